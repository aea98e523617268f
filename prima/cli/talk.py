"""prima talk."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.common import (
    MAPS,
    clean,
    coloured,
    columns,
    format_option,
    limit_option,
    map_option,
    put,
    raise_limits,
    suggesting,
    tell,
    tell_problems,
    why_option,
    write_for_programs,
)
from prima.cli.terminal import Clock, Keyboard, Piped, Typist, edit_lines, ending_well
from prima.errors import TOO_MUCH, RunError, UsageError
from prima.language.commands import PATIENCE_MS
from prima.scheduler.policy import POLICIES, USAGE

if TYPE_CHECKING:
    from prima.loading import Loaded
    from prima.messages import Record
    from prima.talk import Conversation, Game
    from prima.transcript.table import Row

COLOURS = {"U": "cyan", "E": "yellow"}
"""Colours of rows, by who does it."""


@click.command()
@click.argument("scenario", type=click.Path(), required=False)
@click.option("--fa", "fas", multiple=True, type=click.Path(), help="Run this as the robot's own.")
@click.option("--ea", "eas", multiple=True, type=click.Path(), help="Run this as the place's.")
@click.option("--world", type=click.Path(), help="Let --fa and --ea run in this world.")
@click.option("--robot", type=click.Path(), help="Let --fa and --ea run on this robot.")
@click.option(
    "--step", is_flag=True, help="Let time wait for you: the default unless in a terminal."
)
@click.option(
    "--real-time", is_flag=True, help="Let time go on by itself: the default in a terminal."
)
@click.option("--save", "target", type=click.Path(), help="Write the session here at its end.")
@click.option(
    "--scripted", is_flag=True, help="Let the scenario's user do what it says as well as you."
)
@click.option(
    "--policy",
    shell_complete=suggesting(*POLICIES),
    help=f"The mediator's policy: {USAGE}.",
)
@why_option
@click.option(
    "--allow-host",
    "hosts",
    metavar="HOST[:PORT]",
    multiple=True,
    help="Let VoiceXML documents fetch from this host; without, no network is used.",
)
@map_option
@limit_option
@format_option
def talk(
    scenario: str | None,
    fas: tuple[str, ...],
    eas: tuple[str, ...],
    world: str | None,
    robot: str | None,
    step: bool,
    real_time: bool,
    target: str | None,
    scripted: bool,
    policy: str | None,
    why: bool,
    hosts: tuple[str, ...],
    maps: tuple[str, ...],
    limits: tuple[str, ...],
    form: str,
) -> None:
    """Play the user of a run: type what he says and does, and see what the robot makes of it.

    A line is said; /touch head, /walk 3 0.5, /message from Ann: I'm late and others are
    done; /help names them all. Time stands still while you type. An empty line lets it go
    on, and the end of input ends the session. /save FILE or --save FILE keeps it as a scenario, for prima run.

    Exit code 3 if an application ended by an error; 1 if a line from a file or pipe was wrong.

    \b
    prima talk documents/scenarios/touched-on-the-way.xml
    prima talk --fa documents/fa/follow.xml --ea documents/ea/guide.xml --save visit.xml
    prima talk --ea museum.xml --world documents/worlds/museum.xml --robot papero.xml
    printf '/back 5s\\n/touch head\\n' | prima talk documents/scenarios/touched-on-the-way.xml
    """
    from prima import api
    from prima.talk import Conversation, Game

    raise_limits(limits)
    if (scenario is None) == (not fas and not eas):
        raise UsageError("Name a scenario, or applications with --fa and --ea.")
    if scenario is not None and (world or robot):
        raise UsageError("A scenario names its own world and robot; leave out --world and --robot.")
    if maps and scenario is not None:
        raise UsageError(MAPS)
    if step and real_time:
        raise UsageError("Write --step or --real-time, not both.")
    if scenario is not None:
        loaded = api.load_scenario(scenario)
    else:
        loaded = api.stage(fas, eas, (), world, robot, maps)
    tell_problems(loaded.problems)
    folder = os.path.dirname(scenario or "")
    sink = _write if form == "json" else None
    web = api.fetcher(list(hosts), len(loaded.cast.documents))
    game = Game(loaded, folder, policy, scripted, web, sink)
    terminal = sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()
    real = real_time or (terminal and not step)
    screen = Screen(game, why, form == "json", terminal)
    names = loaded.files if scenario is not None else [*loaded.files][1:]
    sources = [os.path.join(folder, name) for name in names]
    conversation = Conversation(game, screen, real, sources)
    if target is not None:
        conversation.check_target(target)
    if form == "json":
        write_for_programs()
        _write([_head(game, loaded)])
    _greet(game, screen)
    with ending_well(lambda: _keep(conversation, target)):
        try:
            _converse(conversation, screen)
        finally:
            _keep(conversation, target)
    if game.stopped == "limit":
        raise RunError(TOO_MUCH)
    if game.failures:
        raise Exit(3)
    if conversation.wrong and not terminal:
        raise Exit(1)


def _keep(conversation: Conversation, target: str | None) -> None:
    """Write the session where --save says."""
    if target is not None:
        conversation.save(target)
        tell(f"Saved {target}.")


def _write(records: list[Record]) -> None:
    """Records as JSON lines, to stdout."""
    from prima.transcript.lines import line

    for record in records:
        sys.stdout.write(line(record))
    sys.stdout.flush()


def _head(game: Game, loaded: Loaded) -> Record:
    """The first record: without the scenario's digest, as its user is another one."""
    from prima.loading.heads import VERSION

    scenario = game.cast.scenario
    own = os.path.basename(loaded.cast.scenario.node.source.file)
    return {
        "time": 0,
        "phase": "run",
        "actor": "mediator",
        "data": {
            "version": VERSION,
            "scenario": scenario.id,
            "policy": game.policy,
            "bound": None,
            **({} if scenario.patience == PATIENCE_MS else {"patience": scenario.patience / 1000}),
            "date": scenario.date,
            "applications": [doc.id for doc in game.cast.documents],
            "files": {name: digest for name, digest in loaded.files.items() if name != own},
        },
    }


