"""Figures of sweeps: maps over two keys, curves over one key, families of curves."""

from __future__ import annotations

import itertools
import math
import string
import textwrap
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter

from tweezer.plots import style
from tweezer.plots.scene import change_note
from tweezer.results.io import scene_of
from tweezer.scene.heading import named
from tweezer.sweeps.quantities import FAILED, MISSING
from tweezer.trap.quantities import STABLE
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.prefixes import in_tables
from tweezer.values.signs import typeset

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis


#: Lifetime of one hour, and the longest one that is distinguished, s
_HOUR, _LONGEST = 3600.0, 1e10
#: Largest number of curves in a family
_FAMILY = 8
#: Smallest ratio of the ends of a range for which its axis can be logarithmic
_WIDE = 3.0
#: Colours of cases without a trap, failed cases, and cases that were not computed
_LOST, _BROKEN, _EMPTY = "#d9d9d9", style.LIGHT, "#ffffff"
#: Length of a line in the title of a panel
_TITLE = 46


class _Panel(NamedTuple):
    """A quantity of a sweep in the form in which a panel of the figure shows it."""

    values: xr.DataArray
    """values over the swept dimensions, in the unit of the figure"""
    error: xr.DataArray
    """errors of the values"""
    label: str
    """name of the quantity"""
    axis: str
    """short name with the unit"""
    log: bool = False
    """whether values differ by orders of magnitude"""
    line: float | None = None
    """value that is marked by a line"""
    line_is: str = ""
    """what the line means"""
    top: float | None = None
    """upper limit of the values drawn"""


@style.styled
def sweep_figure(result: xr.Dataset) -> Figure:
    """Draw the main quantities of a sweep over one or two of its keys.

    Two keys with numerical ranges give maps. For a trap these show the well depth, where it holds
    the bead, with the line of 10 k_B T, and the stiffness. One range gives curves with their
    errors, one for each of a few values of a second key or of a few cases. Failed cases, and cases
    in which nothing holds the bead, are marked. Raises `ResultError` for a sweep over more keys:
    first select with `.sel`.
    """
    over = [str(dim) for dim in result["outcome"].dims]
    swept = drawn_over({dim: result.sizes[dim] for dim in over})
    result = result.squeeze([dim for dim in over if dim not in swept])
    result = result.sortby([dim for dim in swept if dim in result.coords and _numeric(result[dim])])
    panels = _panels(result)
    columns = min(2, len(panels))
    rows = math.ceil(len(panels) / columns)
    figure = style.new(style.COLUMN if columns == 1 else style.PAGE, 0.5 + 2.35 * rows)
    every = list(figure.subplots(rows, columns, squeeze=False).flat)
    few = [dim for dim in swept if not _numeric(result[dim]) or result.sizes[dim] <= _FAMILY]
    family = sorted(few, key=lambda dim: (_numeric(result[dim]), result.sizes[dim]))
    drawn_as_map = len(swept) == 2 and not family
    for axes, panel in itertools.zip_longest(every, panels):
        if panel is None:
            axes.set_axis_off()
        elif drawn_as_map:
            _draw_map(axes, panel, result, *swept)
        else:
            _draw_curves(axes, panel, result, swept, family)
    style.add_letters(every[: len(panels)])
    scene, keys = scene_of(result), [named(key) for dim in swept for key in _keys_of(result, dim)]
    style.add_title(figure, f"{scene.name}: {result.attrs['of']} over {' and '.join(keys)}")
    style.add_notes(figure, [change_note(scene), _marks_note(result, panels, maps=drawn_as_map)])
    return figure


def _marks_note(result: xr.Dataset, panels: list[_Panel], *, maps: bool) -> str:
    """Return a note on the lines and marks that occur in the panels.

    maps: whether the panels are maps.
    """
    told = [
        f"{'white' if maps else 'dashed'} line in {letter}: {panel.line_is}"
        for letter, panel in zip(string.ascii_lowercase, panels, strict=False)
        if panel.line is not None
    ]
    top = next((panel.top for panel in panels if panel.top), None)
    if top and any(panel.top and (panel.values == panel.top).any() for panel in panels):
        told.append(f"{'brightest colour' if maps else 'triangle up'}: {top:.0e} s or longer")
    if not maps:
        failed = result["outcome"] == FAILED
        without = [panel.values.isnull() for panel in panels]
        if any((each & ~failed).any() for each in without):
            told.append("cross: no number, because nothing holds the bead")
        if any((each & failed).any() for each in without):
            told.append("triangle down: failed")
        if (result["caveat"] != "").any():
            told.append("hollow: with a caveat")
    note = "; ".join(told)
    return f"{note[0].upper()}{note[1:]}." if told else ""


