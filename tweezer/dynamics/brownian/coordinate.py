"""Formulas for a step of one coordinate of a bead, shared by all Brownian schemes.

`tweezer.dynamics.brownian.propagator.Weights` defines the symbols. A number may be eight lanes
(`tweezer.compiled.lanes`), which the loops over rows of beads pass.
"""

from __future__ import annotations

from tweezer.compiled import named_njit


@named_njit(inner=True, error_model="numpy", forceinline=True)
def led(x, u, normal, by_u, spread):  # type: ignore[no-untyped-def]
    """Return the position (m) after a step under a constant slow velocity and noise.

    `x` is the position (m), `u` the slow velocity (m/s) and `normal` a standard normal number.
    `by_u` is the displacement per slow velocity (s), `spread` the standard deviation of noise (m).
    """
    return x + by_u * u + spread * normal


@named_njit(inner=True, error_model="numpy", forceinline=True)
def beyond_spring(x, ahead, u, u_ahead, kappa):  # type: ignore[no-untyped-def]
    """Return the change of the slow velocity from x to `ahead` beyond the spring's, m/s.

    The slow velocity is `u` at `x` and `u_ahead` at `ahead` (m/s and m). The spring changes it by
    -kappa (ahead - x), where `kappa` is stiffness over drag, 1/s.
    """
    return u_ahead - u + kappa * (ahead - x)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def relaxed(v, u, decay, by_u, noise):  # type: ignore[no-untyped-def]
    """Return the velocity, or a hidden variable, after a step of its relaxation towards u.

    The result is decay v + by_u u + noise. `v` is the value before the step, `decay` the fraction
    of it that remains, `u` (m/s) the slow velocity, `by_u` its weight, and `noise` the random
    change.
    """
    return decay * v + by_u * u + noise
