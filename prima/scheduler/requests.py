"""Takes applications' requests into working memory (O1, O2, O3, U3, U5, E2, E3, X6)."""

from __future__ import annotations

from prima.messages import NO_DEVICES, LeaveState, Notice, OpenUnit, Request, line_of
from prima.scheduler.admission import (
    CommandRefused,
    check_command,
    check_number,
    check_steps,
    link,
    occupied_by,
    parent_in,
    substitute,
)
from prima.scheduler.behavior import GONE, Application, AwaitedRun, Behavior, Stream
from prima.scheduler.endings import cancel, close_unit, withdraw
from prima.scheduler.mediation import Mediation
from prima.scheduler.streams import continue_with, drop_hints, going_on, held_of, let_go, opened, x3


def u3(mediation: Mediation, app: Application, asked: Request) -> None:
    """U3: accept Commands as one tree, or refuse them all (E3)."""
    x6(mediation, app, asked)
    unit = app.units.get(asked.unit) if asked.unit is not None else None
    try:
        most = mediation.longest_turn
        check_number(asked.steps, sum(one.app is app for one in mediation.memory.waiting.values()))
        check_steps(asked.steps, app, mediation.table, unit.devices if unit else None, most)
        _check_words(mediation, app, asked)
    except CommandRefused as refused:
        e3(mediation, app, asked, refused)
    else:
        _take_in(mediation, app, asked, unit)


def _check_words(mediation: Mediation, app: Application, asked: Request) -> None:
    """X9: a robot that speaks must be able to say the words with which a topic resumes."""
    words, table = asked.words, mediation.table
    if words is None or "x9" not in mediation.policy.extensions:
        return
    if words.type in table and not table[words.type].substitute:
        check_command(words, app, table, mediation.longest_turn)


def _take_in(mediation: Mediation, app: Application, asked: Request, unit: Behavior | None) -> None:
    """U3: make ABs of valid Commands in the stream to which they belong."""
    first = asked.steps[0].what
    reaction = asked.cause if unit is None else None
    if first.now:
        devices = occupied_by(first, mediation.table)
        stream, parent = o2(mediation, app, devices, reaction, unit), None
    else:
        stream, parent = place(mediation, app, reaction, unit)
    x3(mediation, stream, asked)
    stream.words = asked.words if "x9" in mediation.policy.extensions else None
    run, now = AwaitedRun(asked.run, len(asked.steps)), mediation.now
    made = mediation.maker.chain(app, stream, asked.steps, now, asked.state, run, unit)
    if asked.connect and unit is None:
        _connect(made)
    for ab in made:
        if not ab.waits_for:
            _root(mediation, ab, parent, reaction)
            x8(mediation, ab, asked.fresh)
        if unit is not None and unit.inside is not None:
            unit.inside.members[ab.name] = unit.inside.latest = ab
        mediation.memory.add(ab)
        mediation.recorder.request(ab)
    if unit is None:
        app.latest = made[-1]


def _connect(made: list[Behavior]) -> None:
    """X4: mark the first words of a tree: those that no other of it precedes."""
    followed: set[str] = set()
    for ab in made:
        follows = not followed.isdisjoint(ab.waits_for)
        ab.connect = ab.says and not follows
        if ab.says or follows:
            followed.add(ab.name)


def x8(mediation: Mediation, ab: Behavior, fresh: int | None) -> None:
    """X8: the latest time at which a reaction is still worth starting."""
    if fresh is not None and ab.reaction is not None and "x8" in mediation.policy.extensions:
        ab.stale = mediation.now + fresh


def e3(mediation: Mediation, app: Application, asked: Request, refused: CommandRefused) -> None:
    """E3: Commands are refused before they enter working memory."""
    command = refused.command
    mediation.recorder.add(
        "fail",
        "mediator",
        app=app.name,
        rule="E3",
        command=command.type if command else None,
        event=refused.event,
        message=refused.message,
        source=line_of(command.source) if command else None,
    )
    notice = Notice("failed", asked.run, command, event=refused.event, message=refused.message)
    notice.cause = asked.cause
    mediation.tell(app, None, notice)


def x6(mediation: Mediation, app: Application, asked: Request) -> None:
    """X6: substitute other Commands for those that the robot lacks."""
    if "x6" not in mediation.policy.extensions:
        return
    for command in substitute(asked.steps, mediation.table):
        mediation.recorder.add(
            "substitute",
            "mediator",
            app=app.name,
            rule="X6",
            command=command.replaces,
            by=command.type,
            source=line_of(command.source),
        )


