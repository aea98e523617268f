"""Small documents of PRIMA's own language."""

from __future__ import annotations

# Errors that a document can handle, wherever they arise ------------------------------
CAUGHT = '<on event="error.semantic"><log expr="_event"/></on>'
