"""Atomic Behaviors, Communication Streams, and the mediator's data on applications.

An AB tree *is* a Communication Stream (thesis 4.4): a :class:`Stream` holds the
ABs of its trees, and each :class:`Behavior` its parents and children. A feedback
Command is one :class:`Behavior` that runs once for every loop; each loop is an
AB of its own in the transcript, named ``ea#5.1``, ``ea#5.2``, ... (rule U2).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, Literal

from prima.language.commands import CommandType
from prima.messages import Command, Data, Group
from prima.scheduler.robot_state import Effects

HIGH: Final = 1
State = Literal["linked", "waiting", "running", "gone"]
"""The states of an AB in working memory (thesis Figure 4.3) and outside it."""
LINKED: Final = "linked"
WAITING: Final = "waiting"
RUNNING: Final = "running"
GONE: Final = "gone"


@dataclass(slots=True, eq=False)
class Stream:
    """A Communication Stream: it ends when nothing keeps it open (rule C1)."""

    name: str
    app: Application
    members: dict[str, Behavior] = field(default_factory=dict)
    turn: int = 0
    """When one of its ABs started last, as a counter; 0 before the first (S2b, S2d)."""
    spoken: bool = False
    """Whether an AB of it has spoken (F6)."""
    causes: set[int] = field(default_factory=set)
    """Serial numbers of the events that the stream has reacted to (F2)."""
    suspended: bool = False
    """Whether another stream has taken the floor and no AB of this one has started since (C2)."""
    waits: bool = False
    """Whether another application has kept an AB of it waiting since it was suspended (C2)."""
    answered: int | None = None
    """The instant in which the user last answered one of its questions, if ever (E6)."""
    place: int = 0
    """When the stream was suspended, as a counter: the greatest was suspended last (S2d). One
    that resumes keeps its place until the selection is over; 0 for others."""
    moved_away: bool = False
    """Whether the robot may have been moved since one of its ABs relied on its state (X1)."""
    effects: Effects = field(default_factory=Effects)
    """How its Commands have changed the robot's state (X1)."""
    hold: int | None = None
    """How long (ms) the stream is kept open for an event, by its latest request (X3)."""
    hold_state: int = 0
    """The document's state that gave this hint."""
    words: Command | None = None
    """The words to say when the stream resumes, by its latest request (X9)."""
    words_due: bool = False
    """Whether another application has spoken since the stream was suspended (X9)."""
    held_until: int | None = None
    """Until when it is held (ms); None if it is not."""

    @property
    def open(self) -> bool:
        """Whether the stream has an AB in working memory, or is held (C1, X3).

        This is not used while a window is open: streams end in the selection, after all windows.
        """
        return bool(self.members) or self.held_until is not None

    @property
    def runs(self) -> bool:
        """Whether an AB of the stream runs."""
        return any(ab.state is RUNNING for ab in self.members.values())

    def present(self) -> list[Behavior]:
        """The running and waiting ABs; linked ABs do not compete."""
        return [ab for ab in self.members.values() if not ab.dormant]

    def contending(self) -> list[Behavior]:
        """The same for F2 and K1: an inserted AB counts as the one it was inserted for (X1, X4)."""
        return [one for ab in self.members.values() if not ab.dormant for one in ab.meant()]

    def latest(self) -> Behavior | None:
        """The latest of its ABs in memory that its application has requested, if any (O1)."""
        return next(
            (ab for ab in reversed(self.members.values()) if ab.unit is None and not ab.inserted),
            None,
        )


@dataclass(slots=True, eq=False)
class Application:
    """The mediator's data on an application, without its documents."""

    name: str
    kind: str
    order: int
    latest: Behavior | None = None
    """The latest AB that it has requested outside units."""
    window: Stream | None = None
    """The stream in whose window it handles the end of a Command (C3)."""
    continuing: Stream | None = None
    """A stream that O3 cancelled: requests of this instant continue it."""
    units: dict[int, Behavior] = field(default_factory=dict)
    """Its units that span questions (U5), by the numbers that it gave them."""
    members: dict[str, Behavior] = field(default_factory=dict)
    """Its ABs in working memory, in the order of their requests."""
    last_turn: int = -1
    """When one of its ABs started last, as a counter (policy ``fair``)."""
    gone: bool = False


@dataclass(slots=True)
class AwaitedRun:
    """Commands that an application sent together and whose end it awaits."""

    number: int
    left: int
    begun: bool = False
    """Whether any of them has started."""


@dataclass(slots=True)
class Wait:
    """How an AB waits, from when it may compete until it starts."""

    blocked: tuple[str, str] = ("", "")
    """The rule that keeps it from starting, and the AB or stream that the rule protects."""
    loops: int = 0
    """How many loops of another application's feedback Command it has waited (E4)."""
    since: int | None = None
    """Since when (ms) another application keeps it waiting; None if none does."""
    starves: bool = False
    """Whether that has been reported."""
    kept: int = 0
    """How long (ms) others have kept it from the speaker, with no rule to do so (E6)."""
    kept_since: int | None = None
    """Since when (ms) they have done so; None if they do not."""
    overdue: bool = False
    """Whether they have done so for the maximum time."""

    def end(self) -> None:
        """The AB starts. One that it was put in for (X4, X9) goes on with the counts."""
        self.blocked, self.since, self.kept_since = ("", ""), None, None


