"""How long an application goes on without waiting for an event, and where it may never end."""

from __future__ import annotations

from collections.abc import Iterable

from prima.deferred import dataclass, field
from prima.errors import Place
from prima.prices.model import Gap, Outline, Price, Reaction, State, devices_of


@dataclass(slots=True)
class Busy:
    """What an application may do in one go: its length (ms), and why it may be longer."""

    lasts: int = 0
    endless: list[Gap] = field(default_factory=list)
    """Why it may have no end."""
    unknown: list[Gap] = field(default_factory=list)
    """Why its length is not known."""


@dataclass(slots=True)
class Loop:
    """Something that may go on without an end and without a wait for an event."""

    place: Place
    what: str
    devices: frozenset[str]
    engages: bool
    leaves: bool
    """Whether all of it leaves the user: then it ranks below what does not (K2)."""
    states: frozenset[str]


def closure(outline: Outline, starts: Iterable[str]) -> list[State]:
    """All states that some lead to without a wait, themselves included.

    What a subdialog leads to comes back to whoever may have called it.
    """
    found = {name for name in starts if name in outline.states}
    called = {
        name: {one for callee in state.calls for one in (callee, *_reach(outline, callee))}
        for name, state in outline.states.items()
        if state.calls
    }
    while True:
        more = {to for name in found for to in _reach(outline, name)}
        more |= {name for name, inner in called.items() if inner & (found | more)}
        if more <= found:
            return [state for name, state in outline.states.items() if name in found]
        found |= more


def _after(outline: Outline, reaction: Reaction) -> list[State]:
    """What a reaction does, and the states that it leads to or that go on beside it."""
    starts = [*reaction.does.goes, *reaction.does.calls]
    if reaction.stays is not None:
        starts += [reaction.stays] if reaction.stays else list(outline.states)
    return [reaction.does, *closure(outline, starts)]


def busy_after(outline: Outline, reaction: Reaction) -> Busy:
    """How long an application is busy because of an event at most."""
    return _busy(outline, _after(outline, reaction))


def busy_at_all(outline: Outline) -> Busy:
    """How long an application is busy in one go at most, whatever begins it."""
    does = [reaction.does for reaction in outline.reactions]
    return _busy(outline, [*outline.states.values(), *does, *outline.wakes])


def _busy(outline: Outline, states: list[State]) -> Busy:
    found = Busy(unknown=list(outline.gaps))
    names = {state.name for state in states}
    for loop in loops(outline):
        if loop.states & names:
            found.endless.append(Gap(loop.place, loop.what))
    for state in states:
        parts = {(id(part.node), part.what): part for part in state.parts}.values()
        found.lasts += state.times * sum(part.lasts for part in parts)
        found.endless += [
            Gap(part.place, f"{part.what} goes on until its goal is reached")
            for part in state.parts
            if part.loops
        ]
        found.unknown += [Gap(one.place, one.unknown) for one in state.parts if one.unknown]
        found.unknown += state.unknown
    return found


def loops(outline: Outline) -> list[Loop]:
    """Cycles of states without a wait, and questions that are asked again without an end."""
    found = []
    for states in _cycles(outline):
        names = frozenset(state.name for state in states)
        parts = [part for state in _with_called(outline, states) for part in state.parts]
        first = min(states, key=lambda state: state.node.index)
        told = [one for state in states for one in state.repeats]
        if len(states) == 1 and first.name not in first.goes and told:
            found.append(_loop(told[0].place, told[0].reason, parts, names))
            continue
        ways = [node for state in states for to, node in state.goes.items() if to in names]
        place = min(ways, key=lambda node: node.index).place if ways else first.node.place
        listed = ", ".join(state.name for state in states)
        follows = "follow one another" if len(states) > 1 else "follows itself"
        what = f"{listed} {follows} without a wait for an event"
        found.append(_loop(place, what, parts, names))
    return [loop for loop in found if loop.devices]


def _with_called(outline: Outline, states: list[State]) -> list[State]:
    """Some states, and those that their subdialogs lead to: they are done in every round."""
    called = {
        one
        for state in states
        for callee in state.calls
        for one in (callee, *_reach(outline, callee))
    }
    own = {state.name for state in states}
    return [*states, *(outline.states[one] for one in outline.states if one in called - own)]


def _loop(place: Place, what: str, parts: list[Price], names: frozenset[str]) -> Loop:
    engages = any(part.engages for part in parts)
    leaves = all(part.leaves for part in parts)
    return Loop(place, what, devices_of(parts), engages, leaves, names)


def _cycles(outline: Outline) -> list[list[State]]:
    """The states that lead back to themselves, by what leads round together."""
    ways = {name: _reach(outline, name) for name in outline.states}
    done: set[str] = set()
    found = []
    for name, state in outline.states.items():
        if name in done:
            continue
        ring = [one for one in outline.states if name in ways[one] and one in ways[name]]
        if name in ways[name]:
            done |= set(ring)
            found.append([outline.states[one] for one in ring])
        elif state.repeats:
            found.append([state])
    return found


def _reach(outline: Outline, name: str) -> set[str]:
    """The states that one leads to in one step or more."""
    found: set[str] = set()
    left = [name] if name in outline.states else []
    while left:
        state = outline.states[left.pop()]
        for to in (*state.goes, *state.calls):
            if to in outline.states and to not in found:
                found.add(to)
                left.append(to)
    return found
