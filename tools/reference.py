"""Writes schemas and the tables of the documentation from the tables in the code.

``python -m tools.reference`` writes them in place; with ``--check`` it writes
nothing, names what differs and exits with 1. It works in a checkout.
"""

from __future__ import annotations

import ast
import inspect
import json
import re
import sys
import textwrap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import prima
from prima.checks.codes import diagnoses
from prima.devices import loop
from prima.devices.vocabulary.robot import ROBOT
from prima.devices.vocabulary.services import SERVICES
from prima.errors import LONGEST_TEXT, UsageError
from prima.grammar import assent, chart
from prima.grammar.answers import TYPES
from prima.grammar.types import read
from prima.handbook import examples
from prima.interpreter import (
    application,
    bounds,
    content,
    expressions,
    handling,
    speaking,
    transfers,
)
from prima.interpreter.units import ARRANGING
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.interpreter.vocabulary.names import CONTENT, HANDLERS, SPEAKING
from prima.interpreter.vocabulary.questions import PROPERTIES
from prima.language.commands import LONGEST_TURN_MS, PATIENCE_MS, TABLE_4_2, CommandType
from prima.language.values import KINDS, LONGEST_MS
from prima.lsp.descriptions import VOICEXML_ATTRIBUTES
from prima.markup.limits import LIMITS
from prima.markup.vocabulary import Attribute, Element, Vocabulary
from prima.scheduler import admission, failures, starvation
from prima.script import budget, evaluation, host, parse, sandbox, syntax
from prima.sim.vocabulary.scenario import SCENARIO
from prima.sim.vocabulary.user import USER
from prima.sim.vocabulary.world import WORLD
from prima.transcript import lines
from prima.transcript.phases import PHASES
from prima.transcript.record import model
from prima.voicexml.arranging import UNIT, UNIT_HOLDS
from prima.voicexml.vocabulary import COMMANDS, EXPRESSIONS, VOICEXML, kind_of
from tools.guests import Guests, OpenVocabulary
from tools.rnc import make_rnc
from tools.xsd import (
    XML_SCHEMA,
    make_catalog,
    make_guest_schema,
    make_locating_rules,
    make_schema,
)

ROOT = Path(__file__).resolve().parent.parent
VOCABULARIES = (DIALOGUE, WORLD, ROBOT, SCENARIO, USER, SERVICES)
MARKER = re.compile(
    r"(<!-- generated: (?P<name>[\w-]+) -->\n).*?(<!-- end: (?P=name) -->)", re.DOTALL
)
Groups = Mapping[str, tuple[str, ...]]
GROUPS: Groups = {
    "[executable content](#executable-content)": tuple(CONTENT.split()),
    "[Commands](#commands)": (*SPEAKING.split(), "command"),
    "[handlers](#handlers)": tuple(HANDLERS.split()),
}
"""Children of the dialogue language that are listed together in the tables."""


# Tables ----------------------------------------------------------------------


def table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    """A Markdown table."""
    shown = [head, tuple("---" for _ in head), *rows]
    return "".join(f"| {' | '.join(_cell(cell) for cell in row)} |\n" for row in shown)


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def sentence(text: str) -> str:
    """A phrase as a sentence: with a capital and a full stop."""
    text = text.strip()
    return text[:1].upper() + text[1:] + ("" if not text or text[-1] in ".]" else ".")


def seconds(milliseconds: float) -> str:
    """A time as documents write it."""
    return f"{milliseconds:g}ms" if milliseconds < 1000 else f"{milliseconds / 1000:g}s"


def range_of(kind: str, low: float | None, high: float | None) -> str:
    """The range of a number, in words."""
    shown: Callable[[float], str] = seconds if kind == "duration" else "{:.12g}".format
    if low is not None and high is not None:
        return f"From {shown(low)} to {shown(high)}."
    if low is not None:
        return f"At least {shown(low)}."
    return f"At most {shown(high)}." if high is not None else ""


