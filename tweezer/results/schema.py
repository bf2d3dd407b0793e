"""Required contents of a result: attributes, variables and units, checked on reading.

Each kind of dataset has one table, on which the code that reads a result relies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, Json, TypeAdapter, ValidationError

from tweezer.scene import Scene
from tweezer.scene.choices import MODELS
from tweezer.values.errors import ResultError
from tweezer.values.saved import kind_of
from tweezer.values.shown import clipped

if TYPE_CHECKING:
    import xarray as xr

Count = Annotated[int, Field(ge=0)]
#: Sizes of the dimensions of vectors
_VECTORS = {"axis": 3, "euler_parameter": 4, "body_axis": 3, "direction": 6}


#: Upper bound on the coordinates of a bead, m, above which statistics overflow.
_LARGEST_POSITION = 1e9


class Event(BaseModel):
    """Event in the attributes of a run."""

    name: str
    time: float
    """s"""
    position: tuple[float, float, float]
    """m"""
    orientation: tuple[float, float, float, float] | None = None
    """Euler parameters, for an event of poses"""


class _Attributes(BaseModel):
    """Attributes that every dataset of tweezer has."""

    model_config = ConfigDict(strict=True)

    title: str
    scene: str


class _OfRun(_Attributes):
    """Attributes of a run."""

    model: Literal[*MODELS]  # type: ignore[valid-type]
    method: str
    fluid_inertia: str
    force_evaluator: str
    status: Literal["complete", "lost", "ended", "interrupted", "failed"]
    message: str
    integration_error: float
    model_error: float
    events: Json[list[Event]] = []
    scene_as_given: Json[dict[str, Any]] = {}
    summary: Json[dict[str, Any]] = {}
    other_forces: Count = 0
    seed: int | None = None
    step: Annotated[float, Field(gt=0)] | None = None


class _OfEnsemble(_Attributes):
    """Attributes of an ensemble or its statistics."""

    seed: int
    trajectories: Count
    model: Literal[*MODELS]  # type: ignore[valid-type]
    method: str
    step: Annotated[float, Field(gt=0)]


class _OfSweep(_Attributes):
    """Attributes of a sweep."""

    of: str
    over: Json[dict[str, dict[str, list[Any]]]]
    status: Literal["complete", "interrupted"]
    cases: Count
    trajectories: str | None = None
    skip: str | None = None
    seed: str | None = None


class Variable(NamedTuple):
    """Dimensions and unit that a variable of a result must have."""

    dimensions: tuple[str, ...]
    unit: str
    needed: bool = False
    """whether the result must have it"""


class Schema(NamedTuple):
    """Requirements on every result of a kind: attributes, variables and a further check."""

    attributes: type[_Attributes]
    variables: Mapping[str, Variable]
    check: Callable[[xr.Dataset, Any, Scene], Iterable[str]]
    """function that yields further errors, from a dataset, its attributes and its scene"""


def checked(dataset: xr.Dataset, name: str) -> xr.Dataset:
    """Return the dataset after checking that it is a valid result of its kind.

    Raises `ResultError`, beginning with `name`, if it is not. Kinds that are not in `SCHEMAS`, such
    as a trap over heights, are not checked.
    """
    kind = kind_of(dataset)
    schema = SCHEMAS.get(kind.name) if kind else None
    if kind is None or schema is None:
        return dataset
    for reason in _wrong(dataset, schema):
        raise ResultError(f"{name}: not {kind.told} as tweezer saves it: {clipped(reason)}")
    return dataset


def _wrong(dataset: xr.Dataset, schema: Schema) -> Iterable[str]:
    """Yield the errors of a dataset in attributes, variables, sizes of vectors, and the further
    check.
    """
    attributes = {str(key): plain(value) for key, value in dataset.attrs.items()}
    try:
        about = schema.attributes.model_validate(attributes)
        scene = Scene.model_validate_json(about.scene)
    except ValidationError as error:
        yield of_validation(error)
        return
    for name, variable in schema.variables.items():
        if name in dataset.variables:
            yield from _wrong_variable(dataset, name, variable)
        elif variable.needed:
            yield f"it has no {name}"
    for dimension, size in _VECTORS.items():
        if dataset.sizes.get(dimension, size) != size:
            yield f"its {dimension} has {dataset.sizes[dimension]} entries, not {size}"
    yield from schema.check(dataset, about, scene)


def _wrong_variable(dataset: xr.Dataset, name: str, expected: Variable) -> Iterable[str]:
    """Yield the error of a variable in dimensions, type, sign or unit, if there is one."""
    there = dataset.variables[name]
    if there.dims != expected.dimensions:
        along = ", ".join(map(str, there.dims))
        yield f"its {name} is over ({along}), not over ({', '.join(expected.dimensions)})"
    elif expected.unit == TEXT:
        if there.dtype.kind not in "UOT":
            yield f"its {name} is not text"
    elif there.dtype.kind not in "fiu":
        yield f"its {name} is not a number"
    elif name.endswith("_error") and (there.values < 0).any():
        yield f"its {name} is negative"
    elif str(there.attrs.get("units", "")) != expected.unit:
        unit = str(there.attrs.get("units", "no unit"))[:20]
        yield f"its {name} is in {unit!r}, not in {expected.unit!r}"


def plain(value: Any) -> Any:
    """Return an attribute as a Python number; NetCDF files have NumPy's."""
    return value.item() if isinstance(value, np.generic) else value


