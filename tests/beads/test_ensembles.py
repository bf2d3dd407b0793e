"""Ensembles of several beads: the same numbers however they are computed, losses, statistics."""

import numpy as np
import pytest
from scipy.constants import Boltzmann

import tweezer
from tests.ensembles.test_ensemble import content, interrupt_after
from tweezer.ensembles import job, statistics
from tweezer.plots import ensemble_figure
from tweezer.values.errors import ResultError, SceneError

BEAD = {"diameter": "1 um", "density": "2000 kg/m^3", "refractive_index": 1.45}


def apart(*places):
    """Return a scene of beads at places along x, m, that diffuse without forces, for 10 ms."""
    return tweezer.load_scene({
        "name": "free beads",
        "bead": [BEAD | {"name": f"bead {x:g}", "start": [x, 0, 0]} for x in places],
        "medium": {"name": "water", "temperature": 295},
        "lens": {"map": "sine", "radius": "2.5 mm", "numerical_aperture": 1.2},
        "beam": {
            "wavelength": "1064 nm", "power_through_pupil": "50 mW", "waist": "2.5 mm",
            "polarisation": "circular",
        },
        "forces": {"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
        "simulation": {"duration": "10 ms", "samples": 101},
    })  # fmt: skip


#: Two beads, of which a third of the copies lose one within the 10 ms
PAIR = apart(-0.75e-6, 0.75e-6).replace(simulation={"loss_distance": "850 nm"})
THREE = apart(-1.5e-6, 0, 1.5e-6)


@pytest.fixture
def small(monkeypatch):
    """Blocks of 8 trajectories, windows of 32 samples."""
    monkeypatch.setattr(job, "_BATCH", 8)
    monkeypatch.setattr(job, "_WINDOW_NUMBERS", 6 * 8 * 32)
    monkeypatch.setattr(statistics, "WINDOW", 32)


@pytest.mark.parametrize("scene", [PAIR, THREE], ids=["two", "three"])
def test_trajectories_do_not_depend_on_blocks_and_the_first_is_the_run(scene, small):
    run = tweezer.simulate(scene, seed=5)
    several = tweezer.ensemble(scene, 20, seed=5, workers=2)
    few = tweezer.ensemble(scene, 3, seed=5, workers=1)
    assert several.position.dims == ("trajectory", "time", "bead", "axis")
    assert several.bead.values.tolist() == run.bead.values.tolist()
    samples = run.sizes["time"]
    np.testing.assert_array_equal(several.position[0, :samples], run.position)
    np.testing.assert_array_equal(several.position[:3], few.position)
    assert len(np.unique(several.position[:, 1, 0, 0])) == 20


def test_a_trajectory_ends_with_the_loss_of_its_first_bead():
    found = tweezer.ensemble(PAIR, 64, seed=2)
    kept = tweezer.ensemble(PAIR.replace(simulation={"loss_distance": "1 mm"}), 64, seed=2)
    far = (np.linalg.norm(kept.position.values, axis=-1) > 850e-9).any(axis=2)
    lost = far.any(axis=1)
    assert 10 < lost.sum() < 54
    first = np.where(lost, far.argmax(axis=1), 101)
    for i, sample in enumerate(first):
        np.testing.assert_array_equal(found.position[i, :sample], kept.position[i, :sample])
        assert np.isnan(found.position[i, sample:]).all()
        assert found.lost_time[i] == (kept.time[sample] if lost[i] else np.inf)
    assert "losses are late" in found.attrs["loss_caveat"]


def test_statistics_are_the_moments_of_the_trajectories(small):
    all_of_them = tweezer.ensemble(PAIR, 40, seed=4).position.values
    found = tweezer.ensemble(PAIR, 40, seed=4, statistics=True, skip="1 ms")
    assert found.position_mean.dims == ("time", "bead", "axis")
    assert found.axis.values.tolist() == ["x", "y", "z"]
    with np.errstate(invalid="ignore"):
        mean, variance = np.nanmean(all_of_them, axis=0), np.nanvar(all_of_them, axis=0, ddof=1)
    np.testing.assert_allclose(found.position_mean, mean, rtol=1e-9, atol=1e-18)
    np.testing.assert_allclose(found.position_variance, variance, rtol=1e-9, atol=1e-26)
    after = all_of_them[:, 10:]
    assert found.counts.sum() == 3 * np.isfinite(after[..., 0]).sum()
    held = after[~np.isnan(after[:, -1]).any(axis=(1, 2))]
    moved = [(held[:, i : i + 30, :, 0]) for i in (0, 30, 60)]
    step = np.mean([np.diff(each, axis=1) ** 2 for each in moved])
    assert found.msd.sel(axis="x")[:, 0].mean() == pytest.approx(step, rel=0.2)
    free = 2 * Boltzmann * 295 * 1e-4 / tweezer.bead_properties(PAIR.alone(1)).drag
    assert found.msd[:, :, 0].mean() == pytest.approx(free, rel=0.1)


@pytest.mark.parametrize("gathered", [False, True])
def test_interrupted_and_resumed(gathered, small, tmp_path):
    suffix = ".nc" if gathered else ".zarr"
    one, other = (tmp_path / f"{name}{suffix}" for name in ("one", "other"))
    kind = {"seed": 8, "statistics": gathered, "workers": 1}
    tweezer.ensemble(PAIR, 30, out=one, **kind)
    begun = tweezer.ensemble(PAIR, 30, out=other, progress=interrupt_after(0.3), **kind)
    assert begun.attrs["status"] == "interrupted"
    tweezer.ensemble(PAIR, 30, out=other, resume=True, **kind)
    assert content(one) == content(other)


def test_a_figure_shows_one_bead_at_a_time():
    found = tweezer.ensemble(PAIR, 5, seed=1)
    with pytest.raises(ResultError, match="several beads; select one"):
        ensemble_figure(found)
    assert ensemble_figure(found.isel(bead=0, drop=True)).axes


def test_what_several_beads_cannot_have_is_refused(tmp_path):
    with pytest.raises(SceneError, match="forces: require a single bead"):
        tweezer.ensemble(PAIR, 2, forces=[lambda x, t: x])
    with pytest.raises(SceneError, match=r"bead\[2\]\.start .* from the nearest focus"):
        PAIR.replace(**{"bead[2]": {"start": [2e-6, 0, 0]}})
