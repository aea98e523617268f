"""Tags of the time before SISR 1.0, and tags without a declared format.

SRGS leaves the content of a tag open if no tag format is declared. Documents of the VoiceXML 2.0
era write slots (``city='Boston'``), the rule variable as ``$`` (``$.city = $$``), or a value by
itself; each is recognised by its form and rewritten as a script of SISR 1.0.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from functools import lru_cache

from prima.grammar.model import GrammarDocument
from prima.script.names import script_names
from prima.script.parse import Code, Node, inner, parse_expression, parse_script, spliced

FORMATS = {
    "": "",
    "semantics/1.0": "script",
    "semantics/1.0.2006": "script",
    "semantics/1.0-literals": "literals",
    "semantics-ms/1.0": "legacy",
    "swi-semantics/1.0": "legacy",
    "lumenvox/1.0": "legacy",
}
"""Tag formats and how their tags are read; without a format, the tags decide."""

_STRING = r"""(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')"""
_OWN = frozenset(["out", "rules", "meta"])
"""Names of SISR as identifiers; those of properties are ignored."""
_NAMES = ("identifier", "shorthand_property_identifier")
_GIVES = ("assignment_expression", "augmented_assignment_expression", "variable_declarator")
MOST_PARENTS = 15
"""How many objects a slot may be in; each is made by a script as long as its name."""
_SLOT = re.compile(
    rf"(?s)\s*([A-Za-z_]\w*(?:\.[A-Za-z_]\w*){{0,{MOST_PARENTS}}})\s*=(?!=)\s*(.+?)\s*"
)
_GSL = re.compile(r"<\s*+([A-Za-z_]\w*+)\s++([^<>]++)>")
_ALL_GSL = re.compile(rf"(?:\s*+{_GSL.pattern})+\s*+")
_PIECE = re.compile(rf"{_STRING}|(?P<open>[\[{{(])|(?P<close>[\]}})])|(?P<end>;)|[^\s]|\s+")
_WORDS = re.compile(r"[^\W\d][\w' -]*")
_CONSTANTS = {"true", "false", "null", "undefined"}


def settle(document: GrammarDocument) -> None:
    """Decide how a document's tags are read; the format is a known one."""
    dialect = FORMATS[document.tag_format]
    codes = [tag.code for tag in document.tags]
    if dialect == "script":
        if _drafted(codes, [tag.code for tag in document.globals]):
            dialect = "legacy"  # as the drafts of SISR had it under the same name
    elif not dialect:
        dialect = _guess(document, codes)
    document.dialect = dialect
    document.merges = dialect == "legacy" and any(_slots(code) for code in codes)


def _drafted(codes: list[str], globals: list[str]) -> bool:
    """Whether tags are in the style of the drafts: with ``$`` and without any name of SISR 1.0."""
    everything = [*codes, *globals]
    if not any("$" in code for code in codes) or _used(everything) & _OWN:
        return False
    declared = {name for code in everything for name in script_names(code).declared}
    return not {name for name in _used(codes) if name.startswith("$")} <= declared


def _used(codes: Iterable[str]) -> set[str]:
    """Names that are read or assigned."""
    names = [script_names(code) for code in codes]
    return {name for one in names for name in (*one.read, *one.written)}


def _guess(document: GrammarDocument, codes: list[str]) -> str:
    if any(_uses_sisr(code) for code in codes):
        return "script"
    bare = all(not _signs(one) and not _slots(one) and not _value(one) for one in codes)
    return "literals" if bare and not document.globals else "legacy"


def _uses_sisr(code: str) -> bool:
    """Whether code reads or assigns a variable of SISR 1.0; mere words do not count."""
    if not any(name in code for name in _OWN):
        return False
    parsed = parse_script(code)
    return parsed is not None and any(
        _is_sisr(parsed, node, parent) for node, parent in parsed.walk_inside()
    )


def _is_sisr(code: Code, node: Node, parent: Node | None) -> bool:
    if node.type != "identifier" or parent is None or parent.children[0] != node:
        return False
    around = parent.type
    if around in ("member_expression", "subscript_expression"):
        return code.of(node) in _OWN
    return code.of(node) == "out" and (around in _GIVES or around == "binary_expression")


def _signs(code: str) -> list[tuple[int, int, str]]:
    """The drafts' variables in code: offsets and names."""
    parsed = parse_script(code) if "$" in code else None
    found = []
    for node in parsed.walk() if parsed is not None else ():
        if parsed is not None and node.type in _NAMES and parsed.of(node).startswith("$"):
            found.append((parsed.start(node), parsed.end(node), parsed.of(node)))
    return found


def _value(code: str) -> bool:
    """Whether a tag is a text, an array or an object."""
    code = code.strip()
    if code[:1] + code[-1:] in ("{}", "[]"):
        return True
    parsed = parse_expression(code)
    value = inner(parsed) if parsed is not None else None
    return value is not None and value.type == "string"


@lru_cache(maxsize=4096)
def translate(code: str) -> str:
    """A tag as a script of SISR 1.0."""
    if _uses_sisr(code):
        return code
    if _signs(code):
        return _from_dollars(code)
    slots = _slots(code)
    if slots:
        return " ".join(_assign(name, value) for name, value in slots)
    if _value(code):
        return f"out = ({code.strip()}\n);"
    return f"out = {json.dumps(code.strip())};" if code.strip() else ""


def _from_dollars(code: str) -> str:
    """Translate ``$`` (the rule's variable), ``$$`` (the last rule's value) and ``$name``."""
    known = {"$": "out", "$$": "rules.latest()"}
    signs = ((a, z, known.get(name, f"rules.{name[1:]}")) for a, z, name in _signs(code))
    script = spliced(code, signs)
    parsed = parse_script(code)
    if parsed is not None and any(node.type in _GIVES for node in parsed.walk()):
        return script
    return f"out = ({script}\n);"


def _slots(code: str) -> list[tuple[str, str]]:
    """The slots that a tag fills, with their values; none if it is not a list of assignments."""
    if _ALL_GSL.fullmatch(code):
        return [(match[1], match[2].strip()) for match in _GSL.finditer(code)]
    if "=" not in code:
        return []
    found: list[tuple[str, str]] = []
    for piece in _pieces(code):
        match = _SLOT.fullmatch(piece)
        if match is None:
            return []
        found.append((match[1], match[2]))
    return found


def _pieces(code: str) -> list[str]:
    """A tag split at semicolons outside of strings and brackets."""
    pieces, depth = [""], 0
    for match in _PIECE.finditer(code):
        depth += bool(match["open"]) - bool(match["close"])
        if match["end"] and depth <= 0:
            pieces.append("")
        else:
            pieces[-1] += match[0]
    return [piece for piece in pieces if piece.strip()]


def _assign(name: str, value: str) -> str:
    """An assignment to a slot; bare words are a text."""
    parents = name.split(".")[:-1]
    made = [".".join(parents[:end]) for end in range(1, len(parents) + 1)]
    before = "".join(f"out.{one} = out.{one} || {{}}; " for one in made)
    bare = _WORDS.fullmatch(value) and value not in _CONSTANTS
    shown = json.dumps(value) if bare else f"({value}\n)"
    return f"{before}out.{name} = {shown};"
