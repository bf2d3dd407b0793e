"""The exact T-matrix of a rigid cluster of spheres, by superposition.

Each sphere j is lit by the light and by the waves that leave its neighbours,

    t_j = T'_j [p(r_j) + (1/2) sum over i of H(r_j - r_i) t_i],  p(r_j) = exp(i k s.r_j) p,

with T'_j = S_j - 1, -2 a_n for electric and -2 b_n for magnetic waves, and with the translation H
of outgoing waves (`tweezer.optics.bodies.translation`). About the origin the cluster has
t = sum over j of exp(-i k s.r_j) t_j. With amplitudes scaled by the square root of T' no number is
large, whatever the degree.

The system is eliminated degree by degree, so that each further degree of the spheres adds one term
to the T-matrix, and the size of these terms shows the convergence. By reciprocity the upper
triangle of the system follows from the lower one. The system decouples if the cluster is symmetric:
into orders m for spheres on a line through the origin, and into two classes for spheres in a plane
through the origin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tweezer.optics.bodies.rotation import rotation_matrix
from tweezer.optics.bodies.t_matrix import Integers, TMatrix, modes_up_to
from tweezer.optics.bodies.translation import Translation
from tweezer.optics.waves.sphere import mie_coefficients
from tweezer.values.arrays import Array, Complex

#: Largest degree of the spheres in the cluster
HIGHEST_DEGREE = 80
#: Largest number of amplitudes of one decoupled system; 16 bytes times half of its square is stored
MOST_AMPLITUDES = 6000
#: Overlap that counts as rounding of touching spheres, relative to the sum of the radii
_ROUNDING_OF_TOUCH = 1e-9
#: Distance from a line or a plane that counts as rounding, relative to the enclosing radius
_ROUNDING_OF_PLACE = 1e-14
#: Rounding errors of S - 1, relative to its largest element
_ROUNDING = 1e-14
#: Number of the last degrees from whose terms the remainder is estimated
_LAST = 4
#: Largest factor by which a dielectric neighbour strengthens what a sphere scatters
_STRENGTHENED = 10.0

Sphere = tuple[Array, float, complex]


def _enough(x: float) -> int:
    """Return the degree that waves of a sphere of size x = k times its radius need."""
    return math.ceil(x + 4 * x ** (1 / 3) + 4)


def _refuse_overlap(spheres: Sequence[Sphere]) -> None:
    for j, (centre, radius, _) in enumerate(spheres):
        for i, (other, other_radius, _) in enumerate(spheres[:j]):
            together = radius + other_radius
            distance = float(np.linalg.norm(centre - other))
            if distance < together * (1 - _ROUNDING_OF_TOUCH):
                raise ValueError(
                    f"spheres {i + 1} and {j + 1}: overlap, as their centres are {distance:.6g} m "
                    f"apart and their radii add up to {together:.6g} m; spheres may touch at most"
                )


def _frame(centres: Array, size: float) -> tuple[str, Array, Array]:
    """Return the symmetry of the centres, the centres in a frame that shows it, and its rotation R.

    The symmetry is one of

    - "line": the centres are on a line through the origin, the z axis of the frame;
    - "plane": they are in a plane through the origin, normal to z in the frame;
    - "none".

    R takes vectors in the frame to the body's frame. It is exactly 1 if z is the same in both.
    """
    _, sizes, axes = np.linalg.svd(np.concatenate([centres, np.zeros((3, 3))]))
    if sizes[1] <= _ROUNDING_OF_PLACE * size:
        symmetry, axis = "line", axes[0]
    elif sizes[2] <= _ROUNDING_OF_PLACE * size:
        symmetry, axis = "plane", axes[2]
    else:
        return "none", centres, np.eye(3)
    axis = np.where(np.abs(axis) <= _ROUNDING_OF_PLACE, 0.0, axis)
    x, y, z = axis if axis[2] >= 0 else -axis
    R = np.eye(3)
    if sizes[0] > 0 and (x != 0 or y != 0):
        # the shortest rotation that takes z to the axis
        R = np.array(
            [
                [1 - x * x / (1 + z), -x * y / (1 + z), x],
                [-x * y / (1 + z), 1 - y * y / (1 + z), y],
                [-x, -y, z],
            ]
        )
    placed = centres @ R
    placed[:, slice(0, 2) if symmetry == "line" else slice(2, 3)] = 0.0
    return symmetry, placed, R


@dataclass(frozen=True)
class _Modes:
    """Modes of one decoupled system: which orders of a degree belong to it, and their mirror.

    Reciprocity relates each mode to its mirror, of order -m, with a sign (-1)^(n+m).
    """

    #: "line", "plane" or "none"
    symmetry: str
    #: order m on a line, class 0 or 1 in a plane, else 0
    which: int

    def orders(self, n: int, magnetic: int) -> Integers:
        """Return the indices of the orders of degree n that belong to the system."""
        if self.symmetry == "line":
            return np.zeros(int(n >= self.which), np.int64)
        every = np.arange(2 * n + 1)
        if self.symmetry == "plane":
            # the mirror plane: n + m of electric and n + m + 1 of magnetic waves, modulo 2
            return every[(every + magnetic + self.which) % 2 == 0]
        return every

    def first(self, n: int) -> int:
        """Return the index of the first mode of degree n among those of all degrees."""
        return n - 1 if self.symmetry == "line" else n * n - 1

    def indices(self, n: int, magnetic: int) -> Integers:
        """Return the indices of the modes of degree n that belong to the system."""
        return self.first(n) + self.orders(n, magnetic)

    def mirror(self, n: int, magnetic: int) -> tuple[Integers, Array]:
        """Return the positions of the mirrored modes within `orders`, and their signs."""
        orders = self.orders(n, magnetic)
        if self.symmetry == "line":
            # m of electric waves is -m with the other sign of magnetic ones
            return np.arange(orders.size), np.full(orders.size, (-1.0) ** (n + magnetic))
        return np.arange(orders.size)[::-1], np.where(orders % 2, -1.0, 1.0)


class _Mirror:
    """Positions and signs of the mirrored modes of several groups, one after the other."""

    def __init__(self, groups: Sequence[tuple[Integers, Array]]) -> None:
        sizes = [positions.size for positions, _ in groups]
        starts = np.cumsum([0, *sizes[:-1]])
        self.positions = np.concatenate(
            [start + positions for start, (positions, _) in zip(starts, groups, strict=True)]
        ).astype(np.int64)
        self.signs = np.concatenate([signs for _, signs in groups])

    def rows(self, matrix: Complex) -> Complex:
        """Return a matrix with its rows mirrored."""
        return self.signs[:, None] * matrix[self.positions]

    def columns(self, matrix: Complex) -> Complex:
        """Return a matrix with its columns mirrored."""
        return matrix[:, self.positions] * self.signs


class _System:
    """One decoupled system (1 - G) u = Y p of scaled amplitudes u, eliminated degree by degree.

    Below the diagonal 1 - G = L D U is L, by blocks of one degree; U is the mirrored L^T.
    """

    def __init__(self, modes: _Modes, count: int, degree: int) -> None:
        self.modes = modes
        self._count = count
        incident = [(n, q) for q in (0, 1) for n in range(1, degree + 1)]
        split = [[modes.indices(n, q) for n in range(1, degree + 1)] for q in (0, 1)]
        #: modes of the body that the system couples to: electric, magnetic
        self.incident = tuple(np.concatenate(each).astype(np.int64) for each in split)
        self._of_body = _Mirror([modes.mirror(n, q) for n, q in incident])
        width = sum(each.size for each in self.incident)
        #: S - 1 between these modes
        self.change = np.zeros((width, width), np.complex128)
        #: what the degree that was added last contributed to it
        self.term = np.zeros_like(self.change)
        self._offsets = [0]
        self._mirrors: list[_Mirror] = []
        self._lower: list[Complex] = []
        self._inverse: list[Complex] = []
        self._light = np.zeros((0, width), np.complex128)
        #: columns of the system of each sphere's electric and magnetic waves, and their modes
        self.columns: list[list[Integers]] = [[np.zeros(0, np.int64)] * 2 for _ in range(count)]
        self.members: list[Integers] = [np.zeros(0, np.int64)] * 2

    @property
    def amplitudes(self) -> int:
        """Number of amplitudes so far."""
        return self._offsets[-1]

    def begin(self, n: int) -> list[list[Integers]]:
        """Add the amplitudes of degree n; return the rows of each sphere's waves among them."""
        groups = []
        rows: list[list[Integers]] = []
        at = 0
        for j in range(self._count):
            rows.append([])
            for q in (0, 1):
                here = at + np.arange(self.modes.orders(n, q).size)
                at += here.size
                groups.append(self.modes.mirror(n, q))
                rows[j].append(here)
                self.columns[j][q] = np.concatenate([self.columns[j][q], self.amplitudes + here])
        for q in (0, 1):
            self.members[q] = np.concatenate([self.members[q], self.modes.indices(n, q)])
        self._mirrors.append(_Mirror(groups))
        self._offsets.append(self.amplitudes + at)
        return rows

    def eliminate(self, coupling: Complex, light: Complex) -> float:
        """Eliminate the degree that was added last; return the largest element of its term.

        Parameters
        ----------
        coupling : ndarray, shape (rows, amplitudes)
            Rows of 1 - G.
        light : ndarray, shape (rows, incident modes)
            Rows of Y.
        """
        before = self._offsets[-2]
        block = coupling[:, :before]
        mirror = self._mirrors[-1]
        lower = np.empty_like(block)
        for i, inverse in enumerate(self._inverse):
            begin, end = self._offsets[i], self._offsets[i + 1]
            block[:, begin:end] -= block[:, :begin] @ self._lower[i].T
            lower[:, begin:end] = block[:, begin:end] @ inverse
        mirrored = mirror.rows(lower)
        for i, each in enumerate(self._mirrors[:-1]):
            here = slice(self._offsets[i], self._offsets[i + 1])
            mirrored[:, here] = each.columns(mirrored[:, here])
        last = np.linalg.inv(coupling[:, before:] - block @ mirrored.T).astype(np.complex128)
        self._lower.append(mirrored)
        self._inverse.append(last)
        light -= lower @ self._light
        self._light = np.concatenate([self._light, light])
        term = self._of_body.rows(mirror.columns(light.T) @ (last @ light))
        self.change += term
        self.term = term
        return float(np.abs(term).max(initial=0.0))


