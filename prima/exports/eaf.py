"""ELAN's annotation format, EAF 3.0 (Max Planck Institute for Psycholinguistics)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from datetime import datetime
from itertools import chain
from xml.sax.saxutils import escape, quoteattr

from prima.exports.timeline import KINDS, TierPart, Timeline, clean, unused

MARK_MS = 200
"""Duration (ms) of a point, unless the next comes earlier: EAF has no points."""
UNKNOWN = "und"
"""The code of an unknown language (ISO 639-3)."""

CHILDREN = {
    "does": ("rule", "behavior", "outcome"),
    "streams": ("rule",),
    "why": ("rule", "behavior", "losers"),
    "reactions": ("event", "seconds"),
}
"""Details with tiers of their own, each associated with its annotation."""

CONSTRAINTS = {
    "Time_Subdivision": "Time subdivision of parent annotation's time interval,"
    " no time gaps allowed within this interval",
    "Symbolic_Subdivision": "Symbolic subdivision of a parent annotation."
    " Annotations refering to the same parent are ordered",
    "Symbolic_Association": "1-1 association with a parent annotation",
    "Included_In": "Time alignable annotations within the parent annotation's time interval,"
    " gaps are allowed",
}
"""ELAN's four stereotypes of dependent tiers, with the descriptions that it expects."""


def write(timeline: Timeline, languages: dict[str, str]) -> Iterator[str]:
    """The document, in pieces.

    ``languages`` has the language tags of applications; the empty name means the user
    and all others. Those of the transcript come second.
    """
    languages = {**({} if "" in languages else timeline.languages), **languages}
    parts = timeline.parts()
    children = [(part, column) for part in parts for column in _details(part)]
    rules = sorted(_rules(part for part, _ in children))
    details = sum(_count(part, column) for part, column in children)
    yield from _head(timeline, timeline.marks + details)
    slots = _Slots(parts)
    yield from slots.write()
    firsts: dict[str, int] = {}
    number = 1
    for part in parts:
        firsts[part.name] = number
        yield from _tier(part, number, slots, languages)
        number += len(part.marks)
    names = {part.name for part in parts}
    for part, column in children:
        child = unused(f"{part.name} {column}", names)
        yield from _child(part, firsts[part.name], child, column, number, rules)
        number += _count(part, column)
    yield from _types(rules, {tag for tag in languages.values() if tag})


def _rules(parts: Iterable[TierPart]) -> set[str]:
    marks = chain.from_iterable(part.marks for part in parts)
    return {mark.about["rule"] for mark in marks if "rule" in mark.about}


def _details(part: TierPart) -> list[str]:
    """The details of a tier's annotations that have tiers of their own."""
    columns = CHILDREN.get(part.tier.kind, ())
    return [one for one in columns if any(one in mark.about for mark in part.marks)]


def _count(part: TierPart, column: str) -> int:
    """The number of marks with a detail."""
    return sum(column in mark.about for mark in part.marks)


def _head(timeline: Timeline, annotations: int) -> Iterator[str]:
    yield (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ANNOTATION_DOCUMENT AUTHOR="prima" DATE="{_date(timeline.head.get("date"))}"'
        ' FORMAT="3.0" VERSION="3.0" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        ' xsi:noNamespaceSchemaLocation="http://www.mpi.nl/tools/elan/EAFv3.0.xsd">\n'
        '<HEADER MEDIA_FILE="" TIME_UNITS="milliseconds">\n'
    )
    for name in ("scenario", "policy", "version"):
        if timeline.head.get(name):
            yield f'<PROPERTY NAME="prima.{name}">{escape(clean(timeline.head[name]))}</PROPERTY>\n'
    yield f'<PROPERTY NAME="lastUsedAnnotationId">{annotations}</PROPERTY>\n</HEADER>\n'


def _date(value: object) -> str:
    """The run's own date, so that one transcript gives one file."""
    try:
        date = datetime.fromisoformat(str(value))
    except ValueError:
        date = datetime(1970, 1, 1)
    return f"{date.replace(microsecond=0, tzinfo=None).isoformat()}Z"


class _Slots:
    """Two time slots for each annotation: annotations that share a slot would move together."""

    def __init__(self, parts: list[TierPart]) -> None:
        times: list[tuple[int, int]] = []
        for part in parts:
            for place, mark in enumerate(part.marks):
                times.append((mark.start, len(times)))
                times.append((_end(part, place), len(times)))
        times.sort()
        self._times = [time for time, _ in times]
        self._ids = [0] * len(times)
        for number, (_, index) in enumerate(times, 1):
            self._ids[index] = number

    def write(self) -> Iterator[str]:
        """All slots, by time."""
        yield "<TIME_ORDER>\n"
        for number, time in enumerate(self._times, 1):
            yield f'<TIME_SLOT TIME_SLOT_ID="ts{number}" TIME_VALUE="{time}"/>\n'
        yield "</TIME_ORDER>\n"

    def of(self, annotation: int) -> tuple[int, int]:
        """The numbers of the slots of an annotation, which are counted from 1."""
        return self._ids[2 * annotation - 2], self._ids[2 * annotation - 1]


