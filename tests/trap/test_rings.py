"""Light that holds a bead on a ring around its axis."""

import math

import numpy as np
import pytest

import tweezer
from tweezer.sweeps.quantities import values_of

AZIMUTHAL, VORTEX = {"polarisation": "azimuthal"}, {"vortex": 1}


def hollow(beam, diameter=0.3e-6, **sections):
    return tweezer.load_scene("silica-1um").replace(
        bead={"diameter": diameter}, beam=beam,
        medium={"mean_free_path": "0.1 nm"} | sections.pop("medium", {}), **sections,
    )  # fmt: skip


@pytest.mark.parametrize("diameter", [0.2e-6, 0.3e-6, 0.4e-6, 0.5e-6])
@pytest.mark.parametrize("beam", [AZIMUTHAL, VORTEX])
def test_released_bead_comes_to_rest_on_the_ring(beam, diameter):
    scene = hollow(beam, diameter)
    ring = tweezer.characterise(scene).ring
    drag = 3 * math.pi * scene.medium.viscosity * diameter
    released = [0.0, ring.radius + 3e-8, ring.height + 6e-8]
    duration = 12 * drag / ring.stiffness_across.min()
    run = tweezer.simulate(scene.replace(
        start={"position": released}, simulation={"duration": duration, "samples": 101}
    ))  # fmt: skip
    position = run["position"].values
    x, y, z = position[-1]
    assert math.hypot(x, y) == pytest.approx(ring.radius, abs=1e-10)
    assert z == pytest.approx(ring.height, abs=1e-10)
    summary = tweezer.summarise(run)
    assert summary.outcome == "captured on a ring"
    assert 0 < summary.outcome_time < duration / 2
    # it is driven round at the speed that the ring says
    turned = np.diff(np.unwrap(np.arctan2(position[-11:, 1], position[-11:, 0]))).sum()
    rate = turned / (2 * math.pi * 0.1 * duration)
    # the speed of the ring neglects the memory of the fluid
    vorticity_time = scene.medium.density * (diameter / 2) ** 2 / scene.medium.viscosity
    slower = 1 + math.sqrt(math.pi * abs(ring.rate) * vorticity_time)
    assert rate == pytest.approx(ring.rate / slower, rel=1e-3, abs=1e-9)
    assert (ring.rate > 1) == (beam is VORTEX)


def test_ring_is_reported():
    trap = tweezer.characterise(hollow(VORTEX))
    assert trap.equilibrium is None
    assert (trap.ring.radius, trap.ring.height) == pytest.approx((0.347e-6, 0.106e-6), abs=1e-9)
    step = 1e-10
    for i, axis in enumerate((0, 2)):
        off = np.zeros(3)
        off[axis] = step
        there = trap.ring.position
        force = np.subtract(
            *tweezer.optical_force(trap.scene, np.array([there + off, there - off]))
        )
        assert trap.ring.stiffness[:, i] == pytest.approx(-force[[0, 2]] / (2 * step), rel=1e-5)
    assert math.isinf(trap.lifetime.time)
    text = repr(trap)
    assert "held on a ring           of radius 0.347 µm about the axis, at z = 0.106 µm" in text
    assert "turns/s" in text
    values = values_of(trap, trap.scene.medium.temperature)
    assert values["outcome"] == "held on a ring"
    assert values["ring_radius"] == trap.ring.radius
    with pytest.raises(tweezer.TweezerError, match=r"held on a ring of 0\.347 um"):
        _ = trap.stiffness


WEIGHTLESS = {"gravity": False, "buoyancy": False}


def test_ring_of_faint_light_holds_no_bead():
    """Depths go by the power: the same ring at 0.4 mW and, a twentieth as deep, at 20 uW."""
    bright, faint = (
        tweezer.characterise(
            hollow(VORTEX, 0.5e-6).replace(beam={"power_through_pupil": power}, forces=WEIGHTLESS)
        )
        for power in (4e-4, 2e-5)
    )
    depths = [min(each.energy_kT for each in trap.ring.escapes) for trap in (bright, faint)]
    assert depths[0] == pytest.approx(20 * depths[1], rel=1e-3)
    assert depths[0] > 1 > depths[1]
    assert bright.too_shallow == ""
    assert values_of(bright, bright.scene.medium.temperature)["outcome"] == "shallow"
    told = f"takes {depths[1]:.2g} kT, less than 1 kT"
    assert told in faint.too_shallow
    assert told in repr(faint)
    assert "held on a ring" not in repr(faint)
    values = values_of(faint, faint.scene.medium.temperature)
    assert (values["outcome"], values["reason"]) == ("not held", faint.reason)


def test_place_in_faint_light_holds_no_bead():
    scene = tweezer.load_scene("silica-1um").replace(forces=WEIGHTLESS)
    swept = tweezer.sweep(scene, {"beam.power_through_pupil": [2e-6, 5e-2]}, workers=1)
    assert swept["outcome"].values.tolist() == ["not held", "held"]
    assert swept["trapped"].values.tolist() == [False, True]
    assert "less than 1 kT" in str(swept["reason"].values[0])


