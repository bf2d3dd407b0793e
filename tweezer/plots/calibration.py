"""Figure of a calibration: the recording, and the curves of the fits."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure, SubFigure

from tweezer.calibration import (
    in_metres,
    mean_squared_displacement,
    potential,
    power_spectrum,
    standard_error,
)
from tweezer.plots import style
from tweezer.plots.free import draw_free, draw_records, number
from tweezer.values.constants import Boltzmann
from tweezer.values.prefixes import per
from tweezer.values.printed import with_error
from tweezer.values.rounding import with_uncertainty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tweezer.calibration import Calibration, Finding
    from tweezer.reading import Recording


@style.styled
def calibration_figure(recording: Recording, calibration: Calibration) -> Figure:
    """Draw trajectory, density, power spectrum, mean squared displacement and potential, with fits.

    Below the spectrum are its residuals: data over fit. A bead that is free along all axes has a
    figure of its own, see `tweezer.plots.free.draw_free`.

    Bars are standard errors. Spectra are averaged over bins of frequency for the figure only;
    `calibration` contains the fits. A recording in volts is drawn in metres, and one with a drive
    without the motion that the stage causes.

    Parameters
    ----------
    recording : Recording
        Recording that was calibrated.
    calibration : Calibration
        Its calibration.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    free = calibration.free is not None and not calibration.trapped
    figure = style.new(style.PAGE, 6.2 if free else 7.8)
    draw_calibration(figure, recording, calibration)
    return figure


@style.styled
def draw_calibration(
    figure: Figure | SubFigure, recording: Recording, calibration: Calibration
) -> None:
    """Draw the panels of `calibration_figure` in a figure or a part of one."""
    if calibration.free is not None and not calibration.trapped:
        draw_free(figure, recording, calibration, calibration.free)
        return
    recording = in_metres(recording, calibration)
    records = [f"{axis} over time" for axis in recording.axes]
    rows: list[Any] = [
        *([name, name] for name in records),
        ["spectrum", "displacement"], ["residuals", "displacement"], ["potential", "density"],
    ]  # fmt: skip
    heights = [0.9 / len(records)] * len(records)
    axes = figure.subplot_mosaic(rows, height_ratios=(*heights, 1, 0.4, 1.2))
    draw_records([axes[name] for name in records], recording, "nm", per("nm"))
    _draw_density(axes["density"], recording)
    _draw_spectrum(axes["spectrum"], axes["residuals"], recording, calibration)
    _draw_displacement(axes["displacement"], recording, calibration)
    _draw_potential(axes["potential"], recording, calibration)
    figure.align_ylabels(
        [*(axes[name] for name in (*records, "spectrum", "residuals", "potential"))]
    )
    shown = [records[0], "spectrum", "residuals", "displacement", "potential", "density"]
    style.add_letters(axes[name] for name in shown if axes[name].axison)
    drag = "drag fitted"
    if calibration.drag is not None:
        drag = f"drag {calibration.drag * per('nN s/m'):.3g} nN s/m"
    if calibration.wall is not None:
        drag += " far away" if calibration.drag is not None else ""
        drag += f", {calibration.wall.distance * per('um'):.4g} µm from a wall"
    style.add_title(figure, f"Calibration of {calibration.name}")
    note = (
        f"{calibration.temperature:.5g} K, {drag}, {calibration.samples} samples, one every "
        f"{calibration.step * per('ms'):.3g} ms. Bars: standard errors; rings: corner frequencies; "
        "dotted: beyond the frequencies of the fit. The spectrum includes its aliases."
    )
    style.add_notes(figure, [note])


def _draw_density(axes: Axes, recording: Recording) -> None:
    """Draw the probability density of the first two coordinates."""
    if len(recording.axes) < 2:
        axes.set_axis_off()
        return
    x, y = (
        (recording.positions[:, i] - recording.positions[:, i].mean()) * per("nm") for i in (0, 1)
    )
    reach = 4 * max(x.std(), y.std()) * np.array([-1, 1])
    _, _, _, shown = axes.hist2d(
        x, y, bins=64, range=[reach, reach], density=True, cmap=style.FROM_ZERO, rasterized=True
    )
    axes.figure.colorbar(shown, ax=axes, label="probability density (1/nm²)", fraction=0.05)
    axes.set(
        aspect="equal", xlabel=f"{recording.axes[0]} from the mean (nm)",
        ylabel=f"{recording.axes[1]} from the mean (nm)",
    )  # fmt: skip
    axes.set_title("density")


