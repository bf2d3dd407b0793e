"""The table of named media: liquids, mixtures with water and gases, with their range and errors.

A new medium is an entry of `MEDIA`. A pure liquid takes polynomials, a gas its molecules, and a
mixture a function of `derivation.media`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from tweezer.scene.water import LIQUID, WAVELENGTHS, water

#: Wavelength of the sodium line, m, for properties that do not depend on the light
SODIUM = 0.5893e-6
#: Range of vacuum wavelengths of the liquids other than water, and of gases, m
_SEEN, _SEEN_IN_GAS = (0.4e-6, 1.1e-6), (0.3e-6, 1.7e-6)
#: Range of pressures of a gas, Pa
PRESSURES = 1e-10, 2e5
#: Largest Knudsen number, by the radius, for which a gas has the inertia of a continuum
CONTINUUM = 0.01


class Properties(NamedTuple):
    """Properties of a medium, in SI units."""

    density: float
    viscosity: float
    refractive_index: float
    mean_free_path: float | None = None
    """mean free path of the molecules, m; None for a liquid"""


@dataclass(frozen=True, kw_only=True)
class Fluid:
    """A named medium with its range and its errors."""

    name: str
    about: str
    """description in a few words"""
    temperatures: tuple[float, float]
    """range of temperatures, K"""
    part: str = ""
    """key of the scene that completes the description: fraction, molality or pressure"""
    parts: tuple[float, float] = (0.0, 0.0)
    """range of that key, in SI units"""
    wavelengths: tuple[float, float] = _SEEN
    """range of vacuum wavelengths, m"""
    density_error: float
    """relative error"""
    viscosity_error: float
    """relative error"""
    index_error: float
    """absolute error of the refractive index"""
    refraction: tuple[float, float] = (0.0, 0.0)
    """specific refraction (n^2 - 1)/(n^2 + 2)/rho of the liquid, the solute or the gas, m^3/kg, and
    its change with the squared inverse wavelength, m^5/kg"""

    @property
    def gas(self) -> bool:
        """Whether it is a gas."""
        return self.part == "pressure"

    def at(self, temperature: float, part: float, wavelength: float) -> Properties:
        """Return the properties within the range, which the caller checks.

        Parameters
        ----------
        temperature : float
            Temperature, K.
        part : float
            Value of the key `part`, in SI units.
        wavelength : float
            Wavelength of the light in vacuum, m.
        """
        raise NotImplementedError

    def _refraction(self, wavelength: float) -> float:
        """Return the specific refraction at a vacuum wavelength, m^3/kg."""
        constant, slope = self.refraction
        return constant + slope / wavelength**2

    def errors(self, found: Properties) -> Properties:
        """Return the errors of density (kg/m^3), viscosity (Pa s), index and free path (m)."""
        path = found.mean_free_path
        return Properties(
            self.density_error * found.density,
            self.viscosity_error * found.viscosity,
            self.index_error,
            None if path is None else self.viscosity_error * path,
        )


@dataclass(frozen=True, kw_only=True)
class Water(Fluid):
    """Liquid water by the releases of IAPWS."""

    def at(self, temperature: float, part: float, wavelength: float) -> Properties:  # noqa: ARG002
        """Return the properties of water."""
        return Properties(*water(temperature, wavelength))


@dataclass(frozen=True, kw_only=True)
class Liquid(Fluid):
    """A pure liquid, by polynomials in x, which goes from -1 to 1 over its temperatures."""

    density: tuple[float, ...]
    """coefficients of the density, kg/m^3"""
    log_viscosity: tuple[float, ...]
    """coefficients of the logarithm of the viscosity in Pa s"""

    def at(self, temperature: float, part: float, wavelength: float) -> Properties:  # noqa: ARG002
        """Return the properties of the liquid."""
        from tweezer.generated import media as emitted

        coldest, hottest = self.temperatures
        x = (2 * temperature - coldest - hottest) / (hottest - coldest)
        density = _polynomial(self.density, x)
        index = emitted.refractive_index(density, 1.0, self._refraction(wavelength), 1.0, 1.0)
        return Properties(density, math.exp(_polynomial(self.log_viscosity, x)), index)


@dataclass(frozen=True, kw_only=True)
class Mixture(Fluid):
    """A mixture with water."""

    function: str
    """function of `tweezer.generated.media` that returns density and viscosity"""
    molar_mass: float = 0.0
    """mass of a mole of the solute, kg/mol, for a `part` that is a molality"""

    def at(self, temperature: float, part: float, wavelength: float) -> Properties:
        """Return the properties of the mixture."""
        from tweezer.generated import media as emitted

        solvent = water(temperature, wavelength)
        function: Callable[..., tuple[float, float]] = getattr(emitted, self.function)
        density, viscosity = function(temperature, part, solvent.density, solvent.viscosity)
        mass = self.molar_mass * part
        fraction = mass / (1 + mass) if self.molar_mass else part
        index = emitted.refractive_index(
            density, fraction, self._refraction(wavelength), solvent.density,
            solvent.refractive_index,
        )  # fmt: skip
        return Properties(density, viscosity, index)


@dataclass(frozen=True, kw_only=True)
class Gas(Fluid):
    """An ideal gas, whose viscosity does not depend on the pressure."""

    part: str = "pressure"
    parts: tuple[float, float] = PRESSURES
    wavelengths: tuple[float, float] = _SEEN_IN_GAS
    density_error: float = 5e-3
    """relative error at 1 bar, which is proportional to the pressure"""
    index_error: float = 0.01
    """relative error of n - 1"""
    molar_mass: float
    """kg/mol"""
    molecules: tuple[float, float] | None = None
    """Lennard-Jones diameter, m, and energy over k, K"""
    power: tuple[float, float, float] | None = None
    """viscosity at 300 K, Pa s, power of the temperature there, and its change with ln T"""

    def at(self, temperature: float, part: float, wavelength: float) -> Properties:
        """Return the properties of the gas; `part` is its pressure, Pa."""
        from tweezer.generated import media as emitted

        if self.molecules is not None:
            viscosity = emitted.gas_viscosity(temperature, self.molar_mass, *self.molecules)
        else:
            viscosity = emitted.power_viscosity(temperature, *(self.power or ()))
        density, path = emitted.gas(temperature, part, self.molar_mass, viscosity)
        index = emitted.refractive_index(density, 1.0, self._refraction(wavelength), 1.0, 1.0)
        return Properties(density, viscosity, index, path)

    def errors(self, found: Properties) -> Properties:
        """Return the errors, which of density and index fall with the pressure."""
        pressure = found.density / self.at(300.0, 1e5, SODIUM).density
        return (
            super()
            .errors(found)
            ._replace(
                density=self.density_error * pressure * found.density,
                refractive_index=self.index_error * (found.refractive_index - 1),
            )
        )


def _polynomial(coefficients: Sequence[float], x: float) -> float:
    """Return the polynomial with these coefficients, lowest power first."""
    total = 0.0
    for each in reversed(coefficients):
        total = total * x + each
    return total


#: Named media. Errors include the uncertainty of the sources and the deviation from them
MEDIA: dict[str, Fluid] = {
    each.name: each
    for each in (
        Water(
            name="water", about="water (IAPWS SR6-08 and R9-97)", temperatures=LIQUID,
            wavelengths=WAVELENGTHS, density_error=1e-6, viscosity_error=0.01, index_error=6e-5,
        ),
        Liquid(  # fitted to IAPWS R16-17 and R17-20; index: Kedenburg et al. (2012)
            name="heavy-water", about="heavy water", temperatures=(277.15, 373.15),
            density_error=1e-4, viscosity_error=0.01, index_error=2e-3,
            refraction=(1.78936589e-4, 1.58380559e-18),
            density=(1094.7696, -23.423244, -9.4381618, 2.0975911, -0.95801874, 0.3221547),
            log_viscosity=(-7.3737225, -0.82800578, 0.22235677, -0.072083233, 0.043143376,
                           -0.020012471),
        ),
        Liquid(  # fitted to CoolProp 8.0.0; index: Rheims, Koeser and Wriedt (1997)
            name="ethanol", about="ethanol", temperatures=(273.15, 343.15),
            density_error=1e-3, viscosity_error=0.02, index_error=1e-3,
            refraction=(2.74359418e-4, 2.21599708e-18),
            density=(776.47848, -30.54156, -0.95265521, -0.35215228),
            log_viscosity=(-7.0166308, -0.64013253, 0.060952313, -0.0058937121),
        ),
        Mixture(  # Cheng (2008), Volk and Kaehler (2018)
            name="glycerol", about="glycerol and water", temperatures=LIQUID, part="fraction",
            parts=(1e-6, 1.0), density_error=4e-3, viscosity_error=0.06, index_error=2e-3,
            refraction=(2.1727e-4, 1.87e-18), function="glycerol",
        ),
        Mixture(  # Kestin, Khalifa and Correia (1981)
            name="salt-water", about="sodium chloride and water", temperatures=(293.15, LIQUID[1]),
            part="molality", parts=(0.0, 6.0), density_error=1e-3, viscosity_error=0.01,
            index_error=1e-3, refraction=(1.531e-4, 1.6e-18), function="salt_water",
            molar_mass=0.0584428,
        ),
        Mixture(  # fitted to the CRC Handbook
            name="sucrose", about="sucrose and water", temperatures=(283.15, 333.15),
            part="fraction", parts=(0.0, 0.6), density_error=2e-3, viscosity_error=0.02,
            index_error=1e-3, refraction=(2.0065e-4, 1.7e-18), function="sucrose",
        ),
        # Lemmon and Jacobsen (2004); index: Ciddor (1996), Peck and Khanna (1966), Peck and Fisher
        # (1964), Kren (2011), Mansfield and Peck (1969)
        Gas(
            name="air", about="dry air", temperatures=(200.0, 1000.0), viscosity_error=0.01,
            refraction=(1.48288784e-4, 9.03557355e-19), molar_mass=0.02896546,
            molecules=(0.360e-9, 103.3),
        ),
        Gas(
            name="nitrogen", about="nitrogen", temperatures=(200.0, 1000.0), viscosity_error=0.02,
            refraction=(1.56642999e-4, 8.86893562e-19), molar_mass=0.02801348,
            molecules=(0.3656e-9, 98.94),
        ),
        Gas(
            name="argon", about="argon", temperatures=(200.0, 1000.0), viscosity_error=0.02,
            refraction=(1.03751450e-4, 5.78814722e-19), molar_mass=0.039948,
            molecules=(0.335e-9, 143.2),
        ),
        Gas(
            name="oxygen", about="oxygen", temperatures=(200.0, 1000.0), viscosity_error=0.02,
            refraction=(1.23636040e-4, 9.65466997e-19), molar_mass=0.0319988,
            molecules=(0.3428e-9, 118.5),
        ),
        Gas(  # power law of ab initio values
            name="helium", about="helium", temperatures=(150.0, 600.0), viscosity_error=0.005,
            refraction=(1.29437998e-4, 3.11593217e-19), molar_mass=0.004002602,
            power=(19.9146e-6, 0.6882, 0.016),
        ),
    )
}  # fmt: skip
#: Names of the gases
GASES = tuple(each.name for each in MEDIA.values() if each.gas)


def parted_by(key: str) -> tuple[str, ...]:
    """Return the names of the media that a key such as `fraction` completes."""
    return tuple(each.name for each in MEDIA.values() if each.part == key)


def drag_factors(
    name: str | None, knudsen: float, accommodation: float | None
) -> tuple[float, float]:
    """Return drag and rotational drag of a sphere over Stokes's; both are 1 unless in a named gas.

    Parameters
    ----------
    name : str or None
        Name of the medium.
    knudsen : float
        Mean free path over the radius.
    accommodation : float or None
        Accommodation coefficient; 1 if it is None.
    """
    if name not in GASES:
        return 1.0, 1.0
    from tweezer.generated import media as emitted

    factors: tuple[float, float] = emitted.drag_factors(knudsen, accommodation or 1.0)
    return factors
