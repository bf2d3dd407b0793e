"""Microrheology against recordings of beads among springs and dashpots, simulated exactly."""

import json

import numpy as np
import pytest

import tweezer
from tests.reference.trapped_bead import BOLTZMANN, viscoelastic
from tweezer.microrheology import Medium, ViscoelasticBead
from tweezer.plots import rheology_figure

RADIUS, TEMPERATURE, STEP, SAMPLES = 0.5e-6, 295.0, 2e-4, 30_000
PER_VISCOSITY = 6 * np.pi * RADIUS
SOLVENT, VISCOSITY, TIME, STIFFNESS = 1e-3, 4e-3, 5e-3, 1e-5
KNOWN = {"temperature": TEMPERATURE, "radius": RADIUS, "exposure": 0}
#: standard uncertainties that a normal number exceeds once in 3000 cases
RARE = 3.6
FREQUENCIES = np.array([3.0, 30.0, 300.0, 2000.0])


def modulus(frequencies):
    """The complex modulus of the medium, Pa."""
    s = 2j * np.pi * frequencies
    return s * SOLVENT + s * VISCOSITY / (1 + s * TIME)


def recorded(*positions, step=STEP):
    """A recording of one or two axes."""
    times = step * np.arange(len(positions[0]))
    return tweezer.Recording(times, np.stack(positions, axis=1), ("x", "y")[: len(positions)])


@pytest.fixture(scope="module")
def motion():
    """Positions along two axes, (2, samples), m."""
    element = (PER_VISCOSITY * VISCOSITY, TIME)
    return viscoelastic(
        STEP, SAMPLES, STIFFNESS, PER_VISCOSITY * SOLVENT, [element], TEMPERATURE, 5, 2
    )  # fmt: skip


@pytest.fixture(scope="module")
def found(motion):
    return tweezer.rheology(recorded(*motion), frequencies=FREQUENCIES, **KNOWN)


@pytest.mark.parametrize("exposure", [0.0, 0.7 * STEP])
def test_sampled_spectrum_is_the_sum_over_all_aliases(exposure):
    """The continuous spectrum is 4 kT Re(gamma)/|k + s gamma|^2. Without an exposure its tail is
    added in closed form; with one it is negligible.
    """
    noise = 1e-9
    drags, times = (PER_VISCOSITY * 2e-3, PER_VISCOSITY * 1e-2), (5e-4, 2e-2)
    beta = PER_VISCOSITY * SOLVENT
    bead = ViscoelasticBead(
        STIFFNESS, beta, TEMPERATURE, drags=drags, times=times, exposure=exposure, noise=noise
    )
    f = np.array([0.5, 20.0, 400.0, 2400.0])
    order = np.arange(-20_000, 20_001)
    aliases = np.abs(f[:, None] + order / STEP)
    s = 2j * np.pi * aliases
    gamma = beta + sum(b / (1 + s * t) for b, t in zip(drags, times, strict=True))
    kT = BOLTZMANN * TEMPERATURE
    density = 4 * kT * gamma.real / np.abs(STIFFNESS + s * gamma) ** 2
    total = (density * np.sinc(aliases * exposure) ** 2).sum(axis=1)
    if not exposure:
        total += 4 * kT / (beta * (2 * np.pi / STEP) ** 2) * 2 / (order[-1] + 0.5)
    expected = total + 2 * STEP * noise**2
    np.testing.assert_allclose(bead.sampled_spectrum(f, STEP), expected, rtol=1e-9)
    np.testing.assert_allclose(bead.spectrum(f), density[:, 20_000] * np.sinc(f * exposure) ** 2)


def test_slopes_of_the_modulus_are_its_derivatives():
    f, start = np.array([0.3, 40.0, 900.0]), np.log([1e-3, 2e-3, 1e-2, 5e-4, 2e-2])

    def medium(x):
        return Medium(float(np.exp(x[0])), tuple(np.exp(x[1:3])), tuple(np.exp(x[3:])))

    for i, slope in enumerate(medium(start).slopes(f)):
        h = 1e-4 * np.eye(5)[i]
        difference = medium(start + h).modulus(f) - medium(start - h).modulus(f)
        np.testing.assert_allclose(slope, difference / 2e-4, rtol=1e-7)


