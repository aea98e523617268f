"""Errors in scenarios and worlds, reported before a run."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from prima import api, loading
from prima.errors import DocumentError
from prima.loading.scenarios import load_whole
from tests import ROOT
from tests.helpers.validating import VXML, in_the_passage

SCENARIO = f"""<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"
 world="{ROOT}/documents/worlds/library.xml" robot="{ROOT}/documents/robots/papero.xml">
  <application src="{{}}"/>
  {{}}
  <robot at="nowhere"/>
  <person at="there" spede="1"/>
  <when at="3s"><touch sensor="haed"/><unload application="librari"/></when>
  <when at="3x"><fail device="wheel"/></when>
</scenario>
"""


@pytest.mark.parametrize("missing", [False, True])
def test_all_that_is_wrong_with_a_scenario_is_told_at_once(missing: bool, tmp_path: Path) -> None:
    documents = ROOT / "documents" / "ea"
    src = documents / ("libary.xml" if missing else "library.xml")
    path = tmp_path / "s.xml"
    path.write_text(SCENARIO.format(src, "<application/>" if missing else ""), encoding="utf-8")
    with pytest.raises(DocumentError) as caught:
        loading.load_scenario(path)
    own = [one for one in caught.value.problems if one.place.file == str(path)]
    places = {
        (3, 21): "no-such-file",
        (4, 3): "missing-attribute",
        (5, 14): "no-such-name",
        (6, 15): "no-such-name",
        (6, 22): "unknown-attribute",
        (7, 32): "no-such-name",
        (7, 60): "no-such-name",
        (8, 13): "bad-value",
        (8, 31): "no-such-name",
    }
    for unknown in [(7, 60)] if missing else [(3, 21), (4, 3)]:  # which ids there are is not known
        del places[unknown]
    assert {(one.place.line, one.place.column): one.code for one in own} == places


def test_a_scenario_with_any_attribute_wrong_is_looked_at() -> None:
    looked = 0
    for path in sorted((ROOT / "documents" / "scenarios").glob("*.xml"))[::6]:
        text = path.read_text(encoding="utf-8")
        for written in re.finditer(r'([\w-]+)="([^"]*)"', text):
            for wrong in ("", f'{written[1]}=""', f'{written[1]}="?!"', f'{written[1]}x="1"'):
                try:
                    load_whole(
                        path, (text[: written.start()] + wrong + text[written.end() :]).encode()
                    )
                except DocumentError as error:
                    assert error.problems
                looked += 1
    assert looked > 200


@pytest.mark.parametrize(
    ("person", "doing", "told"),
    [
        ("", '<walk to="aisle"/><look at="robot"/>', ["<walk> does nothing"]),
        ("", '<look at="robot"/>', ["<look> does nothing"]),
        ("", "<follow/>", ["<follow> does nothing"]),
        ("<person/>", "<follow/>", ["<follow> does nothing, as the <person> is nowhere."]),
        ("<person/>", "<say>Hello.</say>", []),
        ("", "<say>Hello.</say>", []),
        ('<person at="aisle"/>', '<walk to="entrance"/>', []),
    ],
)
def test_nobody_walks_where_nobody_is(
    person: str, doing: str, told: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "s.xml"
    head = SCENARIO.partition("<application")[0]
    application = f'<application src="{ROOT}/documents/ea/library.xml"/>'
    when = f'<when at="3s">{doing}</when></scenario>'
    path.write_text(f"{head}{application}{person}{when}", encoding="utf-8")
    problems = loading.load_scenario(path).problems
    found = [one for one in problems if one.message.startswith("Nobody")]
    assert [one.message.partition(" without")[0].partition(": ")[2] for one in found] == told
    assert {(one.severity, one.code) for one in found} <= {("warning", "missing-element")}


@pytest.mark.parametrize(
    ("asking", "told"),
    [
        ('<data name="d" src="service:wether"/>', [(2, 'The scenario has no service "wether".')]),
        ('<submit next=" service:wether#f "/>', [(2, 'The scenario has no service "wether".')]),
        ('<data name="d" src="service:weather"/>', []),
        ('<data name="d" src="service:news"/>', []),
    ],
)
def test_a_service_that_a_voicexml_document_names(
    asking: str, told: list[tuple[int, str]], tmp_path: Path
) -> None:
    (tmp_path / "a.vxml").write_text(
        VXML.format("", f"\n<form id='f'><block>{asking}</block></form>")
    )
    path = tmp_path / "s.xml"
    service = '<service name="weather"><reply/></service>'
    head = SCENARIO.partition("<application")[0]
    path.write_text(f'{head}<application src="a.vxml"/>{service}</scenario>', encoding="utf-8")
    found = [one for one in loading.load_scenario(path).problems if "service" in one.message]
    assert [(one.place.line, one.message) for one in found] == told
    assert all(one.fixes and "weather" in one.remedy for one in found)


# Worlds ---------------------------------------------------------------------------------
WORLD = """<world xmlns="urn:prima:world:1" version="1.0" id="w">
<place id="a" x="0" y="0"/><place id="b" x="4" y="0"/>
<way from="a" to="b"/>
{}
</world>"""
WALKS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f"><block>
<topological-move to="b"/><exit/></block></form></prima>"""


