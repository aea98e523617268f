"""Diagnoses that several modules use, by subject; others are declared beside their check."""
