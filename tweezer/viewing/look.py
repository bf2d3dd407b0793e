"""Page of a result, of a file, or of a scene, which is simulated first."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tweezer.scene import Scene
from tweezer.values.saved import RESULTS, SAVED_TRAP
from tweezer.viewing.kinds import content_of
from tweezer.viewing.page import Page

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.trap import Trap


def view(of: xr.Dataset | Trap | Scene | str | Path) -> Page:
    """Return an interactive page of a result: one HTML file that requires no server or network.

    Jupyter displays the page. `Page.save(path)` writes it to a file, and `Page.open()` shows it in
    a browser.

    Parameters
    ----------
    of : Dataset, Trap, Scene, str or Path
        A run of one or several beads, an ensemble, a sweep or a trap, or its file (.nc, .zarr,
        .json of `tweezer trap --out`). A scene, or its name or file, is simulated first.

    Returns
    -------
    Page
        The page.

    Raises
    ------
    ResultError
        For a result without a page.
    SceneError
        For a scene that is not valid.

    Examples
    --------
    >>> run = tweezer.simulate("silica-1um", "1 ms")
    >>> tweezer.view(run).save("run.html").exists()
    True
    """
    name = str(of) if isinstance(of, str | Path) else type(of).__name__
    if isinstance(of, str | Path):
        path = Path(of)
        if path.suffix == SAVED_TRAP:
            from tweezer.viewing import saved_trap

            return Page(saved_trap.content(path))
        of = _read(path)
    if isinstance(of, Scene):
        from tweezer.runs.simulation import simulate

        of = simulate(of)
    return Page(content_of(of, name))


def _read(path: Path) -> xr.Dataset | Scene:
    """Return the result in a file, or the scene with that name or in that file."""
    if path.suffix in RESULTS:
        from tweezer.results.io import load_result

        return load_result(path)
    from tweezer.scene import load_scene

    return load_scene(str(path))
