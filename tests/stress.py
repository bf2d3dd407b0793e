"""Random scenes over many decades: each ends finite, or with a typed error.

`python -m tests.stress 10000` prints how they ended; `make stress` calls it. A run whose numbers
are not finite, or an error that is not tweezer's own, raises and names the scene.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections import Counter
from typing import Any

import numpy as np

import tweezer
from tweezer.dynamics import (
    bind,
    chosen,
    closest_approach,
    integrate,
    lens_touched,
    loss,
)
from tweezer.dynamics.integrate import SOFT, SOFT_IN_TOLERANCES
from tweezer.dynamics.walk import walk
from tweezer.scene import Scene
from tweezer.values.errors import IntegrationError, TweezerError

#: force calls of one run: what needs more ends as failed, its work spent
MOST_CALLS = 20_000
METHODS = ("auto", "auto", "auto", "exponential", "dormand-prince", "dop853", "scipy:LSODA")
MODELS = (None, None, "full", "scaled", "overdamped", "first-order")
STOCHASTIC = ("auto", "auto", "one-call", "harmonic", "euler-maruyama", "baoab")
#: thermal beads of a scene
BEADS = 4
#: depth in a wall that is rounding, of the bead's coordinate
ROUNDING = 1e-14


def random_changes(rng: np.random.Generator) -> dict[str, dict[str, Any]]:
    """Changes of a shipped scene, over the range that a user may ask for."""

    def decades(low: float, high: float) -> float:
        return float(10 ** rng.uniform(np.log10(low), np.log10(high)))

    radius = decades(25e-9, 10e-6)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    if rng.random() < 0.15:
        direction = np.array([0.0, 0.0, rng.choice([-1.0, 1.0])])  # on the axis
    distance = rng.choice([0.0, 1.0, 1.0 - 1e-9, rng.uniform(0, 3), decades(1e-3, 30)]) * radius
    orientation = rng.normal(size=4)
    if rng.random() < 0.3:
        orientation[0] = 0.0  # turned by 180 degrees
    spin = decades(1, 1e7) * rng.normal(size=3) if rng.random() < 0.3 else np.zeros(3)
    power = 0.0 if rng.random() < 0.05 else decades(1e-6, 10)
    start = direction * min(distance, 1.5e-3)
    bead: dict[str, Any] = {"radius": radius, "refractive_index": rng.uniform(1.0, 2.5),
                            "density": rng.uniform(900, 4000)}  # fmt: skip
    if spin.any() and rng.random() < 0.3:
        inertia = 0.4 * bead["density"] * 4 / 3 * np.pi * radius**5
        bead["moments_of_inertia"] = (inertia * rng.uniform(0.8, 1.2, 3)).tolist()
    model = MODELS[rng.integers(len(MODELS))]
    return {
        "bead": bead,
        "medium": {"viscosity": decades(1e-5, 1.0)},
        "beam": {"power": power, "torque": "thesis" if rng.random() < 0.2 else "none"},
        "start": {
            "frame": "focus", "position": start.tolist(),
            "velocity": (decades(1e-9, 1) * rng.normal(size=3)).tolist(),
            "orientation": orientation.tolist(), "angular_velocity": spin.tolist(),
        },
        "optics": {
            "evaluator": "grid" if rng.random() < 0.1 else "quadrature",
            "tolerance": 10.0 ** -int(rng.integers(4, 10)),
        },
        "simulation": {
            "model": model, "scaling_factor": decades(1e-5, 1),
            "method": METHODS[rng.integers(len(METHODS))],
            "duration": decades(1e-9, 1e-1), "samples": 21,
            "relative_tolerance": float(10 ** -rng.uniform(3, 10)),
            "position_tolerance": radius * decades(1e-9, 1e-3),
            "loss_distance": 2e-3, "most_force_calls": MOST_CALLS,
            "step": decades(1e-9, 1e-4) if rng.random() < 0.1 else None,
        },
    }  # fmt: skip


def beside_a_wall(
    rng: np.random.Generator, changes: dict[str, dict[str, Any]]
) -> dict[str, dict[str, Any]]:
    """The same beside a wall, or between two: near contact, far away, now and then in the wall."""
    radius, z = changes["bead"]["radius"], changes["start"]["position"][2]
    side = ("above", "below")[rng.integers(2)]
    normal = 1 if side == "above" else -1
    gap = float(10 ** rng.uniform(-7, 2)) * (-1 if rng.random() < 0.03 else 1)
    position = z - normal * radius * (1 + gap)
    changes["wall"] = {"position": position, "side": side}
    if rng.random() < 0.2:
        changes["wall"]["opposite"] = position + normal * radius * rng.uniform(15, 200)
    if rng.random() < 0.3:
        changes["forces"] = changes.get("forces", {}) | {"dlvo": {
            "strength": float(10 ** rng.uniform(-21, -16)),
            "debye_length": float(10 ** rng.uniform(-9.5, -6.5)),
            "hamaker_constant": float(rng.choice([0.0, 1.0]) * 10 ** rng.uniform(-22, -19)),
        }}  # fmt: skip
    if rng.random() < 0.8:  # what is not refused
        model = (None, "overdamped", "full")[rng.integers(3)]
        changes["simulation"]["model"] = model
        if changes["simulation"]["method"] in STOCHASTIC:
            followed = ("auto", "heun") if model == "full" else ("auto", "heun", "one-call")
            changes["simulation"]["method"] = followed[rng.integers(len(followed))]
            if model == "full" and "forces" in changes:
                changes["forces"]["brownian_torque"] = False
                changes["start"]["angular_velocity"] = [0.0, 0.0, 0.0]
        if "ball_radius" in changes["start"]:
            changes["start"]["ball_radius"] = 0.9 * abs(gap) * radius
    return changes


def depth(scene: Scene, z: Any) -> float:
    """How deep any of the places is in a wall, m, less rounding; 0 if none is."""
    radius, deepest = scene.bead.radius, 0.0
    for position, normal in scene.wall.planes if scene.wall else ():
        rounding = ROUNDING * (abs(position) + np.abs(z).max(initial=0.0))
        deepest = max(
            deepest, float((radius - normal * (z - position)).max(initial=0.0)) - rounding
        )
    return deepest


def outcome(changes: dict[str, dict[str, Any]]) -> str:
    """How a scene ends; raises for what must not happen."""
    try:
        scene: Scene = tweezer.load_scene("silica-1um").replace(**changes)
        scene, _ = chosen(scene)
        simulation = scene.simulation
        equations = bind(scene)
        events = [loss(simulation.loss_distance), closest_approach()]
        if (lens := lens_touched(scene)) is not None:
            events.append(lens)
        run = integrate(equations, np.linspace(0, simulation.duration, simulation.samples), events)
        motion = equations.motion(run.times, run.states)
    except TweezerError as error:
        return f"refused: {str(error).split(':')[0].split('=')[0].strip()}"
    parts = (run.times, motion.position, motion.velocity, motion.orientation,
             motion.angular_velocity)  # fmt: skip
    if not all(np.isfinite(part).all() for part in parts if part is not None):
        raise AssertionError("a result is not finite")
    soft = max(SOFT, SOFT_IN_TOLERANCES * scene.simulation.position_tolerance)
    if (deep := depth(scene, motion.position[:, 2])) > soft:
        raise AssertionError(f"the bead is {deep} m deep in a wall")
    if run.status == "failed":
        return f"failed: {run.message.partition(': ')[2] or run.message.split(' at ')[0]}"
    return run.status


def thermal_changes(rng: np.random.Generator) -> dict[str, dict[str, Any]]:
    """The same with thermal motion, and steps of any length."""
    changes = random_changes(rng)
    if rng.random() < 0.7:
        changes["bead"].pop("moments_of_inertia", None)
    changes["medium"]["temperature"] = float(rng.uniform(50, 5000))
    changes["forces"] = {"brownian": True, "brownian_torque": bool(rng.random() < 0.3)}
    drawn = ("no", "no", "equilibrium", "boltzmann", "ball")[rng.integers(5)]
    changes["start"] |= {"drawn": drawn}
    if drawn == "ball":
        changes["start"]["ball_radius"] = changes["bead"]["radius"] * rng.uniform(0.1, 3)
    changes["simulation"] |= {
        "method": STOCHASTIC[rng.integers(len(STOCHASTIC))],
        "step": float(10 ** rng.uniform(-9, -2)) if rng.random() < 0.5 else None,
    }
    return changes


def thermal_outcome(changes: dict[str, dict[str, Any]]) -> str:
    """How a scene with thermal motion ends; raises for what must not happen."""
    who = np.arange(BEADS)
    try:
        bound = walk(tweezer.load_scene("silica-1um").replace(**changes), 1)
        # as many samples as the calls allow
        calls = BEADS * bound.per_sample * max(bound.scheme.force_calls, 1)
        samples = min(len(bound.times) - 1, MOST_CALLS // calls)
        if samples == 0:
            return "not followed: too many steps from sample to sample"
        states = bound.start(who)
        out = np.empty((BEADS, samples, len(bound.columns)))
        bound.advance(states, who, 0, out)
    except IntegrationError:
        return "failed: a place is not finite"
    except TweezerError as error:
        return f"refused: {str(error).split(':')[0].split('=')[0].strip()}"
    lost = bound.times[1 : samples + 1] >= states[:, -1:] * (1 - 1e-9)
    if np.isfinite(out[lost]).any() or not np.isfinite(out[~lost]).all():
        raise AssertionError("a sample of a bead that is there is not finite")
    if (deep := depth(bound.scene, out[~lost][:, 2])) > 0:
        raise AssertionError(f"a bead is {deep} m deep in a wall")
    if "e0" in bound.columns:
        at = bound.columns.index("e0")
        if np.abs(np.linalg.norm(out[~lost][:, at : at + 4], axis=1) - 1).max(initial=0) > 1e-12:
            raise AssertionError("|e| is not 1")
    return "lost" if lost.any() else "complete"


def outcomes(count: int, seed: int, *, thermal: bool = False, walls: bool = False) -> Counter[str]:
    """How so many random scenes end."""
    rng = np.random.default_rng(seed)
    counted: Counter[str] = Counter()
    for number in range(count):
        changes = thermal_changes(rng) if thermal else random_changes(rng)
        if walls:
            changes = beside_a_wall(rng, changes)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                counted[thermal_outcome(changes) if thermal else outcome(changes)] += 1
            except Exception as error:
                raise AssertionError(f"scene {number} of seed {seed}: {changes}") from error
        if sys.stderr.isatty() and number % 100 == 0:
            print(f"\r{number} of {count}", end="", file=sys.stderr)
    return counted


if __name__ == "__main__":
    began = time.perf_counter()
    scenes = int(sys.argv[1])
    for many, thermal, walls in (
        (scenes, False, False), (scenes // 5, True, False),
        (scenes // 20, False, True), (scenes // 20, True, True),
    ):  # fmt: skip
        said = (" with thermal motion" if thermal else "") + (" beside a wall" if walls else "")
        print(f"{many} scenes{said}")
        found = outcomes(many, 20_250, thermal=thermal, walls=walls)
        for ended, times in found.most_common():
            print(f"{times:8d}  {ended}")
    print(f"{time.perf_counter() - began:8.0f}  s")
