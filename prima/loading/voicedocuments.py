"""Problems of VoiceXML documents and of those that they lead to."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from os.path import dirname
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from prima.errors import (
    Hint,
    Problem,
    UsageError,
    replaced,
)
from prima.loading.applications import fetcher, in_folder
from prima.loading.diagnoses import (
    NO_FILE_HERE,
    NOT_FETCHED,
    OUTSIDE,
    TOO_LARGE_HERE,
)
from prima.loading.files import Folder, relative, size_of, texts_of
from prima.loading.similar import nearby
from prima.markup.limits import LIMITS
from prima.markup.spans import value_span

if TYPE_CHECKING:
    from prima.markup.tree import Node
    from prima.voicexml.document import Page, VoiceDocument
    from prima.voicexml.pages import Pages
    from prima.voicexml.site import Site


def mappings(maps: Iterable[str], paths: Iterable[str]) -> dict[str, str]:
    """Folders by the URIs at which they are served, from ``URI=FOLDER``.

    Raises:
        UsageError: a mapping is invalid, or none of the documents is in its folder.
    """
    from prima.voicexml.site import mapped, mapping_of

    held: dict[str, str] = {}
    paths = list(paths)
    for text in texts_of(maps, "maps"):
        try:
            uri, folder = mapping_of(text)
        except ValueError as error:
            raise UsageError(f"--map {' '.join(error.args)}") from None
        held[uri] = folder
        if not any(mapped(path, {uri: folder}) for path in paths):
            raise UsageError(f"--map {text}: no VoiceXML application is in the folder {folder}.")
    return held


def mapped_site(path: str, maps: Mapping[str, str]) -> Site | None:
    """Where a document is served by the mapping of its folder, if there is one."""
    if not maps:
        return None
    from prima.voicexml.site import mapped, site_of

    found = mapped(path, maps)
    return site_of(path, *found) if found else None


def pages_from(
    path: str, data: bytes, site: Site | None = None, folder: str | None = None
) -> Pages:
    """A VoiceXML document and those of its folder that it leads to.

    ``folder`` is that of the application, by default the document's own.
    """
    from prima.voicexml.pages import Pages
    from prima.voicexml.reading import read_page

    place = site.folder if site else dirname(path) if folder is None else folder
    name = site.name(site.uri) if site else relative(path, place)
    return Pages(read_page(name, path, data, site), place, Folder(str(Path(place))).fetch)


def voicexml_problems(pages: Pages, answered: tuple[str, ...] = ()) -> Iterator[Problem]:
    """The problems of the documents of a VoiceXML application.

    URIs with a prefix in ``answered`` are a service's.
    """
    from prima.voicexml.caught import check_caught
    from prima.voicexml.checks import check_failing
    from prima.voicexml.document import FetchError
    from prima.voicexml.listening import check_listening
    from prima.voicexml.sketched import check_sketched
    from prima.voicexml.upgrade import is_other_version
    from prima.voicexml.variables import check_variables

    folder = Path(pages.folder)

    def script(page: Page, node: Node) -> str | None:
        try:
            source = page.resolve(node.get("src"), node) if node.get("src") else ""
            return Folder(str(folder)).fetch(source).decode("utf-8") if source else None
        except (FetchError, ValueError):
            return None

    for page in pages:
        if is_other_version(page.root):
            yield from page.problems
            continue
        missing: set[Node] = set()
        yield from (*page.problems, *page.warnings())
        yield from _not_there(page, pages.nodes(page), folder, answered, missing)
        yield from _not_fetched(page)
        yield from _grammars_of(page, folder, missing, answered)
        yield from check_caught(page.root, pages.thrown)
        yield from check_listening(page, root := pages.root(page))
        if root is not None:
            yield from check_failing(page.root, root.root)
    rooted = [(page, pages.root(page)) for page in pages]
    roots = {id(root) for _, root in rooted}
    for page, root in rooted:
        if not is_other_version(page.root):
            yield from check_variables(page, root, script, id(page) in roots)
    yield from check_sketched(rooted)
    yield from (*pages.problems, *pages.between())


def read_named(document: VoiceDocument) -> None:
    """Read all files that an application names literally, as far as they can be read.

    What a grammar refers to is read as well; of a sound only the header.
    """
    from prima.voicexml.document import FetchError
    from prima.voicexml.pages import pages_of

    pages = pages_of(document)
    for page in pages:
        named: list[tuple[Callable[[str], object], str]] = [
            (document.fetch, file) for _, _, file in _files_named(page, pages.nodes(page), ())
        ]
        for node in page.root.walk():
            if node.tag == "audio" and node.get("src"):
                named.append((document.glance, page.resolve(node.get("src"), node)))
            elif node.tag == "grammar":
                _of_files(node, page, Path(document.folder), ())
        for read, file in named:
            with suppress(FetchError):
                read(file)


NAMING_FILES = {
    "src": frozenset(["script", "grammar", "data", "subdialog"]),
    "next": frozenset(["goto", "link", "choice", "submit"]),
    "application": frozenset(["vxml"]),
}
"""Attributes of VoiceXML elements that name a file, unless they name something else."""


SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:|//")
"""URI schemes that do not name a file."""


def _not_there(
    page: Page,
    nodes: Iterable[Node],
    folder: Path,
    answered: tuple[str, ...],
    missing: set[Node],
) -> Iterator[Problem]:
    """Warn of files that elements of a VoiceXML document name but its folder lacks, or are too large.

    The elements that name them are put into ``missing``.
    """
    from prima.voicexml.pages import TARGETS

    listed: dict[Path, list[Path]] = {}
    whole = folder.resolve()
    for node, name, file in _files_named(page, nodes, answered):
        size = size_of(folder / file)
        inside = not file.startswith("../")
        if size is not None and inside and (folder / file).resolve().is_relative_to(whole):
            if size > LIMITS.bytes:
                missing.add(node)
                place = node.attribute_place(name)
                yield TOO_LARGE_HERE.at(place, file=file[:80], size=size, most=LIMITS.bytes)
            continue
        uri = node.get(name).strip().partition("#")[0].partition("?")[0]
        spans = value_span(node, name, uri)
        missing.add(node)
        if size is not None:
            yield OUTSIDE.at(node.attribute_place(name), file=file[:80])
            continue
        few = len(missing) <= LIMITS.problems  # problems that are not listed need no hint
        hint = nearby(folder / file, uri, *spans, listed=listed) if few else Hint()
        dialog = node.get(name).strip()
        if dialog in page.dialogs and node.key in TARGETS:
            text = f'It is a dialog: write "#{dialog}".'
            hint = replaced(text, f"#{dialog}", *value_span(node, name))
        yield NO_FILE_HERE.at(node.attribute_place(name), hint, file=file[:80])


def _files_named(
    page: Page, nodes: Iterable[Node], answered: tuple[str, ...]
) -> Iterator[tuple[Node, str, str]]:
    """The files that elements name, with the attribute, except URIs ``answered`` by services."""
    for node in nodes:
        for name, tags in NAMING_FILES.items():
            uri = node.get(name).strip()
            if node.tag not in tags or not uri or uri.startswith("#"):
                continue
            whole = page.resolve(uri, node)
            file = unquote(whole.partition("#")[0].partition("?")[0]).lstrip("/")
            if file and not _is_elsewhere(whole, page, answered):
                yield node, name, file


ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9.-]*:[0-9]{1,5}(?:/.*)?")
"""A host with a port, as it is written where its scheme is missing."""


def _not_fetched(page: Page) -> Iterator[Problem]:
    """Warn of URIs whose scheme neither hosts nor services answer."""
    from prima.voicexml.document import REMOTE

    for node in page.root.walk():
        for name, tags in NAMING_FILES.items():
            uri = node.get(name).strip()
            scheme = uri.partition(":")[0]
            known = scheme.lower() in REMOTE or (node.tag, scheme) == ("grammar", "builtin")
            if node.tag in tags and not known and SCHEME.match(uri) and uri[0] != "/":
                hint = Hint(f'Write "http://{uri}".') if ADDRESS.fullmatch(uri) else Hint()
                yield NOT_FETCHED.at(node.attribute_place(name), hint, scheme=scheme[:40])


def _grammars_of(
    page: Page, folder: Path, missing: set[Node], answered: tuple[str, ...]
) -> Iterator[Problem]:
    """Problems of grammars with files, and of the existing files that a VoiceXML document names."""
    site = page.site
    for node in page.root.walk():
        if node.tag != "grammar" or node in missing:
            continue
        for problem in _of_files(node, page, folder, answered):
            if problem.place.file != node.source.file:
                file = problem.place.file
                place = problem.place._replace(file=site.name(file) if site else file)
                yield in_folder(folder, problem._replace(place=place))
            elif problem.code != "no-such-file" or not node.get("src"):  # which is reported already
                yield problem


def _of_files(node: Node, page: Page, folder: Path, answered: tuple[str, ...]) -> list[Problem]:
    """The problems of a grammar that are not found in its element alone."""
    from prima.voicexml.checks import grammar_problems

    site = page.site
    fetch, base = fetcher(folder, site), site.whole(page.base()) if site else page.base()
    uri = node.get("src").strip()
    if uri.startswith("builtin:"):
        return []
    if uri:
        elsewhere = SCHEME.match(page.resolve(uri, node))
        return grammar_problems(node, page.lang, base, None if elsewhere else fetch)
    files = [page.resolve(one, node) for one in _referred(node)]
    if not files or any(_is_elsewhere(one, page, answered) for one in files):
        return []
    own = grammar_problems(node, page.lang)
    return [one for one in grammar_problems(node, page.lang, base, fetch) if one not in own]


REFERENCE = re.compile(r"\$<\s*+([^<>\s]*)")
"""A reference in the ABNF form, up to its URI."""


def _referred(node: Node) -> list[str]:
    """The URIs of other grammars to which the rules of a grammar in a document refer."""
    uris = [one.get("uri").strip() for one in node.walk() if one.tag == "ruleref"]
    uris += REFERENCE.findall(node.own_text)
    return [uri for uri in uris if uri and not uri.startswith(("#", "builtin:"))]


def _is_elsewhere(whole: str, page: Page, answered: tuple[str, ...]) -> bool:
    """Whether a URI names no file of the folder: a service answers it, or a host."""
    if page.site is not None and page.site.whole(whole).startswith(answered):
        return True
    return SCHEME.match(whole) is not None
