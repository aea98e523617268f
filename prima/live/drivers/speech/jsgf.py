"""The active grammars as one JSGF grammar, for a recogniser limited to it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence

from prima.grammar.answers import Answers
from prima.grammar.model import Alternatives, BuiltIn, Part, Reference, Repeat, Rule, Special, Words
from prima.grammar.model import Sequence as Row
from prima.grammar.numbers import ONES, TENS
from prima.grammar.text import wide

DEEP = 40
"""The maximum depth of rules inside rules, which recursive ones exceed: deeper ones are omitted."""
MOST = 50_000
"""Maximum length of a grammar in characters, and number of parts, each as often as it is written."""
MOST_INSIDE = 200
"""Maximum number of parts inside one another, of all rules together."""
APART = re.compile(r"[^\w']+")
SPOKEN = re.compile(r"[a-z][a-z']*")
"""A word that can be added to a recogniser's dictionary."""
NUMBERS = [*ONES, *TENS, "hundred", "thousand", "point", "oh", "minus"]
TYPES = {
    "boolean": "( yes | no )",
    "number": f"( {' | '.join(NUMBERS)} )+",
    "digits": f"( {' | '.join([*NUMBERS[:10], 'oh'])} )+",
}
TYPES |= {
    "phone": f"{TYPES['digits']} [ extension {TYPES['digits']} ]",
    "currency": f"{TYPES['number']} [ dollar | dollars ] [ and ] [ {TYPES['number']} [ cent | cents ] ]",
}
"""The built-in types with few words. Dates, times and texts need an open recogniser."""


class TooLarge(Exception):
    """A grammar is too large."""


def jsgf(takes: Sequence[Answers], known: Callable[[str], bool]) -> str:
    """A grammar of everything that listens; empty if nothing of it can be expressed.

    Args:
        takes: what the listening questions and links accept.
        known: whether the recogniser knows a word.
    """
    try:
        choices = [one for answers in takes for one in _answers(answers, known)]
    except TooLarge:
        return ""
    choices = list(dict.fromkeys(choices))
    body = " | ".join(choices)
    if not choices or len(body) > MOST:
        return ""
    return f"#JSGF V1.0;\ngrammar heard;\npublic <heard> = {body};\n"


def _answers(answers: Answers, known: Callable[[str], bool]) -> Iterator[str]:
    writer = Writer(known)
    for option in answers.options:
        if text := writer.words(option):
            yield text
    for grammar in answers.grammars:
        if text := writer.part(grammar.expansion, ()):
            yield text
    if answers.type in TYPES:
        yield TYPES[answers.type]


def spelt(text: str) -> list[str]:
    """Words in dictionary form: lower case, with apostrophes, which distinguish I'll from ill."""
    plain = wide(text).lower().replace("\u2019", "'")
    return [word for word in (one.strip("'") for one in APART.split(plain)) if word]


class Writer:
    """Writes parts of grammars; what cannot be said is omitted.

    A part that matches silence is empty text; one that can never match is None.
    """

    def __init__(self, known: Callable[[str], bool]) -> None:
        self._known = known
        self._written = 0
        self._parts = 0
        self._inside = 0

    def words(self, text: str) -> str | None:
        """Words in the recogniser's spelling; None if it does not know one."""
        found = spelt(text)
        if not all(SPOKEN.fullmatch(word) and self._known(word) for word in found):
            return None
        self._add(len(text))
        return " ".join(found)

    def _add(self, letters: int) -> None:
        self._written += letters
        if self._written > MOST:
            raise TooLarge

    def part(self, part: Part, inside: tuple[Rule, ...]) -> str | None:
        """A part of a grammar, within some rules."""
        self._parts += 1
        self._inside += 1
        if self._parts > MOST or self._inside > MOST_INSIDE:
            raise TooLarge
        made = self._made(part, inside)
        self._inside -= 1
        return made

    def _made(self, part: Part, inside: tuple[Rule, ...]) -> str | None:
        match part:
            case Words(tokens=tokens):
                return self.words(" ".join(tokens))
            case Row(parts):
                made = [self.part(one, inside) for one in parts]
                return None if None in made else " ".join(filter(None, made))
            case Alternatives(parts):
                return self._choice(parts, inside)
            case Repeat():
                return self._repeat(part, inside)
            case Reference(rule=rule):
                return self._rule(rule, inside)
            case Special(name):
                return None if name == "VOID" else ""
            case BuiltIn(name=name):
                return TYPES.get(name)
        return ""  # a tag

    def _rule(self, rule: Rule | None, inside: tuple[Rule, ...]) -> str | None:
        """A rule's body; None if the rule does not exist, is recursive, or is too deep."""
        if rule is None or rule in inside or len(inside) > DEEP:
            return None
        return self.part(rule.body, (*inside, rule))

    def _choice(self, parts: Sequence[Part], inside: tuple[Rule, ...]) -> str | None:
        made = [self.part(one, inside) for one in parts]
        said = list(dict.fromkeys(one for one in made if one))
        silent = "" in made
        if not said:
            return "" if silent else None
        body = " | ".join(said)
        return f"[ {body} ]" if silent else f"( {body} )"

    def _repeat(self, part: Repeat, inside: tuple[Rule, ...]) -> str | None:
        body = self.part(part.part, inside)
        if not body:
            return "" if body == "" or not part.low else None
        if part.high == 0:
            return ""
        row = [f"( {body} )"] * min(part.low, DEEP)
        if part.high is None:
            row.append(f"( {body} )*")
        else:
            row += [f"[ {body} ]"] * min(part.high - part.low, DEEP)
        self._add(len(body) * (len(row) - 1))
        return " ".join(row)
