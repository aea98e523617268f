"""What the commands share: printing, options, and a guard against scripts that do not end."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import IO, TYPE_CHECKING, Any

import click

from prima.errors import UsageError, did_you_mean, one_of
from prima.errors.visible import escaped, visible

if TYPE_CHECKING:
    from pathlib import Path

    from prima.api import Transcript
    from prima.errors import Problem


class Choice(click.Choice[str]):
    """One of some words, with a suggestion for a misspelt one."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """The word, or a refusal that says which one was probably meant."""
        words = [str(word) for word in self.choices]
        if value not in words:
            hint = did_you_mean(str(value), words) or f"Write {one_of(words)}."
            self.fail(f'There is no "{value}" here. {hint}', param, ctx)
        return str(value)


def suggesting(*words: str) -> Callable[[click.Context, click.Parameter, str], list[str]]:
    """What the shell completes an option to whose values are checked later."""
    return lambda _context, _parameter, begun: [one for one in words if one.startswith(begun)]


def or_stdout(_context: click.Context, _option: click.Parameter, path: str | None) -> str | None:
    """What is written to ``-`` goes where it goes without ``-o``: to stdout."""
    return None if path == "-" else path


REFUSING = ("strict", "surrogateescape")
"""Ways of Python to deal with what an encoding lacks that end in an error."""
PROGRESS_SECONDS = 0.5
"""How often a terminal is told how far a long run is."""
format_option = click.option(
    "--format",
    "form",
    type=Choice(["text", "json"]),
    default="text",
    help="What to print.",
)
limit_option = click.option(
    "--limit",
    "limits",
    metavar="NAME=NUMBER",
    multiple=True,
    help="Raise a limit on documents: bytes, elements, attributes, depth or problems.",
)
map_option = click.option(
    "--map",
    "maps",
    metavar="URI=FOLDER",
    multiple=True,
    help="Read what VoiceXML documents name at this URI, or below, from this folder.",
)
MAPS = 'A scenario says itself where it is served: <application src="..." uri="https://..."/>.'
"""What to write in place of ``--map`` in a scenario."""
why_option = click.option(
    "--why", "--explain", is_flag=True, help="Print the rule that put each row there."
)


PATIENCE = "Let no application keep another from the speaker for longer, 60s by default (rule E6)."
"""What ``--patience`` is for."""


def duration_option(name: str, meaning: str) -> Callable[[Any], Any]:
    """An option whose value is a time as documents write it; it is given in ms."""

    def read(_context: click.Context, _option: click.Parameter, text: str | None) -> int | None:
        from prima.language.values import read_value

        try:
            return None if text is None else int(read_value("duration", text))
        except ValueError as error:
            raise UsageError(f'{name} "{text}" {error}') from None

    return click.option(name, metavar="TIME", callback=read, help=meaning)


def coloured() -> bool:
    """Whether to colour what goes to stdout."""
    return sys.stdout.isatty() and "NO_COLOR" not in os.environ


def columns() -> int:
    """How wide a table on stdout may be: as the terminal, or 80 columns where there is none."""
    import shutil

    return shutil.get_terminal_size((80, 24)).columns if sys.stdout.isatty() else 80


def clean(text: str) -> str:
    """Text for a terminal, in lines: without what it would obey."""
    return visible(text, "\n\t")


def escape_for_people() -> None:
    """Let stdout show with escapes what its encoding lacks, as stderr does."""
    out = sys.stdout
    if isinstance(out, io.TextIOWrapper) and not _is_utf8(out) and out.errors in REFUSING:
        out.reconfigure(errors="backslashreplace")


def write_for_programs() -> None:
    """Let what programs read go to stdout as UTF-8, whatever encoding people see there."""
    if isinstance(sys.stdout, io.TextIOWrapper) and not _is_utf8(sys.stdout):
        sys.stdout.reconfigure(encoding="utf-8", errors="strict")


def _is_utf8(out: io.TextIOWrapper) -> bool:
    return out.encoding.lower().replace("-", "").replace("_", "") == "utf8"


def put(text: str) -> None:
    """Text for people, to stdout."""
    click.echo(clean(text), nl=not text.endswith("\n"))


def tell(text: str) -> None:
    """A message, to stderr; if nothing can be written there, nobody is told."""
    with suppress(OSError):
        click.echo(clean(text), err=True)


def tell_problems(problems: list[Problem]) -> None:
    """What is odd in the documents of a run."""
    from prima.errors import listed
    from prima.markup.limits import LIMITS

    for problem in listed([one for one in problems if one.severity != "note"], LIMITS.problems):
        tell(str(problem))


def tell_cut(*transcripts: Transcript) -> None:
    """Say of transcripts that they end before their runs did; what is there has been shown.

    Raises:
        click.exceptions.Exit: with 2: one ends at a line that cannot be read.
    """
    for transcript in transcripts:
        if message := transcript.cut or transcript.early:
            tell(f"prima: {message}")
    if any(transcript.cut for transcript in transcripts):
        raise click.exceptions.Exit(2)


def print_json(data: Any) -> None:
    """Data as JSON, to stdout."""
    import json

    write_for_programs()
    click.echo(escaped(json.dumps(data, ensure_ascii=False, indent=2)))


def raise_limits(given: tuple[str, ...]) -> None:
    """Raise the limits on documents, as ``NAME=NUMBER``.

    Raises:
        UsageError: there is no such limit, or it cannot be that high.
    """
    from prima.markup.limits import HIGHEST, LIMITS

    names = ("bytes", "elements", "attributes", "depth", "problems")
    for text in given:
        name, _, number = text.partition("=")
        if name not in names:
            hint = did_you_mean(name, names) or f"Write {one_of(names)}."
            raise UsageError(f'There is no limit "{name}". {hint}')
        most = getattr(HIGHEST, name)
        if not (number.isascii() and number.isdigit() and 0 < int(number[:12]) <= most):
            raise UsageError(f'--limit {text}: write a whole number up to {most}, as "{name}=200".')
        setattr(LIMITS, name, int(number))


class SourceLines:
    """The lines of files, each file read once, for the source line of a problem."""

    def __init__(self) -> None:
        self._held: dict[str, list[str]] = {}

    def __call__(self, file: str) -> list[str]:
        """A file's lines; none where it cannot be read."""
        if file not in self._held:
            from prima.errors import DocumentError
            from prima.loading.files import read_file
            from prima.markup.reader import decode

            try:
                self._held[file] = decode(file, read_file(file)).split("\n")
            except (DocumentError, UsageError):
                self._held[file] = []
        return self._held[file]


