"""Each rule of the mediator, by its number, on the smallest case that shows it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from prima.language.commands import TABLE_4_2
from prima.messages import Command, Group, OpenUnit, Step
from prima.scheduler import rules
from tests.stage import Stage, ask, chain, command, move, say, search

EVENT = 7


# Information Units ------------------------------------------------------------------


def test_u1_a_command_makes_one_ab() -> None:
    stage = Stage()
    stage.request("ea", say())
    assert stage.select() == ["ea#1"]


def test_u2_a_feedback_command_makes_one_ab_a_loop_until_its_goal() -> None:
    stage = Stage()
    stage.request("ea", move(), say())
    assert stage.select() == ["ea#1.1"]
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["ea#1.2"]
    stage.at(1000).end("ea#1.2", goal=True)
    assert stage.select() == ["ea#2"]


def test_u2_a_feedback_command_that_was_interrupted_starts_afresh() -> None:
    stage = Stage()
    stage.request("ea", search("Where are you?"))
    stage.select()
    stage.request("fa", ask(), cause=EVENT)
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["fa#1"]
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1.2"]
    assert [order.resumed for order in stage.orders if order.behavior == "ea#1.2"] == [True]


def test_u3_branches_share_a_parent_and_what_follows_waits_for_all() -> None:
    stage = Stage()
    steps = [
        Step(say()),
        Step(command("move-head", pan=10), (0,)),
        Step(command("point-by-hand", angle=0), (0,)),
        Step(say("Done."), (1, 2)),
    ]
    stage.request("ea", steps=steps)
    assert stage.select() == ["ea#1"]
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2", "ea#3"]
    stage.at(20).end("ea#3")
    assert stage.select() == []
    stage.at(30).end("ea#2")
    assert stage.select() == ["ea#4"]


def test_u3_branches_that_share_a_device_run_in_document_order() -> None:
    stage = Stage()
    stage.request("ea", steps=[Step(say("One.")), Step(say("Two."))])
    assert stage.select() == ["ea#1"]
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]


def test_u4_a_group_is_one_ab_with_the_devices_of_all_branches() -> None:
    stage = Stage()
    group = Group([Step(say()), Step(command("gesture", name="nod"), (0,))])
    stage.request("ea", group)
    stage.request("fa", command("move-head", pan=5), cause=EVENT)
    # The reaction ranks first, so it has the neck; the group waits for all its devices.
    assert stage.select() == ["fa#1"]
    stage.at(10).end("fa#1")
    assert stage.select() == ["ea#1", "ea#2"]
    stage.request("fa", command("move-head", pan=0), cause=EVENT + 1)
    stage.at(20).end("ea#2")
    assert stage.select() == ["ea#3"], "the neck belongs to the group until its end"
    stage.at(30).end("ea#3")
    assert stage.select() == ["fa#2"]


def test_u4_neither_feedback_nor_leaving_commands_stand_in_a_group() -> None:
    stage = Stage()
    stage.request("ea", Group([Step(say()), Step(move(), (0,))]))
    assert stage.select() == []
    assert stage.told("ea") == ["error.semantic"]


def test_u5_a_unit_spans_requests_and_owns_its_devices_until_it_is_left() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "speech-recognition")
    stage.request("ea", ask(), unit=1)
    assert stage.select() == ["ea#1", "ea#2"]
    stage.request("fa", say(), cause=EVENT)
    stage.at(10).end("ea#2", then=lambda: stage.request("ea", say("Thanks."), unit=1))
    assert stage.select() == ["ea#3"]
    stage.at(20).end("ea#3", then=lambda: stage.close("ea", 1))
    assert stage.select() == ["fa#1"]


def test_u5_what_runs_finishes_when_the_unit_is_left_and_the_rest_is_deleted() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker")
    stage.request("ea", say("One."), say("Two."), unit=1)
    stage.select()
    stage.request("fa", say("Me."), cause=EVENT)
    stage.at(5).close("ea", 1)
    assert stage.select() == []
    stage.at(10).end("ea#2")
    assert stage.select() == ["fa#1"]
    assert [r["behavior"] for r in stage.phases("cancel")] == ["ea#3"]


def test_u5_a_unit_that_takes_too_long_ends_and_its_application_is_told() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", longest=1000)
    stage.request("ea", say(), unit=1)
    stage.select()
    assert stage.mediator.deadline() == 1000
    stage.at(1000).mediator.expire()
    stage.select()
    assert "error.unit.timeout" in stage.told("ea")
    assert stage.running == {"ea#1", "ea#2"}, "the Command that runs finishes"
    stage.at(1500).end("ea#2")
    stage.select()
    assert stage.running == set()


def test_u6_a_running_ab_is_not_interrupted_by_another_application() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    stage.request("fa", say(), cause=EVENT)
    assert stage.select() == []
    assert stage.running == {"ea#1"}


def test_u5_a_command_that_needs_another_device_is_refused_in_a_unit() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "speech-recognition")
    stage.request("ea", ask(), unit=1)
    stage.request("ea", command("turn", angle=90), unit=1)
    stage.select()
    assert stage.told("ea") == ["error.semantic"]
    assert "locomotion" in stage.notices[-1][1].message


def test_u5_a_command_that_leaves_or_loops_is_refused_in_a_unit() -> None:
    for what in (command("set-position", x=1, y=1), command("tracking-human")):
        stage = Stage()
        stage.open("ea", 1, "speaker", "locomotion", "localization", "human-detection")
        stage.request("ea", what, unit=1)
        stage.settle()
        assert stage.told("ea") == ["error.semantic"], what


def test_u5_what_is_inside_a_linked_unit_holds_nobody_back() -> None:
    stage = Stage()
    stage.request("ea", command("face-human"), move(), cause=EVENT)
    assert stage.select() == ["ea#1"], "it has the floor, and engages the user"
    stage.open("ea", 1, "speaker", "speech-recognition")
    stage.request("ea", ask(), unit=1)
    stage.request("fa", say(), cause=EVENT + 1)
    assert stage.select() == ["fa#1"]
    stage.request("fa", move())
    stage.at(10).end("ea#1")
    stage.select()
    assert stage.mediator.memory.behaviors["ea#3"].state == "linked"
    stage.at(20).end("fa#1")
    assert stage.select() == ["fa#2.1"], "all that contends in the other's stream leaves as well"


# Orders -------------------------------------------------------------------------------


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


# Selection ------------------------------------------------------------------------------


def test_s1_an_ab_waits_for_its_devices() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.at(1).request("fa", say())
    assert stage.select() == ["ea#1"]
    assert stage.holds("fa#1") == ["S1"]


def test_s2a_the_higher_priority_goes_first() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.at(5).request("fa", command("turn", angle=10))
    assert stage.select() == ["fa#1"]
    assert stage.rule("fa#1") == "S2a"


def test_s2b_of_reactions_the_latest_event_goes_first() -> None:
    stage = Stage()
    stage.request("ea", say(), cause=1)
    stage.at(1).request("fa", say(), cause=2)
    assert stage.select() == ["fa#1"]
    assert stage.rule("fa#1") == "S2b"


def test_s2b_of_one_events_reactions_the_active_applications_goes_first() -> None:
    stage = Stage()
    stage.request("ea", command("move-head", pan=1))
    stage.select()
    stage.request("fa", say(), cause=EVENT)
    stage.request("ea", say(), cause=EVENT)
    assert stage.select() == ["ea#2"]


@pytest.mark.parametrize("goes_on", [True, False])
def test_s2b_a_stream_that_has_not_ended_is_active_between_its_abs(goes_on: bool) -> None:
    stage = Stage()
    stage.request("ea", say("One."), *([say("Two.")] if goes_on else []))
    stage.select()
    stage.request("fa", say("F."), cause=EVENT)
    stage.request("ea", say("E."), cause=EVENT)
    stage.at(10).end("ea#1")
    first = ("ea#3", "S2b") if goes_on else ("fa#1", "S2f")
    assert stage.select() == [first[0]]
    assert stage.rule(first[0]) == first[1]


def test_s2b_a_stream_that_has_ended_is_not_active_while_another_runs() -> None:
    stage = Stage(apps={"one": "ea", "two": "ea"})
    stage.request("one", say("Long."))
    stage.select()
    stage.at(5).request("two", command("move-head", pan=1))
    stage.select()
    stage.at(10).end("two#1")
    stage.select()
    stage.at(15).request("two", command("point-by-hand", angle=0), cause=EVENT)
    stage.request("one", command("point-by-hand", angle=9), cause=EVENT)
    assert stage.select() == ["one#2"], "the sentence is what is active"


def test_s2c_a_parent_that_has_just_ended_goes_before_others() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say("Me."))
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    assert stage.rule("ea#2") == "S2c"


def test_s2d_the_stream_suspended_last_goes_first() -> None:
    apps = {"a": "fa", "b": "ea", "c": "ea"}
    stage = Stage(apps=apps)
    stage.request("a", say("a1"), say("a2"))
    stage.select()
    stage.request("b", say("b1"), say("b2"), cause=1)
    stage.at(10).end("a#1")
    stage.select()
    stage.request("c", say("c1"), cause=2)
    stage.at(20).end("b#1")
    assert stage.select() == ["c#1"]
    stage.at(30).end("c#1")
    assert stage.select() == ["b#2"], "a stack of topics is unwound"
    stage.at(40).end("b#2")
    assert stage.select() == ["a#2"]


def test_s2d_the_stream_suspended_last_goes_first_when_no_floor_is_left() -> None:
    stage = Stage(apps={"a": "fa", "b": "ea", "c": "ea"})
    stage.request("a", say("a1"), say("a2"))
    stage.request("b", command("move-head", pan=1), say("b1"))
    stage.select()
    stage.request("b", say("r"), cause=1)
    stage.at(10).end("a#1")
    assert stage.select() == ["b#3"], "a is suspended"
    stage.request("c", say("c1"), cause=2)
    stage.at(20).end("b#3")
    assert stage.select() == ["c#1"], "and now b's first stream"
    stage.at(25).end("b#1")
    stage.select()
    stage.at(30).end("c#1")
    assert stage.select() == ["b#2"]
    assert stage.rule("b#2") == "S2d"


def test_s2d_streams_suspended_together_rank_alike() -> None:
    stage = Stage(apps={"a": "fa", "b": "ea", "c": "ea"})
    stage.request("a", say("a1"), say("a2"))
    stage.at(1).request("b", command("move-head", pan=1), say("b1"))
    stage.select()
    stage.request("c", say("c1"), cause=EVENT)
    stage.at(10).end("a#1")
    assert stage.select() == ["c#1"]
    stage.at(15).end("b#1")
    stage.select()
    stage.at(20).end("c#1")
    assert stage.select() == ["a#2"]
    assert stage.rule("a#2") == "S2e"


def test_s2d_a_stream_that_has_not_begun_never_goes_before_one_that_was_broken() -> None:
    stage = Stage(apps={"fa": "fa", "one": "ea", "two": "ea"})
    stage.request("one", ask("One?"), ask("Or two?"))
    stage.select()
    stage.at(1).request("two", ask("Three?"))
    stage.request("fa", say(), cause=EVENT)
    stage.at(10).end("one#1")
    assert stage.select() == ["fa#1"]
    assert [r["tree"] for r in stage.phases("suspend")] == ["one:1"]
    stage.at(20).end("fa#1")
    assert stage.select() == ["one#2"]


def test_s2f_goes_by_the_declared_order_whoever_was_loaded_first() -> None:
    stage = Stage(apps={})
    stage.mediator.load("late", "ea", order=1)
    stage.mediator.load("early", "ea", order=0)
    stage.request("late", say())
    stage.request("early", say())
    assert stage.select() == ["early#1"]
    assert stage.rule("early#1") == "S2f"


def test_s2_a_decision_names_as_losers_only_what_could_have_started() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say(), command("face-human"), cause=EVENT)
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1"]
    assert (stage.rule("fa#1"), stage.losers("fa#1")) == ("S2b", ["ea#2"])
    stage.at(20).end("fa#1")
    assert stage.select() == ["fa#2"]
    assert (stage.rule("fa#2"), stage.losers("fa#2")) == ("S1", []), "F2 holds ea#2"


def test_s2e_and_s2f_the_earlier_request_then_the_declared_order() -> None:
    stage = Stage()
    stage.at(5).request("ea", say())
    stage.at(6).request("fa", say())
    assert stage.select() == ["ea#1"]
    assert stage.rule("ea#1") == "S2e"
    same = Stage()
    same.request("ea", say())
    same.request("fa", say())
    assert same.select() == ["fa#1"]
    assert same.rule("fa#1") == "S2f"


def test_s3_a_waiting_reaction_holds_its_devices_back() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    # The reaction needs speaker and locomotion; only the speaker is taken.
    stage.at(1).request("fa", command("turn-and-speak", "Hey.", angle=90), cause=EVENT)
    stage.request("ea", steps=[Step(command("turn", angle=5))], cause=None)
    stage.at(2).request("fa", command("turn", angle=5), cause=None)
    assert stage.select() == []
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1"]


def test_s3_holds_a_device_from_another_applications_ab() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    stage.at(1).request("fa", command("turn-and-speak", "Hey.", angle=90), cause=EVENT)
    third = Stage(apps={"a": "fa", "b": "ea", "c": "ea"})
    third.request("b", say())
    third.select()
    third.at(1).request("a", command("turn-and-speak", "Hey.", angle=90), cause=EVENT)
    third.request("c", command("turn", angle=5))
    assert third.select() == []
    assert third.holds("c#1") == ["S3"]


def test_s4_abs_without_a_common_device_run_together() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.request("fa", say("Hello."))
    assert sorted(stage.select()) == ["ea#1.1", "fa#1"]


# Streams ------------------------------------------------------------------------------------


def test_c1_a_stream_ends_with_its_last_ab_and_holds_no_floor_then() -> None:
    stage = Stage()
    stage.request("fa", say(), cause=EVENT)
    stage.select()
    assert stage.floor == ["fa:1"]
    stage.at(10).end("fa#1")
    stage.select()
    assert stage.floor == []
    assert [r["tree"] for r in stage.phases("stream-end")] == ["fa:1"]


def test_c2_a_suspended_stream_resumes_where_it_was() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."), say("Three."))
    stage.select()
    stage.request("fa", ask(), cause=EVENT)
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1"]
    assert [r["tree"] for r in stage.phases("suspend")] == ["ea:1"]
    stage.at(20).end("fa#1")
    assert stage.select() == ["ea#2"]
    assert [r["tree"] for r in stage.phases("resume")] == ["ea:1"]


def test_c3_what_is_requested_in_the_window_belongs_to_the_stream() -> None:
    stage = Stage()
    stage.request("ea", say("One."))
    stage.select()
    stage.request("fa", say("Me."))
    stage.at(10).end("ea#1", then=lambda: stage.request("ea", say("Two.")))
    assert stage.select() == ["ea#2"]
    assert stage.phases("request")[-1]["tree"] == "ea:1"


def test_c4_an_answer_opens_the_window_too() -> None:
    stage = Stage()
    stage.request("ea", ask())
    stage.select()
    stage.request("fa", say("Me."))
    stage.at(10).end("ea#1", then=lambda: stage.request("ea", say("I see.")))
    assert stage.select() == ["ea#2"]


# Floor -----------------------------------------------------------------------------------------


def test_f1_a_reaction_suspends_the_others_whatever_devices_they_need() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("fa", ask(), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == [], "nothing of the EA moves while the FA talks"
    assert stage.holds("ea#1.1") == ["F2"]
    assert [(r["tree"], r["by"]) for r in stage.phases("suspend")] == [("ea:1", "fa:1")]


def test_f2_a_reaction_to_another_event_may_break_in_and_one_to_the_same_may_not() -> None:
    stage = Stage()
    stage.request("fa", say(), cause=1)
    stage.select()
    stage.request("ea", command("move-head", pan=1), cause=1)
    assert stage.select() == []
    stage.request("ea", command("point-by-hand", angle=1), cause=2)
    assert "ea#2" in stage.select()


def test_f2_a_higher_priority_than_all_of_the_floors_stream_may_start() -> None:
    stage = Stage()
    stage.request("fa", search())
    stage.select()
    stage.request("ea", say(), move(), cause=1)
    stage.at(500).end("fa#1.1", goal=False)
    assert stage.select() == ["ea#1"]
    stage.at(900).end("ea#1")
    assert stage.select() == ["fa#1.2"], "the search outranks the move (Figure 5.3, rows 15-16)"
    assert stage.rule("fa#1.2") == "F2"
    assert stage.floor == ["ea:1", "fa:1"]


def test_f2_a_higher_priority_than_some_of_the_floors_stream_is_not_enough() -> None:
    stage = Stage()
    stage.request("ea", steps=[Step(move()), Step(say())], cause=1)
    assert stage.select() == ["ea#2", "ea#1.1"]
    stage.at(5).request("fa", command("gesture", name="bow"))
    assert stage.select() == [], "it outranks the move, not the words"
    assert stage.holds("fa#1") == ["F2"]
    stage.at(10).end("ea#2")
    assert stage.select() == ["fa#1"]


def test_f3_the_floor_falls_back_when_its_holder_ends() -> None:
    stage = Stage()
    stage.request("fa", ask("1"), ask("2"), cause=1)
    stage.select()
    stage.request("ea", say(), cause=2)
    stage.at(10).end("fa#1")
    stage.select()
    assert stage.floor == ["fa:1", "ea:1"]
    stage.at(20).end("ea#1")
    assert stage.select() == ["fa#2"]
    assert stage.floor == ["fa:1"]


def test_f3_what_outranks_the_floor_takes_it_only_if_it_needs_its_devices() -> None:
    for what, floor in ((command("turn", angle=10), "fa:1"), (say(), "ea:1")):
        stage = Stage()
        stage.request("ea", move(), cause=EVENT)
        stage.select()
        stage.at(5).request("fa", what)
        stage.at(500).end("ea#1.1", goal=False)
        stage.select()
        assert stage.floor[-1] == floor, what
        assert ("fa#1" in stage.running) and ("ea#1.2" in stage.running) is (floor == "ea:1")


def test_f3_a_robot_that_guides_does_not_stop_for_every_sentence() -> None:
    stage = Stage()
    stage.request("ea", move(), cause=EVENT)
    stage.select()
    stage.at(5).request("fa", say("Once upon a time"), say("there was a robot."))
    assert stage.select() == ["fa#1"]
    assert stage.phases("suspend") == []
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["ea#1.2"]


def test_f6_a_topic_is_not_spoken_into() -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), command("move-head", pan=30), say("forty two."))
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    assert stage.holds("fa#1")[-1] == "F6"
    stage.at(20).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.at(30).end("ea#3")
    assert stage.select() == ["fa#1"]


def test_f6_a_reaction_may_break_in() -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), command("move-head", pan=30), say("forty two."))
    stage.select()
    stage.at(5).request("fa", say("Ouch."), cause=EVENT)
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1", "ea#2"] or "fa#1" in stage.running


@pytest.mark.parametrize(
    "between",
    [
        [command("move-head", pan=30), search(), say("forty two.")],  # it works in loops
        [command("move-head", pan=30)],  # nothing is said behind it
    ],
)
def test_f6_holds_only_between_two_utterances(between: list[Command]) -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), *between)
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    stage.at(10).end("ea#1")
    assert "fa#1" in stage.select()


def test_f6_a_stream_that_has_not_spoken_is_no_topic_yet() -> None:
    stage = Stage()
    stage.request("ea", command("move-head", pan=30), say("Forty two."))
    stage.at(1).request("fa", say("I like trains."))
    assert stage.select() == ["ea#1", "fa#1"]


def test_f6_who_holds_the_floor_may_speak_into_a_topic() -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), command("gesture", name="bow"), say("forty two."))
    stage.select()
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    stage.at(12).request("fa", command("face-human"), say("Ouch there."), cause=EVENT)
    assert stage.select() == ["fa#1"], "the reaction takes the floor without a word"
    stage.at(20).end("fa#1")
    assert stage.select() == ["fa#2"], "what follows it is no reaction, but has the floor"


def test_f6_a_topic_that_works_in_loops_may_be_spoken_into() -> None:
    stage = Stage()
    stage.request("ea", say("Follow me."), move(), say("Here we are."))
    stage.select()
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2.1"]
    stage.at(20).request("fa", say("I like trains."))
    assert stage.select() == ["fa#1"]


def test_f6_a_unit_keeps_its_own_speaker() -> None:
    """Between two utterances in a unit it is the unit that others wait for, by S1."""
    stage = Stage()
    bow = command("gesture", name="bow")
    stage.request("ea", Group(chain(say("The answer is"), bow, say("forty two."))))
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    for part in ("ea#2", "ea#3", "ea#4"):
        assert stage.select() == ([] if part == "ea#2" else [part])
        stage.end(part)
    assert stage.select() == ["fa#1"]
    assert [(r["rule"], r["by"]) for r in stage.phases("hold")] == [("S1", "ea#1")]


def test_f6_who_waits_too_long_for_a_unit_holds_its_devices_back() -> None:
    """It waits by S1, so S3 and E6 apply: nobody whom it outranks takes the wheels from it."""
    stage = Stage(patience=1000, apps={"fa": "fa", "ea": "ea", "guide": "ea"})
    bow = command("gesture", name="bow")
    stage.request("ea", Group(chain(say("The answer is"), bow, say("forty two."))))
    stage.select()
    stage.at(5).request("fa", Group(chain(say("Look."), command("turn", angle=10))))
    stage.select()
    stage.at(2000).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.at(2010).request("guide", command("turn", angle=20))
    assert stage.select() == []
    assert stage.holds("guide#1") == ["S3"]


def test_f4_without_a_floor_only_devices_and_the_channel_count() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.request("fa", command("turn", angle=5))
    assert sorted(stage.select()) == ["ea#1", "fa#1"]
    assert stage.floor == []


def test_f5_a_motion_that_gets_no_next_loop_is_stopped_for_certain() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("fa", ask(), cause=EVENT)
    stage.select()
    stage.at(500).end("ea#1.1", goal=False)
    stage.select()
    assert [order.verb for order in stage.orders][-1] == "stop"
    assert [r["rule"] for r in stage.phases("stop")] == ["F5"]


def test_f5_no_stop_where_something_else_takes_the_wheels_or_the_goal_is_met() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("fa", command("turn", angle=9), cause=EVENT)
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["fa#1"]
    assert stage.phases("stop") == []
    done = Stage()
    done.request("ea", move())
    done.select()
    done.at(500).end("ea#1.1", goal=True)
    done.select()
    assert done.phases("stop") == []


# Channel -------------------------------------------------------------------------------------


def test_k1_a_leaving_ab_waits_while_another_application_engages_the_user() -> None:
    stage = Stage()
    stage.request("fa", ask("Shall we?"))
    stage.select()
    stage.request("ea", move())
    assert stage.select() == [], "not even though the wheels are free"
    assert stage.holds("ea#1") == ["K1"]
    stage.at(10).end("fa#1")
    assert stage.select() == ["ea#1.1"]


def test_k1_a_stream_that_leaves_itself_engages_nobody() -> None:
    table = {
        **TABLE_4_2,
        "glide": replace(TABLE_4_2["set-position"], name="glide", devices=frozenset({"arm"})),
    }
    stage = Stage(table=table)
    stage.request("fa", ask(), Command("glide", {"x": 1, "y": 1}))
    stage.select()
    stage.at(10).end("fa#1")
    assert stage.select() == ["fa#2.1"]
    stage.request("ea", move())
    assert stage.select() == ["ea#1.1"]


def test_k1_a_stream_of_which_only_a_part_leaves_engages_still() -> None:
    table = {
        **TABLE_4_2,
        "glide": replace(TABLE_4_2["set-position"], name="glide", devices=frozenset({"arm"})),
    }
    stage = Stage(table=table)
    steps = [Step(ask()), Step(move(), (0,)), Step(say("This way."), (0,))]
    stage.request("fa", steps=steps)
    stage.select()
    stage.at(10).end("fa#1")
    assert set(stage.select()) == {"fa#2.1", "fa#3"}
    stage.request("ea", Command("glide", {"x": 1, "y": 1}))
    assert stage.select() == []
    assert stage.holds("ea#1") == ["K1"]
    stage.at(20).end("fa#3")
    assert stage.select() == ["ea#1.1"]


def test_k1_a_stream_that_is_held_and_does_nothing_engages_still() -> None:
    stage = Stage("prima+x3")
    stage.request("fa", ask(), hold=5000)
    stage.select()
    stage.at(10).end("fa#1")
    stage.select()
    stage.at(20).request("ea", move(), cause=EVENT)
    assert stage.select() == [], "a reaction may break in (F2), but not leave the user"
    assert stage.holds("ea#1") == ["K1"]
    stage.at(5010).mediator.expire()
    assert stage.select() == ["ea#1.1"]


def test_k1_nobody_engages_a_user_who_has_gone() -> None:
    stage = Stage()
    stage.mediator.sees_user(True)
    stage.request("ea", ask("Still there?"))
    stage.select()
    stage.at(1000).mediator.sees_user(False)
    stage.request("fa", move())
    assert stage.select() == []
    assert stage.holds("fa#1") == ["K1"]
    assert stage.mediator.deadline() == 21_000
    stage.at(21_000).mediator.expire()
    assert stage.select() == ["fa#1.1"]
    stage.at(21_500).mediator.senses_user()
    stage.end("fa#1.1", goal=False)
    assert stage.select() == [], "the user is back"


@pytest.mark.parametrize(("kind", "engages"), [("active-sensing-human", True), ("q-and-a", False)])
def test_k1_a_stream_that_searches_engages_whom_it_looks_for(kind: str, engages: bool) -> None:
    stage = Stage()
    stage.request("ea", command(kind, "Hello?"))
    stage.select()
    memory = stage.mediator.memory
    memory.absent = True
    assert rules.engages(memory.streams["ea:1"], memory) is engages


def test_k2_leaving_commands_have_low_priority() -> None:
    low = {name for name, row in TABLE_4_2.items() if row.priority == 0}
    assert low == {"topological-move", "set-position", "set-position-and-direction"}


# When things go wrong -------------------------------------------------------------------------


def test_e1_a_failing_device_ends_the_ab_and_the_rest_of_its_tree() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.request("fa", say("Me."))
    stage.select()
    stage.at(10).mediator.failed(min(stage.running), "speaker", "broken")
    stage.settle()
    assert "error.device.speaker" in stage.told("fa")
    assert stage.select() == ["ea#1"]


def test_e1_a_device_that_hangs_past_its_limit_has_failed() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    due = stage.mediator.deadline()
    assert due is not None
    stage.at(due).mediator.expire()
    stage.settle()
    assert stage.told("ea") == ["error.device.speaker"]
    assert stage.running == set()


def test_e1_a_robot_without_the_command_says_so() -> None:
    table = {name: row for name, row in TABLE_4_2.items() if name != "gesture"}
    stage = Stage(table=table)
    stage.request("ea", command("gesture", name="nod"))
    stage.select()
    assert stage.told("ea") == ["error.unsupported.gesture"]


def test_e2_an_unloaded_application_gives_back_what_it_holds() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say("Me."))
    stage.mediator.unload("ea", "crash")
    assert stage.select() == []
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1"]


def test_e6_who_is_kept_from_the_speaker_has_a_turn_at_last() -> None:
    stage = Stage(patience=5000)
    stage.request("ea", say("First."))
    stage.select()
    stage.at(1).request("fa", say("One."), say("Two."))
    stage.select()
    for number in range(1, 20):
        stage.at(1000 * number)
        stage.end(f"ea#{number}", then=lambda: stage.request("ea", say("On.")))
        if (started := stage.select()) != [f"ea#{number + 1}"]:
            break
    assert started == ["fa#1"] and stage.recorder.now == 6000
    assert stage.rule("fa#1") == "E6" and stage.losers("fa#1") == ["ea#7"]
    assert stage.floor == [], "no reaction, so that nobody is suspended"
    assert [(r["time"], r["rule"]) for r in stage.phases("starve")] == [(6000, "E6")]
    stage.at(7000).end("fa#1")
    assert stage.select() == ["fa#2"], "its stream goes on (S2c)"
    stage.at(8000).end("fa#2")
    assert stage.select() == ["ea#7"], "and then the other one"


@pytest.mark.parametrize(("patience", "turns"), [(0, []), (5000, ["fa#1"])])
def test_e6_without_patience_it_waits_for_ever(patience: int, turns: list[str]) -> None:
    stage = Stage(patience=patience)
    stage.request("ea", say("First."))
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    found: list[str] = []
    for number in range(1, 9):
        stage.at(1000 * number)
        if f"ea#{number}" in stage.running:
            stage.end(f"ea#{number}", then=lambda: stage.request("ea", say("On.")))
        found += [one for one in stage.select() if one.startswith("fa")]
    assert found == turns


def test_e6_only_the_speaker_counts_and_no_floor() -> None:
    """A reaction's stream has the floor (F2): who waits for that is not kept from the speaker."""
    stage = Stage(patience=5000)
    stage.request("ea", say("Yes?"), say("A"), say("long"), say("story."), cause=EVENT)
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    for number in range(1, 4):
        stage.at(4000 * number).end(f"ea#{number}")
        assert stage.select() == [f"ea#{number + 1}"]
    assert [(r["rule"], r["by"]) for r in stage.phases("starve")] == [("F2", "ea:1")]
    stage.at(16_000).end("ea#4", then=lambda: stage.request("ea", say("Next.")))
    assert stage.select() == ["ea#5"]


