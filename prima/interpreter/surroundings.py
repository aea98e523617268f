"""Checks what a document names against the world, the robot and the scenario."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

from prima.errors import Hint, Problem, Span, meant, one_of, suggestion
from prima.errors.diagnoses.names import NO_SUCH_NAME
from prima.grammar.text import fold
from prima.interpreter.acts import Declare, Pause, Text, holder_of
from prima.interpreter.elements import Document, Field, all_items, document_commands
from prima.interpreter.events import event_place, handlers_of
from prima.language.commands import TABLE_4_2, WRITTEN
from prima.markup.spans import instead, value_span
from prima.markup.tree import Node

NO_SENSOR = NO_SUCH_NAME.says(
    'The robot has no touch sensor "{name}".',
    "Name another, or add it to the robot's document.",
    "warning",
)
NO_VOICE = NO_SUCH_NAME.says(
    'The robot has no voice for "{name}".', "Add a <voice> to the robot's document.", "warning"
)
NOT_THERE = NO_SUCH_NAME.says(
    '{whose} no {what} "{name}".', "Name another, or add it there.", "warning"
)

PLACED = {"to": "place", "toward": "place or thing", "name": "gesture"}
"""Arguments of Commands that name something in the surroundings."""
FEW = 8
"""Maximum number of names listed if no guess can be made."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The names that a world and a robot define."""

    places: frozenset[str]
    gestures: frozenset[str]
    sensors: frozenset[str]
    voices: frozenset[str] = frozenset()
    """The languages that the robot speaks; none if its profile does not list them."""
    points: frozenset[str] = frozenset()
    """Places and things."""


def check_surroundings(document: Document, names: Surroundings) -> list[Problem]:
    """Warn of places, things, gestures, touch sensors and voices that do not exist.

    At run time they cause device errors, which a document may handle; a text is spoken anyway.
    """
    problems = list(_voices(document.node, names.voices)) if names.voices else []
    variables = _variables(document)
    for command in document_commands(document):
        row = TABLE_4_2.get(command.type)
        placed = PLACED.keys() & row.arguments.keys() if row is not None else ()
        for name, value in (*command.args.items(), *command.extra):
            if name in placed and isinstance(value, str):
                problems += check_name(command.node, name, value, names, variables)
    for handler in handlers_of(document):
        for event in handler.events:
            problems += check_sensor(handler.node, event, names)
    return problems


def check_sensor(node: Node, event: str, names: Surroundings) -> list[Problem]:
    """Warn of a handler that names the event of a missing touch sensor."""
    first, _, sensor = event.partition(".")
    if first != "touch" or not sensor or sensor in names.sensors:
        return []
    place = event_place(node, event)
    last = place._replace(column=place.column + len("touch."))
    hint = nearest(sensor, names.sensors, Span.of(last, sensor))
    return [NO_SENSOR.at(place, hint, name=sensor)]


def _voices(root: Node, voices: frozenset[str]) -> Iterator[Problem]:
    spoken = {one.lower().partition("-")[0] for one in voices}
    nodes = [root]
    while nodes:
        node = nodes.pop()
        nodes += [child for child in node.nodes if child.tag != "grammar"]
        lang = node.get("xml:lang")
        if lang and lang.lower().partition("-")[0] not in spoken:
            yield NO_VOICE.at(node.attribute_place("xml:lang"), nearest("", voices), name=lang)


def _variables(document: Document) -> set[str]:
    """The names of a document's variables and form items."""
    found = {act.name for act in document.setup if isinstance(act, Declare)}
    for form in document.forms.values():
        found |= {act.name for act in form.setup if isinstance(act, Declare)}
        found |= {item.name for item in all_items(form.items)}
    return found


def check_name(
    node: Node, name: str, value: str, names: Surroundings, variables: Collection[str] = ()
) -> list[Problem]:
    """Warn of an argument of a Command, one of :data:`PLACED`, that names something missing."""
    what = PLACED[name]
    known = {"to": names.places, "toward": names.points, "name": names.gestures}[name]
    if what == "gesture" and not known:
        return []  # the robot has no arm, which is reported already
    if value.strip() in known:
        return []
    whose = "The robot knows" if what == "gesture" else "The world has"
    holder, attribute = holder_of(node, name)
    hint = nearest(value, known, *value_span(holder, attribute))
    if value in variables:
        expr = "expr" if attribute == "value" else f"{name}-expr"
        hint = instead(f'It is a variable: write {expr}="{value}".', holder, attribute, expr, value)
    place = holder.attribute_place(attribute)
    return [NOT_THERE.at(place, hint, whose=whose, what=what, name=value)]


def nearest(word: str, known: Collection[str], *spans: Span) -> Hint:
    """The name probably meant, or all names; a fix writes it into some spans."""
    if (command := WRITTEN.get(word, "")) in known:
        return meant(command, *spans)
    if hint := suggestion(word, known, *spans):
        return hint
    few = 0 < len(known) <= FEW
    return Hint(f"There is {one_of(known).replace(' or ', ' and ')}." if few else "")


class Sayings:
    """The texts that some applications speak, gathered once.

    Of a text with expressions only the rest is known: words may be in it if they share one with
    that rest.
    """

    def __init__(self, texts: Iterable[Sequence[object]]) -> None:
        every = list(texts)
        self.lines = {_joined(text) for text in every}
        self._all = "\n".join(map(fold, self.lines))
        opened = [text for text in every if not all(isinstance(part, str | Pause) for part in text)]
        shared = [set(fold(_joined(text)).split()) for text in opened]
        self._shared: set[str] = set().union(*shared)
        self._open = not all(shared)
        """Whether only a run determines some text."""
        self.certain = not opened
        """Whether everything is known before a run."""

    def may_hold(self, words: str) -> bool:
        """Whether words may ever be said; true in case of doubt."""
        folded = fold(words)
        return self._open or folded in self._all or not self._shared.isdisjoint(folded.split())


def _joined(text: Sequence[object]) -> str:
    words = (" " if isinstance(part, Pause) else part for part in text)
    return " ".join("".join(part for part in words if isinstance(part, str)).split())


def texts_of(document: Document, asked: bool) -> list[Text]:
    """The texts of a document's questions and, unless ``asked``, of its Commands."""
    found: list[Text] = []
    for form in document.forms.values():
        for item in all_items(form.items):
            if isinstance(item, Field):
                found += [prompt.text for prompt in item.prompts]
                found.append(tuple(part for one in item.prompts for part in (*one.text, " ")))
    return (
        found if asked else [*found, *(one.text for one in document_commands(document) if one.text)]
    )
