"""Leaving a state (O3): what becomes of its requests, and what goes on afterwards."""

from __future__ import annotations

from collections.abc import Iterable

from prima.invariants.endings import Endings
from prima.invariants.model import AB, RUNNING, Record, Tree


class LeavingRules(Endings):
    """O3, from the ``leave`` records. The application itself decides when a state is left."""

    def note_leave(self, record: Record) -> None:
        """A state is left: it makes no new requests, and none of its ABs starts."""
        app, state = record["app"], record["state"]
        if (app, state) in self.left:
            self.report(3, "O3", f"state {state} of {app} is left twice")
        if state not in self.asked.get(app, ()) and app not in self.refused:
            self.report(3, "O3", f"state {state} of {app} is left, which has asked for nothing")
        self.left.add((app, state))
        self.left_now.add((app, state))
        for tree in self.trees.values():
            if tree.app == app and tree.hold is not None and tree.hold_state == state:
                self._hold_no_more(tree)
        mine = [ab for ab in self.abs_there() if ab.app == app and ab.state == state]
        if mine:
            self.continuing[app] = going_on(mine)

    def asks(self, record: Record) -> None:
        """O3: a state that makes a request has followed states that were left, unless called."""
        app, state = record["app"], record.get("state")
        if state is None:
            return
        states = self.asked.setdefault(app, set())
        if app not in self.calling:
            for before in sorted(one for one in states if one < state):
                self._is_left(app, before, f"state {state} asks for {record['behavior']}")
        states.add(state)

    def left_at_end(self, app: str, outcome: str) -> None:
        """O3: an application that ends leaves its state, and all states that have called it.

        One that is ended by an error or a limit may not reach them (E2). The last state may be one
        whose requests were all refused (E3), which only shows in that it is left.
        """
        if "error." in outcome or "defect" in outcome:
            return
        states = sorted(self.asked.get(app, ()))
        if app in self.calling:
            later = (state for one, state in self.left if one == app and state is not None)
            states = [one for one in states[-1:] if one >= max(later, default=one)]
        for state in states:
            self._is_left(app, state, "it has ended")

    def _is_left(self, app: str, state: int, because: str) -> None:
        if (app, state) not in self.left:
            self.report(3, "O3", f"state {state} of {app} was not left, but {because}")
            self.asked[app].discard(state)

    def _hold_no_more(self, tree: Tree) -> None:
        """X3: a state that is left holds nothing; what was held may be continued."""
        if tree.until is None:
            tree.hold = None
        else:
            self.continuing[tree.app] = tree

    def left_rightly(self) -> None:
        """O3 at the end of an instant: the remaining ABs of states that were left are running."""
        for ab in self.abs_there():
            if not self.has_left(ab) or self.in_group(ab):
                continue
            if ab.phase != RUNNING:
                self.report(3, "O3", f"{ab.shown} is {ab.phase}, but its state was left")
            elif ab.listening:
                self.report(3, "O3", f"{ab.shown} listens, but its state was left")
        for tree, state in self.let_go:
            known = (tree.app, state) in self.left_now or tree.app in self.unloaded
            if not (known or self.released):
                self.report(10, "X3", f"{tree.name} is held no longer, but its state goes on")
        for tree in self.trees.values():
            self._held_rightly(tree)

    def _held_rightly(self, tree: Tree) -> None:
        if tree.until is not None and (tree.app, tree.hold_state) in self.left_now:
            self.report(10, "X3", f"{tree.name} is held on, but its state was left")


def going_on(left: Iterable[AB]) -> Tree:
    """O3: of several streams, the running one or the one whose AB started last, else the latest."""
    asked = sorted(left, key=lambda ab: int(ab.name.rpartition("#")[2]), reverse=True)
    return max((ab.tree for ab in asked), key=lambda tree: (tree.runs, tree.started))
