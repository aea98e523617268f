"""The language of kinds of users."""

from __future__ import annotations

from dataclasses import replace

from prima.devices.vocabulary.common import ID, TITLE, VERSION
from prima.markup.vocabulary import Element, Vocabulary, elements
from prima.sim.vocabulary.happenings import CHANCE, DOINGS, SPEED
from prima.sim.vocabulary.scenario import SCENARIO


def _without(element: Element, name: str, children: tuple[str, ...] = ()) -> Element:
    """An element of scenarios as users have it."""
    kept = tuple(one for one in element.attributes if one.name != name)
    return replace(element, attributes=kept, children=children or element.children)


TABLE = f"""
user > answers answer when | A kind of users: how a person of a scenario behaves, whatever the
    scenario.
  {VERSION}
  {ID}
  {TITLE}
  {SPEED}
answers | How they give the scenario's answers, unless these specify it themselves.
  after: delay = 1s | how long after the question
  {CHANCE}
"""
USER = Vocabulary(
    "urn:prima:user:1",
    "user",
    "user",
    (
        *elements(TABLE),
        _without(SCENARIO.elements["answer"], "person"),
        _without(SCENARIO.elements["when"], "person", ("one-of", *DOINGS)),
        replace(SCENARIO.elements["one-of"], children=DOINGS),
        SCENARIO.elements["alternative"],
        *(SCENARIO.elements[name] for name in DOINGS),
    ),
    hints={
        **{tag: hint for tag, hint in SCENARIO.hints.items() if tag != "user"},
        **dict.fromkeys(
            ("event", "message", "sensor", "fail", "repair", "service"),
            "The scenario says what happens around the user.",
        ),
        "person": "The scenario says who is where.",
    },
)
