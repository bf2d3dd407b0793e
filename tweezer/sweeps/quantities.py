"""Quantities that a sweep computes for each case, with their errors."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tweezer.forces.acting import forces_of
from tweezer.forces.equilibria import DIRECTIONS
from tweezer.forces.force import Force
from tweezer.forces.named import origins_of
from tweezer.scene import Scene, with_settings
from tweezer.scene.arguments import check_ensemble, check_seed, check_thermal, samples_skipped
from tweezer.scene.choices import SWEPT
from tweezer.scene.theory import largest_wavenumber
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import ResultError, SceneError, TweezerError

if TYPE_CHECKING:
    from tweezer.trap import Trap

#: Values of a case by name: numbers, or lists of them along a dimension
Values = dict[str, Any]

#: Words of a case that was not finished, and of one that was not begun
FAILED, MISSING = "failed", "not computed"
#: Word of a trap out of which the easiest straight way takes less than `STABLE`
SHALLOW = "shallow"
#: Energy in k_B T above which a trap is usually called stable (A. Ashkin et al., Opt. Lett. 11,
#: 288 (1986))
STABLE = 10.0

#: Distance over which the force of rays is taken to change, in radii
_RAYS = 0.02

#: Names along the dimensions of quantities
DIMENSIONS = {"axis": ["x", "y", "z"], "direction": list(DIRECTIONS)}
#: Scale and name of the unit in which a quantity is shown, in place of the SI unit
SHOWN = {
    "m": (1e6, "µm"), "W": (1e3, "mW"), "N": (1e12, "pN"), "N/m": (1e6, "pN/µm"), "s": (1e3, "ms"),
    "m^2": (1e18, "nm²"), "m^2/s": (1e12, "µm²/s"), "Pa s": (1e3, "mPa s"),
}  # fmt: skip


class Quantity(NamedTuple):
    """A variable of the result."""

    dimension: str
    """"" for one number a case"""
    unit: str
    about: str
    error: bool = True
    """whether it has one"""

    @property
    def along(self) -> list[str]:
        """Names of its numbers; of one number alone an empty one."""
        return DIMENSIONS[self.dimension] if self.dimension else [""]


QUANTITIES: dict[str, dict[str, Quantity]] = {
    "trap": {
        "equilibrium": Quantity(
            "axis", "m", "stable equilibrium nearest the focus, measured from it"
        ),
        "stiffness": Quantity("axis", "N/m", "stiffness at the equilibrium"),
        "corner_frequency": Quantity("axis", "Hz", "corner frequency at the equilibrium"),
        "resonance_frequency": Quantity("axis", "Hz", "resonance frequency along each axis"),
        "quality_factor": Quantity("axis", "1", "quality factor of this resonance"),
        "ring_radius": Quantity("", "m", "radius of the ring on which the bead is held"),
        "escape_force": Quantity("direction", "N", "largest restoring force on the way out"),
        "escape_energy": Quantity("direction", "1", "work of pulling the bead out, in k_B T"),
        "lifetime": Quantity("", "s", "mean time that thermal motion leaves the bead in the trap"),
        "force_error": Quantity("", "N", "largest error of the force of the light", error=False),
    },
    "run": {
        "outcome_time": Quantity("", "s", "time of capture, of loss, or of the end"),
        "end": Quantity("axis", "m", "last position, from the focus"),
        "overshoot": Quantity("", "m", "largest excursion beyond the axis"),
        "closest_approach": Quantity("", "m", "first closest approach to the focus"),
        "closest_approach_time": Quantity("", "s", "time of the first closest approach"),
        "largest_reynolds_number": Quantity("", "1", "largest Reynolds number"),
        "largest_force": Quantity("", "N", "largest force of the light on the way"),
    },
    "ensemble": {
        "lost": Quantity("", "1", "part of the trajectories that was lost"),
        "mean": Quantity("axis", "m", "mean position over time and trajectories"),
        "variance": Quantity("axis", "m^2", "variance of the position"),
    },
    "calibrate": {
        "stiffness": Quantity("axis", "N/m", "stiffness by the power spectrum"),
        "corner_frequency": Quantity("axis", "Hz", "corner frequency by the power spectrum"),
        "diffusion": Quantity("axis", "m^2/s", "diffusion by the power spectrum"),
    },
}


def quantities_of(of: str) -> dict[str, Quantity]:
    """Return the quantities of a sweep of `of`. Raises `ResultError` for an unknown name."""
    if of not in QUANTITIES:
        raise ResultError(f"is a sweep of {of[:20]!r}; allowed: {', '.join(SWEPT)}")
    return QUANTITIES[of]


#: Arguments that only some sweeps use: of each its value if it is not given
_DEFAULTS: dict[str, Any] = {"trajectories": 100, "seed": 0, "skip": 0.0}
#: Those that a sweep of each kind uses
USED: dict[str, tuple[str, ...]] = {
    "trap": (), "run": ("seed",), "ensemble": ("seed", "trajectories", "skip"),
    "calibrate": ("seed", "skip"),
}  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Asked:
    """What is asked of every case."""

    scene: str
    """JSON of the scene that the cases change"""
    of: str
    trajectories: int
    """of an ensemble"""
    seed: int
    """of thermal motion, the same in every case"""
    skip: float
    """time left out at the beginning of an ensemble's statistics, or of a recording, s"""
    forces: tuple[Force | str, ...] = ()
    """beside those of the scene; those named by files can be read in another process"""
    forces_from: str = ""
    """the files of these and their digests"""

    def case(self, settings: Mapping[str, str]) -> Scene:
        """The scene of a case. Raises `SceneError` if it is none."""
        return with_settings(self._scene, settings)

    @functools.cached_property
    def _scene(self) -> Scene:
        return Scene.model_validate_json(self.scene)

    def check(self, scene: Scene) -> None:
        """Raises `SceneError` for a scene, or arguments, of which it cannot be computed."""
        if self.of == "ensemble":
            check_ensemble(
                scene, self.trajectories, seed=self.seed, out=None, statistics=True,
                skip=self.skip, scheduler=None, workers=1,
            )  # fmt: skip
        elif self.of == "calibrate":
            check_thermal(scene, self.seed)
            samples_skipped(scene, self.skip)
        else:
            check_seed(self.seed)

    @functools.cached_property
    def own(self) -> tuple[Force, ...]:
        """The forces, read. Raises `SceneError` if a file has changed since the sweep began."""
        found = forces_of(self.forces)
        if self.forces_from and origins_of(found) != self.forces_from:
            raise SceneError("forces: their file changed while the sweep ran; start a new sweep")
        return found

    def compute(self, settings: Mapping[str, str]) -> Values:
        """What becomes of a case: its outcome, in a word, and values; or why it failed."""
        try:
            with warnings.catch_warnings(action="ignore"):
                scene = self.case(settings)
                self.check(scene)
                return _COMPUTED[self.of](scene, self)
        except TweezerError as error:
            return {"outcome": FAILED, "reason": "; ".join(str(error).splitlines())}
        except Exception as error:
            kind = type(error).__name__
            return {"outcome": FAILED, "reason": f"{kind}: {' '.join(str(error).split())}"}


