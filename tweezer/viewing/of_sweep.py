"""The page of a sweep: its cases over the keys that were varied, each with its results."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tweezer.results.io import scene_of
from tweezer.scene.heading import heading, named, of_changes
from tweezer.sweeps.quantities import FAILED, MISSING, quantities_of
from tweezer.trap.quantities import STABLE
from tweezer.values.measured import DIMENSIONS
from tweezer.values.prefixes import in_tables
from tweezer.values.signs import typeset
from tweezer.viewing.arrays import Packed, float32
from tweezer.viewing.content import Content, Row
from tweezer.viewing.rows import computed_by

if TYPE_CHECKING:
    import xarray as xr

#: Smallest ratio of the last value to the first for which an axis can be logarithmic
_WIDE = 3.0
#: Quantities whose values differ by orders of magnitude
_BY_RATIO = ("lifetime", "stiffness", "corner_frequency", "escape_energy", "escape_force")

#: Nouns for the computed quantities whose sweep is named by a verb
_NOUNS = {"calibrate": "calibration"}
#: Quantities shown in SI units
_IN_SI = ("lifetime",)


def content(dataset: xr.Dataset) -> Content:
    """Return the content of the page of a sweep. Raises `ResultError` if its scene is not valid."""
    of, scene = dataset.attrs["of"], scene_of(dataset)
    over = [str(dim) for dim in dataset["outcome"].dims]
    # the page shows numerical keys in ascending order
    dataset = dataset.sortby(
        [dim for dim in over if dim in dataset.coords and dataset[dim].dtype.kind in "if"]
    )
    words = {name: _words(dataset[name].values) for name in ("outcome", "reason", "caveat")}
    arrays = {name: numbers for name, (_, numbers) in words.items()}
    quantities = []
    for name, quantity in quantities_of(of).items():
        scale, unit = _unit(quantity.unit, apart=name in _IN_SI)
        along = DIMENSIONS[quantity.along] if quantity.along else []
        for each in (name, f"{name}_error"):
            if each in dataset:
                values = dataset[each].transpose(*over, ...).values * scale
                arrays[each] = float32(values, unit or "1")
                # for example a lifetime that is too long to be computed
                if np.isinf(values).any():
                    arrays[f"{each}_endless"] = float32(np.isinf(values), "1")
        quantities.append({
            "name": name, "about": quantity.about, "unit": unit, "along": along,
            "least": quantity.along == "direction",
            "log": name in _BY_RATIO, "error": f"{name}_error" in dataset,
        })  # fmt: skip
    outcomes, numbers = np.unique(dataset["outcome"].values, return_counts=True)
    counts = dict(zip(outcomes.tolist(), numbers.tolist(), strict=True))
    of_what = heading(scene, scene.title) if scene.changed else scene.name
    return Content(
        kind="sweep",
        title=f"{of_what}: {_NOUNS.get(of, of)} over {' and '.join(map(named, over))}",
        facts={
            "of": of,
            "scene": scene.name,
            "axes": [_axis(dataset, dim) for dim in over],
            "words": {name: list(found) for name, (found, _) in words.items()},
            "unknown": [FAILED, MISSING],
            "quantities": quantities,
        },
        arrays=arrays,
        summary=_summary(dataset, over, counts),
        notes=[*of_changes(scene), *_notes(dataset, of)],
        warning=f"This sweep was stopped early: {counts.get(MISSING, 0)} of its cases are not "
        "computed." if MISSING in counts else "",
    )  # fmt: skip


def _unit(unit: str, *, apart: bool = False) -> tuple[float, str]:
    """Return the factor from an SI unit to the unit in which a quantity is shown, and its name.

    If `apart`, the quantity is shown in the SI unit itself.
    """
    scale, name = (1.0, unit) if apart else in_tables(unit)
    return scale, typeset(name)


def _words(values: NDArray[Any]) -> tuple[list[str], Packed]:
    """Return the distinct words of an array, and for each case the index of its word."""
    found, numbers = np.unique(values.astype(str), return_inverse=True)
    return found.tolist(), float32(numbers.reshape(values.shape), "1")


def _axis(dataset: xr.Dataset, dim: str) -> dict[str, Any]:
    """Return a dimension of the cases as a JSON object: its name, and its keys with their values.

    It has one key in a grid of cases, and may have several in a table of cases.
    """
    keys = [dim] if dim in dataset.coords else [
        str(name) for name, of in dataset.coords.items() if of.dims == (dim,)
    ]  # fmt: skip
    described = []
    for key in keys:
        values, unit = dataset[key].values, str(dataset[key].attrs.get("units", ""))
        scale, shown = _unit(unit)
        numeric = values.dtype.kind in "if"
        described.append({
            "key": key,
            "name": named(key),
            "about": str(dataset[key].attrs.get("long_name", "")),
            "unit": shown,
            "si": unit,
            "values": (values * scale).tolist() if numeric else values.astype(str).tolist(),
            "given": values.tolist() if numeric else values.astype(str).tolist(),
            "numeric": numeric,
            "log": numeric and _wide(values),
        })  # fmt: skip
    return {"name": named(dim), "keys": described}


def _wide(values: NDArray[Any]) -> bool:
    """Return whether an axis should be logarithmic.

    The values, in ascending order, must have more even ratios than differences.
    """
    if values.size < 3 or values[0] <= 0 or values[-1] / values[0] <= _WIDE:
        return False
    return bool(np.ptp(np.diff(np.log(values))) < np.ptp(np.diff(values)) / values[-1])


def _summary(dataset: xr.Dataset, over: list[str], counts: dict[str, int]) -> list[Row]:
    """Return the lines of the summary of a sweep; `counts`: number of cases by outcome."""
    shape = " x ".join(f"{dataset.sizes[dim]} {dim}" for dim in over)
    return [
        Row("computed of each case", dataset.attrs["of"]),
        Row("cases", f"{dataset.attrs['cases']}: {shape}"),
        *(Row(outcome, f"{number}", "", outcome not in (FAILED, MISSING))
          for outcome, number in counts.items()),
        Row("with a caveat", f"{int((dataset['caveat'].values != '').sum())}"),
    ]  # fmt: skip


def _notes(dataset: xr.Dataset, of: str) -> list[str]:
    """Return the notes on how to read the page; `of`: what was computed, such as "trap"."""
    varied = [size for size in dataset["outcome"].shape if size > 1]
    notes = [
        "Each cell is one case and extends halfway to its neighbours. Hatched cells have no "
        "number; the outcome gives the reason."
        if len(varied) > 1
        else "Each point is one case; the lines guide the eye. A cross marks a case without a "
        "number; the outcome gives the reason."
    ]
    if of == "trap":
        notes.append(
            "The smallest value over the directions belongs to the easiest straight escape line. "
            "Escape work is not the height of a barrier, because the force of light has no "
            f"potential. A trap is shallow if it is less than {STABLE:g} kT: thermal motion soon "
            "removes the bead."
        )
        notes.append("An infinite lifetime means longer than 10²⁰ s.")
    if of in ("ensemble", "calibrate"):
        notes.append(
            "Thermal motion uses the same random numbers in every case, so differences between "
            "neighbours are due to the scenes."
        )
    return [*notes, computed_by(dataset.attrs)]
