"""How ABs leave working memory: by their own end, by O2, O3 and E2, and with their unit (U5)."""

from __future__ import annotations

from collections import deque

from prima.language.commands import ABSENCE_MS, PATIENCE_MS
from prima.messages import Command, Data, Notice, Order
from prima.scheduler.behavior import (
    GONE,
    LINKED,
    RUNNING,
    WAITING,
    Application,
    Behavior,
    Run,
    Stream,
)
from prima.scheduler.intake import Maker, Table
from prima.scheduler.memory import Memory
from prima.scheduler.recorder import Recorder
from prima.scheduler.selection import Policy
from prima.scheduler.selector import Selector


class Told:
    """Notices for one application, to be handled in the window of ``stream`` if any (C3)."""

    __slots__ = ("app", "notices", "stream")

    def __init__(self, app: str, stream: Stream | None, notices: list[Notice]) -> None:
        self.app = app
        self.stream = stream
        self.notices = notices


class Endings:
    """Working memory, and every way out of it that is no failure."""

    def __init__(
        self,
        policy: Policy,
        table: Table,
        recorder: Recorder,
        bound: int | None = None,
        absence: int = ABSENCE_MS,
        patience: int = PATIENCE_MS,
    ) -> None:
        """Begin with nothing.

        Args:
            policy: what decides.
            table: the robot's Commands.
            recorder: takes the records.
            bound: after how many loops of another a waiting AB counts as a reaction (E4).
            absence: after how long (ms) without being sensed the user is absent (K1).
            patience: how long (ms) others may keep an AB from the speaker (E6); 0 for ever.
        """
        self._absence = absence
        self.recorder = recorder
        recorder.extensions = policy.extensions
        self.memory = Memory()
        self.told: deque[Told] = deque()
        self._maker = Maker(table)
        self._selector = Selector(self.memory, policy, self._maker, recorder, bound, patience)
        self.holds: dict[str, int] = {}
        """Until when streams are held (X3)."""
        self._restoring = policy.has("x1")
        """Whether it matters what Commands have done to the robot's state."""
        self._rolling: Behavior | None = None
        self._continuing: list[Application] = []
        """Applications one of whose streams stays open for this instant (O3)."""
        self._touched: dict[str, Stream] = {}
        self.halted = False
        self.changed = False
        """Whether anything has happened since the latest selection that it may depend on."""

    @property
    def orders(self) -> list[Order]:
        """Orders for the devices, not yet drained."""
        return self._selector.orders

    def drain_orders(self) -> list[Order]:
        """Give the orders made since the last time."""
        selector = self._selector
        orders = selector.orders
        if orders:
            selector.orders = []
            return orders
        return []

    def drain_turns(self) -> list[tuple[str, Stream]]:
        """Give the streams that wait suspended or have resumed since the last time, with which."""
        turns, self._selector.turns = self._selector.turns, []
        return turns

    def _now(self) -> int:
        return self.recorder.now

    def _cancel(self, behaviors: list[Behavior], devices: frozenset[str]) -> None:
        """O2: delete ABs; one that runs on the devices is cut short, others finish."""
        for ab in reversed(behaviors):
            if ab.state is GONE or in_group(ab):
                continue
            heard = not ab.silent
            if ab.state is RUNNING and not ab.devices & devices:
                self._silence(ab)
            else:
                self._delete(ab, "O2")
            if heard:
                self._tell_cancelled(ab)

    def _tell_cancelled(self, ab: Behavior) -> None:
        if ab.run is not None and not ab.app.gone:
            name = ab.command.type if ab.command else "iu"
            notice = Notice("cancelled", ab.run.number, ab.command, event=f"cancel.{name}")
            self.told.append(Told(ab.app.name, None, [notice]))

    def _withdraw(self, behaviors: list[Behavior], rule: str) -> None:
        """O3, E2: what has not started goes; what runs finishes, heard by nobody."""
        for ab in reversed(behaviors):
            if ab.state is GONE or in_group(ab):
                continue
            if ab.state is RUNNING:
                self._silence(ab)
                ab.left = True
                if ab.listening:
                    self._delete(ab, rule)
            elif not ab.spans:
                self._delete(ab, rule)

    def _silence(self, ab: Behavior) -> None:
        ab.silent = True
        ab.last_loop = True

    def _delete(self, ab: Behavior, rule: str) -> None:
        """Take an AB out before its end; a running one is aborted."""
        ab.open = True  # a unit that is deleted does not settle as done
        for inner in list(ab.inner.values()):
            self._delete(inner, rule)
        if ab.state is RUNNING and ab.command is not None:
            self.orders.append(Order("abort", ab.id, ab.command, app=ab.app.name))
            if ab.feedback and "locomotion" in ab.devices:
                self._rolling = ab
        self.recorder.behavior("cancel", ab, rule=rule, outcome=ab.state)
        self._remove(ab)

    def _remove(self, ab: Behavior) -> None:
        unit = ab.unit
        self.memory.remove(ab)
        self._touched[ab.stream.name] = ab.stream
        for child in ab.children:
            child.waits_for.discard(ab.name)
            if child.state is LINKED and not child.waits_for:
                child.freed = self._now()
                self.memory.wait(child)
        if ab.group is not None:
            ab.app.units = {key: held for key, held in ab.app.units.items() if held is not ab}
        if unit is not None:
            self._settle(unit)

    def running(self, behavior: str) -> Behavior | None:
        """The running AB of that name, if it runs still."""
        running = self.memory.running
        ab = running.get(behavior) or running.get(behavior.partition(".")[0])
        return ab if ab is not None and ab.id == behavior else None

    def question(self) -> Behavior | None:
        """The question that runs, if any (V1)."""
        ab = self.memory.occupied.get("speech-recognition")
        while ab is not None and ab.group is not None:
            ab = ab.busy.get("speech-recognition")
        return ab

    def listening(self, behavior: str) -> None:
        """A question has been said. One whose state was left ends at once (O3)."""
        ab = self.running(behavior)
        if ab is not None:
            self.changed = ab.listening = True
            if ab.left:
                self._delete(ab, "O3")

    def interrupted(self, behavior: str, data: Data) -> None:
        """X2: the device tells how much it had done of an AB that was interrupted."""
        self.changed = True
        name = behavior.partition(".")[0]
        ab = self.memory.behaviors.get(name)
        unit = self._selector.halting.pop(name, None)
        self.recorder.add(
            "halted",
            "robot",
            app=ab.app.name if ab else unit[0].app.name if unit else None,
            behavior=behavior,
            data=dict(data) or None,
            inbound=True,
        )
        if unit is not None:
            ab, data = unit[0], whole(data, unit[1], unit[2])
        elif ab is not None:
            marks = {key: data[key] for key in ("mark", "passed") if key in data}
            ab.since = marks or None
        if ab is None or ab.run is None or ab.silent or ab.app.gone:
            return
        command = ab.command or Command("iu", hook=[])
        event = f"interrupted.{command.type}"
        notice = Notice("interrupted", ab.run.number, command, data, event)
        self.told.append(Told(ab.app.name, None, [notice]))

    def ended(self, behavior: str, goal: bool, data: Data, inbound: bool = True) -> bool:
        """An AB ends by itself, or one loop of a feedback Command does (U2)."""
        ab = self.running(behavior)
        if ab is None:
            return False
        self.changed = True
        ending = goal or ab.last_loop or not ab.feedback
        outcome = "done" if ending else "again"
        if data and ending and "outcome" in data:
            outcome = str(data["outcome"])
        self.recorder.end(ab, outcome, goal, data, inbound)
        if ab.feedback and not goal and "locomotion" in ab.devices:
            self._rolling = ab
        if self._restoring and ab.type is not None and ab.command is not None:
            body = self._selector.body
            body.moved(ab.type, ab.command, data)
            if ab.inserted != "X1" and (ending or "follow" in ab.type.effects):
                ab.stream.effects.add(ab.type, ab.command, data, body)
        if not inbound and ab.type is not None and "speech-recognition" in ab.type.devices:
            ab.stream.answered = self._now()
        if ending:
            self._finish(ab, data)
        else:
            self.memory.release(ab)
            ab.freed = self._now()
            self.memory.wait(ab)
        return True

    def _finish(self, ab: Behavior, data: Data) -> None:
        run = ab.run
        self._remove(ab)
        if ab.silent or ab.app.gone or run is None:
            return
        run.left -= 1
        notices = []
        if ab.command is not None:
            notices.append(Notice("ended", run.number, ab.command, data))
        if run.left == 0:
            notices.append(Notice("done", run.number, ab.command, data))
        self.told.append(Told(ab.app.name, ab.stream, notices))

    def _settle(self, unit: Behavior) -> None:
        """End a unit when its Commands have ended, or what was left to run in it has."""
        if unit.state is not RUNNING or unit.inner or unit.open:
            return
        self.recorder.end(unit, "done", True, {}, inbound=False)
        self._finish(unit, {})

    def _close_unit(self, app: Application, number: int) -> None:
        unit = app.units.pop(number, None)
        if unit is None or unit.state is GONE:
            return
        unit.open = False
        for ab in list(reversed(list(unit.inner.values()))):
            if ab.state is RUNNING:
                self._silence(ab)
            elif ab.state is not GONE:
                self._delete(ab, "U5")
        if unit.name in self.memory.running:
            self._settle(unit)
        elif unit.name in self.memory.behaviors:
            self._delete(unit, "U5")

    def _delete_rest(self, tree: dict[str, Behavior], run: Run | None, rule: str) -> None:
        """Delete what has not started of a failed tree; other runs in it are cancelled."""
        for other in list(reversed(list(tree.values()))):
            if other.state in (LINKED, WAITING) and not in_group(other):
                self._delete(other, rule)
                if other.run is not run and not other.silent:
                    self._tell_cancelled(other)


def in_group(ab: Behavior) -> bool:
    """Whether an AB is a part of a unit that shares the unit's fate (U4)."""
    return ab.unit is not None and not ab.unit.spans


def whole(data: Data, finished: list[Command], count: int) -> Data:
    """How much of a unit was done, of ``count`` Commands: the finished ones and a part of one."""
    part = float(data.get("done", 0.0))
    said = [command.text for command in finished if command.text]
    heard = " ".join([*said, str(data.get("heard", ""))]).strip()
    made = {"done": round((len(finished) + part) / max(count, 1), 3)}
    return {**made, "heard": heard} if heard else made
