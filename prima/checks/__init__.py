"""Checks before a run: codes, ignores, and the cost of parts of documents."""
