"""The ABNF form of SRGS 1.0 (Appendix D), read into rules."""

from __future__ import annotations

import codecs
import re
from functools import partial
from typing import NoReturn

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
HEADER = re.compile(r"#ABNF[ \t]+([^\s;]+)(?:[ \t]+([^\s;]+))?[ \t]*;")
_BLANK = r"(?:\s++|//[^\n]*+|/\*[\s\S]*?\*/)*+"
_WORD = r"""[^\s;=|*+<>()\[\]{}/$"!]+"""
_SYMBOL = re.compile(
    rf"""{_BLANK}(?:
    (?P<word>{_WORD})
    |(?P<sign>[;=|()\[\]])
    |(?P<tag>\{{!\{{[\s\S]*?\}}!\}}|\{{(?!!\{{)[^}}]*\}})
    |(?P<quoted>"[^"]*")
    |(?P<name>\${_WORD})
    |(?P<link>\$<[^<>]*>(?:~<[^<>]*>)?)
    |(?P<angle><[^<>]*>(?:~<[^<>]*>)?)
    |(?P<weight>/[^/*\n]+/)
    |(?P<language>!(?:{_WORD})?)
    |(?P<end>\Z)
    |(?P<other>[\s\S])
    )""",
    re.VERBOSE,
)
"""What a grammar is written with, with what is passed over before it; something always fits."""
_TEXT = re.compile(rf"""{_BLANK}("[^"]*"|'[^']*')""")
"""A text in quotes of either kind, as declarations have it."""
_REPEAT = re.compile(r"<\s*([^/\s]+)\s*(?:/([^/]*)/\s*)?>")
DECLARATIONS = (
    *("base", "http-equiv", "language", "lexicon", "meta", "mode", "root", "tag-format"),
)
ONCE = frozenset(["base", "language", "mode", "root", "tag-format"])
SCOPES = ("public", "private")


def decode_abnf(file: str, data: bytes) -> str:
    """The text of a file in the ABNF form, in the encoding that its header names (SRGS 4.4).

    Raises:
        GrammarError: an unknown encoding, or the bytes are not in it.
    """
    encoding = _encoding(data)
    if not _is_accepted(encoding):
        message = f'The encoding "{encoding[:40]}" is not accepted.'
        raise refuse(GrammarError, Place(file), "encoding", message, "Save it as UTF-8.")
    try:
        return data.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        message = f"A byte here is not {encoding.upper()}."
        raise refuse(GrammarError, Place(file, line), "encoding", message) from None


def _is_accepted(encoding: str) -> bool:
    """Whether an encoding is one of those accepted, under any of its names."""
    try:
        name = codecs.lookup(encoding).name
    except (LookupError, ValueError):
        return False
    more = ("utf-8-sig", "utf-16-le", "utf-16-be")
    return name in {codecs.lookup(one).name for one in (*ENCODINGS, *more)}


