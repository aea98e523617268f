"""Scenarios, with their worlds, robots and applications."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from prima.checks.ignores import Ignores
from prima.errors import (
    DocumentError,
    Problem,
    few_guesses,
    has_errors,
    in_order,
)
from prima.loading.applications import digest
from prima.loading.files import check_path, read_file
from prima.loading.reading import Reading
from prima.markup.collecting import seldom_collected

if TYPE_CHECKING:
    from prima.sim.devices import Cast


@dataclass(slots=True)
class Loaded:
    """A scenario with everything that it names."""

    cast: Cast
    """The scenario, its documents, world and robot."""
    files: dict[str, str]
    """The files read: digests of their bytes by path."""
    problems: list[Problem] = field(default_factory=list)
    """Warnings of all these files."""


def load_scenario(path: str | Path, robot: str | Path | None = None) -> Loaded:
    """Load a scenario with its world, robot and applications.

    Args:
        path: the path of the scenario.
        robot: the path of a robot to use instead of the scenario's.

    Raises:
        DocumentError: with the problems of all files, if any is an error.
        UsageError: the scenario's file, or the robot's, cannot be read.
    """
    named = check_path("" if robot is None else robot, "robot")
    return load_text(path, read_file(path), named)


def load_text(path: str | Path, data: bytes, robot: str = "") -> Loaded:
    """Load a scenario from memory; see :func:`load_scenario`.

    Args:
        path: the file whose folder is the base of its paths; it is not read.
        data: the scenario's text.
        robot: the path of another robot than the scenario's.

    Raises:
        DocumentError: with the problems of all files, if any is an error.
    """
    return without_ignored(load_whole(Path(path), data, robot=robot))


def with_scenario(loaded: Loaded, path: str | Path, data: bytes) -> Loaded:
    """A loaded scenario with another text that names the same files.

    Raises:
        DocumentError: the text has errors.
    """
    from prima.sim.scenario import read_scenario

    scenario = read_scenario(str(path), data)
    for service, before in zip(scenario.services, loaded.cast.scenario.services, strict=True):
        for reply, old in zip(service.replies, before.replies, strict=True):
            reply.body = old.body
    for name, user in loaded.cast.scenario.users.items():
        scenario.take(name, user)
    files = {**loaded.files, Path(path).name: digest(data)}
    return Loaded(replace(loaded.cast, scenario=scenario), files, loaded.problems)


def with_robot(loaded: Loaded, data: bytes) -> Loaded:
    """A loaded scenario with another text of its robot's document.

    Raises:
        DocumentError: the text has errors.
    """
    from prima.devices.profile import read_robot

    cast = loaded.cast
    robot = read_robot(cast.robot.place.file, data)
    files = {**loaded.files, cast.scenario.robot: digest(data)}
    return Loaded(replace(cast, robot=robot), files, loaded.problems)


def seeded(loaded: Loaded, seed: int | None) -> Loaded:
    """A loaded scenario with another seed; None for its own."""
    if seed is None:
        return loaded
    scenario = replace(loaded.cast.scenario, seed=seed)
    return Loaded(replace(loaded.cast, scenario=scenario), loaded.files, loaded.problems)


def without_ignored(loaded: Loaded) -> Loaded:
    """A loaded scenario without the problems that authors ignore."""
    loaded.problems = Ignores(read_file).left(loaded.problems)
    return loaded


@few_guesses()
@seldom_collected()
def load_whole(path: Path, data: bytes, whole: bool = False, robot: str = "") -> Loaded:
    """Load a scenario; with ``whole`` also check all documents of its VoiceXML applications."""
    from prima.devices.profile import read_robot
    from prima.sim.devices import Cast
    from prima.sim.hearing import check_hearing
    from prima.sim.rehearsal import check_cast, check_names
    from prima.sim.scenario import look_at_scenario

    scenario, found = look_at_scenario(str(path), data)
    if robot:
        read_robot(robot, read_file(robot))  # what is wrong with it is not the scenario's fault
        scenario.robot = os.path.relpath(robot, path.parent)
    reading = Reading(path, {path.name: digest(data)}, [*found], whole=whole)
    reading.applications(scenario)
    reading.users(scenario)
    world, profile = reading.surroundings(scenario)
    offers = reading.offers(scenario, world) if world is not None and scenario.entrances else []
    if profile is not None:
        reading.check_commands(profile)
    reading.check_policy(scenario)
    reading.replies(scenario)
    offered = {name for _, name in offers}
    complete = len(reading.documents) == len(scenario.applications) + len(offered)
    if world is None or profile is None or not complete:
        documents = reading.documents if complete else None
        names = check_names(scenario, world, profile, documents)
        raise DocumentError(in_order([*reading.problems, *names]))
    cast = Cast(scenario, reading.documents, world, profile, offers)
    problems = in_order([*reading.problems, *check_cast(cast)])
    if not has_errors(found):
        problems = in_order([*problems, *check_hearing(cast)])
    if has_errors(problems):
        raise DocumentError(problems)
    return Loaded(cast, reading.files, problems)
