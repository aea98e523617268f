"""Which handler takes an event: VoiceXML 2.0, section 5.2.4."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import lru_cache

from prima.interpreter.elements import Expression, Handler

Taking = tuple[tuple[Handler, tuple[str, ...]], ...]
"""Handlers that take an event, innermost scope first, each with the names that it takes it by."""


def takes(handler_event: str, event: str) -> bool:
    """Whether a handler's event name is the event's, or a prefix of it token by token."""
    return not handler_event or event == handler_event or event.startswith(f"{handler_event}.")


@lru_cache(maxsize=1000)
def prefixes(event: str) -> tuple[str, ...]:
    """All names under which an event counts: itself, its prefixes, and the empty one."""
    parts = event.split(".")
    return ("", *(".".join(parts[: n + 1]) for n in range(len(parts))))


def taking(handlers: Iterable[Handler], event: str) -> Taking:
    """Those of a list of handlers whose names take an event."""
    found = []
    for handler in handlers:
        names = tuple(name for name in handler.events if takes(name, event))
        if names:
            found.append((handler, names))
    return tuple(found)


def select_handler(
    candidates: Taking, occurrences: Callable[[str], int], holds: Callable[[Expression], bool]
) -> Handler | None:
    """Find the handler of an event among those whose names take it.

    Those whose condition does not hold are left out; of the rest, those with the highest
    count that the occurrences have reached remain, and the first of them it is.
    """
    found: Handler | None = None
    for handler, names in candidates:
        if handler.count > 1 and handler.count > max(map(occurrences, names)):
            continue
        holding = handler.cond is None or holds(handler.cond)
        if holding and (found is None or handler.count > found.count):
            found = handler
    return found
