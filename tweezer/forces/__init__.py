"""Forces and torques on a bead: the interface of all forces, and combinations of forces.

To define a force, decorate a function with `kernel` and pass it to `UserForce`.
`tweezer.simulate(scene, forces=[...])` adds it to the forces of the scene.
"""

from tweezer.forces.composed import Course, Moved, Sum
from tweezer.forces.entries import matrix, number, tensor, vector
from tweezer.forces.force import Force, Pose, Wrench
from tweezer.forces.own import UserForce, kernel

__all__ = [
    "Course",
    "Force",
    "Moved",
    "Pose",
    "Sum",
    "UserForce",
    "Wrench",
    "kernel",
    "matrix",
    "number",
    "tensor",
    "vector",
]
