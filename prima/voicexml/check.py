"""Everything wrong with a VoiceXML document, with its place: the Recommendation's schema and rules."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from prima.errors import (
    Hint,
    Place,
    Problem,
    few,
    meant,
    nearest_word,
    one_of,
    replaced,
    suggestion,
)
from prima.interpreter.checks import given_to
from prima.language.commands import TABLE_4_2, CommandType, excluding_arguments
from prima.language.values import NUMBER, read_value
from prima.markup.slips import meant_value
from prima.markup.spans import added, attribute_span, name_spans, renamed, value_span
from prima.markup.tree import Node
from prima.markup.vocabulary import Element, Instead
from prima.script.compile import compiled
from prima.script.evaluation import EngineLost, ScriptError
from prima.script.globals import IDENTIFIER, RESERVED
from prima.script.isolated import IsolatedSyntax, syntax
from prima.script.names import SCOPES, script_names
from prima.voicexml.arranging import (
    ARRANGING,
    UNIT,
    check_arranged,
    check_items,
    is_unit,
    parts_of,
)
from prima.voicexml.cues import is_rate
from prima.voicexml.upgrade import version_problem
from prima.voicexml.vocabulary import (
    ALTERNATIVES,
    COMMANDS,
    EXPRESSIONS,
    HOLDING,
    NAMESPACE,
    PRIMA_NAMESPACE,
    SRGS,
    VALUES,
    VOICEXML,
)

KEYS = re.compile(r"\s*[0-9*#A-D](?:\s*[0-9*#A-D])*\s*")
MOST_ALIKE = 5
"""Of problems that say the same, so many are told, each with its place."""
HABITS: dict[str, str | Instead] = {
    "speak": Instead("prompt"),
    "say": Instead("prompt"),
    "on": Instead("catch", 'event="..."'),
    "send": Instead("submit"),
    "iu": f'Write <p:iu> around Commands or form items, with xmlns:p="{PRIMA_NAMESPACE}".',
    "par": f'Write <p:par> around Commands, with xmlns:p="{PRIMA_NAMESPACE}".',
    "seq": f'Write <p:seq> around Commands, with xmlns:p="{PRIMA_NAMESPACE}".',
}
"""What to write for elements of other languages."""
HOLDERS = {
    "foreach": "a <foreach> of executable content",
    "said-foreach": "a <foreach> of a prompt",
}
"""What elements are that hold different things by where they stand."""
INPUT_ITEMS = ("field", "record", "object", "subdialog", "transfer")
FORM_ITEMS = (*INPUT_ITEMS, "block", "initial")


@dataclass(frozen=True, slots=True)
class Entry:
    """What the tables say of an element, ready for use."""

    known: frozenset[str]
    required: tuple[str, ...]
    kinds: dict[str, str]
    alternatives: tuple[tuple[str, ...], ...]
    text: bool


def _entry(element: Element) -> Entry:
    names = [item.name for item in element.attributes]
    kinds = {name: VALUES.get(f"{element.key} {name}") or VALUES.get(name, "") for name in names}
    kinds["xml:lang"] = "" if element.key == "grammar" else "language"  # a grammar tells it itself
    return Entry(
        frozenset(names),
        tuple(item.name for item in element.attributes if item.required),
        {name: kind for name, kind in kinds.items() if kind},
        tuple(tuple(line.split()) for line in ALTERNATIVES.get(element.key, ())),
        element.text,
    )


ENTRIES = {key: _entry(element) for key, element in VOICEXML.elements.items()}


def check_tree(root: Node) -> list[Problem]:
    """Give every node its key, take out what is of foreign namespaces, and tell what is wrong.

    A document with an error is not run: who fetches it gets ``error.badfetch`` (5.2.6).
    """
    root.key = "vxml"
    problems = [problem] if (problem := version_problem(root)) else []
    if problem is not None and problem.severity == "error":
        return problems  # of another version, what else seems wrong may be right
    stack = [root]
    while stack:
        node = stack.pop()
        entry = ENTRIES[node.key]
        if node.attributes or entry.required or entry.alternatives:
            _check_attributes(node, entry, problems)
            for names in entry.alternatives:
                _check_alternatives(node, names, problems)
        check = RULES.get(node.key)
        if check is not None:
            check(node, problems)
        if not entry.text and node.content and node.text:
            message = f'<{node.tag}> holds text: "{node.text[:30]}".'
            problems.append(Problem(node.place, "error", "stray-text", message))
        if node.content and node.key not in ("grammar", "metadata"):
            _check_children(node, stack, problems)
    return few(problems, MOST_ALIKE)


def _check_children(node: Node, stack: list[Node], problems: list[Problem]) -> None:
    """Find the children's keys; those that are to be looked at go onto the stack."""
    foreign = False
    for child in node.content:
        if isinstance(child, str):
            continue
        if is_unit(child) and node.key == "form":
            stack.extend(check_items(child, problems))
        elif child.namespace == PRIMA_NAMESPACE:
            _check_command(child, node, problems)
        elif child.namespace == NAMESPACE or (child.tag, child.namespace) == ("grammar", SRGS):
            key = VOICEXML.child(node.key, child.tag)
            if key is None:
                problems.append(_misplaced(child, node))
            else:
                child.key = key
                stack.append(child)
        else:
            foreign = True
            message = f'<{child.tag}> is of another namespace, "{child.namespace}".'
            code = "wrong-namespace"
            problems.append(Problem(child.place, "warning", code, message, "It is ignored."))
    if foreign:
        kept = (NAMESPACE, PRIMA_NAMESPACE, SRGS)
        node.content = [
            one for one in node.content if isinstance(one, str) or one.namespace in kept
        ]


