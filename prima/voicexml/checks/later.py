"""Errors only if executed: a run reports them as events when it reaches them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Literal

from prima.errors import Hint, Problem, meant, nearest_word, one_of, suggestion
from prima.errors.diagnoses.grammars import NO_ROOT
from prima.errors.diagnoses.names import BAD_EXPRESSION, NO_SUCH_FORM, NO_SUCH_ITEM, NO_SUCH_NAME
from prima.errors.diagnoses.structure import MISSING_ATTRIBUTE
from prima.errors.diagnoses.values import ASKED_LATER, BAD_VALUE, EXCLUSIVE
from prima.interpreter.acts import type_of
from prima.interpreter.deadcontent import dead_content
from prima.interpreter.steps import no_step
from prima.language.commands import TABLE_4_2
from prima.markup.spans import instead, value_span
from prima.markup.tree import Node
from prima.markup.uris import parted
from prima.messages import SERVICE
from prima.script.compile import compiled
from prima.script.evaluation import EngineLost, ScriptError
from prima.script.shared import IsolatedSyntax, syntax
from prima.script.slips import code_remedy
from prima.voicexml.arranging import UNIT, items_in, parts_of
from prima.voicexml.checks.attributes import bad_value, fits, instead_of
from prima.voicexml.checks.conditions import check_conditions
from prima.voicexml.checks.failing import check_failing
from prima.voicexml.checks.guests import command_problems
from prima.voicexml.checks.names import check_assigned, check_listed, check_name, check_script_names
from prima.voicexml.elements import ITEMS, handler_number
from prima.voicexml.platform import listens_in
from prima.voicexml.vocabulary import (
    EXPRESSIONS,
    FETCHED_VALUES,
    NAMESPACE,
    PRIMA_NAMESPACE,
    PROPERTIES,
    PROPERTY_NAMES,
)

LATER = "When it is to listen, this will be error.badfetch or error.unsupported."
ASKING = ("field", "initial", "record", "menu")
"""Elements that ask by their prompts."""
LONGEST_CODE, LONGEST_VALUE = 60, 40
"""Characters of code and of a property's value that a message quotes."""
LATER_VALUES = {
    "choice": {"dtmf": "keys", "event": "event"},
    "link": {"dtmf": "keys", "event": "event"},
    "option": {"dtmf": "keys"},
    "throw": {"event": "event"},
    "return": {"event": "event"},
    "catch": {"event": "events"},
    "form": {"id": "name"},
    "menu": {"id": "name"},
    "phoneme": {"alphabet": "alphabet"},
    "prosody": {"pitch": "pitch", "range": "pitch", "contour": "contour", "volume": "volume"},
    "voice": {"age": "number", "variant": "integer"},
}
"""Impossible keys, events that nothing throws or takes, and speech that no voice can produce."""
NO_EFFECT = MISSING_ATTRIBUTE.says(
    "<{tag}> without an attribute changes nothing.", "Add one, or remove the element.", "warning"
)
NO_URI = BAD_VALUE.says(
    "{name} is empty: this will be error.badfetch.", "Write a URI.", severity="warning"
)
NO_DIALOG = NO_SUCH_FORM.says(
    'There is no dialog "{name}" here: this will be error.badfetch.',
    'Name another, or add <form id="{name}">.',
    "warning",
)
NO_ITEM = NO_SUCH_ITEM.says(
    'This {tag} has no item "{name}" to go to: this will be error.badfetch.',
    "Name another item.",
    "warning",
)
ROOTLESS = NO_ROOT.says(
    "This grammar names no root rule: when it is to listen, this will be error.badfetch.",
    'Write root="NAME"; in the ABNF form, "root $NAME;".',
    "warning",
)
NO_PROPERTY = BAD_VALUE.says(
    'There is no property "{name}" in VoiceXML: it has no effect.', "Remove it.", "warning"
)
BAD_PROPERTY = BAD_VALUE.says('{name} "{value}" is not allowed.', severity="warning")
TWO_MEANINGS = EXCLUSIVE.says("{wrong}", "At run time it is error.badfetch.", "warning")
UNKNOWN_TYPE = NO_SUCH_NAME.says("{wrong}", severity="warning")
STATEMENTS = BAD_EXPRESSION.says(
    "{name} holds several statements: the value of the last counts.",
    "Write one expression.",
    "warning",
)
EMPTY = BAD_EXPRESSION.says(
    "{name} is empty: its value is undefined.", "Write an expression.", "warning"
)
NOT_ECMASCRIPT = BAD_EXPRESSION.says(
    '"{code}" is not ECMAScript: {error}. This will be error.semantic.', severity="warning"
)
NOT_CHECKED = BAD_EXPRESSION.says('"{code}" cannot be checked: {error}.', severity="warning")

