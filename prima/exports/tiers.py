"""Builds the timeline of a run: the tiers of its spells, streams, floor and events."""

from __future__ import annotations

import json
from collections.abc import Iterable
from operator import attrgetter

from prima.devices import voice
from prima.errors import UsageError
from prima.exports.timeline import (
    KINDS,
    LONGEST_NAME,
    MOST_LETTERS,
    MOST_MARKS,
    MOST_PARTS,
    MOST_TIERS,
    POINTS,
    TAG,
    Interval,
    Tier,
    Timeline,
    clean,
    unused,
)  # fmt: skip
from prima.language.values import LONGEST_MS
from prima.messages import Json, Record
from prima.transcript.record import Entry
from prima.transcript.row import describe
from prima.transcript.run import Run, run_of
from prima.transcript.spans import Saying, Spell


def timeline(name: str, records: Iterable[Record]) -> Timeline:
    """The timeline of a transcript's records; ``name`` is for messages.

    Raises:
        UsageError: a record lacks a field of its phase, or the run is too long for one file.
    """
    run = run_of(records, name)
    if run.end * 1000 > LONGEST_MS:
        raise UsageError(f"{name}: the transcript ends after more than a day.")
    return _TierBuilder(name, run).result()


def _ms(seconds: float) -> int:
    return round(seconds * 1000)


