"""Checks the limits of the extensions."""

from __future__ import annotations

import math
from typing import TypeGuard

from prima.invariants.floor import give_floor
from prima.invariants.memory import Memory
from prima.invariants.model import AB, LINKED, RUNNING, WAITING, Record, Tree, base, ms

RESTORING = ("set-position", "set-position-and-direction", "set-direction", "face-human")
"""The Commands that X1 may insert, and the head's Command."""
GOING = (*RESTORING[:2], "topological-move", "set-speed-and-time", "tracking-human")
"""Commands that change the robot's place, and so do not rely on it."""
FAR = 0.5
"""The distance (m) from its place at which a stream counts as moved (X1)."""


def put_in(memory: Memory, ab: AB, before: AB | None, record: Record) -> None:
    """X1, X4, X9: the mediator itself inserts an AB before another."""
    rule, shown = ab.inserted, f"{ab.name} is put in"
    if rule not in ("X1", "X4", "X9") or rule.lower() not in memory.extensions:
        memory.report(11, rule, f"{shown} by a rule that is not on")
    if before is None or not _may_precede(ab, before):
        memory.report(11, rule, f"{shown} before something that it cannot precede")
        return
    _takes_place(memory, ab, before)
    if rule == "X1":
        _restores(memory, ab, record)
    elif rule == "X9":
        _says_so(memory, ab, before, record)
    else:
        _connects(memory, ab, before, record)
    before.parents.add(ab.name)
    before.phase = LINKED
    memory.waiting.pop(before.name, None)
    if rule != "X4":  # all that waits in the stream waits for a way back, or for words
        for other in [one for one in memory.waiting.values() if one.tree is ab.tree]:
            memory.join_first(other)


def _may_precede(ab: AB, before: AB) -> bool:
    """A way back comes also before what has been put in already."""
    first = ab.inserted == "X1" or not before.inserted
    return before.tree is ab.tree and before.unit is None and first


def _takes_place(memory: Memory, ab: AB, before: AB) -> None:
    """An inserted AB takes the other's place in the order of S2, with its reactive flag."""
    rule, shown = ab.inserted, f"{ab.name} is put in"
    first = before.phase == WAITING
    if not first and not before.parents & ab.parents:
        memory.report(11, rule, f"{shown}, but {before.shown} is {before.phase}")
    if ab.cause != (before.cause if first else None):
        memory.report(11, "C5", f"{shown} with a flag that {before.shown} has not")
    ab.fresh_until = before.fresh_until if first else None
    before.cause = before.fresh_until = None
    ab.requested, ab.place = before.requested, before.place
    ab.followed_at = before.followed_at
    ab.waits_as = ab.name if rule == "X1" else before.waits_as


def _restores(memory: Memory, ab: AB, record: Record) -> None:
    """X1: only state that a suspended stream relies on is restored."""
    if not ab.tree.moved_away:
        memory.report(11, "X1", f"{ab.name} is put in, but {ab.tree.name} was not suspended")
    if record["command"] not in (*RESTORING, "move-head"):
        memory.report(11, "X1", f"{ab.name} restores nothing: it is {record['command']}")
    for other in ab.tree.members.values():
        if other is not ab and other.inserted == "X1" and other.command == ab.command:
            memory.report(11, "X1", f"{ab.name} restores what {other.shown} restores already")


def _says_so(memory: Memory, ab: AB, before: AB, record: Record) -> None:
    """X9: the stream's words are said once after others have spoken into its pause."""
    tree = ab.tree
    if not tree.words_due or record.get("text") != tree.words or ab.command != "speak":
        memory.report(11, "X9", f"{ab.name} is put in, but {tree.name} has not to say it")
    if before.begins_now:
        memory.report(11, "X9", f"{ab.name} is put in before {before.shown}, which is wanted now")


