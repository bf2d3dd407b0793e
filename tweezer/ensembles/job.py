"""An ensemble as its workers know it: blocks of trajectories, windows of time, files."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.choices import METHODS
from tweezer.dynamics.walk import Walk
from tweezer.ensembles.statistics import WINDOW, Plan
from tweezer.optics import worth_attributes

Array = NDArray[np.float64]
Attributes = dict[str, Any]

#: of the files; those of another number cannot be resumed
FORMAT = 4
#: trajectories a block is a multiple of, and the most; blocks aimed at, so that all cores work
_BATCH, _MOST, _BLOCKS = 64, 1024, 16
#: numbers held of all samples in one window of a block, 25 MB, at most; steps of such a window, at
#: most, if a block is to be of more than one batch
_WINDOW_NUMBERS, _WINDOW_STEPS = 3 * _BATCH * WINDOW, 2**27

#: columns of a sample, dimension, unit and name of every quantity
QUANTITIES = {
    "position": (("x", "y", "z"), "axis", "m", "position of the bead's centre from the focus"),
    "velocity": (("vx", "vy", "vz"), "axis", "m/s", "velocity"),
    "orientation": (("e0", "e1", "e2", "e3"), "euler_parameter", "1", "Euler parameters"),
    "angular_velocity": (("wx", "wy", "wz"), "body_axis", "rad/s", "angular velocity, body frame"),
}
COORDINATES = {
    "axis": ["x", "y", "z"],
    "euler_parameter": ["e0", "e1", "e2", "e3"],
    "body_axis": ["P1", "P2", "P3"],
}


@dataclass(frozen=True)
class Job:
    """All that a worker needs to know."""

    scene: str
    """JSON, with model and method decided"""
    seed: int
    trajectories: int
    block: int
    """trajectories of a block"""
    cuts: tuple[int, ...]
    """samples at which windows begin, and the end"""
    skipped: int | None
    """samples; None if trajectories are written"""
    out: Path | None
    found: Attributes
    """`found_of` the process that began it"""

    @classmethod
    def of(cls, bound: Walk, trajectories: int, skipped: int | None, out: Path | None) -> Job:
        """Divided so that what is held of a window of a block is 25 MB at most: of trajectories
        all columns, for statistics the position. A block is of more than 64 trajectories only if a
        window of it is still some seconds' work.
        """
        samples = len(bound.times)
        width = len(bound.columns) if skipped is None else 3
        if skipped is None:
            window = max(1, min(samples, _WINDOW_NUMBERS // (_BATCH * width)))
            cuts = [*range(0, samples, window), samples]
        else:
            plan = plan_of(bound, skipped)
            window, cuts = plan.window, plan.cuts
        batches = min(
            _MOST // _BATCH,
            _WINDOW_NUMBERS // (_BATCH * window * width),
            _WINDOW_STEPS // (_BATCH * window * bound.per_sample),
            math.ceil(trajectories / (_BATCH * _BLOCKS)),
        )
        block = _BATCH * max(1, batches)
        scene = bound.scene.model_dump_json(exclude_none=True)
        return cls(
            scene, bound.seed, trajectories, block, tuple(cuts), skipped, out, found_of(bound)
        )

    @property
    def blocks(self) -> int:
        """How many."""
        return -(-self.trajectories // self.block)

    def members(self, index: int) -> slice:
        """The trajectories of a block."""
        first = index * self.block
        return slice(first, min(first + self.block, self.trajectories))

    def share(self, index: int) -> float:
        """The part of the ensemble that a block is."""
        members = self.members(index)
        return (members.stop - members.start) / self.trajectories

    @property
    def part(self) -> Path:
        """Where the files of an ensemble at work are."""
        assert self.out is not None
        return self.out.with_name(self.out.name + ".part")

    def checkpoint(self, index: int) -> Path:
        """What a block goes on from."""
        return self.part / f"{index}.npz"

    @property
    def marker(self) -> Path:
        """Says that `part` was made for an ensemble."""
        return self.part / "of-an-ensemble"

    @property
    def total(self) -> Path:
        """The statistics of the first blocks, joined."""
        return self.part / "total.npz"

    @property
    def lock(self) -> Path:
        """Held by the process at work."""
        assert self.out is not None
        return self.out.with_name(self.out.name + ".lock")


def plan_of(bound: Walk, skipped: int) -> Plan:
    """The statistics of all quantities that can be averaged.

    Without displacements for the method "one-call": see `tweezer.dynamics.brownian.one_call`.
    """
    quantities = {name: at for name, at in columns_of(bound).items() if name != "orientation"}
    simulation = bound.scene.simulation
    return Plan(
        bound.times,
        quantities,
        skipped,
        simulation.loss_distance,
        tuple(bound.plan.centre[:3]) if bound.equilibrium else bound.scene.start_position,
        METHODS[simulation.method].displacements,
    )


def columns_of(bound: Walk) -> dict[str, slice]:
    """Where a sample has the quantities it has."""
    found = {}
    for name, (columns, *_) in QUANTITIES.items():
        if columns[0] in bound.columns:
            first = bound.columns.index(columns[0])
            found[name] = slice(first, first + len(columns))
    return found


def found_of(bound: Walk) -> Attributes:
    """What every process finds by itself, and all that work together must find alike."""
    coefficients = b"".join(np.asarray(each).tobytes() for each in (*bound.plan, *bound.weights))
    return {
        "step": float(bound.step),
        "steps_per_sample": int(bound.per_sample),
        **{f"{name}_version": version(name) for name in ("tweezer", "numpy", "scipy", "numba")},
        "coefficients": hashlib.sha256(coefficients).hexdigest()[:16],
    }


def attributes_of(job: Job, bound: Walk) -> Attributes:
    """What the numbers depend on: nothing of when and where they are computed."""
    return {
        "title": bound.scene.title,
        "scene": job.scene,
        "seed": job.seed,
        "trajectories": job.trajectories,
        "duration": float(bound.times[-1]),
        "samples": len(bound.times),
        "model": bound.scene.simulation.model or "",
        "method": bound.scene.simulation.method,
        "chosen": bound.why,
        **worth_attributes(bound.scene),
        "samples_skipped": job.skipped or 0,
        "trajectories_per_block": job.block,
        "samples_per_window": max(b - a for a, b in itertools.pairwise(job.cuts)),
        "format": FORMAT,
        **{key: value for key, value in job.found.items() if key != "coefficients"},
    }


def identity_of(job: Job, bound: Walk) -> str:
    """Digest of `attributes_of`, less the reasons: a worker is told what was chosen, not why.

    And less the words in which the scene was changed.
    """
    scene = bound.scene.model_dump_json(exclude_none=True, exclude={"changed"})
    attributes = {**attributes_of(job, bound), "chosen": "", "title": "", "scene": scene}
    return hashlib.sha256(json.dumps(attributes).encode()).hexdigest()
