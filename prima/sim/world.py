"""The physical world: bodies, walls, visibility. Only this module uses pymunk."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, degrees, dist, inf, pi, radians, sin

import pymunk

from prima.devices.goals import At
from prima.devices.profile import Profile
from prima.scheduler.robot_state import difference
from prima.sim.map import EPSILON, Corner, Map
from prima.sim.plan import Point, crosses, off_line

STEP_MS = 50
"""The longest step of physics."""
WALLS = pymunk.ShapeFilter(mask=0b10)
ROOM = 0.1
"""How much room (m) the robot leaves beside its body if it can choose."""
WALL = 0.05
"""Half the thickness (m) of walls."""
THICK = 0.7
"""The share of the body's radius that must be free of walls on both sides of its way."""
STANDING = (0.0, 0.0)
"""The wheels' speeds of a robot that does not move."""
FAR = 3.0
"""The radius (m) around the robot within which walls are considered."""


def bearing(a: Point, b: Point) -> float:
    """The direction from one point to another, in degrees."""
    return degrees(atan2(b[1] - a[1], b[0] - a[0]))


def room_beside(profile: Profile) -> float:
    """How far (m) a robot must be from a wall beside it not to be blocked by it."""
    return profile.radius * THICK + WALL


@dataclass(slots=True)
class Somebody:
    """A person in the world: their position (m; None if they have left) and destination."""

    at: Point | None
    goal: Point | None = None
    speed: float = 1.0
    """Metres a second."""


