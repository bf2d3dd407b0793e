"""The application that contains all commands, and arguments that several commands share."""

from __future__ import annotations

import contextlib
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
import typer.core

from tweezer.cli.completion import complete_scene, complete_setting
from tweezer.cli.console import (
    MORE,
    detailed,
    importing,
    show_warning,
    showing_progress,
    telling_interrupt,
)
from tweezer.values.errors import PhysicsWarning, SceneError

if TYPE_CHECKING:
    from tweezer.optics import Table as Map
    from tweezer.scene import Scene


#: Names of commands by the alternative names under which users may look for them
_FAMILIAR = {
    "simulate": "run", "characterise": "trap", "characterize": "trap", "stiffness": "trap",
    "show": "view", "plot": "view", "optimize": "optimise", "init": "new",
}  # fmt: skip


class _Commands(typer.core.TyperGroup):
    """Group of all commands. An interrupted command reports the files that it has written."""

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return the command with this name or alternative name."""
        return super().get_command(ctx, cmd_name) or super().get_command(
            ctx, _FAMILIAR.get(cmd_name, cmd_name)
        )

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        """Parse the arguments of a command, reporting an interrupt."""
        with telling_interrupt(), importing():
            return super().make_context(*arguments, **options)

    def invoke(self, ctx: Any) -> Any:
        """Run the command, reporting an interrupt."""
        with telling_interrupt():
            return super().invoke(ctx)


app = typer.Typer(
    cls=_Commands,
    help="Simulate a bead in an optical trap.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
SceneName = Annotated[
    str,
    typer.Argument(
        help="Shipped scene or TOML file.", metavar="SCENE", autocompletion=complete_scene
    ),
]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        help='Change the scene: --set "beam.power=80 mW". May be repeated.',
        metavar="KEY=VALUE",
        autocompletion=complete_setting,
    ),
]
Columns = Annotated[
    str | None,
    typer.Option(
        help='Columns of a table, either in file order, e.g. "t [s],-,x [um]", or by heading or '
        'number, e.g. "t=Zeit,x=4".',
        metavar="NAMES",
    ),
]
Rate = Annotated[
    str | None,
    typer.Option(
        help='Rate of the rows of a table without times, or of its numbered frames, e.g. "15 Hz".',
        metavar="RATE",
    ),
]
Scale = Annotated[
    str | None,
    typer.Option(
        help='Length of a pixel or a volt, e.g. "85.8 nm", "11.66 px/um" or "0.5 um/V".',
        metavar="LENGTH",
    ),
]
Bead = Annotated[
    str | None,
    typer.Option(
        help="Bead to read from a table of several beads, as its column labels it.", metavar="ID"
    ),
]
Skip = Annotated[str, typer.Option(help='Time to omit at the beginning, e.g. "5 ms".')]
OwnForces = Annotated[
    list[str] | None,
    typer.Option(
        help="Your own force in a Python file, which is executed, e.g. handles.py:spring. May be "
        "repeated.",
        metavar="FILE.py:NAME",
    ),
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Continue the interrupted OUT, if it exists.")
]
JsonFile = Annotated[
    Path | None,
    typer.Option("--out", "--json", help='JSON file to write; "-" prints only this file.'),
]
Details = Annotated[
    bool,
    typer.Option("--details", help="Print also how the result was computed, and whole warnings."),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace existing files of any kind.")]
FigureFile = Annotated[
    Path | None,
    typer.Option(
        help="Figure to write (png, pdf, svg). Replaces an earlier figure of tweezer; any other "
        "file requires --overwrite."
    ),
]


def scene_with(scene: str | Scene, settings: dict[str, str]) -> Scene:
    """Return a scene, or the scene of that name or file, with the changes of `settings_of`."""
    from tweezer.scene import checked_scene, with_settings

    described = checked_scene(scene, several=True)
    return with_settings(described, settings) if settings else described


def settings_of(changes: list[str], **simulation: str | None) -> dict[str, str]:
    """Return values by dotted key, from `--set` and from options that set simulation keys.

    `changes` are texts KEY=VALUE. `simulation` has the values of options by key, or None for
    options that are not given. Raises `SceneError` for a key that is given twice.
    """
    settings = pairs_of("--set", changes, "beam.power=80 mW")
    named = {f"simulation.{key}": value for key, value in simulation.items() if value is not None}
    for key in settings.keys() & named.keys():
        raise SceneError(f"--{key.partition('.')[2]}: {key} is set twice, also by --set")
    return {**settings, **named}


def pairs_of(option: str, texts: list[str], example: str) -> dict[str, str]:
    """Return values by key from the texts KEY=VALUE of an option.

    Raises `SceneError` for other texts and for a key that is given twice. `example` is a text.
    """
    found: dict[str, str] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise SceneError(f"{option} {text!r}: must be key=value, such as {example}")
        if (key := key.strip()) in found:
            raise SceneError(f"{option} {text!r}: {key} is set twice")
        found[key] = value.strip()
    return found


def with_thermal_motion(scene: str | Scene, settings: dict[str, str]) -> Scene:
    """Return a scene with settings and thermal motion, with forces from a map if possible.

    A map is used only for a sphere, if the scene does not choose an evaluator and its light has a
    map.
    """
    thermal = scene_with(scene, {"forces.brownian": "true"} | settings)
    if thermal.bead.shape == "sphere" and thermal.optics.evaluator == "auto":
        with contextlib.suppress(SceneError):
            mapped = thermal.replace(optics={"evaluator": "map"})
            if mapped.theory == "waves" and not mapped.plain:
                from tweezer.optics.binding import check_maps  # most light has a small map

                check_maps(mapped)
            return mapped
    return thermal


def bind_light(scene: Scene) -> None:
    """Warn if ray optics is inaccurate for the scene, and compute the force maps that it needs."""
    with importing():
        from tweezer.optics import light_force
        from tweezer.scene.interference import groups, separately

    warn_of_rays(scene)
    separate = (group[0] for group in groups(scene) if separately(scene, group))
    for alone in map(scene.with_one_beam, separate):
        if alone.lit and scene.optics.evaluator == "map":
            map_of(alone)
    with warnings.catch_warnings(action="ignore", category=PhysicsWarning):  # shown above
        light_force(scene)


def warn_of_rays(scene: Scene) -> None:
    """Warn if ray optics is inaccurate for the scene, in one line without --details."""
    from tweezer.optics import ray_optics_caveat, ray_optics_warning

    if caveat := ray_optics_caveat(scene):
        show_warning(caveat if detailed() else f"{ray_optics_warning(scene)} ({MORE})")


def map_of(scene: Scene) -> Map:
    """Return the force map of a scene, computed with a progress bar if it is not in the cache."""
    with showing_progress(f"map of {scene.name}", 1.0) as progress:
        from tweezer.optics import force_map

        return force_map(scene, progress)


def quantity_in(option: str, text: str, annotation: object) -> float:
    """Return the text of an option as a quantity in SI units, of the type `annotation`.

    Raises `SceneError` for an invalid text; warns if a number without a unit is implausible.
    """
    from tweezer.values.units import bare, quantity_of, to_si

    quantity = quantity_of(annotation)
    assert quantity is not None  # all annotations of tweezer.values.units have one
    value = bare(text)
    try:
        number = to_si(value, quantity.unit, quantity.low, quantity.high)
    except ValueError as error:
        raise SceneError(f"{option} {text!r}: {error}") from None
    if doubt := quantity.doubt(value):
        show_warning(f"{option} {text} {doubt}")
    return number
