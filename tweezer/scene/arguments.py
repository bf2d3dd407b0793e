"""Checks of the arguments of runs and ensembles, before large imports and computations."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tweezer.scene.scene import Scene
from tweezer.values.errors import ResultError, SceneError, TweezerError, warn
from tweezer.values.units import QuantityLike, array_in_si, to_si

if TYPE_CHECKING:
    import numpy as np
    from distributed import Client
    from numpy.typing import NDArray

#: Largest number of trajectories of an ensemble
_MOST = 10**9


def in_si(
    name: str,
    value: Any,
    unit: str,
    low: float = -math.inf,
    high: float = math.inf,
    error: type[TweezerError] = SceneError,
) -> float:
    """Return an argument in its SI unit, converted by `tweezer.values.units.to_si`.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : float, str or quantity
        Its value.
    unit : str
        Its SI unit.
    low, high : float, optional
        Allowed range.
    error : type, optional
        Class of the error.

    Raises
    ------
    TweezerError
        The class `error`, with the name of the argument, for an invalid value.
    """
    try:
        return to_si(value, unit, low, high)
    except ValueError as refused:
        raise error(f"{name} = {value!r}: {refused}") from None


def numbers_in_si(
    name: str, values: Any, unit: str, error: type[TweezerError] = ResultError
) -> NDArray[np.float64]:
    """Return an array argument in SI units, converted by `tweezer.values.units.array_in_si`.

    Parameters
    ----------
    name : str
        Name of the argument.
    values : array_like
        Its values.
    unit : str
        Its SI unit.
    error : type, optional
        Class of the error for invalid values.
    """
    try:
        return array_in_si(values, unit)
    except ValueError as refused:
        raise error(f"{name}: {refused}") from None


def check_seed(seed: int) -> None:
    """Raise `SceneError` unless `seed` is a valid seed of random numbers."""
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**63:
        raise SceneError(f"seed = {seed!r}: must be a whole number from 0 to 2^63 - 1")


def check_run(scene: Scene, seed: int | None) -> None:
    """Raise `SceneError` for an invalid seed, or a seed for a run without random numbers."""
    if seed is None:
        return
    if not scene.draws:
        raise SceneError(
            "seed: requires forces.brownian = true, or a camera or detector with noise"
        )
    check_seed(seed)


def check_thermal(scene: Scene, seed: int) -> None:
    """Raise `SceneError` for a scene without thermal motion, or an invalid seed."""
    if not scene.forces.brownian:
        raise SceneError("forces.brownian = False: all trajectories would be equal; set it to true")
    check_seed(seed)


def check_ensemble(
    scene: Scene,
    trajectories: int,
    *,
    seed: int,
    out: str | Path | None,
    statistics: bool,
    skip: QuantityLike,
    scheduler: str | Client | None,
    workers: int | None,
) -> None:
    """Raise `SceneError` or `ResultError` for invalid arguments of `tweezer.ensemble`.

    Parameters
    ----------
    scene : Scene
        Scene of the ensemble.
    trajectories : int
        Number of trajectories.
    seed : int
        Seed of the random numbers.
    out : str or Path, optional
        File to write.
    statistics : bool
        Whether statistics are computed.
    skip : float or str
        Time to omit from the statistics, s.
    scheduler : str or distributed.Client, optional
        Dask scheduler.
    workers : int, optional
        Number of threads.
    """
    for name, value in (
        ("trajectories", trajectories),
        ("workers", 1 if workers is None else workers),
    ):
        if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= _MOST:
            raise SceneError(f"{name} = {value!r}: must be a whole number from 1 to {_MOST:.0e}")
    check_thermal(scene, seed)
    if scene.detector is not None and scene.detector.bandwidth is not None and not statistics:
        raise SceneError(
            f"detector.bandwidth = {scene.detector.bandwidth:g}: applies to single runs; remove it "
            "or set statistics = True"
        )
    if skip and not statistics:
        raise SceneError(f"skip = {skip!r}: requires statistics = True")
    samples_skipped(scene, skip)
    if scheduler is not None and workers is not None:
        raise SceneError(
            f"workers = {workers}: cannot be combined with a scheduler; omit one of them"
        )
    if scheduler is not None and out is None:
        raise SceneError("out: required with a scheduler, whose workers write to it")
    if out is not None and Path(out).suffix != (suffix := ".nc" if statistics else ".zarr"):
        raise ResultError(f"{out}: must end in {suffix}")


def samples_skipped(scene: Scene, skip: QuantityLike) -> int:
    """Return the index of the first sample not before `skip`, s or text.

    Raises `SceneError` if fewer than two samples remain.
    """
    import numpy as np

    seconds = in_si("skip", skip, "s", 0.0)
    samples = scene.simulation.samples
    times = np.linspace(0.0, scene.simulation.duration, samples)
    skipped = int(np.searchsorted(times, seconds * (1 - 1e-12)))
    if skipped > samples - 2:
        raise SceneError(f"skip = {skip!r}: must leave at least 2 of the {samples} samples")
    return skipped


def name_last(record: Any) -> Any:
    """Let a dataclass with the keyword `name` accept the name first, as in earlier releases."""
    made = record.__init__

    @functools.wraps(made)
    def init(self: Any, *given: Any, **named: Any) -> None:
        """Initialise the dataclass; text as the first argument is its name and gives a warning."""
        if given and isinstance(given[0], str):
            kind = record.__name__
            warn(
                f"{kind}({given[0]!r}, ...): the name is now the last argument, as "
                f"{kind}(..., name={given[0]!r}); the old order will be removed in version 0.3",
                FutureWarning,
            )
            given, named = given[1:], {"name": given[0], **named}
        made(self, *given, **named)

    record.__init__ = init
    return record
