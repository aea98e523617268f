"""Semantic checks: problems of an application beyond its schema.

Each module checks one subject, and declares the diagnoses that only it reports.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from prima.errors import Problem
from prima.interpreter.checks.arguments import given_to
from prima.interpreter.checks.calls import check_calls
from prima.interpreter.checks.code import check_code
from prima.interpreter.checks.commands import check_branches, check_texts, check_units
from prima.interpreter.checks.comparisons import check_comparisons
from prima.interpreter.checks.contents import check_contents
from prima.interpreter.checks.facts import Facts
from prima.interpreter.checks.hints import check_hints
from prima.interpreter.checks.questions import check_first_prompts, check_leaving, check_silence
from prima.interpreter.checks.reachable import check_handlers, check_reachable
from prima.interpreter.checks.robot import check_commands
from prima.interpreter.checks.rounds import check_endless, check_rounds
from prima.interpreter.checks.sensors import check_sensors
from prima.interpreter.checks.targets import check_items, check_targets
from prima.interpreter.checks.throws import check_throws
from prima.interpreter.deadcontent import dead_content
from prima.interpreter.elements import Document
from prima.interpreter.events import KnownEvents
from prima.interpreter.repeats import source_of, told_twice
from prima.interpreter.rounds import endless_reactions

__all__ = ["check_commands", "check_document", "given_to"]

CHECKS: tuple[Callable[[Facts], Iterator[Problem]], ...] = (
    check_targets,
    check_hints,
    check_reachable,
    check_items,
    check_code,
    check_sensors,
    check_contents,
    check_comparisons,
    check_calls,
    check_texts,
    check_branches,
    check_endless,
    check_units,
    check_rounds,
    check_leaving,
    check_silence,
    check_first_prompts,
    check_handlers,
    check_throws,
)


def check_document(document: Document) -> list[Problem]:
    """All semantic problems of a document."""
    facts = Facts(document)
    problems = [problem for check in CHECKS for problem in check(facts)]
    problems += dead_content(document.node)
    problems += endless_reactions(document)
    problems += KnownEvents(document, facts.acts).problems()
    return [*problems, *told_twice([source_of(document, facts.acts)])]
