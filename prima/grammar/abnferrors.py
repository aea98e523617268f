"""Syntax errors of the ABNF form of SRGS, with remedies."""

from __future__ import annotations

import re
from typing import Any

from lark import Token, UnexpectedCharacters, UnexpectedInput, UnexpectedToken

from prima.errors import Problem
from prima.markup.tree import Source

DECLARATIONS = frozenset(
    ["base", "http-equiv", "language", "lexicon", "meta", "mode", "root", "tag-format"]
)
_EXPECTED = {
    "WORD": "a token, or () for nothing",
    "LANGUAGE": "a declaration such as root $name; or a rule such as $name = ...;",
    "NAME": "a rule, $name = ...;",
    "EQUAL": '"="',
    "SEMICOLON": '";"',
    "LANGTAG": "a language such as en-US",
    "MODENAME": "voice or dtmf",
    "ROOTNAME": "the name of a rule, $name",
    "FORMATURI": "a URI in angle brackets, <uri>",
    "BASEURI": "a URI in angle brackets, <uri>",
    "LEXICONURI": "a URI in angle brackets, <uri>",
    "TEXT": "a text in quotes",
    "IS": "the word is",
}
"""Descriptions of what may come next, most likely first: the first possible one is named."""
_CLOSING = {"RPAR": '")"', "RSQB": '"]"', "SEMICOLON": '";"'}
"""Ends of alternatives, named if they may also continue."""
_RESERVED = {
    "}": "A tag that holds a } itself is written {!{ ... }!}.",
    "!": "A language is allowed only after a token, a rule or a bracket, before its repeat: oui!fr<2>.",
    "*": 'Write <0-> for any number of times; a sign that is a key or said, in quotes: "*".',
    "+": 'Write <1-> for once or more; a sign that is said, in quotes: "+".',
}
"""Remedies for signs with another meaning, here or in other languages (2.5)."""
_NAMED = re.compile(r"(\$[^\s;=|*+<>()\[\]{}/$\"!]+)\s*\Z")
"""The name of a rule at the end of a text."""
_UNCLOSED = {
    '"': 'A quote is opened and not closed: write the other ".',
    "{": "A tag is opened and not closed: write }, or }!} if it begins with {!{.",
    "<": "An angle bracket is opened and not closed: write >.",
    "/": "A comment or a weight is not closed: /* ... */, /0.5/.",
}
"""Remedies for unclosed constructs."""


def unexpected(source: Source, error: UnexpectedInput) -> Problem:
    """The problem of an unexpected token."""
    text = source.text
    token = error.token if isinstance(error, UnexpectedToken) else None
    if token is not None and token.type == "$END":
        at = len(text.rstrip())
    else:
        at = len(text) - len(text[error.pos_in_stream :].lstrip())
    found = text[at : at + 20].split("\n")[0].strip()
    message = f'"{found}" is not allowed here.' if found else "The grammar ends too early."
    rule = _NAMED.search(text[:at]) if found[:1] == "=" else None
    begins = f'If {rule[1]} is a new rule, end the one before it with ";".' if rule else ""
    remedy = begins or _remedy(error, found, token)
    return Problem(source.at(at), "error", "not-abnf", message, remedy)


def _remedy(error: UnexpectedInput, found: str, token: Token | None) -> str:
    if found[:1] in _RESERVED:
        return _RESERVED[found[0]]
    if token is None and found[:1] in _UNCLOSED:
        return _UNCLOSED[found[0]]
    assert isinstance(error, UnexpectedToken | UnexpectedCharacters)
    stopped: Any = error.interactive_parser
    accepted: set[str] = stopped.accepts()
    names = _CLOSING if "OR" in accepted else _EXPECTED
    remedy = f"Expected {next(names[name] for name in names if name in accepted)}."
    if token is None:
        return f"{remedy} Signs are words only in quotes."
    if accepted >= {"NAME", "$END"} and (token in DECLARATIONS or found[0] == "{"):
        return f"{remedy} Declarations come before all rules."
    return remedy
