"""Plays: two or three generated documents, run by a session with the devices of `world`.

A play is a plain value, so that a failing one is printed whole and can be run again.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

from hypothesis import strategies as st

from prima.interpreter.application import Interpreter
from prima.interpreter.elements import Document
from prima.interpreter.reader import read_document
from prima.invariants import callers
from prima.language.commands import PATIENCE_MS
from prima.messages import (
    ApplicationLoaded,
    ApplicationUnloaded,
    Emergency,
    Inbound,
    Occurred,
    Record,
)
from prima.scheduler.policy import policy_named
from prima.session import Session
from prima.voicexml.document import VoiceDocument
from tests.helpers.generated.author import EVENTS, Author
from tests.helpers.generated.voice import VoiceAuthor
from tests.helpers.generated.world import (
    APPS,
    STEPS,
    Devices,
    Run,
    World,
    lasting,
    left_undone,
    orders_match,
)
from tests.helpers.voice import voice


@dataclass(frozen=True)
class Play:
    """Documents, when they are loaded, what happens around them, and how devices behave."""

    documents: tuple[str, ...]
    loads: tuple[int, ...]
    events: tuple[tuple[int, Inbound], ...]
    world: World


def perform(
    play: Play, policy: str = "prima", bound: int | None = None, patience: int = PATIENCE_MS
) -> Run:
    """Run a play to its end, or cut it off."""
    documents = documents_of(play)
    chosen = policy_named(policy)
    session = Session(documents, chosen, play.world.table, bound, patience=patience)
    devices = Devices(play.world)
    for document, start in zip(documents, play.loads, strict=True):
        devices.plan(start, ApplicationLoaded(document.id))
    for time, value in play.events:
        devices.plan(time, value)
    records: list[Record] = []
    problems: list[str] = []
    now = steps = 0
    while steps < STEPS:
        times = [time for time in (devices.due(), session.deadline()) if time is not None]
        if not times:
            break
        steps, now = steps + 1, max(now, min(times))
        for order in session.step(now, devices.collect(now)):
            devices.order(now, order)
        records += session.drain()
        problems += left_undone(now, session.deadline())
    problems += orders_match(records, devices.starts)
    run = Run(records, steps < STEPS, problems, frozenset(callers(documents)))
    run.problems += [f"a defect: {error!r}" for error in session.defects]
    if run.complete:
        run.problems += _stuck(session)
    return run


def documents_of(play: Play) -> list[Document | VoiceDocument]:
    """A play's documents, read."""
    return [_read(name, text) for name, text in zip(APPS, play.documents, strict=False)]


def _read(name: str, text: str) -> Document | VoiceDocument:
    """A document in either language, which has no errors."""
    if text.startswith("<vxml"):
        return voice(text, name, "fa" if name == "fa" else "ea")
    document, problems = read_document(f"{name}.xml", text.encode())
    errors = [str(problem) for problem in problems if problem.severity == "error"]
    assert not errors, (errors, text)
    return document


def _stuck(session: Session) -> list[str]:
    """Invariant 9: with nothing left to happen, who waits for something of the mediator's?"""
    if session.mediator.halted:
        return []
    found = []
    memory = session.mediator.memory
    for ab in memory.behaviors.values():
        found.append(f"invariant 9: {ab.id} is {ab.state} for ever")
    for stream in memory.streams.values():
        found.append(f"invariant 9: {stream.name} stays open for ever")
    for app in session.apps.values():
        # Private, but nothing else tells an application that waits for a Command
        # which is gone from one that waits for an event.
        waiting = sorted(app.waiting) if isinstance(app, Interpreter) else []
        if waiting and not app.over and not memory.behaviors:
            found.append(f"invariant 9: {app.name} waits for {waiting}, which nobody will end")
    return found


HINTS = re.compile(r' (stream|hold-for|channel|restartable|resume-text|fresh-for)="[^"]*"')


def without_hints(play: Play) -> Play:
    """The same play, but its applications tell the mediator nothing of what they would like."""
    blank = tuple(HINTS.sub(lambda hint: " " * len(hint[0]), text) for text in play.documents)
    return replace(play, documents=blank)


def _when(event: tuple[int, Inbound]) -> int:
    return event[0]


def _author(draw: Any, name: str, lively: bool) -> Author:
    """Of four documents one is VoiceXML."""
    language = VoiceAuthor if draw(st.integers(1, 4)) == 4 else Author
    return language(draw, name, lively)


@st.composite
def plays(draw: Any, lively: bool = False) -> Play:
    """Two or three applications; ``lively``: every user answers and every device ends."""
    names = APPS[: draw(st.sampled_from((2, 2, 2, 3)))]
    documents = tuple(_author(draw, name, lively).document() for name in names)
    loads = tuple(draw(st.sampled_from((0, 0, 1, 700))) for _ in names)
    events: list[tuple[int, Inbound]] = []
    for _ in range(draw(st.integers(0, 8))):
        time = draw(st.integers(1, 12_000))
        name = draw(st.sampled_from(EVENTS))
        events.append((time, Occurred(name, "user" if "touch" in name else "environment")))
    if not lively and draw(st.integers(1, 4)) == 4:
        time = draw(st.integers(1, 8000))
        events.append((time, Emergency(True)))
        events.append((time + draw(lasting), Emergency(False, draw(st.booleans()))))
    if not lively and draw(st.integers(1, 4)) == 4:
        events.append(
            (draw(st.integers(1, 8000)), ApplicationUnloaded(draw(st.sampled_from(names))))
        )
    events.sort(key=_when)
    if len(names) == 3 and draw(st.booleans()):
        # All three may react to one event.
        both = '<on event="touch"><speak>Yes.</speak><face-human/></on></prima>'
        documents = tuple(text.replace("</prima>", both) for text in documents)
        events = sorted(
            [*events, (draw(st.integers(1, 9000)), Occurred("touch", "user"))], key=_when
        )
    seed = draw(st.integers(0, 10_000))
    world = World(seed, lacks=draw(st.integers(1, 5)) == 5)
    if not lively:
        world = World(
            seed,
            draw(st.sampled_from((0, 0, 5, 20))),
            draw(st.sampled_from((0, 30, 60))),
            draw(st.booleans()),
            world.lacks,
        )
    return Play(documents, loads, tuple(events), world)
