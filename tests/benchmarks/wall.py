"""Thermal motion beside a wall: bias against step, first passage, inertia, step rates.

A sphere of silica of 3 um under its weight above a wall. The mean gap is kT over the weight, and
the part of time below a tenth of it 1 - e^(-1/10); T is the time in which the gap relaxes. Beside
the schemes of the product are three that are written here: Euler's with the drift of the changing
mobility, reflected at contact; Fixman's (the mobility of the noise from where it leads to); and
Euler's without the drift. The results are plain data for JSON.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.integrate import quad

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import least_step_times, machine
from tweezer.dynamics.walk import Walk, walk
from tweezer.generated.wall import mobilities
from tweezer.scene import Scene

Array = NDArray[np.float64]
Results = dict[str, Any]

#: m
RADIUS = 1.5e-6
SINKING = tweezer.load_scene("silica-1um").replace(
    bead={"radius": RADIUS}, forces={"brownian": True, "optical": False},
    medium={"inertia": "none"}, wall={"position": 0.0},
    start={"frame": "focus", "position": [0, 0, 1.02 * RADIUS]},
    simulation={"model": "overdamped", "loss_distance": 1.0},
)  # fmt: skip
#: steps over T
STEPS = (0.05, 0.1, 0.2, 0.4, 0.8)
#: steps over the relaxation time of the velocity, and over T
RATIOS, OF_INERTIA = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0), 0.05
#: mean gap, radii, or 0 without weight; begin and end of a passage in it, or in 0.02 radii
PASSAGES = (
    (0.02, 0.2, 2.0), (0.02, 0.05, 1.0), (0.02, 1.0, 4.0), (0.002, 0.2, 2.0), (0.5, 0.2, 2.0),
    (0.0, 1.0, 20.0),
)  # fmt: skip
#: step over the time of the passage without a wall
_OF_PASSAGE = 2e-3
#: samples advanced at once
_PIECE = 25


def measure(quick: bool = False, say: Callable[[str], None] = lambda _: None) -> Results:
    """Everything; quick: less of it, to see that it runs. say: told what is measured."""
    results = {
        "machine": machine(),
        "bias": _biases(quick, say),
        "passages": [_passage(*each, quick, say) for each in PASSAGES[: 1 if quick else None]],
        "inertia": [_inertia(each, quick, say) for each in (RATIOS[:2] if quick else RATIOS)],
        "steps": _steps(quick, say),
    }
    return _to_four_digits(results)


def _known(scene: Scene) -> tuple[float, float]:
    """Mean gap in radii, and D/a^2, 1/s."""
    bead = tweezer.bead_properties(scene)
    kT = 1.380649e-23 * scene.medium.temperature
    weight = -bead.weight[2]
    return kT / (weight * RADIUS) if weight else math.inf, kT / bead.drag / RADIUS**2


def _walk(scene: Scene, step: float, per_sample: int = 1, samples: int = 2, **keys: Any) -> Walk:
    simulation = {
        "step": step * (1 + 1e-9), "samples": samples, **keys,
        "duration": f"{step * per_sample * (samples - 1)!r} s",
    }  # fmt: skip
    return walk(scene.replace(simulation=simulation), 1)


def _states(bound: Walk, gaps: Array) -> Array:
    states = bound.start(np.arange(len(gaps)))
    states[:, 2] = RADIUS * (1 + gaps)
    return states


def _told(mean: Array, low: Array, of: float) -> Results:
    """Biases of the mean gap and of the part below a tenth of it, in %, from those of beads."""
    n, rare = len(mean), -math.expm1(-0.1)
    return {
        "mean": 100 * float(mean.mean() / of - 1),
        "mean_error": 100 * float(mean.std() / math.sqrt(n) / of),
        "low": 100 * float(low.mean() / rare - 1),
        "low_error": 100 * float(low.std() / math.sqrt(n) / rare),
    }


# --- bias ----------------------------------------------------------------------------------------


def _biases(quick: bool, say: Callable[[str], None]) -> list[Results]:
    n, times = (500, 20) if quick else (20_000, 100)
    mean, rate = _known(SINKING)
    T = mean / rate
    found = []
    for step in STEPS[2:3] if quick else STEPS:
        many = round(times / 0.8)
        for method in ("heun", "one-call"):
            say(f"bias: {method}, {step} of T")
            bound = _walk(SINKING, step * T, round(0.8 / step), many + 1, method=method)
            told = _told(*_followed(bound, n, mean), mean)
            found.append({"scheme": method, "step": step, **told})
        for name, which in (("euler, drift", 0), ("fixman", 1), ("euler, no drift", 2)):
            say(f"bias: {name}, {step} of T")
            rng, many_steps = np.random.default_rng(1), round(times / step)
            told = _told(*_others(rng, which, n // 4, step * mean, many_steps, mean), mean)
            found.append({"scheme": name, "step": step, **told})
    return found


def _followed(bound: Walk, n: int, mean: float) -> tuple[Array, Array]:
    """Mean gap and part below a tenth of the mean of each of n beads, from Boltzmann's."""
    who = np.arange(n)
    states = _states(bound, np.random.default_rng(1).exponential(mean, n))
    total, low, begin = np.zeros(n), np.zeros(n), 5
    last = len(bound.times) - 1
    for sample in range(0, last, _PIECE):
        out = np.empty((n, min(_PIECE, last - sample), len(bound.columns)))
        bound.advance(states, who, sample, out)
        gaps = (out[:, max(0, begin - sample) :, 2] / RADIUS) - 1
        total += gaps.sum(axis=1)
        low += (gaps < 0.1 * mean).sum(axis=1)
    return total / (last - begin), low / (last - begin)


