"""Light that interferes, against plane waves, holograms and shifts of the light."""

import cmath
import math

import numpy as np
import pytest

import tweezer
from tests.optics.waves.test_pupil import EVEN, N_M, ONE, VACUUM, reference
from tests.reference.plane_waves import Cone, Sphere, Together, push
from tweezer import SceneError
from tweezer.optics import force_map, light_force

PLACES = np.array([[0.2, -0.15, 0.25], [0.3, 0.35, -0.2], [0, 0, 0.1]]) * 1e-6
SILICA = Sphere(((0.5e-6, 1.45),))
LINEAR = reference([])
DOWN = {"direction": "down"}


def scene_with(*beams, **sections):
    """Return the evenly lit scene with these keys of its beams, and other sections."""
    described = EVEN.model_dump(exclude_none=True)
    del described["more_beams"]
    found = []
    for keys in beams:
        beam = {**described["beam"], **keys}
        if beam["polarisation"] != "linear":
            del beam["jones"]
        found.append(beam)
    described["beam"] = found if len(found) > 1 else found[0]
    return tweezer.load_scene({**described, **sections})


def together(*cones):
    return Together(tuple(Cone(LINEAR, **keys) if "light" not in keys else Cone(**keys)
                          for keys in cones))  # fmt: skip


RIGHT, LEFT = (reference([], polarisation=(ONE, sign * ONE * 1j)) for sign in (1, -1))
BOTH = reference([], polarisation="unpolarised")
CIRCULAR, UNPOLARISED = {"polarisation": "circular"}, {"polarisation": "unpolarised"}
OTHER = {"jones": [1, "-1j"]}
A, HALF = {"coherent": "a"}, [0.4e-6, 0.1e-6, 0.2e-6]
CASES = {
    "two foci": (
        [{**A, "position": HALF, "phase": 0.7}, {**A, "position": [-0.3e-6, 0, 0]}], {},
        [{"place": HALF, "size": cmath.exp(0.7j)}, {"place": (-0.3e-6, 0, 0)}],
    ),
    "standing wave": ([A, {**A, **DOWN, "phase": 1.0}], {},
                      [{}, {"down": True, "size": cmath.exp(1j)}]),
    "shifted standing wave, circular": (
        [{**A, **CIRCULAR, "position": HALF}, {**A, **DOWN, **OTHER, "position": [0, 0, -0.1e-6]}],
        {},
        [{"light": RIGHT, "place": HALF}, {"light": LEFT, "down": True, "place": (0, 0, -0.1e-6)}],
    ),
    "perfect mirror": ([{}], {"mirror": {"position": 1.5e-6}}, [{}, {"mirror": (1.5e-6, None)}]),
    "glass": ([CIRCULAR], {"mirror": {"position": 1.2e-6, "refractive_index": 1.52}},
              [{"light": RIGHT}, {"light": RIGHT, "mirror": (1.2e-6, 1.52)}]),
    "metal below": (
        [{**CIRCULAR, **DOWN}],
        {"mirror": {"position": -1e-6, "refractive_index": "0.26+6.97j"}},
        [{"light": RIGHT, "down": True},
         {"light": RIGHT, "down": True, "mirror": (-1e-6, 0.26 + 6.97j)}],
    ),
    "unpolarised at a wall": (
        [{**UNPOLARISED, "position": [0, 0.2e-6, 0.3e-6]}],
        {"wall": {"position": 1.5e-6, "side": "below", "reflects": True}},
        [{"light": BOTH, "place": (0, 0.2e-6, 0.3e-6)},
         {"light": BOTH, "place": (0, 0.2e-6, 0.3e-6), "mirror": (1.5e-6, 1.518)}],
    ),
    "both ways at a mirror": (
        [{**A, "power_through_pupil": 0.25}, {**A, "phase": 2.0, "position": [0.3e-6, 0, 0]}],
        {"mirror": {"position": 1.5e-6}},
        [{"size": 0.5}, {"size": 0.5, "mirror": (1.5e-6, None)},
         {"size": cmath.exp(2j), "place": (0.3e-6, 0, 0)},
         {"size": cmath.exp(2j), "place": (0.3e-6, 0, 0), "mirror": (1.5e-6, None)}],
    ),
}  # fmt: skip


@pytest.mark.parametrize(("beams", "sections", "cones"), CASES.values(), ids=CASES.keys())
def test_force_is_that_of_plane_waves(beams, sections, cones):
    """Within 1e-9 of the largest component; the stated error is not below the true one."""
    scene = scene_with(*beams, **sections)
    expected = push(together(*cones), SILICA, PLACES).force
    found = tweezer.optical_force(scene, PLACES)
    largest = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * largest)
    stated = tweezer.optical_force_error(scene, PLACES)
    assert (np.linalg.norm(found - expected, axis=1) <= stated + 1e-11 * largest).all()


