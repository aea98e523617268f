"""prima graph: what the pictures tell is so, and they can be read, by people and by programs."""

from __future__ import annotations

import json
import os
import random
import re
import subprocess
import sys
from collections import Counter
from functools import lru_cache
from itertools import combinations, pairwise
from pathlib import Path

import pydot
import pytest
from lxml import etree

from prima import api
from prima.errors import DocumentError, UsageError
from prima.graph import FORMATS, cards, picture, run, states, text, treepicture
from prima.graph.labels import condition, ordinal
from prima.graph.layout import Link, arrange, distances
from prima.graph.model import Edge, Graph, Node, clean
from prima.graph.svg import SIZE, measure
from prima.messages import Command, Record
from prima.scheduler.policy import policy_named
from prima.sim.rehearsal import Rehearsal
from prima.transcript.colours import colours
from prima.transcript.lines import finished
from prima.transcript.run import run_of
from prima.transcript.spans import base
from tests.stage import Stage, say

ROOT = Path(__file__).parent.parent
DEMOS = sorted([*(ROOT / "documents/fa").iterdir(), *(ROOT / "documents/ea").iterdir()])
SVG = "{http://www.w3.org/2000/svg}"


def app(body: str, more: str = "") -> str:
    return (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app" xml:lang="en">'
        f"{body}{more}</prima>"
    )


def vxml(body: str, more: str = "") -> str:
    return f'<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en" {more}>{body}</vxml>'


def drawn(folder: Path, body: str, name: str = "app.xml") -> Graph:
    path = folder / name
    path.write_text(body, encoding="utf-8")
    return states(path)


def ways(graph: Graph, title: str) -> dict[str, list[str]]:
    """Where a state leads, with the reasons."""
    node = named(graph, title)
    return {
        (graph.nodes[e.target].title if e.target else e.words)
        + (
            ""
            if e.kind in ("go", "exit", "return", "computed", "outside", "missing")
            else f" {e.kind}"
        ): e.labels
        for e in graph.out(node.key)
    }


def named(graph: Graph, title: str) -> Node:
    [node] = [node for node in graph.nodes.values() if node.title == title]
    return node


def read_dot(made: str) -> pydot.Dot:
    """DOT as another program reads it."""
    [graph] = pydot.graph_from_dot_data(made) or []
    return graph


@lru_cache
def transcript(scenario: str, policy: str = "prima") -> api.Transcript:
    return api.rehearse(ROOT / "documents" / scenario, policy)


# States ------------------------------------------------------------------------------------


def test_the_museum_guide_leads_where_its_document_says() -> None:
    graph = states(ROOT / "documents/ea/museum.xml")
    assert len(graph.nodes) == 8
    assert ways(graph, "welcome") == {"go": ["then"]}
    assert ways(graph, "explain") == {
        "find call": ["subdialog first", "subdialog second"],
        "explain": ["repeat answered yes"],
        "over": ["repeat answered no, if at === panels.length - 1"],
        "stay": ["next answered no", "noinput, 3rd time"],
        "go": ["next answered yes"],
        "alone": ["gone"],
        "skip": ["error.device.localization"],
    }
    assert ways(graph, "find") == {
        "explain back": ["then", "gone (after 80 s), throws gone"],
    }
    assert ways(graph, "over") == {"ends the application": ["then"]}
    assert named(graph, "go").marks == ["leaves the user"]
    assert "sleeps" in named(graph, "stay").marks


def test_conditions_counts_delays_watches_and_links_are_the_labels(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        app(
            '<form id="a"><field name="size"><prompt>How big?</prompt><option>big</option>'
            "<option>small</option><filled>"
            """<if cond="size == 'big'"><goto next="#b"/><elseif cond="size === &quot;small&quot;"/>"""
            '<goto next="#c"/></if><if cond="!ok"><exit/></if><goto next="#a"/></filled>'
            '<noinput count="2" cond="ok"><goto next="#c"/></noinput></field>'
            '<block cond="ok"><send event="late" delay="1.5s"/></block>'
            '<on event="late touch"><goto next="#b"/></on><var name="ok"/>'
            '<watch name="near" when="sensor.human.distance &lt; 1"/>'
            '<on event="near"><exit/></on></form>'
            '<form id="b"/><form id="c"><link next="#a"><grammar><one-of><item>stop'
            "</item><item>no <tag>x</tag></item></one-of></grammar></link></form>"
        ),
    )
    assert ways(graph, "a") == {
        "b": ['answered "big"', "late (after 1.5 s), touch"],
        "c": ['answered "small"', "noinput, 2nd time, if ok"],
        "ends the application": [
            "answered, otherwise, if !ok",
            "near (sensor.human.distance < 1)",
        ],
        "a": ["answered, otherwise, otherwise"],
    }
    assert ways(graph, "c") == {"a": ['said "stop" or "no"']}
    assert named(graph, "a").notes == ['asks "How big?"']
    assert named(graph, "a").marks == ["asks"] and named(graph, "b").marks == ["sleeps"]


