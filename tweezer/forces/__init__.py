"""What pushes and turns a bead: the contract of every force, and forces made of forces.

A force of your own is a function for `kernel` and a `UserForce`; `tweezer.simulate(scene,
forces=[...])` takes it beside the forces of the scene.
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
