"""Executable content: each kind of element in a short method (VoiceXML 5.3)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, NoReturn

from prima.interpreter.acts import (
    Act,
    Assign,
    Clear,
    CommandRun,
    CommandTemplate,
    Declare,
    Exit,
    Expression,
    Foreach,
    Goto,
    GroupTemplate,
    If,
    Log,
    Reprompt,
    Return,
    Script,
    SendOut,
    StepTemplate,
    Throw,
)
from prima.interpreter.elements import all_items
from prima.interpreter.expressions import Evaluator
from prima.interpreter.frame import Abandoned, Content, Fiber, GoForm
from prima.interpreter.places import source
from prima.interpreter.transfers import GoBack, GoItem, GoOut, Thrown, Transfer, no_item, undeclared
from prima.language.values import LONGEST_MS, quoted, read_value, shown
from prima.markup.tree import Node
from prima.messages import Command, Group, Json, Notice, Say, Step
from prima.script.evaluation import RESULT_LIMIT

MAX_NAME = 200
"""Characters of an event's name that are significant."""
MAX_REPEATS = 10_000
"""Maximum number of elements of a foreach."""


class Executor(Evaluator):
    """Runs content for one application."""

    def run(self, content: Sequence[Act], fiber: Fiber) -> Content:
        """Run content in document order, waiting for Commands to end (O4)."""
        for act in content:
            self.owner.count_step(act.node)
            simple = SIMPLE.get(type(act))
            if simple is not None:
                transfer = simple(self, act, fiber)
                if transfer is not None:
                    raise transfer
            elif isinstance(act, CommandRun):
                yield from self.commands(act, fiber)
            else:
                for part in self.parts(act, fiber):
                    yield from self.run(part, fiber)

    def run_at_once(self, content: Sequence[Act], fiber: Fiber) -> Transfer | None:
        """Run content without Commands; gives the transfer of control that ends it."""
        if content:
            self.owner.count_step(content[0].node, len(content))
        for act in content:
            simple = SIMPLE.get(type(act))
            transfer = (
                simple(self, act, fiber) if simple is not None else self._run_held(act, fiber)
            )
            if transfer is not None:
                return transfer
        return None

    def _run_held(self, act: Act, fiber: Fiber) -> Transfer | None:
        for part in self.parts(act, fiber):
            transfer = self.run_at_once(part, fiber)
            if transfer is not None:
                return transfer
        return None

    def parts(self, act: Act, fiber: Fiber) -> Iterator[Sequence[Act]]:
        """The content of an ``if`` or ``foreach`` to run now."""
        if isinstance(act, Foreach):
            yield from self.foreach(act, fiber)
        elif isinstance(act, If):
            for cond, content in act.branches:
                if cond is None or self.condition(cond, fiber):
                    yield content
                    return

    def foreach(self, act: Foreach, fiber: Fiber) -> Iterator[Sequence[Act]]:
        """Run content once for each element of an array."""
        elements = partial(self.engine.elements, most=MAX_REPEATS)
        for element in self.by_engine(elements, act.array, fiber):
            self.owner.count_step(act.node)
            self.engine.put(self.local(fiber), act.item, element)
            yield act.content

    def throw(self, act: Throw, fiber: Fiber) -> NoReturn:
        """Throw an event (VoiceXML 5.2.1)."""
        name = self.event_name(act, fiber)
        said = self.plain(act.message, fiber)
        message = "" if said is None else shown(said)
        raise Thrown(name, message, source(act.node))

    def event_name(self, act: Throw, fiber: Fiber) -> str:
        """The name of the event to throw; an expression may give an invalid one."""
        value = self.plain(act.event, fiber)
        name = shown(value)[:MAX_NAME]
        if not isinstance(act.event, Expression):
            return name
        try:
            return str(read_value("event", "" if value is None else name))
        except ValueError as error:
            message = f"event {quoted(value)} {error}"
            raise Thrown.at(act.node, "error.semantic", message) from None

    def leave(self, act: Return, fiber: Fiber) -> Transfer:
        """Return from a subdialog, with values (VoiceXML 5.3.10)."""
        params = [(name, Expression(name, act.node, "namelist")) for name in act.names]
        return GoBack(self.named(params, fiber, act.node), act.event)

    def log(self, act: Log, fiber: Fiber) -> None:
        """Write to the transcript."""
        label = f"{act.label}: " if act.label else ""
        said = label + self.text(act.text, fiber, RESULT_LIMIT)
        self.owner.count_output(len(said), act.node)
        self.owner.actions.append(Say("log", said, source(act.node)))

    def reprompt(self, _act: Reprompt, fiber: Fiber) -> None:
        """Let the form ask again."""
        fiber.frame.silent = ""

    def assign(self, act: Assign, fiber: Fiber) -> None:
        """Give a declared variable a value; innermost scope first (VoiceXML 5.3.2)."""
        self.by_engine(self.engine.assign_declared, act.expr, fiber, act.name)

    def clear(self, act: Clear, fiber: Fiber) -> None:
        """Undefine variables and reset the counters of form items (VoiceXML 5.3.3)."""
        frame = fiber.frame
        names = act.names or [item.name for item in all_items(frame.form.items)]
        self.owner.count_step(act.node, len(names))
        items = {item.name for item in all_items(frame.form.items)}
        for name in names:
            scope = next(
                (one for one in reversed(self.scopes(fiber)) if self.engine.has(one, name)), None
            )
            if scope is None:
                raise undeclared(act.node, name)
            self.engine.unset(scope, name)
            if name in items:
                frame.counters = frame.counters.without(name)

    def goto(self, act: Goto, fiber: Fiber) -> Transfer:
        """Leave for a form or an item."""
        if act.item is not None:
            name = shown(self.plain(act.item, fiber))
            if all(item.name != name for item in all_items(fiber.frame.form.items)):
                raise no_item(act.node, name)
            return GoItem(name)
        target = act.form
        if not isinstance(target, str):
            target = shown(self.plain(target, fiber)).removeprefix("#")
        if target not in self.owner.document.forms:
            raise Thrown.at(act.node, "error.badfetch", f'there is no form "{target}"')
        return GoForm(target)

    def send(self, act: SendOut, fiber: Fiber) -> None:
        """Ask a service, or raise an event here after a delay."""
        params = self.named(act.params, fiber, act.node)
        if act.event:
            delay = self.plain(act.delay, fiber)
            self.owner.delay(act, params, self.milliseconds(delay, act.node), fiber)
        else:
            service = self.plain(act.service, fiber)
            if service is None:
                raise Thrown.at(act.node, "error.semantic", "to has no value: it names no service")
            self.owner.send(shown(service), {"params": params}, source(act.node))

    def milliseconds(self, value: Json, node: Node) -> int:
        """A delay: milliseconds from an attribute, or a time or seconds from an expression."""
        try:
            if isinstance(value, str):
                return int(read_value("duration", value))
            if isinstance(value, int | float) and not isinstance(value, bool):
                ms = value if "delay" in node.attributes else value * 1000
                if 0 <= ms <= LONGEST_MS:
                    return round(ms)
        except ValueError:
            pass
        raise Thrown.at(node, "error.semantic", f"delay {quoted(value)} is not a time")

    # Commands -----------------------------------------------------------------

    def commands(self, act: CommandRun, fiber: Fiber) -> Content:
        """Request Commands as one tree and wait for their end (U3, O4)."""
        steps = self.steps(act.steps, fiber)
        if steps:  # otherwise a par or seq without Commands
            notice = yield self.owner.request(steps, fiber)
            self.check(notice, fiber)

    def check(self, notice: Notice, fiber: Fiber) -> None:
        """Go on after a run's end; a failure becomes an event, a cancellation ends the content."""
        if notice.what == "failed":
            fiber.commands = (notice.command.hook if notice.command else None) or ()
            place = notice.command.source if notice.command else ""
            message = f"{place}: {notice.message}" if place else notice.message
            data = {"command": notice.command.asked} if notice.command else {}
            raise Thrown(notice.event, message, place, data)
        if notice.what == "cancelled":
            raise Abandoned

    def steps(self, templates: Sequence[StepTemplate], fiber: Fiber) -> list[Step]:
        """Templates with their expressions evaluated."""
        made: list[Step] = []
        for template in templates:
            what = template.what
            if isinstance(what, GroupTemplate):
                steps = self.steps(what.steps, fiber)
                group = Group(steps, what.longest, source(what.node), what.restartable)
                made.append(Step(group, template.after))
            else:
                made.append(Step(self.command(what, fiber), template.after))
        return made

    def command(self, template: CommandTemplate, fiber: Fiber) -> Command:
        """A Command with its arguments."""
        text, cues = self.speech(template.text, fiber) if template.text is not None else (None, ())
        self.owner.count_output(len(text or ""), template.node)
        args = self.named([*template.args.items()], fiber, template.node)
        extra = self.named(template.extra, fiber, template.node)
        if template.node.tag == "command":  # which has no attributes for them
            own = self.owner.arguments.get(template.type, frozenset())
            args |= {name: extra.pop(name) for name in list(extra) if name in own}
        command = Command(
            template.type,
            args,
            text or None,
            template.now,
            extra,
            lang=template.lang,
            source=source(template.node),
            restartable=template.restartable,
            cues=cues,
        )
        if template.handlers:
            command.hook = template.handlers
        return command


SIMPLE: dict[type, Callable[[Executor, Any, Fiber], Transfer | None]] = {
    Assign: Executor.assign,
    Declare: lambda self, act, fiber: self.declare(act, self.local(fiber), fiber),
    Script: lambda self, act, fiber: self.script(act, self.local(fiber), fiber),
    Clear: Executor.clear,
    Goto: Executor.goto,
    Throw: Executor.throw,
    Return: Executor.leave,
    Exit: lambda self, act, fiber: GoOut(),
    Reprompt: Executor.reprompt,
    Log: Executor.log,
    SendOut: Executor.send,
}
"""How to run content that takes no time, by its kind."""
