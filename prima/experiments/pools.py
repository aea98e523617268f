"""Where the runs of experiments are made."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from typing import Protocol, TypeVar

from prima.experiments.scenariotext import Variant
from prima.pool import Died, cores, staff

Result = TypeVar("Result")
Result_co = TypeVar("Result_co", covariant=True)
Runs = Callable[[Iterable[Variant]], Iterator[tuple[Variant, Result | Died]]]
"""Makes a batch of runs, and yields their results in order."""


class Making(Protocol[Result_co]):
    """A stage: makes runs in the process to which it is sent."""

    def run(self, variant: Variant) -> Result_co:
        """Make a run."""

    def pack(self) -> None:
        """Read everything that its runs may read, before it is sent to another machine."""


class Pool(Protocol):
    """Makes runs somewhere."""

    def __call__(self, stage: Making[Result]) -> AbstractContextManager[Runs[Result]]:
        """Start the workers: the stage is sent once."""


def local(workers: int = 0) -> Pool:
    """Processes of this machine; by default as many as it has cores."""

    def pool(stage: Making[Result]) -> AbstractContextManager[Runs[Result]]:
        return staff(stage.run, workers or cores(), ahead=1)

    return pool
