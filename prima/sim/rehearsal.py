"""A rehearsal: a scenario run in virtual time; and checks that its parts fit together."""

from __future__ import annotations

from itertools import chain

from prima.devices.loop import Loop
from prima.devices.profile import Profile
from prima.devices.reading import unknown_name
from prima.errors import DocumentError, Problem
from prima.interpreter.elements import Document
from prima.language.commands import TABLE_4_2
from prima.scheduler.policy import Policy
from prima.session import AnyDocument, Session
from prima.sim.devices import Cast, SimulatedDevices
from prima.sim.expected import check_expectations
from prima.sim.map import Map
from prima.sim.scenario import Scenario
from prima.sim.services import Web
from prima.sim.vocabulary.scenario import NAMING_APPLICATIONS


def check_names(
    scenario: Scenario,
    world: Map | None,
    robot: Profile | None,
    documents: list[AnyDocument] | None,
) -> list[Problem]:
    """Names in a scenario that are unknown to its world, robot and applications.

    What could not be read is None: its names are not checked.
    """
    problems: list[Problem] = []
    known: dict[tuple[str, str], tuple[set[str] | None, str]] = {}
    if world is not None:
        points = set(world.places) | set(world.things)
        known["robot", "at"] = set(world.places), "place"
        known["person", "at"] = known["walk", "to"] = points, "place or thing"
        known["look", "at"] = points | {"robot"}, "place or thing"
    if robot is not None:
        known["touch", "sensor"] = set(robot.touch), "touch sensor"
        known["fail", "device"] = known["repair", "device"] = set(robot.devices), "device"
        commands = {*robot.commands, *TABLE_4_2}  # those it cannot do are warnings
        known["when", "doing"] = known["when", "done"] = commands, "Command"
    if documents is not None:
        ids = {document.id for document in documents}
        for tag, name in NAMING_APPLICATIONS:
            known[tag, name] = ids, "application"
    nodes = (scenario.node, *(user.node for user in scenario.users.values()))
    for node in chain.from_iterable(one.walk() for one in nodes):
        for name in node.attributes:
            words, what = known.get((node.tag, name), (None, ""))
            if words is not None:
                problems += unknown_name(node, name, words, f"There is no {what}")
    return problems


def check_cast(cast: Cast) -> list[Problem]:
    """The problems of a scenario together with its world, robot and applications."""
    scenario = cast.scenario
    problems = check_names(scenario, cast.world, cast.robot, cast.documents)
    seen: set[str] = set()
    nodes = [node for _, _, node in scenario.applications]
    nodes += {name: area.node for area, name in reversed(cast.offers)}.values()
    for node, document in zip(nodes, cast.documents, strict=True):
        if document.id in seen:
            message = f'Two applications have the id "{document.id}".'
            own = isinstance(document, Document)
            remedy = "Change the id in one of the documents" if own else 'Give one another id="..."'
            remedy += ", or remove this one."
            problems.append(Problem(node.place, "error", "duplicate-id", message, remedy))
        seen.add(document.id)
    return problems + check_expectations(scenario, cast.documents, cast.robot)


def make_session(
    cast: Cast, policy: Policy, bound: int | None, isolate: str, patience: int | None
) -> Session:
    """The session of a run.

    Raises:
        DocumentError: scenario, world, robot and applications do not go together.
    """
    if problems := check_cast(cast):
        raise DocumentError(problems)
    scenario = cast.scenario
    return Session(
        cast.documents,
        policy,
        cast.robot.commands,
        bound,
        scenario.date,
        absence=cast.robot.absence,
        isolate=isolate,
        patience=scenario.patience if patience is None else patience,
    )


class Rehearsal(Loop):
    """One run of a scenario in virtual time: it jumps to whatever is due next.

    Raises:
        DocumentError: scenario, world, robot and applications do not go together.
    """

    devices: SimulatedDevices

    def __init__(
        self,
        cast: Cast,
        policy: Policy,
        bound: int | None = None,
        web: Web | None = None,
        isolate: str = "ea",
        patience: int | None = None,
    ) -> None:
        session = make_session(cast, policy, bound, isolate, patience)
        devices = SimulatedDevices(cast, web, policy.exclusive)
        super().__init__(session, devices, cast.scenario.until)
