"""Several beams, beams that move, change or come from above: as scenes, in traps and in runs."""

import math
import re
import warnings

import numpy as np
import pytest

import tweezer
from tests.reference.fields import GaussianWell, LinearTrap
from tweezer.dynamics import bound_once
from tweezer.dynamics.walk import walk
from tweezer.forces import Course, Moved, Sum
from tweezer.optics import light_force
from tweezer.scene import with_settings
from tweezer.values.errors import SceneError, UnitWarning

RNG = np.random.default_rng(401)
PLACES = RNG.normal(size=(5, 3)) * 4e-7
ONE = tweezer.load_scene("silica-1um")
TWO = tweezer.load_scene("two-traps")
BEAD = tweezer.bead_properties(ONE)
KT = 1.380649e-23 * ONE.medium.temperature


def beam_of(scene, **keys):
    return scene.beam.model_dump(exclude_none=True) | keys


# --- what the light does --------------------------------------------------------------------------


def test_beams_add_up_each_about_its_focus():
    alone = ONE.replace(beam={"power_through_pupil": "20 mW"})
    for side in (-1.5e-6, 1.5e-6):
        assert tuple(side * np.array([1, 0, 0])) in {beam.position for beam in TWO.beams}
    expected = sum(
        tweezer.optical_force(alone, PLACES - [side, 0, 0]) for side in (-1.5e-6, 1.5e-6)
    )
    np.testing.assert_allclose(tweezer.optical_force(TWO, PLACES), expected, rtol=1e-12)


@pytest.mark.parametrize("evaluator", ["grid", "quadrature", "map"])
def test_light_that_comes_from_above_is_seen_upside_down(evaluator):
    scene = ONE.replace(optics={"evaluator": evaluator})
    above = scene.replace(beam={"direction": "down", "position": [1e-7, 2e-7, 3e-7]})
    R = np.diag([1.0, -1.0, -1.0])
    there = (PLACES - [1e-7, 2e-7, 3e-7]) @ R
    np.testing.assert_allclose(
        tweezer.optical_force(above, PLACES), tweezer.optical_force(scene, there) @ R, rtol=1e-12
    )
    np.testing.assert_allclose(
        tweezer.optical_jacobian(above, PLACES),
        R @ tweezer.optical_jacobian(scene, there) @ R, rtol=1e-9, atol=1e-15,
    )  # fmt: skip


STEPS = {"kind": "steps", "times": ["1 ms", "3 ms"], "positions": [[1e-7, 0, 0], [0, 2e-7, 0]]}
TABLE = {**STEPS, "kind": "table"}


