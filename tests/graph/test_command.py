"""prima graph: formats, wrong usage and limits."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from prima.errors import DocumentError, UsageError
from prima.graph import FORMATS, picture, states
from prima.graph.model import Edge, Graph
from tests import ROOT
from tests.helpers.graphs import app, generated, prima


def test_the_suffix_tells_the_format(tmp_path: Path) -> None:
    path = str(ROOT / "documents/fa/dance.xml")
    for name, begin in (("a.svg", "<svg"), ("a.gv", "digraph"), ("a.mmd", "---"), ("a.json", "{")):
        code, _, told = prima(tmp_path, path, "-o", name)
        assert (code, told) == (0, f"written: {name}\n")
        assert (tmp_path / name).read_text(encoding="utf-8").startswith(begin)
    code, _, told = prima(tmp_path, path, "-o", "a.png")
    assert code == 2 and "--to svg, dot, mermaid or json" in told


WRONG = [
    (["none.xml"], "none.xml: cannot be read: No such file"),
    (["."], "it is a folder. Name a file in it."),
    (["empty.xml"], "the file is empty"),
    (["text.txt"], "text.txt:1:"),
    (["world.xml", "--what", "states"], "this is a world, which has no states"),
    (["world.xml", "--row", "1"], "--row needs a transcript"),
    (["app.xml", "--what", "map"], "--what map needs a world"),
    (["t.jsonl", "--what", "map"], "which has no map"),
    (["robot.xml"], "an application, a transcript or a world"),
    (["scenario.xml"], "prima run scenario.xml -o FILE.jsonl"),
    (["grammar.grxml"], "this is a grammar"),
    (["app.xml", "--to", "sgv"], 'Did you mean "svg"?'),
    (["app.xml", "--what", "stream"], 'Did you mean "streams"?'),
    (["app.xml", "--what", "streams"], "--what streams needs a transcript"),
    (["app.xml", "--row", "3"], "--row needs a transcript"),
    (["t.jsonl", "--what", "states"], "has no states"),
    (["t.jsonl", "--row", "9999"], "t.jsonl: there is no row 9999; the rows are 0 to"),
    (["t.jsonl", "--what", "streams", "--row", "1"], "--row works only with --what tree"),
    (["app.xml", "-o", "app.xml", "--to", "dot"], "the picture is made from this file"),
    (["app.xml", "-o", "no/where.svg"], "cannot be written"),
    (["cut.jsonl"], "cut.jsonl:4"),
    (["json.json"], "not a transcript"),
]


@pytest.mark.parametrize(
    ("words", "told"), WRONG, ids=lambda one: " ".join(one) if isinstance(one, list) else ""
)
def test_what_is_wrong_is_said_with_its_remedy(folder: Path, words: list[str], told: str) -> None:
    code, _, errors = prima(folder, *words)
    assert told in errors and code == (1 if words == ["text.txt"] else 2)


def test_a_document_with_errors_is_told_as_by_validate(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(app('<form id="a"><block><goto next="#b"/></block></form>'))
    code, out, told = prima(tmp_path, "a.xml")
    assert code == 1 and out == "" and "a.xml:1:" in told
    with pytest.raises(DocumentError):
        states(tmp_path / "a.xml")


def test_a_transcript_with_strange_records_is_refused_or_drawn(tmp_path: Path) -> None:
    strange: list[dict[str, object]] = [
        {"phase": "request", "behavior": "x#1", "command": "q", "app": "x", "priority": "high", "parent": "x#1", "tree": "x:1"},
        {"phase": "start", "behavior": "y#1", "command": "speak", "app": "y"},
        {"phase": "suspend"}, {"phase": "resume", "tree": "none:1"}, {"phase": "stream-end", "tree": "y:1"},
        {"phase": "request", "behavior": "z#1", "command": "", "app": "", "priority": "high", "tree": "z:1", "parents": ["z#2"]},
        {"phase": "request", "behavior": "z#2", "command": "", "app": "", "priority": "high", "tree": "z:1", "parents": ["z#1"], "unit": "z#2"},
        {"phase": "send"}, {"phase": "fail"}, {"phase": "collision", "behavior": "z#1"},
    ]  # fmt: skip
    for keep in range(1, len(strange) + 1):
        path = tmp_path / "t.jsonl"
        rows = [{"time": 0.5, "actor": "robot", **record} for record in strange[:keep]]
        path.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
        for what in ("tree", "streams"):
            for to in FORMATS:
                try:
                    picture(path, to, what)
                except UsageError as error:
                    assert re.search("lacks a field of its phase| needs ", str(error))


def test_too_many_states_are_refused_as_svg_and_taken_as_dot(tmp_path: Path) -> None:
    path = tmp_path / "app.xml"
    path.write_text(generated(301, 1), encoding="utf-8")
    with pytest.raises(UsageError, match=r"301 boxes are too many: .* --to dot"):
        picture(path)
    assert picture(path, "dot").count("state-") >= 301
    path.write_text(generated(2000, 1), encoding="utf-8")
    with pytest.raises(UsageError, match="more than 4000 ways"):
        picture(path, "dot")


def test_an_edge_tells_only_some_of_very_many_reasons() -> None:
    graph = Graph("x")
    graph.node("a", "a")
    for number in range(1000):
        graph.edge("a", "a", "go", f"event-{number}")
    assert graph.edges == [Edge("a", "a", "go", [*(f"event-{n}" for n in range(11)), "and more"])]


def test_help_shows_an_example() -> None:
    code, out, _ = prima(ROOT, "--help")
    assert code == 0 and "prima graph mediated.jsonl --what streams -o streams.svg" in out
