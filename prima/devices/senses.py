"""The senses: whether the camera sees the user, and which sensors' values have changed."""

from __future__ import annotations

import math

from prima.messages import Data, Inbound, Json, Occurred, Sensed

LOST_AFTER_MS = 1000
"""How long the user must be out of sight for the camera to have lost them."""


class Sight:
    """Finds and loses the user, ignoring brief interruptions (V4)."""

    def __init__(self) -> None:
        self._found = False
        self._unseen_since: int | None = None
        self.again = False
        """Whether to look once more though nothing moves: a Command that itself reports the user
        has ended without them, or the camera works again."""

    def due(self, now: int, visible: bool) -> int | None:
        """When to look again even if nothing moves (ms), if ever."""
        if self._unseen_since is not None:
            return self._unseen_since + LOST_AFTER_MS
        looks = self.again and not self._found if visible else self._found
        return now + 1 if looks else None

    def heeds(self, visible: bool) -> bool:
        """Whether looking is worthwhile: the user has come into view, or has just left it."""
        if visible:
            return not self._found or self._unseen_since is not None
        return self._found and self._unseen_since is None

    def look(self, now: int, visible: bool, where: Data, searching: bool = False) -> list[Inbound]:
        """Take in whether the user is visible; returns ``human.found`` or ``human.lost``.

        Args:
            now: the time.
            visible: whether the camera sees the user.
            where: their ``distance`` (m) and ``angle`` (degrees).
            searching: whether a Command that itself reports them is looking for them.
        """
        if visible:
            self._unseen_since = None
            if self._found or searching:
                return []
            self._found = True
            return [Occurred("human.found", "robot", where)]
        if not self._found:
            return []
        if self._unseen_since is None:
            self._unseen_since = now
        elif now - self._unseen_since >= LOST_AFTER_MS:
            self._found, self._unseen_since = False, None
            return [Occurred("human.lost", "robot")]
        return []

    def restore(self, found: bool) -> None:
        """Continue after an interrupted run in which the user was last seen or not."""
        self._found, self._unseen_since = found, None

    def find(self, where: Data) -> Inbound:
        """Note that a Command that looks for the user has found them."""
        self._found, self._unseen_since = True, None
        return Occurred("human.found", "robot", {**where, "sensed": True})


class Sensors:
    """The latest values of the sensors, so that only changes are reported (C6)."""

    def __init__(self) -> None:
        self.values: dict[str, Json] = {}

    def take(self, values: Data) -> list[Inbound]:
        """Take in current sensor values; returns those that have changed."""
        changed = {key: one for key, one in values.items() if self._differs(key, one)}
        self.values.update(changed)
        return [Sensed(changed)] if changed else []

    def _differs(self, key: str, one: Json) -> bool:
        """Whether a value is another one: 1 and true are equal in Python, and not in conditions."""
        before = self.values.get(key, ...)
        return before != one or isinstance(before, bool) != isinstance(one, bool)


def sensor_value(text: str) -> Json:
    """A sensor's value as people write it: true, false, a number, or else a text."""
    if text in ("true", "false"):
        return text == "true"
    try:
        number = float(text)
        return number if math.isfinite(number) else text
    except ValueError:
        return text
