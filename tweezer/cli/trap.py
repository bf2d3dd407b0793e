"""The commands `tweezer trap` and `tweezer tune`."""

from __future__ import annotations

import dataclasses
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import (
    Changes,
    Details,
    FigureFile,
    JsonFile,
    Overwrite,
    OwnForces,
    Quiet,
    SceneName,
    app,
    bind_light,
    quantity_in,
    scene_with,
    settings_of,
    warn_of_rays,
)
from tweezer.cli.console import (
    INTERRUPTED,
    begin,
    complain,
    say,
    showing_progress,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
    write_result,
)
from tweezer.cli.tables import (
    print_card,
    print_rows,
    print_shown,
    print_table,
)
from tweezer.values.errors import PhysicsWarning, SceneError, TweezerError
from tweezer.values.prefixes import per
from tweezer.values.printed import in_unit
from tweezer.values.rounding import micrometres, three

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.scene import Scene


@app.command()
def trap(
    scene: SceneName,
    heights: Annotated[
        tuple[str, str] | None,
        typer.Option(
            help='Lowest and highest focus above the wall, e.g. "1 um" "10 um". Compute stiffness, '
            "equilibrium and drag at each height."
        ),
    ] = None,
    count: Annotated[
        int | None, typer.Option(help="Number of heights. Default: 19.", min=1, max=10_000)
    ] = None,
    set: Changes = None,
    force: OwnForces = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "--json",
            help='JSON file to write; "-" prints only this file. With --heights, a NetCDF file.',
        ),
    ] = None,
    plot: FigureFile = None,
    overwrite: Overwrite = False,
    details: Details = False,
    quiet: Quiet = False,
) -> None:
    """Characterise the trap of SCENE.

    The command prints the equilibrium, trap stiffness, escape force, well depth, range, lifetime
    and efficiencies. With --heights it prints how the trap depends on the height above a wall.
    """
    begin(details=details, quiet=quiet)
    described = scene_with(scene, settings_of(set or []))
    out = out and writable_result(out, ("nc",) if heights else ("json",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)
    if force and (heights or plot):
        option = "--heights" if heights else "--plot"
        raise SceneError(f"--force: cannot be combined with {option}")
    if heights:
        _trap_over(described, heights, count or 19, out, plot)
        return
    if count is not None:
        raise SceneError("--count: requires --heights")
    bind_light(described)

    with showing_progress(described.name):
        from tweezer.trap import Trap, characterise

        characterised = characterise(described, forces=force or [])
        if isinstance(characterised, Trap):
            _ = characterised.lifetime  # computed on first use
    print_card(characterised.card())
    if not force:
        _print_time_sharing(described)
    if out:
        from tweezer.results.saving import content_of

        write_result(content_of(characterised), out)
    if plot:
        from tweezer.plots import body_trap_figure, trap_figure

        if isinstance(characterised, Trap):
            figure = trap_figure(described, characterised)
        else:
            figure = body_trap_figure(described, characterised)
        write_figure(figure, plot)
    tell_written(out, plot)


def _print_time_sharing(scene: Scene) -> None:
    """Print how the trap of light that repeats differs from the trap of its averaged force."""
    from tweezer.trap.time_sharing import repeats, time_sharing

    if not repeats(scene):
        return
    try:
        card = time_sharing(scene).card()
        print_shown(card.title, card.rows)
    except TweezerError as error:
        say(f"time sharing: {error}")


def _trap_over(
    scene: Scene, ends: tuple[str, str], count: int, out: Path | None, plot: Path | None
) -> None:
    """Compute the trap at several heights of the focus; print, write and draw it.

    If it is interrupted, the heights computed so far are printed and written. `ends` are the lowest
    and highest height.
    """
    from tweezer.values.units import PositiveLength

    low, high = (quantity_in("--heights", text, PositiveLength) for text in ends)
    if count == 1 and low != high:
        raise SceneError(f"--count 1: heights from {ends[0]} to {ends[1]} require 2 or more")
    step = (high - low) / max(count - 1, 1)
    warn_of_rays(scene)
    with (
        showing_progress(scene.name) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # shown above
    ):
        from tweezer.trap import trap_over_heights

        found = trap_over_heights(scene, [low + i * step for i in range(count)], progress=progress)
    _print_heights(found)
    if out:
        from tweezer.results.io import save_run

        save_run(found, out)
    if plot and found.sizes["height"]:
        from tweezer.plots import heights_figure

        write_figure(heights_figure(found), plot)
    tell_written(out, plot)
    if found.attrs["status"] == "interrupted":
        complain(f"{scene.name}: interrupted after {found.sizes['height']} of {count} heights")
        raise typer.Exit(INTERRUPTED)


@app.command()
def tune(
    scene: SceneName,
    factor: Annotated[
        list[float] | None,
        typer.Option(
            help="Scaling factor. May be repeated. Default: from epsilon to 1.", metavar="A2"
        ),
    ] = None,
    duration: Annotated[
        str | None,
        typer.Option(
            help='Duration of the compared runs, s or e.g. "1 ms". Default: that of SCENE.'
        ),
    ] = None,
    deviation: Annotated[
        str, typer.Option(help="Allowed deviation from the unscaled bead.")
    ] = "10 nm",
    method: Annotated[str, typer.Option(help="Method of the scaled runs.")] = "dormand-prince",
    set: Changes = None,
    out: JsonFile = None,
    plot: FigureFile = None,
    overwrite: Overwrite = False,
    details: Details = False,
    quiet: Quiet = False,
) -> None:
    """Compare scaled and unscaled motion of SCENE.

    This is the thesis's search for a scaling factor a2, for a list of factors.
    """
    from tweezer.values.units import PositiveLength

    begin(details=details, quiet=quiet)
    described = scene_with(scene, settings_of(set or [], duration=duration))
    allowed = quantity_in("--deviation", deviation, PositiveLength)
    out = out and writable_result(out, ("json",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)

    from tweezer.runs.tuning import scaled_scenes
    from tweezer.runs.tuning import tune as compared

    scaled_scenes(described, factor, method)  # to raise errors before the light is computed
    bind_light(described)
    with showing_progress(described.name) as progress:
        tuning = compared(described, factor, method=method, progress=progress)
    print_table(tuning.table())
    most = tuning.most_scaling_within(allowed)
    found = "none of these a2" if most is None else f"a2 down to {most.scaling_factor:.3g}"
    say(f"within {deviation}: {found}; the thesis's first guess, epsilon: {tuning.epsilon:.3g}")
    if out:
        write_result(dataclasses.asdict(tuning), out)
    if plot:
        from tweezer.plots import tuning_figure

        write_figure(tuning_figure(tuning, described.title), plot)
    tell_written(out, plot)


def _print_heights(found: xr.Dataset) -> None:
    """Print a table of the trap with one row for each height."""
    rows = [
        ["height, um", "equilibrium, um", "gap, um", "stiffness (x, y, z), pN/um",
         "drag across, along, times", "corner frequencies, Hz"]
    ]  # fmt: skip
    for at in (found.isel(height=i) for i in range(found.sizes["height"])):
        first = micrometres(float(at["height"]))
        if (state := str(at["state"].values)) != "held":
            rows.append([first, state, *4 * [""]])
            continue
        x, y, z = at["equilibrium"].values
        across, _, along = at["drag"].values / found["free_drag"].values
        rows.append([
            first,
            micrometres(z) if x == y == 0 else ", ".join(map(micrometres, (x, y, z))),
            in_unit(float(at["gap"]), "um"),
            three(*(per("pN/um") * at["stiffness"].values)),
            f"{across:.4g}, {along:.4g}",
            three(*at["corner_frequency"].values),
        ])  # fmt: skip
    print_rows(rows)
