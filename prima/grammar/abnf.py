"""The ABNF form of SRGS 1.0 (Appendix D), read into rules."""

from __future__ import annotations

import codecs
import re
from functools import lru_cache, partial

import lark
from lark import Token, Tree

from prima.errors import Place, Problem, did_you_mean
from prima.grammar.errors import GrammarError, Problems, Where, refuse
from prima.grammar.model import Document, Part, Reference, Repeat, Rule, Special, Tag, Words
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
from prima.markup.reader import ENCODINGS
from prima.markup.tree import Source

MAX_DEPTH = 100
SYNTAX = r"""
start: declaration* rule*
declaration: "language" LANGTAG ";"   -> language
    | "mode" MODE ";"                 -> mode
    | "root" RULENAME ";"             -> root
    | "tag-format" URI ";"            -> tag_format
    | "base" URI ";"                  -> base
    | "lexicon" LEXICON ";"           -> lexicon
    | ("meta" | "http-equiv") QUOTED "is" QUOTED ";" -> meta
    | TAG ";"                         -> global_tag
rule: [SCOPE] RULENAME "=" expansion ";"
expansion: alternative ("|" alternative)*
alternative: [WEIGHT] element+
element: _unit REPEAT*
_unit: word | reference | tag | nothing | group | optional
word: (TOKEN | QUOTED) [LANGUAGE]
reference: (RULENAME | URIREF) [LANGUAGE]
tag: TAG
nothing: "(" ")"
group: "(" expansion ")" [LANGUAGE]
optional: "[" expansion "]" [LANGUAGE]

SCOPE.2: /(public|private)(?=[\s\/$])/
MODE: /[^\s;]+/
LANGTAG: /[^\s;]+/
RULENAME: /\$[\w.:\-]+/
URIREF: /\$<[^<>]*>(~<[^<>]*>)?/
URI: /<[^<>]*>/
LEXICON: /<[^<>]*>(~<[^<>]*>)?/
REPEAT: /<[^<>]*>/
WEIGHT: /\/[^\/*\n]+\//
TAG: /\{!\{[\s\S]*?\}!\}|\{(?!!\{)[^}]*\}/
QUOTED: /"[^"]*"/
LANGUAGE: /![A-Za-z0-9\-]+/
TOKEN: /[^\s;=|*+<>()\[\]{}\/$"!]+/
COMMENT: /\/\/[^\n]*|\/\*[\s\S]*?\*\//
%ignore COMMENT
%ignore /\s+/
"""
HEADER = re.compile(r"#ABNF[ \t]+([^\s;]+)(?:[ \t]+([^\s;]+))?[ \t]*;")
_NESTING = re.compile(
    r"""//[^\n]*|/\*[\s\S]*?\*/|"[^"]*"|\{!\{[\s\S]*?\}!\}|\{[^}]*\}|<[^<>]*>|[()\[\]]"""
)
_REPEAT = re.compile(r"<\s*([^/\s]+)\s*(?:/([^/]*)/\s*)?>")
_NAMES = {
    "SEMICOLON": '";"', "EQUAL": '"="', "TOKEN": "a token", "RULENAME": "$name",
    "$END": "the end", "RPAR": '")"', "RSQB": '"]"', "VBAR": '"|"', "URI": "<uri>",
    "LANGTAG": "a language", "MODE": "voice or dtmf", "QUOTED": "a text in quotes",
}  # fmt: skip
"""What is named where something else stands, most telling first."""


def decode_abnf(file: str, data: bytes) -> str:
    """The text of a file in the ABNF form, in the encoding that its header names (SRGS 4.4).

    Raises:
        GrammarError: an unknown encoding, or the bytes are not in it.
    """
    encoding = "utf-8-sig"
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        encoding = "utf-16"
    elif match := HEADER.match(data[:200].decode("latin-1")):
        encoding = (match[2] or "utf-8").lower()
    if encoding.removesuffix("-sig") not in ENCODINGS:
        message = f'The encoding "{encoding[:40]}" is not accepted.'
        raise refuse(GrammarError, Place(file), "encoding", message, "Save it as UTF-8.")
    try:
        return data.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        message = f"A byte here is not {encoding.upper()}."
        raise refuse(GrammarError, Place(file, line), "encoding", message) from None


@lru_cache(maxsize=1)
def _parser() -> lark.Lark:
    return lark.Lark(SYNTAX, parser="lalr", lexer="contextual", maybe_placeholders=True)


