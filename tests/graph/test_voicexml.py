"""The graph of a VoiceXML application."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from prima.graph import text
from tests.helpers.graphs import drawn, named, vxml, ways


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


def test_json_names_what_an_edge_leads_to_out_of_the_picture(tmp_path: Path) -> None:
    graph = drawn(
        tmp_path,
        vxml(
            '<form id="a"><block><if cond="x"><goto expr="y"/><elseif cond="y"/>'
            '<goto next="http://h.example/x"/><elseif cond="z"/><goto next="gone.vxml"/>'
            '<elseif cond="w"/><exit/></if><goto next="#b"/></block></form><form id="b"/>'
        ),
        "a.vxml",
    )
    edges = json.loads(text.data(graph))["edges"]
    assert all({*edge} - {"where"} == {"from", "to", "kind", "labels"} for edge in edges)
    assert {edge["kind"]: edge.get("where") for edge in edges} == {
        "computed": "y",
        "outside": "http://h.example/x",
        "missing": "gone.vxml",
        "exit": None,
        "go": None,
    }


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


def test_what_fills_an_item_of_voicexml_leads_on(tmp_path: Path) -> None:
    to = '<filled><goto next="#{}"/></filled>'.format
    graph = drawn(
        tmp_path,
        vxml(
            f'<form id="a"><subdialog name="s" src="#d">{to("b")}</subdialog>'
            f'<subdialog src="#d">{to("c")}</subdialog><record name="m">{to("d")}</record></form>'
            f'<form id="b"><record>{to("a")}</record><object name="o" classid="x">{to("c")}</object>'
            '<transfer dest="tel:1" bridge="true"><filled><foreach item="n" array="[1]">'
            '<if cond="n"><goto next="#d"/></if></foreach></filled></transfer></form>'
            '<form id="c"><field name="x" type="time"/><field name="y" type="date"/>'
            '<filled namelist="x  y"><goto next="#a"/></filled>'
            '<filled namelist="x y" mode="any"><goto next="#b"/></filled>'
            '<filled><goto next="#c"/></filled><filled mode="any"><goto next="#d"/></filled></form>'
            '<form id="d"><block><if cond="x"><return event="e.x"/><elseif cond="y"/>'
            """<return namelist="z"/></if><goto expr="z ? '#a' : other"/></block></form>"""
        ),
        "a.vxml",
    )
    assert ways(graph, "a") == {
        "d call": ["subdialog s", "subdialog"],
        "b": ["s has returned"],
        "c": ["subdialog has returned"],
        "d": ["m recorded"],
    }
    assert ways(graph, "b") == {
        "a": ["it recorded"],
        "c": ["o over"],
        "d": ["transfer over, if n"],
    }
    assert ways(graph, "c") == {
        "a": ["x, y answered"],
        "b": ["x or y answered"],
        "c": ["all answered"],
        "d": ["any answered"],
    }
    assert ways(graph, "d") == {
        "a back": ["then, if x, throws e.x", "then, if y"],
        "a guess": ["then, otherwise"],
        "to a computed target z ? '#a' : other": ["then, otherwise"],
    }


GRAMMAR = (
    '<grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar" {}>'
    '<rule id="r">{}</rule><rule id="s">far</rule></grammar>'
)


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        ("<one-of><item>a <one-of><item>b</item><item>c</item></one-of> d</item></one-of>", '"a b d"'),
        ('go <ruleref uri="#s"/> away', '"go ... away"'),
        ('<item repeat="0-1">please</item> see <token>New York</token>', '"see New York"'),
        ("<one-of><item>w</item><item>x</item><item>y</item><item>z</item></one-of>", '"w", "x", "y", ...'),
        ("<item>" * 60 + "stop" + "</item>" * 60, '"stop"'),
        ("please " + "<item>" * 60 + "stop" + "</item>" * 60, '"please stop"'),
    ],
)  # fmt: skip
def test_a_grammar_says_what_it_takes(tmp_path: Path, rule: str, said: str) -> None:
    body = f'<link next="#a">{GRAMMAR.format("", rule)}</link><form id="a"/>'
    graph = drawn(tmp_path, vxml(body), "a.vxml")
    assert ways(graph, "in any state") == {"a": [f"said {said}"]}


def test_a_dialog_is_reached_by_its_grammars_for_the_whole_document(tmp_path: Path) -> None:
    field = '<field name="x" type="boolean"/>'
    outer = GRAMMAR.format('scope="document"', "outer")
    (tmp_path / "y.grxml").write_text(GRAMMAR.format('xml:lang="en"', "no"), encoding="utf-8")
    body = (
        f'<form id="a"/><form id="b" scope="document">{GRAMMAR.format("", "start")}{field}</form>'
        f'<form id="c">{GRAMMAR.format("", "inner")}{outer}'
        f'<grammar scope="document" src="y.grxml" type="application/srgs+xml"/>{field}</form>'
        '<menu id="d" scope="document"><choice next="#a">it</choice></menu>'
    )
    graph = drawn(tmp_path, vxml(body), "a.vxml")
    assert ways(graph, "in any state") == {
        "b": ['said "start"'],
        "c": ['said "outer" or what y.grxml takes'],
        "d": ["said one of its choices"],
    }
