"""The user's speech as reported by drivers: when they begin and fall silent, and what was heard."""

from __future__ import annotations

from prima.devices.conductor import Conductor
from prima.messages import Heard, Inbound


class UserSpeech:
    """The user's current utterance. Times are ms of the run."""

    def __init__(self, conductor: Conductor) -> None:
        self._conductor = conductor
        self._began: int | None = None
        """When they began to speak."""
        self._over = False
        """Whether they have spoken since the ear last listened."""
        self._cut = False
        """Whether their utterance has taken too long and is over for the run."""

    def begins(self, now: int) -> None:
        """The user begins to speak; nothing if they are known to be speaking."""
        if self._began is None:
            self._began, self._cut = now, False
            self._conductor.speech_begins(now)

    def ends(self) -> None:
        """The user has fallen silent."""
        if self._began is not None:
            self._began, self._over = None, True
            self._conductor.ear.speech_ends()

    def heard(self, now: int, heard: Heard) -> list[Inbound]:
        """The recogniser's result, for the session; None if the utterance was cut off."""
        if self._cut:
            self._cut = False
            return []
        began, self._over = self._began, True
        self.ends()
        if began is None:  # only the driver knows, if anybody
            began = now - min(max(heard.lasted, 0), now)
        passed = self._conductor.marks_passed(began)
        return [Heard(heard.text, {**passed, **heard.data}, now - began)]

    def listen_on(self, now: int) -> None:
        """Let the ear keep listening after an utterance of the user."""
        if self._over:
            self._over = False
            self._conductor.ear.listen_on(now)

    @property
    def too_long(self) -> int | None:
        """When the user will have spoken for longer than the question allows."""
        longest = self._conductor.longest_answer() if self._began is not None else 0
        return self._began + longest if self._began is not None and longest else None

    def cut_off(self, now: int) -> list[Inbound]:
        """End an answer that takes too long (VoiceXML 2.0, 6.3.2); the rest of it is ignored."""
        over = self.too_long
        if over is None or over > now:
            return []
        passed = self._conductor.marks_passed(over)
        self._cut = True
        self.ends()
        return [Heard("", {**passed, "toolong": True})]
