"""How long others keep an AB waiting: what starves is reported, and what cannot speak has its turn.

The mediator counts between selections, in which nothing changes. Rule E6 says what follows
(:func:`prima.scheduler.rules.e6`).
"""

from __future__ import annotations

from prima.scheduler import rules
from prima.scheduler.behavior import Behavior, application
from prima.scheduler.memory import Memory
from prima.scheduler.recorder import Recorder


class Patience:
    """Watches the waiting ABs of a run; ``most`` (ms) is how long each has to bear it, 0 for ever."""

    def __init__(self, memory: Memory, recorder: Recorder, most: int) -> None:
        self._memory = memory
        self._chronicle = recorder
        self._most = most
        self.due: int | None = None
        """When the next AB will have waited for so long (ms), if any waits."""

    def before(self, now: int) -> None:
        """Count what has passed since the selection before, and report who has waited too long."""
        if not self._most:
            return
        for ab in self._memory.waiting.values():
            if ab.kept_from >= 0:
                ab.kept += now - ab.kept_from
                ab.overdue = ab.kept >= self._most
            waited = max(now - ab.waits_from, ab.kept) if ab.waits_from >= 0 else 0
            if waited >= self._most and not ab.starves:
                self._report(ab, waited)

    def after(self, now: int) -> None:
        """Note who is kept waiting by whom from here on, and when the next one will starve."""
        self.due = None
        if not self._most:
            return
        for ab in self._memory.waiting.values():
            ab.kept_from = -1
            if application(ab.blocked[1]) in ("", ab.app.name):
                ab.waits_from = -1
                continue
            if rules.keeps_speaker(ab, self._memory):
                ab.kept_from = now
            if ab.waits_from < 0:
                ab.waits_from = now
            if not ab.starves:
                due = ab.waits_from + self._most
                self.due = due if self.due is None else min(due, self.due)

    def _report(self, ab: Behavior, waited: int) -> None:
        ab.starves = True
        rule, by = ab.blocked
        self._chronicle.add(
            "starve",
            "mediator",
            app=ab.app.name,
            behavior=ab.id,
            rule="E6" if ab.overdue else rule,
            by=by,
            data={"waited": waited / 1000},
        )

    def over(self, ab: Behavior) -> None:
        """An AB waits no longer."""
        ab.waits_from = ab.kept_from = -1
        ab.kept = 0
        ab.starves = ab.overdue = False

    def interrupt(self, now: int) -> None:
        """E5: in an emergency nobody keeps anybody waiting."""
        self.before(now)
        self.due = None
        for ab in self._memory.waiting.values():
            ab.waits_from = ab.kept_from = -1