@pytest.mark.parametrize(
    ("motion", "time", "place"),
    [
        ({"kind": "sine", "amplitude": ["0.2 um", 0, 0], "frequency": "50 Hz"}, 5e-3, [2e-7, 0, 0]),
        ({"kind": "sine", "amplitude": [0, 2e-7, 0], "frequency": 50, "phase": "90 deg"}, 0.0,
         [0, 2e-7, 0]),
        ({"kind": "circle", "radius": "0.2 um", "frequency": "50 Hz"}, 5e-3, [0, 2e-7, 0]),
        ({"kind": "circle", "radius": 2e-7, "frequency": 50, "phase": "90 deg"}, 5e-3,
         [-2e-7, 0, 0]),
        ({"kind": "ramp", "velocity": [1e-4, 0, 0]}, 2e-3, [2e-7, 0, 0]),
        ({"kind": "ramp", "velocity": [1e-4, 0, 0], "begin": "1 ms", "end": "2 ms"}, 0.5e-3,
         [0, 0, 0]),
        ({"kind": "ramp", "velocity": [1e-4, 0, 0], "begin": "1 ms", "end": "2 ms"}, 9e-3,
         [1e-7, 0, 0]),
        (STEPS, 0.9e-3, [0, 0, 0]),
        (STEPS, 1e-3, [1e-7, 0, 0]),
        (STEPS, 5e-3, [0, 2e-7, 0]),
        (TABLE, 2e-3, [0.5e-7, 1e-7, 0]),
        (TABLE, 0.0, [1e-7, 0, 0]),
        ({**STEPS, "period": "4 ms"}, 8.5e-3, [0, 0, 0]),
        ({**STEPS, "period": "4 ms"}, 9e-3, [1e-7, 0, 0]),
        ({**TABLE, "period": "4 ms"}, 10e-3, [0.5e-7, 1e-7, 0]),
    ],
)  # fmt: skip
def test_a_beam_is_where_its_motion_says(motion, time, place):
    scene = ONE.replace(beam={"motion": motion, "position": [0, 0, 1e-7]})
    np.testing.assert_allclose(
        tweezer.optical_force(scene, PLACES, time=time),
        tweezer.optical_force(ONE, PLACES - place - np.array([0, 0, 1e-7])), rtol=1e-9,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("modulation", "time", "factor"),
    [
        ({"kind": "sine", "depth": 0.3, "frequency": "50 Hz"}, 5e-3, 1.3),
        ({"kind": "sine", "depth": 0.3, "frequency": "50 Hz", "phase": "90 deg"}, 10e-3, 0.7),
        ({"kind": "ramp", "factor": 3, "begin": "1 ms", "end": "3 ms"}, 2e-3, 2.0),
        ({"kind": "ramp", "factor": 3, "begin": "1 ms", "end": "3 ms"}, 9e-3, 3.0),
        ({"kind": "on-off", "frequency": "100 Hz"}, 4.9e-3, 1.0),
        ({"kind": "on-off", "frequency": "100 Hz"}, 5e-3, 0.0),
        ({"kind": "on-off", "frequency": "100 Hz", "duty": 0.2}, 13e-3, 0.0),
        ({"kind": "on-off", "frequency": "100 Hz", "duty": 0.2}, 11e-3, 1.0),
        ({"kind": "on-off", "frequency": "100 Hz", "phase": "180 deg"}, 4.9e-3, 0.0),
        ({"kind": "on-off", "frequency": "100 Hz", "phase": "180 deg"}, 5e-3, 1.0),
        ({"kind": "on-off", "frequency": "100 Hz", "phase": "36 deg"}, 3.9e-3, 1.0),
        ({"kind": "on-off", "frequency": "100 Hz", "phase": "36 deg"}, 4e-3, 0.0),
        ({"kind": "on-off", "frequency": "100 Hz", "phase": "36 deg"}, 9e-3, 1.0),
        ({"kind": "on-off", "frequency": "100 Hz", "phase": "-36 deg"}, 0.9e-3, 0.0),
        ({"kind": "steps", "times": ["1 ms", "2 ms"], "factors": [0.5, 2]}, 0.0, 1.0),
        ({"kind": "steps", "times": ["1 ms", "2 ms"], "factors": [0.5, 2]}, 1.5e-3, 0.5),
        ({"kind": "table", "times": ["1 ms", "2 ms"], "factors": [0.5, 2]}, 1.5e-3, 1.25),
    ],
)
def test_a_beam_is_as_strong_as_its_modulation_says(modulation, time, factor):
    scene = ONE.replace(beam={"modulation": modulation})
    np.testing.assert_allclose(
        tweezer.optical_force(scene, PLACES, time=time),
        factor * tweezer.optical_force(ONE, PLACES), rtol=1e-9, atol=1e-30,
    )  # fmt: skip


# --- scenes ---------------------------------------------------------------------------------------


def test_a_table_is_read_from_the_folder_of_the_scene(tmp_path):
    text = tweezer.shipped_scenes()["moving-trap"].read_text(encoding="utf-8")
    head, _, rest = text.partition("[beam.motion]")
    motion = '[beam.motion]\nkind = "table"\nfile = "way.csv"\n\n[start]'
    (tmp_path / "mine.toml").write_text(head + motion + rest.partition("[start]")[2])
    (tmp_path / "way.csv").write_text("t (s),x (m),y (m),z (m)\n0,0,0,0\n1e-3,1e-6,0,2e-7\n")
    scene = tweezer.load_scene(tmp_path / "mine.toml")
    assert scene.beam.motion.times == (0.0, 1e-3)
    assert scene.beam.motion.positions == ((0, 0, 0), (1e-6, 0, 2e-7))
    # what a run keeps of it is whole
    assert tweezer.Scene.model_validate_json(scene.model_dump_json(exclude_none=True)) == scene

    # as do a key on the command line and a mapping, from the folder they are used in
    file = tmp_path / "way.csv"
    settings = {"beam.motion.kind": "table", "beam.motion.file": str(file)}
    assert with_settings(ONE, settings).beam.motion == scene.beam.motion
    of_second = {key.replace("beam", "beam[2]"): value for key, value in settings.items()}
    second = with_settings(TWO, of_second)
    assert (second.beams[0].motion, second.beams[1].motion) == (None, scene.beam.motion)
    assert "changed: beam.motion = {kind = table, file = " in with_settings(ONE, settings).title

    for wrong, said in (
        ("0,0,0\n", "row 1: must have 4 numbers"),
        ("0,0,0,0\n1,x,0,0\n", "row 2: must be"),
    ):
        (tmp_path / "way.csv").write_text(wrong)
        with pytest.raises(SceneError, match=said):
            tweezer.load_scene(tmp_path / "mine.toml")
    (tmp_path / "way.csv").unlink()
    with pytest.raises(SceneError, match=r"way.csv: cannot be read: No such file"):
        tweezer.load_scene(tmp_path / "mine.toml")


