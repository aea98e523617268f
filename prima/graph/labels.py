"""Labels of edges: the causes of transitions in a few words."""

from __future__ import annotations

import re
from collections.abc import Iterable

from prima.graph.model import clean, short
from prima.markup.tree import Node

SAID = 44
"""Maximum length of speech."""
TOLD = 60
"""Maximum length of a condition."""
LITERAL = re.compile(r"""'([^'\\\n]*)'|"([^"\\\n]*)\"""")
ASKED = frozenset({"noinput", "nomatch", "help"})
"""Events after which a question is asked again by default."""
YES = {"yes": "no", "no": "yes"}


def quoted(text: str, letters: int = SAID) -> str:
    """Speech in quotation marks."""
    return f'"{short(clean(text), letters)}"'


def ordinal(number: int) -> str:
    """1st, 2nd, 3rd, 4th."""
    teen = number % 100 // 10 == 1
    return f"{number}{'th' if teen else {1: 'st', 2: 'nd', 3: 'rd'}.get(number % 10, 'th')}"


def condition(code: str, name: str, truth: bool) -> str:
    """A condition; if it is about the answer just given, that answer.

    Args:
        code: the expression.
        name: the variable of the question that has been answered, if any.
        truth: whether the answer is yes or no.
    """
    code = " ".join(code.split())
    if name:
        own = rf"(?:dialog\.)?{re.escape(name)}"
        if truth and (match := re.fullmatch(rf"(!?) ?{own}(?: ?===? ?(true|false))?", code)):
            return "yes" if (match[1] == "") == (match[2] != "false") else "no"
        if match := re.fullmatch(rf"{own} ?===? ?(?:{LITERAL.pattern})", code):
            return quoted(match[1] or match[2] or "")
    return "if " + short(clean(code), TOLD)


def joined(base: str, conditions: Iterable[str]) -> str:
    """A cause with its conditions."""
    told = base
    for one in conditions:
        told += f" {one}" if one in YES or one.startswith('"') else f", {one}"
    return told


def otherwise(branches: list[str]) -> str:
    """The label of the case that no branch of an ``if`` is taken."""
    return YES.get(branches[0], "otherwise") if len(branches) == 1 else "otherwise"


def handled(events: Iterable[str], count: int, cond: str, hints: dict[str, list[str]]) -> str:
    """The events that a handler takes, with their known sources."""
    told = []
    for event in events:
        more = hints.get(event, [])
        told.append(f"{event} ({short('; '.join(more), TOLD)})" if more else event or "any event")
    times = f", {ordinal(count)} time" if count > 1 else ""
    return joined(", ".join(told) + times, [condition(cond, "", False)] if cond else [])


def literals(code: str, names: Iterable[str]) -> list[str]:
    """The names that an expression contains as literals."""
    known = set(names)
    held = [(match[1] or match[2] or "").strip() for match in LITERAL.finditer(code)]
    found = [name.removeprefix("#") for name in held]
    return [name for name in dict.fromkeys(found) if name in known]


def sayings(grammars: Iterable[Node]) -> str:
    """The first phrases that a grammar takes."""
    found: list[str] = []
    for grammar in grammars:
        outside = grammar.get("src") or grammar.get("srcexpr")
        if outside:
            found.append(f"what {clean(outside)} takes")
            continue
        phrases = [quoted(words, 24) for words in _phrases(grammar)]
        rest = ["..."] if len(phrases) > 3 else []
        found += [*phrases[:3], *rest]
    return " or ".join(found) if len(found) < 3 else ", ".join(found)


def _phrases(node: Node, depth: int = 0) -> list[str]:
    """The alternatives at a grammar's beginning, or else all of its words."""
    if depth > 40:
        return []
    inner = [child for child in node.nodes if child.tag not in ("tag", "meta", "metadata")]
    own = node.text
    if not own and len(inner) == 1 and inner[0].tag in ("rule", "one-of", "item"):
        return _phrases(inner[0], depth + 1)
    if node.tag == "one-of":
        return [text for child in inner[:4] if (text := _words(child))]
    if node.tag == "grammar" and inner and inner[0].tag == "rule":
        root = next((rule for rule in inner if rule.get("id") == node.get("root")), inner[0])
        return _phrases(root, depth + 1)
    text = _words(node)
    return [text] if text else []


def _words(node: Node, depth: int = 0) -> str:
    """All words of a part of a grammar, with the first of alternatives."""
    parts: list[str] = []
    for item in node.content:
        if isinstance(item, str):
            parts.append(item)
        elif depth < 40 and item.tag == "one-of" and item.nodes:
            parts.append(_words(item.nodes[0], depth + 1))
        elif item.tag == "ruleref":
            parts.append("...")
        elif depth < 40 and item.tag in ("item", "token") and item.get("repeat")[:1] != "0":
            parts.append(_words(item, depth + 1))
    return " ".join(" ".join(parts).split())[:200]
