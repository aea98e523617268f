"""The timeline that all exports are made of."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from prima import api
from prima.errors import UsageError
from prima.exports import tiers
from tests import ROOT
from tests.helpers.exporting import SCENARIOS, end, event, made, of, start


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


def test_a_unit_that_has_taken_too_long_lasts_as_long_as_something_in_it() -> None:
    late = {**end(1.0, "a#1", "iu"), "phase": "fail", "rule": "U5", "event": "error.unit.timeout"}
    found = made(
        [
            start(0.0, "a#1", "iu"),
            start(0.0, "a#2", text="A long story.", unit="a#1"),
            late,
            end(3.0, "a#2", outcome="done"),
            end(3.0, "a#1", "iu", outcome="done"),
        ]
    )
    (unit,) = next(tier for tier in found.tiers if tier.kind == "units").marks
    assert (unit.start, unit.end, unit.about["outcome"]) == (0, 3000, "failed")


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


def test_who_speaks_at_the_same_time_begins_when_each_does() -> None:
    found = made(
        [
            event(3.0, "speech", "user", text="One", data={"duration": 1500, "person": "ann"}),
            event(3.5, "speech", "user", text="Two", data={"duration": 1500, "person": "ben"}),
            event(4.0, "speech", "user", text="Three", data={"duration": 1500, "person": "ann"}),
        ]
    )
    assert of(found, "user: says") == [(1.5, 3.0, "One"), (2.0, 3.5, "Two"), (3.0, 4.0, "Three")]


@pytest.mark.parametrize("policy", ["prima", "prima+x10"])
@pytest.mark.parametrize(
    "text", ["Hello, my friend. It is me!", "!?", "\U0001f600", "你好，我叫小明。"]
)
def test_what_users_say_in_simulation_begins_when_they_begin(
    text: str, policy: str, tmp_path: Path
) -> None:
    robot, world = ROOT / "documents/robots/papero.xml", ROOT / "documents/worlds/room.xml"
    file = tmp_path / "two.xml"
    file.write_text(
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="two" world="{world}"'
        f' robot="{robot}"><robot at="middle"/><person id="ann" x="1" y="0"/>'
        f'<person id="ben" x="1" y="1"/><application src="{ROOT}/documents/ea/navigate.xml"/>'
        f'<when at="1s" person="ann"><say>{text}</say></when>'
        f'<when at="1.1s" person="ben"><say>{text}</say></when></scenario>',
        "utf-8",
    )
    found = of(made(api.rehearse(file, policy).records), "user: says")
    assert [start for start, _, _ in found] == [1.0, 1.1]


def test_times_that_go_backwards_never_make_an_interval_of_less_than_nothing() -> None:
    found = made([start(5.0, "a#1"), end(1.0, "a#1"), event(2.0, "bell")])
    assert of(found, "a: does")[0][:2] == (5.0, 5.0)


def test_what_no_file_could_hold_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    records = [start(0, "a#1", text="Hello."), end(86_400, "a#1")]
    assert made(records).end == 86_400_000
    with pytest.raises(UsageError, match=r"t\.jsonl: the transcript ends after more than a day\."):
        made([*records, event(86_400.001, "touch")])
    for most in ("MOST_MARKS", "MOST_LETTERS"):
        with monkeypatch.context() as lower:
            lower.setattr(tiers, most, 1)
            with pytest.raises(UsageError, match="Cut the transcript after whole lines"):
                made([*records, event(1, "touch.head"), event(2, "touch.head")])
