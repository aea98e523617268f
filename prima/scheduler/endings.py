"""How ABs leave working memory: when they end, by O2, O3 or E2, or with their unit (U5)."""

from __future__ import annotations

from collections.abc import Iterable

from prima.messages import Data, Notice
from prima.scheduler.admission import link
from prima.scheduler.behavior import (
    GONE,
    LINKED,
    RUNNING,
    WAITING,
    Application,
    AwaitedRun,
    Behavior,
    Stream,
)
from prima.scheduler.mediation import Mediation

# By themselves ------------------------------------------------------------------------------------


def u2(mediation: Mediation, ab: Behavior, goal: bool, data: Data, inbound: bool) -> None:
    """U1, U2: an AB, or one loop of a feedback Command, ends by itself."""
    ending = goal or ab.silent or not ab.feedback
    outcome = str(data.get("outcome", "done")) if ending else "again"
    mediation.recorder.end(ab, outcome, goal, data, inbound)
    if not goal:
        note_rolling(mediation, ab)
    if "x1" in mediation.policy.extensions:
        _note_effects(mediation, ab, data, ending)
    if not inbound:
        _note_answer(mediation, ab.stream, outcome)
    if ending:
        _finish(mediation, ab, data)
    else:
        mediation.memory.release(ab)
        ab.freed = mediation.now
        mediation.memory.wait(ab)


def _note_answer(mediation: Mediation, stream: Stream, outcome: str) -> None:
    """E6, X7: note that a question has ended by what the user said."""
    stream.answered = mediation.now
    if outcome == "filled":
        mediation.memory.answered = stream


def note_rolling(mediation: Mediation, ab: Behavior) -> None:
    """F5: note that the body rolls on after a loop of this Command unless another one follows."""
    if ab.feedback and "locomotion" in ab.devices:
        mediation.rolling = ab


def _note_effects(mediation: Mediation, ab: Behavior, data: Data, ending: bool) -> None:
    """X1: note how a Command has changed the robot's state; its stream relies on it."""
    assert ab.type is not None and ab.command is not None
    mediation.robot.moved(ab.type, ab.command, data)
    if ab.inserted != "X1" and (ending or "follow" in ab.type.effects):
        ab.stream.effects.add(ab.type, ab.command, data, mediation.robot)


def forget_effects(ab: Behavior) -> None:
    """X1: nothing relies on the effects of a Command that is cut short or fails."""
    if ab.begun and ab.type is not None and ab.inserted != "X1":
        ab.stream.effects.forget(ab.type.effects)


def _finish(mediation: Mediation, ab: Behavior, data: Data, cause: int | None = None) -> None:
    """Remove an AB that has ended and notify its application, which may react to ``cause``."""
    run = ab.run
    remove(mediation, ab)
    if ab.silent or run is None:
        return
    run.left -= 1
    notices = []
    if ab.command is not None:
        notices.append(Notice("ended", run.number, ab.command, data))
    if run.left == 0:
        done = Notice("done", run.number, ab.command, data)
        done.cause = cause
        notices.append(done)
    mediation.tell(ab.app, ab.stream, *notices)


def answered(mediation: Mediation, ab: Behavior, data: Data, rule: str, serial: int) -> None:
    """X8, X10: the user has answered a question before it was asked.

    If the question is a reaction, what follows it becomes a reaction to what the user said: the
    event with the number ``serial``.
    """
    mediation.recorder.behavior("cancel", ab, rule=rule, outcome="answered", data=dict(data))
    _note_answer(mediation, ab.stream, "filled")
    for child in ab.children:
        for name in ab.waits_for:  # what was to come before the question comes before the rest
            link(mediation.memory.behaviors[name], child)
        if ab.reaction is not None and child.waits_for == {ab.name}:
            child.reaction = serial
    _finish(mediation, ab, data, None if ab.reaction is None else serial)


def settle(mediation: Mediation, unit: Behavior) -> None:
    """U4, U5: end a unit when its Commands, or those that were left to run in it, have ended."""
    inside = unit.inside
    assert inside is not None
    if unit.state is not RUNNING or inside.members or inside.open:
        return
    mediation.recorder.end(unit, "done", True, {}, inbound=False)
    _finish(mediation, unit, {})


