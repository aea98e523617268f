"""The names that variables of documents may have (VoiceXML 2.0, 5.1)."""

from __future__ import annotations

from typing import Literal

from prima.script.globals import IDENTIFIER, RESERVED
from prima.script.walk import OBJECTS

SCOPES = frozenset(["session", *OBJECTS])
"""Objects that hold the variables of a scope (5.1.2)."""

SOMETIMES = frozenset(["async", "await", "let", "of", "static", "yield"])
"""Words that are names as well in the ECMAScript of documents."""


def wrong_name(name: str) -> Literal["", "not a name", "reserved", "scope"]:
    """Why a variable cannot have a name: no expression can read it, or it is the platform's.

    A declaration names no scope, such as ``application.x``: its own place says which (5.3.1).
    """
    if name.partition(".")[0] in SCOPES and "." in name:
        return "scope"
    if not IDENTIFIER.fullmatch(name) or name in RESERVED - SOMETIMES:
        return "not a name"
    # $ alone is not a shadow variable.
    return "reserved" if name.startswith("_") or name[1:].endswith("$") else ""
