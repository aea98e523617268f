"""The state of a running VoiceXML application, and the ways in which control leaves content."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field

from prima.interpreter.selection import Counters
from prima.interpreter.transfers import Thrown, Transfer
from prima.markup.tree import Node
from prima.messages import Data, Event, Json
from prima.script.evaluation import Scope
from prima.voicexml.document import Page

SCOPES = ("session", "application", "document", "dialog", "anonymous")
"""Outermost first (5.1.2)."""


@dataclass(slots=True)
class Resume:
    """The end of a wait: the run's data, or an event from outside."""

    data: Data = field(default_factory=dict)
    event: Event | None = None
    outside: bool = False
    """Whether the event is not what was waited for, but arrived meanwhile."""


Flow = Generator[None, Resume, None]


@dataclass(frozen=True, slots=True)
class UriRequest:
    """The method and values of a submit, subdialog or data that go along with a URI."""

    method: str = "get"
    values: Mapping[str, Json] = field(default_factory=dict)


@dataclass(slots=True)
class TakenUtterance:
    """An utterance that an active grammar has taken (5.1.5)."""

    utterance: str
    interpretation: Json
    owner: Node
    page: Page
    confidence: float = 1.0
    mode: str = "voice"
    others: list[tuple[str, Json, float]] = field(default_factory=list)
    """Further results, best first, as utterance, interpretation and confidence."""
    recognised: bool = True
    """Whether a grammar took it, rather than a record."""
    mark: str | None = None
    """The last mark passed before it; the prompts' last mark for devices that report none."""
    marktime: int | None = None
    """How much (ms) was played from that mark on, if that is known (VoiceXML 2.1, 4)."""

    recorded: int | None = None
    """How long (ms) its recording is, if it was recorded (VoiceXML 2.1, 7)."""

    def take_mark(self, data: Data) -> None:
        """Take over the marks that the device reports, if any (:class:`prima.messages.Heard`)."""
        if "markname" in data:
            self.mark, self.marktime = data["markname"], data.get("marktime")


@dataclass(slots=True)
class Params:
    """Params of a subdialog that it has not declared yet (2.3.4)."""

    values: Scope
    names: dict[str, None] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class Context:
    """One execution context: the application's own, or a subdialog's (2.3.4)."""

    session: Scope
    page: Page
    application: Scope
    document: Scope
    dialog: Scope
    root: Page | None = None
    form: Node | None = None
    unit: Node | None = None
    """The ``p:iu`` around form items in which the dialog is (rule U5)."""
    item: Node | None = None
    counters: Counters = field(default_factory=Counters)
    """Of events and prompts, by the index of an item; -1 for the dialog."""
    visited: set[int] = field(default_factory=set)
    """Items without a name that have been visited: their guards are set."""
    params: Params | None = None
    depth: int = 0
    caller: Context | None = None
    """The context whose subdialog this is."""
    quiet: bool = False
    """Whether the next item is visited without its prompts (5.3.6)."""

    def scopes(self, local: Scope) -> tuple[Scope, ...]:
        """All scopes of content, outermost first."""
        return (self.session, self.application, self.document, self.dialog, local)


class UnitOver(Thrown):
    """A unit around form items has taken longer than its longest duration (rule U5)."""


HANGUP = "connection.disconnect.hangup"
"""The event of a user who hangs up, or whom the application disconnects (5.2.6)."""


class HungUp(Thrown):
    """The user has left or is about to: a hangup, a disconnect, a transfer (1.5.4)."""

    def __init__(
        self, name: str, message: str = "", source: str = "", outside: bool = False
    ) -> None:
        super().__init__(name, message, source)
        self.outside = outside


def thrown_outside(resume: Resume) -> Thrown:
    """The event that ended a wait."""
    assert resume.event is not None
    thrown = thrown_of_event(resume.event)
    thrown.outside = thrown.outside or resume.outside
    return thrown


def thrown_of_event(event: Event) -> Thrown:
    """An event of the session as one of VoiceXML."""
    message = str(event.data.get("message", ""))
    if event.name.startswith("connection.disconnect"):
        return HungUp(event.name, message, outside=True)
    thrown = Thrown(event.name, message)
    own = event.name == "message" or event.name.startswith("connection.")
    thrown.shared = event.shared and not own
    return thrown


class Unasked(Thrown):
    """A parameter for which a subdialog has no variable; unhandled, it is thrown in the caller."""


class GoDialog(Transfer):
    """A goto or submit, or an utterance that another dialog's grammar took."""

    def __init__(
        self,
        page: Page | None,
        dialog: str,
        heard: TakenUtterance | None = None,
        submitted: bool = False,
    ) -> None:
        super().__init__(dialog)
        self.submitted = submitted
        """Whether a submit leads there: a root that a leaf submits to starts anew (1.5.2)."""
        self.page = page
        self.dialog = dialog
        self.heard = heard
