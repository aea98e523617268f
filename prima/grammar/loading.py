"""Loading a grammar: from an element, a file's text or bytes, or the name of a built-in type."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from urllib.parse import urldefrag

from prima.errors import DocumentError, Place
from prima.grammar.builtin import TYPES, Conflict, built_in, uri_mode
from prima.grammar.errors import (
    GrammarError,
    UnsupportedBuiltIn,
    UnsupportedLanguage,
    other_rule,
)
from prima.grammar.grammar import Grammar
from prima.grammar.linking import Fetch, Library, Refusal, joined
from prima.grammar.media import ABNF_TYPES, check_form, check_known, check_no_text, media_type
from prima.grammar.model import GrammarDocument, Mode, Rule
from prima.grammar.xmlform import read_xml
from prima.markup.encodings import blank
from prima.markup.limits import LIMITS, too_large
from prima.markup.reader import parse
from prima.markup.spans import value_span
from prima.markup.tree import Inner, Node, Source
from prima.markup.uris import parted

_NAMED = re.compile(rf"(?:builtin:.*|(?:{'|'.join(TYPES)})(?:\?.*)?)", re.DOTALL)
_DECLARED = re.compile(r"""(<\?xml[^>]*?)\s+encoding\s*=\s*(?:"[^"]*"|'[^']*')""")

Languages = Callable[[str], bool]


def load(
    source: Node | bytes | str,
    *,
    base: str = "",
    lang: str = "en",
    mode: Mode | None = None,
    fetch: Fetch | None = None,
    refusal: Refusal | None = None,
    type: str = "",
    rule: str = "",
    languages: Languages | None = None,
    lenient: bool = False,
) -> Grammar:
    """Load a grammar.

    Args:
        source: a ``<grammar>`` element inside a document, the text or bytes of a whole file in
            either form of SRGS 1.0, a ``builtin:`` URI, or the name of a built-in type.
        base: the URI of the file, or of the document that contains the element.
        lang: the language of an element or a built-in type that does not declare its own.
        mode: the mode of an element or a built-in type that does not declare its own.
        fetch: returns the bytes of a grammar that is referred to; by default none may be.
        refusal: returns why one grammar may not refer to another, by their URIs; empty if it may.
        type: the media type, if known.
        rule: the rule to match in place of the root.
        languages: whether a language is accepted; by default every one is.
        lenient: whether files without a namespace are accepted as SRGS, and files without
            ``xml:lang`` as in the given language, as voice browsers do; the interpretation of
            a grammar without tags is then the whole text, and ``rule`` must be public.

    Raises:
        UnsupportedFormat: the media type, or the format of the tags, is not known.
        UnsupportedLanguage: ``languages`` does not accept the grammar's language.
        UnsupportedBuiltIn: there is no such built-in type.
        GrammarError: the grammar is not legal.
    """
    library = Library(fetch, partial(_document, lang, lenient), refusal)
    if isinstance(source, str) and _NAMED.fullmatch(source.strip()):
        return _named(source.strip(), mode, lang)
    if isinstance(source, Node):
        document, rule = _element(library, source, base, lang, mode, type, rule)
    else:
        data = source if isinstance(source, bytes) else _bytes(source)
        document = _document(lang, lenient, library, base, data, type)
        media, file = media_type(type), urldefrag(base)[0]
        check_form(library.problems, media, document.form, file, document.where)
        library.add(document)
    _language(library, document, languages)
    library.link()
    library.problems.check()
    if rule and rule not in document.rules:
        message = f'There is no rule "{rule}".'
        hint = other_rule(rule, document.rules)
        raise GrammarError.of(document.where(), "no-such-rule", message, hint)
    if lenient and rule and not document.rules[rule].public:
        message = f'The rule "{rule}" is private: it is for this grammar alone.'
        raise GrammarError.of(document.where(), "private-rule", message)
    return Grammar(document, rule, document.where, lenient, library.problems.warnings)


def _language(library: Library, document: GrammarDocument, languages: Languages | None) -> None:
    spoken = document.lang and document.mode == "voice"
    if spoken and languages is not None and not languages(document.lang):
        message = f'Grammars in "{document.lang}" are not taken.'
        remedy = "Write another language."
        problems = library.problems
        problems.unsupported(UnsupportedLanguage, document.where, "language", message, remedy)


# Built-in types


def _named(uri: str, mode: Mode | None, lang: str) -> Grammar:
    """The grammar of a built-in type (VoiceXML 2.0 Appendix P)."""
    mode = uri_mode(uri) or mode
    where = partial(Place, uri)
    try:
        found = built_in(uri, lang)
    except Conflict as error:
        raise GrammarError.of(where(), "exclusive", str(error)) from None
    except ValueError as error:
        raise UnsupportedBuiltIn.of(where(), "no-such-name", str(error)) from None
    document = GrammarDocument(uri, where, mode or "", lang, found.name, dialect="literals")
    document.rules[found.name] = Rule(found.name, found, document, True)
    return Grammar(document, "", where)


