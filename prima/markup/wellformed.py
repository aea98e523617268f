"""Explains why a text is not well-formed XML, in plain words and at the place of the mistake.

Only this module uses lxml, for its parser's messages.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING
from xml.parsers import expat

from prima.errors import DocumentError, Fix, Hint, Place, nearest_word, replaced
from prima.markup import endtags
from prima.markup.endtags import MISMATCH, UNCLOSED, line_of, offset_of
from prima.markup.tree import Source
from prima.markup.vocabulary import Vocabulary

if TYPE_CHECKING:
    from lxml import etree

OTHER_FORMS = (
    (("{",), "This is JSON, not XML.", "If it is a transcript, prima show prints it."),
    (
        ("#ABNF", "#JSGF", "#GSL", ";GSL"),
        "This is a grammar, not XML.",
        "Name it in a VoiceXML document (<grammar src>); prima validate checks it.",
    ),
)
"""Beginnings of texts in other formats, with descriptions and remedies."""
REMEDIES = (
    (r"Namespace prefix p ", 'Write the name without "p:", or declare it: xmlns:p="...". '
     'PRIMA\'s Commands in VoiceXML need xmlns:p="urn:prima:dialogue:1".'),
    (r"Namespace prefix (\S+) ", 'Write the name without "{0}:", or declare it: xmlns:{0}="...".'),
    (r"Char 0x0|Document is empty|PCDATA invalid Char value 0|Invalid character",
     "Remove the character; an editor may not show it. Save the file as UTF-8."),
    (r"invalid Char value|xmlParseCharRef", "Remove the control character."),
    (r"Start tag expected", "Begin with a root element, such as <prima> or <vxml>."),
    (r"Attribute (\S+) redefined", "Keep one of them."),
    (r"Unescaped '<' not allowed in attributes", "Write &lt; for <, or close the quote before."),
    (r"EntityRef|xmlParseEntityRef", "Write &amp; for &."),
    (r"attributes construct error", "Put a space between attributes, and quote their values."),
    (r"AttValue", 'Write the value in quotes: name="value".'),
    (r"Extra content at the end", "A document has one root element, and nothing after it."),
    (r"StartTag: invalid element name", "Write &lt; for a < that begins no tag."),
    (r"XML declaration allowed only", "Move it to the very beginning of the file."),
    (r"Specification mandates value", 'Write the value in quotes: name="value".'),
    (r"error parsing attribute name", "Close the tag with >, or remove what is not an attribute."),
    (r"Sequence '\]\]>'", "Write ]]&gt;."),
    (r"[Cc]omment", "A comment ends with --> and holds no --."),
    (r"CData", "It ends with ]]>."),
    (r"ParsePI", "Write &lt; for a < that begins no tag, or remove the <? and what follows it."),
    (r"parse QName", "Remove the colon: here a name has none, or something before and behind it."),
    (r"XML declaration|declaration expecting|Blank needed|Invalid PI name",
     'Write the first line as <?xml version="1.0" encoding="UTF-8"?>.'),
    (r"\Aexpected '>'", "A closing tag holds its name alone: </name>."),
)  # fmt: skip
"""The parser's messages, with remedies."""
PLAINER = (
    (r"Document is empty", "it begins with the character NUL"),
    (r"xmlParseEntityRef: no name", "an & is not escaped"),
    (r"EntityRef: expecting ';'", "an & begins no character's name, or lacks its ;"),
    (r"AttValue: \" or ' expected", "an attribute's value has no quotes"),
    (r"Specification mandates value for attribute (\S+)", 'the attribute "{0}" has no value'),
    (r"attributes construct error", "an attribute is written wrongly"),
    (r"error parsing attribute name", "the name of an attribute is expected here"),
    (MISMATCH, "</{2}> does not end <{0}>"),
    (UNCLOSED, "the file ends inside <{0}>"),
    (r"StartTag: invalid element name", "a < begins no tag"),
    (r"Unescaped '<' not allowed in attributes values", "a < is in an attribute's value"),
    (r"Namespace prefix (\S+) on (\S+) is not defined", 'the prefix "{0}" is not declared'),
)
"""The parser's messages, and plainer ones."""
BEGINNINGS = ((MISMATCH, "</"), (r"Namespace prefix (\S+) on", "<{0}:"), ("Entity", "&"))
"""The parser's messages that give the end of a mistake, and its beginning on the same line."""
WIDE = {
    **dict.fromkeys("“”„″＂「」『』", 'This is a typographic quote: write ".'),
    **dict.fromkeys("‘’‚＇", "This is a typographic quote: write '."),
    **dict.fromkeys(
        "\u3000\u00a0\u2003\u202f", "This is a space of another kind: type an ordinary one."
    ),
    "＝": "This equals sign has full width: write =.",
    "／": "This slash has full width: write /.",
    "＞": "This bracket has full width: write >.",
}
"""Characters that editors substitute for those of XML, with the right ones."""
SPACED_TAG = re.compile(r"""\s+(/?)([\w-]+)(?:\s+[\w:-]+\s*=\s*["']|\s*/?>)""")
"""The beginning of a tag with a space behind its <."""
OPEN_QUOTE = re.compile(r"""=\s*(["'])[^"'<]*\Z""")
TEMPLATE = re.compile(r"<%|<\?php|<\?=")