@pytest.mark.parametrize(
    ("beam", "said"),
    [
        ({"motion": {"kind": "spiral"}}, "beam.motion.kind = 'spiral': allowed: 'sine', 'circle'"),
        ({"motion": {"kind": "ramp"}}, "beam.motion.velocity: missing; kind = 'ramp' requires it"),
        ({"motion": {"kind": "ramp", "velocity": [1, 0, 0], "phase": 1}},
         "beam.motion.phase: does not apply to kind = 'ramp'"),
        ({"motion": {**STEPS, "times": ["3 ms", "1 ms"]}}, "beam.motion.times: must ascend"),
        ({"motion": {**STEPS, "period": "2.9 ms"}},
         "beam.motion.period = 0.0029 s: must be at least the last time, 0.003 s"),
        ({"motion": {"kind": "ramp", "velocity": [1, 0, 0], "period": 1}},
         "beam.motion.period: does not apply to kind = 'ramp'"),
        ({"modulation": {"kind": "table", "times": [1, 2], "factors": [1, 2], "period": 1}},
         "beam.modulation.period = 1 s: must be at least the last time, 2 s"),
        ({"motion": {**STEPS, "times": ["3 ms"]}}, "must have as many as times"),
        ({"motion": {"kind": "ramp", "velocity": [1, 0, 0], "begin": 2, "end": 1}},
         "beam.motion.end = 1: must be later than begin"),
        ({"modulation": {"kind": "sine", "depth": 2, "frequency": 1}},
         "beam.modulation.depth = 2: must be from 0 to 1"),
        ({"modulation": {"kind": "sine", "depth": 1, "frequency": "1 rad/s"}},
         "beam.modulation.frequency = '1 rad/s': has an unknown unit; .* Hz, kHz"),
        ({"modulation": {"kind": "on-off", "frequency": 1, "speed": 3}},
         "beam.modulation.speed = 3: unknown key; allowed: kind, .*, factors, period, file$"),
        ({"motion": {"kind": "table", "file": 3}}, "beam.motion.file = 3: unknown key"),
        ({"direction": "left"}, "beam.direction = 'left': allowed: 'up' or 'down'"),
    ],
)  # fmt: skip
def test_a_beam_that_cannot_be_is_refused_in_one_line(beam, said):
    with pytest.raises(SceneError, match=said) as refused:
        ONE.replace(beam=beam)
    assert len(str(refused.value).splitlines()) == 1


