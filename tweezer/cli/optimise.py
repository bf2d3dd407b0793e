"""The command `tweezer optimise`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import (
    Changes,
    FigureFile,
    Overwrite,
    Quiet,
    SceneName,
    app,
    pairs_of,
    scene_with,
    settings_of,
)
from tweezer.cli.completion import among
from tweezer.cli.console import (
    begin,
    showing_progress,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
)
from tweezer.cli.tables import print_shown, print_table
from tweezer.scene.choices import GOALS
from tweezer.values.errors import SceneError
from tweezer.values.shown import Row, Table

if TYPE_CHECKING:
    from tweezer.optics.optimised import Optimum


#: What a mask sets
_KINDS = ("field", "phase")


@app.command()
def optimise(
    scene: SceneName,
    set: Changes = None,
    goal: Annotated[
        str,
        typer.Option(
            "--for",
            help=f"Stiffness to maximise: {', '.join(GOALS)}.",
            autocompletion=among(GOALS),
        ),
    ] = "kx",
    kind: Annotated[
        str,
        typer.Option(
            "--with",
            help="Mask of amplitude and phase (field), or of the phase alone (phase).",
            autocompletion=among(_KINDS),
        ),
    ] = "field",
    at_least: Annotated[
        list[str] | None,
        typer.Option(
            help='Smallest other stiffness: --at-least "kz=5 pN/um". May be repeated.',
            metavar="KEY=VALUE",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="File .npy of the mask; the scene is written beside it, as .toml."),
    ] = None,
    plot: FigureFile = None,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Find the mask for SCENE's stiffest trap.

    The command writes the mask over the pupil and a scene with it: best-GOAL.npy and best-GOAL.toml
    by default.
    """
    begin(quiet=quiet)
    described = scene_with(scene, settings_of(set or []))
    if kind not in _KINDS:
        raise SceneError(f"--with {kind!r}: must be {' or '.join(_KINDS)}")
    least = pairs_of("--at-least", at_least or [], "kz=5 pN/um")
    mask = writable_result(out or Path(f"best-{goal}.npy"), ("npy",), overwrite=overwrite)
    file = writable_result(mask.with_suffix(".toml"), ("toml",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)
    with showing_progress(described.name):
        from tweezer.optics.optimised import optimise as optimised

        best = optimised(
            described, goal, field=kind == "field", at_least=least, file=mask,
            overwrite=overwrite,
        )  # fmt: skip
    _write(best, mask, file)
    print_shown(described.name, _rows(best))
    print_table(_table(best))
    if plot:
        from tweezer.plots import optimum_figure

        write_figure(optimum_figure(best, described), plot)
    tell_written(mask, file, plot)


def _write(best: Optimum, mask: Path, file: Path) -> None:
    """Write the scene, which names the mask beside it."""
    import tomli_w

    from tweezer.values.files import replacing

    scene = best.scene.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    scene["name"] = file.stem
    scene["beam"]["mask"] = mask.name
    with replacing(file) as whole:
        whole.write(tomli_w.dumps(scene).encode())


def _rows(best: Optimum) -> list[Row]:
    """Return the rows about the whole mask."""
    gain = "the scene itself has no trap" if best.gain is None else f"{best.gain:.4g}"
    worth = best.value / best.bound
    return [
        Row(f"gain in {best.goal}", gain),
        Row("part of its upper bound", f"{100 * worth:.4g} %"),
        Row("light that the mask transmits", f"{100 * best.passed:.3g} %"),
    ]


def _table(best: Optimum) -> Table:
    """Return the table of stiffness and linear range by axis."""
    rows = [("stiffness, pN/um", *(f"{1e6 * each:.4g}" for each in best.stiffness))]
    if best.without is not None:
        rows.append(("without the mask, pN/um", *(f"{1e6 * each:.4g}" for each in best.without)))
    rows.append(("linear within 5 % to, nm", *(f"{1e9 * each:.3g}" for each in best.linear_range)))
    return Table(("along", "x", "y", "z"), tuple(rows))
