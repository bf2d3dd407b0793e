"""The user's own forces: read from an argument, and tried at the positions of a run."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numba.core.dispatcher import Dispatcher

from tweezer.forces.composed import Differenced
from tweezer.forces.force import Force, Wrench
from tweezer.forces.named import named_force
from tweezer.forces.own import fault_of, forget_faults, own_forces
from tweezer.values.arrays import Array
from tweezer.values.errors import ForceError, SceneError

#: Number of times at which a force is tried
_TIMES = 9
#: Number of beads that are tried each by itself
_ALONE = 3
#: Largest relative difference of two forces that count as equal: on a bead alone and among others,
#: or at two times
_SAME = 1e-9
#: Largest difference of most gradients from differences of the force, as a part of the largest one
_OF_GRADIENT = 0.1
#: Rounding of a force in differences of it, relative
_ROUNDING = 1e-12
#: Step of these differences, m
_STEP = 1e-10


def forces_of(given: Any) -> tuple[Force, ...]:
    """Return the forces in an argument `forces`; text names a force in a Python file.

    Raises `SceneError` unless it is a list of forces.
    """
    must = "forces: must be a list of UserForce, or of other forces of tweezer.forces"
    if isinstance(given, Force):
        raise SceneError(f"{must}; put the {type(given).__name__} in brackets")
    if callable(given):
        raise SceneError(f"{must}; did you mean [{_made(given)}]?")
    if not isinstance(given, Iterable) or isinstance(given, str):
        raise SceneError(f"{must}, not {given!r}")
    forces = tuple(named_force(each) if isinstance(each, str) else each for each in given)
    for each in forces:
        if not isinstance(each, Force):
            instead = f"; did you mean [{_made(each)}]?" if callable(each) else f", not of {each!r}"
            raise SceneError(must + instead)
    return forces


def _made(function: Any) -> str:
    """Return how a function is written as a force: "UserForce(NAME)", for a message."""
    name = str(getattr(function, "__name__", type(function).__name__))
    return (
        f"UserForce({name})" if isinstance(function, Dispatcher) else f"UserForce(kernel({name}))"
    )


def try_forces(forces: Iterable[Force], places: Array, duration: float) -> None:
    """Evaluate forces at `places` (n, 3) m, n of at least 3, and at times up to `duration`, s.

    Raises `ForceError`, with the name of the force and the problem, for a force that

    * raises an exception, is not finite or has a negative error,
    * depends on the number of beads,
    * depends on the time or exerts a torque without declaring it,
    * has a wrong gradient.
    """
    for each in forces:
        forget_faults(each)
        _try(each, places, duration)
        forget_faults(each)


def _try(force: Force, places: Array, duration: float) -> None:
    """Evaluate one force as `try_forces` does, and raise its `ForceError`."""
    unturned = np.tile([1.0, 0.0, 0.0, 0.0], (len(places), 1))
    several = np.random.default_rng(11).normal(size=unturned.shape)
    several /= np.linalg.norm(several, axis=1, keepdims=True)
    orientations: Array | None = None
    first: Wrench | None = None
    for orientations in [unturned, several] if force.oriented else [None]:
        first = None
        for time in np.linspace(0.0, duration, _TIMES).tolist():
            found = force.field(places, gradient=True, time=time, orientations=orientations)
            check_numbers(force, found)
            if first is None:
                first = found
            elif force.steady and not _alike(first.force, found.force):
                raise ForceError(f"{name_of(force)}: depends on the time; give by_time=True")
    assert first is not None
    if not force.oriented and first.moment.any():
        raise ForceError(f"{name_of(force)}: adds to wrench.moment; give turns=True")
    for i in range(-_ALONE, 0):
        at = slice(i, len(places) + i + 1)
        turned = None if orientations is None else orientations[at]
        alone = force.field(places[at], orientations=turned)
        check_numbers(force, alone)
        if not _alike(alone.force, first.force[at]):
            raise ForceError(
                f"{name_of(force)}: the force on a bead depends on how many beads there are, or "
                "changes from call to call"
            )
    differenced = Differenced(force, _STEP)
    differences = differenced.field(places, gradient=True, orientations=orientations)
    off = np.abs(first.force_gradient - differences.force_gradient).max(axis=(1, 2))
    rounding = _ROUNDING * np.abs(first.force).max() / _STEP
    largest = np.abs(differences.force_gradient).max()
    if np.median(off) > _OF_GRADIENT * largest + rounding:
        raise ForceError(
            f"{name_of(force)}: wrench.force_gradient is not the derivative of wrench.force; "
            "correct it, or omit gradient=True"
        )


def check_numbers(force: Force, found: Wrench) -> None:
    """Raise `ForceError` unless the force, torque and gradients `found` of a force are finite."""
    if not all(np.isfinite(values).all() for values in found[:4]):
        raise ForceError(fault_of(force) or f"{name_of(force)}: the force is not finite")


def _alike(one: Array, other: Array) -> bool:
    """Return whether two arrays of forces are equal within rounding."""
    return bool(np.abs(one - other).max() <= _SAME * max(np.abs(one).max(), np.abs(other).max()))


def name_of(force: Force) -> str:
    """Return the name of a force for messages: the name of its function for a user's own force."""
    own = next(own_forces(force), None)
    name = type(force).__name__ if own is None else own.function.__name__
    return f"forces: {name}"
