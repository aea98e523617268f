"""Data shared by the checks of a document: acts, declared names, targets of forms."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from functools import cached_property

from prima.interpreter.acts import Declare, Exit, Foreach, Goto, Handler, Script
from prima.interpreter.elements import Acts, Document, Form, Item, Link, Subdialog, all_items
from prima.interpreter.events import handlers_of
from prima.script.known import Known, NameScope
from prima.script.names import script_names

NONE: frozenset[str] = frozenset()


class FormLeads:
    """The targets of forms, by name, and of the document's own content (None)."""

    __slots__ = ("anywhere", "calls", "exits", "targets")

    def __init__(self) -> None:
        self.targets: defaultdict[str | None, list[str]] = defaultdict(list)
        """Forms they go to."""
        self.anywhere: set[str | None] = set()
        """Forms with a goto whose target is an expression."""
        self.calls: defaultdict[str | None, list[str]] = defaultdict(list)
        """Forms that they call as subdialogs."""
        self.exits: set[str | None] = set()
        """Forms that an exit may end."""

    def of(self, form: str) -> list[str]:
        """All forms that a form goes to or calls."""
        return [*self.targets.get(form, ()), *self.calls.get(form, ())]


class Facts:
    """A document with the facts that several checks look up, each computed once."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.acts = Acts(document)
        self.shared = NameScope(setup_names(document.setup))
        """Names visible to all forms."""
        self._declared: dict[str | None, NameScope] = {}
        """Names by the form whose content declares them; None for the document."""
        self._given: dict[str, NameScope] = {}
        """Names that subdialogs give as params, by the form they call."""
        self._visible: dict[str, Known] = {}
        self._outside: dict[str, NameScope] = {}
        """Names that no content declares, by form."""
        self._gather()
        self._common = NameScope(self.shared | self._declared.get(None, NONE))

    @cached_property
    def forms(self) -> list[tuple[Form, Sequence[Item]]]:
        """Forms with all their items."""
        return [(form, all_items(form.items)) for form in self.document.forms.values()]

    @cached_property
    def handlers(self) -> list[Handler]:
        """All handlers of the document."""
        return list(handlers_of(self.document, self.acts))

    # Names

    def _gather(self) -> None:
        """Collect names by the form that declares them, in one pass."""
        for form, declare in self.acts.of(Declare):
            self._own(form).add(declare.name)
        for form, script in self.acts.of(Script):
            self._own(form).update(script_names(script.code.code).declared)
        for form, loop in self.acts.of(Foreach):
            self._own(form).add(loop.item)
        for form, items in self.forms:
            if form.setup:
                self._own(form).update(setup_names(form.setup))
            for item in items:
                self._gather_item(form, item)

    def _gather_item(self, form: Form, item: Item) -> None:
        if item.node.get("name"):
            self._own(form).update((item.name, f"{item.name}$"))
        if isinstance(item, Subdialog):
            given = self._given.setdefault(item.form, NameScope())
            given |= {name for name, _ in item.params}

    def _own(self, form: Form | None) -> NameScope:
        return self._declared.setdefault(name_of(form), NameScope())

    def outside_content(self, form: Form) -> NameScope:
        """The variables of a form that no content declares."""
        own = self._outside.get(form.id)
        if own is None:
            own = self._outside[form.id] = NameScope(setup_names(form.setup))
            for item in all_items(form.items):
                own |= {item.name, f"{item.name}$"}
            own |= self._given.get(form.id, set())
        return own

    @cached_property
    def _every(self) -> Known:
        """All variables."""
        return Known(NameScope(self.shared.union(*self._declared.values(), *self._given.values())))

    def known_in(self, form: Form | None) -> Known:
        """All variables visible to a form's content, or to the document's own content (None)."""
        if form is None:
            return self._every
        known = self._visible.get(form.id)
        if known is None:
            own, given = self._declared.get(form.id), self._given.get(form.id)
            known = self._visible[form.id] = Known(self._common, *filter(None, (own, given)))
        return known

    # Ways

    @cached_property
    def leads(self) -> FormLeads:
        """The targets of each form and of the document's own content."""
        found = FormLeads()
        for form, goto in self.acts.of(Goto):
            if isinstance(goto.form, str):
                found.targets[name_of(form)].append(goto.form)
            elif goto.form is not None:
                found.anywhere.add(name_of(form))
        found.exits = {name_of(form) for form, _ in self.acts.of(Exit)}
        for name, links in self.links:
            found.targets[name] += [link.form for link in links if link.form]
        for form, items in self.forms:
            found.calls[form.id] += [item.form for item in items if isinstance(item, Subdialog)]
        return found

    @property
    def links(self) -> list[tuple[str | None, Sequence[Link]]]:
        """The links of the document (None), and of each form by its name."""
        return [(None, self.document.links), *((form.id, form.links) for form, _ in self.forms)]


def name_of(form: Form | None) -> str | None:
    """The name by which a form is looked up; None for the document."""
    return form.id if form else None


def setup_names(setup: Iterable[Declare | Script]) -> set[str]:
    """The names that a document or form declares before its content."""
    names: set[str] = set()
    for act in setup:
        names |= {act.name} if isinstance(act, Declare) else script_names(act.code.code).declared
    return names
