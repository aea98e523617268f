"""A VoiceXML application under test, run by a session on devices that do what the test says."""

from __future__ import annotations

from prima.messages import Ended
from prima.voicexml.document import FetchError, VoiceDocument, read_page
from tests.robot import Bench

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

    return VoiceDocument(name, kind, f"{name}.vxml", page, fetch, page.root)


class Call(Bench):
    """Drives one VoiceXML application: says what the user says, and lets prompts be finished."""

    def __init__(self, text: str, *others: VoiceDocument, **files: str) -> None:
        super().__init__(voice(text, **files), *others)  # type: ignore[arg-type]

    def play(self) -> list[str]:
        """Let everything that is said come to its end; gives all that has been said so far."""
        for _ in range(1000):
            speaking = self._speaking()
            if not speaking:
                break
            self.step(*[Ended(behavior) for behavior in speaking])
        return self.said()

    def _speaking(self) -> list[str]:
        running = self.session.mediator.memory.running
        return [ab.id for ab in running.values() if ab.command and ab.command.type != "q-and-a"]

    def answer(self, *utterances: str) -> None:
        """Say something to each question that comes, once it has been said."""
        for text in utterances:
            self.play()
            self.listens()
            self.hears(text)
        self.play()

    def silent(self) -> None:
        """Say nothing to the question that comes."""
        self.play()
        self.silence()
        self.play()

    @property
    def ended(self) -> str:
        """How the application has ended: ``exit``, an event's name, or nothing if it runs."""
        found = [r for r in self.phases("unload") if r["actor"] == "mediator"]
        return str(found[0]["outcome"]) if found else ""
