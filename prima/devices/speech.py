"""What the robot is saying: how far it has got, and which marks it has passed."""

from __future__ import annotations

from dataclasses import dataclass

from prima.devices import voice
from prima.messages import Command, Json, Order


@dataclass(slots=True)
class Utterance:
    """A text that the robot says, from ``began`` to ``ends`` (ms)."""

    command: Command
    began: int
    ends: int
    timeline: voice.Timeline | None = None
    """When its letters and marks come, where it has cues."""
    skipped: int = 0
    """How much (ms) had been said before an interruption (X2)."""

    @classmethod
    def of(cls, now: int, order: Order, rates: dict[str, float]) -> Utterance | None:
        """What an order lets the robot say from now on, if anything.

        Args:
            now: the time (ms).
            order: a ``start``; after an interruption it may name the mark to go on from (X2).
            rates: letters a second, by language.
        """
        command = order.command
        if command is None or not (command.text or command.cues):
            return None
        if order.loop > 1 and not order.resumed:
            return None  # said in the first loop
        text, lang = command.text or "", command.lang
        if not command.cues:
            return cls(command, now, now + voice.duration(text, lang, rates))
        timeline = voice.timeline(text, lang, rates, command.cues)
        skipped = round(timeline.marks[order.data["passed"] - 1][0]) if order.data else 0
        ends = now + max(timeline.total - skipped, 1)
        return cls(command, now, ends, timeline, skipped)

    def passed(self, now: int) -> tuple[int, str, int] | None:
        """How many marks have been passed, the last one's name, and the ms since then."""
        played = self.skipped + now - self.began
        count = self.timeline.passed(played) if self.timeline is not None else 0
        if self.timeline is None or not count:
            return None
        time, name = self.timeline.marks[count - 1]
        return count, name, round(played - time)

    def heard(self, now: int) -> dict[str, Json]:
        """How much of it has been heard, as :class:`prima.messages.Halted` has it."""
        if self.timeline is None:
            share = (now - self.began) / max(self.ends - self.began, 1)
            text = self.command.text or ""
            return {"heard": voice.beginning(text, self.command.lang, share)} if text else {}
        data: dict[str, Json] = {"heard": self.timeline.heard(now - self.began + self.skipped)}
        passed = self.passed(now)
        if passed is not None:
            data["passed"], data["mark"] = passed[:2]
        return data


class Marks:
    """The last mark that each application's speech has passed."""

    def __init__(self) -> None:
        self._passed: dict[str, tuple[str, int]] = {}

    def end(self, now: int, app: str, said: Utterance | None) -> None:
        """Something has been said to its end."""
        passed = said.passed(now) if said is not None else None
        if passed is not None:
            self._passed[app] = (passed[1], now - passed[2])

    def heard(self, began: int, app: str, said: Utterance | None) -> dict[str, Json]:
        """The last mark passed when the user began to speak (VoiceXML 2.1, 4).

        As :class:`prima.messages.Heard` has it; nothing for a question without marks, or for
        a prompt without them that is said before one.
        """
        if said is None or not said.command.cued("mark", "earlier"):
            return {}
        until = said.ends
        if said.command.args.get("bargein", True):
            until = min(until, began)
        passed = said.passed(until)
        if passed is not None:
            return {"markname": passed[1], "marktime": passed[2]}
        name, time = self._passed.get(app, ("", until + 1))
        if not said.command.cued("earlier") or time > until:
            return {"markname": None}
        return {"markname": name, "marktime": until - time}
