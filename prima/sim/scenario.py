"""Worlds, robot profiles and scenarios as values, read from their documents."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from prima.errors import DocumentError, Problem, Severity, did_you_mean, parted
from prima.interpreter.events import near
from prima.interpreter.surroundings import nearest as nearest_name
from prima.language.commands import (
    ABSENCE_MS,
    DEVICES,
    PATIENCE_MS,
    TABLE_4_2,
    Argument,
    CommandType,
)
from prima.language.values import nearest, outside, read_value, within
from prima.markup.reader import read_tree
from prima.markup.tree import Node
from prima.markup.vocabulary import Vocabulary
from prima.messages import Json
from prima.script.prelude import START
from prima.sim.plan import Plan
from prima.sim.vocabulary import ROBOT, SCENARIO, WORLD

Point = tuple[float, float]
MAX_AREAS = 256
"""Areas that a world may have."""
RENAME = "Rename one."


class Reader:
    """Reads typed attributes of one document by its vocabulary, collecting problems."""

    def __init__(self, vocabulary: Vocabulary, file: str, data: bytes) -> None:
        self.vocabulary = vocabulary
        self.root, self.problems = read_tree(file, data, vocabulary)

    def get(self, node: Node, name: str) -> Any:
        """An attribute's value, its default, or None."""
        element = self.vocabulary.elements.get(node.key)
        item = (
            next((item for item in element.attributes if item.name == name), None)
            if element
            else None
        )
        if item is None:
            return None  # an element that the language lacks; told already
        text = node.attributes.get(name, item.default)
        if not text and name not in node.attributes:
            return None
        try:
            value = read_value(item.kind, text)
        except ValueError:
            return None  # told already, as a problem of the schema
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if number and not within(float(value), item.low, item.high):
            message = f'{name} "{text}" {outside(item.kind, item.low, item.high)}'
            remedy = nearest(item.kind, float(value), item.low, item.high)
            self.problem(node, "out-of-range", message, name, remedy)
        return value

    def problem(
        self,
        node: Node,
        code: str,
        message: str,
        attribute: str = "",
        remedy: str = "",
        severity: Severity = "error",
    ) -> None:
        """Note a problem."""
        place = node.attribute_place(attribute) if attribute in node.attributes else node.place
        self.problems.append(Problem(place, severity, code, message, remedy))

    def known(self, node: Node, name: str, words: Collection[str], what: str) -> None:
        """Note a problem where an attribute names something that is not there."""
        word = node.get(name)
        if word and word not in words:
            message = f'There is no {what} "{word}".'
            self.problem(node, "no-such-name", message, name, nearest_name(word, words))

    def finish(self) -> None:
        """Raise what was found.

        Raises:
            DocumentError: if there is any error.
        """
        if any(problem.severity == "error" for problem in self.problems):
            raise DocumentError(self.problems)


@dataclass(slots=True)
class Corner:
    """Where an event is raised when the robot comes near (radius in m)."""

    id: str
    at: Point
    radius: float
    event: str


@dataclass(slots=True)
class Area:
    """Where an application is offered: its corners (m), and the application's document."""

    id: str
    title: str
    low: Point
    high: Point
    src: str
    node: Node

    def holds(self, point: Point, margin: float = 0.0) -> bool:
        """Whether a point lies inside, or outside by no more than a margin."""
        return (
            self.low[0] - margin <= point[0] <= self.high[0] + margin
            and self.low[1] - margin <= point[1] <= self.high[1] + margin
        )


@dataclass(slots=True)
class Map:
    """A world: places with headings (degrees), ways, walls, things, corners, areas."""

    id: str
    places: dict[str, Point] = field(default_factory=dict)
    headings: dict[str, float] = field(default_factory=dict)
    ways: list[tuple[str, str]] = field(default_factory=list)
    walls: list[tuple[Point, Point]] = field(default_factory=list)
    things: dict[str, Point] = field(default_factory=dict)
    corners: list[Corner] = field(default_factory=list)
    areas: list[Area] = field(default_factory=list)
    warnings: list[Problem] = field(default_factory=list)
    """What is odd in its document, and no error."""
    plan: Plan | None = None
    """Its ways and walls with their elements, of a world that has been read."""

    def point(self, name: str) -> Point | None:
        """Where a place or thing is (m)."""
        return self.places.get(name) or self.things.get(name)


