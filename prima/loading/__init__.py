"""Loading: files and what they name, read and checked together.

This module and :mod:`prima.api` alone open documents; everything below works on
text and values.
"""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from os.path import exists, normpath
from typing import TYPE_CHECKING, TypeVar

from prima.checks.ignores import Ignores
from prima.errors import (
    DocumentError,
    Hint,
    Place,
    Problem,
    Span,
    UsageError,
    few_guesses,
    in_order,
    listed,
    meant,
    one_of,
    replaced,
    suggestion,
)
from prima.interpreter.checks import check_commands
from prima.interpreter.elements import Document
from prima.interpreter.events import near
from prima.interpreter.reader import read_document
from prima.interpreter.vocabulary import DIALOGUE
from prima.loading.collecting import seldom_collected
from prima.loading.diagnoses import (
    BAD_POLICY,
    BAD_SITE,
    NEEDS_URI,
    NO_AREA,
    NO_FAVOURITE,
    NO_FILE_HERE,
    NOT_SERVED,
    RUNS_AS_OTHER,
    UNREADABLE,
)
from prima.loading.files import Folder, path_of, read_file
from prima.markup.check import check_root, kind_of
from prima.markup.limits import LIMITS
from prima.markup.reader import parse
from prima.markup.sniff import root_of
from prima.markup.spans import value_span

if TYPE_CHECKING:
    from pathlib import Path

    from prima.devices.endpoints import Endpoint
    from prima.devices.profile import Profile
    from prima.grammar import Grammar
    from prima.markup.tree import Node
    from prima.session import AnyDocument
    from prima.sim.devices import Cast
    from prima.sim.map import Area, Map
    from prima.sim.scenario import Scenario
    from prima.voicexml.document import Page
    from prima.voicexml.site import Site

# What one use needs and another does not is imported where it is used: most commands are short.


Taken = Callable[[str, bytes], object]
"""Is told the name and the bytes of each file that a document takes in."""


def read_application(
    path: str,
    data: bytes,
    name: str = "",
    kind: str = "",
    site: Site | None = None,
    taken: Taken | None = None,
) -> tuple[AnyDocument, list[Problem]]:
    """Read an application of either language; a VoiceXML document is named after its file.

    ``kind`` is ``fa`` or ``ea`` where the run says so; it counts, whatever the document says.
    ``site`` says where a VoiceXML document and its folder are served. ``taken`` is told of the
    grammars that a document of PRIMA's own language names.

    Raises:
        DocumentError: no document at all can be given.
    """
    if not is_voicexml(data):
        native, problems = _read_native(path, data, taken)
        if kind and native.kind != kind:
            from dataclasses import replace

            native = replace(native, kind=kind)  # others may run the same document as it is
        return native, problems
    from prima.voicexml.document import VoiceDocument
    from prima.voicexml.reading import read_page

    file = path_of(path)
    page = read_page(site.name(site.uri) if site else file.name, path, data, site)
    own = name or re.sub(r"[^A-Za-z0-9_-]+", "-", file.stem).strip("-") or "voice"
    folder = Folder(site.folder if site else str(file.parent))
    return VoiceDocument(
        own, kind or "ea", path, page, folder.fetch, page.root, folder.glance
    ), page.problems


def _read_native(
    path: str, data: bytes, taken: Taken | None = None
) -> tuple[Document, list[Problem]]:
    """An application in PRIMA's own language, with the grammars of its folder that it names."""

    def fetch(uri: str) -> bytes:
        found = _fetcher(path_of(path).parent)(uri)
        if taken is not None:
            taken(uri, found)
        return found

    return read_document(path, data, fetch)


VOICEXML = re.compile(rb"<(?:[\w.-]+:)?vxml[\s>/]")
"""How the root element of VoiceXML begins."""


def is_voicexml(data: bytes) -> bool:
    """Whether a file's root element is VoiceXML's, as far as its beginning tells."""
    return VOICEXML.match(root_of(data)) is not None


