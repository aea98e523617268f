"""The language of services that a live run may ask."""

from __future__ import annotations

from prima.devices.vocabulary.common import VERSION
from prima.markup.vocabulary import Element, Instead, Vocabulary, attribute

COMMON = (
    attribute("name", "id", "its name, as in `<send>` and `service:NAME`", "required"),
    attribute("application", "id", "the only application that may use it; by default all may"),
    attribute("url", "text", "its URL: http or https", "required"),
    attribute("deadline", "duration", "how long the whole answer may take", default="3s", low=1),
    attribute(
        "retries",
        "integer",
        "how often a request is repeated within the deadline, if it cannot be reached or answers"
        " 429, 502, 503 or 504",
        default="0",
        low=0,
        high=10,
    ),
    attribute(
        "most",
        "integer",
        "the maximum size of an answer in bytes",
        default="100000",
        low=1,
        high=10_000_000,
    ),
    attribute(
        "key", "text", "the environment variable whose value is sent as `Authorization: Bearer`"
    ),
)
SERVICES = Vocabulary(
    "urn:prima:services:1",
    "services",
    "services",
    (
        Element(
            "services",
            "The services that a live run may use; it may use no others.",
            (VERSION,),
            ("service", "language-model"),
        ),
        Element(
            "service",
            "A service that takes values and answers a JSON object.",
            (
                *COMMON,
                attribute(
                    "method",
                    "text",
                    "the method: `get` sends the values in the URL, the others as JSON",
                    default="post",
                    choices=("get", "put", "post"),
                ),
                attribute(
                    "idempotent",
                    "boolean",
                    "whether a `post` may be repeated; `get` and `put` always may",
                    default="false",
                ),
            ),
            ("header", "slot"),
        ),
        Element(
            "language-model",
            "A language model behind the chat interface of OpenAI, which fills slots.",
            (*COMMON, attribute("model", "text", "the model's name", "required")),
            ("header", "prompt", "slot", "fallback"),
        ),
        Element(
            "header",
            "A header of the request.",
            (
                attribute("name", "text", "its name", "required"),
                attribute("value", "text", "its value"),
                attribute("variable", "text", "the environment variable that holds its value"),
            ),
        ),
        Element(
            "prompt",
            "A message to the model; {NAME} is replaced by a value that is sent.",
            (attribute("role", "text", "whose it is", default="user", choices=("system", "user")),),
            text=True,
        ),
        Element(
            "slot",
            "A value of the answer. If there are slots, the rest of an answer is ignored.",
            (
                attribute("name", "id", "its name in the reply", "required"),
                attribute(
                    "kind",
                    "text",
                    "its type",
                    default="text",
                    choices=("text", "number", "boolean"),
                ),
                attribute("choices", "text", "the texts that it may be, separated by `|`"),
                attribute(
                    "field",
                    "text",
                    "the part of the answer, by default its name; dots lead into objects and lists",
                ),
                attribute("required", "boolean", "whether it is needed", default="true"),
                attribute("doc", "text", "what it means, for the model"),
            ),
        ),
        Element(
            "fallback",
            "A grammar that fills the slots if the model does not.",
            (
                attribute(
                    "grammar", "text", "the file: an SRGS grammar beside this document", "required"
                ),
                attribute("of", "id", "the sent value that it parses", "required"),
            ),
        ),
    ),
    hints={
        "param": "Values that are sent are the <param> of <send>.",
        "llm": Instead("language-model"),
    },
)
