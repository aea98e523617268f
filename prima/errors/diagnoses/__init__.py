"""Diagnoses that several modules make, by subject; others are declared beside their check."""
