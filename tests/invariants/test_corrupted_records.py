"""Transcripts that were tampered with: the checker of the invariants finds every falsehood.

Each corruption changes the records of a sound run. What is selected otherwise than it
was is cut off behind the change, as nothing after it would follow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings

from prima.invariants import check
from prima.messages import ApplicationUnloaded, Emergency, Inbound, Occurred
from tests.helpers.generated.plays import Play, perform, plays
from tests.helpers.generated.world import APPS, World

Records = list[dict[str, Any]]
Corruption = Callable[[Records], Records]

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="{}">{}</prima>'
SAY = "<speak>{}</speak>"


def play(*bodies: str, events: tuple[tuple[int, Inbound], ...] = (), silent: int = 0) -> Play:
    documents = tuple(HEAD.format(name, body) for name, body in zip(APPS, bodies, strict=False))
    return Play(documents, (0,) * len(documents), events, World(1, silent=silent, endless=True))


def form(content: str, handlers: str = "") -> str:
    return f'<form id="f1"><block>{content}</block>{handlers}</form>'


def on(event: str, content: str) -> str:
    return f'<on event="{event}">{content}</on>'


def at(time: int, name: str = "touch") -> tuple[int, Inbound]:
    return time, Occurred(name, "user")


TOPIC = form(SAY.format("One") + '<move-head pan="10"/>' + SAY.format("Two"))
REACTS = '<form id="f1">' + on("touch", '<turn angle="5"/>' + SAY.format("Yes")) + "</form>"
MOVES = form('<topological-move to="room"/>')
TRACKS = form("<tracking-human/>")
TWO = form(SAY.format("One") + SAY.format("Two"))
SPEAKS = '<form id="f1">' + on("touch", SAY.format("Yes.")) + "</form>"
WAITS = form(SAY.format("Me."), on("touch", SAY.format("Yes.")))
ASKS = (
    '<form id="f1"><field name="q" type="boolean"><prompt>Well?</prompt>'
    "<filled><speak>Good.</speak><face-human/></filled></field></form>"
)
UNIT = form('<iu><speak>In.</speak><turn angle="1"/></iu>')
IDLE = '<form id="f1"/>'
BOTH = form(SAY.format("Me."))

BROKEN = play(form('<move-head pan="1"/>' + SAY.format("Mine.")), REACTS, events=(at(100),))
"""The reaction takes the floor, suspends, and gives it back."""
SUSPENDED = play(TRACKS, REACTS, events=(at(20),))
RIVALS = play(BOTH, BOTH)
PRESSED = play(
    form(SAY.format("Long.") + SAY.format("More.")),
    IDLE,
    events=((10, Emergency(True)), (50, Emergency(False, False))),
)


def indexes(records: Records, **fields: Any) -> list[int]:
    return [
        index
        for index, record in enumerate(records)
        if all(record.get(name) == value for name, value in fields.items())
    ]


def change(number: int, match: dict[str, Any], **new: Any) -> Corruption:
    """Change the fields of the record that matches as the ``number``-th one."""

    def changed(records: Records) -> Records:
        records[indexes(records, **match)[number]].update(new)
        return records

    return changed


def drop(number: int, **match: Any) -> Corruption:
    def dropped(records: Records) -> Records:
        del records[indexes(records, **match)[number]]
        return records

    return dropped


def double(new: dict[str, Any], **match: Any) -> Corruption:
    """Put a record behind the first that matches, which differs from it in some fields."""

    def doubled(records: Records) -> Records:
        index = indexes(records, **match)[0]
        return [*records[: index + 1], {**records[index], **new}, *records[index + 1 :]]

    return doubled


def instead(records: Records, index: int, name: str) -> Records:
    """Let another start than the winner of the decision at an index; cut off behind that."""
    before = records[:index]
    request = next(one for one in before if one["phase"] == "request" and one["behavior"] == name)
    start = {**records[index], "phase": "start", "behavior": name}
    start |= {field: request.get(field) for field in ("app", "tree", "command", "devices")}
    start |= {"reactive": request.get("reactive") or None, "cause": request.get("cause")}
    decision = {**records[index], "winner": name, "losers": [records[index]["winner"]]}
    while before[-1]["phase"] in ("floor", "suspend", "resume"):
        before.pop()
    return [*before, decision, start]


def other_first(rule: str) -> Corruption:
    """At a decision by the rule the loser starts, and not the winner."""

    def swapped(records: Records) -> Records:
        index = indexes(records, phase="decision", rule=rule)[0]
        return instead(records, index, records[index]["losers"][0])

    return swapped


def without_start(records: Records) -> Records:
    """What was to start last waits, and nobody says why."""
    index = indexes(records, phase="decision")[-1]
    time = records[index]["time"]
    return [one for one in records[:index] if one["phase"] != "hold" or one["time"] != time]


def spoken_into(records: Records) -> Records:
    """While ``fa`` moves its head between two sentences, ``ea`` speaks."""
    index = indexes(records, phase="hold", rule="F6")[0]
    decision = next(one for one in records if one["phase"] == "decision")
    time = records[index]["time"]
    records.insert(index, {**decision, "time": time, "losers": [], "losers_count": 0})
    return instead(records, index, records[index + 1]["behavior"])


def never_starts(records: Records) -> Records:
    """The move that starts when the user has been away for long enough does not."""
    index = indexes(records, phase="start", command="topological-move")[0]
    return [*records[: index - 1], {"phase": "log", "actor": "robot", "app": "fa", "time": 90_000}]


def after_its_end(records: Records) -> Records:
    index = indexes(records, phase="request", app="fa")[-1]
    gone = {"phase": "unload", "actor": "mediator", "app": "fa", "time": records[index]["time"]}
    return [*records[:index], gone, *records[index:]]


def cut_short(records: Records) -> Records:
    end = indexes(records, phase="start")[0] + 1
    over = {"time": records[end - 1]["time"], "phase": "over", "outcome": "over"}
    return [*records[:end], {**over, "actor": "mediator"}]


FIRST = {"phase": "request"}
WANTED = play(
    form(SAY.format("A") + SAY.format("B"), on("touch", '<turn angle="5" order="now"/>')),
    IDLE,
    events=(at(10),),
)
MISSED = play(
    form('<topological-move to="room"/>'),
    form("<face-human/>" + SAY.format("Story.") * 40),
    silent=100,
)
LEFT = play(
    form(
        SAY.format("Long.") + SAY.format("More."),
        on("touch", '<goto next="#f2"/>'),
    )
    + '<form id="f2"><block><speak>New.</speak></block></form>',
    IDLE,
    events=(at(10),),
)
"""A touch leaves a state in which one sentence is said and another waits (O3)."""
LEFT_LOOPING = play(
    form("<tracking-human/>", on("touch", '<goto next="#f2"/>')) + '<form id="f2"/>',
    IDLE,
    events=(at(20),),
)
LEFT_DONE = play(
    form(SAY.format("Done.") + '<goto next="#f2"/>')
    + '<form id="f2"><block><speak>New.</speak><exit/></block></form>',
    IDLE,
)
"""Nothing is left to cancel when a state is left, nor when its application ends."""
LEFT_ASKING = play(
    ASKS.replace("</form>", on("touch", '<goto next="#f2"/>') + "</form>") + '<form id="f2"/>',
    IDLE,
    events=(at(10),),
    silent=100,
)
LATER = '<form id="f1"><on event="{}" reactive="false"><speak>Hm.</speak></on></form>'
EARLIER = play(
    form(SAY.format("One")),
    LATER.format("corner"),
    LATER.format("message"),
    events=(at(10, "message"), at(20, "corner")),
)
BESIDE = play(
    form("<log>so</log>", '<on event="corner" reactive="false"><speak>Hm.</speak></on>'),
    '<form id="f1">' + on("touch", '<topological-move to="room"/>') + "</form>",
    events=(at(10), at(20, "corner")),
)
"""Who speaks beside a move that has the floor takes nothing from it (F3)."""


HELD_BY_TOPIC = play(TOPIC, form('<turn angle="5"/>' + SAY.format("I.")))
HELD_TWICE = play(BOTH, BOTH, BOTH)
LEFT_MOVING = play(
    form(SAY.format("Off.") + '<goto next="#f2"/>')
    + '<form id="f2"><block><topological-move to="room"/></block></form>',
    SPEAKS,
    events=(at(300),),
)
"""A state is left, and the move of the next one is stopped, suspended and resumed."""
TOLD = play(
    form(SAY.format("One") + SAY.format("Two"), on("suspended", "<log>so</log>")),
    SPEAKS,
    events=(at(10),),
)
"""An application hears that its stream has to wait (C2)."""
TAKEN_OUT = play(form(SAY.format("Long.")), IDLE, events=((10, ApplicationUnloaded("ea")),))


def listens_on(records: Records) -> Records:
    """A question whose state was left listens; cut off there."""
    return records[: indexes(records, phase="cancel", rule="O3")[0]]


def told_late(records: Records) -> Records:
    """The window in which an application hears that its stream waits comes 5 ms too late."""
    time = records[indexes(records, phase="log")[0]]["time"]
    return [{**one, "time": time + 5} if one["time"] == time else one for one in records]


def without_windows(records: Records) -> Records:
    return [one for one in records if one["phase"] != "window"]


def heard_of(records: Records) -> Records:
    """A window opens for the end of what was said when its state was left."""
    index = indexes(records, phase="end", behavior="fa#1")[0]
    window = {**records[index], "phase": "window", "outcome": "open"}
    return [*records[: index + 1], window, *records[index + 1 :]]


def takes_the_floor(records: Records) -> Records:
    index = indexes(records, phase="decision", app="fa")[0]
    taken = {"phase": "floor", "tree": "fa:1", "floor": ["ea:1", "fa:1"], "outcome": "taken"}
    return [*records[:index], {**records[index], **taken}, *records[index:]]


def told_as(new: str, number: int = 0, **match: Any) -> Corruption:
    """A decision and its start are both told by another rule."""

    def told(records: Records) -> Records:
        index = indexes(records, phase="decision", **match)[number]
        start = next(one for one in records[index:] if one["phase"] == "start")
        records[index]["rule"] = start["rule"] = new
        return records

    return told


@dataclass(frozen=True)
class Falsehood:
    """A corruption of a sound run, and what is found."""

    name: str
    made: Play
    corrupt: Corruption
    found: str


FALSEHOODS = (
    # What is told of decisions and of reasons to wait.
    Falsehood("rule", RIVALS, change(0, {"phase": "decision"}, rule="S2d"), "13 (S2)"),
    Falsehood("losers", RIVALS, change(0, {"phase": "decision"}, losers=["fa#9"]), "13 (S2)"),
    Falsehood("count", RIVALS, change(0, {"phase": "decision"}, losers_count=3), "13 (S2)"),
    Falsehood("undecided", RIVALS, drop(0, phase="decision"), "13 (S2)"),
    Falsehood("unsaid", RIVALS, drop(0, phase="hold"), "13 (S1)"),
    Falsehood("false-reason", RIVALS, change(0, {"phase": "hold"}, rule="K1"), "13 (K1)"),
    Falsehood("false-cause", RIVALS, change(0, {"phase": "hold"}, by="ea#1"), "13 (S1)"),
    # Floor, suspensions, ends.
    Falsehood("floor", BROKEN, drop(0, phase="floor"), "13 (F3)"),
    Falsehood("stack", BROKEN, change(0, {"phase": "floor"}, floor=["fa:1", "ea:1"]), "13 (F3)"),
    Falsehood("kept", BROKEN, drop(0, phase="floor", outcome="returned"), "13 (F3)"),
    Falsehood("suspend", SUSPENDED, drop(0, phase="suspend"), "13 (C2)"),
    Falsehood("by", SUSPENDED, change(0, {"phase": "suspend"}, by="ea:9"), "13 (C2)"),
    Falsehood("resume", SUSPENDED, drop(0, phase="resume"), "13 (C2)"),
    Falsehood("end-untold", RIVALS, drop(0, phase="stream-end"), "13 (C1)"),
    Falsehood("end-told-twice", RIVALS, double({"time": 1}, phase="start"), "3 (U1)"),
    # The rules that are told, and what became of whom.
    *(
        Falsehood(f"alone-{rule}", BROKEN, told_as(rule), "13 (S2)")
        for rule in ("S4", "F2", "K1", "F6", "E6", "X5", "U4")
    ),
    Falsehood("alone-S1", BROKEN, told_as("S1", number=1), "13 (S2)"),
    Falsehood("by-priority", BESIDE, told_as("S4", rule="F2"), "13 (S2)"),
    Falsehood("start", BROKEN, change(0, {"phase": "start"}, rule="S4"), "13 (S1)"),
    Falsehood("start-lost", RIVALS, change(0, {"phase": "start"}, rule="S2e"), "13 (S1)"),
    Falsehood("in-unit", play(UNIT, IDLE), change(1, {"phase": "start"}, rule="U5"), "13 (S1)"),
    Falsehood("taken-by", BROKEN, change(0, {"phase": "floor"}, rule="F3"), "13 (F3)"),
    Falsehood("taken-as", BROKEN, change(0, {"phase": "floor"}, outcome="held"), "13 (F3)"),
    Falsehood("given-by", BROKEN, change(1, {"phase": "floor"}, rule="F1"), "13 (F3)"),
    Falsehood("given-as", BROKEN, change(1, {"phase": "floor"}, outcome="taken"), "13 (F3)"),
    Falsehood("cancelled", LEFT, change(0, {"phase": "cancel"}, outcome="waiting"), "13 (O3)"),
    Falsehood("unloaded", TAKEN_OUT, drop(0, phase="unload", actor="mediator"), "13 (E2)"),
    # What each record says of itself.
    *(
        Falsehood(
            f"{phase}-by", LEFT_MOVING, change(0, {"phase": phase}, rule="S4"), f"13 ({rule})"
        )
        for phase, rule in (
            *(("window", "C3"), ("leave", "O3"), ("stream-end", "C1")),
            *(("suspend", "C2"), ("resume", "C2"), ("stop", "F5")),
        )
    ),
    *(
        Falsehood(
            f"{phase}-of", LEFT_MOVING, change(0, {"phase": phase, "app": "fa"}, app="ea"), found
        )
        for phase, found in (
            *(("window", "13 (C1)"), ("suspend", "13 (C1)"), ("resume", "13 (U1)")),
            *(("stream-end", "13 (C1)"), ("decision", "13 (U1)")),
            *(("start", "13 (U1)"), ("end", "13 (U1)"), ("stop", "13 (U1)"), ("leave", "3 (O3)")),
        )
    ),
    Falsehood("floor-of", LEFT_MOVING, change(0, {"phase": "floor"}, app="fa"), "13 (C1)"),
    Falsehood("text", LEFT_MOVING, change(0, {"phase": "start"}, text="No."), "13 (U1)"),
    Falsehood("resumes-by", SUSPENDED, change(0, {"phase": "resume"}, behavior="ea#1"), "13 (C2)"),
    # Windows.
    Falsehood("never-open", RIVALS, drop(0, phase="window", outcome="open"), "15 (C3)"),
    Falsehood("never-closed", RIVALS, drop(0, phase="window", outcome="closed"), "15 (C3)"),
    Falsehood("unheard", RIVALS, without_windows, "15 (C3)"),
    Falsehood("told-late", TOLD, told_late, "15 (O3)"),
    Falsehood("two-at-once", RIVALS, double({}, phase="window", outcome="open"), "15 (C3)"),
    # Reasons to wait, as long as one waits.
    Falsehood("still-said", HELD_TWICE, drop(1, phase="hold", app="xa"), "13 (S1)"),
    Falsehood("topic", HELD_BY_TOPIC, change(0, {"rule": "F6"}, by="fa#3"), "13 (F6)"),
    Falsehood(
        "waiting-loop", SUSPENDED, change(0, {"phase": "hold"}, behavior="fa#1.9"), "13 (S1)"
    ),
    # Stops.
    Falsehood(
        "unstopped", play(TRACKS, SPEAKS, events=(at(20),)), drop(0, phase="stop"), "14 (F5)"
    ),
    Falsehood("stopped", SUSPENDED, double({"phase": "stop"}, phase="start"), "14 (F5)"),
    # Requests.
    Falsehood("devices", RIVALS, change(0, FIRST, devices=["arm"]), "15 (K2)"),
    Falsehood("priority", RIVALS, change(0, FIRST, priority="low"), "15 (K2)"),
    Falsehood("leaves", MISSED, change(0, FIRST, leaves=None), "15 (K2)"),
    Falsehood("feedback", MISSED, change(0, FIRST, feedback=None), "15 (K2)"),
    Falsehood("engages", RIVALS, change(0, FIRST, engages=True), "15 (K2)"),
    Falsehood("window", play(ASKS, IDLE), change(1, FIRST, tree="fa:9"), "15 (C3)"),
    Falsehood("stream", BROKEN, change(1, FIRST, tree="fa:9"), "15 (U3)"),
    Falsehood("no-event", BROKEN, change(0, {"reactive": True}, cause=77), "15 (C5)"),
    Falsehood("no-cause", BROKEN, change(0, {"reactive": True}, cause=None), "15 (C5)"),
    Falsehood("twice", BROKEN, double({"time": 100}, phase="event"), "15 (C5)"),
    Falsehood("emergency", PRESSED, change(0, {"phase": "emergency"}, serial=None), "15 (E5)"),
    Falsehood("unit", play(UNIT, IDLE), change(0, {"unit": "fa#1"}, devices=["neck"]), "15 (U5)"),
    Falsehood("linked", WANTED, change(0, {"order": "now"}, parent="fa#1"), "15 (O2)"),
    Falsehood(
        "lost", PRESSED, drop(0, phase="cancel", behavior="fa#1", outcome="waiting"), "3 (C1)"
    ),
    Falsehood("needless", BESIDE, takes_the_floor, "13 (F3)"),
    Falsehood("gone", BROKEN, after_its_end, "3 (E2)"),
    Falsehood("cut-short", BROKEN, cut_short, "2 (E2)"),
    # Leaving a state.
    Falsehood("not-left", LEFT, drop(0, phase="leave"), "3 (O3)"),
    Falsehood("goes-on", LEFT_DONE, drop(0, phase="leave"), "3 (O3)"),
    Falsehood("ends-in-it", LEFT_DONE, drop(-1, phase="leave"), "3 (O3)"),
    Falsehood("left-unasked", LEFT_DONE, change(-1, {"phase": "leave"}, state=7), "3 (O3)"),
    Falsehood("left-twice", LEFT, double({}, phase="leave"), "3 (O3)"),
    Falsehood("waits-on", LEFT, drop(0, phase="cancel", rule="O3"), "3 (O3)"),
    Falsehood("asks-on", LEFT, change(-1, FIRST, state=1), "3 (O3)"),
    Falsehood("heard-of", LEFT, heard_of, "15 (O3)"),
    Falsehood("elsewhere", LEFT, change(-1, FIRST, tree="fa:9", parent=None), "15 (O3)"),
    Falsehood("loops-on", LEFT_LOOPING, change(-1, {"phase": "end"}, outcome="again"), "3 (O3)"),
    Falsehood("stops-looping", LEFT_LOOPING, drop(0, phase="leave"), "3 (U2)"),
    Falsehood("listens-on", LEFT_ASKING, listens_on, "3 (O3)"),
    # Who starts.
    Falsehood("S2a", play(MOVES, form('<turn angle="5"/>')), other_first("S2a"), "5 (S2a)"),
    Falsehood("S2b", play(TWO, SPEAKS, events=(at(10),)), other_first("S2b"), "6 (S3)"),
    Falsehood("S2c", play(TWO, BOTH), other_first("S2c"), "12 (S2c)"),
    Falsehood("S2d", play(TWO, WAITS, events=(at(10),)), other_first("S2d"), "12 (S2d)"),
    Falsehood("S2e", EARLIER, other_first("S2e"), "12 (S2e)"),
    Falsehood("S2f", RIVALS, other_first("S2f"), "12 (S2f)"),
    Falsehood("waits", RIVALS, without_start, "5 (S1)"),
    Falsehood(
        "F6", play(TOPIC, form('<turn angle="5"/>' + SAY.format("I."))), spoken_into, "5 (F6)"
    ),
    Falsehood("K1", MISSED, never_starts, "5 (S1)"),
)


def records_of(made: Play) -> Records:
    return [dict(record) for record in perform(made).records]


@pytest.mark.parametrize("one", FALSEHOODS, ids=lambda one: one.name)
def test_a_falsehood_is_found(one: Falsehood) -> None:
    assert check(records_of(one.made), declared=APPS) == []
    found = check(one.corrupt(records_of(one.made)), declared=APPS)
    assert any(text.startswith(f"invariant {one.found}") for text in found), found


def swaps(records: Records) -> list[Records]:
    """Every decision between ABs that share a device, decided otherwise."""
    found = []
    requests = {one["behavior"]: one for one in records if one["phase"] == "request"}
    for index in indexes(records, phase="decision"):
        decision = records[index]
        winner = requests[decision["winner"].partition(".")[0]]
        names = [name for name in decision["losers"] if "." not in name]
        if not decision["rule"].startswith("S2") or not names or winner.get("order") == "now":
            continue
        loser = requests[names[0]]
        if set(loser["devices"]) & set(winner["devices"]) and not loser.get("feedback"):
            found.append(instead(records, index, names[0]))
    return found


@given(plays())
@settings(
    max_examples=30,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
)
def test_another_order_is_found_wherever_something_is_decided(made: Play) -> None:
    run = perform(made)
    if check(run.records, declared=APPS, calling=run.calling):
        return  # what is wrong already is told by the properties
    for swapped in swaps(run.records):
        found = check(swapped, declared=APPS, calling=run.calling)
        assert any("outranks" in text or "reaction" in text for text in found), found
