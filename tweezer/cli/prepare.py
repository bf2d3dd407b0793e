"""The commands `tweezer map` and `tweezer warmup`, which compute in advance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import Details, Quiet, SceneName, app, map_of, scene_with, settings_of
from tweezer.cli.completion import complete_scene, complete_setting
from tweezer.cli.console import ERR, OUT, begin, end_notice
from tweezer.cli.tables import print_shown
from tweezer.values.errors import SceneError
from tweezer.values.printed import printed
from tweezer.values.shown import Row

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tweezer.compiled import Compilation
    from tweezer.optics import Table as Map
    from tweezer.scene import Scene


@app.command("map")
def force_map(
    scene: SceneName,
    set: Annotated[
        list[str] | None,
        typer.Option(
            help='Change the scene, e.g. --set "optics.table_tolerance=1e-8". May be repeated.',
            metavar="KEY=VALUE",
            autocompletion=complete_setting,
        ),
    ] = None,
    details: Details = False,
    quiet: Quiet = False,
) -> None:
    """Compute the force map of SCENE.

    The command prints the error of the map and stores it. A scene uses it if evaluator = "map" in
    [optics].
    """
    begin(details=details, quiet=quiet)
    described = scene_with(scene, {"optics.evaluator": "map", **settings_of(set or [])})
    if (other := described.optics.evaluator) != "map":
        raise SceneError(f"optics.evaluator = {other!r}: must be 'map' for this command")
    made = map_of(described)
    print_shown(described.name, _rows(described, made))
    if made.path:
        OUT.print(f"kept in {made.path}", highlight=False, soft_wrap=True)


@app.command()
def warmup(
    scene: Annotated[
        list[str] | None,
        typer.Argument(
            help="Shipped scenes or TOML files. Default: all shipped scenes.",
            metavar="SCENE",
            autocompletion=complete_scene,
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Compile in advance for commands on SCENE.

    The command also computes the force map of SCENE, if it uses one. Without SCENE it compiles for
    the shipped scenes. For those without a grid this includes thermal motion, and a bead with a
    lower refractive index than the medium.
    """
    begin(quiet=quiet)
    from tweezer.scene import load_scene, shipped_scenes

    described = [load_scene(name) for name in scene or shipped_scenes()]
    end_notice()
    with ERR.status("loading") as status:
        from tweezer.cli.warmup import usual_scenes, warm_up
        from tweezer.compiled import compilation, found

        def say(compiling: Compilation) -> None:
            """Show which function is being compiled."""
            status.update(f"compiling {compiling.latest}, {compiling.seconds:.0f} s so far")

        with compilation(say) as compiling:
            for each in described:
                for usual in [each] if scene else usual_scenes(each):
                    warm_up(usual)
    OUT.print(
        f"compiled {compiling.functions} functions in {compiling.seconds:.0f} s; {found()} were "
        "there already"
    )


def _rows(scene: Scene, made: Map) -> Iterator[Row]:
    """Yield the rows of a force map: range, error, size and light."""
    from tweezer.optics import rows_of_light

    yield Row("largest force", printed(made.largest_force, "pN"))
    part = made.certified_error / made.largest_force if made.largest_force else 0.0
    error = f"{printed(made.certified_error, 'pN', 2)}, {part:.2g} of the largest force"
    yield Row("certified error", error)
    yield Row("range", f"{printed(made.range, 'um')} from the focus")
    yield Row("pieces", f"{made.pieces}", detail=True)
    if made.path:
        yield Row("size of the file", f"{made.path.stat().st_size / 1e6:.2g} MB")
    yield Row("time to make", f"{made.build_time:.2g} s", detail=True)
    yield from rows_of_light(scene)