def _encoding(data: bytes) -> str:
    """The encoding of a file by its first bytes, or as its header says."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if data.startswith((b"#\0", b"\0#")):
        return "utf-16-le" if data[0] else "utf-16-be"
    header = HEADER.match(data[:200].decode("latin-1"))
    return (header[2] or "utf-8").lower() if header else "utf-8-sig"


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
    _Reader(source, document, problems, header.end()).read()


class _Reader:
    """Reads a text from left to right, one symbol ahead.

    What a symbol says wrongly is noted and the reading goes on; it ends where one cannot stand.
    """

    def __init__(self, source: Source, document: Document, problems: Problems, at: int) -> None:
        self.source = source
        self.text = source.text
        self.document = document
        self.problems = problems
        self.kind = ""
        """The kind of the symbol that comes next."""
        self.symbol = ""
        self.at = at
        self.end = at
        self._next()

    # Symbols

    def _next(self) -> None:
        match = _SYMBOL.match(self.text, self.end)
        assert match is not None and match.lastgroup is not None
        self.kind = match.lastgroup
        self.symbol = match[self.kind]
        self.at, self.end = match.start(self.kind), match.end()

    def _take(self, kind: str, expected: str) -> tuple[str, int]:
        """The next symbol, which is of this kind, and where it stands."""
        if self.kind != kind:
            self._fail(expected)
        found = self.symbol, self.at
        self._next()
        return found

    def _sign(self, sign: str) -> None:
        if self.symbol != sign or self.kind != "sign":
            self._fail(f'"{sign}"')
        self._next()

    def _fail(self, expected: str) -> NoReturn:
        """Something stands where it cannot stand."""
        offset = len(self.text.rstrip()) if self.kind == "end" else self.at
        found = self.text[offset : offset + 20].split("\n")[0].strip()
        message = f'"{found}" cannot stand here.' if found else "The grammar ends too early."
        remedy = f"Here may stand {expected}."
        if found.startswith("}"):
            remedy = "A tag that holds a } itself is written {!{ ... }!}."
        elif self.kind == "other":
            remedy = _UNCLOSED.get(self.symbol, f"{remedy} Signs are words only in quotes.")
        place = self.source.at(offset)
        raise GrammarError(
            [*self.problems.found, Problem(place, "error", "not-abnf", message, remedy)]
        )

    def _where(self, at: int) -> Where:
        return partial(self.source.at, at)

    def note(self, at: int, code: str, message: str, remedy: str = "") -> None:
        self.problems.note(self._where(at), code, message, remedy)

    # Header (section 4)

    def read(self) -> None:
        """The header, then the rules."""
        root = self._header()
        document = self.document
        if not document.lang and document.mode == "voice":
            remedy = 'Write "language en-US;" or the like.'
            self.problems.note(document.where, "missing-attribute", "It has no language.", remedy)
        while self.kind != "end":
            self._rule()
        if root is not None and document.root not in document.rules:
            hint = did_you_mean(document.root, document.rules)
            self.note(root, "no-such-rule", f'The root rule "{document.root}" is not there.', hint)

    def _header(self) -> int | None:
        """All declarations; gives where the root is named."""
        seen: set[str] = set()
        root: int | None = None
        while self.kind == "tag" or (self.kind == "word" and self.symbol not in SCOPES):
            kind, at = self.symbol, self.at
            if self.kind == "tag":
                self.document.globals.append(self._tag())
            elif kind not in DECLARATIONS:
                self._fail("a declaration such as root $name; or a rule such as $name = ...;")
            elif kind in ("meta", "http-equiv"):
                self._meta()
            else:
                self._next()
                at = self.at
                self._declare(kind)
                root = at if kind == "root" else root
            if kind in ONCE & seen:
                self.note(
                    at, "duplicate-element", f"There are two declarations of {kind}.", "Keep one."
                )
            seen.add(kind)
            self._sign(";")
        return root

    def _declare(self, kind: str) -> None:
        document, at = self.document, self.at
        match kind:
            case "language":
                document.lang, _ = self._take("word", "a language such as en-US")
                self._language(document.lang, at)
            case "mode":
                mode, _ = self._take("word", "voice or dtmf")
                if mode not in MODES:
                    message = f'A grammar\'s mode is voice or dtmf, not "{mode[:40]}".'
                    self.note(at, "bad-value", message)
                document.mode = "dtmf" if mode == "dtmf" else "voice"
            case "root":
                document.root = self._take("name", "the name of a rule, $name")[0][1:]
            case "tag-format":
                document.tag_format = self._uri()
            case "base":
                document.base = self._uri()
            case _:
                document.lexicons.append(self._uri(media=True))

    def _uri(self, media: bool = False) -> str:
        symbol, at = self._take("angle", "a URI in angle brackets, <uri>")
        uri, told, _ = symbol.partition("~")
        if not uri[1:-1].strip() or (told and not media):
            self.note(at, "bad-value", f'"{symbol[:60]}" is no URI in angle brackets.')
        return uri[1:-1].strip()

    def _meta(self) -> None:
        """``meta "name" is "content"``, where quotes may be single ones (4.11)."""
        name = self._quoted()
        self._next()
        if (self.kind, self.symbol) != ("word", "is"):
            self._fail("the word is")
        self.document.meta[name] = self._quoted()
        self._next()

    def _quoted(self) -> str:
        match = _TEXT.match(self.text, self.end)
        if match is None:
            self._next()
            self._fail("a text in quotes")
        self.end = match.end()
        return match[1][1:-1]

    def _language(self, text: str, at: int) -> None:
        if not is_language(text):
            self.note(at, "bad-value", f'"{text[:40]}" names no language.', 'Write "en-US".')

    # Rules (section 3) and expansions (section 2)

    def _rule(self) -> None:
        public = False
        if self.kind == "word" and self.symbol in SCOPES:
            public = self.symbol == "public"
            self._next()
        elif self.kind == "tag" or (self.kind == "word" and self.symbol in DECLARATIONS):
            self._fail("a rule, $name = ...;: declarations come before all rules")
        symbol, at = self._take("name", "a rule, $name = ...;")
        name = symbol[1:]
        if problem := name_problem(name):
            self.note(at, "bad-value", problem)
        elif name in self.document.rules:
            self.note(at, "duplicate-id", f'There are two rules "{name}".')
        self._sign("=")
        rule = Rule(name, self._expansion(1), self.document, public)
        self._sign(";")
        self.document.rules.setdefault(name, rule)

    def _expansion(self, depth: int) -> Part:
        """Alternatives (2.4); at least one, none of them empty."""
        if depth > MAX_DEPTH:
            message = f"Brackets are nested more than {MAX_DEPTH} deep."
            place = self.source.at(self.at)
            raise refuse(GrammarError, place, "too-deep", message, "Make rules of the inner ones.")
        parts: list[Part] = []
        weights: list[float | None] = []
        while True:
            weights.append(self._weight())
            parts.append(self._sequence(depth))
            if self.kind != "sign" or self.symbol != "|":
                return choice(parts, weights)
            self._next()

    def _weight(self) -> float | None:
        if self.kind != "weight":
            return None
        symbol, at = self._take("weight", "a weight")
        try:
            return decimal(symbol[1:-1].strip(), "weight")
        except ValueError as error:
            self.note(at, "bad-value", str(error))
            return None

    def _sequence(self, depth: int) -> Part:
        """Expansions one after another (2.3); tokens side by side are taken together."""
        parts: list[Part] = []
        words: list[str] = []
        began = self.at
        while (part := self._unit(depth)) is not None:
            if self.kind == "angle":
                if isinstance(part, str):
                    part = self._words([part])
                part = self._repeat(part)
            if isinstance(part, str):
                words.append(part)
                continue
            if words:
                parts.append(self._words(words))
                words = []
            parts.append(part)
        if self.at == began:
            self._fail("a token, or () for nothing")
        if words:
            parts.append(self._words(words))
        return sequence(parts)

    def _unit(self, depth: int) -> Part | str | None:
        """One expansion with its language; a token as text, or None where there is none."""
        found: Part | str
        match self.kind:
            case "word" | "quoted":
                found = self._token()
            case "tag":
                tag = self._tag()
                self.document.tags.append(tag)
                return tag
            case "name" | "link":
                found = self._reference()
            case "sign" if self.symbol in "([":
                closing = ")" if self.symbol == "(" else "]"
                self._next()
                if closing == ")" and (self.kind, self.symbol) == ("sign", ")"):
                    self._next()
                    return sequence([])
                found = self._expansion(depth + 1)
                self._sign(closing)
                found = Repeat(found, 0, 1) if closing == "]" else found
            case _:
                return None
        self._attached()
        return found

    def _attached(self) -> None:
        """The language of an expansion, if one is told (2.7)."""
        if self.kind == "language":
            self._language(self.symbol[1:], self.at)
            self._next()

    def _token(self) -> str:
        quoted = self.kind == "quoted"
        symbol, at = self._take(self.kind, "a token")
        text = " ".join(symbol[1:-1].split()) if quoted else symbol
        if not text:
            self.note(at, "bad-token", "A token holds something.", "Write () for nothing.")
            return ""
        if self.document.mode != "dtmf":
            return text
        pressed = keys(text)
        if pressed is None or len(pressed) != 1:
            message = f'"{text[:40]}" is no key of a telephone.'
            self.note(at, "bad-token", message, 'Keys are 0 to 9, "*", "#", and A to D.')
        return pressed or ""

    def _words(self, words: list[str]) -> Part:
        folded = "".join(words) if self.document.mode == "dtmf" else fold(" ".join(words))
        return Words(folded, tuple(words))

    def _reference(self) -> Part:
        local = self.kind == "name"
        symbol, at = self._take(self.kind, "a rule")
        if local:
            name = symbol[1:]
            if name in RESERVED:
                return Special(name)
            if problem := name_problem(name):
                self.note(at, "bad-value", problem)
            found = Reference(f"#{name}", self._where(at))
        else:
            uri, _, media = symbol[1:].partition("~")
            found = Reference(uri[1:-1].strip(), self._where(at), media[1:-1].strip())
        self.document.references.append(found)
        return found

    def _repeat(self, part: Part) -> Part:
        bounds, at = self._take("angle", "a repeat")
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
            self.note(at, "bad-value", str(error))
            return part

    def _tag(self) -> Tag:
        symbol, at = self._take("tag", "a tag")
        text = symbol[3:-3] if symbol.startswith("{!{") else symbol[1:-1]
        return Tag(text, self._where(at))


_UNCLOSED = {
    '"': 'A quote is opened and not closed: write the other ".',
    "{": "A tag is opened and not closed: write }, or }!} if it begins with {!{.",
    "<": "An angle bracket is opened and not closed: write >.",
    "/": "A comment or a weight is not closed: /* ... */, /0.5/.",
}
"""Remedies for what begins something and does not end it."""
