"""Tags of the time before SISR 1.0, and tags whose format is not told.

SRGS leaves open what a tag holds where no tag format is declared. Documents of the VoiceXML 2.0
era write slots (``city='Boston'``), the rule variable as ``$`` (``$.city = $$``), or a value by
itself; each is told by its looks and put as a script of SISR 1.0.
"""

from __future__ import annotations

import json
import re
from functools import lru_cache

from prima.grammar.model import Document
from prima.names import PASSED

FORMATS = {
    "": "",
    "semantics/1.0": "script",
    "semantics/1.0.2006": "script",
    "semantics/1.0-literals": "literals",
    "semantics-ms/1.0": "legacy",
    "swi-semantics/1.0": "legacy",
    "lumenvox/1.0": "legacy",
}
"""Tag formats and how their tags are read; where none is told, the tags decide."""

_STRING = r"""(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')"""
_SKIPPED = re.compile(PASSED, re.VERBOSE | re.DOTALL)
_SIGN = r"(?:(?<![\w$.])|(?<=\.\.\.))\$(?:\$|(?P<rule>[^\W\d]\w*))?(?![\w$])"
_DOLLAR = re.compile(_SIGN)
_DOLLARS = re.compile(rf"(?P<passed>{PASSED})|{_SIGN}", re.VERBOSE | re.DOTALL)
_DECLARED = re.compile(r"(?<![\w$.])(?:var|let|const|class|function)\s+(\$[\w$]*)")
_PARAMETERS = re.compile(r"(?<![\w$.])function\b\s*+\*?\s*+[\w$]*+\s*+\(([^()]*)\)")
_USED = re.compile(
    r"[{,]\s*\w+\s*:|(?<!\.\.)\.\s*[\w$]+|(?<![\w$])(?P<own>out|rules|meta)(?![\w$])"
)
"""Names of SISR as identifiers; those of properties are passed over."""
_SISR = re.compile(r"(?<![\w.$])(?:out\b\s*[.=\[+]|(?:rules|meta)\s*[.\[])")
_SLOT = re.compile(r"(?s)\s*([A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*)\s*=(?!=)\s*(.+?)\s*")
_GSL = re.compile(r"<\s*([A-Za-z_]\w*)\s+([^<>]+?)\s*>")
_ALL_GSL = re.compile(rf"(?:\s*{_GSL.pattern})+\s*")
_PIECE = re.compile(rf"{_STRING}|(?P<open>[\[{{(])|(?P<close>[\]}})])|(?P<end>;)|[^\s]|\s+")
_WORDS = re.compile(r"[^\W\d][\w' -]*")
_LITERAL = re.compile(r"""(?s)(?:"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|\{.*\}|\[.*\])""")
_CONSTANTS = {"true", "false", "null", "undefined"}
_ASSIGNED = re.compile(r"(?<![=!<>])=(?!=)")


def settle(document: Document) -> None:
    """Decide how a document's tags are read; the format is one of those known."""
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
    """Whether tags are in the way of the drafts: with ``$`` and without any name of SISR 1.0."""
    if not any("$" in code for code in codes):
        return False
    scripts = [_bare(code) for code in codes]
    everything = [*scripts, *(_bare(code) for code in globals)]
    if any(match["own"] for code in everything for match in _USED.finditer(code)):
        return False
    declared = {name for code in everything for name in _declared(code)}
    signs = {match[0] for code in scripts for match in _DOLLAR.finditer(code)}
    return not signs <= declared


def _declared(script: str) -> list[str]:
    """The names with ``$`` that a script gives to variables and functions of its own."""
    parameters = " ".join(_PARAMETERS.findall(script))
    return _DECLARED.findall(script) + re.findall(r"\$[\w$]*", parameters)


def _bare(code: str) -> str:
    """A script without strings, comments and regular expressions."""
    return _SKIPPED.sub(" ", code)


def _guess(document: Document, codes: list[str]) -> str:
    if any(_SISR.search(_bare(code)) for code in codes):
        return "script"
    bare = all(not _dollars(one) and not _slots(one) and not _value(one) for one in codes)
    return "literals" if bare and not document.globals else "legacy"


def _dollars(code: str) -> bool:
    return _DOLLAR.search(_bare(code)) is not None


def _value(code: str) -> bool:
    return _LITERAL.fullmatch(code.strip()) is not None


@lru_cache(maxsize=4096)
def translate(code: str) -> str:
    """A tag as a script of SISR 1.0."""
    if _SISR.search(_bare(code)):
        return code
    if _dollars(code):
        return _from_dollars(code)
    slots = _slots(code)
    if slots:
        return " ".join(_assign(name, value) for name, value in slots)
    if _value(code):
        return f"out = ({code.strip()}\n);"
    return f"out = {json.dumps(code.strip())};" if code.strip() else ""


def _from_dollars(code: str) -> str:
    """``$`` is the rule's variable, ``$$`` the last rule's value, ``$name`` that of a rule."""

    def put(match: re.Match[str]) -> str:
        if match["passed"] is not None:
            return match["passed"]
        if match[0] == "$$":
            return "rules.latest()"
        return f"rules.{match['rule']}" if match["rule"] else "out"

    script = _DOLLARS.sub(put, code)
    if _ASSIGNED.search(_DOLLARS.sub("", code)):
        return script
    return f"out = ({script}\n);"


def _slots(code: str) -> list[tuple[str, str]]:
    """The slots that a tag fills, with what; none if it is no list of assignments."""
    if _ALL_GSL.fullmatch(code):
        return [(match[1], match[2]) for match in _GSL.finditer(code)]
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
    """A tag divided at its semicolons, not those in strings or brackets."""
    pieces, depth = [""], 0
    for match in _PIECE.finditer(code):
        depth += bool(match["open"]) - bool(match["close"])
        if match["end"] and depth <= 0:
            pieces.append("")
        else:
            pieces[-1] += match[0]
    return [piece for piece in pieces if piece.strip()]


def _assign(name: str, value: str) -> str:
    """A slot filled; a value of bare words is their text."""
    parents = name.split(".")[:-1]
    made = [".".join(parents[:end]) for end in range(1, len(parents) + 1)]
    before = "".join(f"out.{one} = out.{one} || {{}}; " for one in made)
    bare = _WORDS.fullmatch(value) and value not in _CONSTANTS
    shown = json.dumps(value) if bare else f"({value}\n)"
    return f"{before}out.{name} = {shown};"