def words_said(memory: Memory, ab: AB) -> None:
    """X9: a stream that resumes has said its words, if others have spoken meanwhile."""
    goes_on = not (ab.inserted or ab.begins_now) and ab.cause is None
    if "x9" in memory.extensions and goes_on and ab.tree.words_due and ab.tree.words:
        memory.report(16, "X9", f"{ab.shown} resumes {ab.tree.name}, which has not said so")


def note_resumed(memory: Memory, ab: AB, response: bool, now: bool) -> None:
    """X1, X9: after a start: note which streams' pauses it speaks into, and what resumes.

    A ``response`` (X7) resumes nothing, and what begins ``now`` relies on no state.
    """
    if ab.says:
        for tree in memory.trees.values():
            if tree.app != ab.app and tree.suspended and tree.spoken:
                tree.words_due = True
    if response or ab.tree.suspended:
        return
    if ab.inserted in ("", "X9"):
        ab.tree.words_due = False
    ab.tree.moved_away = ab.tree.moved_away and now


def stands_right(memory: Memory, ab: AB) -> None:
    """X1: a suspended stream resumes where the robot was for it.

    What is wanted now waits for no way back (O2).
    """
    place, robot = ab.tree.place, memory.robot
    if (
        not ab.tree.moved_away
        or ab.inserted
        or ab.begins_now
        or ab.command in GOING
        or "x1" not in memory.extensions
    ):
        return
    if place is not None and robot is not None and math.dist(place, robot) > FAR:
        memory.report(11, "X1", f"{ab.shown} resumes at {robot}, but its stream was at {place}")


def note_halted(memory: Memory, record: Record) -> None:
    """X1, X2: note where an interrupted motion has left the robot."""
    data = record.get("data") or {}
    if {"x", "y", "heading"} <= data.keys():
        memory.robot = (data["x"], data["y"])


def moved(memory: Memory, ab: AB, record: Record) -> None:
    """Note where a Command's end, or a loop's, has brought the robot."""
    data = record.get("data") or {}
    if not {"x", "y", "heading"} <= data.keys():
        return
    memory.robot = (data["x"], data["y"])
    if ab.command == "tracking-human":
        ab.tree.place = None
    elif ab.command in GOING and not ab.inserted and record["outcome"] != "again":
        ab.tree.place = memory.robot


def forget_place(ab: AB) -> None:
    """X1: where a motion that is cut short has brought the robot for its stream is unknown."""
    if ab.starts and ab.command in GOING[:-1] and not ab.inserted:
        ab.tree.place = None


def _connects(memory: Memory, ab: AB, before: AB, record: Record) -> None:
    """X4: the robot turns to the user once, if requested and the user is not seen."""
    if not before.connect or before.name in memory.faced or memory.in_view or before.starts:
        memory.report(11, "X4", f"{ab.name} is put in, but {before.shown} needs no channel")
    if not (record["command"] == "face-human" and ab.devices >= before.devices):
        memory.report(11, "X4", f"{ab.name} does not keep the channel for {before.shown}")
    memory.faced.add(before.name)


def note_interrupt(memory: Memory, record: Record) -> None:
    """X2: only a restartable AB yields to a reaction that waits for it."""
    ab = memory.running_one(record, "is interrupted")
    if ab is None:
        return
    by = memory.abs.get(base(record["by"]))
    if "x2" not in memory.extensions or not ab.restartable or ab.unit is not None:
        memory.report(2, "X2", f"{ab.shown} is interrupted, which is not marked so")
    if memory.is_given_up(ab):
        memory.report(2, "X2", f"{ab.shown} is interrupted, but nobody wants it to start again")
    if memory.third_turn(ab):
        memory.report(16, "X7", f"{ab.shown} is interrupted between an answer and its response")
    if not _reacts_to(by, ab):
        memory.report(2, "X2", f"{ab.shown} is interrupted for {record['by']}, no reaction to it")
    elif ab.started_at == memory.now and not _later(by, ab):
        text = f"{ab.shown} is interrupted at its start: {by.shown} was outranked"
        memory.report(2, "S2", text)
    if by is not None:
        memory.gave_way.append((ab, by, memory.place))
    ab.interrupted = True
    ab.before, ab.content = ab.content, []
    memory.wait(ab)


