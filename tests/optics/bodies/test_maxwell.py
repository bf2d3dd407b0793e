"""The stress-tensor reference for bodies against the sphere, whose force is known otherwise."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tweezer
from tests.optics.bodies.maxwell import Sphere, force_and_torque
from tests.reference import plane_waves

POSITION = np.array([0.31e-6, -0.2e-6, 0.4e-6])
ROTATION = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
ELLIPTIC = {"polarisation": "linear", "jones": [[0.6, 0], [0.3, 0.74]]}
GOLD = [0.26, 6.97]


def scene_with(beam, *, lens=None, bead=None):
    changes = {"optics": {"theory": "waves"}, "beam": beam, "lens": lens or {}, "bead": bead or {}}
    return tweezer.load_scene("silica-1um").replace(**changes)


def modes_up_to(degree):
    # another order than the package's
    return np.array([
        (l, m, helicity)
        for helicity in (-1, 1) for l in range(1, degree + 1) for m in range(l, -l - 1, -1)
    ])  # fmt: skip


def sphere(scene, degree=None):
    """T-matrix of the scene's bead from the Mie coefficients of the other reference."""
    k = 2 * math.pi * scene.medium.refractive_index / scene.beam.wavelength
    layers = tuple((radius, complex(index)) for radius, index in scene.bead.shells)
    a, b = plane_waves.Sphere(layers).coefficients(k, scene.medium.refractive_index)
    modes = modes_up_to(len(a))
    l, m, helicity = modes[:, None].T
    same = (l == l.T) & (m == m.T)
    n = modes[:, 0] - 1
    matrix = -np.where(helicity == helicity.T, a[n] + b[n], a[n] - b[n]) / 2 * same
    return SimpleNamespace(modes=modes, matrix=matrix)


def displaced(body, k, by, degree):
    """T-matrix of a body that is moved by `by` in its frame, for modes up to a degree.

    A mode about another origin is a sum of modes, and the factors are integrals over directions.
    """
    modes = modes_up_to(degree)
    whole = Sphere(modes)
    whole.size = math.inf  # fields far away
    theta = np.arccos(whole.frame[0, 2, :, 0])
    ones = np.ones(degree + 1)
    far = whole._waves(theta, ones, 1j * ones)[:, 0, :, :, None] * whole.turned[:, None, None, :]
    far = far * (1j ** -modes[:, 0])[:, None, None, None]
    phase = np.exp(-1j * k * np.einsum("i,itp->tp", by, whole.frame[0])) * whole.weight
    moved = np.einsum("natp,matp->nm", far.conj(), far * phase, optimize=True)
    kept = [np.flatnonzero((modes == row).all(1))[0] for row in body.modes]
    return SimpleNamespace(
        modes=modes, matrix=moved[:, kept] @ body.matrix @ moved[:, kept].conj().T
    )


@pytest.mark.parametrize(
    ("beam", "lens"),
    [
        (ELLIPTIC, {}),
        ({**ELLIPTIC, "power_through_pupil": None, "power": 0.02, "sigma": 0.8e-3}, {}),
        ({"polarisation": "circular", "vortex": 2}, {}),
        ({"polarisation": "unpolarised", "profile": "uniform", "sigma": None},
         {"map": "tan", "numerical_aperture": None, "focal_length": 2.2e-3}),
    ],
    ids=["elliptic", "total-power", "vortex", "uniform-tan"],
)  # fmt: skip
def test_force_on_sphere_agrees_with_multipoles(beam, lens):
    scene = scene_with(beam, lens=lens)
    force, torque, absorbed = force_and_torque(scene, sphere(scene), POSITION, ROTATION)
    expected = tweezer.optical_force(scene, POSITION)
    assert force == pytest.approx(expected, abs=1e-12 * abs(expected).max())
    assert abs(torque).max() < 1e-12 * scene.bead.radius * abs(expected).max()
    assert abs(absorbed) < 1e-14


def test_torque_and_absorbed_power_of_absorbing_sphere_agree_with_multipoles():
    bead = {"radius": 0.2e-6, "refractive_index": GOLD, "density": 19300}
    scene = scene_with(ELLIPTIC, bead=bead)
    body = sphere(scene)
    found = force_and_torque(scene, body, POSITION, ROTATION)
    expected = (
        tweezer.optical_force(scene, POSITION),
        tweezer.optical_torque(scene, POSITION),
        tweezer.absorbed_power(scene, POSITION),
    )
    for one, other in zip(found, expected, strict=True):
        assert one == pytest.approx(other, abs=1e-11 * np.abs(other).max())


def test_displaced_sphere_feels_the_force_of_the_sphere_and_its_moment():
    """All modes are coupled in this T-matrix, and the sphere is not at the body's origin."""
    scene = scene_with(ELLIPTIC, bead={"radius": 0.25e-6})
    k = 2 * math.pi * scene.medium.refractive_index / scene.beam.wavelength
    by = np.array([0.12e-6, 0.16e-6, -0.09e-6])
    body = displaced(sphere(scene), k, by, 14)
    force, torque, absorbed = force_and_torque(scene, body, POSITION, ROTATION)
    expected = tweezer.optical_force(scene, POSITION + ROTATION @ by)
    assert force == pytest.approx(expected, abs=1e-10 * abs(expected).max())
    moment = np.cross(ROTATION @ by, expected)
    assert torque == pytest.approx(moment, abs=1e-10 * abs(moment).max())
    assert abs(absorbed) < 1e-12


def test_result_does_not_change_with_more_plane_waves_and_points():
    scene = scene_with(ELLIPTIC)
    body = sphere(scene)
    rng = np.random.default_rng(3)
    body.matrix = body.matrix + 1e-3 * rng.normal(size=body.matrix.shape) / len(body.matrix)
    found = force_and_torque(scene, body, POSITION, ROTATION)
    finer = force_and_torque(scene, body, POSITION, ROTATION, finer=1.3)
    force, torque, absorbed = (
        np.abs(one - other).max() for one, other in zip(found, finer, strict=True)
    )
    size = abs(finer[0]).max()
    assert force < 1e-12 * size
    assert torque < 1e-12 * size * scene.bead.radius
    assert absorbed < 1e-13
