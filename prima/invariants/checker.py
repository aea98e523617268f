"""The checker goes through the records of one run and applies every family of rules."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from prima.invariants import (
    channel,
    endings,
    extensions,
    floor,
    late,
    leaving,
    patience,
    selection,
    starts,
    streams,
    telling,
    turn,
)
from prima.invariants.memory import Memory
from prima.invariants.model import AB, GONE, LINKED, Record, Tree, base, ms
from prima.invariants.table import contradictions


def violations(memory: Memory) -> list[str]:
    """All violations in a run's records, in the order in which they show."""
    for place, record in enumerate(memory.records):
        if record["time"] != memory.now:
            _instant_over(memory)
            _until(memory, record["time"])
        memory.place = place
        telling.tells_rightly(memory, record)
        take = TAKES.get(record["phase"])
        if take is not None:
            take(memory, record)
    _instant_over(memory)
    return memory.found


def _end(memory: Memory, record: Record) -> None:
    patience.note_answer(memory, record)
    turn.note_turn(memory, record)
    late.note_lapse(memory, record)
    endings.note_end(memory, record)


def _until(memory: Memory, time: int) -> None:
    """Advance to the next recorded instant, past the moment in which K1 may lapse."""
    patience.pass_time(memory, time)
    lapse = channel.lapses_at(memory)
    if memory.now < lapse < time and not memory.in_view and not memory.halted:
        memory.now = lapse
        for ab in memory.waiting.values():
            if ab.leaves and memory.prima:
                selection.late(memory, ab)
    memory.now = time
    memory.new_instant()


def _load(memory: Memory, record: Record) -> None:
    if record["actor"] == "mediator":
        _former(memory, record["app"])
        memory.apps.setdefault(record["app"], len(memory.apps))
        memory.gone_apps.discard(record["app"])
        memory.loaded.add(record["app"])
        memory.left = {one for one in memory.left if one[0] != record["app"]}  # it is counted anew
        memory.asked.pop(record["app"], None)


def _former(memory: Memory, name: str) -> None:
    """ABs still running when an application is loaded again belong to its former run (E2)."""
    memory.latest.pop(name, None)
    former = f"{name}, unloaded"
    known: list[Tree | AB] = [*memory.trees.values(), *memory.abs.values()]
    for one in known:
        if one.app == name:
            one.app = former
            memory.apps[former] = memory.apps[name]
            memory.gone_apps.add(former)
    memory.continuing.pop(name, None)
    if name in memory.unloaded:  # in this instant
        memory.unloaded.add(former)
    memory.left_now = {(former if app == name else app, state) for app, state in memory.left_now}


def _unload(memory: Memory, record: Record) -> None:
    if record["actor"] == "mediator":
        leaving.left_at_end(memory, record["app"], record.get("outcome") or "")
        memory.gone_apps.add(record["app"])
        memory.unloaded.add(record["app"])
        memory.taken_out.discard(record["app"])
        memory.loaded.discard(record["app"])
    elif record["app"] in memory.loaded:
        memory.taken_out.add(record["app"])


def _decision(memory: Memory, record: Record) -> None:
    if memory.decision is not None and memory.prima:
        memory.report(13, "S2", f"{memory.decision['winner']} is selected, but does not start")
    memory.decision = record
    turn.look_for_turn(memory)


def _event(memory: Memory, record: Record) -> None:
    late.note_speech(memory, record)
    channel.note_event(memory, record)


def _hold(memory: Memory, record: Record) -> None:
    turn.look_for_turn(memory)
    selection.note_hold(memory, record)


def _listening(memory: Memory, record: Record) -> None:
    ab = memory.running.get(base(record["behavior"]))
    if ab is not None:
        ab.listening = True


# Requests -----------------------------------------------------------------------


def _request(memory: Memory, record: Record) -> None:
    name, app = record["behavior"], record["app"]
    if name in memory.abs:
        memory.report(3, "U1", f"{name} is requested twice")
        return
    _may_ask(memory, record)
    leaving.asks(memory, record)
    new = record["tree"] not in memory.trees
    tree = memory.trees.setdefault(record["tree"], Tree(record["tree"], app))
    ab = memory.abs[name] = _made(memory, record, tree)
    before = memory.abs.get(ab.put_before) if ab.inserted else None
    tree.members[name] = ab
    extensions.wants_hold(memory, tree, ab, record)
    if ab.unit is not None:
        _into_unit(memory, ab.unit, record)
    if ab.inserted:
        extensions.put_in(memory, ab, before, record)
    if ab.parents:
        ab.phase = LINKED
    else:
        _waits_from_now(memory, ab)
    if record.get("order") == "now":
        memory.urgent.append((ab, memory.place))
    _asked_rightly(memory, ab, record, new)
    if record.get("order") == "now":
        endings.maybe_silence(memory, ab)
    if ab.unit is None and not ab.inserted:
        memory.latest[app] = ab


def _into_unit(memory: Memory, unit: AB, record: Record) -> None:
    """U4: the Commands of a group are requested when it starts from its beginning, once."""
    if unit.name in memory.groups and any(one["time"] != memory.now for one in unit.content):
        memory.report(3, "U4", f"{record['behavior']} is requested, but {unit.name} has begun")
    unit.content.append(record)


def _waits_from_now(memory: Memory, ab: AB) -> None:
    """C3: requests in a window count as following the AB that has just ended (S2c)."""
    window = streams.window_of(memory, ab.app)
    memory.wait(ab)
    if window is not None and not ab.inserted:
        ab.followed_at = memory.now


