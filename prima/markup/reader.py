"""Hardened reading: bytes in, a tree of nodes or a list of problems out.

An untrusted file is restricted before it is parsed: its size, its encoding, and its DOCTYPE,
which may name an external identifier (never fetched) and nothing else.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from prima.errors import DocumentError, Place, Problem, Span, replaced
from prima.markup.build import MAX_NAME, LimitReached, Unclear, build
from prima.markup.check import check_tree
from prima.markup.encodings import ENCODING, blank, decode
from prima.markup.limits import LIMITS, too_deep
from prima.markup.roots import check_root
from prima.markup.tree import Node, Source
from prima.markup.vocabulary import Vocabulary
from prima.markup.wellformed import explain

UNVERSIONED = re.compile(r"<\?xml(?:\s*\?>|\s++(?!version\b))")
"""The beginning of an XML declaration without its version (XML 1.0, 2.8)."""
DECLARATION = re.compile(
    r"""<\?xml(?![\s?])[^>]*>|<\?xml\s+version\s*=\s*("[^"]*"|'[^']*')"""
    r"""(\s+encoding\s*=\s*("[^"]*"|'[^']*'))?(\s+standalone\s*=\s*("[^"]*"|'[^']*'))?\s*\?>"""
)
"""An XML declaration, or another instruction."""


def parse(file: str, data: bytes, vocabularies: Sequence[Vocabulary] = ()) -> Node:
    """Parse bytes into nodes.

    ``vocabularies`` are languages to which a misspelt opening tag may belong.

    Raises:
        DocumentError: it is not well-formed, or exceeds a limit.
    """
    text = decode(file, data)
    end = text.find(">") + 1
    if text.startswith("<?xml") and text[:end].endswith("?>"):
        _check_declaration(file, text[:end])
        text = blank(text[:end]) + text[end:]  # the text is decoded, whatever it declares
    source = Source(file, text)
    try:
        try:
            return build(source)
        except Unclear:
            explain(source, vocabularies)
            return build(source, doctype=True)
    except LimitReached as much:
        raise _beyond(much) from None
    except Unclear as unclear:  # names of the fifth edition of XML 1.0
        message = "This is not well-formed XML: a name has a character that no name may have."
        place = Place(file, unclear.line, unclear.column)
        raise DocumentError.of(place, "not-xml", message, "Take another name.") from None


def _check_declaration(file: str, text: str) -> None:
    """Refuse an XML declaration that is not well-formed, such as one without its version.

    Raises:
        DocumentError: it does so.
    """
    if not DECLARATION.fullmatch(text):
        place = Place(file)
        encoding = ENCODING.match(text.encode())
        right = f'<?xml version="1.0" encoding="{encoding[1].decode() if encoding else "UTF-8"}"?>'
        spans = () if "\n" in text else (Span.of(place, text),)
        hint = replaced(f"Write {right}.", right, *spans)
        wrong = "does not begin with a version" if UNVERSIONED.match(text) else "is written wrongly"
        raise DocumentError.of(place, "not-xml", f"The XML declaration {wrong}.", hint)


def _beyond(much: LimitReached) -> DocumentError:
    place, tag = much.node.place, much.node.tag
    if much.what == "depth":
        return too_deep(place)
    if much.what == "name":
        message = f"A name has more than {MAX_NAME:,} characters."
        return DocumentError.of(place, "too-large", message, "Take a shorter one.")
    if much.what == "attributes":
        message = f"<{tag}> has more than {LIMITS.attributes} attributes."
        return DocumentError.of(place, "too-large", message, "Remove some.")
    message = f"The document has more than {LIMITS.elements:,} elements."
    remedy = f"Divide it, or raise the limit: --limit elements={10 * LIMITS.elements}."
    return DocumentError.of(place, "too-large", message, remedy)


def read_tree(file: str, data: bytes, *vocabularies: Vocabulary) -> tuple[Node, list[Problem]]:
    """Read a document of one of the vocabularies; gives it with its schema problems.

    Raises:
        DocumentError: it is not XML, or not such a document at all.
    """
    root = parse(file, data, vocabularies)
    problems: list[Problem] = []
    check_tree(root, check_root(root, vocabularies), problems)
    return root, problems
