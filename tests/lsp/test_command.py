"""prima lsp at a terminal, and without its library."""

from __future__ import annotations

import pty
import subprocess
import sys


def test_a_person_at_a_terminal_is_told_what_it_is_for() -> None:
    _master, slave = pty.openpty()
    done = subprocess.run(
        [sys.executable, "-m", "prima", "lsp"], stdin=slave, capture_output=True, encoding="utf-8"
    )
    assert done.returncode == 2
    assert "An editor starts this" in done.stderr and "docs/editors.md" in done.stderr


def test_without_pygls_it_says_what_to_install() -> None:
    code = (
        "import sys; sys.modules['pygls'] = None; sys.argv = ['prima', 'lsp']\n"
        "from prima.cli import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        encoding="utf-8",
    )
    assert done.returncode == 2
    assert done.stderr == 'prima: The language server needs pygls: pip install "prima[editor]".\n'
