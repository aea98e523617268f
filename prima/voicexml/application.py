"""A VoiceXML application as a state machine without I/O or clock, for a session to drive."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

from prima.grammar.answers import Answers
from prima.interpreter.protocol import Answer, App
from prima.interpreter.transfers import GoOut, Thrown
from prima.messages import Command, Data, Event, Hypothesis, Json, Notice, Say, Understood
from prima.messages import Heard as Spoken
from prima.script.isolated import AnyEngine, Engines
from prima.voicexml.document import VoiceDocument
from prima.voicexml.machine import Machine
from prima.voicexml.shared import SharedState
from prima.voicexml.state import SCOPES, Flow, Resume, TakenUtterance, thrown_of_event


class VoiceInterpreter(App[AnyEngine]):
    """Runs one VoiceXML application."""

    def __init__(self, document: VoiceDocument, engines: Engines | None = None) -> None:
        engine = (engines or Engines()).engine(document.id, document.kind, SCOPES)
        super().__init__(document.id, document.kind, engine)
        self._shared = SharedState(self, document)
        self._shared.note_document(document.page)
        self.waits = self._shared.waits
        self._machine = Machine(self._shared)
        self._flow: Flow | None = None
        self._missed: deque[tuple[int, Event]] = deque()
        """Events that arrived while waiting for an answer (4.1.8), and when: none is lost."""

    # Calls from the session ---------------------------------------------------------

    def start(self, now: int) -> None:
        """Begin with the first dialog."""
        self._tick(now)
        self._flow = self._machine.start()
        self._drive(None)

    def takes(self, name: str) -> bool:
        """Whether a handler in scope takes an event of the robot."""
        return self._is_taken(Event(name, 0, shared=True))

    def _is_taken(self, event: Event) -> bool:
        context = self._shared.context  # None while the last queue is played
        return context is not None and self._machine.events.takes(context, thrown_of_event(event))

    def event(self, now: int, event: Event) -> None:
        """Deliver an event: one that a handler in scope takes ends the wait (5.2)."""
        self._tick(now)
        if self._is_deaf(event):
            self._missed.append((now, event))
            if self.waits.run and _hangs_up(event):  # nobody hears the rest (1.5.4)
                self.leave_states()
                self._drive(Resume(event=event, outside=True))
        else:
            self._happened(event)
            self._catch_up()

    def _is_deaf(self, event: Event) -> bool:
        """Whether an event has to wait until something else is waited for (4.1.8)."""
        if self.waits.asked is not None:
            return not (self.waits.calling and _hangs_up(event))
        return self.waits.leaving and not _hangs_up(event)

    def _happened(self, event: Event) -> None:
        if self.over or not (self.waits.run or self.waits.calling):
            return
        if not _hangs_up(event) and not self._is_taken(event):
            if (context := self._shared.context) is not None:
                self._machine.events.count(context, thrown_of_event(event))
            return
        self.waits.cause = event.serial if event.reactive else None
        self._tell(event)
        self.leave_states()
        self._drive(Resume(event=event, outside=True))
        self.waits.cause = None

    def _tell(self, event: Event) -> None:
        """Set ``session.event`` to an event's data: VoiceXML has no variable for it."""
        session = self._shared.session
        self.engine.set(session, "event", {"name": event.name, "data": dict(event.data)})

    def notice(self, now: int, notice: Notice) -> None:
        """The mediator reports what became of Commands."""
        self._tick(now)
        if notice.what == "unit-timeout":
            self._unit_over(notice)
            return
        if self.over or notice.run != self.waits.run or notice.what in ("ended", "interrupted"):
            return
        if notice.what == "failed":
            place = notice.command.source if notice.command else ""
            data = {"message": f"{place}: {notice.message}" if place else notice.message}
            self._drive(Resume(event=Event(notice.event, 0, data, reactive=False)))
        elif notice.what == "done":
            self._drive(Resume(notice.data))
        self._catch_up()

    def _unit_over(self, notice: Notice) -> None:
        """U5: a unit takes too long: end every wait in it."""
        if self.over or notice.run != self.waits.unit:
            return
        self.waits.overrun(notice.message)
        self._drive(Resume())
        self._catch_up()

    def replied(self, now: int, answer: Answer) -> None:
        """The answer to a request; one that comes too late, or twice, is ignored."""
        self._tick(now)
        if self.over or answer.serial != self.waits.asked:
            return
        self.waits.take(answer)
        if self.waits.run and self.waits.patient:
            return
        if self.waits.run:
            self.leave_states()
        self._drive(Resume())
        self._catch_up()

    def sensed(self, now: int, values: Data) -> list[str]:
        """VoiceXML watches no sensors."""
        self._tick(now)
        self.sensors.update(values)
        return []

    def answer(self, run: int, said: Sequence[Hypothesis]) -> Understood | None:
        """How the active grammars interpret what the user said; None if none takes it."""
        context = self._shared.context
        if context is None or run != self.waits.run or self.over:
            return None
        try:
            self._shared.heard = self._machine.inputs.hear(context, said)
        except Thrown:
            return None  # reported when the question was asked
        if self._shared.heard is None and context.item is not None and context.item.tag == "record":
            text, sure = said[0]
            self._shared.heard = TakenUtterance(text, text, context.item, context.page, sure)
            self._shared.heard.recognised = False
        if self._shared.heard is None:
            return None
        self._shared.heard.mark = self._shared.marked
        heard, found = self._shared.heard, self._shared.heard.interpretation
        value = found if found is not None else heard.utterance
        return Understood(value, heard.utterance, heard.confidence)

    def heeds(self, text: str) -> bool:
        """Whether the input mode of an utterance is listened to (VoiceXML 6.3.6)."""
        context = self._shared.context
        return context is not None and self._machine.inputs.noted(context, text) is not None

    def answers(self, run: int) -> Answers | None:
        """The answers to the question of a run."""
        context = self._shared.context
        if context is None or run != self.waits.run or self.over:
            return None
        return self._machine.inputs.words(context)

    def open_during(self, command: Command) -> Answers | None:
        """The answers that may interrupt a prompt, to the question behind it (4.1.5)."""
        waits = self.waits
        return self.answers(waits.run) if waits.opens(command) else None

    def before(self, command: Command) -> Command | None:
        """The awaited Command before a given one, if any."""
        return self.waits.before(command)

    def breaks_in(
        self, now: int, command: Command, heard: Spoken, said: Sequence[Hypothesis]
    ) -> bool:
        """Take what the user says during a prompt as the answer to the question behind it (4.1.5).

        What is being said is said to its end (rule U1), what is queued behind it is not (O3).
        An utterance that no grammar takes is not for this application: nothing listens yet.
        """
        if self.over or not self.waits.opens(command):
            return False
        self._tick(now)
        if heard.data.get("toolong") and command.cued("longest"):
            outcome: dict[str, Json] = {"outcome": "maxspeechtimeout", "utterance": heard.text}
        else:
            answer = self.answer(self.waits.run, said)
            if answer is None or self._shared.heard is None:
                return False
            self._shared.heard.mark = None  # the last one played, which the device reports
            outcome = heard.filled(answer)
        self.leave_states()
        self._drive(Resume(outcome))
        self._catch_up()
        return True

    def expire(self, now: int) -> None:
        """End a fetch or call that takes too long (6.1.1, 2.3.7): no events are ever delayed."""
        self._tick(now)
        if self.waits.late is not None and self.deadline is not None and now >= self.deadline:
            self.replied(now, self.waits.late)

    def leave_states(self) -> None:
        """O3: give up what is requested and awaited."""
        self.waits.leave_state()

    def _catch_up(self) -> None:
        """Deliver the events that arrived while waiting for an answer, once there is a wait.

        Waiting loses the reactive flag (C5).
        """
        while self._missed and self.waits.run and not self.over:
            came, event = self._missed[0]
            if self._is_deaf(event):
                return
            self._missed.popleft()
            self._happened(event if came == self.now else replace(event, reactive=False))

    def _tick(self, now: int) -> None:
        if now != self.now:
            self.renew(now)

    def _drive(self, resume: Resume | None) -> None:
        assert self._flow is not None
        try:
            if resume is None:
                next(self._flow)
            else:
                self._flow.send(resume)
        except GoOut as out:
            if out.failed:
                self.actions.append(Say("error", out.reason, out.source))
            self.quit(out.reason, out.failed)
        except Thrown as thrown:  # when nothing is left to handle it
            self.quit_unhandled(thrown)
        except RecursionError:
            self.quit("error.semantic: its elements are nested too deep", failed=True)


def _hangs_up(event: Event) -> bool:
    return event.name.startswith("connection.disconnect")
