"""Warnings of calls of forms: misspelt params, and misspelt properties of results."""

from __future__ import annotations

import pytest

from prima.interpreter.reader import read_document

APP = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app">
<form id="a"><subdialog name="r" src="#sub">{params}</subdialog>
  <block>{use}<exit/></block></form>
<form id="sub"><var name="topic"/><var name="answer"/>
  <block><speak><value expr="topic"/></speak>{then}</block></form>
{more}</prima>"""
RETURN = '<return namelist="answer"/>'
OTHER = f'<form id="other"><var name="answer"/><block><log>x</log>{RETURN}</block></form>'


def warned(params: str = "", use: str = "", then: str = RETURN, more: str = "") -> list[str]:
    """The warnings of names; the document has no error."""
    text = APP.format(params=params, use=use, then=then, more=more)
    _, problems = read_document("app.xml", text.encode())
    assert {one.severity for one in problems} <= {"warning"}
    return [f"{one.message} {one.remedy}" for one in problems if one.code == "undeclared-variable"]


def param(*names: str) -> str:
    return "".join(f'<param name="{name}" expr="1"/>' for name in names)


def test_a_misspelt_param() -> None:
    told = 'The form "sub" neither declares nor uses "topicc". Did you mean "topic"?'
    assert warned(param("topicc")) == [told]


@pytest.mark.parametrize(
    ("names", "then"),
    [
        (("topic",), RETURN),
        (("topic", "topics"), RETURN),  # topic is given already
        (("topics",), f'<log expr="topics.length"/>{RETURN}'),
        (("other",), RETURN),
    ],
)
def test_a_param_that_may_be_meant(names: tuple[str, ...], then: str) -> None:
    assert warned(param(*names), then=then) == []


ANOTHER = """<form id="b"><subdialog name="r" src="#more"/>
  <block><log expr="r.anser"/><exit/></block></form>
<form id="more"><var name="anser"/><block><log>x</log><return namelist="anser"/></block></form>"""
"""A call whose result has the name of another form's, and is another one."""
USE = '<log expr="r.anser + 1"/>'


def test_a_misspelt_result() -> None:
    told = 'The form "sub" returns no "anser": its value is undefined. Did you mean "answer"?'
    assert warned(use=USE) == [told]
    assert warned(use=USE, then='<goto next="#other"/>', more=OTHER) == [told]
    assert warned(use="<script>var x = r.anser;</script>") == [told]


@pytest.mark.parametrize(
    ("use", "then", "more"),
    [
        ('<log expr="r.answer"/>', RETURN, ""),
        ('<log expr="r.length"/>', RETURN, ""),
        ('<log expr="r.toString()"/>', RETURN, ""),
        (USE, "<goto next-expr=\"'#ot' + 'her'\"/>", OTHER),  # leads anywhere
        ('<goto next="#b"/><log expr="r.answer"/>', RETURN, ANOTHER),
        (USE, '<var name="anser"/><return namelist="anser answer"/>', ""),
    ],
)
def test_a_result_that_may_be_meant(use: str, then: str, more: str) -> None:
    assert warned(use=use, then=then, more=more) == []


@pytest.mark.parametrize(
    ("goto", "told"),
    [
        ("next-expr=\"'#othr'\"", 'There is no form "othr" to go to: this throws error.badfetch.'),
        ("next-expr=\"r ? '#sub' : 'lost'\"", 'There is no form "lost" to go to: this throws'),
        ("nextitem-expr=\"'s'\"", 'There is no form item "s" to go to: this throws'),
        ("next-expr=\"r ? '#other' : 'sub'\"", ""),
        ("next-expr=\"'#oth' + r\"", ""),
        ("nextitem-expr=\"'r'\"", ""),
    ],
)
def test_a_goto_by_a_literal_that_names_nothing(goto: str, told: str) -> None:
    text = APP.format(params="", use=f'<if cond="r"><goto {goto}/></if>', then=RETURN, more=OTHER)
    _, problems = read_document("app.xml", text.encode())
    found = [one for one in problems if one.code in ("no-such-form", "no-such-item")]
    assert [one.severity for one in found] == ["warning"] * bool(told)
    assert not told or found[0].message.startswith(told)
