"""Scenes, command lines and recordings changed at random, for `tests.stress_faults`.

Each is read, or refused in one error of tweezer's own, within seconds, and no file is touched that
it does not name.
"""

from __future__ import annotations

import contextlib
import os
import signal
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import scipy.io
import typer.testing
import xarray as xr
from nptdms import ChannelObject, TdmsWriter

import tweezer
from tweezer import cli
from tweezer.scene import Scene
from tweezer.values.errors import TweezerError

#: s, after which a case hangs
PATIENCE = 60
#: what may stand in place of a value, in a scene or a command line
VALUES = (
    "0", "-1", "1e400", "nan", "-inf", "1e-320", "''", "true", "True", "[]", "[[[1]]]", "{}",
    "80 mW", "'80 mW'", '"20 C"', "'1 px'", "'500 nm'", "1 um 2", "2024-01-01", "[1, 2, 3]", "0x10",
    "'[bold]'", "[/x]", "µ", "\x00", "\udcff", "'''", "9" * 400, "x" * 5000, "a=b", "=", "--set",
    "\\frac{$", "None", "1_000", "linear", "table", "grid", "map", "euler-maruyama", "full", "auto",
)  # fmt: skip
#: settings that keep any run short; those given last count
SHORT = (
    "--set", "simulation.most_force_calls=2000", "--set", "simulation.samples=3",
    "--set", "optics.tolerance=1e-3", "--set", "optics.table_range=0.5",
    "--set", "optics.table_tolerance=1e-2", "--set", "beam.divisions=10",
)  # fmt: skip
#: command lines to begin from
LINES = (
    ("scenes",),
    ("run", "silica-1um", "--duration", "10 us", "--out", "r.nc", "--plot", "r.png", *SHORT),
    ("run", "mine.toml", "--duration", "1 us", "--seed", "3", "--set", "forces.brownian=true",
     "--method", "heun", "--out", "b.nc", "--plot", "b.svg", *SHORT),
    ("trap", "silica-1um", "--out", "t.json", "--overwrite", "--plot", "t.png",
     "--set", "forces.optical=false"),
    ("map", "thesis-990nm", *SHORT),
    ("tune", "thesis-990nm", "--factor", "0.5", "--duration", "1 us", "--deviation", "1 nm",
     *SHORT),
    ("calibrate", "mine.csv", "--temperature", "20 degC", "--radius", "500 nm",
     "--viscosity", "1 mPa s", "--skip", "1 ms", "--out", "k.json", "--overwrite"),
    ("calibrate", "mine.csv", "--temperature", "20 degC", "--radius", "500 nm",
     "--viscosity", "1 mPa s", "--density", "2000 kg/m^3", "--fluid-density", "998 kg/m^3",
     "--blur", "1 us", "--diode", "14 kHz, 0.3", "--noise", "1 nm", "--wall", "1.2 um +- 50 nm",
     "--out", "k.json", "--overwrite"),
    ("calibrate", "mine.csv", "mine.csv", "--temperature", "20 degC", "--radius", "500 nm",
     "--viscosity", "1 mPa s", "--focus", "0 um, 1 um", "--focal-shift", "0.8",
     "--out", "k.json", "--overwrite"),
    ("fit-depth", "short.csv", "--scene", "thesis-990nm", "--noise", "15 nm", "--fit", "power",
     "--search", "-8 um", "2 um", "--set", "optics.evaluator=quadrature"),
    ("ensemble", "silica-1um", "--trajectories", "2", "--duration", "1 us", "--out", "e.zarr",
     "--set", "forces.brownian=true", *SHORT),
)  # fmt: skip


class HangError(Exception):
    """A case took too long."""


@contextlib.contextmanager
def alarm() -> Iterator[None]:
    """Raise `HangError` after `PATIENCE`."""

    def ring(*_: object) -> None:
        raise HangError

    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(PATIENCE)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def pick(rng: np.random.Generator, among: tuple | list) -> object:
    return among[rng.integers(len(among))]


