"""How the simulated robot moves: the wheels' speeds for each Command, loop by loop."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from math import copysign, dist, radians

from prima.devices.profile import Motion, Profile
from prima.messages import Command, Json
from prima.scheduler.robot_state import difference
from prima.sim.plan import Point, off_line
from prima.sim.routes import Routes
from prima.sim.world import STANDING, STEP_MS, World, bearing

ARRIVED = 0.1
"""A goal is reached at this distance (m)."""
PASSED = 0.25
"""A point on the way is passed at this distance (m)."""
BLOCKED_MS = 10_000
"""How long a way may be blocked before the move fails."""
IN_THE_WAY = 0.8
"""The robot goes round a person in front of it who is nearer than this (m)."""
TOO_NEAR = 0.1
"""The distance (m) that its body keeps from a person in front."""
PASSING = 70.0
"""How many degrees off the person's direction it passes them."""
TURNED = 30.0
"""The robot begins to drive when it is turned to its goal within this many degrees."""
DRIFT = 0.11
"""How far (m) it may drift off its line until it is."""
ALIGNED = 1.5
"""The robot counts as turned in a direction within this many degrees."""
SLOWEST = 10.0
"""A turn slows down to this speed before its end (degrees a second), if it is faster."""
REACTING_S = 0.3
"""How long the robot goes on away from its way after a dance has stopped moving it (X5)."""
AFTERMATH_MS = 1000
"""How long after moving the body a dance accounts for where the robot is (X5)."""


@dataclass(slots=True)
class LocomotionMemory:
    """The memory of a locomotion Command from loop to loop; lost when it is interrupted."""

    path: list[Point] | None = None
    turn_left: float = 0.0
    since: int = -1_000_000
    last: tuple[Point, float] | None = None
    stuck: int = 0
    sought: Point | None = None
    scanned: float = 0.0
    goal: bool = False
    """Whether it has reached its goal."""
    track: list[Point] = field(default_factory=list)
    """The whole way of a move, from where it began."""
    strayed: float = 0.0
    """How far (m) a motion composed with a move has taken the robot off its way (X5)."""


