"""What goes along with a request that a service moves to another address."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.live.test_services import SECRET, Handler, Host, document, send


class Telling(Handler):
    """Keeps another header with the key."""

    def _answer(self, host: Host, path: str, count: int) -> None:
        host.keys[-1] = f"{host.keys[-1]} {self.headers['X-Lab']}"
        super()._answer(host, path, count)


@pytest.fixture
def hosts() -> Iterator[list[Host]]:
    made = [Host(), Host()]
    for one in made:
        one.RequestHandlerClass = Telling
        threading.Thread(target=one.serve_forever, args=(0.05,), daemon=True).start()
    yield made
    for one in made:
        one.shutdown()
        one.server_close()


@pytest.mark.parametrize("leaves", [False, True])
def test_headers_and_secrets_go_to_the_services_own_address_alone(
    leaves: bool, hosts: list[Host], tmp_path: Path
) -> None:
    host, other = hosts
    elsewhere = f"http://127.0.0.1:{other.server_address[1]}/books"
    host.moved = elsewhere if leaves else "/books"
    more = (
        'url="URL/away" key="LIBRARY_KEY"><header name="X-Lab" value="7"/></service>\n'
        f'<service name="other" url="{elsewhere}"/>'
    )
    found = send(document(tmp_path, host, more), {"LIBRARY_KEY": SECRET})
    assert found.name == "reply.library"
    own = f"Bearer {SECRET} 7"
    assert (host.keys, other.keys) == (([own], ["None None"]) if leaves else ([own, own], []))
