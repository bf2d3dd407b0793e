"""Resistance of the shapes of a scene: three routes to one body, and numbers that are given."""

import numpy as np
import pytest
from scipy.constants import Boltzmann

import tweezer
from tests.fluid.resistance.test_surfaces import globe
from tweezer.fluid.resistance import of_scene, triangles
from tweezer.fluid.resistance.ellipsoid import ellipsoid_resistance
from tweezer.fluid.resistance.rings import arc, line, revolved_resistance

SCENE = tweezer.load_scene("silica-1um")
UM = 1e-6


def scene_of(shape, **keys):
    return SCENE.replace(bead={"shape": shape, "material": None, "density": 2000, **keys})


def enlarged(scene):
    """Factors of the drag of an inscribed body that is enlarged to the ellipsoid's volume."""
    factor = (4 / 3 * np.pi * 1.5 * UM**3 / scene.body.volume) ** (1 / 3)
    return np.repeat([factor, factor**3], 3)


def test_three_routes_to_an_ellipsoid(tmp_path, monkeypatch):
    """Elliptic integrals, rings about a profile, and triangles of a file."""
    pytest.importorskip("trimesh")
    monkeypatch.setattr(triangles, "_LARGEST", 640)
    exact = tweezer.resistance(scene_of("ellipsoid", semi_axes=[UM, UM, 1.5 * UM]))
    assert exact.method == "Carlson's elliptic integrals"
    angle = np.linspace(0, np.pi, 21)
    points = np.stack([np.sin(angle), 3 - 1.5 * np.cos(angle)], axis=1)
    points[[0, -1], 0] = 0
    scene = scene_of("profile", points=points * UM)
    by_rings = tweezer.resistance(scene)
    assert by_rings.error < 1e-4
    np.testing.assert_allclose(
        np.diag(by_rings.matrix) * enlarged(scene), np.diag(exact.matrix), rtol=2e-3
    )

    corners = np.add(globe(2, (1, 1, 1.5)), [4, 5, -6])
    outwards = np.linalg.det(corners - [4, 5, -6]) > 0
    corners[~outwards] = corners[~outwards, ::-1]
    lines = [f"v {x} {y} {z}" for x, y, z in corners.reshape(-1, 3)]
    lines += [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(len(corners))]
    (tmp_path / "globe.obj").write_text("\n".join(lines), encoding="utf-8")
    scene = scene_of("mesh", file=str(tmp_path / "globe.obj"), scale=UM)
    by_triangles = tweezer.resistance(scene)
    assert 0 < by_triangles.error < 5e-3
    np.testing.assert_allclose(
        np.diag(by_triangles.matrix) * enlarged(scene), np.diag(exact.matrix), rtol=4e-3
    )


def test_cylinder_and_capsule_of_a_scene():
    mu = SCENE.medium.viscosity
    rod = tweezer.resistance(scene_of("cylinder", diameter=UM, length=2 * UM))
    # K_par, K_perp, Q_perp and Q_par of L/2a = 2
    expected = [27.84670, 31.22770, 144.1318, 65.6373]
    found = np.diag(rod.matrix)[[2, 0, 3, 5]] / (mu * np.array([0.5, 0.5, 0.125, 0.125]))
    np.testing.assert_allclose(found / [1e-6, 1e-6, 1e-18, 1e-18], expected, rtol=2e-6)
    assert rod.method == "single layer of rings"
    capsule = tweezer.resistance(scene_of("capsule", diameter=UM, length=2 * UM))
    curve = [arc(1, (1, 1), 0, np.pi / 2), line((1, 1), (1, -1)), arc(-1, (1, 1), np.pi / 2, np.pi)]
    expected = np.diag(revolved_resistance(curve, mu)[0]) * np.repeat([0.5e-6, 0.125e-18], 3)
    np.testing.assert_allclose(np.diag(capsule.matrix), expected, rtol=1e-12)


def test_resistance_is_computed_once(monkeypatch):
    scene = scene_of("capsule", diameter=UM, length=1.7 * UM)
    first = tweezer.resistance(scene)
    monkeypatch.setattr(of_scene, "at", lambda place: pytest.fail("computed again"))
    again = tweezer.resistance(scene.replace(beam={"power_through_pupil": "1 mW"}))
    np.testing.assert_array_equal(again.matrix, first.matrix)


