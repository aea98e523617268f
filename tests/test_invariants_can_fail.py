"""Proof that the tests of the invariants can fail: each rule broken on purpose is seen.

A mutation replaces one function of the scheduler. On a small run made for it
exactly one invariant is violated, which holds there without the mutation; and
generated runs meet it as well, without being made for it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from prima.messages import Command, Data
from prima.scheduler import rules
from prima.scheduler.behavior import Application, Behavior, Stream
from prima.scheduler.effects import Body, Effects
from prima.scheduler.mediator import Mediator
from prima.scheduler.memory import Memory
from prima.scheduler.rules import Refusal
from prima.scheduler.selection import Policy
from prima.scheduler.selector import Selector
from tests.generated import Ask, Leave, Play, Run, Script, World, drive, perform, plays, scripts
from tests.invariants import check, numbers

Patch = Callable[[pytest.MonkeyPatch], None]

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="{}">{}</prima>'
BLOCK = '<form id="f1"><block>{}</block></form>'
FIELD = (
    '<form id="f1"><field name="q" type="boolean"><prompt>Well?</prompt></field>'
    "<block><speak>Good.</speak></block></form>"
)


def documents(fa: str, ea: str) -> Play:
    return Play((HEAD.format("fa", fa), HEAD.format("ea", ea)), (0, 0), (), World())


def one(*whats: str) -> Ask:
    """Commands one after another."""
    return Ask(whats, tuple((index - 1,) if index else () for index in range(len(whats))))


def at_events(*deeds: tuple[str, Ask | Leave]) -> Script:
    """Each deed is done by its application about an event of its own, 50 ms apart."""
    events = tuple(
        (50 * number, ((deed,), ()) if app == "fa" else ((), (deed,)))
        for number, (app, deed) in enumerate(deeds, 1)
    )
    return Script(((), ()), events, (), World())


def devices_shared(patch: pytest.MonkeyPatch) -> None:
    """S1 is gone."""

    def conflict(memory: Memory, ab: Behavior) -> None:
        return None

    patch.setattr(Memory, "conflict", conflict)


def running_cut(patch: pytest.MonkeyPatch) -> None:
    """O3 cuts short what runs."""

    def silence(mediator: Mediator, ab: Behavior) -> None:
        mediator._delete(ab, "O3")

    patch.setattr(Mediator, "_silence", silence)


def run_twice(patch: pytest.MonkeyPatch) -> None:
    """What has ended competes once more."""
    finish = Mediator._finish
    seen: set[int] = set()

    def again(mediator: Mediator, ab: Behavior, data: Data) -> None:
        if ab.group is None and ab.unit is None and id(ab) not in seen:
            seen.add(id(ab))
            kept.append(ab)
            mediator.memory.release(ab)
            mediator.memory.wait(ab)
        else:
            finish(mediator, ab, data)

    kept: list[Behavior] = []  # so that no other AB gets the same id
    patch.setattr(Mediator, "_finish", again)


def children_lost(patch: pytest.MonkeyPatch) -> None:
    """A parent's end takes its children with it."""
    remove = Memory.remove

    def forget(memory: Memory, ab: Behavior) -> None:
        remove(memory, ab)
        for child in ab.children:
            if child.name in memory.behaviors:
                remove(memory, child)

    patch.setattr(Memory, "remove", forget)


def children_early(patch: pytest.MonkeyPatch) -> None:
    """Children do not wait for their parents."""
    add = Memory.add

    def at_once(memory: Memory, ab: Behavior) -> None:
        ab.waits_for.clear()
        add(memory, ab)

    patch.setattr(Memory, "add", at_once)


def never_resumed(patch: pytest.MonkeyPatch) -> None:
    """What is not reactive waits for nothing, for ever."""

    def refusal(policy: Policy, ab: Behavior, memory: Memory) -> Refusal | None:
        return None if ab.reaction is not None else ("F2", "nobody")

    patch.setattr(Policy, "refusal", refusal)


