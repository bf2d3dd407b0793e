"""Datasets and files by the CF Conventions: what made them, units, names, whose error is whose."""

import json
import re

import h5netcdf
import numpy as np
import pint
import pytest
import xarray as xr

import tweezer

SCENE = tweezer.load_scene("thesis-990nm").replace(
    start={"frame": "focus", "position": [1e-7, 0, 0]}, simulation={"samples": 40}
)
THERMAL = SCENE.replace(
    forces={"brownian": True, "optical": False},
    simulation={"model": "overdamped", "method": "auto"},
)


def datasets(folder):
    """A result of every kind, and as it is read from its file."""
    run = tweezer.simulate(SCENE, "10 us")
    yield "simulate", run
    yield "simulate", tweezer.load_run(tweezer.save_run(run, folder / "run.nc"))
    kind = {"duration": "20 us", "workers": 1}
    yield "ensemble", tweezer.ensemble(THERMAL, 3, out=folder / "e.zarr", **kind)
    yield "ensemble", xr.open_zarr(folder / "e.zarr")
    yield "ensemble", tweezer.ensemble(THERMAL, 3, statistics=True, **kind)
    powers = {"beam.power": ["20 mW", "30 mW"]}
    dark = SCENE.replace(forces={"optical": False})
    yield "sweep", tweezer.sweep(dark, powers, of="run", workers=1, out=folder / "s.zarr")
    yield "sweep", xr.open_zarr(folder / "s.zarr")
    yield "wall_mobilities", tweezer.wall_mobilities([0.1, 1.0])


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_every_dataset_says_what_it_is(tmp_path):
    registry = pint.UnitRegistry()
    for made_by, found in datasets(tmp_path):
        assert found.attrs["Conventions"] == "CF-1.11"
        assert found.attrs["title"]
        told = f"tweezer {tweezer.__version__}: {made_by}"
        assert found.attrs["history"].endswith(told)
        dated = re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00: .*", found.attrs["history"])
        # of a store there is no time: killed and resumed it has the same bytes
        assert bool(dated) == (made_by not in ("ensemble", "sweep"))
        for variable in found.variables.values():
            assert variable.attrs["long_name"]
            if variable.dtype.kind == "f":
                registry.Unit(variable.attrs["units"])
        errors = {name for name in found.data_vars if str(name).endswith("_error")}
        tied = {each.attrs.get("ancillary_variables") for each in found.data_vars.values()}
        assert errors == tied - {None}


def test_a_file_has_what_the_conventions_want(tmp_path):
    """As h5netcdf reads it: a fill value for variables, none for coordinates."""
    from tweezer.results.io import write_run
    from tweezer.runs.simulation import motion_of

    run, find_errors = motion_of(SCENE.replace(simulation={"duration": 1e-5}))
    find_errors()
    write_run(run, tmp_path / "a.nc")
    tweezer.save_run(run.dataset(), tmp_path / "b.nc")
    for name in ("a.nc", "b.nc"):
        with h5netcdf.File(tmp_path / name) as file:
            assert "_FillValue" not in file.variables["time"].attrs
            assert np.isnan(file.variables["position"].attrs["_FillValue"])
            assert file.variables["optical_force"].attrs["ancillary_variables"] == "force_error"
            assert json.loads(file.attrs["scene"])
