"""Which form item is visited next, and what it says (2.1.6.1, 4.1.6)."""

from __future__ import annotations

from collections.abc import Sequence

from prima.interpreter.selection import select_item, select_prompts
from prima.markup.tree import Node
from prima.voicexml.arranging import holds, is_unit
from prima.voicexml.content import Content
from prima.voicexml.elements import ITEMS, handler_number
from prima.voicexml.settings import form_items
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context


class ItemSelection:
    """Declares the variables of form items, and selects by them; selects prompts by their counts."""

    def __init__(self, shared: SharedState, content: Content) -> None:
        self._shared = shared
        self._content = content

    def declare(self, context: Context, item: Node) -> None:
        """Initialise an item's variable; an item without a name is only visited or not."""
        nothing = self._shared.engine.nothing
        if name := item.get("name"):
            self._content.check_name(item)
            self._shared.engine.unset(context.dialog, name)  # even if a var has declared it (C)
            if "expr" in item.attributes:
                self._content.put(context.dialog, name, item, "expr", context, nothing)
            return
        if "expr" in item.attributes:
            guard, name = self._shared.local(), "guard"
            self._content.put(guard, name, item, "expr", context, nothing)
            if self._shared.engine.defined(guard, name):  # null is a value
                context.visited.add(item.index)

    def select(self, context: Context, wanted: str) -> Node | None:
        """The item that a goto names, or its unit; else the first unfilled one whose condition holds."""
        items, nothing = self._next_to(context), self._shared.engine.nothing

        def first_undefined(some: Sequence[Node]) -> int:
            each = enumerate(some)
            return next((at for at, one in each if not self._is_over(context, one)), len(some))

        def is_wanted(one: Node) -> bool:
            return self._content.holds(one, context, nothing)

        return select_item(items, wanted, holds, first_undefined, is_wanted)

    def _is_over(self, context: Context, item: Node) -> bool:
        """Whether an item's guard is set; a menu has no guard."""
        return item.tag != "menu" and self.guarded(context, item)

    def _next_to(self, context: Context) -> list[Node]:
        """The items that may be visited next: of the unit, or of the dialog with its units."""
        if context.unit is not None:
            return [one for one in context.unit.nodes if one.tag in ITEMS]
        form = context.form
        if form is None or form.tag == "menu":
            return form_items(context)
        return [one for one in form.nodes if one.tag in ITEMS or is_unit(one)]

    def guarded(self, context: Context, item: Node) -> bool:
        """Whether an item's variable is defined, so that it is not visited."""
        name = item.get("name")
        if name:
            return self._shared.engine.defined(context.dialog, name)
        return item.index in context.visited

    def prompts(self, context: Context, item: Node) -> list[Node | str]:
        """The prompts of an item's next visit, by their counts (4.1.6)."""
        asked = context.counters.prompts.get(item.index, 0) + 1
        content, nothing = self._content, self._shared.engine.nothing

        def spoken(piece: Node | str) -> bool:
            return isinstance(piece, str) or content.holds(piece, context, nothing)

        pieces = ((_least(piece), piece) for piece in item.content if _is_spoken(piece))
        return select_prompts(pieces, asked, spoken)


def _is_spoken(piece: Node | str) -> bool:
    return isinstance(piece, str) or piece.tag in ("prompt", "audio", "value", "enumerate")


def _least(piece: Node | str) -> int:
    """The count of a prompt; bare text is a prompt without attributes (4.1.2)."""
    return 1 if isinstance(piece, str) else handler_number(piece)
