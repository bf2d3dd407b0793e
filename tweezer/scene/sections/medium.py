"""Sections of a scene: the medium and the wall."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Self, TypeAlias

from pydantic import Field, StrictInt, model_validator

from tweezer.scene.choices import INERTIAS, told
from tweezer.scene.courses import Section, refusal
from tweezer.scene.media import MEDIA
from tweezer.scene.sections.alternatives import BELONGING, Filled
from tweezer.values.printed import printed
from tweezer.values.units import (
    FluidDensity,
    FreePath,
    Frequency,
    Modulus,
    Molality,
    PositiveTime,
    Pressure,
    RefractiveIndex,
    Temperature,
    Viscosity,
    WallPosition,
    entries,
)

if TYPE_CHECKING:
    InertiaName: TypeAlias = str
    MediumName: TypeAlias = str
else:
    InertiaName = Literal[tuple(INERTIAS)]
    MediumName = Literal[tuple(MEDIA)]


#: Smallest and largest ratio of the frequencies of a power law
_NARROWEST, _WIDEST = 10.0, 1e12


class Relaxing(Section):
    """A Maxwell element of a polymer solution, beside the solvent's viscosity."""

    viscosity: Viscosity = Field(description="viscosity eta_j that the element adds at rest")
    time: PositiveTime = Field(description="relaxation time tau_j")


class PowerLaw(Section):
    """A complex shear modulus proportional to a power of the frequency."""

    exponent: Annotated[float, Field(ge=0.05, le=0.95)] = Field(
        description="power a of the frequency, e.g. 1/2 (Rouse), 2/3 (Zimm), 3/4 (semiflexible)"
    )
    modulus: Modulus = Field(description="modulus |G*| at the frequency `at`")
    at: Frequency = Field(description="frequency of the modulus")
    band: Annotated[tuple[Frequency, Frequency], entries(2)] = Field(
        description="frequencies between which the power law applies; the fluid is Newtonian below"
    )

    @model_validator(mode="after")
    def _band_ascends(self) -> Self:
        """Refuse a band that is too narrow or too wide."""
        low, high = self.band
        if not _NARROWEST <= high / low <= _WIDEST:
            raise refusal(
                f"band = ({low:g}, {high:g}): the frequencies must ascend, by a factor of "
                f"{_NARROWEST:g} to {_WIDEST:g}"
            )
        return self