class _TierBuilder:
    """Fills the tiers; marks of one tier with the same start are in the order of their ends."""

    def __init__(self, name: str, run: Run) -> None:
        self._name = name
        self._run = run
        self._tiers: dict[tuple[str, str], Tier] = {}
        self._marks = self._letters = 0

    def result(self) -> Timeline:
        """The timeline; open marks end with the last record."""
        run = self._run
        self._speech()
        self._behaviors()
        self._streams()
        self._holders()
        self._reactions()
        for entry in run.entries:
            self._entry(entry)
        order = {kind: number for number, kind in enumerate(KINDS)}
        tiers = sorted(self._tiers.values(), key=lambda tier: order[tier.kind])
        names: set[str] = set()
        for tier in tiers:
            tier.name = unused(tier.name, names)
            tier.marks.sort(key=lambda mark: mark.start)
        languages = {app: tag for app, tag in run.languages.items() if TAG.fullmatch(tag)}
        over = bool(run.of("over"))
        return Timeline(tiers, _ms(run.end), run.head, self._name, over, languages=languages)

    # Tiers ----------------------------------------------------------------------------------

    def _tier(self, kind: str, who: str, device: str = "") -> Tier:
        tier = self._tiers.get((kind, device or who))
        if tier is None:
            if len(self._tiers) >= MOST_TIERS:
                raise UsageError(f"{self._name}: more than {MOST_TIERS} tiers.")
            name = KINDS[kind] or (f"device: {device}" if device else f"{who}: {kind}")
            name, whose = clean(name, LONGEST_NAME), clean(who, LONGEST_NAME)
            tier = Tier(name, kind, whose, kind in POINTS)
            self._tiers[kind, device or who] = tier
        return tier

    def _put(self, tier: Tier, start: float, end: float, text: str, about: dict[str, str]) -> None:
        """Add a mark; times in seconds."""
        kept = {name: made for name, value in about.items() if (made := clean(value))}
        mark = Interval(_ms(start), _ms(end), clean(text), kept)
        tier.marks.append(mark)
        self._marks += 1
        self._letters += len(mark.text) + sum(map(len, kept.values()))
        if self._marks > MOST_MARKS or self._letters > MOST_LETTERS:
            raise UsageError(
                f"{self._name}: too long for one file: more than {MOST_MARKS} intervals, or"
                f" {MOST_LETTERS} characters. Cut the transcript after whole lines."
            )

    # Behaviors ------------------------------------------------------------------------------

    def _behaviors(self) -> None:
        for spell in sorted(self._run.spells, key=attrgetter("closed")):
            kind = "units" if spell.unit else "does"
            text = _title(spell)
            if spell.unit:
                text = ", ".join(map(_title, spell.parts[:MOST_PARTS])) or "(nothing)"
            about = {**_about(spell), "outcome": spell.outcome, "by": spell.by}
            self._put(self._tier(kind, spell.start.app), spell.begin, spell.end, text, about)
        for use in self._run.uses:
            spell = use.spell
            about = {**_about(spell), "outcome": use.outcome, "by": use.by}
            tier = self._tier("device", "robot", use.device)
            self._put(tier, use.begin, use.end, f"{spell.start.app}: {_title(spell)}", about)

    def _speech(self) -> None:
        """Add what applications and the user say, and who speaks when."""
        entries = enumerate(self._run.entries, 1)
        turns: list[tuple[int, Entry | Saying]] = [(n, one) for n, one in entries if one.spoken]
        turns += [(one.closed, one) for one in self._run.sayings]
        until: dict[str, float] = {}
        for _, one in sorted(turns, key=lambda turn: turn[0]):
            if isinstance(one, Entry):
                person = str(one.data.get("person", ""))
                self._hear(one, until.get(person, 0.0))
                until[person] = one.time
                continue
            words = f"{one.heard} ..." if one.heard else one.spell.start.text
            about = {**_about(one.spell), "outcome": one.outcome}
            self._put(self._tier("says", one.spell.start.app), one.begin, one.end, words, about)
        for (kind, _), tier in list(self._tiers.items()):
            for mark in tier.marks if kind.endswith("says") else ():
                about = {**mark.about, "note": mark.text}
                floor = self._tier("floor", "robot")
                self._put(floor, mark.start / 1000, mark.end / 1000, tier.who, about)

    def _hear(self, entry: Entry, until: float) -> None:
        """Add what a user said; its start is computed, as the record comes at its end.

        It is not before ``until``, the end of what they said before.
        """
        text, lasted = clean(entry.text), _lasted(entry)
        about = {"event": "speech", "serial": str(entry.serial or "")}
        about["note"] = "start estimated" if lasted is None else ""
        if lasted is None:
            lasted = voice.timeline(text, voice.language(text), {}, ()).total
        start = max(_ms(entry.time) - lasted, _ms(until)) / 1000
        self._put(self._tier("user-says", "user"), start, entry.time, text, about)

    # Streams, floor, reactions --------------------------------------------------------------

    def _streams(self) -> None:
        """Add the states of streams, except those without duration."""
        for one in sorted(self._run.states, key=attrgetter("closed")):
            if _ms(one.begin) == _ms(one.end):
                continue
            by = f" by {one.by}" if one.by else ""
            about = {"application": one.app, "stream": one.tree, "rule": one.rule, "by": one.by}
            about["outcome"] = one.state
            tier = self._tier("streams", one.app)
            self._put(tier, one.begin, one.end, f"{one.tree} {one.state}{by}", about)

    def _holders(self) -> None:
        """Add who holds the mediator's floor."""
        held: list[tuple[float, str, str]] = []
        for one in self._run.floors:
            holder = one.stack[-1] if one.stack else ""
            if not held or held[-1][1] != holder:
                held.append((one.begin, holder, one.rule))
        ends = [*(begin for begin, _, _ in held[1:]), self._run.end]
        for (begin, holder, rule), end in zip(held, ends, strict=False):
            if holder and _ms(begin) < _ms(end):
                about = {"application": holder.rpartition(":")[0], "stream": holder, "rule": rule}
                self._put(self._tier("holder", "robot"), begin, end, holder, about)

    def _reactions(self) -> None:
        """Add reactions, from each event to an application's first Command because of it."""
        for one in self._run.reactions:
            name, app = clean(one.event.event), one.start.app
            seconds = f"{(_ms(one.end) - _ms(one.begin)) / 1000:.3f}"
            about = {
                "application": app,
                "behavior": one.start.behavior,
                "event": name,
                "serial": str(one.start.cause),
                "seconds": seconds,
                "rule": one.start.rule,
            }
            text = f"{name}: {app} after {seconds} s"
            self._put(self._tier("reactions", "robot"), one.begin, one.end, text, about)

    # Points ---------------------------------------------------------------------------------

    def _entry(self, entry: Entry) -> None:
        """Add a record as a point."""
        match entry.phase:
            case "decision":
                self._decision(entry)
            case "event" if not entry.spoken:
                self._point(entry, entry.event + _values(entry.data))
            case "fail":
                what = describe(entry.command or "command", None, None)
                self._point(entry, f"{what} fails: {entry.message or entry.event}")
            case "note":
                self._point(entry, entry.text)
            case "load" | "unload" if entry.actor == "mediator":
                outcome = f": {entry.outcome}" if entry.outcome else ""
                verb = "starts" if entry.phase == "load" else "ends"
                self._point(entry, f"{entry.app} {verb}{outcome}")
            case "fetched" | "transferred" | "emergency" | "error":
                about = (entry.app, entry.phase, entry.data.get("uri"), entry.outcome)
                why = (entry.data.get("problem"), entry.message)
                self._point(entry, " ".join(map(str, filter(None, (*about, *why)))))

    def _decision(self, entry: Entry) -> None:
        winner, more = entry.winner, entry.losers_count - len(entry.losers)
        about = {
            "application": entry.app or winner.rpartition("#")[0],
            "behavior": winner,
            "rule": entry.rule,
            "losers": " ".join(entry.losers) + (f" and {more} more" if more > 0 else ""),
        }
        tier = self._tier("why", "robot")
        self._put(tier, entry.time, entry.time, f"{entry.rule} {winner}", about)

    def _point(self, entry: Entry, text: str) -> None:
        """Add a point of the user or the surroundings."""
        user = entry.actor == "user"
        tier = self._tier("user-does", "user") if user else self._tier("events", "environment")
        about = {
            "behavior": entry.behavior,
            "command": entry.command,
            "rule": entry.rule,
            "outcome": entry.outcome,
            "event": entry.event,
            "serial": "" if entry.serial is None else str(entry.serial),
            "source": entry.source,
            "application": entry.app,
        }
        self._put(tier, entry.time, entry.time, text, about)


def _lasted(entry: Entry) -> int | None:
    """How long a user spoke (ms), if the transcript has it: all of it, or what was recorded."""
    for name, unit in (("lasted", 1000), ("duration", 1)):
        value = entry.data.get(name)
        if isinstance(value, int | float) and 0 <= value * unit <= LONGEST_MS:
            return round(value * unit)
    return None


def _title(spell: Spell) -> str:
    asked = spell.behavior.asked
    return describe(spell.start.command, spell.start.text, asked.args, asked.extra)


def _about(spell: Spell) -> dict[str, str]:
    start = spell.start
    return {
        "application": start.app,
        "behavior": spell.behavior.name,
        "stream": start.tree,
        "command": start.command,
        "rule": start.rule,
        "source": spell.behavior.asked.source,
        "note": "resumed" if start.resumed else "",
    }


def _values(data: dict[str, Json]) -> str:
    """An event's scalar values, in brackets."""
    details = ", ".join(
        f"{key} {one if isinstance(one, str) else json.dumps(one)}"
        for key, one in data.items()
        if not isinstance(one, dict | list)
    )
    return f" ({details})" if details else ""