def walking(folder: Path) -> Path:
    """A scenario in which a robot goes along the way of ``w.xml``."""
    (folder / "a.xml").write_text(WALKS)
    path = folder / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w.xml"'
        f' robot="{ROOT}/documents/robots/papero.xml"><robot at="a"/>'
        '<application src="a.xml"/></scenario>'
    )
    return path


def test_a_way_through_a_wall_is_told_beside_other_errors(tmp_path: Path) -> None:
    path = tmp_path / "w.xml"
    wall = '<wall x1="2" y1="-2" x2="2" y2="2"/>'
    path.write_text(WORLD.format(f'<way from="a" to="q"/>{wall}'))
    found = [(one.code, one.place.line) for one in loading.validate([path])]
    assert found == [("blocked-way", 3), ("no-such-name", 4)]
    path.write_text(WORLD.format(wall.replace('"2"', '"far"', 1)))
    assert [one.code for one in loading.validate([path])] == ["bad-value"], (
        "nobody knows where it is"
    )


@pytest.mark.parametrize("y", ["0.1", "-0.18", "0.2", "0.4"])
def test_a_way_that_is_too_narrow_for_the_robot_is_told(tmp_path: Path, y: str) -> None:
    (tmp_path / "w.xml").write_text(WORLD.format(f'<wall x1="1" y1="{y}" x2="5" y2="{y}"/>'))
    path = walking(tmp_path)
    assert loading.validate([tmp_path / "w.xml"]) == [], "it is wide enough for some robot"
    told = [one.message for one in loading.validate([path])]
    blocked = bool(api.rehearse(api.load_scenario(path)).failures)
    assert blocked == (abs(float(y)) < 0.19)
    right = (
        'The way from "a" to "b" is too narrow for the robot: the wall in line 4 is'
        f" {abs(float(y)):.2f} m beside it."
    )
    assert told == [right] * blocked


@pytest.mark.parametrize(("metres", "told"), [("0.19", True), ("0.21", False)])
def test_a_place_that_is_too_close_to_a_wall_is_told(
    tmp_path: Path, metres: str, told: bool
) -> None:
    x = 4 + float(metres)
    (tmp_path / "w.xml").write_text(WORLD.format(f'<wall x1="{x}" y1="-2" x2="{x}" y2="2"/>'))
    path = walking(tmp_path)
    right = 'The place "b" is too close to the wall in line 4: 0.19 m. The robot may not reach it.'
    assert [one.message for one in loading.validate([path])] == [right] * told
    assert bool(api.rehearse(api.load_scenario(path)).failures) == told


# What a scenario waits for ----------------------------------------------------------------
ASKING = (
    '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f">'
    '<field name="x" type="boolean"><prompt>{}</prompt><noinput><exit/></noinput>'
    "<filled><exit/></filled></field></form></prima>"
)
VOICE = VXML.format(
    "",
    '<form><field name="x" type="boolean"><prompt>{}</prompt><filled>{}</filled></field></form>',
)


