"""Services of live runs: HTTP by name, with deadlines, and without making the run wait."""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import threading
import time
from collections.abc import Coroutine, Iterator, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from prima.errors import DocumentError, UsageError
from prima.live.services import LiveServices
from prima.loading import load_services, validate
from prima.messages import Fetched, Inbound, Occurred, Order
from tests.helpers import here
from tests.live.test_live import ROBOT, ROOT, prima

SECRET = "s3cret-key"
HEAD = '<services xmlns="urn:prima:services:1" version="1.0">\n'
ASKS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" id="asks" kind="ea">
  <form id="a"><block><send to="library"><param name="about" expr="'robots'"/></send></block>
    <on event="reply.library"><speak>It is <value expr="event.data.title"/>.</speak><exit/></on>
    <on event="error.service"><speak>It fails.</speak><exit/></on>
  </form>
</prima>"""
MOODS = """<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en" root="r"
 tag-format="semantics/1.0"><rule id="r"><one-of><item>great<tag>out.mood = "happy"</tag></item>
 <item>bad<tag>out.mood = "sad"</tag></item></one-of></rule></grammar>"""


class Host(ThreadingHTTPServer):
    """Answers as the path says, and keeps what it was asked."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.asked: list[tuple[str, str, bytes]] = []
        self.keys: list[str | None] = []
        self.moved = "http://localhost:1/books"
        self.said: str | None = '{"mood": "happy"}'

    def handle_error(self, request: object, client_address: object) -> None:
        """Say nothing of clients that have hung up."""


