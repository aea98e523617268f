"""Grammars of applications: an index of alternatives changes nothing but the time."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima.grammar.answers import Answers
from prima.grammar.model import Alternatives, Part, PrefixIndex, Repeat, Sequence
from prima.script.budget import MOST_MATCHING, Budget
from tests.helpers.robot import document, read

MANY = 10_000
WORDS = ["a", "b", "a b", "ab", "é", "éa", "駅", "駅 a", "a駅", "3", "new york"]
SAID = st.lists(st.sampled_from([*WORDS, "york", "c", "3.5"]), max_size=5).map(" ".join)


def parts(depth: int = 3) -> st.SearchStrategy[str]:
    """Parts of grammars with the rules r and s."""
    refs = [f'<ruleref uri="#{name}"/>' for name in "rs"]
    tags = [f"<tag>{value}</tag>" for value in "12"]
    leaves = st.sampled_from([*WORDS, *WORDS, *tags, *refs])
    if not depth:
        return leaves
    inner = st.deferred(lambda: parts(depth - 1))
    times = st.sampled_from(["1", "0-1", "2", "0-", "1-", "0"])
    several = st.lists(inner, min_size=1, max_size=3).map(" ".join)
    items = several.map("<item>{}</item>".format)
    return st.one_of(
        leaves,
        several,
        st.builds('<item repeat="{}">{}</item>'.format, times, several),
        st.lists(items, min_size=1, max_size=10).map("".join).map("<one-of>{}</one-of>".format),
    )


def unindexed(part: Part) -> None:
    """Let all alternatives of a part be tried."""
    todo = [part]
    while todo:
        one = todo.pop()
        if isinstance(one, Alternatives):
            one.index = PrefixIndex({}, [], list(range(len(one.parts))))
        if isinstance(one, Alternatives | Sequence):
            todo += one.parts
        elif isinstance(one, Repeat):
            todo.append(one.part)


@given(parts(), parts(2), SAID)
@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
def test_an_index_leaves_out_no_alternative_that_matches(one: str, two: str, said: str) -> None:
    rules = f'<rule id="r">{one}</rule><rule id="s">{two}</rule>'
    made, _ = read(ASKING.format(f'<grammar root="r">{rules}</grammar>'))
    grammar = made.forms["f"].items[0].answers.grammars[0]  # type: ignore[attr-defined]
    indexed = grammar.match(said)
    for rule in grammar._document.rules.values():
        unindexed(rule.body)
    assert grammar.match(said) == indexed


ASKING = '<form id="f"><field name="a"><prompt>?</prompt>{}</field></form>'


def answers(inside: str) -> Answers:
    """What a field with such a grammar takes."""
    made = document(ASKING.format(inside))
    field = made.forms["f"].items[0]
    return field.answers  # type: ignore[attr-defined, no-any-return]


ITEMS = "".join(f"<item>w{i} street<tag>{i}</tag></item>" for i in range(MANY))


@pytest.mark.parametrize(
    ("inside", "said", "value"),
    [
        (f"<one-of>{ITEMS}</one-of>", "w77 street", "77"),
        (f'please <item repeat="1-"><one-of>{ITEMS}</one-of></item>', "please w5 street w7", None),
        (
            f'please <item repeat="1-"><one-of>{ITEMS}</one-of></item>',
            "please " + "w5 street w7 street " * 20,
            "7",
        ),
        (
            '<rule id="r"><item repeat="0-1">the</item><ruleref uri="#n"/> now</rule>'
            f'<rule id="n"><one-of>{ITEMS}</one-of></rule>',
            "The w9999 street now!",
            "9999",
        ),
        (
            "<one-of>"
            + ITEMS.replace("<item>", '<item><item repeat="0-1">the</item> ')
            + "</one-of>",
            "the w5 street",
            "5",
        ),
        (f"<one-of>{ITEMS}<item>w5 street<tag>late</tag></item></one-of>", "w5 street", "5"),
        (
            f"<one-of><item>w5<tag>early</tag></item>{ITEMS}</one-of><item repeat='0-1'>street</item>",
            "w5 street",
            "5",
        ),
    ],
)
def test_one_of_ten_thousand_is_found_in_few_steps(
    inside: str, said: str, value: str | None
) -> None:
    budget = Budget()
    assert answers(f"<grammar>{inside}</grammar>").match(said, budget) == value
    assert MOST_MATCHING - budget.steps < 40 * len(said.split()) + 40


def test_rules_may_follow_one_another_without_end() -> None:
    depth = 3_000
    rules = "".join(f'<rule id="r{i}"><ruleref uri="#r{i + 1}"/></rule>' for i in range(depth))
    grammar = f'<grammar>{rules}<rule id="r{depth}">yes<tag>7</tag></rule></grammar>'
    assert answers(grammar).match("Yes.") == "7"


def test_a_rule_that_ends_with_itself_takes_a_long_answer() -> None:
    digits = "".join(f"<item>{digit}</item>" for digit in range(10))
    grammar = (
        f'<grammar><rule id="d"><one-of>{digits}</one-of>'
        '<item repeat="0-1"><ruleref uri="#d"/></item></rule></grammar>'
    )
    said = " ".join("0123456789" * 20)
    assert answers(grammar).match(said) == said
    assert answers(grammar).match(f"{said} x") is None
