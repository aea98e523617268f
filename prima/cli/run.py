"""prima run."""

from __future__ import annotations

import os
import sys
from itertools import chain
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.options import (
    MAPS,
    PathName,
    Whole,
    bound_option,
    check_source,
    check_why,
    ea_option,
    fa_option,
    format_option,
    hosts_option,
    isolate_option,
    limit_option,
    map_option,
    output_option,
    paths_option,
    patience_option,
    policy_option,
    why_option,
    workers_option,
)
from prima.cli.outputs import check_output
from prima.cli.printing import columns, put, tell, tell_problems, write_for_programs
from prima.cli.progress import run_into
from prima.cli.runs import tell_failures
from prima.errors import TOO_MUCH, RunError, UsageError, counted
from prima.language.values import MOST_SEED

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.experiments.plan import Options
    from prima.loading import Loaded

FOLDER_ENDINGS = ("/", os.sep)


@click.command()
@click.argument("scenarios", metavar="[SCENARIO]...", nargs=-1, type=PathName())
@fa_option
@ea_option
@click.option("--say", "says", multiple=True, help="The user's answer to the next question.")
@output_option("Write the transcript here as JSON lines; for several runs, a folder.")
@policy_option("The mediator's policy: {}. Repeat for a run under each.", many=True)
@bound_option
@patience_option
@click.option(
    "--seed",
    type=Whole(0, MOST_SEED),
    help="Draw what the scenario leaves to chance by this number, instead of its own.",
)
@why_option
@hosts_option
@isolate_option
@paths_option(
    "--from",
    "lists",
    "Run the scenarios listed in this file, one per line; - is standard input.",
    metavar="FILE",
)
@workers_option
@click.option("--resume", is_flag=True, help="Skip runs whose transcripts are up to date.")
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
    seed: int | None,
    why: bool,
    hosts: tuple[str, ...],
    isolate: str,
    lists: tuple[str, ...],
    workers: int | None,
    resume: bool,
    maps: tuple[str, ...],
    form: str,
) -> None:
    """Run scenarios in simulation and print the mediated transcript, or a row for each run.

    Without SCENARIO, the applications named by --fa and --ea run in an empty room,
    and each --say answers one question, in order.

    With -o the transcript is written as JSON lines during the run, and only a
    summary is printed; -o - writes the lines to stdout. Exit code 3 if the run
    ended by an error or a limit.

    Several scenarios, a folder of them or several policies are a batch: the runs use
    all cores, a failed run does not stop the others, and each has a row and a
    transcript in the folder after -o. The exit code is the highest of all runs.

    \b
    prima run documents/scenarios/follow-during-navigation.xml -o mediated.jsonl
    prima run --ea documents/ea/library.xml --say "The C Primer"
    prima run documents/scenarios --policy prima --policy fifo -o runs/
    prima run documents/scenarios --policy prima --policy fifo -o runs/ --resume
    """
    from prima.experiments.plan import Options

    applications = bool(fas or eas)
    _check_source(bool(scenarios or lists), applications, bool(says), bool(maps))
    options = Options(bound, patience, isolate, hosts, seed, resume=resume)
    if lists or workers or resume or _are_several(scenarios, policies, output):
        _check_batch(applications, why, resume, output)
        from prima.cli.batch import listed, run_all

        paths = [*scenarios, *chain.from_iterable(map(listed, lists))]
        run_all(paths, policies, output or "", options, workers or 0, form)
        return
    from prima import api

    check_why(why, form, output)
    scenario = next(iter(scenarios), "")
    loaded = api.load_scenario(scenario) if scenario else api.stage(fas, eas, says, maps=maps)
    if output == "-":
        output, form = None, "json"
    elif output is not None:
        _check_file(output, os.path.dirname(scenario), loaded)
    tell_problems(loaded.problems)
    policy = next(iter(policies), None)
    _report_end(_run_one(loaded, output, policy, options, why, form))


def _check_source(scenarios: bool, applications: bool, says: bool, maps: bool) -> None:
    """Refuse a run of both scenarios and applications, and options that the source excludes.

    Raises:
        UsageError: the options contradict each other.
    """
    check_source(scenarios, applications)
    if says and not applications:
        raise UsageError(
            "--say works only with --fa and --ea: a scenario has the user's answers in it."
        )
    if maps and not applications:
        raise UsageError(MAPS)


def _are_several(scenarios: tuple[str, ...], policies: tuple[str, ...], output: str | None) -> bool:
    """Whether scenarios, policies or the output name a batch."""
    several = len(scenarios) > 1 or len(policies) > 1
    return several or any(map(os.path.isdir, scenarios)) or (output or "").endswith(FOLDER_ENDINGS)


def _check_batch(applications: bool, why: bool, resume: bool, output: str | None) -> None:
    """Refuse options that only one run can have.

    Raises:
        UsageError: one of them is given.
    """
    if applications:
        raise UsageError("--fa and --ea name one run; for several, write scenarios.")
    check_why(why, "", output="")
    if resume and output is None:
        raise UsageError("--resume needs the folder of the transcripts: -o FOLDER.")
    is_file = output is not None and output.endswith(".jsonl") and not os.path.isdir(output)
    if output == "-" or is_file:
        raise UsageError(f"{output}: several transcripts go into a folder: -o runs/.")


def _check_file(output: str, folder: str, loaded: Loaded) -> None:
    """Refuse to write a transcript to a folder or over a document.

    Raises:
        UsageError: it would.
    """
    if os.path.isdir(output):
        hint = f'For a transcript in it, write "{output}/".'
        raise UsageError(f"{output}: cannot be written: Is a directory. {hint}")
    check_output(output, "run", *(os.path.join(folder, name) for name in loaded.files))


def _run_one(
    loaded: Loaded, output: str | None, policy: str | None, options: Options, why: bool, form: str
) -> Transcript:
    """Run, and write the transcript to a file or print it."""
    from prima import api

    def rehearse(sink: api.Sink | None, keep: bool = False) -> Transcript:
        return api.rehearse(loaded, policy, sink=sink, keep=keep, **options.arguments())

    if output is not None:
        transcript = run_into(output, rehearse)
        tell(f"{output}: {_outline(transcript)}")
    elif form == "json":
        write_for_programs()
        transcript = rehearse(sys.stdout.write)
    else:
        transcript = rehearse(None, keep=True)
        put(transcript.table(why, columns()))
    return transcript


def _report_end(transcript: Transcript) -> None:
    """Print why a run ended early, and what failed in it.

    Raises:
        Exit: an application ended by an error.
        RunError: the run ended by a limit.
    """
    if transcript.unfinished:
        seconds = transcript.summary().seconds
        until = "; ".join(transcript.unfinished)
        tell(f"The run was stopped at {seconds:g} s, the scenario's until: {until}.")
    failed = tell_failures([transcript])
    if transcript.outcome == "limit":
        raise RunError(TOO_MUCH)
    if failed:
        raise Exit(3)


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
