"""Small documents of PRIMA's own language."""

from __future__ import annotations

CAUGHT = '<on event="error.semantic"><log expr="_event"/></on>'
