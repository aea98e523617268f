"""The table that a person reads, in the manner of the thesis's Figures 5.1-5.12."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from prima.errors import counted
from prima.errors.visible import visible
from prima.language.commands import TABLE_4_2
from prima.messages import Record
from prima.transcript.record import Entry
from prima.transcript.spans import base

LONGEST_SHOWN = 5000
"""Letters of a row that are printed."""
SMALL = frozenset({"a", "an", "and", "at", "by", "for", "of", "on", "the", "to", "with"})
"""Words of a title that have no capital."""
COLUMNS = 80
"""Of a table that is not shown on a terminal, or on one that does not say how wide it is."""
NARROWEST = 20
"""Columns of the behaviour, however long the names of applications are."""
CLOSING = frozenset(
    "\u3001\u3002\uff0c\uff0e\uff01\uff1f\u300d\u300f\uff09\u30fc\u3083\u3085\u3087\u3063\u30e3\u30e5\u30e7\u30c3,.!?)\"'"
)
"""Letters that begin no line of a text that is broken anywhere."""
MOST_KEPT = 3
"""How many such letters are looked at."""
SILENT = frozenset({"stop-moving", "iu"})
"""Commands that have no row of their own, as in the thesis."""

UNSEEN = frozenset(
    {"decision", "floor", "window", "leave", "stream-end", "suspend", "resume", "listening"}
)
"""Phases of many records, which have no rows."""
ASKED = ("command", "text", "args", "extra", "inserted", "source")
"""What a row tells of the request of its behavior."""

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
"""What becomes of a call, said of whom it is made to."""


@dataclass(slots=True)
class Row:
    """A row: who does what. ``time`` in seconds; ``key`` is what makes two rows the same."""

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

    @property
    def key(self) -> tuple[str, str, str, str]:
        """Actor, application, kind and text: alike in two runs where the behaviour is."""
        return (self.actor, self.app, self.kind, self.what.removeprefix("resumes "))


def make_rows(entries: Iterable[Entry]) -> list[Row]:
    """The rows of a transcript, numbered; of its records only those are kept that may have one."""
    held: list[Entry] = []
    handled: set[int] = set()
    asked: dict[str, Entry] = {}
    ends: dict[str, float] = {}
    for record in entries:
        if record.cause:
            handled.add(record.cause)
        if record.phase == "request":
            asked[record.behavior] = record.only(ASKED)
        elif record.phase == "end":
            if record.command == "iu":
                ends[record.behavior] = record.time
            if record.goal:
                held.append(record)
        elif record.phase not in UNSEEN:
            held.append(record)
    rows: list[Row] = []
    collided: set[tuple[str, str]] = set()
    for record in held:
        row = _row(record, asked, handled)
        if record.phase == "collision":
            pair = (base(record.behavior), base(record.by))
            row = None if pair in collided else row  # loops collide at every turn
            collided.add(pair)
        if row is not None:
            row.number = len(rows)
            rows.append(row)
    _bracket(rows, ends)
    return rows


class Growing:
    """The table of a run that goes on: rows are made of its records as they come.

    What only a later record tells is not waited for. A unit's rows begin with ``+`` and go on
    with a bar: which is its last is not known yet. What the camera has seen has its row as
    soon as somebody minds.
    """

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self._asked: dict[str, Entry] = {}
        self._handled: set[int] = set()
        self._ignored: dict[int, Entry] = {}
        """Events that nobody has minded yet, by their serial numbers."""
        self._collided: set[tuple[str, str]] = set()
        self._units: set[str] = set()
        """Units that have a row and go on."""

    def add(self, records: Iterable[Record]) -> list[Row]:
        """Take in the records of an instant, times in seconds; gives the rows they make."""
        held = [Entry(record) for record in records]
        before = len(self.rows)
        for record in held:
            if record.cause:
                self._handled.add(record.cause)
            if record.phase == "request":
                self._asked[record.behavior] = record
        minded = [self._ignored.pop(one) for one in sorted(self._handled & self._ignored.keys())]
        for record in (*minded, *held):
            self._add(record)
        return self.rows[before:]

    def _add(self, record: Entry) -> None:
        if record.phase == "event" and record.actor == "robot" and record.serial is not None:
            if record.serial not in self._handled:
                self._ignored[record.serial] = record
        elif record.phase == "collision":
            pair = (base(record.behavior), base(record.by))
            if pair in self._collided:
                return
            self._collided.add(pair)
        row = _row(record, self._asked, self._handled)
        if row is not None:
            row.number = len(self.rows)
            if row.unit and row.unit not in self._units:
                self._units.add(row.unit)
                row.bracket = "+"
            elif self._units:
                row.bracket = "|"
            self.rows.append(row)
        if record.phase in ("end", "cancel", "fail", "interrupt"):
            self._units.discard(record.behavior)


def _row(record: Entry, asked: dict[str, Entry], handled: set[int]) -> Row | None:
    match record.phase:
        case "start":
            return _start_row(record, asked)
        case "end" if record.goal and record.outcome != "again":
            return _goal_row(record, asked)
        case "event":
            return _event_row(record, handled)
        case "fetched":
            return _fetched_row(record)
        case "transferred":
            return _call_row(record, record.data["uri"], record.outcome)
        case "send" if "transfer" in record.data:
            return _transfer_row(record)
        case "note":
            letter = "U" if record.actor == "user" else "E"
            return Row(record.time, letter, "", record.text, kind="note")
        case "load" | "unload" if record.actor == "environment":
            return _place_row(record)
        case "interrupt":
            request = asked.get(record.behavior, record)
            what = describe(record.command, record.text, request.args)
            what = "the unit" if record.command == "iu" else what
            return _plain(record, f"breaks off {what}", "interrupt")
        case "load" if record.actor == "mediator":
            return Row(record.time, "R", record.app, f"starts {record.app}", kind="load")
        case "unload" if record.actor == "mediator":
            return _plain(record, f"ends {record.app}: {record.outcome}", "unload")
        case "fail":
            title = describe(record.command or "iu", None, None)
            title = "the unit" if title == "Iu" else title
            what = f"{title} fails: {record.message or record.event}"
            return _plain(record, what, "fail", event=True)
        case "emergency":
            what = "the emergency stop is " + str(record.outcome)
            return Row(record.time, "E", "", what, event=True, kind="emergency")
        case "collision":
            what = f"{record.command} loses the {record.device}"
            return _plain(record, what, "collision")
        case "starve":
            request = asked.get(base(record.behavior), record)
            what = describe(request.command, request.text, request.args)
            return _plain(record, f"still waits after {_waited(record)}: {what}", "starve")
        case "log":
            return _plain(record, f"log: {record.message}", "log")
    return None


def _waited(record: Entry) -> str:
    """How long an AB has waited: so many loops of another (E4), or seconds."""
    if record.loop:
        return counted(record.loop, "loop")
    return f"{record.data.get('waited', 0):g} s"


def _place_row(record: Entry) -> Row | None:
    """The robot comes to where an application is offered, or goes away from there."""
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
    """A Command in words: what it says, or its title and what it was given."""
    row = TABLE_4_2.get(command)
    title = row.title if row else " ".join(map(_capital, command.split("-")))
    if command in ("speak", "q-and-a") and text:
        return f'"{text}"'
    if command == "q-and-a":
        return "(listens)"
    defaults = row.arguments if row else {}
    given = {
        name: value
        for name, value in {**(args or {}), **(extra or {})}.items()
        if name not in defaults or value != defaults[name].default
    }
    times = {name for name, argument in defaults.items() if argument.kind == "duration"}
    shown = ", ".join(
        f"{name} {value / 1000:g}s" if name in times else f"{name} {_value(value)}"
        for name, value in given.items()
    )
    return title + (f" ({shown})" if shown else "") + (f', saying "{text}"' if text else "")


def _capital(word: str) -> str:
    return word if word in SMALL else word[:1].upper() + word[1:]


def _value(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _goal_row(record: Entry, asked: dict[str, Entry]) -> Row:
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
    """The answer to what an application has asked a URI for."""
    data = record.data
    what = f"fails: {data['problem']}" if data.get("problem") else "answers"
    return Row(record.time, "E", record.app, f"{data['uri']} {what}", event=True)


def _transfer_row(record: Entry) -> Row:
    """An application calls somebody, or ends its call."""
    data = record.data
    if data["transfer"] == "over":
        return _plain(record, f"ends the call to {data['to']}: {data['outcome']}", "call")
    return _plain(record, f"transfers to {data['to']}", "call")


def _call_row(record: Entry, uri: str, outcome: str) -> Row:
    """What becomes of a call."""
    what = CALLS.get(outcome, f"fails: {outcome}")
    return Row(record.time, "E", record.app, f"{uri} {what}", event=True, kind="call")


def _heard(text: str, data: Record) -> str:
    """What the user said, and how sure the recogniser is where it tells."""
    said = f'"{text}"'
    if "confidence" not in data:
        return said
    others = "".join(
        f', or "{one.get("text")}" {one.get("confidence")}'
        for one in data.get("alternatives") or ()
        if isinstance(one, dict)
    )
    return f"{said} (confidence {data['confidence']}{others})"


def _event_row(record: Entry, handled: set[int]) -> Row | None:
    name, data = record.event, record.data
    if name == "speech":
        return Row(record.time, "U", "", _heard(record.text, data), kind="speech")
    if record.actor == "robot" and record.serial not in handled:
        return None  # the camera sees the human, and nobody minds
    if name == "human.found" and record.actor == "robot":
        return (
            None
            if data.get("sensed")
            else Row(record.time, "R", "", "sees the user", event=True, kind=name)
        )
    letter = {"user": "U", "robot": "R"}.get(record.actor, "E")
    if name.startswith("touch."):
        what = f"touches the robot's {data.get('sensor', name[6:])}"
    elif name == "message":
        sender = f" from {data['from']}" if data.get("from") else ""
        what = f"a message{sender} arrives"
    elif name == "connection.disconnect.hangup" and letter == "U":
        what = "hangs up"
    elif name == "human.lost":
        what = "has lost the user"
    else:
        details = ", ".join(str(value) for value in data.values())
        what = name + (f" ({details})" if details else "")
    return Row(record.time, letter, record.app, what, event=True, kind=name)


def _bracket(rows: list[Row], ends: dict[str, float]) -> None:
    """Mark the rows of units: what happens between the first and the last belongs to them.

    The answer to a unit's last question belongs to it (U5); what comes after a unit was
    broken off and before it starts again does not (X2).
    """
    spans: dict[tuple[str, int], list[int]] = {}
    broken: dict[str, int] = {}
    for index, row in enumerate(rows):
        if row.kind == "interrupt":
            broken[row.behavior] = broken.get(row.behavior, 0) + 1
        if row.unit:
            spans.setdefault((row.unit, broken.get(row.unit, 0)), []).append(index)
    for (unit, _), indices in spans.items():
        final, after = rows[indices[-1]], indices[-1] + 1
        answer = rows[after] if after < len(rows) and final.kind == "q-and-a" else None
        if answer and answer.kind == "speech" and answer.time <= ends.get(unit, -1.0):
            indices.append(after)
    left = list(range(len(rows) + 1))  # from each row on, about where one without a mark comes
    for indices in reversed(spans.values()):  # later units go over earlier ones
        first, last = indices[0], indices[-1]
        index = _next(left, first)
        while index <= last:
            inside = first < index < last
            rows[index].bracket = "|" if inside else "+" if first != last else "["
            left[index] = index + 1
            index = _next(left, index)


def _next(left: list[int], index: int) -> int:
    """The first row from one on that has no mark; the way there is shorter the next time."""
    while left[index] != index:
        left[index] = left[left[index]]
        index = left[index]
    return index


def width(text: str) -> int:
    """How many columns of a terminal a text takes."""
    if text.isascii():
        return len(text)
    return sum(map(_columns, text))


def _columns(letter: str) -> int:
    """How many columns a letter takes: none if it changes the one before it."""
    if unicodedata.category(letter) in ("Mn", "Me", "Cf"):
        return 0
    return 2 if unicodedata.east_asian_width(letter) in "WF" else 1


def _pad(text: str, columns: int) -> str:
    return text + " " * max(columns - width(text), 0)


class Layout(NamedTuple):
    """How wide the table's columns are, in columns of a terminal."""

    apps: int
    behavior: int
    numbers: int = 4
    times: int = 7
    why: bool = False

    @property
    def left(self) -> int:
        """Columns before the behaviour."""
        return 4 + 2 + self.numbers + 1 + self.times + 2 + 3 + 2 + self.apps + 2


