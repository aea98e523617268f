"""What parts of an application cost others: how long a reaction may have to wait for them.

Nothing that runs is cut (rule U1), and nothing breaks a unit (U4, U5); so a reaction that needs
the same device waits for the end. The times are those of the simulator's voice and gestures.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from prima.commands import TABLE_4_2, CommandType
from prima.deferred import dataclass
from prima.errors import Place, Problem
from prima.interpreter.elements import (
    Act,
    Block,
    CommandTemplate,
    Document,
    Expression,
    Field,
    Form,
    GroupTemplate,
    Item,
    Pause,
    Run,
    StepTemplate,
    Text,
    Unit,
    all_acts,
    all_items,
    pauses_in,
)
from prima.markup.tree import Node
from prima.sim.scenario import POINTING_MS, Profile
from prima.sim.voice import duration
from prima.values import milliseconds
from prima.voicexml.document import VoiceDocument

UNKNOWN_LETTERS = 20
"""How much an expression in a text is taken to say."""
QUESTION = TABLE_4_2["q-and-a"]
DEFAULT_TIMEOUT = int(QUESTION.arguments["timeout"].default or 0)
OUTSIDE = ("touch", "human", "message", "reply", "emergency")
"""What events from outside begin with: what an application does about them is a reaction (C5)."""
VOICE_TIMEOUT = 5_000
"""VoiceXML's questions wait so long (ms) where nothing says otherwise."""


@dataclass(frozen=True, slots=True)
class Price:
    """A part of an application that nothing breaks."""

    node: Node
    what: str
    """``unit``, ``question`` or the Command's name."""
    devices: frozenset[str]
    lasts: int
    """The longest that others wait (ms), as far as the document tells."""
    known: bool
    """Whether all of it is known: no expression, no motion whose length the world decides."""
    leaves: bool = False
    loops: bool = False
    """Whether it works in loops, between which it gives way: ``lasts`` is one loop."""

    @property
    def place(self) -> Place:
        """Where it stands."""
        return self.node.place

    @property
    def seconds(self) -> str:
        """How long others wait, for people."""
        return f"{'' if self.known else 'at least '}{self.lasts / 1000:.1f} s"


def prices(document: Document | VoiceDocument, profile: Profile) -> list[Price]:
    """All parts of an application that nothing breaks, in document order."""
    if isinstance(document, VoiceDocument):
        return _voice(document, profile)
    found: list[Price] = []
    inside: set[int] = set()
    for form in document.forms.values():
        for item in all_items(form.items):
            if isinstance(item, Unit):
                found.append(_around_items(item, document, profile))
                inside |= {one.node.index for one in all_items(item.items)}
            elif isinstance(item, Field) and item.node.index not in inside:
                found.append(_question(item, form, document, profile))
    for _, content, node in document.contents():
        if node.index in inside:
            continue
        for act in all_acts(content):
            if isinstance(act, Run):
                found += [_step(step, document.lang, profile) for step in act.steps]
    return sorted(found, key=lambda price: price.node.index)


def notes(document: Document, profile: Profile) -> list[Problem]:
    """What units cost, as notes for ``prima validate --notes``."""
    return [
        Problem(
            price.place,
            "note",
            "unit-price",
            f"While this unit runs, a reaction that needs its devices waits up to {price.seconds}.",
        )
        for price in prices(document, profile)
        if price.what == "unit"
    ]


def worst(held: Iterable[Price], devices: frozenset[str]) -> Price | None:
    """The part for which something that needs these devices may wait longest."""
    fitting = [price for price in held if price.devices & devices]
    return max(fitting, key=lambda price: price.lasts, default=None)


def reactions(document: Document) -> dict[str, frozenset[str]]:
    """The devices that an application's first Commands need after each event it handles."""
    found: dict[str, frozenset[str]] = {}
    handlers = [*document.handlers]
    outside = (*OUTSIDE, *(watch.name for watch in document.watches))
    for form in document.forms.values():
        handlers += form.handlers
        for item in all_items(form.items):
            handlers += item.handlers
    for handler in handlers:
        needed = first_devices(document, handler.content)
        for event in handler.events:
            if needed and event.startswith(outside):
                found[event] = found.get(event, frozenset()) | needed
    return found


def first_devices(document: Document, content: Sequence[Act]) -> frozenset[str]:
    """The devices of the first Commands of some content, or of the form that it goes to."""
    for act in all_acts(content):
        if isinstance(act, Run):
            return devices_of(act.steps)
        target = getattr(act, "form", None)
        if isinstance(target, str) and target.removeprefix("#") in document.forms:
            return _first_of(document.forms[target.removeprefix("#")])
    return frozenset()


def _first_of(form: Form) -> frozenset[str]:
    for item in all_items(form.items):
        if isinstance(item, Field):
            return QUESTION.devices
        for act in all_acts(item.content) if isinstance(item, Block) else ():
            if isinstance(act, Run):
                return devices_of(act.steps)
    return frozenset()


def devices_of(steps: Iterable[StepTemplate]) -> frozenset[str]:
    """The devices of Commands and units."""
    found: frozenset[str] = frozenset()
    for step in steps:
        if isinstance(step.what, GroupTemplate):
            found |= devices_of(step.what.steps)
        else:
            row = TABLE_4_2.get(step.what.type)
            found |= row.occupied("x" if step.what.text else None) if row else frozenset()
    return found