def _misplaced(child: Node, node: Node) -> Problem:
    if child.tag not in VOICEXML.tags:
        message = f"There is no <{child.tag}> in VoiceXML."
        return Problem(child.place, "error", "unknown-element", message, _known_instead(child))
    holder = HOLDERS.get(node.key, f"<{node.tag}>")
    message = f"<{child.tag}> cannot stand in {holder}."
    others = [tag for tag in VOICEXML.parents(child.tag) if tag != node.tag]
    remedy = f"It may stand in {one_of(others)}."
    return Problem(child.place, "error", "misplaced-element", message, remedy)


def _known_instead(child: Node) -> Hint:
    """The element to write instead of one that VoiceXML lacks."""
    habit = HABITS.get(child.tag)
    if isinstance(habit, Instead):
        return renamed(str(habit), child, habit.tag)
    if habit:
        return Hint(habit)
    if child.tag in COMMANDS:
        return Hint(
            f'It is a Command of PRIMA: write <p:{child.tag}>, with xmlns:p="{PRIMA_NAMESPACE}".'
        )
    tag = nearest_word(child.tag, VOICEXML.tags)
    return meant(tag, *(name_spans(child) if tag else ()))


# Attributes -------------------------------------------------------------------------------


def _check_attributes(node: Node, entry: Entry, problems: list[Problem]) -> None:
    for name, text in node.attributes.items():
        if name == "method" and text != text.lower():
            problems.append(_capitals(node, name))
        elif name in entry.kinds:
            if not _fits(entry.kinds[name], text):
                problems.append(_bad_value(node, name, text, entry.kinds[name]))
        elif name not in entry.known and not name.startswith(("xml:", "xsi:", "{")):
            problems.append(_unknown(node, name))
    for name in entry.required:
        if name not in node.attributes and node.key != "vxml":  # told already
            message = f'<{node.tag}> needs the attribute "{name}".'
            hint = added("", node, VOICEXML.attributes[node.key][name][0])
            problems.append(Problem(node.place, "error", "missing-attribute", message, hint))


