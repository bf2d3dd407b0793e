"""Correlations and spectra of several beads, with the closed forms of linear motion.

About their equilibrium the beads move by dx = -A x dt + noise, A = M K, with the mobility M and the
stiffness K of all forces there. The covariance C of the positions solves A C + C A^T = 2 kT M. For
forces with a potential it is kT/K. Correlations are e^(-A t) C.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.beads.equilibrium import equilibrium
from tweezer.beads.system import system
from tweezer.results.io import scene_of
from tweezer.scene.arguments import in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.units import QuantitiesLike, QuantityLike, array_in_si
from tweezer.values.version import made_by

if TYPE_CHECKING:
    import xarray as xr

#: Number of blocks of a record, whose scatter gives errors
_BLOCKS = 20
#: Lags that are computed if none are given, in parts of a block
_LAGS, _PART = 60, 0.2
#: Names of the axes of a record with one axis, or with three
_AXES = {1: ["x"], 3: ["x", "y", "z"]}


def cross_correlation(
    run: xr.Dataset | Array,
    lags: QuantitiesLike | None = None,
    *,
    interval: QuantityLike | None = None,
) -> xr.Dataset:
    """Return the correlations of the positions of several beads, beside their closed form.

    Parameters
    ----------
    run : xarray.Dataset or ndarray
        Run of several beads with thermal motion, or positions, m, over time and bead, or over time,
        bead and axis.
    lags : array_like, optional
        Lags, s; rounded to samples. Default: 61 lags from 0 to a hundredth of the record.
    interval : float or str, optional
        Time between samples of an array, s.

    Returns
    -------
    xarray.Dataset
        * correlation (lag, axis, bead, other): <x_bead(t + lag) x_other(t)> about the means, m^2
        * correlation_error: standard error, from 20 blocks of the record
        * expected (lag, axis, bead, other): closed form e^(-A t) C at the equilibrium; only for a
          run

    Raises
    ------
    ResultError
        For positions of a single bead, records that are too short, and lags that do not fit.
    """
    x, step, scene = _record(run, interval)
    block = len(x) // _BLOCKS
    if lags is None:
        shifts = np.unique(np.linspace(0, _PART * block, _LAGS + 1).astype(int))
    else:
        shifts = np.rint(np.atleast_1d(array_in_si(lags, "s")) / step).astype(int)
        if (shifts < 0).any() or (shifts > block / 2).any():
            raise ResultError(
                f"lags: allowed: from 0 to {block // 2 * step:.3g} s, half of one of "
                f"{_BLOCKS} blocks of the record"
            )
    x = x - x.mean(axis=0)
    parts = np.array([
        [_products(x[first : first + block], shift) for shift in shifts]
        for first in range(0, _BLOCKS * block, block)
    ])  # fmt: skip
    variables = {
        "correlation": (parts.mean(axis=0), "correlation of the positions"),
        "correlation_error": (
            parts.std(axis=0, ddof=1) / np.sqrt(_BLOCKS), "standard error of the correlation",
        ),
    }  # fmt: skip
    if scene is not None:
        rates, covariance, _ = linear_motion(scene)
        variables["expected"] = _closed_form(rates, covariance, shifts * step), "closed form"
    return _dataset("lag", shifts * step, "s", variables, "m^2", x, scene, "cross_correlation")


def cross_spectrum(run: xr.Dataset | Array, *, interval: QuantityLike | None = None) -> xr.Dataset:
    """Return the spectra and cross-spectra of several beads, beside their closed form.

    Parameters
    ----------
    run : xarray.Dataset or ndarray
        Run of several beads with thermal motion, or positions, m, over time and bead, or over time,
        bead and axis.
    interval : float or str, optional
        Time between samples of an array, s.

    Returns
    -------
    xarray.Dataset
        * spectrum (frequency, axis, bead, other): real part of the one-sided cross-spectral
          density, m^2/Hz, as the mean over 20 blocks
        * spectrum_error: standard error, from the scatter of the blocks
        * expected: closed form for samples at these times, with aliasing; only for a run

    Raises
    ------
    ResultError
        For positions of a single bead, and for records that are too short.
    """
    x, step, scene = _record(run, interval)
    block = len(x) // _BLOCKS
    x = x - x.mean(axis=0)
    found = np.fft.rfft(x[: _BLOCKS * block].reshape(_BLOCKS, block, *x.shape[1:]), axis=1)
    frequencies = np.arange(1, (block + 1) // 2) / (block * step)
    found = found[:, 1 : len(frequencies) + 1]
    parts = 2 * step / block * np.einsum("bfic,bfjc->bfcij", found, found.conj()).real
    variables = {
        "spectrum": (parts.mean(axis=0), "one-sided cross-spectral density"),
        "spectrum_error": (parts.std(axis=0, ddof=1) / np.sqrt(_BLOCKS), "standard error of it"),
    }
    if scene is not None:
        variables["expected"] = _spectrum(scene, frequencies, step), "closed form, with aliasing"
    return _dataset("frequency", frequencies, "Hz", variables, "m^2/Hz", x, scene, "cross_spectrum")


def linear_motion(scene: Any) -> tuple[Array, Array, Array]:
    """Return the rates A = M K, the covariance C and the mobility M of beads at their equilibrium.

    Each is (3 beads, 3 beads), in 1/s, m^2 and s/kg. Raises `SceneError` if there is no stable
    equilibrium near the starts.
    """
    from scipy.linalg import solve_continuous_lyapunov

    bound = system(scene)
    place = equilibrium(bound)
    mobility = bound.mobility(place)
    rates = mobility @ bound.stiffness(place)
    covariance: Array = solve_continuous_lyapunov(rates, 2 * bound.kT * mobility)
    return rates, covariance, mobility


def _closed_form(rates: Array, covariance: Array, lags: Array) -> Array:
    """Return e^(-A t) C at lags (n,), s, as (n, axis, bead, other)."""
    from scipy.linalg import expm

    return _by_axis(np.array([expm(-rates * lag) @ covariance for lag in lags]))


def _spectrum(scene: Any, frequencies: Array, step: float) -> Array:
    """Return the spectrum of samples every `step`, s, as (frequency, axis, bead, other), m^2/Hz.

    Samples are an autoregressive process x' = E x + noise, E = e^(-A step).
    """
    from scipy.linalg import expm

    rates, covariance, _ = linear_motion(scene)
    kept = expm(-rates * step)
    noise = covariance - kept @ covariance @ kept.T
    turns = np.exp(-2j * np.pi * frequencies * step)
    passed = np.linalg.inv(np.eye(len(kept)) - turns[:, None, None] * kept)
    return _by_axis((2 * step * passed @ noise @ passed.conj().transpose(0, 2, 1)).real)


def _by_axis(matrices: Array) -> Array:
    """Return the parts of matrices (n, 3 beads, 3 beads) of one axis, (n, axis, bead, other)."""
    n, beads = len(matrices), matrices.shape[1] // 3
    found: Array = np.einsum("niaja->naij", matrices.reshape(n, beads, 3, beads, 3))
    return found


def _products(x: Array, shift: int) -> Array:
    """Return the mean of x_i(t + shift) x_j(t) over a block (n, beads, axes): (axis, i, j)."""
    later, earlier = x[shift:], x[: len(x) - shift]
    found: Array = np.einsum("tia,tja->aij", later, earlier) / len(later)
    return found


def _record(run: xr.Dataset | Array, interval: QuantityLike | None) -> tuple[Array, float, Any]:
    """Return positions (time, bead, axis), m, the time between samples, s, and the scene if any."""
    scene = None
    if isinstance(run, np.ndarray):
        if interval is None:
            raise ResultError("interval: missing; an array does not contain its times")
        x = run[..., None] if run.ndim == 2 else run
        step = in_si("interval", interval, "s", 1e-15, error=ResultError)
        if x.ndim != 3 or x.shape[1] < 2 or x.shape[2] not in _AXES:
            raise ResultError(
                f"run: has the shape {x.shape}; must be (time, bead) or (time, bead, 3)"
            )
    else:
        if "bead" not in run.dims or interval is not None:
            raise ResultError("run: must be a run of several beads, without interval")
        scene = scene_of(run)
        if not scene.forces.brownian:
            raise ResultError("run: must have thermal motion")
        if scene.last_change > 0 or scene.light_moves:
            raise ResultError("run: must have light that is constant in time")
        x = run["position"].values
        step = float(run["time"][1] - run["time"][0]) if run.sizes["time"] > 1 else 0.0
    if len(x) < 10 * _BLOCKS or not np.isfinite(x).all():
        raise ResultError(f"run: must have at least {10 * _BLOCKS} samples, all of them finite")
    return x, step, scene


def _dataset(
    name: str, values: Array, unit: str, variables: dict[str, tuple[Array, str]], units: str,
    x: Array, scene: Any, made: str,
) -> xr.Dataset:  # fmt: skip
    """Return a dataset over a first dimension, the axis and two beads."""
    import xarray as xr

    names = scene.bead_names if scene else [str(k + 1) for k in range(x.shape[1])]
    dimensions = (name, "axis", "bead", "other")
    return xr.Dataset(
        {
            key: (dimensions, each, {"units": units, "long_name": told})
            for key, (each, told) in variables.items()
        },
        {name: (name, values, {"units": unit}), "axis": _AXES[x.shape[2]], "bead": names,
         "other": names},
        made_by(made, dated=False),
    )  # fmt: skip
