"""Small results of every kind that has a page."""

import math

import numpy as np
import pytest
import xarray as xr

import tweezer
from tweezer.ensembles.statistics import Plan, Statistics
from tweezer.sweeps.cases import cases_of
from tweezer.sweeps.result import dataset_of


@pytest.fixture(scope="session")
def about():
    """Attributes of an ensemble; no light, so that nothing is compiled, and a wall far off."""
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True, "optical": False}, wall={"position": "-20 um"}
    )
    return {
        "title": "beads that are made up", "scene": scene.model_dump_json(exclude_none=True),
        "trajectories": 15, "seed": 24, "model": "full", "method": "heun", "step": 1e-5,
        "tweezer_version": "0.1.0",
    }  # fmt: skip


def walks(beads, samples):
    """Positions of beads that diffuse from a place, (beads, samples, 3) m."""
    steps = 2e-7 * np.random.default_rng(24).normal(size=(beads, samples, 3))
    steps[:, 0] = [3e-7, 2e-7, -3e-7]
    return steps.cumsum(axis=1)


@pytest.fixture(scope="session")
def cloud(about) -> xr.Dataset:
    """Fifteen beads, of which two are lost."""
    times = np.linspace(0, 2e-3, 12)
    position, lost = walks(15, 12), np.full(15, np.inf)
    for bead, sample in ((3, 5), (8, 9)):
        position[bead, sample:] = np.nan
        lost[bead] = times[sample]
    return xr.Dataset(
        {"position": (("trajectory", "time", "axis"), position), "lost_time": ("trajectory", lost)},
        {"time": times, "axis": ["x", "y", "z"]},
        about,
    )


@pytest.fixture(scope="session")
def gathered(about) -> xr.Dataset:
    """Statistics of forty such beads."""
    plan = Plan(np.linspace(0, 2e-3, 40), {"position": slice(0, 3)}, 0, 2e-5, (0.0,) * 3, False)
    statistics, position = Statistics(plan), walks(40, 40)
    statistics.add_piece(0, position)
    statistics.add_window(0, position)
    statistics.close(np.full(40, np.inf))
    return statistics.dataset().assign_attrs(about)


@pytest.fixture(scope="session")
def diagram() -> xr.Dataset:
    """A sweep whose numbers are made up: a case each that is not held, failed, not computed."""
    over = {
        "bead.diameter": ["1.2 um", "0.5 um", "0.8 um"],
        "beam.power_through_pupil": ["1 mW", "10 mW", "100 mW", "1 W"],
    }
    cases = cases_of(over, None)
    rng = np.random.default_rng(24)
    done = {}
    for case in range(cases.count - 1):
        done[case] = {"outcome": "held", "caveat": "a caveat" if case == 6 else ""}
        for name, count in (
            ("equilibrium", 3), ("stiffness", 3), ("corner_frequency", 3),
            ("escape_force", 6), ("escape_energy", 6),
        ):  # fmt: skip
            scale = {"equilibrium": 1e-7, "stiffness": 1e-5, "escape_force": 1e-11}.get(name, 50)
            done[case][name] = (scale * rng.uniform(0.5, 9, count)).tolist()
            done[case][f"{name}_error"] = (scale * rng.uniform(1e-3, 1e-2, count)).tolist()
        endless = case % 4 == 3
        done[case]["lifetime"] = math.inf if endless else 10.0 ** rng.uniform(-2, 9)
        done[case]["lifetime_error"] = 0.0 if endless else 0.01
        done[case]["force_error"] = 1e-15
    done[5]["escape_energy"][:3] = [2.0, 9.0, math.nan]
    done[1] = {"outcome": "not held", "force_error": 1e-15}
    done[2] = {"outcome": "failed", "reason": "bead.diameter: of no use"}
    attributes = {
        "of": "trap", "scene": tweezer.load_scene("silica-1um").model_dump_json(exclude_none=True),
        "over": "{}", "title": "made up", "tweezer_version": "0.1.0",
    }  # fmt: skip
    return dataset_of(cases, "trap", done, attributes)


@pytest.fixture(scope="session")
def trap() -> tweezer.Trap:
    """A bead in two beams of elliptical light, not the same all around; one comes from above."""
    scene = tweezer.load_scene("polystyrene-500nm")
    up = scene.beam.model_dump(mode="json", exclude_none=True) | {"jones": [[0.6, 0.0], [0.3, 0.7]]}
    above = {"direction": "down", "position": [1e-7, 2e-7, 3e-7], "power_through_pupil": 0.02}
    return tweezer.characterise(scene.replace(beam=[up, up | above]))
