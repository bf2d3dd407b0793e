"""Files, folders, links and pipes of a user's, of the names that an output has beside it.

`tests.stress_faults` makes many. Whatever is written, or refused: they are as they were, and so is
what links lead to.
"""

from __future__ import annotations

import os
import shutil
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import tweezer
from tests.damaged_results import sound
from tests.mutations import counted, pick
from tests.write_faults import KINDS
from tweezer.results.io import write_json

#: Outputs of one file
FILES: dict[str, Callable[[Path], Any]] = {
    "run.nc": lambda out: tweezer.save_run(tweezer.load_run(sound() / "run.nc"), out),
    "page.html": lambda out: tweezer.view(sound() / "run.nc").save(out),
    "trap.json": lambda out: write_json({"a": 1}, out),
}
#: Names within OUT.part
WITHIN = ("journal.jsonl", "new", "new-0123456789abcdef", "0.npz", "total.npz", "notes.txt",
          "of-a-sweep", "of-an-ensemble", "0.run")  # fmt: skip


def _file(path: Path) -> None:
    path.write_text("precious")


def _folder(path: Path) -> None:
    path.mkdir()
    (path / "thesis.tex").write_text("precious")


def _second_name(path: Path) -> None:
    os.link("victim/thesis.tex", path)


THINGS: tuple[Callable[[Path], None], ...] = (
    _file,
    _folder,
    _second_name,
    lambda path: path.symlink_to(Path("victim/thesis.tex").absolute()),
    lambda path: path.symlink_to(Path("victim").absolute()),
    lambda path: path.symlink_to("nowhere"),
    os.mkfifo,
)


def _state(folder: Path) -> dict[str, Any]:
    """Return the contents of a folder: of its files, the targets of links, and all other items."""
    found: dict[str, Any] = {}
    for path in folder.rglob("*"):
        if path.is_symlink():
            found[str(path)] = f"link to {path.readlink()}"
        elif path.is_file():
            found[str(path)] = path.read_bytes()
        else:
            found[str(path)] = "folder" if path.is_dir() else "pipe"
    return found


def foreign_files(count: int, first: int = 0) -> Counter[str]:
    """Write, or resume, an output with foreign files beside it."""
    sound()

    def case(rng: np.random.Generator) -> str:
        _folder(Path("victim"))
        name = str(pick(rng, [*KINDS, *FILES]))
        out, stores = Path(name).absolute(), name in KINDS
        begun = stores and rng.random() < 0.4
        if begun:
            _interrupted(out)
        part = Path(f"{out}.part")
        mine = set()
        for _ in range(int(rng.integers(1, 3))):
            places = [Path(f"{out}.lock"), part, out, Path(".saving-0123456789abcdef").absolute()]
            places += [part / each for each in WITHIN]
            path, make = places[rng.integers(len(places))], THINGS[rng.integers(len(THINGS))]
            if path.parent == part and not os.path.lexists(part):
                part.mkdir()
            if os.path.lexists(path) or (path.parent == part and not part.is_dir()):
                continue
            # what replaces a file, as its functions say; and own names in the folder with a marker
            own = begun and path.parent == part and path.name not in ("new", "notes.txt")
            if (path == out and not stores and make in (_file, _second_name)) or own:
                continue
            make(path)
            mine.add(str(path))
        before = {
            path: it
            for path, it in _state(Path.cwd()).items()
            if any(path.startswith(each) for each in [*mine, str(Path("victim").absolute())])
        }
        resume = bool(rng.random() < 0.5)
        try:
            if stores:
                KINDS[name](out, [], resume=resume)
            else:
                FILES[name](out)
            ended = "written"
        except tweezer.TweezerError as error:
            if "\n" in str(error):
                raise AssertionError(f"{name}: told as {error}") from error
            ended = "refused"
        after = _state(Path.cwd())
        for path, it in before.items():
            if after.get(path) != it:
                raise AssertionError(f"{name}, resume={resume}, begun={begun}: {path} is not kept")
        return f"{name}: {ended}"

    return counted(count, first, 14, case)


def _interrupted(out: Path) -> None:
    """Begin an output, and be interrupted."""

    class StopError(Exception):
        """Ends the work."""

    def stop(_: float) -> None:
        raise StopError

    scene = tweezer.load_scene("silica-1um")
    try:
        if out.name == "sweep.zarr":
            over = {"bead.diameter": [0.5e-6, 0.75e-6, 1e-6]}
            tweezer.sweep(scene, over, out=out, workers=1, progress=stop)
        else:
            from tests.write_faults import _THERMAL

            tweezer.ensemble(
                _THERMAL, 70, out=out, statistics=out.suffix == ".nc", workers=1, progress=stop
            )
    except StopError:
        shutil.rmtree(out, ignore_errors=True)