def attribute_row(item: Attribute) -> tuple[str, ...]:
    """A row of an element's table of attributes."""
    name = f"`{item.name}` or `{item.name}-expr`" if item.dynamic else f"`{item.name}`"
    kind = " or ".join(f"`{choice}`" for choice in item.choices) or item.kind
    default = "*required*" if item.required else f"`{item.default}`" if item.default else ""
    meaning = f"{sentence(item.doc)} {range_of(item.kind, item.low, item.high)}".strip()
    return (name, kind, default, meaning)


def children_of(vocabulary: Vocabulary, element: Element, groups: Groups) -> str:
    """The possible content of an element, groups of elements together."""
    left = list(element.children)
    words = []
    for name, keys in groups.items():
        if set(keys) <= set(left):
            words.append(name)
            left = [key for key in left if key not in keys]
    words += [f"`{vocabulary.elements[key].tag}`" for key in left]
    if element.text:
        words.insert(0, "text")
    return ", ".join(words) or "nothing"


def parents_of(vocabulary: Vocabulary, element: Element, groups: Groups) -> str:
    """The possible parents of an element, groups of elements together."""
    parents = [other for other in vocabulary.elements.values() if element.key in other.children]
    keys = [other.key for other in parents]
    words = []
    for name, members in groups.items():
        if len(members) > 1 and set(members) <= set(keys):
            words.append(name)
            keys = [key for key in keys if key not in members]
    tags = dict.fromkeys(vocabulary.elements[key].tag for key in keys)
    return ", ".join([*words, *(f"`{tag}`" for tag in tags)])


def heading(vocabulary: Vocabulary, element: Element) -> str:
    """An element's heading; one of two elements of a name also names its parents."""
    same = [other for other in vocabulary.elements.values() if other.tag == element.tag]
    if len(same) == 1:
        return f"`<{element.tag}>`"
    parents = vocabulary.parents(element.tag)
    own = [tag for tag in parents if element.key in _children(vocabulary, tag)]
    where = " and ".join(f"`<{tag}>`" for tag in own) if len(own) < 3 else "content"
    return f"`<{element.tag}>` in {where}"


def _children(vocabulary: Vocabulary, tag: str) -> set[str]:
    return {
        key for item in vocabulary.elements.values() if item.tag == tag for key in item.children
    }


def elements(vocabulary: Vocabulary, level: int, groups: Groups | None = None) -> str:
    """The reference of all elements of a kind of document."""
    parts = []
    for element in vocabulary.elements.values():
        parts.append(f"{'#' * level} {heading(vocabulary, element)}\n")
        source = f" *{sentence(element.source)}*" if element.source else ""
        parts.append(f"{sentence(element.doc)}{source}\n")
        where = parents_of(vocabulary, element, groups or {})
        parents = f"Parents: {where}." if where else "The root element."
        parts.append(f"Children: {children_of(vocabulary, element, groups or {})}. {parents}\n")
        if element.attributes:
            head = ("attribute", "kind", "default", "meaning")
            parts.append(table(head, map(attribute_row, element.attributes)))
    return "\n" + "\n".join(parts) + "\n"


def commands() -> str:
    """The thesis's Table 4.2 as applications write it."""
    return table(
        ("element", "devices", "marks", "text", "arguments"), map(_command, TABLE_4_2.values())
    )


def _command(row: CommandType) -> tuple[str, ...]:
    marks = {
        "feedback": row.feedback,
        "leaves the user": row.leaves,
        "engages the user": row.engages,
        "now": row.now,
    }
    name = "`field`" if row.name == "q-and-a" else f"`{row.name}`"
    arguments = [
        f"`{key}`" + ("*" if item.required else "°" if item.choice else "")
        for key, item in row.arguments.items()
    ]
    return (
        name,
        ", ".join(sorted(row.devices)) or "none",
        ", ".join(mark for mark, holds in marks.items() if holds),
        "" if row.text == "none" else row.text,
        ", ".join(arguments),
    )


def kinds() -> str:
    """The simple types that attributes have."""
    return table(("kind", "what it is"), ((name, sentence(k.doc)) for name, k in KINDS.items()))