def test_marks_tell_of_sleeping_units_holding_and_facing(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        app(
            '<form id="a" stream="hold"><block><iu><speak>Hm.</speak></iu><goto next="#b"/></block></form>'
            '<form id="b"><iu><block><speak>Oh.</speak></block></iu><field name="x" type="text"'
            ' channel="connect"><prompt>What?</prompt></field></form>'
            '<form id="c"><block><if cond="1"><goto next="#a"/><else/><exit/></if></block></form>'
            '<form id="d"><block cond="1"><exit/></block><block><goto nextitem="x"/></block>'
            '<block name="x"><topological-move to="lab"/></block></form>'
        ),
    )
    assert named(graph, "a").marks == ["unit", "holds its stream"]
    assert named(graph, "b").marks == ["asks", "sleeps", "unit", "faces the user"]
    assert named(graph, "c").marks == ["never reached"]
    assert named(graph, "d").marks == ["sleeps", "leaves the user", "never reached"]
    assert named(graph, "d").notes == ["Topological Move to lab"]


def test_a_reaction_that_stays_in_the_state_is_told(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        app(
            '<form id="a"><on event="touch.head" cond="x"><speak>Hm.</speak></on><on event="b"/>'
            '<on event="c"><throw event="d"/></on><field name="q" type="text"><prompt>?</prompt>'
            "<noinput><reprompt/></noinput></field></form>",
            '<var name="x"/>',
        ),
    )
    assert ways(graph, "a") == {
        "a stay": ["touch.head, if x"],
        "ends the application": ["c, throws d"],
    }
    assert "stays" in cards.draw(graph) and "n1 -.->" in text.mermaid(graph)
    voice = drawn(
        tmp_path,
        vxml(
            '<form id="a"><catch event="touch">Hm.</catch><catch event="noinput">?</catch></form>'
        ),
        "a.vxml",
    )
    assert ways(voice, "a") == {"a stay": ["touch"], "ends the application": ["at its end"]}


def test_a_throw_leads_where_its_handler_goes(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        app(
            '<on event="far"><goto next="#c"/></on>'
            '<form id="a"><field name="size" type="number"><prompt>?</prompt><filled>'
            '<if cond="size &gt; 9"><throw event="big.one"/><else/><throw event="far"/></if>'
            '</filled><on event="big"><goto next="#b"/></on></field>'
            '<on event="big"><goto next="#c"/></on></form>'
            '<form id="b"><block><throw event="big"/></block><on event="big" count="2">'
            '<goto next="#a"/></on><on event="big" cond="x"><throw event="far"/></on></form>'
            '<form id="c"><on event="touch"><throw event="t"/></on>'
            '<on event="t"><speak>Hm.</speak></on></form>',
            '<var name="x"/>',
        ),
    )
    assert "answered, if size > 9, throws big.one" in ways(graph, "a")["b"]
    assert not any("throws big.one" in told for told in ways(graph, "a")["c"]), "the item's first"
    assert "answered, otherwise, throws far" in ways(graph, "a")["c"], "the document's"
    assert "then, throws big, 2nd time" in ways(graph, "b")["a"]
    assert "then, throws big, if x, throws far" in ways(graph, "b")["c"]
    assert ways(graph, "b")["ends the application"] == ["then, throws big"], "before the 2nd time"
    assert "touch, throws t" in ways(graph, "c")["c stay"]


