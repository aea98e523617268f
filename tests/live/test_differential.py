"""The same scenario rehearsed, and live: in jumps of the clock, the transcripts are the same."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from prima import api
from prima.invariants import callers, check
from prima.live.shell import Shell
from prima.messages import Record
from prima.scheduler.policy import policy_named
from prima.sim.rehearsal import Rehearsal
from prima.transcript.lines import finished
from tests.live.stage import Jumping, carried_out, in_ms, live_loop

SCENARIOS = sorted((Path(__file__).parents[2] / "documents" / "scenarios").glob("*.xml"))


def rehearsed(path: Path) -> list[Record]:
    loaded = api.load_scenario(path)
    run = Rehearsal(loaded.cast, policy_named(loaded.cast.scenario.policy), isolate="none")
    return [finished(record) for records in run.run() for record in records]


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_the_shell_gives_what_a_rehearsal_gives(path: Path) -> None:
    loaded = api.load_scenario(path)
    run = Rehearsal(loaded.cast, policy_named(loaded.cast.scenario.policy), isolate="none")
    assert carried_out(run) == rehearsed(path)


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_a_driver_gives_what_a_rehearsal_gives(path: Path) -> None:
    loaded = api.load_scenario(path)
    live = carried_out(live_loop(loaded.cast, loaded.cast.scenario.policy))
    before = rehearsed(path)
    if loaded.cast.offers:  # a robot goes on to where the next application is offered
        live[-1]["outcome"] = before[-1]["outcome"]
    assert live == before


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_invariants_hold_where_devices_take_time_to_stop(path: Path) -> None:
    loaded = api.load_scenario(path)
    policy = loaded.cast.scenario.policy
    live = carried_out(live_loop(loaded.cast, policy, stopping="60ms"))
    documents = loaded.cast.documents
    names = [doc.id for doc in documents]
    assert check(in_ms(live), policy, names, calling=callers(documents)) == []


def test_what_begins_on_a_device_that_still_stops_is_held_back_and_told() -> None:
    path = next(one for one in SCENARIOS if one.stem == "follow-during-navigation")
    live = carried_out(live_loop(api.load_scenario(path).cast, stopping="60ms"))
    delays = [record for record in live if record["phase"] == "delayed"]
    assert delays
    assert {record["data"]["waited"] for record in delays} == {0.06}


def test_an_instant_that_comes_late_because_the_one_before_took_long_is_told() -> None:
    path = next(one for one in SCENARIOS if one.stem == "follow-during-navigation")
    loop, clock, told = live_loop(api.load_scenario(path).cast), Jumping(), list[str]()

    def slow(records: list[Record]) -> None:
        if records[0]["time"] == 0:
            clock.time = 60_000

    loop.journal = slow
    shell = Shell(loop, clock, told.append, late=250)
    clock.ended = shell.stop
    try:
        asyncio.run(shell.run())
    finally:
        loop.session.close()
    assert len(told) == 1 and told[0].startswith("An instant was carried out ")
    assert shell.latest > 50_000
