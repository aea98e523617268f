"""prima explore."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.options import (
    PathName,
    Whole,
    duration_option,
    format_option,
    isolate_option,
    limit_option,
    on_option,
    policy_option,
    workers_option,
)
from prima.cli.printing import print_json, put, tell
from prima.cli.progress import ProgressBar
from prima.errors import RunError, UsageError, counted

if TYPE_CHECKING:
    from prima.experiments.explore import Exploration


@click.command()
@click.argument("scenario", type=PathName())
@click.option(
    "--move",
    "moves",
    metavar="PATH",
    multiple=True,
    help="A time of the scenario; may be repeated. By default that of each <when>.",
)
@duration_option("--within", "How far each is moved, to both sides; default 5s.", "5s")
@click.option("--depth", type=Whole(1, 4), default=2, help="How many are moved at once; default 2.")
@duration_option("--step", "Try besides all times in steps of this.")
@click.option(
    "--runs",
    type=Whole(1),
    default=20_000,
    help="Runs at most, before shifts are minimised; default 20000.",
)
@policy_option("Run under this policy.", default="")
@click.option("-o", "--output", type=PathName(), help="A folder for the orders and problems.")
@workers_option
@on_option
@click.option("--resume", is_flag=True, help="Use the runs that the folder has already.")
@format_option
@isolate_option
@limit_option
def explore(
    scenario: str,
    moves: tuple[str, ...],
    within: int,
    depth: int,
    step: int | None,
    runs: int,
    policy: str,
    output: str | None,
    workers: int | None,
    address: str | None,
    resume: bool,
    form: str,
    isolate: str,
) -> None:
    """Find every order of events that other timings bring, and those that break something.

    Each time is moved to just before and at every instant of the run: ends, windows,
    timeouts. In every run the scenario's expectations and the rules of mediation are
    checked, and that it ends. Exit code 1 if something is broken. Ctrl-C prints what was
    found so far.

    \b
    prima explore visit.xml
    prima explore visit.xml --move touch --move "when[2]" --within 5s -o explored/
    """
    from prima.experiments.cluster import pool_of
    from prima.experiments.explore import Exploration, ExplorationPlan
    from prima.experiments.explored import carried_out

    if resume and output is None:
        raise UsageError("--resume needs the folder: -o FOLDER.")
    if step == 0:
        raise UsageError("--step: write a time above 0.")
    plan = ExplorationPlan(scenario, moves, within, depth, step or 0, runs, policy, isolate)
    exploration = Exploration(plan)
    progress = ProgressBar(runs)
    numbers = carried_out(exploration, pool_of(address, workers), output, resume)
    try:
        kept = next(numbers)
        if resume:
            tell(f"{counted(kept, 'run')} had been made before")
        for number in numbers:
            progress.show(number, 0)
    except (KeyboardInterrupt, RunError) as ended:
        progress.clear()
        exploration.settle()
        _put(exploration, form, written=False)
        if output is not None:
            tell(f"{output}: the runs made so far are kept; --resume goes on.")
        if isinstance(ended, RunError):
            raise
        raise click.Abort from None
    finally:
        progress.clear()
    _put(exploration, form, output is not None)
    if exploration.problems:
        raise Exit(1)


def _put(exploration: Exploration, form: str, written: bool) -> None:
    """Print what was found, if anything was."""
    from prima.experiments.explored import Explored

    if not exploration.orders:
        return
    explored = Explored(exploration)
    if form == "json":
        print_json(explored.data(written))
        return
    for line in explored.text():
        put(line)