def _systems(symmetry: str, count: int, degree: int) -> list[_System]:
    """Return the decoupled systems of a cluster of `count` spheres and of the body's degree.

    On a line, there are systems of the orders m >= 0 only. Those of -m differ in signs alone.
    """
    number = {"line": degree + 1, "plane": 2, "none": 1}[symmetry]
    return [_System(_Modes(symmetry, which), count, degree) for which in range(number)]


def _assembled(systems: list[_System], parts: list[Complex], symmetry: str, degree: int) -> Complex:
    """Return a matrix between the electric, then the magnetic modes from its decoupled parts."""
    count = degree * (degree + 2)
    change = np.zeros((2 * count, 2 * count), np.complex128)
    for system, own in zip(systems, parts, strict=True):
        electric, magnetic = system.incident
        if symmetry != "line":
            at = np.concatenate([electric, count + magnetic])
            change[np.ix_(at, at)] = own
            continue
        m = system.modes.which
        n = electric + 1
        sign = np.repeat([1.0, -1.0], n.size)
        for order, part in ((m, own), (-m, sign[:, None] * own * sign)):
            modes = n * n - 1 + n + order
            at = np.concatenate([modes, count + modes])
            change[np.ix_(at, at)] = part
    return change


def _by_helicity(change: Complex) -> Complex:
    """Return S - 1 between modes of helicity, in the standard order, from electric and magnetic."""
    count = len(change) // 2
    electric, magnetic = slice(None, count), slice(count, None)
    own = change[electric, electric] + change[magnetic, magnetic]
    other = change[electric, electric] - change[magnetic, magnetic]
    crossed = change[electric, magnetic] + change[magnetic, electric]
    turned = change[magnetic, electric] - change[electric, magnetic]
    found = np.empty_like(change)
    found[::2, ::2], found[1::2, 1::2] = (own + crossed) / 2, (own - crossed) / 2
    found[::2, 1::2], found[1::2, ::2] = (other + turned) / 2, (other - turned) / 2
    return found


