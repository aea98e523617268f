"""Reactions that lead to themselves again, so that an application may keep the floor for ever."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prima.checks.prices.model import Gap, Outline, PricedReaction, PricedState
from prima.digraphs import rings

Node = tuple[str, str | int]
"""A reaction by its number, or a state or an event by its name."""


def reacting_again(outline: Outline) -> list[Gap]:
    """Where an application reacts to the results of its own reactions, including from outside."""
    found = [one.made for one in outline.reactions if one.made]
    starts: list[Node] = [("reaction", number) for number in range(len(outline.reactions))]
    for ring in rings(starts, _Ways(outline)):
        found += _gaps(outline, ring)
    return list(dict.fromkeys(found))


def _gaps(outline: Outline, ring: Iterable[Node]) -> Iterator[Gap]:
    """The gap of a cycle of nodes, if it contains Commands."""
    held: dict[str, list[str | int]] = {"state": [], "event": [], "reaction": []}
    for kind, name in ring:
        held[kind].append(name)
    reactions = [outline.reactions[int(number)] for number in held["reaction"]]
    states = [*(one.does for one in reactions), *_states(outline, held["state"])]
    if not (held["event"] and reactions and any(state.parts for state in states)):
        return
    first = min(reactions, key=lambda one: one.node.index)
    if first.made is None:
        yield Gap(first.node.place, _again(first, set(map(str, held["event"]))))


def _again(reaction: PricedReaction, events: set[str]) -> str:
    event = next(one for one in reaction.events if one in events)
    return f"what is done about {event} may bring it again"


def _states(outline: Outline, names: Iterable[str | int]) -> Iterator[PricedState]:
    return (outline.states[str(name)] for name in names if name in outline.states)


class _Ways:
    """The consequences of a reaction, a state or an event."""

    def __init__(self, outline: Outline) -> None:
        self._outline = outline
        self._takers: dict[str, list[Node]] = {}
        self._callers: dict[str, list[Node]] = {}
        for number, one in enumerate(outline.reactions):
            for event in one.events if one.often is None else ():
                self._takers.setdefault(event, []).append(("reaction", number))
        for name, state in outline.states.items():
            for to in state.calls:
                self._callers.setdefault(to, []).append(("state", name))

    def __call__(self, node: Node) -> Iterator[Node]:
        kind, name = node
        if kind == "event":
            yield from self._takers.get(str(name), ())
            longer = str(name).rpartition(".")[0]
            if longer:  # a handler takes all events with its event as a prefix
                yield ("event", longer)
        elif kind == "state":
            state = self._outline.states[str(name)]
            yield from self._after(state, state.onward)
            yield from self._callers.get(str(name), ())
        else:
            does = self._outline.reactions[int(name)].does
            yield from self._after(does, does.goes)

    def _after(self, state: PricedState, goes: Iterable[str]) -> Iterator[Node]:
        for name in (*goes, *state.calls):
            if name in self._outline.states:
                yield ("state", name)
        for event in sorted(state.brings):
            yield ("event", event)