def _of_trap(scene: Scene, asked: Asked) -> Values:
    from tweezer.trap import characterise

    return values_of_trap(characterise(scene, forces=asked.own))


def values_of_trap(trap: Trap) -> Values:
    """The values of a trap, with its outcome and caveat."""
    from tweezer.trap.heights import HELD, LOST, ON_RING, RESTS

    scene, place, error = trap.scene, trap.equilibrium, trap.force_error
    of_lifetime = trap.lifetime_caveat
    caveats = [trap.caveat, of_lifetime and f"lifetime: {of_lifetime}"]
    values: Values = {"force_error": error, "caveat": "; ".join(filter(None, caveats))}
    thermal = Boltzmann * scene.medium.temperature
    held = trap.lifetime
    values |= {
        "lifetime": math.nan if held is None else held.time,
        "lifetime_error": math.nan if held is None else held.error,
    }
    if (ring := trap.ring) is not None:
        depth = min(each.energy_kT for each in ring.escapes)
        softest = float(np.linalg.eigvals(ring.stiffness).real.min())
        return values | {
            "outcome": LOST if trap.too_shallow else ON_RING if depth >= STABLE else SHALLOW,
            "reason": trap.reason if trap.too_shallow else "",
            "ring_radius": ring.radius,
            "ring_radius_error": error / softest,
        }
    if place is None:
        return values | {"outcome": RESTS if trap.rests else LOST, "reason": trap.reason}
    errors = errors_of_trap(dataclasses.asdict(trap), scene)
    relative = errors["stiffness"] / np.abs(place.stiffness_xyz)
    depth = min(each.energy_kT for each in trap.escapes)
    frequencies = {
        "corner_frequency": (trap.corner_frequencies, 1.0),
        "resonance_frequency": (trap.resonance_frequencies, 0.5),
        "quality_factor": (trap.quality_factors, 0.5),
    }
    for name, (found, power) in frequencies.items():
        numbers = np.asarray(found)
        values |= {
            name: numbers.tolist(),
            f"{name}_error": (numbers * power * relative).tolist(),
        }
    return values | {
        "outcome": LOST if trap.too_shallow else HELD if depth >= STABLE else SHALLOW,
        "reason": trap.reason,
        "equilibrium": place.position.tolist(),
        "equilibrium_error": [errors["equilibrium"]] * 3,
        "stiffness": place.stiffness_xyz.tolist(),
        "stiffness_error": [errors["stiffness"]] * 3,
        "escape_force": [each.force for each in trap.escapes],
        "escape_force_error": errors["escape_force"],
        "escape_energy": [each.energy_kT for each in trap.escapes],
        "escape_energy_error": [each / thermal for each in errors["escape_energy"]],
    }


