"""Quantities that a sweep computes for each case, with their errors."""

from __future__ import annotations

import dataclasses
import functools
import json
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tweezer.calibration import quantities as calibration
from tweezer.forces.acting import forces_of
from tweezer.forces.force import Force
from tweezer.forces.named import origins_of
from tweezer.optics.heat import heated
from tweezer.runs import quantities as run
from tweezer.scene import Scene, with_settings
from tweezer.scene.arguments import check_ensemble, check_seed, check_thermal, samples_skipped
from tweezer.scene.choices import SWEPT
from tweezer.trap import quantities as trap
from tweezer.values.errors import ResultError, SceneError, TweezerError
from tweezer.values.measured import Quantity, Result

#: Values of a case by name: numbers, or lists of numbers along a dimension
Values = dict[str, Any]

#: Outcomes of a case that failed, and of a case that was not computed
FAILED, MISSING = "failed", "not computed"
_OF: dict[str, tuple[Quantity, ...]] = {
    "trap": trap.QUANTITIES,
    "run": run.QUANTITIES,
    "ensemble": (
        Quantity("lost", "1", "part of the trajectories that was lost"),
        Quantity("mean", "m", "mean position over time and trajectories", "axis"),
        Quantity("variance", "m^2", "variance of the position", "axis"),
    ),
    "calibrate": calibration.QUANTITIES,
}
#: Quantities by kind of sweep and by name; energies are in k_B T
QUANTITIES = {
    of: {each.name: each.in_kT for each in every if each.swept} for of, every in _OF.items()
}


def quantities_of(of: str) -> dict[str, Quantity]:
    """Return the quantities of a kind of sweep; raises `ResultError` for an unknown kind."""
    if of not in QUANTITIES:
        raise ResultError(f"is a sweep of {of[:20]!r}; allowed: {', '.join(SWEPT)}")
    return QUANTITIES[of]


#: Default values of the arguments that only some kinds of sweep use
_DEFAULTS: dict[str, Any] = {"trajectories": 100, "seed": 0, "skip": 0.0}
#: Names of these arguments that each kind of sweep uses
USED: dict[str, tuple[str, ...]] = {
    "trap": (), "run": ("seed",), "ensemble": ("seed", "trajectories", "skip"),
    "calibrate": ("seed", "skip"),
}  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Asked:
    """Computation that a sweep performs for every case, in a form that other processes can read."""

    scene: str
    """JSON of the scene before the changes of a case"""
    of: str
    """kind of the sweep, one of `SWEPT`"""
    trajectories: int
    """number of trajectories of an ensemble"""
    seed: int
    """seed of thermal motion, the same in every case"""
    skip: float
    """time omitted at the beginning of an ensemble's statistics, or of a recording, s"""
    forces: tuple[Force | str, ...] = ()
    """the user's forces; only forces named by files can be read by another process"""
    forces_from: str = ""
    """files of these forces with their digests; "" if a force is an object"""

    def case(self, settings: Mapping[str, str]) -> Scene:
        """Return the scene of a case; raises `SceneError` if its settings are invalid."""
        return with_settings(self._scene, settings)

    @functools.cached_property
    def _scene(self) -> Scene:
        """The scene before the changes of a case, parsed once."""
        return Scene.model_validate_json(self.scene)

    def check(self, scene: Scene) -> None:
        """Raise `SceneError` if a scene or the arguments do not allow this computation."""
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
        """The user's forces, read from their files if they are named by files.

        Raises `SceneError` if a file has changed since the sweep began.
        """
        found = forces_of(self.forces)
        if self.forces_from and origins_of(found) != self.forces_from:
            raise SceneError("forces: their file changed while the sweep ran; start a new sweep")
        return found

    def compute(self, settings: Mapping[str, str]) -> Values:
        """Compute a case; return its outcome and values, or the reason for a failure."""
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
    """Characterise the trap of a scene, and return its values."""
    from tweezer.trap import Trap, characterise

    found = characterise(scene, forces=asked.own)
    if isinstance(found, Trap):
        _ = found.lifetime  # computed on first use
    return values_of(found, heated(scene).noise_temperature)


def values_of(result: Result, temperature: float) -> Values:
    """Return the values of a result with their errors, and its outcome in words.

    Energies are in k_B T at `temperature`, K.
    """
    values: Values = {}
    for each in result.quantities():
        if each.of.swept:
            found = each.in_kT(temperature)
            values[each.of.name] = found.value.tolist()
            if found.error is not None:
                values[f"{each.of.name}_error"] = found.errors.tolist()
    return values | result.words()


def _of_run(scene: Scene, asked: Asked) -> Values:
    """Simulate the bead of a scene, and return the values of the summary of its run."""
    from tweezer.runs import summarise
    from tweezer.runs.simulation import simulate

    followed = simulate(scene, seed=asked.seed if scene.forces.brownian else None, forces=asked.own)
    found = summarise(followed)
    if followed.attrs["status"] == "failed":
        raise TweezerError(followed.attrs["message"])
    end_error = float(followed.attrs["integration_error"]) + float(followed.attrs["model_error"])
    return values_of(found, heated(scene).noise_temperature) | {"end_error": [end_error] * 3}


def _of_ensemble(scene: Scene, asked: Asked) -> Values:
    """Compute the statistics of an ensemble; return the lost fraction and the moments."""
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
    """Simulate a run of a scene, calibrate the trap from it, and return the values."""
    from tweezer.calibration import calibrate
    from tweezer.reading import load_recording
    from tweezer.runs.simulation import simulate

    followed = simulate(scene, seed=asked.seed, forces=asked.own)
    if followed.attrs["status"] == "failed":
        raise TweezerError(followed.attrs["message"])
    found = calibrate(load_recording(followed).since(asked.skip))
    return values_of(found, heated(scene).noise_temperature)


_COMPUTED: dict[str, Callable[[Scene, Asked], Values]] = {
    "trap": _of_trap,
    "run": _of_run,
    "ensemble": _of_ensemble,
    "calibrate": _of_calibration,
}


def asked_of(scene: Scene, of: str, forces: Sequence[Force | str] = (), **given: Any) -> Asked:
    """Return the computation of a sweep of the kind `of`.

    `given` contains the arguments named in `USED`, or None for arguments that are not given. Raises
    `SceneError` unless `of` is one of `SWEPT`, and for an argument that this kind does not use.
    """
    if of not in SWEPT:
        raise SceneError(f"of = {of!r}: allowed: {', '.join(SWEPT)}")
    given = {name: value for name, value in given.items() if value is not None}
    for name in given:
        if name not in USED[of]:
            uses = ", ".join(each for each in SWEPT if name in USED[each])
            raise SceneError(f"{name}: applies to sweeps of {uses}, not of {of}")
    own = forces_of(forces)  # raises an error for other objects
    kept = tuple(str(Path(each).absolute()) if isinstance(each, str) else each for each in forces)
    return Asked(
        scene.model_dump_json(exclude_none=True), of, **_DEFAULTS | given, forces=kept,
        forces_from=origins_of(own),
    )  # fmt: skip


def to_text(found: Any) -> str:
    """Return values as a line of JSON, from which they are read back exactly, including NaN."""
    return json.dumps(found, separators=(",", ":"))
