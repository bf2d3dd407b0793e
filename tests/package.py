"""Wheel and sdist, each installed in a fresh environment and run there: `make package`.

The licences of everything that the wheel installs are listed, and must suit MIT.

What the sdist installs is what the wheel does, file by file, so that one of them is enough to
compile and to follow a bead. No checkout is on the path.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.environments import UV

ROOT = Path(__file__).parents[1]
#: in both environments
TELLING = ("tweezer --version", "tweezer info", "tweezer scenes")
#: in that of the wheel alone
RUNNING = (
    "tweezer run thesis-990nm --out run.nc --plot run.png",
    "tweezer view run.nc --out page.html",
)
#: what these must leave behind
LEFT = ("run.nc", "run.png", "page.html")


def installed(place: Path, package: Path) -> Path:
    """A fresh environment with a package; the folder of its programs."""
    environment = place / f"with-{package.suffix.removeprefix('.')}"
    subprocess.run([*UV, "venv", "--python", sys.executable, environment], check=True)
    python = environment / "bin" / "python"
    subprocess.run([*UV, "pip", "install", "--python", python, package], check=True)
    return environment / "bin"


def files_of(programs: Path) -> set[str]:
    """What was installed of tweezer, as the installer noted it: name, hash and size."""
    (record,) = programs.parent.rglob("tweezer-*.dist-info/RECORD")
    return {line for line in record.read_text().splitlines() if line.startswith("tweezer/")}


def run(programs: Path, folder: Path, commands: tuple[str, ...]) -> None:
    """Commands in an empty folder, with empty caches."""
    folder.mkdir()
    environment = {
        **os.environ,
        "PATH": f"{programs}:{os.environ['PATH']}",
        "NUMBA_CACHE_DIR": str(folder / "compiled"),
        "XDG_CACHE_HOME": str(folder / "cache"),
    }
    environment.pop("PYTHONPATH", None)
    for command in commands:
        began = time.perf_counter()
        subprocess.run(
            command, shell=True, check=True, cwd=folder, env=environment, stdout=subprocess.DEVNULL
        )
        print(f"  {time.perf_counter() - began:6.1f} s  {command}", flush=True)


def main() -> int:
    """Build, install, run; 1 if the two differ or leave something out."""
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        # the wheel is built from the sdist, as an installer would
        subprocess.run([*UV, "build", "--out-dir", place / "built", ROOT], check=True)
        (wheel,) = place.glob("built/*.whl")
        (sdist,) = place.glob("built/*.tar.gz")
        print(wheel.name, flush=True)
        of_wheel = installed(place, wheel)
        subprocess.run([of_wheel / "python", "-I", ROOT / "tests" / "licences.py"], check=True)
        run(of_wheel, place / "wheel", (*TELLING, *RUNNING))
        missing = [left for left in LEFT if not (place / "wheel" / left).stat().st_size]
        print(sdist.name, flush=True)
        of_sdist = installed(place, sdist)
        run(of_sdist, place / "sdist", TELLING)
        differing = files_of(of_wheel) ^ files_of(of_sdist)
        print("\n".join([*missing, *sorted(differing)]) or "both are whole")
        return 1 if missing or differing else 0


if __name__ == "__main__":
    sys.exit(main())