def test_e6_a_reaction_goes_first() -> None:
    stage = Stage(patience=1000)
    stage.request("ea", say("First."))
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    stage.at(5000).request("ea", say("Ouch."), cause=EVENT)
    stage.end("ea#1")
    assert stage.select() == ["ea#2"]


@pytest.mark.parametrize(
    ("then", "started"), [(say("Thank you."), ["ea#2"]), (ask("And why?"), ["fa#1"])]
)
def test_e6_after_an_answer_the_asker_has_the_first_word_but_no_question(
    then: Command, started: list[str]
) -> None:
    stage = Stage(patience=1000)
    stage.request("ea", ask())
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    stage.at(5000).mediator.ended("ea#1", True, {"outcome": "filled"}, inbound=False)
    stage.settle(lambda: stage.request("ea", then, say("More.")))
    assert stage.select() == started
    if started == ["ea#2"]:
        stage.at(6000).end("ea#2")
        assert stage.select() == ["fa#1"], "before its next sentence"


def test_e6_holds_other_devices_back_as_well() -> None:
    """Two devices that another application uses in turn are kept for it (S3)."""
    stage = Stage(patience=1000)
    stage.request("ea", Group(chain(say("One."), command("move-head", pan=1))))
    stage.select()
    stage.at(1).request("fa", Group(chain(say("Me."), command("move-head", pan=2))))
    stage.select()
    stage.at(500).end("ea#2")
    stage.select()
    stage.at(2000).end("ea#3")
    assert stage.select() == ["fa#1", "fa#2"]


