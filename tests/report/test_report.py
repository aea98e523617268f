"""The report's page as text: its structure, escaping, languages, ways and messages."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from html.parser import HTMLParser
from itertools import pairwise
from math import dist
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima import api
from prima.errors import UsageError
from prima.errors.visible import visible
from prima.report import MOST_ROWS, make
from prima.report.lanes import make_lanes
from prima.report.parts import json_text, text
from prima.report.view import language
from prima.report.walk import RobotWalk, reported, walk_of
from prima.transcript.lines import read_lines
from prima.transcript.row import Row
from prima.transcript.rules import RULES
from prima.transcript.run import run_of
from tests import ROOT
from tests.helpers.generated_report import long_run
from tests.helpers.here import prima

SCENARIOS = ROOT / "documents" / "scenarios"
SCENARIO = SCENARIOS / "follow-during-navigation.xml"
VOID = {"meta", "input", "br", "img", "link", "hr"}


@cache
def run(policy: str = "prima", scenario: Path = SCENARIO) -> api.Transcript:
    return api.rehearse(scenario, policy)


class Outline(HTMLParser):
    """A page's elements; says whether each is closed where it should be."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open.pop() == tag, tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.found if name == tag]


def data_of(page: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found
    made: dict[str, Any] = json.loads(found[1])
    return made


# The page ----------------------------------------------------------------------


def test_a_page_is_whole_and_needs_nothing_beside_it() -> None:
    page = make([run()])
    outline = Outline(page)
    for tag in ("html", "main", "header", "footer", "h1", "title"):
        assert len(outline.all(tag)) == 1, tag
    assert outline.all("html")[0]["lang"] == "en"
    assert not outline.all("link") and not outline.all("img") and not outline.all("iframe")
    assert not [one for _, one in outline.found if "style" in one or "src" in one]
    assert not [name for _, one in outline.found for name in one if name.startswith("on")]
    addresses = [one["href"] for one in outline.all("a")]
    assert all(address and address.startswith("#") for address in addresses)
    assert (
        "http://" not in page.replace("http://www.w3.org/2000/svg", "") and "https://" not in page
    )
    policy = next(one for one in outline.all("meta") if "http-equiv" in one)["content"]
    assert policy and policy.startswith("default-src 'none';") and "unsafe" not in policy
    ids = [one["id"] for _, one in outline.found if one.get("id")]
    assert len(ids) == len(set(ids))


def test_the_table_is_that_of_prima_show() -> None:
    page = make([run()])
    words = "".join(Outline(page).words)
    rows = run().rows()
    assert page.count('<tr role="row" id="row-') == len(rows) == 35
    for row in rows:
        assert row.what in words
    data = data_of(page)
    assert [one[3] for one in data["runs"][0]["rows"]] == [row.what for row in rows]


def test_the_head_tells_scenario_policy_version_and_measures() -> None:
    page = make([run("fifo")])
    for word in ("follow-during-navigation", "<dd>fifo</dd>", "<dd>1.0.0</dd>", "follow (FA)"):
        assert word in page
    assert "<dt>Broken</dt><dd>2</dd>" in page
    assert "<dt>Reaction time</dt><dd>32.56/97.68 s</dd>" in page
    assert "<dt>Response time</dt><dd>48.84/97.68 s</dd>" in page


def test_reasons_are_those_of_prima_explain() -> None:
    made = run()
    whys = data_of(make([made]))["runs"][0]["whys"]
    for row in made.rows():
        told = api.explain_row(made, row.number)
        for time, words, _, _ in whys[row.number].get("reasons", []):
            assert f"{time:.3f} s: {words}" in told
        assert len(whys[row.number].get("reasons", [])) == told.count(" s: ") - 1  # the head's
    data = data_of(make([made]))["runs"][0]
    assert data["whys"][14]["source"] == "navigate.xml:61"
    assert data["names"]["navigate#3"][1:] == ["navigate.xml:39", 6]
    assert data["whys"][10]["cause"] == 9


def test_the_same_transcripts_give_the_same_bytes() -> None:
    code = (
        "import sys; from prima import api; from prima.report import make;"
        f"sys.stdout.write(make([api.rehearse({str(SCENARIO)!r})],"
        f"[api.load_scenario({str(SCENARIO)!r})]))"
    )
    pages = {
        subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONIOENCODING": "utf-8"},
        ).stdout
        for seed in ("1", "2")
    }
    assert len(pages) == 1 and len(pages.pop()) > 50_000


