"""Runs of scenarios whose values are varied, from content alone: no file is read.

A :class:`Stage` can be sent to another process, or machine, and makes runs there.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from prima import api
from prima.devices.vocabulary.robot import ROBOT
from prima.errors import TOO_MUCH, DocumentError, PrimaError, Problem, UsageError, has_errors
from prima.errors.visible import visible
from prima.interpreter.elements import Document
from prima.loading import Loaded, load_text, with_robot, with_scenario
from prima.loading.files import Files, GivenFiles, in_place_of_files, read_file, read_head
from prima.loading.writing import write_whole
from prima.markup.edits import TextEdit, edited, set_attribute
from prima.markup.limits import LIMITS
from prima.markup.reader import read_tree
from prima.markup.tree import Node
from prima.messages import Json
from prima.sim.paths import ScenarioValue, find
from prima.sim.scenario import look_at_scenario
from prima.sim.vocabulary.scenario import SCENARIO
from prima.testing.checking import Failure, check
from prima.testing.facts import make_run
from prima.testing.tracing import states_of
from prima.transcript.criteria import Criteria
from prima.transcript.row import Row
from prima.voicexml.recordings import length_ms

MOST_LOADED = 64
"""Combinations of documents, worlds and robots that are kept loaded."""
MOST_SENT = 64_000_000
"""Bytes of documents that are sent to a cluster."""
MOST_FILES = 1_000
"""Files of the folders of VoiceXML applications that are sent to a cluster."""
MOST_MESSAGE = 1_000
"""Characters of a run's messages."""
CRITERIA = [one.name for one in fields(Criteria) if one.name != "delays"]


class Variant(NamedTuple):
    """One run: which scenario, its policy, and the values of what is varied."""

    number: int
    scenario: int
    policy: str
    """Empty for the scenario's own."""
    seed: int
    """By which the run is drawn; 0 for the scenario's own."""
    values: tuple[str, ...]


@dataclass(slots=True)
class Made:
    """What came of a run."""

    exit: int = 0
    """0 fine; 1 documents have errors; 2 unreadable input; 3 an error or a limit."""
    ended: str = ""
    failures: str = ""
    expects_failed: int = 0
    order: str = ""
    """The signature of its rows without their times; empty if there is no run."""
    measures: dict[str, Json] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class ExperimentSettings:
    """What holds for all runs of an experiment."""

    bound: int | None = None
    patience: int | None = None
    isolate: str = "ea"
    limits: Mapping[str, int] = field(default_factory=lambda: asdict(LIMITS))


class ScenarioText:
    """A scenario as it is written, and the values in it that are varied."""

    def __init__(self, path: str, data: bytes, paths: Sequence[str]) -> None:
        """Read a scenario.

        Raises:
            DocumentError: it has errors.
            UsageError: a path means nothing in it.
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
            DocumentError: it is no robot's document.
            UsageError: it cannot be read.
        """
        path = os.path.normpath(os.path.join(os.path.dirname(self.path), self.root.get("robot")))
        root, problems = read_tree(path, read_file(path), ROBOT)
        if has_errors(problems):
            raise DocumentError(problems)
        return root

    def _check_apart(self) -> None:
        """Refuse two paths of one value, and another robot beside changes of the one it replaces."""
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
        return ((one, value) for one, value in pairs if value != one.written)

    def text(self, variant: Variant) -> bytes:
        """The scenario of a run."""
        changed = self._changed(variant)
        edits = [one.edit(value) for one, value in changed if not one.of_robot]
        return edited(self.root.source.text, [*edits, *self._seeded(variant)])

    def robot_text(self, variant: Variant) -> bytes | None:
        """The robot's document of a run; None if it is as it is written."""
        edits = [one.edit(value) for one, value in self._changed(variant) if one.of_robot]
        return edited(self.robot.source.text, edits) if edits else None

    def _seeded(self, variant: Variant) -> list[TextEdit]:
        """The edit that lets a run be drawn by its seed, if anything is drawn."""
        if not (self._drawn and variant.seed):
            return []
        return [set_attribute(self.root, "seed", str(variant.seed))]

    def moved(self, variant: Variant, folder: Path, robot: Path | None = None) -> bytes:
        """The scenario of a run with its policy, as a file of another folder.

        Args:
            variant: the run.
            folder: the folder.
            robot: another document of the robot.
        """
        changed = [one for one in self._changed(variant) if not one[0].of_robot]
        files = {
            (one.node.index, one.attribute.name): value
            for one, value in changed
            if one.attribute and one.kind == "path"
        }
        if robot:
            files[self.root.index, "robot"] = str(robot.absolute())
        edits = [one.edit(value) for one, value in changed if one.kind != "path"]
        edits += self._seeded(variant)
        if variant.policy:
            edits.append(set_attribute(self.root, "policy", variant.policy))
        edits += self._files_from(folder, files)
        return edited(self.root.source.text, edits)

    def _files_from(
        self, folder: Path, varied: Mapping[tuple[int, str], str]
    ) -> Iterator[TextEdit]:
        """Edits by which all files are named as seen from another folder.

        Args:
            folder: the other folder.
            varied: the files that a run has in place of those written, by element and attribute.
        """
        here = os.path.dirname(os.path.abspath(self.path))
        for node in self.root.walk():
            for item in SCENARIO.elements[node.key].attributes:
                value = varied.get((node.index, item.name), node.get(item.name))
                if item.kind == "path" and value:
                    beside = os.path.relpath(os.path.join(here, value), folder.absolute())
                    yield set_attribute(node, item.name, PurePath(beside).as_posix())


