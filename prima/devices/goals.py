"""The calls from the conductor to drivers, and the drivers' reports."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from prima.messages import Command, Data, Emergency, Heard, Narrated, Occurred, Sensed

SAY: Final = "say"
"""The goal of saying a Command's text."""
LISTEN: Final = "listen"
"""The goal of hearing the answer to a question."""
RECORD: Final = "record"
"""The goal of recording the answer to a question; ``Heard`` reports it, as described there."""


@dataclass(frozen=True, slots=True)
class RecordingBounds:
    """When a recording ends. Times are ms; 0 leaves them to the device."""

    longest: int = 0
    silence: int = 0
    """How long the user has to be silent for it to end."""


@dataclass(frozen=True, slots=True)
class Begin:
    """A goal begins. An AB has one for its motion, one for its text, one for its answer.

    A feedback Command is one goal for all of its loops. Times are ms from the run's start.
    """

    key: str
    """Its name, which is never reused."""
    kind: str
    """:data:`SAY`, :data:`LISTEN`, :data:`RECORD`, or the Command's type."""
    command: Command
    """The Command; for a text that was interrupted at a mark, with the rest of the text (X2)."""
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
    """When the recording ends."""

    @property
    def device(self) -> str:
        """The device to which a failure of the goal as a whole is attributed."""
        return min(self.devices, default="none")


@dataclass(frozen=True, slots=True)
class Again:
    """A feedback Command makes another loop: its goal goes on. Most drivers can ignore this."""

    key: str


@dataclass(frozen=True, slots=True)
class Cancel:
    """A goal has to end as soon as it can: :class:`Stopped` confirms it."""

    key: str


@dataclass(frozen=True, slots=True)
class Stand:
    """The body has to stop if it is still rolling (F5)."""


@dataclass(frozen=True, slots=True)
class Safe:
    """Everything has to stop at once; the devices are considered lost."""


Call = Begin | Again | Cancel | Stand | Safe


@dataclass(frozen=True, slots=True)
class Accepted:
    """A driver has begun a goal."""

    key: str


@dataclass(frozen=True, slots=True)
class Progress:
    """A driver is still working at a goal."""

    key: str


@dataclass(frozen=True, slots=True)
class Done:
    """A goal has been reached."""

    key: str
    data: Data = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Stopped:
    """A goal has ended because it was cancelled, or was already over by then."""

    key: str
    share: float | None = None
    """How much of it had been done, 0 to 1, if known."""
    said: int | None = None
    """For a text: how many of its characters had been said, if known."""


@dataclass(frozen=True, slots=True)
class Broke:
    """A goal was not reached: the device failed or refused it."""

    key: str
    device: str
    reason: str
    lacks: bool = False
    """For a recording: whether the robot is unable to record though its devices work."""


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


# Other reports of drivers -----------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class At:
    """Where the robot is: metres, and degrees to the left of the x axis, in the map's frame."""

    x: float
    y: float
    heading: float

    @property
    def where(self) -> dict[str, float]:
        """The pose as reported: to the mm, and to a tenth of a degree."""
        heading = round(self.heading, 1) % 360.0
        return {"x": round(self.x, 3), "y": round(self.y, 3), "heading": heading}


@dataclass(frozen=True, slots=True)
class Sees:
    """Whether the camera sees the user and, if so, their distance (m) and degrees to the left."""

    visible: bool
    distance: float | None = None
    angle: float | None = None

    @property
    def where(self) -> Data:
        """Where the user is, as far as known."""
        values = {"distance": self.distance, "angle": self.angle} if self.visible else {}
        return {name: value for name, value in values.items() if value is not None}


@dataclass(frozen=True, slots=True)
class Speaks:
    """The user begins to speak, or has fallen silent.

    A recogniser that reports the beginning also reports the end: by :class:`Heard`, which
    implies one, or by this.
    """

    begins: bool


News = At | Sees | Speaks | Heard | Occurred | Sensed | Emergency | Narrated
"""Reports that a driver may make at any time."""
