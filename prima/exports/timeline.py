"""What a transcript's records amount to on a time axis: tiers of intervals and points.

Computed once, from the records in their order, and then written in one format
or another. Times are whole milliseconds of the run.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import count

from prima.devices import voice
from prima.errors import UsageError, did_you_mean, one_of
from prima.errors.visible import visible
from prima.language.values import LONGEST_MS
from prima.messages import Json, Record
from prima.transcript.table import describe

TAG = re.compile(r"[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*")
"""A language tag (BCP 47), as far as its form goes."""
MOST_MARKS = 1_000_000
"""Intervals and points of one export."""
MOST_LETTERS = 200_000_000
"""Letters of all their texts and details together."""
MOST_TIERS = 1000
"""Tiers, those that hold what overlaps included."""
LONGEST_TEXT = 5000
"""Letters of one text."""
LONGEST_NAME = 100
"""Letters of a tier's name, and of whose it is."""
MOST_PARTS = 8
"""Parts of a unit that its text names."""

BLANKS = re.compile(r"[\t-\r\x1c-\x20\x85\u2028\u2029]+")

COLUMNS = (
    "application",
    "behavior",
    "stream",
    "command",
    "rule",
    "outcome",
    "by",
    "event",
    "serial",
    "seconds",
    "losers",
    "source",
    "note",
)
"""The details that an interval or a point may have, besides its text."""


KINDS = {
    "does": "",
    "says": "",
    "units": "",
    "streams": "",
    "user-says": "user: says",
    "user-does": "user: does",
    "events": "events",
    "reactions": "reactions",
    "floor": "floor",
    "holder": "floor holder",
    "why": "why",
    "device": "",
}
"""Kinds of tiers in their order, with the names of those that are there only once."""
POINTS = frozenset({"user-does", "events", "why"})
"""Kinds that consist of points."""


@dataclass(slots=True)
class Interval:
    """Something from ``start`` to ``end`` (ms); a point where these are the same."""

    start: int
    end: int
    text: str
    about: dict[str, str] = field(default_factory=dict)
    """Details by the names of :data:`COLUMNS`; those that are empty are left out."""


@dataclass(slots=True)
class Tier:
    """Intervals of one kind, by their start; ``points`` tells that all are points.

    ``kind`` is one of :data:`KINDS`; ``who`` whose it is: an application's name,
    ``user``, ``robot`` or ``environment``.
    """

    name: str
    kind: str
    who: str
    points: bool = False
    marks: list[Interval] = field(default_factory=list)

    def lanes(self, least: int = 1) -> list[list[Interval]]:
        """The marks divided so that in no part two overlap, as few parts as are needed.

        ``least`` is how long (ms) each counts at the least.
        """
        lanes: list[list[Interval]] = []
        busy: list[tuple[int, int]] = []
        free: list[int] = []
        for mark in self.marks:
            while busy and busy[0][0] <= mark.start:
                heappush(free, heappop(busy)[1])
            if free:
                lane = heappop(free)
            else:
                lane = len(lanes)
                lanes.append([])
            lanes[lane].append(mark)
            heappush(busy, (max(mark.end, mark.start + least), lane))
        return lanes


@dataclass(slots=True)
class Part:
    """A tier, or what of it no other part overlaps, with a name that no other has."""

    name: str
    tier: Tier
    marks: list[Interval]


