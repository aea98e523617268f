"""Interprets a robot's messages by the ``senses`` of its document."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Literal, cast

from prima.devices.goals import At, News, Sees
from prima.devices.settings import Senses
from prima.messages import Emergency, Heard, Json, Occurred, Sensed

Actor = Literal["user", "environment", "robot"]


class SenseReports:
    """Turns messages into news; unchanged values are not reported again."""

    def __init__(self) -> None:
        self._waiting: dict[int, tuple[Senses, Json]] = {}
        """The newest values of sensors."""
        self._news: list[News] = []
        self._last: dict[int, Json] = {}
        """The latest report of each ``senses``, or whether its event held."""

    def take(self, senses: Senses, message: Json) -> None:
        """Take a message."""
        value = senses.value(message)
        match senses.what:
            case "event":
                if self._begins(senses, value):
                    self._news.append(Occurred(senses.name, cast(Actor, senses.actor)))
            case "heard":
                self._news += _heard(message, value)
            case "emergency":
                pressed = senses.holds(value) if senses.when else bool(value)
                if self._changes(senses, pressed, False):
                    self._news.append(Emergency(pressed))
            case _ if value is not None:
                self._waiting[id(senses)] = (senses, value)

    def drain(self) -> list[News]:
        """All news since the last call."""
        news, self._news = self._news, []
        waiting, self._waiting = self._waiting, {}
        for senses, value in waiting.values():
            made = _state(senses, value)
            if made is not None and self._changes(senses, made):
                news.append(made)
        return news

    def _begins(self, senses: Senses, value: Json) -> bool:
        """Whether an event happens: at each message, or when its value begins to match."""
        holds = senses.holds(value)
        if not senses.when:
            return True
        return self._changes(senses, holds, False) and holds

    def _changes(self, senses: Senses, value: Any, first: Any = None) -> bool:
        before = self._last.get(id(senses), first)
        self._last[id(senses)] = value
        return bool(before != value)


def _state(senses: Senses, value: Json) -> News | None:
    if senses.what == "sensor":
        return Sensed(dict(_flat(senses.name, value)))
    return pose(value) if senses.what == "pose" else _human(senses, value)


def _flat(name: str, value: Json) -> Iterator[tuple[str, Json]]:
    """The values of a sensor, by dotted names."""
    if not isinstance(value, dict):
        yield name, value
        return
    for key, inner in value.items():
        yield from _flat(f"{name}.{key}", inner)


def _human(senses: Senses, value: Json) -> Sees:
    """Whether the user is seen: by a value, a non-empty list, or a message that says so."""
    if not isinstance(value, dict):
        return Sees(senses.holds(value) if senses.when else bool(value))
    visible = bool(value.get("visible", True))
    distance, angle = value.get("distance"), value.get("angle")
    return Sees(visible, distance, angle) if visible else Sees(False)


def pose(value: Json) -> At | None:
    """The pose in a message: ROS's pose within poses, x, y and theta in radians, or a list of these.

    None if there is none.
    """
    try:
        return _pose(value)
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError):
        return None


def _pose(value: Json) -> At | None:
    while isinstance(value, dict) and "pose" in value:
        value = value["pose"]
    if isinstance(value, dict) and "position" in value:
        at, turned = value["position"], value.get("orientation", {})
        x, y, z, w = (float(turned.get(name, name == "w")) for name in "xyzw")
        theta = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        return At(float(at["x"]), float(at["y"]), math.degrees(theta))
    if isinstance(value, dict):
        value = [value.get("x"), value.get("y"), value.get("theta", 0.0)]
    if not isinstance(value, list) or len(value) < 3:
        return None
    if not all(isinstance(one, int | float) for one in value[:3]):
        return None
    return At(float(value[0]), float(value[1]), math.degrees(float(value[2])))


def _heard(message: Json, value: Json) -> list[News]:
    """A recogniser's result: a text, or texts with their confidence, the best first."""
    if isinstance(value, list):
        return _ranked(value)
    text = "" if value is None else str(value).strip()
    given = message.get("confidence") if isinstance(message, dict) else None
    known: dict[str, Json] = {} if given is None else {"confidence": _share(given)}
    return [Heard(text, known)] if text else []


def _ranked(value: list[Json]) -> list[News]:
    """The texts heard, each followed by its confidence, the best first."""
    pairs: list[dict[str, Json]] = [
        {"text": str(text).strip(), "confidence": _share(sure)}
        for text, sure in zip(value[::2], value[1::2], strict=False)
        if str(text).strip()
    ]
    if not pairs:
        return []
    data: dict[str, Json] = {"confidence": pairs[0]["confidence"]}
    if pairs[1:]:
        data["alternatives"] = pairs[1:]
    return [Heard(str(pairs[0]["text"]), data)]


def _share(value: Json) -> float:
    return min(max(float(value), 0.0), 1.0) if isinstance(value, int | float) else 1.0
