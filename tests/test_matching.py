"""Grammars of applications: an index of alternatives changes nothing but the time."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima.interpreter.grammar import (
    FEW,
    MAX_STEPS,
    Answers,
    Choice,
    Grammar,
    Matching,
    Part,
    Reference,
    Sequence,
    Tag,
    Words,
    fold,
)
from prima.interpreter.leads import index_choices
from tests.robot import document

MANY = 10_000
WORDS = ["a", "b", "a b", "ab", "é", "éa", "駅", "駅 a", "a駅", "3", "new york"]
SAID = st.lists(st.sampled_from([*WORDS, "york", "c", "3.5"]), max_size=5).map(" ".join)


def parts(depth: int = 3) -> st.SearchStrategy[Part]:
    """Parts of grammars with the rules r and s."""
    words = st.sampled_from(WORDS).map(lambda text: Words(fold(text)))
    leaves: st.SearchStrategy[Part] = st.one_of(
        words, words, st.sampled_from(["1", "2"]).map(Tag), st.sampled_from("rs").map(Reference)
    )
    if not depth:
        return leaves
    inner = st.deferred(lambda: parts(depth - 1))
    times = st.sampled_from([(1, 1), (0, 1), (2, 2), (0, 999), (1, 999), (0, 0)])
    return st.one_of(
        leaves,
        st.builds(lambda held, n: Sequence(held, *n), st.lists(inner, max_size=3), times),
        st.builds(Choice, st.lists(inner, max_size=4)),
        st.builds(
            lambda held: Choice([Sequence([part]) for part in held]),
            st.lists(inner, min_size=FEW + 1, max_size=FEW + 4),
        ),
    )


@given(parts(), parts(2), SAID)
@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
def test_an_index_leaves_out_no_alternative_that_matches(one: Part, two: Part, said: str) -> None:
    grammar = Grammar({"r": Sequence([one]), "s": Sequence([two])}, "r")
    without = Matching(grammar.rules, fold(said)).ends(Reference("r"), 0)
    index_choices(grammar)
    indexed = Matching(grammar.rules, fold(said)).ends(Reference("r"), 0)
    assert indexed == without


def answers(inside: str) -> Answers:
    """What a field with such a grammar takes."""
    made = document(f'<form id="f"><field name="a"><prompt>?</prompt>{inside}</field></form>')
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
            "early",
        ),
    ],
)
def test_one_of_ten_thousand_is_found_in_few_steps(
    inside: str, said: str, value: str | None
) -> None:
    grammar = answers(f"<grammar>{inside}</grammar>").grammars[0]
    assert grammar.match(said) == value
    matching = Matching(grammar.rules, fold(said))
    matching.ends(Reference(grammar.root), 0)
    assert MAX_STEPS - matching.left < 20 * len(said.split()) + 20


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
    said = " ".join("0123456789" * 50)
    assert answers(grammar).match(said) == said
    assert answers(grammar).match(f"{said} x") is None