def limits() -> str:
    """The limits of documents and runs."""
    mib = 1024 * 1024
    rows = (
        ("a file", f"{LIMITS.bytes:,} bytes", "`too-large`"),
        ("elements in a file", f"{LIMITS.elements:,}", "`too-large`"),
        ("attributes of an element", f"{LIMITS.attributes}", "`too-large`"),
        ("elements inside each other", f"{LIMITS.depth}", "`too-deep`"),
        ("problems listed", f"{LIMITS.problems:,}", "`more-problems`"),
        ("a problem's message or remedy", f"{LONGEST_TEXT:,} characters", "its middle is left out"),
        ("names that one script declares", f"{syntax.MOST_NAMES:,}", "`bad-expression`"),
        ("characters of one script", f"{parse.MOST_CODE:,}", "`bad-expression`"),
        ("a time in an attribute", f"{LONGEST_MS // 1000:,} s", "`bad-value`"),
        (
            "one evaluation of an expression or script",
            f"{syntax.TIME_LIMIT:g} s of processor time",
            "`error.semantic`",
        ),
        (
            "the tags of one utterance",
            f"{budget.TIME_LIMIT:g} s of processor time",
            "it does not match",
        ),
        (
            "memory of an application's ECMAScript",
            f"{sandbox.MEMORY_LIMIT // mib} MiB",
            "`error.semantic`",
        ),
        (
            "stack of an application's ECMAScript (some 600 calls within one another)",
            f"{sandbox.STACK_LIMIT // mib} MiB",
            "`error.semantic`",
        ),
        (
            "a value that leaves ECMAScript",
            f"{evaluation.RESULT_LIMIT:,} characters, "
            f"{evaluation.DEEPEST} lists and objects inside each other",
            "`error.semantic`",
        ),
        ("elements that a `foreach` goes through", f"{content.MAX_REPEATS:,}", "`error.semantic`"),
        ("what a Command says", f"{expressions.MAX_TEXT:,} characters", "the rest is not said"),
        (
            "what one utterance or question keeps the speaker, at 50 ms a character",
            f"{LONGEST_TURN_MS // 1000} s",
            "`too-long`, `error.semantic`",
        ),
        (
            "the same beside another application",
            f"the run's `patience`, {PATIENCE_MS // 1000} s by default",
            "`long-turn`, `error.semantic`",
        ),
        (
            "Commands of an application that wait beside one another",
            f"{admission.MOST_AT_ONCE}",
            "`error.semantic`",
        ),
        (
            "what an application says, logs and sends in one instant",
            f"{bounds.MAX_OUTPUT:,} characters",
            "the application ends",
        ),
        (
            "what an application says, logs and sends in a run",
            f"{bounds.MAX_WRITTEN:,} characters",
            "the application ends",
        ),
        (
            "content that an application goes through in a run",
            f"{bounds.MAX_RUN_STEPS:,} pieces, and {bounds.STEPS_A_SECOND:,} a second",
            "the application ends",
        ),
        (
            "Commands and messages of an application in a run",
            f"{bounds.MAX_ACTIONS:,}, and {bounds.ACTIONS_A_SECOND} a second",
            "the application ends",
        ),
        (
            "matching one utterance in all that an application listens for",
            f"{budget.MOST_MATCHING:,} steps",
            "the application ends",
        ),
        (
            "what all applications say, log and send in a run",
            f"{loop.MAX_WRITTEN:,} characters",
            "the run ends (exit code 3)",
        ),
        (
            "an application's scripts in one instant, all together",
            f"{evaluation.MAX_SCRIPT_SECONDS:g} s",
            "the application ends",
        ),
        (
            "an application's scripts and tags in a run, all together",
            f"{evaluation.MAX_RUN_SECONDS:g} s of processor time, and {evaluation.MAX_SHARE:.0%} of"
            " the run's own",
            "the application ends",
        ),
        (
            "processor time of a call that escapes the engine's own limit",
            f"{host.KILL_SECONDS:g} s",
            "the application ends",
        ),
        (
            "memory of a process with engines",
            f"{host.MEMORY_BYTES // mib} MiB",
            "the application ends",
        ),
        (
            "steps of content in one instant, or in instants joined by events sent without delay; beginning a "
            "form or form item counts 10, a dialog of VoiceXML 100, looking for the handler of an event "
            "among very many 1 for each 100",
            f"{bounds.MAX_STEPS:,}",
            "the application ends",
        ),
        (
            "waits in a row, for content, answers and calls",
            f"one in {bounds.BRIEF_MS} ms on an average, and {bounds.MOST_BRIEF:,} more",
            "the application ends",
        ),
        ("handlers under way at once in a state", f"{handling.MAX_FIBERS}", "the application ends"),
        (
            "events that handlers throw in turn, each while the one before is handled",
            f"{transfers.MAX_DEPTH + 1}",
            "the application ends",
        ),
        ("subdialogs inside each other", f"{transfers.MAX_DEPTH}", "`error.semantic`"),
        ("delayed events under way", f"{application.MAX_TIMERS}", "`error.semantic`"),
        (
            "steps of matching an utterance with a grammar",
            f"{chart.MAX_STEPS:,}",
            "it does not match",
        ),
        (
            "speech in one unit",
            f"about {speaking.LONG_UNIT_MS // 1000} s",
            "the warning `long-unit`",
        ),
        (
            "a Command, beyond the times it is given",
            f"{failures.HANG_MS // 1000} s",
            "`error.device.DEVICE`",
        ),
        (
            "loops that another application's equal Command waits",
            f"{starvation.STARVING_LOOPS}",
            "a `starve` record",
        ),
        ("records of a run", f"{loop.MAX_RECORDS:,}", "the run ends with exit code 3"),
        (
            "a line of a transcript that is read",
            f"{lines.MAX_LINE:,} characters",
            "it is refused",
        ),
        (
            "a transcript that is read",
            f"{lines.MAX_LINES:,} lines, {lines.MAX_CHARACTERS:,} characters,"
            f" {lines.MAX_VALUES:,} values",
            "the rest is not read (exit code 2)",
        ),
    )
    return table(("what", "limit", "beyond it"), rows)


