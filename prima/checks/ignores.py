"""Ignores: warnings and notes that authors suppress, with a reason.

A comment in a document, ``<!-- prima-ignore: CODE reason -->``, applies to the element after it
and its content; before the root element it applies to the whole document. An ``[[ignore]]`` of the
nearest ``prima.toml``, from a document's folder upwards, applies to all documents, or those that
it names. Errors are never ignored: a document with errors does not run.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from os.path import dirname, isabs, isfile, join, realpath, relpath
from pathlib import Path
from typing import Any

from prima.errors import DocumentError, Place, Problem, UsageError, suggestion
from prima.errors.diagnoses.validation import (
    NO_CODE,
    NO_COLON,
    NO_ENTRIES,
    NO_FILES,
    NO_REASON,
    NOT_READ,
    NOT_TOML,
    UNKNOWN_CODE,
    UNKNOWN_KEY,
    UNKNOWN_SETTING,
    UNUSED_IGNORE,
)
from prima.markup.encodings import decode
from prima.markup.toml import MOST_CHARACTERS, NotToml, parse_toml
from prima.markup.tree import MARKUP, Source

SETTINGS = "prima.toml"
KINDS = (".xml", ".vxml", ".grxml", ".gram", ".abnf")
"""Suffixes of documents."""
WORD = "prima-ignore"
COMMENT = re.compile(rf"\s*{WORD}\b\s*(:?)\s*(\S*)\s*(.*?)\s*", re.DOTALL)
FORM = f"Write <!-- {WORD}: CODE reason -->."
OF_SCENARIOS = frozenset(
    [
        *("unsupported-command", "no-such-name", "no-such-argument", "missing-attribute"),
        *("out-of-range", "bad-value", "unknown-event", "unheard-event"),
    ]
)
"""Codes of warnings that may depend on the scenario, so that an ignore may be needed there."""
ENTRY = re.compile(r"^[ \t]*\[\[[ \t]*ignore[ \t]*\]\]", re.MULTILINE)
KEYS = ("code", "files", "reason")

Position = tuple[int, int]
"""A line and a column, from 1."""
EVERYWHERE: tuple[Position, Position] = ((0, 0), (10**9, 0))


@dataclass(slots=True)
class Ignore:
    """One ignore."""

    code: str
    place: Place
    span: tuple[Position, Position] = EVERYWHERE
    """The range of its document to which it applies."""
    files: tuple[str, ...] = ("*",)
    used: bool = False
    around: Ignore | None = None
    """The next of its code that applies to everything that it applies to."""

    def use(self) -> None:
        """Mark it, and those around it, as used."""
        one: Ignore | None = self
        while one is not None and not one.used:
            one.used, one = True, one.around


class DocumentIgnores:
    """The ignores of one document; two of the same code are nested or disjoint."""

    def __init__(self, ignores: Iterable[Ignore]) -> None:
        self.all = list(ignores)
        by_code: dict[str, list[Ignore]] = {}
        for one in self.all:
            if one.span[0] < one.span[1]:
                by_code.setdefault(one.code, []).append(one)
        self._turns = {code: list(_turns(found)) for code, found in by_code.items()}
        """By code, the places from which another one applies, or none."""

    def taking(self, problem: Problem) -> Ignore | None:
        """The innermost one that applies to a problem."""
        turns = self._turns.get(problem.code)
        if turns is None:
            return None
        at = (problem.place.line, problem.place.column)
        index = bisect_right(turns, at, key=lambda turn: turn[0])
        return turns[index - 1][1] if index else None


def _turns(ignores: list[Ignore]) -> Iterator[tuple[Position, Ignore | None]]:
    """Where another ignore of a code begins to apply, or the enclosing one applies again."""
    open_: list[Ignore] = []
    for one in sorted(ignores, key=lambda one: (one.span[0], _backwards(one.span[1]))):
        while open_ and open_[-1].span[1] <= one.span[0]:
            yield open_.pop().span[1], open_[-1] if open_ else None
        one.around = open_[-1] if open_ else None
        open_.append(one)
        yield one.span[0], one
    while open_:
        yield open_.pop().span[1], open_[-1] if open_ else None


def _backwards(position: Position) -> Position:
    """A sort key that puts later positions before earlier ones."""
    return -position[0], -position[1]


@dataclass(slots=True)
class IgnoreSettings:
    """The ``[[ignore]]`` entries of a ``prima.toml``."""

    path: str
    ignores: list[Ignore] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    def for_file(self, file: str) -> Iterator[Ignore]:
        """The entries that apply to a document in its folder."""
        name = relpath(file, dirname(self.path)).replace("\\", "/")
        return (one for one in self.ignores if any(fnmatchcase(name, glob) for glob in one.files))


class Ignores:
    """The ignores of all documents of one validation, and those that are unused."""

    def __init__(self, read: Callable[[str], bytes]) -> None:
        self._read = read
        self._documents: dict[str, tuple[DocumentIgnores, list[Problem]]] = {}
        self._paths: dict[str, str] = {}
        self._settings: dict[str, IgnoreSettings | None] = {}
        self._checked: dict[str, str] = {}
        """The checked documents, by the names used in messages."""
        self._errors: dict[str, set[str]] = {}
        """The codes of errors by document, whose warnings are therefore uncertain."""

    def left(self, problems: Iterable[Problem]) -> list[Problem]:
        """The problems without an ignore."""
        found = list(problems)
        for problem in found:
            if problem.severity == "error":
                self._errors.setdefault(self._path(problem.place.file), set()).add(problem.code)
        return [problem for problem in found if not self._ignored(problem)]

    def check(self, file: str) -> None:
        """Check the ignores of a document itself, once its problems have been filtered."""
        self._checked[absolute(file)] = file

    def problems(self) -> list[Problem]:
        """The problems of the ignores of the documents checked, including unused ones."""
        found: list[Problem] = []
        settings: dict[str, IgnoreSettings] = {}
        for path, file in self._checked.items():
            ignores, problems = self._of_document(path, file)
            found += problems
            errors = self._errors.get(path)
            idle = [one for one in ignores.all if self._is_idle(one)]
            found += [_unused(one) for one in idle if errors is None or one.code in errors]
            if (own := self._of_folder(dirname(path))) is not None:
                settings[own.path] = own
        for own in settings.values():
            wrong = own.problems + [_unused(one) for one in own.ignores if self._is_over(one, own)]
            found += [self._as_others(problem) for problem in wrong]
        return found

    def _as_others(self, problem: Problem) -> Problem:
        """A problem of settings, whose file is named like the documents: absolutely or not."""
        if any(map(isabs, self._checked.values())):
            return problem
        return problem._replace(place=problem.place._replace(file=relpath(problem.place.file)))

    @staticmethod
    def _is_idle(ignore: Ignore) -> bool:
        """Whether an ignore of a document is certainly unused."""
        empty = ignore.span[0] >= ignore.span[1]
        return not ignore.used and (empty or ignore.code not in OF_SCENARIOS)

    def _is_over(self, ignore: Ignore, settings: IgnoreSettings) -> bool:
        """Whether an entry is unused, and all documents that it names are checked and right."""
        if ignore.used:
            return False
        within = Path(settings.path).parent.rglob("*")
        documents = (str(one) for one in within if one.suffix in KINDS)
        return all(
            one in self._checked and one not in self._errors
            for one in documents
            if any(ignore is other for other in settings.for_file(one))
        )

    def _ignored(self, problem: Problem) -> bool:
        if problem.severity == "error":
            return False
        file = problem.place.file
        path = self._path(file)
        settings = self._of_folder(dirname(path))
        inside = self._of_document(path, file)[0].taking(problem)
        found = [inside] if inside else []
        if settings is not None:
            found += [one for one in settings.for_file(path) if one.code == problem.code]
        for one in found:
            one.use()
        return bool(found)

    def _path(self, file: str) -> str:
        """A file's path, cached as many problems share it."""
        if file not in self._paths:
            self._paths[file] = absolute(file)
        return self._paths[file]

    def _of_document(self, path: str, file: str) -> tuple[DocumentIgnores, list[Problem]]:
        if path not in self._documents:
            try:
                ignores, problems = in_document(file, self._read(file))
                self._documents[path] = DocumentIgnores(ignores), problems
            except (DocumentError, UsageError):
                self._documents[path] = DocumentIgnores(()), []  # reading it reports the error
        return self._documents[path]

    def _of_folder(self, folder: str) -> IgnoreSettings | None:
        """The settings that apply in a folder: only the nearest."""
        if folder not in self._settings:
            file = join(folder, SETTINGS)
            if isfile(file):
                self._settings[folder] = read_settings(file)
            else:
                above = dirname(folder)
                self._settings[folder] = None if above == folder else self._of_folder(above)
        return self._settings[folder]


