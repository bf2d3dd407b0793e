"""Runs of several beads: closed forms of sedimentation and of traps, and what a run contains."""

import json
import math

import numpy as np
import pytest
from scipy.linalg import expm

import tweezer
from tests.beads.springs import KT, UNIT, in_traps
from tweezer.beads import many
from tweezer.beads.equilibrium import equilibrium, rates, velocities
from tweezer.beads.system import system
from tweezer.beads.thermal import coupled
from tweezer.fluid.many import many_mobility
from tweezer.fluid.pair import NAMES, exact
from tweezer.values.errors import ResultError, SceneError

A = 0.5e-6
ONE = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)


def beads(*starts, diameters=("1 um", "1 um"), **sections):
    """Return the scene of dark beads in water at starts, m."""
    data = {key: value for key, value in ONE.items() if key not in ("start", "name")}
    data["simulation"] = {"duration": "2 ms", "samples": 11} | sections.pop("simulation", {})
    data["forces"] = {"optical": False, "gravity": False} | sections.pop("forces", {})
    data["bead"] = [
        {"diameter": size, "density": 2000.0, "refractive_index": 1.45, "start": list(start)}
        for start, size in zip(starts, diameters, strict=True)
    ]
    return tweezer.load_scene(data | sections)


@pytest.mark.parametrize("second", ["1 um", "0.4 um"])
def test_sedimentation_of_a_pair(second):
    """Beads beside each other and above each other fall by the exact mobilities, to 1e-8."""
    for axis, (own, cross) in ((0, ("y", "y12")), (2, ("x", "x12"))):
        start = np.zeros((2, 3))
        start[1, axis] = 1.6e-6
        scene = beads(*start.tolist(), diameters=("1 um", second), forces={"gravity": True})
        radii = [each.radius for each in scene.beads]
        unit = 1 / (6 * math.pi * scene.medium.viscosity)
        found, _ = exact(*radii, 1.6e-6 - sum(radii))
        of = dict(zip(NAMES, found * unit, strict=True))
        weight = [4 / 3 * math.pi * r**3 * (2000 - scene.medium.density) * -9.80665 for r in radii]
        expected = [
            of[f"{own}11"] * weight[0] + of[cross] * weight[1],
            of[cross] * weight[0] + of[f"{own}22"] * weight[1],
        ]
        fall = velocities(system(scene), 0.0, start.ravel()).reshape(2, 3)
        np.testing.assert_allclose(fall[:, 2], expected, rtol=1e-8)
        np.testing.assert_allclose(fall[:, :2], 0, atol=1e-9 * abs(expected[0]))


def test_approach_of_beads_that_a_spring_pulls_together():
    """The time from one gap to another is the integral of dg/(a F), by quadrature."""
    from scipy.integrate import quad

    tether = {"model": "spring", "between": ["1", "2"], "stiffness": 1e-6}
    scene = beads((0, 0, 0), (1.5e-6, 0, 0), tether=[tether],
                  simulation={"duration": "40 ms", "samples": 401, "relative_tolerance": 1e-10,
                              "position_tolerance": "1e-16 m"})  # fmt: skip
    run = tweezer.simulate(scene)
    gap, unit = run.gap.values[:, 0], 1 / (6 * math.pi * scene.medium.viscosity)

    def slowness(g):
        return 1 / (unit * exact(A, A, g)[0][NAMES.index("relative_x")] * 1e-6 * g)

    for last in (100, 400):
        took, _ = quad(slowness, gap[last], gap[0], epsrel=1e-10)
        assert took == pytest.approx(run.time.values[last], rel=1e-8)
    assert run.attrs["integration_error"] < 1e-14
    np.testing.assert_allclose(run.force_between[:, 0], 1e-6 * run.gap[:, 0], rtol=1e-12)


