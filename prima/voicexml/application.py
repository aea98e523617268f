"""A VoiceXML application as a state machine without I/O or clock, for a session to drive."""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Sequence
from itertools import pairwise
from pathlib import PurePath

from prima.grammar.answers import Answers
from prima.interpreter.bounds import ElementVisit
from prima.interpreter.places import source
from prima.interpreter.protocol import Answer, App
from prima.interpreter.transfers import GoOut, Thrown
from prima.interpreter.units import Reach
from prima.markup.tree import Node
from prima.messages import (
    CloseUnit,
    Command,
    Data,
    Event,
    Fetched,
    Hypothesis,
    Json,
    LeaveState,
    Notice,
    OpenUnit,
    Request,
    Say,
    Transferred,
    Understood,
)
from prima.messages import Heard as Spoken
from prima.script.isolated import AnyEngine, Engines
from prima.voicexml.arranging import Queued, steps_of
from prima.voicexml.document import Page, VoiceDocument
from prima.voicexml.machine import Machine
from prima.voicexml.state import SCOPES, Flow, Resume, TakenUtterance, UnitOver, thrown_of_event


class VoiceInterpreter(App[AnyEngine]):
    """Runs one VoiceXML application."""

    def __init__(
        self,
        document: VoiceDocument,
        engines: Engines | None = None,
    ) -> None:
        self.document = document
        engine = (engines or Engines()).engine(document.id, document.kind, SCOPES)
        super().__init__(document.id, document.kind, engine)
        self.heard: TakenUtterance | None = None
        self.note_document(document.page)
        self._machine = Machine(self)
        self._flow: Flow | None = None
        self._run = 0
        self._state = 0
        self._left = 0
        """The state that was left last: each is left once (O3)."""
        self._cause: int | None = None
        self._marked: str | None = None
        self._asked: int | None = None
        """The serial of what is asked for outside and waited for: the transitioning state."""
        self._answer: Answer | None = None
        self._late: Answer | None = None
        """The answer when the deadline is over."""
        self._calling = False
        """Whether what is waited for is a call, which the user may hang up."""
        self._patient = False
        """Whether what is played now is played to its end, even with the answer there."""
        self._open: Sequence[Command] = ()
        """Commands during which the question behind them may be answered."""
        self._queue: Sequence[Queued] = ()
        """Commands whose end is waited for."""
        self._missed: deque[Event] = deque()
        """Events that came while an answer was waited for (4.1.8): none is lost."""
        self._unit_node = document.node
        self._unit: int | None = None
        """The unit around form items in which Commands are asked for (U5)."""
        self._overdue = ""
        """What to say of a unit that has just taken too long."""
        self.leaving = False
        """Whether a unit is being left: what is said in it is said to its end."""

    # What a session tells -----------------------------------------------------------

    def start(self, now: int) -> None:
        """Begin with the first dialog."""
        self._tick(now)
        self._flow = self._machine.start()
        self._drive(None)

    def note_document(self, page: Page) -> None:
        """A document is there, whatever becomes of it; its path is relative to the first one's."""
        first, file = self.document.page, self.document.file
        path = file if page is first else str(PurePath(file).parent / page.root.source.file)
        self.visits.append(ElementVisit(self.name, max(self.now, 0), "document", page.root, path))

    def takes(self, name: str) -> bool:
        """Whether a handler in scope takes an event of the robot."""
        context, thrown = self._machine.context, thrown_of_event(Event(name, 0, shared=True))
        return context is not None and self._machine.events.takes(context, thrown)

    def event(self, now: int, event: Event) -> None:
        """Something happened: an event that a handler in scope takes ends the wait (5.2)."""
        self._tick(now)
        if self._is_deaf(event):
            self._missed.append(event)
        else:
            self._happened(event)
            self._catch_up()

    def _is_deaf(self, event: Event) -> bool:
        """Whether an event has to wait until something else is waited for (4.1.8)."""
        if self._asked is not None:
            return not (self._calling and _hangs_up(event))
        return self.leaving and not _hangs_up(event)

    def _happened(self, event: Event) -> None:
        context = self._machine.context
        if self.over or context is None or not (self._run or self._calling):
            return
        thrown = thrown_of_event(event)
        if not _hangs_up(event) and not self._machine.events.takes(context, thrown):
            return
        self._cause = event.serial if event.reactive else None
        self._tell(event)
        self.leave_states()
        self._drive(Resume(event=event, outside=True))
        self._cause = None

    def _tell(self, event: Event) -> None:
        """Give an event's data as ``session.event``: VoiceXML's own variables have none."""
        session = self._machine.documents.session
        self.engine.set(session, "event", {"name": event.name, "data": dict(event.data)})

    def notice(self, now: int, notice: Notice) -> None:
        """The mediator tells the fate of Commands."""
        self._tick(now)
        if notice.what == "unit-timeout":
            self._unit_over(notice)
            return
        if self.over or notice.run != self._run or notice.what in ("ended", "interrupted"):
            return
        if notice.what == "failed":
            place = notice.command.source if notice.command else ""
            data = {"message": f"{place}: {notice.message}" if place else notice.message}
            self._drive(Resume(event=Event(notice.event, 0, data, reactive=False)))
        elif notice.what == "done":
            self._drive(Resume(notice.data))
        self._catch_up()

    def _unit_over(self, notice: Notice) -> None:
        """U5: a unit takes too long: whatever is waited for in it is over."""
        if self.over or notice.run != self._unit:
            return
        self._unit, self._overdue = None, f"{source(self._unit_node)}: {notice.message}"
        self._drive(Resume())
        self._catch_up()

    def replied(self, now: int, answer: Answer) -> None:
        """The answer to what was asked for; one that comes too late, or twice, is not heeded."""
        self._tick(now)
        if self.over or answer.serial != self._asked:
            return
        self._asked, self._answer, self.deadline = None, answer, None
        if self._run and self._patient:
            return
        if self._run:
            self.leave_states()
        self._drive(Resume())
        self._catch_up()

    def sensed(self, now: int, values: Data) -> list[str]:
        """VoiceXML watches no sensors."""
        self._tick(now)
        self.sensors.update(values)
        return []

    def answer(self, run: int, said: Sequence[Hypothesis]) -> Understood | None:
        """What the active grammars make of what the user said, or None if they take it not."""
        context = self._machine.context
        if context is None or run != self._run or self.over:
            return None
        try:
            self.heard = self._machine.inputs.hear(context, said)
        except Thrown:
            return None  # told when the question was asked
        if self.heard is None and context.item is not None and context.item.tag == "record":
            text, sure = said[0]
            self.heard = TakenUtterance(text, text, context.item, context.page, sure)
            self.heard.recognised = False
        if self.heard is None:
            return None
        self.heard.mark = self._marked
        heard, found = self.heard, self.heard.interpretation
        value = found if found is not None else heard.utterance
        return Understood(value, heard.utterance, heard.confidence)

    def answers(self, run: int) -> Answers | None:
        """What can be said to the question of a run."""
        context = self._machine.context
        if context is None or run != self._run or self.over:
            return None
        return self._machine.inputs.words(context)

    def open_during(self, command: Command) -> Answers | None:
        """What can be said to the question behind a prompt while that is being said (4.1.5)."""
        opened = any(one is command for one in self._open)
        return self.answers(self._run) if opened else None

    def before(self, command: Command) -> Command | None:
        """Which of the Commands that are waited for comes before one of them, if any does."""
        for one, after in pairwise(self._queue):
            if after is command:
                return one if isinstance(one, Command) else None
        return None

    def breaks_in(
        self, now: int, command: Command, heard: Spoken, said: Sequence[Hypothesis]
    ) -> bool:
        """Take what the user says during a prompt as the answer to the question behind it (4.1.5).

        What is being said is said to its end (rule U1), what is queued behind it is not (O3).
        What no grammar takes is not for this application: nothing listens yet.
        """
        if self.over or not any(one is command for one in self._open):
            return False
        self._tick(now)
        if heard.data.get("toolong") and command.cued("longest"):
            outcome: dict[str, Json] = {"outcome": "maxspeechtimeout", "utterance": heard.text}
        else:
            answer = self.answer(self._run, said)
            if answer is None or self.heard is None:
                return False
            self.heard.mark = None  # the last one played, which the device tells
            outcome = heard.filled(answer)
        self.leave_states()
        self._drive(Resume(outcome))
        self._catch_up()
        return True

    def expire(self, now: int) -> list[tuple[str, Data]]:
        """VoiceXML has no delayed events; but a fetch or a call may take too long (6.1.1, 2.3.7)."""
        self._tick(now)
        if self._late is not None and self.deadline is not None and now >= self.deadline:
            self.replied(now, self._late)
        return []

    # What the machine asks for --------------------------------------------------------

    def wait(
        self, commands: Sequence[Queued], open_to_answers: Sequence[Command] = ()
    ) -> Generator[None, Resume, Resume]:
        """Ask for Commands, one after another, and wait for the end of the last.

        Args:
            commands: the Commands.
            open_to_answers: those during which the question behind them may be answered.
        """
        self._run = next(self.runs)
        self._state = next(self.states)
        cause, self._cause = self._cause, None
        content = self._machine.content
        self._marked, content.mark = content.mark, None
        steps = steps_of(commands)
        self.actions.append(Request(self._run, steps, self._state, cause, self._unit))
        self._open, self._queue = open_to_answers, commands
        resume = yield from self._resumed()
        self._run, self._open, self._queue = 0, (), ()
        self._stay_in_time()
        return resume

    def _resumed(self) -> Generator[None, Resume, Resume]:
        """Wait until something goes on."""
        began = self.now
        resume = yield
        context = self._machine.context
        item = context.item if context is not None else None
        self.count_wait(began, item or self.document.node)
        return resume

    def open_unit(self, reach: Reach, longest: int, node: Node) -> None:
        """U5: what is asked for from now on belongs to a unit, which is a state of its own."""
        self._unit, self._unit_node = next(self.units), node
        self._state = next(self.states)
        cause, self._cause = self._cause, None
        place, devices, types = source(node), reach.devices, reach.types
        self.actions.append(
            OpenUnit(self._unit, self._state, devices, longest, cause, place, types=types)
        )

    def close_unit(self) -> None:
        """U5: the unit is left, by whatever way."""
        if self._unit is not None and not self.over:
            self.actions.append(CloseUnit(self._unit))
        self._unit = None

    def _stay_in_time(self) -> None:
        """U5: nothing is waited for any longer in a unit that has taken too long.

        Raises:
            UnitOver: ``error.unit.timeout``.
        """
        message, self._overdue = self._overdue, ""
        if message:
            self.expect_nothing()
            raise UnitOver("error.unit.timeout", message, source(self._unit_node))

    def ask(self, uri: str, data: Data, late: Answer, timeout: int, node: Node) -> None:
        """Ask something of a URI; ``late`` is the answer if none comes in ``timeout`` ms."""
        late.serial = self.send(uri, data, source(node))
        self.expect(late, timeout)

    def expect(self, late: Answer, timeout: int | None) -> None:
        """Wait for an answer to what has been asked; without a timeout, for ever."""
        self._asked, self._answer, self._late = late.serial, None, late
        self._calling = isinstance(late, Transferred)
        self.deadline = None if timeout is None else self.now + timeout

    @property
    def overdue(self) -> bool:
        """Whether the answer is that none has come in time."""
        return self._answer is not None and self._answer is self._late

    def expect_nothing(self) -> None:
        """Wait for no answer any more."""
        self._asked = self._answer = self._late = self.deadline = None
        self._calling = False

    def answer_or_input(
        self, commands: Sequence[Queued]
    ) -> Generator[None, Resume, Answer | Resume]:
        """Wait for an answer or, with Commands, for the end of the last, whichever is first.

        An event ends the wait as well.
        """
        resume = yield from self.wait(commands) if commands else self._resumed()
        return self._answer or resume

    def pass_time(
        self, queued: Sequence[Queued], audio: Sequence[Queued]
    ) -> Generator[None, Resume, None]:
        """Play what is queued, and then fetch audio until the answer is there (6.1.1)."""
        for commands, self._patient in ((queued, True), (audio, False)):
            if commands and self._answer is None:
                yield from self.wait(commands)
        self._patient = False

    def fetched(self) -> Generator[None, Resume, Fetched]:
        """Wait for the answer of a fetch."""
        while not isinstance(self._answer, Fetched):
            yield from self._resumed()
            self._stay_in_time()
        return self._answer

    def _catch_up(self) -> None:
        """Give the events that came while an answer was waited for, once there is a wait."""
        while self._missed and self._run and not self.over and not self._is_deaf(self._missed[0]):
            self._happened(self._missed.popleft())

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
        except StopIteration:
            self.quit("exit")
        except GoOut as out:
            if out.failed:
                self.actions.append(Say("error", out.reason, out.source))
            self.quit(out.reason, out.failed, out.source)
        except Thrown as thrown:  # when nothing is left that could handle it
            self.quit_unhandled(thrown)
        except RecursionError:
            self.quit("error.semantic: its elements are nested too deep", failed=True)

    def leave_states(self) -> None:
        """O3: what is asked for and waited for is given up."""
        if self._left != self._state:
            self._left = self._state
            self.actions.append(LeaveState(self._state))


def _hangs_up(event: Event) -> bool:
    return event.name.startswith("connection.disconnect")
