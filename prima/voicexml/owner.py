"""What a VoiceXML interpreter's parts require of the whole and of each other.

The machine (:mod:`~prima.voicexml.machine`) runs the Form Interpretation Algorithm. Its parts
run content, listen, enter documents, fill items and handle events; they know each other, the
machine, and the application that owns it by what is here alone.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Generator, Sequence
from typing import Protocol

from prima.interpreter.protocol import App
from prima.interpreter.transfers import Thrown
from prima.markup.tree import Node
from prima.messages import Command, Data, Event, Json
from prima.script.evaluation import Scope
from prima.script.isolated import AnyEngine
from prima.voicexml.arranging import Queued
from prima.voicexml.document import Page, VoiceDocument
from prima.voicexml.queue import PromptQueue
from prima.voicexml.speech import Speech
from prima.voicexml.state import Context, Flow, Resume, TakenUtterance, UriRequest
from prima.voicexml.waits import Waits


class VoiceApplication(App[AnyEngine]):
    """The application, as its parts know it besides what every application has."""

    heard: TakenUtterance | None
    """The user's latest utterance, as a grammar took it."""
    marked: str | None
    """The last mark of what is being said."""
    waits: Waits
    """Its waits."""
    document: VoiceDocument
    """The document that it runs."""

    @abstractmethod
    def note_document(self, page: Page) -> None:
        """Note a loaded document, usable or not; its path is relative to the first one's."""


class VoiceContentRunner(Protocol):
    """Runs executable content, and evaluates what is in it."""

    def run(self, node: Node, context: Context, local: Scope) -> Flow:
        """Run an element's content."""

    def holds(self, node: Node, context: Context, local: Scope) -> bool:
        """An element's condition; one without holds."""

    def word(self, node: Node, name: str, context: Context, local: Scope) -> str:
        """An attribute, or its ``expr`` form, as a word."""

    def raised(self, node: Node, context: Context, local: Scope) -> Thrown:
        """The event that an element throws, with its message."""

    def sent(self, node: Node, names: list[str], context: Context, local: Scope) -> dict[str, Json]:
        """The values of variables by their names, as a request sends them."""

    def put(
        self, scope: Scope, name: str, node: Node, attribute: str, context: Context, local: Scope
    ) -> None:
        """Set a variable to the value of an attribute's expression."""

    def check_name(self, node: Node) -> None:
        """Refuse a name that no variable can have."""

    def declare(self, node: Node, scope: Scope, context: Context, local: Scope) -> None:
        """Declare a variable."""

    def script(self, node: Node, scope: Scope, context: Context, local: Scope) -> Flow:
        """Run a script."""

    def data(self, node: Node, scope: Scope, context: Context, local: Scope) -> Flow:
        """Fetch data (VoiceXML 2.1, 5)."""

    def say(self, text: str, lang: str, place: str) -> None:
        """Queue something to be said."""


class ListeningGrammars(Protocol):
    """Knows which grammars listen."""

    def activate(self, context: Context) -> None:
        """Load all that listens now."""

    def modes(self, context: Context) -> list[str]:
        """The kinds of input that the application takes (6.3.6)."""

    def noted(self, context: Context, text: str) -> tuple[str, str] | None:
        """An utterance that no grammar took, and its mode; None if such input is off."""

    def most_results(self, context: Context) -> int:
        """The maximum number of results (6.3.2)."""


class DocumentEntering(Protocol):
    """Enters the documents of the application."""

    session: Scope
    """The session's variables."""

    def root(
        self, page: Page, context: Context | None = None
    ) -> Generator[None, Resume, Page | None]:
        """The application root of a leaf."""

    def find(
        self, context: Context, uri: str, node: Node, request: UriRequest | None = None
    ) -> Generator[None, Resume, tuple[Page | None, str]]:
        """The dialog that a URI names, and its document where that is fetched."""

    def go(self, context: Context, uri: str, node: Node, request: UriRequest | None = None) -> Flow:
        """Follow a URI to a dialog (5.3.7)."""


