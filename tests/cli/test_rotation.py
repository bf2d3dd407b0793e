"""The command `tweezer rotation`: its rows against orientations that turn as given here."""

import numpy as np
import pytest
import xarray as xr

import tweezer
from tweezer.plots import rotation_figure

ROD = tweezer.load_scene("polystyrene-500nm").replace(
    bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"},
    beam={"power_through_pupil": 0},
    simulation={"duration": "1 ms", "samples": 3},
)
#: rad/s
RATE = 60 * np.pi


@pytest.fixture(scope="module")
def spinning():
    """A run of 6 turns in 0.2 s about z, with the body's axis at 0.5 rad from z."""
    run = tweezer.simulate(ROD)
    t = np.arange(2000) * 1e-4
    c, s = np.cos(RATE / 2 * t), np.sin(RATE / 2 * t)
    e = np.stack([np.cos(0.25) * c, -np.sin(0.25) * s, np.sin(0.25) * c, np.cos(0.25) * s], axis=-1)
    return run.drop_dims("time").assign(
        orientation=(("time", "euler_parameter"), e, run.orientation.attrs),
        position=(("time", "axis"), np.zeros((2000, 3)), run.position.attrs),
    ).assign_coords(time=("time", t, run.time.attrs))  # fmt: skip


@pytest.fixture
def file(spinning, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tweezer.save_run(spinning, "spinning.nc")


def test_rates_order_and_decay_times_are_printed(file, command_line):
    outcome = command_line("rotation", str(file))
    assert (outcome.code, outcome.err) == (0, "")
    lines = [line.strip().partition("  ") for line in outcome.out.splitlines()]
    rows = {name: value.strip() for name, _, value in lines}
    assert rows["angular velocity about z"] == "188.5 rad/s"
    # the axis of the body is 0.5 rad from that of the rotation
    along = rows["angular velocity about P3"].removesuffix(" rad/s")
    assert float(along) == pytest.approx(RATE * np.cos(0.5), rel=1e-3)
    order = 1.5 * np.cos(0.5) ** 2 - 0.5
    assert float(rows["<P2> of n along z"]) == pytest.approx(order, abs=1e-4)
    assert float(rows["order parameter of n"].partition(" ")[0]) == pytest.approx(order, abs=1e-4)
    assert rows["director"] == "0.000, 0.000, 1.000"
    # cos^2 0.5 + sin^2 0.5 cos(RATE t) does not fall to 1/e
    assert rows["decay time of <P1(n(0).n(t))>"] == "longer than 25 ms"
    assert outcome.out.endswith("half of the 95 % confidence interval.\n")


def test_result_is_written_and_loaded(file, spinning, command_line):
    outcome = command_line("rotation", str(file), "--axis", "1", "0", "0", "--skip", "10 ms",
                           "--segments", "1", "--out", "out.nc", "--plot", "out.png")  # fmt: skip
    assert (outcome.code, outcome.err) == (0, "")
    expected = tweezer.rotation(spinning, (1, 0, 0), skip="10 ms", segments=1)
    xr.testing.assert_identical(tweezer.load("out.nc"), expected)
    again = command_line("rotation", str(file), "--out", "out.nc")
    assert again.code == 2
    assert "out.nc: already exists" in again.err


def test_samples_too_rare_are_refused_with_the_option(spinning, command_line, tmp_path):
    rare = spinning.isel(time=slice(None, None, 130))  # 2.45 rad apart
    file = str(tweezer.save_run(rare, tmp_path / "rare.nc"))
    outcome = command_line("rotation", file)
    assert outcome.code == 2
    assert outcome.err.count("\n") == 1
    assert "turns by 2.45 rad between two samples" in outcome.err
    outcome = command_line("rotation", file, "--no-rates")
    assert outcome.code == 0
    assert "angular velocity" not in outcome.out
    assert "order parameter" in outcome.out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nothing.nc"], "nothing.nc: no such file"),
        (["spinning.nc", "--axis", "0", "0", "0"], "axis = (0.0, 0.0, 0.0): must be 3 numbers"),
        (
            ["spinning.nc", "--skip", "1 s"],
            "spinning.nc: contains fewer than 2 samples after skip = 1 s",
        ),
        (["spinning.nc", "--skip", "-1 s"], "--skip"),
        (["spinning.nc", "--segments", "0"], "segments = 0: must be a whole number of at least 1"),
    ],
)
def test_bad_arguments_are_one_line(file, command_line, arguments, said):
    outcome = command_line("rotation", *arguments)
    assert outcome.code == 2
    assert said in outcome.err
    assert outcome.err.count("\n") == 1


def test_figure_shows_the_values(spinning):
    found = tweezer.rotation(spinning, (1, 0, 0))
    msad, correlation, psd = rotation_figure(found).axes
    np.testing.assert_allclose(msad.lines[2].get_ydata(), (RATE * found.lag) ** 2, rtol=1e-9)
    np.testing.assert_allclose(correlation.lines[0].get_xdata(), 1e3 * found.lag)
    np.testing.assert_allclose(psd.lines[0].get_ydata(), found.psd.sel(axis="x"))
    assert len(rotation_figure(tweezer.rotation(spinning, rates=False)).axes) == 2
