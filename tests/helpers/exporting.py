"""Records and transcripts to export."""

from __future__ import annotations

import csv
import io
import json
import re
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import Any

import jsonschema
import webvtt
from lxml import etree
from mcap.reader import make_reader
from praatio import textgrid
from pympi.Elan import Eaf

from prima import api
from prima.errors.visible import HARMFUL
from prima.exports import timeline
from prima.exports.timeline import Timeline
from tests import ROOT

SCENARIOS = ROOT / "documents" / "scenarios"
DEMO = SCENARIOS / "follow-during-navigation.xml"
Records = list[dict[str, Any]]


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
        assert not HARMFUL.search(message.data.decode() + channel.topic)
        told = json.loads(message.data)
        schemas[schema.id].validate(told)
        assert message.log_time >= last
        last = message.log_time
        if channel.topic == "/records":
            held.append(told)
        else:
            begun += told["active"]
            over = max(told["end"], told["start"] + 0.001)
            assert round((told["start"] if told["active"] else over) * 1e9) == message.log_time
    written = json.dumps(records, ensure_ascii=False).encode("utf-8", "replace")
    assert held == json.loads(written) and begun == found.marks  # half a character is a "?"


def check_all(transcript: api.Transcript, folder: Path) -> None:
    found = made(transcript.records)
    check_eaf(exported(transcript, "eaf"), found, folder)
    check_textgrid(exported(transcript, "textgrid"), found, folder)
    check_vtt(exported(transcript, "vtt"), found)
    check_csv(exported(transcript, "csv"), found)
    check_mcap(exported(transcript, "mcap"), found, transcript.records)
