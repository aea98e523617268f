"""Generated documents in PRIMA's own language."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import count
from typing import Any

from hypothesis import strategies as st

from tests.helpers.generated.world import DANCES

PLAIN = (
    "<speak>Hello.</speak>",
    "<speak>Well.</speak>",
    "<face-human/>",
    "<face-human-and-speak>You.</face-human-and-speak>",
    '<turn-and-speak angle="90">There.</turn-and-speak>',
    '<set-direction heading="10"/>',
    '<turn angle="30"/>',
    '<set-speed-and-time speed="0.1" time="1s"/>',
    '<move-head pan="10"/>',
    '<point-by-hand angle="20"/>',
    '<gesture name="nod"/>',
)
MORE = (*PLAIN, *(f'<command type="{name}"/>' for name in DANCES))
"""What may be asked for outside units too."""


NESTED = '<iu><speak>In.</speak><turn angle="1"/></iu>'
NOW = (
    "<stop-moving/>",
    '<speak order="now">Wait.</speak>',
    '<turn angle="5" order="now"/>',
    '<topological-move to="room" order="now"/>',
)
LOOPS = (
    '<topological-move to="room"/>',
    '<set-position x="1" y="2"/>',
    '<set-position-and-direction x="1" y="2" heading="3"/>',
    "<active-sensing-human>Where are you?</active-sensing-human>",
    "<active-sensing-human/>",
    "<tracking-human/>",
)
HOOKED = '<speak>Hooked.<on event="cancel"><log>cut</log></on><on event="end">{}</on></speak>'
THROWN = "thrown.here"
TURNS = ("suspended", "resumed")
OWN = ("end", "cancel", "expired", "error")
"""Events that may come for ever, of what the application itself does."""
EVENTS = ("touch", "touch.head", "message", "corner", "human.found", "human.lost")


CALLED = (
    '<form id="called"><field name="r" type="boolean"><prompt>Sure?</prompt>'
    '<filled><return namelist="r"/></filled><noinput count="2"><return event="own"/></noinput>'
    "</field></form>"
)
"""A form for subdialogs."""


class Author:
    """Writes one document. Every choice is drawn, so that it shrinks."""

    def __init__(self, draw: Any, name: str, lively: bool) -> None:
        self.draw = draw
        self.name = name
        self.lively = lively
        """Whether the application may stop on its own account: by errors, exits, timeouts."""
        self.fields = count(1)

    def some(self, low: int, high: int) -> int:
        return int(self.draw(st.integers(low, high)))

    def one(self, choices: Iterable[str]) -> str:
        return str(self.draw(st.sampled_from(tuple(choices))))

    def chance(self, of: int) -> bool:
        """True once in ``of`` times; False is the simpler choice."""
        return bool(self.some(1, of) == of)

    def document(self) -> str:
        self.forms = [f"f{number}" for number in range(1, self.some(1, 3) + 1)]
        parts = []
        if self.chance(3):
            parts.append(self.handler(0, self.one(EVENTS)))
        if self.chance(3):
            # It may be thrown again wherever it leads: so it leads nowhere.
            parts.append(f"<error>{self.content(len(self.forms), simple=True)}</error>")
        if self.chance(5):
            target = self.one(self.forms)
            parts.append(f'<link next="#{target}"><grammar><item>mumble</item></grammar></link>')
        parts += [self.form(index) for index in range(len(self.forms))]
        kind = "fa" if self.name == "fa" else "ea"
        head = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="{self.name}">'
        return head + "".join(parts) + CALLED + "</prima>"

    def form(self, index: int) -> str:
        items = "".join(self.item(index) for _ in range(self.some(0, 2)))
        handlers = "".join(
            self.handler(index, self.one((*EVENTS, *TURNS, "own", "late", *OWN)))
            for _ in range(self.some(0, 2))
        )
        hints = self.hold(4) + self.connect(4) + self.words(2)
        watch = self.watch(index) if self.chance(8) else ""
        return f'<form id="{self.forms[index]}"{hints}>{watch}{items}{handlers}</form>'

    def watch(self, index: int) -> str:
        """A condition that is true on entry; what it raises may leave the state at once."""
        ahead = self.forms[index + 1 :]
        leaving = [f'<goto next="#{form}"/>' for form in ahead]
        if not self.lively:
            leaving.append("<exit/>")
        content = self.command(False) if self.chance(2) else ""
        content += self.one(leaving) if leaving and self.chance(2) else ""
        return f'<watch name="w" when="true"/><on event="w">{content}</on>'

    def hold(self, of: int) -> str:
        """X3: now and then the hint that the stream be kept open."""
        return f' stream="hold" hold-for="{self.some(1, 6000)}ms"' if self.chance(of) else ""

    def words(self, of: int) -> str:
        """X9: now and then what is said when the form's stream resumes."""
        return ' resume-text="As I was saying."' if self.chance(of) else ""

    def connect(self, of: int) -> str:
        """X4: now and then the hint that the robot turn to the user first."""
        return ' channel="connect"' if self.chance(of) else ""

    def restart(self, text: str) -> str:
        """X2: now and then the hint that a Command or unit may be interrupted."""
        if not self.chance(3):
            return text
        return re.sub(r"^<[\w-]+", r'\g<0> restartable="true"', text)

    def item(self, index: int) -> str:
        kind = self.some(0, 8)
        if kind == 8:
            filled = f"<filled>{self.content(index)}</filled>"
            return f'<subdialog name="s{next(self.fields)}" src="#called">{filled}</subdialog>'
        if kind == 6:
            # A unit behind speech: it is linked until that has ended.
            return f"<block><speak>First.</speak></block>{self.unit(index)}"
        if kind == 7:
            # What is wanted now, behind speech of one's own.
            said = "".join(f"<speak>{word}.</speak>" for word in ("One", "Two")[: self.some(1, 2)])
            return f"<block>{said}{self.one(NOW)}{self.command(False)}</block>"
        if kind < 3:
            return f"<block{self.hold(6)}>{self.content(index, sends=True)}</block>"
        if kind < 5:
            return self.question(index)
        return self.unit(index)

    def question(self, index: int, unit: bool = False) -> str:
        parts = ["<prompt>Well?</prompt>"]
        if self.chance(3):
            parts.append(f"<noinput>{self.content(index, unit=unit, simple=True)}</noinput>")
        if self.chance(3):
            parts.append(f"<nomatch>{self.content(index, unit=unit, simple=True)}</nomatch>")
        if self.chance(2):
            parts.append(f"<filled>{self.content(index, unit=unit)}</filled>")
        if self.chance(4):
            parts.append(self.handler(index, self.one(EVENTS), unit))
        if self.chance(8):
            parts.append(self.leaving(index))
        hints = self.hold(6) + self.connect(6)
        name = f'name="q{next(self.fields)}" type="boolean"'
        return f"<field {name}{hints}>{''.join(parts)}</field>"

    def leaving(self, index: int) -> str:
        """A handler that leaves the state while a question may be asked."""
        leave = f'<goto next="#{self.one(self.forms)}"/>'
        if self.chance(4) and not self.lively:
            leave = "<exit/>"
        said = "<speak>Bye.</speak>" if self.chance(3) else ""
        return f'<on event="{self.one(EVENTS)}">{said}{leave}</on>'

    def unit(self, index: int) -> str:
        parts = []
        for _ in range(self.some(1, 2)):
            if self.chance(2):
                parts.append(self.question(index, unit=True))
            else:
                parts.append(f"<block>{self.content(index, unit=True)}</block>")
        if self.chance(4):
            parts.append(self.handler(index, self.one(EVENTS), True))
        if self.chance(6):
            # A handler inside that is reached by throw alone.
            thrown = f'<throw event="{THROWN}"/>'
            parts.append(f"<block>{thrown}</block>")
            parts.append(f'<on event="{THROWN}">{self.content(index, unit=True)}</on>')
        longest = f' longest="{self.some(1, 6000)}ms"' if self.chance(3) else ""
        return f"<iu{longest}>{''.join(parts)}</iu>"

    def handler(self, index: int, event: str, unit: bool = False) -> str:
        reactive = self.one(("", "", ' reactive="true"', ' reactive="false"'))
        # Ends and errors may come for ever, so what is done about them asks for nothing;
        # the application's own event is sent by what comes from outside or once, and leads ahead;
        # so does what its stream comes to.
        simple = event in OWN
        external = not simple and event not in ("own", *TURNS)
        content = self.content(index, unit=unit, simple=simple, external=external, sends=external)
        fresh = self.one(("", "", ' fresh-for="1ms"', ' fresh-for="900ms"'))
        return f'<on event="{event}"{reactive}{fresh}>{content}</on>'

    def content(
        self,
        index: int,
        unit: bool = False,
        simple: bool = False,
        external: bool = False,
        sends: bool = False,
    ) -> str:
        """Content; ``simple`` asks for nothing, ``external`` may go anywhere in the document.

        Only where it ``sends`` does it send itself an event.
        """
        parts = []
        for _ in range(self.some(0, 3)):
            kind = self.some(0, 9)
            if simple or kind == 9:
                parts.append(self.effortless(sends))
            elif kind < 5:
                parts.append(self.command(unit))
            elif kind == 5:
                parts.append(f"<par>{self.branch(unit)}{self.branch(unit)}</par>")
            elif kind == 6:
                parts.append(self.group())
            elif kind == 7:
                parts.append(self.one(NOW[:3] if unit else NOW))
            else:
                parts.append(f'<if cond="true">{self.command(unit)}</if>')
        if self.chance(3):
            ahead = self.forms if external else self.forms[index + 1 :]
            if ahead:
                parts.append(f'<goto next="#{self.one(ahead)}"/>')
            elif self.chance(3) and not self.lively:
                parts.append("<exit/>")
        return "".join(parts)

    def effortless(self, sends: bool = False) -> str:
        quiet = ("<log>so</log>", '<send to="server"/>', "<reprompt/>")
        return self.one((*quiet, '<send event="own" delay="700ms"/>') if sends else quiet)

    def command(self, unit: bool) -> str:
        if not unit and self.chance(3):
            return self.one(LOOPS)
        if self.chance(12):
            return self.restart(HOOKED.format(self.effortless()))
        return self.restart(self.one(MORE))

    def branch(self, unit: bool) -> str:
        if self.chance(3):
            return f"<seq>{self.command(unit)}{self.command(unit)}</seq>"
        return self.command(unit)

    def group(self) -> str:
        inside = [self.one(PLAIN) for _ in range(self.some(1, 3))]
        if self.chance(3):
            second = self.one((*PLAIN, NESTED, NESTED, NESTED))
            inside.append(f"<par>{self.one(PLAIN)}{second}</par>")
        if self.chance(6):
            inside.insert(0, self.one(NOW[:3]))
        longest = f' longest="{self.some(1, 3000)}ms"' if self.chance(4) else ""
        return self.restart(f"<iu{longest}>{''.join(inside)}</iu>")
