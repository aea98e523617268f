"""The thesis's criteria for a mediated order, counted in a transcript (docs/measures.md).

Nothing of the mediator's own view is used (its floor, its suspensions): requests,
starts, ends and events alone say what a user has seen, so that all policies are
measured alike. Times in seconds.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from statistics import fmean

from prima.messages import Record


@dataclass(frozen=True, slots=True)
class Delay:
    """An event, and how long (s) until an application's first Command because of it started."""

    event: str
    serial: int
    app: str
    seconds: float


@dataclass(slots=True)
class Criteria:
    """What a run did to units, streams and the channel, and how soon it answered."""

    units_cut: int = 0
    """Behaviors that lost a device to another application while they ran."""
    restarts: int = 0
    """Behaviors that gave way because their author allowed it (X2)."""
    broken: int = 0
    """Streams broken by no reaction."""
    broken_waiting: int = 0
    """Waits for a server into which another application came by no reaction (first pattern)."""
    unfaced: int = 0
    """Conversations begun without the channel (second pattern)."""
    left: int = 0
    """Conversations that the robot went away from before they were over."""
    reactions: int = 0
    """Events that some application reacted to."""
    reaction_mean: float = 0.0
    reaction_max: float = 0.0
    delays: list[Delay] = field(default_factory=list)
    """How soon each application answered each event."""


@dataclass(slots=True)
class _Tree:
    """A Communication Stream as far as a user can tell."""

    name: str
    app: str
    pending: dict[str, Record] = field(default_factory=dict)
    """Requests of it that have not ended, by AB."""
    running: set[str] = field(default_factory=set)
    begun: bool = False
    engaged: bool = False
    broken_by: str = ""
    """The application that has come in since it last did something, if any."""
    by_reaction: bool = False
    left_by: set[str] = field(default_factory=set)
    reacting: float = -1.0
    """When a reaction of it started last, if nobody has come in since; else less than 0."""


@dataclass(slots=True)
class _Wait:
    """An application waits for a service's answer."""

    talked: bool
    """Whether it was or has been doing something for the user: else nobody notices."""
    since: float
    broken: bool = False
    """Whether another application came in, by no reaction."""


