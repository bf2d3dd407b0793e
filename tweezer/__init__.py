"""A bead in an optical trap: derived dynamics, the real optical force, stated errors.

>>> import tweezer
>>> scene = tweezer.load_scene("thesis-990nm").replace(beam={"power": "80 mW"})
>>> run = tweezer.simulate(scene, duration="10 ms")

Names are loaded when first used, so that importing the package costs nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tweezer.analysis import summarise
    from tweezer.bead import bead_properties
    from tweezer.errors import (
        IntegrationError,
        PhysicsWarning,
        ResultError,
        SceneError,
        TweezerError,
    )
    from tweezer.io import load_run, save_run, scene_of
    from tweezer.optics import optical_force, optical_jacobian, optical_torque
    from tweezer.scene import Scene, load_scene, shipped_scenes
    from tweezer.simulate import simulate

_HOMES = {
    "tweezer.analysis": ("summarise",),
    "tweezer.bead": ("bead_properties",),
    "tweezer.errors": (
        "IntegrationError",
        "PhysicsWarning",
        "ResultError",
        "SceneError",
        "TweezerError",
    ),
    "tweezer.io": ("load_run", "save_run", "scene_of"),
    "tweezer.optics": ("optical_force", "optical_jacobian", "optical_torque"),
    "tweezer.scene": ("Scene", "load_scene", "shipped_scenes"),
    "tweezer.simulate": ("simulate",),
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [  # noqa: PLE0604
    *sorted(_HOME_OF)
]


def __getattr__(name: str) -> Any:
    if name in _HOME_OF:
        value = getattr(importlib.import_module(_HOME_OF[name]), name)
        globals()[name] = value  # also in place of the submodule `simulate`
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
