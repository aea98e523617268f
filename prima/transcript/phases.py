"""The phases of a transcript's records: the meaning of each, and the fields that it needs."""

from __future__ import annotations

from typing import NamedTuple


class Phase(NamedTuple):
    """A phase's meaning, its notable fields, and its required ones."""

    meaning: str
    notable: str
    needed: tuple[str, ...] = ()


PHASES = {
    "run": Phase("the run begins", "`data`", ("data",)),
    "load": Phase(
        "an application starts; once as inbound, once by the mediator", "`app`", ("app",)
    ),
    "unload": Phase("an application has ended or is unloaded", "`outcome`: why", ("app",)),
    "request": Phase(
        "an AB enters working memory",
        "`behavior`, `tree`, `command`, `text`, `args`, `extra`, `parent`, `parents`, "
        "`devices`, `priority`, `reactive`, `cause`, `feedback`, `leaves`, `engages`, `order`, "
        "`state`, `unit`, `inserted`, `before`, `restartable`, `hold`, `connect`, `fresh`, `spans`, "
        "`words`, `motion`, `source`",
        ("behavior", "command", "app", "tree", "priority"),
    ),
    "decision": Phase(
        "a selection; losers could have started in the winner's place",
        "`winner`, `rule`, `losers`, `losers_count`",
        ("winner", "rule", "losers", "losers_count"),
    ),
    "start": Phase(
        "an AB starts",
        "`behavior`, `devices`, `reactive`, `cause`, `resumed`, `rule`",
        ("behavior", "command", "app"),
    ),
    "end": Phase(
        "an AB ends by itself; `outcome` is `again` for a loop that another follows",
        "`outcome`, `goal`, `data`",
        ("behavior", "command", "app"),
    ),
    "cancel": Phase(
        "an AB is deleted, or halted by the emergency stop",
        "`rule`, `outcome`: the state it was in",
        ("behavior",),
    ),
    "fail": Phase("an AB fails, or a Command is refused", "`event`, `device`, `message`, `rule`"),
    "hold": Phase("a waiting AB may not start", "`rule`, `by`", ("behavior", "rule", "by")),
    "suspend": Phase("a stream is suspended by another", "`tree`, `by`, `rule`", ("tree", "app")),
    "resume": Phase("a suspended stream resumes", "`tree`, `behavior`, `rule`", ("tree", "app")),
    "floor": Phase("the floor is taken or returned", "`tree`, `outcome`, `floor`, `rule`"),
    "window": Phase(
        "an application begins or finishes handling the end of its Command", "`tree`, `outcome`"
    ),
    "leave": Phase(
        "an application has left a state of its document", "`state`, `rule`", ("app", "state")
    ),
    "stream-end": Phase("a stream ends", "`tree`", ("tree",)),
    "stop": Phase("the body is stopped, since nothing keeps it moving", "`behavior`, `rule`"),
    "collision": Phase(
        "without a mediator: an AB loses a device", "`by`, `device`", ("behavior", "by")
    ),
    "starve": Phase(
        "an AB has waited for another application for many loops of its feedback Command (E4), "
        "or for as long as the run's `patience` (E6)",
        "`behavior`, `by`, `rule`: why it waits, E6 if its turn is next; `loop`, or `data`: "
        "`waited` (s)",
        ("behavior",),
    ),
    "emergency": Phase(
        "the emergency stop is pressed or released", "`outcome`, `serial`", ("outcome",)
    ),
    "listening": Phase("a question has been said, and listens", "`behavior`", ("behavior",)),
    "held": Phase(
        "a stream is kept open for an event, or no longer (x3)",
        "`tree`, `outcome`: `begun`, `joined`, `left` or `over`; `data`: until when (s)",
    ),
    "interrupt": Phase(
        "a restartable AB yields to a reaction (x2)",
        "`behavior`, `by`, `rule`",
        ("behavior", "command"),
    ),
    "halted": Phase(
        "the device reports how much of it was done",
        "`behavior`, `data`: `done` (0 to 1), `heard`; of a motion, the pose; of what has marks, "
        "`mark` and how many were `passed`",
        ("behavior",),
    ),
    "delayed": Phase(
        "what an AB begins was held back until a device had stopped what it did before",
        "`behavior`, `device`, `data`: `waited` (s)",
        ("behavior", "device", "data"),
    ),
    "device": Phase(
        "a device is missing from now on, or available again",
        "`device`, `outcome`: `missing` or `back`; `message`: why",
        ("device", "outcome"),
    ),
    "substitute": Phase(
        "another Command takes the place of one that the robot lacks (x6)", "`command`, `by`"
    ),
    "event": Phase(
        "an event, or what the user says (`speech`, with `text`; where the recogniser is not "
        "sure, `data` has `confidence`, and `alternatives` with `text` and `confidence` of "
        "each; where there are several persons, `person` for who speaks or touches)",
        "`event`, `serial`, `data`",
        ("event",),
    ),
    "fetched": Phase("the answer to an application's request to a URI", "`data`", ("app", "data")),
    "transferred": Phase(
        "what has become of a call",
        "`serial`, `outcome`, `data`",
        ("app", "serial", "outcome", "data"),
    ),
    "sensed": Phase(
        "sensor values have changed, if some document uses any: at first all of them, then those used",
        "`data`",
        ("data",),
    ),
    "note": Phase("a remark for the reader", "`text`", ("text",)),
    "send": Phase(
        "a message to a service or a URI; a call to somebody, or its end, where `data` has "
        "`transfer`",
        "`data`, `serial`",
        ("app", "data"),
    ),
    "log": Phase("what a `log` element says", "`message`, `source`", ("message",)),
    "error": Phase("an error that no handler took", "`message`, `source`"),
    "over": Phase("the run has ended", "`outcome`: `over`, `quiet`, `until` or `limit`"),
}
"""The phases by name."""
