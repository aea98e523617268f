"""A scenario's text, and the values in it that a run changes."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path, PurePath
from typing import NamedTuple

from prima.devices.vocabulary.robot import ROBOT
from prima.errors import DocumentError, UsageError, has_errors
from prima.loading.files import read_file
from prima.markup.edits import TextEdit, edited, set_attribute
from prima.markup.reader import read_tree
from prima.markup.tree import Node
from prima.sim.paths import ScenarioValue, find
from prima.sim.scenario import look_at_scenario
from prima.sim.vocabulary.scenario import SCENARIO


class Variant(NamedTuple):
    """One run: its scenario, its policy, and the varied values."""

    number: int
    scenario: int
    policy: str
    """Empty for the scenario's own."""
    seed: int
    """The run's seed; 0 for the scenario's own."""
    values: tuple[str, ...]


class ScenarioText:
    """A scenario's text, and the values in it that are varied."""

    def __init__(self, path: str, data: bytes, paths: Sequence[str]) -> None:
        """Read a scenario.

        Raises:
            DocumentError: it has errors.
            UsageError: a path does not exist in it.
        """
        self.path = path
        scenario, problems = look_at_scenario(path, data)
        if has_errors(problems):
            raise DocumentError(problems)
        self.root = scenario.node
        self.policy = scenario.policy
        try:
            self.targets = [find(self.root, one, lambda: self.robot) for one in paths]
        except UsageError as error:
            raise UsageError(f"{path}: {error}") from None
        self._check_apart()
        users = [one for one in self.root.all("person") if "user" in one.attributes]
        self._drawn = "seed" not in paths and (
            scenario.draws.any
            or bool(users)
            or any(one.attribute and one.attribute.name == "user" for one in self.targets)
        )

    @cached_property
    def robot(self) -> Node:
        """The robot's document.

        Raises:
            DocumentError: it is not a robot's document.
            UsageError: it cannot be read.
        """
        path = os.path.normpath(os.path.join(os.path.dirname(self.path), self.root.get("robot")))
        root, problems = read_tree(path, read_file(path), ROBOT)
        if has_errors(problems):
            raise DocumentError(problems)
        return root

    def _check_apart(self) -> None:
        """Reject two paths to one value, and another robot with changes to the one it replaces."""
        seen: dict[tuple[bool, int, str], str] = {}
        for target in self.targets:
            name = target.attribute.name if target.attribute else ""
            key = target.of_robot, target.node.index, name
            if key in seen:
                raise UsageError(f'"{seen[key]}" and "{target.path}" are the same value.')
            seen[key] = target.path
        changed = next((one.path for one in self.targets if one.of_robot), None)
        if changed and (False, self.root.index, "robot") in seen:
            message = f'"{changed}" is a value of one robot, and "robot" names others.'
            raise UsageError(f"{message} Vary one of the two.")

    def _changed(self, variant: Variant) -> Iterator[tuple[ScenarioValue, str]]:
        """The values that a run changes."""
        pairs = zip(self.targets, variant.values, strict=True)
        return ((one, value) for one, value in pairs if value != one.as_it_is)

    def text(self, variant: Variant) -> bytes:
        """The scenario of a run."""
        changed = self._changed(variant)
        edits = [one.edit(value) for one, value in changed if not one.of_robot]
        return edited(self.root.source.text, [*edits, *self._seeded(variant)])

    def robot_text(self, variant: Variant) -> bytes | None:
        """The robot's document of a run; None if it is unchanged."""
        edits = [one.edit(value) for one, value in self._changed(variant) if one.of_robot]
        return edited(self.robot.source.text, edits) if edits else None

    def _seeded(self, variant: Variant) -> list[TextEdit]:
        """The edit that sets a run's seed, if anything is random."""
        if not (self._drawn and variant.seed):
            return []
        return [set_attribute(self.root, "seed", str(variant.seed))]

    def moved(self, variant: Variant, folder: Path, robot: Path | None = None) -> bytes:
        """The scenario of a run with its policy, as a file of another folder.

        ``robot`` is another document of its robot.
        """
        changed = [one for one in self._changed(variant) if not one[0].of_robot]
        files = {
            (one.node.index, one.attribute.name): value
            for one, value in changed
            if one.attribute and one.kind == "path"
        }
        if robot:
            files[self.root.index, "robot"] = str(robot.absolute())
        edits = [one.edit(value) for one, value in changed if one.kind != "path" or not value]
        edits += self._seeded(variant)
        if variant.policy:
            edits.append(set_attribute(self.root, "policy", variant.policy))
        edits += self._files_from(folder, files)
        return edited(self.root.source.text, edits)

    def _files_from(
        self, folder: Path, varied: Mapping[tuple[int, str], str]
    ) -> Iterator[TextEdit]:
        """Edits that make all file names relative to another folder.

        ``varied`` has the files that a run uses instead of those written, by element and attribute.
        """
        here = os.path.dirname(os.path.abspath(self.path))
        for node in self.root.walk():
            for item in SCENARIO.elements[node.key].attributes:
                value = varied.get((node.index, item.name), node.get(item.name))
                if item.kind == "path" and value:
                    beside = os.path.relpath(os.path.join(here, value), folder.absolute())
                    yield set_attribute(node, item.name, PurePath(beside).as_posix())
