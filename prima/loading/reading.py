"""Reads the documents that a scenario names, and collects their problems."""

from __future__ import annotations

import posixpath
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import partial
from os.path import exists, normpath
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from prima.errors import (
    DocumentError,
    Hint,
    Place,
    Problem,
    UsageError,
    meant,
    one_of,
    replaced,
    suggestion,
)
from prima.errors.diagnoses.names import RELATIVE
from prima.interpreter.checks import check_commands
from prima.interpreter.elements import Document
from prima.loading.applications import digest, read_application
from prima.loading.diagnoses import (
    BAD_POLICY,
    BAD_SITE,
    NEEDS_URI,
    NO_AREA,
    NO_FAVOURITE,
    NOT_SERVED,
    OWN_ID,
    RUNS_AS_OTHER,
    UNREADABLE,
)
from prima.loading.files import read_file
from prima.loading.kinds import is_voicexml
from prima.loading.similar import beside, nearby
from prima.loading.voicedocuments import pages_from, voicexml_problems
from prima.markup.reader import parse
from prima.markup.roots import kind_of
from prima.markup.spans import value_span

if TYPE_CHECKING:
    from prima.devices.profile import Profile
    from prima.markup.tree import Node
    from prima.session import AnyDocument
    from prima.sim.map import Area, Map
    from prima.sim.scenario import Scenario
    from prima.voicexml.site import Site


Made = TypeVar("Made")

STAGE = "stage.xml"
"""The name of the scenario made for applications without one: no file has this name."""


@dataclass(slots=True)
class Reading:
    """The documents of a scenario read so far, and their problems."""

    path: Path
    files: dict[str, str]
    problems: list[Problem] = field(default_factory=list)
    documents: list[AnyDocument] = field(default_factory=list)
    whole: bool = False
    """Whether all documents of VoiceXML applications are checked, not only the first."""
    answered: tuple[str, ...] = ()
    """Prefixes of URIs that the scenario's services answer."""
    _listed: dict[Path, list[Path]] = field(default_factory=dict)
    """Files of the folders in which a document was missing."""

    def read(
        self, name: str, node: Node, attribute: str, made_of: Callable[[str, bytes], Made]
    ) -> Made | None:
        """A document that an attribute names, or None if it cannot be read.

        ``name`` is relative to the scenario.
        """
        if not name:
            return None  # reported already by the schema
        target, place = Path(normpath(self.path.parent / name)), node.attribute_place(attribute)
        content = b""
        try:
            content = read_file(target)
            self.files[name] = digest(content)
            return made_of(str(target), content)
        except UsageError as error:
            wrong = str(error).removeprefix(f"{target}: ")
            hint = self._meant(name, target, node, attribute)
            self.problems.append(UNREADABLE.at(place, hint, name=name, wrong=wrong))
        except DocumentError as error:
            self.problems += [_named_wrongly(name, place, one, content) for one in error.problems]
        return None

    def _meant(self, name: str, target: Path, node: Node, attribute: str) -> Hint:
        """The remedy for a name of no readable file; a world's are relative to the world."""
        spans, written = value_span(node, attribute), node.get(attribute)
        if written == name and (found := beside(self.path.parent, name)):
            return meant(found, *spans)
        hint = nearby(target, written, *spans, listed=self._listed)
        if hint or exists(target):
            return hint
        return Hint(RELATIVE)

    def applications(self, scenario: Scenario) -> None:
        """The applications that a scenario names."""
        self.answered = tuple(one.uri for one in scenario.services if one.uri)
        for src, _, node in scenario.applications:
            self.application(src, node)

    def application(self, src: str, node: Node) -> AnyDocument | None:
        """An application that an <application> or <area> names, with its problems."""
        is_area = node.tag == "area"
        said = "ea" if is_area else node.get("kind")
        own = ("" if is_area else node.get("id"), said or "ea")
        site = None if is_area else self.site(src, node)

        def take(uri: str, data: bytes) -> None:
            beside = posixpath.join(posixpath.dirname(src), uri)
            self.files[posixpath.normpath(beside)] = digest(data)

        def made_of(path: str, data: bytes) -> tuple[AnyDocument, list[Problem]]:
            document, problems = read_application(path, data, *own, site, take)
            further: Iterable[Problem] = ()
            if self.whole and is_voicexml(data):
                further = voicexml_problems(pages_from(path, data, site), self.answered)
            return document, [*problems, *further]

        read = self.read(src, node, "application" if is_area else "src", made_of)
        if read is None:
            return None
        document, problems = read
        self.problems += problems
        self.documents.append(document)
        if is_area:
            return document
        place = node.attribute_place("src")
        who = "this scenario says EA" if said == "ea" else "this scenario does not"
        who = "this scenario says FA" if said == "fa" else who
        remedy = f'Write kind="{document.node.get("kind")}" here, or change the document.'
        self.problems += other_kind(document, f'"{src}"', who, place, remedy)
        if isinstance(document, Document):
            self._voice_alone(src, document, node, site)
        return document

    def _voice_alone(self, src: str, document: Document, node: Node, site: Site | None) -> None:
        """What only an application in VoiceXML may have."""
        if site is not None:
            where = node.attribute_place("uri", value=False)
            self.problems.append(NOT_SERVED.at(where, src=src))
        if node.get("id") not in ("", document.id):
            where = node.attribute_place("id", value=False)
            self.problems.append(OWN_ID.at(where, src=src, own=document.id))

    def site(self, src: str, node: Node) -> Site | None:
        """Where an application is served, if the scenario says so; a wrong URI is a problem."""
        from prima.voicexml.site import site_of

        uri, folder = node.get("uri").strip(), node.get("folder")
        if not uri and not folder:
            return None
        if not uri:
            self.problems.append(NEEDS_URI.at(node.attribute_place("folder")))
            return None
        try:
            above = normpath(self.path.parent / folder) if folder else ""
            return site_of(normpath(self.path.parent / src), uri, above)
        except ValueError as error:
            wrong, *remedies = error.args
            hint = Hint("".join(remedies))
            self.problems.append(BAD_SITE.at(node.attribute_place("uri"), hint, wrong=wrong))
            return None

    def surroundings(self, scenario: Scenario) -> tuple[Map | None, Profile | None]:
        """The scenario's world and robot."""
        from prima.devices.profile import read_robot
        from prima.sim.map import read_world

        root = scenario.node
        world = self.read(scenario.world, root, "world", read_world)
        profile = self.read(scenario.robot, root, "robot", read_robot)
        for made in (world, profile):
            self.problems += made.warnings if made is not None else ()
        return world, profile

    def offers(self, scenario: Scenario, world: Map) -> list[tuple[Area, str]]:
        """The applications that a world's areas offer, except those the scenario runs itself."""
        if not world.areas:
            place = scenario.node.attribute_place("entrances")
            self.problems.append(NO_AREA.at(place, world=world.id))
        beside = {posixpath.normpath(src) for src, _, _ in scenario.applications}
        known: dict[str, AnyDocument | None] = {}
        made = []
        for area in world.areas:
            folder = posixpath.dirname(scenario.world)
            name = posixpath.normpath(posixpath.join(folder, area.src))
            if name in beside:
                continue  # the scenario determines when it runs
            if name not in known:
                known[name] = self.offered(name, area)
            document = known[name]
            if document is not None:
                made.append((area, document.id))
        return made

    def users(self, scenario: Scenario) -> None:
        """The documents of the behaviour of persons."""
        from prima.sim.user import read_user

        wrong: set[str] = set()
        told: set[str] = set()
        for person in scenario.persons:
            if person.user and person.user not in wrong and person.node is not None:
                made_of = partial(read_user, person=person.name)
                user = self.read(person.user, person.node, "user", made_of)
                if user is None:
                    wrong.add(person.user)  # reported once
                    continue
                scenario.take(person.name, user)
                if person.user not in told:
                    told.add(person.user)
                    self.problems += user.warnings

    def replies(self, scenario: Scenario) -> None:
        """The answers of services to fetches."""
        for service in scenario.services:
            for reply in service.replies:
                if reply.src and reply.node is not None:
                    body = self.read(reply.src, reply.node, "src", lambda _, data: data)
                    reply.body = body or b""

    def offered(self, name: str, area: Area) -> AnyDocument | None:
        """The EA that an area offers."""
        document = self.application(name, area.node)
        if document is not None:
            place = area.node.attribute_place("application")
            who, remedy = "a place offers EAs", 'Write kind="ea" in the document.'
            self.problems += other_kind(document, f'"{area.src}"', who, place, remedy)
        return document

    def check_commands(self, robot: Profile) -> None:
        """Check for Commands that the robot cannot carry out."""
        for document in self.documents:
            if isinstance(document, Document):
                self.problems += check_commands(document, robot.commands, robot.devices)
            else:
                from prima.voicexml import checks, pages, sketched

                voice = pages.pages_of(document)
                for page in voice:
                    roots = [one.root for one in (page, voice.root(page)) if one is not None]
                    self.problems += checks.check_commands(roots, robot.commands, robot.devices)
                    self.problems += sketched.added_in_units(page, robot.commands)

    def check_policy(self, scenario: Scenario) -> None:
        """Check the policy: an unknown one, or one that prefers a missing application."""
        from prima.scheduler.policy import UnknownPolicy, policy_named

        place = scenario.node.attribute_place("policy")
        try:
            policy_named(scenario.policy)
        except UnknownPolicy as error:
            spans = value_span(scenario.node, "policy", error.word) if error.meant else ()
            hint = replaced(error.remedy, error.meant, *spans)
            self.problems.append(BAD_POLICY.at(place, hint, wrong=error.wrong))
        if problem := favourite_problem(scenario.policy, self.documents, scenario.node):
            wrong, hint = problem
            self.problems.append(NO_FAVOURITE.at(place, hint, wrong=wrong))


