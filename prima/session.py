"""Applications and one mediator, wired: inbound values in, orders out.

A :class:`Session` owns no clock, thread or file. :meth:`Session.step` takes what
happens at one instant and carries it through by rule V3: ends of ABs, then
events, then timeouts, until nothing more happens; then selection, once. What a
session does is a function of its documents and of these calls, so recording
the inbound values is a journal, and feeding them again a replay.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, TypeAlias

from prima.grammar.answers import Answers
from prima.interpreter.application import Interpreter
from prima.interpreter.bounds import Visit
from prima.interpreter.elements import Document
from prima.interpreter.protocol import App
from prima.interpreter.transfers import GoOut
from prima.language.commands import ABSENCE_MS, LATE_MS, PATIENCE_MS, CommandType
from prima.language.values import moment
from prima.messages import (
    PROMOTED,
    Action,
    CloseUnit,
    Command,
    Data,
    Delayed,
    Emergency,
    Ended,
    Event,
    Failed,
    Fetched,
    GoOn,
    Halted,
    Heard,
    Hypothesis,
    Inbound,
    Json,
    LeaveState,
    Listening,
    Loaded,
    Narrated,
    Occurred,
    OpenUnit,
    Order,
    Presence,
    Promote,
    Quit,
    Raise,
    Record,
    Request,
    Say,
    Send,
    Sensed,
    Transferred,
    Unloaded,
    line_of,
)
from prima.scheduler.behavior import WAITING, Behavior, Stream
from prima.scheduler.mediation import Told
from prima.scheduler.mediator import Mediator
from prima.scheduler.policy import Policy
from prima.scheduler.recorder import Recorder
from prima.script.evaluation import EngineLost
from prima.script.isolated import Engines
from prima.script.sandbox import START

if TYPE_CHECKING:
    from prima.voicexml.document import VoiceDocument

AnyDocument: TypeAlias = "Document | VoiceDocument"
AnyApp: TypeAlias = App[Any]


SEEING = frozenset(["human.found", "human.lost"])
"""Events by which the camera tells whether it sees the user (V4)."""


class Session:
    """One robot's applications under one policy.

    ``isolate`` says whose code gets a process of its own
    (:data:`~prima.script.isolated.ISOLATIONS`); :meth:`close` gives these back.
    """

    def __init__(
        self,
        documents: Iterable[AnyDocument],
        policy: Policy,
        commands: Mapping[str, CommandType],
        bound: int | None = None,
        date: str = START,
        absence: int = ABSENCE_MS,
        isolate: str = "ea",
        patience: int = PATIENCE_MS,
    ) -> None:
        self._began = moment(date)
        self._engines = Engines(isolate)
        self._arguments = {name: frozenset(row.arguments) for name, row in commands.items()}
        self.documents = {document.id: document for document in documents}
        self.apps = {name: self._made(one) for name, one in self.documents.items()}
        self.order = {name: index for index, name in enumerate(self.apps)}
        self.recorder = Recorder()
        self._late_answers = policy.has("x10")
        self.mediator = Mediator(policy, commands, self.recorder, bound, absence, patience)
        self.failures: list[str] = []
        self.unheard = ""
        """What the user said last that nobody took."""
        """Applications that ended by an error, as ``NAME: what``."""
        self.defects: list[Exception] = []
        """What has gone wrong in interpreters themselves: each has ended its application."""
        self._serial = 0
        self._promoted = 0
        """The serial number of the event that was promoted last."""
        self._loaded: set[str] = set()
        self._alive: list[AnyApp] | None = []
        """Applications that are loaded and not over, in declared order; None if to be looked up."""
        self._due: dict[str, int] = {}
        """When applications want to be called, by name."""
        self._sensors: dict[str, Json] = {}
        self._lapsed: tuple[str, int] | None = None
        """Whose question nobody answered in time last, and when that was (X10)."""
        self._sends: list[Order] = []
        self._turns: list[tuple[str, Stream]] = []
        """Streams that wait ``suspended`` or have ``resumed`` by the latest selection, with which:
        their applications want to hear of it."""

    def _made(self, document: AnyDocument) -> AnyApp:
        """The interpreter of a document; one for which no engine can be had ends at its start."""

        def make() -> AnyApp:
            return interpreter_of(document, self._arguments, self._began, self._engines)

        try:
            return make()
        except EngineLost as error:
            return self._engines.without(error, make)

    def drain_visits(self) -> list[Visit]:
        """What each application came to since the last time, one application after the other."""
        found: list[Visit] = []
        for app in self.apps.values():
            found += app.visits
            app.visits.clear()
        return found

    # Driving ------------------------------------------------------------------

    def step(self, now: int, inbound: Collection[Inbound]) -> list[Order]:
        """Take in what happens at ``now`` (ms, never less than before); gives the orders.

        Orders are for the devices, in the order in which they were made; ``send``
        orders are for services.
        """
        self.recorder.now = now
        if self._turns:
            self._tell_turns()
        for value in sorted(inbound, key=self._class) if len(inbound) > 1 else inbound:
            if type(value) is Occurred:  # by far the most
                self._occurred(value)
            else:
                self._take(value)
        mediator = self.mediator
        if self._due or mediator.memory.behaviors or mediator.holds:
            self._time_out(now)
        if mediator.told:
            self._settle()
        orders: list[Order] = []
        if mediator.changed:  # else it has given no orders either
            mediator.select()
            self._note_turns()
            orders = mediator.drain_orders()
        if self._sends:
            orders += self._sends
            self._sends = []
        return orders

    def deadline(self) -> int | None:
        """The next instant at which :meth:`step` has to be called, if anything is due."""
        if self._turns:
            return self.recorder.now + 1
        due = min(self._due.values(), default=None)
        late = self.mediator.deadline()
        return late if due is None else due if late is None else min(due, late)

    def close(self) -> None:
        """Give back the processes in which code was evaluated: the session is over."""
        self._engines.close()

    @property
    def written(self) -> int:
        """Characters that the applications have said, logged and sent."""
        return sum(app.written for app in self.apps.values())

    def drain(self) -> list[Record]:
        """Give the records made since the last time."""
        return self.recorder.drain()

    @property
    def over(self) -> bool:
        """Whether every application that was loaded has ended."""
        return bool(self._loaded) and not self._living()

    @property
    def idle(self) -> bool:
        """Whether nothing runs or waits in working memory."""
        return not self.mediator.memory.behaviors

    def _class(self, value: Inbound) -> tuple[int, int]:
        """V3: class, and for ends the application, the one whose stream is active first."""
        if isinstance(value, Ended | Listening | Halted | Failed):
            return 0, self._rank(value.behavior.partition("#")[0])
        return 1, 0

    def _rank(self, name: str) -> int:
        active = self.mediator.memory.active
        return -1 if active is not None and active.name == name else self.order.get(name, 0)

    def _in_order(self) -> list[AnyApp]:
        """V3: the applications in declared order, the one whose stream is active first."""
        living = self._living() if self._alive is None else self._alive
        if len(living) == 1:
            return living
        active = self.mediator.memory.active
        if active is None:
            return living
        first = self.apps[active.name]
        if first.over or first is living[0]:
            return living
        return [first, *(app for app in living if app is not first)]

    def _living(self) -> list[AnyApp]:
        if self._alive is None:
            self._alive = [
                app for name, app in self.apps.items() if name in self._loaded and not app.over
            ]
        return self._alive

    # Inbound ------------------------------------------------------------------

    def _take(self, value: Inbound) -> None:
        match value:
            case Ended():
                self._lapse(value)
                self.mediator.ended(value.behavior, value.goal, value.data)
                self._settle()
            case Listening():
                self._record("listening", "robot", behavior=value.behavior)
                self.mediator.listening(value.behavior)
            case Halted():
                self.mediator.interrupted(value.behavior, value.data)
                self._settle()
            case Failed():
                self.mediator.failed(value.behavior, value.device, value.reason)
                self._settle()
            case Heard():
                self._heard(value)
            case Fetched():
                told = {key: one for key, one in asdict(value).items() if one and key != "app"}
                self._record("fetched", "environment", app=value.app, data=told)
                self._answered(value)
            case Transferred():
                self._record(
                    "transferred",
                    "environment",
                    app=value.app,
                    serial=value.serial,
                    outcome=value.outcome,
                    data={"uri": value.uri},
                )
                self._answered(value)
            case Sensed():
                self._sensed(value)
            case Delayed():
                self._record(
                    "delayed",
                    "robot",
                    behavior=value.behavior,
                    device=value.device,
                    data={"waited": value.waited / 1000},
                )
            case Presence():
                self._record(
                    "device",
                    "environment",
                    device=value.device,
                    outcome="back" if value.there else "missing",
                    message=value.reason or None,
                )
            case Narrated():
                self._record("note", value.actor, text=value.text)
            case Emergency():
                self._emergency(value)
            case Loaded():
                self._load(value)
            case Unloaded():
                self._record("unload", "environment", app=value.app, data=place_data(value))
                app = self.apps.get(value.app)
                if app is not None and value.app in self._loaded:
                    with self._contained(app):
                        app.stop()
                    self._act(app)

    def _emergency(self, value: Emergency) -> None:
        """E5: applications are told by an event, whose serial number the record has."""
        self._serial += 1
        self.mediator.emergency(value.pressed, value.resume, self._serial)
        name = "emergency.stop" if value.pressed else "emergency.release"
        event = Event(name, self._serial, {}, reactive=True, shared=True)
        for app in self._in_order():
            with self._contained(app):
                app.event(self.recorder.now, event)
            self._act(app)
        self._settle()

    @contextmanager
    def _contained(self, app: AnyApp) -> Iterator[None]:
        """E2: what goes wrong in an application's interpreter ends that application alone."""
        try:
            yield
        except Exception as error:
            self._defect(app, error)

    def _defect(self, app: AnyApp, error: Exception) -> None:
        if not isinstance(error, EngineLost | GoOut):
            self.defects.append(error)
        app.fail(error)

    def _record(self, phase: str, actor: str, **fields: Json) -> None:
        self.recorder.add(phase, actor, inbound=True, **fields)

    def _load(self, value: Loaded) -> None:
        name = value.app
        self._record("load", "environment", app=name, data=place_data(value))
        app = self.apps[name]
        if name in self._loaded:
            if not app.over:
                return
            before, app = app, self._made(self.documents[name])
            app.visits[:0] = before.visits
            self.apps[name] = app
        self._loaded.add(name)
        self._alive = None
        app.sensors.update(self._sensors)
        app.connection = value.connection
        self.mediator.load(name, app.kind, self.documents[name].lang, self.order[name])
        with self._contained(app):
            app.start(self.recorder.now)
        self._act(app)
        if self._sensors:  # what it watches for may be so already
            self._look(app, {})
        self._settle()

    def _occurred(self, value: Occurred) -> None:
        name, app, data = value.name, value.app, value.data
        self._serial = serial = self._serial + 1
        self.recorder.event(name, value.actor, app, data, serial)
        if name in SEEING:
            self.mediator.sees_user(name == "human.found")
        elif value.actor == "user":
            self.mediator.senses_user()
        apps = self._alive if app is None else self._alone(app)
        if apps is None or len(apps) > 1:
            apps = self._in_order()
        event = Event(name, serial, data, True, shared=app is None)
        for one in apps:
            try:
                one.event(self.recorder.now, event)
            except Exception as error:  # as _contained does, which takes longer
                self._defect(one, error)
            if one.actions or self._due or one.deadline is not None:
                self._act(one)

    def _alone(self, name: str) -> list[AnyApp]:
        """The application of a name, if it is there."""
        app = self.apps.get(name)
        return [app] if app is not None and name in self._loaded and not app.over else []

    def listening(self) -> list[Answers]:
        """What is listened for: by the question that listens or may be interrupted, and by links (V1)."""
        asked: list[Answers | None] = []
        question = self.mediator.question()
        if question is not None and question.run is not None and self._hears(question):
            asked.append(self.apps[question.app.name].answers(question.run.number))
        for ab in self.mediator.memory.running.values():
            if ab.command is not None and not ab.silent:
                asked.append(self.apps[ab.app.name].open_during(ab.command))
        found = [answers for answers in asked if answers is not None]
        for app in self._in_order():
            found += app.listening()
        return found

    def _heard(self, value: Heard) -> None:
        """V1: the question that listens, then links that listen all the time, then nomatch."""
        self.mediator.senses_user()
        self._serial += 1
        told, said = dict(value.data), value.hypotheses
        question = self.mediator.question()
        if question is not None and not self._hears(question):
            question = None
        late = self._late_for(value, question)
        lasted = {"lasted": value.lasted / 1000} if value.lasted and self._late_answers else {}
        self._record(
            "event",
            "user",
            app=late.name if late is not None else None,
            event="speech",
            text=value.text,
            data={**told, **lasted} or None,
            rule="X10" if late is not None else None,
            serial=self._serial,
        )
        if late is not None:
            self._answer_late(late, value, said)
            return
        asked = question.command if question is not None else None
        if question is not None and told.get("toolong") and asked and asked.cued("longest"):
            self._conclude(question.id, {"outcome": "maxspeechtimeout", "utterance": value.text})
            return
        if question is not None and question.run is not None:
            asking, answer, link = self.apps[question.app.name], None, None
            with self._contained(asking):
                answer = asking.answer(question.run.number, said)
            if answer is not None:
                self._conclude(question.id, value.filled(answer))
                return
            with self._contained(asking):
                link = asking.listens_to(said)
            if link is not None and link.event:
                # As in VoiceXML, a link ends the input of the field that is being visited.
                self._conclude(question.id, {"outcome": link.event, "utterance": value.text})
                return
        if question is None and self._breaks_in(value, said):
            return
        if self._follow_links(value.text, said, question):
            return
        if question is None or question.silent:
            self.unheard = value.text
            return
        if self._offer(value, said):
            return
        if asked is None or not asked.cued("hotword"):
            self._conclude(question.id, {"outcome": "nomatch", "utterance": value.text, **told})

    def _lapse(self, value: Ended) -> None:
        """X10: note the question that nobody has answered in time."""
        if not self._late_answers or value.data.get("outcome") != "noinput":
            return
        question = self.mediator.running(value.behavior)
        if question is not None and not question.silent:
            self._lapsed = question.app.name, self.recorder.now

    def _late_for(self, value: Heard, question: Behavior | None) -> AnyApp | None:
        """X10: whose question the user answers too late, unless it asks again and listens."""
        if self._lapsed is None:
            return None
        name, when = self._lapsed
        app = self.apps[name]
        if app.over or self.recorder.now - value.lasted - when > LATE_MS:
            self._lapsed = None
            return None
        return None if question is not None and question.app.name == name else app

    def _answer_late(self, app: AnyApp, value: Heard, said: list[Hypothesis]) -> None:
        """X10: to its next question, else to its links, else as its event ``late``."""
        question, answer, link = self.mediator.coming_question(app.name), None, None
        if question is not None and question.run is not None:
            with self._contained(app):
                answer = app.answer(question.run.number, said)
        if question is not None and answer is not None:
            self._answer_early(question, value.filled(answer), "X10")
            return
        data: dict[str, Json] = {"text": value.text}
        with self._contained(app):
            link = app.listens_to(said)
            if link is not None:
                app.follow(self.recorder.now, link, Event("speech", self._serial, data))
            elif app.takes("late"):
                app.event(self.recorder.now, Event("late", self._serial, data))
            else:
                self.unheard = value.text
        self._act(app)

    def _offer(self, value: Heard, said: list[Hypothesis]) -> bool:
        """X8: what a question refuses may answer the first one of a reaction that waits."""
        question, answer = self.mediator.offered(), None
        if question is None or question.run is None:
            return False
        app = self.apps[question.app.name]
        with self._contained(app):
            answer = app.answer(question.run.number, said)
        if answer is not None:
            self._answer_early(question, value.filled(answer), "X8")
        self._act(app)
        return answer is not None

    def _answer_early(self, question: Behavior, data: dict[str, Json], rule: str) -> None:
        """X8, X10: a question is answered that is still to be asked, or is being asked."""
        if self.mediator.running(question.id) is not None:
            self._conclude(question.id, data)
            return
        self.mediator.answered(question, data, rule, self._serial)
        self._settle()

    @staticmethod
    def _hears(question: Behavior) -> bool:
        """Whether a question takes an answer now: it listens, or may be interrupted."""
        command = question.command
        return question.listening or (command is not None and bool(command.args.get("bargein")))

    def _breaks_in(self, value: Heard, said: list[Hypothesis]) -> bool:
        """Whether an application takes what the user says while its prompts are being said."""
        now, memory = self.recorder.now, self.mediator.memory
        for ab in [*memory.running.values(), *memory.waiting.values()]:
            app = self.apps[ab.app.name]
            if ab.command is None or ab.silent:
                continue
            during: Command | None = ab.command
            taken = False
            with self._contained(app):
                if ab.state is WAITING:  # between two prompts, the first of which has just ended
                    during = app.before(ab.command) if ab.freed == now else None
                taken = during is not None and app.breaks_in(now, during, value, said)
            if taken or app.over:
                self._act(app)
            if taken:
                return True
        return False

    def _follow_links(self, text: str, said: list[Hypothesis], question: Behavior | None) -> bool:
        """V1: links take it; what was said to a question, no link of another application's EA."""
        taken = False
        event = Event("speech", self._serial, {"text": text})
        for app in self._in_order():
            if question is not None and app.kind != "fa" and app.name != question.app.name:
                continue
            with self._contained(app):
                link = app.listens_to(said)
                if link is not None:
                    taken = True
                    app.follow(self.recorder.now, link, event)
            self._act(app)
        return taken

    def _answered(self, value: Fetched | Transferred) -> None:
        """An answer goes to the application that has asked."""
        app = self.apps.get(value.app)
        if app is not None and value.app in self._loaded:
            with self._contained(app):
                app.replied(self.recorder.now, value)
            self._act(app)
            self._settle()

    def _conclude(self, behavior: str, data: dict[str, Json]) -> None:
        """The answer is the question's end (C4); the devices are told to stop listening."""
        ab = self.mediator.running(behavior)
        if ab is not None:
            self.mediator.orders.append(Order("abort", behavior, ab.command, app=ab.app.name))
        self.mediator.ended(behavior, True, data, inbound=False)
        self._settle()

    def _sensed(self, value: Sensed) -> None:
        self._record("sensed", "environment", data=dict(value.values))
        self._sensors.update(value.values)
        for app in self._in_order():
            self._look(app, value.values)

    def _look(self, app: AnyApp, values: Data) -> None:
        """C6: an application is told of sensors, and its conditions on them may have turned true."""
        raised: list[str] = []
        with self._contained(app):
            raised = app.sensed(self.recorder.now, values)
        for name in raised:
            self._own_event(app, name, {}, reactive=True)
        self._act(app)

    def _own_event(self, app: AnyApp, name: str, data: dict[str, Json], reactive: bool) -> None:
        """An event that one application alone has defined."""
        self._handle_own(app, name, data, reactive)
        self._act(app)

    def _handle_own(self, app: AnyApp, name: str, data: dict[str, Json], reactive: bool) -> None:
        """Let the application handle its own event; what it wants then is still to be done."""
        serial = self._record_own(app, name, data, "environment")
        with self._contained(app):
            app.event(self.recorder.now, Event(name, serial, data, reactive))

    def _record_own(self, app: AnyApp, name: str, data: Data, actor: str) -> int:
        """Record an event that one application alone has defined; gives its serial number."""
        self._serial += 1
        self.recorder.add(
            "event",
            actor,
            app=app.name,
            event=name,
            data=dict(data) or None,
            serial=self._serial,
        )
        return self._serial

    def _time_out(self, now: int) -> None:
        """V3: timeouts come last."""
        if self.mediator.expire():
            self._settle()
        if not self._due or min(self._due.values()) > now:
            return
        for app in self._in_order():
            due: list[tuple[str, Data]] = []
            with self._contained(app):
                due = app.expire(now)
            for name, data in due:
                self._own_event(app, name, dict(data), reactive=False)
            self._act(app)

    # Outbound -----------------------------------------------------------------

    def _settle(self) -> None:
        """Tell applications what became of their Commands, until nobody has more to say."""
        told_queue = self.mediator.told
        while told_queue:
            told = told_queue.popleft()
            self._tell(told)

    def _tell(self, told: Told) -> None:
        app = self.apps[told.app]
        if app.over:
            return
        self.mediator.open_window(told)
        for notice in told.notices:
            with self._contained(app):
                app.notice(self.recorder.now, notice)
            self._act(app)
        self.mediator.close_window(told)

    def _note_turns(self) -> None:
        """Keep the streams that wait suspended or have resumed of which an application will hear."""
        for name, stream in self.mediator.drain_turns():
            app = self.apps[stream.app.name]
            with self._contained(app):
                if app.takes(name):
                    self._turns.append((name, stream))
            if app.over and app.actions:
                self._act(app)

    def _tell_turns(self) -> None:
        """Tell applications that their streams wait suspended or have resumed (C2).

        What they ask for then belongs to the stream and is no reaction.
        """
        turns, self._turns = self._turns, []
        for name, stream in turns:
            app = self.apps[stream.app.name]
            told = Told(app.name, stream if stream.open else None, [])
            self.mediator.open_window(told)
            with self._contained(app):
                app.event(self.recorder.now, Event(name, 0, {}, reactive=False, shared=True))
            self._act(app)
            self.mediator.close_window(told)

    def _act(self, app: AnyApp) -> None:
        """Carry out what an application wants, and note when it wants to be called."""
        if app.actions:
            self._carry_out(app)
        due = app.deadline
        if due is not None:
            self._due[app.name] = due
        elif self._due:
            self._due.pop(app.name, None)

    def _carry_out(self, app: AnyApp) -> None:
        """Do what an application wants, in order; what comes of its own events first."""
        left: deque[Action] = deque()
        while app.actions or left:
            left.extendleft(reversed(app.actions))
            app.actions.clear()
            try:
                app.count_action()
            except GoOut as error:
                app.fail(error)
            match action := left.popleft():
                case Request():
                    if action.cause == PROMOTED:
                        action.cause = self._promoted
                    self.mediator.request(app.name, action)
                case OpenUnit():
                    if action.cause == PROMOTED:
                        action.cause = self._promoted
                    self.mediator.open_unit(app.name, action)
                case CloseUnit():
                    self.mediator.close_unit(app.name, action)
                case LeaveState():
                    self.mediator.leave_state(app.name, action)
                case Send():
                    self._send(app, action)
                case Say():
                    self._log(app, action)
                case Raise():
                    self._handle_own(app, action.event, {}, reactive=True)
                case Promote():
                    self._promoted = self._record_own(app, action.event, {}, "robot")
                case GoOn():
                    with self._contained(app):
                        app.go_on_entering(action.state)
                case Quit():
                    self._quit(app, action)

    def _send(self, app: AnyApp, action: Send) -> None:
        data = {"to": action.service, **action.data}
        self.recorder.add(
            "send",
            "robot",
            app=app.name,
            data=data,
            serial=action.serial,
            source=line_of(action.source),
        )
        order = Order("send", f"{app.name}!{action.serial}", app=app.name)
        order.data = data
        self._sends.append(order)

    def _log(self, app: AnyApp, action: Say) -> None:
        self.recorder.add(
            "log" if action.level == "log" else "error",
            "robot",
            app=app.name,
            message=action.text,
            source=line_of(action.source),
        )

    def _quit(self, app: AnyApp, action: Quit) -> None:
        self._alive = None
        if action.failed:
            self.failures.append(f"{app.name}: {action.reason}")
        self.mediator.unload(app.name, action.reason)


def interpreter_of(
    document: AnyDocument,
    arguments: Mapping[str, frozenset[str]],
    began: int,
    engines: Engines,
) -> AnyApp:
    """The interpreter of a document, of whichever language it is, in a run that began then."""
    app: AnyApp
    if isinstance(document, Document):
        app = Interpreter(document, arguments, engines)
    else:
        from prima.voicexml.application import VoiceInterpreter

        app = VoiceInterpreter(document, engines)
    app.began = began
    return app


def place_data(value: Loaded | Unloaded) -> dict[str, Json] | None:
    """What a record tells of an application that comes or goes with a place, or has a caller."""
    told: dict[str, Json] = {"place": value.place} if value.place else {}
    if isinstance(value, Loaded) and value.connection:
        told["connection"] = dict(value.connection)
    return told or None
