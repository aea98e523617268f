"""Replies of hosts can name no file; a silent or endless host harms only its own application."""

from __future__ import annotations

import gzip
import re
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import ClassVar
from urllib.parse import urlsplit

import pytest

from prima import api
from prima.loading import web
from prima.voicexml.document import VoiceDocument
from tests.helpers.voice import HEAD, Online, vxml

GRAMMAR = """<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en"
 root="r"><rule id="r" scope="public">{}</rule></grammar>"""
SECRETS = {
    "secret.xml": "<all>the secret</all>",
    "secret.vxml": vxml(
        '<var name="d" expr="\'the secret\'"/><form><block><log>secret</log></block></form>'
    ),
    "secret.js": "var d = 'the secret';",
    "secret.grxml": GRAMMAR.format("secret"),
    "secret.wav": "RIFF$\0\0\0WAVEfmt ",
}
TELL = '<submit next="/take" namelist="d" method="post"/>'
BAD = '<catch event="error"><log expr="_event"/><exit/></catch>'


class Host(BaseHTTPRequestHandler):
    """Answers with the pages of a test, and keeps what it is told."""

    pages: ClassVar[dict[str, str | bytes]] = {}
    told: ClassVar[list[str]] = []
    asked: ClassVar[list[str]] = []

    def do_GET(self) -> None:
        path = urlsplit(self.path).path
        self.asked.append(self.path)
        getattr(self, f"be{path.replace('/', '_')}", self._give)()

    def do_POST(self) -> None:
        self.told.append(self.rfile.read(int(self.headers["Content-Length"])).decode())
        path = urlsplit(self.path).path
        if path.startswith("/to/"):
            self._move("/form", int(path.removeprefix("/to/")))
            return
        self._send(vxml("<form><block><exit/></block></form>"))

    def _give(self) -> None:
        page = self.pages.get(self.path)
        if page is None:
            self.send_error(404)
        else:
            self._send(page)

    def _send(self, page: str | bytes, **headers: str) -> None:
        data = page.encode() if isinstance(page, str) else page
        self.send_response(200)
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(data)

    def _move(self, where: str, status: int = 302) -> None:
        self.send_response(status)
        self.send_header("Location", where)
        self.end_headers()

    def be_noise(self) -> None:
        self.wfile.write(b"220 ready\r\n\r\n")
        self.close_connection = True

    def be_file(self) -> None:
        self._move("file:///secret.xml")

    def be_round(self) -> None:
        self._move("/round")

    def be_silent(self) -> None:
        time.sleep(20)

    def be_drip(self) -> None:
        self._drip(b"HTTP/1.0 200 OK\r\n\r\n", b" ")

    def be_headers(self) -> None:
        self._drip(b"HTTP/1.0 200 OK\r\nX: ", b"a")

    def be_moved(self) -> None:
        self._drip(b"HTTP/1.0 302 Found\r\nLocation: /one\r\n\r\n", b"a" * 100_000)

    def _drip(self, head: bytes, drop: bytes) -> None:
        try:
            self.wfile.write(head)
            for _ in range(200):
                self.wfile.write(drop)
                self.wfile.flush()
                time.sleep(0.1)
        except OSError:
            pass

    def be_spoken(self) -> None:
        page = self.pages["/spoken"]
        self._send(page, Content_Type="application/voicexml+xml; charset=ISO-8859-1")

    def be_large(self) -> None:
        try:
            self._send(b" " * 40_000_000)
        except OSError:
            pass

    def be_bomb(self) -> None:
        self._send(gzip.compress(b" " * 40_000_000), Content_Encoding="gzip")

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


@pytest.fixture
def host() -> Iterator[str]:
    """A host on this machine, as HOST:PORT."""
    Host.pages, Host.told, Host.asked = {}, [], []
    server = ThreadingHTTPServer(("127.0.0.1", 0), Host)
    server.daemon_threads, server.block_on_close = True, False
    threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True).start()
    yield f"127.0.0.1:{server.server_port}"
    server.shutdown()


