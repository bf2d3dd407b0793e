"""Plain Numba instead of tweezer's own compilation, for Numba releases with different internals.

With TWEEZER_PLAIN_NUMBA=1 `numba.njit` compiles every function and Numba's own cache stores it.
Results differ only by rounding, but compiling takes longer.

Numba's cache detects a change of a function, but not of the functions that it calls. The cache
therefore has a folder for each state of tweezer's sources. It does not detect a change in a second
file of a user's own force. If a closure contains another compiled function, Numba compiles it again
in each process.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

import numba
from numba.core.dispatcher import Dispatcher

from tweezer.compiled.compiling import stored
from tweezer.compiled.fingerprint import name_by_values


def cached_njit(signature: Any = None, **options: Any) -> Any:
    """Return a decorator that compiles a function with `numba.njit` and Numba's own cache.

    With `signature`, the argument types, the function is compiled immediately, otherwise when it is
    first called. `options` are options of `numba.njit`.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        name_by_values(function)
        dispatcher = numba.njit(signature, cache=True, **options)(function)
        stored.add(dispatcher)
        return dispatcher

    return compiled


def named_njit(*, inner: bool = False, **options: Any) -> Any:  # noqa: ARG001
    """Return a decorator that compiles a function with `numba.njit`, without a cache.

    `inner` has no effect here: Python may call the function in any case.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        name_by_values(function)
        return numba.njit(**options)(function)

    return compiled


def cache_functions(module: ModuleType) -> ModuleType:
    """Make the compiled functions of an emitted module use Numba's cache; return the module."""
    for each in vars(module).values():
        if isinstance(each, Dispatcher):
            each.enable_caching()
            stored.add(each)
    return module
