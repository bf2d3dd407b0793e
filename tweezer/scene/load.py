"""Scenes from a name, a file or a mapping."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tweezer.scene.courses import with_tables
from tweezer.scene.files import read_scene
from tweezer.scene.messages import counted, in_short
from tweezer.scene.scene import Scene, validated
from tweezer.values.errors import SceneError

SceneLike = Scene | str | Path | Mapping[str, Any]
"""a scene, the name of a shipped one, a TOML file, or a mapping of the same form"""


def checked_scene(scene: SceneLike, *, several: bool = False) -> Scene:
    """Return the scene for an argument: a scene itself, or a source for `load_scene`.

    Raises `SceneError` if it neither is a scene nor names one, or if it has several beads and
    `several` is False.
    """
    if isinstance(scene, str | Path | Mapping):
        scene = load_scene(scene)
    if isinstance(scene, Scene):
        if scene.more_beads and not several:
            raise SceneError(
                f"bead: the scene has {counted(scene.beads, 'bead')}, and this requires one; "
                "remove the others, or use Scene.alone"
            )
        return scene
    raise SceneError(
        f"scene = {in_short(scene)}: must be a Scene, the name of a shipped one, a TOML file or a "
        "mapping"
    )


def load_scene(source: str | Path | Mapping[str, Any]) -> Scene:
    """Return the scene of a shipped name, a TOML file, or a mapping of the same form.

    Parameters
    ----------
    source : str, Path or mapping
        Name of a shipped scene (`tweezer.shipped_scenes`), file, or sections by their names.

    Returns
    -------
    Scene
        Validated scene.

    Raises
    ------
    SceneError
        For invalid values. The message has one line for each, with the key, the value and what is
        allowed.

    Warns
    -----
    PhysicsWarning
        If the continuum drag (2.13) is not valid.
    UnitWarning
        For numbers without a unit whose magnitude is unusual in the SI unit.

    Examples
    --------
    >>> scene = tweezer.load_scene("silica-1um")
    >>> f"{scene.beam.power_through_pupil} W, NA {scene.lens.numerical_aperture}"
    '0.05 W, NA 1.25'
    """
    if isinstance(source, Mapping):
        try:
            data = with_tables(source, Path())
        except ValueError as error:
            raise SceneError(str(error)) from None
        return validated(data, source)
    return validated(*read_scene(str(source)))
