"""Objects in another process, whose methods are called there."""

from __future__ import annotations

from functools import partial
from typing import Any

from prima.script.evaluation import EngineLost
from prima.script.host import METHODS
from prima.script.worker import Handle, Meter, Worker


class Remote:
    """An object in another process.

    It has the methods that :data:`~prima.script.host.METHODS` lists for its class. Values of the
    engine, as arguments and as results, are :class:`~prima.script.worker.Handle` here.
    """

    there = ""
    """The name of its class."""

    def __init__(self, host: Worker, meter: Meter, maker: str, *arguments: Any) -> None:
        self.host = host
        self._use = host.use
        self._meter = meter
        self._here: Handle = host.call(0, maker, [*map(_sent, arguments)], meter)

    def __getattr__(self, name: str) -> Any:
        if name not in METHODS[self.there]:
            raise AttributeError(f"{self.there} has no method {name}")
        return partial(self._call, name)

    def _call(self, method: str, *arguments: Any) -> Any:
        if self._use != self.host.use:
            raise EngineLost("its run has ended")
        return self.host.call(self._here.number, method, [*map(_sent, arguments)], self._meter)


def _sent(value: Any) -> list[Any]:
    """An argument as it is sent: values of the engine by their numbers, or data."""
    if isinstance(value, Handle):
        return ["value", value.number]
    if isinstance(value, tuple) and any(isinstance(one, Handle) for one in value):
        return ["values", [one.number for one in value]]
    return ["data", value]