class _Superposition:
    """Equations of the spheres of a cluster, degree by degree."""

    def __init__(
        self,
        spheres: Sequence[Sphere],
        centres: Array,
        wavenumber: float,
        symmetry: str,
        degree: int,
    ) -> None:
        count = len(spheres)
        self._degree = degree
        self._line, self._plane = symmetry == "line", symmetry == "plane"
        kinds = {
            (radius, index): mie_coefficients(((radius, index),), wavenumber, HIGHEST_DEGREE)
            for _, radius, index in spheres
        }
        #: square roots of -2 a_n and -2 b_n of each sphere, (spheres, 2, degrees)
        self._scales = np.sqrt(
            [-2 * np.array(kinds[radius, index], np.complex128) for _, radius, index in spheres]
        )
        self._light = [Translation(c, wavenumber, outgoing=False) for c in centres]
        self._between = {
            (i, j): Translation(centres[i] - centres[j], wavenumber, outgoing=True)
            for i in range(count)
            for j in range(i)
        }
        self.systems = _systems(symmetry, count, degree)

    def amplitudes(self, highest: int) -> int:
        """Return the number of amplitudes of the largest system up to a degree of the spheres."""
        modes = highest if self._line else highest * (highest + 2)
        return 2 * len(self._light) * modes // (2 if self._plane else 1)

    def strengths(self) -> Array:
        """Return the largest change of a wave by each sphere, (spheres, degrees)."""
        return np.abs(self._scales).max(axis=1) ** 2

    def largest(self) -> float:
        """Return the largest element of S - 1 so far."""
        return max(float(np.abs(system.change).max()) for system in self.systems)

    def _rows(self, translation: Translation, n: int, highest: int) -> tuple[Complex, Complex]:
        return (translation.axial if self._line else translation.rows)(n, highest)

    def add(self, n: int) -> float:
        """Add the waves of degree n about the spheres; return the largest change of S - 1.

        It is infinite where the numbers overflow; the degree is then left out.
        """
        light = [self._rows(each, n, self._degree) for each in self._light]
        of_degree = np.arange(1, n + 1)
        # the translation of -d has the signs of the mirrored light
        sign = (-1.0) ** (n + of_degree)
        if not self._line:
            sign = np.repeat(sign, 2 * of_degree + 1)
            of_degree = np.repeat(of_degree, 2 * of_degree + 1)
        outer, inner = self._scales[:, :, n - 1], self._scales[:, :, of_degree - 1]
        pairs = {}
        for (i, j), translation in self._between.items():
            with np.errstate(over="ignore", invalid="ignore"):
                A, B = self._rows(translation, n, n)
            if not (np.isfinite(A).all() and np.isfinite(B).all()):
                return math.inf
            for to, of, parts in ((i, j, (A, B)), (j, i, (sign * A, -sign * B))):
                for q, r in np.ndindex(2, 2):
                    pairs[to, of, q, r] = outer[to, q] / 2 * parts[q ^ r] * inner[of, r]
        return max(self._added(system, n, light, pairs) for system in self.systems)

    def _added(
        self,
        system: _System,
        n: int,
        light: list[tuple[Complex, Complex]],
        pairs: dict[tuple[int, int, int, int], Complex],
    ) -> float:
        """Add the waves of degree n to one system; return the largest change of S - 1."""
        modes = system.modes
        if not modes.orders(n, 0).size and not modes.orders(n, 1).size:
            return 0.0
        # on a line each system has one row of the tables, its order m
        of_rows = [np.array([modes.which]) if self._line else modes.orders(n, q) for q in (0, 1)]
        rows = system.begin(n)
        height = sum(each.size for both in rows for each in both)
        coupling = np.zeros((height, system.amplitudes), np.complex128)
        incident = np.zeros((height, system.change.shape[0]), np.complex128)
        split = system.incident[0].size
        for i, both in enumerate(rows):
            for q, here in enumerate(both):
                scale = self._scales[i, q, n - 1]
                for r, columns in enumerate((slice(None, split), slice(split, None))):
                    part = light[i][q ^ r][np.ix_(of_rows[q], system.incident[r])]
                    incident[here, columns] = scale * part
                    for j in range(len(rows)):
                        if j != i:
                            table = pairs[i, j, q, r]
                            at = np.ix_(here, system.columns[j][r])
                            coupling[at] = -table[np.ix_(of_rows[q], system.members[r])]
        coupling[:, system.amplitudes - height :] += np.eye(height)
        return system.eliminate(coupling, incident)


