"""Check of MATLAB files of versions 5 to 7 before SciPy reads them.

SciPy uses the code of a number type without checking it, so a damaged code would crash the process.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from pathlib import Path

#: Length of the file header, and position of the byte order in it
_HEADER, _ORDER = 128, slice(126, 128)
#: Codes of elements that contain numbers or characters
_NUMBERS = (1, 2, 3, 4, 5, 6, 7, 9, 12, 13, 16, 17, 18)
_MATRIX, _COMPRESSED = 14, 15
#: Codes of arrays of characters or numbers; other arrays contain arrays
_ARRAYS = range(4, 16)
#: Code of the array flags; in the flags, the code of a sparse array and the bit for complex numbers
_FLAGS, _SPARSE, _COMPLEX = 6, 5, 0x800
#: Size of the tag before an element, bytes; elements end at a multiple of it
_TAG = 8
#: Depth to which nested arrays are read
_DEPTH = 50


def check_elements(path: Path, most_bytes: int) -> None:
    """Raise `ValueError` unless the elements of a file fit into it and have known codes.

    `most_bytes` is the largest size of a compressed element after decompression.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        order = {b"IM": "<", b"MI": ">"}.get(content[_ORDER])
        if order is None:
            raise ValueError("its header has no byte order")
        with memoryview(content) as everything, everything[_HEADER:] as elements:
            _check(elements, order, most_bytes, _DEPTH)


def _check(elements: memoryview, order: str, most_bytes: int, depth: int) -> None:
    """Check a sequence of elements, of a file or of an array in it.

    An element consists of a tag with its code and length, followed by its content. `order` is the
    byte order, "<" or ">", `most_bytes` the largest size of a compressed element after
    decompression, and `depth` the number of levels of nested arrays still allowed.
    """
    if not depth:
        raise ValueError("has arrays within arrays, too many")
    # whether the elements belong to an array, and to one of numbers; offset; number of elements,
    # and the smallest number required
    within, numbers, at, count, fewest = depth < _DEPTH, False, 0, 0, 0
    while at + _TAG <= len(elements):
        code, length = struct.unpack_from(f"{order}2I", elements, at)
        begin, most = at + _TAG, len(elements)
        if code >> 16:  # a small element, whose content is in the tag
            code, length, begin, most = code & 0xFFFF, code >> 16, at + _TAG // 2, at + _TAG
        end = begin + length
        if end > most:
            raise ValueError("an element is longer than its place: cut short or damaged")
        with elements[begin:end] as element:
            if within and not count:  # the first element of an array: flags with the array's code
                if code != _FLAGS or length < _TAG:
                    raise ValueError("an array has no flags")
                flags = struct.unpack_from(f"{order}I", element)[0]
                numbers = flags & 0xFF in _ARRAYS
                # flags, size, name and contents; row and column indices if sparse; imaginary part
                fewest = numbers and 4 + 2 * (flags & 0xFF == _SPARSE) + bool(flags & _COMPLEX)
            if code == _MATRIX and not numbers:
                _check(element, order, most_bytes, depth - 1)
            elif code == _COMPRESSED and not within:
                unpacking = zlib.decompressobj()
                unpacked = unpacking.decompress(element, most_bytes)
                if unpacking.unconsumed_tail:
                    raise ValueError(f"an array has more than {most_bytes:,} bytes")
                _check(memoryview(unpacked), order, most_bytes, depth)
            elif code not in _NUMBERS:
                raise ValueError(f"an element has the code {code}, which is not defined there")
        at = end if code == _COMPRESSED else -(-end // _TAG) * _TAG
        count += 1
    if count < fewest:
        raise ValueError(f"an array has {count} parts; must have at least {fewest}")
