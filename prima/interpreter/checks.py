"""Meaning: what a document says that cannot be so, beyond what its schema can tell."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from itertools import chain
from typing import Any

from prima.errors import Hint, Place, Problem, Severity, Span, few, suggestion
from prima.interpreter.elements import (
    Act,
    Acts,
    Assign,
    Block,
    Clear,
    CommandTemplate,
    Declare,
    Document,
    Exit,
    Expression,
    Field,
    Filled,
    Foreach,
    Form,
    Goto,
    GroupTemplate,
    Handler,
    If,
    Item,
    Log,
    Prompt,
    Return,
    Run,
    Script,
    SendOut,
    StepTemplate,
    Subdialog,
    Text,
    Throw,
    Unit,
    all_acts,
    all_items,
    run_commands,
)
from prima.interpreter.events import DEFAULTS, Events, handlers_of, silent_fields, takes
from prima.interpreter.repeats import source_of, told_twice
from prima.interpreter.rounds import endless_reactions
from prima.interpreter.units import (
    Finder,
    Reached,
    long_unit,
    speak,
    unit_problem,
    unit_speaks,
    units_of,
)
from prima.language.commands import (
    TABLE_4_2,
    Argument,
    CommandType,
    check_argument,
    missing_argument,
)
from prima.language.values import BadValue, nearest, read_value
from prima.markup.spans import Declarations, instead, value_span
from prima.markup.tree import Node
from prima.script.compile import compiled
from prima.script.evaluation import EngineLost, ScriptError
from prima.script.globals import HANDLED
from prima.script.known import Known, Scope
from prima.script.names import expression_names, script_names
from prima.script.parse import parse_expression

MANY_FORMS = 8
"""Of forms that go round, so many are named."""
MANY_STEPS = 200
"""Steps of one run beyond which its branches are not compared."""

STRINGS = re.compile(r""""(?:[^"\\\\]|\\\\.)*"|'(?:[^'\\\\]|\\\\.)*'""")
ASSIGNMENT = re.compile(r"(?<![=!<>+*/%&|^-])(=)(?![=>])")
BRACES = re.compile(r"\$?\{\{?\s*(\w+)\s*\}\}?")
CALL = re.compile(r"\s*\(")
"""What expressions and texts are looked through for."""

LEAVING = (Goto, Return, Exit)
"""Acts behind which nothing is reached."""
SCOPED = ("document", "dialog", "application")
"""Scopes that the name of a variable may begin with."""
NONE: frozenset[str] = frozenset()
VARIABLES = Scope(HANDLED | {"session", "sensor"})
"""What the language itself declares."""
ABSENT = {
    "console": 'Write <log expr="..."/>.',
    "alert": 'Write <log expr="..."/>.',
    "setTimeout": 'Write <send event="..." delay="..."/> and handle the event.',
    "fetch": 'Write <send to="..."/>, which asks a service.',
    "require": "Write the functions into a <script>.",
}
"""What to write instead of what ECMAScript has elsewhere."""


def check_document(document: Document) -> list[Problem]:
    """All problems of meaning in a document."""
    checker = Checker(document)
    checker.check()
    return checker.problems


def check_commands(
    document: Document, commands: Mapping[str, CommandType], devices: frozenset[str] = frozenset()
) -> list[Problem]:
    """Commands of a document that a robot cannot do: warnings, as a document may handle it."""
    problems = _outside_units(document, commands)
    heard = {name for handler in handlers_of(document) for name in handler.events}
    cannot: list[Problem] = []
    for command in document_commands(document):
        row = commands.get(command.type)
        if row is None or row.substitute:
            cannot.append(_cannot(command, row, commands, devices, heard))
        else:
            problems += _arguments(command, row)
    return problems + few(cannot, 1)


def _cannot(
    command: CommandTemplate,
    row: CommandType | None,
    commands: Mapping[str, CommandType],
    devices: frozenset[str],
    heard: set[str],
) -> Problem:
    """A Command that a robot lacks; ``heard`` are the events that the document handles."""
    place = command.node.place
    if command.type not in TABLE_4_2:
        message = f'This robot has no Command "{command.type}".'
        hint = suggestion(command.type, commands, *value_span(command.node, "type"))
        return Problem(place, "error", "unsupported-command", message, hint)
    lacking = sorted(TABLE_4_2[command.type].devices - devices) if devices else []
    lacks = f": it lacks {', '.join(lacking)}" if lacking else ""
    event = f"error.unsupported.{command.type}"
    message = f"This robot cannot do {command.type}{lacks}. At run time it is {event}."
    if row is not None:
        message += f" With the extension x6 {row.substitute} takes its place."
    handled = any(takes(name, event) for name in heard)
    remedy = "" if handled else f'Handle it: <on event="{event}">.'
    return Problem(place, "warning", "unsupported-command", message, remedy)


