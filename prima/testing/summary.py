"""Test results as text."""

from __future__ import annotations

from collections.abc import Iterable

from prima.errors import counted
from prima.errors.rendering import excerpt
from prima.errors.visible import visible
from prima.testing.checking import Failure
from prima.testing.running import Result
from prima.testing.sources import SourceLines

WORDS = {"passed": "passed", "failed": "FAILED", "error": "ERROR", "invalid": "INVALID"}


def format_failure(failure: Failure, sources: SourceLines) -> str:
    """A failure: place, message, source line with a caret, and rows of the run."""
    place = failure.place
    parts = [f"{place}: {visible(failure.message)}"]
    line = sources.line(place.file, place.line)
    if line.strip():
        shown, under = excerpt(line, place.column)
        parts += [f"{place.line:>5} | {shown}", f"      | {under}"]
    if failure.rows:
        parts.append(failure.rows.rstrip("\n"))
    return "\n".join(parts)


def format_result(result: Result) -> str:
    """The failures of a result, and the difference of its table."""
    sources = SourceLines()
    parts = [format_failure(one, sources) for one in result.failures]
    if result.golden == "differs":
        parts.append(f"{result.file}: the run's table differs:\n{result.difference}")
    return "\n\n".join(parts)


def row(result: Result, wide: int) -> str:
    """A result as one line."""
    return f"{WORDS[result.status]:<7}  {result.path:<{wide}}  {_checked(result)}".rstrip()


def _checked(result: Result) -> str:
    """The outcome of the checks, in words."""
    if result.status == "invalid":
        return "documents have errors"
    wrong = len({(one.place.line, one.place.column) for one in result.failures})
    parts = []
    if result.expectations:
        many = counted(result.expectations, "expectation")
        parts.append(f"{wrong} of {many}" if wrong and result.status == "failed" else many)
    words = {
        "same": "table as expected",
        "differs": "table differs",
        "skipped": "table not compared",
    }
    if result.golden:
        parts.append(words[result.golden])
    if result.status == "error":
        parts.append("the run ended by an error")
    return ", ".join(parts) or "no expectations; it ran"


def counts(results: Iterable[Result]) -> dict[str, int]:
    """The number of results of each status."""
    found = dict.fromkeys(WORDS, 0)
    for result in results:
        found[result.status] += 1
    return found


def summary(results: list[Result]) -> str:
    """All results as one line."""
    tally = ", ".join(f"{status}: {n}" for status, n in counts(results).items() if n)
    return f"scenarios: {len(results)}; {tally}"