def read_abnf(source: Source, document: Document, problems: Problems, where: Where) -> None:
    """Read a text in the ABNF form into a document.

    Raises:
        GrammarError: the text is not of this form.
    """
    document.where = where
    header = HEADER.match(source.text)
    if header is None or header[1] != "1.0":
        found = header[1] if header else ""
        message = f'Version "{found[:20]}" is not known.' if found else "The header is missing."
        remedy = 'Begin with "#ABNF 1.0 UTF-8;" in the first line.'
        raise refuse(GrammarError, source.at(0), "not-abnf", message, remedy)
    _check_depth(source)
    blank = re.sub(r"[^\n]", " ", header[0])
    try:
        tree = _parser().parse(blank + source.text[header.end() :])
    except lark.UnexpectedInput as error:
        raise GrammarError([_syntax_problem(source, error)]) from None
    _Reader(source, document, problems).read(tree)


def _check_depth(source: Source) -> None:
    depth = 0
    for match in _NESTING.finditer(source.text):
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(match[0], 0)
        if depth > MAX_DEPTH:
            place = source.at(match.start())
            message = f"Brackets are nested more than {MAX_DEPTH} deep."
            raise refuse(GrammarError, place, "too-deep", message, "Make rules of the inner ones.")


def _syntax_problem(source: Source, error: lark.UnexpectedInput) -> Problem:
    """What stands where nothing of the kind may stand."""
    offset = error.pos_in_stream
    if isinstance(error, lark.UnexpectedToken) and error.token.type == "$END":
        offset = len(source.text.rstrip())
    if offset is None or offset < 0:
        offset = len(source.text.rstrip())
    accepted: set[str] = set()
    if isinstance(error, lark.UnexpectedToken):
        accepted = set(error.accepts or error.expected)
    elif isinstance(error, lark.UnexpectedCharacters):
        accepted = set(error.allowed or ())
    found = source.text[offset : offset + 20].split("\n")[0].strip()
    message = f'"{found}" cannot stand here.' if found else "The grammar ends too early."
    likely = [shown for name, shown in _NAMES.items() if name in accepted]
    remedy = f"Here may stand {likely[0]}." if likely else ""
    return Problem(source.at(offset), "error", "not-abnf", message, remedy)


