"""Prices of the parts of an application in PRIMA's language."""

from __future__ import annotations

from collections.abc import Sequence

from prima.checks.prices.commands import command_price, group_price, unit_price
from prima.checks.prices.contents import contents_of, inside, runs_once, thrown_by
from prima.checks.prices.model import UNKNOWN_LETTERS, Price, devices_of
from prima.checks.prices.texts import Constants
from prima.devices.profile import Profile
from prima.devices.voice import duration
from prima.interpreter.acts import (
    Act,
    CommandRun,
    CommandTemplate,
    Expression,
    GroupTemplate,
    Handler,
    Pause,
    StepTemplate,
    Text,
    all_acts,
    pauses_in,
)
from prima.interpreter.elements import Block, Document, Field, Form, Item, Prompt, Unit
from prima.interpreter.selection import takes
from prima.interpreter.units import Finder
from prima.language.commands import TABLE_4_2

ASKED_AGAIN = "the question is asked again until the user answers"
OFTEN = "an expression says how often it is done"
SAYS = "an expression gives its text"
QUESTION = TABLE_4_2["q-and-a"]
DEFAULT_TIMEOUT = int(QUESTION.arguments["timeout"].default or 0)
INNER = ("noinput", "nomatch", "help", "end", "cancel", "interrupted", "exit", "error")
"""Prefixes of the application's own events: handling them is not a reaction (C5)."""
BROKEN = ("error.device", "error.unsupported")
"""Events of device failures: then no duration holds."""
SERVICES = "error.service"


class Times:
    """How long Commands, questions and units may last."""

    def __init__(self, document: Document, profile: Profile, finder: Finder) -> None:
        self.document = document
        self.profile = profile
        self.constants = Constants(document)
        self.thrown = thrown_by(document)
        self.of_items: dict[int, Price] = {}
        """Durations of fields and units, by the index of their element."""
        self._of_steps: dict[int, Price] = {}
        """Durations of steps, by their identities."""
        self.finder = finder

    def steps(self, content: Sequence[Act]) -> list[Price]:
        """The parts of executable content."""
        runs = [act for act in all_acts(content) if isinstance(act, CommandRun)]
        return [self.step(step) for run in runs for step in run.steps]

    def step(self, step: StepTemplate) -> Price:
        """A Command, or a unit of them (U4)."""
        if id(step) not in self._of_steps:
            self._of_steps[id(step)] = self._step(step.what)
        return self._of_steps[id(step)]

    def _step(self, what: CommandTemplate | GroupTemplate) -> Price:
        if isinstance(what, CommandTemplate):
            return self.command(what)
        inner = [self.step(one) for one in what.steps]
        return group_price(what.node, what.longest, inner, [one.after for one in what.steps])

    def command(self, command: CommandTemplate) -> Price:
        """A Command by itself."""
        args = {
            name: None if isinstance(value, Expression) else value
            for name, value in command.args.items()
        }
        return command_price(command.node, command.type, args, self.said(command), self.profile)

    def said(self, command: CommandTemplate) -> tuple[int, str] | None:
        """How long a Command speaks at most (ms), and why it may be longer; None if it is silent."""
        lang = command.lang or self.document.lang
        return self.speech(command.text, lang) if command.text else None

    def speech(self, text: Text, lang: str) -> tuple[int, str]:
        """The longest duration of a text (ms), and why it may be longer."""
        known = [self._texts(one) for one in text if not isinstance(one, Pause)]

        def weight(piece: str) -> int:
            return duration(f"{piece} x", lang, self.profile.voices)

        said = "".join(
            "x" * UNKNOWN_LETTERS if one is None else max(one, key=weight, default="")
            for one in known
        )
        spoken = duration(said, lang, self.profile.voices) if known else 0
        return spoken + pauses_in(text), SAYS if None in known else ""

    def _texts(self, piece: str | Expression) -> list[str] | None:
        return self.constants.texts(piece.code) if isinstance(piece, Expression) else [piece]

    def question(self, field: Field, form: Form) -> Price:
        """A question: its longest prompts and the time without an answer (C4)."""
        settings = (field.properties, form.properties, self.document.properties)
        usual = next((one["timeout"] for one in settings if "timeout" in one), DEFAULT_TIMEOUT)
        lasts, unknown = 1 + int(usual) if self._unsaid(field, form) else 0, ""
        for count in {prompt.count for prompt in field.prompts}:
            said = [prompt for prompt in field.prompts if prompt.count == count]
            asked, why = self._asked(said, int(usual), field.lang or self.document.lang)
            unknown = unknown or why
            lasts = max(lasts, asked)
        return Price(
            field.node, "question", QUESTION.devices, lasts, unknown, engages=True, listens=True
        )

    def _asked(self, said: list[Prompt], usual: int, lang: str) -> tuple[int, str]:
        """The duration of prompts and the wait for an answer (ms), and why it may be longer."""
        text = [piece for prompt in said for piece in (" ", *prompt.text)][1:]
        speech, why = self.speech(tuple(text), lang)
        timeout = max(usual if one.timeout is None else one.timeout for one in said)
        return speech + max(timeout, 1), why

    def _unsaid(self, field: Field, form: Form) -> bool:
        """Whether a question may be asked silently, as a handler may not repeat it aloud."""
        always = any(prompt.count == 1 and prompt.cond is None for prompt in field.prompts)
        handlers = [*field.handlers, *form.handlers, *self.document.handlers]
        return not always or any(self.takes_inner(one) for one in handlers)

    def unit(self, unit: Unit, form: Form) -> Price:
        """A unit around form items: its longest duration, and what then runs to its end (U5)."""
        inner = [price for one in inside(unit) for price in self._within(one, unit)]
        reach = self.finder.reach(form, unit)
        inner += [self.command(one.command) for one in reach.commands if not one.inside]
        lasts = unit.longest + max((one.lasts for one in inner), default=0)
        if _runs_once(unit) and all(one.inside for one in reach.commands):
            lasts = min(lasts, sum(one.lasts for one in inner))
        return unit_price(unit.node, reach.devices | devices_of(inner), lasts, inner)

    def _within(self, part: Item | Handler, unit: Unit) -> list[Price]:
        own = self.of_items.get(part.node.index) if part is not unit else None
        return ([own] if own else []) + [
            price for content in contents_of(part) for price in self.steps(content)
        ]

    def takes_inner(self, handler: Handler) -> bool:
        """Whether it may take an event of the application's own activity, without a wait."""
        names = [name for name in handler.events if not name.startswith((*BROKEN, SERVICES))]
        return any(is_inner(name) or name in self.thrown for name in names)


def is_inner(name: str) -> bool:
    """Whether an event belongs to the application's own activity."""
    return any(takes(one, name) for one in INNER)


def _runs_once(unit: Unit) -> bool:
    """Whether everything in a unit runs at most once."""
    handled = unit.handlers or any(item.handlers for item in unit.items)
    blocks = all(isinstance(item, Block) and runs_once(item.content) for item in unit.items)
    return blocks and not handled