def test_two_runs_have_the_changes_of_prima_diff() -> None:
    page = make([run(), run("fifo")])
    Outline(page)
    difference = api.diff(run(), run("fifo"))
    data = data_of(page)
    assert [change[0] for change in data["changes"]] == [one.kind for one in difference.changes]
    for kind, count in difference.counts.items():
        assert page.count(f'class="row kind-{kind}"') == count
    assert "was row 33, at 76.36 s" in page and "2 moved, 4 added, 10 lost" in page


def test_two_equal_runs_are_alike() -> None:
    assert "The two runs are alike." in make([run(), run()])


# Strangers' texts -----------------------------------------------------------------

EVIL = "</script><!--<script><b onclick='x'>\u2028\u2029\"&amp;\x00\x1b[31m"


def test_nothing_that_is_said_becomes_markup() -> None:
    assert json.loads(json_text([EVIL])) == [visible(EVIL, "\n")]
    assert json.loads(json_text(["</script> & <b>"])) == ["</script> & <b>"]
    assert not re.search("[<>&\u2028\u2029]", json_text([EVIL]))
    assert not re.search("[<>\"'\x00\x1b]", text(EVIL))
    records = json.loads(json.dumps(run().records))
    for record in records:
        for name in ("text", "message", "source", "rule"):
            record[name] = EVIL
    records[0]["data"].update(scenario=EVIL, policy=EVIL, version=EVIL, files={EVIL: EVIL})
    bad = api.Transcript(records, EVIL, cut=EVIL)
    for page in (make([bad]), make([bad, run()])):
        outline = Outline(page)
        assert not outline.all("b") and len(outline.all("script")) == 2
        assert "\x00" not in page and "\x1b" not in page


def test_names_without_end_are_cut() -> None:
    records = json.loads(json.dumps(run().records))
    for record in records:
        if "text" in record:
            record["text"] = "word " * 50_000
        if record["phase"] == "decision":
            record["losers"] = [f"navigate#{number}" for number in range(5000)]
    assert len(make([api.Transcript(records, "x")])) < 3_000_000


def test_odd_values_are_no_places() -> None:
    records = json.loads(json.dumps(run().records))
    moves = [one for one in records if one["phase"] == "end" and "x" in (one.get("data") or {})]
    for record, odd in zip(moves, (1e999, "left", None, True, 1e300), strict=False):
        record["data"]["x"] = odd
    assert len(reported(run_of(records))) == len(moves) - 5
    Outline(make([api.Transcript(records, "x")]))


def test_a_record_that_lacks_something_is_told() -> None:
    records = json.loads(json.dumps(run().records))
    for record in records:
        if record["phase"] == "request":
            del record["tree"]
    with pytest.raises(UsageError, match="lacks a field of its phase"):
        make([api.Transcript(records, "bad.jsonl")])


VALUES: list[Any] = [None, "", "x", -1, 1e999, True, [], {}, ["x", 1], {"x": [1]}, EVIL]


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_odd_records_give_a_page_or_a_message(data: st.DataObject) -> None:
    """What the model lets through of a stranger's transcript, and what it need not."""
    records = json.loads(json.dumps(run().records))
    for _ in range(data.draw(st.integers(1, 12))):
        record = data.draw(st.sampled_from(records))
        name = data.draw(
            st.sampled_from(sorted(record.keys() - {"time", "phase", "actor"}) or ["app"])
        )
        where = record
        if isinstance(record.get(name), dict) and record[name] and data.draw(st.booleans()):
            where, name = record[name], data.draw(st.sampled_from(sorted(record[name])))
        if data.draw(st.booleans()):
            where.pop(name, None)
        else:
            where[name] = data.draw(st.sampled_from(VALUES))
    lines = api.Transcript(records, "x").dumps().splitlines(keepends=True)
    try:
        held = list(read_lines("x", lines))
        page = make([api.Transcript(held, "x")], [api.load_scenario(SCENARIO)])
    except UsageError:
        return
    Outline(page)
    data_of(page)


