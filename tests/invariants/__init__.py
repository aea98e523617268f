"""Tests of the invariants: that they hold in every run, and that they can fail."""