class _Seen(Exception):
    """The root element has been reached."""


def explain(source: Source, vocabularies: Sequence[Vocabulary]) -> None:
    """Check that a text is well-formed XML.

    ``vocabularies`` are languages to which a misspelt opening tag may belong.

    Raises:
        DocumentError: it is not well-formed, or its DOCTYPE declares something.
    """
    from lxml import etree  # most documents have nothing that needs explaining

    _check_prolog(source)
    parser = etree.XMLParser(
        resolve_entities="internal",  # type: ignore[arg-type]  # the stubs know True and False
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
        encoding="utf-8",
    )
    try:
        root = etree.fromstring(source.text.encode(), parser)
    except etree.XMLSyntaxError as error:
        misspelt = _misspelt(source, error, vocabularies)
        raise misspelt or _syntax_error(source, error, vocabularies) from None
    dtd = root.getroottree().docinfo.internalDTD
    if dtd is not None and (dtd.entities() or dtd.elements()):  # type: ignore[union-attr]
        raise DocumentError.of(
            Place(source.file), "doctype", "A DOCTYPE may not declare anything itself."
        )


def _check_prolog(source: Source) -> None:
    """Refuse a DOCTYPE that declares anything itself, before anything is expanded."""
    parser = expat.ParserCreate(encoding="utf-8")

    def doctype(_name: str, _system: str | None, _public: str | None, internal: bool) -> None:
        if internal:
            raise DocumentError.of(
                Place(source.file, parser.CurrentLineNumber),
                "doctype",
                "A DOCTYPE may not declare anything itself.",
                "Remove the part in square brackets; entities are not needed in UTF-8.",
            )

    def start(_tag: str, _attributes: dict[str, str]) -> None:
        raise _Seen

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    try:
        parser.Parse(source.text.encode(), True)
    except (_Seen, expat.ExpatError):
        return  # lxml has better messages


def _misspelt(
    source: Source, error: etree.XMLSyntaxError, vocabularies: Sequence[Vocabulary]
) -> DocumentError | None:
    """The error for an unknown opening tag whose closing tag is right."""
    match = re.search(MISMATCH, _said(error))
    if match is None:
        return None
    opened, closed = match[1], match[3]
    tags = {tag for one in vocabularies for tag in one.tags}
    if opened in tags or closed not in tags or not nearest_word(opened, [closed]):
        return None
    start, name = endtags.innermost(source)
    place, local = source.at(start), start + 1 + len(name) - len(opened)
    if name.rpartition(":")[2] != opened:
        return None  # the parsers disagree
    span = source.span(local, local + len(opened))
    remedy = replaced(f'Did you mean "{closed}"? The closing tag is right.', closed, span)
    return DocumentError.of(place, "unknown-element", f"There is no <{opened}>.", remedy)


def _said(error: etree.XMLSyntaxError) -> str:
    """The parser's message without the place."""
    return " ".join((error.msg or "Not XML").split(", line ")[0].split())


