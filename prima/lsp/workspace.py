"""The documents open in an editor, those on disk, and their relations."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

from prima.digraphs import led_to
from prima.errors import DocumentError
from prima.loading.applications import named_after
from prima.lsp.meanings import FILES, SHARED
from prima.lsp.names import FoundName, Mark, NameSpot, dialect, marks
from prima.lsp.paths import MOST_FILES, SUFFIXES, file_named, path_of, uri_of, walk
from prima.lsp.scan import ScannedText
from prima.lsp.tables import resolve
from prima.lsp.text import Lines
from prima.markup.encodings import ENCODING, decode
from prima.markup.limits import LIMITS

MOST_FOLDERS = 5_000
"""Maximum number of folders searched for them."""
FEW_FOLDERS = 50
"""Maximum number of folders searched around a document outside the workspace."""
FRESH_SECONDS = 3.0
"""How long a listing of the workspace is used."""


@dataclass
class Text:
    """A document's text, with results computed from it once."""

    text: str
    version: int | None = None
    stamp: tuple[int, int] = (0, 0)

    @cached_property
    def page(self) -> ScannedText:
        """Its tags."""
        return self._scanned()

    @cached_property
    def top(self) -> ScannedText:
        """Its first tag alone, which is found faster."""
        return self._scanned(most=1)

    def _scanned(self, most: int = 0) -> ScannedText:
        page = ScannedText(self.text, self.lines, most)
        resolve(page)
        return page

    @cached_property
    def lines(self) -> Lines:
        """Its lines."""
        return Lines(self.text)

    @cached_property
    def marks(self) -> list[Mark]:
        """Its names."""
        return marks(self.page)

    def data(self) -> bytes:
        """The text as bytes in its declared encoding."""
        match = ENCODING.match(self.text[:1000].encode("ascii", "replace"))
        try:
            return self.text.encode(match[1].decode() if match else "utf-8")
        except (LookupError, UnicodeEncodeError):
            return self.text.encode("utf-8", "replace")


