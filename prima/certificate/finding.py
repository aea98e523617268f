"""How one application affects another: waits of its reactions, and starvation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from prima.certificate.model import Delay, Starving
from prima.checks.prices import Gap, Outline, Price, Reaction, worst
from prima.checks.prices.bounds import Busy, busy_after_each, busy_at_all, closure, loops
from prima.checks.prices.model import Loop, State, devices_of
from prima.interpreter.selection import takes


def related(one: Reaction, other: Reaction) -> bool:
    """Whether two reactions may be to the same event."""
    if one.words is not None and other.words is not None and not one.words & other.words:
        return False  # no utterance is taken by both links
    pairs = ((name, its) for name in one.events for its in other.events)
    return any(takes(name, its) or takes(its, name) for name, its in pairs)


def delays(own: Outline, theirs: Outline) -> list[Delay]:
    """The waits of each reaction of ``own`` for ``theirs``."""
    mine: dict[str, list[Reaction]] = {}
    for reaction in own.reactions:
        for event in reaction.events:
            if reaction.firsts:
                one = replace(reaction, events=(event,))
                mine.setdefault(event, []).append(one)
    found = [_delay(event, reactions, theirs) for event, reactions in sorted(mine.items())]
    return [one for one in found if one is not None]


def _delay(event: str, mine: list[Reaction], theirs: Outline) -> Delay | None:
    """How long the first Commands about an event may wait, and its response; None for not at all."""
    first = _first_delay(event, mine, theirs)
    firsts = [price for one in mine for price in one.firsts]
    until = [price for one in mine for price in one.responds]
    found = first or Delay(event, (), 0, "", None)
    if {id(one.node) for one in until} <= {id(one.node) for one in firsts}:
        found.response = replace(found) if until else None
        return first
    found.response = _response(found, firsts, until, theirs)
    found.response.unknown += [gap for one in mine for gap in one.later]
    return found if first or found.response != replace(found, response=None) else None


def _first_delay(event: str, mine: list[Reaction], theirs: Outline) -> Delay | None:
    firsts = [price for one in mine for price in one.firsts]
    needed = devices_of(firsts)
    foreign = _foreign(theirs)
    same = [one for one in foreign if any(related(each, one) for each in mine)]
    whole = _whole(firsts, theirs, same)
    if not theirs.gaps and whole is None and worst(theirs.parts, needed) is None:
        return None
    delay = Delay(event, (), 0, "", None, unknown=list(theirs.gaps))
    _add_longest(delay, theirs, needed)
    delay.each = max((_first(one, needed) for one in foreign), default=0)
    _add_own(delay, theirs, needed)
    delay.everything = whole is not None and _drives(firsts, theirs)
    if whole is not None:
        delay.after = [one.node.place for one in same]
        _wait_for_all(delay, whole, theirs)
    return _once(delay)


def _response(first: Delay, firsts: list[Price], until: list[Price], theirs: Outline) -> Delay:
    """How long the first word or movement towards the user may wait, behind other Commands.

    The reaction has the floor by then (F1): what the other has begun before goes to its end, and
    its reactions to further events come in with all that follows from them (F2).
    """
    needed = devices_of(until)
    delay = replace(first, unknown=list(first.unknown), endless=list(first.endless))
    delay.lasts = 0
    _add_longest(delay, theirs, needed)
    delay.lasts = max(delay.lasts, first.lasts + _begun_meanwhile(first, firsts, needed, theirs))
    if _drives(until, theirs):
        delay.everything = True
        _wait_for_all(delay, busy_at_all(theirs), theirs)
    _add_own(delay, theirs, None)
    _add_further(delay, theirs)
    return _once(delay)


def _begun_meanwhile(
    first: Delay, firsts: list[Price], needed: frozenset[str], theirs: Outline
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


def _foreign(theirs: Outline) -> list[Reaction]:
    """The reactions of the other to events that it does not make for itself."""
    return [one for one in theirs.reactions if one.often is None]


def _add_longest(delay: Delay, theirs: Outline, needed: frozenset[str]) -> None:
    """The longest part of the other on devices, which goes to its end (U1)."""
    fitting = [part for part in theirs.parts if part.devices & needed]
    longest = worst(fitting, needed)
    if longest is None:
        return
    delay.devices = tuple(sorted(longest.devices & needed))
    delay.what, delay.place = longest.what, longest.place
    delay.lasts += longest.lasts
    delay.listens = delay.listens or any(part.listens for part in fitting)
    delay.unknown += [Gap(part.place, part.unknown) for part in fitting if part.unknown]


def _add_own(delay: Delay, theirs: Outline, needed: frozenset[str] | None) -> None:
    """Reactions of the other to events that it makes for itself: each goes first (S2b).

    Those count that begin on some devices; without these, all, as each may take the floor.
    """
    for one in theirs.reactions:
        if needed is not None and not devices_of(one.firsts) & needed:
            continue
        delay.endless += [one.made] if one.made else []
        if one.often is None:
            continue
        again = [Gap(loop.place, loop.what) for loop in loops(theirs) if _raises(loop, one, theirs)]
        delay.endless += again if not one.made else []
        delay.unknown += [one.often] if not again and not one.made else []


def _raises(loop: Loop, reaction: Reaction, theirs: Outline) -> bool:
    """Whether what goes on without an end makes the event of a reaction again and again."""
    raised = {name for state in loop.states for name in theirs.states[state].raises}
    return any(takes(event, name) for event in reaction.events for name in raised)


def _whole(firsts: list[Price], theirs: Outline, same: list[Reaction]) -> Busy | None:
    """What of the other is waited for as a whole (F2, K1, K2); None where nothing is."""
    if _drives(firsts, theirs):
        return busy_at_all(theirs)
    told = [one for one in busy_after_each(theirs, same) if one.lasts]
    if not told:
        return None
    later = [gap for state in _doings(theirs) for gap in state.unknown]
    different = {id(one): one for one in told}.values()
    return Busy(
        sum(one.lasts for one in told),
        [gap for one in different for gap in one.endless],
        [*(gap for one in different for gap in one.unknown), *later],
    )


def _drives(mine: list[Price], theirs: Outline) -> bool:
    """Whether a Command leaves the user, and the other may prevent it (K1, K2)."""
    return any(one.leaves for one in mine) and any(not one.leaves for one in theirs.parts)


def _doings(theirs: Outline) -> Iterable[State]:
    does = [one.does for one in theirs.reactions]
    return [*theirs.states.values(), *does, *theirs.wakes]


def _wait_for_all(delay: Delay, whole: Busy, theirs: Outline) -> None:
    """Add all activity without a wait, and that of further events."""
    delay.lasts += whole.lasts
    delay.unknown += whole.unknown
    delay.endless += whole.endless
    delay.listens = delay.listens or any(part.listens for part in theirs.parts)
    _add_further(delay, theirs)


def _add_further(delay: Delay, theirs: Outline) -> None:
    """All that the other does about each further event, and each that it has not done with."""
    delay.whole = True
    others = busy_after_each(theirs, _foreign(theirs))
    delay.each = max((one.lasts for one in others), default=0)
    if any(one.endless or one.unknown for one in others):
        delay.each = None


def _first(reaction: Reaction, needed: frozenset[str]) -> int:
    """How long the first Command of a reaction keeps devices."""
    return max((one.lasts for one in reaction.firsts if one.devices & needed), default=0)


# What may starve ----------------------------------------------------------------------------


def starving(own: Outline, theirs: Outline) -> list[Starving]:
    """The parts of ``theirs`` that may starve Commands of ``own`` other than reactions."""
    drives = any(part.leaves for part in own.parts)
    floors = _floors(theirs) if not drives else set(theirs.states)
    floor = {part for name in _floors(theirs) for part in theirs.states[name].parts}
    floor |= {part for one in theirs.reactions for part in one.does.parts}
    found = [_by_loops(part, own, part in floor, drives) for part in theirs.parts]
    found += [_by_cycle(loop, own, floors, drives) for loop in loops(theirs)]
    found += [
        Starving(gap.place, gap.reason, "", tuple(sorted(own.devices)), drives, True)
        for gap in theirs.gaps
    ]
    return [one for one in found if one is not None]


def _floors(theirs: Outline) -> set[str]:
    """The states that may hold the floor: those that reactions lead to, or go on beside."""
    begun = [*(one.does for one in theirs.reactions), *theirs.wakes]
    starts = [name for one in begun for name in (*one.goes, *one.calls)]
    starts += [one.stays for one in theirs.reactions if one.stays]
    if any(one.stays == "" for one in theirs.reactions):
        return set(theirs.states)
    return {state.name for state in closure(theirs, starts)}


def _by_loops(part: Price, own: Outline, floored: bool, drives: bool) -> Starving | None:
    """A Command that works in loops: the next one goes before others' equal Commands (E4)."""
    if not part.loops:
        return None
    equal = [one for one in own.parts if one.leaves or not part.leaves]
    held = part.devices & devices_of(equal)
    engages = part.engages and drives
    floor = not part.leaves and (drives or floored)
    if not held and not engages and not floor:
        return None
    what = f"{part.what} goes on until its goal is reached"
    return Starving(part.place, what, "E4", tuple(sorted(held)), engages, floor)


def _by_cycle(loop: Loop, own: Outline, floors: set[str], drives: bool) -> Starving | None:
    """What follows itself without a wait: the active stream goes on before others (S2c)."""
    equal = [one for one in own.parts if one.leaves or not loop.leaves]
    held = loop.devices & devices_of(equal)
    engages = loop.engages and drives
    floor = bool(loop.states & floors)
    if not held and not engages and not floor:
        return None
    return Starving(loop.place, loop.what, "S2c", tuple(sorted(held)), engages, floor)
