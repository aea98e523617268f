"""Decodes documents in one of the accepted encodings."""

from __future__ import annotations

import codecs
import re
from typing import TYPE_CHECKING

from prima.errors import DocumentError, Place, Problem, Span, replaced
from prima.errors.diagnoses.reading import ENCODING as DECLARED_WRONGLY
from prima.markup.limits import LIMITS, too_large

if TYPE_CHECKING:
    from email.message import Message

ENCODINGS = frozenset(
    ["utf-8", "ascii", "utf-16", "utf-16-le", "utf-16-be", "koi8-r", "koi8-u"]
    + [f"iso8859-{number}" for number in range(1, 17) if number != 12]
    + [f"cp{number}" for number in range(1250, 1259)]
    + ["shift_jis", "cp932", "euc_jp", "iso2022_jp", "gb2312", "gbk", "gb18030", "big5", "euc_kr"]
)
"""Accepted encodings, by the names that :func:`codecs.lookup` gives them."""
ENCODING = re.compile(rb"""<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._\-]+)["']""")
MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (b"<\0?\0", "utf-16-le"),
    (b"\0<\0?", "utf-16-be"),
)
"""Initial bytes of files in some encodings (XML 1.0, appendix F)."""
ONE_BYTE = ("iso8859", "cp125", "koi8")
"""Beginnings of the names of encodings with one byte for each letter."""
IN_UTF_8 = DECLARED_WRONGLY.says(
    'The file says encoding="{encoding}", but it is in UTF-8: its letters are read wrongly.',
    severity="warning",
)
LATE_DECLARATION = re.compile(rb"(?:\xef\xbb\xbf)?\s+<\?xml\s")


def decode(file: str, data: bytes) -> str:
    """Give a document's text.

    Raises:
        DocumentError: it is too large, its encoding is not accepted, or differs from the declared
            one.
    """
    if len(data) > LIMITS.bytes:
        raise too_large(file, len(data))
    encoding = _encoding(file, data)
    try:
        text = data.decode("utf-8-sig" if encoding == "utf-8" else encoding)
    except UnicodeDecodeError as error:
        if LATE_DECLARATION.match(data):  # the parser reports it; its encoding is ignored
            return data.decode("iso-8859-1")
        message = f"A byte here is not {encoding.upper()}."
        remedy = "Save it as UTF-8, or declare the encoding it has."
        raise DocumentError.of(
            byte_place(file, encoding, error), "encoding", message, remedy
        ) from None
    return with_line_feeds(text)


def recoded(data: bytes, headers: Message) -> bytes:
    """The bytes of an answer; XML whose headers name another encoding is recoded to UTF-8.

    It then begins with a byte order mark, which comes before its declaration. A document that
    has a mark of its own, or is not in that encoding, stays as it is (RFC 7303, 3.2).
    """
    codec = _codec(headers.get_content_charset(""))
    marked = any(data.startswith(mark) for mark, _ in MARKS)
    declaration = ENCODING.match(data)
    declared = _codec(declaration[1].decode()) if declaration else "utf-8"
    is_xml = headers.get_content_type().endswith("xml")
    if marked or not is_xml or codec not in ENCODINGS or codec == declared:
        return data
    try:
        return codecs.BOM_UTF8 + data.decode(codec).encode()
    except UnicodeDecodeError:
        return data


def _encoding(file: str, data: bytes) -> str:
    """The encoding by a file's first bytes, or the declared one, or UTF-8."""
    marked = next((name for mark, name in MARKS if data.startswith(mark)), "")
    declaration = ENCODING.match(data)
    declared = declaration[1].decode().lower() if declaration else ""
    place = _declared_at(file, declaration) if declaration else Place(file)
    if not marked and _codec(declared).startswith("utf-16"):
        message = f'The file says encoding="{declared}", but it is not in UTF-16.'
        raise DocumentError.of(place, "encoding", message, "Declare the encoding it has.")
    encoding = marked or declared or "utf-8"
    if _codec(encoding) not in ENCODINGS:
        message = f'The encoding "{encoding}" is not accepted.'
        where = place if encoding == declared else Place(file)
        raise DocumentError.of(where, "encoding", message, "Save it as UTF-8.")
    return encoding


def _declared_at(file: str, declaration: re.Match[bytes]) -> Place:
    """The place of the encoding's name in an XML declaration, which may have several lines."""
    before = declaration.string[: declaration.start(1)].decode("latin-1")
    return end_place(file, with_line_feeds(before))


def _codec(encoding: str) -> str:
    """Python's name of an encoding; empty for an unknown one."""
    try:
        return codecs.lookup(encoding).name
    except LookupError:
        return ""


def misread(file: str, data: bytes) -> list[Problem]:
    """Warn of UTF-8 that is declared in an encoding of one byte a letter: it is read as noise.

    A text of that encoding would have to hold, and only in such order, letters like "Ã©".
    """
    declaration = ENCODING.match(data)
    declared = declaration[1].decode() if declaration else ""
    if declaration is None or data.isascii() or not _codec(declared).startswith(ONE_BYTE):
        return []
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return []
    place = _declared_at(file, declaration)
    hint = replaced('Write encoding="UTF-8".', "UTF-8", Span.of(place, declared))
    return [IN_UTF_8.at(place, hint, encoding=declared)]


def with_line_feeds(text: str) -> str:
    """Text with all line ends normalised to line feeds (XML 1.0, 2.11)."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def blank(text: str) -> str:
    """Spaces in place of a text, with its line ends: what follows stays where it is."""
    return re.sub(r"[^\n]", " ", text)


def byte_place(file: str, encoding: str, error: UnicodeDecodeError) -> Place:
    """The place of the byte that is invalid in a file's encoding; columns count characters."""
    before = error.object[: error.start].decode(encoding, errors="ignore")
    return end_place(file, with_line_feeds(before))


def end_place(file: str, text: str) -> Place:
    """The place after a file's text, or its beginning, with line feeds."""
    return Place(file, text.count("\n") + 1, len(text) - text.rfind("\n"))
