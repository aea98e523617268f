"""Runs of scenarios whose values are varied, from content alone: no file is read.

A :class:`Stage` can be sent to another process, or machine, and makes runs there.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from prima import api
from prima.errors import TOO_MUCH, DocumentError, PrimaError, Problem, UsageError
from prima.errors.visible import visible
from prima.experiments.kept import Kept
from prima.experiments.scenariotext import ScenarioText, Variant
from prima.experiments.settings import ExperimentSettings
from prima.interpreter.elements import Document
from prima.loading import Loaded, load_text, with_robot, with_scenario
from prima.loading.applications import digest
from prima.loading.files import Files, in_place_of_files, read_file
from prima.loading.writing import write_whole
from prima.markup.collecting import seldom_collected
from prima.markup.limits import set_limits
from prima.messages import Json
from prima.sim.paths import ScenarioValue
from prima.testing.checking import Failure, check
from prima.testing.facts import make_run
from prima.testing.tracing import states_of
from prima.transcript.criteria import CRITERIA
from prima.transcript.row import Row

MOST_LOADED = 64
"""Maximum number of combinations of documents, worlds and robots kept loaded."""
ORDER = "[0-9a-f]{12}"
"""An order's signature, after which its files are named."""
MOST_MESSAGE = 1_000
"""Maximum length of a run's messages (characters)."""


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


class Stage:
    """Scenarios with all files that they name, and the values to vary; makes runs."""

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
            UsageError: one cannot be read, or a path does not exist in it.
        """
        made = cls([(name, read_file(name)) for name in names], paths, settings)
        for index in range(len(names)):
            made.loaded(
                Variant(0, index, "", 0, tuple(one.as_it_is for one in made.targets(index)))
            )
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
            UsageError: they are too large.
        """
        assert isinstance(self.files, Kept)
        self.digests()  # before there is more
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
        """The values that are varied in a scenario."""
        return self.scripts[scenario].targets

    def _read_named(self, loaded: Loaded) -> None:
        """Read the files that VoiceXML documents name before a run, so that all digests are known."""
        from prima.loading.voicedocuments import read_named

        for document in loaded.cast.documents:
            if not isinstance(document, Document):
                read_named(document)

    def digests(self) -> list[str]:
        """The SHA-256 of everything that the scenarios name, without what ``pack`` adds.

        They are in the order of the files' paths from the first scenario, so that two files that
        are exchanged differ.
        """
        return self._digests

    @cached_property
    def _digests(self) -> list[str]:
        assert isinstance(self.files, Kept)
        texts, heads = self.files.texts, self.files.heads
        here = os.path.dirname(os.path.join(self.files.folder, self.scenarios[0][0]))

        def place(path: Path) -> str:
            return os.path.relpath(path, here)

        contents = [data for _, data in self.scenarios]
        contents += [texts[path] for path in sorted(texts, key=place)]
        for path in sorted(heads, key=place):
            data, size = heads[path]
            contents.append(data + str(size).encode())
        return [digest(data) for data in contents]

    def problems(self, variant: Variant) -> list[Problem]:
        """The error of a variant before it runs, if any."""
        from prima.sim.rehearsal import check_cast

        try:
            return check_cast(self.loaded(variant).cast)
        except DocumentError as error:
            return [one for one in error.problems if one.severity == "error"]

    def loaded(self, variant: Variant) -> Loaded:
        """A scenario with its values, and all files that it names.

        Raises:
            DocumentError: they do not fit together.
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
                if isinstance(self.files, Kept):
                    self._read_named(self._cast[key])
        loaded = with_scenario(self._cast[key], script.path, data)
        robot = script.robot_text(variant)
        return loaded if robot is None else with_robot(loaded, robot)

    def run(self, variant: Variant) -> Made:
        """Make a run; errors are in its result."""
        set_limits(self.settings.limits)
        try:
            with in_place_of_files(self.files), seldom_collected():
                return self._run(variant)
        except DocumentError as error:
            wrong = [str(one) for one in error.problems if one.severity == "error"]
            return Made(1, failures=_short("; ".join(wrong)))
        except PrimaError as error:
            return Made(2 if isinstance(error, UsageError) else 3, failures=_short(str(error)))
        except MemoryError:
            return Made(3, failures="out of memory")
        except Exception as error:
            if "PRIMA_DEBUG" in os.environ:
                raise
            reason = f"this is a defect of prima: {type(error).__name__}: {error}"
            return Made(3, failures=_short(reason))

    def rehearsed(
        self, variant: Variant, loaded: Loaded, sink: api.Sink | None = None, keep: bool = False
    ) -> api.Transcript:
        """A run's transcript, with its rows."""
        expects = bool(loaded.cast.scenario.expectations)
        return api.rehearse(
            loaded,
            variant.policy or None,
            sink=sink,
            keep=keep,
            visits=expects,
            rows=True,
            entries=expects,
            **self.settings.arguments(),
        )

    def _run(self, variant: Variant) -> Made:
        loaded = self.loaded(variant)
        return self.made(loaded, self.rehearsed(variant, loaded))

    def made(self, loaded: Loaded, transcript: api.Transcript) -> Made:
        """What came of a run."""
        rows = transcript.rows()
        failed = len(failed_expectations(loaded, transcript))
        failures = [*transcript.failures, *([TOO_MUCH] if transcript.outcome == "limit" else [])]
        assert transcript.measure is not None
        summary, criteria = transcript.summary(), transcript.measure.criteria()
        return Made(
            3 if failures else 0,
            transcript.outcome,
            _short("; ".join(failures)),
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


def discard(folder: Path, names: str = ORDER) -> None:
    """Remove the cases that an earlier sweep or exploration has saved in a folder.

    Args:
        folder: the folder; other files in it stay.
        names: the pattern of the cases' names.

    Raises:
        OSError: a file cannot be removed.
    """
    for path in list(folder.glob("*")):
        if re.fullmatch(rf"{names}\.(jsonl|xml|robot\.xml)", path.name):
            path.unlink()


def failed_expectations(loaded: Loaded, transcript: api.Transcript) -> list[Failure]:
    """The expectations of its scenario that a run does not meet."""
    scenario = loaded.cast.scenario
    if not scenario.expectations:
        return []
    facts = make_run(transcript.entries, transcript.rows(), states_of(transcript.visits))
    return check(scenario, facts)


def signature(rows: Sequence[Row]) -> str:
    """The order of a run as 12 hexadecimal digits: equal if all rows are equal except for times."""
    text = "\n".join("\t".join(row.key) for row in rows)
    return hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()[:12]


def _short(text: str) -> str:
    shown = visible(text)
    return shown if len(shown) <= MOST_MESSAGE else f"{shown[:MOST_MESSAGE]}..."
