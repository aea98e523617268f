"""What the mediator records: values in the order in which things were decided."""

from __future__ import annotations

from typing import Any, Final

from prima.messages import Cue, Data, Json, Record, line_of
from prima.scheduler.behavior import Behavior, Stream

LOSERS_NAMED: Final = 8
"""How many losers of a decision are named; all are counted."""


Kept = tuple[Any, ...]
"""What will be a record: its phase, the instant, and what :func:`recorded` makes of the rest. Most
records are kept so, as a tuple costs next to nothing, until they are drained."""


class Chronicle:
    """Collects the records of a run; ``now`` is the instant, in milliseconds."""

    def __init__(self) -> None:
        self.now = 0
        self.extensions: frozenset[str] = frozenset()
        """Which of X1 to X6 are on: what they rest on is recorded with a request."""
        self.records: list[Record | Kept] = []

    def add(self, phase: str, actor: str, **fields: Json) -> None:
        """Record something. Fields that are None are left out when it is written."""
        fields["time"] = self.now
        fields["phase"] = phase
        fields["actor"] = actor
        self.records.append(fields)

    def event(self, name: str, actor: str, app: str | None, data: Data, serial: int) -> None:
        """Record an event that has come in."""
        held = dict(data) if data else None
        self.records.append(("event", self.now, actor, app, name, held, serial))

    def drain(self) -> list[Record]:
        """Give what was recorded since the last time."""
        records, self.records = self.records, []
        return [one if isinstance(one, dict) else recorded(one) for one in records]

    def behavior(self, phase: str, ab: Behavior, **fields: Json) -> None:
        """Record what becomes of an AB."""
        record = of_behavior(phase, self.now, ab.told or describe(ab), ab.id)
        record.update(fields)
        self.records.append(record)

    def end(self, ab: Behavior, outcome: str, goal: bool, data: Data, inbound: bool) -> None:
        """Record the end of an AB, or of a loop of one."""
        told, held = ab.told or describe(ab), dict(data) if data else None
        reached = goal if ab.feedback else None
        self.records.append(("end", self.now, told, ab.id, outcome, reached, held, inbound or None))

    def start(self, ab: Behavior, rule: str, reaction: int | None) -> None:
        """Record the start of an AB, or of a loop of one."""
        told, since = ab.told or describe(ab), (True, ab.since) if ab.resumed else None
        parent = ab.parent if ab.feedback else None
        self.records.append(
            ("start", self.now, told, ab.id, ab.in_order, rule, parent, reaction, since)
        )

    def hold(self, ab: Behavior, rule: str, by: str) -> None:
        """Record that a waiting AB may not start, and because of what."""
        self.records.append(("hold", self.now, ab.app.name, ab.id, rule, by))

    def request(self, ab: Behavior, before: str | None = None) -> None:
        """Record a request with all that the rules ask of an AB; ``before`` what it was put in."""
        command = ab.command
        self.behavior(
            "request",
            ab,
            args=(command.args or None) if command else None,
            extra=(command.extra or None) if command else None,
            cues=shown_cues(command.cues) if command and command.cues else None,
            parent=ab.parent,
            parents=sorted(ab.waits_for) if len(ab.waits_for) > 1 else None,
            devices=[*ab.in_order],
            priority="high" if ab.priority else "low",
            reactive=ab.reaction is not None,
            cause=ab.reaction,
            feedback=ab.feedback or None,
            leaves=ab.leaves or None,
            engages=ab.engages or None,
            order="now" if command and command.now else None,
            state=ab.document_state,
            inserted=ab.inserted or None,
            before=before,
            restartable=ab.restartable or None if "x2" in self.extensions else None,
            hold=ab.stream.hold / 1000 if ab.stream.hold and "x3" in self.extensions else None,
            connect=ab.connect or None if "x4" in self.extensions else None,
            motion=ab.motion or None if "x5" in self.extensions else None,
            source=line_of(command.source if command else ab.group.source if ab.group else ""),
        )

    def stream(self, phase: str, stream: Stream, rule: str, **fields: Json) -> None:
        """Record what becomes of a stream."""
        self.add(phase, "mediator", app=stream.app.name, tree=stream.name, rule=rule, **fields)

    def decision(self, winner: Behavior, rule: str, losers: list[str]) -> None:
        """Record a selection: the rule, who won, who lost, and how many did."""
        named, count = losers[:LOSERS_NAMED], len(losers)
        self.records.append(("decision", self.now, winner.app.name, winner.id, rule, named, count))


def describe(ab: Behavior) -> Record:
    """Note what the records of an AB have in common, with places for what most of them have."""
    ab.told = {
        "time": 0,
        "phase": "",
        "actor": "robot",
        "app": ab.app.name,
        "behavior": "",
        "tree": ab.stream.name,
        "command": ab.type.name if ab.type else "iu",
        "text": ab.command.text if ab.command else None,
        "unit": ab.unit.id if ab.unit else None,
        "rule": None,
        "devices": None,
        "outcome": None,
        "inbound": None,
    }
    return ab.told


HOLD: Final[Record] = {
    "time": 0,
    "phase": "hold",
    "actor": "mediator",
    "app": "",
    "behavior": "",
    "rule": "",
    "by": "",
}
DECISION: Final[Record] = {
    "time": 0,
    "phase": "decision",
    "actor": "mediator",
    "app": "",
    "winner": "",
    "rule": "",
    "losers": None,
    "losers_count": 0,
}


def of_behavior(phase: str, time: int, told: Record, behavior: str) -> Record:
    """What all records of an AB have; ``told`` is :func:`describe`'s."""
    record = told.copy()
    record["time"] = time
    record["phase"] = phase
    record["behavior"] = behavior
    return record


def recorded(kept: Kept) -> Record:
    """Make a record of what was kept."""
    phase: str = kept[0]
    if phase == "end":
        _, time, told, behavior, outcome, goal, data, inbound = kept
        record = of_behavior(phase, time, told, behavior)
        record["outcome"] = outcome
        record["inbound"] = inbound
        if goal is not None:
            record["goal"] = goal
        if data is not None:
            record["data"] = data
    elif phase == "start":
        _, time, told, behavior, devices, rule, parent, reaction, since = kept
        record = of_behavior(phase, time, told, behavior)
        record["devices"] = [*devices]
        record["rule"] = rule
        if parent is not None:
            record["parent"] = parent
        if reaction is not None:
            record["reactive"] = True
            record["cause"] = reaction if reaction > 0 else None
        if since is not None:
            record["resumed"], record["data"] = since
    elif phase == "decision":
        record = DECISION.copy()
        (
            _,
            record["time"],
            record["app"],
            record["winner"],
            record["rule"],
            record["losers"],
            record["losers_count"],
        ) = kept
    elif phase == "hold":
        record = HOLD.copy()
        _, record["time"], record["app"], record["behavior"], record["rule"], record["by"] = kept
    else:
        _, time, actor, app, event, data, serial = kept
        record = {
            "time": time,
            "phase": phase,
            "actor": actor,
            "app": app,
            "event": event,
            "data": data,
            "serial": serial,
            "inbound": True,
        }
    return record


def shown_cues(cues: tuple[Cue, ...]) -> list[dict[str, Json]]:
    """Cues as a record has them: the place in the text, and the value under the kind's name."""
    return [{"at": cue.at, cue.kind: True if cue.value is None else cue.value} for cue in cues]
