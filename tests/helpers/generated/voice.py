"""Generated VoiceXML applications, for plays beside those in PRIMA's own language."""

from __future__ import annotations

import re

from tests.helpers.generated.author import CALLED, EVENTS, LOOPS, OWN, PLAIN, TURNS, Author

HEAD = (
    '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1"'
    ' xml:lang="en">'
)


def guest(command: str) -> str:
    """Commands of PRIMA's own language as VoiceXML has them, where none is wanted now."""
    return re.sub(r"<(/?)(?=\w)", r"<\1p:", command.replace(' order="now"', ""))


class VoiceAuthor(Author):
    """Writes one VoiceXML document."""

    def document(self) -> str:
        """The document's text."""
        self.forms = [f"f{number}" for number in range(1, self.some(1, 3) + 1)]
        parts = []
        if self.chance(3):
            parts.append(self.caught(0, self.one(EVENTS), external=True))
        if self.chance(3):
            parts.append(f"<error>{self.said(len(self.forms), simple=True)}</error>")
        if self.chance(5):
            to = self.one((f'next="#{self.one(self.forms)}"', 'event="own"'))
            grammar = '<grammar version="1.0" root="g"><rule id="g">mumble</rule></grammar>'
            parts.append(f"<link {to}>{grammar}</link>")
        parts += [self.dialog(index) for index in range(len(self.forms))]
        return f"{HEAD}{''.join(parts)}{CALLED}</vxml>"

    def dialog(self, index: int) -> str:
        """A form, or a menu that leads on."""
        name, ahead = self.forms[index], self.forms[index + 1 :]
        if ahead and self.chance(5):
            choice = (
                f'<choice next="#{self.one(ahead)}">yes</choice><choice event="own">no</choice>'
            )
            return f'<menu id="{name}"><prompt>Which?</prompt>{choice}</menu>'
        items = "".join(self.visited(index) for _ in range(self.some(0, 3)))
        events = (*EVENTS, *TURNS, "own", *OWN)
        caught = [self.caught(index, self.one(events)) for _ in range(self.some(0, 2))]
        filled = f"<filled>{self.said(index, unit=True)}</filled>" if "<field" in items else ""
        return (
            f'<form id="{name}">{items}{filled if self.chance(4) else ""}{"".join(caught)}</form>'
        )

    def visited(self, index: int) -> str:
        """A form item."""
        match self.some(0, 7):
            case 0 | 1 | 2:
                return f"<block>{self.said(index)}</block>"
            case 3 | 4 | 5:
                return self.asked(index)
            case 6:
                name = f"s{next(self.fields)}"
                filled = f"<filled>{self.said(index)}</filled>"
                return f'<subdialog name="{name}" src="#called">{filled}</subdialog>'
            case _:
                inside = f"<block>{self.said(index, unit=True)}</block>{self.asked(index, True)}"
                longest = f' longest="{self.some(1, 6000)}ms"' if self.chance(3) else ""
                return f"<p:iu{longest}>{inside}</p:iu>"

    def asked(self, index: int, unit: bool = False) -> str:
        """A question."""
        bargein = ' bargein="false"' if self.chance(4) else ""
        parts = [f"<prompt{bargein}>Well?{self.played(unit)}</prompt>"]
        if self.chance(4):
            parts.append('<prompt count="2">Well, then?</prompt>')
        for tag in ("noinput", "nomatch"):
            if self.chance(3):
                count = self.one(("", "", ' count="2"'))
                parts.append(f"<{tag}{count}>{self.said(index, unit, simple=True)}</{tag}>")
        if self.chance(2):
            parts.append(f"<filled>{self.said(index, unit)}</filled>")
        if self.chance(4):
            parts.append(self.caught(index, self.one(EVENTS), unit))
        return f'<field name="q{next(self.fields)}" type="boolean">{"".join(parts)}</field>'

    def played(self, unit: bool) -> str:
        """Now and then a Command in a prompt."""
        return guest(self.one(PLAIN)) if self.chance(5) and not unit else ""

    def caught(self, index: int, event: str, unit: bool = False, external: bool = False) -> str:
        """A handler; ends and errors may come for ever, so it asks for nothing then.

        What a link throws is handled in units too.
        """
        simple, unit = event in OWN, unit or event == "own"
        content = self.said(index, unit, simple=simple, external=external and not simple)
        return f'<catch event="{event}">{content}</catch>'

    def said(
        self, index: int, unit: bool = False, simple: bool = False, external: bool = False
    ) -> str:
        """Executable content; ``simple`` asks for nothing, ``external`` may lead anywhere."""
        parts = []
        for _ in range(self.some(0, 3)):
            kind = self.some(0, 9)
            if simple or kind == 9:
                parts.append(self.one(("<log>so</log>", "<reprompt/>")))
            elif kind < 3:
                parts.append(f"<prompt>Hello.{self.played(unit)}</prompt>")
            elif kind < 5:
                parts.append(guest(self.one(PLAIN if unit else (*PLAIN, *LOOPS))))
            elif kind == 5:
                branches = "".join(guest(self.one(PLAIN)) for _ in range(2))
                parts.append(f"<p:par>{branches}</p:par>")
            elif kind == 6:
                parts.append(guest(self.group()))
            else:
                parts.append('<if cond="true"><prompt>So.</prompt></if>')
        ahead = self.forms if external else self.forms[index + 1 :]
        if ahead and self.chance(3):
            parts.append(f'<goto next="#{self.one(ahead)}"/>')
        elif not unit and self.chance(6):
            parts.append("<exit/>")
        return "".join(parts)
