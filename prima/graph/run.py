"""What a transcript shows as a picture: the trees of Atomic Behaviors, and the streams' history."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from prima.graph.model import Graph, Node, clean
from prima.messages import Record
from prima.transcript.colours import NOBODY, of_run
from prima.transcript.criteria import Observer
from prima.transcript.table import describe

NEVER = float("inf")


def base(name: str | None) -> str:
    """An AB's name without the number of its loop."""
    return (name or "").partition(".")[0]


# Trees of Atomic Behaviors --------------------------------------------------------------------


def trees(records: Sequence[Record], until: float = NEVER) -> Graph:
    """The Atomic Behaviors with their parents, one group for each stream.

    Args:
        records: of a transcript.
        until: a time in seconds: what is in working memory when all that happens then is
            done. Without it, all that there was in the run.
    """
    whole = until == NEVER
    before: dict[str, list[str]] = {}
    graph = Graph("Atomic Behaviors of the run" if whole else "", across=False)
    colour = of_run(records)
    state: dict[str, str] = {}
    asked: dict[str, Record] = {}
    began: dict[str, float] = {}
    ended: dict[str, float] = {}
    for record in records:
        if record["time"] > until:
            break
        name = base(record.get("behavior"))
        _follow(record, name, state, asked)
        if record["phase"] == "request" and record.get("before"):
            before.setdefault(base(record["before"]), []).append(name)
        if record["phase"] == "start":
            began.setdefault(name, record["time"])
        ended[name] = record["time"]
    parents = {name: [*_parents(asked[name]), *before.get(name, [])] for name in asked}
    kept = [name for name in asked if whole or state[name] in ("running", "waiting")]
    for name in kept:
        request = asked[name]
        node = graph.node(name, name)
        node.shade = colour.get(request["app"], NOBODY)
        node.group = clean(request.get("tree") or "")
        node.source = clean(request.get("source") or "")
        node.kind = _state(state, name, parents[name])
        span = f"{began[name]:.2f} to {ended[name]:.2f} s" if name in began else "not started"
        node.notes = [_words(request), *([span] if whole else [])]
        node.marks = _marks(request, node)
    for name in kept:
        for parent in parents[name]:
            if parent in graph.nodes:
                graph.edge(parent, name, "child")
        unit = base(asked[name].get("unit"))
        if unit in graph.nodes and not any(one in graph.nodes for one in parents[name]):
            graph.edge(unit, name, "call")
    if not whole:
        graph.title = f"Working memory at {until:.2f} s"
    return graph


def _follow(record: Record, name: str, state: dict[str, str], asked: dict[str, Record]) -> None:
    """Follow the state of an AB through one record."""
    phase, outcome = record["phase"], record.get("outcome")
    if phase == "request":
        asked[name], state[name] = record, "waiting"
    elif name not in asked:
        return
    elif phase == "start":
        state[name] = "running"
    elif phase == "end":
        state[name] = "waiting" if outcome == "again" else "done"
    elif phase == "interrupt":
        state[name] = "waiting"
    elif phase == "cancel":
        state[name] = "cancelled"
    elif phase == "fail":
        state[name] = "failed"


def _state(state: dict[str, str], name: str, parents: list[str]) -> str:
    """How an AB is: one that waits is linked while a parent has not ended."""
    if state[name] != "waiting":
        return state[name]
    held = [state.get(parent) for parent in parents]
    return "linked" if "running" in held or "waiting" in held else "waiting"


def _parents(request: Record) -> list[str]:
    """The ABs after which an AB was requested."""
    found = request.get("parents") or [request.get("parent") or ""]
    return [base(str(name)) for name in found if name]


def _words(request: Record) -> str:
    command = request["command"]
    if command == "iu":
        return "the unit"
    return clean(describe(command, request.get("text"), request.get("args"), request.get("extra")))


def _marks(request: Record, node: Node) -> list[str]:
    marks = {
        node.kind: node.kind != "done",
        "reaction": bool(request.get("reactive")),
        "leaves the user": bool(request.get("leaves")),
        "in loops": bool(request.get("feedback")),
        f"unit {clean(request.get('unit') or '')}": bool(request.get("unit")),
    }
    return [mark for mark, there in marks.items() if there]


# Streams ----------------------------------------------------------------------------------------