def test_several_beams_are_written_and_refused_as_they_are_counted():
    beams = [beam_of(ONE), beam_of(ONE, power_through_pupil=-1.0)]
    for number, given in ((2, beams), (1, beams[::-1])):
        said = rf"^beam\[{number}\]\.power_through_pupil = -1\.0: must be from 0"
        with pytest.raises(SceneError, match=said):
            ONE.replace(beam=given)
    with pytest.raises(SceneError, match="beam: at least one beam is required"):
        ONE.replace(beam=[])
    three = ONE.replace(beam=[beam_of(ONE)] * 3)
    assert len(three.beams) == 3
    assert three.title.endswith("changed: beam = 3 of them")
    assert three.replace(beam=[beam_of(ONE)]).beams == ONE.beams
    weaker = with_settings(three, {"beam[2].power": "5 mW", "beam[3].waist": "4 mm"})
    assert weaker.title.endswith(" 3 of them, beam[2].power = 5 mW, beam[3].waist = 4 mm")
    assert [beam.power for beam in weaker.beams] == [None, 5e-3, None]
    assert (weaker.beams[0], weaker.beams[2].sigma) == (ONE.beam, 2e-3)
    undone = weaker.replace(**{"beam[2]": {"power_through_pupil": ONE.beam.power_through_pupil}})
    assert undone.beams[1] == ONE.beam
    assert "beam[2].power =" not in undone.title
    assert "  light    150 mW at 1064 nm, 3 beams; wave optics" in repr(three)
    assert repr(three).endswith("  changed  3 beams")
    for scene, key, said in (
        (three, "beam.power", r"beam\.power: does not name a beam; the scene has 3 beams, "),
        (three, "beam[4].power", r"beam\[4\]: the scene has 3 beams, beam\[1\] to beam\[3\]"),
        (ONE, "beam[1].power", r"beam\[1\]: the scene has one beam, beam"),
    ):
        with pytest.raises(SceneError, match=f"^{said}"):
            with_settings(scene, {key: "5 mW"})
    with pytest.raises(SceneError, match=r"^beam\[2\]: cannot be combined with beam"):
        three.replace(**{"beam": beams, "beam[2]": {"power": 1}})
    with pytest.raises(SceneError, match=r"^beam\[2\] = \[1\]: must be a section \[\[beam\]\]$"):
        three.replace(**{"beam[2]": [1]})
    assert repr(TWO.replace(beam=[TWO.beam])).endswith("  changed  one beam")
    assert TWO.replace(bead={"radius": "0.4 um"}).more_beams == TWO.more_beams
    moving = ONE.replace(beam={"motion": TABLE})
    assert moving.replace(beam={"motion": {"times": [0, 1]}}).beam.motion.times == (0, 1)
    faster = tweezer.load_scene("moving-trap").replace(
        beam={"motion": {"velocity": ["2 mm/s", 0, 0]}}
    )
    assert faster.beam.motion.end == 4e-3


@pytest.mark.parametrize(
    ("scene", "changes", "said"),
    [
        (ONE, {"more_beams": [ONE.beam]}, "more_beams: beam = [...] replaces all beams, and beam["),
        (TWO, {"more_beams": []}, "more_beams: beam = [...] replaces all"),
        (TWO, {"more_beams": {"power": 1}}, "more_beams: beam = [...] replaces all"),
        (
            TWO,
            {"beam": ONE.beam},
            "beam: does not name a beam; the scene has 2 beams, beam[1] to beam[2]",
        ),
        (TWO, {"beam": None}, "beam: does not name a beam"),
        (TWO, {"beam[01]": {"power": 1}}, "beam[01] = {'power': 1}: unknown key"),
        (TWO, {"beam[\u0662]": {"power": 1}}, "beam[\u0662] = {'power': 1}: unknown key"),
    ],
)
def test_no_beam_is_changed_or_lost_in_silence(scene, changes, said):
    with pytest.raises(SceneError, match=f"^{re.escape(said)}"):
        scene.replace(**changes)


def test_a_scene_as_a_mapping_has_its_beams_in_one_way():
    sections = TWO.model_dump(exclude_none=True)
    assert tweezer.load_scene(sections) == TWO
    with pytest.raises(SceneError, match=r"^more_beams: cannot be combined with beam = \[\.\.\.\]"):
        tweezer.load_scene({**sections, "beam": [TWO.beam, TWO.beam]})
    strong = {**sections["beam"], "power_through_pupil": 100}
    with pytest.warns(UnitWarning, match=r"^beam\[2\]\.power_through_pupil = 100 is 100 W"):
        tweezer.load_scene({**sections, "more_beams": [strong]})


def test_what_one_beam_is_needed_for_is_refused(tmp_path):
    track = tmp_path / "track.csv"
    track.write_text("t (s),x (m),y (m)\n" + "".join(f"{i * 1e-3},1e-7,0\n" for i in range(20)))
    with pytest.raises(SceneError, match="only with one fixed beam"):
        tweezer.fit_depth(track, TWO)
    harmonic = ONE.replace(forces={"brownian": True}, simulation={"method": "harmonic"})
    with pytest.raises(SceneError, match="follows a trap at rest"):
        walk(harmonic.replace(beam={"motion": TABLE}))
    walk(harmonic)


