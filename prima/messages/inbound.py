"""What comes in."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from prima.messages.commands import Data, Json


@dataclass(slots=True)
class Ended:
    """A device reports the end of an AB; ``goal`` tells whether a feedback loop is done."""

    behavior: str
    goal: bool = True
    data: Data = field(default_factory=dict)


@dataclass(slots=True)
class Listening:
    """The question has been said: the robot now listens."""

    behavior: str


@dataclass(slots=True)
class Halted:
    """A device tells how much it had done of an AB that was interrupted (rule X2)."""

    behavior: str
    data: Data = field(default_factory=dict)
    """``done``: the part of it, 0 to 1; ``heard``: the beginning of the text that was said.
    Of a text with marks also ``passed``, how many, and ``mark``, the name of the last."""


@dataclass(slots=True)
class Failed:
    """A device could not do it (rule E1)."""

    behavior: str
    device: str
    reason: str


@dataclass(slots=True)
class Delayed:
    """What begins on a device was held back until the device had stopped what it did before."""

    behavior: str
    device: str
    waited: int
    """How long (ms)."""


@dataclass(slots=True)
class Presence:
    """A device is missing from now on, or there again."""

    device: str
    there: bool
    reason: str = ""


class Hypothesis(NamedTuple):
    """What a recogniser takes an utterance for, and how sure it is (0 to 1)."""

    text: str
    confidence: float = 1.0


class Understood(NamedTuple):
    """What an application makes of an utterance, and of which hypothesis."""

    value: Json
    utterance: str
    confidence: float = 1.0


@dataclass(slots=True)
class Heard:
    """The user said something (rule V1)."""

    text: str
    data: Data = field(default_factory=dict)
    """Of a recogniser that tells: ``confidence``, how sure it is of the text (0 to 1; 1 if it does
    not tell), and ``alternatives``, what else it may have been, each an object with ``text`` and
    ``confidence``. Of a question with marks: ``markname``, the last one passed when the user began to speak,
    or None, and ``marktime``, the ms that were played from there on. Of a recording:
    ``duration``, its ms, and ``maxtime``, whether it was cut off; of one that is a file, which is
    the text, also ``size``, its bytes, and ``type``, its media type. ``toolong``: it took longer than
    the question lets it (``longest``)."""
    lasted: int = 0
    """How long (ms) it took to say, where that is known: the user began so long ago (X10)."""

    @property
    def hypotheses(self) -> list[Hypothesis]:
        """What it may have been, the likeliest first; of equal ones in the order given."""
        others = self.data.get("alternatives")
        told = [one for one in others if isinstance(one, dict)] if isinstance(others, list) else []
        found = [Hypothesis(self.text, _confidence(self.data))]
        found += [Hypothesis(str(one.get("text", "")), _confidence(one)) for one in told]
        return sorted(found, key=lambda one: -one.confidence)

    def filled(self, answer: Understood) -> dict[str, Json]:
        """The data of the end of a question that it answers."""
        told = {name: value for name, value in self.data.items() if name != "alternatives"}
        if "confidence" in told or answer.utterance != self.text:
            told["confidence"] = answer.confidence
        return {"outcome": "filled", "utterance": answer.utterance, "value": answer.value, **told}


def _confidence(data: Data) -> float:
    """How sure a recogniser is, 0 to 1; 1 where it does not tell."""
    told = data.get("confidence")
    sure = isinstance(told, int | float) and not isinstance(told, bool) and 0 <= told <= 1
    return float(told) if sure and told is not None else 1.0


@dataclass(slots=True)
class Occurred:
    """An event for every application, or for ``app`` alone (a service's answer)."""

    name: str
    actor: Literal["user", "environment", "robot", "mediator"] = "environment"
    data: Data = field(default_factory=dict)
    app: str | None = None


@dataclass(slots=True)
class Fetched:
    """The answer to what an application has asked a URI for (a VoiceXML document, data, ...).

    ``serial`` is the :class:`Send`'s. ``problem`` tells why there is no answer; ``status`` is
    that of a host, or 0. ``body`` is text that ``charset`` makes the resource's bytes of.
    ``host`` is whether a real host has sent it, and no service of the scenario.
    """

    app: str
    serial: int
    uri: str
    body: str = ""
    charset: Literal["utf-8", "latin-1"] = "utf-8"
    status: int = 0
    problem: str = ""
    host: bool = False


@dataclass(slots=True)
class Transferred:
    """What has become of a call that an application makes (VoiceXML 2.0, 2.3.7).

    ``serial`` is the :class:`Send`'s. ``outcome`` is ``answered``, after which another one tells
    the call's end; how it has ended, as ``busy``; or the name of an event, as ``error.connection``.
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
    """Something a reader of the transcript wants to know, and nobody else."""

    actor: Literal["user", "environment"]
    text: str


@dataclass(slots=True)
class Emergency:
    """The emergency stop is pressed, or released with or without resuming (E5)."""

    pressed: bool
    resume: bool = True


@dataclass(slots=True)
class ApplicationLoaded:
    """An application starts; ``place`` is where the robot has entered, if that is why."""

    app: str
    place: str = ""
    connection: Data = field(default_factory=dict)
    """What is known of the user's connection: ``session.connection`` (VoiceXML 2.0, 5.1.4)."""


@dataclass(slots=True)
class ApplicationUnloaded:
    """An application is taken out of the robot (rule E2); ``place`` is what it has left."""

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
