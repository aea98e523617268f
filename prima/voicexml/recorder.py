"""Recordings of the user: the words said, or the name of a file (VoiceXML 2.0, 2.3.6)."""

from __future__ import annotations

from dataclasses import replace

from prima.interpreter.transfers import Thrown
from prima.language.values import milliseconds
from prima.markup.tree import Node
from prima.messages import BEEP, Command, Cue, Data, Event, Hypothesis, Json
from prima.voicexml.inputs import Inputs
from prima.voicexml.items import Items
from prima.voicexml.matching import KEYS
from prima.voicexml.platform import unrecorded
from prima.voicexml.results import marked_and_recorded
from prima.voicexml.settings import setting
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context, Flow, TakenUtterance

BEEP_MS = 500
END_KEYS = "#*"
"""Keys that may end a spoken recording; others would be taken for its last word."""


class RecordItems:
    """Fills the record items of one application."""

    def __init__(self, shared: SharedState, inputs: Inputs, items: Items) -> None:
        self.shared = shared
        self.inputs = inputs
        self.items = items

    def check(self, context: Context, item: Node) -> None:
        """Refuse a format that cannot be recorded, of a record item or of ``recordutterance``.

        Raises:
            Thrown: ``error.unsupported.format`` (2.0, 2.3.6; 2.1, 7.2).
        """
        media_type = item.get("type") if item.tag == "record" else ""
        if item.tag != "record" and setting(context, "recordutterance") == "true":
            media_type = setting(context, "recordutterancetype")
        if (refused := unrecorded(media_type)) is not None:
            raise Thrown.at(item, *refused)

    def prepare(self, item: Node, question: Command) -> None:
        """Make a question ask for a recording: a beep at its end, and its bounds as cues."""
        if item.get("beep") == "true":
            said = f"{question.text} " if question.text else ""
            at = len(said)
            begins = (Cue(at, "lasts", BEEP_MS), Cue(at, "sound", BEEP))
            beep = (*begins, Cue(at + len(BEEP), "end"))
            question.text = said + BEEP
            question.cues = (*question.cues, *beep)
        silence = milliseconds(item.get("finalsilence"), 0)
        bounds = (
            Cue(0, "record", milliseconds(item.get("maxtime"), 0)),
            *((Cue(0, "finalsilence", silence),) if silence else ()),
        )
        question.cues = (*bounds, *question.cues)

    def take(self, context: Context, item: Node, heard: TakenUtterance, data: Data) -> Flow:
        """Fill a record with what was said.

        If only keys are pressed, nothing has been recorded: its variable stays as it is, and
        the keys are found in ``application.lastresult$``. So it does if another element's grammar
        takes the key at the end, which then goes to that element.
        """
        said, key, heard = self._heard(context, item, heard)
        if key or heard.recognised:
            self.items.remember(context, heard)
        if heard.owner is not item:
            yield from self.items.process(context, heard)
            return
        if not said:
            return
        more: dict[str, Json] = {"maxtime": bool(data.get("maxtime"))}
        more |= marked_and_recorded(heard)
        more["termchar"] = key or None
        if not key and heard.recognised:
            more |= {"utterance": heard.utterance, "confidence": heard.confidence}
        self._fill(context, item, said, data, more)
        yield from self.items.run_filled(context, [item])

    def _heard(
        self, context: Context, item: Node, heard: TakenUtterance
    ) -> tuple[str, str, TakenUtterance]:
        """What was recorded, the key of ``dtmfterm`` that ended it, and what a grammar took."""
        listens = "dtmf" in self.inputs.modes(context)
        said, key = divided(heard, listens and item.get("dtmfterm") != "false")
        if heard.recognised:
            return said, key, heard
        if key:
            taken = replace(heard, utterance=key, interpretation=key, confidence=1.0, mode="dtmf")
            return said, key, taken
        if listens:
            said, heard = self._ended(context, heard)
        return said, "", heard

    def _ended(self, context: Context, heard: TakenUtterance) -> tuple[str, TakenUtterance]:
        """What was recorded until a key that a grammar takes, and that key; else all of it."""
        said, key = divided(heard, ends=True)
        taken = self.inputs.hear(context, [Hypothesis(key, 1.0)]) if said and key else None
        if taken is None:
            return heard.utterance.strip(), heard
        return said, replace(taken, mark=heard.mark, marktime=heard.marktime)

    def broken_off(self, context: Context, item: Node, event: Event) -> None:
        """Keep what was recorded until the user hung up."""
        said = str(event.data.get("recorded", ""))
        if said:
            self._fill(context, item, said, event.data, {"maxtime": False, "termchar": None})

    def _fill(
        self, context: Context, item: Node, said: str, data: Data, more: dict[str, Json]
    ) -> None:
        ms = self.shared.keep_recording(said, data.get("duration"))
        size = data.get("size", len(said.encode()))
        shadow = {"duration": ms, "size": size, **more}
        self.items.fill(context, item, said, shadow)
        self.items.leave_initial(context)


def divided(heard: TakenUtterance, ends: bool) -> tuple[str, str]:
    """Divide an utterance into the words recorded and the keys that ended them, if any may."""
    text = heard.utterance.strip()
    if heard.recognised and heard.mode == "dtmf":
        return "", text
    if heard.recognised or not ends:
        return text, ""
    if set(text) <= KEYS:
        return "", text[:1]
    if text[-1:] in END_KEYS:
        return text[:-1].strip(), text[-1]
    return text, ""