def changed_bytes(rng: np.random.Generator, content: bytes) -> bytes:
    """`content` with a few bytes other, or missing, or cut short."""
    changed = bytearray(content or b" ")
    kind = rng.integers(4)
    if kind == 0:
        return bytes(changed[: rng.integers(len(changed))])
    for _ in range(min(int(rng.integers(1, 8)), len(changed) // 30 + 1)):
        at = int(rng.integers(len(changed)))
        if kind == 1:
            changed[at] ^= 1 << int(rng.integers(8))
        elif kind == 2:
            changed[at] = int(rng.choice([0, 8, 34, 44, 255, rng.integers(256)]))
        else:
            del changed[at : at + int(rng.integers(1, 30))]
    return bytes(changed)


def changed_text(rng: np.random.Generator, lines: list[str]) -> list[str]:
    """`lines` of TOML with one or two changed."""
    lines = list(lines)
    for _ in range(rng.integers(1, 3)):
        at = int(rng.integers(len(lines)))
        key, _, value = lines[at].partition("=")
        lines[at] = str(pick(rng, [
            f"{key}= {pick(rng, VALUES)}", f"{key[:-2]} = {value}", f"{key}{value}", "",
            f"{lines[at]}\n{lines[at]}", f"[{pick(rng, VALUES)}]", f"{key}.x = {value}",
            f"{key}= {'[' * 3000}", f"{'a.' * 3000}b = 1", f"x = {'{a=' * 300}1{'}' * 300}",
        ]))  # fmt: skip
    return lines


def counted(
    count: int, first: int, seed: int, case: Callable[[np.random.Generator], str]
) -> Counter[str]:
    """Return the outcomes of `count` cases, beginning with number `first`, in separate folders.

    Raises an exception for a forbidden outcome.
    """
    outcomes: Counter[str] = Counter()
    home = Path.cwd()
    for number in range(first, first + count):
        rng = np.random.default_rng([seed, number])
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            os.chdir(folder)
            try:
                with alarm():
                    outcomes[case(rng)] += 1
            except TweezerError as error:
                if not str(error).strip():
                    raise AssertionError(f"case {number} of {seed}: an empty line") from error
                outcomes["refused"] += 1
            except Exception as error:
                raise AssertionError(f"case {number} of seed {seed}") from error
            finally:
                os.chdir(home)
    return outcomes


def mutated_scenes(count: int, first: int = 0) -> Counter[str]:
    """Files of shipped scenes: lines and bytes changed."""
    texts = [path.read_text(encoding="utf-8") for path in tweezer.shipped_scenes().values()]

    def case(rng: np.random.Generator) -> str:
        text = str(pick(rng, texts))
        content = "\n".join(changed_text(rng, text.splitlines())).encode(errors="surrogateescape")
        if rng.random() < 0.3:
            content = changed_bytes(rng, content)
        Path("mine.toml").write_bytes(content)
        scene = tweezer.load_scene("mine.toml")
        if Scene.model_validate_json(scene.model_dump_json(exclude_none=True)) != scene:
            raise AssertionError("JSON does not keep the scene")
        return "read" if len(repr(scene)) < 800 else "read, but shown at length"

    return counted(count, first, 1, case)


def mutated_command_lines(count: int, first: int = 0) -> Counter[str]:
    """Commands on short scenes: words changed, left out, doubled, and added."""
    options = [word for line in LINES for word in line if word.startswith("--")]
    scene = tweezer.shipped_scenes()["silica-1um"].read_bytes()
    runner = typer.testing.CliRunner()

    def files() -> None:
        Path("mine.toml").write_bytes(scene)
        _write_table("mine.csv", 400)
        _write_table("short.csv", 5)  # a fit of a longer one takes half a minute
        Path("precious.nc").write_text("not a run")
        Path("precious").mkdir()
        Path("precious/notes.txt").write_text("years of work")

    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.chdir(folder),
        warnings.catch_warnings(action="ignore"),
    ):
        files()
        for line in LINES:  # what they need is compiled before they are timed
            runner.invoke(cli.app, line)

    def case(rng: np.random.Generator) -> str:
        line = [str(word) for word in pick(rng, LINES)]
        end = len(line) - len(SHORT) if line[-len(SHORT) :] == list(SHORT) else len(line)
        for _ in range(rng.integers(0, 4)):
            at = int(rng.integers(end))
            if (kind := rng.integers(4)) == 0:
                line[at] = str(pick(rng, VALUES))
            elif kind == 1:
                line[at] = changed_bytes(rng, line[at].encode(errors="replace") + b"?").decode(
                    errors="replace"
                )
            elif kind == 2 and end > 1:
                del line[at]
                end -= 1
            else:
                line[at:at] = [str(pick(rng, options)), str(pick(rng, VALUES))]
                end += 2
        files()
        before = _contents()
        ended = runner.invoke(cli.app, [word.replace("\x00", "") for word in line])
        error = ended.exception
        if isinstance(error, HangError):
            raise AssertionError(f"hangs: {line}") from error
        if error is not None and not isinstance(error, TweezerError | SystemExit):
            traceback.print_exception(error)
            raise AssertionError(f"ends in a traceback: {line}") from error
        after = _contents()
        for name, content in before.items():
            if after.get(name) != content and not any(name in word for word in line):
                raise AssertionError(f"{name} has changed: {line}")
        if left := [name for name in after if ".saving" in name or name.endswith(".part")]:
            raise AssertionError(f"{left} are left: {line}")
        return "refused" if isinstance(error, TweezerError) else f"exit code {ended.exit_code}"

    return counted(count, first, 2, case)


def _contents() -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in Path().rglob("*") if path.is_file()}


