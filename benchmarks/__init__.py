"""Numbers that matter, measured on this machine: ``python -m benchmarks``."""
