"""Units around form items (rule U5): each unit's questions and speech are one Atomic Behavior.

An event that is thrown in a unit is handled in it, wherever the handler is. One that comes
from outside is handled in it by the handlers of its items and its own alone; any other handler
leaves it first, as VoiceXML does one thing at a time. What is left to do in it is then another
unit, once the form goes on.
"""

from __future__ import annotations

from collections.abc import Callable

from prima.interpreter.transfers import GoOut, Thrown, Transfer
from prima.interpreter.units import Reach
from prima.markup.tree import Node
from prima.script.evaluation import ScriptError
from prima.voicexml.arranging import longest_of
from prima.voicexml.choosing import ItemSelection
from prima.voicexml.document import Page
from prima.voicexml.elements import HANDLERS, ITEMS
from prima.voicexml.events import Events
from prima.voicexml.items import Items
from prima.voicexml.shared import SharedState
from prima.voicexml.sketch import Sketch
from prima.voicexml.state import Context, Flow, HungUp, UnitOver


class Units:
    """Opens and closes the units of one application."""

    def __init__(
        self,
        shared: SharedState,
        items: Items,
        selection: ItemSelection,
        events: Events,
        visit_all: Callable[[Context, str], Flow],
    ) -> None:
        self.shared = shared
        self._items = items
        self._selection = selection
        self._events = events
        self._visit_all = visit_all
        self._reached: dict[int, tuple[Node, Page | None, Reach]] = {}
        """The content that each unit reaches, with its document's application root at that time."""

    def span(self, context: Context, unit: Node, wanted: str) -> Flow:
        """Visit the items of a unit; closes it however it is left.

        ``wanted`` is the name of the item in it to begin with, if a goto names one.
        """
        if self.shared.queue:
            yield from self.shared.play()  # earlier speech is not part of it
        self.shared.waits.open_unit(self._reach(context, unit), longest_of(unit), unit)
        context.unit = unit
        self._items.mark(context, unit)
        try:
            yield from self._visit_all(context, wanted)
            # A clear in it makes its items be visited again, not itself.
            self._items.mark(context, unit)
        except Transfer as way:
            if not (isinstance(way, GoOut) and way.failed):
                yield from self._say_rest()
            raise
        finally:
            context.item, context.unit = unit, None
            self.shared.waits.close_unit()

    def _say_rest(self) -> Flow:
        """Play what is queued before a unit is left: it belongs to the unit (O3), uninterrupted."""
        if not self.shared.queue or self.shared.gone:
            return
        self.shared.waits.leaving = True
        try:
            yield from self.shared.play()
        finally:
            self.shared.waits.leaving = False

    def left_by(self, context: Context, error: Thrown | ScriptError) -> bool:
        """Whether an event leaves the unit that the dialog is in before it is handled."""
        unit = context.unit
        if unit is None or isinstance(error, UnitOver):
            return unit is not None
        if isinstance(error, ScriptError) or not error.outside:
            return False
        if not isinstance(error, HungUp) and self._takes(context, unit, error):
            return False
        if any(not self._selection.guarded(context, one) for one in unit.all(*ITEMS)):
            context.visited.discard(unit.index)  # the form visits it again
            if unit.get("name"):
                self.shared.engine.unset(context.dialog, unit.get("name"))
        return True

    def _takes(self, context: Context, unit: Node, thrown: Thrown) -> bool:
        """Whether a handler in a unit takes an event, or may take it."""
        try:
            handler = self._events.taker(context, thrown)
        except Thrown:
            return True
        inside = [unit, *([context.item] if context.item is not None else [])]
        return any(handler is one for node in inside for one in node.all(*HANDLERS))

    def _reach(self, context: Context, unit: Node) -> Reach:
        """The Commands that may be requested in a unit, by all handlers that it can reach."""
        kept = self._reached.get(id(unit))
        if kept is None or kept[1] is not context.root:
            reach = Sketch(context.page, context.root).reach(unit)
            kept = self._reached[id(unit)] = unit, context.root, reach
        return kept[2]
