"""prima live."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource
from click.exceptions import Exit

from prima.cli.failures import INTERRUPTED, closed_pipe
from prima.cli.interrupts import leave_to_python
from prima.cli.options import (
    Number,
    PathName,
    bound_option,
    check_why,
    duration_option,
    ea_option,
    fa_option,
    format_option,
    hosts_option,
    isolate_option,
    limit_option,
    map_option,
    paths_option,
    patience_option,
    policy_option,
    why_option,
)
from prima.cli.outputs import check_output
from prima.cli.printing import (
    clean,
    columns,
    echo,
    how_to_go_on,
    stream,
    tell,
    tell_line,
    tell_problems,
    write_for_programs,
)
from prima.cli.progress import print_records
from prima.errors import RunError

if TYPE_CHECKING:
    from prima.live.visit import Visit
    from prima.messages import Record

FASTEST = 1000.0  # equals prima.api.live.FASTEST, which is slow to import
FOR_CHECKS = ("checks", "robot", "world", "drivers", "limits")
"""What --check heeds."""


@click.command()
@click.argument("scenario", type=PathName(), required=False)
@click.option("--robot", type=PathName(), help="The robot, whose document names its drivers.")
@click.option("--world", type=PathName(), help="The site's map, and what its areas offer.")
@fa_option
@ea_option
@click.option(
    "--services", type=PathName(), help="Ask the services of this document, and no others."
)
@click.option("-o", "--output", type=PathName(), help="Write the journal here, as it grows.")
@click.option("--resume", "journal", type=PathName(), help="Go on with a run that was cut off.")
@click.option(
    "--check", "checks", is_flag=True, help="Try each driver and Command of the robot, and end."
)
@click.option(
    "--speed",
    type=Number(0, FASTEST, min_open=True),
    default=1.0,
    help="Run so many times as fast as real time; for simulated robots.",
)
@duration_option("--until", "End the run after this time at the latest.")
@duration_option("--late", "Tell when an instant is later than this; 250ms by default.")
@click.option(
    "--sync", is_flag=True, help="Have each instant on the disk before it is carried out."
)
@click.option("--redact", is_flag=True, help="Leave out of the journal what users say.")
@paths_option(
    "--driver", "drivers", "Take drivers from this Python file, too; it is run.", metavar="FILE"
)
@policy_option("The mediator's policy: {}.")
@bound_option
@patience_option
@why_option
@hosts_option
@isolate_option
@map_option
@limit_option
@format_option
def live(
    scenario: str | None,
    robot: str | None,
    world: str | None,
    fas: tuple[str, ...],
    eas: tuple[str, ...],
    services: str | None,
    output: str | None,
    journal: str | None,
    checks: bool,
    speed: float,
    until: int | None,
    late: int | None,
    sync: bool,
    redact: bool,
    drivers: tuple[str, ...],
    policy: str | None,
    bound: int | None,
    patience: int | None,
    why: bool,
    hosts: tuple[str, ...],
    isolate: str,
    maps: tuple[str, ...],
    form: str,
) -> None:
    """Run applications on a robot, in real time, with the journal as transcript.

    Rows are printed as they happen. Ctrl-C ends the run and makes the robot safe; --resume
    goes on with it. With SCENARIO the robot, its world and its user are simulated.

    Exit code 1 if documents have errors, 2 if something else is wrong before the run, 3 if the
    robot is not there or an application ended by an error, 130 after Ctrl-C.

    \b
    prima live --robot documents/robots/simulated.xml --fa documents/fa/follow.xml -o visit.jsonl
    prima live --robot documents/robots/simulated.xml --check
    prima live --speed 20 documents/scenarios/follow-during-navigation.xml
    prima live --resume visit.jsonl
    """
    from prima.api.rehearsing import fetcher
    from prima.live.chosen import Chosen
    from prima.live.prepared import check_usage, prepared
    from prima.live.visit import LiveSettings

    leave_to_python()
    chosen = Chosen(robot or "", scenario or "", world or "", fas, eas, maps, services or "")
    check_usage(chosen, output, journal, checks)
    check_why(why, form)
    web = fetcher(list(hosts), len(fas) + len(eas) + 1)
    settings = LiveSettings(policy, bound, patience, isolate, speed, until, sync, web=web)
    settings.drivers, settings.redact = drivers, redact
    if late is not None:
        settings.late = late or None
    if checks:
        from prima.live.preflight import check_robot

        _tell_unused(click.get_current_context())
        raise Exit(check_robot(chosen, settings, lambda text: echo(clean(text))))
    if output is not None:
        check_output(
            output, "journal", *filter(None, (scenario, robot, world, services, *fas, *eas))
        )
    visit = prepared(chosen, settings, output, journal)
    tell_problems(visit.loaded.problems)
    _run(visit, why, form == "json")


def _tell_unused(context: click.Context) -> None:
    """Tell what is given beside --check, which has no effect."""
    given = [
        _long_name(one) if isinstance(one, click.Option) else one.human_readable_name
        for one in context.command.params
        if context.get_parameter_source(one.name or "") is ParameterSource.COMMANDLINE
        and one.name not in FOR_CHECKS
    ]
    if given:
        tell(f"prima: --check tries the robot alone; it ignores {', '.join(given)}.")


def _long_name(option: click.Option) -> str:
    """An option's first name that is a word."""
    return next(name for name in option.opts if name.startswith("--"))


def _run(visit: Visit, why: bool, as_json: bool) -> None:
    """Carry out a run, with its rows on stdout."""
    if as_json:
        write_for_programs()
    show = print_records if as_json else Rows(visit, why)

    def sink(records: list[Record]) -> None:
        try:
            show(records)
        except BrokenPipeError as error:  # nobody reads the rows any more: as after Ctrl-C
            closed_pipe(error)
            visit.stop()
        except OSError as error:
            raise RunError(f"stdout: cannot be written: {error.strerror}.") from None

    visit.run(sink, lambda text: tell_line(f"prima: {text}"))
    session = visit.loop.session
    for failure in session.failures:
        tell_line(f"prima: {failure}")
    if visit.stopped:
        journal = visit.journal
        kept = journal is not None and os.path.exists(journal.path) and not visit.loop.outcome
        if journal is not None and kept and not visit.settings.redact:
            tell(f"Stopped. {how_to_go_on(journal.path, visit.settings.drivers)}")
        raise Exit(INTERRUPTED)
    if session.failures:
        raise Exit(3)


class Rows:
    """Prints the rows of a run as they happen."""

    def __init__(self, visit: Visit, why: bool) -> None:
        from prima.transcript.rows import GrowingTable
        from prima.transcript.table import format_head, layout

        self._table = GrowingTable()
        self._table.add(visit.before)  # continued Commands keep their arguments and numbers
        self._shape = layout([doc.id for doc in visit.loaded.cast.documents], columns(), why)
        self._head = format_head(self._shape)

    def __call__(self, records: list[Record]) -> None:
        """Print what the records of an instant add.

        Raises:
            OSError: they cannot be printed.
        """
        from prima.transcript.lines import finished
        from prima.transcript.table import format_row

        if self._head:
            stream(self._head)
            self._head = ""
        for row in self._table.add([finished(record) for record in records]):
            stream(clean("\n".join(format_row(row, self._shape))))
        sys.stdout.flush()