class _Convergence:
    """Estimate of what all further degrees of the spheres would add to S - 1."""

    def __init__(self, spheres: Sequence[Sphere], wavenumber: float, strengths: Array) -> None:
        #: fall of the waves that a neighbour at the distance d sends to a sphere of radius a and
        #: receives from it, (a/d)^2 a degree
        self._fall = max(
            (
                (radius / float(np.linalg.norm(centre - other))) ** 2
                for j, (centre, radius, _) in enumerate(spheres)
                for i, (other, _, _) in enumerate(spheres)
                if i != j
            ),
            default=0.0,
        )
        #: the light itself converges beyond the degree k a
        self._begin = max(
            _LAST + 1, *(math.ceil(wavenumber * radius) + 2 for _, radius, _ in spheres)
        )
        #: most that the waves between the spheres add
        self._between = 2.0
        if all((index**2).real > 0 for _, _, index in spheres):
            largest = strengths.max(axis=1)
            self._between = _STRENGTHENED * float(np.sort(largest)[:-1].sum())
        #: most that the spheres scatter of the light itself from degree 1, 2, ... on
        self._light = np.cumsum(strengths.sum(axis=0)[::-1])[::-1]

    def remainder(self, terms: Sequence[float]) -> float:
        """Return an upper estimate of the sum of the terms that follow `terms`, of degree 1, 2, ...

        The ratio of successive terms approaches 1 slowly where spheres touch, so that a geometric
        series with their last ratio gives too little. Twice that series is more than the remainder
        of terms that fall as n^-p with p >= 2.

        The ratio is at least the one of n^3 (a/d)^2n, which are the terms of a dipole beside a
        sphere. While the light itself still converges, the terms may fall faster than that, but
        those of the waves between spheres follow.

        Dielectric spheres cannot add more than what they scatter of the light itself, and by the
        waves between them a multiple of what the weaker ones scatter. No element of S - 1 is larger
        than 2.
        """
        n = len(terms)
        if n < self._begin:
            return 2.0
        if terms[-1] == 0:
            return 0.0
        light = float(self._light[n]) if n < self._light.size else 0.0
        most = min(2.0, self._between + light)
        if not terms[-1 - _LAST] * terms[-3]:
            return most
        falls = [(terms[-1] / terms[-1 - back]) ** (1 / back) for back in (2, _LAST)]
        ratio = max(*falls, self._fall * (1 + 1 / n) ** 3)
        if ratio >= 1:
            return most
        return min(most, 2 * terms[-1] * ratio / (1 - ratio))


