"""Where the user's words begin and end in the sound that the microphone hears."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from prima.live.drivers.speech.sound import CHUNK_S

LIKELY, UNLIKELY = 0.5, 0.35
"""The probabilities of speech at which an utterance begins, and below which it pauses."""
ONSET = 3
"""The number of chunks of speech that begin an utterance: a click does not."""
BEFORE_S = 0.5
"""How much of the preceding sound belongs to it."""
LONGEST_S = 20.0
"""Longer speech is cut off here."""


class Segments:
    """Divides the sound into utterances.

    Args:
        likely: returns the probability that a chunk is speech (0 to 1).
        silence: seconds of silence that end an utterance.
    """

    def __init__(self, likely: Callable[[bytes], float], silence: float) -> None:
        self._likely = likely
        self._before: deque[bytes] = deque(maxlen=round(BEFORE_S / CHUNK_S))
        self._said: list[bytes] = []
        self._run = 0
        """Chunks of speech so far or, once it has begun, of silence."""
        self.cut = False
        """Whether the latest finished utterance was cut off."""
        self._usual = silence
        self.bound()

    def bound(self, silence: float = 0, longest: float = LONGEST_S) -> None:
        """Set when utterances end from now on.

        Args:
            silence: seconds of silence; 0 for the usual ones.
            longest: seconds of speech at most.
        """
        self.silence = max(round((silence or self._usual) / CHUNK_S), 1)
        """Chunks of silence that end it and are part of it."""
        self._longest = max(round(longest / CHUNK_S), 1)
        self.reset()

    @property
    def speaking(self) -> bool:
        """Whether the user is speaking."""
        return bool(self._said)

    def reset(self) -> None:
        """Drop what was heard."""
        self._before.clear()
        self._said.clear()
        self._run = 0

    def feed(self, chunk: bytes) -> bytes | None:
        """Hear a chunk.

        Returns:
            an utterance that has ended with it; else None.
        """
        likely = self._likely(chunk)
        if not self._said:
            self._before.append(chunk)
            self._run = self._run + 1 if likely >= LIKELY else 0
            if self._run == ONSET:
                self._said, self._run = list(self._before), 0
            return None
        self._said.append(chunk)
        self._run = self._run + 1 if likely < UNLIKELY else 0
        self.cut = self._run < self.silence
        if self.cut and len(self._said) < self._longest:
            return None
        said = b"".join(self._said)
        self.reset()
        return said