class Medium(Filled):
    """The fluid around the bead."""

    name: MediumName | None = Field(
        None,
        description="name of the fluid, which sets refractive index (at the wavelength of the "
        "beam), density and viscosity at the temperature, unless the scene gives them",
    )
    fraction: Annotated[float, Field(ge=0, le=1)] | None = Field(
        None, description="mass fraction of glycerol or sucrose in the mixture with water"
    )
    molality: Molality | None = Field(
        None, description="sodium chloride per mass of water in salt water"
    )
    pressure: Pressure | None = Field(None, description="pressure of the gas")
    accommodation: Annotated[float, Field(ge=0.01, le=1)] | None = Field(
        None, description="part of the molecules of a gas that leave the bead with its "
        "temperature and no memory of their arrival. Default: 1",
    )  # fmt: skip
    refractive_index: RefractiveIndex = Field(
        description="refractive index n_m; not needed with a `name`"
    )
    density: FluidDensity = Field(description="density rho_m; not needed with a `name`")
    viscosity: Viscosity = Field(description="dynamic viscosity mu_m; not needed with a `name`")
    temperature: Temperature = Field(description="absolute temperature T")
    mean_free_path: FreePath = Field(
        3e-10, description="mean free path of the molecules, lambda_mfp (2.2.2); that of a gas "
        "follows from its `name`"
    )  # fmt: skip
    inertia: InertiaName | None = Field(
        None,
        description=f"fluid inertia that acts on the bead; {told(INERTIAS.values())}. Default: "
        "memory for the model full if the method supports it, otherwise none",
    )
    poles: Annotated[StrictInt, Field(ge=1, le=100)] | None = Field(
        None,
        description="number of poles of the hydrodynamic memory. Default: determined by the "
        "duration and the tolerance",
    )

    relaxing: Annotated[tuple[Relaxing, ...], entries(1, 50)] | None = Field(
        None,
        description="Maxwell elements beside the viscosity of the solvent, as [[medium.relaxing]]",
    )
    power_law: PowerLaw | None = Field(
        None, description="modulus that grows as a power of the frequency, beside the solvent"
    )
    elasticity: Modulus | None = Field(
        None, description="shear modulus of a gel, whose spring 6 pi r G pulls the bead back"
    )
    anchor: Literal["start", "trap"] | None = Field(
        None,
        description="where the gel formed about the bead: at start.position, or at the equilibrium "
        "in the light. Default: start",
    )

    @property
    def viscoelastic(self) -> bool:
        """Whether the drag depends on the frequency by more than the fluid's inertia."""
        return self.relaxes or self.elasticity is not None

    @property
    def relaxes(self) -> bool:
        """Whether the medium has relaxing elements beside the solvent."""
        return bool(self.relaxing or self.power_law)

    @property
    def relaxation_in_words(self) -> str:
        """Elements of a viscoelastic medium beside the solvent, in words."""
        parts = [
            f"{printed(each.viscosity, 'mPa s')} relaxing in {printed(each.time, 'ms')}"
            for each in self.relaxing or ()
        ]
        if (law := self.power_law) is not None:
            parts.append(
                f"|G*| = {printed(law.modulus, 'Pa')} (f/{law.at:g} Hz)^{law.exponent:.3g} from "
                f"{law.band[0]:g} to {law.band[1]:g} Hz"
            )
        if self.elasticity is not None:
            parts.append(f"{printed(self.elasticity, 'Pa')} of elasticity")
        return ", ".join(parts)

    @model_validator(mode="after")
    def _anchor_of_a_gel(self) -> Self:
        """Refuse an anchor without elasticity."""
        if self.anchor is not None and self.elasticity is None:
            raise refusal("anchor: requires elasticity; remove it")
        return self

    @model_validator(mode="after")
    def _keys_of_its_name(self) -> Self:
        """Refuse keys that do not apply to the name."""
        for key, (_, names) in BELONGING["medium"].items():
            if getattr(self, key) is not None and self.name not in names:
                allowed = " or ".join(map(repr, names))
                raise refusal(f"{key}: requires name = {allowed}; remove it")
        return self

    @model_validator(mode="after")
    def _poles_of_a_memory(self) -> Self:
        """Refuse a number of poles for a fluid without hydrodynamic memory."""
        if self.poles is not None and self.inertia not in (None, "memory"):
            raise refusal(
                f"poles: does not apply to inertia = {self.inertia!r}; remove it, or set inertia "
                "to memory"
            )
        return self


class Wall(Filled):
    """A plane across the light that ends the fluid, on one side of the bead; none if not given."""

    position: WallPosition = Field(
        description="height z of the plane relative to the focus; not needed with lens.cover, "
        "whose face is then the wall"
    )
    side: Literal["above", "below"] = Field(
        "above", description="side of the plane on which the bead is; above means larger z"
    )
    opposite: WallPosition | None = Field(
        None,
        description="height z of a second plane on the other side of the bead. The added drag of "
        "the planes is summed (Oseen)",
    )
    reflects: bool = Field(
        False, description="whether the planes reflect the light that meets them from the bead's "
        "side, by Fresnel's equations. Requires wave optics"
    )  # fmt: skip
    refractive_index: RefractiveIndex | None = Field(
        None, description="refractive index behind planes that reflect. Default: the cover's, or "
        "1.518, cover glass"
    )  # fmt: skip

    @property
    def normal(self) -> float:
        """Direction along z from the plane to the bead: 1 above, -1 below."""
        return 1.0 if self.side == "above" else -1.0

    @property
    def planes(self) -> tuple[tuple[float, float], ...]:
        """Position z, m, and normal (1 or -1 along z, to the bead) of each plane."""
        first = self.position, self.normal
        return (first,) if self.opposite is None else (first, (self.opposite, -self.normal))

    @model_validator(mode="after")
    def _index_of_a_reflection(self) -> Self:
        """Refuse an index of planes that do not reflect."""
        if self.refractive_index is not None and not self.reflects:
            raise refusal("refractive_index: requires reflects = true; remove it")
        return self

    @model_validator(mode="after")
    def _opposite_beyond(self) -> Self:
        """Refuse a second plane that is not on the bead's side of the first one."""
        if self.opposite is not None and self.normal * (self.opposite - self.position) <= 0:
            raise refusal(
                f"opposite = {self.opposite:g}: must be on the side of the bead, {self.side} "
                f"position = {self.position:g}"
            )
        return self
