"""The characterised trap against the force itself, sampled densely; scaling laws; published Q."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Circle

import tweezer
from tests import readable
from tweezer.optics import light_force, sampled
from tweezer.optics.waves.binding import sums
from tweezer.plots import trap_figure
from tweezer.values.signs import typeset

AXES = {"x": 0, "y": 1, "z": 2}
PUBLISHED = Path(__file__).parents[1] / "data" / "ashkin1992.csv"


#: Tests of what rays alone do
RAYS = {"theory": "rays"}


def silica(**changes):
    """Describe the everyday trap, by quadrature: of waves, unless the changes say otherwise."""
    return tweezer.load_scene("silica-1um").replace(**changes)


def weightless(**changes):
    return silica(forces={"gravity": False, "buoyancy": False}, **changes)


def weight(scene):
    """Gravity and buoyancy along z, N."""
    volume = math.pi * (2 * scene.bead.radius) ** 3 / 6
    density = scene.bead.density * scene.forces.gravity
    density -= scene.medium.density * scene.forces.buoyancy
    return -density * volume * 9.80665


def pull(scene, trap, direction, distances):
    """Force towards the equilibrium at distances from it, N."""
    side, axis = (1 if direction[0] == "+" else -1), AXES[direction[1]]
    places = np.tile(trap.equilibrium.position, (len(distances), 1))
    places[:, axis] += side * distances
    force = tweezer.optical_force(scene, places)[:, axis]
    return -side * (force + (weight(scene) if axis == 2 else 0.0))


def closely_up_to(end, r):
    """Distances up to `end`, closer where the force bends."""
    near = min(2 * r, end)
    return np.unique(np.concatenate([np.linspace(0, near, 4_001), np.linspace(near, end, 1_001)]))


@pytest.fixture(
    scope="module",
    params=["silica", "levitated", "linear", "donut", "thesis", "grid"],
)
def trapped(request):
    """Scenes of all kinds with their traps."""
    thesis = tweezer.load_scene("thesis-990nm")
    scene = {
        "silica": silica(),
        # weight balances the light a second time, beyond the focus
        "levitated": silica(
            bead={"diameter": "3 um"}, beam={"power_through_pupil": "20 mW"}, optics=RAYS
        ),
        "linear": silica(beam={"polarisation": "linear", "jones": ["1", "0.3+0.4j"]}),
        "donut": silica(beam={"profile": "donut", "waist": "1.5 mm"}),
        "thesis": thesis.replace(optics={"evaluator": "quadrature"}),
        "grid": thesis,
    }[request.param]
    return scene, tweezer.characterise(scene)


def test_nothing_pulls_at_an_equilibrium_and_the_stable_one_is_nearest(trapped):
    scene, trap = trapped
    assert trap.equilibria
    for place in trap.equilibria:
        assert not place.position[:2].any()
        force = tweezer.optical_force(scene, place.position)
        force[2] += weight(scene)
        largest = max(escape.force for escape in trap.escapes)
        # where the sum over the grid jumps past zero, no force vanishes
        assert np.abs(force).max() < (1e-2 if trap.evaluator == "grid" else 1e-11) * largest
        assert place.residual == pytest.approx(np.linalg.norm(force), abs=1e-12 * largest)
    assert f" z = {1e6 * trap.equilibrium.position[2]:.4g} µm, " in repr(trap)
    assert len(repr(trap)) < 600
    stable = [abs(place.position[2]) for place in trap.equilibria if place.stable]
    assert abs(trap.equilibrium.position[2]) == min(stable)
    assert trap.equilibrium.stable
    assert len(stable) == (2 if scene.bead.radius == 1.5e-6 else 1)


def test_every_change_of_sign_on_the_axis_is_an_equilibrium(trapped):
    scene, trap = trapped
    if trap.evaluator == "grid":
        pytest.skip("its jumps change the sign back and forth between any two samples")
    z = np.linspace(-1, 1, 9_011) * trap.reach
    places = np.zeros((z.size, 3))
    places[:, 2] = z
    sign = np.sign(tweezer.optical_force(scene, places)[:, 2] + weight(scene))
    changes = np.flatnonzero(np.diff(sign))
    found = [place.position[2] for place in trap.equilibria]
    assert len(found) == len(changes)
    for i, place in zip(changes, found, strict=True):
        assert z[i] <= place <= z[i + 1]


def test_stiffness_is_the_slope_of_the_force(trapped):
    scene, trap = trapped
    if trap.evaluator != "grid":
        scene = scene.replace(optics={"tolerance": 1e-13})
    step = 2e-4 * scene.bead.radius
    for place in trap.equilibria if trap.evaluator != "grid" else [trap.equilibrium]:
        shifts = step * np.eye(3)
        ahead = tweezer.optical_force(scene, place.position + shifts)
        behind = tweezer.optical_force(scene, place.position - shifts)
        slope = ((behind - ahead) / (2 * step)).T
        scale = np.abs(slope).max()
        np.testing.assert_allclose(place.stiffness, slope, rtol=0, atol=1e-5 * scale)
        np.testing.assert_allclose(
            place.eigenvalues, np.sort(np.linalg.eigvals(slope).real), rtol=0, atol=2e-5 * scale
        )
        assert place.stable == (min(place.eigenvalues) > 0)
    drag = 6 * math.pi * scene.medium.viscosity * scene.bead.radius
    expected = np.diag(trap.equilibrium.stiffness) / (2 * math.pi * drag)
    np.testing.assert_allclose(trap.corner_frequencies, expected, rtol=1e-14)


def test_escape_is_the_largest_pull_before_it_ends(trapped):
    scene, trap = trapped
    r = scene.bead.radius
    assert [escape.direction for escape in trap.escapes] == ["+x", "-x", "+y", "-y", "+z", "-z"]
    for escape in trap.escapes:
        end = trap.reach if escape.range is None else escape.range
        distances = closely_up_to(end, r)[1:-1]
        forces = pull(scene, trap, escape.direction, distances)
        # on the grid a single sample may find a jump that the lines' samples missed
        grid = trap.evaluator == "grid"
        assert forces.max() <= escape.force * (1 + (1e-3 if grid else 1e-9))
        assert forces.max() == pytest.approx(escape.force, rel=1e-3)
        at = pull(scene, trap, escape.direction, np.array([escape.force_at]))
        assert at == pytest.approx(escape.force, rel=1e-12)
        if not grid:
            # near the equilibrium and near the end of the pull it is next to nothing
            assert forces.min() > -1e-9 * escape.force
            assert abs(distances[forces.argmax()] - escape.force_at) < 2e-3 * r


def test_range_is_where_the_pull_ends(trapped):
    scene, trap = trapped
    r = scene.bead.radius
    ranges = {escape.direction: escape.range for escape in trap.escapes}
    for direction, end in ranges.items():
        if end is None:
            assert pull(scene, trap, direction, np.array([0.9995 * trap.reach])) > 0
            continue
        before, behind = pull(scene, trap, direction, end + np.array([-1e-6, 1e-6]) * r)
        assert before > 0 >= behind
    if trap.evaluator == "grid":  # the samples of another line meet other jumps
        return
    unstable = {place.position[2] for place in trap.equilibria if not place.stable}
    for direction, side in (("+z", 1), ("-z", -1)):
        height = trap.equilibrium.position[2]
        beyond = [side * (z - height) for z in unstable if side * (z - height) > 0]
        if beyond:
            assert ranges[direction] == pytest.approx(min(beyond), abs=1e-9 * r)


def test_energy_is_the_work_on_the_way(trapped):
    scene, trap = trapped
    r = scene.bead.radius
    for escape in trap.escapes:
        end = trap.reach if escape.range is None else escape.range
        edges = closely_up_to(end, r)
        middles, widths = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
        at_edges, between = (
            pull(scene, trap, escape.direction, distances) for distances in (edges, middles)
        )
        work = (at_edges[:-1] + 4 * between + at_edges[1:]) @ widths / 6  # Simpson's rule
        error = 2e-6 * work if trap.evaluator != "grid" else 1e-3 * work
        assert escape.energy == pytest.approx(work, abs=error)
        assert 0 <= escape.energy_error < 10 * error
        assert escape.energy_kT == pytest.approx(
            escape.energy / (1.380649e-23 * scene.medium.temperature), rel=1e-12
        )


def test_error_and_evaluator_are_told(trapped):
    scene, trap = trapped
    if scene.optics.evaluator == "grid":
        largest = max(escape.force for escape in trap.escapes)
        assert trap.evaluator == "grid"
        assert 0.003 * largest < trap.force_error < 0.1 * largest
        return
    assert trap.evaluator == "quadrature"
    assert 0 < trap.force_error < 1e-7 * max(escape.force for escape in trap.escapes)
    rough = tweezer.characterise(scene.replace(optics={"tolerance": 1e-3}))
    assert rough.force_error > 10 * trap.force_error
    for rough_escape, escape in zip(rough.escapes, trap.escapes, strict=True):
        assert rough_escape.force == pytest.approx(escape.force, rel=2e-3)


def assert_scaled(trap, other, *, force=1.0, length=1.0):
    """Force and length of `other` are so many times those of `trap`."""
    stiff, soft = other.equilibrium, trap.equilibrium
    r = 0.5e-6
    np.testing.assert_allclose(
        stiff.position, np.multiply(soft.position, length), rtol=0, atol=1e-9 * length * r
    )
    np.testing.assert_allclose(
        stiff.stiffness, np.multiply(soft.stiffness, force / length), rtol=0,
        atol=1e-6 * max(soft.eigenvalues) * force / length,
    )  # fmt: skip
    for scaled, escape in zip(other.escapes, trap.escapes, strict=True):
        assert scaled.force == pytest.approx(force * escape.force, rel=1e-7)
        assert scaled.force_at == pytest.approx(length * escape.force_at, rel=1e-4)
        assert scaled.energy == pytest.approx(force * length * escape.energy, rel=1e-6)
        assert (scaled.range is None) == (escape.range is None)
        if escape.range is not None:
            assert scaled.range == pytest.approx(length * escape.range, rel=1e-5)
    for scaled, pulls in ((other.backward_efficiency, trap.backward_efficiency),
                          (other.lateral_efficiency, trap.lateral_efficiency)):  # fmt: skip
        assert abs(scaled.Q / pulls.Q - 1) < 1e-7
        assert scaled.at == pytest.approx(length * pulls.at, rel=1e-4)


def test_twice_the_power_is_twice_the_trap():
    trap = tweezer.characterise(weightless())
    double = weightless(beam={"power_through_pupil": "100 mW"})
    assert_scaled(trap, tweezer.characterise(double), force=2.0)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"beam": {"polarisation": "linear", "jones": ["1", "0"]}},
        {"optics": RAYS},
        {"optics": {"theory": "rays", "evaluator": "grid"}},
    ],
    ids=["waves", "linear", "rays", "grid"],
)
def test_forces_kept_of_another_power_are_those_of_this_one(changes):
    weak = silica(**changes)
    strong = weak.replace(beam={"power_through_pupil": None, "power": "0.3 W"})
    places = np.random.default_rng(1).normal(size=(120, 3)) * 0.7e-6
    sampled(weak, places)
    force, error = sampled(strong, places)
    fresh = light_force.__wrapped__(strong)
    field = fresh.field(places)
    size = np.abs(field.force).max()
    np.testing.assert_allclose(force, field.force, rtol=0, atol=1e-14 * size)
    np.testing.assert_allclose(error, fresh.error_of(places, field), rtol=1e-6, atol=1e-14 * size)


def test_light_of_waves_is_bound_once_for_all_powers():
    """Bound for one power and for another, the sums are the same to the bit but for the power."""
    scene = silica(beam={"power_through_pupil": "7 mW"})
    here = light_force(scene)
    anew = sums(here.light, here.tolerance, here.reach)
    assert here.sums.data.numbers.tobytes() == anew.data.numbers.tobytes()
    again = light_force(silica(beam={"power_through_pupil": "70 mW"}))
    assert again.alike is here.alike


def test_a_larger_bead_has_a_wider_trap_of_the_same_force_of_rays():
    trap = tweezer.characterise(weightless(optics=RAYS))
    larger = weightless(bead={"diameter": "12 um"}, optics=RAYS)
    assert_scaled(trap, tweezer.characterise(larger), length=12.0)


def test_weight_shifts_the_equilibrium_by_its_share_of_the_stiffness():
    scene = silica(bead={"diameter": "2 um"})
    floating = scene.replace(forces={"gravity": False, "buoyancy": False})
    sunk, trap = tweezer.characterise(scene), tweezer.characterise(floating)
    shift = sunk.equilibrium.position[2] - trap.equilibrium.position[2]
    assert shift < 0
    assert shift == pytest.approx(weight(scene) / trap.equilibrium.stiffness[2][2], rel=5e-3)
    # the efficiencies are those of the light alone
    assert sunk.backward_efficiency == trap.backward_efficiency
    assert sunk.lateral_efficiency == trap.lateral_efficiency


def test_left_and_right_are_alike(trapped):
    scene, trap = trapped
    there = {escape.direction: escape for escape in trap.escapes}
    pairs = [("+x", "-x"), ("+y", "-y")]
    if scene.beam.polarisation != "linear":
        pairs.append(("+x", "+y"))
    for one, other in pairs:
        assert there[one].force == pytest.approx(there[other].force, rel=1e-9)
        ends = [trap.reach if there[side].range is None else there[side].range
                for side in (one, other)]  # fmt: skip
        assert ends[0] == pytest.approx(ends[1], rel=1e-9)
        assert there[one].energy == pytest.approx(there[other].energy, rel=1e-6)


def test_linear_light_pulls_differently_along_and_across_it():
    along_x, along_y, oblique = (
        tweezer.characterise(weightless(beam={"polarisation": "linear", "jones": jones}))
        for jones in (["1", "0"], ["0", "1j"], ["1", "1"])
    )
    kx, ky, kz = np.diag(along_x.equilibrium.stiffness)
    assert abs(kx / ky - 1) > 1e-3
    np.testing.assert_allclose(np.diag(along_y.equilibrium.stiffness), [ky, kx, kz], rtol=1e-7)
    assert abs(along_x.escapes[0].force / along_x.escapes[2].force - 1) > 1e-2
    assert along_y.escapes[0].force == pytest.approx(along_x.escapes[2].force, rel=1e-8)
    assert abs(along_x.lateral_efficiency.Q / along_y.lateral_efficiency.Q - 1) < 1e-8
    # at 45 degrees the same tensor, turned
    mean, half = (kx + ky) / 2, (kx - ky) / 2
    expected = [[mean, half, 0], [half, mean, 0], [0, 0, kz]]
    np.testing.assert_allclose(oblique.equilibrium.stiffness, expected, rtol=0, atol=1e-8 * kx)


def polystyrene(diameter, *, wide, jones=None):
    """Weightless, in the light of the published rows: NA 1.2, 1 mW, waist 1 or 10 pupil radii."""
    light = {"polarisation": "linear", "jones": jones} if jones else {"polarisation": "circular"}
    return weightless(
        medium={"refractive_index": 1.33},
        bead={"diameter": diameter, "refractive_index": 1.59},
        lens={"numerical_aperture": 1.2},
        beam={"power_through_pupil": "1 mW", "waist": "25 mm" if wide else "2.5 mm", **light},
    )


@pytest.mark.parametrize(
    ("diameter", "kx", "kz", "z"),
    [
        ("0.5 um", 2.324, 0.426, 0.301),
        ("0.99 um", 3.795, 0.920, 0.192),
        ("5 um", 0.455, 0.146, 0.038),
    ],
)
def test_waves_trap_polystyrene_as_another_program_has_it(diameter, kx, kz, z):
    """fatcuda 0.6.5, extrapolated in its grid: pN/um per mW, um."""
    trap = tweezer.characterise(polystyrene(diameter, wide=False))
    (xx, xy, _), (yx, yy, _), (_, _, zz) = trap.equilibrium.stiffness
    np.testing.assert_allclose(1e6 * np.array([xx, yy, zz]), [kx, kx, kz], rtol=4e-4, atol=6e-4)
    assert 1e6 * trap.equilibrium.position[2] == pytest.approx(z, abs=6e-4)
    assert xy == pytest.approx(-yx, abs=1e-9 * xx)
    assert trap.equilibrium.turn == pytest.approx(xy)
    assert (trap.caveat, trap.ray_optics, trap.theory) == (None, None, "waves")


@pytest.mark.parametrize(
    ("diameter", "kx", "ky"), [("0.5 um", 2.406, 3.460), ("1 um", 3.558, 2.355)]
)
def test_linear_light_of_waves_is_stiffer_along_one_axis(diameter, kx, ky):
    """fatcuda 0.6.5: along the field weaker at half a micrometre, and stronger at one."""
    trap = tweezer.characterise(polystyrene(diameter, wide=True, jones=["1", "0"]))
    k = 1e6 * np.diag(trap.equilibrium.stiffness)
    np.testing.assert_allclose(k[:2], [kx, ky], rtol=4e-4)
    assert abs(trap.equilibrium.turn) < 1e-9 * trap.equilibrium.stiffness[0][0]


@pytest.mark.parametrize("diameter", ["0.5 um", "1 um"])
def test_circular_light_pushes_a_bead_round_the_axis_against_its_sense(diameter):
    """By 7 to 10 % of the stiffness; the force beside the axis says so too. Turned light, turned
    push (Diniz et al., arXiv 1901.09370).
    """
    scene = polystyrene(diameter, wide=False)
    place = tweezer.characterise(scene).equilibrium
    share = place.turn / place.stiffness[0][0]
    assert -0.10 < share < -0.06
    beside = np.add(place.position, [1e-9, 0, 0])
    assert tweezer.optical_force(scene, beside)[1] == pytest.approx(place.turn * 1e-9, rel=1e-4)


def test_the_500_nm_bead_of_the_thesis_rests_by_waves_beyond_the_focus():
    scene = tweezer.load_scene("thesis-500nm").replace(
        optics={"theory": "waves", "evaluator": "quadrature"},
        beam={"polarisation": "circular"},
    )
    place = tweezer.characterise(scene).equilibrium
    assert 1e6 * place.position[2] == pytest.approx(0.3855, abs=2e-4)
    assert 1e6 * place.turn == pytest.approx(-22.9, abs=0.1)


def test_all_equilibria_of_a_large_bead_of_waves_are_found():
    """Its surfaces interfere: the axial force ripples at half a wavelength, and changes its sign
    where rays push against the weight.
    """
    scene = silica(bead={"diameter": "10 um"})
    trap = tweezer.characterise(scene)
    z = np.linspace(-1, 1, 6_011) * trap.reach
    force = tweezer.optical_force(scene, np.stack([0 * z, 0 * z, z], axis=1))[:, 2] + weight(scene)
    changes = np.flatnonzero(np.diff(np.sign(force)))
    found = [place.position[2] for place in trap.equilibria]
    assert len(found) == len(changes) == 4
    for i, place in zip(changes, found, strict=True):
        assert z[i] <= place <= z[i + 1]
    assert [place.stable for place in trap.equilibria] == [False, True, False, True]


def test_an_absorbing_bead_takes_power_and_spin_from_circular_light():
    """On the axis the moment is the absorbed power over the light's angular frequency."""
    trap = tweezer.characterise(tweezer.load_scene("gold-100nm"))
    omega = 2 * math.pi * 299792458.0 / tweezer.load_scene("gold-100nm").beam.wavelength
    assert 0 < trap.absorbed_power < 1e-3 * trap.power_through_pupil
    assert trap.torque == pytest.approx((0, 0, trap.absorbed_power / omega), rel=1e-9, abs=1e-30)
    clear = tweezer.characterise(silica())
    assert (clear.absorbed_power, clear.torque) == (None, None)


