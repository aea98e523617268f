"""Users' recordings: files beside the journal, to which records refer by name."""

from __future__ import annotations

import io
import os
import wave
from contextlib import suppress
from pathlib import Path
from typing import Final

from prima.messages import Heard

TYPE: Final = "audio/x-wav"
SAMPLE_BYTES = 2
MOST_IN_MEMORY = 20
"""Maximum number of recordings that are kept without a folder for them."""


class Recordings:
    """The recordings of a run, 16-bit mono.

    Args:
        journal: the journal's path, such as VISIT.jsonl beside VISIT-1.wav; without one, or if
            what users say is left out of it, they are kept as long as the run lasts.
    """

    def __init__(self, journal: str | None = None) -> None:
        self._path = Path(journal) if journal is not None else None
        self._count = 0
        self._held: dict[str, bytes] = {}

    def keep(self, sound: bytes, rate: int, cut: bool = False) -> Heard:
        """Store a recording.

        Args:
            sound: its samples.
            rate: how many of them are a second.
            cut: whether it reached the maximum length and was cut off.

        Returns:
            the data to report: its name, length and size.

        Raises:
            OSError: it cannot be written.
        """
        buffer = io.BytesIO()
        with wave.open(buffer, "wb") as made:
            made.setnchannels(1)
            made.setsampwidth(SAMPLE_BYTES)
            made.setframerate(rate)
            made.writeframes(sound)
        name = self._write(buffer.getvalue())
        lasts = round(len(sound) / SAMPLE_BYTES / rate * 1000)
        size = len(buffer.getvalue())
        return Heard(name, {"duration": lasts, "size": size, "type": TYPE, "maxtime": cut})

    def _write(self, data: bytes) -> str:
        if self._path is None:
            self._count += 1
            name = f"recording-{self._count}.wav"
            if len(self._held) >= MOST_IN_MEMORY:
                del self._held[next(iter(self._held))]
            self._held[name] = data
            return name
        while True:
            self._count += 1
            path = self._path.with_name(f"{self._path.stem}-{self._count}.wav")
            with suppress(FileExistsError):
                file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
                with os.fdopen(file, "wb") as made:
                    made.write(data)
                return path.name

    def samples(self, name: str) -> bytes | None:
        """The samples of a recording of this run; None if none has that name."""
        data = self._held.get(name)
        path = self._path
        if path is not None and name.startswith(f"{path.stem}-") and Path(name).name == name:
            with suppress(OSError):
                data = path.with_name(name).read_bytes()
        if data is None:
            return None
        with suppress(wave.Error, EOFError), wave.open(io.BytesIO(data)) as made:
            return bytes(made.readframes(made.getnframes()))
        return None
