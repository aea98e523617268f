"""A robot that runs for days, and the ten situations: what they cost.

``python -m bench.long [HOURS]`` prints both.
"""

from __future__ import annotations

import gc
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median
from time import process_time
from typing import TYPE_CHECKING

from bench.fresh import check
from bench.workloads import memory as memory_now

if TYPE_CHECKING:
    from prima.api import Loaded

HOUR = 3600
EVERY = 180
"""Seconds after which the user comes back: twenty times an hour."""

HOST = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="host" xml:lang="en">
  <watch name="near" when="sensor.human.visible &amp;&amp; sensor.human.distance &lt; 1.3"/>
  <var name="visits" expr="0"/>
  <form id="wait">
    <on event="near"><assign name="visits" expr="visits + 1"/><goto next="#greet"/></on>
    <on event="human.lost"><goto next="#home"/></on>
  </form>
  <form id="home">
    <block>
      <set-position-and-direction x="0" y="0" heading="0"/>
      <goto next="#wait"/>
    </block>
  </form>
  <form id="greet">
    <block>
      <speak>Welcome, visitor <value expr="visits"/>.</speak>
      <send to="office"><param name="visit" expr="visits"/></send>
      <send event="too.late" delay="60s"/>
    </block>
    <on event="reply.office"><speak>The office knows.</speak><goto next="#wait"/></on>
    <on event="too.late"><goto next="#wait"/></on>
  </form>
</prima>
"""
SCENARIO = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="days"
    world="{documents}/worlds/room.xml" robot="{documents}/robots/papero.xml">
  <robot at="middle"/>
  <person x="4.5" y="4.5"/>
  <application src="{documents}/fa/emotions.xml" kind="fa"/>
  <application src="{documents}/fa/follow.xml" kind="fa"/>
  <application src="host.xml"/>
  <service name="office"><reply after="2s"><data name="known" value="yes"/></reply></service>
  <when at="1s"><event name="visit"/></when>
  <when on="visit">
    <walk x="1.2" y="0"/>
    <wait for="10s"/>
    <touch sensor="head"/>
  </when>
  <when on="visit" after="{every}s"><event name="visit"/></when>
  <when asked="What's the matter" after="1s"><say>Come on, follow me.</say></when>
  <when doing="tracking-human">
    <walk x="2.5" y="0"/>
    <wait for="3s"/>
    <touch sensor="head"/>
  </when>
  <when asked="May I stop following you?" after="1s"><say>Yes.</say></when>
  <when said="I'll stop following you">
    <walk x="4.5" y="4.5"/>
  </when>
</scenario>
"""
ALWAYS = 10**9
SEEN = {
    '"event":"visit"': "came",
    '"event":"human.lost"': "went away",
    '"phase":"start","actor":"robot","app":"emotions"': "was answered by emotions",
    '"phase":"start","actor":"robot","app":"host"': "was answered by host",
    "I'll start following you": "was followed",
    '"event":"reply.office"': "was told to the office",
}
"""The records that each visit has to leave in the transcript."""


@dataclass(slots=True)
class Sink:
    """Takes the lines of a transcript, counts what is in them, and drops them."""

    until: float
    """The time (s) of the run at which the memory is looked at."""
    seen: Counter[str] = field(default_factory=Counter)
    megabytes: float = 0.0

    def __call__(self, line: str) -> None:
        for words, what in SEEN.items():
            self.seen[what] += words in line
        if not self.megabytes and float(line[len('{"time":') : line.index(",")]) >= self.until:
            gc.collect()
            self.megabytes = memory_now()


def days(folder: Path, hours: float) -> Loaded:
    """A scenario with a user who comes back all the time: longer than a scenario itself can say."""
    from prima import api

    documents = api.documents_folder().resolve()
    (folder / "host.xml").write_text(HOST, "utf-8")
    path = folder / "days.xml"
    path.write_text(SCENARIO.format(documents=documents, every=EVERY), "utf-8")
    loaded = api.load_scenario(path)
    script = loaded.cast.scenario
    whens = [when if when.trigger == "at" else replace(when, times=ALWAYS) for when in script.whens]
    loaded.cast.scenario = replace(script, whens=whens, until=round(hours * HOUR * 1000))
    return loaded


def memory(hours: float) -> tuple[float, float, int]:
    """Run a robot with three applications for hours; all records are written, none is kept.

    Returns:
        the megabytes that the process has in memory after a tenth of the hours and at their end,
        and how often the user came.

    Raises:
        WrongAnswer: he came less than twenty times an hour, or was not answered.
    """
    from prima import api
    from prima.devices import loop

    sink = Sink(hours * HOUR / 10)
    with tempfile.TemporaryDirectory() as folder:
        loaded = days(Path(folder), hours)
    allowed, loop.MAX_RECORDS = loop.MAX_RECORDS, ALWAYS
    try:
        run = api.rehearse(loaded, sink=sink, keep=False)
    finally:
        loop.MAX_RECORDS = allowed
    gc.collect()
    check(run.outcome == "until" and not run.failures, f"{run.outcome}: {run.failures}")
    visits = sink.seen["came"]
    check(visits >= hours * HOUR / EVERY, f"the user came only {visits} times")
    for what in SEEN.values():
        check(
            sink.seen[what] >= visits - 1, f"of {visits} visits the user {what} {sink.seen[what]}"
        )
    return sink.megabytes, memory_now(), visits


def situations(seconds: float = 0.5) -> dict[str, float]:
    """Simulated seconds a second of processor time of each of the ten situations.

    Args:
        seconds: how long each is run again and again; the median run counts.
    """
    from prima.experiments.study import situations as ten

    return {path.stem: speed(path, seconds) for path in ten()}


def speed(path: Path, seconds: float) -> float:
    """Simulated seconds a second of processor time: the median run of a scenario counts."""
    from prima import api

    loaded = api.load_scenario(path)
    first = api.rehearse(loaded, keep=False)
    check(not first.failures, f"{path.stem}: {first.failures}")
    runs: list[float] = []
    while sum(runs) < seconds:
        began = process_time()
        again = api.rehearse(loaded, keep=False)
        runs.append(process_time() - began)
    check(again.summary() == first.summary(), f"{path.stem}: another run is another one")
    return first.summary().seconds / median(runs)


def main() -> None:
    """Tell all figures."""
    for name, speed in situations().items():
        print(f"{name:26} {speed:6,.0f} x real time")
    hours = float(sys.argv[1]) if len(sys.argv) > 1 else 100.0
    tenth, end, visits = memory(hours)
    print(f"{hours:g} h, {visits:,} visits: {tenth:.1f} MB after a tenth, {end:.1f} MB at the end")


if __name__ == "__main__":
    main()
