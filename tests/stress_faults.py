"""Faults from outside: each ends whole, or as one error of tweezer's own; never wrong in silence.

`python -m tests.stress_faults` prints how they ended; `make stress` calls it. A kind of fault is a
function `kind(count)` that makes so many and counts how they ended; what must not happen raises
AssertionError, which names the fault.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable

#: name, what makes the faults, and how many
FAULTS: list[tuple[str, Callable[[int], Counter[str]], int]] = []


if __name__ == "__main__":
    began = time.perf_counter()
    for name, make, count in FAULTS:
        print(f"{count} {name}", flush=True)
        for ended, times in make(count).most_common():
            print(f"{times:8d}  {ended}")
    print(f"{time.perf_counter() - began:8.0f}  s")
