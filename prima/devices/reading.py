"""Reads typed attributes of worlds, robot profiles and scenarios, and collects their problems."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Any

from prima.errors import DocumentError, Hint, Problem, Severity, has_errors
from prima.interpreter.surroundings import nearest
from prima.language.values import DRAWABLE, NAME, is_beyond, outside, read_value
from prima.markup.reader import read_tree
from prima.markup.spans import nearest_allowed, value_span
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute, Vocabulary
from prima.messages import SERVICE, Json

if TYPE_CHECKING:
    from prima.language.distributions import Quantile

RENAME = "Rename one."


def unknown_name(node: Node, name: str, words: Collection[str], wrong: str) -> list[Problem]:
    """The problem of an attribute that names something that does not exist, if it does so.

    ``wrong`` begins the message, which ends with the name.
    """
    word = node.attributes.get(name)
    if word is None or word in words:
        return []
    # What is no name is reported where it is given.
    named = [one for one in words if re.fullmatch(NAME, one.removeprefix(SERVICE))]
    hint = nearest(word, named, *value_span(node, name))
    message = f'{wrong} "{word}".'
    return [Problem(node.attribute_place(name), "error", "no-such-name", message, hint)]


def part_of(value: Json, path: str) -> Json:
    """The part of a message or an answer at a dotted path; None if there is none.

    A number is an index into a list, from 0.
    """
    for name in path.split("."):
        if isinstance(value, list) and name.isdecimal() and int(name) < len(value):
            value = value[int(name)]
        else:
            value = value.get(name) if isinstance(value, dict) else None
    return value


class Reader:
    """Reads typed attributes of one document by its vocabulary, collecting problems."""

    def __init__(self, vocabulary: Vocabulary, file: str, data: bytes) -> None:
        self.vocabulary = vocabulary
        self.root, self.problems = read_tree(file, data, vocabulary)

    def get(self, node: Node, name: str) -> Any:
        """An attribute's value, its default, or None; for a distribution, its quantiles."""
        item, _ = self.vocabulary.attributes.get(node.key, {}).get(name, (None, False))
        if item is None:
            return None  # an unknown element; already reported
        text = node.attributes.get(name, item.default)
        if not text and name not in node.attributes:
            return None
        try:
            value = read_value(item.kind, text)
        except ValueError:
            return None  # already reported as a schema problem
        if item.kind in DRAWABLE and isinstance(value, str):
            return self._quantile(node, item, value)
        if is_beyond(value, item.low, item.high):
            message = f'{name} "{text}" {outside(item.kind, item.low, item.high)}'
            hint = nearest_allowed(item, text, node, name)
            self.problem(node, "out-of-range", message, name, hint)
        return value

    def _quantile(self, node: Node, item: Attribute, text: str) -> Quantile | None:
        """The quantiles of a distribution, or None if it is invalid."""
        from prima.language.distributions import Distributions  # few documents need it

        values = Distributions(DRAWABLE[item.kind], item.low, item.high, folder=None)
        try:
            return values.read(text)
        except ValueError as error:
            message = f'{item.name} "{text}" cannot be drawn.'
            self.problem(node, "bad-value", message, item.name, str(error))
            return None

    def given(self, node: Node | None, name: str) -> Any:
        """An attribute's value if it is written, else None."""
        return self.get(node, name) if node is not None and name in node.attributes else None

    def problem(
        self,
        node: Node,
        code: str,
        message: str,
        attribute: str = "",
        remedy: str | Hint = "",
        severity: Severity = "error",
    ) -> None:
        """Note a problem."""
        place = node.attribute_place(attribute) if attribute in node.attributes else node.place
        self.problems.append(Problem(place, severity, code, message, remedy))

    def known(self, node: Node, name: str, words: Collection[str], what: str) -> None:
        """Note a problem if an attribute names something that does not exist."""
        if node.get(name):
            self.problems += unknown_name(node, name, words, f"There is no {what}")

    def once(self, node: Node, seen: set[str], what: str = "") -> str:
        """An element's id, which is a problem if it is among those seen before."""
        name = node.get("id")
        if name in seen:
            self.problem(node, "duplicate-id", f'{what}"{name}" is there twice.', "id", RENAME)
        seen.update({name} - {""})
        return name

    def check_twice(self, nodes: Iterable[Node], key: str, fold: bool = False) -> None:
        """Note a problem for each element that is named as an earlier one: only one would count.

        ``key`` is the attribute with the name; ``fold`` ignores its case.
        """
        seen: set[str] = set()
        for node in nodes:
            name = node.get(key).lower() if fold else node.get(key)
            if name in seen:
                message = f'"{name}" is there twice.'
                self.problem(node, "duplicate-name", message, key, "Keep one.")
            seen.add(name)

    def only(self, tag: str) -> Node | None:
        """The root's child of a tag that may occur once; another one is a problem."""
        found = self.root.all(tag)
        for extra in found[1:]:
            message = f"There is a second <{tag}>."
            self.problem(extra, "duplicate-element", message, "", "Keep one.")
        return found[0] if found else None

    def finish(self) -> None:
        """Raise the problems found.

        Raises:
            DocumentError: if there is any error.
        """
        if has_errors(self.problems):
            raise DocumentError(self.problems)
