"""Requests of VoiceXML applications to services and hosts (2.0, 5.3.8 and 6.1; 2.1, 5)."""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from urllib.parse import unquote_plus

import pytest

from prima import api
from prima.errors import UsageError
from prima.loading.web import form_request
from prima.markup.tree import Node
from tests import ROOT
from tests.helpers.voice import Call, Online, vxml

SHOP = "http://shop.example/order"
REFUSED = '<catch event="error.badfetch"><log><value expr="_event"/></log><exit/></catch>'


def block(content: str) -> str:
    return f"<form><block>{content}</block></form>"


def test_a_submit_goes_on_in_the_document_that_a_host_answers_with() -> None:
    call = Online(
        {SHOP: vxml(block('Thank you.<goto next="#end"/>') + '<form id="end"><block>Bye.</block></form>')},
        f"""<form><var name="size" expr="'large'"/><block>One moment.
        <submit next="{SHOP}" namelist="size" method="post"/></block></form>""",
    )  # fmt: skip
    call.play()
    assert call.said() == ["One moment.", "Thank you.", "Bye."]
    sent = call.phases("send")[0]["data"]
    assert sent == {"to": SHOP, "method": "post", "params": {"size": "large"}}
    assert call.ended == "exit"


def test_a_number_that_json_lacks_is_submitted_as_its_text() -> None:  # 5.3.8
    names = '<var name="x" expr="NaN"/><var name="y" expr="1/0"/>'
    call = Online({}, REFUSED + names + block(f'<submit next="{SHOP}" namelist="x y"/>'))
    assert call.phases("send")[0]["data"]["params"] == {"x": "NaN", "y": "Infinity"}


@pytest.mark.parametrize("element", ["submit next", "data src"])
def test_null_is_submitted_as_its_text(element: str) -> None:  # 5.3.8
    names = '<var name="x" expr="null"/><var name="y"/><var name="z" expr="{a: null}"/>'
    sends = f'<{element}="{SHOP}" namelist="x y z.a"/>'
    call = Online({}, REFUSED + names + block(sends))
    sent = call.phases("send")[0]["data"]
    assert sent["params"] == {"x": "null", "y": None, "z.a": "null"}
    asked = form_request(SHOP, "get", sent["params"]).full_url
    assert asked == f"{SHOP}?x=null&y=undefined&z.a=null"


def test_a_subdialog_is_requested_by_its_method_even_without_values() -> None:  # 2.3.4
    called = vxml(block("<return/>"))
    twice = f'<subdialog src="{SHOP}" method="post"/>' * 2
    call = Online({SHOP: called}, f"<form>{twice}</form>")
    sent = [record["data"] for record in call.phases("send")]
    assert sent == [{"to": SHOP, "method": "post", "params": {}}] * 2
    assert call.ended == "exit"


def test_null_goes_along_with_a_subdialog_as_its_text() -> None:  # 2.3.4
    sends = f'<subdialog src="{SHOP}" namelist="x"/>'
    call = Online({}, REFUSED + f'<var name="x" expr="null"/><form>{sends}</form>')
    assert call.phases("send")[0]["data"]["params"] == {"x": "null"}


def test_each_submit_is_sent_and_answered_anew() -> None:
    again = '<submit next="service:count"/>'
    call = Online({"service:count": vxml(block("More."))}, block(again))
    call.play()
    assert len(call.phases("send")) == 1
    call = Online(
        {"service:count": vxml('<form><field name="x"><prompt>More?</prompt><option>yes</option>'
                               f"<filled>{again}</filled></field></form>")},
        block(again),
    )  # fmt: skip
    call.answer("yes", "yes")
    assert len(call.phases("send")) == 3


def test_documents_that_were_left_are_not_kept_for_their_handlers() -> None:
    again = '<submit next="service:count"/>'
    form = f"""<form><field name="x"><prompt>More?</prompt><option>yes</option>
        <filled><throw event="again"/></filled></field><catch event="again">{again}</catch></form>"""
    call = Online({"service:count": vxml(form)}, block(again))
    call.answer(*["yes"] * 20)
    assert len(call.phases("send")) == 21
    call.session.drain_visits()
    gc.collect()
    forms = [one for one in gc.get_objects() if isinstance(one, Node) and one.tag == "form"]
    there = [one for one in forms if one.source.text == vxml(form)]
    assert 0 < len(there) <= 2, "that of now, and one that has just been left"


