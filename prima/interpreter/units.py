"""The Commands that a unit around form items may request (rule U5).

An event that is thrown in a unit is handled in it, by whatever handler takes it: of the item, the
unit, the form or the document. What such a handler asks for belongs to the unit as well. An event
from outside is handled in the unit by the handlers of its items and its own alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from prima.errors import Problem
from prima.errors.diagnoses.behaviour import NOT_IN_UNIT, NOW_INSIDE
from prima.interpreter.acts import (
    Act,
    CommandTemplate,
    Expression,
    Handler,
    Throw,
    all_acts,
    commands_of,
)
from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Filled,
    Form,
    Item,
    Subdialog,
    Unit,
    all_items,
)
from prima.interpreter.naming import events_named
from prima.interpreter.selection import takes
from prima.language.commands import TABLE_4_2, CommandType
from prima.markup.tree import Node

NOW_BEHIND_OTHERS = NOW_INSIDE.says(
    "<{p}{tag}> is wanted now; it is not allowed in a <{p}par>, <{p}seq> or <{p}iu> after others.",
    "Put it first.",
)
CANNOT_BE_IN_UNIT = NOT_IN_UNIT.says("{why}; it is not allowed in a unit.", "{remedy}")

ARRANGING = ("par", "seq", "iu")
"""Elements around Commands."""
LONGEST_UNIT_MS = 60_000
"""The default of ``longest``, a unit's longest duration."""
QUESTION = "q-and-a"
UNANSWERED = ("noinput", "nomatch")
"""The events that a question throws in itself."""


@dataclass(slots=True)
class Reached:
    """A Command that may run in a unit, and how it is reached."""

    command: CommandTemplate
    inside: bool
    """Whether it is written inside the unit."""
    event: str = ""
    """The event whose handler outside the unit requests it, if any."""
    code: str = ""
    """The expression that may name that event, if only a run determines it."""


@dataclass(slots=True)
class Reach:
    """All that may run in a unit."""

    commands: list[Reached]
    """Each Command once, in the order found."""
    asks: bool
    """Whether its items include a question."""

    @property
    def devices(self) -> frozenset[str]:
        """All its devices according to Table 4.2; a robot may add Commands of its own."""
        found = TABLE_4_2[QUESTION].devices if self.asks else frozenset()
        return found.union(*(devices_of(one.command) for one in self.commands))

    @property
    def types(self) -> tuple[str, ...]:
        """The types of its Commands by name, except questions."""
        return tuple(sorted({one.command.type for one in self.commands}))


def units_of(document: Document) -> Iterator[tuple[Form, Unit]]:
    """Every unit around form items, with its form."""
    for form in document.forms.values():
        yield from ((form, item) for item in form.items if isinstance(item, Unit))


def not_in_unit(row: CommandType) -> str:
    """Why a Command cannot run in a unit (U4), if so."""
    if row.leaves:
        return "leaves the user"
    return "works in a feedback loop" if row.feedback else ""


def unit_problem(
    one: Reached, row: CommandType | None, unit: Unit | None = None, prefix: str = ""
) -> Problem | None:
    """The problem of a Command of such a row in a unit (U4, U5), if any.

    ``prefix`` is that of Commands' elements in the document, with its colon.
    """
    if row is None:
        return None
    why = not_in_unit(row)
    if not why:
        return None
    iu = f"<{prefix}iu>"
    message, remedy = f"<{prefix}{row.name}> {why}", f"Move it out of the {iu}."
    if unit is not None and not one.inside:
        by = f' by the event "{one.event}"' if one.event else ""
        if one.code:
            by += f', which the expression "{one.code}" may name'
        message += f", and the unit in line {unit.node.place.line} reaches it{by}"
        remedy = f"Leave the {iu} with <goto> first, and do this there."
    if one.event:
        remedy = f'Handle "{one.event}" in the {iu} as well, or leave the {iu} with <goto> first.'
    if one.code:
        remedy = (
            f"Name the event as a text, x ? 'this' : 'that', or leave the {iu} with <goto> first."
        )
    return CANNOT_BE_IN_UNIT.at(one.command.node.place, why=message, remedy=remedy)


def leading(node: Node) -> Node:
    """The Command that a ``par``, ``seq`` or ``iu`` begins with, or the Command itself."""
    while node.tag in ARRANGING and node.nodes:
        node = node.nodes[0]
    return node


def now_inside(node: Node, prefix: str = "") -> Problem:
    """A Command wanted now after or alongside others in a unit (O2)."""
    return NOW_BEHIND_OTHERS.at(node.place, p=prefix, tag=node.tag)


class UnitPiece:
    """Executable content of a unit or a handler: its Commands and thrown events."""

    __slots__ = ("commands", "computed", "throws")

    def __init__(self, content: Sequence[Act], document: Document) -> None:
        acts = all_acts(content)
        self.commands = commands_of(content)
        self.throws: set[str] = set()
        """Names of events."""
        self.computed: set[str] = set()
        """Expressions that name events which only a run determines."""
        for act in acts:
            if isinstance(act, Throw):
                self._throw(act.event, document)
        for command in self.commands:
            self.throws |= failures(command)

    def _throw(self, event: str | Expression, document: Document) -> None:
        if isinstance(event, str):
            self.throws.add(event)
        elif (named := events_named(document, event.code)) is not None:
            self.throws |= named
        else:
            self.computed.add(event.code)


