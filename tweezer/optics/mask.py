"""Arrays of pixels in the pupil, such as the pattern of a spatial light modulator.

Files .npy and .npz contain an array of the phase (rad), the amplitude or the complex field. In it,
x increases from column to column and y from row to row. A .png image contains grey levels, with its
first row at the largest y. The array is centred on the axis, and no light passes outside of it.
"""

from __future__ import annotations

import functools
import hashlib
import math
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from tweezer.optics.sectors import Sectors
from tweezer.optics.zernike import projected, radial_sums
from tweezer.scene.sections import Beam
from tweezer.values.arrays import Array, Complex
from tweezer.values.errors import SceneError
from tweezer.values.files import check_regular

#: Smallest and largest number of rows and of columns; largest size of a file, bytes
_FEWEST, _MOST, _LARGEST = 2, 4096, 2**28
#: Amount by which the modulus of a factor may exceed 1 by rounding
_ROUNDED = 1e-6
#: Levels of an image of 8 bits
_LEVELS = 256
#: Degree up to which the transmitted intensity is expanded
_OF_POWER = 240
#: Smallest part of the light that a mask may transmit
_LEAST = 1e-6
#: Largest pupil radius over the standard deviation of a beam
_NARROWEST = 30.0
#: Axes of an array, rows and columns, that a flip reverses
_FLIPPED: dict[str, tuple[int, ...]] = {"none": (), "x": (1,), "y": (0,), "both": (0, 1)}


@dataclass(frozen=True, eq=False)
class Mask:
    """Complex factor of the light in square pixels over the pupil."""

    key: ClassVar[str] = "mask"
    values: Complex
    """(rows, columns) factor of the pixels; x ascends over the columns, and y over the rows"""
    width: float
    """of all columns, in pupil radii"""
    angle: float
    """angle by which the array is turned about the axis, from x to y, rad"""

    def __repr__(self) -> str:
        """Return a text that differs for all masks: the names of force maps contain it."""
        digest = hashlib.sha256(self.values.tobytes()).hexdigest()
        return f"Mask({self.values.shape}, {digest}, {self.width!r}, {self.angle!r})"

    @functools.cached_property
    def lossless(self) -> bool:
        """Whether all light passes."""
        rows, columns = self.values.shape
        covers = min(rows / columns, 1.0) * self.width >= 2 - 1e-12
        return covers and bool(np.abs(np.abs(self.values) - 1).max() < 1e-12)

    def terms(self, degree: int) -> Complex:
        """Return the coefficients c_nm up to a degree; see `tweezer.optics.zernike.projected`."""
        known: Complex | None = self.__dict__.get("known")
        if known is None or len(known) <= degree:
            # the degree grows in steps: a projection to twice the degree serves several of them
            most = degree if known is None else max(degree, 2 * len(known))
            known = self.__dict__["known"] = self._turned(self.values, most)
        most = len(known) - 1
        return known[: degree + 1, most - degree : most + degree + 1]

    def _turned(self, values: Complex, degree: int) -> Complex:
        """Return the coefficients of values of the pixels, turned by the angle."""
        orders = np.arange(-degree, degree + 1)
        found = projected(values, self.width, degree) * np.exp(-1j * orders * self.angle)
        return np.asarray(found)

    def transmitted(self, rho: Array, phi: Array) -> Array:
        """Return |T|^2 at radii (n,) and azimuths (m,), (n, m), without its fine details.

        Its expansion ends at a degree beyond which the profile of the light has no terms.
        """
        if self.lossless:
            return np.ones((len(rho), len(phi)))
        return np.asarray(harmonic_sum(radial_sums(self._intensity, rho), phi).real)

    @functools.cached_property
    def _intensity(self) -> Complex:
        """Coefficients c_nm of |T|^2."""
        return self._turned(np.abs(self.values) ** 2 + 0j, _OF_POWER)


def harmonic_sum(harmonics: Complex, phi: Array) -> Complex:
    """Return sum_m t_m exp(i m phi) of harmonics (orders, n) at azimuths (m,): (n, m)."""
    degree = len(harmonics) // 2
    return np.asarray(harmonics.T @ np.exp(1j * np.outer(np.arange(-degree, degree + 1), phi)))