def _is_surely_ours(data: bytes) -> bool:
    """Whether a file begins so that it need not be parsed to know it for our language's."""
    tag, _, _ = root_of(data).partition(b">")
    before, found, _ = tag.partition(b'xmlns="%s"' % DIALOGUE.namespace.encode())
    apart = before[6:7].isspace() and before[-1:].isspace()
    return bool(found) and before.startswith(b"<prima") and apart and b"<" not in before[6:]


def is_application(path: str) -> bool:
    """Whether a file is an application of either language, as far as its beginning tells."""
    try:
        data = read_file(path)
    except (DocumentError, UsageError):
        return False
    return is_voicexml(data) or DIALOGUE.namespace.encode() in data[:4096]


def load(path: str | Path) -> Document:
    """Load an application.

    Raises:
        DocumentError: with all problems, if any is an error.
        UsageError: the file cannot be read.
    """
    document, problems = _read_native(str(path), read_file(path))
    if any(problem.severity == "error" for problem in problems):
        raise DocumentError(problems)
    return document


@dataclass(slots=True)
class Loaded:
    """A scenario with everything it names; ``files`` are paths with digests of their bytes."""

    cast: Cast
    files: dict[str, str]
    problems: list[Problem] = field(default_factory=list)


def validate(paths: Iterable[str | Path], maps: Iterable[str] = ()) -> list[Problem]:
    """Give all problems of documents of any kind; a scenario's also those of what it names.

    Those that authors ignore, in a document or in ``prima.toml``, are left out. Of very many the
    last says only how many there are more (:func:`prima.errors.listed`).

    Args:
        paths: the documents.
        maps: folders of VoiceXML documents and where they are served, as ``URI=FOLDER``.

    Raises:
        UsageError: a file cannot be read, or a mapping is none.
    """
    paths = list(paths)
    validation = Validation(mappings(maps, map(str, paths)))
    problems = [problem for path in paths for problem in validation.problems(path)]
    return listed(sorted(once([*problems, *validation.ignored()])), LIMITS.problems)


def once(problems: Iterable[Problem]) -> list[Problem]:
    """Problems once each: an error in a file is not repeated as a warning of the documents that name it."""
    found = dict.fromkeys(problems)
    warned = {one.place for one in found if one.severity != "error"}
    errors = {
        (one.place, one.message) for one in found if one.severity == "error" and one.place in warned
    }
    return [
        one for one in found if one.severity == "error" or (one.place, one.message) not in errors
    ]


class Validation:
    """Checks documents one after the other, and in the end what their authors ignore.

    Args:
        maps: folders of VoiceXML documents by the URIs at which they are served.
    """

    def __init__(self, maps: Mapping[str, str] | None = None) -> None:
        self._maps = maps or {}
        self._ignores = Ignores(read_file)

    def problems(self, path: str | Path) -> list[Problem]:
        """The problems of a document that nobody ignores.

        Raises:
            UsageError: the file cannot be read.
        """
        with few_guesses(), seldom_collected():
            found = self._ignores.left(_validate_one(str(path), self._maps))
        self._ignores.check(str(path))
        return in_order(found)

    def ignored(self) -> list[Problem]:
        """What is wrong with ignores of the documents checked: no reason, or nothing to ignore."""
        return in_order(self._ignores.told())


def _validate_one(path: str, maps: Mapping[str, str]) -> list[Problem]:
    try:
        data = read_file(path)
        application = _is_surely_ours(data)
        if not application and is_voicexml(data):
            return list(_voicexml_problems(path, data, _mapped_site(path, maps)))
        if not application and (is_grammar(data) or path.lower().endswith(GRAMMAR_FILES)):
            return _grammar_problems(path_of(path), data)
        if application:
            return _application_problems(path, data)
        from prima.devices.profile import read_robot
        from prima.devices.vocabulary import ROBOT, SERVICES
        from prima.sim.map import read_world
        from prima.sim.vocabulary import SCENARIO, USER, WORLD

        kinds = (DIALOGUE, WORLD, ROBOT, SCENARIO, USER, SERVICES)
        vocabulary = check_root(parse(path, data, kinds), kinds)
        if vocabulary is DIALOGUE:
            return _application_problems(path, data)
        if vocabulary is WORLD:
            world = read_world(path, data)
            reading = _Reading(path_of(path), {}, [*world.warnings])
            for area in world.areas:
                if area.src not in reading.files:
                    reading.offered(area.src, area)
            return reading.problems
        elif vocabulary is ROBOT:
            return read_robot(path, data).warnings
        elif vocabulary is SERVICES:
            _services(path, data)
            return []
        elif vocabulary is USER:
            from prima.sim.user import read_user

            read_user(path, data)
            return []
        else:
            return _load(path_of(path), data, whole=True).problems
    except DocumentError as error:
        return error.problems
    return []


