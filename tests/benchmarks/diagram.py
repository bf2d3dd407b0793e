"""What is trapped: polystyrene and silica over size and power, and the least power for an hour.

Beads in water of 20 degC in a Gaussian beam of 1064 nm that fills the pupil of an NA 1.25
objective, circular light, by waves. The lifetimes are held to ensembles where these are short.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from os import cpu_count
from typing import Any

import numpy as np

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine
from tweezer.scene import Scene

Results = dict[str, Any]

MATERIALS = {
    "polystyrene": {"refractive_index": 1.5715, "density": 1050.0},
    "silica": {"refractive_index": 1.45, "density": 2000.0},
}
#: m and W
DIAMETERS = np.geomspace(0.2e-6, 3e-6, 40)
POWERS = np.geomspace(1e-3, 1.0, 60)
#: s
TIMES = {"1 h": 3600.0, "1 year": 365.25 * 86400}

#: traps that last some seconds: diameter, power and distance of loss, and changes of the beam
SHORT = (
    ("polystyrene", 0.3e-6, 0.9e-3, 3e-6, {}),
    ("polystyrene", 0.3e-6, 0.9e-3, 3e-6, {"polarisation": "linear", "jones": ["1", "0"]}),
    ("polystyrene", 0.5e-6, 0.28e-3, 3e-6, {}),
    ("silica", 1e-6, 0.075e-3, 4e-6, {}),
)
TRAJECTORIES = 1000
#: of the thermal motion, s
STEP = 0.2e-3
#: lifetimes that an ensemble lasts
LASTS = 14.0


def scene_of(material: str, **changes: Any) -> Scene:
    """A bead of that material."""
    bead = {**MATERIALS[material], **changes.pop("bead", {})}
    return tweezer.load_scene("silica-1um").replace(bead=bead, **changes)


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    diameters, powers = (DIAMETERS[::13], POWERS[::29]) if quick else (DIAMETERS, POWERS)
    maps: Results = {}
    for material in MATERIALS:
        found = tweezer.sweep(
            scene_of(material),
            {"bead.diameter": diameters, "beam.power_through_pupil": powers},
            progress=lambda part, what=material: say(f"{what}: {100 * part:.0f} %"),
        )
        maps[material] = {
            "outcome": found["outcome"].values.tolist(),
            "depth_kT": np.nan_to_num(found["escape_energy"].min("direction").values).tolist(),
            # JSON has no infinity: what lasts longer than is told has none
            "lifetime_s": [
                [each if math.isfinite(each) else None for each in row]
                for row in found["lifetime"].values.tolist()
            ],
        }
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick,
            "diameters_m": diameters.tolist(), "powers_W": powers.tolist(),
            "maps": maps,
            "least": _least(diameters, say),
            "ensembles": [
                _ensemble(*case, 20 if quick else TRAJECTORIES, say)
                for case in SHORT[: 1 if quick else None]
            ],
        }
    )  # fmt: skip
    return results


def _least(diameters: np.ndarray, say: Callable[[str], object]) -> list[Results]:
    """The least powers, of each material and size."""
    tasks = [(material, float(diameter)) for material in MATERIALS for diameter in diameters]
    found = []
    with ProcessPoolExecutor(cpu_count(), mp_context=get_context("spawn")) as executor:
        for done, each in enumerate(executor.map(least, *zip(*tasks, strict=True)), 1):
            found.append(each)
            say(f"least powers: {done} of {len(tasks)}")
    return found


def least(material: str, diameter: float) -> Results:
    """Least powers and their errors, W, for each of the times."""
    with warnings.catch_warnings(action="ignore"):
        scene = scene_of(material, bead={"diameter": diameter})
        powers = {name: tweezer.least_power(scene, seconds) for name, seconds in TIMES.items()}
    return {
        "material": material,
        "diameter_m": diameter,
        "powers_W": {name: each and each.power for name, each in powers.items()},
        "errors_W": {name: each and each.error for name, each in powers.items()},
    }


def _ensemble(
    material: str, diameter: float, power: float, lost_at: float, beam: dict[str, Any],
    trajectories: int, say: Callable[[str], object],
) -> Results:  # fmt: skip
    """A lifetime, and the mean of the times at which beads of an ensemble are lost."""
    say(f"ensemble: {material}, {1e6 * diameter:g} um")
    with warnings.catch_warnings(action="ignore"):
        scene = scene_of(
            material,
            bead={"diameter": diameter},
            beam={"power_through_pupil": power, **beam},
            forces={"brownian": True},
            start={"position": [0, 0, 0]},
            simulation={
                "model": "overdamped", "step": STEP, "samples": 21, "loss_distance": lost_at
            },
        )  # fmt: skip
        trap = tweezer.characterise(scene)
        held, place = trap.lifetime, trap.equilibrium
        assert held is not None
        assert place is not None
        by_map = scene.replace(
            start={"position": place.position},
            optics={
                "evaluator": "map", "table_tolerance": 1e-5, "table_range": f"{1.02 * lost_at} m"
            },
        )  # fmt: skip
        drawn = tweezer.ensemble(
            by_map, trajectories, duration=LASTS * held.time, seed=1,
        )  # fmt: skip
    lost = drawn["lost_time"].values
    inside = np.isfinite(lost)
    # of an exponential law, cut off at the end: all time over the number of losses
    mean = float(np.where(inside, lost, LASTS * held.time).sum() / inside.sum())
    return {
        "material": material, "diameter_m": diameter, "power_W": power, "lost_at_m": lost_at,
        "polarisation": scene.beam.polarisation, "depth_kT": min(
            each.energy_kT for each in trap.escapes
        ),
        "lifetime_s": held.time, "lifetime_error_s": held.error,
        "trajectories": trajectories, "ensemble_s": mean,
        "ensemble_error_s": mean / math.sqrt(inside.sum()),
    }  # fmt: skip