def read_world(file: str, data: bytes) -> Map:
    """Read a world.

    Raises:
        DocumentError: with all its problems.
    """
    reader = Reader(WORLD, file, data)
    world = Map(reader.root.get("id"))
    seen: set[str] = set()
    for node in reader.root.all("place", "thing", "corner"):
        name = node.get("id")
        if name in seen:
            reader.problem(node, "duplicate-id", f'"{name}" is there twice.', "id", RENAME)
        seen.add(name)
        at = (reader.get(node, "x") or 0.0, reader.get(node, "y") or 0.0)
        if node.tag == "place":
            world.places[name] = at
            world.headings[name] = reader.get(node, "heading") or 0.0
        elif node.tag == "thing":
            world.things[name] = at
        else:
            world.corners.append(
                Corner(name, at, reader.get(node, "radius") or 0.8, node.get("event", "corner"))
            )
    for node in reader.root.all("way"):
        for end in ("from", "to"):
            reader.known(node, end, world.places, "place")
        if node.get("from") == node.get("to") != "":
            message = f'The way goes from "{node.get("from")}" to itself.'
            reader.problem(node, "bad-value", message, "to", "Name another place.")
        world.ways.append((node.get("from"), node.get("to")))
    for node in reader.root.all("wall"):
        x1, y1, x2, y2 = (reader.get(node, name) or 0.0 for name in ("x1", "y1", "x2", "y2"))
        world.walls.append(((x1, y1), (x2, y2)))
    areas = reader.root.all("area")
    for node in areas[MAX_AREAS:][:1]:
        message = f"There are more than {MAX_AREAS} areas."
        reader.problem(node, "too-large", message, "", "Divide the world.")
    for node in areas[:MAX_AREAS]:
        if node.get("id") in seen:
            message = f'"{node.get("id")}" is there twice.'
            reader.problem(node, "duplicate-id", message, "id", RENAME)
        seen.add(node.get("id"))
        x1, y1, x2, y2 = (reader.get(node, name) or 0.0 for name in ("x1", "y1", "x2", "y2"))
        title = node.get("title", node.get("id"))
        low, high = (min(x1, x2), min(y1, y2)), (max(x1, x2), max(y1, y2))
        world.areas.append(Area(node.get("id"), title, low, high, node.get("application"), node))
    world.plan = _plan(reader.root, world)
    errors = {problem.code for problem in reader.problems if problem.severity == "error"}
    if errors <= {"no-such-name"}:  # others may be about what stands where
        reader.problems += world.plan.problems(whole=not errors)
    reader.finish()
    world.warnings = reader.problems
    return world


def _plan(root: Node, world: Map) -> Plan:
    """A world's map with its elements."""
    places = {node.get("id"): node for node in root.all("place")}
    ways = [(node.get("from"), node.get("to"), node) for node in root.all("way")]
    return Plan(world.places, places, ways, list(zip(world.walls, root.all("wall"), strict=True)))


POINTING_MS = 1000
"""How long the robot holds its arm out."""


@dataclass(slots=True)
class Profile:
    """A robot: sizes in m, speeds in m/s and degrees/s, times in ms."""

    id: str
    radius: float = 0.2
    speed: float = 0.5
    turn_speed: float = 90.0
    head_speed: float = 120.0
    loop: int = 500
    absence: int = ABSENCE_MS
    """After how long without being sensed the user is absent (rule K1)."""
    devices: frozenset[str] = frozenset()
    camera_angle: float = 60.0
    camera_range: float = 4.0
    voices: dict[str, float] = field(default_factory=dict)
    touch: frozenset[str] = frozenset()
    gestures: dict[str, int] = field(default_factory=dict)
    commands: dict[str, CommandType] = field(default_factory=dict)
    durations: dict[str, int] = field(default_factory=dict)
    motions: dict[str, Motion] = field(default_factory=dict)
    warnings: list[Problem] = field(default_factory=list)
    """What is odd in its document, and no error."""


