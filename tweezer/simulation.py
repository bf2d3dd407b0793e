"""Simulate a scene: from its description to an `xarray.Dataset` with units and provenance."""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Callable, Sequence
from importlib.metadata import version

import numpy as np
import xarray as xr

from tweezer.analysis.derived import derived_quantities
from tweezer.dynamics import (
    Event,
    bind,
    chosen,
    closest_approach,
    error_budget,
    integrate,
    lens_touched,
    loss,
)
from tweezer.errors import PhysicsWarning, SceneError
from tweezer.optics import ray_optics_caveat
from tweezer.scene import Scene

AXES = ["x", "y", "z"]


def simulate(
    scene: Scene,
    duration: float | str | None = None,
    *,
    model: str | None = None,
    method: str | None = None,
    tolerance: float | None = None,
    events: Sequence[Event] = (),
    progress: Callable[[float], None] | None = None,
) -> xr.Dataset:
    """Release the bead of `scene` and follow it for `duration` (s, or text such as "20 ms").

    duration, model, method: in place of the scene's. tolerance: the relative tolerance; the
    scene's absolute tolerances change in the same ratio. events: to look for besides the first
    closest approach, the loss of the bead and its contact with the lens (`tweezer.capture`,
    `tweezer.Event`). progress: called with the time reached.

    Returns a dataset over `time`: position (m from the focus), velocity, orientation (Euler
    parameters) and angular_velocity (body frame) if the scene has a rotation, and the derived
    quantities of `tweezer.analysis.derived`. Every variable has units and a long name; the
    attributes hold the scene, the versions, the model, the method, what gave the force, steps,
    force calls, run time (without that of the errors), how the run ended, the events, and the
    errors of `error_budget`. `status` is "complete", "lost", "ended" (by an event of yours),
    "interrupted" or "failed"; a run that ended early holds what it reached, and a failed one also
    warns (`PhysicsWarning`).

    Raises `SceneError` for arguments that do not make a valid scene, and events that are none.
    """
    scene = _adjusted(scene, duration, model, method, tolerance)
    scene, why = chosen(scene)
    simulation = scene.simulation
    began = time.perf_counter()
    equations = bind(scene)
    times = np.linspace(0.0, simulation.duration, simulation.samples)
    if not all(isinstance(event, Event) for event in events):
        raise SceneError("events: must be a list of `tweezer.Event`")
    looked_for = [
        *events, loss(simulation.loss_distance), closest_approach(simulation.position_tolerance),
    ]  # fmt: skip
    if (lens := lens_touched(scene)) is not None:
        looked_for.append(lens)
    result = integrate(equations, times, looked_for, progress)
    wall_time = time.perf_counter() - began
    motion = equations.motion(result.times, result.states)
    run = xr.Dataset(
        {
            "position": (("time", "axis"), motion.position,
                         _about("m", "position of the bead's centre from the focus")),
            "velocity": (("time", "axis"), motion.velocity, _about("m/s", "velocity")),
        },
        coords={
            "time": ("time", result.times, _about("s", "time since release")),
            "axis": ("axis", AXES, {"long_name": "axis, z along the light"}),
        },
    )  # fmt: skip
    if motion.orientation is not None:
        run["orientation"] = (("time", "euler_parameter"), motion.orientation,
                              _about("1", "Euler parameters"))  # fmt: skip
        run["angular_velocity"] = (("time", "body_axis"), motion.angular_velocity,
                                   _about("rad/s", "angular velocity, body frame"))  # fmt: skip
        run = run.assign_coords(
            euler_parameter=["e0", "e1", "e2", "e3"], body_axis=["P1", "P2", "P3"]
        )
    run = run.merge(derived_quantities(scene, run))
    run.attrs = {
        "title": scene.description or scene.name,
        "scene": scene.model_dump_json(exclude_none=True),
        "model": simulation.model,
        "emitted_module": equations.name,
        "method": result.method,
        "force_evaluator": equations.light.evaluator,
        "ray_optics_caveat": ray_optics_caveat(scene) or "",
        "status": result.status,
        "message": result.message,
        "chosen": why,
        "events": json.dumps(
            [
                {"name": event.name, "time": event.time, "position": event.state[:3].tolist()}
                for event in result.events
            ]
        ),
        "steps": result.steps,
        "rejected_steps": result.rejected,
        "force_calls": result.force_calls,
        "wall_time": wall_time,
        **error_budget(equations, result, motion.position),
        "tweezer_version": version("tweezer"),
        "numpy_version": version("numpy"),
        "scipy_version": version("scipy"),
        "numba_version": version("numba"),
    }
    if result.status == "failed":
        warnings.warn(f"{scene.name}: {result.message}", PhysicsWarning, stacklevel=2)
    return run


def _adjusted(
    scene: Scene,
    duration: float | str | None,
    model: str | None,
    method: str | None,
    tolerance: float | None,
) -> Scene:
    changes: dict[str, object] = {
        key: value
        for key, value in (("duration", duration), ("model", model), ("method", method))
        if value is not None
    }
    if tolerance is not None:
        simulation = scene.simulation
        ratio = tolerance / simulation.relative_tolerance
        changes |= {
            "relative_tolerance": tolerance,
            "position_tolerance": simulation.position_tolerance * ratio,
            "orientation_tolerance": simulation.orientation_tolerance * ratio,
        }
    return scene.replace(simulation=changes) if changes else scene


def _about(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}
