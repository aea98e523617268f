"""Hardened reading: bytes in, a tree of nodes or a list of problems out.

This is the only module that knows lxml, which explains what is wrong. What a stranger's file may do is
bounded before it is parsed: its size, its encoding, and its DOCTYPE, which may
name an external identifier (never fetched) and nothing else.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING
from xml.parsers import expat

from prima.errors import (
    DocumentError,
    Edit,
    Fix,
    Hint,
    Place,
    Problem,
    Span,
    nearest_word,
    replaced,
)
from prima.markup.build import (
    MAX_NAME,
    TooMuch,
    Unclear,
    build,
)
from prima.markup.check import check_root, check_tree
from prima.markup.limits import LIMITS
from prima.markup.tree import Node, Source
from prima.markup.vocabulary import Vocabulary

if TYPE_CHECKING:
    from lxml import etree

ENCODINGS = frozenset(
    ["utf-8", "ascii", "utf-16", "utf-16-le", "utf-16-be", "koi8-r", "koi8-u"]
    + [f"iso8859-{number}" for number in range(1, 17) if number != 12]
    + [f"cp{number}" for number in range(1250, 1259)]
    + ["shift_jis", "cp932", "euc_jp", "iso2022_jp", "gb2312", "gbk", "gb18030", "big5", "euc_kr"]
)
"""Encodings that are read, by the names that :func:`codecs.lookup` gives them."""
REMEDIES = (
    (r"Opening and ending tag mismatch: (\S+) line (\d+) and (\S+)",
     "The <{0}> of line {1} is still open here: write </{0}>, or end its own tag with />."),
    (r"Namespace prefix (\S+) ", 'Write the name without "{0}:", or declare it: xmlns:{0}="...".'),
    (r"Char 0x0|PCDATA invalid Char value 0|Invalid character",
     "Remove the character; an editor may not show it. Save the file as UTF-8."),
    (r"invalid Char value|xmlParseCharRef", "Remove the control character."),
    (r"Premature end of data in tag (\S+) line (\d+)",
     "The <{0}> of line {1} is never closed: write </{0}>."),
    (r"Start tag expected", "Begin with a root element, such as <prima> or <vxml>."),
    (r"Attribute (\S+) redefined", "Keep one of them."),
    (r"Unescaped '<' not allowed in attributes", "Write &lt; for <, or close the quote before."),
    (r"EntityRef|xmlParseEntityRef", "Write &amp; for &."),
    (r"attributes construct error", "Put a space between attributes, and quote their values."),
    (r"AttValue", 'Write the value in quotes: name="value".'),
    (r"Extra content at the end", "A document has one root element; nothing may stand after it."),
    (r"StartTag: invalid element name", "Write &lt; for a < that begins no tag."),
    (r"XML declaration allowed only", "Move it to the very beginning of the file."),
    (r"Specification mandates value", 'Write the value in quotes: name="value".'),
    (r"error parsing attribute name", "Close the tag with >, or remove what is no attribute."),
    (r"Sequence '\]\]>'", "Write ]]&gt;."),
    (r"[Cc]omment", "A comment ends with --> and holds no --."),
    (r"CData", "It ends with ]]>."),
)  # fmt: skip
"""The parser's words, and what the author may do."""
ENCODING = re.compile(rb"""<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._\-]+)["']""")
BOMS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (b"<\0?\0", "utf-16-le"),
    (b"\0<\0?", "utf-16-be"),
)
"""How files of some encodings begin (XML 1.0, appendix F)."""
LATE_DECLARATION = re.compile(rb"(?:\xef\xbb\xbf)?\s+<\?xml\s")
TEMPLATE = re.compile(r"<%|<\?php|<\?=")


def _error(place: Place, code: str, message: str, remedy: str | Hint = "") -> DocumentError:
    return DocumentError([Problem(place, "error", code, message, remedy)])