@dataclass(slots=True)
class Motion:
    """How an added Command moves the body: steps of ms, m/s and degrees/s; ``stray`` in m (X5)."""

    steps: list[tuple[int, float, float]]
    stray: float

    @property
    def duration(self) -> int:
        """How long it takes once (ms)."""
        return sum(step[0] for step in self.steps)

    def at(self, time: int) -> tuple[float, float]:
        """Speed and turn speed at a time (ms); it is repeated as long as it lasts."""
        time %= self.duration
        for lasts, speed, turning in self.steps:
            if time < lasts:
                return speed, turning
            time -= lasts
        return (0.0, 0.0)


def read_robot(file: str, data: bytes) -> Profile:
    """Read a robot profile; its ``commands`` are those it can do.

    Raises:
        DocumentError: with all its problems.
    """
    reader = Reader(ROBOT, file, data)
    root = reader.root
    profile = Profile(
        root.get("id"),
        radius=reader.get(root, "radius") or 0.2,
        speed=reader.get(root, "speed") or 0.5,
        turn_speed=reader.get(root, "turn-speed") or 90.0,
        head_speed=reader.get(root, "head-speed") or 120.0,
        loop=reader.get(root, "loop") or 500,
        absence=reader.get(root, "absence"),
        devices=frozenset(node.get("name") for node in root.all("device")),
        touch=frozenset(node.get("sensor") for node in root.all("touch")),
    )
    _check_devices(reader, profile)
    for node in root.all("camera"):
        profile.camera_angle = reader.get(node, "angle") or 60.0
        profile.camera_range = reader.get(node, "range") or 4.0
    for node in root.all("voice"):
        profile.voices[node.get("lang").lower()] = reader.get(node, "rate") or 14.0
    for node in root.all("gesture"):
        profile.gestures[node.get("name")] = reader.get(node, "duration") or 1000
    rows = dict(TABLE_4_2)
    for node in root.all("adds"):
        if node.get("command") in rows:
            message = f'There is a Command "{node.get("command")}" already.'
            reader.problem(node, "duplicate-id", message, "command")
        rows[node.get("command")] = _added(reader, node)
        lacking = set(node.get("devices").split()) - profile.devices
        if lacking:
            device = min(lacking)
            message = f'"{node.get("command")}" needs the device "{device}", which the robot lacks.'
            reader.problem(
                node,
                "no-such-name",
                message,
                "devices",
                did_you_mean(device, profile.devices) or f'Add <device name="{device}"/>.',
            )
        profile.durations[node.get("command")] = max(reader.get(node, "duration") or 1000, 1)
        motion = _motion(reader, node)
        if motion is not None:
            profile.motions[node.get("command")] = motion
            if "duration" not in node.attributes:
                profile.durations[node.get("command")] = motion.duration
    allowed: dict[str, set[str]] = {}
    for node in root.all("allows"):
        reader.known(node, "command", rows, "Command")
        allowed.setdefault(node.get("command"), set()).add(node.get("argument"))
    for name in allowed.keys() & rows.keys():
        rows[name] = replace(rows[name], extra=rows[name].extra | allowed[name])
    profile.commands = {name: row for name, row in rows.items() if row.devices <= profile.devices}
    for node in root.all("substitute"):
        _substitute(reader, node, rows, profile)
    reader.finish()
    profile.warnings = reader.problems
    return profile


def _check_devices(reader: Reader, profile: Profile) -> None:
    """A device of the robot's own that none of its Commands needs, most likely a slip."""
    own = {name for node in reader.root.all("adds") for name in node.get("devices").split()}
    free = (set(DEVICES) | own) - profile.devices
    for node in reader.root.all("device"):
        name = node.get("name")
        if name in DEVICES or name in own:
            continue
        meant = near(name, free)
        message = f'No Command of this robot needs a device "{name}".'
        remedy = f'Did you mean "{meant}"?' if meant else ""
        remedy = remedy or f'Name it in an <adds devices="{name}">, or remove it.'
        reader.problem(node, "no-such-name", message, "name", remedy, "warning")