@dataclass(slots=True)
class Span:
    """Something of a stream's from ``begin`` to ``end`` (s): it ``runs``, is ``away`` or broken.

    ``kind`` is ``runs``, ``away`` (suspended, and resumed at the end) or ``broken`` (another
    application came in by no reaction). ``by`` is whom that was for.
    """

    begin: float
    end: float
    kind: str
    by: str = ""
    rule: str = ""

    @property
    def words(self) -> str:
        """What it is, in words."""
        by = f" by {self.by}" if self.by else ""
        rule = f" ({self.rule})" if self.rule else ""
        return {"runs": "active", "away": "suspended", "broken": "broken"}[self.kind] + by + rule


@dataclass(slots=True)
class Stream:
    """A Communication Stream: open from ``begin`` to ``end`` (s)."""

    name: str
    app: str
    begin: float
    end: float = -1.0
    ended: bool = False
    spans: list[Span] = field(default_factory=list)


@dataclass(slots=True)
class History:
    """All streams of a run in the order in which they begin; ``end`` in seconds."""

    title: str
    streams: list[Stream]
    end: float
    shades: dict[str, int]


class _Historian:
    """Goes through the records of one run, in order."""

    def __init__(self) -> None:
        self.streams: dict[str, Stream] = {}
        self.of: dict[str, Stream] = {}
        self.running: dict[str, set[str]] = {}
        self.since: dict[str, float] = {}
        self.paused: dict[str, float] = {}
        self.away: dict[str, Span] = {}
        self.last: dict[str, str] = {}
        self.observer = Observer()
        self.now = 0.0

    def add(self, record: Record) -> None:
        self.now = max(self.now, float(record["time"]))
        phase, tree = record["phase"], record.get("tree") or ""
        broken = self.observer.found.broken
        self.observer.add(record)
        name = base(record.get("behavior"))
        if phase == "request" and tree:
            stream = self.streams.setdefault(
                tree, Stream(clean(tree), clean(record["app"]), self.now)
            )
            self.of[name] = stream
        elif phase == "start" and name in self.of:
            if self.observer.found.broken > broken:
                self._break(self.of[name])
            self._start(name)
        elif phase in ("end", "cancel", "fail", "interrupt") and name in self.of:
            self._stop(name)
        elif phase == "suspend" and tree in self.streams:
            by, rule = clean(record.get("by") or ""), clean(record.get("rule") or "")
            self.away[tree] = Span(self.now, self.now, "away", by, rule)
        elif phase in ("resume", "stream-end") and tree in self.streams:
            self._back(tree)
            if phase == "stream-end":
                self.streams[tree].end, self.streams[tree].ended = self.now, True

    def _start(self, name: str) -> None:
        stream = self.of[name]
        running = self.running.setdefault(stream.name, set())
        if not running:
            self.since[stream.name] = self.now
        running.add(name)
        self.last[stream.app] = stream.name
        stream.ended = False

    def _stop(self, name: str) -> None:
        stream = self.of[name]
        running = self.running.get(stream.name, set())
        if name in running:
            running.remove(name)
            if not running:
                self._put(stream, Span(self.since[stream.name], self.now, "runs"))
                self.paused[stream.name] = self.now

    def _put(self, stream: Stream, span: Span) -> None:
        last = stream.spans[-1] if stream.spans else None
        if last and span.kind == last.kind == "runs" and last.end == span.begin:
            last.end = span.end
        elif span.end > span.begin or span.kind == "broken":
            stream.spans.append(span)

    def _back(self, tree: str) -> None:
        span = self.away.pop(tree, None)
        if span is not None:
            span.end = self.now
            self._put(self.streams[tree], span)

    def _break(self, stream: Stream) -> None:
        """It goes on now; another application came in since it last did something."""
        begin = min(self.paused.get(stream.name, self.now), self.observer.broken_since)
        came = [
            other.name
            for other in self.streams.values()
            if other.app != stream.app
            and any(span.begin >= begin for span in other.spans if span.kind == "runs")
        ]
        self._put(stream, Span(begin, self.now, "broken", ", ".join(came[:3])))

    def history(self) -> History:
        for name, stream in self.streams.items():
            if self.running.get(stream.name):
                self._put(stream, Span(self.since[stream.name], self.now, "runs"))
            self._back(name)
            if stream.end < 0 or not stream.ended:
                stream.end = self.now
            stream.spans.sort(key=lambda span: (span.begin, span.kind))
        return History("", list(self.streams.values()), self.now, {})


def streams(records: Sequence[Record]) -> History:
    """The history of all Communication Streams of a run."""
    historian = _Historian()
    for record in records:
        historian.add(record)
    made = historian.history()
    made.title = "Communication Streams of the run"
    made.shades = {clean(app): shade for app, shade in of_run(records).items()}
    return made
