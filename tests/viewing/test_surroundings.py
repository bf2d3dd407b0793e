"""The medium on a page: its name, the temperatures in the light, and its forces."""

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson

import tweezer
from tweezer.viewing.surroundings import of_the_medium

SILICA = tweezer.load_scene("silica-1um")
THIN = tweezer.load_scene("levitated-200nm")


def test_summary_names_medium_and_temperatures_in_the_light():
    """50 mW warm the medium by 15 K/W, and the bead by 400 K/W more, each known to 10 %."""
    hot = tweezer.load_scene(
        SILICA.model_dump(exclude_none=True)
        | {"medium": {"name": "water", "temperature": "20 degC"}}
        | {"heat": {"light": "15 K/W", "bead": "400 K/W"}}
    )
    rows = list(of_the_medium(hot))
    assert [row.value for row in rows[:3]] == ["water, 293.15 K", "293.9 K", "313.9 K"]
    assert [row.error for row in rows[:3]] == ["", "± 0.075 K", "± 2.0 K"]
    motion, _ = rows[3].value.split()
    assert float(motion) == pytest.approx(293.9 + 5 / 12 * 20, abs=0.6)  # of 20 K, to first order


@pytest.mark.parametrize(
    ("medium", "words"),
    [
        (THIN.medium, "air, 5 mbar, 300 K"),
        (SILICA.medium, "viscosity 1.002 mPa·s, 293.15 K"),
        (
            tweezer.load_scene("polymer-solution").medium,
            "viscosity 1.002 mPa·s, with 4 mPa s relaxing in 5 ms, 293.15 K",
        ),
    ],
)
def test_summary_without_heat_has_one_line(medium, words):
    (row,) = of_the_medium(SILICA.model_copy(update={"medium": medium}))
    assert (row.name, row.value) == ("medium", words)


@pytest.mark.parametrize(("interval", "close"), [(0.5e-6, True), (2e-6, False)])
def test_samples_of_a_bead_that_oscillates_are_close_within_its_swing(interval, close):
    """sqrt(m/k_y) is 0.9 us in the trap and beta/k 1.6e-8 s."""
    short = THIN.replace(
        start={"position": [0, 0, 0.381e-6]},
        simulation={"duration": 10 * interval, "samples": 11},
    )
    page = tweezer.view(tweezer.simulate(short, seed=1)).content
    assert ("energy_work" in page.arrays) == close
    assert page.facts["resolved"] == close


def test_rest_of_a_polymer_solution_is_the_force_of_its_elements():
    """A Maxwell element pulls back by -(b/tau) int exp(-(t - s)/tau) v(s) ds, less its noise."""
    scene = tweezer.load_scene("polymer-solution").replace(
        medium={"inertia": "none"}, forces={"brownian": False},
        simulation={"model": "full", "duration": "5 ms", "samples": 2001},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    page = tweezer.view(run).content
    found = page.arrays["force_medium"].values()
    tau, b = 5e-3, 6 * np.pi * 0.5e-6 * 4e-3
    t, velocity = run.time.values, run.velocity.values
    grown = np.exp(t / tau)[:, None]
    expected = -b / tau / grown * cumulative_simpson(velocity * grown, x=t, axis=0, initial=0)
    largest = np.abs(expected).max()
    assert largest > 1e-13
    np.testing.assert_allclose(found[20:], expected[20:], atol=1e-2 * largest, rtol=0)
    assert any("in the solvent" in note for note in page.notes)