# Times --------------------------------------------------------------------------------------


def _step(step: StepTemplate, lang: str, profile: Profile) -> Price:
    what = step.what
    if isinstance(what, CommandTemplate):
        return _command(what, lang, profile)
    lasts, known = _group(what.steps, lang, profile)
    return Price(what.node, "unit", devices_of([step]), min(lasts, what.longest), known)


def _group(steps: Sequence[StepTemplate], lang: str, profile: Profile) -> tuple[int, bool]:
    """How long the steps of a unit take, each after those that it follows."""
    ends: list[int] = []
    known = True
    for step in steps:
        price = _step(step, lang, profile)
        known &= price.known
        ends.append(max((ends[index] for index in step.after), default=0) + price.lasts)
    return max(ends, default=0), known


def _command(command: CommandTemplate, lang: str, profile: Profile) -> Price:
    row = profile.commands.get(command.type) or TABLE_4_2.get(command.type)
    speech, known = _speech(command.text, command.lang or lang, profile)
    if row is None:
        return Price(command.node, command.type, frozenset(), speech, False)
    devices = row.occupied("x" if command.text else None)
    if row.feedback:
        loop = profile.durations.get(row.name, profile.loop)
        lasts = max(loop, speech)
        return Price(command.node, row.name, devices, lasts, known, row.leaves, loops=True)
    motion, sure = _motion(command, row, profile)
    return Price(command.node, row.name, devices, max(speech, motion), known and sure, row.leaves)


def _motion(command: CommandTemplate, row: CommandType, profile: Profile) -> tuple[int, bool]:
    """How long a Command moves, and whether the document alone tells."""
    args = command.args
    match row.name:
        case "speak" | "stop-moving":
            return 1, True
        case "point-by-hand":
            return POINTING_MS, True
        case "gesture":
            return profile.gestures.get(str(args.get("name")), 0), isinstance(args.get("name"), str)
        case "pause" | "set-speed-and-time":
            time = args.get("time")
            return milliseconds(time, 0) if isinstance(time, str) else 0, isinstance(time, str)
        case "turn" if isinstance(args.get("angle"), int | float):
            return round(abs(float(str(args["angle"]))) / profile.turn_speed * 1000), True
        case name:
            return profile.durations.get(name, 0), name in profile.durations


def _speech(text: Text | None, lang: str, profile: Profile) -> tuple[int, bool]:
    if not text:
        return 0, True
    unknown = "x" * UNKNOWN_LETTERS
    words = [one if isinstance(one, str) else unknown for one in text if not isinstance(one, Pause)]
    known = not any(isinstance(one, Expression) for one in text)
    spoken = duration("".join(words), lang, profile.voices) if words else 0
    return spoken + pauses_in(text), known


def _question(field: Field, form: Form, document: Document, profile: Profile) -> Price:
    """A question: its longest prompt and the time in which nobody answers (C4)."""
    lasts, known = 0, True
    for prompt in field.prompts:
        speech, sure = _speech(prompt.text, field.lang or document.lang, profile)
        known &= sure
        timeout = prompt.timeout
        for properties in (field.properties, form.properties, document.properties):
            timeout = timeout if timeout is not None else properties.get("timeout")
        lasts = max(lasts, speech + (DEFAULT_TIMEOUT if timeout is None else int(timeout)))
    return Price(field.node, "question", QUESTION.devices, lasts, known)


def _around_items(unit: Unit, document: Document, profile: Profile) -> Price:
    """A unit around form items: with a question in it nobody knows how often it is asked."""
    lasts, known = 0, True
    for item in all_items(unit.items):
        if isinstance(item, Field):
            lasts = unit.longest
        lasts += _block(item, document.lang, profile)
    return Price(unit.node, "unit", unit.devices, min(lasts, unit.longest), known)


def _block(item: Item, lang: str, profile: Profile) -> int:
    content = item.content if isinstance(item, Block) else []
    runs = [act for act in all_acts(content) if isinstance(act, Run)]
    return sum(_group(run.steps, lang, profile)[0] for run in runs)


def _voice(document: VoiceDocument, profile: Profile) -> list[Price]:
    """The prompts of a VoiceXML document; the last before an input item is its question."""
    found: list[Price] = []
    for node in document.page.root.walk():
        if node.tag != "prompt":
            continue
        letters = _voice_text(node)
        asks = any(node in item.nodes for item in _items(document.page.root))
        speech = duration(letters, node.get("xml:lang") or document.lang, profile.voices)
        what, devices = (
            ("question", QUESTION.devices) if asks else ("speak", frozenset({"speaker"}))
        )
        known = "x" * UNKNOWN_LETTERS not in letters
        found.append(Price(node, what, devices, speech + (VOICE_TIMEOUT if asks else 0), known))
    return found


def _items(root: Node) -> list[Node]:
    forms = root.all("form", "menu")
    return [*root.all("menu"), *(one for form in forms for one in form.all("field", "initial"))]


def _voice_text(node: Node) -> str:
    parts = [
        one if isinstance(one, str)
        else "x" * UNKNOWN_LETTERS if one.tag in ("value", "enumerate")
        else _voice_text(one)
        for one in node.content
    ]  # fmt: skip
    return " ".join(parts)
