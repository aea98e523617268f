"""How one application affects another: waits of its reactions, and starvation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import islice

from prima.certificate.model import Delay, Starving
from prima.checks.prices import Gap, Outline, Price, PricedReaction, worst
from prima.checks.prices.again import reacting_again
from prima.checks.prices.bounds import (
    MOST_COMPARED,
    Busy,
    busy_after_each,
    busy_at_all,
    closure,
    loops,
    size,
)
from prima.checks.prices.model import EndlessLoop, devices_of
from prima.interpreter.selection import prefixes, takes

ANY_EVENT = "any event"
"""Represents each event of an application that has too many to check individually."""
MOST_ENDLESS = 100
"""Maximum number of loops listed for one reaction to its own events."""


def related(one: PricedReaction, other: PricedReaction) -> bool:
    """Whether two reactions may be to the same event."""
    if one.words is not None and other.words is not None and not one.words & other.words:
        return False  # the links share no utterance
    pairs = ((name, its) for name in one.events for its in other.events)
    return any(takes(name, its) or takes(its, name) for name, its in pairs)


class _Other:
    """An application for which another waits, and the data common to all waits for it."""

    def __init__(self, outline: Outline) -> None:
        self.outline = outline
        self.parts, self.gaps = outline.parts, outline.gaps
        self.foreign = [one for one in outline.reactions if one.often is None]
        """The reactions to events that it does not cause itself."""

    @cached_property
    def size(self) -> int:
        """The number of things to check for each event."""
        return size(self.outline) + sum(len(one.events) for one in self.outline.reactions)

    @cached_property
    def at_all(self) -> Busy:
        """The longest time for which it is busy, whatever begins it."""
        return busy_at_all(self.outline)

    @cached_property
    def after(self) -> list[Busy]:
        """How long it is busy because of each event that it does not cause itself."""
        return busy_after_each(self.outline, self.foreign)

    @cached_property
    def joined(self) -> list[Busy]:
        """How long it is busy because of each event to which it does not react, as :attr:`after`."""
        return busy_after_each(self.outline, self.outline.joins)

    @cached_property
    def later(self) -> list[Gap]:
        """Why anything of it may take longer."""
        does = [one.does for one in self.outline.handled]
        states = [*self.outline.states.values(), *does, *self.outline.wakes]
        return list(dict.fromkeys(gap for state in states for gap in state.unknown))

    @cached_property
    def rounds(self) -> list[list[Gap]]:
        """For each reaction, the endless activity that causes its event repeatedly."""
        raising: dict[str, dict[int, EndlessLoop]] = {}
        for number, loop in enumerate(loops(self.outline)):
            raised = {name for one in loop.states for name in self.outline.states[one].raises}
            for event in {under for name in raised for under in prefixes(name)}:
                raising.setdefault(event, {})[number] = loop
        return [
            [Gap(loop.place, loop.what) for loop in _some(raising, one)]
            for one in self.outline.reactions
        ]


def _some(
    raising: dict[str, dict[int, EndlessLoop]], reaction: PricedReaction
) -> Iterable[EndlessLoop]:
    """The first loops that cause the event of a reaction to one of the application's own events."""
    if reaction.often is None:
        return ()
    found: dict[int, EndlessLoop] = {}
    for event in reaction.events:
        found |= dict(islice(raising.get(event, {}).items(), MOST_ENDLESS))
    return [found[number] for number in sorted(found)[:MOST_ENDLESS]]


def delays(own: Outline, theirs: Outline) -> list[Delay]:
    """The waits of each reaction of ``own`` for ``theirs``; if there are very many, one for all."""
    other, asking = _Other(theirs), [one for one in own.reactions if one.firsts]
    held = [len(one.events) * (1 + len(one.firsts) + len(one.responds)) for one in asking]
    if sum(held) * other.size > MOST_COMPARED:
        mine = {ANY_EVENT: asking}
    else:
        mine = {}
        for reaction in asking:
            for event in reaction.events:
                mine.setdefault(event, []).append(replace(reaction, events=(event,)))
    found = [_delay(event, reactions, other) for event, reactions in sorted(mine.items())]
    return [one for one in found if one is not None]


def _delay(event: str, mine: list[PricedReaction], theirs: _Other) -> Delay | None:
    """How long the first Commands about an event, and its response, may wait; None: not at all."""
    first = _first_delay(event, mine, theirs)
    firsts = _firsts(mine)
    until = [price for one in mine for price in one.responds]
    found = first or Delay(event)
    if all(_same(one) for one in mine):
        found.response = replace(found) if until else None
        return first
    found.response = _response(found, firsts, until, theirs)
    found.response.unknown += [gap for one in mine for gap in one.later]
    return found if first or found.response != replace(found, response=None) else None


