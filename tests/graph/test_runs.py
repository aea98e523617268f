"""Pictures of runs: trees of behaviours at a moment, streams, all formats."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from lxml import etree

from prima import api
from prima.graph import picture, run
from prima.messages import Command, Record
from prima.scheduler.policy import policy_named
from prima.sim.rehearsal import Rehearsal
from prima.transcript.lines import finished
from prima.transcript.run import run_of
from prima.transcript.spans import base
from tests import ROOT
from tests.helpers.graphs import FLOW, SVG, read_dot, transcript
from tests.helpers.stage import Stage, say

MEMORIES = [
    "tutorial/interleaved.xml",
    "tutorial/channel.xml",
    "tutorial/trees.xml",
    "scenarios/emotions-alone.xml",
    "scenarios/three-applications.xml",
    "scenarios/pizza-and-video-timer.xml",
    "scenarios/leaving-the-museum.xml",
    "scenarios/dance-while-guiding.xml",
]


def memories(scenario: str, policy: str) -> tuple[list[Record], dict[float, dict[str, str]]]:
    """A run's records, and what the mediator's own memory held when each instant was over."""
    cast = api.load_scenario(ROOT / "documents" / scenario).cast
    rehearsal = Rehearsal(cast, policy_named(policy), None, None)
    records: list[Record] = []
    held: dict[float, dict[str, str]] = {}
    for made in rehearsal.run():
        records += map(finished, made)
        memory = rehearsal.session.mediator.memory.behaviors.values()
        if records:
            held[records[-1]["time"]] = {base(ab.name): ab.state for ab in memory}
    return records, held


@pytest.mark.parametrize("policy", ["prima", "prima+all", "fifo", "none"])
@pytest.mark.parametrize("scenario", MEMORIES)
def test_a_tree_at_a_moment_is_the_mediators_memory(scenario: str, policy: str) -> None:
    records, held = memories(scenario, policy)
    told = run_of(records)
    assert len(held) > 5
    for moment, known in list(held.items())[:-1]:
        graph = run.trees(told, moment)
        assert {key: node.kind for key, node in graph.nodes.items()} == known, moment


def test_figure_4_3_at_the_row_of_the_touch() -> None:
    held = transcript("tutorial/interleaved.xml")
    [touch] = [row for row in held.rows() if "touches" in row.what]
    graph = run.trees(held.run(), touch.time)
    assert {key: node.kind for key, node in graph.nodes.items()} == {
        "tour#1": "running",
        "tour#2": "linked",
        "tour#3": "linked",
        "tour#4": "linked",
        "hello#1": "waiting",
        "hello#2": "linked",
        "hello#3": "linked",
    }
    pairs = {(edge.source, edge.target) for edge in graph.edges}
    assert {("tour#2", "tour#4"), ("tour#3", "tour#4"), ("tour#1", "tour#2")} <= pairs
    assert {node.group for node in graph.nodes.values()} == {"tour:1", "hello:1"}


def test_a_unit_leads_to_its_parts() -> None:
    graph = run.trees(transcript("scenarios/emotions-alone.xml").run())
    assert [(e.target, e.kind) for e in graph.out("emotions#1")] == [
        ("emotions#2", "call"),
        ("emotions#3", "call"),
    ]
    assert "unit emotions#1" in graph.nodes["emotions#2"].marks


def test_streams_are_suspended_and_resumed_as_the_records_say() -> None:
    records = transcript("scenarios/three-applications.xml").records
    made = {stream.name: stream for stream in run.streams(run_of(records)).streams}
    for phase, end in (("suspend", False), ("resume", True)):
        told = {(r["tree"], r["time"]) for r in records if r["phase"] == phase}
        spans = {
            (stream.name, span.end if end else span.begin)
            for stream in made.values()
            for span in stream.pieces
            if span.kind == "away"
        }
        assert told == spans
    ends = {(r["tree"], r["time"]) for r in records if r["phase"] == "stream-end"}
    assert ends == {(stream.name, stream.end) for stream in made.values() if stream.ended}
    away = next(span for span in made["navigate:1"].pieces if span.kind == "away")
    assert run.in_words(away) == "suspended by coffee:1 (C2)"


@pytest.mark.parametrize("policy", ["prima", "fifo", "fair", "none"])
def test_as_many_streams_are_broken_as_are_measured(policy: str) -> None:
    held = transcript("scenarios/follow-during-navigation.xml", policy)
    broken = [
        s for one in run.streams(held.run()).streams for s in one.pieces if s.kind == "broken"
    ]
    assert len(broken) == held.summary().streams_broken
    assert all(span.end >= span.begin for span in broken)
    assert len(broken) == 2 or policy != "fifo"


def test_a_stream_that_is_spoken_into_is_red_from_there_on() -> None:
    stage = Stage("fifo")
    stage.request("ea", say("The answer is"), Command("move-head", {"pan": 30}), say("forty two."))
    stage.select()
    stage.at(900).end("ea#1")
    stage.select()
    stage.request("fa", say("I like trains."))
    stage.at(1000).select()
    for time, ends in ((1200, "ea#2"), (2000, "fa#1"), (3000, "ea#3")):
        stage.at(time).end(ends)
        stage.select()
    records = [{**record, "time": record["time"] / 1000} for record in stage.records]
    [stream, _] = run.streams(run_of(records)).streams
    [broken] = [span for span in stream.pieces if span.kind == "broken"]
    assert (broken.begin, broken.end, broken.by) == (1.0, 2.0, "fa:1")


@pytest.mark.parametrize("what", ["tree", "streams"])
def test_a_transcript_in_all_formats(what: str, tmp_path: Path) -> None:
    path = tmp_path / "t.jsonl"
    path.write_text(transcript("scenarios/dance-while-guiding.xml").dumps(), encoding="utf-8")
    root = etree.fromstring(picture(path, what=what).encode())
    assert root.findtext(f"{SVG}title")
    read = read_dot(picture(path, "dot", what))
    assert read.get_subgraphs()
    assert json.loads(picture(path, "json", what))["title"]
    lines = picture(path, "mermaid", what).splitlines()
    kinds = FLOW
    if what == "streams":
        date = r"2000-01-01 \d\d:\d\d:\d\d\.\d{3}"
        kinds = [
            "gantt", r"(title|section|dateFormat|axisFormat) [^\n;]+;?[\w]*", rf"[^:]+ :(active|done|crit), {date}, {date}",
        ]  # fmt: skip
    for line in lines:
        assert any(re.fullmatch(kind, line.strip()) for kind in kinds), line
