"""Proof that the tests of the invariants can fail: each rule broken on purpose is seen.

A mutation replaces one function of the scheduler. On a small run made for it
exactly one invariant is violated, which holds there without the mutation; and
generated runs meet it as well, without being made for it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from prima.messages import Data
from prima.scheduler import selection
from prima.scheduler.behavior import Behavior
from prima.scheduler.mediator import Mediator
from prima.scheduler.memory import Memory
from prima.scheduler.selection import Policy, Refusal
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

    patch.setattr(selection, "refused_by_floor", refused)


def nothing_held_back(patch: pytest.MonkeyPatch) -> None:
    """S3 is gone."""

    def holds_back(policy: Policy, ab: Behavior) -> bool:
        return False

    patch.setattr(Policy, "holds_back", holds_back)


def reactions_unranked(patch: pytest.MonkeyPatch) -> None:
    """S2b is gone."""

    def rank(ab: Behavior, memory: Memory) -> tuple[int, ...]:
        return (0,)

    patch.setattr(selection, "rank_reaction", rank)


def channel_ignored(patch: pytest.MonkeyPatch) -> None:
    """K1 is gone."""

    def refused(ab: Behavior, memory: Memory) -> None:
        return None

    patch.setattr(selection, "refused_by_channel", refused)


def ends_untold(patch: pytest.MonkeyPatch) -> None:
    """Applications do not hear of their Commands' ends."""

    def finish(mediator: Mediator, ab: Behavior, data: Data) -> None:
        mediator._remove(ab)

    patch.setattr(Mediator, "_finish", finish)


def chance(patch: pytest.MonkeyPatch) -> None:
    """S5 is gone: what was before decides."""
    calls = [0]

    def rank(ab: Behavior) -> tuple[int, ...]:
        calls[0] += 1
        return (ab.serial * (-1 if calls[0] > 2 else 1),)

    patch.setattr(selection, "rank_declared", rank)


@dataclass(frozen=True)
class Mutation:
    """A rule broken on purpose, the invariant that falls, and a run in which it shows."""

    invariant: int
    patch: Patch
    made: Play | Script


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
)
IDS = [f"{mutation.invariant}-{mutation.patch.__name__}" for mutation in MUTATIONS]


def run(made: Play | Script) -> Run:
    return perform(made) if isinstance(made, Play) else drive(made)


@pytest.mark.parametrize("mutation", MUTATIONS, ids=IDS)
def test_a_broken_rule_violates_its_invariant_and_no_other(
    mutation: Mutation, monkeypatch: pytest.MonkeyPatch
) -> None:
    sound = run(mutation.made)
    assert check(sound.records) + sound.problems == []
    mutation.patch(monkeypatch)
    broken = check(run(mutation.made).records)
    assert numbers(broken) == {mutation.invariant}, broken


def test_what_was_before_the_run_violates_invariant_8(monkeypatch: pytest.MonkeyPatch) -> None:
    speaks = BLOCK.format("<speak>Hello.</speak>")
    play = documents(speaks, speaks)
    assert perform(play).lines() == perform(play).lines()
    chance(monkeypatch)
    first, second = perform(play), perform(play)
    assert check(first.records) == check(second.records) == []
    assert first.lines() != second.lines()


def test_an_end_that_is_not_told_violates_invariant_9(monkeypatch: pytest.MonkeyPatch) -> None:
    play = documents(BLOCK.format("<speak>Hello.</speak>"), '<form id="f1"/>')
    assert perform(play).problems == []
    ends_untold(monkeypatch)
    broken = perform(play)
    assert check(broken.records) == []
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
            if mutation.invariant in numbers(check(run(made).records)):
                raise Met

    with pytest.raises(Met):
        meet()