@dataclass(slots=True)
class Timeline:
    """All tiers of a run, those of the applications first; ``end`` in ms."""

    tiers: list[Tier]
    end: int
    head: dict[str, Json]
    """What the run's first record tells; empty if the transcript does not begin with it."""
    name: str = ""
    """The transcript's, for messages."""
    over: bool = False
    """Whether the transcript tells how the run ended."""
    _parts: list[Part] | None = None
    languages: dict[str, str] = field(default_factory=dict)
    """The language of each application of which the transcript tells it."""

    @property
    def marks(self) -> int:
        """How many intervals and points there are."""
        return sum(len(tier.marks) for tier in self.tiers)

    def check_names(self, names: Iterable[str]) -> None:
        """Make sure that applications are of this run; the empty name is no application's.

        Raises:
            UsageError: there is no such application.
        """
        known = {tier.who for tier in self.tiers if tier.kind in ("does", "says", "streams")}
        for name in names:
            if name and name not in known:
                hint = did_you_mean(name, known) or f"There is {one_of(known) or 'none'}."
                raise UsageError(f'{self.name}: nothing is done by an application "{name}". {hint}')

    def parts(self) -> list[Part]:
        """Tiers in which nothing overlaps; what does goes to a second one, ``NAME-2`` and so on.

        Raises:
            UsageError: there would be too many.
        """
        if self._parts is None:
            names: set[str] = set()
            self._parts = []
            for tier in self.tiers:
                for number, marks in enumerate(tier.lanes(), 1):
                    if len(names) == MOST_TIERS:
                        message = f"it makes more than {MOST_TIERS} tiers, since too much overlaps."
                        raise UsageError(f"{self.name}: {message} Try --to csv.")
                    name = unused(tier.name if number == 1 else f"{tier.name}-{number}", names)
                    self._parts.append(Part(name, tier, marks))
        return self._parts


def unused(name: str, names: set[str]) -> str:
    """A name that is not among ``names`` yet, and is then."""
    found = name
    for number in count(2):
        if found not in names:
            break
        found = f"{name}-{number}"
    names.add(found)
    return found


def clean(text: object, longest: int = LONGEST_TEXT) -> str:
    """One line of text that every format can hold, not too long."""
    line = str(text)
    if len(line) > longest:
        line = line[:longest] + "..."
    return visible(BLANKS.sub(" ", line)).strip()


def _value(value: Json) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def timeline(name: str, records: Iterable[Record]) -> Timeline:
    """Make the timeline of a transcript's records; ``name`` is for messages.

    Raises:
        UsageError: a record lacks what its phase has, or it is too much for one file.
    """
    builder = Builder(name)
    for number, record in enumerate(records, 1):
        try:
            builder.add(record)
        except (KeyError, TypeError, ValueError, AttributeError):
            raise UsageError(f"{name}: record {number} lacks what its phase has.") from None
    return builder.result()


@dataclass(slots=True)
class _Run:
    """A behavior that runs: all loops of a feedback Command that follow one another."""

    app: str
    start: int
    text: str
    about: dict[str, str]
    devices: dict[str, int]
    """Since when it has had each."""
    unit: bool
    ended: int | None = None
    """When its last loop ended, if it has."""
    words: str = ""
    saying: int | None = None
    """Since when it speaks, while it does."""
    parts: list[str] = field(default_factory=list)


@dataclass(slots=True)
class _Stream:
    """A Communication Stream's present state, and since when."""

    app: str
    since: int
    state: str
    rule: str = ""
    by: str = ""