@njit
def _others(rng, which, n, step, many, mean):  # type: ignore[no-untyped-def]
    """The same of a scheme; step: in a^2/D. Reflected at contact."""
    total, low = np.zeros(n), np.zeros(n)
    begin = many // 20
    for i in range(n):
        g = mean * rng.exponential()
        for at in range(many):
            normal = rng.normal()
            found = mobilities(g)
            mu, slope = found[0], found[5]
            wide = math.sqrt(2 * mu * step) * normal
            if which == 1:
                ahead = mobilities(abs(g - mu / mean * step + wide))[0]
                new = g - mu / mean * step + 0.5 * (1 + ahead / max(mu, 1e-12)) * wide
            else:
                new = g + (slope * (which == 0) - mu / mean) * step + wide
            g = abs(new)
            if at >= begin:
                total[i] += g
                low[i] += g < 0.1 * mean
    return total / (many - begin), low / (many - begin)


# --- first passage -------------------------------------------------------------------------------


def _passage(
    mean: float, begin: float, end: float, quick: bool, say: Callable[[str], None]
) -> Results:
    """Mean time from one gap to another, away from the wall, over the double integral."""
    say(f"passage: mean gap {mean:g} radii, {begin:g} to {end:g}")
    usual, rate = _known(SINKING)
    scene = SINKING.replace(forces={"gravity": False, "buoyancy": False})
    unit = 0.02
    if mean:
        unit, g = mean, 9.80665 * usual / mean
        scene = SINKING.replace(forces={"gravitational_acceleration": g})

    def inner(y: float) -> float:
        below = mean * math.expm1(y / mean) if mean else y
        return below / mobilities(y)[0]

    low, high = begin * unit, end * unit
    exact = quad(inner, low, high, limit=200)[0] / rate
    n, piece = (1000 if quick else 40_000), 200
    step = _OF_PASSAGE * exact
    bound = _walk(scene, step, 1, 200 * piece + 1, method="heun")
    grid = np.sqrt(np.geomspace(1e-9, 4 * high + 20 * unit, 20_000))
    change = 2 * grid / np.sqrt(2 * np.array([mobilities(g)[0] for g in grid**2]))
    r = grid[0] * change[0] + np.append(
        0, np.cumsum(np.diff(grid) * (change[1:] + change[:-1]) / 2)
    )
    reached = np.interp(high, grid**2, r)
    rng = np.random.default_rng(2)
    passed = np.full(n, np.nan)
    who = np.arange(n)
    states = _states(bound, np.full(n, low))
    before = np.full(n, reached - np.interp(low, grid**2, r))
    for at in range(0, 200 * piece, piece):
        out = np.empty((len(who), piece, 3))
        bound.advance(states, who, at, out)
        away = reached - np.interp(out[:, :, 2] / RADIUS - 1, grid**2, r)
        away = np.hstack([before[:, None], away])
        chance = np.exp(-2 * np.maximum(away[:, 1:], 0) * np.maximum(away[:, :-1], 0)
                        / (step * rate))  # fmt: skip
        there = (away[:, 1:] <= 0) | (rng.random(chance.shape) < chance)
        first, any_there = there.argmax(axis=1), there.any(axis=1)
        passed[who[any_there]] = (at + first[any_there] + 0.5) * step
        left = ~any_there
        who, states, before = who[left], np.ascontiguousarray(states[left]), away[left, -1]
        if not len(who):
            break
    assert not np.isnan(passed).any()
    return {
        "mean_gap": mean, "begin": begin, "end": end, "exact_s": exact, "beads": n,
        "off": 100 * float(passed.mean() / exact - 1),
        "error": 100 * float(passed.std() / math.sqrt(n) / exact),
    }  # fmt: skip