def phases() -> str:
    """The phases of a transcript's records."""
    rows = ((f"`{name}`", one.meaning, one.notable) for name, one in PHASES.items())
    return table(("phase", "meaning", "notable fields"), rows)


def fields() -> str:
    """The fields of a transcript's record."""
    properties = model().model_json_schema()["properties"]
    return table(
        ("field", "type", "meaning"),
        (
            (f"`{name}`", _type(item), str(item.get("description", "")))
            for name, item in properties.items()
        ),
    )


def _type(item: Mapping[str, Any]) -> str:
    for option in item.get("anyOf", [item]):
        if "const" in option:
            return f"`{option['const']}`"
        if "enum" in option:
            words = option["enum"]
            return (
                " or ".join(f"`{word}`" for word in words)
                if len(words) < 6
                else "one of the [phases](#phases)"
            )
        if option.get("type") == "array":
            return f"array of {_type(option['items'])}s"
        if option.get("type") != "null":
            return str(option.get("type", ""))
    return ""


def codes() -> str:
    """The codes of problems."""
    return table(
        ("code", "problem", "rule or section"),
        (
            (f"[`{one.code}`](#{one.code})", _quoted(one.title), one.rule)
            for one in diagnoses().values()
        ),
    )


def code_examples() -> str:
    """A wrong and a right example for each code, with what is said of the wrong one."""
    parts = []
    for code in diagnoses():
        wrong, right = examples.examples(code)
        parts += [f"## {code}", _quoted(examples.meaning(code))]
        for name, text in examples.beside(code).items():
            parts += [f"`{name}`:", _listing(text)]
        parts += [examples.headline(code, "Wrong"), _listing(wrong.text)]
        parts += [_listing(examples.problems_of(wrong)), examples.headline(code, "Right")]
        parts += [_listing(right.text)]
    return "\n" + "\n\n".join(parts) + "\n\n"


def _quoted(text: str) -> str:
    """Text with its tags and entities as Markdown shows them."""
    return re.sub(r"<[^>]+>|(?:&\w+; ?)+(?<=;)", r"`\g<0>`", text)


