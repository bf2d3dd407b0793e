"""Recordings of one's own and of ours, and `tweezer calibrate` of them."""

import json
import math
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import tweezer
from tests import readable
from tests.reference.trapped_bead import trapped
from tweezer.plots import calibration_figure
from tweezer.reading import Recording
from tweezer.results.io import save_run
from tweezer.values.rounding import rounded, with_uncertainty

T, K, DRAG, STEP = 293.15, 1e-5, 6 * math.pi * 1.002e-3 * 0.5e-6, 1e-4
KNOWN = ["--temperature", "20 degC", "--radius", "500 nm", "--viscosity", "1.002 mPa s"]


@pytest.fixture(scope="module")
def positions():
    """(4000, 3) m; the trap is a third as stiff along z."""
    lateral = trapped(STEP, 4000, K, DRAG, None, T, 1, 2)
    return np.concatenate([lateral, trapped(STEP, 4000, K / 3, DRAG, None, T, 2)]).T


@pytest.fixture
def run(positions):
    """What a simulation of thermal motion returns, as far as it matters here."""
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, simulation={"model": "overdamped"}
    )
    return xr.Dataset(
        {"position": (("time", "axis"), positions.copy(), {"units": "m"})},
        coords={"time": STEP * np.arange(len(positions)), "axis": ["x", "y", "z"]},
        attrs={"title": "a run", "scene": scene.model_dump_json(exclude_none=True),
               "status": "complete"},
    )  # fmt: skip


def write_table(path, positions, heading="t,x,y,z", scales=(1, 1, 1, 1), delimiter=","):
    columns = np.column_stack([STEP * np.arange(len(positions)), positions])
    np.savetxt(
        path, columns / scales[: columns.shape[1]], fmt="%.12g", delimiter=delimiter,
        header=heading, comments="",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("heading", "scales", "delimiter"),
    [("t,x,y,z", (1, 1, 1, 1), ","),
     ("t [ms], x (um), y [µm], z (nm)", (1e-3, 1e-6, 1e-6, 1e-9), ","),
     ("# Time [s];X [nm];Y [nm];Z [nm]", (1, 1e-9, 1e-9, 1e-9), ";"),
     ("\ufefft\tx[mm]\ty\tz", (1, 1e-3, 1, 1), "\t"),
     ("time_ms,x_nm,y_um,Z_mm", (1e-3, 1e-9, 1e-6, 1e-3), ","),
     ("t/s;x/nm;y / µm;z/m", (1, 1e-9, 1e-6, 1), ";"),
     ("Time (ms),X position (nm),y pos [um],z um", (1e-3, 1e-9, 1e-6, 1e-6), ",")],
)  # fmt: skip
def test_tables_in_text(tmp_path, positions, heading, scales, delimiter):
    path = tmp_path / "mine.csv"
    write_table(path, positions[:200], heading, scales, delimiter)
    recording = tweezer.load_recording(path)
    assert (recording.name, recording.axes, recording.scene) == (str(path), ("x", "y", "z"), None)
    np.testing.assert_allclose(recording.positions, positions[:200], rtol=1e-11)
    assert recording.step == pytest.approx(STEP, rel=1e-11)


def test_other_columns_are_left_alone(tmp_path):
    path = tmp_path / "mine.txt"
    rows = "".join(f'{i},{i % 7},spot {i}, {i / 10},9,"a, b",\n' for i in range(150))
    path.write_text(f"frame,x [um],what,t,x_err,x_max,y\n{rows}\n".replace(",y\n", ",\n"))
    recording = tweezer.load_recording(path)
    assert recording.axes == ("x",)
    assert recording.positions[8, 0] == pytest.approx(1e-6)
    assert recording.times[8] == pytest.approx(0.8)