@dataclass(slots=True, eq=False)
class Inside:
    """The contents of a unit (U4, U5)."""

    spans: bool = False
    """Whether the unit spans questions and states (U5)."""
    open: bool = False
    """Whether more may be added: it does not end when it is empty."""
    members: dict[str, Behavior] = field(default_factory=dict)
    """The unit's own ABs that are in working memory."""
    busy: dict[str, Behavior] = field(default_factory=dict)
    """Which of those use the unit's devices."""
    latest: Behavior | None = None
    """The latest of its Commands (O1)."""


@dataclass(slots=True, eq=False)
class Behavior:
    """An Atomic Behavior (thesis Figure 4.2): of one Command, or of a unit of them."""

    name: str
    serial: int
    app: Application
    stream: Stream
    type: CommandType | None
    """Its Command's row of Table 4.2; None for a unit."""
    command: Command | None
    devices: frozenset[str]
    requested: int
    document_state: int
    group: Group | None = None
    run: AwaitedRun | None = None
    unit: Behavior | None = None
    """The unit that it is in."""
    inside: Inside | None = None
    """Its contents, if it is a unit."""
    state: State = WAITING
    reaction: int | None = None
    """The serial number of the event reacted to: the reactive flag, until the AB starts (C5)."""
    stale: int | None = None
    """From when (ms) on a reaction that has not started is no longer worth starting (X8)."""
    parent: str | None = None
    waits_for: set[str] = field(default_factory=set)
    children: list[Behavior] = field(default_factory=list)
    freed: int | None = None
    """The instant in which the AB's parent ended or its window opened, if either did (S2c)."""
    wait: Wait = field(default_factory=Wait)
    loop: int = 0
    """The number of a feedback Command's loop that is running, or ran last (U2)."""
    resumed: bool = False
    listening: bool = False
    silent: bool = False
    """Whether nobody is notified of its end any more; the loop that runs is then the last."""
    left: bool = False
    """Whether its state has been left (O3): a question then ends as soon as it listens."""
    connect: bool = False
    """Whether the robot has to face the user before the AB starts (X4)."""
    inserted: str = ""
    """The rule by which the mediator itself inserted the AB (X1, X4, X9)."""
    motion: str = ""
    """How it moves the robot, ``faithful`` or ``free`` in its path, if it may be composed (X5)."""
    reacted: int = -1
    """The event to which it reacts, if it is a reaction: it yields to later ones (X2)."""
    begun: bool = False
    """Whether the AB has ever started."""
    restarting: bool = False
    """Whether the AB was interrupted and has not started again (X2)."""
    since: Data | None = None
    """The mark from which it resumes after an interruption, as its device reported it (X2)."""
    late: int | None = None
    """When it will have run for too long (U5, E1), once it has started."""
    id: str = field(init=False)
    """The AB's name in the transcript; a loop of a feedback Command has its number (U2)."""
    feedback: bool = field(init=False)
    """Whether the Command makes one loop after another (U2)."""
    leaves: bool = field(init=False)
    """Whether the AB leaves the user; an AB in a unit never does (K2)."""
    engages: bool = field(init=False)
    """Whether the AB engages the user (K1)."""
    priority: int = field(init=False)
    """1 (high) or 0 (low), by K2."""

    def __post_init__(self) -> None:
        row = self.type
        self.id = self.name
        self.feedback = row is not None and row.feedback
        self.leaves = row is not None and row.leaves
        self.engages = row is not None and row.engages
        self.priority = HIGH if row is None else row.priority

    @property
    def what(self) -> Command | Group:
        """Its Command or, if it is a unit, the group."""
        what = self.command or self.group
        assert what is not None
        return what

    @property
    def in_order(self) -> list[str]:
        """Its devices in the order in which they are checked and reported."""
        return sorted(self.devices)

    @property
    def asks(self) -> bool:
        """Whether it is or contains a question, which lasts as long as the user thinks."""
        return "speech-recognition" in self.devices

    @property
    def inner(self) -> dict[str, Behavior]:
        """The ABs inside it, if it is a unit."""
        return self.inside.members if self.inside is not None else {}

    @property
    def spans(self) -> bool:
        """Whether it is a unit that spans questions and states (U5)."""
        return self.inside is not None and self.inside.spans

    @property
    def in_group(self) -> bool:
        """Whether the AB is part of a unit and shares the unit's fate (U4)."""
        return self.unit is not None and not self.unit.spans

    @property
    def dormant(self) -> bool:
        """Whether the AB, or the unit around it, is linked: it neither runs nor waits."""
        return self.state is LINKED or (self.unit is not None and self.unit.dormant)

    @property
    def restartable(self) -> bool:
        """Whether the AB gives way to a reaction and starts again (X2)."""
        return self.what.restartable and not self.silent

    @property
    def says(self) -> bool:
        """Whether the robot speaks meanwhile; a unit that owns the speaker counts (F6, X9)."""
        wordless = self.command is not None and not self.command.text
        return "speaker" in self.devices and not wordless

    def next_loop(self) -> None:
        """U2: begin another loop of a feedback Command: an AB with a name of its own."""
        if self.loop:
            self.parent = self.id
        self.loop += 1
        self.id = f"{self.name}.{self.loop}"

    def meant(self) -> list[Behavior]:
        """The AB itself, or those in memory for which it was inserted (X1, X4, X9)."""
        if not self.inserted:
            return [self]
        behind = [
            one for child in self.children if child.state is not GONE for one in child.meant()
        ]
        return behind or [self]


def application(name: str) -> str:
    """The application of an AB or a stream."""
    return name.partition("#")[0].partition(":")[0]
