"""Calibration beside a wall: exact records of a bead whose mobilities are those of the series."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest
from lumicks.pylake.force_calibration.detail import drag_models
from scipy.signal import lfilter

import tweezer
from tests.reference.detected_bead import BOLTZMANN
from tweezer.analysis import Recording

T = 293.15
KT = BOLTZMANN * T
RADIUS, VISCOSITY, WATER = 500e-9, 1.002e-3, 998.2
FAR = 6 * math.pi * VISCOSITY * RADIUS
VOLUME = 4 / 3 * math.pi * RADIUS**3
#: along and across the wall over that far away, by the gap in radii: the bispherical series at 30
#: digits (H. Brenner 1961; W. R. Dean and M. E. O'Neill 1963, of a bead that is free to turn)
MOBILITY = {
    0.1: (0.44304988, 0.08726645), 0.5: (0.62681117, 0.31197449),
    1.0: (0.72321218, 0.47046966), 5.0: (0.90668861, 0.81440620),
}  # fmt: skip


def height(gap):
    return (1 + gap) * RADIUS


def drawn(drag, stiffness, step, samples, rng):
    """Exact samples of a bead in a trap without inertia."""
    kept = math.exp(-stiffness / drag * step)
    noise = math.sqrt(KT / stiffness) * rng.standard_normal(samples)
    noise[1:] *= math.sqrt(1 - kept**2)
    return lfilter([1.0], [1.0, -kept], noise)


#: of x, y and z, N/m
K = {"x": 2e-5, "y": 3e-5, "z": 1e-5}
STEP, SAMPLES = 1e-4, 2**14


def recording(gap, seed, axes="xyz", unit="m", scale=1.0, **more):
    rng, (along, across) = np.random.default_rng(seed), MOBILITY[gap]
    columns = [
        drawn(FAR / (across if axis == "z" else along), K[axis], STEP, SAMPLES, rng)
        for axis in axes
    ]
    times = STEP * np.arange(SAMPLES)
    return Recording(
        "record", times, scale * np.stack(columns, axis=1), tuple(axes), unit=unit, **more
    )


KNOWN = {"temperature": T, "drag": FAR, "radius": RADIUS, "exposure": 0.0}


@pytest.mark.parametrize("gap", MOBILITY)
def test_the_drag_at_a_height(gap):
    """That of the series; and pylake's, which is within 0.4 % of Brenner's across it, and along it
    Faxen's, of a bead that is kept from turning: 0.3 % from a gap of a radius on.
    """
    found = tweezer.calibrate(recording(gap, 1), wall=height(gap), **KNOWN)
    for axis in found.axes:
        mobility = MOBILITY[gap][int(axis.axis == "z")]
        assert axis.drag == pytest.approx(FAR / mobility, rel=1e-7)
        assert axis.fit.bead.drag == axis.drag
    h = height(gap)
    brenner, faxen = drag_models.brenner_axial(h, RADIUS), drag_models.faxen_factor(h, RADIUS)
    assert found.axes[2].drag == pytest.approx(FAR * brenner, rel=4e-3)
    if gap >= 1:
        assert found.axes[0].drag == pytest.approx(FAR * faxen, rel=3e-3)
    assert (found.drag, found.wall.distance) == (FAR, h)


@pytest.mark.parametrize("gap", [0.1, 1.0])
def test_estimates_beside_a_wall_are_as_uncertain_as_they_say(gap):
    """8 records of three axes: scores have mean 0 and deviation 1, in 4 scatters of 24 (0.2 and
    0.14): false alarm 1e-3. Volts too; and without the wall nothing is trusted. Findings: one in a
    hundred records for each of a few tests, more than 6 of 48 in a thousand.
    """
    scores, against = {}, 0
    for seed in range(8):
        metres = recording(gap, seed)
        volts = dataclasses.replace(metres, positions=3e6 * metres.positions, unit="V")
        found, in_volts = (
            tweezer.calibrate(each, wall=height(gap), **KNOWN) for each in (metres, volts)
        )
        for axis, seen in zip(found.axes, in_volts.axes, strict=True):
            against += len(axis.findings) + len(seen.findings)
            for by, value, error, true in (
                *((e.method, e.stiffness, e.uncertainty, K[axis.axis]) for e in axis.estimates),
                ("drag", axis.free_fit.bead.drag, axis.free_fit.drag_uncertainty, axis.drag),
                ("volts", seen.sensitivity, seen.sensitivity_uncertainty, 1 / 3e6),
            ):
                scores.setdefault(by, []).append((value - true) / error)
        if not seed:
            for axis in tweezer.calibrate(metres, **KNOWN).axes:
                assert "drag, as beside a wall" in axis.findings[0].text
    assert against <= 6
    assert len(scores) == 8
    for by, values in scores.items():
        assert abs(np.mean(values)) < 0.8, by
        assert 0.4 < np.std(values) < 1.6, by


def drag_farther(found, axis, further):
    """The drag along an axis a little farther from the wall."""
    wall = dataclasses.replace(found.wall, distance=found.wall.distance + further)
    return found.drag / wall.mobility(axis.axis)


def test_an_uncertain_height():
    """The height is off by one uncertainty each time: what is known of the drag and what the record
    tells are weighted, and the stiffness is hardly worse known than with a drag that is fitted.
    """
    gap = 0.5
    for seed, off in ((1, 30e-9), (2, -30e-9)):
        metres = recording(gap, seed, "xz")
        wall = height(gap) + off, 30e-9
        found = tweezer.calibrate(metres, wall=wall, **KNOWN)
        by_text = tweezer.calibrate(metres, wall=f"{1e6 * wall[0]:.3f} um +- 30 nm", **KNOWN)
        assert repr(by_text) == repr(found)
        free = tweezer.calibrate(metres, **(KNOWN | {"drag": None})).axes
        for axis, alone in zip(found.axes, free, strict=True):
            assert not axis.findings
            assert axis.free_fit.bead.drag == pytest.approx(alone.fit.bead.drag, rel=1e-4)
            known, measured = axis.drag, alone.fit.bead.drag
            slope = np.log(known / drag_farther(found, axis, 1e-9)) / 1e-9
            errors = np.array([30e-9 * abs(slope), alone.fit.drag_uncertainty / measured])
            weights = errors**-2 / (errors**-2).sum()
            mean = math.exp(weights @ np.log([known, measured]))
            assert axis.fit.bead.drag == pytest.approx(mean, rel=3e-3)
            uncertainty = (errors**-2).sum() ** -0.5
            assert axis.fit.drag_uncertainty / mean == pytest.approx(uncertainty, rel=0.05)
            k, without = axis["power spectrum"], alone["power spectrum"]
            assert k.uncertainty < 1.02 * without.uncertainty
            assert abs(k.stiffness - K[axis.axis]) < 4 * k.uncertainty
    wrong = tweezer.calibrate(metres, wall=(3 * RADIUS, 10e-9), **KNOWN)
    assert all("drag" in [f.name for f in axis.findings] for axis in wrong.axes)


@pytest.mark.parametrize(
    ("known", "why"),
    [({"wall": 600e-9, "radius": None}, "wall: needs the bead's radius too"),
     ({"wall": 400e-9}, "wall = 4e-07: must be more than the bead's radius, 5e-07 m: it is the"),
     ({"wall": "600 pixels"}, "wall = '600 pixels': has a unit that is not known"),
     ({"wall": "1 um +- 20 nm +- 1 nm"}, "must be a height, perhaps with its uncertainty"),
     ({"wall": (600e-9, 50e-9)}, "uncertainty must be from 0 to 0.3 of the gap; leave the wall"),
     ({"wall": (600e-9, -1e-9)}, "uncertainty must be from 0 to 0.3 of the gap"),
     ({"wall": 1e-6, "radius": -1.0}, "radius = -1.0: must be positive")],
)  # fmt: skip
def test_what_is_wrong_with_a_wall_is_said(known, why):
    with pytest.raises(tweezer.ResultError, match=why):
        tweezer.calibrate(recording(1.0, 1, "x"), **(KNOWN | known))


def write_table(name, found):
    table = np.column_stack([found.times, found.positions])
    np.savetxt(name, table, delimiter=",", header=",".join(["t", *found.axes]), comments="")


SAID = ["--temperature", "20 degC", "--blur", "0"]
BEAD = ["--radius", "500 nm", "--viscosity", "1.002 mPa s"]


def test_command_beside_a_wall(command_line):
    found = recording(1.0, 3, "xz")
    write_table("mine.csv", found)
    asked = ["calibrate", "mine.csv", *SAID, *BEAD]
    outcome = command_line(*asked, "--wall", "1 um", "--out", "k.json", "--plot", "k.png")
    assert (outcome.code, outcome.err) == (0, "")
    for way, mobility in zip(("along", "across"), MOBILITY[1.0], strict=True):
        drag = f"drag {1e9 * FAR / mobility:.4g} nN s/m, {1 / mobility:.4g} times that far away"
        assert f"1 um from the wall, {way} it: {drag}" in outcome.out
    written = json.loads(Path("k.json").read_text())
    assert written["wall"] == pytest.approx({"distance": 1e-6, "uncertainty": 0, "radius": 5e-7})
    for axis, mobility in zip(written["axes"], MOBILITY[1.0], strict=True):
        assert axis["drag"] == pytest.approx(FAR / mobility)
    outcome = command_line(*asked, "--wall", "1 um +- 50 nm")
    assert (outcome.code, outcome.err) == (0, "")
    assert "along it: drag 13.06 +- 0.25 nN s/m" in outcome.out
    outcome = command_line("calibrate", "mine.csv", *SAID, "--wall", "1 um")
    assert (outcome.code, outcome.err) == (
        2, "mine.csv: --wall needs --radius and --viscosity\n"
    )  # fmt: skip
    outcome = command_line(*asked, "--wall", "0.4 um")
    assert outcome.code == 2
    assert outcome.err.startswith("mine.csv: wall = 4e-07: must be more than the bead's radius")
