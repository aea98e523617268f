"""prima run."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.common import (
    POLICIES,
    check_output,
    format_option,
    limit_option,
    put,
    raise_limits,
    run_into,
    start_watchdog,
    tell,
    why_option,
)
from prima.errors import RunError, UsageError

if TYPE_CHECKING:
    from prima.api import Transcript


@click.command()
@click.argument("scenario", type=click.Path(), required=False)
@click.option("--fa", "fas", multiple=True, type=click.Path(), help="Run this as the robot's own.")
@click.option("--ea", "eas", multiple=True, type=click.Path(), help="Run this as the place's.")
@click.option("--say", "says", multiple=True, help="The user's answer to the next question.")
@click.option("-o", "--output", type=click.Path(), help="Write the transcript here as JSON lines.")
@click.option("--policy", help=f"The mediator's policy: {POLICIES}.")
@click.option(
    "--bound", type=click.IntRange(1), help="Let nobody wait longer than this many loops (rule E4)."
)
@why_option
@click.option(
    "--allow-host",
    "hosts",
    metavar="HOST[:PORT]",
    multiple=True,
    help="Let VoiceXML documents fetch from this host; without, no network is used.",
)
@limit_option
@format_option
def run(
    scenario: str | None,
    fas: tuple[str, ...],
    eas: tuple[str, ...],
    says: tuple[str, ...],
    output: str | None,
    policy: str | None,
    bound: int | None,
    why: bool,
    hosts: tuple[str, ...],
    limits: tuple[str, ...],
    form: str,
) -> None:
    """Run a scenario in simulation and print the mediated transcript.

    Without SCENARIO, the applications named by --fa and --ea run in an empty room,
    and the user says what --say tells, one after the other, to the questions.

    With -o the transcript is written as JSON lines while the run goes on, and
    only a summary is printed. Exit code 3 if the run ended by an error or a limit.

    \b
    prima run documents/scenarios/follow-during-navigation.xml -o mediated.jsonl
    prima run --ea documents/ea/library.xml --say "The C Primer"
    """
    from prima import api

    raise_limits(limits)
    if (scenario is None) == (not fas and not eas):
        raise UsageError("Name a scenario, or applications with --fa and --ea.")
    if scenario is not None and says:
        raise UsageError(
            "A scenario says itself what the user says; --say goes with --fa and --ea."
        )
    loaded = api.load_scenario(scenario) if scenario is not None else api.stage(fas, eas, says)
    if output is not None:
        folder = os.path.dirname(scenario or "")
        check_output(output, "run", *(os.path.join(folder, name) for name in loaded.files))
    for problem in loaded.problems:
        if problem.severity != "note":
            tell(str(problem))
    start_watchdog()
    if output is not None:
        transcript = run_into(
            output, lambda sink: api.rehearse(loaded, policy, bound, sink, False, hosts)
        )
        tell(f"{output}: {_outline(transcript)}")
    elif form == "json":
        transcript = api.rehearse(loaded, policy, bound, sys.stdout.write, False, hosts)
    else:
        transcript = api.rehearse(loaded, policy, bound, hosts=hosts)
        put(transcript.table(why))
    for failure in transcript.failures:
        tell(f"prima: {failure.rstrip(': ')}{_handling(failure)}")
    if transcript.outcome == "limit":
        raise RunError("the run made more records than a run may.")
    if transcript.failures:
        raise Exit(3)


def _handling(failure: str) -> str:
    """How an application may take what it has thrown itself; errors say what is wrong."""
    event = failure.split(": ")[1]
    if ":" in event or event.startswith("error."):
        return ""
    return f'. Nothing handles it: write <on event="{event}">.'


def _outline(transcript: Transcript) -> str:
    summary = transcript.summary()
    return (
        f"{transcript.measure.records if transcript.measure else 0} records of {summary.seconds:.1f} s,"
        f" {summary.streams_broken} streams broken, {summary.reactions} reactions"
        f" after {summary.reaction_mean:.2f} s on average"
    )
