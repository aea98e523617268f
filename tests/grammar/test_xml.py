"""Elements and text of grammars in the XML form that are in the wrong place: what to do about them."""

from __future__ import annotations

import pytest

from prima.grammar import GrammarError, load
from prima.grammar.vocabulary import SRGS
from prima.markup.limits import LIMITS

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
        ("", "a<grammar/>", "<grammar> is not allowed in <rule>.", "It begins a document: give it its own file."),
        ("", "<token>a<b/></token>", "<b> is not allowed in <token>.", ""),
        ("", "<item xmlns=''>a</item>", "<item> is in another namespace than <rule>.", f'Declare xmlns="{SRGS}".'),
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


@pytest.mark.parametrize(
    ("header", "remedy"),
    [
        ("<lexicon/>", 'Write <lexicon uri="words.pls"/>.'),
        ("<meta name='a'/>", 'Write <meta name="author" content="..."/>.'),
        ("<meta name='a' http-equiv='b' content='c'/>", 'Write <meta name="author" content="..."/>.'),
    ],
)  # fmt: skip
def test_what_a_header_lacks_is_told_with_what_to_write(header: str, remedy: str) -> None:
    with pytest.raises(GrammarError) as caught:
        load(GRAMMAR.format(header, "a"))
    (problem,) = caught.value.problems
    assert (problem.code, problem.remedy) == ("missing-attribute", remedy)


def test_metadata_holds_what_it_likes() -> None:
    metadata = '<metadata><x:a xmlns:x="urn:x">text</x:a><item/></metadata>'
    assert load(GRAMMAR.format(metadata, "a")).match("a")


def test_words_alone_are_told_how_to_be_a_grammar() -> None:
    with pytest.raises(GrammarError) as caught:
        load(f'<grammar xmlns="{SRGS}" version="1.0" xml:lang="en">just words</grammar>')
    (problem,) = caught.value.problems
    assert (problem.code, problem.place.column) == ("stray-text", 80)
    assert problem.remedy.startswith("Write it in SRGS: rules in XML,")


def test_grammars_are_as_deep_as_documents_may_be(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(LIMITS, "depth", 200)
    inside = "<item>" * 198 + "a" + "</item>" * 198
    assert load(GRAMMAR.format("", inside)).match("a")


def test_a_rule_that_is_not_there_is_told_with_those_that_are() -> None:
    with pytest.raises(GrammarError) as caught:
        load(GRAMMAR.format("", "a"), rule="q")
    (problem,) = caught.value.problems
    assert (problem.message, problem.remedy) == ('There is no rule "q".', "Write r.")