class Kept:
    """Keeps the content of every file that is read while it is in place."""

    def __init__(self) -> None:
        self.folder = os.getcwd()
        self.texts: dict[Path, bytes] = {}
        self.heads: dict[Path, tuple[bytes, int]] = {}

    def text(self, path: Path) -> bytes | None:
        """The content of a file as it was first read."""
        if path not in self.texts:
            try:
                with path.open("rb") as stream:
                    self.texts[path] = stream.read(LIMITS.bytes + 1)
            except OSError:
                return None
        return self.texts[path]

    def head(self, path: Path) -> tuple[bytes, int] | None:
        """The first bytes of a file and its size as they were first."""
        if path not in self.heads:
            try:
                self.heads[path] = read_head(path)
            except OSError:
                return None
        return self.heads[path]

    def keep(self, folder: str) -> None:
        """Keep all files of a folder; of sounds only their heads.

        A link that leads out of the folder is none of its files: an application may not read it.

        Raises:
            UsageError: they are too many or too large.
        """
        held, root = sum(map(len, self.texts.values())), Path(self.folder, folder)
        for path in sorted(root.rglob("*")):
            inside = path.is_file() and path.resolve().is_relative_to(root.resolve())
            if inside and (head := self.head(path)):
                if length_ms(*head) is None:
                    held += len(self.text(path) or b"")
                if held > MOST_SENT or len(self.heads) > MOST_FILES:
                    raise UsageError(
                        f"{folder}: a cluster needs the files that an application may name,"
                        f" and its folder has more than {MOST_SENT // 1_000_000} MB of them,"
                        f" or more than {MOST_FILES:,}. Keep it in a folder of its own."
                    )

    @contextmanager
    def beside(self, files: Mapping[Path, bytes]) -> Iterator[None]:
        """Let files that are still to be written count as if they were there."""
        added = {path.absolute(): data for path, data in files.items()}
        self.texts |= added
        try:
            yield
        finally:
            for path in added:
                del self.texts[path]

    def contents(self) -> GivenFiles:
        """What was read, for another process."""
        return GivenFiles(self.texts, self.heads, self.folder)


