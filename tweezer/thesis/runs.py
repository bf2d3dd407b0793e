"""Motions for the thesis's figures: each bead by the thesis's scaled model, and unscaled.

Each is computed with ray optics, as in the thesis, and with wave optics.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import xarray as xr

from tweezer.results.io import scene_of
from tweezer.runs import Summary, summarise
from tweezer.runs.simulation import simulate
from tweezer.scene import Scene, load_scene
from tweezer.scene.bead import BeadProperties, bead_properties

#: Beads in the thesis's order, with its names
BEADS = ("500nm", "990nm", "1950nm")

#: Settings for the integral over the lens instead of 7644 rays, tabulated up to the loss distance
INTEGRAL = {"evaluator": "map", "table_range": 20.0}

#: Theories of light of the motions
THEORIES = ("rays", "waves")

#: Settings for wave optics, tabulated up to the loss distance
_WAVES = {"theory": "waves", "evaluator": "map", "table_range": "5 um"}

#: Settings for light averaged over both polarisations, without the torque (3.25)
_UNPOLARISED = {"polarisation": "unpolarised", "torque": "none"}

#: Relative tolerance of the unscaled motion; at the thesis's 1e-7 a bead at rest would jitter
_TOLERANCE = 1e-10

#: Number of sampling intervals of a motion without noise in an interval of its scene
_SAMPLES_BETWEEN = 20

_NOISE = {"brownian": True, "brownian_torque": True}


@dataclass(frozen=True)
class Motions:
    """Five runs of one bead of the thesis, released as in Table 5.1."""

    bead: str
    """one of `BEADS`"""
    theory: str
    """one of `THEORIES`"""
    thesis: xr.Dataset
    """run of the scaled model (4.17) with the printed a2, by Dormand-Prince, without noise; the
    light consists of 7644 rays with their torque (3.25), or of waves"""
    thesis_thermal: xr.Dataset
    """the scaled model with thermal force and torque, in steps with exact drag and noise"""
    unscaled: xr.Dataset
    """run of the full model (A.25) without noise, with the integral over the lens and no torque of
    the light"""
    unscaled_thermal: xr.Dataset
    """the full model with thermal force and torque"""
    remembering: xr.Dataset
    """the full model in a fluid with inertia, without noise"""

    @functools.cached_property
    def scene(self) -> Scene:
        """Scene of the thesis's model."""
        return scene_of(self.thesis)

    @property
    def properties(self) -> BeadProperties:
        """Mass, drag and weight of the bead."""
        return bead_properties(self.scene)

    @property
    def scaling_factor(self) -> float:
        """Scaling factor a2 that the thesis prints for this bead."""
        return self.scene.simulation.scaling_factor or 1.0

    @property
    def shift_by_memory(self) -> float:
        """Largest distance between the unscaled motions with and without fluid inertia, m."""
        return largest_distance(self.unscaled, self.remembering)

    def summary(self, which: str) -> Summary:
        """Return the summary of the run `which`, the name of a field such as "unscaled"."""
        return summarise(getattr(self, which))


def in_the_light(scene: Scene, theory: str) -> Scene:
    """Return a scene of the thesis with light without approximations, by `theory` (`THEORIES`).

    Ray optics uses the integral over the lens instead of 7644 rays. Wave optics has the same lens,
    profile and power. It is unpolarised, because the thesis averages the reflectances (3.17), which
    has no equivalent in wave optics.
    """
    if theory == "rays":
        return scene.replace(optics=INTEGRAL)
    return scene.replace(beam=_UNPOLARISED, optics=_WAVES)


def thesis_scene(bead: str, theory: str = "rays") -> Scene:
    """Return the scene of a bead of `BEADS` in the thesis's model, with its a2 and its light.

    With the theory "rays" the light consists of 7644 rays with the torque (3.25). With the other
    theory of `THEORIES` the force is computed by wave optics at each position, without a map.
    """
    scene = load_scene(f"thesis-{bead}")
    if theory == "rays":
        return scene.replace(beam={"torque": "thesis"})
    return in_the_light(scene, theory).replace(optics={"evaluator": "quadrature"})


def unscaled_scene(bead: str, theory: str = "rays") -> Scene:
    """Return the scene of a bead of `BEADS` without the thesis's approximations.

    These are the scaling, the grid of rays, and the torque (3.25), which light does not exert on a
    lossless sphere. `theory` is one of `THEORIES`.
    """
    return in_the_light(load_scene(f"thesis-{bead}"), theory).replace(
        simulation={"model": "full", "method": "auto", "scaling_factor": None},
    )


def motions(bead: str, seed: int = 1, theory: str = "rays") -> Motions:
    """Compute the five motions of a bead of `BEADS`.

    `seed` determines the thermal motion, and `theory` is one of `THEORIES`.
    """
    thesis, unscaled = thesis_scene(bead, theory), unscaled_scene(bead, theory)
    noisy = thesis.replace(forces=_NOISE, simulation={"method": "auto"})
    densely = _densely_sampled(unscaled)
    return Motions(
        bead=bead,
        theory=theory,
        thesis=simulate(_densely_sampled(thesis)),
        thesis_thermal=simulate(noisy, seed=seed),
        unscaled=simulate(densely, tolerance=_TOLERANCE),
        unscaled_thermal=simulate(unscaled.replace(forces=_NOISE), seed=seed),
        remembering=simulate(densely.replace(medium={"inertia": "memory"}), tolerance=_TOLERANCE),
    )


def _densely_sampled(scene: Scene) -> Scene:
    """Return a scene with 20 times as many samples.

    They resolve the peak of the force, which the bead passes within microseconds.
    """
    samples = _SAMPLES_BETWEEN * (scene.simulation.samples - 1) + 1
    return scene.replace(simulation={"samples": samples})


def largest_distance(first: xr.Dataset, second: xr.Dataset) -> float:
    """Return the largest distance between the beads of two runs at common samples, m."""
    n = min(first.sizes["time"], second.sizes["time"])
    apart = first["position"].values[:n] - second["position"].values[:n]
    return float(np.linalg.norm(apart, axis=1).max())


def closest_approach(run: xr.Dataset) -> int | None:
    """Return the index of the sample nearest to the first closest approach (FCA); None without one.

    The FCA is the first local minimum of the distance to the focus (5.2).
    """
    time = summarise(run).closest_approach_time
    return None if time is None else int(np.abs(run["time"].values - time).argmin())


def crossings(run: xr.Dataset, least: float = 1e-9) -> int:
    """Return how often q2 crosses the axis after the first closest approach.

    A crossing counts if q2 is more than `least`, m, from the axis on both sides.
    """
    approach = closest_approach(run)
    if approach is None:
        return 0
    side = run["position"].sel(axis="y").values[approach:]
    return int((np.diff(np.sign(side[np.abs(side) > least])) != 0).sum())
