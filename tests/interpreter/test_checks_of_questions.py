"""Warnings of questions: prompts that come too late, times in which nobody can answer."""

from __future__ import annotations

from functools import partial
from typing import Any

import pytest

from prima.grammar.answers import Answers
from prima.grammar.phrases import MOST
from prima.interpreter.checks import comparisons
from prima.interpreter.reader import read_document
from prima.messages import Json
from prima.script.budget import Budget

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


OPTIONS = '<option value="tea">some tea</option><option>Coffee</option>'
GRAMMAR = (
    "<grammar><one-of><item>green tea <tag>green</tag></item><item>coffee</item></one-of></grammar>"
)


@pytest.mark.parametrize(
    ("answers", "cond", "told"),
    [
        (OPTIONS, "x == 'tea' || x != 'Coffee'", 0),
        (OPTIONS, "x == 'some tea'", 1),
        (OPTIONS, "'coffee' !== x", 1),
        (OPTIONS, "x == '' || x == '1' || x == y || x$.utterance == 'tee' || x == '\\x41'", 0),
        (GRAMMAR, "x == 'green' || x == 'Coffee'", 0),
        (GRAMMAR, "x == 'green tea'", 1),
        ('type="boolean"', "x == 'yes'", 1),
        ('type="boolean"', "x === 'true' &amp;&amp; x != 'no'", 2),
        ('type="boolean"', "x == true || x == '1'", 0),
        ('type="number"', "x == 'one'", 0),
        ('type="text"', "x == 'one'", 0),
        (f"{OPTIONS}<nomatch><assign name='x' expr='1'/></nomatch>", "x == 'none'", 0),
        (f"{OPTIONS}<filled><script>x = 'none'</script></filled>", "x == 'none'", 0),
        (f'expr="null">{OPTIONS}', "x == 'none'", 0),
    ],
)
def test_a_comparison_with_what_no_answer_gives_is_told(answers: str, cond: str, told: int) -> None:
    start = answers if answers[:1] != "<" else f">{answers}"
    start += "" if ">" in start else ">"
    field = f'<field name="x" {start}<prompt>Tea?</prompt><noinput><exit/></noinput></field>'
    content = '<block><var name="y"/></block>{}<block><exit/></block>'
    asked = f'<block cond="{cond}"><speak>Good.</speak></block>'
    assert warned(form("a", field + content.format(asked)), "never-equal") == told


@pytest.mark.parametrize(
    ("answers", "told"),
    [
        (OPTIONS, "It is Coffee or tea."),
        (GRAMMAR, "It is coffee or green."),
        ("<grammar>tea <item repeat='0-1'>please</item></grammar>", "It is tea or tea please."),
        (
            "<grammar><one-of><item>black</item><item>milk</item></one-of></grammar>",
            'Did you mean "milk"?',
        ),
        ('<grammar><one-of><item>tea <tag>""</tag></item></one-of></grammar>', 'It is "".'),
    ],
)
def test_the_values_that_answers_give_are_told(answers: str, told: str) -> None:
    field = f'<field name="x"><prompt>Tea?</prompt>{answers}<noinput><exit/></noinput></field>'
    asked = """<block cond="x == 'mlik'"><speak>Good.</speak></block><block><exit/></block>"""
    _, problems = read_document("app.xml", APP.format(form("a", field + asked)).encode())
    (found,) = [one for one in problems if one.code == "never-equal"]
    assert found.remedy == told


def test_answers_that_take_too_long_to_find_are_not_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(comparisons, "Budget", partial(Budget, steps=1))
    grammar = "<grammar><item repeat='0-'>green</item> tea</grammar>"
    field = f'<field name="x"><prompt>Tea?</prompt>{grammar}<noinput><exit/></noinput></field>'
    asked = """<block cond="x == 'milk'"><speak>Good.</speak></block><block><exit/></block>"""
    _, problems = read_document("app.xml", APP.format(form("a", field + asked)).encode())
    assert [one.remedy for one in problems if one.code == "never-equal"] == [""]


def test_the_answers_of_a_grammar_are_listed_once_however_many_comparisons_are_wrong(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    matched: list[str] = []
    match = Answers.match

    def counted(answers: Answers, text: str, *others: Any) -> Json:
        matched.append(text)
        return match(answers, text, *others)

    monkeypatch.setattr(Answers, "match", counted)
    items = "".join(f"<item>tea {number}</item>" for number in range(40))
    field = f'<field name="x"><prompt>Tea?</prompt><grammar><one-of>{items}</one-of></grammar>'
    asked = "".join(f"<block cond=\"x == 'milk {number}'\"/>" for number in range(90))
    body = f"{field}<noinput><exit/></noinput></field>{asked}<block><exit/></block>"
    assert warned(form("a", body), "never-equal") == 90
    assert len(matched) == 90 + MOST


@pytest.mark.parametrize(
    ("grammar", "code"),
    [
        ("[please] tea", "bad-token"),
        ("#ABNF 1.0; root $tea; $tea = tea;", "bad-token"),
        ("$tea please", "bad-token"),
        ("<one-of><item>[very] good</item></one-of>", "bad-token"),
        ("5 $ for C#, or #1", ""),
        ("<tag>tea</tag>", "empty-answer"),
        ("<item/>", "empty-answer"),
        ('<rule id="tea"><ruleref uri="#tea"/></rule>', "empty-answer"),
        ('<rule id="tea"><tag>tea</tag></rule>', "empty-answer"),
        ("<one-of/>", "empty-answer"),
        ('tea <ruleref uri="#root"/>', "no-such-rule"),
        ('<ruleref uri="#root"/>', "no-such-rule"),
        ('<rule id="a"><ruleref uri="#b"/></rule><rule id="b">tea</rule>', ""),
    ],
)
def test_a_grammar_that_no_words_can_match_is_told_once(grammar: str, code: str) -> None:
    body = (
        f'<field name="drink"><prompt>Tea?</prompt><grammar>{grammar}</grammar>'
        "<noinput><exit/></noinput><filled><exit/></filled></field>"
    )
    _, problems = read_document("app.xml", APP.format(form("a", body)).encode())
    assert [one.code for one in problems] == ([code] if code else [])
    assert all(one.remedy for one in problems)
