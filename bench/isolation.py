"""The cost of running scripts in separate processes: calls, and whole runs."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).parent.parent


def calls(isolate: str, seconds: float) -> float:
    """Conditions that an engine evaluates in a second."""
    from prima.script.evaluation import SCOPES
    from prima.script.isolated import Engines

    engine = Engines(isolate).engine("bench", "ea")
    scopes = tuple(engine.named(name) for name in SCOPES)
    engine.set(scopes[1], "n", 1)
    count, began = 0, perf_counter()
    while perf_counter() - began < seconds:
        for _ in range(100):
            engine.condition("Math.max(n, 0) == 1", scopes)
        count += 100
    return count / (perf_counter() - began)


def run(isolate: str, what: str, times: int) -> float:
    """Seconds that a run takes in a process that has made one already."""
    from prima import api

    documents = ROOT / "documents"
    if what == "demo":
        loaded = api.load_scenario(documents / "scenarios" / "follow-during-navigation.xml")
    else:
        loaded = api.load_scenario(documents / "scenarios" / "pizza-and-follow.xml")
    api.rehearse(loaded, isolate=isolate)
    began = perf_counter()
    for _ in range(times):
        api.rehearse(loaded, isolate=isolate)
    return (perf_counter() - began) / times
