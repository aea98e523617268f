"""Speech: prompts, their markup, and Commands of the robot among them (VoiceXML 2.0, 4.1)."""

from __future__ import annotations

from collections.abc import Callable
from urllib.parse import urldefrag

from prima.interpreter.acts import arrange, type_of
from prima.interpreter.places import source
from prima.interpreter.transfers import Thrown
from prima.interpreter.units import ARRANGING
from prima.language.commands import TABLE_4_2
from prima.markup.tree import Node
from prima.messages import Command, Cue, Group, Json, Step
from prima.script.evaluation import Scope
from prima.voicexml.arranging import Arranged, longest_of
from prima.voicexml.cues import MAX_NAME
from prima.voicexml.document import FetchError, Page, of_web
from prima.voicexml.elements import numbered, says_instead, words_of
from prima.voicexml.evaluating import WORD, VoiceEvaluator
from prima.voicexml.platform import NO_CHOICES
from prima.voicexml.settings import answering, setting
from prima.voicexml.shared import SharedState
from prima.voicexml.speech import Speech, language_of, read_markup
from prima.voicexml.state import Context
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, SPOKEN

UNKNOWN_MS = 1000
"""The duration assumed for a recording that cannot be read and has no text (4.1.3)."""
MAX_KNOWN = 1000
"""Maximum number of recordings whose length is cached."""


Maker = Callable[[Node], Command]
"""Makes a Command from its element."""


