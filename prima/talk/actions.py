"""Typed actions: read and checked as those of a scenario."""

from __future__ import annotations

from dataclasses import dataclass, replace

from prima.errors import DocumentError, Problem, UsageError
from prima.interpreter.elements import Document
from prima.interpreter.events import KnownEvents
from prima.sim.devices import Cast
from prima.sim.happenings import Doing
from prima.sim.hearing import check_hearing
from prima.sim.rehearsal import Rehearsal, check_cast
from prima.sim.scenario import Scenario, read_scenario
from prima.talk.scene import Scene, when
from prima.talk.typed import TypedLine, TypedNames

FILE = "typed"
"""The file name under which typed lines are read as a scenario."""
MOVES = ("walk", "follow", "stay", "leave")
"""Actions for which the user must be present."""


@dataclass(frozen=True, slots=True)
class Played:
    """An action of the user: its time (ms), elements, and the row before it."""

    at: int
    xml: str
    doings: list[Doing]
    after: str


def doings_of(line: TypedLine, scene: Scene, cast: Cast) -> list[Doing]:
    """The actions of a line, read and checked as a scenario's ``when``.

    Raises:
        UsageError: they are wrong.
    """
    scenario = scenario_of(scene, [when(0, line.xml)])
    made = replace(cast, scenario=scenario)
    last = scenario.node.all("when")[-1].place.line
    found = [*check_cast(made), *check_hearing(made)]
    problems = [one for one in found if one.place.file == FILE and one.place.line == last]
    if problems:
        raise UsageError(message_of(problems[0]))
    return [one for one in scenario.whens if one.trigger == "at"][-1].doings


def scenario_of(scene: Scene, whens: list[str]) -> Scenario:
    """The scene as a scenario, with these actions.

    Raises:
        UsageError: they are wrong.
    """
    try:
        return read_scenario(FILE, scene.text(whens).encode())
    except DocumentError as error:
        raise UsageError(message_of(error.problems[0])) from None


def message_of(problem: Problem) -> str:
    """A problem of a line, as a message."""
    return f"{problem.message} {problem.remedy}".rstrip()


def check_there(rehearsal: Rehearsal, doings: list[Doing]) -> None:
    """Check that the user, and the application to load or unload, are there.

    Raises:
        UsageError: they are not.
    """
    if not rehearsal.devices.people.there:
        for doing in doings:
            if doing.name in MOVES:
                raise UsageError(f'Nobody is there to do "/{doing.name}".')
    _check_loaded(rehearsal, doings[0])


def _check_loaded(rehearsal: Rehearsal, doing: Doing) -> None:
    app = rehearsal.session.apps.get(doing.values.get("application", ""))
    if app is None:
        return
    loaded = app.name in rehearsal.session.mediator.memory.apps and not app.over
    if doing.name == "load" and loaded:
        raise UsageError(f'"{app.name}" is already loaded. Remove it with /unload.')
    if doing.name == "unload" and not loaded:
        raise UsageError(f'"{app.name}" is not loaded. Load it with /load.')


def names_of(cast: Cast) -> TypedNames:
    """The names that typed lines may use."""
    events = [KnownEvents(one) for one in cast.documents if isinstance(one, Document)]
    return TypedNames(
        sensors=frozenset(cast.robot.touch),
        points=frozenset(cast.world.places) | frozenset(cast.world.things),
        devices=frozenset(cast.robot.devices),
        applications=frozenset(doc.id for doc in cast.documents),
        events=frozenset(name for one in events for name in one.heard if name),
    )
