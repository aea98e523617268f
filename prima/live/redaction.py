"""Removes what users say from the records of a live run (``--redact``)."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Sequence
from re import Pattern
from unicodedata import category
from urllib.parse import unquote

from prima.grammar.answers import Answers
from prima.grammar.text import fold
from prima.messages import Heard, Json, Record

REDACTED = "[redacted]"
"""Replaces what a user has said."""
MOST_FREE = 1000
"""How many of the latest utterances without a matching grammar are searched for."""
LONG_ENOUGH = 8
"""Minimum length of an utterance that nobody took; a shorter one recurs by chance."""
SPOKEN = ("utterance", "alternatives", "recorded", "text")
"""The fields of records' data that hold what a user has said."""
FREE = ("text", "words", "extra", "message")
"""Fields of records in which an application may repeat it."""
NAMED = ("error.", "reply.")
"""How events begin whose names an application may make from it."""
ANSWERED = ("X8", "X10")
"""The rules by which words answer a question that does not listen."""


class Redactor:
    """Removes what users say from records; its times and the grammars' results are kept.

    What no grammar took is removed wherever it recurs word for word. Such a journal can be shown
    and measured; it cannot be replayed or resumed.

    Args:
        listening: returns what is listened for now.
    """

    def __init__(self, listening: Callable[[], Sequence[Answers]]) -> None:
        self._listening = listening
        self._takes: Sequence[Answers] = ()
        self._free: deque[Pattern[str]] = deque(maxlen=MOST_FREE)
        """Finds users' own words."""

    def __call__(self, records: list[Record]) -> list[Record]:
        """The records of an instant without users' words."""
        filled = any(
            one.get("outcome") == "filled" or one.get("rule") in ANSWERED for one in records
        )
        made = [self._redacted(record, filled) for record in records]
        self._takes = self._listening()
        return made

    def _redacted(self, record: Record, filled: bool) -> Record:
        data = record.get("data")
        if record["phase"] == "run":
            return {**record, "data": {**record["data"], "redacted": True}}
        if record["phase"] == "event" and record["event"] == "speech":
            self._hear(record, filled)
            record = {**record, "text": REDACTED}
        else:
            record = self._repeated(record)
        if isinstance(data, dict):
            record = {**record, "data": self._values(data) or None}
        return record

    def _repeated(self, record: Record) -> Record:
        """What an application does or says without users' own words."""
        made = {name: self.without(record[name]) for name in FREE if record.get(name)}
        if record.get("args"):
            made["args"] = self._values(record["args"])
        if record.get("cues"):
            made["cues"] = [self._values(one) for one in record["cues"]]
        if record["phase"] == "event" and record["event"].startswith(NAMED):
            made["event"] = self.without(record["event"])
        outcome = record.get("outcome") or ""
        if record["phase"] == "unload" and ": " in outcome:  # with an error's place
            made["outcome"] = self.without(outcome)
        return {**record, **made}

    def _values(self, fields: dict[str, Json]) -> dict[str, Json]:
        """The fields of data, arguments or a cue as they are named, but for what was said."""
        return {name: self.without(one) for name, one in fields.items() if name not in SPOKEN}

    def _hear(self, record: Record, filled: bool) -> None:
        """Remember what was said, and what else the recogniser takes it for."""
        heard = Heard(record.get("text") or "", record.get("data") or {})
        for one in heard.hypotheses:
            self._note(one.text, filled)

    def _note(self, said: str, filled: bool) -> None:
        """Remember free speech; short words only if a question takes any text or has taken them."""
        taken = filled or any(one.type == "text" for one in self._takes)
        if len(fold(said)) < (1 if taken else LONG_ENOUGH):
            return
        if not any(one.in_grammar(said) for one in self._takes):
            words = r"\W+".join(map(re.escape, _words(said)))
            self._free.append(re.compile(rf"(?<![a-z0-9]){words}(?![a-z0-9])", re.I))

    def without(self, value: Json) -> Json:
        """A value without users' own words, in names, too."""
        if isinstance(value, str):
            value = self._cleared(value)
            plain = unquote(value)
            cleared = self._cleared(plain) if plain != value else plain
            return value if cleared == plain else cleared  # it is in a URI
        if isinstance(value, dict):
            return {str(self.without(name)): self.without(one) for name, one in value.items()}
        return [self.without(one) for one in value] if isinstance(value, list) else value

    def _cleared(self, text: str) -> str:
        for said in self._free:
            text = said.sub(REDACTED, text)
        return text


def _words(text: str) -> list[str]:
    """The words of a text, each with its accents and vowel signs."""
    kept = (one.isalnum() or one == "_" or category(one)[0] == "M" for one in text)
    return "".join(one if keep else " " for one, keep in zip(text, kept, strict=True)).split()
