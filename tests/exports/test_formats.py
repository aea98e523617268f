"""Each format, read by a library that is not part of the project."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
import webvtt
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree
from mcap.reader import make_reader
from pympi.Elan import Eaf

from prima import api
from prima.errors import UsageError
from prima.exports import FORMATS
from prima.exports.timeline import MOST_TIERS
from tests.helpers.exporting import (
    DEMO,
    SCENARIOS,
    Records,
    check_all,
    check_csv,
    check_eaf,
    check_mcap,
    check_textgrid,
    end,
    event,
    exported,
    made,
    read_eaf,
    start,
)

ALL = sorted(SCENARIOS.rglob("*.xml"))


@pytest.mark.parametrize("scenario", ALL, ids=lambda path: path.stem)
def test_every_scenario_is_read_by_other_programs(scenario: Path, tmp_path: Path) -> None:
    transcript = api.rehearse(scenario)
    check_all(transcript, tmp_path)


def test_runs_without_a_mediator_are_read_too(tmp_path: Path) -> None:
    check_all(api.rehearse(DEMO, "none"), tmp_path)


@pytest.mark.parametrize("to", FORMATS)
def test_one_transcript_gives_one_file(to: str, demo: api.Transcript) -> None:
    assert exported(demo, to) == exported(demo, to)


def test_eaf_tells_languages_and_the_rules_as_a_vocabulary(
    demo: api.Transcript, tmp_path: Path
) -> None:
    root = etree.fromstring(exported(demo, "eaf", _="en", follow="ja"))
    tags = {tier.get("TIER_ID"): tier.get("LANG_REF") for tier in root.iter("TIER")}
    assert tags["navigate: says"] == tags["user: says"] == "en"
    assert tags["follow: says"] == "ja" and tags["why"] is None
    eaf = read_eaf(exported(demo, "eaf"), tmp_path)
    entries = {value[0][0][0] for value in eaf.controlled_vocabularies["rules"][1].values()}
    assert {value for _, _, value, _ in eaf.get_ref_annotation_data_for_tier("why rule")} <= entries
    assert eaf.get_parent_aligned_annotation(eaf_first(eaf, "why rule"))[2] == "S1 navigate#1"


def eaf_first(eaf: Eaf, tier: str) -> str:
    return str(next(iter(eaf.tiers[tier][1])))


def test_mcap_holds_the_runs_head(demo: api.Transcript) -> None:
    reader = make_reader(io.BytesIO(exported(demo, "mcap")))
    (attachment,) = reader.iter_attachments()
    assert json.loads(attachment.data) == demo.records[0]["data"]
    (metadata,) = reader.iter_metadata()
    assert metadata.metadata["scenario"] == "follow-during-navigation"
    topics = {channel.topic for channel in reader.get_summary().channels.values()}  # type: ignore[union-attr]
    assert {"/records", "/navigate/says", "/device/speaker", "/floor_holder"} <= topics


def test_mcap_ends_an_interval_of_no_duration() -> None:
    """A reaction in the instant of its event would else last until the next one."""
    event = {"time": 1.0, "phase": "event", "actor": "user", "event": "touch.head", "serial": 1}
    records = [event, start(1.0, "a#1", cause=1, text="Yes?"), end(2.0, "a#1", outcome="done")]
    transcript = api.Transcript(records, "t.jsonl")
    reader = make_reader(io.BytesIO(exported(transcript, "mcap")))
    told = [
        (one.log_time, json.loads(one.data)) for _, _, one in reader.iter_messages("/reactions")
    ]
    found = [(time // 1_000_000, one["active"]) for time, one in told]
    assert found == [(1000, True), (1001, False)]


def test_mcap_schemas_give_each_field_one_type(demo: api.Transcript) -> None:
    """Foxglove reads no alternatives, and refuses the channel."""
    summary = make_reader(io.BytesIO(exported(demo, "mcap"))).get_summary()
    assert summary is not None
    for schema in summary.schemas.values():
        for name, field in json.loads(schema.data)["properties"].items():
            assert isinstance(field["type"], str), name
            assert field["type"] != "array" or isinstance(field["items"]["type"], str), name


NASTY = [
    "=cmd|' /C calc'!A0",
    " +1",
    "-2",
    "@SUM(A1)",
    "'=1",
    "\uff1d1",
    "<script>alert(1)</script>",
    "a --> b",
    "</v>\n\nNOTE x",
    "&amp; \"quoted\" 'it'",
    "\x00\x1b[31m\x7f\ud800\ufffe",
    "木戸出先生の部屋です。",
    "\u2028line\r\n\r\nother",
    "]]>",
    "x" * 20_000,
    "\x1b[31m\u202e\udfff" * 20_000,
    "",
]


def nasty_records(text: str) -> Records:
    app = text or "a"
    return [
        {"time": 0.0, "phase": "run", "actor": "mediator", "data": {text: text, "date": text}},
        event(0.5, text, serial=1, data={text: text, "n": [text]}),
        event(0.6, "speech", "user", text=text),
        start(1.0, f"{app}#1", text=text, devices=[text], cause=1, source=text, rule=text),
        {"time": 1.0, "phase": "note", "actor": "user", "text": text},
        {
            "time": 1.0,
            "phase": "decision",
            "actor": "mediator",
            "winner": text,
            "rule": text,
            "losers": [text],
            "losers_count": 9,
        },
        {
            "time": 1.2,
            "phase": "suspend",
            "actor": "mediator",
            "app": app,
            "tree": text,
            "by": text,
        },
        {"time": 1.2, "phase": "floor", "actor": "mediator", "floor": [text]},
        end(2.0, f"{app}#1"),
    ]


@pytest.mark.parametrize("text", NASTY, ids=range(len(NASTY)))
def test_no_text_breaks_a_file(text: str, tmp_path: Path) -> None:
    transcript = api.Transcript(nasty_records(text), "t.jsonl")
    found = made(transcript.records)
    check_eaf(exported(transcript, "eaf"), found, tmp_path)
    check_textgrid(exported(transcript, "textgrid"), found, tmp_path)
    data = exported(transcript, "vtt").decode()
    assert len(webvtt.from_string(data)) == sum(
        bool(mark.text) for t in found.tiers if t.kind.endswith("says") for mark in t.marks
    )
    assert "<script" not in data and "\x1b" not in data
    check_csv(exported(transcript, "csv"), found)
    check_mcap(exported(transcript, "mcap"), found, transcript.records)


@pytest.mark.parametrize("text", NASTY[:6])
def test_no_cell_of_csv_is_a_formula(text: str) -> None:
    transcript = api.Transcript(nasty_records(text), "t.jsonl")
    rows = list(csv.reader(io.StringIO(exported(transcript, "csv").decode(), newline="")))
    cells = [cell for row in rows for cell in row]
    assert not [cell for cell in cells if cell.strip().startswith(tuple("=+-@\uff1d"))]
    assert f"'{text.strip()}" in cells


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_whatever_overlaps_every_file_is_well_formed(data: st.DataObject, tmp_path: Path) -> None:
    times = st.integers(0, 40).map(lambda tenths: tenths / 10)
    names = st.sampled_from(["a#1", "a#2", "b#1", "b#2.1", "b#2.2", "user#1"])
    records: Records = []
    for time in sorted(data.draw(st.lists(times, min_size=1, max_size=25))):
        name = data.draw(names)
        devices = data.draw(st.lists(st.sampled_from(["arm", "speaker"]), unique=True))
        records.append(
            data.draw(
                st.sampled_from(
                    [
                        start(time, name, text="Hi", devices=devices, cause=1),
                        start(time, name, "iu", devices=devices),
                        end(time, name, outcome=data.draw(st.sampled_from(["done", "again"]))),
                        event(time, "bell", serial=1),
                        event(time, "speech", "user", text="Yes"),
                        {"time": time, "phase": "listening", "actor": "robot", "behavior": name},
                    ]
                )
            )
        )
    check_all(api.Transcript(records, "t.jsonl"), tmp_path)


def test_overlapping_things_go_to_a_second_tier() -> None:
    found = made([start(0.0, "a#1"), start(1.0, "a#2"), end(2.0, "a#1"), end(3.0, "a#2")])
    assert [part.name for part in found.parts()] == [
        "a: does",
        "a: does-2",
        "a: streams",
        "a: streams-2",
    ]


def test_an_application_named_like_a_tier_keeps_its_own() -> None:
    found = made([start(0.0, "user#1", text="Hello"), end(1.0, "user#1"), event(1.0, "x", "user")])
    found = made([start(0.0, "user#1", text="Hi"), event(1.0, "speech", "user", text="Yes")])
    assert [tier.name for tier in found.tiers if "says" in tier.name] == [
        "user: says",
        "user: says-2",
    ]


def test_too_many_tiers_are_told() -> None:
    records = [start(0.0, f"a{number}#1") for number in range(MOST_TIERS + 1)]
    with pytest.raises(UsageError, match=r"t\.jsonl: more than"):
        made(records)
    at_once = made([event(1.0, "bell") for _ in range(MOST_TIERS + 1)])
    with pytest.raises(UsageError, match="because too many intervals overlap"):
        at_once.parts()


def test_a_record_that_lacks_something_is_told() -> None:
    with pytest.raises(UsageError, match="record 1 lacks a field of its phase"):
        made([{"time": 0.0, "phase": "suspend", "actor": "mediator"}])
