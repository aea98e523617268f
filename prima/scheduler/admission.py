"""From requested Commands to ABs in working memory (rules U1-U5, O1, E3)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from prima.errors import did_you_mean
from prima.language.arguments import check_arguments
from prima.language.commands import LONGEST_TURN_MS, TABLE_4_2, CommandType, too_long
from prima.messages import NO_DEVICES, Command, Group, Json, OpenUnit, Step
from prima.scheduler.behavior import GONE, Application, AwaitedRun, Behavior, Inside, Stream

Table = Mapping[str, CommandType]


MOST_AT_ONCE = 500
"""The maximum number of an application's Commands that may wait side by side."""


class CommandRefused(Exception):
    """A Command is refused before it enters working memory (rule E3)."""

    def __init__(self, event: str, message: str, command: Command | None) -> None:
        super().__init__(message)
        self.event = event
        self.message = message
        self.command = command


def check_command(
    command: Command, app: Application, table: Table, most: int = LONGEST_TURN_MS
) -> None:
    """Refuse a Command unknown to the rules or to this robot, and fill in defaults.

    ``most`` is how long (ms) it may keep the speaker.

    Raises:
        CommandRefused: with ``error.unsupported.TYPE`` or ``error.semantic``.
    """
    row = table.get(command.type)
    if row is None or row.substitute:
        if command.type in TABLE_4_2:
            message = f"This robot cannot do {command.type}."
            raise CommandRefused(f"error.unsupported.{command.type}", message, command)
        hint = did_you_mean(command.type, table)
        raise CommandRefused(
            "error.semantic", f'No Command "{command.type}". {hint}'.rstrip(), command
        )
    if command.extra and app.kind == "ea":
        message = f"Only an FA may give {command.type} additional arguments."
        raise CommandRefused("error.semantic", message, command)
    for name in command.extra:
        if name not in row.extra:
            message = f'{command.type} has no additional argument "{name}" on this robot.'
            raise CommandRefused("error.semantic", message, command)
    try:
        command.args = dict(check_arguments(row, command.text, command.args))
    except ValueError as error:
        raise CommandRefused("error.semantic", str(error), command) from None
    if problem := too_long(len(command.text or ""), silence(command), most):
        raise CommandRefused(
            "error.semantic", f"{problem} Divide it, or shorten its pauses and timeout.", command
        )
    command.now = command.now or row.now


def silence(command: Command) -> float:
    """How long (ms) a Command keeps the speaker silent: its pauses and a question's timeout."""
    if command.text is None and command.type != "q-and-a":
        return 0
    times: list[Json] = [cue.value for cue in command.cues if cue.kind in ("pause", "lasts")]
    if command.type == "q-and-a":
        times.append(command.args["timeout"])
    return sum(time for time in times if isinstance(time, int | float))


def substitute(steps: list[Step], table: Table) -> list[Command]:
    """X6: substitute other Commands for those that the robot lacks; returns them."""
    made = []
    for command in commands_of(steps):
        row = table.get(command.type)
        if row is not None and row.substitute:
            command.replaces, command.type = command.type, row.substitute
            made.append(command)
    return made


def check_steps(
    steps: list[Step],
    app: Application,
    table: Table,
    owned: frozenset[str] | None = None,
    most: int = LONGEST_TURN_MS,
) -> None:
    """Check all Commands of a request before accepting any of them.

    ``owned`` are the devices of the unit in which they are requested, if any (U5); ``most`` is
    how long (ms) each may keep the speaker.

    Raises:
        CommandRefused: for the first invalid one.
    """
    for command in commands_of(steps):
        check_command(command, app, table, most)
    check_units(steps, table, owned)


def check_number(steps: list[Step], waiting: int) -> None:
    """E3: refuse requests that let too many Commands wait at once, as each is ranked repeatedly.

    Args:
        steps: the request; the largest number of its steps beside one another counts.
        waiting: how many of the application's Commands are already waiting.

    Raises:
        CommandRefused: there are more than :data:`MOST_AT_ONCE`.
    """
    if waiting + _width(steps) > MOST_AT_ONCE:
        message = f"At most {MOST_AT_ONCE} Commands of an application wait beside one another."
        raise CommandRefused("error.semantic", message, next(commands_of(steps), None))


def _width(steps: list[Step]) -> int:
    """The largest number of steps none of which follows another.

    It is the number of chains that cover them (Dilworth): a step continues the latest chain
    whose end comes before it. Sets of steps are the bits of an integer.
    """
    ends = 0
    before: dict[int, int] = {}
    last = {above: index for index, step in enumerate(steps) for above in step.after}
    for index, step in enumerate(steps):
        all_before = 0
        for above in step.after:
            all_before |= before[above] | 1 << above
        for above in step.after:
            if last[above] == index:
                before.pop(above, None)
        if index in last:
            before[index] = all_before & ends
        if free := ends & all_before:
            ends ^= 1 << (free.bit_length() - 1)
        ends |= 1 << index
    return ends.bit_count()