class Speaker(VoiceEvaluator):
    """Reads prompts for their words."""

    def __init__(self, shared: SharedState) -> None:
        super().__init__(shared)
        self._known: dict[str, int | None] = {}

    def prompt(self, node: Node, context: Context, local: Scope) -> None:
        """Queue a prompt in executable content (4.1)."""
        if self.holds(node, context, local):
            self.utter(node, context, local)

    def utter(self, node: Node, context: Context, local: Scope) -> None:
        """Queue a prompt's speech without checking its condition."""
        self.flush(self.read_whole(node, context, local), node)
        self.note_bargein(context, node.get("bargein"))

    def note_bargein(self, context: Context, own: str = "") -> None:
        """Note whether the user may break in on what has just been queued (4.1.5, 6.3.2).

        ``own`` is the prompt's attribute.
        """
        self.shared.queue.note_bargein((own or setting(context, "bargein")) != "false")

    @staticmethod
    def lang(node: Node, context: Context) -> str:
        """The language of a prompt: its own, or its document's."""
        return node.get("xml:lang") or context.page.lang

    def read_whole(self, node: Node, context: Context, local: Scope) -> Speech:
        """Read a spoken element; gives the part that has not been queued."""
        speech = Speech(self.lang(node, context), source(node), base=node.get("xml:base"))
        for item in [node] if node.tag in SPOKEN - {"prompt"} else node.content:
            self.read(item, context, local, speech)
        return speech

    def flush(self, speech: Speech, prompt: Node | None = None) -> None:
        """Queue what has been read, of a prompt or between prompts."""
        text, cues = speech.take()
        self.shared.app.count_output(len(text), self.shared.document.node)
        self.say(text, speech.lang, speech.place, cues, prompt)

    def say(
        self,
        text: str,
        lang: str,
        place: str,
        cues: tuple[Cue, ...] = (),
        prompt: Node | None = None,
    ) -> None:
        """Queue speech, and how it may be answered."""
        context, queue = self.shared.context, self.shared.queue
        if context is not None and (prompt is not None or text):
            queue.answering = answering(context, prompt)
        queue.say(text, lang, place, cues)

    def read_all(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """Read an element's content."""
        for item in node.content:
            self.read(item, context, local, speech)

    def read(self, item: Node | str, context: Context, local: Scope, speech: Speech) -> None:
        """Read a piece of a prompt."""
        if isinstance(item, str):
            speech.parts.append(item)
            return
        self.shared.app.count_step(item)
        lang = language_of(item, speech.lang)
        if item.namespace == PRIMA_NAMESPACE:
            self.flush(speech)
            self.enqueue(item, context, local, speech.lang)
        elif lang != speech.lang:
            self.flush(speech)
            before, speech.lang = speech.lang, lang
            self.read_element(item, context, local, speech)
            self.flush(speech)
            speech.lang = before
        else:
            self.read_element(item, context, local, speech)

    def read_element(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """Read one element of a prompt."""
        match node.tag:
            case "value":
                text = self.text(node, context, local)
                self.shared.app.count_output(len(text), node)
                speech.parts.append(text)
            case "audio":
                self.audio(node, context, local, speech)
            case "mark":
                self.mark_here(node, context, local, speech)
            case "enumerate":
                self.enumeration(node, context, local, speech)
            case "foreach":
                self.read_each(node, context, local, speech)
            case _:
                read_markup(node, speech, lambda: self.read_all(node, context, local, speech))

    def enumeration(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """Read an enumerate: each choice, in its own words (2.2.4)."""
        owner = context.item if context.item is not None else context.form
        choices = owner.all("choice", "option") if owner is not None else []
        if owner is None or not choices or _holds_enumerate(node):
            raise Thrown.at(node, *NO_CHOICES)
        keys = numbered(owner)
        if not node.content:
            speech.parts.append("; ".join(filter(None, map(words_of, choices))))
            return
        for choice in choices:
            self.engine.set(local, "_prompt", words_of(choice))
            if keys[choice.index] and not choice.all("grammar"):
                self.engine.set(local, "_dtmf", " ".join("".join(keys[choice.index].split())))
            else:
                self.engine.unset(local, "_dtmf")
            self.read_all(node, context, local, speech)
            speech.parts.append(" " if choice is not choices[-1] else "")

    def read_each(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """Read a ``foreach`` once for each element of its array."""
        for element in self.elements(node, context, local):
            self.engine.put(local, node.get("item"), element)
            speech.parts.append(" ")
            self.read_all(node, context, local, speech)

    def mark_here(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """Set a mark that is reported when passed (VoiceXML 2.1, 4)."""
        name = self.word(node, "name", context, local)[:MAX_NAME]
        self.shared.app.count_output(len(name), node)
        speech.parts.append(" ")
        if not speech.silent:
            self.shared.mark = name
            speech.parts += [Cue(0, "mark", name), " "]

    def audio(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """Read a recording: its text if it has one, else its name (4.1.3).

        A recording of the application's folder takes its own time, whatever its text.
        """
        name = node.get("src")
        if "expr" in node.attributes:
            uri = self.said(node, "expr", WORD, context, local)
            if uri is None:
                return  # neither an undefined one nor its content is played
            name = str(uri)
            ms = self.shared.lengths.get(name)
            if ms is not None:  # a record's recording is played back as its words (2.3.6)
                opened = speech.open(ms)
                speech.parts += [Cue(0, "sound", name), f" {name} "]
                speech.close(opened)
                return
        ms = self.recording(context.page, speech.base, name, node)
        speech.parts.append(" ")
        if says_instead(node):
            silent, speech.silent = speech.silent, speech.silent or ms is not None
            opened = speech.open(ms)
            self.read_all(node, context, local, speech)
            speech.close(opened)
            speech.silent = silent
        else:
            opened = speech.open(UNKNOWN_MS if ms is None else ms)
            speech.parts.append(f"[{name.rpartition('/')[2]}]")
            speech.close(opened)
        speech.parts.append(" ")

    def recording(self, page: Page, base: str, name: str, node: Node) -> int | None:
        """How long (ms) a recording of the application's folder plays, if it can be played.

        ``name`` is relative to a prompt's own ``base``, and that to the page's. What a host
        has sent plays no file of the folder.
        """
        if of_web(node.source.file):
            return None
        try:
            uri = urldefrag(page.join(page.join(page.base(), base), name))[0]
            if uri not in self._known:
                if len(self._known) >= MAX_KNOWN:
                    self._known.clear()
                self._known[uri] = self.shared.document.recording_ms(uri)
        except (FetchError, ValueError):
            return None
        return self._known[uri]

    # Commands of the robot ---------------------------------------------------------------

    def enqueue(self, node: Node, context: Context, local: Scope, lang: str = "") -> None:
        """Queue a Command of PRIMA's namespace, or several that are arranged."""
        if node.tag not in ARRANGING:
            self.shared.queue.put(self.command(node, context, local, lang))
            return
        steps = self.steps([node], lambda one: self.command(one, context, local, lang))
        if steps:
            self.shared.queue.put(Arranged(steps))

    def steps(self, nodes: list[Node], make: Maker) -> list[Step]:
        """Commands and units of them, one after another but for branches (U3)."""
        made: list[tuple[Command | Group, tuple[int, ...]]] = arrange(
            nodes,
            lambda one: self.unit(one, make) if one.tag == "iu" else make(one),
            self.shared.app.count_step,
        )
        return [Step(what, after) for what, after in made]

    def unit(self, node: Node, make: Maker) -> Group:
        """Commands that are one unit (U4)."""
        steps = self.steps(node.nodes, make)
        return Group(steps, longest_of(node), source(node), node.get("restartable") == "true")

    def command(self, node: Node, context: Context, local: Scope, lang: str = "") -> Command:
        """A Command of PRIMA's namespace among executable content."""
        name = type_of(node)
        row = TABLE_4_2.get(name)
        args: dict[str, Json] = {}
        for key, text in node.attributes.items():
            bare = key.removesuffix("-expr")
            if row is not None and bare in row.arguments:
                args[bare] = text if bare == key else self.value(node, key, context, local)
        for child in node.all("param"):
            args[child.get("name")] = (
                self.value(child, "expr", context, local)
                if "expr" in child.attributes
                else child.get("value")
            )
        speech = Speech(language_of(node, lang or context.page.lang), source(node))
        self.read_all(node, context, local, speech)
        said, cues = speech.take()
        self.shared.app.count_output(len(said), node)
        made = Command(name, args, said or None, row is not None and row.now, lang=speech.lang)
        made.source = source(node)
        return self.shared.queue.cued(made, cues) if said else made


def _holds_enumerate(node: Node) -> bool:
    return any(one.tag == "enumerate" or _holds_enumerate(one) for one in node.nodes)
