"""ABs that the mediator inserts before others: ways back (X1), facing the user (X4), words (X9)."""

from __future__ import annotations

from dataclasses import replace

from prima.messages import Command, Step
from prima.scheduler.admission import link
from prima.scheduler.behavior import Behavior, Stream
from prima.scheduler.mediation import Mediation
from prima.scheduler.robot_state import sets
from prima.scheduler.rules import third_turn


def prepare(mediation: Mediation, ab: Behavior) -> bool:
    """X1, X4, X9: insert what has to come first; whether anything was inserted.

    The words of X9 are words, too: the user is faced before them.
    """
    if third_turn(ab, mediation.memory):
        return False
    return x1(mediation, ab) or (not ab.inserted and (x4(mediation, ab) or x9(mediation, ab)))


def x1(mediation: Mediation, ab: Behavior) -> bool:
    """X1: restore the robot's state on which a suspended stream relies.

    If the way back was itself broken, what has been undone of it is done again.
    """
    if not ab.stream.moved_away or wanted_now(ab):
        return False
    coming = [one for one in ab.stream.members.values() if one.inserted == "X1"]
    own = [_sets(mediation, Step(one.what)) for one in (*ab.meant(), *coming)]
    made = ab.stream.effects.missing(frozenset().union(*own), mediation.robot)
    return insert(mediation, ab, made, "X1")


def _sets(mediation: Mediation, step: Step) -> frozenset[str]:
    """The effects of a Command, or of those with which a unit begins."""
    if isinstance(step.what, Command):
        return sets(mediation.table.get(step.what.type), step.what)
    first = [_sets(mediation, one) for one in step.what.steps if not one.after]
    return frozenset().union(*first)


def x4(mediation: Mediation, ab: Behavior) -> bool:
    """X4: face the user before a conversation begins.

    While they are in view nothing is decided: they may go before the first word is said.
    """
    wanted = ab.connect and "x4" in mediation.policy.extensions
    if not wanted or mediation.memory.in_view:
        return False
    ab.connect = False
    return insert(mediation, ab, [Command("face-human")], "X4")


def x9(mediation: Mediation, ab: Behavior) -> bool:
    """X9: a topic that resumes after others have spoken says so first.

    Reactions and Commands with ``now`` do not resume the topic: they begin something else.
    """
    stream, words = ab.stream, ab.stream.words
    if not stream.words_due or words is None or ab.reaction is not None or wanted_now(ab):
        return False
    return insert(mediation, ab, [replace(words)], "X9")


def note_resumed(mediation: Mediation, ab: Behavior, response: bool, begins: bool) -> None:
    """X1, X9: a starting AB speaks into the pause of every suspended topic, or resumes one.

    A ``response`` to an answer leaves to what follows it how the topic resumes (X7), and what
    ``begins`` now leaves to it the robot's state (O2).
    """
    if ab.says:
        for stream in mediation.memory.streams.values():
            if stream.app is not ab.app and stream.suspended and stream.spoken:
                stream.words_due = True
    if response:
        return
    if ab.inserted in ("", "X9"):
        ab.stream.words_due = False  # also for what was said while the words waited
    ab.stream.moved_away = ab.stream.moved_away and begins


def insert(mediation: Mediation, ab: Behavior, commands: list[Command], rule: str) -> bool:
    """Insert Commands between an AB and what it follows, in its stream and with its rank."""
    table, maker = mediation.table, mediation.maker
    before: Behavior | None = None
    for command in commands:
        if command.type not in table or table[command.type].substitute:
            continue
        command.source = command.source or (ab.command.source if ab.command else "")
        made = maker.behavior(ab.app, ab.stream, command, mediation.now, ab.document_state)
        made.inserted, made.requested, made.serial = rule, ab.requested, ab.serial
        if rule == "X4":  # the first word follows at once, so its devices are taken along
            made.devices |= ab.devices
        if before is None:
            made.parent, made.reaction, made.freed = ab.parent, ab.reaction, ab.freed
            made.stale, ab.reaction, ab.stale = ab.stale, None, None
            if rule != "X1":  # which needs no speaker
                made.wait = ab.wait
        else:
            link(before, made)
        mediation.memory.add(made)
        mediation.recorder.request(made, before=ab.id)
        before = made
    if before is None:
        return False
    put_behind(mediation, before, ab)
    return True


def put_behind(mediation: Mediation, before: Behavior, ab: Behavior) -> None:
    """Let a waiting AB wait for another that has been inserted."""
    link(before, ab)
    mediation.memory.unwait(ab)


def join_first(mediation: Mediation) -> None:
    """X1, X9: ABs that wait in a stream wait for its inserted way back or words, if any.

    Commands with ``now`` do not: they wait for nothing of their own application (O2).
    """
    if not ("x1" in mediation.policy.extensions or "x9" in mediation.policy.extensions):
        return
    for ab in list(mediation.memory.waiting.values()):
        first = None if ab.inserted else first_of(ab.stream)
        if first is not None and not (wanted_now(ab) or third_turn(ab, mediation.memory)):
            put_behind(mediation, first, ab)


def wanted_now(ab: Behavior) -> bool:
    """O2: whether an AB waits for nothing of its own application; what resumes does."""
    return ab.what.now and not ab.begun


def first_of(stream: Stream) -> Behavior | None:
    """X1, X9: an AB inserted for a stream to resume with, while it is in memory."""
    return next((one for one in stream.members.values() if one.inserted in ("X1", "X9")), None)
