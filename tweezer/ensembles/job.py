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

from tweezer.ensembles.motion import Moving
from tweezer.ensembles.statistics import WINDOW, Plan
from tweezer.forces.named import origins_of
from tweezer.optics import worth_attributes
from tweezer.scene.choices import METHODS
from tweezer.values.beside import NEW, Part
from tweezer.values.version import FORMAL, made_by, versions

Attributes = dict[str, Any]

#: Version of the file format; files of another version cannot be resumed
FORMAT = 6
#: Number by which the trajectories of a block are divisible
_BATCH = 64
#: Largest number of trajectories in a block
_MOST = 1024
#: Smallest number of blocks, which keeps all cores busy, if there are enough trajectories
_BLOCKS = 16
#: Largest number of values in memory for one window of a block, 25 MB
_WINDOW_NUMBERS = 3 * _BATCH * WINDOW
#: Largest number of steps in a window of a block with more than one batch
_WINDOW_STEPS = 2**27

#: Pattern of the files of a running ensemble in the folder beside its output
_OWN = re.compile(rf"\d+\.npz|total\.npz|[0-9a-f]+\.run|\.saving-[0-9a-f]{{16}}|{NEW}")

#: Names of the variables with the positions that the camera recorded and the detector's signals
SEEN, SIGNAL = "seen", "signal"


@dataclass(frozen=True)
class Job:
    """Description of an ensemble, from which every worker can compute its blocks.

    A block is a group of trajectories that one worker computes. A window is a group of successive
    samples, after which a checkpoint is written.
    """

    scene: str
    """JSON of the scene, with model and method resolved"""
    seed: int
    """seed of the random numbers"""
    trajectories: int
    """number of trajectories"""
    block: int
    """number of trajectories in a block"""
    cuts: tuple[int, ...]
    """index of the first sample of each window, followed by the number of samples"""
    skipped: int | None
    """index of the first sample of stationary statistics; None if trajectories are written"""
    out: Path | None
    """file to write; None to keep the result in memory"""
    found: Attributes
    """value of `found_of` in the process that began the ensemble"""

    @classmethod
    def of(cls, bound: Moving, trajectories: int, skipped: int | None, out: Path | None) -> Job:
        """Return the job, divided into blocks and windows.

        A window of a block takes at most 25 MB of memory. A block has more than 64 trajectories
        only if each of its windows still takes less than a few seconds.

        Parameters
        ----------
        bound : Moving
            Equations of motion and times of samples.
        trajectories : int
            Number of trajectories.
        skipped : int, optional
            Index of the first sample of stationary statistics; None if trajectories are written.
        out : Path, optional
            File to write; None to keep the result in memory.
        """
        samples = len(bound.times)
        width = bound.shown.size if skipped is None else len(bound.origin)
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
        """Return the indices of the trajectories in a block, as a slice."""
        first = index * self.block
        return slice(first, min(first + self.block, self.trajectories))

    def share(self, index: int) -> float:
        """Return the fraction of the trajectories that a block contains."""
        members = self.members(index)
        return (members.stop - members.start) / self.trajectories

    @property
    def beside(self) -> Part:
        """Folder beside the output for checkpoints while the ensemble runs."""
        assert self.out is not None
        return Part(self.out, "ensemble", _OWN)

    @property
    def part(self) -> Path:
        """Path of the folder for checkpoints while the ensemble runs."""
        return self.beside.folder

    def checkpoint(self, index: int) -> Path:
        """Return the path of a block's checkpoint."""
        return self.part / f"{index}.npz"

    @property
    def total(self) -> Path:
        """Path of the file with the joined statistics of the first blocks."""
        return self.part / "total.npz"


def plan_of(bound: Moving, skipped: int) -> Plan:
    """Return the plan of the statistics, which includes all quantities that can be averaged.

    The first `skipped` samples enter only the moments over time. For the method "one-call" the plan
    omits displacements, because displacements between its steps differ from the motion's.
    """
    shown = bound.shown
    quantities = {name: shown.at(name) for name in shown.blocks if name != "orientation"}
    if shown.bodies > 1:
        quantities = {"position": slice(0, shown.size)}
    simulation = bound.scene.simulation
    return Plan(
        bound.times,
        quantities,
        skipped,
        bound.reach,
        bound.origin,
        METHODS[simulation.method].displacements,
        tuple(bound.scene.bead_names),
    )


def found_of(bound: Moving) -> Attributes:
    """Return the values that every process computes by itself: step, versions, coefficients.

    They must agree among all processes that work on an ensemble.
    """
    coefficients = b"".join(np.asarray(each).tobytes() for each in bound.coefficients)
    return {
        "step": float(bound.step),
        "steps_per_sample": int(bound.per_sample),
        **versions(),
        "coefficients": hashlib.sha256(coefficients).hexdigest()[:16],
    }


def attributes_of(job: Job, bound: Moving) -> Attributes:
    """Return the attributes of the result, which contain everything that its numbers depend on.

    They exclude the time and machine of the computation.
    """
    others: Attributes = {}
    if own := bound.others:
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
        **worth_attributes(bound.scene.alone(1)),
        "samples_skipped": job.skipped or 0,
        "trajectories_per_block": job.block,
        "samples_per_window": max(b - a for a, b in itertools.pairwise(job.cuts)),
        "format": FORMAT,
        **{key: value for key, value in job.found.items() if key != "coefficients"},
        **made_by("ensemble", dated=False),
    }


def identity_of(job: Job, bound: Moving) -> str:
    """Return a digest of `attributes_of`, by which checkpoints of the ensemble are recognised.

    It excludes the reasons for choices, which workers do not know, and the text of changes to the
    scene.
    """
    scene = bound.scene.model_dump_json(exclude_none=True, exclude={"changed"})
    attributes = {**attributes_of(job, bound), "chosen": "", "variance_bias": "", "scene": scene}
    attributes |= dict.fromkeys(FORMAL, "")
    return hashlib.sha256(json.dumps(attributes).encode()).hexdigest()
