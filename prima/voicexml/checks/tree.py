"""The elements of a VoiceXML document: where each may appear, and what it may contain."""

from __future__ import annotations

from prima.errors import Hint, Problem, few, meant, nearest_word
from prima.errors.diagnoses.structure import (
    MISPLACED_ELEMENT,
    STRAY_TEXT,
    UNKNOWN_ELEMENT,
    WRONG_NAMESPACE,
)
from prima.grammar.vocabulary import SRGS
from prima.markup.hints import allowed_in, inside_itself, put_into
from prima.markup.spans import name_spans, renamed
from prima.markup.tree import Node
from prima.markup.vocabulary import Instead
from prima.voicexml.arranging import check_items, is_unit
from prima.voicexml.checks.attributes import check_attributes
from prima.voicexml.checks.elements import RULES
from prima.voicexml.checks.guests import check_guest
from prima.voicexml.upgrade import is_other_version, version_problem
from prima.voicexml.vocabulary import COMMANDS, NAMESPACE, PRIMA_NAMESPACE, VOICEXML

MOST_ALIKE = 5
"""How many problems with the same message are shown, each with its place."""
LONGEST_SHOWN = 30
"""Characters of stray text that a message quotes."""
HABITS: dict[str, str | Instead] = {
    "speak": Instead("prompt"),
    "say": Instead("prompt"),
    "on": Instead("catch", 'event="..."'),
    "send": Instead("submit"),
    "pause": 'In a prompt write <break time="1s"/>; between Commands '
    f'<p:pause time="1s"/>, with xmlns:p="{PRIMA_NAMESPACE}".',
    "iu": f'Write <p:iu> around Commands or form items, with xmlns:p="{PRIMA_NAMESPACE}".',
    "par": f'Write <p:par> around Commands, with xmlns:p="{PRIMA_NAMESPACE}".',
    "seq": f'Write <p:seq> around Commands, with xmlns:p="{PRIMA_NAMESPACE}".',
}
"""Remedies for elements of other languages."""
HOLDERS = {
    "foreach": "a <foreach> of executable content",
    "said-foreach": "a <foreach> of a prompt",
}
"""How messages name elements whose content depends on where they appear."""
USUAL = ("block", "prompt")
"""Elements that authors forget most often around others."""

TEXTS = {
    "vxml": "Write it into a <block> of a <form>.",
    "form": "Write it into a <block>.",
    "menu": "Write it into a <prompt>.",
    "subdialog": "Write it into a <prompt>.",
    **dict.fromkeys(
        ("else", "elseif"),
        "It only divides the <if>: end its tag with />, and write this behind it.",
    ),
}
"""Where text directly in an element belongs."""

HOLDS_TEXT = STRAY_TEXT.says('<{tag}> holds text: "{text}".')
IGNORED = WRONG_NAMESPACE.says(
    '<{tag}> is of another namespace, "{namespace}".', "It is ignored.", "warning"
)
UNKNOWN_HERE = UNKNOWN_ELEMENT.says("There is no <{tag}> in VoiceXML.", "Remove it.")
NOT_HERE = MISPLACED_ELEMENT.says("<{tag}> is not allowed in {holder}.")


def check_tree(root: Node) -> list[Problem]:
    """Give every node its key, remove foreign namespaces, and report what is wrong.

    A document with an error is not run: fetching it throws ``error.badfetch`` (5.2.6).
    """
    root.key = "vxml"
    problems = [problem] if (problem := version_problem(root)) else []
    if is_other_version(root):
        return problems  # of another version, what else seems wrong may be right
    stack = [root]
    while stack:
        node = stack.pop()
        problems += _check_element(node)
        if node.content and node.key not in ("grammar", "metadata"):
            _check_children(node, stack, problems)
    return few(problems, MOST_ALIKE)


def _check_element(node: Node) -> list[Problem]:
    """Check an element itself."""
    problems = [*check_attributes(node)]
    check = RULES.get(node.key)
    if check is not None:
        problems += check(node)
    if not VOICEXML.elements[node.key].text and node.content and node.text:
        text = node.text[:LONGEST_SHOWN]
        hint = Hint(TEXTS.get(node.key, "Remove it."))
        problems.append(HOLDS_TEXT.at(node.place, hint, tag=node.tag, text=text))
    return problems


def _check_children(node: Node, stack: list[Node], problems: list[Problem]) -> None:
    """Find the children's keys; push those to be checked onto the stack."""
    foreign = False
    for child in node.nodes:
        if is_unit(child) and node.key == "form":
            stack.extend(check_items(child, problems))
        elif child.namespace == PRIMA_NAMESPACE:
            problems += check_guest(child, node)
        elif child.namespace == NAMESPACE or (child.tag, child.namespace) == ("grammar", SRGS):
            key = VOICEXML.child(node.key, child.tag)
            if key is None:
                problems.append(_misplaced(child, node))
            else:
                child.key = key
                stack.append(child)
        else:
            foreign = True
            problems.append(_ignored(child))
    if foreign:
        kept = (NAMESPACE, PRIMA_NAMESPACE, SRGS)
        node.held = [one for one in node.content if isinstance(one, str) or one.namespace in kept]


def _ignored(child: Node) -> Problem:
    """The problem of an element of another namespace, which may be PRIMA's, misspelt."""
    near = nearest_word(child.namespace, [PRIMA_NAMESPACE])
    remedy = f'Did you mean "{near}"?' if near else ""
    if not child.namespace and child.tag in VOICEXML.tags:
        remedy = 'Remove its xmlns="".'
    hint = Hint(f"It is ignored. {remedy}" if remedy else "")
    return IGNORED.at(child.place, hint, tag=child.tag, namespace=child.namespace)


def _misplaced(child: Node, node: Node) -> Problem:
    if child.tag not in VOICEXML.tags:
        return UNKNOWN_HERE.at(child.place, _known_instead(child), tag=child.tag)
    around = put_into(child.tag, node, VOICEXML, USUAL)
    others = (tag for tag in VOICEXML.parents(child.tag) if tag != node.tag)
    hint = Hint(inside_itself(child.tag) if child.tag == node.tag else around or allowed_in(others))
    holder = HOLDERS.get(node.key, f"<{node.tag}>")
    return NOT_HERE.at(child.place, hint, tag=child.tag, holder=holder)


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
