"""Shared by the commands: printing, options, checks of output files."""

from __future__ import annotations

import io
import os
import shlex
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import click

from prima.errors import Problem, UsageError, did_you_mean, listed, one_of
from prima.errors.visible import escaped, visible

if TYPE_CHECKING:
    from pathlib import Path

    from prima.api import Transcript


class SuggestingChoice(click.Choice[str]):
    """A choice that suggests a word for a misspelt one."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """The word, or an error that suggests the one probably meant."""
        words = [str(word) for word in self.choices]
        if value not in words:
            hint = did_you_mean(str(value), words) or f"Write {one_of(words)}."
            self.fail(f'There is no "{value}" here. {hint}', param, ctx)
        return str(value)


class Number(click.FloatRange):
    """A number in a range. NaN is refused; click takes it to be in every range."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or an error."""
        number = super().convert(value, param, ctx)
        if number != number:
            self.fail(f"{value!r} is not a number.", param, ctx)
        return number


class Whole(click.IntRange):
    """A whole number in a range. Its name is that in messages; click's is "integer range"."""

    name = "integer"


def suggesting(*words: str) -> Callable[[click.Context, click.Parameter, str], list[str]]:
    """A shell completion for an option whose values are checked later."""
    return lambda _context, _parameter, begun: [one for one in words if one.startswith(begun)]


def or_stdout(_context: click.Context, _option: click.Parameter, path: str | None) -> str | None:
    """``-o -`` means stdout, as without ``-o``."""
    return None if path == "-" else path


REFUSING = ("strict", "surrogateescape")
"""Python's error handlers that raise for characters that an encoding lacks."""


def formats_option(*words: str, meaning: str = "What to print.") -> Callable[[Any], Any]:
    """An option for the format of the output, by default the first."""
    choice = SuggestingChoice(words)
    return click.option("--format", "form", type=choice, default=words[0], help=meaning)


def output_option(meaning: str, **more: Any) -> Callable[[Any], Any]:
    """An option for the file or folder to write."""
    return click.option("-o", "--output", type=click.Path(), help=meaning, **more)


def paths_option(option: str, name: str, meaning: str, **more: Any) -> Callable[[Any], Any]:
    """An option for paths, which may be repeated."""
    return click.option(option, name, multiple=True, type=click.Path(), help=meaning, **more)


format_option = formats_option("text", "json")
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
    help="Read resources of VoiceXML documents at or below this URI from this folder.",
)
MAPS = '--map works only with --fa and --ea. In a scenario write <application src="..." uri="https://..."/>.'
"""The error for ``--map`` with a scenario."""
MOST_WORKERS = 256
"""More processes than this are a typing error."""
workers_option = click.option(
    "-j",
    "--workers",
    type=Whole(1, MOST_WORKERS),
    help="Number of runs at once. By default the number of cores.",
)
on_option = click.option(
    "--on",
    "address",
    metavar="tcp://HOST:PORT",
    help="Make the runs on the workers of this scheduler of Dask.",
)
fa_option = paths_option("--fa", "fas", "Run this as the robot's application (FA).")
ea_option = paths_option("--ea", "eas", "Run this as the place's application (EA).")
bound_option = click.option(
    "--bound",
    type=Whole(1),
    help="Let no application wait longer than this many loops (rule E4).",
)
hosts_option = click.option(
    "--allow-host",
    "hosts",
    metavar="HOST[:PORT]",
    multiple=True,
    help="Let VoiceXML documents fetch from this host. By default no network is used.",
)
isolate_option = click.option(
    "--isolate",
    type=click.Choice(["ea", "all", "none"]),
    default="ea",
    help="Run scripts in a separate process: for each EA, for each application, or for none.",
)
why_option = click.option(
    "--why", "--explain", is_flag=True, help="Print the rule that put each row there."
)

TRANSCRIPTS = ("run", "replay", "journal")
"""Names of files that commands write and that may replace a transcript."""
TRANSCRIPT = rb'{"time":[\d.]+,"phase":"run",'
"""How transcripts begin."""


def duration_option(name: str, meaning: str) -> Callable[[Any], Any]:
    """An option whose value is a time as written in documents, converted to ms."""

    def read(_context: click.Context, _option: click.Parameter, text: str | None) -> int | None:
        from prima.language.values import read_value

        try:
            return None if text is None else int(read_value("duration", text))
        except ValueError as error:
            raise UsageError(f'{name} "{text}" {error}') from None

    return click.option(name, metavar="TIME", callback=read, help=meaning)


patience_option = duration_option(
    "--patience",
    "Longest time an application may keep another from the speaker; default 60s (rule E6).",
)


def policy_option(meaning: str, many: bool = False, **more: Any) -> Callable[[Any], Any]:
    """An option for policies, which are checked later; its meaning lists them for ``{}``."""
    from prima.scheduler.policy import POLICIES, USAGE

    names = ("--policy", "policies") if many else ("--policy",)
    more["help"] = meaning.format(USAGE)
    return click.option(*names, multiple=many, shell_complete=suggesting(*POLICIES), **more)


def coloured() -> bool:
    """Whether to colour what goes to stdout: not if ``NO_COLOR`` has a value (no-color.org)."""
    return sys.stdout.isatty() and not os.getenv("NO_COLOR") and os.getenv("TERM") != "dumb"


def columns() -> int:
    """Maximum width of a table: the terminal's, or 80 if stdout is not a terminal."""
    import shutil

    return shutil.get_terminal_size((80, 24)).columns if sys.stdout.isatty() else 80


