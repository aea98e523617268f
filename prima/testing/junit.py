"""Results of tests for other tools: JUnit XML, and coverage in Cobertura's format."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import groupby
from pathlib import PurePath
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from prima.testing.coverage import Coverage, Covered, total
from prima.testing.running import Result
from prima.testing.telling import counts, format_result

ILLEGAL = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 has no way to write."""


def junit(results: Iterable[Result]) -> bytes:
    """Results as JUnit XML: a suite for each folder, a case for each scenario."""
    held = sorted(results, key=lambda one: (_folder(one), one.path))
    root = Element("testsuites", name="prima")
    _totals(root, held)
    for folder, group in groupby(held, key=_folder):
        cases = list(group)
        suite = SubElement(root, "testsuite", name=folder)
        _totals(suite, cases)
        for one in cases:
            _case(suite, one)
    return _written(root)


def _folder(result: Result) -> str:
    return PurePath(result.path).parent.as_posix()


def _totals(element: Element, results: list[Result]) -> None:
    found = counts(results)
    element.set("tests", str(len(results)))
    element.set("failures", str(found["failed"]))
    element.set("errors", str(found["error"] + found["invalid"]))
    element.set("skipped", "0")
    element.set("time", f"{sum(one.seconds for one in results):.3f}")


def _case(suite: Element, result: Result) -> None:
    path = PurePath(result.path)
    case = SubElement(
        suite,
        "testcase",
        classname=".".join(path.parent.parts) or ".",
        name=path.name,
        file=path.as_posix(),
        time=f"{result.seconds:.3f}",
    )
    if result.status == "passed":
        return
    lines = [one.place.line for one in result.failures if one.place.file == result.path]
    if lines:
        case.set("line", str(lines[0]))
    first = result.failures[0].message if result.failures else "The table is another one."
    told = SubElement(
        case,
        "failure" if result.status == "failed" else "error",
        type=result.status,
        message=ILLEGAL.sub("\ufffd", first),
    )
    told.text = ILLEGAL.sub("\ufffd", format_result(result))


def cobertura(coverage: Coverage) -> bytes:
    """Coverage as Cobertura's XML: a class for each document, a line for each that has points."""
    points = sum(len(one.points) for one in coverage.values())
    reached = sum(len(one.reached) for one in coverage.values())
    rate = f"{total(coverage) / 100:.4f}"
    root = Element("coverage", {"line-rate": rate, "branch-rate": "0", "version": "1"})
    root.set("lines-valid", str(points))
    root.set("lines-covered", str(reached))
    for name in ("branches-valid", "branches-covered", "complexity", "timestamp"):
        root.set(name, "0")
    SubElement(SubElement(root, "sources"), "source").text = "."
    shared = {"line-rate": rate, "branch-rate": "0", "complexity": "0"}
    package = SubElement(SubElement(root, "packages"), "package", {"name": ".", **shared})
    classes = SubElement(package, "classes")
    for name, one in sorted(coverage.items()):
        _document(classes, name, one)
    return _written(root)


def _document(classes: Element, name: str, covered: Covered) -> None:
    rate = f"{covered.percent / 100:.4f}"
    shown = ILLEGAL.sub("\ufffd", PurePath(name).as_posix())
    one = SubElement(classes, "class", {"name": shown, "filename": shown, "line-rate": rate})
    one.set("branch-rate", "0")
    one.set("complexity", "0")
    SubElement(one, "methods")
    lines = SubElement(one, "lines")
    missed = {point.line for point in covered.missing}
    for number in sorted({point.line for point in covered.points}):
        SubElement(lines, "line", number=str(number), hits=str(int(number not in missed)))


def _written(root: Element) -> bytes:
    indent(root)
    text: str = tostring(root, "unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()