def errors_of_trap(trap: Mapping[str, Any], scene: Scene) -> dict[str, Any]:
    """Errors of a trap's numbers by that of the force: m, N/m, and N and J of each way out.

    trap: the fields of a `Trap` that holds the bead, as `tweezer trap --out` writes them too.
    """
    error, ways = trap["force_error"], trap["escapes"]
    lengths = [each["range"] or each["wall_at"] or trap["reach"] for each in ways]
    return {
        "equilibrium": error / min(trap["equilibrium"]["eigenvalues"]),
        "stiffness": error * gradient_of_errors(scene),
        "escape_force": [error] * len(ways),
        "escape_energy": [
            each["energy_error"] + error * length
            for each, length in zip(ways, lengths, strict=True)
        ],
    }


def gradient_of_errors(scene: Scene) -> float:
    """Largest gradient of an error of the force that is nowhere larger than 1, 1/m.

    A force of waves of the wavenumber k holds wavenumbers up to 2k, and so does its error: the
    gradient is at most 2k times the largest value (S. Bernstein's inequality). Rays have no such
    bound.
    """
    if scene.theory == "waves":
        return 2 * largest_wavenumber(scene.medium, scene.beams)
    return 1 / (_RAYS * scene.bead.radius)


def _of_run(scene: Scene, asked: Asked) -> Values:
    from tweezer.runs import summarise
    from tweezer.runs.simulation import simulate

    run = simulate(scene, seed=asked.seed if scene.forces.brownian else None, forces=asked.own)
    found = summarise(run)
    if run.attrs["status"] == "failed":
        raise TweezerError(run.attrs["message"])
    end_error = float(run.attrs["integration_error"]) + float(run.attrs["model_error"])
    single = ("outcome_time", "overshoot", "closest_approach", "closest_approach_time",
              "largest_reynolds_number")  # fmt: skip
    names = [name for each in single for name in (each, f"{each}_error")]
    return {
        "outcome": found.outcome,
        "reason": found.untold.removeprefix("; "),
        **{name: _number(getattr(found, name)) for name in names},
        "end": list(found.end),
        "end_error": [end_error] * 3,
        "largest_force": found.largest_force,
        "largest_force_error": found.force_error,
    }


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _of_ensemble(scene: Scene, asked: Asked) -> Values:
    from tweezer.ensembles import ensemble
    from tweezer.ensembles.statistics import error_of_part

    found = ensemble(
        scene, asked.trajectories, seed=asked.seed, statistics=True, skip=asked.skip, workers=1,
        forces=asked.own,
    )  # fmt: skip
    if found.attrs["status"] != "complete":
        raise KeyboardInterrupt
    n = asked.trajectories
    lost = float(found["trajectories_lost"]) / n
    moments = {"mean": "stationary_mean", "variance": "stationary_variance"}
    return {
        "outcome": "all held" if lost == 0 else "some lost" if lost < 1 else "all lost",
        "lost": lost,
        "lost_error": error_of_part(lost, n),
        **{name: found[of].values.tolist() for name, of in moments.items()},
        **{f"{name}_error": found[f"{of}_error"].values.tolist() for name, of in moments.items()},
    }