def layout(apps: Iterable[str], columns: int = COLUMNS, why: bool = False) -> Layout:
    """A layout for applications' names that takes no more than so many columns.

    Names of applications are not broken. If they leave too little room for the behaviour,
    the table is wider.
    """
    made = Layout(max([3, *map(width, apps)]), 0, why=why)
    return made._replace(behavior=max(columns - made.left - (14 if why else 7), NARROWEST))


def format_rows(rows: list[Row], why: bool = False, columns: int = COLUMNS) -> str:
    """The table as text: star and bracket, number, who, application, behaviour, event.

    It is as wide as its longest row needs, and at most so many columns; longer rows go on in
    further lines.
    """
    shape = shape_of(rows, why, columns)
    lines = [format_head(shape)]
    for row in rows:
        lines += format_row(row, shape)
    return "\n".join(lines) + "\n"


def shape_of(rows: list[Row], why: bool = False, columns: int = COLUMNS) -> Layout:
    """The layout of these rows: as wide as the longest needs, and at most so many columns."""
    made = layout((row.app for row in rows), columns, why)
    if rows:
        numbers = max(made.numbers, len(str(rows[-1].number)))
        times = max(made.times, len(f"{rows[-1].time:.2f}"))
        more = numbers + times - made.numbers - made.times
        room = max(made.behavior - more, NARROWEST)
        made = made._replace(numbers=numbers, times=times, behavior=room)
    longest = max([8, *(width(visible(row.what)) for row in rows)])
    return made._replace(behavior=min(longest, made.behavior))


