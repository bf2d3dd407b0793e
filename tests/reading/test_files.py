"""Recordings as programs of measurement write them: each is read right, or refused with a way out.

The files are written here by NumPy, h5py, SciPy and npTDMS, from positions that are known.
"""

import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
import xarray as xr
from nptdms import ChannelObject, TdmsWriter

import tweezer
from tests.reference.trapped_bead import trapped
from tweezer.reading.filling import filled

N, STEP = 400, 1e-3
T = STEP * np.arange(N)
X, Y = 2e-8 * np.random.default_rng(5).standard_normal((2, N))
PIXEL = 8.58e-8


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def text(heading, *columns, mark=",", decimal=".", before="", end="\n", encoding="utf-8"):
    """A table in text; without a line of headings where `heading` is None."""
    rows = [
        mark.join(f"{value:.10g}".replace(".", decimal) for value in row)
        for row in zip(*columns, strict=True)
    ]
    lines = [*([before] if before else []), *([heading] if heading is not None else []), *rows]
    return lambda path: Path(path).write_bytes((end.join(lines) + end).encode(encoding))


def npy(array):
    return lambda path: np.save(path, array)


def npz(**arrays):
    return lambda path: np.savez(path, **arrays)


def mat(**variables):
    return lambda path: scipy.io.savemat(path, variables)


def matlab_7_3(path):
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in (("t", T), ("bead/x", X), ("bead/y", Y)):
            file[name] = values[None]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
        file["who"] = np.array([[65], [66]], np.uint16)
        file["who"].attrs["MATLAB_class"] = np.bytes_("char")


def tdms(**properties):
    def write(path):
        with TdmsWriter(path) as writer:
            writer.write_segment(
                [ChannelObject("Data", name, 1e9 * values, properties=properties)
                 for name, values in (("QPD X", X), ("QPD Y", Y))]
            )  # fmt: skip

    return write


def lumicks(path):
    """As Bluelake has it: forces in pN, calibrated by 2 pN/V."""
    start, stop = 10**15, 10**15 + N * 10**6
    with h5py.File(path, "w") as file:
        file.attrs.update(
            {"Bluelake version": "2.0", "File format version": 2, "Export time (ns)": 1,
             "Description": "", "Experiment": ""}
        )  # fmt: skip
        for name, volts in (("Force 1x", X), ("Force 1y", Y)):
            channel = file.create_dataset(f"Force HF/{name}", data=2e9 * volts)
            channel.attrs.update(
                {"Kind": "Continuous", "Sample rate (Hz)": 1000, "Start time (ns)": start,
                 "Stop time (ns)": stop}
            )  # fmt: skip
            item = file.create_group(f"Calibration/1/{name}")
            item.attrs.update({"Response (pN/V)": 2.0, "Stop time (ns)": 10**14})
        file["Calibration/1"].attrs["Timestamp (ns)"] = 10**14


TRACKMATE = (
    "LABEL,POSITION_X,POSITION_Y,POSITION_T,FRAME\nLabel,X,Y,T,Frame\n,(micron),(micron),(sec),"
)
LABVIEW = "LabVIEW Measurement\t\nDecimal_Separator\t.\n***End_of_Header***\t\nChannels\t1\t"
FRAMES = np.arange(N)
STAMPS = T + 1.5e-4 * np.random.default_rng(6).uniform(-1, 1, N)


