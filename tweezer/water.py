"""Water at a temperature: density, viscosity and refractive index by the standard formulations.

IAPWS-95 (density), the 2008 release on viscosity and R9-97 (refractive index), as the package
`iapws` has them, at the pressure of the atmosphere.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

#: Pressure of the atmosphere, MPa
PRESSURE = 0.101325
#: K, from and to: where it is neither ice nor steam at that pressure
LIQUID = 273.15, 373.12
#: m, from and to: wavelengths that R9-97 holds for
WAVELENGTHS = 0.2e-6, 1.1e-6
#: Wavelength of sodium's light, m: for what does not depend on it
_SODIUM = 0.5893e-6


class Water(NamedTuple):
    """SI."""

    density: float
    viscosity: float
    refractive_index: float


@functools.lru_cache(maxsize=256)
def water(temperature: float, wavelength: float = _SODIUM) -> Water:
    """Properties at a temperature, K, and a vacuum wavelength, m.

    Raises `ValueError`, saying why, out of the ranges of the formulations.
    """
    if not LIQUID[0] <= temperature <= LIQUID[1]:
        what = "ice" if temperature < LIQUID[0] else "steam"
        raise ValueError(
            f"water is {what} at {temperature:g} K; must be from {LIQUID[0]:g} to {LIQUID[1]:g} K"
        )
    if not WAVELENGTHS[0] <= wavelength <= WAVELENGTHS[1]:
        raise ValueError(
            f"the index of water is known from {WAVELENGTHS[0]:g} to {WAVELENGTHS[1]:g} m, not at "
            f"{wavelength:g} m"
        )
    from iapws import IAPWS95  # half a second

    found = IAPWS95(T=temperature, P=PRESSURE, l=wavelength * 1e6)
    return Water(float(found.rho), float(found.mu), float(found.n))
