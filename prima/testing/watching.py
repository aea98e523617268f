"""Looking into interpreters while a run goes on: which state each is in, and what it goes through.

Nothing of this is there in other runs: the methods of an interpreter that somebody looks into
are wrapped, one by one, when it is made.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prima import session
from prima.interpreter.application import Interpreter
from prima.interpreter.elements import Document, Handler, Run, all_acts, run_commands
from prima.markup.tree import Node

if TYPE_CHECKING:
    from prima.markup.tree import Source
    from prima.session import App
    from prima.voicexml.application import VoiceInterpreter
    from prima.voicexml.document import Page
    from prima.voicexml.machine import Machine

Mark = tuple[int, str]
"""An element, by its number in its document, and what became of it: in, true or false."""


@dataclass(slots=True)
class Change:
    """An application comes into a state at a time (ms); without a name it is in none."""

    time: int
    state: str
    passing: bool = False
    """Whether another change in the same instant takes its place."""


@dataclass(slots=True)
class States:
    """Which form each application was in."""

    changes: dict[str, list[Change]] = field(default_factory=dict)

    def note(self, app: str, time: int, state: str, passing: bool = False) -> None:
        """An application is in a state from now on."""
        held = self.changes.setdefault(app, [])
        if held and held[-1].passing and held[-1].time == time:
            held.pop()
        held.append(Change(time, state, passing))


@dataclass(slots=True)
class Marks:
    """What was gone through, by the path of the document."""

    roots: dict[str, Node] = field(default_factory=dict)
    """The root elements of the documents that were there."""
    marks: dict[str, set[Mark]] = field(default_factory=dict)

    def document(self, file: str, root: Node) -> None:
        """A document is there, whatever becomes of it."""
        self.roots.setdefault(file, root)
        self.marks.setdefault(file, set())

    def add(self, file: str, node: Node, what: str) -> None:
        """Something became of an element of a document that is there."""
        self.marks[file].add((node.index, what))


@contextmanager
def watching(states: States, marks: Marks | None) -> Iterator[None]:
    """Look into every interpreter that is made; only with ``marks`` at all that it does."""

    def watch(app: App) -> None:
        if isinstance(app, Interpreter):
            _states(app, states)
            if marks is not None:
                _marks(app, marks)
        else:
            _voice(app, states, marks)

    session.watchers.append(watch)
    try:
        yield
    finally:
        session.watchers.remove(watch)


# PRIMA's own language -------------------------------------------------------------


def _states(app: Interpreter, states: States) -> None:
    """Note every form that is begun, and what is active after one is left."""
    begin, leave = app.begin, app.leave

    def begun(frame: Any, setup: bool = True) -> Any:
        states.note(app.name, app.now, frame.form.id)
        return begin(frame, setup)

    def left(frame: Any) -> None:
        outer = frame.caller.form.id if frame.caller is not None and not app.over else ""
        states.note(app.name, app.now, outer, passing=True)
        leave(frame)

    app.begin, app.leave = begun, left  # type: ignore[method-assign]


def _marks(app: Interpreter, marks: Marks) -> None:
    """Note forms, items, content, conditions and links."""
    root = app.document.file
    marks.document(root, app.document.node)
    contents = _contents(app.document)
    begin, follow = app.begin, app.follow
    run, condition = app.execute.run, app.execute.condition
    run_at_once = app.execute.run_at_once
    select = app.algorithm.select_item

    def begun(frame: Any, setup: bool = True) -> Any:
        marks.add(root, frame.form.node, "in")
        return begin(frame, setup)

    def followed(now: int, link: Any, event: Any) -> None:
        marks.add(root, link.node, "in")
        follow(now, link, event)

    def ran(content: Any, fiber: Any) -> Any:
        node = contents.get(id(content))
        if node is not None:
            marks.add(root, node, "in")
        return run(content, fiber)

    def ran_at_once(content: Any, fiber: Any) -> Any:
        node = contents.get(id(content))
        if node is not None:
            marks.add(root, node, "in")
        return run_at_once(content, fiber)

    def held(expr: Any, fiber: Any) -> bool:
        found = condition(expr, fiber)
        marks.add(root, expr.node, "true" if found else "false")
        return found

    def selected(frame: Any, fiber: Any, items: Any) -> Any:
        item = select(frame, fiber, items)
        if item is not None:
            marks.add(root, item.node, "in")
        return item

    app.begin, app.follow = begun, followed  # type: ignore[method-assign]
    app.execute.run, app.execute.condition = ran, held  # type: ignore[method-assign]
    app.execute.run_at_once = ran_at_once  # type: ignore[method-assign]
    app.algorithm.select_item = selected  # type: ignore[method-assign]


def _contents(document: Document) -> dict[int, Node]:
    """The elements that hold content, by the identity of what they hold."""
    found: dict[int, Node] = {}
    for _, content, node in document.contents():
        found[id(content)] = node
        for handler in _of_commands(content):
            found[id(handler.content)] = handler.node
    return found


def _of_commands(content: Any) -> Iterator[Handler]:
    """Handlers that stand inside Commands."""
    for act in all_acts(content):
        if isinstance(act, Run):
            yield from chain.from_iterable(one.handlers for one in run_commands(act.steps))


# VoiceXML -------------------------------------------------------------------------


def _voice(app: VoiceInterpreter, states: States, marks: Marks | None) -> None:
    machine: Machine = app._machine  # there is no other way in
    files = _Files(app, marks)
    dialog, current = machine.dialog, [""]

    def entered(context: Any, form: Any, heard: Any) -> Any:
        files.add(context.page, context.root)
        files.note(form, "in")
        dialogs = context.page.dialogs.items()
        before, current[0] = current[0], next((name for name, one in dialogs if one is form), "")
        states.note(app.name, app.now, current[0])
        try:
            yield from dialog(context, form, heard)
        finally:
            current[0] = before
            states.note(app.name, app.now, before, passing=True)

    machine.dialog = entered  # type: ignore[method-assign]
    if marks is not None:
        files.add(app.document.page)
        _voice_marks(machine, files)


def _voice_marks(machine: Machine, files: _Files) -> None:
    """Note items, content, conditions, links and choices."""
    holds, process = machine.content.holds, machine.items_of.process

    def wrapped(act: Callable[..., Any], place: int) -> Callable[..., Any]:
        def noted(*given: Any) -> Any:
            files.note(given[place], "in")
            return act(*given)

        return noted

    def held(node: Node, context: Any, local: Any) -> bool:
        found = holds(node, context, local)
        files.note(node, "true" if found else "false")
        return found

    def processed(context: Any, heard: Any) -> Any:
        files.note(heard.owner, "in" if heard.owner.tag in ("link", "choice") else "heard")
        return process(context, heard)

    machine.visit = wrapped(machine.visit, 1)  # type: ignore[method-assign]
    machine.content.run = wrapped(machine.content.run, 0)  # type: ignore[method-assign]
    machine.content.holds = held  # type: ignore[method-assign]
    machine.items_of.process = processed  # type: ignore[method-assign]


class _Files:
    """The documents of a VoiceXML application that are files: all elements of one share their source."""

    def __init__(self, app: VoiceInterpreter, marks: Marks | None) -> None:
        self._first = app.document.page
        self._path = app.document.file
        self._marks = marks
        self._known: dict[int, tuple[Source, str]] = {}

    def add(self, *pages: Page | None) -> None:
        """Pages are there; what services have answered with is none of the author's files."""
        for page in pages:
            if page is None or self._marks is None or id(page.root.source) in self._known:
                continue
            path = Path(self._path)
            if page is not self._first:
                path = path.parent / page.root.source.file
            if page is self._first or ("://" not in page.root.source.file and path.is_file()):
                self._known[id(page.root.source)] = (page.root.source, str(path))
                self._marks.document(str(path), page.root)

    def note(self, node: Node, what: str) -> None:
        """Something became of an element."""
        known = self._known.get(id(node.source))
        if known is not None and self._marks is not None:
            self._marks.add(known[1], node, what)