def _end(part: TierPart, place: int) -> int:
    """The end of an annotation; a point is extended."""
    mark = part.marks[place]
    if mark.end > mark.start:
        return mark.end
    after = part.marks[place + 1 : place + 2]
    return min([mark.start + MARK_MS, *(one.start for one in after)])


def _tier(part: TierPart, first: int, slots: _Slots, languages: dict[str, str]) -> Iterator[str]:
    tier = part.tier
    tag = languages.get(tier.who) or languages.get("", "")
    lang = f' LANG_REF="{tag}"' if tag and tier.kind in ("says", "user-says") else ""
    yield (
        f"<TIER TIER_ID={quoteattr(part.name)} PARTICIPANT={quoteattr(tier.who)}"
        f' ANNOTATOR="prima" LINGUISTIC_TYPE_REF="{tier.kind}"{lang}>\n'
    )
    for number, mark in enumerate(part.marks, first):
        begin, end = slots.of(number)
        yield (
            f'<ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="a{number}"'
            f' TIME_SLOT_REF1="ts{begin}" TIME_SLOT_REF2="ts{end}">'
            f"<ANNOTATION_VALUE>{escape(mark.text)}</ANNOTATION_VALUE>"
            "</ALIGNABLE_ANNOTATION></ANNOTATION>\n"
        )
    yield "</TIER>\n"


def _child(
    part: TierPart, first: int, name: str, column: str, number: int, rules: list[str]
) -> Iterator[str]:
    """A tier with one detail of a part's annotations, numbered from ``number``."""
    kind = "rule" if column == "rule" else "detail"
    entries = {rule: place for place, rule in enumerate(rules, 1)}
    yield (
        f"<TIER TIER_ID={quoteattr(name)} PARENT_REF={quoteattr(part.name)}"
        f' PARTICIPANT={quoteattr(part.tier.who)} ANNOTATOR="prima" LINGUISTIC_TYPE_REF="{kind}">\n'
    )
    for above, mark in enumerate(part.marks, first):
        if column not in mark.about:
            continue
        value = mark.about[column]
        entry = f' CVE_REF="cve{entries[value]}"' if kind == "rule" else ""
        yield (
            f'<ANNOTATION><REF_ANNOTATION ANNOTATION_ID="a{number}" ANNOTATION_REF="a{above}"'
            f"{entry}><ANNOTATION_VALUE>{escape(value)}</ANNOTATION_VALUE>"
            "</REF_ANNOTATION></ANNOTATION>\n"
        )
        number += 1
    yield "</TIER>\n"


def _types(rules: list[str], tags: set[str]) -> Iterator[str]:
    """The types of tiers, the languages, and the rules as a vocabulary."""
    for kind in KINDS:
        yield (
            f'<LINGUISTIC_TYPE LINGUISTIC_TYPE_ID="{kind}" TIME_ALIGNABLE="true"'
            ' GRAPHIC_REFERENCES="false"/>\n'
        )
    for kind, more in (("rule", ' CONTROLLED_VOCABULARY_REF="rules"'), ("detail", "")):
        yield (
            f'<LINGUISTIC_TYPE LINGUISTIC_TYPE_ID="{kind}" TIME_ALIGNABLE="false"'
            f' CONSTRAINTS="Symbolic_Association" GRAPHIC_REFERENCES="false"{more}/>\n'
        )
    for tag in sorted(tags | {UNKNOWN}):
        label = "undetermined" if tag == UNKNOWN else tag
        yield f'<LANGUAGE LANG_ID="{tag}" LANG_LABEL="{label}"/>\n'
    for stereotype, description in CONSTRAINTS.items():
        yield f'<CONSTRAINT STEREOTYPE="{stereotype}" DESCRIPTION="{description}"/>\n'
    yield '<CONTROLLED_VOCABULARY CV_ID="rules">\n'
    yield f'<DESCRIPTION LANG_REF="{UNKNOWN}">Rules of mediation</DESCRIPTION>\n'
    for place, rule in enumerate(rules, 1):
        yield (
            f'<CV_ENTRY_ML CVE_ID="cve{place}"><CVE_VALUE LANG_REF="{UNKNOWN}">{escape(rule)}'
            "</CVE_VALUE></CV_ENTRY_ML>\n"
        )
    yield "</CONTROLLED_VOCABULARY>\n</ANNOTATION_DOCUMENT>\n"