def asks(word: str, then: str = "") -> str:
    """A document that asks for one word, by a grammar of its own."""
    grammar = f"""<grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">
        <rule id="r">{word}</rule></grammar>"""
    return vxml(f"""<form><field name="x"><prompt>{word}?</prompt>{grammar}
        <filled>Got <value expr="x"/>. {then}</filled></field></form>""")


@pytest.mark.parametrize("method", ["get", "post"])
def test_another_document_of_the_same_uri_listens_with_its_own_grammars(method: str) -> None:
    again = f'<submit next="{SHOP}" method="{method}"/>'
    call = Online({SHOP: asks("tea", again)}, block(again))
    call.play()
    call.web = {SHOP: asks("milk")}
    call.answer("tea", "milk")
    assert call.said() == ["tea?", "Got tea.", "milk?", "Got milk."]


def test_two_subdialogs_of_the_same_uri_listen_with_their_own_grammars() -> None:
    call = Online(
        {SHOP: asks("tea", "<return/>")},
        f"""<form><var name="a" expr="1"/><subdialog name="s" src="{SHOP}" namelist="a"/>
        <subdialog name="t" src="{SHOP}" namelist="a"/></form>""",
    )
    call.play()
    call.web = {SHOP: asks("milk", "<return/>")}
    call.answer("tea", "milk")
    assert call.said() == ["tea?", "Got tea.", "milk?", "Got milk."]


ROOT_PAGE = """<var name="n" expr="1"/><catch event="tell">Root {0}, n <value expr="n"/>.
    <exit/></catch><form><block>In root {0}. <assign name="n" expr="n + 1"/>
    <goto next="http://h.example/leaf"/></block></form>
    <form id="last"><block>Back in root {0}, n <value expr="n"/>.<exit/></block></form>"""
LEAF = """<form><block>In leaf, n <value expr="n"/>. <assign name="application.n" expr="n + 1"/>
    {}</block></form>"""
LEAF_HEAD = (
    '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="http://h.example/root">'
)


@pytest.mark.parametrize(
    ("then", "said"),
    [
        ("<throw event='tell'/>", ["In root A.", "In leaf, n 2.", "Root A, n 3."]),
        ("<goto next='root#last'/>", ["In root A.", "In leaf, n 2.", "Back in root A, n 3."]),
        ("<goto next='second'/>", ["In root A.", "In leaf, n 2.", "In leaf, n 3.", "Back in root A, n 4."]),
    ],
)  # fmt: skip
def test_a_root_that_a_submit_has_brought_stays_that_of_its_leaves(
    then: str, said: list[str]
) -> None:  # 1.5.2
    web = {
        "http://h.example/root": vxml(ROOT_PAGE.format("A")),
        "http://h.example/leaf": vxml(LEAF.format(then), LEAF_HEAD),
        "http://h.example/second": vxml(LEAF.format("<goto next='root#last'/>"), LEAF_HEAD),
    }
    call = Online(web, block('<submit next="http://h.example/root"/>'))
    call.web = {**web, "http://h.example/root": vxml(ROOT_PAGE.format("B"))}
    call.play()
    assert call.said() == said
    assert [one["data"]["to"] for one in call.phases("send")].count("http://h.example/root") == 1


def test_data_of_a_host_is_a_document() -> None:
    call = Online(
        {"http://x.example/w?q": '<w><sky c="1">blue</sky></w>'},
        block(
            '<data name="w" src="http://x.example/w?q"/>'
            "<value expr=\"w.documentElement.getElementsByTagName('sky').item(0).textContent\"/>"
        ),
    )
    call.play()
    assert call.said() == ["blue"]


def test_a_subdialog_of_a_service_gives_its_values_back() -> None:
    inner = vxml('<form><var name="n" expr="41"/><block><return namelist="n"/></block></form>')
    call = Online(
        {"service:ask": inner},
        """<form><var name="a" expr="1"/><subdialog name="s" src="service:ask" namelist="a">
        <filled><value expr="s.n + a"/></filled></subdialog></form>""",
    )
    call.play()
    assert call.said() == ["42"]
    assert call.phases("send")[0]["data"]["params"] == {"a": 1}


