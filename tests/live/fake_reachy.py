"""A server that answers as the daemon of Reachy Mini does, and moves nothing but numbers."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import json
import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

MAGIC = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
UPRIGHT = {
    "head_pose": {"x": 0.0, "y": 0.0, "z": 0.0, "roll": 0.0, "pitch": 0.0, "yaw": 0.0},
    "antennas_position": [-0.1745, 0.1745],
    "body_yaw": 0.0,
}


class FakeReachy:
    """What it is asked is in ``asked``; ``answers`` are given in the place of its own."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, Any]] = []
        self.answers: dict[str, tuple[int, Any]] = {}
        self.state: dict[str, Any] = dict(UPRIGHT)
        self.mode = "enabled"
        self.doa: Any = None
        self.ends = "move_completed"
        """How moves end; nothing if they go on until they are stopped."""
        self.details = "the motor is hot"
        self.moves = True
        """Whether parts go where they are sent."""
        self.running: list[str] = []
        self._writers: set[asyncio.StreamWriter] = set()
        self._listeners: list[asyncio.StreamWriter] = []
        self.port = 0

    @property
    def gotos(self) -> list[dict[str, Any]]:
        """The bodies of the gotos that it was asked for."""
        return [body for path, body in self.asked if path == "/api/move/goto"]

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer one connection."""
        self._writers.add(writer)
        head = (await reader.readuntil(b"\r\n\r\n")).decode().splitlines()
        path = head[0].split()[1]
        fields = dict(line.lower().split(": ", 1) for line in head[1:] if ": " in line)
        if "upgrade" in fields.get("connection", ""):
            key = next(
                line.split(": ")[1] for line in head if line.lower().startswith("sec-websocket-key")
            )
            self._shake_hands(writer, key)
            await reader.read(1)  # the driver says nothing but good-bye
            writer.close()
            return
        written = await reader.readexactly(int(fields.get("content-length", 0)))
        body = json.loads(written) if written else None
        self.asked.append((path, body))
        status, answer = self.answers.get(path) or (200, self._answer(path, body))
        text = answer if isinstance(answer, str) else json.dumps(answer)
        writer.write(f"HTTP/1.1 {status} X\r\nContent-Length: {len(text)}\r\n\r\n{text}".encode())
        writer.close()

    def _shake_hands(self, writer: asyncio.StreamWriter, key: str) -> None:
        accept = base64.b64encode(hashlib.sha1((key + MAGIC).encode()).digest()).decode()
        writer.write(
            b"HTTP/1.1 101 X\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            + f"Sec-WebSocket-Accept: {accept}\r\n\r\n".encode()
        )
        self._listeners.append(writer)

    def _answer(self, path: str, body: Any) -> Any:
        if path == "/api/daemon/status":
            return {"state": "running", "error": None}
        if path == "/api/motors/status":
            return {"mode": self.mode}
        if path == "/api/state/full":
            return self.state
        if path == "/api/state/doa":
            return self.doa
        if path == "/api/move/running":
            return [{"uuid": one} for one in self.running]
        if path == "/api/move/stop":
            self.running.remove(body["uuid"])
            self.tell("move_cancelled", body["uuid"])
            return {}
        return self._move(path, body) if path.startswith("/api/move/") else {}

    def _move(self, path: str, body: Any) -> dict[str, str]:
        uuid = f"move-{len(self.asked)}"
        if path == "/api/move/goto" and self.moves:
            names = {"antennas": "antennas_position"}
            self.state = {names.get(name, name): value for name, value in body.items()}
        if self.ends:
            self.tell(self.ends, uuid)
        else:
            self.running.append(uuid)
        return {"uuid": uuid}

    def tell(self, event: str, uuid: str) -> None:
        """Tell all listeners how a move has ended."""
        self.send(json.dumps({"type": event, "uuid": uuid, "details": self.details}))

    def send(self, text: str) -> None:
        """Send all listeners a text."""
        for writer in self._listeners:
            writer.write(b"\x81\x7e" + struct.pack("!H", len(text)) + text.encode())

    def hang_up(self) -> None:
        """Drop all connections."""
        for writer in self._writers:
            writer.close()


@asynccontextmanager
async def fake_reachy() -> AsyncIterator[FakeReachy]:
    """A fake daemon on a free port."""
    fake = FakeReachy()
    server = await asyncio.start_server(fake.serve, "127.0.0.1", 0)
    fake.port = server.sockets[0].getsockname()[1]
    try:
        yield fake
    finally:
        fake.hang_up()
        server.close()
