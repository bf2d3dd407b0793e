"""Keys of a beam whose amplitude or phase differs around the pupil."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal, NamedTuple, Self

from pydantic import Field, StrictInt, model_validator

from tweezer.scene.courses import Section, refusal
from tweezer.values.units import Angle, BeamSigma, PositiveLength, Quantity, entries

#: Largest radial order of a Zernike term, and its largest amount, waves
_MOST_ORDERS, _MOST_WAVES = 40, 5.0
#: Difference of azimuths that is rounding, rad
_SAME = 1e-12

Place = Annotated[float, Quantity("m", -2e-5, 2e-5)]
Offset = Annotated[float, Quantity("m", -1, 1)]
Radius = Annotated[float, Quantity("m", 0, 1)]
Azimuth = Annotated[float, Quantity("rad", -20, 20)]
Sector = Annotated[tuple[Azimuth, Azimuth], entries(2)]
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
        None, description="convention of the index of aberration and amplitude terms: OSA/ANSI, "
        "from 0, or Noll, from 1"
    )  # fmt: skip
    amplitude_terms: Terms | None = Field(
        None,
        description="factor 1 + sum of a Z of the amplitude over the pupil: Zernike terms [n, m, "
        "a], or [index, a], as for aberration. The power is unchanged. Requires wave optics. "
        "Default: none",
    )
    axicon: Annotated[float, Quantity("rad", -200, 200)] = Field(
        0.0,
        description="phase of an axicon at the rim: the phase over the pupil is -axicon rho, with "
        "rho = 1 at the rim. Requires wave optics",
    )
    annulus: Annotated[tuple[Radius, Radius], entries(2)] | None = Field(
        None,
        description="inner and outer radius of the open part of the pupil; no light passes outside "
        "of it. Requires wave optics. Default: the whole pupil",
    )
    sectors: Annotated[tuple[Sector, ...], entries(1, 100)] | None = Field(
        None,
        description="open sectors of the pupil, as a list of azimuths [from, to]; no light passes "
        "outside of them. They are azimuths of the light behind the lens, from x to y, and `angle` "
        "does not turn them. Requires wave optics. Default: the whole pupil",
    )

    focus: Annotated[tuple[Spot, ...], entries(1, 100)] | None = Field(
        None, description="foci of a hologram in the pupil, whose fields add; a list of sections "
        "[[beam.focus]]. Requires wave optics. Default: one focus"
    )  # fmt: skip

    foci: Literal["field", "phase"] = Field(
        "field",
        description="field: amplitude and phase of the hologram of several foci; phase: its phase "
        "alone, in 512 x 512 pixels over the pupil, as a spatial light modulator displays it",
    )

    mask: str | None = Field(
        None,
        description="file of an array of pixels over the pupil, centred on the axis: .npy or .npz, "
        "with x ascending over the columns and y over the rows, or a grey .png of 8 bits, with y "
        "descending. No light passes outside of the array. Requires wave optics. Default: none",
    )
    mask_kind: Literal["phase", "amplitude", "field"] = Field(
        "phase",
        description="phase: rad, or levels; amplitude: from 0 to 1, or levels; field: complex, of "
        "a modulus up to 1",
    )
    mask_extent: PositiveLength | None = Field(
        None, description="width of the array in the pupil. Default: the pupil's diameter"
    )
    mask_levels: Annotated[StrictInt, Field(ge=2, le=65536)] | None = Field(
        None,
        description="number of levels n of whole numbers v in the array: the phase is 2 pi v/n, "
        "or the amplitude v/(n - 1). Default: 256",
    )
    mask_flip: Literal["none", "x", "y", "both"] = Field(
        "none", description="mirror image of the array: x -> -x, y -> -y, or both"
    )
    mask_angle: Angle = Field(
        0.0, description="angle by which the array is then turned about the axis, from x to y"
    )

    @property
    def wavefront(self) -> tuple[Zernike, ...]:
        """Zernike terms of the phase, in waves, in the order of n and m; equal terms are added."""
        return self._zernike(self.aberration)

    @property
    def modulation_terms(self) -> tuple[Zernike, ...]:
        """Zernike terms of the amplitude, in the order of n and m; equal terms are added."""
        return self._zernike(self.amplitude_terms)

    def _zernike(self, terms: Terms | None) -> tuple[Zernike, ...]:
        """Return terms in the order of n and m; equal terms are added."""
        found: dict[tuple[int, int], float] = {}
        for term in terms or ():
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
        same = all(each.m == 0 for each in (*self.wavefront, *self.modulation_terms))
        return same and not self.shaped and self.focus is None and self.pattern is None

    @property
    def pattern(self) -> str | None:
        """Key of the pattern that the light passes in the pupil: mask or sectors; None without."""
        return next((key for key in ("mask", "sectors") if getattr(self, key) is not None), None)

    @model_validator(mode="after")
    def _mask_alone(self) -> Self:
        """Refuse keys of a mask without one, and a mask or sectors with several foci."""
        keys = [
            key for key in ("mask_kind", "mask_extent", "mask_levels", "mask_flip", "mask_angle")
            if getattr(self, key) != type(self).model_fields[key].default
        ]  # fmt: skip
        if self.mask == "":
            raise refusal("mask = '': must name a file .npy, .npz or .png")
        if self.mask is None and keys:
            raise refusal(f"{keys[0]}: requires a mask; remove it, or set mask to a file")
        if self.foci == "phase" and self.focus is None:
            raise refusal("foci: requires focus; remove it, or give the foci of a hologram")
        if self.foci == "phase" and (self.annulus is not None or self.axicon):
            raise refusal("foci = 'phase': cannot be combined with annulus or axicon; remove them")
        for key in ("sectors", "focus", "annulus"):
            if self.pattern not in (None, key) and getattr(self, key) is not None:
                raise refusal(f"{self.pattern}: cannot be combined with {key}; remove one of them")
        if self.mask is not None and self.axicon:
            raise refusal("mask: cannot be combined with axicon; add the phase to the mask")
        if self.sectors is not None and self.axicon:
            raise refusal("sectors: cannot be combined with axicon; remove one of them")
        return self

    @model_validator(mode="after")
    def _sectors_apart(self) -> Self:
        """Refuse sectors that are empty, wider than a turn, or overlap."""
        turn = 2 * math.pi
        for i, (begin, end) in enumerate(self.sectors or ()):
            if not 0 < end - begin <= turn + _SAME:
                raise refusal(
                    f"sectors.{i} = [{begin:.6g}, {end:.6g}] rad: the second azimuth must be "
                    "larger than the first, by at most 2 pi (360 deg)"
                )
        found = sorted((begin % turn, end - begin) for begin, end in self.sectors or ())
        once_more = [(begin + turn, width) for begin, width in found[:1]]
        for (begin, width), (after, _) in pairwise(found + once_more):
            if begin + width > after + _SAME:
                raise refusal(
                    f"sectors: those from {begin:.6g} rad and from {after % turn:.6g} rad overlap; "
                    "join them"
                )
        return self

    @model_validator(mode="after")
    def _open(self) -> Self:
        """Refuse an annulus whose radii do not ascend."""
        if self.annulus is not None and not self.annulus[0] < self.annulus[1] * (1 - 1e-6):
            raise refusal(
                f"annulus = {list(self.annulus)}: the outer radius must be the larger one"
            )
        return self

    @model_validator(mode="after")
    def _terms_exist(self) -> Self:
        """Refuse terms of indices that no Zernike polynomial has."""
        pairs = [len(term) == 2 for _, term in self._named_terms()]
        if any(pairs) and self.aberration_order is None:
            raise refusal("aberration_order: missing; terms [index, waves] require 'osa' or 'noll'")
        if self.aberration_order is not None and not all(pairs or [False]):
            raise refusal(
                "aberration_order: applies to terms [index, waves] only; remove it, or give "
                "aberration such terms"
            )
        for where, term in self._named_terms():
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
                raise refusal(f"{where}: the amount must be at most {_MOST_WAVES:g}")
        return self

    def _named_terms(self) -> Iterator[tuple[str, Term]]:
        """Yield the terms of phase and amplitude, with their names and values in the scene."""
        for key in ("aberration", "amplitude_terms"):
            for i, term in enumerate(getattr(self, key) or ()):
                yield f"{key}.{i} = {[f'{each:g}' for each in term]}".replace("'", ""), term
