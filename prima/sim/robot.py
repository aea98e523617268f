"""The simulated robot: carries out orders in the world and reports what comes of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

from prima.messages import (
    Command,
    Ended,
    Failed,
    Halted,
    Inbound,
    Json,
    Listening,
    Occurred,
    Order,
    Sensed,
)
from prima.sim import voice
from prima.sim.plan import off_line
from prima.sim.routes import Routes
from prima.sim.scenario import POINTING_MS, Point, Profile
from prima.sim.world import LOST_AFTER_MS, World, bearing, difference, distance

ARRIVED = 0.1
"""How near a goal is reached (m)."""
PASSED = 0.25
"""How near a point on the way is passed (m)."""
BLOCKED_MS = 10_000
"""How long a way may be blocked before the move has failed."""
IN_THE_WAY = 0.8
"""How near a person in front makes the robot go round him (m)."""
TOO_NEAR = 0.1
"""How near (m) its body may come to him in front."""
PASSING = 70.0
"""How many degrees off the person's direction it passes him."""
ALIGNED = 1.5
"""How many degrees off a direction counts as turned to it."""
BRAKING_MS = 200
REACTING_S = 0.2
"""How long the robot goes on off its way after a dance has stopped taking it there (X5)."""
AFTERMATH_MS = 1000
"""How long after it moved the body a dance answers for where the robot is (X5)."""
FAILING_MS = 300
"""How long a broken device tries before it says that it fails."""
FAILS = "the device fails"
ITS_OWN = frozenset({"human", "position", "moving"})
"""What it measures itself, by the first part of the sensors' names."""


@dataclass(slots=True)
class Plan:
    """What a locomotion Command remembers from loop to loop; forgotten when interrupted."""

    path: list[Point] | None = None
    turn_left: float = 0.0
    since: int = -1_000_000
    last: tuple[Point, float] | None = None
    stuck: int = 0
    sought: Point | None = None
    scanned: float = 0.0
    track: list[Point] = field(default_factory=list)
    """The whole way of a move, from where it began."""
    strayed: float = 0.0
    """How far (m) a motion composed with a move has taken the robot off its way (X5)."""


@dataclass(slots=True)
class Task:
    """An AB that the robot carries out. Times in ms; ``ends`` None while motion decides it."""

    id: str
    command: Command
    devices: frozenset[str]
    ends: int | None = None
    began: int = 0
    speech_ends: int = 0
    said: voice.Timeline | None = None
    """What it says, where that has cues."""
    skipped: int = 0
    """How much (ms) of that had been said before an interruption (X2)."""
    app: str = ""
    listens: int | None = None
    listening: bool = False
    fails: tuple[str, str] | None = None
    lost: set[str] = field(default_factory=set)
    plan: Plan = field(default_factory=Plan)
    goal: bool = False
    control: Callable[[Task], bool] | None = None

    @property
    def name(self) -> str:
        """The Command's AB without the number of its loop."""
        return self.id.partition(".")[0]

    def passed(self, now: int) -> tuple[int, str, int] | None:
        """How many marks its speech has passed, the last one's name, and the ms since then."""
        played = self.skipped + now - self.began
        count = self.said.passed(played) if self.said is not None else 0
        if self.said is None or not count:
            return None
        time, name = self.said.marks[count - 1]
        return count, name, round(played - time)