@pytest.mark.parametrize(
    ("name", "document", "words", "remedy"),
    [
        ("a.xml", ASKING.format("Tea or coffee?"), "tea", None),
        ("a.xml", ASKING.format("Tea or coffee?"), "juice", ""),
        ("a.xml", ASKING.format('Tea or <value expr="1"/>?'), "tea", None),
        ("a.xml", ASKING.format('<value expr="1"/>?'), "juice", None),
        ("a.xml", ASKING.format('Tea or <value expr="1"/>?'), "juice", None),
        ("a.xml", ASKING.format('Coffeine <value expr="1"/>?'), "Cofeine ?", "Coffeine ?"),
        ("a.vxml", VOICE.format("<emphasis>Tea</emphasis> or coffee?", "<exit/>"), "Tea or", None),
        ("a.vxml", VOICE.format('<phoneme ph="x">Tea</phoneme> or coffee?', ""), "Tea or", None),
        ("a.vxml", VOICE.format('<sub alias="Tea">T</sub> or coffee?', ""), "Tea or", None),
        ("a.vxml", VOICE.format('<sub alias="Tea">T</sub> or coffee?', ""), "T or", ""),
        ("a.vxml", VOICE.format("Tea or coffee?", "<exit/>"), "Tea or cofee?", "Tea or coffee?"),
        ("a.vxml", VOICE.format("Tea or coffee?", '<goto expr="x"/>'), "Tea or cofee?", None),
    ],
)
def test_an_answer_that_no_question_contains_is_told(
    tmp_path: Path, name: str, document: str, words: str, remedy: str | None
) -> None:
    (tmp_path / name).write_text(document)
    beside = ROOT / "tests" / "mistakes" / "beside"
    (tmp_path / "visit.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{beside}/museum.xml" robot="{beside}/robot.xml"><robot at="door"/>'
        f'<application src="{name}"/><answer to="{words}">Yes.</answer></scenario>'
    )
    found = loading.validate([tmp_path / "visit.xml"])
    assert [one.code for one in found] == ["never-said"] * (remedy is not None)
    assert all((remedy or "") in one.remedy for one in found)


@pytest.mark.parametrize(
    ("words", "remedy"),
    [
        ("A coffee, then.", 'It is said, not asked: write said="...".'),
        ("Tea or cofee?", 'Did you mean "Tea or coffee?"?'),
        ("Tea or coffee?", None),
    ],
)
def test_what_an_application_says_is_no_question(
    tmp_path: Path, words: str, remedy: str | None
) -> None:
    asks = ASKING.format("Tea or coffee?").replace(
        "<exit/></filled>", "<speak>A coffee, then.</speak></filled>"
    )
    (tmp_path / "a.xml").write_text(asks.replace("</field>", "</field><block><exit/></block>"))
    beside = ROOT / "tests" / "mistakes" / "beside"
    (tmp_path / "visit.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{beside}/museum.xml" robot="{beside}/robot.xml"><robot at="door"/>'
        f'<application src="a.xml"/><when asked="{words}"><say>Yes.</say></when></scenario>'
    )
    found = loading.validate([tmp_path / "visit.xml"])
    assert [one.remedy for one in found if one.code == "never-said"] == [remedy] * (
        remedy is not None
    )


