"""The ABNF form of SRGS 1.0 (Appendix D), read into rules."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextvars import ContextVar
from functools import cache, partial
from typing import Any

from lark import Lark, TextSlice, Token, UnexpectedInput

from prima.errors import Hint, Span
from prima.grammar.abnferrors import unexpected
from prima.grammar.abnfheader import header_end
from prima.grammar.errors import GrammarError, Problems, Where, other_rule
from prima.grammar.model import GrammarDocument, Part, Reference, Repeat, Rule, Special, Tag, Words
from prima.grammar.text import fold, keys
from prima.grammar.values import (
    MODES,
    RESERVED,
    choice,
    cost,
    decimal,
    is_language,
    name_problem,
    probability,
    repeat,
    sequence,
)
from prima.markup.tree import Source

MAX_DEPTH = 100
_REPEAT = re.compile(r"<\s*([^/\s]+)\s*(?:/([^/]*)/\s*)?>")


def read_abnf(
    source: Source, document: GrammarDocument, problems: Problems, where: Where, lenient: bool
) -> None:
    """Read a text in the ABNF form into a document.

    ``lenient`` warns of a missing language.

    Raises:
        GrammarError: the text is not of this form.
    """
    document.where = where
    header = header_end(source)
    reader = _AbnfReader(source, document, problems, lenient)
    before = _reader.set(reader)
    try:
        _parser().parse(TextSlice(source.text, header, len(source.text)))
    except UnexpectedInput as error:
        raise GrammarError([*problems.found, unexpected(source, error)]) from None
    finally:
        _reader.reset(before)


class _AbnfReader:
    """Builds a document as the parser goes along; notes problems and continues.

    A method in capitals gets a token (named in abnf.lark) as soon as it is read, any other
    the parts of a whole rule of that grammar.
    """

    def __init__(
        self, source: Source, document: GrammarDocument, problems: Problems, lenient: bool
    ) -> None:
        self.source = source
        self.document = document
        self.problems = problems
        self.lenient = lenient
        self.declared: set[str] = set()
        self.root: Token | None = None
        self.depth = 0

    def _where(self, token: Token) -> Where:
        return partial(self.source.at, token.start_pos or 0)

    def note(self, token: Token, code: str, message: str, remedy: str | Hint = "") -> None:
        self.problems.note(self._where(token), code, message, remedy)

    # Header (section 4)

    def LANGTAG(self, token: Token) -> None:
        self.document.lang = token.value
        self._language(token.value, token)
        self._once("language", token)

    def MODENAME(self, token: Token) -> None:
        if token.value not in MODES:
            message = f'A grammar\'s mode is voice or dtmf, not "{token[:40]}".'
            self.note(token, "bad-value", message, "Write mode voice; or mode dtmf;.")
        self.document.mode = "dtmf" if token.value == "dtmf" else "voice"
        self._once("mode", token)

    def ROOTNAME(self, token: Token) -> None:
        self.document.root = token[1:]
        self.root = token
        self._once("root", token)

    def FORMATURI(self, token: Token) -> None:
        self.document.tag_format = self._uri(token)
        self.document.formatted = self._where(token)
        self._once("tag-format", token)

    def BASEURI(self, token: Token) -> None:
        self.document.base = self._uri(token)
        self._once("base", token)

    def LEXICONURI(self, token: Token) -> None:
        self._uri(token, media=True)

    def GLOBAL(self, token: Token) -> None:
        self.document.globals.append(self._tag(token))

    def meta(self, found: list[str]) -> None:
        """``meta "name" is "content"``, where quotes may be single ones (4.11)."""
        self.document.meta[found[1][1:-1]] = found[3][1:-1]

    def header(self, found: list[Any]) -> None:
        lang = self.document.lang
        known = "language" in self.declared or (lang and not self.lenient)
        if not known and self.document.mode == "voice":
            tell = self.problems.warn if lang else self.problems.note
            remedy = 'Write "language en-US;" or the like.'
            tell(self.document.where, "missing-attribute", "It has no language.", remedy)

    def _once(self, kind: str, token: Token) -> None:
        if kind in self.declared:
            message = f"There are two declarations of {kind}."
            self.note(token, "duplicate-element", message, "Keep one.")
        self.declared.add(kind)

    def _uri(self, token: Token, media: bool = False) -> str:
        uri, media_type, _ = token.partition("~")
        if not uri[1:-1].strip() or (media_type and not media):
            message = f'"{token[:60]}" is not a URI in angle brackets.'
            self.note(token, "bad-value", message, "Write one such as <names.gram>.")
        return uri[1:-1].strip()

    def _language(self, text: str, token: Token) -> None:
        if not is_language(text):
            message = f'"{text[:40]}" names no language.'
            self.note(token, "bad-value", message, 'Write "en-US".')

    # Rules (section 3)

    def PUBLIC(self, token: Token) -> bool:
        return True

    def NAME(self, token: Token) -> str:
        name = token[1:]
        if problem := name_problem(name):
            self.note(token, "bad-value", problem, "Choose another name.")
        elif name in self.document.rules:
            self.note(token, "duplicate-id", f'There are two rules "{name}".', "Rename one.")
        return name

    def rule(self, found: list[Any]) -> None:
        name, _, alternatives, _ = found[-4:]
        rule = Rule(name, choice(*alternatives), self.document, found[0] is True)
        self.document.rules.setdefault(name, rule)

    def start(self, found: list[Any]) -> None:
        root, rules = self.document.root, self.document.rules
        if self.root is not None and root not in rules:
            hint = other_rule(root, rules, self._named(self.root))
            self.note(self.root, "no-such-rule", f'The root rule "{root}" is not there.', hint)

    def _named(self, token: Token) -> Span:
        """The name that follows the $ of a token."""
        place = self._where(token)()
        return Span.of(place._replace(column=place.column + 1), token[1:])

    # Alternatives (2.4)

    def WEIGHT(self, token: Token) -> float | None:
        try:
            return decimal(token[1:-1].strip(), "weight")
        except ValueError as error:
            self.note(token, "bad-value", str(error), "Write one such as /2.5/.")
            return None

    def alternative(self, found: list[Any]) -> Alternatives:
        """The first one."""
        return [self._sequence(found[-1])], [found[0] if len(found) == 2 else None]

    def alternatives(self, found: list[Any]) -> Alternatives:
        """The previous ones, a sign, and one more."""
        parts, weights = found[0]
        parts.append(self._sequence(found[-1]))
        weights.append(found[2] if len(found) == 4 else None)
        return parts, weights

    # Sequences (2.3), repeats (2.5) and brackets

    def parts(self, found: list[Any]) -> list[Part | str]:
        """The previous ones, if any, and one more, which may have a language and a repeat."""
        before: list[Part | str] = found.pop(0) if isinstance(found[0], list) else []
        part, *more = found
        for times in more:  # a language is None
            if times is not None:
                part = Repeat(self._words([part]) if isinstance(part, str) else part, *times)
        before.append(part)
        return before

    def _sequence(self, found: list[Part | str]) -> Part:
        """A sequence; adjacent tokens are joined."""
        parts: list[Part] = []
        words: list[str] = []
        for part in found:
            if isinstance(part, str):
                words.append(part)
                continue
            if words:
                parts.append(self._words(words))
                words = []
            parts.append(part)
        if words:
            parts.append(self._words(words))
        return sequence(parts)

    def _words(self, words: list[str]) -> Part:
        folded = "".join(words) if self.document.mode == "dtmf" else fold(" ".join(words))
        return Words(folded, tuple(words))

    def REPEAT(self, token: Token) -> tuple[int, int | None, float, float] | None:
        match = _REPEAT.fullmatch(token)
        try:
            if match is None:
                raise ValueError(f'"{token[:40]}" is not a repeat such as <0-1> or <2- /0.5/>.')
            low, high = repeat(match[1])
            if match[2] is None:
                return low, high, 0.0, 0.0
            chance = probability(match[2].strip())
            return low, high, cost(chance), cost(1 - chance)
        except ValueError as error:
            self.note(token, "bad-value", str(error), "Write one such as <0-1>.")
            return None

    def LPAR(self, token: Token) -> None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            message = f"Brackets are nested more than {MAX_DEPTH} deep."
            place = self.source.at(token.start_pos or 0)
            raise GrammarError.of(place, "too-deep", message, "Make rules of the inner ones.")

    def RPAR(self, token: Token) -> None:
        self.depth -= 1

    LSQB, RSQB = LPAR, RPAR

    def group(self, found: list[Any]) -> Part:
        return choice(*found[1])

    def optional(self, found: list[Any]) -> Part:
        return Repeat(choice(*found[1]), 0, 1)

    def nothing(self, found: list[Any]) -> Part:
        return sequence([])

    # Tokens (2.1), references (2.2), tags (2.6) and languages (2.7)

    def WORD(self, token: Token) -> str:
        self._no_question_mark(token)
        return self._token(token.value, token)

    def QUOTED(self, token: Token) -> str:
        text = " ".join(token[1:-1].split())
        if not text:
            message = "A token holds something."
            self.note(token, "bad-token", message, "Write () for nothing.")
            return ""
        return self._token(text, token)

    def _no_question_mark(self, token: Token) -> bool:
        """Refuse the question mark, which is reserved after an expansion (2.5)."""
        if "?" not in token:
            return False
        message = f'"{token[:40]}" has a question mark, which is reserved after an expansion.'
        remedy = (
            "Write <0-1> after what may be left out; drop the ? of a sentence: it is not heard."
        )
        self.note(token, "bad-token", message, remedy)
        return True

    def _token(self, text: str, token: Token) -> str:
        if self.document.mode != "dtmf":
            return text
        pressed = keys(text)
        if pressed is None or len(pressed) != 1:
            message = f'"{text[:40]}" is not a telephone key.'
            remedy = 'Keys are 0 to 9, "*", "#", and A to D.'
            self.note(token, "bad-token", message, remedy)
        return pressed or ""

    def REFERENCE(self, token: Token) -> Part:
        name = token[1:]
        if name in RESERVED:
            return Special(name)
        if not self._no_question_mark(token) and (problem := name_problem(name)):
            self.note(token, "bad-value", problem, "Choose another name.")
        return self._reference(f"#{name}", token)

    def LINK(self, token: Token) -> Reference:
        uri, _, media = token[1:].partition("~")
        found = self._reference(uri[1:-1].strip(), token, media[1:-1].strip())
        found.lead = len("$<")
        return found

    def _reference(self, uri: str, token: Token, media: str = "") -> Reference:
        found = Reference(uri, self._where(token), media)
        self.document.references.append(found)
        return found

    def TAG(self, token: Token) -> Tag:
        tag = self._tag(token)
        self.document.tags.append(tag)
        return tag

    def _tag(self, token: Token) -> Tag:
        text = token[3:-3] if token.startswith("{!{") else token[1:-1]
        return Tag(text, self._where(token))

    def ATTACHED(self, token: Token) -> None:
        self._language(token[1:], token)


Alternatives = tuple[list[Part], list[float | None]]
"""The alternatives, and the weight of each, if given."""
_reader: ContextVar[_AbnfReader] = ContextVar("reader")
"""The active reader; all share one parser."""


class _Handlers:
    """The methods of the active reader."""

    def __getattr__(self, name: str) -> Callable[[Any], object]:
        method = getattr(_AbnfReader, name)
        return lambda found: method(_reader.get(), found)


@cache
def _parser() -> Lark:
    return Lark.open("abnf.lark", rel_to=__file__, parser="lalr", transformer=_Handlers())
