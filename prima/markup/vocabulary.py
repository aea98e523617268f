"""Tables of elements: the single definition of what a kind of document may contain.

A :class:`Vocabulary` drives validation (:mod:`prima.markup.check`). Schemas for editors and
the tables of the language reference are made from it; a test holds them together.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True, slots=True)
class Attribute:
    """An attribute of an element.

    ``choices`` lists the allowed values if there are only few; ``dynamic`` means that
    ``NAME-expr`` may be written instead, with an expression.
    """

    name: str
    kind: str
    doc: str
    required: bool = False
    default: str = ""
    choices: tuple[str, ...] = ()
    dynamic: bool = False
    low: float | None = None
    high: float | None = None


class Instead(NamedTuple):
    """The element to write instead of one that authors expect; ``rest`` follows its name."""

    tag: str
    rest: str = ""

    def __str__(self) -> str:
        space = "" if self.rest in ("", "/") else " "
        return f"Write <{self.tag}{space}{self.rest}>."


@dataclass(frozen=True, slots=True)
class Element:
    """An element: its attributes, the children it may have, and whether it holds text.

    ``key`` distinguishes elements of one name in different parents;
    ``children`` are keys.
    """

    key: str
    doc: str
    attributes: tuple[Attribute, ...] = ()
    children: tuple[str, ...] = ()
    text: bool = False
    name: str = ""
    source: str = ""

    @property
    def tag(self) -> str:
        """The name as written in documents."""
        return self.name or self.key


class Vocabulary:
    """All elements of one kind of document."""

    def __init__(
        self,
        namespace: str,
        name: str,
        root: str,
        elements: Iterable[Element],
        hints: Mapping[str, str | Instead] | None = None,
    ) -> None:
        self.namespace = namespace
        self.name = name
        self.root = root
        self.elements = {element.key: element for element in elements}
        self.hints = dict(hints or {})
        """Replacements of elements that authors expect but this language lacks."""
        self._children = {
            key: {self.elements[child].tag: child for child in element.children}
            for key, element in self.elements.items()
        }
        self.tags = frozenset(element.tag for element in self.elements.values())
        self.attributes = {key: attributes_by_name(one) for key, one in self.elements.items()}
        """Results of :func:`attributes_by_name` by key."""

    @property
    def root_tag(self) -> str:
        """The name of the root element as written in documents."""
        return self.elements[self.root].tag

    def child(self, key: str, tag: str) -> str | None:
        """The key of the element written ``tag`` inside the element ``key``, if allowed."""
        return self._children[key].get(tag)

    def children(self, key: str) -> Mapping[str, str]:
        """The elements allowed inside the element ``key``: tags as written to keys."""
        return self._children[key]

    def parents(self, tag: str) -> list[str]:
        """The tags of the elements that may hold ``tag``."""
        return sorted(
            {self.elements[key].tag for key, tags in self._children.items() if tag in tags}
        )


ROW = re.compile(
    r"(?P<name>[\w:.-]+)(?P<required>\*)?(?P<dynamic>\+expr)?: (?P<kind>\w+)"
    r"(\((?P<choices>[^)]+)\))?( (?P<low>-?\d+(\.\d+)?)?\.\.(?P<high>-?\d+(\.\d+)?)?)?"
    r"( = (?P<default>.*?))? \|(?P<doc>.*)"
)


def attribute(row: str) -> Attribute:
    """Read an :class:`Attribute`: ``NAME: KIND(CHOICES) LOW..HIGH = DEFAULT | DOC``.

    ``*`` behind the name means required, ``+expr`` dynamic. Choices are separated by spaces.

    Raises:
        ValueError: it is written otherwise.
    """
    found = ROW.fullmatch(" ".join(row.split()))
    if found is None:
        raise ValueError(f"not an attribute: {row}")
    low, high = (float(found[name]) if found[name] else None for name in ("low", "high"))
    return Attribute(
        found["name"],
        found["kind"],
        found["doc"].strip(),
        bool(found["required"]),
        found["default"] or "",
        tuple((found["choices"] or "").split()),
        bool(found["dynamic"]),
        low,
        high,
    )


def elements(table: str) -> tuple[Element, ...]:
    """Read elements: ``KEY=NAME ATTRIBUTES > CHILDREN | DOC | SOURCE``, then their attributes.

    ``#text`` among the children means that it holds text. Rows of attributes are indented by two
    spaces; attributes without one are text without a description. More indented lines continue
    the one before.
    """
    found: list[tuple[str, list[str]]] = []
    for line in filter(None, re.sub(r"\n {3,}", " ", table).splitlines()):
        if line.startswith(" "):
            found[-1][1].append(line)
        else:
            found.append((line, []))
    return tuple(_element(*one) for one in found)


def _element(head: str, rows: list[str]) -> Element:
    what, doc, *source = head.split(" | ", 2)
    names, _, children = what.partition(" >")
    first, *plain = names.split()
    key, _, name = first.partition("=")
    bare = (Attribute(one.rstrip("*"), "text", "", one.endswith("*")) for one in plain)
    held = dict.fromkeys(children.split())
    text = "#text" in held
    kept = tuple(one for one in held if one != "#text")
    return Element(key, doc, (*bare, *map(attribute, rows)), kept, text, name, "".join(source))


def attributes_by_name(element: Element) -> dict[str, tuple[Attribute, bool]]:
    """Attribute names as written, ``NAME-expr`` included, with whether it is the expression."""
    names: dict[str, tuple[Attribute, bool]] = {}
    for item in element.attributes:
        names[item.name] = (item, False)
        if item.dynamic:
            names[f"{item.name}-expr"] = (item, True)
    return names