class Stage:
    """Scenarios with all that they name, and what of them is varied; it makes runs."""

    def __init__(
        self,
        scenarios: Sequence[tuple[str, bytes]],
        paths: Sequence[str],
        settings: ExperimentSettings,
    ) -> None:
        self.scenarios = list(scenarios)
        self.paths = list(paths)
        self.settings = settings
        self.files: Files = Kept()

    @classmethod
    def of(cls, names: Sequence[str], paths: Sequence[str], settings: ExperimentSettings) -> Stage:
        """Read scenarios.

        Raises:
            DocumentError: one has errors.
            UsageError: one cannot be read, or a path means nothing in it.
        """
        made = cls([(name, read_file(name)) for name in names], paths, settings)
        for index in range(len(names)):
            made.loaded(Variant(0, index, "", 0, tuple(one.written for one in made.targets(index))))
        return made

    def __getstate__(self) -> dict[str, Any]:
        files = self.files.contents() if isinstance(self.files, Kept) else self.files
        return {
            "scenarios": self.scenarios,
            "paths": self.paths,
            "settings": self.settings,
            "files": files,
        }

    def pack(self) -> None:
        """Read the folders of all VoiceXML applications, as a run may name any of their files.

        Raises:
            UsageError: they hold too much.
        """
        assert isinstance(self.files, Kept)
        for loaded in self._cast.values():
            for document in loaded.cast.documents:
                if not isinstance(document, Document):
                    self.files.keep(document.folder)

    @cached_property
    def scripts(self) -> list[ScenarioText]:
        """The scenarios as written."""
        with in_place_of_files(self.files):
            return [ScenarioText(path, data, self.paths) for path, data in self.scenarios]

    @cached_property
    def _cast(self) -> dict[tuple[int, tuple[str, ...]], Loaded]:
        return {}

    def targets(self, scenario: int) -> list[ScenarioValue]:
        """What is varied in a scenario."""
        return self.scripts[scenario].targets

    def digests(self) -> list[str]:
        """The SHA-256 of everything that is read."""
        assert isinstance(self.files, Kept)
        contents = (*self.files.texts.values(), *(data for _, data in self.scenarios))
        return sorted({hashlib.sha256(data).hexdigest() for data in contents})

    def problems(self, variant: Variant) -> list[Problem]:
        """What is wrong with a variant before it runs."""
        from prima.sim.rehearsal import check_cast

        try:
            return check_cast(self.loaded(variant).cast)
        except DocumentError as error:
            return [one for one in error.problems if one.severity == "error"]

    def loaded(self, variant: Variant) -> Loaded:
        """A scenario with its values, and all that it names.

        Raises:
            DocumentError: they do not go together.
        """
        script = self.scripts[variant.scenario]
        data = script.text(variant)
        pairs = zip(script.targets, variant.values, strict=True)
        key = variant.scenario, tuple(value for one, value in pairs if one.loads)
        if key not in self._cast:
            if len(self._cast) >= MOST_LOADED:
                self._cast.clear()
            with in_place_of_files(self.files):
                self._cast[key] = load_text(script.path, data)
        loaded = with_scenario(self._cast[key], script.path, data)
        robot = script.robot_text(variant)
        return loaded if robot is None else with_robot(loaded, robot)

    def run(self, variant: Variant) -> Made:
        """Make a run; whatever goes wrong is in its result."""
        for name, number in self.settings.limits.items():
            setattr(LIMITS, name, number)
        try:
            with in_place_of_files(self.files):
                return self._run(variant)
        except DocumentError as error:
            wrong = [str(one) for one in error.problems if one.severity == "error"]
            return Made(1, failures=_short("; ".join(wrong)))
        except PrimaError as error:
            return Made(2 if isinstance(error, UsageError) else 3, failures=_short(str(error)))
        except (Exception, MemoryError) as error:
            if "PRIMA_DEBUG" in os.environ:
                raise
            told = f"this is a defect of prima: {type(error).__name__}: {error}"
            return Made(3, failures=_short(told))

    def rehearsed(
        self, variant: Variant, loaded: Loaded, sink: api.Sink | None = None, keep: bool = False
    ) -> api.Transcript:
        """A run's transcript, with its rows."""
        expects = bool(loaded.cast.scenario.expectations)
        return api.rehearse(
            loaded,
            variant.policy or None,
            self.settings.bound,
            sink,
            keep=keep or expects,
            isolate=self.settings.isolate,
            patience=self.settings.patience,
            visits=expects,
            rows=True,
        )

    def _run(self, variant: Variant) -> Made:
        loaded = self.loaded(variant)
        return self.made(loaded, self.rehearsed(variant, loaded))

    def made(self, loaded: Loaded, transcript: api.Transcript) -> Made:
        """What came of a run."""
        rows = transcript.rows()
        failed = len(failed_expectations(loaded, transcript))
        told = [*transcript.failures, *([TOO_MUCH] if transcript.outcome == "limit" else [])]
        assert transcript.measure is not None
        summary, criteria = transcript.summary(), transcript.measure.criteria()
        return Made(
            3 if told else 0,
            transcript.outcome,
            _short("; ".join(told)),
            failed,
            signature(rows),
            {
                "seconds": summary.seconds,
                "records": transcript.measure.records,
                "collisions": summary.collisions,
                "starved": summary.starved,
                **{name: getattr(criteria, name) for name in CRITERIA},
            },
        )

    def save(self, folder: Path, name: str, variant: Variant) -> None:
        """Write a variant as a scenario into a folder, and the transcript of its run.

        Beside ``NAME.xml`` and ``NAME.jsonl`` there is ``NAME.robot.xml`` if it changes the robot.

        Raises:
            DocumentError: it has errors.
            OSError: a file cannot be written.
            RunError: the run cannot be made.
        """
        assert isinstance(self.files, Kept)
        script, made = self.scripts[variant.scenario], {}
        lines: list[str] = []
        with in_place_of_files(self.files):
            robot = script.robot_text(variant)
            if robot is not None:
                made[folder / f"{name}.robot.xml"] = robot
            path = folder / f"{name}.xml"
            made[path] = script.moved(variant, folder, *made)
            with self.files.beside(made):
                self.rehearsed(variant, load_text(path, made[path]), lines.append)
        for path, data in made.items():
            path.write_bytes(data)
        write_whole(folder / f"{name}.jsonl", "".join(lines))


def failed_expectations(loaded: Loaded, transcript: api.Transcript) -> list[Failure]:
    """The expectations of its scenario that a run does not meet."""
    scenario = loaded.cast.scenario
    if not scenario.expectations:
        return []
    facts = make_run(transcript.run(), transcript.rows(), states_of(transcript.visits))
    return check(scenario, facts)


def signature(rows: Sequence[Row]) -> str:
    """The order of a run as 12 hexadecimal digits: equal if all rows are, but for their times."""
    text = "\n".join("\t".join(row.key) for row in rows)
    return hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()[:12]


def _short(text: str) -> str:
    shown = visible(text)
    return shown if len(shown) <= MOST_MESSAGE else f"{shown[:MOST_MESSAGE]}..."
