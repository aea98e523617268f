"""What an application says a second time because an event has made it leave in the middle (O3)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from prima.errors import Problem
from prima.interpreter.elements import (
    Act,
    Assign,
    Block,
    Document,
    Field,
    Form,
    Goto,
    Handler,
    If,
    Item,
    Run,
    SendOut,
    Subdialog,
    Throw,
    Unit,
    all_acts,
    all_items,
    run_commands,
)
from prima.interpreter.events import beginnings
from prima.markup.tree import Node

OWN = ("noinput", "nomatch", "help", "end", "cancel", "interrupted", "exit", "error", "emergency")
"""What begins an event that comes of what the application itself does, or ends everything."""


MOST_STEPS = 100_000
"""Ways that are followed in one document: beyond, only a goto to the form itself is seen."""
Leaving = tuple[str, list[Goto]]
"""An event from outside, and the gotos by which its handler leaves."""
REMEDY = "Leave out the <goto>: what is said goes on then. Or give what is said a cond."


def told_twice(
    document: Document, foreign: Callable[[str], bool] | None = None, remedy: str = REMEDY
) -> Iterator[Problem]:
    """Warn of handlers that leave a state and come back to what it says or asks.

    An event may come while that is being said. Where the user has been asked something else on
    the way back, or the state waits for another event, telling it again is meant.

    Args:
        document: the document.
        foreign: whether a handler's event may come from outside; by default, what
            PRIMA's language has it to be.
        remedy: what to do about it.
    """
    ways = _Ways(document, foreign or _foreign(document))
    for form in document.forms.values():
        said = _said(form)
        if said is None:
            continue
        for event, way in ways.back(form):
            yield _problem(form, *said, event, way, remedy)


class _Ways:
    """Where handlers lead, and what that leads to; each is looked at once."""

    def __init__(self, document: Document, from_outside: Callable[[str], bool]) -> None:
        self._document = document
        self._from_outside = from_outside
        self._onward: dict[str, list[str]] = {}
        self._reached: dict[str, set[str]] = {}
        self._left = MOST_STEPS
        self._shared: dict[str, list[tuple[str, Goto]]] = {}
        """Where the document's own handlers lead back, by forms."""
        for event, gotos in self._of(document.handlers, document.handlers):
            ways = {name: way for way in reversed(gotos) for name in self._leads(way)}
            for name, way in ways.items():
                self._shared.setdefault(name, []).append((event, way))

    def back(self, form: Form) -> Iterator[tuple[str, Goto]]:
        """The events that may come while a form says something, and the gotos back to it."""
        yield from self._shared.get(form.id, ())
        own = [form.handlers, *(item.handlers for item in all_items(form.items))]
        scope = [*form.handlers, *self._document.handlers]
        for event, gotos in (one for handlers in own for one in self._of(handlers, scope)):
            way = next((one for one in gotos if form.id in self._leads(one)), None)
            if way is not None:
                yield event, way

    def _of(self, handlers: Iterable[Handler], scope: Sequence[Handler]) -> Iterator[Leaving]:
        for handler in handlers:
            gotos = self._gotos(handler, scope, ())
            event = next(filter(self._from_outside, handler.events), "") if gotos else ""
            if event and not _brings_news(handler):
                yield event, gotos

    def _gotos(
        self, handler: Handler, scope: Sequence[Handler], before: tuple[Handler, ...]
    ) -> list[Goto]:
        """The gotos of a handler, and of those of a scope that take what it throws."""
        gotos = [act for act in _gotos(handler.content) if isinstance(act.form, str)]
        before = (*before, handler)
        for act in all_acts(handler.content):
            if isinstance(act, Throw) and isinstance(act.event, str) and self._left > 0:
                self._left -= len(scope)
                names = set(beginnings(act.event))
                taker = next((one for one in scope if not names.isdisjoint(one.events)), None)
                if taker is not None and taker not in before:
                    gotos += self._gotos(taker, scope, before)
        return gotos

    def _leads(self, way: Goto) -> set[str]:
        """The forms to which a goto leads, at once or by way of others."""
        name = str(way.form)
        if self._left < 0:
            return {name}
        if name not in self._reached:
            self._reached[name] = self._reach(name)
        self._left -= len(self._reached[name])
        return self._reached[name]

    def _reach(self, name: str) -> set[str]:
        """The forms that entering one leads to, without a question and without a wait for events."""
        found: set[str] = set()
        left = [name]
        while left:
            name = left.pop()
            if name in self._document.forms and name not in found:
                found.add(name)
                if name not in self._onward:
                    self._onward[name] = [*_onward(self._document.forms[name].items)]
                left += self._onward[name]
        return found