def _listing(text: str) -> str:
    return f"```text\n{text.rstrip()}\n```"


def defaults() -> str:
    """How long things take where nothing else is said."""
    question = TABLE_4_2["q-and-a"].arguments
    timeout = question["timeout"].default
    assert isinstance(timeout, int)
    usual = {"timeout": seconds(timeout), "bargein": str(question["bargein"].default).lower()}
    rows = [
        (f"`{name}`", item.kind, f"`{usual.get(name, item.default)}`", sentence(item.doc))
        for name, item in PROPERTIES.items()
    ]
    return table(("property", "kind", "default", "meaning"), rows)


def _any_language(words: dict[str, str]) -> str:
    """The answers taken in any language, each once."""
    return ", ".join(dict.fromkeys("|".join(words.values()).split("|")))


ACCEPTED = {
    "boolean": (
        "One or more words of assent, or of refusal: "
        + "; ".join(_any_language(words) for words in (assent.YES, assent.NO)),
        ("Yes, please.", "OK, sure!", "No, thank you.", "はい"),
    ),
    "number": (
        "A number in digits, in English words or in Japanese numerals, with a sign or decimals",
        ("12", "1.5", "-3", "twenty-one", "two hundred and five", "二十三"),
    ),
    "digits": (
        "Digits or their names, with or without spaces; they stay text",
        ("0 7 2", "oh seven four three"),
    ),
    "date": (
        "Year, month and day, in digits or words; three numbers with the year last begin with the month",
        ("2009-3-9", "2009/03/09", "2009年3月9日", "March 9th, 2009", "3/9/2009"),
    ),
    "time": (
        "A time of day, of 24 hours or with a.m. or p.m.",
        ("9", "9:30 p.m.", "21.15", "7 o'clock", "half past five", "3時20分"),
    ),
    "text": ("Anything said, white space folded", ("Tell him  I'll wait.",)),
}
"""The answers that each built-in type takes, and utterances with their values."""


def types() -> str:
    """The built-in types of fields, with the values that utterances give."""
    rows = []
    for name in TYPES:
        what, said = ACCEPTED[name]
        shown = [f"{one} → `{json.dumps(read(name, one), ensure_ascii=False)}`" for one in said]
        rows.append((f"`{name}`", sentence(what), ", ".join(shown)))
    return table(("type", "takes", "what is said, and the value"), rows)


# The interface ----------------------------------------------------------------


def interface() -> str:
    """The package's exports: signatures and docstrings."""
    parts = []
    public = [name for name in prima.__all__ if not name.startswith("_")]
    for name in sorted(public, key=lambda name: (not _is_function(name), name.lower())):
        thing = getattr(prima, name)
        if _is_function(name):
            parts.append(f"## `{name}{_signature(thing)}`\n")
            parts.append(_prose(thing))
        else:
            parts.append(f"## `{name}`\n")
            parts.append(_prose(thing))
            parts += _members(thing)
    return "\n" + "\n".join(parts) + "\n"


def _is_function(name: str) -> bool:
    return inspect.isfunction(getattr(prima, name))


class _Bare(str):
    """An annotation, shown without quotes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def _signature(function: Callable[..., object]) -> str:
    signature = inspect.signature(function)
    parameters = [
        one if one.annotation is one.empty else one.replace(annotation=_Bare(one.annotation))
        for one in signature.parameters.values()
    ]
    gives = signature.return_annotation
    return str(signature.replace(parameters=parameters, return_annotation=_Bare(gives)))


def _members(thing: type) -> list[str]:
    """Public fields, properties and methods of a class."""
    docs: dict[str, str] = {}
    for one in reversed(getattr(thing, "__mro__", (thing,))):
        docs |= _field_docs(one) if inspect.get_annotations(one) else {}
    rows = [
        (f"`{name}: {getattr(kind, '__forward_arg__', kind)}`", docs.get(name, ""))
        for one in reversed(getattr(thing, "__mro__", (thing,)))
        for name, kind in inspect.get_annotations(one).items()
        if not name.startswith("_")
    ]
    for name, member in vars(thing).items():
        if name.startswith("_"):
            continue
        if isinstance(member, property):
            rows.append((f"`{name}`", _marked(inspect.getdoc(member) or "")))
        elif inspect.isfunction(member):
            rows.append((f"`{name}{_signature(member)}`", _marked(inspect.getdoc(member) or "")))
    return [table(("member", "meaning"), rows)] if rows else []


def _field_docs(thing: type) -> dict[str, str]:
    """The strings written behind the fields of a class."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(thing)))
    body = tree.body[0].body if isinstance(tree.body[0], ast.ClassDef) else []
    docs: dict[str, str] = {}
    for entry, behind in pairwise(body):
        match entry, behind:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(text))),
            ):
                docs[name] = _marked(text)
    return docs


