"""Pictures of states can be read, by people and by programs."""

from __future__ import annotations

import json
import os
import random
import re
import subprocess
import sys
from itertools import combinations, pairwise
from pathlib import Path

import pytest
from lxml import etree

from prima.graph import FORMATS, cards, picture, run, states, text, treepicture
from prima.graph.layout import LayoutEdge, arrange, distances
from prima.graph.model import Graph, clean
from prima.graph.svg import SIZE, measure
from prima.transcript.run import run_of
from tests import ROOT
from tests.helpers.graphs import FLOW, SVG, app, drawn, generated, read_dot

DEMOS = sorted([*(ROOT / "documents/fa").iterdir(), *(ROOT / "documents/ea").iterdir()])


def boxes(root: etree._Element, kind: str) -> list[tuple[float, float, float, float]]:
    return [
        (float(r.get("x", "")), float(r.get("y", "")), float(r.get("width", "")), float(r.get("height", "")))
        for r in root.iter(f"{SVG}rect")
        if kind in (r.get("class") or "").split()
    ]  # fmt: skip


def texts(root: etree._Element) -> list[tuple[float, float, float, float, str]]:
    sizes = {"name": (13, True), "small": (10, False), "to": (SIZE, True), None: (SIZE, False)}
    found = []
    for one in root.iter(f"{SVG}text"):
        size, bold = sizes[one.get("class")]
        x, y, words = float(one.get("x", "")), float(one.get("y", "")), one.text or ""
        found.append((x, y - size * 0.78, measure(words, size, bold), size, words))
    return found


def points(path: str) -> list[tuple[float, float]]:
    """Points on a path of curves and level lines."""
    found: list[tuple[float, float]] = []
    x = y = 0.0
    for command, numbers in re.findall(r"([MLCHV])([^MLCHV]*)", path):
        values = [float(number) for number in numbers.split()]
        if command == "H":
            found += [(x + (values[0] - x) * t / 10, y) for t in range(11)]
            x = values[0]
        elif command == "C":
            x1, y1, x2, y2, x3, y3 = values
            for step in range(21):
                t, s = step / 20, 1 - step / 20
                found.append(
                    (s**3 * x + 3 * s * s * t * x1 + 3 * s * t * t * x2 + t**3 * x3,
                     s**3 * y + 3 * s * s * t * y1 + 3 * s * t * t * y2 + t**3 * y3)
                )  # fmt: skip
            x, y = x3, y3
        else:
            x, y = values
            found.append((x, y))
    return found


PICTURES = [*(str(path.relative_to(ROOT)) for path in DEMOS), "60", "60 chain", "marks"]


MARKED = (
    '<form id="a" stream="hold"><iu><block><speak>Oh.</speak></block></iu>'
    '<field name="x" type="text" channel="connect"><prompt>What?</prompt></field>'
    '<block cond="x"><topological-move to="lab"/></block></form>'
)
"""A state with every mark."""