def test_hdf5_and_netcdf(tmp_path, positions):
    with h5py.File(tmp_path / "mine.h5", "w") as file:
        file["time"] = 1e3 * STEP * np.arange(500)
        file["time"].attrs["units"] = "ms"
        file["x"] = positions[:500, 0]
        file["y"] = np.round(positions[:500, 1] * 1e12).astype(int)
        file["y"].attrs["units"] = b"pm"
        file["camera"] = np.ones((3, 3))
    columns = {
        "x": ("t", positions[:500, 0] * 1e6, {"units": "um"}),
        "z": ("t", positions[:500, 2]),
    }
    xr.Dataset(columns, {"t": STEP * np.arange(500)}).to_netcdf(
        tmp_path / "mine.nc", engine="h5netcdf"
    )
    hdf5 = tweezer.load_recording(tmp_path / "mine.h5")
    netcdf = tweezer.load_recording(tmp_path / "mine.nc")
    assert (hdf5.axes, netcdf.axes) == (("x", "y"), ("x", "z"))
    np.testing.assert_allclose(hdf5.positions, positions[:500, :2], rtol=0, atol=6e-13)
    np.testing.assert_allclose(netcdf.positions, positions[:500, ::2], rtol=1e-12)
    assert hdf5.step == pytest.approx(STEP)
    assert netcdf.step == pytest.approx(STEP)


def test_a_run_of_ours_brings_its_scene(tmp_path, run, positions):
    path = save_run(run, tmp_path / "run.nc")
    for source in (run, path):
        recording = tweezer.load_recording(source)
        assert recording.scene == tweezer.scene_of(run)
        np.testing.assert_array_equal(recording.positions, positions)
    calibration = tweezer.calibrate(path)
    assert calibration.temperature == T
    assert calibration.drag == pytest.approx(DRAG, rel=1e-9, abs=0)
    assert calibration.mass is None
    assert repr(calibration).startswith(f"Calibration of {path}\n  stiffness, x  ")
    for axis, k in zip(calibration.axes, (K, K, K / 3), strict=True):
        first = axis.estimates[0]
        value = with_uncertainty(1e6 * first.stiffness, 1e6 * first.uncertainty, "±")
        assert f"  stiffness, {axis.axis}  {value} pN/µm, by {first.method}" in repr(calibration)
        for estimate in axis.estimates:
            assert not estimate.caveat
            assert abs(estimate.stiffness - k) < 4.5 * estimate.uncertainty  # false alarm 1e-4


def test_a_damaged_run_is_not_calibrated(tmp_path, run):
    path = save_run(run, tmp_path / "run.nc")
    content = bytearray(path.read_bytes())
    at = content.find(run["position"].values[:2].tobytes())
    content[at + 6] ^= 1  # of the first x
    path.write_bytes(content)
    with pytest.raises(tweezer.ResultError, match=r"run\.nc: damaged: its content differs from"):
        tweezer.load_recording(path)


@pytest.mark.parametrize(("model", "factor"), [("full", 1.0), ("scaled", 0.01)])
def test_a_run_has_the_inertia_of_its_model(run, model, factor):
    scene = tweezer.scene_of(run)
    settings = {"model": model, "scaling_factor": factor if model == "scaled" else None}
    run.attrs["scene"] = scene.replace(simulation=settings).model_dump_json(exclude_none=True)
    mass = tweezer.bead_properties(scene).mass
    assert tweezer.calibrate(run).mass == pytest.approx(mass / factor, rel=1e-9, abs=0)


@pytest.mark.parametrize("inertia", ["none", "added-mass", "memory"])
def test_a_run_has_the_inertia_of_its_fluid(run, inertia):
    scene = tweezer.scene_of(run)
    changed = scene.replace(simulation={"model": "full"}, medium={"inertia": inertia})
    run.attrs["scene"] = changed.model_dump_json(exclude_none=True)
    own = tweezer.bead_properties(scene).mass
    fluid = own * scene.medium.density / scene.bead.density
    found = tweezer.calibrate(run)
    assert found.mass == pytest.approx(own + (fluid / 2 if inertia == "added-mass" else 0))
    assert found.displaced_mass == (pytest.approx(fluid) if inertia == "memory" else None)


def test_a_lost_run_counts_up_to_there(run):
    run["position"][3000:] = np.nan
    run.attrs["status"] = "lost"
    recording = tweezer.load_recording(run)
    assert len(recording.times) == 3000
    assert recording.note == "the run is lost: up to 0.2999 s only"
    assert tweezer.calibrate(run).note == recording.note
    run["position"][30:] = np.nan
    with pytest.raises(tweezer.ResultError, match=r"or more; the run is lost: up to 0\.0029 s"):
        tweezer.load_recording(run)


def test_the_beginning_can_be_left_out(run):
    later = tweezer.load_recording(run).since(0.1)
    assert (len(later.times), later.times[0]) == (3000, pytest.approx(0.1))
    with pytest.raises(tweezer.ResultError, match="has 0 samples"):
        later.since(10.0)


