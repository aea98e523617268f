"""Validate and run mutated and generated documents; tell what failed otherwise than it may.

``python -m bench.fuzz mutated 100000 [SEED]`` breaks the shipped documents in one to four places;
``python -m bench.fuzz generated 100000 [SEED]`` puts their elements together at random. Each document
is validated and, if nothing forbids it, run beside an application of the other kind, on one of the
shipped robots and under one of the policies, each in turn.
Faults of PRIMA itself (a traceback, a defect, a run that takes too long) are kept in
``build/fuzz``.
"""

from __future__ import annotations

import os
import random
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path

from lxml import etree

from prima import api
from prima.errors import PrimaError
from prima.pool import cores, spread

ROOT = Path(__file__).parent.parent
KEPT = ROOT / "build" / "fuzz"
SHARE = 200
"""Documents that a process makes at once."""
SLOW_SECONDS = 2.0
"""How long a processor may work for a document, with its engines."""
PIECES = (
    "<", ">", "/>", '"', "&", "]]>", "<!--", "&#0;", "&#x10FFFF;", "\u202e", "\x1b[2J", "#", "..", "%00",
    "-1", "0", "1e400", "NaN", "99999999999999999999", "''", "a.b.c", "(", ")", "{}", "[]", "null",
    "<speak>x</speak>", "<par/>", "<seq/>", "<iu/>", "<iu><field name='x'/></iu>", "<goto next='#a'/>",
    "<exit/>", "<clear/>", "<reprompt/>", "<throw event='e'/>", "<on event='e'><goto next='#a'/></on>",
    "<watch name='w' when='sensor.a.b &lt; 1'/>", "<send event='e' delay='1ms'/>", "<script>x</script>",
    "<script>while(1);</script>", "<pause time='0s'/>", "<stop-moving/>", "<face-human/>",
    "<topological-move to='lab'/>", "<gesture name='bow'/>", "<field name='f'><prompt>?</prompt></field>",
    "<subdialog name='s' src='#a'/>", "<return/>", "<option>q</option>", " order='now'", " id='a'", " cond='x'",
)  # fmt: skip
"""The values put in."""
FILES = sorted(
    path
    for folder in ("fa", "ea", "scenarios", "worlds", "robots")
    for path in (ROOT / "documents" / folder).rglob("*")
    if path.suffix in (".xml", ".vxml")
)


ROBOTS = sorted(path.name for path in (ROOT / "documents" / "robots").glob("*.xml"))
"""The bodies on which applications run, most of which lack something."""
POLICIES = ("prima", "prima+all", "fifo", "none", "fair")


def mutated(chance: random.Random) -> tuple[Path, str]:
    """A shipped document, changed in its letters or in its elements."""
    path = chance.choice(FILES)
    text = path.read_text(encoding="utf-8")
    return path, (_letters if chance.random() < 0.3 else _tree)(chance, text)


def _letters(chance: random.Random, text: str) -> str:
    """A text with something put in, taken out, doubled or moved."""
    for _ in range(chance.randint(1, 3)):
        start = chance.randrange(len(text))
        end = min(start + chance.choice((0, 1, 3, 10, 40, 200)), len(text))
        how = chance.random()
        if how < 0.5:
            text = text[:start] + chance.choice(PIECES) + text[end:]
        elif how < 0.7:
            text = text[:start] + text[end:]
        elif how < 0.85:
            text = text[:end] + text[start:end] + text[end:]
        else:
            place = chance.randrange(len(text))
            text = text[:place] + text[start:end] + text[place:]
    return text


def _above(one: etree._Element) -> etree._Element:
    """The parent of an element."""
    above = one.getparent()
    assert above is not None
    return above


def _tree(chance: random.Random, text: str) -> str:
    """A document whose elements and attributes are taken out, doubled, moved or exchanged."""
    root = etree.fromstring(text.encode())
    for _ in range(chance.randint(1, 4)):
        inner = [one for one in root.iter(etree.Element) if one is not root]
        if not inner:
            break
        one, other = chance.choice(inner), chance.choice(inner)
        above = _above(one)
        match chance.randrange(6):
            case 0:
                above.remove(one)
            case 1:
                above.insert(chance.randint(0, len(above)), deepcopy(one))
            case 2:
                _above(other).insert(0, deepcopy(one))
            case 3 if one.attrib:
                del one.attrib[chance.choice(list(one.attrib))]
            case 4 if one.attrib and other.attrib:
                name = chance.choice(list(one.attrib))
                one.set(name, chance.choice([*other.attrib.values(), *VALUES]))
            case _:
                one.text = chance.choice(VALUES)
    return etree.tostring(root, encoding="unicode")


