"""State shared by the mediation rules: working memory, the policy, and pending orders and notices.

Each rule is a separate function in a neighbouring module and takes this state as an argument.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field

from prima.language.commands import ABSENCE_MS, LONGEST_TURN_MS, PATIENCE_MS, CommandType
from prima.messages import Command, Notice, Order, Verb
from prima.scheduler.admission import Maker
from prima.scheduler.behavior import Application, Behavior, Stream
from prima.scheduler.memory import WorkingMemory
from prima.scheduler.policy import Policy
from prima.scheduler.recorder import Recorder
from prima.scheduler.robot_state import RobotState


@dataclass(slots=True)
class Delivery:
    """Notices for one application, to be handled in the window of ``stream`` if any (C3)."""

    app: str
    stream: Stream | None
    notices: list[Notice]


@dataclass(slots=True)
class HaltedUnit:
    """An interrupted unit whose device has yet to report how much was done (X2)."""

    unit: Behavior
    finished: list[Command]
    """Its Commands that had been completed."""
    count: int
    """The number of its Commands."""


@dataclass(slots=True)
class Mediation:
    """One mediation. Times are ms from the run's start.

    Args:
        policy: the policy that decides.
        table: the robot's Commands.
        recorder: collects the records; its ``now`` is the current instant.
        bound: the number of another's loops after which a waiting AB counts as a reaction (E4).
        absence: how long (ms) the user has to go unsensed to count as absent (K1).
        patience: how long (ms) others may keep an AB from the speaker (E6); 0 for no limit.
    """

    policy: Policy
    table: Mapping[str, CommandType]
    recorder: Recorder
    bound: int | None = None
    absence: int = ABSENCE_MS
    patience: int = PATIENCE_MS
    memory: WorkingMemory = field(default_factory=WorkingMemory)
    changed: bool = False
    """Whether anything that may affect selection has happened since the latest one."""
    halted: bool = False
    """Whether the emergency stop is pressed (E5)."""
    orders: list[Order] = field(default_factory=list)
    """For the devices."""
    deliveries: deque[Delivery] = field(default_factory=deque)
    """For the applications."""
    turns: list[tuple[str, Stream]] = field(default_factory=list)
    """Streams that wait ``suspended`` or have ``resumed``, to notify their applications (C2)."""
    touched: dict[str, Stream] = field(default_factory=dict)
    """Streams that may have ended (C1)."""
    continuing: list[Application] = field(default_factory=list)
    """Applications with a stream that stays open for this instant (O3)."""
    holds: dict[str, int] = field(default_factory=dict)
    """Until when streams are held (X3)."""
    rolling: Behavior | None = None
    """A Command that leaves the body moving unless another loop follows (F5)."""
    started: list[Behavior] = field(default_factory=list)
    """The ABs that the latest selection started."""
    resumed: list[Stream] = field(default_factory=list)
    """The streams that it resumed (C2)."""
    coming: set[str] = field(default_factory=set)
    """The applications that this instant has yet to load (E6)."""
    suspensions: int = 0
    """How often streams were suspended, as a counter (S2d)."""
    starved: int = 0
    """How many ABs count as reactions because they waited too long (E4)."""
    starving: int | None = None
    """When the next AB will starve (ms, E6)."""
    robot: RobotState = field(default_factory=RobotState)
    """The robot's state as its devices last reported it (X1)."""
    halted_units: dict[str, HaltedUnit] = field(default_factory=dict)
    """By the part whose device has yet to report how much was done (X2)."""
    maker: Maker = field(init=False)

    def __post_init__(self) -> None:
        self.maker = Maker(self.table, "x5" in self.policy.extensions)

    @property
    def now(self) -> int:
        """The instant."""
        return self.recorder.now

    @property
    def shared(self) -> bool:
        """Whether applications must leave the speaker to others after a time (E6)."""
        there = sum(not app.gone for app in self.memory.apps.values()) + len(self.coming)
        return there > 1 and self.patience > 0 and self.policy.floor

    @property
    def longest_turn(self) -> int:
        """How long (ms) one utterance or question may keep the speaker (E3, E6)."""
        return min(self.patience, LONGEST_TURN_MS) if self.shared else LONGEST_TURN_MS

    def tell(self, app: Application, stream: Stream | None, *notices: Notice) -> None:
        """Notify an application of what became of its Commands."""
        self.deliveries.append(Delivery(app.name, stream, list(notices)))

    def order(self, verb: Verb, ab: Behavior) -> None:
        """Tell the devices to stop an AB in some way."""
        self.orders.append(Order(verb, ab.id, ab.command, app=ab.app.name))

    def touch(self, stream: Stream) -> None:
        """Note that something has left or entered a stream, which may be over (C1)."""
        self.touched[stream.name] = stream