def test_three_beads_in_traps():
    """Equipartition of each coordinate, and e^(-M K t) kT/K between the outer ones."""
    L, k, copies = 2e-6, 3e-6, 6000
    radii, centres = (A, 0.6 * A, A), np.array([[0, 0, 0], [L, 0, 0], [2 * L, 0, 0]])
    fluid = many.fluid_of(np.array(radii), UNIT, near=False)
    M = many.mobility(fluid, centres)
    step = 0.05 / (k * M[3, 3])
    rng = np.random.default_rng(3)
    begun = rng.normal(size=(copies, 3, 3)) * math.sqrt(KT / k)
    x = begun + centres
    acting = in_traps(radii, centres, [k] * 3)
    out = np.empty((copies, 2, 3, 3))
    many.advance(acting, fluid, KT, 1, step, np.arange(copies), 0, 15, x, out)
    C = expm(-k * M * step * 30) * KT / k
    now = (x - centres).reshape(copies, 9)
    products = now[:, :, None] * begun.reshape(copies, 1, 9)
    error = products.std(axis=0) / math.sqrt(copies)
    assert (np.abs(products.mean(axis=0) - C) < 5 * error + 0.02 * np.abs(C)).all()
    squares = now**2 * k / KT
    assert (np.abs(squares.mean(axis=0) - 1) < 5 * squares.std(axis=0) / math.sqrt(copies)).all()


def test_mobility_of_three_is_symmetric_and_becomes_that_of_pairs():
    """Far beads agree with the exact mobilities within the order (a/r)^4."""
    fluid = many.fluid_of(np.array([A, 0.5 * A, A]), UNIT, near=False)
    place = np.array([[0, 0, 0], [10 * A, 0, 0], [0, 1e4 * A, 0]])
    M = many.mobility(fluid, place)
    np.testing.assert_array_equal(M, M.T)
    assert np.linalg.eigvalsh(M)[0] > 0
    of = dict(zip(NAMES, UNIT * exact(A, 0.5 * A, 8.5 * A)[0], strict=True))
    assert M[0, 3] == pytest.approx(of["x12"], rel=1e-3)
    assert M[1, 4] == pytest.approx(of["y12"], rel=1e-4)


def test_lubrication_of_three_is_that_of_the_fluid():
    """The compiled mobility is the translational part of `many_mobility`, at gaps of 0.02 to 4."""
    radii = np.array([A, 0.5 * A, 0.8 * A])
    place = np.array([[0, 0, 0], [1.52 * A, 0, 0], [0.5 * A, 2.5 * A, 0.6 * A]])
    M = many.mobility(many.fluid_of(radii, UNIT, near=True), place)
    expected = many_mobility(place, radii, 1e-3).matrix[:9, :9]
    np.testing.assert_allclose(M, expected, rtol=0, atol=1e-9 * np.abs(M).max())


def test_three_beads_pressed_together():
    """Gaps of three beads on a line are Boltzmann's, the mean within 12 %."""
    k, copies, L = 60 * KT / A**2, 160, 2.05 * A
    radii, centres = (A, A, A), np.array([[0, 0, 0], [L, 0, 0], [2 * L, 0, 0]])
    fluid = many.fluid_of(np.array(radii), UNIT, near=True)
    acting = in_traps(radii, centres, [k] * 3)
    step = 0.05 * A / (UNIT * k)
    x = np.tile(centres * 1.05, (copies, 1, 1))
    out = np.empty((copies, 60, 3, 3))
    many.advance(acting, fluid, KT, 1, step, np.arange(copies), 0, 5, x, out)
    rng = np.random.default_rng(5)
    y = rng.normal(size=(400_000, 3, 3)) * math.sqrt(KT / k) + centres

    def gaps(x):
        return np.linalg.norm(np.diff(x, axis=-2), axis=-1) - 2 * A

    allowed = gaps(y)[(gaps(y) > 0).all(axis=1)]
    found = gaps(out[:, 20:])
    error = found.mean(axis=(1, 2)).std() / math.sqrt(copies)
    assert abs(found.mean() - allowed.mean()) < 5 * error + 0.02 * allowed.mean()
    assert 5 * error < 0.12 * allowed.mean()
    assert found.min() > 0


def two_traps(**sections):
    """Return two beads in two traps of the light, by tables."""
    beam = ONE["beam"]
    lit = {
        "beam": [beam | {"position": [x, 0, 0]} for x in (-1.5e-6, 1.5e-6)],
        "forces": {"optical": True, "brownian": True}, "start": {"drawn": "equilibrium"},
    }  # fmt: skip
    return beads((-1.5e-6, 0, 0), (1.5e-6, 0, 0), **(lit | sections))


