"""Runs that continue from the end of an earlier run.

The attribute `end` of a run contains the state of its bead in its method, with the hidden variables
of the hydrodynamic memory. Without thermal motion it also contains the state of the finer run that
determines the error. The random numbers of thermal motion are counted by steps from the release, so
a continued run uses the next ones.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
from pydantic import BaseModel, ValidationError

from tweezer.results.io import scene_in
from tweezer.results.schema import events_in
from tweezer.scene import Scene, by_key
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError, SceneError

#: Sections of a scene that a state depends on
_KEPT = ("bead", "medium", "start", "wall")
#: Keys of the simulation of which the same is true
_KEPT_KEYS = ("model", "scaling_factor", "rotation_state", "method")
#: Difference of two numbers that rounding may make, as a part of them
_ROUNDING = 1e-9


class Begin(NamedTuple):
    """State from which equations of motion continue."""

    time: float
    """time since the release, s"""
    state: Array
    """(state,) in the form of the emitted equations"""
    inner: Array
    """(inner,) in the form that the method's loop uses"""
    finer: Begin | None = None
    """state of the finer run that determines the error; None if the error is unknown"""


class _State(BaseModel):
    """State at the end of a run, as it is stored: in the form of the equations and of the method's
    loop.
    """

    state: list[float]
    inner: list[float]


class End(BaseModel):
    """End of a run, as in its attribute `end`."""

    time: float
    """time of the end, s"""
    module: str
    """name of the emitted module, or the columns of a sample of thermal motion"""
    at: _State
    """state at the end; of thermal motion: the last sample, and the state without the camera's
    integrals
    """
    finer: _State | None = None
    """state of the finer run that determines the error; None if unknown or for thermal motion"""
    steps: int = 1
    """number of steps between samples, of thermal motion"""
    memory: list[float] = []
    """coefficients that define the hidden variables of the fluid's memory, of thermal motion with
    memory
    """

    @classmethod
    def of(cls, time: float, module: str, at: tuple[Array, Array], **more: Any) -> Self:
        """Return the end at a time, s, with a state in the form of the equations and in that of the
        method.
        """
        return cls(time=time, module=module, at=_state(at), **more)


def _state(at: tuple[Array, Array]) -> _State:
    """Return a pair of states, in the form of the equations and of the loop, in the form that is
    stored.
    """
    return _State(state=at[0].tolist(), inner=at[1].tolist())


def finer_state(at: tuple[Array, Array] | None) -> _State | None:
    """Return a state of the finer run, if there is one."""
    return None if at is None else _state(at)


@dataclass(frozen=True)
class Continued:
    """Earlier run that a run continues."""

    end: End
    sample: int
    """index of the last sample, counted from the release; both runs have the same sampling
    interval"""
    approached: bool
    """whether the bead has passed its closest approach"""
    seed: int | None
    """seed of the earlier run; None if it used no random numbers"""

    @property
    def begin(self) -> Begin:
        """State from which the equations of motion continue."""
        at, finer = self.end.at, self.end.finer
        other = None
        if finer is not None:
            other = Begin(self.end.time, np.array(finer.state), np.array(finer.inner))
        return Begin(self.end.time, np.array(at.state), np.array(at.inner), other)

    @property
    def mark(self) -> str:
        """Digest that distinguishes this end from others."""
        digest = hashlib.sha256(self.end.model_dump_json().encode()).hexdigest()
        return f"{self.end.time:.9g} s, {digest[:16]}"

    def check_module(self, module: str) -> None:
        """Raise `SceneError` unless the earlier run has the same equations of motion."""
        if module != self.end.module:
            raise SceneError(
                f"continue_from: the run followed {self.end.module}, this one {module}; must be "
                "the same model, with or without rotation"
            )


