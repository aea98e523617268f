"""Each workload does its work, checks the result, and gives one figure.

Figures are events, decisions or simulated seconds a second (``rate``), or
seconds (``time``).
"""

from __future__ import annotations

import gc
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter

from bench.machines import Prima, Sismic, Transitions, prima_text, sismic_text

Machine = Prima | Sismic | Transitions
ROOT = Path(__file__).parent.parent
DEMO = ROOT / "documents" / "scenarios" / "follow-during-navigation.xml"


def build(system: str, states: int, guards: bool = False) -> Callable[[], Machine]:
    """How to make a system's machine from its text or data."""
    if system == "prima":
        text = prima_text(states, guards)
        return lambda: Prima(text)
    if system == "sismic":
        chart = sismic_text(states, guards)
        return lambda: Sismic(chart)
    return lambda: Transitions(states, guards)


def rate(system: str, states: int, events: int, guards: bool = False) -> float:
    """W1, W2: events a second."""
    machine = build(system, states, guards)()
    machine.tick(max(events // 20, 1))
    began = perf_counter()
    machine.tick(events)
    lasted = perf_counter() - began
    assert machine.count() == events + max(events // 20, 1), "events are missing"
    return events / lasted


def load(system: str, states: int) -> float:
    """W3: seconds from text to a started machine, which must then work."""
    make = build(system, states)
    began = perf_counter()
    machine = make()
    lasted = perf_counter() - began
    machine.tick(3)
    assert machine.count() == 3
    return lasted


def many(system: str, machines: int) -> tuple[float, float]:
    """W4: seconds for machines with ten events each, and MB that they take."""
    make = build(system, 2)
    gc.collect()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began = perf_counter()
    made = [make() for _ in range(machines)]
    for machine in made:
        machine.tick(10)
    lasted = perf_counter() - began
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert all(machine.count() == 10 for machine in made)
    return lasted, (after - before) / 1024


def decisions(waiting: int, ends: int) -> float:
    """Mediator: decisions a second while that many ABs of as many applications wait."""
    from prima.commands import TABLE_4_2
    from prima.messages import Command, Request, Step
    from prima.scheduler.chronicle import Chronicle
    from prima.scheduler.mediator import Mediator
    from prima.scheduler.selection import policy_named

    chronicle = Chronicle()
    mediator = Mediator(policy_named("prima"), TABLE_4_2, chronicle)
    for index in range(waiting + 1):
        mediator.load(f"a{index}", "ea")
        mediator.request(f"a{index}", Request(1, [Step(Command("speak", {}, "Hello."))], 1))
    mediator.select()
    chronicle.drain()
    made = 0
    began = perf_counter()
    for turn in range(ends):
        chronicle.now += 1
        running = next(iter(mediator.memory.running.values()))
        mediator.ended(running.id, True, {})
        mediator.told.clear()
        again = Request(turn + 2, [Step(Command("speak", {}, "Hello."))], 1)
        mediator.request(running.app.name, again)
        mediator.select()
        made += sum(record["phase"] == "decision" for record in chronicle.drain())
    lasted = perf_counter() - began
    assert made == ends, "decisions are missing"
    return made / lasted


def voicexml_text(dialogs: int) -> bytes:
    """A VoiceXML document of forms with fields, options, handlers and conditions."""
    forms = "".join(
        f"""<form id="f{i}"><field name="a{i}"><prompt timeout="4s">Question {i} of
<value expr="count"/>: what is it?</prompt><option value="one">the first</option>
<option>the second of {i}</option><noinput count="2"><assign name="count" expr="count + 1"/>
<reprompt/></noinput><filled><if cond="a{i} == 'one'"><goto next="#f{(i + 1) % dialogs}"/>
<else/><prompt>Then goodbye.</prompt><exit/></if></filled></field></form>\n"""
        for i in range(dialogs)
    )
    head = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">'
    return f'{head}<var name="count" expr="0"/>{forms}</vxml>'.encode()


def voicexml(system: str, dialogs: int) -> float:
    """Seconds from a VoiceXML document's bytes to its first question; ``lxml`` parses and validates.

    The document is loaded once before: imports and the schema's own compilation do not count.
    """
    data = voicexml_text(dialogs)
    once = _lxml(data) if system == "lxml" else _prima_voice(data)
    once()
    taken = []
    for _ in range(7):
        gc.collect()
        began = perf_counter()
        once()
        taken.append(perf_counter() - began)
    return median(taken)


def _lxml(data: bytes) -> Callable[[], None]:
    """Parse, and validate by an XML Schema of VoiceXML's elements and attributes."""
    from dataclasses import replace

    from lxml import etree

    from prima.markup.schema import make_schema
    from prima.markup.vocabulary import Vocabulary
    from prima.voicexml.vocabulary import VOICEXML

    elements = [
        replace(one, attributes=tuple(a for a in one.attributes if ":" not in a.name))
        for one in VOICEXML.elements.values()
    ]
    text = make_schema(Vocabulary(VOICEXML.namespace, "voicexml", "vxml", elements))
    for line in text.splitlines():
        if "xs:import" in line or 'ref="xml:lang"' in line:
            loose = "" if "xs:import" in line else '<xs:anyAttribute processContents="skip"/>'
            text = text.replace(line, loose)
    schema = etree.XMLSchema(etree.fromstring(text.encode()))
    wrong = etree.fromstring(data.replace(b"<exit/>", b"<exti/>", 1))
    assert not schema.validate(wrong), "the schema checks nothing"

    def once() -> None:
        assert schema.validate(etree.fromstring(data)), schema.error_log

    return once


def _prima_voice(data: bytes) -> Callable[[], None]:
    from prima.commands import TABLE_4_2
    from prima.loading import read_application
    from prima.messages import Loaded
    from prima.scheduler.selection import policy_named
    from prima.session import Session

    def once() -> None:
        document, problems = read_application("bench.vxml", data)
        assert not problems, problems[0]
        session = Session([document], policy_named("prima"), TABLE_4_2)
        session.step(0, [Loaded(document.id)])
        (asked,) = session.mediator.memory.running.values()
        assert asked.command and asked.command.text == "Question 0 of 0: what is it?"

    return once


def simulate(runs: int) -> float:
    """Simulated seconds a second of the demo, in one process, physics on."""
    from prima import api

    loaded = api.load_scenario(DEMO)
    simulated = 0.0
    api.rehearse(loaded, keep=False)
    began = perf_counter()
    for _ in range(runs):
        transcript = api.rehearse(loaded, keep=False)
        simulated += transcript.summary().seconds
    lasted = perf_counter() - began
    assert simulated > runs * 60, "the demo was cut short"
    return simulated / lasted


IMPORTS = "import click, lxml.etree, pydantic, pymunk, networkx, _quickjs"
LIGHT = "import click, lxml.etree, _quickjs"
TINY_SISMIC = (
    "from bench.machines import Sismic, sismic_text\n"
    "m = Sismic(sismic_text(2)); m.tick(1); assert m.count() == 1"
)
TINY_TRANSITIONS = (
    "from bench.machines import Transitions\nm = Transitions(2); m.tick(1); assert m.count() == 1"
)


def process(what: str) -> float:
    """W5 and start: seconds of a whole process, which must end well."""
    python = sys.executable
    with tempfile.TemporaryDirectory() as folder:
        pair = [python, "-m", "prima", "run", str(DEMO), "-o", f"{folder}/t.jsonl"]
        commands = {
            "bare": [python, "-c", "pass"],
            "click": [python, "-c", "import click"],
            "light": [python, "-c", LIGHT],
            "imports": [python, "-c", IMPORTS],
            "help": [python, "-m", "prima", "--help"],
            "validate": [python, "-m", "prima", "validate", str(ROOT / "documents/fa/follow.xml")],
            "run": pair,
            "sismic": [python, "-c", TINY_SISMIC],
            "transitions": [python, "-c", TINY_TRANSITIONS],
        }
        began = perf_counter()
        done = subprocess.run(commands[what], capture_output=True, cwd=ROOT, check=True)
        lasted = perf_counter() - began
        if what == "help":
            assert b"validate" in done.stdout
        if what == "run":
            assert (Path(folder) / "t.jsonl").stat().st_size > 10_000
        return lasted