def other_kind(
    document: AnyDocument, name: str, who: str, place: Place, remedy: str
) -> list[Problem]:
    """Warn of a document that declares another kind than the run, which takes precedence."""
    own = document.node.get("kind")
    if not isinstance(document, Document) or own not in {"ea", "fa"} - {document.kind}:
        return []  # any other is reported at the document
    if document.kind not in ("ea", "fa"):
        return []  # and this where the scenario says it
    kind = document.kind.upper()
    return [RUNS_AS_OTHER.at(place, Hint(remedy), name=name, own=own.upper(), who=who, kind=kind)]


def _named_wrongly(name: str, place: Place, problem: Problem, content: bytes) -> Problem:
    """Report a document of the wrong kind where the scenario names it.

    If the scenario was generated, it is reported at the document.
    """
    wrong_kind = problem.code == "wrong-namespace" and kind_of(parse(name, content))
    if place.file == STAGE or not wrong_kind:
        return problem
    return problem._replace(place=place, message=f'"{name}": {problem.message}', fixes=())


def favourite_problem(
    policy: str, documents: list[AnyDocument], node: Node | None = None
) -> tuple[str, Hint] | None:
    """The problem of the application that ``fixed:APP`` names, and the one meant."""
    kind, _, first = policy.partition(":")
    names = [document.id for document in documents]
    if kind != "fixed" or not first or first in names:
        return None
    spans = value_span(node, "policy", first) if node is not None else ()
    hint = suggestion(first, names, *spans) or Hint(f"Write {one_of(names)}.")
    return f'The policy "{policy}" names an application that is not in the scenario.', hint
