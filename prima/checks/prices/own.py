"""Events that an application causes itself: ends of its Commands, sends, watches, throws."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import takewhile

from prima.checks.prices.model import Price
from prima.interpreter.acts import Act, Assign, Handler, Run, Script, SendOut, all_acts
from prima.interpreter.elements import Document, Form, Watch
from prima.interpreter.rounds import leads_round, raised_in
from prima.interpreter.selection import takes
from prima.interpreter.sensors import sensors_of

MOVED = ("human", "moving", "position")
"""Sensors whose values change because the robot moves."""


class OwnEvents:
    """Finds the events that content causes in its own application."""

    def __init__(
        self,
        document: Document,
        parts: Iterable[Price],
        steps: Callable[[Sequence[Act]], list[Price]],
    ) -> None:
        self._document = document
        self._steps = steps
        self._takes = sum(part.lasts for part in parts)
        """How long (ms) all of it takes: an event that comes later lets others in before it."""
        self._watches = [
            *document.watches,
            *(one for form in document.forms.values() for one in form.watches),
        ]

    def leads_round(self, handler: Handler, form: Form | None) -> bool:
        """Whether what a handler does makes its event come again before others have had a turn."""
        watched = any(takes(name, one.name) for name in handler.events for one in self._watches)
        if not (handler.reactive or watched):
            return False
        scope = [*(form.handlers if form else ()), *self._document.handlers, handler]
        return leads_round(handler, scope, self.raised)

    def raised(self, content: Sequence[Act]) -> set[str]:
        """The events that content may raise before others have had a turn.

        One that is sent when a Command has ended comes after that: a reaction that waits goes first.
        """
        found = raised_in(content)
        for act in all_acts(tuple(takewhile(lambda one: not isinstance(one, Run), content))):
            if isinstance(act, SendOut) and isinstance(act.delay, int) and act.delay < self._takes:
                found.add(act.event)
        return found | {one.name for one in self._watches if self._turns(one, content)}

    def _turns(self, watch: Watch, content: Sequence[Act]) -> bool:
        """Whether content may make a watched condition true: by moving the robot, or a variable."""
        sensors = sensors_of(watch.when.code)
        moves = any("locomotion" in part.devices for part in self._steps(content))
        if sensors is None:
            return moves or any(isinstance(one, Assign | Script) for one in all_acts(content))
        return moves and not sensors.isdisjoint(MOVED)
