"""DOP853: order 8, error estimates of order 5 and 3, dense output of order 7.

Hairer, Norsett, Wanner, "Solving ordinary differential equations I", II.5 and II.6. The
coefficients are read from SciPy's solver.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial
from scipy.integrate import DOP853 as SOLVER

from tweezer.dynamics.integrators.explicit import Explicit, Tableau


def _dense() -> np.ndarray:
    """Return the dense output of DOP853 as weights of the rates per power of theta, (7, 16).

    theta is the fraction of the step. Hairer's nested form, theta (F0 + (1 - theta) (F1 + theta (F2
    + ...))), is expanded in powers of theta; row p has the coefficient of theta^(p + 1). Let y and
    f be the states and rates at both ends of the step h. Then F0 = y1 - y0, F1 = h f0 - F0 and
    F2 = 2 F0 - h (f0 + f1). The others are h D k, with the rates k of all stages and SciPy's
    matrix D.
    """
    stages = 16
    first, last = np.eye(stages)[0], np.eye(stages)[12]
    change = np.pad(SOLVER.B, (0, stages - 12))
    nested = [change, first - change, 2 * change - first - last, *SOLVER.D]
    theta = Polynomial([0.0, 1.0])
    factor = Polynomial([1.0])
    powers = np.zeros((7, stages))
    for number, weights in enumerate(nested):
        factor = factor * (theta if number % 2 == 0 else 1 - theta)
        coefficients = np.pad(factor.coef, (0, 8 - factor.coef.size))
        powers += np.outer(coefficients[1:], weights)
    return powers


DOP853 = Explicit(
    Tableau(
        order=8,
        estimate=8,
        c=np.concatenate([SOLVER.C, [1.0], SOLVER.C_EXTRA]),
        a=np.ascontiguousarray(SOLVER.A),
        b=np.ascontiguousarray(SOLVER.B),
        error=np.ascontiguousarray(SOLVER.E5),
        damping=np.ascontiguousarray(SOLVER.E3),
        extra=np.ascontiguousarray(SOLVER.A_EXTRA),
        dense=_dense(),
    )
)