def played(
    tmp_path: Path, host: str, *first: str, says: tuple[str, ...] = (), maps: tuple[str, ...] = ()
) -> api.Transcript:
    """Run documents beside the secrets; the first is an EA, others are FAs."""
    for name, text in SECRETS.items():
        (tmp_path / name).write_text(text)
    files = []
    for number, body in enumerate(first):
        path = tmp_path / f"app{number}.vxml"
        path.write_text(body if body.startswith("<vxml") else vxml(body))
        files.append(str(path))
    staged = api.stage(files[1:], files[:1], says, maps=[one.format(path=tmp_path) for one in maps])
    return api.rehearse(staged, hosts=[host])


def logs(made: api.Transcript, app: str = "app0") -> list[str]:
    return [one["message"] for one in made.records if one["phase"] == "log" and one["app"] == app]


def block(content: str) -> str:
    return f"{BAD}<form><block>{content}</block></form>"


def asks(grammar: str) -> str:
    return f'{BAD}<form><field name="d"><prompt>What?</prompt>{grammar}<filled>{TELL}</filled></field></form>'


FILE = "file:///secret"
NAMES_FILES = {
    "data": block(f'<data name="d" src="{FILE}.xml"/>{TELL}'),
    "one slash": block(f'<data name="d" src="file:secret.xml"/>{TELL}'),
    "host": block(f'<data name="d" src="file://localhost/secret.xml"/>{TELL}'),
    "capitals": block(f'<data name="d" src="FILE:///secret.xml"/>{TELL}'),
    "srcexpr": block(f"<data name=\"d\" srcexpr=\"'{FILE}.xml'\"/>{TELL}"),
    "goto": block(f'<goto next="{FILE}.vxml"/>'),
    "goto the first": block('<goto next="file:///app0.vxml"/>'),
    "submit": block(f'<submit next="{FILE}.vxml"/>'),
    "subdialog": f'{BAD}<form><subdialog name="d" src="{FILE}.vxml"/></form>',
    "script": block(f'<script src="{FILE}.js"/>{TELL}'),
    "grammar": asks(f'<grammar src="{FILE}.grxml"/>'),
    "rule": asks(GRAMMAR.format(f'<ruleref uri="{FILE}.grxml"/>')),
    "rule of a grammar": asks('<grammar src="/refers.grxml"/>'),
    "root": vxml(f"<form><block>{TELL}</block></form>", HEAD.replace(
        "<vxml ", f'<vxml application="{FILE}.vxml" ')),
    "base": vxml(block(f'<data name="d" src="secret.xml"/>{TELL}'), HEAD.replace(
        "<vxml ", '<vxml xml:base="file:///" ')),
    "base of a service": vxml(block(f'<data name="d" src="secret.xml"/>{TELL}'), HEAD.replace(
        "<vxml ", '<vxml xml:base="service:x" ')),
    "moved": block(f'<data name="d" src="/file"/>{TELL}'),
    "mapped": block(f'<data name="d" src="https://shop.example/secret.xml"/>{TELL}'),
    "mapped grammar": asks('<grammar src="/mapped.grxml"/>'),
}  # fmt: skip


@pytest.mark.parametrize("maps", [(), ("https://shop.example/={path}",)], ids=["", "mapped"])
@pytest.mark.parametrize("name", NAMES_FILES)
def test_what_a_host_sends_names_no_file(
    name: str, maps: tuple[str, ...], tmp_path: Path, host: str
) -> None:
    page = NAMES_FILES[name].replace('"/take"', f'"http://{host}/take"')
    Host.pages = {
        "/evil": page if page.startswith("<vxml") else vxml(page),
        "/refers.grxml": GRAMMAR.format(f'<ruleref uri="{FILE}.grxml"/>'),
        "/mapped.grxml": GRAMMAR.format('<ruleref uri="https://shop.example/secret.grxml"/>'),
    }
    made = played(
        tmp_path, host, block(f'<goto next="http://{host}/evil"/>'), says=("secret",), maps=maps
    )
    assert made.defects == [] and Host.told == []
    assert logs(made) == ["error.badfetch"] or "error.badfetch" in str(made.failures)