def starts_again(memory: Memory, ab: AB, record: Record) -> None:
    """X2: the AB restarts from its beginning, in full."""
    if not record.get("resumed"):
        memory.report(3, "X2", f"{ab.shown} starts as if it had not been interrupted")
    before, now = (
        [(one["command"], one.get("text"), one.get("args")) for one in content]
        for content in (ab.before, ab.content)
    )
    if before != now:
        memory.report(3, "X2", f"{ab.shown} starts again as something else: {now}, not {before}")
    ab.interrupted = False


def interruptions(memory: Memory) -> None:
    """At the end of an instant: why ABs were interrupted, and whether completely."""
    for ab, by, place in memory.gave_way:
        if by.started <= place:
            memory.report(2, "X2", f"{ab.shown} is interrupted, but {by.shown} does not start")
    for ab in memory.running.values():
        if ab.unit is not None and ab.unit.phase != RUNNING:
            memory.report(2, "X2", f"{ab.shown} runs on, but its unit {ab.unit.shown} does not")


def wants_hold(memory: Memory, tree: Tree, ab: AB, record: Record) -> None:
    """X3: the latest request determines how long; while a stream is held, requests join it."""
    hold = None if record.get("hold") is None else ms(record["hold"])
    if hold != tree.hold or not _says_nothing_of_holds(memory, ab):
        tree.hold, tree.hold_state = hold, ab.state
    tree.requested = memory.place
    tree.words = record.get("words") or ""
    begins = not ab.parents and ab.unit is None and not ab.inserted
    if begins and not any(one.app == ab.app for one in memory.windows):  # else C3 claims it
        _joins_rightly(memory, tree, ab)


def _joins_rightly(memory: Memory, tree: Tree, ab: AB) -> None:
    held = [other for other in memory.trees.values() if other.app == ab.app and other.until]
    if held and not any(tree is other for other in held) and not joined_now(memory, tree):
        memory.report(10, "X3", f"{ab.name} does not join {held[0].name}, which is held for it")


def _says_nothing_of_holds(memory: Memory, ab: AB) -> bool:
    """Whether its request leaves its stream's hold unchanged.

    That is so for inserted ABs, for those in a unit that was given beforehand, and for
    a unit that spans questions: the requests inside determine it.
    """
    spans = ab.command == "iu" and ab.name not in memory.groups
    return bool(ab.inserted) or spans or (ab.unit is not None and ab.unit.name in memory.groups)


def joined_now(memory: Memory, tree: Tree) -> bool:
    """Whether a stream was joined in this instant."""
    return tree.joined >= 0 and memory.records[tree.joined]["time"] == memory.now


def note_held(memory: Memory, record: Record) -> None:
    """A stream is held open (X3)."""
    name, outcome = record["tree"], record["outcome"]
    tree = memory.trees.get(name)
    if "x3" not in memory.extensions or tree is None:
        memory.report(10, "X3", f"{name} is held, which is not to be")
        return
    if outcome == "begun":
        _begin_hold(memory, tree, record)
        return
    if tree.until is None:
        memory.report(10, "X3", f"{name} is held no longer ({outcome}), but was not")
    elif outcome == "over" and tree.until != memory.now:
        memory.report(10, "X3", f"{name} was to be held until {tree.until} ms")
    elif outcome == "left":
        memory.let_go.append((tree, tree.hold_state))
    tree.until = tree.hold = None
    if outcome == "joined":
        tree.joined = memory.place