def _mapped_site(path: str, maps: Mapping[str, str]) -> Site | None:
    """Where a document is served by the mapping of its folder, if there is one."""
    if not maps:
        return None
    from prima.voicexml.site import mapped, site_of

    found = mapped(path, maps)
    return site_of(path, *found) if found else None


def mappings(maps: Iterable[str], paths: Iterable[str]) -> dict[str, str]:
    """Folders by the URIs at which they are served, of ``URI=FOLDER``.

    Raises:
        UsageError: a mapping is none, or none of the applications is in its folder.
    """
    from prima.voicexml.site import mapped, mapping_of

    held: dict[str, str] = {}
    paths = list(paths)
    for text in maps:
        try:
            uri, folder = mapping_of(text)
        except ValueError as error:
            raise UsageError(f"--map {' '.join(error.args)}") from None
        held[uri] = folder
        if not any(mapped(path, {uri: folder}) for path in paths):
            raise UsageError(f"--map {text}: no application is in the folder {folder}.")
    return held


def _application_problems(path: str, data: bytes) -> list[Problem]:
    """The problems of an application in PRIMA's own language."""
    document, problems = _read_native(path, data)
    return problems + _prices(document) if b"<iu" in data else problems


def _voicexml_problems(
    path: str, data: bytes, site: Site | None = None, answered: tuple[str, ...] = ()
) -> Iterator[Problem]:
    """The problems of a VoiceXML document, and of those of its folder that it leads to.

    URIs that begin like one of ``answered`` are a service's.
    """
    from prima.voicexml.caught import check_caught
    from prima.voicexml.document import FetchError
    from prima.voicexml.listening import check_listening
    from prima.voicexml.pages import Pages
    from prima.voicexml.reading import read_page
    from prima.voicexml.sketched import check_sketched
    from prima.voicexml.variables import check_variables

    folder = path_of(site.folder) if site else path_of(path).parent
    first = read_page(site.name(site.uri) if site else path_of(path).name, path, data, site)
    pages = Pages(first, path, Folder(str(folder)).fetch)

    def script(page: Page, node: Node) -> str | None:
        try:
            source = page.resolve(node.get("src"), node) if node.get("src") else ""
            return Folder(str(folder)).fetch(source).decode("utf-8") if source else None
        except (FetchError, ValueError):
            return None

    for page in pages:
        yield from (*page.problems, *page.warnings(), *_not_there(page, folder, answered))
        yield from (*_grammars_of(page, folder), *check_variables(page, pages.root(page), script))
        yield from check_caught(page.root, pages.thrown)
        yield from check_listening(page, pages.root(page))
    yield from check_sketched((page, pages.root(page)) for page in pages)
    yield from (*pages.problems, *pages.between())


NAMING_FILES = {
    "src": frozenset(["script", "grammar", "data", "subdialog"]),
    "next": frozenset(["goto", "link", "choice", "submit"]),
    "application": frozenset(["vxml"]),
}
"""Attributes of VoiceXML elements that name a file, where they name nothing else."""


def _not_there(page: Page, folder: Path, answered: tuple[str, ...]) -> Iterator[Problem]:
    """Warn of files that a VoiceXML document names and that are not in its folder."""
    from urllib.parse import unquote

    for node in page.root.walk():
        for name, tags in NAMING_FILES.items():
            uri = node.get(name).strip()
            if node.tag not in tags or not uri or uri.startswith("#"):
                continue
            whole = page.resolve(uri, node)
            file = unquote(whole.partition("#")[0].partition("?")[0])
            inside = not file.startswith(("/", "../"))
            if page.site is not None and page.site.whole(whole).startswith(answered):
                continue
            if SCHEME.match(whole) or not file or (inside and exists(folder / file)):
                continue
            spans = value_span(node, name, file.rpartition("/")[2])
            hint = _nearby(folder / file, *spans)
            yield NO_FILE_HERE.at(node.attribute_place(name), hint, file=file[:80])


SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:|//")
"""How a URI begins that is no file's name."""
GRAMMAR = re.compile(rb"<(?:[\w.-]+:)?grammar[\s>/]")
"""How the root element of a grammar begins that is a file of its own."""
GRAMMAR_FILES = (".gram", ".abnf", ".grxml", ".srgs")
"""How the names of files end that are nothing but grammars."""
MOST_BEGUN = 2000
"""Characters of a file that are looked at to tell what it is."""
OTHER_FORMS = (b"#ABNF", b"#JSGF", b";GSL", b"#GSL")
"""How grammars begin that are no XML."""


def is_grammar(data: bytes) -> bool:
    """Whether a file is a grammar, as far as its beginning tells; it may lack its header."""
    root = root_of(data)
    if root.startswith(OTHER_FORMS) or GRAMMAR.match(root) is not None:
        return True
    if root.startswith((b"<", b"{")):
        return False
    from prima.grammar.media import looks_like_abnf

    return looks_like_abnf(root[:MOST_BEGUN].decode("latin-1"))


def _grammar_problems(path: Path, data: bytes) -> list[Problem]:
    """What is wrong with a grammar, and with those of its folder that it refers to."""
    from prima.grammar import load

    try:
        problems = load(data, base=path.name, fetch=_fetcher(path.parent)).warnings()
    except DocumentError as error:
        problems = error.problems
    return [_in_folder(path.parent, problem) for problem in problems]


def load_services(path: str) -> tuple[list[Endpoint], str]:
    """Load a document of services; gives its digest, too.

    Raises:
        DocumentError: with all its problems.
        UsageError: the file cannot be read.
    """
    data = read_file(path)
    return _services(path, data), _digest(data)


def _services(path: str, data: bytes) -> list[Endpoint]:
    from prima.devices.endpoints import read_services
    from prima.grammar import load

    folder = path_of(path).parent
    fetch = _fetcher(folder)

    def grammar(name: str) -> Grammar:
        try:
            return load(fetch(name), base=name, fetch=fetch)
        except DocumentError as error:
            raise DocumentError([_in_folder(folder, one) for one in error.problems]) from None

    return read_services(path, data, grammar)


def _in_folder(folder: Path, problem: Problem) -> Problem:
    return problem._replace(place=problem.place._replace(file=str(folder / problem.place.file)))


def _fetcher(folder: Path, site: Site | None = None) -> Callable[[str], bytes]:
    """Gives the bytes of grammars in a folder, of one that was copied from a site by their URIs."""
    from prima.voicexml.document import FetchError

    def fetch(uri: str) -> bytes:
        try:
            return Folder(str(folder)).fetch(site.name(uri) if site else uri)
        except FetchError as error:
            raise LookupError(str(error).rstrip(".")) from None

    return fetch


def _grammars_of(page: Page, folder: Path) -> Iterator[Problem]:
    """What is wrong with the grammars in files that a VoiceXML document names."""
    from prima.voicexml.checks import grammar_problems

    site = page.site
    fetch, base = _fetcher(folder, site), site.whole(page.base()) if site else page.base()
    for node in page.root.walk():
        uri = node.get("src").strip()
        if node.tag != "grammar" or not uri or SCHEME.match(page.resolve(uri, node)):
            continue
        for problem in grammar_problems(node, page.lang, base, fetch):
            if problem.place.file != node.source.file:
                file = problem.place.file
                place = problem.place._replace(file=site.name(file) if site else file)
                yield _in_folder(folder, problem._replace(place=place))
            elif problem.code != "no-such-file":  # which is told already
                yield problem