@pytest.mark.parametrize("where", ["root", "grammar"])
def test_what_a_host_sends_names_no_file_where_a_file_names_it(
    where: str, tmp_path: Path, host: str
) -> None:
    Host.pages = {
        "/root": vxml(
            '<catch event="tell"><data name="d" src="secret.xml"/>'
            f'<submit next="http://{host}/take" namelist="d" method="post"/></catch>'
        ),
        "/g.grxml": GRAMMAR.format('<ruleref uri="https://shop.example/secret.grxml"/>'),
    }
    first = {
        "root": vxml(
            '<form><block><throw event="tell"/></block></form>',
            HEAD.replace("<vxml ", f'<vxml application="http://{host}/root" '),
        ),
        "grammar": asks(f'<grammar src="http://{host}/g.grxml"/>').replace(
            "/take", f"http://{host}/take"
        ),
    }[where]
    told = first.replace("_event", "_event + _message")
    made = played(tmp_path, host, told, says=("secret",), maps=("https://shop.example/={path}",))
    assert Host.told == []
    (failed,) = logs(made) or made.failures
    assert "error.badfetch" in failed and "names no file" in failed


def test_a_file_that_a_page_of_a_host_plays_is_not_looked_at() -> None:
    looked: list[str] = []

    def glance(uri: str) -> tuple[bytes, int]:
        looked.append(uri)
        return b"", 0

    page = vxml(block(f'<audio src="{FILE}.wav">Words.</audio>'))
    call = Online({}, asks("<option>on</option>").replace(TELL, '<goto next="http://h.example/"/>'))
    document = call.session._apps.documents["app"]
    assert isinstance(document, VoiceDocument)
    document.glance = glance
    call.web = {"http://h.example/": page}
    call.answer("on")
    assert call.said()[-1] == "Words." and looked == []


def test_files_and_pages_of_a_host_still_lead_to_each_other(tmp_path: Path, host: str) -> None:
    Host.pages = {
        "/a/one": vxml(block('<data name="d" src="two.xml"/><goto next="three"/>')),
        "/a/two.xml": "<all>two</all>",
        "/a/three": vxml(block('<log>three</log><script src="/s.js"/><log expr="x"/>')),
        "/s.js": "var x = 'four';",
    }
    made = played(tmp_path, host, block(f'<goto next="http://{host}/a/one"/>'))
    assert logs(made) == ["three", "four"]


# Time ----------------------------------------------------------------------------------------

SPEAKS = "<form><block>" + "<prompt>On and on.</prompt>" * 20 + "</block></form>"


def fetches(host: str, path: str) -> str:
    return (
        '<catch event="error.badfetch"><log expr="_message"/></catch>'
        + "".join(
            f'<form id="f{n}"><block><assign name="n" expr="n + 1"/>'
            f'<data name="d" src="http://{host}{path}?{n}"/></block>'
            f'<block><goto next="#f{n + 1}"/></block></form>'
            for n in range(5)
        ).replace("<form", '<var name="n" expr="0"/><form', 1)
        + '<form id="f5"><block><log>end</log></block></form>'
    )


@pytest.mark.parametrize("path", ["/silent", "/drip", "/headers", "/moved"])
def test_a_silent_host_costs_its_application_one_deadline(
    path: str, tmp_path: Path, host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web, "REAL_SECONDS", 30.0 if path == "/moved" else 0.4)
    Host.pages = {"/one": "<one/>"}
    began = time.monotonic()
    made = played(tmp_path, host, fetches(host, path), SPEAKS)
    assert time.monotonic() - began < 3
    told = logs(made)
    if path == "/moved":  # what comes along with a redirection is not read
        assert told == ["end"]
        return
    assert len(told) == 6 and told[-1] == "end"
    assert "the host does not answer" in told[0]
    assert all("has kept the application waiting for 0.4 s before" in one for one in told[1:5])
    alone = played(tmp_path, host, "<form><block/></form>", SPEAKS)
    assert spoken(made) == spoken(alone)