def check_output(output: str | Path, made: str, *inputs: str | Path) -> None:
    """See whether a command may write to a file, before it does anything else.

    What commands wrote earlier may be replaced, and so may what is no file, as ``/dev/null``.

    Args:
        output: the path to write to.
        made: what is written, as "page".
        inputs: paths of what it is made of.

    Raises:
        UsageError: it is an input, a document, or where a scenario's expected table stands.
    """
    from pathlib import Path

    from prima.testing.finding import is_scenario
    from prima.testing.golden import golden_of

    if any(same_file(output, path) for path in inputs):
        raise UsageError(f"{output}: this is what the {made} is made of; write elsewhere.")
    path, real = Path(output), Path(os.path.realpath(output))
    if real.is_file() and _begins_document(real):
        raise UsageError(
            f"{output}: this is a document that somebody has written; write elsewhere."
        )
    beside = [one.with_suffix(".xml") for one in (path, real) if one.suffix == ".txt"]
    for scenario in (*map(Path, inputs), *beside):
        if scenario.is_file() and is_scenario(scenario) and same_file(golden_of(scenario), path):
            raise UsageError(
                f"{output}: here stands the expected table of {scenario}; write elsewhere."
            )


def _begins_document(path: Path) -> bool:
    """Whether a file is a document that somebody writes, as far as its beginning tells."""
    import re

    from prima.loading import is_grammar
    from prima.markup.opening import root_of
    from prima.testing.finding import GLANCE

    try:
        with path.open("rb") as stream:
            data = stream.read(GLANCE)
    except OSError:
        return False  # writing tells what is wrong
    root = rb"<(?:[\w.-]+:)?(?:prima|scenario|world|robot|vxml)(?:[\s>/]|$)"
    return bool(re.match(root, root_of(data))) or is_grammar(data)


def same_file(one: str | Path, other: str | Path) -> bool:
    """Whether two paths are one file, that is there or not; what is no file is never one."""
    if os.path.isfile(one) and os.path.isfile(other):
        return os.path.samefile(one, other)
    there = os.path.exists(one) or os.path.exists(other)
    return not there and os.path.realpath(one) == os.path.realpath(other)


def run_into(output: str, rehearse: Callable[[Any], Transcript]) -> Transcript:
    """Run with the transcript written line by line, so that nothing is lost on the way.

    The file is opened when there is something to write: a run that is refused leaves it as it is.
    """
    stream: IO[str] | None = None

    def write(line: str) -> None:
        nonlocal stream
        if stream is None:
            line.encode()  # may be refused, too
            opened = open(output, "w", encoding="utf-8", buffering=1)  # noqa: SIM115
            stream = files.enter_context(opened)
        stream.write(line)

    try:
        with ExitStack() as files:
            if not sys.stderr.isatty():
                return rehearse(write)
            made = rehearse(_with_progress(write))
            click.echo(f"\r{' ' * 60}\r", err=True, nl=False)
            return made
    except OSError as error:
        raise UsageError(f"{output}: cannot be written: {error.strerror}.") from None
    except UnicodeEncodeError:
        message = "a transcript cannot name a file whose path is not UTF-8; rename it."
        raise UsageError(f"{output}: {message}") from None


def _with_progress(write: Callable[[str], object]) -> Callable[[str], None]:
    """Write lines, and tell a terminal now and then how far the run is."""
    import time

    told = time.monotonic()
    count = 0

    def note(line: str) -> None:
        nonlocal told, count
        write(line)
        count += 1
        if time.monotonic() - told > PROGRESS_SECONDS:
            told = time.monotonic()
            seconds = line.removeprefix('{"time":').partition(",")[0]
            click.echo(f"\r{seconds} s, {count} records ", err=True, nl=False)

    return note
