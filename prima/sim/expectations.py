"""A scenario's expectations of its run (``expect``, ``never``, ``in-order``)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from prima.devices.reading import Reader
from prima.errors import Hint, suggestion
from prima.grammar.text import fold
from prima.language.values import BadValue, read_value
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.sim.happenings import TRIGGERS, read_data

SUBJECTS = ("says", "does", "finishes", "event", "logs", "sends", "state", "ends")
"""The possible subjects of an expectation."""
WITH_DATA = ("does", "finishes", "event", "sends")
"""Subjects that may be narrowed down by values."""
MAX_EXPECTATIONS = 1000
"""Expectations that a scenario may have."""


@dataclass(slots=True, eq=False)
class Expectation:
    """Something that has to happen in a run, or must never happen; times in ms.

    ``words`` are the subjects given, by the attribute's name. The rest says when: after
    ``previous`` (the one before it in an ``in-order``), after or before another of that id,
    from a trigger on (``what`` as in :class:`When`; ``end`` for the run's end), and ``within``
    how long from there.
    """

    words: dict[str, str]
    never: bool
    by: str
    reason: str
    data: dict[str, str]
    id: str
    after: str
    before: str
    trigger: str
    what: Any
    count: int
    within: int | None
    times: int | None
    previous: Expectation | None
    node: Node


def read_expectations(reader: Reader, root: Node) -> list[Expectation]:
    """Everything that is expected of the run."""
    found: list[Expectation] = []
    ids: set[str] = set()

    def read(node: Node, previous: Expectation | None, ordered: bool) -> Expectation:
        made = _expectation(reader, node, previous, ordered, ids)
        reader.once(node, ids)
        found.append(made)
        return made

    for node in root.all("expect", "never", "in-order"):
        previous = None
        for child in node.all("expect") if node.tag == "in-order" else ():
            previous = read(child, previous, True)
        if node.tag != "in-order":
            read(node, None, False)
        elif not node.nodes:
            message = "<in-order> holds nothing."
            reader.problem(node, "empty", message, "", "Put <expect> elements into it.")
    for extra in found[MAX_EXPECTATIONS:][:1]:
        message = f"There are more than {MAX_EXPECTATIONS} expectations."
        reader.problem(extra.node, "too-large", message, "", "Divide the scenario.")
    return found


def _expectation(
    reader: Reader, node: Node, previous: Expectation | None, ordered: bool, ids: set[str]
) -> Expectation:
    given = [name for name in SUBJECTS if name in node.attributes]
    triggers = [name for name in TRIGGERS if name in node.attributes]
    if node.key in reader.vocabulary.elements:  # otherwise of another namespace; already reported
        _check_subject(reader, node, given)
    _check_when(reader, node, triggers)
    if ordered and "state" in given:
        message = "A state lasts: it is not allowed in <in-order>."
        remedy = "Write it outside, and say when by at, said, asked, doing, done or on."
        reader.problem(node, "exclusive", message, "state", remedy)
    _check_other(reader, node, "after", ids)
    _check_other(reader, node, "before", ids)
    trigger = next(iter(triggers), "")
    return Expectation(
        words={name: node.get(name) for name in given},
        never=node.tag == "never",
        by=node.get("by"),
        reason=node.get("reason"),
        data=read_data(reader, node),
        id=node.get("id"),
        after=node.get("after"),
        before=node.get("before"),
        trigger=trigger,
        what=_opening(reader, node, given) if trigger == "at" else node.get(trigger),
        count=reader.get(node, "count") or 1,
        within=reader.get(node, "within"),
        times=reader.get(node, "times"),
        previous=previous,
        node=node,
    )


def _check_subject(reader: Reader, node: Node, given: list[str]) -> None:
    """Check that an expectation has one subject, and what belongs to it."""
    if not given:
        known = {item.name for item in reader.vocabulary.elements[node.key].attributes}
        if set(node.attributes) <= known and not node.text:  # else something else is reported
            message = f"<{node.tag}> does not say what."
            remedy = f"It needs one of {', '.join(SUBJECTS[:-1])} or {SUBJECTS[-1]}."
            reader.problem(node, "missing-attribute", message, "", remedy)
        return
    for name in given:
        text = node.get(name).strip()
        if not (fold(text) if name in ("says", "logs") else text):
            why = ": it has no letter and no digit" if text else ""
            message = f'{name} "{text}" is empty{why}.'
            reader.problem(node, "bad-value", message, name, "Write what is expected.")
    if len(given) > 1 and given != ["says", "does"]:
        message = f'<{node.tag}> has both "{given[0]}" and "{given[1]}".'
        remedy = "Write an element for each; an <in-order> holds those that follow one another."
        reader.problem(node, "exclusive", message, given[1], remedy)
    _check_closer(reader, node, given)


def _check_closer(reader: Reader, node: Node, given: list[str]) -> None:
    """Check that what narrows down a subject belongs to it."""
    first = given[0]
    if "reason" in node.attributes and first != "ends":
        reader.problem(node, "exclusive", "reason says why an application ends.", "reason",
                       "Name the application with ends, or remove it.")  # fmt: skip
    if "by" in node.attributes and first == "ends":
        message = "ends names the application itself."
        reader.problem(node, "exclusive", message, "by", "Remove by.")
    if node.all("data") and not set(given) & set(WITH_DATA):
        message = f"What {first} expects has no values."
        reader.problem(node.all("data")[0], "misplaced-element", message, "", "Remove the <data>.")
    for name in ("times", "id"):
        if name in node.attributes and first == "state":
            message = "A state lasts: it is not counted, and nothing comes before or after it."
            reader.problem(node, "exclusive", message, name, f"Remove {name}.")


def _check_when(reader: Reader, node: Node, triggers: list[str]) -> None:
    """Check that there is one trigger at most, and that ``count`` goes with a countable one."""
    if len(triggers) > 1:
        message = f'<{node.tag}> has both "{triggers[0]}" and "{triggers[1]}".'
        reader.problem(node, "exclusive", message, triggers[1], "Keep one of them.")
    if "count" in node.attributes and (not triggers or triggers[0] == "at"):
        message = "count says which time of said, asked, doing, done or on is meant."
        reader.problem(node, "exclusive", message, "count", "Name one of these, or remove it.")


def _check_other(reader: Reader, node: Node, name: str, ids: set[str]) -> None:
    """Check that ``after`` and ``before`` name an expectation above."""
    other = node.get(name)
    if not other or other in ids:
        return
    remedy: str | Hint = suggestion(other, ids, *value_span(node, name))
    if not remedy and other[:1].isdigit():
        remedy = f'For a time write within="{other}".'
    message = f'No expectation above has the id "{other}".'
    reader.problem(node, "no-such-name", message, name, remedy)


def _opening(reader: Reader, node: Node, given: list[str]) -> Any:
    """The time of ``at`` (ms), or ``end``."""
    text = node.get("at")
    if text == "end":
        if given and given != ["state"]:
            message = 'at="end" is for a state: nothing happens any more then.'
            reader.problem(node, "exclusive", message, "at", "Remove at.")
        return "end"
    try:
        return read_value("duration", text)
    except BadValue as error:
        remedy = f'{error.remedy} Or write "end".'.lstrip()
        reader.problem(node, "bad-value", f'at "{text}" {error.wrong}', "at", remedy)
        return 0
