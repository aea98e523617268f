"""What can go wrong, divided by who broke the rule.

The *author* of a document gets a list of :class:`Problem`, all at once, inside
a :class:`DocumentError`. Whoever called the program wrongly, or named something
that cannot be read or written, gets a :class:`UsageError`. A run that had to be
given up is a :class:`RunError`. What a robot or a service does wrong is no
exception at all but an event that a document can handle; what the programmer
does wrong is an assertion.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import islice
from typing import Literal, NamedTuple, Self

TOO_MUCH = (
    "the run made more records, or more text, than a run may."
    " Let what comes again and again in it wait longer each time, or end the run earlier (until)."
)
"""Why a run ends that goes past its limits, and what an author can do."""
MANY_LETTERS, MANY_WORDS = 60, 300
"""Beyond these no guess is made at what was meant: it would take too long."""
MOST_COMPARED = 30_000
"""Pairs of words that are compared for the guesses at one document."""

MOST_TOLD = 1_000
"""Problems that are listed; the others are counted."""

LONGEST_TEXT = 450
"""Characters of a message or remedy beyond which its middle is left out."""
CUT = " [...] "
"""What is there in place of the middle of a text."""

Severity = Literal["error", "warning", "note"]
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")
"""The worst first."""


class Place(NamedTuple):
    """Where something stands: a file, and a line and column counted from 1.

    Columns count characters, not bytes.
    """

    file: str
    line: int = 1
    column: int = 1

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class _Problem(NamedTuple):
    place: Place
    severity: Severity
    code: str
    message: str
    remedy: str = ""


class Problem(_Problem):
    """One thing wrong in a document, with what to write instead where that is known.

    A message or remedy that quotes very long names is cut in its middle: a name may be as long as a
    document, and be in thousands of messages.
    """

    __slots__ = ()

    def __new__(
        cls, place: Place, severity: Severity, code: str, message: str, remedy: str = ""
    ) -> Self:
        """A problem at a place."""
        return super().__new__(cls, place, severity, code, _brief(message), _brief(remedy))

    def __str__(self) -> str:
        remedy = f" {self.remedy}" if self.remedy else ""
        return f"{self.place}: {self.severity}: {self.message}{remedy} [{self.code}]"


def _brief(text: str) -> str:
    """A text of which, if it is very long, only the beginning and the end are left."""
    if len(text) <= LONGEST_TEXT:
        return text
    return text[: 2 * LONGEST_TEXT // 3] + CUT + text[-LONGEST_TEXT // 3 :]


class PrimaError(Exception):
    """The root of every error that the package raises on purpose."""


class DocumentError(PrimaError):
    """Documents are wrong; ``problems`` says all of it, in document order."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = sorted(problems)
        super().__init__("\n".join(map(str, listed(self.problems))))


class UsageError(PrimaError):
    """The caller asked for something that is not there or makes no sense."""


class RunError(PrimaError):
    """A run was ended by an error or a limit; what it had recorded is kept."""


@contextmanager
def few_guesses() -> Iterator[None]:
    """Let only so many guesses be made meanwhile, however much is wrong with a document."""
    token = _guesses.set(_Guesses())
    try:
        yield
    finally:
        _guesses.reset(token)


class _Guesses:
    """How many comparisons are left for the guesses at one document."""

    def __init__(self) -> None:
        self.left = MOST_COMPARED


_guesses: ContextVar[_Guesses | None] = ContextVar("guesses", default=None)


def guessable(word: str, known: Iterable[str]) -> list[str]:
    """The words among which it may be looked for what was meant by another, in order.

    None if there are too many, or if too much has been guessed at a document (:func:`few_guesses`).
    """
    guesses = _guesses.get()
    if len(word) > MANY_LETTERS or (guesses is not None and guesses.left < 0):
        return []
    words = list(islice(known, MANY_WORDS + 1))
    if guesses is not None:
        guesses.left -= len(words)
    return sorted(words) if len(words) <= MANY_WORDS else []


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Give ``Did you mean "x"?`` for the known word nearest to ``word``, or nothing."""
    words = guessable(word, known)
    alike = [one for one in words if one.casefold() == word.casefold()]
    if words and not alike:
        from difflib import get_close_matches  # costs a third of a start, and is rarely needed

        alike = get_close_matches(word, words, n=1, cutoff=0.6)
    return f'Did you mean "{alike[0]}"?' if alike else ""


def in_order(problems: Iterable[Problem]) -> list[Problem]:
    """Problems once each, in document order."""
    return sorted(dict.fromkeys(problems))  # a set would mix up what is nearly in order


def few(problems: list[Problem], most: int) -> list[Problem]:
    """At most so many of problems that say the same; the last of these tells how many more there are."""
    counts = Counter(problem[1:] for problem in problems)
    if max(counts.values(), default=0) <= most:
        return problems
    told: Counter[tuple[str, ...]] = Counter()
    kept: list[Problem] = []
    for problem in sorted(problems):
        alike = problem[1:]
        told[alike] += 1
        if told[alike] == most and counts[alike] > most:
            more = f"So it is at {counted(counts[alike] - most, 'more place')}."
            problem = problem._replace(remedy=f"{problem.remedy} {more}".strip())
        if told[alike] <= most:
            kept.append(problem)
    return kept


def listed(problems: Sequence[Problem], most: int = MOST_TOLD) -> list[Problem]:
    """So many of the problems, errors before all others, and one that says how many there are more.

    They keep their order.
    """
    if len(problems) <= most:
        return list(problems)
    worst = sorted(range(len(problems)), key=lambda at: SEVERITIES.index(problems[at].severity))
    left = [problems[at] for at in sorted(worst[most:])]
    counts = Counter(one.severity for one in left)
    kinds = [counted(counts[kind], kind) for kind in SEVERITIES if counts[kind]]
    message = f"And {counted(len(left), 'more problem')}: {', '.join(kinds)}."
    remedy = f"Mend those before, or raise the limit: --limit problems={len(problems)}."
    severity = problems[worst[most]].severity
    more = Problem(left[0].place, severity, "more-problems", message, remedy)
    return [*(problems[at] for at in sorted(worst[:most])), more]


def parted(text: str) -> tuple[str, str]:
    """A sentence that says what is wrong, and the rest, which says what to write instead."""
    wrong, stop, remedy = text.partition(". ")
    return (f"{wrong}.", remedy) if stop else (text, "")


def counted(number: int, noun: str) -> str:
    """A number with its noun: ``1 reaction``, ``2 reactions``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def one_of(words: Iterable[str]) -> str:
    """Join words for a message: ``a, b or c``."""
    *head, last = sorted(words) or [""]
    return f"{', '.join(head)} or {last}" if head else last