def _asked_rightly(memory: Memory, ab: AB, record: Record, new: bool) -> None:
    """Check a request: its type's row, its stream, its cause, its unit's devices."""
    for text in [] if ab.inserted else contradictions(record):
        memory.report(15, "K2", f"{ab.name} is {ab.command}, but {text}")
    if ab.unit is not None and not ab.devices <= ab.unit.devices:
        more = ", ".join(sorted(ab.devices - ab.unit.devices))
        memory.report(15, "U5", f"{ab.name} needs {more}, which {ab.unit.name} does not own")
    if ab.unit is not None and (ab.leaves or ab.feedback):
        memory.report(15, "U4", f"{ab.name} is {ab.command} in {ab.unit.name}")
    if not ab.inserted and memory.prima:
        channel.caused_rightly(memory, ab, record)
    if memory.prima:
        streams.placed_rightly(memory, ab, new)


def _may_ask(memory: Memory, record: Record) -> None:
    """O3, E2, X6: states that were left and applications that have ended make no requests."""
    name, app = record["behavior"], record["app"]
    if (app, record.get("state")) in memory.left and record.get("unit") not in memory.nested:
        memory.report(3, "O3", f"{name} is requested, but its state was left")
    if app in memory.gone_apps and not record.get("unit"):
        memory.report(3, "E2", f"{name} is requested, but {app} has ended")
    if record["command"] in memory.lacking:
        memory.report(3, "X6", f"{name} is requested, but the robot lacks {record['command']}")


def _made(memory: Memory, record: Record, tree: Tree) -> AB:
    """The AB of a request."""
    cause = record.get("cause") if record.get("reactive") else None
    unit = memory.abs.get(base(record["unit"])) if record.get("unit") else None
    return AB(
        name=record["behavior"],
        command=record["command"],
        app=record["app"],
        tree=tree,
        devices=frozenset(record["devices"]),
        high=record["priority"] == "high",
        question=record["command"] == "q-and-a",
        state=record.get("state"),
        unit=unit,
        cause=cause,
        reacted_to=cause,
        parents=_parents(memory, record),
        requested=memory.now,
        place=memory.place,
        urgent=record.get("order") == "now",
        motion=record.get("motion") or "" if unit is None else "",
        fresh_until=memory.now + ms(record["fresh"]) if record.get("fresh") else None,
        inserted=record.get("inserted") or "",
        put_before=base(record.get("before") or ""),
        waits_as=record["behavior"],
        leaves=bool(record.get("leaves")),
        engages=bool(record.get("engages")),
        feedback=bool(record.get("feedback")),
        restartable=bool(record.get("restartable")),
        says="speaker" in record["devices"]
        and (record["command"] == "iu" or bool(record.get("text"))),
        spans=bool(record.get("spans")),
        connect=bool(record.get("connect")),
    )


def _parents(memory: Memory, record: Record) -> set[str]:
    """U3: the ABs that a request follows and that are still in memory."""
    parents = record.get("parents") or ([record["parent"]] if record.get("parent") else [])
    names = {base(parent) for parent in parents}
    unknown = [parent for parent in names if parent not in memory.abs]
    if unknown:
        text = f"{record['behavior']} follows {unknown[0]}, which was never requested"
        memory.report(4, "U3", text)
    if record.get("inserted"):
        names.discard(base(record["before"]))  # the loop of it that has ended
    return {one for one in names if one in memory.abs and memory.abs[one].phase != GONE}


# The end of an instant ----------------------------------------------------------


def _instant_over(memory: Memory) -> None:
    _look_back(memory)
    patience.note_keepers(memory)


def _look_back(memory: Memory) -> None:
    turn.look_for_turn(memory)
    extensions.close_trees(memory)
    extensions.holds_rightly(memory)
    extensions.interruptions(memory)
    for cut in memory.cuts:
        endings.justified(memory, cut)
    channel.channel_kept_inside(memory)
    leaving.left_rightly(memory)
    for app in sorted(memory.taken_out):
        memory.report(13, "E2", f"{app} is taken out, but its end is not recorded")
    memory.taken_out.clear()
    if memory.prima:
        _check_records(memory)
    for tree in memory.resumed:
        tree.rank = tree.rank if tree.suspended else 0
    if memory.halted:
        for ab in memory.running.values():
            memory.report(2, "E5", f"{ab.shown} runs during the emergency stop")
        return
    for ab in memory.waiting.values():
        late.fresh(memory, ab)
        selection.waits_rightly(memory, ab)


def _check_records(memory: Memory) -> None:
    """Check the mediator's records of a finished instant."""
    if memory.decision is not None:
        memory.report(13, "S2", f"{memory.decision['winner']} is selected, but does not start")
    floor.check_floor(memory)
    floor.stopped_rightly(memory)
    streams.check_ends(memory)
    streams.check_windows(memory)
    streams.left_waiting(memory)


TAKES: Mapping[str, Callable[[Memory, Record], None]] = {
    "load": _load,
    "unload": _unload,
    "request": _request,
    "window": streams.note_window,
    "leave": leaving.note_leave,
    "listening": _listening,
    "stream-end": streams.note_stream_end,
    "emergency": channel.note_emergency,
    "decision": _decision,
    "start": starts.note_start,
    "end": _end,
    "starve": patience.note_starve,
    "fail": endings.note_fail,
    "cancel": endings.note_cancel,
    "event": _event,
    "interrupt": extensions.note_interrupt,
    "halted": extensions.note_halted,
    "held": extensions.note_held,
    "substitute": extensions.note_substitute,
    "hold": _hold,
    "floor": floor.note_floor,
    "suspend": floor.note_suspend,
    "resume": floor.note_resume,
    "stop": floor.note_stop,
    "over": endings.note_over,
}
"""What each kind of record changes and may violate."""