@pytest.mark.parametrize("name", ["a.xml", "a.vxml"])
@pytest.mark.parametrize(
    ("more", "says"),
    [
        (
            '<when on="corner.trun"><say>Yes.</say></when>',
            '"corner.trun". Did you mean "corner.turn"?',
        ),
        ('<expect event="corner.crosing"/>', 'the event "corner.crosing".'),
        ('<never event="pasage.beds"/>', '"pasage.beds". Did you mean "passage.beds"?'),
        ('<expect event="corner.turn"/><when on="corner"><say>Yes.</say></when>', ""),
        (
            '<when at="1s"><event name="corner.own"/></when><when on="corner.own"><say>Yes.</say></when>',
            "",
        ),
        ('<expect event="passage.beds"/><when on="passage"><say>Yes.</say></when>', ""),
    ],
)
def test_a_corner_that_a_scenario_misspells_is_told(
    tmp_path: Path, name: str, more: str, says: str
) -> None:
    asking = ASKING.replace('id="f">', 'id="f"><on event="corner.own"><exit/></on>', 1)
    (tmp_path / "a.xml").write_text(asking.format("Tea?"))
    (tmp_path / "a.vxml").write_text(VOICE.format("Tea?", "<exit/>"))
    told = [one for one in in_the_passage(tmp_path, name, more) if "a.xml" not in one]
    assert len(told) == bool(says)
    assert all(one.startswith("visit.xml No corner of the world raises") for one in told)
    assert says in "".join(told)


@pytest.mark.parametrize(
    ("more", "severity", "code", "says"),
    [
        ('<when doing="topological-move"><say>Hi.</say></when>', "warning", "unsupported-command", "do topological-move: it lacks localization, locomotion. This never"),
        ('<expect says="Hi" done="gesture"/>', "warning", "unsupported-command", "cannot do gesture"),
        ('<never does="set-position"/>', "warning", "unsupported-command", "cannot do set-position"),
        ('<when doing="topological-mov"><say>Hi.</say></when>', "error", "no-such-name", 'no Command "topological-mov"'),
        ('<expect finishes="gestur"/>', "error", "no-such-name", 'no Command "gestur"'),
        ('<when done="speak"><say>Hi.</say></when>', "", "", ""),
    ],
)  # fmt: skip
def test_a_command_that_the_robot_lacks_is_waited_for_in_vain(
    more: str, severity: str, code: str, says: str, tmp_path: Path
) -> None:
    (tmp_path / "robot.xml").write_text(
        '<robot xmlns="urn:prima:robot:1" version="1.0" id="r"><device name="speaker"/></robot>'
    )
    (tmp_path / "a.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f"><block>'
        "<speak>Hi.</speak><exit/></block></form></prima>"
    )
    path = tmp_path / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" robot="robot.xml"'
        f' world="{ROOT}/documents/worlds/library.xml"><robot at="entrance"/><person x="1" y="0"/>'
        f'<application src="a.xml"/>{more}</scenario>'
    )
    found = loading.validate([path])
    assert [(one.severity, one.code) for one in found] == [(severity, code)] * bool(code)
    assert all(says in one.message for one in found)
    if severity != "error":
        assert not api.rehearse(api.load_scenario(path)).failures


