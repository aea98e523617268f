"""A run whose user is played by the author; time can be stopped and turned back."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from prima.errors import UsageError, one_of
from prima.grammar.phrases import phrases
from prima.language.values import LONGEST_MS
from prima.loading import Loaded
from prima.loading.heads import chosen_policy
from prima.messages import Record
from prima.scheduler.behavior import Behavior
from prima.sim.devices import Cast
from prima.sim.rehearsal import Rehearsal
from prima.sim.services import Web
from prima.talk.actions import Played, check_there, doings_of, names_of, scenario_of
from prima.talk.scene import Scene, comment, seconds, when
from prima.talk.typed import TypedLine
from prima.transcript.lines import finished
from prima.transcript.row import Row
from prima.transcript.rows import GrowingTable

THINKING_MS = 1000
"""How long the user thinks before answering, if time waits for them."""
PATIENCE_MS = 60_000
"""How long time passes without a row before the author is asked again."""
AT_ONCE_MS = 600_000
"""How long time passes at most before the author is asked again."""
SAVED = (
    "Played with prima talk. It ends where the session ended:"
    ' write a later until="..." to let it go on.'
)
MOST_LINES = 10_000
"""Maximum number of lines of a session."""

Sink = Callable[[list[Record]], object]


@dataclass(frozen=True, slots=True)
class ReturnPoint:
    """A state to go back to: a time (ms), and the number of lines by then."""

    clock: int
    lines: int
    passing: str


class Game:
    """One session. Times are in ms; ``clock`` is the author's, never behind the run's.

    Args:
        loaded: the scenario, with the files that it names.
        folder: its folder.
        policy: the mediator's policy; by default the scenario's.
        scripted: whether the scenario's user actions are carried out too.
        web: fetches from hosts.
        sink: called with the records of each instant, times in ms; then /undo is impossible.

    Raises:
        UsageError: the policy is unknown.
    """

    def __init__(
        self,
        loaded: Loaded,
        folder: str = "",
        policy: str | None = None,
        scripted: bool = False,
        web: Web | None = None,
        sink: Sink | None = None,
    ) -> None:
        cast = loaded.cast
        self.policy = policy or cast.scenario.policy
        self._chosen = chosen_policy(self.policy, loaded)
        self.scene = Scene(cast.scenario.node, folder, self.policy, scripted)
        scenario = scenario_of(self.scene, [])
        scenario.services = cast.scenario.services  # with their answers
        if scripted:
            for name, user in cast.scenario.users.items():
                scenario.take(name, user)
        self.cast: Cast = replace(cast, scenario=scenario)
        self.names = names_of(self.cast)
        self._web = web
        self._sink = sink
        self.lines: list[Played] = []
        self.points: list[ReturnPoint] = []
        self._begin()

    def _begin(self) -> None:
        """Start the run from its beginning, with the lines so far."""
        self.rehearsal = Rehearsal(self.cast, self._chosen, None, self._web)
        self._table = GrowingTable()
        self.rows: list[Row] = []
        self.records: list[Record] = []
        """All records so far, times in seconds."""
        self.clock = 0
        self.ended = False
        self.passing = ""
        """The question that the user does not answer."""
        self._busy: Callable[[], bool] | None = None
        for line in self.lines:
            self.rehearsal.devices.play(line.at, line.doings)

    # State ------------------------------------------------------------------------

    @property
    def over(self) -> bool:
        """Whether the run has ended."""
        return self.rehearsal.outcome == "over" or self.rehearsal.over

    @property
    def stopped(self) -> str:
        """Why the run cannot go on, if it cannot: ``limit`` or ``until``."""
        if self.clock >= LONGEST_MS:
            return "until"
        return "limit" if self.rehearsal.outcome == "limit" else ""

    @property
    def failures(self) -> list[str]:
        """Applications that ended by an error, as ``NAME: ERROR``."""
        return self.rehearsal.session.failures

    def unheard(self) -> str:
        """The user's words that no application took; returned once."""
        return self.rehearsal.session.hearing.take_unheard()

    @property
    def asking(self) -> str:
        """The application that is asking a question and does not listen yet."""
        question = self.rehearsal.session.mediator.question()
        return question.app.name if question and not question.listening else ""

    @property
    def asks(self) -> Behavior | None:
        """The question that listens, if one does."""
        question = self.rehearsal.session.mediator.question()
        return question if question and question.listening and not question.silent else None

    @property
    def busy(self) -> bool:
        """Whether the last line is still being carried out."""
        if self._busy is not None and self._busy():
            self._busy = None
        return self._busy is not None

    def options(self) -> list[str]:
        """Some answers to the question that listens; none if they are unknown."""
        question = self.asks
        if question is None or question.run is None:
            return []
        app = self.rehearsal.session.apps[question.app.name]
        answers = app.answers(question.run.number)
        return phrases(answers) if answers is not None else []

    # Time -----------------------------------------------------------------------------

    def due(self) -> int | None:
        """The time of the next event (ms), if any."""
        return None if self.rehearsal.outcome or self.rehearsal.over else self.rehearsal.due()

    def advance(self, until: int) -> list[Row] | None:
        """Carry out the next instant up to a time; return its rows, or None if there is none."""
        until = min(until, LONGEST_MS)
        records = self.rehearsal.advance(until)
        self.clock = max(self.clock, self.rehearsal.now)
        return None if records is None else self._take(records)

    def _take(self, records: list[Record]) -> list[Row]:
        if self._sink is not None:
            self._sink(records)
        done = [finished(record) for record in records]
        self.records += done
        rows = self._table.add(done)
        self.rows += rows
        return rows

    def run(self, until: int) -> Iterator[list[Row]]:
        """Let time pass until then; yield rows as they come."""
        until = min(until, LONGEST_MS)
        while (rows := self.advance(until)) is not None:
            yield rows
        self.clock = max(self.clock, until)

    def go(self) -> Iterator[list[Row]]:
        """Let time pass until the run needs the user, or for a minute without a row."""
        latest = self.clock
        most = self.clock + AT_ONCE_MS
        while not self.waits():
            until = min(latest + PATIENCE_MS, most)
            rows = self.advance(until)
            if rows is None:
                if self.due() is not None:
                    self.clock = max(self.clock, min(until, LONGEST_MS))
                return
            if rows:
                latest = self.rehearsal.now
            yield rows

    def waits(self) -> bool:
        """Whether the run waits for the user: a question listens, or nothing is due."""
        asks = self.asks
        if asks is None or asks.id != self.passing:
            self.passing = ""
        if self.busy:
            return False
        if self.due() is None:
            return True
        return asks is not None and not self.passing and not self._is_answered(asks)

    def _is_answered(self, asks: Behavior) -> bool:
        """Whether the scenario's user acts before a question times out."""
        due = self.rehearsal.devices.people.due()
        until = self._answer_until(asks)
        return due is not None and (until is None or due <= until)

    def _answer_until(self, asks: Behavior) -> int | None:
        """When a question times out (ms), if it does."""
        question = self.rehearsal.devices.robot.ear.questions.get(asks.id)
        return question.until if question is not None else None

    def let_pass(self) -> None:
        """Leave the question that listens unanswered."""
        self.passing = self.asks.id if self.asks else ""

    def finish(self) -> list[Row]:
        """End the run here; return its last rows."""
        rows = [row for some in self.run(self.clock) for row in some]
        self.ended = True
        return rows + self._take(self.rehearsal.finish(self.clock))

    # Doing ----------------------------------------------------------------------------

    def do(self, line: TypedLine, think: bool = False) -> int:
        """Let the user act now; return when they begin (ms).

        Args:
            line: the line typed.
            think: whether the user thinks before answering, since time waits for them.

        Raises:
            UsageError: it names something unknown, or nobody is there to do it.
        """
        if len(self.lines) >= MOST_LINES:
            message = f"A session may have {MOST_LINES} lines: save it, and start a new one."
            raise UsageError(message)
        doings = doings_of(line, self.scene, self.cast)
        if self.over and not line.loads:
            again = f"/load {one_of(self.names.applications)}"
            raise UsageError(
                f"Every application has ended. Load one again ({again}), or type /quit."
            )
        check_there(self.rehearsal, doings)
        thinking = self._thinking() if think and doings[0].name == "say" else 0
        at = max(self.clock + thinking, self.rehearsal.now + 1)
        if at > LONGEST_MS:
            raise UsageError("A run lasts no longer than a day.")
        self.keep()
        if self.over:
            self.rehearsal.outcome = ""  # what is put in again goes on
        self.lines.append(Played(at, line.xml, doings, self._last_row()))
        self._busy = self.rehearsal.devices.play(at, doings)
        return at

    def _thinking(self) -> int:
        """How long the user thinks before answering the question for which time has stopped."""
        if self.asks is None or self.clock > self.rehearsal.now:
            return 0
        until = self._answer_until(self.asks)
        left = until - self.clock if until is not None else 2 * THINKING_MS
        return min(THINKING_MS, max(left // 2, 0))

    def end_line(self) -> Iterator[list[Row]]:
        """Let time pass until the last line has been carried out."""
        while self.busy and (due := self.due()) is not None:
            yield self.advance(due) or []

    def _last_row(self) -> str:
        if not self.rows:
            return "before the first row"
        row = self.rows[-1]
        what = " ".join(filter(None, (row.app, row.what)))
        return f"after row {row.number}, {row.time:.2f} s: {what[:200]}"

    # Going back ------------------------------------------------------------------------

    def keep(self) -> None:
        """Save this state, to go back to it."""
        self.points.append(ReturnPoint(self.clock, len(self.lines), self.passing))
        del self.points[:-MOST_LINES]

    def undo(self) -> None:
        """Go back to where the last line was typed.

        Raises:
            UsageError: there is no line, or it cannot be undone.
        """
        self._check_back()
        if not self.points:
            raise UsageError("There is nothing to undo.")
        point = self.points.pop()
        self.lines = self.lines[: point.lines]
        self._return(point.clock)
        self.passing = point.passing

    def back(self, clock: int) -> None:
        """Go back to a time; later lines are undone.

        Raises:
            UsageError: the time is in the future, or lines cannot be undone.
        """
        self._check_back()
        if clock > self.clock:
            left = seconds(clock - self.clock)
            raise UsageError(f"It is only {seconds(self.clock)}: type /wait {left}.")
        self.lines = [line for line in self.lines if line.at <= clock]
        self.points = [point for point in self.points if point.clock < clock]
        self._return(clock)

    def _check_back(self) -> None:
        if self._sink is not None:
            raise UsageError("Records written as JSON cannot be undone.")
        if self._web is not None:
            raise UsageError("Requests to hosts cannot be undone.")

    def _return(self, clock: int) -> None:
        self._begin()
        for _ in self.run(clock):
            pass

    # Saving ---------------------------------------------------------------------------

    def saved(self, target: str) -> str:
        """The session so far as a scenario that repeats it, for a file."""
        whens = [f"<!-- {comment(one.after)} -->\n  {when(one.at, one.xml)}" for one in self.lines]
        return self.scene.text(whens, seconds(self.clock), target, SAVED)
