"""The messages that come in."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from prima.messages.commands import Data, Json


@dataclass(slots=True)
class Ended:
    """A device reports the end of an AB; ``goal`` says whether a feedback loop is done."""

    behavior: str
    goal: bool = True
    data: Data = field(default_factory=dict)


@dataclass(slots=True)
class Listening:
    """The question has been asked: the robot now listens."""

    behavior: str


@dataclass(slots=True)
class Halted:
    """A device reports how much it had done of an interrupted AB (rule X2)."""

    behavior: str
    data: Data = field(default_factory=dict)
    """``done``: the share of it, 0 to 1; ``heard``: the beginning of the text that was said.
    For a text with marks also ``passed``, how many, and ``mark``, the name of the last."""


@dataclass(slots=True)
class Failed:
    """A device could not do it (rule E1)."""

    behavior: str
    device: str
    reason: str


@dataclass(slots=True)
class Delayed:
    """An AB was held back until a device had stopped what it did before."""

    behavior: str
    device: str
    waited: int
    """How long (ms)."""


@dataclass(slots=True)
class Presence:
    """A device is missing from now on, or available again."""

    device: str
    there: bool
    reason: str = ""


class Hypothesis(NamedTuple):
    """A recogniser's hypothesis for an utterance, with its confidence (0 to 1)."""

    text: str
    confidence: float = 1.0


class Understood(NamedTuple):
    """An application's interpretation of an utterance, and the hypothesis used."""

    value: Json
    utterance: str
    confidence: float = 1.0


@dataclass(slots=True)
class Heard:
    """The user said something (rule V1)."""

    text: str
    data: Data = field(default_factory=dict)
    """From a recogniser that reports them: ``confidence``, how sure it is of the text (0 to 1; 1 if it does
    not tell), and ``alternatives``, what else it may have been, each an object with ``text`` and
    ``confidence``. Of a question with marks: ``markname``, the last one passed when the user began to speak,
    or None, and ``marktime``, the ms that were played from there on. Of a recording:
    ``duration``, its ms, and ``maxtime``, whether it was cut off; of one that is a file, which is
    the text, also ``size``, its bytes, and ``type``, its media type. ``toolong``: it took longer than
    the question lets it (``longest``)."""
    lasted: int = 0
    """How long (ms) it took to say, if known: the user began so long ago (X10)."""

    @property
    def hypotheses(self) -> list[Hypothesis]:
        """The hypotheses, likeliest first; equal ones in the given order."""
        others = self.data.get("alternatives")
        hypotheses = (
            [one for one in others if isinstance(one, dict)] if isinstance(others, list) else []
        )
        found = [Hypothesis(self.text, _confidence(self.data))]
        found += [Hypothesis(str(one.get("text", "")), _confidence(one)) for one in hypotheses]
        return sorted(found, key=lambda one: -one.confidence)

    def filled(self, answer: Understood) -> dict[str, Json]:
        """The data of the end of a question that it answers."""
        data = {name: value for name, value in self.data.items() if name != "alternatives"}
        if "confidence" in data or answer.utterance != self.text:
            data["confidence"] = answer.confidence
        return {"outcome": "filled", "utterance": answer.utterance, "value": answer.value, **data}


def _confidence(data: Data) -> float:
    """A recogniser's confidence, 0 to 1; 1 if it does not report one."""
    given = data.get("confidence")
    sure = isinstance(given, int | float) and not isinstance(given, bool) and 0 <= given <= 1
    return float(given) if sure and given is not None else 1.0


@dataclass(slots=True)
class Occurred:
    """An event for every application, or for ``app`` alone (a service's answer)."""

    name: str
    actor: Literal["user", "environment", "robot", "mediator"] = "environment"
    data: Data = field(default_factory=dict)
    app: str | None = None


@dataclass(slots=True)
class Fetched:
    """The answer to an application's request to a URI (a VoiceXML document, data, ...).

    ``serial`` is the :class:`Send`'s. ``problem`` says why there is no answer; ``status`` is
    a host's, or 0. ``body`` is text which, encoded by ``charset``, gives the resource's bytes.
    ``host`` is whether a real host has sent it, rather than a service of the scenario; ``moved``
    is the URI to which that has redirected the request, if it has.
    """

    app: str
    serial: int
    uri: str
    body: str = ""
    charset: Literal["utf-8", "latin-1"] = "utf-8"
    status: int = 0
    problem: str = ""
    host: bool = False
    moved: str = ""


@dataclass(slots=True)
class Transferred:
    """The progress or end of an application's call (VoiceXML 2.0, 2.3.7).

    ``serial`` is the :class:`Send`'s. ``outcome`` is ``answered``, after which another one reports
    the call's end; how it ended, such as ``busy``; or an event, such as ``error.connection``.
    """

    app: str
    serial: int
    uri: str
    outcome: str


@dataclass(slots=True)
class Sensed:
    """Sensor values that changed, by dotted name (rule C6)."""

    values: Data


@dataclass(slots=True)
class Narrated:
    """A note for readers of the transcript only."""

    actor: Literal["user", "environment"]
    text: str


@dataclass(slots=True)
class Emergency:
    """The emergency stop is pressed, or released with or without resuming (E5)."""

    pressed: bool
    resume: bool = True


@dataclass(slots=True)
class ApplicationLoaded:
    """An application starts; ``place`` is the place that the robot has entered, if that is why."""

    app: str
    place: str = ""
    connection: Data = field(default_factory=dict)
    """The user's connection: ``session.connection`` (VoiceXML 2.0, 5.1.4)."""


@dataclass(slots=True)
class ApplicationUnloaded:
    """An application is removed from the robot (rule E2); ``place`` is what the robot left."""

    app: str
    place: str = ""


Inbound = (
    Ended
    | Listening
    | Halted
    | Failed
    | Delayed
    | Presence
    | Heard
    | Occurred
    | Fetched
    | Transferred
    | Sensed
    | Narrated
    | Emergency
    | ApplicationLoaded
    | ApplicationUnloaded
)
