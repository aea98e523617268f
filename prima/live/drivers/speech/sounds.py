"""The pronunciation of words that a recogniser's dictionary lacks, by the English voice's rules."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

SOUNDS = {
    "A": "EY", "I": "AY", "O": "OW", "W": "AW", "Y": "OY", "Q": "OW",
    "i": "IY", "ɪ": "IH", "ᵻ": "IH", "u": "UW", "ʊ": "UH", "ɛ": "EH", "e": "EH", "æ": "AE",
    "a": "AE", "ɑ": "AA", "ɔ": "AO", "ʌ": "AH", "ə": "AH", "ᵊ": "AH", "ɜ": "ER", "ɐ": "AH",
    "b": "B", "d": "D", "f": "F", "h": "HH", "j": "Y", "k": "K", "l": "L", "m": "M", "n": "N",
    "p": "P", "s": "S", "t": "T", "T": "T", "v": "V", "w": "W", "z": "Z", "ɡ": "G", "g": "G",
    "ŋ": "NG", "ð": "DH", "θ": "TH", "ʃ": "SH", "ʒ": "ZH", "ʤ": "JH", "ʧ": "CH", "ɹ": "R", "ɾ": "T",
}  # fmt: skip
"""The voice's phonetic alphabet in ARPABET, which the recogniser's dictionary uses."""
SILENT = frozenset("ˈˌː. ")


class Pronouncing:
    """Gives the pronunciation of English words; loads what it needs when first used."""

    def __init__(self) -> None:
        self._rules: Callable[[str], Any] | None = None

    def sounds(self, word: str) -> str:
        """The pronunciation of a word in ARPABET; empty if unknown."""
        if self._rules is None:
            from hibari.g2p import G2P

            self._rules = G2P()
        return arpabet(str(self._rules(word) or ""))


def arpabet(signs: str) -> str:
    """Symbols of the voice's alphabet in ARPABET; empty if one is unknown."""
    made: list[str] = []
    for sign in signs:
        if sign in SILENT:
            continue
        if sign not in SOUNDS:
            return ""
        made.append(SOUNDS[sign])
    return " ".join(made).replace("AH R", "ER").replace("ER R", "ER")
