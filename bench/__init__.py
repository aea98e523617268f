"""Measurements, each beside a peer or a floor: ``python -m bench.run``."""
