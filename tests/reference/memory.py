"""Memory as other code leaves it, for what reads an array before it is filled."""

from __future__ import annotations

import ctypes

ZEROS, NAN = 0x00, 0xFF


def leave(byte):
    """Let what compiled code is given for its next arrays, up to 64 KiB, be full of that."""
    libc = ctypes.CDLL(None)
    libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
    libc.free.argtypes = [ctypes.c_void_p]
    # as many of a size as glibc keeps at hand for the next that asks, and larger ones
    sizes = [*7 * [*range(24, 1100, 16)], *4 * [2**n for n in range(11, 17)]]
    places = [(libc.malloc(size), size) for size in sizes]
    for place, size in places:
        ctypes.memset(place, byte, size)
    for place, _ in places:
        libc.free(place)
