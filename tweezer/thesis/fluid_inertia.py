"""The captures in a fluid with inertia, which the thesis proposes as the next step (chapter 6).

Stokes's law applies to steady flow. For the flow around an accelerating bead, the thesis cites the
equation of Maxey and Riley (Phys. Fluids 26, 883 (1983)). For a fluid at rest its forces are the
added mass and the memory of Boussinesq and Basset, which `medium.inertia = "memory"` includes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from tweezer.runs import summarise
from tweezer.runs.simulation import simulate
from tweezer.scene import Scene, load_scene
from tweezer.thesis.runs import BEADS, Motions, in_the_light

#: Readings of the scaled model: which inertia a2 divides, and which inertia is unscaled
READINGS = ("bead scaled, no fluid inertia", "bead scaled, fluid not", "bead and fluid scaled")


@dataclass(frozen=True)
class Scaled:
    """Motion of a bead with the printed a2, for one reading of the term that a2 divides."""

    reading: str
    """one of `READINGS`"""
    outcome: str
    """outcome of `tweezer.summarise`"""
    overshoot: float
    """overshoot of q2 across the axis, m"""
    time: np.ndarray
    """(n,) times of the samples, s"""
    q2: np.ndarray
    """(n,) coordinate y, across the light, m"""


@dataclass(frozen=True)
class Remembered:
    """Motion of a bead in a fluid without inertia, compared with the motion in a fluid with it."""

    bead: str
    """one of `BEADS`"""
    theory: str
    """one of `THEORIES`"""
    off: float
    """largest distance between the unscaled beads without and with fluid inertia, m"""
    within: tuple[float, float]
    """times at which the unscaled bead comes within a radius of the focus, s: without fluid
    inertia, and with it"""
    overshoot: tuple[float, float]
    """overshoot of q2 of the unscaled bead across the axis, m: without fluid inertia, and with"""
    scaled: tuple[Scaled, ...]
    """motions with the printed a2, one for each of `READINGS`"""


def remembered(of_each_theory: Iterable[Mapping[str, Motions]]) -> list[Remembered]:
    """Return the comparison for every bead and theory, from the motions by bead (`BEADS`)."""
    by_theory = list(of_each_theory)
    return [_remembered(by_bead[bead]) for bead in BEADS for by_bead in by_theory]


def _remembered(motions: Motions) -> Remembered:
    """Return the comparison for one bead from its motions, adding runs with the printed a2."""
    without, with_memory = motions.unscaled, motions.remembering
    radius = motions.scene.bead.radius
    return Remembered(
        bead=motions.bead,
        theory=motions.theory,
        off=motions.shift_by_memory,
        within=(_within(without, radius), _within(with_memory, radius)),
        overshoot=(motions.summary("unscaled").overshoot, motions.summary("remembering").overshoot),
        scaled=tuple(_scaled(motions, reading) for reading in READINGS),
    )


def _within(run: xr.Dataset, distance: float) -> float:
    """Return the first time at which the bead is within `distance`, m, of the focus, s.

    It is interpolated linearly between samples.
    """
    t, away = run["time"].values, run["distance"].values
    there = int(np.argmax(away < distance))
    return float(np.interp(-distance, -away[there - 1 : there + 1], t[there - 1 : there + 1]))


def _scaled(motions: Motions, reading: str) -> Scaled:
    """Simulate a bead with the printed a2 for one of `READINGS`, without noise.

    A run of `_all_inertia_scaled` takes `unit` seconds for each second of the scaled motion.
    """
    printed = in_the_light(load_scene(f"thesis-{motions.bead}"), motions.theory).replace(
        simulation={"method": "auto"}
    )
    unit = 1.0
    match reading:
        case "bead scaled, no fluid inertia":
            scene = printed
        case "bead scaled, fluid not":
            scene = printed.replace(medium={"inertia": "memory"})
        case _:
            scene, unit = _all_inertia_scaled(printed)
    run = simulate(scene)
    summary = summarise(run)
    return Scaled(
        reading=reading,
        outcome=summary.outcome,
        overshoot=summary.overshoot,
        time=run["time"].values / unit,
        q2=run["position"].sel(axis="y").values,
    )


def _all_inertia_scaled(printed: Scene) -> tuple[Scene, float]:
    """Return a scene that moves as if all densities were divided by a2, and its time factor u.

    With the time t' = u t, u = sqrt(a2), the equation (m/a2) x'' + beta x' = F becomes m x'' + u
    beta x' = F, where m is the mass, beta the drag and F the force. The memory of the fluid scales
    in the same way. The scene is therefore unscaled, has u times the viscosity, and takes u times
    as long.
    """
    unit = math.sqrt(printed.simulation.scaling_factor or 1.0)
    return printed.replace(
        medium={"viscosity": printed.medium.viscosity * unit, "inertia": "memory"},
        simulation={
            "model": "full", "scaling_factor": None,
            "duration": printed.simulation.duration * unit,
        },
    ), unit  # fmt: skip
