"""Heating of a scene by its light: absorption of water, media by temperature, and checks."""

from __future__ import annotations

import itertools

from tweezer.scene.courses import refusal
from tweezer.scene.description import Description
from tweezer.scene.media import GASES, MEDIA, SODIUM
from tweezer.scene.sections import Medium
from tweezer.values.errors import SceneError

#: Smallest Knudsen number, by the radius, at which a hot bead is among free molecules
FREE_MOLECULES = 10.0
#: Vacuum wavelength, nm, and absorption coefficient of water at 25 degC, 1/m (D. J. Segelstein, The
#: complex refractive index of water, University of Missouri, 1981). Lines between the logarithms
#: reproduce all of his points within 3 %
_WATER = (
    (500.0, 0.0232), (515.2, 0.0356), (524.8, 0.0393), (575.4, 0.0839), (595.7, 0.163),
    (599.8, 0.202), (605.3, 0.235), (619.4, 0.284), (645.7, 0.313), (685.5, 0.453), (699.8, 0.601),
    (714.5, 1.05), (729.5, 1.98), (734.5, 2.31), (739.6, 2.48), (760.3, 2.61), (799.8, 1.96),
    (809.1, 2.07), (835.6, 3.37), (855.1, 4.63), (905.7, 7.14), (909.9, 7.87), (920.4, 11.3),
    (929.0, 18.5), (944.1, 34.0), (955.0, 42.0), (966.1, 45.1), (990.8, 41.3), (1020.9, 29.0),
    (1049.5, 17.0), (1069.1, 14.8), (1078.9, 15.5), (1088.9, 17.3), (1109.2, 23.1),
)  # fmt: skip


def water_absorption(wavelength: float) -> float | None:
    """Return the absorption coefficient of water at a vacuum wavelength, m; None if not known.

    The result has the unit 1/m and an error of 10 %.
    """
    nm = 1e9 * wavelength
    for (low, first), (high, last) in itertools.pairwise(_WATER):
        if low <= nm <= high:
            return float(first * (last / first) ** ((nm - low) / (high - low)))
    return None


def distances_of_glass(scene: Description) -> tuple[float, ...]:
    """Return the distances of the focus from one or two plane glasses, m; empty if not known."""
    if scene.heat is not None and scene.heat.distance is not None:
        return (scene.heat.distance,)
    if scene.wall is not None:
        z = scene.beam.position[2]
        return tuple(normal * (z - position) for position, normal in scene.wall.planes)
    return () if scene.lens.cover is None else (scene.lens.cover.depth,)


def heats_bead(scene: Description) -> bool:
    """Return whether the light of a scene heats its bead above the medium."""
    heat = scene.heat
    if heat is None or not scene.lit:
        return False
    return scene.bead.absorbs if heat.bead is True else heat.bead > 0


def heats_medium(scene: Description) -> bool:
    """Return whether the light of a scene heats its medium."""
    heat = scene.heat
    if heat is None or not scene.lit:
        return False
    return scene.medium.name not in GASES if heat.light is True else heat.light > 0


def medium_at(scene: Description, temperature: float) -> Medium:
    """Return the medium of a scene with the properties of its name at another temperature, K.

    Values that the scene gives are kept. Raises `SceneError` outside the range of the medium.
    """
    medium = scene.medium
    fluid = MEDIA[medium.name or ""]
    check_temperature(fluid.name, temperature)
    wavelength = scene.beam.wavelength if "refractive_index" in medium.filled else SODIUM
    part = getattr(medium, fluid.part) if fluid.part else 0.0
    found = fluid.at(temperature, part, wavelength)
    return medium.model_copy(update={key: getattr(found, key) for key in medium.filled})


def check_temperature(name: str, temperature: float) -> None:
    """Raise `SceneError` if the light heats a named medium beyond its known range."""
    highest = MEDIA[name].temperatures[1]
    if temperature > highest:
        raise SceneError(
            f"heat: the light heats {name} to {temperature:.4g} K; must be at most {highest:g} K; "
            "reduce the power"
        )


