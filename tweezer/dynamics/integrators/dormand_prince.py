"""Dormand-Prince 5(4): the thesis's `ode45`.

J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6:19 (1980); the dense output of order 4 is
Shampine's, Math. Comp. 46:135 (1986). The coefficients are read from SciPy's solver.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import RK45

from tweezer.dynamics.integrators.explicit import Explicit, Tableau

DORMAND_PRINCE = Explicit(
    Tableau(
        order=5,
        estimate=5,
        c=np.append(RK45.C, 1.0),
        a=np.pad(RK45.A, ((0, 0), (0, 1))),
        b=np.ascontiguousarray(RK45.B),
        error=np.ascontiguousarray(RK45.E),
        damping=np.zeros(0),
        extra=np.zeros((0, 7)),
        dense=np.ascontiguousarray(RK45.P.T),
    )
)
