"""Which handler takes an event: VoiceXML 2.0, section 5.2.4."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from prima.interpreter.elements import Expression, Handler


def takes(handler_event: str, event: str) -> bool:
    """Whether a handler's event name is the event's, or a prefix of it token by token."""
    return not handler_event or event == handler_event or event.startswith(f"{handler_event}.")


def prefixes(event: str) -> list[str]:
    """All names under which an event counts: itself, its prefixes, and the empty one."""
    parts = event.split(".")
    return ["", *(".".join(parts[: n + 1]) for n in range(len(parts)))]


def select_handler(
    scopes: Iterable[list[Handler]],
    event: str,
    occurrences: Callable[[str], int],
    holds: Callable[[Expression], bool],
) -> Handler | None:
    """Find the handler of an event.

    The handlers of all scopes, innermost first, make one list. Those whose name
    or condition does not fit are left out; of the rest, those with the highest
    count that the occurrences have reached remain, and the first of them it is.
    """
    fitting: list[tuple[Handler, int]] = []
    for handlers in scopes:
        for handler in handlers:
            names = [name for name in handler.events if takes(name, event)]
            if not names:
                continue
            seen = max(occurrences(name) for name in names)
            if handler.count <= seen and (handler.cond is None or holds(handler.cond)):
                fitting.append((handler, handler.count))
    highest = max((count for _, count in fitting), default=0)
    return next((handler for handler, count in fitting if count == highest), None)
