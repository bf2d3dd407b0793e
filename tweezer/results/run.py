"""A run as arrays, with the dimensions and attributes of its dataset and NetCDF file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError

if TYPE_CHECKING:
    import xarray as xr

#: Dimensions, values and attributes of a variable
Variable = tuple[tuple[str, ...], NDArray[Any], dict[str, Any]]


@dataclass(frozen=True)
class Run:
    """A run before it becomes an `xarray.Dataset`.

    It exists because importing xarray takes longer than a short run.
    """

    coordinates: dict[str, Variable]
    variables: dict[str, Variable]
    attributes: dict[str, Any]

    @classmethod
    def of(cls, dataset: xr.Dataset) -> Run:
        """Return the run in a dataset.

        Raises `ResultError` if it is not a run, or is a part of a run without samples.
        """
        for name in ("position", "time"):
            if name not in dataset.variables:
                raise ResultError(f"not a run: it has no {name}")
            if dataset[name].dims[:1] != ("time",):
                raise ResultError(
                    f"not a run: no {name} over time; select a part of a run by a slice"
                )
        if not dataset.sizes["time"]:
            raise ResultError("a run without samples; must have at least one time")
        parts: dict[Any, Any] = {
            name: (each.dims, each.values, each.attrs) for name, each in dataset.variables.items()
        }
        coordinates: dict[Any, Any] = {name: parts.pop(name) for name in dataset.coords}
        return cls(coordinates, parts, dataset.attrs)

    def dataset(self) -> xr.Dataset:
        """Return the run as an `xarray.Dataset`."""
        import xarray as xr

        return xr.Dataset(self.variables, self.coordinates, self.attributes)

    def beside(self, name: str) -> list[str]:
        """Return the names of a variable's coordinates other than its dimensions."""
        if name not in self.variables:
            return []
        dimensions = self.variables[name][0]
        return [
            each for each, (own, *_) in self.coordinates.items()
            if (each,) != own and set(own) <= set(dimensions)
        ]  # fmt: skip

    def __contains__(self, name: str) -> bool:
        """Return whether the run has a variable or coordinate with this name."""
        return name in self.variables or name in self.coordinates

    def __getitem__(self, name: str) -> Array:
        """Return the values of a variable or coordinate; raise `ResultError` if it is missing."""
        if name not in self:
            raise ResultError(f"a part of a run: it has no {name}, which is required here")
        _, values, _ = self.variables.get(name) or self.coordinates[name]
        return values


def variable(dimensions: tuple[str, ...], values: Array, units: str, long_name: str) -> Variable:
    """Return a variable of a run: dimensions, values, and attributes with unit and long name.

    Parameters
    ----------
    dimensions : tuple of str
        Names of the dimensions.
    values : ndarray
        Values, in the unit.
    units : str
        Unit.
    long_name : str
        Description in words.
    """
    return dimensions, values, {"units": units, "long_name": long_name}


def with_error(described: Variable, error: str) -> Variable:
    """Return a variable with an attribute that names the variable of its error, `error`.

    See CF Conventions, section 3.4.
    """
    dimensions, values, attributes = described
    return dimensions, values, {**attributes, "ancillary_variables": error}
