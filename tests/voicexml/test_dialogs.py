"""VoiceXML 2.0's dialogs (chapter 2) and control flow (chapter 5), one short case for each rule.

Each case is written after the section it names; 2.1 says where the rule is VoiceXML 2.1's.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

from tests.helpers.voice import Call

SILENT = ""
"""Instead of an utterance: the user says nothing."""
OOPS = "I did not understand."
"""What the platform says of what no grammar takes, where no handler does (5.2.5)."""
CITIES = "<option>Kyoto</option><option>Nara</option>"
TRIP = """<grammar version="1.0" root="trip" xmlns="http://www.w3.org/2001/06/grammar"
    tag-format="semantics/1.0">
  <rule id="trip"><one-of>
    <item>from <ruleref uri="#city"/><tag>out.start = rules.latest();</tag></item>
    <item>to <ruleref uri="#city"/><tag>out.end = rules.latest();</tag></item>
    <item>from <ruleref uri="#city"/><tag>out.start = rules.latest();</tag>
      to <ruleref uri="#city"/><tag>out.end = rules.latest();</tag></item>
    </one-of></rule>
  <rule id="city"><one-of><item>Kyoto</item><item>Nara</item><item>Osaka</item></one-of></rule>
</grammar>"""
HOME = """<grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">
  <rule id="r">go home</rule></grammar>"""
LEAF = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="root.vxml">'
PAGE = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">'


@dataclass(frozen=True)
class Case:
    """A document, what the user says to its questions, and what must come of it."""

    text: str
    says: tuple[str, ...]
    logs: list[str] | None
    said: list[str] | None
    ended: str | None
    files: dict[str, str] = field(default_factory=dict)


CASES: list[object] = []


def case(
    rule: str,
    section: str,
    text: str,
    *says: str,
    logs: list[str] | None = None,
    said: list[str] | None = None,
    ended: str | None = None,
    fails: str = "",
    files: dict[str, str] | None = None,
) -> None:
    """Add a case; ``fails`` says what the interpreter does wrong."""
    marks = [pytest.mark.xfail(strict=True, reason=fails)] if fails else []
    made = Case(text, says, logs, said, ended, files or {})
    CASES.append(pytest.param(made, id=f"{section} {rule}".replace(" ", "_"), marks=marks))


# 2.1 Forms ------------------------------------------------------------------------------

case(
    "form items are visited in document order",
    "2.1",
    f"""<form><block><log>a</log></block><field name="f">{CITIES}</field>
    <block><log expr="f"/></block></form>""",
    "nara",
    logs=["a", "Nara"],
    ended="exit",
)
case(
    "the first dialog of a document is run",
    "1.5.1",
    "<form id='z'><block><log>z</log></block></form><form id='a'><block><log>a</log></block></form>",
    logs=["z"],
    ended="exit",
)
case(
    "a form that is exhausted is an implicit exit",
    "2.1.6",
    "<form><block>Bye.</block></form><form><block>Never.</block></form>",
    said=["Bye."],
    ended="exit",
)
case(
    "a form without items exits",
    "2.1.6",
    "<form><var name='x'/></form>",
    logs=[],
    ended="exit",
)
case(
    "an item whose condition is false is not selected",
    "2.1.5",
    """<form><var name="n" expr="1"/><block cond="n == 2"><log>no</log></block>
    <block cond="n == 1"><log>yes</log></block></form>""",
    logs=["yes"],
)
case(
    "guards are looked at anew in each iteration",
    "2.1.6.2",
    """<form><var name="n" expr="1"/><block cond="n == 2"><log>first</log></block>
    <block><log>second</log><assign name="n" expr="2"/></block></form>""",
    logs=["second", "first"],
)
case(
    "an item whose variable has an initial value is not visited",
    "2.1.5",
    f"""<form><field name="f" expr="'x'"><prompt>Where?</prompt>{CITIES}</field>
    <block><log expr="f"/></block></form>""",
    logs=["x"],
    said=[],
)
case(
    "an unnamed block with an expr is not visited",
    "2.3.2",
    "<form><block expr='true'><log>no</log></block><block><log>yes</log></block></form>",
    logs=["yes"],
)
case(
    "assigning undefined to an item makes it eligible again",
    "2.1.5",
    """<form><var name="n" expr="0"/><block name="b"><assign name="n" expr="n + 1"/>
    <log expr="n"/></block><block cond="n == 1"><assign name="b" expr="undefined"/></block></form>""",
    logs=["1", "2"],
)
case(
    "a block's variable is true before its content runs",
    "2.3.2",
    "<form><block name='b'><log expr='b'/></block></form>",
    logs=["true"],
)
case(
    "a form's variables are initialised each time it is entered",
    "2.1.2",
    """<var name="seen" expr="0"/><form id="a"><var name="n" expr="0"/><block>
    <assign name="n" expr="n + 1"/><assign name="seen" expr="seen + 1"/><log expr="n"/>
    <if cond="seen == 1"><goto next="#a"/></if></block></form>""",
    logs=["1", "1"],
)
case(
    "form variables and items are initialised in document order",
    "2.1.6.1",
    """<form><var name="a" expr="1"/><field name="f" expr="a + 1"/><var name="b" expr="f + 1"/>
    <script>var c = b + 1;</script><block><log expr="[a, f, b, c].join()"/></block></form>""",
    logs=["1,2,3,4"],
)
case(
    "goto nextitem visits an item whose variable is filled",
    "2.1.5.1",
    """<form><var name="n" expr="0"/><block name="a"><assign name="n" expr="n + 1"/>
    <log expr="n"/></block><block><goto nextitem="a"/></block></form>""",
    logs=["1", "2"],
    ended="exit",
)
case(
    "goto nextitem visits an item whose condition is false",
    "2.1.6.2",
    """<form><block><goto nextitem="b"/></block><block name="a" cond="false"><log>a</log></block>
    <block name="b" cond="false"><log>b</log></block></form>""",
    logs=["b"],
)
case(
    "after goto nextitem selection goes on as usual",
    "2.1.6.2",
    """<form><block><goto nextitem="b"/></block><block name="a"><log>a</log></block>
    <block name="b"><log>b</log></block></form>""",
    logs=["b", "a"],
)
case(
    "goto expritem computes the item",
    "5.3.7",
    """<form><block><goto expritem="'b' + 1"/></block><block name="a"><log>a</log></block>
    <block name="b1"><log>b1</log></block></form>""",
    logs=["b1", "a"],
)
case(
    "goto an item that is not there is error.badfetch",
    "5.3.7",
    """<form><catch event="error.badfetch"><log>bad</log></catch>
    <block><goto nextitem="nope"/></block></form>""",
    logs=["bad"],
)
case(
    "a goto to an item keeps the form's variables",
    "5.3.7",
    """<form><var name="n" expr="1"/><block><assign name="n" expr="5"/><goto nextitem="b"/></block>
    <block name="b"><log expr="n"/></block></form>""",
    logs=["5"],
)
case(
    "a field's prompt counter is per field and starts again with the form",
    "2.1.6.1",
    f"""<form id="a"><field name="f"><prompt>One?</prompt><prompt count="2">Two?</prompt>{CITIES}
    <nomatch count="2"><goto next="#a"/></nomatch></field></form>""",
    "x",
    "x",
    said=["One?", OOPS, "Two?", "One?"],
)

# 2.1.5 Mixed initiative -----------------------------------------------------------------

MIXED = f"""<form>{TRIP}<initial name="init"><prompt>Your trip?</prompt>
  <nomatch count="2">Step by step.<assign name="init" expr="true"/><reprompt/></nomatch></initial>
  <field name="start"><prompt>From?</prompt>{CITIES}<filled><log>s:<value expr="start"/></log>
    </filled></field>
  <field name="end"><prompt>To?</prompt>{CITIES}<filled><log>e:<value expr="end"/></log></filled>
  </field>
  <block><log><value expr="start"/>-<value expr="end"/>-<value expr="init"/></log></block></form>"""
case(
    "what initial leaves open is asked for",
    "2.3.3",
    MIXED,
    "to Nara",
    "kyoto",
    logs=["e:Nara", "s:Kyoto", "Kyoto-Nara-true"],
    said=["Your trip?", "From?"],
)
case(
    "one utterance fills many fields and their filled run in document order",
    "2.1.5",
    MIXED,
    "from Kyoto to Osaka",
    logs=["s:Kyoto", "e:Osaka", "Kyoto-Osaka-true"],
    said=["Your trip?"],
)
case(
    "initial is left when its variable is set",
    "2.3.3",
    MIXED,
    "x",
    "y",
    "kyoto",
    "nara",
    said=["Your trip?", OOPS, "Your trip?", "Step by step.", "From?", "To?"],
    logs=["s:Kyoto", "e:Nara", "Kyoto-Nara-true"],
)
case(
    "a field's own grammar does not listen during initial",
    "2.3.3",
    MIXED,
    "kyoto",
    "from Nara",
    "kyoto",
    said=["Your trip?", OOPS, "Your trip?", "To?"],
    logs=["s:Nara", "e:Kyoto", "Nara-Kyoto-true"],
)
case(
    "a form's grammar listens in its fields",
    "2.1.5",
    MIXED,
    "from Nara",
    "from Kyoto to Osaka",
    logs=["s:Nara", "s:Kyoto", "e:Osaka", "Kyoto-Osaka-true"],
)
case(
    "initial is true before the filled of what it heard run",
    "2.1.6.2",
    f"""<form>{TRIP}<initial name="init"/><field name="start">{CITIES}
    <filled><log expr="init"/></filled></field></form>""",
    "from Nara",
    logs=["true"],
)
case(
    "an initial with a goto back is visited again when cleared",
    "2.3.3",
    f"""<form>{TRIP}<initial name="init"><prompt>Trip?</prompt></initial>
    <field name="start"><prompt>From?</prompt>{CITIES}</field>
    <field name="end"><prompt>To?</prompt>{CITIES}
    <filled><if cond="end == 'Nara'"><clear namelist="init start end"/></if></filled></field></form>""",
    "from Kyoto to Nara",
    "from Nara to Osaka",
    said=["Trip?", "Trip?"],
    ended="exit",
)
case(
    "an initial's condition is its guard",
    "2.3.3",
    f"""<form>{TRIP}<initial cond="false"><prompt>Trip?</prompt></initial>
    <field name="start"><prompt>From?</prompt>{CITIES}</field></form>""",
    "nara",
    said=["From?"],
    ended="exit",
)
case(
    "an initial's event counters are its own",
    "2.3.3",
    f"""<form>{TRIP}<initial name="i"><nomatch count="2"><assign name="i" expr="true"/></nomatch>
    </initial><field name="start">{CITIES}<nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log></nomatch></field></form>""",
    "x",
    "x",
    "x",
    logs=["1"],
)
# 2.3.1 Fields ---------------------------------------------------------------------------

case(
    "an option gives its value",
    "2.3.1.3",
    """<form><field name="f"><option value="k">Kyoto</option></field>
    <block><log expr="f"/></block></form>""",
    "kyoto",
    logs=["k"],
)
case(
    "an option without a value gives its text",
    "2.3.1.3",
    """<form><field name="f"><option dtmf="1"> New   York </option></field>
    <block><log expr="f"/></block></form>""",
    "new york",
    logs=["New York"],
)
case(
    "an option is chosen by its key",
    "2.3.1.3",
    """<form><field name="f"><option dtmf="1" value="a">Kyoto</option>
    <option dtmf="2" value="b">Nara</option></field>
    <block><log expr="f + f$.inputmode"/></block></form>""",
    "2",
    logs=["bdtmf"],
)
case(
    "an option with neither value nor text gives its key",
    "2.3.1.3",
    """<form><field name="f"><option dtmf="3"/></field><block><log expr="f"/></block></form>""",
    "3",
    logs=["3"],
)
case(
    "an option is exact by default",
    "2.3.1.3",
    """<form><field name="f"><option>New York City</option><nomatch><log>no</log></nomatch></field>
    </form>""",
    "new york",
    logs=["no"],
)
case(
    "an approximate option takes some of its words",
    "2.3.1.3",
    """<form><field name="f"><option accept="approximate">New York City</option></field>
    <block><log expr="f"/></block></form>""",
    "york",
    logs=["New York City"],
)
case(
    "enumerate in a field says its options",
    "2.2.4",
    f"""<form><field name="f"><prompt>Go to <enumerate/>?</prompt>{CITIES}</field></form>""",
    said=["Go to Kyoto; Nara?"],
)
case(
    "a field's shadow variables tell how it was filled",
    "2.3.1",
    f"""<form><field name="f">{CITIES}</field><block>
    <log expr="[f$.utterance, f$.inputmode, f$.interpretation, f$.confidence].join()"/>
    </block></form>""",
    "Kyoto",
    logs=["Kyoto,voice,Kyoto,1"],
)
case(
    "a slot names the property that fills the field",
    "2.3.1",
    f"""<form>{TRIP}<field name="f" slot="start"/><field name="g" slot="end"/>
    <filled><log expr="f + g"/></filled></form>""",
    "from Nara to Osaka",
    logs=["NaraOsaka"],
)
case(
    "a field's own grammar fills that field alone",
    "3.1.6.2",
    f"""<form><field name="start">{TRIP}</field><field name="end"><prompt>To?</prompt>{CITIES}
    </field><block><log expr="start + end"/></block></form>""",
    "from Nara to Osaka",
    "kyoto",
    logs=["NaraKyoto"],
)
case(
    "a field without a matching slot takes the whole interpretation",
    "3.1.6.2",
    f"""<form><field name="f">{TRIP}</field><block><log expr="f.start"/></block></form>""",
    "from Nara",
    logs=["Nara"],
)
case(
    "a field's built-in type is its grammar",
    "2.3.1",
    """<form><field name="f" type="boolean"/><block><log expr="f === true"/></block></form>""",
    "yes",
    logs=["true"],
)
case(
    "a modal field turns off all other grammars",
    "2.3.1",
    f"""<link event="home">{HOME}</link><catch event="home"><log>home</log></catch>
    <form>{TRIP}<field name="f" modal="true">{CITIES}<nomatch><log>nomatch</log></nomatch></field>
    <field name="start" expr="1"/></form>""",
    "go home",
    "from Nara",
    logs=["nomatch", "nomatch"],
)
case(
    "a field that is not modal hears links and the form",
    "2.3.1",
    f"""<link event="home">{HOME}</link><catch event="home"><log>home</log></catch>
    <form>{TRIP}<field name="f" modal="false">{CITIES}</field>
    <field name="start"/><block><log expr="start"/></block></form>""",
    "go home",
    "from Nara",
    "kyoto",
    logs=["home", "Nara"],
)
case(
    "an unnamed field is filled and left",
    "2.3.1",
    f"""<form><field>{CITIES}<filled><log>filled</log></filled></field></form>""",
    "kyoto",
    logs=["filled"],
    ended="exit",
)
case(
    "another field's grammar does not listen",
    "2.3.1",
    f"""<form><field name="a"><option>red</option><nomatch><log>no</log></nomatch></field>
    <field name="b">{CITIES}</field></form>""",
    "kyoto",
    logs=["no"],
)

# 2.3.2 Blocks ---------------------------------------------------------------------------

case(
    "text in a block is said as a prompt",
    "2.3.2",
    "<form><block>One <value expr='1 + 1'/> <prompt>three</prompt> four</block></form>",
    said=["One 2", "three", "four"],
)
case(
    "a block is run once",
    "2.3.2",
    "<form><block><log>a</log></block><block><log>b</log></block></form>",
    logs=["a", "b"],
    ended="exit",
)
case(
    "a block is run again when it is cleared",
    "5.3.3",
    """<form><var name="n" expr="0"/><block name="b"><assign name="n" expr="n+1"/><log expr="n"/>
    </block><block cond="n &lt; 2"><clear namelist="b"/></block></form>""",
    logs=["1", "2"],
)

# 2.3.4 Subdialogs -----------------------------------------------------------------------

case(
    "a param's value and expr reach the subdialog's variables",
    "2.3.4",
    """<form><var name="n" expr="20"/><subdialog name="s" src="#t"><param name="a" expr="n + 1"/>
    <param name="b" value="n + 1"/></subdialog></form>
    <form id="t"><var name="a" expr="0"/><var name="b"/><block><log expr="a"/><log expr="b"/>
    <return/></block></form>""",
    logs=["21", "n + 1"],
)
case(
    "a param replaces the expr of the variable",
    "2.3.4",
    """<form><subdialog name="s" src="#t"><param name="a" expr="7"/></subdialog></form>
    <form id="t"><var name="a" expr="0"/><var name="b" expr="a + 1"/><block><log expr="b"/>
    <return/></block></form>""",
    logs=["8"],
)
case(
    "a param whose value is undefined leaves the variable undefined",
    "2.3.4",
    """<form><var name="u"/><subdialog name="s" src="#t"><param name="a" expr="u"/></subdialog></form>
    <form id="t"><var name="a" expr="1"/><block><log expr="typeof a"/><return/></block></form>""",
    logs=["undefined"],
)
case(
    "a param for a variable that is not declared is error.semantic",
    "2.3.4",
    """<catch event="error.semantic"><log>semantic</log><exit/></catch>
    <form><subdialog name="s" src="#t"><param name="zz" expr="7"/></subdialog></form>
    <form id="t"><block><log>in</log><return/></block></form>""",
    logs=["semantic"],
)
case(
    "a param cannot set a form item's variable",
    "2.3.4",
    f"""<catch event="error.semantic"><log>semantic</log><exit/></catch>
    <form><subdialog name="s" src="#t"><param name="f" expr="7"/></subdialog></form>
    <form id="t"><field name="f">{CITIES}</field></form>""",
    logs=["semantic"],
)
case(
    "an object is passed to a subdialog by value",
    "2.3.4",
    """<form><var name="o" expr="({n: 1})"/><subdialog name="s" src="#t"><param name="a" expr="o"/>
    <filled><log expr="o.n"/></filled></subdialog></form>
    <form id="t"><var name="a"/><block><assign name="a.n" expr="5"/><return/></block></form>""",
    logs=["1"],
)
case(
    "what is returned becomes properties of the subdialog's variable",
    "2.3.4",
    """<form><subdialog name="s" src="#t"><filled><log expr="s.a + s.b.c"/></filled></subdialog></form>
    <form id="t"><var name="a" expr="1"/><var name="b" expr="({c: 2})"/>
    <block><return namelist="a b"/></block></form>""",
    logs=["3"],
)
case(
    "a return without a namelist gives an empty object",
    "5.3.10",
    """<form><subdialog name="s" src="#t"/><block><log expr="JSON.stringify(s)"/></block></form>
    <form id="t"><block><return/></block></form>""",
    logs=["{}"],
)
case(
    "an undefined variable is returned as undefined",
    "5.3.10",
    """<form><subdialog name="s" src="#t"/><block><log expr="typeof s.a"/></block></form>
    <form id="t"><var name="a"/><block><return namelist="a"/></block></form>""",
    logs=["undefined"],
)
case(
    "a variable that is not declared cannot be returned",
    "5.3.10",
    """<catch event="error.semantic"><log>semantic</log><exit/></catch>
    <form><subdialog name="s" src="#t"/></form>
    <form id="t"><block><return namelist="zz"/></block></form>""",
    logs=["semantic"],
)
case(
    "a field's value is returned by its name",
    "2.3.4",
    f"""<form><subdialog name="s" src="#t"/><block><log expr="s.f"/></block></form>
    <form id="t"><field name="f"><prompt>Where?</prompt>{CITIES}<filled><return namelist="f"/>
    </filled></field></form>""",
    "nara",
    logs=["Nara"],
)
case(
    "a returned event is thrown in the caller at the subdialog",
    "5.3.10",
    """<form><subdialog name="s" src="#t"><catch event="odd"><log expr="_event"/><exit/></catch>
    </subdialog></form><form id="t"><catch event="odd"><log>not here</log></catch>
    <block><return event="odd.one"/></block></form>""",
    logs=["odd.one"],
)
case(
    "a returned event may be computed and have a message",
    "5.3.10",
    """<form><subdialog name="s" src="#t"><catch event="odd"><log expr="_event + _message"/><exit/>
    </catch></subdialog></form><form id="t"><var name="n" expr="2"/>
    <block><return eventexpr="'odd.' + n" messageexpr="'m' + n"/></block></form>""",
    logs=["odd.2m2"],
)
case(
    "after a returned event the subdialog is not filled",
    "2.3.4",
    """<form><var name="n" expr="0"/><subdialog name="s" src="#t"><catch event="odd">
    <assign name="n" expr="n + 1"/><log expr="typeof s"/></catch>
    <catch event="odd" count="2"><log>twice</log><exit/></catch><filled><log>no</log></filled>
    </subdialog></form><form id="t"><block><return event="odd"/></block></form>""",
    logs=["undefined", "twice"],
)
case(
    "a return where no subdialog runs is error.semantic",
    "5.3.10",
    """<catch event="error.semantic"><log>semantic</log><exit/></catch>
    <form><block><return/></block></form>""",
    logs=["semantic"],
)
case(
    "an exit in a subdialog ends the application",
    "5.3.9",
    """<form><subdialog name="s" src="#t"/><block><log>after</log></block></form>
    <form id="t"><block><exit/></block></form>""",
    logs=[],
    ended="exit",
)
case(
    "a subdialog whose form is exhausted ends the application",
    "2.3.4",
    """<form><subdialog name="s" src="#t"/><block><log>after</log></block></form>
    <form id="t"><block><log>in</log></block></form>""",
    logs=["in"],
    ended="exit",
)
case(
    "the caller's dialog variables are not seen in a subdialog",
    "2.3.4",
    """<form><var name="n" expr="1"/><subdialog name="s" src="#t"/></form>
    <form id="t"><block><log expr="typeof n"/><return/></block></form>""",
    logs=["undefined"],
)
case(
    "the caller's document is initialised anew for a subdialog in it",
    "2.3.4",
    """<var name="n" expr="1"/><form><block><assign name="n" expr="2"/></block>
    <subdialog name="s" src="#t"/><block><log expr="n"/></block></form>
    <form id="t"><block><log expr="n"/><return/></block></form>""",
    logs=["1", "2"],
)
case(
    "the caller's handlers take nothing thrown in a subdialog",
    "2.3.4",
    """<form><catch event="odd"><log>caller</log></catch><subdialog name="s" src="#t"/></form>
    <form id="t"><block><throw event="odd"/></block></form>""",
    logs=[],
    ended="odd",
)
case(
    "the caller's form grammar does not listen in a subdialog",
    "2.3.4",
    f"""<form>{TRIP}<subdialog name="s" src="#t"/><field name="start"/></form>
    <form id="t"><field name="f">{CITIES}<nomatch><log>no</log></nomatch></field></form>""",
    "from Nara",
    logs=["no"],
)
case(
    "a subdialog may go through many dialogs before it returns",
    "2.3.4",
    """<form><subdialog name="s" src="#t"/><block><log expr="s.n"/></block></form>
    <form id="t"><block><goto next="#u"/></block></form>
    <form id="u"><var name="n" expr="4"/><block><return namelist="n"/></block></form>""",
    logs=["4"],
)
case(
    "a subdialog may be in another document with a root of its own",
    "2.3.4",
    """<var name="n" expr="1"/><form><subdialog name="s" src="other.vxml#t"/>
    <block><log expr="s.n + n"/></block></form>""",
    logs=["11"],
    files={
        "other": f"{LEAF}<form/><form id='t'><var name='n' expr='application.m'/><block>"
        "<return namelist='n'/></block></form></vxml>",
        "root": f"{PAGE}<var name='m' expr='10'/></vxml>",
    },
)
case(
    "the first dialog of a document is the subdialog where none is named",
    "2.3.4",
    """<form><subdialog name="s" src="other.vxml"/><block><log>back</log></block></form>""",
    logs=["in", "back"],
    files={"other": f"{PAGE}<form><block><log>in</log><return/></block></form></vxml>"},
)
case(
    "a subdialog's source may be computed",
    "2.1, 8",
    """<form><subdialog name="s" srcexpr="'#' + 't'"/><block><log>back</log></block></form>
    <form id="t"><block><log>in</log><return/></block></form>""",
    logs=["in", "back"],
)
case(
    "a subdialog's document that is not there is error.badfetch in the caller",
    "2.3.4",
    """<form><subdialog name="s" src="none.vxml"><catch event="error.badfetch"><log>bad</log><exit/>
    </catch></subdialog></form>""",
    logs=["bad"],
)
case(
    "a subdialog within a subdialog comes back to it",
    "2.3.4",
    """<form><subdialog name="s" src="#t"/><block><log expr="s.n"/></block></form>
    <form id="t"><var name="n"/><subdialog name="s" src="#u"/>
    <block><assign name="n" expr="s.m + 1"/><return namelist="n"/></block></form>
    <form id="u"><var name="m" expr="1"/><block><return namelist="m"/></block></form>""",
    logs=["2"],
)
case(
    "prompts queued before a subdialog are said before its own",
    "4.1.8",
    """<form><block>One.</block><subdialog name="s" src="#t"><prompt>Two.</prompt></subdialog>
    <block>Four.</block></form><form id="t"><block>Three.<return/></block></form>""",
    said=["One.", "Two.", "Three.", "Four."],
)
case(
    "a subdialog's condition is its guard",
    "2.3.4",
    """<form><subdialog name="s" src="#t" cond="false"/><block><log>after</log></block></form>
    <form id="t"><block><log>in</log><return/></block></form>""",
    logs=["after"],
)

# 2.3.5 to 2.3.7 Object, record, transfer --------------------------------------------------

case(
    "an object the platform does not have is error.unsupported.objectname",
    "2.3.5",
    """<form><object name="o" classid="method://x"><catch event="error.unsupported.objectname">
    <log>none</log><assign name="o" expr="1"/></catch></object><block><log>on</log></block></form>""",
    logs=["none", "on"],
)
case(
    "a recording fills its variable and runs filled",
    "2.3.6",
    """<form><record name="r" maxtime="10s"><prompt>Speak.</prompt>
    <filled><log expr="typeof r"/></filled></record></form>""",
    "anything at all",
    said=["Speak."],
    logs=["string"],
    ended="exit",
)
case(
    "a recording's shadow variables tell of it",
    "2.3.6",
    """<form><record name="r"/><block><log expr="[typeof r$.duration, typeof r$.size,
    r$.maxtime, r$.termchar === null].join()"/></block></form>""",
    "anything",
    logs=["number,number,false,true"],
)
case(
    "silence at a recording is noinput",
    "2.3.6",
    """<form><record name="r"><noinput><log>silent</log></noinput></record></form>""",
    SILENT,
    logs=["silent"],
)
case(
    "a blind transfer is connection.disconnect.transfer",
    "2.3.7.1",
    """<form><transfer name="t" dest="tel:1" bridge="false"><catch
    event="connection.disconnect.transfer"><log>gone</log><exit/></catch></transfer></form>""",
    logs=["gone"],
)
case(
    "a bridged transfer fills its variable",
    "2.3.7.2",
    """<form><transfer name="t" dest="tel:1" bridge="true"><prompt>Wait.</prompt>
    <filled><log expr="typeof t"/><log expr="t$.duration"/></filled></transfer></form>""",
    said=["Wait."],
    logs=["string", "0"],
    ended="exit",
)

