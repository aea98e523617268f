"""The process that evaluates untrusted code: engines, and limits on the whole process.

It answers the calls of :mod:`prima.script.worker`, one after the other. Each may take a limited
processor time, counted by the system, whatever else the machine does; the process may use limited
memory, and cannot open or write files. Exceeding a limit ends the process, which is all that its
caller needs to know.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Mapping
from typing import Any

KILL_SECONDS = 2.0
"""Processor time after which a call that escaped the engine's own limit ends the process."""
MEMORY_BYTES = 512 * 1024 * 1024
"""Address space of the process."""
OUT_OF_MEMORY = 71
"""The exit code when memory has run out."""
FILES = 16
"""Maximum number of open files of the process: the engine needs none."""

GIVES_NOTHING, GIVES_DATA, GIVES_VALUE = range(3)
"""The kind of a method's result: data leaves the process, a value of the engine stays."""

METHODS: Mapping[str, Mapping[str, int]] = {
    "EngineService": {
        "engine": GIVES_VALUE, "tag_engine": GIVES_VALUE, "syntax": GIVES_VALUE,
        "reset": GIVES_NOTHING,
    },
    "Engine": {
        "compile": GIVES_NOTHING, "lenient": GIVES_DATA, "scope": GIVES_VALUE,
        "named": GIVES_VALUE, "view": GIVES_VALUE, "event": GIVES_VALUE, "clock": GIVES_NOTHING,
        "set": GIVES_NOTHING, "fill": GIVES_NOTHING, "unset": GIVES_NOTHING, "has": GIVES_DATA,
        "defined": GIVES_DATA, "first_undefined": GIVES_DATA, "raw": GIVES_VALUE, "condition": GIVES_DATA, "text": GIVES_DATA, "value": GIVES_DATA,
        "listed": GIVES_VALUE, "length": GIVES_DATA, "pick": GIVES_NOTHING,
        "assign": GIVES_NOTHING, "assign_declared": GIVES_NOTHING, "detach": GIVES_NOTHING,
        "hand": GIVES_NOTHING, "script": GIVES_NOTHING,
        "empty": GIVES_VALUE,
    },
    "TagEngine": {
        "run": GIVES_NOTHING, "box": GIVES_VALUE, "environment": GIVES_VALUE,
        "rule": GIVES_VALUE, "resume": GIVES_VALUE, "reached": GIVES_DATA, "fault": GIVES_DATA, "carry": GIVES_DATA,
        "take": GIVES_VALUE, "json": GIVES_DATA,
    },
    "Syntax": {"expression": GIVES_NOTHING, "script": GIVES_NOTHING, "has_statements": GIVES_DATA,
               "faults": GIVES_DATA},
}  # fmt: skip
"""The methods that may be called, by class."""


class EngineService:
    """Answers calls; keeps the objects created until the caller drops them."""

    now, spent = 0, 0.0

    def __init__(self) -> None:
        self._last = 0
        self._kept: dict[int, Any] = {0: self}

    def reset(self) -> None:
        """Forget everything, for another caller."""
        self._kept = {0: self}

    def engine(self, scopes: list[str]) -> Any:
        """A new engine whose expressions see these scopes."""
        from prima.script.engine import Engine

        return Engine(tuple(scopes))

    def tag_engine(self, others: int) -> Any:
        """A new engine for a grammar document's tags, besides others for the same utterance."""
        from prima.script.tagengine import TagEngine

        return TagEngine(others)

    def syntax(self) -> Any:
        """The compiler of code that is not run."""
        from prima.script.syntax import Syntax

        return Syntax()

    def answer(self, request: list[Any]) -> list[Any]:
        """``[dropped, target, method, arguments, now, spent]`` gives ``[kind, result, spent]``."""
        from prima.script.evaluation import ScriptError

        dropped, target, method, arguments, now, spent = request
        for number in dropped:
            self._kept.pop(number, None)
        holder = self._kept[target]
        gives = METHODS[type(holder).__name__][method]
        holder.now, holder.spent = now, spent
        try:
            result = getattr(holder, method)(*map(self._taken, arguments))
        except ScriptError as error:
            return ["error", [str(error), error.places, error.line, error.column], holder.spent]
        except MemoryError:
            raise
        except Exception as error:
            return ["defect", f"{type(error).__name__}: {error}", holder.spent]
        if gives == GIVES_VALUE:
            self._last += 1
            self._kept[self._last] = result
            return ["value", self._last, holder.spent]
        return ["data", result if gives == GIVES_DATA else None, holder.spent]

    def _taken(self, argument: list[Any]) -> Any:
        """An argument: data, a value in this process, or several of these."""
        kind, value = argument
        if kind == "data":
            return value
        if kind == "value":
            return self._kept[value]
        return tuple(self._kept[one] for one in value)


def limit() -> None:
    """Limit the resources of this process from now on."""
    import resource

    bounds = {
        resource.RLIMIT_AS: MEMORY_BYTES,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_FSIZE: 0,
        resource.RLIMIT_NOFILE: FILES,
    }
    for what, most in bounds.items():
        try:
            resource.setrlimit(what, (most, most))
        except (OSError, ValueError):  # not on this system, or a lower limit applies already
            continue


def serve(requests: int, replies: int) -> None:
    """Answer until the caller has gone."""
    from prima.script.wire import LONGEST_REPLY, LONGEST_REQUEST, TooMuch, WireBroken, receive, send

    service = EngineService()
    while True:
        try:
            request = receive(requests, LONGEST_REQUEST)
            signal.setitimer(signal.ITIMER_PROF, KILL_SECONDS)
            reply = service.answer(request)
            try:
                send(replies, reply, LONGEST_REPLY)
            except TooMuch as error:
                send(replies, ["error", [str(error), [], 0, 0], reply[2]], LONGEST_REPLY)
        except (TooMuch, WireBroken):
            return


def main() -> None:
    """Run as a program: its argument is where Python finds modules."""
    sys.path[:] = json.loads(sys.argv[1])
    import prima.script.engine
    import prima.script.syntax
    import prima.script.tagengine  # noqa: F401  (no file can be opened later)

    limit()
    try:
        serve(0, 1)
    except MemoryError:
        os._exit(OUT_OF_MEMORY)


if __name__ == "__main__":
    main()