def test_what_is_no_run_is_refused(run):
    with pytest.raises(tweezer.ResultError, match="a run: not a run: it has no scene"):
        tweezer.load_recording(run.drop_vars("position"))
    still = tweezer.scene_of(run).replace(forces={"brownian": False})
    run.attrs["scene"] = still.model_dump_json(exclude_none=True)
    with pytest.raises(tweezer.ResultError, match="without thermal motion"):
        tweezer.calibrate(run)


def rows(count=150, **changed):
    """Lines of a table t, x; `changed` by the number of the line, with an l before it."""
    lines = ["t,x", *(f"{i * 1e-3:.6g},{i % 7}e-9" for i in range(count))]
    for line, text in changed.items():
        lines[int(line[1:]) - 1] = text
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [("a.csv", rows(50), "has 50 samples; for a trap it must have 100 or more"),
     ("a.csv", rows(0), "has 0 samples"),
     ("a.csv", "", "has no column t and no column x; headings are such as"),
     ("a.csv", "t,y\n0,1\n", "has no column x among 't', 'y'; headings are such as"),
     ("a.csv", rows(l1="frame,x"), "has frames and no times; give their rate: --rate"),
     ("a.csv", rows(l1="t,x_px"), "x_px: is in pixels; give the length of a pixel: --scale"),
     ("a.csv", rows(l1="0,1e-9"), "has no headings over its 2 columns; name them in their order: "
      '--columns "t [s],x [um]"'),
     ("a.csv", "t," + ",".join(f"c{i}" for i in range(999)), "'c7', 'c8', ...; headings are"),
     ("a.csv", rows(l1="t,x [kg]"), "x [kg]: 'kg' has the wrong unit; must be convertible to m"),
     ("a.csv", rows(l1="t,x/A"), "x/A: 'A' has an unknown unit"),
     ("a.csv", rows(l1="t [furlong],x"), "t [furlong]: 'furlong' has"),
     ("a.csv", rows(l1="t,x (" + 100_000 * " " + "!"), "has no column x"),
     ("a.csv", rows(l1="t,x (" + 100_000 * " " + "!)"), "has no column x"),
     ("a.csv", rows(l60='0.058,"5'), "line 60: a quote is not closed"),
     ("a.csv", rows(l60="0.058," + 200_000 * "5"), "not finite"),
     ("a.csv", rows(l60="0.058," + 200_000 * "x"), "xxx...' is not a number"),
     ("a.csv", rows(l2="0,0,1,5"), "line 2: has 4 cells for 2 headings; decimals need a point"),
     ("a.csv", rows(l60="0.058,five"), "line 60: 'five' is not a number"),
     ("a.csv", rows(**{f"l{i}": f"{1e-3 * (i - 2):.6g}," for i in range(50, 64)}),
      "samples missing: 14 of 150; the longest stretch without a gap has 88 samples, and must"),
     ("a.csv", rows(**{f"l{i}": f"{i},nan" for i in range(2, 152)}), "has no row in which all"),
     ("a.csv", rows(l60="inf,1"), "sample 59: not finite"),
     ("a.csv", rows(l60="0.057,1"), "sample 59: its time is not later than the previous time"),
     ("a.csv", rows(l60="0.0584,1"), "sample 59: its time is off the even step of 0.001 s"),
     ("a.csv", "t,x\n" + "".join(f"{i},1\n" for i in range(150)), "x does not change"),
     ("a.nc", "t,x", "not an HDF5 or NetCDF 4 file, or damaged"),
     ("a.csv", rows(l1="t,x [um],x [nm]"), "two columns for x"),
     ("a.csv", rows(l1="t,time,x"), "two columns for t"),
     ("a.csv", "t,x\n" + "".join(f"{i},{i % 7}\n" for i in range(150)), "Is its unit missing?"),
     ("a.xlsx", "t,x", "must end in .csv, .tsv, .txt, .dat")],
)  # fmt: skip
def test_bad_tables_are_refused_in_one_line(command_line, name, text, complaint):
    Path(name).write_text(text, encoding="utf-8")
    outcome = command_line("calibrate", name, *KNOWN, "--out", "k.json", "--plot", "k.png")
    assert (outcome.code, outcome.out) == (2, "")
    assert len(outcome.err.splitlines()) == 1
    assert outcome.err.startswith(f"{name}: ")
    assert complaint in outcome.err
    assert [path.name for path in Path().iterdir()] == [name]


