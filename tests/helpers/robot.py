"""A document under test, run by a session on devices that do what the test says."""

from __future__ import annotations

from weakref import WeakSet

from prima.errors import Problem
from prima.interpreter.elements import Document
from prima.interpreter.reader import read_document
from prima.language.commands import TABLE_4_2
from prima.messages import (
    ApplicationLoaded,
    Ended,
    Failed,
    Heard,
    Inbound,
    Listening,
    Occurred,
    Order,
    Record,
)
from prima.scheduler.policy import policy_named
from prima.session import Session

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="{name}">'

CAUGHT = '<on event="error.semantic"><log expr="_event"/></on>'
"""A handler that logs the error."""
_sessions = WeakSet[Session]()


def close_sessions() -> None:
    """End the processes of all sessions that a test has begun."""
    while _sessions:
        _sessions.pop().close()


def xml(body: str, kind: str = "fa", name: str = "app") -> bytes:
    return (HEAD.format(kind=kind, name=name) + body + "</prima>").encode()


def read(body: str, kind: str = "fa", name: str = "app") -> tuple[Document, list[Problem]]:
    return read_document(f"{name}.xml", xml(body, kind, name))


def document(body: str, kind: str = "fa", name: str = "app") -> Document:
    made, problems = read(body, kind, name)
    assert [str(one) for one in problems if one.severity == "error"] == []
    return made


class Bench:
    """Runs documents; every Command lasts until the test ends it."""

    def __init__(
        self, *documents: Document | str, policy: str = "prima", isolate: str = "ea"
    ) -> None:
        made = [document(one) if isinstance(one, str) else one for one in documents]
        self.session = Session(made, policy_named(policy), TABLE_4_2, isolate=isolate)
        _sessions.add(self.session)
        self.now = 0
        self.records: list[Record] = []
        self.orders: list[Order] = []
        self.step(*[ApplicationLoaded(one.id) for one in made])

    def step(self, *inbound: Inbound, at: int | None = None) -> None:
        self.now = self.now + 100 if at is None else at
        self.orders += self.session.step(self.now, inbound)
        self.records += self.session.drain()

    # What is running ------------------------------------------------------------

    def running(self) -> dict[str, str]:
        """Running ABs and what they say, or their Command."""
        memory = self.session.mediator.memory
        return {
            ab.id: (ab.command.text or ab.command.type) if ab.command else "iu"
            for ab in memory.running.values()
        }

    def saying(self) -> list[str]:
        return sorted(self.running().values())

    # What happens ---------------------------------------------------------------

    def finish(self, what: str = "", goal: bool = True) -> None:
        """The running Command that says or is ``what`` ends."""
        self.step(Ended(self._id(what), goal))

    def fail(self, what: str, device: str = "speaker") -> None:
        self.step(Failed(self._id(what), device, "broken"))

    def _id(self, what: str) -> str:
        found = [key for key, said in self.running().items() if what in said and said != "iu"]
        assert len(found) == 1, (what, self.running())
        return found[0]

    def listens(self) -> None:
        question = self.session.mediator.question()
        assert question is not None
        self.step(Listening(question.id))

    def hears(self, text: str, confidence: float | None = None, **others: float) -> None:
        """The user says something; of which, and of ``others``, the recogniser is so sure."""
        told = [{"text": word, "confidence": sure} for word, sure in others.items()]
        data = {} if confidence is None else {"confidence": confidence}
        self.step(Heard(text, {**data, **({"alternatives": told} if told else {})}))

    def silence(self) -> None:
        question = self.session.mediator.question()
        assert question is not None
        self.step(Ended(question.id, True, {"outcome": "noinput"}))

    def event(self, name: str, **data: object) -> None:
        self.step(Occurred(name, "environment", data))

    # What the user does to an application alone, whose words are all said to their end

    def play(self) -> list[str]:
        """Let everything that is said come to its end; gives all that has been said so far."""
        for _ in range(1000):
            speaking = self._speaking()
            if not speaking:
                break
            self.step(*[Ended(behavior) for behavior in speaking])
        return self.said()

    def _speaking(self) -> list[str]:
        running = self.session.mediator.memory.running
        return [ab.id for ab in running.values() if ab.command and ab.command.type != "q-and-a"]

    def answer(self, *utterances: str) -> None:
        """Say something to each question that comes, once it has been said."""
        for text in utterances:
            self.play()
            self.listens()
            self.hears(text)
        self.play()

    def silent(self) -> None:
        """Say nothing to the question that comes."""
        self.play()
        self.silence()
        self.play()

    @property
    def ended(self) -> str:
        """How the application has ended: ``exit``, an event's name, or nothing if it runs."""
        found = [r for r in self.phases("unload") if r["actor"] == "mediator"]
        return str(found[0]["outcome"]) if found else ""

    # What was said ------------------------------------------------------------------

    def said(self) -> list[str]:
        return [r["text"] for r in self.records if r["phase"] == "start" and r.get("text")]

    def logs(self) -> list[str]:
        return [r["message"] for r in self.records if r["phase"] == "log"]

    def phases(self, phase: str) -> list[Record]:
        return [record for record in self.records if record["phase"] == phase]
