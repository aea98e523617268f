"""Messages between a run and a process that evaluates untrusted code: JSON with a length prefix.

Values of the engine, which cannot leave its process, are numbers there (:class:`Handle`).
"""

from __future__ import annotations

import json
import os
import struct
from typing import Any

HEADER = struct.Struct("!I")
LONGEST_REQUEST, LONGEST_REPLY = 64 * 1024 * 1024, 4 * 1024 * 1024
"""Maximum size of a message in bytes."""
FIRST, CHUNK = 4096, 1024 * 1024
"""Bytes read at once, at a message's beginning and later."""

_encode = json.JSONEncoder(separators=(",", ":"), check_circular=False).encode
_decode = json.JSONDecoder().decode


class TooMuch(Exception):
    """A message is too long or nested too deep: none of it was sent, or all of it was read."""


class WireBroken(Exception):
    """The other side has gone, or sent something that is not a message."""


def send(pipe: int, message: Any, longest: int) -> None:
    """Write a message.

    Raises:
        TooMuch: it is too long, or nested too deep.
        WireBroken: the other side has gone.
    """
    try:
        body = _encode(message).encode("ascii")
    except RecursionError:
        raise TooMuch("it is nested too deep") from None
    if len(body) > longest:
        raise TooMuch(f"it has more than {longest:,} bytes")
    left = memoryview(HEADER.pack(len(body)) + body)
    try:
        while left:
            left = left[os.write(pipe, left) :]
    except OSError as error:
        raise WireBroken(str(error)) from None


def receive(pipe: int, longest: int) -> Any:
    """Wait for a message: each is answered before the next is sent.

    Raises:
        TooMuch: it is nested deeper than can be read here, where more may be on the stack.
        WireBroken: the other side has gone.
    """
    found = os.read(pipe, FIRST)
    while len(found) < HEADER.size:
        found += _more(pipe)
    size: int = HEADER.unpack_from(found)[0]
    if size > longest:
        raise WireBroken(f"a message of {size:,} bytes")
    missing = HEADER.size + size - len(found)
    pieces = [found]
    while missing > 0:
        pieces.append(_more(pipe))
        missing -= len(pieces[-1])
    if missing < 0:
        raise WireBroken("more than a message")
    try:
        return _decode(str(b"".join(pieces)[HEADER.size :], "ascii"))
    except RecursionError:
        raise TooMuch("it is nested too deep") from None
    except ValueError as error:
        raise WireBroken(str(error)) from None


def _more(pipe: int) -> bytes:
    piece = os.read(pipe, CHUNK)
    if not piece:
        raise WireBroken("it has gone")
    return piece
