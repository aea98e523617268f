"""Calls to engines in another process, and their arguments."""

from __future__ import annotations

from typing import Any

from prima.script.evaluation import EngineLost
from prima.script.worker import Handle, Meter, Worker


def as_data(value: Any) -> list[Any]:
    """Data as an argument."""
    return ["data", value]


def as_value(value: Handle) -> list[Any]:
    """A value of the engine as an argument."""
    return ["value", value.number]


def as_values(values: tuple[Handle, ...]) -> list[Any]:
    """Several values of the engine as one argument."""
    return ["values", [one.number for one in values]]


class Remote:
    """An object in another process."""

    def __init__(self, host: Worker, maker: str, arguments: list[Any], meter: Meter) -> None:
        self.host = host
        self._use = host.use
        self._meter = meter
        self._here: Handle = host.call(0, maker, arguments, meter)

    def _call(self, method: str, *arguments: list[Any]) -> Any:
        if self._use != self.host.use:
            raise EngineLost("its run has ended")
        return self.host.call(self._here.number, method, list(arguments), self._meter)
