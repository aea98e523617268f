"""The first Commands of an application after an event."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby

from prima.checks.prices.model import Price, add_longer, chains
from prima.interpreter.acts import (
    Act,
    CommandRun,
    Exit,
    Expression,
    Foreach,
    Goto,
    Handler,
    If,
    Return,
    SendOut,
    StepTemplate,
    Throw,
    run_commands,
)
from prima.interpreter.elements import Block, Document, Field, Form, Item, Subdialog, all_items
from prima.interpreter.entering import goes_to_item, is_left
from prima.interpreter.rounds import raised_in
from prima.interpreter.selection import prefixes, takes
from prima.markup.tree import Node


def responds(price: Price) -> bool:
    """Whether the robot speaks with it, or begins a movement towards the user."""
    return "speaker" in price.devices or price.engages


class Firsts:
    """Finds the Commands that may be the first ones of some content, on all paths.

    With ``response``, those up to the first word or movement towards the user.
    """

    def __init__(
        self,
        document: Document,
        of_items: Mapping[int, Price],
        step: Callable[[StepTemplate], Price],
        response: bool = False,
    ) -> None:
        self._document = document
        self._response = response
        self.later: list[SendOut] = []
        """The delayed events of the application's own after which a response may come."""
        self.together: dict[frozenset[str], int] = {}
        """How long (ms) first Commands that begin at once, in branches, keep devices."""
        self._of_items = of_items
        self._step = step
        self._seen: set[int] = set()
        self._free: set[int] = set()
        """The forms all of whose items have been visited, as a goto may lead to each."""
        self._returns = False
        """Whether a subdialog may return without any, so that its caller goes on."""
        self._found: dict[int, Price] = {}

    def of(self, content: Sequence[Act], form: Form | None) -> list[Price]:
        """The possible first Commands of content of a form, or of the whole document."""
        self._begin()
        if self._go_through(content, form):
            self._stay(form)
        return list(self._found.values())

    def of_form(self, name: str) -> list[Price]:
        """The possible first Commands of a form."""
        self._begin()
        self._enter(self._document.forms.get(name))
        return list(self._found.values())

    def _begin(self) -> None:
        self._seen, self._free, self._found = set(), set(), {}
        self.later, self.together = [], {}
        self._returns = False

    def _add(self, price: Price) -> None:
        self._found.setdefault(price.node.index, price)

    def _stay(self, form: Form | None) -> None:
        """Continue the form with its remaining items."""
        for one in [form] if form is not None else self._document.forms.values():
            self._enter(one)

    def _enter(self, form: Form | None) -> bool:
        """Add a form's possible first Commands; gives whether it may have none."""
        if form is None or form.node.index in self._seen:
            return False
        self._seen.add(form.node.index)
        for item in form.items:
            if not self._visit(item, form) and item.cond is None and item.expr is None:
                return False
        return True

    def _visit(self, item: Item, form: Form) -> bool:
        """Add an item's possible first Commands; gives whether it may have none."""
        own = self._of_items.get(item.node.index)
        if own is not None:
            self._add(own)
            return self._response and not responds(own)
        if isinstance(item, Subdialog):
            return self._enter(self._document.forms.get(item.form)) or self._returns
        return self._go_through(item.content, form) if isinstance(item, Block) else True

    def _go_through(self, content: Sequence[Act], form: Form | None) -> bool:
        """Add content's possible first Commands; gives whether it may end without any."""
        for act in content:
            match act:
                case Foreach():
                    self._go_through(act.content, form)
                case Throw():
                    self._handled(act.node, [act.event], form)
                    return True
                case SendOut() if act.event and self._response:
                    self.later.append(act)
                    self._handled(act.node, [act.event], form)
                case _ if not self._goes_on(act, form):
                    return False
        return True

    def _goes_on(self, act: Act, form: Form | None) -> bool:
        """Add an act's possible first Commands; gives whether later ones may be first as well."""
        match act:
            case CommandRun():
                return self._run(act, form)
            case If():
                return self._branch(act, form)
            case Goto():
                self._goto(act, form)
            case Return():
                self._returns = True
                self._stay(None)
        return not isinstance(act, Goto | Return | Exit)

    def _run(self, act: CommandRun, form: Form | None) -> bool:
        """Add the relevant Commands of a run; gives whether the content after it is, too."""
        prices = [self._step(step) for step in act.steps]
        if not self._response:
            self._begin_with(
                [price for price, step in zip(prices, act.steps, strict=True) if not step.after]
            )
            return False
        answering = {at for at, price in enumerate(prices) if responds(price)}
        before = answering or set(range(len(prices)))
        for at in reversed(range(len(prices))):
            if at in before:
                before.update(act.steps[at].after)
        for at in sorted(before):
            self._add(prices[at])
        if not answering:
            self._ends(act, form)
        return not answering

    def _begin_with(self, branches: list[Price]) -> None:
        """Add the first Command of each branch of a run."""
        for price in branches:
            self._add(price)
        if len(branches) > 1:
            add_longer(self.together, chains(branches))

    def _ends(self, act: CommandRun, form: Form | None) -> None:
        """Add the Commands of handlers of the ends of Commands."""
        for command in run_commands(act.steps):
            for hook in command.handlers:
                self._go_through(hook.content, form)
        self._handled(act.node, sorted(raised_in([act])), form)

    def _branch(self, act: If, form: Form | None) -> bool:
        over = [self._go_through(branch, form) for _, branch in act.branches]
        return any(over) or act.branches[-1][0] is not None

    def _goto(self, act: Goto, form: Form | None) -> None:
        if isinstance(act.form, str) and act.form:
            self._enter(self._document.forms.get(act.form))
        elif isinstance(act.form, Expression):
            self._stay(None)
        else:
            self._items(form)

    def _items(self, form: Form | None) -> None:
        """Add the first Commands of all items of a form, any of which may be gone to."""
        for one in [form] if form is not None else self._document.forms.values():
            if one.node.index in self._free:
                continue  # a block may go to another one, which goes back to it
            self._free.add(one.node.index)
            for item in all_items(one.items):
                self._visit(item, one)

    def _handled(self, node: Node, events: Sequence[str | Expression], form: Form | None) -> None:
        """The content of handlers of events that an element raises."""
        if node.index in self._seen:
            return
        self._seen.add(node.index)
        every = any(isinstance(event, Expression) for event in events)
        names = {under for one in events if isinstance(one, str) for under in prefixes(one)}
        for handler in _all_handlers(self._document, form):
            if every or not names.isdisjoint(handler.events):
                self._go_through(handler.content, form)


