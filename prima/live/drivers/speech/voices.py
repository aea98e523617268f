"""Voices: text to sound. English and Japanese have their own, all other languages share one."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import Any

from prima.live.driver import Refused
from prima.live.drivers.speech.sound import RATE

LONGEST_S = 30
"""How long an external program may take to synthesise a text."""
LOUDEST = 32767
Voice = Callable[[str, str], bytes]
"""Converts a text with its language tag to sound."""


def resampled(samples: Any, rate: int) -> bytes:
    """Samples from -1 to 1 as sound, whatever their rate."""
    import numpy

    wanted = round(len(samples) * RATE / rate)
    if not wanted:
        return b""
    spectrum = numpy.fft.rfft(samples)
    kept = wanted // 2 + 1
    spectrum = numpy.pad(spectrum[:kept], (0, max(kept - len(spectrum), 0)))
    made = numpy.fft.irfft(spectrum, wanted) * wanted / len(samples)
    sound: bytes = (numpy.clip(made, -1, 1) * LOUDEST).astype("<i2").tobytes()
    return sound


def hibari() -> Voice:
    """The English voice; it is deterministic."""
    from hibari import SAMPLE_RATE, Hibari

    speaker = Hibari()
    return lambda text, lang: resampled(speaker(text, seed=0), SAMPLE_RATE)


def open_jtalk() -> Voice:
    """The Japanese voice."""
    import pyopenjtalk

    def say(text: str, lang: str) -> bytes:
        samples, rate = pyopenjtalk.tts(text)
        return resampled(samples / LOUDEST, rate)

    return say


def espeak() -> Voice:
    """A voice for a hundred languages, by the program espeak-ng.

    Raises:
        Refused: it is not installed.
    """
    program = shutil.which("espeak-ng")
    if program is None:
        raise Refused("the program espeak-ng is not installed", "speaker")

    def say(text: str, lang: str) -> bytes:
        command = [program, "-v", lang or "en", "--stdin", "--stdout"]
        done = subprocess.run(
            command, input=text.encode(), capture_output=True, timeout=LONGEST_S, check=False
        )
        if done.returncode or not done.stdout:
            raise Refused(f'espeak-ng has no voice for the language "{lang}"', "speaker")
        return _read_wave(done.stdout)

    return say


def _read_wave(data: bytes) -> bytes:
    import numpy

    # The lengths in the header are unknown when a program writes to a pipe.
    rate = int.from_bytes(data[24:28], "little")
    samples = numpy.frombuffer(data[44:], "<i2", (len(data) - 44) // 2)
    return resampled(samples / LOUDEST, rate)


MADE: Mapping[str, Callable[[], Voice]] = {
    "hibari": hibari,
    "open-jtalk": open_jtalk,
    "espeak": espeak,
}
"""The voices by name."""
EXTRAS = {"hibari": "speech", "open-jtalk": "speech,speech-ja"}
"""What installs a voice."""
LANGUAGES = {"en": "hibari", "ja": "open-jtalk"}
"""Languages with a voice of their own."""


class Voices:
    """Synthesises texts; each voice is loaded when it is first needed.

    Args:
        name: the voice for all texts; empty to choose by a text's language.
    """

    def __init__(self, name: str = "") -> None:
        self._name = name
        self._made: dict[str, Voice] = {}

    def prepare(self, languages: Iterable[str]) -> None:
        """Load the voices of some languages now; a missing one is reported when it should speak."""
        for lang in languages:
            with suppress(Refused):
                self.say("a", lang)  # this loads what it needs

    def say(self, text: str, lang: str) -> bytes:
        """The sound of a text.

        Raises:
            Refused: there is no voice for it.
        """
        return self._voice(lang)(text, lang or "en")

    def _voice(self, lang: str) -> Voice:
        primary = lang.lower().partition("-")[0] or "en"
        name = self._name or LANGUAGES.get(primary, "espeak")
        if name not in self._made:
            try:
                self._made[name] = MADE[name]()
            except ImportError as error:
                line = f"pip install 'prima[{EXTRAS[name]}]'"
                raise Refused(
                    f"the voice {name} is not there ({error}): {line}", "speaker"
                ) from None
        return self._made[name]
