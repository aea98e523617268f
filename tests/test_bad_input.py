"""Whatever a stranger's file or command line holds gives a clear error: never a traceback or a hang.

Most cases call the command line's own ``main`` in this process; what could hang,
eat memory or die runs in a process of its own with limits on both.
"""

from __future__ import annotations

import json
import math
import os
import pty
import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from prima import api, cli
from prima.devices import loop
from prima.language.commands import DEVICES

DOCUMENTS = api.documents_folder()
WORLD, ROBOT = DOCUMENTS / "worlds" / "office.xml", DOCUMENTS / "robots" / "papero.xml"
GIGABYTE = 1 << 30
SECONDS = 20
"""How long anything here may take at most; what is bounded takes a fraction of it."""
SHARED = 5
"""How many may share the processor: by the clock it may take so many times as long."""


# Documents ----------------------------------------------------------------------


def app(body: str, kind: str = "fa", name: str = "a", head: str = "") -> str:
    """An application, its body on the second line."""
    start = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="{name}">'
    return f"{start}{head}\n{body}\n</prima>\n"


def form(content: str, name: str = "f") -> str:
    return f'<form id="{name}">{content}</form>'


def block(content: str) -> str:
    return form(f"<block>{content}</block>")


def scenario(body: str, attributes: str = "", world: object = WORLD, robot: object = ROBOT) -> str:
    start = '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
    return f'{start} world="{world}" robot="{robot}" {attributes}>\n{body}\n</scenario>\n'


def world(body: str) -> str:
    return f'<world xmlns="urn:prima:world:1" version="1.0" id="w">\n{body}\n</world>\n'


def robot(body: str, attributes: str = "") -> str:
    start = f'<robot xmlns="urn:prima:robot:1" version="1.0" id="r" {attributes}>'
    return start + "".join(f'<device name="{name}"/>' for name in DEVICES) + f"\n{body}\n</robot>\n"


GOOD = app(block("<speak>Hello there.</speak><log>alive</log><exit/>"))
CATCH = '<on event="error"><log>caught <value expr="_message"/></log><exit/></on>'
PLAY = '<application src="app.xml"/>'


# Running -------------------------------------------------------------------------


@dataclass
class Result:
    """What a command gave."""

    code: int
    out: str
    err: str

    @property
    def text(self) -> str:
        return self.out + self.err

    def check(self, code: int, *parts: str) -> Result:
        """The exit code is ``code``, all of ``parts`` are said, and nothing is a defect."""
        assert "Traceback" not in self.text and "defect of prima" not in self.text, self.text
        assert self.code == code, self.text[-2000:]
        for part in parts:
            assert part in self.text, f"{part!r} is not in {self.text[-2000:]!r}"
        return self


Prima = Callable[..., Result]


