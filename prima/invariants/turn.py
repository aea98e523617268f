"""The third turn (X7): the asker's response to an answer, recomputed from the records."""

from __future__ import annotations

from prima.invariants.channel import Channel
from prima.invariants.model import AB, LINKED, WAITING, Record, Tree, base


class Turn(Channel):
    """X7: nobody speaks between a user's answer and the asker's response."""

    def note_turn(self, record: Record) -> None:
        """A question ends, with the user's answer or otherwise."""
        ab = self.abs.get(base(record["behavior"]))
        answered = not record.get("inbound") and record.get("outcome") == "filled"
        if ab is not None and ab.asks and answered:
            self.answered_tree = ab.tree

    def look_for_turn(self) -> None:
        """When selection begins: note the asker's response, if any."""
        if self.halted:
            return
        if self.turn is not None and self.turn.phase not in (LINKED, WAITING):
            self.turn = None
        tree, self.answered_tree = self.answered_tree, None
        if tree is not None and "x7" in self.extensions and self.prima:
            self.turn = self._acknowledgement(tree)

    def _acknowledgement(self, tree: Tree) -> AB | None:
        coming = [
            one
            for one in tree.members.values()
            if one.phase in (LINKED, WAITING) and one.unit is None and "speaker" in one.devices
        ]
        if not coming or not all(map(self._soon_over, self._way_to(coming[0]))):
            return None
        return coming[0]

    def _soon_over(self, ab: AB) -> bool:
        lasts = ab.feedback or ab.leaves or "speech-recognition" in ab.devices
        return not (lasts or ab.spans) and ab.cause is None

    def _way_to(self, ab: AB) -> list[AB]:
        """An AB and all that has to end before it may start."""
        found = [ab]
        for one in found:  # the list grows
            found += [
                parent for name in sorted(one.parents) if (parent := self.abs[name]) not in found
            ]
        return found

    def third_turn(self, ab: AB) -> bool:
        """X7: whether it is the asker's response to an answer, or comes before it."""
        return self.turn is not None and ab in self._way_to(self.turn)

    def refused_by_turn(self, ab: AB) -> AB | None:
        """X7: the utterance that precedes everything else to be said."""
        turn = self.turn
        if turn is None or turn.phase != LINKED or "speaker" not in ab.devices:
            return None
        if self.third_turn(ab) or any(map(self._is_kept, self._way_to(turn))):
            return None
        return turn

    def _is_kept(self, ab: AB) -> bool:
        """Whether a waiting AB's devices are occupied: nobody waits for such an AB (X7)."""
        others = (other for other in self.running.values() if other.devices & ab.devices)
        return ab.phase == WAITING and any(other.unit is None for other in others)
