"""The captures once more in a fluid with inertia: the thesis's next step (chapter 6).

Stokes's law is for steady flow. The thesis names the equation of Maxey and Riley (Phys. Fluids 26,
883 (1983)) for the flow of a bead that accelerates; for a fluid at rest its forces are the added
mass and the memory of Boussinesq and Basset, which `medium.inertia = "memory"` has.
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

#: Readings of the scaled model: what has the inertia that a2 divides, and what else has inertia
READINGS = ("the bead alone", "the bead, fluid as it is", "bead and fluid")


@dataclass(frozen=True)
class Scaled:
    """A bead with the printed a2, by one of `READINGS`."""

    reading: str
    outcome: str
    """outcome of `tweezer.summarise`"""
    overshoot: float
    """overshoot of q2 across the axis, m"""
    time: np.ndarray
    """s, (n,)"""
    q2: np.ndarray
    """m, (n,)"""


@dataclass(frozen=True)
class Remembered:
    """A bead in a fluid without inertia, and in one with it; without noise."""

    bead: str
    """one of `BEADS`"""
    theory: str
    """one of `THEORIES`"""
    off: float
    """largest distance of the unscaled motions, m"""
    within: tuple[float, float]
    """s, when the unscaled bead is within a radius of the focus: without, and with"""
    overshoot: tuple[float, float]
    """of q2 across the axis, m, of the unscaled bead: without, and with"""
    scaled: tuple[Scaled, ...]
    """by reading"""


def remembered(of_each_theory: Iterable[Mapping[str, Motions]]) -> list[Remembered]:
    """Every bead with and without the fluid's inertia, from the motions of each theory."""
    by_theory = list(of_each_theory)
    return [_remembered(by_bead[bead]) for bead in BEADS for by_bead in by_theory]


def _remembered(motions: Motions) -> Remembered:
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
    """First time at that distance from the focus, between samples in proportion, s."""
    t, away = run["time"].values, run["distance"].values
    there = int(np.argmax(away < distance))
    return float(np.interp(-distance, -away[there - 1 : there + 1], t[there - 1 : there + 1]))


def _scaled(motions: Motions, reading: str) -> Scaled:
    printed = in_the_light(load_scene(f"thesis-{motions.bead}"), motions.theory).replace(
        simulation={"method": "auto"}
    )
    unit = 1.0
    match reading:
        case "the bead alone":
            scene = printed
        case "the bead, fluid as it is":
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
    """A scene without scaling that moves as if all densities were over a2, and its unit of time.

    With the time in units of sqrt(a2), (m/a2) x'' + beta x' = F is m x'' + sqrt(a2) beta x' = F,
    and so with the memory of the fluid: all densities over a2 are as a viscosity times sqrt(a2).
    """
    unit = math.sqrt(printed.simulation.scaling_factor or 1.0)
    return printed.replace(
        medium={"viscosity": printed.medium.viscosity * unit, "inertia": "memory"},
        simulation={
            "model": "full", "scaling_factor": None,
            "duration": printed.simulation.duration * unit,
        },
    ), unit  # fmt: skip