ALIKE = 0.85
"""The similarity from which a name is a slip: vendors' own properties are less like these."""


def check_code(root: Node, dialogs: set[str]) -> list[Problem]:
    """Warnings for expressions that do not compile, for dialogs that are not there, and the like.

    Only validation uses this: a run reports what it reaches, as an event.
    """
    problems = list(_all_compiled(root))
    lang = root.get("xml:lang", "en")
    for node in root.walk():
        problems += _check_node(node, lang)
        problems += _targets(node, dialogs)
    for dialog in root.all("form", "menu"):
        problems += _items(dialog, dialogs)
    problems += dead_content(root, texts=True)
    return [*problems, *check_conditions(root), *check_failing(root), *_first_prompt(root)]


def _check_node(node: Node, lang: str) -> Iterator[Problem]:
    if node.key == "grammar" and "src" not in node.attributes:
        yield from grammar_problems(node, lang)
    yield from _type_problems(node)
    if node.key in ("prosody", "voice") and not node.attributes:
        yield NO_EFFECT.at(node.place, tag=node.tag)  # SSML 1.0, 3.2.1 and 3.2.4
    yield from check_name(node)
    yield from _value_problems(node)
    if node.namespace == PRIMA_NAMESPACE and type_of(node) in TABLE_4_2:
        yield from command_problems(node, TABLE_4_2[type_of(node)])
    if node.key == "property":
        yield from _property_problems(node)
    if node.key == "assign":
        yield from (*no_step(node), *check_assigned(node))
    if node.key != "filled":  # its names are checked elsewhere
        yield from check_listed(node)
    if node.key == "script" and node.own_text.strip():
        yield from check_script_names(node)


def _targets(node: Node, dialogs: set[str]) -> Iterator[Problem]:
    for attribute in ("next", "src"):
        target = node.get(attribute)
        name = parted(target)[1]
        here = target.startswith("#") and node.key != "grammar"
        sent = target.startswith(SERVICE) and node.key == "submit" and name != ""
        if attribute in node.attributes and not target.strip() and node.key != "audio":
            yield NO_URI.at(node.attribute_place(attribute), name=attribute)
        if dialogs and (here or sent) and name not in dialogs:
            written = target.partition("#")[2]
            hint = suggestion(name, dialogs, *value_span(node, attribute, written))
            yield NO_DIALOG.at(node.attribute_place(attribute), hint, name=name)


def _items(dialog: Node, dialogs: set[str]) -> Iterator[Problem]:
    """Form items to which a dialog's content goes, and that it lacks (5.3.7)."""
    names = {one.get("name") for one in items_in(dialog)} - {""}
    for node in dialog.walk():
        name = node.get("nextitem")
        if node.key != "goto" or "nextitem" not in node.attributes or name in names:
            continue
        hint = suggestion(name, names, *value_span(node, "nextitem"))
        if name in dialogs:
            remedy = f'It is a dialog: write next="#{name}".'
            hint = instead(remedy, node, "nextitem", "next", f"#{name}")
        yield NO_ITEM.at(node.attribute_place("nextitem"), hint, tag=dialog.tag, name=name)


def _first_prompt(root: Node) -> Iterator[Problem]:
    """A question with which a document begins, and whose prompts all come later (4.1.6)."""
    first = _first_item(root)
    if first is None or first.tag not in ASKING or {"cond", "expr"} & first.attributes.keys():
        return
    speech = first.all("prompt", "audio", "value", "enumerate")
    prompt = min(speech, key=handler_number, default=None)
    if prompt is not None and not first.text and handler_number(prompt) > 1:
        yield ASKED_LATER.at(prompt.attribute_place("count"), count=handler_number(prompt))


def _first_item(root: Node) -> Node | None:
    """The item with which a document begins; a menu is one."""
    dialog = next(iter(root.all("form", "menu")), None)
    if dialog is None or dialog.tag == "menu":
        return dialog
    return next((one for one in parts_of(dialog) if one.tag in ITEMS), None)


def is_code(node: Node, attribute: str) -> bool:
    """Whether an attribute holds ECMAScript: VoiceXML's own, or one of PRIMA's elements."""
    if node.namespace == NAMESPACE:
        return attribute in EXPRESSIONS
    own = attribute.endswith("-expr") or (node.key == UNIT and attribute == "cond")
    return node.namespace == PRIMA_NAMESPACE and own


def _value_problems(node: Node) -> list[Problem]:
    """Values without effect that are not errors when reached."""
    return [
        bad_value(node, name, node.get(name), kind)._replace(severity="warning")
        for name, kind in {**FETCHED_VALUES, **LATER_VALUES.get(node.key, {})}.items()
        if name in node.attributes and not fits(kind, node.get(name).strip())
    ]


