//! Experiments on top of [`render`](crate::render): comparing, verifying, trade-offs. Empty so far.
