"""Documents that want more than they may have, each run beside an honest application.

:data:`ATTACKS` has them by family; :func:`attempt` makes one run in a process of its own and tells
what became of it. ``make attack`` tries them all, the tests one of each family.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

LONGEST_SECONDS = 60.0
"""How much of the processor a run and its engines may take together."""
HANGS_SECONDS = 600.0
"""How long a run may take before it counts as hanging: on a loaded machine it waits for its turn."""
HONEST = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="honest">
<form id="f"><block><send event="late" delay="30s"/></block>
<on event="late"><log><value expr="[1, 2, 3].length"/> alive</log><exit/></on></form></prima>"""
"""Has a script itself, and tells half a minute later that it is still there."""

FLAT = "var a = []; for (var i = 0; i < 45; i++) a = [a, a];"
SPARSE = "var a = []; a[4294967294] = 1;"
ENDLESS = (
    "var e = {[Symbol.iterator]() { return this; }, next() { return {done: false, value: {}}; }};"
)
LONG = "var s = 'x'.repeat(4000000);"

SCRIPTS: dict[str, list[str]] = {
    "arrays": [
        f"{FLAT} a.flat(Infinity)", f"{FLAT} a.toString()", f"{FLAT} a.join()",
        f"{FLAT} [].concat(...a.flat(20))", f"{SPARSE} a.concat(a)", f"{SPARSE} a.reverse()",
        f"{SPARSE} a.sort()", f"{SPARSE} a.indexOf(2)", f"{SPARSE} a.includes(2)",
        f"{SPARSE} a.fill(0)", f"{SPARSE} a.copyWithin(1, 0)", f"{SPARSE} a.splice(0, 1)",
        f"{SPARSE} a.join('')", f"{SPARSE} a.flat()", f"{SPARSE} a.toSorted()", f"{SPARSE} a.with(1, 2)",
        "Array.from({length: 4294967295})", "Array.prototype.join.call({length: 1e15}, '')",
        "Array.prototype.map.call({length: 2 ** 53 - 1}, (x) => x)",
        "Array.prototype.every.call({length: 2 ** 53 - 1}, () => true)",
        "Array.prototype.unshift.call({length: 2 ** 53 - 2}, 1)",
        "var b = Array(1000000); for (var i = 0; i < 1e6; i++) b.concat(b)",
        "var b = Array(1e6).fill(0); b.sort(() => { b.length = 0; b.length = 1e6; return 1; })",
    ],
    "iterators": [
        f"{ENDLESS} [...e]", f"{ENDLESS} new Set(e)", f"{ENDLESS} new Map(e)", f"{ENDLESS} Array.from(e)",
        f"{ENDLESS} Object.fromEntries(e)", f"{ENDLESS} Math.max(...e)", f"{ENDLESS} Promise.all(e)",
        f"{ENDLESS} for (var x of e);", f"{ENDLESS} Iterator.from(e).drop(1e15).next()",
        f"{ENDLESS} Iterator.from(e).reduce((x, y) => x)", f"{ENDLESS} Iterator.from(e).every(() => true)",
        f"{ENDLESS} Object.groupBy(e, () => 1)", f"{ENDLESS} Iterator.from(e).toArray()",
        f"{ENDLESS} new Set([1]).union({{size: 9, has() {{}}, keys() {{ return e; }}}})",
        f"{ENDLESS} new Set([1]).isSupersetOf({{size: 0, has() {{}}, keys() {{ return e; }}}})",
        "var t = new Set(); for (var i = 0; i < 2e5; i++) t.add(i); for (;;) t.symmetricDifference(t)",
    ],
    "texts": [
        f"{FLAT} JSON.stringify(a)", f"{LONG} s.indexOf({{toString() {{ return s.slice(9) + 'y'; }}}})",
        f"{LONG} s.split(s.slice(0, 2000000) + 'y')", f"{LONG} s.replaceAll(s.slice(0, 2e6) + 'y', '')",
        f"{LONG} s.lastIndexOf(s.slice(0, 2000000) + 'y')", f"{LONG} for (;;) s.localeCompare(s + 'y')",
        f"{LONG} for (;;) s.normalize('NFKD')", f"{LONG} for (;;) s.toUpperCase()",
        "'x'.repeat(2 ** 29)", "'x'.padEnd(2 ** 29, 'ab')", "var s = 'x'; for (;;) s += s",
        "var s = 'x'.repeat(2e6), p = [s + 'a', s + 'b'], b = [];"
        "for (var i = 0; i < 2e5; i++) b.push(p[i % 2]); b.sort()",
        "/(a+)+$/.test('a'.repeat(40) + 'b')", "/(.*)*x/.exec('y'.repeat(100000))",
        "/(?=(a*)*b)/.test('a'.repeat(99999))", "JSON.parse('['.repeat(1e6))",
        "String.raw({raw: {length: 2 ** 53 - 1}})", "encodeURIComponent('\\u4e00'.repeat(3e6))",
    ],
    "compiling": [
        "eval('class A {' + 'x() {};'.repeat(100000) + '}')", "eval('1' + '+1'.repeat(1000000))",
        "new Function('return ' + '['.repeat(100000))", "eval('('.repeat(1000000))",
        "eval('var ' + Array.from({length: 200000}, (_, i) => 'v' + i).join())",
        "new RegExp('(a|'.repeat(50000) + ')'.repeat(50000))", "for (;;) new Function('x', 'return x')",
        "eval('`' + '${`'.repeat(20000) + '`}'.repeat(20000) + '`')",
    ],
    "loops": [
        "while (true);", "for (;;) Math.max()", "for (;;) [].flat()", "for (;;) ({}).toString()",
        "for (;;) 'ab'.split('')", "(function f() { f(); })()", "(function* () { for (;;) yield 1; })().next(); for (;;);",
        "throw {toString() { for (;;); }}", "throw {get message() { for (;;); }}", "+{valueOf() { for (;;); }}",
        "var g = {get a() { for (;;); }}; g.a", "2n ** (10n ** 10n)", "for (;;) try { null.x } catch (x) {}",
        "Promise.resolve().then(function f() { return Promise.resolve().then(f); }); for (;;);",
        "var o = {toJSON() { for (;;); }}; JSON.stringify(o)", "new Error('x', {get cause() { for (;;); }})",
    ],
    "memory": [
        "var b = []; for (;;) b.push('x'.repeat(1e6) + b.length)", "new Array(4e9).fill(0)",
        "var o = {}; for (var i = 0; ; i++) o['k' + i] = i", "var m = new Map(); for (var i = 0; ; i++) m.set(i, i)",
        "var f = () => 1; for (;;) f = ((g) => () => g)(f)", "var l = null; for (;;) l = {l: l}",
        "var b = []; for (;;) b.push(Symbol('x'))", "var b = [1]; for (;;) b = b.concat(b)",
    ],
}  # fmt: skip
"""Scripts by what they misuse."""


