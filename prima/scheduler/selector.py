"""Selection: once an instant, every waiting AB that may start is started (rules S, F, K)."""

from __future__ import annotations

from typing import Final

from prima.messages import Command, Group, Order
from prima.scheduler.behavior import (
    RUNNING,
    WAITING,
    Application,
    Behavior,
    Line,
    Rank,
    Stream,
    of,
)
from prima.scheduler.chronicle import LOSERS_NAMED, Chronicle
from prima.scheduler.effects import Body
from prima.scheduler.intake import Maker, link
from prima.scheduler.memory import Memory
from prima.scheduler.selection import Policy, Refusal, composes_with_floor, outranks

STARVING_LOOPS: Final = 20
"""After how many loops of another's feedback Command a waiting AB is reported (E4)."""
FEW = 8
"""So many waiting ABs are all looked at; each that may not start is recorded with the reason."""
EVERYBODY: Final = "everybody"
NOBODY: Final = "nobody"
COMPOSED = {"free", "faithful"}
"""The two kinds of motion that X5 composes."""


Losers = tuple[list[Rank], int]
"""The first of those whom a winner keeps waiting, by rank, and how many there are."""


class Selector:
    """Starts ABs by a policy; knows working memory but nothing of requests or ends."""

    def __init__(
        self, memory: Memory, policy: Policy, maker: Maker, chronicle: Chronicle, bound: int | None
    ) -> None:
        self.memory = memory
        self.policy = policy
        self.chronicle = chronicle
        self.bound = bound
        self.few = FEW
        # Of the policy, what is asked for every AB that is looked at.
        self._lining = policy.lined
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
        self.in_view = False
        """Whether the camera sees the user, as far as it has told (V4)."""
        self._maker = maker
        self._resumed: list[Stream] = []
        """Streams that have resumed in this pass, whose other ABs rank otherwise afterwards."""
        self._suspensions = 0
        self._turns = 0
        self._starved = 0

    def select(self, now: int) -> None:
        """Start what may start, in the order of S2, until nothing more may."""
        self.started = []
        memory = self.memory
        memory.waiting.settle(now)
        if memory.running:
            for unit in [ab for ab in memory.running.values() if ab.inner]:
                self._advance(unit, now)
        more = True
        while more and memory.waiting.all:
            more = self._pass(now)
            if self._resumed:
                for stream in self._resumed:
                    memory.rank_anew(stream)
                self._resumed.clear()

    def _pass(self, now: int) -> bool:
        """Go through the waiting ABs once; true when what ranks them changed on the way.

        Until then all stand where they stood in the beginning (S2).
        """
        memory, policy = self.memory, self.policy
        many = self._lining and len(memory.waiting.all) > self.few
        candidates = self._ranked(memory.waiting.apart if many else memory.waiting.all, now)
        if many:
            self._add_firsts(candidates)
        held: dict[str, Behavior] = {}
        index = 0
        while index < len(candidates):
            rank = candidates[index]
            ab = of(rank)
            index += 1
            refusal = policy.refusal(ab, memory)
            if refusal is None:
                if self._preparing and self._prepare(ab, now):
                    return True
                refusal = self._refused_by_devices(ab, held)
                if refusal is not None and policy.holds_back(ab):
                    for device in ab.devices:
                        held.setdefault(device, ab)
            if refusal is None:
                engaging = ab.engages and not ab.stream.engaged
                if self._start(ab, rank, candidates, index, now, many):
                    return True
                if many and engaging:  # others of a line may be the first that may start (K1)
                    candidates = [one for one in candidates if of(one).name in memory.waiting.apart]
                    self._add_firsts(candidates)
                    index, held = 0, {}
            elif ab.blocked != refusal:
                self._hold(ab, refusal)
        return False

    def _add_firsts(self, found: list[Rank]) -> None:
        """Of many waiting ABs those that may be the next, in the order of S2 (S1-S3, F, K).

        In a line all need the same devices: whoever comes after the first that F2 and K1
        let start has to wait for that one's.

        Args:
            found: those that stand in no line; the others come in among them.
        """
        waiting = self.memory.waiting
        few = len(waiting.all) <= self.few  # since this pass has begun
        for line in waiting.lines.values():
            let = EVERYBODY if few else self._let(line)
            if isinstance(let, Application):
                found += [ab.rank for ab in let.members.values() if ab.rank and ab.line is line]
            elif let is EVERYBODY:
                if line.devices and not few:
                    found.append(line.ranks[0])
                else:
                    found += line.ranks
        found.sort()

    def _ranked(self, found: dict[str, Behavior], now: int) -> list[Rank]:
        policy, memory = self.policy, self.memory
        ranked = [policy.rank(ab, memory, now) for ab in found.values()]
        if len(ranked) > 1:
            ranked.sort()  # no two ranks are equal: they end with the serial number
        return ranked

    def _let(self, line: Line) -> Application | str:
        """Whose ABs of a line F2 and K1 let start: everybody's, one application's, nobody's."""
        holder = self.memory.holder
        allowed: Application | str = EVERYBODY
        if holder is not None and not outranks(line.priority, holder):
            allowed = holder.app
        if line.leaves:
            for stream in self.memory.engaged.values():
                if stream.engages_user():
                    if allowed not in (EVERYBODY, stream.app):
                        return NOBODY
                    allowed = stream.app
        return allowed

    def _behind(self, line: Line, winner: Behavior, rank: Rank) -> Losers:
        """Those of a line who rank below a winner that is gone from it, and must wait."""
        let: Application | str = NOBODY
        mine, its = line.devices, winner.devices
        if not mine or (mine is not its and mine.isdisjoint(its)):
            let = self._let(line)
            if let is EVERYBODY:
                return [], 0
        ranks, start = line.ranks, line.below(rank)
        if not isinstance(let, Application):
            return ranks[start : start + LOSERS_NAMED], len(ranks) - start
        behind = [other for other in ranks[start:] if of(other).app is not let]
        return behind[:LOSERS_NAMED], len(behind)

    def _refused_by_devices(self, ab: Behavior, held: dict[str, Behavior]) -> Refusal | None:
        """S1 and S3: a device is occupied, or held back for a reaction."""
        if not self.policy.exclusive:
            return None
        other = self._occupant(ab)
        if other is None and not held:
            return None
        kept = next((device for device in ab.in_order if device in held), "") if held else ""
        if self._yielding and other is not None and not kept and self._give_way(ab):
            other = self._occupant(ab)
        if other is not None:
            return ("S1", other.id)
        return ("S3", held[kept].id) if kept else None

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

    def _give_way(self, reaction: Behavior) -> bool:
        """X2: interrupt what is restartable and in the way of a reaction; true if that frees all."""
        if reaction.reaction is None:
            return False
        ways = self._in_the_way(reaction)
        if not all(yields(ab, reaction) for ab in ways):
            return False
        for ab in ways:
            self._interrupt(ab, reaction)
        return True

    def _interrupt(self, ab: Behavior, reaction: Behavior) -> None:
        self.chronicle.behavior("interrupt", ab, rule="X2", by=reaction.id)
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
            self.chronicle.behavior("cancel", inner, rule="X2", outcome=inner.state)
            self.memory.remove(inner)

    def _stop_device(self, ab: Behavior) -> None:
        self.orders.append(Order("interrupt", ab.id, ab.command, app=ab.app.name))

    def _prepare(self, ab: Behavior, now: int) -> bool:
        """X1, X4: put in what has to come first; true if something was put in."""
        if ab.inserted:
            return False
        on_its_way = any(one.inserted == "X1" for one in ab.stream.members.values())
        if ab.stream.suspended is not None and self.policy.has("x1") and not on_its_way:
            own = ab.type.effects if ab.type is not None else frozenset()
            commands = ab.stream.effects.missing(own, self.body)
            if self._insert(ab, commands, "X1", now):
                return True
        if ab.connect and self.policy.has("x4"):
            ab.connect = False
            return not self.in_view and self._insert(ab, [Command("face-human")], "X4", now)
        return False

    def _insert(self, ab: Behavior, commands: list[Command], rule: str, now: int) -> bool:
        """Put Commands between an AB and what it follows, in its stream and in its place."""
        table = self._maker.table
        able = [one for one in commands if one.type in table and not table[one.type].substitute]
        before: Behavior | None = None
        for command in able:
            command.source = ab.command.source if ab.command else ""
            made = self._maker.behavior(ab.app, ab.stream, command, now, ab.document_state)
            made.inserted, made.requested = rule, ab.requested
            if rule == "X4":  # the first word follows at once, so its devices are taken along
                made.use(made.devices | ab.devices)
            if before is None:
                made.parent, made.reaction, made.freed = ab.parent, ab.reaction, ab.freed
                ab.reaction = None
            else:
                link(before, made)
            self.memory.add(made)
            self.chronicle.request(made, before=ab.id)
            before = made
        if before is None:
            return False
        behind = [ab]
        if rule == "X1":  # other branches of the stream wait for the same way back
            behind += [one for one in ab.stream.contending() if one.name in self.memory.waiting]
        for one in dict.fromkeys(behind):
            if not one.inserted:
                link(before, one)
                self.memory.unwait(one)
        return True

    def _hold(self, ab: Behavior, refusal: Refusal) -> None:
        rule, by = refusal
        changed = ab.blocked[0] != rule or "." not in by
        ab.blocked = refusal
        if changed:  # the next loop of the same feedback Command is no news
            self.chronicle.hold(ab, rule, by)

    def _start(
        self,
        ab: Behavior,
        rank: Rank,
        candidates: list[Rank],
        index: int,
        now: int,
        many: bool,
    ) -> bool:
        """Start an AB and record why; true when others rank otherwise now.

        Args:
            ab: the AB.
            rank: where it stands.
            candidates: those that are looked at.
            index: where among them those begin that rank below it.
            now: the instant.
            many: whether so many wait that not each of them is looked at.
        """
        memory, policy = self.memory, self.policy
        holder = memory.holder
        composed = self._composing and composes_with_floor(ab, memory)
        by_floor_rule = holder is not None and holder.app is not ab.app and not composed
        others = bool(memory.running)
        # Where the floor changes, all others are suspended: then each is looked at anyway.
        waiting = memory.waiting
        lined = many and ab.reaction is None and not by_floor_rule
        # What is ranked by the lines alone is left to them,
        lower = [
            candidates[place]
            for place in range(index, len(candidates))
            if not many or of(candidates[place]).line is None
        ]
        if many and not lined:  # or looked for now
            for line in waiting.lines.values():
                behind = line.ranks[line.below(rank) :]
                lower += [other for other in behind if of(other) is not ab]
            lower.sort()
        reaction, ab.reaction = ab.reaction, None
        ab.reacted = -1 if reaction is None else reaction
        changed = False
        self._run(ab, now)
        if reaction is not None or by_floor_rule:
            changed = self._take_floor(ab, reaction, by_floor_rule)
        losers = [
            other
            for other in lower
            if of(other).devices & ab.devices or policy.refusal(of(other), memory)
        ]
        # Of several reactions that the floor would let in, it is their rank that decided.
        rivals = reaction is not None and any(of(other).reaction for other in losers)
        count = len(losers)
        if lined:
            for line in waiting.lines.values():
                firsts, more = self._behind(line, ab, rank)
                losers = losers + firsts if losers else firsts
                count += more
            if lower or len(waiting.lines) > 1:
                losers.sort()
        if not policy.exclusive:
            rule = "none"
        elif composed:
            rule = "X5"
        elif by_floor_rule and policy.floor and not rivals:
            rule = "F2"
        elif losers:
            rule = policy.decided(rank, losers[0])
        else:
            rule = "S4" if others else "S1"
        self.chronicle.decision(ab, rule, losers, count)
        self.chronicle.start(ab, rule, reaction)
        if ab.inner:
            self._advance(ab, now)
        if ab.feedback and ab.loop > 1:
            changed = self._count_starving(ab, now) or changed
        return changed or policy.turning

    def _run(self, ab: Behavior, now: int) -> None:
        """Let an AB run."""
        if not self.policy.exclusive:
            self._collide(ab)
        self._turns += 1
        ab.app.last_turn = self._turns
        ab.blocked = ("", "")
        ab.waited_loops = 0
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
        if ab.engages:
            self.memory.engage(stream)
        if stream.suspended is not None and ab.unit is None:
            stream.suspended = None
            self._resumed.append(stream)
            self.chronicle.stream("resume", stream, "C2", behavior=ab.id)
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
                self.chronicle.behavior("collision", other, rule="none", by=ab.id, device=device)

    def _take_floor(self, ab: Behavior, reaction: int | None, by_floor_rule: bool) -> bool:
        """F1, F3: a reaction, or what started by F2, takes the floor; the loser stays beneath."""
        stream = ab.stream
        if reaction is not None:
            stream.causes.add(reaction)
        if not self.policy.floor:
            return False
        floor = self.memory.floor
        if floor and floor[-1] is stream:
            return False
        if stream in floor:
            floor.remove(stream)
        self.take_floor(stream, "F1" if reaction is not None else "F3")
        return True

    def take_floor(self, stream: Stream, rule: str) -> None:
        """Put a stream on top of the floors; the others' streams are suspended (C2)."""
        floor = self.memory.floor
        floor.append(stream)
        self.chronicle.stream(
            "floor", stream, rule, outcome="taken", floor=[held.name for held in floor]
        )
        self._suspend_others(stream)

    def _suspend_others(self, stream: Stream) -> None:
        for other in self.memory.streams.values():
            if other.app is not stream.app and other.open and other.suspended is None:
                self._suspensions += 1
                other.suspended = self._suspensions
                self.memory.rank_anew(other)
                self.chronicle.stream("suspend", other, "C2", by=stream.name)

    def _count_starving(self, ab: Behavior, now: int) -> bool:
        """E4: count the loops that other applications' equal ABs have waited.

        True if one has waited so long that it counts as a reaction from now on.
        """
        bounded: dict[str, Behavior] = {}
        for other in self.memory.waiting:
            if other.app is ab.app or other.priority != ab.priority or other.reaction is not None:
                continue
            other.waited_loops += 1
            if other.waited_loops == STARVING_LOOPS:
                self.chronicle.add(
                    "starve",
                    "mediator",
                    app=other.app.name,
                    behavior=other.id,
                    rule="E4",
                    by=ab.id,
                    loop=STARVING_LOOPS,
                )
            if self.bound is not None and other.waited_loops >= self.bound:
                bounded[other.name] = other
        for rank in self._ranked(bounded, now):
            other = of(rank)
            self._starved += 1
            other.reaction = -self._starved
            self.memory.waiting.moved(other)
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
            self.chronicle.request(ab)

    def _advance(self, unit: Behavior, now: int) -> None:
        """Start the unit's own ABs in their order, where their devices are free (U4, U5)."""
        for ab in list(unit.inner.values()):
            if ab.state is WAITING and not (self.policy.exclusive and self.memory.conflict(ab)):
                reaction, ab.reaction = ab.reaction, None
                self._run(ab, now)
                self.chronicle.start(ab, "U5" if unit.spans else "U4", reaction)
                if ab.inner:
                    self._advance(ab, now)


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
