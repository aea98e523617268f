"""The command ``prima``, also as ``python -m prima``: an interrupt ends it quietly at any time."""

import contextlib
import gc
import os
import signal
import sys

INTERRUPTED = 130
RINGS_AFTER = 20_000
"""So many new objects make the garbage collector look for rings that nothing refers to. Its usual
700 take a tenth of a short command's time: imports make many objects, and no garbage."""


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
    gc.set_threshold(RINGS_AFTER)
    from prima.cli import main as run

    run()


if __name__ == "__main__":
    main()