def drawn_over(sizes: Mapping[str, int]) -> list[str]:
    """Return the dimensions of a sweep with several values; raise `ResultError` unless 1 or 2.

    `sizes` has the number of values by dimension.
    """
    swept = [dim for dim, size in sizes.items() if size > 1]
    if not 1 <= len(swept) <= 2:
        way_out = f"; select among {', '.join(swept)} with .sel first" if swept else ""
        raise ResultError(
            f"a figure requires one or two keys with several values, not {len(swept)}{way_out}"
        )
    return swept


def _numeric(values: xr.DataArray) -> bool:
    """Return whether the values of a key are numbers."""
    return values.dtype.kind in "if"


def _panels(result: xr.Dataset) -> list[_Panel]:
    """Return the panels of the figure, which depend on the kind of sweep."""
    match result.attrs["of"]:
        case "trap":
            panels = [
                _easiest(
                    result, "escape_energy", 1.0,
                    "well depth in the easiest direction", "depth ($k_B T$)", STABLE,
                    f"depth of {STABLE:g} kT",
                ),
                _panel(result, "equilibrium", "z"),
                _easiest(
                    result, "escape_force", 1e12, "smallest escape force", "escape force (pN)"
                ),
                *(_panel(result, "stiffness", axis, log=True) for axis in "xz"),
            ]  # fmt: skip
            if result["lifetime"].notnull().any():
                times = result["lifetime"].clip(max=_LONGEST)
                errors = result["lifetime_error"].where(times < _LONGEST)
                lifetime = _Panel(
                    times, errors, "lifetime", "lifetime (s)", True, _HOUR, "an hour", _LONGEST
                )
                panels.insert(1, lifetime)
            return panels
        case "run":
            names = ("outcome_time", "closest_approach", "overshoot", "largest_force")
            return [_panel(result, name) for name in names]
        case "ensemble":
            return [_panel(result, "lost"), *(_panel(result, "variance", axis) for axis in "xyz")]
        case _:
            return [
                *(_panel(result, "stiffness", axis, log=True) for axis in "xyz"),
                _panel(result, "diffusion", "x"),
            ]


def _easiest(
    result: xr.Dataset, name: str, scale: float, label: str, axis: str,
    line: float | None = None, line_is: str = "",
) -> _Panel:  # fmt: skip
    """Return the panel of a quantity in the direction in which it is smallest.

    `scale` is the factor from the SI unit to the unit of the figure. A line marks the value `line`,
    and `line_is` is its meaning. `_Panel` describes `label` and `axis`.
    """
    at = result[name].fillna(math.inf).argmin("direction")
    values, errors = (result[each].isel(direction=at) for each in (name, f"{name}_error"))
    return _Panel(scale * values, scale * errors, label, axis, True, line, line_is)


def _panel(result: xr.Dataset, name: str, axis: str = "", *, log: bool = False) -> _Panel:
    """Return the panel of a quantity, along an axis if given, in the unit of figures."""
    values, error = result[name], result[f"{name}_error"]
    label = values.attrs["long_name"]
    if axis:
        values, error = values.sel(axis=axis), error.sel(axis=axis)
        label = f"{label}, {axis}"
    scale, unit = _shown(result[name].attrs["units"])
    return _Panel(values * scale, error * scale, label, f"{name.replace('_', ' ')}{unit}", log)


def _shown(unit: str) -> tuple[float, str]:
    """Return the factor from an SI unit to the unit of the figure, and this unit in brackets."""
    scale, name = in_tables(unit)
    return scale, f" ({typeset(name)})" if name else ""


