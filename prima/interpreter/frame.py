"""The data of a state while it is active: scopes, counters, pieces of content."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from types import MappingProxyType

from prima.interpreter.acts import Handler
from prima.interpreter.elements import Form, Item, Subdialog, Unit
from prima.interpreter.selection import Counters
from prima.interpreter.transfers import Transfer
from prima.messages import Json, Notice
from prima.script.evaluation import Scope

Content = Generator[int, Notice, None]
"""A piece of content as a coroutine: it yields the run it waits for and is sent the outcome."""


class Frame:
    """A form that is active, or whose subdialog is (VoiceXML 2.3.4).

    Frames come and go with every event: rarely used fields have their defaults in the class.
    """

    caller: Frame | None = None
    called_by: Subdialog | None = None
    given: Mapping[str, Json] = MappingProxyType({})
    """The params of the call that have a value."""
    item: Item | None = None
    """The item being visited."""
    next_item = ""
    silent = ""
    """The field that listens without a prompt if it is visited next: its own event was handled."""
    stalled = False
    """The form's content has been cancelled (O2): it waits for an event to move it."""
    connected = False
    """Whether the state has asked for the channel (X4)."""
    fresh = False
    """Whether the document's variables and scripts are still to be set up (VoiceXML 5.1.2)."""
    entering = False
    """Whether events raised on entry are still to be handled (C6)."""
    caused: tuple[int | str | None, tuple[int | str, int] | None] = (None, None)
    """The event its content then reacts to, and how long that is worth starting (C5, X8)."""
    asked = False
    """Whether the mediator knows of the state, by a Command or a unit."""

    counters = Counters()
    """Counters of events, by the item visited ("" for the form), and of prompts."""
    units: tuple[tuple[int, Unit], ...] = ()
    """The units that the state is in, outermost first, each with its number."""
    fibers: tuple[Fiber, ...] = ()

    def __init__(self, form: Form, state: int, document: Scope, dialog: Scope) -> None:
        self.form = form
        self.state = state
        self.document = document
        self.dialog = dialog

    @property
    def params(self) -> list[str]:
        """The params of the call, if this is the form that is called and not one it went to."""
        call = self.called_by
        if call is None or call.form != self.form.id:
            return []
        return [name for name, _ in call.params]

    def inside(self, unit: int) -> list[Fiber]:
        """The content that is under way in a unit (U5)."""
        return [one for one in self.fibers if one.unit == unit]


class Fiber:
    """A piece of content in progress: the form's own, or a handler's."""

    content: Content | None = None
    unit: int | None = None
    commands: Sequence[Handler] = ()
    """Handlers inside the Command whose event is being handled."""
    waiting: int | None = None
    began = 0
    """When it started to wait (ms)."""

    def __init__(self, frame: Frame, main: bool = False, local: Scope = None) -> None:
        self.frame = frame
        self.main = main
        self.local = local
        """The innermost scope, created on first use."""


class GoForm(Transfer):
    """A goto to a form."""

    def __init__(self, form: str) -> None:
        self.form = form


class Abandoned(Exception):
    """The Commands that a piece of content waited for were cancelled (O2)."""