@pytest.mark.parametrize("keep", [1, 2, 6, 20, 60, 120])
def test_a_transcript_that_was_cut_off_is_shown_as_far_as_it_goes(keep: int) -> None:
    page = make([api.Transcript(run().records[:keep], "x")], [api.load_scenario(SCENARIO)])
    Outline(page)
    assert "the transcript is cut off" in page
    assert data_of(page)["runs"][0]["walk"]["source"] == "run"


def test_too_much_is_refused_with_a_remedy() -> None:
    with pytest.raises(UsageError, match="A report shows one run or compares two"):
        make([run()] * 3)
    with pytest.raises(UsageError, match="A report shows one run or compares two"):
        make([])
    with pytest.raises(UsageError, match="one for each"):
        make([run()], [api.load_scenario(SCENARIO)] * 2)
    with pytest.raises(UsageError, match="Use prima show"):
        make([long_run(MOST_ROWS + 1)])


# Languages --------------------------------------------------------------------------


def test_what_is_said_has_its_language() -> None:
    japanese = SCENARIOS / "follow-during-navigation-ja.xml"
    page = make([run(scenario=japanese)])
    spoken = Outline(page).all("bdi")
    assert spoken and all(one["lang"] == "ja" for one in spoken)
    english = Outline(make([run()])).all("bdi")
    assert english and all(one["lang"] == "en" for one in english)
    untold = run()
    for record in untold.records:
        if record["phase"] == "load":
            record.get("data", {}).pop("lang", None)
    unknown = Outline(make([untold])).all("bdi")
    assert unknown and all(one["lang"] == "" for one in unknown)


@pytest.mark.parametrize(
    ("said", "found"),
    [
        ("こんにちは", "ja"),
        ("研究室", "zh"),
        ("안녕", "ko"),
        ("Bonjour", ""),
        ("ﾊｲ", "ja"),
        ("", ""),
    ],
)
def test_a_script_tells_a_language(said: str, found: str) -> None:
    assert language(said) == found


def test_chinese_characters_in_a_japanese_run_are_japanese() -> None:
    assert language("研究室", japanese=True) == "ja"


# Lanes and ways -----------------------------------------------------------------------


def test_loops_are_one_bar_and_what_waits_is_told() -> None:
    made = run()
    lanes = make_lanes(made.run(), made.rows())
    first = next(bar for bar in lanes.behaviors if bar.name == "navigate#3")
    assert (first.begin, first.row, first.devices) == (5.304, 6, ("localization", "locomotion"))
    assert len(first.cuts) > 5
    assert [(bar.name, bar.begin) for bar in lanes.away][:2] == [
        ("navigate:1", 11.304),
        ("follow:1", 18.567),
    ]
    assert lanes.apps == ["follow", "navigate"]
    assert all(bar.end >= bar.begin for bar in lanes.behaviors)
    units = run(scenario=SCENARIOS / "picture-alone.xml")
    marked = make([units]).count("<span>unit</span>")
    assert marked == sum(bool(row.bracket) for row in units.rows()) > 0


def test_without_the_scenario_only_reported_places_are_known() -> None:
    walk = walk_of(run(), None)
    assert walk.source == "reports" and walk.plan is None and not walk.person
    assert len(walk.robot) > 20
    assert "Only the places that the robot reported" in make([run()])


