"""A document as values, each with its element."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from prima.grammar.answers import Answers
from prima.interpreter.acts import (
    Act,
    CommandTemplate,
    Declare,
    Expression,
    Handler,
    Script,
    Text,
    all_acts,
    commands_of,
)
from prima.interpreter.selection import Takers
from prima.markup.tree import Node

if TYPE_CHECKING:
    from prima.messages import Json


@dataclass(slots=True, eq=False)
class Link:
    """Something the user may say at any time in its scope."""

    form: str
    event: str
    answers: Answers
    node: Node


@dataclass(slots=True, eq=False)
class Watch:
    """An event defined by a condition on sensor values (C6)."""

    name: str
    when: Expression
    node: Node


@dataclass(slots=True, eq=False)
class Filled:
    """A filled with its fields; without any, those of the form."""

    mode: str
    names: tuple[str, ...]
    content: tuple[Act, ...]
    node: Node


@dataclass(slots=True, eq=False)
class Prompt:
    """A prompt of a field."""

    text: Text
    count: int
    cond: Expression | None
    timeout: int | None
    bargein: bool | None
    node: Node


@dataclass(slots=True, eq=False)
class Item:
    """The common parts of form items."""

    name: str
    expr: Expression | None
    cond: Expression | None
    handlers: tuple[Handler, ...]
    properties: dict[str, Json]
    node: Node
    hold: int | None
    """How long (ms) its stream is kept open for an event afterwards (X3)."""


@dataclass(slots=True, eq=False)
class Block(Item):
    """Content that runs once."""

    content: tuple[Act, ...] = ()


@dataclass(slots=True, eq=False)
class Field(Item):
    """A question."""

    prompts: tuple[Prompt, ...] = ()
    answers: Answers = field(default_factory=Answers)
    filled: tuple[Filled, ...] = ()
    lang: str = ""
    connect: bool = False
    """Whether the robot turns to the user before it asks (X4)."""


@dataclass(slots=True, eq=False)
class Subdialog(Item):
    """A call of another form."""

    form: str = ""
    params: tuple[tuple[str, str | Expression], ...] = ()
    filled: tuple[Filled, ...] = ()


@dataclass(slots=True, eq=False)
class Unit(Item):
    """A unit around form items (U5), with the devices and Commands of all its content."""

    items: tuple[Item, ...] = ()
    devices: frozenset[str] = frozenset()
    types: tuple[str, ...] = ()
    longest: int = 60000


@dataclass(slots=True, eq=False)
class Form:
    """A state of the application."""

    id: str
    items: tuple[Item, ...]
    handlers: tuple[Handler, ...]
    links: tuple[Link, ...]
    watches: tuple[Watch, ...]
    setup: tuple[Declare | Script, ...]
    filled: tuple[Filled, ...]
    properties: dict[str, Json]
    node: Node
    hold: int | None = None
    connect: bool = False
    words: str = ""
    """The words with which its stream resumes after others have spoken (X9)."""
    takers: Takers[Handler] = field(default_factory=Takers, repr=False, compare=False)
    """The handlers that take an event in it, kept by the event and the visited item."""
    bare: bool = False
    """Whether entering it does nothing but wait for events."""

    def __post_init__(self) -> None:
        self.bare = not (self.items or self.setup or self.watches)


Holder = Handler | Filled | Block
"""Elements with executable content."""
Content = tuple[Form | None, tuple[Act, ...], Node]
"""A piece of executable content, with its form and the element that holds it."""


@dataclass(slots=True, eq=False)
class Document:
    """A whole application."""

    id: str
    kind: str
    """``fa`` or ``ea``."""
    lang: str
    """The language of its texts (BCP 47)."""
    file: str
    forms: dict[str, Form]
    """By id, in document order; the first is entered first."""
    handlers: tuple[Handler, ...]
    """Those of the whole document."""
    links: tuple[Link, ...]
    """Those of the whole document."""
    watches: tuple[Watch, ...]
    """Those of the whole document."""
    setup: tuple[Declare | Script, ...]
    """Its variables and scripts, in document order."""
    properties: dict[str, Json]
    """The values of its properties."""
    node: Node
    """Its root element."""
    expressions: list[Expression] = field(default_factory=list)
    """All its code except scripts."""
    scripts: list[str] = field(default_factory=list)
    """The code of its scripts."""
    assigns_parts: bool = False
    """Whether any code assigns to a part of a variable."""
    counting: bool = False
    """Whether any handler depends on how often its event has occurred."""
    python: bool | None = None
    """Whether Python can evaluate all its code; None until computed."""
    curious: bool = False
    """Whether any code may read the event being handled."""
    timed: bool = False
    """Whether any code may read the time of the run."""
    sensors: tuple[frozenset[str] | None] | None = None
    """The sensors that code may read; None until computed: see :mod:`prima.interpreter.sensors`."""
    _holders: tuple[list[Form | None], list[Holder]] | None = field(
        default=None, repr=False, compare=False
    )

    def contents(self) -> Iterator[Content]:
        """Every piece of executable content, with its form and the element that holds it."""
        if self._holders is None:  # used by every check; a document does not change
            self._holders = self._gather()
        return ((form, one.content, one.node) for form, one in zip(*self._holders, strict=True))

    def _gather(self) -> tuple[list[Form | None], list[Holder]]:
        """The elements with content, each with its form."""
        holders: list[Holder] = [*self.handlers]
        forms: list[Form | None] = [None] * len(holders)
        for form in self.forms.values():
            held: list[Holder] = [*form.handlers, *form.filled]
            for item in all_items(form.items):
                held += item.handlers
                if isinstance(item, Block):
                    held.append(item)
                elif isinstance(item, Field | Subdialog):
                    held += item.filled
            holders += held
            forms += [form] * len(held)
        return forms, holders


Kind = TypeVar("Kind", bound=Act)


class Acts:
    """The executable content of a document by kinds, gathered once, with its forms."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._found: dict[type, tuple[list[Form | None], list[Any]]] = {}
        """Acts by kinds, with a parallel list of forms: a pair for each would be many objects."""
        found = self._found
        for form, content, _ in document.contents():
            for act in all_acts(content):
                kind = type(act)
                if kind not in found:
                    found[kind] = [], []
                forms, acts = found[kind]
                forms.append(form)
                acts.append(act)

    def of(self, kind: type[Kind]) -> Iterator[tuple[Form | None, Kind]]:
        """All of a kind in document order, each with its form; None for the document's own."""
        return zip(*self._found.get(kind, ((), ())), strict=True)

    def among(self, *kinds: type[Act]) -> list[Act]:
        """All of some kinds, in document order."""
        if self._found.keys().isdisjoint(kinds):
            return []
        contents = self._document.contents()
        return [act for _, one, _ in contents for act in all_acts(one) if isinstance(act, kinds)]


def all_items(items: Sequence[Item]) -> Sequence[Item]:
    """Form items, those inside units included, in document order."""
    if not items or Unit not in map(type, items):
        return items
    found: list[Item] = []
    for item in items:
        found.append(item)
        if isinstance(item, Unit):
            found += all_items(item.items)
    return found


def document_commands(document: Document) -> Iterator[CommandTemplate]:
    """Every Command of a document, in document order."""
    for _, content, _ in document.contents():
        yield from commands_of(content)
