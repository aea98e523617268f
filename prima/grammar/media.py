"""Media types of grammars, and the form that each implies (SRGS 2.2.2 and Appendix G)."""

from __future__ import annotations

import re
from typing import Literal

from prima.errors import Place
from prima.grammar.errors import GrammarError, Problems, UnsupportedFormat, Where

Form = Literal["XML", "ABNF"]
XML_TYPES = frozenset(
    ["application/srgs+xml", "application/grammar+xml", "application/grammar-xml"]
)
LOOSE_TYPE = "application/abnf"
"""A type in use for the ABNF form, although SRGS does not define it."""
ABNF_TYPES = frozenset(["application/srgs", "application/grammar", LOOSE_TYPE])
OPEN_TYPES = frozenset(
    ["", "text/xml", "application/xml", "text/plain", "application/octet-stream", "text/html"]
)
"""Types that do not imply a form; the content decides."""
OTHERS = {"#JSGF": "JSGF", ";GSL": "GSL", "#GSL": "GSL"}
"""Beginnings of formats other than SRGS."""
UNTYPED = "jsgf"
"""The type assumed for a grammar without one in VoiceXML 1.0, whose form is JSGF."""
RIGHT_TYPES: dict[Form, str] = {"XML": "application/srgs+xml", "ABNF": "application/srgs"}
NO_HEADER = "The header of the ABNF form is missing."
FIRST_LINE = 'Begin with "#ABNF 1.0 UTF-8;" in the first line.'
_LOOKS = re.compile(
    r"(?:\s++|//[^\n]*+\n|/\*[^*]*+\*++(?:[^/*][^*]*+\*++)*/)*(?:#?\s*ABNF\b|(?:public\s|private\s)?\s*\$\w+\s*="
    r"|(?:language|mode|root|tag-format|base|lexicon|meta|http-equiv)\s[^;\n]*;)",
    re.DOTALL,
)


def media_type(type: str) -> str:
    """A media type without its parameters."""
    return type.split(";")[0].strip().lower()


def supports(type: str) -> bool:
    """Whether grammars of a media type can be loaded."""
    return media_type(type) in XML_TYPES | ABNF_TYPES


def looks_like_abnf(text: str) -> bool:
    """Whether a text looks like the ABNF form apart from its missing header."""
    return _LOOKS.match(text) is not None


def check_known(media: str, place: Place, begin: str) -> None:
    """Refuse what is not SRGS, by its media type or by how it begins.

    Raises:
        UnsupportedFormat: it is something else.
    """
    remedy = "Write it in SRGS: application/srgs+xml or application/srgs."
    for start, name in OTHERS.items():
        if begin.lstrip().startswith(start):
            message = f"This grammar is in {name}, which is not supported."
            raise UnsupportedFormat.of(place, "format", message, remedy)
    if media == UNTYPED:
        message = "A grammar without a type is in JSGF in VoiceXML 1.0; JSGF is not supported."
        raise UnsupportedFormat.of(place, "format", message, remedy)
    if media not in XML_TYPES | ABNF_TYPES | OPEN_TYPES:
        message = f'Grammars of type "{media[:80]}" are not supported.'
        raise UnsupportedFormat.of(place, "format", message, remedy)


def check_no_text(file: str, begin: str) -> None:
    """Refuse a file that begins like neither form.

    Raises:
        GrammarError: with the header to write, where the text looks like the ABNF form.
    """
    if not begin or begin.startswith("<"):
        return
    if looks_like_abnf(begin):
        raise GrammarError.of(Place(file), "not-abnf", NO_HEADER, FIRST_LINE)
    remedy = "Begin with <grammar ...> for the XML form, or with #ABNF 1.0 UTF-8; for the other."
    raise GrammarError.of(Place(file), "not-xml", "This is not an SRGS grammar.", remedy)


def check_form(problems: Problems, media: str, form: Form, file: str, where: Where) -> None:
    """Note a media type of the form that a grammar does not have; warn of a loose one."""
    right = RIGHT_TYPES[form]
    types = XML_TYPES if form == "ABNF" else ABNF_TYPES
    if media in types:
        what = f'"{file}"' if file else "this grammar"
        message = f'The type "{media}" contradicts {what}, which is in the {form} form.'
        problems.note(where, "format", message, f"Write {right}, or leave the type out.")
    elif media == LOOSE_TYPE:
        message = f'The type "{media}" is not one of SRGS; it is read as {right}.'
        problems.warn(where, "format", message, f"Write {right}.")