# 2.4 Filled -----------------------------------------------------------------------------

case(
    "a form's filled runs when all input items are filled",
    "2.4",
    f"""<form><field name="a">{CITIES}</field><field name="b">{CITIES}</field>
    <filled><log expr="a + b"/></filled></form>""",
    "kyoto",
    "nara",
    logs=["KyotoNara"],
)
case(
    "with mode any it runs for each",
    "2.4",
    f"""<form><field name="a">{CITIES}</field><field name="b">{CITIES}</field>
    <filled mode="any"><log expr="a + (b || '')"/></filled></form>""",
    "kyoto",
    "nara",
    logs=["Kyoto", "KyotoNara"],
)
case(
    "a namelist says which items count",
    "2.4",
    f"""<form><field name="a">{CITIES}</field><field name="b">{CITIES}</field>
    <field name="c">{CITIES}</field>
    <filled namelist="a b"><log>all</log></filled>
    <filled mode="any" namelist="a c"><log>any</log></filled></form>""",
    "kyoto",
    "nara",
    "nara",
    logs=["any", "all", "any"],
)
case(
    "a filled of items that were filled before does not run again",
    "2.4",
    f"""<form><field name="a">{CITIES}</field><filled namelist="a"><log>a</log></filled>
    <field name="b">{CITIES}</field></form>""",
    "kyoto",
    "nara",
    logs=["a"],
)
case(
    "filled elements run in document order",
    "2.4",
    f"""<form><filled mode="any"><log>form</log></filled><field name="a">{CITIES}
    <filled><log>one</log></filled><filled><log>two</log></filled></field></form>""",
    "kyoto",
    logs=["form", "one", "two"],
)
case(
    "an event in a filled leaves the others out",
    "2.1.6.2",
    f"""<form><catch event="odd"><log>odd</log></catch><field name="a">{CITIES}
    <filled><throw event="odd"/></filled><filled><log>two</log></filled></field>
    <filled><log>form</log></filled></form>""",
    "kyoto",
    logs=["odd"],
)
case(
    "a goto in a filled leaves the others out",
    "2.1.6.2",
    f"""<form><field name="a">{CITIES}<filled><goto nextitem="b"/></filled></field>
    <block name="b"><log>b</log></block><filled><log>form</log></filled></form>""",
    "kyoto",
    logs=["b"],
)
case(
    "a filled that clears its field has it asked again",
    "2.4",
    f"""<form><field name="a"><prompt>Where?</prompt>{CITIES}<filled>
    <if cond="a == 'Nara'">No.<clear namelist="a"/></if></filled></field></form>""",
    "nara",
    "kyoto",
    said=["Where?", "No.", "Where?"],
    ended="exit",
)
case(
    "an event in a field's filled is the field's",
    "5.2.2",
    f"""<form><field name="a">{CITIES}<filled><throw event="odd"/></filled>
    <catch event="odd"><log>field</log></catch></field><catch event="odd"><log>form</log></catch>
    </form>""",
    "kyoto",
    logs=["field"],
)
case(
    "an event in a form's filled is not the field's",
    "5.2.2",
    f"""<form><field name="a">{CITIES}<catch event="odd"><log>field</log></catch></field>
    <filled><throw event="odd"/></filled><catch event="odd"><log>form</log></catch></form>""",
    "kyoto",
    logs=["form"],
)