def _prices(document: Document) -> list[Problem]:
    """What an application's units cost others, on the demo's robot, as notes."""
    from prima.checks.prices import notes
    from prima.devices.profile import read_robot

    robot = documents_folder() / "robots" / "papero.xml"
    return notes(document, read_robot(str(robot), read_file(robot)))


def load_scenario(path: str | Path, robot: str = "") -> Loaded:
    """Load a scenario with its world, robot and applications.

    Args:
        path: the scenario's.
        robot: the path of another robot than the scenario's.

    Raises:
        DocumentError: with the problems of all files, if any is an error.
        UsageError: the scenario's file cannot be read.
    """
    return load_text(path, read_file(path), robot)


def load_text(path: str | Path, data: bytes, robot: str = "") -> Loaded:
    """Load a scenario from memory; see :func:`load_scenario`.

    Args:
        path: the file whose folder its paths begin at; it is not read.
        data: the scenario's text.
        robot: the path of another robot than the scenario's.

    Raises:
        DocumentError: with the problems of all files, if any is an error.
    """
    return _without_ignored(_load(path_of(path), data, robot=robot))


def with_scenario(loaded: Loaded, path: str | Path, data: bytes) -> Loaded:
    """What was loaded, with another text of its scenario that names the same files.

    Raises:
        DocumentError: the text has errors.
    """
    from dataclasses import replace

    from prima.sim.scenario import read_scenario

    scenario = read_scenario(str(path), data)
    for service, before in zip(scenario.services, loaded.cast.scenario.services, strict=True):
        for reply, old in zip(service.replies, before.replies, strict=True):
            reply.body = old.body
    for name, user in loaded.cast.scenario.users.items():
        scenario.take(name, user)
    files = {**loaded.files, path_of(path).name: _digest(data)}
    return Loaded(replace(loaded.cast, scenario=scenario), files, loaded.problems)


def seeded(loaded: Loaded, seed: int | None) -> Loaded:
    """What was loaded, drawn by another seed; None for the scenario's own."""
    from dataclasses import replace

    if seed is None:
        return loaded
    scenario = replace(loaded.cast.scenario, seed=seed)
    return Loaded(replace(loaded.cast, scenario=scenario), loaded.files, loaded.problems)


def _without_ignored(loaded: Loaded) -> Loaded:
    """What has been loaded, without the problems that authors ignore."""
    loaded.problems = Ignores(read_file).left(loaded.problems)
    return loaded


def stage(
    fas: Iterable[str],
    eas: Iterable[str],
    says: Iterable[str] = (),
    world: str | None = None,
    robot: str | None = None,
    maps: Iterable[str] = (),
    entrances: bool = False,
) -> Loaded:
    """Put applications on a robot in an empty room, with a user in front of it.

    Args:
        fas: paths of the robot's own applications.
        eas: paths of the place's.
        says: what the user says to the questions, one after the other.
        world: path of another world; the robot is at its first place.
        robot: path of another robot's profile.
        maps: folders of VoiceXML documents and where they are served, as ``URI=FOLDER``.
        entrances: whether the robot takes up what areas of the world offer.

    Raises:
        DocumentError: with the problems of all files, if any is an error.
        UsageError: a file cannot be read, or two of the applications have one id.
    """
    from html import escape

    demo = documents_folder()
    given = [(kind, path) for kind, paths in (("fa", fas), ("ea", eas)) for path in paths]
    for path in (*(path for _, path in given), *filter(None, (robot, world))):
        read_file(path)  # what is not there is no fault of a document
    served = _served([path for _, path in given], maps)
    applications = [
        f'<application src="{escape(path)}" kind="{kind}"{served.get(path, "")}/>'
        for kind, path in given
    ]
    answers = [
        f'<when asked="" count="{number}" after="1s"><say>{escape(text)}</say></when>'
        for number, text in enumerate(says, 1)
    ]
    world = world or str(demo / "worlds" / "room.xml")
    robot = robot or str(demo / "robots" / "papero.xml")
    taken_up = ' entrances="open"' if entrances else ""
    text = (
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="stage"'
        f' world="{escape(world)}" robot="{escape(robot)}"{taken_up}>'
        f"{_standing(world)}{''.join(applications + answers)}</scenario>"
    )
    try:
        loaded = _load(path_of("stage.xml"), text.encode())
    except DocumentError as error:
        if any(
            one.code == "duplicate-id" and one.place.file == "stage.xml" for one in error.problems
        ):
            _refuse_same_id(given)
        raise
    problems = [one for one in loaded.problems if one.code != "other-kind"]
    for (kind, _), document in zip(given, loaded.cast.documents, strict=False):
        own, place = document.node.get("kind"), document.node.attribute_place("kind")
        remedy = f'Name it with --{own}, or write kind="{kind}".'
        problems += _other_kind(document, "The document", f"--{kind} names it", place, remedy)
    loaded.problems = sorted(problems)
    return _without_ignored(loaded)


