"""Tables of the force with a certified error, stored in the user's cache folder."""

from __future__ import annotations

import dataclasses
import hashlib
import inspect
import io
import logging
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.errors import ResultError, warn
from tweezer.forces import data, force
from tweezer.generated import ray
from tweezer.optics import charts, tabulate
from tweezer.optics.light import Light
from tweezer.optics.rays import nodes, panels, quadrature, ray_sum, rule
from tweezer.optics.tabulate import Made

if TYPE_CHECKING:
    from filelock import FileLock

    from tweezer.scene import Scene

_log = logging.getLogger("tweezer")

#: Wait for the table of another process before a message is shown, s
_PATIENCE = 1.0
#: Longest wait for the table of another process, s
_LONGEST_WAIT = 600.0
#: Largest number of tables in memory
_MOST_IN_MEMORY = 16

#: Sources of the code that computes a table: part of its key. Read on import, as a file may change
#: while the program runs
_SOURCES = "".join(
    Path(__file__).with_name(name).read_text(encoding="utf-8")
    for name in ("table.py", "light.py", "by_quadrature.py", "by_map.py")
) + "".join(
    inspect.getsource(module)
    for module in (ray, rule, panels, nodes, ray_sum, quadrature, charts, tabulate, data, force)
)

_in_memory: dict[str, tuple[Made, Path | None]] = {}


@dataclass(frozen=True)
class Table:
    """The table of one scene."""

    made: Made
    radius: float
    """m, of the bead"""
    strength: float
    """n_m P/c of all rays, N"""
    path: Path | None
    """file of the table; None if it could not be written"""

    @property
    def certified_error(self) -> float:
        """Bound on the error of the force within the range, N: see `tabulate.build`."""
        return self.made.certified * self.strength

    @property
    def largest_force(self) -> float:
        """Largest force within the range, N."""
        return self.made.largest * self.strength

    @property
    def range(self) -> float:
        """Largest distance from the focus, m."""
        return self.made.reach * self.radius

    @property
    def pieces(self) -> int:
        """Number of pieces."""
        return len(self.made.pieces)

    @property
    def build_time(self) -> float:
        """Time of the computation, s."""
        return self.made.seconds


def stored(light: Light, scene: Scene, make: Callable[[], Made]) -> tuple[Made, Path | None]:
    """The table of `light`, given in radii and n_m P/c, and its file.

    From memory, from the user's cache folder, or else by `make`. Warns as
    `tweezer.optics.force_map`.
    """
    key = _key(light, scene)
    if key in _in_memory:
        return _in_memory[key]
    made, path = _kept(key, make)
    reached = made.certified / made.largest
    if reached > (tolerance := scene.optics.table_tolerance):
        warn(
            f"the table errs by up to {reached:.2g} of the largest force: it did not reach "
            f"optics.table_tolerance = {tolerance:g}",
        )
    if len(_in_memory) == _MOST_IN_MEMORY:
        del _in_memory[next(iter(_in_memory))]
    _in_memory[key] = made, path
    return made, path


def _key(light: Light, scene: Scene) -> str:
    """Digest of everything that a table depends on. Rounding in the power does not change it."""
    said = (
        light.cone.half_angle, light.index_ratio, light.polarisation, light.torque,
        scene.optics.table_tolerance, scene.table_radii,
    )  # fmt: skip
    shape = np.round(light.cone.series / np.abs(light.cone.series).max(), 13) + 0.0  # no -0
    return hashlib.sha256(f"{_SOURCES}{said}{shape.tolist()}".encode()).hexdigest()


def _kept(key: str, make: Callable[[], Made]) -> tuple[Made, Path | None]:
    """The table in the cache folder, and its file; computed if it is missing or damaged."""
    from platformdirs import user_cache_path

    path = user_cache_path("tweezer") / "tables" / f"{key}.table"
    if (made := _load(path, key)) is not None:
        return made, path
    from filelock import FileLock

    lock = FileLock(path.with_suffix(".lock"))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _wait_for(lock)
    except (OSError, NotImplementedError) as error:
        warn(f"{path}: the table is not kept: {error}", UserWarning)
        return make(), None
    try:
        if (made := _load(path, key)) is not None:  # written by the process that held the lock
            return made, path
        if path.exists():
            warn(f"{path}: damaged; the table is made again", UserWarning)
        made = make()
        try:
            _save(path, key, made)
        except ResultError as error:
            warn(f"{path}: the table is not kept: {error}", UserWarning)
            return made, None
        return made, path
    finally:
        Path(lock.lock_file).unlink(missing_ok=True)
        lock.release()


def _wait_for(lock: FileLock) -> None:
    """Acquire the lock of a table, so that two processes do not compute the same one.

    The lock only saves work: a table's file is always replaced as a whole.
    """
    try:
        lock.acquire(timeout=_PATIENCE)
    except TimeoutError:
        _log.warning(
            "waiting up to %g s for another process that makes this table: %s", _LONGEST_WAIT,
            lock.lock_file,
        )  # fmt: skip
        lock.acquire(timeout=_LONGEST_WAIT)


def _save(path: Path, key: str, made: Made) -> None:
    """Write a table: a digest of its key and content, and an npz archive."""
    from tweezer.io import replacing

    buffer = io.BytesIO()
    np.savez(buffer, **{f.name: getattr(made, f.name) for f in dataclasses.fields(made)})
    content = buffer.getvalue()
    with replacing(path) as whole:
        whole.write(hashlib.sha256(key.encode() + content).digest() + content)


def _load(path: Path, key: str) -> Made | None:
    """A saved table; None if the file is missing or damaged."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    digest, content = content[:32], content[32:]
    if hashlib.sha256(key.encode() + content).digest() != digest:
        return None
    with np.load(io.BytesIO(content)) as archive:
        fields: dict[str, Any] = {name: archive[name][()] for name in archive.files}
    return Made(**fields)
