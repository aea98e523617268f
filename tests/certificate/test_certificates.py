"""Certificates: what they say of a pair, on the command line as well."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from prima import api
from prima.certificate import (
    certificate_data,
    certificates,
    format_certificate,
)
from tests import ROOT
from tests.helpers.certifying import FA, ROBOT, block, certified, lasting, priced, run, write


def test_the_longest_wait_is_for_the_longest_part_on_the_same_devices(tmp_path: Path) -> None:
    body = block('<speak>Short.</speak><gesture name="bow"/><iu><speak>A longer one.</speak></iu>')
    (delay,) = certified(tmp_path, body).delays
    assert (delay.event, delay.what, delay.lasts) == ("touch", "unit", lasting("A longer one."))
    assert delay.devices == ("speaker",)


def test_what_leaves_loops_and_holds_is_told(tmp_path: Path) -> None:
    body = (
        '<form id="f" stream="hold" hold-for="9s"><block><topological-move to="door"/>'
        '<tracking-human/></block><on event="touch"><exit/></on></form>'
    )
    own = FA.replace("<speak>Yes?</speak>", "<turn angle='20'/>")
    found = certified(tmp_path, body, own)
    assert [price.what for price in found.leaves] == ["topological-move"]
    (starved,) = found.starves
    assert (starved.rule, starved.devices) == ("E4", ("locomotion",))
    assert [lasts for _, lasts in found.holds] == [9000]
    text = format_certificate(found)
    assert "a hold, for 9 s, with x3" in text and "It waits while mine is in a conversation" in text
    assert "tracking-human goes on until its goal is reached\n    waiting: equal ones on" in text


def test_robots_that_lack_something_are_told(tmp_path: Path) -> None:
    found = certified(tmp_path, block('<point-by-hand angle="30"/>'))
    there = {name: lacking for name, lacking in found.lacks.items() if "p" in name[:1]}
    assert there == {"papero": [], "papero-plus": [], "pointer": ["point-by-hand"]}


def test_the_data_are_json(tmp_path: Path) -> None:
    found = certified(tmp_path, block("<iu><speak>Hi.</speak></iu>"))
    data = json.loads(json.dumps(certificate_data(found)))
    assert data["longest_unit"]["lasts"] == lasting("Hi.")
    assert data["delays"][0]["place"].startswith(str(tmp_path))


@pytest.mark.parametrize("touched", range(0, 6000, 700))
def test_no_reaction_waits_longer_than_is_certified(tmp_path: Path, touched: int) -> None:
    body = block(
        "<speak>One sentence that is not long.</speak><iu><speak>Here is the first part.</speak>"
        "<speak>And here is the second one of it.</speak></iu><speak>Bye.</speak>"
    )
    fa, ea = write(tmp_path, "mine", FA, "fa"), write(tmp_path, "theirs", body)
    (found,) = certificates([fa], [ea])
    text = (
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="20s"'
        f' world="{ROOT}/documents/worlds/room.xml" robot="{ROBOT}"><robot at="middle"/>'
        '<person x="1" y="0"/><application src="theirs.xml"/><application src="mine.xml" kind="fa"/>'
        f'<when at="{touched}ms"><touch sensor="head"/></when></scenario>'
    )
    (tmp_path / "s.xml").write_text(text)
    records = api.rehearse(tmp_path / "s.xml").records
    said = next(r["time"] for r in records if r["phase"] == "start" and r.get("text") == "Yes?")
    assert said - touched / 1000 <= found.delays[0].lasts / 1000


def test_the_command_line_prints_a_certificate(tmp_path: Path) -> None:
    fa, ea = (
        write(tmp_path, "mine", FA, "fa"),
        write(tmp_path, "theirs", block("<speak>A.</speak>")),
    )

    def call(*args: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "prima", "validate", *args],
            capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip

    done = call("--with", fa, ea)
    assert (
        done.returncode == 0
        and "What theirs can do to mine, on papero, under the policy prima" in done.stdout
    )
    assert json.loads(call("--with", fa, ea, "--format", "json").stdout)[0]["ea"] == "theirs"
    assert call("--with", "none.xml", ea).returncode == 2
    assert call("--robot", str(ROBOT), ea).returncode == 2
    write(tmp_path, "theirs", "<form/>")
    assert call("--with", fa, ea).returncode == 1


@pytest.mark.parametrize(
    "text, known", [("list[at].said", True), ("list[at].said + 1", False), ("list[at]", False)]
)
def test_texts_of_constants_are_known(tmp_path: Path, text: str, known: bool) -> None:
    script = "<script>const list = [{ said: 'Hello there, you.' }, { said: 'Hi.' }];</script>"
    body = '<var name="at" expr="0"/>' + script + block(f'<speak><value expr="{text}"/></speak>')
    (price,) = priced(tmp_path, body)
    assert price.known is known
    if known:
        assert price.lasts == lasting("Hello there, you.")


@pytest.mark.parametrize("text", ["list.length", "list['length']", "list[0].length", "list[0][1]"])
def test_lengths_and_letters_of_constants_are_not_known(tmp_path: Path, text: str) -> None:
    script = "<script>const list = ['Hi.', 'You.'];</script>"
    (price,) = priced(tmp_path, script + block(f'<speak><value expr="{text}"/></speak>'))
    assert not price.known


def test_constants_cost_what_a_run_says_of_them(tmp_path: Path) -> None:
    values = ["1e999", "2e22", "1e20", "0.000001", "1e-7", "12", "-0.5", "true", "null", "'Hi.'"]
    said = "".join(f'<speak><value expr="list[{at}]"/></speak>' for at in range(len(values) + 1))
    prices = priced(tmp_path, f"<script>const list = [{', '.join(values)}];</script>{block(said)}")
    fa = write(tmp_path, "mine", FA, "fa")
    records = run(tmp_path, fa, str(tmp_path / "app.xml"), "")
    texts = [str(one["text"]) for one in records if one["phase"] == "request"]
    assert texts[:4] == ["Infinity", "2e+22", "100000000000000000000", "0.000001"]
    assert [(one.lasts, one.known) for one in prices] == [(lasting(one), True) for one in texts]


@pytest.mark.parametrize("change", ["list.push('a longer one')", "list[0] = 'a longer one'"])
def test_texts_of_constants_that_change_are_not_known(tmp_path: Path, change: str) -> None:
    script = f"<script>const list = ['Hi.']; {change};</script>"
    (price,) = priced(tmp_path, script + block('<speak><value expr="list[0]"/></speak>'))
    assert not price.known


VALUES = "".join(f'<speak><value expr="{at}"/></speak>' for at in range(8))
WAITS = "not known how long Commands that are not reactions wait: "
ALSO = (
    '<form id="f{0}"><block><goto next="#f{1}"/></block>'
    '<on event="touch"><speak>I too.</speak></on></form>'
)
DOOR = FA.replace("<speak>Yes?</speak>", '<topological-move to="door"/>')
TURNS = '<form id="f"><block><turn angle="3"/><goto next="#f"/></block></form>'
LONG = f'<iu longest="90s"><speak>So.</speak><pause time="60s"/><pause time="30s"/></iu><speak>{"word " * 300}</speak>'
TOLD = {
    "more places than are listed": (
        block(VALUES), FA, ["an expression gives its text, at ", "    not known: 3 more such places"],
    ),
    "others wait for what is not known": (
        block(VALUES), FA, [f"  {WAITS}an expression gives its text, at ", f"  {WAITS}3 more such"],
    ),
    "what it does about the same event": (
        "".join(ALSO.format(at, at + 1) for at in range(7)) + '<form id="f7"/>', FA,
        [" and for what theirs does about the same event at ", " and 2 more such places (F2)\n"],
    ),
    "all that it does": (
        '<form id="q"><field name="a" type="boolean"><prompt>Well?</prompt><noinput><exit/></noinput>'
        "<nomatch><exit/></nomatch></field><block><exit/></block></form>",
        DOOR, [", for all that theirs does (K1, K2), and while the user speaks\n"],
    ),
    "those that leave": (
        block("<tracking-human/>"), f'{DOOR}<form id="m"><block><topological-move to="door"/></block></form>',
        ["goes on until its goal is reached\n", "    waiting: those that leave the user (K1)\n"],
    ),
    "a loop that keeps nothing": (TURNS, FA, ["  nothing: others than reactions wait up to "]),
    "long activities": (
        block(LONG), FA,
        ["\nWhat of theirs is longer than a run's patience, 60 s by default (E6)\n  unit at ",
         " s: it ends then\n  speak at ", " s: it may be refused\n"],
    ),
}  # fmt: skip
"""What a certificate says in rarer cases: the EA, the FA, and pieces of the text in order."""


@pytest.mark.parametrize(("body", "own", "pieces"), TOLD.values(), ids=TOLD)
def test_a_certificate_tells_it(tmp_path: Path, body: str, own: str, pieces: list[str]) -> None:
    text = format_certificate(certified(tmp_path, body, own))
    for piece in pieces:
        _, found, text = text.partition(piece)
        assert found, piece
