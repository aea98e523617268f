"""The state that a stream's next behaviours rely on, derived from its Commands (rule X1)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from prima.language.commands import CommandType
from prima.messages import Command, Data

FAR = 0.5
"""The robot goes back if it is farther (m) than this from where it was."""
TURNED = 15.0
"""The robot, or its head, turns back if it is turned away by more degrees than this."""

Pose = tuple[float, float, float]
"""Metres east and north on the map, degrees counter-clockwise from east."""
Head = tuple[float, float]
"""Pan and tilt in degrees."""


def sets(row: CommandType | None, command: Command | None) -> frozenset[str]:
    """The effects of a Command that do not depend on the robot's state before it (X1)."""
    if row is None or command is None or row.relative or "angle" in command.args:
        return frozenset()
    return row.effects


@dataclass(slots=True)
class RobotState:
    """The robot's state as its devices last reported it."""

    pose: Pose | None = None
    head: Head = (0.0, 0.0)

    def moved(self, row: CommandType, command: Command, data: Data) -> None:
        """Update the state from what a Command reports at its end."""
        pose = pose_of(data)
        if pose is not None:
            self.pose = pose
        if "head" in row.effects:
            self.head = head_of(command)


@dataclass(slots=True)
class Effects:
    """The effects of a stream's Commands: the robot's place, direction and head angles."""

    position: tuple[float, float] | None = None
    heading: float | None = None
    human: bool = False
    """Whether the robot was turned to the human."""
    head: Head | None = None
    body: RobotState = field(default_factory=RobotState)
    """The robot's state once it had turned to them."""

    def add(self, row: CommandType, command: Command, data: Data, body: RobotState) -> None:
        """Take in that a Command of the stream, or one loop of it, has ended."""
        pose, effects = pose_of(data), row.effects
        if "position" in effects and pose is not None:
            self.position, self.heading, self.human = pose[:2], None, False
        if "follow" in effects:
            self.position = None
        if "direction" in effects and pose is not None:
            self.heading, self.human = pose[2], False
        if "human" in effects:
            self.heading, self.human, self.body = None, True, replace(body)
        if "head" in effects:
            self.head = head_of(command)

    def forget(self, effects: frozenset[str]) -> None:
        """Take in that a Command with some effects was cut short: what it has changed is unknown."""
        if "follow" in effects:
            return  # each of its loops has been taken in
        if "position" in effects:
            self.position = None
        if {"position", "direction", "human"} & effects:
            self.heading, self.human = None, False
        if "head" in effects:
            self.head = None

    def missing(self, own: frozenset[str], body: RobotState) -> list[Command]:
        """The Commands that restore the state that a Command with the effects ``own`` needs."""
        made = [] if {"position", "follow"} & own else self._missing_pose(own, body)
        if "head" not in own and self.head is not None and _apart(self.head, body.head):
            made.append(Command("move-head", {"pan": self.head[0], "tilt": self.head[1]}))
        return made

    def _missing_pose(self, own: frozenset[str], body: RobotState) -> list[Command]:
        """The way back and the turns that a Command needs which goes nowhere by itself."""
        turns = not {"direction", "human"} & own
        made = self._missing_place(turns, body.pose)
        away = bool(made) and made[0].type != "set-direction"
        if turns and self.human and (away or self._turned_since(body)):
            made.append(Command("face-human"))
        return made

    def _missing_place(self, turns: bool, pose: Pose | None) -> list[Command]:
        """The way back if the robot is elsewhere, else the turn if it looks elsewhere."""
        where, heading = self.position, self.heading if turns else None
        if pose is None:
            return []
        if where is not None and _far(where, pose[:2]):
            return [_go(where, heading)]
        if heading is not None and _turned(heading, pose[2]):
            return [Command("set-direction", {"heading": _rounded(heading, 1)})]
        return []

    def _turned_since(self, body: RobotState) -> bool:
        before, now = self.body.pose, body.pose
        if before is None or now is None:
            return False
        return _far(before[:2], now[:2]) or _turned(before[2], now[2])


def _rounded(number: float, digits: int) -> float:
    """A number as it is written: never -0.0."""
    return round(number, digits) + 0.0


def _go(position: tuple[float, float], heading: float | None) -> Command:
    args: dict[str, float] = {"x": _rounded(position[0], 3), "y": _rounded(position[1], 3)}
    if heading is None:
        return Command("set-position", args)
    return Command("set-position-and-direction", {**args, "heading": _rounded(heading, 1)})


def _far(place: tuple[float, float], other: tuple[float, float]) -> bool:
    return math.dist(place, other) > FAR


def _turned(heading: float, other: float) -> bool:
    return abs(difference(heading, other)) > TURNED


def _apart(head: Head, other: Head) -> bool:
    return max(abs(head[0] - other[0]), abs(head[1] - other[1])) > TURNED


def difference(angle: float, other: float) -> float:
    """The difference from ``other`` to ``angle``, between -180 and 180 degrees."""
    return (angle - other + 180.0) % 360.0 - 180.0


def pose_of(data: Data) -> Pose | None:
    """The pose that a device reports at a Command's end, if any."""
    values = [data.get(name) for name in ("x", "y", "heading")]
    known = [one for one in values if isinstance(one, int | float) and math.isfinite(one)]
    return (float(known[0]), float(known[1]), float(known[2])) if len(known) == 3 else None


def head_of(command: Command) -> Head:
    """How a Move Head turns the head."""
    pan, tilt = command.args.get("pan"), command.args.get("tilt")
    return (
        float(pan) if isinstance(pan, int | float) else 0.0,
        float(tilt) if isinstance(tilt, int | float) else 0.0,
    )
