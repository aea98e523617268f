"""Of many waiting ABs only few are looked at; the decisions are those of looking at all."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prima.commands import TABLE_4_2
from prima.messages import Command, Json, Occurred, Record, Request, Step
from prima.scheduler import selector
from prima.scheduler.behavior import Behavior, Rank
from prima.scheduler.chronicle import Chronicle
from prima.scheduler.mediator import Mediator
from prima.scheduler.memory import Memory
from prima.scheduler.selection import Policy
from tests.core import in_python
from tests.generated import (
    Ask,
    Close,
    Open,
    Play,
    Run,
    Script,
    World,
    drive,
    perform,
    plays,
    scripts,
)
from tests.test_properties import examples


def decided(act: Callable[[], Run], few: int) -> list[Record]:
    """The records of a run in which all are looked at only where no more than ``few`` wait."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(selector, "FEW", few)
        run = act()
    # Who is not looked at is not told to be held.
    return [record for record in run.records if record["phase"] != "hold"]


@given(plays())
@examples(20)
def test_documents_are_mediated_alike_however_many_are_looked_at(play: Play) -> None:
    assert decided(lambda: perform(play), 0) == decided(lambda: perform(play), 1000)


@given(scripts())
@examples(30)
def test_requests_are_mediated_alike_however_many_are_looked_at(script: Script) -> None:
    assert decided(lambda: drive(script), 0) == decided(lambda: drive(script), 1000)


def test_who_resumes_in_an_instant_keeps_its_place_in_it_however_many_are_looked_at() -> None:
    """S2d: a stream's second branch starts where the first one has just resumed it."""
    sensing = Ask(("active-sensing-human",), ((),))
    branches = Ask(("active-sensing-human", "q-and-a"), ((), ()))
    asked = (
        ((), (), (sensing,)),
        (
            (Open(frozenset({"speaker"}), None), Close(), sensing),
            (Ask(("turn-and-speak",), ((),)), branches),
            (),
        ),
    )
    script = Script(((), (), ()), tuple((0, deeds) for deeds in asked), (), World())
    found = decided(lambda: drive(script), 0)
    assert found == decided(lambda: drive(script), 1000)
    resumed = next(one for one in found if one["phase"] == "resume" and one["app"] == "ea")
    rules = [
        (one["winner"], one["rule"])
        for one in found
        if one["phase"] == "decision" and one["time"] == resumed["time"]
    ]
    assert rules == [("ea#2.1", "S2d"), ("ea#3", "S2d")]


TRACKING = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ea">
<form id="f"><on event="touch"><tracking-human/></on></form></prima>"""
SPEAKING = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="fa">
<form id="f"><on event="message" reactive="false"><speak>Hello.</speak></on></form></prima>"""


@pytest.mark.parametrize("few", [0, 8])
def test_who_has_waited_too_many_loops_starts_in_the_same_instant(few: int) -> None:
    """E4: the bound makes a reaction of what the floor keeps waiting, though nobody looked at it."""
    events = ((10, Occurred("touch", "user")), (20, Occurred("message")))
    play = Play((SPEAKING, TRACKING), (0, 0), events, World(1, endless=True))
    found = decided(lambda: perform(play, bound=3), few)
    loops = [one["time"] for one in found if one["phase"] == "start" and one["app"] == "ea"]
    (spoken,) = (one["time"] for one in found if one["phase"] == "start" and one["app"] == "fa")
    assert spoken == loops[3]


@given(plays(), st.integers(1, 6))
@examples(20)
def test_bounded_loops_are_mediated_alike_however_many_are_looked_at(
    play: Play, bound: int
) -> None:
    few, all_of_them = (decided(lambda: perform(play, bound=bound), n) for n in (0, 1000))
    assert few == all_of_them


