"""A row of a transcript's table, made from a record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from prima.errors import counted
from prima.language.commands import TABLE_4_2, CommandType
from prima.messages import Record
from prima.transcript.record import Entry
from prima.transcript.spans import base

SMALL = frozenset({"a", "an", "and", "at", "by", "for", "of", "on", "the", "to", "with"})
"""Words of a title that are not capitalized."""
SILENT = frozenset({"stop-moving", "iu"})
"""Commands without a row, as in the thesis."""


CALLS = {
    "answered": "answers",
    "busy": "is busy",
    "noanswer": "does not answer",
    "network_busy": "cannot be reached: the network is busy",
    "far_end_disconnect": "hangs up",
    "near_end_disconnect": "is hung up on",
    "network_disconnect": "is cut off by the network",
    "maxtime_disconnect": "is cut off after the longest time",
    "unknown": "is on the line no more",
}
"""The outcomes of a call, as predicates of its target."""


@dataclass(slots=True)
class Row:
    """A row: who does what. ``time`` is in seconds; rows with the same ``key`` are the same."""

    time: float
    actor: str
    app: str
    what: str
    event: bool = False
    star: bool = False
    unit: str = ""
    bracket: str = ""
    resumed: bool = False
    rule: str = ""
    kind: str = ""
    behavior: str = ""
    source: str = ""
    number: int = 0
    own: bool = False
    """Whether the application itself raised the event."""

    @property
    def key(self) -> tuple[str, str, str, str]:
        """Actor, application, kind and text: equal for the same behaviour in two runs."""
        return (self.actor, self.app, self.kind, self.what.removeprefix("resumes "))


def _waited(record: Entry) -> str:
    """How long an AB has waited: in loops of another (E4), or in seconds."""
    if record.loop:
        return counted(record.loop, "loop")
    return f"{record.data.get('waited', 0):g} s"


def _place_row(record: Entry) -> Row | None:
    """The robot enters or leaves the place of an application."""
    place = record.data.get("place")
    if not place:
        return None
    verb = "enters" if record.phase == "load" else "leaves"
    return Row(record.time, "R", "", f"{verb} {place}", kind=verb)


def _plain(record: Entry, what: str, kind: str, event: bool = False) -> Row:
    return Row(
        record.time,
        "R",
        record.app,
        what,
        event=event,
        kind=kind,
        rule=record.rule,
        behavior=record.behavior,
        source=record.source,
    )


def _start_row(record: Entry, asked: dict[str, Entry]) -> Row | None:
    command, loop = record.command, record.behavior.partition(".")[2]
    resumed = bool(record.resumed)
    if command in SILENT or (loop not in ("", "1") and not resumed):
        return None
    request = asked.get(base(record.behavior), record)
    what = describe(command, record.text, request.args, request.extra)
    if resumed and record.data.get("mark"):
        what += f" from the mark {record.data['mark']}"
    if request.inserted:
        what += f" [inserted, {request.inserted}]"
    return Row(
        record.time,
        "R",
        record.app,
        f"resumes {what}" if resumed else what,
        star=bool(loop),
        unit=record.unit,
        resumed=resumed,
        rule=record.rule,
        kind=command,
        behavior=record.behavior,
        source=request.source,
    )


def describe(
    command: str, text: str | None, args: Record | None, extra: Record | None = None
) -> str:
    """A Command as text: what it says, or its title and its arguments other than defaults."""
    if command in ("speak", "q-and-a") and text:
        return f'"{text}"'
    if command == "q-and-a":
        return "(listens)"
    shown = _arguments(TABLE_4_2.get(command), {**(args or {}), **(extra or {})})
    said = f', saying "{text}"' if text else ""
    return title(command) + (f" ({shown})" if shown else "") + said


def title(command: str) -> str:
    """The name of a Command for people."""
    row = TABLE_4_2.get(command)
    return row.title if row else " ".join(map(_capital, command.split("-")))


def _arguments(row: CommandType | None, given: Record) -> str:
    """Arguments that are not the defaults."""
    known = row.arguments if row else {}
    times = {name for name, argument in known.items() if argument.kind == "duration"}
    return ", ".join(
        f"{name} {value / 1000:g}s"
        if name in times and isinstance(value, int | float)
        else f"{name} {_value(value)}"
        for name, value in given.items()
        if name not in known or value != known[name].default
    )


def _capital(word: str) -> str:
    return word if word in SMALL else word[:1].upper() + word[1:]


def _value(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _goal_row(record: Entry, asked: dict[str, Entry]) -> Row | None:
    if not record.goal or record.outcome == "again":
        return None
    request = asked.get(base(record.behavior), record)
    args = request.args
    if record.command == "active-sensing-human":
        what = "finds the user"
    elif "to" in args:
        what = f"reaches {args['to']}"
    else:
        what = f"reaches the goal of {describe(record.command, None, args)}"
    return Row(
        record.time,
        "R",
        record.app,
        what,
        event=True,
        kind=f"goal {record.command}",
        behavior=record.behavior,
    )


def _fetched_row(record: Entry) -> Row:
    """The answer to a fetch."""
    data = record.data
    what = f"fails: {data['problem']}" if data.get("problem") else "answers"
    return Row(record.time, "E", record.app, f"{data['uri']} {what}", event=True)


def _transfer_row(record: Entry) -> Row:
    """The start or end of an application's call."""
    data = record.data
    if data["transfer"] == "over":
        return _plain(record, f"ends the call to {data['to']}: {data['outcome']}", "call")
    return _plain(record, f"transfers to {data['to']}", "call")


