"""The triggers of ``<when>`` and of expectations that a record can fire."""

from __future__ import annotations

from prima.grammar.text import fold
from prima.interpreter.selection import takes
from prima.transcript.record import Entry

PHASES = {
    "asked": ("listening",),
    "said": ("listening", "end"),
    "doing": ("start",),
    "done": ("end",),
    "on": ("event", "emergency"),
}
"""The phases of the records that can fire each trigger."""


def fires(trigger: str, what: str, record: Entry, said: str) -> bool:
    """Whether a record fires a trigger; ``said`` is what its AB says.

    ``what`` is what the trigger waits for: words, a Command's type or an event's name.
    """
    if record.phase not in PHASES[trigger]:
        return False
    match trigger:
        case "asked":
            return holds(what, said)
        case "said":
            over = record.phase == "listening" or record.outcome == "done"
            return over and holds(what, said)
        case "doing":
            return record.first and record.command == what
        case "done":
            return record.outcome != "again" and record.command == what
    return takes(what, record.notice)


def holds(what: str, said: str) -> bool:
    """Whether something that is said contains these words."""
    return bool(said) and fold(what) in fold(said)
