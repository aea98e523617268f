"""A services document as values: the services that a live run may use, and their data."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from prima.devices.reading import RENAME, Reader, part_of
from prima.devices.vocabulary.services import SERVICES
from prima.errors import DocumentError, Place
from prima.language.values import shown
from prima.markup.tree import Node
from prima.messages import Data, Json

if TYPE_CHECKING:
    from prima.grammar import Grammar

NAMED = re.compile(r"\{([A-Za-z_][\w-]*)\}")
"""A placeholder for a sent value in a prompt."""
VARIABLE = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
HEADER = re.compile(r"[!#$%&'*+.^_`|~0-9A-Za-z-]+")
COMPUTED = frozenset({"connection", "content-length", "host", "transfer-encoding"})
"""Headers that follow from the request: another value would spoil it."""
SAFE = frozenset(["get", "put"])
"""Methods that may be repeated (RFC 9110, 9.2.2)."""
TYPES = {"text": "string", "number": "number", "boolean": "boolean"}
Grammars = Callable[[str], "Grammar"]
"""Loads a grammar by its name in the document."""


class Unfit(Exception):
    """An answer does not match the document; the message says why."""


@dataclass(frozen=True, slots=True)
class Slot:
    """A value of an answer."""

    name: str
    kind: str
    choices: tuple[str, ...]
    field: str
    required: bool
    doc: str

    def schema(self) -> dict[str, Json]:
        """Its JSON schema."""
        made: dict[str, Json] = {"type": TYPES[self.kind]}
        if self.choices:
            made["enum"] = list(self.choices)
        if self.doc:
            made["description"] = self.doc
        return made

    def checked(self, value: Json) -> Json:
        """A valid value.

        Raises:
            Unfit: it is invalid.
        """
        number = isinstance(value, int | float) and not isinstance(value, bool)
        fits = {"text": isinstance(value, str), "boolean": isinstance(value, bool)}
        if not fits.get(self.kind, number):
            raise Unfit(f'"{self.name}" is not a {self.kind}')
        if self.choices and value not in self.choices:
            raise Unfit(f'"{self.name}" is not one of {", ".join(self.choices)}')
        return value


@dataclass(slots=True)
class Fallback:
    """A grammar that fills the slots if the language model does not."""

    grammar: Grammar
    of: str


@dataclass(slots=True)
class Endpoint:
    """A service that a live run may use. Times are ms of real time."""

    name: str
    application: str
    """The only application that may use it; empty if all may."""
    uri: str
    method: str
    deadline: int
    retries: int
    most: int
    """Maximum size of an answer (bytes)."""
    repeats: bool
    """Whether a request may be repeated."""
    place: Place
    headers: dict[str, str] = field(default_factory=dict)
    variables: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Headers from environment variables: a prefix of the value, and the variable."""
    slots: tuple[Slot, ...] = ()
    model: str = ""
    prompts: tuple[tuple[str, str], ...] = ()
    """Roles and templates of a language model's messages."""
    fallback: Fallback | None = None

    def reply(self, answer: Json) -> dict[str, Json]:
        """The data of a reply: the slots or, without slots, the whole flat object.

        Raises:
            Unfit: the answer does not match the document.
        """
        if self.slots and not self.model:
            return self._filled(answer)
        if not isinstance(answer, dict):
            raise Unfit("the answer is not a JSON object")
        if self.model:
            return self._filled(answer)
        for name, value in answer.items():
            if isinstance(value, dict | list):
                raise Unfit(f'"{name}" of the answer is not flat; name its parts with <slot>')
        return answer

    def _filled(self, answer: Json) -> dict[str, Json]:
        made = {}
        for slot in self.slots:
            value = part_of(answer, slot.field)
            if value is not None:
                made[slot.name] = slot.checked(value)
            elif slot.required:
                raise Unfit(f'the answer lacks "{slot.field}"')
        return made

    def chat(self, params: Data) -> dict[str, Json]:
        """The request to a language model.

        Raises:
            Unfit: a prompt names a value that is not sent.
        """
        messages = [
            {"role": role, "content": _written(text, params)} for role, text in self.prompts
        ]
        form = {"name": self.name, "strict": True, "schema": self.schema()}
        return {
            "model": self.model,
            "messages": messages,
            "temperature": 0,
            "stream": False,
            "response_format": {"type": "json_schema", "json_schema": form},
        }

    def schema(self) -> dict[str, Json]:
        """The JSON schema of the slots."""
        return {
            "type": "object",
            "properties": {slot.name: slot.schema() for slot in self.slots},
            "required": [slot.name for slot in self.slots if slot.required],
            "additionalProperties": False,
        }


