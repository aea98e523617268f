"""Grammars of a VoiceXML document as functions of what was said (3.1 and 2.2.5)."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, cast
from urllib.parse import urldefrag

from prima.grammar import (
    Grammar,
    GrammarError,
    UnsupportedBuiltIn,
    UnsupportedFormat,
    UnsupportedLanguage,
    load,
)
from prima.grammar.answers import Answers
from prima.grammar.text import MatchedUtterance, fold, utterance
from prima.interpreter.places import source
from prima.interpreter.transfers import Thrown
from prima.markup.tree import Node
from prima.markup.uris import parted
from prima.messages import Json
from prima.script.budget import Budget
from prima.voicexml.document import Page
from prima.voicexml.platform import listens_in

KEYS = frozenset("0123456789*# ")
"""Characters of telephone keys: an utterance of only these is tried as DTMF first."""


@dataclass(frozen=True, slots=True)
class GrammarMatch:
    """One way in which a grammar matches an utterance."""

    utterance: str
    interpretation: Json
    confidence: float = 1.0
    mode: str = "voice"

    @property
    def means(self) -> str:
        """Its identity among results."""
        return json.dumps(self.interpretation, sort_keys=True, default=str)


@dataclass(frozen=True, slots=True)
class Listener:
    """A grammar, the words of an option, or keys."""

    match: Callable[[str, str, int], list[GrammarMatch]]
    """Gives at most so many matches of an utterance in a mode."""
    words: Answers = field(default_factory=Answers)
    """The utterances that it takes, for recognisers."""


Fetch = Callable[[str], bytes]
Refusal = Callable[[str, str], str]
"""Why a grammar may not refer to another, by their URIs; empty if it may."""
Tell = Callable[[Node, str], None]


def listener(
    node: Node,
    page: Page,
    uri: str,
    fetch: Fetch,
    refusal: Refusal,
    tell: Tell,
    budget: Callable[[], Budget],
) -> Listener:
    """The grammar of an element, or of the URI that it names; ``budget`` is that of the utterance.

    Raises:
        Thrown: ``error.badfetch``, ``error.unsupported.format``,
            ``error.unsupported.language`` or ``error.unsupported.builtin``.
    """
    grammar = _loaded(node, page, uri, fetch, refusal)

    def match(said: str, mode: str, most: int) -> list[GrammarMatch]:
        found: list[GrammarMatch] = []
        for one in grammar.match(said, mode=mode, most=most, budget=budget()):
            if one.error is not None:
                tell(node, str(one.error))
                continue
            found.append(GrammarMatch(one.utterance, one.interpretation, one.confidence, mode))
        return found[:most]

    return Listener(match, Answers(grammars=() if grammar.mode == "dtmf" else (grammar,)))


def ways(text: str, end: str) -> list[tuple[str, str]]:
    """An utterance as keys, with and without the key that ends it, or as speech (6.3.3)."""
    if not text.strip() or not set(text) <= KEYS:
        return [(text, "voice")]
    typed = text.replace(" ", "")
    found = [(typed, "dtmf")]
    if end and typed.endswith(end) and typed != end:
        found.append((typed.removesuffix(end), "dtmf"))
    return found if set(typed) & set("*#") else [*found, (text, "voice")]


def _loaded(node: Node, page: Page, uri: str, fetch: Fetch, refusal: Refusal) -> Grammar:
    failures: list[Thrown] = []

    def fetched(name: str) -> bytes:
        try:
            return fetch(name)
        except Thrown as thrown:
            failures.append(thrown)
            raise LookupError(thrown.message) from None

    grammar = node.tag == "grammar"
    given = node.get("mode") if grammar and node.get("mode") in ("dtmf", "voice") else ""
    mode = cast(Literal["dtmf", "voice"], given) if given else None
    lang = node.get("xml:lang") or page.lang
    kind, place = node.get("type") if grammar else "", source(node)
    try:
        what, rule = _given(node, uri, fetch)
        base = urldefrag(uri)[0] or page.base()
        if page.site is not None:
            base = page.site.whole(base)
        made = load(
            what,
            base=base,
            lang=lang,
            mode=mode,
            fetch=fetched,
            refusal=refusal,
            type=kind,
            rule=rule,
            languages=listens_in,
            lenient=True,
        )
        if not made.root:
            raise Thrown("error.badfetch", f"{place}: the grammar names no root rule", place)
    except GrammarError as error:
        if failures:
            raise failures[0] from None
        message = f"{place}: {error}" if uri else str(error)  # has its own place, in this file
        raise Thrown(_event(error), message, place) from None
    return made


def _given(node: Node, uri: str, fetch: Fetch) -> tuple[Node | str | bytes, str]:
    """A grammar's element, the name of a built-in one, or its file; and its rule's name, if any."""
    if not uri:
        return node, ""
    if node.tag != "grammar" or uri.startswith("builtin:"):
        return uri, ""
    name, rule = parted(uri)
    return fetch(name), rule


def _event(error: GrammarError) -> str:
    """The event for a grammar that cannot be used (5.2.6)."""
    for kind, name in (
        (UnsupportedFormat, "error.unsupported.format"),
        (UnsupportedLanguage, "error.unsupported.language"),
        (UnsupportedBuiltIn, "error.unsupported.builtin"),
    ):
        if isinstance(error, kind):
            return name
    return "error.badfetch"  # it cannot be parsed, or its parameters conflict (Appendix P)


def phrase(text: str, value: Json, approximate: bool) -> Listener:
    """A listener to one phrase or, if approximate, to some of its words in order (2.2.5)."""
    whole = fold(text)
    words = [word for part in text.split() for word in fold(part).split()]

    def match(said: str, mode: str, _most: int) -> list[GrammarMatch]:
        heard = utterance(said, mode) if mode == "voice" else None
        if heard is None:
            return []
        taken = heard.said == whole or (approximate and _in_order(words, heard))
        return [GrammarMatch(said, value)] if taken else []

    parts = [text, *(text.split() if approximate else ())]
    return Listener(match, Answers(dict.fromkeys(parts, value)))


def _in_order(words: list[str], heard: MatchedUtterance) -> bool:
    """Whether some of the words make up an utterance, which may have no spaces between them."""
    places = {0}
    for word in words:
        ends = [place + len(word) for place in places if heard.said.startswith(word, place)]
        places |= {heard.after(end) for end in ends if heard.edges[end]}
    return bool(heard.said) and len(heard.said) in places


def keys(dtmf: str, value: Json) -> Listener:
    """A listener to a sequence of keys."""
    wanted = dtmf.replace(" ", "")

    def match(said: str, mode: str, _most: int) -> list[GrammarMatch]:
        typed = mode == "dtmf" and said == wanted
        return [GrammarMatch(wanted, value, 1.0, "dtmf")] if typed else []

    return Listener(match)
