"""Selection: once an instant, every waiting AB that may start is started (rules S, F, K)."""

from __future__ import annotations

from typing import Final

from prima.messages import Command, Group, Order
from prima.scheduler import rules
from prima.scheduler.behavior import RUNNING, WAITING, Behavior, Stream, application
from prima.scheduler.effects import Body
from prima.scheduler.intake import Maker, link
from prima.scheduler.memory import Memory
from prima.scheduler.patience import Patience
from prima.scheduler.recorder import Recorder
from prima.scheduler.rules import Rank, Refusal
from prima.scheduler.selection import Policy

STARVING_LOOPS: Final = 20
"""After how many loops of another's feedback Command a waiting AB is reported (E4)."""
COMPOSED = {"free", "faithful"}
"""The two kinds of motion that X5 composes."""
Ranked = tuple[Rank, Behavior]
"""A waiting AB behind its rank; no two ranks are equal, as they end with a serial number."""
Held = dict[str, Behavior]
"""Devices that waiting ABs hold back from those that they outrank, and which does (S3)."""


class Selector:
    """Starts ABs by a policy; knows working memory but nothing of requests or ends."""

    def __init__(
        self,
        memory: Memory,
        policy: Policy,
        maker: Maker,
        recorder: Recorder,
        bound: int | None,
        patience: int,
    ) -> None:
        self.memory = memory
        self.policy = policy
        self.recorder = recorder
        self.bound = bound
        self._preparing = policy.has("x1") or policy.has("x4")
        self._composing = policy.has("x5")
        self._yielding = policy.has("x2")
        self.orders: list[Order] = []
        self.started: list[Behavior] = []
        """What the latest selection started."""
        self.halting: dict[str, tuple[Behavior, list[Command], int]] = {}
        """Parts of interrupted units whose devices have still to tell how much was done: the unit,
        what of it had been finished, and of how many Commands it is."""
        self.body = Body()
        self._maker = maker
        self.turns: list[tuple[str, Stream]] = []
        """Streams that wait ``suspended`` or have ``resumed``, for their applications to hear."""
        self._resumed: list[Stream] = []
        """Streams that the latest selection let go on."""
        self._suspensions = 0
        self._starved = 0
        self.patience = Patience(memory, recorder, patience if policy.floor else 0)

    def select(self, now: int) -> None:
        """Start what may start, in the order of S2, until nothing more may."""
        self.started, self._resumed = [], []
        memory = self.memory
        self.patience.before(now)
        if memory.running:
            for unit in [ab for ab in memory.running.values() if ab.inner]:
                self._advance(unit, now)
        while memory.waiting and self._pass(now):
            pass
        for stream in self._resumed:
            if not stream.suspended:
                stream.place = 0
        self._note_turns()
        self.patience.after(now)

    def _note_turns(self) -> None:
        """C2: a suspended stream waits from when another application keeps an AB of it waiting."""
        for ab in self.memory.waiting.values():
            stream = ab.stream
            if not stream.suspended or stream.waits:
                continue
            if application(ab.blocked[1]) not in ("", ab.app.name):
                stream.waits = True
                self.turns.append(("suspended", stream))

    def _pass(self, now: int) -> bool:
        """Go through the waiting ABs once; true if another pass may find one that may start.

        All rank as they did in the beginning (S2), until a start changes that: it ends the pass.
        """
        if self._preparing:
            self._join_ways_back()
        ranked = self._ranked(self.memory.waiting, now)
        held: Held = {}
        before = len(self.started)
        for index, (rank, ab) in enumerate(ranked):
            refusal = self.policy.refusal(ab, self.memory)
            if refusal is None:
                if self._preparing and self._prepare(ab, now):
                    return True
                refusal = self._wait_for_devices(ab, held)
            if refusal is not None:
                self._hold(ab, refusal)
            elif self._start(rank, ab, ranked[index + 1 :], held, now):
                return True
        # A start may change whose stream is active, and so how reactions rank (S2b).
        return len(self.started) > before and any(
            ab.reaction is not None for ab in self.memory.waiting.values()
        )

    def _ranked(self, found: dict[str, Behavior], now: int) -> list[Ranked]:
        policy, memory = self.policy, self.memory
        ranked = ((policy.rank(ab, memory, now), ab) for ab in found.values())
        return sorted(ranked, key=lambda one: one[0])

    def _wait_for_devices(self, ab: Behavior, held: Held) -> Refusal | None:
        """S1, S3: what keeps a device from the AB, which holds its own back while it waits."""
        refusal = self._refused_by_devices(ab, held)
        if refusal is None:
            return None
        if self._yielding and refusal[0] == "S1" and self._give_way(ab, held):
            return None
        self._hold_back(ab, held)
        return refusal

    def _hold_back(self, ab: Behavior, held: Held) -> None:
        """S3: keep a waiting AB's devices from those that it outranks, if it is a reaction."""
        if self.policy.holds_back(ab):
            for device in ab.devices:
                held.setdefault(device, ab)

    def _refused_by_devices(self, ab: Behavior, held: Held) -> Refusal | None:
        """S1 and S3: a device is occupied, or held back for a reaction."""
        if not self.policy.exclusive:
            return None
        other = self._occupant(ab)
        if other is not None:
            return ("S1", other.id)
        for device in ab.in_order if held else ():
            if device in held:
                return ("S3", held[device].id)
        return None

    def _able(self, ranked: list[Ranked], held: Held) -> list[Ranked]:
        """Those of waiting ABs that nothing keeps from starting (S1, S3, F2, F6, K1)."""
        able, held = [], dict(held)
        for one in ranked:
            ab = one[1]
            if self.policy.refusal(ab, self.memory) is not None:
                continue
            if self._refused_by_devices(ab, held) is None:
                able.append(one)
            self._hold_back(ab, held)
        return able

    def _occupant(self, ab: Behavior) -> Behavior | None:
        """Who occupies one of the AB's devices, but for a motion to be composed with (X5)."""
        other = self.memory.conflict(ab)
        if other is None or not self._composing or not ab.motion:
            return other
        return next(iter(self._in_the_way(ab)), None)

    def _in_the_way(self, ab: Behavior) -> list[Behavior]:
        """All running ABs that have to end before this one may start."""
        return [
            other
            for other in self.memory.conflicts(ab)
            if not self._composing or {ab.motion, other.motion} != COMPOSED
        ]

    # Extensions -------------------------------------------------------------

    def _give_way(self, reaction: Behavior, held: Held) -> bool:
        """X2: interrupt what is restartable and in the way of a reaction; true if that frees all."""
        if reaction.reaction is None or any(device in held for device in reaction.devices):
            return False
        ways = self._in_the_way(reaction)
        if not all(yields(ab, reaction) for ab in ways):
            return False
        for ab in ways:
            self._interrupt(ab, reaction)
        return True

    def _interrupt(self, ab: Behavior, reaction: Behavior) -> None:
        self.recorder.behavior("interrupt", ab, rule="X2", by=reaction.id)
        self._remember_parts(ab)
        self._empty(ab)
        if ab.command is not None:
            self._stop_device(ab)
        ab.restarting = True
        self.memory.release(ab)
        self.memory.wait(ab)

    def _remember_parts(self, unit: Behavior) -> None:
        """What of a unit has been done, for the application when the device has told the rest."""
        if unit.group is None:
            return
        parts, left = list(unit.inner.values()), []
        while parts:
            part = parts.pop()
            parts += part.inner.values()
            left.append(part)
        pending = {id(part.command) for part in left if part.command is not None}
        pending |= {
            id(one) for part in left if part.group and not part.inner for one in leaves(part.group)
        }
        every = leaves(unit.group)
        finished = [command for command in every if id(command) not in pending]
        running = [p for p in left if p.state is RUNNING and p.command is not None]
        for part in sorted(
            running, key=lambda p: (p.command is None or not p.command.text, p.serial)
        )[:1]:
            self.halting[part.name] = (unit, finished, len(every))

    def _empty(self, unit: Behavior) -> None:
        """Take out what is in a unit that starts again from its beginning."""
        for inner in list(unit.inner.values()):
            self._empty(inner)
            if inner.state is RUNNING and inner.command is not None:
                self._stop_device(inner)
            self.recorder.behavior("cancel", inner, rule="X2", outcome=inner.state)
            self.memory.remove(inner)

    def _stop_device(self, ab: Behavior) -> None:
        self.orders.append(Order("interrupt", ab.id, ab.command, app=ab.app.name))

    def _prepare(self, ab: Behavior, now: int) -> bool:
        """X1, X4: put in what has to come first; true if something was put in."""
        if ab.inserted:
            return False
        if ab.stream.suspended and self.policy.has("x1") and way_back(ab.stream) is None:
            own = ab.type.effects if ab.type is not None else frozenset()
            commands = ab.stream.effects.missing(own, self.body)
            if self._insert(ab, commands, "X1", now):
                return True
        if ab.connect and self.policy.has("x4"):
            ab.connect = False
            return not self.memory.in_view and self._insert(ab, [Command("face-human")], "X4", now)
        return False

    def _insert(self, ab: Behavior, commands: list[Command], rule: str, now: int) -> bool:
        """Put Commands between an AB and what it follows, in its stream and in its place."""
        table = self._maker.table
        able = [one for one in commands if one.type in table and not table[one.type].substitute]
        before: Behavior | None = None
        for command in able:
            command.source = ab.command.source if ab.command else ""
            made = self._maker.behavior(ab.app, ab.stream, command, now, ab.document_state)
            made.inserted, made.requested, made.serial = rule, ab.requested, ab.serial
            if rule == "X4":  # the first word follows at once, so its devices are taken along
                made.use(made.devices | ab.devices)
            if before is None:
                made.parent, made.reaction, made.freed = ab.parent, ab.reaction, ab.freed
                ab.reaction = None
            else:
                link(before, made)
            self.memory.add(made)
            self.recorder.request(made, before=ab.id)
            before = made
        if before is None:
            return False
        self._put_behind(before, ab)
        return True

    def _put_behind(self, before: Behavior, ab: Behavior) -> None:
        link(before, ab)
        self.memory.unwait(ab)

    def _join_ways_back(self) -> None:
        """X1: whatever waits in a stream waits for the way back that is put in, if one is.

        What is wanted ``now`` does not: it waits for nothing of its own application (O2).
        """
        for ab in list(self.memory.waiting.values()):
            way = None if ab.inserted else way_back(ab.stream)
            urgent = ab.command is not None and ab.command.now
            if way is not None and not urgent:
                self._put_behind(way, ab)

    def _hold(self, ab: Behavior, refusal: Refusal) -> None:
        rule, by = refusal
        if ab.blocked == refusal:
            return
        before, ab.blocked = ab.blocked, refusal
        if before[0] == rule and before[1].partition(".")[0] == by.partition(".")[0]:
            return  # the next loop of the same feedback Command is no news
        self.recorder.hold(ab, rule, by)

    def _start(self, rank: Rank, ab: Behavior, lower: list[Ranked], held: Held, now: int) -> bool:
        """Start an AB and record why; true when others rank otherwise now.

        Args:
            rank: the AB's.
            ab: the AB.
            lower: those that rank below it.
            held: devices that those above it hold back.
            now: the instant.
        """
        policy, memory = self.policy, self.memory
        rivals = self._able(lower, held)
        composed = self._composing and rules.x5(ab, memory)
        why = self._admitted_by(ab, composed)
        reaction, ab.reaction = ab.reaction, None
        ab.reacted = -1 if reaction is None else reaction
        beside = composed or not rules.f3(ab, reaction is not None, memory)
        self._run(ab, now)
        changed = self._take_floor(ab, reaction, beside)
        losers = self._outdone(rivals, ab, lower, held)
        rule = policy.decided(rank, losers[0][0]) if losers and policy.exclusive else why
        self.recorder.decision(ab, rule, [loser.id for _, loser in losers])
        self.recorder.start(ab, rule, reaction)
        if ab.inner:
            self._advance(ab, now)
        if ab.feedback and ab.loop > 1:
            changed = self._count_starving(ab, now) or changed
        return changed or policy.turning

    def _outdone(
        self, rivals: list[Ranked], ab: Behavior, lower: list[Ranked], held: Held
    ) -> list[Ranked]:
        """Of those that could have started in an AB's place, those that cannot beside it."""
        if all(other.devices & ab.devices for _, other in rivals) and not self._composing:
            return rivals
        still = self._able(lower, held)
        return [one for one in rivals if one not in still]

    def _admitted_by(self, ab: Behavior, composed: bool) -> str:
        """The rule by which an AB may start with which nothing competes."""
        policy, holder = self.policy, self.memory.holder
        if not policy.exclusive:
            return "none"
        if composed:
            return "X5"
        if policy.floor and holder is not None and holder.app is not ab.app:
            return "F2"
        return "S4" if self.memory.running else "S1"

    def _run(self, ab: Behavior, now: int) -> None:
        """Let an AB run."""
        if not self.policy.exclusive:
            self._collide(ab)
        ab.blocked = ("", "")
        ab.waited_loops = 0
        if ab.waits_from >= 0 or ab.kept:
            self.patience.over(ab)
        ab.resumed = ab.loop > 0 and ab.freed != now
        if ab.feedback:
            ab.next_loop()
        self.started.append(ab)
        beside = self._composing and self.memory.conflict(ab) is not None
        first = ab.started < 0 or ab.restarting
        ab.resumed = ab.resumed or ab.restarting
        ab.restarting = False
        self.memory.start(ab, now)
        stream = ab.stream
        if ab.command is not None and "speaker" in ab.devices:
            stream.spoken = True
        if ab.engages:
            self.memory.engage(stream)
        if stream.suspended and ab.unit is None:
            self._resume(stream, ab)
        if ab.command is not None:
            order = Order(
                "start", ab.id, ab.command, ab.devices, ab.loop, ab.resumed, beside, ab.app.name
            )
            order.data = ab.since if ab.resumed else None
            self.orders.append(order)
        elif first and not ab.spans:
            self._open_group(ab, now)

    def _collide(self, ab: Behavior) -> None:
        """Without a mediator a later Command displaces an earlier one on its devices."""
        for device in ab.in_order:
            other = self.memory.occupied.get(device)
            if other is not None and other is not ab and other is not ab.unit:
                self.recorder.behavior("collision", other, rule="none", by=ab.id, device=device)

    def _take_floor(self, ab: Behavior, reaction: int | None, beside: bool) -> bool:
        """F1, F3: a reaction, or what starts by F2, takes the floor; the loser stays beneath."""
        stream = ab.stream
        if reaction is not None:
            stream.causes.add(reaction)
        floor = self.memory.floor
        if not self.policy.floor or (reaction is None and beside) or stream is self.memory.holder:
            return False
        if stream in floor:
            floor.remove(stream)
        self.take_floor(stream, "F1" if reaction is not None else "F3")
        return True

    def take_floor(self, stream: Stream, rule: str) -> None:
        """Put a stream on top of the floors; the others' streams are suspended (C2)."""
        floor = self.memory.floor
        floor.append(stream)
        self.recorder.stream(
            "floor", stream, rule, outcome="taken", floor=[held.name for held in floor]
        )
        self._suspend_others(stream)

    def _suspend_others(self, stream: Stream) -> None:
        """C2: suspend the others' streams that have begun; together, so that they rank alike."""
        begun = [
            other
            for other in self.memory.streams.values()
            if other.app is not stream.app and other.open and other.turn
        ]
        self._suspensions += 1
        for other in begun:
            if not other.suspended:
                other.suspended, other.place = True, self._suspensions
                self.recorder.stream("suspend", other, "C2", by=stream.name)

    def _resume(self, stream: Stream, ab: Behavior) -> None:
        """C2: a suspended stream goes on with an AB."""
        stream.suspended = False
        self._resumed.append(stream)
        if stream.waits:
            stream.waits = False
            self.turns.append(("resumed", stream))
        self.recorder.stream("resume", stream, "C2", behavior=ab.id)

    def _count_starving(self, ab: Behavior, now: int) -> bool:
        """E4: count the loops that other applications' equal ABs have waited.

        True if one has waited so long that it counts as a reaction from now on.
        """
        bounded: dict[str, Behavior] = {}
        for other in self.memory.waiting.values():
            if other.app is ab.app or other.priority != ab.priority or other.reaction is not None:
                continue
            other.waited_loops += 1
            if other.waited_loops == STARVING_LOOPS:
                self.recorder.add(
                    "starve",
                    "mediator",
                    app=other.app.name,
                    behavior=other.id,
                    rule="E4",
                    by=ab.id,
                    loop=STARVING_LOOPS,
                )
                other.starves = True  # it need not be told again
            if self.bound is not None and other.waited_loops >= self.bound:
                bounded[other.name] = other
        for _, other in self._ranked(bounded, now):
            self._starved += 1
            other.reaction = -self._starved
        return bool(bounded)

    # Units ------------------------------------------------------------------

    def _open_group(self, unit: Behavior, now: int) -> None:
        """U4: the Commands of a group become the unit's own ABs when it starts."""
        assert unit.group is not None
        made: list[Behavior] = []
        for step in unit.group.steps:
            ab = self._maker.behavior(
                unit.app, unit.stream, step.what, now, unit.document_state, None, unit
            )
            for index in step.after:
                ab.waits_for.add(made[index].name)
                ab.parent = made[index].id
                made[index].children.append(ab)
            made.append(ab)
            unit.inner[ab.name] = ab
            self.memory.add(ab)
            self.recorder.request(ab)

    def _advance(self, unit: Behavior, now: int) -> None:
        """Start the unit's own ABs in their order, where their devices are free (U4, U5)."""
        for ab in list(unit.inner.values()):
            if ab.state is WAITING and not (self.policy.exclusive and self.memory.conflict(ab)):
                reaction, ab.reaction = ab.reaction, None
                self._run(ab, now)
                self.recorder.start(ab, "U5" if unit.spans else "U4", reaction)
                if ab.inner:
                    self._advance(ab, now)


def way_back(stream: Stream) -> Behavior | None:
    """X1: the last part of the way back that was put in for a stream, while it is there."""
    members = reversed(stream.members.values())
    return next((one for one in members if one.inserted == "X1"), None)


def yields(ab: Behavior, reaction: Behavior) -> bool:
    """X2: whether a running AB gives way: to a reaction to a later event that it does not outrank."""
    later = reaction.reaction is not None and ab.reacted < reaction.reaction
    return ab.restartable and later and ab.priority <= reaction.priority


def leaves(group: Group) -> list[Command]:
    """The Commands of a unit, those of units inside it included, in their order."""
    found: list[Command] = []
    for step in group.steps:
        found += leaves(step.what) if isinstance(step.what, Group) else [step.what]
    return found
