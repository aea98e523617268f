"""Tags that do not match: what the fix writes, and where."""

from __future__ import annotations

import pytest

from prima.errors import DocumentError, Problem
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.lsp.text import Lines
from prima.markup.reader import parse


def problem(text: str) -> Problem:
    with pytest.raises(DocumentError) as told:
        parse("a.xml", text.encode(), (DIALOGUE,))
    (found,) = told.value.problems
    return found


def fixed(text: str) -> str:
    """The text with the fix of its only problem."""
    ((_, (edit,)),) = problem(text).fixes
    start, end = Lines(text).offsets(edit.span)
    return text[:start] + edit.text + text[end:]


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        # before what may not be in it, and not where its parent ends
        ("<on><exit/>\n<on>é<exit/></on></form>", "<on><exit/></on>\n<on>é<exit/></on></form>"),
        ("<block><speak>A <exit/></block></form>", "<block><speak>A</speak> <exit/></block></form>"),
        # after everything that may be in it
        ("<block><exit/></form>", "<block><exit/></block></form>"),
        # its beginning is missing: an end tag more does not help
        ("<block>Hi.</speak></block></form>", "<block>Hi.</block></form>"),
        ("<block><exit/></block></if ></form>", "<block><exit/></block></form>"),
        # it lacks its slash
        ("<block><speak>A<speak><exit/></block></form>", "<block><speak>A</speak><exit/></block></form>"),
        # its name is not the one that it ends, though another tag has that
        ("<block><speak/><speak>A</speaks></block></form>", "<block><speak/><speak>A</speak></block></form>"),
        # an element that holds nothing
        ("<block><exit></block></form>", "<block><exit/></block></form>"),
    ],
)  # fmt: skip
def test_the_fix_of_tags_that_do_not_match(wrong: str, right: str) -> None:
    text = f'<prima xmlns="urn:prima:dialogue:1">\n<form id="日本">{wrong}</prima>'
    made = fixed(text)
    assert made == text.replace(wrong, right)
    parse("a.xml", made.encode(), (DIALOGUE,))


def test_a_text_that_ends_with_a_tag_without_its_slash() -> None:
    begin = "<prima>\n<form><block><exit/></block></form>"
    assert fixed(f"{begin}<prima>\n") == f"{begin}</prima>\n"
    assert fixed(f"{begin}\n") == f"{begin}</prima>\n"
