"""The messages of applications."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from prima.messages.commands import Command, Data, Step


@dataclass(slots=True)
class Request:
    """Commands sent together (rule U3). ``run`` identifies them in notices of their end."""

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
    """The words to say first when its stream resumes after others have spoken (rule X9)."""
    fresh: int | None = None
    """How long (ms) a reaction is worth starting (rule X8)."""


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
    fresh: int | None = None
    """For how long (ms) a reaction is worth starting (X8)."""


@dataclass(slots=True)
class CloseUnit:
    """The unit is left in any way."""

    unit: int


@dataclass(slots=True)
class LeaveState:
    """A state of the document is left (rule O3)."""

    state: int


@dataclass(slots=True)
class Send:
    """A message to a named service, or a request to a URI.

    ``data`` has the values sent as ``params`` and, if an answer is awaited as a
    :class:`Fetched`, the ``method``, ``get`` or ``post``. A call to somebody else has its kind
    as ``transfer`` (``bridge``, ``blind``, ``consultation``) and ends with
    :class:`Transferred`; ``over`` ends the call whose serial is ``call``.
    """

    service: str
    data: Data
    serial: int
    source: str = ""


@dataclass(slots=True)
class Say:
    """Something for the transcript: a log element, an unhandled error."""

    level: Literal["log", "error"]
    text: str
    source: str = ""


@dataclass(slots=True)
class Quit:
    """The application has ended."""

    reason: str
    failed: bool = False


@dataclass(slots=True)
class Raise:
    """An event that the application has defined for itself (C6)."""

    event: str


@dataclass(slots=True)
class Promote:
    """An event of the application's own becomes one to react to (C5): it gets a serial number.

    The next request whose cause is :data:`PROMOTED` reacts to it.
    """

    event: str


@dataclass(slots=True)
class GoOn:
    """The events that were raised when a state was entered are handled: its content may begin."""

    state: int


Action = Request | OpenUnit | CloseUnit | LeaveState | Send | Say | Raise | Promote | GoOn | Quit
