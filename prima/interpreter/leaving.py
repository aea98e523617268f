"""Handlers that leave a form in mid-speech, and what it says on coming back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    CommandRun,
    Goto,
    Handler,
    all_acts,
    run_commands,
)
from prima.interpreter.elements import Block, Field, Form, Item, Unit
from prima.interpreter.entering import is_left
from prima.interpreter.selection import beginnings
from prima.markup.tree import Node


@dataclass(frozen=True, slots=True)
class Leaving:
    """A handler of an outside event that leaves the form, or goes to an item of it."""

    event: str
    count: int
    gotos: list[Goto]
    cleared: dict[str, None] | None
    """The names of the items then visited again; None for all."""
    item: Item | None
    """The item with the handler, if it belongs to one."""

    def hidden(self, form: Form) -> bool:
        """Whether a form has a handler of its own that takes the event instead."""
        names = set(beginnings(self.event)) if form.handlers and self.count <= 1 else set[str]()
        return any(
            one.cond is None and one.count <= 1 and not names.isdisjoint(one.events)
            for one in form.handlers
        )

    def repeated(self, item: Item) -> tuple[Node, bool] | None:
        """The item's first speech, if another visit repeats it, and whether it is a question."""
        cleared = self.cleared is None or item.name in self.cleared
        counts = {one.count for one in item.prompts} if isinstance(item, Field) else set[int]()
        return said_by(item) if cleared or 2 not in counts else None  # its words differ then


def cleared_by(acts: Iterable[Act]) -> dict[str, None] | None:
    """The names of items that acts clear; None for all."""
    cleared = [act.names for act in acts if isinstance(act, Clear)]
    if not all(cleared):
        return None
    return dict.fromkeys(name for names in cleared for name in names)


def goes_by(item: Item) -> bool:
    """Whether an item neither waits for anything nor leaves the form."""
    return isinstance(item, Block) and not is_left(item.content)


def brings_news(handler: Handler) -> bool:
    """Whether a handler keeps data of the event, which may change what is said afterwards."""
    assigned = [act for act in all_acts(handler.content) if isinstance(act, Assign)]
    return any("event." in act.expr.code for act in assigned)


def said_first(form: Form) -> tuple[Node, bool] | None:
    """The element of a form's first speech on each entry, and whether it is a question."""
    for item in form.items:
        if item.cond is not None or item.expr is not None:
            continue
        said = said_by(item)
        if said is not None:
            return said
    return None


def said_by(item: Item) -> tuple[Node, bool] | None:
    """The element of an item's first speech, and whether it is a question."""
    if isinstance(item, Unit):
        return next(filter(None, map(said_by, item.items)), None)
    said = next(_asked(item) if isinstance(item, Field) else _told(item), None)
    return None if said is None else (said, isinstance(item, Field))


def _asked(field: Field) -> Iterator[Node]:
    return (one.node for one in field.prompts if not one.cond and one.count <= 1 and one.text)


def _told(item: Item) -> Iterator[Node]:
    for act in item.content if isinstance(item, Block) else ():
        if isinstance(act, CommandRun):
            yield from (command.node for command in run_commands(act.steps) if command.text)