def spoken(made: api.Transcript) -> list[tuple[object, object]]:
    """What the other application says, and when."""
    return [
        (one["time"], one.get("text"))
        for one in made.records
        if one["phase"] == "start" and one["app"] == "app1"
    ]


def test_hosts_are_waited_for_together(
    tmp_path: Path, host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web, "REAL_SECONDS", 1.5)
    silent = block(f'<data name="d" src="http://{host}/silent"/>')
    began = time.monotonic()
    made = played(tmp_path, host, silent, silent)
    assert time.monotonic() - began < 2.9
    assert logs(made) == logs(made, "app1") == ["error.badfetch"]
    (failed,) = {one["time"] for one in made.records if one["phase"] == "fetched"}
    assert failed == 10.0  # of simulated time, in which others go on


def test_a_host_that_answered_others_still_answers_them(
    tmp_path: Path, host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web, "REAL_SECONDS", 0.4)
    Host.pages = {"/one": "<one/>"}
    good = block(f'<data name="d" src="http://{host}/one"/><log expr="d.documentElement.tagName"/>')
    made = played(tmp_path, host, block(f'<data name="d" src="http://{host}/silent"/>'), good)
    assert (logs(made), logs(made, "app1")) == (["error.badfetch"], ["one"])


# Budgets -------------------------------------------------------------------------------------


def again(host: str, path: str) -> str:
    """An application that fetches until it may not, and tells why."""
    return (
        '<var name="n" expr="0"/><catch event="error.badfetch"><log expr="n + _message"/><exit/></catch>'
        f'<form id="f"><block><data name="d" src="http://{host}{path}"/><assign name="n" expr="n + 1"/>'
        '<prompt>So.</prompt><goto next="#f"/></block></form>'
    )


def test_each_application_has_its_share_of_what_a_run_fetches(
    tmp_path: Path, host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web, "MOST_FETCHES", 10)
    Host.pages = {"/one": "<one/>"}
    good = again(host, "/one").replace('expr="0"', 'expr="100"').replace(
        "<prompt>So.", '<if cond="n == 103"><log>fine</log><exit/></if><prompt>So.')  # fmt: skip
    made = played(tmp_path, host, again(host, "/one"), good)
    (told,) = logs(made)
    assert told.startswith("5") and told.endswith("share of what a run fetches, 5 fetches")
    assert logs(made, "app1") == ["fine"]
    assert len(Host.asked) == 8


def test_bytes_of_answers_are_shared_as_well(
    tmp_path: Path, host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web, "MOST_BYTES", 4000)
    Host.pages = {"/one": f"<one>{'a' * 989}</one>"}
    made = played(tmp_path, host, again(host, "/one"), SPEAKS)
    (told,) = logs(made)
    assert told.startswith("2") and "a run fetches, 2,000 bytes" in told


def test_so_is_the_time_that_a_run_waits(
    tmp_path: Path, host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web, "MOST_SECONDS", 0.0)
    Host.pages = {"/one": "<one/>"}
    made = played(tmp_path, host, again(host, "/one"), SPEAKS)
    (told,) = logs(made)
    assert told.startswith("1") and "a run fetches, 0 s of waiting" in told


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("/round", "it is moved more than 5 times"),
        ("/file", "file:///secret.xml is not an http or https URI"),
        ("/large", "it is larger than 2 MB"),
        ("/bomb", "the host sends it compressed, as gzip"),
        ("/noise", "it cannot be fetched: the answer is not HTTP"),
    ],
)
def test_an_answer_without_end_is_badfetch(path: str, why: str, tmp_path: Path, host: str) -> None:
    made = played(tmp_path, host, again(host, path))
    (told,) = logs(made)
    assert why in told


