"""``python -m prima``."""

from prima.cli import main

if __name__ == "__main__":
    main()
