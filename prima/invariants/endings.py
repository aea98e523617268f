"""Ends: what may end ABs (invariants 2 and 3), by O2, O3, U5 and E1 to E5."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from prima.invariants.extensions import forget_place, moved
from prima.invariants.late import (
    answered_early,
    comes_too_late,
    hears_of,
    hears_surely,
    reaction_of,
)
from prima.invariants.memory import Memory
from prima.invariants.model import AB, GONE, LINKED, RUNNING, WAITING, Cut, Record, Tree, base

Fault = tuple[int | None, str, str]
"""The invariant that a cancellation violates, by default that of its AB's phase, a rule, a text."""


def _shown(cut: Cut) -> str:
    return f"{cut.ab.shown} ({cut.was}) is cancelled"


def maybe_silence(memory: Memory, urgent: AB) -> None:
    """O2: ABs that run on other devices finish without a notice, which is not recorded."""
    for tree in memory.trees.values():
        devices = memory.tree_devices.get(tree.name, frozenset()).union(
            *(ab.devices for ab in tree.members.values() if ab is not urgent)
        )
        if tree.app == urgent.app and devices & urgent.devices:
            for ab in tree.members.values():
                ab.silent = ab.silent or ab.phase == RUNNING


def note_end(memory: Memory, record: Record) -> None:
    """An AB, or a loop of it, ends."""
    ab = memory.running_one(record, "ends")
    if ab is None:
        return
    moved(memory, ab, record)
    inner = [other for other in memory.running.values() if other.inside(ab)]
    if inner:
        memory.report(2, "U5", f"{ab.shown} ends while {inner[0].shown} runs in it")
    if ab.feedback and not record["goal"]:
        _loop_over(memory, ab)
        if record["outcome"] == "again":
            _goes_on(memory, ab)
            return
        if not (memory.is_given_up(ab) or ab.silent):
            memory.report(3, "U2", f"{ab.shown} ends before its goal, but its state goes on")
    if record["outcome"] == "again":
        memory.report(3, "U2", f"{ab.shown} is recorded as going on, but has no next loop")
    _ended(memory, ab)


def _ended(memory: Memory, ab: AB) -> None:
    """An AB has ended, and its application hears of it."""
    hears_of(memory, ab)
    if not (ab.inserted or ab.command == "iu"):
        hears_surely(memory, ab)
    memory.remove(ab)


def note_over(memory: Memory, record: Record) -> None:
    """E2: the run is over once all applications and the ABs that they left have ended."""
    if record["outcome"] == "over":
        for ab in memory.running.values():
            memory.report(2, "E2", f"{ab.shown} still runs as the run ends")


def _goes_on(memory: Memory, ab: AB) -> None:
    """U2: a loop has ended, and the next one waits."""
    memory.wait(ab)
    ab.followed_at = memory.now
    if memory.has_left(ab):
        memory.report(3, "O3", f"{ab.shown} goes on, but its state was left")
    if ab.last_loop:
        memory.report(3, "E1", f"{ab.shown} goes on, but its tree has failed")


def note_fail(memory: Memory, record: Record) -> None:
    """A request or an AB fails (E1)."""
    if not record.get("behavior"):
        memory.refused.add(record["app"])
        return  # E3: refused before it entered working memory
    ab = memory.abs.get(base(record["behavior"]))
    # A unit fails with the Command in it (U4); it is running then as well.
    ab = memory.running_one(record, "fails") if ab is not None else None
    if ab is None:
        return
    hears_of(memory, ab)
    if record["rule"] == "U5":
        if ab.name in memory.groups:  # of another unit, its author handles the error
            _ends_loops(memory, ab)
        for inner in memory.running.values():
            inner.silent = inner.silent or inner is ab or inner.inside(ab)
        return  # a unit out of time ends when its running Command has
    _loop_over(memory, ab)
    forget_place(ab)
    if not ab.inserted:  # the AB that it was inserted for goes on without it
        memory.failed.append(ab)
        _ends_loops(memory, ab)
    memory.remove(ab)


def _ends_loops(memory: Memory, failed: AB) -> None:
    """E1: the loops of a failed tree end, unless the AB had been given up before (O2, O3)."""
    surely = not (failed.silent or memory.is_given_up(failed) or failed.unit)
    for ab in failed.tree.members.values():
        if ab.feedback and ab.phase == RUNNING and not ab.inserted:
            ab.silent = True
            ab.last_loop = ab.last_loop or surely


def _loop_over(memory: Memory, ab: AB) -> None:
    """F5: a loop is over: the robot moves on only if something starts now."""
    if ab.moves and ab.unit is None:
        memory.halting[ab.name] = ab


def note_cancel(memory: Memory, record: Record) -> None:
    """An AB is removed from working memory."""
    ab = memory.abs.get(base(record["behavior"]))
    if ab is None or ab.phase == GONE:
        memory.report(3, "O2", f"{record['behavior']} is cancelled, but it is not there")
    elif record["outcome"] == "answered":
        answered_early(memory, ab, record)
    elif record["outcome"] == "halted":
        _halted(memory, ab)
    else:
        _cancelled(memory, ab, record)


