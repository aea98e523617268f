"""The mediator's orders to devices, and its notices to applications."""

from __future__ import annotations

from dataclasses import dataclass, field

from prima.messages.commands import NO_DEVICES, Command, Data, Fate, Json, Verb


@dataclass(slots=True, eq=False)
class Order:
    """To the devices: start an AB's Command, abort it, or stop what still moves (F5).

    ``interrupt`` is an abort of an AB that will start again: the device reports how much it had done.
    """

    verb: Verb
    """The action."""
    behavior: str
    """The AB's name in the transcript."""
    command: Command | None = None
    """Its Command."""
    devices: frozenset[str] = NO_DEVICES
    """Those that the Command occupies."""
    loop: int = 0
    """Which loop of a feedback Command begins."""
    resumed: bool = False
    """Whether the Command starts afresh after an interruption."""
    beside: bool = False
    """Whether another motion goes on on the same devices, to be composed with (X5)."""
    app: str = ""
    """The application."""
    data: Json = None
    """For ``send``: the service and what it is sent. For a ``start`` after an interruption: the
    mark to go on from, as the device reported it (:class:`Halted`)."""

    @property
    def serial(self) -> int:
        """The serial number of an application's message (``send``)."""
        return int(self.behavior.rpartition("!")[2])


@dataclass(slots=True, eq=False)
class Notice:
    """The fate of Commands: ``ended``, ``done`` (a whole run), ``cancelled`` or ``failed``.

    ``interrupted`` says how much was done of one that will start again (X2). ``cause`` is the
    event that a refused request was to react to: what is asked for instead does (C5).
    """

    what: Fate
    run: int
    command: Command | None = None
    data: Data = field(default_factory=dict)
    event: str = ""
    message: str = ""
    cause: int | None = None


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
