"""Every command once in fresh environments: lowest and newest dependencies, each Python found.

`python -m tests.environments [PYTHON ...]` says how each command ended, and ends with 1 if any
failed; `make environments` calls it. It needs the network and about ten minutes of one core for
each environment. `--only TEXT` takes the environments whose name contains it.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
UV = [sys.executable, "-m", "uv", "--quiet"]

#: A user's modules of the names that packages of the checkout have: nothing may import them.
USERS = ("generated", "derivation")

THERMAL = "--set forces.brownian=true --set optics.evaluator=map --set simulation.samples=2001"
DEPTH = "--set optics.evaluator=map --set simulation.model=full --set simulation.method=auto"
ROD = "--set bead.shape=spheroid --set 'bead.diameter=0.5 um' --set 'bead.length=1 um'"
#: After this command no other compiles anything for as long as a second.
WARMUP = "tweezer warmup"
#: What to do, in this order, in one folder
COMMANDS = (
    "tweezer --help",
    "tweezer run --help",
    "tweezer scenes",
    "tweezer new",
    "tweezer info",
    "tweezer map silica-1um",
    f"tweezer run silica-1um {ROD} --duration '1 ms' --out rod.nc",
    "tweezer rotation rod.nc --plot rotation.png",
    WARMUP,
    f"tweezer run silica-1um {THERMAL} --duration '100 ms' --seed 1 --out thermal.nc",
    "tweezer calibrate thermal.nc --plot calibration.png",
    f"tweezer ensemble silica-1um {THERMAL} --duration '1 ms' --trajectories 3 --out e.zarr",
    f"tweezer ensemble silica-1um {THERMAL} --duration '1 ms' --trajectories 3 --statistics",
    "tweezer trap silica-1um --plot trap.png --out trap.json",
    "tweezer trap mine.toml",
    "tweezer detect silica-1um --set detector.numerical_aperture=0.9",
    "tweezer optimise silica-1um --out best.npy",
    "tweezer sweep silica-1um --over bead.diameter=0.5um,1um --out s.zarr --plot s.png",
    "tweezer run thesis-990nm --plot thesis-990nm.png",
    "tweezer tune thesis-990nm --factor 0.1 --duration '1 ms' --plot tune.png",
    "python script.py",
    f"tweezer fit-depth track.csv --scene thesis-990nm {DEPTH} --plot depth.png",
    "tweezer reproduce 5.1 --out figures",
    # the folder of the user's own modules is not looked into first
    "python -P -m tweezer.derivation --check",
    "tweezer cache --clear --yes",
)

SCRIPT = """
import numpy as np
import tweezer

scene = tweezer.load_scene("thesis-990nm").replace(
    optics={"evaluator": "map"}, simulation={"model": "full", "method": "auto"}
)
falling = scene.replace(forces={"brownian": True}, simulation={"duration": "9 ms", "samples": 37})
run = tweezer.simulate(falling, seed=1)
seen = np.column_stack([run["time"], run["position"][:, :2]])
np.savetxt("track.csv", seen, delimiter=",", header="t (s),x (m),y (m)", comments="")
print(tweezer.optical_force(tweezer.load_scene("silica-1um"), [0, 0, 0]))
tweezer.load_run("thermal.nc")
"""


def pythons() -> list[str]:
    """The Python that runs this, and those of other versions on the path."""
    others = (minor for minor in range(11, 15) if minor != sys.version_info.minor)
    found = (shutil.which(f"python3.{minor}") for minor in others)
    return [sys.executable, *filter(None, found)]


def install(folder: Path, python: str, resolution: str, wheel: str) -> Path:
    """An environment with the wheel; returns the folder of its programs."""
    subprocess.run([*UV, "venv", "--no-python-downloads", "--python", python, folder], check=True)
    subprocess.run(
        [
            *UV, "pip", "install", "--python", folder / "bin" / "python",
            "--resolution", resolution, f"{wheel}[cluster,derive]",
        ],
        check=True,
    )  # fmt: skip
    return folder / "bin"


def failures(programs: Path, folder: Path) -> int:
    """How many commands fail in a folder, or compile after the warm-up; prints how each ended."""
    folder.mkdir()
    for name in USERS:
        (folder / f"{name}.py").write_text("raise RuntimeError('this is a module of the user')\n")
    (folder / "script.py").write_text(SCRIPT)
    environment = {
        **os.environ,
        "PATH": f"{programs}:{os.environ['PATH']}",
        "NUMBA_CACHE_DIR": str(folder / "compiled"),
        "XDG_CACHE_HOME": str(folder / "cache"),
    }
    environment.pop("PYTHONPATH", None)
    failed, warm = 0, False
    for command in COMMANDS:
        began = time.perf_counter()
        program, *arguments = shlex.split(command)
        done = subprocess.run(
            [programs / program, *arguments], cwd=folder, env=environment, capture_output=True,
            text=True, check=False,
        )  # fmt: skip
        compiled_late = warm and "compiling, once" in done.stderr
        warm |= command == WARMUP
        ended = f"ended with {done.returncode}" if done.returncode else "done"
        ended += ", but compiled after the warm-up" if compiled_late else ""
        print(f"    {time.perf_counter() - began:6.0f} s  {command}: {ended}", flush=True)
        if done.returncode or compiled_late:
            failed += 1
            print("\n".join(f"        {line}" for line in done.stderr.splitlines()[-4:]))
    return failed


def main() -> int:
    """Install and try; 1 if anything failed."""
    parser = argparse.ArgumentParser(prog="python -m tests.environments", description=__doc__)
    parser.add_argument("pythons", nargs="*", default=pythons())
    parser.add_argument("--only", default="")
    asked = parser.parse_args()
    kinds = [
        ("lowest", "lowest-direct", asked.pythons[0]),
        *(("newest", "highest", python) for python in asked.pythons),
    ]
    failed = 0
    with tempfile.TemporaryDirectory() as place:
        subprocess.run([*UV, "build", "--wheel", "--out-dir", place, ROOT], check=True)
        (wheel,) = Path(place).glob("*.whl")
        for number, (name, resolution, python) in enumerate(kinds):
            if asked.only not in f"{name} {python}":
                continue
            print(f"{name} dependencies, {python}", flush=True)
            programs = install(Path(place, f"environment-{number}"), python, resolution, str(wheel))
            failed += failures(programs, Path(place, f"user-{number}"))
    print(f"{failed} failures")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