def test_e6_k1_stands_above_it() -> None:
    """What leaves the user waits for the conversation, however long that takes."""
    stage = Stage(patience=1000)
    stage.request("ea", ask(), ask(), ask())
    stage.select()
    stage.at(1).request("fa", move())
    stage.select()
    for number in range(1, 3):
        stage.at(4000 * number).end(f"ea#{number}")
        assert stage.select() == [f"ea#{number + 1}"]
    assert [r["rule"] for r in stage.phases("starve")] == ["K1"]


@pytest.mark.parametrize(
    "bad",
    [
        Command("fly"),
        Command("turn", {"angle": 1000}),
        Command("turn", {"speed": 1}),
        Command("turn"),
        Command("speak"),
        Command("speak", text="Hi", extra={"volume": 1}),
        Command("turn", {"angle": float("nan")}),
        Command("turn", {"angle": None}),
    ],
)
def test_e3_a_bad_command_never_enters_memory(bad: Command) -> None:
    stage = Stage()
    stage.request("ea", say(), bad)
    assert stage.select() == []
    assert stage.told("ea") == ["error.semantic"]
    assert stage.phases("fail")[0]["rule"] == "E3"


def test_e4_starving_is_reported_and_can_be_bounded() -> None:
    def loops(bound: int | None) -> int:
        stage = Stage(bound=bound)
        stage.request("fa", Command("tracking-human"))
        stage.select()
        stage.at(1).request("ea", command("turn", angle=3))
        for loop in range(1, 60):
            stage.at(500 * loop).end(f"fa#1.{loop}", goal=False)
            if "ea#1" in stage.select():
                return loop
        assert [r["rule"] for r in stage.phases("starve")] == ["E4"]
        return -1

    assert loops(None) == -1
    assert 0 < loops(30) <= 32


