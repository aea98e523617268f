"""The only words that applications, mediator and devices exchange.

Applications ask (:class:`Request`, :class:`OpenUnit`, :class:`CloseUnit`,
:class:`LeaveState`, :class:`Send`, ...), the mediator orders devices about
(:class:`Order`), and what happens comes in as one of the :data:`Inbound` values.
All of them are data: whoever receives one decides what it means.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal, NamedTuple

Json = Any
Data = Mapping[str, Json]
Record = dict[str, Json]
"""One line of the transcript while it is still being made: field name to value."""
Fate = Literal["ended", "done", "cancelled", "expired", "failed", "interrupted", "unit-timeout"]
"""What an application may be told of its Commands; ``expired``: a part of a run came too late (X8)."""
Verb = Literal["start", "abort", "interrupt", "stop", "send"]
"""What devices may be told to do."""
PROMOTED = -1
"""As a request's cause: the event that was promoted last."""
NO_DEVICES: frozenset[str] = frozenset()


def line_of(source: str) -> str | None:
    """The ``FILE:LINE`` of who asked, for a record, of a place with its column; none of nothing."""
    line = source.rpartition(":")[0]
    return line if line.rpartition(":")[2].isdigit() else source or None


BEEP: Final = "[beep]"
"""The signal before a recording, as it stands in a text."""


@dataclass(frozen=True, slots=True)
class Cue:
    """Something that goes with a text besides its words, for the device that says it.

    A device may leave cues alone, and simply speak. Those of one text stand in the order in
    which they come to pass; ``lasts`` and ``end`` enclose each other properly.
    """

    at: int
    """How many characters of the text stand before it."""
    kind: Literal[
        "pause",
        "sentence",
        "rate",
        "lasts",
        "end",
        "mark",
        "earlier",
        "hotword",
        "record",
        "finalsilence",
        "longest",
        "sound",
    ]
    """``pause``: silence of ``value`` ms. ``sentence``: the pause that a full stop makes.
    ``sound``: what stands before the next ``end`` is the sound ``value``, the signal ``[beep]`` or
    a recording that the device has made. ``rate``: from here on ``value`` times the usual rate. ``lasts``: what stands before its
    ``end`` takes ``value`` ms. ``mark``: a place named ``value``, to be told as passed.
    ``earlier``: marks of what the application said just before count for this question.
    ``hotword``: what the user says breaks off this question only if it is understood.
    ``record``: the answer is a recording, of which the device tells how long it is; one of
    ``value`` ms is the longest, and 0 is without end. ``finalsilence``: it is over after so many
    ms of silence. ``longest``: the device listens no longer than ``value`` ms to what the user
    says, and tells that it was too long."""
    value: float | str | None = None


@dataclass(slots=True)
class Command:
    """What an application asks for (thesis 4.1, Table 4.1)."""

    type: str
    args: dict[str, Json] = field(default_factory=dict)
    text: str | None = None
    now: bool = False
    extra: dict[str, Json] = field(default_factory=dict)
    lang: str = ""
    source: str = ""
    """Where the document asks for it: ``FILE:LINE:COLUMN``, as all such places here."""
    restartable: bool = False
    """Whether it gives way to a reaction and starts again afterwards (rule X2)."""
    cues: tuple[Cue, ...] = ()
    """Pauses, rates and marks of its text."""
    hook: Any = None
    """What the application keeps with the Command; nobody else looks at it."""

    def cued(self, *kinds: str) -> bool:
        """Whether its text has a cue of one of these kinds."""
        return any(cue.kind in kinds for cue in self.cues)


@dataclass(slots=True)
class Group:
    """Commands marked as one unit: one Atomic Behavior (rule U4)."""

    steps: list[Step]
    longest: int | None = None
    source: str = ""
    restartable: bool = False


@dataclass(slots=True)
class Step:
    """A node of a requested tree; ``after`` are indices of steps it waits for."""

    what: Command | Group
    after: tuple[int, ...] = ()


# What applications say ------------------------------------------------------


@dataclass(slots=True)
class Request:
    """Commands sent at once (rule U3). ``run`` names them when their end is told."""

    run: int
    steps: list[Step]
    state: int
    cause: int | None = None
    """Serial number of the event that this reacts to; sets the reactive flag (C5)."""
    unit: int | None = None
    hold: int | None = None
    """How long (ms) its stream is kept open for an event afterwards (rule X3)."""
    connect: bool = False
    """Whether the robot has to face the user first (rule X4)."""
    words: Command | None = None
    """What is said first when its stream resumes after others have spoken (rule X9)."""
    fresh: int | None = None
    """For how long (ms) a reaction is worth starting (rule X8)."""


