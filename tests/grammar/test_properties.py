"""The grammar engine over made-up grammars and utterances: both forms agree, values keep form."""

from __future__ import annotations

import re
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prima.grammar import load
from prima.grammar.answers import Answers
from prima.grammar.phrases import phrases
from tests.helpers.grammars import SCRIPT

SRGS = "http://www.w3.org/2001/06/grammar"
QUICK = settings(max_examples=100, deadline=None, suppress_health_check=list(HealthCheck))
SAID = ["", "a", "b", "a a", "a b", "b a", "b b", "a b c", "b b a", "c c c", "a c b"]
REPEATS = ["0", "0-1", "1", "2", "1-3", "0-", "1-"]


@st.composite
def expansions(draw: st.DrawFn, depth: int = 3) -> tuple[str, str]:
    """An expansion in ABNF, and the same in XML."""
    kind = draw(st.integers(0, 6 if depth else 1))
    if kind <= 1:
        return draw(
            st.sampled_from(
                [
                    ("a", "<token>a</token>"),
                    ('"b"', '"b"'),
                    ("c", " c "),
                    ("a!en", '<token xml:lang="en">a</token>'),
                    ("()", "<item/>"),
                    ("$s", '<ruleref uri="#s"/>'),
                    ("$r", '<ruleref uri="#r"/>'),
                    ("$NULL", '<ruleref special="NULL"/>'),
                    ("$VOID", '<ruleref special="VOID"/>'),
                    ("$GARBAGE", '<ruleref special="GARBAGE"/>'),
                    ("{one}", "<tag>one</tag>"),
                    ("{!{two}!}", "<tag><![CDATA[two]]></tag>"),
                ]
            )
        )
    inner = [draw(expansions(depth - 1)) for _ in range(draw(st.integers(1, 3)))]
    if kind <= 3:
        weights = [draw(st.sampled_from(["", "1", "0.5", ".25", "3."])) for _ in inner]
        abnf = " | ".join(
            f"/{weight}/ {one}" if weight else one
            for weight, (one, _) in zip(weights, inner, strict=True)
        )
        items = "".join(
            f'<item weight="{weight}">{one}</item>' if weight else f"<item>{one}</item>"
            for weight, (_, one) in zip(weights, inner, strict=True)
        )
        return f"({abnf})", f"<one-of>{items}</one-of>"
    if kind == 4:
        times = draw(st.sampled_from(REPEATS))
        chance = draw(st.sampled_from(["", ".3", "1"]))
        abnf = f"({inner[0][0]})<{times}{f' /{chance}/' if chance else ''}>"
        likely = f' repeat-prob="{chance}"' if chance else ""
        return abnf, f'<item repeat="{times}"{likely}>{inner[0][1]}</item>'
    if kind == 5:
        return f"[{inner[0][0]}]", f'<item repeat="0-1">{inner[0][1]}</item>'
    return f"({' '.join(one for one, _ in inner)})", f"<item>{''.join(x for _, x in inner)}</item>"


@QUICK
@given(expansions(), expansions())
def test_both_forms_take_and_mean_the_same(one: tuple[str, str], two: tuple[str, str]) -> None:
    abnf = load(
        "#ABNF 1.0;\nlanguage en;\nroot $r;\ntag-format <semantics/1.0-literals>;\n"
        f"$r = {one[0]};\n$s = {two[0]};\n"
    )
    xml = load(
        f'<grammar xmlns="{SRGS}" version="1.0" xml:lang="en" root="r" '
        f'tag-format="semantics/1.0-literals"><rule id="r"><item>{one[1]}</item></rule>'
        f'<rule id="s"><item>{two[1]}</item></rule></grammar>'
    )
    for said in SAID:
        found = [
            [(match.text, match.interpretation, match.weight) for match in grammar.match(said)]
            for grammar in (abnf, xml)
        ]
        assert found[0] == found[1], (said, one, two)


