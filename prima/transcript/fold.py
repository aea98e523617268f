"""The fold of records, one by one, into behaviors, streams, floor, holds and reactions."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from itertools import chain

from prima.transcript.measures import Measure
from prima.transcript.record import Entry
from prima.transcript.spans import (
    OPEN,
    BehaviorSpan,
    DeviceUse,
    FloorSpan,
    Hold,
    Reaction,
    Run,
    Saying,
    Spell,
    StreamPiece,
    StreamSpan,
    StreamState,
    base,
)  # fmt: skip

ASKED = frozenset({"request", "interrupt", "hold", "resume", "starve"})
"""Phases of records that explain the time of an AB."""


class Fold:
    """Folds the records of one run, in order."""

    def __init__(self) -> None:
        self.now = 0.0
        self.entries: list[Entry] = []
        self.behaviors: dict[str, BehaviorSpan] = {}
        self.spells: list[Spell] = []
        self.uses: list[DeviceUse] = []
        self.sayings: list[Saying] = []
        self.streams: dict[str, StreamSpan] = {}
        self.states: list[StreamState] = []
        self.floors: list[FloorSpan] = []
        self.holds: list[Hold] = []
        self.reactions: list[Reaction] = []
        self.events: dict[int, Entry] = {}
        self.about: dict[str, list[tuple[int, Entry]]] = defaultdict(list)
        self.phases: dict[str, list[Entry]] = defaultdict(list)
        self.measure = Measure(delays=True)
        self._came: dict[int, float] = {}
        """The times of events."""
        self._answered: set[tuple[str, int]] = set()
        self._of: dict[str, StreamSpan] = {}
        """The streams of behaviors."""
        self._state: dict[str, StreamState] = {}
        self._held: dict[str, Hold] = {}
        self._do: dict[str, Callable[[Entry, str], None]] = {
            "request": self._request,
            "start": self._start,
            "listening": self._listening,
            "end": self._end,
            "cancel": self._end,
            "fail": self._end,
            "interrupt": self._end,
            "halted": self._halted,
            "collision": self._collision,
            "hold": self._hold,
            "suspend": self._suspend,
            "resume": self._resume,
            "stream-end": self._stream_end,
            "window": self._window,
            "floor": self._floor,
            "event": self._event,
            "decision": self._decision,
        }

    def add(self, entry: Entry) -> None:
        """Add one record; a time that goes backwards counts as the previous one."""
        self.now = max(self.now, entry.time)
        self.entries.append(entry)
        self.phases[entry.phase].append(entry)
        name = base(entry.behavior)
        if entry.phase in ASKED:
            self._tell(name, entry)
        criteria = self.measure.observer.found
        broken = criteria.broken
        self.measure.add(entry)
        if entry.phase == "start" and criteria.broken > broken and name in self._of:
            self._break(self._of[name])
        if do := self._do.get(entry.phase):
            do(entry, name)
        if name in self.behaviors:
            self.behaviors[name].last = entry.time

    def run(self) -> Run:
        """The run so far; ends the fold."""
        for spell in self.spells:
            if spell.behavior.spell is spell:
                self._close(spell.behavior, "unfinished", "", open_=True)
        for one in chain(self.states, self.floors, self.holds):
            if one.end < 0:
                one.end = self.now
        for stream in self.streams.values():
            self._finish(stream)
        return Run(
            self.entries, self.now, self._apps(), self.behaviors, self.spells, self.uses,
            self.sayings, self.streams, self.states, self.floors, self.holds,
            self.reactions, self.events, self.about, self.phases, self.measure,
        )  # fmt: skip

    def _apps(self) -> list[str]:
        loaded = (one.app for one in self.phases["load"])
        return list(
            dict.fromkeys(app for app in chain(loaded, (e.app for e in self.entries)) if app)
        )

    def _tell(self, name: str, entry: Entry) -> None:
        self.about[name].append((len(self.entries), entry))

    def _decision(self, entry: Entry, _: str) -> None:
        self._tell(entry.winner, entry)  # one of the loops, where there are loops

    # Behaviors ------------------------------------------------------------------------------

    def _request(self, entry: Entry, name: str) -> None:
        known = self.behaviors.setdefault(name, BehaviorSpan(name, entry, True))
        known.asked, known.requested, known.state = entry, True, "waiting"
        if entry.tree not in self.streams:
            self.streams[entry.tree] = StreamSpan(entry.tree, entry, entry.app, self.now)
        self._of[name] = self.streams[entry.tree]

    def _start(self, entry: Entry, name: str) -> None:
        self._react(entry)
        if entry.unit:
            self._tell(name, entry)
        self._let_go(name)
        behavior = self.behaviors.setdefault(name, BehaviorSpan(name, entry, False))
        behavior.state = "running"
        if behavior.began is None:
            behavior.began = entry.time
        spell = self._spell(behavior, entry)
        if not spell.unit:
            for device in entry.devices:
                spell.uses.setdefault(device, DeviceUse(self.now, device=device, spell=spell))
        if spell.start.text and (entry.resumed or entry.behavior.partition(".")[2] in ("", "1")):
            spell.saying = Saying(self.now, spell=spell)
        if entry.tree and entry.tree not in self._state:
            self._change(
                entry.tree, StreamState(self.now, tree=entry.tree, app=entry.app, state="active")
            )
        if name in self._of:
            self._begin(self._of[name], name)

    def _spell(self, behavior: BehaviorSpan, entry: Entry) -> Spell:
        """The spell that a start continues, or a new one."""
        spell = behavior.spell
        if spell is not None and spell.paused and spell.end == self.now and not entry.resumed:
            spell.cuts.append(self.now)
            spell.end, spell.paused = -1.0, False
            return spell
        self._close(behavior, "paused", "")
        spell = behavior.spell = Spell(self.now, behavior=behavior, start=entry)
        self.spells.append(spell)
        unit = self.behaviors.get(entry.unit)
        if unit is not None and unit.spell is not None:
            unit.spell.parts.append(spell)
        return spell

    def _listening(self, _: Entry, name: str) -> None:
        if name in self.behaviors and (spell := self.behaviors[name].spell) is not None:
            self._fall_silent(spell, self.now)

    def _end(self, entry: Entry, name: str) -> None:
        if entry.phase in ("cancel", "fail"):
            self._let_go(name)
        behavior = self.behaviors.get(name)
        if behavior is None:
            return
        if entry.phase == "fail" and entry.rule == "U5":
            behavior.late = True  # it ends after what runs in it
            return
        if name in self._of:
            self._stop(self._of[name], name)
        states = {"cancel": "cancelled", "fail": "failed", "interrupt": "interrupted"}
        if entry.phase == "end" and entry.outcome == "again":
            behavior.state = "waiting"
            if (spell := behavior.spell) is not None:
                self._fall_silent(spell, self.now)
                spell.end, spell.paused = self.now, True
            return
        outcome = states.get(entry.phase, "failed" if behavior.late else entry.outcome)
        behavior.state = {"end": "done", "interrupt": "waiting"}.get(entry.phase, outcome)
        self._close(behavior, outcome, entry.by)

    def _halted(self, entry: Entry, name: str) -> None:
        """The device reports what was heard of an interrupted text."""
        behavior = self.behaviors.get(name)
        if behavior is not None and behavior.broken is not None:
            behavior.broken.heard = entry.data.get("heard") or ""
            behavior.broken = None

    def _collision(self, entry: Entry, name: str) -> None:
        """Without a mediator, another behavior takes over a device."""
        behavior = self.behaviors.get(name)
        if behavior is not None and behavior.spell and entry.device in behavior.spell.uses:
            self._release(behavior.spell.uses.pop(entry.device), self.now, "lost", entry.by)

    def _close(self, behavior: BehaviorSpan, outcome: str, by: str, open_: bool = False) -> None:
        """End a spell; one that waits for its next loop ended with its last."""
        spell, behavior.spell = behavior.spell, None
        if spell is None:
            return
        end = spell.end if spell.paused else self.now
        self._fall_silent(spell, end, outcome)
        for use in spell.uses.values():
            self._release(use, end, outcome, by)
        spell.uses = {}
        spell.outcome, spell.by = outcome, by
        spell.close(end, OPEN if open_ else len(self.entries))

    def _release(self, use: DeviceUse, end: float, outcome: str, by: str) -> None:
        use.outcome, use.by = outcome, by
        use.close(end, len(self.entries))
        self.uses.append(use)

    def _fall_silent(self, spell: Spell, end: float, outcome: str = "") -> None:
        """End the saying of a spell."""
        saying, spell.saying = spell.saying, None
        if saying is not None:
            saying.outcome = outcome
            saying.close(end, len(self.entries))
            self.sayings.append(saying)
            if outcome == "interrupted":
                spell.behavior.broken = saying

    # Holds, floor, events -------------------------------------------------------------------

    def _hold(self, entry: Entry, name: str) -> None:
        if name not in self._held:
            app = entry.app or name.partition("#")[0]
            hold = Hold(self.now, name=name, app=app, by=entry.by, rule=entry.rule)
            self._held[name] = hold
            self.holds.append(hold)

    def _let_go(self, name: str) -> None:
        if hold := self._held.pop(name, None):
            hold.close(self.now, len(self.entries))

    def _floor(self, entry: Entry, _: str) -> None:
        if self.floors:
            self.floors[-1].close(self.now, len(self.entries))
        self.floors.append(FloorSpan(self.now, stack=entry.floor, rule=entry.rule))

    def _event(self, entry: Entry, _: str) -> None:
        if entry.serial is not None:
            self.events[entry.serial] = entry
            self._came[entry.serial] = self.now

    def _react(self, entry: Entry) -> None:
        """Record an application's first Command because of an event."""
        cause = entry.cause
        if cause is not None and cause in self.events and (entry.app, cause) not in self._answered:
            self._answered.add((entry.app, cause))
            reaction = Reaction(self.events[cause], entry, self._came[cause], self.now)
            self.reactions.append(reaction)

    # Streams --------------------------------------------------------------------------------

    def _change(self, tree: str, new: StreamState | None) -> None:
        """End a stream's state, and begin another."""
        if old := self._state.pop(tree, None):
            old.close(self.now, len(self.entries))
        if new is not None:
            self._state[tree] = new
            self.states.append(new)

    def _suspend(self, entry: Entry, _: str) -> None:
        tree, by, rule = entry.tree, entry.by, entry.rule
        new = StreamState(self.now, tree=tree, app=entry.app, state="suspended", rule=rule, by=by)
        self._change(tree, new)
        if tree in self.streams:
            self.streams[tree].away = StreamPiece(self.now, self.now, "away", by, rule)

    def _resume(self, entry: Entry, _: str) -> None:
        new = StreamState(self.now, tree=entry.tree, app=entry.app, state="active", rule=entry.rule)
        self._change(entry.tree, new)
        if entry.tree in self.streams:
            self._return(self.streams[entry.tree])

    def _stream_end(self, entry: Entry, _: str) -> None:
        self._change(entry.tree, None)
        if stream := self.streams.get(entry.tree):
            self._return(stream)
            stream.end, stream.ended = self.now, True

    def _window(self, entry: Entry, _: str) -> None:
        stream = self.streams.get(entry.tree)
        if stream is not None and self.now not in stream.windows[-1:]:
            stream.windows.append(self.now)

    def _begin(self, stream: StreamSpan, name: str) -> None:
        """Record that an AB of a stream runs."""
        if not stream.running:
            stream.since = self.now
        stream.running.add(name)
        stream.ended = False

    def _stop(self, stream: StreamSpan, name: str) -> None:
        if name in stream.running:
            stream.running.remove(name)
            if not stream.running:
                stream.put(StreamPiece(stream.since, self.now, "runs"))
                stream.paused = self.now

    def _return(self, stream: StreamSpan) -> None:
        if stream.away is not None:
            stream.away.end = self.now
            stream.put(stream.away)
            stream.away = None

    def _break(self, stream: StreamSpan) -> None:
        """Record that another application broke the stream before it goes on."""
        paused = self.now if stream.paused is None else stream.paused
        begin = min(paused, self.measure.observer.broken_since)
        came = [
            other.name
            for other in self.streams.values()
            if other.app != stream.app
            and any(piece.begin >= begin for piece in other.pieces if piece.kind == "runs")
        ]
        stream.put(StreamPiece(begin, self.now, "broken", ", ".join(came[:3])))

    def _finish(self, stream: StreamSpan) -> None:
        """End a stream with the transcript."""
        if stream.running:
            stream.put(StreamPiece(stream.since, self.now, "runs"))
        self._return(stream)
        if stream.end < 0 or not stream.ended:
            stream.end = self.now
        stream.pieces.sort(key=lambda piece: (piece.begin, piece.kind))