def test_a_throw_in_voicexml_leads_where_its_handler_goes(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        vxml(
            '<catch event="far"><goto next="#c"/></catch><error><throw event="inner"/></error>'
            '<form id="a"><field name="q" type="boolean"><prompt>?</prompt><filled><if cond="q">'
            '<throw event="big.one"/><else/><throw event="far"/></if></filled>'
            '<catch event="big"><goto next="#b"/></catch></field></form>'
            '<form id="b"><block><throw event="odd"/></block><catch event="inner">'
            '<goto next="#a"/></catch></form>'
            '<form id="c"><block><throw event="help"/><throw event="odd"/></block>'
            "<catch>Hm.</catch></form>"
        ),
        "a.vxml",
    )
    assert "answered yes, throws big.one" in ways(graph, "a")["b"]
    assert "answered no, throws far" in ways(graph, "a")["c"]
    assert "then, throws odd" in ways(graph, "b")["ends the application"]
    assert "error, throws inner" in ways(graph, "b")["a"], "a dialog takes what its document throws"
    assert "then, throws help" in ways(graph, "c")["c stay"], "a general catch takes it"


def test_throws_that_go_round_end(tmp_path: Path) -> None:
    names = [f"e{number}" for number in range(12)]
    ways_on = "".join(f'<if cond="x"><throw event="{name}"/></if>' for name in names)
    handlers = "".join(f'<on event="{name}">{ways_on}</on>' for name in names)
    body = f'<form id="a"><block><throw event="e0"/></block>{handlers}</form>'
    graph = drawn(tmp_path, app(body, '<var name="x"/>'))
    assert ways(graph, "a") == {}


def test_what_holds_everywhere_is_one_card_and_reaches_its_targets(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        app('<form id="a"/><form id="b"/>', '<on event="touch"><goto next="#b"/></on>'),
    )
    assert ways(graph, "in any state") == {"b": ["touch"]}
    assert all(node.reached for node in graph.nodes.values())


def test_a_computed_target_leads_to_the_names_it_holds_and_leaves_others_open(
    tmp_path: Path,
) -> None:
    graph = drawn(
        tmp_path,
        app(
            """<form id="a"><block><goto next-expr="x ? 'b' : where()"/></block></form>"""
            '<form id="b"/><form id="c"/>',
            "<script>var x = 1; function where() { return 'c'; }</script>",
        ),
    )
    assert ways(graph, "a") == {
        "b guess": ["then"],
        "to a computed target x ? 'b' : where()": ["then"],
    }
    assert named(graph, "c").reached and named(graph, "c").marks == ["sleeps", "only if computed"]


def test_a_return_leads_to_all_that_call_a_way_to_it(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        app(
            '<form id="a"><subdialog name="s" src="#q"><filled><goto next="#b"/></filled></subdialog></form>'
            '<form id="b"><subdialog name="t" src="#q"/></form>'
            '<form id="q"><block><goto next="#r"/></block></form>'
            '<form id="r"><block><return/></block></form>'
            '<form id="z"><block><return/></block></form>'
        ),
    )
    assert ways(graph, "r") == {"a back": ["then"], "b back": ["then"]}
    assert ways(graph, "z") == {"returns": ["then"]}
    assert ways(graph, "a") == {"q call": ["subdialog s"], "b": ["s has returned"]}


@pytest.mark.parametrize(
    ("code", "name", "truth", "told"),
    [
        ("sure", "sure", True, "yes"),
        ("!sure", "sure", True, "no"),
        ("sure === false", "sure", True, "no"),
        ("!sure == false", "sure", True, "yes"),
        ("sure", "sure", False, "if sure"),
        ("dialog.x == 'a'", "x", False, '"a"'),
        ("x == 'a' || y", "x", False, "if x == 'a' || y"),
        ("y == 'a'", "x", False, "if y == 'a'"),
    ],
)
def test_a_condition_on_the_answer_is_told_as_the_answer(
    code: str, name: str, truth: bool, told: str
) -> None:
    assert condition(code, name, truth) == told


def test_ordinals() -> None:
    assert [ordinal(n) for n in (1, 2, 3, 4, 11, 12, 21, 112)] == [
        "1st", "2nd", "3rd", "4th", "11th", "12th", "21st", "112th",
    ]  # fmt: skip


# VoiceXML ------------------------------------------------------------------------------------


def test_what_commands_of_voicexml_say_is_shown(tmp_path: Path) -> None:
    par = '<p:par><p:speak>One <value expr="n"/>.</p:speak><p:gesture name="nod"/></p:par>'
    said = f"<form><block>{par}<p:speak>Two.</p:speak></block></form>"
    graph = drawn(tmp_path, vxml(said, 'xmlns:p="urn:prima:dialogue:1"'), "a.vxml")
    assert graph.nodes[next(iter(graph.nodes))].notes == ['says "One {n}. Two."']


