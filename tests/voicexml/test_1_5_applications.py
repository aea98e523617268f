"""Documents, applications and their roots: VoiceXML 2.0, 1.5."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import loading
from prima.markup.uris import join
from tests.helpers.dialogs import (
    CITIES,
    LEAF,
    PAGE,
    TRIP,
    Case,
    Cases,
    ask,
    block,
    holds,
    leaf,
    page,
    question,
    rule,
    run,
)
from tests.helpers.robot import Bench
from tests.helpers.voice import HEAD, Call, vxml

case = Cases()

case(
    "the first dialog of a document is run",
    "1.5.1",
    "<form id='z'><block><log>z</log></block></form><form id='a'><block><log>a</log></block></form>",
    logs=["z"],
    ended="exit",
)
case(
    "a form of the root listens in its leaves and is entered with the root's variables kept",
    "1.5.2",
    f"""{LEAF}<form><block><assign name="n" expr="5"/></block><field name="f">{CITIES}</field></form>
    </vxml>""",
    "from Osaka",
    logs=["Osaka5"],
    files={
        "root": f"{PAGE}<var name='n' expr='1'/><form id='t' scope='document'>{TRIP}"
        "<field name='start'><filled><log expr='start + document.n'/></filled></field></form></vxml>"
    },
)
case(
    "the root's variables last from leaf to leaf",
    "1.5.2",
    f"""{LEAF}<form><block><assign name="application.x" expr="2"/><goto next="other.vxml"/></block>
    </form></vxml>""",
    logs=["2"],
    files={
        "root": f"{PAGE}<var name='x' expr='1'/></vxml>",
        "other": f"{LEAF}<form><block><log expr='x'/></block></form></vxml>",
    },
)
case(
    "the root's variables last from root to leaf",
    "1.5.2",
    """<var name="x" expr="1"/><form><block><assign name="x" expr="2"/><goto next="other.vxml"/>
    </block></form>""",
    logs=["2"],
    files={
        "other": f"{LEAF.replace('root', 'app')}<form><block><log expr='application.x'/></block>"
        "</form></vxml>"
    },
)
case(
    "another root begins another application",
    "1.5.2",
    f"""{LEAF}<form><block><assign name="x" expr="2"/><goto next="other.vxml"/></block></form>
    </vxml>""",
    logs=["undefined"],
    files={
        "root": f"{PAGE}<var name='x' expr='1'/></vxml>",
        "base": f"{PAGE}<var name='y' expr='1'/></vxml>",
        "other": f"{LEAF.replace('root', 'base')}<form><block><log expr='typeof x'/></block></form>"
        "</vxml>",
    },
)
case(
    "a root that is not there is error.badfetch",
    "1.5.2",
    """<catch event="error.badfetch"><log>bad</log><exit/></catch>
    <form><block><goto next="leaf.vxml"/></block></form>""",
    logs=["bad"],
    files={"leaf": f"{LEAF}<form/></vxml>"},
)
case(
    "an error in a root's variables is the leaf's to handle",
    "1.5.2",
    f"""{LEAF}<catch event="error.semantic"><log>leaf</log><goto next="#t"/></catch><form/>
    <form id="t"><block><log>t</log></block></form></vxml>""",
    logs=["leaf", "t"],
    files={
        "root": f"{PAGE}<var name='x' expr='zz'/><catch event='error'><log>root</log></catch></vxml>"
    },
)
case(
    "a dialog of the root may be gone to from a leaf",
    "1.5.2",
    f"""{LEAF}<form><block><assign name="x" expr="2"/><goto next="root.vxml#t"/></block></form>
    </vxml>""",
    logs=["2"],
    files={
        "root": f"{PAGE}<var name='x' expr='1'/><form/><form id='t'><block><log expr='x'/></block>"
        "</form></vxml>"
    },
)
case(
    "after a disconnect the application comes to its end where it would wait",
    "1.5.4",
    f"""<form><catch event="connection.disconnect.hangup"><log>hangup</log></catch>
    <block><disconnect/></block><block><log>on</log></block>
    <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    logs=["hangup", "on"],
    said=[],
    ended="connection.disconnect.hangup",
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_version_2_0_document_runs() -> None:  # 1.5
    text = '<vxml version="2.0" xmlns="http://www.w3.org/2001/vxml"><form><block>Hi.</block></form></vxml>'
    assert Call(text).play() == ["Hi."]


def test_an_application_ends_where_no_dialog_follows() -> None:  # 1.5.1
    assert Call(block("<log>one</log>")).ended == "exit"


GO_B = '<goto next="b.vxml"/>'