# --- traps and runs -------------------------------------------------------------------------------


def test_each_of_two_traps_is_found():
    alone = tweezer.characterise(ONE.replace(beam={"power_through_pupil": "20 mW"}))
    found = tweezer.characterise(TWO)
    stable = sorted(place.position.tolist() for place in found.equilibria if place.stable)
    for place, side in zip(stable, (-1.5e-6, 1.5e-6), strict=True):
        # the other trap, beyond the reach of its gradient, still pushes along the light
        np.testing.assert_allclose(place, [side, 0, alone.equilibrium.position[2]], atol=2e-10)
    assert found.power_through_pupil == pytest.approx(0.04)
    listed = [row.name for row in found.card().rows]
    assert listed.count("another stable equilibrium") == len(stable) - 1
    assert listed.count("unstable equilibrium") == len(found.equilibria) - len(stable)


def test_two_beams_that_face_each_other_hold_a_bead_between_them():
    scene = tweezer.load_scene("optical-stretcher").replace(
        forces={"gravity": False, "buoyancy": False}
    )
    (place,) = tweezer.characterise(scene).equilibria
    np.testing.assert_allclose(place.position, 0, atol=1e-12)
    with warnings.catch_warnings(action="error"):  # the error is small beside that of each beam
        tweezer.optical_force(scene, place.position)
    assert place.stable
    alone = scene.replace(beam=[scene.beam.model_dump(exclude_none=True)])
    assert tweezer.characterise(alone).equilibrium is None


def test_a_bead_lags_behind_a_trap_by_its_drag():
    """k^-1 v beta, for small v."""
    v = 2e-5
    scene = ONE.replace(
        medium={"inertia": "none"},
        beam={"motion": {"kind": "ramp", "velocity": [v, 0, 0]}},
        start={"position": [0, 0, 0]},
        simulation={"duration": "5 ms", "samples": 11, "position_tolerance": 1e-15},
    )  # fmt: skip
    stiffness = np.array(tweezer.characterise(ONE).equilibrium.stiffness)
    run = tweezer.simulate(scene)
    lag = v * run["time"].values[-1] - run["position"].values[-1, 0]
    lags = np.linalg.solve(stiffness, [v * BEAD.drag, 0, 0])
    assert lag == pytest.approx(lags[0], rel=1e-3)
    np.testing.assert_allclose(run["optical_force"].values[-1, 0], v * BEAD.drag, rtol=1e-3)


@pytest.mark.parametrize("kind", ["steps", "table"])
def test_a_course_that_repeats_is_the_course_written_out(kind):
    """A trap shared between two places, and dimmer at one of them, over three periods."""
    times, places = np.array([0.0, 5e-4, 1e-3]), [[-1e-7, 0, 0], [1e-7, 5e-8, 0], [-5e-8, 0, 0]]
    factors, period = [1.0, 0.6, 0.8], 2e-3
    still = ONE.replace(
        medium={"inertia": "none"}, start={"position": [0, 0, 0]},
        simulation={"duration": "6 ms", "samples": 61, "model": "overdamped"},
    )  # fmt: skip
    repeated, by_hand = [], []
    for n in range(4):
        for i in range(3):
            if kind == "table" and n and i == 0:  # the last value is held until the next period
                by_hand.append((n * period, places[-1], factors[-1]))
            by_hand.append((n * period + times[i], places[i], factors[i]))
    for given, how in (
        ((times, places, factors), {"kind": kind, "period": period}),
        (tuple(map(list, zip(*by_hand, strict=True))), {"kind": kind}),
    ):
        t, at, strength = given
        beam = {
            "motion": {**how, "times": list(t), "positions": at},
            "modulation": {**how, "times": list(t), "factors": strength},
        }
        scene = still.replace(beam=beam)
        repeated.append(tweezer.simulate(scene))
        assert scene.last_change == (math.inf if "period" in how else t[-1])
    first, second = (run["position"].values for run in repeated)
    np.testing.assert_allclose(first, second, atol=2e-11)
    assert np.ptp(first[:, 0]) > 3e-8


