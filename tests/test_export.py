"""Exports, each read by a reader that is not ours."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import webvtt
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree
from mcap.reader import make_reader
from praatio import textgrid
from pympi.Elan import Eaf

from prima import api
from prima.errors import UsageError
from prima.exports import FORMATS, timeline
from prima.exports.timeline import MOST_TIERS, Timeline

ROOT = Path(__file__).parent.parent
SCENARIOS = ROOT / "documents" / "scenarios"
ALL = sorted(SCENARIOS.rglob("*.xml"))
DEMO = SCENARIOS / "follow-during-navigation.xml"
Records = list[dict[str, Any]]


@pytest.fixture(scope="module")
def demo() -> api.Transcript:
    return api.rehearse(DEMO)


def exported(transcript: api.Transcript, to: str, **languages: str) -> bytes:
    out = io.BytesIO()
    api.export(transcript, to, out, {name.strip("_"): tag for name, tag in languages.items()})
    return out.getvalue()


def made(records: Records) -> Timeline:
    return timeline("t.jsonl", records)


def of(found: Timeline, name: str) -> list[tuple[float, float, str]]:
    """A tier's marks: start and end in seconds, and the text."""
    tier = next(tier for tier in found.tiers if tier.name == name)
    return [(mark.start / 1000, mark.end / 1000, mark.text) for mark in tier.marks]


def run(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "prima", "export", *words]
    return subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8")


# A few records, as a transcript has them ------------------------------------------------------


def start(time: float, behavior: str, command: str = "speak", **more: Any) -> dict[str, Any]:
    app, _, number = behavior.partition("#")
    record = {"time": time, "phase": "start", "actor": "robot", "app": app, "behavior": behavior}
    tree = f"{app}:{number.partition('.')[0]}"
    return {**record, "tree": tree, "command": command, "devices": [], "rule": "S1", **more}


def end(time: float, behavior: str, command: str = "speak", **more: Any) -> dict[str, Any]:
    app = behavior.partition("#")[0]
    record = {"time": time, "phase": "end", "actor": "robot", "app": app, "behavior": behavior}
    return {**record, "command": command, "outcome": "done", **more}


def event(time: float, name: str, actor: str = "environment", **more: Any) -> dict[str, Any]:
    return {"time": time, "phase": "event", "actor": actor, "event": name, **more}


# The timeline ---------------------------------------------------------------------------------


def test_the_demo_has_what_a_reader_of_its_table_expects(demo: api.Transcript) -> None:
    found = made(demo.records)
    assert of(found, "navigate: says")[0] == (0.0, 1.443, "Where are you going?")
    assert of(found, "navigate: does")[0] == (0.0, 4.147, '"Where are you going?"')
    assert of(found, "navigate: does")[2][:2] == (5.304, 11.304)  # twelve loops are one way
    assert of(found, "user: says")[1] == (14.104, 15.481, "Come on, follow me.")
    assert (11.304, 11.304, "touch.head (sensor head)") in of(found, "user: does")
    assert of(found, "navigate: streams")[:2] == [
        (0.0, 11.304, "navigate:1 active"),
        (11.304, 18.567, "navigate:1 suspended by follow:1"),
    ]
    assert of(found, "floor holder")[0] == (11.304, 18.567, "follow:1")
    assert of(found, "floor")[:3] == [
        (0.0, 1.443, "navigate"),
        (2.443, 4.147, "user"),
        (4.147, 5.304, "navigate"),
    ]
    assert of(found, "reactions")[1] == (18.481, 18.567, "message: navigate after 0.086 s")
    assert (18.568, 18.568, "S1 navigate#5") in of(found, "why")
    assert of(found, "device: locomotion")[0][2] == "navigate: Topological Move (to kidode-room)"


def test_reactions_are_those_of_the_measures(demo: api.Transcript) -> None:
    found = made(demo.records)
    delays = [end - start for start, end, _ in of(found, "reactions")]
    assert len(delays) == demo.summary().reactions
    assert max(delays) == pytest.approx(demo.summary().reaction_max)


def test_every_decision_and_every_event_is_there(demo: api.Transcript) -> None:
    phases = Counter(record["phase"] for record in demo.records)
    speech = sum(record.get("event") == "speech" for record in demo.records)
    found = made(demo.records)
    assert len(of(found, "why")) == phases["decision"]
    told = [m for tier in found.tiers if tier.kind in ("events", "user-does") for m in tier.marks]
    assert sum("event" in mark.about for mark in told) == phases["event"] - speech


