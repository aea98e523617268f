"""X8: late reactions are given up, and an answer that one question refuses may fit another.

A reaction is a root that has not started, with the ABs that wait for it alone (as in E1).
"""

from __future__ import annotations

from typing import Literal

from prima.messages import Command, Notice
from prima.scheduler.behavior import LINKED, WAITING, AwaitedRun, Behavior
from prima.scheduler.endings import delete
from prima.scheduler.mediation import Mediation
from prima.scheduler.selection import able


def x8(mediation: Mediation) -> None:
    """X8: give up reactions that were not started in time."""
    if mediation.halted:
        return
    waiting = mediation.memory.waiting
    now = mediation.now
    stale = [ab for ab in waiting.values() if ab.stale is not None and ab.stale <= now]
    for ab in stale:
        free = _may_start(mediation, ab)
        if free and ab.stale == now:
            ab.stale = now + 1  # the selection of this very instant may start it
        elif ab.name in waiting:
            _give_up(mediation, ab, whole=free)


def _may_start(mediation: Mediation, ab: Behavior) -> bool:
    """Whether an AB may start now; another that held devices back (S3) may have been given up."""
    waiting = mediation.memory.waiting.values()
    ranked = mediation.policy.ranked(waiting, mediation.memory, mediation.now)
    return any(one is ab for _, one in able(mediation, ranked, {}))


def _give_up(mediation: Mediation, root: Behavior, whole: bool) -> None:
    """Delete a reaction, except ABs that need only free devices where devices kept it waiting.

    An emergency stop keeps a reaction waiting, too; then it is given up ``whole``.
    """
    kept = not whole and mediation.policy.refusal(root, mediation.memory) is None
    lost = [root]
    for ab in followers(root)[1:]:
        if not kept or mediation.memory.conflict(ab) is not None:
            lost.append(ab)
    reaction = root.reaction
    told = [one for ab in lost for one in (ab, *ab.inner.values())]
    for ab in reversed(lost):
        delete(mediation, ab, "X8")
    for ab in [child for one in lost for child in one.children]:
        if ab.state is WAITING:
            ab.reaction, ab.stale = reaction, mediation.now + 1
            ab.freed = None  # nothing has ended before it (S2c)
    _tell(mediation, told)


def followers(root: Behavior) -> list[Behavior]:
    """A root and the ABs that wait for it alone, each after all that it waits for."""
    found, names = [root], {root.name}
    for ab in found:  # the list grows
        for child in ab.children:
            if child.state is LINKED and child.waits_for <= names and child not in found:
                found.append(child)
                names.add(child.name)
    return found


def _tell(mediation: Mediation, lost: list[Behavior]) -> None:
    """Notify the application of what it should no longer wait for.

    The rest of the same request goes on, if any of it has started or is yet to start.
    """
    notified = [ab for ab in lost if ab.run is not None]
    for ab in notified:
        assert ab.run is not None
        ab.run.left -= 1
    for ab in notified:
        assert ab.run is not None
        mediation.tell(ab.app, None, *_notices(ab, ab.run, last=ab is notified[-1]))


def _notices(ab: Behavior, run: AwaitedRun, last: bool) -> list[Notice]:
    """The notices that an AB has expired and, after the last one, that its request is done."""
    command = ab.command or Command("iu")
    fate: Literal["cancelled", "expired"] = "expired" if run.left or run.begun else "cancelled"
    notices = [Notice(fate, run.number, command, event=f"expired.{command.asked}")]
    if last and run.left == 0 and run.begun:
        notices.append(Notice("done", run.number, command))
    return notices


def offered(mediation: Mediation) -> Behavior | None:
    """X8: the first question of a waiting reaction; it is offered answers that another refuses."""
    reactions = [ab for ab in mediation.memory.waiting.values() if ab.reaction is not None]
    for _, root in mediation.policy.ranked(reactions, mediation.memory, mediation.now):
        for ab in followers(root):
            if ab.command is not None and ab.command.type == "q-and-a":
                return ab
    return None