def _capitals(node: Node, name: str) -> Problem:
    """Words of HTTP in capitals, which other platforms take: they are read as if in small letters."""
    text = node.attributes[name]
    node.attributes[name] = small = text.lower()
    kind = ENTRIES[node.key].kinds[name]
    if not _fits(kind, small):
        return _bad_value(node, name, text, kind)
    message = f'{name} "{text}" is read as "{small}".'
    place = node.attribute_place(name)
    hint = replaced(f'Write "{small}".', small, *value_span(node, name))
    return Problem(place, "warning", "bad-value", message, hint)


_REMEDIES = {
    "rate": 'Write slow, fast or another name of a rate, a number, or a change such as "+10%".',
    "time": 'Write a number with its unit: "500ms" or "2.5s".',
    "integer": "Write a whole number from 1.",
    "share": "Write a number from 0 to 1.",
    "keys": "Write keys, 0 to 9, *, # and A to D, with spaces between or without.",
    "event": 'Write a name such as "order.cancelled".',
    "events": 'Write names such as "order.cancelled", with spaces between.',
    "language": 'Write a language tag such as "en".',
}


def _fits(kind: str, text: str) -> bool:
    if kind == "integer":
        return text.isascii() and text.isdigit() and int(text) > 0
    if kind == "time":
        return _reads("duration", text.strip())
    if kind == "language":
        return not text.strip() or _reads("language", text)
    if kind == "event":
        return _reads("event", text)
    if kind == "events":  # a dot alone, as no name at all, is for all events
        return all(name == "." or _reads("event", name) for name in text.split())
    if kind == "keys":
        return KEYS.fullmatch(text) is not None
    if kind == "share":
        return NUMBER.fullmatch(text.strip()) is not None and 0 <= float(text) <= 1
    if kind == "rate":
        return is_rate(text)
    return text in kind.split()


def _reads(kind: str, text: str) -> bool:
    try:
        read_value(kind, text)
    except ValueError:
        return False
    return True


def _bad_value(node: Node, name: str, text: str, kind: str) -> Problem:
    message = f'{name} "{text}" is not allowed here.'
    hint = Hint(_REMEDIES.get(kind, f"Write {one_of(kind.split())}."))
    if kind == "time" and (right := meant_value("duration", text)):
        hint = replaced(f'Write "{right}".', right, *value_span(node, name))
    return Problem(node.attribute_place(name), "error", "bad-value", message, hint)


def _unknown(node: Node, name: str) -> Problem:
    message = f'<{node.tag}> has no attribute "{name}".'
    place = node.attribute_place(name, value=False)
    hint = suggestion(name, ENTRIES[node.key].known, attribute_span(node, name))
    return Problem(place, "error", "unknown-attribute", message, hint)


def _check_alternatives(node: Node, names: tuple[str, ...], problems: list[Problem]) -> None:
    """Attributes of an element that exclude each other, or none where one is needed."""
    needed = names[-1] == "!"
    names = names[:-1] if needed else names
    given = [name for name in names if name in node.attributes]
    if "content" in names and (node.nodes or node.text):
        given.append("content")
    if len(given) > 1:
        other = "content of its own" if given[1] == "content" else f'"{given[1]}"'
        message = f'<{node.tag}> has both "{given[0]}" and {other}.'
        place = node.place if given[1] == "content" else node.attribute_place(given[1])
        problems.append(Problem(place, "error", "exclusive", message, "Keep one of them."))
    elif needed and not given:
        words = [f'"{name}"' for name in names if name != "content"]
        own = ["content of its own"] if "content" in names else []
        message = f"<{node.tag}> needs {', '.join([*words, *own][:-1])} or {[*words, *own][-1]}."
        problems.append(Problem(node.place, "error", "missing-attribute", message))


# Rules of single elements ---------------------------------------------------------------


