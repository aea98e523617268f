"""All documents of a VoiceXML application that files refer to by literal names."""

from __future__ import annotations

from collections.abc import Iterator
from urllib.parse import unquote, urlsplit

from prima.errors import DocumentError, Problem, suggestion
from prima.errors.diagnoses.names import NO_SUCH_FORM, UNDECLARED_VARIABLE
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.markup.uris import parted
from prima.voicexml.caught import thrown_in
from prima.voicexml.document import Fetch, FetchError, Page
from prima.voicexml.reading import read_page
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, WORDED

MOST_PAGES = 100
"""Maximum number of documents read for one application."""
LEADING = {"goto": "next", "link": "next", "choice": "next", "submit": "next", "subdialog": "src"}
"""Elements that lead to a dialog, and the attribute that names it."""


class Pages:
    """The documents of an application by their URIs, the first one first."""

    def __init__(self, first: Page, file: str, fetch: Fetch) -> None:
        self._folder = file[: len(file) - len(first.uri)] if file.endswith(first.uri) else ""
        if first.site is not None:
            self._folder = f"{first.site.folder}/"
        self._site = first.site
        self._fetch = fetch
        self._pages: dict[str, Page | None] = {first.uri: first}
        self.problems: list[Problem] = []
        """Problems of documents that cannot be read at all."""
        self.open = False
        """Whether something leads to a document that only a run determines."""
        waiting = [first]
        while waiting:
            page = waiting.pop(0)
            waiting += [one for uri in _named(page) if (one := self._read(uri)) is not None]
        self.thrown = {name for page in self for name in thrown_in(page.root)}
        """The events that they throw."""
        self.open = any(self._is_open(page, node) for page in self for node in page.root.walk())

    def _is_open(self, page: Page, node: Node) -> bool:
        if node.key not in LEADING:
            return False
        named = node.get(LEADING[node.key]).strip()
        computed = "expr" in node.attributes or "srcexpr" in node.attributes
        return computed or (bool(named) and self._target(page, node)[0] is None)

    def __iter__(self) -> Iterator[Page]:
        return (page for page in self._pages.values() if page is not None)

    def _read(self, uri: str) -> Page | None:
        """A document that is read for the first time, if it can be."""
        if uri in self._pages or len(self._pages) >= MOST_PAGES:
            return None
        page: Page | None = None
        try:
            file = f"{self._folder}{unquote(uri)}"
            page = read_page(uri, file, self._fetch(uri), self._site)
        except FetchError:
            pass  # reported where it is named
        except DocumentError as error:
            self.problems += error.problems
        self._pages[uri] = page
        return page

    def root(self, page: Page) -> Page | None:
        """The application root document of a page, if it has one that can be read."""
        return self._pages.get(page.application) if page.application else None

    def between(self) -> Iterator[Problem]:
        """Dialogs that other documents lack, and params that no called form takes (2.3.4)."""
        for page in self:
            for node in page.root.walk():
                other, name = self._target(page, node)
                if other is None:
                    continue
                dialog = other.dialog(name)
                if dialog is None and name and other is not page:
                    yield _not_there(node, name, other)
                elif dialog is not None and (node.key, dialog.tag) == ("subdialog", "form"):
                    yield from _untaken(node, dialog)

    def _target(self, page: Page, node: Node) -> tuple[Page | None, str]:
        """The target of an element: its document, if known, and its dialog."""
        uri = node.get(LEADING.get(node.key, "")).strip()
        if not uri:
            return None, ""
        if uri[0] == "#":
            return page, parted(uri)[1]
        base, name = parted(page.resolve(uri, node))
        return self._pages.get(urlsplit(base).path), name


NO_DIALOG = NO_SUCH_FORM.says(
    'There is no dialog "{name}" in {page}: this will be error.badfetch.', severity="warning"
)
NOT_TAKEN = UNDECLARED_VARIABLE.says(
    '{form} has no <var name="{name}"/>: this will be error.semantic.',
    "Declare it in the form.",
    "warning",
)


def _not_there(node: Node, name: str, page: Page) -> Problem:
    place = node.attribute_place(LEADING[node.key])
    hint = suggestion(name, page.dialogs, *value_span(node, LEADING[node.key], name))
    return NO_DIALOG.at(place, hint, name=name, page=page.uri)


def _named(page: Page) -> Iterator[str]:
    """The URIs of the documents that a page names, without their dialogs."""
    if page.application:
        yield page.application
    for node in page.root.walk():
        uri = node.get(LEADING.get(node.key, "")).strip()
        if not uri or uri[:1] == "#":
            continue
        whole = urlsplit(page.resolve(uri, node))
        asks = node.key == "submit" and not whole.path.endswith(".vxml")  # the server generates it
        if not (whole.scheme or whole.netloc or asks) and whole.path:
            yield whole.path


def _untaken(node: Node, form: Node) -> Iterator[Problem]:
    names = {var.get("name") for var in form.all("var")}
    for param in node.all("param"):
        name = param.get("name")
        if name and name not in names:
            which = f'The form "{form.get("id")}"' if form.get("id") else "The form that is called"
            hint = suggestion(name, names, *value_span(param, "name"))
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
