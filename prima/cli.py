"""The command line: it alone prints, sets exit codes and catches everything.

Exit codes: 0 fine; 1 problems found, or transcripts differ; 2 wrong usage or
unreadable input; 3 a run ended by an error or a limit; 130 Ctrl-C.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click
from click.exceptions import Exit

from prima import __version__
from prima.errors import DocumentError, Problem, RunError, UsageError, did_you_mean

if TYPE_CHECKING:
    from prima.api import Transcript

POLICIES = "prima, fifo, fair, fixed, fixed:APP or none"
WATCHDOG_SECONDS = 5.0
"""How long one evaluation of a document's script may hold the process up."""
INSTANT_SECONDS = 20.0
"""How long the scripts of one instant of a run may take together."""


class Commands(click.Group):
    """Commands with a suggestion for a misspelt one."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find a command, or say which one was probably meant."""
        name = args[0] if args else ""
        if name and not name.startswith("-") and self.get_command(ctx, name) is None:
            hint = did_you_mean(name, self.list_commands(ctx))
            raise click.UsageError(f'There is no command "{name}". {hint}'.rstrip(), ctx)
        return super().resolve_command(ctx, args)


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="prima")
def cli() -> None:
    """Mediate robot applications written as XML documents.

    \b
    prima validate documents/fa/follow.xml
    prima run documents/scenarios/follow-during-navigation.xml
    """


_format = click.option(
    "--format",
    "form",
    type=click.Choice(["text", "json"]),
    default="text",
    help="What to print.",
)


def _coloured() -> bool:
    return sys.stdout.isatty() and "NO_COLOR" not in os.environ


def _clean(text: str) -> str:
    """Text of a stranger's without control characters, which a terminal would obey."""
    return "".join(
        letter if letter.isprintable() or letter in "\n\t" else "\ufffd" for letter in text
    )


def _print(text: str) -> None:
    """Data, to stdout."""
    click.echo(_clean(text), nl=not text.endswith("\n"))


def _tell(text: str) -> None:
    """A message, to stderr."""
    click.echo(_clean(text), err=True)


def _print_json(data: Any) -> None:
    import json

    click.echo(json.dumps(data, ensure_ascii=False, indent=2))


def _problem_data(problem: Problem) -> dict[str, Any]:
    return {
        "file": problem.place.file,
        "line": problem.place.line,
        "column": problem.place.column,
        "severity": problem.severity,
        "code": problem.code,
        "message": problem.message,
        "remedy": problem.remedy,
    }


@cli.command()
@click.argument("files", nargs=-1, required=True, type=click.Path())
@_format
def validate(files: tuple[str, ...], form: str) -> None:
    """Check documents of any kind: applications, worlds, robots, scenarios.

    All problems of every file are printed, each with its place and what to write
    instead. Exit code 1 if any is an error, 2 if a file cannot be read.

    \b
    prima validate documents/fa/*.xml documents/ea/*.xml
    """
    from prima import api

    problems: list[Problem] = []
    unread: list[str] = []
    for name in files:
        try:
            problems += api.validate([name])
        except UsageError as error:
            unread.append(str(error))
    if form == "json":
        _print_json([_problem_data(one) for one in problems])
    else:
        for problem in problems:
            _print(str(problem))
    for message in unread:
        _tell(f"prima: {message}")
    errors = sum(problem.severity == "error" for problem in problems)
    if form == "text" and not unread:
        notes = sum(problem.severity == "note" for problem in problems)
        warnings = len(problems) - errors - notes
        counts = f"errors: {errors}, warnings: {warnings}" if errors + warnings else "no problems"
        _tell(f"files: {len(files)}; {counts}" + (f", notes: {notes}" if notes else ""))
    if unread or errors:
        raise Exit(2 if unread else 1)


