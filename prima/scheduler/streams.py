"""Communication Streams: how they begin, are suspended, resumed, held and ended (C1-C3, F1, F3, X3)."""

from __future__ import annotations

from prima.messages import Request
from prima.scheduler.behavior import Application, Behavior, Stream, application
from prima.scheduler.mediation import Delivery, Mediation


def opened(mediation: Mediation, stream: Stream) -> Stream:
    """Begin a stream, or continue one that was about to end."""
    mediation.memory.streams[stream.name] = stream
    return stream


def going_on(streams: list[Stream]) -> Stream:
    """O2, O3: the one of several cancelled streams that goes on.

    That is the running one or, failing that, the one whose AB started last; else the latest.
    """
    return max(reversed(streams), key=lambda one: (one.runs, one.turn))


def continue_with(mediation: Mediation, app: Application, stream: Stream) -> None:
    """O3: what the application requests in this instant outside windows continues the stream."""
    app.continuing = stream
    mediation.continuing.append(app)


def end_continuing(mediation: Mediation) -> None:
    """O3: the instant is over."""
    for app in mediation.continuing:
        app.continuing = None
    mediation.continuing.clear()


# Windows (C3) -------------------------------------------------------------------------------


def open_window(mediation: Mediation, delivery: Delivery) -> None:
    """C3: while an application handles the end of its Command, its stream stays open."""
    mediation.memory.apps[delivery.app].window = delivery.stream
    if delivery.stream is not None:
        mediation.recorder.stream("window", delivery.stream, "C3", outcome="open")


def close_window(mediation: Mediation, delivery: Delivery) -> None:
    """C3: the application now waits for something else."""
    mediation.memory.apps[delivery.app].window = None
    if delivery.stream is not None:
        mediation.recorder.stream("window", delivery.stream, "C3", outcome="closed")


# Floors (F1, F3) and suspension (C2) -----------------------------------------------------------


def f1(mediation: Mediation, ab: Behavior, reaction: int | None, beside: bool) -> bool:
    """F1, F3: a reaction, or an AB that starts by F2, takes the floor; whether it did."""
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
        if other.app is not stream.app and other.turn
    ]
    mediation.suspensions += 1
    for other in begun:
        if not other.suspended:
            other.suspended = other.moved_away = True
            other.place = mediation.suspensions
            mediation.recorder.stream("suspend", other, "C2", by=stream.name)


def resume(mediation: Mediation, stream: Stream, ab: Behavior) -> None:
    """C2: a suspended stream resumes with an AB."""
    stream.suspended = False
    mediation.resumed.append(stream)
    if stream.waits:
        stream.waits = False
        mediation.turns.append(("resumed", stream))
    mediation.recorder.stream("resume", stream, "C2", behavior=ab.id)


def note_turns(mediation: Mediation) -> None:
    """C2: a suspended stream waits once another application keeps one of its ABs waiting."""
    for stream in mediation.resumed:
        if not stream.suspended:
            stream.place = 0
    for ab in mediation.memory.waiting.values():
        stream = ab.stream
        if not stream.suspended or stream.waits:
            continue
        if application(ab.wait.blocked[1]) != ab.app.name:
            stream.waits = True
            mediation.turns.append(("suspended", stream))


def c1(mediation: Mediation) -> None:
    """C1, F3: end the streams that nothing keeps open; they give up the floor.

    Only a stream that has begun is held. The latest of the held ones takes the floor if nobody
    else has it (X3).
    """
    touched, mediation.touched = mediation.touched, {}
    for stream in touched.values():
        if not stream.open:
            (keep_open if stream.hold and stream.turn else _end)(mediation, stream)
    if mediation.holds and not mediation.memory.floor:
        take_floor(mediation, mediation.memory.streams[next(reversed(mediation.holds))], "X3")


def _end(mediation: Mediation, stream: Stream) -> None:
    memory = mediation.memory
    del memory.streams[stream.name]
    memory.engaged.pop(stream.name, None)
    mediation.recorder.stream("stream-end", stream, "C1")
    floor = memory.floor
    if stream in floor:
        floor.remove(stream)
        names = [held.name for held in floor]
        mediation.recorder.stream("floor", stream, "F3", outcome="returned", floor=names)


# Holds (X3) --------------------------------------------------------------------------------------


def x3(mediation: Mediation, stream: Stream, asked: Request) -> None:
    """X3: a stream's latest request determines whether it is held afterwards."""
    if stream.held_until is not None:
        let_go(mediation, stream, "joined")
    if "x3" in mediation.policy.extensions:
        stream.hold, stream.hold_state = asked.hold, asked.state


def keep_open(mediation: Mediation, stream: Stream) -> None:
    """X3: the stream stays open, and waits."""
    assert stream.hold is not None
    until = mediation.now + stream.hold
    mediation.holds[stream.name] = stream.held_until = until
    data = {"until": until / 1000}
    mediation.recorder.stream("held", stream, "X3", outcome="begun", data=data)


def let_go(mediation: Mediation, stream: Stream, outcome: str) -> None:
    """X3: the stream is no longer held."""
    stream.hold = stream.held_until = None
    del mediation.holds[stream.name]
    mediation.touch(stream)
    mediation.recorder.stream("held", stream, "X3", outcome=outcome)


def drop_hints(mediation: Mediation, app: Application, state: int | None) -> None:
    """X3: release what a state that is left, or an application that ends, has held."""
    for stream in mediation.memory.streams.values():
        if stream.app is app and state in (None, stream.hold_state):
            stream.hold = None
            if stream.held_until is not None:
                continue_with(mediation, app, stream)
                let_go(mediation, stream, "left")


def held_of(mediation: Mediation, app: Application) -> Stream | None:
    """X3: the application's held stream; of several, the latest."""
    held = (mediation.memory.streams[name] for name in reversed(mediation.holds))
    return next((stream for stream in held if stream.app is app), None)