@dataclass(frozen=True)
class Attack:
    """Files of an application, the first of which is run as an EA, and what the user says."""

    family: str
    name: str
    files: dict[str, str]
    says: tuple[str, ...] = ()


@dataclass
class Outcome:
    """What became of a run."""

    exit: int
    seconds: float
    processor: float
    peak: float
    """MB of the largest process."""
    survived: bool
    """Whether the honest application went on, and the transcript is whole."""
    said: list[str] = field(default_factory=list)
    """Why applications ended."""

    @property
    def contained(self) -> bool:
        """Whether nobody but the attacker was hurt, and nothing hung or took too much."""
        clean = not any("Traceback" in one or "defect" in one for one in self.said)
        return self.survived and clean and self.processor < LONGEST_SECONDS and self.peak < 700


def document(content: str, head: str = "") -> str:
    """An EA whose only form has this content."""
    return (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="bad">'
        f'{head}<form id="f">{content}</form></prima>'
    )


def voice(content: str) -> str:
    """A VoiceXML document."""
    return f'<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1">{content}</vxml>'


def tagged(code: str) -> str:
    """A question whose grammar has a tag."""
    srgs = 'xmlns="http://www.w3.org/2001/06/grammar" version="1.0" mode="voice" root="r"'
    return voice(
        f'<form id="f"><field name="x"><prompt>Say it.</prompt><grammar {srgs}'
        f' tag-format="semantics/1.0"><rule id="r">yes<tag>{escape(code)}</tag></rule></grammar></field></form>'
    )


