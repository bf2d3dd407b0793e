"""The three captures by the unscaled equations, with ray optics and with wave optics."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from tweezer.dynamics import bound_once
from tweezer.thesis.runs import BEADS, Motions, unscaled_scene
from tweezer.values.errors import TweezerError

#: Distance from the rest position within which a bead has arrived, m
ARRIVED = 20e-9


@dataclass(frozen=True)
class Capture:
    """Capture of one unscaled bead: time of arrival, rest position and trap stiffness there."""

    bead: str
    """one of `BEADS`"""
    theory: str
    """one of `THEORIES`"""
    arrival: float
    """time after which it stays within `ARRIVED` of its rest position, s; infinite if it never
    does"""
    overshoot: float
    """overshoot of q2 across the axis, m"""
    rest: float
    """rest position along the light, relative to the focus, m"""
    stiffness_across: float
    """trap stiffness along x at the rest position, N/m"""
    stiffness_along: float
    """trap stiffness along z, the light, at the rest position, N/m"""


def captures(of_each_theory: Iterable[Mapping[str, Motions]]) -> list[Capture]:
    """Return the captures of each bead by each theory, from its motions by bead (`BEADS`).

    Raises `TweezerError` if a bead has no stable equilibrium.
    """
    by_theory = list(of_each_theory)
    return [_capture(by_bead[bead]) for bead in BEADS for by_bead in by_theory]


def _capture(motions: Motions) -> Capture:
    """Return the capture of the unscaled bead of `motions`, from its equilibrium and its run."""
    equilibrium = bound_once(unscaled_scene(motions.bead, motions.theory)).equilibrium
    if equilibrium is None:
        raise TweezerError(f"thesis-{motions.bead}: no stable equilibrium by {motions.theory}")
    run = motions.unscaled
    away = np.linalg.norm(run["position"].values - equilibrium.position, axis=1) > ARRIVED
    times = np.append(run["time"].values, np.inf)
    return Capture(
        bead=motions.bead,
        theory=motions.theory,
        arrival=float(times[np.flatnonzero(away)[-1] + 1]) if away.any() else 0.0,
        overshoot=motions.summary("unscaled").overshoot,
        rest=equilibrium.position[2],
        stiffness_across=equilibrium.stiffness[0][0],
        stiffness_along=equilibrium.stiffness[2][2],
    )
