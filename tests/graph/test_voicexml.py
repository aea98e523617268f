"""The graph of a VoiceXML application."""

from __future__ import annotations

from pathlib import Path

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