def of_validation(error: ValidationError) -> str:
    """Return the first error of a Pydantic validation: its location and the reason."""
    first = error.errors(include_url=False, include_input=False)[0]
    where = ".".join(map(str, first["loc"])) or "scene"
    message = " ".join(first["msg"].split())
    return f"{where}: {message if len(message) <= 200 else message[:197] + '...'}"


def events_in(attributes: Mapping[str, Any]) -> list[Event]:
    """Return the events in the attributes of a run; raise `ResultError` if they are not valid."""
    try:
        return _EVENTS.validate_json(attributes.get("events", "[]"))
    except ValidationError as error:
        raise ResultError(f"not a run: events: {of_validation(error)}") from None


_EVENTS = TypeAdapter(list[Event])


# --- checks of each kind beside the table ---------------------------------------------------------


def rising(dataset: xr.Dataset, name: str) -> Iterable[str]:
    """Yield the error of a coordinate that must be finite and increasing."""
    values = dataset[name].values
    if not np.isfinite(values).all():
        yield f"its {name} is not finite at entry {1 + int(np.argmin(np.isfinite(values)))}"
    elif (falls := np.diff(values) <= 0).any():
        yield f"its {name} does not increase after entry {1 + int(np.argmax(falls))}"


def _of_times(dataset: xr.Dataset) -> Iterable[str]:
    """Yield the errors in the times of a dataset."""
    for name in ("time", "frame_time"):
        if name in dataset.variables:
            yield from rising(dataset, name)
    if not dataset.sizes["time"]:
        yield "it has no sample"


def _of_run(dataset: xr.Dataset, about: _OfRun, scene: Scene) -> Iterable[str]:
    """Yield the errors of a run beyond its schema."""
    yield from _of_times(dataset)
    if (np.abs(dataset["position"].values) > _LARGEST_POSITION).any():
        yield f"its position exceeds {_LARGEST_POSITION:g} m"
    if scene.forces.brownian and about.step is None:
        yield "it has no attribute step, which a run with thermal motion has"
    if scene.draws and about.seed is None:
        yield "it has no attribute seed, which a run with random numbers has"


def _of_ensemble(dataset: xr.Dataset, about: _OfEnsemble, _scene: Scene) -> Iterable[str]:
    """Yield the errors of an ensemble beyond its schema."""
    yield from _of_times(dataset)
    if dataset.sizes["trajectory"] != about.trajectories:
        yield f"it has {dataset.sizes['trajectory']} of {about.trajectories} trajectories"


def _of_statistics(dataset: xr.Dataset, _about: _OfEnsemble, _scene: Scene) -> Iterable[str]:
    """Yield the errors of statistics of an ensemble beyond their schema."""
    yield from _of_times(dataset)
    for name in ("bin", "lag", "frequency"):
        if name in dataset.variables:
            yield from rising(dataset, name)
    for name in ("trajectories", "trajectories_lost", "windows"):
        if not 0 <= float(dataset[name].values) < 2**53:
            yield f"its {name} is no number of them"
    for variable, each in dataset.data_vars.items():
        name = str(variable)
        of, _, moment = name.rpartition("_")
        if moment == "variance" and each.dims[:1] == ("time",):
            needed = (f"{of}_{other}" for other in ("mean", "kurtosis", "variance_error"))
            yield from (
                f"it has no {one} beside its {name}"
                for one in needed
                if one not in dataset or dataset[one].dims != each.dims
            )


def _of_sweep(dataset: xr.Dataset, about: _OfSweep, _scene: Scene) -> Iterable[str]:
    """Yield the errors of a sweep, whose variables depend on the keys that were varied."""
    over = [str(dimension) for dimension in dataset["outcome"].dims]
    shape = {name: {key: len(values) for key, values in keys.items()} for name, keys in
             about.over.items()}  # fmt: skip
    if over != list(shape) or any(
        size != dataset.sizes[name] for name in over for size in shape[name].values()
    ):
        yield "its cases differ from its attribute over"
        return
    if about.cases != dataset["outcome"].size:
        yield f"it has {dataset['outcome'].size} of {about.cases} cases"
    for name in _WORDS:
        if name not in dataset:
            yield f"it has no {name}"
            return
        yield from _wrong_variable(dataset, name, Variable(tuple(over), TEXT))
    for key in (key for keys in shape.values() for key in keys):
        if key not in dataset.variables:
            yield f"it has no {key}"
        elif dataset[key].dtype.kind == "f" and not np.isfinite(dataset[key].values).all():
            yield f"its {key} is not finite"
    for variable, each in dataset.data_vars.items():
        name, along = str(variable), each.dims[len(over) :]
        if name in _WORDS:
            continue
        if list(each.dims[: len(over)]) != over or along not in ((), ("axis",), ("direction",)):
            yield f"its {name} is not over its cases"
        if each.dtype.kind not in "fiub":
            yield f"its {name} is not a number"
        elif each.dtype.kind != "b" and not isinstance(each.attrs.get("units"), str):
            yield f"its {name} has no unit"
        error = each.attrs.get("ancillary_variables")
        if error is not None and (
            not isinstance(error, str) or error not in dataset or dataset[error].dims != each.dims
        ):
            yield f"the error of its {name} is missing"


