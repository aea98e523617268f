"""The simulated body: carries out the conductor's goals in the world, and reports the results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from prima.devices.goals import SAY, Again, Begin, Broke, Cancel, Done, Report, Stand, Stopped
from prima.devices.goals import Call as Told
from prima.devices.profile import Profile
from prima.messages import Occurred
from prima.messages.times import earliest
from prima.sim.locomotion import Locomotion, LocomotionMemory
from prima.sim.measuring import OwnSensors
from prima.sim.routes import Routes
from prima.sim.world import STANDING, World

FAILING_MS = 300
"""How long a broken device tries before it reports failure."""
FAILS = "the device fails"


@dataclass(slots=True, eq=False)
class Effort:
    """A goal in progress. Times in ms; ``ends`` is None while motion determines it."""

    begin: Begin
    began: int
    ends: int | None = None
    tick: int | None = None
    """When the next loop of a feedback Command ends."""
    looped: int = -1
    """When its last loop ended."""
    fails: tuple[str, str] | None = None
    """The device that fails to do it, and why."""
    lost: bool = False
    """Whether another goal has taken over the wheels (only without a mediator)."""
    plan: LocomotionMemory = field(default_factory=LocomotionMemory)
    control: Callable[[], bool] | None = None
    """Sets the wheels; returns True when nothing is left to do."""

    @property
    def turns_on(self) -> bool:
        """Whether the world determines when it ends."""
        return self.control is not None and self.ends is None and self.tick is None

    @property
    def drives(self) -> bool:
        """Whether it controls the wheels."""
        return "locomotion" in self.begin.devices and not self.lost

    def share(self, now: int) -> float | None:
        """How much of it has been done, 0 to 1, if known."""
        if not self.ends or self.begin.kind == SAY:
            return None
        return (now - self.began) / (max(self.begin.spoken, self.ends) - self.began)


class Body:
    """A PaPeRo-like body: differential drive, turning head, arms, camera, touch, speaker."""

    def __init__(self, profile: Profile, world: World, routes: Routes) -> None:
        self.profile = profile
        self.world = world
        self.locomotion = Locomotion(profile, world, routes)
        self.sensors = OwnSensors(world)
        self.efforts: dict[str, Effort] = {}
        """By the keys of their goals."""
        self.broken: dict[str, bool] = {}
        """Broken devices, and whether they hang instead of failing."""
        self.arrived = False
        """Whether a motion has ended at this instant, though its speech may go on."""
        self._now = 0

    # Calls ------------------------------------------------------------------------

    def take(self, now: int, call: Told) -> list[Report]:
        """Carry out a call of the conductor; returns immediate reports."""
        self._now = now
        if isinstance(call, Begin):
            self._begin(now, call)
        elif isinstance(call, Again):
            self._go_on(self.efforts[call.key])
        elif isinstance(call, Stand):
            self.locomotion.stand()
        elif isinstance(call, Cancel) and (effort := self.efforts.get(call.key)) is not None:
            self._forget(effort)
            self._stand(effort)
            return [Stopped(call.key, effort.share(now))]
        return []

    def _forget(self, effort: Effort) -> None:
        """End a goal, and note where the body stopped on its way."""
        del self.efforts[effort.begin.key]
        if effort.begin.kind == "topological-move":
            self.locomotion.note_way(str(effort.begin.command.args["to"]), effort.plan)

    def _stand(self, effort: Effort) -> None:
        """Stop the wheels if this goal controls them."""
        if effort.drives:
            self.locomotion.stand()

    def broke(self, device: str, hangs: bool) -> list[Report]:
        """A device fails, with the goals on it (E1); or it hangs and no longer reports."""
        self.broken[device] = hangs
        reports: list[Report] = []
        for effort in [one for one in self.efforts.values() if device in one.begin.devices]:
            if device == "locomotion" and effort.lost:
                continue
            self._stand(effort)
            if hangs:
                effort.ends = effort.tick = effort.control = None
            else:
                self._forget(effort)
                reports.append(Broke(effort.begin.key, device, FAILS))
        return reports

    def _begin(self, now: int, begin: Begin) -> None:
        effort = self.efforts[begin.key] = Effort(begin, now)
        self._take_wheels(effort)
        broken = begin.devices & self.broken.keys()
        if broken:
            hangs, device = min((self.broken[one], one) for one in broken)
            if not hangs:
                effort.ends, effort.fails = now + FAILING_MS, (device, FAILS)
            return
        if begin.kind == SAY:
            effort.ends = begin.spoken
        elif begin.tick is not None:
            self._stand(effort)
            self._begin_loops(now, effort)
        else:
            self._stand(effort)
            self._begin_once(now, effort)

    def _take_wheels(self, effort: Effort) -> None:
        """Take the wheels from other goals, unless this one is composed with them (X5)."""
        if "locomotion" not in effort.begin.devices or effort.begin.beside:
            return
        for other in self.efforts.values():
            other.lost = "locomotion" in other.begin.devices and other is not effort

    def _go_on(self, effort: Effort) -> None:
        """Begin the next loop; a dance is composed with it at once (X5)."""
        self._take_wheels(effort)
        effort.looped = -1
        if dances := [one for one in self.efforts.values() if self._dances(one)]:
            for one in (effort, *dances):
                if one.control is not None and not one.lost:
                    one.control()

    def _begin_loops(self, now: int, effort: Effort) -> None:
        """Begin the goal of a feedback Command."""
        begin, move = effort.begin, self.locomotion
        args = begin.command.args
        plan = effort.plan = LocomotionMemory(since=now)
        effort.tick = begin.tick
        match begin.kind:
            case "topological-move":
                plan.path = move.way(str(args["to"]))
                if plan.path is None:
                    self._refuse(now, effort, "localization", f'there is no way to "{args["to"]}"')
            case "set-position" | "set-position-and-direction":
                plan.path = [(float(args["x"]), float(args["y"]))]
            case "tracking-human":
                effort.control = partial(move.track, plan, begin.command)
            case "active-sensing-human":
                effort.control = partial(move.search, plan)
        if plan.path is not None:
            plan.track = [self.world.position, *plan.path]
            effort.control = partial(move.drive_path, plan, begin.command)

    def _begin_once(self, now: int, effort: Effort) -> None:
        """Begin a goal that ends by itself."""
        begin = effort.begin
        args = begin.command.args
        match begin.kind:
            case "listen" | "record":
                pass  # the listener determines when it ends
            case "turn" | "set-direction" | "turn-and-speak":
                self._turn(now, effort)
            case "face-human" | "face-human-and-speak":
                effort.control = partial(self.locomotion.face, effort.plan)
            case "set-speed-and-time":
                self.world.drive = (float(args["speed"]), float(args["turn-speed"]))
                effort.ends = now + int(args["time"])
            case "stop-moving":
                drives = self.world.drive != STANDING
                effort.ends = now + (self.profile.lasts(begin.kind) if drives else 1)
            case "move-head":
                angle = abs(float(args["pan"]) - self.world.pan)
                effort.ends = now + max(round(angle / self.profile.head_speed * 1000), 1)
            case "point-by-hand":
                self._point(now, effort)
            case "gesture":
                self._gesture(now, effort, str(args["name"]))
            case other:
                if other in self.profile.motions:
                    effort.control = partial(self._dance, effort)
                    effort.control()
                lasts = self.profile.lasts(other)
                effort.ends = max(begin.spoken, now + lasts, now + 1)

    def _turn(self, now: int, effort: Effort) -> None:
        args = effort.begin.command.args
        if "angle" in args:
            left: float | None = float(args["angle"])
        else:
            left = self.locomotion.turn_needed(effort.begin.command)
        if left is None:
            self._refuse_place(now, effort, "localization")
            return
        effort.plan.turn_left = left
        effort.control = partial(self.locomotion.turn, effort.plan)

    def _point(self, now: int, effort: Effort) -> None:
        command = effort.begin.command
        effort.ends = now + self.profile.lasts(command.type)
        if "toward" in command.args and self.locomotion.turn_needed(command) is None:
            self._refuse_place(now, effort, "arm")

    def _gesture(self, now: int, effort: Effort, name: str) -> None:
        lasts = self.profile.gestures.get(name)
        if lasts is None:
            self._refuse(now, effort, "arm", f'the robot knows no gesture "{name}"')
        else:
            effort.ends = now + (lasts or 1)

    def _refuse_place(self, now: int, effort: Effort, device: str) -> None:
        place = effort.begin.command.args["toward"]
        self._refuse(now, effort, device, f'there is no place "{place}"')

    @staticmethod
    def _refuse(now: int, effort: Effort, device: str, why: str) -> None:
        effort.fails, effort.ends, effort.tick = (device, why), now + 1, None

    def _dance(self, effort: Effort) -> bool:
        """Perform an added motion, composed with the move that goes on (X5).

        A move whose loop ends at this instant goes on when the next one has been ordered.
        """
        moves = (one for one in self.efforts.values() if one.plan.path is not None)
        move = next((one for one in moves if one.looped != self._now), None)
        motion = self.profile.motions[effort.begin.kind]
        track = move.plan.track if move else []
        return self.locomotion.dance(effort.plan, motion, self._now, effort.began, track)

    # Reports ------------------------------------------------------------------------

    def due(self) -> int | None:
        """When the next report is due (ms), if known.

        The end of speech does not count while the same Command still moves the body.
        """
        moving = {_behavior(one.begin) for one in self.efforts.values() if one.turns_on}
        times = [
            time
            for one in self.efforts.values()
            for time in (one.ends, one.tick)
            if time and not (one.begin.kind == SAY and _behavior(one.begin) in moving)
        ]
        return earliest(None, *times)

    @property
    def moves_on(self) -> bool:
        """Whether a goal has to set the wheels again, though they may not turn."""
        return any(one.turns_on or self._dances(one) for one in self.efforts.values())

    def _dances(self, effort: Effort) -> bool:
        """Whether it performs the steps of an added motion."""
        return effort.begin.kind in self.profile.motions and effort.control is not None

    def collect(self, now: int) -> list[Report]:
        """Advance the body, and return its devices' reports at ``now``."""
        self._now, self.arrived = now, False
        efforts = list(self.efforts.values())
        # Moves set the wheels first; a dance adds to them (X5).
        if len(efforts) > 1 and self.profile.motions:
            efforts.sort(key=lambda one: one.begin.kind in self.profile.motions)
        reports: list[Report] = []
        for effort in efforts:
            if (report := self._get_on(now, effort)) is not None:
                reports.append(report)
        return reports

    def _get_on(self, now: int, effort: Effort) -> Report | None:
        """Let a goal set the wheels; returns its end, if it has ended."""
        steers = None if effort.lost else effort.control
        if steers is not None and steers() and effort.ends is None and effort.tick is None:
            effort.ends, self.arrived = max(now, effort.begin.spoken), True
        if effort.tick is not None and effort.tick <= now:
            effort.tick += effort.begin.loop
            effort.looped = now
            return self._end_loop(now, effort)
        if effort.ends is not None and effort.ends <= now:
            return self._end(effort)
        return None

    def _end(self, effort: Effort) -> Report:
        self._forget(effort)
        key, kind = effort.begin.key, effort.begin.kind
        if effort.fails is not None:
            return Broke(key, *effort.fails)
        if kind in ("set-speed-and-time", "stop-moving"):
            self._stand(effort)
        if kind == "move-head":
            self.world.turn_head(float(effort.begin.command.args["pan"]))
        data = self.world.pose() if "locomotion" in effort.begin.devices else {}
        if kind in self.profile.motions:
            data["strayed"] = round(effort.plan.strayed, 3)
            self._stand(effort)
        return Done(key, data)

    def _end_loop(self, now: int, effort: Effort) -> Report | None:
        """A loop of a feedback Command ends: the goal is reached, unreachable, or goes on."""
        kind, plan = effort.begin.kind, effort.plan
        if kind == "active-sensing-human":
            reached = self._search_on(now, effort)
        else:
            reached = bool(self.profile.lasts(kind)) or plan.goal
        if reached:
            return self._end(effort)
        if plan.path is not None and self.locomotion.blocked(plan):
            effort.fails = "locomotion", "the way is blocked"
            return self._end(effort)
        return None

    def _search_on(self, now: int, effort: Effort) -> bool:
        """Turn-and-Search: found, keep looking, or turn by the camera's angle and try again."""
        if self.world.find_somebody():
            self.locomotion.stand()
            return True
        if now - effort.plan.since >= int(effort.begin.command.args["patience"]):
            effort.plan.since = now
            effort.plan.turn_left = self.profile.camera_angle
        return False

    def corners(self) -> list[Occurred]:
        """The events of corners that the body has come near."""
        if not (near := self.world.corners()):
            return []
        return [Occurred(one.event, "environment", {"corner": one.id}) for one in near]


def _behavior(begin: Begin) -> str:
    """The AB that a goal belongs to."""
    return begin.key.partition("/")[0]
