"""How far equilibria are sought: the light has lengths of its own beside the size of the bead."""

import math
import re

import numpy as np
import pytest

import tweezer
from tweezer.scene.bead import bead_properties

#: A ball of glass in air over a weakly focused beam (A. Ashkin, J. M. Dziedzic, Appl. Phys. Lett.
#: 19, 283 (1971))
BALL = tweezer.load_scene("silica-1um").replace(
    bead={"diameter": "20 um", "refractive_index": 1.5, "density": 2500.0},
    medium={"refractive_index": 1.00028, "viscosity": 1.82e-5, "density": 1.2},
    lens={"numerical_aperture": 0.02, "radius": "1 mm"},
    beam={"wavelength": "514.5 nm", "power_through_pupil": "250 mW", "waist": "0.5 mm",
          "polarisation": "linear"},
    optics={"theory": "rays"},
    simulation={"loss_distance": "20 mm"},
)  # fmt: skip
DOWN = BALL.replace(beam={"direction": "down"}, forces={"gravitational_acceleration": -9.80665})
#: A drop that rises in water, under light that shines down
DROP = BALL.replace(
    bead={"density": 800.0}, beam={"direction": "down"},
    medium={"refractive_index": 1.33, "viscosity": 1e-3, "density": 1000.0},
)  # fmt: skip
#: Glass of index 2, which the light pushes hard, beyond the depth of focus
DENSE = tweezer.load_scene("silica-1um").replace(
    lens={"numerical_aperture": 0.6}, optics={"theory": "rays"},
    bead={"diameter": "10 um", "refractive_index": 2.0, "density": 4000.0},
    beam={"power_through_pupil": "0.1 W"}, simulation={"loss_distance": "1 mm"},
)  # fmt: skip
#: A bead that light of little aperture carries beyond what is searched for traps
FAR = tweezer.load_scene("silica-1um").replace(
    lens={"numerical_aperture": 0.1}, bead={"diameter": "3 um"}, optics={"theory": "rays"},
    beam={"power_through_pupil": "20 mW"}, simulation={"loss_distance": "0.2 mm"},
)  # fmt: skip

pytestmark = pytest.mark.filterwarnings("ignore::tweezer.PhysicsWarning")


def pulled_back(scene, farthest):
    """Heights at which the force on the axis falls through zero, by plain samples of it."""
    z = np.linspace(-farthest, farthest, 2501)
    force = tweezer.optical_force(scene, np.outer(z, [0, 0, 1]))[:, 2]
    force += bead_properties(scene).weight[2]
    falls = np.flatnonzero((force[:-1] > 0) & (force[1:] <= 0))
    zeros = z[falls] + (z[1] - z[0]) * force[falls] / (force[falls] - force[falls + 1])
    aside = np.outer(zeros, [0, 0, 1])
    kept = np.ones(len(zeros), bool)
    for i in (0, 1):
        step = np.zeros(3)
        step[i] = 0.05 * scene.bead.radius
        kept &= tweezer.optical_force(scene, aside + step)[:, i] < 0
        kept &= tweezer.optical_force(scene, aside - step)[:, i] > 0
    return zeros[kept]


@pytest.mark.parametrize(
    ("scene", "farthest"),
    [
        (BALL, 5e-3), (BALL.of_power(0.18), 5e-3), (DOWN, 5e-3), (DROP, 15e-3), (DENSE, 1e-4),
        (FAR, 2e-4),
    ],
    ids=["ball", "two places", "down", "drop", "dense", "far"],
)  # fmt: skip
def test_every_stable_equilibrium_is_found(scene, farthest):
    trap = tweezer.characterise(scene)
    stable = sorted(each.position[2] for each in trap.equilibria if each.stable)
    assert stable == pytest.approx(pulled_back(scene, farthest), abs=4e-3 * farthest)
    assert trap.equilibrium is not None
    assert trap.reach > 20 * scene.bead.radius or scene is DENSE


