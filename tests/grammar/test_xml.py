"""Elements and text of grammars in the XML form that are in the wrong place: what to do about them."""

from __future__ import annotations

import pytest

from prima.grammar import GrammarError, load
from prima.grammar.vocabulary import SRGS

GRAMMAR = f'<grammar xmlns="{SRGS}" version="1.0" xml:lang="en" root="r">{{}}<rule id="r">{{}}</rule></grammar>'


@pytest.mark.parametrize(
    ("around", "inside", "message", "remedy"),
    [
        ("<item>a</item>", "a", "<item> is not allowed in <grammar>.", "Put it in a <rule>."),
        ("a", "a", "Text is not allowed in <grammar>.", "Put it in a <rule>."),
        ("", "<one-of>a<item>b</item></one-of>", "Text is not allowed in <one-of>.", "Put it in an <item>."),
        ("", "<one-of><tag>1</tag><item>b</item></one-of>", "<tag> is not allowed in <one-of>.", "Put it in an <item>."),
        ("", 'a<rule id="q">b</rule>', "<rule> is not allowed in <rule>.", "Close the first <rule> before this one."),
        ("", "a<lexicon uri='l'/>", "<lexicon> is not allowed in <rule>.", "It is allowed in <grammar>."),
        ("", "a<tag><example/></tag>", "<example> is not allowed in <tag>.", "It is allowed in <rule>."),
        ("", "<token>a<b/></token>", "<b> is not allowed in <token>.", ""),
        ("", "<ruleref special='NULL'>a</ruleref>", "Text is not allowed in <ruleref>.", "Remove it."),
    ],
)  # fmt: skip
def test_what_is_misplaced_is_told_with_its_place(
    around: str, inside: str, message: str, remedy: str
) -> None:
    with pytest.raises(GrammarError) as caught:
        load(GRAMMAR.format(around, inside))
    (problem,) = caught.value.problems
    assert (problem.message, problem.remedy) == (message, remedy)


def test_metadata_holds_what_it_likes() -> None:
    metadata = '<metadata><x:a xmlns:x="urn:x">text</x:a><item/></metadata>'
    assert load(GRAMMAR.format(metadata, "a")).match("a")