def test_the_sine_map_traps_about_half_as_strongly_along_the_axis():
    """The same uniform beam and half angle; Ashkin's bead of relative index 1.2."""
    angle = math.asin(1.25 / 1.326)
    tangent = {"map": "tan", "radius": "2.5 mm", "focal_length": 2.5e-3 / math.tan(angle)}
    sine, tan = (
        tweezer.characterise(
            weightless(
                bead={"refractive_index": 1.2 * 1.326},
                beam={"profile": "uniform", "sigma": None},
                lens=lens,
                optics=RAYS,
            )
        )
        for lens in ({}, tangent)
    )
    assert 0.45 < sine.backward_efficiency.Q / tan.backward_efficiency.Q < 0.6


def published():
    with PUBLISHED.open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [row for row in rows if row["kind"] == "axial"]


@pytest.mark.parametrize("row", published(), ids=lambda row: f"{row['n_rel']}-{row['beam']}")
def test_backward_efficiency_is_the_published(row):
    """Ashkin 1992: tan map, half angle 70 degrees, circular light, in bead radii."""
    radius = 2.5e-3
    beam = {"profile": "uniform", "sigma": None}
    if row["beam"] != "uniform":
        beam = {"waist": radius}
    scene = weightless(
        medium={"refractive_index": 1.33},
        bead={"refractive_index": 1.33 * float(row["n_rel"])},
        lens={"map": "tan", "radius": radius, "focal_length": radius / math.tan(math.radians(70))},
        beam=beam,
        optics=RAYS,
    )
    found = tweezer.characterise(scene).backward_efficiency
    assert abs(found.Q + float(row["Qg_or_Qz"])) < 1.5e-3
    assert abs(found.at / scene.bead.radius - float(row["theta_deg_or_z"])) < 0.01