def test_e5_an_emergency_stop_ends_everything_until_released() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(10).mediator.emergency(True, True, 8)
    stage.select()
    assert stage.running == set()
    stage.request("fa", say(), cause=EVENT)
    assert stage.select() == []
    stage.at(20).mediator.emergency(False, True, 9)
    assert stage.select() == ["fa#1"]
    stage.at(30).end("fa#1")
    assert stage.select() == ["ea#1"], "what was cut is done again"


def test_e5_only_what_returns_is_recorded_as_halted() -> None:
    stage = Stage()
    stage.request("ea", say("One."))
    stage.request("fa", command("move-head", pan=1))
    stage.select()
    stage.at(5).leave("ea")
    stage.at(10).mediator.emergency(True, True, 8)
    stage.select()
    halted = {r["behavior"]: r["outcome"] for r in stage.phases("cancel")}
    assert halted == {"ea#1": "running", "fa#1": "halted"}
    assert [r["serial"] for r in stage.phases("emergency")] == [8]
    stage.at(20).mediator.emergency(False, True, 9)
    assert stage.select() == ["fa#1"]


def test_e5_streams_do_not_resume_when_the_operator_says_so() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(10).mediator.emergency(True, True, 8)
    stage.at(20).mediator.emergency(False, False, 9)
    assert stage.select() == []
    assert stage.told("ea") == ["cancel.speak", "cancel.speak"]