def _all_handlers(document: Document, form: Form | None) -> list[Handler]:
    found = list(document.handlers)
    for one in [form] if form is not None else document.forms.values():
        found += one.handlers
        for item in all_items(one.items):
            found += item.handlers
    return found


def asks_at_most(field: Field, form: Form, document: Document) -> int:
    """How often a question is asked until the user answers; 0 for endlessly."""
    scope = [*field.handlers, *form.handlers, *document.handlers]
    counts = [_leaves_at(event, scope) for event in ("noinput", "nomatch")]
    return max(sum(counts) - 1, 1) if all(counts) else 0


def _leaves_at(event: str, scope: Sequence[Handler]) -> int:
    """At which of its occurrences an event certainly leaves the form; 0 if at none.

    Args:
        event: its name.
        scope: the handlers, innermost first.
    """
    fitting = sorted(_fitting(event, scope), key=_count, reverse=True)
    leaves = {id(one): is_left(one.content, goes_to_item) for one in fitting}
    staying = [one.count for one in fitting if not leaves[id(one)] and _under_shorter(one, event)]
    least = max(staying, default=0)
    left = False
    for count, alike in groupby(reversed(fitting), key=_count):
        for one in alike:
            certain = one.cond is None and event in one.events
            left = leaves[id(one)] and (certain or left)
        if left and count >= least:
            return count
    return 0


def _fitting(event: str, scope: Sequence[Handler]) -> Iterator[Handler]:
    """The handlers that take an event at some of its occurrences."""
    for one in scope:
        if any(takes(name, event) for name in one.events):
            yield one


def _count(handler: Handler) -> int:
    return handler.count


def _under_shorter(handler: Handler, event: str) -> bool:
    """Whether a handler takes an event under a shorter name, too: then others count as well."""
    return any(name != event and takes(name, event) for name in handler.events)
