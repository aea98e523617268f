"""Suggestions: the known word nearest to an unknown one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import islice

from prima.errors.problems import Edit, Fix, Hint, Span

MANY_LETTERS, MANY_WORDS = 60, 300
"""Limits of words that are compared, to bound the time."""
SHORTEST = 3
"""Letters that a word has at least to abbreviate another."""
ESCAPED = str.maketrans({"&": "&amp;", "<": "&lt;", '"': "&quot;", "'": "&apos;"})
"""Characters that an attribute's value may not contain as they are."""
MOST_COMPARED = 30_000
"""Maximum number of comparisons for one document."""


@contextmanager
def few_guesses() -> Iterator[None]:
    """Bound the comparisons while a document is checked."""
    token = _guesses.set(_Guesses())
    try:
        yield
    finally:
        _guesses.reset(token)


class _Guesses:
    """The number of comparisons left for one document."""

    def __init__(self) -> None:
        self.left = MOST_COMPARED


_guesses: ContextVar[_Guesses | None] = ContextVar("guesses", default=None)


def guessable(word: str, known: Iterable[str]) -> list[str]:
    """The words that may be compared with another, in order.

    None if there are too many, or if too much has been guessed at a document (:func:`few_guesses`).
    """
    guesses = _guesses.get()
    if len(word) > MANY_LETTERS or (guesses is not None and guesses.left < 0):
        return []
    words = list(islice(known, MANY_WORDS + 1))
    if guesses is not None:
        guesses.left -= len(words)
    return sorted(words) if len(words) <= MANY_WORDS else []


def nearest_word(word: str, known: Iterable[str], alike_from: float = 0.6) -> str:
    """The known word most similar to another, or the only one that it abbreviates; or nothing.

    ``alike_from`` is the least similarity, from 0 to 1.
    """
    words, folded = guessable(word, known), word.casefold()
    alike = [one for one in words if one.casefold() == folded]
    if not alike and len(word) >= SHORTEST:
        begun = [one for one in words if one.casefold().startswith(folded)]
        alike = begun if len(begun) == 1 else []
    if words and not alike:
        from difflib import get_close_matches  # costs a third of a start, and is rarely needed

        alike = get_close_matches(word, words, n=1, cutoff=alike_from)
    return alike[0] if alike else ""


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """``Did you mean "x"?`` with the known word nearest to ``word``, or nothing."""
    return meant(nearest_word(word, known)).text


def suggestion(word: str, known: Iterable[str], *spans: Span) -> Hint:
    """The same as a hint, with a fix that writes the known word into some spans."""
    return meant(nearest_word(word, known), *spans)


def meant(word: str, *spans: Span) -> Hint:
    """A hint that suggests a word and writes it into some spans; nothing without a word."""
    text, title = f'Did you mean "{word}"?', f'Change to "{word}"'
    return replaced(text, word.translate(ESCAPED), *spans, title=title) if word else Hint()


def replaced(text: str, word: str, *spans: Span, title: str = "") -> Hint:
    """A sentence, with a fix that writes a word into some spans."""
    if not spans:
        return Hint(text)
    edits = tuple(Edit(span, word) for span in spans)
    return Hint(text, (Fix(title or f'Change to "{word}"', edits),))
