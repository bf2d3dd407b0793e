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
from tests.reference import detected_bead, reflected_flow
from tests.reference.detected_bead import BOLTZMANN
from tweezer.calibration import TrappedBead
from tweezer.reading import Recording
from tweezer.values.rounding import with_uncertainty

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
        times, scale * np.stack(columns, axis=1), tuple(axes), name="record", unit=unit, **more
    )


ALONE = {"temperature": T, "exposure": 0.0}
KNOWN = {**ALONE, "drag": FAR, "radius": RADIUS}


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
    # it moves by 20 nm rms across the wall
    said = [remark.text for remark in found.axes[2].remarks]
    assert len(said) == (gap == 0.1)
    assert all("of the gap, so its drag is a mean over heights" in each for each in said)


def test_estimates_beside_a_wall_are_as_uncertain_as_they_say():
    """8 records of three axes: scores have mean 0 and deviation 1, in 4 scatters of 24 (0.2 and
    0.14): false alarm 1e-3. Volts too; and without the wall nothing is trusted. Findings: one in a
    hundred records for each of a few tests, more than 6 of 48 in a thousand.
    """
    gap, scores, against = 0.1, {}, 0
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


def test_a_run_beside_a_wall_has_the_drag_on_its_way():
    """The mean of the mobilities at its heights, by the scene: here those of a gap of a radius, and
    with half of the time at one of 5 radii.
    """
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, simulation={"model": "overdamped"}, medium={"inertia": "none"},
        wall={"position": "-4 um", "side": "above"},
    )  # fmt: skip
    radius, far = scene.bead.radius, tweezer.bead_properties(scene).drag
    found = recording(1.0, 1)
    for gaps in ((1.0, 1.0), (1.0, 5.0)):
        places = found.positions * [1, 1, 1e-4] * (far / FAR) ** 0.5
        places[:, 2] += -4e-6 + radius * (1 + np.repeat(gaps, SAMPLES // 2))
        run = dataclasses.replace(found, positions=places, scene=scene)
        along, across = np.mean([MOBILITY[gap] for gap in gaps], axis=0)
        axes = tweezer.calibrate(run).axes
        for axis, mobility in zip(axes, (along, along, across), strict=True):
            assert axis.drag == pytest.approx(far / mobility, rel=1e-4)
    without_z = dataclasses.replace(found, scene=scene, axes=("x",), positions=places[:, :1])
    assert tweezer.calibrate(without_z).axes[0].drag is None


@pytest.mark.parametrize(
    ("known", "why"),
    [({"wall": 600e-9, "radius": None}, "wall: requires the bead's radius too"),
     ({"wall": 400e-9}, "wall = 4e-07: must exceed the bead's radius, 5e-07 m, by the size"),
     ({"wall": "600 pixels"}, "wall = '600 pixels': has an unknown unit"),
     ({"wall": "1 um +- 20 nm +- 1 nm"}, "must be a height, optionally with its uncertainty"),
     ({"wall": (600e-9, 50e-9)}, "uncertainty must be from 0 to 0.3 of the gap; omit the wall"),
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
        drag = f"drag {1e9 * FAR / mobility:.4g} nN·s/m, {1 / mobility:.4g} times that far away"
        assert f"1 µm from the wall, {way} it: {drag}" in outcome.out
    written = json.loads(Path("k.json").read_text())
    assert written["wall"] == pytest.approx({"distance": 1e-6, "uncertainty": 0, "radius": 5e-7})
    for axis, mobility in zip(written["axes"], MOBILITY[1.0], strict=True):
        assert axis["drag"] == pytest.approx(FAR / mobility)
    outcome = command_line(*asked, "--wall", "1 um +- 50 nm")
    assert (outcome.code, outcome.err) == (0, "")
    assert "along it: drag 13.06 ± 0.25 nN·s/m" in outcome.out
    outcome = command_line("calibrate", "mine.csv", *SAID, "--wall", "1 um")
    assert (outcome.code, outcome.err) == (
        2, "mine.csv: --wall requires --radius and --viscosity\n"
    )  # fmt: skip
    outcome = command_line(*asked, "--wall", "0.4 um")
    assert outcome.code == 2
    assert outcome.err.startswith("mine.csv: wall = 4e-07: must exceed the bead's radius")


FLUID = {"mass": 2000.0 * VOLUME, "displaced_mass": WATER * VOLUME}
#: heights in radii at which the drag with inertia is exact enough, and mobilities there
HEIGHTS = [(2.0, False, 0.7232121833), (6.0, False, 0.9066886056), (6.0, True, 0.8144061991)]


def spectrum(stiffness, height, across, mobility):
    """That of the reflected flow, by the reference."""
    masses = FLUID["mass"], FLUID["displaced_mass"]
    return reflected_flow.Density(stiffness, FAR, T, *masses, height, mobility, across)


@pytest.mark.parametrize("of", HEIGHTS)
def test_a_bead_beside_a_wall_in_a_fluid_with_inertia(of):
    """Its spectrum, and that of samples by 1001 aliases, of which those left out are 1e-4; the
    answer to a stage by hand.
    """
    height, across, mobility = of
    exact = spectrum(1e-4, *of)
    found = TrappedBead(1e-4, FAR / mobility, T, **FLUID, wall=height, across=across)
    f = np.geomspace(10, 2e5, 30)
    np.testing.assert_allclose(found.spectrum(f), exact(f), rtol=3e-3)
    f = np.linspace(50, 49_950, 12)
    aliases = detected_bead.sampled(f, 1e-5, exact, 500)
    np.testing.assert_allclose(found.sampled_spectrum(f, 1e-5), aliases, rtol=3e-3)
    assert found.variance == pytest.approx(KT / 1e-4, rel=1e-9)
    s, gamma = 2j * math.pi * 300.0, exact.gamma(300.0)
    push = s * (gamma + s * FLUID["displaced_mass"])
    moved = push / (s * gamma + 1e-4 + FLUID["mass"] * s**2)
    assert complex(found.driven(300.0)) == pytest.approx(moved, rel=3e-3)


@pytest.mark.parametrize("of", HEIGHTS[:1] + HEIGHTS[2:])
def test_estimates_with_the_inertia_of_the_fluid_beside_a_wall(of):
    """8 records at 100 kHz: scores have mean 0 and deviation 1, in 4 scatters (0.35 and 0.25):
    false alarm 1e-3; also with a stage that moves fluid and wall. Without the wall nothing is
    trusted.
    """
    height, across, mobility = of
    exact, step, axis = spectrum(1e-4, *of), 1e-5, "z" if across else "x"
    times = step * np.arange(2**14)
    known = KNOWN | FLUID | {"wall": height * RADIUS}
    wave = 400e-9 * np.exp(2j * np.pi * 37.0 * times)
    s, gamma = 2j * math.pi * 37.0, exact.gamma(37.0)
    push = s * (gamma + s * FLUID["displaced_mass"])
    answer = push / (s * gamma + 1e-4 + FLUID["mass"] * s**2)
    scores = {}
    for i, x in enumerate(detected_bead.drawn(exact, step, 2**14, 5, 8)):
        still = Recording(times, x[:, None], (axis,), name="record")
        volts = 3e6 * (x + (answer * wave).imag)
        driven = Recording(times, volts[:, None], (axis,), name="record", unit="V", drive=wave.imag)
        found = tweezer.calibrate(still, **known).axes[0]
        active = tweezer.calibrate(driven, **(known | {"drag": None})).axes[0]
        fits = found.free_fit, active.free_fit
        for name, value, error, true in (
            *((e.method, e.stiffness, e.uncertainty, 1e-4) for e in found.estimates),
            *(("drag", fit.bead.drag, fit.drag_uncertainty, FAR / mobility) for fit in fits),
            ("volts", active.sensitivity, active.sensitivity_uncertainty, 1 / 3e6),
            ("driven", active.fit.bead.stiffness, active.fit.stiffness_uncertainty, 1e-4),
        ):
            scores.setdefault(name, []).append((value - true) / error)
        if not i:
            wrong = tweezer.calibrate(still, **(known | {"wall": None})).axes[0]
            assert {finding.name for finding in wrong.findings} & {"drag", "spectrum"}
    assert len(scores) == 9
    for name, values in scores.items():
        assert abs(np.mean(values)) < 1.4, name
        assert 0.2 < np.std(values) < 2.0, name


def test_a_driven_axis_tells_the_drag_of_another():
    """x is driven, z is not: across the wall its drag is larger, by the ratio of the mobilities."""
    metres = recording(1.0, 8, "xz")
    drag = FAR / MOBILITY[1.0][0]
    s = 2j * math.pi * 37.0
    wave = 2e-6 * np.exp(s * metres.times)
    moved = (s * drag / (s * drag + K["x"]) * wave).imag
    signal = dataclasses.replace(
        metres, positions=2e6 * (metres.positions + np.outer(moved, [1, 0])), unit="V",
        drive=wave.imag,
    )  # fmt: skip
    known = ALONE | {"wall": height(1.0), "radius": RADIUS}
    by_stage, still = tweezer.calibrate(signal, **known).axes
    ratio = MOBILITY[1.0][0] / MOBILITY[1.0][1]
    first, second = by_stage.free_fit, still.free_fit
    assert second.bead.drag == pytest.approx(ratio * first.bead.drag, rel=1e-3)
    assert abs(first.bead.drag - drag) < 4 * first.drag_uncertainty
    for axis in (by_stage, still):
        k = axis["power spectrum"]
        assert abs(k.stiffness - K[axis.axis]) < 4 * k.uncertainty
        assert axis.sensitivity == pytest.approx(1 / 2e6, abs=4 * axis.sensitivity_uncertainty)
    told = tweezer.calibrate(signal, drag=FAR, **known).axes
    assert not any("drag" in [finding.name for finding in axis.findings] for axis in told)
    wrong = tweezer.calibrate(signal, drag=FAR, **ALONE).axes[0]
    assert "drag" in [finding.name for finding in wrong.findings]


@pytest.mark.parametrize(
    ("wall", "axes", "why"),
    [(0.7e-6, "x", "x .along the wall. is known only above 1.5 radii; omit"),
     (0.9e-6, "xz", "z .across the wall. is known only above 2 radii; omit")],
)  # fmt: skip
def test_the_inertia_of_the_fluid_too_near_a_wall(wall, axes, why):
    with pytest.raises(tweezer.ResultError, match=f"wall = .*: with fluid inertia, .*{why}"):
        tweezer.calibrate(recording(1.0, 1, axes), wall=wall, **KNOWN, **FLUID)


#: positions of the focus, m: with a shift of 0.8 the gaps are 0.1, 0.5, 1 and 5 radii
SHIFT, WALL = 0.8, -2e-6
FOCUS = [WALL + height(gap) / SHIFT for gap in MOBILITY]


@pytest.fixture(scope="module")
def series():
    """Calibrations at the four heights, three times, of which none is told a drag."""
    return [
        [
            tweezer.calibrate(recording(gap, 10 * i + j, "xz"), **ALONE)
            for j, gap in enumerate(MOBILITY)
        ]
        for i in range(3)
    ]


@pytest.mark.parametrize("drag", [FAR, None])
@pytest.mark.parametrize("shift", [SHIFT, None])
def test_the_wall_is_found(series, drag, shift):
    """Scores of 3 series have mean 0 and deviation 1, in 3.5 scatters (0.58 and 0.41), false alarm
    1e-3 each: the wall's place, the height of the nearest bead, and what else is fitted.
    """
    scores = {}
    for calibrations in series:
        found = tweezer.find_wall(calibrations, FOCUS, radius=RADIUS, drag=drag, shift=shift)
        assert not found.findings
        assert (found.drag_uncertainty is None, found.shift_uncertainty is None) == (
            drag is not None, shift is not None,
        )  # fmt: skip
        nearest = found.heights[0]
        for name, value, error, true in (
            ("wall", found.position, found.uncertainty, WALL),
            ("height", nearest.distance, nearest.uncertainty, height(0.1)),
            ("drag", found.drag, found.drag_uncertainty, FAR),
            ("shift", found.shift, found.shift_uncertainty, SHIFT),
        ):
            if error is not None:
                scores.setdefault(name, []).append((value - true) / error)
    for name, values in scores.items():
        assert abs(np.mean(values)) < 2.0, name
        assert np.std(values) < 2.4, name


def test_what_a_series_of_heights_does_not_tell_is_said(series):
    bead = {"radius": RADIUS, "drag": FAR}
    calibrations = series[0]
    far = [tweezer.calibrate(recording(5.0, 20 + i, "x"), **ALONE) for i in range(2)]
    vague = tweezer.find_wall(far, [0.0, 1e-9], radius=RADIUS, shift=1.0)
    assert [finding.name for finding in vague.findings] == ["undetermined"]
    backwards = tweezer.find_wall(calibrations, FOCUS[::-1], **bead, shift=SHIFT)
    assert [finding.name for finding in backwards.findings] == ["apart"]
    told = [tweezer.calibrate(recording(gap, 1, "x"), drag=FAR, **ALONE) for gap in MOBILITY]
    found = tweezer.find_wall(told, FOCUS, **bead, shift=SHIFT)
    assert (
        len(found.recordings) == 1
    )  # of the same name; a drag far from a wall is not held against it
    assert abs(found.position - WALL) < 4 * found.uncertainty
    volts = tweezer.calibrate(recording(1.0, 1, "x", unit="V", scale=1e6), drag=FAR, **ALONE)
    heavy = dataclasses.replace(calibrations[0], displaced_mass=1e-15)
    for wrong, places, why in (
        (calibrations, FOCUS[:3], "positions: must be 4 finite numbers, one for each recording"),
        (calibrations[:2], [0.0, math.nan], "positions: must be 2 finite numbers"),
        ([volts], [0.0], "no recording determines the drag: each is in volts without a drive"),
        ([heavy], [0.0], "without fluid inertia; omit the fluid density"),
    ):
        with pytest.raises(tweezer.ResultError, match=why):
            tweezer.find_wall(wrong, places, **bead)
    with pytest.raises(tweezer.ResultError, match=r"1 positions have a drag .* must be 2 or more"):
        tweezer.find_wall(calibrations[:1], [0.0], radius=RADIUS)
    with pytest.raises(tweezer.ResultError, match=r"shift = 0: must be positive"):
        tweezer.find_wall(calibrations, FOCUS, **bead, shift=0)


def test_command_that_finds_the_wall(command_line):
    names = []
    for gap in MOBILITY:
        names.append(f"{gap}.csv")
        write_table(names[-1], recording(gap, 4, "x"))
    places = ", ".join(f"{1e6 * place:.4f} um" for place in FOCUS)
    asked = ["calibrate", *names, *SAID, *BEAD, "--focus", places]
    outcome = command_line(*asked, "--focal-shift", "0.8", "--out", "k.json")
    assert (outcome.code, outcome.err) == (0, "")
    surface = json.loads(Path("k.json").read_text())["surface"]
    assert abs(surface["position"] - WALL) < 4 * surface["uncertainty"]
    place = with_uncertainty(1e6 * surface["position"], 1e6 * surface["uncertainty"], "±")
    assert f"the bead's centre would be in the wall with the focus at {place} µm" in outcome.out
    outcome = command_line(*asked, "--focal-shift", "fit")
    assert (outcome.code, outcome.err) == (0, "")
    assert "; it moves by 0." in outcome.out
    for more, why in (
        (
            ["--wall", "1 um"],
            "--wall: cannot be combined with --focus, which determines the wall; omit one of them",
        ),
        (["--focal-shift", "some"], "--focal-shift 'some': must be a positive number, or fit"),
        (["--focal-shift", "-1"], "--focal-shift '-1': must be a positive number, or fit"),
    ):
        outcome = command_line(*asked, *more)
        assert (outcome.code, outcome.err) == (2, why + "\n")
    outcome = command_line(*asked[:-2], "--focal-shift", "0.8")
    assert (outcome.code, outcome.err) == (2, "--focal-shift: requires --focus\n")
    outcome = command_line(*asked[:-1], "1 um")
    assert outcome.code == 2
    assert "has 1 positions; must be" in outcome.err


def test_part_of_a_run_without_a_wall_keeps_its_drag():
    """Where the drag is the same everywhere, two columns are enough to know it."""
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"inertia": "none"}, forces={"brownian": True}
    )
    whole = recording(1.0, 3)
    part = dataclasses.replace(
        whole, positions=whole.positions[:, :2], axes=("x", "y"), scene=scene
    )
    assert all(axis.drag for axis in tweezer.calibrate(part).axes)