def _brings_news(handler: Handler) -> bool:
    """Whether a handler keeps what the event tells: then it is something else that is told."""
    assigned = [act for act in all_acts(handler.content) if isinstance(act, Assign)]
    return any("event." in act.expr.code for act in assigned)


def _problem(form: Form, said: Node, asks: bool, event: str, way: Goto, remedy: str) -> Problem:
    what = "asks" if asks else "says"
    it = f"{form.node.tag} {form.id}" if form.id[:1] == "#" else f'{form.node.tag} "{form.id}"'
    message = (
        f'If "{event}" comes while the {it} {what} this (line {said.place.line}), it is told'
        f" twice: this leads back to the {form.node.tag}'s beginning."
    )
    return Problem(way.node.place, "warning", "told-twice", message, remedy)


def _said(form: Form) -> tuple[Node, bool] | None:
    """The first thing that a form says whenever it is entered, and whether it asks that."""
    for item in form.items:
        if item.cond is not None or item.expr is not None:
            continue
        said = _said_by(item)
        if said is not None:
            return said
    return None


def _said_by(item: Item) -> tuple[Node, bool] | None:
    if isinstance(item, Unit):
        return next((said for one in item.items if (said := _said_by(one))), None)
    if isinstance(item, Field):
        asked = (one.node for one in item.prompts if one.cond is None and one.text)
        return next(((node, True) for node in asked), None)
    for act in item.content if isinstance(item, Block) else ():
        for command in run_commands(act.steps) if isinstance(act, Run) else ():
            if command.text:
                return command.node, False
    return None


def _foreign(document: Document) -> Callable[[str], bool]:
    """Tells which events may come from outside, and are no answer to the application."""
    chosen = _chosen(document)
    return lambda event: chosen.isdisjoint(beginnings(event))


def _chosen(document: Document) -> set[str]:
    """Events that the application brings about itself, or that the user says by a link."""
    found = set(OWN)
    for _, content, _ in document.contents():
        for act in all_acts(content):
            if isinstance(act, SendOut | Throw) and isinstance(act.event, str) and act.event:
                found.add(act.event)
    links = [*document.links, *(one for form in document.forms.values() for one in form.links)]
    return found | {link.event for link in links if link.event}


def _gotos(content: Sequence[Act]) -> list[Goto]:
    return [act for act in all_acts(content) if isinstance(act, Goto)]


def _onward(items: Iterable[Item]) -> Iterator[str]:
    """Where the items of a form lead before one of them asks or calls another form."""
    for item in items:
        if isinstance(item, Field | Subdialog | Unit):
            return
        for act in _gotos(item.content) if isinstance(item, Block) else ():
            if isinstance(act.form, str):
                yield act.form
        if isinstance(item, Block) and item.cond is None and _left(item.content):
            return


def _left(content: Sequence[Act]) -> bool:
    """Whether content always goes elsewhere."""
    for act in content:
        if isinstance(act, Goto):
            return True
        complete = isinstance(act, If) and act.branches[-1][0] is None
        if isinstance(act, If) and complete and all(_left(one) for _, one in act.branches):
            return True
    return False
