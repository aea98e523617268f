"""MCAP (Foxglove): a channel for each tier, and one for the records themselves.

Log times are nanoseconds of the run.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from heapq import merge
from typing import IO, Any

from prima.errors.visible import escaped
from prima.exports.timeline import COLUMNS, TierPart, Timeline, clean, unused
from prima.messages import Json, Record
from prima.transcript.record import model

ENCODER = json.JSONEncoder(ensure_ascii=False)
MS = 1_000_000
"""Nanoseconds per millisecond."""
MARK: dict[str, Json] = {
    "type": "object",
    "title": "prima.Mark",
    "properties": {
        "text": {"type": "string", "description": "What it is; empty when it is over."},
        "active": {"type": "boolean", "description": "Whether it begins (or is a point) here."},
        "start": {"type": "number", "description": "Seconds of the run."},
        "end": {"type": "number", "description": "Seconds of the run."},
        **{name: {"type": "string"} for name in COLUMNS},
    },
}
"""The JSON Schema of a tier's messages."""

Message = tuple[int, int, str, bytes]
"""Time (ms), order at that time, topic, message."""


class _Counting:
    """A stream that counts bytes, for pipes, which have no position."""

    def __init__(self, out: IO[bytes]) -> None:
        self._out = out
        self._count = 0

    def write(self, data: bytes) -> int:
        self._out.write(data)
        self._count += len(data)
        return len(data)

    def tell(self) -> int:
        return self._count

    def flush(self) -> None:
        self._out.flush()


def write(timeline: Timeline, records: Iterable[Record], version: str, out: IO[bytes]) -> None:
    """Write the file; ``records`` are the transcript's, read once more."""
    from mcap.writer import Writer

    writer = Writer(_Counting(out))  # type: ignore[arg-type]
    writer.start(profile="", library=f"prima {version}")
    schemas = {
        schema["title"]: writer.register_schema(schema["title"], "jsonschema", _dumps(schema))
        for schema in (MARK, record_schema())
    }
    topics = _topics(timeline)
    channels = {
        topic: writer.register_channel(topic, "json", schemas["prima.Mark"]) for topic, _ in topics
    }
    channels["/records"] = writer.register_channel("/records", "json", schemas["prima.Record"])
    sequences = dict.fromkeys(channels, 0)
    marks = (_mark_messages(topic, part) for topic, part in topics)
    for time, _, topic, data in merge(*marks, _record_messages(records)):
        writer.add_message(channels[topic], time * MS, data, time * MS, sequences[topic])
        sequences[topic] += 1
    if timeline.head:
        writer.add_attachment(0, 0, "run.json", "application/json", _dumps(timeline.head))
        writer.add_metadata("prima", {clean(k): _plain(v) for k, v in timeline.head.items()})
    writer.finish()  # type: ignore[no-untyped-call]


def record_schema() -> dict[str, Json]:
    """The records' JSON Schema; each field has one type, since readers do not support several."""
    properties: dict[str, Json] = {}
    for name, field in model().model_json_schema()["properties"].items():
        kinds = [kind for kind in field.get("anyOf", [field]) if kind["type"] != "null"]
        kept = {key: kinds[0][key] for key in ("type", "items", "enum") if key in kinds[0]}
        properties[name] = {**kept, "description": field.get("description", "")}
    return {"type": "object", "title": "prima.Record", "properties": properties}


def _topics(timeline: Timeline) -> list[tuple[str, TierPart]]:
    """The topic of each part of a tier, such as ``/navigate/says``."""
    names = {"/records"}
    return [
        (unused("/" + part.name.replace(": ", "/").replace(" ", "_"), names), part)
        for part in timeline.parts()
    ]


def _mark_messages(topic: str, part: TierPart) -> Iterator[Message]:
    """A message at the start of each mark, and one at its end unless the next begins then.

    An interval of no duration is over after 1 ms: else it would last until the next one.
    """
    marks = part.marks
    for number, mark in enumerate(marks):
        times: dict[str, Json] = {"start": mark.start / 1000, "end": mark.end / 1000}
        value = {"text": mark.text, "active": True, **times, **mark.about}
        yield (mark.start, 1, topic, _dumps(value))
        end = max(mark.end, mark.start + 1)
        follows = number + 1 < len(marks) and marks[number + 1].start <= end
        if not part.tier.points and not follows:
            yield (end, 0, topic, _dumps({"text": "", "active": False, **times}))


def _record_messages(records: Iterable[Record]) -> Iterator[Message]:
    last = 0
    for number, record in enumerate(records, 2):
        last = max(last, round(record["time"] * 1000))
        yield (last, number, "/records", _dumps(record))


def _plain(value: Json) -> str:
    return clean(value if isinstance(value, str) else json.dumps(value, ensure_ascii=False))


def _dumps(value: Any) -> bytes:
    return escaped(ENCODER.encode(value)).encode("utf-8", "replace")
