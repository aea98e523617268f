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
from prima.interpreter.selection import takes
from prima.markup.tree import Node

OWN = ("noinput", "nomatch", "help", "end", "cancel", "interrupted", "exit", "error", "emergency")
"""What begins an event that comes of what the application itself does, or ends everything."""


REMEDY = "Leave out the <goto>: what is said goes on then. Or give what is said a cond."


def told_twice(
    document: Document, foreign: Callable[[str], bool] | None = None, remedy: str = REMEDY
) -> Iterator[Problem]:
    """Warn of handlers that leave a state and come back to what it says or asks.

    An event may come while that is being said. Where the user has been asked something else on
    the way back, or the state waits for another event, telling it again is meant.

    Args:
        document: the document.
        foreign: tells of a handler's event whether it may come from outside; by default, what
            PRIMA's language has it to be.
        remedy: what to do about it.
    """
    from_outside = foreign or _foreign(document)
    for form in document.forms.values():
        said = _said(form)
        if said is None:
            continue
        for handler in _heard(document, form):
            events = [one for one in handler.events if from_outside(one)]
            if not events or _brings_news(handler):
                continue
            way = _way_back(document, form, handler.content)
            if way is not None:
                yield _problem(form, *said, events[0], way, remedy)


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


def _heard(document: Document, form: Form) -> Iterator[Handler]:
    """The handlers that may take an event while a form says something."""
    yield from document.handlers
    yield from form.handlers
    for item in all_items(form.items):
        yield from item.handlers


def _foreign(document: Document) -> Callable[[str], bool]:
    """Tells which events may come from outside, and are no answer to the application."""
    chosen = _chosen(document)
    return lambda event: not any(takes(name, event) for name in chosen)


def _chosen(document: Document) -> set[str]:
    """Events that the application brings about itself, or that the user says by a link."""
    found = set(OWN)
    for _, content, _ in document.contents():
        for act in all_acts(content):
            if isinstance(act, SendOut | Throw) and isinstance(act.event, str) and act.event:
                found.add(act.event)
    links = [*document.links, *(one for form in document.forms.values() for one in form.links)]
    return found | {link.event for link in links if link.event}


def _way_back(document: Document, form: Form, content: Sequence[Act]) -> Goto | None:
    """The goto of a handler that leads back to a form, at once or by way of others."""
    for act in _gotos(content):
        if isinstance(act.form, str) and form.id in _reached(document, act.form):
            return act
    return None


def _gotos(content: Sequence[Act]) -> list[Goto]:
    return [act for act in all_acts(content) if isinstance(act, Goto)]


def _reached(document: Document, name: str) -> set[str]:
    """The forms that entering one leads to, without a question and without a wait for events."""
    found: set[str] = set()
    left = [name]
    while left:
        name = left.pop()
        if name in document.forms and name not in found:
            found.add(name)
            left += _onward(document.forms[name].items)
    return found


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
