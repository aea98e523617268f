"""Commands of a document that a robot lacks, or supports differently."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from prima.errors import Hint, Problem, few, suggestion
from prima.errors.diagnoses.names import NO_SUCH_ARGUMENT, UNSUPPORTED_COMMAND
from prima.interpreter.acts import CommandTemplate, run_commands
from prima.interpreter.checks.arguments import given_to
from prima.interpreter.elements import Acts, Document, Field, document_commands
from prima.interpreter.elements import Unit as ItemUnit
from prima.interpreter.events import groups_of, handlers_of, items_of
from prima.interpreter.selection import prefixes
from prima.interpreter.units import QUESTION, Finder, Reached, unit_problem, units_of
from prima.language.commands import TABLE_4_2, CommandType
from prima.markup.spans import value_span
from prima.markup.tree import Node

NO_COMMAND = UNSUPPORTED_COMMAND.says(
    'This robot has no Command "{command}".',
    "Add it to the robot's document, or name another.",
    "error",
)
CANNOT = UNSUPPORTED_COMMAND.says(
    "This robot cannot do {command}{lacks}. At run time it is {event}.{substitute}",
    'Handle it: <{handler} event="{event}">.',
)
CANNOT_HANDLED = UNSUPPORTED_COMMAND.says(CANNOT.message)
NO_ARGUMENT = NO_SUCH_ARGUMENT.says(
    'This robot\'s {command} has no additional argument "{name}".',
    'Remove it, or write <allows command="{command}" argument="{name}"/> for the robot.',
)


def check_commands(
    document: Document, commands: Mapping[str, CommandType], devices: frozenset[str] = frozenset()
) -> list[Problem]:
    """Warn of Commands that a robot cannot carry out: a document may handle the failure."""
    acts = Acts(document)
    problems = _outside_units(document, acts, commands)
    heard = {name for handler in handlers_of(document, acts) for name in handler.events}
    robot = Ability(commands, devices, heard)
    cannot: list[Problem] = []
    for command in [one for one in document_commands(document) if one.type]:
        row = commands.get(command.type)
        if row is None or row.substitute:
            cannot.append(robot.problem(command.node, command.type))
        else:
            problems += _arguments(command, row)
    if robot.lacks(QUESTION):
        cannot += [
            robot.problem(item.node, QUESTION)
            for item in items_of(document)
            if isinstance(item, Field)
        ]
    return problems + few(cannot, 1)


@dataclass(frozen=True, slots=True)
class Ability:
    """What a robot can carry out of a document.

    Args:
        commands: the rows of its Commands.
        devices: its devices; empty if unknown.
        heard: the events that the document handles.
        handler: the element that handles an event, in the document's language.
    """

    commands: Mapping[str, CommandType]
    devices: frozenset[str]
    heard: set[str]
    handler: str = "on"

    def lacks(self, name: str) -> bool:
        """Whether the robot lacks a Command, or has only a substitute for it (x6)."""
        row = self.commands.get(name)
        return row is None or bool(row.substitute)

    def problem(self, node: Node, name: str) -> Problem:
        """The problem of an element that asks for a Command that the robot lacks."""
        if name not in TABLE_4_2:
            hint = suggestion(name, self.commands, *value_span(node, "type"))
            return NO_COMMAND.at(node.place, hint, command=name)
        row = self.commands.get(name)
        lacking = sorted(TABLE_4_2[name].devices - self.devices) if self.devices else []
        event = f"error.unsupported.{name}"
        takes_place = f" With the extension x6 {row.substitute} takes its place." if row else ""
        handled = not self.heard.isdisjoint(prefixes(event))
        return (CANNOT_HANDLED if handled else CANNOT).at(
            node.place,
            command=name,
            lacks=f": it lacks {', '.join(lacking)}" if lacking else "",
            event=event,
            substitute=takes_place,
            handler=self.handler,
        )


def _arguments(command: CommandTemplate, row: CommandType) -> Iterator[Problem]:
    """The problems of arguments of a Command that only a robot's profile defines."""
    by_params = command.node.tag == "command"  # arguments of others are attributes, checked already
    for name, _ in command.extra:
        if name and name not in row.extra and not (by_params and name in row.arguments):
            yield _no_argument(command, row, name, by_params)
    if by_params:
        given = dict(command.extra)
        yield from given_to(command.node, row, given, bool(command.text))


def _no_argument(command: CommandTemplate, row: CommandType, name: str, by_params: bool) -> Problem:
    params = [one for one in command.node.all("param") if one.get("name") == name]
    spans = [span for one in params[:1] for span in value_span(one, "name")]
    hint = suggestion(name, row.extra | set(row.arguments if by_params else ()), *spans)
    if name in row.arguments and not by_params:
        hint = Hint(f"Write it as the attribute {name} of <{command.node.tag}>.")
    return NO_ARGUMENT.at(command.node.place, hint, command=command.type, name=name)


def _outside_units(
    document: Document, acts: Acts, commands: Mapping[str, CommandType]
) -> list[Problem]:
    """U4, U5: Commands of the profile's own that cannot be part of a unit."""
    problems: dict[int, Problem] = {}

    def look(one: Reached, unit: ItemUnit | None = None) -> None:
        problem = unit_problem(one, _own_row(one.command, commands), unit)
        if problem is not None:
            problems.setdefault(id(one.command), problem)

    finder = Finder(document)
    for form, unit in units_of(document):
        for one in finder.reach(form, unit).commands:
            look(one, unit)
    for group in groups_of(acts):
        for command in run_commands(group.steps):
            look(Reached(command, True))
    return [*problems.values()]


def _own_row(command: CommandTemplate, commands: Mapping[str, CommandType]) -> CommandType | None:
    """The row of a Command that a robot's profile adds."""
    return None if command.type in TABLE_4_2 else commands.get(command.type)
