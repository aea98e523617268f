"""The parts of a live run: as chosen, or as recorded in its journal."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from prima.devices.endpoints import Endpoint
from prima.errors import DocumentError, Problem, UsageError, did_you_mean
from prima.live.services import LiveServices
from prima.loading import Loaded, load_scenario, load_services, stage
from prima.loading.files import GivenFiles, in_place_of_files, read_file
from prima.loading.heads import check_files
from prima.loading.reading import STAGE
from prima.messages import Json, Record
from prima.sim.services import Web
from prima.voicexml.site import halves


@dataclass(frozen=True, slots=True)
class Chosen:
    """The parts of a live run. Paths are as given on the command line."""

    robot: str = ""
    scenario: str = ""
    world: str = ""
    fas: tuple[str, ...] = ()
    eas: tuple[str, ...] = ()
    maps: tuple[str, ...] = ()
    services: str = ""

    def loaded(self) -> Loaded:
        """Load it all.

        Raises:
            DocumentError: with the problems of all files, if any is an error.
            UsageError: a file cannot be read.
        """
        if self.scenario:
            return load_scenario(self.scenario, robot=self.robot)
        given = self.world or None, self.robot or None, self.maps, bool(self.world)
        loaded = stage(self.fas, self.eas, (), *given)
        own = {name for one in loaded.cast.robot.drivers for name in one.places}
        loaded.problems = [one for one in loaded.problems if not _is_of_place(one, own)]
        if self.services:
            endpoints, loaded.files[self.services] = load_services(self.services)
            _check_owners(endpoints, [one.id for one in loaded.cast.documents])
        return loaded

    def answering(self, web: Web | None) -> LiveServices:
        """The services that answer applications' messages and fetches.

        Raises:
            UsageError: a secret is not in the environment.
        """
        return LiveServices(load_services(self.services)[0] if self.services else (), web)

    def recorded(self, folder: str) -> dict[str, Json]:
        """The same for a journal in a folder: paths from there, and the whole robot document."""

        def seen(path: str) -> str:
            return os.path.relpath(path, folder or ".")

        recorded: dict[str, Json] = {"robot": seen(self.robot)} if self.robot else {}
        for name in ("scenario", "world", "services"):
            if path := getattr(self, name):
                recorded[name] = seen(path)
        for name, paths in (("fa", self.fas), ("ea", self.eas)):
            if paths:
                recorded[name] = [seen(path) for path in paths]
        if self.maps:
            parts = (halves(text) for text in self.maps)
            recorded["maps"] = [f"{uri}={seen(path)}" for uri, path in parts]
        if self.robot:
            recorded["document"] = read_file(self.robot).decode("utf-8", "replace")
        return recorded


def _is_of_place(problem: Problem, names: set[str]) -> bool:
    """Whether a problem is that the site's map lacks a place; robots' own maps may have it."""
    of_place = problem.code == "no-such-name" and problem.get("what").startswith("place")
    return of_place and problem.get("name").strip() in names


def _check_owners(endpoints: Iterable[Endpoint], known: list[str]) -> None:
    """Check that services belong to applications of the run.

    Raises:
        DocumentError: one does not.
    """
    strange = [one for one in endpoints if one.application and one.application not in known]
    if strange:
        raise DocumentError(
            Problem(
                one.place,
                "error",
                "no-such-name",
                f'There is no application "{one.application}".',
                did_you_mean(one.application, known) or f"The run has {', '.join(known)}.",
            )
            for one in strange
        )


def chosen_then(head: Record, name: str) -> Chosen:
    """The parts that a journal with this first record was made with, by paths from its own.

    Raises:
        UsageError: the record does not name files.
    """
    live = head["data"].get("live")
    if not isinstance(live, dict) or not (live.get("robot") or live.get("scenario")):
        message = "the transcript does not say with which files it was made; name its scenario."
        raise UsageError(f"{name}: {message}")
    folder = os.path.dirname(name)

    def path(recorded: Json) -> str:
        return os.path.relpath(os.path.join(folder, str(recorded))) if recorded else ""

    def paths(recorded: Json) -> tuple[str, ...]:
        return tuple(path(one) for one in recorded) if isinstance(recorded, list) else ()

    parts = (halves(str(one)) for one in live.get("maps") or ())
    return Chosen(
        path(live.get("robot")),
        path(live.get("scenario")),
        path(live.get("world")),
        paths(live.get("fa")),
        paths(live.get("ea")),
        tuple(f"{uri}={path(where)}" for uri, where in parts),
        path(live.get("services")),
    )


def reloaded(head: Record, name: str) -> Loaded:
    """Load the parts that a journal was made with; the robot is the one in the journal.

    Raises:
        DocumentError: documents are wrong.
        UsageError: the record does not name files, or a file has changed since.
    """
    chosen = chosen_then(head, name)
    live, texts = head["data"]["live"], {}
    if chosen.robot and isinstance(live.get("document"), str):
        texts[Path(chosen.robot).resolve()] = live["document"].encode()
    with in_place_of_files(GivenFiles(texts)):
        loaded = chosen.loaded()
    loaded.files.pop(STAGE, None)
    check_files(head, loaded, name)
    return loaded
