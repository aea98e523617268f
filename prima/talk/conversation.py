"""The conversation with the author: carries out their lines and answers questions."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Protocol

from prima.errors import UsageError
from prima.errors.visible import visible
from prima.language.values import read_value
from prima.loading.writing import write_whole
from prima.scheduler.behavior import LINKED, RUNNING, WAITING, Behavior, Stream
from prima.talk.game import Game
from prima.talk.scene import MARK, seconds
from prima.talk.typed import TypedLine, help_text, read_line
from prima.transcript.row import Row, describe
from prima.transcript.run import run_of
from prima.transcript.why import explained

SHOWN = 6
"""Number of answers to a question that are shown."""


class Screen(Protocol):
    """The author's screen."""

    interactive: bool
    """Whether a person is using it."""

    def rows(self, rows: list[Row]) -> None:
        """Show rows as they happen."""

    def show(self, text: str) -> None:
        """Show the result of a command."""

    def tell(self, text: str) -> None:
        """Show a message."""


class Conversation:
    """Carries out an author's lines.

    Args:
        game: the session.
        screen: their screen.
        real: whether time passes by itself, in :meth:`pass_time`.
        sources: files that are never overwritten.
    """

    def __init__(
        self, game: Game, screen: Screen, real: bool = False, sources: Iterable[str] = ()
    ) -> None:
        self.game = game
        self.screen = screen
        self.real = real
        self.done = False
        """Whether the author has quit, or the run cannot go on."""
        self.wrong = 0
        """The number of wrong lines."""
        self.options: list[str] = []
        """Some answers to the question that listens."""
        self._sources = {os.path.realpath(path) for path in sources}
        self._failures = 0
        self._told = ""
        self._alone: dict[str, Callable[[], None]] = {
            "go": self._go,
            "step": self._step,
            "undo": self._undo,
            "who": lambda: self.screen.show("\n".join(_situation(self.game))),
            "quit": self._quit,
        }
        """The controls that nothing follows."""
        self._controls: dict[str, Callable[[str], None]] = {
            "back": self._back,
            "why": self._why,
            "save": self._save,
            "help": lambda rest: self.screen.show(help_text(rest)),
        }

    # Time -----------------------------------------------------------------------------

    def begin(self) -> None:
        """Let time pass until the robot first waits for the user."""
        self._show(self.game.go())

    def pass_time(self, now: int) -> int | None:
        """Let time pass until ``now`` (ms); return when something is due next, if ever."""
        self._show(self.game.run(now))
        return self.game.due()

    def _show(self, some: Iterable[list[Row]]) -> None:
        for rows in some:
            if rows:
                self.screen.rows(rows)
            if text := self.game.unheard():
                self.screen.tell(_unheard(text, self.game.asking))
            failures = self.game.failures
            for failure in failures[self._failures :]:
                self.screen.tell(f"prima: {failure.rstrip(': .')}. The session goes on.")
            self._failures = len(failures)
        self.options = self.game.options()
        self._tell_state()

    def _tell_state(self) -> None:
        """Show once why time has stopped, unless a question asks for an answer."""
        state = self.game.stopped
        if state:
            self.done = True
            why = "a run lasts no longer than a day"
            why = "the run made more records than allowed" if state == "limit" else why
            self.screen.tell(f"prima: {why}; the session is over.")
            return
        if self.game.over:
            state = "Every application has ended; /load starts one again."
        elif self.game.due() is None:
            state = "Nothing more happens by itself."
        if state and state != self._told and self.screen.interactive:
            self.screen.tell(state)
        self._told = state

    @property
    def prompt(self) -> str:
        """The prompt for the next line."""
        asks = self.game.asks
        who = f" {asks.app.name} listens" if asks is not None else ""
        return f"{seconds(self.game.clock)}{who}> "

    def close(self) -> None:
        """End the session."""
        if not self.game.ended and (rows := self.game.finish()):
            self.screen.rows(rows)

    # Lines ----------------------------------------------------------------------------

    def line(self, text: str) -> None:
        """Carry out a line, or show what is wrong with it."""
        try:
            line = read_line(text)
            if self.real and line.control in ("go", "step", "wait"):
                if text.strip():
                    raise UsageError("Time passes by itself here; with --step it waits for you.")
            elif line.control == "wait":
                self._wait(line.linger)
            elif line.control in self._alone:
                if line.rest:
                    raise UsageError(f'Nothing follows "/{line.control}".')
                self._alone[line.control]()
            elif line.control:
                self._controls[line.control](line.rest)
            else:
                self._do(line)
        except UsageError as error:
            self.wrong += 1
            self.screen.tell(str(error))

    def refuse(self, message: str) -> None:
        """Show a message about a line that could not be read."""
        self.wrong += 1
        self.screen.tell(message)

    def _do(self, line: TypedLine) -> None:
        self.game.do(line, think=not self.real)
        self._told = ""
        if self.real:
            return
        self._show(self.game.end_line())
        if line.linger:
            self._show(self.game.run(self.game.clock + line.linger))
        else:
            self._show(self.game.go())

    def _go(self) -> None:
        self.game.keep()
        self._told = ""
        self.game.let_pass()
        self._show(self.game.go())

    def _wait(self, linger: int) -> None:
        self.game.keep()
        self._show(self.game.run(self.game.clock + linger))

    def _step(self) -> None:
        self.game.keep()
        self._told = ""
        self.game.let_pass()
        rows = self.game.go()
        self._show(iter([next((some for some in rows if some), [])]))

    def _back(self, rest: str) -> None:
        try:
            clock = int(read_value("duration", rest))
        except ValueError:
            raise UsageError('Write "/back TIME", as in "/back 5s".') from None
        self.game.back(clock)
        self._returned()

    def _undo(self) -> None:
        self.game.undo()
        self._returned()

    def _returned(self) -> None:
        self._failures = len(self.game.failures)
        self.game.unheard()
        self._told = ""
        self.options = self.game.options()
        rows = self.game.rows
        row = f", after row {rows[-1].number}" if rows else ""
        self.screen.show(f"Back at {seconds(self.game.clock)}{row}.")

    def _quit(self) -> None:
        self.done = True

    # Questions ------------------------------------------------------------------------

    def _why(self, rest: str) -> None:
        rows = self.game.rows
        if not rows:
            raise UsageError("There is no row yet.")
        if rest and not (rest.isascii() and rest.isdigit() and int(rest[:9]) < len(rows)):
            raise UsageError(f'There is no row "{rest}"; the rows are 0 to {len(rows) - 1}.')
        row = rows[int(rest)] if rest else rows[-1]
        self.screen.show("\n".join(explained(run_of(self.game.records), row)))

    # Saving ---------------------------------------------------------------------------

    def _save(self, rest: str) -> None:
        quoted = len(rest) > 1 and rest[0] == rest[-1] and rest[0] in "\"'"
        path = rest[1:-1] if quoted else rest
        if not path:
            raise UsageError('Write "/save FILE", as in "/save visit.xml".')
        self.save(path)
        self.screen.tell(f"Saved {path}.")

    def check_target(self, path: str) -> None:
        """Check that a session may be saved to a file.

        Raises:
            UsageError: it is a document of the run, or an existing file of another kind.
        """
        if os.path.realpath(path) in self._sources:
            raise UsageError(f"{path}: this is one of the run's own documents; write elsewhere.")
        folder = Path(path).parent
        try:
            if not folder.is_dir():
                raise UsageError(f"{path}: there is no folder {folder}.")
            if Path(path).is_dir():
                file = os.path.join(path, "visit.xml")
                raise UsageError(f"{path}: this is a folder; name a file, as {file}.")
            if Path(path).exists() and MARK.encode() not in _beginning(Path(path)):
                raise UsageError(
                    f"{path}: this file exists and is not a saved session; write elsewhere."
                )
        except (OSError, ValueError) as error:
            why = getattr(error, "strerror", None) or "not a file name"
            raise UsageError(f"{path}: cannot be written: {why}.") from None

    def save(self, path: str) -> None:
        """Write the session so far as a scenario; the file is replaced atomically.

        Raises:
            UsageError: it cannot be written there.
        """
        self.check_target(path)
        write_whole(path, self.game.saved(path))