def continued(scene: Scene, attributes: Mapping[str, Any], times: Array) -> tuple[Scene, Continued]:
    """Return the scene of a continued run, from the release to its new end, and the earlier run.

    The earlier run gives the sampling interval, and the model, the method and the fluid inertia
    unless the scene sets them. Duration and samples are counted from the release.

    Parameters
    ----------
    scene : Scene
        Scene of the continued run; its duration is added.
    attributes : Mapping
        Attributes of the earlier run.
    times : ndarray, shape (n,)
        Times of the earlier run, s.

    Raises
    ------
    ResultError
        If the run cannot be continued: it failed, lost its bead, is a part of a run or was saved by
        an earlier version.
    SceneError
        If the scene differs from that of the run in a value on which the state of the bead depends.
    """
    end = _end_of(attributes, times)
    earlier = scene_in(attributes)
    for each, told in ((scene, "this scene"), (earlier, "the scene of the run")):
        if each.camera is not None:
            raise SceneError(
                f"camera: {told} has one, and an exposure that is open at the end of a run is not "
                "saved; remove the camera from both scenes"
            )
        if each.detector is not None and each.detector.bandwidth is not None:
            raise SceneError(
                f"detector.bandwidth: {told} has one, and the state of its filter is not saved at "
                "the end of a run; remove it from both scenes"
            )
    if scene.forces.brownian != earlier.forces.brownian:
        raise _different("forces.brownian", scene.forces.brownian, earlier.forces.brownian)
    model = scene.simulation.model
    if model not in (None, earlier.simulation.model):
        raise _different("simulation.model", model, earlier.simulation.model)
    scene = _as_decided(scene, earlier)
    for difference in _differences(scene, earlier):
        raise _different(*difference)
    interval = earlier.simulation.duration / (earlier.simulation.samples - 1)
    duration, before = scene.simulation.duration, round(end.time / interval)
    new = max(1, math.ceil(duration / interval * (1 - _ROUNDING)))
    total = end.time + duration
    if scene.forces.brownian:
        total = (before + new) * interval
    scene = scene.decided(simulation={"duration": total, "samples": before + new + 1})
    approached = any(each.name == "closest approach" for each in events_in(attributes))
    approached = approached or bool(attributes.get("approached", 0))
    seed = int(attributes["seed"]) if "seed" in attributes else None
    return scene, Continued(end, before, approached, seed)


def _end_of(attributes: Mapping[str, Any], times: Array) -> End:
    """Return the state at the end of a run, from which it can be continued."""
    status = attributes.get("status")
    if status == "lost":
        raise ResultError(
            f"continue_from: {attributes.get('message')}; a lost bead cannot be continued"
        )
    if status == "failed":
        raise ResultError(
            f"continue_from: the run {attributes.get('message')}; a failed run cannot be continued"
        )
    if "end" not in attributes:
        raise ResultError(
            "continue_from: does not contain the state at the end of a run; it is not a run, is "
            "from an earlier version, or was ended by an event in thermal motion; compute it again"
        )
    try:
        end = End.model_validate_json(attributes["end"])
    except ValidationError:
        raise ResultError("continue_from: the attribute `end` is damaged") from None
    if not len(times) or times[-1] != end.time:
        raise ResultError(
            f"continue_from: the last samples are missing; the run ends at {end.time:.9g} s; pass "
            "the whole run"
        )
    return end


def _as_decided(scene: Scene, earlier: Scene) -> Scene:
    """Return the scene with what the earlier run decided where it leaves that open."""
    simulation, medium = scene.simulation, scene.medium
    decided: dict[str, dict[str, Any]] = {"simulation": {}, "medium": {}}
    if simulation.model is None:
        decided["simulation"] |= {
            key: getattr(earlier.simulation, key) for key in ("model", "scaling_factor")
        }
    if simulation.method == "auto":
        decided["simulation"]["method"] = earlier.simulation.method
    if medium.inertia is None:
        decided["medium"]["inertia"] = earlier.medium.inertia
    if medium.poles is None and medium.inertia in (None, "memory"):
        decided["medium"]["poles"] = earlier.medium.poles
    if simulation.loss_distance > earlier.simulation.loss_distance and earlier.medium.poles:
        decided["simulation"]["loss_distance"] = earlier.simulation.loss_distance
    return scene.decided(**{name: keys for name, keys in decided.items() if keys})


def _differences(scene: Scene, earlier: Scene) -> list[tuple[str, Any, Any]]:
    """Return keys that must be the same and are not, with both values."""
    now, then = (by_key(each.model_dump(mode="json")) for each in (scene, earlier))
    keys = [key for key in now | then if key.partition(".")[0] in _KEPT]
    keys += [f"simulation.{key}" for key in _KEPT_KEYS]
    return [
        (key, now.get(key), then.get(key)) for key in keys if not _same(now.get(key), then.get(key))
    ]


def _different(key: str, now: Any, then: Any) -> SceneError:
    """Return the error for a key whose value differs from the earlier run's."""
    must = "must not be given" if then is None else f"must be {then}"
    return SceneError(
        f"{key} = {now}: differs from the run to continue, whose state belongs to its own bead, "
        f"medium, wall, start, model and method; {must}"
    )


def _same(one: Any, other: Any) -> bool:
    """Return whether two values are equal, up to rounding for numbers."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=_ROUNDING)
    return bool(one == other)


def as_attribute(end: End | None) -> dict[str, str]:
    """Return the attribute of a run that contains its end."""
    return {} if end is None else {"end": json.dumps(end.model_dump())}
