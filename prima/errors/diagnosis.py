"""A kind of problem as data: code, meaning and message."""

from __future__ import annotations

from dataclasses import dataclass, replace

from prima.errors.problems import Hint, Place, Problem, Severity

NO_HINT = Hint()


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """One kind of problem.

    ``message`` and ``remedy`` are templates: ``{name}`` is a parameter. A wrong and a right example
    are in the folder of its code in ``prima/handbook/examples``.
    """

    code: str
    title: str
    meaning: str
    """The explanation that ``prima explain CODE`` prints."""
    rule: str = ""
    """The rule of mediation, or the section of a Recommendation or of the thesis."""
    severity: Severity = "error"
    message: str = ""
    remedy: str = ""

    def says(self, message: str, remedy: str = "", severity: Severity | None = None) -> Diagnosis:
        """The same diagnosis with another message, for another cause."""
        kind = severity or self.severity
        return replace(self, message=message, remedy=remedy, severity=kind)

    def at(self, place: Place, hint: Hint = NO_HINT, **parameters: object) -> Problem:
        """The problem at a place; ``hint`` is a more exact remedy."""
        return Problem(
            place,
            self.severity,
            self.code,
            self.message.format(**parameters),
            hint.text or self.remedy.format(**parameters),
            hint.fixes,
            tuple((name, str(value)) for name, value in parameters.items()),
        )
