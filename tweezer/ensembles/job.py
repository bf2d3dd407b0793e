"""Description of an ensemble for its workers: blocks of trajectories, windows of time, files."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.walk import Walk
from tweezer.ensembles.statistics import WINDOW, Plan
from tweezer.forces.named import origins_of
from tweezer.optics import worth_attributes
from tweezer.scene.choices import METHODS
from tweezer.values.beside import NEW, Part
from tweezer.values.version import FORMAL, made_by, versions

Attributes = dict[str, Any]

#: Version of the files; those of another version cannot be resumed
FORMAT = 6
#: Trajectories of a block are a multiple of this
_BATCH = 64
#: Largest number of trajectories in a block
_MOST = 1024
#: Smallest number of blocks, if there are enough trajectories, so that all cores work
_BLOCKS = 16
#: Largest number of values in memory for one window of a block, 25 MB
_WINDOW_NUMBERS = 3 * _BATCH * WINDOW
#: Largest number of steps in a window of a block of more than one batch
_WINDOW_STEPS = 2**27

#: Names of the files of a running ensemble beside its output
_OWN = re.compile(rf"\d+\.npz|total\.npz|[0-9a-f]+\.run|\.saving-[0-9a-f]{{16}}|{NEW}")

#: Name of what the camera of a scene saw
SEEN = "seen"


@dataclass(frozen=True)
class Job:
    """Description of an ensemble, from which every worker computes its blocks.

    A block is a group of trajectories that one worker computes; a window is a stretch of their
    samples, after which a checkpoint is written.
    """

    scene: str
    """JSON, with model and method decided"""
    seed: int
    """of the random numbers"""
    trajectories: int
    """number of trajectories"""
    block: int
    """number of trajectories in a block"""
    cuts: tuple[int, ...]
    """number of the first sample of each window, and of the end"""
    skipped: int | None
    """first sample of stationary statistics; None if trajectories are written"""
    out: Path | None
    """file to write; None if the result is in memory"""
    found: Attributes
    """`found_of` in the process that began the ensemble"""

    @classmethod
    def of(cls, bound: Walk, trajectories: int, skipped: int | None, out: Path | None) -> Job:
        """Return the job, divided so that a window of a block takes at most 25 MB.

        bound: equations of motion and times of samples. trajectories: their number. skipped, out:
        see the fields. A window holds all columns of trajectories, or the position for statistics.
        A block has more than 64 trajectories only if a window of it is still some seconds' work.
        """
        samples = len(bound.times)
        width = bound.shown.width if skipped is None else bound.shown.blocks["position"]
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
        """Number of blocks of trajectories."""
        return -(-self.trajectories // self.block)

    def members(self, index: int) -> slice:
        """Return the numbers of the trajectories of a block, as a slice."""
        first = index * self.block
        return slice(first, min(first + self.block, self.trajectories))

    def share(self, index: int) -> float:
        """Return the size of a block as a part of the ensemble."""
        members = self.members(index)
        return (members.stop - members.start) / self.trajectories

    @property
    def beside(self) -> Part:
        """Folder beside the output for the checkpoints of a running ensemble."""
        assert self.out is not None
        return Part(self.out, "ensemble", _OWN)

    @property
    def part(self) -> Path:
        """Path of the folder for the checkpoints of a running ensemble."""
        return self.beside.folder

    def checkpoint(self, index: int) -> Path:
        """Return the file of the checkpoint of a block."""
        return self.part / f"{index}.npz"

    @property
    def total(self) -> Path:
        """File of the statistics of the first blocks, which are joined in order."""
        return self.part / "total.npz"


def plan_of(bound: Walk, skipped: int) -> Plan:
    """Return the plan of the statistics to gather: of all quantities that can be averaged.

    skipped: number of first samples that only the moments over time include. It is without
    displacements for the method "one-call": see `tweezer.dynamics.brownian.one_call`.
    """
    shown = bound.shown
    quantities = {name: shown.at(name) for name in shown.blocks if name != "orientation"}
    simulation = bound.scene.simulation
    return Plan(
        bound.times,
        quantities,
        skipped,
        simulation.loss_distance,
        tuple(bound.plan.centre[TRANSLATION]) if bound.equilibrium else bound.scene.start_position,
        METHODS[simulation.method].displacements,
    )


def found_of(bound: Walk) -> Attributes:
    """Return the numbers that every process determines by itself: step, versions, coefficients.

    They must be the same in all processes that work together.
    """
    (*plan, drag), (*edge, _, _) = bound.plan, bound.edge  # addresses are this process's own
    numbers = (*plan, drag.data.numbers, *edge, *bound.weights)
    coefficients = b"".join(np.asarray(each).tobytes() for each in numbers)
    return {
        "step": float(bound.step),
        "steps_per_sample": int(bound.per_sample),
        **versions(),
        "coefficients": hashlib.sha256(coefficients).hexdigest()[:16],
    }


def attributes_of(job: Job, bound: Walk) -> Attributes:
    """Return the attributes of the result: all that its numbers depend on.

    The time and machine of the computation are not among them.
    """
    others: Attributes = {}
    if own := bound.problem.others:
        others = {"other_forces": len(own), "forces_from": origins_of(own)}
    return {
        "title": bound.scene.title,
        "scene": job.scene,
        **others,
        "seed": job.seed,
        "trajectories": job.trajectories,
        "duration": float(bound.times[-1]),
        "samples": len(bound.times),
        "model": bound.scene.simulation.model or "",
        "method": bound.scene.simulation.method,
        "chosen": bound.why,
        **({} if bound.variance_bias is None else {"variance_bias": bound.variance_bias}),
        **({"loss_caveat": bound.loss_caveat} if bound.loss_caveat else {}),
        **worth_attributes(bound.scene),
        "samples_skipped": job.skipped or 0,
        "trajectories_per_block": job.block,
        "samples_per_window": max(b - a for a, b in itertools.pairwise(job.cuts)),
        "format": FORMAT,
        **{key: value for key, value in job.found.items() if key != "coefficients"},
        **made_by("ensemble", dated=False),
    }


def identity_of(job: Job, bound: Walk) -> str:
    """Return a digest of `attributes_of`, by which checkpoints of this ensemble are recognised.

    It leaves out the reasons for a choice, which workers do not know, and the wording of changes
    to the scene.
    """
    scene = bound.scene.model_dump_json(exclude_none=True, exclude={"changed"})
    attributes = {**attributes_of(job, bound), "chosen": "", "variance_bias": "", "scene": scene}
    attributes |= dict.fromkeys(FORMAL, "")
    return hashlib.sha256(json.dumps(attributes).encode()).hexdigest()
