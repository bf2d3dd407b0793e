"""T-matrices from files of the T-matrix data format, storage version 1 (`.tmat.h5`).

The format is described by N. Asadova et al., arXiv:2408.10727. Units and the order of the modes are
read from the file.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.optics.bodies.saved import ENCLOSING, NAMES, other_basis, save_t_matrix
from tweezer.optics.bodies.t_matrix import ComplexArray, Integers, TMatrix, modes_up_to
from tweezer.values.arrays import Array
from tweezer.values.constants import speed_of_light
from tweezer.values.errors import ResultError, SceneError
from tweezer.values.hdf5 import check_result, item_of
from tweezer.values.units import to_si

if TYPE_CHECKING:
    import h5py

    from tweezer.values.units import QuantityLike

__all__ = ["load_t_matrix", "save_t_matrix"]

#: Relative difference of wavelengths and of refractive indices that are taken to be equal
_SAME = 1e-6
#: Largest part of the power by which S may exceed 1 if the file states no accuracy, and the
#: smallest one that is refused if it does
_MOST_GAIN, _LEAST_GAIN = 1e-2, 1e-6
#: Largest element, in the basis of the file: 1 and a gain
_LARGEST = 1.1
#: Most wavelengths that an error lists one by one
_FEW = 12
#: Rounding of a matrix element
_ROUNDING = 1e-12
#: Largest absorbed part of the power at which a body without a permittivity counts as lossless
_NO_LOSS = 1e-10
#: Most modes: degree 60
_MOST_MODES = 2 * 60 * 62

_PREFIXES = {
    "y": 1e-24, "z": 1e-21, "a": 1e-18, "f": 1e-15, "p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6,
    "μ": 1e-6, "m": 1e-3, "c": 1e-2, "d": 1e-1, "": 1.0, "da": 1e1, "h": 1e2, "k": 1e3, "M": 1e6,
    "G": 1e9, "T": 1e12, "P": 1e15, "E": 1e18, "Z": 1e21, "Y": 1e24,
}  # fmt: skip
_INVERSE = re.compile(r"(?:1/(?P<below>\w+)|(?P<base>\w+?)(?:\^\{-1\}|\^-1|\*\*-1|⁻¹))")

#: Keys of the frequency: kind of unit, and vacuum wavelength (m) of a value in SI units
_FREQUENCIES: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "vacuum_wavelength": ("length", lambda x: x),
    "frequency": ("frequency", lambda x: speed_of_light / x),
    "vacuum_wavenumber": ("inverse length", lambda x: 1 / x),
    "angular_frequency": ("frequency", lambda x: 2 * math.pi * speed_of_light / x),
    "angular_vacuum_wavenumber": ("inverse length", lambda x: 2 * math.pi / x),
}
_EXAMPLES = {
    "length": "a length such as 'nm'",
    "frequency": "a frequency such as 'THz' or 's^{-1}'",
    "inverse length": "an inverse length such as 'nm^{-1}'",
}

#: Names of polarisations: the basis, and +1 for positive helicity or electric modes
_POLARISATIONS = {
    **dict.fromkeys(("positive", "plus"), ("helicity", 1)),
    **dict.fromkeys(("negative", "minus"), ("helicity", -1)),
    **dict.fromkeys(("electric", "tm", "N"), ("electric/magnetic", 1)),
    **dict.fromkeys(("magnetic", "te", "M"), ("electric/magnetic", -1)),
}

#: Lengths of the shapes of the format, and the radius of a sphere about the centre around them
_SHAPES: dict[str, tuple[tuple[str, ...], Callable[..., float]]] = {
    "sphere": (("radius",), lambda r: r),
    "spheroid": (("radiusxy", "radiusz"), max),
    "ellipsoid": (("radiusx", "radiusy", "radiusz"), max),
    "superellipsoid": (("radiusx", "radiusy", "radiusz"), math.hypot),
    "cylinder": (("radius", "height"), lambda r, h: math.hypot(r, h / 2)),
    "torus": (("radius_major", "radius_minor"), lambda R, r: R + r),
    "ring": (
        ("radius_major", "radius_minor", "height"), lambda R, r, h: math.hypot(max(R, r), h / 2)
    ),
    "cube": (("length",), lambda a: math.sqrt(3) / 2 * a),
    "rectangular_cuboid": (
        ("lengthx", "lengthy", "lengthz"), lambda a, b, c: math.hypot(a, b, c) / 2
    ),
}  # fmt: skip


def load_t_matrix(
    path: str | Path,
    *,
    wavelength: QuantityLike | None = None,
    refractive_index: float | None = None,
    radius: QuantityLike | None = None,
) -> TMatrix:
    """Load a T-matrix from a file of the T-matrix data format.

    Parameters
    ----------
    path : str or Path
        File with the T-matrix of one body about one origin.
    wavelength : float or str, optional
        Vacuum wavelength, m. It selects the T-matrix in a file of several wavelengths.
    refractive_index : float, optional
        Refractive index that the medium of the file must have.
    radius : float or str, optional
        Radius of the sphere about the origin that encloses the body, m, in place of the one that
        follows from the geometry in the file.

    Returns
    -------
    TMatrix
        T-matrix for helicity modes. Its `error` is the accuracy that the file states. Without one,
        it is the larger violation of energy conservation and reciprocity.

    Raises
    ------
    SceneError
        For a file that is damaged, incomplete or ambiguous, for another wavelength or medium, for
        a medium that absorbs or is magnetic, and for a T-matrix that creates energy or whose degree
        is too low for the radius.
    """
    import h5py

    path = Path(path)
    asked = _asked(path, wavelength, refractive_index, radius)
    with _reading(path):
        check_result(path)
        with h5py.File(path) as file:
            return _File(path, file).t_matrix(*asked)


def _asked(path: Path, *values: Any) -> tuple[float | None, float | None, float | None]:
    """Return wavelength, refractive index and radius as numbers in SI units, or None."""
    found: list[float | None] = []
    named = zip(("wavelength", "refractive_index", "radius"), ("m", "", "m"), values, strict=True)
    for name, unit, value in named:
        try:
            number = None if value is None else to_si(value, unit)
            if number is not None and not number > 0:
                raise ValueError("must be positive")
        except ValueError as error:
            raise SceneError(f"{path}: {name} = {value}: {error}") from None
        found.append(number)
    return found[0], found[1], found[2]


@contextlib.contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Provide a context for reading a file; errors become `SceneError` of one line."""
    try:
        yield
    except SceneError:
        raise
    except ResultError as error:
        raise SceneError(str(error)) from None
    except FileNotFoundError:
        raise SceneError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise SceneError(f"{path}: is a folder; must be a file .tmat.h5") from None
    except Exception as error:  # h5py raises errors of any type for a damaged file
        reason = " ".join(str(error).split())
        raise SceneError(f"{path}: not a readable HDF5 file: {reason}") from None