def test_relative_uris_are_relative_to_the_document_that_holds_them() -> None:  # 1.5.1
    call = Call(
        block('<goto next="sub/a.vxml"/>'),
        **{
            "sub/a.vxml": vxml(block('<goto next="b.vxml"/>')),
            "sub/b.vxml": vxml(block("<log>sub b</log>")),
        },
    )
    assert call.logs() == ["sub b"]


def test_xml_base_is_what_uris_are_relative_to() -> None:  # 1.5.1
    call = Call(
        f'{HEAD[:-1]} xml:base="sub/">{block("<goto next=" + chr(34) + "b.vxml" + chr(34) + "/>")}</vxml>',
        **{"sub/b.vxml": vxml(block("<log>sub b</log>"))},
    )
    assert call.logs() == ["sub b"]


@pytest.mark.parametrize(("base", "where"), [("..", "s/b.vxml"), (".", "s/t/b.vxml")])
def test_dots_at_the_end_of_a_base_mean_a_folder(base: str, where: str) -> None:  # 1.5.1
    inner = f'{HEAD[:-1]} xml:base="{base}">{block(GO_B)}</vxml>'
    files = {"s/t/a.vxml": inner, where: vxml(block("<log>found</log>"))}
    assert Call(block('<goto next="s/t/a.vxml"/>'), **files).logs() == ["found"]


@pytest.mark.parametrize(
    ("base", "uri", "whole"),
    [
        ("a.vxml", "b.vxml", "b.vxml"),
        ("s/a.vxml", "b.vxml#x", "s/b.vxml#x"),
        ("s/a.vxml", "../b.vxml", "b.vxml"),
        ("s/a.vxml", "../../b.vxml", "../b.vxml"),
        ("s/a.vxml", "#x", "s/a.vxml#x"),
        ("s/a.vxml", "b.vxml?a=1/2", "s/b.vxml?a=1/2"),
        ("s/t/a.vxml", "..", "s/"),  # a folder, also without its slash (RFC 3986, 5.2.4)
        ("s/a.vxml", ".", "s/"),
        ("s/a.vxml", "t/..?q#f", "s/?q#f"),
        ("a.vxml", "http://x.y/z", "http://x.y/z"),
        ("http://x.y/s/a", "b", "http://x.y/s/b"),
    ],
)
def test_uris_are_joined(base: str, uri: str, whole: str) -> None:  # 1.5.1
    assert join(base, uri) == whole


@pytest.mark.parametrize(
    "leading",
    [
        '<block><submit next="#b"/></block>',
        '<block><goto next="#b"/></block>',
        '<subdialog src="#b" namelist="n"/>',
    ],
)
def test_a_fragment_alone_is_of_the_document_whatever_its_base(leading: str) -> None:  # 5.3.8
    body = f"""<form><var name="n" expr="1"/>{leading}</form>
        <form id="b"><block><log>here</log><exit/></block></form>"""
    assert run(f'{HEAD[:-1]} xml:base="sub/">{body}</vxml>').logs() == ["here"]


def test_xml_base_of_the_network_is_refused() -> None:  # 1.5.1
    head = f'{HEAD[:-1]} xml:base="http://example.org/">'
    call = Call(
        vxml('<catch event="error.badfetch"><log>refused</log><exit/></catch>'
             + block('<goto next="b.vxml"/>'), head),
        b=vxml(block("<log>there</log>")),
    )  # fmt: skip
    assert call.logs() == ["refused"]


def test_the_roots_variables_are_the_leafs_application_scope() -> None:  # 1.5.2
    call = Call(
        leaf(block('<log expr="a"/><log expr="application.a"/>')),
        root=vxml("<var name='a' expr='7'/>"),
    )
    assert call.logs() == ["7", "7"]


def test_the_roots_scripts_run_before_the_leafs_variables() -> None:  # 1.5.2
    call = Call(
        leaf('<var name="b" expr="twice(4)"/>' + block('<log expr="b"/>')),
        root=vxml("<script>function twice(x) { return 2 * x; }</script>"),
    )
    assert call.logs() == ["8"]


def test_the_roots_handlers_catch_in_the_leaf() -> None:  # 1.5.2
    call = Call(
        leaf(block('<throw event="odd"/>')),
        root=vxml('<catch event="odd"><log>root</log><exit/></catch>'),
    )
    assert call.logs() == ["root"]


def test_the_roots_links_listen_in_the_leaf() -> None:  # 1.5.2
    call = Call(
        leaf(ask("<option>yes</option>")),
        root=vxml(f'<link event="odd">{rule("operator")}</link>'
                  '<catch event="odd"><log>link</log><exit/></catch>'),
    )  # fmt: skip
    call.answer("operator")
    assert call.logs() == ["link"]


