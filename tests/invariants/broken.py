"""Rules of the scheduler, broken: each function takes the place of one, or patches it."""

from __future__ import annotations

import pytest

from prima.messages import Command, Data
from prima.scheduler import (
    endings,
    freshness,
    interruption,
    preparation,
    requests,
    rules,
    selection,
    streams,
)
from prima.scheduler.behavior import Application, Behavior, Stream
from prima.scheduler.mediation import Mediation
from prima.scheduler.memory import WorkingMemory
from prima.scheduler.policy import Policy
from prima.scheduler.robot_state import Effects, RobotState
from prima.scheduler.rules import Refusal
from tests.helpers.generated.scripts import Ask, Leave, Script
from tests.helpers.generated.world import World
from tests.helpers.rebinding import rebind


def at_events(*deeds: tuple[str, Ask | Leave]) -> Script:
    """Each deed is done by its application about an event of its own, 50 ms apart."""
    events = tuple(
        (50 * number, ((deed,), ()) if app == "fa" else ((), (deed,)))
        for number, (app, deed) in enumerate(deeds, 1)
    )
    return Script(((), ()), events, (), World())


def devices_shared(patch: pytest.MonkeyPatch) -> None:
    """S1 is gone."""

    def conflict(memory: WorkingMemory, ab: Behavior) -> None:
        return None

    rebind(patch, WorkingMemory, "conflict", conflict)


def running_cut(patch: pytest.MonkeyPatch) -> None:
    """O3 cuts short what runs."""

    withdraw = endings.withdraw

    def cut(mediation: Mediation, behaviors: list[Behavior], rule: str) -> None:
        for ab in behaviors:
            if ab.state == "running" and not ab.in_group:
                endings.delete(mediation, ab, rule)
        left = [ab for ab in behaviors if ab.name in mediation.memory.behaviors]
        withdraw(mediation, left, rule)

    rebind(patch, endings, "withdraw", cut)


def run_twice(patch: pytest.MonkeyPatch) -> None:
    """What has ended competes once more."""
    finish = endings._finish
    seen: set[int] = set()

    def again(mediation: Mediation, ab: Behavior, data: Data) -> None:
        if ab.group is None and ab.unit is None and id(ab) not in seen:
            seen.add(id(ab))
            kept.append(ab)
            mediation.memory.release(ab)
            mediation.memory.wait(ab)
        else:
            finish(mediation, ab, data)

    kept: list[Behavior] = []  # so that no other AB gets the same id
    rebind(patch, endings, "_finish", again)


def children_lost(patch: pytest.MonkeyPatch) -> None:
    """A parent's end takes its children with it."""
    remove = WorkingMemory.remove

    def forget(memory: WorkingMemory, ab: Behavior) -> None:
        remove(memory, ab)
        for child in ab.children:
            if child.name in memory.behaviors:
                remove(memory, child)

    rebind(patch, WorkingMemory, "remove", forget)


def children_early(patch: pytest.MonkeyPatch) -> None:
    """Children do not wait for their parents."""
    add = WorkingMemory.add

    def at_once(memory: WorkingMemory, ab: Behavior) -> None:
        ab.waits_for.clear()
        add(memory, ab)

    rebind(patch, WorkingMemory, "add", at_once)


def never_resumed(patch: pytest.MonkeyPatch) -> None:
    """What is not reactive waits for nothing, for ever."""

    def refusal(policy: Policy, ab: Behavior, memory: WorkingMemory) -> Refusal | None:
        return None if ab.reaction is not None else ("F2", "nobody")

    rebind(patch, Policy, "refusal", refusal)


def floor_ignored(patch: pytest.MonkeyPatch) -> None:
    """F2 is gone."""

    def refused(ab: Behavior, memory: WorkingMemory) -> None:
        return None

    rebind(patch, rules, "f2", refused)


def nothing_held_back(patch: pytest.MonkeyPatch) -> None:
    """S3 is gone."""

    def holds_back(policy: Policy, ab: Behavior, memory: WorkingMemory) -> bool:
        return False

    rebind(patch, Policy, "holds_back", holds_back)


