"""Layout of states: which columns of a state belong to which quantity of a body.

The state of a body is a row of numbers in named blocks, such as its position, its velocity and the
hidden variables of the fluid's memory. States of several copies of a scene with several bodies are
rows, `row = copy * bodies + body`. The state of a copy is therefore contiguous: the rows of its
bodies one after the other. No other module contains the number of a column.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from tweezer.values.arrays import Array

#: Columns of the position, with which every state and every sample begins
POSITION = slice(0, 3)
#: Coordinates of a body: along N1, N2, N3, and about them. Arrays by coordinate have this order
TRANSLATION, ROTATION = slice(0, 3), slice(3, 6)


#: Names along each dimension, and what they are
_COORDINATES = {
    "axis": (("x", "y", "z"), "axis, z along the light"),
    "euler_parameter": (("e0", "e1", "e2", "e3"), "Euler parameter"),
    "body_axis": (("P1", "P2", "P3"), "axis of the body"),
}


class Quantity(NamedTuple):
    """Quantity that samples of a run or an ensemble contain."""

    columns: tuple[str, ...]
    """names of its columns in a sample of thermal motion"""
    dimension: str
    unit: str
    long_name: str

    @property
    def coordinate(self) -> tuple[NDArray[np.str_], dict[str, str]]:
        """Values and attributes of the coordinate along `dimension`."""
        names, long_name = _COORDINATES[self.dimension]
        return np.array(names), {"long_name": long_name}


#: Quantities by name, in the order of their blocks in a sample
QUANTITIES = {
    "position": Quantity(
        ("x", "y", "z"), "axis", "m", "position of the bead's centre from the focus"
    ),
    "velocity": Quantity(("vx", "vy", "vz"), "axis", "m/s", "velocity"),
    "orientation": Quantity(("e0", "e1", "e2", "e3"), "euler_parameter", "1", "Euler parameters"),
    "angular_velocity": Quantity(
        ("wx", "wy", "wz"), "body_axis", "rad/s", "angular velocity, body frame"
    ),
    "in_phase": Quantity(
        ("Ix", "Iy", "Iz"), "axis", "m", "amplitude in phase with the lock-in's reference"
    ),
    "quadrature": Quantity(
        ("Qx", "Qy", "Qz"), "axis", "m", "amplitude a quarter of a period ahead of the reference"
    ),
    "feedback_force": Quantity(("ux", "uy", "uz"), "axis", "N", "force by the controller"),
    "feedback_power": Quantity(
        ("ux", "uy", "uz"), "axis", "1", "relative change of the power by the controller"
    ),
    "feedback_position": Quantity(
        ("ux", "uy", "uz"), "axis", "m", "displacement of the light by the controller"
    ),
}
#: Outputs of a controller, of which a state has at most one
FEEDBACK = tuple(name for name in QUANTITIES if name.startswith("feedback"))
#: Number of Euler parameters
EULER = len(QUANTITIES["orientation"].columns)
#: Blocks by the names of the variables in an emitted state, without their numbers
_EMITTED = {
    "q": "position",
    "v": "velocity",
    "e": "orientation",
    "edot": "euler_rates",
    "omega": "angular_velocity",
}


@dataclass(frozen=True)
class Layout:
    """Named blocks of a body's state, and the number of bodies in a state.

    Examples
    --------
    >>> pair = Layout({"position": 3, "velocity": 3}, bodies=2)
    >>> pair.at("velocity"), pair.at("velocity", body=1)
    (slice(3, 6, None), slice(9, 12, None))
    """

    blocks: Mapping[str, int]
    """number of columns of each block, in their order; the position comes first"""
    bodies: int = 1

    @classmethod
    def of_emitted(cls, state: Sequence[str]) -> Self:
        """Return the layout of an emitted module, whose `STATE` names the variables."""
        blocks: dict[str, int] = {}
        for variable in state:
            name = _EMITTED[variable.rstrip("0123456789")]
            blocks[name] = blocks.get(name, 0) + 1
        return cls(blocks)

    @classmethod
    def of_samples(
        cls, *, inertial: bool, rotates: bool, lock_in: bool = False, feedback: str = ""
    ) -> Self:
        """Return the layout of samples of thermal motion, with the quantities that they contain.

        Parameters
        ----------
        inertial : bool
            Whether there are velocities.
        rotates : bool
            Whether there are orientations.
        lock_in : bool, optional
            Whether there are amplitudes behind a lock-in.
        feedback : str, optional
            Name of the output of a controller. Default: no controller.
        """
        there = {
            "position": True,
            "velocity": inertial,
            "orientation": rotates,
            "angular_velocity": inertial and rotates,
            "in_phase": lock_in,
            "quadrature": lock_in,
            feedback: True,
        }
        return cls({
            name: len(each.columns) for name, each in QUANTITIES.items() if there.get(name)
        })  # fmt: skip

    def followed_by(self, **blocks: int) -> Layout:
        """Return this layout with more blocks at the end; a block of no columns is left out."""
        more = {name: width for name, width in blocks.items() if width}
        return Layout({**self.blocks, **more}, self.bodies)

    @property
    def width(self) -> int:
        """Number of columns of a body."""
        return sum(self.blocks.values())

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a sample of a copy: (width,) of one body, or (bodies, width)."""
        return (self.width,) if self.bodies == 1 else (self.bodies, self.width)

    @property
    def size(self) -> int:
        """Number of components of a copy's state."""
        return self.bodies * self.width

    @property
    def shown(self) -> Layout:
        """Layout of the quantities that samples contain; a state of thermal motion begins so."""
        return Layout({name: self.blocks[name] for name in QUANTITIES if name in self}, self.bodies)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of a sample of a body."""
        return tuple(column for name in self.blocks for column in QUANTITIES[name].columns)

    def __contains__(self, name: str) -> bool:
        """Return whether there is a block of that name."""
        return name in self.blocks

    @functools.cached_property
    def _first(self) -> dict[str, int]:
        """First column of each block in the row of a body."""
        ends = np.cumsum([0, *self.blocks.values()]).tolist()
        return dict(zip(self.blocks, ends, strict=False))

    def at(self, name: str, body: int = 0) -> slice:
        """Return the columns of the block `name` of a body in the state of a trajectory.

        For `body` 0 these are the columns in the row of any body.
        """
        first = body * self.width + self._first[name]
        return slice(first, first + self.blocks[name])

    def first(self, name: str) -> int:
        """Return the first column of a block in the row of a body; -1 without this block."""
        return self._first.get(name, -1)

    def by_body(self, states: Array) -> Array:
        """Return a view (copies, bodies, width) of states, whose rows are copies or bodies."""
        return states.reshape(-1, self.bodies, self.width)
