"""Questions: playing prompts, waiting for input, and processing it (VoiceXML 2.0, 4.1)."""

from __future__ import annotations

from collections.abc import Iterator

from prima.interpreter.places import source
from prima.interpreter.transfers import Thrown
from prima.language.values import milliseconds
from prima.markup.tree import Node
from prima.messages import Command, Cue, Data, Json
from prima.messages import Heard as Spoken
from prima.voicexml.inputs import Inputs
from prima.voicexml.items import Items
from prima.voicexml.recorder import RecordItems
from prima.voicexml.settings import answering, setting
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context, Flow, Resume, TakenUtterance, thrown_outside


class Questions:
    """Asks the questions of one application."""

    def __init__(
        self, shared: SharedState, inputs: Inputs, items: Items, recorder: RecordItems
    ) -> None:
        self.shared = shared
        self.inputs = inputs
        self.items = items
        self.recorder = recorder

    def ask(self, context: Context, item: Node) -> Flow:
        """Play what is queued, then wait for the user (C4)."""
        shared = self.shared
        # A grammar that cannot be used is reported before anything is said.
        yield from self.inputs.activate(context)
        self.recorder.check(context, item)
        asked = shared.queue.take_last_said()
        question = self._question(context, item, asked)
        if item.tag == "record":
            self.recorder.prepare(item, question)
        shared.heard = None
        self.items.forget_results(context)
        opened = [] if item.tag == "record" else shared.queue.open_to_answers(question)
        resume = yield from shared.wait([*shared.queue.take(), question], opened)
        yield from self._answered(context, item, resume)

    def _question(self, context: Context, item: Node, asked: Command | None) -> Command:
        """The question made of an item's last prompt (4.1.5, 4.1.7)."""
        wanted = self.shared.queue.answering or answering(context)
        timeout, bargein = milliseconds(wanted["timeout"], 5000), wanted["bargein"] != "false"
        cues = self.shared.queue.question_cues(asked)
        cues = (*self._cues(context, item, bargein and wanted["bargeintype"] == "hotword"), *cues)
        own = item.get("xml:lang") if item.tag != "menu" else ""
        lang = asked.lang if asked and asked.lang else own or context.page.lang
        args: dict[str, Json] = {"timeout": f"{timeout}ms", "bargein": bargein}
        text = asked.text if asked else None
        return Command("q-and-a", args, text, lang=lang, source=source(item), cues=cues)

    def _cues(self, context: Context, item: Node, hotword: bool) -> Iterator[Cue]:
        """Cues for listening: what interrupts the question, and how long an answer may be."""
        modes = self.inputs.modes(context)
        longest = milliseconds(setting(context, "maxspeechtimeout"), 0)
        if longest and item.tag != "record" and "voice" in modes:  # a recording has its own maxtime
            yield Cue(0, "longest", longest)
        if hotword:
            yield Cue(0, "hotword")
        elif len(set(modes)) == 1 and item.tag != "record":
            yield Cue(0, "hotword", modes[0])  # other input interrupts nothing

    def _answered(self, context: Context, item: Node, resume: Resume) -> Flow:
        """Process what ended the wait."""
        if resume.event is not None:
            if item.tag == "record":
                self.recorder.broken_off(context, item, resume.event)
            raise thrown_outside(resume)
        outcome = str(resume.data.get("outcome", "noinput"))
        heard = self.shared.heard
        if outcome == "filled" and heard is not None:
            heard.take_mark(resume.data)
            if heard.owner is item and item.tag == "record":
                yield from self.recorder.take(context, item, heard, resume.data)
            else:
                self.items.remember(context, heard)
                yield from self.items.process(context, heard)
            return
        if outcome == "nomatch":
            self._not_taken(context, item, resume.data)
        reason = resume.data.get("message")
        message = f"{source(item)}: {reason}" if reason else ""
        raise Thrown("noinput" if outcome == "filled" else outcome, message, source(item))

    def _not_taken(self, context: Context, item: Node, data: Data) -> None:
        """Set ``application.lastresult$`` for input that no grammar takes (5.1.5).

        Raises:
            Thrown: ``noinput``, if nobody listens to such input (6.3.6).
        """
        (text, sure), *others = Spoken(str(data.get("utterance", "")), data).hypotheses
        noted = self.inputs.noted(context, text)
        if noted is None:
            raise Thrown("noinput", "", source(item))
        said, mode = noted
        further: list[tuple[str, Json, float]] = [(one, one, less) for one, less in others]
        most = self.inputs.most_results(context)
        heard = TakenUtterance(said, said, item, context.page, sure, mode, further[: most - 1])
        heard.mark = self.shared.marked
        heard.take_mark(data)
        self.items.remember(context, heard)
