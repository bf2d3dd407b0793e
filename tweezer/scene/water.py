"""Liquid water at one atmosphere: density, viscosity and refractive index by the IAPWS releases.

The equations are in `derivation.water`. For liquid water at any temperature, the density agrees
with IAPWS-95 to 1e-6. The viscosity agrees to 3e-5 with the release of 2008, whose own uncertainty
is 1 %. The refractive index of R9-97 has an uncertainty of at most 6e-5 in visible light.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

#: Range of temperatures in which water is liquid at one atmosphere, K
LIQUID = 273.15, 373.12
#: Range of vacuum wavelengths of the release R9-97, m
WAVELENGTHS = 0.2e-6, 1.1e-6
#: Vacuum wavelength of the sodium line, m, for properties that do not depend on the light
_SODIUM = 0.5893e-6


class Water(NamedTuple):
    """Density (kg/m^3), viscosity (Pa s) and refractive index of water."""

    density: float
    viscosity: float
    refractive_index: float


@functools.lru_cache(maxsize=256)
def water(temperature: float, wavelength: float = _SODIUM) -> Water:
    """Return the properties of liquid water at one atmosphere.

    Parameters
    ----------
    temperature : float
        Temperature, K, from 273.15 to 373.12.
    wavelength : float
        Wavelength of the light in vacuum, m, from 0.2e-6 to 1.1e-6.

    Returns
    -------
    Water
        Density, kg/m^3, viscosity, Pa s, and refractive index.

    Raises
    ------
    ValueError
        If the temperature or the wavelength is outside of these ranges.

    References
    ----------
    IAPWS SR6-08(2011) for density and viscosity, IAPWS R9-97 for the refractive index.
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
    from tweezer.generated import water as emitted

    density = emitted.density(temperature)
    return Water(
        density,
        emitted.viscosity(temperature),
        emitted.refractive_index(density, temperature, wavelength),
    )
