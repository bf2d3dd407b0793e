"""From a result, or the name of one, to its page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tweezer.choices import RESULTS
from tweezer.scene import Scene
from tweezer.viewing.kinds import content_of
from tweezer.viewing.page import Page

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.analysis import Trap


def view(of: xr.Dataset | Trap | Scene | str | Path) -> Page:
    """A page to look at: one file of HTML that needs no server and no network.

    of: a run, an ensemble or a sweep as a dataset, or the file of one (.nc, .zarr); a `Trap`; or a
    scene, or the name or file of one, which is simulated first. In Jupyter the page is shown;
    `Page.save(path)` writes it, and `Page.open()` shows it in a browser.

    Raises `ResultError` for what no page shows, and `SceneError` for a scene that is none.
    """
    if isinstance(of, str | Path):
        of = _load(Path(of)) if Path(of).suffix in RESULTS else _scene(str(of))
    if isinstance(of, Scene):
        from tweezer.simulation import simulate

        of = simulate(of)
    return Page(content_of(of))


def _load(path: Path) -> xr.Dataset:
    """The result in a file; of a store only what is asked for is read from it.

    Raises `ResultError` for a file that is none.
    """
    if path.suffix == ".nc":
        from tweezer.io import load_run

        return load_run(path)
    import xarray as xr

    from tweezer.errors import ResultError

    if not path.is_dir():
        raise ResultError(f"{path}: no such folder")
    try:
        return xr.open_zarr(path, chunks=None)
    except Exception as error:  # Zarr raises of any kind where a store is damaged
        reason = " ".join(str(error).split())
        raise ResultError(f"{path}: not a result of tweezer: {reason}") from None


def _scene(name: str) -> Scene:
    from tweezer.scene import load_scene

    return load_scene(name)
