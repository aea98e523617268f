"""How long units speak, and warnings of those that speak for too long (thesis 4.5, U5)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prima.errors import Problem
from prima.errors.diagnoses.behaviour import LONG_UNIT
from prima.interpreter.acts import CommandTemplate, Text, commands_of, pauses_in
from prima.interpreter.elements import Block, Field, Unit
from prima.markup.tree import Node

SPEAKS_LONG = LONG_UNIT.says(
    "This unit speaks for about {seconds} s: no reaction can start.", "Divide it (thesis 4.5)."
)
TOO_LATE = LONG_UNIT.says(
    "This unit speaks for about {seconds} s, beyond its longest duration: error.unit.timeout ends it.",
    "Divide it (thesis 4.5), or write a longer duration.",
)

LONG_UNIT_MS = 20_000
"""The duration of a unit's speech above which no reaction is possible in it."""
MS_A_LETTER = 70
MS_A_SYLLABLE = 125
"""The time to speak a letter, and one of a script of syllables or words, at these robots' speed."""
SYLLABLES = ("ja", "zh", "ko")


def lasts(text: Text | None, lang: str) -> int:
    """The approximate time (ms) to say a text."""
    letters = sum(len(part) for part in text or () if isinstance(part, str))
    syllables = lang.lower().startswith(SYLLABLES)
    return letters * (MS_A_SYLLABLE if syllables else MS_A_LETTER) + pauses_in(text)


def speak(commands: Iterable[CommandTemplate], lang: str) -> int:
    """The approximate time (ms) that Commands speak, one after another."""
    return sum(lasts(one.text, lang) for one in commands)


def unit_speaks(unit: Unit, lang: str) -> int:
    """The approximate time (ms) that a unit around items speaks if each is visited once."""
    total = 0
    for item in unit.items:
        if isinstance(item, Field):
            total += sum(lasts(prompt.text, lang) for prompt in item.prompts[:1])
        elif isinstance(item, Block):
            total += speak(commands_of(item.content), lang)
    return total


def long_unit(node: Node, ms: int) -> Iterator[Problem]:
    """Warn of a unit that speaks so long that no reaction is possible in it."""
    if ms > LONG_UNIT_MS:
        yield SPEAKS_LONG.at(node.place, seconds=ms // 1000)


def long_group(node: Node, ms: int, longest: int) -> Iterator[Problem]:
    """Warn of a unit around Commands that speaks for long, or that its own duration (U5) ends."""
    if ms <= longest:
        yield from long_unit(node, ms)
    else:
        seconds = f"{round(ms / 1000, 1):g}"
        yield TOO_LATE.at(node.attribute_place("longest"), seconds=seconds)
