"""Selection: what goes first (S2), what is held back (S3), and what need not wait (S1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from prima.invariants.channel import channel_kept, keeps_user, refused_by_channel
from prima.invariants.extensions import gives_way
from prima.invariants.floor import (
    carries_floor,
    keeps_topic,
    kept_otherwise,
    refused_by_floor,
    refused_by_topic,
    waits_suspended,
)
from prima.invariants.memory import Memory
from prima.invariants.model import AB, RUNNING, WAITING, Record, base
from prima.invariants.patience import its_turn, overdue
from prima.invariants.turn import refused_by_turn

RULES = ("S2a", "X7", "S2b", "E6", "S2c", "S2d", "S2e", "S2f")
MANY = 8
"""If more ABs wait, not all need to be checked."""


def active_app(memory: Memory) -> str | None:
    """S2b: the active stream's application: the floor's, else of the open one started last."""
    if memory.holder is not None:
        return memory.holder.app
    begun = [tree for tree in memory.trees.values() if tree.open and tree.started >= 0]
    return max(begun, key=lambda tree: tree.started).app if begun else None


def key(memory: Memory, ab: AB) -> tuple[Any, ...]:
    """S2a to S2f, then the order of requests."""
    reaction: tuple[int, int, bool] = (1, 0, False)
    if ab.cause is not None:
        reaction = (0, -ab.cause, ab.app != active_app(memory))
    return (
        not ab.high,
        not memory.third_turn(ab),
        reaction,
        not its_turn(memory, ab),
        ab.followed_at != memory.now,
        -ab.tree.rank,
        ab.requested,
        memory.apps.get(ab.app, 0),
        ab.place,
    )


def rule_between(memory: Memory, ab: AB, other: AB) -> str:
    """The first part of S2 in which two ABs differ."""
    pairs = zip(key(memory, ab), key(memory, other), strict=True)
    index = next((index for index, (one, two) in enumerate(pairs) if one != two), len(RULES))
    return RULES[index] if index < len(RULES) else "S2e"


def outranks(memory: Memory, ab: AB, other: AB) -> bool:
    """S2: whether the first goes before the second."""
    return key(memory, ab) < key(memory, other)


def competing(memory: Memory, ab: AB) -> list[AB]:
    """All other ABs that wait, outside units and not because of this one (X2), sorted by S2."""
    aside = [one for one, by, _ in memory.gave_way if by is ab]
    others = [
        one
        for one in memory.waiting.values()
        if one is not ab and one.unit is None and one not in aside
    ]
    return sorted(others, key=lambda one: key(memory, one))


def free_to_go(memory: Memory, ab: AB) -> bool:
    """Whether F2, F6, K1 and X7 are certain to let a waiting AB start."""
    kept = (
        refused_by_floor(memory, ab)
        or refused_by_topic(memory, ab)
        or refused_by_channel(memory, ab)
    )
    return kept is None and refused_by_turn(memory, ab) is None


def keeps_devices(memory: Memory, ab: AB) -> bool:
    """S3: whether it holds its devices back from lower-ranked ABs while it waits."""
    return ab.cause is not None or overdue(memory, ab) or memory.third_turn(ab)


def held_back(memory: Memory, ab: AB, winner: AB | None = None, surely: bool = True) -> bool:
    """S3: whether a reaction that outranks it needs one of its devices, and may start.

    When determining what could start instead of a winner, the winner holds nothing back.
    ``surely`` says how to read F2 for reactions for which it is open.
    """
    return any(
        other is not winner
        and keeps_devices(memory, other)
        and other.devices & ab.devices
        and outranks(memory, other, ab)
        and refused_by_turn(memory, other) is None
        and refused_by_floor(memory, other, surely) is None
        and refused_by_topic(memory, other) is None
        and refused_by_channel(memory, other) is None
        for other in competing(memory, ab)
    )


def could_start(memory: Memory, ab: AB, winner: AB, surely: bool = True) -> bool:
    """S1: whether nothing keeps a waiting AB from starting instead of another."""
    return kept_by_s3(memory, ab) and not held_back(memory, ab, winner, surely)


def kept_by_s3(memory: Memory, ab: AB) -> bool:
    """Whether nothing but S3 can keep a waiting AB from starting."""
    return not any(memory.occupants(ab)) and free_to_go(memory, ab)


def busy(memory: Memory, ab: AB) -> bool:
    """Whether a running AB occupies one of the devices, and keeps it (S1, U5, X2)."""
    return any(
        ab.devices & other.devices
        and other is not ab
        and not ab.inside(other)
        and not memory.composes(ab, other)
        and not gives_way(memory, other, ab)
        for other in memory.running.values()
    )


# At a start ---------------------------------------------------------------------


def allowed(memory: Memory, ab: AB, shown: str) -> None:
    """Invariants 5, 6, 7 and 12: no AB that could start instead outranks it."""
    holder = refused_by_floor(memory, ab, surely=True)
    if holder is not None:
        number = 7 if ab.leaves else 5
        memory.report(number, "F2", f"{shown} starts while {holder.name} holds the floor")
    turn = refused_by_turn(memory, ab)
    if turn is not None:
        memory.report(16, "X7", f"{shown} speaks between an answer and {turn.shown}")
    topic = refused_by_topic(memory, ab)
    if topic is not None:
        memory.report(5, "F6", f"{shown} speaks into the topic of {topic.name}")
    if ab.leaves:
        channel_kept(memory, ab, shown)
    for other in competing(memory, ab):
        if outranks(memory, other, ab) and free_to_go(memory, other):
            _passed_over(memory, other, ab, shown)


def _passed_over(memory: Memory, other: AB, ab: AB, shown: str) -> None:
    """S2, S3: ABs that outrank the starting one must be unable to start instead."""
    rule = rule_between(memory, other, ab)
    if keeps_devices(memory, other) and other.devices & ab.devices:
        # S3: it holds this device back whether or not its other devices are free.
        number = 5 if other.leaves else 6
        memory.report(number, "S3", f"{shown} starts before the reaction {other.shown}")
    elif could_start(memory, other, ab) and not _cleared_way(memory, other, ab):
        number = 5 if rule in ("S2a", "S2b") and other.devices & ab.devices else 12
        memory.report(number, rule, f"{shown} starts before {other.shown}, which outranks it")


def _cleared_way(memory: Memory, other: AB, ab: AB) -> bool:
    """X2: whether another could only start after what gave way to the starting one, not to it."""
    return any(
        by is ab and gone.devices & other.devices and not gives_way(memory, gone, other)
        for gone, by, _ in memory.gave_way
    )


def admitted_by(memory: Memory, ab: AB) -> str:
    """The rule by which an AB without competitors starts."""
    holder = memory.holder
    running = memory.running.values()
    if any(memory.composes(ab, one) and ab.devices & one.devices for one in running):
        return "X5"
    if carries_floor(memory, ab):
        return "X5"
    if memory.third_turn(ab) and kept_otherwise(memory, ab):
        return "X7"
    if holder is not None and holder.app != ab.app:
        return "F2"
    return "S4" if memory.running else "S1"


def started_by(memory: Memory, ab: AB, record: Record) -> None:
    """A start has the rule of its decision; inside a unit, without a decision, the unit's."""
    decision, shown = memory.decision, record["behavior"]
    if ab.unit is not None:
        expected = "U4" if ab.unit.name in memory.groups else "U5"
    elif decision is not None and decision["winner"] == shown:
        expected = decision["rule"]
    else:
        return  # a missing decision is found elsewhere
    if record["rule"] != expected:
        memory.report(13, "S1", f"{shown} starts by {expected}, not {record['rule']}")


