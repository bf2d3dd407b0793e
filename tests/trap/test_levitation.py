"""Levitation in gas: critical drag and pressure, recoil heating and temperatures."""

import json
import math

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov
from scipy.optimize import brentq

import tweezer
from tests.low_damping import gradient_at
from tweezer.results.saving import content_of
from tweezer.trap.levitation import pulling_back, steady_energies
from tweezer.values.constants import Boltzmann

ROOM = 300.0


def levitated(diameter=150e-9, *, pressure=1000.0, power=0.1, aperture=0.8, index=1.45, **beam):
    """Return a silica bead in air at 300 K, in light of 1064 nm."""
    given = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
    light = {
        "wavelength": 1.064e-6, "polarisation": "circular", "power_through_pupil": power,
        "profile": "gaussian", "sigma": 2.5e-3,
    }  # fmt: skip
    return tweezer.load_scene(given | {
        "bead": {"diameter": diameter, "refractive_index": index, "density": 2000.0},
        "medium": {"name": "air", "pressure": pressure, "temperature": ROOM},
        "lens": {"map": "sine", "radius": 2.5e-3, "numerical_aperture": aperture},
        "beam": light | beam,
    })  # fmt: skip


def mass_of(scene):
    return 4 / 3 * math.pi * scene.bead.radius**3 * 2000.0


def critical_drag(gradient, mass):
    """Return the drag at which an eigenvalue of the 6 x 6 matrix of the motion stops growing."""
    unit = math.sqrt(np.abs(gradient).max() / mass)
    scaled = gradient / mass / unit**2

    def growth(log_drag):
        drag = math.exp(log_drag)
        matrix = np.block([[np.zeros((3, 3)), np.eye(3)], [scaled, -drag * np.eye(3)]])
        return np.linalg.eigvals(matrix).real.max()

    if growth(math.log(1e-9)) < 0:
        return 0.0
    return math.exp(brentq(growth, math.log(1e-9), math.log(1e3), xtol=1e-12)) * mass * unit


SCENES = [
    *({"diameter": d} for d in (100e-9, 150e-9, 200e-9, 300e-9, 400e-9, 500e-9, 600e-9)),
    *({"diameter": d, "polarisation": "linear"} for d in (100e-9, 300e-9, 600e-9)),
    *({"diameter": 250e-9, "aperture": a} for a in (0.6, 0.7, 0.9)),
    *({"diameter": 350e-9, "index": n} for n in (1.2, 1.33, 1.5)),
    {"diameter": 1.2e-6, "index": 1.2, "aperture": 0.9, "vortex": 1},
    {"diameter": 1.2e-6, "index": 1.2, "aperture": 0.9, "vortex": -1},
    {"diameter": 200e-9, "vortex": 0, "offset": (0.5e-3, 0.0)},
    {"diameter": 200e-9, "polarisation": "linear", "offset": (0.5e-3, 0.5e-3)},
]


def test_critical_drag_of_twenty_scenes():
    positive = 0
    for each in SCENES:
        scene = levitated(pressure=1e5, **each)
        trap = tweezer.characterise(scene)
        place = pulling_back(trap)
        if place is None:
            assert trap.least_drag is None, each
            continue
        exact = critical_drag(gradient_at(scene, place.position), mass_of(scene))
        positive += exact > 0
        assert trap.least_drag == pytest.approx(exact, rel=2e-3, abs=1e-9 * trap.drag[0]), each
    assert positive >= 12


@pytest.mark.parametrize(
    ("diameter", "pressure"), [(100e-9, 6.7), (150e-9, 29.5), (300e-9, 138), (600e-9, 1.02e4)]
)
def test_pressures_of_silica_in_circular_light(diameter, pressure):
    """A prototype found 6.7, 29, 139 and 1.0e4 Pa."""
    dense, thin = (levitated(diameter, pressure=factor * pressure) for factor in (1.05, 0.95))
    held, lost = tweezer.characterise(dense), tweezer.characterise(thin)
    assert held.least_pressure == pytest.approx(pressure, rel=0.02)
    assert held.equilibrium is pulling_back(held)
    # light is also brighter than around it far from the focus, where it may hold the bead
    assert lost.equilibrium is not pulling_back(lost)
    assert "um" in next(row for row in lost.card().rows if row.name == "stable at").value
    assert lost.least_pressure == pytest.approx(held.least_pressure, rel=5e-3)
    assert tweezer.medium(levitated(diameter, pressure=held.least_pressure)).drag == pytest.approx(
        held.least_drag, rel=1e-9
    )


def test_linear_light_holds_at_any_pressure():
    trap = tweezer.characterise(levitated(600e-9, pressure=1e-6, polarisation="linear"))
    assert trap.least_drag == trap.least_pressure == 0
    assert trap.equilibrium is not None
    assert "any pressure" in str(trap.card())


def test_strong_light_holds_at_no_pressure():
    trap = tweezer.characterise(levitated(600e-9, power=100.0))
    assert trap.least_pressure == math.inf
    assert "no pressure up to 2000 mbar" in str(trap.card())


def test_pressure_requires_a_named_gas():
    scene = levitated(pressure=1e5)
    given = scene.replace(medium={"mean_free_path": "70 nm"})
    water = tweezer.characterise("silica-1um")
    for trap in (tweezer.characterise(given), water):
        assert trap.least_drag > 0
        assert trap.least_pressure is None
        assert trap.recoil_pressures is None
        assert "stable at" not in str(trap.card())
    assert "recoil" not in str(water.card())


