"""What is said: prompts, their markup, and Commands of the robot among them (VoiceXML 2.0, 4.1)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from prima.commands import TABLE_4_2
from prima.interpreter.content import MAX_REPEATS, MAX_TEXT, source
from prima.interpreter.expressions import Scope, ScriptError
from prima.markup.tree import Node
from prima.messages import Command, Json
from prima.values import shown
from prima.voicexml.state import Context, Thrown
from prima.voicexml.vocabulary import PRIMA_NAMESPACE

if TYPE_CHECKING:
    from prima.voicexml.machine import Machine

SPOKEN = frozenset(
    [
        "audio",
        "value",
        "enumerate",
        "prompt",
        "break",
        "emphasis",
        "mark",
        "phoneme",
        "prosody",
        "say-as",
        "sub",
        "voice",
        "p",
        "s",
        "paragraph",
        "sentence",
    ]
)
"""Elements that are said; all but ``prompt`` are a prompt even without one around (4.1.2)."""
SILENT = frozenset(["break", "lexicon", "metadata", "meta", "desc"])
SHOWN = """function (v) { return v === undefined ? 'undefined'
  : v !== null && v.nodeType !== undefined ? v.textContent : v; }""".replace("\n", "")
"""What is said of a value in the engine: of a node of ``data`` its text."""
APART = frozenset(["p", "s", "paragraph", "sentence"])


@dataclass(slots=True)
class Speech:
    """What has been read of a prompt and not been queued yet."""

    lang: str
    place: str
    parts: list[str] = field(default_factory=list)

    def take(self) -> str:
        """The text so far, white space folded; nothing of it is left."""
        text = " ".join("".join(self.parts).split())[:MAX_TEXT]
        self.parts.clear()
        return text


class Speaker:
    """Evaluates expressions, and reads prompts for their words."""

    def __init__(self, owner: Machine) -> None:
        self.owner = owner
        self.engine = owner.engine
        self.mark: str | None = None
        """The last mark of what is queued (VoiceXML 2.1, 3)."""

    # Expressions ------------------------------------------------------------------

    def failure(self, error: ScriptError, node: Node, attribute: str) -> Thrown:
        """``error.semantic`` with the place of what failed (5.2.6)."""
        place = node.code_place(attribute, error.line, error.column)
        where = f"{place.file.rpartition('/')[2]}:{place.line}"
        code = node.get(attribute) if attribute else node.tag
        return Thrown("error.semantic", f"{where}: {code.strip()[:80]}: {error}", where)

    def value(self, node: Node, attribute: str, context: Context, local: Scope) -> Json:
        """An attribute's expression as plain data."""
        try:
            return self.engine.value(node.get(attribute), context.scopes(local))
        except ScriptError as error:
            raise self.failure(error, node, attribute) from None

    def holds(self, node: Node, context: Context, local: Scope) -> bool:
        """An element's condition; one without holds."""
        if "cond" not in node.attributes:
            return True
        try:
            return self.engine.condition(node.get("cond"), context.scopes(local))
        except ScriptError as error:
            raise self.failure(error, node, "cond") from None

    def word(self, node: Node, name: str, context: Context, local: Scope) -> str:
        """An attribute, or its ``expr`` form, as a word."""
        dynamic = {"next": "expr", "nextitem": "expritem"}.get(name, f"{name}expr")
        if name in node.attributes:
            return node.get(name)
        if dynamic not in node.attributes:
            return ""
        return shown(self.value(node, dynamic, context, local))

    def elements(self, node: Node, context: Context, local: Scope) -> list[Json]:
        """The elements of a foreach's array, as the engine's values."""
        try:
            found = self.engine.elements(node.get("array"), context.scopes(local), MAX_REPEATS)
        except ScriptError as error:
            raise self.failure(error, node, "array") from None
        for _ in found:
            self.owner.count_step(node)
        return found

    # Prompts ------------------------------------------------------------------------

    def prompt(self, node: Node, context: Context, local: Scope) -> None:
        """Queue a prompt in executable content (4.1)."""
        if self.holds(node, context, local):
            said = self.spoken(node, context, local)
            self.owner.say(said, self.lang(node, context), source(node), node)

    @staticmethod
    def lang(node: Node, context: Context) -> str:
        """The language of a prompt: its own, or its document's."""
        return node.get("xml:lang") or context.page.lang

    def spoken(self, node: Node, context: Context, local: Scope) -> str:
        """What an element says, as text: SSML is read for its words (4.1.1).

        What stands before a Command, or is of another language, has been queued already.
        """
        speech = Speech(self.lang(node, context), source(node))
        for item in [node] if node.tag in SPOKEN - {"prompt"} else node.content:
            self.read(item, context, local, speech)
        return speech.take()

    def inner(self, node: Node, context: Context, local: Scope) -> str:
        """What an element's content says, as text alone."""
        speech = Speech(self.lang(node, context), source(node))
        self.read_all(node, context, local, speech)
        return "".join(speech.parts)

    def flush(self, speech: Speech) -> None:
        """Queue what has been read."""
        self.owner.say(speech.take(), speech.lang, speech.place)

    def read_all(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """Read an element's content."""
        for item in node.content:
            self.read(item, context, local, speech)

    def read(self, item: Node | str, context: Context, local: Scope, speech: Speech) -> None:
        """Read a piece of a prompt."""
        if isinstance(item, str):
            speech.parts.append(item)
            return
        self.owner.count_step(item)
        lang = item.get("xml:lang")
        if item.namespace == PRIMA_NAMESPACE:
            self.flush(speech)
            self.owner.queue.append(self.command(item, context, local, speech.lang))
        elif lang and lang != speech.lang:
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
                speech.parts.append(self.text(node, context, local))
            case "audio":
                self.audio(node, context, local, speech)
            case "sub":
                speech.parts.append(f" {node.get('alias') or node.text} ")
            case "mark":
                self.mark = self.word(node, "name", context, local)
                speech.parts.append(" ")
            case tag if tag in SILENT:
                speech.parts.append(" ")
            case "enumerate":
                speech.parts.append(self.owner.enumeration(node, context, local))
            case "foreach":
                for element in self.elements(node, context, local):
                    self.engine.put(local, node.get("item"), element)
                    speech.parts.append(" ")
                    self.read_all(node, context, local, speech)
            case tag if tag in APART:
                speech.parts.append(" ")
                self.read_all(node, context, local, speech)
                speech.parts.append(" ")
            case _:
                self.read_all(node, context, local, speech)

    def text(self, node: Node, context: Context, local: Scope) -> str:
        """What a value says (4.1.4)."""
        code, scopes = node.get("expr"), context.scopes(local)
        try:
            self.engine.compile(code)  # what does not compile is told by its own place
            return self.engine.text(f"({SHOWN})({code}\n)", scopes)
        except ScriptError as error:
            raise self.failure(error, node, "expr") from None

    def audio(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """A recording: its text if it has one, else what it is called (4.1.3)."""
        name = node.get("src")
        if "expr" in node.attributes:
            uri = self.value(node, "expr", context, local)
            if uri is None:
                return  # an undefined one is not said at all, nor is what it holds
            name = shown(uri)
        speech.parts.append(" ")
        if node.text or node.nodes:
            self.read_all(node, context, local, speech)
        else:
            speech.parts.append(f"[{name.rpartition('/')[2]}]")
        speech.parts.append(" ")

    # Commands of the robot ---------------------------------------------------------------

    def command(self, node: Node, context: Context, local: Scope, lang: str = "") -> Command:
        """A Command of PRIMA's namespace among executable content."""
        name = node.get("type") if node.tag == "command" else node.tag
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
        said = " ".join(self.inner(node, context, local).split())[:MAX_TEXT] or None
        self.owner.count_output(len(said or ""), node)
        return Command(name, args, said, lang=lang or context.page.lang, source=source(node))