def _standing(world: str) -> str:
    """The robot at a world's first place, and the user a metre in front of it.

    Raises:
        DocumentError: the world is wrong.
        UsageError: it cannot be read, or has no place.
    """
    from html import escape
    from math import cos, radians, sin

    from prima.sim.map import read_world

    there = read_world(world, read_file(world))
    if not there.places:
        raise UsageError(f"{world}: this world has no place for the robot; write a <place> in it.")
    name, (x, y) = next(iter(there.places.items()))
    angle = radians(there.headings[name])
    return (
        f'<robot at="{escape(name)}"/><person x="{x + cos(angle):.3f}" y="{y + sin(angle):.3f}"/>'
    )


def _served(paths: list[str], maps: Iterable[str]) -> dict[str, str]:
    """What a scenario says of applications whose folders are mapped to URIs.

    Raises:
        UsageError: a mapping is none, or no application is in its folder.
    """
    from html import escape

    from prima.voicexml.site import mapped

    held = mappings(maps, paths)
    served: dict[str, str] = {}
    for path in paths:
        if found := mapped(path, held):
            served[path] = f' uri="{escape(found[0])}" folder="{escape(found[1])}"'
    return served


def _refuse_same_id(given: list[tuple[str, str]]) -> None:
    """Name the two applications of one id, by their options: the stage's own text is no file.

    Raises:
        UsageError: there are two.
    """
    seen: dict[str, str] = {}
    for kind, path in given:
        name, option = read_application(path, read_file(path))[0].id, f"--{kind} {path}"
        if name in seen:
            both = f"{option} is given twice"
            if seen[name] != option:
                both = f'{seen[name]} and {option} have the same id, "{name}"'
            raise UsageError(f"{both}. Leave one out, or run a copy with another id.")
        seen[name] = option


@few_guesses()
@seldom_collected()
def _load(path: Path, data: bytes, whole: bool = False, robot: str = "") -> Loaded:
    """Load a scenario; ``whole`` looks into all documents of its VoiceXML applications as well."""
    from prima.devices.profile import read_robot
    from prima.sim.devices import Cast
    from prima.sim.hearing import check_hearing
    from prima.sim.map import read_world
    from prima.sim.rehearsal import check_cast, check_names
    from prima.sim.scenario import look_at_scenario

    scenario, told = look_at_scenario(str(path), data)
    if robot:
        scenario.robot = os.path.relpath(robot, path.parent)
    reading = _Reading(path, {path.name: _digest(data)}, [*told], whole=whole)
    reading.answered = tuple(one.uri for one in scenario.services if one.uri)
    root = scenario.node
    for src, _, node in scenario.applications:
        reading.application(src, node.attribute_place("src"), node)
    reading.users(scenario)
    world = reading.read(scenario.world, root.attribute_place("world"), read_world)
    profile = reading.read(scenario.robot, root.attribute_place("robot"), read_robot)
    if world is not None:
        reading.problems += world.warnings
    offers = reading.offers(scenario, world) if world is not None and scenario.entrances else []
    if profile is not None:
        reading.check_commands(profile)
        reading.problems += profile.warnings
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
    if not any(problem.severity == "error" for problem in told):
        problems = in_order([*problems, *check_hearing(cast)])
    if any(problem.severity == "error" for problem in problems):
        raise DocumentError(problems)
    return Loaded(cast, reading.files, problems)