def _substitute(reader: Reader, node: Node, rows: dict[str, CommandType], profile: Profile) -> None:
    """Another Command in the place of one that the robot lacks (X6)."""
    reader.known(node, "command", rows, "Command")
    reader.known(node, "by", profile.commands, "Command")
    lacking, other = rows.get(node.get("command")), profile.commands.get(node.get("by"))
    if lacking is None or other is None:
        return
    if lacking.name in profile.commands:
        message = f"The robot can do {lacking.name} itself."
        reader.problem(node, "bad-value", message, "command", "Remove the substitute.")
    unknown = sorted(lacking.arguments.keys() - other.arguments.keys())
    if unknown:
        message = f'{other.name} has no argument "{unknown[0]}", as {lacking.name} has.'
        reader.problem(node, "no-such-argument", message, "by", "Add it to the Command.")
    if lacking.text == "required" and other.text == "none":
        remedy = f"Name a Command that speaks, as {lacking.name} does."
        reader.problem(node, "bad-value", f"{other.name} cannot say anything.", "by", remedy)
    profile.commands[lacking.name] = replace(lacking, substitute=other.name)


def _motion(reader: Reader, node: Node) -> Motion | None:
    """The steps of an added Command that moves the body (X5)."""
    steps = [
        (
            max(reader.get(child, "for") or 1, 1),
            reader.get(child, "speed") or 0.0,
            reader.get(child, "turn-speed") or 0.0,
        )
        for child in node.all("step")
    ]
    if steps and "locomotion" not in node.get("devices").split():
        message = "Its steps move the body, but it does not occupy the locomotion."
        reader.problem(node, "bad-value", message, "devices", 'Add "locomotion" to its devices.')
    stray = reader.get(node, "stray")
    return Motion(steps, 0.3 if stray is None else stray) if steps else None


def _added(reader: Reader, node: Node) -> CommandType:
    """A Command of the profile's own (thesis 5.3 (6))."""
    arguments = {
        child.get("name"): Argument(
            child.get("kind", "text"),
            "",
            reader.get(child, "low"),
            reader.get(child, "high"),
            required=bool(reader.get(child, "required")),
        )
        for child in node.all("argument")
    }
    for child in node.all("argument"):
        low, high = reader.get(child, "low"), reader.get(child, "high")
        if low is not None and high is not None and low > high:
            reader.problem(child, "out-of-range", "low is greater than high.", "low")
    return CommandType(
        name=node.get("command"),
        title=node.get("title", node.get("command")),
        doc="",
        devices=frozenset(node.get("devices").split()),
        feedback=bool(reader.get(node, "feedback")),
        leaves=bool(reader.get(node, "leaves")),
        engages=bool(reader.get(node, "engages")),
        text="optional" if reader.get(node, "says") else "none",
        motion="faithful" if node.all("step") else "",
        arguments=MappingProxyType(arguments),
    )


@dataclass(slots=True)
class Doing:
    """One thing that happens in a ``when``: its element's name and values."""

    name: str
    text: str = ""
    values: dict[str, Any] = field(default_factory=dict)


@dataclass(slots=True)
class When:
    """A trigger with what follows it."""

    trigger: str
    what: Any
    after: int
    times: int
    count: int
    doings: list[Doing]


@dataclass(slots=True)
class Reply:
    """What a service answers, after how long (ms); ``error`` where it fails.

    ``src`` names the file that a fetch is answered with, ``body`` is what it holds.
    """

    after: int
    data: dict[str, Json] = field(default_factory=dict)
    error: str = ""
    status: int = 0
    src: str = ""
    body: bytes = b""
    node: Node | None = None


@dataclass(slots=True)
class Service:
    """A service, and the URI under which it is reached by its address."""

    name: str
    uri: str
    replies: list[Reply]
    application: str = ""
    """The application that alone may ask it; empty if all may."""


UNANSWERED = ("busy", "noanswer", "network_busy")
"""How a call ends that nobody answers (VoiceXML 2.0, 2.3.7.2.2)."""
ENDINGS = (
    "far_end_disconnect",
    "network_disconnect",
    "near_end_disconnect",
    "maxtime_disconnect",
    "unknown",
)
"""How one ends that somebody has answered."""


