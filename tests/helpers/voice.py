"""A VoiceXML application under test, run by a session on devices that do what the test says."""

from __future__ import annotations

from collections.abc import Mapping

from prima.messages import Fetched, Inbound
from prima.sim.telephone import Telephone
from prima.voicexml.document import FetchError, VoiceDocument
from prima.voicexml.reading import read_page
from tests.helpers.robot import Bench

HEAD = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">'


def vxml(body: str, head: str = HEAD) -> str:
    """A whole document around its content."""
    return f"{head}{body}</vxml>"


def voice(text: str, name: str = "app", kind: str = "ea", **files: str) -> VoiceDocument:
    """An application of one document and further ones by their names (``leaf`` is leaf.vxml)."""
    if "<vxml" not in text:
        text = vxml(text)
    page = read_page(f"{name}.vxml", f"{name}.vxml", text.encode())
    assert [str(one) for one in page.problems if one.severity == "error"] == []
    held = {key if "." in key else f"{key}.vxml": content for key, content in files.items()}

    def fetch(uri: str) -> bytes:
        if uri not in held:
            raise FetchError("there is no such file")
        return held[uri].encode()

    def glance(uri: str) -> tuple[bytes, int]:
        whole = fetch(uri)
        return whole, len(whole)

    return VoiceDocument(name, kind, f"{name}.vxml", page, fetch, page.root, glance)


class Call(Bench):
    """Drives one VoiceXML application: says what the user says, and lets prompts be finished."""

    web: Mapping[str, str | int | None] = {}
    """Answers what is asked of URIs outside: a body, or a status; None does not answer."""

    calls = True
    """Whether the telephone answers at once; else the test tells what becomes of calls."""

    def __init__(self, text: str, *others: VoiceDocument, **files: str) -> None:
        self.telephone = Telephone()
        super().__init__(voice(text, **files), *others)  # type: ignore[arg-type]

    def step(self, *inbound: Inbound, at: int | None = None) -> None:
        """One instant; what is fetched is answered in the next one."""
        before = len(self.orders) if hasattr(self, "orders") else 0
        super().step(*inbound, at=at)
        answers = [
            self._answer(order.app, str(order.data["to"]), int(order.behavior.partition("!")[2]))
            for order in self.orders[before:]
            if order.verb == "send" and "method" in order.data
        ]
        for answer in filter(None, answers):
            self.step(answer)
        for order in self.orders[before:] if self.calls else ():
            if order.verb == "send" and "transfer" in order.data:
                self.telephone.order(self.now, order)
        if self.calls and (news := self.telephone.collect(self.now + 100)):
            self.step(*news)

    def _answer(self, app: str, uri: str, serial: int) -> Fetched | None:
        found = self.web.get(uri, 0)
        if isinstance(found, int):
            return Fetched(app, serial, uri, status=found, problem="there is no such thing")
        return Fetched(app, serial, uri, found) if found is not None else None


class Online(Call):
    """An application whose services and hosts answer."""

    def __init__(self, web: Mapping[str, str | int | None], text: str, **files: str) -> None:
        self.web = web
        super().__init__(text, **files)