def format_head(shape: Layout) -> str:
    """The table's head."""
    head = f"{'No.':>{6 + shape.numbers}}  {_pad('Time', shape.times - 1)}  Who"
    head += f"  {_pad('App', shape.apps)}  {_pad('Behavior', shape.behavior)}  Event"
    return head + ("  Rule" if shape.why else "")


def format_row(row: Row, shape: Layout) -> list[str]:
    """The lines of one row under such a head."""
    mark = f"{'*' if row.star else ' '}{row.bracket or ' '}"
    left = f"  {mark}  {row.number:>{shape.numbers}} {row.time:>{shape.times}.2f}"
    left += f"  {row.actor:<3}  {_pad(row.app, shape.apps)}  "
    pieces = _wrap(visible(row.what), shape.behavior)
    event = "o" if row.event else " "
    tail = f"  {event}      {row.rule}" if shape.why else f"  {event}"
    first = (left + _pad(pieces[0], shape.behavior) + tail).rstrip()
    return [first, *(" " * width(left) + piece for piece in pieces[1:])]


def _wrap(text: str, columns: int) -> list[str]:
    """Break a text at spaces; a word that is longer than a line, as in Japanese, anywhere."""
    lines, current = [], ""
    if len(text) > LONGEST_SHOWN:
        text = text[:LONGEST_SHOWN] + "..."
    for word in text.split(" "):
        candidate = f"{current} {word}" if current else word
        if width(candidate) <= columns:
            current = candidate
            continue
        if current:
            lines.append(current)
        *pieces, current = _cut(word, columns)
        lines += pieces
    return [*lines, current]


