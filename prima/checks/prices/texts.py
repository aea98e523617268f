"""The possible texts of expressions, if the document's constants determine them.

``panels[at].parts[0]`` can only give values from ``const panels = [...]``, whatever ``at`` is.
Anything else is unknown before a run.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from prima.grammar.text import fold
from prima.interpreter.acts import Assign, Declare, Foreach, Script, all_acts
from prima.interpreter.elements import Document
from prima.markup.tree import Node
from prima.script.constants import changed_names, constants, path
from prima.script.ecmascript import text


class Constants:
    """The constants of a document that are never changed."""

    def __init__(self, document: Document) -> None:
        codes = list(_codes(document))
        values = {name: value for code in codes for name, value in constants(code)}
        changed = [changed_names(code) for code in codes] if values else []
        if None in changed:
            values.clear()
        lost = set(_declared_again(document)).union(*filter(None, changed))
        self._values = {name: value for name, value in values.items() if name not in lost}

    def texts(self, code: str) -> list[str] | None:
        """All possible texts of an expression; None if unknown."""
        found = path(code)
        if found is None or found.name not in self._values:
            return None
        values: list[Any] = [self._values[found.name]]
        for step in found.steps:
            if any(_has_more(value, step) for value in values):
                return None
            values = [inner for value in values for inner in _inside(value, step)]
        if any(isinstance(value, list | dict) for value in values):
            return None
        return [text(value) for value in values]


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


def _has_more(value: Any, step: str | None) -> bool:
    """Whether a step of a path leads to what a literal does not show, such as its length."""
    if isinstance(value, list):
        return step is not None and not step.isdecimal()
    return isinstance(value, str | float | bool)


def _inside(value: Any, step: str | None) -> Iterable[Any]:
    """The possible values of a step of a path; all members if the step is computed.

    What is undefined is None, which is said in the same way.
    """
    if not isinstance(value, list | dict):
        return [None]
    if step is None:
        return [*(value if isinstance(value, list) else value.values()), None]
    if isinstance(value, dict):
        return [value.get(step)]
    return [value[int(step)]] if step.isdecimal() and int(step) < len(value) else [None]


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
