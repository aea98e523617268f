"""The events of a scenario: the user, the surroundings, services and calls."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from prima.devices.reading import Reader
from prima.errors import suggestion
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.messages import Json
from prima.sim.chance import Amount, Chance, Draws

SURE = Chance()
AT_ONCE = Amount(1)
"""A ms later."""


@dataclass(slots=True)
class Doing:
    """One thing that happens in a ``when``: its element's name and values."""

    name: str
    text: str = ""
    values: dict[str, Any] = field(default_factory=dict)


@dataclass(slots=True)
class When:
    """A trigger with what follows it."""

    trigger: str
    what: Any
    """Its condition: words, a Command, an event; an :class:`Amount` (ms) for ``at``."""
    after: Amount
    times: int
    count: int
    doings: list[Doing]
    chance: Chance = SURE
    person: str = ""
    """The person who does it; empty for the first person."""
    node: Node | None = None


@dataclass(slots=True)
class Reply:
    """A service's answer, after how long (ms); ``error`` if it fails.

    ``src`` names the file that answers a fetch, ``body`` is its content.
    """

    data: dict[str, Json] = field(default_factory=dict)
    after: Amount = AT_ONCE
    error: str = ""
    status: int = 0
    src: str = ""
    body: bytes = b""
    node: Node | None = None


@dataclass(slots=True)
class Service:
    """A service, found by its name or its URI."""

    name: str
    uri: str
    """The address at and below which fetches reach it; empty if only its name does."""
    replies: list[Reply]
    application: str = ""
    """The only application that may use it; empty if all may."""


UNANSWERED = ("busy", "noanswer", "network_busy")
"""The outcomes of an unanswered call (VoiceXML 2.0, 2.3.7.2.2)."""
ENDINGS = (
    "far_end_disconnect",
    "network_disconnect",
    "near_end_disconnect",
    "maxtime_disconnect",
    "unknown",
)
"""The outcomes of an answered call."""


@dataclass(slots=True)
class CallTransfer:
    """How a call to a destination goes; times in ms."""

    to: str
    outcome: str
    after: Amount
    lasts: Amount


TRIGGERS = ("at", "said", "asked", "doing", "done", "on")


def read_services(draws: Draws) -> list[Service]:
    """The services; a message goes to the application's own service of that name, or to all's."""
    reader = draws.reader
    seen: set[tuple[str, str]] = set()
    services = []
    for node in reader.root.all("service"):
        name, owner = node.get("name"), node.get("application")
        if (name, owner) in seen:
            whose = f' for the application "{owner}"' if owner else ""
            message = f'Two services have the name "{name}"{whose}.'
            remedy = "Rename one, or put the replies of both into one."
            reader.problem(node, "duplicate-name", message, "name", remedy)
        seen.add((name, owner))
        replies = [read_reply(draws, child) for child in node.nodes if child.key]
        services.append(Service(name, node.get("uri"), replies, owner))
    return services


def read_when(draws: Draws, node: Node) -> When:
    """A trigger, with what happens then."""
    reader = draws.reader
    trigger = _trigger(reader, node)
    if not node.nodes and not node.text:
        message = "<when> holds nothing."
        remedy = (
            'Put into it what happens then, such as <say>Hello.</say> or <touch sensor="head"/>.'
        )
        reader.problem(node, "empty", message, "", remedy)
    times, count = reader.get(node, "times") or 1, reader.get(node, "count") or 1
    if trigger == "at" and max(times, count) > 1:
        name = "count" if count > 1 else "times"
        message = f"<when> has both at and {name}, but a point in time comes once."
        reader.problem(node, "exclusive", message, name, f"Remove {name}.")
    return When(
        trigger,
        draws.amount(node, "at") if trigger == "at" else reader.get(node, trigger),
        draws.amount(node, "after"),
        times,
        count,
        [_doing(draws, child) for child in node.nodes if child.key],
        draws.chance(node),
        node.get("person"),
        node,
    )


def _trigger(reader: Reader, node: Node) -> str:
    """The trigger's attribute; ``at`` if there is none."""
    given = [name for name in TRIGGERS if name in node.attributes]
    message = "<when> needs exactly one of at, said, asked, doing, done, on."
    if len(given) > 1:
        reader.problem(node, "exclusive", message, given[1], "Write a <when> for each.")
    elif not given and node.attributes.keys() <= reader.vocabulary.attributes["when"].keys():
        remedy = 'Write when it happens, such as at="3s" or said="Hello".'
        reader.problem(node, "missing-attribute", message, "", remedy)
    return given[0] if given else "at"


def _doing(draws: Draws, node: Node) -> Doing:
    reader = draws.reader
    if node.tag == "one-of":
        return _one_of(draws, node)
    if node.tag == "wait":
        return Doing("wait", "", {"for": draws.amount(node, "for")})
    element = reader.vocabulary.elements[node.key]
    values = {item.name: reader.get(node, item.name) for item in element.attributes}
    if node.tag == "walk":
        check_where(reader, node, "to", "a place to go to")
    if node.tag == "event":
        values["data"] = read_data(reader, node)
    if node.tag == "say":
        return _said(reader, node)
    return Doing(node.tag, node.text, values)


