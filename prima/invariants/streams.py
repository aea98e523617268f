"""Streams: when they end (C1), and to which of them a request belongs (O1, O2, O3, C3)."""

from __future__ import annotations

from prima.invariants.extensions import Extensions
from prima.invariants.model import AB, GONE, LINKED, RUNNING, WAITING, Cut, Record, Tree

A_MOMENT_LATER = 1
"""Milliseconds after a selection within which an application is notified of it."""


class Streams(Extensions):
    """Checks the stream that a request continues, and the AB that it follows."""

    def note_window(self, record: Record) -> None:
        """C3: a window opens or closes."""
        tree = self.trees.get(record["tree"])
        if tree is None:
            self.report(3, "C1", f"a window of {record['tree']} opens, which has ended")
            tree = self.trees[record["tree"]] = Tree(record["tree"], record["app"])
        if record["outcome"] == "open":
            self._open_window(tree)
        elif tree in self.windows:
            tree.windows -= 1
            self.windows.remove(tree)
        else:
            self.report(15, "C3", f"a window of {tree.name} closes, which is not open")

    def _open_window(self, tree: Tree) -> None:
        """C3: a window opens for an end with a notice, or when a stream waits or resumes (C2)."""
        if self.windows:
            self.report(15, "C3", f"a window of {tree.name} opens within another")
        if self.owed[tree.name]:
            self.owed[tree.name] -= 1
        turned = [at for at in self.turns[tree.name] if self.now - at <= A_MOMENT_LATER]
        if self.heard[tree.name] > 0:
            self.heard[tree.name] -= 1
        elif not turned:
            self.report(15, "O3", f"a window of {tree.name} opens, but no end is heard")
        else:
            turned.pop()
        self.turns[tree.name] = turned
        tree.windows += 1
        self.windows.append(tree)

    def check_windows(self) -> None:
        """C3 at the end of an instant: all windows are closed; each end with a notice had one."""
        for tree in self.windows:
            self.report(15, "C3", f"a window of {tree.name} is not closed")
        for name in sorted(+self.owed):
            if name.rpartition(":")[0] not in self.gone_apps:
                self.report(15, "C3", f"an end of {name} is heard, but no window opens")

    def note_stream_end(self, record: Record) -> None:
        """C1: a stream ends without ABs; its end is recorded when it happens, and once."""
        self.told_ends.add(record["tree"])
        tree = self.trees.get(record["tree"])
        if tree is None:
            return
        if tree.until is not None:
            self.report(10, "X3", f"{tree.name} ends, but is held until {tree.until} ms")
            tree.until = None
        for ab in list(tree.members.values()):
            self.report(3, "C1", f"{ab.shown} is {ab.phase}, but its tree has ended: it is lost")
            self.remove(ab)

    def check_ends(self) -> None:
        """C1 at the end of an instant."""
        for name in sorted(self.ended_trees ^ self.told_ends):
            ended = "not recorded" if name in self.ended_trees else "recorded, but it has not ended"
            self.report(13, "C1", f"the end of {name} is {ended}")

    def window_of(self, app: str) -> Tree | None:
        """The application's current window."""
        return next((tree for tree in reversed(self.windows) if tree.app == app), None)

    def placed_rightly(self, ab: AB, new: bool) -> None:
        """O1, O2, C3: the stream that a request belongs to, and what it follows."""
        for name in sorted(ab.parents):
            if self.abs[name].tree is not ab.tree:
                self.report(15, "U3", f"{ab.name} of {ab.tree.name} follows {name} of another")
        if ab.inserted:
            return
        if ab.unit is not None:
            if ab.unit.tree is not ab.tree:
                self.report(15, "U5", f"{ab.name} is not of the stream of its unit")
            return
        if any(one is ab for one, _ in self.urgent):
            self._urgent_placed(ab)
        elif ab.cause is not None:
            self._reaction_placed(ab, new)
        elif (window := self.window_of(ab.app)) is not None:
            if ab.tree is not window and not self._goes_on_here(ab):
                text = f"{ab.name} is of {ab.tree.name}, but asked for in a window of {window.name}"
                self.report(15, "C3", text)
        else:
            self._follows_rightly(ab, new)

    def _goes_on_here(self, ab: AB) -> bool:
        """Whether it follows in that tree: in its own request, one with ``now``, or a hold (X3)."""
        follows = any(self.abs[name].requested == self.now for name in ab.parents)
        urgent = any(one.tree is ab.tree for one, _ in self.urgent)
        return follows or urgent or self.joined_now(ab.tree)

    def _urgent_placed(self, ab: AB) -> None:
        """O2: it is never linked, and continues what it cancels, preferably what ran."""
        if ab.parents:
            self.report(15, "O2", f"{ab.name} is wanted now, but waits for {sorted(ab.parents)}")
        cut = self._cut_for(ab)
        trees = {one.ab.tree.name for one in cut if not one.ab.unit}
        ran = {one.ab.tree.name for one in cut if self._ran(one, ab)}
        if trees and ab.tree.name not in (ran or trees) and not self.joined_now(ab.tree):
            text = f"{ab.name} is of {ab.tree.name}, but cancels {', '.join(sorted(trees))}"
            self.report(15, "O2", text)
        for tree in self.trees.values():
            if tree.app == ab.app:
                self._cancelled_whole(tree, ab)

    def _cut_for(self, urgent: AB) -> list[Cut]:
        """O2: the ABs of its application cancelled since the previous request."""
        mine = [one for one in self.abs.values() if one.app == urgent.app]
        since = max((one.place for one in mine if one.place < urgent.place), default=-1)
        cut = [one for one in self.cuts if one.rule == "O2" and one.place > since]
        return [one for one in cut if one.ab.app == urgent.app]

    def _ran(self, cut: Cut, urgent: AB) -> bool:
        """O2: whether an AB of a tree ran when one of its ABs was cancelled."""
        others = [one for one in cut.ab.tree.members.values() if one is not urgent]
        return cut.was == RUNNING or any(one.phase == RUNNING for one in others)

    def _cancelled_whole(self, tree: Tree, urgent: AB) -> None:
        """O2: a tree that wanted one of the devices only has ABs running on others left."""
        own = [ab for ab in tree.members.values() if ab is not urgent and ab.unit is None]
        before = [ab for ab in own if ab.requested < self.now]
        if not any(ab.devices & urgent.devices for ab in before):
            return
        for ab in before:
            if ab.phase != RUNNING or ab.devices & urgent.devices:
                self.report(15, "O2", f"{ab.shown} is left, though {urgent.name} is wanted now")

    def _reaction_placed(self, ab: AB, new: bool) -> None:
        """O1: a reaction is the root of a new tree, or of one that it continues (O3, X3)."""
        if self._follows(ab):
            self.report(15, "O1", f"the reaction {ab.name} waits for {self._follows(ab)}")
        alike = any(
            other is not ab and other.reacted_to == ab.cause and other.requested == self.now
            for other in ab.tree.members.values()
        )
        if not (alike or self._goes_on_rightly(ab, new)):
            self.report(15, "O1", f"the reaction {ab.name} begins no tree of its own")

    def _goes_on_rightly(self, ab: AB, new: bool) -> bool:
        """O3, X3: the stream of a root that follows nothing.

        That is one that was held, else that of a state left in this instant, else a new one.
        """
        if self.joined_now(ab.tree):
            return True
        on = self.continuing.get(ab.app)
        return new if on is None else on is ab.tree

    def _follows_rightly(self, ab: AB, new: bool) -> None:
        """O1: it follows the latest Command of its application that is still in memory."""
        latest = self.latest.get(ab.app)
        if latest is not None and latest.command == "iu" and latest.phase != GONE:
            return  # the latest Command may be one inside, which has ended
        if latest is None or latest.phase == GONE:
            if not self._goes_on_rightly(ab, new):
                text = f"{ab.name} is of {ab.tree.name}, which it does not follow"
                self.report(15, "O3" if ab.app in self.continuing else "O1", text)
        elif latest.tree is not ab.tree:
            self.report(15, "O1", f"{ab.name} is of {ab.tree.name}; {latest.name} came before it")
        elif latest.requested < self.now and not self._follows(ab) and not self._begins_par(ab):
            self.report(15, "O1", f"{ab.name} does not wait for {latest.name}")

    def _follows(self, ab: AB) -> list[str]:
        """The ABs that it was requested to follow; a way back, which all join, is not one (X1)."""
        return [name for name in sorted(ab.parents) if not self.abs[name].inserted]

    def _begins_par(self, ab: AB) -> bool:
        """Whether it may be a branch beside one requested in this instant."""
        return any(
            other is not ab and other.requested == self.now and other.unit is None
            for other in ab.tree.members.values()
        )

    def left_waiting(self) -> None:
        """E2, at the end of an instant: no AB of an application that has ended waits."""
        for ab in self.abs_there():
            if ab.app in self.gone_apps and ab.phase in (WAITING, LINKED) and not self.in_group(ab):
                self.report(3, "E2", f"{ab.shown} is {ab.phase}, but {ab.app} has ended")

    def abs_there(self) -> list[AB]:
        """All of working memory."""
        return [ab for tree in self.trees.values() for ab in tree.members.values()]
