"""Temperatures in the light of a scene, and drag and thermal motion of a hot bead."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import BSpline

import tweezer
from tweezer.dynamics import bound_once
from tweezer.optics.heat import effective_distance, heated, hot_motion
from tweezer.scene.heating import water_absorption
from tweezer.scene.water import water
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError

WATER = {"name": "water", "temperature": "20 degC"}
SILICA = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
OWN = ("refractive_index", "density", "viscosity")


def scene(heat=None, **changes):
    """A 1 um silica bead in water at 20 degC, with other keys by section."""
    data = {key: dict(part) if isinstance(part, dict) else part for key, part in SILICA.items()}
    data["medium"] = dict(WATER)
    for section, keys in changes.items():
        data[section] = {**data.get(section, {}), **keys}
    return tweezer.load_scene(data if heat is None else {**data, "heat": heat})


def viscosity(temperature):
    return water(temperature).viscosity


def least_dissipation(rise, cold=293.15):
    """Drag over 6 pi r mu(cold), and mean of (T - cold)/rise, by splines over ln x to x = e^9.

    The flow has v = g(x) cos(theta) along x, and a component across x by which it has no sources.
    """
    degree, end = 4, 9.0
    knots = np.concatenate([[0] * degree, np.linspace(0, end, 120), [end] * degree])
    nodes, weights = np.polynomial.legendre.leggauss(5)
    width = np.diff(np.linspace(0, end, 120))[0]
    s = (np.arange(119)[:, None] + (nodes + 1) / 2).ravel() * width
    weights = np.tile(weights, 119) * width / 2
    splines = BSpline(knots, np.eye(len(knots) - degree - 1), degree)
    first, second = (splines.derivative(n)(s).T for n in (1, 2))
    x = np.exp(s)
    slope, curvature = first / x, (second - first) / x**2
    mu = np.array([viscosity(cold + rise / each) for each in x]) / viscosity(cold)
    per_s = weights * x * x**2 * mu / 6  # dx = x ds; 4 pi and 8 pi/3 over 6 pi
    shear = slope + x * curvature / 2
    matrix = (slope * 4 * per_s) @ slope.T + (shear * 8 / 3 * per_s) @ shear.T
    # g = 1 and g' = 0 on the sphere, and g = 0 far away
    fixed, free = [0, 1], range(2, len(first) - 1)
    flow = np.zeros(len(first))
    flow[fixed] = 1.0
    flow[list(free)] = -np.linalg.solve(
        matrix[np.ix_(free, free)], matrix[np.ix_(free, fixed)].sum(axis=1)
    )
    parts = 4 * (flow @ slope) ** 2 + 8 / 3 * (flow @ shear) ** 2
    drag = float(parts @ per_s)
    return drag, float(parts * per_s @ (1 / x)) / drag


@pytest.mark.parametrize(
    ("rise", "drag", "noise"),
    [(1, 0.98988, 0.4179), (20, 0.82501, 0.4388), (75, 0.53564, 0.4770)],
)
def test_hot_bead_has_the_drag_and_temperature_of_least_dissipation(rise, drag, noise):
    found, _, excess = hot_motion(viscosity, 293.15, rise)
    assert [found, excess / rise] == pytest.approx([drag, noise], abs=6e-5)
    # the far end of the splines, at 8000 radii, adds 3/(2 x) to the drag
    assert [found, excess / rise] == pytest.approx(least_dissipation(rise), rel=1e-3)


def test_rotational_drag_of_a_hot_bead_follows_from_its_torque():
    """The torque 8 pi r^3 mu x^4 (-dw/dx)/3 is the same at every distance x."""
    rise = 40.0
    turned = quad(lambda u: 3 * u**2 / viscosity(293.15 + rise * u), 0, 1)[0]
    expected = 1 / (turned * viscosity(293.15))
    assert hot_motion(viscosity, 293.15, rise)[1] == pytest.approx(expected, rel=1e-9)


def by_images(below, above, wavelength, many=4000):
    """Integral over a line of sources between two cold glasses, of 1/distance minus images."""
    height, cut = below + above, wavelength / (2 * math.pi)
    n = np.arange(-many, many + 1)

    def at(z):
        real = np.abs(2 * n * height + z)
        image = np.abs(2 * n * height - 2 * below - z)
        return float((1 / real - 1 / image).sum())

    parts = [(-below, -cut), (cut, above)]
    return sum(quad(at, *part, limit=200)[0] for part in parts)


@pytest.mark.parametrize(("below", "above"), [(10e-6, 90e-6), (25e-6, 25e-6), (10e-6, 0.01)])
def test_water_between_glasses_has_the_temperature_of_all_images(below, above):
    wavelength = 1.064e-6
    found = 2 * math.log(2 * math.pi * effective_distance(below, above) / wavelength)
    assert found == pytest.approx(by_images(below, above, wavelength), rel=5e-3)


def test_light_heats_water_by_the_published_amount():
    """1.54 K for 100 mW, 10 um from a glass, with 14.2 1/m and 0.60 W/(m K)."""
    keys = {"absorption": 14.2, "conductivity": 0.6, "distance": "10 um"}
    warm = scene(keys, beam={"power_through_pupil": 0.1, "power": None})
    found = heated(warm)
    assert found.heating.water == pytest.approx(1.54, abs=5e-3)
    assert found.medium.viscosity == pytest.approx(viscosity(293.15 + found.heating.water))
    assert found.medium.temperature == 293.15
    cell = {**keys, "distance": None}
    walls = {"position": -10e-6, "opposite": 90e-6}
    between = heated(scene(cell, beam={"power_through_pupil": 0.1}, wall=walls))
    assert between.heating.water == pytest.approx(1.485, abs=5e-3)


@pytest.mark.parametrize(("wavelength", "published"), [(0.8e-6, 1.96), (0.975e-6, 44.9)])
def test_absorption_of_water_agrees_with_hale_and_querry(wavelength, published):
    assert water_absorption(wavelength) == pytest.approx(published, rel=0.1)
    assert water_absorption(0.532e-6) == pytest.approx(0.0446, rel=0.1)  # Pope and Fry (1997)


def test_absorbing_bead_is_warmer_by_its_absorbed_power():
    keys = {"light": False, "conductivity": 0.6}
    dark = {"refractive_index": "1.45+0.0002j"}
    hot = scene(keys, bead=dark)
    place = list(tweezer.characterise(scene(bead=dark)).equilibrium.position)
    absorbed = float(tweezer.absorbed_power(scene(bead=dark), place))
    expected = absorbed / (4 * math.pi * 0.6 * 0.5e-6)
    assert expected > 10
    found = tweezer.medium(hot)
    rise = found.temperature_of_bead - 293.15
    assert rise == pytest.approx(expected, rel=1e-6)
    assert found.temperature_of_bead_error == pytest.approx(0.1 * rise)
    # a wall that conducts heat takes r/2h; exactly, a sum over all images of the bead
    beside = heated(scene(keys, bead=dark, wall={"position": -3e-6}))
    height = (place[2] + 3e-6) / 0.5e-6
    alpha = math.acosh(height)
    images = sum(1 / math.sinh(n * alpha) for n in range(1, 40))
    exact = expected / (math.sinh(alpha) * images)
    assert beside.heating.bead == pytest.approx(expected * (1 - 1 / (2 * height)), rel=1e-6)
    assert abs(beside.heating.bead / exact - 1) < 1 / (2 * height) ** 2


def test_hot_bead_moves_like_one_in_a_medium_of_its_drag_and_temperature():
    """The positions equal those in a scene whose medium is given by numbers, up to rounding."""
    settings = {
        "forces": {"brownian": True},
        "simulation": {"duration": 2e-4, "samples": 5, "model": "overdamped"},
    }
    hot = scene({"light": "20 K/W", "bead": "400 K/W"}, **settings)
    warm, rise = 0.05 * 20, 0.05 * 400
    drag, _, noise = hot_motion(viscosity, 293.15 + warm, rise)
    about = water(293.15 + warm, 1.064e-6)
    numbers = {
        "name": None, "viscosity": drag * about.viscosity, "density": about.density,
        "refractive_index": about.refractive_index, "temperature": 293.15 + warm + noise,
    }  # fmt: skip
    cold = scene(**settings, medium=numbers)
    runs = [tweezer.simulate(each, seed=3).position.values for each in (hot, cold)]
    assert runs[0] == pytest.approx(runs[1], rel=1e-9)
    assert tweezer.medium(hot).effective_temperature == pytest.approx(293.15 + warm + noise)
    traps = [tweezer.characterise(each) for each in (hot, cold)]
    assert traps[0].escapes[0].energy_kT == pytest.approx(traps[1].escapes[0].energy_kT, rel=1e-9)
    assert traps[0].corner_frequencies == pytest.approx(traps[1].corner_frequencies, rel=1e-9)
    assert "medium by 1 K and bead by 20 K" in str(traps[0])


def test_stationary_variance_is_that_of_the_effective_temperature():
    """D/kappa of the step's linear motion about the equilibrium."""
    from tweezer.dynamics.thermal import Linearised

    hot = scene({"light": False, "bead": "1000 K/W"}, forces={"brownian": True})
    problem = bound_once(hot).decided(simulation={"model": "overdamped", "method": "heun"})
    motion = Linearised.of(problem)
    stiffness = np.diag(problem.equilibrium.stiffness)
    temperature = tweezer.medium(hot).effective_temperature
    assert temperature - 293.15 == pytest.approx(50 * 0.4627, abs=0.01)
    variance = motion.diffusion[:3] / motion.kappa[:3]
    assert variance == pytest.approx(Boltzmann * temperature / stiffness, rel=1e-12)


