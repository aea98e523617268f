"""The further documents of a VoiceXML application: files that its elements name."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator
from dataclasses import dataclass
from urllib.parse import urldefrag, urlsplit

from prima.checks.prices.model import Gap
from prima.errors import DocumentError
from prima.markup.tree import Node
from prima.markup.uris import parted
from prima.script.choices import choices
from prima.voicexml.document import FetchError, Page, VoiceDocument
from prima.voicexml.pages import MOST_PAGES
from prima.voicexml.reading import read_page

TARGETS = {
    "goto": ("next", "expr"),
    "submit": ("next", "expr"),
    "subdialog": ("src", "srcexpr"),
    "link": ("next", "expr"),
    "choice": ("next", "expr"),
}
"""Elements that lead elsewhere: the attribute with the target, and the one that computes it."""


@dataclass(frozen=True, slots=True)
class PageTarget:
    """The target of an element: dialogs of a page, or unknown."""

    page: Page | None = None
    dialogs: tuple[str, ...] = ()
    gap: Gap | None = None


class PricedPages:
    """All documents of an application that it names literally as files."""

    def __init__(self, document: VoiceDocument) -> None:
        self.document = document
        self.gaps: list[Gap] = []
        self._known: dict[str, Page | None] = {document.page.uri: document.page}
        for page in self:
            if page.application:
                self._open(page.application)
            for node in page.root.walk():
                if node.tag in TARGETS:
                    gap = self.target(page, node).gap
                    self.gaps += [gap] if gap else []
        self.gaps = list(dict.fromkeys(self.gaps))
        self.thrown = {name for page in self for name in _thrown_by(page.root)}
        """The events that it throws itself; the empty name means those of expressions."""

    def __iter__(self) -> Iterator[Page]:
        """The documents, further ones as they are found."""
        done: set[str] = set()
        while waiting := [one for one in self._known.values() if one and one.uri not in done]:
            for page in waiting:
                done.add(page.uri)
                yield page

    def root(self, page: Page) -> Page | None:
        """The application root document of a page, if it has one of its own."""
        return self._known.get(page.application) if page.application else None

    def target(self, page: Page, node: Node) -> PageTarget:
        """The target of an element of a page."""
        plain, computed = TARGETS[node.tag]
        code = node.get(computed)
        if code and all(one.text.startswith("#") for one in choices(code)):
            return PageTarget(page, tuple(page.dialogs))
        if code:
            place = node.attribute_place(computed)
            return PageTarget(gap=Gap(place, "an expression says where it goes on"))
        return self._literal(page, node, plain)

    def _literal(self, page: Page, node: Node, plain: str) -> PageTarget:
        """The target that an attribute names literally."""
        uri = node.get(plain).strip()
        if not uri:
            return PageTarget()
        base, dialog = parted(page.resolve(uri, node) if uri[:1] != "#" else uri)
        if urlsplit(base).scheme == "service" and dialog in page.dialogs:
            base = ""
        if urlsplit(base).scheme or base.startswith("//"):
            place = node.attribute_place(plain)
            return PageTarget(gap=Gap(place, f"the document that {base} answers is not known"))
        found = self._open(base) if base else page
        if found is None:
            return PageTarget(gap=self._full(node))
        first = next(iter(found.dialogs), "")
        return PageTarget(found, (dialog or first,))

    def _open(self, uri: str) -> Page | None:
        """A document of the application's folder, read once; None if it cannot be read."""
        if uri not in self._known:
            self._known[uri] = None
            if len(self._known) <= MOST_PAGES:
                file, site = posixpath.join(self.document.folder, uri), self.document.page.site
                try:
                    self._known[uri] = read_page(uri, file, self.document.fetch(uri), site)
                except (FetchError, DocumentError):
                    return None  # a run throws error.badfetch
        return self._known[uri]

    def _full(self, node: Node) -> Gap | None:
        if len(self._known) <= MOST_PAGES:
            return None
        return Gap(node.place, f"only {MOST_PAGES} documents of an application are read")

    def recording(self, page: Page, name: str) -> int | None:
        """How long (ms) a recording of the application's folder plays, if it can be played."""
        try:
            uri = urldefrag(page.join(page.base(), name))[0]
            return self.document.recording_ms(uri)
        except (FetchError, ValueError):
            return None


def _thrown_by(root: Node) -> Iterator[str]:
    """The events that a document throws itself; the empty name means those of expressions."""
    for node in root.walk():
        if node.tag in ("throw", "link", "choice", "return"):
            if node.get("event"):
                yield node.get("event")
            elif node.get("eventexpr"):
                yield ""
