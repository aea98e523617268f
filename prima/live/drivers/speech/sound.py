"""Sound in and out: 16-bit mono at 16 kHz, by a sound card."""

from __future__ import annotations

import asyncio
import math
from array import array
from collections.abc import Callable
from contextlib import suppress
from threading import Lock
from typing import Any, Protocol

from prima.live.driver import Unreachable, Unusable

RATE = 16_000
"""Samples a second."""
CHUNK = 1024
"""Bytes in a chunk: 32 ms, the size that the speech detector takes."""
CHUNK_S = CHUNK / 2 / RATE
BEEP_HZ, BEEP_MS, BEEP_LOUD = 880, 500, 6000
Hear = Callable[[bytes], None]


def seconds(sound: bytes) -> float:
    """How long a sound lasts."""
    return len(sound) / 2 / RATE


def beep() -> bytes:
    """The signal before a recording: a soft tone."""
    swing = 2 * math.pi * BEEP_HZ / RATE
    samples = (round(BEEP_LOUD * math.sin(swing * at)) for at in range(RATE * BEEP_MS // 1000))
    return array("h", samples).tobytes()


class Sound(Protocol):
    """A microphone and a loudspeaker."""

    heard: int
    """The number of bytes of the latest sound that have been played."""

    def open(self, hear: Hear, lost: Callable[[str], None]) -> None:
        """Begin to listen.

        Args:
            hear: called with each :data:`CHUNK` of sound, in any thread.
            lost: called with the reason when no more sound comes, in any thread.

        Raises:
            Unreachable: there is no such device.
        """

    async def play(self, sound: bytes) -> None:
        """Play a sound to its end; it stops at once if this is cancelled."""

    def close(self) -> None:
        """Give back the devices."""


class SoundCard:
    """The machine's microphone and loudspeaker.

    Args:
        source: the microphone's name or number; empty for the default.
        sink: the loudspeaker's.
    """

    def __init__(self, source: str = "", sink: str = "") -> None:
        self.heard = 0
        self._names = source, sink
        self._streams: list[Any] = []
        self._lock = Lock()
        self._buffer = b""

    def open(self, hear: Hear, lost: Callable[[str], None]) -> None:
        """Begin to listen.

        Raises:
            Unreachable: there is no such device, or no sound at all.
        """
        self.close()
        try:
            import sounddevice
        except (ImportError, OSError) as error:
            message = f"there is no sound: {error}. Install PortAudio (libportaudio2)"
            raise Unusable(f"{message} and: pip install 'prima[speech]'") from None

        def heard(data: Any, *_: object) -> None:
            hear(bytes(data))

        def wanted(data: Any, *_: object) -> None:
            data[:] = self._take(len(data))

        form = {"samplerate": RATE, "channels": 1, "dtype": "int16", "blocksize": CHUNK // 2}
        source, sink = (int(name) if name.isdecimal() else name or None for name in self._names)
        names = ("microphone", "loudspeaker")
        ended = lambda: lost("the sound card is gone")  # noqa: E731
        made = (
            (sounddevice.RawInputStream, heard, source),
            (sounddevice.RawOutputStream, wanted, sink),
        )
        for name, (kind, callback, device) in zip(names, made, strict=True):
            try:
                stream = kind(device=device, callback=callback, finished_callback=ended, **form)
                self._streams.append(stream)
                stream.start()
            except Exception as error:  # PortAudio's own, and ValueError for a name
                self.close()
                raise Unreachable(_lacking(name, device, error)) from None

    def _take(self, size: int) -> bytes:
        with self._lock:
            taken, self._buffer = self._buffer[:size], self._buffer[size:]
        return taken.ljust(size, b"\0")

    async def play(self, sound: bytes) -> None:
        """Play a sound."""
        with self._lock:
            self._buffer, self.heard = sound, 0
        try:
            while self._buffer:
                await asyncio.sleep(CHUNK_S)
        finally:
            with self._lock:
                self.heard, self._buffer = len(sound) - len(self._buffer), b""

    def close(self) -> None:
        """Give back the devices."""
        streams, self._streams = self._streams, []
        for stream in streams:
            with suppress(Exception):  # it is already gone
                stream.close(ignore_errors=True)


def _lacking(name: str, device: int | str | None, error: Exception) -> str:
    """The remedies for a missing microphone or loudspeaker."""
    which = (
        f'the {name} "{device}" cannot be opened' if device is not None else f"there is no {name}"
    )
    remedy = f'Connect one, or choose one by <option name="{name}" value="..."/>;'
    return f"{which} ({error}). {remedy} python -m sounddevice lists the devices."