def test_units_name_their_parts_and_do_not_occupy_devices() -> None:
    found = made(api.rehearse(SCENARIOS / "emotions-alone.xml").records)
    first = of(found, "emotions: units")[0]
    assert first[:2] == (1.0, 2.229) and "," in first[2]
    assert all("unit" not in text for _, _, text in of(found, "device: speaker"))


def test_what_gives_way_is_told_as_far_as_it_was_heard() -> None:
    run = api.rehearse(SCENARIOS / "situations" / "s07.xml", "prima+all")
    says = of(made(run.records), "museum: says")
    assert any(text == "This panel shows ..." for _, _, text in says)


def test_a_way_that_is_broken_off_is_two_intervals() -> None:
    found = made(
        [
            start(0.0, "a#1.1", "topological-move"),
            end(0.5, "a#1.1", "topological-move", outcome="again"),
            start(0.5, "a#1.2", "topological-move"),
            end(1.0, "a#1.2", "topological-move", outcome="again"),
            start(4.0, "a#1.3", "topological-move", resumed=True),
            end(4.5, "a#1.3", "topological-move"),
        ]
    )
    assert [one[:2] for one in of(found, "a: does")] == [(0.0, 1.0), (4.0, 4.5)]


def test_without_a_mediator_a_device_changes_hands() -> None:
    found = made(
        [
            start(0.0, "a#1", devices=["speaker"]),
            start(1.0, "b#1", devices=["speaker"]),
            {**end(1.0, "a#1"), "phase": "collision", "device": "speaker", "by": "b#1"},
            end(2.0, "a#1"),
            end(3.0, "b#1"),
        ]
    )
    assert [one[:2] for one in of(found, "device: speaker")] == [(0.0, 1.0), (1.0, 3.0)]
    assert of(found, "a: does")[0][:2] == (0.0, 2.0)


def test_what_is_not_over_ends_with_the_transcript() -> None:
    found = made([start(0.0, "a#1", text="Hello"), event(2.0, "bell")])
    assert of(found, "a: says") == [(0.0, 2.0, "Hello")]
    assert found.tiers[0].marks[0].about["outcome"] == "unfinished"


def test_a_recorded_duration_counts_and_a_guess_never_overlaps() -> None:
    found = made(
        [
            event(2.0, "speech", "user", text="One", data={"duration": 500}),
            event(2.1, "speech", "user", text="A long answer to a question", data={}),
        ]
    )
    assert of(found, "user: says") == [
        (1.5, 2.0, "One"),
        (2.0, 2.1, "A long answer to a question"),
    ]


def test_times_that_go_backwards_never_make_an_interval_of_less_than_nothing() -> None:
    found = made([start(5.0, "a#1"), end(1.0, "a#1"), event(2.0, "bell")])
    assert of(found, "a: does")[0][:2] == (5.0, 5.0)


# The formats ----------------------------------------------------------------------------------


def read_eaf(data: bytes, folder: Path) -> Eaf:
    (folder / "t.eaf").write_bytes(data)
    return Eaf(str(folder / "t.eaf"))


EAF_ATTRIBUTES = {
    "ANNOTATION_DOCUMENT": "AUTHOR! DATE! FORMAT VERSION! noNamespaceSchemaLocation",
    "HEADER": "MEDIA_FILE TIME_UNITS",
    "PROPERTY": "NAME",
    "TIME_ORDER": "",
    "TIME_SLOT": "TIME_SLOT_ID! TIME_VALUE",
    "TIER": "TIER_ID! PARTICIPANT ANNOTATOR LINGUISTIC_TYPE_REF! PARENT_REF LANG_REF",
    "ANNOTATION": "",
    "ALIGNABLE_ANNOTATION": "ANNOTATION_ID! TIME_SLOT_REF1! TIME_SLOT_REF2!",
    "REF_ANNOTATION": "ANNOTATION_ID! ANNOTATION_REF! CVE_REF",
    "ANNOTATION_VALUE": "",
    "LINGUISTIC_TYPE": "LINGUISTIC_TYPE_ID! TIME_ALIGNABLE CONSTRAINTS GRAPHIC_REFERENCES"
    " CONTROLLED_VOCABULARY_REF",
    "LANGUAGE": "LANG_ID! LANG_LABEL",
    "CONSTRAINT": "STEREOTYPE! DESCRIPTION",
    "CONTROLLED_VOCABULARY": "CV_ID!",
    "DESCRIPTION": "LANG_REF!",
    "CV_ENTRY_ML": "CVE_ID!",
    "CVE_VALUE": "LANG_REF!",
}
"""The elements of EAF 3.0 that an export may have, with their attributes; ! marks needed ones."""


