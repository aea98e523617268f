"""What the mediator itself puts in before an AB: a way back (X1), or facing the user (X4)."""

from __future__ import annotations

from prima.messages import Command
from prima.scheduler.admission import link
from prima.scheduler.behavior import Behavior, Stream
from prima.scheduler.mediation import Mediation
from prima.scheduler.rules import third_turn


def prepare(mediation: Mediation, ab: Behavior) -> bool:
    """X1, X4: put in what has to come first; true if something was put in."""
    if ab.inserted or third_turn(ab, mediation.memory):
        return False
    return x1(mediation, ab) or x4(mediation, ab)


def x1(mediation: Mediation, ab: Behavior) -> bool:
    """X1: bring the robot's state back on which a suspended stream relies."""
    if not (ab.stream.suspended and mediation.has("x1")) or way_back(ab.stream) is not None:
        return False
    own = ab.type.effects if ab.type is not None else frozenset()
    return insert(mediation, ab, ab.stream.effects.missing(own, mediation.robot), "X1")


def x4(mediation: Mediation, ab: Behavior) -> bool:
    """X4: face the user before a conversation begins."""
    if not (ab.connect and mediation.has("x4")):
        return False
    ab.connect = False
    return not mediation.memory.in_view and insert(mediation, ab, [Command("face-human")], "X4")


def insert(mediation: Mediation, ab: Behavior, commands: list[Command], rule: str) -> bool:
    """Put Commands between an AB and what it follows, in its stream and in its place."""
    table, maker = mediation.table, mediation.maker
    before: Behavior | None = None
    for command in commands:
        if command.type not in table or table[command.type].substitute:
            continue
        command.source = ab.command.source if ab.command else ""
        made = maker.behavior(ab.app, ab.stream, command, mediation.now, ab.document_state)
        made.inserted, made.requested, made.serial = rule, ab.requested, ab.serial
        if rule == "X4":  # the first word follows at once, so its devices are taken along
            made.devices |= ab.devices
        if before is None:
            made.parent, made.reaction, made.freed = ab.parent, ab.reaction, ab.freed
            ab.reaction = None
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
    """Let a waiting AB wait for another that has been put in."""
    link(before, ab)
    mediation.memory.unwait(ab)


def join_ways_back(mediation: Mediation) -> None:
    """X1: whatever waits in a stream waits for the way back that is put in, if one is.

    What is wanted ``now`` does not: it waits for nothing of its own application (O2).
    """
    if not mediation.has("x1"):
        return
    for ab in list(mediation.memory.waiting.values()):
        way = None if ab.inserted else way_back(ab.stream)
        urgent = ab.command is not None and ab.command.now
        if way is not None and not (urgent or third_turn(ab, mediation.memory)):
            put_behind(mediation, way, ab)


def way_back(stream: Stream) -> Behavior | None:
    """X1: the last part of the way back that was put in for a stream, while it is there."""
    members = reversed(stream.members.values())
    return next((one for one in members if one.inserted == "X1"), None)
