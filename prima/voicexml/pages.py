"""All documents of a VoiceXML application that files refer to by literal names."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator
from dataclasses import dataclass
from urllib.parse import unquote, urlsplit

from prima.errors import DocumentError, Hint, Problem, suggestion
from prima.errors.diagnoses.names import NO_SUCH_FORM, UNDECLARED_VARIABLE
from prima.errors.diagnoses.values import BAD_VALUE
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.markup.uris import parted
from prima.voicexml.caught import thrown_in
from prima.voicexml.document import Fetch, FetchError, Page, VoiceDocument
from prima.voicexml.elements import HANDLERS
from prima.voicexml.reading import read_page
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, WORDED

MOST_PAGES = 100
"""Maximum number of documents read for one application."""
TARGETS = {
    "goto": ("next", "expr"),
    "submit": ("next", "expr"),
    "subdialog": ("src", "srcexpr"),
    "link": ("next", "expr"),
    "choice": ("next", "expr"),
}
"""Elements that lead to a dialog: the attribute that names it, and the one that computes it."""


@dataclass(frozen=True, slots=True)
class Target:
    """The dialog that an element names."""

    page: Page | None = None
    """Its document, if that can be read."""
    name: str = ""
    """Its name; empty for the document's first one."""
    asked: str = ""
    """The URI of a service that is asked before, or of an answer that only a run determines."""

    @property
    def key(self) -> str:
        """Its key among its document's dialogs."""
        return self.name or next(iter(self.page.dialogs if self.page else ()), "")


def inherited(root: Node) -> Iterator[Node]:
    """What a leaf inherits of its root document: handlers and links (1.5.2); grammars stay there."""
    for part in root.all("link", *HANDLERS):
        yield from (one for one in part.walk() if one.key != "grammar")


def pages_of(document: VoiceDocument) -> Pages:
    """The documents of an application."""
    return Pages(document.page, document.folder, document.fetch)


class Pages:
    """The documents of an application, the first one first, then as others name them."""

    def __init__(self, first: Page, folder: str, fetch: Fetch) -> None:
        self.folder = folder
        self._site = first.site
        self._fetch = fetch
        self._pages: dict[str, Page | None] = {first.uri: first}
        self._read = [first]
        self.problems: list[Problem] = []
        """Problems of documents that cannot be read at all."""
        self.open = False
        """Whether something leads to a document that only a run determines."""
        self.cut = False
        """Whether there are more documents than are read."""
        self.whole: list[Page] = []
        """The documents of which all that they name is read, as far as it can be."""
        for page in self._read:  # which grows meanwhile
            before, self.cut = self.cut, False
            self.root(page)
            for node in self.nodes(page):
                self.open |= node.key in TARGETS and self._is_open(page, node)
            self.whole += () if self.cut else (page,)
            self.cut |= before
        self.thrown = {name for page in self for name in thrown_in(page.root)}
        """The events that they throw."""

    def __iter__(self) -> Iterator[Page]:
        return iter(self._read)

    def _is_open(self, page: Page, node: Node) -> bool:
        plain, computed = TARGETS[node.key]
        named = self.target(page, node).page is not None or not node.get(plain).strip()
        return computed in node.attributes or not named

    def root(self, page: Page) -> Page | None:
        """The application root document of a page, if it has one that can be read."""
        uri = page.application
        return self._page(uri) if uri and uri != page.uri else None

    def nodes(self, page: Page) -> Iterator[Node]:
        """The elements whose URIs are relative to a document: its own, and those it inherits.

        Those that the leaves of a root document without dialogs inherit never run in it.
        """
        root = self.root(page)
        if root is not None and page.dialogs:
            yield from inherited(root.root)
        is_root = any(one.application == page.uri for one in self._read if one is not page)
        given = set(map(id, inherited(page.root) if is_root and not page.dialogs else ()))
        yield from (one for one in page.root.walk() if id(one) not in given)

    def target(self, page: Page, node: Node) -> Target:
        """The dialog that one of ``TARGETS`` names literally; no document if it names none."""
        uri = node.get(TARGETS[node.key][0]).strip()
        if not uri:
            return Target()
        if uri[0] == "#":
            return Target(page, parted(uri)[1])
        base, name = parted(page.resolve(uri, node))
        parts = urlsplit(base)
        if parts.scheme == "service" and name in page.dialogs:
            return Target(page, name, base)
        if parts.scheme or parts.netloc:
            return Target(asked=base)
        program = node.key == "submit" and not parts.path.endswith(".vxml")
        return Target(self._page(parts.path, program), name)

    def _page(self, uri: str, program: bool = False) -> Page | None:
        """A document of the folder, read once; None if it cannot be read.

        A file that may be a ``program`` of the server need not be VoiceXML.
        """
        self.cut |= uri not in self._pages and len(self._pages) >= MOST_PAGES
        if uri not in self._pages and len(self._pages) < MOST_PAGES:
            self._pages[uri] = None
            try:
                file = posixpath.join(self.folder, unquote(uri).lstrip("/"))
                page = read_page(uri, file, self._fetch(uri), self._site)
                self._pages[uri] = page
                self._read.append(page)
            except FetchError:
                pass  # reported where it is named
            except DocumentError as error:
                self.problems += [] if program else error.problems
        return self._pages.get(uri)

    def between(self) -> Iterator[Problem]:
        """Dialogs that others lack, roots that have one, params that no called form takes (2.3.4)."""
        for page in self:
            yield from self._root_of_root(page)
            for node in self.nodes(page):
                target = self.target(page, node) if node.key in TARGETS else Target()
                other, name = target.page, target.name
                if other is None or target.asked:
                    continue
                dialog = other.dialog(name)
                if dialog is None and (other is not page or node.source is not page.root.source):
                    yield _not_there(node, name, other)
                elif dialog is not None and (node.key, dialog.tag) == ("subdialog", "form"):
                    yield from _untaken(node, dialog)

    def _root_of_root(self, page: Page) -> Iterator[Problem]:
        """An application root that has one itself (1.5.2)."""
        root = self.root(page)
        if root is not None and root.application:
            yield ROOTED_ROOT.at(page.root.attribute_place("application"), page=root.uri)


