"""Commands on a trap at rest and on scaling: trap, tune."""

from __future__ import annotations

import dataclasses
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import (
    Changes,
    FigureFile,
    JsonFile,
    SceneName,
    app,
    bind_light,
    quantity_in,
    scene_with,
    settings_of,
)
from tweezer.cli.console import (
    FIGURE_FORMATS,
    INTERRUPTED,
    OUT,
    complain,
    show_warning,
    showing_progress,
    tell_written,
    writable,
    write_figure,
    write_json,
)
from tweezer.cli.tables import (
    located,
    micrometres,
    print_rows,
    table_of,
    theory_of,
    three,
    time_taken,
)
from tweezer.errors import PhysicsWarning, SceneError

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.analysis import Efficiency, Escape, Trap
    from tweezer.equilibria import Equilibrium
    from tweezer.scene import Scene

#: Part of the stiffness below which one across the axes is not shown
_NEGLIGIBLE = 1e-6


@app.command()
def trap(
    scene: SceneName,
    heights: Annotated[
        tuple[str, str] | None,
        typer.Option(
            help='Heights of the focus above the wall: "1 um" "10 um". Stiffness, equilibrium and '
            "drag at each."
        ),
    ] = None,
    count: Annotated[
        int | None, typer.Option(help="How many heights; 19 if not given.", min=1, max=10_000)
    ] = None,
    set: Changes = None,
    out: Annotated[Path | None, typer.Option(help="JSON file to write; of heights NetCDF.")] = None,
    plot: FigureFile = None,
) -> None:
    """Characterise the trap of SCENE.

    Equilibrium, stiffness, escape, range, lifetime, efficiencies; or what changes with the height
    above a wall.
    """
    described = scene_with(scene, settings_of(set or []))
    out = out and writable(out, ("nc",) if heights else ("json",))
    plot = plot and writable(plot, FIGURE_FORMATS)
    if heights:
        _trap_over(described, heights, count or 19, out, plot)
        return
    if count is not None:
        raise SceneError("--count: goes with --heights")
    bind_light(described)

    from tweezer.analysis import characterise

    characterised = characterise(described)
    _print_trap(described, characterised)
    if out:
        _write_trap(described, characterised, out)
    if plot:
        from tweezer.plots import trap_figure

        write_figure(trap_figure(described, characterised), plot)
    tell_written(out, plot)


def _trap_over(
    scene: Scene, ends: tuple[str, str], count: int, out: Path | None, plot: Path | None
) -> None:
    """The trap over heights: table, file, figure; of an interrupted one what was reached."""
    from tweezer.optics import ray_optics_caveat
    from tweezer.units import PositiveLength

    low, high = (quantity_in("--heights", text, PositiveLength) for text in ends)
    step = (high - low) / max(count - 1, 1)
    if caveat := ray_optics_caveat(scene):
        show_warning(caveat)
    with (
        showing_progress(scene.name, 1.0) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # said above
    ):
        from tweezer.analysis import trap_over_heights

        found = trap_over_heights(scene, [low + i * step for i in range(count)], progress=progress)
    _print_heights(found)
    if out:
        from tweezer.io import save_run

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
            help="A scaling factor; may be repeated. From epsilon to 1 if none.", metavar="A2"
        ),
    ] = None,
    duration: Annotated[
        str | None, typer.Option(help='Time compared over: "1 ms", or seconds.')
    ] = None,
    deviation: Annotated[
        str, typer.Option(help="Deviation from the unscaled bead that is allowed.")
    ] = "10 nm",
    method: Annotated[str, typer.Option(help="Method of the scaled runs.")] = "dormand-prince",
    set: Changes = None,
    out: JsonFile = None,
    plot: FigureFile = None,
) -> None:
    """Scaled against unscaled motion of SCENE.

    For a list of a2: the thesis's search.
    """
    from tweezer.units import PositiveLength

    described = scene_with(scene, settings_of(set or [], duration=duration))
    allowed = quantity_in("--deviation", deviation, PositiveLength)
    out = out and writable(out, ("json",))
    plot = plot and writable(plot, FIGURE_FORMATS)

    from tweezer.analysis.tuning import scaled_scenes
    from tweezer.analysis.tuning import tune as compared

    scaled_scenes(described, factor, method)  # errors before the light is bound
    bind_light(described)
    with showing_progress(described.name, 1.0) as progress:
        tuning = compared(described, factor, method=method, progress=progress)
    table = table_of("a2", "off the unscaled bead", "steps", "force calls", "time")
    for entry in [*tuning.entries, tuning.unscaled]:
        first = "unscaled" if entry is tuning.unscaled else f"{entry.scaling_factor:.3g}"
        off = "failed"
        if entry.deviation is not None:
            off = located(entry.deviation, entry.deviation_error, 1e6, "um")
        table.add_row(
            first, off, f"{entry.steps}", f"{entry.force_calls}", time_taken(entry.seconds)
        )
    OUT.print(table)
    most = tuning.most_scaling_within(allowed)
    found = "none of these a2" if most is None else f"a2 down to {most.scaling_factor:.3g}"
    OUT.print(
        f"within {deviation}: {found}; the thesis's first guess, epsilon: {tuning.epsilon:.3g}",
        highlight=False, soft_wrap=True,
    )  # fmt: skip
    if out:
        write_json(dataclasses.asdict(tuning), out)
    if plot:
        from tweezer.plots import tuning_figure

        write_figure(tuning_figure(tuning, described.title), plot)
    tell_written(out, plot)


