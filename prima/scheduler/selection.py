"""Selection: once an instant, every waiting AB that may start is started (rules S, F, K)."""

from __future__ import annotations

from prima.messages import Order
from prima.scheduler import rules
from prima.scheduler.behavior import WAITING, Behavior, Wait
from prima.scheduler.interruption import Held, x2
from prima.scheduler.mediation import Mediation
from prima.scheduler.policy import Ranked
from prima.scheduler.preparation import join_first, note_resumed, prepare, wanted_now
from prima.scheduler.rules import Rank, Refusal
from prima.scheduler.starvation import count_waits, e4, note_waits
from prima.scheduler.streams import f1, note_turns, resume
from prima.scheduler.thirdturn import goes_before, owe

COMPOSED = {"free", "faithful"}
"""The two kinds of motion that X5 composes."""


def select(mediation: Mediation) -> None:
    """Start the ABs that may start, in the order of S2, until none is left."""
    mediation.started, mediation.resumed = [], []
    memory = mediation.memory
    count_waits(mediation)
    owe(mediation)
    for ab in [*memory.running.values()]:
        advance(mediation, ab)
    while s4(mediation):
        pass
    note_turns(mediation)
    note_waits(mediation)


def s4(mediation: Mediation) -> bool:
    """S2, S4: go through the waiting ABs once; whether another pass may find more to start.

    The ranks are those at the beginning (S2); a start that changes them ends the pass.
    """
    policy, memory = mediation.policy, mediation.memory
    join_first(mediation)
    ranked = policy.ranked(memory.waiting.values(), memory, mediation.now)
    held: Held = {}
    before = len(mediation.started)
    for index, (rank, ab) in enumerate(ranked):
        refusal = policy.refusal(ab, memory)
        if refusal is None:
            if prepare(mediation, ab):
                return True
            refusal = _wait_for_devices(mediation, ab, held)
        if refusal is not None:
            _hold(mediation, ab, refusal)
        elif _start(mediation, rank, ab, ranked[index + 1 :], held):
            return True
    return len(mediation.started) > before


# Devices ------------------------------------------------------------------------------------------


def _wait_for_devices(mediation: Mediation, ab: Behavior, held: Held) -> Refusal | None:
    """S1, S3: what keeps a device from the AB, which holds its devices back while it waits."""
    refusal = s1(mediation, ab) or s3(mediation, ab, held)
    if refusal is None:
        return None
    if "x2" in mediation.policy.extensions and x2(mediation, ab, in_the_way(mediation, ab), held):
        return None
    _hold_back(mediation, ab, held)
    return refusal


def s1(mediation: Mediation, ab: Behavior) -> Refusal | None:
    """S1: a running AB, except a motion to be composed with (X5), occupies one of the devices."""
    if not mediation.policy.exclusive:
        return None
    other = mediation.memory.conflict(ab)
    if ab.motion:
        other = next(iter(in_the_way(mediation, ab)), None)
    return None if other is None else ("S1", other.id)


def s3(mediation: Mediation, ab: Behavior, held: Held) -> Refusal | None:
    """S3: a device is held back for a reaction."""
    return next((("S3", held[device].id) for device in ab.in_order if device in held), None)


def _hold_back(mediation: Mediation, ab: Behavior, held: Held) -> None:
    """S3: keep a waiting AB's devices from those that it outranks, if it is a reaction."""
    if mediation.policy.holds_back(ab, mediation.memory):
        for device in ab.devices:
            held.setdefault(device, ab)


def in_the_way(mediation: Mediation, ab: Behavior) -> list[Behavior]:
    """X5: all running ABs that have to end before this one may start."""
    conflicts = mediation.memory.conflicts(ab)
    return [other for other in conflicts if {ab.motion, other.motion} != COMPOSED]


def able(mediation: Mediation, ranked: list[Ranked], held: Held) -> list[Ranked]:
    """The waiting ABs that nothing keeps from starting (S1, S3, F2, F6, K1)."""
    found, held = [], dict(held)
    for one in ranked:
        ab = one[1]
        if mediation.policy.refusal(ab, mediation.memory) is not None:
            continue
        if s1(mediation, ab) is None and s3(mediation, ab, held) is None:
            found.append(one)
        _hold_back(mediation, ab, held)
    return found


def _hold(mediation: Mediation, ab: Behavior, refusal: Refusal) -> None:
    """Record why a waiting AB may not start, if the reason has changed."""
    rule, by = refusal
    before, ab.wait.blocked = ab.wait.blocked, refusal
    # The next loop of the same feedback Command is the same reason.
    if (before[0], before[1].partition(".")[0]) != (rule, by.partition(".")[0]):
        mediation.recorder.hold(ab, rule, by)


# Starting -----------------------------------------------------------------------------------------


