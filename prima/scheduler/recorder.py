"""The mediator's records, in the order of its decisions."""

from __future__ import annotations

from typing import Final

from prima.messages import Cue, Data, Json, Record, line_of
from prima.scheduler.behavior import Behavior, Stream

LOSERS_NAMED: Final = 8
"""The maximum number of losers that a decision names; all are counted."""


class Recorder:
    """Collects the records of a run; ``now`` is the current instant in milliseconds."""

    def __init__(self) -> None:
        self.now = 0
        self.extensions: frozenset[str] = frozenset()
        """The extensions that are on: requests record the values they depend on."""
        self.records: list[Record] = []

    def add(self, phase: str, actor: str, **fields: Json) -> None:
        """Add a record. Fields that are None are omitted when it is written."""
        self.records.append({"time": self.now, "phase": phase, "actor": actor, **fields})

    def drain(self) -> list[Record]:
        """Return the records made since the last call."""
        records, self.records = self.records, []
        return records

    def behavior(self, phase: str, ab: Behavior, **fields: Json) -> None:
        """Record what becomes of an AB."""
        self.add(
            phase,
            "robot",
            app=ab.app.name,
            behavior=ab.id,
            tree=ab.stream.name,
            command=ab.type.name if ab.type else "iu",
            text=ab.command.text if ab.command else None,
            unit=ab.unit.id if ab.unit else None,
            **fields,
        )

    def end(self, ab: Behavior, outcome: str, goal: bool, data: Data, inbound: bool) -> None:
        """Record the end of an AB, or of a loop of one."""
        fields: Record = {"outcome": outcome}
        if inbound:
            fields["inbound"] = True
        if ab.feedback:
            fields["goal"] = goal
        if data:
            fields["data"] = dict(data)
        self.behavior("end", ab, **fields)

    def start(self, ab: Behavior, rule: str, reaction: int | None) -> None:
        """Record the start of an AB, or of a loop of one."""
        fields: Record = {"devices": ab.in_order, "rule": rule}
        fields["parent"] = ab.parent if ab.feedback else None
        if reaction is not None:
            fields["reactive"] = True
            fields["cause"] = reaction if reaction > 0 else None
        if ab.resumed:
            fields["resumed"], fields["data"] = True, ab.since
        self.behavior("start", ab, **fields)

    def hold(self, ab: Behavior, rule: str, by: str) -> None:
        """Record that a waiting AB may not start, and why."""
        self.add("hold", "mediator", app=ab.app.name, behavior=ab.id, rule=rule, by=by)

    def request(self, ab: Behavior, before: str | None = None) -> None:
        """Record a request with all that the rules use of an AB; ``before`` is what it precedes."""
        self.behavior(
            "request",
            ab,
            parent=ab.parent,
            parents=sorted(ab.waits_for) if len(ab.waits_for) > 1 else None,
            devices=ab.in_order,
            priority="high" if ab.priority else "low",
            reactive=ab.reaction is not None,
            cause=ab.reaction,
            feedback=ab.feedback or None,
            leaves=ab.leaves or None,
            engages=ab.engages or None,
            state=ab.document_state,
            inserted=ab.inserted or None,
            before=before,
            **_asked_by_author(ab),
            **self._asked_by_extensions(ab),
        )

    def _asked_by_extensions(self, ab: Behavior) -> Record:
        """The values of an AB that the enabled extensions use (X2 to X5, X7 to X9)."""
        marks: dict[str, tuple[str, Json]] = {
            "x2": ("restartable", ab.restartable or None),
            "x3": ("hold", ab.stream.hold / 1000 if ab.stream.hold else None),
            "x4": ("connect", ab.connect or None),
            "x5": ("motion", ab.motion or None),
            "x7": ("spans", ab.spans or None),
        }
        found: Record = {
            name: value for on, (name, value) in marks.items() if on in self.extensions
        }
        if ab.stale is not None:
            found["fresh"] = (ab.stale - self.now) / 1000
        if ab.stream.words is not None:
            found["words"] = ab.stream.words.text
        return found

    def stream(self, phase: str, stream: Stream, rule: str, **fields: Json) -> None:
        """Record what becomes of a stream."""
        self.add(phase, "mediator", app=stream.app.name, tree=stream.name, rule=rule, **fields)

    def decision(self, winner: Behavior, rule: str, losers: list[str]) -> None:
        """Record a selection: the rule, the winner, the losers and their number."""
        self.add(
            "decision",
            "mediator",
            app=winner.app.name,
            winner=winner.id,
            rule=rule,
            losers=losers[:LOSERS_NAMED],
            losers_count=len(losers),
        )


def shown_cues(cues: tuple[Cue, ...]) -> list[dict[str, Json]]:
    """Cues as in a record: the place in the text, and the value under the kind's name."""
    return [{"at": cue.at, cue.kind: True if cue.value is None else cue.value} for cue in cues]


def _asked_by_author(ab: Behavior) -> Record:
    """The request behind an AB: the arguments of its Command, and its line."""
    fields: Record = {"source": line_of(ab.what.source)}
    if (command := ab.command) is not None:
        fields["args"], fields["extra"] = command.args or None, command.extra or None
        fields["cues"] = shown_cues(command.cues) if command.cues else None
    if ab.what.now and not ab.in_group:  # otherwise its unit is
        fields["order"] = "now"
    return fields
