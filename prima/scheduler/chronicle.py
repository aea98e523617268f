"""What the mediator records: values in the order in which things were decided."""

from __future__ import annotations

from typing import Final

from prima.messages import Cue, Data, Json, Record
from prima.scheduler.behavior import Behavior, Entry, Stream

LOSERS_NAMED: Final = 8
"""How many losers of a decision are named; all are counted."""


Occurrence = tuple[int, str, str | None, str, dict[str, Json] | None, int]
"""An event that has come in: when, whose, for which application, its name, data and number."""


class Chronicle:
    """Collects the records of a run; ``now`` is the instant, in milliseconds."""

    def __init__(self) -> None:
        self.now = 0
        self.extensions: frozenset[str] = frozenset()
        """Which of X1 to X6 are on: what they rest on is recorded with a request."""
        self.records: list[Record | Occurrence] = []

    def add(self, phase: str, actor: str, **fields: Json) -> None:
        """Record something. Fields that are None are left out when it is written."""
        fields["time"] = self.now
        fields["phase"] = phase
        fields["actor"] = actor
        self.records.append(fields)

    def event(self, name: str, actor: str, app: str | None, data: Data, serial: int) -> None:
        """Record an event that has come in: there are many, so it becomes a record when drained."""
        self.records.append((self.now, actor, app, name, dict(data) if data else None, serial))

    def drain(self) -> list[Record]:
        """Give what was recorded since the last time."""
        records, self.records = self.records, []
        return [one if type(one) is dict else occurred(*one) for one in records]

    def behavior(self, phase: str, ab: Behavior, **fields: Json) -> None:
        """Record what becomes of an AB."""
        record = self._of(ab, phase)
        record.update(fields)
        self.records.append(record)

    def end(self, ab: Behavior, outcome: str, goal: bool, data: Data, inbound: bool) -> None:
        """Record the end of an AB, or of a loop of one."""
        record = self._of(ab, "end")
        record["outcome"] = outcome
        record["inbound"] = inbound or None
        if ab.feedback:
            record["goal"] = goal
        if data:
            record["data"] = dict(data)
        self.records.append(record)

    def start(self, ab: Behavior, rule: str, reaction: int | None) -> None:
        """Record the start of an AB, or of a loop of one."""
        record = self._of(ab, "start")
        record["devices"] = [*ab.in_order]
        record["rule"] = rule
        if ab.feedback:
            record["parent"] = ab.parent
        if reaction is not None:
            record["reactive"] = True
            record["cause"] = reaction if reaction > 0 else None
        if ab.resumed:
            record["resumed"], record["data"] = True, ab.since
        self.records.append(record)

    def hold(self, ab: Behavior, rule: str, by: str) -> None:
        """Record that a waiting AB may not start, and because of what."""
        record: Record = {
            "time": self.now,
            "phase": "hold",
            "actor": "mediator",
            "app": ab.app.name,
            "behavior": ab.id,
            "rule": rule,
            "by": by,
        }
        self.records.append(record)

    def _of(self, ab: Behavior, phase: str) -> Record:
        """What all records of an AB have; most of it stays the same while it lives."""
        if ab.told is None:
            ab.told = described(ab)
        record = ab.told.copy()
        record["time"] = self.now
        record["phase"] = phase
        record["behavior"] = ab.id
        return record

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
            source=(command.source if command else ab.group.source if ab.group else None) or None,
        )

    def stream(self, phase: str, stream: Stream, rule: str, **fields: Json) -> None:
        """Record what becomes of a stream."""
        self.add(phase, "mediator", app=stream.app.name, tree=stream.name, rule=rule, **fields)

    def decision(self, winner: Behavior, rule: str, losers: list[Entry], count: int) -> None:
        """Record a selection: the rule, who won, who lost, and how many did."""
        record: Record = {
            "time": self.now,
            "phase": "decision",
            "actor": "mediator",
            "app": winner.app.name,
            "winner": winner.id,
            "rule": rule,
            "losers": [ab.id for _, ab in losers[:LOSERS_NAMED]],
            "losers_count": count,
        }
        self.records.append(record)


def described(ab: Behavior) -> Record:
    """What the records of an AB have in common, with places for what most of them have."""
    return {
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


def occurred(
    time: int, actor: str, app: str | None, event: str, data: dict[str, Json] | None, serial: int
) -> Record:
    """The record of an event that has come in."""
    return {
        "time": time,
        "phase": "event",
        "actor": actor,
        "app": app,
        "event": event,
        "data": data,
        "serial": serial,
        "inbound": True,
    }


def shown_cues(cues: tuple[Cue, ...]) -> list[dict[str, Json]]:
    """Cues as a record has them: the place in the text, and the value under the kind's name."""
    return [{"at": cue.at, cue.kind: True if cue.value is None else cue.value} for cue in cues]
