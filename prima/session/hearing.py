"""The user's words, and the questions they answer (V1), even too late (X10) or too early (X8)."""

from __future__ import annotations

from prima.grammar.answers import Answers
from prima.language.commands import LATE_MS
from prima.messages import Command, Ended, Event, Heard, Json, Order
from prima.scheduler.behavior import WAITING, Behavior
from prima.session.applications import AnyApp
from prima.session.wiring import Wiring


class Hearing:
    """Passes what the user says to the application that it answers.

    Args:
        wiring: connects the session's applications and mediator.
        late_answers: whether the extension X10 is on.
    """

    def __init__(self, wiring: Wiring, late_answers: bool) -> None:
        self.wiring = wiring
        self.unheard = ""
        """The user's latest words that nobody took."""
        self.refused: dict[str, tuple[str, str]] = {}
        """The latest answer that each application's question did not take, until one is taken: the
        question's place in the document, and the words."""
        self._late_answers = late_answers
        self._lapsed: tuple[AnyApp, int] | None = None
        """The application whose question was the latest to time out, and when it did (X10); loaded
        again, it is another one."""

    def take_unheard(self) -> str:
        """The user's latest words that nobody took; returned once."""
        text, self.unheard = self.unheard, ""
        return text

    def listening(self) -> list[Answers]:
        """The utterances possible now: answers to a listening or interruptible question, links (V1)."""
        asked: list[Answers | None] = []
        question = self.wiring.mediator.question()
        if question is not None and question.run is not None and self._hears(question):
            asked.append(self.wiring.apps.named[question.app.name].answers(question.run.number))
        for ab in self.wiring.mediator.memory.running.values():
            if ab.command is not None and not ab.silent:
                asked.append(self.wiring.apps.named[ab.app.name].open_during(ab.command))
        found = [answers for answers in asked if answers is not None]
        for app in self.wiring.in_order():
            found += app.listening()
        return found

    def hear(self, value: Heard) -> None:
        """V1: the listening question, then links that listen all the time, then nomatch."""
        self.wiring.mediator.senses_user()
        self.wiring.serial += 1
        question = self.wiring.mediator.question()
        if question is not None and not self._hears(question):
            question = None
        late = self._late_for(value, question)
        self._record(value, late)
        if late is not None:
            self._answer_late(late, value)
            return
        taken = self._answer(question, value) if question is not None else self._breaks_in(value)
        if taken or self._follow_links(value, question):
            return
        if question is None:
            self.unheard = value.text
        elif question.silent:  # U5: of a unit that has been left
            self._conclude(question.id, {"outcome": "nomatch", "utterance": value.text})
        elif not self._offer(value):
            self._refuse(question, value)

    def _record(self, value: Heard, late: AnyApp | None) -> None:
        lasted = {"lasted": value.lasted / 1000} if value.lasted and self._late_answers else {}
        self.wiring.recorder.add(
            "event",
            "user",
            app=late.name if late is not None else None,
            event="speech",
            text=value.text,
            data={**value.data, **lasted} or None,
            rule="X10" if late is not None else None,
            serial=self.wiring.serial,
            inbound=True,
        )

    def _answer(self, question: Behavior, value: Heard) -> bool:
        """Whether the user's words end the question: as an answer, a link, or by their length."""
        asked = question.command
        if value.data.get("toolong") and asked is not None and asked.cued("longest"):
            self._conclude(question.id, {"outcome": "maxspeechtimeout", "utterance": value.text})
            return True
        if question.run is None or question.silent:  # nobody would learn how it has ended
            return False
        app = self.wiring.apps.named[question.app.name]
        if (filled := self._filled(question, value)) is not None:
            self.refused.pop(app.name, None)
            self._conclude(question.id, filled)
            return True
        link = self.wiring.apps.guard(app, app.listens_to, value.hypotheses)
        if app.over:  # what it listens for took too long, and its question has ended with it
            self.wiring.act(app)
            return True
        if link is None or not link.event:
            return False
        # As in VoiceXML, a link ends the input of the field that is being visited.
        self._conclude(question.id, {"outcome": link.event, "utterance": value.text})
        return True

    def _filled(self, question: Behavior, value: Heard) -> dict[str, Json] | None:
        """How a question ends by the user's words as its answer; None if it does not take them."""
        answer = None
        if question.run is not None:
            app = self.wiring.apps.named[question.app.name]
            run = question.run.number
            answer = self.wiring.apps.guard(app, app.answer, run, value.hypotheses)
        return value.filled(answer) if answer is not None else None

    def _refuse(self, question: Behavior, value: Heard) -> None:
        """Words that nobody has taken are the question's nomatch; with a hotword it listens on."""
        cues = question.command.cues if question.command is not None else ()
        place = question.command.source if question.command is not None else ""
        hotword = next((cue for cue in cues if cue.kind == "hotword"), None)
        if hotword is None or (
            hotword.value and self.wiring.apps.named[question.app.name].heeds(value.text)
        ):
            self.refused[question.app.name] = place, value.text
            data = {"outcome": "nomatch", "utterance": value.text, **value.data}
            self._conclude(question.id, data)

    def lapse(self, value: Ended) -> None:
        """X10: note the question that was not answered in time."""
        if not self._late_answers or value.data.get("outcome") != "noinput":
            return
        question = self.wiring.mediator.running(value.behavior)
        if question is not None and not question.silent:
            app = self.wiring.apps.named[question.app.name]
            self._lapsed = app, self.wiring.recorder.now

    def _late_for(self, value: Heard, question: Behavior | None) -> AnyApp | None:
        """X10: the application whose question is answered too late, unless it listens again."""
        if self._lapsed is None:
            return None
        app, when = self._lapsed
        if self.wiring.recorder.now - value.lasted - when > LATE_MS:
            self._lapsed = None
            return None
        asks = self.wiring.apps.named[question.app.name] if question is not None else None
        return None if asks is app else app

    def _answer_late(self, app: AnyApp, value: Heard) -> None:
        """X10: to its next question, else to its links, else as its event ``late``.

        If the application has ended meanwhile, the words are dropped.
        """
        if app.over:
            self.unheard = value.text
            return
        question = self.wiring.mediator.coming_question(app.name)
        if question is not None and (filled := self._filled(question, value)) is not None:
            self._answer_early(question, filled, "X10")
            return
        now, serial, guard = self.wiring.recorder.now, self.wiring.serial, self.wiring.apps.guard
        data: dict[str, Json] = {"text": value.text}
        link = guard(app, app.listens_to, value.hypotheses)
        if link is not None:
            guard(app, app.follow, now, link, Event("speech", serial, data))
        elif not app.over and guard(app, app.takes, "late"):
            guard(app, app.event, now, Event("late", serial, data))
        else:
            self.unheard = value.text
        self.wiring.act(app)

    def _offer(self, value: Heard) -> bool:
        """X8: an answer that a question refuses may answer the first one of a waiting reaction."""
        question = self.wiring.mediator.offered()
        if question is None:
            return False
        filled = self._filled(question, value)
        if filled is not None:
            self._answer_early(question, filled, "X8")
        self.wiring.act(self.wiring.apps.named[question.app.name])
        return filled is not None

    def _answer_early(self, question: Behavior, data: dict[str, Json], rule: str) -> None:
        """X8, X10: a question is answered before or while it is asked."""
        if self.wiring.mediator.running(question.id) is not None:
            self._conclude(question.id, data)
            return
        self.wiring.mediator.answered(question, data, rule, self.wiring.serial)
        self.wiring.settle()

    @staticmethod
    def _hears(question: Behavior) -> bool:
        """Whether a question takes an answer now: it listens or may be interrupted."""
        command = question.command
        return question.listening or (command is not None and bool(command.args.get("bargein")))

    def _breaks_in(self, value: Heard) -> bool:
        """Whether an application takes what the user says while its prompts are being said."""
        wiring = self.wiring
        now, memory = wiring.recorder.now, wiring.mediator.memory
        for ab in [*memory.running.values(), *memory.waiting.values()]:
            app = self.wiring.apps.named[ab.app.name]
            if ab.command is None or ab.silent:
                continue
            during: Command | None = ab.command
            if ab.state is WAITING:  # between two prompts: the first has just ended
                during = wiring.apps.guard(app, app.before, ab.command) if ab.freed == now else None
            taken = during is not None and wiring.apps.guard(
                app, app.breaks_in, now, during, value, value.hypotheses
            )
            if taken or app.over:
                self.wiring.act(app)
            if taken:
                return True
        return False

    def _follow_links(self, value: Heard, question: Behavior | None) -> bool:
        """V1: try the links; not those of another application's EA if it was said to a question."""
        taken = False
        event = Event("speech", self.wiring.serial, {"text": value.text})
        for app in self.wiring.in_order():
            if question is not None and app.kind != "fa" and app.name != question.app.name:
                continue
            link = self.wiring.apps.guard(app, app.listens_to, value.hypotheses)
            if link is not None:
                taken = True
                self.wiring.apps.guard(app, app.follow, self.wiring.recorder.now, link, event)
            self.wiring.act(app)
        return taken

    def _conclude(self, behavior: str, data: dict[str, Json]) -> None:
        """The answer is the question's end (C4); the devices get the order to stop listening."""
        ab = self.wiring.mediator.running(behavior)
        if ab is not None:
            self.wiring.mediator.orders.append(
                Order("abort", behavior, ab.command, app=ab.app.name)
            )
        self.wiring.mediator.ended(behavior, True, data, inbound=False)
        self.wiring.settle()
