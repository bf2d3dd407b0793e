"""Tables of the force with a certified error, stored in the user's cache folder."""

from __future__ import annotations

import dataclasses
import hashlib
import importlib.util
import io
import logging
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

from tweezer.forces.data import Data, Part
from tweezer.forces.force import Kernel, Wrench
from tweezer.optics.beam import Cone
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError, warn

if TYPE_CHECKING:
    from filelock import FileLock

Progress = Callable[[float], None]
AnyMade = TypeVar("AnyMade", bound="Made")
AnyKept = TypeVar("AnyKept")

_log = logging.getLogger("tweezer")

#: Wait for the table of another process before a message is shown, s
_PATIENCE = 1.0
#: Longest wait for the table of another process, s
_LONGEST_WAIT = 600.0
#: Largest number of tables in memory
_MOST_IN_MEMORY = 16

_in_memory: dict[str, tuple[Any, Path | None]] = {}


class Evaluate(Protocol):
    """Type of the function that a table interpolates: `LightForce.field`, in the table's units."""

    def __call__(self, positions: Array) -> Wrench:
        """Return force, torque and estimated error at positions (n, 3)."""


class Made(Protocol):
    """Type of a table as computed and stored, a dataclass.

    Lengths are in a unit of the theory, forces in n_m P/c (refractive index, power, speed of
    light).
    """

    @property
    def certified(self) -> float:
        """Bound on the error of the force within the range, in n_m P/c."""

    @property
    def largest(self) -> float:
        """Largest force found within the range, in n_m P/c."""

    @property
    def reach(self) -> float:
        """Range of the table: largest distance from the focus, in the unit of its lengths."""

    @property
    def seconds(self) -> float:
        """Time that the computation of the table took, s."""

    @property
    def count(self) -> int:
        """Number of pieces of the table, each with its own polynomials."""

    def kernel(self, *, gradient: bool) -> Kernel:
        """Return the kernel that reads this table, and adds gradients if `gradient`."""

    def data(self, unit: float, strength: float, beyond: Part) -> Data:
        """Return the data of the kernel.

        `unit` is the table's unit of length (m), `strength` is n_m P/c (N), and `beyond` is the
        force out of range.
        """


@dataclass(frozen=True)
class Table:
    """A force table with the units of one scene, as `tweezer.optics.force_map` returns it."""

    made: Made
    """the table in its own units"""
    unit: float
    """unit of its lengths, m"""
    strength: float
    """n_m P/c of all the light (refractive index, power, speed of light), N: unit of its forces"""
    path: Path | None
    """file of the table; None if it could not be written"""

    @property
    def certified_error(self) -> float:
        """Bound on the error of the force within the range, N."""
        return self.made.certified * self.strength

    @property
    def largest_force(self) -> float:
        """Largest force within the range, N."""
        return self.made.largest * self.strength

    @property
    def range(self) -> float:
        """Largest distance from the focus at which the table is read, m."""
        return self.made.reach * self.unit

    @property
    def pieces(self) -> int:
        """Number of pieces of the table, each with its own polynomials."""
        return self.made.count

    @property
    def build_time(self) -> float:
        """Time that the computation of the table took, s."""
        return self.made.seconds


def processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def stored(
    key: str, tolerance: float, kind: type[AnyMade], make: Callable[[], AnyMade]
) -> tuple[AnyMade, Path | None]:
    """Return the table of a key, and its file; None if it could not be written.

    The table is taken from memory or from the user's cache folder, or else computed.

    Parameters
    ----------
    key : str
        Key of the table.
    tolerance : float
        Wanted error, as a fraction of the largest force. A larger error gives a warning.
    kind : type
        Class of the tables that `make` returns.
    make : callable
        Function that computes the table.
    """
    if key in _in_memory:
        return _in_memory[key]
    made, path = kept(key, kind, make)
    reached = made.certified / made.largest if made.largest else 0.0
    if reached > tolerance:
        warn(
            f"the table errs by up to {reached:.2g} of the largest force: it did not reach "
            f"optics.table_tolerance = {tolerance:g}",
        )
    if len(_in_memory) == _MOST_IN_MEMORY:
        del _in_memory[next(iter(_in_memory))]
    _in_memory[key] = made, path
    return made, path


def sources(*modules: str) -> str:
    """Return the text of the code that computes a table, which is a part of the table's key.

    `modules` are names within tweezer, in addition to those that all tables use. The text is read
    on import, because a file may change while the program runs.
    """
    own = ("beam", "beyond", "light", "mapped", "table", "turning")
    names = (*modules, "forces.data", "forces.force", *(f"optics.{name}" for name in own))
    found = (importlib.util.find_spec(f"tweezer.{name}") for name in names)
    return "".join(
        Path(each.origin).read_text(encoding="utf-8") for each in found if each and each.origin
    )


def key(code: str, cone: Cone, *said: Any) -> str:
    """Return the digest under which a table is stored: it covers everything that affects the table.

    `code` is a result of `sources`. Only the shape of the `cone` of light is included, rounded, so
    that the power does not change the digest. `said` is everything else that affects the table.
    """
    shape = np.round(cone.series / np.abs(cone.series).max(), 13) + 0.0  # no -0
    return hashlib.sha256(f"{code}{said}{shape.tolist()}".encode()).hexdigest()


def tables_folder() -> Path:
    """Return the folder of the tables, `KEY.table`, in the user's cache folder."""
    from platformdirs import user_cache_path

    return user_cache_path("tweezer") / "tables"


def kept(key: str, kind: type[AnyKept], make: Callable[[], AnyKept]) -> tuple[AnyKept, Path | None]:
    """Return the table in the cache folder, and its file; compute it if missing or damaged.

    `key`, `kind` and `make` are described in `stored`. If the table could not be written, no file
    is returned.
    """
    path = tables_folder() / f"{key}.table"
    if (made := _load(path, key, kind)) is not None:
        return made, path
    from filelock import FileLock

    lock = FileLock(path.with_suffix(".lock"))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _wait_for(lock)
    except (OSError, NotImplementedError) as error:
        warn(f"{path}: the table is not saved: {error}", UserWarning)
        return make(), None
    try:
        # the process that held the lock may have written it
        if (made := _load(path, key, kind)) is not None:
            return made, path
        if path.exists():
            warn(f"{path}: damaged; the table is computed again", UserWarning)
        made = make()
        try:
            _save(path, key, made)
        except ResultError as error:
            warn(f"{path}: the table is not saved: {error}", UserWarning)
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


def _save(path: Path, key: str, made: Any) -> None:
    """Write a table to a file: a digest of its key and content, then the fields as npz archive."""
    from tweezer.values.files import replacing

    buffer = io.BytesIO()
    np.savez(buffer, **{f.name: getattr(made, f.name) for f in dataclasses.fields(made)})
    content = buffer.getvalue()
    with replacing(path) as whole:
        whole.write(hashlib.sha256(key.encode() + content).digest() + content)


def _load(path: Path, key: str, kind: type[AnyKept]) -> AnyKept | None:
    """Return a saved table of the class `kind`; None if the file is missing or damaged."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    digest, content = content[:32], content[32:]
    if hashlib.sha256(key.encode() + content).digest() != digest:
        return None
    with np.load(io.BytesIO(content)) as archive:
        read = {name: archive[name] for name in archive.files}
    # numbers become Python's again: for NumPy's, kernels would be compiled once more
    fields: dict[str, Any] = {
        name: value if value.ndim else value.item() for name, value in read.items()
    }
    return kind(**fields)