def _written(template: str, params: Data) -> str:
    def value(slot: re.Match[str]) -> str:
        if slot[1] not in params:
            raise Unfit(f'the prompt needs the value "{slot[1]}": send it as a <param>')
        return shown(params[slot[1]])

    return NAMED.sub(value, template)


def read_services(file: str, data: bytes, grammars: Grammars) -> list[Endpoint]:
    """Read a document of services.

    Raises:
        DocumentError: with all its problems.
    """
    reader = Reader(SERVICES, file, data)
    made: list[Endpoint] = []
    for node in reader.root.all("service", "language-model"):
        name, owner = node.get("name"), node.get("application")
        if any((one.name, one.application) == (name, owner) for one in made):
            whose = f' for the application "{owner}"' if owner else ""
            message = f'The service "{name}" is there twice{whose}.'
            reader.problem(node, "duplicate-name", message, "name", RENAME)
        made.append(_endpoint(reader, node, grammars))
    reader.finish()
    return made


def _endpoint(reader: Reader, node: Node, grammars: Grammars) -> Endpoint:
    chats = node.tag == "language-model"
    reader.check_twice(node.all("slot"), "name")
    _check_url(reader, node)
    method = "post" if chats else reader.get(node, "method") or "post"
    made = Endpoint(
        node.get("name"),
        node.get("application"),
        node.get("url"),
        method,
        reader.get(node, "deadline") or 1,
        reader.get(node, "retries") or 0,
        reader.get(node, "most") or 1,
        chats or method in SAFE or bool(reader.get(node, "idempotent")),
        node.place,
        slots=tuple(_slot(reader, child) for child in node.all("slot")),
        model=node.get("model"),
        prompts=tuple((one.get("role", "user"), one.text) for one in node.all("prompt")),
    )
    _check_retries(reader, node, made)
    _read_headers(reader, node, made)
    if chats:
        _read_fallback(reader, node, made, grammars)
    return made


def _check_retries(reader: Reader, node: Node, made: Endpoint) -> None:
    if made.retries and not made.repeats:
        message = "A post is not repeated: it might be carried out twice."
        remedy = 'Remove retries, or add idempotent="true" if that does no harm.'
        reader.problem(node, "exclusive", message, "retries", remedy)


def _check_url(reader: Reader, node: Node) -> None:
    url = node.get("url")
    try:
        parts = urlsplit(url)
        wrong = parts.scheme not in ("http", "https") or not parts.hostname or parts.port == 0
    except ValueError:
        wrong = True
    if wrong or not url.isascii() or any(one.isspace() for one in url):
        message, remedy = (
            f'"{url}" is not an address.',
            'Write as in "http://127.0.0.1:8080/books".',
        )
        reader.problem(node, "bad-value", message, "url", remedy)
    elif "@" in parts.netloc:
        remedy = 'Put it into an environment variable, and name that as key="...".'
        reader.problem(node, "bad-value", "The address holds a password.", "url", remedy)


