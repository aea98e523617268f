"""Communication Streams: how they begin, are suspended, resumed, held and ended (C1-C3, F1, F3, X3)."""

from __future__ import annotations

from prima.messages import Request
from prima.scheduler.behavior import Application, Behavior, Stream, application
from prima.scheduler.mediation import Mediation, Told


def opened(mediation: Mediation, stream: Stream) -> Stream:
    """Let a stream begin, or go on after all."""
    if stream.name not in mediation.memory.streams:
        mediation.memory.open(stream)
    mediation.touch(stream)
    return stream


def going_on(streams: list[Stream]) -> Stream:
    """O2, O3: of streams that are cancelled, the one that goes on.

    That is the one that runs, or of which an AB started last; else the latest.
    """
    return max(reversed(streams), key=lambda one: (one.runs, one.turn))


def continue_with(mediation: Mediation, app: Application, stream: Stream) -> None:
    """O3: what the application asks for in this instant outside of windows goes on with it."""
    app.continuing = stream
    mediation.continuing.append(app)


def end_continuing(mediation: Mediation) -> None:
    """O3: the instant is over."""
    for app in mediation.continuing:
        app.continuing = None
    mediation.continuing.clear()


# Windows (C3) -------------------------------------------------------------------------------


def open_window(mediation: Mediation, told: Told) -> None:
    """C3: while an application handles the end of its Command, its stream stays open."""
    mediation.changed = True
    mediation.memory.apps[told.app].window = told.stream
    if told.stream is not None:
        mediation.recorder.stream("window", told.stream, "C3", outcome="open")


def close_window(mediation: Mediation, told: Told) -> None:
    """C3: the application has gone to wait for something else."""
    mediation.changed = True
    mediation.memory.apps[told.app].window = None
    if told.stream is not None:
        mediation.touch(told.stream)
        mediation.recorder.stream("window", told.stream, "C3", outcome="closed")


# Floors (F1, F3) and suspension (C2) -----------------------------------------------------------


def f1(mediation: Mediation, ab: Behavior, reaction: int | None, beside: bool) -> bool:
    """F1, F3: a reaction, or what starts by F2, takes the floor; true if it has done so."""
    stream, memory = ab.stream, mediation.memory
    if reaction is not None:
        stream.causes.add(reaction)
    stays = (reaction is None and beside) or stream is memory.holder
    if not mediation.policy.floor or stays:
        return False
    if stream in memory.floor:
        memory.floor.remove(stream)
    take_floor(mediation, stream, "F1" if reaction is not None else "F3")
    return True


def take_floor(mediation: Mediation, stream: Stream, rule: str) -> None:
    """Put a stream on top of the floors; the others' streams are suspended (C2)."""
    floor = mediation.memory.floor
    floor.append(stream)
    names = [held.name for held in floor]
    mediation.recorder.stream("floor", stream, rule, outcome="taken", floor=names)
    suspend_others(mediation, stream)


def suspend_others(mediation: Mediation, stream: Stream) -> None:
    """C2: suspend the others' streams that have begun; together, so that they rank alike (S2d)."""
    begun = [
        other
        for other in mediation.memory.streams.values()
        if other.app is not stream.app and other.open and other.turn
    ]
    mediation.suspensions += 1
    for other in begun:
        if not other.suspended:
            other.suspended, other.place = True, mediation.suspensions
            mediation.recorder.stream("suspend", other, "C2", by=stream.name)


def resume(mediation: Mediation, stream: Stream, ab: Behavior) -> None:
    """C2: a suspended stream goes on with an AB."""
    stream.suspended = False
    mediation.resumed.append(stream)
    if stream.waits:
        stream.waits = False
        mediation.turns.append(("resumed", stream))
    mediation.recorder.stream("resume", stream, "C2", behavior=ab.id)


def note_turns(mediation: Mediation) -> None:
    """C2: a suspended stream waits from when another application keeps an AB of it waiting."""
    for stream in mediation.resumed:
        if not stream.suspended:
            stream.place = 0
    for ab in mediation.memory.waiting.values():
        stream = ab.stream
        if not stream.suspended or stream.waits:
            continue
        if application(ab.wait.blocked[1]) not in ("", ab.app.name):
            stream.waits = True
            mediation.turns.append(("suspended", stream))


def c1(mediation: Mediation) -> None:
    """C1, F3: streams that nothing keeps open end, and hold no floor then."""
    touched, mediation.touched = mediation.touched, {}
    kept: list[Stream] = []
    for stream in touched.values():
        if stream.open or stream.name not in mediation.memory.streams:
            continue
        if stream.hold and not stream.app.gone:
            kept.append(stream)  # after those that end have given the floor back
        else:
            _end(mediation, stream)
    for stream in kept:
        keep_open(mediation, stream)


def _end(mediation: Mediation, stream: Stream) -> None:
    mediation.memory.end(stream)
    mediation.recorder.stream("stream-end", stream, "C1")
    floor = mediation.memory.floor
    if stream in floor:
        floor.remove(stream)
        names = [held.name for held in floor]
        mediation.recorder.stream("floor", stream, "F3", outcome="returned", floor=names)


# Holds (X3) --------------------------------------------------------------------------------------


def x3(mediation: Mediation, stream: Stream, asked: Request) -> None:
    """X3: the latest request of a stream says whether it is held afterwards."""
    if stream.held_until is not None:
        let_go(mediation, stream, "joined")
    if mediation.has("x3"):
        stream.hold, stream.hold_state = asked.hold, asked.state


def keep_open(mediation: Mediation, stream: Stream) -> None:
    """X3: the stream stays open, with the floor unless another has it, and waits."""
    assert stream.hold is not None
    until = mediation.now + stream.hold
    mediation.holds[stream.name] = stream.held_until = until
    data = {"until": until / 1000}
    mediation.recorder.stream("held", stream, "X3", outcome="begun", data=data)
    if not mediation.memory.floor:
        take_floor(mediation, stream, "X3")


def let_go(mediation: Mediation, stream: Stream, outcome: str) -> None:
    """X3: the stream is held no longer."""
    stream.hold = stream.held_until = None
    del mediation.holds[stream.name]
    mediation.touch(stream)
    mediation.recorder.stream("held", stream, "X3", outcome=outcome)


def drop_hints(mediation: Mediation, app: Application, state: int | None) -> None:
    """X3: a state that is left, or an application that ends, holds nothing any more."""
    if not mediation.has("x3"):
        return
    for stream in mediation.memory.streams.values():
        if stream.app is app and stream.hold and state in (None, stream.hold_state):
            stream.hold = None
            if stream.held_until is not None:
                continue_with(mediation, app, stream)
                let_go(mediation, stream, "left")


def held_of(mediation: Mediation, app: Application) -> Stream | None:
    """X3: the application's stream that is held, the latest of several."""
    held = (mediation.memory.streams[name] for name in reversed(mediation.holds))
    return next((stream for stream in held if stream.app is app), None)