class Workspace:
    """All documents that requests may be about."""

    def __init__(self) -> None:
        self.open: dict[Path, Text] = {}
        self.uris: dict[Path, str] = {}
        """The URIs by which the editor knows open documents."""
        self.folders: list[Path] = []
        self._read: dict[Path, Text] = {}
        self._listed: tuple[float, list[Path]] = (float("-inf"), [])

    # Documents ----------------------------------------------------------------

    def put(self, uri: str, text: str, version: int | None = None) -> Path | None:
        """Store an open document's text."""
        path = path_of(uri)
        if path is not None:
            self.open[path], self.uris[path] = Text(text, version), uri
        return path

    def drop(self, path: Path) -> None:
        """Close a document; its file is used again."""
        self.open.pop(path, None)
        self.uris.pop(path, None)

    def uri(self, path: Path) -> str:
        """The URI of a document, as the editor writes it."""
        return self.uris.get(path) or uri_of(path)

    def text(self, path: Path) -> Text | None:
        """A document, open or on disk; None if it cannot be read."""
        if path in self.open:
            return self.open[path]
        try:
            if not path.is_file():
                return None
            state = path.stat()
            stamp = (state.st_mtime_ns, state.st_size)
            kept = self._read.get(path)
            if kept is not None and kept.stamp == stamp:
                return kept
            if state.st_size > LIMITS.bytes:
                return None
            made = Text(decode(path.name, path.read_bytes()), stamp=stamp)
        except (OSError, ValueError, DocumentError):
            return None
        if len(self._read) >= MOST_FILES:
            self._read.clear()
        self._read[path] = made
        return made

    def marks(self, path: Path) -> list[Mark]:
        """The names in a document; none if it cannot be read."""
        text = self.text(path)
        return text.marks if text is not None else []

    def asked(self, uri: str) -> tuple[Path, Text] | None:
        """An open document by its URI."""
        path = path_of(uri)
        return (path, self.open[path]) if path is not None and path in self.open else None

    # The workspace ------------------------------------------------------------

    def forget(self) -> None:
        """Drop the listing, since files have changed."""
        self._listed = (float("-inf"), [])

    def files(self) -> list[Path]:
        """The documents of the workspace, the open ones, and those beside them."""
        since, listed = self._listed
        if time.monotonic() - since > FRESH_SECONDS:
            lone = {path.parent.parent for path in self.open if not self._has_folder(path)}
            listed = [*walk(self.folders, MOST_FOLDERS), *walk(sorted(lone), FEW_FOLDERS)]
            self._listed = (time.monotonic(), listed)
        return sorted({*listed, *self.open})

    def _has_folder(self, path: Path) -> bool:
        return any(folder in path.parents for folder in self.folders)

    def has_uris(self, path: Path) -> bool:
        """Whether a document names files by URIs; scenarios and worlds name them plainly."""
        text = self.text(path)
        return text is None or dialect(text.top) not in ("scenario", "world")

    def target(self, path: Path, name: str) -> Path | None:
        """The file that a relative name in a document means."""
        return file_named(path.parent, name, self.has_uris(path))

    def named(self, path: Path) -> list[tuple[Path, int, int]]:
        """The files that a document names, with the positions of their names."""
        text, uris = self.text(path), self.has_uris(path)
        found: list[tuple[Path, int, int]] = []
        for tag in text.page.tags if text else ():
            for attr in tag.attributes:
                key = (tag.vocabulary.name if tag.vocabulary else "", tag.key, attr.name)
                if key not in FILES or attr.first < 0:
                    continue
                target = file_named(path.parent, attr.value, uris)
                if target is not None:
                    space = len(attr.value) - len(attr.value.lstrip())
                    name = attr.value.strip()
                    length = len(name.partition("#")[0].partition("?")[0] if uris else name)
                    first = attr.first + space
                    found.append((target, first, first + length))
        return found

    def reading(self, path: Path, ways: Callable[[Path], set[Path]] | None = None) -> set[Path]:
        """The files that a scenario or world names, those that its world and pages name, and so on."""
        return led_to((one for one, *_ in self.named(path)), ways or self._ways)

    def _ways(self, path: Path) -> set[Path]:
        """The files that a world or a page of VoiceXML names; recordings are not looked into."""
        text = self.text(path) if path.suffix.lower() in SUFFIXES else None
        known = text is not None and dialect(text.top) in ("world", "voicexml")
        return {one for one, *_ in self.named(path)} if known else set()

    def _scenes(self) -> Iterator[tuple[Path, set[Path]]]:
        """Every scenario with the files that belong to it."""
        ways = cache(self._ways)
        for path in self.files():
            text = self.text(path)
            if text is None or "scenario" not in text.text or dialect(text.top) != "scenario":
                continue
            yield path, self.reading(path, ways) | {path}

    def related(self, path: Path) -> list[Path]:
        """A document and those in a scenario with it."""
        found = {path}
        for _, belongs in self._scenes():
            if path in belongs:
                found |= belongs
        return sorted(found)

    def naming(self, path: Path) -> list[NameSpot]:
        """Where documents of the workspace name a file."""
        return [
            NameSpot(other, start, end)
            for other in self.files()
            for target, start, end in self.named(other)
            if target == path
        ]

    # Names ----------------------------------------------------------------------

    def uses(self, path: Path, mark: Mark, *, all_scenes: bool = True) -> list[FoundName]:
        """All uses of a name, including its definition; or those in scenarios of a document."""
        found = self._elsewhere(path, mark) if mark.file else []
        if found or (mark.file and "variable" not in mark.kind):
            return found
        if mark.is_state:
            form = self._form_of(path, mark)
            return self.uses(form.path, form.mark) if form is not None else []
        own = [FoundName(path, one) for one in self.marks(path) if one.names(mark)]
        if mark.shared:
            return own + self._shared(path, mark, all_scenes)
        return own + self._beyond(path, mark)

    def _beyond(self, path: Path, mark: Mark) -> list[FoundName]:
        """Uses in other documents of what only this document defines."""
        found = []
        if mark.inherited:
            found += self._from_others(path, mark, mark.name, "application")
        if "form" in mark.kind or "rule" in mark.kind:
            found += self._from_others(path, mark, f"#{mark.name}")
        if "form" in mark.kind:
            found += self._expected(path, mark)
        return found

    def _shared(self, path: Path, mark: Mark, all_scenes: bool) -> list[FoundName]:
        """The uses in documents of a scenario with it, or with one of these that has the name."""
        scenes = [belongs for _, belongs in self._scenes()]
        found: list[FoundName] = []
        seen, waiting = {path}, [path]
        while waiting:
            here = waiting.pop()
            for other in set().union(*(one for one in scenes if here in one)) - seen:
                seen.add(other)
                same = [one for one in self.marks(other) if one.is_like(mark)]
                found += [FoundName(other, one) for one in same]
                waiting += [other] if same and all_scenes else []
        return sorted(found, key=lambda one: (one.path, one.mark.start))

    def _elsewhere(self, path: Path, mark: Mark) -> list[FoundName]:
        """The uses of a name of another file."""
        target = self.target(path, mark.file)
        if target is None:
            return []
        own = (one for one in self.marks(target) if one.defines and one.is_like(mark))
        found = next((one for one in own if one.scope < 0 or "variable" not in one.kind), None)
        return self.uses(target, found) if found is not None else []

    def _from_others(self, path: Path, mark: Mark, *words: str) -> list[FoundName]:
        """Where other documents, with some words, name something of this one."""
        found = []
        for other in self.files():
            text = self.text(other)
            if text is None or not all(word in text.text for word in words):
                continue
            for one in text.marks:
                if one.file and one.is_like(mark) and self.target(other, one.file) == path:
                    found.append(FoundName(other, one))
        return found

    def _expected(self, path: Path, mark: Mark) -> Iterator[FoundName]:
        """Where scenarios expect an application to be in a form of this document."""
        for scene, belongs in self._scenes():
            for one in self.marks(scene) if path in belongs else ():
                form = self._form_of(scene, one) if one.name == mark.name else None
                if form is not None and form.path == path:
                    yield FoundName(scene, one)

    def _form_of(self, path: Path, state: Mark) -> FoundName | None:
        """The form that an expectation names: of its application, or of the first that has it."""
        forms = self.forms(path, state.tag.get("by")) if state.is_state else []
        return next((one for one in forms if one.mark.name == state.name), None)

    def forms(self, path: Path, by: str = "") -> list[FoundName]:
        """The forms of an application of a scenario, or of all its applications."""
        scene = self.text(path)
        tags = [one for one in (scene.page.tags if scene else ()) if one.key == "application"]
        called = {self.target(path, one.get("src")): one.get("id") for one in tags}
        written = [one for one in called if one is not None]
        paths = [*written, *sorted(self.reading(path).difference(written))]
        named = [one for one in paths if by in ("", called.get(one) or self._id_of(one))]
        pages = [*named, *sorted(led_to(named, self._ways).difference(named))]
        return self._defined(pages, frozenset({"form"}))

    def _id_of(self, path: Path) -> str:
        """A document's id, or else the name of its file."""
        root = text.top.root if (text := self.text(path)) else None
        return (root.get("id") if root else "") or named_after(path)

    def called(self, path: Path) -> list[str]:
        """The names of a scenario's VoiceXML applications that are those of their files."""
        scene = self.text(path)
        tags = [one for one in (scene.page.tags if scene else ()) if one.key == "application"]
        files = [self.target(path, one.get("src")) for one in tags if not one.get("id")]
        texts = [(one, self.text(one)) for one in files if one is not None]
        return [named_after(one) for one, text in texts if text and dialect(text.top) == "voicexml"]

    def given(self, path: Path, mark: Mark) -> list[FoundName]:
        """The definitions of a name: in its scenarios, or else anywhere in the workspace."""
        found = [one for one in self.uses(path, mark, all_scenes=False) if one.mark.defines]
        if not found and mark.shared:
            found = [one for one in self.known(path, mark.kind) if one.mark.name == mark.name]
        return found

    def known(self, path: Path, kinds: Iterable[str], anywhere: bool = True) -> list[FoundName]:
        """Definitions of some kinds that a document may use, each name once.

        They are those of its scenarios, or of the whole workspace if it is in none.
        """
        wanted = frozenset(kinds)
        found = [
            FoundName(path, one)
            for one in self.marks(path)
            if one.defines and not wanted.isdisjoint(one.kind)
        ]
        if not SHARED.isdisjoint(wanted):
            others = [one for one in self.related(path) if one != path]
            found += self._defined(others, wanted)
            if anywhere and not (found or others):
                found += self._defined(self.files(), wanted)
        once: dict[str, FoundName] = {}
        for one in found:
            once.setdefault(one.mark.name, one)
        return list(once.values())

    def _defined(self, paths: Iterable[Path], wanted: frozenset[str]) -> list[FoundName]:
        found = []
        for path in paths:
            text = self.text(path)
            own = dialect(text.top) if text else ""
            private = "event" if own in ("dialogue", "voicexml") else ""
            for one in self.marks(path):
                if one.defines and wanted.intersection(one.kind) and private not in one.kind:
                    found.append(FoundName(path, one))
        return found
