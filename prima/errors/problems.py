"""Problems of documents: where, what is wrong, what to write instead, and the edits that do it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, Self

from prima.errors.words import counted

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


class Span(NamedTuple):
    """A piece of a file's text: from one line and column, counted from 1, to before another."""

    line: int
    column: int
    end_line: int
    end_column: int

    @classmethod
    def of(cls, place: Place, text: str) -> Self:
        """Text on one line that begins at a place."""
        return cls(place.line, place.column, place.line, place.column + len(text))


class Edit(NamedTuple):
    """Text in place of what a span holds; an empty span is where to insert it."""

    span: Span
    text: str


class Fix(NamedTuple):
    """What can be done at once: edits of the file in which the problem is."""

    title: str
    edits: tuple[Edit, ...]


class Hint(NamedTuple):
    """What to write instead, as a sentence and as fixes of which one may be chosen."""

    text: str = ""
    fixes: tuple[Fix, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.text)


class _Problem(NamedTuple):
    place: Place
    severity: Severity
    code: str
    message: str
    remedy: str = ""
    fixes: tuple[Fix, ...] = ()
    parameters: tuple[tuple[str, str], ...] = ()


class Problem(_Problem):
    """One thing wrong in a document, with what to write instead where that is known.

    ``parameters`` are the names and numbers in the message. A message or remedy that quotes very
    long names is cut in its middle: a name may be as long as a document, and be in thousands of
    messages. It has no fixes then.
    """

    __slots__ = ()

    def __new__(
        cls,
        place: Place,
        severity: Severity,
        code: str,
        message: str,
        remedy: str | Hint = "",
        fixes: tuple[Fix, ...] = (),
        parameters: tuple[tuple[str, str], ...] = (),
    ) -> Self:
        """A problem at a place; a hint as its remedy brings its fixes."""
        if isinstance(remedy, Hint):
            remedy, fixes = remedy
        short = len(message) <= LONGEST_TEXT and len(remedy) <= LONGEST_TEXT
        kept = fixes if short else ()
        texts = _brief(message), _brief(remedy)
        return super().__new__(cls, place, severity, code, *texts, kept, parameters)

    def __str__(self) -> str:
        remedy = f" {self.remedy}" if self.remedy else ""
        return f"{self.place}: {self.severity}: {self.message}{remedy} [{self.code}]"

    @property
    def sentence(self) -> tuple[Severity, str, str, str]:
        """What it says, wherever it is."""
        return self.severity, self.code, self.message, self.remedy

    def get(self, name: str) -> str:
        """A parameter, or nothing."""
        return dict(self.parameters).get(name, "")


def _brief(text: str) -> str:
    """A text of which, if it is very long, only the beginning and the end are left."""
    if len(text) <= LONGEST_TEXT:
        return text
    return text[: 2 * LONGEST_TEXT // 3] + CUT + text[-LONGEST_TEXT // 3 :]


def in_order(problems: Iterable[Problem]) -> list[Problem]:
    """Problems once each, in document order."""
    return sorted(dict.fromkeys(problems))  # a set would mix up what is nearly in order


def few(problems: list[Problem], most: int) -> list[Problem]:
    """At most so many of problems that say the same; the last of these tells how many more there are."""
    counts = Counter(problem.sentence for problem in problems)
    if max(counts.values(), default=0) <= most:
        return problems
    told: Counter[tuple[str, ...]] = Counter()
    kept: list[Problem] = []
    for problem in sorted(problems):
        alike = problem.sentence
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
