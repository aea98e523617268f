"""Random grammars take what their rules derive, and mean what the tags of a derivation say."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from prima.grammar import load

HEAD = "#ABNF 1.0;\nlanguage en;\nroot $r0;\ntag-format <semantics/1.0>;\n"
SRGS = (
    '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en" root="r0"'
    ' tag-format="semantics/1.0">{}</grammar>'
)
RULES = 4
MOST_DERIVATIONS = 3_000
Meaning = str | dict[str, "Meaning"]
Step = tuple[str, str, Meaning]
"""What a derivation comes to: a ``word``, a ``tag``, or a ``rule`` with its meaning."""


@dataclass
class Part:
    """An expansion: ``word``, ``tag``, ``rule``, ``all``, ``one`` or ``times``, with its parts."""

    kind: str
    text: str = ""
    parts: list[Part] = field(default_factory=list)
    least: int = 0
    most: int | None = None

    @property
    def repeat(self) -> str:
        """How often it is repeated, as SRGS writes it."""
        if self.least == self.most:
            return str(self.least)
        return f"{self.least}-{'' if self.most is None else self.most}"

    def abnf(self) -> str:
        inner = [one.abnf() for one in self.parts]
        match self.kind:
            case "word":
                return self.text
            case "tag":
                return f"{{!{{{self.text}}}!}}"
            case "rule":
                return f"${self.text}"
            case "times":
                return f"({inner[0]})<{self.repeat}>"
        return f"({(' | ' if self.kind == 'one' else ' ').join(inner)})"

    def xml(self) -> str:
        inner = [one.xml() for one in self.parts]
        match self.kind:
            case "word":
                return f"<item>{self.text}</item>"
            case "tag":
                return f"<tag><![CDATA[{self.text}]]></tag>"
            case "rule":
                return f'<ruleref uri="#{self.text}"/>'
            case "times":
                return f'<item repeat="{self.repeat}">{inner[0]}</item>'
            case "one":
                return f"<one-of>{''.join(f'<item>{one}</item>' for one in inner)}</one-of>"
        return f"<item>{''.join(inner)}</item>"


class Author:
    """Writes a grammar; a rule refers to later ones, and has tags of one kind, or none."""

    def __init__(self, random: Random) -> None:
        self.random = random
        self.below: list[str] = []
        self.kind = ""
        self.rules: dict[str, Part] = {}
        for number in reversed(range(RULES)):
            self.kind = random.choice(("properties", "text", "", ""))
            self.rules[f"r{number}"] = self.part(3)
            self.below.append(f"r{number}")

    def part(self, depth: int, empty: bool = True) -> Part:
        """An expansion; what is repeated may not be empty."""
        kind = self.random.randint(0, 9 if depth else 2)
        if kind <= 1 or (kind == 2 and not (self.below and empty)):
            return Part("word", self.random.choice("abc"))
        if kind == 2:
            return Part("rule", self.random.choice(self.below))
        if kind <= 5:
            return Part("all", parts=[*self.several(depth, empty)])
        if kind <= 7:
            some = [self.part(depth - 1, empty) for _ in range(self.random.randint(1, 3))]
            return Part("one", parts=some)
        if kind == 8 and empty and self.random.random() < 0.2:
            return Part("all")
        least = self.random.choice((0, 0, 1, 2)) if empty else 1
        most = self.random.choice((max(least, 1), least + 1, None))
        return Part("times", "", [self.part(depth - 1, empty=False)], least, most)

    def several(self, depth: int, empty: bool) -> Iterator[Part]:
        for _ in range(self.random.randint(1, 3)):
            yield self.part(depth - 1, empty)
            if self.kind and self.random.random() < 0.5:
                yield Part("tag", self.tag())

    def tag(self) -> str:
        name, value = self.random.choice("pq"), self.random.choice("xyz")
        if self.kind == "text":
            return self.random.choice((f"out = '{value}';", "out = meta.current().text;"))
        kinds = [f"out.{name} = '{value}';", f"out.{name} = meta.current().text;"]
        if self.below:
            rule = self.random.choice(self.below)
            kinds.append(f"if (rules.{rule} !== undefined) out.{name} = rules.{rule};")
        return self.random.choice(kinds)


class Derivations:
    """All ways in which rules derive words, from left to right."""

    def __init__(self, rules: dict[str, Part], words: list[str]) -> None:
        self.rules = rules
        self.words = words

    def of(self, part: Part, at: int) -> Iterator[tuple[int, list[Step]]]:
        """Where an expansion that begins there may end, and what it comes to."""
        match part.kind:
            case "word":
                if self.words[at : at + 1] == [part.text]:
                    yield at + 1, [("word", part.text, "")]
            case "tag":
                yield at, [("tag", part.text, "")]
            case "rule":
                for end, meaning in self.meanings(part.text, at):
                    yield end, [("rule", part.text, meaning)]
            case "all":
                yield from self.all(part.parts, at)
            case "one":
                for one in part.parts:
                    yield from self.of(one, at)
            case _:
                yield from self.times(part, at, 0)

    def all(self, parts: list[Part], at: int) -> Iterator[tuple[int, list[Step]]]:
        if not parts:
            yield at, []
            return
        for middle, first in self.of(parts[0], at):
            for end, rest in self.all(parts[1:], middle):
                yield end, first + rest

    def times(self, part: Part, at: int, done: int) -> Iterator[tuple[int, list[Step]]]:
        if done >= part.least:
            yield at, []
        if part.most is None or done < part.most:
            for middle, first in self.of(part.parts[0], at):
                for end, rest in self.times(part, middle, done + 1):
                    yield end, first + rest

    def meanings(self, name: str, at: int) -> Iterator[tuple[int, Meaning]]:
        """What a rule may mean there (SISR 1.0, 3.2, 6): by its tags, or else by its last rule."""
        for end, steps in self.of(self.rules[name], at):
            whole = " ".join(self.words[at:end])
            out: Meaning = {}
            rules: dict[str, Meaning] = {}
            for kind, text, meaning in steps:
                if kind == "rule":
                    rules.pop(text, None)  # the latest is the last
                    rules[text] = meaning
                elif kind == "tag":
                    out = after(text, out, rules, whole)
            if not any(kind == "tag" for kind, *_ in steps):
                out = [*rules.values()][-1] if rules else whole
            yield end, out


def after(tag: str, out: Meaning, rules: dict[str, Meaning], whole: str) -> Meaning:
    """What ``out`` is after a tag."""
    target, _, value = tag.removesuffix(";").rpartition(" = ")
    target = target.rpartition(" ")[2]
    name = value.removeprefix("rules.")
    if name != value and name not in rules:
        return out
    meant = rules[name] if name in rules else whole if "meta" in value else value.strip("'")
    return {**out, target[4:]: meant} if isinstance(out, dict) and target != "out" else meant


@settings(
    max_examples=int(os.environ.get("PRIMA_EXAMPLES", "300")),
    derandomize=os.environ.get("CI") == "true",
    deadline=None,
    database=None,
)
@given(st.integers(0, 10**9))
def test_random_grammars(seed: int) -> None:
    random = Random(seed)
    rules = Author(random).rules
    abnf = HEAD + "".join(f"public ${name} = {one.abnf()};\n" for name, one in rules.items())
    xml = "".join(f'<rule id="{name}">{one.xml()}</rule>' for name, one in rules.items())
    grammars = load(abnf), load(SRGS.format(xml))
    for _ in range(8):
        words = [random.choice("abc") for _ in range(random.randint(1, 5))]
        derived = Derivations(rules, words).meanings("r0", 0)
        some = [*islice(derived, MOST_DERIVATIONS)]
        if len(some) == MOST_DERIVATIONS:
            continue
        meanings = [meaning for end, meaning in some if end == len(words)]
        for grammar in grammars:
            found = grammar.match(" ".join(words))
            assert bool(found) == bool(meanings), (abnf, words)
            assert not found or found[0].interpretation in meanings, (abnf, words)
