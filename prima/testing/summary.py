"""Results of tests as people read them."""

from __future__ import annotations

from collections.abc import Iterable

from prima.errors import DocumentError, UsageError
from prima.errors.rendering import excerpt
from prima.errors.visible import visible
from prima.loading.files import read_file
from prima.markup.reader import decode
from prima.testing.checking import Failure
from prima.testing.running import Result

WORDS = {"passed": "passed", "failed": "FAILED", "error": "ERROR", "invalid": "INVALID"}


class Sources:
    """The lines of files, each file read once."""

    def __init__(self) -> None:
        self._held: dict[str, list[str]] = {}

    def line(self, file: str, number: int) -> str:
        """A line of a file, counted from 1; empty where it cannot be read."""
        if file not in self._held:
            try:
                self._held[file] = decode(file, read_file(file)).split("\n")
            except (DocumentError, UsageError):
                self._held[file] = []
        lines = self._held[file]
        return lines[number - 1] if 0 < number <= len(lines) else ""


def format_failure(failure: Failure, sources: Sources) -> str:
    """A failure: its place and words, its source line with a caret, and rows of the run."""
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
    """All that a result has to tell that is not as expected."""
    sources = Sources()
    parts = [format_failure(one, sources) for one in result.failures]
    if result.golden == "differs":
        parts.append(f"{result.file}: the run's table is another one:\n{result.difference}")
    return "\n\n".join(parts)


def row(result: Result, wide: int) -> str:
    """A result in a line."""
    return f"{WORDS[result.status]:<7}  {result.path:<{wide}}  {_checked(result)}".rstrip()


def _checked(result: Result) -> str:
    """What was compared."""
    if result.status == "invalid":
        return "its documents are wrong"
    wrong = len({(one.place.line, one.place.column) for one in result.failures})
    parts = []
    if result.expectations:
        counted = f"{result.expectations} expectation{'s'[: result.expectations != 1]}"
        parts.append(f"{wrong} of {counted}" if wrong and result.status == "failed" else counted)
    told = {
        "same": "table as expected",
        "differs": "another table",
        "skipped": "table not compared",
    }
    if result.golden:
        parts.append(told[result.golden])
    if result.status == "error":
        parts.append("the run ended by an error")
    return ", ".join(parts) or "nothing is expected but that it runs"


def counts(results: Iterable[Result]) -> dict[str, int]:
    """How many results there are of each kind."""
    found = dict.fromkeys(WORDS, 0)
    for result in results:
        found[result.status] += 1
    return found


def summary(results: list[Result]) -> str:
    """All results in a line."""
    told = ", ".join(f"{status}: {n}" for status, n in counts(results).items() if n)
    return f"scenarios: {len(results)}; {told}"
