"""Values that are filled in before a scene is checked: properties of named materials, and the
position of the wall.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

from tweezer.scene.choices import SHAPES
from tweezer.scene.courses import refusal
from tweezer.scene.keys import SEVERAL
from tweezer.scene.materials import Material, materials
from tweezer.scene.media import MEDIA, SODIUM, Fluid, Properties
from tweezer.scene.sections import FILLED, NAMED
from tweezer.scene.starts import with_starts
from tweezer.values.units import TEMPERATURE, to_si

#: Shapes of a bead that has no refractive index of its own
_WITHOUT_INDEX = [each.name for each in SHAPES.values() if each.index is False]


def filled_in(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data of a scene with the values that follow from names, materials and the cover.

    `data` has values by section and key, as given by the user. The filled keys of a section are
    listed under `FILLED`.
    """
    for kind in SEVERAL:
        data = _several(data, kind)
    data = _wall_of_the_cover(with_starts(data))
    _refuse_names_of_indices(data)
    if isinstance(bead := data.get("bead"), dict):
        data = {**data, "bead": _of_materials(data, bead)}
    if more := data.get("more_beads"):
        beads = (_of_materials(data, each) if isinstance(each, dict) else each for each in more)
        data = {**data, "more_beads": list(beads)}
    return _medium_by_name(data)


def _of_fluid(
    data: Mapping[str, Any], medium: Mapping[str, Any], fluid: Fluid, *, indexed: bool
) -> Properties:
    """Return the properties of a named medium for the data of a scene.

    The refractive index at the wavelength of the beams is included only if `indexed`. Invalid data
    gives placeholders, because the check of the keys reports the error later.
    """
    unit = {"pressure": "Pa", "molality": "mol/kg"}.get(fluid.part, "")
    try:
        temperature = to_si(medium.get("temperature"), "K", *TEMPERATURE)
        wavelengths = _wavelengths(data)
        part = to_si(medium[fluid.part], unit) if medium.get(fluid.part) is not None else None
    except (ValueError, AttributeError):
        return Properties(1000.0, 1e-3, 1.33, 3e-10)  # the check of the keys reports the error
    if fluid.part and part is None:
        raise refusal(f"medium.{fluid.part}: missing; medium.name = {fluid.name!r} requires it")
    _check_range("temperature", medium, temperature, fluid, fluid.temperatures, "K")
    if part is not None:
        _check_range(fluid.part, medium, part, fluid, fluid.parts, unit)
    low, high = fluid.wavelengths
    if indexed and not low <= wavelengths[0] <= high:
        raise refusal(
            f"beam.wavelength = {wavelengths[0]!r}: the index of {fluid.name} is known from "
            f"{low:g} to {high:g} m; give medium.refractive_index"
        )
    return fluid.at(temperature, part or 0.0, wavelengths[0] if indexed else SODIUM)


def _check_range(
    key: str,
    medium: Mapping[str, Any],
    value: float,
    fluid: Fluid,
    allowed: tuple[float, float],
    unit: str,
) -> None:
    """Refuse a value of a key of a named medium, in SI units, that is not in its range."""
    low, high = allowed
    if not low <= value <= high:
        what = f"outside the known range of {fluid.name}"
        if key == "temperature" and fluid.name == "water":
            what = f"water is {'ice' if value < low else 'steam'} at {value:g} K"
        raise refusal(
            f"medium.{key} = {medium[key]!r}: {what}; must be from {low:g} to {high:g} "
            f"{unit}".rstrip()
        )


def _wavelengths(data: Mapping[str, Any]) -> list[float]:
    """Return the vacuum wavelengths of the beams in the data of a scene, m.

    Raises `ValueError` or `AttributeError` if they are not valid.
    """
    return [
        to_si(beam.get("wavelength") if isinstance(beam, Mapping) else beam.wavelength, "m")
        for beam in (data.get("beam"), *(data.get("more_beams") or ()))
    ]


