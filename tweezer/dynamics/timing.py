"""Measurement of the time that a part of a run takes."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

from tweezer.compiled import compilation


@contextlib.contextmanager
def timed() -> Iterator[dict[str, float]]:
    """Yield a dictionary that contains the time spent in the context when it ends, s.

    Its entries are `compile_time`, and `wall_time` without it.
    """
    seconds: dict[str, float] = {}
    began = time.perf_counter()
    with compilation(lambda _: None) as compiling:
        yield seconds
    seconds["compile_time"] = compiling.seconds
    seconds["wall_time"] = time.perf_counter() - began - compiling.seconds
