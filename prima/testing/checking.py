"""Whether a run was as its scenario expects (docs/testing.md)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from typing import Any

from prima.errors import Place
from prima.grammar.text import fold
from prima.interpreter.selection import takes
from prima.language.values import read_value, shown
from prima.sim.expectations import Expectation
from prima.sim.scenario import Scenario
from prima.testing.tracing import Change, States
from prima.transcript.record import Entry
from prima.transcript.run import Run
from prima.transcript.spans import base
from prima.transcript.table import Row, describe, format_head, format_row, shape_of

AROUND = 2
"""Rows that are shown before and after the one that matters."""
MOST_ROWS = 4
"""Rows that are shown of each end of a long time."""
GAP = "       ..."
"""Stands for rows that are not shown."""
MOST_TOLD = 5
"""Times that a message lists."""
MOST_COMPARED = 500
"""Texts that are looked through for the nearest one."""
LONGEST_COMPARED = 200
"""Letters of each that count for that."""
ALIKE = 0.5
"""From which likeness on (0 to 1) a text is worth telling."""


@dataclass(frozen=True, slots=True)
class Failure:
    """What was not as expected: where the scenario says so, in words, with rows of the run."""

    place: Place
    message: str
    rows: str = ""


@dataclass(slots=True)
class Fact:
    """Something that happened: its number among the facts, when (ms), and its record."""

    number: int
    time: int
    phase: str
    record: Entry
    request: Entry
    """The request of the Behavior, where there is one."""
    said: str = ""
    """What the Behavior says."""


@dataclass(slots=True)
class Window:
    """When something is expected: from a time (ms) and behind a fact on, until a time."""

    opens: int = 0
    behind: int = -1
    closes: int | None = None
    ahead: int | None = None
    """The fact that it has to come before."""
    why: str = ""
    """Since when, in words."""

    def holds(self, fact: Fact) -> bool:
        """Whether a fact is in it."""
        return not self.early(fact) and not self.late(fact)

    def early(self, fact: Fact) -> bool:
        """Whether a fact comes too early."""
        return fact.time < self.opens or fact.number <= self.behind

    def late(self, fact: Fact) -> bool:
        """Whether a fact comes too late."""
        past = self.closes is not None and fact.time > self.closes
        return past or (self.ahead is not None and fact.number >= self.ahead)


@dataclass(slots=True)
class Checked:
    """What is known of a run: its facts and rows, and the states that applications were in."""

    facts: list[Fact]
    rows: list[Row]
    states: States
    end: int
    """When it ended (ms)."""
    ended: dict[str, str] = field(default_factory=dict)
    """Why applications ended."""


def make_run(run: Run, rows: list[Row], states: States) -> Checked:
    """Make what expectations are checked on of a run."""
    ended = {one.app: one.outcome for one in run.of("unload") if one.actor == "mediator"}
    return Checked(list(_facts(run)), rows, states, round(run.end * 1000), ended)


def _facts(run: Run) -> Iterable[Fact]:
    """What may be expected or waited for: no loops but the first, and no decisions."""
    texts: dict[str, str] = {}
    number = 0
    for entry in run.entries:
        phase, name = entry.phase, base(entry.behavior)
        if phase == "start" and entry.text:
            texts[name] = entry.text
        ended = phase == "end" and entry.outcome != "again"
        gone = phase == "unload" and entry.actor == "mediator"
        first = phase == "start" and entry.first
        if first or ended or gone or phase in ("listening", "event", "log", "send"):
            request = run.asked(name) or entry
            time = round(entry.time * 1000)
            yield Fact(number, time, phase, entry, request, texts.get(name, ""))
            number += 1


def check(scenario: Scenario, run: Checked) -> list[Failure]:
    """Check all that a scenario expects; gives what was not so, in document order."""
    return Checker(scenario, run).failures


class Checker:
    """Goes through the expectations of one scenario."""

    def __init__(self, scenario: Scenario, run: Checked) -> None:
        self.run = run
        self.failures: list[Failure] = []
        self._found: dict[int, Fact | None] = {}
        """What expectations found, by their identity; None where they did not."""
        self._named = {one.id: one for one in scenario.expectations if one.id}
        for one in scenario.expectations:
            self._check(one)

    def _check(self, one: Expectation) -> None:
        self._found[id(one)] = None
        window = self._window(one)
        if window is None:
            return
        if "state" in one.words:
            self._check_state(one, window)
            return
        fitting = [fact for fact in self.run.facts if fits(one, fact)]
        inside = [fact for fact in fitting if window.holds(fact)]
        if one.never:
            if inside:
                self._fail(
                    one, f"{_must(one, window)} It does {self._at(inside)}.", window, inside[0]
                )
        elif one.times is not None and len(inside) != one.times:
            told = f"It does {_times(len(inside))}"
            told += f", {self._at(inside)}." if inside else "."
            self._fail(one, f"{_must(one, window)} {told}", window, next(reversed(inside), None))
        elif not inside:
            self._miss(one, window, fitting)
        else:
            self._found[id(one)] = inside[-1] if one.times else inside[0]

    # When -------------------------------------------------------------------------

    def _window(self, one: Expectation) -> Window | None:
        """When it is expected; None where that cannot be said, which has been told."""
        window = Window()
        others = [self._named[one.after]] if one.after else []
        others += [one.previous] if one.previous is not None else []
        for other in others:
            fact = self._found.get(id(other))
            if fact is None:
                return None
            if fact.number > window.behind:
                window.opens, window.behind = max(window.opens, fact.time), fact.number
                window.why = f"after {_subject(other)} at {_seconds(fact.time)}"
        if one.before:
            fact = self._found.get(id(self._named[one.before]))
            if fact is None:
                return None
            window.ahead = fact.number
        if one.trigger and not self._open(one, window):
            return None
        if one.within is not None:
            window.closes = window.opens + one.within
        return window

    def _open(self, one: Expectation, window: Window) -> bool:
        """Open the window at its trigger; tells if that has not come."""
        if one.trigger == "at":
            time = self.run.end if one.what == "end" else one.what
            window.opens = max(window.opens, time)
            window.why = "at the end" if one.what == "end" else f"from {_seconds(time)} on"
            return True
        fired = [
            fact
            for fact in self.run.facts
            if fact.number > window.behind and triggers(one.trigger, one.what, fact)
        ]
        told = _trigger(one)
        if len(fired) < one.count:
            often = "is never there" if not fired else f"comes only {_times(len(fired))}"
            why = f"What it waits for {often}: {told}."
            self._fail(one, f"{_must(one, window)} {why}", window, next(reversed(fired), None))
            return False
        fact = fired[one.count - 1]
        window.opens, window.behind = fact.time, fact.number
        window.why = f"after {told} at {_seconds(fact.time)}"
        return True

    # States -----------------------------------------------------------------------

    def _check_state(self, one: Expectation, window: Window) -> None:
        """A state lasts: it has to be there at some time of the window, or at none."""
        name, states = one.words["state"], self.run.states.changes
        if window.ahead is not None:
            window.closes = min(
                self.run.facts[window.ahead].time,
                self.run.end if window.closes is None else window.closes,
            )
        closes = self.run.end if window.closes is None else window.closes
        apps = [one.by] if one.by else list(states)
        held = [
            (app, change.time)
            for app in apps
            for change, ends in _spans(states.get(app, []))
            if change.state == name and _meets(change.time, ends, window.opens, closes)
        ]
        if one.never and held:
            app, time = held[0]
            told = f"{app} is in it from {_seconds(time)} on."
            self._fail(one, f"{_must(one, window)} {told}", window, max(time, window.opens))
        elif not one.never and not held:
            told = " ".join(self._instead(app, window.opens) for app in apps[:MOST_TOLD])
            self._fail(one, f"{_must(one, window)} {told}".strip(), window, window.opens)

    def _instead(self, app: str, time: int) -> str:
        """Where an application is at a time."""
        changes = self.run.states.changes.get(app, [])
        now = next((one for one in reversed(changes) if one.time <= time), None)
        if now is None:
            return f"{app} has not begun then."
        if now.state:
            return f'{app} is in "{now.state}" then, since {_seconds(now.time)}.'
        return f"{app} has ended then: {self.run.ended.get(app, 'it is over')}."

    # Telling ----------------------------------------------------------------------

    def _fail(
        self, one: Expectation, message: str, window: Window, near: Fact | int | None = None
    ) -> None:
        """Tell a failure, with the rows where it was looked for, and those around what was found.

        ``near`` is what was found, or its time (ms).
        """
        name = next(name for name in one.node.attributes if name in one.words)
        place = one.node.attribute_place(name, value=False)
        time = near.time if isinstance(near, Fact) else near
        looked = None if one.never and near is not None else window
        self.failures.append(Failure(place, message, around(self.run.rows, looked, time)))

    def _at(self, facts: list[Fact]) -> str:
        """When things happened, with the rows."""
        told = [f"{_seconds(fact.time)}{self._row(fact)}" for fact in facts[:MOST_TOLD]]
        more = f" and {len(facts) - MOST_TOLD} more" if len(facts) > MOST_TOLD else ""
        return f"at {', '.join(told)}{more}"

    def _row(self, fact: Fact) -> str:
        """The row of the table that shows a fact."""
        name = (fact.record.behavior).partition(".")[0]
        kind = fact.phase if fact.phase in ("log", "unload") else ""
        for row in self.run.rows:
            same = row.behavior.partition(".")[0] == name and row.kind == (kind or row.kind)
            now = round(row.time * 1000) == fact.time and row.app == (fact.record.app)
            if same and now:
                return f" (row {row.number})"
        return ""

    def _miss(self, one: Expectation, window: Window, fitting: list[Fact]) -> None:
        """Nothing was found: tell what came nearest."""
        late = next((fact for fact in fitting if window.late(fact)), None)
        early = next((fact for fact in reversed(fitting) if window.early(fact)), None)
        near = late or early
        if late is not None:
            after = f", {_seconds(late.time - window.closes)} too late" if window.closes else ""
            told = f"It does {self._at([late])}{after or ', too late'}."
        elif early is not None:
            told = f"It does {self._at([early])}, too early."
        else:
            near, told = self._nearest(one)
        self._fail(one, f"{_must(one, window)} {told}", window, near)

    def _nearest(self, one: Expectation) -> tuple[Fact | None, str]:
        """What is nearest to what never happens: said by another, or with other words."""
        wanted = [fact for fact in self.run.facts if fits(one, fact, whoever=True)]
        if wanted:
            who, at = wanted[0].record.app, self._at(wanted[:1])
            told = f"It is {who} that does, {at}." if who else f"It does for all, {at}."
            return wanted[0], told
        loose = [fact for fact in self.run.facts if fits(one, fact, whatever=True)]
        if loose and one.data:
            told = ", ".join(f"{key} {shown(value)}" for key, value in values(loose[0]).items())
            return loose[0], f"It does so with {told or 'no values'}, {self._at(loose[:1])}."
        if loose and one.reason:
            return loose[0], f"It ends with {loose[0].record.outcome}, {self._at(loose[:1])}."
        name = "says" if "says" in one.words else "logs" if "logs" in one.words else ""
        found = _likest(one.words[name], name, self.run.facts) if name else None
        if found is None:
            return None, "It never does."
        who, text = found.record.app, _text(found, name)
        return found, f'It never does. Nearest: {who} {name} "{text}" {self._at([found])}.'


def around(rows: list[Row], looked: Window | None, near: int | None) -> str:
    """The rows of the table in a window, and around a time (ms); three dots stand for others."""
    chosen: set[int] = set()
    if looked is not None:
        chosen |= _within(rows, looked)
    if near is not None:
        at = max((index for index, row in enumerate(rows) if row.time * 1000 <= near), default=0)
        chosen |= set(range(at - AROUND, at + AROUND + 1))
    kept = sorted(chosen & set(range(len(rows))))
    if not kept:
        return ""
    shape = shape_of([rows[index] for index in kept])
    lines = [format_head(shape)]
    for before, index in zip([kept[0] - 1, *kept], kept, strict=False):
        lines += [GAP] if index > before + 1 else []
        lines += format_row(rows[index], shape)
    return "\n".join(lines) + "\n"


def _within(rows: list[Row], window: Window) -> set[int]:
    """The rows of a window with the one before it and the one after it; of many, both ends."""
    closes = float("inf") if window.closes is None else window.closes
    inside = [
        index for index, row in enumerate(rows) if window.opens <= round(row.time * 1000) <= closes
    ]
    if not inside:
        last = sum(row.time * 1000 < window.opens for row in rows)
        return {last - 1, last}
    found = [inside[0] - 1, *inside, inside[-1] + 1]
    if len(found) > 2 * MOST_ROWS:
        found = [*found[:MOST_ROWS], *found[-MOST_ROWS:]]
    return set(found)


# Matching -------------------------------------------------------------------------


def fits(one: Expectation, fact: Fact, whoever: bool = False, whatever: bool = False) -> bool:
    """Whether a fact is what is expected; also of another application, or with other values."""
    record = fact.record
    if one.by and not whoever and record.app != one.by:
        return False
    if not all(_is(name, word, fact) for name, word in one.words.items()):
        return False
    if whatever:
        return True
    if one.reason and not _reason(one.reason, record.outcome):
        return False
    held = values(fact) if one.data else {}
    return all(name in held and _same(text, held[name]) for name, text in one.data.items())


def _is(name: str, word: str, fact: Fact) -> bool:
    record, phase = fact.record, fact.phase
    match name:
        case "says":
            return phase == "start" and bool(fact.said) and fold(word) in fold(fact.said)
        case "does":
            return phase == "start" and record.command == word
        case "finishes":
            return triggers("done", word, fact)
        case "event":
            return phase == "event" and takes(word, record.event)
        case "logs":
            return phase == "log" and fold(word) in fold(record.message)
        case "sends":
            return phase == "send" and _to(word, str(record.data.get("to") or ""))
        case "ends":
            return phase == "unload" and record.app == word
    return False


def _to(word: str, target: str) -> bool:
    """A service by its name, or a URI by its beginning."""
    return (
        target == word or target == f"service:{word}" or (":" in word and target.startswith(word))
    )


def _reason(word: str, outcome: str) -> bool:
    """An application's reason begins with the event's name; a prefix of it is enough."""
    name = outcome.partition(":")[0]
    return outcome == word or takes(word, name)


def values(fact: Fact) -> dict[str, Any]:
    """What was given along: a Command's arguments, an event's or a message's values."""
    record, request = fact.record, fact.request
    if fact.phase in ("start", "end"):
        return {**(request.args), **(request.extra)}
    data = dict(record.data)
    params = data.get("params")
    return params if isinstance(params, dict) else data