# 2.2 Menus ------------------------------------------------------------------------------

ENDS = """<form id="a"><block><log>a</log></block></form>
<form id="b"><block><log>b</log></block></form>"""
case(
    "a choice leads to its next",
    "2.2.1",
    f'<menu><choice next="#a">sports</choice><choice next="#b">news</choice></menu>{ENDS}',
    "news",
    logs=["b"],
)
case(
    "a choice's next may be computed",
    "2.2.2",
    f"""<menu><choice expr="'#' + 'b'">news</choice></menu>{ENDS}""",
    "news",
    logs=["b"],
)
case(
    "a choice may throw an event with a message",
    "2.2.2",
    """<menu><choice event="odd" message="well">news</choice>
    <catch event="odd"><log expr="_event + _message"/><exit/></catch></menu>""",
    "news",
    logs=["oddwell"],
)
case(
    "a choice's event may be computed",
    "2.2.2",
    """<menu><choice eventexpr="'o' + 'dd'" messageexpr="1 + 1">news</choice>
    <catch event="odd"><log expr="_event + _message"/><exit/></catch></menu>""",
    "news",
    logs=["odd2"],
)
case(
    "a choice has its key",
    "2.2.2",
    f'<menu><choice dtmf="7" next="#a">x</choice><choice dtmf="0" next="#b">y</choice></menu>{ENDS}',
    "0",
    logs=["b"],
)
case(
    "a menu with dtmf numbers its choices",
    "2.2.1",
    f'<menu dtmf="true"><choice next="#a">x</choice><choice next="#b">y</choice></menu>{ENDS}',
    "2",
    logs=["b"],
)
case(
    "an explicit key takes no number from the others",
    "2.2.1",
    f"""<menu dtmf="true"><choice dtmf="0" next="#a">x</choice><choice next="#b">y</choice></menu>
    {ENDS}""",
    "1",
    logs=["b"],
)
case(
    "enumerate says the choices",
    "2.2.4",
    f"""<menu><prompt>Say <enumerate/></prompt><choice next="#a">sports</choice>
    <choice next="#b">world <emphasis>news</emphasis></choice></menu>{ENDS}""",
    said=["Say sports; world news"],
)
case(
    "enumerate's content has the choice's words and key",
    "2.2.4",
    f"""<menu dtmf="true"><prompt><enumerate>For <value expr="_prompt"/>
    press <value expr="_dtmf"/>. </enumerate></prompt><choice next="#a">sports</choice>
    <choice next="#b">news</choice></menu>{ENDS}""",
    said=["For sports press 1. For news press 2."],
)
case(
    "a choice is exact by default",
    "2.2.5",
    f"""<menu><nomatch><log>no</log></nomatch><choice next="#a">world sports news</choice></menu>
    {ENDS}""",
    "sports news",
    logs=["no"],
)
case(
    "an approximate choice takes some of its words",
    "2.2.5",
    f"""<menu><nomatch><log>no</log></nomatch>
    <choice accept="approximate" next="#a">world sports news</choice></menu>{ENDS}""",
    "news world",
    "world news",
    logs=["no", "a"],
)
case(
    "a menu's accept is its choices' default",
    "2.2.1",
    f"""<menu accept="approximate"><nomatch><log>no</log></nomatch>
    <choice next="#a">world sports</choice><choice accept="exact" next="#b">local news</choice>
    </menu>{ENDS}""",
    "news",
    "sports",
    logs=["no", "a"],
)
case(
    "a choice's grammar takes the place of its words",
    "2.2.2",
    f"""<menu><nomatch><log>no</log></nomatch><choice next="#a">{HOME} house</choice></menu>{ENDS}""",
    "house",
    "go home",
    logs=["no", "a"],
)
case(
    "a menu's prompts taper",
    "2.2",
    f"""<menu><prompt>News?</prompt><prompt count="2">Say news.</prompt>
    <noinput><reprompt/></noinput><choice next="#a">news</choice></menu>{ENDS}""",
    SILENT,
    said=["News?", "Say news."],
)
case(
    "a menu counts its events",
    "2.2",
    f"""<menu><nomatch><log>1</log></nomatch><nomatch count="2"><log>2</log></nomatch>
    <choice next="#a">news</choice></menu>{ENDS}""",
    "x",
    "x",
    logs=["1", "2"],
)
case(
    "a menu of document scope listens in other dialogs",
    "2.2.1",
    f"""<form><field name="f">{CITIES}</field></form>
    <menu scope="document"><choice next="#b">news</choice></menu>{ENDS}""",
    "news",
    logs=["b"],
)
case(
    "a menu of dialog scope does not",
    "2.2.1",
    f"""<form><field name="f">{CITIES}<nomatch><log>no</log></nomatch></field></form>
    <menu><choice next="#b">news</choice></menu>{ENDS}""",
    "news",
    logs=["no"],
)
case(
    "a menu is gone to like a form",
    "2.2",
    f"""<form><block>Hi.<goto next="#m"/></block></form>
    <menu id="m"><prompt>What?</prompt><choice next="#b">news</choice></menu>{ENDS}""",
    "news",
    said=["Hi.", "What?"],
    logs=["b"],
)
case(
    "a menu's prompt may be bare text",
    "2.2.1",
    f"""<menu>Welcome. <choice next="#b">news</choice></menu>{ENDS}""",
    said=["Welcome."],
)
case(
    "a choice to a dialog that is not there is error.badfetch",
    "2.2.2",
    """<menu><choice next="#zz">news</choice>
    <catch event="error.badfetch"><log>bad</log><exit/></catch></menu>""",
    "news",
    logs=["bad"],
)

