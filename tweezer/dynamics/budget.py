"""What a run may be off, and why: time integration and model. The force's own error is apart."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.integrate import SOLVERS, Integration, integrate
from tweezer.dynamics.models import EquationsOfMotion, bind
from tweezer.scene import Scene

Array = NDArray[np.float64]

#: at the lowest order of convergence, 1, half the steps leave half the error
_ERROR_PER_DISTANCE = 2.0
#: tolerances of a run that is to be exact by comparison, of the scene's
_TIGHTER = 1.0 / 16.0


def error_budget(
    equations: EquationsOfMotion, run: Integration, position: Array
) -> dict[str, float]:
    """Errors of the positions of a run, m, at the times that it returns; NaN where unknown.

    position: (n, 3) m, of the run. Of a run that was interrupted, or an estimate that is, nothing
    is known.

    integration_error: of a compiled method, twice the largest distance to a run with every step
    halved. A solver of SciPy's is compared with a compiled method of tighter tolerances instead.
    model_error: largest distance to the unscaled equations with all their inertia, integrated by
    the exponential method; 0 for them, and NaN for a body that it cannot integrate.
    """
    if run.status == "interrupted":
        return {"integration_error": math.nan, "model_error": math.nan}
    if len(run.times) < 2:
        return {"integration_error": 0.0, "model_error": 0.0}
    try:
        return {
            "integration_error": _of_integration(equations, run, position),
            "model_error": _of_model(equations, run, position),
        }
    except KeyboardInterrupt:  # the run itself is whole
        return {"integration_error": math.nan, "model_error": math.nan}


def _of_integration(equations: EquationsOfMotion, run: Integration, position: Array) -> float:
    if run.method in SOLVERS:
        return _distance(_compiled(equations), run, position, tightened=_TIGHTER)
    halved = np.repeat(run.step_lengths / 2, 2)
    same = equations.scene.replace(simulation={"method": run.method})
    return _ERROR_PER_DISTANCE * _distance(same, run, position, prescribed=halved)


def _of_model(equations: EquationsOfMotion, run: Integration, position: Array) -> float:
    if equations.name.startswith("full"):
        return 0.0
    return _distance(_unscaled(equations.scene), run, position)


def _compiled(equations: EquationsOfMotion) -> Scene | None:
    """The scene with a compiled method that suits its equations."""
    method = "exponential" if equations.takes_drag_exactly else "dop853"
    slow = equations.scene.simulation.model in ("overdamped", "first-order")
    if method == "exponential" or slow:
        return equations.scene.replace(simulation={"method": method, "step": None})
    return None


def _unscaled(scene: Scene) -> Scene | None:
    full = scene.replace(
        simulation={
            "model": "full",
            "method": "exponential",
            "scaling_factor": None,
            "step": None,
            "rotation_state": "angular-velocity",
        }
    )
    return full if bind(full).takes_drag_exactly else None


def _distance(scene: Scene | None, run: Integration, position: Array, **how: Any) -> float:
    """Largest distance of a run to another of `scene`."""
    if scene is None:
        return math.nan
    equations = bind(scene)
    compared = integrate(equations, run.times, **how)
    if compared.status == "interrupted":
        raise KeyboardInterrupt
    if compared.status != "complete":
        return math.nan
    there = equations.motion(compared.times, compared.states).position
    return float(np.linalg.norm(there - position, axis=1).max())
