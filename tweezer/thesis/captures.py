"""The three captures without the scaling, in the light of rays and in the same light as waves."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from tweezer.dynamics import bound_once
from tweezer.thesis.runs import BEADS, Motions, unscaled_scene
from tweezer.values.errors import TweezerError

#: Distance from the place of rest at which a bead has arrived, m
ARRIVED = 20e-9


@dataclass(frozen=True)
class Capture:
    """How the unscaled bead comes to rest."""

    bead: str
    """one of `BEADS`"""
    theory: str
    """one of `THEORIES`"""
    arrival: float
    """time from which on it is within `ARRIVED` of the place of rest, s; infinite if it never is"""
    overshoot: float
    """overshoot of q2 across the axis, m"""
    rest: float
    """place of rest along the light, m from the focus"""
    stiffness_across: float
    """N/m"""
    stiffness_along: float
    """N/m"""


def captures(of_each_theory: Iterable[Mapping[str, Motions]]) -> list[Capture]:
    """The captures of each bead, from the motions of each theory. Keys: `BEADS`.

    Raises `TweezerError` if a bead has no stable equilibrium.
    """
    by_theory = list(of_each_theory)
    return [_capture(by_bead[bead]) for bead in BEADS for by_bead in by_theory]


def _capture(motions: Motions) -> Capture:
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