# --- inertia, and step rates ---------------------------------------------------------------------


def _inertia(ratio: float, quick: bool, say: Callable[[str], None]) -> Results:
    """Biases of steps of so many relaxation times at the mean gap, in a fluid that is so thin."""
    say(f"inertia: steps of {ratio:g} relaxation times")
    n, times = (500, 20) if quick else (8000, 100)
    bead = tweezer.bead_properties(SINKING)
    mean, _ = _known(SINKING)
    weight = -bead.weight[2]
    drag = math.sqrt(bead.mass * mean * weight * ratio / (RADIUS * OF_INERTIA))
    scene = SINKING.replace(
        medium={"viscosity": drag / (6 * math.pi * RADIUS)}, simulation={"model": "full"}
    )
    step = OF_INERTIA * RADIUS * drag / weight
    bound = _walk(scene, step, 8, round(times / OF_INERTIA / 8) + 1, method="heun")
    flight = math.sqrt(1.380649e-23 * scene.medium.temperature * bead.mass) / drag / RADIUS
    return {"ratio": ratio, "flight": flight, **_told(*_followed(bound, n, mean), mean)}


def _steps(quick: bool, say: Callable[[str], None]) -> list[Results]:
    """Steps of 128 beads in a trap 1 um above a wall by the map, in turn, the least of repeats."""
    beads, samples, rounds = 128, 3, 3 if quick else 60
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, optics={"evaluator": "map"}, medium={"inertia": "none"},
        start={"drawn": "boltzmann"}, simulation={"duration": "20 ms", "samples": 101},
    )  # fmt: skip
    walls = {
        "none": {}, "one": {"wall": {"position": "-1 um"}},
        "two": {"wall": {"position": "-1 um", "opposite": "20 um"}},
    }  # fmt: skip
    walks = {
        (model, method, name): walk(
            scene.replace(simulation={"model": model, "method": method}, **wall), 1
        )
        for model, method in (
            ("overdamped", "heun"), ("overdamped", "one-call"), ("full", "heun"),
        )
        for name, wall in walls.items()
    }  # fmt: skip
    least = least_step_times(
        walks, beads, samples, rounds, lambda kind: say(f"steps: {', '.join(kind)}")
    )
    return [
        {"model": model, "method": method, "walls": name, "step_s": walks[model, method, name].step,
         "ns": 1e9 * ns, "rate": least[model, method, "none"] / ns}
        for (model, method, name), ns in least.items()
    ]  # fmt: skip
