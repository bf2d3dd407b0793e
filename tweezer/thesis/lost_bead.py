"""Parameter study of why the thesis's 500 nm bead is lost, and what would trap it."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binomtest

from tweezer.ensembles import ensemble
from tweezer.runs import summarise
from tweezer.runs.simulation import simulate
from tweezer.scene import Scene, load_scene
from tweezer.thesis.runs import INTEGRAL, crossings
from tweezer.values.errors import PhysicsWarning
from tweezer.values.prefixes import per

_BEAD = "thesis-500nm"
_FACTORS = (1e-5, 2e-5, 3e-5, 4e-5, 5e-5, 1e-4, 3e-4, 1e-3, 1e-2)
_POWERS = (30, 60, 80, 100, 120, 156, 200, 300)
_THERMAL_TRAJECTORIES = 200
#: Approximate work of the ensemble with thermal motion, in units of a run without noise
_THERMAL_WORK = 40


@dataclass(frozen=True)
class Variant:
    """Outcome for the thesis's 500 nm bead with one parameter changed."""

    group: str
    """kind of the change: a2, force, lens, polarisation, power, start"""
    name: str
    """the change in words"""
    outcome: str
    """outcome of `tweezer.summarise`"""
    outcome_time: float
    """time of the outcome, s"""
    overshoot: float
    """overshoot of q2 across the axis, m"""
    crossings: int
    """number of crossings of the axis by q2, by more than 1 nm, after the first closest approach"""
    time: np.ndarray
    """(n,) times of the samples, s"""
    q2: np.ndarray
    """(n,) coordinate y, across the light, m"""

    @property
    def as_claimed(self) -> bool:
        """Whether the bead is trapped and oscillates, as in Figure 5.1."""
        return self.outcome == "captured" and self.crossings >= 2


@dataclass(frozen=True)
class Study:
    """Parameter study of the thesis's 500 nm bead in the scaled model."""

    variants: list[Variant]
    """motions; the first one has all parameters as printed"""
    factors: tuple[float, ...]
    """values of a2 in the columns of `captured`"""
    powers: tuple[float, ...]
    """powers in the rows of `captured`, before the pupil, mW"""
    captured: np.ndarray
    """(powers, factors) whether the bead is captured"""
    overshoot: np.ndarray
    """(powers, factors) overshoot of q2 across the axis, m"""
    kept: int
    """number of trajectories with thermal motion and otherwise printed parameters that end within a
    radius of the focus"""
    released: int
    """total number of these trajectories"""

    @property
    def kept_interval(self) -> tuple[float, float]:
        """95 % confidence interval (Wilson) of the probability to stay trapped."""
        interval = binomtest(self.kept, self.released).proportion_ci(method="wilson")
        return float(interval.low), float(interval.high)


def study(did: Callable[[float], None] = lambda _: None) -> Study:
    """Run the bead with single changes, then for each a2 and power, then with thermal motion.

    `did` is called with each completed fraction of the work; the fractions add up to 1.
    """
    printed = load_scene(_BEAD)
    changes = _changes(printed)
    total = len(changes) + len(_POWERS) * len(_FACTORS) + _THERMAL_WORK

    with warnings.catch_warnings(action="ignore", category=PhysicsWarning):
        variants = []
        for group, name, scene in changes:
            variants.append(_variant(group, name, scene))
            did(1 / total)
        captured = np.zeros((len(_POWERS), len(_FACTORS)), bool)
        overshoot = np.zeros(captured.shape)
        for i, power in enumerate(_POWERS):
            for j, factor in enumerate(_FACTORS):
                scene = printed.replace(
                    beam={"power": f"{power} mW"},
                    simulation={"scaling_factor": factor, "samples": 2001},
                    optics=INTEGRAL,
                )
                summary = summarise(simulate(scene))
                captured[i, j] = summary.outcome == "captured"
                overshoot[i, j] = summary.overshoot
                did(1 / total)
        kept = _thermally_kept(printed)
        did(_THERMAL_WORK / total)
    return Study(
        variants=variants,
        factors=_FACTORS,
        powers=_POWERS,
        captured=captured,
        overshoot=overshoot,
        kept=int(kept.sum()),
        released=kept.size,
    )


def _changes(printed: Scene) -> list[tuple[str, str, Scene]]:
    """Return the scenes of the single changes with groups and names; the first is unchanged."""
    table: list[tuple[str, str, dict[str, Any]]] = [
        ("printed", "all as printed", {}),
        ("force", "integral in place of 7644 rays", {}),
        ("polarisation", "Q averaged, not R (circular)", {"beam": {"polarisation": "circular"}}),
        ("lens", "sine condition, NA 1.3", {"lens": {"map": "sine"}}),
        ("lens", "sine condition, circular",
         {"lens": {"map": "sine"}, "beam": {"polarisation": "circular"}}),
        ("power", "156 mW through the pupil", {"beam": {"power_through_pupil": "156 mW"}}),
        ("power", "sigma is a 1/e² waist", {"beam": {"waist": "2.5 mm"}}),
        ("power", "120 mW", {"beam": {"power": "120 mW"}}),
        ("power", "100 mW", {"beam": {"power": "100 mW"}}),
        ("power", "50 mW", {"beam": {"power": "50 mW"}}),
    ]  # fmt: skip
    table += [
        ("a2", f"a2 = {factor:g}", {"simulation": {"scaling_factor": factor}})
        for factor in (1e-5, 4e-5, 5e-5, 1e-4, 3e-4, 1e-3)
    ]
    start = [float(q) * per("um") for q in printed.start_position]
    table += [
        ("start", f"N3 {shift:+g} µm",
         {"start": {"frame": "focus", "position": [f"{q} um" for q in (*start[:2],
                                                                       start[2] + shift)]}})
        for shift in (-1, -0.5, -0.2, 0.2, 0.5, 1)
    ]  # fmt: skip
    scenes = [
        (group, name, printed.replace(**change, optics=INTEGRAL)) for group, name, change in table
    ]
    scenes[0] = ("printed", "all as printed", printed)
    return scenes


def _variant(group: str, name: str, scene: Scene) -> Variant:
    """Run the scene of a change, and return the outcome for its bead."""
    run = simulate(scene)
    summary = summarise(run)
    return Variant(
        group=group,
        name=name,
        outcome=summary.outcome,
        outcome_time=summary.outcome_time,
        overshoot=summary.overshoot,
        crossings=crossings(run),
        time=run["time"].values,
        q2=run["position"].sel(axis="y").values,
    )


def _thermally_kept(printed: Scene) -> np.ndarray:
    """Return whether each trajectory with thermal motion ends within a radius of the focus.

    The result is an array of booleans, (trajectories,). A bead that has left the trap drifts for
    most of the run before it counts as lost, so the loss is not a suitable criterion.
    """
    scene = printed.replace(
        forces={"brownian": True},
        simulation={"method": "auto", "samples": 101},
        optics=INTEGRAL,
    )
    result = ensemble(scene, _THERMAL_TRAJECTORIES, seed=1)
    end = result["position"].isel(time=-1).values  # NaN, so not close, for a lost bead
    kept: np.ndarray = np.linalg.norm(end, axis=1) < scene.bead.radius
    return kept
