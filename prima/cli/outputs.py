"""Checks of the files that commands write."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from prima.errors import UsageError

if TYPE_CHECKING:
    from pathlib import Path

TRANSCRIPTS = ("run", "replay", "journal")
"""Names of files that commands write and that may replace a transcript."""
TRANSCRIPT = rb'{"time":[\d.]+,"phase":"run",'
"""How transcripts begin."""


def check_output(output: str | Path, made: str, *inputs: str | Path) -> None:
    """Check that a command may write to a file, before it does anything else.

    Files that commands wrote earlier may be replaced; so may devices such as ``/dev/null``.

    Args:
        output: the path to write to.
        made: the kind of output, such as "page".
        inputs: the files that it is made from.

    Raises:
        UsageError: it is stdout, an input, a document, a scenario's expected table, or a
            transcript that would be replaced by something else.
    """
    from pathlib import Path

    from prima.testing.finding import is_scenario
    from prima.testing.golden import golden_of

    if str(output) == "-":
        raise UsageError("-: this does not go to stdout; name a file.")
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
