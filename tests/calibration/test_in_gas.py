"""Calibration of beads that oscillate in a gas, from exact samples of a damped oscillator."""

import functools
import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import lfilter

import tweezer
from tweezer import ResultError

K_B, T, RADIUS, DENSITY = 1.380649e-23, 300.0, 75e-9, 1850.0
MASS = 4 / 3 * math.pi * RADIUS**3 * DENSITY
FREQUENCIES, VOLTS = {"x": 173e3, "y": 150e3}, {"x": 2e6, "y": 1.5e6}  # Hz, V/m
RATE = 1e6


@functools.cache
def levitated(pressure="10 mbar", radius=RADIUS, density=DENSITY):
    data = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
    data["lens"]["numerical_aperture"] = 0.8
    data["medium"] = {"name": "air", "pressure": pressure, "temperature": T}
    data["bead"] |= {"radius": radius, "density": density}
    return tweezer.load_scene(data)


DAMPING = tweezer.medium(levitated()).damping_rate


def oscillator(omega, gamma, samples, rng):
    """Return exact samples of x'' + gamma x' + omega^2 x = noise with the mass of the bead, m.

    The step is a matrix exponential, and its noise has the covariance C - E C E^T with the
    stationary covariance C.
    """
    step = expm(np.array([[0, 1], [-(omega**2), -gamma]]) / RATE)
    stationary = K_B * T / MASS * np.diag([omega**-2, 1.0])
    scale = np.sqrt(np.diag(stationary))
    noise = stationary - step @ stationary @ step.T
    kicks = np.linalg.cholesky(noise / np.outer(scale, scale)) @ rng.standard_normal((2, samples))
    kicks *= scale[:, None]
    start = scale * rng.standard_normal(2)
    then = step @ start + kicks[:, 0]
    # without the velocity the positions are an ARMA(2, 1) process
    trace, det = np.trace(step), np.linalg.det(step)
    driven = kicks[0, 1:-1] + step[0, 1] * kicks[1, :-2] - step[1, 1] * kicks[0, :-2]
    before = [trace * then[0] - det * start[0], -det * then[0]]
    rest, _ = lfilter([1.0], [1.0, -trace, det], driven, zi=before)
    return np.concatenate([[start[0], then[0]], rest])


def recorded(seed, duration=0.02, unit="V", gamma=DAMPING, frequencies=FREQUENCIES):
    """Return a recording with 2 % of white noise."""
    rng, samples = np.random.default_rng(seed), round(duration * RATE)
    columns = []
    for axis, frequency in frequencies.items():
        x = oscillator(2 * math.pi * frequency, gamma, samples, rng)
        x *= VOLTS[axis] if unit == "V" else 1.0
        columns.append(x + 0.02 * x.std() * rng.standard_normal(samples))
    times = np.arange(samples) / RATE
    return tweezer.Recording(times, np.stack(columns, axis=1), tuple(frequencies), unit=unit)


@pytest.fixture(scope="module")
def found():
    """Calibrations of 16 recordings of 1100 damping times each."""
    return [tweezer.calibrate(recorded(seed), scene=levitated()) for seed in range(16)]


def test_intervals_contain_mass_and_sensitivity(found):
    """32 sensitivities and 16 masses. The gas is exact in the simulation, so its error is removed.
    At 95 % coverage, fewer than 11 of 16 or 25 of 32 have a probability of 1.2e-4 each.
    """
    of_gas = tweezer.medium(levitated()).drag_error / tweezer.medium(levitated()).drag / 2
    masses, volts = [], []
    for one in found:
        bead = one.levitated
        error = math.sqrt((bead.mass_uncertainty / bead.mass) ** 2 - of_gas**2)
        masses.append(math.log(bead.mass / MASS) / error)
        for axis in one.axes:
            relative = axis.sensitivity_uncertainty / axis.sensitivity
            error = math.sqrt(relative**2 - (of_gas / 2) ** 2)
            volts.append(math.log(axis.sensitivity * VOLTS[axis.axis]) / error)
    assert np.less(np.abs(masses), 1.96).sum() >= 11
    assert np.less(np.abs(volts), 1.96).sum() >= 25
    assert 0.5 < np.std(masses) < 1.6
    assert all(one.determined for one in found[:5])


