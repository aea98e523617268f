"""Both languages interpret forms as the algorithm of VoiceXML's appendix C does."""

from __future__ import annotations

import os
import re
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.helpers.fia.algorithm import OUTSIDE, Run, TooLong
from tests.helpers.fia.author import Author
from tests.helpers.fia.documents import FIRST, pages, written
from tests.helpers.robot import Bench, close_sessions
from tests.helpers.voice import Call

many = settings(
    max_examples=int(os.environ.get("PRIMA_EXAMPLES", "300")) * 2,
    derandomize=os.environ.get("CI") == "true",
    deadline=None,
    database=None,
)
"""A document takes a few ms."""


def followed(bench: Bench, answers: list[str | None]) -> tuple[list[str], list[str], bool]:
    """What an application said and logged, and whether it has ended, when the user said this."""
    for answer in answers:
        bench.play()
        asks = bench.session.mediator.question() is not None
        if not asks and answer not in OUTSIDE:
            break
        if asks and answer is not None:
            bench.listens()
        if answer in OUTSIDE:
            bench.event(str(answer))
        elif answer is None:
            bench.silence()
        else:
            bench.hears(answer)
    bench.play()
    said = re.findall(r"\bp\d+\b", " ".join(bench.said()))  # others are the platform's
    return said, [one for one in bench.logs() if re.match(r"l\d+\b", one)], bool(bench.ended)


def expected(author: Author) -> Run | None:
    """The same by the algorithm; None if the application does very much at once."""
    documents, answers = author.documents(), author.answers()
    try:
        return Run(documents, answers, author.voice)
    except TooLong:
        return None


@many
@given(st.integers(0, 10**9))
def test_of_forms(seed: int) -> None:
    author = Author(Random(seed), voice=False)
    found = expected(author)
    if found is not None:
        text = "".join(written(one, False) for one in found.documents[FIRST].holds)
        got = followed(Bench(text), found.given)
        close_sessions()
        assert got == (found.said, found.logs, found.ended)


@many
@given(st.integers(0, 10**9))
def test_of_voicexml(seed: int) -> None:
    author = Author(Random(seed), voice=True)
    found = expected(author)
    if found is not None:
        texts = pages(found.documents)
        got = followed(Call(texts.pop(FIRST), **texts), found.given)
        close_sessions()
        assert got == (found.said, found.logs, found.ended)
