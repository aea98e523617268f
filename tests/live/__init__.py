"""Live runs: drivers, clock, journal, and what comes of them."""