def check_eaf_form(root: Any) -> None:
    """Hold a document to what the schema of EAF 3.0 asks of the elements used."""
    for element in root.iter():
        words = EAF_ATTRIBUTES[element.tag].split()
        names = {etree.QName(name).localname for name in element.attrib}
        assert names <= {word.rstrip("!") for word in words}, element.tag
        assert names >= {word[:-1] for word in words if word.endswith("!")}, element.tag
        assert not (len(element) and (element.text or "").strip()), element.tag
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", root.get("DATE"))
    assert root.get("FORMAT") == root.get("VERSION") == "3.0"
    assert root.find("HEADER").get("TIME_UNITS") == "milliseconds"
    assert all(len(one) == 1 for one in root.iter("ANNOTATION"))
    names_of_all = ("TIME_SLOT_ID", "ANNOTATION_ID", "LANG_ID", "STEREOTYPE")
    ids = [str(value) for name in names_of_all for value in root.xpath(f"//@{name}")]
    assert len(ids) == len(set(ids))  # one space of names, of XML's kind
    assert all(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_.-]*", one) for one in ids)
    kinds = root.xpath("//@TIME_ALIGNABLE | //@GRAPHIC_REFERENCES")
    assert set(kinds) <= {"true", "false"}


def check_eaf(data: bytes, found: Timeline, folder: Path) -> None:
    root: Any = etree.fromstring(data)
    check_eaf_form(root)
    order = [
        "HEADER",
        "TIME_ORDER",
        "TIER",
        "LINGUISTIC_TYPE",
        "LANGUAGE",
        "CONSTRAINT",
        "CONTROLLED_VOCABULARY",
    ]
    places = [order.index(child.tag) for child in root]
    assert places == sorted(places)
    names = ("TIME_SLOT_ID", "ANNOTATION_ID", "CVE_ID", "LANG_ID")
    ids = [str(value) for name in names for value in root.xpath(f"//@{name}")]
    assert len(ids) == len(set(ids))
    for name in ("TIME_SLOT_REF1", "TIME_SLOT_REF2", "ANNOTATION_REF", "CVE_REF", "LANG_REF"):
        assert {str(value) for value in root.xpath(f"//@{name}")} <= set(ids), name
    tiers = [str(value) for value in root.xpath("//@TIER_ID")]
    assert len(tiers) == len(set(tiers))
    assert set(root.xpath("//@PARENT_REF")) <= set(tiers)
    assert set(root.xpath("//@LINGUISTIC_TYPE_REF")) <= set(root.xpath("//@LINGUISTIC_TYPE_ID"))
    assert set(root.xpath("//@CONSTRAINTS")) <= set(root.xpath("//@STEREOTYPE"))
    times = [int(value) for value in root.xpath("//@TIME_VALUE")]
    assert times == sorted(times) and times.count(-1) == 0
    numbered = [int(value[1:]) for value in root.xpath("//@ANNOTATION_ID")]
    last = root.find("HEADER/PROPERTY[@NAME='lastUsedAnnotationId']")
    assert last is not None and last.text == str(max(numbered, default=0))
    eaf = read_eaf(data, folder)
    count = 0
    for name, tier in eaf.tiers.items():
        if "PARENT_REF" in tier[2]:
            continue
        marks = sorted(eaf.get_annotation_data_for_tier(name))
        count += len(marks)
        assert all(mark[0] < mark[1] for mark in marks), name
        assert all(a[1] <= b[0] for a, b in pairwise(marks)), name
    assert count == found.marks


def check_textgrid(data: bytes, found: Timeline, folder: Path) -> None:
    path = folder / "t.TextGrid"
    path.write_bytes(data)
    grid = textgrid.openTextgrid(str(path), includeEmptyIntervals=True)
    assert grid.validate("error")
    count = 0
    for tier in grid.tiers:
        assert tier.validate("error")
        if isinstance(tier, textgrid.PointTier):
            count += len(tier.entries)
            continue
        assert tier.entries[0].start == 0 and tier.entries[-1].end == grid.maxTimestamp
        assert all(one.end == other.start for one, other in pairwise(tier.entries))
        count += sum(bool(entry.label) for entry in tier.entries)
    assert count == sum(bool(m.text) or tier.points for tier in found.tiers for m in tier.marks)