def _check_menu(menu: Node, problems: list[Problem]) -> None:
    for choice in menu.all("choice") if menu.get("dtmf") == "true" else ():
        if choice.get("dtmf") and choice.get("dtmf") not in ("*", "#", "0"):
            message = "This menu numbers its choices itself: a choice may add *, # or 0 alone."
            place = choice.attribute_place("dtmf")
            problems.append(Problem(place, "error", "exclusive", message))


def _check_item(item: Node, problems: list[Problem]) -> None:
    for child in item.all("filled", "grammar"):
        for name in ("mode", "namelist") if child.tag == "filled" else ("scope",):
            if name in child.attributes:
                message = f'<{child.tag}> in <{item.tag}> has no "{name}": it is of this item.'
                place = child.attribute_place(name, value=False)
                problems.append(Problem(place, "error", "unknown-attribute", message))


def _check_form(form: Node, problems: list[Problem]) -> None:
    items = [one for one in parts_of(form) if one.tag in FORM_ITEMS or is_unit(one)]
    items = [node for node in items if node.get("name")]
    counts = Counter(node.get("name") for node in items)
    for node in items:
        if counts[node.get("name")] > 1:
            counts[node.get("name")] = 0
            message = f'Two items of the form have the name "{node.get("name")}".'
            place = node.attribute_place("name")
            problems.append(Problem(place, "error", "duplicate-name", message))
    inputs = {node.get("name") for node in items if node.tag in INPUT_ITEMS}
    for filled in form.all("filled"):
        for name in filled.get("namelist").split():
            if name not in inputs:
                message = f'The form has no input item "{name}".'
                hint = suggestion(name, inputs, *value_span(filled, "namelist", name))
                place = filled.attribute_place("namelist")
                problems.append(Problem(place, "error", "no-such-item", message, hint))


def _check_if(node: Node, problems: list[Problem]) -> None:
    branches = node.all("else", "elseif")
    for before, branch in pairwise(branches):
        if before.tag == "else":
            message = f"<{branch.tag}> stands after <else>."
            problems.append(Problem(branch.place, "error", "after-else", message))


def _check_say_as(node: Node, problems: list[Problem]) -> None:
    """What it is has to be told; older documents do by ``type`` (4.1.1)."""
    if not {"interpret-as", "type"} & node.attributes.keys():
        message = '<say-as> needs the attribute "interpret-as".'
        hint = added("", node, VOICEXML.attributes[node.key]["interpret-as"][0])
        problems.append(Problem(node.place, "error", "missing-attribute", message, hint))


RULES: dict[str, Callable[[Node, list[Problem]], None]] = {
    "form": _check_form,
    "menu": _check_menu,
    "if": _check_if,
    "say-as": _check_say_as,
    **dict.fromkeys(INPUT_ITEMS, _check_item),
}
"""What holds between an element and its children."""


def _check_command(node: Node, parent: Node, problems: list[Problem]) -> None:
    if node.tag not in (*COMMANDS, *ARRANGING):
        known = [*COMMANDS, *ARRANGING]
        message = f"PRIMA has no Command <{node.tag}>."
        hint = suggestion(node.tag, known, *name_spans(node))
        problems.append(Problem(node.place, "error", "unknown-element", message, hint))
        return
    if parent.key not in HOLDING and VOICEXML.child(parent.key, "assign") is None:
        message = f"A Command cannot stand in <{parent.tag}>."
        if node.tag in ARRANGING:
            message = f"<p:{node.tag}> cannot stand in <{parent.tag}>: it is around Commands."
        remedy = "It may stand in a prompt or among executable content."
        if node.tag == "iu":
            message = f"<p:iu> cannot stand in <{parent.tag}>."
            remedy = "It stands around Commands in content, or around the items of a <form>."
        problems.append(Problem(node.place, "error", "misplaced-element", message, remedy))
    if node.tag in ARRANGING:
        for command in check_arranged(node, problems):
            _check_arguments(command, problems)
    else:
        _check_arguments(node, problems)