class Builder:
    """Takes the records of one run, in their order, and gives its timeline."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._tiers: dict[tuple[str, str], Tier] = {}
        self._now = 0
        self._head: dict[str, Json] = {}
        self._over = False
        self._languages: dict[str, str] = {}
        self._marks = self._letters = 0
        self._asked: dict[str, Record] = {}
        self._runs: dict[str, _Run] = {}
        self._broken: dict[str, Interval] = {}
        """What was being said by behaviors that were broken off."""
        self._streams: dict[str, _Stream] = {}
        self._holder: tuple[int, str, str] | None = None
        self._events: dict[int, tuple[str, int]] = {}
        self._answered: set[tuple[str, int]] = set()
        self._heard_until = 0
        self._do: dict[str, Callable[[Record], None]] = {
            "run": self._run,
            "request": self._request,
            "start": self._start,
            "listening": self._listening,
            "end": self._end,
            "cancel": self._end,
            "fail": self._fail,
            "interrupt": self._interrupt,
            "halted": self._halted,
            "collision": self._collision,
            "suspend": self._suspend,
            "resume": self._resume,
            "stream-end": self._stream_end,
            "floor": self._floor,
            "decision": self._decision,
            "event": self._event,
            "note": self._note,
            "load": self._loaded,
            "unload": self._loaded,
            "over": self._end_of_run,
            "fetched": self._told,
            "transferred": self._told,
            "emergency": self._told,
            "error": self._told,
        }

    def add(self, record: Record) -> None:
        """Take in one record; times that go backwards count as the time before."""
        now = record["time"] * 1000
        if now > LONGEST_MS:
            raise UsageError(f"{self._name}: the transcript ends after more than a day.")
        self._now = max(self._now, round(now))
        if do := self._do.get(record["phase"]):
            do(record)

    def result(self) -> Timeline:
        """The timeline; what has not ended ends with the last record."""
        for name in list(self._runs):
            self._close(name, "unfinished")
        for tree in list(self._streams):
            self._state(tree, None)
        self._hold("", "")
        self._turns()
        order = {kind: number for number, kind in enumerate(KINDS)}
        tiers = sorted(self._tiers.values(), key=lambda tier: order[tier.kind])
        names: set[str] = set()
        for tier in tiers:
            tier.name = unused(tier.name, names)
            tier.marks.sort(key=lambda mark: mark.start)
        return Timeline(
            tiers, self._now, self._head, self._name, self._over, languages=self._languages
        )

    # Tiers ----------------------------------------------------------------------------------

    def _tier(self, kind: str, who: str, device: str = "") -> Tier:
        tier = self._tiers.get((kind, device or who))
        if tier is None:
            if len(self._tiers) >= MOST_TIERS:
                raise UsageError(f"{self._name}: it makes more than {MOST_TIERS} tiers.")
            name = KINDS[kind] or (f"device: {device}" if device else f"{who}: {kind}")
            name, whose = clean(name, LONGEST_NAME), clean(who, LONGEST_NAME)
            tier = Tier(name, kind, whose, kind in POINTS)
            self._tiers[kind, device or who] = tier
        return tier

    def _put(
        self, tier: Tier, start: int, text: str, about: dict[str, str], end: int | None = None
    ) -> Interval:
        """A mark from ``start`` to ``end``, which is now if nothing is said."""
        kept = {name: made for name, value in about.items() if (made := clean(value))}
        mark = Interval(start, self._now if end is None else end, clean(text), kept)
        tier.marks.append(mark)
        self._marks += 1
        self._letters += len(mark.text) + sum(map(len, kept.values()))
        if self._marks > MOST_MARKS or self._letters > MOST_LETTERS:
            raise UsageError(
                f"{self._name}: it is too long for one file: more than {MOST_MARKS} intervals, or"
                f" {MOST_LETTERS} letters. Cut the transcript after whole lines."
            )
        return mark

    # Behaviors ------------------------------------------------------------------------------

    def _run(self, record: Record) -> None:
        self._head = self._head or record["data"]

    def _end_of_run(self, _: Record) -> None:
        self._over = True

    def _request(self, record: Record) -> None:
        self._asked[record["behavior"]] = {
            name: record[name] for name in ("args", "extra", "source") if record.get(name)
        }

    def _start(self, record: Record) -> None:
        base, _, loop = record["behavior"].partition(".")
        self._reaction(record)
        run, resumed = self._runs.get(base), bool(record.get("resumed"))
        goes_on = run is not None and run.ended == self._now and not resumed
        if run is None or not goes_on:
            self._close(base, "paused")
            run = self._runs[base] = self._begin(base, record)
        run.ended = None
        for device in () if run.unit else record.get("devices") or ():
            run.devices.setdefault(device, self._now)
        if run.words and (loop in ("", "1") or resumed):
            run.saying = self._now
        if record.get("tree"):
            stream = self._streams.get(record["tree"])
            if stream is None:
                self._streams[record["tree"]] = _Stream(record["app"], self._now, "active")

    def _begin(self, base: str, record: Record) -> _Run:
        command, asked = record["command"], self._asked.get(base) or {}
        words = record.get("text") or ""
        text = describe(command, words, asked.get("args"), asked.get("extra"))
        unit = self._runs.get(record.get("unit") or "")
        if unit is not None and len(unit.parts) < MOST_PARTS:
            unit.parts.append(text)
        about = {
            "application": record["app"],
            "behavior": base,
            "stream": record.get("tree") or "",
            "command": command,
            "rule": record.get("rule") or "",
            "source": asked.get("source") or "",
            "note": "resumed" if record.get("resumed") else "",
        }
        return _Run(record["app"], self._now, text, about, {}, command == "iu", words=words)

    def _listening(self, record: Record) -> None:
        self._fall_silent(record["behavior"].partition(".")[0], self._now)

    def _end(self, record: Record) -> None:
        base = record["behavior"].partition(".")[0]
        run = self._runs.get(base)
        if record["phase"] == "end" and record.get("outcome") == "again":
            if run is not None:
                self._fall_silent(base, self._now)
                run.ended = self._now
            return
        outcome = record.get("outcome") or ""
        self._close(base, "cancelled" if record["phase"] == "cancel" else outcome, record)
        self._asked.pop(base, None)

    def _fail(self, record: Record) -> None:
        base = (record.get("behavior") or "").partition(".")[0]
        self._close(base, "failed", record)
        self._asked.pop(base, None)
        what = describe(record.get("command") or "command", None, None)
        self._point(record, f"{what} fails: {record.get('message') or record.get('event') or ''}")

    def _interrupt(self, record: Record) -> None:
        self._close(record["behavior"].partition(".")[0], "interrupted", record)

    def _halted(self, record: Record) -> None:
        """The device tells what was heard of what was broken off: that alone was said."""
        mark = self._broken.pop(record["behavior"].partition(".")[0], None)
        heard = (record.get("data") or {}).get("heard")
        if mark is not None and heard:
            mark.text = clean(f"{heard} ...")

    def _collision(self, record: Record) -> None:
        """Without a mediator another behavior takes a device away."""
        run = self._runs.get(record["behavior"].partition(".")[0])
        device = record.get("device") or ""
        if run is not None and device in run.devices:
            self._release(run, device, "lost", record.get("by") or "")

    def _close(self, base: str, outcome: str, record: Record | None = None) -> None:
        """A behavior is over; one that waits for its next loop was over with its last."""
        run = self._runs.get(base)
        if run is None:
            return
        by = (record or {}).get("by") or ""
        end = self._now if run.ended is None else run.ended
        self._fall_silent(base, end, outcome)
        for device in list(run.devices):
            self._release(run, device, outcome, by, end)
        del self._runs[base]
        kind = "units" if run.unit else "does"
        about = {**run.about, "outcome": outcome, "by": by}
        text = (", ".join(run.parts) or "(nothing)") if run.unit else run.text
        self._put(self._tier(kind, run.app), run.start, text, about, end)

    def _release(
        self, run: _Run, device: str, outcome: str, by: str, end: int | None = None
    ) -> None:
        since = run.devices.pop(device)
        about = {**run.about, "outcome": outcome, "by": by}
        text = f"{run.app}: {run.text}"
        self._put(self._tier("device", "robot", device), since, text, about, end)

    def _fall_silent(self, base: str, end: int, outcome: str = "") -> None:
        """A behavior has said what it says."""
        run = self._runs.get(base)
        if run is None or run.saying is None:
            return
        about = {**run.about, "outcome": outcome}
        says = self._tier("says", run.app)
        mark = self._put(says, run.saying, run.words, about, end)
        if outcome == "interrupted":
            self._broken[base] = mark
        run.saying = None

    # Streams, floor, decisions --------------------------------------------------------------

    def _suspend(self, record: Record) -> None:
        by, rule = record.get("by") or "", record.get("rule") or ""
        new = _Stream(record["app"], self._now, "suspended", rule, by)
        self._state(record["tree"], new)

    def _resume(self, record: Record) -> None:
        new = _Stream(record["app"], self._now, "active", record.get("rule") or "")
        self._state(record["tree"], new)

    def _stream_end(self, record: Record) -> None:
        self._state(record["tree"], None)

    def _state(self, tree: str, new: _Stream | None) -> None:
        """A stream's state ends; what has taken no time is not shown."""
        old = self._streams.pop(tree, None)
        if new is not None:
            self._streams[tree] = new
        if old is None or old.since == self._now:
            return
        by = f" by {old.by}" if old.by else ""
        about = {"application": old.app, "stream": tree, "rule": old.rule, "by": old.by}
        about["outcome"] = old.state
        tier = self._tier("streams", old.app)
        self._put(tier, old.since, f"{tree} {old.state}{by}", about)

    def _floor(self, record: Record) -> None:
        held = record.get("floor") or ()
        self._hold(held[-1] if held else "", record.get("rule") or "")

    def _hold(self, tree: str, rule: str) -> None:
        """A stream takes the mediator's floor, or with none nobody does."""
        old = self._holder
        if old is not None and old[1] == tree:
            return
        self._holder = (self._now, tree, rule) if tree else None
        if old is not None and old[0] < self._now:
            about = {"application": old[1].rpartition(":")[0], "stream": old[1], "rule": old[2]}
            self._put(self._tier("holder", "robot"), old[0], old[1], about)

    def _decision(self, record: Record) -> None:
        winner, losers = record["winner"], record["losers"]
        more = record["losers_count"] - len(losers)
        lost = " ".join(losers) + (f" and {more} more" if more > 0 else "")
        about = {
            "application": record.get("app") or winner.rpartition("#")[0],
            "behavior": winner,
            "rule": record["rule"],
            "losers": lost,
        }
        tier = self._tier("why", "robot")
        self._put(tier, self._now, f"{record['rule']} {winner}", about)

    # Events ---------------------------------------------------------------------------------

    def _event(self, record: Record) -> None:
        name, serial = record["event"], record.get("serial")
        if serial is not None:
            self._events[serial] = (clean(name), self._now)
        if name == "speech":
            self._hear(record)
            return
        data = record.get("data") or {}
        told = ", ".join(
            f"{key} {_value(value)}"
            for key, value in data.items()
            if not isinstance(value, dict | list)
        )
        self._point(record, name + (f" ({told})" if told else ""))

    def _hear(self, record: Record) -> None:
        """What the user said is known when it is over; when it began is worked out."""
        text = clean(record.get("text") or "")
        told = (record.get("data") or {}).get("duration")
        known = isinstance(told, int | float) and 0 <= told <= LONGEST_MS
        lasted = round(told or 0) if known else voice.duration(text, voice.language(text), {})
        start = max(self._now - lasted, self._heard_until)
        self._heard_until = self._now
        about = {"event": "speech", "serial": str(record.get("serial") or "")}
        about["note"] = "" if known else "start estimated"
        self._put(self._tier("user-says", "user"), start, text, about)

    def _reaction(self, record: Record) -> None:
        """An application's first Command because of an event starts."""
        cause, app = record.get("cause"), record["app"]
        if cause not in self._events or (app, cause) in self._answered:
            return
        self._answered.add((app, cause))
        name, since = self._events[cause]
        seconds = f"{(self._now - since) / 1000:.3f}"
        about = {
            "application": app,
            "behavior": record["behavior"],
            "event": name,
            "serial": str(cause),
            "seconds": seconds,
            "rule": record.get("rule") or "",
        }
        text = f"{name}: {app} after {seconds} s"
        self._put(self._tier("reactions", "robot"), since, text, about)

    def _note(self, record: Record) -> None:
        self._point(record, record["text"])

    def _loaded(self, record: Record) -> None:
        if record["actor"] == "mediator":
            outcome = f": {record['outcome']}" if record.get("outcome") else ""
            verb = "starts" if record["phase"] == "load" else "ends"
            lang = (record.get("data") or {}).get("lang")
            if isinstance(lang, str) and TAG.fullmatch(lang):
                self._languages[record["app"]] = lang
            self._point(record, f"{record['app']} {verb}{outcome}")

    def _told(self, record: Record) -> None:
        data = record.get("data") or {}
        parts = (record.get("app"), record["phase"], data.get("uri"), record.get("outcome"))
        told = (*parts, data.get("problem"), record.get("message"))
        self._point(record, " ".join(str(part) for part in told if part))

    def _point(self, record: Record, text: str) -> None:
        """Something of the user's or the surroundings' happens."""
        user = record["actor"] == "user"
        tier = self._tier("user-does", "user") if user else self._tier("events", "environment")
        names = ("app", "behavior", "command", "rule", "outcome", "event", "serial", "source")
        about = {name: str(record[name]) for name in names if record.get(name) is not None}
        about["application"] = about.pop("app", "")
        self._put(tier, self._now, text, about)

    def _turns(self) -> None:
        """Who speaks, from when to when: applications and the user."""
        for (kind, _), tier in list(self._tiers.items()):
            if not kind.endswith("says"):
                continue
            for mark in tier.marks:
                about = {**mark.about, "note": mark.text}
                self._put(self._tier("floor", "robot"), mark.start, tier.who, about, mark.end)