@pytest.mark.parametrize("jones", [["1", "0"], ["0", "1"]])
def test_efficiencies_are_the_largest_of_the_light(jones):
    """Linear light of rays pulls harder from the sides it is polarised along."""
    scene = silica(beam={"polarisation": "linear", "jones": jones}, optics=RAYS)
    trap = tweezer.characterise(scene)
    unit = 1.326 * 50e-3 / 299792458.0
    side = int(jones[1])
    z, x = np.zeros((4_001, 3)), np.zeros((4_001, 3))
    z[:, 2], x[:, side] = np.linspace(-1e-6, 1e-6, 4_001), np.linspace(0, 1e-6, 4_001)
    for found, Q, where in (
        (trap.backward_efficiency, -tweezer.optical_force(scene, z)[:, 2] / unit, z[:, 2]),
        (trap.lateral_efficiency, -tweezer.optical_force(scene, x)[:, side] / unit, x[:, side]),
    ):
        assert Q.max() <= found.Q * (1 + 1e-9)
        assert Q.max() == pytest.approx(found.Q, rel=1e-3)
        assert where[Q.argmax()] == pytest.approx(found.at, abs=1e-9)
    assert trap.power_through_pupil == pytest.approx(50e-3, rel=1e-12)
    assert trap.fraction_through_pupil == pytest.approx(1 - math.exp(-2), rel=1e-12)