def floor_ignored(patch: pytest.MonkeyPatch) -> None:
    """F2 is gone."""

    def refused(ab: Behavior, memory: Memory) -> None:
        return None

    patch.setattr(rules, "f2", refused)


def nothing_held_back(patch: pytest.MonkeyPatch) -> None:
    """S3 is gone."""

    def holds_back(policy: Policy, ab: Behavior) -> bool:
        return False

    patch.setattr(Policy, "holds_back", holds_back)


def reactions_unranked(patch: pytest.MonkeyPatch) -> None:
    """S2b is gone."""

    def rank(ab: Behavior, memory: Memory) -> tuple[int, ...]:
        return (0, 0, 0)

    patch.setattr(rules, "s2b", rank)


def channel_ignored(patch: pytest.MonkeyPatch) -> None:
    """K1 is gone."""

    def refused(ab: Behavior, memory: Memory) -> None:
        return None

    patch.setattr(rules, "k1", refused)


def ends_untold(patch: pytest.MonkeyPatch) -> None:
    """Applications do not hear of their Commands' ends."""

    def finish(mediator: Mediator, ab: Behavior, data: Data) -> None:
        mediator._remove(ab)

    patch.setattr(Mediator, "_finish", finish)


def chance(patch: pytest.MonkeyPatch) -> None:
    """S5 is gone: what was before decides."""
    seen: list[Behavior] = []

    def rank(ab: Behavior) -> int:
        if not any(one is ab for one in seen):
            seen.append(ab)
        return ab.serial * (-1 if len(seen) > 2 else 1)

    patch.setattr(rules, "s2f", rank)


# The extensions, broken ------------------------------------------------------------


def anything_composed(patch: pytest.MonkeyPatch) -> None:
    """X5 lets any two ABs use one device."""

    def occupant(selector: Selector, ab: Behavior) -> None:
        return None

    patch.setattr(Selector, "_occupant", occupant)


def carried_by_anything(patch: pytest.MonkeyPatch) -> None:
    """X5 lets a move go on whatever the floor's stream does."""

    def composes(ab: Behavior, memory: Memory) -> bool:
        return ab.motion == "free"

    patch.setattr(rules, "x5", composes)


def unmarked_interrupted(patch: pytest.MonkeyPatch) -> None:
    """X2 interrupts what is not restartable."""

    def give_way(selector: Selector, reaction: Behavior, held: object) -> bool:
        if reaction.reaction is None:
            return False
        for ab in selector.memory.conflicts(reaction):
            selector._interrupt(ab, reaction)
        return True

    patch.setattr(Selector, "_give_way", give_way)


def everything_interrupted(patch: pytest.MonkeyPatch) -> None:
    """X2 interrupts what is in nobody's way."""
    interrupt = Selector._interrupt

    def all_of_it(selector: Selector, ab: Behavior, reaction: Behavior) -> None:
        interrupt(selector, ab, reaction)
        for other in list(selector.memory.running.values()):
            if other.restartable and other.name in selector.memory.running:
                interrupt(selector, other, reaction)

    patch.setattr(Selector, "_interrupt", all_of_it)


def restarted_in_part(patch: pytest.MonkeyPatch) -> None:
    """X2 starts a unit again, but not all of it."""
    open_group = Selector._open_group
    opened: list[Behavior] = []

    def open_part(selector: Selector, unit: Behavior, now: int) -> None:
        if unit in opened and unit.group is not None:
            unit.group.steps = unit.group.steps[:1]
        opened.append(unit)
        open_group(selector, unit, now)

    patch.setattr(Selector, "_open_group", open_part)


def restarted_as_new(patch: pytest.MonkeyPatch) -> None:
    """X2 forgets that the AB was interrupted."""
    interrupt = Selector._interrupt

    def forget(selector: Selector, ab: Behavior, reaction: Behavior) -> None:
        interrupt(selector, ab, reaction)
        ab.restarting = False

    patch.setattr(Selector, "_interrupt", forget)


