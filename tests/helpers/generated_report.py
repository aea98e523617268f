"""A long run for the tests of the report: made up, but with all that a run's records have."""

from __future__ import annotations

from prima import api
from prima.messages import Record


def long_run(rows: int) -> api.Transcript:
    """A transcript of two applications that take turns, with so many rows or a few more."""
    records: list[Record] = [
        {
            "time": 0.0,
            "phase": "run",
            "actor": "mediator",
            "data": {"version": "1.0.0", "scenario": "long", "policy": "prima", "files": {}},
        }
    ]
    time, apps = 0.0, ("guide", "follow")
    for app in apps:
        records.append({"time": time, "phase": "load", "actor": "mediator", "app": app})
    for number in range(1, rows + 1):
        app, other = apps[number % 2], apps[(number + 1) % 2]
        behavior, tree = f"{app}#{number}", f"{app}:{number // 50 + 1}"
        about: Record = {"app": app, "behavior": behavior, "tree": tree, "command": "speak"}
        text = f"Sentence {number} of a long tour through the museum."
        if number % 10 == 0:
            records.append(
                {"time": time, "phase": "event", "actor": "user", "event": "touch.head",
                 "serial": number, "data": {"sensor": "head"}, "inbound": True}
            )  # fmt: skip
        records.append(
            {"time": time, "phase": "request", "actor": "robot", **about, "text": text,
             "devices": ["speaker"], "priority": "high", "reactive": number % 10 == 0,
             "source": f"{app}.xml:{number % 200 + 1}"}
        )  # fmt: skip
        records.append(
            {"time": time, "phase": "decision", "actor": "mediator", "app": app, "rule": "S2c",
             "winner": behavior, "losers": [f"{other}#{number - 1}"] if number > 1 else [],
             "losers_count": int(number > 1)}
        )  # fmt: skip
        records.append(
            {"time": time, "phase": "start", "actor": "robot", **about, "text": text,
             "devices": ["speaker"], "rule": "S2c"}
        )  # fmt: skip
        time = round(time + 2.5, 3)
        records.append(
            {"time": time, "phase": "end", "actor": "robot", **about, "outcome": "done",
             "data": {"x": number % 40 / 4, "y": number % 7 / 2, "heading": number % 360 * 1.0}}
        )  # fmt: skip
        if number % 50 == 49:
            records.append(
                {"time": time, "phase": "stream-end", "actor": "mediator", "app": app, "tree": tree}
            )
    records.append({"time": time, "phase": "over", "actor": "mediator", "outcome": "over"})
    return api.Transcript(records, "long.jsonl")
