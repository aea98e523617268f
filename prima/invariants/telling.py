"""Fields common to records: their application, stream, Command and rule."""

from __future__ import annotations

from prima.invariants.memory import Memory
from prima.invariants.model import Record, base

ALONE = {
    "window": "C3",
    "leave": "O3",
    "stream-end": "C1",
    "suspend": "C2",
    "resume": "C2",
    "stop": "F5",
    "interrupt": "X2",
    "held": "X3",
    "substitute": "X6",
}
"""Phases that always have the same rule."""
SAME = ("app", "tree", "command", "text", "unit")
"""Fields that every record of an AB shares with its request."""


def tells_rightly(memory: Memory, record: Record) -> None:
    """Check a record before it is processed."""
    phase = record["phase"]
    rule = ALONE.get(phase)
    if rule is not None and record.get("rule") != rule:
        memory.report(13, rule, f"a {phase} has the rule {record.get('rule')}")
    name = base(record.get("winner") or record.get("behavior") or "")
    if phase == "request":
        memory.requests.setdefault(name, record)
    elif name in memory.requests:
        _check_repeated(memory, record, name)
    tree = record.get("tree")
    if tree is not None and record["app"] != tree.rpartition(":")[0]:
        memory.report(13, "C1", f"a {phase} of {tree} has the application {record['app']}")


def _check_repeated(memory: Memory, record: Record, name: str) -> None:
    request = memory.requests[name]
    for field in SAME:
        value = record.get(field)
        if value is not None and value != request.get(field):
            text = f"a {record['phase']} of {name} has the {field} {value}"
            memory.report(13, "U1", f"{text}, not {request.get(field)}")