SHOP = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="shop"><form id="a">
<block><send {}/><speak>Hello.</speak><gesture name="bow"/></block>
<on event="reply"><exit/></on></form></prima>"""


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("reply.ticket-ofice", 'Did you mean "reply.ticket-office"?'),
        ("error.service.ticket-ofice", 'Did you mean "error.service.ticket-office"?'),
        ("cancel.gestur", "Name what its handler says or does."),
        ("error.unsupported.gestur", "Name what its handler says or does."),
        ("expired.iu", "Name what its handler says or does."),
        ("error.badfetch.http", "Name what its handler says or does."),
        ("touch.hed", 'Did you mean "head"?'),
        ("touch.tail", "There is back and head."),
        *((f"reply.{name}", "") for name in ("ticket-office", "another")),
        ("touch.own", ""),
    ],
)
@pytest.mark.parametrize("where", ['<expect event="{}"/>', '<when on="{}"><say>Yes.</say></when>'])
def test_a_scenario_awaits_an_event_of_what_is_there(
    name: str, says: str, where: str, tmp_path: Path
) -> None:
    (tmp_path / "shop.xml").write_text(SHOP.format('to="ticket-office"'), encoding="utf-8")
    own = '<when at="1s"><event name="touch.own"/></when>'
    text = SCENARIO.split("  <robot")[0] + "</scenario>"
    (tmp_path / "s.xml").write_text(text.format("shop.xml", own + where.format(name)))
    found = [one for one in api.validate([tmp_path / "s.xml"]) if one.place.line == 4]
    assert [one.remedy for one in found if one.code != "unheard-event"] == [says] * bool(says)


def test_a_service_named_by_an_expression_may_be_any(tmp_path: Path) -> None:
    (tmp_path / "shop.xml").write_text(SHOP.format("to-expr=\"'ticket-' + 'ofice'\""))
    text = SCENARIO.split("  <robot")[0] + "</scenario>"
    more = '<service name="ticket-office"/><expect event="reply.ticket-ofice"/>'
    (tmp_path / "s.xml").write_text(text.format("shop.xml", more))
    assert api.validate([tmp_path / "s.xml"]) == []


WATCHING = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="w">
<watch name="low" when="sensor.battery?.level &lt; 20"/><form id="a"><on event="low"><exit/></on>
</form></prima>"""


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("batery.level", 'No application reads the sensor "batery". Did you mean "battery"?'),
        ("light", 'sensor "light". Read it: <watch name="..." when="sensor.light ..."/>, or'),
        *(("battery.level", ""), ("battery", "")),
    ],
)
@pytest.mark.parametrize("voicexml", [False, True])
def test_a_sensor_that_nobody_reads_is_told(
    name: str, told: str, voicexml: bool, tmp_path: Path
) -> None:
    (tmp_path / "w.xml").write_text(WATCHING, encoding="utf-8")
    (tmp_path / "a.vxml").write_text(VOICE.format("Tea?", "<exit/>"), encoding="utf-8")
    more = f'<when at="1s"><sensor name="{name}" value="3"/></when>'
    more += '<application src="a.vxml"/>' * voicexml  # it may read any sensor
    text = SCENARIO.split("  <robot")[0] + "</scenario>"
    (tmp_path / "s.xml").write_text(text.format("w.xml", more))
    found = [one for one in api.validate([tmp_path / "s.xml"]) if one.code == "no-such-name"]
    assert len(found) == (bool(told) and not voicexml)
    assert all(told in f"{one.message} {one.remedy}" for one in found)


@pytest.mark.parametrize(
    ("reply", "told"),
    [
        ("<number>3</number>", "There is no <number>. <reply> may hold <data>."),
        ('<param name="n" value="3"/>', 'no <param>. Write <data name="..." value="..."/>.'),
        ('<data name="n" value="3"><a/></data>', "There is no <a>. <data> holds no elements."),
        ("three", '<reply> holds text: "three". Write <data name="..." value="..."/>.'),
        ('<data name="n" value="3">3</data>', 'holds text: "3". Write it as value="...".'),
    ],
)
def test_what_a_reply_may_hold_is_told(reply: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "shop.xml").write_text(SHOP.format('to="office"'), encoding="utf-8")
    text = SCENARIO.split("  <robot")[0] + "</scenario>"
    more = f'<service name="office"><reply>{reply}</reply></service>'
    (tmp_path / "s.xml").write_text(text.format("shop.xml", more))
    (found,) = api.validate([tmp_path / "s.xml"])
    assert told in f"{found.message} {found.remedy}" and found.place.line == 4


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ('<place id="b" x="0.0" y="0" heading="0"/>', ['The place "b" is exactly where "a" is.']),
        ('<place id="b" x="0" y="0" heading="90"/>', []),
        ('<thing id="b" x="0" y="0"/>', []),
        ('<place id="b" x="1" y="0"/><way from="a" to="b"/>', []),
        ('<place id="b" x="1" y="0"/><way from="a" to="b"/><way from="b" to="a"/>',
         ['The way between "b" and "a" is there already, in line 1.']),
    ],
)  # fmt: skip
def test_what_a_world_has_twice_is_told(more: str, told: list[str], tmp_path: Path) -> None:
    head = '<world xmlns="urn:prima:world:1" version="1.0" id="w"><place id="a" x="0" y="0"/>'
    (tmp_path / "w.xml").write_text(f"{head}{more}</world>", encoding="utf-8")
    assert [one.message for one in api.validate([tmp_path / "w.xml"])] == told