def reactions_unranked(patch: pytest.MonkeyPatch) -> None:
    """S2b is gone."""

    def rank(ab: Behavior, memory: WorkingMemory) -> tuple[int, ...]:
        return (0, 0, 0)

    rebind(patch, rules, "s2b", rank)


def channel_ignored(patch: pytest.MonkeyPatch) -> None:
    """K1 is gone."""

    def refused(ab: Behavior, memory: WorkingMemory) -> None:
        return None

    rebind(patch, rules, "k1", refused)


def ends_untold(patch: pytest.MonkeyPatch) -> None:
    """Applications do not hear of their Commands' ends."""

    def finish(mediation: Mediation, ab: Behavior, data: Data) -> None:
        endings.remove(mediation, ab)

    rebind(patch, endings, "_finish", finish)


def chance(patch: pytest.MonkeyPatch) -> None:
    """S5 is gone: what was before decides."""
    seen: list[Behavior] = []

    def rank(ab: Behavior) -> int:
        if not any(one is ab for one in seen):
            seen.append(ab)
        return ab.serial * (-1 if len(seen) > 2 else 1)

    rebind(patch, rules, "s2f", rank)


def anything_composed(patch: pytest.MonkeyPatch) -> None:
    """X5 lets any two ABs use one device."""

    def free(mediation: Mediation, ab: Behavior) -> None:
        return None

    rebind(patch, selection, "s1", free)


def carried_by_anything(patch: pytest.MonkeyPatch) -> None:
    """X5 lets a move go on whatever the floor's stream does."""

    def composes(ab: Behavior, memory: WorkingMemory) -> bool:
        return ab.motion == "free"

    rebind(patch, rules, "x5", composes)


def unmarked_interrupted(patch: pytest.MonkeyPatch) -> None:
    """X2 interrupts what is not restartable."""

    def give_way(
        mediation: Mediation, reaction: Behavior, ways: list[Behavior], held: object
    ) -> bool:
        if reaction.reaction is None:
            return False
        for ab in mediation.memory.conflicts(reaction):
            interruption.interrupt(mediation, ab, reaction)
        return True

    rebind(patch, interruption, "x2", give_way)


def everything_interrupted(patch: pytest.MonkeyPatch) -> None:
    """X2 interrupts what is in nobody's way."""
    interrupt = interruption.interrupt

    def all_of_it(mediation: Mediation, ab: Behavior, reaction: Behavior) -> None:
        interrupt(mediation, ab, reaction)
        running = mediation.memory.running
        for other in list(running.values()):
            if other.restartable and other.name in running:
                interrupt(mediation, other, reaction)

    rebind(patch, interruption, "interrupt", all_of_it)


def restarted_in_part(patch: pytest.MonkeyPatch) -> None:
    """X2 starts a unit again, but not all of it."""
    open_group = selection.u4
    opened: list[Behavior] = []

    def open_part(mediation: Mediation, unit: Behavior) -> None:
        if unit in opened and unit.group is not None:
            unit.group.steps = unit.group.steps[:1]
        opened.append(unit)
        open_group(mediation, unit)

    rebind(patch, selection, "u4", open_part)


def restarted_as_new(patch: pytest.MonkeyPatch) -> None:
    """X2 forgets that the AB was interrupted."""
    interrupt = interruption.interrupt

    def forget(mediation: Mediation, ab: Behavior, reaction: Behavior) -> None:
        interrupt(mediation, ab, reaction)
        ab.restarting = False

    rebind(patch, interruption, "interrupt", forget)


def nothing_interrupted(patch: pytest.MonkeyPatch) -> None:
    """X2 is gone, though it is on."""

    def give_way(
        mediation: Mediation, reaction: Behavior, ways: list[Behavior], held: object
    ) -> bool:
        return False

    rebind(patch, interruption, "x2", give_way)


def inserted_beside(patch: pytest.MonkeyPatch) -> None:
    """X4 puts something in, and what it is put in for does not wait."""

    def unwait(memory: WorkingMemory, ab: Behavior) -> None:
        return None

    rebind(patch, WorkingMemory, "unwait", unwait)