def check_vtt(data: bytes, found: Timeline) -> None:
    captions = webvtt.from_string(data.decode()).captions
    said = [m for t in found.tiers if t.kind.endswith("says") for m in t.marks if m.text]
    said.sort(key=lambda mark: mark.start)
    assert Counter(one.text for one in captions) == Counter(mark.text for mark in said)
    assert [one.start_in_seconds for one in captions] == [mark.start // 1000 for mark in said]


def check_csv(data: bytes, found: Timeline) -> None:
    assert data.count(b"\n") == data.count(b"\r\n") == found.marks + 1
    rows = list(csv.DictReader(io.StringIO(data.decode(), newline="")))
    assert len(rows) == found.marks
    assert all(float(row["start"]) <= float(row["end"]) for row in rows)
    assert all(None not in row and None not in row.values() for row in rows)


def check_mcap(data: bytes, found: Timeline, records: Records) -> None:
    reader = make_reader(io.BytesIO(data), validate_crcs=True)
    summary = reader.get_summary()
    assert summary is not None
    schemas = {
        name: jsonschema.Draft202012Validator(json.loads(schema.data))
        for name, schema in summary.schemas.items()
    }
    begun, held, last = 0, [], 0
    for schema, channel, message in reader.iter_messages():
        assert schema is not None and schema.encoding == "jsonschema"
        told = json.loads(message.data)
        schemas[schema.id].validate(told)
        assert message.log_time >= last
        last = message.log_time
        if channel.topic == "/records":
            held.append(told)
        else:
            begun += told["active"]
            assert round(told["start" if told["active"] else "end"] * 1e9) == message.log_time
    assert held == records and begun == found.marks


@pytest.mark.parametrize("scenario", ALL, ids=lambda path: path.stem)
def test_every_scenario_is_read_by_other_programs(scenario: Path, tmp_path: Path) -> None:
    transcript = api.rehearse(scenario)
    check_all(transcript, tmp_path)


def check_all(transcript: api.Transcript, folder: Path) -> None:
    found = made(transcript.records)
    check_eaf(exported(transcript, "eaf"), found, folder)
    check_textgrid(exported(transcript, "textgrid"), found, folder)
    check_vtt(exported(transcript, "vtt"), found)
    check_csv(exported(transcript, "csv"), found)
    check_mcap(exported(transcript, "mcap"), found, transcript.records)


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


def test_mcap_schemas_give_each_field_one_type(demo: api.Transcript) -> None:
    """Foxglove reads no alternatives, and refuses the channel."""
    summary = make_reader(io.BytesIO(exported(demo, "mcap"))).get_summary()
    assert summary is not None
    for schema in summary.schemas.values():
        for name, field in json.loads(schema.data)["properties"].items():
            assert isinstance(field["type"], str), name
            assert field["type"] != "array" or isinstance(field["items"]["type"], str), name


# What strangers write -------------------------------------------------------------------------

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
    assert make_reader(io.BytesIO(exported(transcript, "mcap"))).get_summary() is not None


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
    for time in sorted(data.draw(st.lists(times, max_size=25))):
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


# The command line -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def folder(demo: api.Transcript, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("exports")
    (path / "t.jsonl").write_text(demo.dumps(), encoding="utf-8")
    return path


@pytest.mark.parametrize("to", FORMATS)
def test_the_command_writes_what_the_function_does(
    to: str, folder: Path, demo: api.Transcript
) -> None:
    done = run("t.jsonl", "-o", f"t.{to}", folder=folder)
    assert done.returncode == 0, done.stderr
    assert done.stderr.startswith(f"t.{to}: 18 tiers with ") and not done.stdout
    assert (folder / f"t.{to}").read_bytes() == exported(demo, to)


@pytest.mark.parametrize("to", FORMATS)
def test_it_writes_to_a_pipe_from_a_pipe(to: str, folder: Path, demo: api.Transcript) -> None:
    if not os.path.exists("/dev/stdin"):
        pytest.skip("no /dev/stdin here")
    command = [sys.executable, "-m", "prima", "export", "/dev/stdin", "--to", to]
    given = (folder / "t.jsonl").read_bytes()
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        out, _ = process.communicate(given)
    assert process.returncode == 0 and out == exported(demo, to)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["t.jsonl"], "Name a format: --to csv, eaf, mcap, textgrid or vtt"),
        (["t.jsonl", "--to", "textgird"], 'Did you mean "textgrid"?'),
        (["t.jsonl", "--to", "pdf"], "Name csv, eaf, mcap, textgrid or vtt."),
        (["none.jsonl", "--to", "csv"], "none.jsonl: cannot be read"),
        (["t.jsonl", "--to", "csv", "-o", "t.jsonl"], "this is the transcript itself"),
        (["t.jsonl", "--to", "csv", "-o", "no/t.csv"], "no/t.csv: cannot be written"),
        (["t.jsonl", "--to", "eaf", "--lang", "e_n"], "is not a language tag"),
        (
            ["t.jsonl", "--to", "csv", "--lang", "en"],
            "--lang works only with --to eaf, not with csv",
        ),
        (
            ["t.jsonl", "-o", "t.TextGrid", "--lang", "a=en"],
            "--lang works only with --to eaf, not with textgrid",
        ),
        (["t.jsonl", "--to", "eaf", "--lang", "en", "--lang", "ja"], "two languages of all: en"),
        (["t.jsonl", "--to", "eaf", "--lang", "folow=ja"], 'Did you mean "follow"?'),
        (["."], "Name a format"),
        ([".", "--to", "vtt"], "cannot be read: Is a directory"),
    ],
)
def test_wrong_usage_is_told(words: list[str], message: str, folder: Path) -> None:
    done = run(*words, folder=folder)
    assert done.returncode == 2 and message in done.stderr
    assert "Traceback" not in done.stderr and not done.stdout


