"""The Form Interpretation Algorithm (VoiceXML 2.0, 2.1.6 and appendix C)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Filled,
    Form,
    Item,
    Prompt,
    Subdialog,
    Unit,
    all_items,
)
from prima.interpreter.frame import Abandoned, Content, Fiber, Frame
from prima.interpreter.owner import FORM_STEPS, Owner
from prima.interpreter.places import source
from prima.interpreter.selection import satisfied, select_item, select_prompts
from prima.interpreter.transfers import GoBack, GoItem, Thrown, Transfer, check_depth, thrown_of
from prima.interpreter.vocabulary.questions import USUAL_CONFIDENCE
from prima.messages import Command, Cue, Json, Notice, OpenUnit, Step
from prima.script.evaluation import ScriptError


def confidence_level(document: Document, form: Form, field: Field | None = None) -> float:
    """The minimum confidence of a recognition result (0 to 1; VoiceXML 6.3.2)."""
    nearer = field.properties if field is not None else {}
    settings = {**document.properties, **form.properties, **nearer}
    return float(settings.get("confidencelevel", USUAL_CONFIDENCE))


def holds(item: Item, name: str) -> bool:
    """Whether an item has a name, or is a unit around the one that has."""
    inner = item.items if isinstance(item, Unit) else ()
    return any(one.name == name for one in (item, *inner))


def _shadow(notice: Notice) -> dict[str, Json]:
    """The properties of an utterance besides its meaning."""
    utterance = notice.data.get("utterance")
    sure = notice.data.get("confidence", None if utterance is None else 1.0)
    return {"utterance": utterance, "confidence": sure}


class Algorithm:
    """Selects, visits and processes the items of forms, for one application."""

    def __init__(self, owner: Owner) -> None:
        self.owner = owner

    def interpret(self, frame: Frame, fiber: Fiber, setup: bool) -> Content:
        """Select, visit and process until no item is left; then the form waits for events."""
        if frame.fresh:
            yield from self._at_once(frame, fiber, lambda: self.owner.set_up_document(frame))
        if setup and not (frame.form.bare and frame.called_by is None):
            yield from self._at_once(frame, fiber, lambda: self.owner.initialise(frame, fiber))
            yield from self._at_once(frame, fiber, lambda: self.owner.arm_watches(frame))
            if frame.entering:
                yield 0
        yield from self._visit_all(frame, fiber, frame.form.items, None)

    def _at_once(self, frame: Frame, fiber: Fiber, act: Callable[[], None]) -> Content:
        """Run content that takes no time; an event thrown in it is handled in the same fiber."""
        try:
            act()
            return
        except (Thrown, ScriptError) as error:
            thrown = thrown_of(error)
        yield from self.owner.handling.handle_thrown(frame, fiber, None, thrown, 0)

    def _visit_all(
        self, frame: Frame, fiber: Fiber, items: Sequence[Item], unit: Unit | None
    ) -> Content:
        while True:
            fiber.local = None  # conditions, prompts and parameters see no content's variables
            item = self._selected(frame, fiber, items)
            if not isinstance(item, Field) or item.name != frame.silent:
                frame.silent = ""
            if isinstance(item, Thrown):
                yield from self.owner.handling.handle_thrown(frame, fiber, unit, item, 0)
                return
            if item is None:
                return
            self.owner.count_step(item.node, FORM_STEPS)
            frame.item = item
            yield from self._catching(frame, fiber, item, item, self._visit(frame, fiber, item))
            frame.item = unit

    def _selected(self, frame: Frame, fiber: Fiber, items: Sequence[Item]) -> Item | Thrown | None:
        """The item that a goto names, else the first undefined one whose condition holds.

        After a condition's error nothing more can be selected: its event is returned.
        """

        def first_undefined(some: Sequence[Item]) -> int:
            names = (one.name for one in some)
            return self.owner.engine.first_undefined(frame.dialog, *names) if some else 0

        def is_wanted(one: Item) -> bool:
            return one.cond is None or self.owner.execute.condition(one.cond, fiber)

        try:
            item = select_item(items, frame.next_item, holds, first_undefined, is_wanted)
        except Thrown as error:
            return thrown_of(error)
        if item is not None:
            self.owner.note(item.node)
            if item.name == frame.next_item:
                frame.next_item = ""
        return item

    def _visit(self, frame: Frame, fiber: Fiber, item: Item) -> Content:
        match item:
            case Block():
                self.owner.engine.set(frame.dialog, item.name, True)
                yield from self.owner.execute.run(item.content, fiber)
            case Field():
                yield from self._collect(frame, fiber, item)
            case Subdialog():
                yield from self._call(frame, fiber, item)
            case Unit():
                yield from self._span(frame, fiber, item)

    def _catching(
        self, frame: Frame, fiber: Fiber, item: Item, scope: Item | None, content: Content
    ) -> Content:
        """Run content of a visit to an item; an event thrown in it is handled in the same fiber.

        ``scope`` is the item whose handlers count, None for the form's alone.
        """
        try:
            yield from content
            return
        except (Thrown, ScriptError) as error:
            thrown = thrown_of(error)
            if thrown.sought:  # in a subdialog: its caller's handlers are not in force there
                raise
            frame.silent = item.name if isinstance(item, Field) else ""
        yield from self.owner.handling.handle_thrown(frame, fiber, scope, thrown, 0)

    def _collect(self, frame: Frame, fiber: Fiber, field: Field) -> Content:
        """Ask, and take the answer: the Command Q&A (C4)."""
        command = self._question(frame, fiber, field)
        notice = yield self.owner.request([Step(command)], fiber)
        self.owner.execute.check(notice, fiber)
        outcome = str(notice.data.get("outcome", "noinput"))
        if outcome != "filled":
            data = {**_shadow(notice), "command": command.type}
            if outcome not in ("noinput", "nomatch"):  # the event of a link
                data["text"] = data["utterance"]
            raise Thrown(outcome, "", command.source, data)
        given = {field.name: notice.data["value"], f"{field.name}$": _shadow(notice)}
        self.owner.engine.fill(frame.dialog, given)
        yield from self._process(frame, fiber, field, field.filled)

    def _question(self, frame: Frame, fiber: Fiber, field: Field) -> Command:
        """A Q&A of the prompts to say now."""
        args = {**self.owner.document.properties, **frame.form.properties, **field.properties}
        text = ""
        cues: tuple[Cue, ...] = ()
        silent, frame.silent = frame.silent, ""  # after its own event (4.1.6)
        for prompt in () if silent else self._prompts(frame, fiber, field):
            text, more = self.owner.execute.speech(prompt.text, fiber, text)
            cues += more
            own = {"timeout": prompt.timeout, "bargein": prompt.bargein}
            args |= {name: value for name, value in own.items() if value is not None}
        if not silent:  # what fails before has not asked (C)
            frame.counters = frame.counters.asked(field.name)
        args.pop("confidencelevel", None)  # it concerns understanding, not listening
        if "timeout" in args:
            args["timeout"] = f"{args['timeout']}ms"
        self.owner.count_output(len(text), field.node)
        place = source(field.node)
        return Command("q-and-a", args, text or None, lang=field.lang, source=place, cues=cues)

    def _prompts(self, frame: Frame, fiber: Fiber, field: Field) -> list[Prompt]:
        """The prompts of a field the next time that it asks (4.1.6)."""
        return select_prompts(
            ((one.count, one) for one in field.prompts),
            frame.counters.prompts.get(field.name, 0) + 1,
            lambda one: one.cond is None or self.owner.execute.condition(one.cond, fiber),
        )

    def _process(self, frame: Frame, fiber: Fiber, item: Item, own: Sequence[Filled]) -> Content:
        """Run the filled elements that an answer has satisfied (VoiceXML 2.4)."""

        def is_defined(name: str) -> bool:
            return self.owner.engine.defined(frame.dialog, name)

        for index, filled in enumerate(own):
            if index and not is_defined(item.name):
                break  # an earlier one has cleared it
            fiber.local = None
            self.owner.note(filled.node)
            yield from self.owner.execute.run(filled.content, fiber)
        of_form = self._process_form(frame, fiber, item, is_defined)
        yield from self._catching(frame, fiber, item, None, of_form)

    def _process_form(
        self, frame: Frame, fiber: Fiber, item: Item, is_defined: Callable[[str], bool]
    ) -> Content:
        """Run the form's own filled elements; what they throw is the form's (5.2.4)."""
        inputs = [
            one.name for one in all_items(frame.form.items) if isinstance(one, Field | Subdialog)
        ]
        for filled in frame.form.filled:
            names = filled.names or inputs
            if satisfied(filled.mode, names, [item.name], is_defined):
                fiber.local = None
                self.owner.note(filled.node)
                yield from self.owner.execute.run(filled.content, fiber)

    def _call(self, frame: Frame, fiber: Fiber, item: Subdialog) -> Content:
        """Call another form in a context of its own and take its result."""
        depth, outer = 0, frame.caller
        while outer is not None:
            depth, outer = depth + 1, outer.caller
        check_depth(depth, item.node)
        form = self.owner.document.forms[item.form]
        given = self.owner.execute.passed(item.params, fiber, item.node)
        inner = self.owner.frame_for(form, None)
        inner.caller, inner.called_by, inner.given = frame, item, given
        result = self._chase(frame, self.owner.begin(inner))
        if result is None:
            result = yield 0
        if result.event:
            raise Thrown(result.event, "", source(item.node))
        self.owner.engine.set(frame.dialog, item.name, result.data["result"])
        yield from self._process(frame, fiber, item, item.filled)

    def _returned(self, frame: Frame, caller: Frame, back: GoBack) -> Notice:
        """The result of a subdialog that returned without waiting."""
        self.owner.leave(frame)
        self.owner.frame = caller
        self.owner.note(None, "leave", caller.form.id)
        return Notice("done", 0, data={"result": back.values}, event=back.event)

    def _chase(self, caller: Frame, pending: tuple[Frame, Transfer] | None) -> Notice | None:
        """Follow a subdialog's first transfers of control until it waits or returns.

        It is in the middle of being driven: the driver does so only when it is free again.
        """
        while pending is not None:
            frame, transfer = pending
            if isinstance(transfer, GoBack) and frame.caller is caller:
                return self._returned(frame, caller, transfer)
            pending = self.owner.go_to(frame, transfer)
        return None

    def _span(self, frame: Frame, fiber: Fiber, unit: Unit) -> Content:
        """Run a unit around form items: opened here, concluded however it is left (U5)."""
        number, fresh = next(self.owner.units), self.owner.fresh_for()
        self.owner.actions.append(
            OpenUnit(
                number,
                frame.state,
                unit.devices,
                unit.longest,
                self.owner.take_cause(),
                source(unit.node),
                self.owner.connects(frame),
                unit.types,
                fresh,
            )
        )
        frame.connected = frame.asked = True
        frame.units = (*frame.units, (number, unit))
        outer, fiber.unit = fiber.unit, number
        self.owner.engine.set(frame.dialog, unit.name, True)
        given_up = False
        try:
            yield from self._visit_unit(frame, fiber, unit)
        except Abandoned:
            given_up = True
            raise
        finally:
            fiber.unit = outer
            if not given_up:  # otherwise its handlers go on in it
                for other in frame.inside(number):
                    self.owner.forget(other)
            self.owner.close_units(frame)

    def _visit_unit(self, frame: Frame, fiber: Fiber, unit: Unit) -> Content:
        """Visit the items of a unit; a goto between them does not leave it, one to others does."""
        while True:
            try:
                yield from self._visit_all(frame, fiber, unit.items, unit)
                return
            except GoItem as go:
                frame.next_item, frame.silent = go.item, ""

    def after_timeout(self, frame: Frame, fiber: Fiber, unit: Unit, thrown: Thrown) -> Content:
        """U5: throw error.unit.timeout in the unit; then the form continues after it."""
        yield from self.owner.handling.handle_thrown(frame, fiber, unit, thrown, 0)
        frame.item = None
        yield from self._visit_all(frame, fiber, frame.form.items, None)
