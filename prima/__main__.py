"""The command ``prima``, also as ``python -m prima``: an interrupt ends it quietly at any time."""

import contextlib
import os
import signal
import sys

INTERRUPTED = 130


def end(_signal: int, _frame: object) -> None:
    """End at once: an exception would be lost or changed in the imports of compiled modules."""
    with contextlib.suppress(Exception):
        sys.stdout.flush()
    os.write(2, b"prima: interrupted\n")
    os._exit(INTERRUPTED)


def main() -> None:
    """Run the command line, which is imported when an interrupt is already taken care of."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, end)
    from prima.cli import main as run

    run()


if __name__ == "__main__":
    main()