def _arguments(command: CommandTemplate, row: CommandType) -> Iterator[Problem]:
    """What is wrong with the arguments of a Command that only a robot's profile knows."""
    place = command.node.place
    for name, _ in command.extra:
        if name not in row.extra and name not in row.arguments:
            message = f'This robot\'s {command.type} has no additional argument "{name}".'
            known = row.extra | set(row.arguments)
            params = [one for one in command.node.all("param") if one.get("name") == name]
            spans = [span for one in params[:1] for span in value_span(one, "name")]
            hint = suggestion(name, known, *spans)
            yield Problem(place, "error", "no-such-argument", message, hint)
    if command.node.tag == "command":  # arguments of others are attributes, looked at already
        given = dict(command.extra)
        yield from given_to(command.node, row, given, bool(command.text))


def given_to(
    node: Node, row: CommandType, given: Mapping[str, object], says: bool
) -> Iterator[Problem]:
    """What is wrong with the motion arguments and the text of a Command's element.

    Args:
        node: the element.
        row: what the robot's profile says of the Command.
        given: its arguments, by name; only those are looked at whose values are texts.
        says: whether it has a text.
    """
    for name, value in given.items():
        if name in row.arguments and isinstance(value, str):
            yield from _argument(node, name, row.arguments[name], value)
    if missing := missing_argument(row, given):
        needed = [name for name, one in row.arguments.items() if one.required or one.choice]
        lacking = next(name for name in needed if name not in given)
        remedy = f'Write {lacking}="...".'
        if node.tag == "command":
            remedy = f'Write <param name="{lacking}" value="..."/> into it.'
        yield Problem(node.place, "error", "missing-attribute", missing, remedy)
    if row.text == "none" and says:
        remedy = "Say it with <speak>."
        yield Problem(node.place, "error", "stray-text", f"{row.name} cannot say anything.", remedy)


def _argument(node: Node, name: str, argument: Argument, text: str) -> Iterator[Problem]:
    """What is wrong with a motion argument's value: of a param, or of the element's own attribute."""
    param = next((one for one in node.all("param") if one.get("name") == name), None)
    holder, attribute = (node, name) if param is None else (param, "value")
    place = holder.attribute_place(attribute) if attribute in holder.attributes else holder.place
    try:
        check_argument(name, argument, text)
    except BadValue as error:
        if not error.beyond:
            yield Problem(place, "error", "bad-value", error.wrong, error.remedy)
            return
        value, spans = float(read_value(argument.kind, text)), value_span(holder, attribute)
        hint = nearest(argument.kind, value, argument.low, argument.high, *spans)
        yield Problem(place, "error", "out-of-range", error.wrong, hint)


def _outside_units(document: Document, commands: Mapping[str, CommandType]) -> list[Problem]:
    """U4, U5: Commands of the profile's own that cannot stand in a unit."""
    problems: dict[int, Problem] = {}

    def look(one: Reached, unit: Unit | None = None) -> None:
        problem = unit_problem(one, _own_row(one.command, commands), unit)
        if problem is not None:
            problems.setdefault(id(one.command), problem)

    finder = Finder(document)
    for form, unit in units_of(document):
        for one in finder.reach(form, unit).commands:
            look(one, unit)
    for command in _grouped(document):
        look(Reached(command, True))
    return [*problems.values()]


def _own_row(command: CommandTemplate, commands: Mapping[str, CommandType]) -> CommandType | None:
    """The row of a Command that a robot's profile adds."""
    return None if command.type in TABLE_4_2 else commands.get(command.type)


def _grouped(document: Document) -> Iterator[CommandTemplate]:
    """The Commands in units around Commands (U4)."""
    for _, content, _ in document.contents():
        for act in all_acts(content):
            for step in act.steps if isinstance(act, Run) else ():
                if isinstance(step.what, GroupTemplate):
                    yield from run_commands([step])


def document_commands(document: Document) -> Iterator[CommandTemplate]:
    """Every Command of a document."""
    for _, content, _ in document.contents():
        for act in all_acts(content):
            if isinstance(act, Run):
                yield from run_commands(act.steps)


def _check_code(code: str, script: bool) -> None:
    """Compile a script or an expression by an engine, which simple code does without."""
    from prima.script.isolated import syntax

    (syntax().script if script else syntax().expression)(code)


def _look_ahead(codes: list[tuple[str, bool]]) -> None:
    """Let the engine look at all code at once that needs it: each call takes time."""
    if len(codes) > 1:
        from prima.script.isolated import syntax

        with suppress(ScriptError):  # who asks for one of them is told that it cannot be started
            syntax().look_ahead(codes)


