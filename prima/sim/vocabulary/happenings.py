"""Triggers, users' actions and other events of a scenario, as a table."""

AFTER = "after: delay = 0s | how long afterwards"
_DOINGS = "say hang-up touch walk wait look follow stay leave note"
DOINGS = tuple(_DOINGS.split())
"""Users' actions, without those of the surroundings."""
_ACTIONS = f"{_DOINGS} message event sensor fail repair emergency release unload load"
_CONFIDENCE = "confidence: number 0..1 = 1 | the recogniser's confidence in the words"
_CALLED = "id: id | its name, for experiments that vary it (prima sweep)"
CHANCE = (
    "chance: number 0..1 = 1 | its probability each time, from 0 to 1; drawn by the scenario's seed"
)
_PERSON = "person: id | the person who does it, if there are several; by default the first"
SPEED = "speed: quantity 0.05..5 = 1 | metres a second"
TRIGGERS = (
    "at: delay | a time of the run",
    "said: text | the robot has said something with these words",
    "asked: text | the robot has asked something with these words and listens",
    "doing: id | the robot begins such a Command",
    "done: id | the robot ends such a Command",
    "on: event | such an event happens",
)
_TRIGGERS = "\n  ".join(TRIGGERS)
HAPPENINGS = f"""
answer > alternative #text | What the user answers whenever the robot asks something with these
    words.
  {_CALLED}
  {_PERSON}
  to*: text | words of the question
  after: delay = 1s | how long after it
  times: integer 1..1000 = 1000 | how often at most
  {CHANCE}
  {_CONFIDENCE}
when > one-of {_ACTIONS} | What happens at a time, or when the robot has done something: in
    sequence.
  {_CALLED}
  {_PERSON}
  {_TRIGGERS}
  {AFTER}
  times: integer 1..1000 = 1 | how often at most
  count: integer 1.. = 1 | the first time at which it happens; `times` counts from then on
  {CHANCE}
one-of > {_ACTIONS} | One of these happens, with equal probability; drawn by the scenario's seed.
say > alternative #text | The user says something.
  {_CONFIDENCE}
alternative > #text | An alternative result of the recogniser, with a lower confidence.
  confidence*: number 0..1 | the recogniser's confidence in the words
hang-up | The user hangs up, in the middle of what they say if they speak: the event
    connection.disconnect.hangup.
touch | The user touches a sensor.
  sensor*: id | which
walk | The user walks somewhere in a straight line.
  to: id | a place or thing
  x: number -1000..1000 | metres east
  y: number -1000..1000 | metres north
wait | Nothing, for a while.
  for*: delay | how long
look | The user looks at something.
  at*: id | a place or thing, or robot
follow | The user follows the robot from now on.
  distance: number 0.3..10 = 1.2 | metres
stay | The user stays where they are.
leave | The user goes away and is seen no more.
note > #text | A remark for the reader.
message > #text | A message arrives from the network: the event message, with its sender and text.
  from: text | who sends it
  to: id | the only application that gets it; by default all do
event > data | An event of the surroundings.
  name*: event | its name
data | A value passed with it.
  name*: text | its name
  value*: text | its value
sensor | A sensor's value changes.
  name*: event | its dotted name
  value*: text | its value: a number, true, false or a text
fail | A device fails from now on, or hangs.
  device*: id | which
  hangs: boolean = false | whether it hangs instead of failing
repair | The device works again.
  device*: id | which
emergency | The emergency stop is pressed.
release | The emergency stop is released.
  resume: boolean = true | whether streams resume
unload | An application is unloaded.
  application*: id | its id
load | An application that has ended or was unloaded is loaded again: it starts anew.
  application*: id | its id
"""
