"""What a calibration found of a free bead, in words."""

from __future__ import annotations

import math

from tweezer.analysis.free import Diffusion
from tweezer.rounding import rounded, with_uncertainty

#: What is inferred in words, with the factor to its unit and the unit.
_INFERRED = {
    "viscosity": ("viscosity", 1e3, "mPa s"),
    "radius": ("radius", 1e9, "nm"),
    "drag": ("drag", 1e9, "nN s/m"),
    "Boltzmann": ("Boltzmann's constant", 1e23, "10^-23 J/K"),
}


def diffusion_in_words(free: Diffusion, unit: str) -> str:
    """The verdict on a bead that is not trapped, in one line; unit: of the record, m or V."""
    axes = ", ".join(each.axis for each in free.axes)
    relative = free.uncertainty / free.diffusion
    factor, of = (1e12, "um^2/s") if unit == "m" else (1.0, "V^2/s")
    told = _with_interval(free.diffusion, relative, free.interval, factor, of)
    parts = [f"{axes}: no trap is seen; as of a free bead: diffusion {told}"]
    inferred = free.inferred
    if inferred is not None and free.interval[0]:
        name, factor, of = _INFERRED[inferred.name]
        told = _with_interval(inferred.value, relative, inferred.interval, factor, of)
        parts.append(f"{name} {told}")
    if free.expected is not None:
        parts.append(f"by Einstein the diffusion is {1e12 * free.expected:.4g} um^2/s")
    return "; ".join(parts)


def _with_interval(
    value: float, relative: float, ends: tuple[float, float], factor: float, unit: str
) -> str:
    """Value, standard uncertainty and 95 % interval, with as many digits as these leave."""
    low, high = (factor * end for end in ends)
    if not low or not math.isfinite(high):
        return f"below {high:.2g} {unit} (95 %)"
    error = factor * value * relative
    first, last = rounded(low, error)[0], rounded(high, error)[0]
    return f"{with_uncertainty(factor * value, error)} {unit} (95 %: {first} to {last})"
