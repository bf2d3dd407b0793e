"""All that knows Numba's insides: where functions are kept, and how one calls another.

Importing it finds a place for what is compiled, which Numba wants before the first function.
"""

from tweezer.compiled.address import address, call
from tweezer.compiled.cache import (
    Compilation,
    cache_functions,
    cached_njit,
    compilation,
    found,
    named_njit,
)
from tweezer.compiled.fingerprint import fingerprint

__all__ = [
    "Compilation",
    "address",
    "cache_functions",
    "cached_njit",
    "call",
    "compilation",
    "fingerprint",
    "found",
    "named_njit",
]
