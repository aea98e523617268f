"""Table 4.2, independently: the devices of each type of Command, and its effect on the user."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from prima.invariants.model import Record


@dataclass(frozen=True)
class CommandRow:
    """One type of Command: its devices, and which of :data:`MARKS` it has."""

    devices: frozenset[str]
    marks: frozenset[str]


MARKS = ("feedback", "leaves", "engages")


def row(devices: str, marks: str = "") -> CommandRow:
    """A row, with devices and marks separated by spaces."""
    return CommandRow(frozenset(devices.split()), frozenset(marks.split()))


TABLE: Mapping[str, CommandRow] = {
    "active-sensing-human": row("human-detection locomotion localization", "feedback engages"),
    "face-human": row("human-detection locomotion", "engages"),
    "q-and-a": row("speaker speech-recognition", "engages"),
    "tracking-human": row("human-detection locomotion", "feedback engages"),
    "face-human-and-speak": row("human-detection locomotion speaker", "engages"),
    "turn-and-speak": row("locomotion localization speaker"),
    "set-direction": row("locomotion localization"),
    "turn": row("locomotion"),
    "set-speed-and-time": row("locomotion"),
    "stop-moving": row("locomotion"),
    "speak": row("speaker"),
    "move-head": row("neck"),
    "point-by-hand": row("arm"),
    "gesture": row("arm neck"),
    "topological-move": row("locomotion localization", "feedback leaves"),
    "set-position": row("locomotion localization", "feedback leaves"),
    "set-position-and-direction": row("locomotion localization", "feedback leaves"),
}


def contradictions(record: Record, table: Mapping[str, CommandRow] = TABLE) -> Iterable[str]:
    """How a request differs from a table, if it does. Types outside the table are not checked."""
    command, devices = record["command"], set(record["devices"])
    leaves = bool(record.get("leaves"))
    if (record["priority"] == "low") != leaves:
        yield f"its priority is {record['priority']}"  # K2
    known = table.get(command)
    if known is None:
        if command == "iu" and (leaves or record.get("feedback")):
            yield "it is a unit that leaves the user, or loops"  # U4
        return
    expected = known.devices | ({"speaker"} if record.get("text") else set())
    if devices != expected:
        yield f"it occupies {', '.join(sorted(devices))}"
    for name in MARKS:
        if bool(record.get(name)) != (name in known.marks):
            yield f"{name} is {bool(record.get(name))}"
