"""Streams: when they end (C1), and to which of them a request belongs (O1, O2, O3, C3)."""

from __future__ import annotations

from prima.invariants.extensions import joined_now
from prima.invariants.memory import Memory
from prima.invariants.model import AB, GONE, LINKED, RUNNING, WAITING, Cut, Record, Tree

A_MOMENT_LATER = 1
"""Milliseconds after a selection within which an application is notified of it."""


def note_window(memory: Memory, record: Record) -> None:
    """C3: a window opens or closes."""
    tree = memory.trees.get(record["tree"])
    if tree is None:
        memory.report(3, "C1", f"a window of {record['tree']} opens, which has ended")
        tree = memory.trees[record["tree"]] = Tree(record["tree"], record["app"])
    if record["outcome"] == "open":
        _open_window(memory, tree)
    elif tree in memory.windows:
        tree.windows -= 1
        memory.windows.remove(tree)
    else:
        memory.report(15, "C3", f"a window of {tree.name} closes, which is not open")


def _open_window(memory: Memory, tree: Tree) -> None:
    """C3: a window opens for an end with a notice, or when a stream waits or resumes (C2)."""
    if memory.windows:
        memory.report(15, "C3", f"a window of {tree.name} opens within another")
    if memory.owed[tree.name]:
        memory.owed[tree.name] -= 1
    turned = [at for at in memory.turns[tree.name] if memory.now - at <= A_MOMENT_LATER]
    if memory.heard[tree.name] > 0:
        memory.heard[tree.name] -= 1
    elif not turned:
        memory.report(15, "O3", f"a window of {tree.name} opens, but no end is heard")
    else:
        turned.pop()
    memory.turns[tree.name] = turned
    tree.windows += 1
    memory.windows.append(tree)


def check_windows(memory: Memory) -> None:
    """C3 at the end of an instant: all windows are closed; each end with a notice had one."""
    for tree in memory.windows:
        memory.report(15, "C3", f"a window of {tree.name} is not closed")
    for name in sorted(+memory.owed):
        if name.rpartition(":")[0] not in memory.gone_apps:
            memory.report(15, "C3", f"an end of {name} is heard, but no window opens")


def note_stream_end(memory: Memory, record: Record) -> None:
    """C1: a stream ends without ABs; its end is recorded when it happens, and once."""
    if record["tree"] in memory.told_ends:
        memory.report(13, "C1", f"the end of {record['tree']} is recorded twice")
    memory.told_ends.add(record["tree"])
    tree = memory.trees.get(record["tree"])
    if tree is None:
        return
    if tree.until is not None:
        memory.report(10, "X3", f"{tree.name} ends, but is held until {tree.until} ms")
        tree.until = None
    for ab in list(tree.members.values()):
        memory.report(3, "C1", f"{ab.shown} is {ab.phase}, but its tree has ended: it is lost")
        memory.remove(ab)


def check_ends(memory: Memory) -> None:
    """C1 at the end of an instant."""
    for name in sorted(memory.ended_trees ^ memory.told_ends):
        ended = "not recorded" if name in memory.ended_trees else "recorded, but it has not ended"
        memory.report(13, "C1", f"the end of {name} is {ended}")


def window_of(memory: Memory, app: str) -> Tree | None:
    """The application's current window."""
    return next((tree for tree in reversed(memory.windows) if tree.app == app), None)


def placed_rightly(memory: Memory, ab: AB, new: bool) -> None:
    """O1, O2, C3: the stream that a request belongs to, and what it follows."""
    for name in sorted(ab.parents):
        if memory.abs[name].tree is not ab.tree:
            memory.report(15, "U3", f"{ab.name} of {ab.tree.name} follows {name} of another")
    if ab.inserted:
        return
    if ab.unit is not None:
        if ab.unit.tree is not ab.tree:
            memory.report(15, "U5", f"{ab.name} is not of the stream of its unit")
        return
    if any(one is ab for one, _ in memory.urgent):
        _urgent_placed(memory, ab)
    elif ab.cause is not None:
        _reaction_placed(memory, ab, new)
    elif (window := window_of(memory, ab.app)) is not None:
        if ab.tree is not window and not _goes_on_here(memory, ab):
            text = f"{ab.name} is of {ab.tree.name}, but asked for in a window of {window.name}"
            memory.report(15, "C3", text)
    else:
        _follows_rightly(memory, ab, new)


def _goes_on_here(memory: Memory, ab: AB) -> bool:
    """Whether it follows in that tree: in its own request, one with ``now``, or a hold (X3)."""
    follows = any(memory.abs[name].requested == memory.now for name in ab.parents)
    urgent = any(one.tree is ab.tree for one, _ in memory.urgent)
    return follows or urgent or joined_now(memory, ab.tree)