def _axis_of(values: xr.DataArray) -> tuple[Array, str, bool]:
    """Return the values of a key in the figure's unit, their label, and whether the axis is
    logarithmic.

    It is if they are positive, differ by a factor above 3, and have more even ratios than
    differences. Values that are not numbers are numbered.
    """
    if not _numeric(values):
        return np.arange(values.size, dtype=float), named(str(values.name)), False
    scale, unit = _shown(values.attrs.get("units", ""))
    at = values.values * scale
    wide = bool(at.min() > 0 and at.max() / at.min() > _WIDE)
    if wide and at.size > 2:
        ratios = np.diff(np.log(np.sort(at)))
        wide = bool(np.ptp(ratios) < np.ptp(np.diff(np.sort(at))) / np.abs(at).max())
    return at, f"{named(str(values.name))}{unit}", wide


def _draw_map(axes: Axes, panel: _Panel, result: xr.Dataset, down: str, along: str) -> None:
    """Draw a quantity as colours over two keys; mark cells without a number by their outcome.

    `down` and `along` are the dimensions on the vertical and the horizontal axis.
    """
    x, x_label, x_wide = _axis_of(result[along])
    y, y_label, y_wide = _axis_of(result[down])
    values = panel.values.transpose(down, along).values
    positive = values[np.isfinite(values) & (values > 0)]
    norm = None
    if panel.log and positive.size and positive.max() / positive.min() > _WIDE:
        norm = LogNorm(positive.min(), positive.max())
    axes.set(xscale="log" if x_wide else "linear", yscale="log" if y_wide else "linear")
    for axis, at, wide in ((axes.xaxis, x, x_wide), (axes.yaxis, y, y_wide)):
        if wide:
            _number(axis, at)
    shown = axes.pcolormesh(
        _edges(x, wide=x_wide), _edges(y, wide=y_wide), np.ma.masked_invalid(values), norm=norm,
        cmap=style.VALUES, rasterized=True,
    )  # fmt: skip
    colorbar = axes.figure.colorbar(shown, ax=axes, label=panel.axis)
    outcome = result["outcome"].transpose(down, along).values
    _mark(axes, x, y, x_wide, y_wide, np.isnan(values), outcome)
    line = panel.line
    if line is not None and positive.size and positive.min() < line < positive.max():
        heights = np.log(np.ma.masked_less_equal(np.ma.masked_invalid(values), 0.0))
        axes.contour(x, y, heights, [math.log(line)], colors="white", linewidths=1.4)
        colorbar.ax.axhline(line, color="white", lw=1.4)
    axes.set(xlabel=x_label, ylabel=y_label)
    axes.set_title(textwrap.fill(panel.label, _TITLE), parse_math=False)


def _mark(
    axes: Axes, x: Array, y: Array, x_wide: bool, y_wide: bool, without: Any, outcome: Any
) -> None:
    """Colour the cells without a number by their outcome, with a legend.

    `x` and `y` are the values of both keys, `x_wide` and `y_wide` whether the axes are logarithmic.
    `without` selects the cells without a number, and `outcome` has the words of all cells, both as
    arrays (y, x).
    """
    styles = {FAILED: _BROKEN, MISSING: _EMPTY}
    legend = []
    for word in np.unique(outcome[without]):
        colour = styles.get(str(word), _LOST)
        cells = np.ma.masked_where(~(without & (outcome == word)), np.zeros(outcome.shape))
        axes.pcolormesh(
            _edges(x, wide=x_wide), _edges(y, wide=y_wide), cells, vmin=0, vmax=1, alpha=1.0,
            cmap=_one_colour(colour), rasterized=True,
        )  # fmt: skip
        legend.append(Patch(facecolor=colour, edgecolor="#999999", label=str(word)))
    if legend:
        axes.legend(handles=legend, loc="upper left")


def _one_colour(colour: str) -> Any:
    """Return a colour map with a single colour."""
    from matplotlib.colors import ListedColormap

    return ListedColormap([colour])


def _number(axis: Axis, at: Array) -> None:
    """Use plain numbers on a logarithmic axis, more of them if it is short; `at`: its values."""
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if at.max() < 100 * at.min() else (1,)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def _edges(at: Array, *, wide: bool) -> Array:
    """Return the edges (n + 1,) of cells around values (n,), in order; they may be uneven.

    `wide` is whether the axis is logarithmic.
    """
    values = np.log(at) if wide else at
    middle = (values[1:] + values[:-1]) / 2  # the outer edges mirror the nearest inner ones
    edges = np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])
    return np.exp(edges) if wide else edges