SECTION = re.compile(r"^(Args|Returns|Raises):$\n((?:[ ]{4}.*\n?|\n)+)", re.MULTILINE)
ROLE = re.compile(r":\w+:`~?([^`]+)`")


def _prose(thing: object) -> str:
    """A docstring as Markdown."""
    text = inspect.getdoc(thing) or ""
    if text.startswith(f"{getattr(thing, '__name__', '')}("):
        text = ""  # what dataclass writes where the author wrote nothing

    def listed(match: re.Match[str]) -> str:
        if match[1] == "Returns":
            return f"Returns: {' '.join(match[2].split())}\n\n"
        entries: list[str] = []
        for row in textwrap.dedent(match[2]).splitlines():
            if row and not row[0].isspace():
                entries.append(row)
            elif row.strip():
                entries[-1] += " " + row.strip()
        shown = []
        for entry in entries:
            name, _, rest = entry.partition(": ")
            shown.append(f"- `{name}`: {rest}")
        return f"{match[1]}:\n\n" + "\n".join(shown) + "\n\n"

    return _marked(SECTION.sub(listed, text + "\n")).strip() + "\n"


def _marked(text: str) -> str:
    """A docstring's marks as Markdown's."""
    return ROLE.sub(r"`\1`", text).replace("``", "`")


# Files ---------------------------------------------------------------------------

SECTIONS: dict[str, Callable[[], str]] = {
    "commands": commands,
    "kinds": kinds,
    "questions": defaults,
    "types": types,
    "limits": limits,
    "dialogue": lambda: elements(DIALOGUE, 3, GROUPS),
    "world": lambda: elements(WORLD, 4),
    "robot": lambda: elements(ROBOT, 4),
    "scenario": lambda: elements(SCENARIO, 4),
    "user": lambda: elements(USER, 4),
    "services": lambda: elements(SERVICES, 4),
    "fields": fields,
    "phases": phases,
    "codes": codes,
    "examples": code_examples,
    "interface": interface,
}
"""The generated parts of the documentation, by the names of their markers."""


def fill(name: str, text: str) -> str:
    """Put the generated sections between a document's markers.

    Raises:
        UsageError: a marker names no section, or has no end.
    """

    def section(match: re.Match[str]) -> str:
        make = SECTIONS.get(match["name"])
        if make is None:
            raise UsageError(f'{name}: there is no generated section "{match["name"]}".')
        return f"{match[1]}{make()}{match[3]}"

    filled = MARKER.sub(section, text)
    if filled.count("<!-- generated: ") != len(MARKER.findall(filled)):
        raise UsageError(f"{name}: a marker of a generated section has no end.")
    return filled


def voicexml() -> Vocabulary:
    """VoiceXML's elements with the descriptions of editors."""
    elements = [
        replace(
            element,
            source=VOICEXML_SECTION.sub(r"VoiceXML \1", element.source),
            attributes=tuple(_voicexml_attribute(element, one) for one in element.attributes),
        )
        for element in VOICEXML.elements.values()
    ]
    return OpenVocabulary(VOICEXML, elements, ("grammar", "metadata"), _guests())


def _guests() -> Guests:
    """The elements of PRIMA's own language that VoiceXML documents may have."""
    made = [_guest(DIALOGUE.elements[key]) for key in sorted([*COMMANDS, *ARRANGING])]
    made += [replace(DIALOGUE.elements["param"], children=())]
    return Guests(DIALOGUE.namespace, f"{VOICEXML.name}-prima", tuple(made))


