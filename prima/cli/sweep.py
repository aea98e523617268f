"""prima sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
from click.core import ParameterSource
from click.exceptions import Exit

from prima.cli.options import (
    PathName,
    SuggestingChoice,
    Whole,
    bound_option,
    isolate_option,
    limit_option,
    on_option,
    output_option,
    patience_option,
    policy_option,
    workers_option,
)
from prima.cli.outputs import check_output
from prima.cli.printing import put, stream, tell, write_for_programs
from prima.cli.progress import ProgressBar
from prima.errors import UsageError, counted

if TYPE_CHECKING:
    from prima.experiments.pools import Pool
    from prima.experiments.sweep import Output, Sweep

MANY = 100_000
"""The number of runs from which their duration is estimated beforehand."""


@click.command()
@click.argument("scenarios", metavar="SCENARIO...|STUDY.toml", nargs=-1, type=PathName())
@click.option(
    "--vary",
    "varied",
    metavar="PATH=LEVELS",
    multiple=True,
    help="A value of the scenario and its levels; may be repeated.",
)
@policy_option("Run under this policy; may be repeated: {}.", many=True)
@click.option("--seeds", type=Whole(1), help="Runs of each combination. By default 1.")
@click.option(
    "--design",
    type=SuggestingChoice(["full", "random", "lhs"]),
    help="All combinations (full), random ones, or a Latin hypercube (lhs).",
)
@click.option("--runs", type=Whole(1), help="Number of runs, for random and lhs.")
@output_option("Write the table here: a .csv or .parquet file.")
@workers_option
@on_option
@click.option("--resume", is_flag=True, help="Go on behind the rows that are there already.")
@click.option(
    "--bundle",
    type=PathName(),
    help="Write an archive (RO-Crate), too: the table with all that it was made from.",
)
@click.option("--plan", is_flag=True, help="Only tell how many runs these are, and how long.")
@bound_option
@patience_option
@isolate_option
@limit_option
def sweep(
    scenarios: tuple[str, ...],
    varied: tuple[str, ...],
    policies: tuple[str, ...],
    seeds: int | None,
    design: str | None,
    runs: int | None,
    output: str | None,
    workers: int | None,
    address: str | None,
    resume: bool,
    bundle: str | None,
    plan: bool,
    bound: int | None,
    patience: int | None,
    isolate: str,
) -> None:
    """Run scenarios over many values, and write one tidy table, a row for each run.

    Levels are a list (Yes.|No.), a range (0s..20s/200ms), or a distribution by seed
    (normal(5s,1s)). Without -o the table goes to stdout, as CSV. With it, a folder
    beside the table holds one transcript for each order in which things happened.

    \b
    prima sweep visit.xml --vary "when[2].after=0s..20s/200ms" --policy prima --policy fifo -o sweep.csv
    prima sweep visit.xml --vary "person.speed=normal(1,0.2)" --seeds 100 -o sweep.parquet
    prima sweep study.toml -o sweep.parquet --resume
    prima sweep study.toml -o sweep.csv --bundle sweep.zip
    """
    from prima.experiments.bundle import check_bundle, write_bundle
    from prima.experiments.cluster import pool_of
    from prima.experiments.studyfile import question_of
    from prima.experiments.sweep import Output, Sweep

    question = question_of(
        scenarios,
        _vary(varied),
        policies=policies or None,
        seeds=seeds,
        design=design,
        runs=runs,
        bound=bound,
        patience=patience,
        isolate=isolate if _is_given("isolate") else None,
    )
    _check_table(output, resume, bundle)
    made = Sweep(question)
    _tell_cost(made, address, workers, plan)
    if plan:
        return
    pool = pool_of(address, workers)
    if output is None or output == "-":
        worst = _print(made, pool)
    else:
        check_output(output, "table", *scenarios, *question.scenarios)
        out = Output(made, output, pool)
        if bundle is not None:
            check_output(bundle, "archive", *scenarios, *question.scenarios)
            check_bundle(bundle, out)
        worst = _write(out, resume)
        if bundle is not None:
            tell(f"{bundle}: {counted(write_bundle(bundle, out), 'file')}")
    if worst:
        raise Exit(worst)


def _is_given(option: str) -> bool:
    """Whether an option is on the command line; otherwise a study's own value counts."""
    source = click.get_current_context().get_parameter_source(option)
    return source is not ParameterSource.DEFAULT


def _check_table(output: str | None, resume: bool, bundle: str | None) -> None:
    """Refuse options that need the table's file.

    Raises:
        UsageError: it is not named.
    """
    if resume and output in (None, "-"):
        raise UsageError("--resume needs the table: -o sweep.csv.")
    if bundle is not None and output in (None, "-"):
        raise UsageError("--bundle needs the table: -o sweep.csv.")


def _vary(varied: tuple[str, ...]) -> dict[str, str]:
    """Levels by paths.

    Raises:
        UsageError: an option is malformed, or there twice.
    """
    vary: dict[str, str] = {}
    for text in varied:
        path, equals, levels = text.partition("=")
        path = path.strip()
        if not equals or not path:
            raise UsageError(f'--vary "{text}": write PATH=LEVELS, as "person.speed=0.5|1".')
        if path in vary:
            raise UsageError(f"--vary: {path} is there twice; join the levels with |.")
        vary[path] = levels
    return vary


def _tell_cost(made: Sweep, address: str | None, workers: int | None, plan: bool) -> None:
    """Print how long a sweep will take, if requested or if it is long."""
    from prima.experiments.cluster import size_of
    from prima.experiments.sweep import estimate

    if plan or len(made) > MANY:
        line = estimate(made, size_of(address, workers))
        if plan:
            put(line)
        else:
            tell(line)


def _print(made: Sweep, pool: Pool) -> int:
    """Print the table; return the highest exit code of a run."""
    from prima.experiments.table import line

    write_for_programs()
    names = [one.name for one in made.columns]
    worst, exit_column = 0, names.index("exit")
    head = line(names)  # printed with the first row: there may be none, or it may be refused
    for row in made.results(pool):
        stream(head + line(row), nl=False)
        head = ""
        code = row[exit_column]
        worst = max(worst, code if isinstance(code, int) else 0)
    return worst


def _write(out: Output, resume: bool) -> int:
    """Write the table, and report its contents; return the highest exit code of a run."""
    total, begun = len(out.sweep), -1
    progress = ProgressBar(total)
    try:
        for number in out.write(resume):
            begun = number if begun < 0 else begun
            progress.show(number, 0)
    except KeyboardInterrupt:
        progress.clear()
        tell(f"{out.path}: the runs made so far are kept; --resume goes on.")
        raise click.Abort from None
    finally:
        progress.clear()
    if resume:
        tell(f"{begun} of {counted(total, 'run')} had been made before")
    orders: set[object] = set()
    bad = worst = failed = 0
    for row in out.read():
        orders.add(row["order"])
        code = row["exit"]
        bad += bool(code)
        failed += bool(row["expects_failed"])
        worst = max(worst, code if isinstance(code, int) else 0)
    counts = [counted(total, "run"), counted(len(orders - {""}), "order")]
    counts += [f"{bad} not fine"] if bad else []
    counts += [f"{failed} with failed expectations"] if failed else []
    put(f"{out.path}: {', '.join(counts)}")
    return worst