def test_run_contains_beads_pairs_and_provenance(tmp_path):
    scene = two_traps(simulation={"duration": "0.2 ms", "samples": 21})
    run = tweezer.simulate(scene, seed=4)
    assert run.position.dims == ("time", "bead", "axis")
    assert run.distance.dims == run.force_between.dims == ("time", "pair")
    assert run.bead.values.tolist() == ["1", "2"]
    apart = np.linalg.norm(run.position.values[:, 1] - run.position.values[:, 0], axis=1)
    np.testing.assert_array_equal(run.distance.values[:, 0], apart)
    assert run.attrs["status"] == "complete"
    assert 0 < run.attrs["model_error"] < 1e-8
    binding = tweezer.optical_binding(scene, run.position[0].values)
    largest = np.linalg.norm(binding.scattered, axis=1).max()
    assert run.attrs["optical_binding"] == pytest.approx(largest, rel=1e-9)
    assert json.loads(run.attrs["scene_as_given"])["more_beads"]
    again = tweezer.simulate(scene, seed=4)
    np.testing.assert_array_equal(again.position, run.position)
    assert not np.array_equal(tweezer.simulate(scene, seed=5).position, run.position)
    path = tweezer.save(run, tmp_path / "run.nc")
    assert tweezer.load(path).identical(run)
    for key in ("continue_from", "events", "forces"):
        with pytest.raises(SceneError, match=key):
            tweezer.simulate(scene, **{key: [1]})
    with pytest.raises((SceneError, ResultError)):
        tweezer.calibrate(run)


def test_each_bead_rests_where_it_rests_alone():
    """Far apart, equilibria and stiffness are the same as for single beads."""
    scene = two_traps()
    bound = system(scene)
    found = equilibrium(bound)
    for k in (1, 2):
        every = [each.position for each in tweezer.characterise(scene.alone(k)).equilibria]
        nearest = min(every, key=lambda place, k=k: np.linalg.norm(place - found[k - 1]))
        np.testing.assert_allclose(found[k - 1], nearest, atol=1e-13)
    stiffness = bound.stiffness(found)
    assert np.abs(stiffness[:3, 3:]).max() < 1e-6 * stiffness.max()
    assert rates(bound, found)[0] > 0


def test_chain_pulls_both_beads():
    tether = {"model": "marko-siggia", "between": ["1", "2"], "contour_length": "3 um",
              "persistence_length": "50 nm"}  # fmt: skip
    scene = two_traps(tether=[tether])
    bound = system(scene)
    x = bound.start[None]
    pull = tweezer.chain_force(
        "marko-siggia", "2 um", contour_length="3 um", persistence_length="50 nm",
        temperature=scene.medium.temperature,
    )  # fmt: skip
    assert bound.tension(x)[0, 0] == pytest.approx(float(pull), rel=2e-6)
    free = system(two_traps()).forces(x)
    np.testing.assert_allclose((bound.forces(x) - free)[0, :, 0], [pull, -pull], rtol=2e-6)


@pytest.mark.parametrize(
    ("between", "energy"),
    [
        (
            {"kind": "dlvo", "strength": "1e-18 J", "debye_length": "50 nm",
             "hamaker_constant": "1e-20 J"},
            lambda g: 1e-18 * math.exp(-g / 50e-9) - 1e-20 * A / 12 / g,
        ),
        (
            {"kind": "wca", "strength": "1e-20 J", "range": "200 nm"},
            lambda g: 4e-20 * ((2e-7 / (g + 2e-7)) ** 12 - (2e-7 / (g + 2e-7)) ** 6)
            if g < (2 ** (1 / 6) - 1) * 2e-7 else -1e-20,
        ),
        (
            {"kind": "hertz", "modulus": "1 kPa", "range": "100 nm"},
            lambda g: 8 / 15 * 1e3 * math.sqrt(A / 2) * max(1e-7 - g, 0) ** 2.5,
        ),
        ({"kind": "spring", "stiffness": "1e-6 N/m", "gap": "30 nm"},
         lambda g: 0.5e-6 * (g - 30e-9) ** 2),
    ],
)  # fmt: skip
def test_force_between_surfaces_is_the_slope_of_its_energy(between, energy):
    for gap in (10e-9, 40e-9, 300e-9):
        scene = beads((0, 0, 0), (2 * A + gap, 0, 0), forces={"between": between})
        bound = system(scene)
        slope = (energy(gap * 1.0001) - energy(gap / 1.0001)) / (gap * (1.0001 - 1 / 1.0001))
        assert bound.tension(bound.start[None])[0, 0] == pytest.approx(slope, rel=1e-6, abs=1e-20)