def test_thermal_run_in_faint_light_is_not_captured():
    """Both runs end within a radius of the focus; only one trap is deeper than kT."""
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True} | WEIGHTLESS, start={"position": [0, 0, 0]},
        optics={"evaluator": "map", "table_tolerance": 1e-4},
        simulation={"duration": "1 ms", "samples": 21},
    )  # fmt: skip
    for power, outcome in ((2e-6, "not captured"), (5e-2, "captured")):
        run = tweezer.simulate(scene.replace(beam={"power_through_pupil": power}), seed=1)
        assert np.linalg.norm(run["position"][-1]) < 5e-7
        assert tweezer.summarise(run).outcome == outcome


def test_shallow_ring_has_a_lifetime():
    """Independent Brownian dynamics in the same light give the same mean time."""
    scene = hollow(VORTEX, 0.5e-6).replace(beam={"power_through_pupil": "0.4 mW"})
    scene = scene.replace(forces={"gravity": False, "buoyancy": False},
                          simulation={"loss_distance": "0.8 um"})  # fmt: skip
    trap = tweezer.characterise(scene)
    assert 1 < min(each.energy_kT for each in trap.ring.escapes) < 10
    assert values_of(trap, trap.scene.medium.temperature)["outcome"] == "shallow"
    rng, n = np.random.default_rng(2), 200
    kT = 1.380649e-23 * scene.medium.temperature
    mobility = 1 / (3 * math.pi * scene.medium.viscosity * 0.5e-6)
    step = 1e-4
    lost = np.zeros(n)
    places = np.tile(trap.ring.position, (n, 1))
    alive, time = np.arange(n), 0.0
    field = tweezer.dynamics.bound_once(scene).light
    while alive.size:
        force = field.field(places[alive]).force
        kick = rng.normal(size=(alive.size, 3)) * math.sqrt(2 * kT * mobility * step)
        before = np.linalg.norm(places[alive], axis=1)
        places[alive] += mobility * force * step + kick
        after = np.linalg.norm(places[alive], axis=1)
        time += step
        # a Brownian bridge between the two crosses the sphere with this probability
        gaps = np.maximum(0.8e-6 - before, 0) * np.maximum(0.8e-6 - after, 0)
        crossed = rng.random(alive.size) < np.exp(-gaps / (kT * mobility * step))
        lost[alive[crossed]] = time
        alive = alive[~crossed]
    error = lost.std() / math.sqrt(n)
    assert trap.lifetime.time == pytest.approx(lost.mean(), abs=4 * error)  # false alarm 6e-5


def test_ring_widens_in_thin_gas_until_it_is_gone():
    """The faster the light drives the bead round, the farther out the force has to carry it."""
    gas = {"viscosity": 2e-7, "density": 1e-3, "mean_free_path": 1e-15, "inertia": "none"}
    scene = hollow(VORTEX, medium=gas)
    ring = tweezer.characterise(scene).ring
    slow = tweezer.characterise(scene.replace(simulation={"model": "overdamped"})).ring
    assert slow.radius == pytest.approx(0.347e-6, abs=1e-10)
    assert ring.radius > 0.42e-6
    run = tweezer.simulate(scene.replace(
        start={"position": ring.position.tolist(), "velocity": [0, ring.speed, 0]},
        simulation={"duration": "0.3 ms", "samples": 101, "model": "full"},
    ))  # fmt: skip
    assert tweezer.summarise(run).outcome == "captured on a ring"
    end = np.hypot(*run["position"].values[-50:, :2].T)
    assert end == pytest.approx(ring.radius, abs=5e-10)
    thinner = tweezer.characterise(scene.replace(medium={"viscosity": 2e-8}))
    assert all(each.radius > 1e-6 for each in thinner.rings)


@pytest.mark.parametrize("viscosity", [1e-7, 1e-8])
def test_reason_names_a_ring_lost_by_too_little_drag(viscosity):
    scene = hollow(VORTEX, medium={"viscosity": viscosity})
    trap = tweezer.characterise(scene)
    assert trap.ring is None
    assert trap.reason.endswith(
        "; on a ring of 0.347 um the light pulls it back, but too little drag lets its inertia "
        "carry it off"
    )


def test_no_ring_is_searched_if_the_axis_has_an_equilibrium():
    trap = tweezer.characterise(hollow({}, 1e-6))
    assert trap.rings == ()
    assert "ring" not in trap.searched
    none = tweezer.characterise(tweezer.load_scene("silica-1um").replace(
        bead={"refractive_index": 1.2}
    ))  # fmt: skip
    assert none.ring is None
    assert none.reason == (
        "no stable equilibrium on the axis within 10.52 um of the focus (where light just carries "
        "the weight, 20 um), nor on a ring up to 4.39 um from the axis and 3.51 um from the focus"
    )


def test_linear_light_holds_a_bead_beside_its_axis():
    scene = hollow({"polarisation": "linear", "vortex": 1})
    trap = tweezer.characterise(scene)
    off = [each for each in trap.equilibria if each.position[:2].any()]
    assert "nor off it up to" in trap.searched
    for each in off:
        assert each.stable
        force = tweezer.optical_force(scene, each.position)
        assert np.linalg.norm(force) < 1e-3 * 1e-12
    assert (trap.equilibrium is None) == (not off)