NO_DIALOG = NO_SUCH_FORM.says(
    'There is no dialog "{name}" in {page}: this will be error.badfetch.',
    'Name another, or add <form id="{name}"> there.',
    "warning",
)
NO_DIALOGS = NO_SUCH_FORM.says(
    "{page} has no dialog: this will be error.badfetch.", "Name another document.", "warning"
)
ROOTED_ROOT = BAD_VALUE.says(
    "{page} has an application root itself: this will be error.semantic.",
    "Name that root, or another document without one.",
    "warning",
)
NOT_TAKEN = UNDECLARED_VARIABLE.says(
    '{form} has no <var name="{name}"/>: this will be error.semantic.',
    "Declare it in the form.",
    "warning",
)

A_NAME = Hint("Write the name of a variable of that form.")


def _not_there(node: Node, name: str, page: Page) -> Problem:
    place = node.attribute_place(TARGETS[node.key][0])
    if not name:
        return NO_DIALOGS.at(place, page=page.uri)
    hint = suggestion(name, page.dialogs, *value_span(node, TARGETS[node.key][0], name))
    return NO_DIALOG.at(place, hint, name=name, page=page.uri)


def _untaken(node: Node, form: Node) -> Iterator[Problem]:
    names = {var.get("name") for var in form.all("var")}
    for param in node.all("param"):
        name = param.get("name")
        if "name" in param.attributes and name not in names:
            which = f'The form "{form.get("id")}"' if form.get("id") else "The form that is called"
            hint = suggestion(name, names, *value_span(param, "name")) if name else A_NAME
            yield NOT_TAKEN.at(param.attribute_place("name"), hint, form=which, name=name)


SPEAKING = frozenset(["prompt", "block", "filled", "catch", "noinput", "nomatch", "help", "error",
                      "initial", "field", "choice", "option", "if", "menu", "record"])  # fmt: skip
"""Elements whose own text is spoken."""
OPEN = frozenset(["value", "enumerate", "foreach"])
"""Elements whose speech only a run determines."""


def spoken_in(page: Page) -> Iterator[list[object]]:
    """The texts that a document speaks; None stands for what only a run determines."""
    for node in page.root.walk():
        if node.tag in SPEAKING or node.namespace == PRIMA_NAMESPACE:
            parts = list(_parts(node))
            if any(part is None or str(part).strip() for part in parts):
                yield parts


def _parts(node: Node) -> Iterator[object]:
    for one in node.content:
        if isinstance(one, str):
            yield " ".join(one.split()) + " "
        elif one.tag in OPEN or (one.tag == "audio" and not one.text and not one.nodes):
            yield None
        elif one.tag == "sub":
            yield f"{one.get('alias')} "
        elif one.tag in WORDED or one.tag == "desc":
            yield from _parts(one)
