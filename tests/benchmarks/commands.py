"""Commands: what each costs in empty caches, and again.

Each command runs in an empty folder with caches of its own: once with nothing in them (cold), then
again (warm). Processor time is that of the command and the processes that it
started. What a command reads is made before, with other caches. Then one user's commands run in
their order with one cache, which is what a first hour is like; and tweezer is installed from
nothing, which is told apart.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from tests.benchmarks.timing import ROOT, machine

Results = dict[str, Any]

#: times that a warm command runs
WARM = 1


class Command(NamedTuple):
    """A command, and what it is given."""

    arguments: tuple[str, ...]
    reads: tuple[str, ...] = ()
    """files that `INPUTS` make"""

    @property
    def told(self) -> str:
        return " ".join(("tweezer", *self.arguments))


#: each file that a command reads, and the arguments that make it
INPUTS: dict[str, tuple[str, ...]] = {
    "run.nc": ("run", "silica-1um", "--out", "run.nc"),
    "other.nc": (
        "run", "silica-1um", "--set", "simulation.relative_tolerance=1e-8", "--out", "other.nc",
    ),
    "record.nc": (
        "run", "silica-1um", "--set", "forces.brownian=true", "--set", "simulation.samples=50001",
        "--duration", "1 s", "--seed", "1", "--out", "record.nc",
    ),
    "rod.nc": ("run", "flipping-rod", "--out", "rod.nc"),
    "track.nc": (
        "run", "silica-1um", "--set", "forces.brownian=true", "--set",
        "beam.power_through_pupil=30 mW", "--set", "simulation.samples=11", "--set",
        "camera.rate=2500 Hz", "--set", "camera.exposure=0.4 ms", "--duration", "0.4 s",
        "--out", "track.nc",
    ),
    "falling.nc": (
        "run", "thesis-990nm", "--model", "full", "--method", "auto", "--set",
        "optics.evaluator=map", "--set", "forces.brownian=true", "--set", "camera.rate=4 kHz",
        "--set", "camera.noise=15 nm", "--duration", "9 ms", "--seed", "1", "--out", "falling.nc",
    ),
}  # fmt: skip

_THERMAL = ("--set", "forces.brownian=true")
COMMANDS = (
    Command(("--help",)),
    Command(("scenes",)),
    Command(("info",)),
    Command(("new", "mine.toml")),
    Command(("run", "thesis-990nm")),
    Command(("run", "silica-1um")),
    Command(("run", "silica-1um", *_THERMAL, "--duration", "20 ms")),
    Command(("view", "silica-1um", "--out", "page.html")),
    Command(("view", "run.nc", "--out", "page.html"), ("run.nc",)),
    Command(("compare", "run.nc", "other.nc"), ("run.nc", "other.nc")),
    Command(("trap", "silica-1um", "--plot", "trap.png")),
    Command(("map", "silica-1um")),
    Command(
        ("ensemble", "silica-1um", *_THERMAL, "--trajectories", "100", "--duration", "4 ms",
         "--statistics")
    ),
    Command(
        ("sweep", "silica-1um", "--over", "bead.diameter=0.5um..2um:4", "--over",
         "beam.power_through_pupil=10mW..100mW:4:log", "--out", "diagram.zarr")
    ),
    Command(("calibrate", "record.nc", "--skip", "20 ms"), ("record.nc",)),
    Command(
        ("fit", "track.nc", "--scene", "silica-1um", "--free", "beam.power_through_pupil",
         "--skip", "20 ms"),
        ("track.nc",),
    ),
    Command(
        ("fit-depth", "falling.nc", "--scene", "thesis-990nm", "--set", "optics.evaluator=map",
         "--set", "simulation.model=full", "--set", "simulation.method=auto"),
        ("falling.nc",),
    ),
    Command(("rotation", "rod.nc"), ("rod.nc",)),
    Command(("tune", "thesis-990nm")),
    Command(("reproduce", "5.1")),
    Command(("cache",)),
    Command(("warmup",)),
)  # fmt: skip
#: in one cache
ORDER = tuple(
    command
    for command in COMMANDS
    if command.arguments[0] in ("view", "run", "trap", "ensemble", "calibrate", "sweep")
)
QUICK = COMMANDS[:1]
#: what is seen first: today's, and the picture it is held against
FIRST_PAGE, FIRST_RUN = COMMANDS[7], COMMANDS[4]


class Cost(NamedTuple):
    """What a command took, s."""

    processor: float
    wall: float


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    commands, order = (QUICK, QUICK) if quick else (COMMANDS, ORDER)
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        made = _inputs(Path(folder), {name for each in commands for name in each.reads}, say)
        alone = [_cold_and_warm(Path(folder), command, made, say) for command in commands]
        say("one after the other")
        together = _in_order(Path(folder), order, made)
    return {
        "machine": machine(), "quick": quick, "load_before": load, "commands": alone,
        "in_order": together, "install": None if quick else _installed(say),
    }  # fmt: skip


def _inputs(folder: Path, names: Iterable[str], say: Callable[[str], object]) -> Path:
    made = folder / "made"
    made.mkdir()
    for name in sorted(names):
        say(f"making {name}")
        _cost(INPUTS[name], made, _caches(folder / "caches of inputs"))
    return made


def _cold_and_warm(
    folder: Path, command: Command, made: Path, say: Callable[[str], object]
) -> Results:
    say(command.told)
    with tempfile.TemporaryDirectory(dir=folder) as empty:
        caches = Path(empty)
        cold, *warm = (_fresh(folder, command, made, _caches(caches)) for _ in range(1 + WARM))
        kept = _kept(caches)
    return {
        "command": command.told, "cold_cpu_s": cold.processor, "cold_wall_s": cold.wall,
        "warm_cpu_s": min(each.processor for each in warm),
        "warm_wall_s": min(each.wall for each in warm), "functions_kept": kept,
    }  # fmt: skip


def _in_order(folder: Path, commands: Sequence[Command], made: Path) -> list[Results]:
    caches, told, before = folder / "one cache", [], 0
    for command in commands:
        cost = _fresh(folder, command, made, _caches(caches))
        kept = _kept(caches)
        told.append(
            {
                "command": command.told, "cpu_s": cost.processor, "wall_s": cost.wall,
                "functions_added": kept - before,
            }
        )  # fmt: skip
        before = kept
    return told


def _installed(say: Callable[[str], object]) -> Results:
    """Time of the environment and of pip, of a copy of the sources, s."""
    say("installing")
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        pip = [f"{folder}/bin/python", "-m", "pip", "install", "--quiet", str(ROOT)]
        subprocess.run(pip, check=True, capture_output=True)
        return {"wall_s": time.perf_counter() - began}


def _caches(folder: Path) -> dict[str, str]:
    """An environment whose caches lie in that folder."""
    return {
        **os.environ, "NUMBA_CACHE_DIR": str(folder / "compiled"),
        "XDG_CACHE_HOME": str(folder / "kept"),
    }  # fmt: skip


def _kept(caches: Path) -> int:
    """Number of compiled functions that are kept there."""
    return sum(1 for _ in caches.rglob("*.nbc"))


def _fresh(folder: Path, command: Command, made: Path, environment: Mapping[str, str]) -> Cost:
    """What a command takes in a folder that holds what it reads and nothing else."""
    with tempfile.TemporaryDirectory(dir=folder) as empty:
        for name in command.reads:
            shutil.copy(made / name, empty)
        return _cost(command.arguments, Path(empty), environment)


def _cost(arguments: Sequence[str], folder: Path, environment: Mapping[str, str]) -> Cost:
    began = time.perf_counter()
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen(
            [sys.executable, "-m", "tweezer", *arguments], cwd=folder, env=dict(environment),
            stdin=subprocess.DEVNULL, stdout=said, stderr=said,
        )  # fmt: skip
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        wall = time.perf_counter() - began
        if child.returncode:
            said.seek(0)
            raise RuntimeError(f"tweezer {' '.join(arguments)}: {said.read().decode()}")
    return Cost(used.ru_utime + used.ru_stime, wall)
