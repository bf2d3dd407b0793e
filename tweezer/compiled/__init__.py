"""Everything that depends on Numba's internals: the cache of compiled functions, calls by address.

Importing it chooses the folder of the cache: Numba needs one before the first function is defined.
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
