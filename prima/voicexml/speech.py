"""The speech of a prompt while it is read, until it is queued (VoiceXML 4.1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from prima.interpreter.expressions import MAX_TEXT
from prima.language.values import milliseconds
from prima.markup.tree import Node
from prima.messages import Cue
from prima.voicexml.cues import break_ms, clipped, fold, rate_of
from prima.voicexml.elements import SILENT

APART = frozenset(["p", "s", "paragraph", "sentence"])
SENTENCE = Cue(0, "sentence")


@dataclass(slots=True)
class Speech:
    """The part of a prompt that has been read and not yet queued."""

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


def language_of(node: Node, around: str) -> str:
    """The language of an element in text of some language, which an unspoken one does not change.

    Names of languages differ by more than capitals (RFC 3066, 2.1).
    """
    own = node.get("xml:lang")
    same = not own or node.tag in SILENT or own.lower() == around.lower()
    return around if same else own


def read_markup(node: Node, speech: Speech, inner: Callable[[], None]) -> None:
    """Read an element that needs nothing but the document (SSML 1.0); ``inner`` reads its content."""
    match node.tag:
        case "sub":
            speech.parts.append(node.get("alias", node.text))
        case "break":
            ms = break_ms(node.get("time"), node.get("strength"), node.get("size"))
            speech.parts += [" ", Cue(0, "pause", ms), " "] if ms else [" "]
        case "prosody":
            _prosody(node, speech, inner)
        case tag if tag in SILENT:
            speech.parts.append(" ")
        case tag if tag in APART:
            speech.parts += [" ", SENTENCE]
            inner()
            speech.parts += [SENTENCE, " "]
        case _:
            inner()


def _prosody(node: Node, speech: Speech, inner: Callable[[], None]) -> None:
    """Speech at a rate, or of a set duration, which goes before the rate (SSML 1.0, 3.2.4)."""
    around = speech.rate
    speech.say_at(rate_of(node.get("rate"), around))
    opened = speech.open(milliseconds(node.get("duration"), None))
    inner()
    speech.close(opened)
    speech.say_at(around)