@pytest.mark.parametrize("policy", ["prima", "fifo", "none", "prima+all"])
def test_the_scenario_gives_the_map_and_the_users_way(policy: str) -> None:
    made = run(policy)
    walk = walk_of(made, api.load_scenario(SCENARIO))
    assert walk.source == "run" and walk.plan and walk.person
    for time, x, y, _ in reported(made.run()):
        before = [pose for pose in walk.robot if pose[0] <= time + 1e-6][-1]
        assert max(abs(before[1] - x), abs(before[2] - y)) < 0.1
    assert walk.robot[0][0] == 0.0
    assert all(a[0] <= b[0] for a, b in pairwise(walk.robot))
    far = [dist(a[1:3], b[1:3]) for a, b in pairwise(walk.robot)]
    assert max(far) < 0.05, "where nothing is decided, bodies move on the page, too"


@pytest.mark.parametrize(
    "damage",
    [
        lambda records: records[30].update(time=records[30]["time"] + 0.001),
        lambda records: records.append(records[-1]),
        lambda records: records[0]["data"].update(policy="no-such"),
        lambda records: records[0]["data"].update(bound="much"),
    ],
)
def test_a_run_that_comes_out_otherwise_has_only_its_reports(
    damage: Callable[[Any], object],
) -> None:
    records = json.loads(json.dumps(run().records))
    damage(records)
    walk: RobotWalk = walk_of(api.Transcript(records, "x"), api.load_scenario(SCENARIO))
    assert walk.source == "reports" and walk.plan and not walk.person


def test_another_scenario_is_refused() -> None:
    other = api.load_scenario(SCENARIOS / "leaving-the-museum.xml")
    with pytest.raises(UsageError, match="is not a file of the run"):
        make([run()], [other])
    records = json.loads(json.dumps(run().records))
    records[0]["data"]["files"]["../fa/follow.xml"] = "0" * 64
    with pytest.raises(UsageError, match=r"follow\.xml has changed since"):
        make([api.Transcript(records, "x")], [api.load_scenario(SCENARIO)])
    records[0]["data"]["files"] = {}
    with pytest.raises(UsageError, match="x: the transcript does not name its files; leave out"):
        make([api.Transcript(records, "x")], [api.load_scenario(SCENARIO)])


def test_rules_are_those_of_the_page_on_transcripts() -> None:
    page = (ROOT / "docs" / "transcripts.md").read_text(encoding="utf-8")
    told = dict(re.findall(r"^\| ([A-Z]\d+[a-f]?|U4, U5) \| (.*?) \|$", page, re.MULTILINE))
    for names in list(told):
        for name in names.split(", "):
            told.setdefault(name, told[names])
    for rule, meaning in RULES.items():
        assert told[rule] == meaning, rule


def test_a_row_without_behaviour_has_no_reasons() -> None:
    from prima.transcript.why import reasons

    assert reasons(run().run(), Row(0.0, "U", "", "nods")) == []


# The command line -----------------------------------------------------------------------


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("desk")
    (made / "a.jsonl").write_text(run().dumps(), encoding="utf-8")
    (made / "b.jsonl").write_text(run("fifo").dumps(), encoding="utf-8")
    (made / "cut.jsonl").write_text(run().dumps()[:5000], encoding="utf-8")
    return made


def test_report_writes_a_page(folder: Path) -> None:
    done = prima("report", "a.jsonl", "--scenario", SCENARIO, "-o", "r.html", cwd=folder)
    assert (done.returncode, done.stdout) == (0, "")
    assert "r.html:" in done.stderr
    Outline((folder / "r.html").read_text(encoding="utf-8"))
    piped = prima("report", "a.jsonl", "--scenario", SCENARIO, cwd=folder)
    assert piped.stdout == (folder / "r.html").read_text(encoding="utf-8") and not piped.stderr


def test_a_scenario_is_run_and_reported_with_its_map(folder: Path) -> None:
    done = prima("report", SCENARIO, "-o", "run.html", cwd=folder)
    assert done.returncode == 0 and "run.html:" in done.stderr
    page = (folder / "run.html").read_text(encoding="utf-8")
    assert "Places as the simulation had them" in page