def _begin_hold(memory: Memory, tree: Tree, record: Record) -> None:
    """X3: a stream without ABs stays open, and takes the floor if it is free."""
    until = ms(record["data"]["until"])
    if tree.open or tree.hold is None or tree.app in memory.gone_apps:
        memory.report(10, "X3", f"{tree.name} is held, but nobody asks for it")
    elif tree.started < 0:
        memory.report(10, "X3", f"{tree.name} is held, but has not begun")
    elif until - memory.now != tree.hold:
        memory.report(10, "X3", f"{tree.name} is held until {until} ms, not for {tree.hold} ms")
    tree.until, tree.held = until, memory.place
    close_trees(memory)


def holds_rightly(memory: Memory) -> None:
    """X3, at the end of an instant: no stream is held too long, or while it goes on."""
    for tree in memory.trees.values():
        if tree.until is not None and tree.until <= memory.now:
            memory.report(10, "X3", f"{tree.name} is held beyond {tree.until} ms")
        if tree.until is not None and tree.members:
            memory.report(10, "X3", f"{tree.name} is held, but {next(iter(tree.members))} is of it")
        if joined_now(memory, tree) and tree.requested < tree.joined:
            memory.report(10, "X3", f"{tree.name} is joined by nothing")


def _ends_rightly(memory: Memory, tree: Tree) -> None:
    """X3: a stream ends only if it need not be held."""
    wanted = tree.hold is not None and "x3" in memory.extensions and tree.started >= 0
    if wanted and tree.app not in memory.gone_apps:
        memory.report(10, "X3", f"{tree.name} ends, but was to be held for {tree.hold} ms")


def note_substitute(memory: Memory, record: Record) -> None:
    """X6: from now on, Commands that the robot lacks are not requested."""
    if "x6" not in memory.extensions:
        memory.report(3, "X6", f"{record['command']} is replaced, which is not on")
    memory.lacking.add(record["command"])


def gives_way(memory: Memory, ab: AB, reaction: AB) -> bool:
    """X2: whether an AB is certain to be interrupted for a reaction.

    It may not be if the reaction ranks below it (S2a, X7, S2b), or if its state
    was left, so that it must not start again (O3).
    """
    ab = ab.outermost
    may = "x2" in memory.extensions and ab.restartable and not ab.silent
    outranked = _later(reaction, ab) and not memory.third_turn(ab)
    return may and outranked and not memory.is_given_up(ab)


def channel_connected(memory: Memory, ab: AB) -> None:
    """X4: the first word waits until the robot has turned to a user whom it does not see."""
    wanted = "x4" in memory.extensions and ab.connect and not ab.starts
    if wanted and ab.name not in memory.faced and not memory.in_view:
        memory.report(11, "X4", f"{ab.shown} starts, but the robot has not turned to the user")


def close_trees(memory: Memory) -> None:
    """C1, F3: once everything of the instant has been processed, empty trees end."""
    coming = False
    for tree in [tree for tree in memory.trees.values() if not tree.open]:
        if memory.begins.get((memory.now, tree.name), -1) > memory.place:
            coming = True  # it is held from this instant on, and may have the floor
            continue
        _ends_rightly(memory, tree)
        del memory.trees[tree.name]
        memory.ended_trees.add(tree.name)
        if tree in memory.floor:
            memory.floor.remove(tree)
            memory.turned.append((tree.name, "returned", "F3"))
    held = [tree for tree in memory.trees.values() if tree.until is not None]
    if held and not (memory.floor or coming):
        give_floor(memory, max(held, key=lambda tree: tree.held), "X3")


def _reacts_to(by: AB | None, ab: AB) -> TypeGuard[AB]:
    """X2: whether one AB is a reaction that waits for a device of the other."""
    waits = by is not None and by.phase == WAITING and by.cause is not None
    return by is not None and waits and bool(by.devices & ab.devices)


def _later(reaction: AB, ab: AB) -> bool:
    """X2: whether a reaction of high priority has a later cause than a running AB."""
    cause = reaction.cause
    return reaction.high and cause is not None and cause > (ab.reacted or 0)
