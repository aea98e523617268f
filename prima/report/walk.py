"""The paths of robot and user, and their map.

A transcript holds only what the robot reported: its pose at each end of a motion. Given the
scenario, the run is made again, and the simulation provides the rest, but only if it produces
the same records, since otherwise it was another run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from prima.errors import UsageError
from prima.language.commands import PATIENCE_MS
from prima.messages import Json, Record
from prima.scheduler.robot_state import difference

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.loading import Loaded
    from prima.sim.map import Map
    from prima.sim.rehearsal import Rehearsal
    from prima.sim.world import World
    from prima.transcript.run import Run

MOST_POSES = 60_000
"""Maximum number of poses of robot and of user on a page."""
MOVED = 0.03
"""The smallest change of place (m) that is kept."""
TURNED = 4.0
"""The smallest change of heading (degrees) that is kept."""
FARTHEST = 1e6
"""The distance (m) from the origin beyond which a reported place is not trusted."""

Pose = tuple[float, float, float, float]
"""Time (s), x and y (m), heading (degrees)."""


@dataclass(slots=True)
class RobotWalk:
    """The paths of robot and user, and the map as data if known."""

    robot: list[Pose] = field(default_factory=list)
    person: list[Pose] = field(default_factory=list)
    plan: dict[str, Json] | None = None
    source: str = "reports"
    """``run`` if they come from the simulation, ``reports`` if only from the transcript."""
    camera: tuple[float, float] | None = None
    """The camera's angle (degrees) and range (m)."""
    radius: float = 0.2


def reported(run: Run) -> list[Pose]:
    """The poses that a run's motions end with."""
    poses: list[Pose] = []
    for entry in run.entries:
        if entry.phase not in ("end", "halted") or len(poses) >= MOST_POSES:
            continue
        x, y, heading = (_number(entry.data.get(name)) for name in ("x", "y", "heading"))
        if x is not None and y is not None and heading is not None:
            poses.append((entry.time, x, y, heading))
    return poses


def _number(value: object) -> float | None:
    """A number that may be a place, or None."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if abs(value) < FARTHEST else None


def walk_of(transcript: Transcript, loaded: Loaded | None) -> RobotWalk:
    """The paths of a transcript's run; with its scenario, also the map and the user.

    Raises:
        UsageError: the transcript was made with other files than the scenario's.
    """
    if loaded is None:
        return RobotWalk(reported(transcript.run()))
    check_files(transcript, loaded)
    profile = loaded.cast.robot
    walk = _again(transcript, loaded) or RobotWalk(reported(transcript.run()))
    walk.plan = plan_of(loaded.cast.world, {area.id: app for area, app in loaded.cast.offers})
    walk.camera = (profile.camera_angle, profile.camera_range)
    walk.radius = profile.radius
    return walk


def check_files(transcript: Transcript, loaded: Loaded) -> None:
    """Check that a transcript was made with a scenario's files.

    Raises:
        UsageError: it was not.
    """
    digests = transcript.run().head.get("files")
    if not isinstance(digests, dict) or not digests:
        message = "the transcript does not name its files; leave out --scenario."
        raise UsageError(f"{transcript.name}: {message}")
    for name, digest in loaded.files.items():
        if digest != digests.get(name) and digest not in digests.values():
            known = name in digests
            message = "has changed since" if known else "is not a file of"
            remedy = "Run it again, or leave out --scenario."
            raise UsageError(f"{name} {message} {transcript.name} was made. {remedy}" if known
                             else f"{name} {message} the run of {transcript.name}. {remedy}")  # fmt: skip


def _again(transcript: Transcript, loaded: Loaded) -> RobotWalk | None:
    """Run the scenario again and record the paths; None if the records differ."""
    from prima.transcript.lines import finished

    rehearsal = _rehearsal(loaded, transcript)
    if rehearsal is None:
        return None
    watch = WalkWatch(rehearsal.devices.world)
    rehearsal.devices.watcher = watch.look
    expected: Sequence[Record] = transcript.records
    place = 1
    for records in rehearsal.run():
        for record in records:
            if place < len(expected) and finished(record) != expected[place]:
                return None
            place += 1
        watch.look()
        if place >= len(expected):
            return RobotWalk(watch.robot, watch.person, source="run")
    return None  # the transcript has more


def _rehearsal(loaded: Loaded, transcript: Transcript) -> Rehearsal | None:
    """A scenario, ready to run as a transcript's first record says; None if that is damaged."""
    from prima.loading import seeded
    from prima.scheduler.policy import policy_named
    from prima.sim.rehearsal import Rehearsal
    from prima.transcript.lines import check_head

    head = transcript.records[0]
    try:
        check_head(head, transcript.name)
        said = head["data"]
        patience = round(said.get("patience", PATIENCE_MS / 1000) * 1000)
        cast = seeded(loaded, said.get("seed")).cast
        return Rehearsal(cast, policy_named(said["policy"]), said.get("bound"), patience=patience)
    except UsageError:
        return None


class WalkWatch:
    """Records the positions of robot and user when they change."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.robot: list[Pose] = []
        self.person: list[Pose] = []
        self._before: dict[str, Pose] = {}
        """The last poses seen, kept or not: the ends of rests."""

    def look(self) -> None:
        """Record the current positions."""
        world = self._world
        time = world.time / 1000
        x, y = world.position
        turned = world.heading + world.pan
        self._keep(self.robot, "robot", (time, round(x, 3), round(y, 3), round(turned, 1)))
        if world.person is not None:
            x, y = world.person
            self._keep(self.person, "person", (time, round(x, 3), round(y, 3), 0.0))

    def _keep(self, poses: list[Pose], who: str, pose: Pose) -> None:
        before = self._before.get(who)
        self._before[who] = pose
        if len(poses) >= MOST_POSES:
            return
        if not poses or before is None:
            poses.append(pose)
            return
        last = poses[-1]
        if not _differs(last, pose):
            return
        if before[0] > last[0]:
            poses.append(before)
        poses.append(pose)


def _differs(a: Pose, b: Pose) -> bool:
    way = max(abs(a[1] - b[1]), abs(a[2] - b[2]))
    return way > MOVED or abs(difference(a[3], b[3])) > TURNED


def plan_of(world: Map, offers: Mapping[str, str]) -> dict[str, Json]:
    """A world as plain data, in metres; ``offers`` are the applications of its areas."""
    return {
        "walls": [[*a, *b] for a, b in world.walls],
        "ways": [[*world.places[a], *world.places[b]] for a, b in world.ways],
        "places": [[name, *at] for name, at in world.places.items()],
        "things": [[name, *at] for name, at in world.things.items()],
        "corners": [[corner.id, *corner.at, corner.radius] for corner in world.corners],
        "areas": [
            [area.title, *area.low, *area.high, offers.get(area.id, "")] for area in world.areas
        ],
    }
