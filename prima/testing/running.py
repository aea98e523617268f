"""Runs scenarios as tests, in one process or several."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any, ClassVar, Literal

from prima import api
from prima.errors import TOO_MUCH, DocumentError, PrimaError, RunError, UsageError
from prima.loading import Loaded, load_scenario
from prima.markup.limits import LIMITS, set_limits
from prima.pool import Died, spread
from prima.testing.checking import Failure, check
from prima.testing.coverage import Coverage, covered
from prima.testing.facts import make_run
from prima.testing.golden import difference, golden_of, read_golden
from prima.testing.tracing import reached, states_of
from prima.transcript.row import Row

Status = Literal["passed", "failed", "error", "invalid"]
"""As expected; not as expected; the run ended by an error; the documents have errors."""


@dataclass(frozen=True, slots=True)
class TestOptions:
    """How to test scenarios: the policy (None for their own), and how to compare tables."""

    __test__: ClassVar[bool] = False  # its name is that of tests, for pytest
    policy: str | None = None
    compare: str = "text"
    coverage: bool = False


@dataclass(slots=True)
class Result:
    """The result of one scenario."""

    path: str
    name: str = ""
    status: Status = "passed"
    expectations: int = 0
    failures: list[Failure] = field(default_factory=list)
    golden: Literal["", "same", "differs", "skipped"] = ""
    """The comparison with the expected table, if there is one."""
    difference: str = ""
    table: str = ""
    """The run's table, if the expected one is missing or differs."""
    seconds: float = 0.0
    """Its duration in real time."""
    simulated: float = 0.0
    """The run's duration in virtual time (s)."""
    coverage: Coverage = field(default_factory=dict)

    @property
    def file(self) -> Path:
        """The file of the expected table, whether it exists or not."""
        return golden_of(Path(self.path))


def run_one(path: str, choice: TestOptions) -> Result:
    """Test one scenario.

    Raises:
        UsageError: the file or its expected table cannot be read; the policy is unknown.
    """
    began = perf_counter()
    made = Result(path)
    try:
        loaded = load_scenario(path)
    except DocumentError as error:
        made.status = "invalid"
        made.failures = [
            Failure(
                problem.place,
                " ".join(filter(None, (problem.message, problem.remedy, f"[{problem.code}]"))),
            )
            for problem in error.problems
            if problem.severity == "error"
        ]
    else:
        _rehearse(loaded, choice, made)
    made.seconds = perf_counter() - began
    return made


def _rehearse(loaded: Loaded, choice: TestOptions, made: Result) -> None:
    scenario = loaded.cast.scenario
    made.name, made.expectations = scenario.id, len(scenario.expectations)
    transcript = api.rehearse(loaded, choice.policy, visits=True)
    if choice.coverage:
        made.coverage = covered(reached(transcript.visits))
    states = states_of(transcript.visits)
    made.simulated = transcript.run().end
    rows = transcript.rows()
    made.failures = check(scenario, make_run(transcript.run().entries, rows, states))
    if made.failures:
        made.status = "failed"
    own = choice.policy in (None, scenario.policy)
    made.table = transcript.table() if own else ""
    _compare(rows, choice.compare, own, made)
    unexpected = _unexpected(transcript.failures, loaded)
    if transcript.outcome == "limit":
        unexpected.append(Failure(scenario.node.place, TOO_MUCH[0].upper() + TOO_MUCH[1:]))
    if unexpected:
        made.status = "error"
        made.failures += unexpected


def _compare(rows: list[Row], by: str, own: bool, made: Result) -> None:
    """Compare with the expected table, which is for the scenario's own policy."""
    if not made.file.exists():
        return
    if not own:
        made.golden = "skipped"
        return
    try:
        made.difference = difference(read_golden(made.file), rows, by)
    except UsageError as error:  # the other scenarios are run all the same
        made.difference = str(error)
    made.golden = "differs" if made.difference else "same"
    if made.difference:
        made.status = "failed"
    else:
        made.table = ""


def _unexpected(failures: Iterable[str], loaded: Loaded) -> list[Failure]:
    """Errors that ended applications, except those that the scenario expects."""
    scenario = loaded.cast.scenario
    expected = {
        one.words["ends"]
        for one in scenario.expectations
        if "ends" in one.words and not one.never and one.reason
    }
    pairs = zip(loaded.cast.documents, scenario.applications, strict=False)
    places = {document.id: node.attribute_place("src") for document, (_, _, node) in pairs}
    unexpected = []
    for failure in failures:
        name, _, what = failure.rstrip(": ").partition(": ")
        if name not in expected:
            place = places.get(name, scenario.node.place)
            unexpected.append(Failure(place, f"The application {name} ended by an error: {what}"))
    return unexpected


def run_all(paths: list[str], choice: TestOptions, jobs: int = 1) -> Iterator[Result]:
    """Test scenarios; the results come in order.

    Args:
        paths: the scenarios.
        choice: how to test them.
        jobs: the number of processes.

    Raises:
        UsageError: as :func:`run_one`.
        RunError: a process was killed.
    """
    if jobs == 1:
        yield from (run_one(path, choice) for path in paths)
        return
    begin = partial(set_limits, asdict(LIMITS))
    with closing(spread(partial(_run_or_error, choice), paths, jobs, begin)) as made:
        for _path, found in made:
            if isinstance(found, Died):
                raise RunError("a test process was killed; the remaining tests are not run.")
            if isinstance(found, PrimaError):
                raise found
            yield found


def _run_or_error(choice: TestOptions, path: str) -> Result | UsageError | RunError:
    """As :func:`run_one`; an error is returned, so that it can leave the process."""
    try:
        return run_one(path, choice)
    except (UsageError, RunError) as error:
        return error


def result_data(result: Result) -> dict[str, Any]:
    """A result as data for JSON."""
    return {
        "scenario": result.path,
        "name": result.name,
        "status": result.status,
        "expectations": result.expectations,
        "golden": result.golden or None,
        "seconds": round(result.seconds, 3),
        "simulated": result.simulated,
        "difference": result.difference or None,
        "failures": [
            {
                "file": one.place.file,
                "line": one.place.line,
                "column": one.place.column,
                "message": one.message,
                "rows": one.rows.splitlines(),
            }
            for one in result.failures
        ],
    }