def test_a_unit_around_items_of_voicexml_is_looked_into(tmp_path: Path) -> None:
    inner = (
        '<field name="x" type="boolean"><prompt>Well?</prompt>'
        '<filled><goto next="#b"/></filled></field>'
        '<catch event="touch"><goto next="#c"/></catch>'
    )
    rest = '<form id="b"><block>So.</block></form><form id="c"><block>Oh.</block></form>'
    body = f'<form id="a"><p:iu>{inner}</p:iu></form>{rest}'
    graph = drawn(tmp_path, vxml(body, 'xmlns:p="urn:prima:dialogue:1"'), "a.vxml")
    box = graph.nodes["a.vxml#a"]
    assert box.marks == ["asks", "unit"] and box.notes == ['asks "Well?"']
    ways = {(edge.target, label) for edge in graph.out("a.vxml#a") for label in edge.labels}
    assert ways >= {
        ("a.vxml#b", "answered"),
        ("a.vxml#c", "touch"),
    }


def test_voicexml_menus_links_submits_and_ends(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        vxml(
            '<link event="cancel"><grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">'
            '<rule id="r">forget it</rule></grammar></link>'
            '<catch event="cancel"><disconnect/></catch>'
            '<menu id="main" dtmf="true"><prompt>Which <enumerate/>?</prompt>'
            '<choice next="#poster">the poster</choice><choice expr="x">others</choice>'
            '<choice event="help" dtmf="0">help</choice></menu>'
            '<form id="poster"><field name="ok" type="boolean"><prompt>O.K.?</prompt><filled>'
            '<if cond="ok"><submit next="http://h.example/x" namelist="ok"/><else/>'
            '<submit next="service:s#last"/></if></filled></field></form>'
            '<form id="last"><block>Bye.</block><transfer dest="tel:1" type="blind"/></form>'
            '<form id="sub"><subdialog name="d" src="#last"/><block><goto next="gone.vxml"/></block></form>'
        ),
        "a.vxml",
    )
    assert ways(graph, "main") == {
        "poster": ['said "the poster" or key 1'],
        "to a computed target x": ['said "others" or key 2'],
    }
    assert ways(graph, "poster") == {
        "goes to http://h.example/x": ["answered yes, submits ok"],
        "last": ["answered no, submits, asks service:s"],
    }
    assert ways(graph, "last") == {"ends the application": ["the call is passed on", "at its end"]}
    assert ways(graph, "sub") == {
        "last call": ["subdialog d"],
        "goes to a missing target: gone.vxml": ["then"],
    }
    assert ways(graph, "in any state") == {
        "ends the application": ['cancel (said "forget it"), hangs up']
    }
    assert named(graph, "main").notes == ['asks "Which ...?"']
    assert "only if computed" in named(graph, "sub").marks


def test_the_documents_of_an_application_are_drawn_together(tmp_path: Path) -> None:
    (tmp_path / "root.vxml").write_text(
        vxml(
            '<link next="leaf.vxml#b"><grammar version="1.0" root="r"'
            ' xmlns="http://www.w3.org/2001/06/grammar"><rule id="r">b</rule></grammar></link>'
            '<form id="r"><block><exit/></block></form>'
        ),
        encoding="utf-8",
    )
    (tmp_path / "next.vxml").write_text(
        vxml('<form><block><goto next="leaf.vxml"/></block></form>'), encoding="utf-8"
    )
    graph = drawn(
        tmp_path,
        vxml(
            '<form id="a"><block><goto next="next.vxml"/></block></form><form id="b"/>'
            '<form id="c"><block><goto next="../out.vxml"/></block></form>',
            'application="root.vxml"',
        ),
        "leaf.vxml",
    )
    assert ways(graph, "a") == {"next.vxml#form 1": ["then"]}
    assert ways(graph, "next.vxml#form 1") == {"a": ["then"]}
    assert ways(graph, "in any state of root.vxml and its leaf documents") == {"b": ['said "b"']}
    assert named(graph, "b").reached and not named(graph, "root.vxml#r").reached
    assert ways(graph, "c") == {"goes to a missing target: ../out.vxml": ["then"]}


# The picture ---------------------------------------------------------------------------------


