"""Added mass of ellipsoids, against closed forms and limits (H. Lamb, Hydrodynamics, 1932)."""

import math

import numpy as np
import pytest

import tweezer
from tweezer.dynamics.body import body_motion
from tweezer.fluid.added_mass import ellipsoid_added_mass

E = math.sqrt(0.75)
ALPHA = 2 * (1 - E**2) / E**3 * (math.atanh(E) - E)
#: Added mass over displaced mass of a prolate spheroid of aspect 2, along and across its axis
ALONG, ACROSS = ALPHA / (2 - ALPHA), (1 - ALPHA / 2) / (1 + ALPHA / 2)


def test_sphere_adds_half_the_displaced_mass():
    assert ellipsoid_added_mass((2e-6, 2e-6, 2e-6), 3.0) == pytest.approx([1.5] * 3 + [0] * 3)


def test_prolate_spheroid_of_aspect_two():
    """Elementary functions of the eccentricity in place of elliptic integrals (section 114)."""
    found = ellipsoid_added_mass((1.0, 1.0, 2.0), 1.0)
    np.testing.assert_allclose(found[:3], [ACROSS, ACROSS, ALONG], rtol=1e-14)
    # 0.240 of the moment of the fluid in it, by the table of section 115
    np.testing.assert_allclose(found[3:] / ((1 + 4) / 5), [0.240, 0.240, 0.0], atol=1e-3)


def test_disc():
    """8/3 rho a^3 along the axis, and 16/45 rho a^5 about a diameter."""
    thin = 1e-5
    found = ellipsoid_added_mass((1.0, 1.0, thin), 4 / 3 * math.pi * thin)
    assert found[2] == pytest.approx(8 / 3, rel=1e-4)
    np.testing.assert_allclose(found[3:], [16 / 45, 16 / 45, 0], rtol=1e-4, atol=1e-9)


def test_axes_that_are_nearly_equal_lose_no_digits():
    near = ellipsoid_added_mass((1.0, 1.0 + 3e-6, 2.0), 1.0)
    assert abs(near[5]) < 1e-11
    np.testing.assert_allclose(near[:5], ellipsoid_added_mass((1.0, 1.0, 2.0), 1.0)[:5], rtol=1e-5)


def test_spheroid_of_a_scene_moves_its_added_mass():
    scene = tweezer.load_scene("polystyrene-500nm").replace(
        bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"}
    )
    alone, more = (
        np.diag(body_motion(scene.replace(medium={"inertia": each})).inertia)
        for each in ("none", "added-mass")
    )
    displaced = scene.medium.density * scene.body.volume
    np.testing.assert_allclose((more - alone)[:3] / displaced, [ACROSS, ACROSS, ALONG], rtol=1e-9)
    assert (more - alone)[3] == pytest.approx(
        0.240 * displaced * (0.04 + 0.16) * 1e-12 / 5, rel=3e-3
    )


def test_cylinder_does_not_have_the_added_mass_of_a_spheroid():
    scene = tweezer.load_scene("polystyrene-500nm").replace(
        bead={"shape": "cylinder", "diameter": "0.4 um", "length": "0.8 um"},
        medium={"inertia": "added-mass"},
    )
    with pytest.raises(tweezer.SceneError, match=r"is known for spheres, spheroids and ellipsoids"):
        body_motion(scene)


def test_cluster_with_added_mass_is_refused_in_one_line():
    description = tweezer.load_scene("polystyrene-500nm").model_dump(exclude_none=True)
    index = description["bead"]["refractive_index"]
    description["bead"] = {
        "shape": "spheres", "density": "1050 kg/m^3",
        "spheres": [
            {"radius": "0.2 um", "refractive_index": index, "position": [0, 0, z]}
            for z in ("-0.2 um", "0.2 um")
        ],
    }  # fmt: skip
    description["medium"]["inertia"] = "added-mass"
    with pytest.raises(tweezer.SceneError, match=r"medium\.inertia = 'added-mass': is known"):
        body_motion(tweezer.load_scene(description))
