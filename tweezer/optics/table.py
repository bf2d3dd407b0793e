"""The force from a table with a certified error, kept in the user's cache folder."""

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
from tweezer.optics import charts, kernels, quadrature, tabulate
from tweezer.optics.light import Light
from tweezer.optics.tabulate import Made

if TYPE_CHECKING:
    from filelock import FileLock

    from tweezer.scene import Optics

_log = logging.getLogger("tweezer")

#: Time after which a user reads that a table of another process is waited for, s
_PATIENCE = 1.0
#: Longest time that a table of another process is waited for, s
_LONGEST_WAIT = 600.0
#: how many tables stay in memory
_MOST_IN_MEMORY = 16

#: what a stored table depends on besides the light: the sources that it was computed by, read at
#: once, for a file may change under a running program
_SOURCES = "".join(
    Path(__file__).with_name(name).read_text(encoding="utf-8")
    for name in ("table.py", "light.py", "by_quadrature.py")
) + "".join(
    inspect.getsource(module)
    for module in (ray, quadrature, kernels, charts, tabulate, data, force)
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
    """its file; None if it could not be written"""

    @property
    def certified_error(self) -> float:
        """N, of the force, anywhere in range: see `tabulate.build`."""
        return self.made.certified * self.strength

    @property
    def largest_force(self) -> float:
        """N, within the range."""
        return self.made.largest * self.strength

    @property
    def range(self) -> float:
        """m, distance from the focus up to which it holds."""
        return self.made.reach * self.radius

    @property
    def pieces(self) -> int:
        """How many pieces it has."""
        return len(self.made.pieces)

    @property
    def build_time(self) -> float:
        """s, that it took to make."""
        return self.made.seconds


def stored(light: Light, optics: Optics, make: Callable[[], Made]) -> tuple[Made, Path | None]:
    """The table of `light`, given in radii and n_m P/c, and its file.

    It is the one in memory, or in the user's cache folder, or what `make` gives. Warns as
    `tweezer.optics.force_map`.
    """
    key = _key(light, optics)
    if key in _in_memory:
        return _in_memory[key]
    made, path = _kept(key, make)
    reached = made.certified / made.largest
    if reached > optics.table_tolerance:
        warn(
            f"the table errs by up to {reached:.2g} of the largest force: it did not reach "
            f"optics.table_tolerance = {optics.table_tolerance:g}",
        )
    if len(_in_memory) == _MOST_IN_MEMORY:
        del _in_memory[next(iter(_in_memory))]
    _in_memory[key] = made, path
    return made, path


def _key(light: Light, optics: Optics) -> str:
    """Of all that a table depends on. Rounding of the beam's power does not change it."""
    said = (
        light.cone.half_angle, light.index_ratio, light.polarisation, light.torque,
        optics.table_tolerance, optics.table_range,
    )  # fmt: skip
    shape = np.round(light.cone.series / np.abs(light.cone.series).max(), 13) + 0.0  # no -0
    return hashlib.sha256(f"{_SOURCES}{said}{shape.tolist()}".encode()).hexdigest()


def _kept(key: str, make: Callable[[], Made]) -> tuple[Made, Path | None]:
    """The table in the cache folder, and its file: made if there is none, or a damaged one."""
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
        if (made := _load(path, key)) is not None:  # by a process that held the lock
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
    """Acquire the lock of a table, which keeps processes from making the same one at once.

    A process that goes without it does no harm: a table's file is replaced as a whole.
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
    """A table as it was saved; None if there is none, or not all of it."""
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
