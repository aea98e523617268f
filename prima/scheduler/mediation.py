"""What the rules of mediation share: working memory, the policy, and what is still to be told.

Each rule is a function of its own in one of the modules beside, and is given this.
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
class Told:
    """Notices for one application, to be handled in the window of ``stream`` if any (C3)."""

    app: str
    stream: Stream | None
    notices: list[Notice]


@dataclass(slots=True)
class HaltedUnit:
    """A unit that was interrupted and whose device has still to tell how much was done (X2)."""

    unit: Behavior
    finished: list[Command]
    """What of it had been done to its end."""
    count: int
    """Of how many Commands it is."""


@dataclass(slots=True)
class Mediation:
    """One mediation. Times are ms from the run's start.

    Args:
        policy: what decides.
        table: the robot's Commands.
        recorder: takes the records; its ``now`` is the instant.
        bound: after how many loops of another a waiting AB counts as a reaction (E4).
        absence: after how long (ms) without being sensed the user is absent (K1).
        patience: how long (ms) others may keep an AB from the speaker (E6); 0 for ever.
    """

    policy: Policy
    table: Mapping[str, CommandType]
    recorder: Recorder
    bound: int | None = None
    absence: int = ABSENCE_MS
    patience: int = PATIENCE_MS
    memory: WorkingMemory = field(default_factory=WorkingMemory)
    changed: bool = False
    """Whether anything has happened since the latest selection that it may depend on."""
    halted: bool = False
    """Whether the emergency stop is pressed (E5)."""
    orders: list[Order] = field(default_factory=list)
    """For the devices."""
    told: deque[Told] = field(default_factory=deque)
    """For the applications."""
    turns: list[tuple[str, Stream]] = field(default_factory=list)
    """Streams that wait ``suspended`` or have ``resumed``, for their applications to hear (C2)."""
    touched: dict[str, Stream] = field(default_factory=dict)
    """Streams that may have ended (C1)."""
    continuing: list[Application] = field(default_factory=list)
    """Applications one of whose streams stays open for this instant (O3)."""
    holds: dict[str, int] = field(default_factory=dict)
    """Until when streams are held (X3)."""
    rolling: Behavior | None = None
    """A Command that leaves the body moving when it gets no next loop (F5)."""
    started: list[Behavior] = field(default_factory=list)
    """What the latest selection started."""
    resumed: list[Stream] = field(default_factory=list)
    """Streams that it let go on (C2)."""
    suspensions: int = 0
    """How often streams were suspended, as a counter (S2d)."""
    starved: int = 0
    """How many ABs count as reactions because they waited too long (E4)."""
    starving: int | None = None
    """When the next AB will have waited for too long (ms, E6)."""
    robot: RobotState = field(default_factory=RobotState)
    """The robot's state as its devices have told it last (X1)."""
    halted_units: dict[str, HaltedUnit] = field(default_factory=dict)
    """By the part of them whose device has still to tell how much was done (X2)."""
    maker: Maker = field(init=False)

    def __post_init__(self) -> None:
        self.maker = Maker(self.table)

    @property
    def now(self) -> int:
        """The instant."""
        return self.recorder.now

    @property
    def shared(self) -> bool:
        """Whether an application must leave the speaker to others after a time (E6)."""
        others = sum(not app.gone for app in self.memory.apps.values()) > 1
        return others and self.patience > 0 and self.policy.floor

    @property
    def longest_turn(self) -> int:
        """How long (ms) one utterance or question may keep the speaker (E3, E6)."""
        return min(self.patience, LONGEST_TURN_MS) if self.shared else LONGEST_TURN_MS

    def has(self, extension: str) -> bool:
        """Whether an extension is on."""
        return self.policy.has(extension)

    def tell(self, app: Application, stream: Stream | None, *notices: Notice) -> None:
        """Tell an application what became of its Commands."""
        self.told.append(Told(app.name, stream, list(notices)))

    def order(self, verb: Verb, ab: Behavior) -> None:
        """Tell the devices to stop an AB in some way."""
        self.orders.append(Order(verb, ab.id, ab.command, app=ab.app.name))

    def touch(self, stream: Stream) -> None:
        """Something has left or entered a stream: it may be over (C1)."""
        self.touched[stream.name] = stream