#: Variables with text for every case of a sweep
_WORDS = ("outcome", "reason", "caveat")
#: Marks a variable with text instead of numbers, in place of a unit
TEXT = "text"
_TIME = Variable(("time",), "s", needed=True)


def _over_time(*along: str, **units: str) -> dict[str, Variable]:
    """Return variables over time and the further dimensions `along`, by name, with these units."""
    return {name: Variable(("time", *along), unit) for name, unit in units.items()}


_SEEN = {
    "seen": Variable(("frame", "seen_axis"), "m"), "frame_time": Variable(("frame",), "s"),
}  # fmt: skip
_RUN = {
    "time": _TIME,
    "position": Variable(("time", "axis"), "m", needed=True),
    **_over_time("axis", velocity="m/s", optical_force="N", net_force="N"),
    **_over_time("axis", in_phase="m", quadrature="m"),
    **_over_time("axis", feedback_force="N", feedback_power="1", feedback_position="m"),
    **_over_time("euler_parameter", orientation="1"),
    **_over_time("body_axis", angular_velocity="rad/s"),
    **_over_time(
        force_error="N", terminal_speed="m/s", distance="m", potential_energy="J", gap="m",
        speed="m/s", reynolds_number="1", kinetic_energy="J", total_energy="J",
    ),
    **_SEEN,
}  # fmt: skip
_BEADS = {
    "time": _TIME,
    "position": Variable(("time", "bead", "axis"), "m", needed=True),
    **_over_time("bead", "axis", optical_force="N"),
    **_over_time("pair", distance="m", gap="m", force_between="N"),
}
_ENSEMBLE = {
    "time": _TIME,
    "lost_time": Variable(("trajectory",), "s", needed=True),
    "position": Variable(("trajectory", "time", "axis"), "m", needed=True),
    "velocity": Variable(("trajectory", "time", "axis"), "m/s"),
    "in_phase": Variable(("trajectory", "time", "axis"), "m"),
    "quadrature": Variable(("trajectory", "time", "axis"), "m"),
    "feedback_force": Variable(("trajectory", "time", "axis"), "N"),
    "feedback_power": Variable(("trajectory", "time", "axis"), "1"),
    "feedback_position": Variable(("trajectory", "time", "axis"), "m"),
    "orientation": Variable(("trajectory", "time", "euler_parameter"), "1"),
    "angular_velocity": Variable(("trajectory", "time", "body_axis"), "rad/s"),
    "seen": Variable(("trajectory", "frame", "seen_axis"), "m"),
    "frame_time": Variable(("frame",), "s"),
}
_BEADS_ENSEMBLE = _ENSEMBLE | {
    "position": Variable(("trajectory", "time", "bead", "axis"), "m", needed=True)
}
_STATISTICS = {
    "time": _TIME,
    **{
        f"{of}_{moment}{error}": Variable((*along, "axis"), unit, needed=True)
        for of, along in (("position", ("time",)), ("stationary", ()))
        for moment, unit in (("mean", "m"), ("variance", "m^2"))
        for error in ("", "_error")
    },
    "trajectories_left": Variable(("time",), "1", needed=True),
    **{
        name: Variable((), "1", needed=True)
        for name in ("trajectories", "trajectories_lost", "windows")
    },
    "bin": Variable(("bin",), "m", needed=True),
    "density": Variable(("bin", "axis"), "1/m", needed=True),
}
_BEADS_STATISTICS = {
    name: each._replace(dimensions=(*each.dimensions[:-1], "bead", "axis"))
    if each.dimensions[-1:] == ("axis",)
    else each
    for name, each in _STATISTICS.items()
}
#: Requirements by the name of the kind
SCHEMAS: dict[str, Schema] = {
    "run": Schema(_OfRun, _RUN, _of_run),
    "beads": Schema(_OfRun, _BEADS, _of_run),
    "ensemble": Schema(_OfEnsemble, _ENSEMBLE, _of_ensemble),
    "statistics": Schema(_OfEnsemble, _STATISTICS, _of_statistics),
    "beads ensemble": Schema(_OfEnsemble, _BEADS_ENSEMBLE, _of_ensemble),
    "beads statistics": Schema(_OfEnsemble, _BEADS_STATISTICS, _of_statistics),
    "sweep": Schema(_OfSweep, {}, _of_sweep),
}
