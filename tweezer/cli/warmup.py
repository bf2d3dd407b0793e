"""Compilation in advance, by brief runs of the computations that scenes need."""

from __future__ import annotations

import warnings

import numpy as np

from tweezer.dynamics import bound_once, chosen
from tweezer.dynamics.models import bind_translation
from tweezer.dynamics.walk import walk
from tweezer.optics import Beams, LightForce, light_force, light_of_one_beam
from tweezer.runs.simulation import simulate
from tweezer.scene import Scene
from tweezer.scene.choices import EVALUATORS
from tweezer.scene.interference import changing, interferes
from tweezer.tracking.filter import kalman_filter
from tweezer.trap.elimination import mean_times
from tweezer.values.errors import PhysicsWarning

#: Simulated duration of a brief run, s
_MOMENT = 1e-8


def usual_scenes(scene: Scene) -> list[Scene]:
    """Return a shipped scene with its usual variants: thermal motion with forces from a map,
    or without one if the light has none.

    A scene with the thesis's grid also has the variant with the torque (3.25), which `tweezer
    reproduce` runs and in which the bead rotates. Its thermal motion from the map is unscaled. A
    scene with a body that is not a sphere has the variant without thermal motion. A scene with
    several beads has no variants.
    """
    if scene.more_beads:
        return [scene]
    if scene.bead.shape != "sphere":
        quiet = {"forces": {"brownian": False}, "simulation": {"model": "full"}}
        return [scene, scene.replace(**quiet)]
    mapped = scene.allows(EVALUATORS["map"]) and not changing(scene)
    thermal = {
        "forces": {"brownian": True}, "optics": {"evaluator": "map" if mapped else "auto"},
    }  # fmt: skip
    if scene.optics.evaluator != "grid":
        return [scene, scene.replace(**thermal)]
    unscaled = {"simulation": {"model": "full", "method": "auto"}}
    return [
        scene,
        scene.replace(**thermal, **unscaled),
        scene.replace(beam={"torque": "thesis"}),
    ]


def warm_up(scene: Scene) -> None:
    """Compile what runs, ensembles, traps and fits of a scene need, unless it is compiled already.

    A scene that reads its force from a map also gets the map, unless it exists. A scene with
    several beads gets what its runs need.
    """
    with warnings.catch_warnings(action="ignore", category=PhysicsWarning):
        if scene.more_beads:
            simulate(scene.replace(simulation={"duration": _MOMENT, "samples": 2}))
            return
        one_beam = scene.with_one_beam(scene.beam)
        lights: list[LightForce | Beams] = [light_of_one_beam(one_beam)]
        if scene.lit:
            lights.append(light_of_one_beam(one_beam.replace(optics={"evaluator": "quadrature"})))
        if interferes(scene):
            lights.append(light_force(scene))
        for bound in lights:
            for gradient in (False, True):
                bound.field(np.zeros((1, 3)), gradient=gradient)
        if scene.lit:
            kalman_filter(bind_translation(bound_once(scene), "overdamped"))
            mean_times(np.zeros((1, 1)), np.ones(1), np.ones(1), np.zeros(1))
        scene = walk(scene).scene if scene.forces.brownian else chosen(scene)[0]
        blurred = scene.forces.brownian and not scene.medium.viscoelastic
        seen = {"camera": {"rate": 1 / _MOMENT}} if blurred else {}
        simulate(scene.replace(simulation={"duration": _MOMENT, "samples": 2}, **seen))
