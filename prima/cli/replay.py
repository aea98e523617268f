"""prima replay."""

from __future__ import annotations

from itertools import zip_longest
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.options import PathName, limit_option
from prima.cli.outputs import check_output
from prima.cli.printing import echo, tell, tell_cut, write_for_programs

if TYPE_CHECKING:
    from prima.api import Transcript


@click.command()
@click.argument("transcript", type=PathName())
@click.argument("scenario", type=PathName(), required=False)
@click.option("-o", "--output", type=PathName(), help="Write the replayed transcript here.")
@limit_option
def replay(transcript: str, scenario: str | None, output: str | None) -> None:
    """Run a transcript's inbound events again and check that the result is the same.

    The journal of a live run names what it was made with; other transcripts need their scenario.

    \b
    prima replay mediated.jsonl documents/scenarios/follow-during-navigation.xml
    prima replay visit.jsonl
    """
    from prima import api
    from prima.loading.writing import write_whole

    if output not in (None, "-"):
        check_output(output, "replay", transcript, *([scenario] if scenario else []))
    original = api.read(transcript, partial=True)
    if original.cut:
        tell_cut(original)
    again = api.replay(original, scenario)
    if output == "-":
        write_for_programs()
        echo(again.dumps(), nl=False)
    elif output is not None:
        write_whole(output, again.dumps())
    given, made = original.dumps(), again.dumps()
    if given != made and not (original.early and made.startswith(given)):
        tell(_differs(original, given, made))
        raise Exit(1)
    tell_cut(original)
    far = "" if given == made else ", as far as the transcript goes"
    tell(f"the same, byte for byte{far}")


def _differs(original: Transcript, given: str, made: str) -> str:
    """The message that a replay differs from a line on, with the remedy where there is one."""
    from prima.live.journal import CHANGED, sound_above

    pairs = zip_longest(given.splitlines(), made.splitlines())
    number = next(number for number, (one, other) in enumerate(pairs, 1) if one != other)
    remedy = sound_above(original.name, number) if "live" in original.records[0]["data"] else ""
    return f"the replay differs from line {number}: {CHANGED} {remedy}".rstrip()
