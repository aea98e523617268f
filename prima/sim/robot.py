"""The simulated robot: carries out orders in the world and reports what comes of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from prima.devices.ear import Ear
from prima.devices.senses import Sensors, Sight
from prima.devices.speech import Marks, Utterance
from prima.messages import (
    Command,
    Data,
    Ended,
    Failed,
    Halted,
    Inbound,
    Json,
    Listening,
    Occurred,
    Order,
)
from prima.sim.locomotion import Locomotion, Plan
from prima.sim.profile import POINTING_MS, Profile
from prima.sim.routes import Routes
from prima.sim.world import World, distance

BRAKING_MS = 200
FAILING_MS = 300
"""How long a broken device tries before it says that it fails."""
FAILS = "the device fails"
ITS_OWN = frozenset({"human", "position", "moving"})
"""What it measures itself, by the first part of the sensors' names."""
STANDING = (0.0, 0.0)
"""What the wheels are told when the robot stands."""


@dataclass(slots=True)
class Task:
    """An AB that the robot carries out. Times in ms; ``ends`` None while motion decides it."""

    id: str
    command: Command
    devices: frozenset[str]
    app: str = ""
    began: int = 0
    ends: int | None = None
    said: Utterance | None = None
    """What it says."""
    asked: int | None = None
    """When a question has been asked, and listens."""
    fails: tuple[str, str] | None = None
    """Which device does not do it, and why."""
    lost: set[str] = field(default_factory=set)
    """Devices that another Command has taken (only without a mediator)."""
    plan: Plan = field(default_factory=Plan)
    control: Callable[[], bool] | None = None
    """Sets the wheels; true when it has nothing left to do."""

    @property
    def name(self) -> str:
        """The Command's AB without the number of its loop."""
        return self.id.partition(".")[0]

    @property
    def spoken(self) -> int:
        """When it has said all it says (ms); 0 if it says nothing."""
        return self.said.ends if self.said is not None else 0

    @property
    def drives(self) -> bool:
        """Whether the wheels are its."""
        return "locomotion" in self.devices - self.lost

    def halted(self, now: int) -> Halted:
        """How much of it has been done, and of what it says, how much was heard (X2)."""
        ends = max(self.spoken, self.ends or 0)
        began = self.began - (self.said.skipped if self.said is not None else 0)
        done = (now - began) / (ends - began) if ends > self.began else 0.0
        data: dict[str, Json] = {"done": round(min(max(done, 0.0), 1.0), 3)}
        if self.said is not None:
            data |= self.said.heard(now)
        elif self.command.text:
            data["heard"] = self.command.text.strip()
        return Halted(self.id, data)