class Recording(Protocol):
    """Fills the record items."""

    lengths: dict[str, int]
    """The lengths of recordings (ms), by their URIs."""

    def check(self, context: Context, item: Node) -> None:
        """Refuse a format in which nothing can be recorded."""

    def prepare(self, item: Node, question: Command) -> None:
        """Make a question ask for a recording."""

    def take(self, context: Context, item: Node, heard: TakenUtterance, data: Data) -> Flow:
        """Fill a record with what was said."""

    def broken_off(self, context: Context, item: Node, event: Event) -> None:
        """Keep what was recorded until the user hung up."""


class Filling(Protocol):
    """Fills the form items."""

    @property
    def recorder(self) -> Recording:
        """Fills those that record."""

    def process(self, context: Context, heard: TakenUtterance) -> Flow:
        """Pass what the user said to the item, form, link or choice that took it."""

    def remember(self, context: Context, heard: TakenUtterance) -> None:
        """Set ``application.lastresult$`` (5.1.5)."""

    def forget_results(self, context: Context) -> None:
        """Make ``application.lastresult$`` undefined, as input is waited for (5.1.5)."""

    def fill(
        self, context: Context, item: Node, value: Json, shadow: dict[str, Json] | None = None
    ) -> None:
        """Set the variable of an item, and its shadow variables."""

    def mark(self, context: Context, item: Node) -> None:
        """Visit an item no more."""

    def run_filled(self, context: Context, filled: list[Node]) -> Flow:
        """Run the ``filled`` elements of items that have just been filled."""


class Selecting(Protocol):
    """Selects the form items."""

    def guarded(self, context: Context, item: Node) -> bool:
        """Whether an item's variable is defined, so that it is not visited."""


class Catching(Protocol):
    """Handles events."""

    def taker(self, context: Context, thrown: Thrown) -> Node | None:
        """The handler that takes an event, if any."""


class MachineOwner(Protocol):
    """The machine: what is remembered while the application runs, and how it goes on."""

    pages: dict[str, Page]
    """Documents by their URIs."""
    resources: dict[str, bytes]
    """Resources of grammars that are not files, once they have been fetched."""
    hosted: dict[str, str]
    """Names and URIs that a real host, not a service, has answered, and where it did."""
    queue: PromptQueue
    """Prompts and Commands that are played when a wait is reached (4.1.8)."""
    reprompted: bool
    gone: str
    """The event by which the user left."""
    context: Context | None

    # Its parts:

    @property
    def app(self) -> VoiceApplication:
        """The application."""

    @property
    def engine(self) -> AnyEngine:
        """Evaluates its code."""

    @property
    def document(self) -> VoiceDocument:
        """The document that it runs."""

    @property
    def content(self) -> VoiceContentRunner:
        """Runs its content."""

    @property
    def inputs(self) -> ListeningGrammars:
        """Listens."""

    @property
    def documents(self) -> DocumentEntering:
        """Enters its documents."""

    @property
    def selection(self) -> Selecting:
        """Selects its items."""

    @property
    def items_of(self) -> Filling:
        """Fills its items."""

    @property
    def events(self) -> Catching:
        """Handles its events."""

    # What is queued and waited for:

    def enumeration(self, node: Node, context: Context, local: Scope, speech: Speech) -> None:
        """Read an enumerate (2.2.4)."""

    def play(self) -> Flow:
        """Play what is queued and wait until it has been said."""

    def wait(
        self, commands: Sequence[Queued], open_to_answers: Sequence[Command] = ()
    ) -> Generator[None, Resume, Resume]:
        """Wait for the end of Commands."""

    # The dialog:

    def local(self) -> Scope:
        """A new anonymous scope."""

    def visit_all(self, context: Context, wanted: str = "") -> Flow:
        """Visit the items of the dialog, or of the unit that it is in, until none is left."""

    def execute(self, context: Context, page: Page, dialog: str) -> Flow:
        """Run documents and dialogs of one context until it is left."""

    def finish(self, context: Context) -> Flow:
        """Play what is queued at an application's end (4.1.8)."""