def test_hot_bead_in_a_rarefied_gas_moves_between_both_temperatures():
    """A bead of 500 K in a gas of 300 K moves as at 367 K by Millen et al. (2014), with 8 % more
    drag. Kinetic theory gives 366 K.
    """
    gas = {"name": "air", "pressure": "1 Pa", "temperature": 300.0}
    data = {"lens": {"numerical_aperture": 0.8}, "medium": gas}
    hot = scene({"bead": "4000 K/W"}, **data)
    found, cold = tweezer.medium(hot), tweezer.medium(scene(**data))
    assert found.temperature_of_bead == pytest.approx(500)
    assert found.effective_temperature == pytest.approx(367, rel=3e-3)
    assert found.effective_temperature == pytest.approx(366.358, abs=0.01)
    assert found.drag / cold.drag == pytest.approx(1.0821, abs=1e-4)
    assert 0.1 * 66 < found.effective_temperature_error < 0.2 * 66


def test_scene_without_heat_is_returned_as_it_is():
    cold = scene()
    assert heated(cold) is cold
    assert "heat" not in cold.model_dump(exclude_none=True)
    assert math.isnan(tweezer.medium("silica-1um").viscosity_error)
    assert tweezer.medium(cold).effective_temperature == 293.15


def test_heated_scene_is_saved_as_given():
    given = scene({"light": "15 K/W"})
    hot = heated(given)
    assert hot.medium.viscosity < given.medium.viscosity
    assert hot.model_dump_json() == given.model_dump_json()
    assert heated(hot) is hot
    assert heated(hot.replace(beam={"power_through_pupil": 0.1})).heating.water == 1.5