# --- given ------------------------------------------------------------------------------------


def cone():
    """A body whose centre of mobility is not its centre of mass, turned to no axis of its frame."""
    found = tweezer.resistance(scene_of("profile", points=[[0, 0], [UM, 0], [0, 2 * UM]]))
    assert abs(found.centre_of_mobility[2]) > 0.01 * UM
    return found


def given(**numbers):
    own = {"mass": "1 pg", "volume": "1 um^3", "inertia": [1e-27] * 3, **numbers}
    return SCENE.replace(
        bead={"shape": "given", "diameter": UM, "material": None, "density": None, "given": own}
    )


def test_given_resistance_is_about_the_centre_of_mass():
    about_mass = cone()
    exact = tweezer.resistance(given(resistance=about_mass.matrix))
    np.testing.assert_allclose(exact.matrix, about_mass.matrix, rtol=1e-12, atol=1e-30)
    point = about_mass.centre_of_mobility
    elsewhere = given(resistance=about_mass.at(point).matrix, point=point)
    scale = np.sqrt(np.outer(*[np.diag(about_mass.matrix)] * 2))
    found = tweezer.resistance(elsewhere)
    assert (np.abs(found.matrix - about_mass.matrix) < 1e-12 * scale).all()
    assert found.method == "as given"
    thick = tweezer.resistance(given(resistance=about_mass.matrix, viscosity=1e-2))
    factor = SCENE.medium.viscosity / 1e-2
    np.testing.assert_allclose(thick.matrix, factor * about_mass.matrix, atol=1e-30)


def test_given_diffusion_is_in_centimetres():
    """At the centre of diffusion in water of 20 C, and used in another medium."""
    about_mass = cone()
    point = about_mass.centre_of_mobility
    mobility = np.linalg.inv(about_mass.at(point).matrix)
    diffusion = Boltzmann * 310.0 * mobility
    diffusion[:3, :3] *= 1e4  # m^2 in cm^2
    diffusion[:3, 3:] *= 1e2
    diffusion[3:, :3] *= 1e2
    scene = given(
        diffusion=diffusion, point=point, temperature=310.0, viscosity=SCENE.medium.viscosity
    ).replace(medium={"name": None, "viscosity": 3 * SCENE.medium.viscosity})
    scale = np.sqrt(np.outer(*[np.diag(about_mass.matrix)] * 2))
    found = tweezer.resistance(scene)
    assert (np.abs(found.matrix - 3 * about_mass.matrix) < 1e-11 * scale).all()


def test_ellipsoid_with_the_axis_z_has_the_light_of_the_spheroid():
    keys = {"refractive_index": 1.45}
    one = scene_of("ellipsoid", semi_axes=[0.3 * UM, 0.3 * UM, 0.5 * UM], **keys)
    other = scene_of("spheroid", diameter=0.6 * UM, length=UM, **keys)
    position = [0.1 * UM, 0, 0.2 * UM]
    for function in (tweezer.optical_force, tweezer.optical_torque):
        found = [function(scene, position, [0.9, 0.3, 0.1, 0.2]) for scene in (one, other)]
        np.testing.assert_array_equal(*found)
    drag = [tweezer.resistance(scene).matrix for scene in (one, other)]
    np.testing.assert_array_equal(*drag)


def test_light_on_a_cylinder_is_the_file_of_its_t_matrix(tmp_path):
    file = str(tmp_path / "rod.tmat.h5")
    spheroid = scene_of("spheroid", diameter=0.6 * UM, length=UM, refractive_index=1.45)
    tweezer.t_matrix(spheroid).save(file)
    rod = scene_of("cylinder", diameter=0.5 * UM, length=0.8 * UM, t_matrix=file)
    position = [0.1 * UM, 0, 0.2 * UM]
    np.testing.assert_allclose(
        tweezer.optical_force(rod, position), tweezer.optical_force(spheroid, position), rtol=1e-9
    )
    axes = ellipsoid_resistance((0.25 * UM, 0.25 * UM, 0.4 * UM), SCENE.medium.viscosity)
    assert (np.diag(tweezer.resistance(rod).matrix) > np.diag(axes)).all()
