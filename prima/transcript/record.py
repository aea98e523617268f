"""A transcript's record as a model: what a line may hold. Makes the JSON Schema."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Annotated, Any, Literal, NotRequired

from pydantic import BaseModel, ConfigDict, Field

PHASES = [
    "run",
    "load",
    "unload",
    "request",
    "decision",
    "start",
    "end",
    "cancel",
    "fail",
    "hold",
    "suspend",
    "resume",
    "floor",
    "window",
    "leave",
    "stream-end",
    "stop",
    "collision",
    "starve",
    "emergency",
    "listening",
    "held",
    "interrupt",
    "halted",
    "substitute",
    "event",
    "fetched",
    "transferred",
    "sensed",
    "note",
    "send",
    "log",
    "error",
    "over",
]


LONGEST = 1e9
"""Seconds that a run may last: no drawing of a longer one would come to an end."""


class Record(BaseModel):
    """One line of a transcript. Fields that do not apply are left out.

    Times are seconds of the run. ``inbound`` marks what came from outside: the
    inbound records of a transcript are enough to run it again.
    """

    model_config = ConfigDict(extra="forbid", strict=True)

    time: float = Field(
        ge=0, le=LONGEST, allow_inf_nan=False, description="Seconds since the run began."
    )
    phase: Literal[
        "run", "load", "unload", "request", "decision", "start", "end", "cancel", "fail",
        "hold", "suspend", "resume", "floor", "window", "leave", "stream-end", "stop", "collision",
        "starve", "emergency", "listening",
        "held", "interrupt", "halted", "substitute", "event", "fetched", "transferred", "sensed", "note", "send", "log", "error",
        "over",
    ] = Field(description="What the record tells.")  # fmt: skip
    actor: Literal["robot", "user", "environment", "mediator"] = Field(
        description="Whose doing it is."
    )
    app: str | None = Field(None, description="The application concerned.")
    behavior: str | None = Field(
        None, description="The AB: APP#N, or APP#N.LOOP for a loop of a feedback Command."
    )
    tree: str | None = Field(None, description="The Communication Stream: APP:N.")
    command: str | None = Field(None, description="The Command's type; iu for a unit.")
    text: str | None = Field(None, description="What is said.")
    args: dict[str, Any] | None = Field(None, description="Motion arguments; times in ms.")
    extra: dict[str, Any] | None = Field(None, description="Additional arguments of an FA.")
    cues: list[dict[str, Any]] | None = Field(
        None, description="Pauses, rates and marks of the text, each `at` a place in it; in ms."
    )
    parent: str | None = Field(None, description="The AB that this one follows.")
    parents: list[str] | None = Field(
        None, description="All ABs that it waits for, where more than one."
    )
    devices: list[str] | None = Field(None, description="The devices that it occupies.")
    priority: Literal["high", "low"] | None = Field(None, description="K2.")
    reactive: bool | None = Field(None, description="Whether it carries the reactive flag (C5).")
    cause: int | None = Field(None, description="The serial number of the event reacted to.")
    feedback: bool | None = Field(None, description="Whether it makes one loop after another (U2).")
    leaves: bool | None = Field(None, description="Whether it leaves the user (K1).")
    engages: bool | None = Field(None, description="Whether it engages the user (K1).")
    order: Literal["now"] | None = Field(None, description="Set for a Command wanted now (O2).")
    state: int | None = Field(
        None, description="The activation of a document's state that asks, or is left (O3)."
    )
    inserted: str | None = Field(
        None, description="The rule by which the mediator put it in itself (X1, X4)."
    )
    before: str | None = Field(None, description="The AB that it was put in before.")
    restartable: bool | None = Field(
        None, description="Whether it gives way to a reaction and starts again (X2)."
    )
    hold: float | None = Field(
        None, description="How long (s) its stream is held for an event afterwards (X3)."
    )
    connect: bool | None = Field(
        None, description="Whether the robot has to face the user before it starts (X4)."
    )
    motion: Literal["free", "faithful"] | None = Field(
        None, description="How it moves the body: free in its path, or faithful to its own (X5)."
    )
    unit: str | None = Field(None, description="The unit that it is a part of (U4, U5).")
    event: str | None = Field(None, description="An event's name.")
    serial: int | None = Field(None, description="An event's or message's serial number.")
    rule: str | None = Field(None, description="The rule that decided.")
    winner: str | None = Field(None, description="Who was selected.")
    losers: list[str] | None = Field(None, description="Who was not: the first eight.")
    losers_count: int | None = Field(None, description="How many were not.")
    by: str | None = Field(None, description="The AB or stream because of which.")
    floor: list[str] | None = Field(
        None, description="The stack of streams, the floor's holder last (F3)."
    )
    outcome: str | None = Field(None, description="How it ended.")
    goal: bool | None = Field(None, description="Whether a feedback Command has met its goal (U2).")
    resumed: bool | None = Field(
        None, description="Whether an interrupted Command starts afresh (U2)."
    )
    device: str | None = Field(None, description="The device concerned.")
    loop: int | None = Field(None, description="A number of loops.")
    message: str | None = Field(None, description="More about it, for people.")
    data: dict[str, Any] | None = Field(None, description="Values given along.")
    source: str | None = Field(None, description="The document and line that asked: FILE:LINE.")
    inbound: bool | None = Field(None, description="Whether it came from outside.")


@cache
def quick_reader() -> Callable[[str], dict[str, Any]]:
    """What reads a line and checks it at once, a few times as fast as one after the other.

    It raises pydantic's ``ValidationError`` for whatever it does not take; it refuses nothing
    of :class:`Record` but escaped halves of letters and very deep values, and takes what is no
    JSON, the numbers ``NaN`` and ``Infinity``. Times are floats.
    """
    from pydantic import TypeAdapter
    from typing_extensions import TypedDict

    fields: dict[str, Any] = {}
    for name, field in Record.model_fields.items():
        kind: Any = field.annotation
        for bound in field.metadata:
            kind = Annotated[kind, bound]
        fields[name] = kind if field.is_required() else NotRequired[kind]
    made = TypedDict("Quick", fields)  # type: ignore[misc]
    setattr(made, "__pydantic_config__", Record.model_config)  # noqa: B010
    read: Callable[[str], dict[str, Any]] = TypeAdapter(made).validator.validate_json
    return read


FIELDS = tuple(Record.model_fields)