def _start(mediation: Mediation, rank: Rank, ab: Behavior, lower: list[Ranked], held: Held) -> bool:
    """Start an AB and record why; whether the ranks of others have changed.

    Args:
        mediation: what is shared.
        rank: the AB's.
        ab: the AB.
        lower: the ABs that rank below it.
        held: the devices that ABs above it hold back.
    """
    policy, memory = mediation.policy, mediation.memory
    active = memory.active
    rivals = able(mediation, lower, held)
    composed = rules.x5(ab, memory)
    why = _admitted_by(mediation, ab, composed)
    reaction, ab.reaction, ab.stale = ab.reaction, None, None
    ab.reacted = goes_before(ab, reaction, memory)
    aside = rules.aside(ab, memory)
    response, begins = rules.third_turn(ab, memory), wanted_now(ab)
    acknowledges = rules.acknowledges(ab, mediation.now)
    beside = composed or aside or not rules.f3(ab, memory)
    run(mediation, ab, not aside)
    changed = f1(mediation, ab, reaction, beside)
    note_resumed(mediation, ab, response, begins)
    losers = _outdone(mediation, rivals, ab, lower, held)
    rule = policy.decided(rank, losers[0][0]) if losers else why
    mediation.recorder.decision(ab, rule, [loser.id for _, loser in losers])
    mediation.recorder.start(ab, rule, reaction)
    advance(mediation, ab)
    # The active application ranks reactions to one event (S2b), a word after an answer who is overdue.
    changed = changed or memory.active is not active or acknowledges
    return e4(mediation, ab) or changed or policy.turning


def _outdone(
    mediation: Mediation, rivals: list[Ranked], ab: Behavior, lower: list[Ranked], held: Held
) -> list[Ranked]:
    """The ABs that could have started instead of an AB and cannot start beside it."""
    still = {other.name for _, other in able(mediation, lower, held)}
    return [one for one in rivals if one[1].name not in still]


def _admitted_by(mediation: Mediation, ab: Behavior, composed: bool) -> str:
    """The rule by which an AB without competitors may start."""
    policy, holder = mediation.policy, mediation.memory.holder
    if not policy.exclusive:
        return "none"
    if composed or mediation.memory.conflict(ab) is not None:
        return "X5"
    if rules.third_turn(ab, mediation.memory) and rules.refusal(ab, mediation.memory) is not None:
        return "X7"
    if holder is not None and holder.app is not ab.app:
        return "F2"
    return "S4" if mediation.memory.running else "S1"


def run(mediation: Mediation, ab: Behavior, resumes: bool) -> None:
    """Run an AB; if it ``resumes``, so does its stream (C2)."""
    memory, now = mediation.memory, mediation.now
    ab.resumed = ab.restarting or (ab.loop > 0 and ab.freed != now)
    ab.begun, ab.restarting = True, False
    ab.wait.end()
    ab.wait = Wait()
    if ab.run is not None:
        ab.run.begun = True
    if ab.feedback:
        ab.next_loop()
    if not mediation.policy.exclusive:
        _collide(mediation, ab)
    mediation.started.append(ab)
    beside = mediation.policy.exclusive and memory.conflict(ab) is not None
    memory.start(ab)
    _note_start(mediation, ab, resumes)
    if ab.command is not None:
        order = Order(
            "start", ab.id, ab.command, ab.devices, ab.loop, ab.resumed, beside, ab.app.name
        )
        order.data = ab.since if ab.resumed else None
        mediation.orders.append(order)
    else:
        u4(mediation, ab)


def _note_start(mediation: Mediation, ab: Behavior, resumes: bool) -> None:
    """F6, K1, C2, X4: what an AB's start changes for itself and its stream."""
    stream = ab.stream
    ab.connect = False  # its first word is said, though X7 may have let it start before the turn
    if ab.command is not None and ab.says:
        stream.spoken = True
    if ab.engages:
        mediation.memory.engaged[stream.name] = stream
    if ab is mediation.memory.owed:
        mediation.memory.owed = None
    if stream.suspended and resumes:
        resume(mediation, stream, ab)


def _collide(mediation: Mediation, ab: Behavior) -> None:
    """Without a mediator a later Command displaces an earlier one on its devices."""
    for device in ab.in_order:
        other = mediation.memory.occupied.get(device)
        if other is not None and other is not ab.unit:
            mediation.recorder.behavior("collision", other, rule="none", by=ab.id, device=device)


def f5(mediation: Mediation) -> None:
    """F5: stop the body if no further loop follows, unless something else takes the wheels."""
    ab, mediation.rolling = mediation.rolling, None
    if ab is not None and mediation.memory.using("locomotion") is None:
        mediation.order("stop", ab)
        mediation.recorder.behavior("stop", ab, rule="F5")


# Units --------------------------------------------------------------------------------------------


def u4(mediation: Mediation, unit: Behavior) -> None:
    """U4: the Commands of a group become the unit's own ABs when it starts.

    A unit that an emergency stop has halted goes on with what is left of it (E5).
    """
    if unit.inner:
        return
    assert unit.group is not None and unit.inside is not None
    steps, now, state = unit.group.steps, mediation.now, unit.document_state
    for ab in mediation.maker.chain(unit.app, unit.stream, steps, now, state, None, unit):
        unit.inside.members[ab.name] = ab
        mediation.memory.add(ab)
        mediation.recorder.request(ab)


def advance(mediation: Mediation, unit: Behavior) -> None:
    """U4, U5: start a unit's own ABs in their order as far as their devices are free."""
    for ab in list(unit.inner.values()):
        occupied = mediation.policy.exclusive and mediation.memory.conflict(ab) is not None
        if ab.state is WAITING and not occupied:
            reaction, ab.reaction = ab.reaction, None
            run(mediation, ab, resumes=False)
            mediation.recorder.start(ab, "U5" if unit.spans else "U4", reaction)
            advance(mediation, ab)
