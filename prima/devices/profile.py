"""Robot profiles as values, read from their documents."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from prima.devices.goals import LISTEN, SAY
from prima.devices.reading import Reader
from prima.devices.settings import SLOTS, WRITTEN_SLOT, DriverSettings, read_driver, share_devices
from prima.devices.vocabulary.robot import ROBOT
from prima.errors import Place, Problem, meant, suggestion
from prima.interpreter.events import near
from prima.language.arguments import missing_argument
from prima.language.commands import ABSENCE_MS, DEVICES, TABLE_4_2, Argument, CommandType
from prima.markup.spans import value_span
from prima.markup.tree import Node

NAMED = [("device", "name"), ("touch", "sensor"), ("gesture", "name"), ("voice", "lang")]
"""Parts of a profile that are there once each, with the attribute that names them."""


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
    """How long the user has to go unsensed to count as absent (rule K1)."""
    devices: frozenset[str] = frozenset()
    camera_angle: float = 60.0
    camera_range: float = 4.0
    voices: dict[str, float] = field(default_factory=dict)
    touch: frozenset[str] = frozenset()
    gestures: dict[str, int] = field(default_factory=dict)
    commands: dict[str, CommandType] = field(default_factory=dict)
    motions: dict[str, Motion] = field(default_factory=dict)
    drivers: list[DriverSettings] = field(default_factory=list)
    warnings: list[Problem] = field(default_factory=list)
    """The warnings about its document."""
    place: Place = field(default_factory=lambda: Place("robot.xml"))
    """The position at which its document begins."""

    def lasts(self, kind: str) -> int:
        """How long (ms) a Command takes by itself, if that is fixed; else 0."""
        row = self.commands.get(kind)
        return row.lasts if row is not None else 0


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
        """Speed and turn speed at a time (ms); the motion repeats as long as it lasts."""
        time %= self.duration
        for lasts, speed, turning in self.steps:
            if time < lasts:
                return speed, turning
            time -= lasts
        return (0.0, 0.0)


def _read_parts(reader: Reader, profile: Profile) -> None:
    """The camera, voices and gestures."""
    for node in reader.root.all("camera"):
        profile.camera_angle = reader.get(node, "angle")
        profile.camera_range = reader.get(node, "range")
    for node in reader.root.all("voice"):
        profile.voices[node.get("lang").lower()] = reader.get(node, "rate")
    for node in reader.root.all("gesture"):
        profile.gestures[node.get("name")] = reader.get(node, "duration")


def _check_twice(reader: Reader) -> None:
    """Duplicate entries, of which only one would count."""
    reader.only("camera")
    for tag, key in NAMED:
        reader.check_twice(reader.root.all(tag), key, fold=key == "lang")
    for adds in reader.root.all("adds"):
        reader.check_twice(adds.all("argument"), "name")


def read_robot(file: str, data: bytes) -> Profile:
    """Read a robot profile; its ``commands`` are those that the robot can do.

    Raises:
        DocumentError: with all its problems.
    """
    reader = Reader(ROBOT, file, data)
    root = reader.root
    profile = Profile(
        root.get("id"),
        radius=reader.get(root, "radius"),
        speed=reader.get(root, "speed"),
        turn_speed=reader.get(root, "turn-speed"),
        head_speed=reader.get(root, "head-speed"),
        loop=reader.get(root, "loop"),
        absence=reader.get(root, "absence"),
        devices=frozenset(node.get("name") for node in root.all("device")),
        touch=frozenset(node.get("sensor") for node in root.all("touch")),
        place=root.place,
    )
    _check_devices(reader, profile)
    _check_twice(reader)
    _read_parts(reader, profile)
    longest = max((one or 0 for one in profile.gestures.values()), default=0)
    rows = {**TABLE_4_2, "gesture": replace(TABLE_4_2["gesture"], lasts=longest)}
    for node in root.all("adds"):
        _add(reader, node, rows, profile)
    _allow(reader, rows)
    profile.commands = {name: row for name, row in rows.items() if row.devices <= profile.devices}
    for node in root.all("substitute"):
        _substitute(reader, node, rows, profile)
    _read_drivers(reader, profile)
    reader.finish()
    profile.warnings = reader.problems
    return profile


def _read_drivers(reader: Reader, profile: Profile) -> None:
    """The drivers, whose devices, Commands and gestures the robot has."""
    seen: set[str] = set()
    for node in reader.root.all("driver"):
        for device in node.get("devices").split():
            if device in seen:
                message = f'The device "{device}" is carried twice.'
                reader.problem(node, "duplicate-name", message, "devices", "Name it once.")
            elif device not in profile.devices:
                message = f'The robot has no device "{device}".'
                _lacks(reader, node, device, profile, message)
            seen.add(device)
        for does in node.all("does"):
            if does.get("command"):
                reader.known(does, "command", {*profile.commands, SAY, LISTEN}, "Command")
            if does.get("gesture"):
                reader.known(does, "gesture", profile.gestures, "gesture")
            _check_slots(reader, does, profile)
        profile.drivers.append(read_driver(reader, node))
    share_devices(profile.drivers, profile.devices)


def _check_slots(reader: Reader, does: Node, profile: Profile) -> None:
    """Warn about misspelt placeholders; a driver of one's own may have others."""
    row = profile.commands.get(does.get("command") or "gesture")
    known = SLOTS | (row.arguments.keys() | row.extra if row is not None else set())
    for node in does.all("set"):
        for name in WRITTEN_SLOT.findall(node.get("value")):
            if name not in known and (word := near(name, known)):
                message = f'There is no value "{{{name}}}", so this argument lacks it.'
                hint = meant(word, *value_span(node, "value", name))
                reader.problem(node, "no-such-argument", message, "value", hint, "warning")


