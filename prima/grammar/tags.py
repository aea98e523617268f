"""Problems of a grammar's tags that are found in their text."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from prima.errors import Problem, did_you_mean
from prima.grammar.legacy import translate
from prima.grammar.model import GrammarDocument, Part, Reference, Tag, walk
from prima.script.budget import Budget
from prima.script.globals import GLOBALS, VARIABLES
from prima.script.names import script_names
from prima.script.parse import parse_script

if TYPE_CHECKING:
    from prima.script.shared import IsolatedTagEngine

SISR = frozenset(["out", "rules", "meta"])
"""Variables of every tag of a rule (SISR 1.0)."""
LABELLED = re.compile(r"""\s*\{?\s*(?:[\w$]+|"[^"\n]*"|'[^'\n]*')\s*:""")
"""The beginning of an object's properties."""
OLDER = "In SISR 1.0, as in the other tags, $$ is rules.latest() and $ is out."
"""The remedy for a name of SISR's drafts, in a grammar whose other tags are of SISR 1.0."""
LOST = "answers that need it do not match"


def tag_warnings(document: GrammarDocument) -> list[Problem]:
    """Tags that are not scripts, and unassigned names in them (SISR 1.0)."""
    if not (document.tags or document.globals) or document.dialect == "literals":
        return []
    from prima.script.shared import IsolatedTagEngine

    engine = IsolatedTagEngine(Budget())
    found: list[Problem] = []
    sound: dict[int, str] = {}
    """Tags that are scripts, by the identity of the tag."""
    for tag in (*document.globals, *document.tags):
        code = _script(document, tag)
        shown = " ".join(tag.code.split())[:60]
        fault = engine.fault(code)
        remedy = "" if document.dialect == "legacy" else _as_object(engine, tag.code)
        if fault:
            message = f'"{shown}" is not ECMAScript: {LOST}.'
        elif remedy:
            message = f'"{shown}" is a statement with a label, not an object: it gives no value.'
        else:
            sound[id(tag)] = code
            continue
        found.append(Problem(tag.where(), "warning", "bad-expression", message, remedy))
    return [*found, *_unknown(document, sound)]


def _as_object(engine: IsolatedTagEngine, code: str) -> str:
    """The remedy for a tag that is only the properties of an object, in braces or without."""
    if not LABELLED.match(code):
        return ""
    code = code.strip().rstrip(";")
    right = f"out = {code}" if code[0] == "{" else f"out = {{{code}}}"
    return "" if engine.fault(right) else f"Write {' '.join(right.split())}."


def _script(document: GrammarDocument, tag: Tag) -> str:
    legacy = document.dialect == "legacy" and not any(tag is one for one in document.globals)
    return translate(tag.code) if legacy else tag.code


def _unknown(document: GrammarDocument, sound: dict[int, str]) -> Iterator[Problem]:
    """Names that are neither SISR's nor assigned, or tested, by any tag of the document."""
    names = [script_names(code) for code in sound.values()]
    known = set(SISR).union(*(one.declared | one.written | one.asked for one in names))
    for tag in document.globals:
        yield from _names(tag, sound.get(id(tag), ""), known)
    for rule in document.rules.values():
        tags, rules = _held(rule.body)
        for tag in tags:
            code = sound.get(id(tag), "")
            yield from _names(tag, code, known)
            yield from _rules(tag, code, rules)


def _names(tag: Tag, code: str, known: set[str]) -> Iterator[Problem]:
    names = script_names(code)
    for name in sorted({*names.free, *(VARIABLES & names.read.keys())} - known):
        message = f'The tag uses "{name}", which nothing in the grammar declares: {LOST}.'
        remedy = OLDER if name in ("$", "$$") else did_you_mean(name, known | GLOBALS - VARIABLES)
        remedy = remedy or f"For the text itself write '{name}' in quotes."
        yield Problem(tag.where(), "warning", "undeclared-variable", message, remedy)


def _rules(tag: Tag, code: str, rules: set[str]) -> Iterator[Problem]:
    """Rules that a tag names although its own rule does not refer to them."""
    for name in _rules_used(code):
        if name in rules:
            continue
        message = f'The tag uses the rule "{name}", to which its own rule does not refer.'
        remedy = did_you_mean(name, rules) or "rules.latest() is the rule matched last."
        yield Problem(tag.where(), "warning", "no-such-rule", message, remedy)


def _rules_used(code: str) -> list[str]:
    """The rules whose values or texts a tag reads: ``rules.name``, ``meta.name``."""
    found: list[str] = []
    parsed = parse_script(code)
    for node, parent in parsed.walk_inside() if parsed is not None else ():
        if node.type != "member_expression" or parent is None:
            continue
        holder, part = node.child_by_field_name("object"), node.child_by_field_name("property")
        called = parent.type == "call_expression"
        if holder is None or part is None or called or holder.type != "identifier":
            continue
        if parsed is not None and parsed.of(holder) in ("rules", "meta"):
            found.append(parsed.of(part))
    return [*dict.fromkeys(found)]


def _held(body: Part) -> tuple[list[Tag], set[str]]:
    """The tags of a rule, and the names of the rules that it refers to."""
    tags: list[Tag] = []
    rules: set[str] = set()
    for part in walk(body):
        match part:
            case Tag():
                tags.append(part)
            case Reference(rule=rule) if rule is not None:
                rules.add(rule.name)
    return tags, rules
