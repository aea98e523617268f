"""Contradictions of a run to its certificate: devices, waits of reactions, starvation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from prima.certificate import Certificate, Delay, Starving
from prima.devices.voice import duration
from prima.interpreter.selection import takes
from prima.messages import Record
from prima.transcript.observer import observe

SLACK = 0.002
"""How far (s) times may be off: records have them rounded."""
OVER = ("end", "fail", "cancel")
OWN = ("end", "cancel", "noinput", "nomatch", "late")
"""Events that an application makes for itself: certificates count none of them."""


@dataclass
class Spell:
    """A Command in a run: when it was asked for, could run, ran and was over (s)."""

    app: str
    name: str
    devices: frozenset[str]
    asked: float
    cause: int | None
    leaves: bool
    text: str
    parents: list[str]
    tree: str
    started: float | None = None
    loops: list[tuple[float, float]] = field(default_factory=list)
    over: float | None = None


class Watched:
    """A run's records, read for what a certificate is about."""

    def __init__(self, records: list[Record]) -> None:
        self.records = records
        self.ends = records[-1]["time"]
        self.spells: dict[str, Spell] = {}
        self.events: dict[int, tuple[float, str]] = {}
        for record in records:
            self._take(record)
        for spell in self.spells.values():
            if spell.loops and spell.loops[-1][1] < 0:
                spell.loops[-1] = (spell.loops[-1][0], self.ends)

    def _take(self, record: Record) -> None:
        phase, time = record["phase"], record["time"]
        if phase == "event" and record.get("serial"):
            self.events[record["serial"]] = (time, record["event"])
        if phase == "request":
            self._request(record)
        spell = self.spells.get(str(record.get("behavior")).partition(".")[0])
        if spell is None:
            return
        if phase == "start":
            spell.started = time if spell.started is None else spell.started
            spell.loops.append((time, -1.0))
        elif phase in OVER:
            if spell.loops and spell.loops[-1][1] < 0:
                spell.loops[-1] = (spell.loops[-1][0], time)
            if record.get("outcome") != "again":
                spell.over = time

    def _request(self, record: Record) -> None:
        parents = record.get("parents") or ([record["parent"]] if record.get("parent") else [])
        self.spells.setdefault(
            record["behavior"],
            Spell(
                record["app"],
                record["behavior"],
                frozenset(record["devices"]),
                record["time"],
                record.get("cause") if record.get("reactive") else None,
                bool(record.get("leaves")),
                record.get("text") or "",
                [name.partition(".")[0] for name in parents],
                record["tree"],
            ),
        )

    def of(self, app: str) -> list[Spell]:
        """The Commands of an application."""
        return [spell for spell in self.spells.values() if spell.app == app]

    def ran(self, spells: Iterable[Spell], since: float, until: float) -> float:
        """For how long (s) any of some Commands ran in a stretch of time."""
        found = sorted(
            (max(begin, since), min(end, until))
            for spell in spells
            for begin, end in spell.loops
            if end > since and begin < until
        )
        total, reached = 0.0, since
        for begin, end in found:
            total += max(end - max(begin, reached), 0.0)
            reached = max(reached, end)
        return total

    def spoken(self, since: float, until: float, rates: dict[str, float]) -> tuple[int, float]:
        """How often and how long (s) the user speaks in a stretch of time."""
        heard = [
            record
            for record in self.records
            if record["phase"] == "event" and record.get("event") == "speech"
        ]
        lasts = [
            (record["time"], duration(record["text"], "", rates) / 1000 + 1.0)
            for record in heard
            if record["time"] >= since and record["time"] <= until + 10
        ]
        return len(lasts), sum(length for _, length in lasts)


def faults(certificate: Certificate, records: list[Record], rates: dict[str, float]) -> list[str]:
    """What the EA does in a run to the FA that the certificate does not say."""
    run = Watched(records)
    return [
        *_devices(certificate, run),
        *_waits(certificate, run, rates),
        *_responses(certificate, run, rates),
        *_starved(certificate, run, rates),
    ]


def _devices(certificate: Certificate, run: Watched) -> list[str]:
    told = {*certificate.both, *certificate.only_ea}
    return [
        f"{spell.name} uses {spell.devices - told}"
        for spell in run.of(certificate.ea)
        if not spell.devices <= told and not certificate.gaps
    ]


def _waits(certificate: Certificate, run: Watched, rates: dict[str, float]) -> list[str]:
    found = []
    for spell in run.of(certificate.fa):
        if spell.cause not in run.events:
            continue
        asked, event = run.events[spell.cause]
        until = run.ends if spell.started is None else spell.started
        if spell.started is None and spell.over is not None:
            until = spell.over
        others = [one for one in run.of(certificate.fa) if one is not spell]
        waited = until - asked - run.ran(others, asked, until)
        told = [one for one in certificate.delays if takes(one.event, event)]
        allowed = _allowed(told, certificate, run, (asked, until), rates)
        if allowed is not None and waited > allowed + SLACK:
            found.append(
                f"{spell.name} about {event} at {asked} waits {waited:.3f} > {allowed:.3f}"
            )
    return found