# Elements


def _element(
    library: Library, node: Node, base: str, lang: str, mode: Mode | None, type: str, rule: str
) -> tuple[GrammarDocument, str]:
    """A <grammar> element inside a document: rules, text in ABNF, or a reference by src."""
    media = media_type(node.get("type") or type)
    if node.get("xml:base"):
        base = joined(base, node.get("xml:base"), partial(node.attribute_place, "xml:base"))
    if "src" in node.attributes:
        return _external(library, node, base, media, rule)
    where = partial(node.attribute_place, "")
    document = GrammarDocument(base, where, mode or "voice", node.get("xml:lang", lang))
    check_known(media, where(), node.own_text)
    if not node.nodes and (media in ABNF_TYPES or node.own_text.lstrip().startswith("#ABNF")):
        from prima.grammar.abnf import read_abnf

        document.form = "ABNF"
        read_abnf(Inner(node), document, library.problems, where, lenient=False)
    else:
        read_xml(node, document, library.problems, inline=True)
        document.base = ""  # the URI includes it already
        _root(document)
    check_form(library.problems, media, document.form, "", partial(node.attribute_place, "type"))
    library.add(document)
    return document, rule


def _root(document: GrammarDocument) -> None:
    """The root of an element without one: its only rule, or its only public one."""
    if not document.root:
        public = document.public()
        names = public if len(public) == 1 else list(document.rules)
        document.root = names[0] if len(names) == 1 else ""


def _external(
    library: Library, node: Node, base: str, media: str, rule: str
) -> tuple[GrammarDocument, str]:
    where = partial(node.attribute_place, "src")
    uri, fragment = parted(joined(base, node.get("src").strip(), where))
    check_known(media, where(), "")
    document = library.fetch(uri, media, where, partial(value_span, node, "src"))
    library.problems.check()
    assert document is not None
    name = rule or fragment
    if name and name in document.rules:
        if not document.rules[name].public:
            message = f'The rule "{name}" is private to its grammar.'
            raise GrammarError.of(where(), "private-rule", message)
    elif name:
        message = f'The grammar "{uri}" has no rule "{name}".'
        hint = other_rule(name, document.public(), *value_span(node, "src", name))
        raise GrammarError.of(where(), "no-such-rule", message, hint)
    elif not document.root:
        message = f'The grammar "{uri}" names no root rule.'
        raise GrammarError.of(where(), "no-root", message, "Name a rule: #name.")
    return document, name


# Files


def _bytes(text: str) -> bytes:
    """A whole file's text as bytes; its declared encoding is irrelevant."""
    if text.startswith("#ABNF"):
        from prima.grammar.abnfheader import as_unicode

        return as_unicode(text)
    if "encoding" in text[:200]:
        text = _DECLARED.sub(lambda one: one[1] + blank(one[0][len(one[1]) :]), text, count=1)
    return text.encode(errors="surrogatepass")


def _document(
    lang: str, lenient: bool, library: Library, uri: str, data: bytes, type: str
) -> GrammarDocument:
    """The bytes of a whole file as a document, in the language that it declares."""
    media = media_type(type)
    uri, file = urldefrag(uri)[0], uri or "grammar"
    if len(data) > LIMITS.bytes:
        raise GrammarError(too_large(file, len(data)).problems)
    begin = _beginning(data)
    check_known(media, Place(file), begin)
    document = GrammarDocument(uri, partial(Place, file), lang=lang if lenient else "")
    if begin.startswith("#ABNF") or (media in ABNF_TYPES and not begin.startswith("<")):
        from prima.grammar.abnf import read_abnf
        from prima.grammar.abnfheader import decode_abnf

        source = Source(file, decode_abnf(file, data))
        document.form = "ABNF"
        read_abnf(source, document, library.problems, document.where, lenient)
        return document
    check_no_text(file, begin)
    try:
        node = parse(file, data)
    except DocumentError as error:
        raise GrammarError(error.problems) from None
    document.where = partial(node.attribute_place, "")
    read_xml(node, document, library.problems, inline=False, lenient=lenient)
    return document


def _beginning(data: bytes) -> str:
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data[:200].decode("utf-16", errors="replace").lstrip()
    if data[:2] in (b"#\0", b"\0#"):
        return data[:200].replace(b"\0", b"").decode("latin-1")
    return data[:200].decode("utf-8-sig", errors="replace").lstrip()
