"""What a scenario leaves to chance: delays, chances and choices, drawn by its seed."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from statistics import median

import pytest

from prima import api
from prima.errors import DocumentError
from prima.loading import load_scenario
from prima.sim.happenings import When
from tests.helpers.here import prima
from tests.helpers.rehearsing import rehearse

QUIET = '<form id="a"><block><speak>Hello.</speak><exit/></block></form>'
ASKS = """<form id="a"><field name="x" type="boolean"><prompt timeout="5s">Shall I?</prompt>
  <noinput><reprompt/></noinput><nomatch><reprompt/></nomatch>
  <filled><clear/></filled></field></form>"""
SEEDS = range(1, 201)


def whens(folder: Path, script: str) -> list[When]:
    """What a scenario lets happen; each is drawn by the tests themselves."""
    rehearse(folder, QUIET, script)
    return load_scenario(folder / "scenario.xml").cast.scenario.whens


def spoken(folder: Path, script: str, body: str = QUIET) -> list[tuple[float, str]]:
    """What the user says, and when."""
    made = rehearse(folder, body, script)
    return [(one["time"], one["text"]) for one in made.records if one.get("event") == "speech"]


def test_delays_follow_their_distribution(tmp_path: Path) -> None:
    (when,) = whens(tmp_path, '<when at="lognormal(5s,0.5)" after="2s..4s"><say>Yes.</say></when>')
    at = [when.what.ms(seed) for seed in SEEDS]
    after = [when.after.ms(seed) for seed in SEEDS]
    assert 4500 < median(at) < 5600
    assert 2000 <= min(after) < 2100 and 3900 < max(after) <= 4000
    pairs = list(zip(at, after, strict=True))
    late = [one for when, one in pairs if when > 5000]
    soon = [one for when, one in pairs if when <= 5000]
    assert abs(median(late) - median(soon)) < 300, "each has numbers of its own"


def test_what_happens_again_is_drawn_again(tmp_path: Path) -> None:
    script = '<answer to="Shall I" after="normal(2s,500ms)">Yes.</answer>'
    (when,) = whens(tmp_path, script)
    drawn = [when.after.ms(1, number) for number in range(1, 101)]
    assert len(set(drawn)) > 90
    made = rehearse(tmp_path, ASKS, script, until="60s")
    asked = [one["time"] for one in made.records if one["phase"] == "listening"]
    said = [one for one in made.records if one.get("event") == "speech"]
    begun = [one["time"] - 0.25 for one in said]  # how long "Yes." takes is the same each time
    delays = [round((b - a) * 1000) for a, b in zip(asked, begun, strict=False)]
    assert len(delays) > 5
    for number, (delay, expected) in enumerate(zip(delays, drawn, strict=False), 1):
        assert delay - expected == delays[0] - drawn[0], number


def test_the_same_seed_gives_the_same_run(tmp_path: Path) -> None:
    script = '<when at="0s..20s"><say>Yes.</say></when>'
    first = rehearse(tmp_path, ASKS, script)
    path = tmp_path / "scenario.xml"
    assert first.records[0]["data"]["seed"] == 1
    assert api.rehearse(path).dumps() == first.dumps()
    assert api.rehearse(path, seed=1).dumps() == first.dumps()
    other = api.rehearse(path, seed=2)
    assert other.records[0]["data"]["seed"] == 2
    assert other.dumps() != first.dumps()
    assert api.replay(other, path).dumps() == other.dumps()
    path.write_text(path.read_text().replace('id="s"', 'id="s" seed="2"'))
    assert [one["time"] for one in api.rehearse(path).records] == [
        one["time"] for one in other.records
    ]


def test_a_run_in_which_nothing_is_drawn_has_no_seed(tmp_path: Path) -> None:
    made = rehearse(tmp_path, QUIET, '<when at="3s"><say>Yes.</say></when>')
    assert "seed" not in made.records[0]["data"]
    again = api.rehearse(tmp_path / "scenario.xml", seed=9)
    assert again.dumps() == made.dumps()


def test_other_elements_do_not_change_what_is_drawn(tmp_path: Path) -> None:
    drawn = '<when id="mine" at="0s..20s"><say>Yes.</say></when>'
    (alone,) = whens(tmp_path, drawn)
    more = '<when at="0s..20s"><say>No.</say></when>'
    first, second = whens(tmp_path, more + drawn)
    assert second.what.ms(1) == alone.what.ms(1) != first.what.ms(1)


def test_chances_come_as_often_as_they_say(tmp_path: Path) -> None:
    script = '<answer to="Shall I" chance="0.3">Yes.</answer>'
    (when,) = whens(tmp_path, script)
    happened = [when.chance.happens(seed, 1) for seed in SEEDS]
    assert 40 < sum(happened) < 80
    made = rehearse(tmp_path, ASKS, script, until="600s")
    asked = sum(one["phase"] == "listening" for one in made.records)
    said = sum(one.get("event") == "speech" for one in made.records)
    assert 0 < said < asked, "each question anew"
    sure = rehearse(tmp_path, ASKS, script.replace("0.3", "1"), until="60s")
    assert "seed" not in sure.records[0]["data"]
    never = rehearse(tmp_path, ASKS, script.replace("0.3", "0"), until="60s")
    assert not any(one.get("event") == "speech" for one in never.records)


def test_times_counts_what_has_happened(tmp_path: Path) -> None:
    script = '<when asked="Shall I" chance="0.5" times="3"><say>Yes.</say></when>'
    assert len(spoken(tmp_path, script, ASKS)) == 3


def test_one_of_several_things_happens(tmp_path: Path) -> None:
    script = """<when at="3s" after="0s..1s"><note>Now:</note><one-of>
      <say>Yes.</say><say>No.</say><touch sensor="head"/></one-of><say>Done.</say></when>"""
    rehearse(tmp_path, ASKS, script, until="20s")
    found: Counter[str] = Counter()
    for seed in range(1, 41):
        made = api.rehearse(tmp_path / "scenario.xml", seed=seed)
        doings = [one.get("text") or one["event"] for one in made.records if one["actor"] == "user"]
        assert doings[1] == "Done.", "and the rest follows"
        found[doings[0]] += 1
    assert found.keys() == {"Yes.", "No.", "touch.head"}
    assert min(found.values()) > 4


def test_services_and_starts_are_drawn(tmp_path: Path) -> None:
    body = """<form id="a"><block><send to="mail"/></block><on event="reply.mail"><log>got</log>
      <send to="mail"/></on></form>"""
    script = '<service name="mail"><reply after="1s..5s"/></service>'
    made = rehearse(tmp_path, body, script, until="60s")
    got = [one["time"] for one in made.records if one["phase"] == "log"]
    waits = {round(b - a, 3) for a, b in zip([0.0, *got], got, strict=False)}
    assert len(waits) == len(got) > 5
    assert all(0.9 < one <= 5.01 for one in waits)
    path = tmp_path / "scenario.xml"
    path.write_text(path.read_text().replace('kind="fa"/>', 'kind="fa" start="1s..9s"/>'))
    starts = {
        next(one["time"] for one in api.rehearse(path, seed=seed).records if one["phase"] == "load")
        for seed in (1, 2, 3)
    }
    assert len(starts) == 3 and all(1 <= one <= 9 for one in starts)


WRONG = {
    '<when at="nomal(5s,1s)"><leave/></when>': (
        'at "nomal(5s,1s)" cannot be drawn.',
        'There is no distribution "nomal". Did you mean "normal"?',
    ),
    '<when at="2s-4s"><leave/></when>': ('at "2s-4s" is not a range.', 'Write "2s..4s".'),
    '<when at="500 to 900ms"><leave/></when>': (
        'at "500 to 900ms" is not a range.',
        'Write "500ms..900ms".',
    ),
    '<when at="1.5..2s/1s"><leave/></when>': (
        'at "1.5..2s/1s" is not a range.',
        'Write "1.5s..2s".',
    ),
    '<when at="normal(5s)"><leave/></when>': (
        'at "normal(5s)" cannot be drawn.',
        "Write normal(MEAN,DEVIATION).",
    ),
    '<when at="9s..2s"><leave/></when>': (
        'at "9s..2s" cannot be drawn.',
        "The range ends before it begins.",
    ),
    '<when at="empirical(x.csv)"><leave/></when>': (
        'at "empirical(x.csv)" cannot be drawn.',
        "A document draws nothing from a file; vary it: prima sweep --vary PATH=empirical(x.csv).",
    ),
    '<when at="normal(5,1)"><leave/></when>': ('at "normal(5,1)" cannot be drawn.', '"5" '),
    '<when at="1s..1h"><leave/></when>': ('at "1s..1h" ', ""),
    '<when at="1s" chance="2"><leave/></when>': (
        'chance "2" is out of range: from 0 to 1.',
        'The nearest is "1".',
    ),
    '<when at="1s"><one-of/></when>': (
        "<one-of> holds nothing.",
        "Put into it what may happen, such as <say>Yes.</say><say>No.</say>.",
    ),
    '<person speed="0..9"/>': ('speed "0..9" cannot be drawn.', '"0" is out of range'),
}


@pytest.mark.parametrize("script", WRONG)
def test_what_cannot_be_drawn_has_a_remedy(tmp_path: Path, script: str) -> None:
    with pytest.raises(DocumentError) as caught:
        rehearse(tmp_path, QUIET, script)
    (problem,) = [one for one in caught.value.problems if one.severity == "error"]
    message, remedy = WRONG[script]
    assert problem.message.startswith(message)
    assert str(problem.remedy).startswith(remedy)


def test_the_command_line_takes_a_seed(tmp_path: Path) -> None:
    rehearse(tmp_path, ASKS, '<when at="0s..20s"><say>Yes.</say></when>', until="30s")
    path = tmp_path / "scenario.xml"
    made = [prima("run", str(path), "--seed", seed, "--format", "json") for seed in "112"]
    assert [one.returncode for one in made] == [0, 0, 0]
    assert made[0].stdout == made[1].stdout != made[2].stdout
    assert json.loads(made[2].stdout.splitlines()[0])["data"]["seed"] == 2
    for wrong in ("-1", "1" * 400, "x"):
        assert prima("run", str(path), "--seed", wrong).returncode == 2
