"""The header of the ABNF form of SRGS, and the encoding that it names."""

from __future__ import annotations

import codecs
import re

from prima.errors import Place
from prima.grammar.errors import GrammarError
from prima.grammar.media import FIRST_LINE, NO_HEADER
from prima.markup.encodings import ENCODINGS, byte_place, with_line_feeds
from prima.markup.tree import Source

HEADER = re.compile(r"#ABNF[ \t]+([^\s;]+)(?:[ \t]+([^\s;]+))?[ \t]*;")
UNENDED = re.compile(r"#ABNF[ \t]+1\.0(?:[ \t]+[^\s;]+)?(?=[ \t]*(?:\n|\Z))")
"""A header without its semicolon."""
LINE_END = re.compile(r"[ \t]*(?:\n|\Z)")


def decode_abnf(file: str, data: bytes) -> str:
    """The text of a file in the ABNF form, in the encoding that its header names (SRGS 4.4).

    Raises:
        GrammarError: the encoding is unknown, or the bytes are not in it.
    """
    encoding, column = _encoding(data)
    if not _is_accepted(encoding):
        message = f'The encoding "{encoding[:40]}" is not accepted.'
        place = Place(file, 1, column)
        raise GrammarError.of(place, "encoding", message, "Save it as UTF-8.")
    try:
        return with_line_feeds(data.decode(encoding))
    except UnicodeDecodeError as error:
        message = f"A byte here is not {encoding.upper().removesuffix('-SIG')}."
        remedy = "Save it as UTF-8, or name the encoding it has in the header."
        place = byte_place(file, encoding, error)
        raise GrammarError.of(place, "encoding", message, remedy) from None


def as_unicode(text: str) -> bytes:
    """A text in this form as UTF-8, as its header then declares, with all positions unchanged."""
    header = HEADER.match(text)
    if header is None or header[2] is None or not _is_accepted(header[2].lower()):
        return text.encode(errors="surrogatepass")
    blank = "UTF-8".ljust(len(header[2]))
    named = text[: header.start(2)] + blank + text[header.end(2) :]
    return named.encode(errors="surrogatepass")


def _is_accepted(encoding: str) -> bool:
    """Whether an encoding is accepted, under any of its names."""
    try:
        name = codecs.lookup(encoding).name
    except (LookupError, ValueError):
        return False
    more = ("utf-8-sig", "utf-16-le", "utf-16-be")
    return name in {codecs.lookup(one).name for one in (*ENCODINGS, *more)}


def _encoding(data: bytes) -> tuple[str, int]:
    """The encoding of a file by its first bytes or its header, and the column that names it."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16", 1
    if data.startswith((b"#\0", b"\0#")):
        return "utf-16-le" if data[0] else "utf-16-be", 1
    header = HEADER.match(data[:200].decode("latin-1"))
    if header is None:
        return "utf-8-sig", 1
    return (header[2].lower(), header.start(2) + 1) if header[2] else ("utf-8", 1)


def header_end(source: Source) -> int:
    """The offset at which the header ends; it is alone on the first line (4.1).

    Raises:
        GrammarError: it is missing, its version is unknown, or its line goes on.
    """
    header = HEADER.match(source.text)
    if header is None and (unended := UNENDED.match(source.text)) is not None:
        message = "The header of the ABNF form does not end with a semicolon."
        raise GrammarError.of(source.at(0), "not-abnf", message, f'Write "{unended[0]};".')
    if header is None or header[1] != "1.0":
        found = header[1] if header else ""
        message = f'Version "{found[:20]}" is not known.' if found else NO_HEADER
        raise GrammarError.of(source.at(0), "not-abnf", message, FIRST_LINE)
    if LINE_END.match(source.text, header.end()) is None:
        message = "The line goes on after the header."
        remedy = f'Put a line end after "{header[0]}".'
        raise GrammarError.of(source.at(header.end()), "not-abnf", message, remedy)
    return header.end()
