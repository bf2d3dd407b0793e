"""Bodies that light spins: rotation rates of runs and ensembles against torque over drag."""

import math

import numpy as np
import pytest
from scipy.constants import Boltzmann, speed_of_light
from scipy.optimize import brentq

import tweezer

#: five standard errors
FAR = 5.0
LIT = tweezer.load_scene("polystyrene-500nm").replace(
    beam={"polarisation": "circular"},
    forces={"gravity": False, "buoyancy": False},
    simulation={"model": "overdamped"},
)
#: A rod that absorbs light, upright in the trap
ROD = LIT.replace(
    bead={
        "shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um", "density": "1050 kg/m^3",
        "material": None, "refractive_index": "1.5715+3e-4j",
    }
)  # fmt: skip
#: A disc without absorption, which stands on its edge
DISC = LIT.replace(bead={"shape": "spheroid", "diameter": "0.5 um", "length": "0.25 um"})
UPRIGHT, ON_EDGE = [1, 0, 0, 0], [math.sqrt(0.5), 0, math.sqrt(0.5), 0]


def height(scene, orientation):
    """Height on the axis at which the optical force vanishes."""

    def force(z):
        return tweezer.optical_force(scene, [0, 0, z], orientation)[2]

    return brentq(force, -0.1e-6, 0.5e-6, xtol=1e-13)


def drag_about_the_axis(scene):
    """Perrin's drag of a prolate spheroid against rotation about its axis, N m s."""
    b, a = scene.bead.diameter / 2, scene.bead.length / 2
    long = math.sqrt(a**2 - b**2)
    s = 2 / long * math.log((a + long) / b)
    return 32 * math.pi / 3 * scene.medium.viscosity * long**2 * b**2 / (2 * a - b**2 * s)


#: A body as wide as the ring of a vortex of charge 1, which traps it
WIDE = {"diameter": "1.2 um", "length": "1.5 um", "refractive_index": "1.5715+1e-4j"}


