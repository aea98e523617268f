"""Replay: runs a transcript's inbound records again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from prima.errors import UsageError
from prima.language.commands import PATIENCE_MS, CommandType
from prima.messages import (
    ApplicationLoaded,
    ApplicationUnloaded,
    Delayed,
    Emergency,
    Ended,
    Failed,
    Fetched,
    Halted,
    Heard,
    Inbound,
    Listening,
    Narrated,
    Occurred,
    Presence,
    Record,
    Sensed,
    Transferred,
)
from prima.scheduler.policy import policy_named
from prima.script.sandbox import START
from prima.session import AnyDocument, Session


def _heard_or_occurred(record: Record, data: Record) -> Inbound:
    if record["event"] == "speech" and record["actor"] == "user":
        values = {name: value for name, value in data.items() if name != "lasted"}
        return Heard(record["text"], values, _milliseconds(data.get("lasted", 0)))
    return Occurred(record["event"], record["actor"], data, record.get("app"))


INBOUND: dict[str, Callable[[Record, Record], Inbound]] = {
    "end": lambda record, data: Ended(record["behavior"], record.get("goal", True), data),
    "halted": lambda record, data: Halted(record["behavior"], data),
    "listening": lambda record, data: Listening(record["behavior"]),
    "fail": lambda record, data: Failed(record["behavior"], record["device"], record["message"]),
    "delayed": lambda record, data: Delayed(
        record["behavior"], record["device"], _milliseconds(data["waited"])
    ),
    "device": lambda record, data: Presence(
        record["device"], record["outcome"] == "back", record.get("message", "")
    ),
    "event": _heard_or_occurred,
    "fetched": lambda record, data: Fetched(record["app"], **data),
    "transferred": lambda record, data: Transferred(
        record["app"], record["serial"], data["uri"], record["outcome"]
    ),
    "sensed": lambda record, data: Sensed(data),
    "note": lambda record, data: Narrated(record["actor"], record["text"]),
    "emergency": lambda record, data: Emergency(
        record["outcome"] == "pressed", bool(data.get("resume", True))
    ),
    "load": lambda record, data: ApplicationLoaded(
        record["app"], str(data.get("place", "")), data.get("connection", {})
    ),
    "unload": lambda record, data: ApplicationUnloaded(record["app"], str(data.get("place", ""))),
}
"""The inbound value of a record of each phase, from the record and its data."""


WRONG = (KeyError, TypeError, ValueError, AttributeError)
"""Exceptions caused by a record whose fields are not those of its phase."""
DAMAGED = "a record lacks a field of its phase, or has another value in it than PRIMA writes."


def inbound_of(record: Record) -> Inbound | None:
    """The inbound value that a record was made from; None for decisions of the mediator."""
    make = INBOUND.get(record["phase"]) if record.get("inbound") else None
    return None if make is None else make(record, record.get("data") or {})


def _milliseconds(seconds: float) -> int:
    return round(seconds * 1000)


def replay_records(
    records: Iterable[Record],
    documents: Iterable[AnyDocument],
    commands: Mapping[str, CommandType],
    absence: int,
    name: str,
) -> Iterator[Record]:
    """Run the inbound records of a transcript through a session; times of both in s and ms.

    ``name`` is the transcript's.

    Raises:
        UsageError: the transcript names an unknown application, or a record is wrong.
    """
    held = list(records)
    head, settings = held[0], held[0]["data"]
    yield {**head, "time": _milliseconds(head["time"])}
    date = settings.get("date", START)
    policy = policy_named(settings["policy"])
    bound, patience = (
        settings.get("bound"),
        _milliseconds(settings.get("patience", PATIENCE_MS / 1000)),
    )
    session = Session(documents, policy, commands, bound, date, absence=absence, patience=patience)
    try:
        yield from replay_instants(session, held, name)
    finally:
        session.close()
    if (last := held[-1])["phase"] == "over":
        yield {**last, "time": _milliseconds(last["time"])}


def replay_instants(session: Session, records: list[Record], name: str = "") -> Iterator[Record]:
    """Feed a transcript's inbound records to a session; yield its records.

    Args:
        session: a new one.
        records: the transcript's, times in s. Those of the session are in ms.
        name: the transcript's name.

    Raises:
        UsageError: the transcript names an unknown application, or a record is wrong.
    """
    batches: dict[int, list[Inbound]] = {}
    lines: dict[int, int] = {}
    for number, record in enumerate(records, 1):
        try:
            value = inbound_of(record)
        except WRONG:
            raise UsageError(f"{name}:{number}: {DAMAGED}") from None
        if value is not None:
            if isinstance(value, ApplicationLoaded) and value.app not in session.apps:
                message = f'it loads an application that is not there: "{value.app}".'
                raise UsageError(f"{name}:{number}: {message}")
            now = _milliseconds(record["time"])
            batches.setdefault(now, []).append(value)
            lines.setdefault(now, number)
    end = _milliseconds(records[-1]["time"])
    for now, batch in sorted(batches.items()):
        yield from _time_out(session, now - 1)
        try:
            session.step(now, batch)
        except WRONG:
            message = (
                f"the records from {now / 1000:g} s on are not those of a transcript: {DAMAGED}"
            )
            raise UsageError(f"{name}:{lines[now]}: {message}") from None
        session.drain_visits()  # a long replay would keep them all
        yield from session.drain()
    yield from _time_out(session, end)


def _time_out(session: Session, until: int) -> Iterator[Record]:
    """Carry out the session's deadlines up to a time (ms)."""
    while (due := session.deadline()) is not None and due <= until:
        session.step(due, ())
        yield from session.drain()
