"""Machines and documents: each workload does its work, checks it, and gives one figure.

Figures are events a second (``rate``), seconds, megabytes, or plain numbers.
"""

from __future__ import annotations

import gc
import math
import os
import random
import resource
import sys
from collections.abc import Callable
from statistics import linear_regression, median
from time import perf_counter

from bench import peers
from bench.fresh import check, fresh, note
from bench.machines import (
    Alone,
    Prima,
    Sismic,
    Transitions,
    applications,
    prima_text,
    sismic_text,
)

Machine = Prima | Alone | Sismic | Transitions
BATCH = 200
"""Events between two looks at the clock."""
ROUNDS_BEFORE = 8
"""How often a ring is gone round before the clock is looked at: PRIMA compiles what happens often."""
MOST_EVENTS = 200_000
"""Events of one measurement: the trace of all of them is kept."""
MOST_TICKS = 1_000
"""Events that show that a loaded machine works: once round, if it is not too far."""


def build(system: str, states: int, guards: bool = False) -> Callable[[], Machine]:
    """How to make a system's machine from its text or data; a text is one that nobody has read."""
    if system == "prima":
        text = f"<!-- {os.urandom(8).hex()} -->{prima_text(states, guards)}"
        return lambda: Prima(text)
    if system in ("application", "scripted"):
        return applications(system == "scripted", guards)
    if system == "sismic":
        chart = sismic_text(states, guards)
        return lambda: Sismic(chart)
    return lambda: Transitions(states, guards)


def rate(system: str, states: int, seconds: float, guards: bool = False) -> float:
    """W1, W2: events a second, of as many as come in that time."""
    if system in peers.PEERS:
        return peers.rate(system, states, seconds, guards)
    machine = build(system, states, guards)()
    before = max(BATCH, ROUNDS_BEFORE * states)
    machine.tick(before)
    events, lasted = 0, 0.0
    began = perf_counter()
    while lasted < seconds and events < MOST_EVENTS:
        machine.tick(BATCH)
        events += BATCH
        lasted = perf_counter() - began
    check(machine.count() == before + events, f"{system}: events are missing")
    return events / lasted


# Load -------------------------------------------------------------------------


