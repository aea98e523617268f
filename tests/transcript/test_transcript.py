"""Reading, tables, diff, and durations of speech."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from prima import api
from prima.devices import voice
from prima.messages import Record
from prima.transcript.diff import compare, format_difference, summary_line
from prima.transcript.lines import finished, line
from prima.transcript.row import Row, describe
from prima.transcript.table import format_rows, read_table, width
from tests import ROOT

DEMO = ROOT / "documents" / "scenarios" / "follow-during-navigation.xml"


def rows(*whats: str, resumed: str = "") -> list[Row]:
    return [
        Row(
            0.0,
            "R",
            "ea",
            what.strip("!"),
            kind="speak",
            resumed=what == resumed,
            number=index,
        )
        for index, what in enumerate(whats)
    ]


def kinds(before: list[Row], after: list[Row]) -> list[str]:
    return [change.kind for change in compare(before, after).changes]


def test_every_record_fits_the_published_json_schema() -> None:
    schema = json.loads((ROOT / "schemas" / "transcript.schema.json").read_text(encoding="utf-8"))
    validator = jsonschema.Draft202012Validator(schema)
    for record in api.rehearse(DEMO).records:
        validator.validate(record)


def test_a_transcript_reads_back_as_it_was_written(tmp_path: Path) -> None:
    transcript = api.rehearse(DEMO)
    path = tmp_path / "t.jsonl"
    path.write_text(transcript.dumps(), encoding="utf-8")
    assert api.read(path).records == transcript.records
    assert api.read(path).dumps() == transcript.dumps()


class Word(str):
    """A string of a kind that JSON does not know."""


@pytest.mark.parametrize(
    "data",
    [
        {"list": [1, (2, [3])], "none": None, "yes": True, "nothing": -0.0, "large": 10**20},
        {1: "one", "deep": {2.5: "x", None: [{True: 1}]}},
        {"word": Word("a"), "words": [Word("b")], "letters": "é\ud800\u2028"},
        {},
    ],
    ids=["kinds", "keys", "words", "empty"],
)
def test_a_kept_record_is_what_its_line_reads_back(data: dict[object, object]) -> None:
    record: Record = {"data": data, "event": None, "time": 1234, "phase": "event", "actor": "user"}
    kept = finished(record)
    read: Record = json.loads(line(record))
    assert (kept, repr(kept), list(kept)) == (read, repr(read), list(read))
    assert list(kept) == ["time", "phase", "actor", "data"]
    assert kept["data"] is not data, "later changes do not reach it"


def test_diff_tells_moved_added_lost_changed() -> None:
    assert kinds(rows("a", "b", "c"), rows("a", "b", "c")) == ["same"] * 3
    assert kinds(rows("a", "b", "c"), rows("b", "c", "a")) == ["same", "same", "moved"]
    assert kinds(rows("a", "b"), rows("a", "x", "b")).count("added") == 1
    assert kinds(rows("a", "b", "c"), rows("a", "c")).count("lost") == 1
    assert kinds(rows("a", "b", "c"), rows("a", "x", "c")) == ["same", "changed", "same"]


def test_diff_tells_split_and_delayed() -> None:
    before, after = rows("a", "b"), rows("a", "b", "resumes a", resumed="resumes a")
    assert kinds(before, after) == ["same", "same", "split"]
    assert kinds(after, before) == ["same", "same", "joined"]
    late = rows("a", "b", "c")
    late[1].time = late[2].time = 5
    assert kinds(rows("a", "b", "c"), late) == ["same", "delayed", "same"], "only what causes it"


def test_diff_tells_what_comes_exactly_half_a_second_later() -> None:
    """2.3 - 1.8 is a little less."""
    before, after = rows("a"), rows("a")
    before[0].time, after[0].time = 1.8, 2.3
    assert 2.3 - 1.8 < 0.5 and kinds(before, after) == ["delayed"]


def test_diff_counts_repeated_behaviours_one_by_one() -> None:
    assert sorted(kinds(rows("a", "a", "b"), rows("a", "b", "a"))) == ["moved", "same", "same"]


def test_diff_of_policies_has_a_summary() -> None:
    difference = api.diff(api.rehearse(DEMO), api.rehearse(DEMO, "fifo"))
    line = summary_line(difference)
    assert "streams broken: 0 -> 2" in line
    assert "\x1b[" in format_difference(difference, colour=True)
    assert "\x1b[" not in format_difference(difference)


def test_the_table_is_aligned_for_wide_scripts_and_obeys_no_control_characters() -> None:
    made = rows("日本語で話す", "\x1b[31mred")
    for row in made:
        row.event = True
    lines = format_rows(made).splitlines()
    assert "\x1b" not in format_rows(made)
    assert width(lines[1]) == width(lines[2])


LONG = (
    'resumes Active Sensing Human, saying "Where are you? I have been looking for you"',
    "木戸出です。会議がまだ終わりませんので、お約束の時間に５分ほど遅れます。「はい」とどうぞ。",
    "http://service.example/a/very/long/address/that/has/no/space/and/goes/on?and=on&and=on",
    "e\u0301" * 90,
    "\U0001f600" * 45,
)


@pytest.mark.parametrize("columns", [70, 80, 81, 100, 200])
@pytest.mark.parametrize("why", [False, True])
def test_the_table_fits_its_columns_and_breaks_no_word(columns: int, why: bool) -> None:
    made = rows(*LONG)
    for row in made:
        row.event, row.rule = True, "S2c"
    lines = format_rows(made, why, columns).splitlines()
    assert max(map(width, lines)) <= columns
    event = lines[0].index("Event")
    left = lines[0].index("Behavior")
    firsts = [line for line in lines[1:] if line[:left].strip()]
    assert all(width(line[: line.index(" o")]) + 1 <= event + 1 for line in firsts)
    assert all(line.startswith(" " * left) for line in lines[1:] if line not in firsts)
    pieces = [line[left:event].strip() for line in lines[1:]]
    words = {word for piece in pieces for word in piece.split()}
    assert set(LONG[0].split()) <= words, "words are whole"
    assert not any(piece.startswith(("。", "、", "」", "\u0301")) for piece in pieces)


@pytest.mark.parametrize("columns", [60, 80, 100, 200])
def test_a_table_is_read_back_as_it_was(columns: int) -> None:
    made = rows(*LONG, "short")
    made[1].event = True
    printed = format_rows(made, columns=columns)
    back = read_table(printed)
    assert read_table(printed.replace("\n", "\n\n")) == back, "lines without anything are nothing"
    assert [(row.app, row.event) for row in back] == [(row.app, row.event) for row in made]
    assert [row.what for row in back[:3]] == list(LONG[:3])
    assert [row.what for row in back[4:]] == [LONG[4], "short"]


def test_columns_stay_aligned_in_long_runs_and_beside_long_names() -> None:
    made = rows("a", "b")
    made[1].time, made[1].number, made[1].event = 123456.78, 123456, True
    made[0].event = True
    head, *lines = format_rows(made).splitlines()
    assert {line.index(" o") + 1 for line in lines} == {head.index("Event")}
    assert [row.number for row in read_table(format_rows(made))] == [0, 1]
    made[0].app = "an-application-with-a-name-that-is-long-beyond-all-reason"
    made[0].what = LONG[0]
    assert "\n" + " " * 84 + "Human" not in format_rows(made)
    assert width(format_rows(made).splitlines()[0]) > 80, "the behaviour keeps its room"


@pytest.mark.parametrize(
    ("lang", "text", "low", "high"),
    [
        ("en", "Where are you going?", 1300, 2000),
        ("ja", "どちらへいらっしゃいますか。", 1700, 2600),
        ("ja", "今日は図書館が休みです。", 1700, 3200),
        ("en", "12", 400, 800),
        ("xx", "", 300, 300),
    ],
)
def test_speech_is_timed_by_language_and_script(lang: str, text: str, low: int, high: int) -> None:
    assert low <= voice.duration(text, lang, {}) <= high


def test_a_profiles_voice_counts() -> None:
    slow = voice.duration("Where are you going?", "en", {"en": 7.0})
    assert slow > voice.duration("Where are you going?", "en-GB", {"en": 14.0})


def test_what_an_application_sends_itself_is_nothing_that_happens_to_the_robot(
    tmp_path: Path,
) -> None:
    events = "touch.head", "message", "human.lost", "connection.disconnect.hangup"
    sends = "".join(f'<send event="{event}"/>' for event in events)
    (tmp_path / "a.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a" xml:lang="en">'
        f'<form id="a"><block>{sends}<pause time="1s"/><exit/></block></form></prima>'
    )
    made = api.rehearse(api.stage([], tmp_path / "a.xml"), isolate="none")
    assert [row.what for row in made.rows() if row.event] == list(events)


def test_an_argument_that_is_no_time_is_shown_as_it_is() -> None:
    assert describe("pause", None, {"time": "robot"}) == "Pause (time robot)"
    assert describe("pause", None, {"time": 500}) == "Pause (time 0.5s)"


def test_no_name_or_word_of_a_transcript_begins_a_line_of_its_own() -> None:
    """A row or a reason that PRIMA has not told cannot be put into what it prints."""
    app, fake = "a\n9  R    b", "x\n1 s: by F1"
    records = [
        {"time": 0.0, "phase": "request", "actor": "mediator", "app": app, "behavior": "a#1",
         "tree": "a:1", "command": "speak", "text": fake, "priority": "low", "source": fake},
        {"time": 0.0, "phase": "start", "actor": "robot", "app": app, "behavior": "a#1",
         "tree": "a:1", "command": "speak", "text": fake, "rule": "S1\u2028S2\x1b"},
    ]  # fmt: skip
    transcript = api.Transcript(records, "t.jsonl")
    lines = transcript.table(why=True).splitlines()
    assert len(lines) == 2 and "\x1b" not in lines[1]
    assert lines[0].index("Behavior") == lines[1].index('"x 1 s')
    assert len(api.explain_row(transcript, 0).splitlines()) == 4