def test_error_of_the_gas_is_part_of_the_intervals(found):
    """The bound of 5 % counts as two standard uncertainties, of the mass and of the stiffness."""
    bead = found[0].levitated
    of_gas = tweezer.medium(levitated()).drag_error / tweezer.medium(levitated()).drag / 2
    of_rate = math.sqrt(2 / (2 * DAMPING * 0.02))  # Fisher's information of two envelopes
    assert bead.mass_uncertainty / bead.mass == pytest.approx(math.hypot(of_gas, of_rate), rel=0.1)
    told = tweezer.calibrate(
        recorded(0), scene=levitated(), pressure="10 mbar +- 10 %", radius="75 nm +- 3 nm"
    ).levitated
    # for free molecules the drag is proportional to pressure and squared radius
    expected = math.hypot(bead.mass_uncertainty / bead.mass, 0.1, 2 * 0.04)
    assert told.mass_uncertainty / told.mass == pytest.approx(expected, rel=0.02)
    expected = math.hypot(bead.mass_uncertainty / bead.mass, 0.1, 0.04)
    assert told.density_uncertainty / told.density == pytest.approx(expected, rel=0.02)


def test_density_determines_the_radius():
    """For free molecules the radius is inverse to the damping rate: 4 errors, false alarm 6e-5."""
    given = levitated(radius=90e-9)
    bead = tweezer.calibrate(recorded(3), scene=given, density="1850 kg/m^3").levitated
    assert abs(bead.radius - RADIUS) < 4 * bead.radius_uncertainty
    assert bead.density == pytest.approx(DENSITY)
    assert bead.mass == pytest.approx(4 / 3 * math.pi * DENSITY * bead.radius**3, rel=1e-6)
    assert bead.mass_uncertainty / bead.mass == pytest.approx(
        3 * bead.radius_uncertainty / bead.radius, rel=1e-3
    )


def test_recording_in_metres_tests_the_mass():
    right = tweezer.calibrate(recorded(4, unit="m"), scene=levitated())
    axis = right.axes["x"]
    k = MASS * (2 * math.pi * FREQUENCIES["x"]) ** 2
    for method in ("power spectrum", "equipartition"):
        assert abs(axis[method].stiffness - k) < 4 * axis[method].uncertainty
    assert right.determined
    record = recorded(4, unit="m")
    scaled = tweezer.Recording(record.times, 1.3 * record.positions, record.axes)
    wrong = tweezer.calibrate(scaled, scene=levitated())
    assert [each.name for each in wrong.axes["x"].findings] == ["metres"]
    assert not wrong.determined


def test_sampling_near_twice_the_resonance_is_exact():
    """The aliases change the line at 0.45 of the sampling rate; 4 errors, false alarm 2e-4."""
    near = {"x": 0.45 * RATE}
    found = tweezer.calibrate(recorded(5, frequencies=near), scene=levitated())
    resonance = found.axes["x"].resonance
    assert abs(resonance.frequency - 0.45 * RATE) < 4 * resonance.frequency_uncertainty
    assert abs(resonance.damping_rate - DAMPING) < 4 * resonance.damping_rate_uncertainty
    axis = found.axes["x"]
    assert abs(axis.sensitivity * VOLTS["x"] - 1) < 4 * axis.sensitivity_uncertainty * VOLTS["x"]


