"""Undeclared variables and functions in code."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import chain

from prima.errors import Hint, Place, Problem, Span, one_of, replaced, suggestion
from prima.errors.diagnoses.names import NO_MEMBER, UNDECLARED_VARIABLE
from prima.errors.diagnoses.structure import DUPLICATE_NAME
from prima.interpreter.acts import Assign, Clear, Expression, Foreach, Handler, Return
from prima.interpreter.checks.facts import Facts
from prima.interpreter.elements import Form
from prima.interpreter.selection import beginnings
from prima.markup.spans import Declarations, value_span
from prima.markup.tree import Node
from prima.script.globals import HANDLED, IDENTIFIER, RESERVED
from prima.script.known import Known, NameScope
from prima.script.names import Names, expression_names, script_names, whole_scopes
from prima.script.slips import is_bare, or_text, value_elsewhere
from prima.script.walk import OBJECTS

PARTS = ("name", "message", "data")
TOLD = ("session.time", *(f"event.{part}" for part in PARTS))
"""What a run tells to documents."""
FIELDS = {
    "touch": ("sensor",),
    "message": ("from", "text"),
    "human.found": ("distance", "angle", "sensed"),
    "corner": ("corner",),
    **dict.fromkeys(("noinput", "nomatch"), ("command", "utterance", "confidence")),
    "error.service": ("service", "message"),
    "interrupted": ("done", "heard"),
    "late": ("text",),
}
"""What the data of events holds that are raised by the language itself."""
FIELD = re.compile(r"data\s*\??\.\s*([A-Za-z_$][\w$]*)")
GIVEN = ("session", "sensor")
"""The variables of the scope ``application``."""
ABSENT = {
    "console": 'Write <log expr="..."/>.',
    "alert": 'Write <log expr="..."/>.',
    "setTimeout": 'Write <send event="..." delay="..."/> and handle the event.',
    "fetch": 'Write <send to="..."/>, which asks a service.',
    **{name: f"Write sensor.{name}." for name in ("human", "moving", "position")},
    "require": "Write the functions into a <script>.",
    **{
        name: f'There is no browser here. For a variable of your own write <var name="{name}"/>.'
        for name in ("localStorage", "navigator", "sessionStorage", "window")
    },
}
"""Remedies for names that ECMAScript has in other environments."""

NOT_DECLARED = UNDECLARED_VARIABLE.says('The variable "{name}" is not declared.')
NO_VARIABLE = UNDECLARED_VARIABLE.says(
    'No variable can be named "{name}": ECMAScript reserves this word.', "Choose another name."
)
NOT_ASSIGNED = UNDECLARED_VARIABLE.says(
    '"{name}" cannot be assigned: a run tells it to the document.', "Assign a variable of your own."
)
NO_FUNCTION = UNDECLARED_VARIABLE.says('There is no function "{name}".', "Define it in a <script>.")
NO_EVENT_HERE = UNDECLARED_VARIABLE.says(
    'No event is handled here: "{name}" exists only in handlers.',
    "Keep what you need of it in a variable: the handler can <assign> it.",
)
NO_PART = UNDECLARED_VARIABLE.says(
    'An event has no "{name}" of its own; it has name, message and data.', severity="warning"
)
NO_FIELD = UNDECLARED_VARIABLE.says(
    'The data of {event} has no "{name}"; it has {known}.', severity="warning"
)
UNDEFINED = UNDECLARED_VARIABLE.says(
    'The scope "{scope}" declares no variable "{name}": it is undefined.',
    "Name a variable that it has.",
    "warning",
)
NO_SENSOR = UNDECLARED_VARIABLE.says(
    "No <watch> is in force here: sensor is there only where one is.",
    "Write a <watch> into this form or the document.",
    severity="warning",
)
IN_SCRIPT = UNDECLARED_VARIABLE.says(
    'The script uses "{name}", which is not declared.', "Declare it: var {name};", "warning"
)

HIDDEN_ARRAY = DUPLICATE_NAME.says(
    'The item "{name}" hides the variable "{name}", which the array comes from.',
    "Give the item a name of its own.",
    "warning",
)


def place_in(expr: Expression, characters: int) -> Place:
    """The place of a character of an expression or script."""
    return expr.node.source.inside(expr.node.index, expr.attribute, characters)


def _parts_of_event(
    expr: Expression, names: Names, known: Known, handler: Handler | None
) -> Iterator[Problem]:
    """Properties of ``event`` that no event has, and misspelt ones of its data."""
    if "event" in known:
        return
    for use in names.uses:
        if use.name != "event" or use.holder or use.part is None:
            continue
        start, name = use.part
        if name not in PARTS:
            place = place_in(expr, start)
            span = Span.of(place, name)
            data = replaced(f"Write event.data.{name}.", f"data.{name}", span)
            near = suggestion(name, PARTS, span)
            hint = near._replace(text=f"{near.text} Or write event.data.{name}.") if near else data
            yield NO_PART.at(place, hint, name=name)
        elif name == "data" and handler is not None:
            yield from _field_of_data(expr, start, handler)


def _field_of_data(expr: Expression, start: int, handler: Handler) -> Iterator[Problem]:
    """A property of an event's data that is most likely a misspelling of one that it has."""
    found = FIELD.match(expr.code, start)
    kinds = {
        next((one for one in beginnings(event) if one in FIELDS), "") for event in handler.events
    }
    if found is None or len(kinds) != 1 or not (event := kinds.pop()):
        return
    name, known = found[1], FIELDS[event]
    place = place_in(expr, found.start(1))
    hint = Hint() if name in known else suggestion(name, known, Span.of(place, name))
    if hint:
        yield NO_FIELD.at(
            place, hint, event=event, name=name, known=one_of(known).replace(" or ", " and ")
        )


