"""Recognisers: one limited to what listens now, and one for any words. Both are for English.

They may take long, so they are called in a separate thread, one at a time.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Any

from prima.grammar.answers import Answers
from prima.grammar.phrases import phrases
from prima.live.drivers.speech.jsgf import jsgf
from prima.live.drivers.speech.nearest import hypotheses
from prima.live.drivers.speech.sounds import Pronouncing
from prima.messages import Hypothesis

LOUDEST = 32768.0
MOST_PHRASES = 300
"""The maximum number of a question's phrases that are compared with what is heard."""
Takes = Sequence[Answers]


class GrammarEar:
    """PocketSphinx with a grammar made from what is listening."""

    def __init__(self, pronouncing: Pronouncing) -> None:
        from pocketsphinx import Decoder

        self._decoder: Any = Decoder(lm=None, loglevel="FATAL")
        self._pronouncing = pronouncing
        self._grammar = ""

    def listen_for(self, takes: Takes) -> None:
        """Hear this from now on."""
        grammar = jsgf(takes, self._knows)
        if grammar == self._grammar:
            return
        if grammar:
            self._decoder.add_jsgf_string("heard", grammar)
            self._decoder.activate_search("heard")
        self._grammar = grammar

    def _knows(self, word: str) -> bool:
        """Whether a word is in the dictionary, or can be added to it."""
        if self._decoder.lookup_word(word):
            return True
        sounds = self._pronouncing.sounds(word)
        if sounds:
            self._decoder.add_word(word, sounds, True)
        return bool(sounds)

    def hear(self, sound: bytes) -> str:
        """The accepted words that are nearest to a sound; empty if nothing listens."""
        if not self._grammar:
            return ""
        self._decoder.start_utt()
        self._decoder.process_raw(sound, no_search=False, full_utt=True)
        self._decoder.end_utt()
        found = self._decoder.hyp()
        return str(found.hypstr) if found is not None else ""


class OpenEar:
    """Moonshine with the smallest English model, which comes with its package."""

    def __init__(self) -> None:
        from moonshine_voice import ModelArch, Transcriber, get_model_path

        self._transcriber: Any = Transcriber(str(get_model_path("tiny-en")), ModelArch.TINY)

    def hear(self, sound: bytes) -> str:
        """The words of a sound, if any."""
        samples = [sample / LOUDEST for sample in array("h", sound)]
        heard = self._transcriber.transcribe_without_streaming(samples)
        return " ".join(line.text.strip() for line in heard.lines).strip()

    def close(self) -> None:
        """Release its memory."""
        self._transcriber.close()


class Ears:
    """The selected recognisers.

    Args:
        which: ``grammar``, ``open`` or ``both``.
        cutoff: the minimum similarity of a phrase to what the open one has heard.
        pronouncing: gives the pronunciation of words that the dictionary lacks.
    """

    def __init__(self, which: str, cutoff: float, pronouncing: Pronouncing) -> None:
        self._grammar = GrammarEar(pronouncing) if which != "open" else None
        self._open = OpenEar() if which != "grammar" else None
        self._cutoff = cutoff
        self._phrases: list[str] = []

    def listen_for(self, takes: Takes) -> None:
        """Hear this from now on."""
        found = (phrase for one in takes for phrase in phrases(one, MOST_PHRASES))
        self._phrases = list(dict.fromkeys(found))
        if self._grammar is not None:
            self._grammar.listen_for(takes)

    def hear(self, sound: bytes) -> list[Hypothesis]:
        """The hypotheses, likeliest first; empty if no words were said."""
        said = self._open.hear(sound) if self._open is not None else ""
        if self._open is not None and not said:
            return []
        fits = self._grammar.hear(sound) if self._grammar is not None else ""
        return hypotheses(said, fits, self._phrases, self._cutoff)

    def close(self) -> None:
        """Release their memory."""
        if self._open is not None:
            self._open.close()