def test_scenarios_and_transcripts_are_compared_in_one_page(folder: Path) -> None:
    both = prima("report", SCENARIO, "--policy", "prima", "--policy", "fifo", cwd=folder)
    assert both.returncode == 0 and "Two runs compared" in both.stdout
    assert both.stdout.count("Places as the simulation had them") == 2
    mixed = prima("report", "b.jsonl", SCENARIO, cwd=folder)
    assert mixed.stdout.count("Places as the simulation had them") == 1
    known = prima("report", "b.jsonl", SCENARIO, "--scenario", SCENARIO, cwd=folder)
    assert known.stdout.count("Places as the simulation had them") == 2


def test_diff_writes_a_page(folder: Path) -> None:
    done = prima("diff", "a.jsonl", "b.jsonl", "--format", "html", "-o", "d.html", cwd=folder)
    assert done.returncode == 1 and "d.html:" in done.stderr
    same = prima("diff", "a.jsonl", "a.jsonl", "--format", "html", cwd=folder)
    assert same.returncode == 0 and same.stdout.startswith("<!DOCTYPE html>")


def test_a_run_that_fails_is_shown_and_told_as_by_run(tmp_path: Path) -> None:
    (tmp_path / "fails.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="fails" xml:lang="en">'
        '<form id="a"><block><throw event="error.semantic"/></block></form></prima>'
    )
    (tmp_path / "s.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" '
        f'world="{ROOT}/documents/worlds/room.xml" robot="{ROOT}/documents/robots/papero.xml">'
        '<application src="fails.xml"/><robot at="middle"/><person x="1" y="0"/></scenario>'
    )
    both = ["--policy", "prima", "--policy", "fifo"]
    for words in (
        ["run", "s.xml"],
        ["report", "s.xml", "-o", "r.html"],
        ["report", "s.xml", *both],
        ["diff", "s.xml", *both],
    ):
        done = prima(*words, cwd=tmp_path)
        assert done.returncode == 3, words
        assert done.stderr.count("prima: fails: error.semantic: fails.xml:1:") == 1, done.stderr
    assert (tmp_path / "r.html").exists()


def test_a_cut_transcript_is_reported_and_told(folder: Path) -> None:
    done = prima("report", "cut.jsonl", "-o", "c.html", cwd=folder)
    assert done.returncode == 2 and "the record is cut off" in done.stderr
    assert "is not whole" in (folder / "c.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "Name a scenario, or a transcript"),
        (["a.jsonl", "--policy", "fifo", "-o", "r.html"], "this is a transcript"),
        ([SCENARIO, "--policy", "fif", "-o", "r.html"], "fifo"),
        ([SCENARIO, "--scenario", SCENARIO, "-o", "r.html"], "has its own map"),
        ([SCENARIO, SCENARIO, "--policy", "fifo", "--policy", "none"], "These are 4 runs"),
        (["none.jsonl"], "No such file"),
        (["a.jsonl", "-o", "a.jsonl"], "write elsewhere"),
        (["a.jsonl", "-o", "nowhere/r.html"], "cannot be written"),
        (
            ["a.jsonl", "b.jsonl", "a.jsonl", "-o", "r.html"],
            "a report shows one run or compares two",
        ),
        (["a.jsonl", "--scenario", "a.jsonl", "-o", "r.html"], "a.jsonl:1:1"),
        (["a.jsonl", "--scenari", "x"], "--scenario"),
    ],
)
def test_wrong_usage_is_told(folder: Path, words: list[str], told: str) -> None:
    done = prima("report", *words, cwd=folder)
    assert done.returncode in (1, 2) and told in done.stderr + done.stdout
    assert "Traceback" not in done.stderr and "defect" not in done.stderr


def test_an_output_of_diff_needs_its_format(folder: Path) -> None:
    done = prima("diff", "a.jsonl", "b.jsonl", "-o", "d.html", cwd=folder)
    assert done.returncode == 2 and "--format html" in done.stderr
