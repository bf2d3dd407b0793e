"""Beads in gas at low damping: what `characterise` says, linear algebra, and runs.

`python -m tests.low_damping` compares 40 scenes and writes `tests/data/low_damping.csv`. The
tests take a few of them.
"""

from __future__ import annotations

import csv
import math
import sys
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

import tweezer

OUTCOME = Path(__file__).parent / "data" / "low_damping.csv"
#: Distance from the equilibrium at which the bead is released, m
OFF = 10e-9
#: Step of the differences of the force, m
STEP = 2e-9
#: Length of a run, in times in which the slowest root grows or decays by e
LIVES = 3.0

#: Light and bead of which the axis pulls the bead back
KINDS = {
    "linear": ({"polarisation": "linear"}, 0.5e-6, 1.5715),
    "circular": ({"polarisation": "circular"}, 0.5e-6, 1.5715),
    "vortex": ({"polarisation": "circular", "vortex": 1}, 1.2e-6, 1.2),
}


class Compared(NamedTuple):
    """A scene, and whether the bead comes to rest, three ways."""

    light: str
    viscosity: float
    growth: float
    """largest real part of an eigenvalue of the 6 x 6 matrix, 1/s"""
    stable: bool
    """of the equilibrium, as `characterise` has it"""
    run: float
    """distance at the end of a run over that at its beginning"""

    @property
    def agrees(self) -> bool:
        return self.stable == (self.growth < 0) == (self.run < 1)


def scene(light: str, viscosity: float) -> tweezer.Scene:
    """Return a bead in gas without memory, in light of a kind."""
    beam, diameter, index = KINDS[light]
    return tweezer.load_scene("silica-1um").replace(
        bead={"diameter": diameter, "refractive_index": index, "density": 1050.0},
        lens={"numerical_aperture": 0.9},
        beam=beam,
        medium={
            "refractive_index": 1.0003, "density": 1.2e-3, "viscosity": viscosity,
            "mean_free_path": "1e-6 nm", "inertia": "none",
        },
    )  # fmt: skip


def gradient_at(of: tweezer.Scene, place: np.ndarray) -> np.ndarray:
    """Gradient of the optical force, (3, 3) N/m, from its differences."""
    steps = STEP * np.eye(3)
    stencil = np.array([-2, -1, 1, 2])
    weights = np.array([1, -8, 8, -1]) / 12
    gradient = np.empty((3, 3))
    for j in range(3):
        force = tweezer.optical_force(of, place + stencil[:, None] * steps[j])
        gradient[:, j] = weights @ force / STEP
    return gradient


def growth_of(of: tweezer.Scene, place: np.ndarray) -> float:
    """Largest real part of an eigenvalue of the linear motion, from differences of the force."""
    gradient = gradient_at(of, place)
    radius, density = of.bead.radius, 1050.0
    mass = 4 / 3 * math.pi * radius**3 * density
    drag = 6 * math.pi * of.medium.viscosity * radius
    swing = math.sqrt(np.abs(gradient).max() / mass)  # the unit of rates
    matrix = np.block(
        [
            [np.zeros((3, 3)), np.eye(3)],
            [gradient / mass / swing**2, -drag / mass / swing * np.eye(3)],
        ]
    )
    return float(np.linalg.eigvals(matrix).real.max() * swing)


def compared(light: str, viscosity: float) -> Compared:
    """Return a scene, three ways."""
    of = scene(light, viscosity)
    trap = tweezer.characterise(of)
    pulled = [each for each in trap.equilibria if each.eigenvalues[0] > 0]
    place = min(pulled, key=lambda each: np.linalg.norm(each.position))
    growth = growth_of(of, place.position)
    duration = LIVES / abs(growth)
    released = place.position + OFF * np.array([1.0, 1.0, 1.0]) / math.sqrt(3)
    run = tweezer.simulate(of.replace(
        start={"position": released.tolist()},
        simulation={"duration": duration, "samples": 2001, "model": "full"},
    ))  # fmt: skip
    away = np.linalg.norm(run["position"].values - place.position, axis=1)
    tenth = max(1, len(away) // 10)
    ratio = float(away[-tenth:].max() / away[:tenth].max())
    return Compared(light, viscosity, growth, place.stable, ratio)


def cases(count: int) -> list[tuple[str, float]]:
    """Kinds of light in turn, at viscosities from 1e-8 to 1e-3 Pa s."""
    kinds = [list(KINDS)[i % len(KINDS)] for i in range(count)]
    return list(zip(kinds, np.geomspace(1e-8, 1e-3, count).round(12).tolist(), strict=True))


def main() -> None:
    warnings.simplefilter("ignore")
    rows = [compared(*each) for each in cases(40)]
    with OUTCOME.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*Compared._fields, "agrees"])
        for each in rows:
            numbers = f"{each.viscosity:.4g}", f"{each.growth:.6g}"
            writer.writerow([each.light, *numbers, each.stable, f"{each.run:.4g}", each.agrees])
    disagree = sum(not each.agrees for each in rows)
    print(f"{len(rows)} scenes, {disagree} disagreements; wrote {OUTCOME}")
    sys.exit(min(disagree, 1))


if __name__ == "__main__":
    main()