def generated(count: int, seed: int) -> str:
    """An application of many states that lead here and there."""
    chance = random.Random(seed)
    forms = []
    for number in range(count):
        to = [chance.randrange(count), chance.randrange(count), (number + 1) % count]
        forms.append(
            f'<form id="state-{number}"><field name="more" type="boolean"><prompt>Is this number'
            f' {number}, or do you want to hear more?</prompt><filled><if cond="more">'
            f'<goto next="#state-{to[0]}"/><else/><goto next="#state-{to[1]}"/></if></filled></field>'
            f'<on event="touch.{number}"><goto next="#state-{to[2]}"/></on></form>'
        )
    return app("".join(forms))


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


PICTURES = [*(str(path.relative_to(ROOT)) for path in DEMOS), "60", "60 chain"]


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
    root = etree.fromstring(picture(path).encode())
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
                links.append(Link(low, high, 5, 5))
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


# Strangers' names ------------------------------------------------------------------------------

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


FLOW = [
    r"---", r'title: "[^\n]*"', r"flowchart (LR|TB)",
    r'n\d+\["[^"]*"\]', r'start\(\("start"\)\)', r'out\d+(\(\(\("[^"]*"\)\)\)|>"[^"]*"\])',
    r'(n\d+|start) (-->|-\.->)(\|"[^"]*"\|)? (n|out)\d+',
    r'subgraph g\d+\["[^"]*"\]', r"end",
    r"classDef \w+ [\w:.#, -]+", r"class n\d+(,n\d+)* \w+",
]  # fmt: skip
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
    path = ROOT / "documents/ea/library.xml"
    for to in FORMATS:
        made = {
            subprocess.run(
                [sys.executable, "-m", "prima", "graph", str(path), "--to", to],
                capture_output=True,
                check=True,
                env={**os.environ, "PYTHONHASHSEED": seed},
            ).stdout
            for seed in ("1", "2")
        }
        assert made == {picture(path, to).encode()}


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

# Runs ----------------------------------------------------------------------------------------


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