def decided_rightly(memory: Memory, ab: AB, shown: str) -> None:
    """The ``decision`` before a start: its losers, and the rule that decided."""
    decision, memory.decision = memory.decision, None
    if decision is None or decision["winner"] != shown:
        memory.report(13, "S2", f"{shown} starts, but nobody has decided so")
        return
    rivals = [other for other in competing(memory, ab) if could_start(memory, other, ab)]
    needed = {  # those that cannot run beside it (S1)
        other.shown
        for other in rivals
        if other.devices & ab.devices and not memory.composes(ab, other)
    }
    _check_losers(memory, ab, shown, decision, needed)
    named = {*decision["losers"], *needed}
    rivals = [other for other in rivals if other.shown in named]
    readings = [one[0] for one in (rivals, _perhaps(memory, ab, decision["losers"])) if one]
    _check_rule(memory, ab, shown, decision["rule"], readings)


def _perhaps(memory: Memory, ab: AB, losers: Sequence[str]) -> list[AB]:
    """The losers of a decision to which F2 is open."""
    named = [other for other in competing(memory, ab) if other.shown in losers]
    return [other for other in named if could_start(memory, other, ab, surely=False)]


def _check_losers(memory: Memory, ab: AB, shown: str, decision: Record, needed: set[str]) -> None:
    """S2: the losers could have started; all are named, up to the limit."""
    losers, count = set(decision["losers"]), decision["losers_count"]
    allowed = {other.shown for other in competing(memory, ab) if kept_by_s3(memory, other)}
    if strangers := losers - allowed:
        text = f"{shown} is said to start before {sorted(strangers)}"
        memory.report(13, "S2", f"{text}, which could not have started")
    elif count <= MANY and (needed - losers or len(losers) != count):
        text = f"{shown} is said to start before {decision['losers']}"
        memory.report(13, "S2", f"{text}, {count}, not {sorted(needed)}")
    elif count > MANY and (len(losers) != MANY or not len(needed) <= count <= len(allowed)):
        memory.report(13, "S2", f"{shown} is said to start before {count}, not {len(needed)}")