def _print_trap(scene: Scene, characterised: Trap) -> None:
    from tweezer.optics.worth import between

    table = table_of(scene.name, "")
    power = f"{1e3 * characterised.power_through_pupil:.4g} mW"
    if characterised.fraction_through_pupil is not None:
        power += f", {100 * characterised.fraction_through_pupil:.4g} % of the beam"
    table.add_row("power through the pupil", power)
    if scene.plain:
        table.add_row("backward Q, largest", _efficiency(characterised.backward_efficiency))
        table.add_row("lateral Q, largest", _efficiency(characterised.lateral_efficiency))
    place, frequencies = characterised.equilibrium, characterised.corner_frequencies
    if place is None or frequencies is None:
        on_wall = "; it rests on the wall" if characterised.rests else ""
        table.add_row("equilibrium", f"no stable equilibrium{on_wall}")
    else:
        (kx, kxy, _), (kyx, ky, _), (_, _, kz) = place.stiffness
        worth = characterised.ray_optics
        doubt = "" if worth is None or worth.trusted else ", not to be trusted"
        where = f"z = {micrometres(place.position[2])} um, {doubt[2:] or 'on the axis'}"
        table.add_row("stable equilibrium", where if scene.plain else f"{_where(place)}{doubt}")
        if worth and worth.equilibrium_shift:
            low, high = (f"{1e6 * shift:+.2g}" for shift in worth.equilibrium_shift)
            table.add_row("  by wave optics", f"{low} to {high} um from there")
        stiffness = three(1e6 * kx, 1e6 * ky, 1e6 * kz)
        table.add_row("stiffness (x, y, z)", f"{stiffness} pN/um{doubt}")
        if abs(kxy + kyx) > _NEGLIGIBLE * kx:
            table.add_row("stiffness, xy", f"{1e6 * (kxy + kyx) / 2:.4g} pN/um{doubt}")
        if abs(place.turn) > _NEGLIGIBLE * kx:
            turn = f"{1e6 * place.turn:.4g} pN/um, (dFy/dx - dFx/dy)/2"
            table.add_row("push round the axis", turn)
        if worth and worth.stiffness_across:
            across, along = between(worth.stiffness_across), between(worth.stiffness_along)
            table.add_row("  by wave optics", f"{across} times that, z {along} times")
        if characterised.gap is not None and characterised.drag is not None:
            table.add_row("gap to the wall there", f"{micrometres(characterised.gap)} um")
            drag = three(*(1e9 * each for each in characterised.drag))
            table.add_row("drag there (x, y, z)", f"{drag} nN s/m")
        table.add_row("corner frequencies", f"{three(*frequencies)} Hz{doubt}")
        held, caveat = characterised.lifetime, characterised.lifetime_caveat
        told = [f"{held.words}{doubt}"] if held else []
        table.add_row("held for", ", ".join([*told, *([caveat] if caveat else [])]))
    if characterised.absorbed_power is not None and characterised.torque is not None:
        table.add_row("absorbed power", f"{1e3 * characterised.absorbed_power:.4g} mW")
        torque = three(*(1e18 * each for each in characterised.torque))
        table.add_row("torque about the bead's centre", f"{torque} pN um")
    others = [each for each in characterised.equilibria if each.stable and each is not place]
    if others and scene.plain:
        heights = ", ".join(micrometres(each.position[2]) for each in others)
        table.add_row("other stable equilibria", f"z = {heights} um")
    unstable = [each for each in characterised.equilibria if not each.stable]
    if unstable and scene.plain:
        heights = ", ".join(micrometres(each.position[2]) for each in unstable)
        table.add_row("unstable equilibria", f"z = {heights} um")
    elif not scene.plain:
        for each in characterised.equilibria:
            if each is not place:
                kind = "another equilibrium" if each.stable else "unstable equilibrium"
                table.add_row(kind, _where(each))
    error = characterised.force_error
    table.add_row("error of the force", f"{1e12 * error:.1g} pN")
    table.add_row("force by", characterised.evaluator)
    table.add_row("light", theory_of(scene))
    OUT.print(table)
    if characterised.escapes:
        _print_escapes(characterised)


