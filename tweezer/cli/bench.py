"""The commands of `tweezer bench`, which measure speed and errors."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Annotated

import typer

from tweezer.cli.app import FigureFile, JsonFile, Quiet, app
from tweezer.cli.console import (
    ERR,
    FIGURE_FORMATS,
    begin,
    tell_written,
    writable,
    write_figure,
)
from tweezer.cli.tables import print_rows
from tweezer.values.errors import TweezerError

bench = typer.Typer(
    help="Measure speed and errors (in a checkout).", no_args_is_help=True, rich_markup_mode=None
)


app.add_typer(bench, name="bench")


def _add_benchmark(name: str, report_name: str, told: str) -> None:
    """Add the command `tweezer bench NAME`, which runs a benchmark and prints its report.

    `name` and `report_name` are modules of tests/benchmarks, and `told` is the help of the command.
    """

    @bench.command(name, help=told)
    def measured(
        quick: Annotated[
            bool,
            typer.Option("--quick", help="Run a short version, to test that the benchmark works."),
        ] = False,
        out: JsonFile = None,
        plot: FigureFile = None,
        quiet: Quiet = False,
    ) -> None:
        begin(quiet=quiet)
        benchmark, report = _benchmark(name), _benchmark(report_name)
        out = out and writable(out, ("json",))
        plot = plot and writable(plot, FIGURE_FORMATS)
        with ERR.status(name) as status:
            results = benchmark.measure(quick=quick, say=status.update)
        for table in report.tables(results):
            print_rows(table)
        if out:
            from tweezer.results.io import write_json  # here, because it imports xarray

            write_json(results, out)
        if plot:
            write_figure(report.figure(results), plot)
        tell_written(out, plot)


_add_benchmark(
    "force", "report",
    "Optical force: error against time. Grid, quadrature, map, and a sum in NumPy.",
)  # fmt: skip


_add_benchmark(
    "bodies", "bodies_report",
    "Light on bodies: error against time. Spheroids, clusters and their T-matrices; treams.",
)  # fmt: skip


_add_benchmark(
    "rods", "rods_report",
    "Hops, flips and distributions of rods. In exact light; rotation alone.",
)  # fmt: skip


_add_benchmark(
    "integrate", "integrate_report",
    "Integration: error against time. Own methods, SciPy, CVODE, others, the thesis's scaling.",
)  # fmt: skip


_add_benchmark(
    "brownian", "brownian_report",
    "Thermal motion: speed and bias. By step and cost; scaling and memory.",
)  # fmt: skip


_add_benchmark(
    "scaling", "scaling_report",
    "Ensembles on clusters: costs. Blocks, files and tasks, and a model of clusters.",
)  # fmt: skip


_add_benchmark(
    "depth", "depth_report",
    "Depth from tracks: coverage and bias. Release heights from tracks in the plane.",
)  # fmt: skip


_add_benchmark(
    "fluid", "fluid_report",
    "Fluid inertia: error against poles. Force calls of captures, thermal steps.",
)  # fmt: skip


_add_benchmark(
    "wall", "wall_report",
    "Thermal motion beside a wall: bias. First passage, inertia, step rates.",
)  # fmt: skip


_add_benchmark(
    "calibrate", "calibrate_report",
    "Calibration: coverage and findings. Simulated traps with known stiffness.",
)  # fmt: skip


_add_benchmark(
    "hydro", "hydro_report",
    "Calibration of fast recordings: bias. Fluid inertia, detectors, a driven stage; pylake.",
)  # fmt: skip


_add_benchmark(
    "sweep", "sweep_report",
    "Sweeps: time, and bytes after kills. Two processes, and Dask workers.",
)  # fmt: skip


_add_benchmark(
    "view", "view_report",
    "Pages: size, time to write, frame rate. Pages of a run and an ensemble, in Chromium.",
)  # fmt: skip


_add_benchmark(
    "heights", "heights_report",
    "Calibration beside a wall: coverage. At given heights, and with a fitted wall position.",
)  # fmt: skip
_add_benchmark(
    "fit", "fit_report",
    "Fits of a scene to recordings: coverage. Size and power, and findings for other keys.",
)  # fmt: skip


_add_benchmark(
    "camera", "camera_report",
    "Calibration of camera tracks: coverage. Simulated tracks with full exposure and noise.",
)  # fmt: skip


_add_benchmark(
    "free", "free_report",
    "Free beads: coverage of the diffusion. Tracks with blur, noise and drift.",
)  # fmt: skip


_add_benchmark(
    "diagram", "diagram_report",
    "Trapping diagram: depth and lifetime. Size against power; minimum powers; ensembles.",
)  # fmt: skip


_add_benchmark(
    "commands", "commands_report",
    "Commands: time, cold and warm. With empty caches, in a typical order, and the first page.",
)  # fmt: skip


def _benchmark(name: str) -> ModuleType:
    """Import a module of tests/benchmarks, which exists only in a checkout of the sources."""
    root = Path(__file__).parents[2]
    if not (root / "tests" / "benchmarks" / f"{name}.py").is_file():
        raise TweezerError("bench: requires a checkout of tweezer's sources")
    sys.path.insert(0, str(root))
    return importlib.import_module(f"tests.benchmarks.{name}")
