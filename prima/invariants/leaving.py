"""Leaving a state (O3): what becomes of its requests, and what goes on afterwards."""

from __future__ import annotations

from collections.abc import Iterable

from prima.invariants.memory import Memory
from prima.invariants.model import AB, RUNNING, Record, Tree
from prima.invariants.streams import abs_there


def note_leave(memory: Memory, record: Record) -> None:
    """A state is left: it makes no new requests, and none of its ABs starts."""
    app, state = record["app"], record["state"]
    if (app, state) in memory.left:
        memory.report(3, "O3", f"state {state} of {app} is left twice")
    if state not in memory.asked.get(app, ()) and app not in memory.refused:
        memory.report(3, "O3", f"state {state} of {app} is left, which has asked for nothing")
    memory.left.add((app, state))
    memory.left_now.add((app, state))
    for tree in memory.trees.values():
        if tree.app == app and tree.hold is not None and tree.hold_state == state:
            _hold_no_more(memory, tree)
    mine = [ab for ab in abs_there(memory) if ab.app == app and ab.state == state]
    if mine:
        memory.continuing[app] = going_on(mine)


def asks(memory: Memory, record: Record) -> None:
    """O3: a state that makes a request has followed states that were left, unless called."""
    app, state = record["app"], record.get("state")
    if state is None:
        return
    states = memory.asked.setdefault(app, set())
    if app not in memory.calling:
        for before in sorted(one for one in states if one < state):
            _is_left(memory, app, before, f"state {state} asks for {record['behavior']}")
    states.add(state)


def left_at_end(memory: Memory, app: str, outcome: str) -> None:
    """O3: an application that ends leaves its state, and all states that have called it.

    One that is ended by an error or a limit may not reach them (E2). The last state may be one
    whose requests were all refused (E3), which only shows in that it is left.
    """
    if "error." in outcome or "defect" in outcome:
        return
    states = sorted(memory.asked.get(app, ()))
    if app in memory.calling:
        later = (state for one, state in memory.left if one == app and state is not None)
        states = [one for one in states[-1:] if one >= max(later, default=one)]
    for state in states:
        _is_left(memory, app, state, "it has ended")


def _is_left(memory: Memory, app: str, state: int, because: str) -> None:
    if (app, state) not in memory.left:
        memory.report(3, "O3", f"state {state} of {app} was not left, but {because}")
        memory.asked[app].discard(state)


def _hold_no_more(memory: Memory, tree: Tree) -> None:
    """X3: a state that is left holds nothing; what was held may be continued."""
    if tree.until is None:
        tree.hold = None
    else:
        memory.continuing[tree.app] = tree


def left_rightly(memory: Memory) -> None:
    """O3 at the end of an instant: the remaining ABs of states that were left are running."""
    for ab in abs_there(memory):
        if not memory.has_left(ab) or memory.in_group(ab):
            continue
        if ab.phase != RUNNING:
            memory.report(3, "O3", f"{ab.shown} is {ab.phase}, but its state was left")
        elif ab.listening:
            memory.report(3, "O3", f"{ab.shown} listens, but its state was left")
    for tree, state in memory.let_go:
        known = (tree.app, state) in memory.left_now or tree.app in memory.unloaded
        if not (known or memory.released):
            memory.report(10, "X3", f"{tree.name} is held no longer, but its state goes on")
    for tree in memory.trees.values():
        _held_rightly(memory, tree)


def _held_rightly(memory: Memory, tree: Tree) -> None:
    if tree.until is not None and (tree.app, tree.hold_state) in memory.left_now:
        memory.report(10, "X3", f"{tree.name} is held on, but its state was left")


def going_on(left: Iterable[AB]) -> Tree:
    """O3: of several streams, the running one or the one whose AB started last, else the latest."""
    asked = sorted(left, key=lambda ab: int(ab.name.rpartition("#")[2]), reverse=True)
    return max((ab.tree for ab in asked), key=lambda tree: (tree.runs, tree.started))
