"""Rotation rate, alignment, correlations and spectrum of a body from its orientations."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from tweezer.dynamics.layout import QUANTITIES
from tweezer.orientations.means import Parts
from tweezer.orientations.samples import Samples
from tweezer.orientations.spectrum import Spectrum
from tweezer.orientations.turns import in_laboratory, turns
from tweezer.results.io import load_result
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.units import QuantitiesLike, QuantityLike

if TYPE_CHECKING:
    import xarray as xr

#: Largest turn between two samples, rad, beyond which the turn the other way could be as likely
_LARGEST_TURN = 0.75 * np.pi
#: Attributes of a result that its analysis keeps
_KEPT = ("scene", "scene_as_given", "seed", "model", "method", "tweezer_version")


def rotation(
    run: xr.Dataset | str | Path,
    axis: QuantitiesLike = (0, 0, 1),
    *,
    lags: QuantitiesLike | None = None,
    skip: QuantityLike = 0.0,
    segments: int = 8,
    rates: bool = True,
) -> xr.Dataset:
    """Analyse how the body of a run or an ensemble rotates, and how one of its axes is aligned.

    Everything is computed from the orientations, without stored angular velocities. The rotation
    between two samples is the shortest turn that joins their orientations.

    Parameters
    ----------
    run : Dataset, str or Path
        Run of `tweezer.simulate`, trajectories of `tweezer.ensemble`, or their file. Your own
        dataset requires only `time`, s, and `orientation` over (time, euler_parameter) or
        (trajectory, time, euler_parameter). These are Euler parameters, scalar first, from the
        body's frame to the laboratory.
    axis : array_like, shape (3,), optional
        Axis n in the body's frame, scaled to length 1. Default: its z axis, about which a spheroid,
        cylinder, capsule or profile is symmetric. For the spectrum of a body that spins about n,
        choose another axis.
    lags : array_like, shape (m,), optional
        Lags, s, rounded to sampling intervals. Default: ten per decade, up to an eighth of the
        duration.
    skip : float or str, optional
        Time to omit at the beginning, s.
    segments : int, optional
        Number of parts of each trajectory over whose periodograms the spectrum is averaged. Fewer
        parts give sharper lines and larger errors.
    rates : bool, optional
        Whether to compute rotation rates and angular displacements, for which the samples must
        resolve the rotation.

    Returns
    -------
    xarray.Dataset
        The quantities below. X_error is the standard error of X. X_interval is its 95 % confidence
        interval, for rates, order and decay times.

        * rate (axis): mean angular velocity in laboratory axes, rad/s
        * rate_body (body_axis): mean angular velocity in the body's frame, rad/s
        * msad (axis, lag), msad_body (body_axis, lag): mean squared angular displacement, rad^2.
          A displacement is the sum of all turns in a lag, with components in laboratory axes or in
          the body's frame, so it grows beyond pi. It includes the mean rotation.
        * order_tensor (axis, other_axis): Q = <(3 n n - 1)/2>. Its element zz is <P2(n.z)>.
        * order_parameter, director (axis): largest eigenvalue S of Q and its eigenvector d, so that
          S = <P2(n.d)>. If n has no preferred direction, S is too large by about its error.
        * p1, p2 (lag): <P1(n(0).n(t))> and <P2(n(0).n(t))> over all pairs of samples. The mean
          squared change of n is 2 (1 - p1).
        * p1_decay_time, p2_decay_time: time at which they have decreased to 1/e, s; NaN if it is
          longer than the longest lag
        * psd (axis, frequency): one-sided power spectral density of the components of n, 1/Hz, by
          periodograms with a Hann window. A rotation at the rate w about an axis across n is a line
          at w/(2 pi).

    Raises
    ------
    ResultError
        If the orientation or a second sample is missing, the sampling interval changes, or the body
        turns by more than 3/4 pi between samples; also for invalid arguments.

    Notes
    -----
    The errors of an ensemble follow from the scatter among trajectories. The errors of a run follow
    from the scatter among 20 blocks of time, or fewer blocks that are at least a lag long, and from
    the covariance of neighbouring blocks. Runs of a free body that are 60 correlation times long
    have intervals that contain the true value with 93 to 97 % probability; at 20 correlation times
    it is 89 to 97 %. The errors of the spectrum follow from the scatter among segments.

    Thermal motion with the rotational diffusion coefficient D reduces the mean rotation vector of a
    time t by a fraction of about D t/3. The rates are corrected for it by the measured variance of
    the turns. With simulation.method = "one-call", the displacements and correlations lack the
    diffusion of half a step. Samples after a loss are excluded, and so is a last sample at the time
    of an event.

    References
    ----------
    W. Magnus, Commun. Pure Appl. Math. 7, 649 (1954), for the correction. W. G. Cochran, Sampling
    Techniques, 2.11, for the errors of trajectories of unequal length.

    Examples
    --------
    >>> rod = {"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"}
    >>> scene = tweezer.load_scene("polystyrene-500nm").replace(bead=rod)
    >>> found = tweezer.rotation(tweezer.simulate(scene, duration="1 ms"))
    >>> bool(found.order_parameter > 0.999)  # the rod stays along the light
    True
    """
    source, name = (
        (load_result(Path(run)), f"{run}") if isinstance(run, str | Path) else (run, "run")
    )
    n = numbers_in_si("axis", axis, "1")
    if n.shape != (3,) or not np.isfinite(n).all() or not n.any():
        raise ResultError(f"axis = {axis!r}: must be 3 numbers that are not all 0")
    if isinstance(segments, bool) or not isinstance(segments, int) or segments < 1:
        raise ResultError(f"segments = {segments!r}: must be a whole number of at least 1")
    n = n / np.linalg.norm(n)
    begin = in_si("skip", skip, "s", 0.0, error=ResultError)
    samples = Samples.of(source, name, begin)
    wanted = samples.default_lags() if lags is None else samples.lags_at(lags)
    spectrum = Spectrum(samples.number, samples.step, segments)
    groups: list[dict[str, list[Parts]]] = []
    for orientation in samples.groups():
        direction = in_laboratory(orientation, n)
        spectrum.add(direction)
        found = _alignment(direction, wanted, samples)
        groups.append(found | (_turning(orientation, wanted, samples) if rates else {}))
    sums = {
        name: [Parts.joined(each) for each in zip(*(one[name] for one in groups), strict=True)]
        for name in groups[0]
    }
    return _dataset(source, n, samples, wanted, sums, spectrum)


def _alignment(
    direction: Array, lags: NDArray[np.int64], samples: Samples
) -> dict[str, list[Parts]]:
    """Return the sums for the order tensor, and for P1 and P2 at each lag (samples).

    `direction` (trajectories, n, 3) is the body's axis in the laboratory.
    """
    tensor = 1.5 * direction[..., :, None] * direction[..., None, :] - 0.5 * np.eye(3)
    sums = {"order": [Parts.of(tensor, successive=samples.successive)], "p": []}
    for lag in lags:
        cosine = np.einsum("rti,rti->rt", direction[:, lag:], direction[:, :-lag])
        legendre = np.stack([cosine, 1.5 * cosine**2 - 0.5], axis=-1)
        sums["p"].append(Parts.of(legendre, successive=samples.successive, span=lag))
    return sums


def _turning(
    orientation: Array, lags: NDArray[np.int64], samples: Samples
) -> dict[str, list[Parts]]:
    """Return the sums for turns, their squares, and angular displacements at each lag (samples).

    The names end in "_body" for components in the body's frame. Raises `ResultError` if a turn is
    too large.
    """
    in_body = turns(orientation)
    largest = float(np.nanmax(np.linalg.norm(in_body, axis=-1), initial=0.0))
    if largest > _LARGEST_TURN:
        raise ResultError(
            f"orientation: the body turns by {largest:.3g} rad between two samples; must be at "
            f"most {_LARGEST_TURN:.3g}; store samples more often, or omit the rates by "
            "rates=False or --no-rates"
        )
    sums: dict[str, list[Parts]] = {}
    for end, each in (("", in_laboratory(orientation[:, :-1], in_body)), ("_body", in_body)):
        sums[f"turn{end}"] = [Parts.of(each, successive=samples.successive)]
        square = each[..., :, None] * each[..., None, :]
        sums[f"square{end}"] = [Parts.of(square, successive=samples.successive)]
        angle = np.cumsum(each, axis=1)
        angle = np.concatenate([np.zeros_like(angle[:, :1]), angle], axis=1)
        sums[f"msad{end}"] = [
            Parts.of((angle[:, lag:] - angle[:, :-lag]) ** 2,
                     successive=samples.successive, span=lag)
            for lag in lags
        ]  # fmt: skip
    return sums


def _corrected(turn: Parts, square: Parts) -> Parts:
    """Return turns from which the effect of their own variance on the mean is removed.

    The turn of an interval is the rotation vector of a product of small turns. To first order in
    the covariance C of the turns, its mean is too small by (tr C - C)/12 times the mean.
    """
    covariance = square.mean - np.outer(turn.mean, turn.mean)
    return turn.times(np.eye(3) + (np.trace(covariance) * np.eye(3) - covariance) / 12)


def _dataset(
    source: xr.Dataset,
    axis: Array,
    samples: Samples,
    lags: NDArray[np.int64],
    sums: dict[str, list[Parts]],
    spectrum: Spectrum,
) -> xr.Dataset:
    """Return the dataset that `rotation` describes."""
    import xarray as xr

    names, about = QUANTITIES["position"].coordinate
    body_names, about_body = QUANTITIES["angular_velocity"].coordinate
    dataset = xr.Dataset(
        coords={
            "axis": ("axis", names, about),
            "other_axis": ("other_axis", names, about),
            "body_axis": ("body_axis", body_names, about_body),
            "limit": ("limit", ["low", "high"], {"long_name": "limit of a 95 % interval"}),
            "lag": ("lag", lags * samples.step, _about("s", "lag")),
            "frequency": ("frequency", spectrum.frequency, _about("Hz", "frequency")),
        },
        attrs={name: source.attrs[name] for name in _KEPT if name in source.attrs},
    )
    dataset["body_direction"] = (
        "body_axis", axis, _about("1", "analysed axis n of the body, body frame")
    )  # fmt: skip
    for end, dimension, frame in (
        ("", "axis", "laboratory axes"), ("_body", "body_axis", "body frame"),
    ):  # fmt: skip
        if f"turn{end}" in sums:
            turn = _corrected(sums[f"turn{end}"][0], sums[f"square{end}"][0])
            _put(dataset, f"rate{end}", (dimension,), turn.mean / samples.step,
                 turn.error / samples.step, "rad/s", f"mean angular velocity, {frame}",
                 turn.freedom)  # fmt: skip
            mean, error = (
                np.stack([getattr(each, what) for each in sums[f"msad{end}"]], axis=-1)
                for what in ("mean", "error")
            )
            _put(dataset, f"msad{end}", (dimension, "lag"), mean, error, "rad^2",
                 f"mean squared angular displacement, {frame}")  # fmt: skip
    _put_order(dataset, sums["order"][0])
    for i, name in enumerate(("p1", "p2")):
        _put_correlation(dataset, name, sums["p"], i)
    _put(dataset, "psd", ("axis", "frequency"), spectrum.mean, spectrum.error, "1/Hz",
         "one-sided power spectral density of the body's axis n")  # fmt: skip
    return dataset


def _put_order(dataset: xr.Dataset, order: Parts) -> None:
    """Add the order tensor, its largest eigenvalue and the director, which points to z > 0."""
    if not np.isfinite(order.mean).all():
        raise ResultError("orientation: all values are NaN")
    _put(dataset, "order_tensor", ("axis", "other_axis"), order.mean, order.error, "1",
         "order tensor <(3 n n - 1)/2>", order.freedom)  # fmt: skip
    values, vectors = np.linalg.eigh(order.mean)
    director = vectors[:, -1] * (-1.0 if vectors[2, -1] < 0 else 1.0)
    along = Parts(director @ order.totals @ director, order.counts, order.successive)
    _put(dataset, "order_parameter", (), values[-1], along.error, "1",
         "order parameter, largest eigenvalue of the order tensor", order.freedom)  # fmt: skip
    dataset["director"] = (
        "axis", director, _about("1", "director, eigenvector of the order parameter")
    )  # fmt: skip


def _put_correlation(dataset: xr.Dataset, name: str, over_lags: list[Parts], i: int) -> None:
    """Add <P1> or <P2>, component `i` of the sums at each lag, and its decay time."""
    mean, error = (
        np.array([getattr(each, what)[i] for each in over_lags]) for what in ("mean", "error")
    )
    told = f"autocorrelation <P{i + 1}(n(0).n(t))> of the body's axis n"
    _put(dataset, name, ("lag",), mean, error, "1", told)
    time, of_time, at = _decay_time(dataset["lag"].values, mean, error)
    _put(dataset, f"{name}_decay_time", (), time, of_time, "s",
         f"time at which {name} has decreased to 1/e", over_lags[at].freedom)  # fmt: skip


def _decay_time(lags: Array, values: Array, errors: Array) -> tuple[float, float, int]:
    """Return the time at which a correlation has decreased from 1 to 1/e, and its standard error.

    Both are NaN if no value is that small. The last number returned is the index of the first value
    that is. Between it and the value before, the correlation is taken as an exponential, or as a
    line if the value is negative.
    """
    level = np.exp(-1)
    at = int(np.argmax(values <= level))
    if not values[at] <= level:
        return np.nan, np.nan, at
    before, lag = (1.0, 0.0) if at == 0 else (values[at - 1], lags[at - 1])
    if values[at] > 0:
        rate = np.log(before / values[at]) / (lags[at] - lag)
        return lag + np.log(before / level) / rate, errors[at] / (level * rate), at
    slope = (before - values[at]) / (lags[at] - lag)
    return lag + (before - level) / slope, errors[at] / slope, at


def _put(
    dataset: xr.Dataset,
    name: str,
    dimensions: tuple[str, ...],
    value: Any,
    error: Any,
    unit: str,
    long_name: str,
    freedom: int | None = None,
) -> None:
    """Add a quantity, its standard error and, with `freedom`, its 95 % confidence interval.

    `freedom` is the number of degrees of freedom of the error.
    """
    dataset[name] = (dimensions, value, _about(unit, long_name))
    dataset[f"{name}_error"] = (dimensions, error, _about(unit, f"standard error: {long_name}"))
    beside = [f"{name}_error"]
    if freedom is not None:
        half = np.asarray(error) * (stdtrit(freedom, 0.975) if freedom else np.nan)
        dataset[f"{name}_interval"] = (
            (*dimensions, "limit"),
            np.stack([value - half, value + half], axis=-1),
            _about(unit, f"95 % confidence interval: {long_name}"),
        )
        beside.append(f"{name}_interval")
    dataset[name].attrs["ancillary_variables"] = " ".join(beside)


def _about(units: str, long_name: str) -> dict[str, str]:
    """Return the attributes of a variable of a dataset."""
    return {"units": units, "long_name": long_name}
