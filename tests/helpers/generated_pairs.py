"""Random pairs of applications in either language, and scenarios for them in the simulator.

Everything of a pair is drawn from one number, so a pair that fails is named by it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from random import Random

from tests import ROOT

DOCUMENTS = ROOT / "documents"
HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{}" id="{}" xml:lang="en">'
VOICE = (
    '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1"'
    ' xml:lang="en">'
)
TIMER = '<on event="late"{}>{}</on>'
REACTIVE = ' reactive="true"'
OWN = ("end.speak", "end.gesture", "end.move-head", "end.turn", "end")
"""Events that an application makes for itself."""
EVENTS = ("touch", "touch.head", "message", "bell", "human.found", "human.lost")
WORDS = ("one", "two three", "four, five. Six", "a longer sentence about nothing at all", "eh")
MOTIONS = (
    '<move-head pan="{angle}"/>',
    '<turn angle="{angle}"/>',
    "<face-human/>",
    '<gesture name="bow"/>',
    '<point-by-hand angle="20"/>',
    '<set-direction heading="{angle}"/>',
    '<set-speed-and-time speed="0.1" time="{time}ms"/>',
    '<turn-and-speak toward="door">{words}</turn-and-speak>',
    "<face-human-and-speak>{words}</face-human-and-speak>",
)
SHARED = (
    ('<turn angle="20"/>', ('<turn angle="{angle}"/>', '<set-direction heading="{angle}"/>')),
    ("<speak>Me.</speak>", ("<speak>{words}.</speak>",)),
    ('<move-head pan="5"/>', ('<move-head pan="{angle}"/>', '<gesture name="bow"/>')),
)
"""What one application does, and what of the other makes it wait."""
BEFORE = ("", "", "", '<point-by-hand angle="20"/>', '<pause time="10ms"/>')
"""What the first one may do before that, for nothing of the other."""
TOUCH = '<touch sensor="head"/>'
MESSAGE = '<message from="A">Hello.</message>'
BELL = '<event name="bell"/>'
PLACES = ('x="1" y="0"', 'x="-1" y="0.5"', 'x="0" y="-3"')
LOOPS = (
    '<topological-move to="{place}"/>',
    "<active-sensing-human>{words}</active-sensing-human>",
    "<tracking-human/>",
)


@dataclass(frozen=True)
class Pair:
    """Two applications and what happens to them, as documents."""

    seed: int
    fa: str
    ea: str
    more: str
    """A further document of the EA's, if it is VoiceXML."""
    scenario: str

    @property
    def voice(self) -> bool:
        """Whether the EA is VoiceXML."""
        return self.ea.startswith("<vxml")

    def write(self, folder: Path) -> tuple[Path, Path, Path]:
        """Write all files; gives those of FA, EA and scenario."""
        fa, scenario = folder / "mine.xml", folder / "scenario.xml"
        ea = folder / ("theirs.vxml" if self.voice else "theirs.xml")
        fa.write_text(self.fa)
        ea.write_text(self.ea)
        (folder / "more.vxml").write_text(self.more)
        scenario.write_text(self.scenario.format(ea=ea.name))
        return fa, ea, scenario


def pair(seed: int) -> Pair:
    """The pair of a number; every fourth is as slow as its certificate allows, or nearly so."""
    random = Random(seed)
    if seed % 4 == 0:
        return _slowest(seed, random)
    fa = _Dialogue(random, "fa", "mine").document()
    voice = random.random() < 0.4
    ea = _Voice(random) if voice else _Dialogue(random, "ea", "theirs")
    more = f"{VOICE}{ea.form('more')}</vxml>" if isinstance(ea, _Voice) else VOICE
    return Pair(seed, fa, ea.document(), more, _scenario(random))


class _Author:
    def __init__(self, random: Random) -> None:
        self.random = random
        self.forms = [f"f{number}" for number in range(random.randint(1, 3))]

    def maybe(self, chance: float) -> bool:
        return self.random.random() < chance

    def words(self) -> str:
        return " ".join(self.random.choices(WORDS, k=self.random.randint(1, 3))) + "."

    def motion(self, templates: tuple[str, ...] = MOTIONS) -> str:
        return self.random.choice(templates).format(
            angle=self.random.choice((-170, -20, 45, 180)),
            time=self.random.choice((300, 2500)),
            words=self.words(),
            place=self.random.choice(("door", "middle")),
        )


