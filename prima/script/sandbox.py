"""The sandbox for untrusted ECMAScript: its limits, and what makes a run repeatable.

``Math.random`` is seeded and the host's clock cannot be read: ``Date`` is :data:`DATE` with the
run's clock. Functions that wait, or reveal when memory is collected, are removed.
"""

from __future__ import annotations

import re
from pathlib import Path

MEMORY_LIMIT = 16 * 1024 * 1024
"""Bytes that one engine may use."""
STACK_LIMIT = 1024 * 1024
"""Bytes of its stack: some 600 calls of a function within one another."""
MAY_ASK_TIME = re.compile(
    r"""Date|\bthis\b|globalThis|eval|Function|constructor|Reflect|Object|\\"""
    r"""|\[(?!\s*(?:\d*|"[^"]*"|'[^']*')\s*\])"""
)
"""Code that names ``Date``, or may reach it without naming it."""


def source(name: str) -> str:
    """The text of one of our scripts, in the folder ``js``."""
    return Path(__file__).with_name("js").joinpath(name).read_text(encoding="utf-8")


PRELUDE = source("repeatable.js")

SAFE, GUARD, EVALUATE, NEXT = "\u01c0safe", "\u01c0guard", "\u01c0evaluate", "\u01c0next"
GIVE, DECLARE = "\u01c0give", "\u01c0declare"
NAME, REFUSE = "\u01c0name", "\u01c0refuse"
"""Names of the functions of :data:`GUARDS`, which documents hardly use."""

GUARDS = source("guards.js")


def reason(text: str, seconds: float) -> str:
    """Why a script failed, in words, from the engine's message; ``seconds`` is its limit."""
    message = (text.splitlines() or [""])[0]
    if message.startswith("InternalError: interrupted"):
        return f"it took longer than {seconds:g} s"
    if message == "null":  # the engine's only message if no memory is left for an error
        return "it threw null, or used too much memory"
    if (
        message in ("", "[uninitialized]")
        or "out of memory" in message
        or "string too long" in message
    ):
        return "it used too much memory"
    if message.startswith("(Failed obtaining"):
        return "it threw a value that cannot be shown"
    if message.startswith("Unknown quickjs tag"):
        return "its value is of a type that is absent here, such as BigInt"
    if message == "[object Object]":
        return "it threw an object that is not an Error"
    return message


START = "2005-03-01T10:00:00"
"""The date at which a run begins by default (UTC)."""

DATE = source("date.js")
"""``Date`` as ECMAScript has it, in UTC: it reads neither the host's clock nor its time zone.

An expression that gives a function of the host's own ``Date`` and a function that gives the time.
"""

CLOCK = source("clock.js")
"""Replaces the host's ``Date`` by :data:`DATE` when a document first reads it.

A function of the text of :data:`DATE`, evaluated before :data:`PRELUDE`, which takes the host's
own ``Date`` away. It gives a function that, called without a value, installs the new one; with
one, sets the time (ms since 1970).
"""
