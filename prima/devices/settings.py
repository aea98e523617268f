"""The drivers of a robot's document, as values."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from prima.devices.reading import Reader, part_of
from prima.errors import Place, UsageError, one_of
from prima.language.values import BadValue, read_value
from prima.markup.tree import Node
from prima.messages import Json

SLOT = re.compile(r"\{([a-z][a-z-]*)\}")
"""A placeholder for a Command's value."""
WRITTEN_SLOT = re.compile(r"\{([\w-]+)\}")
"""What an author may have meant as one."""
DEGREES = ("angle", "heading", "pan", "tilt", "down", "turn", "turn-speed")
"""Values that are also available in radians: ``{NAME-radians}``."""
SLOTS = frozenset(f"{name}-radians" for name in DEGREES) | {
    *("text", "lang", "language", "x", "y", "heading", "heading-z", "heading-w"),
    *("turn", "turn-speed", "down", "seconds"),
}
"""The placeholders that do not have the name of an argument."""
SENSES = ("event", "sensor", "as")
DOES = ("command", "gesture")


@dataclass(frozen=True, slots=True)
class DriverLimits:
    """How long (ms) a driver may take before it is given up; None for no limit."""

    accept: int | None = None
    """To begin a goal."""
    progress: int | None = None
    """To report on a goal again."""
    cancel: int | None = None
    """To confirm that a goal has stopped."""

    def over(self, others: DriverLimits) -> DriverLimits:
        """These limits where they are given, else the others."""
        return DriverLimits(
            others.accept if self.accept is None else self.accept,
            others.progress if self.progress is None else self.progress,
            others.cancel if self.cancel is None else self.cancel,
        )


FOREVER = DriverLimits()
USUAL = DriverLimits(accept=5_000, cancel=5_000)
"""The defaults. A driver need not report while a goal goes on."""


@dataclass(frozen=True, slots=True)
class Does:
    """How a Command, or a gesture, is carried out."""

    command: str
    gesture: str
    by: str
    type: str
    kind: str
    """``action``, ``service`` or ``topic``, if it has to be specified."""
    limits: DriverLimits
    values: tuple[tuple[str, str], ...]
    """Names and values of the interface's arguments as written."""
    place: Place
    stop: str = ""
    """The service or method that stops it, if cancelling does not."""

    def filled(self, given: Mapping[str, Json]) -> dict[str, Json]:
        """The arguments as nested values, with the Command's values filled in.

        A value that is a single slot keeps its type; one without slots is read as JSON if valid.
        An argument whose slot has no value is omitted. Slots may be in a JSON list.
        """
        filled: dict[str, Json] = {}
        for name, written in self.values:
            value = _fill(written, given)
            if value is not None:
                _put(filled, name.split("."), value)
        return filled


def _fill(written: str, given: Mapping[str, Json]) -> Json:
    whole = SLOT.fullmatch(written)
    if whole:
        return given.get(whole[1])
    if SLOT.search(written):
        said = SLOT.sub(lambda slot: str(given.get(slot[1], "")), written)
        if not written.startswith("["):
            return said
        written = said
    try:
        return json.loads(written)
    except ValueError:
        return written


def _put(values: dict[str, Json], path: list[str], value: Json) -> None:
    for name in path[:-1]:
        inner = values.setdefault(name, {})
        values = inner if isinstance(inner, dict) else {}
    values[path[-1]] = value


@dataclass(frozen=True, slots=True)
class Senses:
    """Something that a driver reports of its own accord."""

    what: str
    """``event``, ``sensor``, or the value of ``as``: ``heard``, ``pose``, ``human``, ``emergency``."""
    name: str
    """The event's or sensor's."""
    by: str
    type: str
    field: str
    when: str
    actor: Any
    place: Place

    def value(self, message: Json) -> Json:
        """The relevant part of a message; None if the message lacks it."""
        return part_of(message, self.field) if self.field else message

    def holds(self, value: Json) -> bool:
        """Whether an event is raised at a value."""
        if not self.when:
            return value is not None
        return value == _fill(self.when, {}) or str(value) == self.when


@dataclass(frozen=True, slots=True)
class Pose:
    """A place: metres, and degrees to the left of the x axis."""

    x: float
    y: float
    heading: float