def _one_of(draws: Draws, node: Node) -> Doing:
    """One of several things that happens."""
    several = [_doing(draws, child) for child in node.nodes if child.key]
    if not several:
        remedy = "Put into it what may happen, such as <say>Yes.</say><say>No.</say>."
        draws.reader.problem(node, "empty", "<one-of> holds nothing.", "", remedy)
    return Doing("one-of", "", {"several": several, "choice": draws.choice(node)})


def _said(reader: Reader, node: Node) -> Doing:
    """The user's words; without words they stay silent."""
    known = reader.vocabulary.attributes.get(node.key, {})  # none of another namespace
    if not node.text and node.attributes.keys() <= known.keys():
        message = f"<{node.tag}> holds no words: the user stays silent."
        remedy = f"Write the words into it, or remove <{node.tag}>."
        reader.problem(node, "empty", message, "", remedy, "warning")
    return Doing("say", node.text, {"report": _recognised(reader, node)})


def _recognised(reader: Reader, node: Node) -> dict[str, Json]:
    """The recogniser's report of the user's words (:class:`prima.messages.Heard`)."""
    report: dict[str, Json] = {}
    sure = reader.get(node, "confidence")
    if sure is not None and sure < 1.0:
        report["confidence"] = sure
    others = [(one.text, reader.get(one, "confidence")) for one in node.all("alternative")]
    for one, (_, less) in zip(node.all("alternative"), others, strict=True):
        if None not in (sure, less) and less > sure:
            message = f"An alternative is less likely than what is heard, {sure:g} or below."
            remedy = "Put the likeliest words first."
            reader.problem(one, "out-of-range", message, "confidence", remedy)
    if others:
        report["confidence"] = sure
        report["alternatives"] = [{"text": text, "confidence": less} for text, less in others]
    return report


def check_where(reader: Reader, node: Node, name: str, what: str, needed: bool = True) -> None:
    """A place by its name, or by x and y, and not both."""
    numbers = [key for key in ("x", "y") if key in node.attributes]
    if name in node.attributes and numbers:
        message = f'<{node.tag}> has both "{name}" and "{numbers[0]}".'
        reader.problem(node, "exclusive", message, numbers[0], "Keep one of them.")
    elif len(numbers) == 1 or (needed and not numbers and name not in node.attributes):
        message = f"<{node.tag}> needs {what}, or x and y."
        lacks = "y" if numbers == ["x"] else "x" if numbers else name
        reader.problem(node, "missing-attribute", message, "", f'Write {lacks}="...".')


def read_answer(draws: Draws, node: Node) -> When:
    """The user's answer to a question."""
    reader = draws.reader
    return When(
        "asked",
        node.get("to"),
        draws.amount(node, "after", 1000),
        reader.get(node, "times") or 1,
        1,
        [_said(reader, node)],
        draws.chance(node),
        node.get("person"),
        node,
    )


def read_reply(draws: Draws, node: Node) -> Reply:
    """A service's answer, or its failure."""
    reader, after = draws.reader, draws.amount(node, "after")
    if node.tag == "failure":
        status = reader.get(node, "status") or 0
        error = reader.get(node, "reason") or "no answer"
        return Reply(after=after, error=error, status=status)
    return Reply({**read_data(reader, node)}, after, src=node.get("src"), node=node)


def read_connection(node: Node) -> dict[str, Json]:
    """The user's call as in ``session.connection`` (VoiceXML 2.0, 5.1.4)."""
    given = node.attributes
    found: dict[str, Json] = {
        side: {"uri": given[side]} for side in ("remote", "local") if side in given
    }
    protocol = {
        name: given[key] for name, key in (("name", "protocol"), ("version",) * 2) if key in given
    }
    redirects = [dict(child.attributes) for child in node.all("redirect")]
    return (
        found
        | ({"protocol": protocol} if protocol else {})
        | {name: given[name] for name in ("aai", "originator") if name in given}
        | ({"redirect": redirects} if redirects else {})
    )


def read_transfer(draws: Draws, node: Node) -> CallTransfer:
    """How a call to a destination goes."""
    reader = draws.reader
    outcome = reader.get(node, "outcome") or ENDINGS[0]
    if outcome not in (*UNANSWERED, *ENDINGS) and not outcome.startswith("error."):
        message = f'A call does not end with "{outcome}".'
        spans = value_span(node, "outcome")
        hint = suggestion(outcome, {*UNANSWERED, *ENDINGS}, *spans)
        remedy = hint or f"Write {', '.join((*UNANSWERED, *ENDINGS))}, or an error's event."
        reader.problem(node, "bad-value", message, "outcome", remedy)
    after, lasts = draws.amount(node, "after"), draws.amount(node, "lasts", 10_000)
    return CallTransfer(node.get("to"), outcome, after, lasts)


def read_data(reader: Reader, node: Node) -> dict[str, str]:
    """The values in an element; each has a name of its own."""
    nodes = node.all("data")
    reader.check_twice([one for one in nodes if one.get("name")], "name")
    return {child.get("name"): child.get("value") for child in nodes}
