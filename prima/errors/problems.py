"""Problems of documents: place, message, remedy, and fixes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, Self

from prima.errors.words import counted

MOST_TOLD = 1_000
"""Maximum number of similar problems listed; others are counted."""

LONGEST_TEXT = 450
"""Length of a message or remedy above which its middle is omitted."""
CUT = " [...] "
"""Replaces the middle of a long text."""

Severity = Literal["error", "warning", "note"]
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")
"""Severities, worst first."""


class Place(NamedTuple):
    """A place: a file, and a line and column counted from 1.

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
        """The span of a text on one line that begins at a place."""
        return cls(place.line, place.column, place.line, place.column + len(text))


class Edit(NamedTuple):
    """Text that replaces a span; an empty span is an insertion."""

    span: Span
    text: str


class Fix(NamedTuple):
    """A fix: edits of the file with the problem."""

    title: str
    edits: tuple[Edit, ...]


class Hint(NamedTuple):
    """A remedy: a sentence, and alternative fixes."""

    text: str = ""
    fixes: tuple[Fix, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.text)


class _Problem(NamedTuple):
    place: Place
    """The file, line and column."""
    severity: Severity
    """``error``, ``warning`` or ``note``."""
    code: str
    """The name by which docs/codes.md explains it."""
    message: str
    """The problem, as a sentence."""
    remedy: str = ""
    """How to mend it."""
    fixes: tuple[Fix, ...] = ()
    """Alternative edits of the file that mend it."""
    parameters: tuple[tuple[str, str], ...] = ()
    """The names and numbers in the message."""


class Problem(_Problem):
    """One problem of a document, with a remedy if one is known.

    A message or remedy that quotes very long names is cut in its middle, as a name may be as long
    as a document, and occur in thousands of messages. Then there are no fixes.
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
        texts = brief(message), brief(remedy)
        return super().__new__(cls, place, severity, code, *texts, kept, parameters)

    def __str__(self) -> str:
        remedy = f" {self.remedy}" if self.remedy else ""
        return f"{self.place}: {self.severity}: {self.message}{remedy} [{self.code}]"

    @property
    def sentence(self) -> tuple[Severity, str, str, str]:
        """Its identity, apart from its place."""
        return self.severity, self.code, self.message, self.remedy

    def get(self, name: str) -> str:
        """A parameter, or nothing."""
        return dict(self.parameters).get(name, "")


def brief(text: str, longest: int = LONGEST_TEXT) -> str:
    """A text; if it has more letters than ``longest``, only its beginning and end."""
    if len(text) <= longest:
        return text
    return text[: 2 * longest // 3] + CUT + text[-longest // 3 :]


def has_errors(problems: Iterable[Problem]) -> bool:
    """Whether some problem is an error, and not only a warning or note."""
    return any(problem.severity == "error" for problem in problems)


def in_order(problems: Iterable[Problem]) -> list[Problem]:
    """Problems without duplicates, in document order."""
    return sorted(dict.fromkeys(problems))  # a set would mix up what is nearly in order


def few(problems: list[Problem], most: int) -> list[Problem]:
    """Limit the problems with the same message; the last one counts those omitted."""
    counts = Counter(problem.sentence for problem in problems)
    if max(counts.values(), default=0) <= most:
        return problems
    reported: Counter[tuple[str, ...]] = Counter()
    kept: list[Problem] = []
    for problem in sorted(problems):
        alike = problem.sentence
        reported[alike] += 1
        if reported[alike] == most and counts[alike] > most:
            more = f"So it is at {counted(counts[alike] - most, 'more place')}."
            problem = problem._replace(remedy=f"{problem.remedy} {more}".strip())
        if reported[alike] <= most:
            kept.append(problem)
    return kept


def listed(problems: Sequence[Problem], most: int = MOST_TOLD) -> list[Problem]:
    """The first problems, errors before all others, and one that counts those omitted.

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