def mask_of(beam: Beam, radius: float) -> Mask | Sectors | None:
    """Return the mask or the sectors of a beam in a pupil of a radius, m; None if it has neither.

    Raises `SceneError` for a file that cannot be read, or that contains no such mask, and for a
    beam whose light does not fill the pupil smoothly.
    """
    if beam.pattern is None:
        return None
    if beam.sigma is not None and beam.sigma * _NARROWEST < radius:
        raise SceneError(
            f"beam.sigma = {beam.sigma:.3g}: with beam.{beam.pattern} the beam must be at least "
            f"{radius / _NARROWEST:.3g} m wide, a {_NARROWEST:g}th of lens.radius"
        )
    if beam.profile_radius is not None and beam.profile_radius[-1] < radius:
        raise SceneError(
            f"beam.profile_radius: ends at {beam.profile_radius[-1]:.3g} m; with "
            f"beam.{beam.pattern} it must reach lens.radius = {radius:.3g} m"
        )
    if beam.mask is None:
        return Sectors(beam.sectors or ())
    try:
        check_regular(Path(beam.mask))
        status = Path(beam.mask).stat()
    except OSError as error:
        raise SceneError(f"beam.mask = {beam.mask!r}: cannot be read: {error.strerror}") from None
    if status.st_size > _LARGEST:
        raise SceneError(f"beam.mask = {beam.mask!r}: must have at most {_LARGEST >> 20} MiB")
    width = 2.0 if beam.mask_extent is None else beam.mask_extent / radius
    return _read(
        beam.mask, status.st_mtime_ns, beam.mask_kind, beam.mask_levels, beam.mask_flip, width,
        beam.mask_angle,
    )  # fmt: skip


@functools.lru_cache(maxsize=8)
def _read(
    file: str, changed: int, kind: str, levels: int | None, flip: str, width: float, angle: float
) -> Mask:
    """Return the mask in a file that was last changed at a time; see `mask_of`."""
    del changed  # a file that changes is read again
    try:
        values = _factor(_array(Path(file)), kind, levels)
    except SceneError as error:
        raise SceneError(f"beam.mask = {file!r}: {error}") from None
    values = np.flip(values, _FLIPPED[flip])
    values.setflags(write=False)
    return Mask(values, width, angle)


def _array(path: Path) -> Any:
    """Return the array of numbers in a file, with y ascending over the rows."""
    suffix = path.suffix.lower()
    if suffix not in (".npy", ".npz", ".png"):
        raise SceneError("must be a file .npy, .npz or .png")
    try:
        if suffix == ".png":
            return _levels(path)[::-1]
        with path.open("rb") as file:
            found: Any = np.load(file, allow_pickle=False)
            if suffix == ".npz":
                found = _only(found)
    except (OSError, ValueError, EOFError, SyntaxError, zipfile.BadZipFile) as error:
        why = str(error).splitlines()[0]
        if "pickle" in why:  # of the objects that NumPy would read instead
            why = "contains no array of numbers"
        raise SceneError(f"cannot be read as {suffix}: {why}") from None
    if not isinstance(found, np.ndarray):
        raise SceneError(f"must be an array, as {suffix} files contain")
    return found


def _only(archive: Any) -> Any:
    """Return the only array of a .npz file."""
    if not isinstance(archive, np.lib.npyio.NpzFile):
        raise SceneError("must be an archive .npz of one array")
    if len(archive.files) != 1:
        raise SceneError(f"must contain one array, and has {len(archive.files)}")
    return archive[archive.files[0]]


def _levels(path: Path) -> Any:
    """Return the grey levels of an image of 8 bits, as integers."""
    from matplotlib.image import imread

    shades = np.asarray(imread(path, format="png"), float)
    if shades.ndim == 3:
        colours = shades[..., :3]
        if shades.shape[2] == 2 or np.ptp(colours, axis=2).max() > 0:
            raise SceneError("must be a grey image, without colours")
        shades = colours[..., 0]
    found = np.rint(255 * shades)
    if np.abs(255 * shades - found).max(initial=0.0) > 1e-3:
        raise SceneError("must be an image of 8 bits; save finer levels as .npy")
    return found.astype(int)


def _factor(array: Any, kind: str, levels: int | None) -> Complex:
    """Return the complex factor of the pixels of an array; see `Mask`."""
    if array.ndim != 2 or not all(_FEWEST <= each <= _MOST for each in array.shape):
        shape = " x ".join(map(str, array.shape)) or "a number"
        raise SceneError(f"has the shape {shape}; must have {_FEWEST} to {_MOST} rows and columns")
    if array.dtype.kind not in "biufc":
        raise SceneError(f"contains {array.dtype}; must contain numbers")
    if not np.isfinite(array).all():
        raise SceneError("contains NaN or infinite numbers; must be finite")
    whole, wavy = array.dtype.kind in "biu", array.dtype.kind == "c"
    if levels is not None and not whole:
        raise SceneError(f"beam.mask_levels requires whole numbers, and the file has {array.dtype}")
    if kind == "field":
        factor = array.astype(np.complex128)
    elif wavy:
        raise SceneError(f"contains complex numbers; beam.mask_kind = {kind!r} requires real ones")
    elif kind == "phase":
        per_level = 2 * math.pi / (levels or _LEVELS) if whole else 1.0
        factor = np.exp(1j * (per_level * array.astype(float)))
    else:
        factor = array / ((levels or _LEVELS) - 1.0 if whole else 1.0) + 0j
        if factor.real.min() < 0:
            raise SceneError(f"has the amplitude {factor.real.min():.3g}; must be from 0 to 1")
    largest = float(np.abs(factor).max())
    if largest > 1 + _ROUNDED:
        raise SceneError(f"has the modulus {largest:.4g}; must be at most 1")
    if largest < _LEAST:
        raise SceneError("transmits no light")
    return np.ascontiguousarray(factor)
