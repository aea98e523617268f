"""Small documents through a session, and what became of them."""

from __future__ import annotations

from prima.interpreter.reader import read_document
from prima.messages import (
    Inbound,
    Record,
)
from prima.scheduler.policy import policy_named
from prima.session import Session
from tests.helpers.generated.plays import Play
from tests.helpers.generated.world import TABLE, World

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="{}">{}</prima>'
IDLE = HEAD.format("fa", '<form id="f1"/>')


def play(body: str, *events: tuple[int, Inbound]) -> Play:
    """One application, ``ea``, beside one that does nothing."""
    return Play((IDLE, HEAD.format("ea", body)), (0, 0), events, World())


def told(records: list[Record], behavior: str) -> list[tuple[int, str]]:
    return [(r["time"], r["phase"]) for r in records if r.get("behavior") == behavior]


def stepped(content: str, *steps: tuple[int, tuple[Inbound, ...]]) -> tuple[Session, list[Record]]:
    """A session of one application that is told what its devices do, and its records."""
    text = HEAD.format("ea", f'<form id="f"><block>{content}</block></form>')
    document, _ = read_document("ea.xml", text.encode())
    session = Session([document], policy_named("prima"), TABLE)
    for now, inbound in steps:
        session.step(now, inbound)
    return session, session.drain()


NESTED = (
    "<iu>{}<par><speak>One.</speak><iu{}><gesture name='nod'/></iu></par></iu><speak>Over.</speak>"
)


IN_ORDER = ("fa", "ea", "xa")
SEARCH = "<block><active-sensing-human>Where are you?</active-sensing-human></block>"