def nothing_interrupted(patch: pytest.MonkeyPatch) -> None:
    """X2 is gone, though it is on."""

    def give_way(selector: Selector, reaction: Behavior, held: object) -> bool:
        return False

    patch.setattr(Selector, "_give_way", give_way)


def inserted_beside(patch: pytest.MonkeyPatch) -> None:
    """X4 puts something in, and what it is put in for does not wait."""

    def unwait(memory: Memory, ab: Behavior) -> None:
        return None

    patch.setattr(Memory, "unwait", unwait)


def nothing_put_in(patch: pytest.MonkeyPatch) -> None:
    """X1 and X4 are gone, though they are on."""

    def prepare(selector: Selector, ab: Behavior, now: int) -> bool:
        return False

    patch.setattr(Selector, "_prepare", prepare)


def camera_forgotten(patch: pytest.MonkeyPatch) -> None:
    """X4 turns to a user who is seen."""
    prepare = Selector._prepare

    def blind(selector: Selector, ab: Behavior, now: int) -> bool:
        selector.memory.in_view = False
        return prepare(selector, ab, now)

    patch.setattr(Selector, "_prepare", blind)


def restored_for_nothing(patch: pytest.MonkeyPatch) -> None:
    """X1 restores what was not suspended."""
    seen: list[Behavior] = []

    def prepare(selector: Selector, ab: Behavior, now: int) -> bool:
        if ab.inserted or ab in seen:
            return False
        seen.append(ab)
        return selector._insert(ab, [Command("set-direction", {"heading": 0.0})], "X1", now)

    patch.setattr(Selector, "_prepare", prepare)


def place_forgotten(patch: pytest.MonkeyPatch) -> None:
    """X1 does not know where a stream stood."""

    def missing(effects: Effects, own: frozenset[str], body: Body) -> list[Command]:
        return []

    patch.setattr(Effects, "missing", missing)


def held_too_long(patch: pytest.MonkeyPatch) -> None:
    """X3 holds a stream beyond its longest time."""
    keep_open = Mediator._keep_open

    def longer(mediator: Mediator, stream: Stream) -> None:
        keep_open(mediator, stream)
        mediator.holds[stream.name] += 1000

    patch.setattr(Mediator, "_keep_open", longer)


def not_held(patch: pytest.MonkeyPatch) -> None:
    """X3 is gone, though it is on."""

    def end(mediator: Mediator, stream: Stream) -> None:
        del mediator.memory.streams[stream.name]
        if stream in mediator.memory.floor:
            mediator.memory.floor.remove(stream)

    patch.setattr(Mediator, "_keep_open", end)


def held_without_floor(patch: pytest.MonkeyPatch) -> None:
    """X3 keeps the stream, but not the floor."""
    keep_open = Mediator._keep_open

    def floorless(mediator: Mediator, stream: Stream) -> None:
        keep_open(mediator, stream)
        if stream in mediator.memory.floor:  # else another stream has it anyway
            mediator.memory.floor.remove(stream)

    patch.setattr(Mediator, "_keep_open", floorless)


def held_without_channel(patch: pytest.MonkeyPatch) -> None:
    """X3 keeps the stream, but not the channel."""
    engages = rules.engages

    def unless_held(stream: Stream, memory: Memory) -> bool:
        return stream.held_until is None and engages(stream, memory)

    patch.setattr(rules, "engages", unless_held)


def nothing_joins(patch: pytest.MonkeyPatch) -> None:
    """X3 holds a stream that no request joins."""
    stream = Mediator._stream

    def apart(mediator: Mediator, app: Application, reaction: int | None) -> Stream:
        holds, mediator.holds = mediator.holds, {}
        found = stream(mediator, app, reaction)
        mediator.holds = holds
        return found

    patch.setattr(Mediator, "_stream", apart)


