"""Ten faults planted in documents, each of which only some timings show: explorations find all."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from prima import api
from prima.experiments.explore import Exploration, ExplorationPlan
from prima.experiments.explored import Explored, carried_out
from prima.experiments.pools import local
from tests import ROOT

HEAD = 'xmlns="urn:prima:dialogue:1" version="1.0"'
TOUCH = '<when id="touch" at="{at}"><touch sensor="head"/></when>'
MESSAGE = '<when id="message" at="{at}"><message from="Ann">I am late.</message></when>'
TALK = """
<form id="hello"><block><speak>Welcome to the museum of clocks.</speak></block>
<block><speak>The oldest one is from sixteen hundred.</speak></block>
<block><goto next="#ask"/></block></form>
<form id="ask"><field name="more"><prompt>Shall I go on?</prompt><option>Yes.</option>
<filled><exit/></filled><noinput><exit/></noinput></field></form>"""


@dataclass
class Fault:
    """Documents with a fault, and how it shows."""

    kind: str
    told: str
    ea: str = TALK
    fa: str = '<form id="pet"><on event="touch"><speak>That tickles!</speak></on></form>'
    events: str = TOUCH.format(at="20s")
    more: str = ""
    """Expectations."""
    within: int = 20_000
    until: str = "60s"


FAULTS = {
    "a greeting that a touch holds up": Fault(
        "expect",
        "Shall I go on?",
        more='<expect says="Shall I go on?" within="5s" at="0s"/>',
    ),
    "a question that is cut off from its talk": Fault(
        "expect",
        "That tickles!",
        more='<expect id="asked" says="Shall I go on?"/><never says="That tickles!" before="asked"/>',
    ),
    "an event that one form does not handle": Fault(
        "error",
        "guide: ",
        ea=TALK.replace(
            '<form id="ask">', '<form id="ask"><on event="touch"><throw event="lost"/></on>'
        ),
    ),
    "a variable that is set too late": Fault(
        "error",
        "guide: ",
        ea=TALK.replace(
            '<form id="hello">',
            '<var name="guest"/><form id="hello">'
            '<on event="touch"><speak><value expr="guest.name"/></speak></on>',
        ).replace("<goto", '<assign name="guest" expr="({name: \'Ann\'})"/><goto'),
    ),
    "a round without an end": Fault(
        "endless",
        "does not end by itself",
        ea=TALK.replace(
            '<form id="ask">',
            '<form id="ask"><on event="touch"><goto next="#round"/></on>',
        )
        + '<form id="round"><block><speak>Tick, tock.</speak><goto next="#round"/></block></form>',
    ),
    "a round without a pause": Fault(
        "error",
        "guide: ",
        ea=TALK.replace(
            '<form id="ask">',
            '<form id="ask"><on event="touch"><goto next="#round"/></on>',
        )
        + '<form id="round"><block><goto next="#round"/></block></form>',
    ),
    "two touches too near to each other": Fault(
        "error",
        "pet: ",
        fa="""<var name="busy" expr="false"/><form id="pet"><on event="touch">
        <if cond="busy"><throw event="again"/></if><assign name="busy" expr="true"/>
        <send event="calm" delay="300ms"/><speak>That tickles!</speak></on>
        <on event="calm"><assign name="busy" expr="false"/></on></form>""",
        events=TOUCH.format(at="10s") + TOUCH.format(at="14s").replace('"touch"', '"second"'),
        within=6_000,
    ),
    "a message that comes before what it is about": Fault(
        "error",
        "pet: ",
        fa="""<var name="who"/><form id="pet">
        <on event="touch"><assign name="who" expr="'Bob'"/><speak>Hello.</speak></on>
        <on event="message"><speak><value expr="who.toUpperCase()"/></speak></on></form>""",
        events=TOUCH.format(at="10s") + MESSAGE.format(at="14s"),
        within=6_000,
    ),
    "one instant in which the answer is nobody's": Fault(
        "expect",
        "ends",
        ea=TALK.replace("<noinput><exit/></noinput>", '<noinput><goto next="#wait"/></noinput>')
        + '<form id="wait"><on event="calm"><exit/></on></form>',
        events='<when id="say" asked="Shall I go on?" after="1s"><say>Yes.</say></when>',
        more='<expect ends="guide" reason="exit"/>',
        within=30_000,
    ),
    "a touch and a message in the wrong order": Fault(
        "expect",
        "finishes",
        fa="""<var name="told" expr="false"/><form id="pet">
        <on event="message"><assign name="told" expr="true"/></on>
        <on event="touch" cond="told"><gesture name="nod"/></on>
        <on event="touch" cond="!told"><speak>That tickles!</speak></on></form>""",
        events=MESSAGE.format(at="8s") + TOUCH.format(at="11s"),
        within=6_000,
        more='<expect finishes="gesture"/>',
    ),
}


def write(folder: Path, fault: Fault) -> str:
    (folder / "ea.xml").write_text(f'<prima {HEAD} kind="ea" id="guide">{fault.ea}</prima>')
    (folder / "fa.xml").write_text(f'<prima {HEAD} kind="fa" id="pet">{fault.fa}</prima>')
    scenario = folder / "visit.xml"
    scenario.write_text(
        f"""<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit" until="{fault.until}"
        world="{ROOT}/documents/worlds/room.xml" robot="{ROOT}/documents/robots/papero.xml">
        <robot at="middle"/><person x="1" y="0"/>
        <application src="fa.xml" kind="fa"/><application src="ea.xml"/>
        {fault.events}{fault.more}</scenario>"""
    )
    return str(scenario)


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found_and_its_case_kept(name: str, tmp_path: Path) -> None:
    fault = FAULTS[name]
    exploration = Exploration(ExplorationPlan(write(tmp_path, fault), within=fault.within))
    for _ in carried_out(exploration, local(1), tmp_path / "out", resume=False):
        pass
    assert exploration.complete
    assert not exploration.findings(exploration.seen[exploration.base]), (
        "the run as written is fine"
    )
    numbered = dict(enumerate(exploration.problems, 1))
    found = {n: one for n, one in numbered.items() if one.finding.kind == fault.kind}
    assert found, [one.finding for one in exploration.problems]
    number, problem = next(iter(found.items()))
    assert fault.told in problem.finding.text
    smallest(exploration, problem.point, problem.finding.kind)
    case = tmp_path / "out" / "problems" / f"{Explored.name(number, problem)}.xml"
    again = api.rehearse(case)
    assert again.dumps() == case.with_suffix(".jsonl").read_text()


def smallest(exploration: Exploration, point: tuple[int, ...], kind: str) -> None:
    """No event of a shrunk case can be put back, or moved by 1 ms less."""
    for which, (time, base) in enumerate(zip(point, exploration.base, strict=True)):
        if time != base:
            nearer = time + (1 if base > time else -1)
            for other in (base, nearer):
                seen = exploration.seen[(*point[:which], other, *point[which + 1 :])]
                assert kind not in {one.kind for one in exploration.findings(seen)}
