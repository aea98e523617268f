"""The floor: its holder, the ABs that it keeps waiting, and its records (F1 to F6, C2)."""

from __future__ import annotations

from prima.invariants.model import AB, LINKED, RUNNING, Record, Tree, base
from prima.invariants.turn import Turn


class FloorRules(Turn):
    """Rules F1 to F6, with the suspensions and stops that follow from them."""

    # Who may start ----------------------------------------------------------------

    def carries_floor(self, ab: AB) -> bool:
        """X5: whether the floor's stream does nothing but a motion that the AB can carry."""
        contending = self.floor[-1].contending() if self.floor else []
        return bool(contending) and all(
            ab.motion == "free" and self.composes(ab, other) and other.phase == RUNNING
            for other in contending
        )

    def refused_by_floor(self, ab: AB, surely: bool = False) -> Tree | None:
        """F2, X7: the stream that keeps, or may keep, the AB from starting."""
        return None if self.third_turn(ab) else self.kept_by_floor(ab, surely)

    def starts_aside(self, ab: AB) -> bool:
        """X7: whether it starts although another has the floor, without taking or ending it."""
        return self.third_turn(ab) and self.kept_by_floor(ab) is not None

    def kept_by_floor(self, ab: AB, surely: bool = False) -> Tree | None:
        """F2: the stream that keeps, or may keep, the AB from starting.

        F2 leaves "another event" open if the floor's stream goes on from one reaction to
        the next (O2, O3): an event other than the last certainly counts, one other than an
        earlier one perhaps. A reaction to an earlier one may start or wait.
        """
        holder = self.holder
        if holder is None or holder.app == ab.app:
            return None
        held = {holder.cause} if surely else holder.causes
        if ab.cause is not None and ab.cause not in held:
            return None
        high = any(one.high for one in ab.tree.meant(ab))
        contending = self._contending(holder)
        if contending and all(high and not other.high for other in contending):
            return None
        return None if self.carries_floor(ab) else holder

    def _contending(self, holder: Tree) -> list[AB]:
        """F2: the ABs of the floor's stream that keep others from starting."""
        members = holder.members.values()
        if any(one.inserted and self.refused_by_channel(one) for one in members):
            # A way back that K1 keeps counts as itself, so that the two do not wait for each other.
            return [one for one in members if one.contends]
        return holder.contending()

    def refused_by_topic(self, ab: AB) -> Tree | None:
        """F6: the stream that the AB would interrupt by speaking."""
        if "speaker" not in ab.devices or ab.cause is not None or self.holder is ab.tree:
            return None
        return None if self.third_turn(ab) else self._topic_kept(ab)

    def _topic_kept(self, ab: AB) -> Tree | None:
        for other in self.running.values():
            if self.keeps_topic(other, ab):
                return other.tree
        return None

    def kept_otherwise(self, ab: AB) -> bool:
        """Whether F2 or F6 would keep it waiting if not for X7."""
        if self.kept_by_floor(ab) is not None:
            return True
        speaks = "speaker" in ab.devices and self.holder is not ab.tree
        return speaks and self._topic_kept(ab) is not None

    def keeps_topic(self, other: AB, ab: AB) -> bool:
        """F6: whether a running AB is between two utterances of another application's topic."""
        between = other.phase == RUNNING and not other.feedback and other.unit is None
        return between and other.app != ab.app and other.tree.spoken and self._speaks_next(other)

    def _speaks_next(self, ab: AB) -> bool:
        """F6: whether a speaking AB is linked behind it, without a looping AB in between."""
        reached = [ab]
        for before in reached:  # the list grows
            for child in ab.tree.members.values():
                if child.phase != LINKED or before.name not in child.parents:
                    continue
                if "speaker" in child.devices:
                    return True
                if not child.feedback and child not in reached:
                    reached.append(child)
        return False

    # Who has it -------------------------------------------------------------------

    def take_floor(self, ab: AB, reaction: int | None) -> None:
        """F1: a reaction takes the floor. F3: so does an AB that needs the floor's devices."""
        tree, holder = ab.tree, self.holder
        if reaction is not None:
            tree.cause = reaction
            tree.causes.add(reaction)
        elif holder is None or holder.app == ab.app or not self._in_the_way(ab, holder):
            return
        self.give_floor(tree, "F1" if reaction is not None else "F3")

    def _in_the_way(self, ab: AB, holder: Tree) -> bool:
        """F3: whether a running or waiting AB of the floor's stream needs one of the devices."""
        own = [other for other in holder.members.values() if other.contends]
        return any(ab.devices & other.devices for other in (*own, *holder.contending()))

    def give_floor(self, tree: Tree, rule: str) -> None:
        """C2: the stream that takes the floor suspends others' streams, which rank alike (S2d)."""
        if self.holder is tree:
            return
        self.turned.append((tree.name, "taken", rule))
        if tree in self.floor:
            self.floor.remove(tree)
        self.floor.append(tree)
        for other in self.trees.values():
            if other.app != tree.app and other.started >= 0 and not other.suspended:
                other.suspended, other.rank = True, self.place + 1
                self.suspended_by[other.name] = tree.name

    def resume(self, ab: AB) -> None:
        """C2: a suspended stream resumes. It keeps its place until the instant is over (S2d)."""
        tree = ab.tree
        if tree.suspended:
            tree.suspended = False
            self.resumed.append(tree)
            if tree.waits:
                self.turns[tree.name].append(self.now)
            tree.waits = False
            named = self.resumptions.pop(tree.name, None)
            if named != ab.shown:
                self.report(
                    13, "C2", f"{tree.name} resumes by {ab.shown}; the records name {named}"
                )

    def waits_suspended(self, ab: AB) -> None:
        """C2: an application is notified that another's stream keeps its suspended one waiting."""
        by = ab.said[1] if ab.said is not None else ""
        other = by.replace("#", ":").partition(":")[0]
        if ab.tree.suspended and not ab.tree.waits and other not in ("", ab.app):
            ab.tree.waits = True
            self.turns[ab.tree.name].append(self.now)

    # What the records say -----------------------------------------------------------

    def note_floor(self, record: Record) -> None:
        """F3: the floor is a stack; only the named stream is pushed, or removed."""
        tree, recorded = record["tree"], list(record.get("floor") or ())
        rest = [name for name in self.recorded_floor if name != tree]
        if recorded != (rest if record["outcome"] == "returned" else [*rest, tree]):
            self.report(13, "F3", f"the floor is {recorded}, after {self.recorded_floor}")
        self.recorded_floor = recorded
        self.told_turns.append((tree, record["outcome"], record["rule"]))

    def note_suspend(self, record: Record) -> None:
        """A record says that a stream is suspended."""
        self.suspensions[record["tree"]] = record["by"]

    def note_resume(self, record: Record) -> None:
        """A record says that a stream is resumed."""
        self.resumptions[record["tree"]] = record["behavior"]

    def note_stop(self, record: Record) -> None:
        """A record says that an AB that moves the robot is stopped (F5)."""
        self.stops.add(base(record["behavior"]))

    def check_floor(self) -> None:
        """After a start, and at an instant's end: the records show all changes, and no others."""
        names = [tree.name for tree in self.floor]
        if names != self.recorded_floor:
            self.report(13, "F3", f"the floor is {names}; the records say {self.recorded_floor}")
            self.recorded_floor = names
        self._check_turns()
        for tree, by in self.suspended_by.items():
            named = self.suspensions.pop(tree, None)
            if named != by:
                self.report(13, "C2", f"{by} suspends {tree}; the records name {named}")
        for tree, by in self.suspensions.items():
            self.report(13, "C2", f"{tree} is not suspended by {by}, as a record says")
        for tree in sorted(self.resumptions):
            self.report(13, "C2", f"{tree} does not resume, as a record says")
        self.suspensions, self.suspended_by, self.resumptions = {}, {}, {}

    def _check_turns(self) -> None:
        """F1, F3, X3: which streams took the floor and gave it back, and by which rule.

        The stack shows their order; for several that end at once it is not defined.
        """
        if sorted(self.told_turns) != sorted(self.turned):
            text = f"the floor was {self.turned}; the records say {self.told_turns}"
            self.report(13, "F3", text)
        self.turned, self.told_turns = [], []

    # Stops --------------------------------------------------------------------------

    def stopped_rightly(self) -> None:
        """F5: a body that moved and gets no next loop is stopped; there are no other stops.

        In an emergency every device goes to its safe state anyway (E5).
        """
        if self.halted:
            return
        driven = self.driven or any(ab.drives for ab in self.running.values())
        due = set() if driven else set(self.halting)
        for name in sorted(due - self.stops):
            self.report(14, "F5", f"{name} is moved on by nobody and not stopped")
        for name in sorted(self.stops - due):
            self.report(14, "F5", f"{name} is stopped for no reason")