def _text(value: Any) -> str:
    """Return the text of an attribute or an element, which other programs store in many ways."""
    if isinstance(value, np.ndarray):
        value = value.ravel()[0] if value.size == 1 else ""
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    return str(value).strip("\0 ")


def _factor(unit: str, kind: str) -> float | None:
    """Return the SI value of a unit of a kind, see `_EXAMPLES`; None for an unknown one."""
    if kind == "frequency" and unit == "rad/s":
        return 1.0
    base, power = {"length": ("m", 1), "frequency": ("Hz", 1), "inverse length": ("m", -1)}[kind]
    if match := _INVERSE.fullmatch(unit):
        unit, power = match["below"] or match["base"], -1
        base = "s" if kind == "frequency" else "m"
        if kind == "length":
            return None
    elif power < 0:
        return None
    prefix = _PREFIXES.get(unit.removesuffix(base)) if unit.endswith(base) else None
    return None if prefix is None else prefix**power


class _File:
    """An open file, whose entries are read with one line for each error."""

    def __init__(self, path: Path, file: h5py.File):
        self.path, self.file = path, file

    def t_matrix(
        self, wavelength: float | None, refractive_index: float | None, radius: float | None
    ) -> TMatrix:
        """Return the T-matrix for a wavelength (m), a medium and a radius (m), None if any."""
        matrices, basis = self._matrices()
        chosen, vacuum = self._wavelength(wavelength, len(matrices))
        n = self._medium(chosen, len(matrices), refractive_index)
        matrix = matrices[chosen]
        if not np.isfinite(matrix).all():
            raise self.error("tmatrix", "", "contains NaN or infinity; must be finite")
        if (largest := float(np.abs(matrix).max())) > _LARGEST:
            raise self.error(
                "tmatrix", "", f"has an element of size {largest:.3g}; a passive body has at most 1"
            )
        if basis == "electric/magnetic":
            matrix = other_basis(matrix)
        if radius is None:
            radius = self._radius()
        accuracy = self._accuracy()
        lossless = self._lossless(matrix, accuracy)
        found = TMatrix(matrix, 2 * math.pi * n / vacuum, n, radius, lossless, accuracy)
        gain = self._gain(found)
        size = found.wavenumber * radius
        if size > found.degree:
            raise self.error(
                "modes/l", f"1 to {found.degree}",
                f"too few for a body of radius {radius:.4g} m, k times which is {size:.3g}; must "
                f"reach {math.ceil(size)}",
            )  # fmt: skip
        if gain <= _within(accuracy, matrix) and found.reciprocity <= 4 * accuracy:
            return found
        worst = max(accuracy, gain, found.reciprocity, 0.0 if accuracy else found.unitarity)
        return dataclasses.replace(found, error=worst)

    def error(self, entry: str, value: object, problem: str) -> SceneError:
        """Return an error that names the file, the entry and its value (none if it is "")."""
        shown = "" if value == "" else f" = {value}"
        return SceneError(f"{self.path}: {entry}{shown}: {problem}")

    def item(self, name: str) -> Any:
        """Return a dataset or a group, or None if the file has none of that name."""
        found: Any = self.file
        for part in name.split("/"):
            if not hasattr(found, "keys") or part not in found:
                return None
            found = item_of(self.path, found, part, name)
            if found is None:
                return None
        return found

    def numbers(self, name: str, *, kinds: str = "iuf") -> Any:
        """Return the numbers of a dataset, or None if there is no such dataset."""
        item = self.item(name)
        if item is None:
            return None
        if not hasattr(item, "dtype"):
            raise self.error(name, "", "is a group; must be a dataset")
        if item.dtype.kind not in kinds or item.shape is None:
            allowed = "complex numbers" if kinds == "c" else "numbers"
            raise self.error(name, "", f"has values of type {item.dtype}; must contain {allowed}")
        return item[()]

    def unit(self, name: str, kind: str, otherwise: str = "") -> float:
        """Return the SI value of the unit of a dataset, an attribute of it.

        `otherwise` is a group that may have the attribute in place of the dataset.
        """
        for each in (name, otherwise):
            if each and "unit" in (attributes := self.item(each).attrs):
                unit = _text(attributes["unit"])
                if (factor := _factor(unit, kind)) is None:
                    raise self.error(f"{each}, unit", repr(unit), f"must be {_EXAMPLES[kind]}")
                return factor
        raise self.error(name, "", f"has no attribute unit; must have {_EXAMPLES[kind]}")

    def _matrices(self) -> tuple[ComplexArray, str]:
        """Return the T-matrices (frequencies, modes, modes) in standard order, and their basis."""
        matrices = self.numbers("tmatrix", kinds="c")
        if matrices is None:
            raise self.error("tmatrix", "", "missing; must contain the T-matrix")
        if matrices.ndim not in (2, 3) or not matrices.size:
            raise self.error(
                "tmatrix", "",
                f"has the shape {matrices.shape}; must be (modes, modes) or (frequencies, modes, "
                "modes)",
            )  # fmt: skip
        self._check_one_origin()
        rows, row_basis = self._modes("scattered")
        columns, basis = self._modes("incident")
        if row_basis != basis:
            raise self.error("modes", "", f"scattered {row_basis} and incident {basis} modes; "
                             "must be of one kind")  # fmt: skip
        if matrices.shape[-2:] != (len(rows), len(columns)):
            raise self.error(
                "tmatrix", "",
                f"has the shape {matrices.shape} for {len(rows)} scattered and {len(columns)} "
                "incident modes",
            )  # fmt: skip
        if len(rows) != len(columns):
            raise self.error(
                "tmatrix", "", f"has {len(rows)} scattered and {len(columns)} incident modes; must "
                "have the same"
            )  # fmt: skip
        matrices = matrices.reshape(-1, *matrices.shape[-2:])
        return matrices[:, rows][:, :, columns].astype(np.complex128), basis

    def _check_one_origin(self) -> None:
        """Refuse modes about several origins, or about another origin than the body's."""
        index = next(
            (name for name in ("modes/index", "modes/position_index") if self.item(name)), None
        )
        if index is not None and len(set(np.ravel(self.numbers(index)).tolist())) > 1:
            raise self.error(index, "", "has modes about several origins; must be about one")
        positions = self.numbers("modes/positions")
        if positions is None:
            return
        if np.size(positions) != 3:
            raise self.error(
                "modes/positions", "", f"has {np.size(positions) // 3} origins; must have one"
            )
        if np.any(positions):
            where = " ".join(f"{each:g}" for each in np.ravel(positions))
            raise self.error("modes/positions", where, "must be 0 0 0")

    def _modes(self, which: str) -> tuple[Integers, str]:
        """Return where each mode of the standard order is in the file, and the basis.

        Function `modes_up_to` lists the standard order. Electric modes replace helicity +1.
        """
        l_name, m_name, p_name = (
            f"modes/{key}_{which}" if self.item(f"modes/{key}_{which}") is not None
            else f"modes/{key}"
            for key in ("l", "m", "polarization")
        )  # fmt: skip
        l, m = (self._integers(name) for name in (l_name, m_name))
        names, basis = self._polarisations(p_name)
        lengths = {l_name: len(l), m_name: len(m), p_name: len(names)}
        if len(set(lengths.values())) > 1:
            told = ", ".join(f"{each} {count}" for each, count in lengths.items())
            raise self.error("modes", "", f"differ in length ({told}); must be the same")
        if len(l) > _MOST_MODES:
            raise self.error(l_name, "", f"has {len(l)} modes; must have at most {_MOST_MODES}")
        if min(l) < 1:
            raise self.error(l_name, min(l), "must be at least 1")
        for degree, order in zip(l, m, strict=True):
            if abs(order) > degree:
                raise self.error(
                    m_name, order, f"must be from {-degree} to {degree} for l = {degree}"
                )
        at: dict[tuple[int, int, int], int] = {}
        label = NAMES[basis]
        for place, mode in enumerate(zip(l, m, names, strict=True)):
            if mode in at:
                raise self.error("modes", "", f"{_mode(mode, label)} occurs twice")
            at[mode] = place
        standard = (
            (degree, order, helicity)
            for degree in range(1, max(l) + 1)
            for order in range(-degree, degree + 1)
            for helicity in (1, -1)
        )
        if missing := next((mode for mode in standard if mode not in at), None):
            raise self.error(
                "modes", "", f"{_mode(missing, label)} is missing; all modes up to l = {max(l)} "
                "are required"
            )  # fmt: skip
        return np.array([at[l, m, h] for l, m, h in modes_up_to(max(l)).tolist()]), basis

    def _integers(self, name: str) -> list[int]:
        """Return a list of integers, which may be stored as floats."""
        values = self.numbers(name)
        if values is None:
            raise self.error(name, "", "missing; must list a number for each mode")
        values = np.ravel(values)
        if not values.size:
            raise self.error(name, "", "is empty; must list a number for each mode")
        if bad := [each for each in values.tolist() if not float(each).is_integer()]:
            raise self.error(name, bad[0], "must be an integer")
        return [int(each) for each in values.tolist()]

    def _polarisations(self, name: str) -> tuple[list[int], str]:
        """Return +1 (positive, electric) or -1 for each mode, and the basis."""
        item = self.item(name)
        if item is None or not hasattr(item, "dtype"):
            raise self.error(name, "", "missing; must list a polarisation for each mode")
        names = [_text(each) for each in np.ravel(item[()])]
        allowed = "must be positive and negative, or electric and magnetic"
        for each in names:
            if each not in _POLARISATIONS:
                raise self.error(name, repr(each), allowed)
        bases = {_POLARISATIONS[each][0] for each in names}
        if len(bases) != 1:
            raise self.error(name, "", f"mixes helicity and electric or magnetic modes; {allowed}")
        return [_POLARISATIONS[each][1] for each in names], bases.pop()

    def _wavelength(self, asked: float | None, count: int) -> tuple[int, float]:
        """Return the index and the vacuum wavelength, m, of the requested T-matrix."""
        found = {name: self._table(name, count) for name in _FREQUENCIES}
        tables = {name: table for name, table in found.items() if table is not None}
        if not tables:
            raise self.error("vacuum_wavelength", "", f"missing; one of {', '.join(_FREQUENCIES)} "
                             "is required")  # fmt: skip
        (name, table), *others = tables.items()
        for other, values in others:
            if not np.allclose(table, values, rtol=_SAME, atol=0):
                raise self.error(other, "", f"is another wavelength than {name}; must agree")
        if asked is None:
            if len(table) > 1:
                raise self.error(name, _listed(table), "has several; choose one by wavelength")
            return 0, float(table[0])
        off = np.abs(table / asked - 1)
        chosen = int(off.argmin())
        if off[chosen] > _SAME:
            nearest = f", the nearest is {_nm(table[chosen])}" if len(table) > _FEW else ""
            raise self.error(
                name, _listed(table), f"does not include {_nm(asked)} as asked{nearest}; choose a "
                "tabled one"
            )  # fmt: skip
        return chosen, float(table[chosen])

    def _table(self, name: str, count: int) -> Array | None:
        """Return the vacuum wavelengths, m, of the T-matrices by one of the frequency keys."""
        values = self.numbers(name)
        if values is None:
            return None
        values = np.ravel(values).astype(float)
        if len(values) != count:
            raise self.error(
                name, "", f"has {len(values)} values; must have {count}, one for each T-matrix"
            )
        if not (np.isfinite(values) & (values > 0)).all():
            bad = values[~(np.isfinite(values) & (values > 0))][0]
            raise self.error(name, f"{bad:g}", "must be finite and positive")
        kind, as_wavelength = _FREQUENCIES[name]
        found: Array = as_wavelength(values * self.unit(name, kind))
        return found

    def _of_medium(self, key: str, chosen: int, count: int) -> complex | None:
        """Return a property of the medium at the chosen wavelength, or None."""
        name = f"embedding/{key}"
        values = self.numbers(name, kinds="iufc")
        if values is None:
            return None
        values = np.ravel(values)
        if len(values) not in (1, count):
            both = "1" if count == 1 else f"1 or {count}"
            raise self.error(name, "", f"has {len(values)} values; must have {both}")
        value = complex(values[chosen if len(values) > 1 else 0])
        if not np.isfinite(value):
            raise self.error(name, _shown(value), "must be finite")
        return value

    def _medium(self, chosen: int, count: int, asked: float | None) -> float:
        """Return the refractive index of the medium; refuse a medium that is not a dielectric."""
        mu = self._of_medium("relative_permeability", chosen, count)
        if mu is not None and abs(mu - 1) > _ROUNDING:
            raise self.error("embedding/relative_permeability", _shown(mu), "must be 1")
        for key in ("chirality", "chirality_parameter", "nonreciprocity"):
            if value := self._of_medium(key, chosen, count):
                raise self.error(f"embedding/{key}", _shown(value), "must be 0")
        key = "relative_permittivity"
        value = self._of_medium(key, chosen, count)
        index = None if value is None else np.sqrt(value)
        if value is None:
            key = "refractive_index"
            value = index = self._of_medium(key, chosen, count)
        if value is None or index is None:
            raise self.error(
                "embedding/relative_permittivity", "", "missing; must be that of the medium"
            )
        if abs(value.imag) > _ROUNDING * abs(value):
            raise self.error(f"embedding/{key}", _shown(value), "the medium absorbs; must be real")
        if not value.real > 0:
            raise self.error(f"embedding/{key}", _shown(value), "must be positive")
        found = float(index.real)
        if asked is not None and abs(found / asked - 1) > _SAME:
            raise self.error(
                f"embedding/{key}", _shown(value),
                f"is a refractive index of {found:.6g}; must be {asked:.6g} as asked",
            )  # fmt: skip
        return found

    def _scatterers(self) -> list[str]:
        """Return the names of the groups that describe the parts of the body."""
        return [name for name in self.file if re.fullmatch(r"scatterer(_\d+)?", name)]

    def _radius(self) -> float:
        """Return the radius of the sphere about the origin that encloses the body, m."""
        parts = [self._reach(f"{name}/geometry") for name in self._scatterers()]
        known = [each for each in parts if each is not None]
        if not known or len(known) < len(parts):
            raise self.error(
                "scatterer/geometry", "", "does not determine the size of the body; give radius, "
                "that of the sphere about the origin that encloses it"
            )  # fmt: skip
        return max(known)

    def _reach(self, geometry: str) -> float | None:
        """Return the largest distance of a part of the body from the origin, m, if it is known."""
        item = self.item(geometry)
        if item is None:
            return None
        own = self._lengths(geometry, ENCLOSING)
        if own is not None:
            return float(own[0])
        shape = _text(item.attrs.get("shape", ""))
        points = self._lengths(geometry, "points", signed=True) if "points" in item else None
        if shape == "convex_polyhedron" and points is not None and points.size % 3 == 0:
            reach = float(np.linalg.norm(points.reshape(-1, 3), axis=1).max())
        elif shape in _SHAPES:
            keys, around = _SHAPES[shape]
            lengths = [self._lengths(geometry, key) for key in keys]
            if any(each is None for each in lengths):
                return None
            reach = float(around(*(float(each[0]) for each in lengths if each is not None)))
        else:
            return None
        centre = np.zeros(3)
        for key, sign in (("position", 1), ("expansion_center", -1)):
            if (place := self._lengths(geometry, key, signed=True)) is not None:
                if place.size != 3:
                    raise self.error(f"{geometry}/{key}", "", "must have three coordinates")
                centre += sign * place
        return reach + float(np.linalg.norm(centre))

    def _lengths(self, group: str, key: str, *, signed: bool = False) -> Array | None:
        """Return the lengths in a dataset of a geometry, m, or None without it."""
        name = f"{group}/{key}"
        values = self.numbers(name)
        if values is None:
            return None
        values = np.ravel(values).astype(float)
        if not values.size or not np.isfinite(values).all():
            raise self.error(name, "", "must be finite lengths")
        if not signed and not (values > 0).all():
            raise self.error(name, f"{values.min():g}", "must be positive")
        return np.asarray(values * self.unit(name, "length", group))

    def _accuracy(self) -> float:
        """Return the accuracy that the file states; 0 without one."""
        item = self.item("computation")
        value = None if item is None else item.attrs.get("accuracy")
        if value is None or not np.size(value):
            return 0.0
        try:
            found = float(np.ravel(value)[0])
        except (TypeError, ValueError):
            found = math.nan
        if not 0 <= found < math.inf:
            raise self.error(
                "computation, accuracy", repr(_text(value)), "must be 0 or a positive number"
            )
        return found

    def _lossless(self, matrix: ComplexArray, accuracy: float) -> bool:
        """Return whether the body absorbs nothing.

        The permittivity of the body decides if the file has one, then keywords, and then the
        T-matrix.
        """
        losses = [self._material_absorbs(f"{name}/material") for name in self._scatterers()]
        if any(losses):
            return False
        if losses and None not in losses:
            return True
        if "lossless" in _text(self.file.attrs.get("keywords", "")):
            return True
        power = _power(matrix)
        return bool(-power[0] <= max(_NO_LOSS, _within(accuracy, matrix), 2 * power[-1]))

    def _material_absorbs(self, name: str) -> bool | None:
        """Return whether a material absorbs; None if the file does not determine it."""
        item = self.item(name)
        if item is None:
            return None
        for key in ("relative_permittivity", "refractive_index"):
            values = self.numbers(f"{name}/{key}", kinds="iufc")
            if values is not None:
                values = np.ravel(values).astype(complex)
                return bool((np.abs(values.imag) > _ROUNDING * np.abs(values)).any())
        return True if "absorptive" in _text(item.attrs.get("keywords", "")) else None

    def _gain(self, found: TMatrix) -> float:
        """Return the largest part of the power by which a body gives out more than it receives.

        Refuses a gain beyond the accuracy of the file.
        """
        gain = max(0.0, float(_power(found.matrix)[-1]))
        allowed = _MOST_GAIN
        if found.error > 0:
            allowed = max(_LEAST_GAIN, _within(found.error, found.matrix))
        if gain > allowed:
            raise self.error(
                "tmatrix", "", f"scatters {gain:.3g} of the incident power more than it receives; "
                f"must be at most {allowed:.3g}"
            )  # fmt: skip
        return gain


