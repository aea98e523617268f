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


@dataclass(slots=True)
class StateHistory:
    """The states of each application over time."""

    changes: dict[str, list[StateChange]] = field(default_factory=dict)

    def note(self, app: str, time: int, state: str, passing: bool = False) -> None:
        """Record that an application enters a state."""
        held = self.changes.setdefault(app, [])
        if held and held[-1].passing and held[-1].time == time:
            held.pop()
        held.append(StateChange(time, state, passing))


@dataclass(slots=True)
class ReachedElements:
    """Elements reached, by the path of the document."""

    roots: dict[str, Node] = field(default_factory=dict)
    """The root elements of the documents."""
    marks: dict[str, set[Mark]] = field(default_factory=dict)


def states_of(visits: Iterable[ElementVisit]) -> StateHistory:
    """The states that applications were in, in the order of a run."""
    states = StateHistory()
    for visit in visits:
        if visit.what in ("enter", "leave"):
            states.note(visit.app, visit.time, visit.name, passing=visit.what == "leave")
    return states


def marks_of(visits: Iterable[ElementVisit]) -> ReachedElements:
    """The elements reached in documents that are files, not in services' answers."""
    marks = ReachedElements()
    paths: dict[int, str] = {}
    """The paths of documents, by the identity of their sources."""
    for visit in visits:
        if visit.node is None:
            continue
        source = visit.node.source
        if visit.what != "document":
            if id(source) in paths:
                what = "in" if visit.what == "enter" else visit.what
                marks.marks[paths[id(source)]].add((visit.node.index, what))
        elif id(source) not in paths and _is_file(visit):
            paths[id(source)] = visit.name
            marks.roots.setdefault(visit.name, visit.node)
            marks.marks.setdefault(visit.name, set())
    return marks


def _is_file(visit: ElementVisit) -> bool:
    assert visit.node is not None
    return "://" not in visit.node.source.file and Path(visit.name).is_file()
