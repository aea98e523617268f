"""Long transcripts: read piece by piece, compared and printed with the same result."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prima import api
from prima.errors import UsageError
from prima.transcript.diff import compare, difference_json
from prima.transcript.lines import quick_reader, read_lines
from prima.transcript.observer import MOST_STREAMS, Observer
from prima.transcript.record import Entry, model
from prima.transcript.row import Row
from prima.transcript.rows import _bracket, make_rows

DEMO = Path("documents/scenarios/follow-during-navigation.xml")


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The demo's transcripts under two policies, as files."""
    folder = tmp_path_factory.mktemp("runs")
    found = []
    for policy in ("prima", "fifo"):
        path = folder / f"{policy}.jsonl"
        path.write_text(api.rehearse(DEMO, policy).dumps(), encoding="utf-8")
        found.append(path)
    return found


def test_what_is_skimmed_is_what_is_read(runs: list[Path]) -> None:
    for path in runs:
        whole, part = api.read(path), api.skim(path)
        assert part.rows() == whole.rows() and part.summary() == whole.summary()
        assert part.records == [whole.records[0], whole.records[-1]]
        assert (part.cut, part.early, part.name) == ("", "", str(path))


def test_what_is_skimmed_may_be_cut_off(runs: list[Path], tmp_path: Path) -> None:
    lines = runs[0].read_text(encoding="utf-8").splitlines(keepends=True)
    cut = tmp_path / "cut.jsonl"
    cut.write_text("".join(lines[:200]) + lines[200][:30], encoding="utf-8")
    whole, part = api.read(cut, partial=True), api.skim(cut)
    assert part.cut == whole.cut != "" and part.rows() == whole.rows()
    cut.write_text("".join(lines[:200]), encoding="utf-8")
    assert api.skim(cut).early == api.read(cut).early != ""
    cut.write_text("no transcript\n", encoding="utf-8")
    with pytest.raises(UsageError, match=r"cut\.jsonl:1: this is not a line of JSON"):
        api.skim(cut)


def test_the_difference_as_json_stands_as_any_json_of_prima(runs: list[Path]) -> None:
    for one, other in ((runs[0], runs[1]), (runs[0], runs[0])):
        difference = api.diff(api.skim(one), api.skim(other))
        told = "".join(difference_json(difference))
        data = json.loads(told)
        assert told == json.dumps(data, ensure_ascii=False, indent=2) + "\n"
        assert list(data) == ["differs", "counts", "before", "after", "changes"]
        assert data["counts"] == difference.counts and data["differs"] is difference.differs
        changed = [change for change in difference.changes if change.kind != "same"]
        assert [item["kind"] for item in data["changes"]] == [change.kind for change in changed]
        for item, change in zip(data["changes"], changed, strict=True):
            assert list(item) == ["kind", "before", "after", "delay"]
            for row, shown in ((change.before, item["before"]), (change.after, item["after"])):
                assert (row is None) == (shown is None)
                assert row is None or Row(**shown) == row


HEAD = '{"time":0,"phase":"run","actor":"mediator","data":{},"text":"'
LINES = [
    'x"}', 'x"} x', 'x"', '\\ud83d\\ude00"}', '\\ud800"}', '\\udc00"}', '\\uDC00\\uD83D"}', "\t\"}",
    'x","app":null}', 'x","nothing":1}', 'x","loop":1.0}', 'x","loop":true}', 'x","hold":2}',
    'x","hold":1e400}', 'x","time":3}', 'x","time":-1}', 'x","time":1e999}', 'x","time":"0"}',
    'NaN Infinity"}', 'x","data":{"a":NaN}}', 'x","data":{"a":-Infinity}}', 'x","data":{"a":1e400}}',
    'x","data":{"a":01}}', 'x","data":{"a":123456789012345678901234567890}}', 'x","losers":["a",1]}',
    'x","data":{"a":' + "[" * 300 + "]" * 300 + "}}", 'x","data":{"a":' + "[" * 100_000 + "}}",
]  # fmt: skip


