"""Small VoiceXML documents, what a user says to them, and what must come of it."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from prima.errors import DocumentError, Problem
from prima.voicexml.reading import read_page
from tests.helpers.voice import Call, vxml

SILENT = ""
"""Instead of an utterance: the user says nothing."""

OOPS = "I did not understand."
"""What the platform says of what no grammar takes, where no handler does (5.2.5)."""

CITIES = "<option>Kyoto</option><option>Nara</option>"

TRIP = """<grammar version="1.0" root="trip" xmlns="http://www.w3.org/2001/06/grammar"
    tag-format="semantics/1.0">
  <rule id="trip"><one-of>
    <item>from <ruleref uri="#city"/><tag>out.start = rules.latest();</tag></item>
    <item>to <ruleref uri="#city"/><tag>out.end = rules.latest();</tag></item>
    <item>from <ruleref uri="#city"/><tag>out.start = rules.latest();</tag>
      to <ruleref uri="#city"/><tag>out.end = rules.latest();</tag></item>
    </one-of></rule>
  <rule id="city"><one-of><item>Kyoto</item><item>Nara</item><item>Osaka</item></one-of></rule>
</grammar>"""

HOME = """<grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">
  <rule id="r">go home</rule></grammar>"""

LEAF = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="root.vxml">'

PAGE = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">'

MIXED = f"""<form>{TRIP}<initial name="init"><prompt>Your trip?</prompt>
  <nomatch count="2">Step by step.<assign name="init" expr="true"/><reprompt/></nomatch></initial>
  <field name="start"><prompt>From?</prompt>{CITIES}<filled><log>s:<value expr="start"/></log>
    </filled></field>
  <field name="end"><prompt>To?</prompt>{CITIES}<filled><log>e:<value expr="end"/></log></filled>
  </field>
  <block><log><value expr="start"/>-<value expr="end"/>-<value expr="init"/></log></block></form>"""

ENDS = """<form id="a"><block><log>a</log></block></form>
<form id="b"><block><log>b</log></block></form>"""


def thrown(handlers: str, event: str = "a.b.c", attributes: str = "") -> str:
    """A form whose block throws an event."""
    return f'<form>{handlers}<block><throw event="{event}" {attributes}/></block></form>'


P = 'xmlns:p="urn:prima:dialogue:1"'

GRAMMAR = 'version="1.0" xmlns="http://www.w3.org/2001/06/grammar"'


def leaf(body: str, root: str = "root.vxml", version: str = "2.1") -> str:
    """A document of the application whose root is ``root``."""
    return (
        f'<vxml version="{version}" xmlns="http://www.w3.org/2001/vxml" xml:lang="en"'
        f' application="{root}">{body}</vxml>'
    )


def block(content: str) -> str:
    return f"<form><block>{content}</block></form>"


def rule(words: str, more: str = "") -> str:
    """A grammar of a few words."""
    items = "".join(f"<item>{word}</item>" for word in words.split("|"))
    return (
        f'<grammar {GRAMMAR} root="r" {more}><rule id="r"><one-of>{items}</one-of></rule></grammar>'
    )


def file(words: str, more: str = "") -> str:
    """A grammar as a file."""
    return rule(words, f'xml:lang="en" {more}')


def ask(content: str, name: str = "f", more: str = "") -> str:
    """A form with one field that logs what it was filled with."""
    return (
        f'<form><field name="{name}" {more}><prompt>Well?</prompt>{content}'
        f'<filled><log expr="{name}"/><exit/></filled></field></form>'
    )


def problems(text: str) -> list[str]:
    """What is wrong with a document: line, column and code of each problem."""
    try:
        page = read_page("d.vxml", "d.vxml", text.encode())
        found = page.problems
    except DocumentError as error:
        found = error.problems
    return [f"{p.place.line}:{p.place.column} {p.code}" for p in sorted(found)]


def codes(text: str) -> list[str]:
    return [one.partition(" ")[2] for one in problems(text if "<vxml" in text else vxml(text))]


def asked(content: str, *said: str, more: str = "", head: str = "") -> list[str]:
    """What a field logs when it is answered."""
    call = Call(head + ask(content, more=more))
    call.answer(*said)
    return call.logs()


def question(call: Call) -> dict[str, object]:
    """The arguments of the question that is being asked."""
    found = call.session.mediator.question()
    assert found is not None and found.command is not None
    return found.command.args


def said(content: str, **files: str) -> list[str]:
    """What a block says."""
    return Call(f"<form><block>{content}</block></form>", **files).play()


PASS = "<log>pass</log><exit/>"

FAIL = "<log>fail</log><exit/>"

YES = "<option>yes</option>"

VXML = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"'


def page(body: str) -> str:
    """A further document."""
    return f"{VXML}>{body}</vxml>"


def grammar(words: str, tag: str = "", attributes: str = "") -> str:
    """A grammar of one phrase, and what it means."""
    meaning = f"<tag>{tag}</tag>" if tag else ""
    return f"""<grammar version="1.0" root="r" xml:lang="en" tag-format="semantics/1.0" {attributes}
    xmlns="http://www.w3.org/2001/06/grammar"><rule id="r">{words}{meaning}</rule></grammar>"""


def holds(cond: str) -> str:
    """Pass if a condition holds, else fail."""
    return f'<if cond="{cond}">{PASS}<else/>{FAIL}</if>'


def run(text: str, *says: str, **files: str) -> Call:
    """Run a document to its end, or to a question that nobody answers."""
    call = Call(text, **files)
    for one in says:
        if one == SILENT:
            call.silent()
        else:
            call.answer(one)
    call.play()
    return call


GO = grammar("go")


def check_page(body: str) -> list[Problem]:
    return read_page("a.vxml", "a.vxml", vxml(body).encode()).problems


def logged(error: str, content: str) -> str:
    """A form whose content causes an error that a handler logs."""
    return f"""<form><catch event="{error}"><log expr="_event"/><exit/></catch>{content}</form>"""


@dataclass(frozen=True)
class Case:
    """A document, what the user says to its questions, and what must come of it."""

    text: str
    says: tuple[str, ...]
    logs: list[str] | None
    said: list[str] | None
    ended: str | None
    files: dict[str, str]

    def holds(self) -> None:
        """Run it, and compare."""
        call = run(self.text, *self.says, **self.files)
        if self.logs is not None:
            assert call.logs() == self.logs
        if self.said is not None:
            assert call.said() == self.said
        if self.ended is not None:
            assert call.ended.partition(":")[0] == self.ended


class Cases:
    """Cases of a chapter, each named after the section of its rule."""

    def __init__(self) -> None:
        self.made: list[object] = []

    def __call__(
        self,
        rule: str,
        section: str,
        text: str,
        *says: str,
        logs: list[str] | None = None,
        said: list[str] | None = None,
        ended: str | None = None,
        files: dict[str, str] | None = None,
    ) -> None:
        """Add a case."""
        one = Case(text, says, logs, said, ended, files or {})
        self.made.append(pytest.param(one, id=f"{section} {rule}".replace(" ", "_")))