def _refuse_names_of_indices(data: Mapping[str, Any]) -> None:
    """Refuse names that stand for a refractive index if the beams have several wavelengths."""
    try:
        wavelengths = _wavelengths(data)
    except (ValueError, AttributeError):
        return  # the check of the beams reports the error
    if max(wavelengths) == min(wavelengths):
        return
    named: list[tuple[str, Any, str]] = []
    beads = [data.get("bead"), *(data.get("more_beads") or ())]
    for number, bead in enumerate(beads, start=1):
        name = "bead" if len(beads) == 1 else f"bead[{number}]"
        layers = bead.get("layers") if isinstance(bead, dict) else None
        if isinstance(layers, list | tuple):
            named += [(f"{name}.layers.{i}", each, "material") for i, each in enumerate(layers)]
        else:
            named.append((name, bead, "material"))
    named.append(("medium", data.get("medium"), "name"))
    given = [
        (f"{section}.{key} = {part[key]!r}", f"{section}.refractive_index")
        for section, part, key in named
        if isinstance(part, dict) and part.get("refractive_index") is None
        if str(part.get(key)) in (*materials(), *MEDIA)
    ]
    if given:
        names, indices = (" and ".join(each) for each in zip(*given, strict=True))
        raise refusal(
            f"{names}: {'have' if len(given) > 1 else 'has'} a different index at each of the "
            f"beams' wavelengths; give {indices}"
        )


