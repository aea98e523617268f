"""The further documents of a VoiceXML application: files that its elements name."""

from __future__ import annotations

from functools import cached_property
from urllib.parse import urldefrag

from prima.checks.prices.model import Gap
from prima.checks.prices.speech import choices_of, enumerated
from prima.devices.voice import duration
from prima.markup.tree import Node
from prima.script.choices import choices
from prima.voicexml.document import FetchError, Page, VoiceDocument
from prima.voicexml.pages import MOST_PAGES, TARGETS, Pages


class PricedPages(Pages):
    """All documents of an application that it names literally as files."""

    def __init__(self, document: VoiceDocument) -> None:
        super().__init__(document.page, document.folder, document.fetch)
        self.document = document
        nodes = [(page, one) for page in self for one in page.root.walk() if one.key in TARGETS]
        found = (self.leads(*one)[1] for one in nodes)
        self.gaps = list(dict.fromkeys(gap for gap in found if gap))
        self.throws_any = any(one.get("eventexpr") for page in self for one in page.root.walk())
        """Whether expressions determine events that it throws."""
        self._longest_choices: dict[str, str] = {}
        """The longest that an ``enumerate`` says, by its language."""

    @cached_property
    def choosing(self) -> list[Node]:
        """The items of all documents whose choices an ``enumerate`` says."""
        nodes = (one for page in self for one in page.root.walk())
        return [one for one in nodes if one.tag in ("menu", "field") and choices_of(one)]

    def longest_choices(self, lang: str) -> str:
        """The longest that an ``enumerate`` says in a language, of whichever item."""
        if lang not in self._longest_choices:

            def lasts(words: str) -> int:
                return duration(words, lang, {})

            said = map(enumerated, self.choosing)
            self._longest_choices[lang] = max(said, key=lasts, default="")
        return self._longest_choices[lang]

    def leads(self, page: Page, node: Node) -> tuple[list[str], Gap | None]:
        """The states to which an element of a page leads, or why they are not known."""
        plain, computed = TARGETS[node.key]
        if code := node.get(computed):
            if all(one.text.startswith("#") for one in choices(code)):
                return [f"{page.uri}#{name}" for name in page.dialogs], None
            place = node.attribute_place(computed)
            return [], Gap(place, "an expression says where it goes on")
        target = self.target(page, node)
        if target.page is not None:
            return [f"{target.page.uri}#{target.key}"], None
        if target.asked:
            place = node.attribute_place(plain)
            return [], Gap(place, f"the document that {target.asked} answers is not known")
        if self.cut and node.get(plain):
            return [], Gap(node.place, f"only {MOST_PAGES} documents of an application are read")
        return [], None  # a run throws error.badfetch

    def recording(self, page: Page, base: str, name: str) -> int | None:
        """How long (ms) a recording of the application's folder plays, if it can be played.

        ``name`` is relative to a prompt's own ``base``, and that to the page's.
        """
        try:
            uri = urldefrag(page.join(page.join(page.base(), base), name))[0]
            return self.document.recording_ms(uri)
        except (FetchError, ValueError):
            return None