def _same(text: str, value: Any) -> bool:
    """Whether a value is the one written; times are given in ms."""
    if isinstance(value, bool):
        return text == str(value).lower()
    if isinstance(value, int | float):
        for kind in ("number", "duration"):
            try:
                return abs(float(read_value(kind, text)) - value) < 1e-6
            except ValueError:
                continue
        return False
    return " ".join(text.split()) == " ".join(shown(value).split())


def triggers(name: str, what: Any, fact: Fact) -> bool:
    """Whether a fact fires a trigger, as it would that of a ``when``."""
    record, phase = fact.record, fact.phase
    match name:
        case "asked":
            return phase == "listening" and _holds(what, fact)
        case "said":
            done = phase == "end" and record.outcome == "done"
            return (phase == "listening" or done) and _holds(what, fact)
        case "doing":
            return phase == "start" and record.command == what
        case "done":
            return phase == "end" and record.command == what
    return phase == "event" and takes(what, record.event)


def _holds(what: str, fact: Fact) -> bool:
    return bool(fact.said) and fold(what) in fold(fact.said)


def _text(fact: Fact, name: str) -> str:
    return fact.said if name == "says" else str(fact.record.message)


def _likest(word: str, name: str, facts: list[Fact]) -> Fact | None:
    """The fact whose text is most like a text, if any is like it at all."""
    wanted = fold(word)[:LONGEST_COMPARED]
    phase = "start" if name == "says" else "log"
    held = [fact for fact in facts if fact.phase == phase and _text(fact, name)]
    best, found = ALIKE, None
    for fact in held[:MOST_COMPARED]:
        alike = SequenceMatcher(None, wanted, fold(_text(fact, name))[:LONGEST_COMPARED]).ratio()
        if alike > best:
            best, found = alike, fact
    return found


