"""What parts of applications cost others, and certificates for pairs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from prima import api
from prima.certificate import Certificate, certificate_data, certificates, format_certificate
from prima.loading import read_application, read_file
from prima.prices import Price, prices, reactions
from prima.sim.scenario import read_robot
from prima.sim.voice import duration

ROOT = Path(__file__).parent.parent
ROBOT = ROOT / "documents" / "robots" / "papero.xml"
PROFILE = read_robot(str(ROBOT), read_file(ROBOT))
HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{}" id="{}" xml:lang="en">'
FA = (
    '<form id="sleep"><on event="touch"><goto next="#yes"/></on></form>'
    '<form id="yes"><block><speak>Yes?</speak><goto next="#sleep"/></block></form>'
)


def write(folder: Path, name: str, body: str, kind: str = "ea") -> str:
    path = folder / f"{name}.xml"
    path.write_text(HEAD.format(kind, name) + body + "</prima>")
    return str(path)


def priced(folder: Path, body: str) -> list[Price]:
    path = write(folder, "app", body)
    document, problems = read_application(path, read_file(path))
    assert [one for one in problems if one.severity == "error"] == []
    return prices(document, PROFILE)


def block(content: str) -> str:
    return f'<form id="f"><block>{content}<exit/></block></form>'


def lasting(text: str) -> int:
    return duration(text, "en", PROFILE.voices)


def test_speech_costs_what_it_lasts(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block("<speak>Good morning to you.</speak>"))
    assert (price.lasts, price.known) == (lasting("Good morning to you."), True)
    assert price.devices == {"speaker"}


def test_pauses_cost_what_they_last_and_only_those_in_speech_the_speaker(tmp_path: Path) -> None:
    (said,) = priced(tmp_path, block('<speak>Good <break time="2s"/>morning.</speak>'))
    assert (said.lasts, said.known) == (lasting("Good morning.") + 2000, True)
    (unit,) = priced(tmp_path, block('<iu><speak>Good.</speak><pause time="3s"/></iu>'))
    assert (unit.lasts, unit.known) == (lasting("Good.") + 3000, True)
    assert unit.devices == {"speaker"}


def test_what_an_expression_says_is_not_known(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block('<speak>Good <value expr="1"/></speak>'))
    assert not price.known and price.seconds.startswith("at least ")


def test_a_unit_costs_the_sum_of_its_parts_and_branches_their_longest(tmp_path: Path) -> None:
    parts = '<speak>One and two.</speak><gesture name="bow"/>'
    (price,) = priced(tmp_path, block(f"<iu>{parts}</iu>"))
    assert price.what == "unit" and price.lasts == lasting("One and two.") + 1500
    (price,) = priced(tmp_path, block(f"<iu><par>{parts}</par></iu>"))
    assert price.lasts == max(lasting("One and two."), 1500)


def test_a_unit_costs_no_more_than_its_longest_duration(tmp_path: Path) -> None:
    (price,) = priced(
        tmp_path, block(f'<iu longest="2s"><speak>{"a long word " * 20}</speak></iu>')
    )
    assert price.lasts == 2000


def test_a_question_costs_its_prompt_and_its_timeout(tmp_path: Path) -> None:
    field = '<form id="f"><field name="a" type="boolean"><prompt timeout="4s">Well?</prompt></field></form>'
    (price,) = priced(tmp_path, field)
    assert price.what == "question" and price.lasts == lasting("Well?") + 4000
    (price,) = priced(tmp_path, field.replace(' timeout="4s"', ""))
    assert price.lasts == lasting("Well?") + 5000


def test_a_question_in_a_unit_costs_the_units_longest(tmp_path: Path) -> None:
    body = (
        '<form id="f"><iu longest="20s"><field name="a" type="boolean"><prompt>Well?</prompt>'
        "</field></iu></form>"
    )
    (price,) = priced(tmp_path, body)
    assert (price.what, price.lasts) == ("unit", 20_000)


def test_a_loop_costs_one_loop(tmp_path: Path) -> None:
    (price,) = priced(tmp_path, block("<tracking-human/>"))
    assert price.loops and price.lasts == PROFILE.loop


def test_reactions_are_what_follows_events_from_outside(tmp_path: Path) -> None:
    body = FA.replace("</on>", '</on><on event="own.timer"><speak>Late.</speak></on>')
    document, _ = read_application("a.xml", (HEAD.format("fa", "a") + body + "</prima>").encode())
    assert reactions(document) == {"touch": {"speaker"}}  # type: ignore[arg-type]


def certified(folder: Path, body: str, own: str = FA) -> Certificate:
    fa, ea = write(folder, "mine", own, "fa"), write(folder, "theirs", body)
    (found,) = certificates([fa], [ea])
    return found


def test_the_longest_wait_is_for_the_longest_part_on_the_same_devices(tmp_path: Path) -> None:
    body = block('<speak>Short.</speak><gesture name="bow"/><iu><speak>A longer one.</speak></iu>')
    (delay,) = certified(tmp_path, body).delays
    assert (delay.event, delay.what, delay.lasts) == ("touch", "unit", lasting("A longer one."))
    assert delay.devices == ("speaker",)


def test_what_leaves_loops_and_holds_is_told(tmp_path: Path) -> None:
    body = (
        '<form id="f" stream="hold" hold-for="9s"><block><topological-move to="door"/></block>'
        '<on event="touch"><exit/></on></form>'
    )
    own = FA.replace("<speak>Yes?</speak>", "<tracking-human/>")
    found = certified(tmp_path, body, own)
    assert [price.what for price in found.leaves] == ["topological-move"]
    assert [price.what for price in found.loops] == ["topological-move"]
    assert [lasts for _, lasts in found.holds] == [9000]
    text = format_certificate(found)
    assert "for 9 s at" in text and "It waits while mine is in a conversation" in text


def test_robots_that_lack_something_are_told(tmp_path: Path) -> None:
    found = certified(tmp_path, block('<point-by-hand angle="30"/>'))
    assert found.lacks == {"papero": [], "papero-plus": [], "pointer": ["point-by-hand"]}


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
        '<person x="1" y="0"/><application src="theirs.xml"/><application src="mine.xml"/>'
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
    assert done.returncode == 0 and "What theirs can do to mine, on papero" in done.stdout
    assert json.loads(call("--with", fa, ea, "--format", "json").stdout)[0]["ea"] == "theirs"
    assert call("--with", "none.xml", ea).returncode == 2
    assert call("--robot", str(ROBOT), ea).returncode == 2
    write(tmp_path, "theirs", "<form/>")
    assert call("--with", fa, ea).returncode == 1
