"""The command `tweezer view`."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import (
    Changes,
    Details,
    Overwrite,
    Quiet,
    app,
    bind_light,
    scene_with,
    settings_of,
)
from tweezer.cli.completion import complete_shown
from tweezer.cli.console import (
    FAILED,
    INTERRUPTED,
    OUT,
    begin,
    complain,
    showing_progress,
    tell_written,
    writable_result,
)
from tweezer.cli.runs import followed_with_progress
from tweezer.values.errors import ResultError, SceneError
from tweezer.values.saved import RESULTS, SAVED_TRAP

if TYPE_CHECKING:
    from tweezer.results.run import Run
    from tweezer.scene import Scene
    from tweezer.viewing import Page

#: Default duration of a film, s
_SECONDS = 8.0


@app.command()
def view(
    run: Annotated[
        str,
        typer.Argument(
            help="File of a run, ensemble or sweep (.nc, .zarr) or of a trap (.json), or name or "
            "file of a scene, which is simulated first.",
            metavar="RUN",
            autocompletion=complete_shown,
        ),
    ],
    trap: Annotated[
        bool, typer.Option("--trap", help="Show the trap of a scene instead of a run.")
    ] = False,
    set: Changes = None,
    out: Annotated[
        Path | None, typer.Option(help="Page to write (html). Default: show it in a browser.")
    ] = None,
    movie: Annotated[
        Path | None,
        typer.Option(help="Film to write (mp4, gif). Requires Chromium, selenium and ffmpeg."),
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option(help=f"Duration of the film, s. Requires --movie. Default: {_SECONDS:g}."),
    ] = None,
    overwrite: Overwrite = False,
    details: Details = False,
    quiet: Quiet = False,
) -> None:
    """Show RUN on an interactive page.

    The page is one file that requires no network. It shows the bead in the light with its forces,
    and plots in which a click selects the time. For an ensemble it shows all beads, for a trap the
    force field, and for a sweep the outcome of each case. An earlier page of tweezer at OUT is
    replaced; any other file requires --overwrite.
    """
    begin(details=details, quiet=quiet)
    out = out and writable_result(out, ("html",), overwrite=overwrite, obstacle=_obstacle)
    length = _SECONDS if seconds is None else seconds
    if movie is not None:
        from tweezer.viewing.movie import FORMATS, programs

        writable_result(movie, tuple(FORMATS), overwrite=overwrite, option="--movie")
        if not 0 < length <= 600:
            raise ResultError(f"--seconds {length:g}: must be above 0, and at most 600")
        programs()
    elif seconds is not None:
        raise ResultError("--seconds: requires --movie")
    page, code = _page(run, set or [], trap=trap)
    if out is not None:
        tell_written(page.save(out))
    elif movie is None:
        OUT.print(f"the page is {page.open()}", highlight=False, soft_wrap=True)
    if movie is not None:
        from tweezer.viewing.movie import film

        with showing_progress(f"{movie}") as progress:
            film(page, movie, length, progress)
        tell_written(movie)
    if code:
        raise typer.Exit(code)


#: Text near the beginning of a page of tweezer, and the number of bytes that contain it
_SIGN, _HEAD = b'<meta name="generator" content="tweezer ', 4096


def _obstacle(out: Path) -> str:
    """Return why a page must not replace the file at `out`; "" if that is tweezer's page."""
    with contextlib.suppress(OSError), out.open("rb") as file:
        if _SIGN in file.read(_HEAD):
            return ""
    return "already exists and is not a page of tweezer"


def _page(name: str, changes: list[str], *, trap: bool) -> tuple[Page, int]:
    """Return the page of a result or scene, and the exit code, which reports an incomplete run."""
    if Path(name).suffix in (*RESULTS, SAVED_TRAP):
        if changes or trap:
            given = "--trap" if trap else "--set"
            raise SceneError(f"{given}: requires a scene, but {name} is a result")
        from tweezer.viewing import view as page_of

        return page_of(name), 0
    scene = scene_with(name, settings_of(changes))
    if trap and scene.bead.shape != "sphere":
        raise SceneError(
            f"bead.shape = {scene.bead.shape!r}: its trap has no interactive page; use "
            "`tweezer trap --plot`"
        )
    if scene.more_beads and not trap:
        from tweezer.cli.several import followed

        return _shown(scene, followed(scene, None))
    bind_light(scene)
    if trap:
        from tweezer.trap import Trap, characterise
        from tweezer.viewing import view as page_of

        characterised = characterise(scene)
        assert isinstance(characterised, Trap)
        return page_of(characterised), 0

    from tweezer.dynamics.second_process import compiling_beside

    with compiling_beside(scene):
        result, find_errors = followed_with_progress(scene, None)
        find_errors()
    return _shown(scene, result)


def _shown(scene: Scene, result: Run) -> tuple[Page, int]:
    """Return the page of the run of a scene, and the exit code, which reports an incomplete run."""
    from tweezer.viewing import view as page_of

    status, message = (result.attributes[name] for name in ("status", "message"))
    code = {"failed": FAILED, "interrupted": INTERRUPTED}.get(status, 0)
    if code:
        complain(f"{scene.name}: {message}; the page shows the trajectory so far")
    return page_of(result.dataset()), code
