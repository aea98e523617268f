"""From nodes to values: reads attributes, and says what is wrong with each value."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from prima.errors import Diagnosis, Hint, Problem
from prima.errors.diagnosis import NO_HINT
from prima.grammar.answers import Answers
from prima.grammar.text import fold
from prima.interpreter.diagnoses import (
    BAD_PROPERTY,
    BEHIND_ELSE,
    BEYOND,
    EMPTY_OPTION,
    EMPTY_UNIT,
    FOR_FAS,
    HAS_BOTH,
    ID_WITH_DOT,
    NAME_WITH_DOT,
    NEEDS_ARGUMENT,
    NEEDS_EITHER,
    NEEDS_VALUE,
    NO_DELAY,
    NO_FORM_AT_ALL,
    NO_GRAMMAR,
    ONLY_A_PAUSE,
    ONLY_ONE,
    RESERVED_NAME,
    SAYS_NOTHING,
    SPEAKS_TOO_LONG,
    TAKES_NO_ANSWER,
    TWO_FORMS,
    TWO_OPTIONS,
)
from prima.interpreter.elements import (
    Act,
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
    Link,
    Log,
    Pause,
    Prompt,
    Reprompt,
    Return,
    Run,
    Script,
    SendOut,
    StepTemplate,
    Subdialog,
    Text,
    Throw,
    Unit,
    Watch,
    pauses_in,
    run_commands,
)
from prima.interpreter.units import (
    LONGEST_UNIT_MS,
    Finder,
    Reached,
    now_inside,
    unit_problem,
    units_of,
)
from prima.interpreter.vocabulary import ACTING, DIALOGUE, HANDLERS, PROPERTIES
from prima.language.commands import (
    TABLE_4_2,
    CommandType,
    check_argument,
    excluding_arguments,
    missing_argument,
    too_long,
)
from prima.language.values import XML_SPACE, BadValue, nearest, outside, read_value, within
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute
from prima.script.evaluation import SCOPES
from prima.script.globals import HANDLED, RESERVED

if TYPE_CHECKING:
    from prima.grammar.grammar import Grammar
    from prima.interpreter.grammars import Fetch
    from prima.messages import Json

HOLD_MS = 15_000
"""How long a stream is held for an event unless hold-for says otherwise (X3)."""

Parts = dict[str, list[Node]]
"""The child elements of an element by what they are for: see :data:`PARTS`."""
PARTS = {
    **dict.fromkeys(HANDLERS, "handlers"),
    **dict.fromkeys(("var", "script"), "setup"),
    **dict.fromkeys(("block", "field", "subdialog", "iu"), "items"),
}
"""What elements are for that others are for as well; the rest go by their tags."""
COMMANDS = frozenset(ACTING)
EVENT = re.compile(r"event|_message|\beval\b|valueOf|\\u")
"""What code has that may look at the event that is being handled."""
ONLY_NEXT = frozenset(["next"])


class Builder:
    """Builds a document; what is wrong is collected in ``problems``, and building goes on."""

    def __init__(self, root: Node, fetch: Fetch | None = None) -> None:
        self.root = root
        self.fetch = fetch
        """Gives the bytes of files that the document names."""
        self.outside = False
        """Whether it names any."""
        self.problems: list[Problem] = []
        self.lang = root.get("xml:lang", "en")
        self.expressions: list[Expression] = []
        self.words: list[str] = []
        """Code and names of variables that are no expressions."""
        self.scripted = self.counting = False
        self._unnamed = 0
        self._runs = 0
        """How many runs of Commands have been built."""

    # Reading attributes -----------------------------------------------------

    def problem(
        self,
        diagnosis: Diagnosis,
        node: Node,
        attribute: str = "",
        hint: Hint = NO_HINT,
        **parameters: object,
    ) -> None:
        """Note a problem at an element or at the value of one of its attributes."""
        self.problems.append(diagnosis.at(node.place_of(attribute), hint, **parameters))

    def value(self, node: Node, name: str, kind: str, default: Json) -> Json:
        """An attribute as a value of its kind, within its bounds."""
        text = node.attributes.get(name)
        if text is None:
            return default
        try:
            value = read_value(kind, text)
        except ValueError:
            return default  # the schema's problem, told already
        for item in DIALOGUE.elements[node.key].attributes if node.key else ():
            if item.name == name:
                self.bounded(node, name, item, value)
        return value

    def bounded(self, node: Node, name: str, item: Attribute, value: Json) -> None:
        """Note an attribute's number that is not within the bounds of what it says."""
        if isinstance(value, int | float) and not within(float(value), item.low, item.high):
            wrong = f'{item.name} "{node.get(name)}" {outside(item.kind, item.low, item.high)}'
            spans = value_span(node, name)
            hint = nearest(item.kind, float(value), item.low, item.high, *spans)
            self.problem(BEYOND, node, name, hint, wrong=wrong)

    def expression(self, node: Node, name: str = "expr") -> Expression | None:
        """An attribute as an expression, if it is there."""
        code = node.attributes.get(name)
        return None if code is None or not code.strip() else self.code(code, node, name)

    def code(self, code: str, node: Node, attribute: str) -> Expression:
        """An expression, noted as one of the document's."""
        made = Expression(code, node, attribute)
        self.expressions.append(made)
        return made

    def either(self, node: Node, name: str, default: str = "") -> str | Expression:
        """An attribute, or the expression in NAME-expr; never both."""
        if f"{name}-expr" not in node.attributes:
            return node.attributes.get(name, default)
        found = self.expression(node, f"{name}-expr")
        if found is None:
            return node.get(name, default)
        if name in node.attributes:
            self.exclusive(node, name, f"{name}-expr")
        return found

    def target(self, node: Node, name: str) -> str:
        """The form that an attribute names; the schema tells where the # is missing."""
        return node.attributes.get(name, "").strip(XML_SPACE).removeprefix("#")

    def one_of_two(self, node: Node, first: str, second: str) -> None:
        """Note where an element has neither or both of two attributes, or of their expressions."""
        one, other = self.written(node, first), self.written(node, second)
        if one and other:
            self.exclusive(node, one, other)
        elif not (one or other or self.strange(node)):
            self.problem(NEEDS_EITHER, node, tag=node.tag, first=first, second=second)

    @staticmethod
    def written(node: Node, name: str) -> str:
        """The name by which an attribute is there, or the expression in its place; or nothing."""
        if name in node.attributes:
            return name
        return f"{name}-expr" if f"{name}-expr" in node.attributes else ""

    @staticmethod
    def strange(node: Node) -> bool:
        """Whether something unknown in an element has been told, and is likely what is missing."""
        return not node.key or not node.attributes.keys() <= DIALOGUE.attributes[node.key].keys()

    def exclusive(self, node: Node, first: str, second: str) -> None:
        """Note that two attributes exclude each other."""
        self.problem(HAS_BOTH, node, second, tag=node.tag, first=first, second=second)

    def text(self, node: Node) -> Text:
        """Text with values in it, white space folded."""
        parts: list[str | Expression | Pause] = []
        for item in node.content:
            if isinstance(item, str):
                folded = " ".join(item.split())
                if folded:
                    lead = " " if item[:1].isspace() and parts else ""
                    parts.append(lead + folded + (" " if item[-1:].isspace() else ""))
                elif parts and item:
                    parts.append(" ")
            elif item.tag == "value":
                expr = self.expression(item)
                if expr is not None:
                    parts.append(expr)
            elif item.tag == "break":
                parts.append(self.pause(item))
        if parts and isinstance(parts[-1], str):
            parts[-1] = parts[-1].rstrip()
        return tuple(part for part in parts if part != "")

    def pause(self, node: Node) -> Pause:
        """A break."""
        return Pause(int(self.value(node, "time", "duration", 0)))  # in ms

    def params(self, node: Node) -> tuple[tuple[str, str | Expression], ...]:
        """The param children."""
        found: list[tuple[str, str | Expression]] = []
        for child in node.all("param"):
            expr = self.expression(child)
            if expr is not None and "value" in child.attributes:
                self.exclusive(child, "value", "expr")
            elif expr is None and "value" not in child.attributes:
                self.problem(NEEDS_VALUE, child)
            found.append((child.get("name"), expr or child.get("value")))
        return tuple(found)

    def names(self, node: Node) -> tuple[str, ...]:
        """The namelist attribute."""
        return tuple(node.get("namelist").split())

    # The document -------------------------------------------------------------

    def document(self) -> Document:
        """Build the whole application."""
        root = self.root
        forms: dict[str, Form] = {}
        parts = self.parts(root)
        for node in parts.get("form", ()):
            name = node.get("id")
            if name in forms:
                self.problem(TWO_FORMS, node, "id", name=name)
            forms.setdefault(name, self.form(node))
        if "." in root.get("id"):
            self.problem(ID_WITH_DOT, root, "id", name=root.get("id"))
        if not forms:
            self.problem(NO_FORM_AT_ALL, root)
        document = Document(
            id=root.get("id"),
            kind=root.get("kind"),
            lang=self.lang,
            file=root.source.file,
            forms=forms,
            handlers=self.handlers(parts),
            links=self.links(parts),
            watches=self.watches(parts),
            setup=self.setup(parts),
            properties=self.properties(parts),
            node=root,
            expressions=self.expressions,
            scripted=self.scripted,
            counting=self.counting,
            curious=self.any_has(EVENT),
        )
        self.settle_units(document)
        return document

    def any_has(self, words: re.Pattern[str]) -> bool:
        """Whether any code of the document, or a variable's name in it, has certain words."""
        codes = {*self.words, *(one.code for one in self.expressions)}  # most are there many times
        return any(map(words.search, codes))

    def form(self, node: Node) -> Form:
        """A form."""
        parts = self.parts(node)
        return Form(  # in order: naming what is given takes as long as making it
            node.get("id"),
            self.items(parts),
            self.handlers(parts),
            self.links(parts),
            self.watches(parts),
            self.setup(parts),
            self.filleds(parts),
            self.properties(parts),
            node,
            self.hold(node),
            node.get("channel") == "connect",
            " ".join(node.get("resume-text", "").split()),
        )

    @staticmethod
    def parts(node: Node) -> Parts:
        """The child elements, divided by what they are for."""
        found: Parts = {}
        for child in node.content:
            if not isinstance(child, str):
                part = PARTS.get(child.tag, child.tag)
                if part in found:
                    found[part].append(child)
                else:
                    found[part] = [child]
        return found

    def hold(self, node: Node) -> int | None:
        """How long a stream is held by the hints of an element (X3)."""
        longest: int = self.value(node, "hold-for", "duration", HOLD_MS)
        return longest if node.get("stream") == "hold" else None

    def setup(self, parts: Parts) -> tuple[Declare | Script, ...]:
        """Variables and scripts, in document order."""
        found: list[Declare | Script] = []
        for child in parts.get("setup", ()):
            found.append(self.declare(child) if child.tag == "var" else self.script(child))
        return tuple(found)

    def declare(self, node: Node) -> Declare:
        """A var."""
        self.plain_name(node, "name")
        return Declare(node.get("name"), self.expression(node), node)

    def plain_name(self, node: Node, attribute: str) -> None:
        """A variable that is declared has a name without a scope's."""
        name = node.get(attribute)
        if "." in name:
            self.problem(NAME_WITH_DOT, node, attribute, attribute_name=attribute, name=name)
        elif name in RESERVED:
            self.problem(RESERVED_NAME, node, attribute, attribute_name=attribute, name=name)

    def script(self, node: Node) -> Script:
        """A script."""
        code = "".join(item for item in node.content if isinstance(item, str))
        self.scripted = True
        self.words.append(code)
        return Script(Expression(code, node, ""), node)

    def properties(self, parts: Parts) -> dict[str, Json]:
        """Properties by name, as values."""
        found: dict[str, Json] = {}
        for child in parts.get("property", ()):
            name = child.get("name")
            if name in PROPERTIES:
                item, text = PROPERTIES[name], child.get("value")
                try:
                    found[name] = value = read_value(item.kind, text)
                except BadValue as error:
                    hint = Hint(error.remedy)
                    self.problem(
                        BAD_PROPERTY, child, "value", hint, name=name, value=text, wrong=error.wrong
                    )
                    continue
                self.bounded(child, "value", item, value)
        return found

    def handlers(self, parts: Parts) -> tuple[Handler, ...]:
        """Handlers in document order."""
        found = []
        for child in parts.get("handlers", ()):
            given = child.attributes
            events = given.get("event", "").split() if child.tag == "on" else [child.tag]
            reactive = given.get("reactive")
            count = self.value(child, "count", "integer", 1)
            self.counting = self.counting or count > 1
            runs = self._runs
            content = self.content(child)
            found.append(
                Handler(
                    tuple([event.rstrip(".") for event in events]),
                    self.expression(child, "cond"),
                    count,
                    None if reactive is None else reactive == "true",
                    content,
                    child,
                    self._runs > runs,
                    self.value(child, "fresh-for", "duration", None),
                )
            )
        return tuple(found)

    def links(self, parts: Parts) -> tuple[Link, ...]:
        """Links in document order."""
        found = []
        for child in parts.get("link", ()):
            self.one_of_two(child, "next", "event")
            held = child.all("grammar")
            grammars = self.grammars(held)
            if len(held) != 1:
                self.problem(NO_GRAMMAR, child)
            if grammars:
                to = self.target(child, "next")
                found.append(Link(to, child.get("event"), Answers(grammars=grammars[:1]), child))
        return tuple(found)

    def grammars(self, nodes: list[Node]) -> list[Grammar]:
        """Grammars, without those of files that cannot be used."""
        if not nodes:
            return []
        from prima.interpreter.grammars import grammar_of  # few documents have any

        self.outside = self.outside or any("src" in node.attributes for node in nodes)
        found = [
            grammar_of(node, self.lang, self.fetch, self.problem, self.problems) for node in nodes
        ]
        return [one for one in found if one is not None]

    def watches(self, parts: Parts) -> tuple[Watch, ...]:
        """Watches in document order."""
        return tuple(
            Watch(child.get("name"), self.code(child.get("when"), child, "when"), child)
            for child in parts.get("watch", ())
        )

    # Form items ---------------------------------------------------------------

    def items(self, parts: Parts) -> tuple[Item, ...]:
        """The form items of a form or a unit."""
        made: list[Item] = []
        for child in parts.get("items", ()):
            match child.tag:
                case "block":
                    block = Block(*self.item(child, self.parts(child)), content=self.content(child))
                    made.append(block)
                case "field":
                    made.append(self.field(child))
                case "subdialog":
                    made.append(self.subdialog(child))
                case "iu" if child.key == "iu-items":
                    made.append(self.unit(child))
        return tuple(made)

    def item(
        self, node: Node, parts: Parts
    ) -> tuple[
        str,
        Expression | None,
        Expression | None,
        tuple[Handler, ...],
        dict[str, Json],
        Node,
        int | None,
    ]:
        """What all form items have."""
        name = node.get("name")
        self.plain_name(node, "name")
        if not name:
            self._unnamed += 1
            name = f"$item{self._unnamed}"
        handlers = self.handlers(parts) if node.tag != "block" else ()
        return (
            name,
            self.expression(node),
            self.expression(node, "cond"),
            handlers,
            self.properties(parts),
            node,
            self.hold(node) if "stream" in node.attributes else None,
        )

    def field(self, node: Node) -> Field:
        """A field, with all that it takes as an answer."""
        parts = self.parts(node)
        prompts = tuple(
            Prompt(
                text=self.text(child),
                count=self.value(child, "count", "integer", 1),
                cond=self.expression(child, "cond"),
                timeout=self.value(child, "timeout", "duration", None),
                bargein=self.value(child, "bargein", "boolean", None),
                node=child,
            )
            for child in parts.get("prompt", ())
        )
        for prompt in prompts:
            self.check_length(prompt.node, prompt.text)
        answers = Answers(type=node.get("type"))
        for child in parts.get("option", ()):
            said = child.text
            if not fold(said):
                self.problem(EMPTY_OPTION, child)
            elif fold(said) in answers.options:
                self.problem(TWO_OPTIONS, child, answer=said)
            answers.options.setdefault(fold(said), child.get("value", said))
        answers.grammars = self.grammars(parts.get("grammar", []))
        strange = any(not child.key for child in node.nodes)  # told already
        if not (answers.options or "grammar" in parts or answers.type or strange):
            self.problem(TAKES_NO_ANSWER, node, name=node.get("name"))
        return Field(
            *self.item(node, parts),
            prompts=prompts,
            answers=answers,
            filled=self.filleds(parts),
            lang=self.lang,
            connect=node.get("channel") == "connect",
        )

    def subdialog(self, node: Node) -> Subdialog:
        """A subdialog."""
        parts = self.parts(node)
        return Subdialog(
            *self.item(node, parts),
            form=self.target(node, "src"),
            params=self.params(node),
            filled=self.filleds(parts),
        )

    def unit(self, node: Node) -> Unit:
        """A unit around form items; what they reach is known when the document is whole."""
        parts = self.parts(node)
        unit = Unit(*self.item(node, parts), items=self.items(parts))
        unit.longest = self.value(node, "longest", "duration", LONGEST_UNIT_MS)
        return unit

    def settle_units(self, document: Document) -> None:
        """U5: a unit owns the devices of all that may run in it."""
        finder = Finder(document)
        told: set[int] = set()
        for form, unit in units_of(document):
            reach = finder.reach(form, unit)
            unit.devices, unit.types = reach.devices, reach.types
            for one in reach.commands:
                problem = unit_problem(one, TABLE_4_2.get(one.command.type), unit)
                if problem is not None and id(one.command) not in told:
                    told.add(id(one.command))
                    self.problems.append(problem)

    def filleds(self, parts: Parts) -> tuple[Filled, ...]:
        """Filled elements."""
        return tuple(
            Filled(child.get("mode", "all"), self.names(child), self.content(child), child)
            for child in parts.get("filled", ())
        )

    # Content ----------------------------------------------------------------------

    def content(self, node: Node) -> tuple[Act, ...]:
        """Executable content; Commands that follow one another become one run."""
        return self.acts(
            [
                child
                for child in node.content
                if not isinstance(child, str) and child.key not in ("param", "value")
            ]
        )

    def acts(self, nodes: list[Node]) -> tuple[Act, ...]:
        """Executable content from some of an element's children."""
        made: list[Act] = []
        sequence: list[Node] = []
        for node in nodes:
            if node.tag in COMMANDS:
                # A Command wanted now begins a run of its own: what stands before it comes first.
                if sequence and self.is_now(node):
                    made.append(self.run(sequence))
                    sequence = []
                sequence.append(node)
                continue
            if sequence:
                made.append(self.run(sequence))
                sequence = []
            act = self.act(node)
            if act is not None:
                made.append(act)
        if sequence:
            made.append(self.run(sequence))
        return tuple(made)

    @staticmethod
    def is_now(node: Node) -> bool:
        """Whether a Command is wanted now."""
        row = TABLE_4_2.get(node.tag)
        return node.get("order") == "now" or (row is not None and row.now)

    def run(self, nodes: list[Node]) -> Run:
        """Commands that follow one another, flattened into steps."""
        steps: list[StepTemplate] = []
        self.sequence(nodes, (), steps)
        self._runs += 1
        return Run(tuple(steps), nodes[0])

    def sequence(
        self, nodes: list[Node], after: tuple[int, ...], steps: list[StepTemplate]
    ) -> tuple[int, ...]:
        """Add steps one after another; gives what whatever follows has to wait for."""
        for node in nodes:
            if node.tag == "par":
                ends: list[int] = []
                for branch in node.nodes:
                    ends += self.sequence([branch], after, steps)
                after = tuple(ends) or after
            elif node.tag == "seq":
                after = self.sequence(node.nodes, after, steps)
            elif node.tag == "iu":
                group = self.group(node)
                if group.steps:
                    steps.append(StepTemplate(group, after))
                    after = (len(steps) - 1,)
            else:
                if steps and self.is_now(node):
                    self.problems.append(now_inside(node))
                steps.append(StepTemplate(self.command(node), after))
                after = (len(steps) - 1,)
        return after

    def group(self, node: Node) -> GroupTemplate:
        """A unit around Commands."""
        steps: list[StepTemplate] = []
        self.sequence(node.nodes, (), steps)
        for command in run_commands(steps):
            problem = unit_problem(Reached(command, True), TABLE_4_2.get(command.type))
            self.problems += [problem] if problem is not None else []
        if not steps:
            self.problem(EMPTY_UNIT, node)
        longest = self.value(node, "longest", "duration", LONGEST_UNIT_MS)
        return GroupTemplate(tuple(steps), longest, node, node.get("restartable") == "true")

    def command(self, node: Node) -> CommandTemplate:
        """A Command element."""
        name = node.get("type") if node.tag == "command" else node.tag
        row = TABLE_4_2.get(name)
        args = self.arguments(node, row) if row is not None else {}
        content = self.text(node) or None
        if row is not None:
            self.check_complete(node, row, args, content)
        params = self.params(node)
        if params and self.root.get("kind") == "ea" and node.tag != "command":
            self.problem(FOR_FAS, node.all("param")[0])
        return CommandTemplate(
            type=name,
            args=args,
            text=content,
            now=node.get("order") == "now",
            extra=params,
            handlers=self.handlers(self.parts(node)),
            node=node,
            lang=self.lang,
            restartable=node.get("restartable") == "true",
        )

    def arguments(self, node: Node, row: CommandType) -> dict[str, Json | Expression]:
        """A Command's motion arguments, as written or as expressions."""
        args: dict[str, Json | Expression] = {}
        for key, text in node.attributes.items():
            bare = key.removesuffix("-expr")
            argument = row.arguments.get(bare)
            if argument is None:
                continue
            if bare != key:
                if bare in node.attributes:
                    self.exclusive(node, bare, key)
                args[bare] = self.code(text, node, key)
                continue
            try:
                check_argument(bare, argument, text)
                args[bare] = text  # the mediator reads it, as it reads what an expression gives
            except BadValue as error:
                if error.beyond:
                    value, spans = float(read_value(argument.kind, text)), value_span(node, key)
                    hint = nearest(argument.kind, value, argument.low, argument.high, *spans)
                    self.problem(BEYOND, node, key, hint, wrong=error.wrong)
        return args

    def check_complete(
        self, node: Node, row: CommandType, args: dict[str, Json | Expression], text: Text | None
    ) -> None:
        """Whether a Command has what it needs, beyond what its schema asks."""
        required = {name for name, item in row.arguments.items() if item.required}
        missing = missing_argument(row, args) if required <= args.keys() else ""
        if missing and not self.strange(node):
            choices = sorted(key for key, item in row.arguments.items() if item.choice)
            hint = Hint(f'Write {choices[0]}="...", for one.' if choices else "")
            self.problem(NEEDS_ARGUMENT, node, hint=hint, wrong=missing)
        if excluding := excluding_arguments(row, args):
            given = [key for key in node.attributes if key.removesuffix("-expr") in args]
            choices = [key for key in given if row.arguments[key.removesuffix("-expr")].choice]
            self.problem(ONLY_ONE, node, choices[-1], wrong=excluding)
        self.check_length(node, text)
        wordless = text is not None and all(isinstance(part, Pause) for part in text)
        if wordless or (row.text == "required" and text is None):
            paused = wordless and row.text == "required"
            self.problem(ONLY_A_PAUSE if paused else SAYS_NOTHING, node, tag=node.tag)

    def check_length(self, node: Node, text: Text | None) -> None:
        """Whether what is said takes longer than one utterance may (E3), as far as it is known."""
        letters = sum(len(part) for part in text or () if isinstance(part, str))
        if wrong := too_long(letters, pauses_in(text)):
            self.problem(SPEAKS_TOO_LONG, node, wrong=wrong)

    def act(self, node: Node) -> Act | None:
        """One element of executable content that is no Command."""
        match node.tag:
            case "var":
                return self.declare(node)
            case "script":
                return self.script(node)
            case "assign":
                return self.assign(node)
            case "clear":
                self.words += self.names(node)
                return Clear(self.names(node), node)
            case "if":
                return self.condition(node)
            case "foreach":
                array = self.code(node.get("array"), node, "array")
                self.plain_name(node, "item")
                return Foreach(node.get("item"), array, self.content(node), node)
            case "log":
                text = self.text(node)
                expr = self.expression(node)
                return Log(node.get("label"), (*text, expr) if expr else text, node)
            case "throw":
                return Throw(self.either(node, "event"), self.either(node, "message"), node)
            case "goto":
                return self.goto(node)
            case "return":
                for name in self.names(node):
                    self.code(name, node, "namelist")
                return Return(self.names(node), node.get("event"), node)
            case "exit":
                return Exit(node)
            case "reprompt":
                return Reprompt(node)
            case "send":
                return self.send(node)
        return None

    def assign(self, node: Node) -> Assign:
        """An assign; what it names may be a part of a variable."""
        name = node.get("name")
        if name in HANDLED or "." in name:
            self.words.append(name)
        if "." in name:
            scope, _, part = name.partition(".")
            self.scripted = self.scripted or "." in (part if scope in SCOPES else name)
        return Assign(name, self.code(node.get("expr"), node, "expr"), node)

    def condition(self, node: Node) -> If:
        """An if, divided by its elseif and else."""
        branches: list[tuple[Expression | None, tuple[Act, ...]]] = []
        cond: Expression | None = self.code(node.get("cond"), node, "cond")
        part: list[Node] = []
        for child in node.nodes:
            if child.tag not in ("elseif", "else"):
                part.append(child)
                continue
            if cond is None:
                self.problem(BEHIND_ELSE, child, tag=child.tag)
            branches.append((cond, self.acts(part)))
            part = []
            cond = self.code(child.get("cond"), child, "cond") if child.tag == "elseif" else None
        branches.append((cond, self.acts(part)))
        return If(tuple(branches), node)

    def goto(self, node: Node) -> Goto:
        """A goto, to a form or to an item."""
        if node.attributes.keys() == ONLY_NEXT:  # as nearly all are
            return Goto(self.target(node, "next") or None, None, node)
        form, item = self.either(node, "next"), self.either(node, "nextitem")
        self.one_of_two(node, "next", "nextitem")
        if isinstance(form, str):
            form = self.target(node, "next")
        return Goto(form or None, item or None, node)

    def send(self, node: Node) -> SendOut:
        """A send, to a service or to the application itself."""
        to = self.either(node, "to")
        event = node.get("event")
        self.one_of_two(node, "to", "event")
        if to and ("delay" in node.attributes or "delay-expr" in node.attributes):
            self.problem(NO_DELAY, node, "delay")
        delay = self.expression(node, "delay-expr") or self.value(node, "delay", "duration", 0)
        return SendOut(to, event, delay, self.params(node), node)