def absolute(file: str) -> str:
    """A file's real path, equal for different names of the same file."""
    try:
        return realpath(file)
    except (OSError, ValueError):
        return file


def _unused(ignore: Ignore) -> Problem:
    return UNUSED_IGNORE.at(ignore.place, code=ignore.code)


def _incomplete(place: Place, code: str, reason: str, form: str) -> Problem | None:
    """The problem of an ignore's code or reason, if any."""
    from prima.checks.codes import diagnoses  # imports every check, and few documents have ignores

    known = diagnoses()
    if code in known:
        return None if reason else NO_REASON.at(place, code=code, form=form)
    hint = suggestion(code, known)
    return (UNKNOWN_CODE if code else NO_CODE).at(place, hint, code=code, form=form)


# Documents ----------------------------------------------------------------------------------


def in_document(file: str, data: bytes) -> tuple[list[Ignore], list[Problem]]:
    """The ignores of a document, and their problems."""
    if WORD.encode() not in data.replace(b"\0", b""):
        return [], []
    source = Source(file, decode(file, data))
    ignores: list[Ignore] = []
    problems: list[Problem] = []
    for offset, text, end in comments(source.text):
        match = COMMENT.fullmatch(text)
        if match is None:
            continue
        place = source.at(offset)
        problem = _incomplete(place, match[2], match[3], FORM)
        if not match[1]:
            problem = NO_COLON.at(place, word=WORD, form=FORM)
        if problem is not None:
            problems.append(problem)
            continue
        ignores.append(Ignore(match[2], place, (place[1:], source.at(end)[1:])))
    return ignores, problems


