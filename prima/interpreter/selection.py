"""Decisions of the Form Interpretation Algorithm, for both languages (VoiceXML 2.0, appendix C).

Which item is visited next, which handler takes an event, which prompts are said, which
``filled`` run. The languages differ in their items and handlers, so only the relevant facts are
passed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Generic, NamedTuple, TypeVar

T = TypeVar("T")

MOST_KEPT = 10_000
"""Maximum number of handlers, each with each event that it takes, that are kept."""
MOST_PARTS = 100
"""Maximum number of dots considered in an event's name."""


class Candidate(NamedTuple, Generic[T]):
    """A handler with the names by which it takes events, and its count."""

    handler: T
    names: tuple[str, ...]
    least: int


class Takers(dict[Hashable, list[Candidate[T]]]):
    """The handlers that take events, by the event and where it occurs, for events that come again."""

    _room = MOST_KEPT

    def keep(self, key: Hashable, found: list[Candidate[T]]) -> None:
        """Keep the handlers that take an event; all others are forgotten if they are too many."""
        if self._room <= len(found):
            self.clear()
            self._room = MOST_KEPT
        self._room -= 1 + len(found)
        self[key] = found


@dataclass(frozen=True, slots=True)
class Counters:
    """How often events occurred, and items were visited, while their dialog is active (2.1.6.1)."""

    events: Mapping[tuple[Hashable, str], int] = field(default_factory=dict)
    """By the visited item, and the name counted."""
    prompts: Mapping[Hashable, int] = field(default_factory=dict)

    def came(self, item: Hashable, names: Iterable[str]) -> Counters:
        """Count an event while an item was visited, under each of its names (5.2.2)."""
        more = {(item, name): self.seen(item, name) + 1 for name in names}
        return replace(self, events={**self.events, **more})

    def seen(self, item: Hashable, name: str) -> int:
        """How often events of a name occurred while an item was visited."""
        return self.events.get((item, name), 0)

    def asked(self, item: Hashable) -> Counters:
        """Count a visit of an item that asks (4.1.6)."""
        return replace(self, prompts={**self.prompts, item: self.prompts.get(item, 0) + 1})

    def without(self, item: Hashable) -> Counters:
        """The counters after a clear of an item (5.3.3)."""
        kept = {key: times for key, times in self.events.items() if key[0] != item}
        return Counters(kept, {**self.prompts, item: 0})


def takes(handler_event: str, event: str) -> bool:
    """Whether a handler's event name is the event's, or a token-wise prefix of it."""
    return not handler_event or event == handler_event or event.startswith(f"{handler_event}.")


def beginnings(event: str) -> list[str]:
    """The names under which handlers take an event: its prefixes, and its own."""
    parts = event.split(".", MOST_PARTS)
    return [".".join(parts[:count]) for count in range(1, len(parts) + 1)]


def prefixes(event: str) -> list[str]:
    """All names under which an event counts: these, and the empty one, which takes all events."""
    return ["", *beginnings(event)]


def taking(
    handlers: Iterable[Candidate[T]], event: str, by_name: bool = False
) -> list[Candidate[T]]:
    """The handlers that take an event, each with the matching names.

    Args:
        handlers: those in scope, innermost first.
        event: its name.
        by_name: whether the empty name, which takes all events, does not take this one.
    """
    found = []
    for handler, names, least in handlers:
        fitting = tuple(one for one in names if takes(one, event) and (one or not by_name))
        if fitting:
            found.append(Candidate(handler, fitting, least))
    return found


def select_handler(
    candidates: Iterable[Candidate[T]], seen: Callable[[str], int], holds: Callable[[T], bool]
) -> T | None:
    """The handler of an event among those that take it (5.2.4).

    Those whose condition does not hold are left out, whatever their count; of the rest, those
    with the highest count that the occurrences have reached remain, and the first is selected.
    """
    fitting = (
        (one.least, one.handler)
        for one in candidates
        if holds(one.handler) and (one.least <= 1 or one.least <= max(map(seen, one.names)))
    )
    return next(iter(of_highest_count(fitting)), None)


def select_prompts(
    prompts: Iterable[tuple[int, T]], asked: int, holds: Callable[[T], bool]
) -> list[T]:
    """The prompts of an item's ``asked``-th visit, from prompts with counts (4.1.6)."""
    return of_highest_count((least, one) for least, one in prompts if holds(one) and least <= asked)


def of_highest_count(found: Iterable[tuple[int, T]]) -> list[T]:
    """Those with the highest count, in document order."""
    counted = list(found)
    highest = max((count for count, _ in counted), default=0)
    return [one for count, one in counted if count == highest]


def select_item(
    items: Sequence[T],
    wanted: str,
    named: Callable[[T, str], bool],
    first_undefined: Callable[[Sequence[T]], int],
    holds: Callable[[T], bool],
) -> T | None:
    """The item to visit: the one that a goto names, or the first open one (2.1.6.2).

    Args:
        items: form items, and units with items inside.
        wanted: the name of one of these.
        named: whether an item has a name, or is a unit around the one that has.
        first_undefined: the index of the first item whose variable is undefined, or their number.
        holds: whether an item's condition holds; evaluating it may define items.
    """
    if wanted:
        return next((item for item in items if named(item, wanted)), None)
    at = first_undefined(items)
    while at < len(items):
        if holds(items[at]):
            return items[at]
        at += 1 + first_undefined(items[at + 1 :])
    return None


def satisfied(
    mode: str, items: Collection[T], filled: Collection[T], is_defined: Callable[[T], bool]
) -> bool:
    """Whether a form's ``filled`` for some items runs, once others have been filled (2.4)."""
    if not any(item in filled for item in items):
        return False
    return (any if mode == "any" else all)(map(is_defined, items))
