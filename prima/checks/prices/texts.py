"""The possible texts of expressions, if the document's constants determine them.

``panels[at].parts[0]`` can only give values from ``const panels = [...]``, whatever ``at`` is.
Anything else is unknown before a run.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator

from prima.grammar.text import fold
from prima.interpreter.acts import Assign, Declare, Foreach, Script, all_acts
from prima.interpreter.elements import Document
from prima.markup.tree import Node

Literal = str | float | bool | None | list["Literal"] | dict[str, "Literal"]
"""A literal value in a script."""

NAME = r"[A-Za-z_$][\w$]*"
CONSTANT = re.compile(rf"\bconst\s+({NAME})\s*=\s*(?=[\[{{])")
TOKEN = re.compile(
    rf"""\s*(?://[^\n]*\n\s*|/\*.*?\*/\s*)*(?:(?P<string>'[^'\\\n]*'|"[^"\\\n]*")"""
    rf"|(?P<number>-?[0-9]+(?:\.[0-9]+)?)|(?P<word>{NAME})|(?P<mark>[\[\]{{}},:]))",
    re.DOTALL,
)
WORDS: dict[str, Literal] = {"true": True, "false": False, "null": None}
STEP = re.compile(rf"\.(?P<key>{NAME})|\[\s*(?P<code>[^\[\]]*?)\s*\]")
PATH = re.compile(rf"\s*(?P<name>{NAME})(?P<steps>(?:\.{NAME}|\[[^\[\]]*\])+)\s*")
UNDEFINED = "undefined"


class Constants:
    """The constants of a document that are never changed."""

    def __init__(self, document: Document) -> None:
        codes = list(_codes(document))
        self._values = {
            name: value
            for code in codes
            for name, value in _declared(code)
            if all(_only_read(name, one) for one in codes)
        }
        for name in _declared_again(document):
            self._values.pop(name, None)

    def texts(self, code: str) -> list[str] | None:
        """All possible texts of an expression; None if unknown."""
        path = PATH.fullmatch(code)
        if path is None or path["name"] not in self._values:
            return None
        values: list[Literal] = [self._values[path["name"]]]
        for step in STEP.finditer(path["steps"]):
            values = [inner for value in values for inner in _inside(value, step)]
        if any(isinstance(value, list | dict) for value in values):
            return None
        return [_said(value) for value in values]


def _codes(document: Document) -> Iterator[str]:
    """All code of a document."""
    yield from (one.code for one in document.expressions)
    for setup in (document.setup, *(form.setup for form in document.forms.values())):
        yield from (one.code.code for one in setup if isinstance(one, Script))
    for _, content, _ in document.contents():
        yield from (act.code.code for act in all_acts(content) if isinstance(act, Script))


def _declared_again(document: Document) -> Iterator[str]:
    """The names of variables of other scopes, and of assigned variables."""
    for setup in (document.setup, *(form.setup for form in document.forms.values())):
        yield from (one.name for one in setup if isinstance(one, Declare))
    for form in document.forms.values():
        yield from (item.name for item in form.items)
    for _, content, _ in document.contents():
        for act in all_acts(content):
            if isinstance(act, Declare | Assign):
                yield act.name.partition(".")[0].partition("[")[0]
            elif isinstance(act, Foreach):
                yield act.item


READ = re.compile(
    rf"(?>(?:\.{NAME}|\[[^\[\]=(]*\])+)"
    r"(?!\s*(?:[\[(`.]|\+\+|--|=(?!=)|[-+*/%&|^?<>]+=(?!=)))"
)
"""What may follow a constant's name: a path that is neither called nor changed."""


def _only_read(name: str, code: str) -> bool:
    """Whether code only reads a constant's content."""
    for found in re.finditer(rf"(?<![\w$.]){re.escape(name)}(?![\w$])", code):
        before = code[: found.start()]
        if re.search(r"\b(const|in)\s+$", before) is None:
            read = READ.match(code, found.end())
            if read is None or re.search(r"(\+\+|--|\bdelete\s)\s*$", before):
                return False
    return True


def _declared(code: str) -> Iterator[tuple[str, Literal]]:
    """The constants of a script whose values are entirely literal."""
    for found in CONSTANT.finditer(code):
        try:
            value, end = _value(code, found.end())
        except ValueError:
            continue
        if re.match(r"\s*(;|\n|$)", code[end:]) is not None:
            yield found[1], value


def _value(code: str, at: int) -> tuple[Literal, int]:
    """The literal value at a position, and its end.

    Raises:
        ValueError: it is computed.
    """
    token = _token(code, at)
    if token["string"]:
        return token["string"][1:-1], token.end()
    if token["number"]:
        return float(token["number"]), token.end()
    if token["word"] in WORDS:
        return WORDS[token["word"]], token.end()
    if token["mark"] == "[":
        return _array(code, token.end())
    if token["mark"] == "{":
        return _object(code, token.end())
    raise ValueError


def _token(code: str, at: int) -> re.Match[str]:
    token = TOKEN.match(code, at)
    if token is None:
        raise ValueError
    return token


def _array(code: str, at: int) -> tuple[Literal, int]:
    made: list[Literal] = []
    while _token(code, at)["mark"] != "]":
        value, at = _value(code, at)
        made.append(value)
        at = _comma(code, at, "]")
    return made, _token(code, at).end()


def _object(code: str, at: int) -> tuple[Literal, int]:
    made: dict[str, Literal] = {}
    while (key := _token(code, at))["mark"] != "}":
        name = key["word"] or key["number"] or (key["string"] or "")[1:-1]
        colon = _token(code, key.end())
        if colon["mark"] != ":":
            raise ValueError
        made[name], at = _value(code, colon.end())
        at = _comma(code, at, "}")
    return made, _token(code, at).end()


def _comma(code: str, at: int, closing: str) -> int:
    """Skip a comma; without one the closing bracket must follow."""
    token = _token(code, at)
    if token["mark"] == ",":
        return token.end()
    if token["mark"] != closing:
        raise ValueError
    return at


def _inside(value: Literal, step: re.Match[str]) -> Iterable[Literal]:
    """The possible values of a step of a path; all members if the step is computed."""
    if not isinstance(value, list | dict):
        return [UNDEFINED]
    key = _key(step)
    if key is None:
        return [*(value if isinstance(value, list) else value.values()), UNDEFINED]
    if isinstance(value, dict):
        return [value.get(key, UNDEFINED)]
    return [value[int(key)]] if key.isdecimal() and int(key) < len(value) else [UNDEFINED]


def _key(step: re.Match[str]) -> str | None:
    """The literal name or number of a step."""
    key: str | None = step["key"]
    code: str = step["code"] or ""
    if key is None and code[:1] in "'\"" and code[:1] == code[-1:] and len(code) > 1:
        return code[1:-1]
    return code if key is None and code.isdecimal() else key


def _said(value: Literal) -> str:
    if isinstance(value, float) and value == int(value):
        return str(int(value))
    return value if isinstance(value, str) else json.dumps(value)


def words_of(link: Node) -> frozenset[str] | None:
    """The words in a link's grammars; None if they refer to other grammars."""
    found: set[str] = set()
    for node in [one for grammar in link.all("grammar") for one in grammar.walk()]:
        named = node.attributes.keys() & {"src", "srcexpr", "type", "mode"}
        if named or node.tag not in ("grammar", "one-of", "item", "token", "tag", "rule"):
            return None
        if node.tag != "tag":
            found |= {
                word for one in node.content if isinstance(one, str) for word in fold(one).split()
            }
    return frozenset(found)