@pytest.mark.parametrize(
    ("name", "write", "options", "axes", "unit"),
    [("a.csv", text("time_s,x_nm", T, 1e9 * X), {}, "x", "m"),
     ("a.csv", text("t/s,x/nm", T, 1e9 * X), {}, "x", "m"),
     ("a.csv", text("Time (ms),X position (nm),Y-Pos [um]", 1e3 * T, 1e9 * X, 1e6 * Y), {}, "xy",
      "m"),
     ("a.csv", text("Elapsed time [s];Bead centre X [um]", T, 1e6 * X, mark=";"), {}, "x", "m"),
     ("a.csv", text("timestamp_ms,posX_um,posY_um", 1e3 * T, 1e6 * X, 1e6 * Y), {}, "xy", "m"),
     ("a.csv", text("seconds,x,y\n# a trap\ns,um,um", T, 1e6 * X, 1e6 * Y), {}, "xy", "m"),
     ("a.csv", text(TRACKMATE, T, 1e6 * X, 1e6 * Y, T, FRAMES), {}, "xy", "m"),
     ("a.csv", text("t,x [um],x_raw [um]", T, 1e6 * X, 1e6 * Y), {}, "x", "m"),
     ("a.csv", text("t,x [um],bead x [um]", T, 1e6 * X, 1e6 * Y), {}, "x", "m"),
     ("a.csv", text("Zeit,Pos A,Pos B", T, 1e6 * X, Y), {"columns": "t=Zeit,x=Pos A [um]"}, "x",
      "m"),
     ("a.csv", text("x1,y1,x2,y2", X, Y, Y, X), {"columns": {"x": 1, "y": 2}, "rate": 1e3},
      "xy", "m"),
     ("a.csv", text("t,x [um],x [nm]", T, 1e6 * X, 1e9 * X), {"columns": "t=t,x=x [nm]"}, "x", "m"),
     ("a.csv", text(None, T, 1e6 * Y, 1e9 * X), {"columns": "t [s],-,x [nm]"}, "x", "m"),
     ("a.csv", text("t,x [um],x [um]", T, 1e6 * X, Y), {"columns": "x=2"}, "x", "m"),
     ("a.csv", text("frame,t [s],x", FRAMES, T // 0.1 / 10, X), {"rate": 1000}, "x", "m"),
     ("a.csv", text("frame,t [furlong],x", FRAMES, T, X), {"rate": 1000}, "x", "m"),
     ("a.csv", text(None, T, 1e9 * X), {"columns": ["t", "x [nm]"]}, "x", "m"),
     ("a.csv", text("t [s];x [nm]", T, 1e9 * X, mark=";", decimal=","), {}, "x", "m"),
     ("a.txt", text(None, T, 1e9 * X, mark=" ", decimal=","), {"columns": "t,x [nm]"}, "x", "m"),
     ("a.dat", text("# t [s]   x [nm]", T, 1e9 * X, mark="   "), {}, "x", "m"),
     ("a.csv", text("time [s]\tx [nm]", T, 1e9 * X, mark="\t", before="Rate\t1000\nDate\tMonday"),
      {}, "x", "m"),
     ("a.txt", text("Time [ms]\tX [µm]", 1e3 * T, 1e6 * X, mark="\t", encoding="utf-16",
                    end="\r\n"), {}, "x", "m"),
     ("a.csv", text("Time [µs],X [µm]", 1e6 * T, 1e6 * X, encoding="latin-1"), {}, "x", "m"),
     ("a.lvm", text("X_Value\tVoltage\tComment", T, 1e9 * X, mark="\t", before=LABVIEW),
      {"columns": "t=X_Value,x=Voltage [nm]"}, "x", "m"),
     ("a.csv", text("frame;x;y", FRAMES, X / PIXEL, Y / PIXEL, mark=";"),
      {"rate": "1000 fps", "scale": "85.8 nm"}, "xy", "m"),
     ("a.csv", text("frame,x (px),y (pixels)", FRAMES, X / PIXEL, Y / PIXEL),
      {"rate": 1000, "scale": f"{1e-6 / PIXEL!r} px/um"}, "xy", "m"),
     ("a.csv", text("t,x", STAMPS, X), {"rate": "1 kHz"}, "x", "m"),
     ("a.csv", text("x [um]", 1e6 * X), {"rate": "1 kHz"}, "x", "m"),
     ("a.csv", text("t [s],QPD X [mV],Voltage Y [mV]", T, X * 1e3, Y * 1e3), {}, "xy", "V"),
     ("a.csv", text("t [s],x voltage,y voltage", T, X, Y), {}, "xy", "V"),
     ("a.csv", text("t [s],x [mV],y [mV]", T, 1e9 * X, 1e9 * Y), {"scale": "1 nm/mV"}, "xy", "m"),
     ("a.csv", text("t [s],x [mV],y [mV]", T, 1e9 * X, 1e9 * Y), {"scale": "1000 mV/um"}, "xy",
      "m"),
     ("a.npy", npy(np.stack([T, 1e6 * X])), {"columns": "t,x [um]"}, "x", "m"),
     ("a.npy", npy(X), {"columns": "x", "rate": 1e3}, "x", "m"),
     ("a.npy", npy(np.rec.fromarrays([T, X], names="time,x")), {}, "x", "m"),
     ("a.npz", npz(t_ms=1e3 * T, x_um=1e6 * X, y=Y, fs=1e3), {}, "xy", "m"),
     ("a.mat", mat(t=T, x=X, y=Y), {}, "xy", "m"),
     ("a.mat", mat(bead={"t": T, "x": X, "fs": 1e3}), {}, "x", "m"),
     ("a.mat", mat(data=np.column_stack([T, 1e6 * X])),
      {"columns": "t=data:1,x=data:2 [um]"}, "x", "m"),
     ("a.mat", matlab_7_3, {}, "xy", "m"),
     ("a.tdms", tdms(wf_increment=STEP, unit_string="nV"), {}, "xy", "V"),
     ("a.tdms", tdms(), {"columns": "x=Data/QPD X [nV],y=QPD Y [nV]", "rate": "1 kHz"}, "xy", "V")],
)  # fmt: skip
def test_read_right(name, write, options, axes, unit):
    write(name)
    recording = tweezer.load_recording(name, **options)
    assert (recording.axes, recording.unit, recording.note) == (tuple(axes), unit, "")
    np.testing.assert_allclose(recording.times - recording.times[0], T, rtol=0, atol=1e-12)
    expected = np.stack([X, Y], axis=1)[:, : len(axes)]
    np.testing.assert_allclose(recording.positions, expected, rtol=1e-8, atol=1e-17)


def test_forces_of_lumicks_are_put_back_into_volts():
    lumicks("a.h5")
    recording = tweezer.load_recording(
        "a.h5", columns="x=Force HF/Force 1x,y=Force HF/Force 1y", scale="1 nm/V"
    )
    np.testing.assert_allclose(recording.positions, np.stack([X, Y], axis=1), rtol=1e-12)
    assert recording.step == pytest.approx(STEP)
    assert recording.note.startswith("Force 1x in pN is divided by its 2 pN/V; Force 1y")


def test_a_waveform_that_is_cut_off_is_said(caplog):
    tdms(wf_increment=STEP, unit_string="nV")("a.tdms")
    content = Path("a.tdms").read_bytes()
    Path("a.tdms").write_bytes(content[:-800])  # of the last 100 samples of y
    recording = tweezer.load_recording("a.tdms", columns="x=QPD X")
    assert recording.note == "its end is missing"
    assert len(recording.times) == N
    assert not caplog.records


def gap(*rows, fill=None):
    """A table that lacks rows, or the numbers of x in them."""
    there = ~np.isin(FRAMES, rows)
    if fill is None:
        return text("t,x", T[there], X[there])
    lines = [
        f"{t:.10g},{x:.10g}" if ok else f"{t:.10g},{fill}"
        for t, x, ok in zip(T, X, there, strict=True)
    ]
    return lambda path: Path(path).write_text("t,x\n" + "\n".join(lines) + "\n")


@pytest.mark.parametrize("fill", [None, "", "NaN", "#N/A", "-"])
def test_a_few_missing_samples_are_filled_in(fill):
    gap(50, 200, fill=fill)("a.csv")
    recording = tweezer.load_recording("a.csv")
    assert recording.note == "samples missing: 2 of 400, filled from the samples around them"
    x, there = recording.positions[:, 0], ~np.isin(FRAMES, [50, 200])
    np.testing.assert_allclose(x[there], X[there], rtol=1e-8)
    assert (np.abs(x[~there]) < 4 * np.std(X)).all()
    np.testing.assert_allclose(recording.times, T, rtol=0, atol=1e-12)


def test_the_stage_is_filled_in_by_straight_lines():
    there = FRAMES != 50
    text("t,x,stage [um]", T[there], X[there], FRAMES[there])("a.csv")
    recording = tweezer.load_recording("a.csv", "stage")
    np.testing.assert_allclose(recording.drive, 1e-6 * FRAMES, rtol=1e-9)


@pytest.mark.parametrize(
    "bead",
    [(1e-8, 1e-4, 1e-15), (1e-4, 1e-5, None), (5e-3, 1e-5, None)],
    ids=["inertial", "diffusive", "slow"],
)
def test_what_is_filled_in_moves_as_the_record_does(bead):
    """Mean squares of x, its steps and their differences, with a fifth of the samples drawn.

    Ten records together: 4 sd (false alarm 1e-4) are 0.02. Straight lines are off by up to 0.3.
    """
    step, k, mass = bead
    rng = np.random.default_rng(7)
    sums = np.zeros((2, 3))
    for whole in trapped(step, 4000, k, 9.4e-9, mass, 293.15, 8, 10):
        there = rng.random(4000) > 0.2
        there[[0, -1]] = True
        for i, x in enumerate((filled(whole, there), whole)):
            sums[i] += [np.sum(np.diff(x, order) ** 2) for order in range(3)]
    np.testing.assert_allclose(sums[0] / sums[1], 1, atol=0.02)


@pytest.mark.parametrize("fill", [None, ""])
def test_of_a_record_with_gaps_the_longest_stretch_is_taken(fill):
    gap(50, *range(100, 112), 399, fill=fill)("a.csv")
    recording = tweezer.load_recording("a.csv")
    np.testing.assert_allclose(recording.times, T[112:399], rtol=0, atol=1e-12)
    np.testing.assert_allclose(recording.positions[:, 0], X[112:399], rtol=1e-8)
    assert (
        "13 of 399; the longest stretch without a gap is used: 287 samples from 0.112"
        in recording.note
    )
    assert ("1 row without numbers at its ends omitted" in recording.note) is (fill is not None)


def test_stamps_in_whole_milliseconds_are_no_gaps():
    """1.4 ms between samples: 0, 1, 3, 4, 6, 7, 8 ms."""
    text("t [ms],x", np.round(1.4 * FRAMES), X)("a.csv")
    with pytest.raises(tweezer.ResultError, match=r'uneven, give the rate: --rate "71\d\.\d Hz"'):
        tweezer.load_recording("a.csv")
    recording = tweezer.load_recording("a.csv", rate=1e3 / 1.4)
    np.testing.assert_allclose(recording.times, 1.4e-3 * FRAMES, rtol=1e-12)


def test_packed_numbers_of_netcdf():
    packed = {"dtype": "int16", "scale_factor": 5e-12, "add_offset": 3e-9, "_FillValue": -9999}
    values = np.where(FRAMES == 30, np.nan, X)
    table = xr.Dataset({"x": ("t", values, {"units": "m"})}, {"t": T})
    table.to_netcdf("a.nc", engine="h5netcdf", encoding={"x": packed})
    recording = tweezer.load_recording("a.nc")
    assert recording.note.startswith("samples missing: 1 of 400")
    there = FRAMES != 30
    np.testing.assert_allclose(recording.positions[there, 0], X[there], rtol=0, atol=3e-12)


@pytest.mark.parametrize("heading", ["t [s],x [um],y [um]", "t [s],x [um],y [um],frame"])
def test_a_rate_that_is_not_that_of_the_times_is_said(heading):
    columns = [T, 1e6 * X, 1e6 * Y, FRAMES][: len(heading.split(","))]
    text(heading, *columns)("a.csv")
    said = "its times have 1000 Hz; 970 Hz is used"
    recording = tweezer.load_recording("a.csv", columns=heading, rate=970)
    assert recording.note == said
    np.testing.assert_allclose(recording.times, FRAMES / 970, rtol=1e-9)
    with pytest.warns(UserWarning, match=f"^a.csv: {said}$"):
        tweezer.load_track("a.csv", columns=heading, rate=970)


def test_a_coordinate_that_does_not_change_is_left_out():
    """TrackMate has z of images too."""
    heading = "POSITION_X,POSITION_Y,POSITION_Z,POSITION_T,FRAME"
    text(heading, X, Y, 0 * X, T, FRAMES)("a.csv")
    recording = tweezer.load_recording("a.csv")
    assert recording.axes == ("x", "y")
    assert recording.note == "z does not change, and is left out"
    with pytest.raises(
        tweezer.ResultError, match="z does not change, so there is nothing to calibrate"
    ):
        tweezer.load_recording("a.csv", columns="x=POSITION_X,z=POSITION_Z")


def test_frames_that_were_dropped_are_a_gap():
    kept = FRAMES[FRAMES != 70]
    text("frame,x [um]", kept, 1e6 * X[kept])("a.csv")
    recording = tweezer.load_recording("a.csv", rate=1000)
    assert len(recording.times) == N
    assert recording.note.startswith("samples missing: 1 of 400, filled from")


def test_a_track_is_read_by_the_same_options():
    text("frame;x;y", FRAMES, X / PIXEL, Y / PIXEL, mark=";")("a.csv")
    track = tweezer.load_track("a.csv", rate="15 Hz", scale="85.8 nm")
    np.testing.assert_allclose(track.times, FRAMES / 15, rtol=1e-12)
    np.testing.assert_allclose(track.positions, np.stack([X, Y], axis=1), rtol=1e-8)


BEADS = text("x,y,frame,particle", 1e6 * X, Y, FRAMES % 200, FRAMES // 200)


@pytest.mark.parametrize(
    ("name", "write", "options", "way"),
    [("a.csv", text("frame;x;y", FRAMES, X, Y, mark=";"), {},
      'give their rate: --rate "... Hz"'),
     ("a.csv", text("t,x_px", T, X / PIXEL), {}, 'give the length of a pixel: --scale "... nm"'),
     ("a.csv", text("t,x", T, X / PIXEL * 100), {},
      "Is its unit missing? For pixels give --scale"),
     ("a.csv", text("t,x [um]", T, X), {"scale": "1 nm"},
      "is in m, and --scale applies to positions in pixels"),
     ("a.csv", text("x [um]", 1e6 * X), {},
      'give the rate of rows at even times: --rate "... Hz"'),
     ("a.csv", text(None, T, X, Y), {}, '--columns "t [s],x [um],y [um]"'),
     ("a.csv", text("Zeit,Pos A", T, X), {}, 'such as --columns "t=Zeit,x=Pos A"'),
     ("a.csv", text("t,x [um],x [nm]", T, X, X), {}, 'such as --columns "x=x [um]"'),
     ("a.csv", text("t,x [um],x [um]", T, X, X), {}, 'such as --columns "x=2"'),
     ("a.csv", text("t,x [um],x [um]", T, X, X), {"columns": "x=x [um]"}, 'such as "x=2"'),
     ("a.csv", text("t [s],y [um],z [um]", T, X, X), {},
      'read it without: --columns "y=y [um],z=z [um]"'),
     ("a.csv", text(None, 1e6 * X, decimal=","), {"columns": "x [um]", "rate": 1000},
      "has 2 columns and no headings, and --columns names 1; name the others -, or, if its "
      "decimals have commas, write them with points"),
     ("a.csv", text("frame,t,x", FRAMES, T, X), {"rate": 100},
      'its times have 1000 Hz, but --rate is 100 Hz; omit --rate, or, if the times are wrong, '
      'name the columns without them: --columns "frame=...,x=..."'),
     ("a.csv", text("t,x", T, X), {"columns": "t=t,x=place"},
      "no column is called 'place' among 't', 'x'"),
     ("a.csv", text("t,x", T, X), {"columns": "t=1,x=9"},
      "x=9: the table has only 2 columns"),
     ("a.csv", text("t [s],x [um]", T, X), {"columns": "t [ms],x"}, "is in ms, and in s"),
     ("a.csv", text("t,x", STAMPS, X), {}, 'give the rate: --rate "999.7 Hz"'),
     ("a.csv", text("t,x", STAMPS, X), {"rate": "50 Hz"}, "its times have 99"),
     ("a.csv", text("t,x", T + 4 * (STAMPS - T), X), {"rate": "1 kHz"},
      '--columns "x=x" --rate "1000 Hz"'),
     ("a.csv", text("t,x", T - 0.0503 * (T > 0.2), X), {},
      'its clock runs backwards; if the rows are in order and evenly spaced, read them without it: '
      '--columns "x=x" --rate "1000 Hz"'),
     ("a.csv", text("t,x", T // 0.005, X), {}, 'stamps repeat; if'),
     ("a.csv", text("t,x", T % 0.2, X), {}, 'such as --columns "bead=ID,..."'),
     ("a.csv", text("t,x", T, X, decimal=","), {}, "decimals need a point, or ; between the cells"),
     ("a.csv", text("t,x\n12:30:01.001,5", T, X), {}, '--columns "x=..." --rate "... Hz"'),
     ("a.csv", BEADS, {"rate": 15}, 'has 2 beads; name the one to be read, such as --bead "0"'),
     ("a.csv", gap(*range(0, 400, 15), fill=""), {},
      "the longest stretch without a gap has 14 samples"),
     ("a.csv", text("frame,x [um]", FRAMES / 7, 1e6 * X), {"rate": 15},
      "frame: must be whole numbers"),
     ("a.xlsx", text("t,x", T, X), {}, "most measurement and spreadsheet programs can save .csv"),
     ("a.npy", npy(np.stack([T, X])), {}, '--columns "t [s],x [um]"'),
     ("a.npz", npz(x=X, fs=1e3), {}, 'fs = 1000 is perhaps the rate of its rows: --rate "1000 Hz"'),
     ("a.mat", mat(d=np.stack([T, X])), {}, '--columns "t=d:1,x=d:2"'),
     ("a.tdms", tdms(), {}, "has no column t among 'Data/QPD X'"),
     ("a.h5", lumicks, {}, '--columns "x=Force HF/Force 1x"'),
     ("a.npy", text("t,x", T, X), {}, "not a NumPy file, or damaged"),
     ("a.npz", text("t,x", T, X), {}, "not a NumPy file, or damaged"),
     ("a.mat", text("t,x", T, X), {}, "not a MATLAB file, or damaged"),
     ("a.tdms", text("t,x", T, X), {}, "not a TDMS file, or damaged")],
)  # fmt: skip
def test_refused_with_the_way_out(name, write, options, way):
    write(name)
    with pytest.raises(tweezer.ResultError) as refusal:
        tweezer.load_recording(name, **options)
    assert str(refusal.value).startswith(name)
    assert len(str(refusal.value).splitlines()) == 1
    assert way in str(refusal.value)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [({"columns": "t,foo"}, "columns: 'foo' is not known; must be t, frame, bead, x, y or z"),
     ({"columns": "t=1,x"}, "must name all columns in their order"),
     ({"columns": "t,t,x"}, "has two columns for t"),
     ({"columns": "t,-"}, "must have x, y or z among them"),
     ({"columns": "x=0"}, "columns are counted from 1"),
     ({"columns": 3}, "columns = 3: must be a text such as"),
     ({"rate": "15 nm"}, "rate = '15 nm': has an unknown unit; must be convertible"),
     ({"rate": 0}, "rate = 0: must be from 1e-06 to 1e.12 1/s"),
     ({"scale": "85.8 kg"}, "scale = '85.8 kg': must be a length such as"),
     ({"scale": "85.8 nm/s"}, "must be a length such as"),
     ({"scale": 0}, "must be a length such as")],
)  # fmt: skip
def test_bad_options(options, complaint):
    with pytest.raises(tweezer.ResultError, match=complaint):
        tweezer.load_recording("a.csv", **options)


@pytest.mark.parametrize(("module", "name"), [("nptdms", "a.tdms"), ("lumicks", "a.h5")])
def test_without_a_reader_the_line_says_how_to_get_it(monkeypatch, module, name):
    (lumicks if module == "lumicks" else tdms())(name)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(tweezer.ResultError, match=r'pip install "tweezer\[recordings\]"'):
        tweezer.load_recording(name)


def test_options_are_not_for_a_run():
    with pytest.raises(
        tweezer.ResultError, match="is a run of tweezer, to which --rate does not apply"
    ):
        tweezer.load_recording(xr.Dataset(attrs={"title": "mine"}), rate=15)


def test_command(command_line):
    text("frame;x;y", FRAMES, X / PIXEL, Y / PIXEL, mark=";")("a.csv")
    known = ["--temperature", "20 degC"]
    refused = command_line("calibrate", "a.csv", *known)
    assert (refused.code, refused.err) == (
        2,
        'a.csv: has frames and no times; give their rate: --rate "... Hz"\n',
    )
    done = command_line(
        "calibrate", "a.csv", *known, "--rate", "1 kHz", "--scale", "85.8 nm",
        "--columns", "frame=1,y=3",
    )  # fmt: skip
    assert done.code == 1  # too short to be trusted
    assert "y: stiffness by" in done.out


@pytest.mark.parametrize(
    "order",
    [FRAMES[::-1], np.random.default_rng(3).permutation(N), np.roll(FRAMES, 150)],
    ids=["descending", "shuffled", "blocks"],
)
@pytest.mark.parametrize("stamp", ["t", "frame"])
def test_rows_are_sorted_by_their_stamps(order, stamp):
    stamps = T if stamp == "t" else FRAMES
    text(f"{stamp},x", stamps[order], X[order])("a.csv")
    recording = tweezer.load_recording("a.csv", rate=None if stamp == "t" else 1000)
    np.testing.assert_allclose(recording.positions[:, 0], X, rtol=1e-8)
    assert recording.note == "rows sorted by time"


def test_sorted_frames_keep_their_gap():
    order = np.random.default_rng(4).permutation(FRAMES[FRAMES != 70])
    text("frame,x [um]", order, 1e6 * X[order])("a.csv")
    recording = tweezer.load_recording("a.csv", rate=1000)
    there = FRAMES != 70
    np.testing.assert_allclose(recording.positions[there, 0], X[there], rtol=1e-8)
    assert recording.note.startswith("rows sorted by time; samples missing: 1 of 400, filled from")


def test_rows_that_repeat_others_are_left_out():
    """Two parts of a record that overlap by 50 rows."""
    rows = np.concatenate([FRAMES[:250], FRAMES[200:]])
    text("t,x", T[rows], X[rows])("a.csv")
    recording = tweezer.load_recording("a.csv")
    np.testing.assert_allclose(recording.positions[:, 0], X, rtol=1e-8)
    assert recording.note == "50 rows that repeat another one omitted"


def test_rows_in_another_order_are_not_read_at_a_rate():
    order = np.random.default_rng(5).permutation(FRAMES)
    text("frame,x,y", order, X[order], Y[order])("a.csv")
    with pytest.raises(tweezer.ResultError, match=r"not in the order of its column 'frame'; read "):
        tweezer.load_recording("a.csv", columns="x=x,y=y", rate=1000)
    text("x,y,t", X, Y, T - 0.0503 * (T > 0.2))("a.csv")  # a clock that is set back once
    assert len(tweezer.load_recording("a.csv", columns="x=x,y=y", rate=1000).times) == N


SPOTS = np.arange(2 * N)


@pytest.mark.parametrize(
    ("heading", "labels"),
    [("particle", SPOTS % 2), ("TRACK_ID", SPOTS // N),
     ("Bead", np.array(["left", "B2"])[SPOTS % 2]),
     ("Trajectory number", np.where(SPOTS % 2, 7.0, 3.0))],
    ids=["in turn", "one after the other", "names", "numbers"],
)  # fmt: skip
def test_one_bead_of_several_is_read(heading, labels):
    first = str(labels[0]).removesuffix(".0")
    mine = labels == labels[0]
    frames = np.where(mine, np.cumsum(mine), np.cumsum(~mine)) - 1
    lines = [f"frame,x,{heading}"]
    lines += [
        f"{f},{X[f] if a else Y[f]:.9g},{b}" for f, a, b in zip(frames, mine, labels, strict=True)
    ]
    Path("a.csv").write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(tweezer.ResultError, match=f'has 2 beads; .* --bead "{first}"'):
        tweezer.load_recording("a.csv", rate=1000)
    recording = tweezer.load_recording("a.csv", rate=1000, bead=first)
    np.testing.assert_allclose(recording.positions[:, 0], X, rtol=1e-8)
    with pytest.raises(tweezer.ResultError, match="bead = 'none': is not in the column"):
        tweezer.load_recording("a.csv", rate=1000, bead="none")


def nested(name, **others):
    """Time and position in a group, and other datasets."""
    with h5py.File(name, "w") as file:
        file["0/data/time"], file["0/data/xBead"] = T, 1e6 * X
        file["0/data/xBead"].attrs["units"] = "um"
        for path, values in others.items():
            file[path.replace("__", "/")] = values


@pytest.mark.parametrize(
    "others",
    [{"meta__beadId": np.frombuffer(b"bead 12", np.uint8)},  # letters by their codes
     {"meta__particle": SPOTS[:N] % 3},  # as long as the record, in another group
     {"meta__time": T[:9], "1__time": T, "1__x": X}, {"meta__frame": FRAMES[:7]},
     {"meta__particle": "bead 12", "x": np.zeros((3, 4, 5))}],
    ids=["letters", "another group", "another time", "frames", "text"],
)  # fmt: skip
def test_only_named_columns_of_a_file_count(others):
    nested("a.h5", **others)
    recording = tweezer.load_recording("a.h5", columns="x=0/data/xBead")
    np.testing.assert_allclose(recording.positions[:, 0], X, rtol=1e-9)
    np.testing.assert_allclose(recording.times, T, rtol=0, atol=1e-12)


def test_other_columns_of_a_text_do_not_count():
    lines = ["t;x;note;bead id", *(f"{t:.9g};{x:.9g};1,5;" for t, x in zip(T, X, strict=True))]
    lines[1] += "bead 12"
    Path("a.csv").write_text("\n".join(lines), encoding="utf-8")
    recording = tweezer.load_recording("a.csv", columns="t=t,x=x")
    np.testing.assert_allclose(recording.positions[:, 0], X, rtol=1e-8)


def test_a_structure_of_matlab_beside_the_record():
    meta = {"particle": np.array([4.0, 5.0, 6.0]), "time": T[:4]}
    mat(rec={"t": T, "x_um": 1e6 * X}, meta=meta)("a.mat")
    recording = tweezer.load_recording("a.mat", columns="t=rec.t,x=rec.x_um [um]")
    np.testing.assert_allclose(recording.positions[:, 0], X, rtol=1e-9)


@pytest.mark.parametrize(
    "heading",
    ["f [Hz],PSD X [V^2/Hz]", "Frequency (kHz),Power (nm²/Hz)", "frequency;amplitude [V/sqrt(Hz)]",
     "freq_Hz,Pxx", "Hz [Hz],S_x [m^2/Hz],S_y [m^2/Hz]", "f,x [V/√Hz]",
     "Frequency,X,Y\nHz,V^2/Hz,V^2/Hz", "Frequency (Hz),Magnitude (dB)"],
)  # fmt: skip
@pytest.mark.parametrize("options", [{}, {"columns": "t=1,x=2"}, {"columns": "x=2", "rate": 1000}])
def test_table_of_a_spectrum_is_refused_as_such(heading, options):
    """A table of another kind is not answered as if a column had the wrong name."""
    columns = heading.split("\n")[0].count(",") + heading.count(";") + 1
    text(heading, *[FRAMES + 1.0] * columns, mark=";" if ";" in heading else ",")("a.csv")
    with pytest.raises(
        tweezer.ResultError, match=r"is a spectrum: .* requires the recording itself"
    ):
        tweezer.load_recording("a.csv", **options)


def test_a_spectrum_beside_a_recording_does_not_matter():
    text("f [Hz],PSD [V^2/Hz],x [um]", FRAMES, FRAMES, 1e6 * X)("a.csv")
    recording = tweezer.load_recording("a.csv", columns="x=x [um]", rate=1000)
    np.testing.assert_allclose(recording.positions[:, 0], X, rtol=1e-8)
    text("t [s],PSD X [V]", T, X)("b.csv")  # a position-sensitive detector
    np.testing.assert_allclose(tweezer.load_recording("b.csv").positions[:, 0], X, rtol=1e-8)
