"""What may enter working memory (rule E3): each Command's limits, for each kind of application."""

from __future__ import annotations

from dataclasses import replace

import pytest

from prima.language.commands import LETTER_MS, LONGEST_TURN_MS, TABLE_4_2
from prima.messages import Command, Cue, Group, OpenUnit, Step
from prima.scheduler.admission import MOST_AT_ONCE, CommandRefused, check_number
from tests.helpers.stage import Stage, ask, chain, command, inserted, move, say

LOUD = dict(TABLE_4_2, speak=replace(TABLE_4_2["speak"], extra=frozenset({"volume"})))
LETTERS = LONGEST_TURN_MS // LETTER_MS
LONG = "x" * LETTERS
SILENT = Command("turn", {"angle": 30.0})


def refused(command: Command, app: str = "ea", table: object = LOUD) -> str:
    """The message with which it is refused; empty if it is not."""
    stage = Stage(table=table, apps={app: app}, refuses=True)  # type: ignore[arg-type]
    stage.request(app, replace(command))
    started = stage.select()
    failed = [str(record["message"]) for record in stage.phases("fail")]
    assert bool(started) != bool(failed)
    return failed[0] if failed else ""


def test_e3_additional_arguments_are_for_an_fa_and_those_that_the_robot_has() -> None:
    assert refused(Command("speak", text="Hi", extra={"volume": 1}), "fa") == ""
    told = refused(Command("speak", text="Hi", extra={"volume": 1}), "ea")
    assert told == "Only an FA may give speak additional arguments."
    told = refused(Command("speak", text="Hi", extra={"colour": 1}), "fa")
    assert told == 'speak has no additional argument "colour" on this robot.'
    stage = Stage(table=LOUD, refuses=True)
    stage.request("fa", Command("speak", text="Hi", extra={"colour": 1}))
    stage.select()
    assert stage.told("fa") == ["error.semantic"]


def test_e3_a_text_is_for_commands_that_speak() -> None:
    assert refused(replace(SILENT, text="Hi")) == "turn cannot say anything."
    assert refused(Command("speak")) == "speak has nothing to say."


def test_e3_what_the_robot_lacks_is_unsupported_and_what_nobody_knows_is_wrong() -> None:
    table = {name: row for name, row in TABLE_4_2.items() if name != "turn"}
    stage = Stage(table=table, refuses=True)
    stage.request("ea", SILENT)
    stage.select()
    assert stage.told("ea") == ["error.unsupported.turn"]
    assert refused(SILENT, table=table) == "This robot cannot do turn."
    assert refused(Command("trun", {"angle": 3.0})) == 'No Command "trun". Did you mean "turn"?'


@pytest.mark.parametrize(
    ("bad", "message", "event"),
    [
        (Command("fly"), 'No Command "fly".', "error.semantic"),
        (move(), "This robot cannot do topological-move.", "error.unsupported.topological-move"),
        (
            Command("turn", {"angle": 3.0}),
            "turn cannot be part of a unit: it leaves the user.",
            "error.semantic",
        ),
        (
            Command("tracking-human"),
            "tracking-human cannot be part of a unit: it works in loops.",
            "error.semantic",
        ),
    ],
)
def test_e3_a_bad_command_in_a_unit_is_refused_as_outside(
    bad: Command, message: str, event: str
) -> None:
    """U4: with it all of its request."""
    table = {name: row for name, row in TABLE_4_2.items() if name != "topological-move"}
    table["turn"] = replace(table["turn"], leaves=True)
    for deep in (False, True):
        inner = Group(chain(say("One."), replace(bad)))
        stage = Stage(table=table, refuses=True)
        stage.request("ea", Group(chain(say("Two."), inner)) if deep else inner)
        assert stage.select() == []
        assert [record["message"] for record in stage.phases("fail")] == [message]
        assert stage.told("ea") == [event]