def test_intervals_contain_the_true_medium_and_trap(found, motion):
    """In logarithms, scaled to 3.6 standard uncertainties: false alarms 1 in 200 with any seed."""
    assert not found.findings
    assert len(found.elements) == 2
    assert not found.noisy
    true = modulus(FREQUENCIES)
    for part, value in ((found.storage, true.real), (found.loss, true.imag)):
        half = np.log(np.array(part.high) / part.low) / 2
        assert (np.abs(np.log(part.values / value)) < RARE / 1.96 * half).all()
    solvent, element = found.elements
    for value, interval, truth in (
        (solvent.viscosity, solvent.viscosity_interval, SOLVENT),
        (element.viscosity, element.viscosity_interval, VISCOSITY),
        (element.time, element.time_interval, TIME),
    ):
        half = np.log(interval[1] / interval[0]) / 2
        assert abs(np.log(value / truth)) < RARE / 1.96 * half < 0.6
    for each, positions in zip(found.axes, motion, strict=True):
        assert abs(each.stiffness - STIFFNESS) < RARE * each.stiffness_uncertainty < 0.2 * STIFFNESS
        assert abs(each.equipartition - STIFFNESS) < RARE * each.equipartition_uncertainty
        by_variance = BOLTZMANN * TEMPERATURE / positions.var()
        assert each.equipartition == pytest.approx(by_variance, rel=0.02)


def test_storage_of_a_newtonian_liquid_is_zero_with_a_limit(motion):
    water = viscoelastic(STEP, 5000, STIFFNESS, PER_VISCOSITY * SOLVENT, [], TEMPERATURE, 1)
    one = tweezer.rheology(recorded(water[0]), **KNOWN)
    assert len(one.elements) == 1
    assert not any(one.storage.values)
    assert not any(one.storage.low)
    assert all(high > 0 for high in one.storage.high)
    np.testing.assert_allclose(
        one.loss.values, 2 * np.pi * np.array(one.frequencies) * one.elements[0].viscosity
    )


def test_noise_is_found_by_the_criterion(motion):
    rng = np.random.default_rng(1)
    noisy = motion[0] + 4e-9 * rng.normal(size=SAMPLES)
    one = tweezer.rheology(recorded(noisy), frequencies=FREQUENCIES, **KNOWN)
    assert one.noisy
    assert one.axes["x"].noise == pytest.approx(4e-9, rel=0.1)
    assert len(one.elements) == 2
    given = tweezer.rheology(recorded(noisy), noise="4 nm", frequencies=FREQUENCIES, **KNOWN)
    assert given.axes["x"].noise == 4e-9
    assert not given.noisy


def test_findings(motion):
    """Axes of different scales, an unknown exposure and a drift are findings."""

    def names(*positions):
        return {each.name for each in tweezer.rheology(recorded(*positions), **KNOWN).findings}

    assert names(motion[0], 1.3 * motion[1]) >= {"axes"}
    assert "drift" in names(motion[0] + np.linspace(0, 2e-7, SAMPLES))
    assert "free" in names(motion[0, :1000])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"radius": None}, "requires the radius"),
        ({"temperature": None}, "requires the temperature"),
        ({"exposure": "fit"}, "exposure = 'fit': cannot be distinguished"),
        ({"diode": "fit"}, "diode = 'fit': cannot be distinguished"),
        ({"frequencies": [1e-3]}, r"frequencies = 0.001 Hz: must be from 0.1667 to 2500 Hz"),
    ],
)
def test_what_cannot_be_analysed_is_refused(changes, message, motion):
    with pytest.raises(tweezer.ResultError, match=message):
        tweezer.rheology(recorded(motion[0]), **KNOWN | changes)


def test_positions_in_volts_are_refused(motion):
    volts = tweezer.Recording(STEP * np.arange(SAMPLES), motion[0], ("x",), unit="V")
    with pytest.raises(tweezer.ResultError, match="in volts: must be in metres"):
        tweezer.rheology(volts, **KNOWN)


def test_result_is_saved_and_drawn(found, tmp_path):
    assert tweezer.load(tweezer.save(found, tmp_path / "found.json")) == found
    moduli, spectrum, residuals = rheology_figure(found).axes
    np.testing.assert_array_equal(moduli.lines[0].get_ydata(), found.storage.values)
    assert len(spectrum.lines) == 4
    assert residuals.get_xlabel() == "frequency (Hz)"


def test_command(motion, tmp_path, command_line):
    np.savetxt(
        "short.csv", np.column_stack([STEP * np.arange(5000), motion[0, :5000]]), delimiter=",",
        header="t,x", comments="",
    )  # fmt: skip
    arguments = ("short.csv", "--temperature", "295 K", "--radius", "0.5 um", "--blur", "0")
    done = command_line("rheology", *arguments, "--out", "found.json", "--plot", "found.png")
    assert done.code == 0
    assert "x: stiffness" in done.out
    content = json.loads((tmp_path / "found.json").read_text())
    assert content["elements"][0]["viscosity"] == pytest.approx(SOLVENT, rel=0.2)
    refused = command_line("rheology", "short.csv")
    assert (refused.code, refused.err) == (
        2, "short.csv: requires --temperature and --radius\n"
    )  # fmt: skip