def cluster_t_matrix(
    spheres: Sequence[tuple[ArrayLike, float, complex]],
    wavenumber: float,
    refractive_index: float,
    *,
    tolerance: float = 1e-10,
) -> TMatrix:
    """Return the T-matrix of a rigid cluster of homogeneous spheres.

    The degree of the waves about the spheres is raised until the T-matrix has converged to the
    tolerance. It stops earlier at `HIGHEST_DEGREE`, at `MOST_AMPLITUDES`, or where numbers
    overflow; the field `error` of the T-matrix then exceeds the tolerance. Touching spheres of
    metal do not converge.

    Parameters
    ----------
    spheres : sequence of (array_like of shape (3,), float, complex)
        Centre relative to the body's origin (m), radius (m) and refractive index relative to the
        medium of each sphere. Im > 0 absorbs. Spheres may touch but not overlap.
    wavenumber : float
        Wavenumber in the medium, 1/m.
    refractive_index : float
        Refractive index of the medium.
    tolerance : float
        Largest error of an element of S - 1, relative to the largest element where that is below 1.

    Returns
    -------
    TMatrix
        T-matrix about the origin, up to the degree that suffices for light on a sphere that
        encloses the cluster.

    Raises
    ------
    ValueError
        If two spheres overlap.
    """
    placed = [
        (np.asarray(centre, np.float64), float(radius), complex(index))
        for centre, radius, index in spheres
    ]
    _refuse_overlap(placed)
    centres = np.array([centre for centre, _, _ in placed])
    size = max(float(np.linalg.norm(centre)) + radius for centre, radius, _ in placed)
    symmetry, centres, R = _frame(centres, size)
    degree = _enough(wavenumber * size)
    turn = None if np.array_equal(R, np.eye(3)) else rotation_matrix(degree, R)
    equations = _Superposition(placed, centres, wavenumber, symmetry, degree)

    def in_frame_of_body(parts: list[Complex]) -> Complex:
        change = _by_helicity(_assembled(equations.systems, parts, symmetry, degree))
        return change if turn is None else turn @ change @ turn.conj().T

    def growth() -> float:
        """Return by how much the largest element of the last term grows in the body's frame."""
        if turn is None or terms[-1] == 0:
            return 1.0
        term = in_frame_of_body([system.term for system in equations.systems])
        return max(1.0, float(np.abs(term).max()) / terms[-1])

    convergence = _Convergence(placed, wavenumber, equations.strengths())
    terms: list[float] = []
    error, grown = 2.0, False
    for n in range(1, HIGHEST_DEGREE + 1):
        if equations.amplitudes(n) > MOST_AMPLITUDES:
            break
        term = equations.add(n)
        if not math.isfinite(term):
            break
        terms.append(term)
        error, grown = convergence.remainder(terms), False
        wanted = tolerance * min(1.0, equations.largest())
        if error <= wanted:
            error, grown = error * growth(), True
            if error <= wanted:
                break
    if terms and not grown:
        error = min(2.0, error * growth())
    change = in_frame_of_body([system.change for system in equations.systems])
    largest = float(np.abs(change).max())
    phase = np.asarray(1j ** (modes_up_to(degree)[:, 0] % 4), np.complex128)
    matrix = phase[:, None] * change * phase.conj() / 2
    return TMatrix(
        matrix,
        wavenumber,
        refractive_index,
        size,
        all(index.imag == 0 for _, _, index in placed),
        error + _ROUNDING * largest,
    )
