"""Parts of a step of one coordinate of a bead, as functions of numbers.

The symbols are those of `tweezer.dynamics.brownian.propagator.Weights`. A number may be eight lanes
(`tweezer.compiled.lanes`), which the loops over rows of beads hand in.
"""

from __future__ import annotations

from tweezer.compiled import named_njit


@named_njit(inner=True, error_model="numpy", forceinline=True)
def led(x, u, normal, by_u, spread):  # type: ignore[no-untyped-def]
    """Position to which a slow velocity u and noise lead."""
    return x + by_u * u + spread * normal


@named_njit(inner=True, error_model="numpy", forceinline=True)
def beyond_spring(x, ahead, u, u_ahead, kappa):  # type: ignore[no-untyped-def]
    """Rise of the slow velocity from x to `ahead` without that of the spring."""
    return u_ahead - u + kappa * (ahead - x)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def relaxed(v, u, decay, by_u, noise):  # type: ignore[no-untyped-def]
    """Velocity, or hidden variable, that decays towards u."""
    return decay * v + by_u * u + noise