def _responses(certificate: Certificate, run: Watched, rates: dict[str, float]) -> list[str]:
    """First words and movements towards the user that come later than they may."""
    found = []
    for delay in observe(run.records).delays:
        if delay.app != certificate.fa or delay.response is None:
            continue
        asked, _ = run.events[delay.serial]
        until = asked + delay.response
        waited = delay.response - run.ran(run.of(certificate.fa), asked, until)
        told = [one.response for one in certificate.delays if takes(one.event, delay.event)]
        if told and not any(told):
            found.append(f"{delay.event} at {asked} is not said to have a response")
        allowed = _allowed([one for one in told if one], certificate, run, (asked, until), rates)
        if allowed is not None and waited > allowed + SLACK:
            found.append(
                f"the response to {delay.event} at {asked} waits {waited:.3f} > {allowed:.3f}"
            )
    return found


def _allowed(
    told: list[Delay],
    certificate: Certificate,
    run: Watched,
    stretch: tuple[float, float],
    rates: dict[str, float],
) -> float | None:
    """How long (s) a reaction may wait; None where the certificate gives no bound."""
    if not told:
        return 0.0
    if not all(one.known for one in told):
        return None
    return max((_bound(one, certificate, run, stretch, rates) for one in told), default=0.0)


def _bound(
    delay: Delay,
    certificate: Certificate,
    run: Watched,
    stretch: tuple[float, float],
    rates: dict[str, float],
) -> float:
    since, until = stretch
    causes = {
        spell.cause
        for spell in run.of(certificate.ea)
        if spell.cause in run.events and since <= spell.asked <= until
    }
    causes = {one for one in causes if not _is_own(run.events[one][1])}
    further = len(causes) + (_unfinished(certificate, run, since) if delay.whole else 0)
    if delay.each is None and further:
        return float("inf")
    count, speaks = run.spoken(since, until, rates) if delay.listens else (0, 0.0)
    return (delay.lasts * (1 + count) + (delay.each or 0) * further) / 1000 + speaks


def _is_own(event: str) -> bool:
    return any(takes(one, event) for one in OWN)


def _unfinished(certificate: Certificate, run: Watched, since: float) -> int:
    """How many reactions the EA has begun before and not ended, by their streams."""
    own = run.of(certificate.ea)
    reactions = {spell.tree for spell in own if spell.cause is not None and spell.asked < since}
    left = {spell.tree for spell in own if spell.asked < since <= (spell.over or run.ends)}
    return len(reactions & left)


def _starved(certificate: Certificate, run: Watched, rates: dict[str, float]) -> list[str]:
    """Commands that are not reactions, and wait for longer than all that the EA does in one go."""
    found = []
    for spell in run.of(certificate.fa):
        since = max([spell.asked, *(_over(run, name) for name in spell.parents)])
        ended = (at for at in (spell.started, spell.over) if at is not None)
        until = next(ended, run.ends)
        if spell.cause is not None or since >= until:
            continue
        mine = [one for one in run.of(certificate.fa) if one is not spell]
        waited = until - since - run.ran(mine, since, until)
        wakes = 1 + _wakes(certificate, run, until)
        count, speaks = run.spoken(0.0, until, rates)
        allowed = certificate.others.lasts / 1000 * (wakes + count) + speaks
        allowed += sum(lasts for _, lasts in certificate.holds) / 1000
        told = any(_covers(one, spell) for one in certificate.starves)
        if waited > allowed + SLACK and not told and not certificate.others.unknown:
            found.append(f"{spell.name} starves for {waited:.3f} > {allowed:.3f}")
    for record in run.records:
        loops = record["phase"] == "starve" and record["rule"] == "E4"
        if loops and record["app"] == certificate.fa:
            spell = run.spells[record["behavior"].partition(".")[0]]
            if not any(_covers(one, spell) for one in certificate.starves):
                found.append(f"{spell.name} starves by {record['by']}")
    return found


def _wakes(certificate: Certificate, run: Watched, until: float) -> int:
    """How many events have given the EA something to do: by reactions, or by its own timers."""
    causes = {spell.cause for spell in run.of(certificate.ea) if spell.asked <= until}
    timers = [
        record
        for record in run.records
        if record["phase"] == "event" and record.get("app") == certificate.ea
    ]
    return len(causes) + len([one for one in timers if one["time"] <= until])


def _over(run: Watched, name: str) -> float:
    spell = run.spells.get(name)
    return run.ends if spell is None or spell.over is None else spell.over


def _covers(one: Starving, spell: Spell) -> bool:
    return (
        one.everything or bool(spell.devices & set(one.devices)) or (one.leaving and spell.leaves)
    )
