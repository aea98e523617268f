"""Run all attacks beside an honest application, and print what each cost and who survived."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from tests.helpers.attacks import ATTACKS, attempt


def main() -> int:
    """Print a row for each attack; 1 if one of them was not contained."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("words", nargs="*", help="only attacks with one of these in their names")
    words = parser.parse_args().words
    print(
        f"{'family':<12}{'attack':<38}{'s':>7}{'CPU s':>7}{'MB':>6}{'exit':>6}  survived  why it ended"
    )
    failed = 0
    for attack in ATTACKS:
        if words and not any(word in f"{attack.family} {attack.name}" for word in words):
            continue
        with tempfile.TemporaryDirectory() as folder:
            found = attempt(attack, Path(folder))
        failed += not found.contained
        numbers = f"{found.seconds:7.2f}{found.processor:7.2f}{found.peak:6.0f}{found.exit:6}"
        mark = "yes" if found.contained else "NO"
        why = found.said[-1][-70:] if found.said else ""
        print(f"{attack.family:<12}{attack.name:<38}{numbers}  {mark:<8}  {why}", flush=True)
    print(f"{failed} not contained")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
