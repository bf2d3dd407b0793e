"""Integrals over the surface of a body of revolution, with twice the digits of a double.

The extended boundary condition method (Waterman, Phys. Rev. D 3, 825 (1971)) gives the T-matrix of
a homogeneous body from surface integrals. An integrand is the product of a wave outside the body
(degree n, the test wave, with psi_n or chi_n) and a wave inside it (degree n', relative index m).
For elongated bodies the integrals are small differences of large numbers, which is why doubles are
not enough. `derivation.bodies` derives the four integrands.

psi_n and chi_n are the Riccati-Bessel functions x j_n(x) and x y_n(x). The polar part of a
spherical harmonic is y, with nu^2 = n(n+1), tau = y'/nu, and pi = m y/(nu sin theta) for the order
m. A real number with twice the digits is stored as (high, low), a complex one as four doubles.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.double_double import (
    add,
    complex_add,
    complex_minus,
    complex_over,
    complex_times,
    exponential,
    minus,
    negative,
    over,
    root,
    scaled,
    sine_and_cosine,
    times,
)

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "inner": True}

#: Numbers of a real and of a complex number with twice the digits
REAL, COMPLEX = 2, 4
#: Degrees above the highest, or above |z|, from which the recurrence of psi_n begins
_BEGIN_ABOVE = (45, 10.0)
# columns of the geometry of a node: x = k r, r'/r, cos(theta), sin(theta), weight of the integral
_X, _SLOPE, _COSINE, _SINE, _WEIGHT = range(5)


@named_njit(**_OPTIONS)
def _real(array, i, j):  # type: ignore[no-untyped-def]
    """Return the number [i, j] of an array (.., .., 2)."""
    return array[i, j, 0], array[i, j, 1]


@named_njit(**_OPTIONS)
def _complex(array, i, j):  # type: ignore[no-untyped-def]
    """Return the complex number [i, j] of an array (.., .., 4)."""
    return (array[i, j, 0], array[i, j, 1]), (array[i, j, 2], array[i, j, 3])


@named_njit(**_OPTIONS)
def _put_real(array, i, j, value):  # type: ignore[no-untyped-def]
    """Store a number as [i, j] of an array (.., .., 2)."""
    array[i, j, 0], array[i, j, 1] = value


@named_njit(**_OPTIONS)
def _put_complex(array, i, j, value):  # type: ignore[no-untyped-def]
    """Store a complex number as [i, j] of an array (.., .., 4)."""
    array[i, j, 0], array[i, j, 1] = value[0]
    array[i, j, 2], array[i, j, 3] = value[1]


@named_njit(**_OPTIONS)
def _legendre_node(u, count):  # type: ignore[no-untyped-def]
    """Return the zero of P_count near `u`, and its weight of Gauss and Legendre on (-1, 1)."""
    node = (u, 0.0)
    slope = (1.0, 0.0)
    for _ in range(3):
        before, here = (1.0, 0.0), node
        for n in range(2, count + 1):
            above = scaled(times(node, here), 2.0 * n - 1.0)
            before, here = here, over(minus(above, scaled(before, n - 1.0)), (float(n), 0.0))
        below_one = minus((1.0, 0.0), times(node, node))
        slope = over(scaled(minus(before, times(node, here)), float(count)), below_one)
        node = minus(node, over(here, slope))
    below_one = minus((1.0, 0.0), times(node, node))
    return node, over((2.0, 0.0), times(below_one, times(slope, slope)))


@cached_njit(error_model="numpy", nogil=True)
def spheroid_nodes(starts, across, along):  # type: ignore[no-untyped-def]
    """Return the geometry of a spheroid at nodes over half its surface, (nodes, 5, 2).

    The columns are k r, r'/r, cos(theta), sin(theta), and the weight of the integral over
    cos(theta) from 0 to 1. `starts` are Gauss-Legendre nodes on (-1, 1) as doubles, and `across`
    and `along` are k times the semi-axes.
    """
    out = np.empty((len(starts), 5, 2))
    one = (1.0, 0.0)
    across_square, along_square = (
        times((across, 0.0), (across, 0.0)),
        times((along, 0.0), (along, 0.0)),
    )
    a, c = over(one, across_square), over(one, along_square)
    for q in range(len(starts)):
        node, weight = _legendre_node(starts[q], len(starts))
        cosine = scaled(add(one, node), 0.5)
        sine_square = times(minus(one, cosine), add(one, cosine))
        sine = root(sine_square)
        square = over(one, add(times(times(cosine, cosine), c), times(sine_square, a)))
        slope = times(times(square, times(sine, cosine)), minus(c, a))
        _put_real(out, q, _X, root(square))
        _put_real(out, q, _SLOPE, slope)
        _put_real(out, q, _COSINE, cosine)
        _put_real(out, q, _SINE, sine)
        _put_real(out, q, _WEIGHT, scaled(weight, 0.5))
    return out


@named_njit(**_OPTIONS)
def _regular(z, highest, q, psi, slopes):  # type: ignore[no-untyped-def]
    """Fill row q of psi and slopes with psi_n(z) and psi_n'(z), complex, for n = 0..highest.

    The ratios psi_n/psi_(n-1) come from the recurrence downward.
    """
    sine, cosine = sine_and_cosine(z[0])
    grown = exponential(z[1])
    shrunk = over((1.0, 0.0), grown)
    cosh, sinh = scaled(add(grown, shrunk), 0.5), scaled(minus(grown, shrunk), 0.5)
    sine_z = times(sine, cosh), times(cosine, sinh)
    cosine_z = times(cosine, cosh), negative(times(sine, sinh))
    size = math.hypot(z[0][0], z[1][0])
    begin = int(max(float(highest), size) + _BEGIN_ABOVE[1] * size ** (1.0 / 3.0))
    zero = (0.0, 0.0)
    ratio = zero, zero
    for n in range(begin + _BEGIN_ABOVE[0], 0, -1):
        ratio = complex_over(
            z, complex_minus(((2.0 * n + 1.0, 0.0), zero), complex_times(z, ratio))
        )
        if n <= highest:
            _put_complex(psi, q, n, ratio)
    first = complex_minus(complex_over(sine_z, z), cosine_z)
    if math.hypot(sine_z[0][0], sine_z[1][0]) > math.hypot(first[0][0], first[1][0]):
        first = complex_times(sine_z, _complex(psi, q, 1))
    _put_complex(psi, q, 0, sine_z)
    _put_complex(slopes, q, 0, cosine_z)
    value = first
    _put_complex(psi, q, 1, value)
    for n in range(2, highest + 1):
        value = complex_times(value, _complex(psi, q, n))
        _put_complex(psi, q, n, value)
    for n in range(1, highest + 1):
        over_z = complex_over(_complex(psi, q, n), z)
        scaled_n = scaled(over_z[0], float(n)), scaled(over_z[1], float(n))
        _put_complex(slopes, q, n, complex_minus(_complex(psi, q, n - 1), scaled_n))


@named_njit(**_OPTIONS)
def _irregular(x, highest, q, chi, slopes):  # type: ignore[no-untyped-def]
    """Fill row q of chi and slopes with chi_n(x) and chi_n'(x) for n = 0..highest, x real."""
    sine, cosine = sine_and_cosine(x)
    before, here = negative(cosine), negative(add(over(cosine, x), sine))
    _put_real(chi, q, 0, before)
    _put_real(slopes, q, 0, sine)
    for n in range(1, highest + 1):
        _put_real(chi, q, n, here)
        _put_real(slopes, q, n, minus(before, scaled(over(here, x), float(n))))
        before, here = here, minus(scaled(over(here, x), 2.0 * n + 1.0), before)


