"""Prices of speech and questions of VoiceXML elements."""

from __future__ import annotations

from collections.abc import Iterator

from prima.checks.prices.commands import command_price, group_price, unit_price
from prima.checks.prices.model import Price, devices_of
from prima.checks.prices.pages import PricedPages
from prima.checks.prices.speech import Said, SpeechReader, utterances
from prima.checks.prices.tags import commands_in, holders, says
from prima.checks.prices.times import QUESTION
from prima.devices.profile import Profile
from prima.devices.voice import duration
from prima.interpreter.acts import arrange
from prima.language.commands import TABLE_4_2
from prima.language.values import milliseconds
from prima.markup.tree import Node
from prima.voicexml.arranging import UNIT, arguments_of, longest_of, parts_of, type_of
from prima.voicexml.calls import CONNECT_MS, kind_of
from prima.voicexml.document import VoiceDocument
from prima.voicexml.elements import HANDLERS
from prima.voicexml.platform import own_words
from prima.voicexml.recorder import BEEP_MS
from prima.voicexml.sketch import ASKING, Sketch
from prima.voicexml.vocabulary import PRIMA_NAMESPACE

SPEAKER = frozenset({"speaker"})
TIMEOUT_MS = 5000
LISTENING_MS = 600_000
"""How long a question during a call listens at most, before it is repeated."""
AGAIN = (*HANDLERS, "clear", "foreach", "goto", "assign", "script")
"""Elements by which something in a unit may run more than once."""


class _Held:
    """The direct content of an element, found once."""

    def __init__(self, node: Node) -> None:
        self.handlers = node.all(*HANDLERS)
        self.wide = node.all(*HANDLERS, "link")
        self.settings = {one.get("name"): one.get("value") for one in node.all("property")}
        self.units = {
            id(item): unit for unit in node.nodes if unit.key == UNIT for item in unit.nodes
        }