class Leads:
    """Where forms lead, by their names, and the document's own content (None)."""

    __slots__ = ("anywhere", "calls", "exits", "targets")

    def __init__(self) -> None:
        self.targets: defaultdict[str | None, list[str]] = defaultdict(list)
        """Forms they go to."""
        self.anywhere: set[str | None] = set()
        """Those of which an expression says where they go."""
        self.calls: defaultdict[str | None, list[str]] = defaultdict(list)
        """Forms they call as subdialogs."""
        self.exits: set[str | None] = set()
        """Those that an exit may end."""

    def of(self, form: str) -> list[str]:
        """All that a form goes to or calls."""
        return [*self.targets.get(form, ()), *self.calls.get(form, ())]


def _of_run(run: Run) -> Iterator[object]:
    for command in run_commands(run.steps):
        yield from command.args.values()
        yield from command.text or ()
        yield from (value for _, value in command.extra)
        yield from (handler.cond for handler in command.handlers)


HELD: Mapping[type[Act], Callable[[Any], Iterable[object]]] = {
    Declare: lambda act: (act.expr,),
    Assign: lambda act: (act.expr,),
    If: lambda act: [cond for cond, _ in act.branches],
    Foreach: lambda act: (act.array,),
    Log: lambda act: act.text,
    Throw: lambda act: (act.event, act.message),
    Goto: lambda act: (act.form, act.item),
    SendOut: lambda act: (act.service, act.delay, *(value for _, value in act.params)),
    Run: _of_run,
}
"""What acts hold that may be expressions, by kinds; scripts are looked at by themselves."""


