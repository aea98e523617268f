"""Large documents, each of one thing many times: what takes longer than its size is found here.

``python -m bench.large [WORDS] [--bytes N]`` prints for each family the seconds of a validation at a
quarter, a half and the whole of that size, and the exponent with which they grow.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import linear_regression
from time import perf_counter

from bench.fresh import check, fresh

MOST_BYTES = 1_990_000
"""Nearly as much as PRIMA reads of one document."""


@dataclass(frozen=True)
class Family:
    """Documents of one kind, in which one piece comes again and again."""

    head: str
    piece: Callable[[int, int], str]
    """The piece of a number, where there are so many."""
    foot: str
    suffix: str = ".xml"

    def text(self, size: int) -> str:
        """A document of about that many bytes."""
        number = max(size // len(self.piece(123_455, 10**6).encode()), 2)
        body = "".join(self.piece(index, number) for index in range(number))
        return f"{self.head}{body}{self.foot}"


FORM = '<form id="last"><block><exit/></block></form>\n'


def _ours(piece: Callable[[int, int], str], before: str = "", after: str = "") -> Family:
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="large" xml:lang="en">\n'
    return Family(head + before, piece, f"{after}</prima>\n")


def _inside(tags: str, piece: Callable[[int, int], str], before: str = "") -> Family:
    """An application with the pieces inside nested elements, such as ``form block``."""
    names = tags.split()
    opened = "".join(
        {"form": '<form id="f">', "field": '<field name="a">', "on": '<on event="e">'}.get(
            name, f"<{name}>"
        )
        for name in names
    )
    closed = "".join(f"</{name}>" for name in reversed(names))
    return _ours(piece, before + opened, closed)


def _voice(piece: Callable[[int, int], str], before: str = "", after: str = "") -> Family:
    head = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">\n'
    return Family(head + before, piece, f"{after}</vxml>\n", ".vxml")


def _world(piece: Callable[[int, int], str]) -> Family:
    head = '<world xmlns="urn:prima:world:1" version="1.0" id="large">\n<place id="start" x="0" y="0"/>'
    return Family(head, piece, "</world>\n")


def _scenario(piece: Callable[[int, int], str]) -> Family:
    folder = Path(__file__).parent.parent / "documents"
    head = (
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="large"'
        f' world="{folder}/worlds/office.xml" robot="{folder}/robots/papero.xml">\n'
        f'<robot at="entrance"/><person x="0.9" y="0.5"/><application src="{folder}/ea/guide.xml"/>\n'
    )
    return Family(head, piece, "</scenario>\n")


def _grammar(piece: Callable[[int, int], str], before: str = "", after: str = "") -> Family:
    head = '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en" root="r0">\n'
    return Family(head + before, piece, f"{after}</grammar>\n", ".grxml")


FAMILIES: dict[str, Family] = {
    # The applications of our own language
    "undeclared names": _inside("form block", lambda i, n: f'<assign name="v{i}" expr="w{i}"/>\n'),
    "undeclared names in expressions": _ours(lambda i, n: f'<var name="v{i}" expr="w{i} + v{i}"/>\n', after=FORM),
    "declared names": _ours(lambda i, n: f'<var name="v{i}" expr="v{max(i - 1, 0)}"/>\n'),
    "forms with gotos": _ours(
        lambda i, n: f'<form id="f{i}"><block><goto next="#f{(i + 1) % n}"/></block></form>\n'
    ),
    "forms with gotos to nothing": _ours(
        lambda i, n: f'<form id="f{i}"><block><goto next="#g{i}"/></block></form>\n'
    ),
    "forms that ask": _ours(
        lambda i, n: f'<form id="f{i}"><field name="a" type="boolean"><prompt>Go to {i}?</prompt>'
        f'<filled><goto next="#f{(i + 1) % n}"/></filled></field></form>\n'
    ),
    "forms with handlers that go on": _ours(
        lambda i, n: f'<form id="f{i}"><block><speak>A</speak><goto next="#f{min(i + 1, n - 1)}"/></block>'
        f'<on event="touch.head"><goto next="#f{min(i + 1, n - 1)}"/></on></form>\n'
    ),
    "forms beside handlers": _ours(
        lambda i, n: f'<form id="f{i}"><block><speak>A</speak><exit/></block></form>'
        f'<on event="touch.s{i}"><goto next="#f{i}"/></on>\n'
    ),
    "forms with handlers that go on anywhere": _ours(
        lambda i, n: f'<form id="f{i}"><block><speak>A</speak><goto next-expr="v{i}"/></block>'
        f'<on event="touch.head"><goto next-expr="w{i}"/></on></form>\n'
    ),
    "forms with handlers that go on to any of many": _ours(
        lambda i, n: f'<form id="f{i}"><block><speak>A</speak></block>'
        f"""<on event="touch.head"><goto next-expr="'f{i // 10}' + v"/></on></form>\n"""
    ),
    "forms with handlers that go on by subdialogs": _ours(
        lambda i, n: f'<form id="f{i}"><subdialog name="s" src="#f{min(i + 1, n - 1)}"/><block><speak>A</speak><return/></block>'
        f'<on event="touch.head"><goto next="#f{min(i + 1, n - 1)}"/></on></form>\n', after='<form id="last"><block><return/></block></form>'
    ),
    "forms in a ring beside handlers that go on": _ours(
        lambda i, n: f'<form id="f{i}"><block><speak>A</speak><goto next="#f{(i + 1) % n}"/></block></form>'
        f'<on event="touch.s{i}"><goto next="#f{i}"/></on>\n'
    ),
    "handlers that go to items": _inside("form", lambda i, n: f'<block name="b{i}"/>'
        f'<on event="touch.s{i}"><clear namelist="b{n - 1 - i}"/><goto nextitem="b{i}"/></on>\n'
    ),
    "handlers of the document that go to items": _ours(
        lambda i, n: f'<form id="f{i}"><block name="b"/></form>'
        f'<on event="touch.s{i}"><clear/><goto nextitem="b"/></on>\n'
    ),
    "reactions to own events": _ours(
        lambda i, n: '<on event="end.speak" reactive="true"><speak>A</speak></on>\n', after=FORM
    ),
    "reactions to own events beside forms": _ours(
        lambda i, n: f'<on event="end.speak" reactive="true"><speak>A</speak></on><form id="f{i}"><block/></form>\n'
    ),
    "reactions that lead on": _ours(
        lambda i, n: f'<on event="e{i}" reactive="true"><throw event="e{(i + 1) % n}"/></on>\n', after=FORM
    ),
    "Commands in a unit": _inside("form block iu", lambda i, n: "<speak>A</speak>\n"),
    "names of a filled": _inside("form", lambda i, n: ('<filled namelist="' if i == 0 else "") + f"a{i} " + ('"/>' if i == n - 1 else "")),
    "names of a clear": _inside("form block", lambda i, n: ('<clear namelist="' if i == 0 else "") + f"a{i} " + ('"/>' if i == n - 1 else "")),
    "items with subdialogs": _inside("form", lambda i, n: f'<subdialog name="s{i}" src="#last"/><filled namelist="s{i}"><log>A</log></filled>\n',
        '<on event="touch"><goto next="#f"/></on>' + FORM.replace("exit", "return")
    ),
    "subdialogs": _ours(
        lambda i, n: f'<form id="f{i}"><subdialog name="s" src="#f{(i * 7 + 1) % n}"/><block><return/></block></form>\n'
    ),
    "unknown elements": _inside("form block", lambda i, n: "<nothing/>\n"),
    "unknown elements of many names": _inside("form block", lambda i, n: f"<nothing{i}/>\n"),
    "unknown attributes": _inside("form block", lambda i, n: f'<speak a{i}="1">A</speak>\n'),
    "let": _inside("form block", lambda i, n: f'<script>let v{i} = {i};</script>\n'),
    "let in one script": _inside("form block script", lambda i, n: f"let v{i} = {i};\n"),
    "statements in one script": _inside("form block script", lambda i, n: f"v{i} = w{i} + 1;\n"),
    "functions in one script": _inside("form block script", lambda i, n: f"function f{i}(a) {{ return a + f{max(i - 1, 0)}(1); }}\n"),
    "scripts": _ours(lambda i, n: f"<script>function g{i}(x) {{ return x; }}</script>\n"),
    "Commands": _inside("form block", lambda i, n: f"<speak>This is number {i}.</speak>\n"),
    "Commands with values": _inside("form block", lambda i, n: f'<speak>Number <value expr="{i} + 1"/>.</speak>\n'),
    "Commands in a par": _inside("form block par", lambda i, n: f'<move-head pan="{i % 20}"/>\n'),
    "pars": _inside("form block", lambda i, n: '<par><move-head pan="20"/><speak>Yes.</speak></par>\n'),
    "units": _inside("form block", lambda i, n: f"<iu><speak>Number {i}.</speak></iu>\n"),
    "units around items": _inside("form", lambda i, n: f"<iu><block><speak>Number {i}.</speak></block></iu>\n"),
    "blocks": _inside("form", lambda i, n: f"<block><speak>Number {i}.</speak></block>\n"),
    "variables of blocks": _inside("form", lambda i, n: f'<block><var name="v{i}" expr="1"/><log expr="v{i}"/></block>\n'),
    "variables of other blocks": _inside("form", lambda i, n: f'<block><var name="v{i}" expr="1"/><log expr="v{max(i - 1, 0)}"/></block>\n'),
    "fields": _inside("form", lambda i, n: f'<field name="a{i}" type="boolean"><prompt>Is it {i}?</prompt></field>\n'),
    "options": _inside("form field", lambda i, n: f"<option>number {i}</option>\n", "" ),
    "items of a grammar": _inside("form field grammar one-of", lambda i, n: f"<item>number {i}</item>\n"),
    "grammars": _inside("form", lambda i, n: f'<field name="a{i}"><grammar><item>number {i}</item></grammar></field>\n'),
    "prompts": _inside("form field", lambda i, n: f'<prompt count="{i + 1}">Is it {i}?</prompt>\n'),
    "handlers": _inside("form", lambda i, n: f'<on event="e{i}"><speak>Yes.</speak></on>\n'),
    "handlers of one event": _inside("form", lambda i, n: f'<on event="touch.head" cond="v == {i}"><speak>Yes.</speak></on>\n'),
    "handlers of the document": _ours(lambda i, n: f'<on event="e{i}"><speak>Yes.</speak></on>\n', after=FORM),
    "events sent": _inside("form block", lambda i, n: f'<send event="e{i}" delay="1s"/>\n'),
    "events thrown": _inside("form block", lambda i, n: f'<throw event="e{i}"/>\n'),
    "watches": _ours(lambda i, n: f'<watch when="sensor.s{i} == {i}" name="e{i}"/>\n'),
    "links": _ours(lambda i, n: f'<link event="e{i}"><grammar><item>number {i}</item></grammar></link>\n'),
    "links to forms": _ours(lambda i, n: f'<link next="#f{i}"><grammar><item>number {i}</item></grammar></link>\n'),
    "conditions": _inside("form block", lambda i, n: f'<if cond="v{i} == {i}"><speak>Yes.</speak></if>\n'),
    "branches": _inside('form block', lambda i, n: (f'<if cond="a == {i}">' if i == 0 else f'<elseif cond="a == {i}"/>') + "<speak>Yes.</speak>\n" + ("</if>" if i == n - 1 else "")),
    "logs": _inside("form block", lambda i, n: f'<log expr="{i}"/>\n'),
    "metas": _ours(lambda i, n: f'<meta name="m{i}" content="{i}"/>\n'),
    "ignores": _inside("form block", lambda i, n: f"<!-- prima-ignore: dead-content because {i} --><speak>A</speak>\n"),
    "dead content": _inside("form block", lambda i, n: '<if cond="true"><exit/><speak>A</speak></if>\n'),
    "gotos to items": _inside("form", lambda i, n: f'<block name="b{i}"><goto nextitem="b{(i + 1) % n}"/></block>\n'),
    "gotos to no item": _inside("form", lambda i, n: f'<block name="b{i}"><goto nextitem="c{i}"/></block>\n'),
    "foreach": _inside("form block", lambda i, n: f'<foreach item="v{i}" array="[1,2]"><speak>A</speak></foreach>\n'),
    "nested conditions": _inside("form block", lambda i, n: '<if cond="true">' * 90 + "<speak>A</speak>" + "</if>" * 90 + "\n"),
    "a long attribute": _inside("form block", lambda i, n: ('<log expr="' if i == 0 else "") + f"{i} + " + ('1"/>' if i == n - 1 else "")),
    "a long expression of names": _inside("form block", lambda i, n: ('<log expr="' if i == 0 else "") + f"v{i} + " + ('1"/>' if i == n - 1 else "")),
    "a long name": _inside("form block", lambda i, n: ('<assign expr="1" name="' if i == 0 else "") + "abcdefghi" + ('"/>' if i == n - 1 else "")),
    "a long event": _inside("form block", lambda i, n: ('<throw event="e' if i == 0 else "") + ".abcdefghi" + ('"/>' if i == n - 1 else "")),
    "events of a handler": _inside("form", lambda i, n: ('<on event="' if i == 0 else "") + f"e{i} " + ('"/>' if i == n - 1 else "")),
    "a long text": _inside("form block speak", lambda i, n: "A word. "),
    "lines": _inside("form block", lambda i, n: "\n"),
    "stray text": _inside("form", lambda i, n: f"<block/> word{i}\n"),
    "comments": _ours(lambda i, n: "<!-- nothing -->\n"),
    "wrong expressions": _inside("form block", lambda i, n: f'<log expr="{i} +"/>\n'),
    "wrong values": _inside("form block", lambda i, n: f'<move-head pan="x{i}"/>\n'),
    "missing attributes": _inside("form block", lambda i, n: "<goto/>\n"),
    "misplaced elements": _inside("form block", lambda i, n: "<field/>\n"),
    "braces": _inside("form block", lambda i, n: f"<speak>{{v{i}}}</speak>\n"),
    "duplicate forms": _ours(lambda i, n: '<form id="f"/>\n'),
    # VoiceXML
    "VoiceXML dialogs with gotos": _voice(
        lambda i, n: f'<form id="f{i}"><block>Number {i}.<goto next="#f{(i + 1) % n}"/></block></form>\n'
    ),
    "VoiceXML dialogs with gotos to nothing": _voice(
        lambda i, n: f'<form id="f{i}"><block><goto next="#g{i}"/></block></form>\n'
    ),
    "VoiceXML gotos to files": _voice(
        lambda i, n: f'<form id="f{i}"><block><goto next="g{i}.vxml"/></block></form>\n'
    ),
    "VoiceXML dialogs with handlers that go on anywhere": _voice(
        lambda i, n: f'<form id="f{i}"><block>A<goto expr="v{i}"/></block>'
        f'<catch event="touch.head"><goto expr="w{i}"/></catch></form>\n'
    ),
    "VoiceXML subdialogs": _voice(
        lambda i, n: f'<form id="f{i}"><subdialog name="s" src="#f{(i * 7 + 1) % n}"><param name="p" expr="{i}"/></subdialog></form>\n'
    ),
    "VoiceXML variables": _voice(lambda i, n: f'<var name="v{i}" expr="v{max(i - 1, 0)}"/>\n', after="<form/>"),
    "VoiceXML undeclared names": _voice(lambda i, n: f'<assign name="v{i}" expr="w{i}"/>\n', "<form><block>", "</block></form>"),
    "VoiceXML scripts": _voice(lambda i, n: f"<script>function g{i}(x) {{ return x; }}</script>\n"),
    "VoiceXML fields": _voice(lambda i, n: f'<field name="a{i}" type="boolean"><prompt>Is it {i}?</prompt></field>\n', "<form>", "</form>"),
    "VoiceXML filleds": _voice(lambda i, n: f'<filled namelist="a b{i}"/>\n', '<form><field name="a"/>', "</form>"),
    "VoiceXML options": _voice(lambda i, n: f"<option>number {i}</option>\n", '<form><field name="a">', "</field></form>"),
    "VoiceXML choices": _voice(lambda i, n: f'<choice next="#m">number {i}</choice>\n', '<menu id="m">', "</menu>"),
    "VoiceXML menus": _voice(lambda i, n: f'<menu id="m{i}"><choice next="#m{(i + 1) % n}">go on</choice></menu>\n'),
    "VoiceXML branches": _voice(
        lambda i, n: f'<form id="f{i}"><catch event="message"><goto next="#f0"/></catch><block><par xmlns="urn:prima:dialogue:1"><speak>A.</speak><speak>B.</speak></par></block></form>\n'
    ),
    "VoiceXML enumerates": _voice(
        lambda i, n: f'<form id="f{i}"><help>Say <enumerate/></help><field name="q"><option>tea {i}</option></field></form>\n'
    ),
    "VoiceXML links": _voice(lambda i, n: f'<link event="e{i}"><grammar mode="voice" version="1.0" root="r"><rule id="r">number {i}</rule></grammar></link>\n', after="<form/>"),
    "VoiceXML catches": _voice(lambda i, n: f'<catch event="e{i}">Yes.</catch>\n', after="<form/>"),
    "VoiceXML values": _voice(lambda i, n: f'<value expr="{i}"/>\n', "<form><block>", "</block></form>"),
    "VoiceXML properties": _voice(lambda i, n: f'<property name="timeout" value="{i}s"/>\n', after="<form/>"),
    "VoiceXML unknown elements": _voice(lambda i, n: "<nothing/>\n", "<form><block>", "</block></form>"),
    "VoiceXML conditions": _voice(lambda i, n: f'<if cond="{i} == 1">A<else/>B</if>\n', "<form><block>", "</block></form>"),
    "VoiceXML external grammars": _voice(lambda i, n: f'<field name="a{i}"><grammar src="g{i}.grxml"/></field>\n', "<form>", "</form>"),
    "VoiceXML namelist": _voice(lambda i, n: ('<submit next="x" namelist="' if i == 0 else "") + f"n{i} " + ('"/>' if i == n - 1 else ""), "<form><block>", "</block></form>"),
    # Grammars
    "rules": _grammar(lambda i, n: f'<rule id="r{i}">number {i}</rule>\n'),
    "rules that refer on": _grammar(lambda i, n: f'<rule id="r{i}">go <ruleref uri="#r{min(i + 1, n - 1)}"/></rule>\n'),
    "rules that refer back": _grammar(lambda i, n: f'<rule id="r{i}">go <item repeat="0-1"><ruleref uri="#r{(i + 1) % n}"/></item></rule>\n'),
    "rules that refer to nothing": _grammar(lambda i, n: f'<rule id="r{i}"><ruleref uri="#s{i}"/></rule>\n'),
    "rules that refer to files": _grammar(lambda i, n: f'<rule id="r{i}"><ruleref uri="s{i}.grxml"/></rule>\n'),
    "rulerefs": _grammar(lambda i, n: '<ruleref uri="#a"/>\n', '<rule id="a">a</rule><rule id="r0">', "</rule>"),
    "items": _grammar(lambda i, n: f"<item>number {i}</item>\n", '<rule id="r0"><one-of>', "</one-of></rule>"),
    "items with tags": _grammar(lambda i, n: f"<item>number {i}<tag>out.n = {i};</tag></item>\n", '<rule id="r0"><one-of>', "</one-of></rule>"),
    "repeats": _grammar(lambda i, n: '<item repeat="0-1">maybe</item>\n', '<rule id="r0">', "</rule>"),
    "lexicons": _grammar(lambda i, n: f'<lexicon uri="l{i}.pls"/>\n', "", '<rule id="r0">a</rule>'),
    "ABNF rules": Family("#ABNF 1.0;\nlanguage en;\nroot $r0;\n", lambda i, n: f"$r{i} = go $r{min(i + 1, n - 1)};\n", "", ".gram"),
    "ABNF alternatives": Family("#ABNF 1.0;\nlanguage en;\nroot $r0;\n$r0 = a", lambda i, n: f" | number{i}", ";\n", ".gram"),
    # Worlds, robots and scenarios
    "places with ways": _world(lambda i, n: f'<place id="p{i}" x="{i % 100}" y="{i // 100}"/>' + (f'<way from="p{i}" to="p{i - 1}"/>\n' if i % 2 else "\n")),
    "places at the points of others": _world(lambda i, n: f'<place id="p{i}" x="{i % 100}" y="{i // 100 % 50}"/>\n'),
    "ways to nowhere": _world(lambda i, n: f'<way from="start" to="q{i}"/>\n'),
    "ways": _world(lambda i, n: f'<place id="p{i}" x="{i % 100}" y="{i // 100}"/><way from="start" to="p{i}"/><way from="p{i}" to="p{max(i - 1, 0)}"/>\n'),
    "walls": _world(lambda i, n: f'<wall x1="{i}" y1="1" x2="{i}" y2="2"/>\n'),
    "corners": _world(lambda i, n: f'<corner id="c{i}" x="{i}" y="0" radius="0.5"/>\n'),
    "things": _world(lambda i, n: f'<thing id="t{i}" x="{i}" y="0"/>\n'),
    "areas": _world(lambda i, n: f'<area id="a{i}" x1="{i}" y1="0" x2="{i + 1}" y2="1" application="a{i}.xml"/>\n'),
    "answers": _scenario(lambda i, n: f'<answer to="Question {i}">Yes.</answer>\n'),
    "whens": _scenario(lambda i, n: f'<when at="{i}s"><touch sensor="head"/></when>\n'),
    "whens with speech": _scenario(lambda i, n: f'<when at="{i}s"><say>Number {i}</say></when>\n'),
    "expects": _scenario(lambda i, n: f'<expect says="Number {i}." by="guide"/>\n'),
    "expects in order": _scenario(lambda i, n: ("<in-order>" if i == 0 else "") + f'<expect says="Number {i}." by="guide"/>\n' + ("</in-order>" if i == n - 1 else "")),
    "expects by nobody": _scenario(lambda i, n: f'<expect says="Number {i}." by="nobody{i}"/>\n'),
    "expects of data": _scenario(lambda i, n: f'<expect does="topological-move" by="guide"><data name="to" value="r{i}"/></expect>\n'),
    "session variables": _scenario(lambda i, n: f'<variable name="v{i}" value="{i}"/>\n'),
    "persons": _scenario(lambda i, n: f'<person id="p{i}" x="{i}" y="0.5"/>\n'),
    "services": _scenario(lambda i, n: f'<service name="s{i}"><reply after="1s"/></service>\n'),
    "applications": _scenario(lambda i, n: f'<application src="a{i}.xml"/>\n'),
    "the same application": _scenario(lambda i, n: f'<application src="guide.xml" id="a{i}"/>\n'),
}  # fmt: skip
"""Families by name."""


def validation(family: str, size: int) -> float:
    """Seconds to validate a document of a family of about so many bytes."""
    from prima import loading

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"large{FAMILIES[family].suffix}")
        path.write_text(FAMILIES[family].text(1000), encoding="utf-8")
        loading.validate([path])  # imports do not count
        path.write_text(FAMILIES[family].text(size), encoding="utf-8")
        began = perf_counter()
        problems = loading.validate([path])
        taken = perf_counter() - began
    check(not any("bytes" in one.message for one in problems[:1]), f"{family}: {problems[:1]}")
    return taken


def growth(family: str, size: int) -> float:
    """With which power of the size the time grows, from a quarter of a size up to it."""
    sizes = [size // 4, size // 2, size]
    return exponent(sizes, [fresh(validation, family, one).value for one in sizes])


def exponent(sizes: list[int], seconds: list[float]) -> float:
    """With which power of the size the time grows."""
    logs = [math.log(size) for size in sizes], [math.log(one) for one in seconds]
    return linear_regression(*logs).slope


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("words", nargs="?", default="", help="families that hold these words")
    parser.add_argument("--bytes", type=int, default=MOST_BYTES, help="the largest size")
    options = parser.parse_args()
    sizes = [options.bytes // part for part in (4, 2, 1)]
    for name in FAMILIES:
        if options.words.lower() in name.lower():
            taken = [fresh(validation, name, size).value for size in sizes]
            told = "  ".join(f"{one:7.2f}" for one in taken)
            print(f"{name:40}{told}  s  exponent {exponent(sizes, taken):.2f}", flush=True)


if __name__ == "__main__":
    main()