@cli.command()
@click.argument("scenario", type=click.Path(), required=False)
@click.option("--fa", "fas", multiple=True, type=click.Path(), help="Run this as the robot's own.")
@click.option("--ea", "eas", multiple=True, type=click.Path(), help="Run this as the place's.")
@click.option("--say", "says", multiple=True, help="The user's answer to the next question.")
@click.option("-o", "--output", type=click.Path(), help="Write the transcript here as JSON lines.")
@click.option("--policy", help=f"The mediator's policy: {POLICIES}.")
@click.option(
    "--bound", type=click.IntRange(1), help="Let nobody wait longer than this many loops (rule E4)."
)
@click.option("--why", "--explain", is_flag=True, help="Print the rule that put each row there.")
@click.option(
    "--allow-host",
    "hosts",
    metavar="HOST[:PORT]",
    multiple=True,
    help="Let VoiceXML documents fetch from this host; without, no network is used.",
)
@_format
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

    if (scenario is None) == (not fas and not eas):
        raise UsageError("Name a scenario, or applications with --fa and --ea.")
    if scenario is not None and says:
        raise UsageError(
            "A scenario says itself what the user says; --say goes with --fa and --ea."
        )
    loaded = api.load_scenario(scenario) if scenario is not None else api.stage(fas, eas, says)
    if output is not None and _is_source(output, scenario or "", loaded.files):
        raise UsageError(f"{output}: this is one of the run's own documents; write elsewhere.")
    for problem in loaded.problems:
        if problem.severity != "note":
            _tell(str(problem))
    _start_watchdog()
    if output is not None:
        transcript = _run_into(
            output, lambda sink: api.rehearse(loaded, policy, bound, sink, False, hosts)
        )
        _tell(f"{output}: {_outline(transcript)}")
    elif form == "json":
        transcript = api.rehearse(loaded, policy, bound, sys.stdout.write, False, hosts)
    else:
        transcript = api.rehearse(loaded, policy, bound, hosts=hosts)
        _print(transcript.table(why))
    for failure in transcript.failures:
        _tell(f"prima: {failure.rstrip(': ')}{_handling(failure)}")
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


def _is_source(output: str, scenario: str, files: dict[str, str]) -> bool:
    """Whether an output would overwrite what the run is made of."""
    folder = os.path.dirname(scenario)
    sources = {os.path.realpath(os.path.join(folder, name)) for name in files}
    return os.path.realpath(output) in sources


def _run_into(output: str, rehearse: Callable[[Any], Transcript]) -> Transcript:
    """Run with the transcript written line by line, so that nothing is lost on the way."""
    try:
        with open(output, "w", encoding="utf-8", buffering=1) as stream:
            return rehearse(stream.write)
    except OSError as error:
        raise UsageError(f"{output}: cannot be written: {error.strerror}.") from None


def _outline(transcript: Transcript) -> str:
    summary = transcript.summary()
    return (
        f"{transcript.measure.records if transcript.measure else 0} records of {summary.seconds:.1f} s,"
        f" {summary.streams_broken} streams broken, {summary.reactions} reactions"
        f" after {summary.reaction_mean:.2f} s on average"
    )


def _start_watchdog() -> None:
    """End the process when a script escapes the engine's own limits (exit code 3).

    The engine lets go of the interpreter lock while it evaluates, so this thread
    runs even if an evaluation never comes back. What was written is on disk.
    """
    import threading
    import time

    from prima.interpreter.expressions import Engine
    from prima.session import Session

    def watch() -> None:
        seen, since = -1, time.monotonic()
        instant, began = -1, time.monotonic()
        while True:
            time.sleep(0.25)
            count = Engine.evaluations
            if Session.instants != instant:
                instant, began = Session.instants, time.monotonic()
            if count % 2 == 0 or count != seen:
                seen, since = count, time.monotonic()
            stuck = time.monotonic() - since > WATCHDOG_SECONDS
            if stuck or (count % 2 and time.monotonic() - began > INSTANT_SECONDS):
                message = "prima: a document's script does not come back; the run is ended.\n"
                os.write(2, message.encode())
                os._exit(3)

    threading.Thread(target=watch, daemon=True).start()


@cli.command()
@click.argument("transcript", type=click.Path())
@click.option("--why", "--explain", is_flag=True, help="Print the rule that put each row there.")
def show(transcript: str, why: bool) -> None:
    """Print a transcript as the table that people read.

    \b
    prima show mediated.jsonl --why
    """
    from prima import api

    made = api.read(transcript, partial=True)
    _print(made.table(why))
    if made.cut:
        _tell(f"prima: {made.cut}")
        raise Exit(2)


@cli.command()
@click.argument("before", type=click.Path())
@click.argument("after", type=click.Path())
@_format
def diff(before: str, after: str, form: str) -> None:
    """Compare two transcripts by behaviour: moved, added, lost, split, changed, delayed.

    Exit code 0 if they are alike, 1 if they differ.

    \b
    prima diff mediated.jsonl fifo.jsonl
    """
    from prima import api
    from prima.transcript.diff import difference_data, format_difference

    difference = api.diff(api.read(before), api.read(after))
    if form == "json":
        _print_json(difference_data(difference))
    else:
        click.echo(format_difference(difference, _coloured()), nl=False, color=_coloured())
    if difference.differs:
        raise Exit(1)