@cached_njit(error_model="numpy", nogil=True)
def radial_functions(nodes, index_re, index_im, highest):  # type: ignore[no-untyped-def]
    """Return psi, psi', chi, chi' of k r, and psi, psi' of m k r at nodes of a surface.

    Parameters
    ----------
    nodes : ndarray, shape (nodes, 5, 2)
        Geometry of the nodes; see `spheroid_nodes`.
    index_re, index_im : float
        Index m of the body relative to the medium.
    highest : int
        Highest degree.

    Returns
    -------
    outside : ndarray, shape (4, nodes, highest + 1, 2)
        psi, psi', chi and chi' of degrees from 0.
    inside : ndarray, shape (2, nodes, highest + 1, 4)
        psi and psi' inside the body.
    """
    count = len(nodes)
    outside = np.empty((4, count, highest + 1, 2))
    inside = np.empty((2, count, highest + 1, 4))
    room = np.empty((2, 1, highest + 1, 4))
    for q in range(count):
        x = _real(nodes, q, _X)
        _regular((x, (0.0, 0.0)), highest, 0, room[0], room[1])
        for n in range(highest + 1):
            _put_real(outside[0], q, n, _complex(room[0], 0, n)[0])
            _put_real(outside[1], q, n, _complex(room[1], 0, n)[0])
        _irregular(x, highest, q, outside[2], outside[3])
        z = scaled(x, index_re), scaled(x, index_im)
        _regular(z, highest, q, inside[0], inside[1])
    return outside, inside


