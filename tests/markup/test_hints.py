"""Values as they were most likely meant."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.markup.hints import MOVED, OTHERS, meant_value
from prima.sim.vocabulary.scenario import SCENARIO


@pytest.mark.parametrize(
    ("text", "usual", "meant"),
    [
        ("99", "", "99s"),
        ("500", "", "500ms"),
        ("500", "0s", "500ms"),
        ("500", "10s", "500ms"),
        ("120", "600s", "120s"),  # when a run ends
        ("2min", "600s", "120s"),
        ("soon", "600s", ""),
    ],
)
def test_a_time_without_a_unit(text: str, usual: str, meant: str) -> None:
    assert meant_value("duration", text, usual) == meant


def test_no_fix_writes_an_empty_text(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><meta/><form id="f">'
        '<block><send to="x"><param value="1"/></send><exit/></block></form></prima>'
    )
    found = [one for one in api.validate([path]) if one.code == "missing-attribute"]
    assert len(found) == 3
    assert not any(one.fixes for one in found)


def voice(body: str) -> str:
    return (
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1"'
        f' xml:lang="en"><form>{body}</form></vxml>'
    )


@pytest.mark.parametrize(
    ("text", "there"),
    [
        (
            '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f">'
            '<block><topological-move too="lab" to="lab"/><exit/></block></form></prima>',
            "to",
        ),
        (voice('<block name="a" nam="b">Hello.</block>'), "name"),
        (voice('<block><p:topological-move too="lab" to="lab"/></block>'), "to"),
        (voice('<p:iu longest="2s" longst="3s"><block>Hello.</block></p:iu>'), "longest"),
        (
            voice(
                '<field name="q"><grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"'
                ' root="r" rot="r"><rule id="r">a</rule></grammar></field>'
            ),
            "root",
        ),
        (
            voice(
                '<field name="q"><grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"'
                ' root="r"><rule id="r" idd="s">a</rule></grammar></field>'
            ),
            "id",
        ),
    ],
)
def test_no_fix_writes_an_attribute_that_is_there(tmp_path: Path, text: str, there: str) -> None:
    path = tmp_path / "a.xml"
    path.write_text(text)
    (problem,) = (one for one in api.validate([path]) if one.code == "unknown-attribute")
    assert problem.remedy.startswith(f'Remove it: there is "{there}" already.')
    assert not problem.fixes


@pytest.mark.parametrize(("tag", "name"), OTHERS)
def test_an_attribute_that_authors_expect_is_none_and_what_is_to_be_written_is_one(
    tag: str, name: str
) -> None:
    known = [one.attributes[tag] for one in (DIALOGUE, SCENARIO) if tag in one.attributes]
    assert known
    right = OTHERS[tag, name].partition(" it at the <prompt>: <prompt ")[2] or OTHERS[tag, name][6:]
    for attributes in known:
        assert name not in attributes
        where = DIALOGUE.attributes["prompt"] if "<prompt" in OTHERS[tag, name] else attributes
        assert right.partition("=")[0] in where


@pytest.mark.parametrize(("tag", "name"), MOVED)
def test_an_attribute_that_belongs_to_another_element_is_none(tag: str, name: str) -> None:
    known = [one.attributes[tag] for one in (DIALOGUE, SCENARIO) if tag in one.attributes]
    assert known and all(name not in attributes for attributes in known)


@pytest.mark.parametrize(
    ("content", "remedy"),
    [
        ("<block><goto next='#f' if='true'/></block>", 'Put it into an <if cond="...">.'),
        ("<block><var name='n'>0</var></block>", 'Write it as expr="..."; a text in it has quotes'),
        (
            "<block><send to='s'><param name='n' value='1'>0</param></send></block>",
            'as value="..."',
        ),
        ("<link next='#f'>stop</link>", "Write it into a <grammar>."),
        ("<on event='touch'><prompt>Oh.</prompt></on>", "Write <speak>; a <prompt> is what"),
        ("<block><topological-move to='#lab'/></block>", 'Write "lab".'),
        ("<block><end/></block>", "Write <exit/>."),
        ("<on event='touch'><retry/></on>", "Write <reprompt/>."),
        ("<field name='a' type='string'><prompt>A?</prompt></field>", 'Did you mean "text"?'),
        (
            "<field name='a'><prompt>A?</prompt><grammar type='date'/></field>",
            "belongs to the field",
        ),
        ("<watch name='near' when='human.distance &lt; 1'/>", "Write sensor.human."),
        ("<var name='goal'/><block cond='goal == lab'/>", "For the text itself write 'lab'."),
        ("<block><topological-move to-exp='x'/></block>", 'Did you mean "to-expr"?'),
        ("<block><topological-move expr='x'/></block>", "Write to-expr."),
        ("<block><turn expr='x'/></block>", "Write angle-expr."),
        ("<block><topological-move to='a[0].b'/></block>", 'write to-expr="a[0].b".'),
        ("<block><topological-move to='${goal}'/></block>", 'write to-expr="goal".'),
        ("<block><topological-move to='$goal'/></block>", 'write to-expr="goal".'),
        ("<block><topological-move to='the lab'/></block>", "Begin with a letter;"),
        ("<block><topological-move to='room (2)'/></block>", "Begin with a letter;"),
        ("<block><turn angle='n * 10'/></block>", 'write angle-expr="n * 10".'),
        ("<block><goto next='{goal}'/></block>", 'write next-expr="goal".'),
        ("<block><goto next-expr='#f'/></block>", "with quotes of its own: '#f'."),
        ("<block><speak expr='1'/></block>", 'Write it inside: <value expr="..."/>.'),
        ("<field name='a'><option name='x'>yes</option></field>", "It may have value."),
        ("<block><script src='a.js'/></block>", "Write the code into the <script>."),
        ("<block><while cond='true'/></block>", "Write <foreach>;"),
        ("<include/>", "Remove it."),
        ("<x:a xmlns:x='urn:x'/>", "Remove it."),
        (
            "<field name='a'><grammar xmlns='http://www.w3.org/2001/06/grammar'>a</grammar></field>",
            "remove its xmlns or its prefix.",
        ),
        ("<var name='a'/><block cond='a eq 1'/>", "Write == for eq."),
        ("<var name='a'/><block cond='{a == 1}'/>", "without { and }."),
    ],
)
def test_what_is_written_in_other_languages_is_known(
    content: str, remedy: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">'
        f'<form id="f">{content}</form></prima>'
    )
    found = [one.remedy for one in api.validate([path]) if one.severity == "error"]
    assert any(remedy in one for one in found), found


def test_the_attribute_to_be_written_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><var name="n" value="0"/>'
        '<form id="f"><block><goto form="f"/></block></form></prima>'
    )
    found = [one.remedy for one in api.validate([path]) if one.code == "unknown-attribute"]
    assert found == [OTHERS["var", "value"], OTHERS["goto", "form"]]
