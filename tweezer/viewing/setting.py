"""Properties of a scene for its picture (bead, light and walls), and notes on the picture."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tweezer.optics import cone_caveat, drawn_cones, ray_optics_caveat
from tweezer.scene import Scene
from tweezer.scene.interference import faces
from tweezer.scene.surfaces import surface_of
from tweezer.viewing.arrays import float32
from tweezer.viewing.pupils import pupil_pictures


def scene_facts(scene: Scene) -> dict[str, Any]:
    """Return the properties of a scene that its picture shows: bead, light cones, walls and
    temperature, in SI units.
    """
    return {
        "shells": [radius for radius, _ in scene.bead.shells],
        **_body(scene),
        "beams": [
            {
                "focus": each.at(0.0).tolist(),
                "factor": float(each.strength.at(0.0)[0]),
                "half_angle": each.half_angle,
                "down": each.beam.direction == "down",
                "wavelength": each.beam.wavelength / scene.medium.refractive_index,
                "vacuum_wavelength": each.beam.wavelength,
            }
            for each in drawn_cones(scene)
        ],
        "pupils": pupil_pictures(scene),
        "walls": _walls(scene),
        "temperature": scene.medium.temperature,
    }


def _body(scene: Scene) -> dict[str, Any]:
    """Return the surface of a body in its frame, and the axes whose directions the page plots.

    The result is empty for a sphere. A body whose surface is not known has none, and is drawn as
    the sphere that encloses it.
    """
    if scene.bead.shape == "sphere":
        return {}
    found = surface_of(scene.bead)
    packed = found and {
        name: float32(values, unit).as_json()
        for name, values, unit in zip(found._fields, found, ("m", "1", "1"), strict=True)
    }
    return {
        "shells": [scene.body.size],
        "body": {"surface": packed, "plotted_axes": plotted_axes(scene)},
    }


def plotted_axes(scene: Scene) -> list[int]:
    """Return the axis about which the inertia of a body is the same all around; else z and x."""
    inertia = np.array(scene.body.inertia)
    same = _SAME_INERTIA * np.trace(inertia)
    moments = np.diag(inertia)
    if np.abs(inertia - np.diag(moments)).max() <= same:
        alike = [abs(moments[k - 1] - moments[k - 2]) <= same for k in range(3)]
        if sum(alike) == 1:
            return [alike.index(True)]
    return [2, 0]


def _walls(scene: Scene) -> list[dict[str, Any]]:
    """Return the planes that bound the fluid, walls and cover glass, by height z, m.

    `normal` is the direction along z from the plane to the bead, 1 or -1.
    """
    cover = scene.lens.cover
    planes = faces(scene)
    if cover is not None:
        same = [z for z in planes if math.isclose(z, -cover.depth, abs_tol=_SAME)]
        planes[same[0] if same else -cover.depth] = (1, "cover glass")
    return [{"z": z, "normal": normal, "name": name} for z, (normal, name) in planes.items()]


#: Relative difference below which two moments of inertia are the same
_SAME_INERTIA = 1e-6
#: Distance below which a wall and the cover glass are the same plane, m
_SAME = 1e-12


def of_the_picture(scene: Scene, *, oriented: bool = True) -> list[str]:
    """Return the notes on how to read the picture of a scene, and its limitations.

    A body that is not a sphere is drawn if it is `oriented`, that is, if the result contains its
    orientation.
    """
    body = scene.bead.shape != "sphere"
    if body and not oriented:
        turns = "The body is not drawn, because the result does not contain its orientation."
    elif body:
        turns = "The pattern on the body shows its rotation; its half at negative z is violet."
    elif scene.rotates:
        turns = "The pattern on the bead shows its rotation."
    else:
        turns = (
            "The pattern on the bead does not turn, because no torque acts on it or its rotation "
            "was not computed."
        )
    notes = [
        f"Bead and light are to scale. {turns} The light is bounded by the outermost rays and "
        "drawn with a waist of half the wavelength over the sine of their angle. Its shade does "
        "not represent the intensity."
    ]
    if body and oriented and surface_of(scene.bead) is None:
        notes.append(
            "The surface of the body is not known. The picture shows the sphere that encloses it, "
            "and the x, y and z axes of the body."
        )
    caveats = filter(None, (cone_caveat(scene), ray_optics_caveat(scene)))
    return [*notes, *(f"{caveat[0].upper()}{caveat[1:]}." for caveat in caveats)]