def test_torque_absorption_and_gradient_are_those_of_plane_waves():
    """An absorbing bead in a circular standing wave: 1e-9 of the largest, gradient 1e-6."""
    described = EVEN.bead.model_dump(exclude_none=True)
    bead = {**described, "refractive_index": "1.5+0.01j"}
    scene = scene_with({**A, **CIRCULAR}, {**A, **OTHER, **DOWN}, bead=bead)
    light = together({"light": RIGHT}, {"light": LEFT, "down": True})
    expected = push(light, Sphere(((0.5e-6, 1.5 + 0.01j),)), PLACES)
    found = tweezer.light(scene).field(PLACES)
    for name, values in (
        ("force", expected.force), ("torque", expected.torque),
        ("absorbed_power", expected.absorbed),
    ):  # fmt: skip
        largest = np.abs(values).max()
        np.testing.assert_allclose(found[name], values, rtol=0, atol=1e-9 * largest)
    step = 1e-10
    for axis in range(3):
        shift = step * np.eye(3)[axis]
        ends = [tweezer.optical_force(scene, PLACES + side * shift) for side in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * step)
        largest = np.abs(found["gradient"]).max()
        np.testing.assert_allclose(found["gradient"][:, :, axis], slope, rtol=0,
                                   atol=1e-6 * float(largest))  # fmt: skip


def test_coherent_foci_of_a_sum_are_a_hologram():
    """Foci of two beams push as a hologram with both, apart from the power that is normalised."""
    foci = [{"position": [0.5e-6, 0, 0]}, {"position": [-0.4e-6, 0.2e-6, 0.1e-6], "phase": 0.5}]
    pair = scene_with(*({**A, **keys} for keys in foci))
    hologram = scene_with({"focus": foci})
    ratio = tweezer.optical_force(pair, PLACES) / tweezer.optical_force(hologram, PLACES)
    np.testing.assert_allclose(ratio, ratio.mean(), rtol=1e-10)


def test_forces_of_other_beams_still_add():
    """A beam without the name, and beams of another name, do not interfere with a pair."""
    pair = [{**A, "position": HALF}, A]
    others = [{"coherent": "b"}, {"coherent": "b", **DOWN}, {"position": [0, 0, 0.3e-6]}]
    separate = [pair, others[:2], others[2:]]
    expected = sum(tweezer.optical_force(scene_with(*each), PLACES) for each in separate)
    found = tweezer.optical_force(scene_with(*pair, *others), PLACES)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


COURSES = {
    "ramp": ({"kind": "ramp", "rate": 40.0, "begin": 0.01}, 2 * math.pi * 40 * 0.013),
    "backwards": ({"kind": "ramp", "rate": -40.0}, -2 * math.pi * 40 * 0.023),
    "sine": ({"kind": "sine", "amplitude": 2.0, "frequency": 30.0, "phase": 0.3},
             2 * math.sin(2 * math.pi * 30 * 0.023 + 0.3)),
    "steps": ({"kind": "steps", "times": [0.01, 0.02], "phases": [1.0, 3.0]}, 3.0),
    "table": ({"kind": "table", "times": [0.02, 0.03], "phases": [0.0, 1.0]}, 0.3),
}  # fmt: skip


@pytest.mark.parametrize(("course", "phase"), COURSES.values(), ids=COURSES.keys())
def test_phase_in_time_is_the_phase_then(course, phase):
    """At 23 ms the force is the force of a constant phase, on top of the beam's own."""
    moving = scene_with(A, {**A, **DOWN, "phase": 0.4, "phasing": course})
    still = scene_with(A, {**A, **DOWN, "phase": 0.4 + phase})
    found = tweezer.light(moving).field(PLACES, time=0.023)["force"]
    expected = tweezer.optical_force(still, PLACES)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_motion_and_modulation_of_a_coherent_beam():
    moving = scene_with(A, {
        **A, "motion": {"kind": "ramp", "velocity": [1e-5, 0, 2e-5]},
        "modulation": {"kind": "ramp", "factor": 0.25, "end": 0.01},
    })  # fmt: skip
    still = scene_with(A, {**A, "position": [2e-7, 0, 4e-7], "power_through_pupil": 0.25})
    found = tweezer.light(moving).field(PLACES, time=0.02)["force"]
    expected = tweezer.optical_force(still, PLACES)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())
    force = light_force(moving)
    assert not force.steady
    assert 0.01 in force.kinks(0.02)