def devices_of(command: CommandTemplate) -> frozenset[str]:
    """The devices of a Command according to Table 4.2, and the speaker for a text."""
    row = TABLE_4_2.get(command.type)
    devices: frozenset[str] = row.devices if row is not None else frozenset()
    return devices | {"speaker"} if command.text else devices


def failures(command: CommandTemplate) -> set[str]:
    """The events by which a Command of a unit can fail in it."""
    broken = {f"error.device.{device}" for device in devices_of(command)}
    return broken | {"error.semantic", f"error.unsupported.{command.type}"}


class _Raised(NamedTuple):
    """An event in a unit, the first event that led to it, and an expression that may name that."""

    event: str | None
    """None if only a run determines it."""
    first: str = ""
    code: str = ""


class Finder:
    """Finds what units of a document reach; examines each handler once."""

    def __init__(
        self, document: Document, thrown: Callable[[Item], Iterable[str | None]] | None = None
    ) -> None:
        """Prepare to find in a document.

        ``thrown`` gives the events that visiting an item may throw by itself, None for one
        whose name is known only in a run; by default those of PRIMA's language.
        """
        self._document = document
        self._thrown = thrown or thrown_by
        self._pieces: dict[int, UnitPiece] = {}
        self._taking: dict[tuple[str, str | None], list[Handler]] = {}
        """The handlers of a form and the document that take an event, by both names."""

    def reach(self, form: Form, unit: Unit) -> Reach:
        """All that may run in a unit of a form."""
        found: dict[int, Reached] = {}
        for item in unit.items:
            self._visit(form, unit, item, found)
        return Reach([*found.values()], any(isinstance(item, Field) for item in unit.items))

    def _visit(self, form: Form, unit: Unit, item: Item, found: dict[int, Reached]) -> None:
        """The content that may run while an item of a unit is visited."""
        inner = (*item.handlers, *unit.handlers)
        waiting = [*map(_Raised, self._thrown(item)), *self._by_links(form, item)]
        for content in _own(item):
            waiting += self._take_in(self._made(content), True, _Raised(""), found)
        for handler in inner:
            waiting += self._take_in(self._piece(handler), True, _Raised(""), found)
        for filled in _answered(form, item):
            waiting += self._take_in(self._made(filled.content), False, _Raised(""), found)
        seen: set[str | None] = set()
        inside = set(map(id, inner))
        while waiting:
            one = waiting.pop()
            if one.event in seen:
                continue
            seen.add(one.event)
            for handler in self._takers(form, inner, one.event):
                if id(handler) not in inside:
                    inside.add(id(handler))
                    event = one.first or one.event or handler.events[0]
                    by = _Raised(one.event, event, one.code)
                    waiting += self._take_in(self._piece(handler), False, by, found)

    def _by_links(self, form: Form, item: Item) -> list[_Raised]:
        """The events of links: what the user says to one ends the question that listens (V1)."""
        links = (*form.links, *self._document.links)
        return [_Raised(one.event) for one in links if one.event and isinstance(item, Field)]

    @staticmethod
    def _take_in(
        piece: UnitPiece, inside: bool, by: _Raised, found: dict[int, Reached]
    ) -> list[_Raised]:
        """Add a piece of content, and the events that it throws in turn."""
        for command in piece.commands:
            found.setdefault(id(command), Reached(command, inside, by.first, by.code))
        computed = [_Raised(None, by.first, by.code or code) for code in sorted(piece.computed)]
        return computed + [_Raised(name, by.first, by.code) for name in sorted(piece.throws)]

    def _made(self, content: Sequence[Act]) -> UnitPiece:
        return UnitPiece(content, self._document)

    def _piece(self, handler: Handler) -> UnitPiece:
        if id(handler) not in self._pieces:
            self._pieces[id(handler)] = self._made(handler.content)
        return self._pieces[id(handler)]

    def _takers(
        self, form: Form, inner: tuple[Handler, ...], event: str | None
    ) -> Iterator[Handler]:
        """The handlers that may take an event in an item, without those never reached."""
        key = (form.id, event)
        if key not in self._taking:
            outer = (*form.handlers, *self._document.handlers)
            self._taking[key] = _taking(outer, event)
        certain = False
        for handler in (*_taking(inner, event), *self._taking[key]):
            if not certain or handler.count > 1:
                yield handler
            certain = certain or (event is not None and handler.count <= 1 and not handler.cond)


def _taking(handlers: Iterable[Handler], event: str | None) -> list[Handler]:
    """The handlers that take an event; all if its name is unknown."""
    if event is None:
        return [handler for handler in handlers if handler.events]
    return [one for one in handlers if any(takes(name, event) for name in one.events)]


def _own(item: Item) -> list[tuple[Act, ...]]:
    """The content of an item itself."""
    if isinstance(item, Block):
        return [item.content]
    return [one.content for one in item.filled] if isinstance(item, Field) else []


def _answered(form: Form, item: Item) -> Iterator[Filled]:
    """The content run with the answer to an item."""
    if isinstance(item, Field) and form.filled:
        asking = {one.name for one in all_items(form.items) if isinstance(one, Field | Subdialog)}
        yield from (one for one in form.filled if item.name in (one.names or asking))


def thrown_by(item: Item) -> Iterator[str]:
    """The events that visiting an item of a unit may throw."""
    yield "error.semantic"
    if isinstance(item, Field):
        yield from UNANSWERED
        yield from (f"error.device.{device}" for device in sorted(TABLE_4_2[QUESTION].devices))
        yield f"error.unsupported.{QUESTION}"