def nothing_put_in(patch: pytest.MonkeyPatch) -> None:
    """X1 and X4 are gone, though they are on."""

    def prepare(mediation: Mediation, ab: Behavior) -> bool:
        return False

    rebind(patch, preparation, "prepare", prepare)


def camera_forgotten(patch: pytest.MonkeyPatch) -> None:
    """X4 turns to a user who is seen."""
    prepare = preparation.prepare

    def blind(mediation: Mediation, ab: Behavior) -> bool:
        mediation.memory.in_view = False
        return prepare(mediation, ab)

    rebind(patch, preparation, "prepare", blind)


def restored_for_nothing(patch: pytest.MonkeyPatch) -> None:
    """X1 restores what was not suspended."""
    seen: list[Behavior] = []

    def prepare(mediation: Mediation, ab: Behavior) -> bool:
        if ab.inserted or ab in seen:
            return False
        seen.append(ab)
        turn = Command("set-direction", {"heading": 0.0})
        return preparation.insert(mediation, ab, [turn], "X1")

    rebind(patch, preparation, "prepare", prepare)


def place_forgotten(patch: pytest.MonkeyPatch) -> None:
    """X1 does not know where a stream stood."""

    def missing(effects: Effects, own: frozenset[str], body: RobotState) -> list[Command]:
        return []

    rebind(patch, Effects, "missing", missing)


def held_too_long(patch: pytest.MonkeyPatch) -> None:
    """X3 holds a stream beyond its longest time."""
    keep_open = streams.keep_open

    def longer(mediation: Mediation, stream: Stream) -> None:
        keep_open(mediation, stream)
        mediation.holds[stream.name] += 1000

    rebind(patch, streams, "keep_open", longer)


def not_held(patch: pytest.MonkeyPatch) -> None:
    """X3 is gone, though it is on."""

    def end(mediation: Mediation, stream: Stream) -> None:
        del mediation.memory.streams[stream.name]
        if stream in mediation.memory.floor:
            mediation.memory.floor.remove(stream)

    rebind(patch, streams, "keep_open", end)


def held_without_floor(patch: pytest.MonkeyPatch) -> None:
    """X3 keeps the stream, but not the floor."""
    keep_open = streams.keep_open

    def floorless(mediation: Mediation, stream: Stream) -> None:
        keep_open(mediation, stream)
        if stream in mediation.memory.floor:  # else another stream has it anyway
            mediation.memory.floor.remove(stream)

    rebind(patch, streams, "keep_open", floorless)


def held_without_channel(patch: pytest.MonkeyPatch) -> None:
    """X3 keeps the stream, but not the channel."""
    engages = rules.engages

    def unless_held(stream: Stream, memory: WorkingMemory) -> bool:
        return stream.held_until is None and engages(stream, memory)

    rebind(patch, rules, "engages", unless_held)


def nothing_joins(patch: pytest.MonkeyPatch) -> None:
    """X3 holds a stream that no request joins."""
    stream_of = requests.stream_of

    def apart(mediation: Mediation, app: Application, reaction: int | None) -> Stream:
        holds, mediation.holds = mediation.holds, {}
        found = stream_of(mediation, app, reaction)
        mediation.holds = holds
        return found

    rebind(patch, requests, "stream_of", apart)


def never_too_late(patch: pytest.MonkeyPatch) -> None:
    """X8: a reaction waits as long as it takes."""
    rebind(
        patch, freshness, "_give_up", lambda mediation, root, whole: setattr(root, "stale", None)
    )


def resumed_silently(patch: pytest.MonkeyPatch) -> None:
    """X9: a topic goes on as if nobody had spoken meanwhile."""
    rebind(patch, preparation, "x9", lambda mediation, ab: False)


def spoken_between(patch: pytest.MonkeyPatch) -> None:
    """X7: a reaction is said between an answer and what the asker says to it."""
    rebind(patch, rules, "x7", lambda ab, memory: None)


def always_substituted(patch: pytest.MonkeyPatch) -> None:
    """X6 works though it is off."""
    only = property(lambda policy: frozenset({"x6"}), lambda policy, extensions: None)
    rebind(patch, Policy, "extensions", only)
