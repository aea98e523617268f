"""Reading, tables, diff, and durations of speech."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from prima import api
from prima.messages import Record
from prima.sim import voice
from prima.transcript.diff import compare, format_difference, summary_line
from prima.transcript.lines import ORDER, finished, line
from prima.transcript.record import FIELDS
from prima.transcript.table import Row, format_rows, width

ROOT = Path(__file__).parent.parent
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


def test_the_writers_order_is_the_models_fields() -> None:
    assert sorted(ORDER) == sorted(FIELDS)


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
