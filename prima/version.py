"""PRIMA's version, which every room may know."""

from __future__ import annotations

__version__ = "1.0.0"
