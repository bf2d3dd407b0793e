"""Materials of beads: refractive index by wavelength, and density, from published measurements.

The numbers and their sources are in materials.toml.
"""

from __future__ import annotations

import bisect
import functools
import math
import tomllib
from pathlib import Path
from typing import NamedTuple

from tweezer.values.printed import scaled


class Material(NamedTuple):
    """A material of beads, with its refractive index and density from published measurements."""

    name: str
    formula: str
    """formula of the refractive index, which `refractive_index` evaluates: "sellmeier", "powers",
    "value" or "table\""""
    numbers: list[list[float]]
    """coefficients of the formula, or rows of the table: wavelength, um, n and k"""
    measured: tuple[float, float]
    """range of vacuum wavelengths of the measurement, um"""
    used: tuple[float, float]
    """range of vacuum wavelengths in which an index is provided, um"""
    error: float
    """approximate difference from other published values of the index"""
    source: str
    cited: str
    """short form of the source"""
    note: str
    density: float
    """mean density, kg/m^3"""
    density_source: str
    aliases: tuple[str, ...] = ()
    """alternative names of the material"""

    def refractive_index(self, wavelength: float) -> complex:
        """Return the refractive index n + jk at a vacuum wavelength, m.

        Raises `ValueError` with the range if the wavelength is outside it.
        """
        low, high = self.used
        um = scaled(wavelength, "um")
        if not low * (1 - 1e-9) <= um <= high * (1 + 1e-9):
            raise ValueError(
                f"the index of {self.name} is known from {low:g} to {high:g} um, not at {um:g} um"
            )
        match self.formula:
            case "sellmeier":  # n^2 = 1 + sum of B l^2/(l^2 - C), l: wavelength
                return complex(math.sqrt(1 + sum(b * um**2 / (um**2 - c) for b, c in self.numbers)))
            case "powers":  # n^2 = sum of c l^p, l: wavelength
                return complex(math.sqrt(sum(c * um**power for c, power in self.numbers)))
            case "value":
                return complex(self.numbers[0][0])
            case _:
                return self._between_rows(um)

    def _between_rows(self, um: float) -> complex:
        """Return n + jk at a wavelength `um`, interpolated linearly between rows of the table."""
        after = bisect.bisect([row[0] for row in self.numbers], um)
        after = min(max(after, 1), len(self.numbers) - 1)
        (a, n, k), (b, next_n, next_k) = self.numbers[after - 1 : after + 1]
        part = (um - a) / (b - a)
        return complex(n + part * (next_n - n), k + part * (next_k - k))


@functools.cache
def materials() -> dict[str, Material]:
    """Return all materials by name, from materials.toml."""
    whole = Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
    return {name: Material(name=name, **of) for name, of in tomllib.loads(whole).items()}