def always_substituted(patch: pytest.MonkeyPatch) -> None:
    """X6 works though it is off."""

    def has(policy: Policy, extension: str) -> bool:
        return extension == "x6"

    patch.setattr(Policy, "has", has)


@dataclass(frozen=True)
class Mutation:
    """A rule broken on purpose, the invariant that falls, and a run in which it shows."""

    invariant: int
    patch: Patch
    made: Play | Script
    policy: str = "prima"


STORY = Ask(("speak",), ((),), restartable=True)
YES = ("fa", one("speak"))
CONNECTED = Ask(("speak",), ((),), connect=True)
HELD = Ask(("speak",), ((),), hold=6000)
GOES = (one("topological-move"),)
TWICE = Script(((), ()), ((50, ((HELD,), ())), (4000, ((HELD,), ()))), (), World())
"""Its stream is held when the application asks again."""
TAKEN_AWAY = Script(
    ((), ()),
    (
        (50, ((), (one("set-position", *("speak",) * 6),))),
        (4000, ((one("set-speed-and-time"),), ())),
    ),
    (),
    World(),
)
"""The robot has gone somewhere to speak, when the other application drives it away."""
TWO_BRANCHES = Ask(("turn", "speak", "turn", "speak", "turn"), ((), (), (0,), (1,), (2,)))

MUTATIONS = (
    Mutation(1, devices_shared, at_events(("fa", one("speak")), ("ea", one("speak")))),
    Mutation(2, running_cut, at_events(("fa", one("speak")), ("fa", Leave()))),
    Mutation(3, run_twice, at_events(("fa", one("speak")))),
    Mutation(3, children_lost, at_events(("fa", one("speak", "turn")))),
    Mutation(4, children_early, at_events(("fa", one("speak", "turn")))),
    Mutation(5, never_resumed, at_events(("fa", one("speak", "turn")))),
    Mutation(
        5,
        floor_ignored,
        at_events(("ea", one("speak", "move-head")), ("fa", one("turn", "turn", "turn"))),
    ),
    Mutation(
        6,
        nothing_held_back,
        at_events(("fa", TWO_BRANCHES), ("ea", one("face-human-and-speak"))),
    ),
    Mutation(
        6, reactions_unranked, at_events(("fa", one("turn", "turn")), ("ea", one("face-human")))
    ),
    Mutation(7, channel_ignored, documents(FIELD, BLOCK.format('<set-position x="1" y="2"/>'))),
    Mutation(
        7,
        floor_ignored,
        at_events(("ea", one("topological-move")), ("fa", one("speak", "move-head"))),
    ),
    Mutation(
        1,
        anything_composed,
        at_events(("ea", one("topological-move")), ("fa", one("turn"))),
        "prima+x5",
    ),
    Mutation(2, unmarked_interrupted, at_events(("ea", one("speak")), YES), "prima+x2"),
    Mutation(
        2,
        everything_interrupted,
        at_events(("ea", replace(STORY, whats=("speak", "turn"), after=((), ()))), YES),
        "prima+x2",
    ),
    Mutation(
        3,
        restarted_in_part,
        at_events(("ea", replace(STORY, whats=(("speak", "turn"),))), YES),
        "prima+x2",
    ),
    Mutation(3, restarted_as_new, at_events(("ea", STORY), YES), "prima+x2"),
    Mutation(
        3,
        always_substituted,
        replace(at_events(("ea", one("point-by-hand"))), world=World(lacks=True)),
    ),
    Mutation(
        4,
        inserted_beside,
        replace(at_events(("fa", one("turn"))), windows=(((CONNECTED,),), ())),
        "prima+x4",
    ),
    Mutation(
        5,
        held_without_floor,
        at_events(("ea", one("speak", "speak")), ("fa", HELD)),
        "prima+x3",
    ),
    Mutation(
        6,
        nothing_interrupted,
        at_events(("ea", STORY), YES, ("ea", one("move-head"))),
        "prima+x2",
    ),
    Mutation(
        7,
        held_without_channel,
        replace(
            at_events(("fa", replace(HELD, whats=("face-human",)))),
            events=((50, ((replace(HELD, whats=("face-human",)),), ())), (4000, ((), GOES))),
        ),
        "prima+x3",
    ),
    Mutation(
        7,
        carried_by_anything,
        at_events(("ea", one("topological-move")), ("fa", one("speak", "speak"))),
        "prima+x5",
    ),
    Mutation(10, held_too_long, at_events(("fa", HELD)), "prima+x3"),
    Mutation(10, not_held, TWICE, "prima+x3"),
    Mutation(10, nothing_joins, TWICE, "prima+x3"),
    Mutation(11, nothing_put_in, at_events(("fa", CONNECTED)), "prima+x4"),
    Mutation(
        11,
        camera_forgotten,
        replace(at_events(("fa", CONNECTED)), views=((10, True),)),
        "prima+x4",
    ),
    Mutation(11, restored_for_nothing, at_events(("fa", one("speak"))), "prima+x1"),
    Mutation(11, place_forgotten, TAKEN_AWAY, "prima+x1"),
)
IDS = [f"{mutation.invariant}-{mutation.patch.__name__}" for mutation in MUTATIONS]


