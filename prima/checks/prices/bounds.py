"""Bounds: how long an application runs without waiting for an event, and endless loops."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from prima.checks.prices.model import (
    EndlessLoop,
    Gap,
    Outline,
    Price,
    PricedReaction,
    PricedState,
    devices_of,
)
from prima.digraphs import rings
from prima.errors import Place
from prima.markup.tree import Node

MANY_STATES = 8
"""Maximum number of states named in a loop."""
MOST_COMPARED = 200_000
"""Limit of reactions times what they may lead to, above which they are not followed separately."""


@dataclass(slots=True)
class Busy:
    """Activity without a wait: its duration (ms), and why it may be longer."""

    lasts: int = 0
    endless: list[Gap] = field(default_factory=list)
    """Why it may have no end."""
    unknown: list[Gap] = field(default_factory=list)
    """Why its length is not known."""


def closure(outline: Outline, starts: Iterable[str]) -> list[PricedState]:
    """All states reachable without a wait, including the start states.

    A subdialog returns to all its possible callers.
    """
    if outline.backwards is None:
        outline.backwards = _backwards(outline)
    before, callers = outline.backwards
    found: set[str] = set()
    leading: set[str] = set()
    """States that lead to one that has been found; they may return to their callers."""
    onward, backward = [*starts], list[str]()
    while onward or backward:
        if onward:
            name = onward.pop()
            if name in outline.states and name not in found:
                found.add(name)
                onward += _ways(outline, name)
                backward.append(name)
        elif (name := backward.pop()) not in leading:
            leading.add(name)
            backward += before.get(name, ())
            onward += callers.get(name, ())
    return [state for name, state in outline.states.items() if name in found]


def _backwards(outline: Outline) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    """The predecessors and the callers of each state."""
    before: dict[str, list[str]] = {}
    callers: dict[str, list[str]] = {}
    for name, state in outline.states.items():
        for to in _ways(outline, name):
            before.setdefault(to, []).append(name)
        for to in state.calls:
            callers.setdefault(to, []).append(name)
    return before, callers


def _after(outline: Outline, reaction: PricedReaction) -> list[PricedState]:
    """The activity of a reaction, and the states that it leads to or that continue alongside it."""
    starts = [*reaction.does.goes, *reaction.does.calls]
    if reaction.stays is not None:
        starts += [reaction.stays] if reaction.stays else list(outline.states)
    return [reaction.does, *closure(outline, starts)]


def busy_after_each(outline: Outline, reactions: Sequence[PricedReaction]) -> list[Busy]:
    """The longest activity caused by each of some events.

    For very many events, the longest activity whatever starts it, for each.
    """
    if len(reactions) * size(outline) > MOST_COMPARED:
        return [busy_at_all(outline)] * len(reactions)
    return [_busy(outline, _after(outline, one)) for one in reactions]


def size(outline: Outline) -> int:
    """The size of an application for this analysis."""
    held = sum(len(state.parts) + len(state.unknown) for state in outline.states.values())
    return len(outline.states) + len(outline.parts) + len(outline.gaps) + held


def busy_at_all(outline: Outline) -> Busy:
    """The longest activity without a wait, whatever starts it."""
    does = [one.does for one in outline.handled]
    return _busy(outline, [*outline.states.values(), *does, *outline.wakes])


def _busy(outline: Outline, states: list[PricedState]) -> Busy:
    found = Busy(unknown=list(outline.gaps))
    names = {state.name for state in states}
    for loop in loops(outline):
        if not loop.states.isdisjoint(names):
            found.endless.append(Gap(loop.place, loop.what))
    for state in states:
        parts = {id(part): part for part in state.parts}.values()
        found.lasts += state.times * sum(part.lasts for part in parts)
        found.endless += [
            Gap(part.place, f"{part.what} goes on until its goal is reached")
            for part in state.parts
            if part.loops
        ]
        found.unknown += [Gap(one.place, one.unknown) for one in state.parts if one.unknown]
        found.unknown += state.unknown
    return found


def loops(outline: Outline) -> list[EndlessLoop]:
    """Cycles of states without a wait, and questions repeated endlessly."""
    if outline.loops is None:
        found = (_loop_of(outline, states) for states in _cycles(outline))
        outline.loops = [loop for loop in found if loop.devices]
    return outline.loops


def _loop_of(outline: Outline, states: list[PricedState]) -> EndlessLoop:
    """The loop of states that lead to each other, or of one that asks repeatedly."""
    names = frozenset(state.name for state in states)
    parts = [part for state in _with_called(outline, states) for part in state.parts]
    first = min(states, key=lambda state: state.node.index)
    repeats = [one for state in states for one in state.repeats]
    if len(states) == 1 and first.name not in first.goes and repeats:
        return _loop(repeats[0].place, repeats[0].reason, parts, names)
    place = _way_back(states, names, first.node).place
    more = ", ..." if len(states) > MANY_STATES else ""
    listed = ", ".join(state.name for state in states[:MANY_STATES]) + more
    follows = "follow one another" if len(states) > 1 else "follows itself"
    return _loop(place, f"{listed} {follows} without a wait for an event", parts, names)


def _way_back(states: list[PricedState], names: frozenset[str], otherwise: Node) -> Node:
    """The first element that leads from one of the states to another."""
    ways = [node for state in states for to, node in state.goes.items() if to in names]
    return min(ways, key=lambda node: node.index, default=otherwise)


def _with_called(outline: Outline, states: list[PricedState]) -> list[PricedState]:
    """Some states, and those that their subdialogs lead to, which run in every round."""
    called: set[str] = set()
    left = [callee for state in states for callee in state.calls]
    while left:
        name = left.pop()
        if name in outline.states and name not in called:
            called.add(name)
            left += _ways(outline, name)
    own = {state.name for state in states}
    return [*states, *(outline.states[one] for one in outline.states if one in called - own)]


def _loop(place: Place, what: str, parts: list[Price], names: frozenset[str]) -> EndlessLoop:
    engages = any(part.engages for part in parts)
    leaves = all(part.leaves for part in parts)
    return EndlessLoop(place, what, devices_of(parts), engages, leaves, names)


def _cycles(outline: Outline) -> list[list[PricedState]]:
    """The cycles of states."""
    order = {name: at for at, name in enumerate(outline.states)}
    found = rings(outline.states, lambda name: _ways(outline, name))
    sets = [sorted(ring, key=order.__getitem__) for ring in found]
    return [
        [outline.states[one] for one in ring]
        for ring in sorted(sets, key=lambda ring: order[ring[0]])
        if len(ring) > 1 or ring[0] in _ways(outline, ring[0]) or outline.states[ring[0]].repeats
    ]


def _ways(outline: Outline, name: str) -> list[str]:
    """The successors of a state."""
    state = outline.states[name]
    return [to for to in (*state.goes, *state.calls) if to in outline.states]
