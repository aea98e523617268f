"""The kind of a file, judged by its beginning."""

from __future__ import annotations

import re

from prima.errors import (
    DocumentError,
    UsageError,
)
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.loading.files import read_file
from prima.markup.sniff import root_of

VOICEXML = re.compile(rb"<(?:[\w.-]+:)?vxml[\s>/]")
"""The beginning of VoiceXML's root element."""


GRAMMAR = re.compile(rb"<(?:[\w.-]+:)?grammar[\s>/]")
"""The beginning of the root element of a grammar file."""


ROOT = re.compile(rb"<(?:[\w.-]+:)?([^\s:/>]+)")
OURS = frozenset([b"prima", b"world", b"robot", b"scenario", b"user", b"services"])
"""The root elements of PRIMA's own documents."""


GRAMMAR_FILES = (".gram", ".abnf", ".grxml", ".srgs")
"""Suffixes of files that are certainly grammars."""


MOST_BEGUN = 2000
"""How many characters of a file are examined to determine its kind."""


OTHER_FORMS = (b"#ABNF", b"#JSGF", b";GSL", b"#GSL")
"""Beginnings of grammars that are not XML."""


def is_voicexml(data: bytes) -> bool:
    """Whether a file's root element is VoiceXML's, judged by its beginning."""
    return VOICEXML.match(root_of(data)) is not None


def is_surely_ours(data: bytes) -> bool:
    """Whether a file is certainly in our language, judged by its beginning without parsing."""
    tag, _, _ = root_of(data).partition(b">")
    before, found, _ = tag.partition(b'xmlns="%s"' % DIALOGUE.namespace.encode())
    apart = before[6:7].isspace() and before[-1:].isspace()
    return bool(found) and before.startswith(b"<prima") and apart and b"<" not in before[6:]


def is_foreign(path: str) -> bool:
    """Whether a file is XML for another purpose, such as data that VoiceXML reads.

    It is judged by the name and namespaces of its root element.
    """
    try:
        root = root_of(read_file(path))
    except (DocumentError, UsageError):
        return False  # its problem is to be reported
    if is_voicexml(root) or GRAMMAR.match(root):
        return False
    name = ROOT.match(root)
    return name is not None and name[1] not in OURS and b"urn:prima:" not in root.partition(b">")[0]


def is_application(path: str) -> bool:
    """Whether a file is an application of either language, judged by its beginning."""
    try:
        data = read_file(path)
    except (DocumentError, UsageError):
        return True  # its problem is to be reported
    return is_voicexml(data) or DIALOGUE.namespace.encode() in data[:4096]


def is_grammar(data: bytes) -> bool:
    """Whether a file is a grammar, judged by its beginning; its header may be missing."""
    root = root_of(data)
    if root.startswith(OTHER_FORMS) or GRAMMAR.match(root) is not None:
        return True
    if root.startswith((b"<", b"{")):
        return False
    from prima.grammar.media import looks_like_abnf

    return looks_like_abnf(root[:MOST_BEGUN].decode("latin-1"))
