"""What the speech driver says and hears: the robot's voice and the recognisers are the real ones.

Two pipes in memory are the sound card.
"""

from __future__ import annotations

import json
import os
import subprocess
import wave
from pathlib import Path
from threading import Timer

from tests.parties.speech.sounding import HERE, LONGEST_S, ROOT, prima


def test_a_voicexml_form_is_filled_and_a_note_recorded_by_sound(
    python: str, tmp_path: Path
) -> None:
    robot, journal = tmp_path / "robot.xml", tmp_path / "visit.jsonl"
    heard = (ROOT / HERE / "heard.xml").read_text()
    address = "documents/scenarios/follow-during-navigation.xml"
    assert address in heard
    robot.write_text(heard.replace(address, f"{HERE}/order.xml"))
    running = prima(
        python,
        *("live", "--robot", str(robot), "--driver", f"{HERE}/user.py"),
        *("--ea", f"{HERE}/order.vxml", "-o", str(journal)),
    )
    limit = Timer(LONGEST_S, running.kill)
    limit.start()
    told, _ = running.communicate()
    limit.cancel()
    assert running.returncode == 0, told
    records = [json.loads(line) for line in journal.read_text().splitlines()]
    (log,) = (one["message"] for one in records if one["phase"] == "log")
    assert log.startswith("large,mushrooms and cheese,true,visit-1.wav,"), told
    duration, cut = log.split(",")[4:]
    assert 1000 < int(duration) < 5000 and cut == "false"
    with wave.open(str(tmp_path / "visit-1.wav")) as recorded:
        assert recorded.getnframes() / recorded.getframerate() == int(duration) / 1000
    assert "parcel on my desk" in said(python, tmp_path / "visit-1.wav")
    again = prima(python, "replay", str(journal))
    told, _ = again.communicate(timeout=60)
    assert (again.returncode, told) == (0, "the same, byte for byte\n")


def said(python: str, path: Path) -> str:
    """The words in a recording."""
    code = (
        "import sys, wave; from prima.live.drivers.speech.ears import OpenEar;"
        "one = wave.open(sys.argv[1]); print(OpenEar().hear(one.readframes(one.getnframes())))"
    )
    done = subprocess.run(
        [python, "-c", code, str(path)],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=True,
    )
    return done.stdout.strip()


SAYS = """
import asyncio, time
from pathlib import Path
from runpy import run_path
from prima.devices.goals import SAY, Begin
from prima.devices.profile import read_robot
from prima.live.drivers.speech import SpeechDriver
from prima.messages import Command
from prima.sim.map import read_world

class Quiet(SpeechDriver):
    def sound(self):
        return run_path("tests/parties/speech/user.py")["Pipes"]()

async def main():
    robot = read_robot("r.xml", Path("documents/robots/speech.xml").read_bytes())
    site = read_world("w.xml", Path("documents/worlds/room.xml").read_bytes())
    settings = next(one for one in robot.drivers if one.kind == "speech")
    driver, told = Quiet(settings, robot, site), []
    driver.attach(lambda one: told.append((time.monotonic(), one)))
    await driver.open()
    texts = {"en": "Hello there, how are you?", "ja": "こんにちは。", "de": "Guten Tag.", "xx": "Hm."}
    for lang, text in texts.items():
        driver.start(Begin(lang, SAY, Command("speak", {}, text, lang=lang), frozenset()))
        for _ in range(1000):
            if told and type(told[-1][1]).__name__ in ("Done", "Broke"):
                break
            await asyncio.sleep(0.01)
        print(type(told[-1][1]).__name__, *getattr(told[-1][1], "reason", "").split())
        told.clear()
    driver.start(Begin("long", SAY, Command("speak", {}, "Hello. " * 20, lang="en"), frozenset()))
    await asyncio.sleep(2)
    began = time.monotonic()
    driver.cancel("long")
    await asyncio.sleep(0.5)
    print(type(told[-1][1]).__name__, told[-1][0] - began < 0.2)
    print(await driver.check())
    await driver.close()

asyncio.run(main())
"""


def test_languages_have_voices_and_what_is_cancelled_stops_at_once(python: str) -> None:
    done = subprocess.run(
        [python, "-c", SAYS],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert done.stdout.splitlines() == [
        "Done",
        "Done",
        "Done",
        'Broke espeak-ng has no voice for the language "xx"',
        "Stopped True",
        "{'microphone': 'no sound comes from it'}",
    ], done.stdout + done.stderr


def test_a_machine_without_a_sound_card_says_so(python: str) -> None:
    checked = prima(python, "live", "--robot", "documents/robots/speech.xml", "--check")
    told, _ = checked.communicate(timeout=120)
    assert checked.returncode == 3
    assert "Traceback" not in told
    assert "FAILS  connection" in told and "there is no microphone" in told
