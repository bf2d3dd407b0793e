"""Compiling ahead what scenes need, by doing for a moment what their users will do."""

from __future__ import annotations

import warnings

import numpy as np

from tweezer.dynamics import chosen, walk
from tweezer.errors import PhysicsWarning
from tweezer.optics import light
from tweezer.scene import Scene
from tweezer.simulation import simulate

#: s, simulated
_MOMENT = 1e-8


def usual_scenes(scene: Scene) -> list[Scene]:
    """What is usually asked of a scene that is shipped: itself, and its thermal motion.

    A scene with the thesis's grid has no table of its force; of any other this is the motion that
    the README shows.
    """
    if scene.optics.evaluator == "grid":
        return [scene]
    changes = {"forces": {"brownian": True}, "optics": {"evaluator": "map"}}
    return [scene, scene.replace(**changes)]


def warm_up(scene: Scene) -> None:
    """Compile what runs, ensembles and traps of `scene` need, unless it is compiled.

    Of a scene that reads its force from a map, also make that, unless it is made.
    """
    with warnings.catch_warnings(action="ignore", category=PhysicsWarning):
        lights = [light(scene)]
        if scene.lit:
            lights.append(lights[0].by_quadrature(scene.optics.tolerance))
        for bound in lights:
            for gradient in (False, True):
                bound.field(np.zeros((1, 3)), gradient=gradient)
        if scene.forces.brownian:
            scene = walk(scene).scene
        else:
            scene, _ = chosen(scene)
        simulate(scene.replace(simulation={"duration": _MOMENT, "samples": 2}))
