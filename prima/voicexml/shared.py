"""What all parts of a VoiceXML interpreter share while its application runs.

The parts are built in layers on this: each is given those below it that it uses, and the machine
(:mod:`~prima.voicexml.machine`), which runs the Form Interpretation Algorithm, puts them together.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from pathlib import PurePath

from prima.interpreter.bounds import ElementVisit
from prima.interpreter.protocol import App
from prima.interpreter.transfers import GoOut
from prima.markup.tree import Node
from prima.messages import Command
from prima.script.evaluation import Scope
from prima.script.isolated import AnyEngine
from prima.voicexml.arranging import Queued
from prima.voicexml.document import Page, VoiceDocument
from prima.voicexml.queue import PromptQueue
from prima.voicexml.state import Context, Flow, Resume, TakenUtterance, thrown_outside
from prima.voicexml.waits import Waits

MS_A_LETTER = 100
"""The assumed duration of a letter if the device does not report how long it heard."""
MAX_KNOWN = 1000
"""Maximum number of recordings recognised when played back."""


class SharedState:
    """What is remembered while one application runs, and how it waits."""

    def __init__(self, app: App[AnyEngine], document: VoiceDocument) -> None:
        self.app = app
        self.engine = app.engine
        self.document = document
        """The document that it runs."""
        self.pages: dict[str, Page] = {document.page.uri: document.page}
        """Documents by their URIs."""
        self.resources: dict[str, bytes] = {}
        """Resources of grammars that are not files, once they have been fetched."""
        self.hosted: dict[str, str] = {}
        """Names and URIs that a real host, not a service, has answered, and where it did."""
        self.queue = PromptQueue()
        """Prompts and Commands that are played when a wait is reached (4.1.8)."""
        self.waits = Waits(app, self._here, self._begun)
        self.reprompted = False
        self.gone = ""
        """The event by which the user left: nothing is waited for any more (1.5.4)."""
        self.context: Context | None = None
        self.session = app.engine.nothing
        """The session's variables, for the platform alone (5.1.2)."""
        self.heard: TakenUtterance | None = None
        """The user's latest utterance, as a grammar took it."""
        self.mark: str | None = None
        """The last mark queued, for devices that report none (VoiceXML 2.1, 4)."""
        self.marked: str | None = None
        """The last mark of what is being said."""
        self.lengths: dict[str, int] = {}
        """The lengths of recordings (ms), by their URIs."""

    def local(self) -> Scope:
        """A new anonymous scope."""
        return self.engine.scope()

    def note_document(self, page: Page) -> None:
        """Note a loaded document, usable or not; its path is relative to the first one's."""
        first, file = self.document.page, self.document.file
        path = file if page is first else str(PurePath(file).parent / page.root.source.file)
        visit = ElementVisit(self.app.name, max(self.app.now, 0), "document", page.root, path)
        self.app.visits.append(visit)

    def keep_recording(self, said: str, ms: float | None = None) -> int:
        """Keep an utterance as a recording; gives its duration (ms), a guess if not reported."""
        while len(self.lengths) >= MAX_KNOWN:
            self.lengths.pop(next(iter(self.lengths)))
        self.lengths[said] = MS_A_LETTER * len(said) if ms is None else int(ms)
        return self.lengths[said]

    # Waiting --------------------------------------------------------------------------

    def play(self) -> Flow:
        """Play what is queued and wait until it has been said."""
        resume = yield from self.wait(self.queue.take())
        if resume.event is not None:
            raise thrown_outside(resume)

    def wait(
        self, commands: Sequence[Queued], open_to_answers: Sequence[Command] = ()
    ) -> Generator[None, Resume, Resume]:
        """Wait for the end of Commands; without a user the application ends (1.5.4)."""
        if self.gone:
            raise GoOut(self.gone)
        return (yield from self.waits.wait(commands, open_to_answers))

    def _here(self) -> Node:
        """Where the application is."""
        item = self.context.item if self.context is not None else None
        return item or self.document.node

    def _begun(self) -> None:
        """The queue has been requested: its last mark counts from now on."""
        self.marked, self.mark = self.mark, None