def test_three_beams_that_take_turns_are_one_beam_that_jumps():
    """The phases of their light differ; two of them jump together, apart from rounding."""
    places, period = [[-1e-7, 0, 0], [1e-7, 0, 0], [0, 1e-7, 0]], 5e-4
    lit = {"kind": "on-off", "frequency": 1 / period, "duty": 1 / 3}
    several = [
        beam_of(ONE, position=place, modulation={**lit, "phase": f"{-120 * i} deg"})
        for i, place in enumerate(places)
    ]
    jumps = {
        "kind": "steps", "times": [0, period / 3, 2 * period / 3], "period": period,
        "positions": places,
    }  # fmt: skip
    runs = []
    for beams in (several, [beam_of(ONE, motion=jumps)]):
        scene = ONE.replace(
            beam=beams, medium={"inertia": "none"}, start={"position": [0, 0, 0]},
            simulation={"model": "overdamped", "duration": "3 ms", "samples": 31},
        )  # fmt: skip
        assert tweezer.Scene.model_validate_json(scene.model_dump_json(exclude_none=True)) == scene
        np.testing.assert_allclose(
            np.unique(light_force(scene).kinks(3e-3).round(12)), np.arange(1, 18) * period / 3,
            atol=1e-12,
        )  # fmt: skip
        runs.append(tweezer.simulate(scene)["position"].values)
    np.testing.assert_allclose(*runs, atol=1e-15)
    assert np.ptp(runs[0][:, 0]) > 1e-7


@pytest.mark.parametrize("method", ["exponential", "scipy:LSODA"])
def test_a_bead_falls_while_the_light_is_off(method):
    """From 2 to 4 ms at its terminal speed, after a start at rest in the trap."""
    height = tweezer.characterise(ONE).equilibrium.position[2]
    scene = ONE.replace(
        medium={"inertia": "none"},
        beam={"modulation": {"kind": "steps", "times": ["2 ms", "4 ms"], "factors": [0, 1]}},
        start={"position": [0, 0, height]},
        simulation={"duration": "8 ms", "samples": 801, "method": method, "model": "full"},
    )
    run = tweezer.simulate(scene)
    t, z = run["time"].values, run["position"].values[:, 2] - height
    speed = BEAD.weight[2] / BEAD.drag
    falling = (t > 2.01e-3) & (t <= 4e-3)
    off = z[falling] - speed * (t[falling] - 2e-3 - BEAD.relaxation_time)
    assert np.abs(off).max() < 1e-11
    assert abs(z[-1]) < 1e-11  # the tolerance
    if method == "exponential":  # a step ends at each kink, and none is taken across
        assert run.attrs["rejected_steps"] <= 4


def test_ensembles_move_the_beams_too():
    scene = tweezer.load_scene("moving-trap").replace(
        forces={"brownian": True}, simulation={"samples": 9}
    )
    many = tweezer.ensemble(scene, 3, seed=8, workers=2)
    run = tweezer.simulate(scene, seed=8)
    np.testing.assert_array_equal(many["position"].values[0], run["position"].values)
    assert run["position"].values[-1, 0] == pytest.approx(2e-6, abs=6e-8)


def test_work_on_a_bead_in_a_moving_trap_obeys_jarzynski():
    """A harmonic trap moved at v for a time t: dF = 0, and the work is Gaussian.

    Its mean is v^2 beta (t - tau (1 - e^(-t/tau))), its variance 2 kT times that (Mazonka and
    Jarzynski 1999), so <exp(-W/kT)> = 1. 5 standard errors of 4096 trajectories, three numbers:
    one seed in 600,000.
    """
    stiffness, n = 2e-5, 4096
    tau = BEAD.drag / stiffness
    t = 2 * tau
    v = math.sqrt(KT / (BEAD.drag * tau))  # a mean work of about kT
    scene = ONE.replace(
        forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
        start={"position": [0, 0, 0], "drawn": "boltzmann"},
        simulation={"model": "overdamped", "duration": t, "samples": 201},
    )
    course = Course(np.array([0.0, t]), np.array([[0.0, 0, 0], [v * t, 0, 0]]), np.zeros(3))
    trap = Moved(LinearTrap(stiffness), course, Course.constant(1.0))
    one = walk(bound_once(scene, [trap]), 19)
    trajectories = np.arange(n)
    states = one.start(trajectories)
    x = np.empty((n, len(one.times)))
    x[:, 0] = states[:, 0]
    out = np.empty((n, len(one.times) - 1, len(one.columns)))
    one.advance(states, trajectories, 0, out)
    x[:, 1:] = out[..., 0]
    power = -stiffness * (x - v * one.times) * v  # dU/da da/dt
    work = np.trapezoid(power, one.times, axis=1) / KT
    mean = v**2 * BEAD.drag * (t - tau * (1 - math.exp(-t / tau))) / KT
    error = math.sqrt(2 * mean / n)
    assert work.mean() == pytest.approx(mean, abs=5 * error)
    assert work.var() == pytest.approx(2 * mean, rel=5 * math.sqrt(2 / n))
    spread = math.sqrt((math.exp(2 * mean) - 1) / n)
    assert np.exp(-work).mean() == pytest.approx(1, abs=5 * spread)