# Before their end ---------------------------------------------------------------------------------


def last_first(behaviors: Iterable[Behavior]) -> list[Behavior]:
    """ABs as they are deleted: what follows others before them (X1, X4 and X9 insert later)."""
    latest = [*behaviors][::-1]
    return [ab for ab in latest if not ab.inserted] + [ab for ab in latest if ab.inserted]


def cancel(mediation: Mediation, behaviors: list[Behavior], devices: frozenset[str]) -> None:
    """O2: delete ABs; one that runs on the devices is cut short, others finish."""
    for ab in last_first(behaviors):
        if ab.state is GONE or ab.in_group:
            continue
        heard = not ab.silent
        if ab.state is RUNNING and not ab.devices & devices:
            ab.silent = True
        else:
            delete(mediation, ab, "O2")
        if heard:
            tell_cancelled(mediation, ab)


def tell_cancelled(mediation: Mediation, ab: Behavior) -> None:
    """Notify an application that one of its ABs was deleted."""
    if ab.run is not None:
        name = ab.command.asked if ab.command else "iu"
        notice = Notice("cancelled", ab.run.number, ab.command, event=f"cancel.{name}")
        mediation.tell(ab.app, None, notice)


def withdraw(mediation: Mediation, behaviors: list[Behavior], rule: str) -> None:
    """O3, E2: delete ABs that have not started; running ones finish, and nobody is notified."""
    for ab in last_first(behaviors):
        if ab.in_group:
            continue
        if ab.state is RUNNING:
            ab.silent = True
            ab.left = True
            if ab.listening:
                delete(mediation, ab, rule)
        elif not ab.spans:
            delete(mediation, ab, rule)


def delete(mediation: Mediation, ab: Behavior, rule: str) -> None:
    """Remove an AB before its end; a running one is aborted."""
    if ab.inside is not None:
        ab.inside.open = True  # a unit that is deleted does not settle as done
        for inner in list(ab.inside.members.values()):
            delete(mediation, inner, rule)
    if ab.state is RUNNING and ab.command is not None:
        mediation.order("abort", ab)
        note_rolling(mediation, ab)
    forget_effects(ab)
    mediation.recorder.behavior("cancel", ab, rule=rule, outcome=ab.state)
    remove(mediation, ab)


def delete_rest(
    mediation: Mediation, tree: dict[str, Behavior], run: AwaitedRun | None, rule: str
) -> None:
    """E1, U5: delete what has not started of a failed tree, its feedback Commands' next loops too.

    Other runs in it are cancelled.
    """
    for other in last_first(tree.values()):
        if other.in_group:
            continue
        if other.state in (LINKED, WAITING):
            delete(mediation, other, rule)
        elif other.feedback and not (other.silent or other.inserted):
            other.silent = True
        else:
            continue
        if other.run is not run:
            tell_cancelled(mediation, other)


def remove(mediation: Mediation, ab: Behavior) -> None:
    """Remove an AB from working memory; ABs linked behind it may now compete (O1, U3)."""
    unit, memory = ab.unit, mediation.memory
    memory.remove(ab)
    mediation.touch(ab.stream)
    for child in ab.children:
        child.waits_for.discard(ab.name)
        if child.state is LINKED and not child.waits_for:
            child.freed = mediation.now
            memory.wait(child)
    if ab.inside is not None:
        ab.app.units = {key: held for key, held in ab.app.units.items() if held is not ab}
    if unit is not None:
        settle(mediation, unit)


def close_unit(mediation: Mediation, app: Application, number: int) -> None:
    """U5: a unit is left: its running ABs finish, the others are deleted."""
    unit = app.units.pop(number, None)
    if unit is None:
        return
    assert unit.inside is not None
    unit.inside.open, unit.late = False, None
    for ab in reversed(list(unit.inside.members.values())):
        if ab.state is RUNNING:
            ab.silent = True
        elif ab.state is not GONE:
            delete(mediation, ab, "U5")
    if unit.name in mediation.memory.running:
        settle(mediation, unit)
    elif unit.name in mediation.memory.behaviors:
        delete(mediation, unit, "U5")
