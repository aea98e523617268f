"""Experiments as functions of Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prima.api.transcripts import whole_numbers
from prima.errors import UsageError
from prima.experiments.cluster import pool_of
from prima.experiments.explore import Exploration, ExplorationPlan
from prima.experiments.explored import Explored, carried_out
from prima.experiments.pools import Pool
from prima.experiments.studyfile import Level, levels_text, question_of
from prima.experiments.sweep import Output, Sweep
from prima.experiments.table import arrow_table
from prima.language.values import LONGEST_MS
from prima.loading.files import check_path, check_texts, paths_of, texts_of
from prima.messages import Json
from prima.script.isolated import check_isolation

if TYPE_CHECKING:
    import pyarrow


def sweep(
    scenarios: str | Path | Iterable[str | Path],
    vary: Mapping[str, Level | Sequence[Level]] | None = None,
    policies: str | Iterable[str] | None = None,
    seeds: int | None = None,
    design: str | None = None,
    runs: int | None = None,
    output: str | Path | None = None,
    workers: int | None = None,
    resume: bool = False,
    bound: int | None = None,
    patience: int | None = None,
    isolate: str | None = None,
    on: str | None = None,
) -> pyarrow.Table:
    """Run scenarios over many values (docs/experiments.md).

    Args:
        scenarios: a scenario, or several, or a study file (``.toml``); what is given beside a
            study file comes before what it says.
        vary: levels by paths: a list, or a text as on the command line, such as
            ``{"when[2].after": "0s..20s/1s", "answer": ["Yes.", "No."]}``.
        policies: policies; by default each scenario's own.
        seeds: runs of each combination, each with other random values; by default 1.
        design: ``full`` (the default), ``random`` or ``lhs``.
        runs: their number, for ``random`` and ``lhs``.
        output: a ``.csv`` or ``.parquet`` file for the table; a folder beside it gets a
            transcript for each order.
        workers: the number of processes; by default as many as there are cores.
        resume: whether to continue after the rows that ``output`` already has.
        bound: rule E4's bound on loops of a feedback Command.
        patience: rule E6's bound (ms); by default each scenario's own.
        isolate: which scripts run in a process of their own, as for :func:`rehearse`.
        on: the address of a scheduler of Dask, on whose workers the runs are made.

    Returns:
        A row for each run; ``.to_pandas()`` and ``polars.from_arrow()`` convert it.

    Raises:
        DocumentError: a scenario has errors.
        UsageError: a factor, level, policy or file is wrong, or pyarrow is not installed.
        RunError: no process can be started.
    """
    [seeds, runs, workers, bound] = whole_numbers(
        seeds=seeds, runs=runs, workers=workers, bound=bound
    )
    [patience] = whole_numbers(0, LONGEST_MS, patience=patience)
    path = None if output is None else check_path(output, "output")
    if isolate is not None:
        check_isolation(isolate)
    question = question_of(
        paths_of(scenarios, "scenarios"),
        _levels({} if vary is None else vary),
        policies=None if policies is None else tuple(texts_of(policies, "policies")),
        seeds=seeds,
        design=design,
        runs=runs,
        bound=bound,
        patience=patience,
        isolate=isolate,
    )
    return _table(Sweep(question), path, pool_of(on, workers), resume)


def explore(
    scenario: str | Path,
    moves: str | Iterable[str] = (),
    within: int = 5_000,
    depth: int = 2,
    step: int = 0,
    runs: int = 20_000,
    policy: str = "",
    output: str | Path | None = None,
    workers: int | None = None,
    resume: bool = False,
    isolate: str = "ea",
    on: str | None = None,
) -> dict[str, Json]:
    """Find every order of events that other timings bring (docs/experiments.md).

    Args:
        scenario: a scenario.
        moves: paths of the times to vary; by default that of each ``<when>``.
        within: how far each is moved, to both sides (ms).
        depth: how many of them are varied at once.
        step: a grid (ms) of times that are tried besides; 0 for none.
        runs: runs at most.
        policy: a policy; by default the scenario's own.
        output: a folder for the orders and problems, as scenarios with their transcripts.
        workers: the number of processes; by default as many as there are cores.
        resume: whether to reuse the runs in ``output``.
        isolate: which scripts run in a process of their own, as for :func:`rehearse`.
        on: the address of a scheduler of Dask, on whose workers the runs are made.

    Returns:
        What ``prima explore --format json`` prints: orders, boundaries, problems.

    Raises:
        DocumentError: the scenario has errors.
        UsageError: a path does not name a time, or a file cannot be written.
        RunError: no process can be started.
    """
    name = check_path(scenario, "scenario")
    path = None if output is None else check_path(output, "output")
    [within, depth, runs] = whole_numbers(needed=True, within=within, depth=depth, runs=runs)
    [workers] = whole_numbers(workers=workers)
    [step] = whole_numbers(0, needed=True, step=step)
    check_isolation(isolate)
    moved = tuple(texts_of(moves, "moves"))
    plan = ExplorationPlan(name, moved, within, depth, step, runs, policy, isolate)
    exploration = Exploration(plan)
    if resume and output is None:
        raise UsageError("resume needs the output that it goes on with.")
    for _ in carried_out(exploration, pool_of(on, workers), path, resume):
        pass
    return Explored(exploration).data(written=output is not None)


def _levels(vary: Mapping[str, Level | Sequence[Level]]) -> dict[str, str]:
    """Levels by paths, as texts.

    Raises:
        UsageError: they are not levels by paths.
    """
    texts: object = vary
    if isinstance(vary, Mapping):
        texts = {path: _text(path, levels) for path, levels in vary.items()}
    return check_texts(texts, "vary")


def _text(path: str, levels: Any) -> str:
    """The levels of one path; no levels would read like the level that removes a value.

    Raises:
        UsageError: there are none, or one is neither a text nor a number.
    """
    if isinstance(levels, str):
        return levels
    if isinstance(levels, Iterable) and not isinstance(levels, Set | Mapping | bytes):
        several = list(levels)
    else:
        several = [levels]
    if not several:
        raise UsageError(f'{path}: there are no levels. Write some, as ["Yes.", "No."].')
    for one in several:
        if not _is_level(one):
            raise UsageError(
                f"{path}: {one!r:.80} cannot be a level. Write texts or numbers in a list;"
                ' "" removes the value.'
            )
    return levels_text(several)


def _is_level(one: object) -> bool:
    """Whether a value can be a level: a text or a number, and not a missing one (NaN)."""
    return isinstance(one, str | Path) or (isinstance(one, Real) and one == one)


def _table(made: Sweep, output: str | None, pool: Pool, resume: bool) -> pyarrow.Table:
    if output is None:
        if resume:
            raise UsageError("resume needs the output that it goes on with.")
        names = [one.name for one in made.columns]
        rows = (dict(zip(names, row, strict=True)) for row in made.results(pool))
        return arrow_table(rows, made.columns)
    out = Output(made, output, pool)
    for _ in out.write(resume):
        pass
    return arrow_table(out.read(), made.columns)
