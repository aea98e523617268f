"""Lines from a file descriptor, read beside the event loop."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Iterator
from threading import Semaphore, Thread

from prima.devices.lines import line_text

CHUNK = 4096
LONGEST = 16_000
"""Bytes of a line that are kept; a line of this length is rejected anyway."""
AHEAD = 100
"""Lines that are read ahead."""


class LineSource:
    """Reads the lines of a terminal, a pipe or a file, by its descriptor, until its end.

    A thread reads, as no other way serves all three. It may wait for input for ever, so it does
    not keep the program from ending.
    """

    def __init__(self, source: int) -> None:
        self._source = source
        self._loop = asyncio.get_running_loop()
        self._queue: asyncio.Queue[str | None] = asyncio.Queue()
        self._room = Semaphore(AHEAD)
        self._closed = False
        Thread(target=self._read, name="console", daemon=True).start()

    async def next(self) -> str | None:
        """The next line, without its end; None at the end of the input."""
        line = await self._queue.get()
        self._room.release()
        return line

    def close(self) -> None:
        """Stop reading once the thread has received its current input."""
        self._closed = True
        self._room.release()

    def _read(self) -> None:
        for line in _lines(self._source):
            self._room.acquire()
            if self._closed:
                return
            try:
                self._loop.call_soon_threadsafe(self._queue.put_nowait, line)
            except RuntimeError:  # the loop is gone
                return


def _lines(source: int) -> Iterator[str | None]:
    """The lines of a source, and None at its end."""
    left = b""
    while read := _piece(source):
        *whole, left = (left + read).split(b"\n")
        yield from (line_text(one, "replace") for one in whole)
        left = left[:LONGEST]
    if left:
        yield line_text(left, "replace")
    yield None


def _piece(source: int) -> bytes:
    try:
        return os.read(source, CHUNK)
    except OSError:  # a terminal that has been closed
        return b""
