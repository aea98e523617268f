"""VoiceXML as it is found: without namespaces, in old encodings, with vendors' words and dates."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import prima
from prima.loading import validate
from prima.script.engine import Engine
from prima.script.evaluation import ScriptError
from tests.helpers.voice import Call, Online, vxml

DEMO = prima.documents_folder()
HEAD = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">'


def scenario(folder: Path, application: str, attributes: str = "") -> Path:
    """A scenario that runs one application."""
    path = folder / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{DEMO / "worlds" / "room.xml"}" robot="{DEMO / "robots" / "papero.xml"}"'
        f' {attributes}><robot at="middle"/><person x="1" y="0"/>'
        f'<application src="{application}"/></scenario>',
        encoding="utf-8",
    )
    return path


def run(
    folder: Path, body: str | bytes, attributes: str = "", head: str = HEAD
) -> prima.Transcript:
    """Run a document, or what stands in one."""
    text = f"{head}{body}</vxml>" if isinstance(body, str) else body
    data = text.encode() if isinstance(text, str) else text
    (folder / "app.vxml").write_bytes(data)
    return prima.rehearse(scenario(folder, "app.vxml", attributes))


def said(transcript: prima.Transcript) -> list[str]:
    """What the robot has said, and how the application ended if not well."""
    assert transcript.failures == []
    return [row.what for row in transcript.rows() if row.what.startswith('"')]


# The calendar of the run ----------------------------------------------------------------

NOW = 1109671200000  # 2005-03-01T10:00:00Z
DATES = [
    ("Date()", "Tue Mar 01 2005 10:00:00 GMT+0000 (UTC)"),
    ("new Date().toString()", "Tue Mar 01 2005 10:00:00 GMT+0000 (UTC)"),
    ("Date.now()", NOW),
    ("new Date().getHours()", 10),
    ("new Date().getYear()", 105),
    ("new Date().getTimezoneOffset()", 0),
    ("new Date().toLocaleString()", "3/1/2005, 10:00:00 AM"),
    ("new Date().toUTCString()", "Tue, 01 Mar 2005 10:00:00 GMT"),
    ("new Date().toGMTString()", "Tue, 01 Mar 2005 10:00:00 GMT"),
    ("new Date().toISOString()", "2005-03-01T10:00:00.000Z"),
    ("JSON.stringify([new Date(0)])", '["1970-01-01T00:00:00.000Z"]'),
    ("new Date(2004, 1, 29, 23, 5).toString()", "Sun Feb 29 2004 23:05:00 GMT+0000 (UTC)"),
    ("new Date(99, 0).getFullYear()", 1999),
    ("new Date(2005, 0, 31) - new Date(2005, 0, 30)", 86_400_000),
    ("new Date(new Date(7)).getTime()", 7),
    ("new Date('2005-03-01').getTime()", NOW - 36_000_000),
    ("new Date('2005-03-01T10:00:00').getTime()", NOW),
    ("new Date('2005-03-01T10:00:00+09:00').getTime()", NOW - 32_400_000),
    ("Date.parse('Mar 1, 2005 5:00 AM EST')", NOW),
    ("Date.parse('1 March 2005 10:00')", NOW),
    ("Date.parse('3/1/05 10:00')", NOW),
    ("Date.parse(Date())", NOW),
    ("Date.parse(new Date().toUTCString())", NOW),
    ("Date.parse(new Date().toLocaleString())", NOW),
    ("String(new Date('tomorrow'))", "Invalid Date"),
    ("Date.parse('2005-13-01')", float("nan")),
    ("(function (d) { d.setHours(26); d.setYear(99); return d.toString(); })(new Date(0))",
     "Sat Jan 02 1999 02:00:00 GMT+0000 (UTC)"),
    ("new Date() instanceof Date && new Date().constructor === Date", True),
    ("Date.length + Date.name + Date.prototype.getHours.name", "7DategetHours"),
    ("Object.keys(Date.prototype).length", 0),
    ("(class Day extends Date {}).prototype instanceof Date", True),
    ("new (eval('Da' + 'te'))().getTime()", NOW),
    ("typeof Date + typeof Intl + typeof performance", "functionundefinedundefined"),
]  # fmt: skip


@pytest.fixture(scope="module")
def engine() -> Engine:
    made = Engine()
    made.now = NOW
    return made


@pytest.mark.parametrize(("code", "value"), DATES)
def test_date(engine: Engine, code: str, value: object) -> None:
    """``Date`` is ECMAScript's, with the run's clock and UTC as the local time zone."""
    found = engine.value(code, tuple(engine.scope() for _ in range(4)))
    assert found == value or (found != found and value != value)


def test_no_way_to_the_hosts_clock(engine: Engine) -> None:
    """Whatever leads from a date leads to the same one, and its clock stands still."""
    scopes = tuple(engine.scope() for _ in range(4))
    for code in (
        "Date.prototype.constructor",
        "new Date(0).constructor",
        "Object.getPrototypeOf(new Date(0)).constructor",
        "Object.getPrototypeOf(class extends Date {})",
        "(function () { return this.Date })() || Date",
        "globalThis.Date",
    ):
        assert engine.value(f"({code}) === Date && ({code}).now()", scopes) == NOW
    with pytest.raises(ScriptError, match="Date"):
        engine.value("Date.prototype.getHours.call({})", scopes)
    busy = "(function () { while (new Date() < 1109671200001); })()"
    with pytest.raises(ScriptError, match="longer than"):
        engine.value(busy, scopes)


def test_whole_numbers_keep_their_size(engine: Engine) -> None:
    scope = engine.scope(large=2**40, small=-(2**31) - 1)
    blank = engine.scope()
    assert engine.value("large", (blank, blank, blank, scope)) == 2**40
    assert engine.value("small", (blank, blank, blank, scope)) == -(2**31) - 1


CLOCK = "<form><block>It is <value expr='new Date().toISOString()'/></block></form>"


@pytest.mark.parametrize("attribute", ["", 'date="1999-12-31T23:59:59"', 'date="2010-02-03"'])
def test_run_has_its_own_date(tmp_path: Path, attribute: str) -> None:
    """The date is the scenario's, goes on with the run's time, and comes back in a replay."""
    made = run(tmp_path, CLOCK, attribute)
    begins = attribute[6:-1] or "2005-03-01T10:00:00"
    begins = begins if "T" in begins else begins + "T00:00:00"
    assert said(made)[-1] == f'"It is {begins}.000Z"'
    assert made.records[0]["data"]["date"] == begins
    for _ in range(2):
        assert prima.replay(made, tmp_path / "s.xml").dumps() == made.dumps()


def test_date_goes_on_with_the_run(tmp_path: Path) -> None:
    """What is asked later finds it later, by the simulated time, in both languages."""
    field = "<field name='f' type='boolean'><prompt timeout='60s'>Well?</prompt><noinput>{}</noinput></field>"
    seconds = "<value expr='(new Date() - new Date(2005, 2, 1, 10)) / 1000 &gt; 60'/><exit/>"
    made = run(tmp_path, f"<form>{field.format(seconds)}</form>")
    assert said(made)[-1] == '"true"'
    (tmp_path / "app.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app"><form id="f"><block>'
        '<speak>Ten seconds.</speak><log expr="Date.now() &gt; 1109671200000"/>'
        '<log expr="new Date(Date.now() - 1000 * session.time).toISOString()"/>'
        "<exit/></block></form></prima>",
        encoding="utf-8",
    )
    made = prima.rehearse(scenario(tmp_path, "app.xml"))
    logs = [record["message"] for record in made.records if record["phase"] == "log"]
    assert logs == ["true", "2005-03-01T10:00:00.000Z"]


def test_date_knows_no_time_zone(tmp_path: Path) -> None:
    """The host's time zone changes no byte."""
    body = "<form><block><value expr=\"new Date(2005, 6, 1) + Date.parse('7/1/05 1:00')\"/></block></form>"
    (tmp_path / "app.vxml").write_text(f"{HEAD}{body}</vxml>", encoding="utf-8")
    path = scenario(tmp_path, "app.vxml")
    code = f"import prima; print(prima.rehearse({str(path)!r}).dumps())"
    outs = {
        subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "TZ": zone},
            capture_output=True,
            check=True,
        ).stdout
        for zone in ("UTC", "Asia/Tokyo", "America/New_York")
    }
    assert len(outs) == 1 and b"2005 00:00:00 GMT+0000" in outs.pop()


