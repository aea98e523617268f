"""Reads typed lines as elements of a scenario's ``when``."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from html import escape

from prima.devices.lines import check_line, split_event, split_message, split_sensor
from prima.errors import UsageError, did_you_mean
from prima.language.values import read_value

PIECE = re.compile(r"(?:^|\s+)(?=/[^\W\d])")
"""The place before a command in a line."""


@dataclass(frozen=True, slots=True)
class TypedNames:
    """Names that commands may use in the current run."""

    sensors: frozenset[str] = frozenset()
    points: frozenset[str] = frozenset()
    devices: frozenset[str] = frozenset()
    applications: frozenset[str] = frozenset()
    events: frozenset[str] = frozenset()
    """Events that applications handle."""


@dataclass(frozen=True, slots=True)
class TypedCommand:
    """A command: its usage, help and element."""

    name: str
    usage: str
    help: str
    element: Callable[[str], str] | None = None
    """Makes the element of a ``when`` from the arguments; None for controls."""
    names: Callable[[TypedNames], Iterable[str]] = lambda names: ()
    """Possible arguments."""


@dataclass(frozen=True, slots=True)
class TypedLine:
    """A line: actions as XML, and the time (ms) to wait after them, if given.

    ``control`` is the command of a line without actions, ``rest`` its arguments.
    """

    xml: str = ""
    linger: int = 0
    control: str = ""
    rest: str = ""

    @property
    def loads(self) -> bool:
        """Whether it loads an application."""
        return "<load " in self.xml


def element(tag: str, text: str = "", **values: str) -> str:
    """An element with attributes, without empty ones."""
    given = "".join(f' {key}="{escape(value)}"' for key, value in values.items() if value)
    content = escape(text, quote=False)
    return f"<{tag}{given}>{content}</{tag}>" if text else f"<{tag}{given}/>"


def _plain(tag: str) -> Callable[[str], str]:
    """A command without arguments."""

    def make(rest: str) -> str:
        if rest:
            raise UsageError(f'Nothing follows "/{tag}".')
        return element(tag)

    return make


def _word(tag: str, attribute: str) -> Callable[[str], str]:
    """A command with one word as argument."""

    def make(rest: str) -> str:
        if not rest or " " in rest:
            raise UsageError(f'Write "{COMMANDS[tag].usage}".')
        return element(tag, **{attribute: rest})

    return make


def _text(tag: str) -> Callable[[str], str]:
    """A command with a text as argument."""

    def make(rest: str) -> str:
        if not rest:
            raise UsageError(f'Write "{COMMANDS[tag].usage}".')
        return element(tag, rest)

    return make


def _look(rest: str) -> str:
    return _word("look", "at")(rest.removeprefix("at "))


def _walk(rest: str) -> str:
    words = rest.removeprefix("to ").replace(",", " ").split()
    if len(words) == 1:
        return element("walk", to=words[0])
    if len(words) == 2:
        for word in words:
            _read("number", word)
        return element("walk", x=words[0], y=words[1])
    raise UsageError(f'Write "{COMMANDS["walk"].usage}".')


def _message(rest: str) -> str:
    sender, text = split_message(rest, COMMANDS["message"].usage)
    return element("message", text, **{"from": sender})


def _fail(rest: str) -> str:
    device, _, how = rest.partition(" ")
    if not device or how not in ("", "hangs"):
        raise UsageError(f'Write "{COMMANDS["fail"].usage}".')
    return element("fail", device=device, hangs="true" if how else "")


def _event(rest: str) -> str:
    name, given = split_event(rest, COMMANDS["event"].usage)
    pairs = given.items()
    data = "".join(f'<data name="{escape(key)}" value="{escape(text)}"/>' for key, text in pairs)
    return f'<event name="{escape(name)}">{data}</event>' if data else element("event", name=name)


def _sensor(rest: str) -> str:
    name, value = split_sensor(rest, COMMANDS["sensor"].usage)
    return element("sensor", name=name, value=value)


def _read(kind: str, text: str) -> int:
    """A time in ms, or another value, which is only checked."""
    try:
        value = read_value(kind, text)
    except ValueError as error:
        raise UsageError(f'"{text}" {error}') from None
    return int(value)


COMMANDS = {
    one.name: one
    for one in (
        TypedCommand("say", "/say TEXT", "says something, as does a line without a command",
            _text("say")),
        TypedCommand("touch", "/touch SENSOR", "touches the robot", _word("touch", "sensor"),
            lambda names: names.sensors),
        TypedCommand("walk", "/walk PLACE, /walk X Y", "walks to a place or thing, or to a point in metres",
            _walk, lambda names: names.points),
        TypedCommand("look", "/look at PLACE, /look at robot", "looks at something", _look,
            lambda names: [f"at {one}" for one in (*names.points, "robot")]),
        TypedCommand("follow", "/follow, /follow METRES", "follows the robot",
            lambda rest: element("follow", distance=rest)),
        TypedCommand("stay", "/stay", "stays where they are", _plain("stay")),
        TypedCommand("leave", "/leave", "goes away, out of sight", _plain("leave")),
        TypedCommand("hang-up", "/hang-up", "hangs up", _plain("hang-up")),
        TypedCommand("message", "/message from NAME: TEXT", "a message arrives", _message),
        TypedCommand("event", "/event NAME KEY=VALUE ...", "an event of the surroundings", _event,
            lambda names: names.events),
        TypedCommand("sensor", "/sensor NAME=VALUE", "a sensor's value changes", _sensor),
        TypedCommand("fail", "/fail DEVICE, /fail DEVICE hangs", "a device fails, or hangs", _fail,
            lambda names: names.devices),
        TypedCommand("repair", "/repair DEVICE", "the device works again", _word("repair", "device"),
            lambda names: names.devices),
        TypedCommand("emergency", "/emergency", "the emergency stop is pressed", _plain("emergency")),
        TypedCommand("release", "/release, /release false",
            "it is released; with false, stopped behaviors are given up",
            lambda rest: element("release", resume=rest)),
        TypedCommand("unload", "/unload APPLICATION", "an application is removed",
            _word("unload", "application"), lambda names: names.applications),
        TypedCommand("load", "/load APPLICATION", "an application that has ended starts again",
            _word("load", "application"), lambda names: names.applications),
        TypedCommand("note", "/note TEXT", "a remark for the reader", _text("note")),
        TypedCommand("wait", "/wait TIME", "time passes, as in /wait 3s"),
        TypedCommand("go", "/go", "time passes until the run needs you, as after an empty line"),
        TypedCommand("step", "/step", "time passes until the next row"),
        TypedCommand("back", "/back TIME", "goes back to a time, as in /back 5s"),
        TypedCommand("undo", "/undo", "undoes the last line"),
        TypedCommand("why", "/why, /why ROW", "explains the last row, or another"),
        TypedCommand("who", "/who", "shows what runs, what waits and what is asked"),
        TypedCommand("save", "/save FILE", "writes the session as a scenario"),
        TypedCommand("help", "/help, /help COMMAND", "shows this help"),
        TypedCommand("quit", "/quit", "ends the session"),
    )
}  # fmt: skip
"""All commands, in the order of the help."""


def read_line(text: str) -> TypedLine:
    """Read a line.

    Raises:
        UsageError: it is wrong; the message says what to write.
    """
    check_line(text)
    words = text.split(maxsplit=1)
    name = _name(words[0])[0] if words else "wait"
    if COMMANDS[name].element is None and name != "wait":
        return TypedLine(control=name, rest="".join(words[1:]).strip())
    pieces = [" ".join(piece.split()) for piece in PIECE.split(text)]
    made: list[str] = []
    linger = 0
    for name, rest in (_name(piece) for piece in pieces if piece):
        if name == "wait":
            linger += _wait(rest)
            continue
        if linger:
            made.append(_pause(linger, first=not made))
        linger = 0
        made.append(_element(name, rest))
    if made:
        return TypedLine("".join(made), linger)
    return TypedLine(linger=linger, control="wait" if linger else "go")


def _wait(rest: str) -> int:
    """The time of a /wait (ms)."""
    if not rest:
        raise UsageError('Write "/wait TIME", as in "/wait 3s".')
    return _read("duration", rest)


def _pause(linger: int, first: bool) -> str:
    """A pause between two actions."""
    if first:
        raise UsageError('A line begins with an action: "/touch head /wait 3s /say Stop."')
    return element("wait", **{"for": f"{linger}ms"})


def _element(name: str, rest: str) -> str:
    """The element of a command."""
    make = COMMANDS[name].element
    if make is None:
        raise UsageError(f'"/{name}" must be alone on its line.')
    return make(rest)


def _name(piece: str) -> tuple[str, str]:
    """The command of a piece of a line, and its arguments."""
    if not piece.startswith("/"):
        return "say", piece
    word, _, rest = piece[1:].partition(" ")
    if word not in COMMANDS:
        hint = did_you_mean(f"/{word}", [f"/{name}" for name in COMMANDS]) or "Type /help."
        raise UsageError(f'Unknown command "/{word[:60]}". {hint}')
    return word, rest.strip()


def complete(text: str, names: TypedNames, options: Iterable[str]) -> list[str]:
    """Completions of a line: commands, their arguments, answers to a question."""
    start = max(match.end() for match in re.finditer(r"(?:^|\s+(?=/))", text))
    before, piece = text[:start], text[start:]
    if not piece.startswith("/"):
        return [one for one in options if one.casefold().startswith(piece.casefold())]
    word, space, rest = piece[1:].partition(" ")
    if not space:
        return [f"{before}/{name} " for name in COMMANDS if name.startswith(word)]
    if word not in COMMANDS:
        return []
    choices = sorted(COMMANDS[word].names(names))
    return [f"{before}/{word} {one}" for one in choices if one.startswith(rest.lstrip())]


def help_text(name: str = "") -> str:
    """The help for all commands, or for one.

    Raises:
        UsageError: the command is unknown.
    """
    name = name.removeprefix("/").partition(" ")[0]  # ignore the rest
    if name and name not in COMMANDS:
        _name(f"/{name}")
    chosen = [COMMANDS[name]] if name else list(COMMANDS.values())
    wide = max(len(one.usage) for one in chosen)
    lines = [f"{one.usage:<{wide}}  {one.help}" for one in chosen]
    if not name:
        lines.append("Several on one line happen in sequence: Yes. /wait 2s /touch head")
    return "\n".join(lines)
