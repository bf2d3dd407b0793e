"""How long a part of a run takes."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

from tweezer.compiled import compilation


@contextlib.contextmanager
def timed() -> Iterator[dict[str, float]]:
    """The attributes of the time that the context took, s, there at its end.

    `wall_time` is without the `compile_time`.
    """
    seconds: dict[str, float] = {}
    began = time.perf_counter()
    with compilation(lambda _: None) as compiling:
        yield seconds
    seconds["compile_time"] = compiling.seconds
    seconds["wall_time"] = time.perf_counter() - began - compiling.seconds
