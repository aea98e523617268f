"""A loaded grammar: what it matches, and what that means."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from prima.errors import Problem
from prima.grammar.chart import MAX_STEPS, Cell, Chart
from prima.grammar.errors import GrammarError, Where, other_rule
from prima.grammar.model import GrammarDocument, Mode, Part, Reference
from prima.grammar.ranking import RankedParse, best, frames
from prima.grammar.semantics import SemanticError, TagFailed, TagInterpreter
from prima.grammar.text import MatchedUtterance, utterance
from prima.script.budget import Budget

if TYPE_CHECKING:
    from prima.messages import Json

MOST_ANALYSES = 64
"""How many analyses of an utterance are examined for different meanings."""
MOST_WORK = 20_000
"""Maximum total size of those after the first, in matched expansions."""
GARBAGE_SHARE = 0.5
"""The share of the words taken by GARBAGE that lowers the confidence: authors write GARBAGE on
purpose, so it must not by itself bring a match below VoiceXML's confidencelevel of 0.5."""


@dataclass(frozen=True, slots=True)
class Match:
    """One way in which a grammar matches an utterance."""

    utterance: str
    """The utterance as given."""
    text: str
    """The grammar's tokens that were matched; of keys, the keys."""
    tokens: tuple[str, ...]
    interpretation: Json
    """The interpretation; the text if the grammar gives none."""
    confidence: float
    """1, or less if GARBAGE took a part of it."""
    weight: float
    """Its likelihood by the grammar's weights, 1 without weights."""
    mode: str
    error: SemanticError | None = None
    """Why it has no interpretation, if a tag failed."""

    @property
    def slots(self) -> dict[str, Json] | None:
        """The interpretation's properties, if it is an object."""
        return self.interpretation if isinstance(self.interpretation, dict) else None