def _write_table(name: str, rows: int) -> None:
    i = np.arange(rows)
    table = np.column_stack([i, np.sin(i * i) * 20, np.cos(i * i) * 20])
    np.savetxt(name, table, "%.6g", ",", header="t [ms],x [nm],y (nm)", comments="")


def mutated_recordings(count: int, first: int = 0) -> Counter[str]:
    """CSV, HDF5, NetCDF, NumPy's, MATLAB's, TDMS: headings, lines and bytes changed, and cut.

    The options that say how a file is read are drawn too.
    """
    scene = tweezer.load_scene("silica-1um").replace(forces={"brownian": True})

    def case(rng: np.random.Generator) -> str:
        _write_table("mine.csv", 150)
        sound = tweezer.load_recording("mine.csv")
        name = str(pick(rng, ("mine.csv", "mine.h5", "mine.nc", *_ARRAYS)))
        if name == "mine.h5":
            with h5py.File(name, "w") as file:
                file["time_s"], file["x"] = sound.times, sound.positions[:, 0]
                file["y"] = sound.positions[:, 1]
                file["y"].attrs["units"] = "m"
        elif name == "mine.nc":
            tweezer.save_run(_run(scene, sound), name)
        elif name in _ARRAYS:
            x, y = sound.positions.T
            _ARRAYS[name](name, {"t": sound.times, "x": x, "y": y})
        content = Path(name).read_bytes()
        if name == "mine.csv" and rng.random() < 0.5:
            lines = content.decode().splitlines()
            at = int(rng.choice([0, rng.integers(len(lines))]))
            cells = lines[at].split(",")
            cells[rng.integers(len(cells))] = str(pick(rng, (*VALUES, '"', "t", "x", "x (", "0,5")))
            lines[at] = str(pick(rng, (",", ";", "\t", ", "))).join(cells)
            changed = "\n".join(lines).encode(errors="surrogateescape")
        else:
            changed = changed_bytes(rng, content)
        Path(name).write_bytes(changed)
        said = {}
        if rng.random() < 0.5:
            options = ("columns", ("t,x", "t=t,x=x", "x=1", *VALUES)), ("rate", ("15 Hz", *VALUES))
            for option, values in (*options, ("scale", ("80 nm", "2 px/um", "1 um/V", *VALUES))):
                if rng.random() < 0.4:
                    said[option] = str(pick(rng, values))
        read = pick(rng, (tweezer.load_recording, tweezer.load_track))(name, **said)
        as_it_was = len(read.times) == len(sound.times) and np.allclose(
            read.positions[:, :2], sound.positions, atol=0, rtol=1e-9, equal_nan=True
        )
        if name == "mine.nc" and not as_it_was:
            raise AssertionError("a saved run that is damaged is read otherwise")
        return f"{name[-4:]}: read {'as it was' if as_it_was else 'otherwise'}"

    return counted(count, first, 3, case)


def _write_tdms(name: str, columns: dict[str, np.ndarray]) -> None:
    with TdmsWriter(name) as file:
        file.write_segment([ChannelObject("Data", *column) for column in columns.items()])


#: Files of arrays, and what writes them
_ARRAYS = {
    "mine.npz": lambda name, columns: np.savez(name, **columns),
    "mine.npy": lambda name, columns: np.save(
        name, np.rec.fromarrays(list(columns.values()), names=list(columns))
    ),
    "mine.mat": scipy.io.savemat,
    "mine.tdms": _write_tdms,
}


def _run(scene: Scene, recording: tweezer.Recording) -> xr.Dataset:
    positions = np.pad(recording.positions, ((0, 0), (0, 1)))
    positions[:, 2] = positions[:, 0]
    return xr.Dataset(
        {"position": (("time", "axis"), positions, {"units": "m"})},
        coords={"time": recording.times, "axis": ["x", "y", "z"]},
        attrs={"title": "a run", "scene": scene.model_dump_json(exclude_none=True),
               "status": "complete"},
    )  # fmt: skip