@pytest.mark.parametrize("rest", LINES)
def test_lines_are_read_quickly_as_they_are_closely(rest: str) -> None:
    """What the quick reader takes is what JSON and the model take; of the rest these decide."""
    text = HEAD + rest + "\n"
    try:
        expected: Any = json.loads(text, parse_constant=lambda word: int(word))
        model().model_validate(expected)
        json.dumps(expected, ensure_ascii=False).encode()
    except (ValueError, RecursionError):
        expected = None
    try:
        (got,) = read_lines("t", [text])
    except UsageError as error:
        assert str(error).startswith("t:1: ")
        got = {}
    assert got == (expected or {})


def test_the_quick_reader_knows_every_field() -> None:
    for name in model().model_fields.keys() - {"time", "phase", "actor"}:
        record = quick_reader()(f'{{"time":1,"phase":"log","actor":"user","{name}":null}}')
        assert record == {"time": 1.0, "phase": "log", "actor": "user", name: None}


def marked(rows: list[Row]) -> list[str]:
    """How units are marked, one after the other: later ones go over earlier ones."""
    marks = [""] * len(rows)
    spans: dict[str, list[int]] = {}
    for index, row in enumerate(rows):
        if row.unit:
            spans.setdefault(row.unit, []).append(index)
    for held in spans.values():
        first, last = held[0], held[-1]
        marks[first : last + 1] = ["|"] * (last + 1 - first)
        marks[first] = marks[last] = "+" if first != last else "["
    return marks


@given(st.lists(st.sampled_from(["", "", "a", "b", "c", "d"]), max_size=30))
@settings(deadline=None)
def test_units_that_overlap_are_marked_in_order(units: list[str]) -> None:
    rows = [Row(0.0, "R", "app", "x", unit=unit) for unit in units]
    _bracket(rows, {})
    assert [row.bracket for row in rows] == marked(rows)


def test_units_inside_each_other_are_marked_once_each() -> None:
    """Each shows its ends; marked one by one, rows would be marked a hundred million times."""
    count = 10_000
    names = [*range(count), *reversed(range(count))]
    rows = [Row(0.0, "R", "app", "x", unit=f"u{number}") for number in names]
    _bracket(rows, {})
    assert {row.bracket for row in rows} == {"+"}


def test_rows_are_the_same_of_records_that_come_one_by_one(runs: list[Path]) -> None:
    entries = api.read(runs[0]).run().entries
    assert make_rows(iter(entries)) == make_rows(entries)


def row(what: str, time: float = 0.0, resumed: bool = False) -> Row:
    return Row(time, "R", "app", what, kind="speak", resumed=resumed)


def test_one_thing_said_very_often_is_compared_in_order() -> None:
    count = 50_000
    before = [row("Hello.", float(i)) for i in range(count)]
    after = [row("Hello.", float(i)) for i in range(0, count, 2)]
    difference = compare(before, after)
    assert difference.counts["lost"] == count - len(after)
    assert [change.after for change in difference.changes if change.after] == after


def stream(number: int) -> list[dict[str, Any]]:
    """A question of a stream of its own, which never ends, and a question to a service."""
    app = f"app{number % 7}"
    asks = {"behavior": f"{app}#{number}", "app": app, "command": "q-and-a", "text": "Well?"}
    when = {"tree": f"{app}:{number}", "actor": "robot", "time": float(number)}
    send = {"time": float(number), "phase": "send", "app": app, "data": {"to": f"s{number}"}}
    return [{**asks, **when, "phase": "request"}, {**asks, **when, "phase": "start"}, send]


def test_streams_that_never_end_are_looked_at_up_to_a_limit() -> None:
    """Each start looks at all streams and waits that go on."""
    observer = Observer()
    count = 3 * MOST_STREAMS
    for number in range(count):
        for record in stream(number):
            observer.add(Entry(record))
    assert len(observer._trees) == len(observer._waits) == MOST_STREAMS
    assert observer.result().unfaced == count
