"""Units in VoiceXML documents that are wrong or speak for too long."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api, loading
from prima.errors import Problem
from tests.helpers.units import P, ask, problems_of, say, unit
from tests.helpers.voice import vxml


@pytest.mark.parametrize(
    ("inner", "code", "told"),
    [
        ("", "empty", "holds no form item. Write <block>, <field>, <initial> or <record>"),
        ("<noinput/>", "empty", "holds no form item"),
        ("Hm. <block/>", "stray-text", "Write it into a <block>"),
        ("<block/><p:turn angle='1'/>", "misplaced-element", "Write it into a <block>."),
        ("<block/><p:par/>", "misplaced-element", "Write it into a <block>."),
        ("<block/><prompt/>", "misplaced-element", "Write it into a <block>."),
        ("<block/><on event='x'/>", "misplaced-element", 'Write <catch event="...">.'),
        ("<block/><filled/>", "misplaced-element", "beside the <p:iu>, with a namelist"),
        ("<block/><var name='v'/>", "misplaced-element", "Write it into the form, beside"),
        ("<subdialog src='#a'/><block/>", "misplaced-element", "Write it into the form, beside"),
        ("<p:iu><block/></p:iu><block/>", "misplaced-element", "<p:iu> is not allowed in a <p:iu>"),
        ("<blok/><block/>", "misplaced-element", "It holds <block>, <field>, <initial> or"),
        ("<field name='x' tipe='a'/>", "unknown-attribute", '"type"'),
        ("<field name='x'/><field name='x'/>", "duplicate-name", 'the name "x"'),
    ],
)
def test_wrong_units_are_told(inner: str, code: str, told: str) -> None:
    problems = problems_of(vxml(unit(inner)))
    [problem] = [one for one in problems if one.code == code]
    assert problem.severity == "error" and problem.place.line == 1
    assert told in f"{problem.message} {problem.remedy}"


@pytest.mark.parametrize(
    ("attributes", "code"),
    [
        ("longest='2'", "bad-value"),
        ("restartable='true'", "unknown-attribute"),
        ("name='1x'", "bad-value"),
    ],
)
def test_wrong_attributes_of_units_are_told(attributes: str, code: str) -> None:
    assert [one.code for one in problems_of(vxml(unit("<block/>", "", attributes)))] == [code]


def test_a_unit_stands_in_a_form_or_around_commands() -> None:
    [problem] = problems_of(vxml(f"<menu {P}><choice next='#a'>a</choice><p:iu/></menu>"))[:1]
    assert problem.message == "<p:iu> is not allowed in <menu>."
    assert "around the items of a <form>" in problem.remedy


def warned(tmp_path: Path, text: str, **files: str) -> list[Problem]:
    """What validation says of a document."""
    for name, content in files.items():
        (tmp_path / f"{name}.vxml").write_text(content)
    (tmp_path / "app.vxml").write_text(text)
    return loading.validate([tmp_path / "app.vxml"])


LONG = "This is a long sentence that goes on and on and on and on. " * 7


@pytest.mark.parametrize(
    "body",
    [
        unit(say(LONG)),
        unit(f"<field name='x' type='boolean'><prompt>{LONG}</prompt></field>"),
        f"<form {P}><block><p:iu><p:speak>{LONG}</p:speak></p:iu></block></form>",
        unit(say("<prompt>Wait. <break time='21s'/></prompt>")),
    ],
)
def test_a_unit_that_speaks_for_long_is_warned_of(tmp_path: Path, body: str) -> None:
    [problem] = warned(tmp_path, vxml(body))
    assert (problem.code, problem.severity) == ("long-unit", "warning")
    assert "<p:iu" in body.splitlines()[problem.place.line - 1]


def test_short_units_are_not_warned_of(tmp_path: Path) -> None:
    assert warned(tmp_path, vxml(unit(say("Hi.") + ask(), say(LONG)))) == []


@pytest.mark.parametrize("arranging", ["par", "seq", "iu"])
def test_a_command_wanted_now_stands_first(arranging: str) -> None:
    def told(inner: str) -> list[str]:
        body = f"<form {P}><block><p:{arranging}>{inner}</p:{arranging}></block></form>"
        return [f"{one.code} {one.message}" for one in problems_of(vxml(body))]

    assert told("<p:stop-moving/><p:speak>a</p:speak>") == []
    [problem] = told("<p:speak>a</p:speak><p:stop-moving/>")
    assert problem.startswith(
        "now-inside <p:stop-moving> is wanted now; it is not allowed in a <p:par>"
    )
    [problem] = told("<p:speak>a</p:speak><p:command type='stop-moving'/>")
    assert problem.startswith("now-inside <p:command> is wanted now")


def test_a_roots_handler_that_a_unit_cannot_have_is_warned_of(tmp_path: Path) -> None:
    root = vxml(f"<noinput {P}><p:tracking-human/></noinput>")
    leaf = (
        "<vxml version='2.1' xmlns='http://www.w3.org/2001/vxml' application='root.vxml'>"
        + unit(ask())
        + "</vxml>"
    )
    [problem] = warned(tmp_path, leaf, root=root)
    assert (problem.code, problem.severity) == ("not-in-unit", "warning")
    assert problem.place.file.endswith("root.vxml")
    assert problem.remedy.endswith("At run time it is error.semantic.")


@pytest.mark.parametrize("code", ["1 ==", "unknown"])
def test_a_units_condition_is_checked(tmp_path: Path, code: str) -> None:
    [problem] = warned(tmp_path, vxml(unit(say("Hi."), "", f"cond='{code}'")))
    assert problem.code in ("bad-expression", "undeclared-variable")


def test_the_fields_of_a_unit_are_variables_of_the_form(tmp_path: Path) -> None:
    assert warned(tmp_path, vxml(unit(ask(), "<block cond='x &amp;&amp; u'/>", "name='u'"))) == []


def test_a_document_with_errors_is_told_of_nothing_else_in_its_units(tmp_path: Path) -> None:
    body = unit(f"<block>{LONG}</block>") + f"<form {P}><block><p:unit/></block></form>"
    assert [one.code for one in warned(tmp_path, vxml(body))] == ["unknown-element"]


def test_a_unit_that_its_own_speech_outlasts_is_told(tmp_path: Path) -> None:
    said = "<p:speak>This takes longer than two seconds to say.</p:speak>"
    body = f'<form {P}><block><p:iu longest="2s">{said}</p:iu></block></form>'
    text = vxml(body)
    [problem] = warned(tmp_path, text)
    assert problem.code == "long-unit" and "error.unit.timeout" in problem.message
    line = text.splitlines()[problem.place.line - 1]
    assert line[problem.place.column - 1 :].startswith("2s")


GUEST = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="world.xml"
  robot="own.xml"><robot at="middle"/><application src="{0}"/></scenario>"""