def _spans(changes: list[Change]) -> Iterable[tuple[Change, int | None]]:
    """Each state with when it was left; None where it never was."""
    for index, change in enumerate(changes):
        later = changes[index + 1].time if index + 1 < len(changes) else None
        yield change, later


def _meets(begins: int, ends: int | None, opens: int, closes: int) -> bool:
    """Whether a span is there at some time of a window, longer than an instant before it."""
    return begins <= closes and (ends is None or ends > opens or begins >= opens)


# Words ----------------------------------------------------------------------------


def _subject(one: Expectation) -> str:
    """What is expected, in words."""
    who = one.by or "the robot"
    words = one.words
    if "does" in words:
        told = describe(words["does"], words.get("says"), None)
        return f"{who} does {told}{_with(one)}"
    name, word = next(iter(words.items()))
    match name:
        case "says" | "logs":
            return f'{who if name == "says" else one.by or "an application"} {name} "{word}"'
        case "finishes":
            return f"{who} finishes {describe(word, None, None)}{_with(one)}"
        case "event":
            return f"the event {word}{_with(one)} happens"
        case "sends":
            return f"{one.by or 'an application'} sends to {word}{_with(one)}"
        case "state":
            return f'{one.by or "an application"} is in the state "{word}"'
    return f"{word} ends" + (f" with {one.reason}" if one.reason else "")


def _trigger(one: Expectation) -> str:
    """What opens a window, in words."""
    match one.trigger:
        case "said" | "asked":
            return f'the robot has {one.trigger} "{one.what}"'
        case "doing" | "done":
            does = "begins" if one.trigger == "doing" else "ends"
            return f"the robot {does} {describe(one.what, None, None)}"
    return f"the event {one.what}"


def _with(one: Expectation) -> str:
    held = ", ".join(f"{name} {value}" for name, value in one.data.items())
    return f" ({held})" if held else ""


def _must(one: Expectation, window: Window) -> str:
    """The expectation as a sentence."""
    parts = [_subject(one)]
    if one.times is not None:
        parts.append(_times(one.times))
    if window.why:
        parts.append(window.why)
    if one.before:
        parts.append(f'before "{one.before}"')
    if one.within is not None:
        parts.append(f"within {_seconds(one.within)}")
    return f"{'Never expected' if one.never else 'Expected'}: {', '.join(parts)}."


def _times(count: int) -> str:
    return {0: "never", 1: "once", 2: "twice"}.get(count, f"{count} times")


def _seconds(time: int) -> str:
    return f"{time / 1000:.2f} s"