@pytest.mark.parametrize(
    ("status", "sent"), [(301, False), (302, False), (303, False), (307, True), (308, True)]
)
def test_a_form_is_sent_on_only_where_its_method_stays(
    status: int, sent: bool, tmp_path: Path, host: str
) -> None:
    Host.pages = {"/form": vxml("<form><block><exit/></block></form>")}
    submit = f'<submit next="http://{host}/to/{status}" method="post" namelist="n"/>'
    made = played(tmp_path, host, f'<var name="n" expr="7"/><form><block>{submit}</block></form>')
    assert made.rows()[-1].what == "ends app0: exit"
    assert Host.told == ["n=7"] * (2 if sent else 1)
    assert Host.asked == ([] if sent else ["/form"])


@pytest.mark.parametrize(
    ("written", "asked"),
    [
        ("/say?text=hello world", "/say?text=hello%20world"),
        ("/caf\u00e9?q=\u00fc&amp;r=%20", "/caf%C3%A9?q=%C3%BC&r=%20"),
        ("/a b/c;d=1?e[]=|1|#f g", "/a%20b/c;d=1?e[]=|1|"),
    ],
)
def test_spaces_and_foreign_letters_of_a_uri_are_escaped(
    written: str, asked: str, tmp_path: Path, host: str
) -> None:
    Host.pages = {asked: vxml('<form id="f g"><block><exit/></block></form>')}
    made = played(tmp_path, host, block(f'<goto next="http://{host}{written}"/>'))
    assert Host.asked == [asked]
    assert made.rows()[-1].what == "ends app0: exit"


@pytest.mark.parametrize("declared", ["", '<?xml version="1.0" encoding="UTF-8"?>'])
@pytest.mark.parametrize("encoding", ["latin-1", "utf-8-sig"])
def test_a_header_says_how_a_document_is_encoded(
    declared: str, encoding: str, tmp_path: Path, host: str
) -> None:
    """Before its XML declaration, and after its byte order mark (RFC 7303, 3.2)."""
    body = vxml("<form><block><log>caf\u00e9</log></block></form>")
    Host.pages = {"/spoken": (declared + body).encode(encoding)}
    made = played(tmp_path, host, block(f'<goto next="http://{host}/spoken"/>'))
    assert [one["message"] for one in made.records if one["phase"] == "log"] == ["caf\u00e9"]


def test_a_request_with_values_escapes_its_uri_as_well(tmp_path: Path, host: str) -> None:
    where = f'<submit next="http://{host}/a?b=c d" namelist="n"/>'
    played(tmp_path, host, f'<var name="n" expr="\'e f\'"/>{block(where)}')
    assert Host.asked == ["/a?b=c%20d&n=e+f"]


@pytest.mark.parametrize(
    ("uri", "why"),
    [
        ("http://{}99999/a", "the URI names no host"),
        ("http://[::1/a", "the URI names no host"),
        ("http:///a", "the URI names no host"),
        ("http://me:secret@{}/a", "the URI names a user: leave out what is before the @"),
    ],
)
def test_a_uri_that_cannot_be_asked_says_why(uri: str, why: str, tmp_path: Path, host: str) -> None:
    made = played(
        tmp_path, host, f'{BAD}<form><block><goto next="{uri.format(host)}"/></block></form>'
    )
    assert why in made.dumps() and "--allow-host" not in made.dumps()
    assert logs(made) == ["error.badfetch"]


@pytest.mark.parametrize("name", ["[::1]", "127.0.0.1", "LOCALHOST"])
def test_a_run_takes_the_host_that_its_remedy_names(name: str, tmp_path: Path) -> None:
    body = block(f'<goto next="http://{name}:1/a"/>')
    refused = played(tmp_path, "other.example", body).dumps()
    (named,) = set(re.findall(r'--allow-host ([^\\"]+)', refused))
    assert named == f"{name.lower()}:1"
    for allowed in (named, name):
        made = played(tmp_path, allowed, body)
        assert "--allow-host" not in made.dumps() and logs(made) == ["error.badfetch"]


def test_a_host_may_have_foreign_letters(tmp_path: Path) -> None:
    assert logs(played(tmp_path, "m\u00fcller.example", block("<log>on</log>"))) == ["on"]
