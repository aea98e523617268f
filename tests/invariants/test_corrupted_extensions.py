"""Transcripts that tell falsehoods of the extensions (X), and of patience (E6): all are found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from prima.messages import Heard
from tests.helpers.generated.scripts import Ask, Script
from tests.helpers.generated.world import World
from tests.invariants.broken import at_events
from tests.invariants.corruptions import (
    BOTH,
    IDLE,
    RIVALS,
    SAY,
    Corruption,
    Falsehood,
    at,
    both,
    change,
    double,
    drop,
    form,
    moved,
    on,
    play,
)

SPEAK = Ask(("speak",), ((),))
CHAIN = Ask(("speak",) * 7, ((), *((number,) for number in range(6))))
GO = Ask(("set-position", *CHAIN.whats[1:]), CHAIN.after)
DRIVEN = Script(
    ((), ()),
    ((50, ((), (GO,))), (4000, ((Ask(("set-speed-and-time",), ((),)),), ()))),
    (),
    World(),
)
"""The robot has gone somewhere to speak, is driven away, and has to go back (X1)."""
YIELDING = at_events(("ea", replace(SPEAK, restartable=True)), ("fa", SPEAK))
HOLDING = play(
    f'<form id="f1" stream="hold" hold-for="9s"><block>{SAY.format("Me.")}</block>'
    + on("touch", '<goto next="#f2"/>')
    + '</form><form id="f2"/>',
    IDLE,
    events=(at(3000),),
)
"""A state is left for which a stream is held (X3)."""
HELD = replace(SPEAK, hold=6000)
ONCE = at_events(("fa", HELD))
TWICE = replace(ONCE, events=((50, ((HELD,), ())), (4000, ((HELD,), ()))))
CONNECTED = at_events(("fa", replace(SPEAK, connect=True)))
FRESH = at_events(
    ("ea", SPEAK), ("fa", replace(SPEAK, fresh=1)), ("ea", Ask(("move-head",), ((),)))
)
ASKS = (
    '<form id="f1"><field name="q" type="{}"><prompt>Well?</prompt><filled>'
    f"{SAY.format('Good.')}</filled></field></form>"
)
SOON = play(
    '<form id="f0"><on event="touch" fresh-for="9s"><goto next="#f1"/></on></form>'
    + ASKS.format("boolean"),
    ASKS.format("number"),
    events=(at(10), (1000, Heard("yes"))),
    silent=100,
)
"""What one question refuses answers another, which waits as a reaction (X8)."""
WORDS = Ask(("speak", "speak"), ((), (0,)), words=True)
RESUMED = at_events(("ea", WORDS), ("fa", SPEAK))
LATE = play(
    ASKS.format("boolean").replace("<filled>", "<noinput><exit/></noinput><filled>"),
    ASKS.format("number"),
    events=((4000, Heard("yes")),),
    silent=100,
)
"""A question is answered when its time is over, and another one is asked (X10)."""
TURNS = Script(
    (((Ask(("move-head", "speak"), ((), (0,))),),), ()),
    ((10, ((Ask(("q-and-a",), ((),)),), ())), (20, ((), (SPEAK,)))),
    (),
    World(),
)
"""The response to an answer follows a movement (X7)."""
REACTIONS = at_events(("fa", replace(SPEAK, restartable=True)))
REACTIONS = replace(REACTIONS, events=((50, (*REACTIONS.events[0][1][:1], (SPEAK,))),))
ENGAGES = replace(
    ONCE, events=((50, ((Ask((("face-human",),), ((),)),), (Ask(("set-position",), ((),)),))),)
)
MOVES = {"phase": "start", "behavior": "ea#1.1", "app": "ea", "tree": "ea:1"}
ENDS = {"phase": "end", "behavior": "ea#1", "outcome": "filled"}
STORY = play(form(SAY.format("Story.") * 4), BOTH, events=(at(1000),))
PUT: dict[str, Any] = {"phase": "request", "app": "fa", "inserted": "X4"}
FIRST: dict[str, Any] = {"phase": "request"}


def put(made: Script, rule: str, corrupt: Corruption, found: str, says: str) -> Falsehood:
    """Something else is put in than is due."""
    return Falsehood(f"put-{says}", made, corrupt, found, says, f"prima+{rule}")


def held(made: Any, corrupt: Corruption, says: str) -> Falsehood:
    """A stream is held otherwise than it should be."""
    return Falsehood(f"held-{says}", made, corrupt, "10 (X3)", says, "prima+x3")


def answered(corrupt: Corruption, found: str, says: str) -> Falsehood:
    """A question is answered early, for no reason."""
    return Falsehood(f"answered-{says}", SOON, corrupt, found, says, "prima+x8")


FALSEHOODS = (
    # What is put in (X1, X4, X9).
    put(CONNECTED, "x4", change(0, PUT, inserted="X1"), "11 (X1)", "that is not on"),
    put(CONNECTED, "x4", change(0, PUT, before="fa#9"), "11 (X4)", "cannot precede"),
    put(CONNECTED, "x4", double({"phase": "start"}, **FIRST), "11 (X4)", "fa#1 is running"),
    put(CONNECTED, "x4", change(0, PUT, cause=None), "11 (C5)", "a flag"),
    put(CONNECTED, "x4", change(0, PUT, command="speak"), "11 (X4)", "not keep the channel"),
    put(DRIVEN, "x1", change(0, {"inserted": "X1"}, command="speak"), "11 (X1)", "nothing: it is"),
    put(DRIVEN, "x1", double({"behavior": "ea#99"}, inserted="X1"), "11 (X1)", "already"),
    put(RESUMED, "x9", change(0, {"inserted": "X9"}, text="No."), "11 (X9)", "has not to say it"),
    put(RESUMED, "x9", change(1, FIRST, order="now"), "11 (X9)", "which is wanted now"),
    # What gives way (X2).
    Falsehood(
        "left-before",
        YIELDING,
        double({"phase": "leave", "app": "ea", "state": 1}, phase="request", app="fa"),
        "2 (X2)",
        "nobody wants it to start again",
        "prima+x2",
    ),
    Falsehood(
        "for-nothing",
        YIELDING,
        moved({"phase": "interrupt"}, behind={"phase": "start", "app": "fa"}),
        "2 (X2)",
        "but fa#1 does not start",
        "prima+x2",
    ),
    Falsehood(
        "turn",
        TURNS,
        double({"phase": "interrupt", "by": "ea#1"}, phase="start", command="move-head"),
        "16 (X7)",
        "between an answer and its response",
        "prima+x2+x7",
    ),
    Falsehood(
        "outranked",
        REACTIONS,
        double({"phase": "interrupt", "by": "ea#1"}, phase="start"),
        "2 (S2)",
        "ea#1 was outranked",
        "prima+x2",
    ),
    Falsehood("engages", ENGAGES, double(MOVES, phase="start"), "7 (K1)", "in which fa#2 engages"),
    # Streams that are held (X3).
    held(ONCE, change(0, {"outcome": "begun"}, tree="fa:9"), "which is not to be"),
    held(ONCE, double({}, phase="held", outcome="over"), "(over), but was not"),
    held(ONCE, change(0, FIRST, hold=None), "nobody asks for it"),
    held(ONCE, change(0, {"outcome": "begun"}, data={"until": 99.0}), "until 99000 ms, not for"),
    held(
        ONCE,
        both(drop(0, phase="start"), change(0, {"phase": "end"}, phase="cancel", rule="O2")),
        "has not begun",
    ),
    held(ONCE, drop(0, phase="held", outcome="over"), "ends, but is held"),
    held(ONCE, both(drop(0, outcome="over"), drop(0, phase="stream-end")), "held beyond"),
    held(ONCE, drop(0, phase="end"), "fa#1 is of it"),
    held(
        TWICE,
        moved({"outcome": "joined"}, behind={"phase": "request", "time": 4000}),
        "joined by nothing",
    ),
    held(HOLDING, drop(0, phase="leave"), "but its state goes on"),
    held(
        HOLDING,
        both(drop(0, outcome="left"), drop(0, phase="stream-end")),
        "held on, but its state was left",
    ),
    # Reactions that come too late, and answers before their questions (X8).
    Falsehood("no-time", FRESH, change(1, FIRST, fresh=None), "3 (X8)", "has a time", "prima+x8"),
    Falsehood(
        "early", FRESH, change(1, FIRST, fresh=9), "3 (X8)", "is given up before", "prima+x8"
    ),
    answered(change(0, {"outcome": "answered"}, rule="X10"), "3 (X10)", "not on"),
    answered(change(0, {"event": "speech"}, actor="robot"), "3 (X8)", "nobody has said"),
    answered(change(1, FIRST, reactive=False, cause=None), "3 (X8)", "no reaction that waits"),
    Falsehood(
        "other-answer",
        LATE,
        both(change(0, {"event": "speech"}, app=None, rule=None), double(ENDS, event="speech")),
        "16 (X10)",
        "answered by what fa has asked",
        "prima+x10",
    ),
    # What the robot lacks (X6).
    Falsehood(
        "lacks",
        RIVALS,
        double({"phase": "substitute"}, phase="request"),
        "3 (X6)",
        "lacks speak",
        "prima+x6",
    ),
    # Patience (E6).
    Falsehood("unsaid", STORY, drop(0, phase="starve"), "13 (E6)", "nothing says so", patience=500),
    Falsehood(
        "impatient",
        STORY,
        both(
            change(0, {"phase": "starve"}, time=0),
            moved({"phase": "starve"}, behind={"phase": "hold"}),
        ),
        "13 (E6)",
        "nobody kept it so long",
        patience=500,
    ),
)


@pytest.mark.parametrize("one", FALSEHOODS, ids=lambda one: one.name)
def test_a_falsehood_about_an_extension_is_found(one: Falsehood) -> None:
    one.is_found()
