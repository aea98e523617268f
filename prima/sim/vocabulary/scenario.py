"""The language of scenarios."""

from __future__ import annotations

from prima.devices.vocabulary.common import ID, TITLE, VERSION
from prima.markup.vocabulary import Instead, Vocabulary, elements
from prima.script.sandbox import START
from prima.sim.vocabulary.happenings import HAPPENINGS, SPEED, TRIGGERS
from prima.sim.vocabulary.served import SERVED

_COMES_AFTER = "\n  ".join(row.replace("| ", "| it comes after ") for row in TRIGGERS[1:])
_EXPECTED = f"""says: text | the robot begins to say something with these words
  does: id | the robot begins a Command of this type; may be combined with says
  finishes: id | the robot ends a Command of this type
  event: event | such an event happens
  logs: text | an application logs something with these words
  sends: text | an application sends something to this service or URI
  state: id | an application is in this form
  ends: id | this application ends
  reason: text | why it ends: exit, return, unloaded or an error's name
  by: id | the application that does it; by default any
  after: text | it comes after the expectation with this id
  before: text | it comes before the expectation with this id
  at: text | it comes from this time of the run on; for a state also end
  {_COMES_AFTER}
  count: integer 1.. = 1 | which of these occurrences counts
  within: duration | how long afterwards at most"""
TABLE = f"""
scenario > robot person application answer when service connection transfer expect never in-order |
    A run: who is where, what the user does and when, and how services answer.
  {VERSION}
  {ID}
  {TITLE}
  world*: path | the world's document
  robot*: path | the robot's profile
  until: duration = 600s | when the run ends, if not by itself
  date: date = {START} | when the run begins, for Date in documents; in UTC, like all
    times
  policy: text = prima | the mediator's policy
  patience: duration = 60s | how long an application may keep others from the speaker (E6); 0s for
    no limit
  entrances: text(open closed) = closed | whether the robot takes up the applications that the
    world's areas offer
  seed: integer 0.. = 1 | which of all possible runs it is: its random values depend on this alone
robot | Where the robot starts.
  at*: id | a place
  heading: number -360..360 | degrees counter-clockwise from east; by default the place's heading
person | The user, and where they start; of several the robot attends to one at a time.
  id: id = user | their name; needed where there are several
  at: id | a place or thing
  x: number -1000..1000 | metres east
  y: number -1000..1000 | metres north
  {SPEED}
  user: path | the document that says how they behave; see <user>
application | An application that the robot runs, in the order in which they are declared.
  src*: path | its document
  start: delay = 0s | when it is loaded
  id: id | its name, for a VoiceXML document; by default that of its file
  kind: text(fa ea) = ea | whether it is the robot's own or a place's; overrides the document
  uri: text | where a VoiceXML document is served in real use
  folder: path | the folder that is served there: its own, or one above it
{HAPPENINGS}
{SERVED}
expect > data | What has to happen in the run. prima test checks it; a run itself ignores it.
  id: id | its name, for after and before of others
  {_EXPECTED}
  times: integer 1.. | how often exactly; by default at least once
never > data | What must not happen in the run.
  {_EXPECTED}
in-order > expect | Expectations that have to be met one after the other.
"""
SCENARIO = Vocabulary(
    "urn:prima:scenario:1",
    "scenario",
    "scenario",
    elements(TABLE),
    hints={
        **dict.fromkeys(("user", "human", "visitor"), Instead("person")),
        **dict.fromkeys(("app", "fa", "ea", "prima", "vxml"), Instead("application", 'src="..."/')),
        **dict.fromkeys(("speak", "prompt", "says"), "Write <say>: what the user says."),
        **dict.fromkeys(("tap", "press", "stroke"), Instead("touch", 'sensor="..."/')),
        **dict.fromkeys(("go", "goto", "move", "topological-move"), Instead("walk", 'to="..."/')),
        **dict.fromkeys(("sleep", "pause", "delay", "after"), 'Write <wait for="3s"/>.'),
        **dict.fromkeys(("on", "at", "if", "then", "catch"), "Write <when>, with its trigger."),
        **dict.fromkeys(("choice", "choose", "random", "any"), Instead("one-of")),
        **dict.fromkeys(("assert", "expected", "must"), Instead("expect")),
        "param": Instead("data", 'name="..." value="..."/'),
        **dict.fromkeys(("forbid", "must-not", "not"), Instead("never")),
        **dict.fromkeys(
            ("place", "way", "wall", "thing", "corner", "area"),
            "Write it into the world's document.",
        ),
        **dict.fromkeys(
            ("device", "camera", "voice", "adds", "allows", "substitute", "driver"),
            "Write it into the robot's document.",
        ),
        "answers": 'Write it into the document of a user: <person user="...">.',
        "world": 'Name it in the root element: <scenario world="..." robot="...">.',
        "question": 'Write what the user answers: <answer to="words of the question">Yes.</answer>.',
        "comment": "Write <note>, or a comment of XML: <!-- ... -->.",
    },
)

NAMING_APPLICATIONS = (
    *(("unload", "application"), ("load", "application")),
    *(("service", "application"), ("message", "to")),
    *((tag, name) for tag in ("expect", "never") for name in ("by", "ends")),
)
"""Elements of scenarios, and their attributes, that name an application."""
