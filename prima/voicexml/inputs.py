"""The active grammars while an application waits, and the results that they give (3.1)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from prima.grammar.answers import Answers
from prima.grammar.builtin import TYPES
from prima.interpreter.places import source
from prima.interpreter.transfers import Thrown
from prima.markup.tree import Node
from prima.messages import Hypothesis, Json, Say
from prima.script.budget import Budget
from prima.voicexml.content import Content
from prima.voicexml.document import Page
from prima.voicexml.elements import numbered, words_of
from prima.voicexml.fetching import Missing, fetch, held, refusal
from prima.voicexml.matching import GrammarMatch, Listener, keys, listener, phrase, ways
from prima.voicexml.settings import setting
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context, Flow, TakenUtterance

UNIVERSALS = {"help": "help", "cancel": "cancel", "exit": "exit"}
"""Commands that listen everywhere once the property ``universals`` names them (6.3.6)."""
DEAF = frozenset(["record", "transfer"])
"""Items that wait even if no grammar is active."""
MOST_RESULTS = 100


@dataclass(slots=True)
class Active:
    """An active grammar, and its owner: an item, a form, a link or a choice."""

    listener: Listener
    owner: Node
    page: Page
    level: Node
    """The element whose grammars are tried together: the parent of a link or choice."""


Taken = tuple[Active, GrammarMatch]
"""A match with its grammar."""


class Inputs:
    """Finds and matches the grammars of one application."""

    def __init__(self, shared: SharedState, content: Content) -> None:
        self.shared = shared
        self.content = content
        self._loaded: dict[tuple[str, int, str], tuple[Page, Listener]] = {}
        """With the page of each: the next page of the same URI may be another document."""
        self._budget = Budget()
        """The budget for matching the current utterance."""
        self._active: list[Active] = []
        """The grammars that listen in the current wait."""
        self._words: Answers | None = None
        """The words that it takes."""

    # Hearing ------------------------------------------------------------------------

    def activate(self, context: Context) -> Flow:
        """Load all grammars that listen now; they stay active until the wait ends (3.1.4).

        Resources that they lack are fetched first.

        Raises:
            Thrown: for a grammar that cannot be used; ``error.semantic`` where none listens.
        """
        shared, active, item = self.shared, None, context.item
        while active is None:
            try:
                active = list(self.active(context))
            except Missing as missing:
                shared.app.count_step(missing.node)
                shared.resources[missing.uri] = yield from fetch(shared, missing.uri, missing.node)
        self._active, self._words = active, None
        if not self._active and item is not None and item.tag not in DEAF:
            raise Thrown.at(item, "error.semantic", "no grammar listens here")

    def words(self, context: Context) -> Answers:
        """The utterances possible now, for recognisers; the same object while nothing changes."""
        if self._words is None:
            heard = self._active if "voice" in self.modes(context) else []
            options: dict[str, Json] = {}
            for one in reversed(heard):  # the most specific goes before
                options |= one.listener.words.options
            grammars = [made for one in heard for made in one.listener.words.grammars]
            self._words = Answers(options, grammars)
        return self._words

    def hear(self, context: Context, said: Sequence[Hypothesis]) -> TakenUtterance | None:
        """The matches of the most specific grammars for an utterance, or None (3.1.4).

        The likeliest hypothesis that any grammar takes decides which those are; further results
        are of the others. Of all results the surest comes first (5.1.5).
        """
        most = self.most_results(context)
        self._budget = self.shared.app.utterance()
        results: list[Taken] = []
        for text, sure in said:
            if len(results) >= most:
                break
            for words, mode in self._ways(context, text):
                first = results[0][0] if results else None
                found = self._taken(context, words, mode, sure, first)
                known = {(one.utterance, one.means) for _, one in results}
                results += [one for one in found if (one[1].utterance, one[1].means) not in known]
                if found:
                    break
        if not results:
            return None
        surest = sorted(results, key=lambda one: -one[1].confidence)
        (active, best), *others = surest[:most]
        further = [(one.utterance, one.interpretation, one.confidence) for _, one in others]
        return TakenUtterance(
            best.utterance,
            best.interpretation,
            active.owner,
            active.page,
            best.confidence,
            best.mode,
            further,
        )

    def most_results(self, context: Context) -> int:
        """The maximum number of results (6.3.2)."""
        return int(min(float(setting(context, "maxnbest")), MOST_RESULTS))

    def noted(self, context: Context, text: str) -> tuple[str, str] | None:
        """An utterance that no grammar took, and its mode; None if such input is off (6.3.6)."""
        found = list(self._ways(context, text))
        pressed = [one for one in found if one[1] == "dtmf"]
        return pressed[-1] if pressed else next(iter(found), None)

    def modes(self, context: Context) -> list[str]:
        """The kinds of input that the application takes (6.3.6)."""
        return setting(context, "inputmodes").split()

    def _ways(self, context: Context, text: str) -> Iterator[tuple[str, str]]:
        """An utterance as keys and as speech, where the application takes such input."""
        modes = self.modes(context)
        for said, mode in ways(text, setting(context, "termchar")):
            if mode in modes:
                yield said, mode

    def _taken(
        self, context: Context, said: str, mode: str, sure: float, first: Active | None
    ) -> list[Taken]:
        """The results of one scope's grammars: of ``first``'s, or the first that takes anything."""
        most = self.most_results(context)
        least = float(setting(context, "confidencelevel"))
        results: list[Taken] = []
        for active in self._active:
            if first is not None and active.level is not first.level:
                continue
            for one in active.listener.match(said, mode, most) if len(results) < most else ():
                found = replace(one, confidence=round(one.confidence * sure, 6))
                if found.confidence >= least and found.means not in {r.means for _, r in results}:
                    results.append((active, found))
                    first = first or active
            if self._budget.steps <= 0:
                self.shared.app.give_up(active.owner, "what it listens for takes too long")
        return results

    # Which grammars listen --------------------------------------------------------------

    def active(self, context: Context) -> Iterator[Active]:
        """All grammars that listen now, by their precedence, then in document order (3.1.4)."""
        item, form, page = context.item, context.form, context.page
        if item is not None:
            yield from self._of(context, item, page, item)
            if item.get("modal", str(item.tag in ("record", "transfer")).lower()) == "true":
                return
        if form is not None and form is not item:
            yield from self._of(context, form, page, form)
        for wider in filter(None, (page, context.root)):
            yield from self._of_document(context, wider)
        yield from self._universals(context)

    def _of_document(self, context: Context, page: Page) -> Iterator[Active]:
        """The grammars of a document's links, and those of its other dialogs."""
        for node in page.root.all("link", "form", "menu"):
            if node.tag == "link":
                yield from self._link(context, node, page, page.root)
            elif node is not context.form:
                yield from self._shared(context, node, page)

    def _shared(self, context: Context, dialog: Node, page: Page) -> Iterator[Active]:
        """The grammars of another dialog that listen in the whole document (3.1.3)."""
        if dialog.get("scope") == "document":
            yield from self._of(context, dialog, page, page.root)
            return
        for grammar in dialog.all("grammar"):
            if grammar.get("scope") == "document":
                yield self._grammar(context, grammar, dialog, page, page.root)

    def _universals(self, context: Context) -> Iterator[Active]:
        names = setting(context, "universals").split()
        root = context.page.root
        for name, event in UNIVERSALS.items():
            if name in names or names == ["all"]:
                link = Node("link", root.source, root.index, {"event": event}, key="link")
                yield Active(phrase(name, name, False), link, context.page, root)

    def _link(self, context: Context, link: Node, page: Page, level: Node) -> Iterator[Active]:
        for grammar in link.all("grammar"):
            yield self._grammar(context, grammar, link, page, level)
        if link.get("dtmf"):
            yield Active(keys(link.get("dtmf"), link.get("dtmf")), link, page, level)

    def _of(self, context: Context, node: Node, page: Page, level: Node) -> Iterator[Active]:
        """The grammars in an item or dialog: its own, and those of its options, choices, links."""
        numbers = numbered(node)
        for one in node.nodes:
            match one.tag:
                case "grammar" if node is context.form or one.get("scope") != "dialog":
                    yield self._grammar(context, one, node, page, level)
                case "option" | "choice" if node.tag in ("field", "menu"):
                    dtmf = numbers[one.index]
                    yield from self._option(context, one, node, page, level, dtmf)
                case "link" if level is node:  # those of another dialog listen in it alone
                    yield from self._link(context, one, page, level)
        if node.tag == "field" and node.get("type"):
            yield Active(self._built_in(node, page), node, page, level)

    def _option(
        self, context: Context, option: Node, node: Node, page: Page, level: Node, dtmf: str
    ) -> Iterator[Active]:
        target = option if option.tag == "choice" else node
        words = words_of(option)
        value: Json = option.attributes.get("value", words or dtmf)
        approximate = (option.get("accept") or node.get("accept")) == "approximate"
        grammars = option.all("grammar")
        for grammar in grammars:
            yield self._grammar(context, grammar, target, page, level)
        if words and not grammars:
            yield Active(phrase(words, value, approximate), target, page, level)
        if dtmf:
            yield Active(keys(dtmf, value), target, page, level)

    # Loading ---------------------------------------------------------------------------

    def _built_in(self, node: Node, page: Page) -> Listener:
        name = node.get("type")
        known = name.partition("?")[0] in TYPES or name.startswith("builtin:")
        return self._load(node, page, name if known else f"builtin:grammar/{name}")

    def _grammar(
        self, context: Context, node: Node, owner: Node, page: Page, level: Node
    ) -> Active:
        uri = node.get("src").strip()
        if "srcexpr" in node.attributes:  # evaluated whenever the grammar listens (2.1, 2)
            uri = self.content.word(node, "src", context, self.shared.engine.nothing).strip()
        if not uri and not node.attributes.keys().isdisjoint(("src", "srcexpr")):
            raise Thrown.at(node, "error.badfetch", "the URI is missing")
        if uri and not uri.startswith("builtin:"):
            uri = page.resolve(uri, node)
        return Active(self._load(node, page, uri), owner, page, level)

    def _load(self, node: Node, page: Page, uri: str) -> Listener:
        key = (page.uri, node.index, uri)
        kept = self._loaded.get(key)
        if kept is not None and kept[0] is page:
            return kept[1]
        made = listener(
            node,
            page,
            uri,
            lambda name: held(self.shared, name, node),
            lambda by, name: refusal(self.shared, by, name, node),
            self._failed,
            lambda: self._budget,
        )
        self._loaded[key] = page, made
        return made

    def _failed(self, node: Node, message: str) -> None:
        """A tag failed on the utterance, so the grammar does not take it."""
        self.shared.app.actions.append(Say("log", f"no match: {message}", source(node)))