def test_relative_names_in_a_hosts_document_are_the_hosts() -> None:
    call = Online(
        {"http://h.example/a/one.vxml": vxml(block('<goto next="two.vxml"/>')),
         "http://h.example/a/two.vxml": vxml(block("Two."))},
        block('<goto next="http://h.example/a/one.vxml"/>'),
    )  # fmt: skip
    call.play()
    assert call.said() == ["Two."]


def test_scripts_grammars_and_roots_of_a_host() -> None:
    grammar = (
        '<grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar" xml:lang="en">'
        '<rule id="r"><ruleref uri="http://h.example/h.grxml"/></rule></grammar>'
    )
    inner = grammar.replace('<ruleref uri="http://h.example/h.grxml"/>', "tea")
    root = vxml('<var name="name" expr="\'Root\'"/>')
    head = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="http://h.example/root.vxml">'
    call = Online(
        {"http://h.example/g.grxml": grammar, "http://h.example/h.grxml": inner,
         "http://h.example/root.vxml": root, "http://h.example/s.js": "var extra = 'and script'"},
        vxml('<script src="http://h.example/s.js"/><form><block>'
             '<value expr="application.name"/> <value expr="extra"/>.</block>'
             '<field name="x"><prompt>What?</prompt><grammar src="http://h.example/g.grxml"/>'
             '<filled>Got <value expr="x"/>.</filled></field></form>', head),
    )  # fmt: skip
    call.answer("tea")
    assert call.said() == ["Root and script.", "What?", "Got tea."]


@pytest.mark.parametrize(("status", "event"), [(404, "error.badfetch.http.404"), (0, "error.badfetch")])  # fmt: skip
def test_a_fetch_that_fails_is_an_event(status: int, event: str) -> None:
    call = Online({SHOP: status}, REFUSED + block(f'<submit next="{SHOP}"/>'))
    assert call.logs() == [event]


def test_an_answer_that_is_no_document_is_badfetch() -> None:
    call = Online({SHOP: "<html/>"}, REFUSED + block(f'<submit next="{SHOP}"/>'))
    assert call.logs() == ["error.badfetch"]


def test_no_answer_in_time_is_badfetch_and_a_late_one_is_not_heeded() -> None:
    from prima.messages import Fetched

    call = Online(
        {SHOP: None},
        '<catch event="error.badfetch"><log>late</log><goto next="#on"/></catch>'
        f'<form><block><submit next="{SHOP}" fetchtimeout="3s"/></block></form>'
        '<form id="on"><field name="x"><prompt>On?</prompt><option>a</option></field></form>',
    )
    assert call.session.deadline() == call.now + 3000
    call.step(at=call.now + 2999)
    assert call.logs() == []
    call.step(at=call.now + 1)
    assert call.logs() == ["late"]
    call.step(Fetched("app", 1, SHOP, vxml(block("Too late."))))
    call.play()
    assert call.said() == ["On?"]


def test_events_while_an_answer_is_awaited_come_at_the_next_wait() -> None:
    from prima.messages import Fetched

    call = Online(
        {SHOP: None},
        '<catch event="touch"><log>touched</log></catch>' + block(f'<submit next="{SHOP}"/>'),
    )
    call.event("touch.head")
    assert call.logs() == []
    page = (
        '<form><catch event="touch"><log>touched later</log></catch>'
        '<field name="x"><prompt>Well?</prompt><option>a</option></field></form>'
    )
    call.step(Fetched("app", 1, SHOP, vxml(page)))
    assert call.logs() == ["touched later"]


def test_queued_prompts_are_played_to_their_end_with_fetch_audio() -> None:
    from prima.messages import Fetched

    call = Online(
        {SHOP: None},
        block(f'One moment.<submit next="{SHOP}" fetchaudio="music/hold.wav"/>'),
    )
    assert call.saying() == ["One moment."]
    call.finish()
    assert call.saying() == ["[hold.wav]"]
    call.step(Fetched("app", 1, SHOP, vxml(block("Done."))))
    call.play()
    assert call.said() == ["One moment.", "[hold.wav]", "Done."]
    assert call.ended == "exit"


def test_an_answer_during_queued_prompts_waits_for_their_end() -> None:
    from prima.messages import Fetched

    call = Online(
        {SHOP: None}, block(f'One moment.<submit next="{SHOP}" fetchaudio="music/hold.wav"/>')
    )
    call.step(Fetched("app", 1, SHOP, vxml(block("Done."))))
    assert call.saying() == ["One moment."]
    call.play()
    assert call.said() == ["One moment.", "Done."]