def _urgent_placed(memory: Memory, ab: AB) -> None:
    """O2: it is never linked, and continues what it cancels, preferably what ran."""
    if ab.parents:
        memory.report(15, "O2", f"{ab.name} is wanted now, but waits for {sorted(ab.parents)}")
    cut = _cut_for(memory, ab)
    trees = {one.ab.tree.name for one in cut if not one.ab.unit}
    ran = {one.ab.tree.name for one in cut if _ran(one, ab)}
    if trees and ab.tree.name not in (ran or trees) and not joined_now(memory, ab.tree):
        text = f"{ab.name} is of {ab.tree.name}, but cancels {', '.join(sorted(trees))}"
        memory.report(15, "O2", text)
    for tree in memory.trees.values():
        if tree.app == ab.app:
            _cancelled_whole(memory, tree, ab)


def _cut_for(memory: Memory, urgent: AB) -> list[Cut]:
    """O2: the ABs of its application cancelled since the previous request."""
    mine = [one for one in memory.abs.values() if one.app == urgent.app]
    since = max((one.place for one in mine if one.place < urgent.place), default=-1)
    cut = [one for one in memory.cuts if one.rule == "O2" and one.place > since]
    return [one for one in cut if one.ab.app == urgent.app]


def _ran(cut: Cut, urgent: AB) -> bool:
    """O2: whether an AB of a tree ran when one of its ABs was cancelled."""
    others = [one for one in cut.ab.tree.members.values() if one is not urgent]
    return cut.was == RUNNING or any(one.phase == RUNNING for one in others)


def _cancelled_whole(memory: Memory, tree: Tree, urgent: AB) -> None:
    """O2: a tree that wanted one of the devices only has ABs running on others left."""
    own = [ab for ab in tree.members.values() if ab is not urgent and ab.unit is None]
    before = [ab for ab in own if ab.requested < memory.now]
    if not any(ab.devices & urgent.devices for ab in before):
        return
    for ab in before:
        if ab.phase != RUNNING or ab.devices & urgent.devices:
            memory.report(15, "O2", f"{ab.shown} is left, though {urgent.name} is wanted now")


def _reaction_placed(memory: Memory, ab: AB, new: bool) -> None:
    """O1: a reaction is the root of a new tree, or of one that it continues (O3, X3)."""
    if _follows(memory, ab):
        memory.report(15, "O1", f"the reaction {ab.name} waits for {_follows(memory, ab)}")
    alike = any(
        other is not ab and other.reacted_to == ab.cause and other.requested == memory.now
        for other in ab.tree.members.values()
    )
    if not (alike or _goes_on_rightly(memory, ab, new)):
        memory.report(15, "O1", f"the reaction {ab.name} begins no tree of its own")


def _goes_on_rightly(memory: Memory, ab: AB, new: bool) -> bool:
    """O3, X3: the stream of a root that follows nothing.

    That is one that was held, else that of a state left in this instant, else a new one.
    """
    if joined_now(memory, ab.tree):
        return True
    on = memory.continuing.get(ab.app)
    return new if on is None else on is ab.tree


def _follows_rightly(memory: Memory, ab: AB, new: bool) -> None:
    """O1: it follows the latest Command of its application that is still in memory."""
    latest = memory.latest.get(ab.app)
    if latest is not None and latest.command == "iu" and latest.phase != GONE:
        return  # the latest Command may be one inside, which has ended
    if latest is None or latest.phase == GONE:
        if not _goes_on_rightly(memory, ab, new):
            text = f"{ab.name} is of {ab.tree.name}, which it does not follow"
            memory.report(15, "O3" if ab.app in memory.continuing else "O1", text)
    elif latest.tree is not ab.tree:
        memory.report(15, "O1", f"{ab.name} is of {ab.tree.name}; {latest.name} came before it")
    elif latest.requested < memory.now and not _follows(memory, ab) and not _begins_par(memory, ab):
        memory.report(15, "O1", f"{ab.name} does not wait for {latest.name}")


def _follows(memory: Memory, ab: AB) -> list[str]:
    """The ABs that it was requested to follow; a way back, which all join, is not one (X1)."""
    return [name for name in sorted(ab.parents) if not memory.abs[name].inserted]


def _begins_par(memory: Memory, ab: AB) -> bool:
    """Whether it may be a branch beside one requested in this instant."""
    return any(
        other is not ab and other.requested == memory.now and other.unit is None
        for other in ab.tree.members.values()
    )


def left_waiting(memory: Memory) -> None:
    """E2, at the end of an instant: no AB of an application that has ended waits."""
    for ab in abs_there(memory):
        if ab.app in memory.gone_apps and ab.phase in (WAITING, LINKED) and not memory.in_group(ab):
            memory.report(3, "E2", f"{ab.shown} is {ab.phase}, but {ab.app} has ended")


def abs_there(memory: Memory) -> list[AB]:
    """All of working memory."""
    return [ab for tree in memory.trees.values() for ab in tree.members.values()]