def _cut(word: str, columns: int) -> list[str]:
    """A word in pieces that fit; none begins with what closes a sentence or changes a letter."""
    pieces = []
    while width(word) > columns:
        end = taken = 0
        while taken + _columns(word[end]) <= columns:
            taken += _columns(word[end])
            end += 1
        for _ in range(min(MOST_KEPT, end - 1)):
            if word[end] not in CLOSING and _columns(word[end]):
                break
            end -= 1
        pieces.append(word[:end])
        word = word[end:]
    return [*pieces, word]


def read_table(text: str) -> list[Row]:
    """Read a printed table back: who, application, behaviour and event of each row.

    Raises:
        ValueError: it has no head, or a row that does not fit under it.
    """
    lines = text.splitlines()
    head = next((line for line in lines if "No." in line and "Behavior" in line), "")
    if not head:
        raise ValueError("it has no head")
    who, app, what, event = (head.index(word) for word in ("Who", "App", "Behavior", "Event"))
    rows: list[Row] = []
    last = ""
    for line in map(_spread, lines[lines.index(head) + 1 :]):
        number = line[:who].split()
        if not line.strip():
            continue
        if not number and rows:
            rows[-1].what += "" if _is_cut(last, event - what - 2) else " "
            last = _gathered(line[what:])
            rows[-1].what += last
            continue
        row = Row(float(number[-1]), line[who:app].strip(), _gathered(line[app:what]), "")
        last = row.what = _gathered(line[what:event])
        row.event = line[event : event + 1] == "o"
        row.number = len(rows)
        rows.append(row)
    for row in rows:
        row.resumed = row.what.startswith("resumes ")
    return rows


def _spread(line: str) -> str:
    """A line in which every letter takes as many places as columns, filled with zeros."""
    if line.isascii():
        return line
    made = ""
    for letter in line:
        taken = _columns(letter)
        if taken:
            made += letter + "\0" * (taken - 1)
    return made


def _gathered(text: str) -> str:
    return text.replace("\0", "").strip()


def _is_cut(piece: str, columns: int) -> bool:
    """Whether a line ends within a word: it is one long word, and full."""
    return " " not in piece and width(piece) >= columns - 2 * MOST_KEPT - 1