def _print_heights(found: xr.Dataset) -> None:
    """A row for each height."""
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
            f"{1e6 * float(at['gap']):.4g}",
            three(*(1e6 * at["stiffness"].values)),
            f"{across:.4g}, {along:.4g}",
            three(*at["corner_frequency"].values),
        ])  # fmt: skip
    print_rows(rows)


def _where(place: Equilibrium) -> str:
    return f"{', '.join(map(micrometres, place.position))} um"


def _print_escapes(characterised: Trap) -> None:
    from tweezer.optics.worth import between

    worth = characterised.ray_optics
    beyond = f"over {1e6 * characterised.reach:.4g}"
    headings = ("escape", "force, pN", "at, um", "energy, kT", "range, um")
    table = table_of(*headings, *(["by waves, times"] if worth else []))
    for escape in characterised.escapes:
        by_waves = ""
        if worth and not worth.trusted:
            by_waves = "not to be trusted"
        elif worth and worth.escape_across:
            axial = {"+z": worth.escape_forward, "-z": worth.escape_backward}
            by_waves = between(axial.get(escape.direction, worth.escape_across))
        table.add_row(
            escape.direction,
            f"{1e12 * escape.force:.4g}",
            f"{1e6 * escape.force_at:.4g}",
            f"{escape.energy_kT:.4g}",
            _range(escape, beyond),
            *([by_waves] if worth else []),
        )
    OUT.print(table)


def _range(escape: Escape, beyond: str) -> str:
    if escape.wall_at is not None:
        return f"wall at {micrometres(escape.wall_at)}"
    return beyond if escape.range is None else f"{1e6 * escape.range:.4g}"


def _efficiency(found: Efficiency | None) -> str:
    return "none" if found is None else f"{found.Q:.4g}, at {micrometres(found.at)} um"


def _write_trap(scene: Scene, characterised: Trap, path: Path) -> None:
    from tweezer.version import __version__

    trap = dataclasses.asdict(characterised)
    del trap["scene"]
    held = characterised.lifetime
    trap["lifetime"] = held and dataclasses.asdict(held) | {"words": held.words}
    trap["lifetime_caveat"] = characterised.lifetime_caveat
    result = {
        "tweezer_version": __version__,
        "scene": scene.model_dump(mode="json", exclude_none=True),
        "trap": trap,
    }
    write_json(result, path)
