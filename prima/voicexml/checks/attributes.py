"""Attributes of VoiceXML's elements, and what they may hold."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterator, Mapping

from prima.errors import Hint, Problem, nearest_word, one_of, replaced
from prima.errors.diagnoses.structure import MISSING_ATTRIBUTE, UNKNOWN_ATTRIBUTE
from prima.errors.diagnoses.values import BAD_VALUE, EXCLUSIVE
from prima.language.values import NUMBER, read_value
from prima.markup.hints import meant_value
from prima.markup.spans import added, similar_attribute, value_span
from prima.markup.tree import Node
from prima.voicexml.cues import is_rate
from prima.voicexml.vocabulary import ALTERNATIVES, VOICEXML, kind_of

WORDS = frozenset(
    [
        *("application", "dest", "event", "fetchaudio", "id", "item", "name", "next", "nextitem"),
        *("slot", "src", "transferaudio", "xml:base"),
    ]
)
"""Free-text attributes in which leading and trailing white space is insignificant."""
KEYS = re.compile(r"\s*[0-9*#A-D](?:\s*[0-9*#A-D])*\s*")

READ_AS = BAD_VALUE.says(
    '{name} "{value}" is read as "{right}".', 'Write "{right}".', severity="warning"
)
NOT_ALLOWED = BAD_VALUE.says('{name} "{value}" is not allowed here.')
NO_ATTRIBUTE = UNKNOWN_ATTRIBUTE.says('<{tag}> has no attribute "{name}".', "Remove it.")
NEEDS = MISSING_ATTRIBUTE.says('<{tag}> needs the attribute "{name}".')
NEEDS_ONE = MISSING_ATTRIBUTE.says("<{tag}> needs {names}.", "Write one of them.")
HAS_BOTH = EXCLUSIVE.says('<{tag}> has both "{name}" and {other}.', "Keep one of them.")


def check_attributes(node: Node) -> Iterator[Problem]:
    """Attributes that are unknown, wrong or missing."""
    for name in node.attributes:
        yield from _check_attribute(node, name)
    for item in VOICEXML.elements[node.key].attributes:
        lacking = item.required and item.name not in node.attributes
        if lacking and node.key != "vxml" and item.name not in _meant(node):
            yield missing(node, item.name)  # a document's version is checked elsewhere
    for line in ALTERNATIVES.get(node.key, ()):
        yield from _check_alternatives(node, line.split())


def _meant(node: Node) -> set[str]:
    """The attributes that unknown ones most likely mean: that they are missing is not told as well."""
    known = VOICEXML.attributes[node.key]
    return {nearest_word(one, known) for one in node.attributes if _is_unknown(one, known)}


def _is_unknown(name: str, known: Container[str]) -> bool:
    """Whether an attribute is none of those known, nor one of XML itself or of another namespace."""
    return name not in known and not name.startswith(("xml:", "xsi:", "{"))


def _kind(node: Node, name: str) -> str:
    """The kind of an attribute's value; empty for any text."""
    if name == "xml:lang":
        return "" if node.key == "grammar" else "language"  # a grammar checks its own
    return kind_of(node.key, name) if name in VOICEXML.attributes[node.key] else ""


def _check_attribute(node: Node, name: str) -> Iterator[Problem]:
    text, kind, known = node.attributes[name], _kind(node, name), VOICEXML.attributes[node.key]
    if (kind or name in WORDS) and text != text.strip():
        node.attributes[name] = text = text.strip()  # as XML Schema collapses it
    if kind and name == "method" and text != text.lower():
        yield _capitals(node, name, kind)
    elif kind:
        if not fits(kind, text):
            yield bad_value(node, name, text, kind)
    elif _is_unknown(name, known):
        hint = similar_attribute(node, name, known)
        place = node.attribute_place(name, value=False)
        yield NO_ATTRIBUTE.at(place, hint, tag=node.tag, name=name)


def missing(node: Node, name: str) -> Problem:
    """The problem of a required attribute that is missing."""
    hint = added("", node, VOICEXML.attributes[node.key][name][0])
    return NEEDS.at(node.place, hint, tag=node.tag, name=name)


def _capitals(node: Node, name: str, kind: str) -> Problem:
    """Accept keywords of HTTP in capitals, as other platforms do: they are read as lower case."""
    text = node.attributes[name]
    node.attributes[name] = small = text.lower()
    if not fits(kind, small):
        return bad_value(node, name, text, kind)
    hint = replaced(f'Write "{small}".', small, *value_span(node, name))
    return READ_AS.at(node.attribute_place(name), hint, name=name, value=text, right=small)


