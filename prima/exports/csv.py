"""Comma-separated values (RFC 4180): a row for each interval and point."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

from prima.errors.visible import harmless
from prima.exports.timeline import COLUMNS, Timeline

HEAD = ("tier", "kind", "start", "end", "text", *COLUMNS)
NUMBERS = frozenset({"serial", "seconds"})


def write(timeline: Timeline, languages: dict[str, str]) -> Iterator[str]:
    """The rows, tier by tier, each tier by time; times in seconds."""
    buffer = io.StringIO(newline="")
    writer = csv.writer(buffer, lineterminator="\r\n")
    writer.writerow(HEAD)
    for tier in timeline.tiers:
        for mark in tier.marks:
            details = (
                mark.about.get(name, "") if name in NUMBERS else harmless(mark.about.get(name, ""))
                for name in COLUMNS
            )
            times = (f"{mark.start / 1000:.3f}", f"{mark.end / 1000:.3f}")
            texts = (harmless(tier.name), tier.kind, *times, harmless(mark.text))
            writer.writerow((*texts, *details))
            yield buffer.getvalue()
            buffer.seek(0)
            buffer.truncate()
    yield buffer.getvalue()