def _check_arguments(node: Node, problems: list[Problem]) -> None:
    row = TABLE_4_2.get(node.tag)
    known = set(row.arguments) if row is not None else {"type"}
    for name in node.attributes:
        if name.removesuffix("-expr") not in known and not name.startswith(("xml:", "{")):
            message = f'<{node.tag}> has no attribute "{name}".'
            place = node.attribute_place(name, value=False)
            hint = suggestion(name, known, attribute_span(node, name))
            problems.append(Problem(place, "error", "unknown-attribute", message, hint))


# What is no error until it is reached -----------------------------------------------------


def check_code(root: Node, dialogs: set[str]) -> list[Problem]:
    """Warnings for expressions that do not compile and for dialogs that are not there.

    Only validation asks for them: a run is told of what it reaches, as an event.
    """
    problems: list[Problem] = []
    codes = [(node, name, code) for node in root.walk() for name, code in _codes(node)]
    if len(codes) > 1:
        with suppress(ScriptError):  # who asks for one of them is told that it cannot be started
            syntax().look_ahead((code, not name) for _, name, code in codes)
    checker = syntax()
    for node, name, code in codes:
        _compile(node, name, code, problems, checker)
    for node in root.walk():
        if node.key == "grammar" and not {"src", "srcexpr"} & node.attributes.keys():
            problems += grammar_problems(node, root.get("xml:lang", "en"))
        if node.key == "field" and node.get("type"):
            problems += _type_problems(node)
        naming = NAMING.get(node.key, "")
        if node.get(naming):
            problems += _name_problems(node, naming)
        problems += _value_problems(node)
        if node.namespace == PRIMA_NAMESPACE and node.tag in TABLE_4_2:
            problems += _command_problems(node, TABLE_4_2[node.tag])
        if node.key == "property":
            problems += _property_problems(node)
        if node.key == "script" and node.own_text.strip():
            problems += _script_problems(node)
        for name in ("next", "src"):
            target = node.get(name)
            if target.startswith("#") and node.key != "grammar" and target[1:] not in dialogs:
                message = f'There is no dialog "{target[1:]}" here: this will be error.badfetch.'
                hint = suggestion(target[1:], dialogs, *value_span(node, name, target[1:]))
                place = node.attribute_place(name)
                problems.append(Problem(place, "warning", "no-such-form", message, hint))
    return problems


def is_code(node: Node, attribute: str) -> bool:
    """Whether an attribute holds ECMAScript: VoiceXML's own, or one of PRIMA's elements."""
    if node.namespace == NAMESPACE:
        return attribute in EXPRESSIONS
    own = attribute.endswith("-expr") or (node.key == UNIT and attribute == "cond")
    return node.namespace == PRIMA_NAMESPACE and own


HIDING = {
    "session": "the session variables, which are read-only",
    **{name: f"the variables of the {name}" for name in sorted(SCOPES)},
}
"""Names that variables should not have, and what cannot be reached any more if one does (5.1.2)."""
SOMETIMES = frozenset(["async", "await", "let", "of", "static", "yield"])
"""Words that are names, too, in the ECMAScript of documents."""
NAMING = {
    **dict.fromkeys([*FORM_ITEMS, UNIT, "var", "data"], "name"),
    **dict.fromkeys(["foreach", "said-foreach"], "item"),
}
"""Elements that have a variable, and the attribute that names it."""


def _script_problems(script: Node) -> Iterator[Problem]:
    """Variables of a script that hide the platform's scopes (5.1.2)."""
    told: set[str] = set()
    for use in script_names(script.own_text).uses:
        if use.declares and not use.holder and use.name in HIDING.keys() - told:
            told.add(use.name)
            place = script.source.inside(script.index, "", use.start)
            yield _hidden(place, use.name)


def _hidden(place: Place, name: str) -> Problem:
    message = f'The variable "{name}" hides {HIDING[name]}.'
    return Problem(place, "warning", "bad-value", message, "Write another name.")


