"""Test results as JUnit XML, and coverage as Cobertura XML."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby
from pathlib import PurePath
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from prima.errors.visible import visible
from prima.testing.coverage import Coverage, DocumentCoverage
from prima.testing.running import Result
from prima.testing.summary import counts, format_result


def junit(results: Iterable[Result]) -> bytes:
    """Results as JUnit XML: a suite per folder, a case per scenario."""
    held = sorted(results, key=lambda one: (_folder(one), one.path))
    root = Element("testsuites", name="prima")
    _totals(root, held)
    for folder, group in groupby(held, key=_folder):
        cases = list(group)
        suite = SubElement(root, "testsuite", name=visible(folder))
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
        classname=visible(".".join(path.parent.parts)) or ".",
        name=visible(path.name),
        file=visible(path.as_posix()),
        time=f"{result.seconds:.3f}",
    )
    if result.status == "passed":
        return
    lines = [one.place.line for one in result.failures if one.place.file == result.path]
    if lines:
        case.set("line", str(lines[0]))
    first = result.failures[0].message if result.failures else "The table differs."
    element = SubElement(
        case,
        "failure" if result.status == "failed" else "error",
        type=result.status,
        message=visible(first),
    )
    element.text = visible(format_result(result), "\n")


def cobertura(coverage: Coverage) -> bytes:
    """Coverage as Cobertura XML: a class per document, a line for each line with points.

    A line is hit if all its points were reached.
    """
    lines = {name: _hits(one) for name, one in sorted(coverage.items())}
    every = [hit for held in lines.values() for hit in held.values()]
    root = Element("coverage", {"version": "1", **_rates(every)})
    root.set("lines-valid", str(len(every)))
    root.set("lines-covered", str(sum(every)))
    for name in ("branches-valid", "branches-covered", "timestamp"):
        root.set(name, "0")
    SubElement(SubElement(root, "sources"), "source").text = "."
    package = SubElement(SubElement(root, "packages"), "package", {"name": ".", **_rates(every)})
    classes = SubElement(package, "classes")
    for name, held in lines.items():
        shown = visible(PurePath(name).as_posix())
        attributes = {"name": shown, "filename": shown, **_rates(list(held.values()))}
        one = SubElement(classes, "class", attributes)
        SubElement(one, "methods")
        inside = SubElement(one, "lines")
        for number, hit in held.items():
            SubElement(inside, "line", number=str(number), hits=str(int(hit)))
    return _written(root)


def _hits(covered: DocumentCoverage) -> dict[int, bool]:
    """The lines with points, and whether all points of each were reached."""
    missed = {point.line for point in covered.missing}
    return {line: line not in missed for line in sorted({one.line for one in covered.points})}


def _rates(hits: list[bool]) -> dict[str, str]:
    rate = sum(hits) / len(hits) if hits else 1.0
    return {"line-rate": f"{rate:.4f}", "branch-rate": "0", "complexity": "0"}


def _written(root: Element) -> bytes:
    indent(root)
    text: str = tostring(root, "unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()