@dataclass(slots=True)
class Transfer:
    """How a call to a destination goes; times in ms."""

    to: str
    outcome: str
    after: int
    lasts: int


SUBJECTS = ("says", "does", "finishes", "event", "logs", "sends", "state", "ends")
"""What an expectation may be of."""
WITH_DATA = ("does", "finishes", "event", "sends")
"""Subjects that may be told closer by values."""
MAX_EXPECTATIONS = 1000
"""Expectations that a scenario may have."""


@dataclass(slots=True, eq=False)
class Expectation:
    """What has to happen in a run, or must never; times in ms.

    ``words`` are the subjects given, by the attribute's name. The rest says when: after
    ``previous`` (the one before it in an ``in-order``), after or before another of that id,
    from a trigger on (``what`` as in :class:`When`; ``end`` for the run's end), and ``within``
    how long from there.
    """

    words: dict[str, str]
    never: bool
    by: str
    reason: str
    data: dict[str, str]
    id: str
    after: str
    before: str
    trigger: str
    what: Any
    count: int
    within: int | None
    times: int | None
    previous: Expectation | None
    node: Node


@dataclass(slots=True)
class Scenario:
    """A run's script. Paths are as written, relative to the scenario's file."""

    id: str
    title: str
    world: str
    robot: str
    until: int
    date: str
    """When the run begins by its own calendar, as ``2005-03-01T10:00:00`` (UTC)."""
    policy: str
    patience: int
    """How long (ms) an application may keep others from the speaker (E6); 0 for ever."""
    entrances: bool
    robot_at: str
    robot_heading: float | None
    person_at: str
    person_point: Point | None
    person_speed: float
    applications: list[tuple[str, int, Node]]
    whens: list[When]
    services: list[Service]
    connection: dict[str, Json]
    """What is known of the user's call, as ``session.connection`` has it."""
    transfers: list[Transfer]
    expectations: list[Expectation]
    """What ``prima test`` checks, in document order."""
    node: Node


TRIGGERS = ("at", "said", "asked", "doing", "done", "on")


def read_scenario(file: str, data: bytes) -> Scenario:
    """Read a scenario; names of the world are checked when the run is put together.

    Raises:
        DocumentError: with all its problems.
    """
    scenario, problems = look_at_scenario(file, data)
    if any(problem.severity == "error" for problem in problems):
        raise DocumentError(problems)
    return scenario


def look_at_scenario(file: str, data: bytes) -> tuple[Scenario, list[Problem]]:
    """A scenario and its problems; what is wrong in it has no value.

    Raises:
        DocumentError: it is no XML document, or beyond a limit.
    """
    reader = Reader(SCENARIO, file, data)
    root = reader.root
    robots, people = root.all("robot"), root.all("person")
    connections = root.all("connection")
    for extra in (*robots[1:], *people[1:], *connections[1:]):
        reader.problem(
            extra, "duplicate-element", f"There is a second <{extra.tag}>.", "", "Keep one."
        )
    applications = [
        (node.get("src"), reader.get(node, "start") or 0, node) for node in root.all("application")
    ]
    if not applications and root.get("entrances") != "open":
        message = "The scenario runs no <application>."
        remedy = 'Name one, or write entrances="open" to take up what the world offers.'
        reader.problem(root, "missing-element", message, "", remedy)
    person = people[0] if people else None
    point: Point | None = None
    if person is not None:
        _check_where(reader, person, "at", "a place to be at", needed=False)
    if person is not None and "x" in person.attributes:
        point = (reader.get(person, "x") or 0.0, reader.get(person, "y") or 0.0)
    _check_services(reader)
    scenario = Scenario(
        id=root.get("id"),
        title=root.get("title"),
        world=root.get("world"),
        robot=root.get("robot"),
        until=600_000 if (until := reader.get(root, "until")) is None else until,
        date=reader.get(root, "date") or START,
        policy=root.get("policy", "prima"),
        patience=PATIENCE_MS if (patience := reader.get(root, "patience")) is None else patience,
        entrances=root.get("entrances") == "open",
        robot_at=robots[0].get("at") if robots else "",
        robot_heading=(
            reader.get(robots[0], "heading")
            if robots and "heading" in robots[0].attributes
            else None
        ),
        person_at=person.get("at") if person is not None else "",
        person_point=point,
        person_speed=(reader.get(person, "speed") if person is not None else None) or 1.0,
        applications=applications,
        whens=[_when(reader, node) for node in root.all("when")]
        + [_answer(reader, node) for node in root.all("answer")],
        services=[
            Service(
                node.get("name"),
                node.get("uri"),
                [_reply(reader, child) for child in node.nodes if child.key],
                node.get("application"),
            )
            for node in root.all("service")
        ],
        connection=_connection(connections[0]) if connections else {},
        transfers=[_transfer(reader, node) for node in root.all("transfer")],
        expectations=_expectations(reader, root),
        node=root,
    )
    return scenario, reader.problems


