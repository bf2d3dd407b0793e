"""Makes the recordings of `tweezer examples` again: `python -m tests.examples`.

They are simulated, so that the right answers are known: see `TRUTH`. Recordings of real beads that
may be redistributed were not found.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import tweezer

FOLDER = Path(tweezer.__file__).parent / "examples"
#: what the recordings were made with, SI
TRUTH = {"trapped-bead.csv": {"power": 20e-3}, "free-beads.csv": {"diffusion": 0.43e-12}}
#: number of free beads, frames of each, time between frames, s, and localisation error, m
BEADS, FRAMES, STEP, NOISE = 12, 60, 0.05, 20e-9


def trapped_bead() -> str:
    """Return the text of a record of a 1 um silica bead in a trap, 4 kHz for 2.5 s."""
    scene = tweezer.load_scene("silica-1um").replace(
        beam={"power_through_pupil": TRUTH["trapped-bead.csv"]["power"]},
        forces={"brownian": True},
        optics={"evaluator": "map"},
        simulation={"duration": 2.55, "samples": 10201},
    )
    run = tweezer.simulate(scene, seed=4).isel(time=slice(201, None))
    lines = ["t [s],x [um],y [um]"]
    for number, (x, y, _) in enumerate(1e6 * run.position.values):
        lines.append(f"{number / 4000:.5f},{x:.4f},{y:.4f}")
    return "\n".join(lines) + "\n"


def free_beads() -> str:
    """Return the text of a table of free beads as a tracking program writes it."""
    rng = np.random.default_rng(12)
    spread = np.sqrt(2 * TRUTH["free-beads.csv"]["diffusion"] * STEP)
    lines = ["particle,frame,x [um],y [um]"]
    for bead in range(BEADS):
        path = rng.uniform(5e-6, 50e-6, 2) + np.cumsum(spread * rng.normal(size=(FRAMES, 2)), 0)
        for frame, (x, y) in enumerate(1e6 * (path + NOISE * rng.normal(size=path.shape))):
            lines.append(f"{bead},{frame},{x:.4f},{y:.4f}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for name, made in (("trapped-bead.csv", trapped_bead()), ("free-beads.csv", free_beads())):
        (FOLDER / name).write_text(made, encoding="utf-8")
        print(f"wrote {FOLDER / name}, {len(made)} bytes")
