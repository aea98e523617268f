"""Checks a run against what its scenario expects (docs/testing.md)."""

from __future__ import annotations

from dataclasses import dataclass

from prima.errors import Place
from prima.language.values import shown
from prima.sim.expectations import Expectation
from prima.sim.scenario import Scenario
from prima.sim.triggers import fires
from prima.testing.excerpts import around
from prima.testing.facts import Fact, RunFacts, Window
from prima.testing.matching import fits, most_alike, text_of, values
from prima.testing.sentences import event_of, expected, seconds, subject, times

MOST_TOLD = 5
"""Times that a message lists."""


@dataclass(frozen=True, slots=True)
class Failure:
    """An expectation that was not met: its place, a message, and rows of the run."""

    place: Place
    message: str
    rows: str = ""


def check(scenario: Scenario, run: RunFacts) -> list[Failure]:
    """The failures of a scenario's expectations, in document order."""
    return ExpectationChecker(scenario, run).failures


class ExpectationChecker:
    """Checks the expectations of one scenario."""

    def __init__(self, scenario: Scenario, run: RunFacts) -> None:
        self.run = run
        self.failures: list[Failure] = []
        self._found: dict[int, Fact | None] = {}
        """The fact that met each expectation, by its identity; None if there was none."""
        self._named = {one.id: one for one in scenario.expectations if one.id}
        for one in scenario.expectations:
            self._found[id(one)] = None
            window = self._window(one)
            if window is not None and "state" in one.words:
                self._check_state(one, window)
            elif window is not None:
                self._check(one, window)

    def _check(self, one: Expectation, window: Window) -> None:
        fitting = [fact for fact in self.run.facts if fits(one, fact)]
        inside = [fact for fact in fitting if window.holds(fact)]
        if one.never:
            if inside:
                self._fail(one, window, f"It does {self._at(inside)}.", inside[0])
        elif one.times is not None and len(inside) != one.times:
            does = (
                f"It does {times(len(inside))}, {self._at(inside)}." if inside else "It never does."
            )
            self._fail(one, window, does, next(reversed(inside), None))
        elif not inside:
            self._miss(one, window, fitting)
        else:
            self._found[id(one)] = inside[-1] if one.times else inside[0]

    # Windows ----------------------------------------------------------------------

    def _window(self, one: Expectation) -> Window | None:
        """The time in which it is expected; None if a fact that bounds it is missing."""
        window = Window()
        named = self._named[one.after] if one.after else None
        for other in filter(None, (named, one.previous)):
            fact = self._found.get(id(other))
            if fact is None:
                return None
            if fact.number > window.behind:
                window.opens, window.behind = max(window.opens, fact.time), fact.number
                window.why = f"after {subject(other)} at {seconds(fact.time)}"
        if one.before:
            fact = self._found.get(id(self._named[one.before]))
            if fact is None:
                return None
            window.ahead = fact.number
        if one.trigger and not self._open(one, window):
            return None
        if one.within is not None:
            window.closes = window.opens + one.within
        return window

    def _open(self, one: Expectation, window: Window) -> bool:
        """Open the window at its trigger; report a trigger that never comes."""
        if one.trigger == "at":
            time = self.run.end if one.what == "end" else one.what
            window.opens = max(window.opens, time)
            window.why = "at the end" if one.what == "end" else f"from {seconds(time)} on"
            return True
        fired = [
            fact
            for fact in self.run.facts
            if fact.number > window.behind and fires(one.trigger, one.what, fact.record, fact.said)
        ]
        event = event_of(one)
        if len(fired) < one.count:
            often = "never happens" if not fired else f"happens only {times(len(fired))}"
            self._fail(one, window, f"Its trigger {often}: {event}.", next(reversed(fired), None))
            return False
        fact = fired[one.count - 1]
        window.opens, window.behind = fact.time, fact.number
        window.why = f"after {event} at {seconds(fact.time)}"
        return True

    # States -----------------------------------------------------------------------

    def _check_state(self, one: Expectation, window: Window) -> None:
        """A state lasts: an application must be in it at some time of the window, or never."""
        closes = self.run.end if window.closes is None else window.closes
        if window.ahead is not None:
            closes = window.closes = min(self.run.facts[window.ahead].time, closes)
        apps = [one.by] if one.by else list(self.run.states)
        wanted = one.words["state"]
        held = [(app, at) for app in apps for at in self._times(app, wanted, window.opens, closes)]
        if one.never and held:
            app, time = held[0]
            message = f"{app} is in it from {seconds(time)} on."
            self._fail(one, window, message, max(time, window.opens))
        elif not one.never and not held:
            message = " ".join(self._state_at(app, window.opens) for app in apps[:MOST_TOLD])
            self._fail(one, window, message, window.opens)

    def _times(self, app: str, state: str, opens: int, closes: int) -> list[int]:
        """When an application entered a state in which it was at some time of a window."""
        changes = self.run.states.get(app, [])
        ends = [*(change.time for change in changes[1:]), None]
        return [
            change.time
            for change, end in zip(changes, ends, strict=False)
            if change.state == state and _meets(change.time, end, opens, closes)
        ]

    def _state_at(self, app: str, time: int) -> str:
        """The state of an application at a time."""
        changes = self.run.states.get(app, [])
        now = next((one for one in reversed(changes) if one.time <= time), None)
        if now is None:
            return f"{app} has not begun then."
        if now.state:
            return f'{app} is in "{now.state}" then, since {seconds(now.time)}.'
        return f"{app} has ended then: {self.run.ended.get(app, 'it is over')}."

    # Failures ---------------------------------------------------------------------

    def _fail(
        self, one: Expectation, window: Window, instead: str, near: Fact | int | None = None
    ) -> None:
        """Add a failure, with the rows of the window and those around what was found.

        Args:
            one: the expectation.
            window: the time in which it is expected.
            instead: what happened instead, as a sentence.
            near: what was found, or its time (ms).
        """
        name = next(name for name in one.node.attributes if name in one.words)
        place = one.node.attribute_place(name, value=False)
        time = near.time if isinstance(near, Fact) else near
        looked = None if one.never and near is not None else window
        message = f"{expected(one, window)} {instead}".strip()
        self.failures.append(Failure(place, message, around(self.run.rows, looked, time)))

    def _at(self, facts: list[Fact]) -> str:
        """The times of facts, with their rows."""
        shown_ones = [f"{seconds(fact.time)}{self._row(fact)}" for fact in facts[:MOST_TOLD]]
        more = f" and {len(facts) - MOST_TOLD} more" if len(facts) > MOST_TOLD else ""
        return f"at {', '.join(shown_ones)}{more}"

    def _row(self, fact: Fact) -> str:
        """The row of the table that shows a fact."""
        name = fact.record.behavior.partition(".")[0]
        kind = fact.phase if fact.phase in ("log", "unload") else ""
        for row in self.run.rows:
            same = row.behavior.partition(".")[0] == name and row.kind == (kind or row.kind)
            now = round(row.time * 1000) == fact.time and row.app == fact.record.app
            if same and now:
                return f" (row {row.number})"
        return ""

    def _miss(self, one: Expectation, window: Window, fitting: list[Fact]) -> None:
        """Add a failure for an expectation that nothing met, with the nearest fact."""
        late = next((fact for fact in fitting if window.late(fact)), None)
        early = next((fact for fact in reversed(fitting) if window.early(fact)), None)
        if late is not None:
            after = f"{seconds(late.time - window.closes)} " if window.closes else ""
            self._fail(one, window, f"It does {self._at([late])}, {after}too late.", late)
        elif early is not None:
            self._fail(one, window, f"It does {self._at([early])}, too early.", early)
        else:
            near, instead = self._nearest(one)
            self._fail(one, window, instead, near)

    def _nearest(self, one: Expectation) -> tuple[Fact | None, str]:
        """The fact nearest to one that never happens: by another application, or with other values."""
        by_others = [fact for fact in self.run.facts if fits(one, fact, whoever=True)]
        if by_others:
            who, at = by_others[0].record.app, self._at(by_others[:1])
            return by_others[0], f"{who} does, {at}." if who else f"It does for all, {at}."
        other_values = [fact for fact in self.run.facts if fits(one, fact, whatever=True)]
        if other_values and (one.data or one.reason):
            return other_values[0], self._different(one, other_values[0])
        return self._nearest_text(one)

    def _different(self, one: Expectation, fact: Fact) -> str:
        """A fact with other values or another reason than expected, as a sentence."""
        if not one.data:
            return f"It ends with {fact.record.outcome}, {self._at([fact])}."
        found = ", ".join(f"{key} {shown(value)}" for key, value in values(fact).items())
        return f"It does so with {found or 'no values'}, {self._at([fact])}."

    def _nearest_text(self, one: Expectation) -> tuple[Fact | None, str]:
        """The most similar text that was said or logged, if that is expected."""
        name = next((name for name in ("says", "logs") if name in one.words), "")
        found = most_alike(one.words[name], name, self.run.facts) if name else None
        if found is None:
            return None, "It never does."
        who, text = found.record.app, text_of(found, name)
        verb = "asks" if found.request.command == "q-and-a" else name
        return found, f'It never does. Nearest: {who} {verb} "{text}" {self._at([found])}.'


def _meets(begins: int, ends: int | None, opens: int, closes: int) -> bool:
    """Whether a span meets a window; one that ends as the window opens does not."""
    return begins <= closes and (ends is None or ends > opens or begins >= opens)
