"""Wrong documents of applications: each error is reported in its place."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.helpers.bad_input import (
    GIGABYTE,
    GOOD,
    Prima,
    app,
    block,
    form,
    grammar,
    process,
    stage,
    write,
)

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
    ("not-closed-depth", "<depth>", "1:8", "the file ends inside <depth>"),
    ("not-known-depth", "<a>&depth;</a>", "1:4", "The entity &depth; is not known"),
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
    ("null-first", b"\0\0\0", "1:1", "it begins with the character NUL"),
    ("null-remedy", b"<a>\0</a>", "1:4", "Remove the character"),
    ("mismatch-remedy", app(block("<speak>x</speek>")), "2:", "write </speak>"),
    ("never-closed", "<a>", "1:4", "write </a>"),
    ("prefix-remedy", app(block("<x:speak>x</x:speak>")), "2:21", 'Write the name without "x:"'),
    ("ampersand", app(block("<speak>a & b</speak>")), "2:", "Write &amp; for &"),
    ("unquoted", "<a b=1/>", "1:6", "in quotes"),
    ("later-declaration", "\n<?xml version='1.0'?><a/>", "2:6", "very beginning"),
    ("no-version", f"<?xml encoding='EUC-JP'?>{GOOD}", "1:1", 'version="1.0" encoding="EUC-JP"'),
    ("late-version", f"<?xml encoding='UTF-8'\nversion='1.0'?>{GOOD}", "1:1", "not begin with a version"),
    ("nothing-declared", f"<?xml?>{GOOD}", "1:1", "not begin with a version"),
    ("many-attributes", app("<form " + "".join(f'a{n}="" ' for n in range(99)) + "/>"), "2:1", "<form> has more than 64 attributes"),
    ("near-namespace", '<prima xmlns="urn:prima:dialog:1"/>', "1:1", 'Did you mean "urn:prima:dialogue:1"?'),
    ("near-vxml", '<vxml xmlns="http://www.w3.org/2001/vmxl"/>', "1:1", 'Did you mean "http://www.w3.org/2001/vxml"?'),
    ("near-world", '<world xmlns="urn:prima:wolrd:1"/>', "1:1", '"urn:prima:world:1"?'),
    ("transcript", '{"time":0}\n', "1:1", "prima show prints it"),
    ("fifth-edition-doctype", f'<!DOCTYPE {FIFTH} [<!ENTITY a "b">]>{GOOD}', "1:1", "not declare"),
]  # fmt: skip


def test_a_study_file_is_no_document(prima: Prima, tmp_path: Path) -> None:
    path = write(tmp_path, "study.toml", 'scenarios = ["visit.xml"]\n')
    for command in ("validate", "study", "test", "explore"):
        prima(command, path).check(1, f"{path}:1:1", "This is TOML, not XML. If it is a study")


@pytest.mark.parametrize(("name", "data", "place", "message"), XML)
def test_bytes_and_xml(
    prima: Prima, tmp_path: Path, name: str, data: str | bytes, place: str, message: str
) -> None:
    path = write(tmp_path, f"{name}.xml", data)
    prima("validate", path).check(1, f"{path}:{place}", message)


CAFES = app(block("<speak>Le café : é, è, à.</speak><exit/>"))
ACCEPTED = [
    ("utf-8-bom", b"\xef\xbb\xbf" + GOOD.encode()),
    ("utf-16", GOOD.encode("utf-16")),
    ("shift-jis", f'<?xml version="1.0" encoding="Shift_JIS"?>{GOOD}'.encode("shift_jis")),
    ("euc-jp", f'<?xml version="1.0" encoding="EUC-JP"?>{GOOD}'.encode("euc-jp")),
    ("bom-rules", b'\xef\xbb\xbf<?xml version="1.0" encoding="EUC-JP"?>' + GOOD.encode()),
    ("style-sheet", f"<?xml-stylesheet href='x'?>{GOOD}".encode()),
    ("version-in-lines", f"<?xml\n  version = '1.0'\n?>{GOOD}".encode()),
    ("latin-1", f'<?xml version="1.0" encoding="ISO-8859-1"?>{CAFES}'.encode("latin-1")),
    ("gbk", f'<?xml version="1.0" encoding="GBK"?>{app(block("<speak>联通</speak><exit/>"))}'.encode("gbk")),
    ("crlf", GOOD.replace("\n", "\r\n").encode()),
    ("external-dtd", f'<!DOCTYPE prima SYSTEM "http://127.0.0.1:9/x.dtd">{GOOD}'.encode()),
    ("external-dtd-dir", f'<!DOCTYPE prima PUBLIC "-//x" "/dev/zero">{GOOD}'.encode()),
    ("unicode-name", app(block("<exit/>"), name="日本語").encode()),
    ("spaces-in-number", app(form('<on event="x" count=" 3 "><exit/></on>')).encode()),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data"), ACCEPTED)
def test_what_looks_odd_but_is_well(prima: Prima, tmp_path: Path, name: str, data: bytes) -> None:
    prima("validate", write(tmp_path, f"{name}.xml", data)).check(0, "no problems")


@pytest.mark.parametrize("declared", ["ISO-8859-15", "windows-1252", "KOI8-R"])
def test_utf_8_that_declares_letters_of_one_byte_is_told(
    prima: Prima, tmp_path: Path, declared: str
) -> None:
    text = f'<?xml version="1.0" encoding="{declared}"?>{CAFES}'
    path = write(tmp_path, "cafe.xml", text.encode())
    prima("validate", path).check(0, f"{path}:1:31: warning", 'Write encoding="UTF-8".')


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


MEANING = [
    ("unknown-element", block("<speek>x</speek>"), "2:21", 'Did you mean "speak"?'),
    ("voicexml-element", block("<catch/>"), "2:21", 'Write <on event="...">'),
    ("misplaced", form("<speak>x</speak>"), "2:14", "<speak> is not allowed in <form>. Put it into a <block>."),
    ("unknown-attribute", block('<turn angel="3" angle="1"/>'), "2:27", 'Remove it: there is "angle" already.'),
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
    ("brackets", block('<log expr="1)});({"/>'), "2:33", "is not ECMAScript"),
    ("closing-brace", block('<log expr="1) } //"/>'), "2:33", "is not ECMAScript"),
    ("comment-open", block('<log expr="1 /*"/>'), "2:34", "is not ECMAScript"),
    ("condition", block('<if cond="true)//"/>'), "2:35", "is not ECMAScript"),
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
    ("injected-script", block("<script>}); (function(){</script>"), "2:29", "ECMAScript"),
    ("reserved-name", form('<var name="class"/>'), "2:25", "name"),
    ("second-line", block('<log expr="1 +&#10;\n )"/>'), "3:2", "is not ECMAScript"),
    ("references", block('<log expr="1 &lt; 2 &amp;&amp; &#x6e;o"/>'), "2:52", '"no" is not declared'),
    ("script-line", block("<script>\n var a = 1;\n <![CDATA[ a = ) ]]></script>"), "4:16", "ECMAScript"),
    ("script-name", block("<script>var a;\n a = nobody;</script>"), "3:6", '"nobody", which is not'),
    ("no-clock", block('<log expr="performance.now()"/>'), "2:32", '"performance" is not declared'),
    ("sensor", form('<watch name="w" when="sensr.x"/>'), "2:36", 'Did you mean "sensor"?'),
    ("event-comma", form('<on event="touch,message"/>'), "2:25", 'holds a comma. Write "touch message".'),
    ("html", block("<speak><b>x</b></speak>"), "2:28", "Speech is plain text"),
    ("empty-grammar", grammar(""), "2:30", "no words"),
    ("script-src", block('<script src="x.js"/>'), "2:29", "Write the code into the <script>."),
    ("language", form("<block><exit/></block>").replace("<form", '<form xml:lang="en"'), "2:7", "root element"),
    ("goto-case", block('<goto next="#G"/>') + form("", "g"), "2:33", 'Did you mean "g"?'),
    ("send-both", block('<send to="a" event="b"/>'), "2:41", "Keep one of them. [exclusive]"),
    ("send-neither", block("<send/>"), "2:21", "either to or event. [missing-attribute]"),
    ("send-delay", block('<send to="a" delay="1s"/>'), "2:41", "Only an event to the application itself"),
    ("send-delay-expr", block('<send to="a" delay-expr="1"/>'), "2:46", "Only an event to the application"),
    ("send-to-twice", block('<send to="a" to-expr="1"/>'), "2:43", 'has both "to" and "to-expr"'),
    ("goto-empty-expr", block('<goto nextitem-expr=""/>'), "2:42", "is empty"),
    ("param-neither", block('<send to="a"><param name="p"/></send>'), "2:34", "needs a value or an expr"),
    ("param-both", block('<send to="a"><param name="p" value="1" expr="2"/></send>'), "2:66", "Keep one"),
    ("var-dot", block('<var name="a.b" expr="1"/>'), "2:32", "without a scope's name"),
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
    write(tmp_path / "empty", "robot.xml", "<robot/>")
    prima("validate", "--with", good, "empty").check(2, "empty: contains no applications.")
    (tmp_path / "empty" / "gone.xml").symlink_to("nowhere")
    gone = "empty/gone.xml: cannot be read: No such file"
    prima("validate", "empty").check(2, gone)
    prima("validate", "--with", good, "empty").check(2, gone)
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
    ("never-ends", app(form("")).partition("<form")[0] + '< form id="' + " " * 400_000, 1),
    ("never-said", app(form("")).partition("<form")[0] + "< form " + "a" * 400_000, 1),
    ("declared", '<?xml' + ' version="1.0" ' * 20_000 + " " * 200_000 + "?><a/>", 1),
    ("spaces", app(block(f'<log expr="1{" " * 400_000}"/><exit/>')), 0),
    ("undeclared", app(form(many(1_500, lambda n: f'<var name="variable{n}"/>') + "<block>" + many(1_500, lambda n: f'<log expr="variabel{n}"/>') + "</block>")), 1),
    ("gotos", app(many(1_500, lambda n: f'<form id="form-{n}"><block><goto next="#fomr-{n}"/></block></form>')), 1),
    ("speaks", app(block("<speak>x</speak>" * 1_000 + "<exit/>")), 0),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data", "code"), SIZES, ids=lambda value: str(value)[:20])
def test_size(tmp_path: Path, name: str, data: str, code: int) -> None:
    process(tmp_path, "validate", write(tmp_path, f"{name}.xml", data)).check(code)