@pytest.mark.parametrize("name", PICTURES)
def test_no_text_lies_on_another_and_no_line_crosses_a_card(name: str, tmp_path: Path) -> None:
    path = ROOT / name
    if name == "60":
        path = tmp_path / "app.xml"
        path.write_text(generated(60, 3), encoding="utf-8")
    elif name == "60 chain":
        path = tmp_path / "app.xml"
        forms = (
            f'<form id="s{n}"><block><goto next="#s{n + 1}"/></block><on event="touch">'
            f'<goto next="#s0"/></on></form>'
            for n in range(60)
        )
        path.write_text(app("".join(forms) + '<form id="s60"/>'), encoding="utf-8")
    elif name == "marks":
        path = tmp_path / "app.xml"
        path.write_text(app(MARKED.replace('"a"', '"b"') + MARKED), encoding="utf-8")
    root = etree.fromstring(picture(path).encode())
    marks = [mark for node in states(path).nodes.values() for mark in node.marks]
    assert len(boxes(root, "mark")) == len(marks)
    width, height = float(root.get("width", "")), float(root.get("height", ""))
    held, written = boxes(root, "box"), texts(root)
    assert len(held) == len(states(path).nodes)
    for (x, y, w, h), (x2, y2, w2, h2) in combinations(held, 2):
        assert x + w < x2 or x2 + w2 < x or y + h < y2 or y2 + h2 < y
    for x, y, w, h in held:
        assert x >= 0 and x + w <= width and y >= 0 and y + h <= height
        inside = [one for one in written if x <= one[0] <= x + w and y <= one[1] <= y + h]
        assert inside
        for a, b, c, d, words in inside:
            assert a + c <= x + w and b + d <= y + h + 1, words
        for one, two in combinations(inside, 2):
            apart = one[1] + one[3] <= two[1] + 3 or two[1] + two[3] <= one[1] + 3
            assert apart or one[0] + one[2] <= two[0] or two[0] + two[2] <= one[0], (one, two)
    for line in root.iter(f"{SVG}path"):
        if "edge" in (line.get("class") or ""):
            for px, py in points(line.get("d", "")):
                assert 0 <= px <= width and 0 <= py <= height
                assert not any(
                    x + 1 < px < x + w - 1 and y + 1 < py < y + h - 1 for x, y, w, h in held
                )


def test_every_edge_to_a_state_has_its_line_or_a_short_arrow(tmp_path: Path) -> None:
    for path in DEMOS:
        graph = states(path)
        root = etree.fromstring(picture(path).encode())
        lines = [p for p in root.iter(f"{SVG}path") if "edge" in (p.get("class") or "")]
        assert len(lines) == len([e for e in graph.edges if e.target and e.kind != "stay"]), path


def test_the_picture_has_a_name_a_description_and_two_colourings() -> None:
    root = etree.fromstring(picture(ROOT / "documents/fa/follow.xml").encode())
    assert root.findtext(f"{SVG}title") == "The states of follow"
    assert "ask (asks, faces the user) leads to search, sleep." in (
        root.findtext(f"{SVG}desc") or ""
    )
    assert "prefers-color-scheme: dark" in (root.findtext(f"{SVG}style") or "")


def test_what_no_way_leads_to_is_dimmed(tmp_path: Path) -> None:
    graph = drawn(tmp_path, app('<form id="a"/><form id="b"/>'))
    root = etree.fromstring(cards.draw(graph).encode())
    dim = [g for g in root.iter(f"{SVG}g") if "lost" in (g.get("class") or "")]
    assert [g.findtext(f"{SVG}text") for g in dim] == ["b"]
    assert 'color="gray60"' in text.dot(graph) and "class n2 lost" in text.mermaid(graph)


@pytest.mark.parametrize("seed", range(5))
def test_boxes_of_a_layer_never_touch(seed: int) -> None:
    chance = random.Random(seed)
    sizes = [float(chance.randrange(10, 200)) for _ in range(40)]
    follows = [[chance.randrange(40) for _ in range(2)] for _ in sizes]
    layers = distances(len(sizes), [0], follows)
    links = []
    for one, targets in enumerate(follows):
        for two in targets:
            low, high = sorted((one, two), key=lambda box: layers[box])
            if layers[low] < layers[high]:
                links.append(LayoutEdge(low, high, 5, 5))
    layout = arrange(sizes, layers, links, 12)
    for layer in range(max(layers) + 1):
        held = sorted((layout.aside[i], sizes[i]) for i, one in enumerate(layers) if one == layer)
        for (at, size), (after, _) in pairwise(held):
            assert at + size + 11.7 <= after
    assert min(layout.aside) == 0


def test_nothing_is_drawn_of_nothing() -> None:
    assert arrange([], [], [], 5).extent == 0
    empty = run.trees(run_of([]))
    assert "Nothing is in working memory." in treepicture.draw(empty)


