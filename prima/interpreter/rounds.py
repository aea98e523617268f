"""Handlers of events that an application causes itself, and those that lead to themselves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from prima.errors import Problem
from prima.errors.diagnoses.behaviour import ENDLESS
from prima.interpreter.acts import (
    Act,
    Assign,
    CommandRun,
    Handler,
    Log,
    SendOut,
    Throw,
    all_acts,
    commands_of,
    run_commands,
)
from prima.interpreter.elements import Document, all_items
from prima.interpreter.selection import prefixes

AGAIN = ENDLESS.says(
    "This reaction to {event} leads to itself again without a wait: no other application has a turn.",
    'Leave out reactive="true", or put <pause time="..."/> first.',
)

PAUSE = "pause"


MOST_FOLLOWED = 100_000
"""Maximum number of handlers and events followed for one document."""

Raised = Callable[[Sequence[Act]], set[str]]
"""Finds the events that content raises."""


class EventLeads:
    """The handlers that others lead to by the events they raise; their number is limited.

    Args:
        raised: finds the events that content raises.
    """

    def __init__(self, raised: Raised) -> None:
        self._raised = raised
        self._by_event: dict[str, list[Handler]] = {}
        self._events: dict[int, list[str]] = {}
        """The names of the events of handlers followed so far."""
        self.left = MOST_FOLLOWED
        """The number of handlers and events still to be followed; below 0 nothing is certain."""

    def among(self, handlers: Sequence[Handler]) -> None:
        """Consider only some handlers from now on."""
        self.left -= len(handlers)
        self._by_event = {}
        for one in handlers if self.left > 0 else ():
            for event in dict.fromkeys(one.events):
                self._by_event.setdefault(event, []).append(one)

    def of(self, handler: Handler) -> Iterator[Handler]:
        """The handlers of the events that a handler raises, directly or indirectly, once each."""
        events: set[str] = set()
        found: set[int] = set()
        left = [handler]
        while left:
            taken = [one for one in self._raised_by(left.pop()) if one not in events]
            events.update(taken)
            for one in (one for event in taken for one in self._by_event.get(event, ())):
                self.left -= 1
                if self.left < 0:
                    return
                if id(one) not in found:
                    found.add(id(one))
                    left.append(one)
                    yield one

    def _raised_by(self, handler: Handler) -> list[str]:
        if id(handler) not in self._events:
            raised = self._raised(handler.content)
            under = {one for name in raised for one in prefixes(name)}
            self._events[id(handler)] = sorted(under)
        self.left -= len(self._events[id(handler)])
        return self._events[id(handler)]

    def round(self, handler: Handler) -> bool:
        """Whether a handler leads to itself again, as far as that is followed."""
        return any(one is handler for one in self.of(handler)) or self.left < 0


def raised_in(content: Sequence[Act]) -> set[str]:
    """The events that content raises without a wait: ends of its Commands, and throws."""
    ends = {f"end.{command.type}" for command in commands_of(content)}
    thrown = [act.event for act in all_acts(content) if isinstance(act, Throw)]
    return ends | {name for name in thrown if isinstance(name, str)}


def endless_reactions(document: Document) -> Iterator[Problem]:
    """Warn of reactions to own events that lead to themselves: no other has a turn (S2b).

    Only certain ones: without conditions, and with nothing in between that would let a reaction of
    another application go first, such as a question, a pause or a second Command.
    """
    reported: set[int] = set()
    leads, everywhere = EventLeads(raised_first), _certain(document.handlers)
    alone = False
    for form in document.forms.values():
        before = _certain(form.handlers)
        behind = [one for item in all_items(form.items) for one in _certain(item.handlers)]
        if before or behind or not alone:  # the document's own alone need checking only once
            leads.among([*before, *everywhere, *behind])
            yield from _endless([*before, *everywhere, *behind], leads, reported)
        alone = alone or not (before or behind)


def _endless(scope: Sequence[Handler], leads: EventLeads, reported: set[int]) -> Iterator[Problem]:
    """Those of a scope that lead to themselves, and to none reported already."""
    behind: set[int] = set()
    """Those that lead to a reported one."""
    for handler in scope:
        again = False
        for one in leads.of(handler):
            again = again or one is handler
            if one.node.index in reported or one.node.index in behind:
                behind.add(handler.node.index)
                break
        if leads.left < 0:
            return
        if again and handler.node.index not in behind:
            reported.add(handler.node.index)
            yield AGAIN.at(handler.node.attribute_place("reactive"), event=handler.events[0])


def _certain(handlers: Sequence[Handler]) -> list[Handler]:
    """Handlers whose Commands are reactions by declaration, whatever the event."""
    return [one for one in handlers if one.reactive and one.cond is None and one.count <= 1]


def raised_first(content: Sequence[Act]) -> set[str]:
    """The events that content certainly raises at once or when its first Command ends."""
    found: set[str] = set()
    ran = False
    for act in content:
        match act:
            case CommandRun() if not ran:
                steps = [step for step in act.steps if not step.after]
                first = {command.type for command in run_commands(steps)}
                if PAUSE in first:
                    return found
                found |= {f"end.{name}" for name in first}
                ran = True
                if any(step.after for step in act.steps):
                    return found
            case Throw(event=str(name)):
                return found | {name}
            case Assign() | Log() | SendOut():
                continue
            case _:
                return found
    return found