def test_a_place_named_by_a_variable_is_told_to_be_an_expression(tmp_path: Path) -> None:
    (tmp_path / "app.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><var name="goal"/>'
        '<form id="f"><field name="spot" type="text"><prompt>Where?</prompt><noinput><exit/></noinput>'
        '</field><block><topological-move to="goal"/><point-by-hand toward="spot"/>'
        '<topological-move to="deks"/><exit/></block></form></prima>'
    )
    text = SCENARIO.split("  <robot")[0] + "</scenario>"
    (tmp_path / "s.xml").write_text(text.format("app.xml", ""))
    found = [one for one in api.validate([tmp_path / "s.xml"]) if one.code == "no-such-name"]
    first, second, third = found
    assert first.remedy == 'It is a variable: write to-expr="goal".'
    assert second.remedy == 'It is a variable: write toward-expr="spot".'
    assert [edit.text for edit in first.fixes[0].edits] == ['to-expr="goal']
    assert "variable" not in third.remedy


BLOCK = "<form id='f'><block>{}<exit/></block></form>"
GUESTS = VXML.format(' xmlns:p="urn:prima:dialogue:1"', BLOCK)
HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">'
TO = '<param name="to" value="aisel"/>'


@pytest.mark.parametrize(
    ("name", "document", "command"),
    [
        ("a.xml", f"{HEAD}{BLOCK}</prima>", f'<command type="topological-move">{TO}</command>'),
        ("a.vxml", GUESTS, f'<p:command type="topological-move">{TO}</p:command>'),
        ("a.vxml", GUESTS, f"<p:topological-move>{TO}</p:topological-move>"),
    ],
)
def test_a_place_in_a_param_is_told_there(
    name: str, document: str, command: str, tmp_path: Path
) -> None:
    text = document.format(command)
    (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "s.xml").write_text(SCENARIO.split("  <robot")[0].format(name, "") + "</scenario>")
    (one,) = [one for one in api.validate([tmp_path / "s.xml"]) if one.code == "no-such-name"]
    assert (one.message, one.remedy) == ('The world has no place "aisel".', 'Did you mean "aisle"?')
    line = text.splitlines()[one.place.line - 1]
    assert line[one.place.column - 1 :].startswith('aisel"/>')
    [edit] = one.fixes[0].edits
    assert (edit.span[:2], edit.text) == ((one.place.line, one.place.column), "aisle")


@pytest.mark.parametrize(
    ("read", "told"),
    [
        ("event.data.skyy", 'No reply of "weather" in the scenario has "skyy".'),
        ("1 + event ?. data.wnid", 'No reply of "weather" in the scenario has "wnid".'),
        ("event.data.sky + event.data.wind", ""),
        ("event.data.humidity", ""),
        ("'event.data' + event.name.skyy", ""),
    ],
)
def test_data_that_a_handler_misspells_of_a_reply(read: str, told: str, tmp_path: Path) -> None:
    form = f'<form id="f"><on event="reply.weather"><log expr="{read}"/></on></form>'
    (tmp_path / "a.xml").write_text(
        f'<prima xmlns="urn:prima:dialogue:1" version="1.0" id="a" kind="ea">{form}</prima>'
    )
    handler = '<catch event="reply.weather"><log expr="session.{}"/></catch><form/>'
    (tmp_path / "a.vxml").write_text(VXML.format("", handler.format(read)))
    reply = (
        '<reply><data name="sky" value="x"/></reply><reply><data name="wind" value="y"/></reply>'
    )
    path, head = tmp_path / "s.xml", SCENARIO.partition("<application")[0]
    for name in ("a.xml", "a.vxml"):
        text = (
            f'{head}<application src="{name}"/><service name="weather">{reply}</service></scenario>'
        )
        path.write_text(text, encoding="utf-8")
        found = [one.message for one in loading.load_scenario(path).problems]
        assert [one for one in found if one.startswith("No reply")] == ([told] if told else []), (
            name
        )