def _scripts() -> Iterator[Attack]:
    for family, codes in SCRIPTS.items():
        for number, code in enumerate(codes):
            text = document(f"<block><script>{escape(code)}</script><exit/></block>")
            yield Attack(family, f"script {number + 1}", {"bad.xml": text})
    for number, code in enumerate(
        [SCRIPTS["arrays"][0], SCRIPTS["loops"][0], SCRIPTS["memory"][0]]
    ):
        yield Attack("tags", f"tag {number + 1}", {"bad.vxml": tagged(code)}, ("yes",))
        expr = quoteattr(f"(function () {{ {code} }})()")
        text = voice(f"<form><block><value expr={expr}/></block></form>")
        yield Attack("expressions", f"VoiceXML value {number + 1}", {"bad.vxml": text})
        text = document(f"<block><if cond={expr}><log>x</log></if></block>")
        yield Attack("expressions", f"condition {number + 1}", {"bad.xml": text})


def _bytes() -> Iterator[Attack]:
    long = "<script>var s = 'x'.repeat(90000), l = 'x'.repeat(4000000), a = Array(10000).fill(l);</script>"
    params = "".join(f'<param name="p{i}" expr="s"/>' for i in range(25_000))
    names = " ".join(f"v{i}" for i in range(12_000))
    declared = "".join(f'<var name="v{i}" expr="s"/>' for i in range(12_000))
    each = '<foreach item="i" array="a"><assign name="n" expr="n + 1"/></foreach>'
    contents = {
        "foreach over one long text": f'<block>{each}<exit/></block>',
        "params of send": f'<block><send to="x">{params}</send><exit/></block>',
        "delayed events": '<block><foreach item="i" array="Array(250)"><send event="e" delay="20s">'
        '<param name="p" expr="s"/><param name="q" expr="s"/></send></foreach></block>',
        "arguments of Commands": '<block><foreach item="i" array="Array(9000)">'
        '<topological-move to-expr="s"/></foreach></block>',
    }  # fmt: skip
    for name, content in contents.items():
        yield Attack(
            "bytes", name, {"bad.xml": document(content, f'{long}<var name="n" expr="0"/>')}
        )
    sub = (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="bad">'
        f"{long}<form id='f'><subdialog name='d' src='#g'/></form>"
        f"<form id='g'>{declared}<block><return namelist='{names}'/></block></form></prima>"
    )
    yield Attack("bytes", "namelist of return", {"bad.xml": sub})
    text = voice(
        f"{long}<form>{declared}<block><submit next='service:x' namelist='{names}'/></block></form>"
    )
    yield Attack("bytes", "namelist of submit", {"bad.vxml": text})
    heard = "<script>var l = 'x'.repeat(90000);</script>"
    array = "Array.from({length: 9000}, function () { return l; })"
    text = voice(
        f"{heard}<form><block><foreach item='i' array=\"{array}\"><value expr='i'/></foreach></block></form>"
    )
    yield Attack("bytes", "values in a prompt", {"bad.vxml": text})
    breaks = '<value expr="s"/><break time="1ms"/>' * 20_000
    text = document(f"<block><speak>{breaks}</speak><exit/></block>", long)
    yield Attack("bytes", "values between pauses", {"bad.xml": text})
    say = '<block name="b"><speak><value expr="s"/></speak><clear/></block>'
    yield Attack("bytes", "says all it can", {"bad.xml": document(say, long)})
    log = '<block name="b"><foreach item="i" array="Array(9)"><log><value expr="s"/></log></foreach><pause time="60ms"/><clear/></block>'
    yield Attack("bytes", "logs all it can", {"bad.xml": document(log, long)})


