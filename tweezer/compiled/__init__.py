"""Everything that depends on Numba's internals: the cache of compiled functions, calls by address.

Importing this package chooses the cache folder, because Numba requires one before the first
function is defined. With TWEEZER_PLAIN_NUMBA=1 it uses `numba.njit` and Numba's own cache instead,
for releases of Numba with different internals (module `plain`).
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
from tweezer.compiled.compiling import PLAIN, Compilation, compilation, found
from tweezer.compiled.fingerprint import fingerprint

if PLAIN:
    from tweezer.compiled.plain import cache_functions, cached_njit, named_njit
else:
    from tweezer.compiled.cache import cache_functions, cached_njit, named_njit

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