def _cancelled(memory: Memory, ab: AB, record: Record) -> None:
    was, rule = ab.phase, record["rule"]
    # ABs of a tree or unit removed together may be recorded with their former state.
    lately = was == WAITING and memory.now in (ab.followed_at, ab.freed_at)
    told = {was, LINKED} if rule in ("E1", "X2") and lately else {was}
    if was == LINKED and ab.joined_at == memory.now:
        told.add(WAITING)  # until the selection it does not wait for the way back
    if record["outcome"] not in told:
        memory.report(13, rule, f"{ab.shown} is {was} when cancelled, not {record['outcome']}")
    memory.cuts.append(Cut(ab, was, rule, memory.place, _wanted(memory, ab.tree)))
    if was == RUNNING:
        _loop_over(memory, ab)
    late = reaction_of(memory, ab) if rule == "X8" else None
    forget_place(ab)
    waited = [one for one in ab.tree.members.values() if ab.name in one.parents]
    memory.remove(ab, ended=was == RUNNING)  # what ran has ended, even if cut short
    if rule == "X8":
        comes_too_late(memory, ab, was, late, waited)


def _wanted(memory: Memory, tree: Tree) -> frozenset[str]:
    """The devices that a tree wanted when its first AB was removed, and has requested since."""
    there = [one.devices for one in tree.members.values()]
    devices = memory.tree_devices.get(tree.name, frozenset()).union(*there)
    memory.tree_devices[tree.name] = devices
    return devices


def _halted(memory: Memory, ab: AB) -> None:
    """E5: the emergency stop ends an AB, which then waits."""
    if ab.phase == RUNNING:
        _loop_over(memory, ab)
    else:
        memory.report(3, "E5", f"{ab.shown} is halted, but it is {ab.phase}")
    if not memory.halted:
        memory.report(2, "E5", f"{ab.shown} is halted without an emergency stop")
    memory.wait(ab)


def justified(memory: Memory, cut: Cut) -> None:
    """Invariants 2 and 3: why an AB was removed from working memory."""
    if cut.rule == "X8":
        return  # checked when it was cancelled
    number = 2 if cut.was == RUNNING else 3
    if cut.rule not in REASONS:
        text = f"{_shown(cut)} by a rule that cancels nothing"
        memory.report(number, cut.rule, text)
        return
    for only, rule, text in REASONS[cut.rule](memory, cut):
        memory.report(only or number, rule, f"{_shown(cut)}{text}")


def _units_cut(memory: Memory, cut: Cut) -> list[AB]:
    """Units that are cancelled with it, along with their contents."""
    return [other.ab for other in memory.cuts if cut.ab.inside(other.ab)]


def _for_something_urgent(memory: Memory, cut: Cut) -> Iterator[Fault]:
    """O2: a Command with ``now`` needs a device of it, or of its tree if it did not run."""
    devices = cut.tree_devices
    if cut.was == RUNNING:
        devices = cut.ab.devices.union(*(unit.devices for unit in _units_cut(memory, cut)))
    later = [one for one, place in memory.urgent if place > cut.place]
    if not any(one.app == cut.ab.app and one.devices & devices for one in later):
        yield None, "O2", " without a Command wanted now"


def _only_listens(memory: Memory, cut: Cut) -> Iterator[Fault]:
    """O3, E2: running ABs go on, unless they listen or their unit is cancelled."""
    if cut.was == RUNNING and not cut.ab.listening and not _units_cut(memory, cut):
        yield 2, "O3", ": it does not listen"


def _as_state_was_left(memory: Memory, cut: Cut) -> Iterator[Fault]:
    yield from _only_listens(memory, cut)
    if not _given_up(memory, cut):
        yield None, "O3", ", but its state goes on"


def _as_application_ended(memory: Memory, cut: Cut) -> Iterator[Fault]:
    yield from _only_listens(memory, cut)
    if cut.ab.app not in memory.unloaded:
        yield None, "E2", f", but {cut.ab.app} goes on"


def _as_unit_ended(_: Memory, cut: Cut) -> Iterator[Fault]:
    if cut.was == RUNNING and not cut.ab.listening:
        yield 2, "U5", ": it does not listen"


def _as_tree_failed(memory: Memory, cut: Cut) -> Iterator[Fault]:
    near = [one for one in memory.failed if one.tree is cut.ab.tree]
    if not near:
        yield None, "E1", ", but nothing of its tree has failed"
    if cut.was == RUNNING and not any(cut.ab.inside(one.unit) for one in near if one.unit):
        yield 2, "E1", ", but nothing of its unit has failed"


def _as_unit_gave_way(memory: Memory, cut: Cut) -> Iterator[Fault]:
    if not any(cut.ab.inside(unit) for unit, _, _ in memory.gave_way):
        yield None, "X2", ", but no unit around it is interrupted"


def _in_emergency(memory: Memory, _cut: Cut) -> Iterator[Fault]:
    if not (memory.released or memory.halted):
        yield None, "E5", " without an emergency"


def _given_up(memory: Memory, cut: Cut) -> bool:
    """O3: its state is left in this instant or, if it ran, it or its application before."""
    ab = cut.ab
    if cut.was == RUNNING:
        return memory.is_given_up(ab)
    return (ab.app, ab.state) in memory.left_now


REASONS: Mapping[str, Callable[[Memory, Cut], Iterator[Fault]]] = {
    "O2": _for_something_urgent,
    "O3": _as_state_was_left,
    "E2": _as_application_ended,
    "U5": _as_unit_ended,
    "E1": _as_tree_failed,
    "X2": _as_unit_gave_way,
    "E5": _in_emergency,
}
"""What is wrong with a cancellation, by the rule that it names."""