class Locomotion:
    """Sets the wheels. A motion returns True when nothing is left to do."""

    def __init__(self, profile: Profile, world: World, routes: Routes) -> None:
        self.profile = profile
        self.world = world
        self.routes = routes
        self._stopped: dict[str, tuple[Point, list[Point]]] = {}
        """By destination: where it stopped, and the rest of the way."""

    def stand(self) -> None:
        """Stop the wheels."""
        self.world.drive = STANDING

    # Ways ---------------------------------------------------------------------------

    def way(self, to: str) -> list[Point] | None:
        """The way to a place: the previous one, if the robot is still where it stopped.

        Otherwise it would cut a corner after a pause, and that corner's event would be lost.
        """
        at, left = self._stopped.get(to, (self.world.position, []))
        if left and dist(at, self.world.position) <= ARRIVED:
            return list(left)
        return self.routes.route(self.world, to)

    def note_way(self, to: str, plan: LocomotionMemory) -> None:
        """Note where a move has stopped, and the rest of its way."""
        self._stopped[to] = self.world.position, list(plan.path or ())

    def blocked(self, plan: LocomotionMemory) -> bool:
        """Whether a move has been stuck for too long; another attempt may find another way."""
        position, heading = self.world.position, self.world.heading
        before = plan.last or (position, heading)
        # A wall pushes the body back by up to a step of its drive, again and again.
        pushed = 2 * self.profile.speed * STEP_MS / 1000
        moved = dist(position, before[0]) > max(0.02, pushed)
        turned = abs(difference(heading, before[1])) > 2.0
        if plan.last is None or moved or turned:
            plan.last, plan.stuck = (position, heading), 0
        else:
            plan.stuck += self.profile.loop
        if plan.stuck < BLOCKED_MS:
            return False
        self.stand()
        self._stopped.clear()
        return True

    def turn_needed(self, command: Command) -> float | None:
        """How far (degrees) to turn to the direction or place of a Command; None if unknown."""
        if "toward" in command.args:
            point = self.world.map.point(str(command.args["toward"]))
            if point is None:
                return None
            heading = bearing(self.world.position, point)
        else:
            heading = float(command.args["heading"])
        return difference(heading, self.world.heading)

    # Motions ------------------------------------------------------------------------

    def _rotate(self, left: float) -> None:
        speed = min(max(abs(left) * 4.0, SLOWEST), self.profile.turn_speed)
        self.world.drive = (0.0, speed if left > 0 else -speed)

    def _turned(self, plan: LocomotionMemory) -> float:
        """How far the robot has turned since the last time (degrees)."""
        heading = self.world.heading
        before = plan.last[1] if plan.last else heading
        plan.last = (self.world.position, heading)
        return difference(heading, before)

    def turn(self, plan: LocomotionMemory) -> bool:
        """Turn by the rest of an angle."""
        plan.turn_left -= self._turned(plan)
        if abs(plan.turn_left) <= ALIGNED:
            self.stand()
            return True
        self._rotate(plan.turn_left)
        return False

    def face(self, plan: LocomotionMemory) -> bool:
        """Turn to where the user was last seen, searching all round for them.

        A camera that points aside with the head loses them while the body turns.
        """
        world = self.world
        plan.scanned += abs(self._turned(plan))
        if world.sees_person():
            plan.sought = world.person
        if plan.sought is not None:
            off = difference(bearing(world.position, plan.sought), world.heading)
            if abs(off) <= 5.0:
                self.stand()
                return True
            self._rotate(off)
            return False
        if plan.scanned >= 360.0:
            self.stand()
            return True
        self._rotate(90.0)
        return False

    def _toward(self, point: Point, near: float) -> None:
        """Drive toward a point: turn on the spot first, then go, slower when near."""
        heading, fastest = self._round_person(bearing(self.world.position, point), point)
        self._go(heading, fastest, near)

    def _go(self, heading: float, fastest: float, near: float) -> None:
        world, profile = self.world, self.profile
        off = difference(heading, world.heading)
        turning = off * 3.0
        if abs(turning) > profile.turn_speed:
            turning = copysign(profile.turn_speed, turning)
        if near * 1.5 < fastest:
            fastest = min(fastest, max(near * 1.5, 0.1))
        if abs(off) > ALIGNED:
            fastest = min(fastest, DRIFT / radians(TURNED) * abs(turning / off))
        world.drive = (0.0 if abs(off) > TURNED else fastest, turning)

    def _round_person(self, heading: float, goal: Point) -> tuple[float, float]:
        """The direction and speed that pass a person who is in the way, if anyone is."""
        for person in self.world.people_within(IN_THE_WAY):
            found = self._round(person, heading, goal)
            if found is not None:
                return found
        return heading, self.profile.speed

    def _round(self, person: Point, heading: float, goal: Point) -> tuple[float, float] | None:
        """The direction and speed that pass a person, or None if they are not in the way."""
        world, profile = self.world, self.profile
        gap = dist(world.position, person)
        if gap > dist(world.position, goal):
            return None
        toward = bearing(world.position, person)
        aside = difference(heading, toward)
        if abs(aside) > PASSING or dist(person, goal) < 0.05:
            return None
        if gap < profile.radius + TOO_NEAR and abs(difference(toward, world.heading)) < 60.0:
            return toward + (PASSING if aside >= 0 else -PASSING), 0.0
        return toward + (PASSING if aside >= 0 else -PASSING), profile.speed / 2

    def drive_path(self, plan: LocomotionMemory, command: Command) -> bool:
        """Go through the points of the way, and turn to the heading asked for."""
        world, path = self.world, plan.path
        while path:
            point, last = path[0], len(path) == 1
            left = dist(world.position, point)
            if left > (ARRIVED if last else PASSED):
                self._toward(point, left if last else 10.0)
                return False
            path.pop(0)
        heading = command.args.get("heading")
        if heading is not None:
            off = difference(float(heading), world.heading)
            if abs(off) > ALIGNED:
                self._rotate(off)
                return False
        self.stand()
        plan.goal = True
        return True

    def track(self, plan: LocomotionMemory, command: Command) -> bool:
        """Stay at a distance (m) from the user."""
        world, keep = self.world, float(command.args["distance"])
        if world.sees_person():
            plan.sought = world.person
        if plan.sought is None:
            self._rotate(90.0)
            return False
        seen = plan.sought == world.person
        left = dist(world.position, plan.sought) - (keep if seen else 0.0)
        if seen and left <= 0.05:
            off = difference(bearing(world.position, plan.sought), world.heading)
            if abs(off) > 5.0:
                self._rotate(off)
            else:
                self.stand()
        elif not seen and left <= PASSED:
            plan.sought = None  # they are not where they were last seen: look around
        else:
            toward = bearing(world.position, plan.sought)
            heading, fastest = self._round_person(toward, plan.sought)
            self._go(world.beside_walls(heading), fastest, left)
        return False

    def search(self, plan: LocomotionMemory) -> bool:
        """Keep turning while the user is out of sight."""
        plan.turn_left -= self._turned(plan)
        if abs(plan.turn_left) > ALIGNED and not self.world.find_somebody():
            self._rotate(plan.turn_left)
        else:
            plan.turn_left = 0.0
            self.stand()
        return False

    def dance(
        self, plan: LocomotionMemory, motion: Motion, now: int, began: int, track: list[Point]
    ) -> bool:
        """Perform the steps of an added motion, on top of a move that goes on (X5).

        ``track`` is the whole way of that move, empty if there is none. Times are ms.
        """
        speed, turning = motion.at(now - began)
        if not track:
            self.world.drive = (speed, turning)
            return False
        off = min((off_line(self.world.position, *ends) for ends in pairwise(track)), default=0.0)
        if now - plan.since <= AFTERMATH_MS:
            plan.strayed = max(plan.strayed, off)
        if off < motion.stray - self.profile.speed * REACTING_S:
            plan.since = now
            forward, left = self.world.drive
            limit = self.profile.turn_speed
            forward = min(max(forward + speed, -self.profile.speed), self.profile.speed)
            self.world.drive = (forward, min(max(left + turning, -limit), limit))
        return False

    # What it measures ---------------------------------------------------------------

    def whereabouts(self) -> dict[str, Json]:
        """Where the user is from here: ``distance`` (m) and ``angle`` (degrees)."""
        person, position = self.world.person, self.world.position
        if person is None:
            return {}
        return {
            "distance": round(dist(position, person), 2),
            "angle": round(difference(bearing(position, person), self.world.heading), 1),
        }
