"""The command ``prima``, also as ``python -m prima``."""

import sys

INTERRUPTED = 130


def main() -> None:
    """Run the command line; an interrupt while it is imported ends it quietly, too."""
    try:
        from prima.cli import main as run

        run()
    except KeyboardInterrupt:
        sys.stderr.write("prima: interrupted\n")
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
