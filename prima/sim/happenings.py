"""What a scenario lets happen: the user, the surroundings, services and calls."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from prima.devices.reading import Reader
from prima.errors import suggestion
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.messages import Json
from prima.sim.vocabulary import SCENARIO


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
    after: int
    times: int
    count: int
    doings: list[Doing]


@dataclass(slots=True)
class Reply:
    """What a service answers, after how long (ms); ``error`` where it fails.

    ``src`` names the file that a fetch is answered with, ``body`` is what it holds.
    """

    after: int
    data: dict[str, Json] = field(default_factory=dict)
    error: str = ""
    status: int = 0
    src: str = ""
    body: bytes = b""
    node: Node | None = None


@dataclass(slots=True)
class Service:
    """A service, and the URI under which it is reached by its address."""

    name: str
    uri: str
    replies: list[Reply]
    application: str = ""
    """The application that alone may ask it; empty if all may."""


UNANSWERED = ("busy", "noanswer", "network_busy")
"""How a call ends that nobody answers (VoiceXML 2.0, 2.3.7.2.2)."""
ENDINGS = (
    "far_end_disconnect",
    "network_disconnect",
    "near_end_disconnect",
    "maxtime_disconnect",
    "unknown",
)
"""How one ends that somebody has answered."""


@dataclass(slots=True)
class Transfer:
    """How a call to a destination goes; times in ms."""

    to: str
    outcome: str
    after: int
    lasts: int


TRIGGERS = ("at", "said", "asked", "doing", "done", "on")


def read_services(reader: Reader) -> list[Service]:
    """The services; what an application sends to a name goes to its own, or to that of all."""
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
        replies = [read_reply(reader, child) for child in node.nodes if child.key]
        services.append(Service(name, node.get("uri"), replies, owner))
    return services


def read_when(reader: Reader, node: Node) -> When:
    """A trigger, with what happens then."""
    given = [name for name in TRIGGERS if name in node.attributes]
    if len(given) != 1:
        message = "<when> needs exactly one of at, said, asked, doing, done, on."
        if given:
            reader.problem(node, "exclusive", message, given[1], "Write a <when> for each.")
        else:
            if node.attributes.keys() <= SCENARIO.attributes["when"].keys():  # else told already
                remedy = 'Write when it happens, such as at="3s" or said="Hello".'
                reader.problem(node, "missing-attribute", message, "", remedy)
            given = ["at"]
    if not node.nodes and not node.text:
        message = "<when> holds nothing."
        remedy = (
            'Put into it what happens then, such as <say>Hello.</say> or <touch sensor="head"/>.'
        )
        reader.problem(node, "empty", message, "", remedy)
    doings = [_doing(reader, child) for child in node.nodes if child.key]
    return When(
        given[0],
        reader.get(node, given[0]),
        reader.get(node, "after") or 0,
        reader.get(node, "times") or 1,
        reader.get(node, "count") or 1,
        doings,
    )


def _doing(reader: Reader, node: Node) -> Doing:
    element = reader.vocabulary.elements[node.key]
    values = {item.name: reader.get(node, item.name) for item in element.attributes}
    if node.tag == "walk":
        check_where(reader, node, "to", "a place to go to")
    if node.tag == "event":
        values["data"] = _data(node)
    if node.tag == "say":
        values["told"] = _recognised(reader, node)
    return Doing(node.tag, node.text, values)


def _recognised(reader: Reader, node: Node) -> dict[str, Json]:
    """What the recogniser reports of the user's words (:class:`prima.messages.Heard`)."""
    told: dict[str, Json] = {}
    sure = reader.get(node, "confidence")
    if "confidence" in node.attributes:
        told["confidence"] = sure
    others = [(one.text, reader.get(one, "confidence")) for one in node.all("alternative")]
    for one, (_, less) in zip(node.all("alternative"), others, strict=True):
        if None not in (sure, less) and less > sure:
            message = f"An alternative is less likely than what is heard, {sure:g} or below."
            remedy = "Put the likeliest words first."
            reader.problem(one, "out-of-range", message, "confidence", remedy)
    if others:
        told["confidence"] = sure
        told["alternatives"] = [{"text": text, "confidence": less} for text, less in others]
    return told


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


def read_answer(reader: Reader, node: Node) -> When:
    """What the user says to a question."""
    after = reader.get(node, "after")
    times = reader.get(node, "times") or 1
    return When(
        "asked",
        node.get("to"),
        1000 if after is None else after,
        times,
        1,
        [Doing("say", node.text, {"told": _recognised(reader, node)})],
    )


def read_reply(reader: Reader, node: Node) -> Reply:
    """What a service answers, or how it fails."""
    after = max(reader.get(node, "after") or 0, 1)
    if node.tag == "failure":
        status = reader.get(node, "status") or 0
        return Reply(after, error=reader.get(node, "reason") or "no answer", status=status)
    return Reply(after, _data(node), src=node.get("src"), node=node)


def read_connection(node: Node) -> dict[str, Json]:
    """The user's call as ``session.connection`` has it (VoiceXML 2.0, 5.1.4)."""
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


def read_transfer(reader: Reader, node: Node) -> Transfer:
    """How a call to a destination goes."""
    outcome = reader.get(node, "outcome") or ENDINGS[0]
    if outcome not in (*UNANSWERED, *ENDINGS) and not outcome.startswith("error."):
        message = f'A call does not end with "{outcome}".'
        spans = value_span(node, "outcome")
        hint = suggestion(outcome, {*UNANSWERED, *ENDINGS}, *spans)
        remedy = hint or f"Write {', '.join((*UNANSWERED, *ENDINGS))}, or an error's event."
        reader.problem(node, "bad-value", message, "outcome", remedy)
    lasts = reader.get(node, "lasts")
    return Transfer(
        node.get("to"),
        outcome,
        max(reader.get(node, "after") or 0, 1),
        max(10_000 if lasts is None else lasts, 1),
    )


def _data(node: Node) -> dict[str, Json]:
    return {child.get("name"): child.get("value") for child in node.all("data")}
