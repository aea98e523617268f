"""The waits of a VoiceXML application: for Commands, answers from outside, the end of a unit."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from itertools import pairwise

from prima.interpreter.places import source
from prima.interpreter.protocol import Answer, App
from prima.interpreter.units import Reach
from prima.markup.tree import Node
from prima.messages import (
    CloseUnit,
    Command,
    Data,
    Fetched,
    LeaveState,
    OpenUnit,
    Request,
    Transferred,
)
from prima.script.isolated import AnyEngine
from prima.voicexml.arranging import Queued, requests_of, steps_of
from prima.voicexml.state import Resume, UnitOver


class Waits:
    """Requests Commands, answers and units, and waits for them.

    Args:
        app: the application.
        here: where it is.
        begun: is called when the queue is requested.
    """

    def __init__(
        self, app: App[AnyEngine], here: Callable[[], Node], begun: Callable[[], None]
    ) -> None:
        self._app = app
        self._here = here
        self._begun = begun
        self.run = 0
        """The run of Commands that is waited for; 0 for none."""
        self.cause: int | None = None
        """The event to which the next request reacts."""
        self.asked: int | None = None
        """The serial of the outside request that is waited for: the transitioning state."""
        self.late: Answer | None = None
        """The answer assumed at the deadline."""
        self.calling = False
        """Whether a call is waited for, which the user may hang up."""
        self.patient = False
        """Whether the current prompts are played to their end, even once the answer is there."""
        self.unit: int | None = None
        """The unit around form items in which Commands are requested (U5)."""
        self.leaving = False
        """Whether a unit is being left: its speech is played to its end."""
        self._answer: Answer | None = None
        self._state = 0
        self._left = 0
        """The state that was left last: each is left once (O3)."""
        self._open: Sequence[Command] = ()
        """Commands during which the question behind them may be answered."""
        self._queue: Sequence[Queued] = ()
        """Commands whose end is waited for."""
        self._unit_place = ""
        """Where that unit is in the document."""
        self._overdue = ""
        """The message for a unit that has just taken too long."""

    # Commands -------------------------------------------------------------------------

    def opens(self, command: Command) -> bool:
        """Whether the question behind a Command may be answered during it."""
        return any(one is command for one in self._open)

    def before(self, command: Command) -> Command | None:
        """The awaited Command before a given one, if any."""
        for one, after in pairwise(self._queue):
            if after is command:
                return one if isinstance(one, Command) else None
        return None

    def leave_state(self) -> None:
        """O3: give up what is requested and awaited."""
        if self._left != self._state:
            self._left = self._state
            self._app.actions.append(LeaveState(self._state))

    def wait(
        self, commands: Sequence[Queued], open_to_answers: Sequence[Command] = ()
    ) -> Generator[None, Resume, Resume]:
        """Request Commands, one after another, and wait for the end of the last.

        During those that are open to answers, the question behind them may be answered. What is
        wanted now is requested after the end of what comes before it (O2, O4).
        """
        self._state = next(self._app.states)
        self._begun()
        resume, before = Resume(), self._answer
        for asked in requests_of(commands):
            resume = yield from self._carry_out(asked, open_to_answers)
            answered = self._answer is not before and not self.patient
            if answered or resume.event is not None:
                break
        return resume

    def _carry_out(
        self, commands: Sequence[Queued], open_to_answers: Sequence[Command]
    ) -> Generator[None, Resume, Resume]:
        """Make one request, and wait."""
        self.run = next(self._app.runs)
        cause, self.cause = self.cause, None
        steps = steps_of(commands)
        self._app.actions.append(Request(self.run, steps, self._state, cause, self.unit))
        self._open, self._queue = open_to_answers, commands
        resume = yield from self._resumed()
        self.run, self._open, self._queue = 0, (), ()
        self._stay_in_time()
        return resume

    def _resumed(self) -> Generator[None, Resume, Resume]:
        """Wait until something goes on."""
        began = self._app.now
        resume = yield
        self._app.count_wait(began, self._here())
        return resume

    def open_unit(self, reach: Reach, longest: int, node: Node) -> None:
        """U5: requests from now on belong to a unit, which is a state of its own."""
        self.unit, self._unit_place = next(self._app.units), source(node)
        self._state = next(self._app.states)
        cause, self.cause = self.cause, None
        place, devices, types = self._unit_place, reach.devices, reach.types
        self._app.actions.append(
            OpenUnit(self.unit, self._state, devices, longest, cause, place, types=types)
        )

    def close_unit(self) -> None:
        """U5: the unit is left, in whatever way."""
        if self.unit is not None and not self._app.over:
            self._app.actions.append(CloseUnit(self.unit))
        self.unit = None

    def _stay_in_time(self) -> None:
        """U5: wait no longer in a unit that has taken too long.

        Raises:
            UnitOver: ``error.unit.timeout``.
        """
        message, self._overdue = self._overdue, ""
        if message:
            self.expect_nothing()
            raise UnitOver("error.unit.timeout", message, self._unit_place)

    def ask(self, uri: str, data: Data, late: Answer, timeout: int, node: Node) -> None:
        """Send a request to a URI; ``late`` is the answer if none comes in ``timeout`` ms."""
        late.serial = self._app.send(uri, data, source(node))
        self.expect(late, timeout)

    def expect(self, late: Answer, timeout: int | None) -> None:
        """Wait for an answer to a request; without a timeout, for ever."""
        self.asked, self._answer, self.late = late.serial, None, late
        self.calling = isinstance(late, Transferred)
        self._app.deadline = None if timeout is None else self._app.now + timeout

    @property
    def overdue(self) -> bool:
        """Whether no answer came in time."""
        return self._answer is not None and self._answer is self.late

    def expect_nothing(self) -> None:
        """Stop waiting for an answer."""
        self.asked = self._answer = self.late = self._app.deadline = None
        self.calling = False

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
        """Play what is queued, and then fetch audio until the answer is there (6.1.1).

        An event from outside ends it before: the user has hung up.
        """
        resume = Resume()
        for commands, self.patient in ((queued, True), (audio, False)):
            if commands and self._answer is None and not resume.outside:
                resume = yield from self.wait(commands)
        self.patient = False

    def fetched(self) -> Generator[None, Resume, Fetched]:
        """Wait for the answer of a fetch."""
        while not isinstance(self._answer, Fetched):
            yield from self._resumed()
            self._stay_in_time()
        return self._answer

    def take(self, answer: Answer) -> None:
        """Take the answer to the request."""
        self.asked, self._answer, self._app.deadline = None, answer, None

    def overrun(self, message: str) -> None:
        """U5: the unit has taken too long."""
        self.unit, self._overdue = None, f"{self._unit_place}: {message}"
