"""Beams that interfere, mirrors, and the rules for both."""

from __future__ import annotations

from typing import NamedTuple

from tweezer.scene.courses import refusal
from tweezer.scene.description import Description
from tweezer.scene.sections import Beam
from tweezer.scene.theory import named_beams

#: Refractive index of a wall that reflects light, if neither wall nor cover has one: cover glass
GLASS = 1.518


class Plane(NamedTuple):
    """A plane that reflects light."""

    position: float
    """height z, m"""
    normal: float
    """1 or -1: sign of z of the normal towards the bead"""
    refractive_index: complex | None
    """refractive index behind the plane; None for a perfect mirror"""
    key: str
    """section of the scene that describes it"""


def planes(scene: Description) -> tuple[Plane, ...]:
    """Return the planes of a scene that reflect light: the mirror, and walls that reflect."""
    found = []
    if scene.mirror is not None:
        position, given = scene.mirror.position, scene.mirror.refractive_index
        normal = 1.0 if scene.start_position[2] > position else -1.0
        index = complex(*given) if isinstance(given, tuple) else given
        found.append(Plane(position, normal, index, "mirror"))
    wall = scene.wall
    if wall is not None and wall.reflects:
        cover = scene.lens.cover
        of_cover = GLASS if cover is None else cover.refractive_index
        index = of_cover if wall.refractive_index is None else wall.refractive_index
        found += [Plane(z, normal, complex(index), "wall") for z, normal in wall.planes]
    return tuple(found)


def faces(scene: Description) -> dict[float, tuple[float, str]]:
    """Return the walls and mirrors of a scene by their height z, m.

    Each has the sign of z of its normal towards the bead, and its name.
    """
    walls = {z: (normal, "wall") for z, normal in (scene.wall.planes if scene.wall else ())}
    return walls | {each.position: (each.normal, each.key) for each in planes(scene)}


def bounds(scene: Description) -> dict[float, float]:
    """Return the heights z of walls and mirrors, m, each with the sign of z of its normal.

    The normal points towards the bead. The force beyond these planes is unknown.
    """
    return {z: normal for z, (normal, _) in faces(scene).items()}


def reflecting(scene: Description, beam: Beam) -> tuple[Plane, ...]:
    """Return the planes that a beam meets behind the bead, which reflect it."""
    along = 1.0 if beam.direction == "up" else -1.0
    return tuple(plane for plane in planes(scene) if plane.normal == -along)


def groups(scene: Description) -> tuple[tuple[Beam, ...], ...]:
    """Return the beams of a scene in groups: beams of one group interfere."""
    found: dict[object, list[Beam]] = {}
    for i, beam in enumerate(scene.beams):
        found.setdefault(i if beam.coherent is None else beam.coherent, []).append(beam)
    return tuple(map(tuple, found.values()))


def separately(scene: Description, group: tuple[Beam, ...]) -> bool:
    """Return whether a group is one beam that nothing reflects, with a force of its own."""
    return len(group) == 1 and not reflecting(scene, group[0])


def interferes(scene: Description) -> bool:
    """Return whether any beams of a scene interfere, or reflected light does."""
    return any(beam.coherent for beam in scene.beams) or bool(planes(scene))


def changing(scene: Description) -> str:
    """Return the first key by which light that interferes changes in time; "" without one.

    Such light has no force map.
    """
    return next((
        f"{name}.{course}" for name, beam in named_beams(scene.beams)
        for course in ("motion", "modulation", "phasing")
        if getattr(beam, course) and (beam.coherent or reflecting(scene, beam))
    ), "")  # fmt: skip


def check_interference(scene: Description) -> None:
    """Refuse coherent beams that cannot interfere, and mirrors without an effect or in the bead."""
    named = list(named_beams(scene.beams))
    for name, beam in named:
        if beam.coherent is None:
            for key in ("phase", "phasing"):
                if getattr(beam, key):
                    raise refusal(f"{name}.{key}: requires {name}.coherent")
            continue
        others = [each for each in scene.beams if each.coherent == beam.coherent]
        if len(others) == 1:
            raise refusal(
                f"{name}.coherent = {beam.coherent!r}: no other beam has this name; give it to "
                "the beams that interfere"
            )
        if any(each.wavelength != beam.wavelength for each in others):
            raise refusal(
                f"{name}.wavelength = {beam.wavelength:g}: must be equal for coherent beams"
            )
        if beam.polarisation == "unpolarised":
            raise refusal(
                f"{name}.polarisation = 'unpolarised': a coherent beam requires polarised light"
            )
    if not interferes(scene):
        return
    key = next((f"{name}.coherent" for name, beam in named if beam.coherent), "")
    key = key or planes(scene)[0].key
    if scene.lit and scene.theory == "rays":
        raise refusal(f"{key}: requires wave optics; set optics.theory to waves")
    if scene.bead.shape != "sphere":
        raise refusal(f"{key}: requires bead.shape = 'sphere'")
    if scene.optics.evaluator == "map" and (course := changing(scene)):
        raise refusal(
            f"optics.evaluator = 'map': requires light that interferes to be constant, without "
            f"{course}; allowed: auto, quadrature"
        )
    for plane in planes(scene):
        gap = plane.normal * (scene.start_position[2] - plane.position)
        if gap <= scene.body.support(plane.normal):
            raise refusal(
                f"{plane.key}.position = {plane.position:g}: the bead must start beside the "
                "plane, by more than its radius"
            )
    sides = [plane.normal for plane in planes(scene)]
    if scene.mirror is not None and sides.count(sides[0]) > 1:
        raise refusal(
            f"mirror.position = {scene.mirror.position:g}: a wall on the same side of the bead "
            "reflects the light too; remove wall.reflects, or the mirror"
        )
    if scene.mirror is not None and not any(
        plane.key == "mirror" for beam in scene.beams for plane in reflecting(scene, beam)
    ):
        raise refusal(
            f"mirror.position = {scene.mirror.position:g}: no beam meets the mirror behind the "
            "bead; move it to the other side, or change beam.direction"
        )
