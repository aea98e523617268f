"""Both languages interpret forms as the algorithm of VoiceXML's appendix C does."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.helpers.fia.algorithm import OUTSIDE, Run, TooLong
from tests.helpers.fia.author import Author
from tests.helpers.fia.documents import FIRST, El, pages, written
from tests.helpers.robot import Bench, close_sessions
from tests.helpers.voice import Call

many = settings(
    max_examples=int(os.environ.get("PRIMA_EXAMPLES", "300")) * 4,
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


def native(documents: Mapping[str, El]) -> Bench:
    """An application in PRIMA's own language."""
    return Bench("".join(written(one, False) for one in documents[FIRST].holds))


def called(documents: Mapping[str, El]) -> Bench:
    """A VoiceXML application."""
    texts = pages(documents)
    return Call(texts.pop(FIRST), **texts)


@many
@given(st.integers(0, 10**9), st.sampled_from([native, called]))
def test_random_forms(seed: int, begin: Callable[[Mapping[str, El]], Bench]) -> None:
    author = Author(Random(seed), voice=begin is called)
    documents, answers = author.documents(), author.answers()
    try:
        run = Run(documents, answers, author.voice)
    except TooLong:
        return  # it does very much at once, as the limits do not let it
    got = followed(begin(documents), answers)
    close_sessions()
    assert got == (run.said, run.logs, run.ended)