def _name_problems(node: Node, attribute: str) -> list[Problem]:
    """A variable that no expression can name, or whose name is the platform's (5.1.1)."""
    name = node.get(attribute)
    if name in HIDING:
        return [_hidden(node.attribute_place(attribute), name)]
    remedy = "Write letters, digits and _, and no word that ECMAScript has for itself."
    if not IDENTIFIER.fullmatch(name) or name in RESERVED - SOMETIMES:
        message = f'"{name}" is no name of ECMAScript: no expression can read it.'
    elif name.startswith("_") or name[1:].endswith("$"):  # $ alone is no shadow variable
        message = (
            f'"{name}" is reserved: names that begin with _ or end with $ are the platform\'s.'
        )
        remedy = "Write another name."
    else:
        return []
    return [Problem(node.attribute_place(attribute), "warning", "bad-value", message, remedy)]


LATER_VALUES = {
    "choice": {"dtmf": "keys", "event": "event"},
    "link": {"dtmf": "keys", "event": "event"},
    "option": {"dtmf": "keys"},
    "throw": {"event": "event"},
    "return": {"event": "event"},
    "catch": {"event": "events"},
}
"""Keys that nobody can press, and events that nothing throws or takes."""


def _value_problems(node: Node) -> list[Problem]:
    """Values that do nothing, though they are no error when they are reached."""
    return [
        _bad_value(node, name, node.get(name), kind)._replace(severity="warning")
        for name, kind in LATER_VALUES.get(node.key, {}).items()
        if name in node.attributes and not _fits(kind, node.get(name))
    ]


PROPERTIES = {
    **dict.fromkeys(
        [
            *("timeout", "interdigittimeout", "termtimeout", "completetimeout", "fetchtimeout"),
            *("incompletetimeout", "maxspeechtimeout", "fetchaudiodelay", "fetchaudiominimum"),
        ],
        "time",
    ),
    **dict.fromkeys(["confidencelevel", "sensitivity", "speedvsaccuracy"], "share"),
    "bargein": "true false",
    "bargeintype": "speech hotword",
    "maxnbest": "integer",
}
"""What properties of the Recommendation hold (6.3)."""


def _property_problems(node: Node) -> list[Problem]:
    """A property whose value is none: the default counts (6.3)."""
    kind = PROPERTIES.get(node.get("name"))
    if kind is None or _fits(kind, node.get("value")):
        return []
    problem = _bad_value(node, "value", node.get("value"), kind)
    message = f'{node.get("name")} "{node.get("value")[:40]}" is not allowed.'
    return [problem._replace(severity="warning", message=message)]


def _type_problems(field: Node) -> list[Problem]:
    """A built-in type that is none: the field throws error.unsupported.builtin (2.3.1)."""
    from prima.grammar.builtin import TYPES, Conflict, built_in

    kind = field.get("type")
    try:
        built_in(kind, "voice", "en")
    except Conflict as error:
        remedy = "At run time it is error.badfetch."
        place = field.attribute_place("type")
        return [Problem(place, "warning", "exclusive", str(error), remedy)]
    except ValueError as error:
        hint = suggestion(kind, TYPES, *value_span(field, "type"))
        hint = hint or Hint(f"Write {one_of(TYPES)}, or a <grammar>.")
        hint = hint._replace(text=f"{hint.text} At run time it is error.unsupported.builtin.")
        place = field.attribute_place("type")
        return [Problem(place, "warning", "no-such-name", str(error), hint)]
    return []


def grammar_problems(
    node: Node, lang: str, base: str = "", fetch: Callable[[str], bytes] | None = None
) -> list[Problem]:
    """What is wrong with a ``<grammar>``; without ``fetch`` it is read as far as it stands there."""
    from prima.grammar import GrammarError, load

    mode: Literal["dtmf", "voice"] = "dtmf" if node.get("mode") == "dtmf" else "voice"
    lang = node.get("xml:lang", lang)
    try:
        return load(node, base=base, lang=lang, mode=mode, fetch=fetch, lenient=True).warnings()
    except GrammarError as error:
        return [
            problem._replace(severity="warning", remedy=f"{problem.remedy} {LATER}".strip())
            for problem in error.problems
            if problem.code != "not-fetched"
        ]


