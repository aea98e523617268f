"""Input of an operator besides the user's words: the commands of ``prima talk`` for a robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from prima.devices.goals import News, Sees
from prima.devices.lines import check_line, split_event, split_message, split_sensor
from prima.devices.senses import sensor_value
from prima.errors import UsageError, did_you_mean
from prima.language.values import BadValue, read_value
from prima.live.wellformed import EMERGENCY
from prima.messages import Emergency, Occurred, Sensed

NEAR_M = 1.0
"""How far in front of the robot the user is."""
HERE = Sees(True, NEAR_M, 0.0)


@dataclass(frozen=True, slots=True)
class ConsoleCommand:
    """A command: its syntax, what it does, and what it reports to the run."""

    usage: str
    help: str
    tells: Callable[[str], News] | None = None
    """Parses what follows the name; None if nothing is reported."""


@dataclass(frozen=True, slots=True)
class Typed:
    """A line: the user's words, news, or a command of another kind with its arguments."""

    said: str = ""
    news: News | None = None
    command: str = ""
    rest: str = ""


def _touch(rest: str) -> News:
    if not rest or " " in rest:
        raise UsageError(f'Write "{COMMANDS["touch"].usage}".')
    return Occurred(f"touch.{rest}", "user", {"sensor": rest})


def _event(rest: str) -> News:
    name, data = split_event(rest, COMMANDS["event"].usage)
    try:
        read_value("event", name)
    except BadValue as error:
        raise UsageError(f'"{name}" {error}') from None
    if name in EMERGENCY:
        raise UsageError(f'Write "{COMMANDS["stop"].usage}" or "{COMMANDS["go"].usage}".')
    return Occurred(name, "environment", data)


def _sensor(rest: str) -> News:
    name, value = split_sensor(rest, COMMANDS["sensor"].usage)
    return Sensed({name: sensor_value(value)})


def _message(rest: str) -> News:
    sender, text = split_message(rest, COMMANDS["message"].usage)
    return Occurred("message", "environment", {"from": sender, "text": text})


def _alone(news: News) -> Callable[[str], News]:
    """A command without arguments."""

    def tell(rest: str) -> News:
        if rest:
            raise UsageError("Nothing follows this command.")
        return news

    return tell


COMMANDS = {
    "touch": ConsoleCommand("/touch SENSOR", "touches the robot", _touch),
    "event": ConsoleCommand("/event NAME KEY=VALUE ...", "an event of the surroundings", _event),
    "sensor": ConsoleCommand("/sensor NAME=VALUE", "a sensor's value changes", _sensor),
    "message": ConsoleCommand("/message from NAME: TEXT", "a message arrives", _message),
    "leave": ConsoleCommand(
        "/leave", "the user goes away and is seen no more", _alone(Sees(False))
    ),
    "come": ConsoleCommand("/come", "the user is seen again", _alone(HERE)),
    "stop": ConsoleCommand("/stop", "the emergency stop is pressed", _alone(Emergency(True))),
    "go": ConsoleCommand(
        "/go", "it is released, and what it stopped goes on", _alone(Emergency(False, True))
    ),
    "wait": ConsoleCommand("/wait TIME, /wait", "the next line waits so long, or for a question"),
    "help": ConsoleCommand("/help", "says this"),
    "quit": ConsoleCommand("/quit", "ends the run, as Ctrl-C does"),
}


def read_typed(text: str) -> Typed:
    """Read a line that is not empty.

    Raises:
        UsageError: it is invalid; the message says what to write.
    """
    check_line(text)
    text = " ".join(text.split())
    if not text.startswith("/"):
        return Typed(said=text)
    word, _, rest = text[1:].partition(" ")
    command = COMMANDS.get(word)
    if command is None:
        hint = did_you_mean(f"/{word}", [f"/{name}" for name in COMMANDS]) or "Type /help."
        raise UsageError(f'There is no command "/{word[:60]}". {hint}')
    if command.tells is not None:
        return Typed(news=command.tells(rest))
    if word == "wait" and rest:
        _duration(rest)
    return Typed(command=word, rest=rest)


def _duration(text: str) -> int:
    try:
        return int(read_value("duration", text))
    except BadValue as error:
        raise UsageError(f'"{text}" {error}') from None


def waits(rest: str) -> int | None:
    """How long (ms) a ``/wait`` lasts; None: until a question listens."""
    return _duration(rest) if rest else None


def help_text() -> str:
    """A description of the commands."""
    wide = max(len(one.usage) for one in COMMANDS.values())
    lines = [f"{one.usage:<{wide}}  {one.help}" for one in COMMANDS.values()]
    return "\n".join([f"{'TEXT':<{wide}}  the user says it", *lines])
