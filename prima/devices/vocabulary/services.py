"""The language of services that a live run may ask."""

from __future__ import annotations

from prima.devices.vocabulary.common import VERSION
from prima.markup.vocabulary import Instead, Vocabulary, elements

COMMON = """name*: id | its name, as in `<send>` and `service:NAME`
  application: id | the only application that may use it; by default all may
  url*: text | its URL: http or https
  deadline: duration 1.. = 3s | how long the whole answer may take
  retries: integer 0..10 = 0 | how often a request is repeated within the deadline, if it cannot be
    reached or answers 429, 502, 503 or 504
  most: integer 1..10000000 = 100000 | the maximum size of an answer in bytes
  key: text | the environment variable whose value is sent as `Authorization: Bearer`"""
TABLE = f"""
services > service language-model | The services that a live run may use; it may use no others.
  {VERSION}
service > header slot | A service that takes values and answers a JSON object.
  {COMMON}
  method: text(get put post) = post | the method: `get` sends the values in the URL, the others as
    JSON
  idempotent: boolean = false | whether a `post` may be repeated; `get` and `put` always may
language-model > header prompt slot fallback | A language model behind the chat interface of OpenAI,
    which fills slots.
  {COMMON}
  model*: text | the model's name
header | A header of the request.
  name*: text | its name
  value: text | its value
  variable: text | the environment variable that holds its value
prompt > #text | A message to the model; {{NAME}} is replaced by a value that is sent.
  role: text(system user) = user | whose it is
slot | A value of the answer. If there are slots, the rest of an answer is ignored.
  name*: id | its name in the reply
  kind: text(text number boolean) = text | its type
  choices: text | the texts that it may be, separated by `|`
  field: text | the part of a service's answer, by default its name; dots lead into objects and lists
  required: boolean = true | whether it is needed
  doc: text | what it means, for the model
fallback | A grammar that fills the slots if the model does not.
  grammar*: text | the file: an SRGS grammar beside this document
  of*: id | the sent value that it parses
"""
SERVICES = Vocabulary(
    "urn:prima:services:1",
    "services",
    "services",
    elements(TABLE),
    hints={
        "param": "Values that are sent are the <param> of <send>.",
        "llm": Instead("language-model"),
    },
)
