"""Scenarios and worlds."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

BLOCKED_WAY = Diagnosis(
    "blocked-way",
    "Blocked way",
    (
        "A way of a world goes through a wall, so that the robot stops in front of it. Given "
        "a scenario, also a way or place that is too close to a wall for its robot."
    ),
    severity="warning",
)

NEVER_SAID = Diagnosis(
    "never-said",
    "Words that nobody says",
    (
        "A scenario waits for words that none of its applications says, so that the waiting "
        "steps never happen."
    ),
    severity="warning",
)
