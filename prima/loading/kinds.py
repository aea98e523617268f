"""What a file is, as far as its beginning tells."""

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
"""How the root element of VoiceXML begins."""


GRAMMAR = re.compile(rb"<(?:[\w.-]+:)?grammar[\s>/]")
"""How the root element of a grammar begins that is a file of its own."""


GRAMMAR_FILES = (".gram", ".abnf", ".grxml", ".srgs")
"""How the names of files end that are nothing but grammars."""


MOST_BEGUN = 2000
"""Characters of a file that are looked at to tell what it is."""


OTHER_FORMS = (b"#ABNF", b"#JSGF", b";GSL", b"#GSL")
"""How grammars begin that are no XML."""


def is_voicexml(data: bytes) -> bool:
    """Whether a file's root element is VoiceXML's, as far as its beginning tells."""
    return VOICEXML.match(root_of(data)) is not None


def is_surely_ours(data: bytes) -> bool:
    """Whether a file begins so that it need not be parsed to know it for our language's."""
    tag, _, _ = root_of(data).partition(b">")
    before, found, _ = tag.partition(b'xmlns="%s"' % DIALOGUE.namespace.encode())
    apart = before[6:7].isspace() and before[-1:].isspace()
    return bool(found) and before.startswith(b"<prima") and apart and b"<" not in before[6:]


def is_application(path: str) -> bool:
    """Whether a file is an application of either language, as far as its beginning tells."""
    try:
        data = read_file(path)
    except (DocumentError, UsageError):
        return False
    return is_voicexml(data) or DIALOGUE.namespace.encode() in data[:4096]


def is_grammar(data: bytes) -> bool:
    """Whether a file is a grammar, as far as its beginning tells; it may lack its header."""
    root = root_of(data)
    if root.startswith(OTHER_FORMS) or GRAMMAR.match(root) is not None:
        return True
    if root.startswith((b"<", b"{")):
        return False
    from prima.grammar.media import looks_like_abnf

    return looks_like_abnf(root[:MOST_BEGUN].decode("latin-1"))