DECIMAL = r"(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]++)"
"""A number without a sign; no digit is tried twice, so that a long one takes no longer."""
PITCH = rf"x-low|low|medium|high|x-high|default|[+-]?{DECIMAL}(?:Hz|st|%)?"
"""A pitch, or a range of it (SSML 1.0, 3.2.4)."""
CONTOUR = rf"(?:\s*+\(\s*+[+-]?{DECIMAL}%\s*+,\s*+(?:{PITCH})\s*+\))+\s*+"
"""Times in a text, as shares of it, each with its pitch (SSML 1.0, 3.2.4)."""
ALPHABET = r"ipa|x-\S+"
"""An alphabet of pronunciations: that of the IPA, or a vendor's (SSML 1.0, 3.1.9)."""
VOLUME = (
    rf"silent|x-soft|soft|medium|loud|x-loud|default|[+-]{DECIMAL}(?:dB|%)?"
    r"|100(?:\.0*)?|[0-9]{1,2}(?:\.[0-9]*)?"
)
WEIGHT = DECIMAL
"""The weight of a grammar, without a sign or an exponent (3.1.1.3)."""
REMEDIES = {
    "rate": 'Write slow, fast or another name of a rate, a number, or a change such as "+10%".',
    "time": 'Write a number with its unit: "500ms" or "2.5s".',
    "integer": "Write a whole number from 1.",
    "share": "Write a number from 0 to 1.",
    "keys": "Write keys, 0 to 9, *, # and A to D, with spaces between or without.",
    "event": 'Write a name such as "order.cancelled".',
    "events": 'Write names such as "order.cancelled", with spaces between.',
    "language": 'Write a language tag such as "en".',
    "number": "Write a whole number from 0.",
    "name": "Write letters, digits, - and _, a letter first.",
    "key": "Write one key: 0 to 9, *, # or A to D; or none.",
    "modes": "Write dtmf, voice, or both with a space between.",
    "pitch": 'Write x-low, low, medium, high, x-high or default, "120Hz", or a change such as "+10%".',
    "contour": 'Write shares of the text with pitches, such as "(0%,+20Hz) (50%,high)".',
    "alphabet": 'Write ipa, or a name that begins with x-, such as "x-sampa".',
    "volume": 'Write silent, x-soft, soft, medium, loud, x-loud or default, 0 to 100, or a change such as "+6dB".',
    "weight": 'Write a number such as "0.5".',
}


def fits(kind: str, text: str) -> bool:
    """Whether a text is a value of a kind, or one of the keywords that the kind lists."""
    return FITS[kind](text) if kind in FITS else text in kind.split()


def _reads(kind: str, text: str) -> bool:
    try:
        read_value(kind, text)
    except ValueError:
        return False
    return True


def _is_whole(text: str) -> bool:
    return text.isascii() and text.isdigit() and text.strip("0") != ""


def _are_events(text: str) -> bool:
    """Whether a text lists events; a dot alone, like an empty name, stands for all events."""
    return all(name == "." or _reads("event", name) for name in text.split())


def _is_share(text: str) -> bool:
    return NUMBER.fullmatch(text.strip()) is not None and 0 <= float(text) <= 1


FITS: Mapping[str, Callable[[str], bool]] = {
    "integer": _is_whole,
    "time": lambda text: _reads("duration", text.strip()),
    "language": lambda text: not text.strip() or _reads("language", text),
    "event": lambda text: _reads("event", text),
    "events": _are_events,
    "keys": lambda text: KEYS.fullmatch(text) is not None,
    "share": _is_share,
    "rate": is_rate,
    "number": lambda text: text.isascii() and text.isdigit(),
    "name": lambda text: re.fullmatch(r"[^\W\d][\w.-]*", text) is not None,
    "key": lambda text: not text or (KEYS.fullmatch(text) is not None and len(text) == 1),
    "modes": lambda text: {*text.split()} in ({"dtmf"}, {"voice"}, {"dtmf", "voice"}),
    "pitch": lambda text: re.fullmatch(PITCH, text) is not None,
    "contour": lambda text: re.fullmatch(CONTOUR, text) is not None,
    "alphabet": lambda text: re.fullmatch(ALPHABET, text) is not None,
    "volume": lambda text: re.fullmatch(VOLUME, text) is not None,
    "weight": lambda text: re.fullmatch(WEIGHT, text) is not None,
}


def bad_value(node: Node, name: str, text: str, kind: str) -> Problem:
    """A value that is not of its kind."""
    return NOT_ALLOWED.at(
        node.attribute_place(name), instead_of(node, name, text, kind), name=name, value=text
    )


def instead_of(node: Node, name: str, text: str, kind: str) -> Hint:
    """The remedy for a value that is not of its kind."""
    if kind == "time" and (right := meant_value("duration", text)):
        return replaced(f'Write "{right}".', right, *value_span(node, name))
    return Hint(REMEDIES.get(kind, f"Write {one_of(kind.split())}."))


def _check_alternatives(node: Node, names: list[str]) -> Iterator[Problem]:
    """Check attributes that exclude each other, and those of which one is required."""
    needed = names[-1] == "!"
    names = names[:-1] if needed else names
    given = [name for name in names if name in node.attributes]
    if "content" in names and (node.nodes or node.text):
        given.append("content")
    if len(given) > 1:
        place = node.place if given[1] == "content" else node.attribute_place(given[1])
        yield HAS_BOTH.at(place, tag=node.tag, name=given[0], other=_called(given[1]))
    elif needed and not given and _meant(node).isdisjoint(names):
        yield NEEDS_ONE.at(node.place, tag=node.tag, names=one_of(map(_called, names)))


def _called(name: str) -> str:
    return "content of its own" if name == "content" else f'"{name}"'