def test_bad_binaries_are_refused(tmp_path):
    def refused(**columns):
        path = tmp_path / "bad.h5"
        with h5py.File(path, "w") as file:
            for name, values in columns.items():
                file[name] = values
        with pytest.raises(tweezer.ResultError) as refusal:
            tweezer.load_recording(path)
        return str(refusal.value)

    t = np.arange(150.0)
    assert "columns have different lengths: 150 values of t and 140 values of x" in refused(
        t=t, x=t[:140]
    )
    assert "has no column x among 't', 'x:1', 'x:2'" in refused(t=t, x=np.ones((150, 2)))
    assert "has no column x among 't'" in refused(t=t, x="text")
    assert "has no column t" in refused(x=t)
    with pytest.raises(tweezer.ResultError, match="no such file"):
        tweezer.load_recording(tmp_path / "none.csv")
    with pytest.raises(tweezer.ResultError, match="xxx: no such file"):
        tweezer.load_recording("x" * 300)
    with pytest.raises(tweezer.SceneError, match=r"xxx\.csv"):
        tweezer.load_scene(f"{'x' * 300}.csv")
    with pytest.raises(tweezer.ResultError, match="is a folder"):
        tweezer.load_recording(tmp_path)


def test_a_binary_column_has_one_unit(tmp_path):
    with h5py.File(tmp_path / "mine.h5", "w") as file:
        file["time_ms"] = np.arange(150.0)
        file["x [nm]"] = np.arange(150.0) % 7
        file["x [nm]"].attrs["units"] = "nm"
    recording = tweezer.load_recording(tmp_path / "mine.h5")
    assert recording.step == pytest.approx(1e-3)
    assert np.ptp(recording.positions) == pytest.approx(6e-9)
    with h5py.File(tmp_path / "mine.h5", "a") as file:
        file["x [nm]"].attrs["units"] = "m"
    with pytest.raises(tweezer.ResultError, match=r"x \[nm\]: is in nm, and in m"):
        tweezer.load_recording(tmp_path / "mine.h5")


@pytest.mark.parametrize("way", ["storage", "link", "soft link", "virtual"])
def test_numbers_in_other_files_are_refused(tmp_path, way):
    """A recording could name any file that its reader may read."""
    (tmp_path / "secret").write_bytes(np.arange(150.0).tobytes())
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["x"] = np.arange(150.0) % 7
    with h5py.File(tmp_path / "mine.h5", "w") as file:
        file["t"] = np.arange(150.0)
        if way == "storage":
            file.create_dataset("x", (150,), "f8", external=[(str(tmp_path / "secret"), 0, 1200)])
        elif way == "virtual":
            layout = h5py.VirtualLayout((150,), "f8")
            layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "x", (150,))
            file.create_virtual_dataset("x", layout)
        elif way == "link":
            file["x"] = h5py.ExternalLink("other.h5", "x")
        else:
            file["beside/x"] = h5py.ExternalLink("other.h5", "x")
            file["x"] = h5py.SoftLink("/beside/x")
    with pytest.raises(tweezer.ResultError, match=r"h5: (beside/)?x: is stored in another file"):
        tweezer.load_recording(tmp_path / "mine.h5")


@pytest.mark.parametrize("scale", [False, True])
def test_a_long_recording_that_holds_nothing_is_refused(tmp_path, scale):
    """Before its numbers are made in memory: a file of 2 kB would take 30 GB."""
    with h5py.File(tmp_path / "mine.h5", "w") as file:
        for column in "tx":
            file.create_dataset(column, (2 * 10**9,), "f8", chunks=(10**6,))
        if scale:
            file["t"].make_scale()
            file["x"].dims[0].attach_scale(file["t"])
    with pytest.raises(tweezer.ResultError, match="has 2,000,000,000 samples; must have at most"):
        tweezer.load_recording(tmp_path / "mine.h5")