def clean(text: str) -> str:
    """Text with control characters made visible, except newlines and tabs."""
    return visible(text, "\n\t")


def escape_for_people() -> None:
    """Write characters that stdout's encoding lacks as escapes, as stderr does."""
    out = sys.stdout
    if isinstance(out, io.TextIOWrapper) and not _is_utf8(out) and out.errors in REFUSING:
        out.reconfigure(errors="backslashreplace")


def write_for_programs() -> None:
    """Write UTF-8 to stdout from now on, whatever the terminal's encoding."""
    if isinstance(sys.stdout, io.TextIOWrapper) and not _is_utf8(sys.stdout):
        sys.stdout.reconfigure(encoding="utf-8", errors="strict")


def _is_utf8(out: io.TextIOWrapper) -> bool:
    return out.encoding.lower().replace("-", "").replace("_", "") == "utf8"


def put(text: str) -> None:
    """Print text for people to stdout."""
    click.echo(clean(text), nl=not text.endswith("\n"))


def tell(text: str) -> None:
    """Print a message to stderr, if anything can be written there."""
    with suppress(OSError):
        click.echo(clean(text), err=True)


def tell_line(text: str) -> None:
    """Print a message to stderr as one line, though a name that it quotes may have several."""
    tell(visible(text))


def tell_problems(problems: list[Problem]) -> None:
    """Print the errors and warnings of a run's documents."""
    from prima.markup.limits import LIMITS

    for problem in listed([one for one in problems if one.severity != "note"], LIMITS.problems):
        tell_line(str(problem))


def tell_cut(*transcripts: Transcript) -> None:
    """Report transcripts that end before their runs did.

    Raises:
        click.exceptions.Exit: with 2, if one ends at an unreadable line.
    """
    for transcript in transcripts:
        if message := transcript.cut or transcript.early:
            tell(f"prima: {message}")
            if _goes_on(transcript):
                tell(how_to_go_on(transcript.name))
    if any(transcript.cut for transcript in transcripts):
        raise click.exceptions.Exit(2)


def _goes_on(transcript: Transcript) -> bool:
    """Whether a live run can go on from its journal: all lines but the last are whole."""
    from prima.transcript.lines import INCOMPLETE

    head = transcript.records[0].get("data", {}) if transcript.records else {}
    torn = not transcript.cut or transcript.cut.endswith(INCOMPLETE)
    return torn and "live" in head and not head.get("redacted")


def how_to_go_on(journal: str) -> str:
    """A message that a live run can go on from its journal."""
    return f"Go on with: prima live --resume {shlex.quote(journal)}"


def print_json(data: Any) -> None:
    """Print data as JSON to stdout."""
    import json

    write_for_programs()
    click.echo(escaped(json.dumps(data, ensure_ascii=False, indent=2)))


def raise_limits(given: tuple[str, ...]) -> None:
    """Raise limits on documents, given as ``NAME=NUMBER``.

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


def check_output(output: str | Path, made: str, *inputs: str | Path) -> None:
    """Check that a command may write to a file, before it does anything else.

    Files that commands wrote earlier may be replaced; so may devices such as ``/dev/null``.

    Args:
        output: the path to write to.
        made: the kind of output, such as "page".
        inputs: the files that it is made from.

    Raises:
        UsageError: it is an input, a document, a scenario's expected table, or a transcript
            that would be replaced by something else.
    """
    from pathlib import Path

    from prima.testing.finding import is_scenario
    from prima.testing.golden import golden_of

    if not str(output):
        raise UsageError('"" cannot be written: it is not a file name.')
    if any(same_file(output, path) for path in inputs):
        raise UsageError(f"{output}: the {made} is made from this file; write elsewhere.")
    path, real = Path(output), Path(os.path.realpath(output))
    if kind := _protected(real, made):
        raise UsageError(f"{output}: this file is a {kind}; write elsewhere.")
    beside = [one.with_suffix(".xml") for one in (path, real) if one.suffix == ".txt"]
    for scenario in (*map(Path, inputs), *beside):
        if scenario.is_file() and is_scenario(scenario) and same_file(golden_of(scenario), path):
            raise UsageError(
                f"{output}: this is the expected table of {scenario}; write elsewhere."
            )


def _protected(path: Path, made: str) -> str:
    """The kind of a file that nothing of this kind may replace, by how it begins; or empty."""
    import re

    from prima.loading import is_grammar
    from prima.markup.sniff import root_of
    from prima.testing.finding import GLANCE

    if not os.path.isfile(path):  # without an error for a name that is too long
        return ""
    try:
        with path.open("rb") as stream:
            data = stream.read(GLANCE)
    except OSError:
        return ""  # writing reports the error
    if made not in TRANSCRIPTS and re.match(TRANSCRIPT, data):
        return "transcript"
    root = rb"<(?:[\w.-]+:)?(?:prima|scenario|world|robot|vxml)(?:[\s>/]|$)"
    return "document" if re.match(root, root_of(data)) or is_grammar(data) else ""


def same_file(one: str | Path, other: str | Path) -> bool:
    """Whether two paths name the same file, which need not exist; false for devices."""
    if os.path.isfile(one) and os.path.isfile(other):
        return os.path.samefile(one, other)
    there = os.path.exists(one) or os.path.exists(other)
    return not there and os.path.realpath(one) == os.path.realpath(other)
