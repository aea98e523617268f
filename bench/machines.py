"""The same state machine written for PRIMA, sismic and transitions.

A ring of states; every ``tick`` adds one to a counter and goes on to the next.
With guards, each state has three, of which the last holds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from prima.interpreter.application import Interpreter
    from prima.interpreter.elements import Document

GUARDS = ("n < 0", "n < -1", "n >= 0")


def prima_text(states: int, guards: bool = False) -> str:
    """The ring as a PRIMA document."""
    act = '<assign name="n" expr="n + 1"/><goto next="#s{}"/>'
    forms = []
    for index in range(states):
        go = act.format((index + 1) % states)
        if guards:
            handlers = "".join(
                f'<on event="tick" cond="{guard.replace("<", "&lt;")}">{go}</on>'
                for guard in GUARDS
            )
        else:
            handlers = f'<on event="tick">{go}</on>'
        forms.append(f'<form id="s{index}">{handlers}</form>')
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="ring">'
    return f'{head}<var name="n" expr="0"/>{"".join(forms)}</prima>'


class Prima:
    """The ring in a session of its own, with its records kept (the trace)."""

    def __init__(self, text: str) -> None:
        from prima.interpreter.reader import read_document
        from prima.language.commands import TABLE_4_2
        from prima.messages import ApplicationLoaded, Occurred
        from prima.scheduler.policy import policy_named
        from prima.session import Session

        document, problems = read_document("ring.xml", text.encode())
        assert not problems, problems
        self.session = Session([document], policy_named("prima"), TABLE_4_2)
        self.session.step(0, [ApplicationLoaded("ring")])
        self.occurred = Occurred
        self.now = 0

    def tick(self, times: int) -> None:
        """Take events in, one at an instant."""
        event = [self.occurred("tick")]
        for now in range(self.now + 1, self.now + times + 1):
            self.session.step(now, event)
        self.now += times
        self.session.drain_visits()  # as whoever drives a session does, after every instant

    def count(self) -> int:
        """The counter, read by the application itself; the trace has to be there too."""
        from prima.interpreter.application import Interpreter

        app = self.session.apps["ring"]
        assert isinstance(app, Interpreter)
        assert len(self.session.drain()) >= self.now, "records are missing"
        return counted(app)


def counted(app: Interpreter) -> int:
    """The counter of a ring."""
    assert app.frame is not None
    return int(app.engine.value("n", (app.frame.document,) * 4))


class Alone:
    """The ring as an application without a session: its interpreter, as the peers are."""

    def __init__(self, document: Document) -> None:
        from prima.interpreter.application import Interpreter
        from prima.messages import Event
        from prima.script.isolated import Engines

        self.made = Event
        self.app = Interpreter(document, None, Engines("none"))
        self.app.start(0)
        self.now = 0

    def tick(self, times: int) -> None:
        """Take events in, one at an instant."""
        for now in range(self.now + 1, self.now + times + 1):
            self.app.event(now, self.made("tick", now))
        self.now += times
        self.app.visits.clear()

    def count(self) -> int:
        """The counter, read by the application itself."""
        assert not self.app.actions
        return counted(self.app)


def applications(scripted: bool, guards: bool = False) -> Callable[[], Alone]:
    """How to make applications of one document that has been read once.

    One with a script needs an ECMAScript engine.
    """
    from prima.interpreter.pyengine import is_python
    from prima.interpreter.reader import read_document

    text = prima_text(2, guards)
    if scripted:
        script = "<script>function next(x) { return x + 1; }</script>"
        text = text.replace('expr="n + 1"', 'expr="next(n)"').replace("<form", f"{script}<form", 1)
    document, problems = read_document("ring.xml", text.encode())
    assert not problems and is_python(document) != scripted, problems
    return lambda: Alone(document)


def sismic_text(states: int, guards: bool = False) -> str:
    """The ring as a sismic statechart."""
    lines = ["statechart:", "  name: ring", "  preamble: n = 0", "  root state:", "    name: root"]
    lines += ["    initial: s0", "    states:"]
    for index in range(states):
        lines += [f"      - name: s{index}", "        transitions:"]
        for guard in GUARDS if guards else ("",):
            lines += [f"          - target: s{(index + 1) % states}", "            event: tick"]
            lines += [f"            guard: {guard}"] if guard else []
            lines += ["            action: n += 1"]
    return "\n".join(lines)


class Sismic:
    """The ring in a sismic interpreter."""

    def __init__(self, text: str) -> None:
        from sismic.interpreter import Interpreter
        from sismic.io import import_from_yaml

        self.interpreter = Interpreter(import_from_yaml(text))
        self.interpreter.execute()

    def tick(self, times: int) -> None:
        """Take events in."""
        for _ in range(times):
            self.interpreter.queue("tick")
            self.interpreter.execute_once()

    def count(self) -> int:
        """The counter."""
        return int(self.interpreter.context["n"])


class Model:
    """The model of a transitions machine; it has no expressions, so guards are Python."""

    def __init__(self) -> None:
        self.n = 0

    def add(self) -> None:
        self.n += 1

    def first(self) -> bool:
        return self.n < 0

    def second(self) -> bool:
        return self.n < -1

    def third(self) -> bool:
        return self.n >= 0


class Transitions:
    """The ring as a transitions machine, made from plain data."""

    def __init__(self, states: int, guards: bool = False) -> None:
        from transitions import Machine

        self.model: Any = Model()
        rows = []
        for index in range(states):
            for guard in ("first", "second", "third") if guards else (None,):
                row: dict[str, Any] = {
                    "trigger": "tick",
                    "source": f"s{index}",
                    "dest": f"s{(index + 1) % states}",
                    "after": "add",
                }
                if guard:
                    row["conditions"] = guard
                rows.append(row)
        names = [f"s{index}" for index in range(states)]
        Machine(self.model, states=names, transitions=rows, initial="s0", auto_transitions=False)

    def tick(self, times: int) -> None:
        """Take events in."""
        for _ in range(times):
            self.model.tick()

    def count(self) -> int:
        """The counter."""
        return int(self.model.n)
