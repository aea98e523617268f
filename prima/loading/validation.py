"""All problems of documents of any kind."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os.path import dirname, join, normpath
from pathlib import Path

from prima.checks.ignores import Ignores
from prima.errors import (
    DocumentError,
    Problem,
    few_guesses,
    in_order,
    listed,
)
from prima.interpreter.elements import Document
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.loading.applications import fetcher, in_folder, read_native, services_of
from prima.loading.files import absolute, noting_fetched, paths_of, read_file, relative
from prima.loading.folders import documents_folder
from prima.loading.kinds import GRAMMAR_FILES, is_grammar, is_surely_ours, is_voicexml
from prima.loading.reading import Reading
from prima.loading.scenarios import load_whole
from prima.loading.voicedocuments import mapped_site, mappings, pages_from, voicexml_problems
from prima.markup.collecting import seldom_collected
from prima.markup.encodings import misread
from prima.markup.limits import LIMITS
from prima.markup.reader import parse
from prima.markup.roots import check_root


def validate(paths: str | Path | Iterable[str | Path], maps: Iterable[str] = ()) -> list[Problem]:
    """Give all problems of documents of any kind, for a scenario also of the documents it names.

    Those that authors ignore, in a document or in ``prima.toml``, are omitted. If there are very
    many, the last one counts those omitted (:func:`prima.errors.listed`).

    Args:
        paths: the documents, or one.
        maps: folders of VoiceXML documents and where they are served, as ``URI=FOLDER``.

    Raises:
        UsageError: a file cannot be read, or a mapping is invalid.
    """
    named = paths_of(paths, "paths")
    validation = Validation(mappings(maps, named))
    problems = [problem for path in upper_first(named) for problem in validation.problems(path)]
    return listed(sorted(once([*problems, *validation.ignored()])), LIMITS.problems)


def upper_first(paths: Iterable[str]) -> list[str]:
    """Files in the order in which they are to be checked: an application before its subfolders."""
    return sorted(paths, key=lambda path: len(absolute(path).parts))


def once(problems: Iterable[Problem]) -> list[Problem]:
    """Remove duplicates: an error in a file is not repeated as a warning of its referrers."""
    found = dict.fromkeys(problems)
    warned = {one.place for one in found if one.severity != "error"}
    errors = {
        (one.place, one.message) for one in found if one.severity == "error" and one.place in warned
    }
    return [
        one for one in found if one.severity == "error" or (one.place, one.message) not in errors
    ]


class Validation:
    """Checks documents one after the other, and finally their ignores.

    A page or a grammar that an application has fetched from a folder below its own may name files
    in the application's folder.

    Args:
        maps: folders of VoiceXML documents by the URIs at which they are served.
    """

    def __init__(self, maps: Mapping[str, str] | None = None) -> None:
        self._maps = maps or {}
        self._ignores = Ignores(read_file)
        self._folders: dict[Path, Path] = {}
        """The folders of the applications that have fetched files, by the files."""
        self._pages: set[tuple[Path, str]] = set()
        """The documents of the VoiceXML applications checked, and the URIs of their folders."""

    def problems(self, path: str | Path) -> list[Problem]:
        """The problems of a document that are not ignored.

        Raises:
            UsageError: the file cannot be read.
        """
        with few_guesses(), seldom_collected(), noting_fetched(self._folders):
            found = self._ignores.left(self._all(str(path)))
        self._ignores.check(str(path))
        return in_order(found)

    def ignored(self) -> list[Problem]:
        """The problems of ignores in the documents checked: no reason, or nothing to ignore."""
        return in_order(self._ignores.problems())

    def _all(self, path: str) -> list[Problem]:
        try:
            data = read_file(path)
            return [*misread(path, data), *self._by_kind(path, data)]
        except DocumentError as error:
            return error.problems

    def _by_kind(self, path: str, data: bytes) -> list[Problem]:
        """The problems of a document, by its beginning.

        Raises:
            DocumentError: with its problems, if any is an error.
        """
        if is_surely_ours(data):
            return _application_problems(path, data)
        if is_voicexml(data):
            return self._voicexml(path, data)
        if is_grammar(data) or path.lower().endswith(GRAMMAR_FILES):
            return _grammar_problems(path, data, self._folder(path))
        return _problems_by_namespace(path, data)

    def _voicexml(self, path: str, data: bytes) -> list[Problem]:
        """The problems of a VoiceXML document and of all that it leads to, unless one led to it."""
        site = mapped_site(path, self._maps)
        served = site.root if site else ""
        if (absolute(path), served) in self._pages:
            return []
        pages = pages_from(path, data, site, self._folder(path))
        self._pages.update((absolute(page.root.source.file), served) for page in pages.whole)
        return list(voicexml_problems(pages))

    def _folder(self, path: str) -> str:
        """The folder whose files a document may name, written as the document's path is."""
        file = absolute(path)
        folder = self._folders.get(file, file.parent)
        up = [".."] * len(file.parent.relative_to(folder).parts)
        named = normpath(join(dirname(path), *up)) if up else dirname(path)
        return "" if named == "." else named


def _problems_by_namespace(path: str, data: bytes) -> list[Problem]:
    """The problems of one of PRIMA's own documents.

    Raises:
        DocumentError: with its problems, if any is an error.
    """
    from prima.devices.profile import read_robot
    from prima.devices.vocabulary.robot import ROBOT
    from prima.devices.vocabulary.services import SERVICES
    from prima.sim.user import read_user
    from prima.sim.vocabulary.scenario import SCENARIO
    from prima.sim.vocabulary.user import USER
    from prima.sim.vocabulary.world import WORLD

    kinds = (DIALOGUE, WORLD, ROBOT, SCENARIO, USER, SERVICES)
    match check_root(parse(path, data, kinds), kinds).namespace:
        case DIALOGUE.namespace:
            return _application_problems(path, data)
        case WORLD.namespace:
            return _world_problems(path, data)
        case ROBOT.namespace:
            return read_robot(path, data).warnings
        case SERVICES.namespace:
            services_of(path, data)
        case USER.namespace:
            return read_user(path, data).warnings
        case _:
            return load_whole(Path(path), data, whole=True).problems
    return []


def _world_problems(path: str, data: bytes) -> list[Problem]:
    """The problems of a world, and of the applications that its areas offer."""
    from prima.sim.map import read_world

    world = read_world(path, data)
    reading = Reading(Path(path), {}, [*world.warnings])
    for area in world.areas:
        if area.src not in reading.files:
            reading.offered(area.src, area)
    return reading.problems


def _application_problems(path: str, data: bytes) -> list[Problem]:
    """The problems of an application in PRIMA's own language."""
    document, problems = read_native(path, data)
    return problems + _prices(document) if b"<iu" in data else problems


def _grammar_problems(path: str, data: bytes, folder: str) -> list[Problem]:
    """The problems of a grammar, and of those in a folder that it refers to."""
    from prima.grammar import load

    place = Path(folder)
    try:
        problems = load(data, base=relative(path, folder), fetch=fetcher(place)).warnings()
    except DocumentError as error:
        problems = error.problems
    return [in_folder(place, problem) for problem in problems]


def _prices(document: Document) -> list[Problem]:
    """The cost of an application's units to others, on the demo's robot, as notes."""
    from prima.checks.prices import notes
    from prima.devices.profile import read_robot

    robot = documents_folder() / "robots" / "papero.xml"
    return notes(document, read_robot(str(robot), read_file(robot)))