def _same(reaction: PricedReaction) -> bool:
    """Whether a reaction's first word or movement towards the user is its first Command."""
    firsts = {id(one.node) for one in reaction.firsts}
    return all(id(one.node) in firsts for one in reaction.responds)


def _firsts(mine: list[PricedReaction]) -> list[Price]:
    """The Commands that may come first."""
    return [price for one in mine for price in one.firsts]


def _about_the_same(
    event: str, mine: list[PricedReaction], theirs: _Other
) -> list[tuple[PricedReaction, Busy]]:
    """The other's reactions to the same event, each with its consequences."""
    return [
        (one, busy)
        for one, busy in zip(theirs.foreign, theirs.after, strict=True)
        if event == ANY_EVENT or any(related(each, one) for each in mine)
    ]


def _first_delay(event: str, mine: list[PricedReaction], theirs: _Other) -> Delay | None:
    firsts = _firsts(mine)
    needed = devices_of(firsts)
    same = _about_the_same(event, mine, theirs)
    whole = _whole(firsts, theirs, [busy for _, busy in same])
    if not theirs.gaps and whole is None and worst(theirs.parts, needed) is None:
        return None
    delay = Delay(event, unknown=list(theirs.gaps))
    _add_longest(delay, theirs, needed)
    delay.each = max((_first(one, needed) for one in theirs.foreign), default=0)
    _add_own(delay, theirs, needed)
    delay.everything = whole is not None and _drives(firsts, theirs)
    if whole is not None:
        delay.after = [one.node.place for one, _ in same]
        _wait_for_all(delay, whole, theirs)
    return _once(delay)


def _response(first: Delay, firsts: list[Price], until: list[Price], theirs: _Other) -> Delay:
    """How long the first word or movement towards the user may wait, behind other Commands.

    The reaction has the floor by then (F1): what the other has begun before runs to its end, and
    its reactions to further events come in with all their consequences (F2).
    """
    needed = devices_of(until)
    delay = replace(first, unknown=list(first.unknown), endless=list(first.endless))
    delay.lasts = 0
    _add_longest(delay, theirs, needed)
    delay.lasts = max(delay.lasts, first.lasts + _begun_meanwhile(first, firsts, needed, theirs))
    if _drives(until, theirs):
        delay.everything = True
        _wait_for_all(delay, theirs.at_all, theirs)
    _add_own(delay, theirs, None)
    _add_further(delay, theirs)
    return _once(delay)


def _begun_meanwhile(
    first: Delay, firsts: list[Price], needed: frozenset[str], theirs: _Other
) -> int:
    """The longest part of the other that may begin while a reaction waits for its first Command.

    The reaction holds back the devices of that (S3), unless the other has the floor.
    """
    fitting = [
        part
        for part in theirs.parts
        if first.whole or not all(part.devices & one.devices for one in firsts)
    ]
    longest = worst(fitting, needed)
    return longest.lasts if longest is not None else 0


def _once(delay: Delay) -> Delay:
    """A delay without duplicate reasons."""
    delay.unknown = list(dict.fromkeys(delay.unknown))
    delay.endless = list(dict.fromkeys(delay.endless))
    return delay


def _add_longest(delay: Delay, theirs: _Other, needed: frozenset[str]) -> None:
    """The longest part of the other on devices, which runs to its end (U1)."""
    fitting = [part for part in theirs.parts if part.devices & needed]
    longest = worst(fitting, needed)
    if longest is None:
        return
    delay.devices = tuple(sorted(longest.devices & needed))
    delay.what, delay.place = longest.what, longest.place
    delay.lasts += longest.lasts
    delay.listens = delay.listens or any(part.listens for part in fitting)
    delay.unknown += [Gap(part.place, part.unknown) for part in fitting if part.unknown]


def _add_own(delay: Delay, theirs: _Other, needed: frozenset[str] | None) -> None:
    """Reactions of the other to events that it causes itself: each goes first (S2b).

    Only those that begin on the given devices count; by default all, as each may take the floor.
    """
    for one, again in zip(theirs.outline.reactions, theirs.rounds, strict=True):
        if needed is not None and not devices_of(one.firsts) & needed:
            continue
        delay.endless += [one.made] if one.made else again
        if one.often is not None and not again and not one.made:
            delay.unknown.append(one.often)


def _whole(firsts: list[Price], theirs: _Other, same: list[Busy]) -> Busy | None:
    """The part of the other that is waited for as a whole (F2, K1, K2); None if there is none."""
    if _drives(firsts, theirs):
        return theirs.at_all
    busy = [one for one in same if one.lasts]
    if not busy:
        return None
    different = {id(one): one for one in busy}.values()
    return Busy(
        sum(one.lasts for one in busy),
        [gap for one in different for gap in one.endless],
        [*(gap for one in different for gap in one.unknown), *theirs.later],
    )


