"""Hardened reading of untrusted XML, with exact places, checked against a table of elements."""