def _slot(reader: Reader, node: Node) -> Slot:
    name, kind = node.get("name"), node.get("kind", "text")
    choices = tuple(one.strip() for one in node.get("choices").split("|") if one.strip())
    if "choices" in node.attributes and not choices:
        message = "There is nothing to choose."
        reader.problem(node, "empty", message, "choices", 'Write as in "happy | sad".')
    if choices and kind != "text":
        message = "Only texts have choices."
        reader.problem(node, "exclusive", message, "choices", "Remove choices, or the kind.")
    needed = reader.get(node, "required")
    return Slot(
        name, kind, choices, node.get("field") or name, needed is not False, node.get("doc")
    )


def _read_headers(reader: Reader, node: Node, made: Endpoint) -> None:
    headers = node.all("header")
    reader.check_twice(headers, "name", fold=True)
    if "key" in node.attributes:
        made.variables["Authorization"] = ("Bearer ", node.get("key"))
        _check_variable(reader, node, "key")
    for child in headers:
        name = child.get("name")
        if name.lower() == "authorization" and "key" in node.attributes:
            message = "The key is sent as this header already."
            reader.problem(child, "exclusive", message, "name", "Keep one.")
        if not HEADER.fullmatch(name):
            message = f'"{name}" is not the name of a header.'
            reader.problem(child, "bad-value", message, "name", 'Write as in "X-Api-Key".')
        if name.lower() in COMPUTED:
            message = f"{name} follows from the request and cannot be set."
            reader.problem(child, "bad-value", message, "name", "Remove the header.")
        if ("value" in child.attributes) == ("variable" in child.attributes):
            message = "<header> needs exactly one of value, variable."
            reader.problem(
                child, "exclusive", message, "value", 'Write variable="..." for secrets.'
            )
        elif "variable" in child.attributes:
            made.variables[name] = ("", child.get("variable"))
            _check_variable(reader, child, "variable")
        elif child.get("value").isprintable() and child.get("value").isascii():
            made.headers[name] = child.get("value")
        else:
            message = "A header's value may contain only printable ASCII characters."
            reader.problem(child, "bad-value", message, "value", "Write others.")


def _check_variable(reader: Reader, node: Node, name: str) -> None:
    if not VARIABLE.fullmatch(node.get(name)):
        message = f"{name} is not the name of an environment variable."
        remedy = 'Write its name, as "LIBRARY_KEY", and keep the secret out of the document.'
        reader.problem(node, "bad-value", message, name, remedy)


def _read_fallback(reader: Reader, node: Node, made: Endpoint, grammars: Grammars) -> None:
    for tag, have in (("prompt", made.prompts), ("slot", made.slots)):
        if not have:
            message = f"<language-model> needs a <{tag}>."
            reader.problem(node, "empty", message, "", f"Add one: <{tag}>.")
    for slot in node.all("slot"):
        if "field" in slot.attributes:
            message = "A language model is asked for the slot by its name."
            reader.problem(slot, "exclusive", message, "field", "Remove field.")
    for extra in node.all("fallback")[1:]:
        message = "<language-model> has one <fallback>."
        reader.problem(extra, "exclusive", message, "", "Remove this one.")
    for child in node.all("fallback")[:1]:
        try:
            made.fallback = Fallback(grammars(child.get("grammar")), child.get("of"))
        except LookupError as error:
            why = str(error.args[0]).removeprefix("cannot be read: ")
            message = f'The grammar "{child.get("grammar")}" cannot be read: {why}.'
            reader.problem(
                child, "no-such-file", message, "grammar", "Name a file beside this one."
            )
        except DocumentError as error:
            reader.problems += error.problems


def filled_by_grammar(endpoint: Endpoint, params: Mapping[str, Json]) -> dict[str, Json] | None:
    """The fallback grammar's result for the value sent; None if the grammar does not match."""
    fallback = endpoint.fallback
    if fallback is None or not isinstance(params.get(fallback.of), str):
        return None
    found = fallback.grammar.match(params[fallback.of])
    if not found or found[0].error is not None:
        return None
    value = found[0].interpretation
    if not isinstance(value, dict):  # a grammar of one value fills the first slot
        value = {endpoint.slots[0].field: value}
    try:
        return {**endpoint.reply(value), "fallback": True}
    except Unfit:
        return None