def _drives(mine: list[Price], theirs: _Other) -> bool:
    """Whether a Command leaves the user, and the other may prevent it (K1, K2)."""
    return any(one.leaves for one in mine) and any(not one.leaves for one in theirs.parts)


def _wait_for_all(delay: Delay, whole: Busy, theirs: _Other) -> None:
    """Add all activity without a wait, and that of further events."""
    delay.lasts += whole.lasts
    delay.unknown += whole.unknown
    delay.endless += whole.endless
    delay.listens = delay.listens or any(part.listens for part in theirs.parts)
    _add_further(delay, theirs)


def _add_further(delay: Delay, theirs: _Other) -> None:
    """All that the other does about each further event, reacting or not, and each unfinished one."""
    delay.whole = True
    each = [*theirs.after, *theirs.joined]
    bounded = not any(one.endless or one.unknown for one in each)
    delay.each = max((one.lasts for one in each), default=0) if bounded else None


def _first(reaction: PricedReaction, needed: frozenset[str]) -> int:
    """How long the first Command of a reaction keeps devices, or all that begin at once."""
    alone = [one.lasts for one in reaction.firsts if one.devices & needed]
    together = [lasts for held, lasts in reaction.together.items() if held & needed]
    return max([*alone, *together], default=0)


# What may starve ----------------------------------------------------------------------------


def starving(own: Outline, theirs: Outline) -> list[Starving]:
    """The parts of ``theirs`` that may starve Commands of ``own`` other than reactions."""
    drives = any(part.leaves for part in own.parts)
    everything = tuple(sorted(own.devices))
    leaving = [one for one in own.parts if one.leaves]
    held = {False: devices_of(own.parts), True: devices_of(leaving)}
    """The devices of Commands that are equal to one that leaves the user or does not (K2)."""
    floors = _floors(theirs) if not drives else set(theirs.states)
    floor = _parts_with_floor(theirs)
    found = [_by_loops(part, held, part in floor, drives) for part in theirs.parts]
    found += [_by_cycle(loop, held, floors, drives) for loop in loops(theirs)]
    found += [Starving(gap.place, gap.reason, "", everything, drives, True) for gap in theirs.gaps]
    causes = [one for one in found if one is not None]
    return causes + _again(theirs, causes, drives)


def _again(theirs: Outline, causes: list[Starving], drives: bool) -> list[Starving]:
    """The reactions that cause their own event again, except those found to keep the floor."""
    kept = {(one.place, one.what) for one in causes if one.everything}
    return [
        Starving(gap.place, gap.reason, "F2", (), drives, True)
        for gap in reacting_again(theirs)
        if (gap.place, gap.reason) not in kept
    ]


def _parts_with_floor(theirs: Outline) -> set[Price]:
    """The parts that may hold the floor: of states that may, and of reactions."""
    floor = {part for name in _floors(theirs) for part in theirs.states[name].parts}
    return floor | {part for one in theirs.handled for part in one.does.parts}


def _floors(theirs: Outline) -> set[str]:
    """The states that may hold the floor: those that reactions lead to, or go on beside."""
    begun = [*(one.does for one in theirs.handled), *theirs.wakes]
    starts = [name for one in begun for name in (*one.goes, *one.calls)]
    starts += [one.stays for one in theirs.handled if one.stays]
    if any(one.stays == "" for one in theirs.handled):
        return set(theirs.states)
    return {state.name for state in closure(theirs, starts)}


Held = Mapping[bool, frozenset[str]]


def _by_loops(part: Price, equal: Held, floored: bool, drives: bool) -> Starving | None:
    """A Command that works in loops: the next one goes before others' equal Commands (E4)."""
    if not part.loops:
        return None
    held = part.devices & equal[part.leaves]
    engages = part.engages and drives
    floor = not part.leaves and (drives or floored)
    if not held and not engages and not floor:
        return None
    what = f"{part.what} goes on until its goal is reached"
    return Starving(part.place, what, "E4", tuple(sorted(held)), engages, floor)


def _by_cycle(loop: EndlessLoop, equal: Held, floors: set[str], drives: bool) -> Starving | None:
    """A loop without a wait: the active stream goes on before others (S2c)."""
    held = loop.devices & equal[loop.leaves]
    engages = loop.engages and drives
    floor = bool(loop.states & floors)
    if not held and not engages and not floor:
        return None
    return Starving(loop.place, loop.what, "S2c", tuple(sorted(held)), engages, floor)
