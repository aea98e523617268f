"""The journal of a live run: its transcript, appended instant by instant, from which it can resume.

An instant is written before its orders are carried out. So nothing missing at the end of a
journal has taken effect in the world, except what came in at the very last instant.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from prima.errors import RunError, UsageError
from prima.loading.files import read_bytes
from prima.loading.writing import locked
from prima.messages import Emergency, Inbound, Json, Narrated, Order, Record
from prima.transcript.lines import check_head, finished, line, read_lines

CHANGED = (
    "the documents do not give this record again: lines are missing above it or were changed,"
    " a file that an application fetched has changed, or another version of PRIMA has written them."
)


def _is_there(path: str) -> UsageError:
    hint = f"Go on with --resume {path}, or name another file."
    return UsageError(f"{path}: there is a journal already. {hint}")


def _opened(path: str, kept: int | None) -> int:
    """A journal's file, open for appending and locked if it is on a disk."""
    flags = os.O_WRONLY | os.O_APPEND
    if kept is None and not os.path.exists(path):
        flags |= os.O_CREAT | os.O_EXCL
    elif kept is None and os.path.isfile(path) and os.path.getsize(path):
        raise _is_there(path)
    try:
        file = os.open(path, flags, 0o644)
        if os.path.isfile(path) and not locked(file):
            os.close(file)
            raise UsageError(f"{path}: another run is still writing it. End that one first.")
        if kept is not None:
            os.ftruncate(file, kept)
    except FileExistsError:
        raise _is_there(path) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise UsageError(f"{path}: cannot be written: {reason}.") from None
    return file


class Journal:
    """A file that grows by each instant's records.

    Args:
        path: its path, which may be a device; a new file unless ``kept`` is given.
        sync: whether each instant is flushed to the disk, if on one, before it is carried out.
        kept: the number of bytes of an older journal to keep; writing continues after them.

    Raises:
        UsageError: the file already exists, cannot be written, or a run is still writing it.
    """

    def __init__(self, path: str, sync: bool = False, kept: int | None = None) -> None:
        self.path = path
        self._file = _opened(path, kept)
        self._sync = sync and os.path.isfile(path)

    def write(self, records: list[Record]) -> None:
        """Append records, times in ms.

        Raises:
            RunError: they cannot be written, for example because the disk is full.
        """
        data = "".join(map(line, records)).encode()
        try:
            while data:
                data = data[os.write(self._file, data) :]
            if self._sync:
                os.fsync(self._file)
        except OSError as error:
            raise RunError(f"{self.path}: cannot be written: {error.strerror}.") from None

    def discard(self) -> None:
        """Remove the file, if it is a regular file."""
        if os.path.isfile(self.path):
            os.unlink(self.path)

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)


@dataclass(slots=True)
class CutJournal:
    """A journal that was cut off: its complete records, and their size in bytes."""

    path: str
    records: list[Record]
    kept: int

    @property
    def time(self) -> int:
        """When it was cut off (ms)."""
        return round(float(self.records[-1]["time"]) * 1000)


def read_broken(path: str) -> CutJournal:
    """Read a journal up to its last complete record.

    Raises:
        UsageError: it is not a journal, cannot be read, or its run has ended.
    """
    data = read_bytes(path)
    kept = data.rfind(b"\n") + 1
    try:
        text = data[:kept].decode()
    except UnicodeDecodeError:
        raise UsageError(f"{path}: this is not a transcript: it is not UTF-8.") from None
    records = list(read_lines(path, text.splitlines(keepends=True)))
    check_head(records[0], path)
    if records[-1]["phase"] == "over":
        raise UsageError(f"{path}: this run has ended; there is nothing to go on with.")
    if records[0].get("data", {}).get("redacted"):
        message = "what users said was left out of this journal, so its run cannot go on."
        raise UsageError(f"{path}: {message}")
    if "live" not in records[0].get("data", {}):
        raise UsageError(f"{path}: this is not the journal of a live run.")
    return CutJournal(path, records, kept)


