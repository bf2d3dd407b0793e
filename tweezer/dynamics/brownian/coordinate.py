"""Parts of a step of one coordinate of a bead, as functions of numbers.

The symbols are those of `tweezer.dynamics.brownian.propagator.Weights`. A number may be eight lanes
(`tweezer.compiled.lanes`), which the loops over rows of beads hand in.
"""

from __future__ import annotations

from tweezer.compiled import named_njit


@named_njit(inner=True, error_model="numpy", forceinline=True)
def led(x, u, normal, by_u, spread):  # type: ignore[no-untyped-def]
    """Return the position (m) after a step under a constant slow velocity and noise.

    x: position, m. u: slow velocity, m/s. normal: standard normal number. by_u: displacement per
    slow velocity, s. spread: standard deviation of the noise, m.
    """
    return x + by_u * u + spread * normal


@named_njit(inner=True, error_model="numpy", forceinline=True)
def beyond_spring(x, ahead, u, u_ahead, kappa):  # type: ignore[no-untyped-def]
    """Return the change of the slow velocity from x to `ahead` beyond the spring's, m/s.

    x, ahead: positions, m. u, u_ahead: slow velocities there, m/s. kappa: stiffness over drag, 1/s:
    the spring changes the slow velocity by -kappa (ahead - x).
    """
    return u_ahead - u + kappa * (ahead - x)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def relaxed(v, u, decay, by_u, noise):  # type: ignore[no-untyped-def]
    """Return the velocity, or hidden variable, after a step in which it relaxes towards u.

    v: its value before. u: slow velocity, m/s. decay: fraction of v that is left. by_u: weight of
    u. noise: random change.
    """
    return decay * v + by_u * u + noise
