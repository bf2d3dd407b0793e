"""Mechanical properties of a scene's bead: mass, inertia, drag, weight (2.3, 2.11-2.15)."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from tweezer.scene.load import SceneLike, checked_scene
from tweezer.scene.media import GASES, drag_factors
from tweezer.scene.scene import KNUDSEN_LIMIT, Scene
from tweezer.scene.sphere import drag_of_rotation, drag_of_translation
from tweezer.values.errors import SceneError
from tweezer.values.printed import printed
from tweezer.values.shown import Card, Row, Shown


@dataclass(frozen=True, repr=False)
class BeadProperties(Shown):
    """Numbers of the bead that enter the equations of motion, in SI units."""

    mass: float
    """mass m, kg"""
    displaced_mass: float
    """mass m_f of the fluid that the bead displaces, kg"""
    moments_of_inertia: tuple[float, float, float]
    """principal moments of inertia I11, I22, I33 (A.13), kg m^2"""
    drag: float
    """drag coefficient beta_v far from walls, kg/s: Stokes's (2.15), in a named gas times its
    factor of slip; of a body that is no sphere, the inverse of its mean mobility"""
    rotational_drag: float
    """rotational drag coefficient beta_w (2.15) far from walls, N m s, likewise"""
    weight: tuple[float, float, float]
    """sum of gravity (2.11) and buoyancy (2.12), as far as the scene includes them, N"""
    knudsen: float
    """mean free path over diameter (2.2.2)"""
    slip: float | None = None
    """drag over Stokes's drag for a sphere in a named gas or a scene with heat; None otherwise"""

    def card(self) -> Card:
        """Return the card with mass, drag, weight and characteristic times."""
        thin = self.knudsen > KNUDSEN_LIMIT and self.slip is None
        doubt = "not to be trusted: the medium is no continuum for this bead" if thin else ""
        rows = (
            Row("mass", printed(self.mass, "pg")),
            Row("displaced mass", printed(self.displaced_mass, "pg")),
            Row("drag", printed(self.drag, "nN s/m"), doubt),
            Row("rotational drag", printed(self.rotational_drag, "pN nm s"), doubt),
            Row("weight in the fluid", f"{printed(-self.weight[2], 'fN')}, down"),
            Row("relaxation time", printed(self.relaxation_time, "us")),
            Row("vorticity time", printed(self.vorticity_time, "us")),
            Row("moments of inertia",
                printed(self.moments_of_inertia, "kg m^2"), detail=True),
            Row("Knudsen number", f"{self.knudsen:.2g}", detail=True),
        )  # fmt: skip
        return Card("BeadProperties", "", rows)

    @property
    def relaxation_time(self) -> float:
        """Velocity relaxation time m/beta_v, s: the epsilon of (4.6)."""
        return self.mass / self.drag

    @property
    def vorticity_time(self) -> float:
        """Time tau_f = r^2 rho_m/mu_m, s, in which vorticity diffuses over a bead radius r.

        rho_m and mu_m are the density and viscosity of the medium. With displaced mass m_f and
        Stokes's drag it is 4.5 m_f/beta_v.
        """
        return 4.5 * self.displaced_mass / self.drag * (self.slip or 1.0)


def bead_properties(scene: SceneLike) -> BeadProperties:
    """Return mass, inertia, drag and weight of the bead of a scene.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene of the bead.

    Returns
    -------
    BeadProperties
        The numbers, in SI units.

    Raises
    ------
    SceneError
        For a bead that is not a sphere.

    Examples
    --------
    >>> properties = tweezer.bead_properties("silica-1um")
    >>> f"{properties.drag:.2e} kg/s"
    '9.44e-09 kg/s'
    """
    scene = checked_scene(scene)
    if scene.bead.shape != "sphere":
        raise SceneError(
            f"bead.shape = {scene.bead.shape!r}: has no single drag coefficient; allowed: "
            "'sphere'. tweezer.resistance gives the drag of any body"
        )
    drag, rotational = drags_of_sphere(scene)
    found = properties_with_drag(scene, drag, rotational)
    if scene.medium.name not in GASES and scene.heat is None:
        return found
    stokes = drag_of_translation(scene.medium.viscosity, scene.bead.radius)
    return dataclasses.replace(found, slip=drag / stokes)


def drags_of_sphere(scene: Scene) -> tuple[float, float]:
    """Return drag beta_v, kg/s, and rotational drag beta_w, N m s, of the sphere of a scene.

    They are Stokes's (2.15), in a named gas times the factors of its Knudsen number. A bead that is
    hotter than the medium has a smaller drag.
    """
    medium, r = scene.medium, scene.bead.radius
    along, about = drag_factors(medium.name, scene.knudsen, medium.accommodation)
    if scene.heat is not None:
        along, about = along * scene.heating.drag, about * scene.heating.rotational_drag
    return (
        along * drag_of_translation(medium.viscosity, r),
        about * drag_of_rotation(medium.viscosity, r),
    )


def properties_with_drag(scene: Scene, drag: float, rotational_drag: float) -> BeadProperties:
    """Return the properties of a bead of any shape with given drag coefficients.

    Parameters
    ----------
    scene : Scene
        Scene of the bead.
    drag, rotational_drag : float
        Drag coefficients of translation, kg/s, and of rotation, N m s.
    """
    body = scene.body
    g, forces = scene.forces.gravitational_acceleration, scene.forces
    lift = scene.medium.density * body.volume * g if forces.buoyancy else 0.0
    pull = body.mass * g if forces.gravity else 0.0
    return BeadProperties(
        mass=body.mass,
        displaced_mass=scene.medium.density * body.volume,
        moments_of_inertia=body.moments_of_inertia,
        drag=drag,
        rotational_drag=rotational_drag,
        weight=(0.0, 0.0, lift - pull),
        knudsen=scene.medium.mean_free_path / (2 * body.size),
    )