# 2.5 Links ------------------------------------------------------------------------------

case(
    "a document's link leads to a dialog from any field",
    "2.5",
    f"""<link next="#b">{HOME}</link><form><field name="f">{CITIES}</field></form>{ENDS}""",
    "go home",
    logs=["b"],
)
case(
    "a form's link listens in that form alone",
    "2.5",
    f"""<form><field name="f">{CITIES}<nomatch><log>no</log></nomatch></field></form>
    <form><link event="x">{HOME}</link></form>""",
    "go home",
    logs=["no"],
)
case(
    "a form's link throws its event where the user is",
    "2.5",
    f"""<form><link event="odd" message="m">{HOME}</link><field name="f">{CITIES}
    <catch event="odd"><log expr="'field' + _message"/></catch></field>
    <catch event="odd"><log>form</log></catch></form>""",
    "go home",
    logs=["fieldm"],
)
case(
    "a link's event is counted by the item",
    "2.5",
    f"""<form><link event="help">{HOME}</link><field name="f">{CITIES}
    <help><log>1</log></help><help count="2"><log>2</log></help></field></form>""",
    "go home",
    "go home",
    logs=["1", "2"],
)
case(
    "a field's link listens in that field alone",
    "2.5",
    f"""<form><catch event="odd"><log>odd</log></catch><nomatch><log>no</log></nomatch>
    <field name="f"><link event="odd">{HOME}</link>{CITIES}</field>
    <field name="g">{CITIES}</field></form>""",
    "go home",
    "kyoto",
    "go home",
    logs=["odd", "no"],
)
case(
    "an initial's link listens there",
    "2.5",
    f"""<form>{TRIP}<catch event="odd"><log>odd</log></catch>
    <initial><link event="odd">{HOME}</link></initial><field name="start"/></form>""",
    "go home",
    logs=["odd"],
)
case(
    "a link's target may be computed",
    "2.5",
    f"""<form><var name="n" expr="'b'"/><link expr="'#' + n">{HOME}</link>
    <field name="f">{CITIES}</field></form>{ENDS}""",
    "go home",
    logs=["b"],
)
case(
    "a link's event may be computed",
    "2.5",
    f"""<form><var name="n" expr="1"/><link eventexpr="'odd.' + n" messageexpr="n + 1">{HOME}</link>
    <field name="f">{CITIES}<catch event="odd"><log expr="_event + _message"/></catch></field>
    </form>""",
    "go home",
    logs=["odd.12"],
)
case(
    "a link has a key",
    "2.5",
    f"""<link next="#b" dtmf="*9"/><form><field name="f">{CITIES}</field></form>{ENDS}""",
    "*9",
    logs=["b"],
)
case(
    "a field's grammar comes before a link's",
    "3.1.4",
    f"""<link event="odd">{HOME}</link><form><field name="f">{HOME}
    <filled><log expr="f"/></filled></field></form>""",
    "go home",
    logs=["go home"],
)
case(
    "the root's links listen in its leaves",
    "2.5",
    f"""{LEAF}<form><field name="f">{CITIES}<catch event="odd"><log>odd</log></catch></field></form>
    </vxml>""",
    "go home",
    logs=["odd"],
    files={"root": f"{PAGE}<link event='odd'>{HOME}</link></vxml>"},
)
case(
    "a menu hears links",
    "2.5",
    f"""<link next="#b">{HOME}</link><menu><choice next="#a">x</choice></menu>{ENDS}""",
    "go home",
    logs=["b"],
)
case(
    "an utterance that a link takes is the last result",
    "5.1.5",
    f"""<link next="#t">{HOME}</link><form><field name="f">{CITIES}</field></form>
    <form id="t"><block><log expr="application.lastresult$.utterance"/></block></form>""",
    "go home",
    logs=["go home"],
)

# 3.1.3 Forms of document scope (part of 2.1.5) ---------------------------------------------

case(
    "a form of document scope is entered by what its grammar takes",
    "2.1.6",
    f"""<form><field name="f"><prompt>Where?</prompt>{CITIES}</field></form>
    <form scope="document">{TRIP}<block><log>never</log></block>
    <field name="start"><prompt>From?</prompt><filled><log expr="start"/><exit/></filled></field>
    </form>""",
    "from Osaka",
    logs=["Osaka"],
    said=["Where?"],
)
case(
    "a form so entered asks for what is missing",
    "2.1.6",
    f"""<form><field name="f"><prompt>Where?</prompt>{CITIES}</field></form>
    <form scope="document">{TRIP}<field name="start"><prompt>From?</prompt></field>
    <field name="end"><prompt>To?</prompt></field></form>""",
    "from Osaka",
    said=["Where?", "To?"],
)
case(
    "a grammar of document scope makes its form listen",
    "3.1.3",
    f"""<form><field name="f"><prompt>Where?</prompt>{CITIES}</field></form>
    <form>{TRIP.replace("<grammar", '<grammar scope="document"')}<field name="start"/>
    <block><log expr="start"/></block></form>""",
    "from Osaka",
    logs=["Osaka"],
)
case(
    "a form of the root listens in its leaves and is entered with the root's variables kept",
    "1.5.2",
    f"""{LEAF}<form><block><assign name="n" expr="5"/></block><field name="f">{CITIES}</field></form>
    </vxml>""",
    "from Osaka",
    logs=["Osaka5"],
    files={
        "root": f"{PAGE}<var name='n' expr='1'/><form id='t' scope='document'>{TRIP}"
        "<field name='start'><filled><log expr='start + document.n'/></filled></field></form></vxml>"
    },
)

# 5.1 Variables --------------------------------------------------------------------------