def decode(file: str, data: bytes) -> str:
    """Give a document's text, whatever listed encoding it is in.

    Raises:
        DocumentError: too large, in an unlisted encoding, or not in the one declared.
    """
    start = Place(file)
    if len(data) > LIMITS.bytes:
        raise too_large(file, len(data))
    encoding = next((name for bom, name in BOMS if data.startswith(bom)), "")
    declared = ENCODING.match(data)
    if not encoding:
        encoding = declared[1].decode().lower() if declared else "utf-8"
        if declared and _codec(encoding).startswith("utf-16"):
            message = f'The file says encoding="{encoding}", but it is not in UTF-16.'
            place = Place(file, 1, declared.start(1) + 1)
            raise _error(place, "encoding", message, "Declare the encoding it has.")
    if data.startswith((codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE)):
        encoding = "utf-32"
    if _codec(encoding) not in ENCODINGS:
        named = declared is not None and encoding == declared[1].decode().lower()
        place = Place(file, 1, declared.start(1) + 1) if declared and named else start
        raise _error(
            place, "encoding", f'The encoding "{encoding}" is not accepted.', "Save it as UTF-8."
        )
    try:
        marked = encoding == "utf-8" and data.startswith(codecs.BOM_UTF8)
        text = data.decode("utf-8-sig" if marked else encoding)
    except UnicodeDecodeError as error:
        if LATE_DECLARATION.match(
            data
        ):  # its encoding counts for nothing there: told by the parser
            return data.decode("iso-8859-1")
        raise _error(
            byte_place(file, encoding, error),
            "encoding",
            f"A byte here is not {encoding.upper()}.",
            "Save it as UTF-8, or declare the encoding it has.",
        ) from None
    return with_line_feeds(text)


def with_line_feeds(text: str) -> str:
    """Text whose lines end as XML has it, whatever they end with in the file (XML 1.0, 2.11)."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def byte_place(file: str, encoding: str, error: UnicodeDecodeError) -> Place:
    """Where the byte stands that is not in a file's encoding; columns count characters."""
    before = with_line_feeds(error.object[: error.start].decode(encoding, errors="ignore"))
    return Place(file, before.count("\n") + 1, len(before) - before.rfind("\n"))


def _codec(encoding: str) -> str:
    """The name by which an encoding is known here; nothing for one that is not."""
    try:
        return codecs.lookup(encoding).name
    except LookupError:
        return ""


def too_large(file: str, size: int) -> DocumentError:
    """The error for a file over the limit, known before it is read."""
    return _error(
        Place(file),
        "too-large",
        f"The file has {size:,} bytes; at most {LIMITS.bytes:,} are read.",
        f"Divide it, or raise the limit: --limit bytes={size}.",
    )


class _Seen(Exception):
    """The root element has been reached."""