def _of_calibration(scene: Scene, asked: Asked) -> Values:
    from tweezer.calibration import calibrate
    from tweezer.reading import load_recording
    from tweezer.runs.simulation import simulate

    run = simulate(scene, seed=asked.seed, forces=asked.own)
    if run.attrs["status"] == "failed":
        raise TweezerError(run.attrs["message"])
    found = calibrate(load_recording(run).since(asked.skip))
    values = {name: [math.nan] * 3 for each in QUANTITIES["calibrate"]
              for name in (each, f"{each}_error")}  # fmt: skip
    caveats = []
    for axis in found.axes:
        i = DIMENSIONS["axis"].index(axis.axis)
        estimate, bead = axis["power spectrum"], axis.fit.bead
        if estimate.caveat:
            caveats.append(f"{axis.axis}: {estimate.caveat}")
        for name, value, error in (
            ("stiffness", estimate.stiffness, estimate.uncertainty),
            ("corner_frequency", bead.corner_frequency, axis.fit.corner_frequency_uncertainty),
            ("diffusion", axis.free_fit.bead.diffusion, axis.diffusion_uncertainty),
        ):
            values[name][i], values[f"{name}_error"][i] = value, error
    outcome = "not to be trusted" if caveats else "calibrated"
    return {**values, "outcome": outcome, "caveat": "; ".join(caveats)}


_COMPUTED: dict[str, Callable[[Scene, Asked], Values]] = {
    "trap": _of_trap,
    "run": _of_run,
    "ensemble": _of_ensemble,
    "calibrate": _of_calibration,
}


def asked_of(scene: Scene, of: str, forces: Sequence[Force | str] = (), **given: Any) -> Asked:
    """What is asked by arguments of `USED`; None for one that is not given.

    Raises `SceneError` unless `of` is one of `SWEPT`, and for an argument that it does not use.
    """
    if of not in SWEPT:
        raise SceneError(f"of = {of!r}: allowed: {', '.join(SWEPT)}")
    given = {name: value for name, value in given.items() if value is not None}
    for name in given:
        if name not in USED[of]:
            uses = ", ".join(each for each in SWEPT if name in USED[each])
            raise SceneError(f"{name}: is for sweeps of {uses}, not of {of}")
    own = forces_of(forces)  # which refuses other objects
    kept = tuple(str(Path(each).absolute()) if isinstance(each, str) else each for each in forces)
    return Asked(
        scene.model_dump_json(exclude_none=True), of, **_DEFAULTS | given, forces=kept,
        forces_from=origins_of(own),
    )  # fmt: skip


def to_text(found: Any) -> str:
    """A line of JSON; its numbers are read back as they were, NaN too."""
    return json.dumps(found, separators=(",", ":"))
