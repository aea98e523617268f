"""How control passes between states without a question or a wait."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

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
        reached = set(found)
        for one in found:  # grows meanwhile
            more = [to for to in onward[one] if to not in reached] if one in onward else ()
            found += more
            reached.update(more)
        self.contents.left -= len(reached)
        return reached

    def _ranks_of(self, guess: bool) -> dict[FormTarget, int]:
        if guess not in self._ranks:
            self._ranks[guess] = Ranks(self._guessed if guess else self._known).found
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


class Ranks:
    """Numbers of targets: equal for those that lead to each other; none leads to a higher one.

    It is Tarjan's search for strongly connected components, without recursion.
    """

    def __init__(self, onward: Onward) -> None:
        self.found: dict[FormTarget, int] = {}
        self._onward = onward
        self._entered: dict[FormTarget, int] = {}
        """The order in which they were reached."""
        self._lowest: dict[FormTarget, int] = {}
        """The earliest one known to be reachable from each."""
        self._edges: dict[FormTarget, Iterator[FormTarget]] = {}
        self._path: list[FormTarget] = []
        for root in onward:
            if root not in self._entered:
                self._search(root)

    def _search(self, root: FormTarget) -> None:
        calls = [self._enter(root)]
        while calls:
            node, into = calls[-1], self._next(calls[-1])
            if into is not None:
                calls.append(self._enter(into))
                continue
            calls.pop()
            lowest = self._lowest[node]
            if calls:
                self._lowest[calls[-1]] = min(self._lowest[calls[-1]], lowest)
            if lowest == self._entered[node]:
                self._close(node)

    def _enter(self, node: FormTarget) -> FormTarget:
        self._entered[node] = self._lowest[node] = len(self._entered)
        self._edges[node] = iter(self._onward.get(node, ()))
        self._path.append(node)
        return node

    def _next(self, node: FormTarget) -> FormTarget | None:
        """Unvisited nodes that a node leads to."""
        for to in self._edges[node]:
            if to not in self._entered:
                return to
            if to not in self.found:
                self._lowest[node] = min(self._lowest[node], self._entered[to])
        return None

    def _close(self, node: FormTarget) -> None:
        """Number the nodes that lead to a node and back."""
        number = len(self.found)
        while node not in self.found:
            self.found[self._path.pop()] = number
