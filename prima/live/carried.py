"""Which driver carries out a goal, and what to write if none does."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import deepcopy
from dataclasses import replace

from prima.devices import voice
from prima.devices.goals import LISTEN, RECORD, SAY, Begin
from prima.devices.profile import Profile
from prima.devices.settings import DriverLimits
from prima.errors import Problem, few
from prima.errors.diagnoses.names import UNSUPPORTED_COMMAND
from prima.interpreter.acts import CommandTemplate
from prima.interpreter.elements import Document, document_commands
from prima.live.driver import Driver
from prima.messages import Command, Json
from prima.session import AnyDocument

UNCARRIED = UNSUPPORTED_COMMAND.says("{what}: {lacking}.")
SPEECH_MS = 5_000
"""How much longer than twice its expected time a text may take."""
SPOKEN = ("pause", "speak", "q-and-a")
"""Commands that move nothing."""


def route(drivers: Sequence[Driver], goal: Begin) -> Driver | None:
    """The driver of a goal: the one that specifies how, else the first with one of its devices."""
    there = [one for one in drivers if one.settings.devices & goal.devices]
    how = (one for one in there if one.does(goal) is not None)
    able = (one for one in there if not one.mapped or goal.kind in one.own)
    return next(how, None) or next(able, None)


def own_copy(goal: Begin) -> Begin:
    """A goal whose arguments a driver may change: those of the Command itself are the run's."""
    return replace(goal, command=replace(goal.command, args=deepcopy(goal.command.args)))


def lacking(drivers: Sequence[Driver], goal: Begin) -> str:
    """The reason why the robot cannot carry out a goal, from its document; empty if it can."""
    if route(drivers, goal) is not None:
        return ""
    if goal.kind == RECORD:
        return "no driver records"
    if not any(one.settings.devices & goal.devices for one in drivers):
        names = " ".join(sorted(goal.devices))
        return f'no driver carries it out: write devices="{names}" into a <driver>'
    gesture = str(goal.command.args.get("name", "")) if goal.kind == "gesture" else ""
    which = f'gesture="{gesture}"' if gesture else f'command="{goal.kind}"'
    return f"no driver carries it out: write <does {which} ...> in a <driver>"


def limits_of(drivers: Sequence[Driver], goal: Begin, rates: dict[str, float]) -> DriverLimits:
    """How long a goal's driver may take: as the document says, or else by the kind of goal."""
    driver = route(drivers, goal)
    if driver is None:
        return DriverLimits()
    does = driver.does(goal)
    said = does.limits.over(driver.settings.limits) if does else driver.settings.limits
    if goal.kind in (LISTEN, RECORD):
        return DriverLimits(said.accept, None, said.cancel)
    if goal.kind == SAY and said.progress is None:
        command = goal.command
        lasts = voice.duration(command.text or "", command.lang, rates)
        return DriverLimits(said.accept, 2 * lasts + SPEECH_MS, said.cancel)
    return said


def uncarried(
    robot: Profile, drivers: Sequence[Driver], documents: Iterable[AnyDocument]
) -> list[Problem]:
    """Warnings about documents' Commands that the robot has but none of its drivers carries out."""
    found = []
    for document in documents:
        commands = document_commands(document) if isinstance(document, Document) else ()
        for command in commands:
            goal = _goal(robot, command)
            if goal is not None and (why := lacking(drivers, goal)):
                what = " ".join([goal.kind, *map(str, goal.command.args.values())])
                found.append(UNCARRIED.at(command.node.place, what=what, lacking=why))
    return few(found, 1)


def _goal(robot: Profile, command: CommandTemplate) -> Begin | None:
    """The goal for a driver, as far as the document determines it; None for mere speech."""
    row = robot.commands.get(command.type)
    if row is None or row.substitute or row.name in SPOKEN:
        return None
    name = command.args.get("name") if row.name == "gesture" else None
    args: dict[str, Json] = {"name": name} if isinstance(name, str) else {}
    if args and name not in robot.gestures:
        return None  # that is already reported
    return Begin("", row.name, Command(row.name, args), row.devices)
