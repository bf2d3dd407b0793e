"""Regenerate `generated/`, or check that it is up to date with the derivation."""

from __future__ import annotations

import argparse
import sys

from .emission import GENERATED, differences, emit, write


def main() -> int:
    """Write `generated/`; with --check compare instead, and return 1 with a diff if it is stale."""
    parser = argparse.ArgumentParser(prog="python -m derivation", description=__doc__)
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit 1 with a diff if stale"
    )
    check = parser.parse_args().check
    files = emit()
    diffs = list(differences(files, GENERATED))
    if check:
        sys.stdout.writelines(diffs)
        stale = f"{len(diffs)} of {len(files)} modules differ: run python -m derivation"
        print(stale if diffs else f"{len(files)} modules are up to date", file=sys.stderr)
        return 1 if diffs else 0
    write(files, GENERATED)
    print(f"{len(files)} modules emitted, {len(diffs)} changed", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