@pytest.mark.parametrize(
    ("fetched", "heard"),
    [
        (f'<block><data src="{SHOP}"/></block>', ["One moment."]),
        (f'<block><script src="{SHOP}"/></block>', []),
        (f'<field name="f"><prompt>Well?</prompt><grammar src="{SHOP}"/></field>', []),
    ],
)
def test_scripts_and_grammars_are_fetched_without_fetch_audio(
    fetched: str, heard: list[str]
) -> None:  # 6.3.5
    sets = '<property name="fetchaudio" value="hold.wav"/>'
    call = Online({SHOP: None}, f"{sets}<form><block>One moment.</block>{fetched}</form>")
    assert call.said() == heard


def test_prompts_stay_queued_while_fetching_without_fetch_audio() -> None:
    call = Online({SHOP: None}, block(f'One moment.<submit next="{SHOP}"/>'))
    assert call.said() == []


def test_a_document_is_set_up_without_the_properties_of_the_dialog_before() -> None:  # 6.3
    sets = '<property name="fetchaudio" value="hold.wav"/>'
    leads = f'<form>{sets}<block>One moment.<goto next="other.vxml"/></block></form>'
    other = f'{{}}<data name="d" src="{SHOP}"/>' + block("Done.")
    assert Online({SHOP: None}, leads, other=vxml(other.format(""))).said() == []
    assert Online({SHOP: None}, leads, other=vxml(other.format(sets))).said() == ["One moment."]


# In a scenario -------------------------------------------------------------------------------