class Robot:
    """A PaPeRo-like robot: differential drive, turning head, camera, touch, speech, ear."""

    def __init__(self, profile: Profile, world: World, routes: Routes) -> None:
        self.profile = profile
        self.world = world
        self.routes = routes
        self.tasks: dict[str, Task] = {}
        self.broken: dict[str, bool] = {}
        """Devices that fail, and whether they hang instead."""
        self._halted: list[Inbound] = []
        """What is to be told of interrupted Commands."""
        self._marks: dict[str, tuple[str, int]] = {}
        """The last mark that each application's speech has passed, and when."""
        self._plans: dict[str, Plan] = {}
        """Of Commands whose loop has ended at this instant: a later one begins afresh (U2)."""
        self._stopped: dict[str, tuple[Point, list[Point]]] = {}
        """By the places it was on the way to: where it stopped, and which way was left."""
        self._owners: dict[str, Task] = {}
        self._now = 0
        self._voices = 0
        """How many things the user is saying."""
        self._seen = False
        self._unseen_since: int | None = None
        self.told_of: frozenset[str] | None = None
        """Sensors that somebody looks at, by the first part of their names; None for all of them."""
        self._sensed: dict[str, Json] = {}
        """What the sensors have said last."""
        self._around: tuple[object, ...] = ()
        """Where robot and person were then, and how the robot was turned and driven."""
        self._loops: dict[str, Callable[[Task], bool]] = {
            "topological-move": self._drive_path,
            "set-position": self._drive_path,
            "set-position-and-direction": self._drive_path,
            "tracking-human": self._track,
            "active-sensing-human": self._sense,
        }

    # Orders ---------------------------------------------------------------------

    def order(self, now: int, order: Order) -> None:
        """Carry out an order of the mediator."""
        self._now = now
        if order.verb == "start":
            self._start(order)
        elif order.verb == "stop":
            self.world.drive = (0.0, 0.0)
        else:
            task = self.tasks.get(order.behavior)
            if task is not None and order.verb == "interrupt":
                self._halted.append(Halted(task.id, self._so_far(task)))
            self._abort(order.behavior)

    def _so_far(self, task: Task) -> dict[str, Json]:
        """How much of a Command has been done, and of what it says, how much was heard (X2)."""
        ends = max(task.speech_ends, task.ends or 0)
        began = task.began - task.skipped
        done = (self._now - began) / (ends - began) if ends > task.began else 0.0
        data: dict[str, Json] = {"done": round(min(max(done, 0.0), 1.0), 3)}
        text = task.command.text
        if task.said is not None:
            data["heard"] = task.said.heard(self._now - began)
            passed = task.passed(self._now)
            if passed is not None:
                data["passed"], data["mark"] = passed[:2]
        elif text:
            share = (self._now - task.began) / max(task.speech_ends - task.began, 1)
            data["heard"] = voice.beginning(text, task.command.lang, share)
        return data

    def _abort(self, behavior: str) -> None:
        task = self.tasks.pop(behavior, None)
        if task is not None:
            self._note_way(task)
            self._stand(task)

    def _stand(self, task: Task) -> None:
        """Stop the wheels, where it is this task that turns them."""
        if "locomotion" in task.devices - task.lost:
            self.world.drive = (0.0, 0.0)

    def broke(self, device: str, hangs: bool) -> list[Inbound]:
        """A device fails, and what runs on it with it (E1); or it hangs, and says nothing more."""
        self.broken[device] = hangs
        told: list[Inbound] = []
        for task in [one for one in self.tasks.values() if device in one.devices - one.lost]:
            self._stand(task)
            if hangs:
                task.ends = task.listens = task.control = None
                task.listening = False
            else:
                task.fails = device, FAILS
                told += self._end(task)
        return told

    def _start(self, order: Order) -> None:
        command = order.command
        assert command is not None
        task = Task(order.behavior, command, order.devices, began=self._now, app=order.app)
        self.tasks[task.id] = task
        for device in order.devices:
            before = self._owners.get(device)
            if before is not None and before.id in self.tasks and not order.beside:
                before.lost.add(device)  # only without a mediator
            self._owners[device] = task
        broken = sorted(order.devices & self.broken.keys())
        if broken:
            if not self.broken[broken[0]]:
                task.ends = self._now + FAILING_MS
                task.fails = broken[0], FAILS
            return
        row = self.profile.commands[command.type]
        if (command.text or command.cues) and (order.loop <= 1 or order.resumed):
            task.speech_ends = self._now + self._speech(task, order)
        if row.feedback:
            self._start_loop(task, order)
        else:
            if "locomotion" in task.devices:
                self.world.drive = (0.0, 0.0)
            self._start_once(task)

    def _speech(self, task: Task, order: Order) -> int:
        """How long (ms) the robot now speaks: from a mark on, where the order names one (X2)."""
        text, lang, cues = task.command.text or "", task.command.lang, task.command.cues
        if not cues:
            return voice.duration(text, lang, self.profile.voices)
        task.said = voice.timeline(text, lang, self.profile.voices, cues)
        if order.data:
            task.skipped = round(task.said.marks[order.data["passed"] - 1][0])
        return max(task.said.total - task.skipped, 1)

    def _start_loop(self, task: Task, order: Order) -> None:
        plan = self._plans.pop(task.name, None)
        if plan is None or order.loop == 1 or order.resumed:
            if "locomotion" in task.devices:
                self.world.drive = (0.0, 0.0)
            plan = Plan(since=self._now)
            self._prepare(task, plan)
        task.plan = plan
        loop = self.profile.durations.get(task.command.type, self.profile.loop)
        task.ends = max(self._now + loop, task.speech_ends) if not task.fails else self._now + 1
        task.control = self._loops.get(task.command.type)

    def _prepare(self, task: Task, plan: Plan) -> None:
        """Find the way from where the robot is now."""
        args = task.command.args
        if task.command.type == "topological-move":
            plan.path = self._way(str(args["to"]))
            if plan.path is None:
                task.fails = ("localization", f'there is no way to "{args["to"]}"')
        elif task.command.type.startswith("set-position"):
            plan.path = [(float(args["x"]), float(args["y"]))]
        plan.track = [self.world.position, *(plan.path or ())]

    def _way(self, to: str) -> list[Point] | None:
        """The way to a place: the one it was on, where it still stands where it stopped.

        Else a pause would let it cut a corner, and nobody would hear of that corner.
        """
        at, left = self._stopped.get(to, (self.world.position, []))
        if left and distance(at, self.world.position) <= ARRIVED:
            return list(left)
        return self.routes.route(self.world, to)

    def _note_way(self, task: Task) -> None:
        """Note where a move has stopped, if it has, and its way from there."""
        if task.command.type == "topological-move":
            self._stopped[str(task.command.args["to"])] = (
                self.world.position,
                list(task.plan.path or ()),
            )

    def _start_once(self, task: Task) -> None:
        args, now = task.command.args, self._now
        match task.command.type:
            case "q-and-a":
                task.listens = max(task.speech_ends, now + 1)
            case "turn":
                task.plan.turn_left = float(args["angle"])
                task.control = self._turn
            case "turn-and-speak" if "angle" in args:
                task.plan.turn_left = float(args["angle"])
                task.control = self._turn
            case "set-direction" | "turn-and-speak":
                self._turn_to(task)
            case "face-human" | "face-human-and-speak":
                task.control = self._face
            case "pause":
                task.ends = now + int(args["time"])
            case "set-speed-and-time":
                self.world.drive = (float(args["speed"]), float(args["turn-speed"]))
                task.ends = now + int(args["time"])
            case "stop-moving":
                task.ends = now + (BRAKING_MS if self.world.drive != (0.0, 0.0) else 1)
            case "move-head":
                angle = abs(float(args["pan"]) - self.world.pan)
                task.ends = now + max(round(angle / self.profile.head_speed * 1000), 1)
            case "point-by-hand":
                task.ends = now + POINTING_MS
            case "gesture":
                lasts = self.profile.gestures.get(str(args["name"]))
                task.ends = now + (lasts or 1)
                if lasts is None:
                    task.fails = ("arm", f'the robot knows no gesture "{args["name"]}"')
            case other:
                if other in self.profile.motions:
                    task.control = self._dance
                task.ends = max(
                    task.speech_ends, now + self.profile.durations.get(other, 1), now + 1
                )

    def _turn_to(self, task: Task) -> None:
        args = task.command.args
        if "toward" in args:
            point = self.world.map.point(str(args["toward"]))
            if point is None:
                task.fails = ("localization", f'there is no place "{args["toward"]}"')
                task.ends = self._now + 1
                return
            heading = bearing(self.world.position, point)
        else:
            heading = float(args["heading"])
        task.plan.turn_left = difference(heading, self.world.heading)
        task.control = self._turn

    # Motion: each gives True when it has nothing left to do -------------------------

    def _rotate(self, left: float) -> None:
        limit = self.profile.turn_speed
        speed = max(min(left * 4.0, limit), -limit)
        if abs(speed) < 10.0:
            speed = 10.0 if left > 0 else -10.0
        self.world.drive = (0.0, speed)

    def _turned(self, plan: Plan) -> float:
        """How far the robot has turned since the last time (degrees)."""
        heading = self.world.heading
        before = plan.last[1] if plan.last else heading
        plan.last = (self.world.position, heading)
        return difference(heading, before)

    def _turn(self, task: Task) -> bool:
        plan = task.plan
        plan.turn_left -= self._turned(plan)
        if abs(plan.turn_left) <= ALIGNED:
            self.world.drive = (0.0, 0.0)
            return True
        self._rotate(plan.turn_left)
        return False

    def _face(self, task: Task) -> bool:
        plan, world = task.plan, self.world
        plan.scanned += abs(self._turned(plan))
        if world.sees_person() and world.person is not None:
            off = difference(bearing(world.position, world.person), world.heading)
            if abs(off) <= 5.0:
                world.drive = (0.0, 0.0)
                return True
            self._rotate(off)
            return False
        if plan.scanned >= 360.0:
            world.drive = (0.0, 0.0)
            return True
        self._rotate(90.0)
        return False

    def _toward(self, point: Point, near: float) -> None:
        """Drive toward a point: turn on the spot first, then go, slower when near."""
        self._go(*self._round_person(bearing(self.world.position, point), point), near)

    def _go(self, heading: float, fastest: float, near: float) -> None:
        world, profile = self.world, self.profile
        off = difference(heading, world.heading)
        turning = max(min(off * 3.0, profile.turn_speed), -profile.turn_speed)
        if abs(off) > 30.0:
            world.drive = (0.0, turning)
        else:
            world.drive = (min(fastest, max(near * 1.5, 0.1)), turning)

    def _round_person(self, heading: float, goal: Point) -> tuple[float, float]:
        """The direction and speed that pass a person who stands in the way, if one does."""
        world, profile = self.world, self.profile
        person = world.person
        if person is None or distance(person, goal) < 0.05:
            return heading, profile.speed
        gap = distance(world.position, person)
        toward = bearing(world.position, person)
        aside = difference(heading, toward)
        if gap > IN_THE_WAY or gap > distance(world.position, goal) or abs(aside) > PASSING:
            return heading, profile.speed
        if gap < profile.radius + TOO_NEAR and abs(difference(toward, world.heading)) < 60.0:
            return toward + (PASSING if aside >= 0 else -PASSING), 0.0
        return toward + (PASSING if aside >= 0 else -PASSING), profile.speed / 2

    def _drive_path(self, task: Task) -> bool:
        plan, world = task.plan, self.world
        path = plan.path
        if path is None:
            return True
        while path:
            left = distance(world.position, path[0])
            if left > (ARRIVED if len(path) == 1 else PASSED):
                self._toward(path[0], left if len(path) == 1 else 10.0)
                return False
            path.pop(0)
        heading = task.command.args.get("heading")
        if heading is not None:
            off = difference(float(heading), world.heading)
            if abs(off) > ALIGNED:
                self._rotate(off)
                return False
        world.drive = (0.0, 0.0)
        task.goal = True
        return True

    def _track(self, task: Task) -> bool:
        world, plan = self.world, task.plan
        keep = float(task.command.args["distance"])
        if world.sees_person():
            plan.sought = world.person
        if plan.sought is None:
            self._rotate(90.0)
            return False
        seen = plan.sought == world.person
        left = distance(world.position, plan.sought) - (keep if seen else 0.0)
        if seen and left <= 0.05:
            off = difference(bearing(world.position, plan.sought), world.heading)
            if abs(off) > 5.0:
                self._rotate(off)
            else:
                world.drive = (0.0, 0.0)
        elif not seen and left <= PASSED:
            plan.sought = None  # he is not where he was seen last: look around
        else:
            toward = bearing(world.position, plan.sought)
            heading, fastest = self._round_person(toward, plan.sought)
            self._go(world.beside_walls(heading), fastest, left)
        return False

    def _sense(self, task: Task) -> bool:
        plan = task.plan
        plan.turn_left -= self._turned(plan)
        if abs(plan.turn_left) > ALIGNED and not self.world.sees_person():
            self._rotate(plan.turn_left)
        else:
            plan.turn_left = 0.0
            self.world.drive = (0.0, 0.0)
        return False

    def _dance(self, task: Task) -> bool:
        """Go through the steps of an added motion, on top of a move that goes on (X5)."""
        motion = self.profile.motions[task.command.type]
        speed, turning = motion.at(self._now - task.began)
        move = next((one for one in self.tasks.values() if one.plan.path is not None), None)
        if move is None:
            self.world.drive = (speed, turning)
            return False
        track = move.plan.track
        off = min((off_line(self.world.position, *ends) for ends in pairwise(track)), default=0.0)
        if self._now - task.plan.since <= AFTERMATH_MS:
            task.plan.strayed = max(task.plan.strayed, off)
        if off < motion.stray - self.profile.speed * REACTING_S:
            task.plan.since = self._now
            forward, left = self.world.drive
            limit = self.profile.turn_speed
            forward = min(max(forward + speed, -self.profile.speed), self.profile.speed)
            self.world.drive = (forward, min(max(left + turning, -limit), limit))
        return False

    # Reports ------------------------------------------------------------------------

    def due(self) -> int | None:
        """The next instant at which something is to be reported, if one is known."""
        due: int | None = None
        for task in self.tasks.values():
            for time in (task.ends, task.listens):
                if time and (due is None or time < due):
                    due = time
        soon: int | None = None
        if self._unseen_since is not None:
            soon = self._unseen_since + LOST_AFTER_MS
        elif self._seen and not self.world.sees_person():
            soon = self._now + 1  # somebody has just gone: begin to miss him
        if self._halted:
            soon = self._now + 1
        return due if soon is None else soon if due is None else min(due, soon)

    def collect(self, now: int) -> list[Inbound]:
        """Everything that the devices report at ``now``."""
        if now > self._now:
            self._plans.clear()
        self._now = now
        reports, self._halted = self._halted, []
        # What goes somewhere sets the wheels first; a dance adds to it (X5).
        tasks = list(self.tasks.values())
        if self.profile.motions:
            tasks.sort(key=lambda task: task.control == self._dance)
        for task in tasks:
            drives = task.control is not None and "locomotion" not in task.lost
            if drives and self._steer(task) and task.ends is None:
                task.ends = max(now, task.speech_ends)
            if task.listens is not None and task.listens <= now:
                task.listens, task.listening = None, True
                if not self._voices:
                    self._wait_for_answer(task)
                reports.append(Listening(task.id))
            elif task.ends is not None and task.ends <= now:
                reports += self._end(task)
        reports += self._look()
        for corner in self.world.corners():
            reports.append(Occurred(corner.event, "environment", {"corner": corner.id}))
        return reports

    @staticmethod
    def _steer(task: Task) -> bool:
        """Let a task set the wheels; true when it has nothing left to do."""
        return task.control is not None and task.control(task)

    def _end(self, task: Task) -> list[Inbound]:
        del self.tasks[task.id]
        self._note_way(task)
        passed = task.passed(self._now)
        if passed is not None:
            self._marks[task.app] = (passed[1], self._now - passed[2])
        if task.fails is not None:
            return [Failed(task.id, *task.fails)]
        row, kind = self.profile.commands[task.command.type], task.command.type
        if kind in ("set-speed-and-time", "stop-moving") and "locomotion" not in task.lost:
            self.world.drive = (0.0, 0.0)
        if kind == "move-head":
            self.world.pan = float(task.command.args["pan"])
        if kind == "q-and-a":
            return [Ended(task.id, True, {"outcome": "noinput"})]
        data = self.world.pose() if "locomotion" in task.devices else {}
        if kind in self.profile.motions:
            data["strayed"] = round(task.plan.strayed, 3)
            if "locomotion" not in task.lost and self._now >= task.began:
                self.world.drive = (0.0, 0.0)
        if not row.feedback:
            return [Ended(task.id, True, data)]
        self._plans[task.name] = task.plan
        return self._end_loop(task, data)

    def _end_loop(self, task: Task, data: dict[str, float]) -> list[Inbound]:
        kind = task.command.type
        if kind in self.profile.durations:
            return [Ended(task.id, True, data)]
        if kind == "active-sensing-human":
            return self._end_sensing(task, data)
        if task.plan.path is not None and not task.goal and self._is_stuck(task.plan):
            self.world.drive = (0.0, 0.0)
            self._stopped.clear()  # another try may find another way
            return [Failed(task.id, "locomotion", "the way is blocked")]
        return [Ended(task.id, task.goal, data)]

    def _end_sensing(self, task: Task, data: dict[str, float]) -> list[Inbound]:
        """Turn-and-Search: found, or look on, or turn the camera's angle and try again."""
        plan = task.plan
        if self.world.sees_person():
            self.world.drive = (0.0, 0.0)
            self._seen, self._unseen_since = True, None
            found = Occurred("human.found", "robot", {**self._whereabouts(), "sensed": True})
            return [Ended(task.id, True, data), found]
        if self._now - plan.since >= int(task.command.args["patience"]):
            plan.since = self._now
            plan.turn_left = self.profile.camera_angle
        return [Ended(task.id, False, data)]

    def _is_stuck(self, plan: Plan) -> bool:
        position, heading = self.world.position, self.world.heading
        if plan.last is not None:
            moved = distance(position, plan.last[0]) > 0.02
            turned = abs(difference(heading, plan.last[1])) > 2.0
            plan.stuck = 0 if moved or turned else plan.stuck + self.profile.loop
        plan.last = (position, heading)
        return plan.stuck >= BLOCKED_MS

    def _whereabouts(self) -> dict[str, Json]:
        person, position = self.world.person, self.world.position
        if person is None:
            return {}
        return {
            "distance": round(distance(position, person), 2),
            "angle": round(difference(bearing(position, person), self.world.heading), 1),
        }

    def _look(self) -> list[Inbound]:
        """V4: the camera comes to see the human, or has lost him."""
        if self.world.sees_person():
            self._unseen_since = None
            if not self._seen and not self._is_sensing():
                self._seen = True
                return [Occurred("human.found", "robot", self._whereabouts())]
            return []
        if not self._seen:
            return []
        if self._unseen_since is None:
            self._unseen_since = self._now
        elif self._now - self._unseen_since >= LOST_AFTER_MS:
            self._seen, self._unseen_since = False, None
            return [Occurred("human.lost", "robot")]
        return []

    def _is_sensing(self) -> bool:
        return any(task.command.type == "active-sensing-human" for task in self.tasks.values())

    def sense(self, values: dict[str, Json]) -> list[Inbound]:
        """What the sensors say, if it has changed: for applications that watch them.

        The first report has all of them; later ones have only what somebody looks at.
        """
        world, looked_at = self.world, ITS_OWN if self.told_of is None else self.told_of
        if not self._sensed:
            looked_at = ITS_OWN
        now: dict[str, Json] = {}
        if not looked_at.isdisjoint(ITS_OWN):
            around = (world.position, world.heading, world.pan, world.person, world.drive)
            if around != self._around:
                self._around = around
                now = self._measured(looked_at)
        now.update(values)
        changed = {key: value for key, value in now.items() if self._sensed.get(key, ...) != value}
        self._sensed.update(changed)
        return [Sensed(changed)] if changed else []

    def _measured(self, looked_at: frozenset[str]) -> dict[str, Json]:
        """What its own sensors say, of those that are looked at."""
        world, now = self.world, dict[str, Json]()
        if "human" in looked_at:
            person = world.person
            now["human.visible"] = world.sees_person()
            now["human.distance"] = (
                None if person is None else round(distance(world.position, person), 1)
            )
        if "position" in looked_at:
            pose = world.pose()
            now["position.x"] = round(pose["x"], 1)
            now["position.y"] = round(pose["y"], 1)
            now["position.heading"] = round(pose["heading"]) % 360
        if "moving" in looked_at:
            now["moving"] = world.drive != (0.0, 0.0)
        return now

    # The ear ------------------------------------------------------------------------

    def _question(self) -> Task | None:
        for task in self.tasks.values():
            if task.command.type == "q-and-a" and "speech-recognition" not in task.lost:
                return task
        return None

    def _wait_for_answer(self, task: Task) -> None:
        """The timeout of a question that listens begins: nobody speaks."""
        task.ends = self._now + max(int(task.command.args["timeout"]), 1)

    def speech_begins(self, now: int) -> None:
        """The user begins to speak: a question that listens, or may be interrupted, waits.

        With hotword bargein the robot speaks on until it has understood (VoiceXML 2.0, 4.1.5.1).
        """
        self._voices += 1
        task = self._question()
        if task is None or task.fails is not None:
            return
        if task.listening:
            task.ends = None
            return
        bargein = task.command.args.get("bargein", True) and not task.command.cued("hotword")
        if bargein and task.listens is not None:
            task.listens, task.speech_ends = now + 1, now

    def records(self) -> tuple[int, int] | None:
        """Whether the answer is a recording: its longest time and its final silence, in ms.

        As :class:`prima.messages.Cue` has them; 0 where there is no such bound.
        """
        task = self._question()
        if task is None or not task.command.cued("record"):
            return None
        values = {cue.kind: int(cue.value or 0) for cue in task.command.cues if cue.at == 0}
        return values["record"], values.get("finalsilence", 0)

    def longest_answer(self) -> int:
        """How long the user may speak, in ms; 0 for as long as he likes (VoiceXML 2.0, 6.3.2)."""
        cues = (cue for task in self.tasks.values() for cue in task.command.cues)
        return next((int(cue.value or 0) for cue in cues if cue.kind == "longest"), 0)

    def marks_passed(self, began: int) -> dict[str, Json]:
        """The last mark that a question had passed when the user began to speak (2.1, 4).

        As :class:`prima.messages.Heard` has it; nothing for a question without marks, or for a
        prompt without them that is said before one.
        """
        spoken = (task for task in self.tasks.values() if task.command.type == "speak")
        task = self._question() or next(spoken, None)
        if task is None or not task.command.cued("mark", "earlier"):
            return {}
        until = max(task.speech_ends, task.began)
        if task.command.args.get("bargein", True):
            until = min(until, began)
        passed = task.passed(until)
        if passed is not None:
            return {"markname": passed[1], "marktime": passed[2]}
        name, time = self._marks.get(task.app, ("", until + 1))
        if not task.command.cued("earlier") or time > until:
            return {"markname": None}
        return {"markname": name, "marktime": until - time}

    def speech_ends(self) -> None:
        """The user has said something to its end, or has broken off."""
        self._voices -= 1

    def listen_on(self) -> None:
        """What the user has said was nobody's answer: his time for one begins again."""
        if self._voices:
            return
        for task in self.tasks.values():
            if task.command.type == "q-and-a" and task.listening and task.ends is None:
                self._wait_for_answer(task)
