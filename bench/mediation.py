"""The mediator alone: the end of what runs, and the choice among all that waits."""

from __future__ import annotations

import random
from time import perf_counter
from typing import TYPE_CHECKING

from bench.fresh import check

if TYPE_CHECKING:
    from prima.messages import Record

CHAIN = 4
"""Commands that an application asks for at a time, each as a tree of its own."""
MOST = 100_000
"""Decisions of one measurement."""


def decisions(waiting: int, seconds: float, policy: str = "prima") -> float:
    """Decisions a second while ABs of so many applications wait.

    One more application's AB runs. Each decision is the end of what runs, reported to the mediator,
    and a selection with its records and orders. All Commands are requested before; the clock
    does not go on while an application whose Commands have all been done asks for new ones.
    """
    from prima.language.commands import TABLE_4_2
    from prima.messages import Command, Request, Step
    from prima.scheduler.mediator import Mediator
    from prima.scheduler.policy import policy_named
    from prima.scheduler.recorder import Recorder

    recorder = Recorder()
    mediator = Mediator(policy_named(policy), TABLE_4_2, recorder)
    asked = 0

    def ask(app: int) -> None:
        nonlocal asked
        for _ in range(CHAIN):
            asked += 1
            step = Step(Command("speak", {}, "Hello."))
            mediator.ask(f"a{app}", Request(asked, [step], 1))

    times = request_times(waiting + 1)
    for app in range(waiting + 1):
        mediator.load(f"a{app}", "ea")
    for app in sorted(times, key=lambda app: times[app]):
        recorder.now = times[app]
        ask(app)
        recorder.drain()
    recorder.now += 1
    mediator.select()
    recorder.drain()
    (order,) = mediator.drain_orders()
    turns: list[int] = []
    lasted = 0.0
    while lasted < seconds and CHAIN * len(turns) < MOST:
        records: list[Record] = []
        began = perf_counter()
        for _ in range(CHAIN):
            recorder.now += 1
            mediator.ended(order.behavior, True, {})
            mediator.deliveries.clear()
            mediator.select()
            (order,) = mediator.drain_orders()
            records += recorder.drain()
        lasted += perf_counter() - began
        winners = [record["app"] for record in records if record["phase"] == "decision"]
        check(len(winners) == CHAIN, f"{len(winners)} decisions are recorded")
        check(len(set(winners[:-1])) == 1, "an application's next Command does not go on (S2c)")
        turns.append(int(winners[0][1:]))
        ask(turns[-1])
        recorder.drain()
    check(turns == expected_turns(times, len(turns)), "another application had its turn (S2e, S2f)")
    return CHAIN * len(turns) / lasted


def cost(waiting: int, seconds: float) -> float:
    """Seconds for a decision."""
    return 1 / decisions(waiting, seconds)


def request_times(apps: int) -> dict[int, int]:
    """When (ms) each application asks at first: three at an instant, not in declared order."""
    shuffled = random.Random(apps).sample(range(apps), apps)
    return {app: index // 3 for index, app in enumerate(shuffled)}


def expected_turns(times: dict[int, int], turns: int) -> list[int]:
    """Whose turn it has to be: by time of request, then in declared order; then round and round."""
    order = sorted(times, key=lambda app: (times[app], app))
    return [order[turn % len(order)] for turn in range(turns)]
