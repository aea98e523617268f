"""Elements of executable content other than Commands."""

from __future__ import annotations

from prima.interpreter.vocabulary.names import CONTENT, EXPR

ACTS = f"""
assign | Gives a declared variable a value. | VoiceXML 5.3.2
  name*: variable | the variable
  expr*: expression | the value
clear | Makes form items, with their counters, and other variables undefined; without names, all
    items of the form. | VoiceXML 5.3.3
  namelist: variables | which
if > {CONTENT} elseif else | Content under a condition; elseif and else divide it. | VoiceXML 5.3.4
  cond*: expression | the condition
elseif | Divides an if.
  cond*: expression | the condition
else | Divides an if.
foreach > {CONTENT} | Runs its content once for every element of an array. | VoiceXML 2.1, 6
  item*: variable | the variable of the element
  array*: expression | the array
log > value #text | Writes a line into the transcript. | VoiceXML 5.3.13
  label: text | a word before it
  {EXPR}
throw | Throws an event in this application. | VoiceXML 5.2.1
  event*+expr: event | its name
  message+expr: text | more about it
goto | Leaves the state for another form, or goes on with another item of this one. | VoiceXML
    5.3.7; rule O3
  next+expr: target | the form
  nextitem+expr: variable | the form item
exit | Ends the application. | VoiceXML 5.3.9
reprompt | Asks that the field say its prompt again when it is visited next. | VoiceXML 5.3.6
send > param | Sends a message to a named service, whose answer comes as the event reply.NAME or
    error.service.NAME; or an event to this application itself, after a delay, unless the state is
    left before. | thesis Figure 5.2; SCXML send
  to+expr: id | the service
  event: event | an event for this application itself
  delay+expr: duration | when, from now
value | The value of an expression, as text; that of a variable without a value is null. | VoiceXML
    4.1.4
  expr*: expression | the expression
break | A pause in what is said: the robot goes on with the same utterance after it. | SSML 3.2.3
  time*: duration 1..60000 | how long
"""
