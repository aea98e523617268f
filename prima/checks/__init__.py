"""Checks before a run: warnings that comments leave out, and what parts of documents cost."""