@pytest.mark.parametrize(
    ("changes", "photon"),
    [
        ({"beam": {"polarisation": "circular"}}, 1),
        ({"beam": {"polarisation": "linear", "jones": [1, "-1j"]}}, -1),
        ({"beam": {"polarisation": "circular", "vortex": 1}, "bead": WIDE}, 2),
        ({"beam": {"polarisation": "linear", "jones": [1, "-1j"], "vortex": 1}, "bead": WIDE}, 0),
    ],
    ids=["circular", "the other way", "vortex", "cancelling vortex"],
)
def test_absorbing_body_spins_at_torque_over_drag(changes, photon):
    """Each absorbed photon brings the angular momentum l + s, in units of hbar."""
    scene = ROD.replace(**changes)
    position = [0, 0, height(scene, UPRIGHT)]
    frequency = 2 * math.pi * speed_of_light / scene.beam.wavelength
    torque = photon * tweezer.absorbed_power(scene, position) / frequency
    run = tweezer.simulate(
        scene.replace(
            start={"position": position, "orientation": UPRIGHT},
            simulation={"duration": "0.2 s", "samples": 1001},
        )
    )
    found = tweezer.rotation(run, axis=[1, 0, 0])
    expected = torque / drag_about_the_axis(scene)
    assert (abs(expected) > 5) == (photon != 0)
    np.testing.assert_allclose(found.rate, [0, 0, expected], rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(found.rate_body, [0, 0, expected], rtol=1e-5, atol=1e-6)


def test_lossless_disc_on_its_edge_turns_at_torque_over_drag():
    """The disc scatters angular momentum of circular light. The interval shrinks to the rate."""
    position = [0, 0, height(DISC, ON_EDGE)]
    torque = tweezer.optical_torque(DISC, position, ON_EDGE)
    across = tweezer.resistance(DISC).matrix[3, 3]
    tilted = [math.cos(0.75), 0, math.sin(0.75), 0]
    run = tweezer.simulate(
        DISC.replace(
            start={"position": position, "orientation": tilted},
            simulation={"duration": "0.1 s", "samples": 2001},
        )
    )
    found = tweezer.rotation(run, skip="10 ms")
    np.testing.assert_allclose(found.rate, [0, 0, torque[2] / across], rtol=1e-5, atol=1e-4)
    low, high = found.rate_interval[2].values
    assert high - low < 1e-3 * high
    assert found.order_tensor[2, 2] == pytest.approx(-0.5, abs=1e-6)


@pytest.fixture(scope="module")
def thermal():
    """24 rods that spin with thermal motion, for 50 ms each, at 4 times the power."""
    position = [0, 0, height(ROD, UPRIGHT)]
    scene = ROD.replace(
        beam={"power_through_pupil": "200 mW"},
        forces={"brownian": True},
        start={"position": position, "orientation": UPRIGHT},
        simulation={"duration": "50 ms", "samples": 501},
    )
    return scene, tweezer.ensemble(scene, 24, seed=1)


def test_spinning_rod_with_thermal_motion(thermal):
    """Rate about z with the error of free rotation about the axis; the rod stays upright."""
    scene, rods = thermal
    found = tweezer.rotation(rods, axis=[1, 0, 0])
    frequency = 2 * math.pi * speed_of_light / scene.beam.wavelength
    drag = drag_about_the_axis(scene)
    on_axis = tweezer.absorbed_power(scene, scene.start.position) / frequency / drag
    error = math.sqrt(2 * Boltzmann * scene.medium.temperature / drag / (24 * 0.05))
    # the rod wanders through weaker light: 3 % of the rate
    assert abs(float(found.rate[2]) - on_axis) < 0.03 * on_axis + FAR * error
    assert 0.5 * error < float(found.rate_error[2]) < 1.8 * error
    low, high = found.rate_interval.values.T
    assert low[2] > 0
    assert (low[:2] < 0).all()
    assert (high[:2] > 0).all()
    upright = tweezer.rotation(rods)
    assert upright.order_parameter > 0.98
    assert upright.director[2] == pytest.approx(1, abs=0.01)


def test_order_of_a_rod_is_that_of_its_stiffness(thermal):
    """Small tilts of a linear trap: <P2> = 1 - 3/2 kT tr(K^-1), over both tilts."""
    scene, rods = thermal
    found = tweezer.rotation(rods, skip="2 ms")
    across = [0, 1, 3, 4]  # x, y and the angles about them
    jacobian = tweezer.optical_jacobian(scene, scene.start.position, UPRIGHT)
    compliance = np.linalg.inv(-jacobian[np.ix_(across, across)])
    kT = Boltzmann * scene.medium.temperature
    off = 1.5 * kT * (compliance[2, 2] + compliance[3, 3])
    assert 1 - float(found.order_parameter) == pytest.approx(
        off, abs=0.03 * off + FAR * float(found.order_parameter_error)
    )
    assert float(found.order_parameter_error) < 0.02 * off


def test_rate_is_the_mean_of_the_angular_velocity():
    """With inertia, the angular velocity of the run is stored."""
    run = tweezer.simulate(
        DISC.replace(
            start={"position": [0, 0, height(DISC, ON_EDGE)], "orientation": ON_EDGE},
            simulation={"model": "full", "duration": "10 ms", "samples": 2001},
        )
    )
    found = tweezer.rotation(run, skip="1 ms")
    stored = run.angular_velocity.sel(time=slice(1e-3 - 1e-9, None)).values
    mean = (stored[1:] + stored[:-1]).mean(axis=0) / 2
    np.testing.assert_allclose(found.rate_body, mean, rtol=1e-6, atol=1e-4)
    assert np.linalg.norm(mean) > 100


def test_run_and_store_are_read_from_files(thermal, tmp_path):
    _, rods = thermal
    one = rods.isel(trajectory=0)
    assert tweezer.rotation(one).sizes["lag"] == tweezer.rotation(rods).sizes["lag"]
    scene = tweezer.scene_of(rods).replace(simulation={"duration": "2 ms", "samples": 101})
    run = tweezer.simulate(scene, seed=1)
    tweezer.save_run(run, tmp_path / "rod.nc")
    found = tweezer.rotation(run)
    assert tweezer.rotation(tmp_path / "rod.nc").identical(found)
    assert tweezer.rotation(str(tmp_path / "rod.nc")).attrs["seed"] == 1
    stored = tweezer.ensemble(scene, 3, seed=1, out=tmp_path / "rods.zarr")
    assert tweezer.rotation(tmp_path / "rods.zarr").identical(tweezer.rotation(stored))


def test_sphere_without_rotation_is_refused():
    run = tweezer.simulate(LIT, duration="1 us")
    if "orientation" in run:
        run = run.drop_vars("orientation")
    with pytest.raises(tweezer.ResultError, match="no orientation over time"):
        tweezer.rotation(run)
    statistics = tweezer.ensemble(
        LIT.replace(forces={"brownian": True}), 3, duration="50 us", statistics=True
    )
    with pytest.raises(tweezer.ResultError, match="trajectories of an ensemble"):
        tweezer.rotation(statistics)