def check_heat(scene: Description) -> None:
    """Refuse heating of a scene whose temperatures cannot be computed."""
    heat, medium = scene.heat, scene.medium
    if heat is None:
        return
    if medium.name is None or "viscosity" not in medium.filled:
        raise refusal(
            "heat: requires a viscosity that follows from the temperature; set medium.name and "
            "remove medium.viscosity"
        )
    if any(beam.modulation is not None for beam in scene.beams):
        raise refusal("heat: requires light of constant power; remove beam.modulation")
    if heat.light is True and heats_medium(scene):
        _check_light(scene)
    if heats_bead(scene):
        _check_bead(scene)


def _check_light(scene: Description) -> None:
    """Refuse light whose heating of the liquid is not computed."""
    assert scene.heat is not None
    mirrored = scene.mirror is not None or (scene.wall is not None and scene.wall.reflects)
    if scene.more_beams or mirrored:
        raise refusal(
            "heat.light = true: is computed for a single beam without a reflection; give the "
            'temperature rise, such as heat.light = "15 K/W"'
        )
    liquid, wavelength = scene.medium.name, scene.beam.wavelength
    if scene.heat.absorption is None:
        if liquid != "water":
            raise refusal(
                f"heat.absorption: missing; medium.name = {liquid!r} requires it, as only the "
                "absorption of water is known"
            )
        if water_absorption(wavelength) is None:
            raise refusal(
                f"beam.wavelength = {wavelength:g}: the absorption of water is known from "
                f"{1e-9 * _WATER[0][0]:g} to {1e-9 * _WATER[-1][0]:g} m; give heat.absorption"
            )
    _check_conductivity(scene)
    glass = distances_of_glass(scene)
    if not glass:
        raise refusal(
            "heat.distance: missing; the temperature of the liquid depends on the distance of the "
            "focus from the glass"
        )
    if min(glass) <= wavelength:
        key = "heat.distance" if scene.heat.distance is not None else "wall.position"
        raise refusal(
            f"{key}: the focus is {min(glass):.3g} m from the glass; must be more than a "
            f'wavelength, {wavelength:g} m; give heat.light, such as "15 K/W"'
        )


def _check_bead(scene: Description) -> None:
    """Refuse a hot bead whose temperature, drag or thermal motion is not computed."""
    assert scene.heat is not None
    said = f"heat.bead = {scene.heat.bead if scene.heat.bead is not True else 'true'}"
    without = "set heat.bead to false"
    if scene.bead.shape != "sphere":
        raise refusal(
            f"{said}: is computed for spheres, not bead.shape = {scene.bead.shape!r}; {without}"
        )
    if scene.forces.brownian_torque:
        raise refusal(
            f"{said}: the rotation of a hot bead has another temperature than its translation; set "
            "forces.brownian_torque to false"
        )
    if scene.medium.name in GASES and scene.knudsen < FREE_MOLECULES:
        raise refusal(
            f"{said}: the mean free path in the gas is {scene.knudsen:.2g} of the radius; a hot "
            f"bead requires at least {FREE_MOLECULES:g}; reduce medium.pressure, or {without}"
        )
    if scene.heat.bead is not True:
        return
    if scene.medium.name in GASES:
        raise refusal(
            f"{said}: the cooling of a bead in a gas is not computed; give its temperature rise, "
            'such as heat.bead = "1000 K/W"'
        )
    _check_conductivity(scene)


def _check_conductivity(scene: Description) -> None:
    """Refuse a liquid whose thermal conductivity is not known."""
    assert scene.heat is not None
    if scene.heat.conductivity is None and scene.medium.name != "water":
        raise refusal(
            f"heat.conductivity: missing; medium.name = {scene.medium.name!r} requires it, as only "
            "the conductivity of water is known"
        )