def test_a_bead_hops_between_two_traps_as_boltzmann_says():
    """The histogram along the line of two wells 3 um apart, within a wide weak bowl.

    U = -A (exp(-r1^2/2 s^2) + exp(-r2^2/2 s^2)) + k r^2/2. 1024 beads from one place, after
    many hops; 12 bins, 5 standard errors each: one seed in 140,000.
    """
    A, s, k, n = 3 * KT, 0.7e-6, 1.2 * KT / (1.5e-6) ** 2, 1024
    wells = [
        Moved(GaussianWell(A / s**2, s), Course.constant(x, 0.0, 0.0), Course.constant(1.0))
        for x in (-1.5e-6, 1.5e-6)
    ]
    duration = 30 * BEAD.drag / k
    scene = ONE.replace(
        forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
        start={"position": [1.5e-6, 0, 0]},
        simulation={
            "model": "overdamped", "method": "heun", "duration": duration, "samples": 3,
            "loss_distance": "1 mm",
        },
    )  # fmt: skip
    one = walk(bound_once(scene, [Sum((*wells, LinearTrap(k)))]), 23)
    trajectories = np.arange(n)
    states = one.start(trajectories)
    out = np.empty((n, 2, len(one.columns)))
    one.advance(states, trajectories, 0, out)
    x = out[:, -1, 0]

    edges = np.linspace(-3e-6, 3e-6, 13)
    along = np.linspace(-6e-6, 6e-6, 2401)
    rho = np.linspace(0, 6e-6, 601)
    X, R = np.meshgrid(along, rho, indexing="ij")
    U = k / 2 * (X**2 + R**2) - A * sum(
        np.exp(-((X - c) ** 2 + R**2) / (2 * s**2)) for c in (-1.5e-6, 1.5e-6)
    )
    density = np.trapezoid(np.exp(-U / KT) * R, rho, axis=1)
    cumulative = np.concatenate([[0], np.cumsum((density[1:] + density[:-1]) / 2)])
    expected = np.diff(np.interp(edges, along, cumulative / cumulative[-1])) * n
    counted, _ = np.histogram(x, edges)
    assert np.abs((counted - expected) / np.sqrt(expected * (1 - expected / n))).max() < 5


def test_light_is_bound_once_for_equal_beams():
    assert light_force(TWO).lights[0] is light_force(TWO).lights[1]