class Handler(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        host = cast(Host, self.server)
        body = self.rfile.read(int(self.headers["Content-Length"] or 0))
        host.asked.append((self.command, self.path, body))
        host.keys.append(self.headers["Authorization"])
        self._answer(host, self.path.partition("?")[0], len(host.asked))

    do_POST = do_PUT = do_GET

    def _answer(self, host: Host, path: str, count: int) -> None:
        if path in ("/slow", "/later"):
            time.sleep(3 if path == "/slow" else 1)
        if path == "/drip":
            self.send_response(200)
            self.end_headers()
            for _ in range(30):
                self.wfile.write(b" ")
                time.sleep(0.1)
            return
        if path == "/busy" and count < 3:
            self._send(503, b"")
        elif path == "/away":
            self.send_response(302)
            self.send_header("Location", host.moved)
            self.end_headers()
        elif path == "/minus":
            self.send_response(200)
            self.send_header("Transfer-Encoding", "chunked")
            self.end_headers()
            self.wfile.write(b"-5\r\n{}")
        elif path == "/status":
            self.wfile.write(b"SSH-2.0-OpenSSH_9.6\r\n")
        elif path == "/short":
            self.send_response(200)
            self.send_header("Content-Length", "100")
            self.end_headers()
            self.wfile.write(b'{"title": "I, Robot"}')
        elif path == "/chat":
            said = {"choices": [{"message": {"content": host.said}}]}
            self._send(200, json.dumps(said).encode())
        else:
            known = BODIES.get(path, b'{"title": "I, Robot", "shelf": 3}')
            self._send(200, known, TYPES.get(path, ""))

    def _send(self, status: int, data: bytes, kind: str = "") -> None:
        self.send_response(status)
        if kind:
            self.send_header("Content-Type", kind)
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


BODIES = {
    "/garbage": b"<html>",
    "/nan": b'{"title": NaN}',
    "/list": b"[1]",
    "/deep": b'{"items": [{"title": "I, Robot"}]}',
    "/infinite": b'{"shelf": 1e999}',
    "/endless": b'{"shelf": ' + b"9" * 400 + b"}",
    "/twice": b'{"title": "A", "title": "B"}',
    "/half": b'{"title": "\\ud800"}',
    "/utf-16": '{"title": "é"}'.encode("utf-16"),
    "/page": b'{"title": "A"}',
    "/plus": b'{"title": "A"}',
    "/echo-escaped": f'{{"title": "{SECRET}"}}'.replace("-", "\\u002d").encode(),
    "/echo-utf-16": f'{{"title": "{SECRET}"}}'.encode("utf-16"),
    "/echo-name": f'{{"{SECRET}": [1]}}'.replace("-", "\\u002d").encode(),
    "/huge": b'{"title": "' + b"a" * 200_000 + b'"}',
    "/longest": b'{"text": "' + b'\\"' * 4_900_000 + b'"}',
    "/echo": f'{{"title": "{SECRET}"}}'.encode(),
}
TYPES = {"/page": "text/html; charset=utf-8", "/plus": "application/vnd.books+json"}


@pytest.fixture
def host() -> Iterator[Host]:
    server = Host()
    threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def document(folder: Path, host: Host, more: str, name: str = "service") -> Path:
    """A document of one service; URL is the host's address."""
    path = folder / "services.xml"
    url = f"http://127.0.0.1:{host.server_address[1]}"
    inside = more.replace("URL", url)
    path.write_text(f'{HEAD}<{name} name="library" {inside}\n</services>')
    return path


def asked(path: Path, data: Mapping[str, Any], environment: Mapping[str, str] = {}) -> Inbound:
    """What comes in for a message or a fetch, and that nothing waits for it."""
    services = LiveServices(load_services(str(path))[0], environment=environment)

    async def run() -> Inbound:
        woken = asyncio.Event()
        tasks: list[asyncio.Task[None]] = []

        def spawn(what: Coroutine[Any, Any, None]) -> None:
            tasks.append(asyncio.ensure_future(what))

        services.run = cast(Any, SimpleNamespace(now=lambda: 5, wake=woken.set, spawn=spawn))
        order = Order("send", "a!7", app="a", data=data)
        began = time.monotonic()
        services.order(1, order)
        assert time.monotonic() - began < 0.2
        assert services.due() is None
        async with asyncio.timeout(10):
            await woken.wait()
        assert services.due() == 5
        (found,) = services.collect(5)
        assert services.due() is None
        return found

    return asyncio.run(run())


def send(path: Path, environment: Mapping[str, str] = {}, **params: Any) -> Occurred:
    found = asked(path, {"to": "library", "params": params}, environment)
    assert isinstance(found, Occurred) and found.app == "a"
    return found


def why(found: Occurred) -> str:
    assert found.name == "error.service.library"
    assert found.data["service"] == "library"
    return str(found.data["message"])


def test_a_get_has_its_values_in_the_url(host: Host, tmp_path: Path) -> None:
    found = send(document(tmp_path, host, 'url="URL/books" method="get"/>'), about="a b")
    assert (found.name, found.data) == ("reply.library", {"title": "I, Robot", "shelf": 3})
    assert host.asked == [("GET", "/books?about=a+b", b"")]


@pytest.mark.parametrize("method", ["post", "put"])
def test_other_methods_have_them_as_json(host: Host, tmp_path: Path, method: str) -> None:
    path = document(tmp_path, host, f'url="URL/books" method="{method}"/>')
    assert send(path, about="ü", many=2).name == "reply.library"
    ((how, where, body),) = host.asked
    assert (how, where) == (method.upper(), "/books")
    assert json.loads(body) == {"about": "ü", "many": 2}


def test_slots_are_taken_out_of_an_answer(host: Host, tmp_path: Path) -> None:
    more = 'url="URL/deep"><slot name="title" field="items.0.title"/></service>'
    assert send(document(tmp_path, host, more)).data == {"title": "I, Robot"}


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        ('url="URL/slow" deadline="300ms"/>', "no answer within 0.3 s"),
        ('url="URL/drip" deadline="300ms"/>', "no answer within 0.3 s"),
        ('url="URL/garbage"/>', "the answer is not JSON"),
        ('url="URL/nan"/>', "the answer is not JSON"),
        ('url="URL/infinite"/>', "the answer has a number that is too large"),
        ('url="URL/endless"/>', "the answer has a number that is too large"),
        ('url="URL/twice"/>', 'the answer has "title" twice'),
        ('url="URL/short"/>', "the answer breaks off"),
        ('url="URL/half"/>', "the answer has half a letter"),
        ('url="URL/page"/>', "the answer is text/html, not application/json"),
        ('url="URL/list"/>', "the answer is not a JSON object"),
        ('url="URL/deep"/>', "is not flat"),
        ('url="URL/huge"/>', "larger than 100,000 bytes"),
        ('url="URL/away"/>', 'moved to the host "localhost:1"'),
        ('url="URL/busy"/>', "the service answers 503"),
        ('url="URL/b"><slot name="author"/></service>', 'the answer lacks "author"'),
        ('url="URL/b"><slot name="shelf"/></service>', '"shelf" is not a text'),
        ('url="URL/b"><slot name="title" choices="A | B"/></service>', "is not one of A, B"),
        ('url="URL/minus"/>', "the answer breaks off"),
        ('url="URL/status"/>', "the answer is not HTTP"),
        ('url="http://127.0.0.1:1/"/>', "the host does not answer"),
    ],
)
def test_an_error_says_why(host: Host, tmp_path: Path, more: str, reason: str) -> None:
    began = time.monotonic()
    assert reason in why(send(document(tmp_path, host, more)))
    assert time.monotonic() - began < 2.5