def _check_services(reader: Reader) -> None:
    """What an application sends to a name goes to one service: its own, or that of all."""
    seen: set[tuple[str, str]] = set()
    for node in reader.root.all("service"):
        name, owner = node.get("name"), node.get("application")
        if (name, owner) in seen:
            whose = f' for the application "{owner}"' if owner else ""
            message = f'Two services have the name "{name}"{whose}.'
            remedy = "Rename one, or put the replies of both into one."
            reader.problem(node, "duplicate-name", message, "name", remedy)
        seen.add((name, owner))


def _when(reader: Reader, node: Node) -> When:
    given = [name for name in TRIGGERS if name in node.attributes]
    if len(given) != 1:
        message = "<when> needs exactly one of at, said, asked, doing, done, on."
        if given:
            reader.problem(node, "exclusive", message, given[1], "Write a <when> for each.")
        else:
            if node.attributes.keys() <= SCENARIO.attributes["when"].keys():  # else told already
                remedy = 'Write when it happens, such as at="3s" or said="Hello".'
                reader.problem(node, "missing-attribute", message, "", remedy)
            given = ["at"]
    if not node.nodes and not node.text:
        message = "<when> holds nothing."
        remedy = (
            'Put into it what happens then, such as <say>Hello.</say> or <touch sensor="head"/>.'
        )
        reader.problem(node, "empty", message, "", remedy)
    doings = [_doing(reader, child) for child in node.nodes if child.key]
    return When(
        given[0],
        reader.get(node, given[0]),
        reader.get(node, "after") or 0,
        reader.get(node, "times") or 1,
        reader.get(node, "count") or 1,
        doings,
    )


def _doing(reader: Reader, node: Node) -> Doing:
    element = reader.vocabulary.elements[node.key]
    values = {item.name: reader.get(node, item.name) for item in element.attributes}
    if node.tag == "walk":
        _check_where(reader, node, "to", "a place to go to")
    if node.tag == "event":
        values["data"] = _data(node)
    if node.tag == "say":
        values["told"] = _recognised(reader, node)
    return Doing(node.tag, node.text, values)


def _recognised(reader: Reader, node: Node) -> dict[str, Json]:
    """What the recogniser reports of the user's words (:class:`prima.messages.Heard`)."""
    told: dict[str, Json] = {}
    sure = reader.get(node, "confidence")
    if "confidence" in node.attributes:
        told["confidence"] = sure
    others = [(one.text, reader.get(one, "confidence")) for one in node.all("alternative")]
    for one, (_, less) in zip(node.all("alternative"), others, strict=True):
        if None not in (sure, less) and less > sure:
            message = f"An alternative is less likely than what is heard, {sure:g} or below."
            remedy = "Put the likeliest words first."
            reader.problem(one, "out-of-range", message, "confidence", remedy)
    if others:
        told["confidence"] = sure
        told["alternatives"] = [{"text": text, "confidence": less} for text, less in others]
    return told


def _check_where(reader: Reader, node: Node, name: str, what: str, needed: bool = True) -> None:
    """A place by its name, or by x and y, and not both."""
    numbers = [key for key in ("x", "y") if key in node.attributes]
    if name in node.attributes and numbers:
        message = f'<{node.tag}> has both "{name}" and "{numbers[0]}".'
        reader.problem(node, "exclusive", message, numbers[0], "Keep one of them.")
    elif len(numbers) == 1 or (needed and not numbers and name not in node.attributes):
        message = f"<{node.tag}> needs {what}, or x and y."
        lacks = "y" if numbers == ["x"] else "x" if numbers else name
        reader.problem(node, "missing-attribute", message, "", f'Write {lacks}="...".')