def _property_problems(node: Node) -> Iterator[Problem]:
    """A property without a value of its kind, or most likely misspelt: the default counts (6.3)."""
    name, value = node.get("name"), node.get("value")
    place = node.attribute_place("name")
    if name not in PROPERTY_NAMES and (near := nearest_word(name, PROPERTY_NAMES, ALIKE)):
        yield NO_PROPERTY.at(place, meant(near, *value_span(node, "name")), name=name)
    kind = PROPERTIES.get(name)
    if kind is not None and not fits(kind, value):
        hint = instead_of(node, "value", value, kind)
        place = node.attribute_place("value")
        yield BAD_PROPERTY.at(place, hint, name=name, value=value[:LONGEST_VALUE])


def _type_problems(node: Node) -> Iterator[Problem]:
    """An unknown built-in type: the field throws error.unsupported.builtin (2.3.1)."""
    from prima.grammar.builtin import Conflict, WrongParameter, built_in

    attribute = "type" if node.key == "field" else "src"
    kind = node.get("type") if node.key == "field" else node.get("src").strip()
    place = node.attribute_place(attribute)
    if not kind or (node.key != "field" and not kind.startswith("builtin:")):
        return
    try:
        built_in(kind, "en")
    except Conflict as error:
        yield TWO_MEANINGS.at(place, wrong=error)
    except ValueError as error:
        wrong = error.remedy if isinstance(error, WrongParameter) else ""
        hint = Hint(wrong) or _other_type(node, attribute, kind)
        text = f"{hint.text} At run time it is error.unsupported.builtin."
        yield UNKNOWN_TYPE.at(place, hint._replace(text=text), wrong=error)


def _other_type(node: Node, attribute: str, kind: str) -> Hint:
    """The built-in type that a wrong one most likely means, or all of them."""
    from prima.grammar.builtin import TYPES

    name = kind.partition("?")[0].rpartition("/")[2]
    spans = value_span(node, attribute, name)
    hint = suggestion(name, TYPES, *spans) if name not in TYPES else Hint()
    return hint or Hint(
        f"Write {one_of(TYPES)}{', or a <grammar>' if attribute == 'type' else ''}."
    )


def grammar_problems(
    node: Node, lang: str, base: str = "", fetch: Callable[[str], bytes] | None = None
) -> list[Problem]:
    """The problems of a ``<grammar>``; without ``fetch``, files that it names are not read.

    Of a grammar with ``srcexpr`` only the type is known before it listens.
    """
    from prima.grammar import GrammarError, load
    from prima.grammar.media import check_known, media_type

    mode: Literal["dtmf", "voice"] = "dtmf" if node.get("mode") == "dtmf" else "voice"
    lang = node.get("xml:lang", lang)
    try:
        if "srcexpr" in node.attributes:
            check_known(media_type(node.get("type")), node.attribute_place("type"), "")
            return []
        made = load(
            node, base=base, lang=lang, mode=mode, fetch=fetch, languages=listens_in, lenient=True
        )
        return made.warnings() + ([] if made.root else [ROOTLESS.at(node.place)])
    except GrammarError as error:
        return [
            problem._replace(severity="warning", remedy=f"{problem.remedy} {LATER}".strip())
            for problem in error.problems
            if problem.code != "not-fetched"
        ]


# Code -------------------------------------------------------------------------------------


def _all_compiled(root: Node) -> Iterator[Problem]:
    codes = [(node, name, code) for node in root.walk() for name, code in _codes(node)]
    if len(codes) > 1:
        with suppress(ScriptError):  # the check of each piece reports that there is no engine
            syntax().look_ahead((code, not name) for _, name, code in codes)
    checker = syntax()
    for node, name, code in codes:
        yield from _compile(node, name, code, checker)


def _codes(node: Node) -> Iterator[tuple[str, str]]:
    """The code of an element that an engine must check, with its attribute (none for a script)."""
    for name in node.attributes:
        if is_code(node, name) and compiled(node.get(name)) is None:
            yield name, node.get(name)
    if node.key == "script" and node.own_text.strip():
        yield "", node.own_text


def _compile(node: Node, name: str, code: str, checker: IsolatedSyntax) -> Iterator[Problem]:
    try:
        (checker.expression if name else checker.script)(code)
    except ScriptError as error:
        if name not in ("", "cond") and checker.has_statements(code):
            # It is a script: accepted here as on other platforms.
            diagnosis = STATEMENTS if code.strip() else EMPTY
            yield diagnosis.at(node.attribute_place(name), name=name)
            return
        place = node.code_place(name, error.line, error.column)
        diagnosis = NOT_CHECKED if isinstance(error, EngineLost) else NOT_ECMASCRIPT
        remedy = code_remedy(code, error, statements=not name, text=name != "cond")
        shown = " ".join(code.split())[:LONGEST_CODE]
        yield diagnosis.at(place, Hint(remedy), code=shown, error=error)
