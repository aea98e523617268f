"""Working memory, trees and floor, rebuilt from the records."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence

from prima.digraphs import led_to
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

SECONDS = 60
"""How long an application may keep another from the speaker by default (E6)."""


def in_ms(records: Iterable[Record]) -> list[Record]:
    """Records with times in ms; transcripts, which begin with ``run``, use seconds."""
    made = list(records)
    if not made or made[0]["phase"] != "run":
        return made
    return [{**record, "time": ms(record["time"])} for record in made]


class Memory:
    """The state so far, which the rules read and change."""

    def __init__(
        self,
        records: Iterable[Record],
        policy: str,
        declared: Sequence[str] = (),
        calling: Collection[str] = (),
        patience: int | None = None,
    ) -> None:
        self.calling = calling
        """Applications whose states may follow ones that were not left."""
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
        self.lapsed: list[tuple[str, int]] = [("", 0)]
        """The application whose question was the latest to time out, and when (X10): one, or more
        that it may be, as records do not show whether an application still hears of an end."""
        self.late_app = ""
        """The application whose question the user has just answered too late (X10)."""
        self.speech: int | None = None
        """The number and time of the user's latest utterance."""
        self.speech_at = -1
        self.answered_tree: Tree | None = None
        """A stream with a question that was answered since the latest selection (X7)."""
        self.turn: AB | None = None
        """The asker's response to an answer, until it starts (X7)."""
        self.trees: dict[str, Tree] = {}
        self.floor: list[Tree] = []
        self.turned: list[tuple[str, str, str]] = []
        """Streams that took the floor or gave it back since the last comparison, with the rules."""
        self.told_turns: list[tuple[str, str, str]] = []
        self.windows: list[Tree] = []
        """Open windows, the latest last."""
        self.latest: dict[str, AB] = {}
        """The latest request of each application outside units (O1)."""
        self.halted = False
        self.in_view = False
        """Whether the camera sees the user (V4)."""
        self.sensed_at = 0
        """When the user was last seen, heard or felt (K1)."""
        self.now = 0
        """The time (ms)."""
        self.place = 0
        self.left: set[tuple[str, int | None]] = set()
        """Applications, with the states that they have left (O3)."""
        self.asked: dict[str, set[int]] = {}
        """The states of each application that have made requests."""
        self.refused: set[str] = set()
        """Applications with a refused request, whose state is unknown (E3)."""
        self.requests: dict[str, Record] = {}
        """The request of each AB."""
        self.serials: dict[int, int] = {}
        """The numbers of events, with their times."""
        self.numbered = any(one.get("serial") is not None for one in self.records)
        """Whether events are recorded: some drivers request Commands without any."""
        self.turns: dict[str, list[int]] = defaultdict(list)
        """When streams began to wait suspended, or resumed: their applications may be notified."""
        self.recorded_floor: list[str] = []
        """The floor according to ``floor`` records."""
        self.extra_reactions = 0
        self.lacking: set[str] = set()
        self.faced: set[str] = set()
        """ABs for which the robot turns to the user (X4)."""
        self.robot: tuple[float, float] | None = None
        """Where the robot is, as reported by its devices."""
        self._begin_waits(patience)
        self._read_ahead()
        self.new_instant()

    def _begin_waits(self, patience: int | None) -> None:
        """Prepare for counting how long ABs wait (E6)."""
        head = self.records[0].get("data") or {} if self.records else {}
        self.patience = ms(head.get("patience", SECONDS)) if patience is None else patience
        """The bound (ms); 0 if there is none."""
        self.kept: dict[str, int] = {}
        """How long (ms) others have kept waiting ABs from the speaker."""
        self.kept_now: set[str] = set()
        """The ABs that are kept from it at present."""
        self.starving: set[str] = set()
        """The ABs that have been reported to starve."""
        self.answered: dict[str, int] = {}
        """When the user last answered a question of each stream."""

    def _read_ahead(self) -> None:
        """Note what only later records show."""
        self.begins: dict[tuple[int, str], int] = {}
        """When streams begin to be held, with the index of the record."""
        self.groups: set[str] = set()
        """Units whose Commands are given beforehand (U4); others span questions (U5)."""
        self.nested: set[str] = set()
        """Units inside units: their contents are requested by no application, when they start."""
        for place, record in enumerate(self.records):
            match record["phase"]:
                case "held" if record["outcome"] == "begun":
                    self.begins[record["time"], record["tree"]] = place
                case "start" if record.get("rule") == "U4" and record.get("unit"):
                    self.groups.add(record["unit"])
                case "request" if record["command"] == "iu" and record.get("unit"):
                    self.nested.add(record["behavior"])

    def new_instant(self) -> None:
        """Forget what concerns one instant alone."""
        self.cuts: list[Cut] = []
        self.urgent: list[tuple[AB, int]] = []
        """Commands with ``now`` of this instant, and their indices (O2)."""
        self.failed: list[AB] = []
        self.unloaded: set[str] = set()
        self.taken_out: set[str] = set()
        """Applications removed from the robot in this instant, whose end is not recorded yet."""
        self.released = False
        self.started_leaving: list[tuple[str, set[AB]]] = []
        self.started_inside: list[AB] = []
        self.tree_devices: dict[str, frozenset[str]] = {}
        self.gave_way: list[tuple[AB, AB, int]] = []
        """X2: interrupted ABs, with the reaction and the record's index."""
        self.suspensions: dict[str, str] = {}
        """The ``suspend`` records since the latest start: streams, and what suspended them."""
        self.suspended_by: dict[str, str] = {}
        """The same as recomputed."""
        self.resumptions: dict[str, str] = {}
        """The ``resume`` records: streams, and the AB that resumed them."""
        self.decision: Record | None = None
        """The latest decision, until its winner starts."""
        self.halting: dict[str, AB] = {}
        """Feedback Commands that move and whose loop ended or was cut in this instant."""
        self.stops: set[str] = set()
        """The ABs that ``stop`` records have named in this instant (F5)."""
        self.driven = False
        """Whether an AB that takes the locomotion has started in this instant."""
        self.ended_trees: set[str] = set()
        self.told_ends: set[str] = set()
        """Streams that ended in this instant, and those that did so by a record (C1)."""
        self.resumed: list[Tree] = []
        self.left_now: set[tuple[str, int | None]] = set()
        self.continuing: dict[str, Tree] = {}
        """The stream that an application continues after leaving a state (O3)."""
        self.let_go: list[tuple[Tree, int | None]] = []
        """Streams no longer held because a state was left, and which state (X3)."""
        self.heard: Counter[str] = Counter()
        """The number of each stream's ends with a notice, but without a window so far (C3)."""
        self.owed: Counter[str] = Counter()
        """The same for ends that certainly have a notice."""

    def report(self, number: int, rule: str, text: str) -> None:
        """Note a violation of an invariant, with the rule behind it."""
        self.found.append(f"invariant {number} ({rule}) at {self.now / 1000:.3f} s: {text}")

    def wait(self, ab: AB) -> None:
        """An AB waits from now on; records of its earlier waits do not count."""
        self.running.pop(ab.name, None)
        ab.phase, ab.said = WAITING, None
        self.waiting[ab.name] = ab
        self.join_first(ab)

    def join_first(self, ab: AB) -> None:
        """X1, X9: ABs of a stream wait for the inserted one, except those with ``now`` (O2)."""
        ways = ab.tree.put_first()
        if ways and not (ab.inserted or ab.begins_now or ab.unit or self.third_turn(ab)):
            ab.parents |= {way.name for way in ways}
            ab.phase, ab.joined_at = LINKED, self.now
            self.waiting.pop(ab.name)

    def third_turn(self, ab: AB) -> bool:
        """X7: whether it is the asker's response to an answer, or comes before it."""
        return self.turn is not None and ab in self.way_to(self.turn)

    def way_to(self, ab: AB) -> set[AB]:
        """An AB and all that has to end before it may start."""
        return led_to([ab], lambda one: map(self.abs.__getitem__, one.parents))

    def go_without(self, ab: AB) -> None:
        """X7: what answers the user does not wait for what was inserted for its stream before."""
        if ab.phase == LINKED and ab.joined_at == self.now:
            ab.parents -= {way.name for way in ab.tree.put_first()}
            ab.phase, ab.joined_at = WAITING, -1
            self.waiting[ab.name] = ab

    def remove(self, ab: AB, ended: bool = True) -> None:
        """An AB leaves working memory; ABs that waited only for its end may start (S2c)."""
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
        """O3: whether the state that requested it was left."""
        return (ab.app, ab.state) in self.left

    def is_given_up(self, ab: AB) -> bool:
        """O3, E2: whether it is no longer wanted: its state was left, or its application ended."""
        return self.has_left(ab) or ab.app in self.gone_apps

    def in_group(self, ab: AB) -> bool:
        """Whether it is part of a running unit, which finishes as a whole (U4)."""
        unit = ab.unit
        return unit is not None and unit.name in self.groups and unit.phase == RUNNING

    def running_one(self, record: Record, what: str) -> AB | None:
        """The running AB that a record is about; a violation if it is not running."""
        ab = self.abs.get(base(record["behavior"]))
        if ab is None or ab.phase != RUNNING or ab.shown != record["behavior"]:
            phase = ab.phase if ab is not None else "unknown"
            self.report(3, "U1", f"{record['behavior']} {what}, but it is {phase}")
            return None
        return ab

    def composes(self, ab: AB, other: AB) -> bool:
        """X5: a free motion carries a faithful one, so both may use the same devices."""
        return "x5" in self.extensions and {ab.motion, other.motion} == COMPOSED

    def occupants(self, ab: AB) -> Iterator[AB]:
        """S1, U5: the running ABs, outside of its own unit, that have one of its devices."""
        for other in self.running.values():
            apart = not (other is ab or ab.inside(other) or other.inside(ab))
            if apart and ab.devices & other.devices and not self.composes(ab, other):
                yield other

    @property
    def holder(self) -> Tree | None:
        """The stream that has the floor."""
        return self.floor[-1] if self.floor else None
