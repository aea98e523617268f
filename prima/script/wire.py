"""Messages between a run and a process that evaluates strangers' code: JSON behind its length.

Values of the engine, which cannot leave its process, are numbers there (:class:`Handle`).
"""

from __future__ import annotations

import json
import os
import struct
from typing import Any

HEADER = struct.Struct("!I")
LONGEST_REQUEST, LONGEST_REPLY = 64 * 1024 * 1024, 4 * 1024 * 1024
"""Bytes that a message may have."""
CHUNK = 1024 * 1024
"""Bytes that are read at once."""

_encode = json.JSONEncoder(separators=(",", ":"), check_circular=False).encode


class TooMuch(Exception):
    """A message is too long or nested too deep; nothing of it was sent."""


class WireBroken(Exception):
    """The other side has gone, or sent something that is not a message."""


def send(pipe: int, message: Any, longest: int) -> None:
    """Write a message.

    Raises:
        TooMuch: it is too long, or nested too deep.
        Broken: the other side has gone.
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
    """Wait for a message.

    Raises:
        Broken: there will be none.
    """
    size: int = HEADER.unpack(_read(pipe, HEADER.size))[0]
    if size > longest:
        raise WireBroken(f"a message of {size:,} bytes")
    try:
        return json.loads(_read(pipe, size))
    except (ValueError, RecursionError) as error:
        raise WireBroken(str(error)) from None


def _read(pipe: int, size: int) -> bytes:
    first = os.read(pipe, size)
    if len(first) == size:
        return first
    found = bytearray(first)
    while len(found) < size:
        piece = os.read(pipe, min(size - len(found), CHUNK))
        if not piece:
            raise WireBroken("it has gone")
        found += piece
    return bytes(found)
