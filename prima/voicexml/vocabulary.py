"""The elements of VoiceXML 2.0 and 2.1 as a table: their attributes and what they may hold."""

from __future__ import annotations

from prima.language.commands import TABLE_4_2
from prima.markup.vocabulary import Attribute, Element, Vocabulary

NAMESPACE = "http://www.w3.org/2001/vxml"
SRGS = "http://www.w3.org/2001/06/grammar"

PRIMA_NAMESPACE = "urn:prima:dialogue:1"

COMMANDS = frozenset(TABLE_4_2) - {"q-and-a"} | {"command"}
"""Elements of PRIMA's namespace that executable content may hold."""

SPEECH = "audio break emphasis enumerate mark phoneme prosody say-as sub voice value"
PARAGRAPH = f"{SPEECH} s sentence said-foreach"
BLOCKS = f"{PARAGRAPH} p paragraph"
EXECUTABLE = (
    "assign audio clear data disconnect enumerate exit foreach goto if log prompt reprompt return"
    " script submit throw value var"
)
HANDLERS = "catch error help noinput nomatch"
ITEM = "name expr cond"
FETCH = "fetchhint fetchtimeout maxage maxstale"

# Each line: element, or a key of its own for it = element | attributes (* required) | children | text? | section of VoiceXML 2.0.
TABLE = f"""
vxml|version* application xml:base xml:lang|{HANDLERS} data form link menu meta metadata property script var||1.5
form|id scope|{HANDLERS} block data field filled grammar initial link object property record script subdialog transfer var||2.1
menu|id scope dtmf accept|{HANDLERS} audio choice enumerate property prompt value|text|2.2
choice|dtmf accept next expr event eventexpr message messageexpr fetchaudio {FETCH}|{BLOCKS} grammar|text|2.2
enumerate||{BLOCKS}|text|2.2.4
block|{ITEM}|{EXECUTABLE}|text|2.3.2
field|{ITEM} type slot modal xml:lang|{HANDLERS} audio enumerate filled grammar link option prompt property value|text|2.3.1
initial|{ITEM}|{HANDLERS} audio enumerate link prompt property value|text|2.3.3
option|dtmf accept value||text|2.3.1.3
object|{ITEM} classid codebase codetype data type archive {FETCH}|{HANDLERS} audio enumerate filled param prompt property value|text|2.3.5
record|{ITEM} modal beep maxtime finalsilence dtmfterm type dest|{HANDLERS} audio enumerate filled grammar prompt property value|text|2.3.6
subdialog|{ITEM} namelist src srcexpr method enctype fetchaudio {FETCH}|{HANDLERS} audio enumerate filled param prompt property value|text|2.3.4
transfer|{ITEM} dest destexpr bridge type connecttimeout maxtime transferaudio aai aaiexpr|{HANDLERS} audio enumerate filled grammar prompt property value|text|2.3.7
filled|mode namelist|{EXECUTABLE}|text|2.4
link|next expr event eventexpr message messageexpr dtmf fetchaudio {FETCH}|grammar||2.5
grammar|version xml:lang mode root tag-format xml:base src srcexpr scope type weight {FETCH}|example lexicon meta metadata one-of item rule ruleref tag token|text|3.1
catch|event cond count|{EXECUTABLE}|text|5.2.2
error|cond count|{EXECUTABLE}|text|5.2.3
help|cond count|{EXECUTABLE}|text|5.2.3
noinput|cond count|{EXECUTABLE}|text|5.2.3
nomatch|cond count|{EXECUTABLE}|text|5.2.3
prompt|bargein bargeintype cond count timeout xml:lang xml:base|{BLOCKS} lexicon meta metadata|text|4.1
audio|src expr {FETCH}|{BLOCKS} desc|text|4.1.3
value|expr* class mode recsrc|||4.1.4
break|strength time size|||4.1.1
emphasis|level|{SPEECH}|text|4.1.1
mark|name nameexpr|||4.1.1
phoneme|ph* alphabet||text|4.1.1
prosody|pitch contour range rate duration volume|{BLOCKS}|text|4.1.1
say-as|interpret-as format detail type|value|text|4.1.1
sub|alias*||text|4.1.1
voice|xml:lang gender age variant name|{BLOCKS}|text|4.1.1
p|xml:lang|{PARAGRAPH}|text|4.1.1
s|xml:lang|{SPEECH}|text|4.1.1
paragraph|xml:lang|{PARAGRAPH}|text|4.1.1
sentence|xml:lang|{SPEECH}|text|4.1.1
desc|xml:lang||text|4.1.3
lexicon|uri* type|||4.1.1
meta|name content* http-equiv|||6.2
metadata||*|text|6.2.2
property|name* value*|||6.3
param|name* expr value valuetype type|||6.4
var|name* expr|||5.3.1
assign|name* expr*|||5.3.2
clear|namelist|||5.3.3
if|cond*|{EXECUTABLE} else elseif|text|5.3.4
elseif|cond*|||5.3.4
else||||5.3.4
reprompt||||5.3.6
goto|next expr nextitem expritem fetchaudio {FETCH}|||5.3.7
submit|next expr namelist method enctype fetchaudio {FETCH}|||5.3.8
exit|expr namelist|||5.3.9
return|namelist event eventexpr message messageexpr|||5.3.10
disconnect|namelist|||5.3.11
script|src srcexpr charset {FETCH}||text|5.3.12
log|label expr|value|text|5.3.13
throw|event eventexpr message messageexpr|||5.2.1
foreach|array* item*|{EXECUTABLE}|text|VoiceXML 2.1, 6
said-foreach=foreach|array* item*|{BLOCKS}|text|VoiceXML 2.1, 6
data|src srcexpr name method enctype namelist fetchaudio {FETCH}|||VoiceXML 2.1, 5
"""
GRAMMAR_PARTS = {"example", "one-of", "item", "rule", "ruleref", "tag", "token"}