def test_x6_a_command_in_a_unit_is_replaced_and_an_unknown_one_is_not() -> None:
    table = dict(TABLE_4_2, gesture=replace(TABLE_4_2["gesture"], substitute="turn"))
    stage = Stage("prima+x6", table=table)
    stage.request("ea", Group(chain(say("One."), Command("gesture", {"angle": 3.0}))))
    assert stage.select() == ["ea#1", "ea#2"]
    replaced = [(one["command"], one["by"]) for one in stage.phases("substitute")]
    assert replaced == [("gesture", "turn")]
    stage = Stage("prima+x6", table=table, refuses=True)
    stage.request("ea", Group(chain(Command("fly"))))
    assert stage.select() == []
    assert stage.told("ea") == ["error.semantic"]


@pytest.mark.parametrize(
    ("fits", "too_long"),
    [
        (say(LONG), say(LONG + "x")),
        (ask(LONG[5_000 // LETTER_MS :]), ask(LONG + "x")),
        (
            replace(say(LONG[1:]), cues=(Cue(0, "pause", LETTER_MS),)),
            replace(say(LONG[1:]), cues=(Cue(0, "pause", LETTER_MS + 1),)),
        ),
        (
            replace(say("x"), cues=(Cue(0, "lasts", LONGEST_TURN_MS - LETTER_MS), Cue(0, "end"))),
            replace(say("x"), cues=(Cue(0, "lasts", LONGEST_TURN_MS), Cue(0, "end"))),
        ),
        (
            replace(ask("x"), args={"timeout": "599950ms"}),
            replace(ask("x"), args={"timeout": "600s"}),
        ),
        (
            replace(ask("x"), args={"timeout": "5s"}, cues=(Cue(0, "pause", LETTER_MS),)),
            replace(ask("x"), args={"timeout": "5s"}, cues=(Cue(0, "pause", LONGEST_TURN_MS),)),
        ),
    ],
)
def test_e3_nobody_speaks_or_listens_longer_than_the_longest_turn(
    fits: Command, too_long: Command
) -> None:
    assert refused(fits) == ""
    message = refused(too_long)
    assert message.startswith("It keeps the speaker for at least "), message
    assert message.endswith(" s are the most. Divide it, or shorten its pauses and timeout.")
    stage = Stage(refuses=True)
    stage.request("ea", replace(too_long))
    stage.select()
    assert stage.told("ea") == ["error.semantic"]


@pytest.mark.parametrize(
    "command",
    [
        replace(say("Hi."), cues=(Cue(0, "rate", 10.0**9), Cue(1, "longest", 10**9))),
        replace(SILENT, cues=(Cue(0, "pause", 10**9),)),
        replace(say("Hi."), cues=(Cue(0, "pause", None), Cue(0, "lasts", "soon"))),
    ],
)
def test_e3_what_keeps_no_speaker_is_not_counted(command: Command) -> None:
    assert refused(command) == ""


@pytest.mark.parametrize(
    ("patience", "policy", "apps", "most"),
    [
        (60_000, "prima", {"ea": "ea", "fa": "fa"}, 60_000),
        (5_000, "prima", {"ea": "ea", "fa": "fa"}, 5_000),
        (90_000, "prima", {"ea": "ea", "fa": "fa"}, 90_000),
        (900_000, "prima", {"ea": "ea", "fa": "fa"}, LONGEST_TURN_MS),
        (0, "prima", {"ea": "ea", "fa": "fa"}, LONGEST_TURN_MS),
        (60_000, "fifo", {"ea": "ea", "fa": "fa"}, LONGEST_TURN_MS),
        (60_000, "prima", {"ea": "ea"}, LONGEST_TURN_MS),
    ],
)
def test_e6_beside_another_nobody_speaks_longer_than_the_patience(
    patience: int, policy: str, apps: dict[str, str], most: int
) -> None:
    for letters, heard in ((most // LETTER_MS, []), (most // LETTER_MS + 1, ["error.semantic"])):
        stage = Stage(policy, apps=apps, patience=patience, refuses=True)
        stage.request("ea", say("x" * letters))
        assert bool(stage.select()) == (heard == [])
        assert stage.told("ea") == heard
    assert all(record["rule"] == "E3" for record in stage.phases("fail"))


def test_e3_so_many_commands_wait_beside_one_another_and_no_more() -> None:
    stage = Stage()
    stage.request("fa", *(say("On.") for _ in range(3 * MOST_AT_ONCE)))  # one after the other
    stage.request("ea", steps=[Step(say("Hi.")) for _ in range(MOST_AT_ONCE)])
    stage.settle()
    assert stage.told("fa") == stage.told("ea") == []
    stage.request("ea", say("One more."))
    stage.settle()
    assert stage.told("ea") == ["error.semantic"]


def beside(width: int, *, first: bool, last: bool) -> list[Step]:
    """Branches of two Commands after one Command and before another, where there are such."""
    start = (0,) if first else ()
    steps = [Step(say("First."))] * first
    ends = []
    for _ in range(width):
        steps += [Step(say("One."), start), Step(say("Two."), (len(steps),))]
        ends.append(len(steps) - 1)
    return steps + [Step(say("Last."), tuple(ends))] * last


@pytest.mark.parametrize(
    ("first", "last"), [(False, False), (False, True), (True, False), (True, True)]
)
def test_e3_what_comes_before_and_after_branches_does_not_hide_them(
    first: bool, last: bool
) -> None:
    check_number(beside(MOST_AT_ONCE, first=first, last=last), 0)
    with pytest.raises(CommandRefused):
        check_number(beside(MOST_AT_ONCE + 1, first=first, last=last), 0)


def test_e3_branches_within_branches_count_together() -> None:
    halves: list[Step] = []
    for _ in range(2):
        at = len(halves)
        half = beside(MOST_AT_ONCE // 2, first=True, last=True)
        halves += [Step(one.what, tuple(index + at for index in one.after)) for one in half]
    check_number(halves, 0)
    with pytest.raises(CommandRefused):
        check_number(halves, 1)


def test_e6_who_starts_together_with_another_is_beside_it() -> None:
    stage = Stage(apps={}, refuses=True)
    stage.mediator.expect(["fa", "ea"])
    stage.mediator.load("fa", "fa")
    stage.request("fa", say(LONG))
    assert stage.select() == [] and stage.told("fa") == ["error.semantic"]
    stage.mediator.load("ea", "ea")
    stage.mediator.unload("ea", "exit")
    stage.request("fa", say(LONG))
    assert stage.select() == ["fa#1"]


def test_e6_who_is_alone_again_may_speak_for_long() -> None:
    stage = Stage()
    stage.mediator.unload("fa", "exit")
    stage.request("ea", say(LONG))
    assert stage.select() == ["ea#1"]


@pytest.mark.parametrize(
    ("content", "apps", "ends"),
    [
        (say("One."), {"ea": "ea", "fa": "fa"}, 70_000),
        (say("One."), {"ea": "ea"}, 90_000),
        (SILENT, {"ea": "ea", "fa": "fa"}, 90_000),
    ],
)
def test_e6_a_unit_keeps_the_speaker_no_longer_than_the_patience(
    content: Command, apps: dict[str, str], ends: int
) -> None:
    stage = Stage(apps=apps, patience=70_000)
    stage.request("ea", Group(chain(replace(content)), longest=90_000))
    stage.select()
    assert stage.mediator.deadline() == ends


# Requests -----------------------------------------------------------------------------------------


def test_e3_a_refusal_is_recorded_and_told_with_the_event_that_led_to_it() -> None:
    stage = Stage(refuses=True)
    wrong = Command("turn", {"angel": 5}, source="fa.xml:3:5")
    stage.at(40).request("fa", wrong, cause=7)
    stage.select()
    [record], [(_, notice)] = stage.phases("fail"), stage.notices
    assert record == {
        "time": 40,
        "phase": "fail",
        "actor": "mediator",
        "app": "fa",
        "rule": "E3",
        "command": "turn",
        "event": "error.semantic",
        "message": 'turn has no argument "angel". Did you mean "angle"?',
        "source": "fa.xml:3",
    }
    assert (notice.what, notice.run, notice.cause) == ("failed", 1, 7)
    assert (notice.event, notice.message) == (record["event"], record["message"])


def test_e3_a_refusal_reads_as_its_message() -> None:
    assert str(CommandRefused("error.semantic", "It is too long.", None)) == "It is too long."


def test_e3_the_words_of_a_topic_are_checked_if_the_robot_speaks() -> None:
    dumb = {name: row for name, row in TABLE_4_2.items() if name != "speak"}
    for table, told in ((TABLE_4_2, ["error.semantic"]), (dumb, [])):
        stage = Stage("prima+x9", table=table, refuses=True)
        stage.request("fa", command("turn", angle=5), words=say("x" * 1_000_000))
        stage.select()
        assert stage.told("fa") == told


def test_x4_what_is_asked_for_in_a_unit_does_not_face_the_user() -> None:
    """The unit does, before it begins."""
    stage = Stage("prima+x4")
    stage.mediator.ask("fa", OpenUnit(1, 1, frozenset({"speaker"}), connect=True))
    stage.request("fa", say("Hello."), unit=1, connect=True)
    assert stage.select() == ["fa#3"]
    assert inserted(stage) == [("X4", "face-human")]
    stage.at(100).end("fa#3")
    assert stage.select() == ["fa#1", "fa#2"]
    assert inserted(stage) == [("X4", "face-human")]
    assert [one.get("connect") for one in stage.phases("request")] == [True, None, None]
    assert [one.get("source") or "" for one in stage.phases("request")] == ["", "", ""]


def test_x8_only_a_reaction_may_come_too_late() -> None:
    stage = Stage("prima+x8")
    stage.request("ea", say("A long story."))
    stage.select()
    stage.request("fa", say("By the way."), fresh=2000)
    stage.select()
    stage.at(9000).mediator.expire()
    assert stage.select() == [] and stage.told("fa") == []


def test_x6_a_substitute_is_recorded_with_its_line() -> None:
    table = dict(TABLE_4_2, gesture=replace(TABLE_4_2["gesture"], substitute="stop-moving"))
    stage = Stage("prima+x6", table=table)
    stage.at(40).request("fa", Command("gesture", source="fa.xml:3:5"))
    stage.select()
    assert stage.phases("substitute") == [
        {
            "time": 40,
            "phase": "substitute",
            "actor": "mediator",
            "app": "fa",
            "rule": "X6",
            "command": "gesture",
            "by": "stop-moving",
            "source": "fa.xml:3",
        }
    ]


@pytest.mark.parametrize(
    ("policy", "devices"), [("prima", ["arm", "speaker"]), ("prima+x6", ["arm", "neck", "speaker"])]
)
def test_u5_a_unit_owns_the_devices_of_substitutes_if_there_are_any(
    policy: str, devices: list[str]
) -> None:
    """Nor does it own those of Commands that the robot lacks."""
    table = dict(TABLE_4_2, gesture=replace(TABLE_4_2["gesture"], substitute="move-head"))
    stage = Stage(policy, table=table)
    types = ("gesture", "take-picture", "point-by-hand")
    stage.mediator.ask("fa", OpenUnit(1, 1, frozenset({"speaker"}), types=types))
    stage.select()
    assert stage.phases("request")[0]["devices"] == devices


def test_e2_what_an_unloaded_application_leaves_is_recorded_by_the_rule() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker")
    stage.request("ea", say("One."), say("Two."), unit=1)
    stage.request("ea", command("turn", angle=5), state=2)
    stage.select()
    stage.at(40).mediator.unload("ea", "crash")
    stage.at(50).end("ea#2")
    assert stage.select() == [] and stage.running == set(), "its unit ends as well"
    gone = [(one["behavior"], one["rule"]) for one in stage.phases("cancel")]
    assert gone == [("ea#4", "E2"), ("ea#3", "E2")]
    assert stage.phases("unload") == [
        {
            "time": 40,
            "phase": "unload",
            "actor": "mediator",
            "app": "ea",
            "rule": "E2",
            "outcome": "crash",
        }
    ]


def test_o3_only_what_the_state_has_asked_for_is_deleted() -> None:
    stage = Stage()
    stage.request("fa", say("Long."))
    stage.select()
    stage.request("ea", say("One."), cause=7, state=1)
    stage.request("ea", say("Two."), cause=8, state=2)
    stage.at(40).leave("ea")
    stage.select()
    assert [one["behavior"] for one in stage.phases("cancel")] == ["ea#1"]
    left = {"time": 40, "phase": "leave", "actor": "mediator", "app": "ea", "rule": "O3"}
    assert stage.phases("leave") == [{**left, "state": 1}]


def test_o2_in_a_unit_what_was_requested_at_once_is_cancelled_whole() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "neck")
    both = [Step(say("One.")), Step(command("move-head", pan=1))]
    stage.request("ea", steps=both, unit=1)
    stage.request("ea", command("move-head", pan=2), unit=1)
    stage.select()
    stage.at(10).request("ea", replace(say("Wait!"), now=True), unit=1)
    assert stage.select() == ["ea#5"]
    assert stage.running == {"ea#1", "ea#3", "ea#5"}, "what runs on other devices finishes"
    assert stage.told("ea") == ["cancel.move-head", "cancel.speak"]
    stage.end("ea#3")
    assert stage.select() == ["ea#4"], "what was requested by itself is carried out"


def test_e3_at_most_five_hundred_commands_wait_side_by_side() -> None:
    for number, told in ((500, []), (501, ["error.semantic"])):
        stage = Stage(refuses=True)
        stage.request("ea", steps=[Step(say("One."))] * number)
        stage.select()
        assert stage.told("ea") == told


def test_e3_a_question_may_wait_for_an_answer_as_long_as_a_turn_lasts() -> None:
    for timeout, told in (("20000ms", []), ("20001ms", ["error.semantic"])):
        stage = Stage(patience=20_000, refuses=True)
        stage.request("ea", Command("q-and-a", {"timeout": timeout}))
        stage.select()
        assert stage.told("ea") == told


def test_u5_all_devices_that_a_unit_lacks_are_named_in_order() -> None:
    stage = Stage(refuses=True)
    stage.open("ea", 1, "neck")
    stage.request("ea", command("turn", angle=5), unit=1)
    stage.request("ea", command("face-human"), unit=1)
    stage.request("ea", ask(), unit=1)
    stage.select()
    assert [record["message"] for record in stage.phases("fail")] == [
        f"{name} needs {devices}, which its unit does not own."
        for name, devices in (
            ("turn", "locomotion"),
            ("face-human", "human-detection, locomotion"),
            ("q-and-a", "speaker, speech-recognition"),
        )
    ]


def test_o1_in_a_unit_a_command_follows_the_latest_of_the_unit() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "neck")
    stage.request("ea", say("One."), unit=1)
    stage.request("ea", command("move-head", pan=1), unit=1)
    assert stage.select() == ["ea#1", "ea#2"], "though its device is free"
    stage.at(10).end("ea#2")
    assert stage.select() == ["ea#3"]


def test_o1_a_reaction_begins_a_stream_of_its_own_even_in_a_window() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(10).end("ea#1", then=lambda: stage.request("ea", say("Oh!"), cause=7))
    stage.select()
    assert [one["tree"] for one in stage.phases("request")] == ["ea:1", "ea:1", "ea:2"]