@pytest.mark.parametrize(
    ("how", "times"),
    [
        ('method="get" retries="2"', 3),
        ('method="put" retries="2"', 3),
        ('idempotent="true" retries="2"', 3),
        ('method="post"', 1),
    ],
)
def test_only_what_is_idempotent_is_asked_again(
    host: Host, tmp_path: Path, how: str, times: int
) -> None:
    found = send(document(tmp_path, host, f'url="URL/busy" {how}/>'))
    assert len(host.asked) == times
    assert found.name == ("reply.library" if times == 3 else "error.service.library")


def test_a_service_is_not_moved_to_a_file(host: Host, tmp_path: Path) -> None:
    host.moved = "file:///etc/hostname"
    reason = why(send(document(tmp_path, host, 'url="URL/away"/>')))
    assert "it is moved to a URI that is neither http nor https" in reason


@pytest.mark.parametrize("where", ["http://[::1", "http://127.0.0.1:x/", "http://me@127.0.0.1/"])
def test_a_service_is_not_moved_to_what_is_no_address(
    where: str, host: Host, tmp_path: Path
) -> None:
    host.moved = where
    reason = why(send(document(tmp_path, host, 'url="URL/away"/>')))
    assert reason == f"it is moved to {where}, which is not an address"


def test_a_service_is_moved_to_an_address_of_other_letters(host: Host, tmp_path: Path) -> None:
    host.moved = "/caf\u00e9 1%20"
    assert send(document(tmp_path, host, 'url="URL/away"/>')).name == "reply.library"
    assert host.asked[-1][1] == "/caf%E9%201%20"


def test_a_fragment_does_not_take_the_values_along(host: Host, tmp_path: Path) -> None:
    send(document(tmp_path, host, 'url="URL/books#new" method="get"/>'), about="a")
    assert host.asked == [("GET", "/books?about=a", b"")]


def test_a_service_that_is_not_named_is_none(host: Host, tmp_path: Path) -> None:
    path = document(tmp_path, host, 'url="URL/"/>')
    found = asked(path, {"to": "archive", "params": {}})
    assert isinstance(found, Occurred)
    assert found.name == "error.service.archive"
    assert "--services" in found.data["message"]
    fetched = asked(path, {"to": "http://localhost:1/x", "method": "get", "params": {}})
    assert isinstance(fetched, Fetched)
    assert "--allow-host" in fetched.problem


@pytest.mark.parametrize("owner", ["a", "another"])
def test_a_service_and_its_secret_are_for_the_application_that_it_belongs_to(
    owner: str, host: Host, tmp_path: Path
) -> None:
    path = document(tmp_path, host, f'application="{owner}" url="URL/x" key="LIBRARY_KEY"/>')
    secret = {"LIBRARY_KEY": SECRET}
    found = send(path, secret, title="I")
    assert found.name == ("reply.library" if owner == "a" else "error.service.library")
    for uri in ("service:library", f"http://127.0.0.1:{host.server_address[1]}/x"):
        fetched = asked(path, {"to": uri, "method": "get", "params": {}}, secret)
        assert isinstance(fetched, Fetched) and (fetched.problem == "") == (owner == "a")
    assert len(host.asked) == len(host.keys) == (3 if owner == "a" else 0)
    if owner != "a":
        assert 'the service "library" is another application\'s' in why(found)


def test_an_applications_own_service_goes_before_that_of_all(host: Host, tmp_path: Path) -> None:
    more = 'url="URL/all"/><service name="library" application="a" url="URL/own"/>'
    send(document(tmp_path, host, more))
    send(document(tmp_path, host, more.replace('"a"', '"b"')))
    assert [one[1] for one in host.asked] == ["/own", "/all"]


def test_voicexml_fetches_by_name_and_below_the_address(host: Host, tmp_path: Path) -> None:
    path = document(tmp_path, host, 'url="URL/garbage"/>')
    url = f"http://127.0.0.1:{host.server_address[1]}/garbage"
    for uri in ("service:library", url, f"{url}/one"):
        found = asked(path, {"to": uri, "method": "get", "params": {"a": "1"}})
        assert isinstance(found, Fetched)
        assert (found.problem, found.serial, found.uri) == ("", 7, uri)
    assert [one[1] for one in host.asked] == ["/garbage?a=1", "/garbage?a=1", "/garbage/one?a=1"]