class Robot:
    """A PaPeRo-like robot: differential drive, turning head, camera, touch, speech, ear."""

    def __init__(self, profile: Profile, world: World, routes: Routes) -> None:
        self.profile = profile
        self.world = world
        self.locomotion = Locomotion(profile, world, routes)
        self.ear = Ear()
        self.tasks: dict[str, Task] = {}
        self.broken: dict[str, bool] = {}
        """Devices that fail, and whether they hang instead."""
        self.told_of: frozenset[str] | None = None
        """Sensors that somebody looks at, by the first part of their names; None for all of them."""
        self._sight = Sight()
        self._sensors = Sensors()
        self._marks = Marks()
        self._halted: list[Inbound] = []
        """What is to be told of interrupted Commands."""
        self._plans: dict[str, Plan] = {}
        """Of Commands whose loop has ended at this instant: a later one begins afresh (U2)."""
        self._owners: dict[str, Task] = {}
        self._now = 0
        self._around: tuple[object, ...] = ()
        """Where robot and person were when it last measured, and how the robot moved."""

    # Orders ---------------------------------------------------------------------

    def order(self, now: int, order: Order) -> None:
        """Carry out an order of the mediator."""
        self._now = now
        if order.verb == "start":
            self._start(order)
        elif order.verb == "stop":
            self.locomotion.stand()
        else:
            task = self.tasks.get(order.behavior)
            if task is not None:
                if order.verb == "interrupt":
                    self._halted.append(task.halted(now))
                self._forget(task)
                self._stand(task)

    def _forget(self, task: Task) -> None:
        """A task is over; where it stopped on its way is noted."""
        del self.tasks[task.id]
        self.ear.drop(task.id)
        if task.command.type == "topological-move":
            self.locomotion.note_way(str(task.command.args["to"]), task.plan)

    def _stand(self, task: Task) -> None:
        """Stop the wheels, where it is this task that turns them."""
        if task.drives:
            self.locomotion.stand()

    def broke(self, device: str, hangs: bool) -> list[Inbound]:
        """A device fails, and what runs on it with it (E1); or it hangs, and says nothing more."""
        self.broken[device] = hangs
        told: list[Inbound] = []
        for task in [one for one in self.tasks.values() if device in one.devices - one.lost]:
            self._stand(task)
            if hangs:
                task.ends = task.asked = task.control = None
                self.ear.deafen(task.id)
            else:
                task.fails = device, FAILS
                told += self._end(task)
        return told

    def _start(self, order: Order) -> None:
        command = order.command
        assert command is not None
        task = Task(order.behavior, command, order.devices, order.app, self._now)
        self.tasks[task.id] = task
        if not order.beside:
            self._take_devices(task)
        self._owners.update(dict.fromkeys(order.devices, task))
        if command.type == "q-and-a":
            self.ear.ask(task.id, command)
        broken = sorted(order.devices & self.broken.keys())
        if broken:
            if not self.broken[broken[0]]:
                task.ends = self._now + FAILING_MS
                task.fails = broken[0], FAILS
            return
        task.said = Utterance.of(self._now, order, self.profile.voices)
        if self.profile.commands[command.type].feedback:
            self._start_loop(task, order)
        else:
            self._stand(task)
            self._start_once(task)

    def _take_devices(self, task: Task) -> None:
        """Without a mediator, a Command takes devices from those that use them."""
        for device in task.devices:
            before = self._owners.get(device)
            if before is not None and before.id in self.tasks:
                before.lost.add(device)
                if device == "speech-recognition":
                    self.ear.lose(before.id)

    def _start_loop(self, task: Task, order: Order) -> None:
        plan = self._plans.pop(task.name, None)
        if plan is None or order.loop == 1 or order.resumed:
            self._stand(task)
            plan = Plan(since=self._now)
            self._prepare(task, plan)
        task.plan = plan
        loop = self.profile.durations.get(task.command.type, self.profile.loop)
        task.ends = self._now + 1 if task.fails else max(self._now + loop, task.spoken)
        task.control = self._controlling(task)

    def _controlling(self, task: Task) -> Callable[[], bool] | None:
        """What sets the wheels in each loop of a feedback Command."""
        move, plan, command = self.locomotion, task.plan, task.command
        match command.type:
            case "topological-move" | "set-position" | "set-position-and-direction":
                return lambda: move.drive_path(plan, command)
            case "tracking-human":
                return lambda: move.track(plan, command)
            case "active-sensing-human":
                return lambda: move.search(plan)
        return None

    def _prepare(self, task: Task, plan: Plan) -> None:
        """Find the way from where the robot is now."""
        args = task.command.args
        if task.command.type == "topological-move":
            plan.path = self.locomotion.way(str(args["to"]))
            if plan.path is None:
                task.fails = ("localization", f'there is no way to "{args["to"]}"')
        elif task.command.type.startswith("set-position"):
            plan.path = [(float(args["x"]), float(args["y"]))]
        plan.track = [self.world.position, *(plan.path or ())]

    def _start_once(self, task: Task) -> None:
        args, now = task.command.args, self._now
        match task.command.type:
            case "q-and-a":
                task.asked = max(task.spoken, now + 1)
            case "turn":
                self._turn(task, float(args["angle"]))
            case "turn-and-speak" if "angle" in args:
                self._turn(task, float(args["angle"]))
            case "set-direction" | "turn-and-speak":
                left = self.locomotion.turn_needed(task.command)
                if left is None:
                    self._refuse(task, "localization", f'there is no place "{args["toward"]}"')
                else:
                    self._turn(task, left)
            case "face-human" | "face-human-and-speak":
                task.control = lambda: self.locomotion.face(task.plan)
            case "pause":
                task.ends = now + int(args["time"])
            case "set-speed-and-time":
                self.world.drive = (float(args["speed"]), float(args["turn-speed"]))
                task.ends = now + int(args["time"])
            case "stop-moving":
                task.ends = now + (BRAKING_MS if self.world.drive != STANDING else 1)
            case "move-head":
                angle = abs(float(args["pan"]) - self.world.pan)
                task.ends = now + max(round(angle / self.profile.head_speed * 1000), 1)
            case "point-by-hand":
                task.ends = now + POINTING_MS
            case "gesture":
                lasts = self.profile.gestures.get(str(args["name"]))
                if lasts is None:
                    self._refuse(task, "arm", f'the robot knows no gesture "{args["name"]}"')
                else:
                    task.ends = now + (lasts or 1)
            case other:
                if other in self.profile.motions:
                    task.control = lambda: self._dance(task)
                task.ends = max(task.spoken, now + self.profile.durations.get(other, 1), now + 1)

    def _turn(self, task: Task, left: float) -> None:
        task.plan.turn_left = left
        task.control = lambda: self.locomotion.turn(task.plan)

    def _refuse(self, task: Task, device: str, why: str) -> None:
        task.fails, task.ends = (device, why), self._now + 1

    def _dance(self, task: Task) -> bool:
        """Go through an added motion, composed with the move that goes on (X5)."""
        move = next((one for one in self.tasks.values() if one.plan.path is not None), None)
        motion, track = self.profile.motions[task.command.type], move.plan.track if move else []
        return self.locomotion.dance(task.plan, motion, self._now, task.began, track)

    # Reports ------------------------------------------------------------------------

    def due(self) -> int | None:
        """The next instant at which something is to be reported, if one is known."""
        due = [time for task in self.tasks.values() for time in (task.ends, task.asked) if time]
        sight, unanswered = self._sight.due(self._now, self.world.sees_person()), self.ear.due()
        due += [time for time in (sight, unanswered) if time is not None]
        if self._halted:
            due.append(self._now + 1)
        return min(due, default=None)

    @property
    def moves_on(self) -> bool:
        """Whether a motion has been ordered that ends where the world lets it."""
        return any(task.control is not None and task.ends is None for task in self.tasks.values())

    def collect(self, now: int) -> list[Inbound]:
        """Everything that the devices report at ``now``."""
        if now > self._now:
            self._plans.clear()
        self._now = now
        reports, self._halted = self._halted, []
        # What goes somewhere sets the wheels first; a dance adds to it (X5).
        tasks = list(self.tasks.values())
        if self.profile.motions:
            tasks.sort(key=lambda task: task.command.type in self.profile.motions)
        for task in tasks:
            reports += self._report(task)
        visible, searching = self.world.sees_person(), self._searches()
        where = self.locomotion.whereabouts() if visible else {}
        reports += self._sight.look(now, visible, where, searching)
        for corner in self.world.corners():
            reports.append(Occurred(corner.event, "environment", {"corner": corner.id}))
        return reports

    def _report(self, task: Task) -> list[Inbound]:
        """Let a task set the wheels, and report what has become of it."""
        now = self._now
        steers = task.control if "locomotion" not in task.lost else None
        if steers is not None and steers() and task.ends is None:
            task.ends = max(now, task.spoken)
        if task.asked is not None and task.asked <= now:
            task.asked = None
            self.ear.listen(now, task.id)
            return [Listening(task.id)]
        if task.ends is not None and task.ends <= now:
            return self._end(task)
        unanswered = self.ear.unanswered(now, task.id)
        if unanswered:
            self._leave(task)
        return unanswered

    def _leave(self, task: Task) -> None:
        """A task has come to its end."""
        self._forget(task)
        self._marks.end(self._now, task.app, task.said)

    def _end(self, task: Task) -> list[Inbound]:
        self._leave(task)
        if task.fails is not None:
            return [Failed(task.id, *task.fails)]
        row, kind = self.profile.commands[task.command.type], task.command.type
        if kind in ("set-speed-and-time", "stop-moving"):
            self._stand(task)
        if kind == "move-head":
            self.world.pan = float(task.command.args["pan"])
        data = self.world.pose() if "locomotion" in task.devices else {}
        if kind in self.profile.motions:
            data["strayed"] = round(task.plan.strayed, 3)
            if "locomotion" not in task.lost and self._now >= task.began:
                self.locomotion.stand()
        if not row.feedback:
            return [Ended(task.id, True, data)]
        self._plans[task.name] = task.plan
        return self._end_loop(task, data)

    def _end_loop(self, task: Task, data: Data) -> list[Inbound]:
        kind = task.command.type
        if kind in self.profile.durations:
            return [Ended(task.id, True, data)]
        if kind == "active-sensing-human":
            return self._end_search(task, data)
        plan = task.plan
        if plan.path is not None and not plan.goal and self.locomotion.blocked(plan):
            return [Failed(task.id, "locomotion", "the way is blocked")]
        return [Ended(task.id, plan.goal, data)]

    def _end_search(self, task: Task, data: Data) -> list[Inbound]:
        """Turn-and-Search: found, or look on, or turn the camera's angle and try again."""
        plan = task.plan
        if self.world.sees_person():
            self.locomotion.stand()
            found = self._sight.find(self.locomotion.whereabouts())
            return [Ended(task.id, True, data), found]
        if self._now - plan.since >= int(task.command.args["patience"]):
            plan.since = self._now
            plan.turn_left = self.profile.camera_angle
        return [Ended(task.id, False, data)]

    def _searches(self) -> bool:
        return any(task.command.type == "active-sensing-human" for task in self.tasks.values())

    # Sensors ------------------------------------------------------------------------

    def sense(self, values: Data) -> list[Inbound]:
        """What the sensors say, if it has changed: for applications that watch them.

        The first report has all of them; later ones have only what somebody looks at.

        Args:
            values: what sensors say that the robot does not have itself.
        """
        looked_at = ITS_OWN if self.told_of is None else self.told_of
        if not self._sensors.values:
            looked_at = ITS_OWN
        world, now = self.world, dict[str, Json]()
        around = (world.position, world.heading, world.pan, world.person, world.drive)
        if around != self._around and not looked_at.isdisjoint(ITS_OWN):
            self._around = around
            now = self._measured(looked_at)
        return self._sensors.take({**now, **values})

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
            now["moving"] = world.drive != STANDING
        return now

    # What the user says ---------------------------------------------------------------

    def speech_begins(self, now: int) -> None:
        """The user begins to speak: a question that may be interrupted listens."""
        task = self.tasks.get(self.ear.speech_begins())
        if task is not None and task.asked is not None:
            task.asked = now + 1
            if task.said is not None:
                task.said.ends = now

    def longest_answer(self) -> int:
        """How long the user may speak (ms); 0 without end (VoiceXML 2.0, 6.3.2)."""
        cues = (cue for task in self.tasks.values() for cue in task.command.cues)
        return next((int(cue.value or 0) for cue in cues if cue.kind == "longest"), 0)

    def marks_passed(self, began: int) -> dict[str, Json]:
        """The last mark passed when the user began to speak, as :class:`prima.messages.Heard` has it."""
        question = self.ear.question
        spoken = (task for task in self.tasks.values() if task.command.type == "speak")
        task = self.tasks[question.id] if question is not None else next(spoken, None)
        return self._marks.heard(began, task.app, task.said) if task is not None else {}