def _check_rule(memory: Memory, ab: AB, shown: str, rule: str, readings: list[AB]) -> None:
    """S2: the rule decided between the winner and the first rival, by a reading of F2."""
    if not readings:
        expected = admitted_by(memory, ab)
        if rule != expected:
            memory.report(13, "S2", f"{shown} starts by {rule}, without losers, not {expected}")
    elif not any(_decides(memory, rule, ab, rival) for rival in readings):
        expected = rule_between(memory, ab, readings[0])
        text = f"{shown} starts before {readings[0].shown} by {expected}, not {rule}"
        memory.report(13, "S2", text)


def _decides(memory: Memory, rule: str, ab: AB, rival: AB) -> bool:
    """S2: whether it is the rule that decided between the two."""
    expected = rule_between(memory, ab, rival)
    alike = ("S2e", "S2f") if rival.app == ab.app else ()
    return rule == expected or {rule, expected} <= set(alike)


# At the end of an instant -------------------------------------------------------


def waits_rightly(memory: Memory, ab: AB) -> None:
    """Invariant 5: no waiting AB waits while it may start."""
    if ab.unit is not None:
        if ab.unit.phase == RUNNING and (memory.policy == "none" or not any(memory.occupants(ab))):
            memory.report(5, "U5", f"{ab.shown} waits in {ab.unit.shown} on free devices")
    elif memory.policy == "none":
        memory.report(5, "none", f"{ab.shown} waits, though nothing mediates")
    elif memory.prima:
        late(memory, ab)
        waits_suspended(memory, ab)
        if len(memory.waiting) <= MANY:
            _check_reason(memory, ab)
    elif not busy(memory, ab) and not any(
        _ahead(memory, one, ab) for one in memory.waiting.values()
    ):
        memory.report(5, memory.policy, f"{ab.shown} waits while its devices are free")


def late(memory: Memory, ab: AB) -> None:
    """Invariants 5 and 6: an AB that could start by now does not wait."""
    if free_to_go(memory, ab) and not held_back(memory, ab) and not busy(memory, ab):
        if not any(memory.occupants(ab)):
            memory.report(5, "S1", f"{ab.shown} waits while its devices are free")
        if ab.cause is not None and not ab.leaves:
            memory.report(6, "S1", f"the reaction {ab.shown} is late")


def _check_reason(memory: Memory, ab: AB) -> None:
    """An AB's latest ``hold`` says why it waits, and is true as long as it does."""
    if ab.said is None:
        if not ab.interrupted:  # its own record says it
            memory.report(13, "S1", f"nothing says why {ab.shown} waits")
        return
    rule, by, when = ab.said
    if not _held_by(memory, ab, rule, by):
        still = "" if when == memory.now else "still "
        memory.report(13, rule, f"{ab.shown} is {still}said to wait by {rule} for {by}")


def _held_by(memory: Memory, ab: AB, rule: str, by: str) -> bool:
    """Whether a reason for a wait is true."""
    if rule == "F2":
        kept = refused_by_floor(memory, ab, surely=False)
        return kept is not None and by == kept.name
    if rule == "K1":  # a stream other than the first that keeps it may be named
        tree = memory.trees.get(by)
        return ab.leaves and tree is not None and keeps_user(memory, tree, ab)
    other = memory.abs.get(base(by))
    return other is not None and _held_by_ab(memory, ab, rule, other)


def _held_by_ab(memory: Memory, ab: AB, rule: str, other: AB) -> bool:
    match rule:
        case "S1":
            return other.phase == RUNNING and bool(other.devices & ab.devices)
        case "S3":
            waits = other.phase == WAITING and keeps_devices(memory, other)
            return waits and bool(other.devices & ab.devices)
        case "X7":
            return other is refused_by_turn(memory, ab)
        case "F6":
            return keeps_topic(memory, other, ab)
    return False


def _ahead(memory: Memory, other: AB, ab: AB) -> bool:
    """Baselines: whether another waiting AB may rank first and hold back a device."""
    if other is ab or other.unit is not None or not other.devices & ab.devices:
        return False
    if memory.policy == "fair":
        return True  # the turn depends on more than these two
    if memory.policy == "fixed":
        top = memory.first or min(memory.apps, key=memory.apps.__getitem__)
        if (other.app == top) != (ab.app == top):
            return other.app == top
    return other.requested <= ab.requested


def note_hold(memory: Memory, record: Record) -> None:
    """A record says why an AB waits."""
    ab = memory.abs.get(base(record["behavior"]))
    if ab is None or ab.phase != WAITING:
        memory.report(13, "S1", f"{record['behavior']} is said to wait, but does not")
    elif ab.shown != record["behavior"]:
        memory.report(13, "S1", f"{record['behavior']} is said to wait, but {ab.shown} does")
    else:
        ab.said = (record["rule"], record.get("by") or "", memory.now)
