"""Whatever a stranger's files contain: a clear error, its place, an exit code, never a traceback."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
WORLD = ROOT / "documents" / "worlds" / "office.xml"
ROBOT = ROOT / "documents" / "robots" / "papero.xml"
HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="app">'
FINE = f'{HEAD}<form id="a"><block><exit/></block></form></prima>'


def prima(*args: str | Path, timeout: int = 60) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [sys.executable, "-m", "prima", *map(str, args)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        errors="replace",
        timeout=timeout,
        check=False,
    )
    assert "Traceback" not in done.stderr, done.stderr
    assert "defect of prima" not in done.stderr, done.stderr
    return done


def scenario(folder: Path, application: str, more: str = "", until: str = "60s") -> Path:
    """A scenario of one application, written out."""
    (folder / "app.xml").write_text(application, encoding="utf-8")
    path = folder / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{WORLD}" robot="{ROBOT}" until="{until}">\n'
        f'<application src="app.xml"/>{more}</scenario>',
        encoding="utf-8",
    )
    return path


def body(text: str) -> str:
    return f'{HEAD}<form id="a"><block>{text}</block><on event="done"><exit/></on></form></prima>'


@pytest.mark.parametrize(
    ("name", "data", "code", "at"),
    [
        ("empty", b"", "not-xml", ":1:1:"),
        ("blank", b"  \n ", "not-xml", ":1:1:"),
        ("not XML", b"Hello, robot.", "not-xml", ":1:"),
        ("binary", bytes(range(256)), "encoding", ":2:"),
        ("unclosed", f"{HEAD}\n<form id='a'>".encode(), "not-xml", ":2:"),
        ("no namespace", b'<prima version="1.0"/>', "wrong-namespace", ":1:1:"),
        ("VoiceXML 3", b'<vxml xmlns="http://www.w3.org/2001/vxml"/>', "wrong-namespace", ":1:1:"),
        ("wrong root", b'<robot xmlns="urn:prima:dialogue:1"/>', "wrong-root", ":1:1:"),
        ("version", FINE.replace('"1.0"', '"9.0"').encode(), "bad-value", ":1:46:"),
        ("entity", FINE.replace("<exit/>", "<log>&boom;</log><exit/>").encode(), "entity", ":1:"),
        ("internal DTD", b'<!DOCTYPE prima [<!ENTITY a "b">]>\n' + FINE.encode(), "doctype", ":1:"),
        (
            "entity bomb",
            b'<!DOCTYPE p [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;">]>\n'
            + FINE.encode(),
            "doctype",
            ":1:",
        ),
        ("deep", b"<a>" * 10_000 + b"</a>" * 10_000, "too-deep", ":1:"),
        ("siblings", (HEAD + "<form/>" * 210_000 + "</prima>").encode(), "too-large", ":1:"),
        (
            "attributes",
            ("<prima " + " ".join(f'a{n}="x"' for n in range(20_000)) + "/>").encode(),
            "too-large",
            ":1:1:",
        ),
        ("UTF-7", b'<?xml version="1.0" encoding="utf-7"?>+ADw-prima/+AD4-', "encoding", ":1:1:"),
        ("wrong encoding", FINE.replace("app", "\u00e9").encode("latin-1"), "encoding", ":1:"),
        ("control", FINE.replace("<exit/>", "<log>\x01</log>").encode(), "not-xml", ":1:"),
        ("unknown element", body("<dance/>").encode(), "unknown-element", ":1:"),
        ("unknown attribute", body('<exit now="1"/>').encode(), "unknown-attribute", ":1:"),
        ("nowhere", body('<goto next="#b"/>').encode(), "no-such-form", ":1:"),
        ("undeclared", body('<log expr="nix"/><exit/>').encode(), "undeclared-variable", ":1:"),
        ("expression", body('<log expr="1 +* 2"/><exit/>').encode(), "bad-expression", ":1:"),
        ("injection", body('<log expr="1)});({"/><exit/>').encode(), "bad-expression", ":1:"),
        ("huge number", body('<turn angle="1e999"/><exit/>').encode(), "bad-value", ":1:"),
        ("long time", body('<set-speed-and-time time="99999999s"/>').encode(), "bad-value", ":1:"),
    ],
    ids=lambda value: value if isinstance(value, str) and " " not in value else None,
)
def test_a_bad_document_is_told_with_its_place(
    tmp_path: Path, name: str, data: bytes, code: str, at: str
) -> None:
    path = tmp_path / "bad.xml"
    path.write_bytes(data)
    result = prima("validate", path)
    assert result.returncode == 1, name
    told = [text for text in result.stdout.splitlines() if f"[{code}]" in text]
    assert told and f"bad.xml{at}" in told[0], result.stdout[:500]


def test_a_file_of_100_mb_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "big.xml"
    with path.open("wb") as stream:
        stream.truncate(100_000_000)
    result = prima("validate", path, timeout=10)
    assert result.returncode == 1
    assert "100,000,000 bytes" in result.stdout


def test_an_external_doctype_is_never_fetched(tmp_path: Path) -> None:
    path = tmp_path / "x.xml"
    path.write_text(f'<!DOCTYPE prima SYSTEM "{tmp_path}/no.dtd">\n{FINE}')
    assert prima("validate", path).returncode == 0


def test_what_cannot_be_read_is_wrong_usage(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "no.xml", "a\0b"):
        if "\0" not in str(path):
            assert prima("validate", path).returncode == 2
    assert prima("run", tmp_path / "no.xml").returncode == 2
    assert prima("validate").returncode == 2


FAILING = {
    "throws": "(function () { throw new Error('bad'); })()",
    "loops": "(function () { for (;;); })()",
    "eats": "(function () { var s = 'x'; for (;;) s += s; })()",
    "recurses": "(function f() { return f() + 1; })()",
    "regex": "/(x+x+)+y/.test('x'.repeat(60))",
    "join": "Array.prototype.join.call({length: 1e15}, '')",
    "huge": "'x'.repeat(200000)",
}


@pytest.mark.parametrize("expr", FAILING.values(), ids=FAILING)
def test_a_failing_expression_is_an_event_that_the_document_can_handle(
    tmp_path: Path, expr: str
) -> None:
    handled = body(f'<log expr="{expr}"/><exit/>').replace(
        "<on ", '<on event="error.semantic"><speak>So be it.</speak><exit/></on><on '
    )
    done = prima("run", scenario(tmp_path, handled))
    assert done.returncode == 0, done.stderr
    assert "So be it." in done.stdout
    done = prima("run", scenario(tmp_path, body(f'<log expr="{expr}"/>')))
    assert done.returncode == 3
    assert "app: error.semantic: app.xml:1: " in done.stderr


@pytest.mark.parametrize(
    "application",
    [
        f'{HEAD}<form id="a"><block><goto next="#a"/></block></form></prima>',
        f'{HEAD}<form id="a"><block name="b"><clear/></block></form></prima>',
        f'{HEAD}<form id="a"><subdialog src="#a"/></form></prima>',
        f'{HEAD}<form id="a"><on event="x"><throw event="x"/></on><block><throw event="x"/></block></form></prima>',
        f'{HEAD}<form id="a"><block><throw event="nobody.cares"/></block></form></prima>',
    ],
)  # fmt: skip
def test_an_application_that_loops_or_fails_ends_alone(tmp_path: Path, application: str) -> None:
    out = tmp_path / "out.jsonl"
    done = prima("run", scenario(tmp_path, application), "-o", out)
    assert done.returncode == 3
    assert "prima: app: " in done.stderr
    assert prima("show", out).returncode == 0, "what was written stays readable"


def test_a_script_that_escapes_its_limits_ends_the_run(tmp_path: Path) -> None:
    """Something always escapes; a watchdog ends the process, and the transcript is readable."""
    code = (
        "import prima.interpreter.expressions as e, time, sys\n"
        "from prima import cli\n"
        "cli.WATCHDOG_SECONDS = 0.5\n"
        "def stuck(*a): time.sleep(60)\n"
        "helpers = e.Engine.__init__\n"
        "def init(self):\n"
        "    helpers(self); self._help['text'] = stuck\n"
        "e.Engine.__init__ = init\n"
        "sys.argv = ['prima', *sys.argv[1:]]\n"
        "cli.main()\n"
    )
    path = scenario(tmp_path, body('<speak>Well.</speak><log expr="1"/>'))
    out = tmp_path / "out.jsonl"
    done = subprocess.run(
        [sys.executable, "-c", code, "run", str(path), "-o", str(out)],
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert done.returncode == 3
    assert "does not come back" in done.stderr
    assert "Well." in prima("show", out).stdout


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ('<application src="no.xml"/>', '"no.xml" cannot be read'),
        ('<application src="."/>', "cannot be read"),
        ('<application src="scenario.xml"/>', "wrong-namespace"),
        ('<application src="app.xml"/>', 'Two applications have the id "app"'),
        ('<robot at="entrence"/>', 'Did you mean "entrance"?'),
        ('<when at="1s"><touch sensor="hed"/></when>', 'Did you mean "head"?'),
        ("<when><say>x</say></when>", "exactly one of"),
        ('<when at="-1s"><say>x</say></when>', "is not a time"),
        ('<person x="nan" y="0"/>', "is not a number"),
    ],
)
def test_a_bad_scenario_is_told_with_its_place(tmp_path: Path, more: str, message: str) -> None:
    path = scenario(tmp_path, FINE, more)
    for command in ("validate", "run"):
        done = prima(command, path)
        assert done.returncode == 1
        assert message in done.stdout + done.stderr
        assert (
            "scenario.xml:2:" in done.stdout + done.stderr
            or "scenario.xml:1:" in done.stderr + done.stdout
        )


def test_a_command_that_the_robot_lacks_is_warned_of_and_an_event(tmp_path: Path) -> None:
    robot = tmp_path / "robot.xml"
    robot.write_text(
        '<robot xmlns="urn:prima:robot:1" version="1.0" id="r"><device name="speaker"/></robot>'
    )
    application = body("<turn angle='3'/><exit/>").replace(
        "<on ", '<on event="error.unsupported.turn"><speak>I cannot turn.</speak><exit/></on><on '
    )
    path = scenario(tmp_path, application)
    path.write_text(path.read_text().replace(str(ROBOT), "robot.xml"))
    done = prima("run", path)
    assert done.returncode == 0
    assert "I cannot turn." in done.stdout
    assert "[unsupported-command]" in done.stderr


def test_an_fa_only_argument_in_an_ea(tmp_path: Path) -> None:
    path = tmp_path / "ea.xml"
    path.write_text(
        body('<speak>x<param name="volume" value="9"/></speak><exit/>').replace('"fa"', '"ea"')
    )
    done = prima("validate", path)
    assert done.returncode == 1
    assert "[fa-only]" in done.stdout


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\xff\xfe\x00",
        b"Hello\n",
        b'{"time": 1}\n',
        b"[1, 2]\n",
        b'{"time":0.0,"phase":"run","actor":"mediator"}\n{"time":0.0,"phase":"lo',
        b'{"time":0.0,"phase":"run","actor":"mediator","colour":"red"}\n',
        b"[" * 100_000 + b"\n",
        b'{"time":1e999,"phase":"over","actor":"mediator"}\n',
    ],
)
def test_a_foreign_or_truncated_transcript_is_unreadable_input(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "t.jsonl"
    path.write_bytes(data)
    for args in (("show", path), ("diff", path, path), ("explain", path, "0")):
        done = prima(*args)
        assert done.returncode == 2, (args, done.stderr)
        assert "t.jsonl" in done.stderr
    assert prima("replay", path, ROOT / "documents/scenarios/follow-alone.xml").returncode == 2


def test_a_replay_with_other_documents_or_edited_records_is_told(tmp_path: Path) -> None:
    demo = ROOT / "documents" / "scenarios" / "follow-alone.xml"
    out = tmp_path / "t.jsonl"
    prima("run", demo, "-o", out)
    other = prima("replay", out, ROOT / "documents" / "scenarios" / "navigate-alone.xml")
    assert other.returncode in (1, 2)
    lines = out.read_text(encoding="utf-8").splitlines(keepends=True)
    edited = [text.replace("Yes.", "No.") for text in lines]
    out.write_text("".join(edited), encoding="utf-8")
    assert prima("replay", out, demo).returncode == 1
    out.write_text("".join(lines[3:]), encoding="utf-8")
    assert prima("replay", out, demo).returncode == 2


def test_an_output_that_cannot_be_written(tmp_path: Path) -> None:
    demo = ROOT / "documents" / "scenarios" / "follow-alone.xml"
    for target in (tmp_path, tmp_path / "no" / "t.jsonl", Path("/dev/full")):
        if target.name == "full" and not target.exists():
            continue
        done = prima("run", demo, "-o", target)
        assert done.returncode == 2, (target, done.stderr)
        assert "cannot be written" in done.stderr


def test_a_reader_that_goes_away_is_no_error() -> None:
    demo = ROOT / "documents" / "scenarios" / "follow-during-navigation.xml"
    done = subprocess.run(
        f'"{sys.executable}" -m prima run "{demo}" --format json | head -1',
        shell=True,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr


def test_texts_cannot_command_the_terminal(tmp_path: Path) -> None:
    out = tmp_path / "t.jsonl"
    prima("run", ROOT / "documents" / "scenarios" / "follow-alone.xml", "-o", out)
    text = out.read_text(encoding="utf-8").replace("Yes.", "\\u001b[2J\\u0007Yes.")
    out.write_text(text, encoding="utf-8")
    for args in (("show", out), ("diff", out, out), ("explain", out, "12")):
        done = prima(*args)
        assert "\x1b" not in done.stdout
        assert "\x07" not in done.stdout


@pytest.mark.parametrize("angle", ["0 / 0", "1 / 0", "'x'", "null", "undefined", "[]", "1e300"])
def test_odd_values_of_arguments_are_refused_at_run_time(tmp_path: Path, angle: str) -> None:
    done = prima("run", scenario(tmp_path, body(f'<turn angle-expr="{angle}"/><exit/>')))
    assert done.returncode == 3
    assert "error.semantic: app.xml:1: " in done.stderr


def test_nobody_answers_for_ever_and_the_run_still_ends(tmp_path: Path) -> None:
    asking = f'{HEAD}<form id="a"><field name="x" type="text"><prompt timeout="0s">?</prompt></field></form></prima>'
    done = prima("run", scenario(tmp_path, asking, until="86400s"), "-o", tmp_path / "t.jsonl")
    assert done.returncode in (0, 3)
    assert os.path.getsize(tmp_path / "t.jsonl") < 500_000_000