def test_the_roots_properties_hold_in_the_leaf() -> None:  # 1.5.2, 6.3
    call = Call(
        leaf(ask("<option>yes</option>")),
        root=vxml('<property name="timeout" value="9s"/>'),
    )
    call.play()
    assert question(call)["timeout"] == 9000


def test_variables_of_the_root_outlive_a_transition_between_leaves() -> None:  # 1.5.2
    call = Call(
        leaf(block('<assign name="a" expr="2"/><goto next="other.vxml"/>')),
        root=vxml("<var name='a' expr='1'/>"),
        other=leaf(block('<log expr="a"/>')),
    )
    assert call.logs() == ["2"]


def test_variables_of_a_leaf_do_not_outlive_it() -> None:  # 1.5.2
    call = Call(
        leaf('<var name="b" expr="1"/>' + block('<goto next="other.vxml"/>')),
        root=vxml(""),
        other=leaf(block('<log expr="typeof b"/>')),
    )
    assert call.logs() == ["undefined"]


@pytest.mark.parametrize("name", ["lastresult$", "application.lastresult$"])
def test_the_last_result_is_a_variable_before_anything_is_heard(name: str) -> None:  # 5.1.5
    text = f"""<form><block><log expr="{name} === undefined"/></block><field name="f">{CITIES}
        <noinput><log expr="{name} === undefined"/><assign name="{name}" expr="1"/>
        <log expr="{name}"/><exit/></noinput></field></form>"""
    assert run(text, "").logs() == ["true", "true", "1"]
    assert run(leaf(text), "", root=page("")).logs() == ["true", "true", "1"]


def test_a_leaf_may_go_to_its_root_without_losing_its_variables() -> None:  # 1.5.2
    call = Call(
        leaf(block('<assign name="a" expr="2"/><goto next="root.vxml"/>')),
        root=vxml("<var name='a' expr='1'/>" + block('<log expr="a"/><log expr="document.a"/>')),
    )
    assert call.logs() == ["2", "2"]


def test_a_root_may_go_to_its_leaf_without_losing_its_variables() -> None:  # 1.5.2
    call = Call(
        vxml(
            "<var name='a' expr='1'/>" + block('<assign name="a" expr="3"/><goto next="l.vxml"/>')
        ),
        l=leaf(block('<log expr="application.a"/>'), root="app.vxml"),
    )
    assert call.logs() == ["3"]


def test_another_application_has_an_application_scope_of_its_own() -> None:  # 1.5.2
    call = Call(
        leaf(block('<assign name="a" expr="2"/><goto next="other.vxml"/>')),
        root=vxml("<var name='a' expr='1'/>"),
        second=vxml("<var name='c' expr='5'/>"),
        other=leaf(block('<log expr="typeof a"/><log expr="application.c"/>'), root="second.vxml"),
    )
    assert call.logs() == ["undefined", "5"]


def test_a_document_without_root_is_its_own_application() -> None:  # 1.5.2
    call = Call("<var name='a' expr='1'/>" + block('<log expr="application.a"/>'))
    assert call.logs() == ["1"]


def test_a_root_that_is_not_there_is_error_badfetch() -> None:  # 1.5.2
    call = Call(leaf(block("x")))
    assert call.ended.startswith("error.badfetch")


def test_a_root_that_names_a_root_is_error_semantic() -> None:  # 1.5.2
    call = Call(leaf(block("x")), root=leaf("", root="second.vxml"), second=vxml(""))
    assert call.ended.startswith("error.semantic")


def test_a_root_that_goes_to_itself_by_its_uri_begins_anew() -> None:  # 1.5.2, 5.3.7
    text = f"""<var name="n" expr="0"/><form><block><assign name="n" expr="n + 1"/>
        <goto next="app.vxml#b"/></block></form><form id="b"><block>{holds("n == 0")}</block></form>"""
    assert run(text, app=page(text)).logs() == ["pass"]


def test_a_submit_to_the_own_root_starts_it_anew() -> None:  # 1.5.2
    root = vxml('<var name="n" expr="1"/><form><block><log expr="n"/></block></form>')
    head = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="root.vxml">'
    for leave, seen in (("submit", "1"), ("goto", "8")):
        body = f'<form><block><assign name="n" expr="8"/><{leave} next="root.vxml"/></block></form>'
        assert Call(vxml(body, head), root=root).logs() == [seen]


def test_a_hangup_from_outside_ends_the_application() -> None:
    """1.5.4: what nothing takes ends it."""
    call = Call(f"<form><field name='f'>{CITIES}</field></form>")
    call.event("connection.disconnect.hangup")
    assert call.ended == "connection.disconnect.hangup"


