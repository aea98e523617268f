"""Expectations as sentences."""

from __future__ import annotations

from prima.sim.expectations import Expectation
from prima.testing.facts import Window
from prima.transcript.row import title


def subject(one: Expectation) -> str:
    """An expectation as a clause."""
    name, word = next(iter(one.words.items()))
    if "does" in one.words:
        name, word = "does", one.words["does"]
    who = one.by or ("the robot" if name in ("does", "finishes", "says") else "an application")
    match name:
        case "does":
            says = one.words.get("says")
            return f"{who} does {title(word)}{_with(one)}" + (f', saying "{says}"' if says else "")
        case "says" | "logs":
            return f'{who} {name} "{word}"'
        case "finishes":
            return f"{who} finishes {title(word)}{_with(one)}"
        case "event":
            return f"the event {word}{_with(one)} happens"
        case "sends":
            return f"{who} sends to {word}{_with(one)}"
        case "state":
            return f'{who} is in the state "{word}"'
    return f"{word} ends" + (f" with {one.reason}" if one.reason else "")


def event_of(one: Expectation) -> str:
    """The trigger of an expectation, as a clause."""
    match one.trigger:
        case "said" | "asked":
            return f'the robot has {one.trigger} "{one.what}"'
        case "doing" | "done":
            does = "begins" if one.trigger == "doing" else "ends"
            return f"the robot {does} {title(one.what)}"
    return f"the event {one.what}"


def _with(one: Expectation) -> str:
    held = ", ".join(f"{name} {value}" for name, value in one.data.items())
    return f" ({held})" if held else ""


def expected(one: Expectation, window: Window) -> str:
    """The expectation as a sentence."""
    parts = [subject(one)]
    if one.times is not None:
        parts.append(times(one.times))
    if window.why:
        parts.append(window.why)
    if one.before:
        parts.append(f'before "{one.before}"')
    if one.within is not None:
        parts.append(f"within {seconds(one.within)}")
    return f"{'Never expected' if one.never else 'Expected'}: {', '.join(parts)}."


def times(count: int) -> str:
    """How often: ``once``, ``3 times``."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def seconds(time: int) -> str:
    """A time (ms) in seconds; where it matters, to the millisecond."""
    return f"{time / 1000:.{3 if time % 10 else 2}f} s"
