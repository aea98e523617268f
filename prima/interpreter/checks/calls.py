"""What a call of a form gives it, and what it takes from the result (VoiceXML 2.3.4)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from functools import cached_property
from itertools import chain

from prima.errors import Problem, Span, suggestion
from prima.errors.diagnoses.names import UNDECLARED_VARIABLE
from prima.interpreter.acts import Declare, Expression, Return
from prima.interpreter.checks.code import all_code
from prima.interpreter.checks.facts import Facts, name_of, setup_names
from prima.interpreter.checks.variables import place_in
from prima.interpreter.elements import Subdialog
from prima.markup.spans import value_span
from prima.script.known import Known
from prima.script.names import Names, expression_names, script_names

NOT_TAKEN = UNDECLARED_VARIABLE.says(
    'The form "{form}" neither declares nor uses "{name}".', severity="warning"
)
NOT_RETURNED = UNDECLARED_VARIABLE.says(
    'The form "{form}" returns no "{name}": its value is undefined.', severity="warning"
)

MOST_FORMS = 100
"""A form from which gotos lead to more forms than these may return anything."""


def check_calls(facts: Facts) -> Iterator[Problem]:
    """Misspelt params, and misspelt properties of results."""
    checked = _Calls(facts)
    if checked.calls:
        yield from chain(checked.params(), checked.results())


class _Calls:
    """The calls of a document's forms."""

    def __init__(self, facts: Facts) -> None:
        self.facts = facts
        self.calls = [
            (facts.known_in(form), item)
            for form, items in facts.forms
            for item in items
            if isinstance(item, Subdialog)
        ]
        """Each with the variables that its form's code sees."""
        self._returned: dict[str, set[str]] = {}

    def params(self) -> Iterator[Problem]:
        """Params that the called form has no variable for, if it has one of a similar name."""
        for _, call in self.calls:
            form = self.facts.document.forms.get(call.form)
            if form is None or not call.params:
                continue
            declared, given = setup_names(form.setup), {name for name, _ in call.params}
            for param in call.node.all("param"):
                name = param.get("name")
                if name in declared or name in self._used[self.facts.known_in(form)]:
                    continue
                if hint := suggestion(name, declared - given, *value_span(param, "name")):
                    place = param.attribute_place("name")
                    yield NOT_TAKEN.at(place, hint, form=form.id, name=name)

    def results(self) -> Iterator[Problem]:
        """Properties of results that the called form never returns."""
        others = {act.name for _, act in self.facts.acts.of(Declare)} | set(self.facts.shared)
        called = {(known, call.name): call.form for known, call in self.calls}
        for expr, known, script in all_code(self.facts):
            for use in _names(expr.code, script).uses:
                form = called.get((known, use.name))
                if form and use.part is not None and not use.holder and use.name not in others:
                    yield from self._unreturned(form, expr, *use.part)

    def _unreturned(self, form: str, expr: Expression, start: int, name: str) -> Iterator[Problem]:
        if form not in self._returned:
            self._returned[form] = self._returns_of(form)
        known, place = self._returned[form], place_in(expr, start)
        if name not in known and (hint := suggestion(name, known, Span.of(place, name))):
            yield NOT_RETURNED.at(place, hint, form=form, name=name)

    @cached_property
    def _used(self) -> dict[Known, set[str]]:
        """The names that code uses, by the variables that it sees: those of its form."""
        used: defaultdict[Known, set[str]] = defaultdict(set)
        for expr, known, script in all_code(self.facts):
            used[known] |= _names(expr.code, script).free.keys()
        return used

    @cached_property
    def _returns(self) -> dict[str | None, set[str]]:
        """The names that each form returns by its own content; None for the document's."""
        names: defaultdict[str | None, set[str]] = defaultdict(set)
        for form, act in self.facts.acts.of(Return):
            names[name_of(form)].update(act.names)
        return names

    def _returns_of(self, form: str) -> set[str]:
        """The names that a form returns, or one that it goes to; none if that is not known."""
        reached, ahead, leads = {form}, [form], self.facts.leads
        while ahead and len(reached) <= MOST_FORMS:
            new = set(leads.targets.get(ahead.pop(), ())) - reached
            reached |= new
            ahead += new
        if ahead or reached & leads.anywhere:
            return set()
        return set().union(*(self._returns.get(one, ()) for one in (None, *reached)))


def _names(code: str, script: bool) -> Names:
    return script_names(code) if script else expression_names(code)