def _answer(reader: Reader, node: Node) -> When:
    after = reader.get(node, "after")
    times = reader.get(node, "times") or 1
    return When(
        "asked",
        node.get("to"),
        1000 if after is None else after,
        times,
        1,
        [Doing("say", node.text, {"told": _recognised(reader, node)})],
    )


def _reply(reader: Reader, node: Node) -> Reply:
    after = max(reader.get(node, "after") or 0, 1)
    if node.tag == "failure":
        status = reader.get(node, "status") or 0
        return Reply(after, error=reader.get(node, "reason") or "no answer", status=status)
    return Reply(after, _data(node), src=node.get("src"), node=node)


def _connection(node: Node) -> dict[str, Json]:
    """The user's call as ``session.connection`` has it (VoiceXML 2.0, 5.1.4)."""
    given = node.attributes
    found: dict[str, Json] = {
        side: {"uri": given[side]} for side in ("remote", "local") if side in given
    }
    protocol = {
        name: given[key] for name, key in (("name", "protocol"), ("version",) * 2) if key in given
    }
    redirects = [dict(child.attributes) for child in node.all("redirect")]
    return (
        found
        | ({"protocol": protocol} if protocol else {})
        | {name: given[name] for name in ("aai", "originator") if name in given}
        | ({"redirect": redirects} if redirects else {})
    )


def _transfer(reader: Reader, node: Node) -> Transfer:
    outcome = reader.get(node, "outcome") or ENDINGS[0]
    if outcome not in (*UNANSWERED, *ENDINGS) and not outcome.startswith("error."):
        message = f'A call does not end with "{outcome}".'
        remedy = did_you_mean(outcome, {*UNANSWERED, *ENDINGS})
        remedy = remedy or f"Write {', '.join((*UNANSWERED, *ENDINGS))}, or an error's event."
        reader.problem(node, "bad-value", message, "outcome", remedy)
    lasts = reader.get(node, "lasts")
    return Transfer(
        node.get("to"),
        outcome,
        max(reader.get(node, "after") or 0, 1),
        max(10_000 if lasts is None else lasts, 1),
    )


def _data(node: Node) -> dict[str, Json]:
    return {child.get("name"): child.get("value") for child in node.all("data")}


# Expectations ------------------------------------------------------------------


def _expectations(reader: Reader, root: Node) -> list[Expectation]:
    """All that is expected of the run."""
    found: list[Expectation] = []
    ids: set[str] = set()

    def read(node: Node, previous: Expectation | None, ordered: bool) -> Expectation:
        made = _expectation(reader, node, previous, ordered, ids)
        if made.id in ids:
            reader.problem(node, "duplicate-id", f'"{made.id}" is there twice.', "id", RENAME)
        ids.update({made.id} - {""})
        found.append(made)
        return made

    for node in root.all("expect", "never", "in-order"):
        previous = None
        for child in node.all("expect") if node.tag == "in-order" else ():
            previous = read(child, previous, True)
        if node.tag != "in-order":
            read(node, None, False)
        elif not node.nodes:
            message = "<in-order> holds nothing."
            reader.problem(node, "empty", message, "", "Put <expect> elements into it.")
    for extra in found[MAX_EXPECTATIONS:][:1]:
        message = f"There are more than {MAX_EXPECTATIONS} expectations."
        reader.problem(extra.node, "too-large", message, "", "Divide the scenario.")
    return found


