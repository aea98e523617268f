"""Events that an application causes itself: ends of its Commands, sends, watches, throws."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import takewhile

from prima.checks.prices.contents import handlers_of
from prima.checks.prices.model import Price
from prima.interpreter.acts import Act, Assign, CommandRun, Handler, Script, SendOut, all_acts
from prima.interpreter.elements import Document, Form
from prima.interpreter.rounds import EventLeads, Raised
from prima.interpreter.selection import prefixes, takes
from prima.interpreter.sensors import sensors_of

MOVED = ("human", "moving", "position")
"""Sensors whose values change because the robot moves."""
SEEN = ("human.found", "human.lost")
"""Events caused by the robot turning to the user or away."""
ANSWERS = ("reply", "error.service")
"""Events of services; the name of the service follows."""


def _handled_answers(document: Document) -> set[str]:
    """The events of services that a document handles."""
    events = {name for _, one in handlers_of(document) for name in one.events}
    return {
        name for name in events if any(takes(kind, name) or takes(name, kind) for kind in ANSWERS)
    }


class OwnEvents:
    """Finds the events that content causes in its own application."""

    def __init__(
        self,
        document: Document,
        parts: Iterable[Price],
        steps: Callable[[Sequence[Act]], list[Price]],
        at_once: Raised,
    ) -> None:
        self._document = document
        self._steps = steps
        self._at_once = at_once
        self._takes = sum(part.lasts for part in parts)
        """The duration (ms) of all of it: others may act before an event that comes later."""
        self._watches = [
            *document.watches,
            *(one for form in document.forms.values() for one in form.watches),
        ]
        sensors = [(one.name, sensors_of(one.when.code)) for one in self._watches]
        self._named = {under for one in self._watches for under in prefixes(one.name)}
        """All names and prefixes of events of watches."""
        self._anything = {name for name, of in sensors if of is None}
        """The watches that may read variables."""
        self._moved = {name for name, of in sensors if of is None or not of.isdisjoint(MOVED)}
        """The watches that may read the robot's position."""
        self._answers = _handled_answers(document)
        self._leads = EventLeads(self.raised)

    def leads_round(self, handler: Handler, form: Form | None) -> bool:
        """Whether a handler causes its own event again before others have had a turn."""
        if not handler.reactive and self._named.isdisjoint(handler.events):
            return False
        self._leads.among([*(form.handlers if form else ()), *self._document.handlers, handler])
        return self._leads.round(handler)

    def raised(self, content: Sequence[Act]) -> set[str]:
        """The events that content may raise before others have had a turn.

        One sent when a Command has ended comes later: a waiting reaction goes first.
        """
        found = set(self._at_once(content))
        for act in all_acts(tuple(takewhile(lambda one: not isinstance(one, CommandRun), content))):
            if isinstance(act, SendOut) and isinstance(act.delay, int) and act.delay < self._takes:
                found.add(act.event)
        if self._moves(content):
            return found | self._moved
        if any(isinstance(one, Assign | Script) for one in all_acts(content)):
            return found | self._anything
        return found

    def brought(self, content: Sequence[Act]) -> set[str]:
        """The outside events that content may cause, after others have had a turn."""
        found = set(SEEN) if self._moves(content) else set[str]()
        for act in all_acts(content):
            if isinstance(act, SendOut) and isinstance(act.service, str) and act.service:
                found.update(f"{name}.{act.service}" for name in ANSWERS)
            elif isinstance(act, SendOut) and act.service:
                found |= self._answers
        return found

    def _moves(self, content: Sequence[Act]) -> bool:
        return any("locomotion" in part.devices for part in self._steps(content))