def test_a_secret_is_sent_and_never_kept(host: Host, tmp_path: Path) -> None:
    path = document(tmp_path, host, 'url="URL/echo" key="LIBRARY_KEY"/>')
    found = send(path, {"LIBRARY_KEY": SECRET})
    assert host.keys == [f"Bearer {SECRET}"]
    assert found.data == {"title": "***"}
    for wrong in ("", "a\nb"):
        with pytest.raises(UsageError, match="LIBRARY_KEY") as error:
            LiveServices(load_services(str(path))[0], environment={"LIBRARY_KEY": wrong})
        assert "services.xml:2:1" in str(error.value)


@pytest.mark.parametrize("path", ["echo", "echo-escaped", "echo-utf-16", "echo-name", "away"])
def test_a_secret_is_hidden_however_it_is_sent_back(host: Host, tmp_path: Path, path: str) -> None:
    host.moved = f"http://{SECRET}.example/"
    document_path = document(tmp_path, host, f'url="URL/{path}" key="LIBRARY_KEY"/>')
    found = send(document_path, {"LIBRARY_KEY": SECRET})
    assert host.keys == [f"Bearer {SECRET}"]
    assert SECRET not in repr(found)
    assert "***" in repr(found)


@pytest.mark.parametrize("path", ["plus", "utf-16"])
def test_json_of_other_kinds_is_taken(host: Host, tmp_path: Path, path: str) -> None:
    assert send(document(tmp_path, host, f'url="URL/{path}"/>')).name == "reply.library"


def test_voicexml_gets_no_secret_back(host: Host, tmp_path: Path) -> None:
    path = document(tmp_path, host, 'url="URL/echo" key="LIBRARY_KEY"/>')
    given = {"to": "service:library", "method": "get", "params": {}}
    found = asked(path, given, {"LIBRARY_KEY": SECRET})
    assert isinstance(found, Fetched)
    assert found.body == '{"title": "***"}'


MODEL = """url="URL/{}" model="small" deadline="500ms"><prompt>It is {{text}}.</prompt>
<slot name="mood" choices="happy | sad"/>{}</language-model>"""


def test_a_language_model_fills_slots(host: Host, tmp_path: Path) -> None:
    path = document(tmp_path, host, MODEL.format("chat", ""), "language-model")
    assert send(path, text="great").data == {"mood": "happy"}
    told = json.loads(host.asked[0][2])
    assert told["messages"] == [{"role": "user", "content": "It is great."}]
    assert told["response_format"]["json_schema"]["schema"] == {
        "type": "object",
        "properties": {"mood": {"type": "string", "enum": ["happy", "sad"]}},
        "required": ["mood"],
        "additionalProperties": False,
    }
    assert 'needs the value "text"' in why(send(path))
    host.said = '{"mood": "angry"}'
    assert "not one of happy, sad" in why(send(path, text="great"))
    host.said = "I would say happy"
    assert "not JSON" in why(send(path, text="great"))
    host.said = None  # as where it calls a tool instead
    assert "the model says nothing" in why(send(path, text="great"))


@pytest.mark.parametrize("where", ["list", "deep"])
def test_an_answer_that_is_no_models_is_told(host: Host, tmp_path: Path, where: str) -> None:
    path = document(tmp_path, host, MODEL.format(where, ""), "language-model")
    assert "choices[0].message.content" in why(send(path, text="great"))


@pytest.mark.parametrize("where", ["slow", "garbage"])
def test_a_grammar_fills_them_where_the_model_does_not(
    host: Host, tmp_path: Path, where: str
) -> None:
    (tmp_path / "mood.grxml").write_text(MOODS)
    more = MODEL.format(where, '<fallback grammar="mood.grxml" of="text"/>')
    path = document(tmp_path, host, more, "language-model")
    assert send(path, text="bad").data == {"mood": "sad", "fallback": True}
    assert why(send(path, text="whatever"))


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ('url="ftp://x/"/>', "is not an address"),
        ('url="http://me:pass@x/"/>', "holds a password"),
        ('url="http://x/" retries="2"/>', "not repeated"),
        ('url="http://x/" key="my key"/>', "environment variable"),
        ('url="http://x/"/><service name="library" url="http://x/"/>', "there twice"),
        ('url="http://x/" dedline="1s"/>', "dedline"),
        ('url="http://x/"><header name="A"/></service>', "exactly one of value, variable"),
    ],
)
def test_a_wrong_document_is_diagnosed(host: Host, tmp_path: Path, more: str, told: str) -> None:
    problems = validate([document(tmp_path, host, more)])
    assert any(told in f"{one.message}" for one in problems)
    assert all(one.place.line == 2 for one in problems)


def test_a_grammar_that_is_not_there_is_diagnosed(host: Host, tmp_path: Path) -> None:
    more = MODEL.format("chat", '<fallback grammar="none.grxml" of="text"/>')
    with pytest.raises(DocumentError, match=r"none\.grxml"):
        load_services(str(document(tmp_path, host, more, "language-model")))


