"""The scenes that étendue ships, and the little glTF writer that they are made with."""
