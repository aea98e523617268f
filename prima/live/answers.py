"""Services' answers: parsed strictly, and without the secrets that were sent."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable
from dataclasses import replace
from http.client import HTTPResponse
from typing import NoReturn

from prima.devices.endpoints import Unfit
from prima.messages import Fetched, Json, Occurred

HIDDEN = "***"
"""Replaces a secret that a host sends back."""
JSON_TYPE = re.compile(r"application/(?:[\w.+-]+\+)?json", re.IGNORECASE)


def check_type(response: HTTPResponse) -> None:
    """Check that an answer is declared as JSON; one without a declaration is read as JSON.

    Raises:
        Unfit: it is something else.
    """
    if response.headers.get("Content-Type") is None:
        return
    kind = response.headers.get_content_type()
    if not JSON_TYPE.fullmatch(kind):
        raise Unfit(f"the answer is {kind[:60]}, not application/json")


def read_json(body: bytes | str, what: str) -> Json:
    """A text as JSON (RFC 8259) that a journal can hold.

    Raises:
        Unfit: it is not JSON, or contains something that a journal cannot hold.
    """

    def refuse(name: str) -> NoReturn:
        raise ValueError(name)

    def finite(text: str) -> float:
        number = float(text)
        if not math.isfinite(number):
            raise Unfit(f"{what} has a number that is too large")
        return number

    def whole(text: str) -> int:
        finite(text)
        return int(text)

    def once(pairs: list[tuple[str, Json]]) -> dict[str, Json]:
        held: dict[str, Json] = {}
        for name, value in pairs:
            if name in held:
                raise Unfit(f'{what} has "{name}" twice')
            held[name] = value
        return held

    try:
        given: Json = json.loads(
            body, parse_constant=refuse, parse_float=finite, parse_int=whole, object_pairs_hook=once
        )
        json.dumps(given, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        raise Unfit(f"{what} has half a letter") from None
    except Unfit:
        raise
    except (ValueError, RecursionError):
        raise Unfit(f"{what} is not JSON") from None
    return given


def said_by_model(given: Json) -> Json:
    """A language model's output, as JSON.

    Raises:
        Unfit: it is empty or not JSON.
    """
    try:
        said = given["choices"][0]["message"]["content"]
    except (TypeError, KeyError, IndexError):
        raise Unfit("the answer has no choices[0].message.content") from None
    if not isinstance(said, str):
        raise Unfit("the model says nothing")
    return read_json(said, "what the model says")


def hidden(value: Occurred | Fetched, secrets: Iterable[str]) -> Occurred | Fetched:
    """An inbound value without secrets, however the host has encoded them."""
    words = "|".join(re.escape(one) for one in sorted(secrets, key=len, reverse=True))
    if not words:
        return value
    found = re.compile(words, re.IGNORECASE)

    def hide(part: Json) -> Json:
        if isinstance(part, str):
            return found.sub(HIDDEN, part)
        if isinstance(part, dict):
            return {hide(name): hide(one) for name, one in part.items()}
        return [hide(one) for one in part] if isinstance(part, list) else part

    if isinstance(value, Occurred):
        return replace(value, data=hide(dict(value.data)))
    return replace(value, body=hide(value.body), problem=hide(value.problem))
