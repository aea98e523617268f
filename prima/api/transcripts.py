"""Transcripts: what a run has recorded, read from files or just made."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from numbers import Integral
from typing import TYPE_CHECKING, Any, TypeGuard

from prima.errors import UsageError
from prima.messages import Record

if TYPE_CHECKING:
    from pathlib import Path

    from prima.interpreter.bounds import ElementVisit
    from prima.transcript.measures import Measure, Summary
    from prima.transcript.record import Entry
    from prima.transcript.row import Row
    from prima.transcript.run import Run

# Modules that only some functions need are imported there, so that short commands start quickly.

LACKING = "a record lacks a field of its phase."


@dataclass(slots=True)
class Transcript:
    """The records of a run, times in seconds, with views of them."""

    records: list[Record]
    """Empty if they were not kept."""
    name: str = ""
    failures: list[str] = field(default_factory=list)
    """Applications that ended by an error, as ``NAME: ERROR``; empty after ``read`` and ``replay``."""
    defects: list[Exception] = field(default_factory=list)
    """Defects of PRIMA that ended applications; empty after ``read`` and ``replay``."""
    outcome: str = ""
    """How the run ended: ``over``, ``quiet``, ``until`` or ``limit``; empty if the records are cut off."""
    unfinished: list[str] = field(default_factory=list)
    """If a rehearsal was stopped at ``until``, the activity of each application still running."""
    cut: str = ""
    """The error in the line at which a partial transcript ends."""
    visits: list[ElementVisit] = field(default_factory=list)
    """The elements that applications reached in their documents, if they were kept."""
    measure: Measure | None = None
    """Counts made during the run."""

    made: list[Row] | None = None
    """The rows, if they were made during the run."""
    entries: list[Entry] = field(default_factory=list, repr=False, compare=False)
    """The records as the views see them, if they were kept so."""
    _run: Run | None = field(default=None, repr=False, compare=False)

    def kept(self) -> list[Record]:
        """The records.

        Raises:
            UsageError: they were not kept.
        """
        if not self.records:
            raise UsageError(f"{self.name}: its records were not kept: run it with keep=True.")
        return self.records

    def rows(self) -> list[Row]:
        """The rows of the table."""
        return rows_of(self.name, self.run().entries) if self.made is None else self.made

    def row(self, number: int) -> Row:
        """A row of the table by its number.

        Raises:
            UsageError: there is no such row.
        """
        if not is_whole(number):
            raise UsageError(f"number={number!r:.80}: write the number of a row.")
        rows = self.rows()
        if 0 <= number < len(rows):
            return rows[number]
        have = f"the rows are 0 to {len(rows) - 1}" if rows else "the transcript has none"
        message = f"{self.name}: there is no row {number}; {have}. {self.cut or self.early}"
        raise UsageError(message.rstrip())

    def run(self) -> Run:
        """The run as folded from its records, once.

        Raises:
            UsageError: a record lacks a field of its phase, or none were kept.
        """
        from prima.transcript.run import run_of

        if self._run is None or len(self._run.entries) != len(self.records):
            self._run = run_of(self.kept(), self.name)
        return self._run

    def table(self, why: bool = False, columns: int = 80) -> str:
        """The table as text, at most this wide if the names of applications allow it.

        With ``why``, each row has the rule that put it there.
        """
        from prima.transcript.table import format_rows

        [columns] = whole_numbers(0, needed=True, columns=columns)
        return format_rows(self.rows(), why, columns)

    def summary(self) -> Summary:
        """The counts and measures of the run.

        Raises:
            UsageError: a record lacks a field of its phase.
        """
        return (self.measure or self.run().measure).summary()

    @property
    def early(self) -> str:
        """A message that the records end before their run did; empty if not, or with ``cut``."""
        if self.cut or not self.records or self.records[0]["phase"] != "run":
            return ""
        last = self.records[-1]
        return "" if last["phase"] == "over" else ends_early(self.name, last["time"])

    def dumps(self) -> str:
        """The transcript as JSON lines."""
        from prima.transcript.lines import line

        made = ({**record, "time": record["time"] * 1000} for record in self.kept())
        return "".join(line(record) for record in made)


def check_transcripts(*given: object) -> None:
    """Refuse what is not a transcript, such as the path of one.

    Raises:
        UsageError: something is not.
    """
    for one in given:
        if not isinstance(one, Transcript):
            raise UsageError(f"{one!r:.80} is not a transcript: read it with prima.read.")


def whole_numbers(
    least: int = 1, most: int | None = None, /, needed: bool = False, **given: int | None
) -> list[Any]:
    """Whole numbers of any kind, such as NumPy's, as ``int``; None stays unless ``needed``.

    Raises:
        UsageError: a value is no whole number, or too small or too large.
    """
    limits = f"from {least}" if most is None else f"from {least} to {most}"
    made: list[int | None] = []
    for name, number in given.items():
        if number is None and not needed:
            made.append(None)
            continue
        whole = int(number) if is_whole(number) else least - 1
        if whole < least or (most is not None and whole > most):
            raise UsageError(f"{name}={number!r:.80}: write a whole number {limits}.")
        made.append(whole)
    return made


def is_whole(number: object) -> TypeGuard[int]:
    """Whether a value is a whole number, and not a truth value."""
    return isinstance(number, Integral) and not isinstance(number, bool)


def rows_of(name: str, entries: Iterable[Entry]) -> list[Row]:
    """The rows of a transcript.

    Raises:
        UsageError: a record lacks a field of its phase.
    """
    from prima.transcript.rows import make_rows

    try:
        return make_rows(entries)
    except (KeyError, TypeError, ValueError, AttributeError):
        raise UsageError(f"{name}: {LACKING}") from None


def ends_early(name: str, seconds: float) -> str:
    """The message for a transcript whose last record is not the end of its run."""
    return f"{name}: the transcript ends at {seconds:.3f} s, before its run did."


def outcome_of(records: Sequence[Record]) -> str:
    """How a run ended, by its last record; empty if that is not the end of the run."""
    last = records[-1] if records else {}
    return str(last.get("outcome", "")) if last.get("phase") == "over" else ""


def read(path: str | Path, partial: bool = False) -> Transcript:
    """Read a transcript; with ``partial``, up to its first unreadable line.

    Raises:
        UsageError: it cannot be read, or is not a transcript; the line is named.
    """
    from prima.loading.files import check_name

    cut: list[str] | None = [] if partial else None
    name = check_name(path)
    records = list(records_of(name, cut))
    return Transcript(records, name, outcome=outcome_of(records), cut=" ".join(cut or ()))


def skim(path: str | Path) -> Transcript:
    """Read a transcript up to its first unreadable line; keep only its rows and counts.

    Only the first and last records are kept, so that a long transcript takes much less memory
    than with :func:`read`.

    Raises:
        UsageError: it cannot be read, or is not a transcript; the line is named.
    """
    from prima.loading.files import check_name
    from prima.transcript.measures import Measure
    from prima.transcript.record import Entry

    name = check_name(path)
    cut: list[str] = []
    kept: list[Record] = []
    measure = Measure()

    def entries() -> Iterator[Entry]:
        for record in records_of(name, cut):
            kept[1:] = [record]
            entry = Entry(record)
            measure.add(entry)
            yield entry

    rows = rows_of(name, entries())
    return Transcript(
        kept, name, outcome=outcome_of(kept), cut=" ".join(cut), measure=measure, made=rows
    )


def records_of(path: str | Path, cut: list[str] | None) -> Iterator[Record]:
    """A transcript's records one by one; see :func:`read`."""
    from prima.loading.files import at_once, check_folder, readable
    from prima.transcript.lines import MAX_LINE, read_lines

    with readable(path):
        check_folder(path, "Name a transcript in it.")
        with open(path, encoding="utf-8-sig", errors="surrogateescape", opener=at_once) as stream:
            lines = iter(lambda: stream.readline(MAX_LINE + 2), "")
            yield from read_lines(str(path), lines, cut)
