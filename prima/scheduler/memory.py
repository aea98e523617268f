"""Working memory (thesis Figure 4.3): every AB that has been requested and has not ended."""

from __future__ import annotations

from prima.scheduler.behavior import GONE, LINKED, RUNNING, WAITING, Application, Behavior, Stream


class WorkingMemory:
    """ABs by state, the devices they occupy, the streams, and the stack of floors."""

    def __init__(self) -> None:
        self.apps: dict[str, Application] = {}
        self.behaviors: dict[str, Behavior] = {}
        self.waiting: dict[str, Behavior] = {}
        """Those outside units."""
        self.running: dict[str, Behavior] = {}
        self.occupied: dict[str, Behavior] = {}
        self.streams: dict[str, Stream] = {}
        self.engaged: dict[str, Stream] = {}
        """Those of the streams in which an AB has engaged the user (K1)."""
        self.floor: list[Stream] = []
        self.answered: Stream | None = None
        """A stream with a question that the user has answered since the latest selection (X7)."""
        self.owed: Behavior | None = None
        """The asker's response to an answer, until it starts (X7)."""
        self._turns = 0
        self.in_view = False
        """Whether the camera sees the user, by its latest report (V4)."""
        self.sensed = 0
        """When the user was seen, heard or felt last (ms, K1)."""
        self.absent = False
        """Whether the user has gone unsensed for so long that nobody engages them (K1)."""

    @property
    def holder(self) -> Stream | None:
        """The stream that holds the floor (F1-F4), if any."""
        return self.floor[-1] if self.floor else None

    @property
    def active(self) -> Application | None:
        """The application whose stream is active (S2b, V3).

        That is the floor's stream or, without a floor, the open stream whose AB started last.
        """
        for stream in reversed(self.floor):
            if stream.open:
                return stream.app
        latest = max(self.streams.values(), key=turn_of, default=None)
        return latest.app if latest is not None and turn_of(latest) else None

    def add(self, ab: Behavior) -> None:
        """Add a requested AB: waiting if nothing comes before it, else linked."""
        self.behaviors[ab.name] = ab
        ab.app.members[ab.name] = ab
        ab.stream.members[ab.name] = ab
        if ab.waits_for:
            ab.state = LINKED
        else:
            self.wait(ab)

    def wait(self, ab: Behavior) -> None:
        """Let the AB compete. Commands inside a unit compete only within it."""
        ab.state, ab.listening = WAITING, False
        if ab.unit is None:
            self.waiting[ab.name] = ab

    def start(self, ab: Behavior) -> None:
        """Move a waiting AB to the running ones; it now occupies its devices."""
        self.waiting.pop(ab.name, None)
        ab.state = RUNNING
        self.running[ab.name] = ab
        self._turns += 1
        ab.stream.turn = ab.app.last_turn = self._turns
        self._users(ab).update(dict.fromkeys(ab.devices, ab))

    def release(self, ab: Behavior) -> None:
        """Free the devices that a running AB occupies."""
        del self.running[ab.name]
        users = self._users(ab)
        for device in ab.devices:
            if users.get(device) is ab:
                del users[device]
        if ab.motion:
            self._leave_to_other_motion(ab)

    def _users(self, ab: Behavior) -> dict[str, Behavior]:
        """The running ABs by device: those of the AB's unit, which owns its devices (U4, U5)."""
        if ab.unit is None:
            return self.occupied
        assert ab.unit.inside is not None
        return ab.unit.inside.busy

    def _leave_to_other_motion(self, ab: Behavior) -> None:
        """X5: of two motions that were composed, the one that goes on keeps its devices."""
        for other in self.running.values():
            if other.motion:
                for device in other.devices & ab.devices:
                    self.occupied.setdefault(device, other)

    def remove(self, ab: Behavior) -> None:
        """Remove an AB from working memory, whatever its state."""
        name = ab.name
        if ab.state is RUNNING:
            self.release(ab)
        else:
            self.waiting.pop(name, None)
        del self.behaviors[name]
        del ab.app.members[name]
        del ab.stream.members[name]
        if ab.unit is not None:
            ab.unit.inner.pop(name, None)
        ab.state = GONE

    def conflicts(self, ab: Behavior) -> list[Behavior]:
        """All running ABs that occupy one of the devices, in the order in which they started."""
        return [
            other
            for other in self.running.values()
            if other.unit is None and other.devices & ab.devices
        ]

    def unwait(self, ab: Behavior) -> None:
        """Link a waiting AB again: something has been inserted before it (X1, X4).

        From now on it waits for something of its own application.
        """
        del self.waiting[ab.name]
        ab.state = LINKED
        ab.wait.blocked = ("", "")
        ab.wait.since = ab.wait.kept_since = None

    def using(self, device: str) -> Behavior | None:
        """The Command that has a device; a unit owns it before a Command of it does (U5)."""
        ab = self.occupied.get(device)
        while ab is not None and ab.inside is not None:
            ab = ab.inside.busy.get(device)
        return ab

    def conflict(self, ab: Behavior) -> Behavior | None:
        """A running AB that occupies one of the devices (S1); a unit's own count within it."""
        users = self._users(ab)
        return next((users[device] for device in ab.in_order if device in users), None)


def turn_of(stream: Stream) -> int:
    """When an AB of the stream started last; 0 if the stream has not begun or has ended."""
    return stream.turn if stream.open else 0