def run(made: Play | Script, policy: str = "prima") -> Run:
    return perform(made, policy) if isinstance(made, Play) else drive(made, policy)


TOLD = {12, 13, 14, 15}
"""The order of all, and what records say: it falls with any rule (tests/test_corrupted_records.py)."""


@pytest.mark.parametrize("mutation", MUTATIONS, ids=IDS)
def test_a_broken_rule_violates_its_invariant_and_no_other(
    mutation: Mutation, monkeypatch: pytest.MonkeyPatch
) -> None:
    sound = run(mutation.made, mutation.policy)
    assert check(sound.records, mutation.policy) + sound.problems == []
    mutation.patch(monkeypatch)
    broken = check(run(mutation.made, mutation.policy).records, mutation.policy)
    assert numbers(broken) - TOLD == {mutation.invariant}, broken


def test_what_was_before_the_run_violates_invariant_8(monkeypatch: pytest.MonkeyPatch) -> None:
    speaks = BLOCK.format("<speak>Hello.</speak>")
    play = documents(speaks, speaks)
    assert perform(play).lines() == perform(play).lines()
    chance(monkeypatch)
    first, second = perform(play), perform(play)
    assert numbers(check(first.records) + check(second.records)) <= TOLD
    assert first.lines() != second.lines()


def test_an_end_that_is_not_told_violates_invariant_9(monkeypatch: pytest.MonkeyPatch) -> None:
    play = documents(BLOCK.format("<speak>Hello.</speak>"), '<form id="f1"/>')
    assert perform(play).problems == []
    ends_untold(monkeypatch)
    broken = perform(play)
    assert numbers(check(broken.records)) == {15}, "nor does the end open a window"
    assert numbers(broken.problems) == {9}


class Met(Exception):
    """A generated run violates the invariant."""


@pytest.mark.parametrize("mutation", MUTATIONS, ids=IDS)
def test_generated_runs_meet_it_too(mutation: Mutation, monkeypatch: pytest.MonkeyPatch) -> None:
    mutation.patch(monkeypatch)

    @given(plays(), scripts())
    @settings(
        max_examples=2000,
        phases=(Phase.generate,),
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    def meet(play: Play, script: Script) -> None:
        for made in (play, script):
            try:
                records = run(made, mutation.policy).records
            except (AssertionError, KeyError, ValueError):
                continue  # a broken mediator may break down: that is no violation told
            if mutation.invariant in numbers(check(records, mutation.policy)):
                raise Met

    with pytest.raises(Met):
        meet()
