"""Thermal motion of rods in exact light: hops between two traps, flips, and distributions.

The rod is a polystyrene spheroid of 0.2 by 0.4 um in water. The light is linearly polarised along
x, on which the foci lie. Each focus has either one beam upwards, or two opposed beams of half the
power that do not interfere. Opposed beams push nowhere, so their force has almost a potential.

Measured distributions are compared with Boltzmann's weight of the energies of
`tests.benchmarks.pose_grid`. A cycle is a passage between two sets of poses and back. For a
coordinate c with the diffusion D(c), averaged over the poses, and the density p(c), the rate of
cycles between c < a and c > b is at most 1 / (integral of 1/(D p) from a to b), by Dirichlet's
principle for reversible motion. It is reached if all other coordinates relax sooner.

Rotation is measured on a driven top, where mean rotation and heat have closed forms, and on the
length of the Euler parameters after many rotations.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import mpmath
import numpy as np
from numpy.typing import NDArray
from scipy.constants import Boltzmann
from scipy.interpolate import BarycentricInterpolator, CubicSpline
from scipy.spatial.transform import Rotation

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.pose_grid import PoseGrid
from tests.benchmarks.timing import Call, machine, on_all_cores, per_item
from tests.reference.poses import Well, a_body, follow
from tweezer.compiled import cached_njit
from tweezer.dynamics.brownian import body
from tweezer.dynamics.se3 import moved
from tweezer.dynamics.walk import walk
from tweezer.optics import light_force
from tweezer.scene import Scene

Array = NDArray[np.float64]
Results = dict[str, Any]

#: Diameter and length of the rod, m
ROD = (0.2e-6, 0.4e-6)
#: Power at a focus, W, and distance of the two foci, m; the right one is stronger by a part
POWER, APART, STRONGER = 8e-3, 0.63e-6, 0.01
#: Duration of a step, s
STEP = 75e-6
#: Poses beyond which the rod is in a trap (x, m), and directed along the polarisation (n_x)
CORES = {"x": 0.2e-6, "n_x": 0.8}
LYING = (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)
#: Bins of the angle between axis and polarisation, degrees
BINS = np.linspace(0.0, 90.0, 19)
#: Steps of the drawn trajectory, and steps from point to point
SHOWN, EVERY = 160_000, 160


class Effort(NamedTuple):
    """How much is measured."""

    hopping_steps: int
    """steps of each trajectory in two traps"""
    block: int
    """steps of the blocks that give errors, and steps left out after the release"""
    trajectories: int
    """trajectories in each of two processes"""
    ways: tuple[bool, ...]
    """whether beams are opposed"""
    steps: int
    """steps of the rod in one trap, all trajectories together"""
    counts: tuple[int, int, int, int, int]
    """nodes of the poses in two traps; in one trap a third as many in x"""
    rounds: int
    tops: int
    """driven tops"""
    updates: int
    """rotations one after the other"""


FULL = Effort(
    hopping_steps=540_000, block=60_000, trajectories=4, ways=(False, True), steps=1_000_000,
    counts=(44, 15, 19, 8, 14), rounds=60, tops=8192, updates=100_000_000,
)  # fmt: skip
QUICK = Effort(
    hopping_steps=9_000, block=3_000, trajectories=1, ways=(True,), steps=8_000,
    counts=(12, 5, 5, 4, 4), rounds=3, tops=64, updates=100_000,
)  # fmt: skip


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """Return the results of the whole benchmark; `say` is called with each subject."""
    effort = QUICK if quick else FULL
    results: Results = {
        "machine": machine(), "quick": quick, "rod_m": list(ROD), "power_W": POWER,
        "apart_m": APART, "stronger": STRONGER, "step_s": STEP, "cores": CORES,
    }  # fmt: skip
    results["hopping"] = [_hopping(effort, opposed, say) for opposed in effort.ways]
    results["one_trap"] = [_one_trap(effort, opposed, say) for opposed in effort.ways]
    say("time of a step")
    results["time"] = _time(effort)
    say("driven top")
    results["top"] = driven_top(effort.tops)
    say("many rotations")
    results["rotations"] = rotations(effort.updates)
    rounded: Results = _to_four_digits(results)
    return rounded


# --- scenes --------------------------------------------------------------------------------------


def scene_of(foci: dict[float, float], *, opposed: bool, samples: int, step: float = STEP) -> Scene:
    """Return the rod, released at the first focus and sampled at every step.

    Parameters
    ----------
    foci : dict
        Power, W, by the position x of the focus, m.
    opposed : bool
        Whether each focus has two opposed beams of half its power.
    samples : int
        Number of steps.
    step : float, optional
        Duration of a step, s.
    """
    ways = ("up", "down") if opposed else ("up",)
    diameter, length = ROD
    return tweezer.load_scene("two-traps").replace(
        bead={
            "shape": "spheroid", "diameter": diameter, "length": length, "material": "polystyrene"
        },
        beam=[
            {
                "wavelength": 1064e-9, "waist": 2.5e-3, "polarisation": "linear",
                "position": [x, 0, 0], "direction": way,
                "power_through_pupil": power / len(ways),
            }
            for x, power in foci.items() for way in ways
        ],
        forces={"brownian": True},
        start={"position": [next(iter(foci)), 0, 0], "orientation": LYING},
        simulation={
            "model": "overdamped", "method": "heun", "duration": f"{samples * step} s",
            "samples": samples + 1,
        },
    )  # fmt: skip


def two_traps(steps: int, *, opposed: bool) -> Scene:
    """Return the rod in two traps."""
    foci = {-APART / 2: POWER, APART / 2: POWER * (1 + STRONGER)}
    return scene_of(foci, opposed=opposed, samples=steps)


def followed(scene: Scene, seed: int, trajectories: int) -> tuple[Array, Array, float]:
    """Return positions and directions of the axis (n, steps, 3), and the processor's time, s.

    A trajectory that is lost raises `ValueError`.
    """
    bound = walk(scene, seed)
    who = np.arange(trajectories)
    states, steps = bound.start(who), scene.simulation.samples - 1
    out = np.empty((trajectories, steps, len(bound.columns)))
    assert bound.per_sample == 1, "the scene's step is the duration between two samples"
    bound.advance(states, who, 0, out[:, :1])
    began = time.process_time()
    bound.advance(states, who, 1, out[:, 1:])
    spent = time.process_time() - began
    if np.isnan(out).any():
        raise ValueError("a rod escaped")
    e = np.moveaxis(out[..., 3:7], -1, 0)
    axis = [
        2 * (e[1] * e[3] + e[0] * e[2]), 2 * (e[2] * e[3] - e[0] * e[1]),
        1 - 2 * (e[1] ** 2 + e[2] ** 2),
    ]  # fmt: skip
    return out[..., :3], np.stack(axis, axis=-1), spent


# --- two traps -----------------------------------------------------------------------------------


def _hopping(effort: Effort, opposed: bool, say: Callable[[str], object]) -> Results:
    """Return rates of hops and flips, occupation, and what energies predict."""
    name = "opposed beams" if opposed else "beams upwards"
    say(f"two traps, {name}: energies")
    z = (-0.45e-6, 0.45e-6) if opposed else (-0.35e-6, 0.85e-6)
    grid = PoseGrid.of(two_traps(2, opposed=opposed), (0.55e-6, 0.2e-6), z, effort.counts)
    expected = _expected(grid)
    say(f"two traps, {name}: motion")
    tasks = [(opposed, seed, effort) for seed in (1, 2)]
    parts = on_all_cores(in_two_traps, tasks, say)[opposed]
    return {"beams": name, **expected, **_rates(parts)}


def in_two_traps(opposed: bool, seed: int, effort: Effort) -> Results:
    """Return the counts of some trajectories, by blocks, and a part of the first one to be drawn.

    Cycles, shares of the time on the right and the means of n_x^2 have one entry a block.
    """
    scene = two_traps(effort.hopping_steps, opposed=opposed)
    x, n, spent = followed(scene, seed, effort.trajectories)
    block = effort.block
    found: Results = {"seconds": spent, "steps": x.shape[0] * x.shape[1], "block": block}
    for name, values in (("x", x[..., 0]), ("n_x", n[..., 0])):
        entered = np.array([passages(each, CORES[name]) for each in values])[:, block:]
        found[name] = entered.reshape(-1, block).sum(axis=1)
    for name, values in (("right", x[..., 0] > 0), ("aligned", n[..., 0] ** 2)):
        found[name] = values[:, block:].reshape(-1, block).mean(axis=1)
    found["trace"] = np.stack([x[0, :SHOWN, 0], n[0, :SHOWN, 0]])[:, ::EVERY]
    return found


def passages(values: Array, core: float) -> Array:
    """Return at which steps a coordinate enters the other of the sets < -core and > core, as 0
    or 1.
    """
    side = np.where(values > core, 1, np.where(values < -core, -1, 0))
    at = np.flatnonzero(side)
    entered = np.zeros(len(values), int)
    entered[at[1:]] = side[at[1:]] != side[at[:-1]]
    return entered


def _rates(parts: list[Results]) -> Results:
    """Return rates per second with their standard errors over blocks; and cost."""
    found: Results = {}
    for name, quantity in (("x", "hops"), ("n_x", "flips")):
        counts = np.concatenate([part[name] for part in parts])
        found[quantity] = int(counts.sum())
        found[f"{quantity}_per_s"] = _with_error(counts / (parts[0]["block"] * STEP))
    right = np.concatenate([part["right"] for part in parts])
    mean, error = _with_error(right)
    found["right_over_left"] = [mean / (1 - mean), error / (1 - mean) ** 2]
    found["aligned"] = _with_error(np.concatenate([part["aligned"] for part in parts]))
    steps, seconds = (sum(part[key] for part in parts) for key in ("steps", "seconds"))
    return found | {
        "steps": steps, "followed_s": steps * STEP, "us_per_step": 1e6 * seconds / steps,
        "cpu_s": seconds, "trace": parts[0]["trace"].tolist(),
    }  # fmt: skip


def _with_error(blocks: Array) -> list[float]:
    """Return the mean of independent blocks and its standard error."""
    return [float(blocks.mean()), float(blocks.std(ddof=1) / math.sqrt(len(blocks)))]


def _expected(grid: PoseGrid) -> Results:
    """Return what the energies by two paths predict; each entry has one number for each path."""
    both, apart = _by_energy(grid)
    of_paths = [_predicted(grid, each) for each in both]
    predicted = {key: [each[key] for each in of_paths] for key in of_paths[0]}
    return {"path_rms_kT": apart, **predicted}


def _by_energy(grid: PoseGrid) -> tuple[list[Array], float]:
    """Return the probabilities of the poses by both paths, and how far their energies differ, kT.

    The difference is its root mean square about its mean.
    """
    kT = Boltzmann * grid.scene.medium.temperature
    energies = grid.energies()
    both = [grid.probabilities(each, kT) for each in energies]
    apart = (energies[1] - energies[0]) / kT
    mean = (both[0] * apart).sum()
    return both, math.sqrt((both[0] * (apart - mean) ** 2).sum())


def _predicted(grid: PoseGrid, p: Array) -> dict[str, float]:
    """Return occupation, bounds of the rates and a depth from probabilities of poses."""
    kT = Boltzmann * grid.scene.medium.temperature
    B = np.linalg.inv(np.array(tweezer.resistance(grid.scene).matrix))
    aligned = np.cos(grid.alpha.at) ** 2
    of_x, of_alpha = p.sum(axis=(1, 2, 3, 4)), p.sum(axis=(0, 1, 2, 4))
    density = CubicSpline(grid.x.at, np.log(of_x / grid.x.weight))
    square = p.sum(axis=(1, 2, 4)) @ aligned / of_x
    mobility = CubicSpline(grid.x.at, B[0, 0] + (B[2, 2] - B[0, 0]) * square)
    x = np.linspace(-CORES["x"], CORES["x"], 2001)
    hops = 2 / np.trapezoid(np.exp(-density(x)) / (kT * mobility(x)), x)
    of_n = of_alpha / (2 * grid.alpha.weight * np.sin(grid.alpha.at))
    logarithm = BarycentricInterpolator(aligned, np.log(of_n))
    n = np.linspace(0, CORES["n_x"], 1001)
    flips = 1 / np.trapezoid(np.exp(-logarithm(n**2)) / (kT * B[3, 3] * (1 - n**2)), n)
    deep = np.linspace(grid.x.at[0], grid.x.at[-1], 201)
    middle = np.exp(density(np.linspace(-0.1e-6, 0.1e-6, 401))).min()
    depth = np.log(np.exp(density(deep[deep < 0])).max() / middle)
    right = of_x[grid.x.at > 0].sum()
    return {
        "right_over_left_by_energy": float(right / (1 - right)),
        "aligned_by_energy": float(of_alpha @ aligned), "hops_at_most_per_s": float(hops),
        "flips_at_most_per_s": float(flips), "barrier_kT": float(depth),
    }  # fmt: skip


# --- one trap ------------------------------------------------------------------------------------


def _one_trap(effort: Effort, opposed: bool, say: Callable[[str], object]) -> Results:
    """Return the distribution of the orientation in one trap, at the step and at half of it."""
    name = "opposed beams" if opposed else "beam upwards"
    say(f"one trap, {name}")
    z = (-0.45e-6, 0.45e-6) if opposed else (-0.35e-6, 0.85e-6)
    foci = {0.0: POWER}
    in_x, *others = effort.counts
    grid = PoseGrid.of(
        scene_of(foci, opposed=opposed, samples=2), (0.22e-6, 0.18e-6), z,
        (in_x // 3 | 1, *others),
    )  # fmt: skip
    both, apart = _by_energy(grid)
    squares = grid.directions(grid.alpha.at) ** 2
    runs = [_distribution(effort, opposed, foci, part) for part in (1.0, 0.5)]
    return {
        "beams": name, "path_rms_kT": apart,
        "mean_squares_by_energy": [np.einsum("xyzap,apk->k", p, squares).tolist() for p in both],
        "shares_by_energy": [_shares(grid, p).tolist() for p in both], "runs": runs,
    }  # fmt: skip


def _distribution(effort: Effort, opposed: bool, foci: dict[float, float], part: float) -> Results:
    """Return mean squares of the axis and shares of the bins, with errors over blocks."""
    trajectories = 16
    per = round(effort.steps / trajectories)
    scene = scene_of(foci, opposed=opposed, samples=per, step=part * STEP)
    _, n, seconds = followed(scene, 3, trajectories)
    n = n[:, min(round(0.2 / (part * STEP)), per // 4) :]
    blocks = n[:, : n.shape[1] // 4 * 4].reshape(4 * trajectories, -1, 3)
    angle = np.degrees(np.arccos(np.abs(blocks[..., 0])))
    shares = np.array([np.histogram(each, BINS)[0] / len(each) for each in angle])
    mean_squares = [_with_error((blocks[..., k] ** 2).mean(axis=1)) for k in range(3)]
    return {
        "step_s": part * STEP, "steps": effort.steps, "seconds": seconds,
        "mean_squares": mean_squares, "shares": [_with_error(each) for each in shares.T],
    }  # fmt: skip


def _shares(grid: PoseGrid, p: Array) -> Array:
    """Return the probability of each bin of the angle to the polarisation."""
    of_alpha = p.sum(axis=(0, 1, 2, 4)) / (grid.alpha.weight * np.sin(grid.alpha.at))
    logarithm = BarycentricInterpolator(np.cos(grid.alpha.at) ** 2, np.log(of_alpha))
    s, w = np.polynomial.legendre.leggauss(12)
    edges = np.radians(BINS)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    at = middle[:, None] + half[:, None] * s
    found = (np.exp(logarithm(np.cos(at) ** 2)) * np.sin(at) * w * half[:, None]).sum(axis=1)
    return np.asarray(found / found.sum())


def _time(effort: Effort) -> Results:
    """Return the least time of a step and of two force calls for a rod in one trap, us."""
    rods, steps = 16, 4
    scene = scene_of({0.0: POWER}, opposed=False, samples=10 * effort.rounds * steps)
    bound, who = walk(scene, 1), np.arange(rods)
    states, out = bound.start(who), np.empty((rods, steps, len(bound.columns)))
    bound.advance(states, who, 0, out)
    samples = itertools.count(steps, steps)
    light = light_force(scene)
    at, turned = np.ascontiguousarray(out[:, -1, :3]), np.ascontiguousarray(out[:, -1, 3:7])

    def some_steps() -> None:
        bound.advance(states, who, next(samples), out)

    evaluate = partial(
        light.field, np.tile(at, (steps, 1)), orientations=np.tile(turned, (steps, 1))
    )
    calls = Call(some_steps, rods * steps), Call(evaluate, rods * steps)
    (step, _), (force, _) = per_item([[call] for call in calls], effort.rounds)
    return {"step_us": 1e6 * step, "two_calls_us": 2e6 * force, "ratio": step / (2 * force)}


# --- rotation alone ------------------------------------------------------------------------------

#: Mobilities across and along the axis, constant torque about z, and K_3 of the well, in kT
TOP = {"b": 0.5, "b_3": 2.0, "torque": 3.0, "K_3": 5.0}


def driven_top(count: int, part: float = 0.2) -> Results:
    """Return mean rotation and heat flow of driven tops, in kT = 1, with errors and exact values.

    The heat is the work of all torques along the path, in Stratonovich's sense. Without a torque
    about z it vanishes on average.

    Parameters
    ----------
    count : int
        Number of tops.
    part : float, optional
        Step in the time scale of the well.
    """
    b, b_3, torque, K_3 = TOP.values()
    h = part / (2 * b * K_3)
    steps, forgotten = 2000, 200
    rates, heats = [], []
    for seed in range(1 + (count - 1) // 512):
        top = a_body(np.diag([1, 1, 1, b, b, b_3]))
        out = follow(
            body.TRAPEZOID, top, h, min(count, 512), steps + forgotten, 1,
            Well(K_3=K_3, torque=torque), seed=seed,
        )[:, forgotten:]  # fmt: skip
        angle, work = turned_and_worked(out[..., 3:], K_3, torque)
        rates.append(angle.mean(axis=1) / h)
        heats.append(work.mean(axis=1) / h)
    c, w = np.polynomial.legendre.leggauss(40)
    w = w * np.exp(K_3 * c**2 / 2)
    exact = torque * (b + (b_3 - b) * float((w * c**2).sum() / w.sum()))
    return {
        **TOP, "step_over_time_scale": part, "tops": count, "steps": steps,
        "rotation_exact": exact, "heat_exact": torque * exact,
        "rotation_deviation": _with_error(np.concatenate(rates) / exact - 1),
        "heat_deviation": _with_error(np.concatenate(heats) / (torque * exact) - 1),
    }  # fmt: skip


def turned_and_worked(e: Array, K_3: float, torque: float) -> tuple[Array, Array]:
    """Return the rotation about z in each step, rad, and the work of the torques, in kT.

    Parameters
    ----------
    e : ndarray, shape (n, samples, 4)
        Euler parameters at each step.
    K_3, torque : float
        Well -K_3 n_z^2/2 of the axis n, and the constant torque about z, in kT.
    """
    shape = e.shape[:2]
    R = Rotation.from_quat(e.reshape(-1, 4), scalar_first=True).as_matrix().reshape(*shape, 3, 3)
    step = R[:, 1:] @ np.swapaxes(R[:, :-1], -1, -2)
    turned = Rotation.from_matrix(step.reshape(-1, 3, 3)).as_rotvec().reshape(*step.shape[:2], 3)
    n = R[..., 2]
    z = np.array([0.0, 0.0, 1.0])
    all_torques = K_3 * n[..., 2:] * np.cross(n, z) + torque * z
    middle = (all_torques[:, 1:] + all_torques[:, :-1]) / 2
    return turned[..., 2], np.einsum("nsk,nsk->ns", middle, turned)


@cached_njit(error_model="numpy")
def _after(twists, rounds, q, e):  # type: ignore[no-untyped-def]
    """Apply twists (m, 6) in turn for some rounds; return the largest | |e|^2 - 1 |."""
    largest = 0.0
    for _ in range(rounds):
        for i in range(len(twists)):
            moved(q, e, twists[i], q, e)
            size = e[0] ** 2 + e[1] ** 2 + e[2] ** 2 + e[3] ** 2
            largest = max(largest, abs(size - 1.0))
    return largest


def rotations(updates: int) -> Results:
    """Return the error of |e| and of the orientation after many rotations.

    A thousand fixed twists, each by a little more than a whole turn about a random axis, are
    applied again and again. Their product is known to 50 digits. And a free rod in thermal motion
    is followed for as many updates of its orientation, five for each step.
    """
    rng = np.random.default_rng(1)
    axes = rng.normal(size=(1000, 3))
    angles = 2 * math.pi + rng.random(1000)
    twists = np.zeros((1000, 6))
    twists[:, 3:] = axes / np.linalg.norm(axes, axis=1)[:, None] * angles[:, None]
    q, e, rounds = np.zeros(3), np.array([1.0, 0, 0, 0]), max(1, updates // 1000)
    _after(twists, 1, q.copy(), e.copy())
    began = time.perf_counter()
    largest = _after(twists, rounds, q, e)
    seconds = time.perf_counter() - began
    per_sample = max(1, updates // 5 // 1000)
    free = follow(
        body.TRAPEZOID, a_body(np.diag([1, 1, 1, 0.5, 0.8, 2.0])), 0.05, 1, 1000, per_sample
    )
    length = np.linalg.norm(free[..., 3:], axis=-1)
    return {
        "turns": float(angles.sum() * rounds / (2 * math.pi)), "updates": 1000 * rounds,
        "length_error": largest / 2, "ns_per_update": 1e9 * seconds / (1000 * rounds),
        "orientation_error_rad": _angle(e, _power(twists, rounds)),
        "thermal_updates": 5000 * per_sample,
        "thermal_length_error": float(np.abs(length - 1).max()),
    }  # fmt: skip


def _power(twists: Array, rounds: int) -> Array:
    """Return the Euler parameters of the product of rotations, taken some times, by 50 digits."""
    with mpmath.workdps(50):
        product = [mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(0)]
        for twist in twists[:, 3:]:
            w = [mpmath.mpf(float(each)) for each in twist]
            size = mpmath.sqrt(sum(each**2 for each in w))
            product = _times(
                product, [mpmath.cos(size / 2), *(mpmath.sin(size / 2) * each / size for each in w)]
            )
        half = mpmath.acos(product[0]) * rounds
        axis_length = mpmath.sqrt(sum(each**2 for each in product[1:]))
        found = [mpmath.cos(half), *(mpmath.sin(half) * each / axis_length for each in product[1:])]
        return np.array([float(each) for each in found])


def _times(a: list[Any], b: list[Any]) -> list[Any]:
    """Return the product of two quaternions."""
    return [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
        a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1],
    ]


def _angle(e: Array, other: Array) -> float:
    """Return the angle between two orientations, rad."""
    return float(2 * min(np.linalg.norm(e - other), np.linalg.norm(e + other)))