def commands_of(steps: list[Step]) -> Iterator[Command]:
    """All Commands of a request, those of its units as well."""
    for step in steps:
        if isinstance(step.what, Group):
            yield from commands_of(step.what.steps)
        else:
            yield step.what


def check_units(steps: list[Step], table: Table, owned: frozenset[str] | None) -> None:
    """U4, U5: check what is inside units; ``owned`` are the devices of the one around them.

    Raises:
        CommandRefused: for the first invalid Command.
    """
    for step in steps:
        if isinstance(step.what, Group):
            inner = group_devices(step.what, table) if owned is None else owned
            check_units(step.what.steps, table, inner)
        elif owned is not None:
            check_in_unit(step.what, table[step.what.type], owned)


def check_in_unit(command: Command, row: CommandType, owned: frozenset[str]) -> None:
    """U4, U5: refuse Commands in a unit that cannot be part of one or need a device it lacks.

    Raises:
        CommandRefused: with ``error.semantic``.
    """
    if row.feedback or row.leaves:
        what = "works in loops" if row.feedback else "leaves the user"
        message = f"{row.name} cannot be part of a unit: it {what}."
        raise CommandRefused("error.semantic", message, command)
    lacking = sorted(row.occupied(command.text) - owned)
    if lacking:
        message = f"{row.name} needs {', '.join(lacking)}, which its unit does not own."
        raise CommandRefused("error.semantic", message, command)


def group_devices(group: Group, table: Table) -> frozenset[str]:
    """All devices of a unit's Commands, of every branch (rule U4)."""
    occupied = (table[one.type].occupied(one.text) for one in commands_of(group.steps))
    return NO_DEVICES.union(*occupied)


def occupied_by(what: Command | Group, table: Table) -> frozenset[str]:
    """The devices that an AB occupies (U1, U4)."""
    if isinstance(what, Group):
        return group_devices(what, table)
    return table[what.type].occupied(what.text)


class Maker:
    """Makes ABs and streams, and assigns their names and serial numbers."""

    def __init__(self, table: Table, composing: bool) -> None:
        self.table = table
        self.composing = composing
        """Whether motions may be composed (X5)."""
        self.serial = 0
        # By application's name: one that is loaded again does not reuse names.
        self._behaviors: dict[str, int] = {}
        self._streams: dict[str, int] = {}

    def stream(self, app: Application) -> Stream:
        """A new stream of the application."""
        number = self._streams[app.name] = self._streams.get(app.name, 0) + 1
        return Stream(f"{app.name}:{number}", app)

    def behavior(
        self,
        app: Application,
        stream: Stream,
        what: Command | Group,
        now: int,
        state: int,
        run: AwaitedRun | None = None,
        unit: Behavior | None = None,
    ) -> Behavior:
        """One AB for a Command (U1) or for a group of them (U4)."""
        self.serial += 1
        number = self._behaviors[app.name] = self._behaviors.get(app.name, 0) + 1
        name, serial = f"{app.name}#{number}", self.serial
        devices = occupied_by(what, self.table)
        if isinstance(what, Group):
            made = Behavior(name, serial, app, stream, None, None, devices, now, state)
            made.group, made.inside = what, Inside()
        else:
            row = self.table[what.type]
            made = Behavior(name, serial, app, stream, row, what, devices, now, state)
            made.motion = row.motion if self.composing and unit is None else ""
        made.run, made.unit = run, unit
        return made

    def spanning(self, app: Application, stream: Stream, asked: OpenUnit, now: int) -> Behavior:
        """The AB of a unit that spans questions and states (U5)."""
        unit = self.behavior(app, stream, Group([], asked.longest, asked.source), now, asked.state)
        unit.devices = asked.devices
        unit.inside = Inside(spans=True, open=True)
        return unit

    def chain(
        self,
        app: Application,
        stream: Stream,
        steps: list[Step],
        now: int,
        state: int,
        run: AwaitedRun | None,
        unit: Behavior | None,
    ) -> list[Behavior]:
        """The ABs of steps, linked as they say; roots wait for nothing yet."""
        made: list[Behavior] = []
        for step in steps:
            ab = self.behavior(app, stream, step.what, now, state, run, unit)
            for index in step.after:
                link(made[index], ab)
            made.append(ab)
        return made


def link(parent: Behavior, child: Behavior) -> None:
    """Make ``child`` wait for ``parent``; the last one linked is its parent (U3)."""
    child.waits_for.add(parent.name)
    child.parent = parent.id
    parent.children.append(child)


def parent_in(unit: Behavior) -> Behavior | None:
    """O1, U5: the latest Command requested in a unit, if it is still in working memory."""
    latest = unit.inside.latest if unit.inside is not None else None
    return latest if latest is not None and latest.state is not GONE else None
