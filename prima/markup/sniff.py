"""The beginning of a file, which shows the kind of document."""

from __future__ import annotations

import re

BOMS = (b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff")
DOCTYPE = re.compile(rb"<!DOCTYPE(?:\"[^\"]*+\"|'[^']*+'|[^\[>\"']++)*(?:\[.*?\]\s*)?>", re.DOTALL)
PIECES = ((b"<?", b"?>"), (b"<!--", b"-->"))
"""Delimiters of processing instructions and comments."""


def root_of(data: bytes) -> bytes:
    """A file from the apparent beginning of its root element, past the prolog, without parsing.

    No file is refused: one that is not XML is returned without leading white space, UTF-16 text
    with one byte for each letter.
    """
    if b"\0" in data[:4]:
        data = data.replace(b"\0", b"")
    at = 0
    while bom := next((bom for bom in BOMS if data.startswith(bom, at)), b""):
        at += len(bom)
    while True:
        while data[at : at + 1].isspace():
            at += 1
        end = _past(data, at)
        if end < 0:
            return data[at:]
        at = end


def _past(data: bytes, at: int) -> int:
    """The end of the instruction, comment or DOCTYPE that begins here; -1 if none does."""
    for begin, close in PIECES:
        if data.startswith(begin, at):
            found = data.find(close, at + len(begin))
            return -1 if found < 0 else found + len(close)
    if data.startswith(b"<!DOCTYPE", at):
        match = DOCTYPE.match(data, at)
        return -1 if match is None else int(match.end())
    return -1
