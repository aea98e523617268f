"""Tables of elements: the single definition of what a kind of document may contain.

A :class:`Vocabulary` drives validation (:mod:`prima.markup.check`). Schemas for editors and
the tables of the language reference are made from it; a test holds them together.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple


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


def attribute(
    name: str,
    kind: str,
    doc: str,
    *marks: Literal["required", "dynamic"],
    default: str = "",
    choices: tuple[str, ...] = (),
    low: float | None = None,
    high: float | None = None,
) -> Attribute:
    """Write an :class:`Attribute` on one line."""
    return Attribute(
        name, kind, doc, "required" in marks, default, choices, "dynamic" in marks, low, high
    )


def attributes_by_name(element: Element) -> dict[str, tuple[Attribute, bool]]:
    """Attribute names as written, ``NAME-expr`` included, with whether it is the expression."""
    names: dict[str, tuple[Attribute, bool]] = {}
    for item in element.attributes:
        names[item.name] = (item, False)
        if item.dynamic:
            names[f"{item.name}-expr"] = (item, True)
    return names