class Crowd:
    """Applications that all want something at once."""

    def __init__(self, few: int) -> None:
        self.chronicle = Chronicle()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(selector, "FEW", few)
            self.mediator = Mediator(Policy(), TABLE_4_2, self.chronicle)
        self.runs = 0

    def ask(
        self, app: int, what: tuple[str, str | None, dict[str, Json]], cause: int | None = None
    ) -> None:
        """One application asks for one Command."""
        name = f"a{app}"
        if name not in self.mediator.memory.apps:
            self.mediator.load(name, "ea")
        self.runs += 1
        kind, text, arguments = what
        steps = [Step(Command(kind, dict(arguments), text))]
        self.mediator.request(name, Request(self.runs, steps, 1, cause))

    def play(self, turns: int) -> None:
        """Let what runs end, the latest first, and again and again."""
        for _ in range(turns):
            self.mediator.select()
            self.chronicle.now += 100
            for ab in list(self.mediator.memory.running.values())[-1:]:
                self.mediator.ended(ab.id, True, {})
                self.mediator.told.clear()
        self.mediator.select()

    def decisions(self) -> list[Record]:
        """What was recorded, but for who was held."""
        return [record for record in self.chronicle.drain() if record["phase"] != "hold"]


KINDS: list[tuple[str, str | None, dict[str, Json]]] = [
    ("speak", "Hello.", {}),
    ("turn", None, {"angle": 10}),
    ("gesture", None, {"name": "wave"}),
    ("topological-move", None, {"to": "door"}),
    ("turn-and-speak", "This way.", {"angle": 10}),
    ("face-human", None, {}),
    ("q-and-a", "Well?", {}),
]


@pytest.mark.parametrize("reacting", [0, 5])
def test_a_crowd_is_served_in_the_same_order(reacting: int) -> None:
    found = []
    for few in (0, 1000):
        crowd = Crowd(few)
        for index in range(60):
            if index % 11 == 0:
                crowd.chronicle.now += 10
                crowd.mediator.select()
            cause = index // 9 + 1 if reacting and index % reacting == 0 else None
            crowd.ask(index * 13 % 40, KINDS[index * 5 % len(KINDS)], cause)
        crowd.play(150)
        found.append(crowd.decisions())
    assert found[0] == found[1]
    assert sum(record["phase"] == "decision" for record in found[0]) >= 55


class Counting(Policy):
    """The policy, which notes whom it is asked for."""

    def __init__(self, asked: list[Behavior]) -> None:
        super().__init__()
        object.__setattr__(self, "asked", asked)

    def rank(self, ab: Behavior, memory: Memory, now: int) -> Rank:
        asked: list[Behavior] = vars(self)["asked"]
        asked.append(ab)
        return super().rank(ab, memory, now)


@in_python
def test_the_work_of_a_decision_does_not_grow_with_those_who_wait() -> None:
    looked = []
    for count in (50, 500):
        crowd = Crowd(8)
        for index in range(count):
            crowd.ask(index, KINDS[0])
        ranks: list[Behavior] = []
        crowd.mediator._selector.policy = Counting(ranks)
        crowd.play(20)
        looked.append(len(ranks))
    assert looked[0] == looked[1]
    assert looked[0] < 20 * 4


def test_losers_are_all_named_when_one_start_leaves_few_waiting() -> None:
    found = []
    for few in (8, 1000):
        crowd = Crowd(few)
        for index in range(9):
            crowd.ask(index, KINDS[0 if index < 5 else 2])
        crowd.mediator.select()
        found.append([one for one in crowd.decisions() if one["phase"] == "decision"])
    assert found[0] == found[1]
    assert [(one["rule"], one["losers_count"]) for one in found[0]] == [("S2f", 4), ("S2f", 3)]


def test_who_may_start_once_the_channel_is_engaged_starts_in_the_same_instant() -> None:
    """K1: a question keeps others from leaving, but not its own application."""
    found = []
    for few in (0, 1000):
        crowd = Crowd(few)
        crowd.ask(1, KINDS[3])
        crowd.mediator.load("a0", "ea")
        commands = [Command("q-and-a", {}, "Well?"), Command("topological-move", {"to": "door"})]
        crowd.mediator.request("a0", Request(99, [Step(one) for one in commands], 1))
        crowd.mediator.select()
        found.append([one["command"] for one in crowd.decisions() if one["phase"] == "start"])
    assert found[0] == found[1] == ["q-and-a", "topological-move"]