def load(system: str, states: int) -> float:
    """W3: seconds from text to a started machine, which must then work; imports are done before.

    The median of several for a small one.
    """
    build(system, 2)()
    ticks = min(states, MOST_TICKS) + 3
    taken = []
    for _ in range(max(2_000 // states, 1)):
        make = build(system, states)
        gc.collect()
        began = perf_counter()
        machine = make()
        taken.append(perf_counter() - began)
        machine.tick(ticks)
        check(machine.count() == ticks, f"{system}: events are missing")
    if system == "prima":
        refuses_what_is_wrong()
    return median(taken)


def refuses_what_is_wrong() -> None:
    """Whether PRIMA checks what it loads, and knows the place of everything.

    Raises:
        WrongAnswer: it does not.
    """
    from prima.interpreter.reader import read_document

    text = prima_text(20).replace("><form", ">\n  <form")
    wrong = text.replace('next="#s0"', 'nxet="#s0"')
    where = wrong.splitlines().index(next(x for x in wrong.splitlines() if "nxet" in x))
    column = wrong.splitlines()[where].index("nxet")
    found = [one.place for one in read_document("ring.xml", wrong.encode())[1]]
    check(
        any((place.line, place.column) == (where + 1, column + 1) for place in found),
        f"an unknown attribute at {where + 1}:{column + 1} is reported at {found}",
    )


def growth(largest: int) -> float:
    """How load grows with the number of states: the exponent, over sizes up to the largest."""
    sizes = sorted({max(largest // part, 1) for part in (200, 20, 4, 1)})
    taken = {size: fresh(load, "prima", size).value for size in random.sample(sizes, len(sizes))}
    logs = [math.log(size) for size in sizes], [math.log(taken[size]) for size in sizes]
    return linear_regression(*logs).slope


def second_load(states: int) -> float:
    """The time of reading the same bytes again, as a share of the first time."""
    from prima.interpreter.reader import read_document

    build("prima", 2)()
    text = f"<!-- {os.urandom(8).hex()} -->{prima_text(states)}"
    taken = []
    for _ in range(2):
        data = text.encode()  # equal bytes, but not the same ones
        gc.collect()
        began = perf_counter()
        document, problems = read_document("ring.xml", data)
        taken.append(perf_counter() - began)
        check(not problems and document.id == "ring", "it is not read")
    one, other = Prima(text), Prima(text)
    one.tick(3)
    other.tick(2)
    check((one.count(), other.count()) == (3, 2), "what is loaded twice shares its state")
    other_text = text.replace('expr="n + 1"', 'expr="n + 2"', states)
    third = Prima(other_text)
    third.tick(3)
    check(third.count() == 6, "other bytes are taken for the same ones")
    return taken[1] / taken[0]


# Many -------------------------------------------------------------------------


def memory() -> float:
    """Megabytes that this process has in memory now (where the system does not say: at most)."""
    try:
        with open("/proc/self/statm", encoding="ascii") as stream:
            return int(stream.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    except OSError:
        unit = 1 if sys.platform == "darwin" else 1024
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


def _many(system: str, machines: int, seconds: float) -> tuple[float, float]:
    """Seconds and megabytes for machines that live at once, with ten events each.

    What is not ready in that time is reckoned from what is.
    """
    make = build(system, 2)
    make().tick(1)
    gc.collect()
    before = memory()
    made: list[Machine] = []
    began = perf_counter()
    while len(made) < machines and perf_counter() - began < seconds:
        made.append(make())
        made[-1].tick(10)
    lasted = perf_counter() - began
    more = memory() - before
    check(all(machine.count() == 10 for machine in made), f"{system}: events are missing")
    if len(made) < machines:
        note(f"{len(made):,} measured")
    return lasted * machines / len(made), more * machines / len(made)


def many(system: str, machines: int, seconds: float) -> float:
    """W4: seconds for machines with ten events each."""
    return _many(system, machines, seconds)[0]


def many_memory(system: str, machines: int, seconds: float) -> float:
    """W4: megabytes for machines with ten events each."""
    return _many(system, machines, seconds)[1]


# VoiceXML ---------------------------------------------------------------------


def voicexml_text(dialogs: int) -> bytes:
    """A VoiceXML document that nobody has read: forms with fields, handlers and conditions."""
    forms = "".join(
        f"""<form id="f{i}"><field name="a{i}"><prompt timeout="4s">Question {i} of
<value expr="count"/>: what is it?</prompt><option value="one">the first</option>
<option>the second of {i}</option><noinput count="2"><assign name="count" expr="count + 1"/>
<reprompt/></noinput><filled><if cond="a{i} == 'one'"><goto next="#f{(i + 1) % dialogs}"/>
<else/><prompt>Then goodbye.</prompt><exit/></if></filled></field></form>\n"""
        for i in range(dialogs)
    )
    head = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">'
    unread = f"<!-- {os.urandom(8).hex()} -->"
    return f'{unread}{head}<var name="count" expr="0"/>{forms}</vxml>'.encode()


def voicexml(system: str, dialogs: int) -> float:
    """Seconds from a VoiceXML document's bytes to its first question; ``lxml`` parses and validates.

    Another one is loaded before: imports and the schema's own compilation do not count.
    """
    once = _lxml() if system == "lxml" else _prima_voice
    once(voicexml_text(dialogs))
    taken = []
    for _ in range(7):
        data = voicexml_text(dialogs)
        gc.collect()
        began = perf_counter()
        once(data)
        taken.append(perf_counter() - began)
    return median(taken)


def _lxml() -> Callable[[bytes], None]:
    """Parse, and validate by an XML Schema of VoiceXML's elements and attributes."""
    from dataclasses import replace

    from lxml import etree

    from prima.markup.vocabulary import Vocabulary
    from prima.voicexml.vocabulary import VOICEXML
    from tools.xsd import make_schema

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
    wrong = etree.fromstring(voicexml_text(1).replace(b"<exit/>", b"<exti/>", 1))
    check(not schema.validate(wrong), "the schema checks nothing")

    def once(data: bytes) -> None:
        check(schema.validate(etree.fromstring(data)), str(schema.error_log))

    return once


def _prima_voice(data: bytes) -> None:
    from prima.language.commands import TABLE_4_2
    from prima.loading import read_application
    from prima.messages import ApplicationLoaded
    from prima.scheduler.policy import policy_named
    from prima.session import Session

    document, problems = read_application("bench.vxml", data)
    check(not problems, str(problems[:1]))
    session = Session([document], policy_named("prima"), TABLE_4_2)
    (order,) = session.step(0, [ApplicationLoaded(document.id)])
    asked = order.command.text if order.command else None
    check(asked == "Question 0 of 0: what is it?", f"the first question is {asked!r}")
