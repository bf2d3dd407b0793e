"""Viscoelastic media of scenes, and the response of a bead in them, against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.special import erfcx, gamma

import tweezer
from tweezer.fluid.viscoelastic import elements_of
from tweezer.scene.sections.medium import PowerLaw
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError

SCENE = tweezer.load_scene("silica-1um")
DARK = SCENE.replace(forces={"optical": False, "gravity": False, "buoyancy": False})
RADIUS = 0.5e-6
KT = Boltzmann * SCENE.medium.temperature
JEFFREYS = {"relaxing": [{"viscosity": "4 mPa s", "time": "5 ms"}]}
THREE = {
    "relaxing": [
        {"viscosity": "4 mPa s", "time": "5 ms"},
        {"viscosity": "10 mPa s", "time": "0.1 ms"},
        {"viscosity": "2 mPa s", "time": "0.3 s"},
    ]
}


def power_law(exponent: float) -> dict[str, Any]:
    return {
        "power_law": {
            "exponent": exponent,
            "modulus": "0.05 Pa",
            "at": "0.159 Hz",
            "band": ["0.01 Hz", "10 MHz"],
        }
    }


def viscosity(medium: Any, s: Any) -> Any:
    """Complex viscosity mu(s) of a medium, without its elements."""
    mu = medium.viscosity + 0 * s
    for each in medium.relaxing or ():
        mu = mu + each.viscosity / (1 + s * each.time)
    if (law := medium.power_law) is not None:
        mu = mu + law.modulus / (2 * np.pi * law.at) ** law.exponent * s ** (law.exponent - 1)
    return mu


@pytest.mark.parametrize("exponent", [0.05, 0.2, 0.5, 2 / 3, 0.75, 0.95])
def test_power_law_has_positive_elements(exponent: float) -> None:
    law = PowerLaw(exponent=exponent, modulus=0.05, at=1.0, band=(1.0, 1e6))
    eta, tau = elements_of(law)
    assert eta.min() > 0
    assert len(eta) == 3 * 6 + 1 + 6
    s = 2j * np.pi * np.geomspace(1, 1e6, 200)
    expected = 0.05 * (s / (2 * np.pi)) ** exponent
    found = s * (eta / (1 + np.multiply.outer(s, tau))).sum(axis=1)
    # of the modulus, with the phase that the exponent implies
    assert np.abs(found / expected - 1).max() < 1e-5


MEDIA = {
    "Jeffreys": JEFFREYS,
    "three elements": THREE,
    **{f"power {a:.3g}": power_law(a) for a in (0.5, 2 / 3, 0.75)},
}


@pytest.mark.parametrize("name", MEDIA)
@pytest.mark.parametrize("inertia", ["none", "memory"])
def test_spectrum_is_that_of_the_correspondence_principle(name: str, inertia: str) -> None:
    scene = DARK.replace(medium=MEDIA[name] | {"inertia": inertia}, simulation={"model": "full"})
    f = np.geomspace(0.1, 1e6, 40)
    s, medium = 2j * np.pi * f, scene.medium
    mu = viscosity(medium, s)
    drag = mu.copy()
    if inertia == "memory":
        drag += RADIUS * np.sqrt(medium.density * s * mu) + s * RADIUS**2 * medium.density / 9
    mass = 2000 * 4 / 3 * np.pi * RADIUS**3
    exact = 4 * KT * (1 / (mass * s + 6 * np.pi * RADIUS * drag)).real / (2 * np.pi * f) ** 2
    found = tweezer.response(scene, frequencies=f).spectrum
    for axis in "xyz":
        off = np.abs(found.sel(axis=axis).values / exact - 1).max()
        assert off < found.attrs["relative_error"]


@pytest.mark.parametrize("exponent", [0.5, 2 / 3, 0.75])
def test_power_law_displacement(exponent: float) -> None:
    # without a solvent to speak of
    medium = power_law(exponent) | {"viscosity": 1e-12, "inertia": "none"}
    scene = DARK.replace(medium=medium, simulation={"model": "overdamped"})
    t = np.geomspace(1e-5, 0.1, 9)
    A = 0.05 / (2 * np.pi * 0.159) ** exponent
    expected = 2 * KT * t**exponent / (6 * np.pi * RADIUS * A * gamma(1 + exponent))
    assert tweezer.response(scene, t).msd_free.values == pytest.approx(expected, rel=1e-4)


def test_root_law_relaxation() -> None:
    medium = power_law(0.5) | {"viscosity": 1e-12, "inertia": "none"}
    scene = SCENE.replace(medium=medium, simulation={"model": "overdamped"})
    t = np.geomspace(1e-5, 0.1, 9)
    k = tweezer.characterise(SCENE).equilibrium.stiffness[0][0]
    A = 0.05 / (2 * np.pi * 0.159) ** 0.5
    expected = erfcx(k * np.sqrt(t) / (6 * np.pi * RADIUS * A))
    found = tweezer.response(scene, t).relaxation.sel(axis="x").values
    assert found == pytest.approx(expected, abs=1e-4)


def test_gel_holds_a_free_bead() -> None:
    scene = DARK.replace(
        medium={"elasticity": "1 Pa", "inertia": "none"}, simulation={"model": "overdamped"}
    )
    t = np.geomspace(1e-5, 1, 9)
    g, beta = 6 * np.pi * RADIUS * 1.0, 6 * np.pi * RADIUS * scene.medium.viscosity
    expected = 2 * KT / g * -np.expm1(-g * t / beta)
    assert tweezer.response(scene, t).msd_free.values == pytest.approx(expected, rel=1e-9)


def test_free_bead_has_no_relaxation() -> None:
    found = tweezer.response(DARK, [1e-3], [1.0])
    assert found.trapped == 0
    assert np.isnan(found.relaxation.values).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"medium": JEFFREYS, "wall": {"position": "-5 um"}}, "medium.relaxing: is not known"),
        (
            {"medium": JEFFREYS, "simulation": {"model": "first-order"}},
            "simulation.model = 'first-order'",
        ),
        ({"medium": JEFFREYS, "simulation": {"method": "dop853"}}, "simulation.method = 'dop853'"),
        ({"medium": {"anchor": "trap"}}, "anchor: requires elasticity"),
        (
            {"medium": JEFFREYS, "start": {"angular_velocity": [0, 0, 1]}},
            "medium.relaxing: the rotation of a bead is not known",
        ),
        (
            {"medium": {"power_law": {"exponent": 0.5, "modulus": 1, "at": 1, "band": [5, 1]}}},
            "the frequencies must ascend",
        ),
    ],
)
def test_scene_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message.replace(".", r"\.")) as error:
        SCENE.replace(**changes)
    assert "\n" not in str(error.value)


def test_times_must_be_positive() -> None:
    with pytest.raises(SceneError, match="times: must be a list of finite numbers above 0 s"):
        tweezer.response(SCENE, [0.0])