SCENARIO = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="world.xml"
  robot="robot.xml"><robot at="middle"/><person x="1" y="0"/>
  <application src="app.vxml"/>{services}</scenario>"""


def run(place: Path, app: str, services: str, hosts: list[str] | None = None) -> list[str]:
    (place / "app.vxml").write_text(vxml(app))
    (place / "s.xml").write_text(SCENARIO.format(services=services))
    made = api.rehearse(place / "s.xml", hosts=hosts or [])
    again = api.replay(made, place / "s.xml")
    assert [record["phase"] for record in again.records] == [r["phase"] for r in made.records]
    return [row["text"] for row in made.records if row["phase"] == "start" and row.get("text")]


def test_a_scenarios_service_answers_with_a_file(place: Path) -> None:
    (place / "thanks.vxml").write_text(vxml(block("Thank you.")))
    app = REFUSED + block('<submit next="http://shop.example/order/new?x=1"/>')
    service = '<service name="shop" uri="{}"><reply after="2s" src="thanks.vxml"/></service>'
    assert run(place, app, service.format("http://shop.example/order")) == ["Thank you."]
    assert run(place, app, service.format("http://shop.example/ord")) == []


def test_a_services_data_are_xml(place: Path) -> None:
    app = block(
        '<data name="w" src="service:weather"/><value expr="w.documentElement.textContent"/>'
    )
    service = '<service name="weather"><reply><data name="sky" value="bl&lt;ue"/></reply></service>'
    assert run(place, app, service) == ["bl<ue"]


def test_a_services_failure_has_its_status(place: Path) -> None:
    app = (
        '<catch event="error.badfetch.http.503">Closed.<exit/></catch>'
        + block('<submit next="service:shop"/>')
    )  # fmt: skip
    service = '<service name="shop"><failure after="1s" status="503"/></service>'
    assert run(place, app, service) == ["Closed."]


def test_a_services_file_that_is_not_there_is_told_at_its_place(place: Path) -> None:
    from prima.errors import DocumentError

    with pytest.raises(DocumentError) as caught:
        run(place, block("Hi."), '<service name="shop"><reply src="none.vxml"/></service>')
    assert "s.xml:3:" in str(caught.value)
    assert "none.vxml" in str(caught.value)


# On a real host ------------------------------------------------------------------------------


class Host(BaseHTTPRequestHandler):
    """Answers as a test wants."""

    def do_GET(self) -> None:
        moved = {"/away": "http://other.example/", "/moved": "/deep/page"}
        if where := moved.get(self.path.partition("?")[0]):
            self.send_response(302)
            self.send_header("Location", where)
            self.end_headers()
            return
        if self.path == "/deep/page":
            self._give(vxml(block('<goto next="beside"/>')))
            return
        if self.path.startswith("/none"):
            self.send_error(404)
            return
        self._give(vxml(block(f"You asked {self.path.replace('&', '&amp;')}.")))

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"])).decode()
        if self.path == "/moved":
            self.do_GET()
            return
        self._give(vxml(block(f"You sent {body.replace('&', '&amp;')}.")))

    def _give(self, text: str) -> None:
        self.send_response(200)
        self.end_headers()
        self.wfile.write(text.encode())

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


@pytest.fixture(scope="module")
def host() -> Iterator[str]:
    """A host on this machine, as HOST:PORT."""
    server = HTTPServer(("127.0.0.1", 0), Host)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"127.0.0.1:{server.server_port}"
    server.shutdown()


def submit(host: str, path: str, method: str = "get") -> str:
    return (
        '<catch event="error.badfetch"><value expr="_event"/>: <value expr="_message"/><exit/></catch>'
        f"""<form><var name="a" expr="'x y'"/><var name="b" expr="2"/><block>
        <submit next="http://{host}{path}" namelist="a b" method="{method}"/></block></form>"""
    )


def test_a_host_that_the_run_allows_is_asked(place: Path, host: str) -> None:
    assert run(place, submit(host, "/o"), "", [host]) == ["You asked /o?a=x+y&b=2."]
    assert run(place, submit(host, "/o?c=1"), "", ["127.0.0.1"]) == ["You asked /o?c=1&a=x+y&b=2."]
    assert run(place, submit(host, "/o", "post"), "", [host]) == ["You sent a=x+y&b=2."]


def test_a_host_is_told_values_in_the_words_of_ecmascript(place: Path, host: str) -> None:
    text = f"""<form><var name="a" expr="0.1 + 0.2"/><var name="b" expr="true"/>
        <var name="c" expr="{{d: [1, 'e']}}"/><block>
        <submit next="http://{host}/o" namelist="a b c"/></block></form>"""
    (said,) = run(place, text, "", [host])
    told = unquote_plus(said.partition("?")[2])
    assert told == 'a=0.30000000000000004&b=true&c={"d":[1,"e"]}.'


def test_no_host_is_asked_that_the_run_does_not_allow(place: Path, host: str) -> None:
    (said,) = run(place, submit(host, "/o"), "")
    assert f'add "--allow-host {host}"' in said
    (said,) = run(place, submit(host, "/o"), "", ["example.org"])
    assert f'add "--allow-host {host}"' in said


def test_a_redirection_leads_to_no_other_host(place: Path, host: str) -> None:
    (said,) = run(place, submit(host, "/away"), "", [host])
    assert 'add "--allow-host other.example"' in said


@pytest.mark.parametrize("method", ["get", "post"])
def test_relative_names_in_a_document_that_has_moved_are_of_its_new_place(
    place: Path, host: str, method: str
) -> None:  # RFC 3986, 5.1.3
    assert run(place, submit(host, "/moved", method), "", [host]) == ["You asked /deep/beside."]


def test_a_hosts_refusal_has_its_status(place: Path, host: str) -> None:
    (said,) = run(place, submit(host, "/none"), "", [host])
    assert said.startswith("error.badfetch.http.404: ")


def test_a_host_that_is_not_there_is_badfetch(place: Path) -> None:
    (said,) = run(place, submit("127.0.0.1:9", "/none"), "", ["127.0.0.1"])
    assert said.startswith("error.badfetch: ")


@pytest.mark.parametrize("host", ["http://example.org", "", "a/b", "a:b", "*"])
def test_a_host_is_named_alone(place: Path, host: str) -> None:
    with pytest.raises(UsageError):
        run(place, block("Hi."), "", [host])


def test_without_a_network_modules_of_it_are_not_loaded() -> None:
    import subprocess
    import sys

    code = (
        "import sys; from prima.api import rehearse, stage\n"
        "rehearse(stage([], ['documents/ea/pizza.vxml'], ['x']))\n"
        "assert 'urllib.request' not in sys.modules and 'prima.loading.web' not in sys.modules"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_a_call_without_hosts_gets_badfetch() -> None:
    call = Call(REFUSED + block(f'<submit next="{SHOP}"/>'))
    assert call.logs() == ["error.badfetch"]
