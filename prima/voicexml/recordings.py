"""The duration of a recording by its file's header (WAV or AU); the sound is not read."""

from __future__ import annotations

import struct

from prima.language.values import LONGEST_MS

HEADER_BYTES = 65_536
"""How much of a file's beginning is read."""
AU_BYTES = {1: 1, 2: 1, 3: 2, 4: 3, 5: 4, 6: 4, 7: 8, 27: 1}
"""Bytes of one sample in each encoding of an AU file."""
UNKNOWN_SIZE = 0xFFFFFFFF


def length_ms(head: bytes, size: int) -> int | None:
    """The duration of a recording.

    Args:
        head: the first bytes of its file, :data:`HEADER_BYTES` at most.
        size: how many bytes the whole file has.

    Returns:
        Milliseconds, or None if it is neither WAV nor AU, or its header is implausible.
    """
    try:
        if head[:4] == b"RIFF" and head[8:12] == b"WAVE":
            sound, rate = _wav(head, size)
        elif head[:4] == b".snd":
            sound, rate = _au(head, size)
        else:
            return None
    except struct.error:
        return None
    if sound <= 0 or rate <= 0:
        return None
    length = round(sound / rate * 1000)
    return max(length, 1) if length <= LONGEST_MS else None


def _wav(head: bytes, size: int) -> tuple[int, int]:
    """Bytes of sound and bytes a second; 0 where the header gives none, or more than there are."""
    at, rate = 12, 0
    while at + 8 <= len(head):
        name, length = head[at : at + 4], struct.unpack_from("<I", head, at + 4)[0]
        at += 8
        if name == b"fmt ":
            rate = struct.unpack_from("<I", head, at + 8)[0]
        elif name == b"data":
            return _sound(length, size - at), rate
        at += length + length % 2
    return 0, 0


def _au(head: bytes, size: int) -> tuple[int, int]:
    """The same for an AU file, whose header may leave the length open."""
    offset, length, encoding, samples, channels = struct.unpack_from(">5I", head, 4)
    rate = samples * channels * AU_BYTES.get(encoding, 0)
    return _sound(length, size - offset) if offset >= 24 else 0, rate


def _sound(said: int, there: int) -> int:
    """Bytes of sound as in the header, unless it leaves them open or claims too many."""
    if said == UNKNOWN_SIZE:
        return there
    return said if said <= there else 0
