"""Playing the user: what is typed happens, and time goes on as far as it should."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest

from prima import api
from prima.api.rehearsing import fetcher
from prima.messages import Record
from prima.talk import game
from prima.transcript.rows import GrowingTable
from tests.helpers.talking import ASKS, DOCUMENTS, TOUCHED, room, start, type_in


# Time ------------------------------------------------------------------------------
def test_time_stops_where_a_question_listens_and_goes_on_with_the_answer(tmp_path: Path) -> None:
    talk, paper = start(room(tmp_path, ASKS))
    assert paper.what[-1] == '"Well?"'
    assert talk.game.asks is not None
    listens = talk.game.clock
    assert talk.prompt == f"{listens / 1000:g}s ea listens> "
    talk.line("Yes.")
    said = next(row for row in paper.made if row.what == '"Yes."')
    assert talk.game.lines[0].at == listens + 1000  # he thinks for a second
    assert said.time * 1000 > listens + 1000
    assert '"Thanks."' in paper.what
    assert talk.game.over


def test_an_empty_line_lets_a_question_pass(tmp_path: Path) -> None:
    talk, paper = start(room(tmp_path, ASKS))
    talk.line("")
    assert '"Nothing heard."' in paper.what


def test_a_question_that_waits_for_less_than_a_second_can_be_answered(tmp_path: Path) -> None:
    short = ASKS.replace("<prompt>", '<prompt timeout="300ms">')
    talk, paper = start(room(tmp_path, short))
    talk.line("Yes.")
    assert '"Thanks."' in paper.what


def test_what_is_no_answer_leaves_the_question_open(tmp_path: Path) -> None:
    talk, paper = start(
        room(tmp_path, ASKS.replace("<filled>", "<nomatch><reprompt/></nomatch><filled>"))
    )
    type_in(talk, "Maybe.", "Yes.")
    assert paper.what.count('"Well?"') == 2
    assert '"Thanks."' in paper.what


def test_going_back_in_time_lets_the_user_come_between(tmp_path: Path) -> None:
    talk, paper = start()
    assert '"Here we are."' in paper.what
    type_in(talk, "/back 5s", "/touch head", "Never mind.")
    rows = [(row.time, row.what) for row in talk.game.rows]
    assert (5.0, "touches the robot's head") in rows
    assert "resumes Topological Move (to kidode-room)" in [what for _, what in rows]


def test_what_is_played_is_what_a_scenario_would_play() -> None:
    talk, _ = start()
    type_in(talk, "/back 5s", "/touch head", "Never mind.")
    written = api.rehearse(TOUCHED)
    assert talk.game.records == written.records[1:-1]


def test_undo_takes_the_last_line_back_and_nothing_else() -> None:
    talk, paper = start()
    type_in(talk, "/back 5s", "/touch head")
    before = list(talk.game.records)
    type_in(talk, "Never mind.", "/undo")
    assert talk.game.records == before
    assert len(talk.game.lines) == 1
    type_in(talk, "/undo", "/undo")
    assert talk.game.lines == []
    assert paper.told[-1] == "There is nothing to undo."


def test_a_step_is_a_row(tmp_path: Path) -> None:
    talk, _ = start()
    talk.line("/back 0s")
    before = len(talk.game.rows)
    talk.line("/step")
    assert talk.game.rows[before].what == "Topological Move (to kidode-room)"
    assert len(talk.game.rows) == before + 1


def test_waiting_stops_time_exactly(tmp_path: Path) -> None:
    talk, _ = start()
    now = talk.game.clock
    type_in(talk, "/wait 2.5s", "/touch head")
    assert talk.game.lines[0].at == now + 2500


def test_what_never_ends_stops_after_a_minute_without_a_row(tmp_path: Path) -> None:
    path = room(tmp_path, '<form id="f"><block><tracking-human/></block></form>')
    talk, paper = start(path)
    assert 60_000 <= talk.game.clock <= 61_000
    before = talk.game.clock
    talk.line("/go")
    assert talk.game.clock == before + 60_000
    assert not paper.told


def test_several_doings_on_a_line_happen_in_sequence() -> None:
    talk, paper = start()
    type_in(talk, "/back 3s", "/touch head /wait 4s Never mind.")
    assert talk.game.lines == []
    assert "no time" in paper.told[-1] or paper.told  # what follows a time is a command
    type_in(talk, "/touch head /wait 4s /say Never mind. /wait 1s")
    assert [one.name for one in talk.game.lines[0].doings] == ["touch", "wait", "say"]
    said = next(row for row in talk.game.rows if row.kind == "speech")
    assert talk.game.clock == round(said.time * 1000) + 1000


def test_an_application_that_fails_is_told_and_the_session_goes_on(tmp_path: Path) -> None:
    path = room(
        tmp_path,
        '<form id="f"><on event="touch"><throw event="oh.dear"/></on></form>',
    )
    talk, paper = start(path)
    talk.line("/touch head")
    assert paper.told[-2].startswith("prima: ea: oh.dear")
    assert paper.told[-2].endswith("The session goes on.")
    talk.line("/touch head")
    assert "Every application has ended" in paper.told[-1]
    before = len(paper.made)
    talk.line("/load ea")
    assert paper.made[before].what == "starts ea"
    talk.line("/load ea")
    assert paper.told[-1] == '"ea" is already loaded. Remove it with /unload.'
    type_in(talk, "/unload ea", "/unload ea")
    assert paper.told[-1] in ('"ea" is not loaded. Load it with /load.',) or talk.game.over


def test_a_failure_and_what_follows_are_two_sentences(tmp_path: Path) -> None:
    talk, paper = start(
        room(tmp_path, '<form id="f"><on event="touch"><speak>A.</speak></on></form>')
    )
    type_in(talk, "/fail speaker hangs", "/touch head", "/wait 200s")
    told = [one for one in paper.told if "The session goes on." in one]
    assert told and all(". The" in one and ".. The" not in one for one in told)


def test_the_scenarios_user_is_left_out_unless_he_is_wanted() -> None:
    talk, paper = start()
    assert talk.game.scene.left_out == 2
    assert "touches the robot's head" not in paper.what
    _, paper = start(scripted=True)
    assert paper.what == [row.what for row in api.rehearse(TOUCHED).rows()]


def test_the_surroundings_of_a_scenario_are_kept() -> None:
    _, paper = start(DOCUMENTS / "scenarios" / "schedule-alone.xml")
    assert paper.what


# Rows ------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "scenario", sorted((DOCUMENTS / "scenarios").glob("*.xml")), ids=lambda path: path.stem
)
def test_rows_that_come_one_by_one_are_those_of_the_table(scenario: Path) -> None:
    made = api.rehearse(scenario)
    growing = GrowingTable()
    instants: dict[float, list[Record]] = {}
    for record in made.records:
        instants.setdefault(record["time"], []).append(record)
    rows = [row for records in instants.values() for row in growing.add(records)]
    assert [row.key for row in rows] == [row.key for row in made.rows()]
    assert [row.number for row in rows] == list(range(len(rows)))


def test_a_table_that_grows_for_months_keeps_no_rows() -> None:
    note: Record = {"time": 1.0, "phase": "note", "actor": "environment", "text": "It rains."}
    growing = GrowingTable()
    tracemalloc.start()
    try:
        assert sum(len(growing.add([dict(note)])) for _ in range(2_000)) == 2_000
        assert tracemalloc.get_traced_memory()[0] < 100_000
    finally:
        tracemalloc.stop()


def test_what_the_camera_saw_has_its_row_when_somebody_minds() -> None:
    seen: Record = {
        "time": 1.0, "phase": "event", "actor": "robot", "event": "human.found", "serial": 3,
    }  # fmt: skip
    growing = GrowingTable()
    assert growing.add([seen]) == []
    minded: Record = {
        "time": 2.0, "phase": "request", "actor": "robot", "behavior": "a#1", "cause": 3,
        "command": "speak", "app": "a", "priority": "high",
    }  # fmt: skip
    assert [row.what for row in growing.add([minded])] == ["sees the user"]


def test_somebody_who_is_gone_does_not_walk() -> None:
    talk, paper = start()
    type_in(talk, "/leave", "/walk 0 0")
    assert paper.told[-1] == 'Nobody is there to do "/walk".'


def test_who_tells_what_runs_and_what_is_asked() -> None:
    talk, paper = start(DOCUMENTS / "scenarios" / "navigate-alone.xml")
    talk.line("/who")
    assert "navigate listens" in paper.shown[-1]
    assert "running: navigate#1" in paper.shown[-1]
    assert "Prof. Kidode" not in paper.told


def test_why_gives_the_rule() -> None:
    talk, paper = start()
    type_in(talk, "/back 5s", "/touch head", "/why", "/why 4")
    assert "selected by rule" in paper.shown[-2]
    assert "It came from outside" in paper.shown[-1]


def test_a_session_has_a_limit() -> None:
    talk, paper = start()
    talk.line("/wait 86000s")
    talk.line("/wait 86000s")
    assert talk.done
    assert "no longer than a day" in paper.told[-1]


def test_a_session_has_no_more_lines_than_can_be_saved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(game, "MOST_LINES", 2)
    talk, paper = start()
    type_in(talk, "/note One.", "/note Two.", "/note Three.")
    assert paper.told[-1:] == ["A session may have 2 lines: save it, and start a new one."]
    assert len(talk.game.lines) == 2


def test_before_the_first_row_there_is_nothing_to_explain() -> None:
    talk, paper = start(real=True)
    type_in(talk, "/why", "/touch head")
    assert paper.told == ["There is no row yet."]
    assert "<!-- before the first row -->" in talk.game.saved("visit.xml")


def test_an_application_is_not_removed_twice() -> None:
    talk, paper = start()
    type_in(talk, "/back 5s", "/unload guide", "/unload guide")
    assert paper.told[-1:] == ['"guide" is not loaded. Load it with /load.']


def test_what_hosts_were_asked_is_not_undone() -> None:
    talk, paper = start(web=fetcher(["localhost"], 2))
    type_in(talk, "/touch head", "/undo", "/back 1s")
    assert paper.told[-2:] == ["Requests to hosts cannot be undone."] * 2


def test_the_help_tells_that_several_may_follow_one_another() -> None:
    talk, paper = start()
    type_in(talk, "/help", "/help walk")
    line = "Several on one line happen in sequence: Yes. /wait 2s /touch head"
    assert [line in one for one in paper.shown] == [True, False]