class _Dialogue(_Author):
    """Writes an application in PRIMA's own language."""

    def __init__(self, random: Random, kind: str, name: str) -> None:
        super().__init__(random)
        self.kind, self.name = kind, name

    def document(self) -> str:
        body = "".join(self.form(name) for name in self.forms)
        back = '<on event="touch"><return/></on>' if self.maybe(0.5) else ""
        body += f'<form id="sub"><block>{self.act()}<return/></block>{back}</form>'
        body += self.handlers(0.2) + TIMER.format(
            REACTIVE if self.maybe(0.2) else "", self.content()
        )
        return f"{HEAD.format(self.kind, self.name)}{body}</prima>"

    def form(self, name: str) -> str:
        least = 0 if self.kind == "fa" else 1
        items = "".join(self.item(f"i{number}") for number in range(self.random.randint(least, 3)))
        hold = ' stream="hold" hold-for="3s"' if self.maybe(0.1) else ""
        return f'<form id="{name}"{hold}>{items}{self.handlers(0.45)}</form>'

    def item(self, name: str) -> str:
        kind = self.random.random()
        if kind < 0.3:
            return self.field(name)
        if kind < 0.37:
            return f'<subdialog name="{name}" src="#sub"/>'
        if kind < 0.48:
            inner = f"<block>{self.calm()}</block>" + (
                self.field(f"u{name}") if self.maybe(0.5) else ""
            )
            return f'<iu longest="{self.random.choice((4, 30))}s">{inner}</iu>'
        return f"<block>{self.content()}</block>"

    def field(self, name: str) -> str:
        timeout = self.random.choice(("1s", "3s"))
        barge = self.random.choice(("", ' bargein="false"'))
        prompts = f'<prompt timeout="{timeout}"{barge}>{self.words()}</prompt>'
        if self.maybe(0.3):
            prompts += f'<prompt count="2">{self.words()}</prompt>'
        told = f"<filled>{self.calm() if self.maybe(0.5) else ''}</filled>"
        if self.maybe(0.6):
            leave = f'<goto next="#{self.random.choice(self.forms)}"/>'
            told += f'<noinput count="2">{leave}</noinput><nomatch>{leave}</nomatch>'
        return f'<field name="{name}" type="boolean">{prompts}{told}</field>'

    def calm(self) -> str:
        """What may stand in a unit."""
        quiet = MOTIONS[:4]
        return f"<speak>{self.words()}</speak>" if self.maybe(0.6) else self.motion(quiet)

    def content(self) -> str:
        made = "".join(self.act() for _ in range(self.random.randint(1, 3)))
        if self.maybe(0.3):
            made += f'<goto next="#{self.random.choice(self.forms)}"/>'
        elif self.maybe(0.15):
            made += "<exit/>"
        return made

    def act(self) -> str:
        kind = self.random.random()
        if kind < 0.38:
            return f"<speak>{self.words()}</speak>"
        if kind < 0.6:
            return self.motion()
        if kind < 0.7:
            return f'<iu longest="{self.random.choice((2, 20))}s">{self.calm()}{self.calm()}</iu>'
        if kind < 0.78:
            return f"<par>{self.calm()}{self.calm()}</par>"
        if kind < 0.83:
            return f'<send event="late" delay="{self.random.choice((1, 9))}s"/>'
        if kind < 0.88:
            return f'<if cond="{self.random.choice(("true", "false"))}">{self.calm()}</if>'
        return self.motion(LOOPS)

    def handlers(self, chance: float) -> str:
        found = [name for name in EVENTS if self.maybe(chance if self.kind == "fa" else chance / 3)]
        made = "".join(f'<on event="{name}">{self.content()}</on>' for name in found)
        if self.maybe(0.1):
            own = self.random.choice(OWN)
            made += f'<on event="{own}"{REACTIVE}>{self.content()}</on>'
        return made


