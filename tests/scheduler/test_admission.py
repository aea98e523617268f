"""What may enter working memory (rule E3): each Command's limits, for each kind of application."""

from __future__ import annotations

from dataclasses import replace

import pytest

from prima.language.commands import LETTER_MS, LONGEST_TURN_MS, TABLE_4_2
from prima.messages import Command, Cue, Group, Step
from prima.scheduler.admission import MOST_AT_ONCE
from tests.helpers.stage import Stage, ask, chain, move, say

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
