"""prima talk."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.options import (
    MAPS,
    PathName,
    check_source,
    check_why,
    ea_option,
    fa_option,
    format_option,
    hosts_option,
    limit_option,
    map_option,
    policy_option,
    why_option,
)
from prima.cli.printing import tell, tell_problems, write_for_programs
from prima.cli.progress import print_records
from prima.cli.screen import TerminalScreen
from prima.cli.terminal import Keyboard, PausingClock, Piped, Typist, edit_lines, ending_well
from prima.errors import TOO_MUCH, RunError, UsageError

if TYPE_CHECKING:
    from prima.loading import Loaded
    from prima.messages import Record
    from prima.talk import Conversation, Game


@click.command()
@click.argument("scenario", type=PathName(), required=False)
@fa_option
@ea_option
@click.option("--world", type=PathName(), help="Let --fa and --ea run in this world.")
@click.option("--robot", type=PathName(), help="Let --fa and --ea run on this robot.")
@click.option(
    "--step", is_flag=True, help="Stop time until you type: the default outside a terminal."
)
@click.option(
    "--real-time", is_flag=True, help="Let time pass by itself: the default in a terminal."
)
@click.option(
    "--save", "target", type=PathName(), help="Write the session here as a scenario at its end."
)
@click.option("--scripted", is_flag=True, help="Carry out the scenario's user actions too.")
@policy_option("The mediator's policy: {}.")
@why_option
@hosts_option
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
    form: str,
) -> None:
    """Play the user of a run: type what they say and do, and watch the robot react.

    The user says what you type. Lines such as /touch head, /walk 3 0.5 or
    /message from Ann: I'm late are actions; /help lists them. Time stands still while
    you type; an empty line lets it go on. The end of input ends the session.
    /save FILE or --save FILE writes it as a scenario for prima run.

    Exit code 3 if an application ended by an error; 1 if a line from a file or pipe was wrong.

    \b
    prima talk documents/scenarios/touched-on-the-way.xml
    prima talk --fa documents/fa/follow.xml --ea documents/ea/library.xml --save visit.xml
    prima talk --ea museum.xml --world documents/worlds/museum.xml --robot papero.xml
    printf '/back 5s\\n/touch head\\n' | prima talk documents/scenarios/touched-on-the-way.xml
    """
    from prima.api.rehearsing import fetcher
    from prima.talk import Conversation, Game

    check_why(why, form)
    _check_options(scenario, bool(fas or eas), bool(world or robot), bool(maps), step and real_time)
    loaded = _loaded(scenario, fas, eas, world, robot, maps)
    tell_problems(loaded.problems)
    folder = os.path.dirname(scenario or "")
    json = form == "json"
    web = fetcher(list(hosts), len(loaded.cast.documents))
    game = Game(loaded, folder, policy, scripted, web, print_records if json else None)
    terminal = _is_terminal()
    screen = TerminalScreen(game, why, json, terminal)
    names = loaded.files if scenario is not None else [*loaded.files][1:]
    sources = [os.path.join(folder, name) for name in names]
    conversation = Conversation(game, screen, real_time or (terminal and not step), sources)
    if target is not None:
        conversation.check_target(target)
    if json:
        write_for_programs()
        print_records([_head(game, loaded)])
    _greet(game, screen)
    with ending_well(lambda: _keep(conversation, target)):
        try:
            _converse(conversation, screen)
        finally:
            _keep(conversation, target)
    _finish(conversation, terminal)


def _is_terminal() -> bool:
    return sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()


def _loaded(
    scenario: str | None,
    fas: tuple[str, ...],
    eas: tuple[str, ...],
    world: str | None,
    robot: str | None,
    maps: tuple[str, ...],
) -> Loaded:
    """The scenario, or the applications on a stage."""
    from prima import api

    if scenario is not None:
        return api.load_scenario(scenario)
    return api.stage(fas, eas, (), world, robot, maps)


def _check_options(
    scenario: str | None, applications: bool, staged: bool, maps: bool, both_times: bool
) -> None:
    """Refuse options that contradict each other.

    Raises:
        UsageError: they do.
    """
    check_source(scenario is not None, applications)
    if scenario is not None and staged:
        message = "--world and --robot work only with --fa and --ea: a scenario names its own."
        raise UsageError(message)
    if scenario is not None and maps:
        raise UsageError(MAPS)
    if both_times:
        raise UsageError("Write --step or --real-time, not both.")


def _finish(conversation: Conversation, terminal: bool) -> None:
    """Set the exit code.

    Raises:
        Exit: an application ended by an error, or a line from a file or pipe was wrong.
        RunError: the run ended by a limit.
    """
    game = conversation.game
    if game.stopped == "limit":
        raise RunError(TOO_MUCH)
    if game.failures:
        raise Exit(3)
    if conversation.wrong and not terminal:
        raise Exit(1)


def _keep(conversation: Conversation, target: str | None) -> None:
    """Write the session to the file after --save."""
    if target is not None:
        conversation.save(target)
        tell(f"Saved {target}.")


def _head(game: Game, loaded: Loaded) -> Record:
    """The first record, without the scenario's digest, since its user is replaced."""
    from prima.loading import Loaded
    from prima.loading.heads import run_record

    own = os.path.basename(loaded.cast.scenario.node.source.file)
    files = {name: digest for name, digest in loaded.files.items() if name != own}
    played = Loaded(game.cast, files)
    return run_record(played, game.policy, None, game.cast.scenario.patience)


def _greet(game: Game, screen: TerminalScreen) -> None:
    if game.scene.left_out:
        tell(
            "You are the scenario's user: their scripted actions are left out; --scripted keeps them."
        )
    if screen.interactive:
        tell("Type what you say, /help for commands, /quit to end.")


def _converse(conversation: Conversation, screen: TerminalScreen) -> None:
    """Read lines and carry them out until the session ends."""
    from prima.talk.typed import complete

    if screen.interactive:
        edit_lines(lambda text: complete(text, conversation.game.names, conversation.options))
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


def _step_by_step(conversation: Conversation, screen: TerminalScreen) -> None:
    """Read lines while time stands still."""
    piped = Piped()
    conversation.begin()
    while not conversation.done:
        try:
            text = _ask(conversation.prompt, piped, screen.interactive)
        except EOFError:
            click.echo()
            return
        except UnicodeDecodeError:
            conversation.refuse("The line is not UTF-8.")
            continue
        if text is None:
            return
        conversation.line(text)


def _ask(prompt: str, piped: Piped, interactive: bool) -> str | None:
    """The next line, or None at the end of input; prompts at a terminal.

    Raises:
        EOFError: the end of input, at a terminal.
        UnicodeDecodeError: the line is not UTF-8.
    """
    if interactive:
        return input(prompt)
    if sys.stdin is not None and sys.stdin.isatty():
        click.echo(prompt, nl=False, err=True)
    return piped.line(None)


def _real_time(conversation: Conversation, typist: Typist) -> None:
    """Read lines while time passes, except while the user types."""
    game = conversation.game
    clock = PausingClock()
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
        if not conversation.done:  # else Python ends while a line is awaited
            typist.ready()