@named_njit(**_OPTIONS)
def _angular(nodes, m, highest, harmonics, pi, tau):  # type: ignore[no-untyped-def]
    """Fill the arrays (nodes, highest + 1, 2) with y, pi and tau of the order m >= 0.

    They have a common factor that depends on m alone, and are 0 below the degree max(m, 1).
    """
    square = float(m * m)
    for q in range(len(nodes)):
        cosine, sine = _real(nodes, q, _COSINE), _real(nodes, q, _SINE)
        before, here = (0.0, 0.0), (1.0, 0.0)
        for _ in range(m):
            here = times(here, sine)
        last = (0.0, 0.0)  # root((n^2 - m^2)/(4 n^2 - 1)) of the degree
        for n in range(highest + 1):
            if n < m:
                value, lower = (0.0, 0.0), (0.0, 0.0)
            else:
                value, lower = here, before
            _put_real(harmonics, q, n, value)
            if n < max(m, 1):
                _put_real(pi, q, n, (0.0, 0.0))
                _put_real(tau, q, n, (0.0, 0.0))
            else:
                length = times(root((n * (n + 1.0), 0.0)), sine)
                _put_real(pi, q, n, over(scaled(value, float(m)), length))
                # sin(theta) y' = n cos(theta) y_n - root((n^2 - m^2)(2n+1)/(2n-1)) y_(n-1)
                part = times(root(over(((n * n - square) * (2.0 * n + 1.0), 0.0),
                                       (2.0 * n - 1.0, 0.0))), lower)  # fmt: skip
                turned = minus(scaled(times(cosine, value), float(n)), part)
                _put_real(tau, q, n, over(turned, length))
            if n >= m:
                above = n + 1.0
                here_root = root(over((above * above - square, 0.0),
                                      (4.0 * above * above - 1.0, 0.0)))  # fmt: skip
                following = minus(times(cosine, value), times(last, lower))
                before, here = value, over(following, here_root)
                last = here_root


@named_njit(**_OPTIONS)
def _tests(nodes, zeta, slope, harmonics, pi, tau, n, out):  # type: ignore[no-untyped-def]
    """Fill `out` (4, nodes, 2) with the factors of the test wave of degree n in the integrands.

    They are w zeta' pi, w (zeta' tau + r'/r nu y zeta/x), w zeta pi and w zeta tau, with the weight
    w of a node.
    """
    length = root((n * (n + 1.0), 0.0))
    for q in range(len(nodes)):
        weight, x = _real(nodes, q, _WEIGHT), _real(nodes, q, _X)
        radial = times(weight, _real(zeta, q, n))
        turned = times(weight, _real(slope, q, n))
        along = over(times(times(_real(nodes, q, _SLOPE), length), _real(harmonics, q, n)), x)
        _put_real(out, 0, q, times(turned, _real(pi, q, n)))
        _put_real(out, 1, q, add(times(turned, _real(tau, q, n)), times(along, radial)))
        _put_real(out, 2, q, times(radial, _real(pi, q, n)))
        _put_real(out, 3, q, times(radial, _real(tau, q, n)))


