"""The simulated robot: how fast time passes, and what a long day costs."""

from __future__ import annotations

import os
import tempfile
from collections import Counter
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

from bench import long
from bench.fresh import check

if TYPE_CHECKING:
    from prima.messages import Record
    from prima.sim.rehearsal import Rehearsal

HOUR = 3_600_000
VISIT = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visits"
    world="{documents}/worlds/room.xml" robot="{documents}/robots/papero.xml">
  <robot at="middle"/>
  <person x="4.6" y="0" speed="2"/>
  <application src="{documents}/fa/emotions.xml" kind="fa"/>
  <when at="1s">
    <walk x="1" y="0"/><touch sensor="head"/><wait for="5s"/><walk x="4.6" y="0"/>
  </when>
</scenario>"""


def situation(number: int, seconds: float) -> float:
    """Simulated seconds a second of the processor's time, of one of the ten situations, physics on.

    Many runs are made, and the median counts: what else the machine does lengthens some of them.

    It has to go as its author expects: see the table beside it. Records are made and dropped.
    """
    from prima import api
    from prima.experiments.study import situations
    from prima.transcript.table import read_table

    path = situations()[number - 1]
    first = api.rehearse(path)
    expected = read_table(path.with_suffix(".txt").read_text(encoding="utf-8"))
    said = Counter(row.what for row in first.rows() if row.actor == "R")
    missing = Counter(row.what for row in expected if row.actor == "R") - said
    check(not missing and not first.failures, f"{path.stem}: {missing} {first.failures}")
    return long.speed(path, seconds)


def ten_situations(seconds: float) -> float:
    """The median of what the ten situations reach in one process."""
    return median(long.situations(seconds).values())


class Quiet:
    """A robot whose user comes, touches it, and goes away; otherwise nothing changes."""

    def __init__(self) -> None:
        from prima import api
        from prima.scheduler.policy import policy_named
        from prima.sim.rehearsal import Rehearsal

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "visits.xml")
            path.write_text(VISIT.format(documents=api.documents_folder().resolve()))
            cast = api.load_scenario(path).cast
        (visit,) = cast.scenario.whens
        self.visit = visit.doings
        cast.scenario.whens.clear()
        self.rehearsal: Rehearsal = Rehearsal(cast, policy_named("prima"))
        self.seen: Counter[str] = Counter()
        self.instants = 0
        """How many instants were computed."""
        self.rehearsal.devices.watcher = self._count

    def _count(self) -> None:
        self.instants += 1

    def until(self, time: int) -> int:
        """Let time pass; gives how many instants were computed."""
        from prima.transcript.lines import line

        before = self.instants
        with open(os.devnull, "w", encoding="utf-8") as nowhere:
            while (records := self.rehearsal.advance(time)) is not None:
                for record in records:
                    nowhere.write(line(record))
                    self.seen[told(record)] += 1
        check(not self.rehearsal.outcome, f"the run has ended: {self.rehearsal.outcome}")
        return self.instants - before

    def come(self, time: int) -> None:
        """The user comes at that time."""
        self.rehearsal.devices.play(time, self.visit)

    def check(self, visits: int) -> None:
        """Whether every visit was seen and answered.

        Raises:
            WrongAnswer: one was not.
        """
        for what in ("human.found", "touch.head", "end That feels good.", "human.lost"):
            check(self.seen[what] == visits, f"{what}: {self.seen[what]} times, not {visits}")


def told(record: Record) -> str:
    """The subject of a record, to count those of a visit."""
    if record["phase"] == "event":
        return str(record["event"])
    return f"{record['phase']} {record.get('text')}"


def visits_memory(hours: float) -> float:
    """Megabytes that memory grows from a tenth of the hours to their end, with many visits."""
    tenth, end, _ = long.memory(hours)
    return end - tenth


def quiet(hours: int) -> float:
    """Instants computed in hours in which nothing changes; a user comes before and after them."""
    run = Quiet()
    run.come(1)
    check(run.until(HOUR) > 10, "nothing was computed while the user was there")
    instants = run.until((hours + 1) * HOUR)
    run.come((hours + 1) * HOUR + 1)
    run.until((hours + 2) * HOUR)
    run.check(2)
    return instants
