"""Documents without namespaces, of other versions, in old encodings, with vendors' words."""

from __future__ import annotations

from pathlib import Path

import pytest

import prima
from prima.errors import DocumentError
from prima.loading import read_application, validate
from tests.helpers.old_documents import HEAD, problems, run, said, scenario
from tests.helpers.voice import Call, vxml

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


@pytest.mark.parametrize(
    ("name", "root"),
    [
        ("a.xml", 'VXML xmlns="http://www.w3.org/2001/vxml"'),
        ("a.xml", 'vmxl xmlns="http://www.w3.org/2001/vxml"'),
        ("a.vxml", "html"),
    ],
)
def test_how_voicexml_begins_is_told_where_it_is_meant(
    tmp_path: Path, name: str, root: str
) -> None:
    (tmp_path / name).write_text(f"<{root}/>")
    [problem] = validate([tmp_path / name])
    with pytest.raises(DocumentError) as error:
        read_application(name, f"<{root}/>".encode())
    for one in (problem, *error.value.problems):
        assert one.remedy == 'Begin with <vxml xmlns="http://www.w3.org/2001/vxml">.'


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


def test_a_document_without_dialogs_tells_where(tmp_path: Path) -> None:
    made = run(tmp_path, '\n<var name="a"/>', head=f"\n{HEAD}")
    [failure] = made.failures
    told = "error.badfetch: app.vxml:2:1: the document has no dialog: add a <form> or <menu>"
    assert failure == f"app: {told}"


def test_a_further_document_without_dialogs_is_told_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "root.vxml").write_text(f'{HEAD}<var name="a"/></vxml>', encoding="utf-8")
    made = run(tmp_path, '<form><block><goto next="root.vxml"/></block></form>')
    [failure] = made.failures
    assert failure.endswith(": there is no dialog in root.vxml")


def test_attributes_that_exclude_each_other_are_one_error_wherever_they_are_told(
    tmp_path: Path,
) -> None:
    application = tmp_path / "app.vxml"
    body = '<form id="a"><block><goto next="#a" expr="1"/></block><block><audio/></block></form>'
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
  <block><prompt>It is <emp level="strong">very</emp> <pros rate="-20%" vol="loud">nice</pros>,
   <pros rate="180">quick</pros> <sayas>so</sayas>.
   <break msecs="500"/><div type="sentence">Doctor <sayas sub="no">know</sayas></div>
   <sayas class="digits">12</sayas> <sayas phon="x">tomato</sayas></prompt></block>
  <subdialog name="s" src="part.vxml" modal="true" caching="fast" fetchhint="stream"/>
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
    question = call.orders[0].command
    assert question is not None and [one.value for one in question.cues if one.kind == "rate"] == [
        0.8,
        1.0,
    ]
    call.answer("2")
    assert call.said()[0] == "It is very nice, quick so. Doctor no 12 tomato"
    assert call.logs() == ["2", "connection.disconnect.hangup"]
    assert call.session._apps.documents["app"].lang == "en-GB"


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