# Baselines -----------------------------------------------------------------------------------


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


def test_a_chain_is_what_a_run_of_commands_becomes() -> None:
    assert [step.after for step in chain(say(), say(), say())] == [(), (0,), (1,)]


def test_none_does_not_let_a_unit_collide_with_itself() -> None:
    stage = Stage("none")
    stage.request("ea", Group([Step(say()), Step(command("gesture", name="nod"), (0,))]))
    stage.select()
    assert stage.phases("collision") == []


def test_u5_a_unit_owns_the_devices_of_what_the_profile_adds() -> None:
    camera = replace(TABLE_4_2["turn"], name="take-picture", devices=frozenset({"camera"}))
    stage = Stage(table={**TABLE_4_2, "take-picture": camera})
    asked = OpenUnit(1, 1, frozenset({"speaker"}), types=("take-picture",))
    stage.mediator.open_unit("fa", asked)
    stage.select()
    stage.request("ea", Command("take-picture", {"angle": 1}))
    assert stage.select() == []
    stage.request("fa", Command("take-picture", {"angle": 1}), unit=1)
    assert stage.select() == ["fa#2"]


def test_u4_no_feedback_command_of_the_profile_runs_in_a_unit_either() -> None:
    stage = Stage()
    stage.open("fa", 1, "speaker")
    stage.select()
    stage.request("fa", search(), unit=1)
    stage.select()
    assert stage.told("fa") == ["error.semantic"]


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