def comments(text: str) -> Iterator[tuple[int, str, int]]:
    """Comments that may be ignores: their beginnings, texts, and ends of the next elements."""
    waiting: list[tuple[int, int, str]] = []
    """Comments whose element has not ended: where they begin, its depth, the text."""
    depth = 0
    for piece in MARKUP.finditer(text):
        tag = piece[0]
        if tag.startswith("<!--"):
            if WORD in tag:
                waiting.append((piece.start(), depth + 1, tag[4:-3]))
            continue
        depth += piece["start"] is not None
        if not (tag.startswith("</") or (piece["start"] and tag.endswith("/>"))):
            continue
        while waiting and waiting[-1][1] >= depth:
            begin, wanted, comment = waiting.pop()
            yield begin, comment, piece.end() if wanted == depth else begin
        depth -= 1
    yield from ((begin, comment, begin) for begin, _, comment in waiting)


def read_settings(file: str) -> IgnoreSettings:
    """Read a ``prima.toml``."""
    settings = IgnoreSettings(file)
    try:
        with open(file, "rb") as stream:
            text, tree = parse_toml(file, stream.read(4 * MOST_CHARACTERS + 1))
    except OSError as error:
        settings.problems.append(NOT_READ.at(Place(file), error=error.strerror or error))
        return settings
    except NotToml as error:
        settings.problems.append(NOT_TOML.at(error.place, error=error.reason))
        return settings
    entries = tree.get("ignore", [])
    if unknown := sorted(tree.keys() - {"ignore"}):
        settings.problems.append(UNKNOWN_SETTING.at(Place(file), name=unknown[0]))
    elif not isinstance(entries, list):
        settings.problems.append(NO_ENTRIES.at(Place(file)))
    lines = [text.count("\n", 0, found.start()) + 1 for found in ENTRY.finditer(text)]
    for number, entry in enumerate(entries if isinstance(entries, list) else []):
        place = Place(file, lines[number] if number < len(lines) else 1)
        _entry(entry, place, settings)
    return settings


def _entry(entry: Any, place: Place, settings: IgnoreSettings) -> None:
    given = entry if isinstance(entry, dict) else {}
    files = given.get("files", "*")
    named = [files] if isinstance(files, str) else files
    strange = sorted(set(given) - set(KEYS))
    form = 'Write code = "..." and reason = "..." into the [[ignore]].'
    code, reason = given.get("code", ""), given.get("reason", "")
    problem = _incomplete(place, str(code), str(reason).strip(), form)
    if strange:
        hint = suggestion(strange[0], KEYS)
        problem = UNKNOWN_KEY.at(place, hint, name=strange[0], keys=", ".join(KEYS))
    elif not isinstance(named, list) or not all(isinstance(one, str) for one in named):
        problem = NO_FILES.at(place)
    if problem is None:
        settings.ignores.append(Ignore(str(code), place, files=tuple(named)))
    else:
        settings.problems.append(problem)
