"""How control passes between states without a question or a wait."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from functools import cached_property

from prima.digraphs import led_to, rings
from prima.interpreter.entering import ContentFacts, EnteredDocument, Entering, FormTarget

Onward = Mapping[FormTarget, Sequence[FormTarget]]
"""The targets of forms, and the expressions that name forms."""


class Ways:
    """The forms of an application and what entering one leads to; each is examined once."""

    def __init__(self, sources: Sequence[EnteredDocument]) -> None:
        self.contents = ContentFacts()
        self._sources = sources
        self._reached: dict[tuple[FormTarget, bool], set[FormTarget]] = {}
        self._ranks: dict[bool, dict[FormTarget, int]] = {}

    def lead(self, target: FormTarget, form: FormTarget, guess: bool) -> bool:
        """Whether a target leads to a form, directly or indirectly.

        With ``guess`` also if only a run determines what an expression names.
        """
        start = self._entering.exact(target)
        if not start.known and not guess:
            return False
        if start == form or (not start.known and form.name.startswith(start.name)):
            return True
        ranks = self._ranks_of(guess)
        if start in ranks and ranks[start] <= ranks[form]:
            return ranks[start] == ranks[form]
        known = self.contents.left > 0 or (start, guess) in self._reached
        return known and form in self.reached(start, guess)

    def reached(self, target: FormTarget, guess: bool) -> set[FormTarget]:
        """The forms that a target leads to, and the expressions that name such."""
        key = (self._entering.exact(target), guess)
        if key not in self._reached:
            self._reached[key] = self._reach(*key)
        return self._reached[key]

    def _reach(self, target: FormTarget, guess: bool) -> set[FormTarget]:
        onward = self._guessed if guess else self._known
        found = [target] if target in onward else self._matching(target) if guess else []
        reached = led_to(found, lambda one: onward.get(one, ()))
        self.contents.left -= len(reached)
        return reached

    def _ranks_of(self, guess: bool) -> dict[FormTarget, int]:
        """Equal numbers for targets that lead to each other; none leads to a higher one."""
        if guess not in self._ranks:
            onward = self._guessed if guess else self._known
            circles = rings(onward, lambda target: onward.get(target, ()))
            self._ranks[guess] = {one: rank for rank, ring in enumerate(circles) for one in ring}
        return self._ranks[guess]

    @cached_property
    def _entering(self) -> Entering:
        return Entering(self._sources, self.contents)

    @cached_property
    def _known(self) -> dict[FormTarget, list[FormTarget]]:
        """Where each form certainly leads on its own; expressions lead on only by guess."""
        return self._entering.onward()

    @cached_property
    def _guessed(self) -> Onward:
        """Where each form and each expression may lead on its own."""
        unknown = {to for leads in self._known.values() for to in leads if not to.known}
        return self._known | {to: self._matching(to) for to in unknown}

    @cached_property
    def _names(self) -> list[str]:
        return sorted(one.name for one in self._known)

    def _matching(self, target: FormTarget) -> list[FormTarget]:
        """The forms that an expression may name."""
        if target.known:
            return []
        begin = bisect_left(self._names, target.name)
        end = bisect_left(self._names, f"{target.name}\U0010ffff")
        return [FormTarget(name) for name in self._names[begin:end]]
