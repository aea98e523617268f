"""Lines that people type: of limited length, without characters that XML does not allow."""

from __future__ import annotations

import re
import shlex

from prima.errors import UsageError

LONGEST_LINE = 2000
"""Maximum length of a line (characters)."""
UNFIT = re.compile("[^\t -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML does not allow."""


def line_text(line: bytes, errors: str = "strict") -> str:
    """The text of a line, without a trailing carriage return or a leading byte order mark.

    Raises:
        UnicodeDecodeError: it is not UTF-8 and ``errors`` is ``strict``.
    """
    return line.rstrip(b"\r").decode("utf-8-sig", errors)


def check_line(text: str) -> None:
    """Reject a line that is too long or contains characters that XML does not allow.

    Raises:
        UsageError: it is rejected; the message says why.
    """
    if len(text) > LONGEST_LINE:
        raise UsageError(f"The line is longer than {LONGEST_LINE} characters.")
    if found := UNFIT.search(text):
        raise UsageError(f"The line contains an invalid character: U+{ord(found[0]):04X}.")


def split_words(text: str) -> list[str]:
    """Split a line into words; quotation marks keep several together.

    Raises:
        UsageError: a quotation mark is not closed.
    """
    try:
        return shlex.split(text)
    except ValueError:
        raise UsageError("A quotation mark is not closed.") from None


def split_event(text: str, usage: str) -> tuple[str, dict[str, str]]:
    """An event's name and data, written as ``NAME KEY=VALUE ...``.

    Raises:
        UsageError: it is not written so; the message names the usage.
    """
    name, *pairs = split_words(text) or [""]
    if not name or any("=" not in pair[1:] for pair in pairs):
        raise UsageError(f'Write "{usage}".')
    split = [pair.partition("=") for pair in pairs]
    return name, {key: value for key, _, value in split}


def split_sensor(text: str, usage: str) -> tuple[str, str]:
    """A sensor's name and value, written as ``NAME=VALUE``.

    Raises:
        UsageError: it is not written so; the message names the usage.
    """
    words = split_words(text.replace("=", " ", 1))
    if len(words) != 2:
        raise UsageError(f'Write "{usage}".')
    return words[0], words[1]


def split_message(text: str, usage: str) -> tuple[str, str]:
    """A message's sender, if one is named, and its text, written as ``from NAME: TEXT``.

    Raises:
        UsageError: it is not written so; the message names the usage.
    """
    found = re.fullmatch(r"from (.+?): (.+)", text)
    if not text or (f"{text} ".startswith("from ") and found is None):
        raise UsageError(f'Write "{usage}".')
    return (found[1], found[2]) if found else ("", text)