Made = TypeVar("Made")


@dataclass(slots=True)
class _Reading:
    """What has been read of a scenario, and all that is wrong with it."""

    path: Path
    files: dict[str, str]
    problems: list[Problem] = field(default_factory=list)
    documents: list[AnyDocument] = field(default_factory=list)
    whole: bool = False
    """Whether all documents of VoiceXML applications are looked into, not only the first."""
    answered: tuple[str, ...] = ()
    """How URIs begin that the scenario's services answer."""

    def read(self, name: str, place: Place, made_of: Callable[[str, bytes], Made]) -> Made | None:
        """A document that the scenario names, or None where it cannot be had."""
        if not name:
            return None  # told already, as a problem of the schema
        target = path_of(normpath(self.path.parent / name))
        content = b""
        try:
            content = read_file(target)
            self.files[name] = _digest(content)
            return made_of(str(target), content)
        except UsageError as error:
            wrong = str(error).removeprefix(f"{target}: ")
            at = place._replace(column=place.column + len(name) - len(target.name))
            hint = _nearby(target, Span.of(at, target.name))
            self.problems.append(UNREADABLE.at(place, hint, name=name, wrong=wrong))
        except DocumentError as error:
            self.problems += [_named_wrongly(name, place, one, content) for one in error.problems]
        return None

    def application(self, src: str, place: Place, node: Node | None = None) -> AnyDocument | None:
        """An application, with its problems."""
        said = node.get("kind") if node is not None else "ea"  # what a place offers is an EA
        own = (node.get("id") if node is not None else "", said or "ea")
        site = self.site(src, node) if node is not None else None

        def take(uri: str, data: bytes) -> None:
            beside = posixpath.join(posixpath.dirname(src), uri)
            self.files[posixpath.normpath(beside)] = _digest(data)

        def made_of(path: str, data: bytes) -> tuple[AnyDocument, list[Problem]]:
            document, problems = read_application(path, data, *own, site, take)
            further: Iterable[Problem] = ()
            if self.whole and is_voicexml(data):
                further = _voicexml_problems(path, data, site, self.answered)
            return document, [*problems, *further]

        read = self.read(src, place, made_of)
        if read is None:
            return None
        document, problems = read
        self.problems += problems
        self.documents.append(document)
        if node is not None:
            who = "this scenario says EA" if said == "ea" else "this scenario does not say so"
            who = "this scenario says FA" if said == "fa" else who
            remedy = f'Write kind="{document.node.get("kind")}" here, or change the document.'
            self.problems += _other_kind(document, f'"{src}"', who, place, remedy)
        if site is not None and node is not None and isinstance(document, Document):
            where = node.attribute_place("uri", value=False)
            self.problems.append(NOT_SERVED.at(where, src=src))
        return document

    def site(self, src: str, node: Node) -> Site | None:
        """Where an application is served, if the scenario says so; a wrong one is a problem."""
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

    def offers(self, scenario: Scenario, world: Map) -> list[tuple[Area, str]]:
        """The applications that a world's areas offer, but those that the scenario runs itself."""
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
                continue  # the scenario itself says when it runs
            if name not in known:
                known[name] = self.offered(name, area)
            document = known[name]
            if document is not None:
                made.append((area, document.id))
        return made

    def users(self, scenario: Scenario) -> None:
        """The documents of how persons behave."""
        from prima.sim.user import read_user

        wrong: set[str] = set()
        for person in scenario.persons:
            if person.user and person.user not in wrong and person.node is not None:
                place = person.node.attribute_place("user")
                user = self.read(person.user, place, partial(read_user, person=person.name))
                if user is None:
                    wrong.add(person.user)  # told once
                else:
                    scenario.take(person.name, user)

    def replies(self, scenario: Scenario) -> None:
        """What services answer fetches with."""
        for service in scenario.services:
            for reply in service.replies:
                if reply.src and reply.node is not None:
                    place = reply.node.attribute_place("src")
                    reply.body = self.read(reply.src, place, lambda _, data: data) or b""

    def offered(self, name: str, area: Area) -> AnyDocument | None:
        """What an area offers: an EA."""
        place = area.node.attribute_place("application")
        document = self.application(name, place)
        if document is not None:
            who, remedy = "a place offers EAs", 'Write kind="ea" in the document.'
            self.problems += _other_kind(document, f'"{area.src}"', who, place, remedy)
        return document

    def check_commands(self, robot: Profile) -> None:
        """Commands that the robot cannot do."""
        for document in self.documents:
            if isinstance(document, Document):
                self.problems += check_commands(document, robot.commands, robot.devices)
            else:
                from prima.voicexml import checks, sketched

                self.problems += checks.check_commands(document.page.root, robot.commands)
                self.problems += sketched.added_in_units(document.page, robot.commands)

    def check_policy(self, scenario: Scenario) -> None:
        """A policy that is none, or prefers an application that is not there."""
        from prima.scheduler.policy import UnknownPolicy, policy_named

        place = scenario.node.attribute_place("policy")
        try:
            policy_named(scenario.policy)
        except UnknownPolicy as error:
            spans = value_span(scenario.node, "policy", error.word) if error.meant else ()
            hint = replaced(f"{error.remedy} {FAVOURITE}", error.meant, *spans)
            self.problems.append(BAD_POLICY.at(place, hint, wrong=error.wrong))
        if problem := favourite_problem(scenario.policy, self.documents, scenario.node):
            wrong, hint = problem
            self.problems.append(NO_FAVOURITE.at(place, hint, wrong=wrong))


