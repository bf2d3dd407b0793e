"""Properties of a scene's medium and the drag of its bead, each with an error."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from tweezer.optics.heat import heated
from tweezer.scene import SceneLike
from tweezer.scene.bead import bead_properties
from tweezer.scene.media import GASES, MEDIA, Properties
from tweezer.values.measured import Measured, Quantity, Result
from tweezer.values.shown import Card

DENSITY = Quantity("density", "kg/m^3", "density")
VISCOSITY = Quantity("viscosity", "Pa s", "viscosity")
INDEX = Quantity("refractive_index", "1", "refractive index")
PATH = Quantity("mean_free_path", "m", "mean free path")
KNUDSEN = Quantity("knudsen", "1", "Knudsen number, by the radius")
DRAG = Quantity("drag", "kg/s", "drag")
ROTATIONAL_DRAG = Quantity("rotational_drag", "N m s", "rotational drag")
RATE = Quantity("damping_rate", "1/s", "damping rate", shown="1/s")
SURFACE = Quantity("temperature_of_bead", "K", "temperature of the bead's surface")
NOISE = Quantity("effective_temperature", "K", "temperature of the thermal motion")
#: Largest errors of the drag in a gas of diffuse reflection: up to each Knudsen number
_GAS = ((0.1, 0.01), (1.0, 0.03), (math.inf, 0.05))
#: Slip of the continuum for diffuse reflection, in mean free paths
_SLIP = 1.22


@dataclass(frozen=True, repr=False)
class MediumProperties(Result):
    """Properties of a medium and the drag of a sphere far from walls, as returned by `medium`.

    An error is NaN if it is not known, because the scene gives the number without an error.
    """

    QUANTITIES: ClassVar = (DENSITY, VISCOSITY, INDEX, PATH, KNUDSEN, DRAG, ROTATIONAL_DRAG, RATE,
                            SURFACE, NOISE)  # fmt: skip

    name: str
    """name of the medium; "" if it has none"""
    density: float
    """density rho_m, kg/m^3"""
    density_error: float
    """error of the density, kg/m^3"""
    viscosity: float
    """dynamic viscosity mu_m, Pa s"""
    viscosity_error: float
    """error of the viscosity, Pa s"""
    refractive_index: float
    """refractive index n_m at the wavelength of the first beam"""
    refractive_index_error: float
    """error of the refractive index"""
    mean_free_path: float
    """mean free path of the molecules, m"""
    mean_free_path_error: float
    """error of the mean free path, m"""
    knudsen: float
    """Knudsen number: mean free path over the radius of the bead"""
    knudsen_error: float
    """error of the Knudsen number"""
    drag: float
    """drag coefficient beta_v, kg/s"""
    drag_error: float
    """error of the drag, kg/s"""
    rotational_drag: float
    """rotational drag coefficient beta_w, N m s"""
    rotational_drag_error: float
    """error of the rotational drag, N m s"""
    damping_rate: float
    """rate beta_v/m at which the velocity of the bead decays without fluid inertia, 1/s"""
    damping_rate_error: float
    """error of the damping rate, 1/s"""
    temperature_of_bead: float
    """temperature of the surface of the bead, K"""
    temperature_of_bead_error: float
    """error of the temperature of the bead by the absorption, K"""
    effective_temperature: float
    """temperature of the translational thermal motion of the bead, K"""
    effective_temperature_error: float
    """error of the effective temperature by the absorption, K"""

    def quantities(self) -> Iterator[Measured]:
        """Yield the numbers of the medium and of the drag."""
        for each in self.QUANTITIES:
            yield each(getattr(self, each.name), getattr(self, f"{each.name}_error"))

    def card(self) -> Card:
        """Return the card with all numbers."""
        rows = tuple(each.row() for each in self.quantities())
        return Card("MediumProperties", self.name, rows)


def medium(scene: SceneLike) -> MediumProperties:
    r"""Return the properties of a scene's medium and the drag of its sphere, each with an error.

    The drag of a sphere of radius r in a gas depends on the Knudsen number Kn = l/r,

    .. math::

        \beta_v = 6 \pi \mu r \frac{c}{c + Kn}
        \left(1 + \frac{0.31\,Kn}{0.785 + 1.152\,Kn + Kn^2}\right),
        \quad c = \frac{4}{9}\left(1 + \frac{\pi a}{8}\right),
        \quad l = \frac{\mu}{p} \sqrt{\frac{\pi k T}{2 m_g}},

    where a is the accommodation coefficient and m_g the mass of a molecule. The rotational drag is
    8 pi mu r^3/(1 + 6 Kn/a). In other media the drag is Stokes's.

    In a scene with heat, the light warms the medium and the bead. The result contains the
    properties of the medium about the bead, and the drag of the hot bead.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene of the bead.

    Returns
    -------
    MediumProperties
        The numbers, in SI units. Errors are bounds of the deviation from the real medium.

    Raises
    ------
    SceneError
        For a bead that is not a sphere, and if the light heats the medium beyond its known range.

    References
    ----------
    S. A. Beresnev, V. G. Chernyak and G. A. Fomyagin, J. Fluid Mech. 219, 405 (1990).
    D. Rings et al., Phys. Rev. Lett. 105, 090604 (2010): drag and thermal motion of a hot bead.

    Examples
    --------
    >>> data = {"name": "water", "temperature": "25 degC"}
    >>> found = tweezer.medium(tweezer.load_scene("silica-1um").replace(medium=data))
    >>> f"{1e3 * found.viscosity:.3f} mPa s, within {1e3 * found.viscosity_error:.3f}"
    '0.890 mPa s, within 0.009'
    """
    scene = heated(scene)
    bead, said, knudsen = bead_properties(scene), scene.medium, scene.knudsen
    found = Properties(said.density, said.viscosity, said.refractive_index, said.mean_free_path)
    errors = dict.fromkeys(Properties._fields, math.nan)
    if said.name is not None:
        known = MEDIA[said.name].errors(found)._asdict()
        errors |= {key: known[key] for key in said.filled}
    of_viscosity = errors["viscosity"] / said.viscosity
    hot = scene.heating
    along = about = math.hypot(of_viscosity, hot.drag_error)
    if said.name in GASES:
        accommodation = said.accommodation or 1.0
        along = math.hypot(along, error_of_slip(knudsen, accommodation))
        about = math.hypot(about, _error_of_rotation(knudsen))
    return MediumProperties(
        said.name or "",
        found.density, errors["density"], found.viscosity, errors["viscosity"],
        found.refractive_index, errors["refractive_index"],
        said.mean_free_path, errors["mean_free_path"],
        knudsen, errors["mean_free_path"] / scene.body.size,
        bead.drag, along * bead.drag, bead.rotational_drag, about * bead.rotational_drag,
        bead.drag / bead.mass, along * bead.drag / bead.mass,
        said.temperature + hot.water + hot.bead, math.hypot(hot.water_error, hot.bead_error),
        scene.noise_temperature, math.hypot(hot.water_error, hot.noise_error),
    )  # fmt: skip


def error_of_slip(knudsen: float, accommodation: float) -> float:
    """Return the relative error of the drag of a sphere in a gas.

    The formula was made for diffuse reflection, a = 1, from which published factors deviate by up
    to 5 %. For a < 1 it has the right limit of free molecules. Its slip differs from that of
    Maxwell, 1.22 (2 - a)/a, in which the difference is an error that is largest at Kn = 1.
    """
    of_form = next(error for limit, error in _GAS if knudsen < limit)
    free = 4 / 9 * (1 + math.pi * accommodation / 8)
    slip = _SLIP * (2 - accommodation) / accommodation - (1 / free - 0.31 / 0.785)
    return math.hypot(of_form, slip * knudsen / (1 + knudsen) ** 2)


def _error_of_rotation(knudsen: float) -> float:
    """Return the relative error of the rotational drag, 1/(1 + 6 Kn/a) of Stokes's.

    Its slip, 6 Kn, exceeds 3.4 Kn of a continuum (a slip length of 1.15 mean free paths).
    """
    return math.hypot(0.05, 2.6 * knudsen / ((1 + 6 * knudsen) * (1 + knudsen)))
