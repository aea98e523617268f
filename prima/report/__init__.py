"""One page of HTML that shows a run, or compares two: timeline, map, table, and why.

:func:`make` is the whole interface. The page is self-contained: it needs no other file, no
network and no library. The same transcripts give the same bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from prima.errors import UsageError

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.loading import Loaded

MOST_ROWS = 20_000
"""Maximum number of rows of a transcript on a page."""


def make(transcripts: Sequence[Transcript], scenarios: Sequence[Loaded | None] = ()) -> str:
    """The page of one transcript, or of two with their differences.

    Args:
        transcripts: one or two.
        scenarios: none, one for all transcripts, or one (or None) for each: they provide the map,
            the user's way and the languages, by making the run again.

    Raises:
        UsageError: too many transcripts, or too long ones; a scenario is not a transcript's.
    """
    from prima.api.transcripts import check_transcripts
    from prima.report.page import page
    from prima.report.view import view_of

    check_transcripts(*transcripts)
    if not 1 <= len(transcripts) <= 2:
        raise UsageError("A report shows one run or compares two.")
    if len(scenarios) not in (0, 1, len(transcripts)):
        raise UsageError("Name one scenario for all transcripts, or one for each.")
    found = list(scenarios) * (len(transcripts) if len(scenarios) == 1 else 1)
    views = []
    for index, transcript in enumerate(transcripts):
        rows = transcript.rows()
        if len(rows) > MOST_ROWS:
            message = f"it has {len(rows)} rows, and a page shows at most {MOST_ROWS}."
            raise UsageError(f"{transcript.name}: {message} Use prima show.")
        views.append(view_of(transcript, rows, found[index] if found else None))
    return page(views)


__all__ = ["make"]
