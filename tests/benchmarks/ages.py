"""Which committed results are older than the code that they measured.

Each result records the commit that it was measured with. `python -m tests.benchmarks.ages` prints,
for each result, how many later commits changed the code of its subject, and ends with 1 if there
are any. The commits since then may change no number: measure again where they could.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from tests.benchmarks import pages
from tests.benchmarks.timing import ROOT

_THERMAL = (
    "tweezer/dynamics",
    "tweezer/fluid",
    "generated/langevin.py",
    "tweezer/compiled/lanes.py",
)
_LIGHT = ("tweezer/optics", "generated/ray.py", "generated/waves.py")
_CALIBRATION = ("tweezer/calibration", "tweezer/reading", "generated/hydrodynamics.py")

#: the code that each result is about, beside the benchmark itself
SUBJECTS: dict[str, tuple[str, ...]] = {
    "bodies": (*_LIGHT, "generated/bodies.py"),
    "brownian": _THERMAL,
    "calibrate": _CALIBRATION,
    "camera": (*_CALIBRATION, "tweezer/dynamics/camera.py"),
    "commands": ("tweezer", "generated"),
    "depth": ("tweezer/tracking",),
    "diagram": (*_LIGHT, "tweezer/trap", "tweezer/forces"),
    "fit": ("tweezer/tracking", "tweezer/calibration", "tweezer/fluid"),
    "fluid": _THERMAL,
    "force": _LIGHT,
    "free": _CALIBRATION,
    "heights": (*_CALIBRATION, "tweezer/fluid"),
    "hydro": _CALIBRATION,
    "integrate": ("tweezer/dynamics", "tweezer/fluid", *_LIGHT),
    "real_tracks": _CALIBRATION,
    "rods": (*_LIGHT, *_THERMAL, "generated/bodies.py", "tests/benchmarks/pose_grid.py"),
    "scaling": ("tweezer/ensembles", *_THERMAL),
    "sweep": ("tweezer/sweeps", "tweezer/trap", "tweezer/runs", *_LIGHT),
    "view": ("tweezer/viewing",),
    "wall": _THERMAL,
}


def measured(name: str) -> str:
    """Return the commit that a committed result was measured with."""
    return str(pages.committed(name)["machine"]["commit"]).removesuffix("+")


def later(name: str, root: Path = ROOT) -> list[str]:
    """Return a line for each commit that changed the code of a result after it was measured."""
    paths = (*SUBJECTS[name], f"tests/benchmarks/{name}.py")
    command = ["git", "log", "--format=%h %s", f"{measured(name)}..HEAD", "--", *paths]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    return done.stdout.splitlines() if done.returncode == 0 else [f"unknown: {done.stderr.strip()}"]


def report() -> Iterator[tuple[str, int]]:
    """Yield a line for each result, and the number of later commits."""
    for name in SUBJECTS:
        lines = later(name)
        newest = f"; the last is {lines[0]}" if lines else ""
        yield f"{name:12} {measured(name)}  {len(lines)} later commits{newest}", len(lines)


def main() -> int:
    """Print the age of every result; return 1 if the code of one of them has changed since."""
    rows = list(report())
    print("\n".join(text for text, _ in rows))
    return 1 if any(count for _, count in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