def _guest(element: Element) -> Element:
    """A Command without what only PRIMA's language has for it; a unit of either kind."""
    row = TABLE_4_2.get(element.key)
    held = [one for one in element.attributes if row is None or one.name in row.arguments]
    if element.key == "command":
        held = [one for one in held if one.name == "type"]
    children: tuple[str, ...] = ()
    if element.key == "iu":
        own = {one.name for one in held}
        items = DIALOGUE.elements[UNIT]
        children = tuple(key for key in VOICEXML.elements if key in UNIT_HOLDS)
        held += [one for one in items.attributes if one.name not in own]
        element = replace(
            element,
            doc=f"{element.doc} In a form: {items.doc}",
            source="thesis 4.1 (2); rules U4 and U5",
        )
    return replace(element, attributes=tuple(held), children=children)


VOICEXML_SECTION = re.compile(r"^([0-9].*)")
VOICEXML_KINDS = {
    "time": "duration",
    "integer": "integer",
    "rate": "text",
    "weight": "text",
    "": "text",
}


def _voicexml_attribute(element: Element, item: Attribute) -> Attribute:
    doc = VOICEXML_ATTRIBUTES.get(item.name, "")
    values = kind_of(element.key, item.name)
    if item.name in EXPRESSIONS:
        return replace(item, kind="expression", doc=doc)
    if values in VOICEXML_KINDS:
        return replace(item, kind=VOICEXML_KINDS[values], doc=doc)
    return replace(item, choices=tuple(values.split()), doc=doc)


def record_schema() -> str:
    """The JSON Schema of a transcript's record."""
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **model().model_json_schema(),
    }
    return json.dumps(schema, ensure_ascii=False, indent=2) + "\n"


def outputs(root: Path) -> dict[Path, str]:
    """Every generated file of a checkout with what it should hold.

    Raises:
        UsageError: the folder is not a checkout, or a marker is wrong.
    """
    schemas, docs = root / "schemas", root / "docs"
    if not docs.is_dir():
        raise UsageError(f"{root} is not a checkout: it has no docs folder.")
    kinds = (*VOCABULARIES, voicexml())
    made = {schemas / f"{one.name}.xsd": make_schema(one) for one in kinds}
    made |= {schemas / f"{one.name}.rnc": make_rnc(one) for one in kinds}
    made[schemas / "catalog.xml"] = make_catalog(
        {one.namespace: f"{one.name}.xsd" for one in kinds}
    )
    made[schemas / "schemas.xml"] = make_locating_rules(
        {one.namespace: f"{one.name}.rnc" for one in kinds}
    )
    made[schemas / "xml.xsd"] = XML_SCHEMA
    guests = _guests()
    made[schemas / f"{guests.name}.xsd"] = make_guest_schema(guests)
    made[schemas / "transcript.schema.json"] = record_schema()
    for path in sorted(docs.glob("*.md")):
        text = path.read_text(encoding="utf-8")
        if "<!-- generated: " in text:
            made[path] = fill(path.name, text)
    return made


def differing(root: Path) -> list[str]:
    """The generated files that do not hold what they should, relative to the checkout."""
    return [
        path.relative_to(root).as_posix()
        for path, text in outputs(root).items()
        if not path.is_file() or path.read_text(encoding="utf-8") != text
    ]


def main(arguments: list[str]) -> int:
    """Write what is generated, or with ``--check`` name what differs."""
    if arguments not in ([], ["--check"]):
        print("usage: python -m tools.reference [--check]", file=sys.stderr)
        return 2
    try:
        names = differing(ROOT)
        made = outputs(ROOT)
    except UsageError as error:
        print(f"prima: {error}", file=sys.stderr)
        return 2
    for name in names:
        if arguments:
            print(f"{name} differs from the code; run python -m tools.reference", file=sys.stderr)
        else:
            (ROOT / name).write_text(made[ROOT / name], encoding="utf-8", newline="\n")
            print(f"written: {name}")
    return 1 if arguments and names else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
