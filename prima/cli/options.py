"""Options that commands share, and the types of their values."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from prima.errors import UsageError, did_you_mean, one_of


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


class PathName(click.Path):
    """The path of a file or folder, which need not exist."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path, or an error if it is empty, as an unset variable of a shell is."""
        if not value:
            self.fail("it is empty; write a path.", param, ctx)
        return super().convert(value, param, ctx)


def suggesting(*words: str) -> Callable[[click.Context, click.Parameter, str], list[str]]:
    """A shell completion for an option whose values are checked later."""
    return lambda _context, _parameter, begun: [one for one in words if one.startswith(begun)]


def or_stdout(_context: click.Context, _option: click.Parameter, path: str | None) -> str | None:
    """``-o -`` means stdout, as without ``-o``."""
    return None if path == "-" else path


def formats_option(*words: str, meaning: str = "What to print.") -> Callable[[Any], Any]:
    """An option for the format of the output, by default the first."""
    choice = SuggestingChoice(words)
    return click.option("--format", "form", type=choice, default=words[0], help=meaning)


def output_option(meaning: str, **more: Any) -> Callable[[Any], Any]:
    """An option for the file or folder to write."""
    return click.option("-o", "--output", type=PathName(), help=meaning, **more)


def paths_option(option: str, name: str, meaning: str, **more: Any) -> Callable[[Any], Any]:
    """An option for paths, which may be repeated."""
    return click.option(option, name, multiple=True, type=PathName(), help=meaning, **more)


format_option = formats_option("text", "json")
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


def check_why(why: bool, form: str, output: str | None = None) -> None:
    """Refuse --why where records are printed or written in place of a table.

    Raises:
        UsageError: it is given there.
    """
    if why and (form == "json" or output is not None):
        raise UsageError("--why works only with a table: prima show TRANSCRIPT --why.")


def check_source(scenarios: bool, applications: bool) -> None:
    """Check that a scenario or applications are named, and not both.

    Raises:
        UsageError: they are not.
    """
    if scenarios and applications:
        raise UsageError("A scenario names its own applications; leave out --fa and --ea.")
    if not (scenarios or applications):
        raise UsageError("Name a scenario, or applications with --fa and --ea.")


def duration_option(name: str, meaning: str, default: str | None = None) -> Callable[[Any], Any]:
    """An option whose value is a time as written in documents, converted to ms."""

    def read(_context: click.Context, _option: click.Parameter, text: str | None) -> int | None:
        from prima.language.values import read_value

        try:
            return None if text is None else int(read_value("duration", text))
        except ValueError as error:
            raise UsageError(f'{name} "{text}" {error}') from None

    return click.option(name, metavar="TIME", default=default, callback=read, help=meaning)


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


def _raise_limits(
    context: click.Context, parameter: click.Parameter, given: tuple[str, ...]
) -> None:
    """Raise limits on documents, given as ``NAME=NUMBER``.

    Raises:
        UsageError: there is no such limit, or it cannot be that high.
    """
    from prima.markup.limits import HIGHEST, set_limits

    names = ("bytes", "elements", "attributes", "depth", "problems")
    for text in given:
        name, _, number = text.partition("=")
        if name not in names:
            hint = did_you_mean(name, names) or f"Write {one_of(names)}."
            raise UsageError(f'There is no limit "{name}". {hint}')
        most = getattr(HIGHEST, name)
        if not (number.isascii() and number.isdigit() and 0 < int(number[:12]) <= most):
            raise UsageError(f'--limit {text}: write a whole number up to {most}, as "{name}=200".')
        set_limits({name: int(number)})


limit_option = click.option(
    "--limit",
    "limits",
    metavar="NAME=NUMBER",
    multiple=True,
    expose_value=False,
    callback=_raise_limits,
    help="Raise a limit on documents: bytes, elements, attributes, depth or problems.",
)