def _call_row(record: Entry, uri: str, outcome: str) -> Row:
    """The outcome of a call."""
    what = CALLS.get(outcome, f"fails: {outcome}")
    return Row(record.time, "E", record.app, f"{uri} {what}", event=True, kind="call")


def _heard(text: str, data: Record) -> str:
    """The user's words: who of several said them, and the recogniser's confidence, if known."""
    said = f'{data["person"]}: "{text}"' if "person" in data else f'"{text}"'
    if "confidence" not in data:
        return said
    told = data.get("alternatives")
    others = "".join(
        f', or "{one.get("text")}" {one.get("confidence")}'
        for one in (told if isinstance(told, list) else ())
        if isinstance(one, dict)
    )
    return f"{said} (confidence {data['confidence']}{others})"


def _event_row(record: Entry, handled: set[int]) -> Row | None:
    name, data = record.event, record.data
    if name == "speech":
        return Row(record.time, "U", "", _heard(record.text, data), kind="speech")
    if record.actor == "robot" and record.serial not in handled:
        return None  # the camera sees the user, and no application reacts
    if name == "human.found" and record.actor == "robot":
        if data.get("sensed"):
            return None
        return Row(record.time, "R", "", "sees the user", event=True, kind=name)
    letter = {"user": "U", "robot": "R"}.get(record.actor, "E")
    own = bool(record.app) and not record.inbound
    what = _named(name, data) if own else _event_text(name, data, letter == "U")
    return Row(record.time, letter, record.app, what, event=True, kind=name, own=own)


def _event_text(name: str, data: Record, by_user: bool) -> str:
    if name.startswith("touch."):
        who = f"{data['person']} " if "person" in data else ""
        return f"{who}touches the robot's {data.get('sensor', name[6:])}"
    if name == "message":
        sender = f" from {data['from']}" if data.get("from") else ""
        return f"a message{sender} arrives"
    if name == "connection.disconnect.hangup" and by_user:
        return "hangs up"
    if name == "human.lost":
        return "has lost the user"
    return _named(name, data)


def _named(name: str, data: Record) -> str:
    details = ", ".join(str(value) for value in data.values())
    return name + (f" ({details})" if details else "")


def _log_row(record: Entry) -> Row:
    return _plain(record, f"log: {record.message}", "log")


def _send_row(record: Entry) -> Row | None:
    return _transfer_row(record) if "transfer" in record.data else None


def _note_row(record: Entry) -> Row:
    letter = "U" if record.actor == "user" else "E"
    return Row(record.time, letter, "", record.text, kind="note")


def _load_row(record: Entry) -> Row | None:
    if record.actor == "environment":
        return _place_row(record)
    if record.phase == "load":
        return Row(record.time, "R", record.app, f"starts {record.app}", kind="load")
    return _plain(record, f"ends {record.app}: {record.outcome}", "unload")


def _interrupt_row(record: Entry, asked: dict[str, Entry]) -> Row:
    return _plain(record, f"breaks off {_requested(record, asked)}", "interrupt")


def _fail_row(record: Entry) -> Row:
    failed = title(record.command) if record.command not in ("", "iu") else "the unit"
    what = f"{failed} fails: {record.message or record.event}"
    return _plain(record, what, "fail", event=True)


def _emergency_row(record: Entry) -> Row:
    what = f"the emergency stop is {record.outcome}"
    return Row(record.time, "E", "", what, event=True, kind="emergency")


def _collision_row(record: Entry) -> Row:
    what = "the unit" if record.command == "iu" else record.command
    return _plain(record, f"{what} loses the {record.device}", "collision")


def _starve_row(record: Entry, asked: dict[str, Entry]) -> Row:
    what = _requested(record, asked)
    return _plain(record, f"still waits after {_waited(record)}: {what}", "starve")


def _requested(record: Entry, asked: dict[str, Entry]) -> str:
    """The Command, or the unit, that a record is about."""
    request = asked.get(base(record.behavior), record)
    unit = request.command == "iu"
    return "the unit" if unit else describe(request.command, request.text, request.args)


BY_RECORD: dict[str, Callable[[Entry], Row | None]] = {
    "fetched": _fetched_row,
    "transferred": lambda record: _call_row(record, record.data["uri"], record.outcome),
    "send": _send_row,
    "note": _note_row,
    "load": _load_row,
    "unload": _load_row,
    "fail": _fail_row,
    "emergency": _emergency_row,
    "collision": _collision_row,
    "log": _log_row,
}
"""Phases whose rows need only the record."""
BY_REQUEST: dict[str, Callable[[Entry, dict[str, Entry]], Row | None]] = {
    "start": _start_row,
    "end": _goal_row,
    "interrupt": _interrupt_row,
    "starve": _starve_row,
}
"""Phases whose rows also need the requests of behaviors."""


def row_of(record: Entry, asked: dict[str, Entry], handled: set[int]) -> Row | None:
    """The row of a record, if it has one.

    Args:
        record: the record.
        asked: the requests of behaviors, by their names.
        handled: the serial numbers of events that an application has reacted to.
    """
    if record.phase == "event":
        return _event_row(record, handled)
    if by_request := BY_REQUEST.get(record.phase):
        return by_request(record, asked)
    by_record = BY_RECORD.get(record.phase)
    return by_record(record) if by_record else None
