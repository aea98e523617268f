"""The transitions that handlers and executable content cause, for both languages."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Sequence
from typing import ClassVar, Generic, TypeVar

from prima.graph.labels import NO_REPLY, AnswerLabel, condition, handled, joined, otherwise
from prima.graph.model import Graph
from prima.graph.throws import Taker, chosen
from prima.interpreter.selection import takes

ANY = "#:any"
"""The end of the key of what holds in all states; no key of a state ends so."""
MOST_DEEP = 4
"""Maximum depth of handlers that throw in turn."""
MOST_FOLLOWED = 2000
"""Maximum number of throws of one application that are followed."""
Act = TypeVar("Act")
Branches = Sequence[tuple[str | None, Sequence[Act]]]
"""The contents of an ``if`` with their conditions; that of ``else`` has none."""


class Transitions(ABC, Generic[Act]):
    """Adds transitions to a graph, from the state ``here`` or from all states."""

    goes_on: ClassVar[Collection[str]]
    """Events after which the application goes on if no handler takes them."""

    def __init__(self, title: str) -> None:
        self.graph = Graph(title)
        self.here = ANY
        self.hints: dict[str, list[str]] = {}
        """The known sources of events."""
        self.scopes: list[Sequence[Taker[Act]]] = []
        """The handlers that may take a thrown event, innermost first."""
        self.thrown: list[str] = []
        """The events that are being followed to their handlers; these may throw in turn."""
        self.followed = 0
        """The number of throws that have been followed."""

    # What a language defines ------------------------------------------------------------------

    @abstractmethod
    def _leaves(self, act: Act, label: str) -> bool:
        """Add the transition of an act that leaves its content; return whether it does."""

    @abstractmethod
    def _passes(self, act: Act, base: str, conditions: list[str], reply: AnswerLabel) -> None:
        """Add the transitions of an act behind which its content goes on."""

    @abstractmethod
    def _branches(self, act: Act) -> Branches[Act]:
        """The branches of an ``if``; none of other acts."""

    @abstractmethod
    def _states(self) -> Iterable[tuple[str, Sequence[Taker[Act]]]]:
        """The states in which the document's handlers are active, with their own handlers."""

    # What both share --------------------------------------------------------------------------

    def content(
        self,
        acts: Sequence[Act],
        base: str,
        held: Sequence[str] = (),
        reply: AnswerLabel = NO_REPLY,
    ) -> bool:
        """Add all transitions of content; return whether it never reaches its end."""
        conditions = list(held)
        for act in acts:
            if self._leaves(act, joined(base, conditions)):
                return True
            if branches := self._branches(act):
                over, left = self._branch(branches, base, conditions, reply)
                if over:
                    return True
                conditions += left
            else:
                self._passes(act, base, conditions, reply)
        return False

    def _branch(
        self, branches: Branches[Act], base: str, conditions: list[str], reply: AnswerLabel
    ) -> tuple[bool, list[str]]:
        """Add the transitions of an ``if``; return whether it never ends, and what holds after it."""
        ends: list[bool] = []
        earlier: list[str] = []
        for cond, acts in branches:
            one = otherwise(earlier) if cond is None else condition(cond, reply)
            ends.append(self.content(acts, base, [*conditions, one], reply))
            earlier.append(one)
        complete = branches[-1][0] is None
        return all(ends) and complete, [otherwise(earlier)] if any(ends) and not complete else []

    def handlers(self, handlers: Iterable[Taker[Act]], where: str = "", of: str = "") -> None:
        """Add the transitions of handlers, also that they stay if they are not ``of`` a Command."""
        for one in handlers:
            label = handled(one.events, one.count, one.cond, self.hints)
            self.content(one.acts, f"{where}{label}{of}")
            if not of and one.named:
                self._stay(one, label)

    def _stay(self, handler: Taker[Act], label: str) -> None:
        if handler.stays and not self.here.endswith(ANY):
            self.graph.edge(self.here, self.here, "stay", label)

    def throw(self, event: str, label: str) -> None:
        """Add the transitions of handlers that take a thrown event, unless it is being followed."""
        if event in self.thrown or len(self.thrown) == MOST_DEEP:
            return
        self.followed += 1
        if self.followed > MOST_FOLLOWED:
            return
        self.thrown.append(event)
        if self.here.endswith(ANY):
            self._throw_in_states(event, label)
        self._taken(event, label)
        self.thrown.pop()

    def _throw_in_states(self, event: str, label: str) -> None:
        """Events that the document's handlers throw go to a state's own handlers first."""
        here, scopes = self.here, self.scopes
        for key, handlers in self._states():
            if any(_takes(one, event) for one in handlers):
                self.here, self.scopes = key, [handlers]
                self._taken(event, label, ends=False)
        self.here, self.scopes = here, scopes

    def _taken(self, event: str, label: str, ends: bool = True) -> None:
        found, always = chosen(one for scope in self.scopes for one in scope if _takes(one, event))
        label = f"{label}, throws {event}"
        for one in found:
            self.content(one.acts, one.label(label))
            self._stay(one, one.label(label))
        if ends and not always and not any(takes(name, event) for name in self.goes_on):
            self.graph.edge(self.here, "", "exit", label)


def _takes(handler: Taker[Act], event: str) -> bool:
    return any(takes(name, event) for name in handler.events)
