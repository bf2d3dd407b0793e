"""The command `tweezer detect`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tweezer.cli.app import Changes, Overwrite, Quiet, SceneName, app, scene_with, settings_of
from tweezer.cli.console import begin, showing_progress, tell_written, writable_result
from tweezer.cli.tables import print_shown, print_table
from tweezer.values.rounding import micrometres
from tweezer.values.shown import Row, Table

if TYPE_CHECKING:
    import xarray as xr

#: Signals, as a part of the largest, and lengths, m, that are rounding
_ROUNDING, _SHORT = 1e-10, 1e-14


@app.command()
def detect(
    scene: SceneName,
    set: Changes = None,
    out: Annotated[Path | None, typer.Option(help="NetCDF file to write.")] = None,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Describe the signals of SCENE's detector.

    The command prints the slope, linear range, crosstalk and shot noise of each signal of the
    photodiode, for a bead at its stable equilibrium.
    """
    begin(quiet=quiet)
    described = scene_with(scene, settings_of(set or []))
    out = out and writable_result(out, ("nc",), overwrite=overwrite)
    with showing_progress(described.name):
        from tweezer.optics.detected import detect as detected

        found = detected(described)
    at_rest = ", ".join(map(micrometres, found["rest"].values))
    print_shown(described.name, [Row("at rest", f"{at_rest} um from the focus")])
    print_table(_table(found))
    if out:
        from tweezer.results.io import save_run

        save_run(found, out)
    tell_written(out)


def _table(found: xr.Dataset) -> Table:
    """Return the table of the signals at rest, and how they depend on the position."""
    channels = [str(name) for name in found["channel"].values]
    of = {name: found.sel(channel=name) for name in channels}
    least = _ROUNDING * float(abs(found["signal"]).max())
    rows = [
        ("signal, mW", *(f"{1e3 * _above(each['signal'], least):.4g}" for each in of.values())),
        ("slope along its axis, mW/um", *(
            f"{1e-3 * float(each['slope'].sel(axis=name)):.4g}" for name, each in of.items()
        )),
        ("linear within 5 % to, nm", *(
            f"{1e9 * float(each['linear_range']):.4g}" for each in of.values()
        )),
        *(
            (f"apparent for 100 nm along {axis}, nm", *(
                f"{1e9 * _above(each['crosstalk'].sel(axis=axis), _SHORT):.4g}"
                for each in of.values()
            ))
            for axis in found["axis"].values
        ),
        ("shot noise, pm/sqrt(Hz)", *(
            f"{1e12 * float(each['shot_noise']):.3g}" for each in of.values()
        )),
        ("part of the information, %", *(
            f"{100 * float(each['information']):.3g}" for each in of.values()
        )),
    ]  # fmt: skip
    return Table(("signal of", *channels), tuple(rows))


def _above(value: Any, least: float) -> float:
    """Return a value, or 0 if its size is below `least`, which is rounding."""
    number = float(value)
    return number if abs(number) >= least else 0.0
