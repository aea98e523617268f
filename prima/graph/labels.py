"""Labels of edges: the causes of transitions in a few words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from prima.graph.model import clean, short
from prima.language.commands import TABLE_4_2
from prima.markup.tree import Node
from prima.script.comparison import comparison
from prima.script.literals import strings

SAID = 44
"""Maximum length of speech."""
TOLD = 60
"""Maximum length of a condition."""
ASKED = frozenset({"noinput", "nomatch", "help"})
"""Events after which a question is asked again by default."""
LEAVES_USER = frozenset(name for name, row in TABLE_4_2.items() if row.leaves)
"""Commands that leave the user."""
YES = {"yes": "no", "no": "yes"}
QUESTIONS = 3
"""Maximum number of questions of a state that are shown."""


def quoted(text: str, letters: int = SAID) -> str:
    """Speech in quotation marks."""
    return f'"{short(clean(text), letters)}"'


def ordinal(number: int) -> str:
    """1st, 2nd, 3rd, 4th."""
    teen = number % 100 // 10 == 1
    return f"{number}{'th' if teen else {1: 'st', 2: 'nd', 3: 'rd'}.get(number % 10, 'th')}"


@dataclass(frozen=True, slots=True)
class AnswerLabel:
    """The answer just given: the variable of its question, and whether it is yes or no."""

    name: str
    is_yes_or_no: bool


NO_REPLY = AnswerLabel("", False)


def condition(code: str, reply: AnswerLabel = NO_REPLY) -> str:
    """A condition; if it is about the answer just given, that answer."""
    found = comparison(code) if reply.name else None
    if found is not None and found.name in (reply.name, f"dialog.{reply.name}"):
        if isinstance(found.value, str):
            return quoted(found.value)
        if reply.is_yes_or_no:
            return "yes" if found.value else "no"
    return "if " + short(clean(" ".join(code.split())), TOLD)


def joined(base: str, conditions: Iterable[str]) -> str:
    """A cause with its conditions."""
    label = base
    for one in conditions:
        label += f" {one}" if one in YES or one.startswith('"') else f", {one}"
    return label


def answered(names: Sequence[str], mode: str) -> str:
    """The cause of what a form's ``filled`` does: all or any of some items, or of all of them."""
    return f"{(' or ' if mode == 'any' else ', ').join(names) or mode} answered"


def otherwise(branches: list[str]) -> str:
    """The label of the case that no branch of an ``if`` is taken."""
    return YES.get(branches[0], "otherwise") if len(branches) == 1 else "otherwise"


def handled(events: Iterable[str], count: int, cond: str, hints: dict[str, list[str]]) -> str:
    """The events that a handler takes, with their known sources."""
    names = []
    for event in events:
        more = hints.get(event, [])
        names.append(f"{event} ({short('; '.join(more), TOLD)})" if more else event or "any event")
    times = f", {ordinal(count)} time" if count > 1 else ""
    return joined(", ".join(names) + times, [condition(cond)] if cond else [])


def literals(code: str, names: Iterable[str]) -> list[str]:
    """The names that an expression contains as literals."""
    known = set(names)
    found = [text.strip().removeprefix("#") for text in strings(code)]
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


def _phrases(node: Node) -> list[str]:
    """The alternatives at a grammar's beginning, or else all of its words."""
    if around := _only_part(node):
        return _phrases(around)
    texts = map(_words, node.nodes[:4] if node.tag == "one-of" else [node])
    return [text for text in texts if text]


def _only_part(node: Node) -> Node | None:
    """The part of a grammar that says all that it takes: its root rule, or its only part."""
    inner = [child for child in node.nodes if child.tag not in ("tag", "meta", "metadata")]
    if node.tag == "grammar" and inner and inner[0].tag == "rule":
        return next((rule for rule in inner if rule.get("id") == node.get("root")), inner[0])
    alone = len(inner) == 1 and inner[0].tag in ("rule", "one-of", "item")
    return inner[0] if alone and not node.text else None


def _words(node: Node) -> str:
    """All words of a part of a grammar, with the first of alternatives."""
    parts: list[str] = []
    for item in node.content:
        if isinstance(item, str):
            parts.append(item)
        elif item.tag == "one-of" and item.nodes:
            parts.append(_words(item.nodes[0]))
        elif item.tag == "ruleref":
            parts.append("...")
        elif item.tag in ("item", "token") and item.get("repeat")[:1] != "0":
            parts.append(_words(item))
    return " ".join(" ".join(parts).split())[:200]


def notes(questions: Sequence[str], said: str, goals: Sequence[str]) -> list[str]:
    """A state's questions and sentences, and the targets of its Commands."""
    more = len(questions) - QUESTIONS
    return [
        *(f"asks {quoted(text)}" for text in questions[:QUESTIONS]),
        *([f"and {more} more"] if more > 0 else []),
        *([f"says {quoted(said)}"] if said else []),
        *map(clean, goals),
    ]


def known(sources: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    """The sources of events, each once, by event."""
    found: dict[str, list[str]] = {}
    for event, label in sources:
        if label not in found.setdefault(event, []):
            found[event].append(label)
    return found
