"""Calls to somebody else: transfers of the caller (VoiceXML 2.0, 2.3.7; 2.1, 9)."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

from prima.interpreter.places import source
from prima.interpreter.transfers import GoOut, Thrown
from prima.language.values import milliseconds
from prima.markup.tree import Node
from prima.messages import Command, Cue, Data, Json, Transferred
from prima.voicexml.content import Content
from prima.voicexml.inputs import Inputs
from prima.voicexml.items import Items
from prima.voicexml.platform import uncalled
from prima.voicexml.results import marked_and_recorded
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context, Flow, HungUp, Resume, TakenUtterance, thrown_outside

CONNECT_MS = 60_000
"""The default of ``connecttimeout``: how long it may take until somebody answers."""
LISTEN = "20s"
"""How long each of the repeated questions during a call listens."""
ANSWERED, NEAR_END = "answered", "near_end_disconnect"


@dataclass(slots=True)
class Call:
    """A call in progress."""

    item: Node
    to: str
    kind: str
    """``bridge``, ``blind`` or ``consultation``."""
    serial: int = 0
    heard: TakenUtterance | None = None
    """The utterance by which the caller ended it."""
    connected: int | None = None
    """When somebody has answered (ms)."""
    given_up: bool = False
    """Whether a time limit of the transfer has passed."""

    @property
    def listens(self) -> bool:
        """Whether the caller may end it by an utterance that a grammar of the transfer takes."""
        return self.kind != "blind" and bool(self.item.all("grammar"))


class Calls:
    """Makes the calls of one application."""

    def __init__(self, shared: SharedState, content: Content, inputs: Inputs, items: Items) -> None:
        self.shared = shared
        self.content = content
        self.inputs = inputs
        self.items = items
        self.app = shared.app

    def transfer(self, context: Context, item: Node) -> Flow:
        """Visit a transfer: give its variable the call's outcome, or throw an event.

        Raises:
            Thrown: ``connection.disconnect.transfer`` where the caller is given away,
                ``connection.disconnect.hangup`` where they hang up, ``error.connection`` and
                ``error.unsupported`` as the platform reports them (2.3.7.3).
        """
        content, nothing = self.content, self.shared.engine.nothing
        if self.shared.gone:
            raise GoOut(self.shared.gone)
        call = Call(item, content.word(item, "dest", context, nothing), kind_of(item))
        aai = content.word(item, "aai", context, nothing)
        if (refused := uncalled(call.to)) is not None:
            raise Thrown.at(item, *refused)
        if call.listens:
            yield from self.inputs.activate(context)
        self.items.forget_results(context)
        yield from self._announce(context, call)
        outcome = NEAR_END
        if call.heard is None:
            outcome = yield from self._connected(context, call, aai)
        if outcome.startswith("error."):
            raise Thrown.at(item, outcome, call.to)
        gives_away = call.kind == "blind" or (call.kind == "consultation" and outcome == ANSWERED)
        if gives_away and call.heard is None:
            raise HungUp("connection.disconnect.transfer", "", source(item))
        yield from self._ended(context, call, outcome)

    def _ended(self, context: Context, call: Call, outcome: str) -> Flow:
        """Fill the item's variable (2.3.7.2.2)."""
        lasted = 0 if call.connected is None else self.app.now - call.connected
        shadow: dict[str, Json] = {"duration": lasted / 1000}
        if call.heard is not None:
            self.items.remember(context, call.heard)
            shadow |= {"inputmode": call.heard.mode, "utterance": call.heard.utterance}
            shadow |= marked_and_recorded(call.heard)
        self.items.fill(context, call.item, outcome, shadow)
        yield from self.items.run_filled(context, [call.item])

    # Before the call ------------------------------------------------------------------

    def _announce(self, context: Context, call: Call) -> Flow:
        """Play what is queued; an utterance that a grammar takes meanwhile prevents the call."""
        queue = self.shared.queue
        if not queue:
            return
        opened: list[Command] = []
        last = queue.take_last_said() if call.listens else None
        if last is not None:
            last.cues = queue.question_cues(last)
            question = self._question(context, call, "1ms", last)
            question.args["bargein"] = bool(last.hook)
            opened = queue.open_to_answers(question)
            queue.put(question)
        self.shared.heard = None
        resume = yield from self.shared.waits.wait(queue.take(), opened)
        self._note(call, resume)

    def _question(
        self, context: Context, call: Call, timeout: str, said: Command | None = None
    ) -> Command:
        """A question that only the transfer's own grammars end."""
        cues = (Cue(0, "hotword"), *(said.cues if said is not None else ()))
        return Command(
            "q-and-a",
            {"timeout": timeout, "bargein": True},
            said.text if said is not None else None,
            lang=said.lang if said is not None else context.page.lang,
            source=source(call.item),
            cues=cues,
        )

    def _note(self, call: Call, resume: Resume) -> None:
        """Note what ended a wait: an event, or the caller's words."""
        if resume.event is not None:
            raise thrown_outside(resume)
        if resume.data.get("outcome") == "filled":
            call.heard = self.shared.heard
            if call.heard is not None:
                call.heard.take_mark(resume.data)

    # The call -------------------------------------------------------------------------

    def _connected(self, context: Context, call: Call, aai: str) -> Generator[None, Resume, str]:
        """Make the call and wait for its end; gives its outcome."""
        item = call.item
        connect = milliseconds(item.get("connecttimeout"), CONNECT_MS)
        longest = milliseconds(item.get("maxtime"), 0) if call.kind == "bridge" else 0
        data: dict[str, Json] = {"transfer": call.kind, "params": {"aai": aai} if aai else {}}
        late = Transferred(self.app.name, 0, call.to, "noanswer")
        self.shared.waits.ask(call.to, data, late, connect, item)
        call.serial = late.serial
        try:
            outcome = yield from self._wait(context, call, self._audio(context, call))
            if outcome == ANSWERED and call.kind == "bridge" and call.heard is None:
                call.connected = self.app.now
                late = Transferred(self.app.name, call.serial, call.to, "maxtime_disconnect")
                self.shared.waits.expect(late, longest or None)
                outcome = yield from self._wait(context, call, None)
        except Thrown as thrown:
            self._over(call, thrown.name)
            raise
        finally:
            self.shared.waits.expect_nothing()
        if call.heard is not None or (call.given_up and call.kind != "blind"):
            self._over(call, outcome)
        return outcome

    def _over(self, call: Call, outcome: str) -> None:
        """Report that this side has ended the call."""
        data: Data = {"transfer": "over", "call": call.serial, "outcome": outcome}
        self.app.send(call.to, data, source(call.item))

    def _audio(self, context: Context, call: Call) -> Command | None:
        """The audio that the caller hears until somebody answers."""
        name = call.item.get("transferaudio")
        if not name or call.kind == "blind":
            return None
        text = f"[{name.rpartition('/')[2]}]"
        self.app.count_output(len(text), call.item)
        return Command("speak", text=text, lang=context.page.lang, source=source(call.item))

    def _wait(
        self, context: Context, call: Call, audio: Command | None
    ) -> Generator[None, Resume, str]:
        """Wait for news of the call, or for the caller to end it by voice."""
        while True:
            commands = [audio] if audio is not None else []
            if call.listens:
                commands = [self._question(context, call, LISTEN, audio)]
            self.shared.heard, audio = None, None
            found = yield from self.shared.waits.answer_or_input(commands)
            if isinstance(found, Transferred):
                call.given_up = self.shared.waits.overdue
                return found.outcome
            if isinstance(found, Resume):
                self._note(call, found)
            if call.heard is not None:
                return NEAR_END


def kind_of(item: Node) -> str:
    """The type of a transfer, from ``type`` or the older attribute; blind by default."""
    return item.get("type") or ("bridge" if item.get("bridge") == "true" else "blind")