def _other_kind(
    document: AnyDocument, name: str, who: str, place: Place, remedy: str
) -> list[Problem]:
    """Warn of a document that says it is of another kind than the run does, which counts."""
    own = document.node.get("kind")
    if not isinstance(document, Document) or own in ("", document.kind):
        return []
    kind = document.kind.upper()
    return [RUNS_AS_OTHER.at(place, Hint(remedy), name=name, own=own.upper(), who=who, kind=kind)]


def _named_wrongly(name: str, place: Place, problem: Problem, content: bytes) -> Problem:
    """A document of another kind than the scenario needs is the mistake of who names it."""
    if problem.code != "wrong-namespace" or not kind_of(parse(name, content)):
        return problem
    return problem._replace(place=place, message=f'"{name}": {problem.message}', fixes=())


def _nearby(path: Path, *spans: Span) -> Hint:
    """The file beside that a name which leads nowhere most likely means: its ending says little."""
    try:
        beside = sorted(islice(path.parent.iterdir(), MOST_BESIDE))
    except (OSError, ValueError):
        return Hint()
    alike = sorted(beside, key=lambda one: one.suffix == path.suffix)  # the last one counts
    stems = {one.stem: one.name for one in alike if one.name != path.name}
    return meant(stems.get(near(path.stem, stems), ""), *spans)


MOST_BESIDE = 300
"""How many files of a folder are looked at for one that was meant."""
FAVOURITE = "fixed:APP prefers the application APP."
"""What to write for a policy that prefers one application."""


def favourite_problem(
    policy: str, documents: list[AnyDocument], node: Node | None = None
) -> tuple[str, Hint] | None:
    """What is wrong with the application that ``fixed:APP`` names, and what was meant."""
    kind, _, first = policy.partition(":")
    names = [document.id for document in documents]
    if kind != "fixed" or not first or first in names:
        return None
    spans = value_span(node, "policy", first) if node is not None else ()
    hint = suggestion(first, names, *spans) or Hint(f"Write {one_of(names)}.")
    return f'The policy "{policy}" names an application that is not in the scenario.', hint


def _digest(data: bytes) -> str:
    import hashlib

    return hashlib.sha256(data).hexdigest()


def schemas_folder() -> Path:
    """The folder of the schemas that come with the package."""
    inside = path_of(__file__).parent.parent / "schemas"
    return inside if inside.is_dir() else path_of(__file__).parent.parent.parent / "schemas"


def documents_folder() -> Path:
    """The folder of the demo documents that come with the package."""
    inside = path_of(__file__).parent.parent / "documents"
    return inside if inside.is_dir() else path_of(__file__).parent.parent.parent / "documents"
