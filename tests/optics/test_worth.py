"""What ray optics is worth: the table against waves, and what is said of a scene."""

import csv
import json
import math
from functools import partial

import numpy as np
import pytest

import tweezer
from tests.benchmarks.worth import FILE, by_waves, errors, force_of, places
from tests.reference.waves import Light, Sphere, force
from tweezer.optics import ray_optics_caveat, ray_optics_worth, worth_attributes
from tweezer.optics.worth import ERRORS, RATIOS

SPEED_OF_LIGHT = 299792458.0
N_M = 1.33
WAVELENGTH = 1.064 / N_M  # um, in the medium


def silica(**beam):
    return tweezer.load_scene("silica-1um").replace(beam=beam, optics={"theory": "rays"})


def with_aperture(aperture):
    return silica().replace(lens={"numerical_aperture": aperture})


# --- the waves themselves -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("waist", "diameter", "k_across", "k_along", "rest"),
    [
        (1, 0.5, 2.324, 0.426, 0.301),
        (1, 0.99, 3.795, 0.920, 0.192),
        (1, 5.0, 0.455, 0.146, 0.038),
        (10, 2.0, 0.932, 0.549, 0.0686),
    ],
)
def test_waves_as_another_program_has_them(waist, diameter, k_across, k_along, rest):
    """fatcuda 0.6.5, extrapolated in its grid: polystyrene, NA 1.2; pN/um per mW, um."""
    light = Light(1.2 / N_M, waist)
    sphere = Sphere(diameter / 2 / WAVELENGTH, 1.59 / N_M)
    unit = 1e-3 * N_M / SPEED_OF_LIGHT * 1e12 / WAVELENGTH
    step = 1e-4
    at = np.array([rest / WAVELENGTH - step, rest / WAVELENGTH + step])
    across = force(light, sphere, [step], [at.mean()])[0, 0]
    along = force(light, sphere, [0, 0], at)[:, 2]
    assert -unit * across / step == pytest.approx(k_across, rel=2e-3)
    assert -unit * np.diff(along)[0] / (2 * step) == pytest.approx(k_along, rel=4e-3)


def test_waves_of_equal_indices_do_nothing():
    assert np.abs(force(Light(0.9, 1), Sphere(0.6, 1.0), [0.1, 0.3], [0.2, -0.1])).max() < 1e-14


def test_the_table_is_what_waves_give():
    """Ratios of two sizes at one aperture and index: rays, without a wavelength, drop out."""
    with FILE.open() as file:
        rows = list(csv.DictReader(file))
    light = Light(0.8, 1.0)
    case = {"index_ratio": "1.195", "aperture": f"{light.effective_aperture:.4g}"}
    for small, large in ((0.5, 1.0), (1.0, 2.0)):
        row, other = (
            next(row for row in rows if row.items() >= {**case, "wavelengths": f"{size:g}"}.items())
            for size in (small, large)
        )
        trap, other_trap = (
            by_waves(light, sphere, partial(force, light, sphere))
            for sphere in (Sphere(size / 2, 1.195) for size in (small, large))
        )
        for name in RATIOS:
            expected = getattr(trap, name) / getattr(other_trap, name)
            assert float(row[name]) / float(other[name]) == pytest.approx(expected, rel=0.012)


def test_the_errors_of_the_table_are_the_distance_to_waves():
    light, sphere = Light(0.65, 100.0), Sphere(1.0, 1.09)

    def waves(rho, z):
        return force(light, sphere, rho, z) * [1, 0, 1]  # unpolarised light pushes nowhere sideways

    rays = force_of(light, Sphere(1.0, 1.09), "rays")(*places())
    with FILE.open() as file:
        case = {"index_ratio": "1.09", "aperture": f"{light.effective_aperture:.4g}"}
        row = next(
            row
            for row in csv.DictReader(file)
            if row.items() >= {**case, "wavelengths": "2", "ray_trap": "1"}.items()
        )
    found = [float(row[name]) for name in ERRORS]
    assert found == pytest.approx(errors(waves, sphere.radius, rays), rel=0.01)


# --- what is said of a scene ----------------------------------------------------------------------


def test_known_ratios_lie_within_the_ranges():
    """Of silica, 1 um, NA 1.25, and polystyrene, NA 1.2: waves and rays by other programs."""
    worth = ray_optics_worth(silica())
    for found, ratio in (
        (worth.stiffness_across, 104.6 / 63.9),
        (worth.stiffness_along, 34.5 / 23.0),
        (worth.escape_across, 32.5 / 70.2),
    ):
        assert found[0] <= ratio <= found[1] < 4 * found[0]
    scene = with_aperture(1.2).replace(medium={"refractive_index": N_M})
    for diameter, across, along in ((0.5, 0.47, 0.27), (1.95, 0.97, 0.98), (5.0, 0.92, 0.93)):
        bead = {"diameter": diameter * 1e-6, "refractive_index": 1.59}
        worth = ray_optics_worth(scene.replace(bead=bead))
        assert worth.stiffness_across[0] <= across <= worth.stiffness_across[1]
        assert worth.stiffness_along[0] <= along <= worth.stiffness_along[1]