def test_an_empty_file_and_one_with_its_head_alone(folder: Path, demo: api.Transcript) -> None:
    (folder / "empty.jsonl").write_text("")
    done = run("empty.jsonl", "--to", "vtt", folder=folder)
    assert done.returncode == 2 and "it has no records" in done.stderr
    check_all(api.Transcript(demo.records[:1], "head.jsonl"), folder)


def test_a_transcript_that_was_cut_off_is_written_as_far_as_it_goes(tmp_path: Path) -> None:
    whole = api.rehearse(SCENARIOS / "follow-during-navigation-ja.xml").dumps().encode()
    for length in range(20_000, 20_006):  # within a letter of several bytes, too
        (tmp_path / "cut.jsonl").write_bytes(whole[:length])
        done = run("cut.jsonl", "-o", "cut.csv", folder=tmp_path)
        assert done.returncode == 2 and "cut.jsonl:103: the record is cut off" in done.stderr
        assert "木戸出".encode() in (tmp_path / "cut.csv").read_bytes()


def test_letters_that_are_none_are_told(tmp_path: Path, demo: api.Transcript) -> None:
    (tmp_path / "t.jsonl").write_bytes(demo.dumps().encode().replace(b"poster", b"p\xffster"))
    done = run("t.jsonl", "--to", "csv", folder=tmp_path)
    assert done.returncode == 2 and "it is not UTF-8" in done.stderr


def test_without_the_library_mcap_tells_what_to_install(folder: Path) -> None:
    code = (
        "import sys; sys.modules['mcap'] = None; sys.argv = "
        "['prima', 'export', 't.jsonl', '-o', 'never.mcap']; from prima.cli import main; main()"
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8")
    assert done.returncode == 2 and "pip install 'prima[export]'" in done.stderr
    assert not (folder / "never.mcap").exists()


class Weighed(dict[str, Any]):
    """A record that counts how many of its kind there are at a time."""

    alive = most = 0

    def __init__(self, *args: Any, **more: Any) -> None:
        super().__init__(*args, **more)
        Weighed.alive += 1
        Weighed.most = max(Weighed.most, Weighed.alive)

    def __del__(self) -> None:
        Weighed.alive -= 1


def test_of_a_long_transcript_no_records_are_kept() -> None:
    def records() -> Iterator[dict[str, Any]]:
        for number in range(20_000):
            more = {"outcome": "again", "data": {"x": number}}
            yield Weighed(start(number, f"a#1.{number + 1}", "topological-move"))
            yield Weighed(end(number + 1, f"a#1.{number + 1}", "topological-move", **more))

    found = timeline("long.jsonl", records())
    assert of(found, "a: does")[0][:2] == (0.0, 20_000.0) and found.marks == 2
    assert Weighed.most < 10
