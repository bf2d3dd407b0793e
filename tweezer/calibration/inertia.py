"""Inertia of a bead and of the surrounding fluid, as assumed in an analysis."""

from __future__ import annotations

from typing import NamedTuple

from tweezer.scene import Scene
from tweezer.scene.bead import bead_properties
from tweezer.scene.choices import MODELS, POLES
from tweezer.values.errors import SceneError


class Inertia(NamedTuple):
    """Kind of inertia of a recorded bead, independent of its size."""

    bead: bool
    """whether the bead has a mass"""
    fluid: str
    """"none", "added-mass" or "memory\""""
    poles: int = POLES
    """number of poles of the hydrodynamic memory"""
    scale: float = 1.0
    """a2 of the scaled model, which divides the mass of the bead"""

    @classmethod
    def of(cls, scene: Scene) -> Inertia:
        """Return the inertia in a scene, by default the inertia of a measured bead.

        The scene of a run specifies it. A measured bead has mass and hydrodynamic memory.
        """
        simulation, medium = scene.simulation, scene.medium
        model = simulation.model or "full"
        if not MODELS[model].inertia:
            return cls(bead=False, fluid="none")
        fluid = medium.inertia or ("memory" if model == "full" else "none")
        scale = (model == "scaled" and simulation.scaling_factor) or 1.0
        return cls(True, fluid, medium.poles or POLES, scale)

    def masses(self, scene: Scene) -> tuple[float | None, float | None]:
        """Return the mass of the bead and of the displaced fluid, kg; None where they do not apply.

        For a fluid without memory, the mass of the bead includes the added mass. The mass of the
        fluid is returned only with memory.
        """
        if not self.bead:
            return None, None
        found = bead_properties(scene)
        mass = found.mass / self.scale
        if self.fluid == "memory":
            return mass, found.displaced_mass
        return mass + (found.displaced_mass / 2 if self.fluid == "added-mass" else 0.0), None

    @staticmethod
    def refuse_relaxing(scene: Scene | None) -> None:
        """Raise `SceneError` for a medium with relaxing elements, which a fit leaves out."""
        if scene is not None and scene.medium.relaxes:
            raise SceneError(
                "medium.relaxing, medium.power_law: a fit assumes a fluid without relaxing "
                "elements; remove them from the scene, or use tweezer.rheology"
            )

    @property
    def words(self) -> str:
        """Description of the inertia in words."""
        if not self.bead:
            return "without inertia"
        fluid = {"none": "", "added-mass": " and the added mass", "memory": " and of the fluid"}
        return f"with the inertia of the bead{fluid[self.fluid]}"