def _lacks(reader: Reader, node: Node, device: str, profile: Profile, message: str) -> None:
    hint = suggestion(device, profile.devices, *value_span(node, "devices", device))
    remedy = hint or f'Add <device name="{device}"/>.'
    reader.problem(node, "no-such-name", message, "devices", remedy)


def _add(reader: Reader, node: Node, rows: dict[str, CommandType], profile: Profile) -> None:
    """Add a Command of the robot's own to the rows of the table."""
    name = node.get("command")
    if name in rows:
        message = f'There is a Command "{name}" already.'
        reader.problem(node, "duplicate-id", message, "command")
    motion = _motion(reader, node)
    if motion is not None:
        profile.motions[name] = motion
    rows[name] = _added(reader, node, motion)
    lacking = set(node.get("devices").split()) - profile.devices
    if lacking:
        device = min(lacking)
        message = f'"{name}" needs the device "{device}", which the robot lacks.'
        _lacks(reader, node, device, profile, message)


def _allow(reader: Reader, rows: dict[str, CommandType]) -> None:
    """Add further arguments to Commands."""
    for node in reader.root.all("allows"):
        name = node.get("command")
        reader.known(node, "command", rows, "Command")
        if name in rows:
            rows[name] = replace(rows[name], extra=rows[name].extra | {node.get("argument")})


def _check_devices(reader: Reader, profile: Profile) -> None:
    """Warn about a device of the robot's own that none of its Commands needs: likely a typo."""
    own = {name for node in reader.root.all("adds") for name in node.get("devices").split()}
    free = set(DEVICES) - profile.devices  # a device that an <adds> lacks is reported there
    for node in reader.root.all("device"):
        name = node.get("name")
        if name in DEVICES or name in own or not name:
            continue
        message = f'No Command of this robot needs a device "{name}".'
        hint = meant(near(name, free), *value_span(node, "name"))
        remedy = hint or f'Name it in an <adds devices="{name}">, or remove it.'
        reader.problem(node, "no-such-name", message, "name", remedy, "warning")


def _substitute(reader: Reader, node: Node, rows: dict[str, CommandType], profile: Profile) -> None:
    """Read a substitute for a Command that the robot lacks (X6)."""
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
    if missing := missing_argument(other, lacking.arguments):
        message = f"{missing.removesuffix('.')}, which {lacking.name} does not have."
        reader.problem(node, "no-such-argument", message, "by", "Name another Command.")
    if lacking.text == "required" and other.text == "none":
        remedy = f"Name a Command that speaks, as {lacking.name} does."
        reader.problem(node, "bad-value", f"{other.name} cannot say anything.", "by", remedy)
    profile.commands[lacking.name] = replace(lacking, substitute=other.name)


def _check_range(reader: Reader, node: Node) -> None:
    """Report a range without numbers in it, or of values that are not numbers."""
    low, high = reader.get(node, "low"), reader.get(node, "high")
    if low is not None and high is not None and low > high:
        reader.problem(node, "out-of-range", "low is greater than high.", "low")
    kind, limits = node.get("kind", "text"), [one for one in ("low", "high") if node.get(one)]
    if limits and kind not in ("number", "duration"):
        message = f"{limits[0]} limits numbers and durations, and the kind is {kind}."
        reader.problem(node, "exclusive", message, limits[0], 'Write kind="number".')


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
    return Motion(steps, stray) if steps else None


def _added(reader: Reader, node: Node, motion: Motion | None) -> CommandType:
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
        _check_range(reader, child)
    lasts = reader.get(node, "duration")
    if motion is not None and "duration" not in node.attributes:
        lasts = motion.duration
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
        arguments=arguments,
        lasts=max(lasts or 1, 1),
    )