def test_conveyor_carries_the_bead():
    """A 400 nm bead follows the antinodes: rate times half of the wavelength in the medium."""
    bead = {"diameter": 0.4e-6, "density": 1050.0, "refractive_index": 1.57}
    rate, weak = 100.0, {**A, "power_through_pupil": 0.05}
    scene = scene_with(
        weak, {**weak, **DOWN, "phasing": {"kind": "ramp", "rate": rate}},
        bead=bead, simulation={"duration": 0.01, "samples": 11}, start={"position": [0, 0, 0]},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    z = run.position.sel(axis="z")
    velocity = np.polyfit(run.time[2:], z[2:], 1)[0]
    waves = VACUUM / (2 * N_M)  # of plane waves; the waves of a cone are longer
    assert 1.0 < float(velocity) / (rate * waves) < 1.4


MAPPED = {
    "standing wave": ([A, {**A, **DOWN, "phase": 1.0, "position": [1e-7, 0, 0]}], {}),
    "standing wave, at another place": (
        [A, {**A, **DOWN, "phase": 1.0, "position": [-1e-7, 0, 0]}], {}
    ),
    "mirror": ([{}], {"mirror": {"position": 1.6e-6, "refractive_index": 1.52}}),
}  # fmt: skip


@pytest.mark.parametrize(("beams", "sections"), MAPPED.values(), ids=MAPPED.keys())
def test_map_has_the_certified_error(beams, sections):
    """At 500 random places in the box; the map is made again from the file."""
    optics = {"evaluator": "map", "table_tolerance": 1e-6, "table_range": "0.5 um"}
    scene = scene_with(*beams, **sections, optics={**optics, "tolerance": 1e-9})
    table = force_map(scene)
    direct = scene.replace(optics={"evaluator": "quadrature"})
    places = np.random.default_rng(0).uniform(-0.49e-6, 0.49e-6, (500, 3))
    expected = tweezer.optical_force(direct, places)
    found = tweezer.optical_force(scene, places)
    off = np.linalg.norm(found - expected, axis=1).max()
    stated = tweezer.optical_force_error(scene, places)
    assert off <= stated.min()
    assert table.certified_error <= 1e-6 * table.largest_force * 1.01
    far = [[0.0, 0.0, -2e-6]]
    np.testing.assert_allclose(
        tweezer.optical_force(scene, far), tweezer.optical_force(direct, far), rtol=1e-9
    )


FAR = {"coherent": [A, {**A, **DOWN}], "separate": [{}, DOWN],
       "uneven": [{"aberration": [[2, 2, 0.1]]}]}  # fmt: skip


@pytest.mark.parametrize("beams", FAR.values(), ids=FAR.keys())
def test_force_too_far_from_the_foci_is_refused(beams):
    with pytest.raises(SceneError, match="too far from the foci"):
        tweezer.optical_force(scene_with(*beams), [[0.0, 0.0, 0.0], [0.0, 0.0, -1e-3]])


WRONG = {
    "phase alone": ([{"phase": 1.0}], {}, "beam.phase: requires beam.coherent"),
    "phasing alone": ([{"phasing": {"kind": "ramp", "rate": 1.0}}], {},
                      "beam.phasing: requires beam.coherent"),
    "one name": ([A, {}], {}, "beam[1].coherent = 'a': no other beam"),
    "two colours": ([A, {**A, "wavelength": 1.0e-6}], {}, "beam[1].wavelength = 1.064e-06: must"),
    "unpolarised": ([A, {**A, **UNPOLARISED}], {}, "beam[2].polarisation = 'unpolarised': a coh"),
    "rays": ([A, A], {"optics": {"theory": "rays"}}, "beam[1].coherent: requires wave optics"),
    "map": ([A, {**A, "phasing": {"kind": "ramp", "rate": 1.0}}],
            {"optics": {"evaluator": "map"}}, "optics.evaluator = 'map': requires light that int"),
    "in the mirror": ([{}], {"mirror": {"position": 0.1e-6}}, "mirror.position = 1e-07: the bead"),
    "behind the light": ([{}], {"mirror": {"position": -2e-6}}, "mirror.position = -2e-06: no be"),
    "wall at the mirror": (
        [{}],
        {"mirror": {"position": 2e-6},
         "wall": {"position": 2e-6, "side": "below", "reflects": True}},
        "mirror.position = 2e-06: a wall on the same side",
    ),
    "no position": ([{}], {"mirror": {}}, "mirror.position: missing"),
    "index alone": ([{}], {"wall": {"position": -2e-6, "refractive_index": 1.5}},
                    "wall.refractive_index: requires reflects = true"),
    "name": ([{"coherent": "a/b"}, {}], {}, "beam[1].coherent = 'a/b': must begin with a letter"),
    "wrong course": ([A, {**A, "phasing": {"kind": "ramp", "rate": 1.0, "phases": [1]}}],
                     {}, "beam[2].phasing.phases: does not apply to kind = 'ramp'"),
    "uneven course": ([A, {**A, "phasing": {"kind": "table", "times": [0, 1], "phases": [1.0]}}],
                      {}, "beam[2].phasing.phases: has 1 entries"),
    "no rate": ([A, {**A, "phasing": {"kind": "ramp"}}], {}, "beam[2].phasing.rate: missing"),
    "body": ([A, A], {"bead": {"shape": "spheroid", "diameter": 1e-6, "length": 2e-6,
                               "density": 2000.0, "refractive_index": 1.45}},
             "beam[1].coherent: requires bead.shape = 'sphere'"),
}  # fmt: skip


@pytest.mark.parametrize(("beams", "sections", "line"), WRONG.values(), ids=WRONG.keys())
def test_wrong_keys_are_refused_in_one_line(beams, sections, line):
    with pytest.raises(SceneError) as refused:
        scene_with(*beams, **sections)
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)
