"""Compiling ahead what scenes need, by doing for a moment what their users will do."""

from __future__ import annotations

import warnings

import numpy as np

from tweezer.dynamics import bound_once, chosen, walk
from tweezer.dynamics.filter import kalman_filter
from tweezer.dynamics.models import bind_translation
from tweezer.errors import PhysicsWarning
from tweezer.optics import LightForce, light_of_one_beam
from tweezer.optics.by_quadrature import by_quadrature
from tweezer.scene import Scene
from tweezer.simulation import simulate

#: s, simulated
_MOMENT = 1e-8


def usual_scenes(scene: Scene) -> list[Scene]:
    """A shipped scene, and what users change in it: thermal motion by the map, a lighter bead.

    A bead of a lower index than the medium reflects all of some rays, which takes other kernels.
    A scene with the thesis's grid is the thesis's own: beside it is what `tweezer reproduce` runs,
    with the moment (3.25), which turns the bead.
    """
    if scene.optics.evaluator == "grid":
        return [scene, scene.replace(beam={"torque": "thesis"})]
    thermal = {"forces": {"brownian": True}, "optics": {"evaluator": "map"}}
    lower_index = 0.9 * scene.medium.refractive_index
    return [scene, scene.replace(**thermal), scene.replace(bead={"refractive_index": lower_index})]


def warm_up(scene: Scene) -> None:
    """Compile what runs, ensembles, traps and fits of the depth of `scene` need, unless it is.

    Of a scene that reads its force from a map, also make that, unless it is made.
    """
    with warnings.catch_warnings(action="ignore", category=PhysicsWarning):
        lights: list[LightForce] = [light_of_one_beam(scene.with_one_beam(scene.beam))]
        if scene.lit:
            lights.append(by_quadrature(scene))
        for bound in lights:
            for gradient in (False, True):
                bound.field(np.zeros((1, 3)), gradient=gradient)
        if scene.lit:
            kalman_filter(bind_translation(bound_once(scene), "overdamped"))
        scene = walk(scene).scene if scene.forces.brownian else chosen(scene)[0]
        simulate(scene.replace(simulation={"duration": _MOMENT, "samples": 2}))
