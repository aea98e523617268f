"""Builds acts from elements of executable content."""

from __future__ import annotations

from collections.abc import Callable

from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    CommandRun,
    CommandTemplate,
    Declare,
    Exit,
    Expression,
    Flattened,
    Foreach,
    Goto,
    GroupTemplate,
    Handler,
    If,
    Log,
    Reprompt,
    Return,
    Script,
    SendOut,
    StepTemplate,
    Throw,
    arrange,
    run_commands,
    type_of,
)
from prima.interpreter.attributes import AttributeReader
from prima.interpreter.deadcontent import branches
from prima.interpreter.diagnoses import (
    BEHIND_ELSE,
    EMPTY_UNIT,
    FOR_FAS,
    NAME_WITH_DOT,
    NO_DELAY,
    RESERVED_NAME,
)
from prima.interpreter.units import LONGEST_UNIT_MS, Reached, now_inside, unit_problem
from prima.interpreter.vocabulary.names import ACTING, HANDLERS
from prima.language.commands import TABLE_4_2
from prima.markup.tree import Node
from prima.script.evaluation import SCOPES
from prima.script.globals import HANDLED, RESERVED

Parts = dict[str, list[Node]]
"""An element's children by purpose: see :data:`PARTS`."""
PARTS = {
    **dict.fromkeys(HANDLERS.split(), "handlers"),
    **dict.fromkeys(("var", "script"), "setup"),
    **dict.fromkeys(("block", "field", "subdialog", "iu"), "items"),
}
"""Purposes shared by several elements; the others go by their tags."""
COMMANDS = frozenset(ACTING.split())
ONLY_NEXT = frozenset(["next"])