def _draw_curves(
    axes: Axes, panel: _Panel, result: xr.Dataset, swept: list[str], family: list[str]
) -> None:
    """Draw a quantity as curves with errors over one key, one for each member of the family.

    `swept` are the dimensions with several values, and `family` those that may distinguish curves,
    the best first.
    """
    names = family[:1] if len(swept) == 2 else []
    (along,) = [dim for dim in swept if dim not in names]
    x, label, wide = _axis_of(result[along])
    values = panel.values.transpose(*names, along).values.reshape(-1, x.size)
    errors = panel.error.transpose(*names, along).values.reshape(values.shape)
    outcome = result["outcome"].transpose(*names, along).values.reshape(values.shape)
    told = _told(result, names[0]) if names else [""]
    doubted = result["caveat"].transpose(*names, along).values.reshape(values.shape) != ""
    marks = _marks(len(values))
    for row, mark, name in zip(range(len(values)), marks, told, strict=True):
        order = np.argsort(x)
        bars = np.nan_to_num(errors[row][order])
        cut = values[row] == panel.top
        shown = np.where(cut, np.nan, values[row])
        axes.errorbar(
            x[order], shown[order], bars, elinewidth=0.8, label=name, **mark.both,
        )  # fmt: skip
        axes.plot(
            x[doubted[row]], values[row][doubted[row]], mfc="white", zorder=4, **mark.points,
        )  # fmt: skip
        axes.plot(x[cut], values[row][cut], "^", ms=6, color=mark.colour)
        for word, marker in (("", "x"), (FAILED, "v")):
            without = np.isnan(values[row]) & ((outcome[row] == FAILED) == (word == FAILED))
            (crosses,) = axes.plot(
                x[without], np.zeros(without.sum()), marker, color=mark.colour, ms=5, clip_on=False,
                transform=axes.get_xaxis_transform(),
            )  # fmt: skip
            crosses.set_in_layout(False)
    positive = values[np.isfinite(values)]
    log = panel.log and positive.size and positive.min() > 0
    log = bool(log and (panel.top is not None or positive.max() / positive.min() > _WIDE))
    axes.set(yscale="log" if log else "linear", xlabel=label, ylabel=panel.axis)
    if wide:
        axes.set(xscale="log")
        _number(axes.xaxis, x)
    if not _numeric(result[along]):
        axes.set_xticks(x, [str(value) for value in result[along].values])
    if panel.line is not None:
        axes.axhline(panel.line, color=style.MUTED, lw=0.8, ls="--")
    axes.set_title(textwrap.fill(panel.label, _TITLE), parse_math=False)
    if names and axes is axes.figure.axes[0]:
        title = ", ".join(named(key) for key in _keys_of(result, names[0]))
        axes.legend(title=title)


def _keys_of(result: xr.Dataset, dimension: str) -> list[str]:
    """Return the keys that vary along a dimension; a table of cases may have several."""
    if dimension in result.coords:
        return [dimension]
    return [str(name) for name, of in result.coords.items() if of.dims == (dimension,)]


def _told(result: xr.Dataset, dimension: str) -> list[str]:
    """Return a label for each entry of a dimension, from the values of its keys."""
    columns = []
    for key in _keys_of(result, dimension):
        values = result[key]
        scale, unit = _shown(values.attrs.get("units", ""))
        unit = unit.strip(" ()")
        columns.append(
            [f"{scale * value:.4g} {unit}".strip() for value in values.values]
            if _numeric(values)
            else [str(value) for value in values.values]
        )
    return [", ".join(row) for row in zip(*columns, strict=True)]


def _marks(count: int) -> list[style.Mark]:
    """Return the styles of `count` curves; for many curves, colours from dark to light."""
    if count <= len(style.SERIES):
        return list(style.SERIES[:count])
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    shades = [to_hex(colormaps[style.VALUES](0.9 * i / (count - 1))) for i in range(count)]
    again = itertools.cycle(style.SERIES)
    return [style.Mark(shade, *next(again)[1:]) for shade in shades]