class _Voice(_Author):
    """Writes a VoiceXML application that moves the robot."""

    def document(self) -> str:
        body = "".join(self.form(name) for name in self.forms)
        if self.maybe(0.3):
            event = self.random.choice(EVENTS)
            body += f'<catch event="{event}">{self.content()}</catch>'
        return f"{VOICE}{body}</vxml>"

    def form(self, name: str) -> str:
        items = [f"<block>{self.content()}</block>"]
        if self.maybe(0.7):
            items.append(self.field())
        if self.maybe(0.2):
            items.append(
                f'<record name="r" maxtime="4s" finalsilence="1s" beep="true">{self.words()}</record>'
            )
        if self.maybe(0.2):
            items.append('<subdialog name="s" src="more.vxml"/>' if name != "more" else "")
        self.random.shuffle(items)
        if self.maybe(0.3):
            items.insert(self.random.randint(0, len(items)), self.unit())
        end = "<return/>" if name == "more" else self.goto()
        return f'<form id="{name}">{"".join(items)}<block>{end}</block></form>'

    def unit(self) -> str:
        """A unit around form items (U5)."""
        items = [f"<block>{self.still()}</block>"]
        if self.maybe(0.7):
            items.append(self.field("u"))
        if self.maybe(0.2):
            items.append(f'<catch event="{self.random.choice(EVENTS)}">{self.still()}</catch>')
        self.random.shuffle(items)
        return f'<p:iu longest="{self.random.choice((2, 20))}s">{"".join(items)}</p:iu>'

    def still(self) -> str:
        """Content that may stand in a unit."""
        return "".join(
            self.random.choice((self.words, lambda: prefixed(self.motion(MOTIONS[:4]))))()
            for _ in range(self.random.randint(1, 3))
        )

    def goto(self) -> str:
        return f'<goto next="#{self.random.choice(self.forms)}"/>' if self.maybe(0.5) else ""

    def field(self, name: str = "q") -> str:
        asked = self.prompt() if name == "q" else self.words()  # a unit holds no loops
        prompt = f'<prompt timeout="2s">{asked}</prompt>'
        leave = "<exit/>"
        handlers = ""
        if self.maybe(0.6):
            handlers = f'<noinput count="2">{self.words()}{leave}</noinput>'
            handlers += f"<nomatch>{self.words()}<reprompt/></nomatch>"
        said = f"<filled>{self.words()}</filled>"
        return f'<field name="{name}" type="boolean">{prompt}{said}{handlers}</field>'

    def prompt(self) -> str:
        parts = [self.words()]
        if self.maybe(0.4):
            parts.append(self.command())
        if self.maybe(0.3):
            parts.append('<break time="700ms"/>')
        if self.maybe(0.3):
            parts.append(f'<prosody rate="50%">{self.words()}</prosody>')
        self.random.shuffle(parts)
        return " ".join(parts)

    def command(self) -> str:
        return prefixed(self.motion() if self.maybe(0.85) else self.motion(LOOPS[:1]))

    def content(self) -> str:
        kinds = (lambda: f"<prompt>{self.prompt()}</prompt>", self.words, self.command)
        return "".join(self.random.choice(kinds)() for _ in range(self.random.randint(1, 3)))


def prefixed(made: str) -> str:
    """Commands of PRIMA's language as they stand in VoiceXML."""
    return made.replace("</", "</p:").replace("<", "<p:").replace("<p:/p:", "</p:")


def _slowest(seed: int, random: Random) -> Pair:
    """A reaction that comes just after the other has begun, and is passed by further events.

    Applications do nothing else, so that nothing makes the certificate wider than the run.
    """
    mine, theirs = random.choice(SHARED)
    angle, words = random.choice((-170, 45, 90, 180)), random.choice(WORDS)
    acts = [text.format(angle=angle, words=words) for text in theirs]
    handlers = "".join(
        f'<on event="{name}">{"".join(random.choices(acts, k=random.randint(1, 2)))}</on>'
        for name in ("touch", "message")
    )
    event, doing = random.choice((("bell", BELL), ("touch", TOUCH)))
    whens = []
    for begun in range(2000, 60000, 15000):
        doings = [(begun, MESSAGE), (begun + random.randint(1, 30), doing)]
        for _ in range(random.choice((0, 2, 6))):
            doings.append((begun + random.randint(50, 1200), random.choice((TOUCH, MESSAGE))))
        whens += [f'<when at="{at}ms">{doing}</when>' for at, doing in doings]
    before = random.choice(BEFORE)
    fa = f'{HEAD.format("fa", "mine")}<form id="f"><on event="{event}">{before}{mine}</on></form></prima>'
    ea = f'{HEAD.format("ea", "theirs")}<form id="f">{handlers}</form></prima>'
    return Pair(seed, fa, ea, VOICE, _staged(whens, PLACES[0]))


def _scenario(random: Random) -> str:
    """What the user and the surroundings do to both."""
    whens = []
    for _ in range(random.randint(5, 14)):
        doing = random.choice(
            (
                TOUCH,
                TOUCH,
                MESSAGE,
                BELL,
                "<say>yes</say>",
                "<say>this is not what was asked for</say>",
            )
        )
        whens.append(f'<when at="{random.randint(0, 40000)}ms">{doing}</when>')
    return _staged(whens, random.choice(PLACES))


def _staged(whens: list[str], place: str) -> str:
    """A scenario for both, with a person at a place."""
    folder = DOCUMENTS.as_posix()
    return (
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="70s"'
        f' world="{folder}/worlds/room.xml" robot="{folder}/robots/papero.xml">'
        f'<robot at="middle"/><person {place}/>'
        '<application src="mine.xml" kind="fa"/><application src="{ea}" id="theirs"/>'
        f"{''.join(whens)}</scenario>"
    )
