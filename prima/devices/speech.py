"""The robot's speech: its progress, and the marks it has passed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from prima.devices import voice
from prima.messages import Command, Cue, Json, Order

ABOUT_ALL = ("earlier", "hotword", "record", "finalsilence", "longest")
"""Cues that belong to a question as a whole, not to a place in its text."""

MOST_MARKS = 1000
"""How many marks passed before what is being said are known; a user may begin to speak then."""


@dataclass(slots=True)
class Utterance:
    """A text that the robot says, from ``began`` to ``ends`` (ms)."""

    command: Command
    began: int
    ends: int
    timeline: voice.SpeechTimeline | None = None
    """When its letters and marks are said, if it has cues."""
    skipped: int = 0
    """How much (ms) had been said before an interruption (X2)."""
    marks: int = 0
    """How many marks had been passed by then: it resumes from the last of these."""

    @classmethod
    def of(cls, now: int, order: Order, rates: dict[str, float]) -> Utterance | None:
        """The speech that an order begins, if any.

        Args:
            now: the time (ms).
            order: a ``start``; after an interruption it may name the mark to resume from (X2).
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
        marks = order.data["passed"] if order.data else 0
        skipped = round(timeline.marks[marks - 1][0]) if marks else 0
        ends = now + max(timeline.total - skipped, 1)
        return cls(command, now, ends, timeline, skipped, marks)

    @property
    def since(self) -> int:
        """The number of characters of the text after which it resumes."""
        return marks_of(self.command)[self.marks - 1].at if self.marks else 0

    def left(self) -> Command:
        """The Command with the rest of its text."""
        command, since = self.command, self.since
        if not self.marks:
            return command
        mark = marks_of(command)[self.marks - 1]
        index = next(at for at, cue in enumerate(command.cues) if cue is mark)
        before = command.cues[:index]
        rates = [replace(cue, at=0) for cue in before if cue.kind == "rate"]
        cues = [cue for cue in before if cue.kind in ABOUT_ALL] + rates[-1:]
        cues += [replace(cue, at=cue.at - since) for cue in closed(command.cues[index + 1 :])]
        return replace(command, text=(command.text or "")[since:], cues=tuple(cues))

    def passed(self, now: int) -> tuple[int, str, int] | None:
        """The number of marks passed, the last one's name, and the ms since then."""
        played = self.skipped + now - self.began
        count = self.timeline.passed(played) if self.timeline is not None else 0
        if self.timeline is None or not count:
            return None
        time, name = self.timeline.marks[count - 1]
        return count, name, round(played - time)

    def marks_passed(self, now: int) -> list[tuple[int, str]]:
        """The marks passed, each with its time; of a resumed text from where it resumes on."""
        passed = self.passed(now)
        if self.timeline is None or passed is None:
            return []
        marks = self.timeline.marks[max(self.marks - 1, 0) : passed[0]]
        return [(self.began - self.skipped + round(time), name) for time, name in marks]

    def share(self, said: int) -> float:
        """How much of the text has been said (0 to 1) after so many characters of its rest."""
        return min((self.since + said) / max(len(self.command.text or ""), 1), 1.0)

    def heard(self, now: int, said: int | None = None) -> dict[str, Json]:
        """How much of it has been heard, in the form of :class:`prima.messages.Halted`.

        Args:
            now: the time, from which this is computed if the device does not report it.
            said: how many characters of the rest have been said, if it does.
        """
        if said is not None:
            return self._heard_to(self.since + said)
        if self.timeline is None:
            share = (now - self.began) / max(self.ends - self.began, 1)
            text = self.command.text or ""
            return {"heard": voice.beginning(text, self.command.lang, share)} if text else {}
        data: dict[str, Json] = {"heard": self.timeline.heard(now - self.began + self.skipped)}
        passed = self.passed(now)
        if passed is not None:
            data["passed"], data["mark"] = passed[:2]
        return data

    def _heard_to(self, count: int) -> dict[str, Json]:
        """The same after so many characters of the whole text."""
        text = self.command.text or ""
        data: dict[str, Json] = {"heard": voice.whole_words(text, count)} if text else {}
        passed = [cue for cue in marks_of(self.command) if cue.at <= count]
        if passed:
            data["passed"], data["mark"] = len(passed), passed[-1].value
        return data


def marks_of(command: Command) -> list[Cue]:
    """The marks of a text, in order."""
    return [cue for cue in command.cues if cue.kind == "mark"]


def closed(cues: Iterable[Cue]) -> Iterator[Cue]:
    """Cues without those that end something begun before them."""
    inside = 0
    for cue in cues:
        inside += {"lasts": 1, "end": -1}.get(cue.kind, 0)
        if inside < 0:
            inside = 0
        else:
            yield cue


class SpeechMarks:
    """The marks that each application's speech has passed, with their times."""

    def __init__(self) -> None:
        self._passed: dict[str, list[tuple[int, str]]] = {}

    def end(self, now: int, app: str, said: Utterance | None) -> None:
        """Note that something has been said to its end."""
        passed = said.marks_passed(now) if said is not None else []
        if said is None or not passed:
            return
        goes_on = bool(said.marks) or said.command.cued("earlier")
        before = self._passed.get(app, []) if goes_on else []
        self._passed[app] = [*before, *passed][-MOST_MARKS:]

    def heard(self, began: int, app: str, said: Utterance | None) -> dict[str, Json]:
        """The last mark passed when the user began to speak (VoiceXML 2.1, 4).

        It has the form of :class:`prima.messages.Heard`; it is empty for a question without marks,
        and for a prompt without marks that precedes one.
        """
        if said is None or not said.command.cued("mark", "earlier"):
            return {}
        until = said.ends
        if said.command.args.get("bargein", True):
            until = min(until, began)
        passed = said.passed(until)
        if passed is not None:
            return {"markname": passed[1], "marktime": passed[2]}
        known = self._passed.get(app, []) if said.command.cued("earlier") else []
        time, name = next((one for one in reversed(known) if one[0] <= until), (until, None))
        return {"markname": None} if name is None else {"markname": name, "marktime": until - time}
