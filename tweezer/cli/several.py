"""The command `run` for a scene with several beads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import typer

from tweezer.cli.console import (
    FAILED,
    INTERRUPTED,
    complain,
    showing_progress,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
)
from tweezer.cli.tables import print_shown
from tweezer.results.run import Run
from tweezer.scene import Scene
from tweezer.values.errors import SceneError
from tweezer.values.printed import printed
from tweezer.values.shown import Row


def run_of_several(
    scene: Scene,
    seed: int | None,
    out: Path | None,
    plot: Path | None,
    continue_from: Path | None,
    force: list[str] | None,
    *,
    overwrite: bool,
) -> None:
    """Simulate several beads, print a summary and write the run; see the command `run`."""
    from tweezer.results.io import unlike, write_run

    for name, given in (("continue-from", continue_from), ("force", force)):
        if given:
            raise SceneError(f"--{name}: requires a single bead; omit it")
    out = writable_result(
        out or Path(f"{scene.name}.nc"), ("nc",), overwrite=overwrite,
        obstacle=lambda there: unlike(there, scene, seed or 0, "", ""),
    )  # fmt: skip
    plot = writable_figure(plot, overwrite=overwrite)
    result = followed(scene, seed)
    print_shown(scene.title, list(_rows(scene, result)))
    status, message = result.attributes["status"], result.attributes["message"]
    write_run(result, out)
    tell_written(out)
    if plot:
        from tweezer.plots import beads_figure

        write_figure(beads_figure(result.dataset()), plot)
        tell_written(plot)
    if status in ("failed", "interrupted"):
        complain(f"{scene.name}: {message}; the trajectory so far was saved to {out}")
        raise typer.Exit(FAILED if status == "failed" else INTERRUPTED)


def followed(scene: Scene, seed: int | None) -> Run:
    """Return the run of several beads, with a progress bar."""
    from tweezer.beads.motion import run_of

    with showing_progress(scene.name) as progress:
        return run_of(scene, seed, lambda time: progress(time / scene.simulation.duration))


def _rows(scene: Scene, run: Run) -> Iterator[Row]:
    """Yield the rows of the summary of a run."""
    about = run.attributes
    yield Row("outcome", about["message"] or about["status"])
    if scene.forces.brownian:
        yield Row("seed of the thermal motion", f"{about['seed']}")
        yield Row("step", f"{about['step']:.3g} s")
    else:
        error = printed(about["integration_error"], "um", 1)
        yield Row("error of the integration", f"up to {error}")
    names = run["pair"]
    for k, name in enumerate(names):
        least, mean = run["gap"][:, k].min(), run["distance"][:, k].mean()
        yield Row(f"beads {name}", f"{printed(mean, 'um')} apart on average, gap at least "
                  f"{printed(least, 'nm')}")  # fmt: skip
        if scene.tether or scene.forces.between is not None:
            pull = run["force_between"][:, k].mean()
            yield Row("force between them", f"{printed(pull, 'pN')} on average")
    if not math.isnan(about["model_error"]):
        error = printed(about["model_error"], "nm", 1)
        yield Row("error by the inertia of the fluid", f"up to {error}")
    seconds = f"{about['wall_time']:.2g} s, {about['step_time']:.2g} s of it stepping"
    yield Row("time", seconds)