class Grammar:
    """Rules that match utterances; made by :func:`prima.grammar.load`."""

    def __init__(
        self,
        document: GrammarDocument,
        rule: str,
        where: Where,
        lenient: bool = False,
        warnings: Sequence[Problem] = (),
    ) -> None:
        self._document = document
        self._lenient = lenient
        self._where = where
        self._warnings = warnings
        self.root = rule or document.root
        """The rule that is matched; empty if the document names none."""

    @property
    def mode(self) -> Mode:
        """``voice`` or ``dtmf``; empty for a built-in type that takes both."""
        return self._document.mode

    @property
    def lang(self) -> str:
        """The language of the grammar."""
        return self._document.lang

    @property
    def uri(self) -> str:
        """The URI of the grammar, if it is known."""
        return self._document.uri

    @property
    def tag_format(self) -> str:
        """The tag format that the grammar declares."""
        return self._document.tag_format

    @property
    def rules(self) -> dict[str, bool]:
        """The rules by name, and whether each is public."""
        return {rule.name: rule.public for rule in self._document.rules.values()}

    @property
    def meta(self) -> dict[str, str]:
        """The meta data of the header (SRGS 4.11)."""
        return dict(self._document.meta)

    def warnings(self) -> list[Problem]:
        """Accepted but probably unintended media types, and tags that cannot be run (SISR)."""
        from prima.grammar.tags import tag_warnings  # few callers need it

        return [*self._warnings, *tag_warnings(self._document)]

    def rule(self, name: str) -> Grammar:
        """The grammar with another of its rules as root."""
        if name not in self._document.rules:
            message = f'There is no rule "{name}".'
            hint = other_rule(name, self._document.rules)
            raise GrammarError.of(self._where(), "no-such-rule", message, hint)
        return Grammar(self._document, name, self._where, self._lenient, self._warnings)

    def match(
        self,
        text: str,
        *,
        mode: str = "voice",
        most: int = 1,
        now: int = 0,
        budget: Budget | None = None,
    ) -> list[Match]:
        """The meanings of an utterance, best first; none if the grammar does not match it.

        Args:
            text: the utterance.
            mode: ``voice`` or ``dtmf``.
            most: the maximum number of matches.
            now: the time of ``Date`` in tags (ms since 1970, UTC).
            budget: the utterance's budget, partly used by other grammars; it has its own time.

        Raises:
            GrammarError: the grammar has no root rule.
        """
        root = self._root()
        said = utterance(text, mode) if self._takes(mode) else None
        if said is None or most < 1:
            return []
        budget = budget or Budget(now)
        chart = Chart(said, root, max(min(MAX_STEPS, budget.steps), 1))
        left = chart.steps_left
        top = chart.run()
        budget.steps -= left - chart.steps_left
        found: list[Match] = []
        for analysis in _analyses(top, most, budget) if top is not None else ():
            made = self._interpreted(analysis, said, budget)
            if not any(_same(one, made) for one in found):
                found.append(made)
            if len(found) == most:
                break
        return found

    def _interpreted(self, analysis: RankedParse, said: MatchedUtterance, budget: Budget) -> Match:
        """The match for an analysis, with its interpretation."""
        reader = TagInterpreter(said.mode, budget)
        value: Json = None
        error = None
        try:
            value = reader.interpret(frames(analysis, said))
            if self._lenient and self._silent and not reader.valued:
                value = reader.text()
            elif self._document.dialect == "last":
                value = said.text.strip() if reader.last is None else reader.last.code
        except TagFailed as failure:
            error = failure.error
        return Match(
            said.text,
            reader.text(),
            tuple(reader.tokens),
            value,
            round(1 - GARBAGE_SHARE * analysis.lost / max(len(said.ends), 1), 3),
            round(math.exp(-analysis.cost), 9),
            said.mode,
            error,
        )

    def accepts_prefix(self, text: str, *, mode: str = "voice") -> bool:
        """Whether more may follow: whether some longer utterance with this beginning matches.

        True in case of doubt.
        """
        said = utterance(text, mode) if self._takes(mode) else None
        if said is None:
            return False
        chart = Chart(said, self._root())
        chart.run(prefixes=True)
        return chart.open or chart.steps_left < 0

    @cached_property
    def _silent(self) -> bool:
        """Whether there is neither a tag nor a tag format, so that the text is the interpretation.

        SISR's default assignment, by which the last rule counts, is for grammars that use SISR;
        others predate it: three keys of a rule ``digit`` are a number.
        """
        seen: dict[int, GrammarDocument] = {}
        stack = [self._document]
        while stack:
            document = stack.pop()
            if id(document) not in seen:
                seen[id(document)] = document
                stack += [one.rule.document for one in document.references if one.rule is not None]
        return not any(one.tags or one.globals or one.tag_format for one in seen.values())

    def _takes(self, mode: str) -> bool:
        return mode == self.mode or (not self.mode and mode in ("voice", "dtmf"))

    def _root(self) -> Reference:
        rule = self._document.rules.get(self.root)
        if rule is None:
            message = "This grammar names no root rule, so it takes nothing by itself."
            root = '"root $name;"' if self._document.form == "ABNF" else 'root="..."'
            remedy = f'Write {root}, or name a rule: grammar.rule("...").'
            raise GrammarError.of(self._where(), "no-root", message, remedy)
        return Reference(f"#{self.root}", self._where, "", self._document, self.root)

    @property
    def expansion(self) -> Part:
        """The root rule's expansion, as data.

        Raises:
            GrammarError: the grammar has no root rule.
        """
        rule = self._root().rule
        assert rule is not None
        return rule.body

    def __iter__(self) -> Iterator[str]:
        return iter(self._document.rules)

    def __repr__(self) -> str:
        return f"<Grammar {self.uri or 'inline'} root={self.root!r} mode={self.mode!r}>"


def _analyses(top: Cell, most: int, budget: Budget) -> Iterator[RankedParse]:
    """The best analyses of an utterance, as long as there is time to examine them."""
    work = 0
    for number, analysis in enumerate(best(top, 1 if most == 1 else min(most * 4, MOST_ANALYSES))):
        work += analysis.size
        if number and (work > MOST_WORK or budget.over):
            return
        yield analysis


def _same(one: Match, two: Match) -> bool:
    if one.error is not None or two.error is not None:
        return one.error == two.error
    first, second = one.interpretation, two.interpretation
    return type(first) is type(second) and bool(first == second)
