"""Documents as values, that can be written as XML and interpreted."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from html import escape

Value = str | int | bool | dict[str, "Value"] | None
"""None is undefined."""
Values = Mapping[str, Value]

HEAD = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en"{}>'
SRGS = (
    '<grammar version="1.0" root="r" tag-format="semantics/1.0"{}'
    ' xmlns="http://www.w3.org/2001/06/grammar"><rule id="r"><one-of>{}</one-of></rule></grammar>'
)


@dataclass(frozen=True)
class Code:
    """An expression: as it is written, and what it means."""

    text: str
    of: Callable[[Values], Value]


@dataclass(eq=False)
class El:
    """An element; ``words`` are what a grammar, link or choice takes, with the slots they fill."""

    tag: str
    has: dict[str, str | int | Code | None] = field(default_factory=dict)
    holds: list[El | str] = field(default_factory=list)
    words: dict[str, dict[str, str]] = field(default_factory=dict)

    def get(self, name: str) -> str:
        """An attribute as text."""
        value = self.has.get(name)
        return value.text if isinstance(value, Code) else "" if value is None else str(value)

    def code(self, name: str) -> Code | None:
        """An attribute that is an expression."""
        value = self.has.get(name)
        return value if isinstance(value, Code) else None

    @property
    def count(self) -> int:
        """The ``count`` of a prompt or handler."""
        return int(self.get("count") or 1)

    @property
    def name(self) -> str:
        """The variable of a form item; a menu is its own item."""
        return self.get("name") or self.get("id")

    def all(self, *tags: str) -> list[El]:
        """Children by their tags, in document order."""
        return [one for one in self.holds if isinstance(one, El) and one.tag in tags]


def written(one: El | str, voice: bool) -> str:
    """An element as XML: of VoiceXML, or of PRIMA's own language."""
    if isinstance(one, str):
        return one
    inside = "".join(written(part, voice) for part in one.holds)
    if one.tag == "grammar":
        return _grammar(one, voice)
    if one.tag in ("elseif", "else", "if"):
        cond = one.code("cond")
        head = f'<{one.tag} cond="{escape(cond.text)}"' if cond else f"<{one.tag}"
        return f"{head}>{inside}</if>" if one.tag == "if" else f"{head}/>{inside}"
    if one.tag == "link":
        inside = _grammar(one, voice)
    tag = one.tag if voice else {"catch": "on", "say": "speak"}.get(one.tag, one.tag)
    tag = {"say": "prompt"}.get(tag, tag)
    had = "".join(f' {name}="{escape(one.get(name))}"' for name in one.has if one.get(name))
    return f"<{tag}{had}>{inside}</{tag}>"


def _grammar(one: El, voice: bool) -> str:
    items = ""
    for word, slots in one.words.items():
        tag = "".join(f"out.{name} = '{value}';" for name, value in slots.items())
        items += f"<item>{word}<tag>{tag}</tag></item>" if tag else f"<item>{word}</item>"
    if not voice:
        return f"<grammar><one-of>{items}</one-of></grammar>"
    scope = f' scope="{one.get("scope")}"' if one.get("scope") and one.tag == "grammar" else ""
    return SRGS.format(scope, items)


def pages(documents: Mapping[str, El]) -> dict[str, str]:
    """The documents of a VoiceXML application as text; all but the root name it."""
    return {
        name: HEAD.format("" if name == ROOT else f' application="{ROOT}"')
        + "".join(written(one, True) for one in page.holds)
        + "</vxml>"
        for name, page in documents.items()
    }


ROOT, FIRST, OTHER = "root.vxml", "app.vxml", "two.vxml"
