"""prima test."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.options import (
    Number,
    PathName,
    SuggestingChoice,
    Whole,
    format_option,
    limit_option,
    policy_option,
)
from prima.cli.outputs import check_output, same_file
from prima.cli.printing import coloured, echo, print_json, put, tell
from prima.cli.progress import show_count
from prima.errors import UsageError

if TYPE_CHECKING:
    from prima.testing.coverage import Coverage
    from prima.testing.running import Result

COLOURS = {"passed": "32", "failed": "31", "error": "31", "invalid": "31"}
MOST_JOBS = 64


@click.command()
@click.argument("paths", nargs=-1, type=PathName())
@click.option(
    "-k", "word", metavar="WORD", default="", help="Only scenarios with WORD in the path."
)
@policy_option("Run under this policy: {}.")
@click.option("-j", "--jobs", type=Whole(1, MOST_JOBS), default=1, help="Number of runs at once.")
@click.option(
    "--compare",
    "compare",
    type=SuggestingChoice(["text", "behavior"]),
    default="text",
    help="How to compare tables; behavior ignores differences in time below 0.5 s.",
)
@click.option("--update", is_flag=True, help="Write tables that differ or are missing.")
@click.option("-y", "--yes", is_flag=True, help="With --update: do not ask.")
@click.option(
    "--coverage", "cover", is_flag=True, help="Show how much of the documents was reached."
)
@click.option("--coverage-xml", type=PathName(), help="Write coverage here (Cobertura).")
@click.option(
    "--fail-under",
    type=Number(0, 100),
    metavar="PERCENT",
    help="Exit with 1 if less of the documents was reached.",
)
@click.option("--junit", "junit_file", type=PathName(), help="Write results here (JUnit XML).")
@limit_option
@format_option
def test(
    paths: tuple[str, ...],
    word: str,
    policy: str | None,
    jobs: int,
    compare: str,
    update: bool,
    yes: bool,
    cover: bool,
    coverage_xml: str | None,
    fail_under: float | None,
    junit_file: str | None,
    form: str,
) -> None:
    """Run scenarios, and check what they expect.

    PATHS are scenarios or folders with scenarios; the default is this folder. A scenario
    states its expectations by <expect>, <never> and <in-order>; a table beside it (NAME.txt
    for NAME.xml) is compared with the run's. A scenario without either passes if no
    application ends by an error.

    Exit code 0 if all is as expected, 1 if not, 3 if a run ended by an error.

    \b
    prima test
    prima test documents/scenarios/touched-on-the-way.xml --coverage
    prima test documents/scenarios -k situations --jobs 2 --junit results.xml
    prima test my-scenario.xml --update
    """
    from prima.testing.coverage import merge
    from prima.testing.finding import find
    from prima.testing.running import TestOptions as How
    from prima.testing.running import run_all

    _check_options(update, yes, policy, form)
    chosen = _chosen(find(paths or ["."]), word)
    _check_outputs(chosen, junit_file, coverage_xml)
    cover = cover or coverage_xml is not None or fail_under is not None
    results: list[Result] = []
    coverage: Coverage = {}
    for result in run_all(chosen, How(policy, compare, cover), min(jobs, len(chosen))):
        results.append(result)
        merge(coverage, result.coverage)
        result.coverage = {}
        show_count(len(results), len(chosen), "scenarios")
    under = _is_under(coverage, fail_under)
    if form == "text":
        _report(results)
    if update:
        _update(results, set(paths), yes)
    _finish(results, coverage if cover else None, form)
    if under and form == "text":
        tell(f"prima: less than {fail_under:g}% of the documents was reached.")
    _write(results, coverage, junit_file, coverage_xml)
    _set_exit_code(results, under)


def _chosen(found: list[str], word: str) -> list[str]:
    """Those scenarios whose path contains a word.

    Raises:
        UsageError: there are none.
    """
    chosen = [path for path in found if word.casefold() in path.casefold()]
    if not chosen:
        raise UsageError(f'None of {len(found)} scenarios has "{word}" in its path.')
    return chosen


def _set_exit_code(results: list[Result], under: bool) -> None:
    """End with the exit code of the results.

    Raises:
        Exit: a run failed, or less was reached than required.
    """
    statuses = {result.status for result in results}
    if "error" in statuses:
        raise Exit(3)
    if under or statuses != {"passed"}:
        raise Exit(1)


def _check_options(update: bool, yes: bool, policy: str | None, form: str) -> None:
    if yes and not update:
        raise UsageError("--yes works only with --update.")
    if update and policy is not None:
        raise UsageError("Expected tables are for the scenario's own policy: leave out --policy.")
    if update and form == "json":
        raise UsageError("--update prints differences as text: leave out --format json.")
    if policy is not None:
        from prima.scheduler.policy import policy_named

        policy_named(policy)


def _check_outputs(scenarios: list[str], *outputs: str | None) -> None:
    """Check the files for results and coverage.

    Raises:
        UsageError: they are one file, or one would replace an input.
    """
    paths = [path for path in outputs if path]
    if len(paths) == 2 and same_file(*paths):
        raise UsageError(f"{paths[0]}: results and coverage need two files; name another one.")
    for path in paths:
        check_output(path, "test", *scenarios)


def _paint(text: str, status: str) -> str:
    return f"\033[{COLOURS[status]}m{text}\033[0m" if coloured() else text


def _report(results: list[Result]) -> None:
    """Print each result in a line, then the failures."""
    from prima.cli.printing import clean
    from prima.testing.summary import format_result, row

    wide = max(len(result.path) for result in results)
    for result in results:
        echo(_paint(clean(row(result, wide)), result.status))
    for result in results:
        shown = format_result(result)
        if shown:
            echo(_paint(f"\n{clean(result.path)}", result.status))
            put(shown)


def _finish(results: list[Result], coverage: Coverage | None, form: str) -> None:
    from prima.testing.coverage import coverage_data, format_coverage
    from prima.testing.running import result_data
    from prima.testing.summary import counts, summary

    if form == "json":
        print_json(
            {
                "counts": counts(results),
                "scenarios": [result_data(result) for result in results],
                "coverage": None if coverage is None else coverage_data(coverage),
            }
        )
        return
    if coverage is not None:
        put("\n" + format_coverage(coverage))
    put(f"\n{summary(results)}")


def _is_under(coverage: Coverage, percent: float | None) -> bool:
    from prima.testing.coverage import total

    return percent is not None and total(coverage) < percent


def _write(
    results: list[Result], coverage: Coverage, junit_file: str | None, coverage_xml: str | None
) -> None:
    from prima.loading.writing import write_whole
    from prima.testing.junit import cobertura, junit

    if junit_file:
        write_whole(junit_file, junit(results))
    if coverage_xml:
        write_whole(coverage_xml, cobertura(coverage))


# Expected tables -------------------------------------------------------------------


def _update(results: list[Result], named: set[str], yes: bool) -> None:
    """Write the tables of runs without other failures; each has been shown before."""
    from prima.loading.writing import write_whole

    for result in results:
        new = result.golden == "" and result.path in named
        if not (result.golden == "differs" or new):
            continue
        if result.failures:
            tell(f"{result.file}: not written: the run was not as expected.")
            continue
        if new:
            put(f"\n{result.table}")
        if not _agreed(result, yes):
            continue
        write_whole(result.file, result.table)
        tell(f"{result.file}: written.")
        result.status, result.golden, result.difference = "passed", "same", ""


def _agreed(result: Result, yes: bool) -> bool:
    """Whether the author agrees to write a table."""
    if yes:
        return True
    if sys.stdin is None or not sys.stdin.isatty():
        tell(f"{result.file}: not written. To write it, add --yes.")
        return False
    return click.confirm(f"Write {result.file}?", err=True)
