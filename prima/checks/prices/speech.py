"""Maximum durations of the prompts of VoiceXML documents, computed without a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from prima.checks.prices.model import UNKNOWN_LETTERS
from prima.devices.voice import timeline
from prima.markup.tree import Node
from prima.messages import Cue
from prima.voicexml.elements import says_instead, words_of
from prima.voicexml.prompts import UNKNOWN_MS
from prima.voicexml.speech import Speech, language_of, read_markup
from prima.voicexml.vocabulary import PRIMA_NAMESPACE

SAYS = "an expression gives a part of what it says"
REPEATED = "an expression says how often a part of it is said"
OF_EACH = "a part of it is said for each choice"


@dataclass(slots=True)
class Said:
    """The text of a prompt by language, with its markup as cues."""

    speech: Speech
    """The piece that is being read."""
    done: list[tuple[str, str, tuple[Cue, ...]]] = field(default_factory=list)
    unknown: str = ""

    def flush(self, lang: str) -> None:
        """Finish a piece before a change of language."""
        self.done.append((self.speech.lang, *self.speech.take()))
        self.speech.lang = lang

    def lasts(self, rates: dict[str, float]) -> int:
        """The duration of all of it (ms)."""
        self.flush(self.speech.lang)
        return sum(
            timeline(text, lang, rates, cues).total for lang, text, cues in self.done if text
        )


def choices_of(item: Node) -> list[Node]:
    """The choices of an item that an ``enumerate`` says."""
    return item.all("choice", "option")


def enumerated(item: Node) -> str:
    """What an ``enumerate`` says of an item."""
    return "; ".join(filter(None, map(words_of, choices_of(item))))


class SpeechReader:
    """Reads the speech of elements.

    ``recording`` returns a recording's duration (ms), if known, by its prompt's base and its name;
    ``choices`` the longest that an ``enumerate`` may say in a language.
    """

    def __init__(
        self, recording: Callable[[str, str], int | None], choices: Callable[[str], str]
    ) -> None:
        self._recording = recording
        self._choices = choices

    def read(
        self, pieces: Iterable[Node | str], lang: str, base: str, choosing: Node | None = None
    ) -> Said:
        """Read pieces of a prompt with a language and a base, or of speech without one.

        ``choosing`` is the item whose choices an ``enumerate`` says; if None, it may be any.
        """
        said = Said(Speech(lang, "", base=base))
        for piece in pieces:
            self._piece(piece, said, choosing)
        return said

    def _piece(self, piece: Node | str, said: Said, choosing: Node | None) -> None:
        if isinstance(piece, str):
            said.speech.parts.append(piece)
        elif piece.namespace != PRIMA_NAMESPACE:
            before = said.speech.lang
            lang = language_of(piece, before)
            if lang != before:
                said.flush(lang)
            self._element(piece, said, choosing)
            if said.speech.lang != before:
                said.flush(before)

    def _inner(self, node: Node, said: Said, choosing: Node | None) -> None:
        for piece in node.content:
            self._piece(piece, said, choosing)

    def _element(self, node: Node, said: Said, choosing: Node | None) -> None:
        match node.tag:
            case "value":
                self._guess(said, SAYS)
            case "enumerate":
                self._enumerate(node, said, choosing)
            case "foreach":
                said.unknown = REPEATED
                self._inner(node, said, choosing)
            case "audio":
                self._audio(node, said, choosing)
            case _:
                read_markup(node, said.speech, lambda: self._inner(node, said, choosing))

    @staticmethod
    def _guess(said: Said, why: str) -> None:
        said.unknown = why
        said.speech.parts.append("x" * UNKNOWN_LETTERS)

    def _enumerate(self, node: Node, said: Said, choosing: Node | None) -> None:
        if node.content:
            said.unknown = OF_EACH
            self._inner(node, said, choosing)
            return
        speech = said.speech
        speech.parts.append(
            self._choices(speech.lang) if choosing is None else enumerated(choosing)
        )

    def _audio(self, node: Node, said: Said, choosing: Node | None) -> None:
        if "expr" in node.attributes:
            self._guess(said, "an expression says what is played")
            self._inner(node, said, choosing)
            return
        ms, speech = self._recording(said.speech.base, node.get("src")), said.speech
        spoken = says_instead(node)
        opened = speech.open(UNKNOWN_MS if ms is None and not spoken else ms)
        if spoken:
            self._inner(node, said, choosing)
        else:
            speech.parts.append(f"[{node.get('src').rpartition('/')[2]}]")
        speech.close(opened)
        speech.parts.append(" ")


def says(pieces: Iterable[Node | str]) -> bool:
    """Whether some pieces contain anything to say."""
    return any(isinstance(one, Node) or one.strip() for one in pieces)
