"""Each rule, dropped or reversed: a test that is named after it must notice."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from functools import partial
from importlib import import_module
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from prima.interpreter.application import Interpreter
from prima.interpreter.handling import Handling
from prima.language.commands import CommandType
from prima.messages import Data
from prima.scheduler import (
    admission,
    emergency,
    endings,
    failures,
    freshness,
    interruption,
    preparation,
    requests,
    rules,
    selection,
    starvation,
    streams,
    thirdturn,
)
from prima.scheduler.admission import Maker
from prima.scheduler.behavior import Application, Behavior, Stream
from prima.scheduler.mediation import Mediation
from prima.scheduler.mediator import Mediator
from prima.scheduler.memory import WorkingMemory
from prima.scheduler.policy import Policy, Ranked
from prima.session import hearing
from prima.session.hearing import Hearing
from prima.session.session import Session
from prima.session.wiring import Wiring
from tests.helpers.rebinding import rebind

Patch = Callable[[pytest.MonkeyPatch], None]
MODULES = [
    import_module(f"tests.scheduler.{path.stem}")
    for path in sorted(Path(__file__).parent.glob("test_*.py"))
    if path != Path(__file__)
]


def put(where: ModuleType | type, name: str, what: object) -> Patch:
    """Put something else in the place of a rule."""
    return lambda patch: rebind(patch, where, name, what)


def wrapped(where: Any, name: str, change: Callable[[Any], Any]) -> Patch:
    """Change what a rule gives."""
    whole = getattr(where, name)
    return put(where, name, lambda *given: change(whole(*given)))


def reworded(where: Any, name: str, clause: str, other: str) -> Patch:
    """Change one clause in the text of a rule."""
    text = inspect.getsource(getattr(where, name))
    assert text.count(clause) == 1, f'"{clause}" is not once in {name}'
    made: dict[str, Any] = {}
    exec(text.replace(clause, other), vars(where), made)
    return put(where, name, made[name])


def nothing(*_given: object) -> None:
    """A rule that is gone."""


def everything_begun(patch: pytest.MonkeyPatch) -> None:
    """S2d: streams that have not begun are suspended as well."""
    take = streams.take_floor

    def suspend_all(mediation: Mediation, stream: Stream, rule: str) -> None:
        for other in mediation.memory.streams.values():
            other.turn = other.turn or 1
        take(mediation, stream, rule)

    rebind(patch, streams, "take_floor", suspend_all)


def one_by_one(patch: pytest.MonkeyPatch) -> None:
    """S2d: of streams suspended together, the one that began last goes first."""
    take = streams.take_floor

    def number(mediation: Mediation, stream: Stream, rule: str) -> None:
        take(mediation, stream, rule)
        for other in mediation.memory.streams.values():
            if other.place == mediation.suspensions:
                other.place = mediation.suspensions * 100 + other.turn

    rebind(patch, streams, "take_floor", number)


def loaded_order(patch: pytest.MonkeyPatch) -> None:
    """S2f: the application loaded first goes first."""
    load = Mediator.load

    def load_next(
        self: Mediator, name: str, kind: str, lang: str = "", order: int | None = None
    ) -> None:
        load(self, name, kind, lang)

    patch.setattr(Mediator, "load", load_next)


def any_loser(patch: pytest.MonkeyPatch) -> None:
    """S2: who waits has lost, whatever keeps it."""
    asked: list[object] = []

    def in_turn(mediation: Mediation, ranked: list[Ranked], held: object) -> list[Ranked]:
        asked.append(ranked)
        return ranked if len(asked) % 2 else []  # before the winner starts, and after

    rebind(patch, selection, "able", in_turn)


def ended_is_active(patch: pytest.MonkeyPatch) -> None:
    """S2b: whose AB started last is active, whether its stream has ended or not."""
    latest: list[Stream] = []
    start = WorkingMemory.start

    def note(memory: WorkingMemory, ab: Behavior) -> None:
        latest.append(ab.stream)
        start(memory, ab)

    patch.setattr(WorkingMemory, "start", note)
    patch.setattr(
        WorkingMemory, "active", property(lambda memory: latest[-1].app if latest else None)
    )


def only_placed(
    mediation: Mediation,
    app: Application,
    devices: frozenset[str],
    reaction: int | None,
    unit: Behavior | None,
) -> Stream:
    """O2: what is wanted now cancels nothing."""
    if unit is not None:
        return unit.stream
    return streams.opened(mediation, requests.stream_of(mediation, app, reaction))


u2 = endings.u2


def always_at_the_goal(
    mediation: Mediation, ab: Behavior, goal: bool, data: Data, inbound: bool
) -> None:
    """U2: a feedback Command has met its goal after one loop."""
    u2(mediation, ab, True, data, inbound)


def any_running(memory: WorkingMemory, ab: Behavior) -> Behavior | None:
    """S4: whatever runs keeps everything from starting."""
    return next(iter(memory.running.values()), None)


def waits_for_what_runs(ab: Behavior, memory: WorkingMemory) -> tuple[str, str] | None:
    """F4: whatever runs of another application holds a floor."""
    return next((("F2", one.id) for one in memory.running.values() if one.app is not ab.app), None)


makes_channels = property(lambda policy: frozenset({"x4"}), lambda policy, extensions: None)
"""K3: X4 is always on."""


def chance(patch: pytest.MonkeyPatch) -> None:
    """S5: what was decided before has a part in it."""
    asked = count()
    patch.setattr(rules, "s2f", lambda ab: (ab.serial * (-1) ** (next(asked) // 7 % 2), 0))


MUTANTS: list[tuple[str, str, Patch]] = [
    ("s1", "dropped", put(WorkingMemory, "conflict", nothing)),
    ("s2a", "dropped", put(rules, "s2a", lambda ab: 0)),
    ("s2a", "reversed", put(rules, "s2a", lambda ab: ab.priority)),
    ("s2b", "dropped", put(rules, "s2b", lambda ab, memory: rules.NO_REACTION)),
    ("s2b", "the earliest first", wrapped(rules, "s2b", lambda r: (r[0], -r[1], r[2]))),
    ("s2b", "no matter who is active", wrapped(rules, "s2b", lambda r: (r[0], r[1], 0))),
    ("s2b", "what has ended is active", ended_is_active),
    ("s2c", "dropped", put(rules, "s2c", lambda ab, now: 0)),
    ("s2c", "reversed", wrapped(rules, "s2c", lambda r: -r)),
    ("s2d", "dropped", put(rules, "s2d", lambda ab: 0)),
    ("s2d", "reversed", put(rules, "s2d", lambda ab: ab.stream.place or 99)),
    ("s2d", "what has not begun is suspended", everything_begun),
    ("s2d", "one by one", one_by_one),
    ("s2e", "dropped", put(rules, "s2e", lambda ab: 0)),
    ("s2e", "reversed", put(rules, "s2e", lambda ab: -ab.requested)),
    ("s2f", "reversed", wrapped(rules, "s2f", lambda r: (-r[0], r[1]))),
    ("s2f", "by loading", loaded_order),
    ("s2", "all that wait have lost", any_loser),
    ("s3", "dropped", put(Policy, "holds_back", lambda policy, ab, memory: False)),
    ("f1", "no floor", put(streams, "take_floor", nothing)),
    ("f1", "nobody is suspended", put(streams, "suspend_others", nothing)),
    ("f2", "dropped", put(rules, "f2", nothing)),
    (
        "f2",
        "priority does not count",
        put(rules, "outranks", lambda priority, stream, memory: False),
    ),
    ("f2", "above any", reworded(rules, "outranks", "all(priority", "any(priority")),
    ("f3", "never", put(rules, "f3", lambda ab, memory: False)),
    ("f3", "always", put(rules, "f3", lambda ab, memory: True)),
    ("f5", "dropped", put(selection, "f5", nothing)),
    ("f6", "dropped", put(rules, "f6", nothing)),
    (
        "f6",
        "reactions too",
        put(
            rules,
            "f6",
            lambda ab, memory: next(
                (("F6", one.id) for one in memory.running.values() if rules.speaks_next(one)), None
            ),
        ),
    ),
    ("f6", "silent streams too", lambda patch: patch.setattr(Stream, "spoken", True)),
    ("f6", "whatever comes next", put(rules, "speaks_next", lambda ab: True)),
    (
        "f6",
        "whoever has the floor",
        reworded(rules, "f6", " or ab.stream is memory.holder", ""),
    ),
    ("f6", "loops too", reworded(rules, "f6", "not other.feedback and ", "")),
    ("f6", "in units too", reworded(rules, "f6", "other.unit is None and ", "")),
    ("k1", "dropped", put(rules, "k1", nothing)),
    ("k1", "for ever", put(failures, "look_for_user", nothing)),
    ("k1", "who leaves engages", put(rules, "engages", lambda stream, memory: True)),
    (
        "k1",
        "who searches does not",
        put(rules, "engages", lambda stream, memory: not memory.absent),
    ),
    ("k1", "who leaves in part", reworded(rules, "engages", "not all(", "not any(")),
    (
        "k1",
        "who does nothing",
        reworded(rules, "engages", "not contending or", "bool(contending) and"),
    ),
    (
        "o1",
        "windows do not count",
        put(
            requests,
            "o1",
            lambda app: None if app.latest is None or app.latest.state == "gone" else app.latest,
        ),
    ),
    ("o1", "dropped", put(requests, "o1", nothing)),
    ("o2", "nothing is cancelled", put(requests, "o2", only_placed)),
    ("o2", "the first goes on", put(streams, "going_on", lambda found: found[0])),
    ("o3", "dropped", put(requests, "o3", nothing)),
    ("o3", "nothing goes on", put(streams, "continue_with", nothing)),
    ("o3", "the first goes on", put(streams, "going_on", lambda found: found[0])),
    ("c2", "nobody is told", put(Wiring, "tell_turns", nothing)),
    ("c3", "dropped", put(streams, "open_window", nothing)),
    (
        "u5",
        "what is linked contends",
        put(Behavior, "dormant", property(lambda ab: ab.state == "linked")),
    ),
    ("u5", "anything goes in a unit", put(admission, "check_steps", nothing)),
    ("u1", "dropped", put(Maker, "chain", lambda *given: [])),
    ("u2", "one loop", put(endings, "u2", always_at_the_goal)),
    ("u3", "dropped", put(admission, "link", nothing)),
    ("u4", "dropped", put(admission, "group_devices", lambda group, table: frozenset())),
    ("u6", "dropped", put(WorkingMemory, "conflict", nothing)),
    ("o4", "the state does not go on", put(Interpreter, "go_on_entering", nothing)),
    ("s4", "one at a time", put(WorkingMemory, "conflict", any_running)),
    ("s5", "chance", chance),
    ("c1", "dropped", put(streams, "c1", nothing)),
    ("c4", "dropped", put(streams, "open_window", nothing)),
    ("c5", "dropped", put(Handling, "allow_reaction", nothing)),
    ("c6", "never raised", put(Handling, "check_watches", lambda *given: [])),
    ("f4", "all wait for what runs", put(rules, "f2", waits_for_what_runs)),
    ("k2", "one priority", put(CommandType, "priority", property(lambda row: 1))),
    ("k3", "a channel is made", put(Policy, "extensions", makes_channels)),
    ("v1", "the question first", put(Hearing, "_follow_links", lambda *given: False)),
    ("v2", "dropped", put(WorkingMemory, "conflict", nothing)),
    ("v3", "events first", put(Session, "_class", lambda session, value: (0, 0))),
    ("e1", "dropped", put(failures, "e1", nothing)),
    ("e2", "dropped", put(requests, "e2", nothing)),
    ("e3", "dropped", put(admission, "check_steps", nothing)),
    ("e4", "dropped", put(starvation, "e4", lambda *given: False)),
    ("e5", "dropped", put(emergency, "e5", nothing)),
    ("e6", "dropped", put(rules, "e6", lambda ab, memory, now: 1)),
    ("e6", "reversed", wrapped(rules, "e6", lambda r: 1 - r)),
    ("e6", "whatever keeps it", put(rules, "keeps_speaker", lambda ab, memory: True)),
    ("e6", "nobody hears an answer", put(rules, "acknowledges", lambda ab, now: False)),
    ("e6", "any word is one", put(rules, "acknowledges", lambda ab, now: ab.freed == now)),
    ("e6", "one turn has no bound", put(Mediation, "shared", property(lambda all_: False))),
    ("e6", "who is alone has one", put(Mediation, "shared", property(lambda all_: True))),
    ("x1", "dropped", put(preparation, "x1", lambda *given: False)),
    ("x2", "dropped", put(interruption, "x2", lambda *given: False)),
    ("x3", "dropped", put(streams, "x3", nothing)),
    ("x4", "dropped", put(preparation, "x4", lambda *given: False)),
    (
        "x5",
        "dropped",
        put(selection, "in_the_way", lambda mediation, ab: mediation.memory.conflicts(ab)),
    ),
    ("x6", "dropped", put(requests, "x6", nothing)),
    ("x8", "dropped", put(freshness, "x8", lambda mediation: False)),
    ("x8", "never shrinks", reworded(freshness, "_give_up", "not kept or ", "True or ")),
    ("x8", "whatever keeps it", reworded(freshness, "_give_up", "not kept or ", "")),
    ("x8", "what follows stays", put(freshness, "followers", lambda root: [root])),
    ("x8", "the last instant", put(freshness, "_may_start", lambda mediation, ab: False)),
    ("x8", "what has begun is abandoned", reworded(freshness, "_notices", " or run.begun", "")),
    ("x8", "nothing is offered", put(freshness, "offered", nothing)),
    ("x8", "what comes before is lost", reworded(endings, "answered", "in ab.waits_for", "in ()")),
    ("x10", "dropped", put(Hearing, "_late_for", nothing)),
    ("x10", "for ever", put(hearing, "LATE_MS", 10**9)),
    ("x10", "not at once", put(hearing, "LATE_MS", 0)),
    ("x10", "links alone", put(Mediator, "coming_question", nothing)),
    ("x9", "dropped", put(preparation, "x9", lambda *given: False)),
    ("x9", "whoever resumes", reworded(preparation, "note_resumed", " and stream.spoken", "")),
    ("x9", "what is not speech", reworded(preparation, "note_resumed", "if ab.says", "if True")),
    (
        "x9",
        "for ever",
        reworded(preparation, "note_resumed", "ab.stream.words_due = False", "pass"),
    ),
    ("x9", "another topic, too", reworded(preparation, "x9", " or wanted_now(ab)", "")),
    ("x9", "nobody waits for it", put(preparation, "join_first", nothing)),
    ("x7", "dropped", put(thirdturn, "owe", nothing)),
    ("x7", "others speak", put(rules, "x7", nothing)),
    ("x7", "floors are kept", put(rules, "aside", lambda ab, memory: False)),
    ("x7", "questions, too", reworded(thirdturn, "_soon_over", " or ab.asks", "")),
    ("x7", "loops, too", reworded(thirdturn, "_soon_over", "ab.feedback or ", "")),
    ("x7", "whatever comes before", put(rules, "before", lambda ab, memory: [])),
    ("x7", "broken off", reworded(interruption, "yields", " and not third_turn(ab, memory)", "")),
    ("x7", "whatever was heard", reworded(endings, "_note_answer", 'outcome == "filled"', "True")),
]
"""Those of the rules that decide in a run. V4 is the simulated camera's (tests/sim/test_robot.py)."""


