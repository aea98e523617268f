"""Corruptions of the records of sound runs: each tells a falsehood."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from prima.invariants import check
from prima.language.commands import PATIENCE_MS
from prima.messages import Emergency, Inbound, Occurred
from tests.helpers.generated.plays import Play, perform
from tests.helpers.generated.scripts import Script, drive
from tests.helpers.generated.world import APPS, World

Records = list[dict[str, Any]]
Corruption = Callable[[Records], Records]

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="{}">{}</prima>'
SAY = "<speak>{}</speak>"


def play(*bodies: str, events: tuple[tuple[int, Inbound], ...] = (), silent: int = 0) -> Play:
    documents = tuple(HEAD.format(name, body) for name, body in zip(APPS, bodies, strict=False))
    return Play(documents, (0,) * len(documents), events, World(1, silent=silent, endless=True))


def form(content: str, handlers: str = "") -> str:
    return f'<form id="f1"><block>{content}</block>{handlers}</form>'


def on(event: str, content: str) -> str:
    return f'<on event="{event}">{content}</on>'


def at(time: int, name: str = "touch") -> tuple[int, Inbound]:
    return time, Occurred(name, "user")


TOPIC = form(SAY.format("One") + '<move-head pan="10"/>' + SAY.format("Two"))
REACTS = '<form id="f1">' + on("touch", '<turn angle="5"/>' + SAY.format("Yes")) + "</form>"
MOVES = form('<topological-move to="room"/>')
TRACKS = form("<tracking-human/>")
TWO = form(SAY.format("One") + SAY.format("Two"))
SPEAKS = '<form id="f1">' + on("touch", SAY.format("Yes.")) + "</form>"
WAITS = form(SAY.format("Me."), on("touch", SAY.format("Yes.")))
ASKS = (
    '<form id="f1"><field name="q" type="boolean"><prompt>Well?</prompt>'
    "<filled><speak>Good.</speak><face-human/></filled></field></form>"
)
UNIT = form('<iu><speak>In.</speak><turn angle="1"/></iu>')
IDLE = '<form id="f1"/>'
BOTH = form(SAY.format("Me."))

BROKEN = play(form('<move-head pan="1"/>' + SAY.format("Mine.")), REACTS, events=(at(100),))
"""The reaction takes the floor, suspends, and gives it back."""
SUSPENDED = play(TRACKS, REACTS, events=(at(20),))
RIVALS = play(BOTH, BOTH)
PRESSED = play(
    form(SAY.format("Long.") + SAY.format("More.")),
    IDLE,
    events=((10, Emergency(True)), (50, Emergency(False, False))),
)


LEFT = play(
    form(
        SAY.format("Long.") + SAY.format("More."),
        on("touch", '<goto next="#f2"/>'),
    )
    + '<form id="f2"><block><speak>New.</speak></block></form>',
    IDLE,
    events=(at(10),),
)
"""A touch leaves a state in which one sentence is said and another waits (O3)."""
LEFT_LOOPING = play(
    form("<tracking-human/>", on("touch", '<goto next="#f2"/>')) + '<form id="f2"/>',
    IDLE,
    events=(at(20),),
)
LEFT_DONE = play(
    form(SAY.format("Done.") + '<goto next="#f2"/>')
    + '<form id="f2"><block><speak>New.</speak><exit/></block></form>',
    IDLE,
)
"""Nothing is left to cancel when a state is left, nor when its application ends."""
LEFT_ASKING = play(
    ASKS.replace("</form>", on("touch", '<goto next="#f2"/>') + "</form>") + '<form id="f2"/>',
    IDLE,
    events=(at(10),),
    silent=100,
)


def indexes(records: Records, **fields: Any) -> list[int]:
    return [
        index
        for index, record in enumerate(records)
        if all(record.get(name) == value for name, value in fields.items())
    ]


def change(number: int, match: dict[str, Any], **new: Any) -> Corruption:
    """Change the fields of the record that matches as the ``number``-th one."""

    def changed(records: Records) -> Records:
        records[indexes(records, **match)[number]].update(new)
        return records

    return changed


def drop(number: int, **match: Any) -> Corruption:
    def dropped(records: Records) -> Records:
        del records[indexes(records, **match)[number]]
        return records

    return dropped


def double(new: dict[str, Any], **match: Any) -> Corruption:
    """Put a record behind the first that matches, which differs from it in some fields."""

    def doubled(records: Records) -> Records:
        index = indexes(records, **match)[0]
        return [*records[: index + 1], {**records[index], **new}, *records[index + 1 :]]

    return doubled


def moved(match: dict[str, Any], behind: dict[str, Any]) -> Corruption:
    """Put the first record that matches behind another."""

    def put(records: Records) -> Records:
        record = records.pop(indexes(records, **match)[0])
        index = indexes(records, **behind)[0] + 1
        return [*records[:index], record, *records[index:]]

    return put


def cut(**match: Any) -> Corruption:
    """End the records behind the first that matches."""
    return lambda records: records[: indexes(records, **match)[0] + 1]


def both(one: Corruption, other: Corruption) -> Corruption:
    return lambda records: other(one(records))


@dataclass(frozen=True)
class Falsehood:
    """A corruption of a sound run, and what is found: its beginning, and words of it."""

    name: str
    made: Play | Script
    corrupt: Corruption
    found: str
    says: str = ""
    policy: str = "prima"
    patience: int = PATIENCE_MS

    def records(self) -> Records:
        """Those of the sound run."""
        if isinstance(self.made, Play):
            run = perform(self.made, self.policy, patience=self.patience)
        else:
            run = drive(self.made, self.policy, self.patience)
        return [dict(record) for record in run.records]

    def is_found(self) -> None:
        """Check that the sound run is sound, and the falsehood found."""
        assert self._check(self.records()) == []
        found = self._check(self.corrupt(self.records()))
        begins = f"invariant {self.found}"
        assert any(one.startswith(begins) and self.says in one for one in found), found

    def _check(self, records: Records) -> list[str]:
        return check(records, self.policy, APPS, self.patience)
