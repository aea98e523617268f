"""Running a transcript's inbound records again: recovery, what-if, and proof."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from prima.errors import UsageError
from prima.language.commands import ABSENCE_MS, PATIENCE_MS, CommandType
from prima.messages import (
    Delayed,
    Emergency,
    Ended,
    Failed,
    Fetched,
    Halted,
    Heard,
    Inbound,
    Listening,
    Loaded,
    Narrated,
    Occurred,
    Presence,
    Record,
    Sensed,
    Transferred,
    Unloaded,
)
from prima.scheduler.policy import policy_named
from prima.script.prelude import START
from prima.session import AnyDocument, Session


def inbound_of(record: Record) -> Inbound | None:
    """The inbound value that a record was made of; None for what was decided inside."""
    if not record.get("inbound"):
        return None
    data = record.get("data") or {}
    match record["phase"]:
        case "end":
            return Ended(record["behavior"], record.get("goal", True), data)
        case "halted":
            return Halted(record["behavior"], data)
        case "listening":
            return Listening(record["behavior"])
        case "fail":
            return Failed(record["behavior"], record["device"], record["message"])
        case "delayed":
            waited = round(data["waited"] * 1000)
            return Delayed(record["behavior"], record["device"], waited)
        case "device":
            there = record["outcome"] == "back"
            return Presence(record["device"], there, record.get("message", ""))
        case "event" if record["event"] == "speech" and record["actor"] == "user":
            return Heard(record["text"], data)
        case "event":
            return Occurred(record["event"], record["actor"], data, record.get("app"))
        case "fetched":
            return Fetched(record["app"], **data)
        case "transferred":
            return Transferred(record["app"], record["serial"], data["uri"], record["outcome"])
        case "sensed":
            return Sensed(data)
        case "note":
            return Narrated(record["actor"], record["text"])
        case "emergency":
            pressed = record["outcome"] == "pressed"
            return Emergency(pressed, bool(data.get("resume", True)))
        case "load":
            return Loaded(record["app"], str(data.get("place", "")), data.get("connection", {}))
        case "unload":
            return Unloaded(record["app"], str(data.get("place", "")))
    return None


def replay_records(
    records: Iterable[Record],
    documents: Iterable[AnyDocument],
    commands: Mapping[str, CommandType],
    absence: int = ABSENCE_MS,
) -> Iterator[Record]:
    """Run the inbound records of a transcript through a session; times of both in s and ms.

    Raises:
        UsageError: the transcript names an application that is not there.
    """
    held = list(records)
    head, settings = held[0], held[0]["data"]
    yield {**head, "time": round(head["time"] * 1000)}
    date = settings.get("date", START)
    policy = policy_named(settings["policy"])
    bound, patience = (
        settings.get("bound"),
        round(settings.get("patience", PATIENCE_MS / 1000) * 1000),
    )
    session = Session(documents, policy, commands, bound, date, absence=absence, patience=patience)
    try:
        yield from replay_instants(session, held)
    finally:
        session.close()
    if (last := held[-1])["phase"] == "over":
        yield {**last, "time": round(last["time"] * 1000)}


def replay_instants(session: Session, records: list[Record]) -> Iterator[Record]:
    """Feed a transcript's inbound records to a session; gives the records that it makes.

    Args:
        session: a new one.
        records: the transcript's, times in s. Those of the session are in ms.

    Raises:
        UsageError: the transcript names an application that is not there.
    """
    batches: dict[int, list[Inbound]] = {}
    for record in records:
        value = inbound_of(record)
        if value is not None:
            if isinstance(value, Loaded) and value.app not in session.apps:
                raise UsageError(f'The transcript loads "{value.app}", which is not there.')
            batches.setdefault(round(record["time"] * 1000), []).append(value)
    end = round(records[-1]["time"] * 1000)
    for now, batch in sorted(batches.items()):
        yield from _time_out(session, now - 1)
        session.step(now, batch)
        session.drain_visits()  # a long replay would keep them all
        yield from session.drain()
    yield from _time_out(session, end)


def _time_out(session: Session, until: int) -> Iterator[Record]:
    """Carry out what the session does by itself up to a time."""
    while (due := session.deadline()) is not None and due <= until:
        session.step(due, ())
        yield from session.drain()