case(
    "a variable without an expr is undefined",
    "5.3.1",
    "<form><var name='x'/><block><log expr='typeof x'/></block></form>",
    logs=["undefined"],
)
case(
    "inner variables shadow outer ones and scopes reach them",
    "5.1.2",
    f"""{LEAF}<var name="x" expr="'doc'"/><form><var name="x" expr="'dlg'"/><block>
    <var name="x" expr="'anon'"/>
    <log expr="[x, dialog.x, document.x, application.x].join()"/></block></form></vxml>""",
    logs=["anon,dlg,doc,app"],
    files={"root": f"{PAGE}<var name='x' expr=\"'app'\"/></vxml>"},
)
case(
    "an assignment reaches the innermost variable",
    "5.1.3",
    """<var name="x" expr="'doc'"/><form><var name="x" expr="'dlg'"/><block>
    <assign name="x" expr="'new'"/><log expr="dialog.x + document.x"/></block></form>""",
    logs=["newdoc"],
)
case(
    "an assignment may name its scope",
    "5.1.3",
    """<var name="x" expr="'doc'"/><form><var name="x" expr="'dlg'"/><block>
    <assign name="document.x" expr="'new'"/><log expr="dialog.x + document.x"/></block></form>""",
    logs=["dlgnew"],
)
case(
    "without a root the document is the application",
    "5.1.2",
    """<var name="x" expr="1"/><form><block><log expr="application.x"/>
    <assign name="application.x" expr="2"/><log expr="document.x"/></block></form>""",
    logs=["1", "2"],
)
case(
    "a root's variables are its document's as well",
    "5.1.2",
    f"""{LEAF}<form><block><goto next="root.vxml"/></block></form></vxml>""",
    logs=["3,3"],
    files={
        "root": f"{PAGE}<var name='x' expr='3'/><form><block>"
        "<log expr='[document.x, application.x].join()'/></block></form></vxml>"
    },
)
case(
    "an anonymous variable ends with its element",
    "5.1.2",
    """<form><block><var name="x" expr="1"/></block><block><log expr="typeof x"/></block></form>""",
    logs=["undefined"],
)
case(
    "an anonymous scope is each filled's and catch's own",
    "5.1.2",
    f"""<form><catch event="odd"><var name="y" expr="1"/><log expr="typeof x"/></catch>
    <field name="f">{CITIES}<filled><var name="x" expr="1"/><throw event="odd"/></filled></field>
    <block><log expr="typeof y"/></block></form>""",
    "kyoto",
    logs=["undefined", "undefined"],
)
case(
    "an if has no scope of its own",
    "5.1.2",
    """<form><block><if cond="true"><var name="x" expr="1"/></if><log expr="x"/></block></form>""",
    logs=["1"],
)
case(
    "a dialog's variables end with it",
    "5.1.2",
    """<form><var name="x" expr="1"/><block><goto next="#t"/></block></form>
    <form id="t"><block><log expr="typeof x"/></block></form>""",
    logs=["undefined"],
)
case(
    "a document's variables last from dialog to dialog",
    "5.1.2",
    """<var name="x" expr="1"/><form><block><assign name="x" expr="2"/><goto next="#t"/></block></form>
    <form id="t"><block><log expr="x"/></block></form>""",
    logs=["2"],
)
case(
    "a document fetched again is initialised again",
    "5.3.7",
    """<var name="x" expr="1"/><form><block><assign name="x" expr="2"/>
    <goto next="app.vxml#t"/></block></form><form id="t"><block><log expr="x"/></block></form>""",
    logs=["1"],
    files={
        "app": f"{PAGE}<var name='x' expr='1'/><form/><form id='t'><block><log expr='x'/></block>"
        "</form></vxml>"
    },
)
case(
    "a document's variables end with it",
    "5.1.2",
    """<var name="x" expr="1"/><form><block><goto next="other.vxml"/></block></form>""",
    logs=["undefined"],
    files={"other": f"{PAGE}<form><block><log expr='typeof x'/></block></form></vxml>"},
)
case(
    "the root's variables last from leaf to leaf",
    "1.5.2",
    f"""{LEAF}<form><block><assign name="application.x" expr="2"/><goto next="other.vxml"/></block>
    </form></vxml>""",
    logs=["2"],
    files={
        "root": f"{PAGE}<var name='x' expr='1'/></vxml>",
        "other": f"{LEAF}<form><block><log expr='x'/></block></form></vxml>",
    },
)
case(
    "the root's variables last from root to leaf",
    "1.5.2",
    """<var name="x" expr="1"/><form><block><assign name="x" expr="2"/><goto next="other.vxml"/>
    </block></form>""",
    logs=["2"],
    files={
        "other": f"{LEAF.replace('root', 'app')}<form><block><log expr='application.x'/></block>"
        "</form></vxml>"
    },
)
case(
    "another root begins another application",
    "1.5.2",
    f"""{LEAF}<form><block><assign name="x" expr="2"/><goto next="other.vxml"/></block></form>
    </vxml>""",
    logs=["undefined"],
    files={
        "root": f"{PAGE}<var name='x' expr='1'/></vxml>",
        "base": f"{PAGE}<var name='y' expr='1'/></vxml>",
        "other": f"{LEAF.replace('root', 'base')}<form><block><log expr='typeof x'/></block></form>"
        "</vxml>",
    },
)
case(
    "a variable that is not declared is error.semantic",
    "5.1.1",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><log expr="zz"/></block></form>""",
    logs=["semantic"],
)
case(
    "an assignment to one is error.semantic",
    "5.3.2",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><assign name="zz" expr="1"/></block></form>""",
    logs=["semantic"],
)
case(
    "an assignment to one of a named scope is error.semantic",
    "5.3.2",
    """<var name="x"/><form><catch event="error.semantic"><log>semantic</log></catch>
    <block><assign name="dialog.x" expr="1"/></block></form>""",
    logs=["semantic"],
)
case(
    "a variable's name has no scope prefix where it is declared",
    "5.3.1",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><var name="document.x" expr="1"/><log expr="document.x"/></block></form>""",
    logs=["semantic"],
)
case(
    "session variables are read only",
    "5.1.2",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><assign name="session.x" expr="1"/></block></form>""",
    logs=["semantic"],
)
case(
    "the session's connection may be looked at",
    "5.1.4",
    """<form><block><log expr="typeof session.connection.remote.uri"/>
    <log expr="typeof session.connection.protocol.name"/></block></form>""",
    logs=["undefined", "undefined"],
)
case(
    "the session's connection cannot be assigned",
    "5.1.4",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><assign name="session.connection" expr="1"/></block></form>""",
    logs=["semantic"],
)
case(
    "variables of a document are declared in order",
    "5.1.1",
    """<var name="a" expr="1"/><script>var b = a + 1;</script><var name="c" expr="b + 1"/>
    <form><block><log expr="c"/></block></form>""",
    logs=["3"],
)
case(
    "a variable may be declared again in its scope",
    "5.1.1",
    """<form><block><var name="a" expr="1"/><var name="a" expr="2"/><log expr="a"/></block></form>""",
    logs=["2"],
)
case(
    "an object's property may be assigned",
    "5.3.2",
    """<form><var name="o" expr="({})"/><block><assign name="o.p" expr="4"/><log expr="o.p"/></block>
    </form>""",
    logs=["4"],
)
case(
    "the last result has its properties and is an array",
    "5.1.5",
    f"""<form><field name="f">{CITIES}</field><block>
    <log expr="var_(application.lastresult$)"/></block>
    <script>function var_(r) {{ return [r.length, r[0].utterance, r.utterance, r.inputmode,
      r.interpretation, r[0].confidence].join(); }}</script></form>""",
    "Nara",
    logs=["1,Nara,Nara,voice,Nara,1"],
)
case(
    "the last result is the root's in a leaf",
    "5.1.5",
    f"""{LEAF}<form><field name="f">{CITIES}</field><block><goto next="other.vxml"/></block></form>
    </vxml>""",
    "Nara",
    logs=["Nara"],
    files={
        "root": f"{PAGE}</vxml>",
        "other": f"{LEAF}<form><block><log expr='application.lastresult$.utterance'/></block></form>"
        "</vxml>",
    },
)
case(
    "a form's grammar gives each field its shadow",
    "2.3.1",
    f"""<form>{TRIP}<field name="start"/><field name="end"/><filled>
    <log expr="start$.utterance + '/' + end$.utterance"/></filled></form>""",
    "from Nara to Osaka",
    logs=["from Nara to Osaka/from Nara to Osaka"],
)

# 5.2 Events -----------------------------------------------------------------------------


def thrown(handlers: str, event: str = "a.b.c", attributes: str = "") -> str:
    """A form whose block throws an event."""
    return f'<form>{handlers}<block><throw event="{event}" {attributes}/></block></form>'


case(
    "a handler takes an event by its whole name",
    "5.2.4",
    thrown("<catch event='a.b.c'><log>x</log></catch>"),
    logs=["x"],
)
case(
    "a handler takes events by a prefix of whole tokens",
    "5.2.4",
    thrown("<catch event='a.b'><log>x</log></catch>"),
    logs=["x"],
)
case(
    "part of a token is no prefix",
    "5.2.4",
    thrown("<catch event='a.b.cc a.bb a.'><log expr='_event'/></catch>", "a.bbb"),
    logs=["a.bbb"],
)
case(
    "half a token takes nothing",
    "5.2.4",
    thrown("<catch event='a.b'><log>x</log></catch>", "a.bc"),
    logs=[],
    ended="a.bc",
)
case(
    "a handler without an event takes all",
    "5.2.2",
    thrown("<catch><log expr='_event'/></catch>"),
    logs=["a.b.c"],
)
case(
    "a handler may name many events",
    "5.2.2",
    thrown("<catch event='x y a'><log>x</log></catch>"),
    logs=["x"],
)
case(
    "document order decides, not the longer name",
    "5.2.4",
    thrown("<catch event='a'><log>1</log></catch><catch event='a.b.c'><log>2</log></catch>"),
    logs=["1"],
)
case(
    "the inner scope comes first",
    "5.2.4",
    "<catch event='a.b.c'><log>doc</log></catch>"
    + thrown("<catch event='a'><log>form</log></catch>"),
    logs=["form"],
)
case(
    "a document's handler takes what the form does not",
    "5.2.4",
    "<catch event='a'><log>doc</log></catch>" + thrown("<catch event='b'><log>no</log></catch>"),
    logs=["doc"],
)
case(
    "the root's handler comes after the document's",
    "5.2.4",
    f"""{LEAF}<catch event="a"><log>leaf</log></catch><form><block><throw event="a"/></block>
    <block><throw event="b"/></block></form></vxml>""",
    logs=["leaf", "root"],
    files={"root": f"{PAGE}<catch event='a b'><log>root</log></catch></vxml>"},
)
case(
    "a handler whose condition is false is passed over",
    "5.2.4",
    thrown(
        "<catch event='a' cond='false'><log>1</log></catch>"
        "<catch event='a' cond=\"_event == 'a.b.c'\"><log>2</log></catch>"
    ),
    logs=["2"],
)
COUNTED = """<form><var name="n" expr="0"/>{handlers}<field name="f"><option>x</option></field>
  <block><log>end</log></block></form>"""
case(
    "the highest count that is reached is chosen",
    "5.2.2",
    COUNTED.format(
        handlers="<nomatch><log>1</log></nomatch><nomatch count='3'><log>3</log></nomatch>"
    ),
    "y",
    "y",
    "y",
    "y",
    logs=["1", "1", "3", "3"],
)
case(
    "a higher count in an outer scope wins",
    "5.2.4",
    """<nomatch count="2"><log>doc</log></nomatch><form><field name="f"><option>x</option>
    <nomatch><log>field</log></nomatch></field></form>""",
    "y",
    "y",
    logs=["field", "doc"],
)
case(
    "events are counted by full names and prefixes",
    "5.2.2",
    """<form><catch event="a" count="3"><log>third</log></catch>
    <catch event="a.b" count="2"><log>second b</log></catch>
    <catch event="a"><log expr="_event"/></catch>
    <field name="f"><option>x</option>
    <nomatch><throw event="a.b"/></nomatch><noinput><throw event="a.c"/></noinput></field></form>""",
    "y",
    SILENT,
    "y",
    logs=["a.b", "a.c", "third"],
)
case(
    "each item counts for itself",
    "5.2.2",
    """<form><nomatch><log>1</log></nomatch><nomatch count="2"><log>2</log></nomatch>
    <field name="f"><option>x</option></field><field name="g"><option>x</option></field></form>""",
    "y",
    "x",
    "y",
    logs=["1", "1"],
)
case(
    "counters start again when the form is entered again",
    "5.2.2",
    """<form id="a"><field name="f"><option>x</option><nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log><goto next="#a"/></nomatch></field></form>""",
    "y",
    "y",
    "y",
    logs=["1", "2", "1"],
)
case(
    "a field's counters last while the form does",
    "5.2.2",
    """<form><field name="f"><option>x</option><nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log></nomatch><filled><assign name="f" expr="undefined"/></filled>
    </field></form>""",
    "y",
    "x",
    "y",
    logs=["1", "2"],
)
case(
    "clear resets an item's event and prompt counters",
    "5.3.3",
    """<form><field name="f"><prompt>1?</prompt><prompt count="2">2?</prompt><option>x</option>
    <nomatch><log>1</log><reprompt/></nomatch><nomatch count="2"><log>2</log></nomatch>
    <filled><clear namelist="f"/></filled></field></form>""",
    "y",
    "x",
    "y",
    logs=["1", "1"],
    said=["1?", "2?", "1?", "2?"],
)
case(
    "the form's own counters are not reset by clear",
    "5.2.2",
    """<form><field name="f"><option>x</option></field><filled><clear/><throw event="odd"/></filled>
    <catch event="odd"><log>1</log></catch><catch event="odd" count="2"><log>2</log></catch></form>""",
    "x",
    "x",
    logs=["1", "2"],
)
case(
    "the event's name and message are the handler's",
    "5.2.2",
    thrown(
        "<catch event='a'><log expr=\"_event + ': ' + _message\"/></catch>",
        attributes="message='m'",
    ),
    logs=["a.b.c: m"],
)
case(
    "without a message it is undefined",
    "5.2.2",
    thrown("<catch event='a'><log expr='typeof _message'/></catch>"),
    logs=["undefined"],
)
case(
    "an error of the platform has a message",
    "5.2.2",
    """<form><catch event="error"><log expr="typeof _message + _event"/></catch>
    <block><assign name="zz" expr="1"/></block></form>""",
    logs=["stringerror.semantic"],
)
case(
    "the event's variables are seen in the handler alone",
    "5.2.2",
    """<form><catch event="a"><log>a</log></catch><block><throw event="a"/></block>
    <block><log expr="typeof _event"/></block></form>""",
    logs=["a", "undefined"],
)
case(
    "a variable called event is the document's own",
    "5.2.2",
    """<var name="event" expr="'mine'"/><form><catch event="a"><log expr="event"/></catch>
    <block><throw event="a"/></block></form>""",
    logs=["mine"],
)
case(
    "a throw may be computed",
    "5.2.1",
    """<form><var name="n" expr="'a'"/><catch event="a"><log expr="_event + _message"/></catch>
    <block><throw eventexpr="n + '.b'" messageexpr="n + 1"/></block></form>""",
    logs=["a.ba1"],
)
case(
    "a handler may throw on",
    "5.2.2",
    """<catch event="b"><log expr="_event"/></catch>
    <form><catch event="a"><throw event="b"/></catch><block><throw event="a"/></block></form>""",
    logs=["b"],
)
case(
    "an event thrown in a handler is looked for from the same scope",
    "5.2.2",
    """<form><field name="f"><option>x</option><nomatch><throw event="b"/></nomatch>
    <catch event="b"><log>field</log></catch></field><catch event="b"><log>form</log></catch></form>""",
    "y",
    logs=["field"],
)
case(
    "a handler may end the handling by throwing to a higher count",
    "5.2.2",
    """<form><catch event="a"><log>1</log><throw eventexpr="_event"/></catch>
    <catch event="a" count="2"><log>2</log></catch><block><throw event="a"/></block></form>""",
    logs=["1", "2"],
)
case(
    "a handler that throws to itself for ever is stopped",
    "5.2.2",
    thrown("<catch event='a'><throw event='a'/></catch>"),
    ended="error.semantic",
)
case(
    "a handler runs as if it were copied to where the event was thrown",
    "5.2.4",
    """<var name="x" expr="'doc'"/><catch event="a"><log expr="x"/><log expr="dialog.x"/></catch>
    <form><var name="x" expr="'dlg'"/><block><throw event="a"/></block></form>""",
    logs=["dlg", "dlg"],
)
case(
    "a handler's gotos are of the active document",
    "5.2.4",
    f"""{LEAF}<form><block><throw event="a"/></block></form>
    <form id="t"><block><log>leaf</log></block></form></vxml>""",
    logs=["leaf"],
    files={
        "root": f"{PAGE}<catch event='a'><goto next='#t'/></catch>"
        "<form id='t'><block><log>root</log></block></form></vxml>"
    },
)
case(
    "a handler's goto nextitem is of the active form",
    "5.2.4",
    """<catch event="a"><goto nextitem="c"/></catch><form><block><throw event="a"/></block>
    <block><log>b</log></block><block name="c"><log>c</log></block></form>""",
    logs=["c", "b"],
)
case(
    "the short names are handlers of their events",
    "5.2.3",
    """<form><error><log>error</log></error><block><throw event="error.odd"/></block>
    <help><log>help</log></help><block><throw event="help"/></block>
    <noinput><log>noinput</log></noinput><block><throw event="noinput"/></block>
    <nomatch><log>nomatch</log></nomatch><block><throw event="nomatch"/></block></form>""",
    logs=["error", "help", "noinput", "nomatch"],
)
case(
    "after a handler the form goes on",
    "5.2",
    """<form><catch event="a"><log>a</log></catch><block><throw event="a"/><log>no</log></block>
    <block><log>on</log></block></form>""",
    logs=["a", "on"],
    ended="exit",
)
case(
    "an error at a dialog's initialisation is handled",
    "5.2.2",
    """<form id="a"><catch event="error.semantic"><log>semantic</log><exit/></catch>
    <var name="x" expr="zz"/><block><log>no</log></block></form>""",
    logs=["semantic"],
)
case(
    "an error in a condition is error.semantic at its item",
    "5.2.6",
    """<form><catch event="error.semantic"><log>semantic</log><exit/></catch>
    <block cond="zz"><log>no</log></block></form>""",
    logs=["semantic"],
)

# 5.2.5 Default handlers ------------------------------------------------------------------

for _event in ("error.odd", "odd", "exit", "connection.disconnect.hangup"):
    case(
        f"{_event} that nothing takes ends the application",
        "5.2.5",
        f"""<form><block><throw event="{_event}"/></block><block><log>no</log></block></form>""",
        logs=[],
        ended=_event,
    )
for _event in ("cancel", "help", "help.more", "noinput", "nomatch", "maxspeechtimeout"):
    case(
        f"{_event} that nothing takes lets the application go on",
        "5.2.5",
        f"""<form><block><throw event="{_event}"/></block><block><log>on</log></block></form>""",
        logs=["on"],
        ended="exit",
    )
case(
    "prompts queued before an error ends the application are said",
    "4.1.8",
    "<form><block>Hello.<throw event='odd'/></block></form>",
    said=["Hello."],
    ended="odd",
)
case(
    "cancel that nothing takes does not ask again",
    "5.2.5",
    f"""<form><link event="cancel">{HOME}</link>
    <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    "go home",
    said=["Well?"],
)
case(
    "a nomatch that nothing takes asks again",
    "5.2.5",
    f"<form><field name='f'><prompt>1?</prompt><prompt count='2'>2?</prompt>{CITIES}</field></form>",
    "x",
    said=["1?", OOPS, "2?"],
)
case(
    "a noinput that nothing takes asks again",
    "5.2.5",
    f"<form><field name='f'><prompt>1?</prompt><prompt count='2'>2?</prompt>{CITIES}</field></form>",
    SILENT,
    said=["1?", "2?"],
)

