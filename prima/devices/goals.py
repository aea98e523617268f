"""What the conductor tells drivers to do, and what they report."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from prima.messages import Command, Data, Emergency, Heard, Narrated, Occurred, Sensed

SAY: Final = "say"
"""The goal of saying a Command's text."""
LISTEN: Final = "listen"
"""The goal of hearing the answer to a question."""
RECORD: Final = "record"
"""The goal of recording the answer to a question: told by ``Heard`` as it is described there."""


@dataclass(frozen=True, slots=True)
class RecordingBounds:
    """When a recording is over. Times are ms; 0 leaves them to the device."""

    longest: int = 0
    silence: int = 0
    """How long the user has to be silent."""


@dataclass(frozen=True, slots=True)
class Begin:
    """A goal begins. An AB has one for its motion, one for its text, one for its answer.

    A feedback Command is one goal for all of its loops. Times are ms from the run's start.
    """

    key: str
    """Its name, which is never used again."""
    kind: str
    """:data:`SAY`, :data:`LISTEN`, :data:`RECORD`, or the Command's type."""
    command: Command
    """The Command; of a text that was interrupted at a mark, what is left of it (X2)."""
    devices: frozenset[str]
    spoken: int = 0
    """Until when the robot is expected to speak in the same Command; 0 if it does not."""
    tick: int | None = None
    """When the first loop of a feedback Command ends."""
    loop: int = 0
    """How long (ms) each further loop takes."""
    beside: bool = False
    """Whether a motion is composed with another one that goes on (X5)."""
    bounds: RecordingBounds = RecordingBounds()
    """When what is to be recorded is over."""


@dataclass(frozen=True, slots=True)
class Again:
    """A feedback Command makes another loop: its goal goes on. Most drivers need not heed it."""

    key: str


@dataclass(frozen=True, slots=True)
class Cancel:
    """A goal has to end as soon as it can: :class:`Stopped` confirms it."""

    key: str


@dataclass(frozen=True, slots=True)
class Stand:
    """The body has to stop where it rolls on (F5)."""


@dataclass(frozen=True, slots=True)
class Safe:
    """Everything has to stop at once, whatever runs; devices are given up for lost."""

    reason: str


Call = Begin | Again | Cancel | Stand | Safe


@dataclass(frozen=True, slots=True)
class Accepted:
    """A driver has begun a goal."""

    key: str


@dataclass(frozen=True, slots=True)
class Progress:
    """A driver is on with a goal."""

    key: str


@dataclass(frozen=True, slots=True)
class Done:
    """A goal is reached."""

    key: str
    data: Data = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Stopped:
    """A goal has ended because it was cancelled, or was over when that came."""

    key: str
    share: float | None = None
    """How much of it had been done, 0 to 1, if that is known."""
    said: int | None = None
    """Of a text: how many of its characters had been said, if that is known."""


@dataclass(frozen=True, slots=True)
class Broke:
    """A goal is not reached: the device failed or refused it."""

    key: str
    device: str
    reason: str
    lacks: bool = False
    """Of a recording: whether the robot cannot record it, though its devices work."""


@dataclass(frozen=True, slots=True)
class Lost:
    """A driver is gone, and the devices with it."""

    devices: frozenset[str]
    reason: str


@dataclass(frozen=True, slots=True)
class Back:
    """Devices that were lost work again."""

    devices: frozenset[str]


Report = Accepted | Progress | Done | Stopped | Broke | Lost | Back


# What drivers tell besides ----------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class At:
    """Where the robot is: metres, and degrees to the left of the x axis, in the map's frame."""

    x: float
    y: float
    heading: float


@dataclass(frozen=True, slots=True)
class Sees:
    """Whether the camera sees the user; of a user who is seen, m away and degrees to the left."""

    visible: bool
    distance: float | None = None
    angle: float | None = None


@dataclass(frozen=True, slots=True)
class Speaks:
    """The user begins to speak, or has fallen silent.

    A recogniser that tells of the beginning tells of the end as well: by :class:`Heard`, which
    is one, or by this.
    """

    begins: bool


News = At | Sees | Speaks | Heard | Occurred | Sensed | Emergency | Narrated
"""What a driver may tell at any time."""
