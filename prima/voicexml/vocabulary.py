"""The elements of VoiceXML 2.0 and 2.1 as a table: their attributes and what they may hold."""

from __future__ import annotations

from prima.language.commands import TABLE_4_2
from prima.markup.vocabulary import Vocabulary, elements

NAMESPACE = "http://www.w3.org/2001/vxml"
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

TABLE = f"""
vxml version* application xml:base xml:lang > {HANDLERS} data form link menu meta metadata property
    script var | A VoiceXML document. | 1.5
form id scope > {HANDLERS} block data field filled grammar initial link object property record
    script subdialog transfer var | A dialog that presents information and gathers input. | 2.1
menu id scope dtmf accept > {HANDLERS} audio choice enumerate property prompt value #text | A dialog
    that lets the user choose where to go. | 2.2
choice dtmf accept next expr event eventexpr message messageexpr fetchaudio {FETCH} > {BLOCKS}
    grammar #text | A choice of the menu: what the user may say, and where it leads. | 2.2
enumerate > {BLOCKS} #text | The choices of the menu, or the options of the field, one after
    another. | 2.2.4
block {ITEM} > {EXECUTABLE} #text | Content that runs once, without a question. | 2.3.2
field {ITEM} type slot modal xml:lang > {HANDLERS} audio enumerate filled grammar link option prompt
    property value #text | Asks the user something and keeps the answer. | 2.3.1
initial {ITEM} > {HANDLERS} audio enumerate link prompt property value #text | The first question of
    a form that takes several answers at once. | 2.3.3
option dtmf accept value > #text | An answer that the field takes. | 2.3.1.3
object {ITEM} classid codebase codetype data type archive {FETCH} > {HANDLERS} audio enumerate
    filled param prompt property value #text | An object of the platform; this one has none. | 2.3.5
record {ITEM} modal beep maxtime finalsilence dtmfterm type dest > {HANDLERS} audio enumerate filled
    grammar prompt property value #text | Records what the user says. | 2.3.6
subdialog {ITEM} namelist src srcexpr method enctype fetchaudio {FETCH} > {HANDLERS} audio enumerate
    filled param prompt property value #text | Calls another dialog and comes back with its result.
    | 2.3.4
transfer {ITEM} dest destexpr bridge type connecttimeout maxtime transferaudio aai aaiexpr >
    {HANDLERS} audio enumerate filled grammar prompt property value #text | Connects the user to
    somebody else. | 2.3.7
filled mode namelist > {EXECUTABLE} #text | What to do when input items have been filled. | 2.4
link next expr event eventexpr message messageexpr dtmf fetchaudio {FETCH} > grammar | What the user
    may say at any time in its scope. | 2.5
grammar version xml:lang mode root tag-format xml:base src srcexpr scope type weight {FETCH} >
    lexicon meta metadata #text | What the user may say or key in. | 3.1
catch event cond count > {EXECUTABLE} #text | A handler of events. | 5.2.2
error cond count > {EXECUTABLE} #text | A handler of every error. | 5.2.3
help cond count > {EXECUTABLE} #text | A handler of a request for help. | 5.2.3
noinput cond count > {EXECUTABLE} #text | A handler for when nobody answered in time. | 5.2.3
nomatch cond count > {EXECUTABLE} #text | A handler for an answer that no grammar takes. | 5.2.3
prompt bargein bargeintype cond count timeout xml:lang xml:base > {BLOCKS} lexicon meta metadata
    #text | What is said to the user. | 4.1
audio src expr {FETCH} > {BLOCKS} desc #text | A recording, with what to say where there is none. |
    4.1.3
value expr* class mode recsrc | The value of an expression, as text. | 4.1.4
break strength time size | A pause. | 4.1.1
emphasis level > {SPEECH} #text | Text said with stress. | 4.1.1
mark name nameexpr | A place in a prompt; the application can ask whether it was passed. | 4.1.1
phoneme ph* alphabet > #text | How something is pronounced. | 4.1.1
prosody pitch contour range rate duration volume > {BLOCKS} #text | Rate, pitch and loudness of the
    text. | 4.1.1
say-as interpret-as format detail type > value #text | The kind of the text, such as a date. | 4.1.1
sub alias* > #text | What to say in place of the text. | 4.1.1
voice xml:lang gender age variant name > {BLOCKS} #text | Another voice. | 4.1.1
p xml:lang > {PARAGRAPH} #text | A paragraph. | 4.1.1
s xml:lang > {SPEECH} #text | A sentence. | 4.1.1
paragraph xml:lang > {PARAGRAPH} #text | A paragraph. | 4.1.1
sentence xml:lang > {SPEECH} #text | A sentence. | 4.1.1
desc xml:lang > #text | A description of a recording. | 4.1.3
lexicon uri* type | A document of pronunciations. | 4.1.1
meta name content* http-equiv | A fact about the document. | 6.2
metadata > #text | Facts about the document in another language. | 6.2.2
property name* value* | A setting for the element around it. | 6.3
param name* expr value valuetype type | A named value that is passed along. | 6.4
var name* expr | Declares a variable in the scope around it. | 5.3.1
assign name* expr* | Gives a variable a value. | 5.3.2
clear namelist | Makes form items undefined again, with their counters. | 5.3.3
if cond* > {EXECUTABLE} else elseif #text | Content under a condition; elseif and else divide it. |
    5.3.4
elseif cond* | Divides an if. | 5.3.4
else | Divides an if. | 5.3.4
reprompt | Repeats the prompt at the next visit. | 5.3.6
goto next expr nextitem expritem fetchaudio {FETCH} | Goes to another item, dialog or document. |
    5.3.7
submit next expr namelist method enctype fetchaudio {FETCH} | Sends values to a server and goes on
    with the document it answers. | 5.3.8
exit expr namelist | Ends the application. | 5.3.9
return namelist event eventexpr message messageexpr | Ends a subdialog. | 5.3.10
disconnect namelist | Ends the connection with the user. | 5.3.11
script src srcexpr charset {FETCH} > #text | ECMAScript that runs when it is reached. | 5.3.12
log label expr > value #text | Writes into the transcript. | 5.3.13
throw event eventexpr message messageexpr | Throws an event. | 5.2.1
foreach array* item* > {EXECUTABLE} #text | Runs its content once for every element of an array. |
    VoiceXML 2.1, 6
said-foreach=foreach array* item* > {BLOCKS} #text | Runs its content once for every element of an
    array. | VoiceXML 2.1, 6
data src srcexpr name method enctype namelist fetchaudio {FETCH} | Fetches XML as a read-only tree
    of nodes. | VoiceXML 2.1, 5
"""
VOICEXML = Vocabulary(NAMESPACE, "voicexml", "vxml", elements(TABLE))
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
from 1; an element's own come first: see :func:`kind_of`."""


def kind_of(element: str, attribute: str) -> str:
    """The kind of an attribute's value, by the element's key; empty for any text."""
    return VALUES.get(f"{element} {attribute}") or VALUES.get(attribute, "")


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
PROPERTY_NAMES = frozenset([*PROPERTIES, "fetchaudio", "recordutterancetype", "universals"])
"""The names of all its properties."""