# 5.2.6 Predefined events -----------------------------------------------------------------


def told(error: str, content: str) -> str:
    """A form whose content causes an error that a handler logs."""
    return f"""<form><catch event="{error}"><log expr="_event"/><exit/></catch>{content}</form>"""


for _error, _content in [
    ("error.badfetch", "<block><goto next='none.vxml'/></block>"),
    ("error.semantic", "<block><value expr='zz.y'/></block>"),
    ("error.unsupported.objectname", "<object name='o' classid='x'/>"),
    (
        "error.badfetch",
        "<field name='f'><grammar version='1.0' root='zz'><rule id='a'>x</rule></grammar></field>",
    ),
    ("error.unsupported.builtin", "<field name='f' type='zodiac'/>"),
    (
        "error.unsupported.format",
        "<field name='f'><grammar type='text/x-odd' src='g.odd'/></field>",
    ),
]:
    case(
        f"{_error} is thrown",
        "5.2.6",
        told(_error, _content),
        logs=[_error],
        files={"g.odd": "odd"},
    )
case(
    "a document that is no VoiceXML is error.badfetch",
    "5.2.6",
    told("error.badfetch", "<block><goto next='odd.vxml'/></block>"),
    logs=["error.badfetch"],
    files={"odd": "<vxml"},
)
case(
    "a dialog that is not there is error.badfetch",
    "5.3.7",
    told("error.badfetch", "<block><goto next='#zz'/></block>"),
    logs=["error.badfetch"],
)
case(
    "a dialog that is not there in another document is error.badfetch",
    "5.3.7",
    told("error.badfetch", "<block><goto next='other.vxml#zz'/></block>"),
    logs=["error.badfetch"],
    files={"other": f"{PAGE}<form/></vxml>"},
)
case(
    "prompts before a grammar that cannot be used are kept",
    "5.2.6",
    """<form><block>Hello.</block><field name="f"><prompt>Well?</prompt>
    <grammar src="none.grxml" type="application/srgs+xml"/></field><catch event="error.badfetch">
    Sorry.<exit/></catch></form>""",
    said=["Hello.", "Well?", "Sorry."],
)

# 5.3.6 Reprompt --------------------------------------------------------------------------

ASK = f"""<form><field name="f"><prompt>1?</prompt><prompt count="2">2?</prompt>
<prompt count="3">3?</prompt>{CITIES}%s</field><field name="g"><prompt>G?</prompt>{CITIES}</field>
</form>"""
case(
    "after a handler without reprompt nothing is asked again",
    "5.3.6",
    ASK % "<nomatch>No.</nomatch>",
    "x",
    said=["1?", "No."],
)
case(
    "a handler's prompt counts as the question, the counter stands still",
    "5.3.6",
    ASK % "<nomatch>No.</nomatch><noinput><reprompt/></noinput>",
    "x",
    SILENT,
    said=["1?", "No.", "2?"],
)
case(
    "reprompt asks after all that the handler says",
    "5.3.6",
    ASK % "<nomatch><reprompt/>No.</nomatch>",
    "x",
    said=["1?", "No.", "2?"],
)
case(
    "reprompt does not leave the handler",
    "5.3.6",
    ASK % "<nomatch><reprompt/><log>on</log></nomatch>",
    "x",
    logs=["on"],
)
case(
    "a goto to another item without reprompt is not asked",
    "5.3.6",
    ASK % "<nomatch>No.<goto nextitem='g'/></nomatch>",
    "x",
    said=["1?", "No."],
)
case(
    "a goto to another item with reprompt is asked",
    "5.3.6",
    ASK % "<nomatch>No.<reprompt/><goto nextitem='g'/></nomatch>",
    "x",
    said=["1?", "No.", "G?"],
)
case(
    "a dialog that a handler goes to is asked",
    "5.3.6",
    f"""<form id="a"><field name="f"><prompt>1?</prompt>{CITIES}
    <nomatch>No.<goto next="#a"/></nomatch></field></form>""",
    "x",
    said=["1?", "No.", "1?"],
)
case(
    "reprompt outside a handler does nothing",
    "5.3.6",
    f"""<form><field name="f"><prompt>1?</prompt>{CITIES}<nomatch>No.</nomatch>
    <filled><reprompt/><assign name="f" expr="undefined"/></filled></field></form>""",
    "kyoto",
    "x",
    said=["1?", "1?", "No."],
)
case(
    "only the next item goes without its prompts",
    "5.3.6",
    f"""<form><catch event="a">A.</catch><block><throw event="a"/></block>
    <block/><field name="f"><prompt>F?</prompt>{CITIES}</field></form>""",
    said=["A.", "F?"],
)
case(
    "an item visited next after a handler is not asked",
    "C",
    f"""<form><catch event="a">A.</catch><block><throw event="a"/></block>
    <field name="f"><prompt>F?</prompt>{CITIES}</field></form>""",
    said=["A."],
)

# 5.3 Executable content -----------------------------------------------------------------