def _check_prolog(source: Source) -> None:
    """Refuse a DOCTYPE that declares anything itself, before anything is expanded."""
    parser = expat.ParserCreate(encoding="utf-8")

    def doctype(_name: str, _system: str | None, _public: str | None, internal: bool) -> None:
        if internal:
            raise _error(
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
        return  # what is not well-formed is told better below


def parse(file: str, data: bytes, vocabularies: Sequence[Vocabulary] = ()) -> Node:
    """Parse bytes into nodes.

    Args:
        file: the name by which places are told.
        data: the bytes.
        vocabularies: whose elements may be meant, to tell a slip in an opening tag.

    Raises:
        DocumentError: not well-formed, or beyond a limit.
    """
    text = decode(file, data)
    end = text.find(">") + 1
    if text.startswith("<?xml") and text[:end].endswith("?>"):
        text = " " * end + text[end:]  # the text is what it is, whatever it declares
    source = Source(file, text)
    try:
        try:
            return build(source)
        except Unclear:
            _explain(source, vocabularies)
            return build(source, doctype=True)
    except TooMuch as much:
        raise _beyond(much) from None
    except Unclear as unclear:  # names of the fifth edition of XML 1.0
        message = "This is not well-formed XML: a name has a character that no name may have."
        place = Place(file, unclear.line, unclear.column)
        raise _error(place, "not-xml", message, "Take another name.") from None


def _explain(source: Source, vocabularies: Sequence[Vocabulary]) -> None:
    """Tell what is wrong with a document, by the parser that has the better words.

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
        raise _misspelt(source, error, vocabularies) or _syntax_error(source, error) from None
    dtd = root.getroottree().docinfo.internalDTD
    if dtd is not None and (dtd.entities() or dtd.elements()):  # type: ignore[union-attr]
        raise _error(Place(source.file), "doctype", "A DOCTYPE may not declare anything itself.")


def _beyond(much: TooMuch) -> DocumentError:
    place, tag = much.node.place, much.node.tag
    if much.what == "depth":
        return _too_deep(place)
    if much.what == "name":
        message = f"A name has more than {MAX_NAME:,} characters."
        return _error(place, "too-large", message, "Take a shorter one.")
    if much.what == "attributes":
        message = f"<{tag}> has more than {LIMITS.attributes} attributes."
        return _error(place, "too-large", message, "Remove some.")
    message = f"The document has more than {LIMITS.elements:,} elements."
    remedy = f"Divide it, or raise the limit: --limit elements={10 * LIMITS.elements}."
    return _error(place, "too-large", message, remedy)


MISMATCH = r"tag mismatch: (\S+) line (\d+) and (\S+)"
"""The parser's words for a closing tag that does not fit: the opening one, its line, the closing."""


def _misspelt(
    source: Source, error: etree.XMLSyntaxError, vocabularies: Sequence[Vocabulary]
) -> DocumentError | None:
    """The error for an opening tag that no language has, where its closing tag is right."""
    match = re.search(MISMATCH, (error.msg or "").split(", line ")[0])
    if match is None:
        return None
    opened, closed = match[1], match[3]
    tags = {tag for one in vocabularies for tag in one.tags}
    if opened in tags or closed not in tags or not nearest_word(opened, [closed]):
        return None
    lines = source.text.split("\n")
    line = int(match[2])
    column = lines[line - 1].rfind(f"<{opened}") + 1 if line <= len(lines) else 1
    place = Place(source.file, line, max(column, 1))
    name = Span.of(place._replace(column=place.column + 1), opened)
    remedy = replaced(f'Did you mean "{closed}"? The closing tag is right.', closed, name)
    return _error(place, "unknown-element", f"There is no <{opened}>.", remedy)


def _syntax_error(source: Source, error: etree.XMLSyntaxError) -> DocumentError:
    line, column = (error.position or (1, 1)) if source.text.strip() else (1, 1)
    place = Place(source.file, max(line or 1, 1), max(column or 1, 1))
    message = " ".join((error.msg or "Not XML").split(", line ")[0].split())
    if not source.text.strip():
        return _error(place, "not-xml", "The file is empty.", "Begin with a root element.")
    if source.text.lstrip().startswith("{"):
        remedy = "If it is a transcript, prima show prints it."
        return _error(place, "not-xml", "This is JSON, not XML.", remedy)
    if source.text.lstrip().startswith(("#ABNF", "#JSGF", "#GSL", ";GSL")):
        remedy = "Name it in a VoiceXML document (<grammar src>); prima validate checks it."
        return _error(place, "not-xml", "This is a grammar, not XML.", remedy)
    if "depth" in message.lower():
        return _too_deep(place)
    if "Entity" in message:  # told where it ends
        before = source.text.split("\n")[place.line - 1][: place.column]
        place = place._replace(column=max(before.rfind("&") + 1, 1))
    if message.startswith("Entity '"):
        name = message.split("'")[1]
        return _error(
            place,
            "entity",
            f"The entity &{name}; is not known: documents declare none.",
            "Write the character itself; only &amp; &lt; &gt; &quot; &apos; are needed.",
        )
    first = _remedy(message)
    unclosed = re.search(UNCLOSED, message)
    place, message, remedy = _clearer(source, place, message, first)
    if TEMPLATE.search(source.text):
        remedy = "A server makes the document from this: run what it makes."
    message = f"This is not well-formed XML: {message.rstrip('.')}."
    fixes = _closed(source, place, unclosed[1]) if unclosed and remedy == first else ()
    return _error(place, "not-xml", message, Hint(remedy, fixes))


UNCLOSED = r"(?:tag mismatch:|Premature end of data in tag) ([^\s<>]+) line"
"""The parser's words for an element that is not closed."""


def _closed(source: Source, place: Place, name: str) -> tuple[Fix, ...]:
    """An end tag before the one that ends something else, or at the end of the text."""
    line = source.text.split("\n")[place.line - 1]
    at = len(source.text.rstrip())
    here = line.startswith("</", place.column - 1)
    span = Span.of(place, "") if here else source.span(at, at)
    return (Fix(f"Write </{name}>", (Edit(span, f"</{name}>"),)),)


WIDE = {
    **dict.fromkeys("“”„″＂「」『』", 'A typographic quote stands here: write ".'),
    **dict.fromkeys("‘’‚＇", "A typographic quote stands here: write '."),
    **dict.fromkeys(
        "\u3000\u00a0\u2003\u202f", "A space of another kind stands here: type an ordinary one."
    ),
    "＝": "An equals sign of full width stands here: write =.",
    "／": "A slash of full width stands here: write /.",
    "＞": "A bracket of full width stands here: write >.",
}
"""Characters that editors put in place of those of XML, and what to write."""
WORDS = (
    (r"xmlParseEntityRef: no name", "an & stands alone"),
    (r"EntityRef: expecting ';'", "an & begins no character's name, or lacks its ;"),
    (r"AttValue: \" or ' expected", "an attribute's value has no quotes"),
    (r"Specification mandates value for attribute (\S+)", 'the attribute "{0}" has no value'),
    (r"attributes construct error", "an attribute is written wrongly"),
    (r"error parsing attribute name", "what stands here is no attribute"),
    (r"Opening and ending tag mismatch: (\S+) line (\d+) and (\S+)", "</{2}> does not end <{0}>"),
    (r"Premature end of data in tag (\S+) line (\d+)", "the file ends inside <{0}>"),
    (r"StartTag: invalid element name", "a < begins no tag"),
    (r"Unescaped '<' not allowed in attributes values", "a < stands in an attribute's value"),
    (r"Namespace prefix (\S+) on (\S+) is not defined", 'the prefix "{0}" is not declared'),
)
"""The parser's words, and plainer ones."""
OPEN_QUOTE = re.compile(r"""=\s*(["'])[^"'<]*\Z""")


def _clearer(source: Source, place: Place, message: str, remedy: str) -> tuple[Place, str, str]:
    """The parser's place, message and remedy, nearer to the mistake and in plainer words."""
    lines = source.text.split("\n")
    line = lines[place.line - 1] if place.line <= len(lines) else ""
    if match := re.search(MISMATCH, message):
        start = line.rfind("</", 0, place.column)
        place = place._replace(column=start + 1) if start >= 0 else place
        if match[1].startswith("／"):
            opened = int(match[2])
            column = lines[opened - 1].find("／") + 1 if opened <= len(lines) else 1
            place, remedy = Place(source.file, opened, max(column, 1)), WIDE["／"]
    elif match := re.search(r"Namespace prefix (\S+) on", message):
        start = line.rfind(f"<{match[1]}:", 0, place.column)
        place = place._replace(column=start + 1) if start >= 0 else place
    elif "'<' not allowed in attributes" in message:
        before = "\n".join([*lines[: place.line - 1], line[: place.column - 1]])
        quote = OPEN_QUOTE.search(before[-10_000:])
        if quote and "\n" in quote[0]:
            at = source.at(len(before) - len(quote[0]) + quote[0].index(quote[1]))
            return at, "a quote that is opened here is not closed", "Write the other quote."
    wrong = WIDE.get(line[place.column - 1 : place.column])
    for words, plain in WORDS:
        if match := re.search(words, message):
            message = plain.format(*match.groups())
    return place, message, wrong or remedy


def _remedy(message: str) -> str:
    """What to do about a mistake that the parser names."""
    for words, remedy in REMEDIES:
        if match := re.search(words, message):
            return remedy.format(*match.groups())
    return ""


def _too_deep(place: Place) -> DocumentError:
    return _error(
        place,
        "too-deep",
        f"Elements are nested more than {LIMITS.depth} deep.",
        "Divide the document into smaller parts.",
    )


def read_tree(file: str, data: bytes, *vocabularies: Vocabulary) -> tuple[Node, list[Problem]]:
    """Read a document of one of the vocabularies; the problems are those of its schema.

    Raises:
        DocumentError: no tree can be given: not XML, or not such a document at all.
    """
    root = parse(file, data, vocabularies)
    problems: list[Problem] = []
    check_tree(root, check_root(root, vocabularies), problems)
    return root, problems
