"""étendue measured against its peers: see docs/benchmarking.md."""
