"""Hints for authors: the values and elements most likely meant."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable, Sequence

from prima.errors import nearest_word, one_of, with_article
from prima.language.values import DRAWABLE, read_value
from prima.markup.tree import Node
from prima.markup.vocabulary import Vocabulary

UNITS = {
    **dict.fromkeys(("sec", "secs", "second", "seconds"), 1000),
    **dict.fromkeys(("m", "min", "mins", "minute", "minutes"), 60_000),
    **dict.fromkeys(("h", "hour", "hours"), 3_600_000),
    **dict.fromkeys(("msec", "msecs", "millisecond", "milliseconds"), 1),
    "S": 1000,
    "MS": 1,
}
"""Units of time that documents do not support, in ms."""
# Compiled on first use: most documents have no mistakes.
MEASURE = r"\s*([0-9]+(?:[.,][0-9]+)?|[.,][0-9]+)\s*([A-Za-z]*)\s*"
NUMBER = r"\s*([+-]?(?:[0-9]+(?:[.,][0-9]+)?|[.,][0-9]+))\s*[A-Za-z/°%]*[²2]?\s*"
TRUTHS = {"yes": "true", "1": "true", "on": "true", "no": "false", "0": "false", "off": "false"}
LONG = 100
"""Length of a value above which no guess is made."""
INSIDE = {
    "field": "Write it into a <prompt>.",
    "when": "Write it into a <say>.",
    "reply": 'Write <data name="..." value="..."/>.',
    **dict.fromkeys(("expect", "never"), 'Write it as says="..." or logs="...".'),
    "data": 'Write it as value="...".',
    "form": "Say it with <speak> in a <block>.",
    "prima": "Say it with <speak> in a <block> of a <form>.",
    "value": 'Write an expression: <value expr="..."/>.',
    "goto": "Remove it; the tag ends with />.",
    "one-of": "Write it into an <item>.",
    "link": "Write it into a <grammar>.",
    **dict.fromkeys(
        ("var", "assign"), 'Write it as expr="..."; a text in it has quotes of its own.'
    ),
    **dict.fromkeys(("param", "property"), 'Write it as value="...".'),
    "failure": 'Write it as reason="...".',
    "walk": 'Write it as to="...".',
}
"""Where text directly in an element belongs."""
IN_SCENARIOS = ("when", "reply", "data", "expect", "never", "failure", "walk")
"""Those of them that scenarios have."""
INSTEAD = {
    "prompt": "Write <speak>; a <prompt> is what a <field> asks.",
    "option": "It is an answer that a <field> takes.",
}
"""Remedies for elements that make no sense in their place."""
ASKED = (
    "Write <prompt>: what the field asks. What is said before it belongs in a <block> before it."
)
"""The remedy for speech in a question."""
OTHERS = {
    ("active-sensing-human", "timeout"): 'Write patience="...".',
    ("answer", "delay"): 'Write after="...".',
    ("failure", "delay"): 'Write after="...".',
    ("field", "bargein"): 'Write it at the <prompt>: <prompt bargein="...">.',
    ("field", "timeout"): 'Write it at the <prompt>: <prompt timeout="...">.',
    ("goto", "form"): 'Write next="#...": a form.',
    ("goto", "to"): 'Write next="#...": a form.',
    ("point-by-hand", "to"): 'Write toward="...".',
    ("reply", "delay"): 'Write after="...".',
    ("send", "service"): 'Write to="...": a service.',
    ("set-direction", "to"): 'Write toward="...".',
    ("turn-and-speak", "to"): 'Write toward="...".',
    ("var", "value"): 'Write expr="...": a text in it has quotes of its own.',
    ("when", "event"): 'Write on="...".',
    ("when", "time"): 'Write at="...".',
}
"""Attributes that authors give to elements, with what belongs there."""
MOVED = {
    **{
        (tag, name): 'Put it into an <if cond="...">.'
        for tag in ("assign", "exit", "goto", "reprompt", "return", "send", "speak", "throw")
        for name in ("cond", "if", "when")
    },
    **{
        (tag, name): f'Write what is compared inside: <data name="{name}" value="..."/>.'
        for tag in ("expect", "never")
        for name in ("to", "name", "angle", "toward")
    },
    ("filled", "cond"): 'Put an <if cond="..."> into it.',
    ("grammar", "type"): 'A type of answers belongs to the field: <field type="...">.',
    ("script", "src"): "Write the code into the <script>.",
}
"""Attributes that authors give to elements, with the other element that has what they mean."""
CHOICES = {
    **dict.fromkeys(("string", "str", "any", "open"), "text"),
    **dict.fromkeys(("yesno", "yes-no", "bool"), "boolean"),
    **dict.fromkeys(("integer", "int", "float"), "number"),
}
"""Values of other languages, with those that are meant."""
TEXTS = ("text", "value", "say", "content", "message", "name")
"""Attributes that authors give to elements whose text belongs inside."""
REMOVE = "Remove it."
OWN_NAMESPACE = "Write it without a namespace of its own: remove its xmlns or its prefix."
SIGNS = r"""[$\[{*+]|\w\(|\A\s*['"]"""
"""What an expression has, and hardly a name or a number."""
WRAPPED = r"\$?\{+([^{}]+)\}+|\$(\w+)"
"""An expression with signs around it that templates of other languages have."""


def other_attribute(tag: str, name: str) -> str:
    """The remedy for an attribute that another one, or another element, has."""
    return OTHERS.get((tag, name)) or MOVED.get((tag, name), "")


def inside(node: Node, name: str, values: bool) -> str:
    """The remedy for an attribute in place of the content of an element that holds text.

    ``values`` is whether it may hold a ``<value>``.
    """
    if name == "expr" and values:
        return 'Write it inside: <value expr="..."/>.'
    if name in TEXTS and not node.text:
        return f"Write the text inside: <{node.tag}>...</{node.tag}>."
    return ""


def expression(text: str) -> str:
    """The expression that is written in place of a value; nothing if it does not look like one."""
    if len(text) > LONG or not re.search(SIGNS, text):
        return ""
    wrapped = re.fullmatch(WRAPPED, text.strip())
    code = (wrapped[1] or wrapped[2]) if wrapped else text
    return code.strip().replace('"', "'")


def meant_choice(text: str, choices: Collection[str]) -> str:
    """The allowed value that another most likely means, or nothing."""
    other = CHOICES.get(text.lower(), "")
    return other if other in choices else nearest_word(text, choices)


def half(text: str) -> str:
    """Text converted to half-width characters."""
    straight = re.sub("[“”„«»]", '"', text)
    return unicodedata.normalize("NFKC", re.sub("[‘’‚]", "'", straight))


def meant_value(kind: str, text: str, usual: str = "") -> str:
    """The value of a kind that a wrong text most likely means, or nothing.

    ``usual`` is the default, if any: it distinguishes seconds from milliseconds.
    """
    if len(text) > LONG:
        return ""
    for guess in (half(text), _guess(kind, half(text), usual)):
        try:
            if guess and guess != text:
                read_value(kind, guess)
                return guess
        except ValueError:
            continue
    return ""


LONG_SECONDS = 100
"""The number from which a time without a unit most likely means milliseconds, unless so many
seconds are usual."""


def _guess(kind: str, text: str, usual: str) -> str:
    kind = DRAWABLE.get(kind, kind)
    if kind == "duration" and (match := re.fullmatch(MEASURE, text)):
        number, unit = match[1].replace(",", "."), match[2]
        if unit in ("", "s", "ms"):
            long = re.fullmatch(r"\d{3,}s", usual)
            return f"{number}{unit or ('s' if long or float(number) < LONG_SECONDS else 'ms')}"
        return f"{float(number) * UNITS[unit] / 1000:g}s" if unit in UNITS else ""
    if kind in ("number", "integer") and (match := re.fullmatch(NUMBER, text)):
        return match[1].replace(",", ".")
    return _guess_word(kind, text.strip())


def _guess_word(kind: str, text: str) -> str:
    if kind == "boolean":
        return TRUTHS.get(text.lower(), text.lower())
    if kind in ("event", "events"):
        return re.sub(r"\s*,\s*", " ", text)
    return text.removeprefix("#") if kind == "id" else ""


def text_remedy(node: Node, spoken: bool, missing: str) -> str:
    """Where text that an element may not contain belongs.

    ``spoken`` is whether it is in an application, ``missing`` the only attribute that the element
    lacks, if it takes no speech.
    """
    if node.tag in INSIDE and (spoken or node.tag in IN_SCENARIOS):
        return INSIDE[node.tag]
    if missing:
        return f'Write it as {missing}="...".'
    return "Say it with <speak>, or remove it." if spoken else REMOVE


PAUSES = {
    "break": 'Between Commands write <pause time="1s"/>; a <break> is a pause inside a text.',
    "pause": 'Inside a text write <break time="1s"/>; a <pause> goes between Commands.',
}
"""The two kinds of pauses, each where the other belongs."""


FEW = 8
"""Maximum number of elements that are listed."""


def held(parent: Node, inside: Collection[str]) -> str:
    """What an element may hold instead of an unknown one, if that is little."""
    if len(inside) > FEW:
        return REMOVE
    few = one_of(f"<{tag}>" for tag in inside)
    return f"<{parent.tag}> may hold {few}." if few else f"<{parent.tag}> holds no elements."


def allowed_in(parents: Iterable[str]) -> str:
    """The remedy for an element that may only be elsewhere; a root element has no parents."""
    listed = one_of(parents)
    return (
        f"It is allowed in {listed}." if listed else "It begins a document: give it its own file."
    )


def inside_itself(tag: str) -> str:
    """The remedy for an element inside another of its name, which is most likely unclosed."""
    return f"Close the first <{tag}> before this one."


def put_into(tag: str, parent: Node, vocabulary: Vocabulary, usual: Sequence[str]) -> str:
    """The remedy for an element that belongs into another one, allowed in its parent.

    Of several that could contain it, this is the first of the usual ones, or none.
    """
    inside = [
        one
        for one, key in vocabulary.children(parent.key).items()
        if tag in vocabulary.children(key)
    ]
    alone = inside[0] if len(inside) == 1 else ""
    holder = next((one for one in usual if one in inside), alone)
    return f"Put it into {with_article(f'<{holder}>')}." if holder else ""


def misplaced_remedy(tag: str, parent: Node, vocabulary: Vocabulary) -> str:
    """The remedy for a misplaced element."""
    allowed = vocabulary.parents(tag)
    if tag in PAUSES and "break" in vocabulary.tags:
        return PAUSES[tag]
    if parent.tag in ("else", "elseif"):
        return (
            f"<{parent.tag}> only divides the <if>: end its tag with />, and write this behind it."
        )
    if parent.tag == tag:
        return inside_itself(tag)
    if tag == "speak" and vocabulary.child(parent.key, "prompt"):
        return ASKED
    if tag in INSTEAD and vocabulary.child(parent.key, "speak"):
        return INSTEAD[tag]
    if into := put_into(tag, parent, vocabulary, ["block"]):
        return into
    if set(allowed) & set(vocabulary.parents(parent.tag)):
        return f"Move it out of the <{parent.tag}>."
    return INSTEAD.get(tag) or allowed_in(allowed)
