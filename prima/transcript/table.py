"""The table of a transcript as text, in the style of the thesis's Figures 5.1-5.12."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from prima.errors.rendering import columns_of
from prima.errors.visible import visible
from prima.transcript.row import Row

LONGEST_SHOWN = 5000
"""Maximum length of a printed row (characters)."""
COLUMNS = 80
"""Width of a table if the terminal's is unknown."""
NARROWEST = 20
"""Minimum width of the behaviour's column."""
CLOSING = frozenset(
    "\u3001\u3002\uff0c\uff0e\uff01\uff1f\u300d\u300f\uff09\u30fc\u3083\u3085\u3087\u3063\u30e3\u30e5\u30e7\u30c3,.!?)\"'"
)
"""Characters that do not begin a line where a word is broken."""
MOST_KEPT = 3
"""How many such characters are moved to the next line."""


def width(text: str) -> int:
    """The width of a text in columns of a terminal."""
    if text.isascii():
        return len(text)
    return sum(map(columns_of, text))


def pad(text: str, columns: int) -> str:
    """A text with spaces after it, up to a number of columns."""
    return text + " " * max(columns - width(text), 0)


class ColumnWidths(NamedTuple):
    """The widths of the table's columns."""

    apps: int
    behavior: int
    numbers: int = 4
    times: int = 7
    why: bool = False

    @property
    def left(self) -> int:
        """Columns before the behaviour."""
        return 4 + 2 + self.numbers + 1 + self.times + 2 + 3 + 2 + self.apps + 2


def layout(apps: Iterable[str], columns: int = COLUMNS, why: bool = False) -> ColumnWidths:
    """A layout for applications' names, at most this wide.

    Names of applications are not broken. If they leave too little room for the behaviour,
    the table is wider.
    """
    made = ColumnWidths(max([3, *(width(visible(app)) for app in apps)]), 0, why=why)
    return made._replace(behavior=max(columns - made.left - (14 if why else 7), NARROWEST))


def format_rows(rows: list[Row], why: bool = False, columns: int = COLUMNS) -> str:
    """The table as text: star and bracket, number, who, application, behaviour, event.

    It is as wide as its longest row, and at most ``columns``; longer rows are wrapped.
    """
    shape = shape_of(rows, why, columns)
    lines = [format_head(shape)]
    for row in rows:
        lines += format_row(row, shape)
    return "\n".join(lines) + "\n"


def shape_of(rows: list[Row], why: bool = False, columns: int = COLUMNS) -> ColumnWidths:
    """The layout of rows: as wide as the longest, and at most ``columns``."""
    made = layout((row.app for row in rows), columns, why)
    if rows:
        numbers = max(made.numbers, len(str(rows[-1].number)))
        times = max(made.times, len(f"{rows[-1].time:.2f}"))
        more = numbers + times - made.numbers - made.times
        room = max(made.behavior - more, NARROWEST)
        made = made._replace(numbers=numbers, times=times, behavior=room)
    longest = max([8, *(width(visible(row.what)) for row in rows)])
    return made._replace(behavior=min(longest, made.behavior))


def format_head(shape: ColumnWidths) -> str:
    """The table's head."""
    head = f"{'No.':>{6 + shape.numbers}}  {pad('Time', shape.times - 1)}  Who"
    head += f"  {pad('App', shape.apps)}  {pad('Behavior', shape.behavior)}  Event"
    return head + ("  Rule" if shape.why else "")


def format_row(row: Row, shape: ColumnWidths) -> list[str]:
    """The lines of one row."""
    mark = f"{'*' if row.star else ' '}{row.bracket or ' '}"
    left = f"  {mark}  {row.number:>{shape.numbers}} {row.time:>{shape.times}.2f}"
    left += f"  {row.actor:<3}  {pad(visible(row.app), shape.apps)}  "
    pieces = _wrap(visible(row.what), shape.behavior)
    event = "o" if row.event else " "
    tail = f"  {event}      {visible(row.rule)}" if shape.why else f"  {event}"
    first = (left + pad(pieces[0], shape.behavior) + tail).rstrip()
    return [first, *(" " * width(left) + piece for piece in pieces[1:])]


def _wrap(text: str, columns: int) -> list[str]:
    """Wrap a text at spaces; break words longer than a line, as in Japanese, anywhere."""
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
    """A word in pieces that fit; none begins with closing punctuation or a combining character."""
    pieces = []
    while width(word) > columns:
        end = taken = 0
        while taken + columns_of(word[end]) <= columns:
            taken += columns_of(word[end])
            end += 1
        for _ in range(min(MOST_KEPT, end - 1)):
            if word[end] not in CLOSING and columns_of(word[end]):
                break
            end -= 1
        pieces.append(word[:end])
        word = word[end:]
    return [*pieces, word]


def read_table(text: str) -> list[Row]:
    """Read a printed table back: who, application, behaviour and event of each row.

    Raises:
        ValueError: it has no head, or a row does not match the head.
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
    """A line with one character per column: NUL follows each wide character."""
    if line.isascii():
        return line
    made = ""
    for letter in line:
        taken = columns_of(letter)
        if taken:
            made += letter + "\0" * (taken - 1)
    return made


def _gathered(text: str) -> str:
    return text.replace("\0", "").strip()


def _is_cut(piece: str, columns: int) -> bool:
    """Whether a full line ends within a long word."""
    return " " not in piece and width(piece) >= columns - 2 * MOST_KEPT - 1