@named_njit(**_OPTIONS)
def _inner(nodes, psi, slope, index, harmonics, pi, tau, n, out):  # type: ignore[no-untyped-def]
    """Fill `out` (4, nodes, 4) with the factors of the inner wave of degree n in the integrands.

    They are psi pi, psi tau, psi' pi and psi' tau + r'/r nu y psi/(m x), with the index m.
    """
    length = root((n * (n + 1.0), 0.0))
    for q in range(len(nodes)):
        x = _real(nodes, q, _X)
        z = times(x, index[0]), times(x, index[1])
        value, turned = _complex(psi, q, n), _complex(slope, q, n)
        angle, other = _real(pi, q, n), _real(tau, q, n)
        along = times(times(_real(nodes, q, _SLOPE), length), _real(harmonics, q, n))
        part = complex_over((times(value[0], along), times(value[1], along)), z)
        _put_complex(out, 0, q, (times(value[0], angle), times(value[1], angle)))
        _put_complex(out, 1, q, (times(value[0], other), times(value[1], other)))
        _put_complex(out, 2, q, (times(turned[0], angle), times(turned[1], angle)))
        _put_complex(out, 3, q, (
            add(times(turned[0], other), part[0]), add(times(turned[1], other), part[1])
        ))  # fmt: skip


@named_njit(**_OPTIONS)
def _two_products(test, i, j, inner, k, l, real):  # type: ignore[no-untyped-def]
    """Return the integral of test[i] inner[k] + test[j] inner[l], complex, or `real` if so."""
    re, im = (0.0, 0.0), (0.0, 0.0)
    for q in range(test.shape[1]):
        a, b = _real(test, i, q), _real(test, j, q)
        c, d = _complex(inner, k, q), _complex(inner, l, q)
        re = add(re, add(times(a, c[0]), times(b, d[0])))
        if not real:
            im = add(im, add(times(a, c[1]), times(b, d[1])))
    return re, im


@named_njit(**_OPTIONS)
def _element(test, inner, index, even, magnetic):  # type: ignore[no-untyped-def]
    """Return the element of Q between a test wave, `magnetic` or electric, and an inner wave.

    The inner wave has the same type if the sum of the two degrees is `even`, else the other one.
    """
    real = index[1][0] == 0.0
    if even:
        one = _two_products(test, 0, 1, inner, 0, 1, real)
        two = _two_products(test, 2, 3, inner, 2, 3, real)
        if magnetic:
            return complex_minus(one, complex_times(index, two))
        return complex_minus(two, complex_times(index, one))
    one = _two_products(test, 1, 0, inner, 2, 3, real)
    two = _two_products(test, 3, 2, inner, 0, 1, real)
    if magnetic:
        return complex_add(one, complex_times(index, two))
    return complex_add(two, complex_times(index, one))


@named_njit(**_OPTIONS)
def _power_of_two(values):  # type: ignore[no-untyped-def]
    """Return the power of two that brings the largest of complex numbers (n, 4) to about 1."""
    largest = 0.0
    for i in range(len(values)):
        largest = max(largest, abs(values[i, 0]), abs(values[i, 2]))
    return 2.0 ** -math.floor(math.log2(largest)) if largest > 0.0 else 1.0


@named_njit(**_OPTIONS)
def _eliminate(matrix, right):  # type: ignore[no-untyped-def]
    """Replace `right` (n, n, 4) by matrix^-1 right, by elimination with pivots; both change."""
    size = len(matrix)
    for k in range(size):
        pivot, largest = k, 0.0
        for i in range(k, size):
            value = math.hypot(matrix[i, k, 0], matrix[i, k, 2])
            if value > largest:
                pivot, largest = i, value
        if pivot != k:
            for j in range(size):
                for part in range(COMPLEX):
                    kept = matrix[k, j, part]
                    matrix[k, j, part] = matrix[pivot, j, part]
                    matrix[pivot, j, part] = kept
                    kept = right[k, j, part]
                    right[k, j, part] = right[pivot, j, part]
                    right[pivot, j, part] = kept
        for i in range(k + 1, size):
            factor = complex_over(_complex(matrix, i, k), _complex(matrix, k, k))
            for j in range(k + 1, size):
                less = complex_times(factor, _complex(matrix, k, j))
                _put_complex(matrix, i, j, complex_minus(_complex(matrix, i, j), less))
            for j in range(size):
                less = complex_times(factor, _complex(right, k, j))
                _put_complex(right, i, j, complex_minus(_complex(right, i, j), less))
    for k in range(size - 1, -1, -1):
        for j in range(size):
            value = _complex(right, k, j)
            for i in range(k + 1, size):
                less = complex_times(_complex(matrix, k, i), _complex(right, i, j))
                value = complex_minus(value, less)
            _put_complex(right, k, j, complex_over(value, _complex(matrix, k, k)))


