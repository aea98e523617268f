"""The Command types of the thesis's Table 4.2 as data: the vocabulary of requests.

This module is pure data. The interpreter's elements, the mediator's rules and the
robot's controllers all read this one table; a robot profile may add rows to a
copy of it (thesis 5.3 (6)).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Literal

from prima.language.values import Value

WRITTEN = {"field": "q-and-a"}
"""The types of Commands that applications write as an element of another name."""
DEVICES = (
    "human-detection",
    "locomotion",
    "localization",
    "speaker",
    "speech-recognition",
    "neck",
    "arm",
)
"""The devices every robot profile may name (Table 4.2); a profile adds its own."""

EFFECTS = frozenset({"position", "direction", "human", "follow", "head"})
"""Where the robot is, its heading on the map, that it faces the human, that it is where the human
went, and how its head is turned."""

ABSENCE_MS = 20_000
"""After how long without being seen, heard or felt the user is absent (rule K1), unless the
profile says otherwise."""
LONGEST_TURN_MS = 600_000
"""How long one utterance, or one question, may keep the speaker without another application (rule E3)."""
LETTER_MS = 50
"""The duration counted per letter: less than it takes, so that only speech too long is refused."""
PATIENCE_MS = 60_000
"""How long an application may keep another from the speaker, by one utterance or question or by
many (rule E6), unless the run says otherwise."""
LATE_MS = 2_000
"""How long after a question's timeout the user may still begin to answer it (rule X10)."""


@dataclass(frozen=True, slots=True)
class Argument:
    """A motion argument: its kind, bounds (in the kind's unit) and meaning."""

    kind: str
    doc: str
    low: float | None = None
    high: float | None = None
    default: Value | None = None
    required: bool = False
    choice: str = ""
    """Arguments sharing a ``choice`` name exclude each other; one of them is needed."""


@dataclass(frozen=True, slots=True)
class CommandType:
    """A row of Table 4.2."""

    name: str
    title: str
    doc: str
    devices: frozenset[str]
    feedback: bool = False
    leaves: bool = False
    engages: bool = False
    text: Literal["none", "optional", "required"] = "none"
    now: bool = False
    arguments: Mapping[str, Argument] = field(default_factory=dict)
    effects: frozenset[str] = frozenset()
    """The effects on which later Commands of a stream rely once it has ended (X1): :data:`EFFECTS`."""
    relative: bool = False
    """Whether its effects depend on where the robot is before it, as an ``angle`` does (X1)."""
    motion: Literal["", "faithful", "free"] = ""
    """Faithful to its own path (a dance), or free in its path (going somewhere) (rule X5)."""
    substitute: str = ""
    """For a Command that the robot lacks: the one that takes its place (rule X6)."""
    extra: frozenset[str] = frozenset()
    """Additional arguments that the robot's maker offers to an FA (Table 4.1)."""
    lasts: int = 0
    """How long (ms) it takes without its speech, or each of its loops; 0 where that varies."""

    @property
    def priority(self) -> int:
        """1 (high) or 0 (low): leaving Commands rank below all others (rule K2)."""
        return 0 if self.leaves else 1

    def occupied(self, text: str | None) -> frozenset[str]:
        """Devices that a Command of this type occupies; speech adds the speaker."""
        return self.devices | {"speaker"} if text else self.devices


def _row(
    name: str,
    title: str,
    devices: str,
    doc: str,
    *,
    marks: str = "",
    effects: str = "",
    text: Literal["none", "optional", "required"] = "none",
    lasts: int = 0,
    **arguments: Argument,
) -> CommandType:
    return CommandType(
        name=name,
        title=title,
        doc=doc,
        devices=frozenset(devices.split()),
        feedback="feedback" in marks,
        leaves="leaves" in marks,
        engages="engages" in marks,
        now="now" in marks,
        effects=frozenset(effects.split()),
        relative="relative" in marks,
        motion="free" if "leaves" in marks else "",
        text=text,
        lasts=lasts,
        arguments={key.rstrip("_").replace("_", "-"): value for key, value in arguments.items()},
    )


_TOWARD = Argument("id", "a place or thing of the world's map", choice="direction")
_X = Argument("number", "metres east on the world's map", -1000, 1000, required=True)
_Y = Argument("number", "metres north on the world's map", -1000, 1000, required=True)
_HEADING = Argument("number", "degrees counter-clockwise from east", -360, 360)
_ANGLE = Argument("number", "degrees to turn, counter-clockwise positive", -360, 360)
_DRIVE = "locomotion localization"