NASTY = (
    '</text><script>alert(1)</script>"\\N \\" ]] --> | %% {{x}} #quot; &amp; `b` \u202e 1. - * \x7f'
)


def nasty() -> Graph:
    graph = Graph("The states of " + clean(NASTY))
    node = graph.node("a\n\"'>", NASTY, start=True)
    node.marks, node.notes = [clean(NASTY)], [clean(NASTY)]
    graph.node("end", "end")
    graph.edge("a\n\"'>", "end", "go", NASTY)
    graph.edge("end", "", "computed", NASTY, NASTY)
    return graph


def test_strangers_names_are_escaped_in_svg() -> None:
    root = etree.fromstring(cards.draw(nasty()).encode())
    assert {str(one.tag).removeprefix(SVG) for one in root.iter()} <= {
        "svg", "title", "desc", "style", "g", "rect", "text", "path",
    }  # fmt: skip
    assert not any(str(name).startswith("on") for one in root.iter() for name in one.attrib)
    assert "\u202e" not in cards.draw(nasty()) and "\x7f" not in cards.draw(nasty())


def test_strangers_names_are_escaped_in_dot() -> None:
    graph = read_dot(text.dot(nasty()))
    node = graph.get_node("n1")[0]
    label = node.get("label")
    assert label.startswith('"') and label.endswith('"')
    shown = re.sub(r"\\(.)", lambda m: {"n": "\n"}.get(m[1], m[1]), label[1:-1])
    assert shown.replace("&amp;", "&").split("\n")[0] == clean(NASTY)
    assert len(graph.get_edges()) == 3


QUOTED = re.compile(r"""(?:[^\W_]|[ ,?!'/=]|#\d+;|<br/>|</?b>)*""")


@pytest.mark.parametrize("path", [*DEMOS, None], ids=lambda path: path.stem if path else "nasty")
def test_mermaid_is_made_of_the_lines_of_a_flowchart(path: Path | None) -> None:
    made = text.mermaid(states(path) if path else nasty())
    for line in made.splitlines():
        assert any(re.fullmatch(kind, line.strip()) for kind in FLOW), line
        if not line.startswith("title"):
            assert all(QUOTED.fullmatch(words) for words in re.findall('"([^"]*)"', line)), line


@pytest.mark.parametrize("path", DEMOS, ids=lambda path: path.stem)
def test_dot_and_json_have_the_same_states_and_ways(path: Path) -> None:
    graph = states(path)
    read = read_dot(picture(path, "dot"))
    made = json.loads(picture(path, "json"))
    assert len([n for n in read.get_nodes() if re.match(r"n\d", n.get_name())]) == len(graph.nodes)
    assert len(read.get_edges()) == len(graph.edges) + 1
    assert [node["name"] for node in made["nodes"]] == [n.title for n in graph.nodes.values()]
    assert len(made["edges"]) == len(graph.edges)


def test_the_same_file_gives_the_same_bytes() -> None:
    """In all formats, in processes that order sets otherwise."""
    path = str(ROOT / "documents/ea/library.xml")
    code = (
        f"from prima.graph import picture\nfor to in {list(FORMATS)}: print(picture({path!r}, to))"
    )
    made = "".join(f"{picture(path, to)}\n" for to in FORMATS).encode()
    for seed in ("1", "2"):
        done = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONIOENCODING": "utf-8"},
            cwd=ROOT,
        )
        assert done.stdout == made


def test_a_letter_with_its_accent_apart_is_as_wide_as_without() -> None:
    assert measure("cafe\u0301") == measure("cafe")


def test_a_long_name_is_broken_at_a_joint() -> None:
    from prima.graph.svg import wrap

    name = "error.unsupported.point-by-hand"
    assert wrap(name, 170, 3) == ["error.unsupported.point-", "by-hand"]
    assert "".join(wrap("x" * 60, 170, 9)) == "x" * 60