@pytest.fixture
def prima(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Prima:
    """The command line in this process, in the test's own folder."""
    monkeypatch.chdir(tmp_path)

    def call(*args: object) -> Result:
        monkeypatch.setattr(sys, "argv", ["prima", *map(str, args)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        shown = capsys.readouterr()
        return Result(int(ended.value.code or 0), shown.out, shown.err)

    return call


def process(
    tmp_path: Path, *args: object, seconds: float = SECONDS, memory: int = 2 * GIGABYTE, **more: Any
) -> Result:
    """The command line as a process of its own, bounded in memory and in the processor's time."""
    busy = math.ceil(seconds)

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CPU, (busy, busy + 1))

    command = [sys.executable, "-m", "prima", *map(str, args)]
    more = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more}
    try:
        done = subprocess.run(
            command, cwd=tmp_path, timeout=SHARED * seconds, stdin=subprocess.DEVNULL,
            preexec_fn=limit, **more,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        pytest.fail(f"it takes longer than {SHARED * seconds} s")
    if done.returncode == -signal.SIGXCPU:
        pytest.fail(f"it takes longer than {seconds} s of the processor's time")
    out, err = done.stdout or b"", done.stderr or b""
    return Result(done.returncode, out.decode(errors="replace"), err.decode(errors="replace"))


def write(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def stage(folder: Path, document: str | bytes, body: str = "", attributes: str = "") -> Path:
    """A scenario with one application, ``app.xml``."""
    write(folder, "app.xml", document)
    return write(folder, "s.xml", scenario(f"{PLAY}\n{body}", attributes or 'until="20s"'))


def messages(path: Path) -> list[str]:
    """What applications have logged in a transcript."""
    records = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return [record["message"] for record in records if record["phase"] == "log"]


# Bytes and XML -------------------------------------------------------------------

LAUGHS = '<!ENTITY a0 "ha">' + "".join(
    f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 9)
)
FIFTH = "\U00010000"
"""A letter of names since XML 1.0's fifth edition, and not before."""

XML = [
    ("empty", b"", "1:1", "is empty"),
    ("blank", b" \n\t", "1:1", "is empty"),
    ("not-xml", b"hello", "1:1", "not well-formed"),
    ("json", b'{"time":0}\n', "1:1", "This is JSON, not XML"),
    ("binary", bytes(range(128, 256)) * 9, "1:1", "Save it as UTF-8"),
    ("null-byte", b"<a>\0</a>", "1:4", "Invalid character"),
    ("control", app(block("<log>\x01</log>")), "2:", "not well-formed"),
    ("voicexml", '<vxml version="3.0" xmlns="http://www.w3.org/2001/vxml"/>', "1:16", 'is not a version of VoiceXML'),
    ("not-closed", app(form("<block>")), "2:21", "not well-formed"),
    ("mismatch", app(block("<speak>日本</speek>")), "2:30", "</speek> does not end <speak>"),
    ("no-namespace", "<prima/>", "1:1", "has no namespace"),
    ("wrong-namespace", '<prima xmlns="urn:x"/>', "1:1", 'Begin with <prima xmlns="urn:prima'),
    ("wrong-root", '<form xmlns="urn:prima:dialogue:1"/>', "1:1", "must be <prima>"),
    ("wrong-version", GOOD.replace('"1.0"', '"2.0"'), "1:46", 'Did you mean "1.0"?'),
    ("entity", app(block("<speak>a&nbsp;b</speak>")), "2:29", "&nbsp; is not known"),
    ("entity-declared", f'<!DOCTYPE prima [<!ENTITY a "b">]>{GOOD}', "1:1", "square brackets"),
    ("laughs", f"<!DOCTYPE prima [{LAUGHS}]>{GOOD}", "1:1", "may not declare"),
    ("laughs-later", f"\n<!DOCTYPE prima SYSTEM 'x' [{LAUGHS}]>{GOOD}", "2:1", "may not declare"),
    ("dtd-entity", f'<!DOCTYPE prima SYSTEM "x">{app(block("<speak>&x;</speak>"))}', "2:28", "&x;"),
    ("xml-bomb-attribute", app(block('<log label="&a;"/>')), "2:33", "is not known"),
    ("prefix", app(block("<x:speak>x</x:speak>")), "2:21", 'the prefix "x"'),
    ("other-namespace", app(block('<x:speak xmlns:x="urn:x"/>')), "2:21", "another namespace"),
    ("too-deep", app(block("<if cond='1'>" * 10_000)), "2:", "more than 100 deep"),
    ("deep", app(block("<if cond='1'>" * 150 + "</if>" * 150)), "2:", "more than 100 deep"),
    ("attributes", app(form("<block " + "".join(f'a{n}="" ' for n in range(5000)) + "/>")), "2:14", "64"),
    ("long-name", app(block("<" + "o" * 60_000 + "/>")), "2:", "more than 1,000 characters"),
    ("utf-7", b'<?xml version="1.0" encoding="UTF-7"?><a/>', "1:31", '"utf-7" is not accepted'),
    ("odd-encoding", b'<?xml version="1.0" encoding="idna"?><a/>', "1:31", "Save it as UTF-8"),
    ("ebcdic", GOOD.encode("cp037"), "1:", "Save it as UTF-8"),
    ("utf-16-without-bom", GOOD.encode("utf-16-le"), "1:", "not well-formed"),
    ("utf-32", GOOD.encode("utf-32"), "1:1", '"utf-32" is not accepted. Save it as UTF-8'),
    ("says-utf-16", b'<?xml version="1.0" encoding="UTF-16"?>' + GOOD.encode(), "1:31", "error"),
    ("not-ascii", b'<?xml version="1.0" encoding="us-ascii"?>\n\n\xe9', "3:", "is not US-ASCII"),
    ("latin-1", app(block("<speak>caf\xe9</speak>")).encode("latin-1"), "2:", "is not UTF-8"),
    ("latin-1-column", app(block("<speak>caf\xe9</speak>")).encode("latin-1"), "2:31", "UTF-8"),
    ("column-of-characters", app(block("<speak>ééé \x00")).encode().replace(b"\0", b"\xe9"), "2:32", "UTF-8"),
    ("line-of-carriage-return", b"<a>\r\r\n\r  \xe9</a>", "4:3", "is not UTF-8"),
    ("column-after-bom", b"\xef\xbb\xbf<a>\xe9</a>", "1:4", "is not UTF-8"),
    ("column-of-shift-jis", '<?xml version="1.0" encoding="Shift_JIS"?><a>日本'.encode("shift_jis") + b"\xff</a>", "1:48", "is not SHIFT_JIS"),
    ("fifth-edition-name", app(block(f"<{FIFTH}/>")), "2:2", "Take another name"),
    ("fifth-edition-later", app(f"<{FIFTH}/>\n" + block("<x/>")), "2:2", "Take another name"),
    ("null-remedy", b"<a>\0</a>", "1:4", "Remove the character"),
    ("mismatch-remedy", app(block("<speak>x</speek>")), "2:", "write </speak>"),
    ("never-closed", "<a>", "1:4", "write </a>"),
    ("prefix-remedy", app(block("<x:speak>x</x:speak>")), "2:21", 'Write the name without "x:"'),
    ("ampersand", app(block("<speak>a & b</speak>")), "2:", "Write &amp; for &"),
    ("unquoted", "<a b=1/>", "1:6", "in quotes"),
    ("later-declaration", "\n<?xml version='1.0'?><a/>", "2:6", "very beginning"),
    ("many-attributes", app("<form " + "".join(f'a{n}="" ' for n in range(99)) + "/>"), "2:1", "<form> has more than 64 attributes"),
    ("near-namespace", '<prima xmlns="urn:prima:dialog:1"/>', "1:1", 'Did you mean "urn:prima:dialogue:1"?'),
    ("near-vxml", '<vxml xmlns="http://www.w3.org/2001/vmxl"/>', "1:1", 'Did you mean "http://www.w3.org/2001/vxml"?'),
    ("near-world", '<world xmlns="urn:prima:wolrd:1"/>', "1:1", '"urn:prima:world:1"?'),
    ("transcript", '{"time":0}\n', "1:1", "prima show prints it"),
    ("fifth-edition-doctype", f'<!DOCTYPE {FIFTH} [<!ENTITY a "b">]>{GOOD}', "1:1", "not declare"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data", "place", "message"), XML)
def test_bytes_and_xml(
    prima: Prima, tmp_path: Path, name: str, data: str | bytes, place: str, message: str
) -> None:
    path = write(tmp_path, f"{name}.xml", data)
    prima("validate", path).check(1, f"{path}:{place}", message)


ACCEPTED = [
    ("utf-8-bom", b"\xef\xbb\xbf" + GOOD.encode()),
    ("utf-16", GOOD.encode("utf-16")),
    ("shift-jis", f'<?xml version="1.0" encoding="Shift_JIS"?>{GOOD}'.encode("shift_jis")),
    ("euc-jp", f'<?xml version="1.0" encoding="EUC-JP"?>{GOOD}'.encode("euc-jp")),
    ("bom-rules", b'\xef\xbb\xbf<?xml version="1.0" encoding="EUC-JP"?>' + GOOD.encode()),
    ("crlf", GOOD.replace("\n", "\r\n").encode()),
    ("external-dtd", f'<!DOCTYPE prima SYSTEM "http://127.0.0.1:9/x.dtd">{GOOD}'.encode()),
    ("external-dtd-dir", f'<!DOCTYPE prima PUBLIC "-//x" "/dev/zero">{GOOD}'.encode()),
    ("unicode-name", app(block("<exit/>"), name="日本語").encode()),
    ("spaces-in-number", app(form('<on event="x" count=" 3 "><exit/></on>')).encode()),
]


@pytest.mark.parametrize(("name", "data"), ACCEPTED)
def test_what_looks_odd_but_is_well(prima: Prima, tmp_path: Path, name: str, data: bytes) -> None:
    prima("validate", write(tmp_path, f"{name}.xml", data)).check(0, "no problems")


def test_a_text_keeps_what_looks_like_a_declaration(prima: Prima, tmp_path: Path) -> None:
    text = "<speak><![CDATA[Write <?xml version='1.0'?> first.]]></speak><exit/>"
    prima("run", stage(tmp_path, app(block(text)))).check(0, "Write <?xml version='1.0'?> first.")


def test_a_hundred_megabytes(tmp_path: Path) -> None:
    path = tmp_path / "big.xml"
    with path.open("wb") as stream:
        stream.write(b"<a>")
        stream.truncate(100_000_000)
    said = process(tmp_path, "validate", path, memory=GIGABYTE)
    said.check(1, f"{path}:1:1", "100,000,000 bytes")


# Meaning -------------------------------------------------------------------------


def grammar(content: str) -> str:
    return form(f'<field name="q"><grammar>{content}</grammar></field>')


MEANING = [
    ("unknown-element", block("<speek>x</speek>"), "2:21", 'Did you mean "speak"?'),
    ("voicexml-element", block("<catch/>"), "2:21", 'Write <on event="...">'),
    ("misplaced", form("<speak>x</speak>"), "2:14", "<speak> cannot stand in <form>. Put it into a <block>."),
    ("unknown-attribute", block('<turn angel="3" angle="1"/>'), "2:27", 'Did you mean "angle"?'),
    ("missing-attribute", block("<turn/>"), "2:21", "needs"),
    ("not-a-number", block('<turn angle="x"/>'), "2:34", "Write digits"),
    ("nan", block('<turn angle="NaN"/>'), "2:34", "is not a number"),
    ("infinite", block('<turn angle="1e999"/>'), "2:34", "is not a number"),
    ("out-of-range", block('<turn angle="1e9"/>'), "2:34", "-360 to 360"),
    ("no-unit", block('<set-speed-and-time time="5"/>'), "2:47", 'is not a time. Write "5s".'),
    ("negative-time", block('<send event="x" delay="-1s"/>'), "2:44", "Write a number with its unit"),
    ("too-long-time", block('<send event="x" delay="99999999s"/>'), "2:44", "longer than a day"),
    ("huge-time", block(f'<send event="x" delay="{"9" * 400}s"/>'), "2:44", "longer than a day"),
    ("count-zero", form('<on event="x" count="0"/>'), "2:35", "out of range"),
    ("count-huge", form('<on event="x" count="99999999999"/>'), "2:35", "whole number"),
    ("count-arabic", form('<on event="x" count="٣"/>'), "2:35", "whole number"),
    ("bad-choice", block('<speak order="later">x</speak>'), "2:35", "is not allowed here"),
    ("variable-name", form('<var name="9 x"/>'), "2:25", "is not a variable name"),
    ("assign-name", block('<assign name="a=1,b" expr="1"/>'), "2:35", "is not a variable name"),
    ("event-name", form('<on event="!!"/>'), "2:25", "not an event name"),
    ("no-event", form('<on event=" "/>'), "2:25", "names no event"),
    ("stray-text", block("hello"), "2:21", "Say it with <speak>"),
    ("nothing-to-say", block("<speak> </speak>"), "2:21", "Write its text"),
    ("no-form", "", "1:1", "Write at least one <form>"),
    ("goto-nowhere", block('<goto next="#F"/>'), "2:33", 'There is no form "F"'),
    ("goto-misspelt", block('<goto next="#homr"/>') + form("", "home"), "2:33", 'mean "home"?'),
    ("goto-item", block('<goto nextitem="zz"/>'), "2:37", "no form item"),
    ("goto-both", block('<goto next="#f" nextitem="x"/>'), "2:47", 'has both "next" and "nextitem"'),
    ("duplicate-form", form("") + form(""), "2:31", "Rename one"),
    ("duplicate-item", form('<field name="q" type="text"/>' * 2), "2:56", "Rename one"),
    ("field-without-answer", form('<field name="q"/>'), "2:14", "Give it options"),
    ("undeclared", block('<log expr="vonder"/>'), "2:32", 'Declare it: <var name="vonder"/>'),
    ("undeclared-near", form('<var name="wonder"/><block><log expr="vonder"/></block>'), "2:52", '"wonder"?'),
    ("assign-undeclared", block('<assign name="x" expr="1"/>'), "2:35", "is not declared"),
    ("not-ecmascript", block('<log expr="1 +"/>'), "2:35", "is not ECMAScript"),
    ("operators", block('<log expr="1 +* 2"/>'), "2:35", "is not ECMAScript"),
    ("brackets", block('<log expr="1)});({"/>'), "2:39", "is not ECMAScript"),
    ("closing-brace", block('<log expr="1) } //"/>'), "2:39", "is not ECMAScript"),
    ("comment-open", block('<log expr="1 /*"/>'), "2:34", "is not ECMAScript"),
    ("condition", block('<if cond="true)//"/>'), "2:38", "is not ECMAScript"),
    ("script", block("<script>function (</script>"), "2:38", "is not ECMAScript"),
    ("statement", block('<log expr="while(1);"/>'), "2:32", "is not ECMAScript"),
    ("both-ways", block('<turn angle="1" angle-expr="2"/>'), "2:49", "Keep one of them"),
    ("direction-twice", block('<set-direction heading="1" toward="lab"/>'), "2:56", "only one of"),
    ("in-unit", block("<iu><tracking-human/></iu>"), "2:25", "Move it out of the <iu>"),
    ("property", form('<property name="timeoot" value="1s"/>'), "2:30", 'Did you mean "timeout"?'),
    ("property-value", form('<property name="timeout" value="x"/>'), "2:46", "with its unit"),
    ("no-rule", grammar('<rule id="a"><ruleref uri="#b"/></rule>'), "2:66", 'no rule "b"'),
    ("repeat", grammar('<item repeat="1-99999999999">x</item>'), "2:53", "0-1 or 1-"),
    ("repeat-negative", grammar('<item repeat="-1">x</item>'), "2:53", "0-1 or 1-"),
    ("unreachable", block("<exit/>") + form("", "g"), "2:53", "Go to it from somewhere"),
    ("repeat-superscript", grammar('<item repeat="²">x</item>'), "2:53", "0-1 or 1-"),
    ("repeat-reversed", grammar('<item repeat="5-2">x</item>'), "2:53", "repeat"),
    ("injected-expression", block('<log expr="1)}),(function(){return(2"/>'), "2:33", "ECMAScript"),
    ("injected-script", block("<script>}); (function(){</script>"), "2:30", "ECMAScript"),
    ("reserved-name", form('<var name="class"/>'), "2:25", "name"),
    ("second-line", block('<log expr="1 +&#10;\n )"/>'), "3:2", "is not ECMAScript"),
    ("references", block('<log expr="1 &lt; 2 &amp;&amp; &#x6e;o"/>'), "2:52", '"no" is not declared'),
    ("script-line", block("<script>\n var a = 1;\n <![CDATA[ a = ) ]]></script>"), "4:16", "ECMAScript"),
    ("script-name", block("<script>var a;\n a = nobody;</script>"), "3:6", '"nobody", which nothing'),
    ("no-clock", block('<log expr="performance.now()"/>'), "2:32", '"performance" is not declared'),
    ("sensor", form('<watch name="w" when="sensr.x"/>'), "2:36", 'Did you mean "sensor"?'),
    ("event-comma", form('<on event="touch,message"/>'), "2:25", 'holds a comma. Write "touch message".'),
    ("html", block("<speak><b>x</b></speak>"), "2:28", "Speech is plain text"),
    ("empty-grammar", grammar(""), "2:30", "no words"),
    ("script-src", block('<script src="x.js"/>'), "2:29", "It has no attributes"),
    ("language", form("<block><exit/></block>").replace("<form", '<form xml:lang="en"'), "2:7", "root element"),
    ("goto-case", block('<goto next="#G"/>') + form("", "g"), "2:33", 'Did you mean "g"?'),
    ("send-both", block('<send to="a" event="b"/>'), "2:41", "Keep one of them. [exclusive]"),
    ("send-neither", block("<send/>"), "2:21", "either to or event. [missing-attribute]"),
    ("link-both", form('<link next="#f" event="x"><grammar>a</grammar></link>'), "2:37", "[exclusive]"),
    ("goto-without-hash", block('<goto next="g"/>') + form("<block><exit/></block>", "g"), "2:33", 'Write "#g".'),
    ("subdialog-without-hash", form('<subdialog src="g"/>'), "2:30", 'Write "#g".'),
    ("rule-without-hash", grammar('<rule id="a">x<ruleref uri="a"/></rule>'), "2:67", 'Write "#a".'),
    ("bounds", block('<active-sensing-human patience="9999s"/>'), "2:53", "from 1s to 600s."),
    ("bounds-ms", form('<iu longest="0s"><block/></iu>'), "2:27", "at least 1ms."),
    ("bounds-count", form('<on event="x" count="0"/>'), "2:35", "from 1 to 1000."),
]  # fmt: skip


@pytest.mark.parametrize(("name", "body", "place", "message"), MEANING)
def test_meaning(
    prima: Prima, tmp_path: Path, name: str, body: str, place: str, message: str
) -> None:
    path = write(tmp_path, f"{name}.xml", app(body))
    said = prima("validate", path)
    said.check(0 if name in ("unreachable", "script-name") else 1)
    told = [line for line in said.out.splitlines() if line.startswith(f"{path}:{place}: ")]
    assert any(message in line for line in told), said.text


def test_an_ea_gives_no_additional_arguments(prima: Prima, tmp_path: Path) -> None:
    body = block('<speak>x<param name="voice" value="1"/></speak>')
    path = write(tmp_path, "ea.xml", app(body, kind="ea"))
    prima("validate", path).check(1, f"{path}:2:29: error", "for an FA alone", "Remove the <param>")


def test_problems_of_all_files_and_none_is_lost(prima: Prima, tmp_path: Path) -> None:
    bad = write(tmp_path, "bad.xml", "<a/>")
    good = write(tmp_path, "good.xml", GOOD)
    (tmp_path / "empty").mkdir()
    said = prima("validate", bad, "no.xml", good, tmp_path)
    said.check(2, f"{bad}:1:1", "no.xml: cannot be read: No such file")
    prima("validate", "empty").check(2, "empty: contains no documents")
    data = json.loads(prima("validate", "--format", "json", bad).check(1).out)
    assert data[0]["code"] == "wrong-namespace" and data[0]["remedy"].startswith("Begin with")


# Size ---------------------------------------------------------------------------


def many(count: int, make: Callable[[int], str]) -> str:
    return "".join(make(number) for number in range(count))


SIZES = [
    ("siblings", app(block("<exit/>" * 50_000)), 0),
    ("too-many", app(block("<exit/>" * 201_000)), 1),
    ("attributes-of-a-megabyte", app(block(f'<speak>x</speak><log label="{"x" * 1_000_000}"/><exit/>')), 0),
    ("quotes", app(block("<script>" + '"' + '\\"' * 300_000 + "</script>")), 1),
    ("comments", app(block("<script>" + "/*" * 300_000 + "</script>")), 1),
    ("digits", app(block(f'<send event="x" delay="{"1" * 1_000_000}s"/>')), 1),
    ("fields", app(form(many(2_000, lambda n: f'<field name="a{n}" type="text"/>')) + form("<block><exit/></block>", "g")), 0),
    ("forms", app(many(8_000, lambda n: f'<form id="f{n}"/>')), 0),
    ("spaces", app(block(f'<log expr="1{" " * 400_000}"/><exit/>')), 0),
    ("undeclared", app(form(many(1_500, lambda n: f'<var name="variable{n}"/>') + "<block>" + many(1_500, lambda n: f'<log expr="variabel{n}"/>') + "</block>")), 1),
    ("gotos", app(many(1_500, lambda n: f'<form id="form-{n}"><block><goto next="#fomr-{n}"/></block></form>')), 1),
    ("speaks", app(block("<speak>x</speak>" * 1_000 + "<exit/>")), 0),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data", "code"), SIZES, ids=lambda value: str(value)[:20])
def test_size(tmp_path: Path, name: str, data: str, code: int) -> None:
    process(tmp_path, "validate", write(tmp_path, f"{name}.xml", data)).check(code)


# Scenarios, worlds and robots ---------------------------------------------------------

FOREIGN = ' xmlns:x="urn:x"'
SCENARIOS = [
    ("no-world", scenario(PLAY, world="no.xml"), "s.xml:1:68", '"no.xml" cannot be read: No such'),
    ("directory", scenario(PLAY, world="."), "s.xml:1:68", "cannot be read"),
    ("itself-as-world", scenario(PLAY, world="s.xml"), "s.xml:1:", "This is a scenario; a world is needed here"),
    ("itself-as-app", scenario('<application src="s.xml"/>'), "s.xml:2:", "This is a scenario; an application"),
    ("url", scenario('<application src="http://127.0.0.1:9/x"/>'), "s.xml:2:19", "cannot be read"),
    ("device", scenario('<application src="/dev/zero"/>'), "", "/dev/zero"),
    ("long-path", scenario(f'<application src="{"x" * 999}"/>'), "s.xml:2:19", "cannot be read"),
    ("no-application", scenario(""), "s.xml:1:1", "runs no <application>"),
    ("two-ids", scenario(PLAY + PLAY), "s.xml:2:29", "have the id"),
    ("place", scenario(f'<robot at="entrnce"/>{PLAY}'), "s.xml:2:12", 'Did you mean "entrance"?'),
    ("sensor", scenario(PLAY + '<when at="1s"><touch sensor="hed"/></when>'), "s.xml:2:58", '"head"?'),
    ("thing", scenario(PLAY + '<when at="1s"><look at="postr"/></when>'), "s.xml:2:53", '"poster"?'),
    ("broken", scenario(PLAY + '<when at="1s"><fail device="am"/></when>'), "s.xml:2:57", '"arm"?'),
    ("unload", scenario(PLAY + '<when at="1s"><unload application="b"/></when>'), "s.xml:2:64", "no application"),
    ("command", scenario(PLAY + '<when doing="speek"><stay/></when>'), "s.xml:2:42", '"speak"?'),
    ("no-trigger", scenario(PLAY + "<when><stay/></when>"), "s.xml:2:29", "exactly one of"),
    ("two-triggers", scenario(PLAY + '<when at="1s" said="x"/>'), "s.xml:2:49", "exactly one of"),
    ("negative", scenario(PLAY + '<when at="-1s"/>'), "s.xml:2:39", "with its unit"),
    ("walk", scenario(PLAY + '<when at="1s"><walk/></when>'), "s.xml:2:43", "a place to go to"),
    ("policy", scenario(PLAY, 'policy="fixd"'), "s.xml:1:", 'Did you mean "fixed"?'),
    ("walk-half", scenario(PLAY + '<when at="1s"><walk x="1"/></when>'), "s.xml:2:43", "or x and y"),
    ("walk-twice", scenario(PLAY + '<when at="1s"><walk to="lab" x="1" y="1"/></when>'), "s.xml:2:61", "Keep one"),
    ("person-half", scenario(PLAY + '<person x="1"/>'), "s.xml:2:29", "or x and y"),
    ("person-twice", scenario(PLAY + '<person at="lab" x="1" y="1"/>'), "s.xml:2:49", "Keep one"),
    ("two-robots", scenario('<robot at="lab"/>' * 2 + PLAY), "s.xml:2:18", "a second <robot>"),
    ("infinite", scenario(PLAY + '<person x="1e999" y="0"/>'), "s.xml:2:40", "is not a number"),
    ("service", scenario(PLAY + '<service name="a"><replay/></service>'), "s.xml:2:47", "reply"),
    ("foreign", scenario(f"{PLAY}<x:person{FOREIGN} x='1'/>"), "s.xml:2:29", "another namespace"),
    ("no-such-favourite", scenario(PLAY, 'policy="fixed:zz"'), "s.xml:1:", "Write a."),
    ("policy-with-favourite", scenario(PLAY, 'policy="fixd"'), "s.xml:1:", "fixed:APP"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text", "place", "message"), SCENARIOS)
def test_scenarios(
    prima: Prima, tmp_path: Path, name: str, text: str, place: str, message: str
) -> None:
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "s.xml", text)
    prima("run", "s.xml").check(1, place, message)


WORLDS = [
    ("range", world('<place id="a" x="5000" y="0"/>'), "w.xml:2:18", "out of range"),
    ("infinite", world('<place id="a" x="1e999" y="0"/>'), "w.xml:2:18", "is not a number"),
    ("twice", world('<place id="a" x="0" y="0"/><thing id="a" x="0" y="0"/>'), "w.xml:2:39", "twice"),
    ("way", world('<place id="lab" x="0" y="0"/><way from="lab" to="lob"/>'), "w.xml:2:50", 'mean "lab"?'),
    ("foreign", world(f'<x:place{FOREIGN} id="a"/>'), "w.xml:2:1", "another namespace"),
    ("wall", world('<wall x1="1e308" y1="0" x2="0" y2="1"/>'), "w.xml:2:11", "out of range"),
]  # fmt: skip
ROBOTS = [
    ("radius", robot("", 'radius="-1"'), "w.xml:1:63", "out of range"),
    ("speed", robot("", 'speed="0"'), "w.xml:1:62", "out of range"),
    ("twice", robot('<adds command="speak" devices="arm"/>'), "w.xml:2:16", "already"),
    ("allows", robot('<allows command="speek" argument="v"/>'), "w.xml:2:18", 'mean "speak"?'),
    ("foreign", robot(f"<x:camera{FOREIGN} angle='1'/>"), "w.xml:2:1", "another namespace"),
    ("adds-device", robot('<adds command="dance" devices="leg"/>'), "w.xml:2:32", "leg"),
    ("bounds", robot('<adds command="a" devices="arm"><argument name="n" kind="number" low="5" high="1"/></adds>'), "w.xml:2:", "low"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text", "place", "message"), WORLDS + ROBOTS)
def test_worlds_and_robots(
    prima: Prima, tmp_path: Path, name: str, text: str, place: str, message: str
) -> None:
    write(tmp_path, "w.xml", text)
    prima("validate", "w.xml").check(1, place, message)


def test_a_run_of_no_time(prima: Prima, tmp_path: Path) -> None:
    path = stage(tmp_path, GOOD, attributes='until="0s"')
    assert "alive" not in prima("run", path).check(0).out


def test_a_world_of_nothing(prima: Prima, tmp_path: Path) -> None:
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "w.xml", world('<wall x1="0" y1="0" x2="0" y2="0"/>'))
    write(tmp_path, "s.xml", scenario(PLAY, world="w.xml"))
    prima("run", "s.xml").check(0, "log: alive")


LACKING = block("<speak>x</speak>")


@pytest.mark.parametrize(
    ("body", "code", "message"),
    [
        (LACKING, 3, "a: error.unsupported.speak: app.xml:2"),
        (LACKING + CATCH.join(['<form id="g">', "</form>"]), 3, "error.unsupported.speak"),
        (form(f"<block><speak>x</speak></block>{CATCH}"), 0, "caught"),
    ],
)
def test_a_robot_without_devices(
    prima: Prima, tmp_path: Path, body: str, code: int, message: str
) -> None:
    write(tmp_path, "app.xml", app(body))
    write(tmp_path, "r.xml", '<robot xmlns="urn:prima:robot:1" version="1.0" id="r"/>')
    write(tmp_path, "s.xml", scenario(PLAY, robot="r.xml"))
    said = prima("run", "s.xml").check(code, message)
    assert "app.xml:2:21: warning: This robot cannot do speak" in said.err


DANCE = '<adds command="dance" devices="arm">{}</adds><allows command="speak" argument="voice"/>'
NUMBER = '<argument name="n" kind="number" low="5"/>'


@pytest.mark.parametrize(
    ("body", "arguments", "code", "message"),
    [
        ('<command type="danse"/>', "", 1, 'app.xml:2:21: error: This robot has no Command "danse". Did you mean "dance"?'),
        ('<speak>x<param name="voic" value="1"/></speak>', "", 1, 'Did you mean "voice"?'),
        ('<topological-move to="moon"/>', "", 3, 'a: error.device.localization: app.xml:2:21: there is no way to "moon"'),
        ('<gesture name="jump"/>', "", 3, 'the robot knows no gesture "jump"'),
        ('<turn angle-expr="0/0"/>', "", 3, "error.semantic: app.xml:2:21: angle"),
        ('<turn angle-expr="1/0"/>', "", 3, "error.semantic: app.xml:2:21: angle"),
        ('<turn angle-expr="[]"/>', "", 3, "is not a number"),
        ('<send event="x" delay-expr="0/0"/>', "", 3, "is not a time"),
        ('<send event="x" delay-expr="-1"/>', "", 3, "is not a time"),
        ('<goto next-expr="1/0"/>', "", 3, "error.badfetch: app.xml:2:21: there is no form"),
        ('<set-speed-and-time time-expr="1e300"/>', "", 3, "error.semantic: app.xml:2:21: time"),
        ('<set-direction toward-expr="1/0"/>', "", 3, "error.semantic: app.xml:2:21: toward"),
        ('<set-direction toward-expr="0/0"/>', "", 3, "error.semantic: app.xml:2:21: toward"),
        ('<command type="dance"><param name="n" expr="1"/></command>', NUMBER, 3, "out of range"),
    ],
)  # fmt: skip
def test_commands_and_arguments(
    prima: Prima, tmp_path: Path, body: str, arguments: str, code: int, message: str
) -> None:
    write(tmp_path, "app.xml", app(block(body)))
    write(tmp_path, "r.xml", robot(DANCE.format(arguments)))
    write(tmp_path, "s.xml", scenario(PLAY, robot="r.xml"))
    prima("run", "s.xml").check(code, message)


# Expressions and scripts at run time ---------------------------------------------------

EXPRESSIONS = [
    ("throws", "(function(){throw new Error('boom')})()", "Error: boom"),
    ("throws-symbol", "(function(){throw Symbol('x')})()", "app.xml:3"),
    ("type-error", "document.x.y", "TypeError"),
    ("loops", "(function(){while(1);})()", "longer than 0.5 s"),
    ("eats", "(function(){var a=[];while(1)a.push(Array(1000).fill(1))})()", "too much memory"),
    ("grows", "(function(){var a='x';while(1)a+=a})()", "too much memory"),
    ("sets", "(function(){var s=new Set();for(var i=0;;i++)s.add(i)})()", "too much memory"),
    ("recurses", "(function f(){f()})()", "call stack"),
    ("regex", "/^(a+)+$/.test('a'.repeat(40)+'b')", "longer than 0.5 s"),
    ("bigint", "10n**(10n**7n)", "RangeError"),
    ("long", "'x'.repeat(200000)", "more than 100,000 characters"),
    ("deep", "(function(){var a=[];for(var i=0;i<5000;i++)a=[a];return a})()", "call stack"),
    ("circular", "(function(){var a=[];a.push(a);return a})()", "circular"),
    ("deep-json", "JSON.parse('['.repeat(500000))", "call stack"),
    ("deep-eval", "eval('('.repeat(500000))", "call stack"),
    ("spread", "Math.max(...Array(900000))", "too much memory"),
    ("no-clock", "eval('performance').now()", "not defined"),
    ("null-thrown", "(function(){throw null})()", "it threw null"),
    ("says-interrupted", "(function(){throw 'interrupted'})()", ": interrupted"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "code", "message"), EXPRESSIONS)
def test_expressions(prima: Prima, tmp_path: Path, name: str, code: str, message: str) -> None:
    """Each is a timely event that the document can handle, with its place."""
    shown = code.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    asked = f'\n<send to="x"><param name="p" expr="{shown}"/></send><exit/>'
    began = time.monotonic()
    prima("run", stage(tmp_path, app(form(f"<block>{asked}</block>{CATCH}"))), "-o", "t").check(0)
    assert time.monotonic() - began < 3
    [said] = messages(tmp_path / "t")
    assert said.startswith("caught app.xml:3:") and message in said


@pytest.mark.parametrize("code", ["null", "undefined", "String(1) ? null : 1"])
def test_nothing_in_the_place_of_a_value_is_told(prima: Prima, tmp_path: Path, code: str) -> None:
    turns = app(form(f'<block><turn angle-expr="{code}"/></block>{CATCH}'))
    prima("run", stage(tmp_path, turns), "-o", "t")
    assert "angle (null or undefined) is not a number." in messages(tmp_path / "t")[0]


BAD = "document.x.y"
SITES = [
    ("log", block(f'<log expr="{BAD}"/>')),
    ("speak", block(f'<speak><value expr="{BAD}"/></speak>')),
    ("script", block("<script>document.x.y</script>")),
    ("if", block(f'<if cond="{BAD}"/>')),
    ("foreach", block(f'<foreach item="i" array="{BAD}"/>')),
    ("no-array", block('<foreach item="i" array="7"/>')),
    ("argument", block(f'<turn angle-expr="{BAD}"/>')),
    ("form-variable", form(f'<var name="z" expr="{BAD}"/>')),
    ("form-script", form(f"<script>{BAD}</script>")),
    ("item-value", form(f'<field name="q" type="text" expr="{BAD}"/>')),
    ("prompt", form(f'<field name="q" type="text"><prompt><value expr="{BAD}"/></prompt></field>')),
    ("goto", block(f'<goto next-expr="{BAD}"/>')),
    ("block-condition", form(f'<block cond="{BAD}"/>')),
    ("handler-condition", form(f'<block><throw event="foo"/></block><on event="foo" cond="{BAD}"/>')),
    ("watch", form(f'<watch name="w" when="{BAD}"/>')),
    ("document-variable", f'<var name="z" expr="{BAD}"/>' + form("")),
    ("return", form('<subdialog name="s" src="#g"/>') + form("<var name='x' expr=\"'x'.repeat(99999)\"/><block><assign name='x' expr='x.concat(x).slice(0)'/><return namelist='x'/></block>", "g")),
]  # fmt: skip


def played(folder: Path, document: str) -> Path:
    return stage(folder, document, '<when at="1s"><sensor name="a" value="1"/></when>')


@pytest.mark.parametrize(("name", "body"), SITES)
def test_every_expression_that_fails_can_be_handled(
    prima: Prima, tmp_path: Path, name: str, body: str
) -> None:
    prima("run", played(tmp_path, app(body, head=CATCH)), "-o", "t").check(0)
    assert messages(tmp_path / "t")[0].startswith("caught app.xml:2:")


@pytest.mark.parametrize(("name", "body"), SITES)
def test_every_expression_that_fails_ends_the_application(
    prima: Prima, tmp_path: Path, name: str, body: str
) -> None:
    prima("run", played(tmp_path, app(body)), "-o", "t").check(3, "prima: a: error.semantic: ")


def test_an_error_ends_its_application_alone(prima: Prima, tmp_path: Path) -> None:
    write(tmp_path, "bad.xml", app(block(f'<log expr="{BAD}"/>'), name="bad"))
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "s.xml", scenario('<application src="bad.xml"/>' + PLAY))
    prima("run", "s.xml", "-o", "t").check(3, "prima: bad: error.semantic: bad.xml:2")
    assert messages(tmp_path / "t") == ["alive"]


HOSTILE = [
    ("freeze", "Object.freeze(application); Object.freeze(document); Object.freeze(dialog)"),
    (
        "prototype",
        "Object.defineProperty(Object.prototype, 'event', {set: function () { throw 1 }})",
    ),
    (
        "full",
        "document.a = []; try { while (1) document.a.push('x' + document.a.length) } catch (e) {}",
    ),
    ("promise", "Promise.resolve(1).then(function () { while (1); })"),
    ("stringify-number", "JSON.stringify = function () { return 42 }"),
    ("stringify-text", "JSON.stringify = function () { return '{' }"),
]


@pytest.mark.parametrize(("name", "code"), HOSTILE)
def test_hostile_scripts(prima: Prima, tmp_path: Path, name: str, code: str) -> None:
    given = '<send to="x"><param name="p" expr="({a: 1})"/></send>' if name != "full" else ""
    body = block(f"<script>{code}</script>{given}<speak>x</speak><log>alive</log><exit/>")
    happens = '<service name="x"/>'
    prima("run", stage(tmp_path, app(body), happens), "-o", "t").check(0)
    assert messages(tmp_path / "t") == ["alive"]


def test_a_setter_for_the_clock(prima: Prima, tmp_path: Path) -> None:
    code = "Object.defineProperty(application, 'session', {set: function () { throw 1 }})"
    body = block(f"<script>{code}</script><speak>x</speak><log>alive</log><exit/>")
    said = prima("run", stage(tmp_path, app(body)), "-o", "t")
    assert said.code in (0, 3)
    said.check(said.code)


def test_a_long_text_made_of_two(prima: Prima, tmp_path: Path) -> None:
    body = block("<log expr=\"'a'.repeat(9000) + 'b'\"/><exit/>")
    prima("run", stage(tmp_path, app(body)), "-o", "t").check(0)
    assert len(messages(tmp_path / "t")[0]) == 9001


def test_an_application_with_a_dot_in_its_name(prima: Prima, tmp_path: Path) -> None:
    document = app(block("<speak>x</speak><log>alive</log><exit/>"), name="my.app")
    prima("run", stage(tmp_path, document)).check(1, "app.xml:1:65: error", "has a dot")


def test_nobody_answers_all_day(
    prima: Prima, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(loop, "MAX_RECORDS", 5_000)
    body = form('<field name="q" type="text"><prompt timeout="0s"/></field>')
    path = stage(tmp_path, app(body), attributes='until="86400s"')
    prima("run", path, "-o", "t").check(
        3, "more records, or more text, than a run may. Let what", "wait longer each time"
    )
    prima("show", "t").check(0)


# Documents that do not wait ---------------------------------------------------------

AT_ONCE = '<send event="a.b" delay="0s"/>'
LOOPS = [
    ("goto", block('<goto next="#f"/>'), "loops without ever waiting"),
    ("goto-cycle", block('<goto next="#g"/>') + form('<block><goto next="#f"/></block>', "g"), "without ever waiting"),
    ("item", form('<block name="b"><goto nextitem="b"/></block>'), "without ever waiting"),
    ("clear", block("<clear/>"), "without ever waiting"),
    ("send", block(AT_ONCE).replace("</form>", f'<on event="a.b">{AT_ONCE}<log>x</log></on></form>'), "without ever waiting"),
    ("sends", block(AT_ONCE * 40).replace("</form>", f'<on event="a.b"><log>x</log>{AT_ONCE}</on></form>'), "without ever waiting"),
    ("throw", block('<throw event="a"/>').replace("</form>", '<on event="a"><throw event="a"/></on></form>'), "throw without end"),
    ("throw-deep", block('<throw event="a"/>').replace("</form>", '<on event="a">' + '<if cond="true">' * 90 + '<throw event="a"/>' + "</if>" * 90 + "</on></form>"), "throw without end"),
    ("error-in-error", form(f'<block><throw event="error.x"/></block><on event="error"><log expr="{BAD}"/></on>'), "throw without end"),
    ("subdialog", form('<subdialog src="#f"/>'), "more than 32 subdialogs"),
    ("subdialog-loop", form('<subdialog name="s" src="#g"><filled><clear/></filled></subdialog>') + form("<block><return/></block>", "g"), "without ever waiting"),
    ("foreach", block('<foreach item="i" array="Array(9000).fill(1)"><foreach item="j" array="Array(9000).fill(1)"><log>x</log></foreach></foreach>'), "without ever waiting"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "body", "message"), LOOPS)
def test_loops(prima: Prima, tmp_path: Path, name: str, body: str, message: str) -> None:
    prima("run", stage(tmp_path, app(body))).check(3, "prima: a: ", "app.xml:2", message)


def test_who_sends_himself_event_after_event_ends_alone(prima: Prima, tmp_path: Path) -> None:
    loops = block(AT_ONCE).replace("</form>", f'<on event="a.b">{AT_ONCE}</on></form>')
    write(tmp_path, "bad.xml", app(loops, name="bad"))
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "s.xml", scenario('<application src="bad.xml"/>' + PLAY))
    prima("run", "s.xml", "-o", "t").check(3, "prima: bad: error.semantic: bad.xml:2:75: it loops")
    assert messages(tmp_path / "t") == ["alive"]
    assert len((tmp_path / "t").read_bytes()) < 5_000_000


def test_who_waits_between_his_events_may_go_on(prima: Prima, tmp_path: Path) -> None:
    ticks = AT_ONCE.replace("0s", "20ms")
    path = stage(
        tmp_path,
        app(block(AT_ONCE).replace("</form>", f'<on event="a.b">{ticks}</on></form>')),
        attributes='until="600s"',
    )
    prima("run", path, "-o", "t").check(0)
    assert (tmp_path / "t").read_text().count('"a.b"') > 29_000


def test_subdialogs_inside_each_other_can_be_handled(prima: Prima, tmp_path: Path) -> None:
    path = stage(tmp_path, app(form(f'<subdialog src="#f"/>{CATCH}')))
    prima("run", path).check(0, "caught app.xml:2:14: more than 32")


STORMS = [
    ("noinput", form('<field name="q" type="text"><prompt timeout="0s">x</prompt><noinput><reprompt/></noinput></field>'), "", 0),
    ("cancel", form('<on event="go"><speak order="now">x</speak></on><on event="cancel"><speak order="now">y</speak></on>'), '<when at="1s">' + '<event name="go"/>' * 3 + "</when>", 3),
    ("end", form('<block><speak>x</speak></block><on event="end"><speak>y</speak></on>'), "", 0),
    ("handlers", form('<on event="go"><speak>x</speak></on>'), '<when at="1s">' + '<event name="go"/>' * 200 + "</when>", 3),
    ("timers", block("<foreach item=\"i\" array=\"Array(999).fill(1)\"><send event=\"x\" delay=\"9s\"/></foreach>"), "", 3),
]  # fmt: skip


@pytest.mark.parametrize(("name", "body", "happens", "code"), STORMS)
def test_storms(
    prima: Prima, tmp_path: Path, name: str, body: str, happens: str, code: int
) -> None:
    prima("run", stage(tmp_path, app(body), happens), "-o", "t").check(code)


EATERS = [
    ("huge-array", app(block('<foreach item="i" array="Array(100000)"><log>x</log></foreach>')), 3),
    ("endless-array", app(block('<foreach item="i" array="Array(1e9)"><log>x</log></foreach>')), 3),
    ("no-array", app(block("<script>Array.isArray = function () { return true }</script><foreach item=\"i\" array=\"({length: 'z'})\"/>")), 3),
    ("slow-errors", app(block('<log expr="(function(){while(1);})()"/>').replace("</form>", '<on event="error"><goto next="#f"/></on></form>')), 3),
    ("logs", app(block("<foreach item=\"i\" array=\"Array(9000).fill(1)\"><log expr=\"'x'.repeat(99999)\"/></foreach><exit/>")), 3),
    ("values", app(block("<var name=\"b\" expr=\"'x'.repeat(99999)\"/><speak>" + '<value expr="b"/>' * 30_000 + "</speak><exit/>")), 0),
    ("event-name", app(block('<throw event="' + "a." * 60_000 + 'a"/>').replace("</form>", '<on event="a"><exit/></on></form>')), 1),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data", "code"), EATERS, ids=lambda value: str(value)[:20])
def test_time_and_memory(tmp_path: Path, name: str, data: str, code: int) -> None:
    path = stage(tmp_path, data)
    process(tmp_path, "run", path, "-o", "t", seconds=6, memory=GIGABYTE).check(code)


HAPPENINGS = [
    ("text", '<sensor name="a" value="&#x1F600;"/>', 0),
    ("late-clash", '<sensor name="a.b" value="1"/><sensor name="a" value="1"/>', 0),
    ("nan", '<sensor name="a" value="nan"/>', 0),
    ("clash", '<sensor name="a" value="1"/><sensor name="a.b" value="1"/>', 0),
    ("far", '<walk x="1e308" y="-1e308"/>', 1),
]  # fmt: skip


@pytest.mark.parametrize(("name", "happens", "code"), HAPPENINGS)
def test_happenings(prima: Prima, tmp_path: Path, name: str, happens: str, code: int) -> None:
    document = app(form('<watch name="w" when="sensor.a > 1"/><on event="w"><exit/></on>'))
    body = f'<person x="-1e300" y="0"/><when at="0s">{happens}</when>'
    if name != "far":
        body = body.replace("-1e300", "1")
    prima("run", stage(tmp_path, document, body)).check(code)


# Grammars ---------------------------------------------------------------------------

GRAMMARS = [
    ("left", '<rule id="a"><ruleref uri="#a"/>x</rule>'),
    ("mutual", '<rule id="a"><ruleref uri="#b"/></rule><rule id="b"><ruleref uri="#a"/></rule>'),
    ("exponential", '<rule id="a"><item repeat="0-"><item repeat="0-"><item repeat="0-">a</item></item></item>b</rule>'),
    ("choices", '<rule id="a">' + '<item repeat="0-1">a</item>' * 40 + "</rule>"),
    ("repeats", '<item repeat="0-999"><item repeat="0-999">a</item></item>'),
    ("nothing", '<item repeat="1-"><item repeat="0-1"/></item>'),
    ("long", "<item>a</item>" * 5_000),
]  # fmt: skip


@pytest.mark.parametrize(("name", "content"), GRAMMARS)
def test_grammars(prima: Prima, tmp_path: Path, name: str, content: str) -> None:
    body = grammar(content).replace("<grammar>", "<prompt>Well?</prompt><grammar>", 1)
    body = body.replace("</field>", "<nomatch><exit/></nomatch><filled><exit/></filled></field>")
    answer = f'<person x="1" y="0"/><answer to="Well?">{"a " * 60}c</answer>'
    began = time.monotonic()
    prima("run", stage(tmp_path, app(body), answer)).check(0)
    assert time.monotonic() - began < SECONDS


def test_a_service_nobody_offers(prima: Prima, tmp_path: Path) -> None:
    body = form(f'<block><send to="mars"/></block>{CATCH}')
    prima("run", stage(tmp_path, app(body))).check(0, 'there is no service "mars"', "caught")


# Transcripts -----------------------------------------------------------------------------


@pytest.fixture
def transcript(prima: Prima, tmp_path: Path) -> str:
    """A good transcript, ``good.jsonl``, of ``s.xml``."""
    prima("run", stage(tmp_path, GOOD), "-o", "good.jsonl").check(0)
    return (tmp_path / "good.jsonl").read_text()


def record(phase: str, **fields: object) -> str:
    return json.dumps({"time": 0, "phase": phase, "actor": "mediator", **fields}) + "\n"


NOT_TRANSCRIPTS: list[Any] = [
    ("empty", b"", "it has no records"),
    ("blank", b"\n\n", "it has no records"),
    ("binary", bytes(range(256)), "it is not UTF-8"),
    ("utf-16", record("run").encode("utf-16"), "it is not UTF-8"),
    ("xml", b"<a/>\n", "t.jsonl:1: this is not a line of JSON"),
    ("foreign", b'{"a":1}\n', "t.jsonl:1: not a transcript's record: time"),
    ("list", b"[1]\n", "t.jsonl:1: not a transcript's record"),
    ("phase", record("zzz").encode(), "t.jsonl:1: not a transcript's record: phase"),
    ("second-line", (record("over") + "x\n").encode(), "t.jsonl:2: this is not a line"),
    ("deep", b"[" * 100_000 + b"\n", "t.jsonl:1: this is not a line of JSON"),
    ("number", b'{"time":' + b"9" * 5000 + b"}\n", "t.jsonl:1: this is not a line of JSON"),
    ("negative", record("over", time=-1).encode(), "t.jsonl:1: not a transcript's record"),
    ("nan", b'{"time":NaN,"phase":"over","actor":"user"}\n', "t.jsonl:1: this is no"),
    ("field", record("run", colour="red").encode(), "t.jsonl:1: not a transcript's record"),
    ("infinite", b'{"time":1e999,"phase":"over","actor":"mediator"}\n', "t.jsonl:1: "),
    ("long-line", b'{"a":"' + b"x" * 2_000_000 + b'"}\n', "t.jsonl:1: the line is too long"),
    *(
        (f"{phase}-without-its-fields", record(phase, goal=True).encode(), "t.jsonl:1: ")
        for phase in ("start", "end", "event", "note", "log", "emergency", "load")
    ),
    ("time-as-text", record("note", time="0", text="x").encode(), "t.jsonl:1: "),
    ("half-a-pair", record("note", text="\ud800").encode(), "t.jsonl:1: "),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data", "message"), NOT_TRANSCRIPTS)
@pytest.mark.parametrize("command", ["show", "diff", "explain"])
def test_not_transcripts(
    prima: Prima, tmp_path: Path, transcript: str, name: str, data: bytes, message: str, command: str
) -> None:  # fmt: skip
    write(tmp_path, "t.jsonl", data)
    given = {"show": ["t.jsonl"], "diff": ["good.jsonl", "t.jsonl"], "explain": ["t.jsonl", "0"]}
    prima(command, *given[command]).check(2, "prima: t.jsonl", message)


def test_a_transcript_cut_off(prima: Prima, tmp_path: Path, transcript: str) -> None:
    write(tmp_path, "t.jsonl", transcript[:-20])
    for arguments in (["show", "t.jsonl"], ["replay", "t.jsonl", "s.xml"]):
        prima(*arguments).check(2, "t.jsonl:", "the record is cut off")


def test_what_stands_before_the_cut_is_shown(prima: Prima, tmp_path: Path, transcript: str) -> None:
    write(tmp_path, "t.jsonl", transcript[:-20])
    assert '"Hello there."' in prima("show", "t.jsonl").out


HOLLOW = [
    record("send", app="a", data={}),
    record("transferred", app="a", serial=1, outcome="busy", data={}),
    record("fetched", app="a", data={}),
    record("halted", behavior="a#1", data={}),
    record("held", app="a", tree="a:1", data={}),
]
"""Records that lack something inside them, which only some of the commands look at."""
READERS = {
    "show": ["show", "bad.jsonl", "--why"],
    "explain": ["explain", "bad.jsonl", "0"],
    "diff": ["diff", "good.jsonl", "bad.jsonl"],
    "diff-json": ["diff", "bad.jsonl", "good.jsonl", "--format", "json"],
    "diff-html": ["diff", "bad.jsonl", "good.jsonl", "--format", "html", "-o", "page.html"],
    "report": ["report", "bad.jsonl", "-o", "page.html"],
    "graph-tree": ["graph", "bad.jsonl", "--what", "tree", "-o", "tree.svg"],
    "graph-streams": ["graph", "bad.jsonl", "--what", "streams", "-o", "streams.svg"],
    "export": ["export", "bad.jsonl", "--to", "csv"],
    "replay": ["replay", "bad.jsonl", "s.xml"],
}


@pytest.mark.parametrize("reader", READERS)
def test_a_record_that_lacks_something_is_no_defect_of_prima(
    prima: Prima, tmp_path: Path, transcript: str, reader: str
) -> None:
    lines = transcript.splitlines(keepends=True)
    for lacking in HOLLOW:
        write(tmp_path, "bad.jsonl", "".join([lines[0], lacking, *lines[1:]]))
        done = prima(*READERS[reader])
        assert done.check(done.code).code in (0, 1, 2), lacking
        assert done.code < 2 or " lacks a field of its phase." in done.err, lacking


def inbound(phase: str, **fields: object) -> Callable[[str], str]:
    made = record(phase, inbound=True, **fields)
    return lambda good: good.splitlines(keepends=True)[0] + made


def head(**data: object) -> Callable[[str], str]:
    return lambda good: record("run", data=data) + "".join(good.splitlines(keepends=True)[1:])


REPLAYS: list[Any] = [
    ("same", lambda good: good, 0, "the same"),
    ("crlf", lambda good: good.replace("\n", "\r\n"), 0, "the same"),
    ("edited", lambda good: good.replace("Hello", "Hullo"), 1, "differs"),
    ("shuffled", lambda good: good.splitlines(True)[0] + "".join(reversed(good.splitlines(True)[1:])), 1, "differs"),
    ("no-head", lambda good: "".join(good.splitlines(True)[1:]), 2, "does not begin with its run"),
    ("policy", head(policy="zz"), 2, 'There is no policy "zz"'),
    ("other-file", lambda good: re.sub(r'"app.xml":"\w+"', '"app.xml":"0"', good), 2, "not the file"),
    ("unknown-app", inbound("load", app="zz"), 2, 'loads "zz"'),
    ("unknown-ab", inbound("end", behavior="zz#1", command="speak", app="a"), 1, "differs"),
    ("head-empty", lambda good: record("run"), 2, "t.jsonl"),
    ("head-no-policy", head(), 2, "t.jsonl"),
    ("head-policy-5", head(policy=5), 2, "t.jsonl"),
    ("head-files", head(policy="prima", files=[1]), 2, "t.jsonl"),
    *(
        (f"bare-{phase}", inbound(phase), 2, "t.jsonl")
        for phase in ("end", "event", "load", "emergency", "note", "fail", "listening")
    ),
]  # fmt: skip


@pytest.mark.parametrize(("name", "edit", "code", "message"), REPLAYS)
def test_edited_transcripts(
    prima: Prima, tmp_path: Path, transcript: str, name: str, edit: Callable[[str], str],
    code: int, message: str,
) -> None:  # fmt: skip
    (tmp_path / "t.jsonl").write_bytes(edit(transcript).encode())
    prima("replay", "t.jsonl", "s.xml").check(code, message)


def test_a_transcript_of_other_applications(prima: Prima, tmp_path: Path, transcript: str) -> None:
    write(tmp_path, "other.xml", app(block("<exit/>")))
    write(tmp_path, "s2.xml", scenario('<application src="other.xml"/>'))
    prima("replay", "good.jsonl", "s2.xml").check(2, 'made with "s.xml"')


def test_an_event_that_nothing_handles(prima: Prima, tmp_path: Path) -> None:
    path = stage(tmp_path, app(block('<throw event="bored"/>')))
    prima("run", path).check(3, "prima: a: bored", 'write <on event="bored">')


def test_a_time_far_away(prima: Prima, tmp_path: Path) -> None:
    loop = form('<block><send event="e"/></block><on event="e"><send event="e"/></on>')
    prima("run", stage(tmp_path, app(loop), attributes='until="1s"'), "-o", "t").check(0)
    lines = (tmp_path / "t").read_text().splitlines(keepends=True)
    lines[-1] = re.sub(r'"time":[\d.]+', '"time":1e8', lines[-1])
    write(tmp_path, "t", "".join(lines))
    process(tmp_path, "replay", "t", "s.xml").check(2, "more than a day")


def test_a_transcript_without_an_end(tmp_path: Path) -> None:
    process(tmp_path, "show", "/dev/zero", memory=GIGABYTE).check(2, "/dev/zero:1")


def test_a_scenario_that_names_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    write(tmp_path, "s.xml", scenario('<application src="pipe"/>'))
    process(tmp_path, "validate", "s.xml").check(1, "s.xml:2:19")


# The command line --------------------------------------------------------------------------

USAGES: list[Any] = [
    ([], 2, "Usage:"),
    (["rn"], 2, 'Did you mean "run"?'),
    (["vaildate", "x"], 2, 'Did you mean "validate"?'),
    (["zzz"], 2, 'There is no command "zzz". prima --help lists them.'),
    (["--verson"], 2, "--version"),
    (["run"], 2, "Name a scenario"),
    (["validate"], 2, "Missing argument"),
    (["run", "s.xml", "more"], 2, "more: cannot be read: No such file"),
    (["run", "s.xml", "--polcy", "fifo"], 2, "--policy"),
    (["run", "s.xml", "--policy", "fif"], 2, 'Did you mean "fifo"?'),
    (["run", "s.xml", "--policy", "x\x1b[31m"], 2, "Write fair, fifo"),
    (["run", "s.xml", "--bound", "0"], 2, "not in the range"),
    (["run", "s.xml", "--bound", "x"], 2, "not a valid integer"),
    (["run", "s.xml", "--bound", "9" * 50, "-o", "t"], 0, "records"),
    (["run", "s.xml", "--format", "jsn"], 2, "jsn"),
    (["run", "no.xml"], 2, "no.xml: cannot be read: No such file"),
    (["run", "."], 0, "runs: 1; fine: 1"),
    (["run", "app.xml"], 1, "a scenario is needed here. prima run and prima talk take it by --fa app.xml."),
    (["run", "good.jsonl"], 1, "prima show prints it"),
    (["run", "s.xml", "-o", "."], 2, "Is a directory"),
    (["run", "s.xml", "-o", ""], 2, "cannot be written"),
    (["run", "s.xml", "-o", "no/t"], 2, "no/t: cannot be written: No such file"),
    (["run", "s.xml", "-o", "/proc/t"], 2, "/proc/t: cannot be written"),
    (["validate", "/dev/zero"], 2, "/dev/zero: cannot be read"),
    (["show", "s.xml"], 2, "s.xml:1: this is not a line of JSON"),
    (["replay", "good.jsonl", "app.xml"], 1, "a scenario is needed here"),
    (["run", "s.xml", "--policy", "fixed:A"], 2, 'Did you mean "a"?'),
    (["run", "s.xml", "--policy", "fixd"], 2, "fixed:APP"),
    (["show", "no"], 2, "no: cannot be read"),
    (["show", "x" * 5000], 2, "cannot be read"),
    (["diff", "good.jsonl"], 2, "Name two transcripts"),
    (["replay", "s.xml", "good.jsonl"], 2, "s.xml:1: this is not a line of JSON"),
    (["explain", "undeclard-variable"], 2, 'Did you mean "undeclared-variable"?'),
    (["explain", "good.jsonl"], 2, "Say which row"),
    (["explain", "good.jsonl", "99"], 2, "the rows are 0 to 3"),
    (["explain", "good.jsonl", "9" * 30], 2, "There is no row"),
    (["explain", ".", "1"], 2, "Is a directory"),
    (["run", "s.xml", "--policy", "fixed:zz"], 2, '"fixed:zz" names an application that is not in the scenario. Write a.'),
    (["run", "s.xml", "--policy", ""], 2, "policy"),
    (["run", "s.xml", "-o", "s.xml"], 2, "s.xml"),
    (["run", "s.xml", "-o", "/dev/full"], 2, "No space left"),
    (["replay", "good.jsonl", "s.xml", "-o", "/dev/full"], 2, "No space left"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "code", "message"), USAGES, ids=lambda value: str(value)[:40]
)
def test_usage(
    prima: Prima, transcript: str, arguments: list[str], code: int, message: str
) -> None:
    prima(*arguments).check(code, message)


def test_no_row_at_all(prima: Prima, tmp_path: Path) -> None:
    write(tmp_path, "t.jsonl", record("over"))
    prima("explain", "t.jsonl", 0).check(2, "no row")


def test_a_folder_that_is_read_only(prima: Prima, tmp_path: Path, transcript: str) -> None:
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o500)
    if os.access(folder, os.W_OK):
        pytest.skip("whoever runs this may write everywhere")
    prima("run", "s.xml", "-o", folder / "t").check(2, "cannot be written: Permission denied")


# Pipes, terminals and signals ----------------------------------------------------------------


def closed_pipe(folder: Path) -> Result:
    """What a long table gives when its reader goes away after the first line."""
    write(folder, "long.jsonl", "".join(record("note", text="x" * 60) for _ in range(5_000)))
    made = subprocess.Popen(
        [sys.executable, "-m", "prima", "show", "long.jsonl"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert made.stdout is not None and made.stderr is not None
    first = made.stdout.readline()
    made.stdout.close()
    with made.stderr:
        return Result(made.wait(SECONDS), first, made.stderr.read())


def test_a_pipe_that_is_closed(tmp_path: Path) -> None:
    said = closed_pipe(tmp_path)
    assert "Behavior" in said.out and said.err == ""


def test_a_closed_pipe_is_no_problem(tmp_path: Path) -> None:
    closed_pipe(tmp_path).check(0)


@pytest.mark.parametrize("given", [["show", "good.jsonl"], ["--help"], ["explain", "bad-value"]])
def test_a_full_disk_behind_the_standard_output(
    tmp_path: Path, prima: Prima, transcript: str, given: list[str]
) -> None:
    with Path("/dev/full").open("w") as full:
        process(tmp_path, *given, stdout=full).check(2, "No space left")


@pytest.mark.parametrize("given", ["show good.jsonl", "validate s.xml"])
def test_no_standard_output(tmp_path: Path, prima: Prima, transcript: str, given: str) -> None:
    done = subprocess.run(
        ["sh", "-c", f'"{sys.executable}" -m prima {given} >&-'],
        cwd=tmp_path, capture_output=True, text=True, timeout=SECONDS, check=False,
    )  # fmt: skip
    Result(done.returncode, done.stdout, done.stderr).check(done.returncode)


def on_terminal(folder: Path, *args: object) -> bytes:
    """What a command shows on a terminal, where nothing takes control sequences out."""
    ours, theirs = pty.openpty()
    made = subprocess.Popen(
        [sys.executable, "-m", "prima", *map(str, args)], cwd=folder,
        stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs,
    )  # fmt: skip
    os.close(theirs)
    shown = b""
    try:
        while more := os.read(ours, 65_536):
            shown += more
    except OSError:
        pass  # the terminal's other end is closed
    made.wait(SECONDS)
    os.close(ours)
    return shown


CONTROLS = (
    "<speak>caf&#x9b;31m</speak>"
    "<log expr=\"'\\x1b[31mred\\x07'\"/>"
    '<throw event="foo" message-expr="\'\\x1b[2J\\x1b]0;title\\x07\'"/>'
)


@pytest.mark.parametrize(
    "given",
    [
        ["show", "t", "--why"],
        ["run", "s.xml"],
        ["explain", "t", "2"],
        ["diff", "t", "t"],
        ["validate", "v.xml"],
        ["explain", "\x1b[31mx"],
        ["run", "s.xml", "--policy", "\x1b[31m"],
        ["r\x1b[31mn"],
    ],
    ids=lambda given: given[0],
)
def test_control_characters_on_a_terminal(prima: Prima, tmp_path: Path, given: list[str]) -> None:
    prima("run", stage(tmp_path, app(block(CONTROLS))), "-o", "t").check(3)
    write(tmp_path, "v.xml", app(block('<turn angle="&#x9b;31m"/>')))
    shown = on_terminal(tmp_path, *given)
    assert b"Traceback" not in shown and shown
    for control in (b"\x1b", b"\x07", b"\xc2\x9b"):
        assert control not in re.sub(rb"\x1b\[(0|1|2|1;3[136])m", b"", shown)  # its own colours


def test_very_long_texts(prima: Prima, tmp_path: Path) -> None:
    body = block(f"<speak>{'word ' * 300}</speak><log>{'word ' * 20_000}</log><exit/>")
    path = stage(tmp_path, app(body), attributes='until="3000s"')
    said = prima("run", path).check(0, "word word")
    assert max(map(len, said.out.splitlines())) < 140


def test_a_very_long_word(tmp_path: Path) -> None:
    write(tmp_path, "t.jsonl", record("note", text="x" * 100_000))
    process(tmp_path, "show", "t.jsonl", seconds=30).check(0, "x" * 40)


def test_a_long_text_is_said_to_its_end(prima: Prima, tmp_path: Path) -> None:
    path = stage(tmp_path, app(block(f"<speak>{'word ' * 600}</speak><exit/>")), "", 'until="900s"')
    prima("run", path).check(0)


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGKILL"])
def test_what_was_written_before_the_end_stays_readable(
    prima: Prima, tmp_path: Path, name: str
) -> None:
    body = form('<block><tracking-human/></block><on event="x"><exit/></on>')
    path = stage(tmp_path, app(body, kind="ea"), attributes='until="86400s"')
    made = subprocess.Popen(
        [sys.executable, "-m", "prima", "run", str(path), "-o", "t"],
        cwd=tmp_path, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    deadline = time.monotonic() + SECONDS
    while not (tmp_path / "t").exists() or (tmp_path / "t").stat().st_size < 20_000:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    made.send_signal(getattr(signal, name))
    said = made.communicate(timeout=SECONDS)[1]
    if name == "SIGINT":
        assert made.returncode == 130 and said.strip() == "prima: interrupted"
    prima("show", "t").check(0, "Tracking Human")
