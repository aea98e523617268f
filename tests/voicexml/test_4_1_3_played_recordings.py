"""Recordings that prompts play, and how long they take: VoiceXML 2.0, 4.1.3."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from prima.voicexml.recordings import length_ms
from tests.helpers.spoken import Played, plain, prompt, recording, takes, texts


def au(length: int, size: int, encoding: int = 1, rate: int = 8000) -> bytes:
    return b".snd" + struct.pack(">5I", 24, length, encoding, rate, 1) + b"x" * size


def mulaw(length: int, there: int) -> bytes:
    """A WAV file of 8-bit mu-law, as telephones have it, with a chunk before its sound."""
    form = b"fmt " + struct.pack("<IHHIIHH", 18, 7, 1, 8000, 8000, 1, 8) + b"\0\0"
    other = b"LIST" + struct.pack("<I", 3) + b"abc\0"
    body = b"WAVE" + form + other + b"data" + struct.pack("<I", length) + b"x" * there
    return b"RIFF" + struct.pack("<I", len(body)) + body


def test_a_recording_of_the_folder_takes_its_own_time(played: Played, tmp_path: Path) -> None:
    (tmp_path / "sounds").mkdir()
    recording(tmp_path / "sounds" / "bell.wav", 2.5)
    made = played(
        prompt('<audio src="sounds/bell.wav"/>').replace(
            "</block>",
            """<prompt><audio expr="'sounds/' + 'bell.wav'">A bell. <break time="9s"/></audio></prompt>
            <prompt>Listen: <audio src="sounds/bell.wav">a bell</audio>!</prompt>
            <prompt xml:base="sounds/"><audio src="bell.wav"/></prompt></block>""",
        )
    )
    assert texts(made) == ["[bell.wav]", "A bell.", "Listen: a bell !", "[bell.wav]"]
    assert takes(made) == [2500, 2500, plain("Listen:") + 2500, 2500]


@pytest.mark.parametrize(
    "inside", ["<desc xml:lang='fr'>cloche</desc>", "<s xml:lang='EN'>rings</s>"]
)
def test_a_description_in_another_language_divides_no_recording(
    played: Played, tmp_path: Path, inside: str
) -> None:  # SSML 1.0, 3.3.3; RFC 3066, 2.1
    recording(tmp_path / "bell.wav", 2.5)
    made = played(prompt(f'<audio src="bell.wav">A bell {inside} here.</audio>'))
    assert (len(texts(made)), takes(made)) == (1, [2500])


def test_a_recording_that_is_not_there_is_said(played: Played) -> None:
    made = played(
        """<form><block><prompt><audio src="none.wav">A <break time="1s"/> bell.</audio></prompt>
        <prompt><audio src="none.wav"/></prompt>
        <prompt><audio src="http://example.org/a.wav">Far away.</audio></prompt>
        <prompt><audio src="http://example.org/a.wav"/></prompt></block></form>"""
    )
    assert texts(made) == ["A bell.", "[none.wav]", "Far away.", "[a.wav]"]
    assert takes(made) == [plain("A bell.") + 1000, 1000, plain("Far away."), 1000]


@pytest.mark.parametrize(
    "name",
    ["../x.wav", "/etc/passwd", "http://[", "a%00b.wav", "x" * 5000, "", "#a", "data:,x", "app.vxml",
     "folder", "link.wav"],
)  # fmt: skip
def test_what_is_no_recording_of_the_folder_is_not_played(
    played: Played, tmp_path: Path, name: str
) -> None:
    (tmp_path / "folder").mkdir()
    recording(tmp_path.parent / "x.wav", 9)
    (tmp_path / "link.wav").symlink_to(tmp_path.parent / "x.wav")
    made = played(prompt(f'<audio src="{name}">Said.</audio>'))
    assert (texts(made), takes(made), made.failures) == (["Said."], [plain("Said.")], [])


@pytest.mark.parametrize(
    ("head", "size", "ms"),
    [
        (mulaw(4000, 4000), None, 500),
        (mulaw(80_000, 10), 100_000, 10_000),  # only the beginning has been read
        (mulaw(0xFFFFFFFF, 4000), None, 500),  # written without knowing its end
        (mulaw(4000, 10), None, None),  # says more than there is
        (mulaw(0, 0), None, None),
        (au(4000, 4000), None, 500),
        (au(0xFFFFFFFF, 4000), None, 500),
        (au(4000, 4000, 3), None, 250),
        (au(4000, 4000, 99), None, None),
        (au(4000, 10), None, None),
        (au(10, 10, rate=0), None, None),
        (b"RIFF", None, None),
        (b"RIFF\0\0\0\0WAVE", None, None),
        (b"RIFF\0\0\0\0WAVEfmt \xff\xff\xff\xff", None, None),
        (b"RIFF\0\0\0\0WAVEdata\x01\0\0\0x", None, None),
        (b".snd\0", None, None),
        (b"ID3 an mp3", None, None),
        (b"", None, None),
    ],
)
def test_a_recordings_header_is_believed_only_where_it_can_be_true(
    head: bytes, size: int | None, ms: int | None
) -> None:
    assert length_ms(head, len(head) if size is None else size) == ms