class VoiceTimes:
    """How long speech, Commands, questions, units and calls may last."""

    def __init__(self, document: VoiceDocument, profile: Profile) -> None:
        self.pages = PricedPages(document)
        self.profile = profile
        self.page = document.page
        self.said: dict[int, list[Price]] = {}
        """The speech of elements, and the Commands in it, by the elements' identities."""
        self.held: dict[int, _Held] = {}
        """Cached direct content of elements, by their identities."""
        self.sketch = Sketch(document.page, None)

    def _own(self, holder: Node) -> Iterator[Price]:
        """The speech of an element itself, and the Commands of the robot in it."""
        menu = holder if holder.tag in ("menu", "field") else None
        for node, pieces in utterances(holder):
            said = self._read_aloud(node, pieces, menu)
            yield Price(node, "speak", SPEAKER, said[0], said[1])
            for piece in pieces:
                for one in commands_in(piece) if isinstance(piece, Node) else ():
                    yield from self._steps(one)
        for node in holder.nodes:
            yield from self._steps(node) if node.key != UNIT else ()
            audio = node.get("fetchaudio") or node.get("transferaudio")
            yield from self._waiting(node, audio)

    def _steps(self, node: Node, first: bool = False) -> Iterator[Price]:
        """The requests of an element of PRIMA's namespace; ``first``: of the initial ones."""
        if node.namespace == PRIMA_NAMESPACE and node.tag != "param":
            for price, after in arrange([node], self._step):
                if not (first and after):
                    yield price

    def _step(self, node: Node) -> Price:
        """A Command, or a unit of them (U4)."""
        if node.tag != "iu":
            return self._command(node)
        steps = arrange(node.nodes, self._step)
        inner, afters = [one for one, _ in steps], [one for _, one in steps]
        return group_price(node, longest_of(node), inner, afters)

    def _unit(self, unit: Node, dialog: Node) -> Price:
        """A unit around form items: its longest duration, and what then runs to its end (U5)."""
        asking = unit.all(*ASKING)
        inner = self._all_said([unit]) + [self._question(item, dialog) for item in asking]
        reach = self.sketch.reach(unit)
        said = self._all_said([*dialog.all("filled"), *self._handlers(unit, dialog)])
        lasts = longest_of(unit) + max((one.lasts for one in [*inner, *said]), default=0)
        again = any(one.tag in AGAIN for one in unit.walk())
        if not asking and not again and all(one.inside for one in reach.commands):
            lasts = min(lasts, sum(one.lasts for one in inner))
        return unit_price(unit, reach.devices | devices_of(inner), lasts, [*inner, *said])

    def _all_said(self, nodes: list[Node]) -> list[Price]:
        """The speech of elements and all their content."""
        return [one for node in nodes for inner in holders(node) for one in self.said[id(inner)]]

    def _command(self, node: Node) -> Price:
        """A Command of PRIMA's namespace."""
        name = type_of(node)
        args = arguments_of(node, self.profile.commands.get(name) or TABLE_4_2.get(name))
        pieces = [one for one in node.content if isinstance(one, str) or one.tag != "param"]
        said = self._read_aloud(node, pieces, None) if says(pieces) else None
        return command_price(node, name, args, said, self.profile)

    def _read_aloud(
        self, node: Node, pieces: list[Node | str], menu: Node | None
    ) -> tuple[int, str]:
        page = self.page
        reader = SpeechReader(lambda name: self.pages.recording(page, name))
        said: Said = reader.read(pieces, node.get("xml:lang") or page.lang, menu)
        return max(said.lasts(self.profile.voices), 1), said.unknown

    def _waiting(self, node: Node, audio: str, name: str = "fetchaudio") -> Iterator[Price]:
        """The audio played while something is fetched, or a call is made."""
        if audio and name == "fetchaudio":
            words = f"[{audio.rpartition('/')[2]}]"
            lasts = duration(words, self.page.lang, self.profile.voices)
            yield Price(node, "speak", SPEAKER, lasts)

    # Questions --------------------------------------------------------------------------

    def _question(self, item: Node, dialog: Node) -> Price:
        """A question: the longest speech that may precede it, and the time for an answer."""
        heard = list(self._before(item, dialog))
        places = [item] if self._speaks_first(item) else [dialog, *parts_of(dialog)]
        usual = max(
            milliseconds(self._setting(one, dialog, "timeout"), TIMEOUT_MS) for one in places
        )
        stated = [milliseconds(one.node.get("timeout"), usual) for one in heard]
        lasts = max((one.lasts for one in heard), default=0) + max([usual, *stated, 1]) + 1
        if item.tag == "record":
            lasts += milliseconds(item.get("finalsilence"), 0)
            lasts += BEEP_MS if item.get("beep") == "true" else 0
        unknown = next((one.unknown for one in heard if one.unknown), "")
        what = "recording" if item.tag == "record" else "question"
        return Price(item, what, QUESTION.devices, lasts, unknown, engages=True, listens=True)

    def _before(self, item: Node, dialog: Node) -> Iterator[Price]:
        """Speech that may come last before an item listens: of its own prompts or handlers."""
        yield from self._spoken(item)
        around = self._handlers(item, dialog)
        for node in around if self._speaks_first(item) else [dialog, *around]:
            for holder in holders(node):
                yield from self._spoken(holder)
        words = own_words(self.page.lang)
        longest = max(words.values(), key=len, default="")
        yield Price(item, "speak", SPEAKER, duration(longest, self.page.lang, self.profile.voices))

    def _speaks_first(self, item: Node) -> bool:
        """Whether a prompt of an item is always said before its question, at its first visit."""
        return any(
            not one.node.get("cond") and one.node.get("count", "1") == "1"
            for one in self._spoken(item)
        )

    def _spoken(self, holder: Node) -> list[Price]:
        return [one for one in self.said[id(holder)] if one.what == "speak"]

    def _handlers(self, item: Node, dialog: Node) -> list[Node]:
        """The handlers in an item's scope that its document holds."""
        return [
            one
            for node in self._scopes(item, dialog)
            for one in self._held(node).handlers
            if id(one) in self.said
        ]

    def _scopes(self, item: Node, dialog: Node) -> list[Node]:
        root = self.pages.root(self.page)
        unit = self._held(dialog).units.get(id(item))
        found = [
            item,
            *([unit] if unit else []),
            dialog,
            self.page.root,
            *([root.root] if root else []),
        ]
        return list({id(node): node for node in found}.values())

    def _setting(self, item: Node, dialog: Node, name: str) -> str:
        """A property's value, from the innermost element that sets it."""
        for node in self._scopes(item, dialog):
            if name in self._held(node).settings:
                return self._held(node).settings[name]
        return ""

    def _held(self, node: Node) -> _Held:
        """An element's own content, without its descendants'."""
        if id(node) not in self.held:
            self.held[id(node)] = _Held(node)
        return self.held[id(node)]

    def _call(self, item: Node) -> Iterator[Price]:
        """A call to somebody else: throughout it the robot listens for the user to end it."""
        kind = kind_of(item)
        if kind == "blind" or not item.all("grammar"):
            return
        said = max((one.lasts for one in self.said[id(item)]), default=0)
        connect = milliseconds(item.get("connecttimeout"), CONNECT_MS)
        longest = milliseconds(item.get("maxtime"), 0) if kind == "bridge" else 1
        lasts = max(min(connect, LISTENING_MS) + said, min(longest or LISTENING_MS, LISTENING_MS))
        yield Price(item, "call", QUESTION.devices, lasts, engages=True, listens=True)