@cli.command()
@click.argument("transcript", type=click.Path())
@click.argument("scenario", type=click.Path())
@click.option("-o", "--output", type=click.Path(), help="Write the replayed transcript here.")
def replay(transcript: str, scenario: str, output: str | None) -> None:
    """Run a transcript's inbound events again and check that the same comes out.

    \b
    prima replay mediated.jsonl documents/scenarios/follow-during-navigation.xml
    """
    from prima import api

    original = api.read(transcript)
    again = api.replay(original, scenario)
    if output is not None:
        _run_into(output, lambda write: (write(again.dumps()), again)[1])
    same = again.dumps() == original.dumps()
    _tell("the same, byte for byte" if same else "the replay differs")
    if not same:
        raise Exit(1)


@cli.command()
@click.argument("what")
@click.argument("row", type=int, required=False)
def explain(what: str, row: int | None) -> None:
    """Explain a problem's CODE, or why a ROW of a transcript came where it did.

    \b
    prima explain undeclared-variable
    prima explain mediated.jsonl 16
    """
    from prima import api

    if row is None and not os.path.exists(what):
        _print(api.explain(what))
    elif row is None:
        raise UsageError("Say which row of the transcript: prima explain TRANSCRIPT ROW.")
    else:
        _print(api.explain_row(api.read(what), row))


@cli.command()
@click.argument("folder", type=click.Path())
def documents(folder: str) -> None:
    """Copy the documents that come with PRIMA to a new FOLDER, to read, run and change.

    \b
    prima documents my-robot
    prima run my-robot/scenarios/follow-during-navigation.xml
    """
    import shutil

    from prima import api

    try:
        shutil.copytree(api.documents_folder(), folder)
    except FileExistsError:
        raise UsageError(f"{folder}: is there already; name a new folder.") from None
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written: {error.strerror}.") from None
    _tell(f"{folder}: applications, worlds, robots and scenarios")


@cli.command()
@click.argument("scenarios", nargs=-1, type=click.Path())
@click.option("--policy", "policies", multiple=True, help="Only this policy; may be repeated.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "json", "csv"]),
    default="text",
    help="What to print.",
)
def study(scenarios: tuple[str, ...], policies: tuple[str, ...], form: str) -> None:
    """Run situations under every policy and measure what became of units, streams and channel.

    Without SCENARIOS these are the ten situations of the thesis. docs/measures.md
    says what the columns count. A "!" marks a run in which an application failed.

    \b
    prima study
    prima study my-scenario.xml --policy prima --policy fifo --format csv
    """
    from prima.study import POLICIES as ALL
    from prima.study import format_csv, format_table, result_data, situations
    from prima.study import study as run_study

    chosen, results = scenarios or tuple(map(str, situations())), []
    total = len(chosen) * len(policies or ALL)
    _start_watchdog()
    for result in run_study(chosen, policies or ALL):
        results.append(result)
        if sys.stderr.isatty():
            click.echo(f"\r{len(results)} of {total} runs", err=True, nl=len(results) == total)
    if form == "json":
        _print_json([result_data(result) for result in results])
    else:
        _print(format_csv(results) if form == "csv" else format_table(results))


def main() -> None:
    """Run the command line; every way out has its exit code and no traceback."""
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    code: Any = 0
    try:
        code = cli.main(standalone_mode=False)
        sys.stdout.flush()
        code = code if isinstance(code, int) else 0
    except SystemExit:
        code = 0  # click's way of saying that nobody reads any more
    except DocumentError as error:
        for problem in error.problems:
            _tell(str(problem))
        code = 1
    except UsageError as error:
        _tell(f"prima: {error}")
        code = 2
    except RunError as error:
        _tell(f"prima: {error}")
        code = 3
    except click.ClickException as error:
        context = getattr(error, "ctx", None)
        usage = f"{context.get_usage()}\n" if context is not None else ""
        _tell(f"{usage}prima: {error.format_message()}")
        code = 2
    except (click.Abort, KeyboardInterrupt):
        _tell("prima: interrupted")
        code = 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    except OSError as error:
        _tell(f"prima: cannot go on: {error.strerror}.")
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        code = 2
    except MemoryError:
        _tell("prima: out of memory")
        code = 3
    except Exception as error:
        if "PRIMA_DEBUG" in os.environ:
            raise
        click.echo(
            f"prima: this is a defect of prima: {type(error).__name__}: {error}."
            " Please report it; PRIMA_DEBUG=1 shows where.",
            err=True,
        )
        code = 3
    sys.exit(code)
