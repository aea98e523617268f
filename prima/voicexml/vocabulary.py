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

# Each line: element, or a key of its own for it = element | attributes (* required) | children | text? | section of VoiceXML 2.0 | what it is.
TABLE = f"""
vxml|version* application xml:base xml:lang|{HANDLERS} data form link menu meta metadata property script var||1.5|A VoiceXML document.
form|id scope|{HANDLERS} block data field filled grammar initial link object property record script subdialog transfer var||2.1|A dialog that presents information and gathers input.
menu|id scope dtmf accept|{HANDLERS} audio choice enumerate property prompt value|text|2.2|A dialog that lets the user choose where to go.
choice|dtmf accept next expr event eventexpr message messageexpr fetchaudio {FETCH}|{BLOCKS} grammar|text|2.2|A choice of the menu: what the user may say, and where it leads.
enumerate||{BLOCKS}|text|2.2.4|The choices of the menu, or the options of the field, one after another.
block|{ITEM}|{EXECUTABLE}|text|2.3.2|Content that runs once, without a question.
field|{ITEM} type slot modal xml:lang|{HANDLERS} audio enumerate filled grammar link option prompt property value|text|2.3.1|Asks the user something and keeps the answer.
initial|{ITEM}|{HANDLERS} audio enumerate link prompt property value|text|2.3.3|The first question of a form that takes several answers at once.
option|dtmf accept value||text|2.3.1.3|An answer that the field takes.
object|{ITEM} classid codebase codetype data type archive {FETCH}|{HANDLERS} audio enumerate filled param prompt property value|text|2.3.5|An object of the platform; this one has none.
record|{ITEM} modal beep maxtime finalsilence dtmfterm type dest|{HANDLERS} audio enumerate filled grammar prompt property value|text|2.3.6|Records what the user says.
subdialog|{ITEM} namelist src srcexpr method enctype fetchaudio {FETCH}|{HANDLERS} audio enumerate filled param prompt property value|text|2.3.4|Calls another dialog and comes back with its result.
transfer|{ITEM} dest destexpr bridge type connecttimeout maxtime transferaudio aai aaiexpr|{HANDLERS} audio enumerate filled grammar prompt property value|text|2.3.7|Connects the user to somebody else.
filled|mode namelist|{EXECUTABLE}|text|2.4|What to do when input items have been filled.
link|next expr event eventexpr message messageexpr dtmf fetchaudio {FETCH}|grammar||2.5|What the user may say at any time in its scope.
grammar|version xml:lang mode root tag-format xml:base src srcexpr scope type weight {FETCH}|example lexicon meta metadata one-of item rule ruleref tag token|text|3.1|What the user may say or key in.
catch|event cond count|{EXECUTABLE}|text|5.2.2|A handler of events.
error|cond count|{EXECUTABLE}|text|5.2.3|A handler of every error.
help|cond count|{EXECUTABLE}|text|5.2.3|A handler of a request for help.
noinput|cond count|{EXECUTABLE}|text|5.2.3|A handler for when nobody answered in time.
nomatch|cond count|{EXECUTABLE}|text|5.2.3|A handler for an answer that no grammar takes.
prompt|bargein bargeintype cond count timeout xml:lang xml:base|{BLOCKS} lexicon meta metadata|text|4.1|What is said to the user.
audio|src expr {FETCH}|{BLOCKS} desc|text|4.1.3|A recording, with what to say where there is none.
value|expr* class mode recsrc|||4.1.4|The value of an expression, as text.
break|strength time size|||4.1.1|A pause.
emphasis|level|{SPEECH}|text|4.1.1|Text said with stress.
mark|name nameexpr|||4.1.1|A place in a prompt; the application can ask whether it was passed.
phoneme|ph* alphabet||text|4.1.1|How something is pronounced.
prosody|pitch contour range rate duration volume|{BLOCKS}|text|4.1.1|Rate, pitch and loudness of the text.
say-as|interpret-as format detail type|value|text|4.1.1|The kind of the text, such as a date.
sub|alias*||text|4.1.1|What to say in place of the text.
voice|xml:lang gender age variant name|{BLOCKS}|text|4.1.1|Another voice.
p|xml:lang|{PARAGRAPH}|text|4.1.1|A paragraph.
s|xml:lang|{SPEECH}|text|4.1.1|A sentence.
paragraph|xml:lang|{PARAGRAPH}|text|4.1.1|A paragraph.
sentence|xml:lang|{SPEECH}|text|4.1.1|A sentence.
desc|xml:lang||text|4.1.3|A description of a recording.
lexicon|uri* type|||4.1.1|A document of pronunciations.
meta|name content* http-equiv|||6.2|A fact about the document.
metadata||*|text|6.2.2|Facts about the document in another language.
property|name* value*|||6.3|A setting for the element around it.
param|name* expr value valuetype type|||6.4|A named value that is passed along.
var|name* expr|||5.3.1|Declares a variable in the scope around it.
assign|name* expr*|||5.3.2|Gives a variable a value.
clear|namelist|||5.3.3|Makes form items undefined again, with their counters.
if|cond*|{EXECUTABLE} else elseif|text|5.3.4|Content under a condition; elseif and else divide it.
elseif|cond*|||5.3.4|Divides an if.
else||||5.3.4|Divides an if.
reprompt||||5.3.6|Repeats the prompt at the next visit.
goto|next expr nextitem expritem fetchaudio {FETCH}|||5.3.7|Goes to another item, dialog or document.
submit|next expr namelist method enctype fetchaudio {FETCH}|||5.3.8|Sends values to a server and goes on with the document it answers.
exit|expr namelist|||5.3.9|Ends the application.
return|namelist event eventexpr message messageexpr|||5.3.10|Ends a subdialog.
disconnect|namelist|||5.3.11|Ends the connection with the user.
script|src srcexpr charset {FETCH}||text|5.3.12|ECMAScript that runs when it is reached.
log|label expr|value|text|5.3.13|Writes into the transcript.
throw|event eventexpr message messageexpr|||5.2.1|Throws an event.
foreach|array* item*|{EXECUTABLE}|text|VoiceXML 2.1, 6|Runs its content once for every element of an array.
said-foreach=foreach|array* item*|{BLOCKS}|text|VoiceXML 2.1, 6|Runs its content once for every element of an array.
data|src srcexpr name method enctype namelist fetchaudio {FETCH}|||VoiceXML 2.1, 5|Fetches XML as a read-only tree of nodes.
"""
GRAMMAR_PARTS = {"example", "one-of", "item", "rule", "ruleref", "tag", "token"}


