"""The states of a run's applications, and the elements that they reached."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prima.interpreter.bounds import ElementVisit
    from prima.markup.tree import Node

Mark = tuple[int, str]
"""An element, by its number in its document, and what happened: in, true, false or heard."""


@dataclass(slots=True)
class StateChange:
    """An application enters a state at a time (ms); an empty name means none."""

    time: int
    state: str
    passing: bool = False
    """Whether another change in the same instant replaces it."""


StateHistory = dict[str, list[StateChange]]
"""The states of each application over time."""


@dataclass(slots=True)
class ReachedElements:
    """The elements reached in a document, which is given by its root."""

    root: Node
    marks: set[Mark] = field(default_factory=set)


def states_of(visits: Iterable[ElementVisit]) -> StateHistory:
    """The states that applications were in, in the order of a run."""
    states: StateHistory = {}
    for visit in visits:
        if visit.what in ("enter", "leave"):
            held = states.setdefault(visit.app, [])
            if held and held[-1].passing and held[-1].time == visit.time:
                held.pop()
            held.append(StateChange(visit.time, visit.name, visit.what == "leave"))
    return states


def reached(visits: Iterable[ElementVisit]) -> dict[str, ReachedElements]:
    """The elements reached in documents that are files, not in services' answers, by path."""
    found: dict[str, ReachedElements] = {}
    by_source: dict[int, ReachedElements] = {}
    """The same by the identity of the documents' sources."""
    for visit in visits:
        if visit.node is None:
            continue
        source = id(visit.node.source)
        if visit.what != "document":
            if source in by_source:
                what = "in" if visit.what == "enter" else visit.what
                by_source[source].marks.add((visit.node.index, what))
        elif source not in by_source and _is_file(visit):
            by_source[source] = found.setdefault(visit.name, ReachedElements(visit.node))
    return found


def _is_file(visit: ElementVisit) -> bool:
    assert visit.node is not None
    return "://" not in visit.node.source.file and Path(visit.name).is_file()
