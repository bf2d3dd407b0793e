"""Compiled elimination of the states of a Markov chain, without any subtraction."""

from __future__ import annotations

from typing import Any

from numba import types

from tweezer.compiled import cached_njit

_NUMBERS = types.float64[::1]


@cached_njit(
    types.void(types.float64[:, ::1], _NUMBERS, _NUMBERS, _NUMBERS),
    error_model="numpy", nogil=True,
)  # fmt: skip
def mean_times(rates: Any, lost: Any, spent: Any, times: Any) -> None:
    """Compute the mean time until a Markov chain of n states is lost, from each state.

    `rates` (n, 2 w + 1), 1/s, has the rate from state i to i + k in [i, w + k], where w is the
    largest distance of connected states. `lost` (n,), 1/s, are the rates at which states are lost.
    `spent` (n,) is 1, or 0 for a state that counts as lost from the beginning. These three are
    overwritten. The times are written to `times` (n,), s.

    States are eliminated one by one, without subtractions (Grassmann, Taksar, Heyman, Oper. Res.
    33, 1107 (1985)). Because all terms are positive, every time has the relative accuracy of the
    rates, however long it is.
    """
    n, width = rates.shape[0], (rates.shape[1] - 1) // 2
    for s in range(n):
        last = min(s + width, n - 1)
        left = lost[s]  # total rate out of state s, only to later states
        for j in range(s + 1, last + 1):
            left += rates[s, width + j - s]
        if left == 0.0:
            continue
        for i in range(s + 1, last + 1):
            share = rates[i, width + s - i] / left
            if share == 0.0:
                continue
            lost[i] += share * lost[s]
            spent[i] += share * spent[s]
            for j in range(s + 1, last + 1):
                rates[i, width + j - i] += share * rates[s, width + j - s]
    for s in range(n - 1, -1, -1):
        last = min(s + width, n - 1)
        left, time = lost[s], spent[s]
        for j in range(s + 1, last + 1):
            rate = rates[s, width + j - s]
            left += rate
            if rate > 0.0:
                time += rate * times[j]
        times[s] = time / left if time > 0.0 else 0.0