OWN = """<robot xmlns="urn:prima:robot:1" version="1.0" id="r"><device name="speaker"/>
  <device name="arm"/><adds command="hold" devices="arm" leaves="true"/></robot>"""
PRIMA = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">{0}</prima>'
HOLD = "hold> leaves the user; it is not allowed in a unit."


@pytest.mark.parametrize(
    ("name", "inner", "message"),
    [
        ("a.vxml", "<p:iu><block>Hi.<p:command type='hold'/></block></p:iu>", f"<p:{HOLD}"),
        ("a.vxml", "<block><p:iu><p:command type='hold'/></p:iu></block>", f"<p:{HOLD}"),
        ("a.vxml", "<block><p:command type='hol'/></block>", 'This robot has no Command "hol".'),
        ("a.vxml", "<block><p:command type='hold'/></block>", ""),
        (
            "a.xml",
            "<iu><block><command type='hold'/></block></iu><block><exit/></block>",
            f"<{HOLD}",
        ),
        ("a.xml", "<block><iu><command type='hold'/></iu><exit/></block>", f"<{HOLD}"),
        ("a.xml", "<block><command type='hold'/><exit/></block>", ""),
    ],
)
def test_a_robots_own_command_is_checked_where_it_is_used(
    place: Path, name: str, inner: str, message: str
) -> None:
    form = f'<form id="f" {P if name == "a.vxml" else ""}>{inner}</form>'
    (place / name).write_text(vxml(form) if name == "a.vxml" else PRIMA.format(form))
    (place / "own.xml").write_text(OWN)
    (place / "s.xml").write_text(GUEST.format(name))
    found = api.validate([place / "s.xml"])
    assert [one.message for one in found] == ([message] if message else [])
    assert all(one.place.file.endswith(name) and one.remedy for one in found)