LATER = "When it is to listen, this will be error.badfetch or error.unsupported."


def _statements(node: Node, name: str) -> Problem:
    """An expression that is a script: other platforms take it, and so does this one."""
    message = f"{name} holds several statements: the value of the last counts."
    remedy = "Write one expression."
    if not node.get(name).strip():
        message, remedy = f"{name} is empty: its value is undefined.", "Write an expression."
    return Problem(node.attribute_place(name), "warning", "bad-expression", message, remedy)


def _codes(node: Node) -> Iterator[tuple[str, str]]:
    """The code of an element that an engine has to look at, with its attribute; none for a script."""
    for name in node.attributes:
        if is_code(node, name) and compiled(node.get(name)) is None:
            yield name, node.get(name)
    if node.key == "script" and node.own_text.strip():
        yield "", node.own_text


def _compile(
    node: Node, name: str, code: str, problems: list[Problem], checker: IsolatedSyntax
) -> None:
    try:
        (checker.expression if name else checker.script)(code)
    except ScriptError as error:
        if name not in ("", "cond") and checker.has_statements(code):
            problems.append(_statements(node, name))
            return
        place = node.code_place(name, error.line, error.column)
        code = " ".join(code.split())[:60]
        message = f'"{code}" is not ECMAScript: {error}. This will be error.semantic.'
        if isinstance(error, EngineLost):
            message = f'"{code}" cannot be checked: {error}.'
        problems.append(Problem(place, "warning", "bad-expression", message))


# What a robot makes of it -----------------------------------------------------------------


def check_commands(root: Node, commands: Mapping[str, CommandType]) -> list[Problem]:
    """Warnings for Commands that a robot adds or lacks: at run time they are events."""
    problems: list[Problem] = []
    for node in root.walk():
        if node.namespace != PRIMA_NAMESPACE or node.tag != "command" or not node.get("type"):
            continue
        row = commands.get(node.get("type"))
        if row is None:
            message = f'This robot has no Command "{node.get("type")}".'
            hint = suggestion(node.get("type"), commands, *value_span(node, "type"))
            place = node.attribute_place("type")
            problems.append(Problem(place, "warning", "unsupported-command", message, hint))
        else:
            problems += _command_problems(node, row)
    return problems


def _command_problems(node: Node, row: CommandType) -> list[Problem]:
    """Arguments and texts for which a Command is an event when it is asked for."""
    given: dict[str, str | None] = {}
    for name, text in node.attributes.items():
        bare = name.removesuffix("-expr")
        if bare in row.arguments and node.tag != "command":
            given[bare] = text if bare == name else None
    given |= {one.get("name"): one.attributes.get("value") for one in node.all("param")}
    says = bool(node.own_text.strip() or node.all("value"))
    found = [
        one._replace(severity="warning", remedy=one.remedy.replace("<speak>", "<p:speak>"))
        for one in given_to(node, row, given, says)
    ]
    if excluding := excluding_arguments(row, given):
        found.append(_warned(node, "exclusive", excluding, "Keep one of them."))
    for name in row.arguments:
        if {name, f"{name}-expr"} <= node.attributes.keys():
            message = f'<p:{node.tag}> has both "{name}" and "{name}-expr".'
            found.append(_warned(node, "exclusive", message, "Keep one of them."))
    if row.text == "required" and not says and not node.nodes:
        message = f"<p:{node.tag}> has nothing to say."
        found.append(_warned(node, "nothing-to-say", message, "Write its text inside it."))
    return found


def _warned(node: Node, code: str, message: str, remedy: str) -> Problem:
    return Problem(node.place, "warning", code, message, remedy)
