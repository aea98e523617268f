"""A transcript's record, declared: its phases, its fields with their types and meanings.

From here come what is written and in which order, the check of what is read, the JSON Schema,
and both tables of the documentation. :class:`Entry` is a record as the fold sees it.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args, get_type_hints

from prima.messages import Record
from prima.transcript.phases import PHASES

if TYPE_CHECKING:
    from pydantic import BaseModel

MEANING = """One line of a transcript. Fields that do not apply are omitted.

Times are seconds of the run. ``inbound`` marks what came from outside: the
inbound records of a transcript are enough to run it again."""
LONGEST_DAYS = 366
LONGEST = LONGEST_DAYS * 86_400.0
"""Maximum length of a run (s): drawing a longer one would not end."""


_NOTHING: dict[str, Any] = {}
_NONE: list[Any] = []


class Entry:
    """A record with a value for each field, empty if the record lacks it.

    The annotations declare the fields in order: the type, the meaning and, if only some words are
    allowed, those. Times are seconds of the run; ``time`` replaces the record's own.
    """

    def __init__(self, record: Record, time: float | None = None) -> None:
        self.__dict__ = {name: one for name, one in record.items() if one is not None}
        if time is not None:
            self.time = time

    @property
    def spoken(self) -> bool:
        """Whether it is what the user says."""
        return self.phase == "event" and self.event == "speech"

    @property
    def first(self) -> bool:
        """Whether it is about neither a further loop of a feedback Command nor a resumption."""
        return self.behavior.partition(".")[2] in ("", "1") and not self.resumed

    @property
    def notice(self) -> str:
        """The event that applications get; the emergency stop and its release are events, too."""
        if self.phase == "emergency":
            return f"emergency.{'stop' if self.outcome == 'pressed' else 'release'}"
        return self.event

    def only(self, names: Iterable[str]) -> Entry:
        """The record with only some of its fields."""
        return Entry({name: self.__dict__[name] for name in names if name in self.__dict__})

    time: Annotated[float, "Seconds since the run began."]
    phase: Annotated[str, "The kind of the record."]
    actor: Annotated[str, "Whose doing it is.", "robot", "user", "environment", "mediator"]
    app: Annotated[str, "The application concerned."] = ""
    behavior: Annotated[str, "The AB: APP#N, or APP#N.LOOP for a loop of a feedback Command."] = ""
    tree: Annotated[str, "The Communication Stream: APP:N."] = ""
    command: Annotated[str, "The Command's type; iu for a unit."] = ""
    text: Annotated[str, "What is said."] = ""
    args: Annotated[dict[str, Any], "Motion arguments; times in ms."] = _NOTHING
    extra: Annotated[dict[str, Any], "Additional arguments of an FA."] = _NOTHING
    cues: Annotated[
        list[dict[str, Any]], "Pauses, rates and marks of the text, each `at` a place in it; in ms."
    ] = _NONE
    parent: Annotated[str, "The AB that this one follows."] = ""
    parents: Annotated[list[str], "All ABs that it waits for, where more than one."] = _NONE
    devices: Annotated[list[str], "The devices that it occupies."] = _NONE
    priority: Annotated[str, "K2.", "high", "low"] = ""
    reactive: Annotated[bool, "Whether it carries the reactive flag (C5)."] = False
    cause: Annotated[int | None, "The serial number of the event reacted to."] = None
    feedback: Annotated[bool, "Whether it makes one loop after another (U2)."] = False
    leaves: Annotated[bool, "Whether it leaves the user (K1)."] = False
    engages: Annotated[bool, "Whether it engages the user (K1)."] = False
    order: Annotated[str, "Set for a Command wanted now (O2).", "now"] = ""
    state: Annotated[
        int | None, "The activation of a document's state that asks, or is left (O3)."
    ] = None
    inserted: Annotated[str, "The rule by which the mediator put it in itself (X1, X4, X9)."] = ""
    before: Annotated[str, "The AB that it was put in before."] = ""
    restartable: Annotated[bool, "Whether it gives way to a reaction and starts again (X2)."] = (
        False
    )
    hold: Annotated[float, "How long (s) its stream is held for an event afterwards (X3)."] = 0.0
    fresh: Annotated[float, "For how long (s) the reaction is worth starting (X8)."] = 0.0
    spans: Annotated[bool, "Whether it is a unit that spans questions and states (U5; for X7)."] = (
        False
    )
    words: Annotated[str, "What is said first when its stream resumes (X9)."] = ""
    connect: Annotated[bool, "Whether the robot has to face the user before it starts (X4)."] = (
        False
    )
    motion: Annotated[
        str,
        "How it moves the body: free in its path, or faithful to its own (X5).",
        "free",
        "faithful",
    ] = ""
    unit: Annotated[str, "The unit that it is a part of (U4, U5)."] = ""
    event: Annotated[str, "An event's name."] = ""
    serial: Annotated[int | None, "An event's or message's serial number."] = None
    rule: Annotated[str, "The rule that decided."] = ""
    winner: Annotated[str, "Who was selected."] = ""
    losers: Annotated[list[str], "Who was not: the first eight."] = _NONE
    losers_count: Annotated[int, "How many were not."] = 0
    by: Annotated[str, "The AB or stream because of which."] = ""
    floor: Annotated[list[str], "The stack of streams, the floor's holder last (F3)."] = _NONE
    outcome: Annotated[str, "How it ended."] = ""
    goal: Annotated[bool, "Whether a feedback Command has met its goal (U2)."] = False
    resumed: Annotated[bool, "Whether an interrupted Command starts afresh (U2)."] = False
    device: Annotated[str, "The device concerned."] = ""
    loop: Annotated[int, "A number of loops."] = 0
    message: Annotated[str, "More about it, for people."] = ""
    data: Annotated[dict[str, Any], "Values given along."] = _NOTHING
    source: Annotated[str, "The document and line that asked: FILE:LINE."] = ""
    inbound: Annotated[bool, "Whether it came from outside."] = False


FIELDS = tuple(Entry.__annotations__)
"""The fields in the order in which they are written."""
REQUIRED = ("time", "phase", "actor")


def lacking(record: Record) -> str:
    """The first required field of its phase that a record lacks."""
    needed = PHASES[record["phase"]].needed
    return next((name for name in needed if record.get(name) is None), "")


@cache
def model() -> type[BaseModel]:
    """The model that a line is checked against; its JSON Schema is published."""
    from pydantic import ConfigDict, Field, create_model

    fields: dict[str, Any] = {}
    for name, hint in get_type_hints(Entry, include_extras=True).items():
        kind, meaning, *words = get_args(hint)
        if get_args(kind) and get_args(kind)[-1] is type(None):
            kind = get_args(kind)[0]
        words = list(PHASES) if name == "phase" else words
        kind = Literal[tuple(words)] if words else kind
        if name == "time":
            held = Field(ge=0, le=LONGEST, allow_inf_nan=False, description=meaning)
            fields[name] = (kind, held)
        elif name in REQUIRED:
            fields[name] = (kind, Field(description=meaning))
        else:
            fields[name] = (kind | None, Field(None, description=meaning))
    return create_model(
        "Record", __config__=ConfigDict(extra="forbid", strict=True), __doc__=MEANING, **fields
    )
