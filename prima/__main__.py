"""The command ``prima``, also as ``python -m prima``."""

import sys

INTERRUPTED = 130


def main() -> None:
    """Run the command line; handle an interrupt during its import, too."""
    try:
        from prima.cli import main as run

        run()
    except KeyboardInterrupt:
        if sys.stderr is not None:
            sys.stderr.write("prima: interrupted\n")
        sys.exit(INTERRUPTED)
    finally:
        # An interrupt in code from text, as a dataclass is made of: python -m would end by the signal.
        eval("0")


if __name__ == "__main__":
    main()