def _syntax_error(
    source: Source, error: etree.XMLSyntaxError, vocabularies: Sequence[Vocabulary]
) -> DocumentError:
    text = source.text.strip()
    if not text:
        place = Place(source.file)
        return DocumentError.of(
            place, "not-xml", "The file is empty.", "Begin with a root element."
        )
    line, column = error.position or (1, 1)
    place = Place(source.file, max(line or 1, 1), max(column or 1, 1))
    if source.file.endswith(".toml"):
        remedy = "If it is a study, prima sweep runs it; with --plan it only checks it."
        return DocumentError.of(place, "not-xml", "This is TOML, not XML.", remedy)
    for beginnings, what, remedy in OTHER_FORMS:
        if text.startswith(beginnings):
            return DocumentError.of(place, "not-xml", what, remedy)
    message = _said(error)
    if message.startswith("Entity '"):
        name = message.split("'")[1]
        sentence = f"The entity &{name}; is not known: documents declare none."
        remedy = "Write the character itself; only &amp; &lt; &gt; &quot; &apos; are needed."
        return DocumentError.of(_beginning(source, place, message), "entity", sentence, remedy)
    return _not_well_formed(source, place, message, vocabularies)


def _not_well_formed(
    source: Source, place: Place, message: str, vocabularies: Sequence[Vocabulary]
) -> DocumentError:
    """The error for a mistake reported by the parser, with a closer place and plainer words."""
    sentence, remedy = _translated(PLAINER, message) or message, _translated(REMEDIES, message)
    fixes: tuple[Fix, ...] = ()
    quote = _open_quote(source, place) if "'<' not allowed in attributes" in message else None
    if quote:
        place = quote
        sentence, remedy = "a quote that is opened here is not closed", "Write the other quote."
    else:
        place = _beginning(source, place, message)
        wide = WIDE.get(line_of(source, place.line)[place.column - 1 : place.column])
        if wide:
            remedy = wide
        elif hint := endtags.remedy(source, place, message, vocabularies):
            remedy, fixes = hint
        elif spaced := _spaced_tag(source, place, message, vocabularies):
            remedy = spaced
        elif "XML declaration" in message and "</" in source.text[: offset_of(source, place)]:
            remedy = "A second document begins here: keep one of them."
    if TEMPLATE.search(source.text):
        remedy, fixes = "A server makes the document from this: run what it makes.", ()
    sentence = f"This is not well-formed XML: {sentence.rstrip('.')}."
    return DocumentError.of(place, "not-xml", sentence, Hint(remedy, fixes))


def _spaced_tag(
    source: Source, place: Place, message: str, vocabularies: Sequence[Vocabulary]
) -> str:
    """The remedy for a tag with a space behind its <; nothing for a < that begins no tag."""
    found = SPACED_TAG.match(source.text, offset_of(source, place))
    if "invalid element name" not in message or found is None:
        return ""
    known = any(found[2] in one.tags for one in vocabularies)
    return f"Write <{found[1]}{found[2]} without the space." if known else ""


def _translated(table: Iterable[tuple[str, str]], message: str) -> str:
    """The entry of a table for the parser's message."""
    for words, text in table:
        if match := re.search(words, message):
            return text.format(*match.groups())
    return ""


def _open_quote(source: Source, place: Place) -> Place | None:
    """A quote opened on an earlier line and not closed there."""
    before = source.text[: offset_of(source, place)]
    quote = OPEN_QUOTE.search(before[-10_000:])
    if quote is None or "\n" not in quote[0]:
        return None
    return source.at(len(before) - len(quote[0]) + quote[0].index(quote[1]))


def _beginning(source: Source, place: Place, message: str) -> Place:
    """The beginning of a mistake whose end the parser reported."""
    unclosed = re.search(MISMATCH, message)
    if unclosed and unclosed[1].startswith("／"):
        line = int(unclosed[2])
        return Place(source.file, line, max(line_of(source, line).find("／") + 1, 1))
    for words, beginning in BEGINNINGS:
        if match := re.search(words, message):
            sought = beginning.format(*match.groups())
            start = line_of(source, place.line).rfind(sought, 0, place.column)
            return place._replace(column=start + 1) if start >= 0 else place
    return place