def u5(mediation: Mediation, app: Application, asked: OpenUnit) -> None:
    """U5: a unit that spans questions is requested like a separate AB."""
    stream, parent = place(mediation, app, asked.cause, None)
    if stream.held_until is not None:
        let_go(mediation, stream, "joined")
    asked.devices |= _devices_of(mediation, asked.types)
    unit = mediation.maker.spanning(app, stream, asked, mediation.now)
    app.units[asked.unit] = app.latest = unit
    _root(mediation, unit, parent, asked.cause)
    unit.connect = asked.connect
    x8(mediation, unit, asked.fresh)
    mediation.memory.add(unit)
    mediation.recorder.request(unit)


def _devices_of(mediation: Mediation, types: tuple[str, ...]) -> frozenset[str]:
    """The devices of Commands as this robot does them, substitutes included (X6)."""
    table, devices = mediation.table, NO_DEVICES
    for name in types:
        row = table.get(name)
        if row is not None and row.substitute and "x6" in mediation.policy.extensions:
            row = table[row.substitute]
        if row is not None and not row.substitute:
            devices |= row.devices
    return devices


def e2(mediation: Mediation, app: Application, reason: str) -> None:
    """E2: an application has ended: its running ABs finish, the others are removed."""
    app.gone = True
    withdraw(mediation, list(app.members.values()), "E2")
    drop_hints(mediation, app, None)
    for number in list(app.units):
        close_unit(mediation, app, number)
    mediation.recorder.add("unload", "mediator", app=app.name, rule="E2", outcome=reason)


def o3(mediation: Mediation, app: Application, asked: LeaveState) -> None:
    """O3: delete the state's Commands that have not started; its loops end."""
    mediation.recorder.add("leave", "mediator", app=app.name, rule="O3", state=asked.state)
    drop_hints(mediation, app, asked.state)
    state = [ab for ab in app.members.values() if ab.document_state == asked.state]
    if state:
        continue_with(mediation, app, going_on([ab.stream for ab in state]))
        withdraw(mediation, state, "O3")


# Where a tree belongs -----------------------------------------------------------------------------


def place(
    mediation: Mediation, app: Application, reaction: int | None, unit: Behavior | None
) -> tuple[Stream, Behavior | None]:
    """O1, O3, C3: the stream a new tree belongs to, and its parent there; a reaction has none."""
    if unit is not None:
        return unit.stream, parent_in(unit)
    parent = o1(app) if reaction is None else None
    if parent is not None:
        return parent.stream, parent
    return opened(mediation, stream_of(mediation, app, reaction)), None


def o1(app: Application) -> Behavior | None:
    """O1: the AB that a Command follows; in a window, an AB of the window's stream."""
    if app.window is not None:
        return app.window.latest()
    latest = app.latest
    return latest if latest is not None and latest.state is not GONE else None


def stream_of(mediation: Mediation, app: Application, reaction: int | None) -> Stream:
    """The stream that a tree without a parent continues, or a new one."""
    if reaction is None and app.window is not None:
        return app.window
    return held_of(mediation, app) or app.continuing or mediation.maker.stream(app)


def _root(
    mediation: Mediation, ab: Behavior, parent: Behavior | None, reaction: int | None
) -> None:
    """Give a root its parent by O1, its reactive flag by C5, or its place by C3."""
    if parent is not None:
        link(parent, ab)
    elif reaction is not None:
        ab.reaction = reaction
    elif ab.app.window is not None:
        ab.freed = mediation.now


def _at_once(unit: Behavior, devices: frozenset[str]) -> list[Behavior]:
    """O2: what was requested in a unit at once with an AB that needs one of these devices.

    All of a unit is one stream: of it, a tree is what was requested at once (U3).
    """
    runs = {id(ab.run) for ab in unit.inner.values() if ab.devices & devices}
    return [ab for ab in unit.inner.values() if id(ab.run) in runs]


def o2(
    mediation: Mediation,
    app: Application,
    devices: frozenset[str],
    reaction: int | None,
    unit: Behavior | None,
) -> Stream:
    """O2: cancel this application's trees that need a device of the new Command or unit.

    Returns:
        The stream that goes on: one of those cancelled, or one that is held (X3), though not
        in a window: no event that such a stream waits for has come.
    """
    if unit is not None:
        cancel(mediation, _at_once(unit, devices), devices)
        return unit.stream
    streams = {ab.stream.name: ab.stream for ab in app.members.values() if ab.devices & devices}
    waited_for = reaction is not None or app.window is None
    if streams and not (waited_for and held_of(mediation, app)):
        stream = going_on(list(streams.values()))
    else:
        stream = stream_of(mediation, app, reaction)
    for one in streams.values():
        cancel(mediation, list(one.members.values()), devices)
    return opened(mediation, stream)