class _Reader:
    """Puts the parsed text into a document; notes what is wrong and goes on."""

    def __init__(self, source: Source, document: Document, problems: Problems) -> None:
        self.source = source
        self.document = document
        self.problems = problems
        self.seen: set[str] = set()

    def note(self, at: Token, code: str, message: str, remedy: str = "") -> None:
        self.problems.note(self._where(at), code, message, remedy)

    def _where(self, at: Token) -> Where:
        return partial(self.source.at, at.start_pos or 0)

    def read(self, tree: Tree[Token]) -> None:
        """All declarations, then all rules: the mode says what tokens are."""
        children = [child for child in tree.children if isinstance(child, Tree)]
        root: Token | None = None
        for child in children:
            if child.data != "rule":
                root = self._declare(child) or root
        document = self.document
        if not document.lang and document.mode == "voice":
            remedy = 'Write "language en-US;" or the like.'
            self.problems.note(document.where, "missing-attribute", "It has no language.", remedy)
        for child in children:
            if child.data == "rule":
                self._rule(child)
        if root is not None and document.root not in document.rules:
            hint = did_you_mean(document.root, document.rules)
            self.note(root, "no-such-rule", f'The root rule "{document.root}" is not there.', hint)

    # Header (section 4)

    def _declare(self, tree: Tree[Token]) -> Token | None:
        """One declaration; gives the token of the root's name."""
        kind = str(tree.data)
        value = [child for child in tree.children if isinstance(child, Token)][-1]
        if kind in self.seen and kind not in ("meta", "global_tag", "lexicon"):
            message = f"There are two declarations of {kind.replace('_', '-')}."
            self.note(value, "duplicate-element", message, "Keep one.")
        self.seen.add(kind)
        document = self.document
        match kind:
            case "language":
                self._language(value, str(value))
                document.lang = str(value)
            case "mode":
                if value not in MODES:
                    message = f'A grammar\'s mode is voice or dtmf, not "{value}".'
                    self.note(value, "bad-value", message)
                document.mode = "dtmf" if value == "dtmf" else "voice"
            case "root":
                document.root = str(value[1:])
                return value
            case "tag_format":
                document.tag_format = str(value[1:-1]).strip()
            case "base":
                document.base = str(value[1:-1]).strip()
            case "lexicon":
                document.lexicons.append(str(value.partition("~")[0][1:-1]))
            case "meta":
                name, content = (str(child)[1:-1] for child in tree.children[-2:])
                document.meta[name] = content
            case _:
                document.globals.append(self._tag(value))
        return None

    def _language(self, at: Token, text: str) -> None:
        if not is_language(text):
            self.note(at, "bad-value", f'"{text[:40]}" names no language.', 'Write "en-US".')

    # Rules (section 3) and expansions (section 2)

    def _rule(self, tree: Tree[Token]) -> None:
        scope, name, expansion = tree.children
        assert isinstance(name, Token) and isinstance(expansion, Tree)
        called = str(name[1:])
        if problem := name_problem(called):
            self.note(name, "bad-value", problem)
        elif called in self.document.rules:
            self.note(name, "duplicate-id", f'There are two rules "{called}".')
        rule = Rule(called, self._expansion(expansion), self.document, scope == "public")
        self.document.rules.setdefault(called, rule)

    def _expansion(self, tree: Tree[Token]) -> Part:
        parts: list[Part] = []
        weights: list[float | None] = []
        for alternative in tree.children:
            assert isinstance(alternative, Tree)
            weight, *elements = alternative.children
            weights.append(self._number(weight) if isinstance(weight, Token) else None)
            parts.append(self._sequence([one for one in elements if isinstance(one, Tree)]))
        return choice(parts, weights)

    def _number(self, token: Token) -> float | None:
        try:
            return decimal(token.strip("/").strip(), "weight")
        except ValueError as error:
            self.note(token, "bad-value", str(error))
            return None

    def _sequence(self, elements: list[Tree[Token]]) -> Part:
        """Elements one after another; tokens side by side are taken together."""
        parts: list[Part] = []
        words: list[str] = []
        for element in elements:
            unit, *repeats = element.children
            assert isinstance(unit, Tree)
            if unit.data == "word" and not repeats:
                words.append(self._token(unit))
                continue
            parts += self._words(words)
            words = []
            part = self._unit(unit)
            for bounds in repeats:
                part = self._repeat(part, bounds)
            parts.append(part)
        return sequence(parts + self._words(words))

    def _unit(self, unit: Tree[Token]) -> Part:
        first = unit.children[0] if unit.children else None
        if unit.data == "word":
            return sequence(self._words([self._token(unit)]))
        self._attached(unit)
        if unit.data == "reference":
            assert isinstance(first, Token)
            return self._reference(first)
        if unit.data == "tag":
            assert isinstance(first, Token)
            tag = self._tag(first)
            self.document.tags.append(tag)
            return tag
        if not isinstance(first, Tree):
            return sequence([])
        inside = self._expansion(first)
        return Repeat(inside, 0, 1) if unit.data == "optional" else inside

    def _attached(self, unit: Tree[Token]) -> None:
        last = unit.children[-1] if unit.children else None
        if isinstance(last, Token) and last.type == "LANGUAGE":
            self._language(last, str(last[1:]))

    def _token(self, unit: Tree[Token]) -> str:
        self._attached(unit)
        token = unit.children[0]
        assert isinstance(token, Token)
        text = " ".join((token[1:-1] if token.type == "QUOTED" else token).split())
        if not text:
            self.note(token, "bad-token", "A token holds something.", "Write () for nothing.")
        pressed = keys(text) if self.document.mode == "dtmf" and text else " "
        if pressed is None or len(pressed) != 1:
            message = f'"{text[:40]}" is no key of a telephone.'
            self.note(token, "bad-token", message, 'Keys are 0 to 9, "*", "#", and A to D.')
        return (pressed or "").strip() if self.document.mode == "dtmf" else text

    def _words(self, words: list[str]) -> list[Part]:
        if not words:
            return []
        folded = "".join(words) if self.document.mode == "dtmf" else fold(" ".join(words))
        return [Words(folded, tuple(words))]

    def _reference(self, token: Token) -> Part:
        if token.type == "RULENAME":
            name = str(token[1:])
            if name in RESERVED:
                return Special(name)
            if problem := name_problem(name):
                self.note(token, "bad-value", problem)
            found = Reference(f"#{name}", self._where(token))
        else:
            uri, _, media = token[1:].partition("~")
            found = Reference(uri[1:-1].strip(), self._where(token), media[1:-1].strip())
        self.document.references.append(found)
        return found

    def _repeat(self, part: Part, bounds: object) -> Part:
        assert isinstance(bounds, Token)
        match = _REPEAT.fullmatch(bounds)
        try:
            if match is None:
                raise ValueError(f'"{bounds[:40]}" is no repeat such as <0-1> or <2- /0.5/>.')
            low, high = repeat(match[1])
            if match[2] is None:
                return Repeat(part, low, high)
            chance = probability(match[2].strip())
            return Repeat(part, low, high, cost(chance), cost(1 - chance))
        except ValueError as error:
            self.note(bounds, "bad-value", str(error))
            return part

    def _tag(self, token: Token) -> Tag:
        text = str(token[3:-3] if token.startswith("{!{") else token[1:-1])
        return Tag(text, self._where(token))
