"""The speech of a prompt while it is read, until it is queued (VoiceXML 4.1)."""

from __future__ import annotations

from dataclasses import dataclass, field

from prima.interpreter.expressions import MAX_TEXT
from prima.messages import Cue
from prima.voicexml.cues import clipped, fold


@dataclass(slots=True)
class Speech:
    """What has been read of a prompt and not been queued yet."""

    lang: str
    place: str
    parts: list[str | Cue] = field(default_factory=list)
    base: str = ""
    """The prompt's ``xml:base``, for its recordings."""
    rate: float = 1.0
    """How fast it is said, as a multiple of the usual rate."""
    silent: bool = False
    """Whether a recording is played instead of the text read, whose marks are not passed."""
    takes: int = 0

    def take(self) -> tuple[str, tuple[Cue, ...]]:
        """Remove and return the text so far, white space folded, and its cues."""
        text, cues = fold(self.parts)
        self.parts.clear()
        self.takes += 1
        if self.rate != 1.0:
            self.parts.append(Cue(0, "rate", self.rate))
        if len(text) > MAX_TEXT:
            text, cues = text[:MAX_TEXT], clipped(cues, MAX_TEXT)
        return text, cues

    def say_at(self, rate: float) -> None:
        """Set the rate of what follows."""
        if rate != self.rate:
            self.rate = rate
            self.parts.append(Cue(0, "rate", rate))

    def open(self, ms: int | None) -> int:
        """Begin a set duration for what follows; gives what closes it."""
        if ms is None:
            return -1
        self.parts.append(Cue(0, "lasts", ms))
        return self.takes

    def close(self, opened: int) -> None:
        """End a set duration, unless it has been split meanwhile."""
        if opened == self.takes:
            self.parts.append(Cue(0, "end"))