@dataclass(slots=True)
class OpenUnit:
    """A unit that spans questions and states begins (rule U5)."""

    unit: int
    state: int
    devices: frozenset[str]
    longest: int | None = None
    cause: int | None = None
    source: str = ""
    connect: bool = False
    types: tuple[str, ...] = ()
    """Commands in it: those that the robot's profile adds have devices of their own."""


@dataclass(slots=True)
class CloseUnit:
    """The unit is left, by whatever way."""

    unit: int


@dataclass(slots=True)
class LeaveState:
    """A state of the document is left (rule O3)."""

    state: int


@dataclass(slots=True)
class Send:
    """A message to a named service, or to a URI that something is asked of.

    ``data`` has the values sent as ``params``, and where an answer is waited for as a
    :class:`Fetched` the ``method``, ``get`` or ``post``. A call to somebody else has its kind
    as ``transfer`` (``bridge``, ``blind``, ``consultation``) and is told of by
    :class:`Transferred`; ``over`` ends the one whose serial is ``call``.
    """

    service: str
    data: Data
    serial: int
    source: str = ""


@dataclass(slots=True)
class Say:
    """Something for the transcript: a log element, an error nobody handled."""

    level: Literal["log", "error"]
    text: str
    source: str = ""


@dataclass(slots=True)
class Quit:
    """The application has ended."""

    reason: str
    failed: bool = False
    source: str = ""


@dataclass(slots=True)
class Raise:
    """An event that the application itself has defined, for itself (C6)."""

    event: str


@dataclass(slots=True)
class Promote:
    """An event of the application's own counts as one to react to (C5): it gets a serial number.

    The next request whose cause is :data:`PROMOTED` reacts to it.
    """

    event: str


@dataclass(slots=True)
class GoOn:
    """The events that were raised when a state was entered are handled: its content may begin."""

    state: int


Action = Request | OpenUnit | CloseUnit | LeaveState | Send | Say | Raise | Promote | GoOn | Quit


# What comes in --------------------------------------------------------------


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


# What the mediator orders -----------------------------------------------------


class Order:
    """To the devices: start an AB's Command, abort it, or stop what still moves (F5).

    ``interrupt`` is an abort of what will start again: the device tells how much it had done.
    """

    __slots__ = (
        "app",
        "behavior",
        "beside",
        "command",
        "data",
        "devices",
        "loop",
        "resumed",
        "verb",
    )

    def __init__(
        self,
        verb: Verb,
        behavior: str,
        command: Command | None = None,
        devices: frozenset[str] = NO_DEVICES,
        loop: int = 0,
        resumed: bool = False,
        beside: bool = False,
        app: str = "",
        data: Json = None,
    ) -> None:
        """Make an order.

        Args:
            verb: what to do.
            behavior: the AB's name in the transcript.
            command: its Command.
            devices: those that the Command occupies.
            loop: which loop of a feedback Command begins.
            resumed: whether the Command starts afresh after an interruption.
            beside: whether another motion goes on on the same devices, to be composed with (X5).
            app: the application.
            data: for ``send``: the service and what it is sent. For a ``start`` after an
                interruption: the mark to go on from, as the device told it (:class:`Halted`).
        """
        self.verb = verb
        self.behavior = behavior
        self.command = command
        self.devices = devices
        self.loop = loop
        self.resumed = resumed
        self.beside = beside
        self.app = app
        self.data = data

    def __repr__(self) -> str:
        return f"Order({self.verb!r}, {self.behavior!r}, {self.command!r}, app={self.app!r})"


# What the mediator tells an application ------------------------------------------


class Notice:
    """The fate of Commands: ``ended``, ``done`` (a whole run), ``cancelled`` or ``failed``.

    ``interrupted`` tells how much was done of one that will start again (X2). ``cause`` is the
    event that a refused request was to react to: what is asked for instead does (C5).
    """

    __slots__ = ("cause", "command", "data", "event", "message", "run", "what")

    def __init__(
        self,
        what: Fate,
        run: int,
        command: Command | None = None,
        data: Data | None = None,
        event: str = "",
        message: str = "",
    ) -> None:
        self.what = what
        self.run = run
        self.command = command
        self.data: Data = {} if data is None else data
        self.event = event
        self.message = message
        self.cause: int | None = None

    def __repr__(self) -> str:
        return (
            f"Notice({self.what!r}, {self.run!r}, {self.command!r}, {self.data!r}, {self.event!r})"
        )


@dataclass(slots=True)
class Event:
    """Something that happened, as applications see it."""

    name: str
    serial: int
    """The number that the transcript has for it; 0 for what a record does not name."""
    data: Data = field(default_factory=dict)
    reactive: bool = True
    shared: bool = False
    """Whether it is of the robot and its surroundings, for every application alike (V1)."""
