"""Maximum durations of the prompts of VoiceXML documents, computed without a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

from prima.checks.prices.model import UNKNOWN_LETTERS
from prima.devices.voice import timeline
from prima.markup.tree import Node
from prima.messages import Cue
from prima.voicexml.cues import break_ms, fold, milliseconds, rate_of
from prima.voicexml.elements import SILENT
from prima.voicexml.inputs import words_of
from prima.voicexml.prompts import APART, SENTENCE, UNKNOWN_MS
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, SPOKEN

SAYS = "an expression gives a part of what it says"
REPEATED = "an expression says how often a part of it is said"


@dataclass(slots=True)
class Said:
    """The text of a prompt by language, with its markup as cues."""

    lang: str
    parts: list[str | Cue] = field(default_factory=list)
    done: list[tuple[str, list[str | Cue]]] = field(default_factory=list)
    unknown: str = ""
    rate: float = 1.0

    def flush(self, lang: str) -> None:
        """Finish a piece before a change of language."""
        self.done.append((self.lang, self.parts))
        self.lang, self.parts = lang, []
        if self.rate != 1.0:
            self.parts.append(Cue(0, "rate", self.rate))

    def lasts(self, rates: dict[str, float]) -> int:
        """The duration of all of it (ms)."""
        self.flush(self.lang)
        folded = [(lang, *fold(_closed(parts))) for lang, parts in self.done]
        return sum(timeline(text, lang, rates, cues).total for lang, text, cues in folded if text)


def _closed(parts: list[str | Cue]) -> list[str | Cue]:
    """Pieces without the ends of durations that begin in other pieces."""
    depth, found = 0, list[str | Cue]()
    for part in parts:
        if isinstance(part, Cue) and part.kind in ("lasts", "end"):
            depth += 1 if part.kind == "lasts" else -1
            if depth < 0:
                depth = 0
                continue
        found.append(part)
    return found


class SpeechReader:
    """Reads the speech of elements; ``recording`` returns a recording's duration (ms), if known."""

    def __init__(self, recording: Callable[[Node, str], int | None]) -> None:
        self._recording = recording

    def read(self, pieces: Iterable[Node | str], lang: str, menu: Node | None = None) -> Said:
        """Read pieces of a prompt, or of speech without one."""
        said = Said(lang)
        for piece in pieces:
            self._piece(piece, said, menu)
        return said

    def _piece(self, piece: Node | str, said: Said, menu: Node | None) -> None:
        if isinstance(piece, str):
            said.parts.append(piece)
        elif piece.namespace != PRIMA_NAMESPACE:
            before, lang = said.lang, piece.get("xml:lang")
            if lang and lang != before:
                said.flush(lang)
            self._element(piece, said, menu)
            if said.lang != before:
                said.flush(before)

    def _inner(self, node: Node, said: Said, menu: Node | None) -> None:
        for piece in node.content:
            self._piece(piece, said, menu)

    def _element(self, node: Node, said: Said, menu: Node | None) -> None:
        match node.tag:
            case "value":
                self._guess(said, SAYS)
            case "sub":
                said.parts.append(f" {node.get('alias', node.text)} ")
            case "break":
                ms = break_ms(node.get("time"), node.get("strength"), node.get("size"))
                said.parts += [" ", Cue(0, "pause", ms), " "]
            case "enumerate":
                self._enumerate(node, said, menu)
            case "foreach":
                said.unknown = REPEATED
                self._inner(node, said, menu)
            case "audio":
                self._audio(node, said, menu)
            case "prosody":
                self._prosody(node, said, menu)
            case tag if tag in SILENT or tag == "mark":
                said.parts.append(" ")
            case tag if tag in APART:
                said.parts += [" ", SENTENCE]
                self._inner(node, said, menu)
                said.parts += [SENTENCE, " "]
            case _:
                self._inner(node, said, menu)

    @staticmethod
    def _guess(said: Said, why: str) -> None:
        said.unknown = why
        said.parts.append("x" * UNKNOWN_LETTERS)

    def _enumerate(self, node: Node, said: Said, menu: Node | None) -> None:
        choices = menu.all("choice", "option") if menu is not None else []
        if node.content:
            said.unknown = REPEATED
            self._inner(node, said, menu)
        said.parts.append("; ".join(filter(None, map(words_of, choices))))

    def _audio(self, node: Node, said: Said, menu: Node | None) -> None:
        if "expr" in node.attributes:
            self._guess(said, "an expression says what is played")
            self._inner(node, said, menu)
            return
        ms = self._recording(node, node.get("src"))
        spoken = node.text or any(one.tag not in SILENT for one in node.nodes)
        if ms is None and not spoken:
            ms = UNKNOWN_MS
        if ms is not None:
            said.parts.append(Cue(0, "lasts", ms))
        if spoken:
            self._inner(node, said, menu)
        else:
            said.parts.append(f"[{node.get('src').rpartition('/')[2]}]")
        if ms is not None:
            said.parts.append(Cue(0, "end"))
        said.parts.append(" ")

    def _prosody(self, node: Node, said: Said, menu: Node | None) -> None:
        around, ms = said.rate, milliseconds(node.get("duration"))
        self._rate(said, rate_of(node.get("rate"), around))
        if ms is not None:
            said.parts.append(Cue(0, "lasts", ms))
        self._inner(node, said, menu)
        if ms is not None:
            said.parts.append(Cue(0, "end"))
        self._rate(said, around)

    @staticmethod
    def _rate(said: Said, rate: float) -> None:
        if said.rate != rate:
            said.rate = rate
            said.parts.append(Cue(0, "rate", rate))


def utterances(node: Node) -> Iterator[tuple[Node, list[Node | str]]]:
    """The speech of an element's own content: each prompt, and text between other elements.

    Each comes with the element at which it is reported.
    """
    loose: list[Node | str] = []
    for piece in [*node.content, None]:
        if isinstance(piece, str) or (piece is not None and piece.tag in SPOKEN - {"prompt"}):
            loose.append(piece)
            continue
        if any(isinstance(one, Node) or one.strip() for one in loose):
            first = loose[0]
            yield first if isinstance(first, Node) else node, loose
        loose = []
        if piece is not None and piece.tag == "prompt":
            yield piece, list(piece.content)
