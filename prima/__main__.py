"""The command ``prima``, also as ``python -m prima``: an interrupt ends it quietly at any time."""

import contextlib
import gc
import os
import sys

try:  # signal itself makes enumerations of all there are: that takes 2 ms
    import _signal as signal  # type: ignore[import-not-found,unused-ignore]
except ImportError:
    import signal

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


def leave(code: int) -> None:
    """End with an exit code, and do not take apart what has been imported: that takes a tenth, too.

    What was registered to be done at the end is done. Whoever has something else to do then, as
    threads and profilers do, gets the interpreter's own end.
    """
    import atexit
    import threading

    others = set(threading.enumerate()) - {threading.current_thread()}
    if sys.gettrace() or sys.getprofile() or not all(one.daemon for one in others):
        sys.exit(code)
    atexit._run_exitfuncs()
    with contextlib.suppress(Exception):
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(code)


def main() -> None:
    """Run the command line, which is imported when an interrupt is already taken care of."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, end)
    gc.set_threshold(RINGS_AFTER)
    from prima.cli import main as run

    try:
        run()
    except SystemExit as over:
        leave(over.code if isinstance(over.code, int) else 0)


if __name__ == "__main__":
    main()