VALUES = (
    "", "0", "-1", "1e400", "NaN", "null", "''", "a.b.c", "x", "true", "0s", "1ms", "86400s", "#a", "#", "..",
    "%00", "touch", "end.speak", "event.data.x", "n + 1", "sensor.a.b < 1", "[1, [2]]", "({}).x.y", "(", "while",
    "(function () { throw 1; })()", "'x'.repeat(1e6)", "lab", "yes", "speaker", "99999999999999999999",
)  # fmt: skip
"""Values of attributes and variables."""


def generated(chance: random.Random) -> tuple[Path, str]:
    """A document whose elements are where they may be, and lead anywhere."""
    kind = chance.choice(("fa", "ea"))
    forms = "".join(f'<form id="{name}">{_form(chance)}</form>' for name in "abc")
    top = "".join(
        f'<var name="{name}" expr="{chance.choice(EXPRESSIONS)}"/>' for name in ("n", "xs", "o")
    )
    handlers = "".join(_handler(chance) for _ in range(chance.randint(0, 3)))
    watch = (
        f'<watch name="w" when="{chance.choice(EXPRESSIONS)}"/>' if chance.random() < 0.3 else ""
    )
    head = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="made">'
    return ROOT / "documents" / kind / "made.xml", f"{head}{top}{watch}{handlers}{forms}</prima>"


EXPRESSIONS = (
    "1", "n + 1", "xs", "[1, 2, 'x']", "({a: [1]})", "o.a.b", "sensor.light &lt; 3", "xs.length", "'&#233;' + n",
    "Math.max(n, 1)", "session.time", "xs.map(function (x) { return x + 1; })", "event.name", "typeof n", "NaN", "n == 3",
    "true", "false", "JSON.stringify(o)", "(function f() { return f(); })()", "undefined", "n &gt; 2 ? 'a' : xs[0]",
)  # fmt: skip
EVENTS = (
    "touch",
    "touch.head",
    "end.speak",
    "error",
    "noinput",
    "nomatch",
    "w",
    "mine",
    "suspended",
    "interrupted",
)


def _form(chance: random.Random) -> str:
    made = []
    for number in range(chance.randint(0, 4)):
        match chance.randrange(5):
            case 0 | 1:
                made.append(f'<block name="b{number}">{_content(chance)}</block>')
            case 2:
                made.append(_field(chance, number))
            case 3:
                made.append(f"<iu>{_field(chance, number)}</iu>")
            case _:
                made.append(f'<subdialog name="s{number}" src="#{chance.choice("abc")}"/>')
    return "".join([*made, *(_handler(chance) for _ in range(chance.randint(0, 2)))])


def _field(chance: random.Random, number: int) -> str:
    return (
        f'<field name="f{number}"><prompt timeout="{chance.choice(("0s", "1s", "5s"))}">Well?</prompt>'
        f"<option>yes</option><filled>{_content(chance)}</filled></field>"
    )


def _handler(chance: random.Random) -> str:
    return f'<on event="{chance.choice(EVENTS)}">{_content(chance)}</on>'


def _content(chance: random.Random, depth: int = 0) -> str:
    return "".join(_act(chance, depth) for _ in range(chance.randint(0, 3)))


