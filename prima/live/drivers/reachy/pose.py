"""Where the parts of Reachy Mini are: in PRIMA's units, and in its daemon's."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

from prima.errors import one_of
from prima.live.driver import Refused

LIMITS = {
    "body": (160.0, "locomotion"),
    "pan": (65.0, "neck"),
    "tilt": (40.0, "neck"),
    "roll": (40.0, "neck"),
    "lift": (25.0, "neck"),
    "left": (180.0, "arm"),
    "right": (180.0, "arm"),
}
"""How far each part moves to either side, and the device to which it belongs."""
FARTHEST = 175.0
"""How far (degrees) body and neck together turn the head: the daemon goes round by the front."""
NEAR = 10.0
"""How far (degrees, mm) a part may be from its target: motors give way under load."""


@dataclass(frozen=True, slots=True)
class HeadPose:
    """Degrees, but for ``lift``.

    Body and ``pan`` are positive to the left, ``tilt`` upward, ``roll`` to the robot's right;
    antennas are at 0 upright, and positive outward.
    """

    body: float = 0.0
    pan: float = 0.0
    """The head against the body."""
    tilt: float = 0.0
    roll: float = 0.0
    lift: float = 0.0
    """How much (mm) the head is raised."""
    left: float = 10.0
    right: float = 10.0

    def moved(self, step: Mapping[str, float]) -> HeadPose:
        """This pose with some parts elsewhere: where a step sends them, or ``turn`` farther.

        Raises:
            Refused: a part cannot move that far.
        """
        parts = {name: value for name, value in step.items() if name in LIMITS}
        if "turn" in step:
            parts["body"] = self.body + step["turn"]
        if "body" in parts:
            parts["body"] = wrapped(parts["body"])
        for name, value in parts.items():
            most, device = LIMITS[name]
            if abs(value) > most:
                unit = "mm" if name == "lift" else "degrees"
                message = (
                    f"Reachy Mini's {name} goes to {most:g} {unit} either way, not to {value:g}."
                )
                raise Refused(message, device)
        pose = replace(self, **parts)
        looks = pose.body + pose.pan
        if abs(looks) > FARTHEST:
            message = (
                f"Body and neck would turn the head to {looks:g} degrees; it turns to {FARTHEST:g}."
            )
            raise Refused(message, "locomotion" if "body" in parts else "neck")
        return pose

    def off(self, other: HeadPose) -> dict[str, float]:
        """The distance of each part from its place in another pose."""
        mine, others = asdict(self), asdict(other)
        return {name: abs(wrapped(mine[name] - others[name])) for name in mine}

    def near(self, other: HeadPose) -> bool:
        """Whether all parts are roughly where they are in another pose."""
        return max(self.off(other).values()) <= NEAR

    def goto(self, seconds: float) -> dict[str, Any]:
        """What the daemon is asked, to be here after a time."""
        angles = {"roll": self.roll, "pitch": -self.tilt, "yaw": self.body + self.pan}
        radians = {name: math.radians(value) for name, value in angles.items()}
        return {
            "head_pose": {"x": 0.0, "y": 0.0, "z": self.lift / 1000, **radians},
            "antennas": [math.radians(-self.right), math.radians(self.left)],
            "body_yaw": math.radians(self.body),
            "duration": round(seconds, 3),
        }


def read_pose(state: Mapping[str, Any]) -> HeadPose:
    """The pose in a full state of the daemon.

    Raises:
        Refused: the state lacks something.
    """
    try:
        head, (right, left) = state["head_pose"], state["antennas_position"]
        body = math.degrees(state["body_yaw"])
        return HeadPose(
            body,
            pan=wrapped(math.degrees(head["yaw"]) - body),
            tilt=-math.degrees(head["pitch"]),
            roll=math.degrees(head["roll"]),
            lift=head["z"] * 1000,
            left=math.degrees(left),
            right=-math.degrees(right),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise Refused("Reachy Mini does not tell where its parts are.") from error


def wrapped(angle: float) -> float:
    """An angle within 180 degrees to either side."""
    return angle if abs(angle) <= 180 else (angle + 180) % 360 - 180


KNOWN = (*LIMITS, "turn", "time")


def read_step(name: str, written: object) -> dict[str, float]:
    """A step of a movement in the robot's document: parts with their targets, and its time (s).

    Raises:
        Refused: it is not a step.
    """
    if not isinstance(written, Mapping):
        raise Refused(f'The step "{name}" of the robot\'s document moves nothing.')
    step: dict[str, float] = {}
    for part, value in written.items():
        if part not in KNOWN:
            raise Refused(f'Reachy Mini has no "{part}" to move; write one of {one_of(KNOWN)}.')
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not math.isfinite(value)
        ):
            raise Refused(f'The {part} of the step "{name}" is not a number: {value!r}.')
        step[part] = float(value)
    if not 0.0 < step.get("time", 1.0) <= 60.0:
        raise Refused(f'The time of the step "{name}" is not between 0 and 60 s.')
    return step
