"""The reader of documents: its cache, and that it compiles all code."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from prima.errors import DocumentError
from prima.interpreter import reader
from prima.interpreter.reader import read_document
from prima.markup.limits import LIMITS

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="app">'
FORM = '<form id="{0}"><var name="unused" expr="nobody"/><block><exit/></block></form>'


def application(body: str) -> bytes:
    """An application's bytes; equal ones are other objects each time."""
    return f"{HEAD}{body}</prima>".encode()


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    """Let each test begin with nothing read."""
    reader._kept.clear()
    yield
    reader._kept.clear()


def test_the_same_bytes_give_the_same_document() -> None:
    first, problems = read_document("a.xml", application(FORM.format("f")))
    again, told = read_document("a.xml", application(FORM.format("f")))
    assert again is first
    assert told == problems != []


def test_problems_are_given_anew_each_time() -> None:
    _, problems = read_document("a.xml", application(FORM.format("f")))
    expected = list(problems)
    problems.clear()
    assert read_document("a.xml", application(FORM.format("f")))[1] == expected


def test_another_name_has_other_places() -> None:
    for name in ("a.xml", "b.xml", "a.xml"):
        document, problems = read_document(name, application(FORM.format("f")))
        assert document.file == name
        assert {one.place.file for one in problems} == {name}


def test_other_bytes_are_read() -> None:
    for name in ("f", "g", "f"):
        assert list(read_document("a.xml", application(FORM.format(name)))[0].forms) == [name]


def test_other_limits_count(monkeypatch: pytest.MonkeyPatch) -> None:
    read_document("a.xml", application(FORM.format("f")))
    monkeypatch.setattr(LIMITS, "elements", 2)
    with pytest.raises(DocumentError, match="more than 2 elements"):
        read_document("a.xml", application(FORM.format("f")))


def test_what_is_kept_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    for number in range(reader.MOST_KEPT + 20):
        read_document(f"{number}.xml", application(FORM.format("f")))
    assert len(reader._kept) == reader.MOST_KEPT
    assert list(reader._kept)[-1] == f"{number}.xml"
    monkeypatch.setattr(reader, "MOST_KEPT_BYTES", 1_000)
    read_document("more.xml", application(FORM.format("f")))
    assert 0 < sum(len(one.data) for one in reader._kept.values()) <= 1_000
    read_document("large.xml", application(FORM.format("f") + " " * 1_000))
    assert "large.xml" not in reader._kept


def test_what_was_used_last_stays_longest() -> None:
    for number in range(reader.MOST_KEPT):
        read_document(f"{number}.xml", application(FORM.format("f")))
    first, _ = read_document("0.xml", application(FORM.format("f")))
    read_document("one more.xml", application(FORM.format("f")))
    assert "1.xml" not in reader._kept
    assert reader._kept["0.xml"].document is first


CODE = [
    '<var name="v" expr="nobody"/>',
    '<assign name="n" expr="nobody"/>',
    '<if cond="nobody"/>',
    '<if cond="n"><elseif cond="nobody"/></if>',
    '<if cond="n"><log expr="nobody"/></if>',
    '<foreach item="one" array="nobody"/>',
    '<foreach item="one" array="n"><log expr="nobody"/></foreach>',
    '<log expr="nobody"/>',
    '<log>It is <value expr="nobody"/>.</log>',
    '<throw event-expr="nobody"/>',
    '<throw event="noinput" message-expr="nobody"/>',
    '<goto next-expr="nobody"/>',
    '<goto nextitem-expr="nobody"/>',
    '<send to-expr="nobody"/>',
    '<send event="tick" delay-expr="nobody"/>',
    '<send to="clock"><param name="p" expr="nobody"/></send>',
    '<speak>It is <value expr="nobody"/>.</speak>',
    '<move-head pan-expr="nobody"/>',
    '<command type="wave"><param name="p" expr="nobody"/></command>',
    '<speak>Hello.<on event="tick" cond="nobody"><exit/></on></speak>',
    '<speak>Hello.<on event="tick"><log expr="nobody"/></on></speak>',
    "<par><seq><speak>One.</speak></seq>"
    '<iu><speak><value expr="nobody"/></speak></iu></par>',
    "<script>nobody();</script>",
    '<assign name="nobody" expr="1"/>',
    '<assign name="document.nobody" expr="1"/>',
    '<clear namelist="nobody"/>',
    '<return namelist="nobody"/>',
]  # fmt: skip
"""Executable content with code in each place where there may be some."""


def question(inside: str, mark: str = "") -> str:
    """A form that asks."""
    silence = "<noinput><exit/></noinput>"
    field = f'<field name="a" type="boolean"{mark}><prompt>Well?</prompt>{inside}{silence}</field>'
    return f'<form id="f">{field}</form>'


BODIES = [
    *(f'<form id="f"><block>{one}</block></form>' for one in CODE),
    *(f'<form id="f"><on event="tick">{one}</on></form>' for one in CODE[1:]),
    *(f'<on event="tick">{one}</on><form id="f"/>' for one in CODE[1:]),
    *(question(f"<filled>{one}</filled>") for one in CODE[1:]),
    *(f'<form id="f"><iu><block>{one}</block></iu></form>' for one in CODE[1:4]),
    '<var name="v" expr="nobody"/><form id="f"/>',
    "<script>nobody();</script><form id='f'/>",
    '<watch name="w" when="nobody"/><form id="f"/>',
    '<on event="tick" cond="nobody"><exit/></on><form id="f"/>',
    '<form id="f"><var name="v" expr="nobody"/></form>',
    '<form id="f"><var name="v" expr="(nobody = 1)"/></form>',
    '<form id="f"><script>nobody();</script></form>',
    '<form id="f"><watch name="w" when="nobody"/></form>',
    '<form id="f"><on event="tick" cond="nobody"><exit/></on></form>',
    '<form id="f"><block cond="nobody"/></form>',
    '<form id="f"><block name="b" expr="nobody"/></form>',
    question("", " cond='nobody'"),
    question("<help cond='nobody'><exit/></help>"),
    question("<prompt cond='nobody'>Well?</prompt>"),
    question("<prompt><value expr='nobody'/></prompt>"),
    '<form id="f"><subdialog name="s" src="#g"><param name="p" expr="nobody"/></subdialog></form>'
    '<form id="g"><block><return/></block></form>',
]


@pytest.mark.parametrize("body", BODIES)
def test_all_code_is_looked_at(body: str) -> None:
    _, problems = read_document("a.xml", application('<var name="n" expr="0"/>' + body))
    assert "undeclared-variable" in {one.code for one in problems}


@pytest.mark.parametrize(
    "inside",
    ['<noinput count="2"/>', "<noinput><goto/></noinput>", "<noinput><send/></noinput>"],
)
def test_an_element_that_is_not_understood_is_told_once(inside: str) -> None:
    body = f'<form id="f"><block><speak>{inside}Hello.</speak><exit/></block></form>'
    _, problems = read_document("a.xml", application(f"<strange/>{body}"))
    assert [one.code for one in problems].count("unknown-element") == 1


def test_a_goto_by_an_expression_leads_to_every_form() -> None:
    forms = "".join(
        f'<form id="f{n}"><block><goto next-expr="\'#f\' + {n}"/></block></form>' for n in range(9)
    )
    assert read_document("a.xml", application(forms))[1] == []