def _elements() -> list[Element]:
    made = []
    for row in TABLE.strip().splitlines():
        names, attributes, children, text, section, doc = row.split("|")
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
        made.append(Element(key, doc, tuple(held), kept, bool(text), name, section))
    return made


VOICEXML = Vocabulary(NAMESPACE, "voicexml", "vxml", _elements())
"""VoiceXML's elements; grammars are checked by :mod:`prima.grammar`."""

SPOKEN = frozenset(BLOCKS.split()) - {"said-foreach"} | {"prompt"}
"""Spoken elements; all but ``prompt`` make a prompt even without one around them (4.1.2)."""
WORDED = frozenset(tag for tag in SPOKEN - {"prompt", "enumerate"} if VOICEXML.elements[tag].text)
"""Elements of speech markup whose text is part of the surrounding text."""
HOLDING = frozenset(
    key
    for key in (SPOKEN | {"said-foreach"}) - {"enumerate"}
    if "break" in VOICEXML.elements[key].children
)
"""Elements besides executable content that may contain a Command of the robot."""

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
"""Attributes of which at most one may be given, or with ``!`` exactly one; ``content`` is the
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
    "weight": "weight",
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
"""Kinds of attribute values: keywords, a time, a rate of speech, a weight, or a whole number
from 1; an element's own come first."""
EXPRESSIONS = frozenset(
    [
        *("expr", "cond", "eventexpr", "messageexpr", "srcexpr"),
        *("destexpr", "expritem", "aaiexpr", "array", "nameexpr"),
    ]
)
"""Attributes that hold ECMAScript."""
FETCHED_VALUES = {"maxage": "number", "maxstale": "number"}
"""Attributes of all elements that fetch (6.1.2)."""
FETCHED = ("audio", "document", "grammar", "object", "script", "data")
PROPERTIES = {
    **dict.fromkeys(
        [
            *("timeout", "interdigittimeout", "termtimeout", "completetimeout", "fetchtimeout"),
            *("incompletetimeout", "maxspeechtimeout", "fetchaudiodelay", "fetchaudiominimum"),
        ],
        "time",
    ),
    **dict.fromkeys(["confidencelevel", "sensitivity", "speedvsaccuracy"], "share"),
    **{f"{what}fetchhint": "prefetch safe" for what in FETCHED},
    **{f"{what}{age}": "number" for what in FETCHED for age in FETCHED_VALUES},
    "inputmodes": "modes",
    "recordutterance": "true false",
    "termchar": "key",
    "bargein": "true false",
    "bargeintype": "speech hotword",
    "maxnbest": "integer",
}
"""Kinds of the Recommendation's properties (6.3)."""