def test_lost_bead_ends_the_run():
    scene = beads(
        (0, 0, 0), (1.5e-6, 0, 0), forces={"gravity": True, "brownian": True},
        simulation={"duration": "20 s", "samples": 201, "loss_distance": "3 um"},
    )  # fmt: skip
    run = tweezer.simulate(scene, seed=1)
    assert run.attrs["status"] == "lost"
    assert "bead" in run.attrs["message"]
    assert 10 < run.sizes["time"] < 150
    assert np.isfinite(run.position).all()


def test_interrupted_run_keeps_its_samples():
    def stop(_):
        raise KeyboardInterrupt

    scene = two_traps(simulation={"duration": "10 ms", "samples": 1001})
    run = tweezer.simulate(scene, seed=1, progress=stop)
    assert run.attrs["status"] == "interrupted"
    assert 1 < run.sizes["time"] < 1001


def test_step_follows_the_forces():
    scene = two_traps()
    found = coupled(scene, 0)
    assert found.step * rates(found.system, found.begin)[-1] <= 0.05 * (1 + 1e-9)


def test_step_resolves_the_stiffness_that_beads_meet_later():
    """A soft layer far from the start: the mean gap is Boltzmann's within 10 %."""
    spring = {"model": "spring", "between": ["1", "2"], "stiffness": 2e-5}
    scene = beads(
        (0, 0, 0), (2 * A + 100e-9, 0, 0), tether=[spring],
        forces={"brownian": True, "between": {"kind": "hertz", "modulus": "0.1 MPa",
                                              "range": "20 nm"}},
        simulation={"duration": "0.2 s", "samples": 4001},
    )  # fmt: skip
    run = tweezer.simulate(scene, seed=1)
    kT = 1.380649e-23 * scene.medium.temperature
    g = np.linspace(1e-12, 200e-9, 40_001)
    layer = 8 / 15 * 1e5 * math.sqrt(A / 2) * np.maximum(20e-9 - g, 0) ** 2.5
    weight = (2 * A + g) ** 2 * np.exp(-(0.5e-5 * 2 * g**2 + layer) / kT)
    expected = (g * weight).sum() / weight.sum()
    gaps = run.gap.values[200:, 0]
    parts = gaps[: 19 * 200].reshape(19, 200).mean(axis=1)
    error = parts.std() / math.sqrt(19)
    assert abs(gaps.mean() - expected) < 5 * error + 0.01 * expected
    assert 5 * error < 0.1 * expected
    assert -1e-3 < run.attrs["variance_bias"] < 0


def test_equilibrium_in_which_beads_overlap_is_refused():
    scene = two_traps(beam=[ONE["beam"] | {"position": [x, 0, 0]} for x in (-0.3e-6, 0.3e-6)])
    scene = scene.replace(**{"bead[1]": {"start": [-0.6e-6, 0, 0]},
                             "bead[2]": {"start": [0.6e-6, 0, 0]}})  # fmt: skip
    with pytest.raises(SceneError, match="no stable equilibrium of the beads near their starts"):
        tweezer.simulate(scene)


@pytest.mark.parametrize("brownian", [True, False])
def test_chain_that_is_too_short_is_refused(brownian):
    tether = {"model": "marko-siggia", "between": ["1", "2"], "contour_length": "1 um",
              "persistence_length": "50 nm"}  # fmt: skip
    scene = beads((0, 0, 0), (3e-6, 0, 0), tether=[tether], forces={"brownian": brownian})
    with pytest.raises(SceneError, match=r"tether\[1\].contour_length = 1e-06: a chain is longer"):
        tweezer.simulate(scene)


def test_force_calls_are_limited():
    scene = two_traps(simulation={"most_force_calls": 100})
    with pytest.raises(SceneError, match=r"simulation\.most_force_calls = 100: the run takes"):
        tweezer.simulate(scene)


def test_error_of_free_beads_is_not_known():
    spring = {"model": "spring", "between": ["1", "2"], "stiffness": 1e-6, "length": 5e-7}
    run = tweezer.simulate(beads((0, 0, 0), (1.5e-6, 0, 0), tether=[spring],
                                 forces={"brownian": True}))  # fmt: skip
    assert run.attrs["model_error"] < 1e-7