def test_all_scenarios_can_be_drawn() -> None:
    for path in sorted((ROOT / "documents/scenarios").glob("*.xml")):
        told = api.rehearse(path).run()
        for moment in (told.entries[len(told.entries) // 2].time, run.NEVER):
            graph = run.trees(told, moment)
            made = treepicture.draw(graph)
            etree.fromstring(made.encode())


# The map of a world ---------------------------------------------------------------------------

WORLD = '<world xmlns="urn:prima:world:1" version="1.0" id="w">{}</world>'
WORLDS = sorted((ROOT / "documents/worlds").iterdir())


def test_a_map_shows_all_that_a_world_has() -> None:
    path = ROOT / "documents/worlds/office.xml"
    root = etree.fromstring(picture(path).encode())
    counts = Counter(str(one.get("class")) for one in root.iter(f"{SVG}circle", f"{SVG}path"))
    assert counts["place"] == 5 + 1, "and one in the legend"
    assert (counts["way"], counts["wall"], counts["corner"]) == (4 + 1, 8 + 1, 1 + 1)
    assert len([one for one in root.iter(f"{SVG}rect") if one.get("class") == "thing"]) == 1 + 1
    written = {one.text for one in root.iter(f"{SVG}text")}
    names = {"entrance", "hall", "crossing", "kidode-room", "lab", "poster", "crossing-corner"}
    assert names | {"the office", "1 m"} <= written
    told = root.findtext(f"{SVG}desc") or ""
    for words in (
        "entrance to hall",
        "poster at 5.9, 4",
        "crossing-corner within 0.8 m",
        "8 walls",
    ):
        assert words in told


def test_an_area_has_the_colour_of_its_application() -> None:
    shade = colours(transcript("scenarios/follow-during-navigation.xml").run().apps)["navigate"]
    assert f'class="s{shade} area"' in picture(ROOT / "documents/worlds/office.xml")


@pytest.mark.parametrize("path", WORLDS, ids=lambda path: path.stem)
def test_no_name_of_a_map_lies_on_another(path: Path) -> None:
    root = etree.fromstring(picture(path).encode())
    found = []
    for one in root.iter(f"{SVG}text"):
        wide = measure(one.text or "", *((13, True) if one.get("class") == "name" else ()))
        x, y = float(one.get("x", "")), float(one.get("y", ""))
        found.append((x, y - 9, x + wide, y + 2, one.text))
    for a, b in combinations(found, 2):
        apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
        assert apart, (a, b)
    assert all(x >= 0 and right <= float(root.get("width", "")) for x, _, right, _, _ in found)


def test_a_map_in_all_formats() -> None:
    path = ROOT / "documents/worlds/office.xml"
    made = json.loads(picture(path, "json", "map"))
    assert made["places"][0] == {"id": "entrance", "x": 0.0, "y": 0.0}
    assert made["corners"][0]["radius"] == 0.8 and made["areas"][0]["title"] == "the office"
    read = read_dot(picture(path, "dot"))
    assert read.get_type() == "graph" and len(read.get_edges()) == len(made["ways"]) == 4
    lines = picture(path, "mermaid").splitlines()
    assert lines[3] == "flowchart LR" and "  n1 --- n2" in lines
    assert '  n4["kidode#45;room"]' in lines


def test_names_of_a_map_are_escaped_and_a_world_may_be_empty(tmp_path: Path) -> None:
    path = tmp_path / "w.xml"
    path.write_text(WORLD.format(""))
    assert etree.fromstring(picture(path).encode()).findtext(f"{SVG}title") == "The map of w"
    title = "&lt;script>alert(1)&lt;/script>&#x202e;"
    area = f'<area id="a" title="{title}" application="x.xml" x1="0" y1="0" x2="2" y2="2"/>'
    path.write_text(WORLD.format(area), encoding="utf-8")
    made = picture(path)
    assert "<script" not in made and "\u202e" not in made


def test_a_wrong_world_is_told_as_by_validate_and_too_many_marks_are_refused(
    tmp_path: Path,
) -> None:
    path = tmp_path / "w.xml"
    path.write_text(WORLD.format('<way from="a" to="b"/>'))
    code, _, told = prima(tmp_path, "w.xml", "-o", "w.svg")
    assert code == 1 and "w.xml:1:" in told and 'There is no place "a".' in told
    path.write_text(WORLD.format("".join(f'<place id="p{n}" x="{n}" y="0"/>' for n in range(301))))
    code, _, told = prima(tmp_path, "w.xml", "-o", "w.svg")
    assert code == 2 and "301 places, things and corners are too many" in told
    assert picture(path, "dot").count("pos=") == 301


# The command --------------------------------------------------------------------------------


def prima(folder: Path, *words: str) -> tuple[int, str, str]:
    done = subprocess.run(
        [sys.executable, "-m", "prima", "graph", *words],
        cwd=folder,
        capture_output=True,
        encoding="utf-8",
    )
    assert "Traceback" not in done.stderr and "defect" not in done.stderr, done.stderr
    return done.returncode, done.stdout, done.stderr


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
    (["."], "it is not a file"),
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
    (["t.jsonl", "--row", "9999"], "There is no row 9999; the rows are 0 to"),
    (["t.jsonl", "--what", "streams", "--row", "1"], "--row works only with --what tree"),
    (["app.xml", "-o", "app.xml", "--to", "dot"], "the picture is made from this file"),
    (["app.xml", "-o", "no/where.svg"], "cannot be written"),
    (["cut.jsonl"], "cut.jsonl:4"),
    (["json.json"], "not a transcript"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("graph")
    dumped = transcript("scenarios/touched-on-the-way.xml").dumps()
    files = {
        "empty.xml": "",
        "text.txt": "hello",
        "app.xml": app('<form id="a"/>'),
        "world.xml": (ROOT / "documents/worlds/room.xml").read_text(encoding="utf-8"),
        "robot.xml": (ROOT / "documents/robots/papero.xml").read_text(encoding="utf-8"),
        "scenario.xml": (ROOT / "documents/scenarios/dance-alone.xml").read_text(encoding="utf-8"),
        "grammar.grxml": '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"/>',
        "t.jsonl": dumped,
        "cut.jsonl": "\n".join(dumped.splitlines()[:3]) + '\n{"time": 1, "pha',
        "json.json": '{"a": 1}',
    }
    for name, content in files.items():
        (made / name).write_text(content, encoding="utf-8")
    return made


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


def test_a_long_name_is_broken_at_a_joint() -> None:
    from prima.graph.svg import wrap

    name = "error.unsupported.point-by-hand"
    assert wrap(name, 170, 3) == ["error.unsupported.point-", "by-hand"]
    assert "".join(wrap("x" * 60, 170, 9)) == "x" * 60