def test_the_error_of_the_grid_is_told_of_several_beams_too():
    """The distance to the quadrature, at the time of each sample."""
    scene = TWO.replace(
        optics={"evaluator": "grid"}, simulation={"samples": 5, "duration": "1 ms"},
        **{"beam[1]": {"motion": {"kind": "ramp", "velocity": [1e-4, 0, 0]}}},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    exact = scene.replace(optics={"evaluator": "quadrature", "theory": "rays"})
    for place, time, force, error in zip(
        run["position"].values, run["time"].values, run["optical_force"].values,
        run["force_error"].values, strict=True,
    ):  # fmt: skip
        off = np.linalg.norm(force - tweezer.optical_force(exact, place, time=time))
        assert error == pytest.approx(off, rel=1e-3)


def test_steps_of_thermal_motion_are_short_enough_for_light_that_grows():
    thermal = ONE.replace(
        forces={"brownian": True}, simulation={"duration": "10 ms", "samples": 11}
    )
    grows = {"kind": "ramp", "factor": 20, "begin": 0, "end": "10 ms"}
    step = walk(thermal).step
    assert walk(thermal.replace(beam={"modulation": grows})).step == pytest.approx(
        step / 20, rel=0.3
    )
    off_at_first = {"kind": "steps", "times": [0, "9 ms"], "factors": [0, 1]}
    late = walk(thermal.replace(beam={"modulation": off_at_first})).step
    assert late == pytest.approx(step, rel=0.3)


def test_one_force_is_not_taken_for_a_list():
    with pytest.raises(SceneError, match="forces: must be a list"):
        tweezer.simulate(ONE, "1 us", forces=LinearTrap(1e-6))


@pytest.mark.parametrize(
    "motion",
    [{"kind": "table", "times": [0, 1], "positions": [[8e-6, 0, 0], [8e-6, 0, 1e-9]]},
     {"kind": "sine", "amplitude": [8e-6, 0, 0], "frequency": "1e-3 Hz", "phase": "90 deg"}],
)  # fmt: skip
def test_a_beam_is_looked_for_where_it_is_at_the_begin(motion):
    scene = ONE.replace(
        beam={"motion": motion}, forces={"brownian": True},
        start={"position": [8e-6, 0, 0]}, simulation={"duration": "1 ms", "samples": 3},
    )  # fmt: skip
    still = scene.replace(beam={"motion": None, "position": [8e-6, 0, 0]})
    assert walk(scene).step == pytest.approx(walk(still).step, rel=0.01)
    place = tweezer.characterise(scene).equilibrium.position
    np.testing.assert_allclose(place, tweezer.characterise(still).equilibrium.position, atol=1e-12)


def test_steps_of_thermal_motion_resolve_light_that_blinks():
    blinking = ONE.replace(
        forces={"brownian": True}, simulation={"duration": "1 ms", "samples": 101},
        beam={"modulation": {"kind": "on-off", "frequency": "100 kHz", "duty": 0.25}},
    )  # fmt: skip
    assert walk(blinking).step <= 0.05 * 2.5e-6 * (1 + 1e-9)
    with pytest.raises(SceneError, match="too many"):
        walk(blinking.replace(beam={"modulation": {"frequency": 1e12}}))


@pytest.mark.parametrize("frequency", [90.0, 730.0])
@pytest.mark.parametrize("method", ["dormand-prince", "dop853", "scipy:LSODA"])
def test_the_error_of_a_run_with_many_kinks_is_told(frequency, method):
    """By a run with every step halved, which ends its steps at the same kinks."""
    scene = ONE.replace(
        beam={"modulation": {"kind": "on-off", "frequency": frequency, "duty": 0.77}},
        simulation={"model": "overdamped", "method": method, "duration": "50 ms", "samples": 11},
    )
    run = tweezer.simulate(scene)
    finer = tweezer.simulate(scene, tolerance=1e-11)
    off = np.abs(run["position"].values - finer["position"].values).max()
    assert off < run.attrs["integration_error"] < max(300 * off, 1e-10)


def test_files_of_other_beams_are_not_replaced(tmp_path):
    from tweezer.results.io import unlike

    run = tweezer.simulate(TWO.replace(simulation={"samples": 2}), "1 us")
    tweezer.save_run(run, tmp_path / "two.nc")
    scene = tweezer.Scene.model_validate_json(run.attrs["scene_as_given"])
    assert unlike(tmp_path / "two.nc", scene, 0) == ""
    stronger = scene.replace(
        beam=[beam_of(scene), {**beam_of(scene), "power_through_pupil": "500 mW"}]
    )
    assert unlike(tmp_path / "two.nc", stronger, 0)
    run = tweezer.simulate(scene, forces=[LinearTrap(1e-9)])
    tweezer.save_run(run, tmp_path / "own.nc")
    assert unlike(tmp_path / "own.nc", scene, 0)


def test_beams_given_again_are_the_same_beams():
    assert TWO.replace(beam=TWO.beams).beams == TWO.beams
    stronger = ONE.replace(beam=[beam_of(ONE, power_through_pupil=0.5)])
    assert "changed: beam = 1 of them" in stronger.title


def test_a_dark_beam_has_no_map():
    dark = TWO.replace(
        beam=[beam_of(TWO, power_through_pupil=0.0), beam_of(TWO)], optics={"evaluator": "map"}
    )
    assert np.abs(tweezer.optical_force(dark, [-1.3e-6, 0, 0])).max() > 0
    with pytest.raises(SceneError, match="a map requires a single beam"):
        tweezer.optics.force_map(dark)