class World:
    """Bodies that move in virtual time, in milliseconds; steps only while something moves."""

    def __init__(self, plan: Map, profile: Profile, at: Point, heading: float) -> None:
        self.map = plan
        self.profile = profile
        self.time = 0
        self._space = pymunk.Space()
        for start, end in plan.walls:
            wall = pymunk.Segment(self._space.static_body, start, end, WALL)
            wall.filter = pymunk.ShapeFilter(categories=0b10)
            self._space.add(wall)
        self._body = pymunk.Body(10.0, pymunk.moment_for_circle(10.0, 0, profile.radius))
        shape = pymunk.Circle(self._body, profile.radius)
        shape.filter = pymunk.ShapeFilter(categories=0b01)
        self._space.add(self._body, shape)
        self.travelled = 0.0
        """How far (m) the robot has moved, on whatever way."""
        self._free: tuple[Point, float] = (at, -1.0)
        """A place, and how far (m) around it there is no wall."""
        self._free_until = -1.0
        """How far it will have travelled when it may be out of there."""
        self._visible: bool | None = None
        """The camera's view from here, as computed; None if anybody has moved since."""
        self.blind = False
        """Whether its camera recognises nobody: the device ``human-detection`` is broken."""
        self.position = at
        """Where the robot is (m)."""
        self.turn_body(radians(heading))
        self.drive = STANDING
        """The wheels' speeds: metres a second forward, degrees a second to the left."""
        self.pan = 0.0
        """Where the head points, from the front (degrees)."""
        self.people: dict[str, Somebody] = {}
        """The people present, by name."""
        self._user: Somebody | None = None
        """The person to whom the robot attends; of several, nobody until it has seen one."""
        self._inside: set[str] = {one.id for one in plan.corners if self._beyond(one) <= 0.0}
        self._corner_at = 0.0
        """How far the robot will have travelled when it may be near or away from a corner."""

    def turn_body(self, angle: float) -> None:
        """Note the direction (radians) of the body; physics is updated only when needed."""
        self._angle = angle
        self.heading = degrees(angle) % 360.0
        """Where the robot's front points (degrees)."""

    # The robot -----------------------------------------------------------------

    def pose(self) -> dict[str, float]:
        """The robot's pose, rounded to mm and tenths of a degree."""
        return At(*self.position, self.heading).where

    def turn_head(self, pan: float) -> None:
        """Turn the head (degrees from the front)."""
        self.pan, self._visible = pan, None

    # People --------------------------------------------------------------------

    def put(self, name: str, at: Point | None) -> None:
        """Add a person; if they are the only one, the robot attends to them from the start."""
        somebody = self.people[name] = Somebody(at)
        self._attend(somebody if len(self.people) == 1 else None)

    @property
    def person(self) -> Point | None:
        """The position (m) of the person to whom the robot attends."""
        return self._user.at if self._user is not None else None

    def attend(self, name: str) -> None:
        """Attend to a person who has spoken or touched the robot."""
        if self.people[name].at is not None:
            self._attend(self.people[name])

    def _attend(self, somebody: Somebody | None) -> None:
        self._user, self._visible = somebody, None

    def walk(self, name: str, to: Point | None, speed: float) -> None:
        """Send a person somewhere in a straight line; with None they stay."""
        somebody = self.people[name]
        somebody.goal, somebody.speed = to, speed

    def leave(self, name: str) -> None:
        """Let a person leave: the robot attends to the next of the others whom it sees."""
        somebody = self.people[name]
        somebody.at = somebody.goal = None
        away = somebody is self._user and len(self.people) > 1
        self._attend(None if away else self._user)

    def people_within(self, reach: float) -> list[Point]:
        """The positions of people within a distance (m), nearest to the robot first."""
        here = self.position
        near = [
            one.at
            for one in self.people.values()
            if one.at is not None and dist(here, one.at) <= reach
        ]
        if len(near) > 1:
            near.sort(key=lambda at: dist(here, at))
        return near

    # Seeing --------------------------------------------------------------------

    def clear(self, a: Point, b: Point) -> bool:
        """Whether no wall is between two points; a line that begins in a wall may leave it."""
        at, free = self._free
        if dist(at, a) < free and dist(at, b) < free:
            return True
        found = self._space.segment_query_first(a, b, 0.0, WALLS)
        if found is not None and found.alpha == 0.0:
            return not any(crosses((a, b), wall) for wall in self.map.walls)
        return found is None

    def passable(self, a: Point, b: Point) -> bool:
        """Whether the robot's body, and a little more, fits through in a straight line.

        If it starts closer to a wall than that, it must not get any closer.
        """
        wide = self.profile.radius + ROOM
        if not self.clear(a, b):
            return False
        for c, d in self.map.walls:
            start = off_line(a, c, d)
            if min(start, wide) - EPSILON > min(
                off_line(c, a, b), off_line(d, a, b), off_line(b, c, d)
            ):
                return False
        return True

    def beside_walls(self, heading: float) -> float:
        """The direction (degrees) closest to another that does not lead the body into a wall."""
        reach = self.profile.radius + ROOM
        if not self._wall_within(reach):
            return heading
        near = self._space.point_query_nearest(self.position, reach, WALLS)
        if near is None:
            return heading
        wall = bearing(self.position, (near.point.x, near.point.y))
        aside = difference(heading, wall)
        if abs(aside) >= 90.0:
            return heading
        away = 90.0 if near.distance > self.profile.radius else 120.0
        return wall + (away if aside >= 0 else -away)

    def sees_person(self) -> bool:
        """Whether the person attended to is in the camera's view, close enough and not hidden.

        If it attends to nobody, it begins to attend to the nearest person it sees. Visibility is
        recomputed only if somebody has moved or turned. A blind robot sees nobody.
        """
        if self.blind:
            return False
        if self._visible is None:
            if self._user is None and len(self.people) > 1:
                self.find_somebody()
            self._visible = self._user is not None and self._look(self._user.at)
        return self._visible

    def find_somebody(self) -> bool:
        """Whether the robot sees anybody; it attends to the nearest, unless it sees its own."""
        if self._look(self.person):
            return True
        seen = [
            (dist(self.position, one.at), name)
            for name, one in self.people.items()
            if one.at is not None and self._look(one.at)
        ]
        if seen:
            self._attend(self.people[min(seen)[1]])
        return bool(seen)

    def _look(self, person: Point | None) -> bool:
        position = self.position
        if person is None or dist(position, person) > self.profile.camera_range:
            return False
        off = difference(bearing(position, person), self.heading + self.pan)
        return abs(off) <= self.profile.camera_angle / 2 and self.clear(position, person)

    # Time ----------------------------------------------------------------------

    def moves(self) -> bool:
        """Whether anybody moves, so that a physics step is needed."""
        if self.drive != STANDING:
            return True
        return any(one.goal is not None for one in self.people.values())

    def advance(self, to: int) -> None:
        """Let time pass until ``to`` (ms)."""
        while (left := to - self.time) > 0 and self.moves():
            step = left if left < STEP_MS else STEP_MS
            self.time += step
            self._visible = None
            if self.drive != STANDING:
                self._move(step / 1000)
            for somebody in self.people.values():
                if somebody.goal is not None and somebody.at is not None:
                    self._step_person(somebody, somebody.at, somebody.goal, step / 1000)
        self.time = to

    def _move(self, seconds: float) -> None:
        """Move the body; physics is used only if it may touch a wall."""
        forward, turning = self.drive[0], radians(self.drive[1])
        near = self._wall_within(self.profile.radius + abs(forward) * seconds + 0.05)
        if near and forward and self._wall_ahead(forward, seconds):
            forward = 0.0
        along, across = forward * cos(self._angle), forward * sin(self._angle)
        if near:
            body = self._body
            body.position, body.angle = self.position, self._angle
            # Each step sets both anew, whatever a push has left of them.
            body.velocity, body.angular_velocity = (along, across), turning
            self._space.step(seconds)
            there = body.position.x, body.position.y
            self.turn_body(body.angle)
        else:
            x, y = self.position
            there = x + along * seconds, y + across * seconds
            self.turn_body(self._angle + turning * seconds)
        self.travelled += dist(self.position, there)
        self.position = there

    def _wall_ahead(self, forward: float, seconds: float) -> bool:
        """Whether continuing would press the body against a wall."""
        reach = self.profile.radius * 0.3 + abs(forward) * seconds + 0.05
        thick = self.profile.radius * THICK
        angle = self._angle if forward > 0 else self._angle + pi
        x, y = self.position
        ahead = (x + reach * cos(angle), y + reach * sin(angle))
        return self._space.segment_query_first((x, y), ahead, thick, WALLS) is not None

    def _wall_within(self, reach: float) -> bool:
        """Whether a wall may be within a distance (m): measured only if that may have changed."""
        if self.travelled + reach < self._free_until:
            return False
        nearest = self._space.point_query_nearest(self.position, FAR, WALLS)
        free = FAR if nearest is None else nearest.distance
        self._free = (self.position, free - EPSILON)
        self._free_until = self.travelled + free - EPSILON
        return reach >= free - EPSILON

    @staticmethod
    def _step_person(somebody: Somebody, at: Point, goal: Point, seconds: float) -> None:
        left, step = dist(at, goal), somebody.speed * seconds
        if left <= step:
            somebody.at, somebody.goal = goal, None
        else:
            share = step / left
            somebody.at = (at[0] + (goal[0] - at[0]) * share, at[1] + (goal[1] - at[1]) * share)

    def corners(self) -> list[Corner]:
        """Corners that the robot has come near since the last call."""
        if self.travelled < self._corner_at:
            return []
        reached = []
        nearest = inf
        for corner in self.map.corners:
            beyond = self._beyond(corner)
            nearest = min(nearest, abs(beyond))
            if beyond > 0.0:
                self._inside.discard(corner.id)
            elif corner.id not in self._inside:
                self._inside.add(corner.id)
                reached.append(corner)
        self._corner_at = self.travelled + nearest - EPSILON
        return reached

    def _beyond(self, corner: Corner) -> float:
        """How far (m) the robot is beyond the radius of a corner; less than 0 within."""
        return dist(self.position, corner.at) - corner.radius
