"""The motions in the thesis's figures: each bead by the thesis's model, and unscaled.

Both in the light of rays, as in the thesis, and in the same light as waves.
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

#: Beads in the thesis's order and names
BEADS = ("500nm", "990nm", "1950nm")

#: The integral over the lens in place of 7644 rays, as a table up to the loss distance
INTEGRAL = {"evaluator": "map", "table_range": 20.0}

#: The theories of light of the motions
THEORIES = ("rays", "waves")

#: Light as waves in place of rays, as a table up to the loss distance
_WAVES = {"theory": "waves", "evaluator": "map", "table_range": "5 um"}

#: The light that is averaged over both polarisations, and exerts no moment (3.25)
_UNPOLARISED = {"polarisation": "unpolarised", "torque": "none"}

#: Relative tolerance of the unscaled motion; at 1e-7, the thesis's, a bead at rest jitters
_TOLERANCE = 1e-10

#: Factor between the samples of a motion without noise and those of its scene
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
    """scaled model (4.17), printed a2, Dormand-Prince; no noise; of rays 7644 and their moment
    (3.25)"""
    thesis_thermal: xr.Dataset
    """the same with thermal force and torque, by steps with exact drag and noise"""
    unscaled: xr.Dataset
    """full model (A.25), the integral over the lens, no moment of the light; no noise"""
    unscaled_thermal: xr.Dataset
    """the same with thermal force and torque"""
    remembering: xr.Dataset
    """the unscaled bead in a fluid with inertia; no noise"""

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
        """The printed a2."""
        return self.scene.simulation.scaling_factor or 1.0

    @property
    def shift_by_memory(self) -> float:
        """Largest distance of the unscaled motions with and without the fluid's inertia, m."""
        return largest_distance(self.unscaled, self.remembering)

    def summary(self, which: str) -> Summary:
        """Summary of the motion of that name."""
        return summarise(getattr(self, which))


def in_the_light(scene: Scene, theory: str) -> Scene:
    """A scene of the thesis with the integral over its lens in place of 7644 rays, or with waves.

    Waves of the same lens, profile and power: unpolarised, where the thesis averages the
    reflectances (3.17), which waves do not have.
    """
    if theory == "rays":
        return scene.replace(optics=INTEGRAL)
    return scene.replace(beam=_UNPOLARISED, optics=_WAVES)


def thesis_scene(bead: str, theory: str = "rays") -> Scene:
    """The scene of a bead of `BEADS` as in the thesis's model: its a2, its rays and their moment;
    or waves, place by place.
    """
    scene = load_scene(f"thesis-{bead}")
    if theory == "rays":
        return scene.replace(beam={"torque": "thesis"})
    return in_the_light(scene, theory).replace(optics={"evaluator": "quadrature"})


def unscaled_scene(bead: str, theory: str = "rays") -> Scene:
    """The same light and bead without the thesis's approximations: the scaling, the grid of rays,
    and the moment (3.25), which light does not exert on a lossless sphere.
    """
    return in_the_light(load_scene(f"thesis-{bead}"), theory).replace(
        simulation={"model": "full", "method": "auto", "scaling_factor": None},
    )


def motions(bead: str, seed: int = 1, theory: str = "rays") -> Motions:
    """The five motions of a bead of `BEADS`; seed: of the thermal ones; theory: of `THEORIES`."""
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
    """The scene with samples that resolve the peak of the force, passed within microseconds."""
    samples = _SAMPLES_BETWEEN * (scene.simulation.samples - 1) + 1
    return scene.replace(simulation={"samples": samples})


def largest_distance(first: xr.Dataset, second: xr.Dataset) -> float:
    """Largest distance of the beads of two runs at the samples that both have, m."""
    n = min(first.sizes["time"], second.sizes["time"])
    apart = first["position"].values[:n] - second["position"].values[:n]
    return float(np.linalg.norm(apart, axis=1).max())


def closest_approach(run: xr.Dataset) -> int | None:
    """Sample nearest to the first closest approach (FCA), the first local minimum of the distance
    to the focus (5.2); None if there is none.
    """
    time = summarise(run).closest_approach_time
    return None if time is None else int(np.abs(run["time"].values - time).argmin())


def crossings(run: xr.Dataset, least: float = 1e-9) -> int:
    """Number of crossings by q2, of more than `least` m, after the first closest approach."""
    approach = closest_approach(run)
    if approach is None:
        return 0
    side = run["position"].sel(axis="y").values[approach:]
    return int((np.diff(np.sign(side[np.abs(side) > least])) != 0).sum())
