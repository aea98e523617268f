"""The language of robots: their body, devices and Commands."""

from __future__ import annotations

from prima.devices.vocabulary.common import ID, TITLE, VERSION
from prima.language.commands import DEVICES
from prima.markup.vocabulary import Instead, Vocabulary, elements

LIMITS = """accept: duration 1.. | how long the robot may take to begin
  progress: duration 1.. | how long it may continue without a report
  cancel: duration 1.. | how long it may take to stop"""
"""How long a driver may take before it is given up."""
TABLE = f"""
robot > device camera voice touch gesture adds allows substitute driver | A robot's body, devices
    and Commands.
  {VERSION}
  {ID}
  {TITLE}
  radius: number 0.05..2 = 0.2 | the body's
  speed: number 0.01..3 = 0.5 | how fast it drives, in metres a second, where a Command or step
    names no speed
  turn-speed: number 1..720 = 90 | how fast it turns, in degrees a second, where a Command or step
    names no speed
  head-speed: number 1..720 = 120 | degrees a second
  loop: duration 10.. = 500ms | a loop of a feedback Command
  absence: duration = 20s | how long the user has to be neither seen, heard nor felt to count as
    absent (K1)
device | A device that the robot has; it cannot do Commands whose devices it lacks.
  name*: id | as in Table 4.2, or one of its own
camera | The camera by which it sees humans.
  angle: number 1..360 = 60 | field of view in degrees
  range: number 0.1..100 = 4 | metres
voice | How fast it talks in a language.
  lang*: language | the language
  rate*: number 0.5..100 | letters a second
touch | A touch sensor.
  sensor*: id | its name
gesture | A gesture that it knows.
  name*: id | its name
  duration: duration = 1s | how long it takes
adds > argument step | A Command that the hardware developer adds.
  command*: id | its name
  {TITLE}
  devices*: text | the devices it occupies, separated by spaces
  duration: duration = 1s | how long it takes, or a loop of it; with steps, by default as long
    as these
  feedback: boolean = false | whether it works in loops
  leaves: boolean = false | whether it leaves the user
  engages: boolean = false | whether it engages the user
  says: boolean = false | whether it takes a text
  stray: number 0..5 = 0.3 | how far (m) its steps may take the robot off the way of a move that
    goes on meanwhile (extension x5)
step | A part of an added motion such as a dance: how the body moves for a while.
  for*: duration 1.. | how long
  speed: number -2..2 = 0 | metres a second, backward negative
  turn-speed: number -180..180 = 0 | degrees a second to the left
substitute | Another Command that takes the place of one that the robot lacks (extension x6).
  command*: id | the Command of Table 4.2 that it lacks
  by*: id | the Command that takes its place
argument | A motion argument of an added Command.
  name*: id | its name
  kind: text(text number duration boolean id) = text | its type
  low: number | the least; of a duration in ms
  high: number | the most; of a duration in ms
  required: boolean = false | whether it is needed
allows | An additional argument of a Command, for FAs only.
  command*: id | the Command
  argument*: id | the argument's name
driver > does senses place option | Carries out Commands on the real robot, and reports what its
    sensors say.
  kind*: id | which driver, such as `sim` or `ros2`
  address: text | where it reaches the robot: a URL, a host, a port
  devices: text | its devices, separated by spaces; by default all that no other driver names
  open: duration 1.. = 10s | how long it may take to connect
  heartbeat: duration 100.. = 2s | how often it checks that the robot is still there
  {LIMITS}
does > set | How the driver carries out a Command or a gesture.
  command: id | the Command; `say` for what any Command says
  gesture: id | the gesture, where the Command is `gesture`
  by: text | the robot's action, service, topic, method or move
  type: text | the type of its messages
  as: text(action service topic) | the kind of interface that `by` names
  stop: text | the service or method that stops it, if cancelling does not
  {LIMITS}
set | An argument of the robot's interface, or a field of its message.
  name*: text | its name; dots lead into a message
  value*: text | its value; {{NAME}} stands for an argument of the Command, its {{text}} or {{lang}}, or
    the {{x}}, {{y}} and {{heading}} of the place it names
senses | What the driver reports by itself: an event, a sensor's value, or what users say.
  event: id | the event that is raised
  sensor: id | the sensor whose value it is
  as: text(heard pose human emergency) | what it is otherwise: what a user says, the robot's pose,
    whether the user is seen, or the emergency stop
  by*: text | the robot's topic, event or memory key
  type: text | the type of its messages
  field: text | the part of the message; dots lead into it
  when: text | the value at which the event is raised; any by default
  actor: text(user environment robot) = user | who causes the event
place | Where a place of the site is on the robot's own map.
  name*: id | its name, as in Commands
  x*: number | metres
  y*: number | metres
  heading: number = 0 | degrees to the left of the x axis
option | A setting of the driver's own.
  name*: id | its name
  value*: text | its value
"""
ROBOT = Vocabulary(
    "urn:prima:robot:1",
    "robot",
    "robot",
    elements(TABLE),
    hints={
        **dict.fromkeys(("sensor", "touch-sensor"), Instead("touch", 'sensor="..."/')),
        **{name: f'Write <device name="{name}"/>.' for name in DEVICES},
        **dict.fromkeys(("command", "add"), Instead("adds", 'command="..."')),
        "language": Instead("voice", 'lang="..."/'),
    },
)
