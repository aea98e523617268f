"""Missing forms and form items that a document names."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from prima.errors import Diagnosis, Problem, suggestion
from prima.errors.diagnoses.names import NO_SUCH_FORM, NO_SUCH_ITEM
from prima.errors.diagnoses.structure import DUPLICATE_NAME
from prima.interpreter.acts import Clear, Expression, Goto
from prima.interpreter.checks.facts import Facts, name_of
from prima.interpreter.elements import Field, Filled, Form, Item, Subdialog
from prima.markup.spans import instead, value_span
from prima.markup.tree import Node
from prima.script.choices import choices
from prima.script.known import NameScope

ADD_FORM = 'Name another, or add <form id="{name}">.'
NAME_ITEM = "Name an item of this form."
UNKNOWN_FORM = NO_SUCH_FORM.says('There is no form "{name}" to go to.', ADD_FORM)
UNKNOWN_ITEM = NO_SUCH_ITEM.says('There is no form item "{name}" to go to.', NAME_ITEM)
COMPUTED_FORM = NO_SUCH_FORM.says(
    'There is no form "{name}" to go to: this throws error.badfetch.', ADD_FORM, "warning"
)
COMPUTED_ITEM = NO_SUCH_ITEM.says(
    'There is no form item "{name}" to go to: this throws error.badfetch.', NAME_ITEM, "warning"
)
UNKNOWN_FIELD = NO_SUCH_ITEM.says('There is no field "{name}".', "Name a field of this form.")
TWO_ITEMS = DUPLICATE_NAME.says('The form "{form}" has two items named "{name}".', "Rename one.")


def check_targets(facts: Facts) -> Iterator[Problem]:
    """Check gotos, subdialogs and links for missing forms and items."""
    names = _item_names(facts)
    for holder, act in facts.acts.of(Goto):
        yield from _goto(facts, act, names[name_of(holder)])
    for _, items in facts.forms:
        for item in items:
            if isinstance(item, Subdialog) and item.form not in facts.document.forms:
                yield from _form(facts, item.form, item.node, "src")
    for link in (link for _, links in facts.links for link in links):
        if link.form and link.form not in facts.document.forms:
            yield from _form(facts, link.form, link.node, "next")


def _goto(facts: Facts, act: Goto, items: set[str]) -> Iterator[Problem]:
    if isinstance(act.form, str) and act.form not in facts.document.forms:
        yield from _form(facts, act.form, act.node, "next")
    if isinstance(act.item, str) and act.item not in items:
        yield _item(facts, act, act.item, items)
    if isinstance(act.form, Expression):
        named = (name.removeprefix("#") for name in _literals(act.form))
        yield from _computed(act.form, named, facts.document.forms, COMPUTED_FORM)
    if isinstance(act.item, Expression):
        yield from _computed(act.item, _literals(act.item), items, COMPUTED_ITEM)


def _literals(expr: Expression) -> Iterator[str]:
    """The texts that an expression gives if its conditions hold, or do not."""
    return (one.text for one in choices(expr.code) if one.whole)


def _computed(
    expr: Expression, names: Iterable[str], known: Collection[str], diagnosis: Diagnosis
) -> Iterator[Problem]:
    """Names that an expression has as literals, and that nothing has."""
    for name in names:
        if name not in known:
            place = expr.node.attribute_place(expr.attribute)
            yield diagnosis.at(place, suggestion(name, known), name=name)


def _item_names(facts: Facts) -> dict[str | None, set[str]]:
    """The names of the items of each form, and of all (None)."""
    found: dict[str | None, set[str]] = {
        form.id: {item.name for item in items} for form, items in facts.forms
    }
    return {**found, None: set().union(*found.values())}


def _form(facts: Facts, name: str, node: Node, attribute: str) -> Iterator[Problem]:
    """The problem of a form that is missing."""
    if node.get(attribute).strip().startswith("#"):  # otherwise the schema reports it
        hint = suggestion(name, facts.document.forms, *value_span(node, attribute, name))
        yield UNKNOWN_FORM.at(node.attribute_place(attribute), hint, name=name)


def _item(facts: Facts, act: Goto, name: str, names: set[str]) -> Problem:
    hint = suggestion(name, names, *value_span(act.node, "nextitem"))
    if name in facts.document.forms:
        remedy = f'It is a form: write next="#{name}".'
        hint = instead(remedy, act.node, "nextitem", "next", f"#{name}")
    return UNKNOWN_ITEM.at(act.node.attribute_place("nextitem"), hint, name=name)


def check_items(facts: Facts) -> Iterator[Problem]:
    """Check for items with the same name, and for missing fields in namelists."""
    for form, items in facts.forms:
        if items or form.filled:
            yield from _two_items(form, items)
            asking = [item for item in items if isinstance(item, Field | Subdialog)]
            inputs = NameScope(item.name for item in asking)
            for filled in (*form.filled, *(one for item in asking for one in item.filled)):
                yield from _namelist(filled, filled.names, inputs)


def _two_items(form: Form, items: Sequence[Item]) -> Iterator[Problem]:
    seen: set[str] = set()
    for item in items:
        if item.name in seen:
            yield TWO_ITEMS.at(item.node.attribute_place("name"), form=form.id, name=item.name)
        seen.add(item.name)


def _namelist(holder: Filled | Clear, names: Sequence[str], known: NameScope) -> Iterator[Problem]:
    for name in names:
        if name not in known:
            spans = value_span(holder.node, "namelist", name)
            hint = suggestion(name, known.written, *spans)
            yield UNKNOWN_FIELD.at(holder.node.attribute_place("namelist"), hint, name=name)