@dataclass(slots=True)
class DriverSettings:
    """A ``driver`` element. Times are ms."""

    kind: str
    address: str
    devices: frozenset[str]
    """Its devices; empty until :func:`share_devices` has given it the remaining ones."""
    open: int
    heartbeat: int
    limits: DriverLimits
    does: list[Does]
    senses: list[Senses]
    place: Place
    places: dict[str, Pose] = field(default_factory=dict)
    options: dict[str, str] = field(default_factory=dict)

    def how(self, command: str, gesture: str = "") -> Does | None:
        """How a Command is carried out, if specified; an entry for its gesture comes first."""
        said = [one for one in self.does if one.command == command]
        own = (one for one in said if gesture and one.gesture == gesture)
        return next(own, None) or next((one for one in said if not one.gesture), None)

    def check_options(self, *known: str) -> None:
        """Refuse options that the driver does not have.

        Raises:
            UsageError: there is one.
        """
        if unknown := sorted(self.options.keys() - {*known}):
            remedy = f"Write {one_of(known)}." if known else "Remove it."
            message = f'there is no option "{unknown[0]}". {remedy}'
            raise UsageError(f"{self.place}: {message}")

    def choice(self, name: str, *allowed: str) -> str:
        """An option that is one of several words; the first is the default.

        Raises:
            UsageError: it is another word.
        """
        text = self.options.get(name, allowed[0])
        if text not in allowed:
            words = one_of(one for one in allowed if one)
            raise UsageError(f'{self.place}: {name} is "{text}". Write {words}.')
        return text

    def number(self, name: str, low: float, high: float, usual: float) -> float:
        """An option that is a number between two others.

        Raises:
            UsageError: it is not.
        """
        text = self.options.get(name, str(usual))
        try:
            number = float(read_value("number", text))
        except BadValue:
            number = math.nan
        if not low <= number <= high:
            message = f'{name} is "{text}". Write a number from {low:g} to {high:g}.'
            raise UsageError(f"{self.place}: {message}")
        return number


def read_driver(reader: Reader, node: Node) -> DriverSettings:
    """Read a ``driver`` element."""
    _check_twice(reader, node)
    return DriverSettings(
        kind=node.get("kind"),
        address=node.get("address"),
        devices=frozenset(node.get("devices").split()),
        open=reader.get(node, "open"),
        heartbeat=reader.get(node, "heartbeat"),
        limits=_limits(reader, node).over(USUAL),
        does=[_does(reader, child) for child in node.all("does")],
        senses=[_senses(reader, child) for child in node.all("senses")],
        place=node.place,
        places={
            child.get("name"): Pose(
                reader.get(child, "x") or 0.0,
                reader.get(child, "y") or 0.0,
                reader.get(child, "heading") or 0.0,
            )
            for child in node.all("place")
        },
        options={child.get("name"): child.get("value") for child in node.all("option")},
    )


def _check_twice(reader: Reader, node: Node) -> None:
    """Duplicate entries, of which only one would count."""
    for tag in ("option", "place"):
        reader.check_twice(node.all(tag), "name")
    does = node.all("does")
    commands = [one for one in does if not one.get("gesture")]
    gestures = [one for one in does if one.get("gesture")]
    reader.check_twice((one for one in commands if one.get("command")), "command")
    reader.check_twice((one for one in gestures if not one.get("command")), "gesture")
    for one in does:
        reader.check_twice(one.all("set"), "name")


def _limits(reader: Reader, node: Node) -> DriverLimits:
    return DriverLimits(*(reader.get(node, name) for name in ("accept", "progress", "cancel")))


def _does(reader: Reader, node: Node) -> Does:
    if not any(name in node.attributes for name in DOES):
        message = "<does> needs a command or a gesture."
        reader.problem(node, "missing-attribute", message, "", 'Write command="...".')
    command = node.get("command") or ("gesture" if node.get("gesture") else "")
    values = tuple((child.get("name"), child.get("value")) for child in node.all("set"))
    return Does(
        command,
        node.get("gesture"),
        node.get("by"),
        node.get("type"),
        node.get("as"),
        _limits(reader, node),
        values,
        node.place,
        node.get("stop"),
    )


def _senses(reader: Reader, node: Node) -> Senses:
    given = [name for name in SENSES if name in node.attributes]
    if len(given) != 1:
        message = "<senses> needs exactly one of event, sensor, as."
        if given:
            reader.problem(node, "exclusive", message, given[1], "Write a <senses> for each.")
        else:
            remedy = 'Write event="...", sensor="..." or as="heard".'
            reader.problem(node, "missing-attribute", message, "", remedy)
    elif node.get("event") == "speech" and node.get("actor", "user") == "user":
        message = 'The event "speech" of a user needs the words that they say.'
        reader.problem(node, "bad-value", message, "event", 'Write as="heard" instead.')
    what = given[0] if given else "event"
    return Senses(
        node.get("as") if what == "as" else what,
        "" if what == "as" else node.get(what),
        node.get("by"),
        node.get("type"),
        node.get("field"),
        node.get("when"),
        node.get("actor", "user"),
        node.place,
    )


def share_devices(drivers: list[DriverSettings], devices: frozenset[str]) -> None:
    """Give the drivers that name no devices all devices that no other driver names."""
    left = devices - {name for one in drivers for name in one.devices}
    for driver in drivers:
        driver.devices = driver.devices or left