def test_a_trap_that_waves_do_not_have_is_not_to_be_trusted():
    """The focal spot of a weak lens is wider than the bead."""
    worth = ray_optics_worth(with_aperture(0.3))
    assert worth.focal_spot > 2e-6
    assert worth.trapped == 0
    assert worth.stiffness_across is None
    assert not worth.trusted
    assert "wave optics has none" in ray_optics_caveat(with_aperture(0.3))
    half = ray_optics_worth(with_aperture(0.6))
    assert half.escape_across[1] < 0.5
    assert not half.trusted


@pytest.mark.parametrize(("diameter", "trusted"), [(0.4, False), (0.75, False), (0.85, True)])
def test_a_bead_below_a_wavelength_is_not_to_be_trusted(diameter, trusted):
    worth = ray_optics_worth(silica().replace(bead={"diameter": diameter * 1e-6}))
    assert worth.wavelengths == pytest.approx(diameter * 1.326 / 1.064)
    assert worth.trusted == trusted
    assert ("not to be trusted" in worth.in_short) == (not trusted)


def test_the_focal_spot_is_the_waist_of_a_gaussian_beam():
    """2 lambda/(pi NA): of a beam much narrower than the pupil, NA = n_m w/f."""
    scene = with_aperture(1.0).replace(beam={"waist": "0.1 mm"})
    waist = 1064e-9 / (math.pi * 1.0 * 0.1 / 2.5)
    assert ray_optics_worth(scene).focal_spot == pytest.approx(2 * waist, rel=1e-6)
    even = 2 * 1064e-9 / (math.pi * 1.25)
    assert ray_optics_worth(silica(profile="uniform")).focal_spot == pytest.approx(even, rel=1e-3)


def test_what_was_not_compared_is_said():
    diamond = silica().replace(bead={"refractive_index": 2.6})
    assert ray_optics_worth(diamond).force_inside is None
    assert "was not compared" in ray_optics_caveat(diamond)
    dark = silica(power_through_pupil=0)
    assert ray_optics_worth(dark) is None
    assert worth_attributes(dark) == {
        "theory": "rays", "theory_reason": "no light", "ray_optics_caveat": "",
        "ray_optics_worth": "null",
    }  # fmt: skip


def test_nothing_is_said_of_rays_where_the_light_is_waves():
    scene = tweezer.load_scene("silica-1um")
    assert (ray_optics_worth(scene), ray_optics_caveat(scene)) == (None, None)
    assert worth_attributes(scene) == {
        "theory": "waves", "theory_reason": scene.theory_reason, "ray_optics_caveat": "",
        "ray_optics_worth": "null",
    }  # fmt: skip


def test_a_bubble_that_rays_do_not_trap_has_errors_of_its_force_alone():
    bubble = silica().replace(bead={"refractive_index": 1.0})
    worth = ray_optics_worth(bubble)
    assert worth.trapped is None
    assert worth.stiffness_across is None
    assert 0 < worth.force_inside[0] < worth.force_inside[1] < 1
    caveat = ray_optics_caveat(bubble)
    assert f"wrong by up to {100 * worth.force_inside[1]:.2g} % with the focus inside" in caveat
    assert "stiffness" not in caveat


def test_the_way_out_is_said():
    exact = "optics.theory = 'waves' is exact"
    assert ray_optics_caveat(silica()).endswith(exact)
    assert ray_optics_caveat(silica(polarisation="averaged-reflectance")).endswith(
        "beam.polarisation = 'averaged-reflectance' requires ray optics"
    )
    large = silica().replace(bead={"diameter": 40e-6}, optics={"theory": "auto"})
    large = large.replace(start={"position": [0.0, 0.0, 0.0]})
    assert f"{exact}; 'auto' selected ray optics because the size" in ray_optics_caveat(large)


def test_waves_are_not_advised_where_they_are_not_computed():
    """Wave optics ends 2000/k from the focus, and at a bead radius of 160/k."""
    exact = "optics.theory = 'waves' is exact"
    ends = 2000 * WAVELENGTH / (2 * math.pi) * 1e-6 * N_M / 1.326
    near, far = (silica().replace(simulation={"loss_distance": s * ends}) for s in (0.99, 1.01))
    assert ray_optics_caveat(near).endswith(exact)
    assert ray_optics_caveat(far).endswith(
        f"wave optics is available up to {ends:.3g} m from the focus, less than "
        "simulation.loss_distance"
    )
    with pytest.raises(tweezer.SceneError, match=r"set a smaller .*_distance or optics\.th"):
        tweezer.optical_force(far.replace(optics={"theory": "waves"}), np.zeros(3))
    large = silica().replace(bead={"diameter": 2.02 * 0.08 * ends})
    large = large.replace(simulation={"loss_distance": 0.9 * ends})
    assert ray_optics_caveat(large).endswith(f"for beads up to {0.08 * ends:.3g} m in radius")
    # a ball over a weak lens floats far from the focus
    ball = with_aperture(0.02).replace(bead={"diameter": "20 um"})
    assert f"{exact}, and available up to {ends:.3g} m from the focus" in ray_optics_caveat(ball)


def test_the_exact_force_has_no_caveat():
    scene = tweezer.load_scene("silica-1um")
    assert scene.theory == "waves"
    assert ray_optics_worth(scene) is None
    assert ray_optics_caveat(scene) is None


def test_attributes_hold_the_numbers():
    attributes = worth_attributes(silica())
    assert attributes["ray_optics_caveat"] == ray_optics_caveat(silica())
    worth = json.loads(attributes["ray_optics_worth"])
    assert tuple(worth["stiffness_across"]) == ray_optics_worth(silica()).stiffness_across