@pytest.mark.parametrize(
    ("times", "positions", "complaint"),
    [(np.arange(150.0), np.arange(149.0), r"positions of shape \(149, 1\); must be .n,. and .n, 1"),
     (np.arange(150.0), np.ones((150, 3)), "must be .n,. and .n, 1."),
     (np.arange(140.0), np.ones((150, 1)), "must be .n,. and .n, 1."),
     (["a"], [[0]], "times: must be a number in s")],
)  # fmt: skip
def test_a_recording_of_other_shapes_is_refused(times, positions, complaint):
    with pytest.raises(tweezer.ResultError, match=complaint):
        Recording(times, positions, ("x",), name="mine")


def test_the_name_of_a_recording_is_optional_and_last(positions):
    times, axes = STEP * np.arange(500), ("x", "y", "z")
    assert Recording(times, positions[:500], axes).name == "recording"
    new = Recording(times, positions[:500], axes, name="mine")
    for old in (((times, positions[:500], axes), {}), ((times, positions[:500]), {"axes": axes})):
        with pytest.warns(FutureWarning, match=r"Recording\(\.\.\., name='mine'\).*the old order"):
            found = Recording("mine", *old[0], **old[1])
        assert found.name == "mine"
        np.testing.assert_array_equal(found.times, new.times)
        np.testing.assert_array_equal(found.positions, new.positions)
    with pytest.warns(FutureWarning, match="the old order"):
        assert tweezer.Track("t", times, positions[:500, :2]).name == "t"


def test_times_may_be_rounded(positions):
    times = np.round(STEP * np.arange(500), 5) + 4e-6 * (np.arange(500) % 2)
    recording = Recording(times, positions[:500], ("x", "y", "z"), name="mine")
    assert recording.step == pytest.approx(STEP, rel=1e-3)


def test_command(command_line, positions):
    write_table("mine.csv", positions, "t [ms],x [um],y [um],z [um]", (1e-3, 1e-6, 1e-6, 1e-6))
    outcome = command_line(
        "calibrate", "mine.csv", *KNOWN, "--skip", "10 ms", "--out", "k.json", "--plot", "k.png"
    )
    assert (outcome.code, outcome.err) == (0, "")
    written = json.loads(Path("k.json").read_text())
    assert written["samples"] == 3900
    assert written["temperature"] == pytest.approx(T)
    assert written["drag"] == pytest.approx(DRAG, rel=1e-9, abs=0)
    assert [axis["axis"] for axis in written["axes"]] == ["x", "y", "z"]
    for axis in written["axes"]:
        for estimate in axis["estimates"]:
            k, error = rounded(1e6 * estimate["stiffness"], 1e6 * estimate["uncertainty"])
            assert re.search(f"^ +{estimate['method']} +{k} +{error} *$", outcome.out, re.MULTILINE)
            assert estimate["findings"] == axis["findings"] == []
        fit = axis["fit"]
        corner = with_uncertainty(
            fit["bead"]["stiffness"] / DRAG / 2 / math.pi, fit["corner_frequency_uncertainty"], "±"
        )
        assert f"corner frequency {corner} Hz" in outcome.out
    assert Path("k.png").read_bytes().startswith(b"\x89PNG")


def test_command_with_inertia_and_without_a_drag(command_line, positions):
    write_table("mine.csv", positions[:, :1], "t,x")
    assert command_line(
        "calibrate", "mine.csv", *KNOWN, "--density", "2000 kg/m^3", "--out", "k.json"
    ).code == 0  # fmt: skip
    volume = 4 / 3 * math.pi * 0.5e-6**3
    assert json.loads(Path("k.json").read_text())["mass"] == pytest.approx(
        2000 * volume, rel=1e-9, abs=0
    )
    again = ("calibrate", "mine.csv", "--temperature", "293.15", "--out", "k.json", "--overwrite")
    outcome = command_line(*again)
    assert outcome.code == 0
    assert json.loads(Path("k.json").read_text())["drag"] is None
    assert "autocorrelation" not in outcome.out


