"""Warnings of questions: prompts that come too late, times in which nobody can answer."""

from __future__ import annotations

import pytest

from prima.interpreter.reader import read_document

APP = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app">{}</prima>'
ASK = """<field name="tea" type="boolean"{}>
<prompt count="2">Tea?</prompt><noinput count="3"><exit/></noinput><filled>{}</filled></field>"""


def form(name: str, content: str) -> str:
    return f'<form id="{name}">{content}</form>'


def warned(body: str, code: str) -> int:
    """How many warnings of a code a document has; it has no error."""
    _, problems = read_document("app.xml", APP.format(body).encode())
    assert {one.severity for one in problems} <= {"warning"}
    return sum(one.code == code for one in problems)


TO_B = '<goto next="#b"/>'


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (form("a", ASK.format("", "<exit/>")), 1),
        (form("a", "<block><log>x</log></block>" + ASK.format("", "<exit/>")), 0),
        (form("a", "<block><speak>Tea?</speak></block>" + ASK.format("", "<exit/>")), 0),
        (form("a", ASK.format(' cond="false"', "<exit/>")), 0),
        (form("a", ASK.format("", TO_B)) + form("b", ASK.format("", "<exit/>")), 2),
        (form("a", f"<block>{TO_B}</block>") + form("b", ASK.format("", "<exit/>")), 1),
        (
            form("a", f"<block><speak>Tea?</speak>{TO_B}</block>")
            + form("b", ASK.format("", "<exit/>")),
            0,
        ),
        (
            form("a", "<block><speak>Tea?</speak><goto next-expr=\"'#b'\"/></block>")
            + form("b", ASK.format("", "<exit/>")),
            0,
        ),
        (
            form("a", '<subdialog name="s" src="#b"/><block><exit/></block>')
            + form("b", ASK.format("", '<return namelist="tea"/>')),
            0,
        ),
    ],
)
def test_a_question_that_nothing_asks_the_first_time_is_told(body: str, told: int) -> None:
    assert warned(body, "nothing-to-say") == told