class Variables:
    """Checks the variables that a document's code uses and its acts assign."""

    def __init__(self, facts: Facts) -> None:
        self.facts = facts

    def of_expression(self, expr: Expression, known: Known) -> Iterator[Problem]:
        """The undeclared names in an expression."""
        names = expression_names(expr.code)
        for name, start in names.free.items():
            if name in known:
                continue
            place = place_in(expr, start)
            meant = _meant(place, name, chain(self._given_at(expr.node), known.written()))
            if start in names.called:
                yield NO_FUNCTION.at(place, meant, name=name)
            else:
                bare = _is_bare(expr, name, start)
                yield self._undeclared(expr.node, place, name, meant, bare=bare)
        for name, start in names.handled.items():
            if not (name in known or id(expr.node) in self._handling):
                yield NO_EVENT_HERE.at(place_in(expr, start), name=name)
        if "event" in names.read and id(expr.node) in self._handling:
            yield from _parts_of_event(expr, names, known, self._handling[id(expr.node)])
        if "sensor" in names.read and not (self._senses or "sensor" in known):
            yield NO_SENSOR.at(place_in(expr, names.read["sensor"]))
        yield from self._undefined(expr, names)

    def _undefined(self, expr: Expression, names: Names) -> Iterator[Problem]:
        """Members that nothing declares in their scope."""
        for use in names.uses:
            if not use.holder or use.declares or use.holder in self._whole:
                continue
            members = self._members[use.holder]
            if use.name not in members and (use.holder, use.name) not in self._given_members:
                place = place_in(expr, use.start)
                meant = suggestion(use.name, members.written, Span.of(place, use.name))
                yield UNDEFINED.at(place, meant, scope=use.holder, name=use.name)

    @cached_property
    def _members(self) -> dict[str, NameScope]:
        """The variables that each scope may have as members."""
        written: set[str] = set().union(*(names.written for names in self._names))
        forms = (self.facts.outside_content(form) for form, _ in self.facts.forms)
        return {
            "document": NameScope(self.facts.shared | written),
            "dialog": NameScope(written.union(*forms)),
            "application": NameScope(GIVEN),
        }

    @cached_property
    def _senses(self) -> bool:
        """Whether the document watches any sensor."""
        document = self.facts.document
        return bool(document.watches) or any(form.watches for form in document.forms.values())

    def _given_at(self, node: Node) -> Iterator[str]:
        """Names that the language itself declares for an element's code."""
        yield "session"
        if self._senses:
            yield "sensor"
        if id(node) in self._handling:
            yield from HANDLED

    @cached_property
    def _handling(self) -> dict[int, Handler]:
        """The elements of all handlers, in which the event's variables are visible."""
        inner_last = sorted(self.facts.handlers, key=lambda one: one.node.index)
        return {id(node): handler for handler in inner_last for node in handler.node.walk()}

    def of_script(self, expr: Expression, known: Known) -> Iterator[Problem]:
        """The undeclared names in a script."""
        names = script_names(expr.code)
        for name, start in names.free.items():
            if name not in known:
                place = place_in(expr, start)
                every = chain(self._given_at(expr.node), known.written())
                yield IN_SCRIPT.at(place, _meant(place, name, every), name=name)
        yield from self._undefined(expr, names)
        yield from _parts_of_event(expr, names, known, self._handling.get(id(expr.node)))

    def given(self) -> Iterator[Problem]:
        """Check variables that acts assign, clear or return; wrong names are reported before."""
        for form, assign in self.facts.acts.of(Assign):
            names = self.facts.known_in(form)
            head, dot, rest = assign.name.partition(".")
            name = rest.partition(".")[0] if dot and head in OBJECTS else head
            if head not in names and ".".join(assign.name.split(".")[:2]) in TOLD:
                yield NOT_ASSIGNED.at(assign.node.attribute_place("name"), name=assign.name)
            elif name not in names and IDENTIFIER.fullmatch(name):
                at = assign.node.attribute_place("name")
                at = at._replace(column=at.column + len(head) + 1) if name != head else at
                meant = _meant(at, name, names.written())
                yield self._undeclared(assign.node, at, name, meant)
            elif name != head and not self._is_member(head, name, form):
                remedy = Hint(f"Write the name alone, {name}, or declare it there.")
                yield NO_MEMBER.at(
                    assign.node.attribute_place("name"), remedy, scope=head, name=name
                )
        listed: list[tuple[Form | None, Clear | Return]] = [
            *self.facts.acts.of(Clear),
            *self.facts.acts.of(Return),
        ]
        for form, listing in listed:
            yield from self._listed(listing, self.facts.known_in(form))

    def _is_member(self, scope: str, name: str, form: Form | None) -> bool:
        """Whether a scope has a variable; the document's content runs in forms of any kind."""
        if (scope, name) in self._given_members or (scope == "dialog" and form is None):
            return True
        if scope == "document":
            return name in self.facts.shared
        return scope == "dialog" and form is not None and name in self.facts.outside_content(form)

    @cached_property
    def _given_members(self) -> set[tuple[str, str]]:
        """The variables that code declares in a scope by its name: ``document.x = 1``."""
        uses = chain.from_iterable(one.uses for one in self._names)
        return {(use.holder, use.name) for use in uses if use.holder and use.declares}

    @cached_property
    def _whole(self) -> set[str]:
        """Names of scopes that variables have, or that some code uses as a whole, for any member."""
        hidden = (scope for scope in OBJECTS if scope in self.facts.known_in(None))
        return {*hidden, *(scope for names in self._names for scope in whole_scopes(names.uses))}

    @property
    def _names(self) -> Iterator[Names]:
        """The names in all code."""
        document = self.facts.document
        yield from (expression_names(one.code) for one in document.expressions)
        yield from map(script_names, document.scripts)

    def hidden(self) -> Iterator[Problem]:
        """Items of a foreach that have the name of the variable with their array."""
        for _, loop in self.facts.acts.of(Foreach):
            if loop.item in expression_names(loop.array.code).free:
                yield HIDDEN_ARRAY.at(loop.node.attribute_place("item"), name=loop.item)

    def _listed(self, listing: Clear | Return, known: Known) -> Iterator[Problem]:
        for name in listing.names:
            if name not in known and IDENTIFIER.fullmatch(name):
                place = listing.node.attribute_place("namelist")
                spans = value_span(listing.node, "namelist", name)
                meant = _meant(place, name, known.written(), spans)
                yield self._undeclared(listing.node, place, name, meant)

    @cached_property
    def _declarations(self) -> Declarations:
        return Declarations(self.facts.document.node)

    def _undeclared(
        self, node: Node, place: Place, name: str, meant: Hint, *, bare: bool = False
    ) -> Problem:
        if name in RESERVED:
            return NO_VARIABLE.at(place, meant, name=name)
        hint = meant or self._declarations.hint(f'Declare it: <var name="{name}"/>.', name, node)
        return NOT_DECLARED.at(place, or_text(hint, name) if bare else hint, name=name)


def _is_bare(expr: Expression, name: str, start: int) -> bool:
    """Whether a name is an expression's only one, or compared, and may have been meant as a text."""
    if name in ABSENT or (expr.node.tag == "value" and expr.code.strip() == name):
        return False
    return is_bare(expr.code, name, start)


def _meant(place: Place, name: str, every: Iterable[str], spans: Sequence[Span] = ()) -> Hint:
    """The one of some names that was most likely meant by an undeclared one."""
    if name in ABSENT:
        return Hint(ABSENT[name])
    spans = spans or [Span.of(place, name)]
    return value_elsewhere(name, *spans) or suggestion(name, every, *spans)