def _greet(game: Game, screen: Screen) -> None:
    if game.scene.left_out:
        tell("The scenario's user is you: what he does there is left out; --scripted keeps it.")
    if screen.interactive:
        tell("Type what you say, /help for commands, /quit to end.")


class Screen:
    """Prints rows, answers and messages; above the line that is being typed, if there is one."""

    def __init__(self, game: Game, why: bool, json: bool, interactive: bool) -> None:
        self.interactive = interactive
        self.typist: Typist | None = None
        self._why = why
        self._json = json
        self._apps = game.names.applications
        self._headed = False

    def rows(self, rows: list[Row]) -> None:
        """Show rows as they happen."""
        from prima.transcript.table import format_head, format_row, layout

        if self._json:
            return
        shape = layout(self._apps, columns(), self._why)
        lines = [] if self._headed else [format_head(shape)]
        self._headed = True
        for row in rows:
            text = "\n".join(format_row(row, shape))
            colour = COLOURS.get(row.actor) if coloured() else None
            lines.append(click.style(clean(text), fg=colour) if colour else clean(text))
        self._print("\n".join(lines), styled=True)

    def show(self, text: str) -> None:
        """Show what was asked for: among records, that is a message."""
        if self._json:
            self.tell(text)
        else:
            self._print(text)

    def tell(self, text: str) -> None:
        """Tell what has gone wrong, or has been done."""
        if self.typist is not None:
            self.typist.clear()
        tell(text)
        if self.typist is not None:
            self.typist.restore()

    def _print(self, text: str, styled: bool = False) -> None:
        if self.typist is not None:
            self.typist.clear()
        if styled:
            click.echo(text)
        else:
            put(text)
        sys.stdout.flush()
        if self.typist is not None:
            self.typist.restore()


def _converse(conversation: Conversation, screen: Screen) -> None:
    """Read lines and carry them out until the session ends."""
    if screen.interactive:
        _edit_lines(conversation)
    if not conversation.real:
        _step_by_step(conversation, screen)
    elif screen.interactive:
        with Keyboard("> ") as keyboard:
            screen.typist = keyboard
            _real_time(conversation, keyboard)
            screen.typist = None
    else:
        _real_time(conversation, Piped())
    conversation.close()


def _edit_lines(conversation: Conversation) -> None:
    from prima.talk.typed import complete

    edit_lines(lambda text: complete(text, conversation.game.names, conversation.options))


def _step_by_step(conversation: Conversation, screen: Screen) -> None:
    """Time waits for every line."""
    piped = Piped()
    alone = sys.stdin is not None and sys.stdin.isatty() and not screen.interactive
    conversation.begin()
    while not conversation.done:
        try:
            if screen.interactive:
                text: str | None = input(conversation.prompt)
            else:
                if alone:
                    click.echo(conversation.prompt, nl=False, err=True)
                text = piped.line(None)
        except EOFError:
            click.echo()
            return
        except UnicodeDecodeError:
            conversation.refuse("The line is not UTF-8.")
            continue
        if text is None:
            return
        conversation.line(text)


def _real_time(conversation: Conversation, typist: Typist) -> None:
    """Time goes on by itself, but while somebody types."""
    game = conversation.game
    clock = Clock()
    while not conversation.done:
        due = conversation.pass_time(clock.now)
        if conversation.done:
            return
        try:
            text = clock.line(typist, due)
        except TimeoutError:
            continue
        except UnicodeDecodeError:
            conversation.refuse("The line is not UTF-8.")
            typist.ready()
            continue
        if text is None:
            return
        now = clock.now
        conversation.pass_time(now)
        conversation.line(text)
        if game.clock < now:  # it has gone back
            clock.back(game.clock)
        typist.ready()
