"""Orders (rules O): what follows, what is wanted now, what is left.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

from dataclasses import replace

from prima.messages import (
    Group,
    Step,
)
from tests.helpers.stage import Stage, ask, chain, command, move, say

EVENT = 7


def test_o1_after_follows_the_latest_command_while_it_is_in_memory() -> None:
    stage = Stage()
    stage.request("ea", say("One."))
    stage.select()
    stage.request("ea", command("move-head", pan=3))
    assert stage.select() == [], "it has the neck to itself, but follows the first"
    assert stage.phases("request")[1]["parent"] == "ea#1"
    assert stage.phases("request")[1]["tree"] == "ea:1"
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]


def test_o1_else_a_new_tree_starts() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    stage.at(10).end("ea#1")
    stage.select()
    stage.at(20).request("ea", say())
    stage.select()
    assert [r["tree"] for r in stage.phases("request")] == ["ea:1", "ea:2"]


def test_o1_a_reaction_never_waits_behind_its_own_application() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("ea", say("Ouch."), cause=EVENT)
    assert stage.select() == ["ea#2"]


def test_o1_in_a_window_a_command_follows_its_own_stream_and_no_reaction() -> None:
    stage = Stage()
    stage.request("ea", ask())
    stage.select()
    stage.request("ea", command("face-human"), move(), cause=EVENT)
    stage.request("fa", say(), cause=EVENT + 1)
    stage.at(10).end("ea#1", then=lambda: stage.request("ea", say("Thanks.")))
    stage.select()
    thanks = stage.phases("request")[-1]
    assert (thanks["tree"], thanks["parent"]) == ("ea:1", None)


def test_o1_in_a_window_a_command_follows_the_latest_of_the_windows_stream() -> None:
    stage = Stage()
    steps = [Step(say("One.")), Step(command("turn", angle=90))]
    stage.request("ea", steps=steps)
    stage.select()
    stage.request("ea", command("move-head", pan=1), cause=EVENT)
    stage.at(10).end("ea#1", then=lambda: stage.request("ea", say("Two.")))
    stage.select()
    assert stage.phases("request")[-1]["parent"] == "ea#2"


def test_o1_in_a_window_a_command_follows_a_unit_and_not_what_is_in_it() -> None:
    stage = Stage()
    unit = Group(chain(say("One."), say("Two.")))
    stage.request("ea", steps=[Step(unit), Step(command("turn", angle=90))])
    assert stage.select() == ["ea#1", "ea#3", "ea#2"]
    stage.at(10).end("ea#2", then=lambda: stage.request("ea", command("turn", angle=0)))
    stage.select()
    assert stage.phases("request")[-1]["parent"] == "ea#1"


def test_o2_now_cancels_the_trees_that_share_a_device() -> None:
    stage = Stage()
    stage.request("ea", move(), say("There."))
    stage.select()
    stage.at(100).request("ea", command("stop-moving"), cause=EVENT)
    assert stage.select() == ["ea#3"]
    assert stage.told("ea") == ["cancel.speak", "cancel.topological-move"]
    assert any(order.verb == "abort" and order.behavior == "ea#1.1" for order in stage.orders)
    assert stage.phases("request")[-1]["tree"] == "ea:1", "it continues the cancelled stream"


def test_o2_what_runs_on_other_devices_finishes() -> None:
    stage = Stage()
    steps = [Step(say("A long story.")), Step(command("turn", angle=90))]
    stage.request("ea", steps=steps)
    stage.select()
    stage.at(10).request("ea", command("stop-moving"))
    assert stage.select() == ["ea#3"]
    assert stage.running == {"ea#1", "ea#3"}


def test_o2_of_what_finishes_the_application_hears_once() -> None:
    stage = Stage()
    turn = replace(command("turn", angle=90), now=True)
    stage.request("ea", steps=[Step(say("A long story.")), Step(command("turn", angle=9))])
    stage.select()
    stage.at(10).request("ea", turn)
    stage.select()
    stage.at(20).request("ea", replace(turn))
    assert stage.select() == ["ea#4"] and stage.running == {"ea#1", "ea#4"}
    assert stage.told("ea").count("cancel.speak") == 1


def test_o2_another_applications_abs_are_left_alone() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("fa", command("stop-moving"))
    assert stage.select() == []
    assert stage.running == {"ea#1.1"}


def test_o2_what_is_wanted_now_waits_for_nothing_of_its_own_application() -> None:
    stage = Stage()
    stage.request("ea", move(), cause=EVENT)
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(10).request("ea", command("stop-moving"))
    assert stage.select() == ["ea#4"]


def test_o2_a_unit_that_runs_on_other_devices_is_finished_whole() -> None:
    stage = Stage()
    point = command("point-by-hand", angle=0)
    unit = Group(chain(say("One."), say("Two.")))
    stage.request("ea", steps=[Step(unit), Step(point)])
    assert stage.select() == ["ea#1", "ea#3", "ea#2"]
    stage.request("ea", replace(point, now=True))
    assert stage.select() == ["ea#5"]
    stage.at(500).end("ea#3")
    assert stage.select() == ["ea#4"]
    assert stage.told("ea") == ["cancel.point-by-hand", "cancel.iu"]


def test_o2_a_unit_is_wanted_now_if_its_first_command_is() -> None:
    stage = Stage()
    stage.request("ea", move(), cause=EVENT)
    stage.request("ea", say("Here."))
    stage.select()
    inner = Group(chain(command("stop-moving"), say("Stopped.")))
    stage.at(10).request("ea", Group([Step(inner), *chain(say("Well."))]))
    assert stage.select()[0] == "ea#3"
    assert sorted(stage.told("ea")) == ["cancel.speak", "cancel.topological-move"]
    asked = [one for one in stage.records if one["phase"] == "request" and one.get("order")]
    assert [one["behavior"] for one in asked] == ["ea#3"]


def test_o2_a_unit_cancels_what_needs_any_of_its_devices() -> None:
    stage = Stage()
    stage.request("ea", say("One."), cause=EVENT)
    stage.request("ea", command("point-by-hand", angle=0))
    stage.select()
    now = replace(command("point-by-hand", angle=9), now=True)
    stage.at(10).request("ea", Group(chain(now, say("There."))))
    stage.select()
    assert sorted(stage.told("ea")) == ["cancel.point-by-hand", "cancel.speak"]


def test_o2_a_unit_that_is_left_ends_with_what_is_cancelled_in_it() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker")
    stage.request("ea", say("Inside."), unit=1)
    assert stage.select() == ["ea#1", "ea#2"]
    stage.close("ea", 1)
    stage.request("ea", replace(say("Wait!"), now=True))
    assert stage.select() == ["ea#3"]
    assert stage.running == {"ea#3"}


def test_o2_of_a_unit_devices_are_told_to_abort_its_commands() -> None:
    stage = Stage()
    stage.request("ea", Group(chain(say("One."), say("Two."))))
    stage.select()
    stage.request("ea", replace(say("Wait!"), now=True))
    assert stage.select() == ["ea#4"]
    assert [order.behavior for order in stage.orders if order.verb == "abort"] == ["ea#2"]


def test_o2_what_is_requested_for_a_unit_that_is_gone_is_said_without_it() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker")
    stage.request("ea", say("Inside."), unit=1)
    stage.select()
    stage.request("ea", replace(say("Wait!"), now=True))
    assert stage.select() == ["ea#3"]
    stage.request("ea", say("Late."), unit=1)
    stage.at(500).end("ea#3")
    assert stage.select() == ["ea#4"]


def test_o2_of_several_streams_the_one_that_ran_goes_on() -> None:
    stage = Stage()
    stage.request("ea", move(), cause=EVENT)
    stage.select()
    stage.request("ea", command("turn", angle=10), cause=EVENT + 1)
    stage.at(10).request("ea", command("stop-moving"), cause=EVENT + 2)
    stage.select()
    assert [r["tree"] for r in stage.phases("request")] == ["ea:1", "ea:2", "ea:1"]


def test_o2_of_several_streams_the_one_that_ran_goes_on_though_it_came_later() -> None:
    stage = Stage()
    stage.request("ea", command("turn", angle=10), cause=EVENT)
    stage.request("ea", command("turn", angle=20), cause=EVENT + 1)
    assert stage.select() == ["ea#2"]
    stage.at(10).request("ea", command("stop-moving"), cause=EVENT + 2)
    stage.select()
    assert [r["tree"] for r in stage.phases("request")] == ["ea:1", "ea:2", "ea:2"]


def test_o3_leaving_a_state_deletes_what_has_not_started_and_ends_loops() -> None:
    stage = Stage()
    stage.request("ea", move(), say("There."))
    stage.select()
    stage.at(100).leave("ea")
    assert stage.select() == []
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == []
    assert stage.running == set()
    assert stage.told("ea") == [], "nobody hears of its end"


def test_o3_what_follows_is_deleted_before_it_could_wait_itself() -> None:
    stage = Stage()
    stage.request("fa", say("Long."))
    stage.select()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.leave("ea")
    stage.select()
    assert [(r["behavior"], r["outcome"]) for r in stage.phases("cancel")] == [
        ("ea#2", "linked"),
        ("ea#1", "waiting"),
    ]


def test_o3_a_unit_that_has_begun_is_finished_whole() -> None:
    stage = Stage()
    stage.request("ea", Group(chain(say("One."), say("Two."))))
    assert stage.select() == ["ea#1", "ea#2"]
    stage.leave("ea")
    stage.at(500).end("ea#2")
    assert stage.select() == ["ea#3"]


def test_o3_a_question_that_listens_ends_at_once() -> None:
    stage = Stage()
    stage.request("ea", ask())
    stage.select()
    stage.mediator.listening("ea#1")
    stage.at(100).leave("ea")
    assert stage.running == set()
    asking = Stage()
    asking.request("ea", ask())
    asking.select()
    asking.at(50).leave("ea")
    assert asking.running == {"ea#1"}, "the question itself is said to its end"
    asking.at(100).mediator.listening("ea#1")
    assert asking.running == set()


def test_o3_nobody_hears_of_the_end_or_failure_of_what_was_left() -> None:
    for what in (say(), Group([Step(say())])):
        for fails in (False, True):
            stage = Stage()
            stage.request("ea", what)
            stage.select()
            stage.at(100).leave("ea")
            last = max(stage.running)  # of a unit, the Command in it
            if fails:
                stage.at(200).mediator.failed(last, "speaker", "it fails")
            else:
                stage.at(200).end(last)
            stage.select()
            assert stage.told("ea") == []
            assert stage.phases("window") == []


def test_o3_leaving_is_recorded() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    stage.at(100).leave("ea")
    stage.select()
    [left] = stage.phases("leave")
    assert (left["time"], left["app"], left["state"], left["rule"]) == (100, "ea", 1, "O3")


def test_o3_what_is_requested_in_the_same_instant_continues_the_stream() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.at(100).leave("ea")
    stage.request("ea", say(), state=2, cause=EVENT)
    stage.select()
    assert {r["tree"] for r in stage.phases("request")} == {"ea:1"}


def test_o3_of_several_streams_the_one_that_ran_goes_on() -> None:
    stage = Stage()
    stage.request("ea", move(), cause=EVENT)
    stage.select()
    stage.request("ea", command("turn", angle=10), cause=EVENT + 1)
    stage.at(10).leave("ea")
    stage.request("ea", say(), state=2, cause=EVENT + 2)
    stage.select()
    assert [r["tree"] for r in stage.phases("request")] == ["ea:1", "ea:2", "ea:1"]


def test_o3_of_several_streams_that_run_the_one_that_started_last_goes_on() -> None:
    stage = Stage()
    stage.request("ea", command("gesture", name="bow"), cause=EVENT)
    stage.select()
    stage.request("ea", command("turn", angle=10), cause=EVENT + 1)
    stage.select()
    assert stage.running == {"ea#1", "ea#2"}
    stage.at(10).leave("ea")
    stage.request("ea", say(), state=2, cause=EVENT + 2)
    stage.select()
    assert [r["tree"] for r in stage.phases("request")] == ["ea:1", "ea:2", "ea:2"]


def test_o3_of_several_streams_that_have_all_paused_the_one_that_started_last_goes_on() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."), cause=EVENT)
    stage.request("ea", command("gesture", name="nod"), say("Nod."), cause=EVENT + 1)
    assert stage.select() == ["ea#3", "ea#1"], "the reaction to the latest event starts first"
    stage.at(500).end("ea#1")
    stage.end("ea#3")
    stage.leave("ea")
    stage.request("ea", say("On."), state=2)
    assert stage.select() == ["ea#5"]
    assert stage.phases("request")[-1]["tree"] == "ea:1"


def test_o3_of_several_streams_the_one_that_runs_goes_on_though_another_started_last() -> None:
    stage = Stage()
    stage.request("ea", command("gesture", name="bow"), cause=EVENT)
    stage.select()
    stage.request("ea", say("One."), say("Two."), cause=EVENT + 1)
    stage.select()
    stage.at(500).end("ea#2")
    stage.leave("ea")
    stage.request("ea", say("On."), state=2)
    assert stage.select() == ["ea#4"]
    assert stage.phases("request")[-1]["tree"] == "ea:1"


def test_o3_of_several_streams_that_have_not_begun_the_latest_goes_on() -> None:
    stage = Stage()
    stage.request("fa", say())
    stage.select()
    for cause in (EVENT, EVENT + 1):
        stage.request("ea", say(), cause=cause)
    assert stage.select() == []
    stage.at(10).leave("ea")
    stage.request("ea", say(), state=2, cause=EVENT + 2)
    stage.select()
    assert [r["tree"] for r in stage.phases("request")] == ["fa:1", "ea:1", "ea:2", "ea:2"]


def test_o3_in_a_window_its_own_stream_goes_on() -> None:
    stage = Stage()
    stage.request("ea", ask())
    stage.select()
    stage.request("ea", command("turn", angle=10), cause=EVENT)
    stage.select()

    def go() -> None:
        stage.leave("ea")
        stage.request("ea", ask("And?"), state=2)

    stage.at(10).end("ea#1", then=go)
    stage.select()
    assert [r["tree"] for r in stage.phases("request")] == ["ea:1", "ea:2", "ea:1"]


def test_o1_what_is_asked_for_in_a_unit_is_not_followed_outside() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker")
    stage.request("ea", say("In it."), unit=1)
    stage.request("ea", command("turn", angle=5))
    stage.select()
    stage.at(10).end("ea#2", then=lambda: stage.request("ea", say("Still in it."), unit=1))
    stage.at(20).request("ea", command("move-head", pan=1))
    stage.select()
    assert stage.phases("request")[-1]["parent"] == "ea#3", "the turn, which is linked still"


def test_a_question_that_o2_leaves_running_finishes() -> None:
    # Only a device in common cuts an AB short (O2); only leaving the state ends a question
    # that listens (O3). Here a move of the same tree is cancelled, and the state goes on.
    stage = Stage()
    stage.request("ea", ask())
    stage.request("ea", command("turn", angle=90))
    stage.select()
    stage.at(10)
    stage.request("ea", command("stop-moving"))
    stage.select()
    assert "ea#1" in stage.running
    stage.at(20).mediator.listening("ea#1")
    stage.select()
    assert [r["phase"] for r in stage.records if r.get("behavior") == "ea#1"] == [
        "request",
        "start",
    ]
