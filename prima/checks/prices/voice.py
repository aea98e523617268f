"""Prices of a VoiceXML application, and the order of its dialogs."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from prima.checks.prices.commands import command_price, group_price, unit_price
from prima.checks.prices.dialogue import ASKED_AGAIN, OFTEN, QUESTION
from prima.checks.prices.firsts import responds
from prima.checks.prices.model import Gap, Outline, Price, Reaction, State, devices_of
from prima.checks.prices.pages import TARGETS, Pages
from prima.checks.prices.speech import Reader, Said, utterances
from prima.checks.prices.tags import (
    commands_in,
    holders,
    is_foreign,
    leaves,
    returns,
    says,
    thrown_by,
    to_item,
)
from prima.devices.profile import Profile
from prima.devices.voice import duration
from prima.interpreter.selection import takes
from prima.language.commands import TABLE_4_2
from prima.language.values import milliseconds
from prima.markup.tree import Node
from prima.voicexml.arranging import UNIT, arrange, longest_of
from prima.voicexml.calls import CONNECT_MS, kind_of
from prima.voicexml.document import Page, VoiceDocument
from prima.voicexml.elements import HANDLERS, handler_names
from prima.voicexml.events import WORDS
from prima.voicexml.recorder import BEEP_MS
from prima.voicexml.sketch import Sketch
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, SPOKEN

SPEAKER = frozenset({"speaker"})
ASKING = ("field", "initial", "record", "menu")
TIMEOUT_MS = 5000
LISTENING_MS = 600_000
"""How long a question of a call listens at most, before it is asked again."""
AGAIN = (*HANDLERS, "clear", "foreach", "goto", "assign", "script")
"""By what in a unit something in it may be done more than once."""
SILENT_ACTS = ("assign", "var", "log", "script", "clear", "desc")


def outline(document: VoiceDocument, profile: Profile) -> Outline:
    """The outline of a VoiceXML application and its further documents."""
    return _Reader(document, profile).outline()


class _Held:
    """What is directly in an element, found once."""

    def __init__(self, node: Node) -> None:
        self.handlers = node.all(*HANDLERS)
        self.wide = node.all(*HANDLERS, "link")
        self.settings = {one.get("name"): one.get("value") for one in node.all("property")}
        self.units = {
            id(item): unit for unit in node.nodes if unit.key == UNIT for item in unit.nodes
        }


class _Reader:
    def __init__(self, document: VoiceDocument, profile: Profile) -> None:
        self.pages = Pages(document)
        self.profile = profile
        self.page = document.page
        self.said: dict[int, list[Price]] = {}
        """What elements say, and the Commands among it, by the elements' identities."""
        self.thrown = {name for page in self.pages for name in thrown_by(page.root)}
        self.parts: list[Price] = []
        self.states: dict[str, State] = {}
        self.caught: list[tuple[Node, State]] = []
        self.inside: set[int] = set()
        """What stands in units around form items, by the elements' identities."""
        self.held: dict[int, _Held] = {}
        """What has been looked for in elements, by their identities."""
        self.sketch = Sketch(document.page, None)
        for page in self.pages:
            self._say(page)
        for page in self.pages:
            self._read(page)

    def _say(self, page: Page) -> None:
        """What the elements of a document say."""
        self.page = page
        for node in [*page.root.all(*HANDLERS), *page.dialogs.values()]:
            for holder in holders(node):
                self.said[id(holder)] = list(self._own(holder))

    def _read(self, page: Page) -> None:
        """What a document does."""
        self.page, self.sketch = page, Sketch(page, self.pages.root(page))
        units = [one for dialog in page.dialogs.values() for one in dialog.nodes if one.key == UNIT]
        self.inside |= {id(node) for unit in units for node in unit.walk()}
        for name, dialog in page.dialogs.items():
            self.states[self._key(page, name)] = self._dialog(name, dialog)
        for node in page.root.all(*HANDLERS):
            self._catch(node, State("", node))
        for node in page.root.all("property"):
            self.parts += self._waiting(node, node.get("value"), node.get("name"))

    @staticmethod
    def _key(page: Page, name: str) -> str:
        return f"{page.uri}#{name}"

    def outline(self) -> Outline:
        """All that is known of the application."""
        parts = list({(one.node.place, one.what): one for one in self.parts}.values())
        reactions = [
            Reaction(
                tuple(name or "message" for name in names),
                node,
                *self._begins(node, parts),
                state,
                None if leaves(node.content) and not returns(node) else "",
            )
            for node, state in self.caught
            if (names := [name for name in handler_names(node) if is_foreign(name)])
        ]
        return Outline(parts, self.states, reactions, [], [], self.pages.gaps)

    def _begins(self, handler: Node, parts: list[Price]) -> tuple[list[Price], list[Price]]:
        """What a handler does first, and what may come up to its response: anything, perhaps."""
        firsts = self._first(handler) or parts
        until = firsts if all(map(responds, firsts)) else [*firsts, *parts]
        return firsts, until if any(map(responds, until)) else []

    def _first(self, handler: Node) -> list[Price]:
        """What a handler does first, where that is the same in each case; else nothing."""
        for piece in handler.content:
            if isinstance(piece, str) and not piece.strip():
                continue
            if isinstance(piece, Node) and piece.tag in SILENT_ACTS:
                continue
            said = isinstance(piece, str) or piece.tag in SPOKEN
            if said and not (isinstance(piece, Node) and piece.get("cond")):
                return [self._asked_anew(handler)]
            return [] if isinstance(piece, str) else [*self._steps(piece, first=True)]
        return []

    def _asked_anew(self, handler: Node) -> Price:
        """The question that listened, asked from its beginning with what a handler says."""
        lasts = max((one.lasts for one in self.parts if one.listens), default=1)
        return Price(handler, "question", QUESTION.devices, lasts, engages=True)

    # Dialogs ----------------------------------------------------------------------------

    def _dialog(self, name: str, dialog: Node) -> State:
        """What a dialog does, and what answers and its own events lead to."""
        state = State(self._key(self.page, name), dialog)
        items = [dialog] if dialog.tag == "menu" else dialog.nodes
        root = self.pages.root(self.page)
        wider = [self._held(one).wide for one in (self.page.root, *([root.root] if root else ()))]
        for node in chain([dialog], *wider):
            for inner in self._walk(node):
                self._lead(state, inner)
                state.parts += self.said.get(id(inner), ()) if id(inner) not in self.inside else ()
        for item in items:
            self._item(state, item, dialog)
        for node in dialog.walk():
            if node.tag in HANDLERS:
                self._catch(node, state)
        self.parts += state.parts
        return state

    def _walk(self, node: Node) -> Iterator[Node]:
        """An element and what is in it, without handlers that only wait for events from outside."""
        if node.tag == "catch" and all(self._is_outside(name) for name in handler_names(node)):
            return
        yield node
        for inner in node.nodes:
            yield from self._walk(inner)

    def _is_outside(self, name: str) -> bool:
        own = any(takes(name, one) for one in self.thrown) or "" in self.thrown
        return bool(name) and is_foreign(name) and not own

    def _item(self, state: State, item: Node, dialog: Node) -> None:
        """What a form item asks."""
        if item.key == UNIT:
            state.parts.append(self._unit(item, dialog))
        elif item.tag == "transfer":
            state.parts += self._call(item)
        elif item.tag in ASKING:
            asked = self._question(item, dialog)
            state.parts.append(asked)
            if not self._bounded(item, dialog):
                state.repeats.append(Gap(item.place, ASKED_AGAIN))

    def _lead(self, state: State, node: Node) -> None:
        """Where an element leads without a wait for an event."""
        if node.tag in TARGETS:
            target = self.pages.target(self.page, node)
            for name in target.dialogs if target.page else ():
                leads = state.calls if node.tag == "subdialog" else state.goes
                leads[self._key(target.page, name)] = node  # type: ignore[arg-type]
        if node.tag == "foreach":
            state.unknown.append(Gap(node.place, OFTEN))
        if node.tag == "clear" or (node.tag == "goto" and to_item(node)):
            state.repeats.append(Gap(node.place, "items of the dialog are visited again"))

    def _catch(self, node: Node, around: State) -> None:
        """A handler: what it does belongs to a reaction where its event comes from outside."""
        does = State(node.get("event") or node.tag, node)
        for holder in holders(node):
            does.parts += self.said[id(holder)]
        self.parts += does.parts if id(node) not in self.inside else ()
        for inner in node.walk():
            self._lead(does, inner)
        # VoiceXML always asks on: a reaction that stays goes on with its dialog.
        if around.name and not leaves(node.content):
            does.goes.setdefault(around.name, node)
        self.caught.append((node, does))

    def _bounded(self, item: Node, dialog: Node) -> bool:
        """Whether a question is left sooner or later if the user never answers it."""
        scope = [one for node in self._scopes(item, dialog) for one in self._held(node).handlers]
        return all(
            any(
                event in handler_names(one) and not one.get("cond") and leaves(one.content)
                for one in scope
            )
            for event in ("noinput", "nomatch")
        )

    # What is said -----------------------------------------------------------------------

    def _own(self, holder: Node) -> Iterator[Price]:
        """What an element says itself, and the Commands of the robot among it."""
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
        """What an element of PRIMA's namespace asks for; ``first`` for what waits for no other."""
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
        """A unit around form items: its longest duration, and what runs then to its end (U5)."""
        inner = [one for node in holders(unit) for one in self.said[id(node)]]
        asking = unit.all(*ASKING)
        inner += [self._question(item, dialog) for item in asking]
        reach = self.sketch.reach(unit)
        around = [*dialog.all("filled"), *self._handlers(unit, dialog)]
        said = [one for node in around for inner in holders(node) for one in self.said[id(inner)]]
        lasts = longest_of(unit) + max((one.lasts for one in [*inner, *said]), default=0)
        again = any(one.tag in AGAIN for one in unit.walk())
        if not asking and not again and all(one.inside for one in reach.commands):
            lasts = min(lasts, sum(one.lasts for one in inner))
        return unit_price(unit, reach.devices | devices_of(inner), lasts, [*inner, *said])

    def _command(self, node: Node) -> Price:
        """A Command of PRIMA's namespace."""
        name = node.get("type") if node.tag == "command" else node.tag
        row = self.profile.commands.get(name) or TABLE_4_2.get(name)
        args: dict[str, object | None] = {}
        for key, text in node.attributes.items():
            bare = key.removesuffix("-expr")
            if row is not None and bare in row.arguments:
                args[bare] = text if bare == key else None
        for param in node.all("param"):
            args[param.get("name")] = param.attributes.get("value")
        pieces = [one for one in node.content if isinstance(one, str) or one.tag != "param"]
        said = self._read_aloud(node, pieces, None) if says(pieces) else None
        return command_price(node, name, args, said, self.profile)

    def _read_aloud(
        self, node: Node, pieces: list[Node | str], menu: Node | None
    ) -> tuple[int, str]:
        page = self.page
        reader = Reader(lambda one, name: self.pages.recording(page, one, name))
        said: Said = reader.read(pieces, node.get("xml:lang") or page.lang, menu)
        return max(said.lasts(self.profile.voices), 1), said.unknown

    def _waiting(self, node: Node, audio: str, name: str = "fetchaudio") -> Iterator[Price]:
        """What is played while something is fetched, or a call is made."""
        if audio and name == "fetchaudio":
            words = f"[{audio.rpartition('/')[2]}]"
            lasts = duration(words, self.page.lang, self.profile.voices)
            yield Price(node, "speak", SPEAKER, lasts)

    # Questions --------------------------------------------------------------------------

    def _question(self, item: Node, dialog: Node) -> Price:
        """A question: the longest that may be said last before it, and the time for an answer."""
        heard = list(self._before(item, dialog))
        usual = milliseconds(self._setting(item, dialog, "timeout"), TIMEOUT_MS)
        stated = [milliseconds(one.node.get("timeout"), usual) for one in heard]
        lasts = max((one.lasts for one in heard), default=0) + max([usual, *stated, 1]) + 1
        if item.tag == "record":
            lasts += milliseconds(item.get("finalsilence"), 0)
            lasts += BEEP_MS if item.get("beep") == "true" else 0
        unknown = next((one.unknown for one in heard if one.unknown), "")
        what = "recording" if item.tag == "record" else "question"
        return Price(item, what, QUESTION.devices, lasts, unknown, engages=True, listens=True)

    def _before(self, item: Node, dialog: Node) -> Iterator[Price]:
        """What may be said last before an item listens: its own prompts, or those of handlers."""
        own = [one for one in self.said[id(item)] if one.what == "speak"]
        yield from own
        first = [
            one for one in own if not one.node.get("cond") and one.node.get("count", "1") == "1"
        ]
        for node in [dialog] if not first else self._handlers(item, dialog):
            for holder in holders(node):
                yield from (one for one in self.said[id(holder)] if one.what == "speak")
        if not first:
            for node in self._handlers(item, dialog):
                for holder in holders(node):
                    yield from (one for one in self.said[id(holder)] if one.what == "speak")
        words = WORDS.get(self.page.lang.partition("-")[0].lower(), {})
        longest = max(words.values(), key=len, default="")
        yield Price(item, "speak", SPEAKER, duration(longest, self.page.lang, self.profile.voices))

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
        """What is directly in an element."""
        if id(node) not in self.held:
            self.held[id(node)] = _Held(node)
        return self.held[id(node)]

    def _call(self, item: Node) -> Iterator[Price]:
        """A call to somebody else: as long as it lasts the robot listens for the user's end of it."""
        kind = kind_of(item)
        if kind == "blind" or not item.all("grammar"):
            return
        said = max((one.lasts for one in self.said[id(item)]), default=0)
        connect = milliseconds(item.get("connecttimeout"), CONNECT_MS)
        longest = milliseconds(item.get("maxtime"), 0) if kind == "bridge" else 1
        lasts = max(min(connect, LISTENING_MS) + said, min(longest or LISTENING_MS, LISTENING_MS))
        yield Price(item, "call", QUESTION.devices, lasts, engages=True, listens=True)
