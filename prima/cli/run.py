"""prima run."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.common import (
    MAPS,
    PATIENCE,
    check_output,
    columns,
    duration_option,
    format_option,
    limit_option,
    map_option,
    put,
    raise_limits,
    run_into,
    suggesting,
    tell,
    tell_problems,
    why_option,
    write_for_programs,
)
from prima.errors import TOO_MUCH, RunError, UsageError, counted
from prima.scheduler.policy import POLICIES, USAGE

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.experiments.batch import Options

MOST_WORKERS = 256
"""More processes than this are a slip of the finger."""
ENDS_OF_FOLDERS = ("/", os.sep)


@click.command()
@click.argument("scenarios", metavar="[SCENARIO]...", nargs=-1, type=click.Path())
@click.option("--fa", "fas", multiple=True, type=click.Path(), help="Run this as the robot's own.")
@click.option("--ea", "eas", multiple=True, type=click.Path(), help="Run this as the place's.")
@click.option("--say", "says", multiple=True, help="The user's answer to the next question.")
@click.option(
    "-o",
    "--output",
    type=click.Path(),
    help="Write the transcript here as JSON lines; those of several runs into this folder.",
)
@click.option(
    "--policy",
    "policies",
    multiple=True,
    shell_complete=suggesting(*POLICIES),
    help=f"The mediator's policy: {USAGE}. Several: a run under each.",
)
@click.option(
    "--bound", type=click.IntRange(1), help="Let nobody wait longer than this many loops (rule E4)."
)
@duration_option("--patience", PATIENCE)
@why_option
@click.option(
    "--allow-host",
    "hosts",
    metavar="HOST[:PORT]",
    multiple=True,
    help="Let VoiceXML documents fetch from this host; without, no network is used.",
)
@click.option(
    "--isolate",
    type=click.Choice(["ea", "all", "none"]),
    default="ea",
    help="Whose scripts get a process of their own: each EA's, each application's or none's.",
)
@click.option(
    "--from",
    "lists",
    metavar="FILE",
    multiple=True,
    type=click.Path(),
    help="Run the scenarios that this file names, one in a line; - is standard input.",
)
@click.option(
    "-j",
    "--workers",
    type=click.IntRange(1, MOST_WORKERS),
    help="Make so many runs at once; by default as many as there are cores.",
)
@click.option("--resume", is_flag=True, help="Leave out runs whose transcripts are up to date.")
@map_option
@limit_option
@format_option
def run(
    scenarios: tuple[str, ...],
    fas: tuple[str, ...],
    eas: tuple[str, ...],
    says: tuple[str, ...],
    output: str | None,
    policies: tuple[str, ...],
    bound: int | None,
    patience: int | None,
    why: bool,
    hosts: tuple[str, ...],
    isolate: str,
    lists: tuple[str, ...],
    workers: int | None,
    resume: bool,
    maps: tuple[str, ...],
    limits: tuple[str, ...],
    form: str,
) -> None:
    """Run scenarios in simulation and print the mediated transcript, or a row for each run.

    Without SCENARIO, the applications named by --fa and --ea run in an empty room,
    and the user says what --say tells, one after the other, to the questions.

    With -o the transcript is written as JSON lines while the run goes on, and
    only a summary is printed; after -o - they go to stdout. Exit code 3 if the run ended by an error or a limit.

    Several scenarios, a folder of them or several policies are a batch: all runs are
    made on all cores, whatever becomes of one of them, each with a row, and with a
    transcript in the folder after -o. The exit code is the highest of them.

    \b
    prima run documents/scenarios/follow-during-navigation.xml -o mediated.jsonl
    prima run --ea documents/ea/library.xml --say "The C Primer"
    prima run documents/scenarios --policy prima --policy fifo -o runs/
    prima run documents/scenarios --policy prima --policy fifo -o runs/ --resume
    """
    from prima.experiments.batch import Options

    raise_limits(limits)
    applications = bool(fas or eas)
    if bool(scenarios or lists) == applications:
        raise UsageError("Name a scenario, or applications with --fa and --ea.")
    if not applications and says:
        raise UsageError(
            "A scenario says itself what the user says; --say goes with --fa and --ea."
        )
    if maps and not applications:
        raise UsageError(MAPS)
    several = len(scenarios) > 1 or len(policies) > 1 or any(map(os.path.isdir, scenarios))
    if lists or workers or resume or several or (output and output.endswith(ENDS_OF_FOLDERS)):
        if applications:
            raise UsageError(
                "Applications named by --fa and --ea are one run: for several, write scenarios."
            )
        if why:
            raise UsageError("--why goes with one run: prima show TRANSCRIPT --why.")
        if resume and output is None:
            raise UsageError("--resume needs the folder of the transcripts: -o FOLDER.")
        if output == "":
            raise UsageError("-o: name the folder that the transcripts go into.")
        is_file = output is not None and output.endswith(".jsonl") and not os.path.isdir(output)
        if output == "-" or is_file:
            raise UsageError(f"{output}: several transcripts go into a folder: -o runs/.")
        from prima.cli.batch import listed, run_all

        paths = [*scenarios, *(path for name in lists for path in listed(name))]
        run_all(
            paths,
            policies,
            output or "",
            Options(bound, hosts, resume, isolate=isolate, patience=patience),
            workers or 0,
            form,
        )
        return
    policy = policies[0] if policies else None
    if output == "-":
        output, form = None, "json"
    _run_one(
        next(iter(scenarios), None),
        fas,
        eas,
        says,
        output,
        policy,
        Options(bound, hosts, isolate=isolate, patience=patience),
        why,
        form,
        maps,
    )


def _run_one(
    scenario: str | None,
    fas: tuple[str, ...],
    eas: tuple[str, ...],
    says: tuple[str, ...],
    output: str | None,
    policy: str | None,
    options: Options,
    why: bool,
    form: str,
    maps: tuple[str, ...],
) -> None:
    """Run one scenario, or applications without one."""
    from prima import api

    loaded = (
        api.load_scenario(scenario)
        if scenario is not None
        else api.stage(fas, eas, says, maps=maps)
    )

    def rehearse(sink: api.Sink | None, keep: bool) -> api.Transcript:
        given = options.bound, sink, keep, options.hosts, options.isolate, options.patience
        return api.rehearse(loaded, policy, *given)

    if output is not None:
        if os.path.isdir(output):
            hint = f"For a transcript in it, write {output}/."
            raise UsageError(f"{output}: cannot be written: Is a directory. {hint}")
        folder = os.path.dirname(scenario or "")
        check_output(output, "run", *(os.path.join(folder, name) for name in loaded.files))
    tell_problems(loaded.problems)
    if output is not None:
        transcript = run_into(
            output,
            lambda sink: rehearse(sink, False),
        )
        tell(f"{output}: {_outline(transcript)}")
    elif form == "json":
        write_for_programs()
        transcript = rehearse(sys.stdout.write, False)
    else:
        transcript = rehearse(None, True)
        put(transcript.table(why, columns()))
    if transcript.unfinished:
        tell(f"{_stopped(transcript)} {'; '.join(transcript.unfinished)}.")
    if transcript.defects and "PRIMA_DEBUG" in os.environ:
        raise transcript.defects[0]
    if transcript.failures:
        from prima.experiments.batch import told_failure

        for failure in transcript.failures:
            tell(f"prima: {told_failure(failure)}")
    if transcript.outcome == "limit":
        raise RunError(TOO_MUCH)
    if transcript.failures:
        raise Exit(3)


def _stopped(transcript: Transcript) -> str:
    seconds = transcript.summary().seconds
    return f"The run was stopped at {seconds:g} s, the scenario's until:"


def _outline(transcript: Transcript) -> str:
    summary = transcript.summary()
    records = counted(transcript.measure.records if transcript.measure else 0, "record")
    broken = counted(summary.streams_broken, "stream")
    reactions = counted(summary.reactions, "reaction")
    if summary.reactions:
        reactions += f" after {summary.reaction_mean:.2f} s, "
        reactions += counted(summary.responses, "response")
    if summary.responses:
        reactions += f" after {summary.response_mean:.2f} s"
    if summary.reactions > 1:
        reactions += " on average"
    starved = f", {counted(summary.starved, 'behavior')} starved" if summary.starved else ""
    return f"{records} of {summary.seconds:.1f} s, {broken} broken{starved}, {reactions}"
