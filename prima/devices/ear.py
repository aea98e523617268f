"""The ear: which question listens, how long it waits, and when the user may interrupt it.

It needs to know when the robot begins and finishes asking, and when the user begins and finishes
speaking, but not what was said.
"""

from __future__ import annotations

from dataclasses import dataclass

from prima.devices.goals import RecordingBounds
from prima.messages import Command, Cue, Ended, Inbound
from prima.messages.times import earliest


@dataclass(slots=True)
class Question:
    """A question that the robot asks."""

    id: str
    command: Command
    listens: bool = False
    """Whether it has been asked, so that the user may answer."""
    until: int | None = None
    """When its time for an answer ends (ms); None while somebody speaks."""
    left: int = 0
    """When that time would have ended if nobody had spoken (ms)."""
    deaf: bool = False
    """Whether it can get no result: its recogniser is broken."""
    lost: bool = False
    """Whether another Command has taken over its recogniser (only without a mediator)."""


def bounds_of(command: Command) -> RecordingBounds | None:
    """The limits of the answer's recording, if it is recorded."""
    if not command.cued("record"):
        return None
    kinds = ("record", "finalsilence")
    values = {cue.kind: int(cue.value or 0) for cue in command.cues if cue.kind in kinds}
    return RecordingBounds(values["record"], values.get("finalsilence", 0))


class Ear:
    """The questions being asked, and the user's utterances meanwhile."""

    def __init__(self) -> None:
        self.questions: dict[str, Question] = {}
        self._voices = 0
        """How many utterances of the user are under way."""

    def ask(self, behavior: str, command: Command) -> None:
        """The robot begins to ask a question; it takes the recogniser from any other."""
        for other in self.questions.values():
            other.lost = True
        self.questions[behavior] = Question(behavior, command)

    def listen(self, now: int, behavior: str) -> bool:
        """A question has been asked: its time for an answer begins, unless the user speaks.

        Returns:
            Whether it listens: its recogniser is not broken.
        """
        question = self.questions[behavior]
        question.listens = not question.deaf
        if question.listens:
            self._wait(now, question)
            if self._voices:
                question.until = None
        return question.listens

    def drop(self, behavior: str) -> None:
        """A question is over or was aborted."""
        self.questions.pop(behavior, None)

    def deafen(self, behavior: str) -> None:
        """The recogniser is broken: a question gets no result any more."""
        if question := self.questions.get(behavior):
            question.deaf, question.listens, question.until = True, False, None

    @property
    def question(self) -> Question | None:
        """The question that an answer would go to."""
        return next((one for one in self.questions.values() if not one.lost), None)

    @property
    def deaf(self) -> bool:
        """Whether the question that an answer would go to can get none."""
        question = self.question
        return question is not None and question.deaf

    @staticmethod
    def _wait(now: int, question: Question) -> None:
        question.until = question.left = now + max(int(question.command.args["timeout"]), 1)

    # The user -----------------------------------------------------------------------

    def speech_begins(self) -> str:
        """The user begins to speak: a question that listens waits for them to end.

        Returns:
            The question whose prompt has to be stopped, or nothing. With hotword bargein the robot
            keeps speaking until it recognises the input (VoiceXML 2.0, 4.1.5.1).
        """
        self._voices += 1
        question = self.question
        if question is None or question.deaf:
            return ""
        if question.listens:
            question.until = None
            return ""
        command = question.command
        return (
            question.id if command.args.get("bargein", True) and not command.cued("hotword") else ""
        )

    def speech_ends(self) -> None:
        """The user has finished or broken off an utterance."""
        self._voices -= 1

    def listen_on(self, now: int) -> None:
        """The user's words answered no question: their time to answer begins again.

        Where only keys are listened to, words do not count, and the time has gone on.
        """
        if self._voices:
            return
        for question in self.questions.values():
            if not question.listens or question.until is not None:
                continue
            if Cue(0, "hotword", "dtmf") in question.command.cues:
                question.until = max(question.left, now + 1)
            else:
                self._wait(now, question)

    def recording(self) -> RecordingBounds | None:
        """The limits of an answer's recording; None if it is not recorded."""
        question = self.question
        return bounds_of(question.command) if question is not None else None

    # Time ---------------------------------------------------------------------------

    def due(self) -> int | None:
        """When the next question times out, if ever."""
        return earliest(None, *(one.until for one in self.questions.values()))

    def unanswered(self, now: int, behavior: str) -> list[Inbound]:
        """The end of a question whose time for an answer is over, if any (V3, noinput)."""
        question = self.questions.get(behavior)
        if question is None or question.until is None or question.until > now:
            return []
        self.drop(behavior)
        return [Ended(behavior, True, {"outcome": "noinput"})]
