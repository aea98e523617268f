"""Policies: the baselines that the thesis's policy is compared with.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

import pickle

import pytest

from prima.messages import Group, Step
from prima.scheduler.policy import (
    BASELINES,
    EXTENSIONS,
    POLICIES,
    USAGE,
    UnknownPolicy,
    policy_named,
)
from tests.helpers.stage import Stage, ask, chain, command, move, say

EVENT = 7


def test_fifo_is_the_order_of_requests() -> None:
    stage = Stage("fifo")
    stage.request("ea", move())
    stage.at(1).request("fa", ask(), cause=EVENT)
    stage.at(2).request("fa", command("turn", angle=3), cause=EVENT + 1)
    assert stage.select() == ["ea#1.1", "fa#1"]
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["ea#1.2"], "no reactivity"
    assert stage.floor == []


def test_fair_takes_turns() -> None:
    stage = Stage("fair")
    stage.request("ea", say("e1"), say("e2"))
    stage.request("fa", say("f1"), say("f2"))
    order = []
    for time in range(1, 5):
        order += stage.select()
        stage.at(time).end(min(stage.running))
    assert order == ["fa#1", "ea#1", "fa#2", "ea#2"]


def test_fair_gives_the_other_its_turn_in_the_same_instant() -> None:
    stage = Stage("fair")
    facing = command("face-human-and-speak", "You.")
    stage.request("fa", steps=[Step(command("turn", angle=3)), Step(facing)])
    stage.request("ea", say())
    assert stage.select() == ["fa#1", "ea#1"], "fa has had its turn: it holds nothing back from ea"


def test_fair_asks_anew_whose_turn_it_is_after_each_start() -> None:
    stage = Stage("fair")
    nod = command("move-head", pan=0, tilt=20)
    stage.request("fa", say())
    stage.request("ea", nod)
    assert stage.select() == ["fa#1", "ea#1"]
    stage.at(500).end("ea#1")
    stage.select()
    stage.request("fa", steps=[Step(command("turn", angle=3)), Step(nod)], cause=EVENT)
    stage.request("ea", nod)
    assert stage.select() == ["fa#2", "ea#2"]


@pytest.mark.parametrize(("policy", "first"), [("fixed", "fa#1"), ("fixed:ea", "ea#1")])
def test_fixed_lets_one_application_always_go_first(policy: str, first: str) -> None:
    stage = Stage(policy)
    stage.request("ea", say())
    stage.at(1).request("fa", say())
    assert stage.select() == [first]


def test_none_displaces_and_records_the_collision() -> None:
    stage = Stage("none")
    stage.request("ea", say())
    stage.request("fa", say())
    assert sorted(stage.select()) == ["ea#1", "fa#1"]
    assert [r["device"] for r in stage.phases("collision")] == ["speaker"]


def test_none_what_was_displaced_once_has_nothing_to_lose() -> None:
    stage = Stage("none")
    stage.request("ea", move())
    stage.select()
    stage.at(1).request("fa", move("hall"), say())
    stage.select()
    stage.at(400).end("fa#1.1", goal=False)
    stage.select()
    assert [(r["behavior"], r["device"]) for r in stage.phases("collision")] == [
        ("ea#1.1", "localization"),
        ("ea#1.1", "locomotion"),
    ], "the second loop takes the wheels from nobody"


def test_none_names_the_loop_that_displaces() -> None:
    stage = Stage("none")
    stage.request("fa", command("turn", angle=3))
    stage.request("ea", move())
    assert stage.select() == ["fa#1", "ea#1.1"]
    assert [r["by"] for r in stage.phases("collision")] == ["ea#1.1"]


def test_none_does_not_let_a_unit_collide_with_itself() -> None:
    stage = Stage("none")
    stage.request("ea", Group([Step(say()), Step(command("gesture", name="nod"), (0,))]))
    stage.select()
    assert stage.phases("collision") == []


def test_fifo_knows_no_rules_of_prima() -> None:
    stage = Stage("fifo")
    stage.request("ea", say("One."), command("gesture", name="nod"), say("Two."))
    stage.select()
    stage.at(100).end("ea#1")
    stage.request("fa", say())
    assert stage.select() == ["ea#2", "fa#1"], "a pause in a topic keeps nobody from speaking"
    assert (stage.rule("fa#1"), stage.losers("fa#1")) == ("S4", [])


def test_none_lets_every_command_reach_its_devices_at_once() -> None:
    stage = Stage("none")
    stage.request("ea", Group([Step(say("One.")), Step(say("Two."))]))
    stage.request("fa", say("Three."))
    assert sorted(stage.select()) == ["ea#1", "ea#2", "ea#3", "fa#1"]
    assert [order.beside for order in stage.orders] == [False, False, False]
    assert [(stage.rule(name), stage.losers(name)) for name in ("ea#1", "fa#1")] == [
        ("none", []),
        ("none", []),
    ]


def test_none_displaces_a_command_inside_a_unit() -> None:
    stage = Stage("none")
    stage.request("ea", Group(chain(say("One."), say("Two."))))
    stage.select()
    stage.at(1).request("fa", say())
    assert stage.select() == ["fa#1"]
    stage.at(2).end("fa#1")
    stage.at(3).end("ea#2")
    assert stage.select() == ["ea#3"]
    assert [(r["behavior"], r["rule"], r["by"]) for r in stage.phases("collision")] == [
        ("ea#1", "none", "fa#1")
    ]


@pytest.mark.parametrize("name", [*POLICIES, "prima+x1+x3"])
def test_a_policy_has_the_name_by_which_it_is_chosen(name: str) -> None:
    assert policy_named(name).name == name


def test_the_table_of_policies_says_what_may_be_written() -> None:
    assert BASELINES == ("fifo", "fair", "fixed", "none")
    assert USAGE == "prima, fifo, fair, fixed, fixed:APP or none"


@pytest.mark.parametrize(
    ("policy", "later", "rules"),
    [
        ("fifo", 0, ["S2f", "S2f"]),
        ("fifo", 1, ["fifo", "fifo"]),
        ("fair", 0, ["S2f", "fair"]),
        ("fair", 1, ["fifo", "fair"]),
        ("fixed", 0, ["fixed", "fixed"]),
        ("fixed:third", 0, ["S2f", "S2f"]),
        ("fixed:third", 1, ["fifo", "fifo"]),
    ],
)
def test_a_decision_names_the_rule_of_its_policy(policy: str, later: int, rules: list[str]) -> None:
    stage = Stage(policy)
    stage.request("fa", say("f1"), say("f2"))
    stage.at(later).request("ea", say("e1"))
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1")
    (second,) = stage.select()
    assert [stage.rule("fa#1"), stage.rule(second)] == rules


def test_fifo_holds_devices_back_for_whoever_came_first() -> None:
    stage = Stage("fifo", apps={"fa": "fa", "ea": "ea", "third": "ea"})
    stage.request("ea", say())
    stage.select()
    stage.at(1).request("fa", command("face-human-and-speak", "You."))
    stage.at(2).request("third", command("turn", angle=3))
    assert stage.select() == []
    assert (stage.holds("fa#1"), stage.holds("third#1")) == (["S1"], ["S3"])


EVERY = "+".join(["all", *(f"x{number}" for number in range(1, 11))])


@pytest.mark.parametrize(
    ("text", "message", "meant"),
    [
        ("prma", 'There is no policy "prma". Did you mean "prima"?', "prima"),
        ("zzz", 'There is no policy "zzz". Write fair, fifo, fixed, none or prima.', ""),
        ("fixed:", 'There is no policy "fixed:". Did you mean "fixed"?', "fixed"),
        ("fifo:ea", 'There is no policy "fifo:ea". Did you mean "fifo"?', "fifo"),
        ("x3", 'There is no policy "x3". Did you mean "prima+x3"?', "prima+x3"),
        ("x1+all", 'There is no policy "x1+all". Did you mean "prima+x1+all"?', "prima+x1+all"),
        (EVERY, f'There is no policy "{EVERY}". Did you mean "prima+{EVERY}"?', f"prima+{EVERY}"),
        ("fifo+x1", 'There is no policy "fifo+x1".', "fifo"),
        ("prima+x11", 'There is no extension "x11". Did you mean "x1"?', "x1"),
        ("prima+speed", 'There is no extension "speed". Write all, or one of x1 to x10.', ""),
    ],
)
def test_an_unknown_policy_is_refused_with_a_remedy(text: str, message: str, meant: str) -> None:
    with pytest.raises(UnknownPolicy) as caught:
        policy_named(text)
    assert str(caught.value).startswith(message)
    assert f"{caught.value.wrong} {caught.value.remedy}" == str(caught.value)
    assert caught.value.meant == meant
    assert caught.value.word == (text.partition("+")[2] if text.startswith("prima+") else "")
    again = pickle.loads(pickle.dumps(caught.value))
    assert vars(again) == vars(caught.value), "as a process that plays runs gives it back"


def test_all_extensions_are_chosen_at_once() -> None:
    assert policy_named("prima+all").extensions == frozenset(EXTENSIONS)
    assert policy_named("prima").extensions == frozenset()