ABSORBING = {"bead": {"refractive_index": "1.45+0.0002j"}}


@pytest.mark.parametrize(
    ("heat", "changes", "said"),
    [
        ({"light": "3 K"}, {}, "heat.light = '3 K': must be true, false, or a rise"),
        ({"bead": "yes"}, {}, "heat.bead = 'yes': must be true, false, or a rise"),
        ({"light": True}, {}, "heat.distance: missing"),
        ({"distance": "1 um"}, {}, "heat.distance: the focus is"),
        ({"distance": 1e-5}, {"beam": {"wavelength": "1.2 um"}}, "beam.wavelength = 1.2e-06: the"),
        ({}, {"medium": {"name": "ethanol"}}, "heat.absorption: missing"),
        ({"absorption": 5}, {"medium": {"name": "ethanol"}}, "heat.conductivity: missing"),
        ({"light": "1 K/W"}, {"medium": {"viscosity": 1e-3}}, "heat: requires a viscosity"),
        ({"light": "1 K/W"}, {"beam": {"modulation": {"kind": "sine", "depth": 0.1,
                                                      "frequency": 10}}}, "constant power"),
        ({"bead": "9 K/W", "light": False}, {"forces": {"brownian": True,
                                                        "brownian_torque": True}}, "rotation"),
        ({"bead": "9 K/W"}, {"medium": {"name": "air", "pressure": "1 bar"},
                             "lens": {"numerical_aperture": 0.8}}, "at least 10"),
        ({}, {**ABSORBING, "medium": {"name": "air", "pressure": "1 Pa"},
              "lens": {"numerical_aperture": 0.8}}, "cooling of a bead in a gas"),
    ],
)  # fmt: skip
def test_heat_that_is_not_computed_is_refused_in_one_line(heat, changes, said):
    with pytest.raises(SceneError) as caught:
        scene(heat, **changes)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_water_that_boils_is_refused():
    with pytest.raises(SceneError, match=r"water to 393\.1 K; must be at most 373\.12 K"):
        tweezer.medium(scene({"light": False, "bead": "2000 K/W"}))


def test_commands_that_change_the_power_refuse_heat():
    hot = scene({"light": "15 K/W"})
    with pytest.raises(SceneError, match="remove"):
        tweezer.least_power(hot)
    with pytest.raises(SceneError, match="remove"):
        tweezer.optimise(hot, "kx")


def test_calibration_of_a_run_uses_temperature_and_drag_of_the_hot_bead():
    hot = scene(
        {"light": "20 K/W", "bead": "600 K/W"}, forces={"brownian": True},
        start={"drawn": "boltzmann"},
        simulation={"duration": 0.1, "samples": 2001, "model": "overdamped"},
    )  # fmt: skip
    recording = tweezer.load_recording(tweezer.simulate(hot, seed=5))
    found, known = tweezer.calibrate(recording), tweezer.medium(hot)
    assert found.temperature == pytest.approx(known.effective_temperature)
    assert found.drag == pytest.approx(known.drag)