class Observer:
    """Goes through the records of one run, in order."""

    def __init__(self) -> None:
        self.found = Criteria()
        self._trees: dict[str, _Tree] = {}
        self._of: dict[str, _Tree] = {}
        self._talks: set[str] = set()
        """Streams that have asked or will ask the user something."""
        self._first_word: dict[str, bool] = {}
        self._seen = False
        self._cut: set[str] = set()
        self._now = 0.0
        self._events: dict[int, tuple[str, float]] = {}
        self._delays: dict[tuple[str, int], Delay] = {}
        self._waits: dict[tuple[str, str], _Wait] = {}
        """Applications that wait for a service's answer, by application and service."""
        self._answered: dict[int, str] = {}
        """Answers to waits that were broken, by their serial number, until they are taken up."""

    def add(self, record: Record, time: float | None = None) -> None:
        """Take in one record; ``time`` in seconds, where the record's own is not."""
        self._now = record["time"] if time is None else time
        match record["phase"]:
            case "request":
                self._request(record)
            case "start":
                self._start(record)
            case "end" | "cancel" | "fail" if record.get("behavior"):
                self._end(record)
            case "stream-end":
                self._trees.pop(record["tree"], None)
            case "event":
                self._event(record)
            case "send":
                app = record["app"]
                talking = any(tree.begun for tree in self._trees.values() if tree.app == app)
                self._waits[app, record["data"]["to"]] = _Wait(talking, self._now)
            case "collision":
                self._collide(record)
            case "interrupt":
                self.found.restarts += 1
                self._end(record, again=True)

    def result(self) -> Criteria:
        """What has been counted."""
        found = self.found
        found.delays = list(self._delays.values())
        delays = [delay.seconds for delay in found.delays]
        found.unfaced = sum(
            not faced for tree, faced in self._first_word.items() if tree in self._talks
        )
        found.reactions = len(delays)
        found.reaction_mean = round(fmean(delays), 3) if delays else 0.0
        found.reaction_max = round(max(delays, default=0.0), 3)
        return found

    def _request(self, record: Record) -> None:
        tree = self._trees.get(record["tree"])
        if tree is None:
            tree = self._trees[record["tree"]] = _Tree(record["tree"], record["app"])
        tree.pending[record["behavior"]] = record
        self._of[record["behavior"]] = tree
        if record["command"] == "q-and-a":
            self._talks.add(tree.name)

    def _start(self, record: Record) -> None:
        name = record["behavior"].partition(".")[0]
        tree = self._of.get(name)
        if tree is None:
            return
        request = tree.pending.get(name, record)
        if record.get("cause") in self._events:
            app, event = record["app"], self._events[record["cause"]]
            seconds = round(self._now - event[1], 3)
            delay = Delay(event[0], record["cause"], app, seconds)
            self._delays.setdefault((app, record["cause"]), delay)
        if self._answered.get(record.get("cause") or 0) == record["app"]:
            del self._answered[record["cause"]]
            self.found.broken_waiting += 1
        if record.get("reactive"):
            tree.reacting = self._now
        if record.get("text"):
            for (app, _), wait in self._waits.items():
                wait.talked = wait.talked or app == tree.app
        if record.get("text") and record["command"] != "active-sensing-human":
            self._first_word.setdefault(tree.name, self._seen)
        again = not record.get("resumed") and record["behavior"].partition(".")[2] not in ("", "1")
        if not again:
            self._come_in(tree)
            if request.get("leaves"):
                self._leave(tree, record["behavior"])
        if tree.broken_by:
            self.found.broken += not tree.by_reaction
            tree.broken_by = ""
        tree.begun = True
        tree.running.add(name)
        tree.engaged = tree.engaged or bool(request.get("engages"))

    def _come_in(self, tree: _Tree) -> None:
        """Something of a stream begins: what others have not finished may be broken by it."""
        for other in self._trees.values():
            if other.app == tree.app or other.broken_by or not other.begun:
                continue
            # Where only a way is left to go, no topic is broken.
            topic = any(not one.get("leaves") for one in other.pending.values())
            if topic and not other.running and not tree.running:
                other.broken_by = tree.app
                other.by_reaction = tree.reacting >= 0
                other.reacting = -1.0  # when it goes on, that is no reaction any more
        for (app, _), wait in self._waits.items():
            broken = wait.talked and app != tree.app and tree.reacting < wait.since
            wait.broken = wait.broken or broken

    def _leave(self, tree: _Tree, behavior: str) -> None:
        """The robot goes away: is another application in the middle of a conversation?"""
        for other in self._trees.values():
            if other.app == tree.app or not other.engaged:
                continue
            doing = [other.pending[name] for name in other.running if name in other.pending]
            if doing and all(one.get("leaves") for one in doing):
                continue
            if tree.name not in other.left_by:
                other.left_by.add(tree.name)
                self.found.left += 1

    def _end(self, record: Record, again: bool = False) -> None:
        name = record["behavior"].partition(".")[0]
        tree = self._of.get(name)
        if tree is None:
            return
        tree.running.discard(name)
        if not (again or record.get("outcome") in ("again", "halted")):
            tree.pending.pop(name, None)

    def _event(self, record: Record) -> None:
        name = record["event"]
        if name in ("human.found", "human.lost"):
            self._seen = name == "human.found"
        if record.get("serial"):
            self._events[record["serial"]] = (record["event"], self._now)
        for kind in ("reply.", "error.service."):
            service = name.removeprefix(kind)
            wait = self._waits.pop((record.get("app") or "", service), None)
            if name.startswith(kind) and wait is not None and wait.broken:
                self._answered[record["serial"]] = record["app"]

    def _collide(self, record: Record) -> None:
        name = record["behavior"].partition(".")[0]
        mine, theirs = self._of.get(name), self._of.get(record["by"].partition(".")[0])
        if mine is None or theirs is None or mine.app == theirs.app or name in self._cut:
            return
        self._cut.add(name)
        self.found.units_cut += 1


def observe(records: Iterable[Record]) -> Criteria:
    """Count the criteria in a whole transcript."""
    observer = Observer()
    for record in records:
        observer.add(record)
    return observer.result()
