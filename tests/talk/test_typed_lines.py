"""Lines as they are typed: nonsense, completion, and answers that are known."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prima.devices.lines import LONGEST_LINE
from prima.errors import UsageError
from prima.grammar.answers import Answers
from prima.grammar.phrases import phrases
from prima.talk.typed import COMMANDS, TypedNames, complete, read_line
from tests.helpers.robot import document
from tests.helpers.talking import ASKS, room, start


# Lines -----------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("/tuch head", 'Unknown command "/tuch". Did you mean "/touch"?'),
        ("/touch", 'Write "/touch SENSOR".'),
        ("/touch hed", 'There is no touch sensor "hed". Did you mean "head"?'),
        ("/touch nose", 'There is no touch sensor "nose". There is back and head.'),
        ("/walk postr", 'There is no place or thing "postr". Did you mean "poster"?'),
        ("/walk 1", None),
        ("/walk 1 x", '"x" is not a number. Write digits, as in "1.5".'),
        ("/walk 5000 0", None),
        ("/walk", 'Write "/walk PLACE, /walk X Y".'),
        ("/look at nothing-here", None),
        ("/follow far", None),
        ("/message from Ann I'm late", 'Write "/message from NAME: TEXT".'),
        ("/message", 'Write "/message from NAME: TEXT".'),
        ("/message from", 'Write "/message from NAME: TEXT".'),
        ("/event", 'Write "/event NAME KEY=VALUE ...".'),
        ('/event corner a="b', "A quotation mark is not closed."),
        ("/event nothing.of.this.kind", None),
        ("/fail nose", None),
        ("/fail speaker often", 'Write "/fail DEVICE, /fail DEVICE hangs".'),
        ("/sensor light", 'Write "/sensor NAME=VALUE".'),
        ("/release maybe", None),
        ("/unload flow", 'There is no application "flow". Did you mean "follow"?'),
        ("/stay here", 'Nothing follows "/stay".'),
        ("/wait", 'Write "/wait TIME", as in "/wait 3s".'),
        ("/wait 3", '"3" is not a time. Write a number with its unit: "500ms" or "2.5s".'),
        ("/wait 3s /touch head", 'A line begins with an action: "/touch head /wait 3s /say Stop."'),
        ("/touch head /go", '"/go" must be alone on its line.'),
        ("/go on", 'Nothing follows "/go".'),
        ("/back", 'Write "/back TIME", as in "/back 5s".'),
        ("/back 900s", None),
        ("/why 99", 'There is no row "99"; the rows are 0 to 7.'),
        ("/why -1", None),
        ("/why \u00b2", None),
        ("/help tuch", 'Unknown command "/tuch". Did you mean "/touch"?'),
        ("/save", 'Write "/save FILE", as in "/save visit.xml".'),
        ("/save a\0b", "The line contains an invalid character: U+0000."),
        ("a\x1b[31mb", "The line contains an invalid character: U+001B."),
        ("x" * (LONGEST_LINE + 1), f"The line is longer than {LONGEST_LINE} characters."),
        ("\udcff", "The line contains an invalid character: U+DCFF."),
        ("/say", 'Write "/say TEXT".'),
    ],
)  # fmt: skip
def test_nonsense_is_answered_with_what_to_write(text: str, message: str | None) -> None:
    talk, paper = start()
    before = list(talk.game.records)
    talk.line(text)
    assert talk.wrong == 1, paper.told
    assert message is None or paper.told[-1] == message
    assert talk.game.records == before
    assert talk.game.lines == []


@settings(max_examples=300, deadline=None)
@given(st.one_of(st.text(max_size=60), st.sampled_from(sorted(COMMANDS)).flatmap(
    lambda name: st.text(max_size=20).map(lambda rest: f"/{name} {rest}"))))  # fmt: skip
def test_whatever_is_typed_is_read_or_refused(text: str) -> None:
    try:
        line = read_line(text)
    except UsageError:
        return
    assert line.xml or line.control


# Completion ------------------------------------------------------------------------
NAMES = TypedNames(
    frozenset({"head", "back"}), frozenset({"poster"}), applications=frozenset({"a"})
)


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("/t", ["/touch "]),
        ("/touch ", ["/touch back", "/touch head"]),
        ("/touch h", ["/touch head"]),
        ("/look at r", ["/look at robot"]),
        ("/touch head /wa", ["/touch head /walk ", "/touch head /wait "]),
        ("y", ["yes"]),
        ("", ["yes", "no"]),
        ("/nothing x", []),
    ],
)
def test_completion(text: str, lines: list[str]) -> None:
    assert complete(text, NAMES, ["yes", "no"]) == lines


def test_some_answers_to_a_question_are_known() -> None:
    answers = taken(
        '<option value="1">none</option><grammar><rule id="r"><ruleref uri="#f"/><tag>x</tag></rule>'
        '<rule id="f"><one-of><item>an apple</item><item>a <one-of><item>pear</item>'
        "<item>fig</item></one-of></item></one-of></rule></grammar>",
        "boolean",
    )
    assert phrases(answers) == ["none", "yes", "no", "an apple", "a pear", "a fig"]


def test_a_grammar_without_end_does_not_keep_anybody_waiting() -> None:
    again = '<ruleref uri="#r"/>' * 8
    grammar = f'<rule id="r"><one-of><item>{again}</item><item>a</item></one-of></rule>'
    began = time.monotonic()
    phrases(taken(f"<grammar>{grammar}</grammar>"))
    assert time.monotonic() - began < 2


def taken(inside: str, type: str = "text") -> Answers:
    """What a field takes that holds something."""
    named = "" if type == "text" else f' type="{type}"'
    made = document(
        f'<form id="f"><field name="a"{named}><prompt>?</prompt>{inside}</field></form>'
    )
    return made.forms["f"].items[0].answers  # type: ignore[attr-defined, no-any-return]


def test_the_options_of_the_question_are_offered(tmp_path: Path) -> None:
    talk, _ = start(room(tmp_path, ASKS))
    assert talk.options == ["yes", "no"]