def _act(chance: random.Random, depth: int) -> str:
    expr, event = chance.choice(EXPRESSIONS), chance.choice(EVENTS)
    simple = (
        "<speak>Hello there.</speak>", f'<speak><value expr="{expr}"/></speak>', "<face-human/>", "<stop-moving/>",
        '<gesture name="bow"/>', '<move-head pan="30"/>', f'<log expr="{expr}"/>', f'<assign name="n" expr="{expr}"/>',
        f'<throw event="{event}"/>', f'<goto next="#{chance.choice("abc")}"/>', "<exit/>", "<clear/>", "<reprompt/>",
        f'<send event="mine" delay="{chance.choice(("0s", "1ms", "2s"))}"><param name="p" expr="{expr}"/></send>',
        '<send to="x"/>', '<pause time="500ms"/>', f'<speak order="now">{event}</speak>', "<par/>", "<seq/>",
        f"<script>xs = {expr}; var v{depth} = n;</script>", f'<var name="v" expr="{expr}"/>', "<return/>",
        '<topological-move to-expr="n"/>', '<turn angle="90"/>',
    )  # fmt: skip
    if depth > 2 or chance.random() < 0.75:
        return chance.choice(simple)
    inner = _content(chance, depth + 1)
    return chance.choice(
        (
            f'<if cond="{expr}">{inner}<else/>{inner}</if>',
            f'<foreach item="i" array="{expr}">{inner}</foreach>',
            "<par><speak>One.</speak><seq><face-human/><gesture name='bow'/></seq></par>",
            "<iu><speak>Two.</speak><turn angle='-90'/></iu>",
        )
    )


def attempt(path: Path, text: str, documents: Path, number: int) -> str:
    """Validate and run a document; ``fine``, ``refused``, ``ended`` or what went wrong.

    ``documents`` is a copy of the shipped ones, in which it takes the place of its original;
    by its ``number`` it has its robot and its policy.
    """
    tried = documents / path.relative_to(ROOT / "documents")
    original = path.read_bytes() if path.exists() else b""
    tried.write_bytes(text.encode("utf-8", "surrogatepass"))
    began = _worked()
    try:
        robot = documents / "robots" / ROBOTS[number % len(ROBOTS)]
        policy = POLICIES[number // len(ROBOTS) % len(POLICIES)]
        made = api.rehearse(_run_of(tried, documents, robot), policy, keep=False)
    except PrimaError:
        return "refused" if _worked() - began < SLOW_SECONDS else "slow (refused)"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    finally:
        tried.write_bytes(original)
    if made.defects:
        return f"defect: {made.defects[0]!r}"
    if _worked() - began > SLOW_SECONDS:
        return f"slow ({'ended' if made.failures else 'fine'})"
    return "ended" if made.failures else "fine"


def _worked() -> float:
    """Seconds of processor time of this process and of those that it has seen end."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _run_of(tried: Path, documents: Path, robot: Path) -> api.Loaded:
    """A run in which a document is needed."""
    folder = tried.relative_to(documents).parts[0]
    if folder == "scenarios":
        return api.load_scenario(tried)
    if folder in ("fa", "ea"):
        pair = {"fa": documents / "fa" / "follow.xml", "ea": documents / "ea" / "library.xml"}
        pair[folder] = tried
        return api.stage([str(pair["fa"])], [str(pair["ea"])], ["yes", "a"], robot=str(robot))
    return api.load_scenario(documents / "scenarios" / "follow-during-navigation.xml")


def several(job: tuple[str, int]) -> Counter[str]:
    """Try some documents, by their seed."""

    how, seed = job
    found: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        documents = Path(folder) / "documents"
        shutil.copytree(ROOT / "documents", documents)
        for number in range(SHARE):
            chance = random.Random(f"{how} {seed} {number}")
            path, text = (mutated if how == "mutated" else generated)(chance)
            result = attempt(path, text, documents, number)
            if result not in ("fine", "refused", "ended"):
                KEPT.mkdir(parents=True, exist_ok=True)
                (KEPT / f"{how}-{seed}-{number}-{path.name}").write_text(
                    f"<!-- {result} -->\n{text}", encoding="utf-8", errors="surrogateescape"
                )
                result = result[:60]
            found[result] += 1
    return found


def jobs(how: str, count: int, seed: int) -> Iterator[tuple[str, int]]:
    """As many shares as there are documents."""
    for share in range(-(-count // SHARE)):
        yield how, seed + share


def main() -> None:
    """Try documents and count what became of them."""
    how, count = sys.argv[1], int(sys.argv[2])
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    total: Counter[str] = Counter()
    from bench import fuzz  # processes of their own find its functions by this name

    for job, found in spread(fuzz.several, jobs(how, count, seed), cores()):
        total += found if isinstance(found, Counter) else Counter({f"died at {job}": SHARE})
        print(f"\r{total.total():,} {dict(total)}", end="", file=sys.stderr, flush=True)
    print()
    for what, number in total.most_common():
        print(f"{number:8,} {what}")


if __name__ == "__main__":
    main()