def test_command_on_a_free_bead_and_on_a_camera(command_line):
    free = np.cumsum(3e-8 * np.random.default_rng(1).standard_normal((1000, 1)), axis=0)
    write_table("free.csv", free, "t,x")
    outcome = command_line("calibrate", "free.csv", "--temperature", "20 degC", "--out", "k.json")
    assert outcome.code == 0
    first, *rest = outcome.out.splitlines()
    assert rest == ["wrote k.json"]
    written = json.loads(Path("k.json").read_text())
    assert "free" in [finding["name"] for finding in written["axes"][0]["findings"]]
    D = with_uncertainty(
        *(1e12 * written["free"][each] for each in ("diffusion", "uncertainty")), "±"
    )  # fmt: skip
    said = f"x: no trap is detected; treated as a free bead: diffusion {D} µm²/s (95 %: "
    assert first.startswith(said)
    assert "; drag " in first
    camera = trapped(STEP, 4000, K, DRAG, None, T, 9, exposure=STEP).T
    write_table("camera.csv", camera, "t,x")
    blind = command_line("calibrate", "camera.csv", *KNOWN)
    assert blind.out.count("not trusted: 1") == 7  # six methods, and the corner frequency
    assert " 1  its positions seem averaged over" in blind.out
    seen = command_line("calibrate", "camera.csv", *KNOWN, "--exposure", f"{STEP} s")
    assert "not trusted" not in seen.out


@pytest.mark.parametrize(
    ("options", "complaint"),
    [([], "mine.csv: requires --temperature"),
     (["--temperature", "20 degC", "--radius", "1 um", "--density", "2000"],
      "mine.csv: --density requires --radius and --viscosity"),
     (["--temperature", "20 degC", "--density", "2000"], "mine.csv: --density requires --radius"),
     (["--temperature", "20 s"], "--temperature '20 s': has the wrong unit"),
     ([*KNOWN, "--skip", "-1"], "--skip '-1': must be from 0"),
     ([*KNOWN, "--skip", "10 s"], "mine.csv: has 0 samples"),
     (["--temperature", "0"], "--temperature '0': must be from 50 to 5000 K"),
     ([*KNOWN, "--exposure", "1 s"], "mine.csv: exposure = 1 s: must be from 0 to the sampling"),
     ([*KNOWN, "--out", "k.nc"], "k.nc: must end in .json")],
)  # fmt: skip
def test_bad_options_are_refused_in_one_line(command_line, positions, options, complaint):
    write_table("mine.csv", positions[:200])
    outcome = command_line("calibrate", "mine.csv", *options)
    assert (outcome.code, outcome.out) == (2, "")
    assert len(outcome.err.splitlines()) == 1
    assert outcome.err.startswith(complaint)


def test_command_on_a_run(command_line, run):
    run["position"][3000:] = np.nan
    save_run(run.assign_attrs(status="lost"), "run.nc")
    outcome = command_line("calibrate", "run.nc")
    assert (outcome.code, outcome.err) == (
        0, "warning: the run is lost: up to 0.2999 s only\n",
    )  # fmt: skip
    outcome = command_line("calibrate", "run.nc", "--temperature", "300 K")
    assert (outcome.code, outcome.err) == (
        2, "run.nc: does not accept the temperature, which its scene has\n",
    )  # fmt: skip


def test_figure_of_one_axis(positions):
    one = Recording(STEP * np.arange(len(positions)), positions[:, :1], ("x",), name="mine")
    figure = calibration_figure(one, tweezer.calibrate(one, temperature=T))
    drawn = {axes.get_title() for axes in figure.axes}
    assert {"trajectory", "mean squared displacement", "potential, from the histogram"} <= drawn
    readable.check(figure)
    (residuals,) = (axes for axes in figure.axes if axes.get_ylabel() == "data / fit")
    ratios = residuals.containers[0].lines[0].get_ydata()
    assert np.median(ratios) == pytest.approx(1, abs=0.15)
    (spectrum,) = (axes for axes in figure.axes if axes.get_ylabel() == "density (m²/Hz)")
    at, density = spectrum.containers[0].lines[0].get_data()
    (curve,) = (line for line in spectrum.lines if line.get_label().startswith("x: "))
    fit = np.exp(np.interp(np.log(at), np.log(curve.get_xdata()), np.log(curve.get_ydata())))
    seen = at < curve.get_xdata()[-1]
    np.testing.assert_allclose(ratios[seen], (density / fit)[seen], rtol=0.01)


def test_figure_of_a_record_too_short_to_show_a_trap(positions):
    few = Recording(STEP * np.arange(150), positions[:150, :1], ("x",), name="mine")
    figure = calibration_figure(few, tweezer.calibrate(few, temperature=T))
    assert figure.get_suptitle() == "Diffusion of mine"
    readable.check(figure)
