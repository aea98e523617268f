"""Working memory, trees and floor, built again from what the records say has happened."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Sequence

from prima.invariants.model import (
    AB,
    COMPOSED,
    EXTENSIONS,
    GONE,
    LINKED,
    RUNNING,
    WAITING,
    Cut,
    Record,
    Tree,
    base,
    ms,
)


def in_ms(records: Iterable[Record]) -> list[Record]:
    """Records with times in ms; transcripts, which begin with ``run``, have them in seconds."""
    made = list(records)
    if not made or made[0]["phase"] != "run":
        return made
    return [{**record, "time": ms(record["time"])} for record in made]


class Memory:
    """What is known so far. The families of rules, which read it, stand on top of it."""

    def __init__(
        self,
        records: Iterable[Record],
        policy: str,
        declared: Sequence[str] = (),
        calling: Collection[str] = (),
    ) -> None:
        self.calling = calling
        """Applications whose states may follow others that were not left."""
        self.records = in_ms(records)
        name, *extensions = policy.split("+")
        self.policy, _, self.first = name.partition(":")
        self.prima = self.policy == "prima"
        self.extensions = EXTENSIONS if "all" in extensions else frozenset(extensions)
        if not declared and self.records and self.records[0]["phase"] == "run":
            declared = (self.records[0].get("data") or {}).get("applications", ())
        self.found: list[str] = []
        self.apps: dict[str, int] = {app: number for number, app in enumerate(declared)}
        """The order in which the applications were declared (S2f)."""
        self.gone_apps: set[str] = set()
        self.loaded: set[str] = set()
        self.abs: dict[str, AB] = {}
        self.waiting: dict[str, AB] = {}
        self.running: dict[str, AB] = {}
        self.lapsed: tuple[str, int] | None = None
        """Whose question was not answered in time last, and when (X10)."""
        self.late_app = ""
        """Who has asked what the user has just answered too late (X10)."""
        self.speech: int | None = None
        """The number of what the user said last, and when that was."""
        self.speech_at = -1
        self.answered_tree: Tree | None = None
        """A stream with a question that was answered since the latest selection (X7)."""
        self.turn: AB | None = None
        """What the asker says to an answer, while it has not started (X7)."""
        self.trees: dict[str, Tree] = {}
        self.floor: list[Tree] = []
        self.turned: list[tuple[str, str, str]] = []
        """Which streams took the floor or gave it back since it was last compared, and by what."""
        self.told_turns: list[tuple[str, str, str]] = []
        self.windows: list[Tree] = []
        """Open windows, the latest last."""
        self.latest: dict[str, AB] = {}
        """What each application has requested last, outside units (O1)."""
        self.halted = False
        self.in_view = False
        """Whether the camera sees the user (V4)."""
        self.sensed_at = 0
        """When the user was last seen, heard or felt (K1)."""
        self.now = 0
        """The time (ms)."""
        self.place = 0
        self.left: set[tuple[str, int | None]] = set()
        """Applications, and states of theirs that they have left (O3)."""
        self.asked: dict[str, set[int]] = {}
        """The states of each application that have asked for something."""
        self.refused: set[str] = set()
        """Applications of which something was refused, so that its state is not known (E3)."""
        self.requests: dict[str, Record] = {}
        """The request of each AB."""
        self.serials: dict[int, int] = {}
        """The numbers of events, and when those happened."""
        self.numbered = any(one.get("serial") is not None for one in self.records)
        """Whether events are recorded: some drivers ask for Commands without any."""
        self.turns: dict[str, int] = {}
        """When streams came to wait suspended, or went on: their applications may hear of it."""
        self.told_floor: list[str] = []
        """The floor according to ``floor`` records."""
        self.extra_reactions = 0
        self.lacking: set[str] = set()
        self.seen: set[str] = set()
        """ABs that have waited while the camera saw the user: X4 may be done with them."""
        self.faced: set[str] = set()
        """ABs for which the robot turns to the user (X4)."""
        self.robot: tuple[float, float] | None = None
        """Where the robot stands, as its devices have told."""
        self._read_ahead()
        self._new_instant()

    def _read_ahead(self) -> None:
        """Note where each name occurs last, which only later records show."""
        self.last: dict[str, int] = {}
        self.unit_ends: dict[str, int] = {}
        self.begins: dict[tuple[int, str], int] = {}
        """When streams begin to be held, and the index of the record that says so."""
        self.groups: set[str] = set()
        """Units whose Commands are given beforehand (U4): others span questions (U5)."""
        self.nested: set[str] = set()
        """Units inside units: what is in them is requested when they start, and by nobody."""
        for place, record in enumerate(self.records):
            if record.get("behavior") and record["phase"] != "halted":
                self.last[base(record["behavior"])] = place
            match record["phase"]:
                case "end" if record["command"] == "iu":
                    self.unit_ends[record["behavior"]] = record["time"]
                case "held" if record["outcome"] == "begun":
                    self.begins[record["time"], record["tree"]] = place
                case "start" if record["rule"] == "U4":
                    self.groups.add(record["unit"])
                case "request" if record["command"] == "iu" and record.get("unit"):
                    self.nested.add(record["behavior"])

    def _new_instant(self) -> None:
        self.cuts: list[Cut] = []
        self.urgent: list[tuple[AB, int]] = []
        """Commands wanted now in this instant, and their places (O2)."""
        self.failed: list[AB] = []
        self.unloaded: set[str] = set()
        self.taken_out: set[str] = set()
        """Applications that are taken out of the robot in this instant, and whose end is untold."""
        self.released = False
        self.started_leaving: list[tuple[str, set[AB]]] = []
        self.started_inside: list[AB] = []
        self.tree_devices: dict[str, frozenset[str]] = {}
        self.gave_way: list[tuple[AB, AB, int]] = []
        """X2: what was interrupted, for which reaction, and where the record is."""
        self.suspensions: dict[str, str] = {}
        """What ``suspend`` records have said since the latest start: streams, and by whom."""
        self.suspended_by: dict[str, str] = {}
        """The same as recomputed."""
        self.resumptions: dict[str, str] = {}
        """Streams of which ``resume`` records have told, and by which AB."""
        self.decision: Record | None = None
        """The latest decision, until its winner starts."""
        self.halting: dict[str, AB] = {}
        """Feedback Commands that move and whose loop has ended or was cut in this instant."""
        self.stops: set[str] = set()
        """Whom ``stop`` records have named in this instant (F5)."""
        self.driven = False
        """Whether something that takes the locomotion has started in this instant."""
        self.ended_trees: set[str] = set()
        self.told_ends: set[str] = set()
        """Streams that ended in this instant, and those that a record says did (C1)."""
        self.resumed: list[Tree] = []
        self.left_now: set[tuple[str, int | None]] = set()
        self.continuing: dict[str, Tree] = {}
        """The stream that an application goes on with, as it has left a state (O3)."""
        self.let_go: list[tuple[Tree, int | None]] = []
        """Streams held no longer as a state was left, and which (X3)."""
        self.heard: Counter[str] = Counter()
        """How many ends of each stream its application hears of, and has no window for yet (C3)."""
        self.owed: Counter[str] = Counter()
        """The same of ends that it hears of for certain."""

    def report(self, number: int, rule: str, text: str) -> None:
        """Note a violation of an invariant, with the rule behind it."""
        self.found.append(f"invariant {number} ({rule}) at {self.now / 1000:.3f} s: {text}")

    def wait(self, ab: AB) -> None:
        """An AB waits from here on; what was said of an earlier wait of it says nothing."""
        self.running.pop(ab.name, None)
        ab.phase, ab.said = WAITING, None
        self.waiting[ab.name] = ab
        self.join_first(ab)

    def join_first(self, ab: AB) -> None:
        """X1, X9: what waits in a stream waits for what is put first, but what is wanted now (O2)."""
        ways = ab.tree.put_first()
        if ways and not (ab.inserted or ab.urgent or ab.unit):
            ab.parents |= {way.name for way in ways}
            ab.phase = LINKED
            self.waiting.pop(ab.name)

    def remove(self, ab: AB, ended: bool = True) -> None:
        """An AB leaves working memory; what waited for its end alone may start (S2c)."""
        ab.phase = GONE
        self.waiting.pop(ab.name, None)
        self.running.pop(ab.name, None)
        ab.tree.members.pop(ab.name, None)
        for other in list(ab.tree.members.values()):
            if ab.name not in other.parents:
                continue
            other.parents.discard(ab.name)
            if not other.parents and other.phase == LINKED:
                other.followed_at = self.now if ended else -1
                other.freed_at = self.now
                self.wait(other)

    def has_left(self, ab: AB) -> bool:
        """O3: whether the state that has asked for it was left."""
        return (ab.app, ab.state) in self.left

    def is_given_up(self, ab: AB) -> bool:
        """O3, E2: whether nobody wants it any more: its state was left, or its application ended."""
        return self.has_left(ab) or ab.app in self.gone_apps

    def in_group(self, ab: AB) -> bool:
        """Whether it is part of a unit that runs, and finishes whole (U4)."""
        unit = ab.unit
        return unit is not None and unit.name in self.groups and unit.phase == RUNNING

    def running_one(self, record: Record, what: str) -> AB | None:
        """The running AB that a record is about; a violation if it does not run."""
        ab = self.abs.get(base(record["behavior"]))
        if ab is None or ab.phase != RUNNING or ab.shown != record["behavior"]:
            phase = ab.phase if ab is not None else "unknown"
            self.report(3, "U1", f"{record['behavior']} {what}, but it is {phase}")
            return None
        return ab

    def composes(self, ab: AB, other: AB) -> bool:
        """X5: a free motion carries a faithful one; both may use the same devices then."""
        return "x5" in self.extensions and {ab.motion, other.motion} == COMPOSED

    def occupant(self, ab: AB) -> AB | None:
        """S1, U5: a running AB, outside of its own unit, that has one of its devices."""
        for other in self.running.values():
            if other is ab or not ab.devices & other.devices:
                continue
            if not ab.inside(other) and not other.inside(ab) and not self.composes(ab, other):
                return other
        return None

    @property
    def holder(self) -> Tree | None:
        """The stream that has the floor."""
        return self.floor[-1] if self.floor else None