@pytest.mark.parametrize(("where", "line"), [("echo", "It is ***."), ("garbage", "It fails.")])
def test_a_mediated_run_replays_without_services(
    host: Host, tmp_path: Path, where: str, line: str
) -> None:
    (tmp_path / "asks.xml").write_text(ASKS)
    path = document(tmp_path, host, f'url="URL/{where}" key="LIBRARY_KEY"/>')
    journal = tmp_path / "visit.jsonl"

    def prima(*words: str, **more: str) -> subprocess.CompletedProcess[str]:
        return here.prima(*words, cwd=ROOT, env={**os.environ, **more})

    words = ["live", "--robot", ROBOT, "--fa", "documents/fa/follow.xml"]
    words += ["--ea", str(tmp_path / "asks.xml"), "--services", str(path), "-o", str(journal)]
    refused = prima(*words)
    assert (refused.returncode, journal.exists()) == (2, False)
    assert "LIBRARY_KEY is not set" in refused.stderr
    right = path.read_text()
    path.write_text(right.replace("<service ", '<service application="ask" '))
    refused = prima(*words, LIBRARY_KEY=SECRET)
    assert (refused.returncode, journal.exists()) == (1, False)
    assert 'There is no application "ask". Did you mean "asks"?' in refused.stderr
    path.write_text(right)
    ran = prima(*words, "--speed", "10", "--until", "60s", LIBRARY_KEY=SECRET)
    assert ran.returncode == 0, ran.stderr
    assert line in ran.stdout
    text = journal.read_text()
    assert SECRET not in text + ran.stdout + ran.stderr
    head = json.loads(text.splitlines()[0])["data"]
    assert head["live"]["services"] == "services.xml"
    assert any("services.xml" in name for name in head["files"])
    host.shutdown()
    again = prima("replay", str(journal))
    assert (again.returncode, again.stderr) == (0, "the same, byte for byte\n")
    path.write_text(path.read_text() + "\n")
    assert prima("replay", str(journal)).returncode == 2


def test_the_journal_of_a_very_long_answer_replays(host: Host, tmp_path: Path) -> None:
    (tmp_path / "asks.xml").write_text(ASKS.replace("event.data.title", "'fine'"))
    path = document(tmp_path, host, 'url="URL/longest" most="10000000" deadline="20s"/>')
    journal = str(tmp_path / "visit.jsonl")
    words = ["--robot", ROBOT, "--ea", str(tmp_path / "asks.xml"), "--services", str(path)]
    ran = prima("live", *words, "-o", journal, "--until", "30s")
    assert "It is fine." in ran.stdout, ran.stderr
    assert prima("replay", journal).returncode == 0


@pytest.mark.parametrize(("policy", "said"), [("prima", [0, 2, 1]), ("prima+x3", [0, 1, 2])])
def test_a_topic_is_held_while_a_real_service_answers(
    policy: str, said: list[int], host: Host, tmp_path: Path
) -> None:
    """X3: what another application wants to say waits for the answer where the author asks for it."""
    services = document(tmp_path, host, 'url="URL/later" method="get"/>')
    asks = ASKS.replace('<form id="a">', '<form id="a" stream="hold" hold-for="60s">')
    asks = asks.replace("<block>", "<block><speak>One moment.</speak>")
    tells = """<prima xmlns="urn:prima:dialogue:1" version="1.0" id="tells" kind="fa">
      <form id="a"><block><send event="now" delay="2s"/></block>
        <on event="now"><speak>By the way.</speak><exit/></on></form></prima>"""
    for name, text in (("asks", asks), ("tells", tells)):
        (tmp_path / f"{name}.xml").write_text(text)
    words = ["--ea", str(tmp_path / "asks.xml"), "--fa", str(tmp_path / "tells.xml")]
    journal = tmp_path / "visit.jsonl"
    words += ["--services", str(services), "--policy", policy, "--speed", "10", "-o", str(journal)]
    ran = prima("live", "--robot", ROBOT, *words)
    assert ran.returncode == 0, ran.stderr
    records = [json.loads(line) for line in journal.read_text().splitlines()]
    texts = [one["text"] for one in records if one["phase"] == "start" and one.get("text")]
    assert texts == [["One moment.", "It is I, Robot.", "By the way."][which] for which in said]
    held = [one["outcome"] for one in records if one["phase"] == "held"]
    assert held[:2] == (["begun", "joined"] if "x3" in policy else [])
    host.server_close()
    assert prima("replay", str(journal)).returncode == 0