case(
    "clear without a namelist clears all items and no variables",
    "5.3.3",
    """<form><var name="n" expr="0"/><block name="b"><assign name="n" expr="n + 1"/><log expr="n"/>
    </block><block><if cond="n &lt; 3"><clear/></if></block></form>""",
    logs=["1", "2", "3"],
)
case(
    "clear sets variables to undefined",
    "5.3.3",
    """<form><var name="n" expr="1"/><block><clear namelist="n"/><log expr="typeof n"/></block>
    </form>""",
    logs=["undefined"],
)
case(
    "clear of what is not declared is error.semantic",
    "5.3.3",
    told("error.semantic", "<block><clear namelist='zz'/></block>"),
    logs=["error.semantic"],
)
case(
    "if takes the first branch that holds",
    "5.3.4",
    """<form><block><if cond="false"><log>1</log><elseif cond="true"/><log>2</log>
    <elseif cond="true"/><log>3</log><else/><log>4</log></if></block></form>""",
    logs=["2"],
)
case(
    "else is for the rest",
    "5.3.4",
    """<form><block><if cond="false"><log>1</log><elseif cond="0"/><log>2</log>
    <else/><log>4</log></if><if cond="0"><log>5</log></if></block></form>""",
    logs=["4"],
)
case(
    "a goto leaves the content at once",
    "5.3.7",
    """<form><block><goto next="#t"/><log>no</log></block></form>
    <form id="t"><block><log>t</log></block></form>""",
    logs=["t"],
)
case(
    "goto may be computed",
    "5.3.7",
    """<form><block><goto expr="'#' + 't'"/></block></form>
    <form id="t"><block><log>t</log></block></form>""",
    logs=["t"],
)
case(
    "goto another document's first dialog",
    "5.3.7",
    """<form><block><goto next="other.vxml"/></block></form>""",
    logs=["first"],
    files={"other": f"{PAGE}<form><block><log>first</log></block></form></vxml>"},
)
case(
    "prompts queued before a goto are said",
    "4.1.8",
    """<form><block>One.<goto next="#t"/></block></form><form id="t"><block>Two.</block></form>""",
    said=["One.", "Two."],
)
case(
    "submit fetches a document",
    "5.3.8",
    """<form><var name="n" expr="1"/><block><submit next="other.vxml" namelist="n"/></block></form>""",
    logs=["got"],
    files={"other": f"{PAGE}<form><block><log>got</log></block></form></vxml>"},
)
case(
    "submit of a variable that is not declared is error.semantic",
    "5.3.8",
    told("error.semantic", "<block><submit next='other.vxml' namelist='zz'/></block>"),
    logs=["error.semantic"],
    files={"other": f"{PAGE}<form/></vxml>"},
)
case(
    "exit ends the application and throws nothing",
    "5.3.9",
    """<form><catch><log>no</log></catch><block>Bye.<exit/><log>no</log></block></form>""",
    said=["Bye."],
    logs=[],
    ended="exit",
)
case(
    "exit's expression is evaluated",
    "5.3.9",
    told("error.semantic", "<block><exit expr='zz'/></block>"),
    logs=["error.semantic"],
)
case(
    "disconnect throws connection.disconnect.hangup",
    "5.3.11",
    """<form><catch event="connection.disconnect.hangup"><log>hangup</log></catch>
    <block><disconnect/></block></form>""",
    logs=["hangup"],
)
case(
    "disconnect says what is queued first",
    "5.3.11",
    """<form><catch event="connection.disconnect.hangup"><log>hangup</log></catch>
    <block>Bye.<disconnect/></block></form>""",
    said=["Bye."],
    logs=["hangup"],
)
case(
    "after a disconnect the application comes to its end where it would wait",
    "1.5.4",
    f"""<form><catch event="connection.disconnect.hangup"><log>hangup</log></catch>
    <block><disconnect/></block><block><log>on</log></block>
    <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    logs=["hangup", "on"],
    said=[],
    ended="connection.disconnect.hangup",
)
case(
    "a thrown connection.disconnect is an event like others",
    "5.2.1",
    f"""<form><catch event="connection.disconnect"><log>caught</log></catch>
    <block><throw event="connection.disconnect.hangup"/></block>
    <block>On.</block><field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    logs=["caught"],
    said=["On.", "Well?"],
)
case(
    "a script's functions and variables are of the scope it stands in",
    "5.3.12",
    """<script>var d = 1; function twice(x) { return x * 2; }</script>
    <form><script>var e = twice(d);</script><block><script>var f = e + 1;</script>
    <log expr="document.d + ',' + dialog.e + ',' + f"/></block>
    <block><log expr="typeof f"/></block></form>""",
    logs=["1,2,3", "undefined"],
)
case(
    "a script may be fetched",
    "5.3.12",
    """<script src="s.js"/><form><block><log expr="f(2)"/></block></form>""",
    logs=["4"],
    files={"s.js": "function f(x) { return x * x; }"},
)
case(
    "a script assigns variables of its scopes",
    "5.3.12",
    """<var name="x" expr="1"/><form><block><script>x = 7;</script><log expr="document.x"/></block>
    </form>""",
    logs=["7"],
)
case(
    "a script that is not there is error.badfetch",
    "5.3.12",
    told("error.badfetch", "<block><script src='none.js'/></block>"),
    logs=["error.badfetch"],
)
case(
    "a script that fails is error.semantic",
    "5.3.12",
    told("error.semantic", "<block><script>null.x;</script></block>"),
    logs=["error.semantic"],
)
case(
    "log takes text, values, an expression and a label",
    "5.3.13",
    """<form><block><log label="l" expr="1 + 1">a <value expr="'b'"/> </log></block></form>""",
    logs=["l: a b 2"],
)
case(
    "log says nothing",
    "5.3.13",
    "<form><block><log>quiet</log></block></form>",
    said=[],
)
case(
    "foreach runs its content for each element",
    "2.1, 6",
    """<form><var name="list" expr="['a', 'b']"/><block><foreach item="x" array="list">
    <if cond="x == 'a'"><log>first</log></if><log expr="x"/><prompt><value expr="x"/></prompt>
    </foreach></block></form>""",
    logs=["first", "a", "b"],
    said=["a", "b"],
)
case(
    "foreach of no array is error.semantic",
    "2.1, 6",
    told("error.semantic", "<block><foreach item='x' array='5'><log>no</log></foreach></block>"),
    logs=["error.semantic"],
)
case(
    "foreach goes through a copy of the array",
    "2.1, 6",
    """<form><var name="list" expr="[1, 2]"/><block><foreach item="x" array="list">
    <script>list.push(x + 10);</script><log expr="x"/></foreach><log expr="list.length"/></block>
    </form>""",
    logs=["1", "2", "4"],
)
case(
    "foreach in a prompt says its content for each element",
    "2.1, 6",
    """<form><var name="list" expr="['a', 'b']"/><block><prompt>So
    <foreach item="x" array="list"><value expr="x"/> and </foreach> on.</prompt></block></form>""",
    said=["So a and b and on."],
)
case(
    "a prompt's condition decides whether it is said",
    "4.1",
    """<form><block><prompt cond="false">No.</prompt><prompt cond="true">Yes.</prompt></block></form>""",
    said=["Yes."],
)
case(
    "var in content makes an anonymous variable",
    "5.3.1",
    """<form><var name="x" expr="1"/><block><var name="x" expr="2"/><log expr="x"/></block>
    <block><log expr="x"/></block></form>""",
    logs=["2", "1"],
)