@cached_njit(error_model="numpy", nogil=True)
def t_of_order(nodes, outside, inside, index_re, index_im, m):  # type: ignore[no-untyped-def]
    """Return the T-matrix of a body of revolution with a mirror plane for one order m >= 0.

    It is the solution of T' Q[psi + i chi] = -Q[psi]. The mirror plane does not mix two classes of
    waves, and each is solved separately. A class has magnetic waves with n of one parity and
    electric waves with n of the other.

    Parameters
    ----------
    nodes : ndarray, shape (nodes, 5, 2)
        Geometry of the nodes; see `spheroid_nodes`.
    outside, inside : ndarray
        Radial functions; see `radial_functions`.
    index_re, index_im : float
        Index of the body relative to the medium.
    m : int
        Order.

    Returns
    -------
    ndarray, shape (2, degrees, 2, degrees, 2)
        T' by type (0 electric, 1 magnetic) and degree of the scattered and of the incident wave,
        as (re, im). Degrees begin at 0; those below max(m, 1) are zero.
    """
    highest, count = outside.shape[2] - 1, len(nodes)
    index = (index_re, 0.0), (index_im, 0.0)
    harmonics = np.empty((count, highest + 1, REAL))
    pi, tau = np.empty_like(harmonics), np.empty_like(harmonics)
    _angular(nodes, m, highest, harmonics, pi, tau)
    lowest = max(m, 1)
    size = highest + 1 - lowest
    regular = np.empty((size, 4, count, REAL))
    irregular = np.empty((size, 4, count, REAL))
    inner = np.empty((size, 4, count, COMPLEX))
    for i in range(size):
        n = lowest + i
        _tests(nodes, outside[0], outside[1], harmonics, pi, tau, n, regular[i])
        _tests(nodes, outside[2], outside[3], harmonics, pi, tau, n, irregular[i])
        _inner(nodes, inside[0], inside[1], index, harmonics, pi, tau, n, inner[i])
    out = np.zeros((2, highest + 1, 2, highest + 1, 2))
    # rows are inner waves, columns are test waves
    total, right = np.empty((size, size, COMPLEX)), np.empty((size, size, COMPLEX))
    scales = np.empty(size)
    for parity in range(2):
        for j in range(size):
            magnetic = (lowest + j) % 2 == parity
            for i in range(size):
                even = (i + j) % 2 == 0
                own = _element(regular[j], inner[i], index, even, magnetic)
                other = _element(irregular[j], inner[i], index, even, magnetic)
                _put_complex(right, i, j, (negative(own[0]), negative(own[1])))
                outgoing = minus(own[0], other[1]), add(own[1], other[0])
                _put_complex(total, i, j, outgoing)
            scales[j] = _power_of_two(total[:, j])
            for i in range(size):
                for part in range(COMPLEX):
                    total[i, j, part] *= scales[j]
        for i in range(size):
            scale = _power_of_two(total[i])
            for j in range(size):
                for part in range(COMPLEX):
                    total[i, j, part] *= scale
                    right[i, j, part] *= scale
        _eliminate(total, right)
        for j in range(size):  # the incident wave
            of = 1 if (lowest + j) % 2 == parity else 0
            for i in range(size):
                to = 1 if (lowest + i) % 2 == parity else 0
                out[to, lowest + i, of, lowest + j, 0] = right[j, i, 0] * scales[j]
                out[to, lowest + i, of, lowest + j, 1] = right[j, i, 2] * scales[j]
    return out
