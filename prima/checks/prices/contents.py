"""Parts of a document in PRIMA's language: handlers, contents, units and own events."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from prima.interpreter.acts import (
    Act,
    CommandRun,
    Exit,
    Goto,
    Handler,
    If,
    Log,
    Return,
    SendOut,
    Throw,
    all_acts,
    commands_of,
)
from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Form,
    Item,
    Subdialog,
    Unit,
    all_items,
)
from prima.interpreter.entering import goes_to_item

ONCE = (CommandRun, Exit, Goto, If, Log, Return)
"""Acts that run once, or end a unit; a goto does if it leaves the form."""


def handlers_of(document: Document) -> Iterator[tuple[Form | None, Handler]]:
    """All handlers, each with its form; those of Commands are of their own events."""
    yield from ((None, one) for one in document.handlers)
    for form in document.forms.values():
        yield from ((form, one) for one in form.handlers)
        for item in all_items(form.items):
            yield from ((form, one) for one in item.handlers)


def hooks_of(document: Document) -> Iterator[tuple[Form | None, Handler]]:
    """The handlers in Commands, each with the form of its Command."""
    for form, content, _ in document.contents():
        for command in commands_of(content):
            yield from ((form, one) for one in command.handlers)


def own_contents(item: Item) -> list[Sequence[Act]]:
    """The content of an item without its handlers."""
    if isinstance(item, Block):
        return [item.content]
    return [part.content for part in item.filled] if isinstance(item, Field | Subdialog) else []


def contents_of(part: Item | Handler) -> list[Sequence[Act]]:
    """The content of an item, or of a handler."""
    return [part.content] if isinstance(part, Handler) else own_contents(part)


def inside(unit: Unit) -> list[Item | Handler]:
    """The content of a unit: its items, and the handlers of both."""
    found: list[Item | Handler] = [*unit.handlers]
    for item in unit.items:
        found += [item, *item.handlers]
    return found


def runs_once(content: Sequence[Act]) -> bool:
    """Whether nothing in content makes it, or other content, run again before its end."""
    acts = all_acts(content)
    return all(isinstance(act, ONCE) and not goes_to_item(act) for act in acts)


def sent_by(document: Document) -> set[str]:
    """The events that the application sends to itself."""
    acts = [act for _, content, _ in document.contents() for act in all_acts(content)]
    return {act.event for act in acts if isinstance(act, SendOut) and act.event}


def thrown_by(document: Document) -> set[str]:
    """The events that the application throws itself."""
    scopes: list[Document | Form] = [document, *document.forms.values()]
    events = {link.event for scope in scopes for link in scope.links}
    for _, content, _ in document.contents():
        thrown = [act.event for act in all_acts(content) if isinstance(act, Throw | Return)]
        events |= {event for event in thrown if isinstance(event, str)}
    return events - {""}