def assert_no_trap(trap):
    assert trap.equilibrium is None
    assert trap.corner_frequencies is None
    assert trap.escapes == ()
    assert not any(place.stable for place in trap.equilibria)


@pytest.mark.parametrize("make", [silica, weightless])
def test_a_bead_like_the_medium_is_not_trapped(make):
    trap = tweezer.characterise(make(bead={"refractive_index": 1.326}))
    assert_no_trap(trap)
    assert trap.equilibria == ()
    assert (trap.backward_efficiency, trap.lateral_efficiency) == (None, None)


@pytest.mark.parametrize(
    "changes",
    [{"forces": {"optical": False}}, {"beam": {"power_through_pupil": 0}}],
    ids=["off", "no power"],
)
def test_the_dark_traps_nothing(changes):
    trap = tweezer.characterise(silica(**changes))
    assert_no_trap(trap)
    assert trap.equilibria == ()
    assert (trap.backward_efficiency, trap.lateral_efficiency) == (None, None)
    assert (trap.power_through_pupil, trap.fraction_through_pupil) == (0.0, None)
    assert (trap.evaluator, trap.force_error, trap.caveat) == ("dark", 0.0, None)


@pytest.mark.parametrize("evaluator", ["quadrature", "grid"])
def test_a_bead_of_lower_index_is_repelled(evaluator):
    """By the grid too: its force has a stable slope between jumps that drive the bead out."""
    scene = silica(bead={"refractive_index": 1.2}, optics={"evaluator": evaluator})
    trap = tweezer.characterise(scene)
    assert_no_trap(trap)
    assert trap.equilibria
    assert trap.backward_efficiency.at < 0
    if evaluator == "quadrature":
        assert trap.lateral_efficiency is None


