"""What is remembered of a state while it is active: scopes, counters, pieces of content."""

from __future__ import annotations

from collections.abc import Generator, Sequence

from prima.interpreter.acts import Handler
from prima.interpreter.elements import Form, Item, Subdialog, Unit
from prima.interpreter.selection import Counters
from prima.interpreter.transfers import Transfer
from prima.messages import Notice
from prima.script.evaluation import Scope

Content = Generator[int, Notice, None]
"""A piece of content as a coroutine: it yields the run it waits for and is sent its fate."""


class Frame:
    """A form that is active, or whose subdialog is (VoiceXML 2.3.4).

    Frames come and go with every event: what few of them need has its value in the class.
    """

    caller: Frame | None = None
    called_by: Subdialog | None = None
    item: Item | None = None
    """The item being visited."""
    next_item = ""
    reprompt = True
    stalled = False
    """What the form was doing has been cancelled (O2): it waits for an event to move it."""
    connected = False
    """Whether the state has asked for the channel (X4)."""
    fresh = False
    """Whether the document's variables and scripts have still to be set up (VoiceXML 5.1.2)."""
    entering = False
    """Whether events that were raised when the state was entered are still to be handled (C6)."""
    caused: tuple[int | str | None, tuple[int | str, int] | None] = (None, None)
    """To what event its content reacts once they are, and for how long that is worth it (C5, X8)."""
    asked = False
    """Whether the mediator has heard of the state: of a Command, or a unit."""

    counters = Counters()
    """Of events while an item ("" for the form) was visited, and of prompts."""
    units: tuple[tuple[int, Unit], ...] = ()
    """The units that the state is in, outermost first, each with its number."""
    fibers: tuple[Fiber, ...] = ()

    def __init__(self, form: Form, state: int, document: Scope, dialog: Scope) -> None:
        self.form = form
        self.state = state
        self.document = document
        self.dialog = dialog


class Fiber:
    """A piece of content that is under way: the form's own, or a handler's."""

    content: Content | None = None
    unit: int | None = None
    waiting: int | None = None
    began = 0
    """When it began to wait (ms)."""

    def __init__(
        self,
        frame: Frame,
        main: bool = False,
        local: Scope = None,
        commands: Sequence[Handler] = (),
    ) -> None:
        self.frame = frame
        self.main = main
        self.local = local
        """The innermost scope, made when something first looks into it."""
        self.commands = commands
        """Handlers written inside the Command whose event is being handled."""


class GoForm(Transfer):
    """A goto to a form."""

    def __init__(self, form: str) -> None:
        self.form = form


class Abandoned(Exception):
    """The Commands that a piece of content waited for were cancelled (O2)."""
