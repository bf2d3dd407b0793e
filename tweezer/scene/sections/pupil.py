"""Keys of a beam whose amplitude or phase differs around the pupil."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple, Self

from pydantic import Field, StrictInt, model_validator

from tweezer.scene.courses import Section, refusal
from tweezer.values.units import Angle, BeamSigma, Quantity, entries

#: Largest radial order of a Zernike term, and its largest amount, waves
_MOST_ORDERS, _MOST_WAVES = 40, 5.0

Place = Annotated[float, Quantity("m", -2e-5, 2e-5)]
Offset = Annotated[float, Quantity("m", -1, 1)]
Order = Annotated[StrictInt, Field(ge=0, le=20)]
Term = Annotated[tuple[Annotated[float, Quantity("", -2000, 2000)], ...], entries(2, 3)]
Terms = Annotated[tuple[Term, ...], entries(1, 500)]


class Zernike(NamedTuple):
    """Term of a wavefront: an amount of the Zernike polynomial of two indices."""

    n: int
    """radial order"""
    m: int
    """azimuthal order: cos(m phi), or sin(|m| phi) for m < 0"""
    amount: float
    """root mean square of the term over the pupil"""


def _of_osa(index: int) -> tuple[int, int]:
    """Return n and m of an OSA/ANSI index j = (n (n + 2) + m)/2, from 0."""
    n = int(((8 * index + 9) ** 0.5 - 3) / 2)
    n += n * (n + 3) // 2 < index
    return n, 2 * index - n * (n + 2)


def _of_noll(index: int) -> tuple[int, int]:
    """Return n and m of Noll's index, from 1: even indices are cosines, and |m| ascends for each n.

    R. J. Noll, J. Opt. Soc. Am. 66, 207 (1976).
    """
    n, left = 0, index - 1
    while left > n:
        n += 1
        left -= n
    size = n % 2 + 2 * ((left + (n + 1) % 2) // 2)
    return n, size if index % 2 == 0 else -size


#: Functions from an index of each convention to n and m, with the lowest index
_INDICES = {"osa": (0, _of_osa), "noll": (1, _of_noll)}


class Spot(Section):
    """A focus of a hologram in the pupil."""

    position: Annotated[tuple[Place, Place, Place], entries(3)] = Field(
        description="position relative to the focus of the beam"
    )
    amplitude: Annotated[float, Quantity("", 1e-6, 1e6)] = Field(
        1.0, description="amplitude relative to the other foci"
    )
    phase: Angle = Field(0.0, description="phase of its light")


class OfPupil(Section):
    """Base of a beam, with its phase and its shape over the pupil."""

    sigma_y: BeamSigma | None = Field(
        None, description="standard deviation of an elliptical Gaussian beam along its own y axis; "
        "`sigma` is then along x. `sigma = [a, b]` or `waist = [a, b]` sets both. Requires wave "
        "optics, as the next three keys. Default: sigma"
    )  # fmt: skip
    angle: Angle = Field(
        0.0, description="angle by which an elliptical or Hermite-Gaussian beam is turned about "
        "the axis, from x to y"
    )  # fmt: skip
    offset: Annotated[tuple[Offset, Offset], entries(2)] = Field(
        (0.0, 0.0), description="centre of a Gaussian beam in the pupil, x and y"
    )
    hermite: Annotated[tuple[Order, Order], entries(2)] = Field(
        (0, 0), description="orders of a Hermite-Gaussian beam along its x and y axis"
    )

    aberration: Terms | None = Field(
        None,
        description="phase over the pupil: Zernike terms [n, m, waves], or [index, waves] with "
        "`aberration_order`. Each amount is the root mean square over the pupil in waves. A term "
        "is N R(rho) cos(m phi), or N R(rho) sin(|m| phi) for m < 0, with a root mean square of 1. "
        "phi is the azimuth of the light behind the lens. Requires wave optics. Default: none",
    )
    aberration_order: Literal["osa", "noll"] | None = Field(
        None, description="convention of the index of aberration terms: OSA/ANSI, from 0, or Noll, "
        "from 1"
    )  # fmt: skip

    focus: Annotated[tuple[Spot, ...], entries(1, 100)] | None = Field(
        None, description="foci of a hologram in the pupil, whose fields add; a list of sections "
        "[[beam.focus]]. Requires wave optics. Default: one focus"
    )  # fmt: skip

    @property
    def wavefront(self) -> tuple[Zernike, ...]:
        """Zernike terms of the phase, in waves, in the order of n and m; equal terms are added."""
        found: dict[tuple[int, int], float] = {}
        for term in self.aberration or ():
            *indices, amount = term
            whole = [int(each) for each in indices]
            if len(whole) == 2:
                n, m = whole
            else:
                n, m = _INDICES[self.aberration_order or "osa"][1](whole[0])
            found[n, m] = found.get((n, m), 0.0) + amount
        return tuple(Zernike(n, m, amount) for (n, m), amount in sorted(found.items()) if amount)

    @property
    def shaped(self) -> bool:
        """Whether the beam is elliptical, off-centre or Hermite-Gaussian."""
        return self.sigma_y is not None or any(self.offset) or any(self.hermite)

    @property
    def even(self) -> bool:
        """Whether amplitude and phase are the same all around the pupil."""
        same = all(each.m == 0 for each in self.wavefront)
        return same and not self.shaped and self.focus is None

    @model_validator(mode="after")
    def _terms_exist(self) -> Self:
        """Refuse aberration terms of indices that no Zernike polynomial has."""
        pairs = [len(term) == 2 for term in self.aberration or ()]
        if any(pairs) and self.aberration_order is None:
            raise refusal("aberration_order: missing; terms [index, waves] require 'osa' or 'noll'")
        if self.aberration_order is not None and not all(pairs or [False]):
            raise refusal(
                "aberration_order: applies to terms [index, waves] only; remove it, or give "
                "aberration such terms"
            )
        for i, term in enumerate(self.aberration or ()):
            where = f"aberration.{i} = {[f'{each:g}' for each in term]}".replace("'", "")
            if any(each != int(each) for each in term[:-1]):
                raise refusal(f"{where}: the indices must be whole numbers")
            if len(term) == 2:
                lowest, find = _INDICES[self.aberration_order or "osa"]
                if term[0] < lowest:
                    raise refusal(f"{where}: the index must be at least {lowest}")
                n, m = find(int(term[0]))
            else:
                n, m = int(term[0]), int(term[1])
            if not abs(m) <= n or (n - m) % 2:
                raise refusal(f"{where}: |m| must be at most n, and n - m even")
            if n > _MOST_ORDERS:
                raise refusal(f"{where}: n must be at most {_MOST_ORDERS}")
            if abs(term[-1]) > _MOST_WAVES:
                raise refusal(f"{where}: the amount must be at most {_MOST_WAVES:g} waves")
        return self
