"""Trajectories of free beads, including short ones, and their common diffusion coefficient."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tweezer.calibration import digits
from tweezer.calibration.free import Diffusion, Given, free_bead
from tweezer.calibration.setup import given_in_si
from tweezer.reading import Columns, Reading, Wanted, measured
from tweezer.reading.recording import Recording, Run, read_source
from tweezer.scene.arguments import in_si, name_last
from tweezer.scene.sphere import drag_of_translation
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.units import QuantityLike

if TYPE_CHECKING:
    import xarray as xr


#: Smallest number of consecutive frames that determine a diffusion coefficient
LEAST_FRAMES = 4
#: Largest deviation of a time from a multiple of the sampling interval, in intervals
_OFF = 0.2
#: Largest relative difference between the sampling intervals of combined trajectories
_ALIKE = 1e-3


@name_last
@dataclass(frozen=True, repr=False)
class Trajectory(Shown):
    """Positions of a free bead at even times, possibly with gaps."""

    step: float
    """Time between frames, s."""
    positions: Array
    """(n, axes) m, or V; NaN where a frame is missing."""
    axes: tuple[str, ...]
    """Names of the axes, such as "x" and "y"."""
    name: str = field(default="trajectory", kw_only=True)
    """Name of the bead."""
    unit: str = "m"
    """Unit of the positions: "m" or "V"."""
    note: str = ""
    """Samples that were omitted, in words."""

    @classmethod
    def of(cls, recording: Recording) -> Trajectory:
        """Return the trajectory of a recording."""
        return cls(
            recording.step, recording.positions, recording.axes, recording.unit, recording.note,
            name=recording.name,
        )  # fmt: skip

    @property
    def frames(self) -> int:
        """Number of frames with a position."""
        return int(np.isfinite(self.positions).all(axis=1).sum())

    def since(self, time: QuantityLike) -> Trajectory:
        """Return the part of the trajectory that begins at a time after the first frame.

        Parameters
        ----------
        time : float or str
            Time to omit, s.
        """
        first = math.ceil(in_si(f"{self.name}: since", time, "s", error=ResultError) / self.step)
        return dataclasses.replace(self, positions=self.positions[first:])

    def card(self) -> Card:
        """Return the card with the number of frames and their rate."""
        rows = (
            Row("frames", f"{len(self.positions)}, {self.frames} of them with a position"),
            Row("rate", f"{1 / self.step:.5g} Hz"),
        )
        return Card("Trajectory", self.name, rows, notes=(self.note,) if self.note else ())


def load_trajectories(
    source: str | Path | xr.Dataset,
    *,
    columns: str | Sequence[str] | Mapping[str, str | int] | None = None,
    rate: QuantityLike | None = None,
    scale: QuantityLike | None = None,
    bead: str | int | None = None,
) -> tuple[Trajectory, ...]:
    """Return the trajectory of each bead in a table or run.

    A table of several beads has a column such as `particle` or `TRACK_ID`. Frames that lack numbers
    are gaps. Beads with fewer than four consecutive frames are omitted.

    Parameters
    ----------
    source : str, Path or xarray.Dataset
        File, or run of tweezer, as in `load_recording`.
    columns : str, sequence of str or mapping, optional
        Columns to read, either in file order or by heading or number from 1.
    rate : float or str, optional
        Frame rate, Hz, for frame numbers or rows without times.
    scale : float or str, optional
        Length per pixel or per volt, m.
    bead : str or int, optional
        Bead to read, as its column names it. Default: all beads.

    Returns
    -------
    tuple of Trajectory
        One trajectory for each bead.

    Raises
    ------
    ResultError
        If the table cannot be read, frames are not at even times, or all trajectories are too
        short.

    Examples
    --------
    >>> import tweezer.calibration
    >>> run = tweezer.simulate("silica-1um", "2 ms")
    >>> len(tweezer.calibration.load_trajectories(run))
    1
    """
    reading = Reading.of(columns, rate, scale, bead=bead)
    read = read_source(source, reading, Wanted(() if reading.columns else ("x",), volts=True))
    if isinstance(read, Run):
        return (Trajectory.of(Recording(**read._asdict())),)
    name = str(source)
    found = [
        _on_grid(f"{name}, bead {label}" if label else name, of_bead)
        for label, of_bead in read.items()
    ]
    long = tuple(each for each in found if _in_a_row(each) >= LEAST_FRAMES)
    if not long:
        most = max(map(_in_a_row, found), default=0)
        raise ResultError(
            f"{name}: has {most} consecutive samples; a diffusion coefficient requires "
            f"{LEAST_FRAMES} or more, and a trap 100"
        )
    return long


def diffusion(
    trajectories: Sequence[Trajectory],
    *,
    temperature: QuantityLike | None = None,
    radius: QuantityLike | None = None,
    viscosity: QuantityLike | None = None,
    exposure: QuantityLike | None = None,
    noise: QuantityLike | None = None,
) -> Diffusion:
    """Return the common diffusion coefficient of free beads, and quantities that follow from it.

    The likelihood is the product of the trajectories' likelihoods (`tweezer.calibration.free`).
    Each trajectory has its own drift. The localisation error is the same in all of them.

    Parameters
    ----------
    trajectories : sequence of Trajectory
        One or more, of the same axes, unit and rate.
    temperature : float or str, optional
        Temperature of the medium, K. It determines the viscosity, the radius or Boltzmann's
        constant.
    radius, viscosity : float or str, optional
        Radius of the bead, m, and viscosity of the medium, Pa s.
    exposure : float or str, optional
        Exposure time of each position, s. The diffusion is the same without it.
    noise : float or str, optional
        Standard deviation of the localisation error, m or V.

    Raises
    ------
    ResultError
        If trajectories differ in axes, unit or rate, or a value is not allowed.

    Returns
    -------
    Diffusion
        Diffusion coefficient with its confidence interval, and findings.

    Examples
    --------
    >>> from tweezer.calibration import Trajectory, diffusion
    >>> steps = 1e-7 * np.random.default_rng(2).normal(size=(200, 2))
    >>> found = diffusion([Trajectory(0.01, steps.cumsum(axis=0), ("x", "y"))])
    >>> found.interval[0] < 5e-13 < found.interval[1]  # m^2/s
    True
    """
    first = trajectories[0]
    trajectories = [each for each in trajectories if _in_a_row(each) >= LEAST_FRAMES]
    if not trajectories:
        raise ResultError(
            f"{first.name}: has {first.frames} samples; a diffusion coefficient requires "
            f"{LEAST_FRAMES} in a row"
        )
    first = trajectories[0]
    name = first.name if len(trajectories) == 1 else f"{first.name} and others"
    for each in trajectories[1:]:
        if (each.axes, each.unit) != (first.axes, first.unit):
            raise ResultError(
                f"{each.name}: has {', '.join(each.axes)} in {each.unit}, and {first.name} "
                f"{', '.join(first.axes)} in {first.unit}; must be the same"
            )
        if abs(each.step / first.step - 1) > _ALIKE:
            raise ResultError(
                f"{each.name}: has {1 / each.step:.5g} Hz, and {first.name} {1 / first.step:.5g} "
                "Hz; must be one rate"
            )
    given = {
        quantity: given_in_si(name, quantity, value, unit)
        for quantity, value, unit in (
            ("temperature", temperature, "K"), ("radius", radius, "m"),
            ("viscosity", viscosity, "Pa s"), ("exposure", exposure, "s"),
        )
    }  # fmt: skip
    for quantity, value in given.items():
        if value is not None and (value < 0 or (value == 0 and quantity != "exposure")):
            raise ResultError(f"{name}: {quantity} = {value:g}: must be positive")
    if (exposed := given["exposure"]) is not None and exposed > first.step * (1 + _ALIKE):
        raise ResultError(
            f"{name}: exposure = {exposed:g} s: must be at most the step of {first.step:.4g} s"
        )
    drag = None
    if given["radius"] is not None and given["viscosity"] is not None:
        drag = drag_of_translation(given["viscosity"], given["radius"])
    error = given_in_si(name, "noise", noise, first.unit)
    noises = {} if error is None else dict.fromkeys(first.axes, error)
    found = free_bead(
        name, first.axes, [each.positions for each in trajectories], first.step,
        Given(given["temperature"], given["radius"], given["viscosity"], drag, exposed, noises,
              unit=first.unit),
        [each.name for each in trajectories] if len(trajectories) > 1 else (),
    )  # fmt: skip
    every = np.concatenate([each.positions for each in trajectories])
    shown = digits.of_samples(every[np.isfinite(every).all(axis=1)])
    return dataclasses.replace(found, findings=tuple(digits.first(shown, found.findings)))


def _on_grid(name: str, columns: Columns) -> Trajectory:
    """Return the trajectory of a bead from the columns of a table, with NaN for missing frames.

    Raises `ResultError` if the times are not multiples of a sampling interval.
    """
    axes = tuple(axis for axis in ("x", "y", "z") if axis in columns.columns)
    moving = tuple(axis for axis in axes if axis == axes[0] or np.nanstd(columns.columns[axis]) > 0)
    table = np.stack([columns.columns[axis] for axis in moving], axis=1)
    _, times, table, note = measured(columns.times, table)
    there = np.isfinite(times) & np.isfinite(table).all(axis=1)
    times, table = times[there], table[there]
    notes = "; ".join(filter(None, [columns.note, note]))
    if len(times) < LEAST_FRAMES:
        return Trajectory(1.0, table, moving, columns.unit, notes, name=name)
    steps = np.diff(times)  # times between frames; `leaps` are their numbers of sampling intervals
    usual = float(np.median(steps))
    if not (steps > 0).all():
        at = 2 + int(np.argmax(steps <= 0))
        raise ResultError(f"{name}: frame {at}: its time is not later than the previous time")
    leaps = np.maximum(np.rint(steps / usual), 1.0)
    if np.abs(steps / usual - leaps).max() > _OFF:
        at = 2 + int(np.abs(steps / usual - leaps).argmax())
        rate = len(steps) / float(times[-1] - times[0])
        raise ResultError(
            f"{name}: frame {at}: its time is off the even step of {usual:.4g} s; if only the "
            f'time stamps are uneven, give the rate: --rate "{rate:.4g} Hz"'
        )
    frame = np.concatenate([[0], np.cumsum(leaps)]).astype(int)
    positions = np.full((frame[-1] + 1, len(moving)), np.nan)
    positions[frame] = table
    step = float(times[-1] - times[0]) / int(frame[-1])
    return Trajectory(step, positions, moving, columns.unit, notes, name=name)


def _in_a_row(trajectory: Trajectory) -> int:
    """Return the largest number of consecutive frames without a gap."""
    there = np.isfinite(trajectory.positions).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], there, [False]])))
    return int((edges[1::2] - edges[::2]).max()) if len(edges) else 0