def test_ball_floats_where_it_is_known_to():
    trap = tweezer.characterise(BALL)
    assert trap.equilibrium.position[2] == pytest.approx(2.0186e-3, abs=1e-6)
    assert trap.stiffness_xyz == pytest.approx([4.83e-6, 3.60e-6, 7.18e-8], rel=5e-3)
    high = max(
        (each for each in tweezer.characterise(BALL.of_power(0.18)).equilibria if each.stable),
        key=lambda each: each.position[2],
    )
    assert high.position[2] == pytest.approx(1.55e-3, abs=5e-6)
    mirrored = tweezer.characterise(DOWN).equilibrium.position[2]
    assert mirrored == pytest.approx(-2.0196e-3, abs=5e-6)  # seen from below it is linear along y
    # across, the ball swings in thin air; along the axis it creeps
    assert np.isnan(trap.corner_frequencies).tolist() == [True, True, False]


def test_run_and_trap_agree_on_the_ball():
    start = {"position": [0, 0, 2.02e-3]}
    run = tweezer.simulate(BALL.replace(start=start), "0.5 s")
    assert tweezer.summarise(run).outcome == "captured"
    end = run["position"].values[-1, 2]
    assert end == pytest.approx(tweezer.characterise(BALL).equilibrium.position[2], abs=1e-7)


def test_empty_answers_name_the_searched_range():
    none = tweezer.characterise(BALL.of_power(1e-3))
    assert none.equilibrium is None
    assert none.reason.startswith(
        "no stable equilibrium on the axis within 5008 um of the focus (where light just carries "
        "the weight, 2e+04 um), nor off it up to"
    )
    with pytest.raises(tweezer.TweezerError, match="within 5008 um of the focus"):
        _ = none.stiffness_xyz
    two = tweezer.characterise(DROP.of_power(3.0))
    assert "of the focus (where light just carries the weight, 2e+04 um), for each beam" in (
        two.reason
    )


def test_range_ends_where_the_force_is_faint():
    trap = tweezer.characterise(tweezer.load_scene("silica-1um"))
    for escape in trap.escapes:
        unit = np.array({"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}[escape.direction[1]])
        unit = unit if escape.direction[0] == "+" else -unit
        ways = np.linspace(0, trap.reach, 4001)
        places = trap.equilibrium.position + np.outer(ways, unit)
        pull = -(tweezer.optical_force(trap.scene, places) @ unit)
        pull -= np.dot(bead_properties(trap.scene).weight, unit)
        past = np.flatnonzero((ways > escape.force_at) & (pull < 0.05 * pull.max()))
        assert escape.faint_at == pytest.approx(ways[past[0]], abs=2 * ways[1])
        assert escape.force_at < escape.faint_at < (escape.range or math.inf)


@pytest.mark.parametrize("name", ["silica-1um", "gold-100nm"])
@pytest.mark.parametrize("aperture", [0.02, 0.05, 0.1, 0.12, 0.14, 0.2, 0.3])
def test_search_ends_where_waves_are_computed(name, aperture):
    """2000/k from the focus, which six depths of focus exceed below NA 0.15."""
    scene = tweezer.load_scene(name).replace(lens={"numerical_aperture": aperture})
    ends = 2000 * scene.beam.wavelength / (2 * math.pi * scene.medium.refractive_index)
    trap = tweezer.characterise(scene)
    assert trap.equilibrium is None
    across, along = map(float, re.search(
        r"ring up to ([\d.]+) um from the axis and ([\d.]+) um from the focus", trap.searched
    ).groups())  # fmt: skip
    assert 40 < along < math.hypot(across, along) < 1.003e6 * ends
    assert aperture > 0.12 or math.hypot(across, along) > 0.99e6 * ends
    box = tweezer.dynamics.bound_once(scene).light.box
    rho, z = box.nodes()
    assert np.hypot(rho, z).max() <= ends


def test_line_from_an_equilibrium_ends_where_waves_are_computed():
    search = tweezer.dynamics.bound_once(tweezer.load_scene("silica-1um")).search
    for origin in ([0, 0, 0.98 * search.known], [0.6 * search.known, 0, -0.6 * search.known]):
        for to, unit in (("+x", [1, 0, 0]), ("-z", [0, 0, -1]), ("+z", [0, 0, 1])):
            end = search._replace(reach=search.known).to_the_end(np.array(origin), to)
            place = np.linalg.norm(np.array(origin) + end * np.array(unit))
            assert place == pytest.approx(search.known) or end == search.known