@QUICK
@given(expansions(), expansions())
def test_phrases_that_are_offered_are_taken(one: tuple[str, str], two: tuple[str, str]) -> None:
    grammar = load(f"#ABNF 1.0;\nlanguage en;\nroot $r;\n$r = {one[0]};\n$s = {two[0]};\n")
    for phrase in phrases(Answers(grammars=[grammar])):
        assert grammar.match(phrase), (phrase, one, two)


Rule = list[Any]
"""Words and tags in order, as letters, and the rules that are referred to."""

RULES: st.SearchStrategy[Rule] = st.recursive(
    st.lists(st.sampled_from(["word", "tag"]), max_size=4),
    lambda inner: st.lists(st.one_of(st.sampled_from(["word", "tag"]), inner), max_size=4),
    max_leaves=12,
)


@QUICK
@given(RULES)
def test_tags_run_from_left_to_right(top: Rule) -> None:
    rules: list[str] = []
    words: list[str] = []
    log: list[int] = []

    def write(rule: Rule) -> int:
        number = len(rules)
        rules.append("")
        parts: list[str] = []
        for one in [*rule, "word", "tag"]:
            if one == "word":
                words.append("x")
                parts.append("x")
            elif one == "tag":
                log.append(number)
                parts.append(f"{{log.push({number}); out = log}}")
            else:
                parts.append(f"$r{write(one)}")
        rules[number] = f"$r{number} = {' '.join(parts)};"
        return number

    write(top)
    text = SCRIPT.replace("root $r;", "root $r0;") + "{var log = []};\n" + "\n".join(rules)
    (found,) = load(text).match(" ".join(words))
    assert (found.error, found.interpretation) == (None, log)


def test_phrases_repeat_what_is_needed() -> None:
    grammar = load("#ABNF 1.0;\nlanguage en;\nroot $r;\n$r = (a | b)<2-3> c<0-> | x<1000000000>;\n")
    assert phrases(Answers(grammars=[grammar]))[:4] == ["a a", "a b", "b a", "b b"]


FORMS = {
    "boolean": r"True|False",
    "currency": r"([A-Z]{3})?\d+\.\d\d",
    "date": r"(\d{4}|\?{4})(\d\d|\?\?)(\d\d|\?\?)",
    "digits": r"\d+",
    "number": r"[+-]?\d+(\.\d+)?",
    "phone": r"\d+(x\d+)?",
    "time": r"((0[1-9]|1[012])[0-5]\d[ap?]|([01]\d|2[0-3])[0-5]\dh)",
}
"""The values of built-in types (VoiceXML 2.0 Appendix P)."""
WORDS = re.findall(
    r"\S+",
    """
    a an and one two five twelve twenty thirty ninety hundred thousand million oh zero double
    point minus plus first third fifth may march the of in half past to quarter noon midnight
    o'clock am p.m. hours morning at night dollars euros cents pence us canadian extension x
    ext yes no not right 1 07 12 30 1999 2004 12:30 3.5 .5 1,000 $ € - + * # / 年 月 三 十 時 半 円
    午後
    """,
)


@pytest.mark.parametrize("name", FORMS)
@QUICK
@given(said=st.lists(st.sampled_from(WORDS), max_size=7), apart=st.sampled_from([" ", ""]))
def test_values_of_built_in_types_are_as_their_appendix_writes_them(
    name: str, said: list[str], apart: str
) -> None:
    grammar = load(name)
    for text, mode in ((apart.join(said), "voice"), ("".join(said), "dtmf")):
        for match in grammar.match(text, mode=mode):
            assert re.fullmatch(FORMS[name], str(match.interpretation)), (text, match)


@QUICK
@given(st.text(alphabet="<>/=\"& \nabcrgruletokenitm-#:'!?[]", max_size=80))
def test_any_text_in_a_rule_in_xml_is_read_or_refused(text: str) -> None:
    from prima.grammar import GrammarError

    head = f'<grammar xmlns="{SRGS}" version="1.0" xml:lang="en" root="r"><rule id="r">'
    try:
        load(f"{head}{text}</rule></grammar>").match("a b")
    except GrammarError as error:
        assert error.problems
