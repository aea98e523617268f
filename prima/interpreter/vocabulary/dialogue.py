"""The dialogue language."""

from __future__ import annotations

from prima.grammar.answers import TYPES
from prima.interpreter.vocabulary.commands import ARRANGING, COMMANDS, LONGEST
from prima.interpreter.vocabulary.content import ACTS
from prima.interpreter.vocabulary.hints import HINTS
from prima.interpreter.vocabulary.names import COND, CONTENT, EXPR, HANDLERS
from prima.interpreter.vocabulary.questions import GRAMMARS, PROPERTIES
from prima.markup.vocabulary import Vocabulary, elements

NAMESPACE = "urn:prima:dialogue:1"

_NAME = "name: variable | the name of its variable; it is visited while undefined"
_START = "expr: expression | the variable's first value; if given, it is not visited until cleared"
_COUNT = "count: integer 1..1000 = 1 | used from this occurrence on"
_STREAM = """stream: text(hold) | hold: its stream stays open, and the floor with it, while the application
    waits for an event afterwards (extension x3)
  hold-for: duration 1..600000 = 15s | how long at most"""
_CHANNEL = """channel: text(connect) | connect: the robot turns to the user before its first word, if it does
    not see them (extension x4)"""
TABLE = f"""
prima > meta var script property form {HANDLERS} link watch | An application of a robot: its
    personality (fa) or a place's service (ea). | VoiceXML vxml; thesis 2.2
  version*: text(1.0) | the language's version
  kind*: text(fa ea) | familiarity-oriented or environment-oriented
  id*: id | the application's name in transcripts
meta | A fact about the document, for people and tools.
  name*: text | its meaning
  content*: text | the fact
var | Declares a variable of the document, the form or the content that it is in. | VoiceXML 5.3.1
  name*: variable | its name
  {EXPR}
script > #text | ECMAScript that runs when its scope is entered; its functions and variables stay
    there. | VoiceXML 5.3.12
property | A setting for the same element: {", ".join(PROPERTIES)}. | VoiceXML 6.3
  name*: text({" ".join(PROPERTIES)}) | which
  value*: text | its value
form > var script property block field subdialog iu-items filled {HANDLERS} link watch | A state of
    the application. Its items are visited in document order while their variables are undefined and
    their conditions true; then it waits for events. | VoiceXML 2.1; thesis Figure 2.1
  id*: id | its name, for goto
  {_STREAM}
  {_CHANNEL}
  resume-text: text | what the robot says first when the form's stream resumes after another
    application has spoken (extension x9)
block > {CONTENT} | Content that runs once, in document order. Commands that follow one another are
    one tree; what follows them runs when they have ended. | VoiceXML 2.3.2; rule O4
  {_NAME}
  {_START}
  {COND}
  {_STREAM}
field > prompt option grammar property filled {HANDLERS} | Asks the user something and keeps the
    answer: the Command Q&A, one Atomic Behavior from the question to the answer or the timeout. |
    VoiceXML 2.3.1; thesis Table 4.2, 4.4 exception 2
  name*: variable | the variable that the answer fills
  {_START}
  {COND}
  type: text({" ".join(TYPES)}) | a built-in grammar for the answer
  {_STREAM}
  {_CHANNEL}
prompt > value break #text | What a field asks. Of several, those with the highest count reached are
    said. | VoiceXML 4.1
  {_COUNT}
  {COND}
  timeout: duration ..600000 | how long to wait for an answer
  bargein: boolean | whether the user may answer before it ends
option > #text | An answer that the field takes: what the user may say. | VoiceXML 2.3.1.3
  value: text | the field's value then; by default the text itself
{GRAMMARS}
filled > {CONTENT} | What happens when fields have been filled. | VoiceXML 2.4
  mode: text(all any) = all | when all of the namelist are filled, or any
  namelist: variables | the fields; by default all of the form
subdialog > param filled {HANDLERS} | Goes to another form in a context of its own and comes back
    with its result. | VoiceXML 2.3.4
  name: variable | the variable that its result fills
  {_START}
  {COND}
  src*: target | the form
param | A named value given along: to a subdialog, a service, or (an FA alone) to a Command as an
    additional argument. | VoiceXML 6.4; thesis Table 4.1
  name*: text | its name
  value: text | its value, as text
  {EXPR}
return | Ends a subdialog, with the values of the named variables. | VoiceXML 5.3.10
  namelist: variables | variables to give back
  event: event | an event to throw in the caller instead
iu-items=iu > block field {HANDLERS} | An Information Unit around form items: one Atomic Behavior
    that spans questions. It owns all devices of its content from its start until it is left, by
    whatever way. | thesis 4.1 (2); rule U5
  {_NAME}
  {COND}
  {LONGEST}
{ARRANGING}
"""
EVENTS = f"""
on > {CONTENT} | A handler of events: touch, human.found, human.lost, message, a corner, a service's
    reply, a watch, end and cancel of Commands, errors. Found as VoiceXML finds a catch: innermost
    scope, name by prefix, count, document order. | VoiceXML 5.2.2; thesis 4.4
  event*: events | which; touch also takes touch.head
  {COND}
  {_COUNT}
  reactive: boolean | whether what it asks for first is a reaction; by default it is for events of
    the user and the surroundings
  fresh-for: duration 1..600000 | for how long the reaction is worth starting: later it is given up
    (extension x8)
noinput > {CONTENT} | A handler of a question that nobody answered in time: short for an on with
    event noinput. | VoiceXML 5.2.3
  {COND}
  {_COUNT}
nomatch > {CONTENT} | A handler of an answer that the question does not take: short for an on with
    event nomatch. | VoiceXML 5.2.3
  {COND}
  {_COUNT}
help > {CONTENT} | A handler of a request for help: short for an on with event help. | VoiceXML
    5.2.3
  {COND}
  {_COUNT}
error > {CONTENT} | A handler of every error: short for an on with event error. | VoiceXML 5.2.3
  {COND}
  {_COUNT}
link > grammar | Something the user may say at any time in its scope: it goes to a form or throws an
    event. | VoiceXML 2.5; rule V1
  next: target | the form to go to
  event: event | the event to throw
watch | Raises an event when a condition on sensor values turns true. | thesis 2.2, 4.4; rule C6
  name*: event | the event
  when*: expression | the condition, over sensor.NAME
{ACTS}
"""
DIALOGUE = Vocabulary(
    NAMESPACE, "dialogue", "prima", (*elements(TABLE), *COMMANDS, *elements(EVENTS)), HINTS
)