def _elements() -> list[Element]:
    made = []
    for row in TABLE.strip().splitlines():
        names, attributes, children, text, section = row.split("|")
        key, _, name = names.partition("=")
        held = [
            Attribute(word.rstrip("*"), "text", "", word.endswith("*"))
            for word in attributes.split()
        ]
        kept = tuple(
            dict.fromkeys(
                child for child in children.split() if child != "*" and child not in GRAMMAR_PARTS
            )
        )
        made.append(Element(key, "", tuple(held), kept, bool(text), name, section))
    return made


VOICEXML = Vocabulary(NAMESPACE, "voicexml", "vxml", _elements())
"""VoiceXML's elements; grammars are checked by :mod:`prima.grammar`."""

SPOKEN = frozenset(BLOCKS.split()) - {"said-foreach"} | {"prompt"}
"""Elements that are said; all but ``prompt`` are a prompt even without one around (4.1.2)."""
WORDED = frozenset(tag for tag in SPOKEN - {"prompt", "enumerate"} if VOICEXML.elements[tag].text)
"""Elements of speech markup whose text is a part of that around them."""
HOLDING = frozenset(
    key
    for key in (SPOKEN | {"said-foreach"}) - {"enumerate"}
    if "break" in VOICEXML.elements[key].children
)
"""Elements besides executable content in which a Command of the robot may stand."""

ALTERNATIVES = {
    "goto": ("next expr nextitem expritem !",),
    "submit": ("next expr !",),
    "link": ("next expr event eventexpr !", "message messageexpr"),
    "choice": ("next expr event eventexpr !", "message messageexpr"),
    "throw": ("event eventexpr !", "message messageexpr"),
    "return": ("event eventexpr namelist", "message messageexpr"),
    "subdialog": ("src srcexpr !",),
    "data": ("src srcexpr !",),
    "transfer": ("dest destexpr !", "bridge type", "aai aaiexpr"),
    "exit": ("expr namelist",),
    "audio": ("src expr !",),
    "mark": ("name nameexpr !",),
    "param": ("expr value !",),
    "meta": ("name http-equiv !",),
    "script": ("src srcexpr content !",),
    "grammar": ("src srcexpr content !",),
}
"""Attributes of which at most one may stand, or with ``!`` exactly one; ``content`` is the
element's own content (each element's own section)."""
_TRUTH, _TIME = "true false", "time"
VALUES = {
    "bargein": _TRUTH,
    "modal": _TRUTH,
    "beep": _TRUTH,
    "dtmfterm": _TRUTH,
    "bridge": _TRUTH,
    "menu dtmf": _TRUTH,
    "bargeintype": "speech hotword",
    "scope": "dialog document",
    "accept": "exact approximate",
    "filled mode": "any all",
    "grammar mode": "voice dtmf",
    "method": "get post",
    "valuetype": "data ref",
    "transfer type": "bridge blind consultation",
    "fetchhint": "prefetch safe",
    "break strength": "none x-weak weak medium strong x-strong",
    "break size": "none small medium large",
    "break time": _TIME,
    "prosody duration": _TIME,
    "prosody rate": "rate",
    "emphasis level": "strong moderate none reduced",
    "voice gender": "male female neutral",
    "count": "integer",
    "timeout": _TIME,
    "fetchtimeout": _TIME,
    "maxtime": _TIME,
    "finalsilence": _TIME,
    "connecttimeout": _TIME,
}
"""What attributes may say: words, a time, a rate of speech, or a whole number from 1; an
element's own come first."""
EXPRESSIONS = frozenset(
    [
        "expr",
        "cond",
        "eventexpr",
        "messageexpr",
        "srcexpr",
        "destexpr",
        "expritem",
        "aaiexpr",
        "array",
        "nameexpr",
    ]
)
"""Attributes that hold ECMAScript."""