def test_trap_run_and_sweep_agree():
    """Beside the least pressure a run's distance grows or decays, as the equilibria say."""
    least = tweezer.characterise(levitated(300e-9)).least_pressure
    pressures = [0.3 * least, 3 * least]
    swept = tweezer.sweep(levitated(300e-9), {"medium.pressure": pressures}, workers=1)
    in_focus = np.abs(swept["equilibrium"].sel(axis="z").values) < 1.5e-6
    assert in_focus.tolist() == [False, True]
    assert swept["least_pressure"].values == pytest.approx(2 * [least], rel=5e-3)
    assert (swept["least_pressure_error"] < 0.08 * least).all()
    assert (swept["recoil_heating"] > 0).all()
    assert (swept["temperatures"].values[1][:2] > ROOM).all()
    for pressure, grows in zip(pressures, (True, False), strict=True):
        scene = levitated(300e-9, pressure=pressure)
        place = pulling_back(tweezer.characterise(scene)).position
        start = place + np.array([2e-9, 0, 0])
        run = tweezer.simulate(scene.replace(
            start={"position": start.tolist()},
            simulation={"duration": 0.7e-3, "samples": 1001, "model": "full"},
        ))  # fmt: skip
        away = np.linalg.norm(run["position"].values[:, :2] - place[:2], axis=1)
        assert (away[-100:].max() > away[:100].max()) == grows, pressure


def test_recoil_heating_and_its_pressures():
    trap = tweezer.characterise(levitated(pressure=1e-4, polarisation="linear"))
    diffusion = tweezer.recoil(trap.scene, trap.equilibrium.position).diagonal()
    mass = mass_of(trap.scene)
    assert trap.recoil_heating == pytest.approx(diffusion / (2 * mass))
    assert trap.recoil_pressures == pytest.approx([7.4e-6, 1.3e-5, 3.4e-5], rel=0.03)
    # Epstein's drag of free molecules
    molar, gas = 0.02896546, 8.31446261815324
    speed = math.sqrt(8 * gas * ROOM / (math.pi * molar))
    radius = trap.scene.bead.radius
    per_pressure = 4 / 3 * math.pi * radius**2 * (1 + math.pi / 8) * speed * molar / (gas * ROOM)
    expected = diffusion / (2 * Boltzmann * ROOM) / per_pressure
    assert trap.recoil_pressures == pytest.approx(expected, rel=1e-4)
    warmer = trap.temperatures - ROOM
    assert warmer == pytest.approx(ROOM * expected / 1e-4, rel=1e-4)
    of = {each.of.name: each for each in trap.quantities()}
    assert (of["temperatures"].error < 0.13 * warmer).all()
    assert (of["temperatures"].error > 0.05 * warmer).all()
    text = str(trap.card())
    assert "recoil heating (x, y, z)" in text
    assert "temperatures (x, y, z)" in text


def test_circulation_heats_the_motion():
    trap = tweezer.characterise(levitated(300e-9, pressure=400.0))
    ratio = trap.least_drag / trap.drag[0]
    assert trap.temperatures[:2] == pytest.approx(2 * [ROOM / (1 - ratio**2)], rel=1e-4)
    assert trap.temperatures[2] == pytest.approx(ROOM, rel=1e-4)


def test_steady_energies_solve_the_lyapunov_equation():
    rng = np.random.default_rng(5)
    compared = 0
    for _ in range(40):
        rates = np.diag(rng.uniform(1, 3, 3)) + rng.uniform(-0.5, 0.5, (3, 3))
        root = rng.normal(size=(3, 3))
        heating, damping = root @ root.T, 10 ** rng.uniform(-1, 1.5)
        A = np.block([[np.zeros((3, 3)), np.eye(3)], [-rates, -damping * np.eye(3)]])
        if np.linalg.eigvals(A).real.max() >= 0:
            continue
        noise = np.zeros((6, 6))
        noise[3:, 3:] = 2 * heating
        expected = solve_continuous_lyapunov(A, -noise).diagonal()[3:]
        assert steady_energies(rates, damping, heating) == pytest.approx(expected, rel=1e-9)
        compared += 1
    assert compared > 20
    # without coupling the energies are exact at any damping
    found = steady_energies(np.diag([1.0, 1.0 + 1e-9, 2.0]), 1e-15, np.diag([1.0, 2.0, 3.0]))
    assert found == pytest.approx([1e15, 2e15, 3e15], rel=1e-12)


def test_saved_trap_keeps_levitation(tmp_path):
    trap = tweezer.characterise(levitated(pressure=1.0, polarisation="linear"))
    path = tmp_path / "trap.json"
    tweezer.save(trap, path)
    saved = json.loads(path.read_text())["trap"]
    assert saved["least_pressure"] == 0
    assert saved["temperatures"] == pytest.approx(trap.temperatures)
    again = tweezer.load(path)
    assert "photon_recoil" in vars(again)
    assert again == trap
    assert [each.of.name for each in again.quantities()] == [
        each.of.name for each in trap.quantities()
    ]
    assert again.temperatures == pytest.approx(trap.temperatures)
    compared = tweezer.compare(trap, again)
    assert compared.agrees
    in_water = content_of(tweezer.characterise("silica-1um"))
    assert "least_pressure" not in in_water["trap"]