def _beginning(path: Path) -> bytes:
    """The first bytes of a regular file."""
    if not path.is_file():
        return b""
    with path.open("rb") as stream:
        return stream.read(200)


def _unheard(text: str, asking: str) -> str:
    """A message that no application took a text, and when one will listen."""
    later = f" {asking} is still asking; it listens when it has finished." if asking else ""
    return f'Nobody listens: "{visible(text)}" is lost.{later}'


def _situation(game: Game) -> list[str]:
    """Applications, ABs, streams and the question that listens."""
    session = game.rehearsal.session
    memory = session.mediator.memory
    lines = [f"{seconds(game.clock)}: {len(memory.behaviors)} in working memory"]
    for name, app in session.apps.items():
        loaded = name in memory.apps and not app.over
        lines.append(f"  {app.kind.upper()} {name}" + ("" if loaded else " (not loaded)"))
    lines += [
        f"  {state}: {_behavior(ab)}"
        for state in (RUNNING, WAITING, LINKED)
        for ab in memory.behaviors.values()
        if ab.state is state
    ]
    lines += [_stream(one, memory.holder) for one in memory.streams.values() if one.open]
    if game.asks is not None:
        options = game.options()
        more = ", ..." if len(options) > SHOWN else ""
        takes = f" for: {', '.join(options[:SHOWN])}{more}" if options else ""
        lines.append(f"  {game.asks.app.name} listens{takes}")
    return lines


def _stream(stream: Stream, holder: Stream | None) -> str:
    held = " is suspended" if stream.suspended else " has the floor" if stream is holder else ""
    return f"  stream {stream.name}{held}: {', '.join(stream.members) or 'held'}"


def _behavior(ab: Behavior) -> str:
    command = ab.command
    what = "a unit"
    if command is not None:
        what = describe(command.type, command.text, dict(command.args))
    devices = f" [{', '.join(sorted(ab.devices))}]" if ab.devices else ""
    after = f" after {', '.join(sorted(ab.waits_for))}" if ab.waits_for else ""
    return f"{ab.id} {what}{devices}{after}"
