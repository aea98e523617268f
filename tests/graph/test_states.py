"""The graph of a document of PRIMA's own language: states, and the ways between them."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.graph import cards, states, text
from prima.graph.labels import AnswerLabel, condition, ordinal
from tests import ROOT
from tests.helpers.graphs import app, drawn, named, vxml, ways


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
    assert condition(code, AnswerLabel(name, truth)) == told


def test_ordinals() -> None:
    assert [ordinal(n) for n in (1, 2, 3, 4, 11, 12, 21, 112)] == [
        "1st", "2nd", "3rd", "4th", "11th", "12th", "21st", "112th",
    ]  # fmt: skip


def test_a_form_s_filled_and_loops_are_told(tmp_path: Path) -> None:
    question = '<field name="{0}" type="text"><prompt>{0}?</prompt></field>'.format
    graph = drawn(
        tmp_path,
        app(
            f'<on event="touch"><throw event="y"/></on><form id="a">{question("x")}{question("y")}'
            '<filled namelist="x y" mode="any"><goto next="#b"/></filled>'
            '<filled mode="any"><foreach item="q" array="[1]"><if cond="q"><goto next="#a"/></if>'
            "</foreach></filled><filled><exit/></filled>"
            '<on event="y"><goto next="#b"/></on></form><form id="b"/>'
        ),
    )
    assert ways(graph, "a") == {
        "b": ["x or y answered", "y", "touch, throws y"],
        "a": ["any answered, if q"],
        "ends the application": ["all answered"],
    }
