"""Choice of the theory of light for a scene: ray optics or wave optics."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tweezer.scene.choices import THEORIES, evaluator
from tweezer.scene.courses import refusal
from tweezer.scene.sections import Bead, Beam, Lens, Medium, Optics

#: Largest size parameter k a for which auto uses wave optics: a 30 um bead in water at 1064 nm
LARGEST_SIZE = 120.0
#: Largest k times `simulation.loss_distance` for which auto uses waves: 130 um in water at 1064 nm
FARTHEST = 1000.0
#: Largest size parameter k a in wave optics, because the tables of harmonics grow as its cube
LARGEST_IN_WAVES = 160.0
#: Largest distance from the focus in wave optics, in 1/k: 250 um in water at 1064 nm
FARTHEST_IN_WAVES = 2000.0

#: Message for light that has no force map by ray optics
NO_MAP = (
    "optics.evaluator = 'map': rays need light that is the same all around the axis; allowed with "
    "beam.polarisation: 'averaged-reflectance', 'circular' or 'unpolarised'"
)


class Choice(NamedTuple):
    """Theory of light with which a scene is computed, and the reason."""

    theory: str
    """"rays" or "waves", as in `THEORIES`"""
    reason: str
    """reason in one short clause"""


def chosen_theory(
    optics: Optics,
    bead: Bead,
    medium: Medium,
    lens: Lens,
    beams: Sequence[Beam],
    loss_distance: float,
) -> Choice:
    """Return the theory that a lit scene names, or wave optics if it applies and is fast enough.

    Parameters
    ----------
    optics : Optics
        Section with the theory.
    bead : Bead
        The bead.
    medium : Medium
        The medium.
    lens : Lens
        The lens.
    beams : sequence of Beam
        The beams.
    loss_distance : float
        Largest distance of the bead from the focus, m.

    Raises
    ------
    PydanticCustomError
        For a theory that does not apply.
    """
    without = {"rays": no_rays(bead, lens, beams), "waves": no_waves(optics, beams)}
    asked = optics.theory
    if all(without.values()):
        raise refusal(f"optics.theory = {asked!r}: {without['waves']}, and {without['rays']}")
    if asked != "auto":
        if reason := without[asked]:
            allowed = " or ".join(repr(name) for name in ("auto", *THEORIES) if name != asked)
            raise refusal(f"optics.theory = {asked!r}: {reason}; allowed: {allowed}")
        return Choice(asked, f"optics.theory = {asked!r}")
    if reason := without["waves"]:
        return Choice("rays", reason)
    if reason := without["rays"]:
        return Choice("waves", reason)
    size = largest_wavenumber(medium, beams) * bead.body.size
    if size > LARGEST_SIZE:
        return Choice("rays", f"the size parameter k a = {size:.3g} is above {LARGEST_SIZE:g}")
    far = largest_wavenumber(medium, beams) * loss_distance
    if far > FARTHEST:
        return Choice("rays", f"k times simulation.loss_distance = {far:.3g} is above {FARTHEST:g}")
    return Choice("waves", f"the size parameter k a = {size:.3g} is at most {LARGEST_SIZE:g}")


def largest_wavenumber(medium: Medium, beams: Sequence[Beam]) -> float:
    """Return k = 2 pi n_m/lambda, 1/m, for the shortest vacuum wavelength lambda of the beams.

    n_m is the refractive index of the medium.
    """
    wavelength = min(beam.wavelength for beam in beams)
    return 2 * math.pi * medium.refractive_index / wavelength


def no_waves(optics: Optics, beams: Sequence[Beam]) -> str | None:
    """Return the reason why wave optics does not apply to a scene; None if it does."""
    return _first(_beyond_waves(optics, beams), "ray")


def no_rays(bead: Bead, lens: Lens, beams: Sequence[Beam]) -> str | None:
    """Return the reason why ray optics does not apply to a scene; None if it does."""
    return _first(_beyond_rays(bead, lens, beams), "wave")


def _first(beyond: Iterator[str], theory: str) -> str | None:
    """Return which theory the first of these settings requires; None without a setting."""
    return next((f"{what} requires {theory} optics" for what in beyond), None)


def _beyond_waves(optics: Optics, beams: Sequence[Beam]) -> Iterator[str]:
    """Yield the settings of a scene to which wave optics does not apply."""
    if "waves" not in evaluator(optics.evaluator).places:
        yield f"optics.evaluator = {optics.evaluator!r}"
    for name, beam in named_beams(beams):
        if beam.polarisation == "averaged-reflectance":
            yield f"{name}.polarisation = 'averaged-reflectance'"
        if beam.torque == "thesis":
            yield f"{name}.torque = 'thesis'"
        if beam.profile == "donut" and not beam.vortex and not _about_the_axis(beam):
            yield (
                f"{name}.profile = 'donut' without a vortex, or radial or azimuthal polarisation,"
            )


def _beyond_rays(bead: Bead, lens: Lens, beams: Sequence[Beam]) -> Iterator[str]:
    """Yield the settings of a scene to which ray optics does not apply."""
    if bead.shape != "sphere":
        yield f"bead.shape = {bead.shape!r}"
    if len(bead.shells) > 1:
        yield f"bead.layers ({len(bead.shells)} layers)"
    if bead.absorbs:
        yield f"bead.refractive_index = {bead.index:.6g}"
    if lens.cover is not None:
        yield "lens.cover"
    for name, beam in named_beams(beams):
        if beam.wavefront:
            yield f"{name}.aberration"
        if beam.focus is not None:
            yield f"{name}.focus"
        for key in ("amplitude_terms", "axicon", "annulus", "sectors", "mask"):
            if getattr(beam, key):
                yield f"{name}.{key}"
        if beam.shaped:
            yield f"{name}.sigma_y, offset or hermite"
        if beam.vortex:
            yield f"{name}.vortex = {beam.vortex}"
        if _about_the_axis(beam) or beam.polarisation == "cylindrical":
            yield f"{name}.polarisation = {beam.polarisation!r}"


def _about_the_axis(beam: Beam) -> bool:
    """Return whether the polarisation is radial or azimuthal, with an axis of symmetry."""
    return beam.polarisation in ("radial", "azimuthal")


def named_beams(beams: Sequence[Beam]) -> Iterator[tuple[str, Beam]]:
    """Yield each beam with its name in a scene: "beam" if it is the only one, else "beam[1]"..."""
    for i, beam in enumerate(beams, start=1):
        yield ("beam" if len(beams) == 1 else f"beam[{i}]"), beam