def _expectation(
    reader: Reader, node: Node, previous: Expectation | None, ordered: bool, ids: set[str]
) -> Expectation:
    given = [name for name in SUBJECTS if name in node.attributes]
    triggers = [name for name in TRIGGERS if name in node.attributes]
    _check_subject(reader, node, given)
    if len(triggers) > 1:
        message = f'<{node.tag}> has both "{triggers[0]}" and "{triggers[1]}".'
        reader.problem(node, "exclusive", message, triggers[1], "Keep one of them.")
    if ordered and "state" in given:
        message = "A state lasts: it cannot stand in <in-order>."
        remedy = "Write it outside, and say when by at, said, asked, doing, done or on."
        reader.problem(node, "exclusive", message, "state", remedy)
    for name in ("after", "before"):
        _check_other(reader, node, name, ids)
    trigger = triggers[0] if triggers else ""
    if "count" in node.attributes and trigger in ("", "at"):
        message = "count says which time of said, asked, doing, done or on is meant."
        reader.problem(node, "exclusive", message, "count", "Name one of these, or remove it.")
    return Expectation(
        words={name: node.get(name) for name in given},
        never=node.tag == "never",
        by=node.get("by"),
        reason=node.get("reason"),
        data={child.get("name"): child.get("value") for child in node.all("data")},
        id=node.get("id"),
        after=node.get("after"),
        before=node.get("before"),
        trigger=trigger,
        what=_opening(reader, node, given) if trigger == "at" else node.get(trigger),
        count=reader.get(node, "count") or 1,
        within=reader.get(node, "within"),
        times=reader.get(node, "times"),
        previous=previous,
        node=node,
    )


def _check_subject(reader: Reader, node: Node, given: list[str]) -> None:
    """One thing is expected, with what belongs to it."""
    if node.key not in reader.vocabulary.elements:
        return  # it is of another namespace; told already
    known = {item.name for item in reader.vocabulary.elements[node.key].attributes}
    if not given and not set(node.attributes) <= known:
        return  # a word is misspelt; told already
    if not given:
        message = f"<{node.tag}> does not say what."
        remedy = f"It needs one of {', '.join(SUBJECTS[:-1])} or {SUBJECTS[-1]}."
        reader.problem(node, "missing-attribute", message, "", remedy)
        return
    for name in given:
        if not node.get(name).strip():
            message = f'{name} "" is empty.'
            reader.problem(node, "bad-value", message, name, "Write what is expected.")
    if len(given) > 1 and given != ["says", "does"]:
        message = f'<{node.tag}> has both "{given[0]}" and "{given[1]}".'
        remedy = "Write an element for each; an <in-order> holds those that follow one another."
        reader.problem(node, "exclusive", message, given[1], remedy)
    first = given[0]
    if "reason" in node.attributes and first != "ends":
        reader.problem(node, "exclusive", "reason says why an application ends.", "reason",
                       "Name the application with ends, or remove it.")  # fmt: skip
    if "by" in node.attributes and first == "ends":
        message = "ends names the application itself."
        reader.problem(node, "exclusive", message, "by", "Remove by.")
    if node.all("data") and not set(given) & set(WITH_DATA):
        message = f"What {first} expects has no values."
        reader.problem(node.all("data")[0], "misplaced-element", message, "", "Remove the <data>.")
    for name in ("times", "id"):
        if name in node.attributes and first == "state":
            message = "A state lasts: it is not counted, and nothing comes before or after it."
            reader.problem(node, "exclusive", message, name, f"Remove {name}.")


def _check_other(reader: Reader, node: Node, name: str, ids: set[str]) -> None:
    """after and before name an expectation that stands above."""
    other = node.get(name)
    if not other or other in ids:
        return
    remedy = did_you_mean(other, ids)
    if not remedy and name == "after" and other[:1].isdigit():
        remedy = f'For a time write within="{other}".'
    message = f'No expectation above has the id "{other}".'
    reader.problem(node, "no-such-name", message, name, remedy)


def _opening(reader: Reader, node: Node, given: list[str]) -> Any:
    """The time of ``at`` (ms), or ``end``."""
    text = node.get("at")
    if text == "end":
        if given and given != ["state"]:
            message = 'at="end" is for a state: nothing happens any more then.'
            reader.problem(node, "exclusive", message, "at", "Remove at.")
        return "end"
    try:
        return read_value("duration", text)
    except ValueError as error:
        wrong, remedy = parted(str(error))
        remedy = f'{remedy} Or write "end".'.lstrip()
        reader.problem(node, "bad-value", f'at "{text}" {wrong}', "at", remedy)
        return 0
