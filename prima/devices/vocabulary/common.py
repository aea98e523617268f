"""Attributes that documents of all kinds have."""

from __future__ import annotations

from prima.markup.vocabulary import attribute

VERSION = attribute("version", "text", "the language's version", "required", choices=("1.0",))
ID = attribute("id", "id", "its name", "required")
TITLE = attribute("title", "text", "what people call it")