class Checker:
    """Looks for each kind of mistake in a document, among what has been gathered of it."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.problems: list[Problem] = []
        self.acts = Acts(document)
        self.shared = Scope(self._setup_names(document.setup))
        self._declared: dict[str | None, Scope] = {}
        """Names by the form whose content declares them; None for the document."""
        self._given: dict[str, Scope] = {}
        """Names that subdialogs give as params, by the form they call."""
        self._waiting: list[tuple[Expression, Known, bool]] = []
        """Code that only an engine understands, with the names that it may use, and whether it is a script."""
        self._gather()
        self._common = Scope(self.shared | self._declared.get(None, NONE))
        self._leads = self._led()

    @property
    def forms(self) -> Iterator[tuple[Form, Sequence[Item]]]:
        """Forms with all their items."""
        return ((form, all_items(form.items)) for form in self.document.forms.values())

    def note(
        self,
        node: Node,
        code: str,
        message: str,
        remedy: str | Hint = "",
        attribute: str = "",
        severity: Severity = "error",
    ) -> None:
        """Note a problem at an element or an attribute's value."""
        place = node.attribute_place(attribute) if attribute in node.attributes else node.place
        self.problems.append(Problem(place, severity, code, message, remedy))

    def check(self) -> None:
        """Check everything."""
        self._targets()
        self._hints()
        self._reachable()
        self._names()
        self._expressions()
        self._commands()
        self._rounds()
        self.problems += endless_reactions(self.document)
        self._leaving()
        self._silence()
        self.problems += Events(self.document, self.acts).problems()
        self._after_goto()
        self.problems += told_twice([source_of(self.document)])

    # States -------------------------------------------------------------------

    def _form(self, name: str, node: Node, attribute: str) -> None:
        forms = self.document.forms
        if name not in forms and "#" in node.get(attribute):  # else told already
            message = f'There is no form "{name}" to go to.'
            hint = suggestion(name, forms, *value_span(node, attribute, name))
            self.note(node, "no-such-form", message, hint, attribute)

    def _targets(self) -> None:
        for form, act in self.acts.of(Goto):
            self._goto(act, form)
        for _, items in self.forms:
            for item in items:
                if isinstance(item, Subdialog):
                    self._form(item.form, item.node, "src")
        links = [*self.document.links, *(x for f in self.document.forms.values() for x in f.links)]
        for link in links:
            if link.form:
                self._form(link.form, link.node, "next")

    def _goto(self, act: Goto, form: Form | None) -> None:
        if isinstance(act.form, str):
            self._form(act.form, act.node, "next")
        if isinstance(act.item, str):
            names = self._item_names[form.id if form else None]
            if act.item not in names:
                message = f'There is no form item "{act.item}" to go to.'
                hint = suggestion(act.item, names, *value_span(act.node, "nextitem"))
                if act.item in self.document.forms:
                    remedy = f'It is a form: write next="#{act.item}".'
                    hint = instead(remedy, act.node, "nextitem", "next", f"#{act.item}")
                self.note(act.node, "no-such-item", message, hint, "nextitem")

    @cached_property
    def _item_names(self) -> dict[str | None, set[str]]:
        """The names of the items of each form, and of all (None)."""
        found: dict[str | None, set[str]] = {
            form.id: {item.name for item in items} for form, items in self.forms
        }
        return {**found, None: set().union(*found.values())}

    def _led(self) -> Leads:
        """Where each form leads, and the document's own content."""
        found = Leads()
        for form, goto in self.acts.of(Goto):
            name = form.id if form else None
            if isinstance(goto.form, str):
                found.targets[name].append(goto.form)
            elif goto.form is not None:
                found.anywhere.add(name)
        found.exits = {form.id if form else None for form, _ in self.acts.of(Exit)}
        holders = [(None, self.document.links), *((form.id, form.links) for form, _ in self.forms)]
        for name, links in holders:
            for link in links:
                if link.form:
                    found.targets[name].append(link.form)
        for form, items in self.forms:
            for item in items:
                if isinstance(item, Subdialog):
                    found.calls[form.id].append(item.form)
        return found

    def _reached(self, names: Iterable[str], calls: bool) -> set[str]:
        """The forms that some forms lead to, themselves included; with subdialogs or without."""
        reached: set[str] = set()
        waiting = list(names)
        while waiting:
            name = waiting.pop()
            if name in reached or name not in self.document.forms:
                continue
            reached.add(name)
            if name in self._leads.anywhere:
                return set(self.document.forms)
            waiting += self._leads.of(name) if calls else self._leads.targets.get(name, ())
        return reached

    def _hints(self) -> None:
        """X3: what a held stream costs others, and hints that can have no effect."""
        for form, items in self.forms:
            pieces: list[Form | Item] = [form, *items]
            for one in pieces:
                node = one.node
                if "hold-for" in node.attributes and "stream" not in node.attributes:
                    message = "hold-for says how long, but nothing is held."
                    self.note(
                        node, "idle-hint", message, 'Add stream="hold".', "hold-for", "warning"
                    )
                if not one.hold or "stream" not in node.attributes or bad_hold(node):
                    continue
                handlers = (*form.handlers, *self.document.handlers)
                if not (handlers or form.watches or form.links or self.document.links):
                    message = "The stream is held, but there is no event to wait for here."
                    remedy = 'Handle the event with <on event="...">.'
                    self.note(node, "idle-hint", message, remedy, "stream", "warning")
                else:
                    message = (
                        f"With the extension x3 another application waits up to {one.hold / 1000:g} s"
                        " for each event awaited here, unless it reacts to one itself."
                    )
                    self.note(node, "hold-price", message, "", "stream", "note")

            if form.connect and not self.document.handlers and not self._speaks(form, items):
                message = (
                    "The robot is to turn to the user before its first word, but says none here."
                )
                self.note(form.node, "idle-hint", message, "Remove the hint.", "channel", "warning")

    def _speaks(self, form: Form, items: Sequence[Item]) -> bool:
        """Whether the robot says or asks something in a form, as far as can be seen."""
        asks = any(isinstance(item, Field | Subdialog) for item in items)
        return asks or form.id in self._speaking

    @cached_property
    def _speaking(self) -> set[str]:
        """The forms whose content has the robot say something."""
        return {
            form.id
            for form, run in self.acts.of(Run)
            if form
            and any(one.text or one.type not in TABLE_4_2 for one in run_commands(run.steps))
        }

    def _reachable(self) -> None:
        forms = self.document.forms
        if not forms:
            return
        leads = self._leads
        starts = [next(iter(forms)), *leads.targets.get(None, ())]
        starts = [*forms] if None in leads.anywhere else starts
        reached = self._reached(starts, calls=True)
        called = {name for calls in leads.calls.values() for name in calls}
        inside = self._reached(called, calls=False)
        exiting = self._exiting()
        ways = self._ways()
        for name, form in forms.items():
            if not name:
                continue  # nothing can name it, which has been told
            if name not in reached:
                self.note(
                    form.node, "unreachable", f'Nothing leads to the form "{name}".',
                    "Go to it from somewhere, or remove it.", "id", "warning",
                )  # fmt: skip
            asks = any(isinstance(item, Field) for item in all_items(form.items))
            left = name in ways or None in ways or (asks and "" in ways)
            left = left or not exiting.isdisjoint(leads.calls.get(name, ()))
            if not left and name in reached:
                remedy = (
                    "To come back from the subdialog, write <return/>."
                    if name in inside
                    else "If the application is over here, write <exit/>."
                )
                message = f'The form "{name}" can never be left.'
                self.note(form.node, "dead-end", message, remedy, "id", "warning")

    def _ways(self) -> set[str | None]:
        """The forms that can be left but by an error; None if every form can, "" if all that ask can.

        A handler of errors is no way out: nobody writes a state that is left when it fails.
        """
        failing: set[int] = set()
        asking: set[int] = set()
        for handler in handlers_of(self.document, self.acts):
            if all(event.partition(".")[0] == "error" for event in handler.events):
                failing |= set(map(id, all_acts(handler.content)))
        for handler in self.document.handlers:
            if DEFAULTS.issuperset(handler.events):
                asking |= set(map(id, all_acts(handler.content)))
        found: set[str | None] = {None} if any(link.form for link in self.document.links) else set()
        found |= {form.id for form, _ in self.forms if any(link.form for link in form.links)}
        for kind in (Goto, Exit, Return, Throw):
            for stands, act in self.acts.of(kind):
                stays = isinstance(act, Goto) and act.form is None
                if not stays and id(act) not in failing:
                    found.add("" if id(act) in asking else stands.id if stands else None)
        return found

    def _exiting(self) -> set[str]:
        """The forms from which an exit can be reached, through gotos and subdialogs."""
        forms = self.document.forms
        waiting = [name for name in forms if name in self._leads.exits]
        if not waiting:
            return set()
        waiting += [name for name in forms if name in self._leads.anywhere]
        leading: dict[str, list[str]] = {}
        for name in forms:
            for target in self._leads.of(name):
                leading.setdefault(target, []).append(name)
        found: set[str] = set()
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                waiting += leading.get(name, [])
        return found

    # Names --------------------------------------------------------------------

    @staticmethod
    def _setup_names(setup: Iterable[Declare | Script]) -> set[str]:
        names: set[str] = set()
        for act in setup:
            names |= (
                {act.name} if isinstance(act, Declare) else script_names(act.code.code).declared
            )
        return names

    def _names(self) -> None:
        for form, items in self.forms:
            if not (items or form.filled):
                continue
            seen: set[str] = set()
            for item in items:
                if item.name in seen:
                    message = f'The form "{form.id}" has two items named "{item.name}".'
                    self.note(item.node, "duplicate-name", message, "Rename one.", "name")
                seen.add(item.name)
            asking = [item for item in items if isinstance(item, Field | Subdialog)]
            inputs = Scope(item.name for item in asking)
            for filled in (*form.filled, *(one for item in asking for one in item.filled)):
                self._namelist(filled, filled.names, inputs, "field")

    def _namelist(
        self, holder: Filled | Clear, names: Sequence[str], known: Scope, what: str
    ) -> None:
        for name in names:
            if name not in known:
                message = f'There is no {what} "{name}".'
                spans = value_span(holder.node, "namelist", name)
                hint = suggestion(name, known.written, *spans)
                self.note(holder.node, "no-such-item", message, hint, "namelist")

    def _gather(self) -> None:
        """Names by the form that declares them, found in one go."""
        for form, declare in self.acts.of(Declare):
            self._own(form).add(declare.name)
        for form, script in self.acts.of(Script):
            self._own(form).update(script_names(script.code.code).declared)
        for form, loop in self.acts.of(Foreach):
            self._own(form).add(loop.item)
        for form, items in self.forms:
            if form.setup:
                self._own(form).update(self._setup_names(form.setup))
            for item in items:
                if item.node.get("name"):
                    self._own(form).update((item.name, f"{item.name}$"))
                if isinstance(item, Subdialog):
                    given = self._given.setdefault(item.form, Scope())
                    given |= {name for name, _ in item.params}

    def _own(self, form: Form | None) -> Scope:
        return self._declared.setdefault(form.id if form else None, Scope())

    @cached_property
    def _every(self) -> Known:
        """All variables that there are."""
        return Known(Scope(self.shared.union(*self._declared.values(), *self._given.values())))

    def known_in(self, form: Form | None) -> Known:
        """All variables that content of a form may see, or the document's own content (None)."""
        if form is None:
            return self._every
        own, given = self._declared.get(form.id), self._given.get(form.id)
        return Known(self._common, *filter(None, (own, given)))

    # Expressions --------------------------------------------------------------

    def _expressions(self) -> None:
        document = self.document
        self._outside(document, Known(self.shared), self.known_in(None))
        for form, items in self.forms:
            known = self.known_in(form)
            self._outside(form, known, known)
            for item in items:
                self._item(item, known)
        for kind, held in HELD.items():
            for stands, act in self.acts.of(kind):
                for one in held(act):
                    if isinstance(one, Expression):
                        self._expression(one, self.known_in(stands))
        for stands, script in self.acts.of(Script):
            self._script(script, self.known_in(stands))
        self._compile()
        self._variables()

    def _outside(self, holder: Document | Form, known: Known, later: Known) -> None:
        """Code of a document or form that is in no content; ``later`` is seen by its handlers."""
        for act in holder.setup:
            if isinstance(act, Script):
                self._script(act, known)
            elif act.expr is not None:
                self._expression(act.expr, known)
        for watch in holder.watches:
            self._expression(watch.when, known)
        self._conditions(holder.handlers, later)

    def _conditions(self, conditional: Iterable[Handler | Prompt], known: Known) -> None:
        for one in conditional:
            if one.cond is not None:
                self._expression(one.cond, known)

    def _item(self, item: Item, known: Known) -> None:
        """Code of a form item that is in no content."""
        self._conditions(item.handlers, known)
        held: list[object] = [item.expr, item.cond]
        if isinstance(item, Field):
            self._conditions(item.prompts, known)
            held += [part for prompt in item.prompts for part in prompt.text]
        elif isinstance(item, Subdialog):
            held += [value for _, value in item.params]
        for one in held:
            if isinstance(one, Expression):
                self._expression(one, known)

    def _variables(self) -> None:
        """Variables that acts give a value, clear or return."""
        for form, assign in self.acts.of(Assign):
            names = self.known_in(form)
            head, dot, rest = assign.name.partition(".")
            name = rest.partition(".")[0] if dot and head in SCOPED else head
            if name not in names:
                at = assign.node.attribute_place("name")
                at = at._replace(column=at.column + len(head) + 1) if name != head else at
                self._undeclared(assign.node, at, name, names)
        listed: list[tuple[Form | None, Clear | Return]] = [
            *self.acts.of(Clear),
            *self.acts.of(Return),
        ]
        for form, listing in listed:
            names = self.known_in(form)
            for name in listing.names:
                if name not in names:
                    at = listing.node.attribute_place("namelist")
                    spans = value_span(listing.node, "namelist", name)
                    self._undeclared(listing.node, at, name, names, spans=spans)

    def _undeclared(
        self,
        node: Node,
        place: Place,
        name: str,
        known: Known,
        bare: bool = False,
        called: bool = False,
        spans: Sequence[Span] = (),
    ) -> None:
        hint = self._meant(place, name, known, spans)
        if called:
            message = f'There is no function "{name}".'
            hint = hint or Hint("Define it in a <script>.")
        else:
            message = f'The variable "{name}" is not declared.'
            declare = f'Declare it: <var name="{name}"/>.'
            hint = hint or self._declarations.hint(declare, name, node)
        if bare and name not in ABSENT:
            hint = hint._replace(text=f"{hint.text} For the text itself write '{name}'.")
        self.problems.append(Problem(place, "error", "undeclared-variable", message, hint))

    @cached_property
    def _declarations(self) -> Declarations:
        return Declarations(self.document.node)

    @staticmethod
    def _meant(place: Place, name: str, known: Known, spans: Sequence[Span] = ()) -> Hint:
        """What was most likely meant by a name that nothing declares."""
        if name in ABSENT:
            return Hint(ABSENT[name])
        every = chain(VARIABLES, known.written())
        return suggestion(name, every, *(spans or [Span.of(place, name)]))

    def _expression(self, expr: Expression, known: Known) -> None:
        if compiled(expr.code) is None:
            self._waiting.append((expr, known, False))
        else:
            self._used(expr, known)

    def _script(self, act: Script, known: Known) -> None:
        self._waiting.append((act.code, known, True))

    def _compile(self) -> None:
        """Check the code that only an engine understands."""
        _look_ahead([(expr.code, script) for expr, _, script in self._waiting])
        for expr, known, script in self._waiting:
            if self._compiles(expr, script):
                (self._used_by_script if script else self._used)(expr, known)

    def _used(self, expr: Expression, known: Known) -> None:
        """Note the names that an expression uses and nothing declares."""
        names = expression_names(expr.code)
        for name, start in names.free.items():
            if name not in known:
                bare = expr.code.strip() == name and expr.node.tag != "value"
                called = CALL.match(expr.code, start + len(name)) is not None
                self._undeclared(expr.node, _place_in(expr, start), name, known, bare, called)
        for name, start in names.handled.items():
            if not (name in known or id(expr.node) in self._handling):
                self._unhandled(_place_in(expr, start), name)
        self._assigns(expr)

    @cached_property
    def _handling(self) -> set[int]:
        """The elements of all handlers: what is in them knows the event."""
        handlers = handlers_of(self.document, self.acts)
        return {id(node) for handler in handlers for node in handler.node.walk()}

    def _unhandled(self, place: Place, name: str) -> None:
        message = f'No event is handled here: "{name}" is there in a handler only.'
        remedy = "Keep what you need of it in a variable: the handler can <assign> it."
        self.problems.append(Problem(place, "error", "undeclared-variable", message, remedy))

    def _assigns(self, expr: Expression) -> None:
        """A condition that gives a variable a value, where a comparison was meant."""
        if "=" not in expr.code or expr.attribute not in ("cond", "when"):
            return
        parsed = parse_expression(expr.code)
        for node in parsed.walk() if parsed is not None else ():
            if parsed is not None and node.type == "assignment_expression":
                message = "This condition gives a variable a value; it does not compare."
                place = _place_in(expr, parsed.start(node.children[1]))
                problem = Problem(place, "warning", "assigning-condition", message, "Write ==.")
                self.problems.append(problem)
                return

    def _used_by_script(self, expr: Expression, known: Known) -> None:
        """Note the names that a script uses and nothing declares."""
        for name, start in script_names(expr.code).free.items():
            if name not in known:
                message = f'The script uses "{name}", which nothing declares.'
                place = _place_in(expr, start)
                code = "undeclared-variable"
                hint = self._meant(place, name, known)
                self.problems.append(Problem(place, "warning", code, message, hint))

    def _compiles(self, expr: Expression, script: bool = False) -> bool:
        if expr.attribute and expr.attribute not in expr.node.attributes:
            return False  # it is missing, which has been told
        try:
            _check_code(expr.code, script)
        except ScriptError as error:
            shown = " ".join(expr.code.split())
            shown = shown if len(shown) <= 60 else shown[:57] + "..."
            message = f'"{shown}" is not ECMAScript: {error}.'
            place = expr.node.code_place(expr.attribute, error.line, error.column)
            if isinstance(error, EngineLost):  # perhaps from outside: a run may still go well
                message = f'"{shown}" cannot be checked: {error}.'
                self.problems.append(Problem(place, "warning", "bad-expression", message))
                return False
            remedy = self._expression_remedy(expr.code)
            self.problems.append(Problem(place, "error", "bad-expression", message, remedy))
            return False
        return True

    @staticmethod
    def _expression_remedy(code: str) -> str:
        """What to write for an expression that is none, where that is a common slip."""
        from prima.markup.slips import half

        bare = STRINGS.sub("", code)
        wide = [
            one
            for one in ("" if bare.isascii() else bare)
            if not one.isascii() and half(one).isascii() and half(one).strip()
        ]
        if wide:
            return "Write it in characters of half width: " + " ".join(map(half, wide[:5])) + "."
        if "${" in bare:
            return "Write the expression alone, without ${ and }."
        if re.search(r"=\s+=", bare):
            return "Write == without a space."
        for word, right in (("and", "&amp;&amp;"), ("or", "||"), ("not", "!")):
            if word in bare and re.search(rf"\b{word}\b", bare):
                return f"Write {right} for {word}."
        return ""

    # Commands -----------------------------------------------------------------

    def _commands(self) -> None:
        for form, run in self.acts.of(Run):
            self._braces(run.steps, form)
            self._branches(run.steps)
            self._endless(run.steps, form)
            self._long_units(run.steps)
        for form, items in self.forms:
            for item in items:
                if isinstance(item, Unit):
                    self.problems += long_unit(item.node, unit_speaks(item, self.document.lang))
                for prompt in item.prompts if isinstance(item, Field) else ():
                    self._literal(prompt.node, prompt.text, form)

    def _braces(self, steps: Sequence[StepTemplate], form: Form | None) -> None:
        """Text with a variable in braces, as other languages write a value."""
        for command in run_commands(steps):
            self._literal(command.node, command.text, form)

    def _literal(self, node: Node, text: Text | None, form: Form | None) -> None:
        for part in text or ():
            found = BRACES.search(part) if isinstance(part, str) and "{" in part else None
            if found and found[1] in (self.known_in(form) if form else self.shared):
                message = f'"{found[0]}" is said as it stands.'
                remedy = f'Write <value expr="{found[1]}"/>.'
                self.note(node, "literal-value", message, remedy, severity="warning")

    def _branches(self, steps: Sequence[StepTemplate]) -> None:
        """U3: branches of a par that share a device run one after the other."""
        chained = all(step.after == ((n - 1,) if n else ()) for n, step in enumerate(steps))
        if chained or len(steps) > MANY_STEPS:
            return
        for index, step in enumerate(steps):
            for second, other in enumerate(steps[index + 1 :], index + 1):
                if not self._parallel(steps, index, second):
                    continue
                both = _devices(step) & _devices(other)
                if both:
                    node = other.what.node
                    message = (
                        f"This branch shares {', '.join(sorted(both))} with another:"
                        " they run one after the other."
                    )
                    remedy = "Write them one after the other, in a <seq>."
                    self.note(node, "shared-device", message, remedy, severity="warning")
                    return

    @staticmethod
    def _parallel(steps: Sequence[StepTemplate], first: int, second: int) -> bool:
        """Whether neither of two steps waits for the other."""
        waiting, seen = [second], set()
        while waiting:
            index = waiting.pop()
            if index == first:
                return False
            if index not in seen:
                seen.add(index)
                waiting += steps[index].after
        return True

    def _endless(self, steps: Sequence[StepTemplate], form: Form | None) -> None:
        """E4: a feedback Command without an end of its own, in a state without handlers."""
        for command in run_commands(steps):
            if command.type != "tracking-human" or form is None:
                continue
            ways = [*form.handlers, *self.document.handlers, *form.links, *self.document.links]
            if not ways:
                message = "tracking-human never ends by itself, and this state handles no event."
                self.note(
                    command.node, "endless", message,
                    'Handle an event: <on event="touch"><goto .../></on>.', severity="warning",
                )  # fmt: skip

    def _rounds(self) -> None:
        """E4: forms that go to each other for ever without asking or waiting for anything."""
        gotos = {form.id: self._always(form) for form, items in self.forms if items}
        told: set[str] = set()
        for start in gotos:
            way: list[str] = []
            passed: set[str] = set()
            name = start
            while name not in passed and name not in told and (act := gotos.get(name)):
                way.append(name)
                passed.add(name)
                name = act.form if isinstance(act.form, str) else ""
            told |= passed
            last = gotos[way[-1]] if way else None
            if last is None or name not in passed:
                continue
            ring = way[way.index(name) :]
            more = ", ..." if len(ring) > MANY_FORMS else ""
            goes = f"The forms {', '.join(ring[:MANY_FORMS])}{more} go round"
            if len(ring) == 1:
                goes = f'The form "{name}" goes to itself'
            message = f"{goes} without asking or waiting: no other application has a turn."
            remedy = 'Wait for an event: <send event="..." delay="10s"/> and <on event="...">.'
            self.note(last.node, "endless", message, remedy, "next", "warning")

    @staticmethod
    def _always(form: Form) -> Goto | None:
        """The goto to a form by which a form is left for certain, without a question or a wait."""
        for item in form.items:
            if not isinstance(item, Block) or item.cond is not None or item.expr is not None:
                return None
            for act in item.content:
                if isinstance(act, If | Foreach | Throw | Exit | Return):
                    return None
                if isinstance(act, Goto):
                    return act if isinstance(act.form, str) else None
        return None

    def _leaving(self) -> None:
        """3.3: a Command that leaves the user while a question is to be asked again."""
        every = list(self.document.handlers)
        for form, items in self.forms:
            fields = [item for item in items if isinstance(item, Field)]
            every += form.handlers if fields else []
            for field in fields:
                for handler in field.handlers:
                    self._leaves(handler)
        for handler in every:
            if not DEFAULTS.isdisjoint(handler.events):
                self._leaves(handler)

    def _leaves(self, handler: Handler) -> None:
        """Note where a handler drives away from a question and comes back to it."""
        acts = all_acts(handler.content)
        if any(isinstance(act, Goto | Exit | Return | Throw) for act in acts):
            return
        commands = [one for act in acts if isinstance(act, Run) for one in run_commands(act.steps)]
        leaving = [one for one in commands if one.type in TABLE_4_2 and TABLE_4_2[one.type].leaves]
        if leaving and not any(one.type == "active-sensing-human" for one in commands):
            node = leaving[0].node
            message = f"<{node.tag}> leaves the user, and then the question is asked again."
            remedy = (
                "Leave the question with <goto>, or look for the user first:"
                " <active-sensing-human/> behind it."
            )
            self.note(node, "leaves-question", message, remedy, severity="warning")

    def _silence(self) -> None:
        """K1: questions that are asked for ever while nobody answers."""
        for field in silent_fields(self.document):
            message = (
                f'If nobody answers "{field.name}", it is asked for ever,'
                " and other applications cannot drive anywhere."
            )
            remedy = 'Write <noinput count="3"><exit/></noinput>, or where else to go.'
            self.note(field.node, "no-noinput", message, remedy, severity="warning")

    def _long_units(self, steps: Sequence[StepTemplate]) -> None:
        for step in steps:
            if isinstance(step.what, GroupTemplate):
                commands = run_commands(step.what.steps)
                self.problems += long_unit(step.what.node, speak(commands, self.document.lang))

    def _after_goto(self) -> None:
        """Content behind a goto, return or exit is never reached."""
        for _, content, _ in self.document.contents():
            self._dead(content)

    def _dead(self, content: Sequence[Act]) -> None:
        for index, act in enumerate(content, 1):
            if isinstance(act, LEAVING):
                for behind in content[index : index + 1]:
                    message = (
                        f"<{behind.node.tag}> stands behind <{act.node.tag}> and is never reached."
                    )
                    remedy = f"Put it before <{act.node.tag}>, or remove it."
                    self.note(behind.node, "dead-content", message, remedy, severity="warning")
                return
            if isinstance(act, If):
                for _, branch in act.branches:
                    self._dead(branch)
            elif isinstance(act, Foreach):
                self._dead(act.content)


def _place_in(expr: Expression, characters: int) -> Place:
    """The place of a character of an expression or script."""
    return expr.node.source.inside(expr.node.index, expr.attribute, characters)


def _devices(step: StepTemplate) -> frozenset[str]:
    commands = (
        run_commands(step.what.steps) if isinstance(step.what, GroupTemplate) else [step.what]
    )
    devices: frozenset[str] = frozenset()
    for command in commands:
        row = TABLE_4_2.get(command.type)
        if row is not None:
            devices |= row.occupied("x" if command.text else None)
    return devices


def bad_hold(node: Node) -> bool:
    """Whether an element's hold-for is no time, which has been told already."""
    try:
        return int(read_value("duration", node.get("hold-for", "1s"))) <= 0
    except ValueError:
        return True