def _of_materials(data: Mapping[str, Any], bead: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a bead with the indices and the density of its materials."""
    layers = bead.get("layers")
    if isinstance(bead.get("spheres"), list | tuple):
        bead = _spheres_of_materials(data, bead)
    if bead.get("shape") in _WITHOUT_INDEX:
        material = materials().get(str(bead.get("material")))
        if material is None or bead.get("density") is not None:
            return dict(bead)
        return {**bead, "density": material.density, FILLED: ["density"]}
    if layers is None:
        density = getattr(materials().get(str(bead.get("material"))), "density", None)
        return _with_material(data, bead, "bead", density)
    if not isinstance(layers, list | tuple) or not all(isinstance(each, dict) for each in layers):
        return dict(bead)
    density = _mean_density(layers) if bead.get("density") is None else None
    filled = {"density": density, FILLED: ["density"]} if density else {}
    within = [_with_material(data, each, f"bead.layers.{i}", None) for i, each in enumerate(layers)]
    return {**bead, **filled, "layers": within}


def _spheres_of_materials(data: Mapping[str, Any], bead: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a cluster with the indices and densities of its spheres' materials.

    The density of a sphere follows from its material unless the bead has a density. The bead's
    density is the mean, if no key gives it and every sphere has its own.
    """
    found = []
    for i, each in enumerate(bead["spheres"]):
        if not isinstance(each, dict):
            return dict(bead)
        material = each.get("material") or bead.get("material")
        of = None if bead.get("density") is not None else materials().get(str(material))
        found.append(_with_material(data, {"material": bead.get("material"), **each},
                                    f"bead.spheres.{i}", of.density if of else None))  # fmt: skip
    filled = {}
    if bead.get("density") is None and bead.get("material") is None:
        density = _mean_of_spheres(found)
        filled = {"density": density, FILLED: ["density"]} if density else {}
    return {**bead, **filled, "spheres": found}


def _mean_of_spheres(spheres: Sequence[Mapping[str, Any]]) -> float | None:
    """Return the mean density of spheres that all have one, kg/m^3; otherwise None.

    Invalid spheres give a placeholder, because the check of the keys reports the error later.
    """
    if any(each.get("density") is None for each in spheres):
        return None
    try:
        cubes = [_radius(each) ** 3 for each in spheres]
        given = [to_si(each["density"], "kg/m^3") for each in spheres]
    except (KeyError, ValueError):
        return 1000.0
    mass = sum(cube * density for cube, density in zip(cubes, given, strict=True))
    return mass / sum(cubes) if sum(cubes) > 0 else 1000.0


def _radius(part: Mapping[str, Any]) -> float:
    """Return the radius of a layer or sphere in the data of a scene, m."""
    return to_si(part["radius"], "m") if "radius" in part else to_si(part["diameter"], "m") / 2


def _with_material(
    data: Mapping[str, Any], part: Mapping[str, Any], name: str, density: float | None
) -> dict[str, Any]:
    """Return the data of a bead or layer with its material's index, and `density` if it has none.

    `data` are the data of the whole scene, and `name` is the name of the part, for messages.
    """
    filled: dict[str, Any] = {}
    if part.get("density") is None and density is not None:
        filled["density"] = density
    material = materials().get(str(part.get("material")))
    if material is not None and part.get("refractive_index") is None:
        index = _index_of(material, data, name)
        filled["refractive_index"] = (index.real, index.imag) if index.imag else index.real
    return {**part, **filled, FILLED: list(filled)} if filled else dict(part)


def _index_of(material: Material, data: Mapping[str, Any], name: str) -> complex:
    """Return the index of a material at the wavelength of the beams in the data of a scene.

    Invalid data gives a placeholder, because the check of the keys reports the error later. `name`
    is the name of the part with this material, for messages.
    """
    try:
        wavelengths = _wavelengths(data)
    except (ValueError, AttributeError):
        return 1.5 + 0j  # the check of the beams reports the error
    try:
        return material.refractive_index(wavelengths[0])
    except ValueError as error:
        raise refusal(
            f"beam.wavelength = {wavelengths[0]:g}: {error}; give {name}.refractive_index"
        ) from None


def _mean_density(layers: Sequence[Mapping[str, Any]]) -> float | None:
    """Return the mean density of a bead whose layers all have a material, kg/m^3; otherwise None.

    Invalid layers give a placeholder, because the check of the keys reports the error later.
    """
    made_of = [materials().get(str(each.get("material"))) for each in layers]
    if not all(made_of):
        return None
    try:
        radii = [_radius(each) for each in layers]
    except (KeyError, ValueError):
        return 1000.0  # the check of the layers reports the error
    cubes = [0.0, *(radius**3 for radius in radii)]
    shells = [b - a for a, b in itertools.pairwise(cubes)]
    mass = sum(of.density * shell for of, shell in zip(made_of, shells, strict=True) if of)
    return mass / cubes[-1] if min(shells) > 0 else 1000.0


def _medium_by_name(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data of a scene with missing properties of a named medium filled in."""
    medium = data.get("medium")
    if not isinstance(medium, dict) or (fluid := MEDIA.get(str(medium.get("name")))) is None:
        return data
    keys = (key for key in NAMED["medium"][1] if fluid.gas or key != "mean_free_path")
    missing = [key for key in keys if medium.get(key) is None]
    if not missing:
        return data
    found = _of_fluid(data, medium, fluid, indexed="refractive_index" in missing)
    filled = {key: getattr(found, key) for key in missing}
    return {**data, "medium": {**medium, **filled, FILLED: missing}}


def _wall_of_the_cover(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data with the wall at the face of the cover, unless the wall has a position."""
    if not isinstance(wall := data.get("wall"), dict):
        return data
    lens = data.get("lens")
    cover = lens.get("cover") if isinstance(lens, dict) else getattr(lens, "cover", None)
    if wall.get("position") is not None or cover is None:
        return data
    try:
        depth = cover.get("depth") if isinstance(cover, dict) else cover.depth
        position = -to_si(depth, "m")
    except (ValueError, AttributeError):
        return data  # the check of the cover reports the error
    return {**data, "wall": {**wall, "position": position, FILLED: ["position"]}}


def _several(data: dict[str, Any], kind: str) -> dict[str, Any]:
    """Return the data with all beams, or beads, after the first under a key of their own."""
    if isinstance(every := data.get(kind), list | tuple):
        key = SEVERAL[kind]
        if not every:
            raise refusal(f"{kind}: at least one {kind} is required")
        if data.get(key):
            raise refusal(f"{key}: cannot be combined with {kind} = [...], which gives all {kind}s")
        data = {**data, kind: every[0], key: list(every[1:])}
    return data
