"""Kinds of users, such as patient or hasty ones: documents of how a scenario's person behaves."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from prima.devices.reading import Reader
from prima.errors import Problem
from prima.markup.tree import Node
from prima.sim.chance import Amount, Chance, Draws
from prima.sim.happenings import When, read_answer, read_when
from prima.sim.vocabulary.user import USER


@dataclass(slots=True)
class User:
    """How a person walks and answers, and what they do on their own."""

    speed: Amount
    """Metres a second."""
    after: Amount
    """How long (ms) they take to answer unless the scenario says so."""
    chance: Chance
    """The probability that they answer at all unless the scenario says so."""
    whens: list[When]
    """Their actions and answers, whatever the scenario says."""
    draws: Draws
    node: Node
    warnings: list[Problem] = field(default_factory=list)
    """The warnings about the document."""

    def answer(self, when: When, name: str) -> None:
        """Adapt an answer of the scenario, with its name, to how this user answers."""
        assert when.node is not None
        given = when.node.attributes
        if "after" not in given:  # answers to other questions have streams of their own
            when.after = replace(self.after, stream=f"{self.after.stream}:{name}")
        if "chance" not in given:
            when.chance = replace(self.chance, stream=f"{self.chance.stream}:{name}")


def read_user(file: str, data: bytes, person: str = "") -> User:
    """Read a user's document for a person of a scenario.

    Raises:
        DocumentError: with all its problems.
    """
    reader = Reader(USER, file, data)
    root = reader.root
    draws = Draws(reader, f"{person}:user")  # no id has a colon
    seen: set[str] = set()
    for node in root.all("when", "answer"):
        reader.once(node, seen, "The id ")
    manner = reader.only("answers")
    user = User(
        speed=draws.amount(root, "speed", 1.0),
        after=draws.amount(manner, "after", 1000) if manner is not None else Amount(1000),
        chance=draws.chance(manner) if manner is not None else Chance(),
        whens=[read_when(draws, node) for node in root.all("when")]
        + [read_answer(draws, node) for node in root.all("answer")],
        draws=draws,
        node=root,
    )
    for when in user.whens:
        when.person = person
    reader.finish()
    user.warnings = reader.problems
    return user
