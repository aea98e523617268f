"""What is remembered of a state while it is active: scopes, counters, pieces of content."""

from __future__ import annotations

from collections.abc import Generator

from prima.deferred import dataclass, field
from prima.interpreter.elements import Form, Handler, Item, Subdialog, Unit
from prima.interpreter.expressions import Scope
from prima.messages import Event, Json, Notice

MAX_DEPTH = 32
"""Subdialogs inside subdialogs, and events thrown while one is handled."""

Content = Generator[int, Notice, None]
"""A piece of content as a coroutine: it yields the run it waits for and is sent its fate."""


@dataclass(slots=True, eq=False)
class Frame:
    """A form that is active, or whose subdialog is (VoiceXML 2.3.4)."""

    form: Form
    state: int
    document: Scope
    dialog: Scope
    caller: Frame | None = None
    called_by: Subdialog | None = None
    counters: dict[tuple[str, str], int] = field(default_factory=dict)
    """Occurrences of an event's names while an item ("" for the form) was visited."""
    prompts: dict[str, int] = field(default_factory=dict)
    item: Item | None = None
    """The item being visited."""
    next_item: str = ""
    reprompt: bool = True
    stalled: bool = False
    """What the form was doing has been cancelled (O2): it waits for an event to move it."""
    units: list[tuple[int, Unit]] = field(default_factory=list)
    fibers: list[Fiber] = field(default_factory=list)
    connected: bool = False
    """Whether the state has asked for the channel (X4)."""
    fresh: bool = False
    """Whether the document's variables and scripts have still to be set up (VoiceXML 5.1.2)."""


@dataclass(slots=True, eq=False)
class Fiber:
    """A piece of content that is under way: the form's own, or a handler's."""

    frame: Frame
    content: Content | None = None
    main: bool = False
    local: Scope = None
    """The innermost scope, made when something first looks into it."""
    unit: int | None = None
    commands: list[Handler] = field(default_factory=list)
    """Handlers written inside the Command whose event is being handled."""
    waiting: int | None = None


class Thrown(Exception):
    """An event thrown in the application (VoiceXML 5.2.1)."""

    def __init__(self, event: Event, source: str = "") -> None:
        super().__init__(event.name)
        self.event = event
        self.source = source
        self.sought = False
        """Whether its handlers have been looked for, and there is none."""


class Transfer(Exception):
    """Control leaves the content: a form, an item, a return, or the end."""


class GoForm(Transfer):
    """A goto to a form."""

    def __init__(self, form: str) -> None:
        super().__init__(form)
        self.form = form


class GoItem(Transfer):
    """A goto to an item of this form."""

    def __init__(self, item: str) -> None:
        super().__init__(item)
        self.item = item


class GoBack(Transfer):
    """A return from a subdialog, with its values or an event."""

    def __init__(self, values: dict[str, Json], event: str) -> None:
        super().__init__(event)
        self.values = values
        self.event = event


class GoOut(Transfer):
    """An exit."""

    def __init__(self, reason: str = "exit", failed: bool = False, source: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.failed = failed
        self.source = source


class Abandoned(Exception):
    """The Commands that a piece of content waited for were cancelled (O2)."""
