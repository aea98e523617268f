"""How Reachy Mini carries out Commands that the robot's document need not describe."""

from __future__ import annotations

from collections.abc import Callable

from prima.devices.goals import Begin
from prima.language.commands import TABLE_4_2
from prima.live.driver import Refused
from prima.live.drivers.reachy.pose import HeadPose, wrapped

OUT = 90.0
"""Where an antenna is that lies flat (degrees)."""

Step = dict[str, float]


def number(goal: Begin, name: str) -> float:
    """An argument of a Command; 0 if it is missing."""
    value = goal.command.args.get(name)
    return float(value) if isinstance(value, int | float) else 0.0


def _head(goal: Begin, at: HeadPose, direction: float | None) -> list[Step]:
    return [{"pan": number(goal, "pan"), "tilt": number(goal, "tilt")}]


def _turn(goal: Begin, at: HeadPose, direction: float | None) -> list[Step]:
    return [{"turn": number(goal, "angle")}]


def _drive(goal: Begin, at: HeadPose, direction: float | None) -> list[Step]:
    if number(goal, "speed"):
        raise Refused("Reachy Mini has no wheels; it only turns.")
    seconds = number(goal, "time") / 1000
    return [{"turn": number(goal, "turn-speed") * seconds, "time": seconds}]


def _point(goal: Begin, at: HeadPose, direction: float | None) -> list[Step]:
    """Lay out the antenna of that side for a while: it cannot point more exactly."""
    angle = number(goal, "angle") if direction is None else wrapped(direction - at.body)
    side = "left" if angle >= 0 else "right"
    out, back = {side: OUT, "time": 0.5}, {side: getattr(HeadPose(), side), "time": 0.5}
    return [out, {"time": TABLE_4_2["point-by-hand"].lasts / 1000}, back]


WAYS: dict[str, Callable[[Begin, HeadPose, float | None], list[Step]]] = {
    "move-head": _head,
    "turn": _turn,
    "set-speed-and-time": _drive,
    "point-by-hand": _point,
}
"""The movements of each Command that the robot's document need not describe, from the pose of
the parts and the Command's direction."""