class ContentBuilder(AttributeReader):
    """Builds executable content, with the Commands and handlers in it."""

    @staticmethod
    def parts(node: Node) -> Parts:
        """The child elements by purpose."""
        found: Parts = {}
        for child in node.content:
            if not isinstance(child, str):
                part = PARTS.get(child.tag, child.tag)
                if part in found:
                    found[part].append(child)
                else:
                    found[part] = [child]
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
                    self.condition_of(child),
                    count,
                    None if reactive is None else reactive == "true",
                    content,
                    child,
                    self._runs > runs,
                    self.value(child, "fresh-for", "duration", None),
                )
            )
        return tuple(found)

    def declare(self, node: Node) -> Declare:
        """A var."""
        self.plain_name(node, "name")
        return Declare(node.get("name"), self.expression(node), node)

    def plain_name(self, node: Node, attribute: str) -> None:
        """Check that a declared variable's name has no scope prefix."""
        name = node.get(attribute)
        if "." in name:
            self.problem(NAME_WITH_DOT, node, attribute, attribute_name=attribute, name=name)
        elif name in RESERVED:
            self.problem(RESERVED_NAME, node, attribute, attribute_name=attribute, name=name)

    def script(self, node: Node) -> Script:
        """A script."""
        code = "".join(item for item in node.content if isinstance(item, str))
        self.scripts.append(code)
        self.words.append(code)
        return Script(Expression(code, node, ""), node)

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
                # A Command wanted now begins a run of its own, after what precedes it.
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

    def run(self, nodes: list[Node]) -> CommandRun:
        """Commands that follow one another, flattened into steps."""
        self._runs += 1
        return CommandRun(self.steps(nodes), nodes[0])

    def steps(self, nodes: list[Node]) -> tuple[StepTemplate, ...]:
        """Commands and units around them as steps."""
        arranged: Flattened[CommandTemplate | GroupTemplate] = arrange(nodes, self.step)
        steps = tuple(StepTemplate(what, after) for what, after in arranged)
        for first in (run_commands((one,))[0].node for one in steps[1:]):
            if self.is_now(first):
                self.problems.append(now_inside(first))
        return steps

    def step(self, node: Node) -> CommandTemplate | GroupTemplate | None:
        """A Command, or a unit that holds any; unknown or misplaced ones are reported already."""
        if node.tag == "iu":
            group = self.group(node)
            return group if group.steps else None
        return self.command(node) if node.key else None

    def group(self, node: Node) -> GroupTemplate:
        """A unit around Commands."""
        steps = self.steps(node.nodes)
        for command in run_commands(steps):
            problem = unit_problem(Reached(command, True), TABLE_4_2.get(command.type))
            self.problems += [problem] if problem is not None else []
        if not steps and all(one.key for one in node.nodes):
            self.problem(EMPTY_UNIT, node)
        longest = self.value(node, "longest", "duration", LONGEST_UNIT_MS)
        return GroupTemplate(steps, longest, node, node.get("restartable") == "true")

    def command(self, node: Node) -> CommandTemplate:
        """A Command element."""
        name = type_of(node)
        row = TABLE_4_2.get(name)
        args = self.arguments(node, row) if row is not None else {}
        content = self.text(node) or None
        if row is not None:
            self.check_complete(node, row, content)
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

    def act(self, node: Node) -> Act | None:
        """One element of executable content that is not a Command."""
        make = ACTS.get(node.tag)
        return None if make is None else make(self, node)

    def clear(self, node: Node) -> Clear:
        """A clear."""
        self.words += self.names(node)
        return Clear(self.names(node), node)

    def foreach(self, node: Node) -> Foreach:
        """A foreach."""
        array = self.code(node.get("array"), node, "array")
        self.plain_name(node, "item")
        return Foreach(node.get("item"), array, self.content(node), node)

    def log(self, node: Node) -> Log:
        """A log, of text or an expression."""
        text = self.text(node)
        expr = self.expression(node)
        return Log(node.get("label"), (*text, expr) if expr else text, node)

    def throw(self, node: Node) -> Throw:
        """A throw."""
        return Throw(self.either(node, "event"), self.either(node, "message"), node)

    def leave(self, node: Node) -> Return:
        """A return."""
        for name in self.names(node):
            self.code(name, node, "namelist")
        if "event" in node.attributes and "namelist" in node.attributes:
            self.exclusive(node, "namelist", "event")
        return Return(self.names(node), node.get("event"), node)

    def assign(self, node: Node) -> Assign:
        """An assign, perhaps to a part of a variable."""
        name = node.get("name")
        if name in HANDLED or "." in name:
            self.words.append(name)
        if "." in name:
            scope, _, part = name.partition(".")
            self.assigns_parts = self.assigns_parts or "." in (part if scope in SCOPES else name)
        return Assign(name, self.code(node.get("expr"), node, "expr"), node)

    def condition(self, node: Node) -> If:
        """An if, divided by its elseif and else."""
        made: list[tuple[Expression | None, tuple[Act, ...]]] = []
        for head, part in branches(node):
            if made and made[-1][0] is None:
                self.problem(BEHIND_ELSE, head, tag=head.tag)
            cond = None if head.tag == "else" else self.code(head.get("cond"), head, "cond")
            made.append((cond, self.acts([one for one in part if isinstance(one, Node)])))
        return If(tuple(made), node)

    def goto(self, node: Node) -> Goto:
        """A goto, to a form or to an item."""
        if node.attributes.keys() == ONLY_NEXT:  # nearly all are
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
        if to and (given := self.written(node, "delay")):
            self.problem(NO_DELAY, node, given)
        delay = self.expression(node, "delay-expr") or self.value(node, "delay", "duration", 0)
        return SendOut(to, event, delay, self.params(node), node)


ACTS: dict[str, Callable[[ContentBuilder, Node], Act]] = {
    "var": ContentBuilder.declare,
    "script": ContentBuilder.script,
    "assign": ContentBuilder.assign,
    "clear": ContentBuilder.clear,
    "if": ContentBuilder.condition,
    "foreach": ContentBuilder.foreach,
    "log": ContentBuilder.log,
    "throw": ContentBuilder.throw,
    "goto": ContentBuilder.goto,
    "return": ContentBuilder.leave,
    "exit": lambda _, node: Exit(node),
    "reprompt": lambda _, node: Reprompt(node),
    "send": ContentBuilder.send,
}
"""Builders of content other than Commands, by element."""