@pytest.mark.parametrize("date", ["today", "2005-02-30", "2005-03-01T25:00", "2005-3-1", ""])
def test_wrong_date(tmp_path: Path, date: str) -> None:
    with pytest.raises(prima.DocumentError) as caught:
        run(tmp_path, CLOCK, f'date="{date}"')
    [problem] = caught.value.problems
    assert problem.place.line == 1 and problem.code == "bad-value"


# Documents without their namespace ---------------------------------------------------------


def problems(folder: Path, text: str | bytes, name: str = "app.vxml") -> list[prima.Problem]:
    """What is wrong with a document."""
    (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
    return prima.validate([folder / name])


GRAMMAR = '<grammar root="r"{}><rule id="r"><one-of><item>red</item><item>blue</item></one-of></rule></grammar>'
NO_NAMESPACE = (
    '<?xml version="1.0"?>\n<vxml version="2.0">\n<form><field name="f"><prompt>Well?</prompt>'
    '{}<filled>You said <value expr="f"/>.</filled></field></form></vxml>'
)


@pytest.mark.parametrize(
    "grammar",
    [GRAMMAR.format(""), GRAMMAR.format(' xmlns="http://www.w3.org/2001/06/grammar"'),
     '<grammar src="g.grxml"/>', '<grammar src="g.grxml" type="application/grammar-xml"/>'],
)  # fmt: skip
def test_no_namespace(tmp_path: Path, grammar: str) -> None:
    """It runs with one warning, whatever grammars it has; theirs may lack it, too."""
    (tmp_path / "g.grxml").write_text(GRAMMAR.format(' version="1.0" xml:lang="en"'))
    text = NO_NAMESPACE.format(grammar)
    [problem] = problems(tmp_path, text)
    assert str(problem) == (
        f"{tmp_path}/app.vxml:2:1: warning: The root element <vxml> has no namespace: it is read as"
        ' VoiceXML. Write <vxml xmlns="http://www.w3.org/2001/vxml">. [no-namespace]'
    )
    made = prima.rehearse(prima.stage([], [str(tmp_path / "app.vxml")], ["blue"]))
    assert said(made)[-1] == '"You said blue."'


def test_no_namespace_in_a_later_document(tmp_path: Path) -> None:
    (tmp_path / "b.vxml").write_text(
        '<vxml version="2.0"><form><block>There.</block></form></vxml>'
    )
    made = run(tmp_path, '<form><block><goto next="b.vxml"/></block></form>')
    assert said(made) == ['"There."']


@pytest.mark.parametrize(
    ("head", "told"),
    [
        ('<vxml version="3.0">', '1:16: error: version "3.0" is not'),
        ('<vxml version="">', '1:16: error: version "" is not'),
    ],
)
def test_another_version(tmp_path: Path, head: str, told: str) -> None:
    """One error tells it, whatever else that version has that this one has not."""
    text = f"{head}<form><field name='a'><dtmf>1</dtmf></field></form></vxml>"
    [error] = problems(tmp_path, text)
    assert str(error).startswith(f"{tmp_path}/app.vxml:{told}")


@pytest.mark.parametrize("space", ["http://www.w3.org/2001/vxml/", "http://www.w3.org/2000/vxml"])
def test_another_namespace(tmp_path: Path, space: str) -> None:
    [problem] = problems(tmp_path, f'<vxml version="2.0" xmlns="{space}"><form/></vxml>')
    assert problem.code == "wrong-namespace"
    assert problem.remedy == 'Did you mean "http://www.w3.org/2001/vxml"?'


@pytest.mark.parametrize(
    "head",
    [
        '<v:vxml version="2.1" xmlns:v="http://www.w3.org/2001/vxml">',
        f"<!-- {'A long licence. ' * 1000} -->\n<v:vxml version=' 2.1 '"
        ' xmlns:v="http://www.w3.org/2001/vxml">',
        '<?xml version="1.0"?><?x <vxml ?><!DOCTYPE v:vxml SYSTEM "a>b">'
        '<v:vxml version="2.1" xmlns:v="http://www.w3.org/2001/vxml">',
    ],
)
def test_a_prefix_and_a_long_prolog(tmp_path: Path, head: str) -> None:
    made = run(tmp_path, f"{head}<v:form><v:block>Hello.</v:block></v:form></v:vxml>".encode())
    assert said(made) == ['"Hello."']


def test_what_only_mentions_voicexml_is_none(tmp_path: Path) -> None:
    text = (
        '<!-- not <vxml version="2.0"> --><prima xmlns="urn:prima:dialogue:1" version="1.0"'
        ' kind="ea" id="a"><form id="f"><block><exit/></block></form></prima>'
    )
    assert problems(tmp_path, text) == []


# Many problems of one kind, and vendors' words -----------------------------------------------


def test_one_misuse_at_many_places(tmp_path: Path) -> None:
    """The report stays readable: the first places, and how many more there are."""
    misuse = "<prompt voice='mike'>a</prompt>\n" * 30
    text = f"{HEAD}<form><block>\n{misuse}<promt/></block></form></vxml>"
    found = problems(tmp_path, text)
    assert [one.place.line for one in found] == [2, 3, 4, 5, 6, 32]
    assert found[4].remedy.endswith("So it is at 25 more places.")
    assert found[5].code == "unknown-element"


def test_vendors_elements_and_attributes(tmp_path: Path) -> None:
    """Those of another namespace are ignored, elements with a warning."""
    body = (
        '<x:meta a="b"><x:c>not said</x:c></x:meta><property name="vendor.thing" value="1"/>'
        '<form x:id="1"><block x:y="z">One. <x:say>not said</x:say> Two.</block></form>'
    )
    head = HEAD.replace(" xml:lang", ' xmlns:x="http://vendor.example/ns" xml:lang')
    assert said(run(tmp_path, body, head=head)) == ['"One. Two."']
    found = problems(tmp_path, f"{head}{body}</vxml>")
    assert [(one.severity, one.code) for one in found] == [("warning", "wrong-namespace")] * 2


# Encodings -----------------------------------------------------------------------------------

ENCODED = [
    ("iso-8859-1", "Grüß Gott"), ("ISO8859-1", "Grüß Gott"), ("latin1", "Grüß Gott"),
    ("iso-8859-2", "zażółć"), ("windows-1250", "zażółć"), ("cp1252", "It’s 5 €"), ("utf8", "€"),
    ("koi8-r", "привет"), ("windows-1251", "привет"), ("iso-8859-7", "γεια"), ("Shift_JIS", "お茶"),
    ("EUC-JP", "お茶"), ("ISO-2022-JP", "お茶"), ("gb2312", "你好"), ("GBK", "你好"), ("GB18030", "你好"),
    ("Big5", "你好"), ("EUC-KR", "안녕"), ("UTF-16", "你好"), ("utf-16-le", "你好"), ("utf-16-be", "你好"),
]  # fmt: skip


@pytest.mark.parametrize(("encoding", "text"), ENCODED)
def test_encodings(tmp_path: Path, encoding: str, text: str) -> None:
    declared = "UTF-16" if encoding.startswith("utf-16") else encoding
    whole = f'<?xml version="1.0" encoding="{declared}"?>\n{HEAD}<form><block>{text}</block></form></vxml>'
    assert said(run(tmp_path, whole.encode(encoding))) == [f'"{text}"']


BROKEN = [
    (b'<?xml version="1.0" encoding="klingon"?><vxml/>', "1:31", "encoding", "Save it as UTF-8"),
    (b'<?xml version="1.0" encoding="UTF-16"?><vxml/>', "1:31", "encoding", "Declare the encoding"),
    (b'<?xml version="1.0" encoding="zip"?><vxml/>', "1:31", "encoding", "Save it as UTF-8"),
    (b'<vxml version="2.0"><form id="\xfc"/></vxml>', "1:31", "encoding", "declare the encoding"),
    (b'\n<?xml version="1.0" encoding="latin1"?>\n<vxml>\xfc</vxml>', "2:6", "not-xml",
     "very beginning of the file"),
    (b'\xef\xbb\xbf\r\n<?xml version="1.0"?>\n<vxml/>', "2:6", "not-xml", "very beginning"),
    (b'<vxml version="2.0">\n<a b="x?a=1&b=2"/></vxml>', "2:12", "not-xml", "Write &amp; for &."),
    (b'<vxml version="2.0">\n<a>a&nbsp;b</a></vxml>', "2:5", "entity", "Write the character itself"),
    (b'<vxml version="2.0">\n<% x %><a/></vxml>', "2:2", "not-xml", "A server makes the document"),
    (b"<%@ page %>\n<?xml version='1.0'?><vxml/>", "1:2", "not-xml", "A server makes the document"),
    (b"<?php header('a') ?>\nx<vxml/>", "2:1", "not-xml", "A server makes the document"),
    (b'<vxml version="2.0">\n<v:log/></vxml>', "2:1", "not-xml", 'Write the name without "v:"'),
    (b'<vxml version="2.0">\n<!-- a -- b --></vxml>', "2:8", "not-xml", "holds no --"),
    (b'<vxml version="2.0"><if cond="a < b"/></vxml>', "1:33", "not-xml", "Write &lt; for <"),
    (b'<!DOCTYPE vxml [<!ENTITY n "x">]><vxml version="2.0">&n;</vxml>', "1:1", "doctype",
     "Remove the part in square brackets"),
    (b'<!DOCTYPE vxml SYSTEM "x.dtd"><vxml version="2.0">a&nbsp;b</vxml>', "1:52", "entity",
     "Write the character itself"),
    (b"", "1:1", "not-xml", "Begin with a root element"),
    (b"404 Not Found", "1:1", "not-xml", "such as <prima> or <vxml>"),
]  # fmt: skip


@pytest.mark.parametrize(("data", "place", "code", "remedy"), BROKEN)
def test_what_no_parser_takes(
    tmp_path: Path, data: bytes, place: str, code: str, remedy: str
) -> None:
    """One error, where it is, and what to do."""
    [problem] = problems(tmp_path, data)
    assert f"{problem.place.line}:{problem.place.column}" == place
    assert problem.code == code and remedy in problem.remedy


# Scripts of the third edition ------------------------------------------------------------------

SCRIPT = """<![CDATA[
<!-- hidden from what knows no scripts
counter = 0;
for (i = 0; i < 4; i++) counter += i;
for (key in { one: 1 }) found = key;
function Person(name) { this.name = name; }
Person.prototype.greet = function () { return 'Hi ' + this.name; };
function sum() { total = 0; for (var i = 0; i < arguments.length; i++) total += arguments[i]; return total; }
outer: for (var j = 0; j < 3; j++) { while (true) { if (j == 1) break outer; continue outer; } }
with (Math) { var three = floor(PI); }
try { throw new Error('boom'); } catch (error) { var message = error.message; }
hours = 010;
var words = escape('a b') + unescape('%21') + String.fromCharCode(65) + 'hello'.substr(1, 2);
// -->
]]>"""
FOUND = [
    ("counter", "6"), ("found", "one"), ("new Person('Bob').greet()", "Hi Bob"), ("sum(1, 2)", "3"),
    ("(sum(3), total)", "3"), ("j + ' ' + three + ' ' + message", "1 3 boom"), ("hours", "8"),
    ("document.hours", "8"), ("application.counter", "6"), ("words", "a%20b!Ael"),
]  # fmt: skip


@pytest.mark.parametrize(("code", "value"), FOUND)
def test_old_scripts(tmp_path: Path, code: str, value: str) -> None:
    """What they assign without declaring it is a variable of the scope that they stand in."""
    variables = '<var name="hours" expr="1"/>'
    body = f'{variables}<script>{SCRIPT}</script><form><block><value expr="{code}"/></block></form>'
    assert said(run(tmp_path, body)) == [f'"{value}"']
    assert problems(tmp_path, f"{HEAD}{body}</vxml>") == []


def test_what_a_script_assigns_goes_no_further_than_its_scope(tmp_path: Path) -> None:
    """That of a block is not there in the next one; a declared variable stays where it is."""
    body = (
        '<form><var name="kept" expr="1"/><block><script>own = 2; kept = 3;</script>'
        '<value expr="own + kept"/></block><block><value expr="kept"/></block>'
        '<block><value expr="own"/></block></form>'
    )
    made = run(tmp_path, body)
    assert [row.what for row in made.rows() if row.what.startswith('"')] == ['"5"', '"3"']
    assert "own is not defined" in made.failures[0]


# Others --------------------------------------------------------------------------------------


def test_the_telephone_of_old_documents(tmp_path: Path) -> None:
    """It is there, and knows what the connection knows: here nothing."""
    body = '<var name="ani" expr="session.telephone.ani"/><form><block>From <value expr="ani"/></block></form>'
    assert said(run(tmp_path, body)) == ['"From undefined"']


def test_a_document_without_dialogs_tells_where(tmp_path: Path) -> None:
    made = run(tmp_path, '\n<var name="a"/>', head=f"\n{HEAD}")
    [failure] = made.failures
    told = "error.badfetch: app.vxml:2:1: the document has no dialog: add a <form> or <menu>"
    assert failure == f"app: {told}"


@pytest.mark.parametrize("uri", ["http://[x", "http://[x#y", "http://[x]:a/b?c=d#e", "//\u2100/x"])
@pytest.mark.parametrize(
    "body",
    [
        '<form><block><goto next="{}"/></block></form>',
        "<form><block><submit expr=\"'{}'\"/></block></form>",
        '<form><subdialog src="{}"/></form>',
        '<form><block><data name="d" src="{}"/></block></form>',
        '<form><block><script src="{}"/></block></form>',
        '<form xml:base="{0}"><block><audio src="{0}"/><goto next="x.vxml"/></block></form>',
        '<form><field name="f"><grammar src="{}"/></field></form>',
    ],
)
def test_a_uri_that_is_none(tmp_path: Path, body: str, uri: str) -> None:
    """It cannot be fetched, whoever names it."""
    transcript = run(tmp_path, body.format(uri))
    [failure] = transcript.failures
    assert "app: error." in failure and "app.vxml:1" in failure


def test_an_external_grammar_without_a_language_has_the_documents() -> None:
    grammar = (
        '<grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">'
        '<rule id="r">tea</rule></grammar>'
    )
    field = '<form><field name="a"><prompt>What?</prompt><grammar src="g.grxml"/></field></form>'
    call = Call(field, **{"g.grxml": grammar})
    call.answer("tea")
    assert call.ended == "exit"


def test_attributes_that_exclude_each_other_are_one_error_wherever_they_are_told(
    tmp_path: Path,
) -> None:
    application = tmp_path / "app.vxml"
    body = '<form id="a"><block><goto next="#a" expr="1"/><audio/></block></form>'
    application.write_text(f"{HEAD}{body}</vxml>", encoding="utf-8")
    path = scenario(tmp_path, "app.vxml")
    told = [("error", "exclusive"), ("error", "missing-attribute")]
    for files in ([application], [path], [application, path]):
        assert [(one.severity, one.code) for one in validate(files)] == told


# What other platforms run, too ------------------------------------------------------------

OLD = """<?xml version="1.0"?>
<vxml version="1.0" lang="en-GB" base="sub/">
 <var name="n" expr="session.telephone.ani"/>
 <catch event="telephone.disconnect error.telephone.noauthorization"><log expr="_event"/></catch>
 <form>
  <block><prompt>It is <emp level="strong">very</emp> <pros rate="-20%" vol="loud">nice</pros>.
   <break msecs="500"/><div type="sentence">Doctor <sayas sub="no">know</sayas></div>
   <sayas class="digits">12</sayas> <sayas phon="x">tomato</sayas></prompt></block>
  <subdialog name="s" src="part.vxml" modal="true" caching="fast"/>
  <field name="f"><prompt>Well?</prompt>
   <dtmf type="application/srgs">#ABNF 1.0;
   language en; mode dtmf; root $r; $r = 1 | 2;</dtmf>
   <option>tea</option><filled><log expr="f"/><throw event="telephone.disconnect.hangup"/>
   </filled></field></form>
</vxml>"""


def test_a_document_of_voicexml_1_is_read_as_2(tmp_path: Path) -> None:
    (tmp_path / "app.vxml").write_text(OLD)
    (tmp_path / "sub").mkdir()
    part = vxml("<form><block><return/></block></form>")
    (tmp_path / "sub" / "part.vxml").write_text(part)
    [told] = validate([tmp_path / "app.vxml"])
    assert str(told).removeprefix(f"{tmp_path}/") == (
        "app.vxml:2:16: warning: The document is of VoiceXML 1.0: it is read as 2.0, its older"
        " elements as newer. Rewrite it in 2.0 or 2.1. [bad-value]"
    )
    call = Call(
        (tmp_path / "app.vxml").read_text(),
        **{"sub/part": part},
    )
    call.answer("2")
    assert call.said()[0] == "It is very nice. Doctor no 12 tomato"
    assert call.logs() == ["2", "connection.disconnect.hangup"]
    assert call.session.documents["app"].lang == "en-GB"


def test_a_grammar_of_voicexml_1_without_a_type_is_not_supported(tmp_path: Path) -> None:
    text = """<vxml version="1.0"><catch event="error"><log expr="_event"/><exit/></catch><form>
        <field name="f"><prompt>Well?</prompt><grammar>yes | no</grammar></field></form></vxml>"""
    assert Call(text).logs() == ["error.unsupported.format"]
    (problem,) = [one for one in problems(tmp_path, text) if one.code == "format"]
    told = "A grammar without a type is in JSGF in VoiceXML 1.0; JSGF is not supported."
    assert problem.message == told


@pytest.mark.parametrize("kind", ["application/x-jsgf", "application/x-gsl", "text/gsl"])
def test_grammars_of_other_forms_stay_unsupported(kind: str) -> None:
    call = Call(
        f"""<catch event="error"><log expr="_event"/><exit/></catch><form><field name="f">
        <prompt>Well?</prompt><grammar type="{kind}">yes | no</grammar></field></form>"""
    )
    assert call.logs() == ["error.unsupported.format"]


def test_a_document_without_a_version_is_read_as_2_1(tmp_path: Path) -> None:
    text = '<vxml xmlns="http://www.w3.org/2001/vxml"><form><block>Hi.</block></form></vxml>'
    [told] = problems(tmp_path, text)
    assert (told.severity, told.code) == ("warning", "missing-attribute")
    assert Call(text).play() == ["Hi."]


EXPRESSIONS = {
    "x = 1; x + 1": "2",
    "x = 1; x = x * 7;": "7",
    "var y = 3; if (y) x = y + 1;": "4",
    "for (var i = 0, s = 0; i != 3; i++) s += i; s": "3",
    "": "undefined",
    " ": "undefined",
}


@pytest.mark.parametrize("expr", EXPRESSIONS)
def test_several_statements_give_the_value_of_the_last(tmp_path: Path, expr: str) -> None:
    body = (
        f'<form><var name="x" expr="9"/><var name="v" expr="{expr}"/><block><assign name="x"'
        f' expr="9"/><log expr="{expr}"/><log><value expr="v"/></log><assign name="v"'
        f' expr="{expr}"/><log expr="String(v)"/><exit expr="{expr}"/></block></form>'
    )
    call = Call(body)
    value = EXPRESSIONS[expr]
    assert call.logs()[:3] == [value] * 3
    assert call.logs()[3:] == ([] if value == "undefined" else [f"exit: {value}"])
    told = problems(tmp_path, HEAD + body + "</vxml>")
    assert {(one.severity, one.code) for one in told} == {("warning", "bad-expression")}
    said = "empty" if not expr.strip() else "several statements"
    assert all(said in one.message for one in told)


def test_an_error_in_several_statements_is_told_at_its_place() -> None:
    call = Call(
        """<form><catch event="error.semantic"><log expr="_message"/></catch>
<var name="x" expr="1; nothing.at.all"/></form>"""
    )
    place, _, message = call.logs()[0].partition(": ")
    assert place == "app.vxml:2:24"
    assert message == "1; nothing.at.all: ReferenceError: nothing is not defined"


def test_what_is_no_script_either_stays_an_error() -> None:
    call = Call(
        """<form><catch event="error.semantic"><log>semantic</log></catch>
        <block><log expr="1 +; 2"/></block><block><if cond="1; 2"/></block></form>"""
    )
    assert call.logs() == ["semantic", "semantic"]


def test_methods_may_stand_in_capitals(tmp_path: Path) -> None:
    web = {"http://x.example/a": vxml("<form><block><log>there</log></block></form>")}
    body = """<form><block><submit next="http://x.example/a" method="GET"/></block></form>"""
    call = Online(web, body)
    sends = [one["data"] for one in call.phases("send")]
    assert (call.logs(), sends[0]["method"]) == (["there"], "get")
    [told] = problems(tmp_path, HEAD + body + "</vxml>")
    assert (told.severity, told.remedy) == ("warning", 'Write "get".')
    [wrong] = problems(tmp_path, HEAD + body.replace("GET", "PUT") + "</vxml>")
    assert (wrong.severity, wrong.code) == ("error", "bad-value")


def test_a_grammar_in_a_file_may_have_a_scope() -> None:
    call = Call(
        """<form><field name="f"><prompt>Well?</prompt><grammar src="g.grxml"/>
        <filled><log expr="f"/></filled></field></form>""",
        **{
            "g.grxml": '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"'
            ' xml:lang="en" root="r" scope="document"><rule id="r">tea</rule></grammar>'
        },
    )
    call.answer("tea")
    assert call.logs() == ["tea"]


def test_a_scope_in_a_grammar_s_file_is_warned_of(tmp_path: Path) -> None:
    path = tmp_path / "g.grxml"
    path.write_text(
        '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en"'
        ' root="r" scope="document"><rule id="r">tea</rule></grammar>'
    )
    [told] = validate([path])
    assert str(told) == (
        f"{path}:1:96: warning: scope says nothing in a grammar's file. Write it where VoiceXML"
        " names the file. [unknown-attribute]"
    )