def _draw_spectrum(
    axes: Axes, residuals: Axes, recording: Recording, calibration: Calibration
) -> None:
    """Draw power spectra with their models: solid in the range of the fit, dotted beyond.

    Rings mark corner frequencies.
    """
    for each in (residuals, axes):
        each.set_xscale("log")
    axes.sharex(residuals)
    every = zip(calibration.axes, recording.positions.T, strict=True)
    for below, (found, positions) in enumerate(every):
        frequencies, density = power_spectrum(positions, recording.step)
        edges = np.geomspace(frequencies[0], frequencies[-1] * (1 + 1e-9), 61)
        bins = np.digitize(frequencies, edges)
        counts = np.bincount(bins)
        kept = counts >= 4
        at, mean = (
            np.bincount(bins, values)[kept] / counts[kept] for values in (frequencies, density)
        )
        mark = style.AXES[found.axis]
        axes.errorbar(
            at, mean, mean / np.sqrt(counts[kept]), elinewidth=0.6, ms=2.5, alpha=0.6,
            zorder=2 - below / 4, **mark.points,
        )  # fmt: skip
        frequencies = np.geomspace(at[0], frequencies[-1], 400)
        fitted = frequencies <= found.fit.highest_frequency
        bead, uncertainty = found.fit.bead, found.fit.corner_frequency_uncertainty
        curve = bead.sampled_spectrum(frequencies, recording.step)
        ratio = mean / bead.sampled_spectrum(at, recording.step)
        residuals.errorbar(
            at, ratio, ratio / np.sqrt(counts[kept]), elinewidth=0.6, ms=2.5, alpha=0.6,
            zorder=2 - below / 4, **mark.points,
        )  # fmt: skip
        corner = with_uncertainty(bead.corner_frequency, uncertainty, "±")
        axes.plot(
            frequencies[fitted], curve[fitted], zorder=3 - below / 4, **mark.curve,
            label=f"{found.axis}: $f_c$ = {corner} Hz{_mark(found.findings)}",
        )  # fmt: skip
        axes.plot(frequencies, curve, color=mark.colour, lw=0.6, ls=":", zorder=3)
        if at[0] < bead.corner_frequency < frequencies[-1]:
            height = np.interp(bead.corner_frequency, frequencies, curve)
            axes.plot(
                bead.corner_frequency, height, "o", mfc="white", mec=mark.colour, ms=5, zorder=4
            )
        for answer in found.answers:
            axes.axvline(answer.frequency, ymin=0.92, color=mark.colour, lw=1.0)
    axes.set(yscale="log", ylabel="density (m²/Hz)")
    axes.tick_params(labelbottom=False)
    residuals.axhline(1, color=style.INK, lw=0.8)
    residuals.set(xlabel="frequency (Hz)", ylabel="data / fit")
    style.headroom(axes, 0.11 * len(calibration.axes), below=True)
    axes.legend(loc="lower left")
    form = "Lorentzian" if calibration.mass is None else "inertial form"
    if calibration.displaced_mass is not None:
        form = "hydrodynamic form"
    if not all(found.fit.bead.seen_as_it_is for found in calibration.axes):
        form += " as detected"
    axes.set_title(f"power spectrum, {form}")


def _draw_displacement(axes: Axes, recording: Recording, calibration: Calibration) -> None:
    """Draw mean squared displacements over the lag, with the curves of the estimated stiffness."""
    step = recording.step
    for found, positions in zip(calibration.axes, recording.positions.T, strict=True):
        longest = min(len(positions) // 4, 10 * found.fit.bead.relaxation_time / step)
        lags = np.unique(np.geomspace(1, max(longest, 10), 24).astype(int))
        values = mean_squared_displacement(positions, lags)
        errors = [standard_error((positions[lag:] - positions[:-lag]) ** 2) for lag in lags]
        mark, estimate = style.AXES[found.axis], found.by("displacement") or found.estimates[0]
        axes.errorbar(
            lags * step, values * per("nm^2"), np.array(errors) * per("nm^2"), elinewidth=0.7,
            ms=2.5, alpha=0.7, **mark.points,
        )  # fmt: skip
        bead = dataclasses.replace(found.fit.bead, stiffness=estimate.stiffness)
        times = np.geomspace(lags[0], lags[-1], 200) * step
        axes.plot(
            times, bead.mean_squared_displacement(times) * per("nm^2"), **mark.curve,
            label=f"{found.axis}: {_stiffness(estimate.stiffness, estimate.uncertainty)}"
            f"{_mark(estimate.findings)}",
        )  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel="lag (s)", ylabel="displacement² (nm²)")
    style.headroom(axes, 0.11 * len(calibration.axes))
    for along in (axes.xaxis, axes.yaxis):
        number(along)
    axes.legend(loc="upper left")
    axes.set_title("mean squared displacement")


def _draw_potential(axes: Axes, recording: Recording, calibration: Calibration) -> None:
    """Draw the potential from the histogram of positions, in k_B T, with the fitted parabolas."""
    kT = Boltzmann * calibration.temperature
    for found, positions in zip(calibration.axes, recording.positions.T, strict=True):
        well = potential(positions, calibration.temperature)
        mark = style.AXES[found.axis]
        label = "too few independent samples"
        if well.stiffness is not None and well.uncertainty is not None and well.minimum is not None:
            estimate = found.by("potential") or found.estimates[0]
            label = _stiffness(estimate.stiffness, estimate.uncertainty) + _mark(estimate.findings)
            reach = math.sqrt(2 * 4.5 * kT / well.stiffness) * np.linspace(-1, 1, 101)
            axes.plot(
                (well.minimum - found.centre + reach) * per("nm"),
                well.stiffness * reach**2 / 2 / kT, **mark.curve,
            )  # fmt: skip
        axes.errorbar(
            (well.coordinates - found.centre) * per("nm"), well.energy / kT, well.errors / kT,
            elinewidth=0.7, ms=2.5, alpha=0.7, label=f"{found.axis}: {label}", **mark.points,
        )  # fmt: skip
    axes.set(xlabel="from the mean (nm)", ylabel="potential ($k_B T$)")
    axes.set_ylim(bottom=-0.3)
    style.headroom(axes, 0.12 * len(calibration.axes))
    axes.legend(loc="upper center")
    axes.set_title("potential, from the histogram")


def _stiffness(k: float, uncertainty: float) -> str:
    """Return a stiffness and its uncertainty, N/m, as text for a legend."""
    return f"k = {with_error(k, uncertainty, 'pN/µm', '±')}"


def _mark(findings: tuple[Finding, ...]) -> str:
    """Return the end of the legend text for an estimate with findings; "" without findings."""
    return ", not trusted" if findings else ""