TABLE_4_2: Mapping[str, CommandType] = MappingProxyType(
    {
        row.name: row
        for row in (
            _row(
                "active-sensing-human",
                "Active Sensing Human",
                "human-detection locomotion localization",
                "Stands still until the camera recognises the human; when patience has run out"
                " it turns the camera's angle and tries again. Says its text when it starts and"
                " when it resumes.",
                marks="feedback engages",
                effects="human",
                text="optional",
                patience=Argument(
                    "duration", "how long to look before turning", 1000, 600000, default=10000
                ),
            ),
            _row(
                "face-human",
                "Face Human",
                "human-detection locomotion",
                "Turns the body to face the human.",
                marks="engages",
                effects="human",
            ),
            _row(
                "q-and-a",
                "Q&A",
                "speaker speech-recognition",
                "Asks, then listens for the answer: one Atomic Behavior. Written as a field.",
                marks="engages",
                text="optional",
                timeout=Argument(
                    "duration", "how long to wait for an answer", 0, 600000, default=5000
                ),
                bargein=Argument(
                    "boolean", "whether the user may answer before the question ends", default=True
                ),
            ),
            _row(
                "tracking-human",
                "Tracking Human",
                "human-detection locomotion",
                "Follows the human at a distance until something else happens.",
                marks="feedback engages",
                effects="human follow",
                distance=Argument("number", "metres to keep", 0.3, 5, default=1.0),
            ),
            _row(
                "face-human-and-speak",
                "Face Human and Speak",
                "human-detection locomotion speaker",
                "Turns to face the human and says its text.",
                marks="engages",
                effects="human",
                text="required",
            ),
            _row(
                "turn-and-speak",
                "Turn and Speak",
                "locomotion localization speaker",
                "Turns by an angle or toward a place and says its text.",
                effects="direction",
                text="required",
                angle=replace(_ANGLE, choice="direction"),
                toward=_TOWARD,
            ),
            _row(
                "set-direction",
                "Set Direction",
                _DRIVE,
                "Turns to a heading of the map or toward a place.",
                effects="direction",
                heading=replace(_HEADING, choice="direction"),
                toward=_TOWARD,
            ),
            _row(
                "turn",
                "Turn",
                "locomotion",
                "Turns the body by an angle.",
                effects="direction",
                angle=replace(_ANGLE, required=True),
            ),
            _row(
                "set-speed-and-time",
                "Set Speed and Time",
                "locomotion",
                "Drives at a speed for a time.",
                marks="relative",
                effects="position direction",
                speed=Argument("number", "metres a second, backward negative", -2, 2, default=0.0),
                turn_speed=Argument("number", "degrees a second", -180, 180, default=0.0),
                time=Argument("duration", "for how long", 1, 60000, required=True),
            ),
            _row(
                "stop-moving",
                "Stop Moving",
                "locomotion",
                "Stops the body; it is requested now by nature and cancels what the same"
                " application's streams wanted of the same devices.",
                marks="now",
                lasts=200,
            ),
            _row("speak", "Speak", "speaker", "Says its text.", text="required"),
            _row(
                "pause",
                "Pause",
                "",
                "Does nothing for a while; what follows it waits.",
                time=Argument("duration", "for how long", 1, 60000, required=True),
            ),
            _row(
                "move-head",
                "Move Head",
                "neck",
                "Moves the head.",
                effects="head",
                pan=Argument("number", "degrees to the left", -180, 180, default=0.0),
                tilt=Argument("number", "degrees upward", -90, 90, default=0.0),
            ),
            _row(
                "point-by-hand",
                "Point by Hand",
                "arm",
                "Points with the hand, toward a place or at an angle to the body.",
                lasts=1000,
                angle=Argument(
                    "number", "degrees from the body's front", -180, 180, choice="direction"
                ),
                toward=_TOWARD,
            ),
            _row(
                "gesture",
                "Gesture",
                "arm neck",
                "Plays a gesture that the robot knows by name.",
                name_=Argument("id", "the gesture's name in the robot profile", required=True),
            ),
            _row(
                "topological-move",
                "Topological Move",
                _DRIVE,
                "Goes to a place along the ways of the world's map.",
                marks="feedback leaves",
                effects="position",
                to=Argument("id", "a place of the world's map", required=True),
            ),
            _row(
                "set-position",
                "Set Position",
                _DRIVE,
                "Goes to a position of the map.",
                marks="feedback leaves",
                effects="position",
                x=_X,
                y=_Y,
            ),
            _row(
                "set-position-and-direction",
                "Set Position and Direction",
                _DRIVE,
                "Goes to a position of the map and turns to a heading there.",
                marks="feedback leaves",
                effects="position direction",
                x=_X,
                y=_Y,
                heading=replace(_HEADING, required=True),
            ),
        )
    }
)
"""The 17 Command types of the thesis by name, and Pause, which needs no device."""


def too_long(letters: int, silence: float, most: int = LONGEST_TURN_MS) -> str:
    """Why an utterance or question of so many letters and ms of silence is too long.

    Args:
        letters: of its text.
        silence: its pauses, and a question's timeout (ms).
        most: how long it may last (ms).

    Returns:
        The problem; empty if there is none.
    """
    lasts = letters * LETTER_MS + silence
    if lasts <= most:
        return ""
    beside = "" if most == LONGEST_TURN_MS else " beside another application (E6)"
    shown = f"{lasts / 1000:.0f}" if lasts >= most + 1000 else f"{lasts / 1000:g}"
    return f"It keeps the speaker for at least {shown} s; {most / 1000:g} s are the most{beside}."
