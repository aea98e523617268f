"""Runs on real robots: drivers, the clock, the journal, services."""
