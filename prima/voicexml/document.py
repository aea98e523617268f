"""VoiceXML documents and applications, and where their files come from."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from urllib.parse import urldefrag, urlsplit

from prima.errors import DocumentError, Problem
from prima.markup.tree import Node
from prima.markup.uris import join
from prima.voicexml.checks import check_code
from prima.voicexml.recordings import length_ms
from prima.voicexml.site import Site

REMOTE = frozenset(["http", "https", "service"])
"""URI schemes of resources outside the application."""
Fetch = Callable[[str], bytes]
"""Gives the bytes of a file by its name in the application's folder."""

Glance = Callable[[str], tuple[bytes, int]]
"""Gives a file's first bytes, at most so many, and its size; raises :class:`FetchError`."""


def of_web(place: str) -> bool:
    """Whether a document's place is a URI: it was sent by a host, or a service in its stead."""
    return place.startswith(("http:", "https:"))


class FetchError(Exception):
    """A resource cannot be fetched: ``error.badfetch`` in the application."""


@dataclass(slots=True)
class Page:
    """One VoiceXML document."""

    uri: str
    root: Node
    dialogs: dict[str, Node] = field(default_factory=dict)
    """Forms and menus by their id, in document order; those without one by a number."""
    problems: list[Problem] = field(default_factory=list)
    site: Site | None = None
    """Where the application's folder was copied from."""

    @property
    def lang(self) -> str:
        """The document's language."""
        return self.root.get("xml:lang", "en")

    @property
    def application(self) -> str:
        """The URI of the application root document, if it names one (1.5.2)."""
        name = self.root.get("application")
        return urldefrag(self.resolve(name))[0] if name else ""

    def base(self, node: Node | None = None) -> str:
        """The base of relative URIs, seen from the application's folder (1.5.1)."""
        base = self.join(self.uri, self.root.get("xml:base"))
        if node is not None and node is not self.root:
            base = self.join(base, node.get("xml:base"))
        return base

    def resolve(self, uri: str, node: Node | None = None) -> str:
        """A URI written in this document, seen from the application's folder (6.1.1)."""
        return self.join(self.base(node), uri)

    def join(self, base: str, uri: str) -> str:
        """A URI resolved against its base; a URI that the folder maps becomes a name in it."""
        if not uri or self.site is None:
            return join(base, uri)
        return self.site.join(base, uri)

    def dialog(self, name: str) -> Node | None:
        """The dialog with that id, or the first one if the name is empty."""
        return self.dialogs.get(name) if name else next(iter(self.dialogs.values()), None)

    def warnings(self) -> list[Problem]:
        """Errors only if executed; computed on demand."""
        return check_code(self.root, set(self.dialogs))


@dataclass(slots=True)
class VoiceDocument:
    """A VoiceXML application: its first document and how others are fetched."""

    id: str
    kind: str
    file: str
    page: Page
    fetch: Fetch
    node: Node
    glance: Glance
    """Looks up recordings, and whether there is a file."""

    @property
    def folder(self) -> str:
        """The folder whose files it may name."""
        site = self.page.site
        return site.folder if site is not None else os.path.dirname(self.file)

    def outside(self, uri: str) -> str:
        """The URI to fetch from outside the application's folder; empty if it has the file."""
        if urlsplit(uri).scheme in REMOTE:
            return uri
        site = self.page.site
        return site.whole(uri) if site is not None and not self._has(uri) else ""

    def _has(self, name: str) -> bool:
        try:
            self.glance(name)
        except FetchError:
            return False
        return True

    def recording_ms(self, name: str) -> int | None:
        """How long a recording of the folder plays (ms), if it can be played.

        Raises:
            FetchError: it is not there.
        """
        return length_ms(*self.glance(name))

    def seen(self, name: str) -> str:
        """A name in the folder as messages show it: relative to the first document's folder."""
        if self.page.site is None or urlsplit(name).scheme in REMOTE:
            return name
        return os.path.relpath(os.path.join(self.folder, name), os.path.dirname(self.file) or ".")

    @property
    def lang(self) -> str:
        """The first document's language."""
        return self.page.lang


def broken(page: Page) -> DocumentError | None:
    """The error raised for a document's problems, if any is an error."""
    errors = [problem for problem in page.problems if problem.severity == "error"]
    return DocumentError(errors) if errors else None