def test_frequency_that_depends_on_energy_or_time_is_a_finding():
    """An envelope whose frequency changes by half the damping rate, added in small steps."""
    rng, samples, omega, gamma = np.random.default_rng(6), 40_000, 2 * math.pi * 1.5e5, 1e4
    times = np.arange(samples) / RATE
    drive = rng.standard_normal(samples) + 1j * rng.standard_normal(samples)
    findings = {}
    for way in ("energy", "time", "neither"):
        envelope, a = np.empty(samples, complex), 1.0 + 0j
        for i in range(samples):
            shift = {"energy": 0.7 * (abs(a) ** 2 - 1), "time": 2 * i / samples - 1}.get(way, 0.0)
            a = a * np.exp((-gamma / 2 + 1j * gamma * shift) / RATE)
            a += math.sqrt(gamma / RATE / 2) * drive[i]
            envelope[i] = a
        x = 1e-8 * (envelope * np.exp(1j * omega * times)).real
        record = tweezer.Recording(times, x, ("x",), unit="V")
        scene = levitated("2 mbar")
        findings[way] = tweezer.calibrate(record, scene=scene).axes["x"].findings
    assert "energy" in findings["energy"][0].text
    assert "drifts" in findings["time"][0].text
    assert "broadened" not in {each.name for each in findings["neither"]}


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"duration": 0.0002}, "damping times"),
        ({"gamma": 1e7}, "overdamped"),
        ({"duration": 0.0004, "frequencies": {"x": 20e3}}, "damping times"),
    ],
)
def test_recording_that_does_not_determine_the_line_is_refused(changes, why):
    with pytest.raises(ResultError, match=why):
        tweezer.calibrate(recorded(7, **changes), scene=levitated())


def test_arguments_that_contradict_the_gas_are_refused():
    record = recorded(8, duration=0.002)
    for given, why in (
        ({"drag": 1e-12}, "drag follows from the gas"),
        ({"wall": "1 um"}, "beside a wall"),
        ({"radius": "75 nm", "density": "1850 kg/m^3"}, "omit one"),
        ({"pressure": "10 mbar +- 50 %"}, "below 30 %"),
    ):
        with pytest.raises(ResultError, match=why):
            tweezer.calibrate(record, scene=levitated(), **given)
    with pytest.raises(ResultError, match="requires the scene of a bead in a named gas"):
        tweezer.calibrate(record, temperature=T, drag=1e-12, pressure="1 mbar")


def test_width_that_the_gas_does_not_explain_is_a_finding():
    found = tweezer.calibrate(recorded(9), scene=levitated("20 mbar"))
    assert "width" in {each.name for each in found.axes["x"].findings}


def test_white_noise_has_no_line():
    times, noise = np.arange(5000) / RATE, np.random.default_rng(1).standard_normal(5000)
    with pytest.raises(ResultError, match=r"line|damping times"):
        tweezer.calibrate(tweezer.Recording(times, noise, ("x",), unit="V"), scene=levitated())


def test_command_prints_mass_and_sensitivity(command_line):
    record = recorded(1)
    table = np.column_stack([record.times, record.positions])
    np.savetxt("gas.csv", table, delimiter=",", header="t [s],x [V],y [V]", comments="")
    done = command_line(
        "calibrate", "gas.csv", "--scene", "silica-1um", "--set", "lens.numerical_aperture=0.8",
        "--set", "bead.radius=75 nm", "--set", "bead.density=1850 kg/m^3",
        "--set", "medium.name=air", "--set", "medium.temperature=300 K",
        "--set", "medium.pressure=10 mbar", "--radius", "75 nm +- 2 %", "--out", "gas.json",
        "--plot", "gas.png",
    )  # fmt: skip
    assert done.code == 0, done.err
    assert "mass" in done.out
    loaded = tweezer.load("gas.json")
    assert loaded.levitated.mass == pytest.approx(MASS, rel=0.3)
    refused = command_line("calibrate", "gas.csv", "--pressure", "1 mbar", "--temperature", "300 K")
    assert refused.code == 2
    assert "--scene" in refused.err