def test_a_weak_lens_pushes_the_bead_away():
    trap = tweezer.characterise(
        weightless(lens={"numerical_aperture": 0.4}, bead={"refractive_index": 2.0})
    )
    assert_no_trap(trap)
    assert trap.equilibria == ()
    assert trap.backward_efficiency is None
    assert trap.lateral_efficiency.Q > 0.01


def test_figure_shows_the_bead_where_it_is_trapped():
    scene = silica(optics=RAYS)
    trap = tweezer.characterise(scene)
    figure = trap.plot()
    axial, field, lateral, colours = figure.axes
    (bead,) = [patch for patch in field.patches if isinstance(patch, Circle)]
    assert bead.center == pytest.approx((0.0, trap.equilibrium.position[2] * 1e6))
    assert bead.radius == pytest.approx(0.5)
    assert colours.get_ylabel() == "force (pN)"
    for axes, k in ((axial, trap.equilibrium.stiffness[2][2]),
                    (lateral, trap.equilibrium.stiffness[0][0])):  # fmt: skip
        assert axes.get_legend().texts[0].get_text() == f"{k * 1e6:.3g} pN/µm"
    labels = {text.get_text() for text in axial.texts + lateral.texts}
    assert labels == {f"{escape.force * 1e12:.3g} pN" for escape in trap.escapes}
    curve = axial.lines[2].get_xydata()
    expected = tweezer.optical_force(scene, [0, 0, curve[100, 0] * 1e-6])[2] + weight(scene)
    assert curve[100, 1] == pytest.approx(expected * 1e12, rel=1e-9)
    note = figure.get_supxlabel().replace("\n", " ")
    assert typeset(trap.caveat)[1:] in note
    assert "Red lines: edges of the cone of light." in note
    readable.check(figure)


def test_figure_prints_a_description_as_it_stands():
    scene = tweezer.load_scene({**silica().model_dump(mode="json"), "description": r"$\frac{ $"})
    figure = trap_figure(scene, tweezer.characterise(scene))
    figure.savefig(Path("/dev/null"), format="png")


@pytest.mark.parametrize(
    "changes",
    [{"forces": {"optical": False, "gravity": False, "buoyancy": False}},
     {"bead": {"refractive_index": 1.2}}],
    ids=["dark and weightless", "repelled"],
)  # fmt: skip
def test_figure_of_no_trap(changes):
    scene = silica(**changes)
    figure = trap_figure(scene, tweezer.characterise(scene))
    readable.check(figure)
    assert figure.axes[0].get_title() == "no stable equilibrium; through the focus"
    assert not [patch for patch in figure.axes[1].patches if isinstance(patch, Circle)]
    assert len(figure.axes) == (4 if scene.lit else 3)  # a bar of colours
