"""Where the runs of experiments are made."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager

from prima.experiments.scenariotext import Variant
from prima.experiments.variants import Made, Stage
from prima.pool import Died, cores, staff

Runs = Callable[[Iterable[Variant]], Iterator[tuple[Variant, Made | Died]]]
"""Makes a batch of runs, and yields their results in order."""
Pool = Callable[[Stage], AbstractContextManager[Runs]]
"""Starts workers, to which a stage is sent once: it makes the runs there."""


def local(workers: int = 0) -> Pool:
    """Processes of this machine; by default as many as it has cores."""
    return lambda stage: staff(stage.run, workers or cores(), ahead=1)