def _power(matrix: ComplexArray) -> Array:
    """Return the eigenvalues of S^+ S - 1 in ascending order: the power that a body gives out."""
    # the phases that distinguish S from 1 + 2T do not change them
    gain = 2 * (matrix + matrix.conj().T + 2 * matrix.conj().T @ matrix)
    return np.linalg.eigvalsh(gain).astype(np.float64)


def _within(accuracy: float, matrix: ComplexArray) -> float:
    """Return how far S^+ S may exceed 1 if no element of S is wrong by more than `accuracy`.

    The norm of the errors is at most the number of modes times the largest one.
    """
    return 2 * len(matrix) * accuracy + _ROUNDING


def _mode(mode: tuple[int, ...], label: tuple[str, str]) -> str:
    """Return a mode as text."""
    return f"l = {mode[0]}, m = {mode[1]}, {label[mode[2] < 0]}"


def _shown(value: complex) -> str:
    """Return a number as text, without a vanishing imaginary part."""
    return f"{value.real:.6g}" if value.imag == 0 else f"{value:.6g}"


def _nm(wavelength: float) -> str:
    """Return a wavelength as text."""
    return f"{wavelength * 1e9:.7g} nm"


def _listed(wavelengths: Array) -> str:
    """Return wavelengths as text; of many, the number and the ends."""
    if len(wavelengths) <= _FEW:
        return ", ".join(_nm(each) for each in wavelengths)
    least, most = _nm(wavelengths.min()), _nm(wavelengths.max())
    return f"{len(wavelengths)} wavelengths from {least} to {most}"