def named_after(rule: str) -> Iterator[Callable[[], None]]:
    """The tests of a rule, each of their cases."""
    for module in MODULES:
        for name, test in vars(module).items():
            if name.startswith(f"test_{rule}_") or f"_and_{rule}_" in name:
                yield from cases(test)


def cases(test: Callable[..., None]) -> Iterator[Callable[[], None]]:
    """A test as pytest calls it: once, or once for each of its parameters."""
    marks = [mark for mark in getattr(test, "pytestmark", []) if mark.name == "parametrize"]
    if not marks:
        yield test
        return
    (mark,) = marks
    names, values = mark.args
    names = [one.strip() for one in names.split(",")] if isinstance(names, str) else list(names)
    for value in values:
        given = dict(zip(names, (value,) if len(names) == 1 else value, strict=True))
        yield partial(test, **given)


def fails(test: Callable[[], None]) -> bool:
    try:
        test()
    except Exception:
        return True
    return False


@pytest.mark.parametrize(
    ("rule", "patch"),
    [(rule, patch) for rule, _, patch in MUTANTS],
    ids=[f"{rule}-{how}" for rule, how, _ in MUTANTS],
)
def test_a_test_named_after_the_rule_notices(
    rule: str, patch: Patch, monkeypatch: pytest.MonkeyPatch
) -> None:
    tests = list(named_after(rule))
    assert tests and not any(fails(test) for test in tests)
    patch(monkeypatch)
    assert any(fails(test) for test in tests)
