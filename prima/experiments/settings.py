"""How the runs of an experiment are made; importing it is quick, as a batch runs elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from prima.markup.limits import LIMITS


@dataclass(frozen=True, slots=True)
class ExperimentSettings:
    """Options of all runs of an experiment; :func:`prima.api.rehearse` describes them."""

    bound: int | None = None
    patience: int | None = None
    isolate: str = "ea"
    hosts: tuple[str, ...] = ()
    seed: int | None = None
    limits: Mapping[str, int] = field(default_factory=lambda: asdict(LIMITS))
    """The limits on documents of the process that makes the settings."""

    def arguments(self) -> dict[str, Any]:
        """The options as arguments of :func:`prima.api.rehearse`."""
        names = ("bound", "patience", "isolate", "hosts", "seed")
        return {name: getattr(self, name) for name in names}
