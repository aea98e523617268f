"""Counts the criteria of a run from its records, one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import ClassVar

from prima.messages import Record
from prima.transcript.criteria import Criteria, ReactionDelay
from prima.transcript.perceived import (
    NEVER,
    AwaitedAnswer,
    AwaitingEvent,
    PerceivedStream,
    does_speak,
)
from prima.transcript.record import Entry

LATE_REACTION = 3.0
"""A reaction is late from this many seconds after its event."""
LATE_ANSWER = 3.0
"""Within this many seconds after a question's timeout, words that end still answer it."""
RESUMES = "X9"
"""The mark of words with which a topic resumes."""
PARTS = 1 << 80
"""The parts of a second in which floats from a microsecond on are integers."""
MOST_EVENTS = 1000
"""The number of later events after which a reaction no longer counts."""
MOST_STREAMS = 256
"""Maximum number of streams, and of waits, that are tracked: each start checks all of them."""


class Observer:
    """Counts the criteria of one run in bounded memory.

    Args:
        delays: whether each reaction is kept in the result, beside their number and times.
    """

    def __init__(self, delays: bool = True) -> None:
        self.found = Criteria()
        self._keeps_delays = delays
        self._delayed = 0
        """The seconds of all reactions, in parts small enough for an exact sum."""
        self._responded = 0
        """The seconds until all responses, in such parts."""
        self._trees: dict[str, PerceivedStream] = {}
        self._of: dict[str, PerceivedStream] = {}
        """The streams of behaviors that have not ended."""
        self.broken_since = 0.0
        """When another application entered the stream that was last counted as broken."""
        self._seen = False
        self._cut: set[str] = set()
        """Running behaviors that have lost a device."""
        self._gave_way: set[str] = set()
        """Behaviors that were interrupted and have neither started again nor ended."""
        self._now = 0.0
        self._events: dict[int, AwaitingEvent] = {}
        """The latest events, by serial number."""
        self._waits: dict[tuple[str, str], AwaitedAnswer] = {}
        """Applications that wait for a service's answer, by application and service."""
        self._stolen: dict[str, bool] = {}
        """Streams with an answered question whose next word is awaited, and whether another
        application has spoken meanwhile."""
        self._lapsed: dict[str, float] = {}
        """When a question of each application was the latest to time out."""

    def add(self, record: Entry) -> None:
        """Add one record."""
        self._now = record.time
        if do := self._DO.get(record.phase):
            do(self, record)

    def _send(self, record: Entry) -> None:
        talking = any(tree.begun for tree in self._trees.values() if tree.app == record.app)
        self._waits[record.app, record.data["to"]] = AwaitedAnswer(talking, self._now)
        if len(self._waits) > MOST_STREAMS:
            del self._waits[next(iter(self._waits))]

    def _interrupt(self, record: Entry) -> None:
        self._gave_way.add(record.behavior.partition(".")[0])
        self._end(record, again=True)

    def result(self) -> Criteria:
        """The result so far."""
        found = self.found
        unfaced = found.unfaced + sum(tree.unfaced for tree in self._trees.values())
        return replace(
            found,
            reaction_mean=_mean(self._delayed, found.reactions),
            response_mean=_mean(self._responded, found.responses),
            unfaced=unfaced,
        )

    def _request(self, record: Entry) -> None:
        tree = self._trees.get(record.tree)
        if tree is None:
            tree = self._trees[record.tree] = PerceivedStream(record.tree, record.app)
            if len(self._trees) > MOST_STREAMS:
                self._forget(next(iter(self._trees)))
        tree.pending[record.behavior] = record
        if not record.leaves:
            tree.topics.add(record.behavior)
        self._of[record.behavior] = tree

    def _forget(self, name: str) -> None:
        """Drop a stream that is over, or one of too many."""
        self._stolen.pop(name, None)
        tree = self._trees.pop(name, None)
        self.found.unfaced += tree is not None and tree.unfaced

    def _start(self, record: Entry) -> None:
        name = record.behavior.partition(".")[0]
        tree = self._of.get(name)
        if tree is None:
            return
        request = tree.pending.get(name, record)
        self.found.restarts += name in self._gave_way
        self._gave_way.discard(name)
        if record.cause is not None and record.cause in self._events:
            self._react(tree, record.cause, self._events[record.cause])
        if record.reactive:
            tree.reacting = self._now
        if record.text:
            self._talk(tree, record)
        again = not record.resumed and record.behavior.partition(".")[2] not in ("", "1")
        if not again:
            self._begin(tree, record, request)
        self._go_on(tree, request, not again and does_speak(request))
        tree.run(name, request)

    def _talk(self, tree: PerceivedStream, record: Entry) -> None:
        """Something is said: a waiting application is noticed, or a conversation begins."""
        for (app, _), wait in self._waits.items():
            wait.talked = wait.talked or app == tree.app
        if record.command != "active-sensing-human" and tree.faced is None:
            tree.faced = self._seen

    def _begin(self, tree: PerceivedStream, record: Entry, request: Entry) -> None:
        """A behavior begins or resumes: note its effects on others, and whether it responds."""
        speaks = does_speak(request)
        self._come_in(tree, speaks)
        if request.leaves:
            self._leave(tree, record.behavior)
        if speaks:
            self._take_turn(tree, record)
            tree.speaking.add(record.behavior.partition(".")[0])
        if record.text or (request.engages and record.command != "q-and-a"):
            self._respond(tree)

    def _take_turn(self, tree: PerceivedStream, record: Entry) -> None:
        """An application speaks: note whether it asked the question that the user answered."""
        if self._stolen.pop(tree.name, False) and record.command != "q-and-a":
            self.found.third_turns += 1
        for name in self._stolen:
            other = self._trees[name]
            self._stolen[name] = self._stolen[name] or other.app != tree.app
        self._take_up(tree, record)

    def _take_up(self, tree: PerceivedStream, record: Entry) -> None:
        """An application speaks: note whether it resumes its topic after others, and says so."""
        request = tree.pending.get(record.behavior.partition(".")[0], record)
        marked = request.inserted == RESUMES
        if tree.talked_over and not marked and not tree.reacts(request):
            self.found.wordless += 1
        tree.has_spoken, tree.talked_over = True, False
        for other in self._trees.values():
            other.talked_over = other.talked_over or (other.has_spoken and other.app != tree.app)

    def _over(self, record: Entry) -> None:
        """A behavior ends; if it is a question, note whose answer it took."""
        tree = self._of.get(record.behavior)
        if tree is not None and record.command == "q-and-a":
            if record.outcome == "noinput":
                self._lapsed[tree.app] = self._now
            elif record.outcome == "filled":
                others = [when for app, when in self._lapsed.items() if app != tree.app]
                since = round(self._now - max(others, default=-LATE_ANSWER - 1), 3)
                self.found.misanswered += since <= LATE_ANSWER
                self._stolen[tree.name] = False
        self._end(record)

    def _go_on(self, tree: PerceivedStream, request: Entry, speaks: bool) -> None:
        """A stream does something, or speaks: note whether another application has broken it.

        ABs that begin beside it at the same instant do not break it.
        """
        if request.feedback and tree.spoken_into == self._now:
            tree.spoken_into = NEVER  # what is said beside a way from its first instant on
        since = tree.spoken_into if speaks else self._now
        if tree.broken_by and not tree.by_reaction:
            since = min(since, tree.entered)
        broken = since < self._now
        if broken:
            self.found.broken += 1
            self.broken_since = since
        tree.broken_by = ""
        if speaks or broken:
            tree.spoken, tree.spoken_into = speaks, NEVER

    def _react(self, tree: PerceivedStream, serial: int, event: AwaitingEvent) -> None:
        """An application starts something in reaction to an event: the first time counts."""
        found, app = self.found, tree.app
        if app not in event.answered:
            event.answered.add(app)
            seconds = round(self._now - event.time, 3)
            found.reactions += 1
            found.reaction_max = max(found.reaction_max or 0.0, seconds)
            found.late_reactions += seconds > LATE_REACTION
            self._delayed += int(seconds * PARTS)
            delay = ReactionDelay(event.name, serial, app, seconds)
            tree.owed = [*tree.owed[-MOST_STREAMS:], (event.time, delay)]
            if self._keeps_delays:
                found.delays.append(delay)
        if event.waited == app:
            event.waited = ""
            found.broken_waiting += 1

    def _respond(self, tree: PerceivedStream) -> None:
        """The user is spoken to or turned to: this responds to all events of the stream."""
        found = self.found
        for time, delay in tree.owed:
            delay.response = seconds = round(self._now - time, 3)
            found.responses += 1
            found.response_max = max(found.response_max or 0.0, seconds)
            self._responded += int(seconds * PARTS)
        tree.owed = []

    def _come_in(self, tree: PerceivedStream, speaks: bool) -> None:
        """An AB of a stream begins: it may break what others have not finished."""
        for other in self._trees.values():
            if other.app != tree.app and other.begun:
                self._come_into(other, tree, speaks)
        for (app, _), wait in self._waits.items():
            broken = wait.talked and app != tree.app and tree.reacting < wait.since
            wait.broken = wait.broken or broken

    def _come_into(self, other: PerceivedStream, tree: PerceivedStream, speaks: bool) -> None:
        """A stream enters another one, which is broken if it continues later."""
        if speaks and other.spoken and other.spoken_into == NEVER:
            self._speak_into(other, tree)
        idle = not other.running and not tree.running
        first = not other.broken_by or (other.by_reaction and tree.reacting < 0)
        # A stream that only has to drive away has no topic to break.
        if other.topics and idle and first:
            other.broken_by, other.entered = tree.app, self._now
            other.by_reaction = tree.reacting >= 0
            other.reacting = -1.0  # its continuation does not count as a reaction any more

    def _speak_into(self, other: PerceivedStream, tree: PerceivedStream) -> None:
        """A stream speaks while another that has spoken goes on: note whether it breaks a topic.

        Speaking during a way or a search is fine: a feedback Command takes as long as it takes.
        """
        if other.looping or other.speaking:
            return
        if other.running or other.topics:
            other.spoken_into = self._now if tree.reacting < 0 else NEVER
        if other.running:
            other.reacting = -1.0

    def _leave(self, tree: PerceivedStream, behavior: str) -> None:
        """The robot leaves: note whether another application is in the middle of a conversation."""
        for other in self._trees.values():
            if other.app == tree.app or not other.engaged:
                continue
            if 0 < len(other.leaving) == len(other.running):
                continue
            if tree.name not in other.left_by:
                other.left_by.add(tree.name)
                self.found.left += 1

    def _fail(self, record: Entry) -> None:
        """An AB fails; a unit that has taken too long ends after what runs in it (U5)."""
        if record.rule != "U5":
            self._end(record)

    def _end(self, record: Entry, again: bool = False) -> None:
        name = record.behavior.partition(".")[0]
        tree = self._of.get(name)
        if tree is None:
            return
        tree.running.discard(name)
        tree.leaving.discard(name)
        tree.looping.discard(name)
        tree.speaking.discard(name)
        if not (again or record.outcome in ("again", "halted")):
            tree.pending.pop(name, None)
            tree.topics.discard(name)
            del self._of[name]
            self._cut.discard(name)
            self._gave_way.discard(name)

    def _event(self, record: Entry) -> None:
        name = record.notice
        if name in ("human.found", "human.lost"):
            self._seen = name == "human.found"
        event = AwaitingEvent(name, self._now)
        if record.serial:
            self._events[record.serial] = event
            if len(self._events) > MOST_EVENTS + 1:
                del self._events[next(iter(self._events))]
        for kind in ("reply.", "error.service."):
            service = name.removeprefix(kind)
            wait = self._waits.pop((record.app, service), None)
            if name.startswith(kind) and wait is not None and wait.broken:
                event.waited = record.app

    def _collide(self, record: Entry) -> None:
        name = record.behavior.partition(".")[0]
        mine, theirs = self._of.get(name), self._of.get(record.by.partition(".")[0])
        if mine is None or theirs is None or mine.app == theirs.app or name in self._cut:
            return
        self._cut.add(name)
        self.found.units_cut += 1

    _DO: ClassVar[dict[str, Callable[[Observer, Entry], None]]] = {
        "request": _request,
        "start": _start,
        "end": _over,
        "cancel": _end,
        "fail": _fail,
        "stream-end": lambda self, record: self._forget(record.tree),
        "event": _event,
        "emergency": _event,
        "send": _send,
        "collision": _collide,
        "interrupt": _interrupt,
    }


def _mean(parts: int, number: int) -> float | None:
    """The mean of a number of times from their sum; None if there are none."""
    return round(parts / PARTS / number, 3) if number else None


def observe(records: Iterable[Record]) -> Criteria:
    """Count the criteria in a whole transcript."""
    observer = Observer()
    for record in records:
        observer.add(Entry(record))
    return observer.result()