case(
    "bare text in a field is a prompt of the first count",
    "4.1.2",
    f"""<form><field name="f">Where <value expr="1 + 1"/>?{CITIES}
    <prompt count="2">Which city?</prompt></field></form>""",
    "x",
    said=["Where 2?", OOPS, "Which city?"],
)
case(
    "a handler in a menu enumerates its choices",
    "2.2.4",
    f"""<menu><choice next="#a">sports</choice><choice next="#b">news</choice>
    <nomatch>Say <enumerate/>.</nomatch></menu>{ENDS}""",
    "x",
    said=["Say sports; news."],
)
case(
    "a handler in a field enumerates its options",
    "2.2.4",
    f"""<form><field name="f">{CITIES}<nomatch>Say <enumerate/>.</nomatch></field></form>""",
    "x",
    said=["Say Kyoto; Nara."],
)
case(
    "a goto nextitem out of a filled asks as usual",
    "5.3.6",
    f"""<form><field name="f"><prompt>F?</prompt>{CITIES}<filled><goto nextitem="h"/></filled></field>
    <field name="g"><prompt>G?</prompt>{CITIES}</field>
    <field name="h"><prompt>H?</prompt>{CITIES}</field></form>""",
    "nara",
    "nara",
    said=["F?", "H?", "G?"],
)
case(
    "a handler in a subdialog may return",
    "5.3.10",
    f"""<form><subdialog name="s" src="#t"><filled><log expr="s.n"/></filled></subdialog></form>
    <form id="t"><var name="n" expr="8"/><field name="f">{CITIES}
    <nomatch><return namelist="n"/></nomatch></field></form>""",
    "x",
    logs=["8"],
)
case(
    "a subdialog's handler of a returned event may go to another item",
    "2.3.4",
    """<form><subdialog name="s" src="#t"><catch event="odd"><goto nextitem="b"/></catch></subdialog>
    <block><log>no</log></block><block name="b"><log>b</log><exit/></block></form>
    <form id="t"><block><return event="odd"/></block></form>""",
    logs=["b"],
)
case(
    "a handler may end the application",
    "5.3.9",
    """<form><catch event="a">Bye.<exit/></catch><block><throw event="a"/></block></form>""",
    said=["Bye."],
    ended="exit",
)
case(
    "after a returned event the caller's document is as it was",
    "2.3.4",
    """<var name="n" expr="1"/><catch event="odd"><log expr="document.n"/><exit/></catch>
    <form><block><assign name="n" expr="2"/></block><subdialog name="s" src="#t"/></form>
    <form id="t"><block><return event="odd"/></block></form>""",
    logs=["2"],
)
case(
    "error takes every error",
    "5.2.3",
    """<form><error><log expr="_event"/><exit/></error><block><goto next="none.vxml"/></block></form>""",
    logs=["error.badfetch"],
)
case(
    "a condition may look at what has been filled",
    "2.1.5",
    f"""<form>{TRIP}<field name="start"><prompt>From?</prompt></field>
    <field name="end" cond="start == 'Nara'"><prompt>To?</prompt></field>
    <block><log expr="typeof end"/></block></form>""",
    "from Kyoto",
    said=["From?"],
    logs=["undefined"],
)
case(
    "an item that was filled out of turn is not asked for",
    "2.1.5",
    f"""<form>{TRIP}<field name="start"><prompt>From?</prompt></field>
    <field name="end"><prompt>To?</prompt></field></form>""",
    "to Nara",
    "from Kyoto",
    said=["From?", "From?"],
    ended="exit",
)
case(
    "help that nothing takes has words of the platform's own",
    "5.2.5",
    f"""<form><link event="help">{HOME}</link>
    <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    "go home",
    said=["Well?", "There is no help here.", "Well?"],
)

# Rules together -------------------------------------------------------------------------

case(
    "a throw within foreach and if leaves all of it",
    "5.2.1",
    """<form><catch event="a"><log expr="typeof x"/></catch><block>
    <foreach item="x" array="[1, 2]"><if cond="x == 1"><log expr="x"/><throw event="a"/></if></foreach>
    </block></form>""",
    logs=["1", "undefined"],
)
case(
    "a subdialog's result does not leave initial",
    "2.1.6.2",
    f"""<form>{TRIP}<subdialog name="s" src="#t"/><initial name="i"><prompt>Trip?</prompt></initial>
    <field name="start"/></form><form id="t"><block><return/></block></form>""",
    said=["Trip?"],
)
case(
    "an error in a document's variables is handled by its handlers",
    "5.2.2",
    """<catch event="error.semantic"><log>semantic</log><goto next="#t"/></catch>
    <var name="x" expr="zz"/><form><block><log>no</log></block></form>
    <form id="t"><block><log>t</log></block></form>""",
    logs=["semantic", "t"],
)
case(
    "a root that is not there is error.badfetch",
    "1.5.2",
    """<catch event="error.badfetch"><log>bad</log><exit/></catch>
    <form><block><goto next="leaf.vxml"/></block></form>""",
    logs=["bad"],
    files={"leaf": f"{LEAF}<form/></vxml>"},
)
case(
    "a goto that fails leaves its dialog as it is",
    "5.2.6",
    """<form><var name="n" expr="1"/><catch event="error.badfetch"><log>bad</log></catch>
    <block><assign name="n" expr="2"/><goto next="leaf.vxml"/></block>
    <block><log expr="n"/></block></form>""",
    logs=["bad", "2"],
    files={"leaf": f"{LEAF}<form/></vxml>"},
)
case(
    "an error in a root's variables is the leaf's to handle",
    "1.5.2",
    f"""{LEAF}<catch event="error.semantic"><log>leaf</log><goto next="#t"/></catch><form/>
    <form id="t"><block><log>t</log></block></form></vxml>""",
    logs=["leaf", "t"],
    files={
        "root": f"{PAGE}<var name='x' expr='zz'/><catch event='error'><log>root</log></catch></vxml>"
    },
)
case(
    "a function of the root sees the root's variables",
    "5.1.2",
    f"""{LEAF}<var name="x" expr="'leaf'"/><form><block><log expr="f()"/></block></form></vxml>""",
    logs=["root"],
    files={
        "root": f"{PAGE}<var name='x' expr=\"'root'\"/><script>function f() {{ return x; }}</script></vxml>"
    },
)
case(
    "a field shadows a document's variable of its name",
    "5.1.2",
    f"""<var name="f" expr="1"/><form><field name="f">{CITIES}</field>
    <block><log expr="f + document.f + dialog.f"/></block></form>""",
    "nara",
    logs=["Nara1Nara"],
)
case(
    "a disconnect in a subdialog is the subdialog's event",
    "5.3.11",
    """<form><catch event="connection"><log>caller</log></catch><subdialog name="s" src="#t"/></form>
    <form id="t"><catch event="connection"><log>subdialog</log><exit/></catch>
    <block><disconnect/></block></form>""",
    logs=["subdialog"],
)
case(
    "a handler at initialisation may go to an item",
    "2.1.6.1",
    """<form><catch event="error"><goto nextitem="b"/></catch><var name="x" expr="zz"/>
    <block><log>a</log></block><block name="b"><log>b</log><exit/></block></form>""",
    logs=["b"],
)
case(
    "an item with a first value counts as filled for the others",
    "2.4",
    f"""<form><field name="a" expr="'x'">{CITIES}</field><field name="b">{CITIES}</field>
    <filled><log expr="a + b"/></filled></form>""",
    "nara",
    logs=["xNara"],
)
case(
    "an item whose expr is undefined is visited",
    "2.1.5",
    f"""<form><field name="a" expr="undefined"><prompt>A?</prompt>{CITIES}</field></form>""",
    said=["A?"],
)
case(
    "an expr that is undefined leaves a variable undefined",
    "5.3.1",
    """<var name="x" expr="undefined"/><form><block><log expr="typeof x"/></block></form>""",
    logs=["undefined"],
)
case(
    "a nomatch that is thrown counts with those that were heard",
    "5.2.2",
    f"""<form><field name="a">{CITIES}<nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log></nomatch><filled><clear namelist="zz"/></filled></field>
    <var name="zz"/></form>""",
    "x",
    "x",
    logs=["1", "2"],
)
case(
    "an event thrown in a filled is counted by its field",
    "5.2.2",
    f"""<form><field name="a">{CITIES}<nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log></nomatch>
    <filled><assign name="a" expr="undefined"/><throw event="nomatch"/></filled></field></form>""",
    "x",
    "nara",
    logs=["1", "2"],
)
case(
    "a goto to an item from a menu is error.badfetch",
    "5.3.7",
    """<menu><choice event="a">news</choice><catch event="a"><goto nextitem="x"/></catch>
    <catch event="error.badfetch"><log>bad</log><exit/></catch></menu>""",
    "news",
    logs=["bad"],
)
case(
    "a menu's choice may ask for help",
    "2.2.2",
    """<menu><prompt>News?</prompt><choice event="help">what</choice>
    <help>Say news.<reprompt/></help></menu>""",
    "what",
    said=["News?", "Say news.", "News?"],
)
case(
    "a subdialog's item is visited again when it is cleared",
    "5.3.3",
    """<form><var name="n" expr="0"/><subdialog name="s" src="#t"><filled>
    <assign name="n" expr="n + 1"/><if cond="n == 1"><clear namelist="s"/></if></filled></subdialog>
    </form><form id="t"><block><log>in</log><return/></block></form>""",
    logs=["in", "in"],
)
case(
    "false, nought, null and empty values fill an item",
    "2.1.5",
    """<form><block name="a" expr="false"><log>a</log></block><block name="b" expr="0"><log>b</log>
    </block><block name="c" expr="null"><log>c</log></block><block name="d" expr="''"><log>d</log>
    </block></form>""",
    logs=[],
    ended="exit",
)
case(
    "a field's no is an answer",
    "2.3.1",
    """<form><field name="f" type="boolean"><filled><log expr="f"/></filled></field>
    <filled><log>form</log></filled></form>""",
    "no",
    logs=["false", "form"],
    ended="exit",
)
case(
    "a form's handlers hear of what its last item threw",
    "5.2.2",
    """<form><block/><catch event="a"><log>a</log></catch><block><throw event="a"/></block></form>""",
    logs=["a"],
    ended="exit",
)
case(
    "a dialog of the root may be gone to from a leaf",
    "1.5.2",
    f"""{LEAF}<form><block><assign name="x" expr="2"/><goto next="root.vxml#t"/></block></form>
    </vxml>""",
    logs=["2"],
    files={
        "root": f"{PAGE}<var name='x' expr='1'/><form/><form id='t'><block><log expr='x'/></block>"
        "</form></vxml>"
    },
)
case(
    "of two choices with the same words the first is taken",
    "3.1.4",
    f"""<menu><choice next="#a">news</choice><choice next="#b">news</choice></menu>{ENDS}""",
    "news",
    logs=["a"],
)
case(
    "a handler's variable is its own in each run",
    "5.1.2",
    f"""<form><field name="f">{CITIES}<nomatch><log expr="typeof n"/><var name="n" expr="1"/></nomatch>
    </field></form>""",
    "x",
    "x",
    logs=["undefined", "undefined"],
)
case(
    "a computed goto to what is not declared is error.semantic",
    "5.3.7",
    told("error.semantic", "<block><goto expr='zz'/></block>"),
    logs=["error.semantic"],
)
case(
    "a computed throw of what is not declared is error.semantic",
    "5.2.1",
    told("error.semantic", "<block><throw eventexpr='zz'/></block>"),
    logs=["error.semantic"],
)
case(
    "an error in a handler's condition is an event itself",
    "5.2.4",
    """<form><catch event="a" cond="zz"><log>a</log></catch>
    <catch event="error.semantic"><log expr="_event"/><exit/></catch>
    <block><throw event="a"/></block></form>""",
    logs=["error.semantic"],
)
case(
    "the condition of a handler that takes another event is not looked at",
    "5.2.4",
    """<form><catch event="b" cond="zz"><log>b</log></catch>
    <catch event="a"><log>a</log></catch><block><throw event="a"/></block></form>""",
    logs=["a"],
)


@pytest.mark.parametrize("one", CASES)
def test_rule(one: Case) -> None:
    call = Call(one.text, **one.files)
    for text in one.says:
        if text == SILENT:
            call.silent()
        else:
            call.answer(text)
    call.play()
    if one.logs is not None:
        assert call.logs() == one.logs
    if one.said is not None:
        assert call.said() == one.said
    if one.ended is not None:
        assert call.ended.partition(":")[0] == one.ended


# What no document says of itself -----------------------------------------------------------


def test_a_hangup_from_outside_ends_the_application() -> None:
    """1.5.4: what nothing takes ends it."""
    call = Call(f"<form><field name='f'>{CITIES}</field></form>")
    call.event("connection.disconnect.hangup")
    assert call.ended == "connection.disconnect.hangup"


def test_a_hangup_from_outside_is_handled_without_waiting_again() -> None:
    """1.5.4: the final processing state."""
    call = Call(
        f"""<form><catch event="connection.disconnect"><log>bye</log>Bye!</catch>
        <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>"""
    )
    call.play()
    call.event("connection.disconnect.hangup")
    call.play()
    assert (call.logs(), call.said()) == (["bye"], ["Well?"])
    assert call.ended == "connection.disconnect.hangup"


def test_an_event_from_outside_that_nothing_takes_changes_nothing() -> None:
    """A robot's world has more events than a telephone's; only errors are for everyone."""
    call = Call(f"<form><field name='f'><prompt>Well?</prompt>{CITIES}</field></form>")
    call.play()
    call.event("touch.head")
    call.answer("nara")
    assert (call.said(), call.ended) == (["Well?"], "exit")


def test_an_event_from_outside_counts_at_the_item() -> None:
    """5.2.2."""
    call = Call(
        f"""<form><catch event="touch"><log>1</log></catch>
        <catch event="touch" count="2"><log>2</log></catch><field name="f">{CITIES}</field></form>"""
    )
    call.event("touch.head")
    call.event("touch.arm")
    assert call.logs() == ["1", "2"]


def test_an_event_from_outside_does_not_cut_the_last_words() -> None:
    """4.1.8: what is queued is said before the application ends."""
    call = Call("<catch event='touch'><log>no</log></catch><form><block>Good bye.</block></form>")
    call.event("touch.head")
    call.play()
    assert (call.logs(), call.said(), call.ended) == ([], ["Good bye."], "exit")


@pytest.mark.parametrize(
    "text",
    [
        "<form id='a'><block><goto next='#a'/></block></form>",
        "<form><catch event='error'/><block cond='zz'/></form>",
        "<form><catch event='error'/><subdialog name='s' src='none.vxml'/></form>",
        "<form><catch event='a'><clear/></catch><block><throw event='a'/></block></form>",
        "<catch event='error'><goto next='#a'/></catch><form id='a'><var name='x' expr='zz'/></form>",
        "<form id='a'><subdialog name='s' src='#a'/></form>",
    ],
)
def test_an_application_that_never_waits_is_stopped(text: str) -> None:
    """C: the algorithm has no bound, the robot has."""
    assert Call(text).ended.startswith("error.semantic")


def test_tags_of_grammars_are_told_the_runs_date() -> None:
    grammar = (
        '<grammar version="1.0" root="r" tag-format="semantics/1.0" xml:lang="en">'
        '<rule id="r">today<tag>out = new Date().toISOString()</tag></rule></grammar>'
    )
    call = Call(
        f'<form><field name="day"><prompt>When?</prompt>{grammar}'
        '<filled><log expr="day"/></filled></field></form>'
    )
    call.answer("today")
    (logged,) = call.logs()
    assert logged.startswith("2005-03-01T10:00:")
