"""Everything that depends on Numba's internals: the cache of compiled functions, calls by address.

Importing it chooses the folder of the cache: Numba needs one before the first function is defined.
"""

from tweezer.compiled.address import (
    address,
    array_at,
    attempt,
    call,
    native_address,
    protected,
    read_only,
)
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
    "array_at",
    "attempt",
    "cache_functions",
    "cached_njit",
    "call",
    "compilation",
    "fingerprint",
    "found",
    "named_njit",
    "native_address",
    "protected",
    "read_only",
]
