"""Problems as text with source lines, as JSON, and as SARIF 2.1.0."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from prima.errors.diagnosis import Diagnosis
from prima.errors.problems import Fix, Problem, Severity
from prima.errors.visible import visible

WIDEST = 100
"""Maximum width of a source line."""
COLOURS: dict[Severity, str] = {"error": "31", "warning": "33", "note": "36"}
TOKEN = re.compile(r"""<[^\s/>]*|"[^"]*"?|'[^']*'?|[^\s<>"'=]+|\S""")
SARIF_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"

Lines = Callable[[str], list[str]]
"""Returns the lines of a file; none if it cannot be read."""


def render(problem: Problem, lines: Lines, colour: bool = False) -> str:
    """A problem with its source line and a caret."""
    place, (severity, code, message, remedy) = problem.place, problem.sentence

    def paint(text: str, style: str) -> str:
        return f"\033[{style}m{text}\033[0m" if colour else text

    sentence = visible(f"{message} {remedy}" if remedy else message)
    head = (
        f"{paint(visible(str(place)), '1')}: {paint(severity, '1;' + COLOURS[severity])}: {sentence}"
        f" {paint(f'[{code}]', '2')}"
    )
    held = lines(place.file)
    if not 1 <= place.line <= len(held) or not held[place.line - 1].strip():
        return head
    shown, under = excerpt(held[place.line - 1], place.column)
    number = f"{place.line:>5}"
    mark = paint(under, "1;" + COLOURS[severity])
    return f"{head}\n{number} | {shown}\n{' ' * len(number)} | {mark}".rstrip()


def excerpt(line: str, column: int) -> tuple[str, str]:
    """A source line, cut around a column, and the carets under the token there."""
    start = min(max(column - 1, 0), len(line))
    token = TOKEN.match(line, start, start + WIDEST)
    length = len(token[0]) if token else 1
    if line[start : start + 1] in "\"'" and line[:start].rstrip()[-1:] != "=":
        length = 1  # the quote that ends a value: what is wrong is that it ends there
    cut = 0
    if len(line) > WIDEST and start > WIDEST // 2:
        cut = start - WIDEST // 2
    shown = line[cut : cut + WIDEST]
    plain = visible(shown, "\t")
    before = "".join(map(_blank, plain[: start - cut]))
    marked = sum(map(columns_of, plain[start - cut : start - cut + length]))
    head, tail = "..." if cut else "", "..." if cut + WIDEST < len(line) else ""
    return f"{head}{plain}{tail}", f"{' ' * len(head)}{before}^{'~' * (max(marked, 1) - 1)}"


def columns_of(letter: str) -> int:
    """The width of a character in columns of a terminal: 0 if it combines with the one before it."""
    if unicodedata.category(letter) in ("Mn", "Me", "Cf"):
        return 0
    return 2 if unicodedata.east_asian_width(letter) in "WF" else 1


def _blank(letter: str) -> str:
    """The padding under a character: a tab under a tab."""
    return "\t" if letter == "\t" else " " * columns_of(letter)


def problem_data(problem: Problem) -> dict[str, Any]:
    """A problem as data for JSON."""
    return {
        "file": problem.place.file,
        "line": problem.place.line,
        "column": problem.place.column,
        "severity": problem.severity,
        "code": problem.code,
        "message": problem.message,
        "remedy": problem.remedy,
        "fixes": [_fix_data(fix) for fix in problem.fixes],
    }


def _fix_data(fix: Fix) -> dict[str, Any]:
    return {
        "title": fix.title,
        "edits": [{**edit.span._asdict(), "text": edit.text} for edit in fix.edits],
    }


def sarif(
    problems: Iterable[Problem], version: str, known: Mapping[str, Diagnosis]
) -> dict[str, Any]:
    """Problems as a SARIF 2.1.0 log; ``known`` are the diagnoses by code."""
    held = list(problems)
    used = sorted({problem.code for problem in held})
    rules = [
        {
            "id": code,
            "shortDescription": {"text": known[code].title},
            "fullDescription": {"text": known[code].meaning},
        }
        for code in used
    ]
    results = [_result(problem, used.index(problem.code)) for problem in held]
    driver = {"name": "prima", "version": version, "rules": rules}
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return {"$schema": SARIF_SCHEMA, "version": "2.1.0", "runs": [run]}


def _result(problem: Problem, rule: int) -> dict[str, Any]:
    """A problem as a result of a SARIF log; ``rule`` is the index of its code."""
    file = {"uri": _uri(problem.place.file)}
    region = {"startLine": problem.place.line, "startColumn": problem.place.column}
    result = {
        "ruleId": problem.code,
        "ruleIndex": rule,
        "level": problem.severity,
        "message": {"text": f"{problem.message} {problem.remedy}".strip()},
        "locations": [{"physicalLocation": {"artifactLocation": file, "region": region}}],
    }
    if problem.fixes:
        result["fixes"] = [_sarif_fix(fix, file) for fix in problem.fixes]
    return result


def _sarif_fix(fix: Fix, file: dict[str, str]) -> dict[str, Any]:
    names = ("startLine", "startColumn", "endLine", "endColumn")
    replacements = [
        {"deletedRegion": dict(zip(names, span, strict=True)), "insertedContent": {"text": text}}
        for span, text in fix.edits
    ]
    changes = [{"artifactLocation": file, "replacements": replacements}]
    return {"description": {"text": fix.title}, "artifactChanges": changes}


def _uri(path: str) -> str:
    """A file's name as a URI reference, relative for a relative name."""
    from urllib.parse import quote

    name = quote(path.replace("\\", "/"), errors="surrogateescape")
    return f"file://{name}" if path.startswith("/") else name