def lacking(broken: CutJournal, made: Iterable[Record]) -> list[Record]:
    """The reproduced records that a journal lacks, times in ms.

    Raises:
        UsageError: the records differ.
    """
    again = iter(made)
    for number, before in enumerate(broken.records[1:], start=2):
        record = next(again, None)
        if record is None or finished(record) != before:
            remedy = sound_above(broken.path, number)
            raise UsageError(f"{broken.path}:{number}: {CHANGED} {remedy}")
    return list(again)


def sound_above(journal: str, number: int) -> str:
    """How to go on from a journal whose lines above one are as they were written."""
    return (
        f"The lines above it are sound. To go on from there: head -n {number - 1} {journal} >"
        " sound.jsonl, then prima live --resume sound.jsonl."
    )


GOES_ON = "the run was cut off here, and goes on"
"""The note with which a resumed run begins."""


@dataclass(slots=True)
class KnownAtCut:
    """The state of a run when it was cut off."""

    loaded: set[str]
    """Applications that were loaded."""
    inside: set[str]
    """Those of the areas that the robot was in."""
    found: bool
    """Whether the user was seen."""
    sensors: dict[str, Json]
    halted: bool
    """Whether the emergency stop was pressed."""
    own: bool = False
    """Whether only resuming after an earlier cut pressed it."""
    asked: dict[str, Order] = field(default_factory=dict)
    """Applications' requests without an answer, by name, the oldest first."""


def known(records: list[Record]) -> KnownAtCut:
    """The state of a run at the end of its records."""
    state, cut = KnownAtCut(set(), set(), False, {}, False), -1.0
    for record in records:
        match record["phase"]:
            case "note" if record.get("inbound") and record["text"] == GOES_ON:
                cut = record["time"]
            case "load" if record.get("inbound"):
                state.loaded.add(record["app"])
                if record.get("data", {}).get("place"):
                    state.inside.add(record["app"])
            case "unload" if record.get("inbound"):
                state.inside.discard(record["app"])
            case "event" if record["event"] in ("human.found", "human.lost"):
                state.found = record["event"] == "human.found"
            case "sensed":
                state.sensors |= record["data"]
            case "emergency":
                pressed = record["outcome"] == "pressed"
                state.own = pressed and not state.halted and record["time"] == cut
                state.halted = pressed
        _note_asked(state.asked, record)
    return state


def _note_asked(asked: dict[str, Order], record: Record) -> None:
    """Keep requests until they are answered.

    A service's reply does not say which message it answers: the oldest is assumed.
    """
    app, data = str(record.get("app", "")), record.get("data") or {}
    match record["phase"]:
        case "load" | "unload":  # the application that asked is gone
            for name in [name for name, order in asked.items() if order.app == app]:
                del asked[name]
        case "send" if data.get("transfer") == "over":
            asked.pop(f"{app}!{data['call']}", None)
        case "send":
            name = f"{app}!{record['serial']}"
            asked[name] = Order("send", name, app=app, data=data)
        case "fetched":
            asked.pop(f"{app}!{data['serial']}", None)
        case "transferred":
            asked.pop(f"{app}!{record['serial']}", None)
        case "event" if record.get("inbound"):
            asked.pop(_answered(asked, app, record["event"]), None)


def _answered(asked: dict[str, Order], app: str, event: str) -> str:
    """The name of the request that an event answers; empty if none."""
    for name, order in asked.items():
        to = order.data["to"]
        if order.app == app and event in (f"reply.{to}", f"error.service.{to}"):
            return name
    return ""


def going_on(state: KnownAtCut) -> Iterator[Inbound]:
    """The events with which a run resumes: everything was interrupted and starts again (E5).

    A stop that somebody has pressed stays pressed until it is released.
    """
    yield Narrated("environment", GOES_ON)
    if not state.halted:
        yield Emergency(True)
    if state.own or not state.halted:
        yield Emergency(False, True)
