"""When things go wrong: devices that fail or hang, units that take too long, the emergency stop."""

from __future__ import annotations

from typing import Final

from prima.messages import Notice, Order
from prima.scheduler.behavior import GONE, RUNNING, Behavior, Stream
from prima.scheduler.endings import Endings, Told, in_group

HANG_MS: Final = 120_000
"""How long a Command may run beyond its own stated times before it has failed (E1)."""
MS_A_LETTER: Final = 500
"""How long a letter of what is said may take at the most."""


class Failures(Endings):
    """The rules E1 and E5, and the longest duration of units (U4, U5)."""

    def failed(self, behavior: str, device: str, reason: str) -> None:
        """E1: a device fails; the AB ends as failed and the rest of its tree goes."""
        ab = self.running(behavior)
        if ab is not None:
            self.changed = True
            self._fail(ab, f"error.device.{device}", reason, inbound=True)

    def _fail(self, ab: Behavior, event: str, reason: str, inbound: bool = False) -> None:
        self.recorder.behavior(
            "fail",
            ab,
            rule="E1",
            event=event,
            message=reason,
            device=event.rpartition(".")[2],
            inbound=inbound or None,
        )
        if ab.feedback and "locomotion" in ab.devices:
            self._rolling = ab
        # Inside a group the unit is the AB that fails (U4); a spanning unit stays its author's.
        while ab.unit is not None and not ab.unit.spans:
            unit = ab.unit
            for inner in list(unit.inner.values()):
                if inner is not ab:
                    self._delete(inner, "E1")
            unit.open = True  # so that it does not settle as done
            self._remove(ab)
            ab = unit
            self.recorder.behavior("fail", ab, rule="E1", event=event, message=reason)
        stream, run, unit_of, silent = ab.stream, ab.run, ab.unit, ab.silent
        self._remove(ab)
        if ab.inserted:
            return  # what it was put in for goes on without it
        self._delete_rest(stream.members if unit_of is None else unit_of.inner, run, "E1")
        if run is not None and not (silent or ab.app.gone):
            run.left = 0
            notice = Notice("failed", run.number, ab.command, event=event, message=reason)
            self.told.append(Told(ab.app.name, stream, [notice]))

    def deadline(self) -> int | None:
        """The next instant at which a unit, a device or an event waited for is too late (ms)."""
        running = self.memory.running.values()
        late = [ab.late for ab in running if ab.late is not None]
        lapse = self._lapse()
        if lapse is not None:
            late.append(lapse)
        starving = self._selector.patience.due
        if starving is not None and not self.halted:
            late.append(starving)
        return min((*late, *self.holds.values()), default=None)

    def _lapse(self) -> int | None:
        """K1: when the user will count as absent, if anything waits for that."""
        memory = self.memory
        if memory.in_view or memory.absent or not memory.engaged:
            return None
        if not any(ab.leaves for ab in memory.waiting.values()):
            return None
        return memory.sensed + self._absence

    def _look_for_user(self) -> None:
        """K1: nobody engages a user who has not been seen, heard or felt for a while."""
        memory = self.memory
        memory.absent = not memory.in_view and self._now() - memory.sensed >= self._absence

    def expire(self) -> bool:
        """U5, E1: end what has run longer than it may; tells whether there was any such."""
        now = self._now()
        due = self.deadline()
        if due is None or due > now:
            return False
        self.changed = True
        for name in [name for name, due in self.holds.items() if due <= now]:
            self._let_go(self.memory.streams[name], "over")
        running = self.memory.running
        for ab in [ab for ab in running.values() if ab.late is not None and ab.late <= now]:
            if ab.name not in running:  # it ended with another one
                continue
            ab.late = None
            if ab.group is not None:
                self._unit_timeout(ab)
            else:
                self.orders.append(Order("abort", ab.id, ab.command, app=ab.app.name))
                device = min(ab.devices, default="none")
                self._fail(ab, f"error.device.{device}", "The device did not end in time.")
        return True

    def _let_go(self, stream: Stream, outcome: str) -> None:
        """X3: the stream is held no longer."""
        stream.hold = stream.held_until = None
        del self.holds[stream.name]
        self._touched[stream.name] = stream
        self.recorder.stream("held", stream, "X3", outcome=outcome)

    def _unit_timeout(self, unit: Behavior) -> None:
        self.recorder.behavior("fail", unit, rule="U5", event="error.unit.timeout")
        number = next((key for key, ab in unit.app.units.items() if ab is unit), None)
        run = unit.run
        if number is not None:
            self._close_unit(unit.app, number)
        else:
            told = unit.silent or unit.app.gone
            self._silence(unit)
            for ab in list(reversed(list(unit.inner.values()))):
                if ab.state is not RUNNING:
                    self._delete(ab, "U5")
            self._delete_rest(unit.stream.members, run, "U5")
            if told:
                return
        notice = Notice(
            "failed" if number is None else "unit-timeout",
            number if number is not None else run.number if run else 0,
            event="error.unit.timeout",
            message="The unit took too long.",
        )
        self.told.append(Told(unit.app.name, unit.stream, [notice]))

    def emergency(self, pressed: bool, resume: bool, serial: int) -> None:
        """E5: every AB ends at once and nothing starts until the stop is released.

        ``serial`` is that of the event by which applications are told.
        """
        self.changed = True
        self.recorder.add(
            "emergency",
            "mediator",
            rule="E5",
            outcome="pressed" if pressed else "released",
            inbound=True,
            serial=serial,
            data=None if pressed else {"resume": resume},
        )
        if pressed:
            self.halted = True
            self._selector.patience.interrupt(self._now())
            running = [ab for ab in self.memory.running.values() if ab.unit is None]
            for ab in running:
                self._halt(ab)
            return
        self.halted = False
        if not resume:
            for name in list(self.holds):
                self._let_go(self.memory.streams[name], "left")
            for stream in self.memory.streams.values():
                stream.hold = None
            for ab in reversed(list(self.memory.behaviors.values())):
                if ab.state is not GONE and not in_group(ab):
                    self._delete(ab, "E5")
                    if not ab.silent:
                        self._tell_cancelled(ab)

    def _halt(self, ab: Behavior) -> None:
        given_up = ab.silent or ab.last_loop or (ab.spans and not ab.open)
        was_open, ab.open = ab.open, True  # it does not settle as done meanwhile
        for inner in list(ab.inner.values()):
            if given_up:
                self._delete(inner, "E5")
            elif inner.state is RUNNING:
                self._halt(inner)
        ab.open = was_open
        if ab.group is not None and not (ab.inner or ab.open or given_up):
            self._settle(ab)  # all that was left of it had been given up
            return
        if ab.command is not None:
            self.orders.append(Order("abort", ab.id, ab.command, app=ab.app.name))
        self.recorder.behavior("cancel", ab, rule="E5", outcome="running" if given_up else "halted")
        if given_up:
            self._remove(ab)
        else:
            self.memory.release(ab)
            ab.listening = False
            self.memory.wait(ab)


def allowance(ab: Behavior) -> int:
    """How long an AB may run (ms): the times among its arguments and :data:`HANG_MS`."""
    row, command = ab.type, ab.command
    assert row is not None and command is not None
    letters = MS_A_LETTER * len(command.text or "")
    if not command.args and not command.cues:
        return HANG_MS + letters
    stated = 0
    for name, value in command.args.items():
        argument = row.arguments.get(name)
        if argument is not None and argument.kind == "duration":
            stated += int(value)
    times = sum(
        cue.value
        for cue in command.cues
        if isinstance(cue.value, int | float) and cue.kind != "rate"
    )
    slowest = min(
        (float(cue.value or 1) for cue in command.cues if cue.kind == "rate"), default=1.0
    )
    return HANG_MS + stated + round(times + letters / min(slowest, 1.0))