def _work() -> Iterator[Attack]:
    item = (
        '<item repeat="0-"><one-of><item>a</item><item>a a</item><item>a a a</item></one-of></item>'
    )
    native = "".join(
        f'<link event="l{i}"><grammar root="r"><rule id="r">{item} z{i}</rule></grammar></link>'
        for i in range(1000)
    )
    srgs = 'xmlns="http://www.w3.org/2001/06/grammar" version="1.0" root="r"'
    voiced = native.replace('<grammar root="r">', f"<grammar {srgs}>")
    ask = '<field name="x"><prompt>?</prompt><option>q</option></field>'
    said = ("a " * 400,)
    yield Attack("work", "links", {"bad.xml": document(ask, native)}, said)
    form = f"<form>{ask}</form>"
    yield Attack("work", "links of VoiceXML", {"bad.vxml": voice(voiced + form)}, said)
    loop = '<form id="a"><block><goto next="#b"/></block></form><form id="b"><block><goto next="#a"/></block></form>'
    yield Attack("work", "dialogs without a wait", {"bad.vxml": voice(loop)})
    pages = {
        f"{one}.vxml": voice(f'<form><block><goto next="{other}.vxml"/></block></form>')
        for one, other in (("bad", "b"), ("b", "bad"))
    }
    yield Attack("work", "documents without a wait", pages)
    yield Attack(
        "work",
        "questions that time out at once",
        {"bad.vxml": voice('<form><field name="x" type="digits"><property name="timeout" value="1ms"/></field></form>')},
    )  # fmt: skip
    refused = '<block name="b"><gesture name="fly"/></block><on event="error"><clear/></on>'
    yield Attack("work", "a Command that is refused for ever", {"bad.xml": document(refused)})
    sums = " + ".join(["n"] * 90)
    many = "".join(f'<assign name="n" expr="{sums} - {i}"/>' for i in range(150))
    busy = (
        f'<block name="b"><foreach item="i" array="Array(120)">{many}</foreach>'
        "<pause time='60ms'/><clear/></block>"
    )
    yield Attack("work", "expressions", {"bad.xml": document(busy, '<var name="n" expr="0"/>')})
    array = ", ".join(["0"] * 90)
    plain = busy.replace('array="Array(120)"', f'array="[{array}]"')
    yield Attack(
        "work", "expressions in Python", {"bad.xml": document(plain, '<var name="n" expr="0"/>')}
    )
    events = '<block><send event="e" delay="1ms"/></block><on event="e"><log>x</log><send event="e" delay="1ms"/></on>'
    yield Attack("work", "events to itself", {"bad.xml": document(events)})
    nested = "<block>" + "<if cond='true'>" * 60 + "<log>x</log>" + "</if>" * 60 + "</block>"
    yield Attack("work", "deep content", {"bad.xml": document(nested)})


ATTACKS = [*_scripts(), *_bytes(), *_work()]
"""All of them."""


WATCH = """
import json, resource, subprocess, sys
process = subprocess.Popen(sys.argv[2:], stdout=subprocess.DEVNULL)
try:
    process.wait(float(sys.argv[1]))
except subprocess.TimeoutExpired:
    process.kill()
    process.wait()
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(json.dumps([process.returncode, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024]))
"""
"""Runs a command for a time and tells its exit code, its seconds of processor time and its MB.

It is a small process: the system counts the memory of the process that starts another as the
other's own.
"""


def attempt(attack: Attack, folder: Path) -> Outcome:
    """Run an attack beside the honest application, in a process of its own."""
    (folder / "honest.xml").write_text(HONEST)
    for name, text in attack.files.items():
        (folder / name).write_text(text)
    says = [part for said in attack.says for part in ("--say", said)]
    applications = ["--fa", "honest.xml", "--ea", next(iter(attack.files))]
    command = [sys.executable, "-m", "prima", "run", *applications, *says, "-o", "t.jsonl"]
    began = time.monotonic()
    watched = [sys.executable, "-c", WATCH, str(HANGS_SECONDS), *command]
    ran = subprocess.run(watched, cwd=folder, capture_output=True, text=True, check=True)
    seconds = time.monotonic() - began
    code, processor, peak = json.loads(ran.stdout)
    records = _records(folder / "t.jsonl")
    logs = [one.get("message", "") for one in records if one.get("app") == "honest"]
    whole = bool(records) and records[-1].get("phase") == "over"
    return Outcome(
        code,
        seconds,
        processor,
        peak,
        whole and "3 alive" in logs,
        ran.stderr.splitlines(),
    )


def _records(path: Path) -> list[dict[str, str]]:
    if not path.exists():
        return []
    with open(path, encoding="utf-8") as lines:
        return [json.loads(line) for line in lines if line.endswith("\n")]
