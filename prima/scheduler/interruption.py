"""X2: restartable ABs yield to a reaction and start again afterwards."""

from __future__ import annotations

from prima.messages import Command, Data, Notice
from prima.scheduler.admission import commands_of
from prima.scheduler.behavior import GONE, RUNNING, Behavior
from prima.scheduler.mediation import HaltedUnit, Mediation
from prima.scheduler.memory import WorkingMemory
from prima.scheduler.robot_state import pose_of
from prima.scheduler.rules import third_turn

Held = dict[str, Behavior]
"""Devices that waiting ABs hold back from lower-ranked ones, with the AB that does so (S3)."""


def x2(mediation: Mediation, reaction: Behavior, ways: list[Behavior], held: Held) -> bool:
    """X2: interrupt restartable ABs that are in the way of a reaction.

    Args:
        mediation: what is shared.
        reaction: a waiting AB.
        ways: the running ABs on its devices; none if only others hold devices back.
        held: devices that others hold back from it (S3).

    Returns:
        Whether all its devices are free now.
    """
    if any(device in held for device in reaction.devices):
        return False
    if not all(yields(ab, reaction, mediation.memory) for ab in ways):
        return False
    for ab in ways:
        interrupt(mediation, ab, reaction)
    return True


def yields(ab: Behavior, reaction: Behavior, memory: WorkingMemory) -> bool:
    """X2: whether a running AB yields: to a reaction to a later event that it does not outrank.

    What comes before the response to an answer outranks all reactions (X7).
    """
    later = reaction.reaction is not None and ab.reacted < reaction.reaction
    outranked = ab.priority <= reaction.priority and not third_turn(ab, memory)
    return ab.restartable and later and outranked


def interrupt(mediation: Mediation, ab: Behavior, reaction: Behavior) -> None:
    """X2: stop a running AB; it then waits to start again."""
    mediation.recorder.behavior("interrupt", ab, rule="X2", by=reaction.id)
    _remember_parts(mediation, ab)
    _empty(mediation, ab)
    if ab.command is not None:
        mediation.order("interrupt", ab)
    ab.restarting = True
    mediation.memory.release(ab)
    mediation.memory.wait(ab)


def _empty(mediation: Mediation, unit: Behavior) -> None:
    """Remove the contents of a unit that starts again from its beginning."""
    for inner in list(unit.inner.values()):
        _empty(mediation, inner)
        if inner.state is RUNNING and inner.command is not None:
            mediation.order("interrupt", inner)
        mediation.recorder.behavior("cancel", inner, rule="X2", outcome=inner.state)
        mediation.memory.remove(inner)


def _remember_parts(mediation: Mediation, unit: Behavior) -> None:
    """Note what has been done of a unit, to notify its application once the device has reported."""
    if unit.group is None:
        return
    left = _parts(unit)
    pending = {id(one) for part in left for one in _pending(part)}
    every = [*commands_of(unit.group.steps)]
    finished = [command for command in every if id(command) not in pending]
    running = [part for part in left if part.state is RUNNING and part.command is not None]
    reporting = min(running, key=_speaks_first)  # one always runs in a running unit
    mediation.halted_units[reporting.name] = HaltedUnit(unit, finished, len(every))


def _pending(part: Behavior) -> list[Command]:
    """A part's pending Commands; a unit that has begun is counted by its own parts."""
    if part.command is not None:
        return [part.command]
    return [*commands_of(part.group.steps)] if part.group is not None and not part.inner else []


def _speaks_first(part: Behavior) -> tuple[bool, int]:
    return part.command is None or not part.command.text, part.serial


def _parts(unit: Behavior) -> list[Behavior]:
    """All ABs in a unit, at any depth."""
    parts, found = list(unit.inner.values()), []
    while parts:
        part = parts.pop()
        parts += part.inner.values()
        found.append(part)
    return found


def interrupted(mediation: Mediation, behavior: str, data: Data) -> None:
    """X2: the device reports how much it had done of an interrupted AB."""
    name = behavior.partition(".")[0]
    ab = mediation.memory.behaviors.get(name)
    halted = mediation.halted_units.pop(name, None)
    of = ab or (halted.unit if halted is not None else None)
    mediation.recorder.add(
        "halted",
        "robot",
        app=of.app.name if of is not None else None,
        behavior=behavior,
        data=dict(data) or None,
        inbound=True,
    )
    mediation.robot.pose = pose_of(data) or mediation.robot.pose
    if halted is not None:
        _tell(mediation, halted.unit, whole(data, halted))
    elif ab is not None:
        ab.since = {key: data[key] for key in ("mark", "passed") if key in data} or None
        _tell(mediation, ab, data)


def _tell(mediation: Mediation, ab: Behavior, data: Data) -> None:
    if ab.run is None or ab.state is GONE:  # its state has been left meanwhile (O3)
        return
    command = ab.command or Command("iu")
    event = f"interrupted.{command.asked}"
    mediation.tell(ab.app, None, Notice("interrupted", ab.run.number, command, data, event))


def whole(data: Data, halted: HaltedUnit) -> Data:
    """How much of a unit was done, when a device reports on one part."""
    part = float(data.get("done", 0.0))
    said = [command.text for command in halted.finished if command.text]
    heard = " ".join([*said, str(data.get("heard", ""))]).strip()
    made = {"done": round((len(halted.finished) + part) / max(halted.count, 1), 3)}
    return {**made, "heard": heard} if heard else made
