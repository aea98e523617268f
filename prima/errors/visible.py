"""Makes untrusted text safe for people and other tools: it is shown and has no other effect.

Documents, file names, transcripts and answers of hosts may contain anything. Text from them that
goes to a terminal, a page, a picture or another tool's file is passed through these functions.
"""

from __future__ import annotations

import re

HARMFUL = re.compile(
    "[\x00-\x1f\x7f-\x9f"  # control characters: a terminal obeys them
    "\u061c\u200e\u200f\u202a-\u202e\u2066-\u206f"  # marks of direction
    "\u2028\u2029"  # ends of lines
    "\u180e\ufeff\ufff9-\ufffb\U000e0001-\U000e007f"  # other invisible characters
    "\ud800-\udfff\ufdd0-\ufdef\ufffe\uffff]"  # not characters
)
"""Characters not shown; joiners, spaces and soft hyphens are, since scripts need them."""
MARK = "\ufffd"
"""Replaces such a character."""
FORMULA = tuple("=+-@\uff1d\uff0b\uff0d\uff20")
"""Characters with which a spreadsheet's formula begins, also in full width."""


def visible(text: str, keep: str = "") -> str:
    """Text without characters that control a terminal, or reverse or hide other text.

    Other white space becomes a space, except the characters in ``keep``, such as ``"\\n"``.
    """
    if text.isprintable():
        return text
    return HARMFUL.sub(lambda found: found[0] if found[0] in keep else _shown(found[0]), text)


def _shown(letter: str) -> str:
    return " " if letter.isspace() else MARK


def escaped(text: str) -> str:
    """JSON with such characters escaped, which does not change its meaning."""
    return HARMFUL.sub(_escape, text) if "\x7f" in text or not text.isascii() else text


def _escape(found: re.Match[str]) -> str:
    letter = found[0]
    if letter == "\n" or "\ud800" <= letter <= "\udfff":  # not UTF-8, and reported as that
        return letter
    units = letter.encode("utf-16-be").hex()
    return "".join(f"\\u{units[start : start + 4]}" for start in range(0, len(units), 4))


def harmless(text: str) -> str:
    """Text that a spreadsheet does not take for a formula: an apostrophe precedes formulas."""
    return f"'{text}" if text.lstrip(" '").startswith(FORMULA) else text


def unharmed(text: str) -> str:
    """The original of a text changed by :func:`harmless`."""
    return text[1:] if text[:1] == "'" and harmless(text[1:]) == text else text
