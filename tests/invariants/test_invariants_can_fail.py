"""Proof that the tests of the invariants can fail: each rule broken on purpose is seen.

A mutation replaces one function of the scheduler. On a small run made for it
exactly one invariant is violated, which holds there without the mutation; and
generated runs meet it as well, without being made for it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest
from hypothesis import HealthCheck, Phase, given, seed, settings

from prima.invariants import check
from tests.helpers.generated.plays import Play, perform, plays
from tests.helpers.generated.scripts import Ask, Leave, Script, drive, scripts
from tests.helpers.generated.world import Run, World
from tests.helpers.violations import numbers
from tests.invariants.broken import (
    always_substituted,
    anything_composed,
    at_events,
    camera_forgotten,
    carried_by_anything,
    chance,
    channel_ignored,
    children_early,
    children_lost,
    devices_shared,
    ends_untold,
    everything_interrupted,
    floor_ignored,
    held_too_long,
    held_without_channel,
    held_without_floor,
    inserted_beside,
    never_resumed,
    never_too_late,
    not_held,
    nothing_held_back,
    nothing_interrupted,
    nothing_joins,
    nothing_put_in,
    place_forgotten,
    reactions_unranked,
    restarted_as_new,
    restarted_in_part,
    restored_for_nothing,
    resumed_silently,
    run_twice,
    running_cut,
    spoken_between,
    unmarked_interrupted,
)

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


ANSWERED = Script(
    (((Ask(("move-head", "speak"), ((), (0,))),),), ()),
    ((10, ((one("q-and-a"),), ())), (20, ((), (one("speak"),)))),
    (),
    World(),
)
"""A question is answered while a reaction waits to speak; the asker's word follows a movement."""

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
        16,
        never_too_late,
        at_events(
            ("ea", one("speak")),
            ("fa", replace(one("speak"), fresh=1)),
            ("ea", one("move-head")),
        ),
        "prima+x8",
    ),
    Mutation(16, spoken_between, ANSWERED, "prima+x7"),
    Mutation(
        16,
        resumed_silently,
        at_events(("ea", replace(one("speak", "speak"), words=True)), ("fa", one("speak"))),
        "prima+x9",
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
"""The order of all, and what records say: it falls with any rule (tests/invariants/test_corrupted_records.py)."""


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

    @given(plays() if isinstance(mutation.made, Play) else scripts())
    @settings(
        max_examples=30,  # the runs of one seed are alike, so that many seeds meet more
        phases=(Phase.generate,),
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    def meet(made: Play | Script) -> None:
        try:
            broken = run(made, mutation.policy)
        except (AssertionError, KeyError, ValueError):
            return  # a broken mediator may break down: that is not a violation
        found = check(broken.records, mutation.policy, calling=broken.calling)
        if mutation.invariant in numbers(found):
            raise Met

    with pytest.raises(Met):
        for number in range(11, 151):
            seed(number)(meet)()
