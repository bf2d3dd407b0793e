"""The emitted module of a scene's motion."""

from __future__ import annotations

import importlib
from types import ModuleType

from tweezer.compiled import cache_functions
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.layout import Layout
from tweezer.fluid import Drag
from tweezer.forces.force import Force
from tweezer.scene import Scene
from tweezer.scene.choices import MODELS


def module(name: str) -> ModuleType:
    """Return an emitted module whose functions are compiled once."""
    return cache_functions(importlib.import_module(f"tweezer.generated.{name}"))


def module_of(scene: Scene, *, rotates: bool) -> ModuleType:
    """Return the smallest emitted module that is sufficient for a scene.

    If the scene does not set a model, the unscaled equations are used.
    """
    model = MODELS[scene.simulation.model or "full"]
    if scene.medium.relaxes:  # whose velocity is a variable even without inertia
        model = MODELS["full"]
    if not rotates:
        return module(f"{model.modules}_translation")
    if scene.bead.shape != "sphere":
        return module(f"{model.modules}_body")
    body = "rigid_body" if scene.bead.moments_of_inertia else "sphere"
    rates = scene.simulation.rotation_state == "euler-rates" and model.inertia
    return module(f"{model.modules}_{model.rotating or body}{'_euler_rates' if rates else ''}")


def takes_drag_exactly(
    equations: ModuleType, force: Force, drag: Drag, body: BodyMotion | None
) -> bool:
    """Return whether the exponential method can integrate emitted equations under force and drag.

    Neither may depend on the orientation, except for a body that is no sphere, whose loop follows
    poses.
    """
    if body is not None:
        return True
    inertial = "velocity" in Layout.of_emitted(equations.STATE)
    plain = not inertial and "force_gradient" not in equations.RHS_INPUTS
    return (equations.LINEAR_DRAG or plain) and not (force.oriented or drag.oriented)
