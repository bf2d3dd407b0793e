"""Properties of a scene for its picture (bead, light and walls), and notes on the picture."""

from __future__ import annotations

import math
from typing import Any

from tweezer.optics import cone_caveat, drawn_half_angle, ray_optics_caveat
from tweezer.scene import Scene


def scene_facts(scene: Scene) -> dict[str, Any]:
    """Return the properties of a scene that its picture shows: bead, light cones, walls and
    temperature, in SI units.
    """
    return {
        "shells": [radius for radius, _ in scene.bead.shells],
        "beams": [
            {
                "focus": list(beam.position),
                "half_angle": drawn_half_angle(alone),
                "down": beam.direction == "down",
                "wavelength": beam.wavelength / scene.medium.refractive_index,
                "vacuum_wavelength": beam.wavelength,
            }
            for beam in scene.beams
            if (alone := scene.with_one_beam(beam)).lit
        ],
        "walls": _walls(scene),
        "temperature": scene.medium.temperature,
    }


def _walls(scene: Scene) -> list[dict[str, Any]]:
    """Return the planes that bound the fluid, walls and cover glass, by height z, m.

    `normal` is the direction along z from the plane to the bead, 1 or -1.
    """
    cover = scene.lens.cover
    planes = {z: (normal, "wall") for z, normal in (scene.wall.planes if scene.wall else ())}
    if cover is not None:
        same = [z for z in planes if math.isclose(z, -cover.depth, abs_tol=_SAME)]
        planes[same[0] if same else -cover.depth] = (1, "cover glass")
    return [{"z": z, "normal": normal, "name": name} for z, (normal, name) in planes.items()]


#: Distance below which a wall and the cover glass are the same plane, m
_SAME = 1e-12


def of_the_picture(scene: Scene) -> list[str]:
    """Return the notes on how to read the picture of a scene, and its limitations."""
    turns = (
        "The pattern on the bead shows its rotation."
        if scene.rotates
        else "The pattern on the bead does not turn, because no torque acts on it or its rotation "
        "was not computed."
    )
    notes = [
        f"Bead and light are to scale. {turns} The light is bounded by the outermost rays and "
        "drawn with a waist of half the wavelength over the sine of their angle. Its shade does "
        "not represent the intensity."
    ]
    caveats = filter(None, (cone_caveat(scene), ray_optics_caveat(scene)))
    return [*notes, *(f"{caveat[0].upper()}{caveat[1:]}." for caveat in caveats)]
