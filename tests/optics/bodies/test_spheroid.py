"""T-matrices of spheroids against point matching, closed forms and published numbers.

The vector spherical waves are those of `tests.optics.bodies.maxwell`, at any radius and index:
M = z_l(kr) X_lm and N = curl M/k.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.integrate import quad
from scipy.special import sph_harm_y_all, spherical_jn, spherical_yn

import tweezer
from tests.optics.bodies.maxwell import plane_waves
from tweezer.optics.bodies.spheroid import spheroid_t_matrix
from tweezer.optics.bodies.t_matrix import modes_up_to, sphere_t_matrix
from tweezer.optics.waves.sphere import mie_coefficients
from tweezer.values.constants import speed_of_light

WATER = 1.33
WAVENUMBER = 2 * np.pi * WATER / 1.064e-6
POLYSTYRENE, SILICA, GOLD = 1.57 / WATER, 1.45 / WATER, (0.26 + 6.97j) / WATER
ABSORBING = (1.57 + 0.05j) / WATER
UM = 1e-6


def of(diameter, length, index=POLYSTYRENE, **given):
    """T-matrix of a spheroid in water; lengths in um."""
    across, along = diameter / 2 * UM, length / 2 * UM
    return spheroid_t_matrix(across, along, complex(index), WAVENUMBER, WATER, **given)


def spherical_waves(degree, m, x, theta, index=1.0, *, outgoing=False):
    """Return E and -i curl E/k of the waves N and M at phi = 0, (2 types, degrees, 2, 3, points).

    The components are along e_r, e_theta and e_phi. `x` is k r outside the body.
    """
    l = np.arange(max(abs(m), 1), degree + 1)[:, None]
    z = index * x
    value, slope = spherical_jn(l, z), spherical_jn(l, z, derivative=True)
    if outgoing:
        value = value + 1j * spherical_yn(l, z)
        slope = slope + 1j * spherical_yn(l, z, derivative=True)
    harmonics, slopes = sph_harm_y_all(degree, degree, theta, 0.0, diff_n=1)
    Y, along = harmonics[l[:, 0], m], slopes[l[:, 0], m][..., 0]
    norm = np.sqrt(l * (l + 1.0))
    X_theta, X_phi = -m * Y / np.sin(theta) / norm, -1j * along / norm
    M = np.stack([0 * X_phi, value * X_theta, value * X_phi], 1)
    both = value / z + slope
    N = np.stack([1j * norm * value * Y / z, -both * X_phi, both * X_theta], 1)
    return np.array([np.stack([N, -1j * index * M], 1), np.stack([M, -1j * index * N], 1)])


def matched_points(across, along, index, m, degree, kept):
    """Return T of one order by matching the tangential fields at points of a spheroid.

    The electric and magnetic amplitudes of the outgoing waves and of the waves inside minimise the
    squares of the mismatch. `across` and `along` are k times the semi-axes. The rows and columns
    are the types, electric first, and the degrees up to `kept`.
    """
    u, weight = leggauss(3 * degree)
    theta = np.arccos(u)
    sin, cos = np.sin(theta), np.cos(theta)
    x = 1 / np.sqrt((sin / across) ** 2 + (cos / along) ** 2)
    normal = np.stack([x * sin / across**2, x * cos / along**2])
    normal /= np.linalg.norm(normal, axis=0)
    # the meridian's tangent, by e_r and e_theta
    tangent = (normal[1] * sin - normal[0] * cos, normal[1] * cos + normal[0] * sin)

    def tangential(waves):
        along_meridian = tangent[0] * waves[..., 0, :] + tangent[1] * waves[..., 1, :]
        both = np.stack([along_meridian, waves[..., 2, :]], -1) * np.sqrt(weight)[:, None]
        return np.moveaxis(both, 2, -1).reshape(2 * waves.shape[1], -1).T

    outgoing = tangential(spherical_waves(degree, m, x, theta, outgoing=True))
    inside = tangential(spherical_waves(degree, m, x, theta, index))
    incident = tangential(spherical_waves(degree, m, x, theta))
    system = np.concatenate([outgoing, -inside], axis=1)
    scales = np.linalg.norm(system, axis=0)
    found = np.linalg.lstsq(system / scales, -incident, rcond=1e-17)[0] / scales[:, None]
    count = outgoing.shape[1] // 2
    few = kept + 1 - max(abs(m), 1)
    at = np.r_[:few, count : count + few]
    return found[np.ix_(at, at)]


def of_order(T, m, kept):
    """Return T of one order between electric and magnetic waves, like `matched_points`."""
    helicities = T.matrix.reshape(len(T.matrix) // 2, 2, -1, 2)
    electric = np.array([[1, 1], [1, -1]]) / np.sqrt(2)
    mixed = np.einsum("ea,iajb,fb->eifj", electric, helicities, electric)
    l, orders, _ = T.modes[::2].T
    at = np.flatnonzero((orders == m) & (l <= kept))
    return mixed[:, at][:, :, :, at].reshape(2 * len(at), -1)


@pytest.mark.parametrize(
    ("diameter", "length", "index"),
    [(0.5, 0.6, POLYSTYRENE), (0.6, 0.5, POLYSTYRENE), (0.5, 0.6, ABSORBING), (0.1, 0.12, GOLD)],
    ids=["prolate", "oblate", "absorbing", "gold"],
)  # fmt: skip
def test_t_matrix_agrees_with_point_matching(diameter, length, index):
    """Electric-magnetic coupling has another sign for the other sign of m."""
    T = of(diameter, length, index)
    across, along = WAVENUMBER * UM * diameter / 2, WAVENUMBER * UM * length / 2
    for m in (-2, 0, 1, 3):
        expected = matched_points(across, along, index, m, 26, 5)
        found = of_order(T, m, 5)
        assert np.abs(found - expected).max() < 3e-13
        few = len(found) // 2
        coupling = np.abs(found[:few, few:]).max()
        assert (coupling > 1e-4 * np.abs(found).max()) == (m != 0)


def shape_factors(across, along):
    """Return the depolarisation factors across and along the axis, from their integral."""

    def integrand(s):
        return across**2 * along / 2 / ((s + along**2) ** 1.5 * (s + across**2))

    along_axis = quad(integrand, 0, np.inf, epsabs=0, epsrel=1e-12)[0]
    return (1 - along_axis) / 2, along_axis


def polarisability(across, along, index):
    """Return the static polarisability across and along the axis, in units of the volume."""
    return [
        (index**2 - 1) / (1 + factor * (index**2 - 1)) for factor in shape_factors(across, along)
    ]


@pytest.mark.parametrize("index", [POLYSTYRENE, GOLD])
@pytest.mark.parametrize("aspect", [0.4, 2.5])
def test_small_spheroid_has_the_polarisability_of_statics(aspect, index):
    """The electric dipole is i k^3 alpha/(6 pi), and the relative difference is of order x^2."""
    for diameter in (0.002, 0.004):
        T = of(diameter, aspect * diameter, index)
        volume = np.pi / 6 * diameter**3 * aspect * UM**3
        x = WAVENUMBER * max(1, aspect) * diameter / 2 * UM
        across, along = polarisability(1, aspect, complex(index))
        for m, alpha in ((-1, across), (0, along), (1, across)):
            expected = 1j * WAVENUMBER**3 * volume * alpha / (6 * np.pi)
            found = of_order(T, m, 1)[0, 0]
            assert abs(found / expected - 1) < 4 * x**2 * abs(index) ** 2


def field_and_slopes(scene, position):
    """Return E, sqrt(W)/m, and dE_j/dx_i at a position, from plane waves."""
    k = 2 * np.pi * scene.medium.refractive_index / scene.beam.wavelength
    ((_, s, E),) = plane_waves(scene, k * np.linalg.norm(position))
    there = E * np.exp(1j * k * s @ position)[:, None]
    return there.sum(0), 1j * k * s.T @ there


@pytest.mark.filterwarnings("ignore:Knudsen number")
@pytest.mark.parametrize("aspect", [0.5, 2.0])
def test_force_and_torque_on_small_spheroid_agree_with_the_dipole(aspect):
    elliptic = {"polarisation": "linear", "jones": [[0.6, 0], [0.3, 0.74]]}
    diameter = 0.002
    x = WAVENUMBER * max(1, aspect) * diameter / 2 * UM
    scene = tweezer.load_scene("silica-1um").replace(
        optics={"theory": "waves", "tolerance": 1e-8}, beam=elliptic,
        bead={"shape": "spheroid", "diameter": diameter * UM, "length": aspect * diameter * UM},
    )  # fmt: skip
    position = np.array([0.2e-6, -0.1e-6, 0.3e-6])
    axis = np.array([0.48, 0.6, 0.64])
    index = scene.bead.index / scene.medium.refractive_index
    across, along = polarisability(1, aspect, index)
    volume = np.pi / 6 * diameter**3 * aspect * UM**3
    E, slopes = field_and_slopes(scene, position)
    alpha = volume * (across * np.eye(3) + (along - across) * np.outer(axis, axis)).real
    momentum = scene.medium.refractive_index / speed_of_light
    force = momentum * (slopes.conj() @ (alpha @ E)).real
    torque = momentum * np.cross(alpha @ E, E.conj()).real
    half = np.array([axis[0], axis[1], axis[2] + 1]) / np.linalg.norm([*axis[:2], axis[2] + 1])
    orientation = [half[2], -half[1], half[0], 0.0]
    found = tweezer.optical_force(scene, position, orientation)
    assert found == pytest.approx(force, abs=4 * x**2 * abs(force).max())
    found = tweezer.optical_torque(scene, position, orientation)
    assert found == pytest.approx(torque, abs=4 * x**2 * abs(torque).max())


@pytest.mark.parametrize("index", [POLYSTYRENE, ABSORBING, GOLD])
def test_spheroid_of_equal_axes_is_the_sphere(index):
    T = of(0.8, 0.8, index)
    a, b = mie_coefficients(((0.4 * UM, complex(index)),), WAVENUMBER, T.degree)
    sphere = sphere_t_matrix(a, b, WAVENUMBER, WATER, 0.4 * UM, lossless=complex(index).imag == 0)
    assert np.abs(T.change - sphere.change).max() < 1e-14
    assert (T.radius, T.lossless) == (sphere.radius, sphere.lossless)


def scattering_amplitudes(T, incident, scattered):
    """Return the amplitudes k S of waves scattered from one direction (theta, 0) to another.

    Rows are the scattered, columns the incident polarisation, along e_theta and e_phi. The far
    field is S E exp(ikr)/r.
    """
    degree = T.degree
    far = np.zeros((2, len(T.matrix), 2), complex)
    l, m, helicity = T.modes.T
    for at, (theta, phi) in enumerate((incident, scattered)):
        Y, slopes = sph_harm_y_all(degree, degree, theta, phi, diff_n=1)
        norm = np.sqrt(l * (l + 1.0))
        X = np.stack([-m * Y[l, m] / np.sin(theta), -1j * slopes[l, m][:, 0]], 1) / norm[:, None]
        turned = np.stack([-X[:, 1], X[:, 0]], 1)  # e_r x X
        # h_l is (-i)^(l+1) exp(ikr)/kr far away, and curl is i k e_r x
        far[at] = (1j * turned + helicity[:, None] * X) / np.sqrt(2)
    # the plane wave E exp(ik s.r) is the sum of 4 pi i^l (X*.E) z_l X and of the like for N
    expansion = 4 * np.pi * (1j ** (l % 4))[:, None] * far[0].conj()
    leaving = (-1j) ** ((l + 1) % 4)
    return np.einsum("ia,i,ij,jb->ab", far[1], leaving, T.matrix, expansion)


def test_amplitudes_of_an_absorbing_oblate_spheroid_agree_with_published_ones():
    """Numbers from the tests of pytmatrix by J. Leinonen (GitHub, jleinonen/pytmatrix).

    They come from the code of M. Mishchenko, asked for a relative accuracy of 1e-3.
    """
    k, ratio = 2 * np.pi / 6.5, 1 / 0.6
    across = 2.0 * ratio ** (1 / 3)
    T = spheroid_t_matrix(across, across / ratio, 1.5 + 0.5j, k, 1.0)
    found = scattering_amplitudes(T, (np.pi / 2, 0), (np.pi / 2, np.pi)) / k
    expected = [
        [3.89338755e-02 - 2.43467777e-01j, 0],
        [0, -8.38637654e-02 + 3.10409912e-01j],
    ]
    assert found == pytest.approx(np.array(expected), abs=2e-5)


SHAPES = {
    "polystyrene, aspect 3": (2 / 3, 2.0, POLYSTYRENE),
    "polystyrene, aspect 1/3": (2.0, 2 / 3, POLYSTYRENE),
    "silica, aspect 2": (1.0, 2.0, SILICA),
    "silica, aspect 1/2": (1.6, 0.8, SILICA),
    "polystyrene, aspect 1.2": (0.5, 0.6, POLYSTYRENE),
    "gold, aspect 3": (0.1, 0.3, GOLD),
    "absorbing, aspect 1.5": (0.6, 0.9, ABSORBING),
}


@pytest.mark.parametrize(("diameter", "length", "index"), SHAPES.values(), ids=SHAPES.keys())
def test_certificates_and_stated_error(diameter, length, index):
    T = of(diameter, length, index)
    assert T.axial
    assert T.lossless is (complex(index).imag == 0)
    assert T.radius == max(diameter, length) / 2 * UM
    assert T.unitarity < 1e-13
    assert T.reciprocity < 1e-13
    assert T.error < 3e-11
    if not T.lossless:
        assert np.linalg.eigvalsh(T.change + T.change.conj().T).min() < -1e-3
    more = of(diameter, length, index, degree=T.degree + 8)
    # an element outside the smaller matrix is what the degree leaves out
    assert np.abs(T.change - more.cut(T.degree).change).max() <= T.error + more.error
    left_out = more.change.copy()
    left_out[: len(T.matrix), : len(T.matrix)] = 0
    assert np.abs(left_out).max() <= T.error


def test_stated_error_of_rough_truncations_exceeds_the_true_one(monkeypatch):
    exact = of(2 / 3, 2.0)
    for degree in (8, 11):
        monkeypatch.setattr("tweezer.optics.bodies.spheroid._EXTRA", (0, 2))
        rough = of(2 / 3, 2.0, degree=degree)
        error = np.abs(rough.change - exact.cut(degree).change).max()
        assert 1e-10 < error < rough.error < 0.2


def test_t_matrix_is_the_same_if_lengths_and_wavelength_scale():
    one, other = of(0.5, 0.8), spheroid_t_matrix(0.5, 0.8, complex(POLYSTYRENE),
                                                  WAVENUMBER * UM / 2, WATER)  # fmt: skip
    assert np.abs(one.change - other.change).max() < 1e-13
    assert np.array_equal(one.modes, modes_up_to(one.degree))
    assert math.isclose(other.radius, 0.8)