def test_a_hangup_from_outside_is_handled_without_waiting_again() -> None:
    """1.5.4: the final processing state."""
    call = Call(
        f"""<form><catch event="connection.disconnect"><log>bye</log>Bye!</catch>
        <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>"""
    )
    call.play()
    call.event("connection.disconnect.hangup")
    call.play()
    assert (call.logs(), call.said()) == (["bye"], ["Well?"])
    assert call.ended == "connection.disconnect.hangup"


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.vxml",
        "/etc/passwd",
        "ftp://x/y",
        "file:///x",
        "file:///in.vxml",
        "//host/in.vxml",
    ],
)
def test_nothing_is_fetched_from_outside_the_folder(tmp_path: Path, uri: str) -> None:
    folder = tmp_path / "app"
    folder.mkdir()
    for path in (folder.parent / "secret.vxml", folder / "in.vxml"):
        path.write_text(vxml(block("<log>secret</log>")))
    text = vxml(
        '<catch event="error.badfetch"><log>refused</log><exit/></catch>'
        + block(f'<goto next="{uri}"/>')
    )
    (folder / "a.vxml").write_text(text)
    found, _ = loading.read_application(str(folder / "a.vxml"), text.encode())
    assert Bench(found).logs() == ["refused"]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("uri", "told"),
    [
        ("/inside.vxml", []),
        ("/sub/../inside.vxml", []),
        ("/insid.vxml", ["inside.vxml"]),
        ("/../out.vxml", ["out.vxml"]),
    ],
)
def test_a_path_from_the_root_counts_from_the_folder(
    tmp_path: Path, uri: str, told: list[str]
) -> None:
    """Runs and validation agree."""
    folder = tmp_path / "app"
    (folder / "sub").mkdir(parents=True)
    for path in (folder / "inside.vxml", tmp_path / "out.vxml"):
        path.write_text(vxml(block("<log>in</log>")))
    there = vxml(
        '<catch event="error.badfetch"><log>refused</log><exit/></catch>'
        + block(f'<goto next="{uri}"/>')
    )
    (folder / "sub" / "there.vxml").write_text(there)
    path = folder / "a.vxml"
    path.write_text(vxml(block('<goto next="sub/there.vxml"/>')))
    found, _ = loading.read_application(str(path), path.read_bytes())
    assert Bench(found).logs() == (["refused"] if told else ["in"])  # type: ignore[arg-type]
    problems = [one.message + one.remedy for one in loading.validate(path)]
    assert len(problems) == len(told)
    assert all(word in problem for word, problem in zip(told, problems, strict=True)), problems


def test_a_link_of_the_file_system_leads_nowhere_outside(tmp_path: Path) -> None:
    folder = tmp_path / "app"
    folder.mkdir()
    (tmp_path / "secret.vxml").write_text(vxml(block("<log>secret</log>")))
    (folder / "in.vxml").symlink_to(tmp_path / "secret.vxml")
    text = vxml(block('<goto next="in.vxml"/>'))
    found, _ = loading.read_application(str(folder / "a.vxml"), text.encode())
    assert Bench(found).logs() == []  # type: ignore[arg-type]


def test_a_root_or_subdialog_that_is_no_valid_document_is_badfetch_where_it_is_fetched() -> None:
    wrong = vxml('<form><block><goto next="#a" expr="1"/></block></form>')
    head = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="wrong.vxml">'
    refused = '<catch event="error.badfetch"><log expr="_message"/><exit/></catch>'
    told = (
        'wrong.vxml:1:106: error: <goto> has both "next" and "expr". Keep one of them. [exclusive]'
    )
    for leading in ('<block><goto next="leaf.vxml"/></block>', '<subdialog src="wrong.vxml"/>'):
        call = Call(
            f"{refused}<form>{leading}</form>",
            wrong=wrong,
            leaf=vxml("<form><block><log>leaf</log></block></form>", head),
        )
        assert [one.partition(" ")[2] for one in call.logs()] == [told]
    own = Call(vxml(f"{refused}<form><block><log>runs</log></block></form>", head), wrong=wrong)
    assert [one.partition(" ")[2] for one in own.logs()] == [told]


def test_a_leaf_sees_its_root() -> None:
    call = Call(
        """<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="root.vxml">
        <form><block><log><value expr="application.greeting"/></log>
          <assign name="greeting" expr="'bye'"/><goto next="other.vxml"/></block></form></vxml>""",
        root="""<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">
        <var name="greeting" expr="'hi'"/><catch event="odd"><log>caught</log></catch></vxml>""",
        other="""<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="root.vxml">
        <form><block><log><value expr="greeting"/></log><throw event="odd.thing"/></block></form>
        </vxml>""",
    )
    assert call.logs() == ["hi", "bye", "caught"]
