"""Tests of applications: scenarios run, with what is expected of them, and what they cover."""
